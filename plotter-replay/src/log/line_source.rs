//! Lines out of any source, with their place, and never more than one line in memory.

use super::{MAGIC, MAX_LINE_BYTES};
use std::io::{self, BufRead};

/// Where a line stands and how it ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct LinePlace {
    /// From 1.
    pub(super) number: u64,
    pub(super) byte_offset: u64,
    /// With its end; may be more than is kept.
    pub(super) bytes: u64,
    /// Whether it has an end.
    pub(super) ended: bool,
}

impl LinePlace {
    pub(super) fn is_too_long(self) -> bool {
        self.bytes > MAX_LINE_BYTES as u64
    }
}

/// Reads line by line; keeps the first [`MAX_LINE_BYTES`] of each.
pub(super) struct LineSource<R> {
    inner: R,
    line: Vec<u8>,
    place: LinePlace,
}

impl<R: BufRead> LineSource<R> {
    pub(super) fn new(inner: R) -> Self {
        Self { inner, line: Vec::new(), place: LinePlace::default() }
    }

    /// The present line without its end (`\n` or `\r\n`).
    pub(super) fn line(&self) -> &[u8] {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// Where the present line stands. After an error: what of it came before.
    pub(super) fn place(&self) -> LinePlace {
        self.place
    }

    /// Takes the next line; `false` at the end of the source.
    pub(super) fn advance(&mut self) -> io::Result<bool> {
        self.line.clear();
        self.place = LinePlace {
            number: self.place.number.saturating_add(1),
            byte_offset: self.place.byte_offset.saturating_add(self.place.bytes),
            bytes: 0,
            ended: false,
        };
        loop {
            let chunk = match self.inner.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                other => other?,
            };
            let end = chunk.iter().position(|&byte| byte == b'\n');
            let used = end.map_or(chunk.len(), |end| end.saturating_add(1));
            let room = MAX_LINE_BYTES.saturating_sub(self.line.len());
            self.line.extend(chunk.iter().take(used.min(room)));
            self.inner.consume(used);
            self.place.bytes = self.place.bytes.saturating_add(used as u64);
            self.place.ended = end.is_some();
            // What does not begin as a log need not have line ends: a device may go on for ever.
            let magic = MAGIC.as_bytes();
            let no_log =
                self.place.number == 1 && self.line.len() >= magic.len() && !self.line.starts_with(magic);
            if self.place.ended || used == 0 || no_log {
                return Ok(self.place.bytes > 0);
            }
        }
    }
}
