//! [`Recording`]: where a session's log comes from; [`MachineLog`], the log that a simulated machine writes
//! of itself.

use super::line::lock;
use crate::BenchRecorder;
use crate::log::{Event, Record, WriteError, Writer};
use core::time::Duration;
use std::io::Write;
use std::sync::{Arc, Mutex};

/// The log of a simulated machine as a recorder inside it sees it: each byte when it is through, each edge,
/// each duty, in the machine's own time. With it the controller can be run again to the same bytes. Clones
/// write into the same log.
#[derive(Debug)]
pub struct MachineLog<W: Write> {
    inside: Arc<Mutex<Inside<W>>>,
}

#[derive(Debug)]
struct Inside<W: Write> {
    /// `None` once it is finished.
    recorder: Option<BenchRecorder<W>>,
    /// The machine's time.
    now: Duration,
}

impl<W: Write> Clone for MachineLog<W> {
    fn clone(&self) -> Self {
        Self { inside: Arc::clone(&self.inside) }
    }
}

impl<W: Write> MachineLog<W> {
    /// A log that goes to `writer`.
    #[must_use]
    pub fn new(writer: Writer<W>) -> Self {
        let recorder = Some(BenchRecorder::new(writer));
        Self { inside: Arc::new(Mutex::new(Inside { recorder, now: Duration::ZERO })) }
    }

    /// What happens in the machine.
    pub(super) fn record(&self, time: Duration, event: Event) {
        let inside = &mut *lock(&self.inside);
        inside.now = time;
        if let Some(recorder) = &mut inside.recorder {
            recorder.write(time, event);
        }
    }

    /// What its host adds, at the machine's time.
    fn write(&self, event: Event) {
        let inside = &mut *lock(&self.inside);
        if let Some(recorder) = &mut inside.recorder {
            recorder.write(inside.now, event);
        }
    }

    /// Writes through what has waited long enough.
    pub(super) fn tick(&self, now: Duration) {
        if let Some(recorder) = &mut lock(&self.inside).recorder {
            recorder.tick(now);
        }
    }

    /// Why nothing is written any more, if so.
    #[must_use]
    pub fn failure(&self) -> Option<WriteError> {
        lock(&self.inside).recorder.as_ref().and_then(BenchRecorder::failure).cloned()
    }

    /// Ends the log; what the machine does later is in none.
    ///
    /// # Errors
    ///
    /// [`WriteError`] if not all of it is written.
    pub fn finish(&self) -> Result<(), WriteError> {
        let recorder = lock(&self.inside).recorder.take();
        recorder.map_or(Ok(()), |recorder| recorder.finish().map(drop))
    }
}

/// Where a session's log comes from.
#[derive(Debug)]
pub enum Recording<W: Write> {
    /// The session writes what it sends and hears: of a machine on a port nobody knows more.
    Line(Writer<W>),
    /// The simulated machine at the other end writes it; the session adds what it notices.
    Machine(MachineLog<W>),
}

impl<W: Write> Recording<W> {
    pub(super) fn write(&mut self, record: &Record) -> Result<(), WriteError> {
        match (self, &record.event) {
            (Self::Line(writer), _) => writer.write(record),
            (Self::Machine(_), Event::Host(_) | Event::Controller(_)) => Ok(()),
            (Self::Machine(log), event) => {
                log.write(event.clone());
                log.failure().map_or(Ok(()), Err)
            }
        }
    }

    /// Writes through what has waited long enough; a machine does that itself.
    pub(super) fn tick(&mut self, now: Duration) -> Result<(), WriteError> {
        match self {
            Self::Line(writer) => writer.tick(now),
            Self::Machine(log) => log.failure().map_or(Ok(()), Err),
        }
    }

    pub(super) fn finish(self) -> Result<(), WriteError> {
        match self {
            Self::Line(writer) => writer.finish().map(drop),
            Self::Machine(log) => log.finish(),
        }
    }
}
