//! Curves of `G5` to `G5.3`, and arcs that are none any more once both axes are scaled by other factors.

use super::super::interpreter::{LineInterpreter, Outcomes};
use super::super::nurbs::{LEAST_ORDER, MOST_ORDER, Nurbs};
use super::super::stretched_arc::StretchedArc;
use super::super::{Block, Error, Modes, Problem, ReadOptions};
use super::words::{carry_out_rest, has, place, without_movement};
use super::{Expansion, Motion, Pending};
use crate::bezier::Bezier;
use crate::{PlotOp, Point, Vec2};

/// Farthest that a curve's chords may be from it, mm: a tenth of the finest pen's line.
const TOLERANCE_MM: f64 = 0.01;

impl Expansion {
    pub(super) fn begin_curve(&mut self, block: &Block, is_cubic: bool, modes: &Modes) -> Result<(), Error> {
        let unit_mm = modes.unit_mm();
        let way = |x, y| Some(Vec2::new(block.number(x)?, block.number(y)?) * unit_mm);
        let (from, to) = (modes.position, place(block, modes, [b'X', b'Y']));
        let missing = |expected| Error { at: block.position(), problem: Problem::Missing { expected } };
        let points = if is_cubic {
            let out = way(b'I', b'J').or(self.back.map(|back| back * -1.0));
            let out = out.ok_or_else(|| missing("G5 needs I and J: the way to its first control point"))?;
            let back = way(b'P', b'Q').ok_or_else(|| {
                missing("G5 needs P and Q: the way from its end to its second control point")
            })?;
            self.back = Some(back);
            [from, from + out, to + back, to]
        } else {
            let out =
                way(b'I', b'J').ok_or_else(|| missing("G5.1 needs I and J: the way to its control point"))?;
            let control = from + out;
            [from, from.lerp(control, 2.0 / 3.0), to.lerp(control, 2.0 / 3.0), to]
        };
        self.block = *block;
        self.pending = Pending::Curve(Bezier::new(points.map(|at| at - Point::ORIGIN), TOLERANCE_MM));
        Ok(())
    }

    /// A line of `G5.2`.
    pub(super) fn take_control_point(
        &mut self,
        block: &Block,
        line: &mut LineInterpreter,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        carry_out_rest(&without_movement(block), line, options, out)?;
        let modes = line.modes();
        let refused = |letter, expected| {
            let word = block.words().iter().find(|word| word.letter == letter).copied();
            let problem = match word {
                Some(word) => Problem::BadParameter { word, expected },
                None => Problem::Missing { expected },
            };
            Error { at: word.map_or(block.position(), |word| block.place(word)), problem }
        };
        let weight = block.number(b'P').unwrap_or(1.0);
        if weight <= 0.0 {
            return Err(refused(b'P', "the weight of a control point is above 0"));
        }
        let (has_x, has_y) = (has(block, b"X"), has(block, b"Y"));
        if has_x != has_y {
            return Err(refused(b'G', "a control point of G5.2 has both X and Y"));
        }
        let is_first = self.nurbs.is_none();
        let first_weight = if has_x { 1.0 } else { weight };
        let mut nurbs =
            self.nurbs.unwrap_or_else(|| Nurbs::new(modes.position, first_weight, block.position()));
        if let Some(order) = block.number(b'L') {
            // LinuxCNC takes a lower one for this, too.
            let order = usize::try_from(crate::whole::whole(order)).unwrap_or_default().max(LEAST_ORDER);
            if order > MOST_ORDER {
                return Err(refused(b'L', "the order of a curve is at most 6"));
            }
            nurbs.set_order(order);
        }
        if has_x {
            // Ways count from where the curve begins, however far it has been drawn.
            let to = place(block, &Modes { position: nurbs.start, ..modes }, [b'X', b'Y']);
            if let Some(stretch) = nurbs.push(to, weight, TOLERANCE_MM) {
                (self.block, self.pending) = (*block, Pending::Nurbs { stretch, is_last: false });
            }
        } else if !is_first && has(block, b"P") {
            return Err(refused(b'P', "a weight without X and Y is that of the first control point"));
        }
        self.nurbs = Some(nurbs);
        Ok(())
    }

    /// `G5.3`.
    pub(super) fn end_nurbs(
        &mut self,
        block: &Block,
        line: &mut LineInterpreter,
        options: &ReadOptions,
        out: &mut Outcomes<Error>,
    ) -> Result<(), Error> {
        let missing = |expected| Error { at: block.position(), problem: Problem::Missing { expected } };
        carry_out_rest(&without_movement(block), line, options, out)?;
        self.motion = Motion::Plain(80);
        let mut nurbs =
            self.nurbs.take().ok_or_else(|| missing("G5.3 needs the curve of a G5.2 before it"))?;
        if nurbs.count() < nurbs.order {
            line.relocate(nurbs.last());
            out.give(Err(missing(
                "G5.2 needs as many control points, with its beginning, as its order L says, 3 without L",
            )));
            out.give(Ok(PlotOp::Travel { to: nurbs.last() }));
            return Ok(());
        }
        if let Some(stretch) = nurbs.rest(TOLERANCE_MM) {
            (self.block, self.pending) = (*block, Pending::Nurbs { stretch, is_last: true });
        }
        self.nurbs = Some(nurbs);
        Ok(())
    }

    /// A curve that the end of the text has cut off.
    pub(in crate::gcode) fn cut_off(&mut self) -> Option<Error> {
        self.nurbs.take().map(|nurbs| nurbs.not_ended())
    }

    /// What becomes of an operation on the sheet: an arc that is none there becomes lines.
    pub(in crate::gcode) fn placed(&mut self, op: PlotOp) -> Option<PlotOp> {
        self.arc = StretchedArc::of(op, &self.frame, TOLERANCE_MM);
        if self.arc.is_some() { self.next_of_arc() } else { Some(self.frame.apply_to(op)) }
    }

    pub(in crate::gcode) fn next_of_arc(&mut self) -> Option<PlotOp> {
        let op = self.arc.as_mut()?.next();
        if op.is_none() {
            self.arc = None;
        }
        op.map(|op| self.frame.apply_to(op))
    }

    /// The end of the next line of a curve.
    pub(super) fn next_of_curve(&mut self) -> Option<Point> {
        let to = match &mut self.pending {
            Pending::Curve(curve) => curve.next().map(|to| Point::ORIGIN + to),
            Pending::Nurbs { stretch, is_last } => {
                let rest = |nurbs: &mut Nurbs| nurbs.rest(TOLERANCE_MM);
                let next = stretch.next();
                if next.is_none() && *is_last {
                    match self.nurbs.as_mut().and_then(rest) {
                        Some(other) => {
                            *stretch = other;
                            stretch.next()
                        }
                        None => {
                            self.nurbs = None;
                            None
                        }
                    }
                } else {
                    next
                }
            }
            _ => None,
        };
        if to.is_none() {
            self.pending = Pending::Nothing;
        }
        to
    }
}
