//! A session with a simulated machine that is looked at, and asked for something, in the machine's time.

use plotter_motion::{Machine, MachineConfig, PenMove};
use plotter_replay::live::{
    Command, DrawingStep, Line, MachineLine, Recording, Session, SessionSettings, State, Telemetry,
};
use plotter_replay::serial::{PortError, PortErrorKind};
use std::fmt;
use std::io::Write;
use std::panic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// As fast as it goes: nothing here goes by the clock on the wall.
pub(crate) const AS_FAST_AS_IT_GOES: f64 = 1e6;
/// Longer than any session here takes on a computer that is busy with other things; only what never ends is
/// ended by it.
pub(crate) const FOR_EVER: Duration = Duration::from_secs(600);

/// The gantry with a host that does not pause between bytes.
pub(crate) fn machine() -> Machine {
    let config = MachineConfig::default();
    Machine::new(config.with_serial(config.serial.with_byte_gap_ms(0.0))).unwrap()
}

/// Something that is done at a look, or looked for; true once it is over.
pub(crate) type Step = Box<dyn FnMut(&Session, Telemetry) -> bool + Send>;

/// A line whose machine is looked at whenever the session has listened to it: in the machine's time.
pub(crate) struct Watched<W: Write> {
    line: MachineLine<W>,
    session: OnceLock<Session>,
    /// What is still to be done, the next at the end.
    steps: Mutex<Vec<Step>>,
    /// Whether the line is cut when all is done.
    is_cut: bool,
    /// Whether a step has failed: the line is cut at once.
    has_failed: AtomicBool,
}

impl<W: Write> fmt::Debug for Watched<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Watched")
    }
}

impl<W: Write + Send> Line for Watched<W> {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        self.line.send(bytes)
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let count = self.line.receive(bytes, wait)?;
        let now = *self.line.telemetry().lock().unwrap();
        let mut steps = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
        let session = self.session.wait();
        let is_done = |step: &mut Step| panic::catch_unwind(panic::AssertUnwindSafe(|| step(session, now)));
        while let Some(step) = steps.last_mut() {
            match is_done(step) {
                Ok(true) => drop(steps.pop()),
                Ok(false) => break,
                Err(_) => {
                    self.has_failed.store(true, Ordering::SeqCst); // (its words are on the screen)
                    return Err(PortError { port: String::from("here"), kind: PortErrorKind::Gone });
                }
            }
        }
        if self.is_cut && steps.is_empty() {
            return Err(PortError { port: String::from("here"), kind: PortErrorKind::Gone });
        }
        Ok(count)
    }

    fn now(&self) -> Option<Duration> {
        self.line.now()
    }
}

/// A session that is over; `steps` were done in their order while it went on.
pub(crate) fn watched<W: Write + Send + 'static, R: Write + Send + 'static>(
    line: MachineLine<W>,
    moves: Vec<PenMove>,
    recording: Option<Recording<R>>,
    settings: SessionSettings,
    steps: Vec<Step>,
) -> Session {
    let drawing = moves.into_iter().map(DrawingStep::from).collect();
    let (session, line) = begun(line, Some(drawing), recording, settings, steps, false);
    assert_eq!(session.wait(FOR_EVER), State::Done);
    assert!(line.steps.lock().unwrap().is_empty(), "the session was over before all was done");
    session
}

/// The same of one that is led by hand, too. Without a drawing it does not end by itself: its line is cut
/// behind the last step.
pub(crate) fn led<W: Write + Send + 'static, R: Write + Send + 'static>(
    line: MachineLine<W>,
    drawing: Option<Vec<DrawingStep>>,
    recording: Option<Recording<R>>,
    settings: SessionSettings,
    steps: Vec<Step>,
) -> Session {
    let is_cut = drawing.is_none();
    let (session, line) = begun(line, drawing, recording, settings, steps, is_cut);
    let state = session.wait(FOR_EVER);
    assert!(!line.has_failed.load(Ordering::SeqCst), "a step failed: {:?}", session.messages());
    assert!(line.steps.lock().unwrap().is_empty(), "{state:?} before all was done: {:?}", session.messages());
    session
}

fn begun<W: Write + Send + 'static, R: Write + Send + 'static>(
    line: MachineLine<W>,
    drawing: Option<Vec<DrawingStep>>,
    recording: Option<Recording<R>>,
    settings: SessionSettings,
    mut steps: Vec<Step>,
    is_cut: bool,
) -> (Session, Arc<Watched<W>>) {
    steps.reverse();
    let telemetry = Some(line.telemetry());
    let line = Arc::new(Watched {
        line,
        session: OnceLock::new(),
        steps: Mutex::new(steps),
        is_cut,
        has_failed: AtomicBool::new(false),
    });
    let state = if drawing.is_some() { State::Ready } else { State::Watching };
    let drawing = drawing.map(|steps| Box::new(steps.into_iter()) as _);
    let session = Session::open(Arc::clone(&line) as _, drawing, recording, telemetry, settings);
    assert_eq!(session.state(), state);
    line.session.set(session.clone()).unwrap();
    (session, line)
}

pub(crate) fn ask_for(command: Command) -> Step {
    Box::new(move |session, _| {
        session.command(command);
        true
    })
}

pub(crate) fn until_it_moves() -> Step {
    Box::new(|_, now| now.duty != [0, 0])
}

pub(crate) fn until_it_is(state: State) -> Step {
    Box::new(move |session, _| session.state() == state)
}

/// So long in the machine's time; each time of it `check` is asked.
pub(crate) fn during(time: Duration, mut check: impl FnMut(&Session, Telemetry) + Send + 'static) -> Step {
    let mut until = None;
    Box::new(move |session, now| {
        check(session, now);
        now.time >= *until.get_or_insert(now.time + time)
    })
}

/// Until what was asked by hand is taken, `asked` times so far, and the machine rests.
pub(crate) fn until_it_rests(asked: u64) -> Step {
    Box::new(move |session, _| {
        let hand = session.by_hand();
        hand.taken >= asked && hand.rests
    })
}
