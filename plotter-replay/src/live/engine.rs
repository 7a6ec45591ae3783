//! [`Engine`]: the loop of a session: commands, host, line.

use super::desk::{Desk, Fed, Steps};
use super::journal::Journal;
use super::line::lock;
use super::machine_log::Recording;
use super::sender::Sender;
use super::session::Shared;
use super::session_settings::pen_wanted;
use super::{Command, SessionSettings, State, Telemetry};
use crate::log::Event;
use crate::resume::{BY_HAND, GIVEN, REACHED};
use crate::serial::PortError;
use core::time::Duration;
use plotter_motion::protocol::{HostEvent, HostNotice, Order};
use plotter_motion::{PenMove, StepPoint};
use std::io::Write;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

/// Longest time for which the line is listened to at once, in its time; so long ahead it takes bytes.
const LISTEN: Duration = Duration::from_millis(2);
/// Moves that lie ready for a machine on the reliable link, so that it need not wait for the line: as many as
/// its host keeps.
const AHEAD: usize = 32;

pub(super) struct Engine<'a, W: Write> {
    pub(super) host: Sender,
    pub(super) desk: Desk,
    journal: Journal<'a, W>,
    telemetry: Option<Arc<Mutex<Telemetry>>>,
    /// Time in which the host's clock stood still.
    frozen: Duration,
    frozen_since: Option<Duration>,
    /// The target that was sent and is not reached, and when it was sent.
    under_way: Option<(PenMove, Duration)>,
    /// The last target.
    at: StepPoint,
    /// What ends the drawing before its end.
    failure: Option<String>,
    /// Whether a person has stopped it here, and has not let it go on.
    wants_stop: bool,
    /// Whether what another host has drawn was taken into account.
    is_resumed: bool,
    /// Until when a key is held, where that is one long move.
    pub(super) held_until: Option<Duration>,
    /// The greatest error that a shape by hand allows, mm.
    pub(super) allowed_mm: Option<f64>,
    pub(super) settings: SessionSettings,
    pub(super) shared: &'a Shared,
}

impl<'a, W: Write> Engine<'a, W> {
    pub(super) fn new(
        drawing: Option<Steps>,
        recorder: Option<Recording<W>>,
        telemetry: Option<Arc<Mutex<Telemetry>>>,
        settings: SessionSettings,
        shared: &'a Shared,
    ) -> Self {
        let desk = Desk::new(drawing, settings.stands_at, settings.most);
        Self {
            host: Sender::new(&settings, desk.tray()),
            desk,
            journal: Journal::new(recorder, shared),
            telemetry,
            frozen: Duration::ZERO,
            frozen_since: None,
            under_way: None,
            at: StepPoint::default(),
            failure: None,
            wants_stop: false,
            is_resumed: false,
            held_until: None,
            allowed_mm: None,
            settings,
            shared,
        }
    }

    /// Until the drawing is done, has failed, or the program ends. All times are the line's.
    pub(super) fn run(mut self) {
        let end = loop {
            match self.round() {
                Ok(None) => {}
                Ok(Some(end)) => break end,
                Err(error) => break State::Failed(error.to_string()),
            }
        };
        self.journal.end(end, |view| view.duty = None);
    }

    pub(super) fn now(&self) -> Duration {
        self.journal.now()
    }

    /// Once round: commands, host, line. The end, if that is it.
    fn round(&mut self) -> Result<Option<State>, PortError> {
        self.obey()?;
        let state = lock(&self.shared.view).state.clone();
        let now = self.now();
        let host_now = self.host_clock(now, &state);
        let by_hand = self.desk.has_by_hand();
        // On the reliable link the machine is told to wait; by digits it is told nothing more.
        let talks = match state {
            State::Running => true,
            State::Paused => !self.host.is_digits() || self.under_way.is_some() || by_hand,
            State::Stopped => self.host.is_linked(),
            State::Ready | State::Watching => by_hand || self.host.is_linked(),
            _ => false,
        };
        let mut wait = LISTEN;
        if talks {
            if let Some(end) = self.feed(&state) {
                return Ok(Some(end));
            }
            self.let_go(host_now);
            self.send(host_now)?;
            if let Some(why) = self.failure.take() {
                return Ok(Some(State::Failed(why)));
            }
            if self.host.is_done() {
                return Ok(Some(State::Done));
            }
            let wake = self.host.next_wake(LISTEN);
            wait = wake.map_or(LISTEN, |wake| wake.saturating_sub(host_now)).min(LISTEN);
        }
        let mut bytes = [0; 1_024];
        let count = self.shared.line.receive(&mut bytes, wait)?;
        let bytes = bytes.get(..count).unwrap_or_default();
        if !bytes.is_empty() {
            let host_now = host_now.max(self.now().saturating_sub(self.frozen));
            self.take(Event::Controller(bytes.to_vec()));
            for &byte in bytes {
                if let Some(event) = self.host.receive(host_now, byte) {
                    self.event(event);
                }
            }
            self.resumed();
        }
        self.look();
        Ok(None)
    }

    /// Gives the host what is next; the end, if that is all.
    fn feed(&mut self, state: &State) -> Option<State> {
        if self.settings.resume.is_some() && !self.is_resumed && !self.host.is_digits() {
            return None; // what another host has drawn is not known yet
        }
        if let Some(kept) = self.host.take_kept() {
            self.desk.withdrawn(kept);
            if kept == 0 {
                self.under_way = None;
            }
        }
        if matches!(state, State::Ready | State::Watching | State::Paused) {
            self.desk.feed_by_hand();
        }
        if *state != State::Running {
            return None;
        }
        let fed = self.desk.feed(if self.host.is_digits() { 1 } else { AHEAD });
        match fed {
            Fed::Given => {}
            Fed::Pen(pen) => self.wait_for(pen_wanted(&self.settings.pens, pen)),
            Fed::Sheet => self.wait_for(String::from("a new sheet is wanted: put it in, then go on")),
            Fed::Paused => self.wait_for(String::new()),
            Fed::Over => return Some(State::Done),
        }
        None
    }

    /// A person has something to do before it goes on.
    fn wait_for(&mut self, wants: String) {
        let now = self.now();
        if !wants.is_empty() {
            self.take(Event::Note(format!("host: {wants}")));
        }
        let mut view = lock(&self.shared.view);
        if !wants.is_empty() {
            view.message(now, wants.clone());
        }
        (view.state, view.wants) = (State::Paused, wants);
    }

    fn obey(&mut self) -> Result<(), PortError> {
        loop {
            let Some(command) = lock(&self.shared.commands).pop_front() else {
                return Ok(());
            };
            if command == Command::Resume && *lock(&self.shared.stop_is_new) {
                continue; // it was stopped again since
            }
            if let Command::Hand(hand) = command {
                let now = self.now();
                let refused = self.hand(hand).err().map(|why| why.to_string());
                let mut view = lock(&self.shared.view);
                if let Some(why) = &refused {
                    view.message(now, why.clone());
                }
                view.hand.took(refused);
                view.hand.rests = self.desk.is_idle();
                continue;
            }
            if command == Command::Start
                && let Err(why) = self.fits()
            {
                let now = self.now();
                lock(&self.shared.view).message(now, why);
                continue;
            }
            let next = {
                let mut view = lock(&self.shared.view);
                if command == Command::Clear {
                    view.clear();
                }
                let next = view.state.after(command);
                let before = next.clone().map(|next| core::mem::replace(&mut view.state, next));
                if before.is_some() {
                    view.wants.clear();
                }
                before.zip(next)
            };
            match (command, next) {
                (Command::Start, Some(_)) => self.desk.all(),
                (Command::Stop, _) => {
                    (self.wants_stop, *lock(&self.shared.stop_is_new)) = (true, false);
                    // Its bytes are out. Over frames it is also told in a way that is answered.
                    let bytes = self.shared.stop_bytes().to_vec();
                    self.take(Event::Host(bytes));
                    let _ = self.host.order(Order::Stop);
                    self.desk.drop_by_hand();
                    self.held_until = None;
                }
                (Command::Pause, Some(_)) => {
                    let _ = self.host.order(Order::Hold);
                    // What it has not begun is taken back, so that a person can do something in between.
                    if !self.host.is_digits() && self.desk.withdraw() {
                        self.host.withdraw();
                    }
                }
                (Command::Resume, Some((State::Paused, _))) => {
                    self.desk.all();
                    self.go_on();
                }
                (Command::Resume, Some((State::Stopped, _))) => {
                    self.wants_stop = false;
                    let byte = self.host.order(Order::GoOn);
                    // Where nobody has answered a call yet, both ways are tried.
                    if byte.is_some() || !self.host.is_linked() {
                        self.shared.line.send(&[Order::GoOn.byte()])?;
                        self.take(Event::Host(vec![Order::GoOn.byte()]));
                    }
                    let mut view = lock(&self.shared.view);
                    if !self.desk.has_drawing() {
                        view.state = State::Watching;
                    } else if view.done.targets == 0
                        && (self.under_way.is_none() || self.desk.is_led_by_hand())
                    {
                        view.state = State::Ready; // it was stopped before it began
                    } else if self.desk.is_led_by_hand() {
                        view.state = State::Paused;
                    }
                }
                _ => {}
            }
        }
    }

    /// A machine that holds does not, from now on.
    pub(super) fn go_on(&mut self) {
        // (a byte would tell a machine of digits what it has not asked for)
        if !self.host.is_digits() {
            let _ = self.host.order(Order::GoOn);
        }
    }

    /// The host's clock stands still while nothing can come of its patience.
    fn host_clock(&mut self, now: Duration, state: &State) -> Duration {
        let by_hand = self.desk.has_by_hand();
        let stands = match state {
            State::Ready | State::Watching => !by_hand && !self.host.is_linked(),
            State::Stopped => !self.host.is_linked(),
            State::Paused => self.host.is_digits() && self.under_way.is_none() && !by_hand,
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
        if *stop_is_new {
            return Ok(());
        }
        let event = self.host.poll(host_now);
        let bytes = self.host.bytes(host_now, LISTEN);
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
                if self.desk.is_led_by_hand() {
                    self.note_by_hand(self.desk.reached_by_hand().saturating_add(1), GIVEN);
                }
            }
            HostEvent::Reached(reached) => {
                let began = self.under_way.take().map_or(now, |(_, began)| began);
                if !self.done() {
                    self.check_shape(reached.target);
                    return;
                }
                let length_mm = self.pass(reached.target);
                let mut view = lock(&self.shared.view);
                view.pace.target(length_mm, now.saturating_sub(began));
                view.reached = view.reached.saturating_add(1);
            }
            HostEvent::Notice(notice) => {
                if let HostNotice::GaveUp { target, .. } | HostNotice::OutOfArea(target) = notice {
                    self.under_way = None;
                    if self.done() {
                        self.pass(target);
                    }
                }
                if matches!(notice, HostNotice::Refused(_)) {
                    self.done();
                }
                if self.host.ends_by(notice) {
                    self.failure = Some(notice.to_string());
                }
                self.follow(notice);
                lock(&self.shared.view).message(now, notice.to_string());
                self.take(Event::Note(format!("host: {notice}")));
            }
        }
    }

    /// A machine on the reliable link counts what it is told, by hand, too: with it another host goes on.
    fn note_by_hand(&mut self, number: u64, became: &str) {
        if !self.host.is_digits() {
            self.take(Event::Note(format!("{BY_HAND}{number}{became}")));
        }
    }

    /// What is under way is over; whether it was a part of the drawing.
    fn done(&mut self) -> bool {
        let (is_drawing, then) = self.desk.done();
        if !is_drawing {
            self.note_by_hand(self.desk.reached_by_hand(), REACHED);
            if self.desk.is_idle() {
                self.take(Event::Pen(self.desk.pen())); // lifted behind a shape
            }
        }
        lock(&self.shared.view).hand.rests = self.desk.is_idle();
        if then == Some(Fed::Paused) {
            self.wait_for(String::new());
        }
        is_drawing
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
        if !self.host.is_linked() {
            return;
        }
        let Some((_, reached)) = self.host.resumed() else { return };
        self.is_resumed = true;
        (0..reached).for_each(|_| self.desk.skip());
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
    pub(super) fn take(&mut self, event: Event) {
        self.journal.take(event);
    }

    /// Now and then: a sample of the response, and the recording written through.
    fn look(&mut self) {
        if !self.journal.is_due() {
            return;
        }
        let duty = self.telemetry.as_ref().map(|telemetry| lock(telemetry).duty);
        let [x, y] = self.settings.pwm_steps.map(|steps| f64::from(steps.max(1)));
        let by_hand = self.desk.has_by_hand().then(|| self.desk.count());
        self.journal.sample(|view| {
            view.by_hand = by_hand;
            if let Some(duty) = duty {
                view.duty = Some([f64::from(duty[0]) / x, f64::from(duty[1]) / y]);
            }
        });
    }
}
