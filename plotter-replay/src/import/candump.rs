//! candump and those who write like it: `(1436509052.249713) vcan0 31 33`.
//!
//! What comes after the name may be bytes with or without spaces, a log line `044#2A366C`, or candump's own
//! `TX - -  123   [2]  11 22`; the time may be a date.

use super::clock::{date_s, fraction_ns, seconds_ns};
use super::hex_dump::hex_run;
use super::{Chunk, Format, Lines, Saw};

#[derive(Debug)]
pub(super) struct Candump;

fn read(line: &str) -> Result<Chunk, &'static str> {
    let no_time = "expected a time in parentheses, seconds and their fraction";
    let (stamp, rest) = line.strip_prefix('(').and_then(|line| line.split_once(')')).ok_or(no_time)?;
    let time_ns = match stamp.split_once(' ') {
        None => seconds_ns(stamp),
        Some((date, time)) => time.split_once('.').and_then(|(time, fraction)| {
            date_s(date, time)?.checked_mul(1_000_000_000)?.checked_add(fraction_ns(fraction)?)
        }),
    }
    .ok_or(no_time)?;
    let mut words = rest.split_ascii_whitespace().peekable();
    let name = words.next().ok_or("expected a name after the time")?;
    while words.next_if(|word| matches!(*word, "TX" | "RX" | "-" | "B" | "E")).is_some() {}
    let words: Vec<&str> = words.collect();
    // Identifier and number of bytes of a frame come before the bytes.
    let data = match words.as_slice() {
        [_, count, data @ ..] if count.starts_with('[') => data,
        data => data,
    };
    let mut bytes = Vec::new();
    for word in data {
        let digits = word.split_once('#').map_or(*word, |(_, digits)| digits);
        bytes.append(&mut hex_run(digits).ok_or("expected bytes in hex after the name")?);
    }
    if bytes.is_empty() {
        return Err("expected bytes in hex after the name");
    }
    Ok(Chunk { time_ns, side: Saw::Name(name.to_owned()), bytes })
}

impl Format for Candump {
    fn line(&mut self, line: &str, out: &mut Lines) {
        if !line.trim().is_empty() {
            out.push(read(line.trim()).map_err(str::to_owned));
        }
    }
}
