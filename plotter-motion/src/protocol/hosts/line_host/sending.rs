//! What a host sends: operations in lines, lines again, questions for room.

use super::super::language::{Language, OpText};
use super::super::line_queue::{MOST_LINE, Purpose};
use super::super::{MachineNotice, Words};
use super::{HAND_RESTS_AFTER, HEARS_OUT, LineHost, MOST_ASKS, MOST_STRAYS, Phase, QUESTIONS_FOR_REST, Then};
use crate::{Pen, PlotOp};
use core::time::Duration;

impl<L: Language, I: Iterator<Item = PlotOp>> LineHost<L, I> {
    /// Puts text on the queue, line by line; says whether all of it found room.
    pub(super) fn push(&mut self, text: &OpText, purpose: Purpose) -> bool {
        let bytes = text.as_bytes();
        let lines = bytes.split_inclusive(|&byte| byte == b'\n');
        let count = lines.clone().count();
        let first = self.queue.next_number();
        let framed = |place: usize, line: &[u8]| {
            let mut out = Words::<MOST_LINE>::default();
            self.language.frame(first.saturating_add(place as u64), line, &mut out).then_some(out)
        };
        let is_room = lines.clone().enumerate().all(|(place, line)| framed(place, line).is_some());
        if count > self.queue.room() || !is_room {
            return false;
        }
        for (place, line) in lines.enumerate() {
            let purpose = match purpose {
                Purpose::Drawing { op, .. } => Purpose::Drawing { op, ends: place + 1 == count },
                Purpose::Rest if place + 1 < count => Purpose::ByHand,
                other => other,
            };
            let mut out = Words::<MOST_LINE>::default();
            self.language.frame(first.saturating_add(place as u64), line, &mut out);
            self.queue.push(out.as_bytes(), purpose);
        }
        self.rests = 0;
        true
    }

    /// Writes operations until there is enough on the way.
    pub(super) fn write(&mut self) {
        while let Phase::Drawing(left) = self.phase {
            if self.has_room().is_err() {
                return;
            }
            let given = match self.trail.next() {
                Some(given) => given,
                None => match self.take_op(left) {
                    Some(()) => continue,
                    None => return,
                },
            };
            let mut text = OpText::default();
            match self.language.write(given.op, &mut text) {
                Ok(()) if text.as_bytes().is_empty() => {
                    self.sent_ops = given.index.saturating_add(1);
                    self.trail.send();
                }
                Ok(()) => {
                    if !self.push(&text, Purpose::Drawing { op: given.index, ends: true }) {
                        self.notice(MachineNotice::LeftOut { op: given.index });
                    }
                    match given.op {
                        PlotOp::Dwell { duration } => self.longest_dwell = self.longest_dwell.max(duration),
                        PlotOp::Travel { .. } => self.pen = Pen::Up,
                        PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => self.pen = Pen::Down,
                        _ => {}
                    }
                    self.trail.send();
                    self.sent_ops = given.index.saturating_add(1);
                }
                Err(_) => {
                    self.notice(MachineNotice::LeftOut { op: given.index });
                    self.trail.send();
                }
            }
        }
    }

    /// The next operation of the drawing, into the trail; `None` if nothing comes now.
    pub(super) fn take_op(&mut self, left: Option<u32>) -> Option<()> {
        if left == Some(0) {
            self.end(Then::Pause);
            return None;
        }
        if let Some(then) = self.after.take() {
            self.end(then);
            return None;
        }
        let (index, op) = match self.change.take() {
            Some(changed) => changed,
            None => {
                let Some(op) = (if self.is_over { None } else { self.ops.next() }) else {
                    self.is_over = true;
                    self.end(Then::Done);
                    return None;
                };
                let index = self.index;
                self.index = self.index.saturating_add(1);
                let wanted = match op {
                    PlotOp::SelectPen { pen } if !L::CHANGES_PENS && pen > 0 && self.holder != Some(pen) => {
                        // The pen that draws first is in the holder already.
                        self.holder.replace(pen).map(|_| Then::Pen(pen))
                    }
                    PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => {
                        self.holder.get_or_insert(0);
                        None
                    }
                    PlotOp::NewPage => Some(Then::Sheet),
                    _ => None,
                };
                if let Some(then) = wanted {
                    self.sent_ops = self.index;
                    self.end(then);
                    return None;
                }
                if matches!(op, PlotOp::SelectPen { .. }) && !L::CHANGES_PENS {
                    self.sent_ops = self.index;
                    return Some(());
                }
                (index, op)
            }
        };
        if !self.trail.push(index, op) {
            self.change = Some((index, op));
            return None;
        }
        if let Phase::Drawing(Some(left)) = &mut self.phase {
            *left = left.saturating_sub(1);
        }
        Some(())
    }

    /// What the machine cannot have seen yet comes when the drawing goes on.
    pub(super) fn hold_back(&mut self) {
        if let Some(op) = self.queue.drop_unsent() {
            self.trail.unsend_from(op);
            self.sent_ops = op;
        }
        self.language.unsaid();
        self.language.holds(self.trail.sent_holds());
    }

    /// Lifts the pen behind what was sent, or where it was interrupted, and waits until all is done.
    pub(super) fn end(&mut self, then: Then) {
        let is_elsewhere = self.is_interrupted || !self.knows_place;
        let here = self.at.filter(|_| is_elsewhere).unwrap_or_else(|| self.trail.sent_end());
        let mut text = OpText::default();
        let mut lift = OpText::default();
        let lifted = self.language.lift(here, &mut lift).is_ok();
        self.language.rest(&mut text);
        let room = lifted && self.push(&lift, Purpose::ByHand);
        if room && self.push(&text, Purpose::Rest) {
            (self.asks, self.is_told) = (1, false);
            self.pen = Pen::Up;
            self.phase = Phase::Ending(then, false);
        }
    }

    /// The machine has taken all lines before this one, and wants it.
    pub(super) fn again(&mut self, number: u64) {
        while let Some(purpose) = self.queue.take_before(number) {
            self.taken(purpose, None);
        }
        if self.queue.again_from(number) {
            self.strays = 0;
            self.notice(MachineNotice::SentAgain);
        } else if self.strays < MOST_STRAYS {
            // The number came wrong, or it is that of an earlier host, whose lines were not heard of yet.
            self.strays += 1;
            self.queue.again_from(self.queue.oldest());
            self.notice(MachineNotice::SentAgain);
        } else {
            self.strays = 0;
            self.greeted();
        }
    }

    /// Lines go out again when all that is said of those on the way is heard: nothing is under way then, so
    /// that answers to what was dropped answer nothing. A line that was begun ends, lest the next be a part
    /// of it.
    pub(super) fn hear_out(&mut self, now: Duration) {
        self.hears_until = Some(now.saturating_add(HEARS_OUT));
        if self.queue.next().is_some_and(|(_, _, is_begun)| is_begun) {
            self.urgent(b'\n');
        }
    }

    /// Nothing was heard for too long: says so, unless a line that goes out again is answered.
    pub(super) fn overdue(&mut self, now: Duration) {
        let resends = L::IS_NUMBERED && self.queue.in_flight().lines > 0;
        if resends {
            self.queue.again_from(self.queue.oldest());
        } else if self.lacks_report() {
            let mut text = OpText::default();
            self.language.rest(&mut text);
            self.push(&text, Purpose::Rest);
        }
        self.spoke = Some(now);
        if resends && !core::mem::replace(&mut self.has_tried, true) {
            return;
        }
        if !core::mem::replace(&mut self.is_silent, true) {
            self.notice(MachineNotice::Silent);
        }
    }

    /// Asks for room as long as a line is not answered, and, lest the silence be taken for one, until the
    /// place at rest is told.
    pub(super) fn ask_for_room(&mut self, now: Duration) {
        let waits = self.queue.in_flight().lines > 0 || self.lacks_report();
        if L::ROOM_QUERY.is_empty() || !waits || !(self.language.answers_lines() || self.lacks_report()) {
            (self.room_asked, self.rest_questions) = (None, 0);
            return;
        }
        let asked = *self.room_asked.get_or_insert(now);
        if now.saturating_sub(asked) < self.settings.ask_every {
            return;
        }
        self.room_asked = Some(now);
        if !self.language.may_be_silent() {
            L::ROOM_QUERY.iter().for_each(|&byte| self.urgent(byte));
        }
        self.rest_questions = if self.lacks_report() { self.rest_questions.saturating_add(1) } else { 0 };
        if self.rest_questions >= QUESTIONS_FOR_REST {
            self.rest_questions = 0;
            let mut text = OpText::default();
            self.language.rest(&mut text);
            self.push(&text, Purpose::Rest);
        }
    }

    /// When a machine that is not asked all the time is to be asked where its way by hand has ended, if ever.
    pub(super) fn place_due(&self) -> Option<Duration> {
        let is_over = self.queue.is_out() && self.queue.in_flight().lines == 0 && self.is_free().is_ok();
        // (a place that comes some time behind its question is asked for once: questions fill the buffer)
        let most = if L::RESTS_BY_REPORT { 1 } else { MOST_ASKS };
        let is_due = L::QUERY.is_none() && self.led.is_some_and(|asks| asks < most) && is_over;
        is_due.then(|| self.stirred.saturating_add(HAND_RESTS_AFTER))
    }

    /// Whether something by hand is under way, as far as is known.
    pub(super) fn is_led(&self) -> bool {
        let is_asked =
            L::QUERY.is_none() && self.led.is_some_and(|asks| L::RESTS_BY_REPORT || asks < MOST_ASKS);
        self.is_free().is_ok() && (is_asked || !self.queue.is_out() || self.queue.in_flight().lines > 0)
    }

    /// Asks it then.
    pub(super) fn ask_for_place(&mut self, now: Duration) {
        if self.place_due().is_none_or(|due| now < due) {
            return;
        }
        let mut text = OpText::default();
        self.language.place(&mut text);
        if self.push(&text, Purpose::ByHand) {
            self.led = self.led.map(|asks| asks.saturating_add(1));
        }
    }

    /// Whether all is answered, and the place at rest was not told.
    pub(super) fn lacks_report(&self) -> bool {
        L::RESTS_BY_REPORT && matches!(self.phase, Phase::Ending(_, true)) && self.queue.is_out()
    }
}
