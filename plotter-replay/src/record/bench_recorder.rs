//! [`BenchRecorder`]: writes the log of a simulated machine.

use crate::log::{Event, Record, WriteError, Writer};
use core::time::Duration;
use plotter_motion::Pen;
use plotter_motion::plant::BenchEvent;
use plotter_motion::protocol::HostEvent;
use std::io::Write;

/// Writes what happens on a simulated bench ([`plotter_motion::plant::Bench`]) into a log: bytes, edges and
/// duty cycles with their exact times, the pen where it changes, and what host and controller notice as
/// notes.
///
/// ```
/// # use plotter_motion::plant::{Bench, BenchSettings};
/// # use plotter_motion::{Machine, MachineConfig, Pen, PenMove, StepPoint};
/// # use plotter_replay::{BenchRecorder, Player, log::{Header, Reader, Writer}, player::MachineController};
/// let machine = Machine::new(MachineConfig::default())?;
/// let moves = [PenMove { pen: Pen::Down, target: StepPoint::new(40, 20) }];
/// let mut bench = Bench::new(&machine, BenchSettings::default(), moves.into_iter());
/// let header = Header::new().with_number("baud", 256_000);
/// let mut recorder = BenchRecorder::new(Writer::new(Vec::new(), &header)?);
/// while !bench.host().is_done() {
///     bench.step(|time, event| recorder.record(time, event));
/// }
/// let log = recorder.finish()?;
///
/// // the log says all that a controller needs to do the same again
/// let records = Reader::new(&log[..])?.map(|record| record.unwrap());
/// assert!(Player::default().check(records, MachineController::new(&machine)).is_equal());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct BenchRecorder<W: Write> {
    writer: Writer<W>,
    pen: Option<Pen>,
    error: Option<WriteError>,
}

impl<W: Write> BenchRecorder<W> {
    /// Records into `writer`.
    #[must_use]
    pub fn new(writer: Writer<W>) -> Self {
        Self { writer, pen: None, error: None }
    }

    /// Takes one event. After the first error nothing more is written; [`BenchRecorder::finish`] tells it.
    pub fn record(&mut self, time: Duration, event: BenchEvent) {
        let event = match event {
            BenchEvent::HostByte(byte) => Event::Host(vec![byte]),
            BenchEvent::ControllerByte(byte) => Event::Controller(vec![byte]),
            BenchEvent::Edge(axis, sign) => Event::Edge { axis, sign },
            BenchEvent::Drive(axis, duty) => Event::Drive { axis, duty },
            BenchEvent::Host(HostEvent::Begun(next)) => {
                if self.pen.replace(next.pen) == Some(next.pen) {
                    return;
                }
                Event::Pen(next.pen)
            }
            BenchEvent::Host(HostEvent::Reached(_)) => return,
            BenchEvent::Host(HostEvent::Notice(notice)) => Event::Note(format!("host: {notice}")),
            BenchEvent::Controller(notice) => Event::Note(format!("controller: {notice}")),
        };
        self.write(time, event);
    }

    /// Takes what the bench does not tell of itself: a switch that was pressed, an emergency stop, a note.
    /// Call it before the controller is told, so that the log has what comes of it afterwards.
    pub fn write(&mut self, time: Duration, event: Event) {
        if self.error.is_none() {
            self.error = self.writer.write(&Record { time, event }).err();
        }
    }

    /// Writes through what waits since half a second: see [`Writer::tick`].
    pub fn tick(&mut self, now: Duration) {
        if self.error.is_none() {
            self.error = self.writer.tick(now).err();
        }
    }

    /// Why nothing is written any more, if so.
    #[must_use]
    pub const fn failure(&self) -> Option<&WriteError> {
        self.error.as_ref()
    }

    /// Writes everything through and gives the sink back.
    ///
    /// # Errors
    ///
    /// The first [`WriteError`] of all.
    pub fn finish(self) -> Result<W, WriteError> {
        match self.error {
            Some(error) => Err(error),
            None => self.writer.finish(),
        }
    }
}
