//! [`Line`]: a serial line that two threads may use at once.

use crate::serial::{Port, PortError, PortErrorKind};
use core::fmt;
use core::time::Duration;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// A serial line: one thread listens while another sends.
pub trait Line: Send + Sync + fmt::Debug {
    /// Sends all of `bytes`.
    ///
    /// # Errors
    ///
    /// [`PortError`] if they cannot be sent.
    fn send(&self, bytes: &[u8]) -> Result<(), PortError>;

    /// Sends as many of `bytes` as the line takes at once; says how many that were.
    ///
    /// # Errors
    ///
    /// [`PortError`] if nothing will ever be taken any more.
    fn offer(&self, bytes: &[u8]) -> Result<usize, PortError> {
        self.send(bytes).map(|()| bytes.len())
    }

    /// Waits at most `wait` for bytes, in the time of the line; says how many came, which may be none.
    ///
    /// # Errors
    ///
    /// [`PortError`] if nothing will ever come any more.
    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError>;

    /// The time of the line, where that is not the clock's: that of a simulated machine, which passes while
    /// it is listened to.
    fn now(&self) -> Option<Duration> {
        None
    }
}

impl<L: Line + ?Sized> Line for Arc<L> {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        (**self).send(bytes)
    }

    fn offer(&self, bytes: &[u8]) -> Result<usize, PortError> {
        (**self).offer(bytes)
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        (**self).receive(bytes, wait)
    }

    fn now(&self) -> Option<Duration> {
        (**self).now()
    }
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

    fn offer(&self, bytes: &[u8]) -> Result<usize, PortError> {
        lock(&self.writer).offer(bytes)
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        lock(&self.reader).receive(bytes, wait)
    }
}

/// How long bytes may wait to be sent, as on a serial port.
const SEND_WITHIN: Duration = Duration::from_secs(5);
/// How often it is looked whether something has come, or has room: systems wait for a socket in ticks of some
/// milliseconds, longer than a session listens.
pub(super) const LOOK_EVERY: Duration = Duration::from_micros(500);

/// Sends all of `bytes` on a line that takes some at a time.
pub(super) fn send_all(line: &impl Line, name: &str, mut bytes: &[u8]) -> Result<(), PortError> {
    let until = Instant::now() + SEND_WITHIN;
    while !bytes.is_empty() {
        let sent = line.offer(bytes)?;
        bytes = bytes.get(sent..).unwrap_or_default();
        if sent == 0 {
            if Instant::now() >= until {
                return Err(PortError { port: name.to_owned(), kind: PortErrorKind::Stuck });
            }
            std::thread::sleep(LOOK_EVERY);
        }
    }
    Ok(())
}

/// What a thread that panicked left is still whole: every change under these locks is one step.
pub(super) fn lock<T: ?Sized>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
