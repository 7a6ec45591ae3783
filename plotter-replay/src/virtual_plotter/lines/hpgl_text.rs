//! [`HpglText`]: what a host that speaks HPGL draws, byte by byte.

use plotter_motion::hpgl::{Event, Interpreter, Reader};
use plotter_motion::{PlotOp, Point};

/// The text so far.
#[derive(Clone, Debug, Default)]
pub(super) struct HpglText {
    reader: Reader,
    interpreter: Interpreter,
    at: Point,
}

/// What a byte has brought to its end.
#[derive(Clone, Debug, Default)]
pub(super) struct Read {
    /// Whether a command has begun.
    pub(super) is_command: bool,
    /// Where the pen was before.
    pub(super) from: Point,
    pub(super) ops: Vec<PlotOp>,
    /// What a plotter does not do either, or cannot.
    pub(super) not_understood: Vec<String>,
}

impl HpglText {
    pub(super) fn push(&mut self, byte: u8) -> Option<Read> {
        let event = self.reader.push(byte)?;
        let is_command = matches!(event, Ok(Event::Command { .. }));
        let mut read = Read { is_command, from: self.at, ..Read::default() };
        if self.interpreter.push(event).is_err() {
            return None; // cannot be: all of the event before has been taken
        }
        while let Some(op) = self.interpreter.next_op() {
            match op {
                Ok(op) => {
                    self.at = op.target().unwrap_or(self.at);
                    read.ops.push(op);
                }
                Err(error) if error.is_notice() => {}
                Err(error) => {
                    let command = error.command().map(|command| command.to_string());
                    read.not_understood.push(command.unwrap_or_else(|| error.to_string()));
                }
            }
        }
        Some(read)
    }
}
