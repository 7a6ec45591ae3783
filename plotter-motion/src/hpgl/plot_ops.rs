//! [`PlotOps`]: a whole text as an iterator of plot operations.

use super::interpreter::USUAL_VERTICES;
use super::{Error, Interpreter, ReadOptions, Reader};
use crate::PlotOp;
use core::iter::Copied;
use core::slice::Iter;

/// How much of the text has been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Text,
    EndOfText,
    EndOfDrawing,
    /// Strict reading met an error: what the interpreter still holds is not to follow.
    Failed,
}

/// The plot operations of an HPGL text, read from an iterator of bytes as they are asked for.
///
/// Memory is constant, whatever the length of the text. An [`Error`] stands in the place of what could not be
/// carried out, and the operations after it follow, unless reading is [strict](PlotOps::strict). `VERTICES`
/// is the room for a polygon: see [`Interpreter`].
#[derive(Clone, Debug)]
pub struct PlotOps<I, const VERTICES: usize = USUAL_VERTICES> {
    bytes: I,
    reader: Reader,
    interpreter: Interpreter<VERTICES>,
    stage: Stage,
    /// Whether the interpreter may have something to give.
    has_more: bool,
    strict: bool,
}

impl<I: Iterator<Item = u8>> PlotOps<I> {
    /// The operations of the text `bytes`.
    pub fn new(bytes: impl IntoIterator<Item = u8, IntoIter = I>) -> Self {
        Self::with_options(bytes, ReadOptions::default())
    }

    /// The operations of the text `bytes`, meant for this plotter.
    pub fn with_options(bytes: impl IntoIterator<Item = u8, IntoIter = I>, options: ReadOptions) -> Self {
        Self::with_interpreter(bytes, Interpreter::with_options(options))
    }
}

impl<I: Iterator<Item = u8>, const VERTICES: usize> PlotOps<I, VERTICES> {
    /// The operations of the text `bytes` as an interpreter carries it out, which may have more or less room
    /// for polygons than the usual one.
    pub fn with_interpreter(
        bytes: impl IntoIterator<Item = u8, IntoIter = I>,
        interpreter: Interpreter<VERTICES>,
    ) -> Self {
        Self {
            bytes: bytes.into_iter(),
            reader: Reader::new(),
            interpreter,
            stage: Stage::Text,
            has_more: true,
            strict: false,
        }
    }

    /// The same, ending with the first error. Notices ([`Error::is_notice`]) do not count as errors.
    ///
    /// ```
    /// # use plotter_motion::hpgl;
    /// let text = b"PU0,0;RP2;PD40,0,80;PD0,0;";
    /// assert_eq!(hpgl::plot_ops(text).filter(Result::is_err).count(), 2); // RP, and an x without y
    /// assert_eq!(hpgl::plot_ops(text).filter(Result::is_ok).count(), 3);
    /// assert_eq!(hpgl::plot_ops(text).strict().filter(Result::is_ok).count(), 2); // the last line is lost
    /// ```
    #[must_use]
    pub fn strict(self) -> Self {
        Self { strict: true, ..self }
    }
}

impl<I: Iterator<Item = u8>, const VERTICES: usize> Iterator for PlotOps<I, VERTICES> {
    type Item = Result<PlotOp, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if self.stage == Stage::Failed {
                return None;
            }
            if self.has_more {
                if let Some(outcome) = self.interpreter.next_op() {
                    if self.strict && outcome.is_err_and(|error| !error.is_notice()) {
                        self.stage = Stage::Failed;
                    }
                    return Some(outcome);
                }
                self.has_more = false;
            }
            let event = match self.stage {
                Stage::Text => match self.bytes.by_ref().find_map(|byte| self.reader.push(byte)) {
                    Some(event) => Some(event),
                    None => {
                        self.stage = Stage::EndOfText;
                        self.reader.finish()
                    }
                },
                Stage::EndOfText => {
                    self.stage = Stage::EndOfDrawing;
                    let ended = self.interpreter.finish();
                    debug_assert!(ended.is_ok(), "next_op has just given none");
                    self.has_more = true;
                    None
                }
                Stage::EndOfDrawing | Stage::Failed => return None,
            };
            if let Some(event) = event {
                let taken = self.interpreter.push(event);
                debug_assert!(taken.is_ok(), "next_op has just given none");
                self.has_more = true;
            }
        }
    }
}

impl<I: Iterator<Item = u8>, const VERTICES: usize> core::iter::FusedIterator for PlotOps<I, VERTICES> {}

/// The plot operations of an HPGL text that is in memory. For one that is not, see [`PlotOps::new`].
///
/// ```
/// # use plotter_motion::{PlotOp, Point, hpgl};
/// let ops: Result<Vec<PlotOp>, hpgl::Error> = hpgl::plot_ops(b"IN;SP2;PU400,0;PD400,200;").collect();
/// assert_eq!(
///     ops?,
///     [
///         PlotOp::SelectPen { pen: 2 },
///         PlotOp::Travel { to: Point::new(10.0, 0.0) },
///         PlotOp::Draw { to: Point::new(10.0, 5.0), feed_mm_s: None },
///     ]
/// );
/// # Ok::<(), hpgl::Error>(())
/// ```
pub fn plot_ops(text: &[u8]) -> PlotOps<Copied<Iter<'_, u8>>> {
    PlotOps::new(text.iter().copied())
}
