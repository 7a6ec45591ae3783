//! [`PlotOps`]: a whole text as an iterator of plot operations.

#[cfg(feature = "alloc")]
use super::PenWords;
use super::lines::Lines;
use super::{Error, Interpreter, Problem, ReadOptions};
use crate::PlotOp;
use core::iter::Copied;
use core::slice::Iter;

/// How much of the text has been read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Text,
    /// The program has ended in this line; what follows is looked at once.
    EndOfProgram(u32),
    EndOfText,
    EndOfDrawing,
    /// Strict reading met an error: what the interpreter still holds is not to follow.
    Failed,
}

/// The plot operations of a G-code text, read from an iterator of bytes as they are asked for.
///
/// Memory is constant, whatever the length of the text; but for loops and subprograms, which are held, 16 MiB
/// at most. An [`Error`] stands in the place of what could not be carried out, and the operations after it
/// follow, unless reading is [strict](PlotOps::strict).
#[derive(Clone, Debug)]
pub struct PlotOps<I> {
    lines: Lines<I>,
    interpreter: Interpreter,
    stage: Stage,
    strict: bool,
}

impl<I: Iterator<Item = u8>> PlotOps<I> {
    /// The operations of the text `bytes`, with the default options.
    pub fn new(bytes: impl IntoIterator<Item = u8, IntoIter = I>) -> Self {
        Self::with_options(bytes, ReadOptions::default())
    }

    /// The operations of the text `bytes`.
    pub fn with_options(bytes: impl IntoIterator<Item = u8, IntoIter = I>, options: ReadOptions) -> Self {
        Self {
            lines: Lines::new(bytes.into_iter()),
            interpreter: Interpreter::with_options(options),
            stage: Stage::Text,
            strict: false,
        }
    }

    /// The same, lifting and lowering the pen by these words instead of those of the options.
    #[cfg(feature = "alloc")]
    #[must_use]
    pub fn with_pen_words(self, words: PenWords) -> Self {
        Self { lines: self.lines.with_pen_words(words), interpreter: self.interpreter.with_spindle(), ..self }
    }

    /// The same, ending with the first error. Notices ([`Error::is_notice`]) do not count as errors.
    ///
    /// ```
    /// # use plotter_motion::gcode;
    /// let text = b"M104 S200\nM3\nG1 X1\nG1 X1O\nG1 X2";
    /// assert_eq!(gcode::plot_ops(text).filter(Result::is_err).count(), 2); // a temperature, and an O for a 0
    /// assert_eq!(gcode::plot_ops(text).filter(Result::is_ok).count(), 2);
    /// assert_eq!(gcode::plot_ops(text).strict().filter(Result::is_ok).count(), 1); // the last line is lost
    /// ```
    #[must_use]
    pub fn strict(self) -> Self {
        Self { strict: true, ..self }
    }
}

impl<I: Iterator<Item = u8>> PlotOps<I> {
    /// What to say of the lines behind the end of the program, if they would do something.
    fn after_end(&mut self, line: u32) -> Option<Error> {
        let labels = self.lines.labels();
        while let Some(ended) = self.lines.advance() {
            let block = *self.lines.block();
            self.lines.clear();
            // Subprograms stand there.
            if ended.is_err() || self.lines.labels() != labels {
                return None;
            }
            if block.words().iter().any(|word| matches!(word.letter, b'X' | b'Y' | b'Z')) {
                return Some(Error { at: block.position(), problem: Problem::AfterEnd { line } });
            }
        }
        None
    }
}

impl<I: Iterator<Item = u8>> Iterator for PlotOps<I> {
    type Item = Result<PlotOp, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if self.stage == Stage::Failed {
                return None;
            }
            if let Some(outcome) = self.interpreter.next_op() {
                if self.strict && outcome.is_err_and(|error| !error.is_notice()) {
                    self.stage = Stage::Failed;
                }
                return Some(outcome);
            }
            let ended = match self.stage {
                Stage::Text => match self.interpreter.ended() {
                    Some(line) => {
                        self.stage = Stage::EndOfProgram(line);
                        let ended = self.interpreter.finish();
                        debug_assert!(ended.is_ok(), "next_op has just given none");
                        None
                    }
                    None => {
                        let ended = self.lines.advance();
                        if ended.is_none() {
                            self.stage = Stage::EndOfText;
                        }
                        ended
                    }
                },
                Stage::EndOfProgram(line) => {
                    self.stage = Stage::EndOfDrawing;
                    self.after_end(line).map(Err)
                }
                Stage::EndOfText => {
                    self.stage = Stage::EndOfDrawing;
                    let ended = self.interpreter.finish();
                    debug_assert!(ended.is_ok(), "next_op has just given none");
                    None
                }
                Stage::EndOfDrawing | Stage::Failed => return None,
            };
            if let Some(ended) = ended {
                let block = ended.map(|()| self.lines.block());
                let taken = self.interpreter.push_line(block, self.lines.text());
                debug_assert!(taken.is_ok(), "next_op has just given none");
                self.lines.clear();
            }
        }
    }
}

impl<I: Iterator<Item = u8>> core::iter::FusedIterator for PlotOps<I> {}

/// The plot operations of a G-code text that is in memory, by the convention that it seems to follow: see
/// [`Detection`](super::Detection). For a text that is not in memory, or whose convention is known, see
/// [`PlotOps::with_options`].
///
/// ```
/// # use plotter_motion::{PlotOp, Point, gcode};
/// let ops: Result<Vec<PlotOp>, gcode::Error> =
///     gcode::plot_ops(b"G0 Z5\nG0 X10 Y0\nG1 Z-1 F600\nG3 X0 Y10 I-10 J0\nG0 Z5").collect();
/// let quarter = PlotOp::DrawArc {
///     centre: Point::ORIGIN,
///     sweep_rad: std::f64::consts::FRAC_PI_2,
///     to: Point::new(0.0, 10.0),
///     feed_mm_s: Some(10.0),
/// };
/// let lift = PlotOp::Travel { to: Point::new(0.0, 10.0) };
/// assert_eq!(ops?, [PlotOp::Travel { to: Point::new(10.0, 0.0) }, quarter, lift]);
/// # Ok::<(), gcode::Error>(())
/// ```
pub fn plot_ops(text: &[u8]) -> PlotOps<Copied<Iter<'_, u8>>> {
    PlotOps::with_options(text.iter().copied(), super::Detection::from_bytes(text.iter().copied()).options())
}
