//! [`DrawingArguments`]: how a drawing's file is read and arranged, as the command line of a machine says it.

use super::{Arrangement, DrawingFile, Language, PenLines, Reading, SvgReading};
use clap::Args;
use std::path::Path;

/// How a drawing is read and arranged before a machine draws it.
#[derive(Args, Debug)]
pub struct DrawingArguments {
    /// What the file is written in [default: told by its contents]
    #[arg(long, value_enum)]
    language: Option<Language>,
    /// Size of a step in CAMM-GL and GP-GL, or of the unit of a DXF, mm: 25.4 for inches [default: 0.025,
    /// 0.1, Silhouette's 0.05; what the DXF says, else 1]
    #[arg(long, value_name = "S", value_parser = step, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    #[command(flatten)]
    svg_reading: SvgReading,
    #[command(flatten)]
    arrangement: Arrangement,
    #[command(flatten)]
    pen_lines: PenLines,
}

fn step(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if (1e-6..=1e6).contains(&number) { Ok(number) } else { Err("give 0.000001 to 1000000".into()) }
}

impl DrawingArguments {
    /// The file, arranged.
    ///
    /// # Errors
    ///
    /// What cannot be read, or not be arranged so.
    pub fn open(&self, path: &Path) -> Result<DrawingFile, String> {
        DrawingFile::open(path, self.language)?
            .with_svg(&self.svg_reading)?
            .arranged(&self.arrangement)
            .with_pen_lines(&self.pen_lines)
    }

    /// How its numbers are read: 40 counts a millimetre in the thesis' text, as its machine has them.
    #[must_use]
    pub fn reading(&self) -> Reading {
        Reading { counts_per_mm: 40.0, step_mm: self.step_mm, ..Reading::default() }
    }
}
