//! [`StepFile`]: the steps of a plot as text.

use crate::machine::PlotEvent;
use crate::shared::at;
use plotter_motion::Pen;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// The steps as text, a line each.
#[derive(Debug)]
pub struct StepFile {
    path: PathBuf,
    out: BufWriter<File>,
    /// Why it cannot be written on.
    pub failure: Option<String>,
}

impl StepFile {
    /// A new file.
    ///
    /// # Errors
    ///
    /// The file and why it could not be written.
    pub fn create(path: &Path) -> Result<Self, String> {
        let file = File::create(path).map_err(|error| at(path, &format!("cannot be written: {error}")))?;
        let mut steps = Self { path: path.to_owned(), out: BufWriter::new(file), failure: None };
        steps.line(format_args!("# tick of 1 us, dx, dy, pen\n"));
        Ok(steps)
    }

    /// Writes what a line tells of: steps, pens and sheets.
    pub fn take(&mut self, event: PlotEvent, pen: Pen) {
        match event {
            PlotEvent::Step { tick_us, dx, dy, .. } => {
                self.line(format_args!("{tick_us} {dx} {dy} {}\n", u8::from(pen == Pen::Down)));
            }
            PlotEvent::SelectPen(pen) => self.line(format_args!("# pen {pen}\n")),
            PlotEvent::NewPage => self.line(format_args!("# new sheet\n")),
            _ => {}
        }
    }

    fn line(&mut self, text: std::fmt::Arguments<'_>) {
        if let Err(error) = self.out.write_fmt(text) {
            self.failure.get_or_insert(at(&self.path, &format!("cannot be written: {error}")));
        }
    }

    /// Writes it to its end.
    ///
    /// # Errors
    ///
    /// The file and why it could not be written.
    pub fn finish(mut self) -> Result<(), String> {
        if let Err(error) = self.out.flush() {
            self.failure.get_or_insert(at(&self.path, &format!("cannot be written: {error}")));
        }
        self.failure.map_or(Ok(()), Err)
    }
}
