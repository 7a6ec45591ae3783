//! jpnevulator's `--read --timing-print`: a line with time and port, then the bytes.
//!
//! ```text
//! 2006-05-30 13:23:49.461075: /dev/ttyS0
//! 00 00 05 3B 0D 00 00 05                         ...;....
//! ```

use super::clock::{date_s, fraction_ns};
use super::hex_dump::{pairs, pairs_with_characters};
use super::{Chunk, Format, Lines, Saw};

#[derive(Debug, Default)]
pub(super) struct Jpnevulator {
    /// Time and port of the lines to come.
    heading: Option<(i128, String)>,
    bytes: Vec<u8>,
    /// Whether the bytes have their characters beside them (`--ascii`): some do not look like bytes.
    has_characters: bool,
}

/// Bytes under one heading that are kept together.
const MOST_BYTES: usize = 4_096;

fn heading(line: &str) -> Option<(i128, String)> {
    let (stamp, name) = line.split_once(": ").or_else(|| line.strip_suffix(':').map(|stamp| (stamp, "")))?;
    let (date, time) = stamp.split_once(' ')?;
    let (time, fraction) = time.split_once('.')?;
    let seconds = date_s(date, time)?;
    let ns = seconds.checked_mul(1_000_000_000)?.checked_add(fraction_ns(fraction)?)?;
    Some((ns, name.trim().to_owned()))
}

/// The bytes of a line: in hex, or with `--base=2` eight binary digits each.
fn bytes_of(line: &str, has_characters: bool) -> Vec<u8> {
    let binary = |word: &str| {
        (word.len() == 8 && word.bytes().all(|b| matches!(b, b'0' | b'1')))
            .then(|| u8::from_str_radix(word, 2).ok())
            .flatten()
    };
    let bits: Vec<u8> = line.split(' ').map_while(binary).collect();
    match (bits.is_empty(), has_characters) {
        (false, _) => bits,
        (true, true) => pairs_with_characters(line),
        (true, false) => pairs(line, false),
    }
}

impl Jpnevulator {
    fn close(&mut self, out: &mut Lines) {
        let bytes = core::mem::take(&mut self.bytes);
        if let (false, Some((time_ns, name))) = (bytes.is_empty(), &self.heading) {
            out.push(Ok(Chunk { time_ns: *time_ns, side: Saw::Name(name.clone()), bytes }));
        }
    }
}

impl Format for Jpnevulator {
    fn survey(&mut self, line: &str) {
        let line = line.trim_end();
        let found = pairs(line, false).len();
        self.has_characters |= found > 0 && found.saturating_mul(3) <= line.len();
    }

    fn line(&mut self, line: &str, out: &mut Lines) {
        if let Some(next) = heading(line) {
            self.close(out);
            self.heading = Some(next);
            return;
        }
        let line = line.trim_end();
        if line.is_empty() {
            return;
        }
        let mut bytes = bytes_of(line, self.has_characters);
        if bytes.is_empty() {
            out.push(Err(String::from("expected date and time, or bytes in hex")));
        } else if self.heading.is_none() {
            out.push(Err(String::from("bytes without a time: was it run with --timing-print?")));
        } else {
            self.bytes.append(&mut bytes);
            if self.bytes.len() >= MOST_BYTES {
                self.close(out);
            }
        }
    }

    fn end(&mut self, out: &mut Lines) {
        self.close(out);
    }
}
