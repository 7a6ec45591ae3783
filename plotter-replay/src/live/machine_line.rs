//! [`MachineLine`]: the line to a simulated machine in this program, in that machine's time.

use super::line::{Line, lock};
use super::pace::Pace;
use super::simulated::{EXCHANGE_EVERY, SimulatedMachine, Telemetry};
use crate::serial::{PortError, PortErrorKind};
use crate::simulation::Seen;
use core::fmt;
use core::time::Duration;
use std::io::{Sink, Write};
use std::sync::{Arc, Mutex};
use std::time::Instant;

/// The line to a simulated machine in this program.
///
/// The machine's time passes while it is listened to, and by nothing else: host and machine share it. So the
/// patience of both is right at any speed, and a session is the same, byte for byte, on a fast computer, a
/// busy one and one that is asleep for a while. The clock on the wall only says how soon that time may pass.
pub struct MachineLine<W: Write = Sink> {
    /// Bytes of the host that the machine has not seen.
    waiting: Mutex<Vec<u8>>,
    inside: Mutex<(SimulatedMachine<W>, Pace)>,
    telemetry: Arc<Mutex<Telemetry>>,
}

/// Bytes that wait for the machine at most; what is more is refused as a port refuses it.
const MOST_WAITING: usize = 1 << 20;
/// Longest wait for the clock at once, so that a person at a slow machine is heard.
const LONGEST_WAIT: Duration = Duration::from_millis(2);
/// So much time passes at least whenever the machine is listened to, lest a host with something overdue stand
/// still with it.
const LEAST_WAIT: Duration = Duration::from_micros(1);

impl<W: Write> MachineLine<W> {
    pub(super) fn new(machine: SimulatedMachine<W>, speed: f64) -> Self {
        let telemetry = machine.telemetry();
        Self { waiting: Mutex::default(), inside: Mutex::new((machine, Pace::new(speed))), telemetry }
    }

    /// What no byte on the line tells.
    #[must_use]
    pub fn telemetry(&self) -> Arc<Mutex<Telemetry>> {
        Arc::clone(&self.telemetry)
    }

    /// Where the machine stands.
    #[must_use]
    pub fn seen(&self) -> Seen {
        let (machine, _) = &*lock(&self.inside);
        machine.seen()
    }
}

impl<W: Write + Send> Line for MachineLine<W> {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        let mut waiting = lock(&self.waiting);
        if waiting.len().saturating_add(bytes.len()) > MOST_WAITING {
            let port = String::from("simulated machine");
            return Err(PortError { port, kind: PortErrorKind::Stuck });
        }
        waiting.extend_from_slice(bytes);
        Ok(())
    }

    fn offer(&self, bytes: &[u8]) -> Result<usize, PortError> {
        // What the machine lets through soon; a stop finds room in any case.
        let room = SimulatedMachine::<W>::MOST_ON_LINE.saturating_sub(lock(&self.waiting).len());
        let count = room.min(bytes.len());
        self.send(bytes.get(..count).unwrap_or_default())?;
        Ok(count)
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let (machine, pace) = &mut *lock(&self.inside);
        let until = machine.now().saturating_add(wait.max(LEAST_WAIT));
        loop {
            let count = machine.give(bytes);
            if count > 0 || machine.now() >= until {
                return Ok(count);
            }
            let to = machine.now().saturating_add(EXCHANGE_EVERY).min(until);
            let early = pace.wait(Instant::now(), to);
            std::thread::sleep(early.min(LONGEST_WAIT));
            if early > LONGEST_WAIT {
                return Ok(0); // its time has not come
            }
            if machine.has_line_room() {
                machine.take(&core::mem::take(&mut *lock(&self.waiting)));
            }
            machine.run_to(to);
        }
    }

    fn now(&self) -> Option<Duration> {
        Some(lock(&self.telemetry).time)
    }
}

impl<W: Write> fmt::Debug for MachineLine<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MachineLine").field("telemetry", &self.telemetry).finish_non_exhaustive()
    }
}
