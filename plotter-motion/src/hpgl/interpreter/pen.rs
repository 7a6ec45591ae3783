//! The pen: where it goes, which one it is, how fast it draws; and curves and encoded data, which are many
//! places.

use super::super::encoded::Step;
use super::super::piece::Piece;
use super::super::scaling::limited;
use super::super::{Error, Mnemonic, Position};
use super::job::Job;
use super::open::Open;
use super::{Interpreter, Item, PENS};
use crate::bezier::Bezier;
use crate::{PlotOp, Vec2};

/// mm/s in a cm/s, the unit of `VS`.
const MM_S_PER_CM_S: f64 = 10.0;

impl<const VERTICES: usize> Interpreter<VERTICES> {
    /// Where coordinates lie, or a step leads to.
    pub(super) fn target(&self, user: Vec2, relative: bool) -> Vec2 {
        if relative { limited(self.at + self.scaling.way(user)) } else { self.scaling.place(user) }
    }

    pub(super) fn go_to(&mut self, x: f64, y: f64) {
        self.move_to(self.target(Vec2::new(x, y), self.relative));
    }

    /// Moves with the pen as it is.
    pub(super) fn move_to(&mut self, to: Vec2) {
        self.dot_owed = false;
        let from = self.at;
        self.draw(if self.pen_down { Piece::Line { from, to } } else { Piece::Travel { to } });
        self.arrive(to);
        if let Some(symbol) = self.symbol
            && !self.recording
        {
            self.draw_symbol(symbol);
        }
    }

    /// The pen is sent somewhere: labels start there.
    pub(super) fn arrive(&mut self, at: Vec2) {
        self.at = at;
        self.lettering.line_start = at;
    }

    pub(super) fn select_pen(&mut self, open: &Open) -> Result<(), Error> {
        let pen = open.whole(0, 0, 0, u8::MAX, "a whole pen number from 0 to 255")?;
        self.leave_dot();
        self.give(Item::Outcome(Ok(PlotOp::SelectPen { pen })));
        Ok(())
    }

    pub(super) fn set_speed(&mut self, open: &Open) -> Result<(), Error> {
        let feed_mm_s = match open.get(0) {
            Some(cm_s) if cm_s > 0.0 => Some(cm_s * MM_S_PER_CM_S),
            Some(_) => return Err(open.bad(0, "a speed above 0 cm/s")),
            None => None,
        };
        match self.pen_index(open)? {
            Some(index) => {
                if let Some(slot) = self.feeds_mm_s.get_mut(index) {
                    *slot = feed_mm_s;
                }
            }
            None => {
                self.feeds_mm_s = [feed_mm_s; PENS];
                self.feed_mm_s = feed_mm_s;
            }
        }
        Ok(())
    }

    /// The pen that the second number names, counted from 0.
    pub(super) fn pen_index(&self, open: &Open) -> Result<Option<usize>, Error> {
        let pen = open.whole(1, 0, 1, 8, "a whole pen number from 1 to 8 as its second number")?;
        Ok(usize::from(pen).checked_sub(1))
    }

    /// One more number of `BZ` or `BR`: with each six there is a curve.
    pub(super) fn curve(&mut self, open: &mut Open) {
        let [Some(b), Some(c), Some(d)] = [open.pair(0), open.pair(2), open.pair(4)] else { return };
        open.clear();
        let relative = open.command.letters() == b"BR";
        let [b, c, d] = [b, c, d].map(|user| self.target(user, relative));
        if self.pen_down || self.recording {
            self.dot_owed = false;
            self.begin_curve();
            self.job = Job::Curve(Bezier::new([self.at, b, c, d], self.tolerance_units), self.at);
        } else {
            self.draw(Piece::Travel { to: d });
        }
        self.arrive(d);
    }

    /// A curve that is the first of a subpolygon begins where the pen is.
    pub(super) fn begin_curve(&mut self) {
        if self.recording && self.polygon.is_closed() {
            let started = self.polygon.start_at(self.at);
            self.record(started);
        }
    }

    pub(super) fn encoded_byte(&mut self, byte: u8, at: Position, command: Mnemonic) {
        let Some(mut decoder) = self.decoder.take() else { return };
        match decoder.push(byte) {
            Ok(steps) => {
                self.decoder = Some(decoder);
                for step in steps.into_iter().flatten() {
                    self.encoded_step(step, at, command);
                }
            }
            Err(_) => {
                self.open = None;
                self.complain(Error::UnexpectedByte { at, command: Some(command), byte });
            }
        }
    }

    fn encoded_step(&mut self, step: Step, at: Position, command: Mnemonic) {
        match step {
            Step::Go { to, up, absolute } => {
                if up {
                    self.lift();
                }
                self.pen_down = !up;
                self.move_to(self.target(to, !absolute));
            }
            Step::Pen(value) => {
                let mut pen = Open::new(command, at);
                pen.push(value, at);
                if let Err(error) = self.select_pen(&pen) {
                    self.complain(error);
                }
            }
        }
    }

    pub(super) fn end_encoded(&mut self, open: &Open) -> Result<(), Error> {
        // Without a decoder, its data have been complained about.
        let Some(mut decoder) = self.decoder.take() else { return Ok(()) };
        if let Ok(Some(step)) = decoder.finish() {
            self.encoded_step(step, open.at, open.command);
        }
        self.bytes = decoder.bytes();
        match decoder.lonely() {
            Some(x) => Err(Error::OddCoordinates { at: open.at, command: open.command, x }),
            None if !decoder.is_complete() => Err(open.missing("the last byte of its last number")),
            None => Ok(()),
        }
    }
}
