//! Logs as tables and as text.

use crate::compare::Decoder;
use crate::log::{Event, Header, Record, write_line};
use std::io::{self, Write};

/// Writes records as CSV: `time_us,from,kind,value,words`. Bytes are in hex, one row a record; cells with a
/// comma or a quote are quoted.
///
/// ```
/// # use plotter_replay::{export, log::{Event, Header, Record}};
/// let mut out = Vec::new();
/// export::csv(&Header::new(), [Record::at_us(90, Event::Controller(b"13+".to_vec()))], &mut out)?;
/// assert_eq!(out, b"time_us,from,kind,value,words\n90,controller,bytes,31332b,\"pulse x+ y+, reached\"\n");
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
///
/// What `out` says.
pub fn csv(
    header: &Header,
    records: impl IntoIterator<Item = Record>,
    mut out: impl Write,
) -> io::Result<()> {
    let mut decoder = Decoder::new(header);
    out.write_all(b"time_us,from,kind,value,words\n")?;
    for record in records {
        let words = decoder.words(&record);
        let line = line_of(&record);
        let (from, kind, value) = match &record.event {
            Event::Host(bytes) => ("host", "bytes", hex(bytes)),
            Event::Controller(bytes) => ("controller", "bytes", hex(bytes)),
            event => {
                // `TIME @ KIND VALUE`
                let (kind, value) =
                    line.splitn(3, ' ').nth(2).and_then(|rest| rest.split_once(' ')).unwrap_or_default();
                let kind = match event {
                    Event::Edge { .. } => "edge",
                    Event::Drive { .. } => "drive",
                    Event::Switch { .. } => "switch",
                    Event::Estop(_) => "estop",
                    Event::Pen(_) => "pen",
                    Event::Target { .. } => "target",
                    Event::Note(_) => "note",
                    _ => kind,
                };
                ("", kind, value.to_owned())
            }
        };
        writeln!(out, "{},{from},{kind},{},{}", record.time.as_micros(), cell(&value), cell(&words))?;
    }
    out.flush()
}

/// Writes records as text: the line of the log without its checksum, and what it says.
///
/// # Errors
///
/// What `out` says.
pub fn text(
    header: &Header,
    records: impl IntoIterator<Item = Record>,
    mut out: impl Write,
) -> io::Result<()> {
    let mut decoder = Decoder::new(header);
    for (key, value) in header.entries() {
        writeln!(out, "# {key}: {value}")?;
    }
    for record in records {
        line(&record, &decoder.words(&record), &mut out)?;
    }
    out.flush()
}

/// Writes one record so, with the words of a [`Decoder`].
///
/// # Errors
///
/// What `out` says.
pub fn line(record: &Record, words: &str, mut out: impl Write) -> io::Result<()> {
    let gap = if words.is_empty() { "" } else { "    " };
    writeln!(out, "{}{gap}{words}", line_of(record))
}

/// The line of a record without its checksum.
fn line_of(record: &Record) -> String {
    let mut line = Vec::new();
    write_line(&mut line, u64::try_from(record.time.as_micros()).unwrap_or(u64::MAX), &record.event.view());
    let line = String::from_utf8_lossy(&line);
    line.rsplit_once(" *").map_or(&*line, |(covered, _)| covered).to_owned()
}

pub(super) fn hex(bytes: &[u8]) -> String {
    use core::fmt::Write as _;
    let mut out = String::with_capacity(bytes.len().saturating_mul(2));
    for byte in bytes {
        let _ = write!(out, "{byte:02x}");
    }
    out
}

fn cell(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
