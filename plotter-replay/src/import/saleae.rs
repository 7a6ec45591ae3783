//! Saleae Logic's table of an async serial analyzer, as CSV.
//!
//! ```text
//! Time [s],Value,Parity Error,Framing Error          Logic 1, one file a direction
//! 0.042909760000000,0x31,,
//! name,type,start_time,duration,data,error           Logic 2, any number of analyzers in one file
//! "host","data",0.0001,0.0000390625,0x02,
//! ```
//!
//! The value is as the program showed it: hex (`0x31`), binary, decimal, or a character, where what cannot be
//! shown is `\n`, `\x02` or its number in quotes, `'2'`. A `1` is a character where every value is one, and a
//! number where some have more digits.

use super::clock::{date_s, fraction_ns, seconds_ns};
use super::{Chunk, Format, ImportSettings, Lines, Saw};

#[derive(Debug)]
pub(super) struct Saleae {
    byte_ns: i128,
    columns: Option<Columns>,
    /// Whether some value is a number of two or three digits.
    has_numbers: bool,
    /// Whether some value is a character that is no digit.
    has_characters: bool,
}

#[derive(Clone, Copy, Debug)]
struct Columns {
    count: usize,
    time: usize,
    value: usize,
    name: Option<usize>,
    kind: Option<usize>,
    duration: Option<usize>,
    errors: [Option<usize>; 2],
}

impl Columns {
    fn of(line: &str) -> Option<Self> {
        let names: Vec<String> = cells(line).iter().map(|cell| cell.trim().to_ascii_lowercase()).collect();
        let place = |wanted: &[&str]| names.iter().position(|name| wanted.contains(&name.as_str()));
        Some(Self {
            count: names.len(),
            time: place(&["time [s]", "start_time", "start", "time"])?,
            value: place(&["value", "data"])?,
            name: place(&["name", "analyzer"]),
            kind: place(&["type"]),
            duration: place(&["duration"]),
            errors: [place(&["parity error", "error"]), place(&["framing error"])],
        })
    }
}

/// The cells of a line of CSV, without the quotes round them.
fn cells(line: &str) -> Vec<String> {
    let mut out = Vec::new();
    let mut cell = String::new();
    let mut quoted = false;
    let mut chars = line.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '"' if quoted && chars.next_if_eq(&'"').is_some() => cell.push('"'),
            '"' if quoted => quoted = false,
            '"' if cell.is_empty() && chars.peek() != Some(&',') => quoted = true,
            ',' if !quoted => out.push(core::mem::take(&mut cell)),
            c => cell.push(c),
        }
    }
    out.push(cell);
    out
}

fn time_ns(text: &str) -> Option<i128> {
    if let Some(ns) = seconds_ns(text) {
        return Some(ns);
    }
    // 2021-04-27T14:54:31.312123456+00:00
    let (date, time) = text.trim().split_once(['T', ' '])?;
    let time = time.trim_end_matches('Z');
    let time = time.split_once(['+', '-']).map_or(time, |(time, _)| time);
    let (time, fraction) = time.split_once('.').unwrap_or((time, "0"));
    date_s(date, time)?.checked_mul(1_000_000_000)?.checked_add(fraction_ns(fraction)?)
}

/// A cell of one character is it, or a number, as the others in the file say.
fn byte_of(value: &str, numbers: bool) -> Option<u8> {
    let number = |text: &str, radix| u8::from_str_radix(text, radix).ok();
    if let Some(hex) = value.strip_prefix("0x").or_else(|| value.strip_prefix("0X")) {
        return number(hex, 16);
    }
    if let Some(bits) = value.strip_prefix("0b").map(|bits| bits.replace(' ', "")) {
        return number(&bits, 2);
    }
    if let Some(escaped) = value.strip_prefix('\\').filter(|rest| !rest.is_empty()) {
        return match escaped {
            "n" => Some(b'\n'),
            "r" => Some(b'\r'),
            "t" => Some(b'\t'),
            "0" => Some(0),
            "\\" => Some(b'\\'),
            other => number(other.strip_prefix('x')?, 16),
        };
    }
    if let Some(inner) =
        value.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')).filter(|s| !s.is_empty())
    {
        // '2' is the byte 2, '\n' and ' ' are what they say.
        return number(inner, 10).or_else(|| byte_of(inner, false));
    }
    match value.as_bytes() {
        &[byte] if !(numbers && byte.is_ascii_digit()) => Some(byte),
        _ if value == "COMMA" => Some(b','),
        // A character of 128 to 255, shown as such.
        _ if !value.is_ascii() && value.chars().count() == 1 => {
            value.chars().next().and_then(|c| u8::try_from(u32::from(c)).ok())
        }
        _ => number(value.trim(), 10),
    }
}

impl Saleae {
    pub(super) fn new(settings: &ImportSettings) -> Self {
        Self { byte_ns: settings.byte_ns(), columns: None, has_numbers: false, has_characters: false }
    }

    /// The cells of a row, a comma among them taken for the value that it is.
    fn row(columns: Columns, line: &str) -> Vec<String> {
        let mut row = cells(line);
        if row.len() == columns.count.saturating_add(1)
            && row.get(columns.value).is_some_and(String::is_empty)
            && row.get(columns.value.saturating_add(1)).is_some_and(String::is_empty)
        {
            row.remove(columns.value);
            if let Some(value) = row.get_mut(columns.value) {
                *value = String::from(",");
            }
        }
        row
    }

    fn read(&self, columns: Columns, line: &str, out: &mut Lines) {
        let row = Self::row(columns, line);
        let cell = |at: usize| row.get(at).map(String::as_str);
        if columns.kind.and_then(cell).is_some_and(|kind| kind != "data") {
            return; // no byte
        }
        let Some(start_ns) = cell(columns.time).and_then(time_ns) else {
            out.push(Err(format!("expected a time in seconds in column {}", columns.time.saturating_add(1))));
            return;
        };
        let numbers = self.has_numbers && !self.has_characters;
        let Some(byte) = cell(columns.value).and_then(|value| byte_of(value, numbers)) else {
            out.push(Err(format!("expected a byte in column {}", columns.value.saturating_add(1))));
            return;
        };
        let duration_ns = columns.duration.and_then(cell).and_then(seconds_ns).filter(|&ns| ns > 0);
        let time_ns = start_ns.saturating_add(duration_ns.unwrap_or(self.byte_ns));
        let side = match columns.name.and_then(cell) {
            Some(name) => Saw::Name(name.to_owned()),
            None => Saw::File,
        };
        out.push(Ok(Chunk { time_ns, side, bytes: vec![byte] }));
        let wrong =
            columns.errors.iter().flatten().find_map(|&at| cell(at).filter(|word| !word.trim().is_empty()));
        if let Some(word) = wrong {
            out.push(Err(format!("the analyzer doubts this byte, 0x{byte:02x}: {word}")));
        }
    }
}

impl Format for Saleae {
    fn survey(&mut self, line: &str) {
        let Some(columns) = self.columns else {
            self.columns = Columns::of(line);
            return;
        };
        let row = Self::row(columns, line);
        let Some(value) = row.get(columns.value) else { return };
        let digits = value.bytes().all(|b| b.is_ascii_digit());
        self.has_numbers |= digits && value.len() > 1;
        self.has_characters |= !digits && value.chars().count() == 1;
    }

    fn line(&mut self, line: &str, out: &mut Lines) {
        if line.is_empty() || Columns::of(line).is_some() {
            return;
        }
        match self.columns {
            Some(columns) => self.read(columns, line, out),
            None => out.push(Err(String::from("expected columns for time and value in the first line"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_as_they_were_shown() {
        for (value, byte) in [
            ("0x0A", 10),
            ("0b0000 1010", 10),
            ("1", b'1'),
            ("'1'", 1),
            ("'255'", 255),
            ("\\n", 10),
            ("\\x02", 2),
            (" ", b' '),
            ("' '", b' '),
            (",", b','),
            ("COMMA", b','),
            ("\\", b'\\'),
            ("'", b'\''),
            ("é", 0xE9),
        ] {
            assert_eq!(byte_of(value, false), Some(byte), "{value:?}");
        }
        assert_eq!((byte_of("1", true), byte_of("49", true)), (Some(1), Some(49)));
        for wrong in ["", "0x", "0x100", "256", "ab", "\\xZZ"] {
            assert_eq!(byte_of(wrong, false), None, "{wrong:?}");
        }
    }
}
