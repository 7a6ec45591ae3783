//! [`Session`]: a drawing on its way to a machine.

use super::desk::Steps;
use super::engine::Engine;
use super::hosted::HostedEngine;
use super::line::{Line, lock};
use super::machine_log::Recording;
use super::timetable::Timetable;
use super::view::{Cursor, HandProgress, Hosted, View};
use super::{Command, DrawingStep, LinkChoice, SessionSettings, State, Telemetry};
use crate::virtual_plotter::CountedBy;
use core::time::Duration;
use plotter_motion::protocol::Order;
use plotter_motion::protocol::hosts::MachineHost;
use serde_json::Value;
use std::collections::VecDeque;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;

/// A drawing on its way to a machine, in a thread of its own; clones are handles of the same session.
#[derive(Clone, Debug)]
pub struct Session {
    shared: Arc<Shared>,
}

/// What a session's handles and its loop have in common.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) line: Arc<dyn Line>,
    pub(super) view: Mutex<View>,
    pub(super) commands: Mutex<VecDeque<Command>>,
    /// What stops the machine at once, where it does not speak digits or frames; none if nothing does.
    pub(super) stops: &'static [u8],
    /// Whether the machine may speak frames, so that a stop is `00 21 00`.
    pub(super) may_be_linked: AtomicBool,
    /// Whether a stop is on the line that the session's loop has not taken note of: until then it sends
    /// nothing, lest it sends an older order to go on.
    pub(super) stop_is_new: Mutex<bool>,
    pub(super) finished: Condvar,
}

impl Session {
    /// Opens a session on `line`. With a drawing it waits for [`Command::Start`]; without, it watches, and
    /// the machine is led by hand only: nothing is sent before somebody asks for it. What happens goes to
    /// `recorder`. What no byte tells of a simulated machine comes from `telemetry`.
    #[must_use]
    pub fn open<W: Write + Send + 'static>(
        line: Arc<dyn Line>,
        drawing: Option<Box<dyn Iterator<Item = DrawingStep> + Send>>,
        recorder: Option<Recording<W>>,
        telemetry: Option<Arc<Mutex<Telemetry>>>,
        mut settings: SessionSettings,
    ) -> Self {
        let may_be_linked = settings.link != LinkChoice::Digits;
        if may_be_linked {
            settings.plotter.counted_by = CountedBy::Link;
        }
        let state = if drawing.is_some() { State::Ready } else { State::Watching };
        let mut view = View::new(settings.plotter, state, settings.plan);
        view.recording = String::from(if recorder.is_some() { "on" } else { "none" });
        let view = Mutex::new(view);
        let shared = Arc::new(Shared {
            line,
            view,
            commands: Mutex::default(),
            stops: const { &[Order::Stop.byte()] },
            may_be_linked: AtomicBool::new(may_be_linked),
            stop_is_new: Mutex::default(),
            finished: Condvar::new(),
        });
        let session = Self { shared: Arc::clone(&shared) };
        let drawing: Option<Steps> = drawing;
        thread::spawn(move || Engine::new(drawing, recorder, telemetry, settings, &shared).run());
        session
    }

    /// Opens a session of a machine that is led by lines of text. `drawing` is what its host has to send, if
    /// that is anything; without, it is led by hand only.
    #[must_use]
    pub fn hosted<W: Write + Send + 'static>(
        line: Arc<dyn Line>,
        host: Box<dyn MachineHost + Send>,
        drawing: Option<Timetable>,
        recorder: Option<Recording<W>>,
        settings: SessionSettings,
    ) -> Self {
        let plan = drawing.as_ref().map(Timetable::plan);
        let mut view = View::new(settings.plotter, State::Connecting, plan);
        view.hosted = Some(Hosted { feed_percent: 100, ..Hosted::default() });
        view.recording = String::from(if recorder.is_some() { "on" } else { "none" });
        let shared = Arc::new(Shared {
            line,
            view: Mutex::new(view),
            commands: Mutex::default(),
            stops: host.stop_bytes(),
            may_be_linked: AtomicBool::new(false),
            stop_is_new: Mutex::default(),
            finished: Condvar::new(),
        });
        let session = Self { shared: Arc::clone(&shared) };
        thread::spawn(move || HostedEngine::new(host, drawing, recorder, settings, &shared).run());
        session
    }

    pub(super) fn of(shared: Arc<Shared>) -> Self {
        Self { shared }
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

    /// How far what was asked by hand is ([`Command::Hand`]).
    #[must_use]
    pub fn by_hand(&self) -> HandProgress {
        let view = lock(&self.shared.view);
        HandProgress { at: view.position(), ..view.hand.clone() }
    }

    /// What was said last, with its time on the line.
    #[must_use]
    pub fn messages(&self) -> Vec<(Duration, String)> {
        lock(&self.shared.view).messages.iter().cloned().collect()
    }

    /// What a person has to do before it goes on; empty for nothing.
    #[must_use]
    pub fn wants(&self) -> String {
        lock(&self.shared.view).wants.clone()
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
    /// What stops the machine at once: a zero on either side makes a stop by itself of it where frames are
    /// spoken.
    pub(super) fn stop_bytes(&self) -> &'static [u8] {
        if self.may_be_linked.load(Ordering::Relaxed) {
            const { &[0, Order::Stop.byte(), 0] }
        } else {
            self.stops
        }
    }
}
