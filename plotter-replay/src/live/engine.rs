//! [`Engine`]: the loop of a session: commands, host, line.

use super::journal::Journal;
use super::line::lock;
use super::machine_log::Recording;
use super::sender::Sender;
use super::session::Shared;
use super::{Command, SessionSettings, State, Telemetry};
use crate::log::Event;
use crate::serial::PortError;
use core::time::Duration;
use plotter_motion::protocol::{HostEvent, HostNotice, Order};
use plotter_motion::{PenMove, StepPoint};
use std::io::Write;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

/// Longest time for which the line is listened to at once, in its time; so long ahead it takes bytes.
const LISTEN: Duration = Duration::from_millis(2);
pub(super) struct Engine<'a, W: Write> {
    host: Option<Sender>,
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
    settings: SessionSettings,
    shared: &'a Shared,
}

impl<'a, W: Write> Engine<'a, W> {
    pub(super) fn new(
        host: Option<Sender>,
        recorder: Option<Recording<W>>,
        telemetry: Option<Arc<Mutex<Telemetry>>>,
        settings: SessionSettings,
        shared: &'a Shared,
    ) -> Self {
        Self {
            host,
            journal: Journal::new(recorder, shared),
            telemetry,
            frozen: Duration::ZERO,
            frozen_since: None,
            under_way: None,
            at: StepPoint::default(),
            failure: None,
            wants_stop: false,
            is_resumed: false,
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

    fn now(&self) -> Duration {
        self.journal.now()
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
                let wake = host.next_wake(LISTEN);
                wait = wake.map_or(LISTEN, |wake| wake.saturating_sub(host_now)).min(LISTEN);
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
        let bytes = host.bytes(host_now, LISTEN);
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
        self.journal.take(event);
    }

    /// Now and then: a sample of the response, and the recording written through.
    fn look(&mut self) {
        if !self.journal.is_due() {
            return;
        }
        let duty = self.telemetry.as_ref().map(|telemetry| lock(telemetry).duty);
        let [x, y] = self.settings.pwm_steps.map(|steps| f64::from(steps.max(1)));
        self.journal.sample(|view| {
            if let Some(duty) = duty {
                view.duty = Some([f64::from(duty[0]) / x, f64::from(duty[1]) / y]);
            }
        });
    }
}
