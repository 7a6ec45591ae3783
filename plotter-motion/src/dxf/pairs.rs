//! [`Pairs`]: the groups of a text, a code and a value each.

use super::{Error, Problem};
use alloc::string::{String, ToString};
use alloc::vec::Vec;

/// Longest value, bytes; DXF has 2049 letters at most (Autodesk, *DXF Reference*, "Group codes in numerical
/// order"). What follows is passed over.
const MOST_VALUE_BYTES: usize = 4096;

/// A group: what it means, and its value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pair {
    pub(super) code: i32,
    pub(super) value: String,
    /// Line of the value, from 1.
    pub(super) line: u32,
}

impl Pair {
    /// Its value as a finite number.
    pub(super) fn number(&self) -> Option<f64> {
        let number: f64 = self.value.trim().parse().ok()?;
        number.is_finite().then_some(number)
    }

    /// Its value as a whole number.
    pub(super) fn whole(&self) -> Option<i64> {
        let value = self.value.trim();
        value.parse().ok().or_else(|| {
            let number: f64 = value.parse().ok()?;
            crate::whole::is_whole(number).then(|| crate::whole::whole(number))
        })
    }
}

/// Reads the groups of a text from an iterator of its bytes.
#[derive(Debug)]
pub(super) struct Pairs<I> {
    bytes: I,
    line: u32,
    /// The byte after a carriage return that was no line feed.
    kept: Option<u8>,
    /// Whether lines that are no code have been told of since the last group.
    is_astray: bool,
}

impl<I: Iterator<Item = u8>> Pairs<I> {
    pub(super) fn new(bytes: I) -> Self {
        Self { bytes, line: 0, kept: None, is_astray: false }
    }

    /// Line that was read last.
    pub(super) fn line(&self) -> u32 {
        self.line
    }

    /// The next group; `None` at the end of the text.
    ///
    /// Where a code belongs and something else stands, lines are passed over up to one that is a code.
    pub(super) fn next(&mut self) -> Option<Result<Pair, Error>> {
        loop {
            let code = self.text()?;
            let line = self.line;
            let code =
                String::from_utf8_lossy(code.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&code)).into_owned();
            if let Some(code) = code.trim().parse().ok().filter(|code: &i32| (-5..=1071).contains(code)) {
                self.is_astray = false;
                let Some(value) = self.text() else {
                    return Some(Err(Error { line, problem: Problem::Cut }));
                };
                return Some(Ok(Pair { code, value: decoded(value), line: self.line }));
            }
            if code.trim().is_empty() && self.kept.is_none() {
                // Blank lines at the end are usual.
                continue;
            }
            if !core::mem::replace(&mut self.is_astray, true) {
                let text = code.trim().chars().take(32).collect::<String>().to_string();
                return Some(Err(Error { line, problem: Problem::NoCode { text } }));
            }
        }
    }

    /// The next line, without its end: a line feed, a carriage return, or both.
    fn text(&mut self) -> Option<Vec<u8>> {
        let mut text = Vec::new();
        let mut is_there = false;
        while let Some(byte) = self.kept.take().or_else(|| self.bytes.next()) {
            is_there = true;
            match byte {
                b'\n' => break,
                b'\r' => {
                    self.kept = self.bytes.next().filter(|byte| *byte != b'\n');
                    break;
                }
                _ if text.len() < MOST_VALUE_BYTES => text.push(byte),
                _ => {}
            }
        }
        self.line = self.line.saturating_add(u32::from(is_there));
        is_there.then_some(text)
    }
}

/// As UTF-8 (from AutoCAD 2007 on) if it is such, else as Windows-1252, the code page of most older files.
fn decoded(bytes: Vec<u8>) -> String {
    /// From 0x80 to 0x9F, where it differs from Latin-1; five of them mean nothing.
    const WINDOWS: [char; 32] = [
        '€', '?', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '?', 'Ž', '?', '?', '‘', '’', '“',
        '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '?', 'ž', 'Ÿ',
    ];
    String::from_utf8(bytes).unwrap_or_else(|error| {
        let letter = |byte: &u8| match byte {
            0x80..=0x9F => WINDOWS.get(usize::from(*byte - 0x80)).copied().unwrap_or('?'),
            _ => char::from(*byte),
        };
        error.as_bytes().iter().map(letter).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    fn read(text: &[u8]) -> (Vec<(i32, String, u32)>, Vec<Error>) {
        let mut pairs = Pairs::new(text.iter().copied());
        let (mut good, mut bad) = (vec![], vec![]);
        while let Some(pair) = pairs.next() {
            match pair {
                Ok(Pair { code, value, line }) => good.push((code, value, line)),
                Err(error) => bad.push(error),
            }
        }
        (good, bad)
    }

    #[test]
    fn lines_may_end_in_three_ways() {
        for text in ["  0\nLINE\n 10\n1.5\n", "0\r\nLINE\r\n10\r\n1.5", "0\rLINE\r10\r1.5\r\r"] {
            let (good, bad) = read(text.as_bytes());
            assert_eq!(good, [(0, "LINE".into(), 2), (10, "1.5".into(), 4)], "{text:?}");
            assert_eq!(bad, []);
        }
    }

    #[test]
    fn what_is_no_code_is_told_once_and_passed_over() {
        let (good, bad) = read(b"0\nLINE\nfoo\nbar\n10\n1\n 8");
        assert_eq!(good.len(), 2);
        assert_eq!(bad[0], Error { line: 3, problem: Problem::NoCode { text: "foo".into() } });
        assert_eq!(bad[1], Error { line: 7, problem: Problem::Cut });
    }

    #[test]
    fn letters_of_older_files() {
        let (good, _) = read(b"1\nH\xf6he \x80\n1\nH\xc3\xb6he\n");
        assert_eq!((&*good[0].1, &*good[1].1), ("Höhe €", "Höhe"));
    }

    #[test]
    fn numbers_that_are_none() {
        let pair = |value: &str| Pair { code: 10, value: value.into(), line: 1 };
        assert_eq!(pair(" 1.5 ").number(), Some(1.5));
        assert_eq!((pair("nan").number(), pair("1e999").number(), pair("x").number()), (None, None, None));
        assert_eq!((pair("3").whole(), pair("3.0").whole(), pair("3.5").whole()), (Some(3), Some(3), None));
    }
}
