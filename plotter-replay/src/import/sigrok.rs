//! sigrok-cli's annotations of the UART decoder: `109-189 uart-1: 02`, samples from and to.
//!
//! A run without `-A uart=rx-data` also writes the bits (`0`, `1`), `Start bit`, `Stop bit` and errors: only
//! two hex digits are a byte, or, with the decoder's `format=ascii`, `[02]`. One file has both directions
//! where two decoders ran (`uart-1`, `uart-2`), or one with both lines and the names of its rows.

use super::hex_dump::hex_byte;
use super::{Chunk, Format, ImportSettings, Lines, Saw};

#[derive(Debug)]
pub(super) struct Sigrok {
    baud: u32,
    sample_rate_hz: Option<f64>,
    /// Lengths of the first bytes, samples.
    lengths: Vec<u64>,
    /// The rows that bytes are in, by the names of decoder and row: of both directions where there are two.
    rows: Vec<String>,
}

/// Bytes whose length is looked at: their median is the length of eight bits.
const MOST_LENGTHS: usize = 1_001;
/// Rows that are told apart.
const MOST_ROWS: usize = 8;

/// Samples from and to.
type Span = (u64, u64);

/// What a line says: samples from and to, the row, and the words.
fn annotation(line: &str) -> Option<(Option<Span>, String, &str)> {
    let (before, words) = line.split_once(": ")?;
    let (samples, decoder) = before.split_once(' ').map_or((None, before), |(s, decoder)| (Some(s), decoder));
    if !decoder.contains("uart") {
        return None;
    }
    let span = match samples {
        None => None,
        Some(samples) => {
            let (from, to) = samples.split_once('-')?;
            let (from, to): (u64, u64) = (from.parse().ok()?, to.parse().ok()?);
            (to > from).then_some((from, to))
        }
    };
    // The name of the row may come before it (--protocol-decoder-ann-class).
    let row = ["rx", "tx"].into_iter().find_map(|way| {
        let words = words.strip_prefix(way)?.strip_prefix("-data: ")?;
        Some((format!("{decoder} {way}"), words))
    });
    let (row, words) = row.unwrap_or_else(|| (decoder.to_owned(), words));
    Some((span, row, words.trim()))
}

fn byte_of(words: &str) -> Option<u8> {
    hex_byte(words).or_else(|| hex_byte(words.strip_prefix('[')?.strip_suffix(']')?))
}

impl Sigrok {
    pub(super) fn new(settings: &ImportSettings) -> Self {
        let sample_rate_hz = settings.sample_rate_hz.filter(|rate| rate.is_finite() && *rate >= 1.0);
        Self { baud: settings.baud, sample_rate_hz, lengths: Vec::new(), rows: Vec::new() }
    }

    fn read(&self, line: &str) -> Option<Result<Chunk, String>> {
        let Some((span, row, words)) = annotation(line) else {
            return Some(Err(String::from("expected samples and `uart-1: ` with a byte in hex")));
        };
        let Some(byte) = byte_of(words) else {
            let lower = words.to_ascii_lowercase();
            let bad = lower.contains("error") || lower.contains("break");
            return bad.then(|| Err(format!("the decoder says: {words}")));
        };
        let Some((from, to)) = span else {
            return Some(Err(String::from(
                "a byte without its samples: run with --protocol-decoder-samplenum",
            )));
        };
        let Some(rate_hz) = self.sample_rate_hz.or_else(|| self.rate_by_length_hz()) else {
            return Some(Err(String::from("the samples a second are not known")));
        };
        // The annotation spans the eight bits; the stop bit comes after them.
        #[expect(clippy::cast_precision_loss, reason = "samples below 2^53")]
        let end = to as f64 + to.saturating_sub(from) as f64 / 8.0;
        let ns = end / rate_hz * 1e9;
        #[expect(
            clippy::cast_possible_truncation,
            reason = "saturates, and is checked to be less than 30 years"
        )]
        let time_ns = libm::round(ns.min(1e18)) as i128;
        let side = if self.has_both() { Saw::Name(row) } else { Saw::File };
        Some(Ok(Chunk { time_ns, side, bytes: vec![byte] }))
    }

    /// Whether the rows are of two directions: two decoders, or both lines of one.
    fn has_both(&self) -> bool {
        let decoder = |row: &str| row.split(' ').next().unwrap_or_default().to_owned();
        let first = self.rows.first().map(|row| decoder(row));
        let ends = |way: &str| self.rows.iter().any(|row| row.ends_with(way));
        self.rows.iter().any(|row| Some(decoder(row)) != first) || ends(" rx") && ends(" tx")
    }

    /// Eight bits take so many samples, and so much time at the baud rate.
    fn rate_by_length_hz(&self) -> Option<f64> {
        let &median = self.lengths.get(self.lengths.len() / 2)?;
        #[expect(clippy::cast_precision_loss, reason = "samples of a byte")]
        let samples_per_bit = median as f64 / 8.0;
        Some(samples_per_bit * f64::from(self.baud))
    }
}

impl Format for Sigrok {
    fn survey(&mut self, line: &str) {
        let Some((Some((from, to)), row, _)) =
            annotation(line).filter(|(.., words)| byte_of(words).is_some())
        else {
            return;
        };
        if !self.rows.contains(&row) && self.rows.len() < MOST_ROWS {
            self.rows.push(row);
        }
        if self.lengths.len() < MOST_LENGTHS {
            let length = to.saturating_sub(from);
            let at = self.lengths.partition_point(|&other| other < length);
            self.lengths.insert(at, length);
        }
    }

    fn line(&mut self, line: &str, out: &mut Lines) {
        if !line.trim().is_empty() && !line.starts_with("FRAME-") && !line.starts_with("META") {
            out.extend(self.read(line));
        }
    }
}
