//! [`Reader`]: records out of a log, past any damage.

use super::line_source::LineSource;
use super::salvage::{Both, salvage};
use super::text::{Parsed, parse_line};
use super::{Damage, DamageKind, Header, MAGIC, Record, RecordRef, Summary, VERSION};
use core::fmt;
use core::time::Duration;
use std::collections::VecDeque;
use std::io::BufRead;

/// Reads a log record by record, in constant memory.
///
/// Iterating gives every good record, and for each bad line what is wrong with it and where; it goes on after
/// it. Line ends may be `\n` or `\r\n`. Where only a line end was hit, the records on both sides of it are
/// read.
///
/// Who reads many millions takes [`Reader::next_ref`], which allocates nothing.
///
/// ```
/// # use plotter_replay::log::Reader;
/// let log = "plotter-log 1 {\"baud\":256000}\n\
///            10312 < 31 33 31 *87\n\
///            10350 @ edge x- *5a\n\
///            10351 @ drive x 20 *04\n";
/// let mut reader = Reader::new(log.as_bytes())?;
/// assert_eq!(reader.header().baud(), Some(256_000));
/// assert_eq!(reader.by_ref().filter(Result::is_ok).count(), 2); // the sum shows that x+ has become x-
/// assert_eq!(reader.summary().to_string(), "2 records, lost 1 line (20 bytes)");
/// # Ok::<(), plotter_replay::log::ReadError>(())
/// ```
pub struct Reader<R> {
    source: LineSource<R>,
    header: Header,
    /// Of the record that was read last.
    bytes: Vec<u8>,
    /// What is to be given before the next line is read.
    waiting: VecDeque<Result<Record, Damage>>,
    /// The record that was lent last, if it is none of the present line.
    lent: Option<Record>,
    summary: Summary,
    over: bool,
}

/// Why something is no log at all.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReadError {
    /// There is not a single byte.
    Empty,
    /// The first line does not begin with [`MAGIC`].
    NotALog,
    /// A log of another version of the format.
    Version {
        /// What the first line says.
        found: String,
    },
    /// The source cannot be read.
    Source {
        /// What the source says.
        message: String,
    },
}

impl<R: BufRead> Reader<R> {
    /// Reads the first line.
    ///
    /// # Errors
    ///
    /// [`ReadError`] if this is no log or one of another version. A log whose header is damaged is read
    /// without it, if a record follows; the damage comes first when iterating.
    pub fn new(inner: R) -> Result<Self, ReadError> {
        let mut reader = Self {
            source: LineSource::new(inner),
            header: Header::new(),
            bytes: Vec::new(),
            waiting: VecDeque::new(),
            lent: None,
            summary: Summary::default(),
            over: false,
        };
        reader.read_header()?;
        Ok(reader)
    }

    fn read_header(&mut self) -> Result<(), ReadError> {
        let failed = |error: std::io::Error| ReadError::Source { message: error.to_string() };
        if !self.source.advance_short().map_err(failed)? {
            return Err(ReadError::Empty);
        }
        let (refused, message) = match Header::from_line(self.source.line()) {
            Ok((header, None)) => {
                self.header = header;
                let place = self.source.place();
                // A carriage return alone in the place of the line end: cut off there, there would be none.
                if !place.ended && place.bytes > self.source.line().len() as u64 {
                    let byte_offset = place.byte_offset.saturating_add(place.bytes.saturating_sub(1));
                    let damage = Damage { byte_offset, bytes: 1, ..self.damage(DamageKind::LineEnd) };
                    self.summary.damaged_bytes = 1;
                    self.waiting.push_back(Err(damage));
                }
                return Ok(());
            }
            Ok((header, Some(message))) => {
                self.header = header;
                (None, message)
            }
            Err(error @ ReadError::NotALog) => (Some(error), format!("not {MAGIC:?} and {VERSION}")),
            Err(error) => return Err(error),
        };
        if let Some((header, at, record)) = refused.is_none().then(|| self.header_and_record()).flatten() {
            self.header = header;
            let place = self.source.place();
            let damage = Damage {
                byte_offset: place.byte_offset.saturating_add(at),
                bytes: 1,
                ..self.damage(DamageKind::LineEnd)
            };
            self.summary.damaged_bytes = 1;
            self.waiting.extend([Err(damage), Ok(record)]);
            return Ok(());
        }
        let damage = self.damage(DamageKind::Header { message });
        self.waiting.push_back(Err(damage));
        let Some(error) = refused else {
            return Ok(());
        };
        // One flipped bit in the first word must not cost all that follows: a record there can only be in a
        // log. Where the bit made a line end, the first line has become two.
        for _ in 0..2 {
            if !self.source.place().ended || !self.source.advance_short().map_err(failed)? {
                break;
            }
            match self.judge() {
                Ok(parsed) => {
                    let record = parsed.of(self.source.line(), &self.bytes).map(|record| record.to_record());
                    let Some(record) = record else { break };
                    self.waiting.push_back(Ok(record));
                    return Ok(());
                }
                Err(kind) => {
                    let damage = self.damage(kind);
                    self.waiting.push_back(Err(damage));
                }
            }
        }
        Err(error)
    }

    /// A first line into which the first record has run because its end was hit, and where that is.
    fn header_and_record(&mut self) -> Option<(Header, u64, Record)> {
        let line = self.source.line();
        memchr::memchr_iter(b'}', line).take(16).find_map(|brace| {
            let at = brace.checked_add(1)?;
            let rest = line.get(at.checked_add(1)?..)?;
            let record = parse_line(rest, &mut self.bytes).ok()?.of(rest, &self.bytes)?.to_record();
            match Header::from_line(line.get(..at)?) {
                Ok((header, None)) => Some((header, at as u64, record)),
                _ => None,
            }
        })
    }

    /// What the log says about itself.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The same log, of which something else is said.
    #[must_use]
    pub fn with_header(self, header: Header) -> Self {
        Self { header, ..self }
    }

    /// What was read and lost so far; of the whole log once the iterator is at its end.
    #[must_use]
    pub fn summary(&self) -> Summary {
        self.summary
    }

    fn damage(&mut self, kind: DamageKind) -> Damage {
        let place = self.source.place();
        self.summary.damaged_lines = self.summary.damaged_lines.saturating_add(1);
        self.summary.damaged_bytes = self.summary.damaged_bytes.saturating_add(place.bytes);
        Damage {
            line: place.number,
            byte_offset: place.byte_offset,
            bytes: place.bytes,
            after: self.summary.last,
            kind,
        }
    }

    fn judge(&mut self) -> Result<Parsed, DamageKind> {
        let place = self.source.place();
        if place.is_too_long() {
            return Err(DamageKind::TooLong);
        }
        // A last line without its end is whole if its checksum says so.
        let parsed = parse_line(self.source.line(), &mut self.bytes)
            .map_err(|kind| if place.ended { kind } else { DamageKind::CutEnd })?;
        self.in_order(Duration::from_micros(parsed.time_us)).map(|()| parsed)
    }

    fn in_order(&self, time: Duration) -> Result<(), DamageKind> {
        let previous = self.summary.last.unwrap_or(Duration::ZERO);
        if time < previous { Err(DamageKind::TimeWentBack { time, previous }) } else { Ok(()) }
    }

    fn took(&mut self, time: Duration) {
        self.summary.records = self.summary.records.saturating_add(1);
        self.summary.first.get_or_insert(time);
        self.summary.last = Some(time);
    }

    /// Takes the next record without allocating: it is good until the next call. The same as the iterator
    /// otherwise.
    pub fn next_ref(&mut self) -> Option<Result<RecordRef<'_>, Damage>> {
        let waiting = match self.waiting.pop_front() {
            Some(waiting) => waiting,
            None if self.over => return None,
            None => match self.source.advance() {
                Ok(false) => {
                    self.over = true;
                    return None;
                }
                Err(error) => {
                    self.over = true;
                    Err(self.damage(DamageKind::Source { message: error.to_string() }))
                }
                Ok(true) => match self.judge() {
                    Ok(parsed) => {
                        self.took(Duration::from_micros(parsed.time_us));
                        return parsed.of(self.source.line(), &self.bytes).map(Ok);
                    }
                    Err(kind) => self.salvage(kind),
                },
            },
        };
        match waiting {
            Err(damage) => Some(Err(damage)),
            Ok(record) => match self.in_order(record.time) {
                Err(kind) => Some(Err(self.damage(kind))),
                Ok(()) => {
                    self.took(record.time);
                    Some(Ok(self.lent.insert(record).view()))
                }
            },
        }
    }

    /// What is left of a bad line: the records on both sides of a hit line end, or nothing but the damage.
    fn salvage(&mut self, kind: DamageKind) -> Result<Record, Damage> {
        let both = match kind {
            DamageKind::Checksum { .. } | DamageKind::Syntax(_) | DamageKind::NotUtf8 => {
                salvage(self.source.line(), &mut self.bytes)
            }
            _ => None,
        };
        // Records of another time are no neighbours that a line end kept apart, and the line is counted as
        // lost once.
        let both = both.filter(|Both { records: [first, second], .. }| {
            self.in_order(first.time).is_ok() && first.time <= second.time
        });
        let Some(both) = both else {
            return Err(self.damage(kind));
        };
        let [first, second] = both.records;
        let damage = Damage {
            byte_offset: self.source.place().byte_offset.saturating_add(both.at),
            bytes: both.bytes,
            after: Some(first.time),
            ..self.damage(DamageKind::LineEnd)
        };
        // The line was counted whole.
        let lost = self.summary.damaged_bytes.saturating_sub(self.source.place().bytes);
        self.summary.damaged_bytes = lost.saturating_add(both.bytes);
        self.waiting.extend([Err(damage), Ok(second)]);
        Ok(first)
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Record, Damage>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_ref().map(|item| item.map(|record| record.to_record()))
    }
}

impl<R> fmt::Debug for Reader<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Reader")
            .field("header", &self.header)
            .field("summary", &self.summary)
            .field("over", &self.over)
            .finish_non_exhaustive()
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "empty: not even the first line of a log"),
            Self::NotALog => write!(f, "not a log: the first line does not begin with \"{MAGIC} {VERSION}\""),
            Self::Version { found } => {
                write!(f, "log format version {found:?}: this program reads version {VERSION}")
            }
            Self::Source { message } => write!(f, "cannot be read: {message}"),
        }
    }
}

impl core::error::Error for ReadError {}
