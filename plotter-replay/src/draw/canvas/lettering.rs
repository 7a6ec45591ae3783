//! Letters as strokes, for pictures without a font: what scale bar and legend need.

use plotter_motion::Point;

/// Width of a letter with the space after it, in heights of a figure.
pub(super) const ADVANCE: f64 = 5.5 / 6.0 * 0.7;
/// A letter's box is 4 wide and 6 high; letters are a little narrower than that.
const UNIT: f64 = 0.7 / 6.0;

/// Strokes of a letter: digit pairs x, y in a box 4 wide, y down, base line at 6; a space lifts the pen.
fn strokes(letter: char) -> &'static str {
    match letter {
        '0' => "103041453616050110",
        '1' => "022026",
        '2' => "01103041420646",
        '3' => "01103041423313 334445361605",
        '4' => "36300444",
        '5' => "400003334445361605",
        '6' => "413010010516364544331304",
        '7' => "004016",
        '8' => "13020110304142331304051636454433",
        '9' => "051636454130100102133342",
        '.' => "2625",
        'a' => "42120305163645 4246",
        'c' => "4332120305163645",
        'd' => "4046 42120305163645",
        'e' => "04444332120305163645",
        'f' => "40302126 0343",
        'h' => "0006 0312324346",
        'i' => "2226 2021",
        'm' => "0206 03122326 23324346",
        'n' => "0206 0312324346",
        'o' => "123243453616050312",
        'p' => "0208 0312324345361605",
        'r' => "0206 04133243",
        's' => "43321203143445361605",
        't' => "20253646 0242",
        'u' => "0205163645 4246",
        'w' => "0216233642",
        'y' => "0226 4208",
        'z' => "02420646",
        _ => "",
    }
}

/// Lines that write `text` with the base line starting at `at`, figures `height` high, y down.
pub(super) fn write(text: &str, at: Point, height: f64) -> Vec<Vec<Point>> {
    let mut lines = Vec::new();
    let mut left = at.x;
    for letter in text.chars() {
        for stroke in strokes(letter).split(' ').filter(|stroke| !stroke.is_empty()) {
            let digit = |c: u8| f64::from(c.saturating_sub(b'0'));
            let place = |pair: &[u8]| match *pair {
                [x, y] => {
                    Some(Point::new(left + digit(x) * UNIT * height, at.y + (digit(y) - 6.0) * UNIT * height))
                }
                _ => None,
            };
            lines.push(stroke.as_bytes().chunks(2).filter_map(place).collect());
        }
        left += ADVANCE * height;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::canvas::Layer;

    #[test]
    fn every_letter_of_scale_bar_and_legend_is_there() {
        let labels = Layer::ALL.map(Layer::label).concat();
        for letter in format!("0123456789. mm{labels}").chars().filter(|&c| c != ' ') {
            assert!(!strokes(letter).is_empty(), "{letter}");
        }
    }

    #[test]
    fn letters_stand_on_the_base_line() {
        let lines = write("10", Point::new(100.0, 50.0), 6.0);
        let lowest = lines.iter().flatten().map(|p| p.y).fold(0.0, f64::max);
        assert_eq!(lowest, 50.0);
        assert_eq!(lines.len(), 2);
    }
}
