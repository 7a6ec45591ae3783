//! socat's `-x` and `-x -v`: a line with direction, time and length, then the bytes.
//!
//! ```text
//! > 2026/01/15 10:00:00.000352  length=10 from=0 to=9
//!  00 00 02 00 00 00 00 02 00 00                    ..........
//! --
//! ```
//!
//! Version 1.7.4.4 writes the microseconds with nine digits, zeros before them: `18.000938437` is 18.938437
//! s. Where no record of a file has more than 999999 there, they are microseconds.

use super::clock::{date_s, fraction_ns};
use super::hex_dump::pairs;
use super::{Chunk, Format, Lines, Saw, Side};

#[derive(Debug, Default)]
pub(super) struct Socat {
    /// Whether fractions of nine digits are nanoseconds after all.
    has_nanoseconds: bool,
    open: Option<Open>,
}

/// A record whose bytes have not all come.
#[derive(Debug)]
struct Open {
    chunk: Chunk,
    length: usize,
}

struct Heading<'a> {
    side: Side,
    seconds: i128,
    fraction: &'a str,
    length: usize,
}

impl<'a> Heading<'a> {
    fn of(line: &'a str) -> Option<Self> {
        let (side, rest) = match line.split_at_checked(2)? {
            ("> ", rest) => (Side::Host, rest),
            ("< ", rest) => (Side::Controller, rest),
            _ => return None,
        };
        let mut words = rest.split_ascii_whitespace();
        let date = words.next()?;
        let (time, fraction) = words.next()?.split_once('.')?;
        let length = words.next()?.strip_prefix("length=")?.parse().ok()?;
        Some(Self { side, seconds: date_s(date, time)?, fraction, length })
    }
}

impl Socat {
    fn close(&mut self, out: &mut Lines) {
        let Some(open) = self.open.take() else { return };
        let (found, length) = (open.chunk.bytes.len(), open.length);
        if found > 0 {
            out.push(Ok(open.chunk));
        }
        if found != length {
            out.push(Err(format!("the record before has {found} of {length} bytes")));
        }
    }
}

impl Format for Socat {
    fn survey(&mut self, line: &str) {
        if let Some(heading) = Heading::of(line) {
            let nine = heading.fraction.len() == 9;
            self.has_nanoseconds |= nine && !heading.fraction.starts_with("000");
        }
    }

    fn line(&mut self, line: &str, out: &mut Lines) {
        if let Some(heading) = Heading::of(line) {
            self.close(out);
            let padded = heading.fraction.len() == 9 && !self.has_nanoseconds;
            let fraction = if padded { heading.fraction.get(3..) } else { Some(heading.fraction) };
            let Some(fraction_ns) = fraction.and_then(fraction_ns) else {
                out.push(Err(String::from("expected a fraction of a second in the time")));
                return;
            };
            let time_ns = heading.seconds.saturating_mul(1_000_000_000).saturating_add(fraction_ns);
            let chunk = Chunk { time_ns, side: Saw::Side(heading.side), bytes: Vec::new() };
            self.open = Some(Open { chunk, length: heading.length });
            return;
        }
        if line == "--" || line.is_empty() {
            self.close(out);
            return;
        }
        if line.contains(" socat[") {
            return; // what it says of itself
        }
        let Some(open) = &mut self.open else {
            out.push(Err(String::from("expected > or <, date, time and length=: is this of `socat -x`?")));
            return;
        };
        let room = open.length.saturating_sub(open.chunk.bytes.len());
        let mut bytes = pairs(line, true);
        if bytes.is_empty() || room == 0 {
            out.push(Err(String::from("expected bytes in hex: is this of `socat -x`?")));
            return;
        }
        bytes.truncate(room);
        open.chunk.bytes.append(&mut bytes);
        if open.chunk.bytes.len() == open.length {
            self.close(out);
        }
    }

    fn end(&mut self, out: &mut Lines) {
        self.close(out);
    }
}
