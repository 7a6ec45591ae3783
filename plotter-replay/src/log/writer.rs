//! [`Writer`]: appends records so that a kill costs at most the last half second.

use super::text::write_line;
use super::{EventRef, Header, MAX_LINE_BYTES, Record, RecordRef};
use core::fmt;
use core::time::Duration;
use std::io::Write;

/// Greatest age, in record time, of a record that is not written through yet.
const FLUSH_AFTER: Duration = Duration::from_millis(500);
/// Text that is gathered before it is handed on, bytes: a disk's block or two, so that a record costs no
/// write of its own.
const GATHER_BYTES: usize = 8_192;

/// Appends records to a log, whole lines at a time.
///
/// What is older than 0.5 s is always written through: each [`Writer::write`] looks after that by the time of
/// its record, and on a silent line [`Writer::tick`] does. A killed program therefore leaves every older
/// record readable, and at most one cut line.
///
/// ```
/// # use plotter_replay::log::{Event, Header, Record, Writer};
/// let mut writer = Writer::new(Vec::new(), &Header::new().with_number("baud", 256_000))?;
/// writer.write(&Record::at_us(10_312, Event::Controller(b"131".to_vec())))?;
/// let log = writer.finish()?;
/// assert_eq!(log, b"plotter-log 1 {\"baud\":256000,\"sum\":\"30\"}\n10312 < 31 33 31 *87\n");
/// # Ok::<(), plotter_replay::log::WriteError>(())
/// ```
#[derive(Debug)]
pub struct Writer<W: Write> {
    // `None` once it was given back.
    inner: Option<W>,
    gathered: Vec<u8>,
    last: Duration,
    /// Time of the oldest record that is not written through.
    oldest: Option<Duration>,
}

/// Why a record cannot be written.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WriteError {
    /// The sink refused.
    Sink {
        /// What it says.
        message: String,
    },
    /// The record is earlier than the one before.
    TimeGoesBack {
        /// Its time.
        time: Duration,
        /// The time before.
        previous: Duration,
    },
    /// The time does not fit 64 bits of microseconds (584 000 years).
    TimeTooLarge {
        /// The time.
        time: Duration,
    },
    /// A record of bytes without a byte.
    NoBytes,
    /// The line would be longer than [`MAX_LINE_BYTES`].
    TooLong {
        /// How long, bytes.
        bytes: usize,
    },
}

impl<W: Write> Writer<W> {
    /// Starts a log on `inner` with its first line, written through.
    ///
    /// # Errors
    ///
    /// [`WriteError::Sink`], or [`WriteError::TooLong`] for a header that no reader would take.
    pub fn new(inner: W, header: &Header) -> Result<Self, WriteError> {
        let first = format!("{}\n", header.to_line()).into_bytes();
        if first.len() > MAX_LINE_BYTES {
            return Err(WriteError::TooLong { bytes: first.len() });
        }
        let mut writer = Self { inner: Some(inner), gathered: first, last: Duration::ZERO, oldest: None };
        writer.flush()?;
        Ok(writer)
    }

    /// Appends one record; parts of a microsecond are dropped from its time.
    ///
    /// # Errors
    ///
    /// [`WriteError`]. Except for [`WriteError::Sink`], nothing of the record is in the log then, and the
    /// next one may be written.
    pub fn write(&mut self, record: &Record) -> Result<(), WriteError> {
        self.write_ref(&record.view())
    }

    /// The same with a record that borrows its bytes.
    ///
    /// # Errors
    ///
    /// [`WriteError`], as [`Writer::write`].
    pub fn write_ref(&mut self, record: &RecordRef<'_>) -> Result<(), WriteError> {
        let Ok(time_us) = u64::try_from(record.time.as_micros()) else {
            return Err(WriteError::TimeTooLarge { time: record.time });
        };
        let time = Duration::from_micros(time_us);
        if time < self.last {
            return Err(WriteError::TimeGoesBack { time, previous: self.last });
        }
        if matches!(record.event, EventRef::Host([]) | EventRef::Controller([])) {
            return Err(WriteError::NoBytes);
        }
        let before = self.gathered.len();
        write_line(&mut self.gathered, time_us, &record.event);
        let bytes = self.gathered.len().saturating_sub(before);
        if bytes > MAX_LINE_BYTES {
            self.gathered.truncate(before);
            return Err(WriteError::TooLong { bytes });
        }
        self.last = time;
        self.oldest.get_or_insert(time);
        if self.gathered.len() >= GATHER_BYTES {
            self.hand_on()?;
        }
        self.tick(time)
    }

    /// Writes through what is older than 0.5 s at `now`: to be called now and then while the line is silent.
    ///
    /// # Errors
    ///
    /// [`WriteError::Sink`].
    pub fn tick(&mut self, now: Duration) -> Result<(), WriteError> {
        match self.oldest {
            Some(oldest) if now.saturating_sub(oldest) >= FLUSH_AFTER => self.flush(),
            _ => Ok(()),
        }
    }

    /// Writes everything through.
    ///
    /// # Errors
    ///
    /// [`WriteError::Sink`].
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.hand_on()?;
        self.oldest = None;
        self.inner.as_mut().map_or(Ok(()), Write::flush).map_err(sink)
    }

    /// Writes everything through and gives the sink back.
    ///
    /// # Errors
    ///
    /// [`WriteError::Sink`].
    pub fn finish(mut self) -> Result<W, WriteError> {
        self.flush()?;
        self.inner.take().ok_or_else(|| WriteError::Sink { message: String::from("already given back") })
    }

    fn hand_on(&mut self) -> Result<(), WriteError> {
        // Cleared even when the sink fails: a part of it may be out, and must not go out twice.
        let result = self.inner.as_mut().map_or(Ok(()), |inner| inner.write_all(&self.gathered));
        self.gathered.clear();
        result.map_err(sink)
    }
}

impl<W: Write> Drop for Writer<W> {
    fn drop(&mut self) {
        // There is nobody left to tell.
        let _ = self.flush();
    }
}

fn sink(error: std::io::Error) -> WriteError {
    WriteError::Sink { message: error.to_string() }
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Sink { message } => write!(f, "the log cannot be written: {message}"),
            Self::TimeGoesBack { time, previous } => write!(
                f,
                "record at {} us comes after one at {} us: a log's time never decreases",
                time.as_micros(),
                previous.as_micros()
            ),
            Self::TimeTooLarge { time } => {
                write!(f, "record at {} s: a log's time ends at 2^64 - 1 us", time.as_secs())
            }
            Self::NoBytes => write!(f, "a record of bytes needs at least one"),
            Self::TooLong { bytes } => {
                write!(f, "a line of {bytes} bytes: a log's lines have at most {MAX_LINE_BYTES}")
            }
        }
    }
}

impl core::error::Error for WriteError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Event;

    /// Counts what was written through.
    #[derive(Default)]
    struct Sink {
        written: Vec<u8>,
        through: usize,
    }

    impl Write for &mut Sink {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.written.extend_from_slice(bytes);
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            self.through = self.written.len();
            Ok(())
        }
    }

    fn note(time_us: u64) -> Record {
        Record::at_us(time_us, Event::Note(String::from("x")))
    }

    #[test]
    fn nothing_older_than_half_a_second_waits() {
        let mut sink = Sink::default();
        let mut writer = Writer::new(&mut sink, &Header::new()).unwrap();
        writer.write(&note(1_000)).unwrap();
        writer.write(&note(500_999)).unwrap();
        assert!(writer.oldest.is_some());
        writer.write(&note(501_000)).unwrap();
        assert_eq!(writer.oldest, None);
        writer.write(&note(600_000)).unwrap();
        writer.tick(Duration::from_micros(1_099_999)).unwrap();
        assert!(writer.oldest.is_some());
        writer.tick(Duration::from_micros(1_100_000)).unwrap();
        assert_eq!(writer.oldest, None);
        core::mem::forget(writer); // killed
        assert_eq!(sink.through, sink.written.len());
        assert_eq!(sink.written.split(|&b| b == b'\n').count(), 6);
    }

    #[test]
    fn a_refused_record_leaves_no_trace() {
        let mut writer = Writer::new(Vec::new(), &Header::new()).unwrap();
        writer.write(&note(5)).unwrap();
        assert!(matches!(writer.write(&note(4)), Err(WriteError::TimeGoesBack { .. })));
        assert_eq!(writer.write(&Record::at_us(6, Event::Host(vec![]))), Err(WriteError::NoBytes));
        let long = Record::at_us(6, Event::Host(vec![0; MAX_LINE_BYTES]));
        assert!(matches!(writer.write(&long), Err(WriteError::TooLong { .. })));
        let late = Record { time: Duration::MAX, event: Event::Estop(true) };
        assert!(matches!(writer.write(&late), Err(WriteError::TimeTooLarge { .. })));
        writer.write(&note(5)).unwrap();
        let text = String::from_utf8(writer.finish().unwrap()).unwrap();
        assert_eq!(text.lines().count(), 3);
    }
}
