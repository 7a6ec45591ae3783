//! Bare bytes of one direction: their times are made from the baud rate, as if they had come without a pause.

use super::{Chunk, ImportSettings, Saw};
use std::io::{self, BufRead};

/// Bytes put together.
const TOGETHER: usize = 64;

pub(super) struct Raw<R> {
    inner: R,
    byte_ns: i128,
    bytes: i128,
}

impl<R: BufRead> Raw<R> {
    pub(super) fn new(inner: R, settings: &ImportSettings) -> Self {
        Self { inner, byte_ns: settings.byte_ns(), bytes: 0 }
    }

    pub(super) fn next(&mut self) -> io::Result<Option<Chunk>> {
        let mut bytes = Vec::with_capacity(TOGETHER);
        while bytes.len() < TOGETHER {
            let chunk = match self.inner.fill_buf() {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                other => other?,
            };
            let used = chunk.len().min(TOGETHER.saturating_sub(bytes.len()));
            if used == 0 {
                break;
            }
            bytes.extend_from_slice(chunk.get(..used).unwrap_or_default());
            self.inner.consume(used);
        }
        self.bytes = self.bytes.saturating_add(i128::try_from(bytes.len()).unwrap_or(i128::MAX));
        let time_ns = self.bytes.saturating_mul(self.byte_ns);
        Ok((!bytes.is_empty()).then_some(Chunk { time_ns, side: Saw::File, bytes }))
    }
}
