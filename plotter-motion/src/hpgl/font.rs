//! The strokes of characters: one line wide, for pens.
//!
//! A capital letter is 8 steps wide and 12 high. A place is two characters: its x as a digit from 0 to 8, its
//! y as a letter from `a` for −4 over `e` for the line the letters stand on to `u` for 16. Places that follow
//! one another are joined; a blank lifts the pen; a place alone is a dot.
//!
//! ```text
//! u 16 ─ accents of capitals      "0e4q8e 1h7h" is the A:
//! q 12 ─ capitals                        ·q·
//! m  8 ─ small letters                  /   \
//! e  0 ─ line                          h─────h
//! a −4 ─ descenders                   0e     8e
//! ```

use super::lettering::place_of;
use crate::Point;

/// From the blank to the tilde.
const ASCII: [&str; 95] = [
    "",                                           // blank
    "4q4i 4e",                                    // !
    "3q3n 5q5n",                                  // "
    "2e3q 5e6q 0i7i 1m8m",                        // #
    "0g1f3e5e7f8h7j5k3k1l0n1p3q5q7p8o 4s4c",      // $
    "0e8q 2q1q0p0o1n2n3o3p2q 6h5g5f6e7e8f8g7h6h", // %
    "8e1n1p2q4q5p5n0j0g2e4e6f8j",                 // &
    "4q4n",                                       // '
    "5s3p2l2j3f5c",                               // (
    "3s5p6l6j5f3c",                               // )
    "4n4h 1m7i 1i7m",                             // *
    "4n4h 1k7k",                                  // +
    "4f4e3c",                                     // ,
    "1k7k",                                       // -
    "4e",                                         // .
    "1c7s",                                       // /
    "3e1g0i0m1o3q4q6o7m7i6g4e3e",                 // 0
    "1n4q4e 1e7e",                                // 1
    "0o1p3q4q6p7n6k0e7e",                         // 2
    "0o1p3q4q6p7n6l4k2k 4k6j7h6f4e3e1f0g",        // 3
    "5e5q0h7h",                                   // 4
    "7q1q0k2l4l6k7i6f4e2e0f",                     // 5
    "6p4q3q1o0k0h1f3e4e6f7h7i6k4l3l1k0i",         // 6
    "0q7q3e",                                     // 7
    "3k1l0n1p3q4q6p7n6l4k3k1j0h1f3e4e6f7h6j4k",   // 8
    "1f3e4e6g7k7n6p4q3q1p0n0m1k3j4j6k7m",         // 9
    "4l 4e",                                      // :
    "4l 4f4e3c",                                  // ;
    "7o1k7g",                                     // <
    "1m7m 1i7i",                                  // =
    "1o7k1g",                                     // >
    "0n1p3q5q7p8n7l4j4h 4e",                      // ?
    "6i5h3h2i2l3m5m6l6i7h8i8l7o5q3q1o0m0h1f3e6e", // @
    "0e4q8e 1h7h",                                // A
    "0e0q5q7p7l5k0k 5k7j8i8g7f5e0e",              // B
    "8g7f5e3e1f0h0n1p3q5q7p8o",                   // C
    "0e0q4q6p8n8h6f4e0e",                         // D
    "8e0e0q8q 0k6k",                              // E
    "0e0q8q 0k6k",                                // F
    "8o7p5q3q1p0n0h1f3e5e7f8g8k5k",               // G
    "0e0q 8e8q 0k8k",                             // H
    "4e4q 2e6e 2q6q",                             // I
    "0h1f3e4e6f7h7q",                             // J
    "0e0q 8q0i 3l8e",                             // K
    "0q0e8e",                                     // L
    "0e0q4i8q8e",                                 // M
    "0e0q8e8q",                                   // N
    "3e1f0h0n1p3q5q7p8n8h7f5e3e",                 // O
    "0e0q5q7p8o8m7k5j0j",                         // P
    "3e1f0h0n1p3q5q7p8n8h7f5e3e 5h8e",            // Q
    "0e0q5q7p8o8m7k5j0j 4j8e",                    // R
    "0g1f3e5e7f8h7j5k3k1l0n1p3q5q7p8o",           // S
    "4e4q 0q8q",                                  // T
    "0q0h1f3e5e7f8h8q",                           // U
    "0q4e8q",                                     // V
    "0q2e4m6e8q",                                 // W
    "0e8q 0q8e",                                  // X
    "0q4k8q 4k4e",                                // Y
    "0q8q0e8e",                                   // Z
    "5s3s3c5c",                                   // [
    "1s7c",                                       // \
    "3s5s5c3c",                                   // ]
    "1m4q7m",                                     // ^
    "0c8c",                                       // _
    "3q5n",                                       // `
    "7m7e 7j6l4m3m1l0j0h1f3e4e6f7h",              // a
    "0q0e 0h1f3e4e6f7h7j6l4m3m1l0j",              // b
    "7k6l4m3m1l0j0h1f3e4e6f7g",                   // c
    "7q7e 7j6l4m3m1l0j0h1f3e4e6f7h",              // d
    "0i7i7j6l4m3m1l0j0h1f3e4e6f7g",               // e
    "2e2o3q5q6p 0m5m",                            // f
    "7m7c6b4a3a1b0c 7j6l4m3m1l0j0h1f3e4e6f7h",    // g
    "0e0q 0j1l3m4m6l7j7e",                        // h
    "4e4m 4p",                                    // i
    "5m5c4a2a1b 5p",                              // j
    "0e0q 6m0g 2i7e",                             // k
    "3q3f4e5e",                                   // l
    "0e0m 0k1m3m4k4e 4k5m7m8k8e",                 // m
    "0e0m 0j1l3m4m6l7j7e",                        // n
    "3e1f0h0j1l3m4m6l7j7h6f4e3e",                 // o
    "0m0a 0j1l3m4m6l7j7h6f4e3e1f0h",              // p
    "7m7a 7j6l4m3m1l0j0h1f3e4e6f7h",              // q
    "0e0m 0j1l3m5m6l",                            // r
    "0f2e4e6f6h4i2i0j0l2m4m6l",                   // s
    "2q2g3e5e6f 0m5m",                            // t
    "0m0h1f3e4e6f7h 7m7e",                        // u
    "0m3e6m",                                     // v
    "0m2e4k6e8m",                                 // w
    "0e6m 0m6e",                                  // x
    "0m3e 6m2b1a0a",                              // y
    "0m6m0e6e",                                   // z
    "5s4r4l3k4j4d5c",                             // {
    "4s4c",                                       // |
    "3s4r4l5k4j4d3c",                             // }
    "0j1l3l5j7j8l",                               // ~
];

/// From the blank that does not break to the question mark that opens.
const SIGNS: [&str; 32] = [
    "",                                             // blank
    "4a4i 4m",                                      // ¡
    "7k6l4m3m1l0j0h1f3e4e6f7g 4o4c",                // ¢
    "8f7e0e2g2n3p5q7p 0k5k",                        // £
    "1h7n 1n7h 4h2i1k2m4n6m7k6i4h",                 // ¤
    "0q4k8q 4k4e 1j7j 1g7g",                        // ¥
    "4s4m 4i4c",                                    // ¦
    "7o5q3q1o2m6j7h5f 3l1j2h6e7c5a3a1c",            // §
    "2p 6p",                                        // ¨
    "3e1f0h0n1p3q5q7p8n8h7f5e3e 6m4n2l2j4h6i",      // ©
    "6q6n 6o5q3q2p2o3n5n6o 2l6l",                   // ª
    "4m1i4e 8m5i8e",                                // «
    "1k7k7h",                                       // ¬
    "1k7k",                                         // hyphen
    "3e1f0h0n1p3q5q7p8n8h7f5e3e 3h3n5n6m5k3k 4k6h", // ®
    "1q7q",                                         // ¯
    "3n2o2p3q5q6p6o5n3n",                           // °
    "4o4i 1l7l 1f7f",                               // ±
    "2p3q5q6p6o2l6l",                               // ²
    "2q6q4o6n5l3l2m",                               // ³
    "3n5q",                                         // ´
    "0m0a 0h1f3e4e6f7h 7m7e",                       // µ
    "7e7q2q0o0n2l5l 5q5e",                          // ¶
    "4k",                                           // ·
    "4e5c4b2b",                                     // ¸
    "3p4q4l",                                       // ¹
    "3n2o2p3q5q6p6o5n3n 2l6l",                      // º
    "0m3i0e 4m7i4e",                                // »
    "0p1q1l 1e7q 7e7j4g8g",                         // ¼
    "0p1q1l 1e7q 5i6j7j8i8h5e8e",                   // ½
    "0q3q1o3n2l0l 1e7q 7e7j4g8g",                   // ¾
    "8d7b5a3a1b0d1f4h4j 4m",                        // ¿
];

/// An accent on a small letter and on a capital one.
const GRAVE: (&str, &str) = ("2q4o", "3u5s");
const ACUTE: (&str, &str) = ("5q3o", "5u3s");
const CIRCUMFLEX: (&str, &str) = ("1o3q5o", "2s4u6s");
const TILDE: (&str, &str) = ("1o2p5o6p", "1s3t5s7t");
const DIAERESIS: (&str, &str) = ("2p 5p", "2s 6s");
const RING: (&str, &str) = ("3n2o2p3q4q5p5o4n3n", "4q3r3s4t5s5r4q");
const CEDILLA: (&str, &str) = ("3e4d4b3a2a", "4e5d5b4a3a");

/// Letters with accents: the letter that is meant, from À and from à on. What has no accent is drawn apart.
const LETTERS: [(u8, (&str, &str)); 32] = [
    (b'A', GRAVE),
    (b'A', ACUTE),
    (b'A', CIRCUMFLEX),
    (b'A', TILDE),
    (b'A', DIAERESIS),
    (b'A', RING),
    (0, ("4m4e 4j3m1m0k0g1e3e4h 4i8i8k7m5m4k 4g5e7e8f", "0e4q4e8e 4q8q 1h4h 4k7k")), // æ Æ
    (b'C', CEDILLA),
    (b'E', GRAVE),
    (b'E', ACUTE),
    (b'E', CIRCUMFLEX),
    (b'E', DIAERESIS),
    (b'I', GRAVE),
    (b'I', ACUTE),
    (b'I', CIRCUMFLEX),
    (b'I', DIAERESIS),
    (0, ("1o6q 2q5n7j7h6f4e3e1f0h0i1k3l5l7j", "1e1q4q6p8n8h6f4e1e 0k4k")), // ð Ð
    (b'N', TILDE),
    (b'O', GRAVE),
    (b'O', ACUTE),
    (b'O', CIRCUMFLEX),
    (b'O', TILDE),
    (b'O', DIAERESIS),
    (0, ("1k7k 4n 4h", "1h7n 1n7h")), // ÷ ×
    (b'O', ("0e7m", "0e8q")),
    (b'U', GRAVE),
    (b'U', ACUTE),
    (b'U', CIRCUMFLEX),
    (b'U', DIAERESIS),
    (b'Y', ACUTE),
    (0, ("0q0a 0j1l3m4m6l7j7h6f4e3e1f0h", "0e0q 0o5o7n8l7j5i0i")), // þ Þ
    (b'Y', DIAERESIS),
];

/// The letters whose dots make way for an accent.
const DOTLESS_I: &str = "4e4m";
const SHARP_S: &str = "0e0n1p3q4q6p6n4l6k7h6f4e3e";

/// The strokes of a character of Latin-1, and those of its accent; none for one that leaves no mark.
pub(super) fn strokes(character: u8) -> (&'static str, &'static str) {
    let of = |table: &[&'static str], first: u8| {
        table.get(usize::from(character.wrapping_sub(first))).copied().unwrap_or("")
    };
    match character {
        b' '..=b'~' => (of(&ASCII, b' '), ""),
        0xA0..=0xBF => (of(&SIGNS, 0xA0), ""),
        0xDF => (SHARP_S, ""),
        0xC0.. => {
            let small = character >= 0xE0;
            let Some((letter, accents)) = LETTERS.get(usize::from(character & 0x1F)) else { return ("", "") };
            let accent = if small { accents.0 } else { accents.1 };
            match letter {
                0 => (accent, ""),
                b'I' if small => (DOTLESS_I, accent),
                capital => (strokes(if small { capital.to_ascii_lowercase() } else { *capital }).0, accent),
            }
        }
        _ => ("", ""),
    }
}

/// The strokes of a letter of the labels' font, one line wide, for texts of other languages: rows of places
/// in steps, of which a capital letter is 8 wide and 12 high. The line that letters stand on is at y = 0, the
/// y axis points up, and a row of one place is a dot. A blank has no stroke; `None` for what the font does
/// not have: it has Latin-1, without control characters.
///
/// ```
/// use plotter_motion::{Point, hpgl::letter_strokes};
///
/// let strokes: Vec<Vec<Point>> = letter_strokes('L').unwrap().map(Iterator::collect).collect();
/// assert_eq!(strokes, [[Point::new(0.0, 12.0), Point::new(0.0, 0.0), Point::new(8.0, 0.0)]]);
/// assert!(letter_strokes('→').is_none());
/// ```
pub fn letter_strokes(
    letter: char,
) -> Option<impl Iterator<Item = impl Iterator<Item = Point> + Clone> + Clone> {
    let character = u8::try_from(letter).ok().filter(|_| !letter.is_control())?;
    let (letter, accent) = strokes(character);
    let places = |stroke: &'static str| {
        stroke.as_bytes().chunks_exact(2).filter_map(|place| match place {
            [x, y] => Some(place_of(*x, *y)),
            _ => None,
        })
    };
    Some(letter.split(' ').chain(accent.split(' ')).filter(|stroke| !stroke.is_empty()).map(places))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stroke_is_on_the_grid() {
        for character in 0..=u8::MAX {
            let (strokes, accent) = strokes(character);
            for stroke in strokes.split(' ').chain(accent.split(' ')) {
                assert_eq!(stroke.len() % 2, 0, "{character}: {stroke}");
                for place in stroke.as_bytes().chunks(2) {
                    assert!(matches!(place, [b'0'..=b'8', b'a'..=b'u']), "{character}: {stroke}");
                }
            }
        }
    }

    #[test]
    fn every_visible_character_has_strokes_of_its_own() {
        let visible = (b'!'..=b'~').chain(0xA1..=0xFF).filter(|character| *character != 0xAD);
        let mut seen = std::collections::BTreeMap::new();
        for character in visible {
            let drawn = strokes(character);
            assert!(!drawn.0.is_empty(), "{character}");
            if let Some(other) = seen.insert(drawn, character) {
                panic!("{character} looks like {other}");
            }
        }
        assert_eq!(strokes(0xE9), (strokes(b'e').0, ACUTE.0)); // é
        assert_eq!(strokes(0xDC), (strokes(b'U').0, DIAERESIS.1)); // Ü
    }
}
