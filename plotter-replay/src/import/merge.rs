//! [`import`]: all files together, in the order of their times, into one log.

use super::raw::Raw;
use super::sides::{Sides, hint};
use super::{Chunk, Format, ImportSettings, Lines, Saw, Side, Source, Tool, Trouble, format_of};
use crate::log::{EventRef, LineSource, RecordRef, WriteError, Writer};
use core::fmt;
use core::time::Duration;
use std::collections::VecDeque;
use std::io::{self, BufRead, Write};

/// Result of an import.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Imported {
    /// Bytes of the host.
    pub host_bytes: u64,
    /// Bytes of the controller.
    pub controller_bytes: u64,
    /// Number of lines that could not be read and of times that had to be changed.
    pub troubles: u64,
    /// Names and files and who they are taken for.
    pub sides: Vec<(String, Side)>,
}

/// Why nothing can be imported, or no more.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ImportError {
    /// A file cannot be read.
    Unreadable {
        /// The file.
        file: String,
        /// Why.
        message: String,
    },
    /// Nothing says who sent the bytes of a file.
    WhoseBytes {
        /// The file.
        file: String,
    },
    /// The log cannot be written.
    Log(WriteError),
}

impl fmt::Display for ImportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { file, message } => write!(f, "{file}: cannot be read: {message}"),
            Self::WhoseBytes { file } => {
                write!(f, "{file}: who sent these bytes? Say --host {file} or --controller {file}")
            }
            Self::Log(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for ImportError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Log(error) => Some(error),
            _ => None,
        }
    }
}

/// Bytes that tell whose they are: a host of the digits protocol sends nothing above 9, a controller nothing
/// below.
const MOST_SAMPLED: usize = 4_096;

/// Imports recordings of one line into a log. Each [`Trouble`] is told as it is met; the rest goes on.
///
/// The log begins when the first byte did. A file of one direction whose [`Source::side`] is not given is the
/// host's or the controller's by its name (`_H`, `tx`, `host`, ...), else by its bytes, else by the order of
/// two files.
///
/// ```
/// # use plotter_replay::import::{ImportSettings, Source, Tool, import};
/// # use plotter_replay::log::{Header, Writer};
/// let text = "(5.000100) host 02\n(5.000139) host 00\n(5.000900) plotter 31\n";
/// let source = Source {
///     name: String::from("dump.txt"),
///     tool: Tool::Candump,
///     side: None,
///     open: Box::new(|| Ok(Box::new(text.as_bytes()))),
/// };
/// let mut log = Writer::new(Vec::new(), &Header::new())?;
/// let imported = import(vec![source], &ImportSettings::default(), &mut log, |trouble| panic!("{trouble}"))?;
/// assert_eq!((imported.host_bytes, imported.controller_bytes), (2, 1));
/// let text = String::from_utf8(log.finish()?)?;
/// let times: Vec<_> = text.lines().skip(1).map(|line| line.split(' ').next().unwrap()).collect();
/// assert_eq!(times, ["0", "39", "800"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`ImportError`]. What was read before is in the log.
pub fn import<W: Write>(
    sources: Vec<Source<'_>>,
    settings: &ImportSettings,
    log: &mut Writer<W>,
    mut trouble: impl FnMut(Trouble),
) -> Result<Imported, ImportError> {
    let mut imported = Imported::default();
    let sides = file_sides(&sources, settings)?;
    let mut inputs = Vec::new();
    for (source, side) in sources.iter().zip(sides) {
        if let Some(side) = side {
            imported.sides.push((source.name.clone(), side));
        }
        let mut input = Input::open(source, settings)?;
        input.side = side;
        inputs.push(input);
    }
    let mut names = Sides::new(settings);
    let mut tell = |one: Trouble, imported: &mut Imported| {
        imported.troubles = imported.troubles.saturating_add(1);
        trouble(one);
    };
    let mut zero_ns = None;
    let mut last_us = 0_u64;
    loop {
        for input in &mut inputs {
            while let Some(one) = input.fill()? {
                tell(one, &mut imported);
            }
        }
        let earliest = inputs
            .iter_mut()
            .filter(|input| input.next.is_some())
            .min_by_key(|input| input.next.as_ref().map_or(i128::MAX, |(_, chunk)| chunk.time_ns));
        let Some((input, (line, chunk))) =
            earliest.and_then(|input| input.next.take().map(|next| (input, next)))
        else {
            break;
        };
        let here = |message| Trouble { file: input.name.clone(), line, message };
        let side = match (&chunk.side, input.side) {
            (Saw::Side(side), _) => Ok(*side),
            (Saw::Name(_), Some(side)) => Ok(side),
            (Saw::Name(name), None) => names.of(name),
            (Saw::File, side) => side.ok_or_else(|| String::from("nobody is known to have sent this")),
        };
        let side = match side {
            Ok(side) => side,
            Err(message) => {
                tell(here(message), &mut imported);
                continue;
            }
        };
        let count = chunk.bytes.len();
        let zero_ns = *zero_ns.get_or_insert_with(|| input.zero_ns(&chunk, settings));
        let since_ns = chunk.time_ns.saturating_sub(zero_ns).max(0);
        // Rounded to the nearest microsecond.
        let time_us = u64::try_from(since_ns.saturating_add(500) / 1_000).unwrap_or(u64::MAX);
        if time_us < last_us {
            tell(
                here(format!(
                    "its time is {} us before that of the one before: taken as the same",
                    last_us - time_us
                )),
                &mut imported,
            );
        }
        last_us = time_us.max(last_us);
        // A tool may put more together than a line of a log holds.
        for bytes in chunk.bytes.chunks(4_096) {
            let event = match side {
                Side::Host => EventRef::Host(bytes),
                Side::Controller => EventRef::Controller(bytes),
            };
            let record = RecordRef { time: Duration::from_micros(last_us), event };
            log.write_ref(&record).map_err(ImportError::Log)?;
        }
        let total = match side {
            Side::Host => &mut imported.host_bytes,
            Side::Controller => &mut imported.controller_bytes,
        };
        *total = total.saturating_add(count as u64);
    }
    imported.sides.extend(names.known());
    Ok(imported)
}

/// Sender of the bytes of each file, where all are of one.
fn file_sides(sources: &[Source<'_>], settings: &ImportSettings) -> Result<Vec<Option<Side>>, ImportError> {
    let mut sides = Vec::new();
    for source in sources {
        let one_sided = match source.tool {
            Tool::Saleae => is_one_sided(source, settings)?.unwrap_or(false),
            Tool::Sigrok => is_one_sided(source, settings)?.unwrap_or(true),
            tool => tool.is_one_sided(),
        };
        sides.push(match source.side {
            Some(side) => Some(side),
            None if !one_sided => None,
            None => match hint(&file_name(&source.name)) {
                Some(side) => Some(side),
                None => by_bytes(source, settings)?,
            },
        });
        // What is still open is settled by the other file, if there are two.
        if one_sided && sides.last() == Some(&None) {
            let other = match sides.as_slice() {
                [Some(Side::Host), None] => Some(Side::Controller),
                [Some(Side::Controller), None] => Some(Side::Host),
                _ => None,
            };
            match (other, sides.last_mut()) {
                (Some(other), Some(last)) => *last = Some(other),
                _ => return Err(ImportError::WhoseBytes { file: source.name.clone() }),
            }
        }
    }
    Ok(sides)
}

fn file_name(path: &str) -> String {
    std::path::Path::new(path).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Whether nothing in a file tells who sent its bytes; `None` without any.
fn is_one_sided(source: &Source<'_>, settings: &ImportSettings) -> Result<Option<bool>, ImportError> {
    let mut input = Input::open(source, settings)?;
    while input.fill()?.is_some() {}
    Ok(input.next.map(|(_, chunk)| chunk.side == Saw::File))
}

fn by_bytes(source: &Source<'_>, settings: &ImportSettings) -> Result<Option<Side>, ImportError> {
    let mut input = Input::open(source, settings)?;
    let (mut digits, mut sampled) = (0, 0);
    while sampled < MOST_SAMPLED {
        while input.fill()?.is_some() {}
        let Some((_, chunk)) = input.next.take() else { break };
        digits += chunk.bytes.iter().filter(|&&byte| byte <= 9).count();
        sampled += chunk.bytes.len();
    }
    // Where a byte in ten is wrong, it is another protocol.
    Ok(match sampled {
        0 => None,
        _ if digits * 10 >= sampled * 9 => Some(Side::Host),
        _ if digits * 10 <= sampled => Some(Side::Controller),
        _ => None,
    })
}

/// A file that is being read.
struct Input<'a> {
    name: String,
    tool: Tool,
    side: Option<Side>,
    lines: Kind<'a>,
    waiting: VecDeque<(u64, Result<Chunk, String>)>,
    /// The next chunk and its line.
    next: Option<(u64, Chunk)>,
}

enum Kind<'a> {
    Lines { format: Box<dyn Format>, source: LineSource<Box<dyn BufRead + 'a>>, over: bool },
    Raw { raw: Raw<Box<dyn BufRead + 'a>>, over: bool },
}

impl<'a> Input<'a> {
    fn open(source: &Source<'a>, settings: &ImportSettings) -> Result<Self, ImportError> {
        let unreadable = |error: io::Error| unreadable(&source.name, &error);
        let kind = match format_of(source.tool, settings) {
            None => Kind::Raw { raw: Raw::new((source.open)().map_err(unreadable)?, settings), over: false },
            Some(mut format) => {
                let mut lines = LineSource::new((source.open)().map_err(unreadable)?);
                while lines.advance().map_err(unreadable)? {
                    if let Ok(line) = text_of(lines.line(), lines.place().number) {
                        format.survey(line);
                    }
                }
                let source = LineSource::new((source.open)().map_err(unreadable)?);
                Kind::Lines { format, source, over: false }
            }
        };
        Ok(Self {
            name: source.name.clone(),
            tool: source.tool,
            side: None,
            lines: kind,
            waiting: VecDeque::new(),
            next: None,
        })
    }

    /// Reads until the next chunk is there or the file is at its end; or gives what cannot be read.
    fn fill(&mut self) -> Result<Option<Trouble>, ImportError> {
        while self.next.is_none() {
            match self.waiting.pop_front() {
                Some((line, Ok(chunk))) => self.next = Some((line, chunk)),
                Some((line, Err(message))) => {
                    return Ok(Some(Trouble { file: self.name.clone(), line, message }));
                }
                None => {
                    if !self.read()? {
                        break;
                    }
                }
            }
        }
        Ok(None)
    }

    /// Reads on; `false` at the end.
    fn read(&mut self) -> Result<bool, ImportError> {
        let name = &self.name;
        let unreadable = |error: io::Error| unreadable(name, &error);
        match &mut self.lines {
            Kind::Raw { over: true, .. } | Kind::Lines { over: true, .. } => Ok(false),
            Kind::Raw { raw, over } => {
                match raw.next().map_err(unreadable)? {
                    Some(chunk) => self.waiting.push_back((0, Ok(chunk))),
                    None => *over = true,
                }
                Ok(true)
            }
            Kind::Lines { format, source, over } => {
                let mut out: Lines = Vec::new();
                if source.advance().map_err(unreadable)? {
                    let place = source.place();
                    if place.is_too_long() {
                        out.push(Err(String::from("the line is too long: left out")));
                    } else {
                        match text_of(source.line(), place.number) {
                            Ok(line) => format.line(line, &mut out),
                            Err(message) => out.push(Err(message)),
                        }
                    }
                } else {
                    *over = true;
                    format.end(&mut out);
                }
                let number = source.place().number;
                self.waiting.extend(out.into_iter().map(|one| (number, one)));
                Ok(true)
            }
        }
    }

    /// When the log begins, if it begins with this chunk: where its first byte did on a clock that tells the
    /// time of day; at zero on one that counts from the beginning of the recording, unless that came before.
    fn zero_ns(&self, chunk: &Chunk, settings: &ImportSettings) -> i128 {
        match self.tool {
            Tool::Socat | Tool::Jpnevulator | Tool::Candump => {
                let before = i128::try_from(chunk.bytes.len()).unwrap_or(1).saturating_sub(1);
                chunk.time_ns.saturating_sub(before.saturating_mul(settings.byte_ns()))
            }
            // A date is no time since the beginning; a recording of more than a year is none.
            Tool::Saleae if chunk.time_ns > 31_536_000_000_000_000 => chunk.time_ns,
            _ => chunk.time_ns.min(0),
        }
    }
}

fn text_of(line: &[u8], number: u64) -> Result<&str, String> {
    let line = if number == 1 { line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line) } else { line };
    core::str::from_utf8(line).map_err(|_| String::from("not UTF-8 text: left out"))
}

fn unreadable(file: &str, error: &io::Error) -> ImportError {
    ImportError::Unreadable { file: file.to_owned(), message: error.to_string() }
}
