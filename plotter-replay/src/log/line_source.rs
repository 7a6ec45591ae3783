//! Lines out of any source, with their place, and never more than one line in memory.

use super::MAX_LINE_BYTES;
use std::io::{self, BufRead};

/// Where a line stands and how it ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LinePlace {
    /// From 1.
    pub(crate) number: u64,
    pub(crate) byte_offset: u64,
    /// With its end; may be more than is kept.
    pub(crate) bytes: u64,
    /// Whether it has an end.
    pub(crate) ended: bool,
}

impl LinePlace {
    pub(crate) fn is_too_long(self) -> bool {
        self.bytes > MAX_LINE_BYTES as u64
    }
}

/// Reads line by line; keeps the first [`MAX_LINE_BYTES`] of each.
pub(crate) struct LineSource<R> {
    inner: R,
    line: Vec<u8>,
    place: LinePlace,
}

impl<R: BufRead> LineSource<R> {
    pub(crate) fn new(inner: R) -> Self {
        Self { inner, line: Vec::new(), place: LinePlace::default() }
    }

    /// The present line without its end (`\n` or `\r\n`).
    pub(crate) fn line(&self) -> &[u8] {
        let line = self.line.strip_suffix(b"\n").unwrap_or(&self.line);
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// Where the present line stands. After an error: what of it came before.
    pub(crate) fn place(&self) -> LinePlace {
        self.place
    }

    /// Takes the next line; `false` at the end of the source.
    pub(crate) fn advance(&mut self) -> io::Result<bool> {
        self.begin();
        while !self.take_part()? {}
        Ok(self.place.bytes > 0)
    }

    /// The same, but gives a line up that is too long: what is none need not have line ends, and a device may
    /// go on for ever.
    pub(crate) fn advance_short(&mut self) -> io::Result<bool> {
        self.begin();
        while !self.take_part()? && !self.place.is_too_long() {}
        Ok(self.place.bytes > 0)
    }

    fn begin(&mut self) {
        self.line.clear();
        self.place = LinePlace {
            number: self.place.number.saturating_add(1),
            byte_offset: self.place.byte_offset.saturating_add(self.place.bytes),
            bytes: 0,
            ended: false,
        };
    }

    /// Takes what the source has of the line; says whether that was all of it.
    fn take_part(&mut self) -> io::Result<bool> {
        let chunk = loop {
            match self.inner.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
                // A second look at the same chunk: it cannot be lent out of the loop.
                Ok(_) => break self.inner.fill_buf()?,
            }
        };
        let end = memchr::memchr(b'\n', chunk);
        let used = end.map_or(chunk.len(), |end| end.saturating_add(1));
        let room = MAX_LINE_BYTES.saturating_sub(self.line.len());
        self.line.extend_from_slice(chunk.get(..used.min(room)).unwrap_or_default());
        self.inner.consume(used);
        self.place.bytes = self.place.bytes.saturating_add(used as u64);
        self.place.ended = end.is_some();
        Ok(self.place.ended || used == 0)
    }
}
