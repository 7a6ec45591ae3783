//! What the host of an EBB sends: settings, the moves of the drawing, what takes back an error.

use super::super::MachineNotice;
use super::{BESIDE_MM, CORRECTION_HZ, ENABLING, EbbHost, LEAST_REST, Phase, Purpose, Then};
use crate::kinematics::Kinematics;
use crate::protocol::ebb::{EbbCommand, EbbEvent};
use crate::{Pen, PlotOp, StepPoint};

impl<K: Kinematics + Clone, I: Iterator<Item = PlotOp>> EbbHost<K, I> {
    /// The next line, if there is one for now.
    pub(super) fn write(&mut self) {
        if self.line.is_some() || self.write_by_hand() {
            return;
        }
        match self.phase {
            Phase::Unheard(sent) => self.write_setting(sent),
            Phase::Drawing(_) | Phase::Ending(_) | Phase::Lifted(_) => self.write_motion(),
            Phase::Asking => self.send(Purpose::Where, format_args!("QS")),
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted | Phase::Done => {
                if let Some(to) = self.goes_to.take() {
                    let _ = self.move_by_hand(to, self.hand_mm_s()); // (it was looked at when it was asked for)
                }
            }
            Phase::Stopped => {}
        }
    }

    /// The next piece of a way by hand; says whether there is one.
    pub(super) fn write_by_hand(&mut self) -> bool {
        let Some(way) = &mut self.way else { return false };
        let ((duration_ms, steps, at), is_last) = way.next();
        if is_last {
            self.way = None;
        }
        self.by_hand = at;
        self.send_command(Purpose::ByHand, EbbCommand::Constant { duration_ms, steps });
        true
    }

    pub(super) fn write_setting(&mut self, sent: u8) {
        let [up, down] = self.settings.servo;
        let [rate_up, rate_down] = self.settings.servo_rates;
        let setting = Purpose::Setting;
        match sent {
            0 => self.send(Purpose::Version, format_args!("V")),
            1 => self.send(setting, format_args!("SC,4,{up}")),
            2 => self.send(setting, format_args!("SC,5,{down}")),
            3 => self.send(setting, format_args!("SC,11,{rate_up}")),
            4 => self.send(setting, format_args!("SC,12,{rate_down}")),
            // Switching the motors on counts their steps from 0: not where an earlier host has left off.
            ENABLING if self.earlier.is_none() => {
                let mode = self.settings.step_mode.clamp(1, 5);
                self.send_command(setting, EbbCommand::Enable { mode });
            }
            // What the board has in its queue is drawn once the second wait is taken.
            5 | 6 => self.send(setting, format_args!("SM,1,0,0")),
            7 => self.send(Purpose::Where, format_args!("QS")),
            _ => self.send_command(setting, EbbCommand::Pen { pen: Pen::Up, duration_ms: self.settle_ms() }),
        }
    }

    pub(super) fn write_motion(&mut self) {
        if let Some((place, true)) = self.rest {
            self.rest = None;
            self.send(Purpose::Rest(place), format_args!("QS"));
            return;
        }
        let Some((command, made)) = self.next.take().or_else(|| self.next_command()) else { return };
        if matches!(command, EbbCommand::Pen { .. })
            && let Some(back) = self.correction()
        {
            // At a rest, before the pen moves.
            self.next = Some((command, made));
            self.send_command(Purpose::Motion(self.motion_led()), back);
            return;
        }
        let is_lifted = matches!(command, EbbCommand::Pen { pen: Pen::Up, .. });
        if is_lifted && self.settings.motion.pen_settle >= LEAST_REST {
            self.rest = Some((made, false));
        }
        self.send_command(Purpose::Motion(made), command);
    }

    /// What takes back what a damaged line did, if something is to be taken back.
    pub(super) fn correction(&mut self) -> Option<EbbCommand> {
        let StepPoint { x, y } = core::mem::take(&mut self.correction);
        let steps = x.unsigned_abs().max(y.unsigned_abs());
        let duration_ms = (u64::from(steps) * 1_000 / u64::from(CORRECTION_HZ)).clamp(10, 1_000_000);
        let duration_ms = u32::try_from(duration_ms).unwrap_or(u32::MAX);
        (steps > 0).then_some(EbbCommand::Constant { duration_ms, steps: [x, y] })
    }

    /// Where the motors were led last.
    pub(super) fn motion_led(&self) -> StepPoint {
        let [last, ..] = self.led;
        last
    }

    /// The next command of the drawing; what is no command changes the phase.
    pub(super) fn next_command(&mut self) -> Option<(EbbCommand, StepPoint)> {
        loop {
            match self.motion.next_event() {
                Some(EbbEvent::Command(command)) => return Some((command, self.motion.made())),
                Some(EbbEvent::SelectPen(pen)) => {
                    // The pen that draws first is in the holder already.
                    if self.holder.replace(pen).is_some_and(|before| before != pen) {
                        self.phase = Phase::PenWanted(pen);
                        return None;
                    }
                    continue;
                }
                Some(EbbEvent::NewPage) => {
                    self.phase = Phase::SheetWanted;
                    return None;
                }
                None => {}
            }
            self.fill();
            match self.planner.next_action() {
                Some(action) => {
                    let _ = self.motion.push(action); // its events have all been taken
                }
                None if !self.rests() => return None,
                None => {}
            }
        }
    }

    /// Nothing more is planned: says whether another command comes of it at once.
    pub(super) fn rests(&mut self) -> bool {
        self.motion.rest();
        if !self.motion.is_idle() {
            return true;
        }
        match self.phase {
            Phase::Drawing(_) if self.is_over => {
                self.phase = Phase::Ending(Then::Done);
                true
            }
            Phase::Ending(then) => {
                self.phase = Phase::Lifted(then);
                let made = self.motion.made();
                if then == Then::Pause {
                    self.held = Some((self.pen, made));
                }
                self.by_hand = made;
                if self.pen == Pen::Down {
                    let lift = EbbCommand::Pen { pen: Pen::Up, duration_ms: self.settle_ms() };
                    self.next = Some((lift, made));
                }
                false
            }
            Phase::Lifted(then) if self.next.is_none() => {
                if self.rest.is_some() {
                    // Another wait behind the pen's: once that is taken, the pen's runs, and the motors
                    // stand.
                    let wait = EbbCommand::Constant { duration_ms: 1, steps: [0; 2] };
                    self.next = Some((wait, self.motion.made()));
                    return false;
                }
                if let Some(back) = self.correction() {
                    self.next = Some((back, self.motion.made()));
                    return false;
                }
                self.phase = match then {
                    Then::Pause => Phase::Paused,
                    Then::Done => {
                        self.trail.finish_sent();
                        Phase::Done
                    }
                };
                false
            }
            _ => false,
        }
    }

    /// Operations into the planner.
    pub(super) fn fill(&mut self) {
        while let Phase::Drawing(left) = self.phase
            && self.planner.has_room()
            && !self.is_over
        {
            if left == Some(0) {
                self.phase = Phase::Ending(Then::Pause);
                let _ = self.planner.rest(); // there is room
                return;
            }
            let given = match self.trail.next() {
                Some(given) => given,
                None => {
                    let Some(op) = self.ops.next() else {
                        self.is_over = true;
                        let _ = self.planner.finish(); // there is room
                        return;
                    };
                    let index = self.index;
                    self.index = self.index.saturating_add(1);
                    if !self.trail.push(index, op) {
                        return;
                    }
                    continue;
                }
            };
            // After a stop beside its way an operation begins anew.
            let is_drawn = matches!(given.op, PlotOp::Draw { .. } | PlotOp::DrawArc { .. });
            if is_drawn && self.planner.position().distance(given.from) > BESIDE_MM {
                let _ = self.planner.push(PlotOp::Travel { to: given.from }); // there is room
                if !self.planner.has_room() {
                    return;
                }
            }
            if self.planner.push(given.op).is_err() {
                self.notice(MachineNotice::LeftOut { op: given.index });
            }
            self.trail.send();
            self.sent_ops = given.index.saturating_add(1);
            if given.op.target().is_some() {
                self.phase = Phase::Drawing(left.map(|left| left - 1));
            }
        }
    }
}
