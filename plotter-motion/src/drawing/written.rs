//! Drawings as texts of plotters.

use super::Drawing;
use crate::{gcode, hpgl};
use core::fmt;

impl Drawing {
    /// Writes it as HPGL. Cubic curves are lines within `tolerance_mm`.
    ///
    /// # Errors
    ///
    /// What HPGL cannot say, or an error of `out`.
    ///
    /// ```
    /// # use plotter_motion::{Point, hpgl, drawing::{Drawing, Stroke}};
    /// let line = Stroke::through([Point::new(1.0, 2.0), Point::new(3.0, 2.0)]).unwrap();
    /// let mut text = String::new();
    /// Drawing { strokes: vec![line], ..Drawing::default() }.write_hpgl(0.01, hpgl::WriteOptions::default(), &mut text)?;
    /// assert_eq!(text, "IN;\nSP1;\nPU40,80;\nPD120,80;\nPU;\nSP0;\n");
    /// # Ok::<(), hpgl::WriteError>(())
    /// ```
    pub fn write_hpgl(
        &self,
        tolerance_mm: f64,
        options: hpgl::WriteOptions,
        out: &mut impl fmt::Write,
    ) -> Result<(), hpgl::WriteError> {
        let mut writer = hpgl::Writer::with_options(out, options);
        self.ops(tolerance_mm).try_for_each(|op| writer.push(op))?;
        writer.finish().map(drop)
    }

    /// Writes it as G-code. Cubic curves are lines within `tolerance_mm`.
    ///
    /// # Errors
    ///
    /// What G-code cannot say by these options, or an error of `out`.
    pub fn write_gcode(
        &self,
        tolerance_mm: f64,
        options: gcode::WriteOptions<'_>,
        out: &mut impl fmt::Write,
    ) -> Result<(), gcode::WriteError> {
        let mut writer = gcode::Writer::with_options(out, options);
        self.ops(tolerance_mm).try_for_each(|op| writer.push(op))?;
        writer.finish().map(drop)
    }
}

/// Text into a file or a port: what takes bytes takes what the writers here write.
///
/// ```
/// use plotter_motion::{PlotOp, Point, hpgl, drawing::{Drawing, IoText}};
/// let drawing: Drawing = [PlotOp::Draw { to: Point::new(1.0, 0.0), feed_mm_s: None }].into_iter().collect();
/// let mut file = IoText::new(Vec::new());
/// drawing.write_hpgl(0.01, hpgl::WriteOptions::default(), &mut file)?;
/// assert!(file.finish()?.starts_with(b"IN;"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[cfg(feature = "std")]
#[derive(Debug)]
pub struct IoText<W> {
    out: W,
    failure: Option<std::io::Error>,
}

#[cfg(feature = "std")]
impl<W: std::io::Write> IoText<W> {
    /// Writes there. Each piece of text is a call: a file is better behind a [`std::io::BufWriter`].
    pub const fn new(out: W) -> Self {
        Self { out, failure: None }
    }

    /// Where the text has gone.
    ///
    /// # Errors
    ///
    /// Why it has not all gone there.
    pub fn finish(mut self) -> std::io::Result<W> {
        match self.failure {
            Some(failure) => Err(failure),
            None => self.out.flush().map(|()| self.out),
        }
    }
}

#[cfg(feature = "std")]
impl<W: std::io::Write> fmt::Write for IoText<W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.out.write_all(text.as_bytes()).map_err(|failure| {
            self.failure = Some(failure);
            fmt::Error
        })
    }
}
