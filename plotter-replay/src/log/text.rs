//! One record as one line of text, both ways.

use super::damage::{DamageKind, SyntaxError};
use super::{Event, Record, SwitchName};
use core::fmt::Write as _;
use core::time::Duration;
use plotter_motion::{Axis, Direction, Pen};

const CHECKSUM: crc::Crc<u8> = crc::Crc::<u8>::new(&crc::CRC_8_SMBUS);

/// Appends `record` and a line end to `line`; `time_us` is the record's time.
pub(crate) fn write_line(line: &mut String, time_us: u64, event: &Event) {
    let start = line.len();
    // Writing to a `String` cannot fail.
    let _ = write_covered(line, time_us, event);
    let sum = CHECKSUM.checksum(line.as_bytes().get(start..).unwrap_or_default());
    let _ = writeln!(line, "*{sum:02x}");
}

fn write_covered(line: &mut String, time_us: u64, event: &Event) -> core::fmt::Result {
    write!(line, "{time_us} ")?;
    match event {
        Event::Host(bytes) => write_bytes(line, '>', bytes)?,
        Event::Controller(bytes) => write_bytes(line, '<', bytes)?,
        Event::Edge { axis, sign } => write!(line, "@ edge {}{}", axis_name(*axis), sign_name(*sign))?,
        Event::Drive { axis, duty } => write!(line, "@ drive {} {duty}", axis_name(*axis))?,
        Event::Switch { name, pressed } => write!(line, "@ switch {} {}", name.as_str(), u8::from(*pressed))?,
        Event::Estop(pressed) => write!(line, "@ estop {}", u8::from(*pressed))?,
        Event::Pen(Pen::Up) => line.push_str("@ pen up"),
        Event::Pen(Pen::Down) => line.push_str("@ pen down"),
        Event::Target { x, y } => write!(line, "@ target {x} {y}")?,
        Event::Note(text) => {
            line.push_str("@ note ");
            escape(line, text)?;
        }
    }
    line.push(' ');
    Ok(())
}

fn write_bytes(line: &mut String, channel: char, bytes: &[u8]) -> core::fmt::Result {
    line.push(channel);
    bytes.iter().try_for_each(|byte| write!(line, " {byte:02x}"))
}

/// A record stays one line whatever a note says: `\` and control characters become `\xHH`.
fn escape(line: &mut String, text: &str) -> core::fmt::Result {
    for c in text.chars() {
        match c {
            '\\' => line.push_str("\\\\"),
            '\n' => line.push_str("\\n"),
            c if c.is_ascii_control() => write!(line, "\\x{:02x}", u32::from(c))?,
            c => line.push(c),
        }
    }
    Ok(())
}

fn unescape(text: &str) -> Option<String> {
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
    Some(out)
}

/// Reads one line without its end.
pub(super) fn parse_line(line: &[u8]) -> Result<Record, DamageKind> {
    let text = core::str::from_utf8(line).map_err(|_| DamageKind::NotUtf8)?;
    let (covered, found) = text.rsplit_once('*').ok_or(SyntaxError::NoChecksum)?;
    let found = hex_byte(found).ok_or(SyntaxError::NoChecksum)?;
    let computed = CHECKSUM.checksum(covered.as_bytes());
    if found != computed {
        return Err(DamageKind::Checksum { found, computed });
    }
    let covered = covered.strip_suffix(' ').ok_or(SyntaxError::Payload)?;
    let (time, rest) = covered.split_once(' ').ok_or(SyntaxError::Channel)?;
    // `u64::from_str` would take a sign; a time has none.
    let time_us = if time.bytes().all(|b| b.is_ascii_digit()) { time.parse::<u64>().ok() } else { None };
    let time_us = time_us.ok_or(SyntaxError::Time)?;
    let (channel, payload) = rest.split_once(' ').unwrap_or((rest, ""));
    let event = match channel {
        ">" => Event::Host(hex_bytes(payload).ok_or(SyntaxError::Bytes)?),
        "<" => Event::Controller(hex_bytes(payload).ok_or(SyntaxError::Bytes)?),
        "@" => parse_event(payload).ok_or(SyntaxError::Payload)?,
        _ => return Err(SyntaxError::Channel.into()),
    };
    Ok(Record { time: Duration::from_micros(time_us), event })
}

fn parse_event(payload: &str) -> Option<Event> {
    let (word, rest) = payload.split_once(' ')?;
    if word == "note" {
        return Some(Event::Note(unescape(rest)?));
    }
    let mut words = rest.split(' ');
    let first = words.next()?;
    let event = match word {
        "edge" => {
            let (axis, sign) = first.split_at_checked(1)?;
            Event::Edge { axis: parse_axis(axis)?, sign: parse_sign(sign)? }
        }
        "drive" => Event::Drive { axis: parse_axis(first)?, duty: words.next()?.parse().ok()? },
        "switch" => Event::Switch { name: SwitchName::new(first).ok()?, pressed: parse_bool(words.next()?)? },
        "estop" => Event::Estop(parse_bool(first)?),
        "pen" => Event::Pen(match first {
            "up" => Pen::Up,
            "down" => Pen::Down,
            _ => return None,
        }),
        "target" => Event::Target { x: first.parse().ok()?, y: words.next()?.parse().ok()? },
        _ => return None,
    };
    words.next().is_none().then_some(event)
}

fn axis_name(axis: Axis) -> char {
    match axis {
        Axis::X => 'x',
        Axis::Y => 'y',
    }
}

fn sign_name(sign: Direction) -> char {
    match sign {
        Direction::Plus => '+',
        Direction::Minus => '-',
    }
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

fn hex_byte(word: &str) -> Option<u8> {
    let fits = word.len() == 2 && word.bytes().all(|b| b.is_ascii_hexdigit());
    if fits { u8::from_str_radix(word, 16).ok() } else { None }
}

fn hex_bytes(payload: &str) -> Option<Vec<u8>> {
    payload.split(' ').map(hex_byte).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(time_us: u64, event: &Event) -> String {
        let mut line = String::new();
        write_line(&mut line, time_us, event);
        line
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
        assert_eq!(parse_line(text.trim_end_matches('\n').as_bytes()), Ok(Record::at_us(7, note)));
    }

    fn verdict(covered: &str) -> Result<Record, DamageKind> {
        parse_line(format!("{covered}*{:02x}", CHECKSUM.checksum(covered.as_bytes())).as_bytes())
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
        assert_eq!(parse_line(b"1 > 00 *0"), Err(SyntaxError::NoChecksum.into()));
        assert_eq!(parse_line(b""), Err(SyntaxError::NoChecksum.into()));
        assert_eq!(parse_line(b"\xff\xfe"), Err(DamageKind::NotUtf8));
        assert!(matches!(parse_line(b"1 > 00 *00"), Err(DamageKind::Checksum { found: 0, .. })));
    }
}
