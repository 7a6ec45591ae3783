//! [`SheetConfig`]: what a machine's file says of drawings that are longer than the table.

use plotter_motion::config::{Bound, ConfigError, Key, MachineConfig, Section};

/// How drawings longer than the table are drawn: the table `[sheet]` of a machine's file.
///
/// The defaults are a machine that moves no sheet. With the feature `toml`,
/// `plotter_motion::Machine::from_toml_with` reads it beside the machine.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, config::Section};
/// # use plotter_stitch::sheet::SheetConfig;
/// let machine = Machine::new(MachineConfig::textile_plotter())?;
/// let sheet = SheetConfig::textile_plotter().checked(machine.config())?;
/// assert_eq!(sheet.frame_mm, 950.0);
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct SheetConfig {
    /// By how much the sheet is moved along y at a time, mm; 0 if the machine cannot move it.
    pub frame_mm: f64,
    /// The machine's y at which every frame begins, mm: the sheet is moved along y, towards smaller y.
    pub begin_mm: f64,
    /// How far from the border between two frames a line may be cut, mm.
    pub cut_window_mm: f64,
    /// A cut nearer than this to a corner or to another line does harm, mm.
    pub cut_clear_mm: f64,
    /// The most that lines may be moved at a joint to keep the drawing parallel to the paper's edge, mm; 0
    /// for not at all.
    pub anchor_mm: f64,
    /// Speed at which the optical head looks for reference lines, mm/s.
    pub sensing_mm_s: f64,
}

impl SheetConfig {
    /// The same with another [`SheetConfig::frame_mm`].
    #[must_use]
    pub const fn with_frame_mm(self, frame_mm: f64) -> Self {
        Self { frame_mm, ..self }
    }

    /// The same with another [`SheetConfig::begin_mm`].
    #[must_use]
    pub const fn with_begin_mm(self, begin_mm: f64) -> Self {
        Self { begin_mm, ..self }
    }

    /// The same with another [`SheetConfig::cut_window_mm`].
    #[must_use]
    pub const fn with_cut_window_mm(self, cut_window_mm: f64) -> Self {
        Self { cut_window_mm, ..self }
    }

    /// The same with another [`SheetConfig::cut_clear_mm`].
    #[must_use]
    pub const fn with_cut_clear_mm(self, cut_clear_mm: f64) -> Self {
        Self { cut_clear_mm, ..self }
    }

    /// The same with another [`SheetConfig::anchor_mm`].
    #[must_use]
    pub const fn with_anchor_mm(self, anchor_mm: f64) -> Self {
        Self { anchor_mm, ..self }
    }

    /// The same with another [`SheetConfig::sensing_mm_s`].
    #[must_use]
    pub const fn with_sensing_mm_s(self, sensing_mm_s: f64) -> Self {
        Self { sensing_mm_s, ..self }
    }
}

impl SheetConfig {
    /// The documented textile plotter: frames of 950 mm on a table that takes 1000 mm of the paper's length.
    #[must_use]
    pub const fn textile_plotter() -> Self {
        Self {
            frame_mm: 950.0,
            begin_mm: 20.0,
            cut_window_mm: 5.0,
            cut_clear_mm: 1.0,
            anchor_mm: 0.01,
            sensing_mm_s: 300.0,
        }
    }
}

impl Default for SheetConfig {
    /// No frames; all else as the documented textile plotter has it.
    fn default() -> Self {
        Self { frame_mm: 0.0, ..Self::textile_plotter() }
    }
}

/// Keys of the table.
static KEYS: [Key<SheetConfig>; 6] = [
    Key::number(
        "sheet.frame_mm",
        |c| c.frame_mm,
        (0.0, 100_000.0),
        "mm",
        "the documented textile plotter takes 900 to 1000, along y; 0 if the sheet cannot be moved",
    ),
    Key::number(
        "sheet.begin_mm",
        |c| c.begin_mm,
        (0.0, 100_000.0),
        "mm",
        "the documented textile plotter has 20",
    ),
    Key::number(
        "sheet.cut_window_mm",
        |c| c.cut_window_mm,
        (0.0, 1_000.0),
        "mm",
        "5 finds a good place for most cuts; 0 cuts at the border",
    ),
    Key::number(
        "sheet.cut_clear_mm",
        |c| c.cut_clear_mm,
        (0.0, 100.0),
        "mm",
        "twice the pen's width is a good choice",
    ),
    Key::number("sheet.anchor_mm", |c| c.anchor_mm, (0.0, 1.0), "mm", "0.01 cannot be seen at a joint"),
    Key::number(
        "sheet.sensing_mm_s",
        |c| c.sensing_mm_s,
        (1.0, 10_000.0),
        "mm/s",
        "the documented textile plotter senses at 300",
    ),
];

impl Section for SheetConfig {
    const NAME: &'static str = "sheet";

    fn keys() -> &'static [Key<Self>] {
        &KEYS
    }

    /// Where frames are drawn, each lies in the area with the windows at both of its borders.
    fn fit(&self, machine: &MachineConfig) -> Result<(), ConfigError> {
        if self.frame_mm <= 0.0 {
            return Ok(());
        }
        ConfigError::demand(
            "sheet.cut_window_mm",
            self.cut_window_mm,
            (Bound::AtMost, self.begin_mm.min(0.25 * self.frame_mm)),
            "mm",
            "the frame before and this one both draw there: at most sheet.begin_mm and a quarter of sheet.frame_mm",
        )?;
        ConfigError::demand(
            "sheet.frame_mm",
            self.frame_mm,
            (Bound::AtMost, machine.area.height_mm - self.begin_mm - self.cut_window_mm),
            "mm",
            "the frame ends within the area: area.height_mm less sheet.begin_mm and sheet.cut_window_mm",
        )
    }
}
