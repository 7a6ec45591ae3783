//! [`Showing`]: a session that only shows what another part of the program tells of a machine.

use super::line::{Line, lock};
use super::session::Shared;
use super::view::View;
use super::{Command, Session, State};
use crate::PlotterSettings;
use crate::log::Record;
use crate::serial::PortError;
use core::time::Duration;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Condvar, Mutex};
use std::time::Instant;

/// How often the response is sampled, by the clock.
const SAMPLE_EVERY: Duration = Duration::from_millis(20);

/// Tells a session what happens in a machine, and what somebody asks of it there.
///
/// ```
/// # use plotter_replay::{PlotterSettings, log::{Event, Record}};
/// # use plotter_replay::live::{Command, Showing, State};
/// let (session, mut showing) = Showing::new(PlotterSettings::default());
/// showing.push(&Record::at_us(900, Event::Controller(b"13".to_vec())));
/// session.command(Command::Stop);
/// assert_eq!(showing.commands(), [Command::Stop]);
/// assert_eq!(session.state(), State::Stopped);
/// ```
#[derive(Debug)]
pub struct Showing {
    shared: Arc<Shared>,
    sampled: Option<Instant>,
}

/// Nobody is at its other end: what is asked of the machine comes as a command.
#[derive(Debug)]
struct Nobody;

impl Line for Nobody {
    fn send(&self, _: &[u8]) -> Result<(), PortError> {
        Ok(())
    }
    fn receive(&self, _: &mut [u8], _: Duration) -> Result<usize, PortError> {
        Ok(0)
    }
}

impl Showing {
    /// A session of a machine with this scale, and what tells it.
    #[must_use]
    pub fn new(plotter: PlotterSettings) -> (Session, Self) {
        let mut view = View::new(plotter, State::Watching, None);
        view.recording = String::from("none");
        let shared = Arc::new(Shared {
            line: Arc::new(Nobody),
            view: Mutex::new(view),
            commands: Mutex::default(),
            stops: &[],
            may_be_linked: AtomicBool::new(false),
            stop_is_new: Mutex::default(),
            finished: Condvar::new(),
        });
        (Session::of(Arc::clone(&shared)), Self { shared, sampled: None })
    }

    /// What became of the recording, in words.
    pub fn recording(&self, words: &str) {
        lock(&self.shared.view).recording = words.to_owned();
    }

    /// Takes what happened.
    pub fn push(&self, record: &Record) {
        lock(&self.shared.view).push(record);
    }

    /// The machine's time is `now`: now and then its place is sampled.
    pub fn tick(&mut self, now: Duration) {
        let clock = Instant::now();
        if self.sampled.is_none_or(|last| clock.saturating_duration_since(last) >= SAMPLE_EVERY) {
            self.sampled = Some(clock);
            lock(&self.shared.view).sample(now);
        }
    }

    /// What was asked since the last time; the session shows it as done.
    pub fn commands(&self) -> Vec<Command> {
        let commands: Vec<Command> = lock(&self.shared.commands).drain(..).collect();
        let mut view = lock(&self.shared.view);
        for &command in &commands {
            match command {
                Command::Clear => view.clear(),
                // There is nothing to begin or to go on with but to watch.
                Command::Resume if view.state == State::Stopped => view.state = State::Watching,
                Command::Stop => view.state = State::Stopped,
                _ => {}
            }
        }
        *lock(&self.shared.stop_is_new) = false;
        commands
    }
}
