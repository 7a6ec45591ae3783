//! [`PenLines`]: the lines of G-code that move a pen, in a person's own words.

use plotter_motion::gcode;

/// The options `--pen-up` and `--pen-down`.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct PenLines {
    /// Line of G-code that lifts the pen, such as "M42 P4 S0", M9 or `PEN_UP`, where G-code is read or
    /// written; for reading it may be given several times
    #[arg(long = "pen-up", value_name = "LINE", requires = "down")]
    pub up: Vec<String>,
    /// Line of G-code that lowers the pen
    #[arg(long = "pen-down", value_name = "LINE", requires = "up")]
    pub down: Vec<String>,
}

impl PenLines {
    /// The words of these lines; `None` where there are none.
    ///
    /// # Errors
    ///
    /// The line that is no G-code.
    pub fn words(&self) -> Result<Option<gcode::PenWords>, String> {
        if self.up.is_empty() {
            return Ok(None);
        }
        let (up, down) = (self.up.iter().map(String::as_str), self.down.iter().map(String::as_str));
        gcode::PenWords::new(up, down)
            .map(Some)
            .map_err(|error| format!("--pen-up, --pen-down: {}", error.problem))
    }
}
