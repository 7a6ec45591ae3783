//! [`Line`]: a serial line that two threads may use at once.

use crate::serial::{Port, PortError, PortErrorKind};
use core::fmt;
use core::time::Duration;
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// A serial line: one thread listens while another sends.
pub trait Line: Send + Sync + fmt::Debug {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    ///
    /// [`PortError`] if they cannot be sent.
    fn send(&self, bytes: &[u8]) -> Result<(), PortError>;

    /// Waits at most `wait` for bytes; says how many came, which may be none.
    ///
    /// # Errors
    ///
    /// [`PortError`] if nothing will ever come any more.
    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError>;
}

/// A serial port as a line.
#[derive(Debug)]
pub struct PortLine {
    reader: Mutex<Port>,
    writer: Mutex<Port>,
}

impl PortLine {
    /// The line of an open port.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the system has no second handle for it.
    pub fn new(port: Port) -> Result<Self, PortError> {
        Ok(Self { writer: Mutex::new(port.try_clone()?), reader: Mutex::new(port) })
    }
}

impl Line for PortLine {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        lock(&self.writer).send(bytes)
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        lock(&self.reader).receive(bytes, wait)
    }
}

/// One end of a line inside this program.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_replay::live::{Line, Pipe};
/// let (host, machine) = Pipe::pair();
/// host.send(b"42")?;
/// let mut bytes = [0; 8];
/// assert_eq!(machine.receive(&mut bytes, Duration::ZERO)?, 2);
/// drop(host);
/// assert!(machine.receive(&mut bytes, Duration::ZERO).is_err());
/// # Ok::<(), plotter_replay::serial::PortError>(())
/// ```
#[derive(Debug)]
pub struct Pipe {
    incoming: Arc<Channel>,
    outgoing: Arc<Channel>,
}

#[derive(Debug, Default)]
struct Channel {
    bytes: Mutex<(VecDeque<u8>, bool)>,
    changed: Condvar,
}

/// Bytes that wait in a pipe at most; what is more is refused as a port refuses it.
const MOST_WAITING: usize = 1 << 20;

impl Pipe {
    /// Both ends of a new line.
    #[must_use]
    pub fn pair() -> (Self, Self) {
        let (a, b) = (Arc::<Channel>::default(), Arc::<Channel>::default());
        (Self { incoming: Arc::clone(&a), outgoing: Arc::clone(&b) }, Self { incoming: b, outgoing: a })
    }

    fn error(kind: PortErrorKind) -> PortError {
        PortError { port: String::from("simulated machine"), kind }
    }
}

impl Line for Pipe {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        let mut inside = lock(&self.outgoing.bytes);
        if inside.1 {
            return Err(Self::error(PortErrorKind::Gone));
        }
        if inside.0.len().saturating_add(bytes.len()) > MOST_WAITING {
            return Err(Self::error(PortErrorKind::Stuck));
        }
        inside.0.extend(bytes);
        self.outgoing.changed.notify_all();
        Ok(())
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let inside = lock(&self.incoming.bytes);
        let (mut inside, _) = self
            .incoming
            .changed
            .wait_timeout_while(inside, wait, |(waiting, gone)| waiting.is_empty() && !*gone)
            .unwrap_or_else(PoisonError::into_inner);
        if inside.0.is_empty() && inside.1 {
            return Err(Self::error(PortErrorKind::Gone));
        }
        let mut count = 0;
        for place in bytes {
            let Some(byte) = inside.0.pop_front() else { break };
            *place = byte;
            count += 1;
        }
        Ok(count)
    }
}

impl Drop for Pipe {
    fn drop(&mut self) {
        for channel in [&self.incoming, &self.outgoing] {
            lock(&channel.bytes).1 = true;
            channel.changed.notify_all();
        }
    }
}

/// What a thread that panicked left is still whole: every change under these locks is one step.
pub(super) fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
