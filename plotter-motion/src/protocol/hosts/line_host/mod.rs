//! [`LineHost`]: the host of a machine that answers lines.

mod asking;
mod hearing;
mod sending;

use super::language::{Language, OpText};
use super::line_queue::{LineQueue, Purpose};
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
/// Free lines before an operation is written: two of an arc, three to lower the pen, and the beginning's
/// four.
const ROOM_FOR_OP: usize = 12;
/// How often a machine is asked where it rests, where its answer comes wrong.
const MOST_ASKS: u8 = 5;
/// So long after the last line by hand a machine that is not asked all the time is asked where it stands:
/// longer than from one piece of a movement to the next while a key is held, ten a second.
const HAND_RESTS_AFTER: Duration = Duration::from_millis(150);
/// Answered lines that are kept where they have numbers: as many as the machine keeps before it reads a
/// line's number (`BUFSIZE` of Marlin).
const KEPT_LINES: usize = 4;
/// So long nothing goes out when lines came wrong, until all that the machine says of them is heard: an
/// adapter on USB keeps bytes for up to 16 ms.
const HEARS_OUT: Duration = Duration::from_millis(25);
/// So many wishes for lines that are not there, without one for a line that is, show that the machine has
/// begun anew.
const MOST_STRAYS: u8 = 8;
/// So many questions for room while the place at rest is not told: a minute of them, five a second. Then it
/// is asked for again.
const QUESTIONS_FOR_REST: u16 = 300;
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
    /// of a usual plotter and more than a last decimal; two steps at most of one that tells how long they
    /// are.
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
/// assert_eq!(String::from_utf8_lossy(&sent), "?$$\nG21\nG90\nM5\nG0 X0 Y0\nM3 S90\nG1 X10 Y0 F1200\nM5\nG4 P0\n");
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
    /// How often the machine was asked at this rest where it stands, and whether it has said so.
    asks: u8,
    is_told: bool,
    /// How often it was asked where it stands since it was led by hand, if it has not said so.
    led: Option<u8>,
    /// The longest that the drawing has stood still so far.
    longest_dwell: Duration,
    /// When a line began to go out last, or was answered.
    stirred: Duration,
    /// Whether it moves by hand: GRBL refuses all but further such movements until it stands.
    jogs: bool,
    /// Whether that is to end: said again until the machine stands, as a jog that it has not read yet is none
    /// to end.
    ends_jog: bool,
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
    /// Nothing goes out before.
    hears_until: Option<Duration>,
    /// Wishes for lines that are not there since one for a line that is.
    strays: u8,
    /// Lines have gone out again for silence since the machine was heard.
    has_tried: bool,
    /// When it was asked for room last, and how often while the place at rest is not told.
    room_asked: Option<Duration>,
    rest_questions: u16,
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
            queue: LineQueue::keeping(if L::IS_NUMBERED { KEPT_LINES } else { 0 }),
            urgent: Ring::new(),
            notices: Ring::new(),
            answer: Words::default(),
            answer_is_cut: false,
            phase: Phase::Unheard,
            told: HostState::Unheard,
            at: None,
            knows_place: true,
            asks: 0,
            is_told: false,
            led: None,
            longest_dwell: Duration::ZERO,
            stirred: Duration::ZERO,
            jogs: false,
            ends_jog: false,
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
            hears_until: None,
            strays: 0,
            has_tried: false,
            room_asked: None,
            rest_questions: 0,
            earlier: None,
        }
    }

    /// The same, which goes on where an earlier host has left the drawing: so many operations of it were
    /// known to be done, so many may have been sent. Where the machine rests says which.
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
        L::QUERY.is_some() || self.queue.in_flight().lines > 0 || self.lacks_report()
    }

    /// Whether a silence leads to something.
    fn is_watched(&self) -> bool {
        let may_be_silent = self.phase != Phase::Unheard && self.language.may_be_silent();
        self.waits() && !may_be_silent && (!self.is_silent || L::IS_NUMBERED)
    }

    fn patience(&self) -> Duration {
        if L::QUERY.is_some() { self.settings.silence } else { L::PATIENCE.max(self.settings.silence) }
    }

    /// How often it is asked where the machine is: four times as often while something depends on it.
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
            if due {
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
        if self.is_watched() && now.saturating_sub(since) >= self.patience() {
            self.overdue(now);
        }
        self.ask_for_room(now);
        self.ask_for_place(now);
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
        if self.hears_until.is_some_and(|until| now < until) || self.language.is_held() {
            return None;
        }
        self.hears_until = None;
        let (bytes, purpose, is_begun) = self.queue.next()?;
        if self.jogs && purpose != Purpose::Jog {
            return None;
        }
        self.jogs |= purpose == Purpose::Jog && L::QUERY.is_some();
        if !is_begun && !self.language.fits(self.queue.in_flight(), bytes) {
            return None;
        }
        self.stirred = self.stirred.max(now);
        if L::QUERY.is_none() && self.queue.in_flight().lines == 0 && !is_begun {
            self.spoke = Some(now);
        }
        let byte = self.queue.next_byte();
        if !self.language.answers_lines() && self.queue.is_between() {
            // Nobody answers it. (A question is no sign that anybody hears.)
            if let Some(purpose) = self.queue.answer().filter(|&purpose| purpose != Purpose::Question) {
                self.taken(purpose, None);
            }
        }
        byte
    }

    fn receive(&mut self, now: Duration, byte: u8) {
        if self.language.hear_byte(byte) {
            (self.heard, self.has_tried) = (Some(now), false);
            return;
        }
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
        let silent = if self.is_watched() { silent } else { Duration::MAX };
        let asks =
            self.room_asked.map_or(asks, |asked| asks.min(asked.saturating_add(self.settings.ask_every)));
        let heard_out = self.hears_until.unwrap_or(Duration::MAX);
        let place = self.place_due().unwrap_or(Duration::MAX);
        Some(asks.min(silent).min(heard_out).min(place)).filter(|&wake| wake < Duration::MAX)
    }

    fn ask(&mut self, _: Duration, request: Request) -> Result<(), NotNow> {
        self.asked_for(request)
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
            is_led: self.is_led(),
            feed_percent: self.feed_percent,
            limits: self.language.limits(),
        }
    }
}
