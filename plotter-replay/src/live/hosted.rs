//! [`HostedEngine`]: the loop of a session with a machine that is led by lines of text.

use super::journal::Journal;
use super::line::lock;
use super::machine_log::Recording;
use super::session::Shared;
use super::session_settings::pen_wanted;
use super::timetable::Timetable;
use super::view::View;
use super::{Command, Hand, SessionSettings, State};
use crate::log::Event;
use crate::serial::PortError;
use core::time::Duration;
use plotter_motion::protocol::Wire;
use plotter_motion::protocol::hosts::{HostState, HostStatus, MachineHost, MachineNotice, NotNow, Request};
use plotter_motion::{Pen, PlotOp, Point};
use std::collections::VecDeque;
use std::io::Write;

/// Longest time for which the line is listened to at once, in its time; so long ahead it takes bytes.
const LISTEN: Duration = Duration::from_millis(2);
/// How often the recording says how far the drawing is, in the line's time: with it another host goes on.
const MARK_EVERY: Duration = Duration::from_millis(100);
/// A machine that says for so long to be at one place rests: it is asked five times a second, and the pen is
/// lifted in between.
const RESTS_FOR: Duration = Duration::from_secs(1);
/// A machine has arrived that says so long to be where it was led: it is asked five times a second.
const ARRIVED_FOR: Duration = Duration::from_millis(250);
/// So near, mm: machines tell their place in hundredths of a millimetre, and in whole steps.
const ARRIVED_MM: f64 = 0.05;
/// Operations by hand that wait: a circle of ten thousand points, and more.
const MOST_BY_HAND: usize = 20_000;

pub(super) struct HostedEngine<'a, W: Write> {
    host: Box<dyn MachineHost + Send>,
    drawing: Option<Timetable>,
    journal: Journal<'a, W>,
    wire: Wire,
    pens: Vec<(u8, String)>,
    free: Duration,
    by_hand: VecDeque<PlotOp>,
    /// Bytes that the line has not taken.
    unsent: Vec<u8>,
    shape: Shaped,
    /// Where the machine was led by hand last, and where it says to be since when.
    led_to: Option<Point>,
    rests: Option<(Point, Duration)>,
    /// Time in which it was drawn, and since when it is.
    drawn: Duration,
    draws_since: Option<Duration>,
    marked: (Duration, u64, u64),
    shared: &'a Shared,
}

impl<'a, W: Write> HostedEngine<'a, W> {
    pub(super) fn new(
        host: Box<dyn MachineHost + Send>,
        drawing: Option<Timetable>,
        recorder: Option<Recording<W>>,
        settings: SessionSettings,
        shared: &'a Shared,
    ) -> Self {
        Self {
            host,
            drawing,
            journal: Journal::new(recorder, shared),
            wire: Wire::new(settings.baud),
            pens: settings.pens,
            free: Duration::ZERO,
            by_hand: VecDeque::new(),
            unsent: Vec::new(),
            shape: Shaped::default(),
            led_to: None,
            rests: None,
            drawn: Duration::ZERO,
            draws_since: None,
            marked: (Duration::ZERO, 0, 0),
            shared,
        }
    }

    /// Until the drawing is done, the line fails, or the program ends. All times are the line's.
    pub(super) fn run(mut self) {
        let end = loop {
            match self.round() {
                Ok(None) => {}
                Ok(Some(end)) => break end,
                Err(error) => break State::Failed(error.to_string()),
            }
        };
        self.mark(true);
        let told = self.told();
        self.journal.end(end, |view| told.show(view));
    }

    fn now(&self) -> Duration {
        self.journal.now()
    }

    /// Once round: commands, host, line. The end, if that is it.
    fn round(&mut self) -> Result<Option<State>, PortError> {
        self.obey();
        let now = self.now();
        while let Some(notice) = self.host.poll(now) {
            self.notice(now, notice);
        }
        self.draw_by_hand(now);
        self.send(now)?;
        let wake = self.host.next_wake().map_or(LISTEN, |wake| wake.saturating_sub(now)).min(LISTEN);
        let mut bytes = [0; 1_024];
        let count = self.shared.line.receive(&mut bytes, wake.max(Duration::from_micros(200)))?;
        let bytes = bytes.get(..count).unwrap_or_default();
        if !bytes.is_empty() {
            self.take(Event::Controller(bytes.to_vec()));
            let now = self.now();
            bytes.iter().for_each(|&byte| self.host.receive(now, byte));
        }
        self.look();
        if self.host.status().state != HostState::Done {
            return Ok(None);
        }
        let now = self.now();
        while let Some(notice) = self.host.poll(now) {
            self.notice(now, notice); // what it noticed of the end
        }
        Ok(Some(State::Done))
    }

    fn send(&mut self, now: Duration) -> Result<(), PortError> {
        let shared = self.shared;
        let stop_is_new = lock(&shared.stop_is_new);
        if *stop_is_new {
            return Ok(()); // nothing older goes out behind a stop
        }
        if !self.unsent.is_empty() {
            // A machine that lets nothing through now: what is asked of it waits, and is not made up.
            let sent = shared.line.offer(&self.unsent)?;
            let gone: Vec<u8> = self.unsent.drain(..sent.min(self.unsent.len())).collect();
            drop(stop_is_new);
            if !gone.is_empty() {
                self.take(Event::Host(gone));
            }
            return Ok(());
        }
        let mut out = Vec::new();
        while self.free <= now.saturating_add(LISTEN) {
            let Some(byte) = self.host.next_byte(now) else { break };
            self.free = self.wire.send(now);
            out.push(byte);
        }
        if !out.is_empty() {
            let sent = shared.line.offer(&out)?;
            self.unsent = out.split_off(sent.min(out.len()));
            if !out.is_empty() {
                self.take(Event::Host(out));
            }
        }
        Ok(())
    }

    fn obey(&mut self) {
        loop {
            let Some(command) = lock(&self.shared.commands).pop_front() else { return };
            let now = self.now();
            let done = match command {
                Command::Clear => {
                    lock(&self.shared.view).clear();
                    Ok(())
                }
                Command::Start | Command::Resume => match self.host.status().state {
                    // A resume after a stop is the word that the machine may be unlocked.
                    HostState::Stopped if command == Command::Resume => self.host.ask(now, Request::Unlock),
                    HostState::Ready if self.drawing.is_none() => Err(NotNow::Nothing),
                    _ => self.host.ask(now, Request::GoOn),
                },
                Command::Pause => self.host.ask(now, Request::Pause),
                Command::Stop => {
                    self.by_hand.clear();
                    self.unsent.clear();
                    *lock(&self.shared.stop_is_new) = false;
                    let bytes = self.shared.stop_bytes().to_vec();
                    if !bytes.is_empty() {
                        self.take(Event::Host(bytes));
                    }
                    self.host.ask(now, Request::Stop)
                }
                Command::Hand(hand) => {
                    self.led_to = None;
                    let done = self.hand(now, hand);
                    lock(&self.shared.view).hand.took(done.as_ref().err().map(ToString::to_string));
                    done
                }
            };
            if let Err(why) = done {
                lock(&self.shared.view).message(now, why.to_string());
            }
        }
    }

    fn hand(&mut self, now: Duration, hand: Hand) -> Result<(), NotNow> {
        let here = self.host.status().at.unwrap_or_default();
        let mut allowed_mm = None;
        let draws: Vec<PlotOp> = match hand {
            Hand::Next => return self.host.ask(now, Request::Next),
            // While a key is held pieces come ten times a second: what the machine has no room for, it need
            // not make, and where there is no word to end one, its pieces end by themselves.
            Hand::Jog(by, feed_mm_s) => match self.host.ask(now, Request::Jog { by, feed_mm_s }) {
                Err(NotNow::Busy) => return Ok(()),
                done => {
                    self.led_to = Some(here + by);
                    return done;
                }
            },
            Hand::EndJog => match self.host.ask(now, Request::EndJog) {
                Err(NotNow::NoWord) => return Ok(()),
                done => return done,
            },
            Hand::GoTo(to) => vec![PlotOp::Travel { to }],
            Hand::DrawTo(to, mm_s) => vec![PlotOp::Draw { to, feed_mm_s: (mm_s > 0.0).then_some(mm_s) }],
            Hand::Pen(Pen::Up) => vec![PlotOp::Travel { to: here }],
            Hand::Pen(Pen::Down) => vec![PlotOp::Draw { to: here, feed_mm_s: None }],
            Hand::PenDownAt(number) => return self.host.ask(now, Request::PenDownAt(number)),
            Hand::Home => return self.host.ask(now, Request::Home),
            Hand::Unlock => return self.host.ask(now, Request::Unlock),
            Hand::StandsAt(place) => return self.host.ask(now, Request::StandsAt(place)),
            Hand::Feed(percent) => return self.host.ask(now, Request::Feed { percent }),
            Hand::Shape { shape, speed_mm_s, allowed_mm: allowed } => {
                allowed_mm = allowed;
                let mut ops = shape.ops(speed_mm_s);
                ops.extend(ops.last().and_then(|last| last.target()).map(|to| PlotOp::Travel { to })); // lifted
                ops
            }
            Hand::Hold(_) | Hand::Pulse(..) | Hand::Origin(_) => return Err(NotNow::NoWord),
        };
        if draws.len() > MOST_BY_HAND {
            return Err(NotNow::Busy);
        }
        // What cannot be begun is not kept for later: nothing moves unasked.
        if !self.by_hand.is_empty() {
            return Err(NotNow::Busy);
        }
        let count = draws.len() as u64;
        let mut draws = draws.into_iter();
        if let Some(first) = draws.next() {
            self.host.ask(now, Request::ByHand(first))?;
            self.led_to = draws.as_slice().last().copied().unwrap_or(first).target();
            self.by_hand.extend(draws);
            self.shape = Shaped { count, allowed_mm, ..Shaped::default() };
        }
        Ok(())
    }

    /// Goes on with a shape as the host has room.
    fn draw_by_hand(&mut self, now: Duration) {
        while let Some(&op) = self.by_hand.front() {
            match self.host.ask(now, Request::ByHand(op)) {
                Ok(()) => {
                    self.by_hand.pop_front();
                    if self.by_hand.is_empty() {
                        self.shape.ends_at = op.target();
                    }
                }
                Err(NotNow::Busy) => return,
                Err(why) => {
                    self.by_hand.clear();
                    lock(&self.shared.view).message(now, why.to_string());
                }
            }
        }
    }

    fn notice(&mut self, now: Duration, notice: MachineNotice) {
        if let MachineNotice::State(state) = notice {
            self.follow(now, state);
        }
        let words = notice.to_string();
        lock(&self.shared.view).message(now, words.clone());
        self.take(Event::Note(format!("host: {words}")));
    }

    fn follow(&mut self, now: Duration, state: HostState) {
        let draws = matches!(state, HostState::Drawing | HostState::Ending);
        match (draws, self.draws_since) {
            (true, None) => self.draws_since = Some(now),
            (false, Some(since)) => {
                self.drawn = self.drawn.saturating_add(now.saturating_sub(since));
                self.draws_since = None;
            }
            _ => {}
        }
        let mut view = lock(&self.shared.view);
        let wants = match state {
            HostState::PenWanted(pen) => pen_wanted(&self.pens, pen),
            HostState::SheetWanted | HostState::Locked(_) | HostState::Stopped => {
                MachineNotice::State(state).to_string()
            }
            _ => String::new(),
        };
        view.wants = wants;
        view.state = match state {
            HostState::Unheard => State::Connecting,
            HostState::Ready if self.drawing.is_none() => State::Watching,
            HostState::Ready => State::Ready,
            HostState::Drawing | HostState::Ending | HostState::Done => State::Running,
            HostState::Homing => State::Homing,
            HostState::Stopped => State::Stopped,
            HostState::Locked(_) => State::Locked,
            _ => State::Paused,
        };
    }

    /// Something happened: on the screen, and into the recording.
    fn take(&mut self, event: Event) {
        self.journal.take(event);
    }

    /// Says in the recording how far the drawing is, so that another host can go on with it.
    fn mark(&mut self, at_once: bool) {
        let (now, status) = (self.now(), self.host.status());
        let (marked, done, sent) = self.marked;
        let is_due = at_once || now.saturating_sub(marked) >= MARK_EVERY;
        if is_due && (done, sent) != (status.done, status.sent) {
            self.marked = (now, status.done, status.sent);
            self.take(Event::Note(format!("{MARK}{} {}", status.done, status.sent)));
        }
    }

    /// Now and then: a sample of the place, and the recording written through.
    fn look(&mut self) {
        if !self.journal.is_due() {
            return;
        }
        self.mark(false);
        self.check_shape();
        let waiting = self.by_hand.len() as u64;
        let by_hand = (waiting > 0).then(|| (self.shape.count.saturating_sub(waiting), self.shape.count));
        let told = self.told();
        self.journal.sample(|view| {
            told.show(view);
            view.by_hand = by_hand;
        });
    }

    /// Once the machine rests behind a shape: says so if that is farther from its end than was allowed.
    fn check_shape(&mut self) {
        let now = self.now();
        let HostStatus { at: Some(at), is_led, .. } = self.host.status() else { return };
        let (was, since) = *self.rests.get_or_insert((at, now));
        if was != at || is_led {
            self.rests = Some((at, now));
            return;
        }
        let for_long = |least| now.saturating_sub(since) >= least;
        if self.by_hand.is_empty()
            && for_long(ARRIVED_FOR)
            && self.led_to.is_some_and(|to| to.distance(at) <= ARRIVED_MM)
        {
            lock(&self.shared.view).hand.rests = true;
        }
        if let (Some(end), Some(allowed_mm)) = (self.shape.ends_at, self.shape.allowed_mm)
            && for_long(RESTS_FOR)
        {
            self.shape = Shaped::default();
            let off_mm = at.distance(end);
            if off_mm > allowed_mm {
                lock(&self.shared.view).message(
                    now,
                    format!(
                        "came to rest {off_mm:.3} mm from ({:.3}, {:.3}) mm: {allowed_mm} mm are allowed",
                        end.x, end.y
                    ),
                );
            }
        }
    }

    /// What the host knows.
    fn told(&self) -> Told {
        let (now, status) = (self.now(), self.host.status());
        let since = self.draws_since.map_or(Duration::ZERO, |since| now.saturating_sub(since));
        let drawn = self.drawn.saturating_add(since);
        let rest = self.drawing.as_ref().filter(|_| !drawn.is_zero());
        let rest = rest.map(|table| table.rest(status.done, drawn));
        Told { status, rest, way_mm: self.drawing.as_ref().map(|table| table.way_mm(status.done)) }
    }
}

/// A shape by hand, while it is drawn.
#[derive(Clone, Copy, Debug, Default)]
struct Shaped {
    /// Its operations.
    count: u64,
    allowed_mm: Option<f64>,
    /// Where it ends, once all of it is sent.
    ends_at: Option<Point>,
}

/// What a host knows of its machine at one time.
struct Told {
    status: HostStatus,
    rest: Option<Duration>,
    way_mm: Option<f64>,
}

impl Told {
    fn show(self, view: &mut View) {
        let Self { status, rest, way_mm } = self;
        (view.done.targets, view.reached) = (status.done, status.done);
        if let Some(hosted) = &mut view.hosted {
            hosted.at = status.at;
            hosted.is_down = status.pen == Pen::Down;
            hosted.feed_percent = status.feed_percent;
            (hosted.rest, hosted.way_mm) = (rest, way_mm);
        }
    }
}

/// Before the numbers of operations done and sent, in a note of a recording.
pub(crate) const MARK: &str = "host: operations done and sent: ";
