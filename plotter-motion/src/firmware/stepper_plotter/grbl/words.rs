//! The words of a line that is in memory as a whole.

use super::codes::Code;
use crate::decimal::Decimal;
use crate::gcode::{Block, MOST, Position, Word, Words, is_control, is_text};

/// The words of a line without blanks and comments, in capitals; none if it has no words. The result is that
/// of a [`Reader`](crate::gcode::Reader), which takes byte by byte, in a third of its program memory.
/// Checksums, texts and programs are only for [`Words::Any`].
#[inline(never)]
pub(super) fn read(text: &[u8], known: Words) -> Result<Option<Block>, Code> {
    let knows_any = known == Words::Any;
    let mut block = Block::empty();
    let mut rest = text;
    let mut column = 0_u32;
    while let Some((&letter, after)) = rest.split_first() {
        let is_first = block.words().is_empty();
        column += 1;
        match letter {
            b'A'..=b'Z' => {}
            b'%' | b'/' if is_first => {
                rest = after;
                continue;
            }
            b'$' if is_first => return Err(Code::BAD_STATEMENT),
            b'*' if knows_any && !is_first && checksum_fits(text, after) => break,
            _ => return Err(Code::NO_LETTER),
        }
        if knows_any && block.words().last().is_some_and(|word| is_control(word, letter)) {
            return Err(Code::UNSUPPORTED);
        }
        rest = after;
        let mut number = None;
        if let Some((&first, after)) = rest.split_first()
            && let Some(mut decimal) = Decimal::begin(first)
        {
            rest = after;
            while let Some((&byte, after)) = rest.split_first()
                && decimal.push(byte)
            {
                rest = after;
            }
            // A second point, a comma or an exponent (Grbl takes the first two for no letter, the third for
            // one), no digit at all, or a number that is too great.
            let ends = !knows_any || !matches!(rest.first(), Some(b'.' | b',' | b'E'));
            let value = decimal.value().filter(|value| ends && value.abs() <= MOST);
            number = Some(value.ok_or(Code::BAD_NUMBER)?);
        } else if !knows_any {
            return Err(Code::BAD_NUMBER);
        }
        if !block.push(Word { letter, number, column }, Position::START) {
            return Err(Code::OVERFLOW);
        }
        if knows_any && is_text(letter, number) {
            break;
        }
    }
    Ok((!block.words().is_empty()).then_some(block))
}

/// Whether `digits`, which stand behind the last `*` of a line, are the exclusive or of the bytes before it.
fn checksum_fits(line: &[u8], digits: &[u8]) -> bool {
    let before = line.len().saturating_sub(digits.len() + 1);
    let sum = line.iter().take(before).fold(0, |sum, byte| sum ^ byte);
    whole(digits) == Some(sum)
}

/// A whole number up to 255.
pub(super) fn whole(digits: &[u8]) -> Option<u8> {
    let number = digits.iter().try_fold(0_u8, |number, byte| {
        let digit = byte.checked_sub(b'0').filter(|digit| *digit < 10)?;
        number.checked_mul(10)?.checked_add(digit)
    });
    number.filter(|_| !digits.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gcode::{Complaint, Reader};
    use std::vec::Vec;

    /// Pieces of lines, good and bad.
    const PIECES: [&str; 40] = [
        "G",
        "M",
        "X",
        "Y",
        "O",
        "N",
        "S",
        "F",
        "I",
        "0",
        "1",
        "2",
        "9",
        "23",
        "117",
        "118",
        ".",
        "-",
        "+",
        ",",
        "E",
        "%",
        "/",
        "$",
        "*",
        "#",
        "[",
        "<",
        "~",
        "=",
        "G1",
        "X10",
        "Y-2.5",
        "1000000000",
        "99999999999999999999",
        "F600",
        "O10",
        "WHILE",
        "M23",
        "*71",
    ];

    type Found = Vec<(u8, Option<f64>)>;

    /// The result of the reader that takes byte by byte.
    fn by_bytes(text: &[u8]) -> Result<Option<Found>, Code> {
        let mut reader = Reader::new();
        for &byte in text {
            if let Some(Err(error)) = reader.push(byte) {
                return Err(Code::of(error.problem, error.at));
            }
        }
        match reader.finish().transpose() {
            Ok(block) => Ok(block.map(|block| words(&block))),
            Err(error) => Err(Code::of(error.problem, error.at)),
        }
    }

    fn words(block: &Block) -> Found {
        block.words().iter().map(|word| (word.letter, word.number)).collect()
    }

    #[test]
    fn a_line_has_the_words_that_the_reader_finds() {
        let mut bits = 1_u64;
        let mut chosen = |count: usize| {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            usize::try_from(bits >> 33).unwrap() % count
        };
        let (mut good, mut bad) = (0, 0);
        for _ in 0..100_000 {
            let text: Vec<u8> = (0..chosen(24)).flat_map(|_| PIECES[chosen(PIECES.len())].bytes()).collect();
            let found = read(&text, Words::Any).map(|block| block.map(|block| words(&block)));
            assert_eq!(found, by_bytes(&text), "{}", text.escape_ascii());
            *if found.is_ok() { &mut good } else { &mut bad } += 1;
        }
        assert!(good > 5_000 && bad > 50_000, "{good} {bad}");
    }

    #[test]
    fn a_checksum_must_be_that_of_the_bytes_before_it() {
        assert_eq!(
            read(b"N3T0*25", Words::Any).map(|block| block.map(|block| block.words().len())),
            Ok(Some(2))
        );
        assert_eq!(read(b"N3T0*25", Words::Grbl), Err(Code::NO_LETTER));
        for wrong in [&b"N3T0*26"[..], b"N3T0*", b"N3T0*281", b"N3T0*25X"] {
            assert_eq!(read(wrong, Words::Any), Err(Code::NO_LETTER), "{}", wrong.escape_ascii());
        }
    }
}
