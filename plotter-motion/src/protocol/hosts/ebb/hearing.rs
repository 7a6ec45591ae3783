//! What the host of an EBB hears: answers to lines, and where the board counts itself to be.

use super::super::MachineNotice;
use super::super::ring::Ring;
use super::answer::Said;
use super::{BEHIND_WHERE, ENABLING, EbbHost, MOST_TRIES, Phase, Purpose, SETTINGS, Then};
use crate::kinematics::Kinematics;
use crate::protocol::ebb::{EbbCommand, EbbDialect};
use crate::{Pen, PlotOp, StepPoint};

/// Changes of pens that are kept of what an earlier host may have sent: each has strokes behind it.
const MOST_PENS: usize = 16;

impl<K: Kinematics + Clone, I: Iterator<Item = PlotOp>> EbbHost<K, I> {
    pub(super) fn hear(&mut self, said: Said) {
        if !self.is_heard {
            self.is_heard = true;
        }
        if core::mem::take(&mut self.is_silent) {
            self.notice(MachineNotice::HeardAgain);
        }
        match (said, self.line.map(|line| line.purpose)) {
            (Said::Version(first, second), Some(Purpose::Version)) => {
                if (first, second) < (2, 7) {
                    self.motion.set_dialect(EbbDialect::Constant);
                }
                self.notice(MachineNotice::Greeted);
                self.taken();
            }
            // What an earlier host has asked for.
            (_, Some(Purpose::Version)) => {}
            (Said::Place(first, second), Some(Purpose::Rest(_) | Purpose::Where)) => {
                self.place = Some(StepPoint::new(first, second));
            }
            (Said::Ok, Some(_)) => self.taken(),
            (Said::Error(code), Some(_)) => self.refused(code),
            // A stop that somebody has written past us.
            (Said::Stopped(_), _) | (Said::Ok | Said::Error(_), None) => {}
            _ => self.notice(MachineNotice::Garbled),
        }
    }

    /// The line in flight is answered.
    pub(super) fn taken(&mut self) {
        let Some(line) = self.line.take() else { return };
        match line.purpose {
            Purpose::Version | Purpose::Setting => self.next_setting(),
            Purpose::Motion(made) => {
                let [last, before, _] = self.led;
                self.led = [made, last, before];
                // With this one in the queue the last one runs, and the one before it is over.
                let at = self.point(before);
                self.trail.is_at(at);
                if let Some((_, asks)) = &mut self.rest {
                    // The pen's own line is the first that is taken; with another behind it the pen moves.
                    if !matches!(line.words.as_bytes(), [b'S', b'P', ..]) {
                        *asks = true;
                    }
                }
            }
            Purpose::Rest(wanted) => self.rested(wanted),
            Purpose::Where => self.found(),
            Purpose::ByHand => {}
        }
    }

    pub(super) fn next_setting(&mut self) {
        if let Phase::Unheard(sent) = self.phase {
            let next = if sent == ENABLING && self.earlier.is_none() { BEHIND_WHERE } else { sent + 1 };
            self.phase = if next < SETTINGS { Phase::Unheard(next) } else { Phase::Ready };
        }
    }

    /// The board has said where it is at a rest.
    pub(super) fn rested(&mut self, wanted: StepPoint) {
        let Some(told) = self.place.take() else { return };
        let told = StepPoint::new(told.x.wrapping_sub(self.zero.x), told.y.wrapping_sub(self.zero.y));
        let off = StepPoint::new(wanted.x.wrapping_sub(told.x), wanted.y.wrapping_sub(told.y));
        let most = u32::from(self.settings.rest_within_steps);
        if off.x.unsigned_abs() <= most && off.y.unsigned_abs() <= most {
            let at = self.point(wanted);
            self.trail.is_at(at);
            return;
        }
        self.damaged = self.damaged.saturating_add(1);
        self.correction = off;
        let (wanted, told) = (self.point(wanted), self.point(told));
        self.notice(MachineNotice::Elsewhere { wanted, told });
    }

    /// The board has said where it stands, of which nothing is known.
    pub(super) fn found(&mut self) {
        let Some(told) = self.place.take() else { return };
        let at = StepPoint::new(told.x.wrapping_sub(self.zero.x), told.y.wrapping_sub(self.zero.y));
        if let (Phase::Unheard(_), Some((done, sent))) = (self.phase, self.earlier.take()) {
            // Pens that were selected behind what was done for certain: in the holder, if what follows was
            // drawn.
            let mut pens = Ring::<(u64, u8), MOST_PENS>::new();
            while self.index < sent
                && let Some(op) = self.ops.next()
            {
                if let PlotOp::SelectPen { pen } = op {
                    if pens.is_full() {
                        self.holder = pens.pop().map(|(_, pen)| pen);
                    }
                    let _ = pens.push((self.index, pen)); // there is room
                }
                if !self.trail.push(self.index, op) {
                    break;
                }
                self.trail.send();
                self.index += 1;
                if self.index <= done {
                    self.trail.finish_first();
                }
            }
            self.sent_ops = self.index;
            let place = self.point(at);
            if self.trail.is_at(place) {
                self.trail.interrupted_at(place);
            } else if self.trail.under_way() > 0 {
                self.notice(MachineNotice::NotResumed { told: place });
            }
            while pens.get(0).is_some_and(|(index, _)| *index < self.trail.done()) {
                self.holder = pens.pop().map(|(_, pen)| pen);
            }
            self.restart_at(at);
            self.next_setting();
            return;
        }
        let place = self.point(at);
        self.trail.is_at(place);
        self.trail.interrupted_at(place);
        self.restart_at(at);
        self.phase = Phase::Lifted(Then::Pause);
        self.next = Some((EbbCommand::Pen { pen: Pen::Up, duration_ms: self.settle_ms() }, at));
    }

    /// The motors stand here with nothing under way.
    pub(super) fn restart_at(&mut self, at: StepPoint) {
        self.motion.stand_at(at);
        self.planner.clear(self.point(at));
        self.led = [at; 3];
        self.by_hand = at;
        self.held = None;
        self.rest = None;
        self.next = None;
        self.correction = StepPoint::default();
        self.is_over = false;
    }

    pub(super) fn refused(&mut self, code: u16) {
        let op =
            matches!(self.line.map(|line| line.purpose), Some(Purpose::Motion(_))).then(|| self.trail.done());
        match &mut self.line {
            Some(line) if line.tries < MOST_TRIES => {
                (line.sent, line.tries) = (0, line.tries + 1);
                self.notice(MachineNotice::SentAgain);
            }
            _ => {
                self.notice(MachineNotice::Refused { op, code });
                self.taken();
                if let Phase::Drawing(_) = self.phase {
                    self.pause();
                }
            }
        }
    }
}
