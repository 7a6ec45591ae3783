//! [`relay`]: between a host and a controller, both ways, with everything recorded.

use super::Recorder;
use crate::import::Side;
use core::fmt;
use core::time::Duration;
use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// After bytes have come, so long is waited for more, which are then read together: the 64 bytes of a record
/// at 256000 baud. A full line needs no 25 600 wake-ups a second. The first byte after a silence goes on at
/// once.
const TOGETHER: Duration = Duration::from_micros(2_500);
/// So long at most, where the line is full: nobody waits for the next byte then. (A wake-up with its reading
/// and sending costs some 30 us, whatever is read.)
const MOST_TOGETHER: Duration = Duration::from_millis(10);
/// The wait is this many times what the bytes just read take on the line, over [`LINE_PARTS`]: on a full
/// line it grows with each read. A host that waits for the answer to each line is held up for a third of
/// that line at most.
const WAIT_PARTS: u64 = 4;
/// See [`WAIT_PARTS`].
const LINE_PARTS: u64 = 3;
/// Bits of a byte on the line: a start bit, eight of data and a stop bit.
const BITS: u64 = 10;
/// A host that takes nothing for so long does not read: what the controller says is recorded all the same.
const HOST_TAKES_WITHIN: Duration = Duration::from_secs(1);
/// Bytes read at once.
const READ_BYTES: usize = 4_096;
/// Bytes sent at once: a line that takes some may not take many without waiting. A serial port of Linux has
/// room for several times that whenever it says that it has any. What a full line at 256000 baud brings
/// within [`MOST_TOGETHER`], on a busy computer too, goes on in one piece.
const SEND_BYTES: usize = 512;

/// One end of a line: what comes from it and what goes to it. Both have time-outs of some tenths of a second,
/// or the relay cannot be stopped.
pub struct RelayEnd {
    /// What it is called, for messages.
    pub name: String,
    /// What comes from it.
    pub reader: Box<dyn Read + Send>,
    /// What goes to it.
    pub writer: Box<dyn Write + Send>,
}

impl fmt::Debug for RelayEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RelayEnd").field("name", &self.name).finish_non_exhaustive()
    }
}

/// Why a relay has ended.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RelayStop {
    /// It was told to.
    Asked,
    /// An end has gone away.
    Gone {
        /// Which.
        name: String,
        /// What the system says.
        message: String,
    },
}

impl fmt::Display for RelayStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Asked => write!(f, "stopped"),
            Self::Gone { name, message } => {
                write!(f, "{name} has gone away ({message}): what came until then is recorded")
            }
        }
    }
}

/// Passes every byte on, both ways, and records it, until `stop` is set or an end goes away. Does not end the
/// recording.
///
/// A byte is recorded before it goes on, which costs a copy in memory: so an answer never stands before what
/// it answers. If the recording fails, the bytes go on without it.
///
/// `baud` is the line's speed, bits a second: by it a full line is known, whose bytes are read and passed
/// on up to 10 ms later, many at a time. All others go on within 2.5 ms, or a third of the time that the
/// bytes before them take on the line.
#[must_use]
pub fn relay(
    host: RelayEnd,
    controller: RelayEnd,
    baud: u32,
    recorder: &Recorder,
    stop: &Arc<AtomicBool>,
) -> RelayStop {
    let first: Mutex<Option<RelayStop>> = Mutex::new(None);
    let (host_name, controller_name) = (host.name, controller.name);
    let end = |result: Result<(), (String, io::Error)>| {
        if let Err((name, error)) = result {
            recorder.note(&format!("recorder: {name} has gone away: {error}"));
            let gone = RelayStop::Gone { name, message: error.to_string() };
            first.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(gone);
        }
        stop.store(true, Ordering::Relaxed);
    };
    let up = Way {
        side: Side::Host,
        baud,
        from: (host_name.clone(), host.reader),
        to: (controller_name.clone(), controller.writer),
        // What a controller does not take waits: a drawing must not have holes.
        drops_after: None,
    };
    let down = Way {
        side: Side::Controller,
        baud,
        from: (controller_name, controller.reader),
        to: (host_name, host.writer),
        drops_after: Some(HOST_TAKES_WITHIN),
    };
    std::thread::scope(|scope| {
        scope.spawn(|| end(up.run(recorder, stop)));
        end(down.run(recorder, stop));
    });
    first.into_inner().unwrap_or_else(PoisonError::into_inner).unwrap_or(RelayStop::Asked)
}

/// One direction.
struct Way {
    side: Side,
    /// Bits a second.
    baud: u32,
    from: (String, Box<dyn Read + Send>),
    to: (String, Box<dyn Write + Send>),
    /// After how long bytes that are not taken are dropped.
    drops_after: Option<Duration>,
}

impl Way {
    fn run(self, recorder: &Recorder, stop: &AtomicBool) -> Result<(), (String, io::Error)> {
        let (from, mut reader) = self.from;
        let (to, mut writer) = self.to;
        let mut buffer = [0; READ_BYTES];
        let mut dropped = 0_usize;
        while !stop.load(Ordering::Relaxed) {
            let bytes = match reader.read(&mut buffer) {
                Ok(0) => return Err((from, io::ErrorKind::UnexpectedEof.into())),
                Ok(count) => buffer.get(..count).unwrap_or_default(),
                Err(error) if passes(&error) => continue,
                Err(error) => return Err((from, error)),
            };
            // While a host does not read, it is tried with one byte at a time, so that nothing waits for it.
            let wait = if dropped > 0 { Some(Duration::ZERO) } else { self.drops_after };
            // Before it goes on: an answer must not stand before what it answers.
            recorder.bytes(self.side, bytes);
            let left = send(&mut *writer, bytes, wait, stop).map_err(|error| (to.clone(), error))?;
            if left > 0 && dropped == 0 {
                recorder
                    .note(&format!("recorder: {to} takes no bytes: they are recorded, but do not reach it"));
            }
            if left == 0 && dropped > 0 {
                recorder.note(&format!("recorder: {to} takes bytes again; {dropped} did not reach it"));
                dropped = 0;
            }
            dropped = dropped.saturating_add(left);
            std::thread::sleep(together(bytes.len(), self.baud));
        }
        Ok(())
    }
}

/// How long is waited for more, after so many bytes have been read.
fn together(bytes: usize, baud: u32) -> Duration {
    let bits_m = (bytes as u64).saturating_mul(BITS * 1_000_000);
    let on_line_us = bits_m / u64::from(baud.max(1));
    let wait_us = on_line_us.saturating_mul(WAIT_PARTS) / LINE_PARTS;
    Duration::from_micros(wait_us).clamp(TOGETHER, MOST_TOGETHER)
}

fn passes(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}

/// Sends bytes; how many were not taken.
fn send(
    writer: &mut dyn Write,
    bytes: &[u8],
    wait: Option<Duration>,
    stop: &AtomicBool,
) -> io::Result<usize> {
    let began = Instant::now();
    let mut rest = bytes;
    while !rest.is_empty() {
        let part = rest.get(..rest.len().min(SEND_BYTES)).unwrap_or(rest);
        match writer.write(part) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(count) => rest = rest.get(count..).unwrap_or_default(),
            Err(error) if passes(&error) => {
                if wait.is_some_and(|wait| began.elapsed() >= wait) || stop.load(Ordering::Relaxed) {
                    return Ok(rest.len());
                }
            }
            Err(error) => return Err(error),
        }
    }
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The wait in the end, on a line that is so many percent full.
    fn settled(baud: u32, percent: u128) -> Duration {
        let (mut time, mut read, mut wait) = (Duration::ZERO, 0, TOGETHER);
        for _ in 0..100 {
            time += wait;
            let came = time.as_micros() * u128::from(baud) * percent / 1_000_000_000;
            wait = together(usize::try_from(came - read).unwrap(), baud);
            read = came;
        }
        wait
    }

    #[test]
    fn only_a_full_line_waits_long_whatever_its_speed() {
        for baud in [9_600, 57_600, 115_200, 256_000, 1_000_000] {
            assert_eq!(settled(baud, 95), MOST_TOGETHER, "{baud}");
            assert!(settled(baud, 70) < Duration::from_millis(3), "{baud}");
        }
        // Twenty bytes at 9600 baud take 20.8 ms, an `ok` at 115200 a third of a millisecond.
        assert_eq!(together(20, 9_600), MOST_TOGETHER);
        assert_eq!(together(4, 115_200), TOGETHER);
        // 36 bytes at 115200 baud take 3.125 ms.
        assert_eq!(together(36, 115_200), Duration::from_micros(4_166));
        assert_eq!(together(0, 0), TOGETHER);
    }
}
