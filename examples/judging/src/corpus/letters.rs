//! Single-line lettering on a grid 4 wide and 6 high, as with a stencil.

use super::strokes::At;

/// Height of a capital in units of the grid.
pub(crate) const HEIGHT: f64 = 6.0;

/// Distance from letter to letter in units of the grid.
const PITCH: f64 = 6.0;

/// The strokes of a line of lettering, in units of the grid, from the upper left corner of the first letter.
pub(crate) fn strokes(words: &str) -> Vec<Vec<At>> {
    let mut all = Vec::new();
    for (place, letter) in (0_u32..).zip(words.chars()) {
        for stroke in shape(letter).split('|').filter(|stroke| !stroke.is_empty()) {
            let point = |pair: &str| {
                let mut digits = pair.chars().filter_map(|digit| digit.to_digit(10)).map(f64::from);
                let (x, y) = (digits.next().unwrap_or(0.0), digits.next().unwrap_or(0.0));
                (x + PITCH * f64::from(place), y)
            };
            all.push(stroke.split(' ').map(point).collect());
        }
    }
    all
}

/// Width of a line of lettering of the given height.
pub(crate) fn width(words: &str, height: f64) -> f64 {
    let letters = words.chars().map(|_| 1.0).sum::<f64>();
    ((letters * PITCH - 2.0) * height / HEIGHT).max(0.0)
}

/// Column and row of each corner; a bar begins a new stroke.
fn shape(letter: char) -> &'static str {
    match letter {
        '0' | 'O' => "10 30 41 45 36 16 05 01 10",
        '1' => "11 20 26",
        '2' => "01 10 30 41 42 06 46",
        '3' => "00 40 22 32 43 45 36 16 05",
        '4' => "30 04 44|33 36",
        '5' => "40 00 02 32 43 45 36 16 05",
        '6' => "30 02 05 16 36 45 43 32 12 03",
        '7' => "00 40 16",
        '8' => "12 01 10 30 41 32 43 45 36 16 05 03 12 32",
        '9' => "43 34 14 03 01 10 30 41 44 36 16",
        'A' => "06 02 20 42 46|03 43",
        'B' => "03 00 30 41 42 33 44 45 36 06 03 33",
        'C' => "41 30 10 01 05 16 36 45",
        'D' => "00 20 42 44 26 06 00",
        'E' => "40 00 06 46|03 33",
        'F' => "40 00 06|03 33",
        'G' => "41 30 10 01 05 16 36 45 43 23",
        'H' => "00 06|40 46|03 43",
        'I' => "20 26",
        'K' => "00 06|40 03 46",
        'L' => "00 06 46",
        'M' => "06 00 23 40 46",
        'N' => "06 00 46 40",
        'P' => "06 00 30 41 42 33 03",
        'R' => "06 00 30 41 42 33 03|23 46",
        'S' => "41 30 10 01 02 13 33 44 45 36 16 05",
        'T' => "00 40|20 26",
        'U' => "00 05 16 36 45 40",
        'V' => "00 26 40",
        'X' => "00 46|40 06",
        'Y' => "00 23 40|23 26",
        'Z' => "00 40 06 46",
        '-' => "03 43",
        '+' => "03 43|21 25",
        '.' => "26",
        ':' => "22|25",
        '/' => "06 40",
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_letter_stands_one_pitch_right_of_the_one_before() {
        assert_eq!(strokes("1I")[1], vec![(8.0, 0.0), (8.0, 6.0)]);
    }

    #[test]
    fn a_full_stop_is_a_single_point() {
        assert_eq!(strokes("."), vec![vec![(2.0, 6.0)]]);
    }
}
