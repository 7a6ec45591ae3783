//! The pen, or the laser: what lowers it, and what it still owes the sheet.

use super::{Machine, is_nearer, spindle_number};
use crate::PlotOp;
use crate::gcode::code::{Code, Group};
use crate::gcode::error::Complaint;
use crate::gcode::interpreter::Outcomes;
use crate::gcode::line::Line;
use crate::gcode::{LaserCommand, PenConvention, ReadOptions, ServoCommand};

impl Machine {
    /// Gives an operation, and notes where it leaves the pen.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn give<C: Complaint>(&mut self, op: PlotOp, out: &mut Outcomes<C>) {
        match op {
            PlotOp::LaserPower { .. } | PlotOp::Dwell { .. } => {}
            _ => {
                self.on_sheet = matches!(op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. });
                self.lift_owed = false;
            }
        }
        out.give(Ok(op));
    }

    /// Lifts the pen where it stands, if it has been told to and no travel has done so: before the machine
    /// stands, or at the end.
    pub(in crate::gcode) fn lift<C: Complaint>(&mut self, out: &mut Outcomes<C>) {
        if self.lift_owed {
            self.give(PlotOp::Travel { to: self.at }, out);
        }
    }

    /// The words by which this text lifts its pen or switches its laser.
    pub(super) fn put_pen<C: Complaint>(
        &mut self,
        line: &Line<'_>,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) {
        let told = line.of(Group::Told);
        let asks_s = matches!(told, Some(Code::Beep | Code::ServoAngle | Code::FanOn | Code::FanOff))
            || (line.is(Code::Dwell) && !line.has(b"P"));
        let spindle_s = line.number(b'S').filter(|_| !asks_s && !line.owned());
        if !matches!(options.pen, PenConvention::Laser { .. }) {
            // Whatever lifts the pen, this is what a controller tells that is asked for its state.
            self.power = spindle_s.unwrap_or(self.power);
            self.spindle = line.of(Group::Spindle).unwrap_or(self.spindle);
        }
        match options.pen {
            PenConvention::Spindle => {
                if let Some(spindle) = line.of(Group::Spindle) {
                    self.set_pen(spindle != Code::SpindleOff, options, out);
                }
            }
            PenConvention::SpindleWords { up, down } => {
                if let Some(spindle) = line.of(Group::Spindle) {
                    let number = spindle_number(spindle);
                    if number == up || number == down {
                        self.set_pen(number == down, options, out);
                    }
                }
            }
            PenConvention::Servo { command, up, down } => {
                let place = match (command, told) {
                    (ServoCommand::M300, Some(Code::Beep)) | (ServoCommand::M280, Some(Code::ServoAngle)) => {
                        line.number(b'S')
                    }
                    (ServoCommand::M1, Some(Code::Degrees)) => Some(line.bare),
                    (ServoCommand::M3, _) if !line.is(Code::SpindleOff) => spindle_s,
                    _ => None,
                };
                if let Some(place) = place {
                    self.set_pen(is_nearer(place, down, up), options, out);
                }
            }
            PenConvention::Laser { command, full } => match (command, told) {
                (LaserCommand::Spindle, _) => {
                    self.power = spindle_s.unwrap_or(self.power);
                    self.spindle = line.of(Group::Spindle).unwrap_or(self.spindle);
                }
                (LaserCommand::Fan, Some(told @ (Code::FanOn | Code::FanOff))) => {
                    self.power = line.number(b'S').unwrap_or(full);
                    self.spindle = if told == Code::FanOn { Code::Constant } else { Code::SpindleOff };
                }
                (LaserCommand::M4, Some(Code::LaserPower)) => {
                    (self.power, self.spindle) = (line.bare, Code::Constant);
                }
                _ => {}
            },
            PenConvention::Height { .. } | PenConvention::Motion => {}
        }
    }

    pub(super) fn set_pen<C: Complaint>(&mut self, down: bool, options: &ReadOptions, out: &mut Outcomes<C>) {
        if down == self.pen_down {
            return;
        }
        if !down {
            self.leave_dot(options, out);
            self.lift_owed = self.on_sheet;
        }
        (self.pen_down, self.dot_owed, self.settling) = (down, down, true);
    }

    /// Share of its power with which the laser burns while it moves as it does now.
    pub(super) fn share(&self, options: &ReadOptions) -> f64 {
        let PenConvention::Laser { command, full } = options.pen else { return 0.0 };
        let is_dark = command == LaserCommand::Spindle && matches!(self.motion, Code::Rapid | Code::NoMotion);
        if self.spindle == Code::SpindleOff || is_dark {
            return 0.0;
        }
        let share = self.power / full;
        if share > 0.0 { share.min(1.0) } else { 0.0 }
    }

    /// What becomes of a laser at the end of a line: switched on and off without a movement between it leaves
    /// a dot.
    pub(super) fn switch_laser<C: Complaint>(
        &mut self,
        moved: bool,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) {
        let share = self.share(options);
        if !moved && self.beam != share {
            // What it has burnt while it stood, it has burnt with the power that it had.
            self.leave_dot(options, out);
            let begins = self.beam == 0.0;
            self.dot_owed = begins && self.spindle == Code::Constant;
            // A laser needs no time to go out.
            self.settling = begins;
            // What draws a laser's text with a pen lifts it.
            self.lift_owed |= self.on_sheet && self.spindle == Code::SpindleOff;
        }
        self.beam = share;
    }

    pub(in crate::gcode) fn leave_dot<C: Complaint>(&mut self, options: &ReadOptions, out: &mut Outcomes<C>) {
        if core::mem::take(&mut self.dot_owed) {
            self.tell_share(self.beam, options, out);
            self.give(PlotOp::Draw { to: self.at, feed_mm_s: self.feed_mm_s }, out);
        }
    }

    /// As [`LineInterpreter::put_down`](super::LineInterpreter::put_down).
    pub(in crate::gcode) fn put_down(&mut self) -> Option<PlotOp> {
        // That of a laser stays: it would burn.
        if !(self.pen_down && self.dot_owed) {
            return None;
        }
        self.dot_owed = false;
        Some(PlotOp::Draw { to: self.at, feed_mm_s: None })
    }

    pub(super) fn tell_share<C: Complaint>(
        &mut self,
        share: f64,
        options: &ReadOptions,
        out: &mut Outcomes<C>,
    ) {
        if matches!(options.pen, PenConvention::Laser { .. }) && self.told_share != Some(share) {
            self.told_share = Some(share);
            self.give(PlotOp::LaserPower { share }, out);
        }
    }
}
