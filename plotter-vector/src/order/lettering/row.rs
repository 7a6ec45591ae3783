//! [`Row`]: letters on a common base line.

use super::mark::Placed;
use super::{ALIGNED, WIDEST};

/// How much of the narrower of two strokes lies above or below the other if both are of one letter.
const SAME_LETTER: f64 = 0.25;

/// Difference of the directions of two parts of one line, rad: three letters by themselves tell it to some
/// degrees.
const SAME_DIRECTION_RAD: f64 = 0.07;

/// Letters on a line, and the band in which most of them lie.
#[derive(Clone, Debug)]
pub(super) struct Row<'a> {
    pub(super) angle: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    pub(super) letters: Vec<Placed<'a>>,
}

impl Row<'_> {
    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn holds(&self, letter: &Placed<'_>, tail: f64) -> bool {
        let tail = tail * self.height();
        letter.top >= self.top - tail
            && letter.bottom <= self.bottom + tail
            && letter.right - letter.left <= WIDEST * self.height()
    }

    /// Whether a row of another group is on this one's base line, at one of its letters, and of its height.
    pub(super) fn goes_on(&self, other: &Row<'_>, letter: &Placed<'_>) -> bool {
        let here = Placed::new(letter.mark, self.angle);
        let height = self.height();
        let same = |a: f64, b: f64| (a - b).abs() <= 2.0 * ALIGNED * height;
        (self.angle - other.angle).abs() <= SAME_DIRECTION_RAD
            && same(here.bottom - self.bottom, letter.bottom - other.bottom)
            && same(here.top - self.top, letter.top - other.top)
            && self.pen() == other.pen()
    }

    pub(super) fn left(&self) -> f64 {
        self.letters.iter().map(|letter| letter.left).fold(f64::INFINITY, f64::min)
    }

    pub(super) fn right(&self) -> f64 {
        self.letters.iter().map(|letter| letter.right).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The strokes by letter, those of one in the drawing's order: they lie above each other.
    pub(super) fn letters_apart(&self) -> Vec<Vec<usize>> {
        let mut letters: Vec<Vec<usize>> = Vec::new();
        let mut reach = (f64::NEG_INFINITY, f64::NEG_INFINITY);
        for letter in &self.letters {
            let narrow = (letter.right - letter.left).min(reach.1 - reach.0);
            let common = letter.right.min(reach.1) - letter.left.max(reach.0);
            match letters.last_mut() {
                Some(own) if common >= SAME_LETTER * narrow => {
                    own.push(letter.mark.stroke);
                    reach.1 = reach.1.max(letter.right);
                }
                _ => {
                    letters.push(vec![letter.mark.stroke]);
                    reach = (letter.left, letter.right);
                }
            }
        }
        letters.iter_mut().for_each(|own| own.sort_unstable());
        letters
    }

    pub(super) fn pen(&self) -> Option<u8> {
        self.letters.first().map(|letter| letter.mark.pen)
    }
}
