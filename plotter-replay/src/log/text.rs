//! One record as one line of text, both ways.

use super::damage::{DamageKind, SyntaxError};
use super::{EventRef, RecordRef, SwitchName};
use core::time::Duration;
use crc::{Crc, Table};
use plotter_motion::{Axis, Direction, Pen};
use std::borrow::Cow;

/// With tables for 16 bytes at a time.
const CHECKSUM: Crc<u8, Table<16>> = Crc::<u8, Table<16>>::new(&crc::CRC_8_SMBUS);

/// The checksum of a line, over everything before its asterisk.
pub(super) fn checksum(covered: &[u8]) -> u8 {
    CHECKSUM.checksum(covered)
}

/// Appends a record and a line end to `out`; `time_us` is the record's time.
pub(crate) fn write_line(out: &mut Vec<u8>, time_us: u64, event: &EventRef<'_>) {
    let start = out.len();
    write_covered(out, time_us, event);
    let sum = checksum(out.get(start..).unwrap_or_default());
    let [high, low] = hex(sum);
    out.extend_from_slice(&[b'*', high, low, b'\n']);
}

fn write_covered(out: &mut Vec<u8>, time_us: u64, event: &EventRef<'_>) {
    write_number(out, time_us);
    let mut text = |text: &str| out.extend_from_slice(text.as_bytes());
    match event {
        EventRef::Host(bytes) => write_bytes(out, b'>', bytes),
        EventRef::Controller(bytes) => write_bytes(out, b'<', bytes),
        EventRef::Edge { axis: Axis::X, sign: Direction::Plus } => text(" @ edge x+"),
        EventRef::Edge { axis: Axis::X, sign: Direction::Minus } => text(" @ edge x-"),
        EventRef::Edge { axis: Axis::Y, sign: Direction::Plus } => text(" @ edge y+"),
        EventRef::Edge { axis: Axis::Y, sign: Direction::Minus } => text(" @ edge y-"),
        EventRef::Drive { axis, duty } => {
            text(match axis {
                Axis::X => " @ drive x ",
                Axis::Y => " @ drive y ",
            });
            write_signed(out, *duty);
        }
        EventRef::Switch { name, pressed } => {
            text(" @ switch ");
            text(name.as_str());
            text(if *pressed { " 1" } else { " 0" });
        }
        EventRef::Estop(pressed) => text(if *pressed { " @ estop 1" } else { " @ estop 0" }),
        EventRef::Pen(Pen::Up) => text(" @ pen up"),
        EventRef::Pen(Pen::Down) => text(" @ pen down"),
        EventRef::Target { x, y } => {
            text(" @ target ");
            write_signed(out, *x);
            out.push(b' ');
            write_signed(out, *y);
        }
        EventRef::Note(note) => {
            text(" @ note ");
            escape(out, note);
        }
    }
    out.push(b' ');
}

fn write_number(out: &mut Vec<u8>, number: u64) {
    let mut digits = [0; 20];
    let mut rest = number;
    let mut length: usize = 0;
    for place in digits.iter_mut().rev() {
        // One digit fits a byte.
        *place = b'0'.wrapping_add(u8::try_from(rest % 10).unwrap_or(0));
        rest /= 10;
        length = length.saturating_add(1);
        if rest == 0 {
            break;
        }
    }
    out.extend_from_slice(digits.get(digits.len().saturating_sub(length)..).unwrap_or_default());
}

fn write_signed(out: &mut Vec<u8>, number: i32) {
    if number < 0 {
        out.push(b'-');
    }
    write_number(out, u64::from(number.unsigned_abs()));
}

fn write_bytes(out: &mut Vec<u8>, channel: u8, bytes: &[u8]) {
    out.extend_from_slice(&[b' ', channel]);
    for &byte in bytes {
        let [high, low] = hex(byte);
        out.extend_from_slice(&[b' ', high, low]);
    }
}

fn hex(byte: u8) -> [u8; 2] {
    let digit =
        |nibble: u8| if nibble < 10 { b'0' | nibble } else { b'a'.wrapping_add(nibble).wrapping_sub(10) };
    [digit(byte >> 4), digit(byte & 15)]
}

/// A record stays one line whatever a note says: `\` and control characters become `\xHH`.
fn escape(out: &mut Vec<u8>, text: &str) {
    for byte in text.bytes() {
        match byte {
            b'\\' => out.extend_from_slice(b"\\\\"),
            b'\n' => out.extend_from_slice(b"\\n"),
            byte if byte.is_ascii_control() => {
                let [high, low] = hex(byte);
                out.extend_from_slice(&[b'\\', b'x', high, low]);
            }
            byte => out.push(byte),
        }
    }
}

fn unescape(text: &str) -> Option<Cow<'_, str>> {
    if !text.contains('\\') {
        return Some(Cow::Borrowed(text));
    }
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        match chars.next()? {
            '\\' => out.push('\\'),
            'n' => out.push('\n'),
            'x' => {
                let code = chars.next()?.to_digit(16)? * 16 + chars.next()?.to_digit(16)?;
                out.push(char::from_u32(code).filter(char::is_ascii)?);
            }
            _ => return None,
        }
    }
    Some(Cow::Owned(out))
}

/// What a line says, its bytes and words left where they are: nothing here borrows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Parsed {
    pub(super) time_us: u64,
    what: What,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Host,
    Controller,
    Edge(Axis, Direction),
    Drive(Axis, i32),
    /// The name is from here to there in the line.
    Switch(usize, usize, bool),
    Estop(bool),
    Pen(Pen),
    Target(i32, i32),
    /// The words are from here to there in the line.
    Note(usize, usize),
}

impl Parsed {
    /// The record, with the line and the bytes that it was read from; `None` for those of another line.
    pub(super) fn of<'a>(self, line: &'a [u8], bytes: &'a [u8]) -> Option<RecordRef<'a>> {
        let words = |from, to| core::str::from_utf8(line.get(from..to)?).ok();
        let event = match self.what {
            What::Host => EventRef::Host(bytes),
            What::Controller => EventRef::Controller(bytes),
            What::Edge(axis, sign) => EventRef::Edge { axis, sign },
            What::Drive(axis, duty) => EventRef::Drive { axis, duty },
            What::Switch(from, to, pressed) => {
                EventRef::Switch { name: Cow::Owned(SwitchName::new(words(from, to)?).ok()?), pressed }
            }
            What::Estop(pressed) => EventRef::Estop(pressed),
            What::Pen(pen) => EventRef::Pen(pen),
            What::Target(x, y) => EventRef::Target { x, y },
            What::Note(from, to) => EventRef::Note(unescape(words(from, to)?)?),
        };
        Some(RecordRef { time: Duration::from_micros(self.time_us), event })
    }
}

/// Reads one line without its end; the bytes of a record of bytes replace those in `bytes`.
pub(super) fn parse_line(line: &[u8], bytes: &mut Vec<u8>) -> Result<Parsed, DamageKind> {
    // What is wrong with a line that is no text is that it is none.
    parse(line, bytes)
        .map_err(|kind| if core::str::from_utf8(line).is_ok() { kind } else { DamageKind::NotUtf8 })
}

fn parse(line: &[u8], bytes: &mut Vec<u8>) -> Result<Parsed, DamageKind> {
    let Some((covered, &[b'*', high, low])) = line.split_last_chunk::<3>() else {
        return Err(SyntaxError::NoChecksum.into());
    };
    let found = sum_byte(high, low).ok_or(SyntaxError::NoChecksum)?;
    let computed = checksum(covered);
    if found != computed {
        return Err(DamageKind::Checksum { found, computed });
    }
    if !covered.ends_with(b" ") {
        return Err(SyntaxError::Payload.into());
    }
    let (time_us, rest) = parse_time(covered)?;
    let what = match rest {
        [b'>', rest @ ..] => hex_bytes(rest, bytes).map(|()| What::Host)?,
        [b'<', rest @ ..] => hex_bytes(rest, bytes).map(|()| What::Controller)?,
        [b'@', rest @ ..] => {
            let rest = rest
                .strip_suffix(b" ")
                .and_then(|rest| rest.strip_prefix(b" "))
                .ok_or(SyntaxError::Payload)?;
            let payload = core::str::from_utf8(rest).map_err(|_| DamageKind::NotUtf8)?;
            let start = covered.len().saturating_sub(rest.len()).saturating_sub(1);
            parse_event(payload, start).ok_or(SyntaxError::Payload)?
        }
        _ => return Err(SyntaxError::Channel.into()),
    };
    Ok(Parsed { time_us, what })
}

/// The time and what comes after the space behind it. `u64::from_str` would take a sign; a time has none.
fn parse_time(covered: &[u8]) -> Result<(u64, &[u8]), SyntaxError> {
    let mut time_us = 0_u64;
    let mut rest = covered;
    while let [digit @ b'0'..=b'9', after @ ..] = rest {
        let sum = time_us.checked_mul(10).and_then(|sum| sum.checked_add(u64::from(digit & 15)));
        time_us = sum.ok_or(SyntaxError::Time)?;
        rest = after;
    }
    match rest {
        _ if rest.len() == covered.len() => Err(SyntaxError::Time),
        [b' ', rest @ ..] => Ok((time_us, rest)),
        [] => Err(SyntaxError::Channel),
        _ => Err(SyntaxError::Time),
    }
}

/// ` HH HH ... ` into `bytes`: at least one, and the space before the asterisk.
fn hex_bytes(payload: &[u8], bytes: &mut Vec<u8>) -> Result<(), SyntaxError> {
    bytes.clear();
    let (pairs, end) = payload.as_chunks::<3>();
    if pairs.is_empty() {
        return Err(SyntaxError::Bytes);
    }
    let mut wrong = end != b" ";
    bytes.extend(pairs.iter().map(|&[space, high, low]| {
        let (high, low) = (nibble(high), nibble(low));
        wrong |= space != b' ' || (high | low) > 15;
        high << 4 | low
    }));
    if wrong { Err(SyntaxError::Bytes) } else { Ok(()) }
}

/// Value of a hex digit; 255 for anything else.
fn nibble(digit: u8) -> u8 {
    const VALUES: [u8; 256] = {
        let mut values = [255; 256];
        let mut value = 0;
        while value < 16_u8 {
            let [decimal, lower, upper] = [b'0', b'a' - 10, b'A' - 10];
            if value < 10 {
                values[(decimal + value) as usize] = value;
            } else {
                values[(lower + value) as usize] = value;
                values[(upper + value) as usize] = value;
            }
            value += 1;
        }
        values
    };
    VALUES.get(usize::from(digit)).copied().unwrap_or(255)
}

/// The checksum's digits are lower case, as all writers write them: so that a single flipped bit in them
/// shows.
fn sum_byte(high: u8, low: u8) -> Option<u8> {
    if high.is_ascii_uppercase() || low.is_ascii_uppercase() {
        return None;
    }
    let (high, low) = (nibble(high), nibble(low));
    ((high | low) <= 15).then_some(high << 4 | low)
}

/// What is beside the line; `start` is where the payload begins in it.
fn parse_event(payload: &str, start: usize) -> Option<What> {
    let (word, rest) = payload.split_once(' ')?;
    let from = start.checked_add(word.len())?.checked_add(1)?;
    if word == "note" {
        return unescape(rest).map(|_| What::Note(from, from.saturating_add(rest.len())));
    }
    let mut words = rest.split(' ');
    let first = words.next()?;
    let what = match word {
        "edge" => {
            let (axis, sign) = first.split_at_checked(1)?;
            What::Edge(parse_axis(axis)?, parse_sign(sign)?)
        }
        "drive" => What::Drive(parse_axis(first)?, words.next()?.parse().ok()?),
        "switch" => {
            SwitchName::new(first).ok()?;
            What::Switch(from, from.saturating_add(first.len()), parse_bool(words.next()?)?)
        }
        "estop" => What::Estop(parse_bool(first)?),
        "pen" => What::Pen(match first {
            "up" => Pen::Up,
            "down" => Pen::Down,
            _ => return None,
        }),
        "target" => What::Target(first.parse().ok()?, words.next()?.parse().ok()?),
        _ => return None,
    };
    words.next().is_none().then_some(what)
}

fn parse_axis(word: &str) -> Option<Axis> {
    match word {
        "x" => Some(Axis::X),
        "y" => Some(Axis::Y),
        _ => None,
    }
}

fn parse_sign(word: &str) -> Option<Direction> {
    match word {
        "+" => Some(Direction::Plus),
        "-" => Some(Direction::Minus),
        _ => None,
    }
}

fn parse_bool(word: &str) -> Option<bool> {
    match word {
        "0" => Some(false),
        "1" => Some(true),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Event, Record};

    fn line(time_us: u64, event: &Event) -> String {
        let mut line = Vec::new();
        write_line(&mut line, time_us, &event.view());
        String::from_utf8(line).unwrap()
    }

    fn parse_record(line: &[u8]) -> Result<Record, DamageKind> {
        let mut bytes = Vec::new();
        parse_line(line, &mut bytes).map(|parsed| parsed.of(line, &bytes).unwrap().to_record())
    }

    /// CRC-8/SMBUS (polynomial 0x07, from 0) as computed by an independent program, bit by bit.
    #[test]
    fn the_checksum_covers_the_space_before_the_asterisk() {
        let target = Event::Host(vec![3, 9, 9, 2, 0, 5, 5, 9, 3, 1]);
        assert_eq!(line(0, &target), "0 > 03 09 09 02 00 05 05 09 03 01 *89\n");
        assert_eq!(line(10312, &Event::Controller(b"131".to_vec())), "10312 < 31 33 31 *87\n");
        assert_eq!(
            line(10350, &Event::Edge { axis: Axis::X, sign: Direction::Plus }),
            "10350 @ edge x+ *5a\n"
        );
        assert_eq!(line(10351, &Event::Drive { axis: Axis::X, duty: 20 }), "10351 @ drive x 20 *04\n");
    }

    #[test]
    fn a_note_may_hold_an_asterisk_and_a_line_end() {
        let note = Event::Note(String::from("5 * 3 \\ \n\0 end "));
        let text = line(7, &note);
        assert!(text.starts_with("7 @ note 5 * 3 \\\\ \\n\\x00 end  *"), "{text}");
        assert_eq!(parse_record(text.trim_end_matches('\n').as_bytes()), Ok(Record::at_us(7, note)));
    }

    fn verdict(covered: &str) -> Result<Record, DamageKind> {
        parse_record(format!("{covered}*{:02x}", checksum(covered.as_bytes())).as_bytes())
    }

    #[test]
    fn each_part_of_a_line_is_judged() {
        assert_eq!(verdict("-1 > 00 "), Err(SyntaxError::Time.into()));
        assert_eq!(verdict("+1 > 00 "), Err(SyntaxError::Time.into()));
        assert_eq!(verdict("18446744073709551616 > 00 "), Err(SyntaxError::Time.into()));
        assert_eq!(verdict("1 ? 00 "), Err(SyntaxError::Channel.into()));
        assert_eq!(verdict("1 "), Err(SyntaxError::Channel.into()));
        assert_eq!(verdict("1 > "), Err(SyntaxError::Bytes.into()));
        assert_eq!(verdict("1 > 0 "), Err(SyntaxError::Bytes.into()));
        assert_eq!(verdict("1 > 00  01 "), Err(SyntaxError::Bytes.into()));
        assert_eq!(verdict("1 @ edge é+ "), Err(SyntaxError::Payload.into()));
        assert_eq!(verdict("1 @ edge x "), Err(SyntaxError::Payload.into()));
        assert_eq!(verdict("1 @ drive x 20 30 "), Err(SyntaxError::Payload.into()));
        assert_eq!(verdict("1 @ target 5000000000 0 "), Err(SyntaxError::Payload.into()));
        assert_eq!(verdict("1 > 00"), Err(SyntaxError::Payload.into()));
        assert_eq!(parse_record(b"1 > 00 *0"), Err(SyntaxError::NoChecksum.into()));
        assert_eq!(parse_record(b""), Err(SyntaxError::NoChecksum.into()));
        assert_eq!(parse_record(b"\xff\xfe"), Err(DamageKind::NotUtf8));
        assert!(matches!(parse_record(b"1 > 00 *00"), Err(DamageKind::Checksum { found: 0, .. })));
    }
}
