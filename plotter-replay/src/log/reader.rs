//! [`Reader`]: records out of a log, past any damage.

use super::line_source::LineSource;
use super::text::parse_line;
use super::{Damage, DamageKind, Header, MAGIC, Record, Summary, VERSION};
use core::fmt;
use core::time::Duration;
use std::io::BufRead;

/// Reads a log record by record, in constant memory.
///
/// Iterating gives every good record, and for each bad line what is wrong with it and where; it goes on after
/// it. Line ends may be `\n` or `\r\n`.
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
    header_damage: Option<Damage>,
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
    /// [`ReadError`] if this is no log or one of another version. A log whose header has lost its settings is
    /// read without them; the damage comes first when iterating.
    pub fn new(inner: R) -> Result<Self, ReadError> {
        let mut source = LineSource::new(inner);
        match source.advance() {
            Err(error) => return Err(ReadError::Source { message: error.to_string() }),
            Ok(false) => return Err(ReadError::Empty),
            Ok(true) => {}
        }
        let line = String::from_utf8_lossy(source.line());
        let rest =
            line.strip_prefix(MAGIC).and_then(|rest| rest.strip_prefix(' ')).ok_or(ReadError::NotALog)?;
        let (version, settings) = rest.split_once(' ').unwrap_or((rest, ""));
        if version.parse() != Ok(VERSION) {
            // Only so much of it that the message stays one line.
            return Err(ReadError::Version { found: version.chars().take(16).collect() });
        }
        let (header, header_damage) = match Header::from_json(settings) {
            Ok(header) => (header, None),
            Err(error) => (Header::new(), Some(DamageKind::Header { message: error.message })),
        };
        let mut reader =
            Self { source, header, header_damage: None, summary: Summary::default(), over: false };
        reader.header_damage = header_damage.map(|kind| reader.damage(kind));
        Ok(reader)
    }

    /// What the log says about itself.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
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

    fn judge(&self) -> Result<Record, DamageKind> {
        let place = self.source.place();
        if place.is_too_long() {
            return Err(DamageKind::TooLong);
        }
        // A last line without its end is whole if its checksum says so.
        let record = parse_line(self.source.line())
            .map_err(|kind| if place.ended { kind } else { DamageKind::CutEnd })?;
        let previous = self.summary.last.unwrap_or(Duration::ZERO);
        if record.time < previous {
            return Err(DamageKind::TimeWentBack { time: record.time, previous });
        }
        Ok(record)
    }
}

impl<R: BufRead> Iterator for Reader<R> {
    type Item = Result<Record, Damage>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(damage) = self.header_damage.take() {
            return Some(Err(damage));
        }
        if self.over {
            return None;
        }
        match self.source.advance() {
            Ok(true) => {}
            Ok(false) => {
                self.over = true;
                return None;
            }
            Err(error) => {
                self.over = true;
                return Some(Err(self.damage(DamageKind::Source { message: error.to_string() })));
            }
        }
        Some(match self.judge() {
            Ok(record) => {
                self.summary.records = self.summary.records.saturating_add(1);
                self.summary.first.get_or_insert(record.time);
                self.summary.last = Some(record.time);
                Ok(record)
            }
            Err(kind) => Err(self.damage(kind)),
        })
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
