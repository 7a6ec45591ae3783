//! [`LineHost`]: the host of a machine that answers lines.

use super::language::{Answer, Doing, Language, OpText};
use super::line_queue::{LineQueue, MOST_LINE, Purpose};
use super::ring::Ring;
use super::trail::Trail;
use super::{HostState, HostStatus, MachineHost, MachineNotice, NotNow, Request, Words};
use crate::{Pen, PlotOp, Point};
use core::time::Duration;

/// Longest line of a machine that is read: GRBL's longest report has about 120 bytes.
const MOST_ANSWER: usize = 192;
/// Notices that wait for [`MachineHost::poll`]; of more the oldest are lost.
const MOST_NOTICES: usize = 16;
/// Bytes past the lines that wait.
const MOST_URGENT: usize = 32;
/// Free lines before an operation is written: two of an arc, three to lower the pen, and the beginning's four.
const ROOM_FOR_OP: usize = 12;
/// So many reports of a machine that waits, one after the other, say that it has taken all that it will.
const RESTS_FOR_LOST: u8 = 4;

/// How a host goes about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineHostSettings {
    /// How often it asks where the machine is, 200 ms by default: GRBL's makers advise 5 to 10 Hz.
    pub ask_every: Duration,
    /// How long it waits for a greeting before it speaks, 2 s by default: opening a port resets many boards.
    pub greeting: Duration,
    /// Silence after which it says so, 5 s by default.
    pub silence: Duration,
    /// How far from where it was led a machine may say to rest, mm on each axis: 0.06 by default, four steps
    /// of a usual plotter and more than a last decimal.
    pub rest_within_mm: f64,
}

impl Default for LineHostSettings {
    fn default() -> Self {
        Self {
            ask_every: Duration::from_millis(200),
            greeting: Duration::from_secs(2),
            silence: Duration::from_secs(5),
            rest_within_mm: 0.06,
        }
    }
}

/// What comes when all that was sent is drawn, and the pen lifted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Then {
    Pause,
    Pen(u8),
    Sheet,
    Done,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Unheard,
    Ready,
    /// So many operations more, if not all.
    Drawing(Option<u32>),
    /// The hold is sent.
    Braking,
    /// The machine is told to forget what it has.
    Forgetting,
    /// Lines that lift the pen, and one that waits for all, are on their way; whether that is answered.
    Ending(Then, bool),
    Paused,
    PenWanted(u8),
    SheetWanted,
    /// Whether it was paused before.
    Homing(bool),
    Stopped,
    Locked(u16),
    Done,
}

/// What an earlier host has left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Earlier {
    done: u64,
    sent: u64,
}

/// Sends a drawing to a machine that speaks a [`Language`], and follows its answers: see
/// [`hosts`](super) for what all hosts do.
///
/// - A pause lifts the pen where it is. A machine that can be held is held at once and told to forget the
///   rest, which is sent again when the drawing goes on; another first draws what it was sent.
/// - At each rest the machine is asked where it stands. In a language without checksums that is the only sign
///   of a number that came wrong.
/// - A machine that greets in the middle has forgotten all: nothing more is sent until a person says that its
///   place is known.
///
/// ```
/// # use plotter_motion::{PlotOp, Point, gcode::WriteOptions};
/// # use plotter_motion::protocol::hosts::{Grbl, HostState, LineHost, LineHostSettings, MachineHost, Request};
/// # use core::time::Duration;
/// let drawing = [PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: Some(20.0) }];
/// let options = WriteOptions { settle: Duration::ZERO, ..WriteOptions::default() };
/// let mut host = LineHost::new(Grbl::new(options), LineHostSettings::default(), drawing.into_iter());
/// let now = Duration::ZERO;
/// b"\r\nGrbl 1.1h ['$' for help]\r\n".iter().for_each(|&byte| host.receive(now, byte));
/// assert_eq!(host.status().state, HostState::Ready);
/// host.ask(now, Request::GoOn)?;
/// host.poll(now);
/// let sent: Vec<u8> = core::iter::from_fn(|| host.next_byte(now)).collect();
/// assert_eq!(String::from_utf8_lossy(&sent), "?$$\nG21\nG90\nM5\nG0 X0 Y0\nM3 S90\nG1 X10 Y0 F1200\nM5\nG0 X10 Y0\nG4 P0\n");
/// # Ok::<(), plotter_motion::protocol::hosts::NotNow>(())
/// ```
#[derive(Clone, Debug)]
pub struct LineHost<L, I> {
    language: L,
    settings: LineHostSettings,
    ops: I,
    /// Number of the next operation of `ops`.
    index: u64,
    /// Whether there are no more.
    is_over: bool,
    /// An operation that changes what is in the machine, before which it must rest.
    change: Option<(u64, PlotOp)>,
    /// What was to come behind what was sent when that was interrupted.
    after: Option<Then>,
    trail: Trail,
    queue: LineQueue,
    urgent: Ring<u8, MOST_URGENT>,
    notices: Ring<MachineNotice, MOST_NOTICES>,
    answer: Words<MOST_ANSWER>,
    answer_is_cut: bool,
    phase: Phase,
    told: HostState,
    at: Option<Point>,
    /// Whether the machine's place is that of the drawing.
    knows_place: bool,
    /// Whether it moves by hand: GRBL refuses all but further such movements until it stands.
    jogs: bool,
    /// Whether what was sent is forgotten, and the place where it ended not told yet.
    is_interrupted: bool,
    pen: Pen,
    holder: Option<u8>,
    sent_ops: u64,
    feed_percent: u8,
    began: Option<Duration>,
    heard: Option<Duration>,
    /// When a line began to go out, after which the machine owes an answer.
    spoke: Option<Duration>,
    is_silent: bool,
    asked: Option<Duration>,
    /// Reports of rest since a line was sent or answered.
    rests: u8,
    earlier: Option<Earlier>,
}

impl<L: Language, I: Iterator<Item = PlotOp>> LineHost<L, I> {
    /// A host with a drawing to send, which waits for [`Request::GoOn`].
    #[must_use]
    pub fn new(language: L, settings: LineHostSettings, ops: I) -> Self {
        Self {
            language,
            settings,
            ops,
            index: 0,
            is_over: false,
            change: None,
            after: None,
            trail: Trail::new(),
            queue: LineQueue::new(),
            urgent: Ring::new(),
            notices: Ring::new(),
            answer: Words::default(),
            answer_is_cut: false,
            phase: Phase::Unheard,
            told: HostState::Unheard,
            at: None,
            knows_place: true,
            jogs: false,
            is_interrupted: false,
            pen: Pen::Up,
            holder: None,
            sent_ops: 0,
            feed_percent: 100,
            began: None,
            heard: None,
            spoke: None,
            is_silent: false,
            asked: None,
            rests: 0,
            earlier: None,
        }
    }

    /// The same, which goes on where an earlier host has left the drawing: so many operations of it were known
    /// to be done, so many may have been sent. Where the machine rests says which.
    #[must_use]
    pub fn resuming(mut self, done: u64, sent: u64) -> Self {
        self.earlier = Some(Earlier { done, sent });
        self
    }

    fn notice(&mut self, notice: MachineNotice) {
        if self.notices.is_full() {
            self.notices.pop();
        }
        let _ = self.notices.push(notice); // there is room
    }

    fn urgent(&mut self, byte: u8) {
        let _ = self.urgent.push(byte); // (who asks faster than the line takes is heard later)
    }

    /// Puts text on the queue, line by line; says whether all of it found room.
    fn push(&mut self, text: &OpText, purpose: Purpose) -> bool {
        let bytes = text.as_bytes();
        let lines = bytes.split_inclusive(|&byte| byte == b'\n');
        if lines.clone().count() > self.queue.room() || lines.clone().any(|line| line.len() > MOST_LINE) {
            return false;
        }
        let count = lines.clone().count();
        for (place, line) in lines.enumerate() {
            let purpose = match purpose {
                Purpose::Drawing { op, .. } => Purpose::Drawing { op, ends: place + 1 == count },
                other => other,
            };
            self.queue.push(line, purpose);
        }
        self.rests = 0;
        true
    }

    /// Writes operations until there is enough on the way.
    fn write(&mut self) {
        while let Phase::Drawing(left) = self.phase {
            if self.queue.room() < ROOM_FOR_OP {
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
    fn take_op(&mut self, left: Option<u32>) -> Option<()> {
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
                    PlotOp::SelectPen { pen } if pen > 0 && self.holder != Some(pen) => {
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
                if matches!(op, PlotOp::SelectPen { .. }) {
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

    /// Lifts the pen behind what was sent, or where it was interrupted, and waits until all is done.
    fn end(&mut self, then: Then) {
        let here = self.at.filter(|_| self.is_interrupted).unwrap_or_else(|| self.trail.sent_end());
        let mut text = OpText::default();
        let mut lift = OpText::default();
        let lifted = self.language.write(PlotOp::Travel { to: here }, &mut lift).is_ok();
        self.language.rest(&mut text);
        let room = lifted && self.push(&lift, Purpose::ByHand);
        if room && self.push(&text, Purpose::Rest) {
            self.pen = Pen::Up;
            self.phase = Phase::Ending(then, false);
        }
    }

    /// All that was sent is drawn, and the machine says where it stands.
    fn rested(&mut self, then: Then, at: Option<Point>) {
        let wanted = self.trail.sent_end();
        self.trail.finish_sent();
        if let Some(told) = at {
            let off = told - wanted;
            if off.x.abs().max(off.y.abs()) > self.settings.rest_within_mm {
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

    /// The machine has forgotten all that it was sent.
    fn forget(&mut self) {
        self.interrupt_ending();
        self.jogs = false;
        self.queue.clear();
        self.language.begin();
        self.pen = Pen::Up;
        self.is_interrupted |= self.trail.under_way() > 0;
        if L::QUERY.is_none() {
            self.settle(self.at);
        }
    }

    /// What was to come at the end comes when the drawing has gone on.
    fn interrupt_ending(&mut self) {
        if let Phase::Ending(then, _) = self.phase
            && then != Then::Pause
        {
            self.after = Some(then);
        }
    }

    /// The machine rests here after it was interrupted.
    fn settle(&mut self, at: Option<Point>) {
        if !core::mem::take(&mut self.is_interrupted) {
            return;
        }
        let at = at.unwrap_or_else(|| self.trail.sent_end());
        self.trail.is_at(at);
        self.trail.interrupted_at(at);
    }

    /// Unlocked, or found again: a pen that is still down is lifted.
    fn wait(&mut self) {
        if self.index > 0 {
            self.end(Then::Pause);
        } else {
            self.phase = Phase::Ready;
        }
    }

    fn taken(&mut self, purpose: Purpose, is_refused: Option<u16>) {
        self.rests = 0;
        if let Some(code) = is_refused {
            let op = if let Purpose::Drawing { op, .. } = purpose { Some(op) } else { None };
            self.notice(MachineNotice::Refused { op, code });
            if op.is_some() && matches!(self.phase, Phase::Drawing(_)) {
                self.phase = Phase::Drawing(Some(0)); // what is on its way is drawn, then the pen is lifted
            }
        }
        match purpose {
            Purpose::Drawing { op, ends: true } if L::ANSWERS_WHEN_DONE => self.trail.finish_to(op),
            Purpose::Rest => {
                if let Phase::Ending(then, is_answered) = &mut self.phase {
                    *is_answered = true;
                    let then = *then;
                    match L::QUERY {
                        // The next report is of the place at rest.
                        Some(query) => self.urgent(query),
                        None => self.rested(then, self.at),
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

    const fn waiting(was_paused: bool) -> Phase {
        if was_paused { Phase::Paused } else { Phase::Ready }
    }

    fn greeted(&mut self) {
        self.notice(MachineNotice::Greeted);
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

    fn first_heard(&mut self) {
        self.phase = Phase::Ready;
        let mut text = OpText::default();
        self.language.questions(&mut text);
        self.push(&text, Purpose::Question);
    }

    fn report(&mut self, doing: Option<Doing>, at: Option<Point>) {
        self.at = at.or(self.at);
        if self.phase == Phase::Unheard {
            self.first_heard();
        }
        match (doing, self.phase) {
            (Some(Doing::Locked), Phase::Locked(_) | Phase::Stopped | Phase::Homing(_)) => {}
            (Some(Doing::Locked), _) => {
                self.forget();
                self.phase = Phase::Locked(0);
            }
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
            (Some(Doing::Idle), Phase::Ending(then, true)) if !self.is_interrupted => self.rested(then, at),
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
            self.jogs = false;
        }
        if self.rests >= RESTS_FOR_LOST && L::QUERY.is_some() && self.queue.in_flight().lines > 0 {
            // It waits, and so has taken all that it will take.
            self.notice(MachineNotice::AnswerLost);
            while let Some(purpose) = self.queue.answer() {
                self.taken(purpose, None);
            }
        }
        self.resume();
    }

    /// Finds where an earlier host has left the drawing.
    fn resume(&mut self) {
        let (Some(earlier), Some(at)) = (self.earlier, self.at) else { return };
        if L::QUERY.is_some() && self.rests < 2 {
            return; // it draws what it has
        }
        self.earlier = None;
        let mut is_room = true;
        while self.index < earlier.sent && is_room {
            let Some(op) = self.ops.next() else { break };
            if let PlotOp::SelectPen { pen } = op {
                self.holder = Some(pen);
            }
            is_room = self.trail.push(self.index, op);
            self.index = self.index.saturating_add(1);
            if self.index <= earlier.done {
                self.trail.send();
                self.trail.finish_sent();
            }
        }
        self.sent_ops = self.index;
        if !is_room || !self.trail.rests_at(at, self.settings.rest_within_mm) {
            self.notice(MachineNotice::NotResumed { told: at });
            self.knows_place = false;
        }
        self.phase = Phase::Paused;
    }

    fn line(&mut self, now: Duration) {
        let answer = core::mem::take(&mut self.answer);
        let is_cut = core::mem::take(&mut self.answer_is_cut);
        self.heard = Some(now);
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
                if self.queue.again_from(number) {
                    self.notice(MachineNotice::SentAgain);
                } else {
                    self.notice(MachineNotice::Garbled);
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
            Answer::Report(report) => self.report(report.doing, report.at),
            Answer::Busy | Answer::Known => {
                if self.phase == Phase::Unheard {
                    self.first_heard();
                }
            }
            Answer::Unknown => self.notice(MachineNotice::Garbled),
        }
    }

    fn go_on(&mut self, left: Option<u32>) -> Result<(), NotNow> {
        match self.phase {
            Phase::Unheard => return Err(NotNow::Unheard),
            Phase::Drawing(Some(_)) => {}
            Phase::Drawing(None) | Phase::Done | Phase::Homing(_) => return Err(NotNow::Nothing),
            Phase::Braking | Phase::Forgetting | Phase::Ending(..) => return Err(NotNow::Busy),
            Phase::Stopped | Phase::Locked(_) => return Err(NotNow::Locked),
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted => {
                if !self.knows_place {
                    return Err(NotNow::PlaceLost);
                }
                if self.is_interrupted {
                    return Err(NotNow::Busy);
                }
                self.language.begin();
                if self.index > 0 {
                    // The pen goes back to where it was lifted.
                    let mut text = OpText::default();
                    let to = self.trail.sent_end();
                    let written = self.language.write(PlotOp::Travel { to }, &mut text).is_ok();
                    if !(written && self.push(&text, Purpose::ByHand)) {
                        return Err(NotNow::Busy);
                    }
                }
            }
        }
        self.phase = Phase::Drawing(left);
        Ok(())
    }

    /// What is asked by hand may be done.
    fn is_free(&self) -> Result<(), NotNow> {
        match self.phase {
            Phase::Unheard => Err(NotNow::Unheard),
            Phase::Stopped | Phase::Locked(_) => Err(NotNow::Locked),
            Phase::Drawing(_) | Phase::Braking | Phase::Forgetting | Phase::Ending(..) | Phase::Homing(_) => {
                Err(NotNow::Draws)
            }
            Phase::Ready | Phase::Paused | Phase::PenWanted(_) | Phase::SheetWanted | Phase::Done => Ok(()),
        }
    }

    /// Text that a person has asked for, if there is a word for it.
    fn by_hand(&mut self, text: &OpText, has_word: bool, purpose: Purpose) -> Result<(), NotNow> {
        match (has_word, self.push(text, purpose)) {
            (true, true) => Ok(()),
            (true, false) => Err(NotNow::Busy),
            (false, _) => Err(NotNow::NoWord),
        }
    }

    fn state(&self) -> HostState {
        match self.phase {
            Phase::Unheard => HostState::Unheard,
            Phase::Ready => HostState::Ready,
            Phase::Drawing(_) => HostState::Drawing,
            Phase::Braking | Phase::Forgetting | Phase::Ending(..) => HostState::Ending,
            Phase::Paused => HostState::Paused,
            Phase::PenWanted(pen) => HostState::PenWanted(pen),
            Phase::SheetWanted => HostState::SheetWanted,
            Phase::Homing(_) => HostState::Homing,
            Phase::Stopped => HostState::Stopped,
            Phase::Locked(code) => HostState::Locked(code),
            Phase::Done => HostState::Done,
        }
    }

    /// Whether the machine owes an answer.
    fn waits(&self) -> bool {
        L::QUERY.is_some() || self.queue.in_flight().lines > 0
    }

    fn patience(&self) -> Duration {
        if L::QUERY.is_some() { self.settings.silence } else { L::PATIENCE.max(self.settings.silence) }
    }

    /// How often it is asked where the machine is: twice as often while something depends on it.
    fn ask_every(&self) -> Duration {
        match self.phase {
            Phase::Braking | Phase::Ending(_, true) => self.settings.ask_every / 4,
            _ => self.settings.ask_every,
        }
    }
}

impl<L: Language, I: Iterator<Item = PlotOp>> MachineHost for LineHost<L, I> {
    fn poll(&mut self, now: Duration) -> Option<MachineNotice> {
        let began = *self.began.get_or_insert(now);
        if let Some(query) = L::QUERY {
            let due = match self.asked {
                Some(asked) => now.saturating_sub(asked) >= self.ask_every(),
                None => self.heard.is_some() || now.saturating_sub(began) >= self.settings.greeting,
            };
            if due && self.phase != Phase::Forgetting {
                self.asked = Some(now);
                self.urgent(query);
            }
        } else if self.phase == Phase::Unheard
            && self.asked.is_none()
            && now.saturating_sub(began) >= self.settings.greeting
        {
            self.asked = Some(now);
            let mut text = OpText::default();
            self.language.questions(&mut text);
            self.push(&text, Purpose::Question);
        }
        let since = self.heard.max(self.spoke).unwrap_or(began);
        if !self.is_silent && self.waits() && now.saturating_sub(since) >= self.patience() {
            self.is_silent = true;
            self.notice(MachineNotice::Silent);
        }
        self.write();
        let state = self.state();
        if state != self.told {
            self.told = state;
            self.notice(MachineNotice::State(state));
        }
        self.notices.pop()
    }

    fn next_byte(&mut self, now: Duration) -> Option<u8> {
        if let Some(byte) = self.urgent.pop() {
            return Some(byte);
        }
        if matches!(self.phase, Phase::Braking | Phase::Forgetting) {
            return None;
        }
        let (bytes, purpose, is_begun) = self.queue.next()?;
        if self.jogs && purpose != Purpose::Jog {
            return None;
        }
        self.jogs |= purpose == Purpose::Jog && L::QUERY.is_some();
        if !is_begun && !self.language.fits(self.queue.in_flight(), bytes) {
            return None;
        }
        if L::QUERY.is_none() && self.queue.in_flight().lines == 0 && !is_begun {
            self.spoke = Some(now);
        }
        self.queue.next_byte()
    }

    fn receive(&mut self, now: Duration, byte: u8) {
        match byte {
            b'\n' => self.line(now),
            b'\r' => {}
            _ => self.answer_is_cut |= !self.answer.push(byte),
        }
    }

    fn next_wake(&self) -> Option<Duration> {
        if !self.urgent.is_empty() || !self.notices.is_empty() {
            return Some(Duration::ZERO);
        }
        let began = self.began?;
        let asks = match (L::QUERY, self.asked) {
            (Some(_), Some(asked)) => asked.saturating_add(self.ask_every()),
            (_, None) => began.saturating_add(self.settings.greeting),
            (None, Some(_)) => Duration::MAX,
        };
        let silent = self.heard.max(self.spoke).unwrap_or(began).saturating_add(self.patience());
        let silent = if self.is_silent || !self.waits() { Duration::MAX } else { silent };
        Some(asks.min(silent)).filter(|&wake| wake < Duration::MAX)
    }

    fn ask(&mut self, _: Duration, request: Request) -> Result<(), NotNow> {
        let mut text = OpText::default();
        match request {
            Request::GoOn => self.go_on(None),
            Request::Next => self.go_on(Some(1)),
            Request::Pause => match (self.phase, L::HOLD) {
                (Phase::Drawing(_) | Phase::Ending(_, false), Some((hold, _)))
                    if self.trail.under_way() > 0 =>
                {
                    self.interrupt_ending();
                    self.urgent(hold);
                    self.urgent(L::QUERY.unwrap_or(hold));
                    self.phase = Phase::Braking;
                    Ok(())
                }
                (Phase::Drawing(_), _) => {
                    self.phase = Phase::Drawing(Some(0));
                    Ok(())
                }
                (Phase::Ending(..) | Phase::Braking | Phase::Forgetting, _) => Ok(()),
                _ => Err(NotNow::Nothing),
            },
            Request::Stop => {
                self.forget();
                self.urgent.clear();
                self.phase = if self.phase == Phase::Unheard { Phase::Unheard } else { Phase::Stopped };
                Ok(())
            }
            Request::Unlock => match self.phase {
                Phase::Locked(_) | Phase::Stopped => {
                    let has_word = self.language.unlock(&mut text);
                    if has_word {
                        self.by_hand(&text, true, Purpose::Unlocking)
                    } else {
                        self.wait();
                        Ok(())
                    }
                }
                _ => Err(NotNow::Nothing),
            },
            Request::Home => {
                let was_paused = match self.phase {
                    Phase::Locked(_) | Phase::Stopped => self.index > 0,
                    Phase::Ready => false,
                    _ => {
                        self.is_free()?;
                        self.index > 0
                    }
                };
                let has_word = self.language.home(&mut text);
                self.by_hand(&text, has_word, Purpose::Homing)?;
                self.phase = Phase::Homing(was_paused);
                Ok(())
            }
            Request::ByHand(op) => {
                self.is_free()?;
                self.language.write(op, &mut text).map_err(|_| NotNow::OutOfRange)?;
                self.by_hand(&text, true, Purpose::ByHand)?;
                self.pen = match op {
                    PlotOp::Draw { .. } | PlotOp::DrawArc { .. } => Pen::Down,
                    PlotOp::Travel { .. } => Pen::Up,
                    _ => self.pen,
                };
                Ok(())
            }
            Request::Jog { by, feed_mm_s } => {
                self.is_free()?;
                if !(by.length() <= 1e6 && feed_mm_s > 0.0 && feed_mm_s <= 1e6) {
                    return Err(NotNow::OutOfRange);
                }
                let has_word = self.language.jog(self.at.unwrap_or_default(), by, feed_mm_s, &mut text);
                self.by_hand(&text, has_word, Purpose::Jog)
            }
            Request::EndJog => {
                self.is_free()?;
                self.urgent(L::END_JOG.ok_or(NotNow::NoWord)?);
                Ok(())
            }
            Request::StandsAt(place) => {
                self.is_free()?;
                if !(place.x.abs() <= 1e6 && place.y.abs() <= 1e6) {
                    return Err(NotNow::OutOfRange);
                }
                let has_word = self.language.stands_at(place, &mut text);
                self.by_hand(&text, has_word, Purpose::ByHand)?;
                self.knows_place = true;
                Ok(())
            }
            Request::Feed { percent } => {
                let percent = percent.clamp(10, 200);
                let made = self.language.feed(self.feed_percent, percent, &mut text).ok_or(NotNow::NoWord)?;
                text.as_bytes().iter().for_each(|&byte| self.urgent(byte));
                self.feed_percent = made;
                Ok(())
            }
            Request::PenDownAt(number) => {
                if self.language.pen_down_at(number) {
                    Ok(())
                } else {
                    Err(NotNow::NoWord)
                }
            }
        }
    }

    fn stop_bytes(&self) -> &'static [u8] {
        L::STOP
    }

    fn status(&self) -> HostStatus {
        HostStatus {
            state: self.state(),
            at: self.at,
            pen: self.trail.pen().unwrap_or(self.pen),
            sent: self.sent_ops,
            done: if self.phase == Phase::Done { self.index } else { self.trail.done() },
            feed_percent: self.feed_percent,
            limits: self.language.limits(),
        }
    }
}
