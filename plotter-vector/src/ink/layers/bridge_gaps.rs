//! Makes strokes whole that a later pen has crossed.
//!
//! ```text
//!     .....##.....            .....##.....
//!     oooo.##.oooo            oooo.##.oooo
//!     oooooXXooooo   X is     ooooo##ooooo   o between the two ends: they face each other
//!     oooo.##.oooo            oooo.##.oooo
//! ```
//!
//! A pixel of another pen belongs to this one too when a straight line through it runs in the others' ink
//! from one place of this pen's ink to another, and goes on in it at both: so the stroke comes in on one side
//! and leaves on the other in the same direction. It must go on for three widths of the stroke, so that the
//! line lies along it and not across, and for twice the gap: of parallel strokes as far apart as they are
//! wide, a line that leaves one for the next would have to turn aside by two widths, and gets no farther than
//! one and a half.

use crate::picture::{Bitmap, Pixel};

/// Directions in half a turn that are tried, 5.6° apart.
const DIRECTIONS: u16 = 32;
/// Longest gap, in widths of the crossing stroke: one crossed at 15° is 1 / sin 15° = 3.9 widths long.
const GAP_WIDTHS: f64 = 4.0;
/// How far a stroke must go on beyond each end of the gap, in its widths.
const RUN_WIDTHS: f64 = 3.0;
/// The same, in lengths of the gap.
const RUN_GAPS: usize = 2;
/// Widest stroke that is bridged or crossed, px; beyond it the search would be long, and ink is an area.
const WIDEST_PX: f64 = 16.0;

/// The ink of a pen with its gaps under the `others`' ink filled.
pub(super) fn bridge(own: &Bitmap, others: &Bitmap) -> Bitmap {
    let mut whole = own.clone();
    let gap = pixels(GAP_WIDTHS * width_px(others)) + 2;
    let run = pixels(RUN_WIDTHS * width_px(own)).max(3);
    let length = gap + run.max(RUN_GAPS * gap);
    let rays: Vec<[Ray; 2]> = (0..DIRECTIONS).map(|direction| rays(direction, length)).collect();
    let walk = Walk { own, others, gap, run };
    let near = (0..gap).fold(own.clone(), |near, _| grown(&near));
    for at in others.ink().filter(|at| near.get(*at) && !own.get(*at)) {
        if rays.iter().any(|[forth, back]| walk.links(at, forth, back)) {
            whole.set(at, true);
        }
    }
    whole
}

/// Ink grown by so many pixels.
pub(super) fn grown_by(ink: &Bitmap, px: u32) -> Bitmap {
    (0..px).fold(ink.clone(), |ink, _| grown(&ink))
}

/// The ink and the eight neighbours of each of its pixels.
pub(super) fn grown(ink: &Bitmap) -> Bitmap {
    let mut grown = ink.clone();
    let used = u64::MAX >> ((64 - ink.width() % 64) % 64);
    for y in 0..ink.height() {
        let above = y.checked_sub(1).map_or(&[][..], |above| ink.row(above));
        let (here, below) = (ink.row(y), ink.row(y + 1));
        let column = |at: usize| {
            let word = |row: &[u64]| row.get(at).copied().unwrap_or(0);
            word(above) | word(here) | word(below)
        };
        let last = here.len().saturating_sub(1);
        let mut left = 0;
        for (at, bits) in grown.row_mut(y).iter_mut().enumerate() {
            let middle = column(at);
            *bits = middle | middle << 1 | middle >> 1 | left >> 63 | column(at + 1) << 63;
            if at == last {
                *bits &= used;
            }
            left = middle;
        }
    }
    grown
}

/// Steps from a pixel, in px.
type Ray = Vec<(i32, i32)>;

/// The steps in a direction, numbered in half a turn, and in the opposite one.
fn rays(direction: u16, length: usize) -> [Ray; 2] {
    let angle_rad = f64::from(direction) * core::f64::consts::PI / f64::from(DIRECTIONS);
    let (cos, sin) = (libm::cos(angle_rad), libm::sin(angle_rad));
    // One column or row a step, so that no pixel of a thin stroke is jumped over.
    let stretch = 1.0 / cos.abs().max(sin.abs());
    #[expect(clippy::cast_possible_truncation, reason = "at most a few hundred px")]
    let step = |n: u16| {
        let along = f64::from(n) * stretch;
        (libm::round(along * cos) as i32, libm::round(along * sin) as i32)
    };
    let forth: Ray = (1_u16..).take(length).map(step).collect();
    let back = forth.iter().map(|(x, y)| (-x, -y)).collect();
    [forth, back]
}

struct Walk<'a> {
    own: &'a Bitmap,
    others: &'a Bitmap,
    /// Most px of a gap.
    gap: usize,
    /// Least px that the stroke goes on.
    run: usize,
}

impl Walk<'_> {
    /// Whether the stroke comes in along one ray and leaves along the other.
    fn links(&self, at: Pixel, forth: &Ray, back: &Ray) -> bool {
        let Some(there) = self.steps(at, forth, self.gap) else { return false };
        let Some(here) = self.steps(at, back, (self.gap + 1).saturating_sub(there)) else { return false };
        // The pixel itself is in both counts' middle.
        let run = self.run.max(RUN_GAPS * (there + here - 1));
        self.goes_on(at, forth, there, run) && self.goes_on(at, back, here, run)
    }

    /// Number of steps through the others' ink until the first one in the own.
    fn steps(&self, from: Pixel, ray: &Ray, most: usize) -> Option<usize> {
        let mut steps = 0;
        for at in ray.iter().take(most) {
            let at = step(from, *at)?;
            steps += 1;
            if self.own.get(at) {
                return Some(steps);
            }
            if !self.others.get(at) {
                return None;
            }
        }
        None
    }

    /// Whether `run` steps behind `steps` are ink, a quarter of them at most crossed by another pen again.
    fn goes_on(&self, from: Pixel, ray: &Ray, steps: usize, run: usize) -> bool {
        let (mut own, mut crossed) = (0, 0);
        for at in ray.iter().skip(steps - 1).take(run).filter_map(|at| step(from, *at)) {
            if self.own.get(at) {
                own += 1;
            } else if self.others.get(at) {
                crossed += 1;
            }
        }
        own + crossed == run && 4 * crossed <= run
    }
}

fn step(from: Pixel, (x, y): (i32, i32)) -> Option<Pixel> {
    Some(Pixel::new(from.x.checked_add_signed(x)?, from.y.checked_add_signed(y)?))
}

/// Width of the strokes of a picture: the area by half the length of its border; each border pixel's side
/// counts, which is 4/π of the length over all directions.
fn width_px(ink: &Bitmap) -> f64 {
    let (mut area, mut sides) = (0_u64, 0_u64);
    for y in 0..ink.height() {
        let (here, below) = (ink.row(y), ink.row(y + 1));
        let mut last = 0;
        for (at, bits) in here.iter().enumerate() {
            area += u64::from(bits.count_ones());
            sides += u64::from((bits ^ (bits << 1 | last)).count_ones());
            // The upper border of the picture is a side too; the words of the row below say the others.
            sides += if y == 0 { u64::from(bits.count_ones()) } else { 0 };
            sides += u64::from((bits ^ below.get(at).copied().unwrap_or(0)).count_ones());
            last = bits >> 63;
        }
        // The right border of a picture as wide as its words, as the left one.
        sides += last;
    }
    #[expect(clippy::cast_precision_loss, reason = "at most 2³⁰")]
    let width = 2.0 * area as f64 * (4.0 / core::f64::consts::PI) / sides.max(1) as f64;
    width.min(WIDEST_PX)
}

/// A length in whole px, upwards.
fn pixels(length_px: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 64")]
    let whole = libm::ceil(length_px) as usize;
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `o` is the own pen, `x` the other.
    fn bridged(picture: &str) -> String {
        let of = |letter: char| {
            let marks = picture.replace(|mark| mark != letter && mark != '\n', ".").replace(letter, "#");
            Bitmap::from_picture(&marks).unwrap()
        };
        let (own, others) = (of('o'), of('x'));
        let whole = bridge(&own, &others);
        picture
            .lines()
            .zip(0..)
            .map(|(line, y)| {
                let mark = |(mark, x)| {
                    if whole.get(Pixel::new(x, y)) && mark == 'x' { 'B' } else { mark }
                };
                line.chars().zip(0..).map(mark).chain(['\n']).collect::<String>()
            })
            .collect()
    }

    #[test]
    fn a_crossed_stroke_is_made_whole_at_its_width() {
        assert_eq!(
            bridged(
                ".............xx.............\n\
                 .............xx.............\n\
                 oooooooooooooxxooooooooooooo\n\
                 oooooooooooooxxooooooooooooo\n\
                 oooooooooooooxxooooooooooooo\n\
                 .............xx.............\n\
                 .............xx.............\n"
            ),
            ".............xx.............\n\
             .............xx.............\n\
             oooooooooooooBBooooooooooooo\n\
             oooooooooooooBBooooooooooooo\n\
             oooooooooooooBBooooooooooooo\n\
             .............xx.............\n\
             .............xx.............\n"
        );
    }

    #[test]
    fn a_stroke_that_ends_at_another_is_left_as_it_is() {
        let tee = ".......xxx.......\n\
                   oooooooxxx.......\n\
                   oooooooxxx.......\n\
                   .......xxx.......\n";
        assert_eq!(bridged(tee), tee);
    }

    #[test]
    fn parallel_strokes_under_a_crossing_one_are_not_linked() {
        let stripes = "..oo..oo..oo..\n".repeat(9);
        let whole = bridged(&format!("{stripes}{0}\n{0}\n{stripes}", "x".repeat(14)));
        for line in whole.lines().skip(9).take(2) {
            assert_eq!(line, "xxBBxxBBxxBBxx", "{whole}");
        }
    }

    #[test]
    fn grown_ink_touches_its_neighbours_and_stays_in_the_picture() {
        let mut dots = Bitmap::new(66, 3).unwrap();
        dots.set(Pixel::new(63, 0), true);
        dots.set(Pixel::new(65, 2), true);
        let grown = grown(&dots);
        let columns = |y| grown.ink().filter(|at| at.y == y).map(|at| at.x).collect::<Vec<_>>();
        assert_eq!(
            [columns(0), columns(1), columns(2)],
            [vec![62, 63, 64], vec![62, 63, 64, 65], vec![64, 65]]
        );
    }

    #[test]
    fn a_sheet_without_other_ink_stays_as_it_is() {
        let line = "oooooo\n";
        assert_eq!(bridged(line), line);
        assert_eq!(bridged("xx\n"), "xx\n");
    }

    #[test]
    fn ink_at_the_right_border_is_as_wide_as_ink_at_the_left_one() {
        for width in [63_usize, 64, 65, 128] {
            let rest = ".".repeat(width - 3);
            let [left, right] = [format!("###{rest}\n"), format!("{rest}###\n")]
                .map(|row| width_px(&Bitmap::from_picture(&row.repeat(2)).unwrap()));
            assert!((left - right).abs() < 1e-12, "{width}: {left} {right}");
        }
    }

    #[test]
    fn the_width_of_a_stroke_is_found_within_two_fifths() {
        let bar = Bitmap::from_picture(&format!("{0}\n{0}\n{0}\n{0}\n", "#".repeat(60))).unwrap();
        let width = width_px(&bar);
        assert!((4.0..=4.0 * 1.4).contains(&width), "{width}");
    }
}
