//! [`GcodeWords`]: operations as lines of G-code, for the languages that are made of it.

use super::language::OpText;
use crate::PlotOp;
use crate::gcode::{PenControl, WriteError, WriteOptions, Writer};
use core::time::Duration;

/// A writer whose text is taken out operation by operation, and which can begin anew.
#[derive(Clone, Debug)]
pub(super) struct GcodeWords<'a> {
    writer: Writer<'a, OpText>,
    options: WriteOptions<'a>,
}

impl<'a> GcodeWords<'a> {
    pub(super) fn new(options: WriteOptions<'a>) -> Self {
        Self { writer: Writer::with_options(OpText::default(), options), options }
    }

    /// Nothing is known of the machine's modes and of its pen any more.
    pub(super) fn begin(&mut self) {
        *self = Self::new(self.options);
    }

    pub(super) fn write(&mut self, op: PlotOp, out: &mut OpText) -> Result<(), WriteError> {
        let written = self.writer.push(op);
        self.take(out);
        written
    }

    /// The pen lifted where it is.
    pub(super) fn lift(&mut self, out: &mut OpText) -> Result<(), WriteError> {
        let written = self.writer.lift();
        self.take(out);
        written
    }

    fn take(&mut self, out: &mut OpText) {
        *out = core::mem::take(self.writer.out_mut());
    }

    /// How long the machine stands for its pen.
    pub(super) const fn settle(&self) -> Duration {
        self.options.settle
    }

    /// The number that lowers the pen from the next beginning on; whether it is one.
    pub(super) fn pen_down_at(&mut self, number: u16) -> bool {
        let PenControl::Spindle { down } = &mut self.options.pen else { return false };
        *down = number.into();
        true
    }
}
