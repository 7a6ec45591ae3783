//! Numbers as short JSON: differences, in whole micrometres and microseconds.

use super::envelope::whole;
use super::trail::TrailPoint;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};
use std::io::Write;

pub(crate) fn signed(time_us: u64) -> i64 {
    i64::try_from(time_us).unwrap_or(i64::MAX)
}

/// Each value as its difference from the one before: shorter.
pub(crate) fn steps(values: impl Iterator<Item = i64>) -> Vec<i64> {
    let mut before = 0_i64;
    values.map(|value| value.saturating_sub(core::mem::replace(&mut before, value))).collect()
}

/// A trail without its times as differences, micrometres; the states as one digit each.
pub(crate) fn along(points: &[TrailPoint]) -> Value {
    let state = |point: &TrailPoint| char::from(b'0'.saturating_add(point.state.min(9)));
    json!({
        "x": steps(points.iter().map(|p| whole(p.x_mm * 1e3))),
        "y": steps(points.iter().map(|p| whole(p.y_mm * 1e3))),
        "s": points.iter().map(state).collect::<String>(),
    })
}

/// A trail with its times, in few bytes: times, x and y one after the other as differences in LEB128 (x and y
/// as 2n, or -2n-1 below 0), then a byte of state for each point; zlib, base64. Places are in units of
/// `unit_um` micrometres, times of as many microseconds: nothing here is faster than a metre a second.
pub(super) fn packed(points: &[TrailPoint], unit_um: u32) -> Value {
    let unit_um = unit_um.max(1);
    let unit_us = i64::from(unit_um);
    let mut bytes = Vec::with_capacity(points.len().saturating_mul(6));
    let place = |mm: f64| whole(mm * 1e3 / f64::from(unit_um));
    let time = |us: u64| signed(us).saturating_add(unit_us / 2) / unit_us;
    for step in steps(points.iter().map(|p| time(p.at_us))) {
        leb128(&mut bytes, step.cast_unsigned());
    }
    for axis in [|p: &TrailPoint| p.x_mm, |p: &TrailPoint| p.y_mm] {
        for step in steps(points.iter().map(|p| place(axis(p)))) {
            leb128(&mut bytes, ((step << 1) ^ (step >> 63)).cast_unsigned());
        }
    }
    bytes.extend(points.iter().map(|p| p.state));
    json!({ "unit_um": unit_um, "count": points.len(), "bytes": zipped(&[&bytes]) })
}

fn leb128(bytes: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        bytes.push((number & 0x7f) as u8 | 0x80);
        number >>= 7;
    }
    bytes.push((number & 0x7f) as u8);
}

/// Bytes as text: zlib, base64.
pub(super) fn zipped(parts: &[&[u8]]) -> String {
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::best());
    let written = parts.iter().try_for_each(|part| packed.write_all(part));
    base64(&written.and_then(|()| packed.finish()).unwrap_or_default())
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word =
            three.iter().fold(0_u32, |word, &byte| word << 8 | u32::from(byte)) << (8 * (3 - three.len()));
        for place in 0..4 {
            let six = usize::try_from(word >> (18 - 6 * place) & 63).unwrap_or(0);
            let letter = LETTERS.get(six).copied().unwrap_or(b'=');
            text.push(if place > three.len() { '=' } else { char::from(letter) });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_as_in_its_standard() {
        let texts = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(texts, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }

    #[test]
    fn a_long_way_takes_few_bytes() {
        // Corners of a zigzag that is not quite regular, each 5 to 6 mm from the last.
        let points: Vec<_> = (0..100_000_u64)
            .map(|n| TrailPoint {
                at_us: n * 30_000 + n * n % 977,
                x_mm: n as f64 % 40.0 * 5.0 + (n * n % 101) as f64 * 0.01,
                y_mm: (n % 2) as f64 * 3.0 + (n * n % 103) as f64 * 0.01,
                state: u8::from(n % 60 > 0),
            })
            .collect();
        let text = packed(&points, 80)["bytes"].as_str().unwrap().len();
        assert!(text < 600_000, "{text}");
    }
}
