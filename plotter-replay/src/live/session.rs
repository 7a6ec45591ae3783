//! [`Session`]: a drawing on its way to a machine.

use super::line::{Line, lock};
use super::machine_log::Recording;
use super::progress::Plan;
use super::sender::Sender;
use super::view::{Cursor, View};
use super::{Command, State, Telemetry};
use crate::log::{Event, Record};
use crate::serial::PortError;
use crate::{CountedBy, PlotterSettings};
use core::time::Duration;
use plotter_motion::protocol::{HostEvent, HostNotice, HostSettings, Order, Resume};
use plotter_motion::{PenMove, StepPoint};
use serde_json::Value;
use std::collections::VecDeque;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Instant;

/// Longest time for which the line is listened to at once.
const LISTEN: Duration = Duration::from_millis(2);
/// How often the response is sampled.
const SAMPLE_EVERY: Duration = Duration::from_millis(20);

/// What is spoken with the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LinkChoice {
    /// Frames, if the machine knows them, else digits. It is called when the drawing begins, at the origin.
    #[default]
    Auto,
    /// Ten digits a target, as published. The machine is not called.
    Digits,
    /// Frames; a machine that does not know them is refused.
    Frames,
}

/// How a session goes.
#[derive(Clone, Debug)]
pub struct SessionSettings {
    /// Scale and origin of the machine.
    pub plotter: PlotterSettings,
    /// Pause after each byte, 10 ms as published.
    pub byte_gap: Duration,
    /// Patience with the machine.
    pub host: HostSettings,
    /// How much the drawing is, if there is one.
    pub plan: Option<Plan>,
    /// How many seconds of the machine pass in one of ours; 1 for any that is real.
    pub speed: f64,
    /// Duty steps that are the whole supply, of both motors.
    pub pwm_steps: [u32; 2],
    /// What is spoken.
    pub link: LinkChoice,
    /// Number of a session of frames: one that the last host is not likely to have taken, such as the low bits of a clock.
    pub nonce: u16,
    /// Bits a second of the line.
    pub baud: u32,
    /// Where another host has left the drawing; its moves are all of them, from the first.
    pub resume: Option<Resume>,
}

impl Default for SessionSettings {
    /// The semi-virtual gantry as published, in its own time, nothing to draw.
    fn default() -> Self {
        Self {
            plotter: PlotterSettings::default(),
            byte_gap: Duration::from_millis(10),
            host: HostSettings::default(),
            plan: None,
            speed: 1.0,
            pwm_steps: [255; 2],
            link: LinkChoice::Auto,
            nonce: 1,
            baud: 256_000,
            resume: None,
        }
    }
}

/// A drawing on its way to a machine, in a thread of its own; clones are handles of the same session.
#[derive(Clone, Debug)]
pub struct Session {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    line: Arc<dyn Line>,
    view: Mutex<View>,
    commands: Mutex<VecDeque<Command>>,
    /// Whether the machine may speak frames, so that a stop is `00 21 00`.
    may_be_linked: AtomicBool,
    /// Whether a stop is on the line that the session's loop has not taken note of: until then it sends nothing, lest it sends an
    /// older order to go on.
    stop_is_new: Mutex<bool>,
    finished: Condvar,
}

/// The moves of a drawing, in order.
pub(super) type Moves = Box<dyn Iterator<Item = PenMove> + Send>;

impl Session {
    /// Opens a session on `line`. With `moves` it waits for [`Command::Start`]; without, it only watches. What happens goes
    /// to `recorder`. What no byte tells of a simulated machine comes from `telemetry`.
    #[must_use]
    pub fn open<W: Write + Send + 'static>(
        line: Arc<dyn Line>,
        moves: Option<Moves>,
        recorder: Option<Recording<W>>,
        telemetry: Option<Arc<Mutex<Telemetry>>>,
        mut settings: SessionSettings,
    ) -> Self {
        let may_be_linked = moves.is_some() && settings.link != LinkChoice::Digits;
        if may_be_linked {
            settings.plotter.counted_by = CountedBy::Link;
        }
        let state = if moves.is_some() { State::Ready } else { State::Watching };
        let mut view = View::new(settings.plotter, state, settings.plan);
        view.recording = String::from(if recorder.is_some() { "on" } else { "none" });
        let view = Mutex::new(view);
        let shared = Arc::new(Shared {
            line,
            view,
            commands: Mutex::default(),
            may_be_linked: AtomicBool::new(may_be_linked),
            stop_is_new: Mutex::default(),
            finished: Condvar::new(),
        });
        let session = Self { shared: Arc::clone(&shared) };
        let host = moves.map(|moves| Sender::new(&settings, moves));
        thread::spawn(move || {
            let engine = Engine {
                host,
                recorder,
                telemetry,
                began: Instant::now(),
                frozen: Duration::ZERO,
                frozen_since: None,
                under_way: None,
                at: StepPoint::default(),
                last: Duration::ZERO,
                failure: None,
                wants_stop: false,
                is_resumed: false,
                settings,
                shared: &shared,
            };
            engine.run();
        });
        session
    }

    /// Does what a person asks. An emergency stop is on the line when this returns.
    pub fn command(&self, command: Command) {
        if command == Command::Stop {
            let mut stop_is_new = lock(&self.shared.stop_is_new);
            *stop_is_new = true;
            // The line's own failure is met by the session's loop, which says so.
            let _ = self.shared.line.send(self.shared.stop_bytes());
        }
        lock(&self.shared.commands).push_back(command);
    }

    /// What it is doing.
    #[must_use]
    pub fn state(&self) -> State {
        lock(&self.shared.view).state.clone()
    }

    /// Targets of the drawing that were reached.
    #[must_use]
    pub fn reached(&self) -> u64 {
        lock(&self.shared.view).reached
    }

    /// What became of the recording: `on`, `none`, `complete`, or why it stopped.
    #[must_use]
    pub fn recording(&self) -> String {
        lock(&self.shared.view).recording.clone()
    }

    /// Waits at most `wait` for the end; the state then.
    #[must_use]
    pub fn wait(&self, wait: Duration) -> State {
        let view = lock(&self.shared.view);
        let (view, _) = self
            .shared
            .finished
            .wait_timeout_while(view, wait, |view| !view.state.is_final())
            .unwrap_or_else(PoisonError::into_inner);
        view.state.clone()
    }

    pub(super) fn update(&self, cursor: &mut Cursor) -> Value {
        lock(&self.shared.view).update(cursor)
    }

    pub(super) fn look<R>(&self, look: impl FnOnce(&View) -> R) -> R {
        look(&lock(&self.shared.view))
    }
}

impl Shared {
    /// What stops the machine at once: a zero on either side makes a stop by itself of it where frames are spoken.
    fn stop_bytes(&self) -> &'static [u8] {
        const { &[0, Order::Stop.byte(), 0] }
            .get(if self.may_be_linked.load(Ordering::Relaxed) { 0..3 } else { 1..2 })
            .unwrap_or_default()
    }
}

struct Engine<'a, W: Write> {
    host: Option<Sender>,
    recorder: Option<Recording<W>>,
    telemetry: Option<Arc<Mutex<Telemetry>>>,
    began: Instant,
    /// Time in which the host's clock stood still.
    frozen: Duration,
    frozen_since: Option<Duration>,
    /// The target that was sent and is not reached, and when it was sent.
    under_way: Option<(PenMove, Duration)>,
    /// The last target.
    at: StepPoint,
    last: Duration,
    /// What ends the drawing before its end.
    failure: Option<String>,
    /// Whether a person has stopped it here, and has not let it go on.
    wants_stop: bool,
    /// Whether what another host has drawn was taken into account.
    is_resumed: bool,
    settings: SessionSettings,
    shared: &'a Shared,
}

impl<W: Write> Engine<'_, W> {
    fn run(mut self) {
        let end = loop {
            match self.round() {
                Ok(None) => {}
                Ok(Some(end)) => break end,
                Err(error) => break State::Failed(error.to_string()),
            }
        };
        if let State::Failed(why) = &end {
            self.take(Event::Note(format!("the session failed: {why}")));
        }
        let kept = self.recorder.take().map(|recorder| recorder.finish());
        let mut view = lock(&self.shared.view);
        match kept {
            Some(Err(error)) => view.recording = format!("stopped: {error}"),
            Some(Ok(())) => view.recording = String::from("complete"),
            None => {}
        }
        view.duty = None;
        let now = self.began.elapsed().mul_f64(self.settings.speed);
        view.sample(now);
        view.state = end;
        self.shared.finished.notify_all();
    }

    fn now(&self) -> Duration {
        self.began.elapsed().mul_f64(self.settings.speed)
    }

    /// Once round: commands, host, line. The end, if that is it.
    fn round(&mut self) -> Result<Option<State>, PortError> {
        self.obey()?;
        let state = lock(&self.shared.view).state.clone();
        let now = self.now();
        let host_now = self.host_clock(now, &state);
        // On the reliable link the machine is told to wait; by digits it is told nothing more.
        let is_digits = self.host.as_ref().is_none_or(Sender::is_digits);
        let drawing = match state {
            State::Running => true,
            State::Paused => !is_digits || self.under_way.is_some(),
            State::Stopped => self.host.as_ref().is_some_and(Sender::is_linked),
            _ => false,
        };
        let mut wait = LISTEN;
        if drawing && self.host.is_some() {
            self.send(host_now)?;
            if let Some(why) = self.failure.take() {
                return Ok(Some(State::Failed(why)));
            }
            if let Some(host) = &self.host {
                if host.is_done() {
                    return Ok(Some(State::Done));
                }
                let due = host.next_wake().map_or(LISTEN, |wake| wake.saturating_sub(host_now));
                wait = due.div_f64(self.settings.speed.max(1e-3)).min(LISTEN);
            }
        }
        let mut bytes = [0; 1_024];
        let count = self.shared.line.receive(&mut bytes, wait)?;
        let bytes = bytes.get(..count).unwrap_or_default();
        if !bytes.is_empty() {
            let host_now = host_now.max(self.now().saturating_sub(self.frozen));
            self.take(Event::Controller(bytes.to_vec()));
            for &byte in bytes {
                let event = self.host.as_mut().and_then(|host| host.receive(host_now, byte));
                if let Some(event) = event {
                    self.event(event);
                }
            }
            self.resumed();
        }
        self.look();
        Ok(None)
    }

    fn obey(&mut self) -> Result<(), PortError> {
        loop {
            let Some(command) = lock(&self.shared.commands).pop_front() else {
                return Ok(());
            };
            if command == Command::Resume && *lock(&self.shared.stop_is_new) {
                continue; // it was stopped again since
            }
            let next = {
                let mut view = lock(&self.shared.view);
                if command == Command::Clear {
                    view.clear();
                }
                let next = view.state.after(command);
                let before = next.clone().map(|next| core::mem::replace(&mut view.state, next));
                before.zip(next)
            };
            match (command, next) {
                (Command::Stop, _) => {
                    (self.wants_stop, *lock(&self.shared.stop_is_new)) = (true, false);
                    // Its bytes are out. Over frames it is also told in a way that is answered.
                    let bytes = self.shared.stop_bytes().to_vec();
                    self.take(Event::Host(bytes));
                    if let Some(host) = &mut self.host {
                        let _ = host.order(Order::Stop);
                    }
                }
                (Command::Pause, Some(_)) => {
                    if let Some(host) = &mut self.host {
                        let _ = host.order(Order::Hold);
                    }
                }
                (Command::Resume, Some((State::Paused, _))) => {
                    // (a byte would tell a machine of digits what it has not asked for)
                    if let Some(host) = self.host.as_mut().filter(|host| !host.is_digits()) {
                        let _ = host.order(Order::GoOn);
                    }
                }
                (Command::Resume, Some((State::Stopped, _))) => {
                    self.wants_stop = false;
                    let order = self.host.as_mut().map(|host| (host.order(Order::GoOn), host.is_linked()));
                    // Where nobody has answered a call yet, both ways are tried.
                    if order.is_none_or(|(byte, is_linked)| byte.is_some() || !is_linked) {
                        self.shared.line.send(&[Order::GoOn.byte()])?;
                        self.take(Event::Host(vec![Order::GoOn.byte()]));
                    }
                    let mut view = lock(&self.shared.view);
                    if self.host.is_none() {
                        view.state = State::Watching;
                    } else if self.under_way.is_none() && view.done.targets == 0 {
                        view.state = State::Ready; // it was stopped before it began
                    }
                }
                _ => {}
            }
        }
    }

    /// The host's clock stands still while nothing can come of its patience.
    fn host_clock(&mut self, now: Duration, state: &State) -> Duration {
        let is_digits = self.host.as_ref().is_none_or(Sender::is_digits);
        let stands = match state {
            State::Ready => true,
            State::Stopped => !self.host.as_ref().is_some_and(Sender::is_linked),
            State::Paused => is_digits && self.under_way.is_none(),
            _ => false,
        };
        match (stands, self.frozen_since) {
            (true, None) => self.frozen_since = Some(now),
            (false, Some(since)) => {
                self.frozen = self.frozen.saturating_add(now.saturating_sub(since));
                self.frozen_since = None;
            }
            _ => {}
        }
        self.frozen_since.unwrap_or(now).saturating_sub(self.frozen)
    }

    fn send(&mut self, host_now: Duration) -> Result<(), PortError> {
        let shared = self.shared;
        let stop_is_new = lock(&shared.stop_is_new);
        let Some(host) = self.host.as_mut().filter(|_| !*stop_is_new) else {
            return Ok(());
        };
        let event = host.poll(host_now);
        let ahead = LISTEN.mul_f64(self.settings.speed.max(1.0));
        let bytes = host.bytes(host_now, ahead);
        if let Some(event) = event {
            self.event(event);
        }
        if !bytes.is_empty() {
            self.shared.line.send(&bytes)?;
            self.take(Event::Host(bytes));
        }
        Ok(())
    }

    fn event(&mut self, event: HostEvent) {
        let now = self.now();
        match event {
            HostEvent::Begun(next) => {
                self.under_way = Some((next, now));
                self.take(Event::Pen(next.pen));
            }
            HostEvent::Reached(reached) => {
                let began = self.under_way.take().map_or(now, |(_, began)| began);
                let length_mm = self.pass(reached.target);
                let mut view = lock(&self.shared.view);
                view.pace.target(length_mm, now.saturating_sub(began));
                view.reached = view.reached.saturating_add(1);
            }
            HostEvent::Notice(notice) => {
                if let HostNotice::GaveUp { target, .. } | HostNotice::OutOfArea(target) = notice {
                    self.under_way = None;
                    self.pass(target);
                }
                if self.host.as_ref().is_some_and(|host| host.ends_by(notice)) {
                    self.failure = Some(notice.to_string());
                }
                self.follow(notice);
                lock(&self.shared.view).message(now, notice.to_string());
                self.take(Event::Note(format!("host: {notice}")));
            }
        }
    }

    /// The machine is stopped or goes on, whoever wanted it so.
    fn follow(&self, notice: HostNotice) {
        let mut view = lock(&self.shared.view);
        match (notice, &view.state) {
            (HostNotice::Stopped, State::Running | State::Paused) => view.state = State::Stopped,
            (HostNotice::GoesOn, State::Stopped) if !self.wants_stop => view.state = State::Running,
            (HostNotice::DigitsOnly, _) => self.shared.may_be_linked.store(false, Ordering::Relaxed),
            _ => {}
        }
    }

    /// What another host has drawn is done.
    fn resumed(&mut self) {
        if self.is_resumed || self.settings.resume.is_none() {
            return;
        }
        let Some((_, reached)) = self.host.as_ref().filter(|host| host.is_linked()).and_then(Sender::resumed)
        else {
            return;
        };
        self.is_resumed = true;
        let mut view = lock(&self.shared.view);
        view.done.targets = view.done.targets.saturating_add(reached.into());
        view.reached = view.reached.saturating_add(reached.into());
    }

    /// A target is behind us: the length of its way, mm.
    fn pass(&mut self, target: StepPoint) -> f64 {
        let to_sheet = |at| self.settings.plotter.to_sheet(at);
        let length_mm = to_sheet(self.at).distance(to_sheet(target));
        self.at = target;
        let mut view = lock(&self.shared.view);
        view.done.targets = view.done.targets.saturating_add(1);
        view.done.way_mm += length_mm;
        length_mm
    }

    /// Something happened: on the screen, and into the recording.
    fn take(&mut self, event: Event) {
        self.last = self.now().max(self.last);
        let record = Record { time: self.last, event };
        let mut view = lock(&self.shared.view);
        view.push(&record);
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.write(&record)
        {
            // The drawing goes on; what was written stays.
            view.recording = format!("stopped: {error}");
            view.message(record.time, format!("recording stopped, drawing goes on: {error}"));
            self.recorder = None;
        }
    }

    /// Now and then: a sample of the response, and the recording written through.
    fn look(&mut self) {
        let now = self.now();
        let mut view = lock(&self.shared.view);
        let every = SAMPLE_EVERY.mul_f64(self.settings.speed);
        if view.samples.back().is_some_and(|sample| now.saturating_sub(sample.time) < every) {
            return;
        }
        if let Some(telemetry) = &self.telemetry {
            let duty = lock(telemetry).duty;
            let [x, y] = self.settings.pwm_steps.map(|steps| f64::from(steps.max(1)));
            view.duty = Some([f64::from(duty[0]) / x, f64::from(duty[1]) / y]);
        }
        view.sample(now);
        if let Some(recorder) = &mut self.recorder
            && let Err(error) = recorder.tick(now)
        {
            view.recording = format!("stopped: {error}");
            self.recorder = None;
        }
    }
}
