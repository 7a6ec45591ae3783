//! What a host hears: answers to lines, greetings, alarms, and where the machine is.

use super::super::MachineNotice;
use super::super::language::{Answer, Doing, Language, OpText};
use super::super::line_queue::Purpose;
use super::{Earlier, LineHost, MOST_ASKS, Phase, RESTS_FOR_LOST, Then};
use crate::{Pen, PlotOp, Point};
use core::time::Duration;

impl<L: Language, I: Iterator<Item = PlotOp>> LineHost<L, I> {
    pub(super) fn line(&mut self, now: Duration) {
        let answer = core::mem::take(&mut self.answer);
        let is_cut = core::mem::take(&mut self.answer_is_cut);
        self.heard = Some(now);
        self.has_tried = false;
        if core::mem::take(&mut self.is_silent) {
            self.notice(MachineNotice::HeardAgain);
        }
        if is_cut {
            self.notice(MachineNotice::Garbled);
            return;
        }
        let words = answer.as_bytes().trim_ascii();
        if words.is_empty() {
            return; // GRBL begins its greeting with one
        }
        match self.language.hear(words) {
            Answer::Taken => {
                if let Some(purpose) = self.queue.answer() {
                    self.taken(purpose, None);
                }
            }
            Answer::Refused(code) => {
                if let Some(purpose) = self.queue.answer() {
                    self.taken(purpose, Some(code));
                }
            }
            Answer::Again(number) => {
                self.hear_out(now);
                self.again(number);
            }
            Answer::Doubtful(code) if self.language.complains_of(self.queue.oldest_bytes()) => {
                if let Some(purpose) = self.queue.answer() {
                    self.taken(purpose, Some(code));
                }
            }
            Answer::Doubtful(_) => {
                self.hear_out(now);
                self.queue.again_from(self.queue.oldest());
                self.notice(MachineNotice::SentAgain);
            }
            Answer::Complains(code) => {
                self.notice(MachineNotice::Refused { op: None, code });
                if matches!(self.phase, Phase::Drawing(_)) {
                    self.phase = Phase::Drawing(Some(0));
                }
            }
            // (of a stop that was asked for it is no news)
            Answer::Alarm(_) if self.phase == Phase::Stopped => self.forget(),
            Answer::Alarm(code) => {
                self.notice(MachineNotice::Alarm { code });
                self.forget();
                self.phase = Phase::Locked(code);
            }
            Answer::Greeting => self.greeted(),
            Answer::Report(report) => self.report(now, report.doing, report.at),
            Answer::Busy | Answer::Known => {
                if self.phase == Phase::Unheard {
                    self.first_heard();
                }
            }
            Answer::Unknown => self.notice(MachineNotice::Garbled),
        }
    }

    pub(super) fn taken(&mut self, purpose: Purpose, is_refused: Option<u16>) {
        self.rests = 0;
        self.stirred = self.stirred.max(self.heard.unwrap_or_default());
        if let Some(code) = is_refused {
            let op = if let Purpose::Drawing { op, .. } = purpose { Some(op) } else { None };
            self.notice(MachineNotice::Refused { op, code });
            if op.is_some() && matches!(self.phase, Phase::Drawing(_)) {
                self.phase = Phase::Drawing(Some(0)); // what is on its way is drawn, then the pen is lifted
            }
        }
        match purpose {
            Purpose::Drawing { op, ends: true } if L::ANSWERS_WHEN_DONE => self.trail.finish_to(op),
            // It says nothing of itself that is understood, but it answers.
            Purpose::Question if self.phase == Phase::Unheard && self.queue.is_out() => {
                self.phase = Phase::Ready;
            }
            Purpose::Rest => {
                if let Phase::Ending(then, is_answered) = &mut self.phase {
                    *is_answered = true;
                    let then = *then;
                    match L::QUERY {
                        // The next report is of the place at rest.
                        Some(query) => self.urgent(query),
                        None if L::RESTS_BY_REPORT => {}
                        // An answer that came wrong is asked for again.
                        None if !self.is_told && self.asks < MOST_ASKS => {
                            self.asks += 1;
                            self.phase = Phase::Ending(then, false);
                            let mut text = OpText::default();
                            self.language.rest(&mut text);
                            self.push(&text, Purpose::Rest);
                        }
                        None => self.rested(then, self.at.filter(|_| self.is_told)),
                    }
                }
            }
            Purpose::Homing => {
                if let Phase::Homing(was_paused) = self.phase {
                    let is_done = is_refused.is_none();
                    self.knows_place |= is_done;
                    self.phase = if is_done { Self::waiting(was_paused) } else { Phase::Locked(0) };
                }
            }
            Purpose::Unlocking if is_refused.is_none() => {
                if matches!(self.phase, Phase::Locked(_) | Phase::Stopped) {
                    self.wait();
                }
            }
            _ => {}
        }
    }

    pub(super) fn report(&mut self, now: Duration, doing: Option<Doing>, at: Option<Point>) {
        self.at = at.or(self.at);
        self.is_told |= at.is_some();
        self.led = self.led.filter(|&asks| asks == 0 || at.is_none());
        if self.phase == Phase::Unheard {
            self.first_heard();
        }
        match (doing, self.phase) {
            (Some(Doing::Locked), Phase::Locked(_) | Phase::Stopped | Phase::Homing(_)) => {}
            (Some(Doing::Locked), _) => {
                self.forget();
                self.phase = Phase::Locked(0);
            }
            // Its greeting came wrong.
            (Some(Doing::Idle), Phase::Forgetting) => self.greeted(),
            (Some(Doing::Held), Phase::Braking) => {
                if let Some((_, forget)) = L::HOLD {
                    if let Some(at) = at {
                        self.trail.is_at(at);
                    }
                    self.urgent.clear();
                    self.urgent(forget);
                    self.phase = Phase::Forgetting;
                }
            }
            (Some(Doing::Idle), Phase::Ending(then, is_answered))
                if !self.is_interrupted && (is_answered || (L::RESTS_BY_REPORT && self.queue.is_out())) =>
            {
                self.rested(then, at);
            }
            (_, Phase::Drawing(_) | Phase::Braking | Phase::Ending(..)) => {
                if let Some(at) = at {
                    self.trail.is_at(at);
                }
            }
            _ => {}
        }
        let rests = matches!(doing, Some(Doing::Idle | Doing::Locked | Doing::Held));
        if rests && self.phase != Phase::Forgetting {
            self.settle(at.or(self.at));
        }
        self.rests = if doing == Some(Doing::Idle) { self.rests.saturating_add(1) } else { 0 };
        if self.rests > 0 && self.queue.in_flight().lines == 0 {
            (self.jogs, self.ends_jog) = (false, false);
        }
        if self.ends_jog
            && doing == Some(Doing::Moves)
            && let Some(byte) = L::END_JOG
        {
            self.urgent(byte);
        }
        let stands_for = self.language.stands_for().max(self.longest_dwell);
        let stands = now.saturating_sub(self.stirred) > stands_for && self.rests >= RESTS_FOR_LOST;
        if stands && L::QUERY.is_some() && self.queue.in_flight().lines > 0 {
            // It waits, and so has taken all that it will take.
            self.notice(MachineNotice::AnswerLost);
            while let Some(purpose) = self.queue.answer() {
                self.taken(purpose, None);
            }
        }
        self.resume();
    }

    pub(super) fn greeted(&mut self) {
        self.notice(MachineNotice::Greeted);
        if L::GREETS_AT_ORIGIN {
            self.at = Some(Point::ORIGIN);
            self.knows_place &= self.index == 0;
        }
        match self.phase {
            Phase::Unheard => self.first_heard(),
            Phase::Forgetting => {
                self.forget();
                self.settle(self.at);
                self.end(Then::Pause);
            }
            Phase::Drawing(_) | Phase::Braking | Phase::Ending(..) | Phase::Homing(_) => {
                self.forget();
                let op = self.trail.done();
                self.notice(MachineNotice::Restarted { op });
                self.knows_place = false;
                self.phase = Phase::Stopped;
            }
            Phase::Ready => {
                self.forget();
                self.first_heard();
            }
            Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted => {
                self.forget();
                self.notice(MachineNotice::Restarted { op: self.trail.done() });
                self.knows_place = false;
            }
            Phase::Done => self.forget(),
            Phase::Stopped | Phase::Locked(_) => self.forget(),
        }
    }

    pub(super) fn first_heard(&mut self) {
        self.phase = Phase::Ready;
        let mut text = OpText::default();
        self.language.questions(&mut text);
        self.push(&text, Purpose::Question);
    }

    /// Operations that an earlier host may have sent, up to the next change of what is in the machine: it
    /// rested there. That change, if it was not made for certain.
    fn take_earlier(&mut self, earlier: Earlier) -> Option<Then> {
        while self.index < earlier.sent {
            let op = self.ops.next()?;
            let index = self.index;
            self.index = self.index.saturating_add(1);
            let change = match op {
                PlotOp::SelectPen { pen } if !L::CHANGES_PENS => {
                    self.holder.replace(pen).filter(|before| *before != pen).map(|_| Then::Pen(pen))
                }
                PlotOp::NewPage => Some(Then::Sheet),
                _ => {
                    if !self.trail.push(index, op) {
                        return None;
                    }
                    if self.index <= earlier.done {
                        self.trail.finish_all();
                    }
                    continue;
                }
            };
            if change.is_some() && index >= earlier.done {
                return change;
            }
        }
        None
    }

    /// Finds where an earlier host has left the drawing.
    pub(super) fn resume(&mut self) {
        let (Some(earlier), Some(at)) = (self.earlier, self.at) else { return };
        if L::QUERY.is_some() && self.rests < 2 {
            return; // it draws what it has
        }
        self.earlier = None;
        let is_found = loop {
            let change = self.take_earlier(earlier);
            if self.trail.rests_at(at, self.rest_within_mm()) {
                self.after = change;
                break true;
            }
            // It is not before the change of pens, and so behind it: all before is drawn.
            if change.is_none() {
                break false;
            }
            self.trail.finish_all();
        };
        self.sent_ops = self.index;
        if !is_found {
            self.notice(MachineNotice::NotResumed { told: at });
            self.knows_place = false;
        }
        self.phase = Phase::Paused;
    }

    /// All that was sent is drawn, and the machine says where it stands.
    pub(super) fn rested(&mut self, then: Then, at: Option<Point>) {
        let wanted = self.trail.sent_end();
        self.trail.finish_sent();
        if let Some(told) = at.filter(|_| self.knows_place) {
            let off = told - wanted;
            if off.x.abs().max(off.y.abs()) > self.rest_within_mm() {
                self.notice(MachineNotice::Elsewhere { wanted, told });
            }
        }
        self.phase = match then {
            Then::Pause => Phase::Paused,
            Then::Pen(pen) => Phase::PenWanted(pen),
            Then::Sheet => Phase::SheetWanted,
            Then::Done => Phase::Done,
        };
    }

    /// How far from where it was led the machine may say to rest: two steps, where it tells how long they
    /// are.
    pub(super) fn rest_within_mm(&self) -> f64 {
        let [x, y] = self.language.limits().steps_per_mm;
        match (x, y) {
            (Some(x), Some(y)) => (2.0 / x.min(y)).min(self.settings.rest_within_mm),
            _ => self.settings.rest_within_mm,
        }
    }

    /// The machine has forgotten all that it was sent.
    pub(super) fn forget(&mut self) {
        self.interrupt_ending();
        (self.jogs, self.ends_jog) = (false, false);
        self.queue.clear();
        self.language.begin();
        self.language.count_anew();
        self.pen = Pen::Up;
        self.is_interrupted |= self.trail.under_way() > 0;
        if L::QUERY.is_none() {
            self.settle(self.at);
        }
        self.language.holds(self.trail.sent_holds());
    }

    /// What was to come at the end comes when the drawing has gone on.
    pub(super) fn interrupt_ending(&mut self) {
        if let Phase::Ending(then, _) = self.phase
            && then != Then::Pause
        {
            self.after = Some(then);
        }
    }

    /// The machine rests here after it was interrupted.
    pub(super) fn settle(&mut self, at: Option<Point>) {
        if !core::mem::take(&mut self.is_interrupted) {
            return;
        }
        let at = at.unwrap_or_else(|| self.trail.sent_end());
        self.trail.is_at(at);
        self.trail.interrupted_at(at);
    }
}
