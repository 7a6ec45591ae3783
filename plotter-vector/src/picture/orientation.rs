//! [`Orientation`]: how a stored picture is turned to be seen upright.

use crate::picture::{Bitmap, Pixel};
use core::fmt;

/// How a stored picture must be turned or mirrored to be seen upright, by its number from 1 to 8 in EXIF and
/// TIFF: 1 is upright.
///
/// Telephones and scanners store what the sensor gives, and say here how it was held.
///
/// Source: TIFF revision 6.0 (1992), section 8; Exif 2.32 (2019), section 4.6.5.
///
/// ```
/// # use plotter_vector::picture::Orientation;
/// let on_its_side = Orientation::of_number(6).unwrap();
/// assert!(on_its_side.swaps_sides());
/// assert_eq!(on_its_side.to_string(), "turned to the right by 90 degrees");
/// assert_eq!(Orientation::of_number(9), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Orientation(u8);

impl Default for Orientation {
    fn default() -> Self {
        Self::UPRIGHT
    }
}

impl Orientation {
    /// Stored as it is seen.
    pub const UPRIGHT: Self = Self(1);

    /// The orientation of that number; none but 1 to 8 mean one.
    #[must_use]
    pub fn of_number(number: u32) -> Option<Self> {
        u8::try_from(number).ok().filter(|number| (1..=8).contains(number)).map(Self)
    }

    /// Number in EXIF, 1 to 8.
    #[must_use]
    pub const fn number(self) -> u8 {
        self.0
    }

    /// Whether nothing is to be done.
    #[must_use]
    pub const fn is_upright(self) -> bool {
        self.0 == 1
    }

    /// Whether columns become rows.
    #[must_use]
    pub const fn swaps_sides(self) -> bool {
        self.0 > 4
    }

    /// The pixel of the stored picture that is seen at `at` of the upright one; `last` is the stored
    /// picture's last column and row.
    const fn stored(self, at: Pixel, last: Pixel) -> Pixel {
        let (left, up) = (last.x.saturating_sub(at.x), last.y.saturating_sub(at.y));
        let (from_right, from_below) = (last.x.saturating_sub(at.y), last.y.saturating_sub(at.x));
        match self.0 {
            2 => Pixel::new(left, at.y),
            3 => Pixel::new(left, up),
            4 => Pixel::new(at.x, up),
            5 => Pixel::new(at.y, at.x),
            6 => Pixel::new(at.y, from_below),
            7 => Pixel::new(from_right, from_below),
            8 => Pixel::new(from_right, at.x),
            _ => at,
        }
    }

    /// Width and height, exchanged where columns become rows.
    pub(crate) const fn turned_size(self, (width, height): (u32, u32)) -> (u32, u32) {
        if self.swaps_sides() { (height, width) } else { (width, height) }
    }

    /// The pixels of a stored picture, row by row, as they are seen upright.
    pub(crate) fn turned<T: Copy>(self, pixels: Vec<T>, size: (u32, u32)) -> Vec<T> {
        if self.is_upright() || pixels.is_empty() {
            return pixels;
        }
        let (width, height) = self.turned_size(size);
        let last = Pixel::new(size.0.saturating_sub(1), size.1.saturating_sub(1));
        let mut turned = Vec::with_capacity(pixels.len());
        for y in 0..height {
            turned.extend((0..width).filter_map(|x| {
                let from = self.stored(Pixel::new(x, y), last);
                pixels.get(from.y as usize * size.0 as usize + from.x as usize)
            }));
        }
        turned
    }

    /// The same of a picture of bits.
    pub(crate) fn turned_bits(self, picture: &Bitmap) -> Bitmap {
        let size = (picture.width(), picture.height());
        let (width, height) = self.turned_size(size);
        let last = Pixel::new(size.0.saturating_sub(1), size.1.saturating_sub(1));
        // The size is that of a picture, with its sides exchanged at most.
        let mut turned = Bitmap::new(width, height).unwrap_or_else(|_| Bitmap::empty());
        for y in 0..turned.height() {
            for (x, word) in (0..).step_by(64).zip(turned.row_mut(y)) {
                for bit in 0..64.min(width - x) {
                    let ink = picture.get(self.stored(Pixel::new(x + bit, y), last));
                    *word |= u64::from(ink) << bit;
                }
            }
        }
        turned
    }
}

impl fmt::Display for Orientation {
    /// What is done to see it upright.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.0 {
            2 => "mirrored left to right",
            3 => "turned by 180 degrees",
            4 => "mirrored top to bottom",
            5 => "mirrored and turned to the left by 90 degrees",
            6 => "turned to the right by 90 degrees",
            7 => "mirrored and turned to the right by 90 degrees",
            8 => "turned to the left by 90 degrees",
            _ => "as it is stored",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is stored where the letter F, upright `###`, `#..`, `##.`, `#..`, is seen: the picture of the
    /// specification.
    const STORED: [(u32, &str); 8] = [
        (1, "###\n#..\n##.\n#..\n"),
        (2, "###\n..#\n.##\n..#\n"),
        (3, "..#\n.##\n..#\n###\n"),
        (4, "#..\n##.\n#..\n###\n"),
        (5, "####\n#.#.\n#...\n"),
        (6, "#...\n#.#.\n####\n"),
        (7, "...#\n.#.#\n####\n"),
        (8, "####\n.#.#\n...#\n"),
    ];

    #[test]
    fn each_orientation_makes_the_letter_upright() {
        for (number, stored) in STORED {
            let orientation = Orientation::of_number(number).unwrap();
            let bits = Bitmap::from_picture(stored).unwrap();
            assert_eq!(orientation.turned_bits(&bits).to_string(), STORED[0].1, "{number}");
            let levels: Vec<char> = stored.chars().filter(|mark| *mark != '\n').collect();
            let turned: String = orientation.turned(levels, (bits.width(), bits.height())).iter().collect();
            assert_eq!(turned, STORED[0].1.replace('\n', ""), "{number}");
        }
    }

    #[test]
    fn bits_are_turned_across_words() {
        let mut wide = Bitmap::new(130, 2).unwrap();
        wide.set(Pixel::new(129, 1), true);
        let turned = Orientation(6).turned_bits(&wide);
        assert_eq!((turned.width(), turned.height(), turned.count()), (2, 130, 1));
        assert!(turned.get(Pixel::new(0, 129)));
        assert_eq!(Orientation(8).turned_bits(&turned), wide);
    }
}
