//! [`OrderedTracking`]: from ink pixels to figures, the published way.
//!
//! ```text
//!   scan ──►  . . . # # # .        8 neighbours of the centre o:
//!             . # # . . . .            5 6 7
//!             # . . . . . .            4 o 0      (numbers are directions)
//!                                      3 2 1
//! ```
//!
//! Rows are scanned from the top, each from left to right. The first ink pixel met becomes the centre; the
//! walk steps from centre to a neighbour, records each pixel in the order visited and erases it. A walk of
//! fewer than `min_run` pixels is undone and left for a second scan from right to left: above, the first scan
//! meets the line in its middle, while the second one meets it at its end. What is short again is a small
//! figure and kept. At last the recorded walks are grouped: a jump between consecutive pixels starts a new
//! figure.
//!
//! Where the publication is silent this is decided: the *direction of travel* is the displacement over the
//! last [`HISTORY`] steps; the walk takes the neighbour that turns least from it, of two equal ones the first
//! in the order of the numbers above. The first step of a walk takes the first in that order, in the second
//! scan mirrored (4, 3, 2, 1, 0, 7, 6, 5).
//!
//! Source: Öcal's thesis on a two-axis gantry, section 3.1.

use crate::picture::{Bitmap, Figures, Pixel};
use core::fmt;

/// Steps over which the direction of travel is taken: enough to tell a gentle slope from a level line, few
/// enough to have forgotten the last corner.
const HISTORY: usize = 4;

/// Neighbours in the order of the numbers in the module's sketch: clockwise on the screen, from the right.
const STEPS: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Order of the first step of a walk in the scan from right to left.
const MIRRORED: [(i32, i32); 8] = [(-1, 0), (-1, 1), (0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1)];

/// Settings of the published tracking.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct OrderedTracking {
    /// A walk of fewer pixels is undone and left for the scan from the opposite side, px.
    pub min_run: usize,
    /// Most figures that are recorded.
    pub max_figures: usize,
}

impl OrderedTracking {
    /// The same with another [`OrderedTracking::min_run`].
    #[must_use]
    pub const fn with_min_run(self, min_run: usize) -> Self {
        Self { min_run, ..self }
    }

    /// The same with another [`OrderedTracking::max_figures`].
    #[must_use]
    pub const fn with_max_figures(self, max_figures: usize) -> Self {
        Self { max_figures, ..self }
    }
}

impl Default for OrderedTracking {
    /// 10 px as published; 5 million figures, where a pen that lifts five times a second draws for twelve
    /// days.
    fn default() -> Self {
        Self { min_run: 10, max_figures: 5_000_000 }
    }
}

/// The picture has more figures than allowed: it is noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyFigures {
    /// The limit.
    pub limit: usize,
    /// Where the first figure too many begins.
    pub at: Pixel,
}

impl fmt::Display for TooManyFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { limit, at } = self;
        write!(
            f,
            "more than {limit} figures (the next is at pixel {}, {}): the picture is noise; set the threshold \
             level by hand, clean the scan, or raise the limit",
            at.x, at.y
        )
    }
}

impl core::error::Error for TooManyFigures {}

impl OrderedTracking {
    /// Follows all ink. Every ink pixel is in exactly one figure, once; the same picture always gives the
    /// same figures. Each pixel is visited at most twice and asks its eight neighbours: the time is linear.
    ///
    /// # Errors
    /// [`TooManyFigures`] above `max_figures`.
    ///
    /// ```
    /// # use plotter_vector::{Bitmap, Pixel, raster::OrderedTracking};
    /// let ring = Bitmap::from_picture("###\n#.#\n###\n")?;
    /// let figures = OrderedTracking::default().track(&ring)?;
    /// assert_eq!(figures.len(), 1);
    /// assert_eq!(figures.get(0).len(), 8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn track(&self, ink: &Bitmap) -> Result<Figures, TooManyFigures> {
        let mut figures = Figures::default();
        let mut left = ink.clone();
        let mut undone = Bitmap::new(ink.width(), ink.height()).unwrap_or(Bitmap::empty());
        let mut walk = Vec::new();
        for y in 0..ink.height() {
            for word in 0..ink.row(y).len() {
                while let Some(x) = first_bit(&left, word, y) {
                    follow(&mut left, Pixel::new(x, y), &STEPS, &mut walk);
                    if walk.len() < self.min_run {
                        walk.iter().for_each(|pixel| undone.set(*pixel, true));
                    } else {
                        self.record(&mut figures, &walk)?;
                    }
                }
            }
        }
        for y in 0..ink.height() {
            for word in (0..ink.row(y).len()).rev() {
                while let Some(x) = last_bit(&undone, word, y) {
                    follow(&mut undone, Pixel::new(x, y), &MIRRORED, &mut walk);
                    self.record(&mut figures, &walk)?;
                }
            }
        }
        Ok(figures)
    }

    /// Groups: a walk that begins beside the last recorded pixel goes on with its figure.
    fn record(&self, figures: &mut Figures, walk: &[Pixel]) -> Result<(), TooManyFigures> {
        let Some(start) = walk.first() else { return Ok(()) };
        if figures.last_pixel().is_some_and(|last| last.touches(*start)) {
            figures.extend_last(walk);
        } else if figures.len() < self.max_figures {
            figures.push(walk.iter().copied());
        } else {
            return Err(TooManyFigures { limit: self.max_figures, at: *start });
        }
        Ok(())
    }
}

/// Column of the leftmost ink pixel in a word of a row.
fn first_bit(ink: &Bitmap, word: usize, y: u32) -> Option<u32> {
    let bits = ink.row(y).get(word).copied().filter(|bits| *bits != 0)?;
    Some(u32::try_from(word).ok()? * 64 + bits.trailing_zeros())
}

/// Column of the rightmost ink pixel in a word of a row.
fn last_bit(ink: &Bitmap, word: usize, y: u32) -> Option<u32> {
    let bits = ink.row(y).get(word).copied().filter(|bits| *bits != 0)?;
    Some(u32::try_from(word).ok()? * 64 + 63 - bits.leading_zeros())
}

/// Walks from `start` as far as there is ink, erasing it; the pixels visited replace what `walk` held.
fn follow(ink: &mut Bitmap, start: Pixel, first: &[(i32, i32); 8], walk: &mut Vec<Pixel>) {
    walk.clear();
    ink.set(start, false);
    walk.push(start);
    let mut centre = start;
    while let Some(next) = next_pixel(ink, centre, walk, first) {
        ink.set(next, false);
        walk.push(next);
        centre = next;
    }
}

/// The neighbour that turns least from the direction of travel.
fn next_pixel(ink: &Bitmap, centre: Pixel, walk: &[Pixel], first: &[(i32, i32); 8]) -> Option<Pixel> {
    let past = walk.get(walk.len().saturating_sub(HISTORY + 1)).copied().unwrap_or(centre);
    let travel = centre - past;
    let order = if past == centre { first } else { &STEPS };
    let mut best: Option<(f64, Pixel)> = None;
    for step in order {
        let Some((x, y)) = centre.x.checked_add_signed(step.0).zip(centre.y.checked_add_signed(step.1))
        else {
            continue;
        };
        let neighbour = Pixel::new(x, y);
        if !ink.get(neighbour) {
            continue;
        }
        // The component of the unit step along the travel falls with the angle turned.
        let length = if step.0 == 0 || step.1 == 0 { 1.0 } else { core::f64::consts::SQRT_2 };
        let along = (f64::from(step.0) * travel.x + f64::from(step.1) * travel.y) / length;
        if best.is_none_or(|(most, _)| along > most) {
            best = Some((along, neighbour));
        }
    }
    best.map(|(_, neighbour)| neighbour)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(picture: &str) -> Vec<String> {
        let ink = Bitmap::from_picture(picture).unwrap();
        let figures = OrderedTracking { min_run: 4, ..OrderedTracking::default() }.track(&ink).unwrap();
        let name = |pixel: &Pixel| format!("{}{}", pixel.x, pixel.y);
        figures.iter().map(|figure| figure.iter().map(name).collect::<Vec<_>>().join(" ")).collect()
    }

    #[test]
    fn a_slope_met_in_its_middle_is_left_for_the_opposite_scan() {
        // The first scan meets 30 and goes right: 3 px. Undone; from the right the line is met at its end.
        assert_eq!(track("...###\n.##...\n#.....\n"), ["50 40 30 21 11 02"]);
    }

    #[test]
    fn a_walk_of_just_enough_pixels_is_kept_as_met() {
        assert_eq!(track("...####\n.##....\n#......\n"), ["30 40 50 60", "21 11 02"]);
    }

    #[test]
    fn the_opposite_scan_steps_to_the_left_first() {
        assert_eq!(track(".#.\n#.#\n"), ["10 01", "21"]);
    }

    #[test]
    fn the_direction_of_travel_remembers_four_steps() {
        // Three steps down alone would find both ways equal, and take the one to the right.
        assert_eq!(track("..#\n.#.\n.#.\n.#.\n.#.\n#.#\n"), ["20 11 12 13 14 05", "25"]);
    }

    #[test]
    fn a_small_figure_is_recorded_whole_after_the_large_ones() {
        assert_eq!(track("##....\n......\n.#####\n"), ["12 22 32 42 52", "10 00"]);
    }

    #[test]
    fn a_crossing_is_passed_straight_on() {
        let figures = track("..#..\n..#..\n#####\n..#..\n..#..\n");
        assert_eq!(figures, ["20 21 22 23 24", "42 32", "12 02"]);
    }

    #[test]
    fn a_rectangle_is_one_figure_and_turns_at_its_corners() {
        assert_eq!(track("####\n#..#\n####\n"), ["00 10 20 30 31 32 22 12 02 01"]);
    }

    #[test]
    fn noise_is_refused_by_the_number_of_figures() {
        let dots = Bitmap::from_picture("#.#.#\n").unwrap();
        let error =
            OrderedTracking { max_figures: 2, ..OrderedTracking::default() }.track(&dots).unwrap_err();
        assert_eq!(error, TooManyFigures { limit: 2, at: Pixel::new(0, 0) });
        assert!(error.to_string().starts_with("more than 2 figures (the next is at pixel 0, 0)"));
    }
}
