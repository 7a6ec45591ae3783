//! [`Opening`]: what tells areas from lines, and from where lines meet.

use super::WidthSplit;
use super::clump::{Beside, LineIn, clumps, draw_between, through};
use super::disc::{Disc, empty_like};
use super::inset::pen_radius_px;
use super::split::{MAX_LINE_PX, absorbed_px};
use crate::picture::Bitmap;

/// What tells areas from lines: a disc that fits into areas only.
#[derive(Clone, Debug)]
pub(crate) struct Opening {
    disc: Disc,
    /// Longest leftover that an area keeps, px.
    absorbed_px: u32,
    /// What is wider is an area, px; of lines, a pixel for the raster on each side.
    widest_line_px: f64,
    /// Of ink in which lines meet, and marks lie on them.
    marks: Option<Marks>,
}

/// What tells marks on lines from the lines.
#[derive(Clone, Debug)]
struct Marks {
    /// Fits into marks, and where lines meet.
    disc: Disc,
    /// Longest leftover that a mark keeps, px.
    absorbed_px: u32,
}

/// A mark on lines is wider than so many of their pens, and px: what is narrower a pen makes that stays or
/// turns.
const MARK_PENS: u32 = 3;
const LEAST_MARK_PX: u32 = 8;

impl Marks {
    /// Makes areas of the marks on lines.
    fn take(&self, ink: &Bitmap, split: &mut WidthSplit, lines_through: &mut Vec<[LineIn; 2]>) {
        let mut found = false;
        for clump in clumps(&self.disc.opened(&split.thin), self.disc.most_px()) {
            let Beside { widest_px, lines } = clump.beside(&split.thin, self.disc.followed_px());
            // A dot by itself is as wide as its pen, and what comes to a mark is narrower than it.
            let is_mark = widest_px.is_some_and(|widest_px| 2 * widest_px <= self.disc.side_px());
            if is_mark && !clump.is_drawn_by(&lines) {
                clump.set(&mut split.thick, true);
                clump.set(&mut split.thin, false);
                lines_through.extend(through(&lines, ink));
                found = true;
            }
        }
        if found {
            split.give_leftovers_to_areas(self.absorbed_px);
        }
    }
}

impl Opening {
    /// Areas are wider than lines of `max_line_px`, as [`split_by_width`] says.
    pub(crate) fn of_lines(max_line_px: u32) -> Self {
        let line = max_line_px.min(MAX_LINE_PX);
        Self {
            disc: Disc::wider_than_lines(line),
            absorbed_px: absorbed_px(line),
            widest_line_px: f64::from(line) + 2.0,
            marks: None,
        }
    }

    /// The same, but where lines meet is no area, and compact marks on lines of a pen are.
    pub(crate) fn of_drawing(max_line_px: u32, pen_px: u32) -> Self {
        let line = MARK_PENS.saturating_mul(pen_px).max(LEAST_MARK_PX).min(max_line_px).min(MAX_LINE_PX);
        let marks = Marks { disc: Disc::wider_than_lines(line), absorbed_px: absorbed_px(line) };
        Self { marks: Some(marks), ..Self::of_lines(max_line_px) }
    }

    /// Areas are what [`inset_outlines`](crate::areas::inset_outlines()) goes around with half of `pen_px`,
    /// with leftovers up to half a side of the disc; what it leaves out is lines.
    pub(crate) fn of_pen(pen_px: f64) -> Self {
        let disc = Disc::of_radius(pen_radius_px(pen_px / 2.0).unwrap_or(0.0));
        let absorbed_px = disc.half();
        Self { disc, absorbed_px, widest_line_px: pen_px, marks: None }
    }

    /// What is wider is an area, px.
    pub(crate) fn widest_line_px(&self) -> f64 {
        self.widest_line_px
    }

    /// Rows above and below a band that decide about its own.
    pub(crate) fn rows_of_context(&self) -> u32 {
        let around = |disc: &Disc| disc.most_px().saturating_add(disc.followed_px());
        let of_marks = self.marks.as_ref().map_or(0, |marks| {
            around(&self.disc) + 4 * self.disc.reach() + around(&marks.disc) + 4 * marks.absorbed_px
        });
        self.disc.reach() + 4 * self.absorbed_px + of_marks
    }

    /// Splits a picture where it lies: the lines, and the areas if there are any.
    pub(crate) fn split(&self, ink: Bitmap) -> (Bitmap, Option<Bitmap>) {
        let smallest = self.marks.as_ref().map_or(&self.disc, |marks| &marks.disc);
        if !smallest.fits(&ink) {
            return (ink, None);
        }
        let mut thick = self.disc.opened(&ink);
        let mut lines_through = Vec::new();
        if self.marks.is_some() {
            self.leave_out_meetings(&ink, &mut thick, &mut lines_through);
        }
        let thin = ink.clone().without(&thick);
        let mut split = WidthSplit { thick, thin };
        if let Some(marks) = &self.marks {
            // Where an area gets narrow it is still one, but for the lines that leave it.
            let wide = marks.disc.opened(&split.thin);
            let mut narrow = WidthSplit { thin: wide, thick: split.thick };
            narrow.give_leftovers_to_areas(self.disc.reach());
            split.thin = split.thin.without(&narrow.thick);
            split.thick = narrow.thick;
        }
        split.give_leftovers_to_areas(self.absorbed_px);
        if let Some(marks) = &self.marks {
            marks.take(&ink, &mut split, &mut lines_through);
        }
        for [one, other] in lines_through {
            draw_between([&one, &other], &ink, &mut split.thin);
        }
        (split.thin, Some(split.thick))
    }

    /// Makes lines again of what their pens have drawn where they meet; of the other compact areas the lines
    /// that go through.
    fn leave_out_meetings(&self, ink: &Bitmap, thick: &mut Bitmap, lines_through: &mut Vec<[LineIn; 2]>) {
        for clump in clumps(thick, self.disc.most_px()) {
            let lines = clump.beside(ink, self.disc.followed_px()).lines;
            if clump.is_drawn_by(&lines) {
                clump.set(thick, false);
            } else {
                lines_through.extend(through(&lines, ink));
            }
        }
    }

    /// As [`Opening::split`], of a picture that is kept.
    pub(crate) fn split_of(&self, ink: &Bitmap) -> WidthSplit {
        let (thin, thick) = self.split(ink.clone());
        WidthSplit { thick: thick.unwrap_or_else(|| empty_like(ink)), thin }
    }

    /// Ink without the insides of its areas, which are the pixels of areas with ink all around them: what
    /// strokes have to come near.
    pub(crate) fn without_insides(&self, ink: Bitmap) -> Bitmap {
        let WidthSplit { thick, .. } = self.split_of(&ink);
        let mut kept = ink.clone();
        for y in (0..ink.height()).filter(|y| thick.row(*y).iter().any(|bits| *bits != 0)) {
            let row = |y: Option<u32>| y.filter(|y| *y < ink.height()).map_or(&[][..], |y| ink.row(y));
            let rows = [row(y.checked_sub(1)), row(Some(y)), row(y.checked_add(1))];
            // Words without ink where the picture ends.
            let word = |index: Option<usize>| {
                let of = |row: &[u64]| index.and_then(|index| row.get(index)).copied().unwrap_or(0);
                rows.into_iter().fold(u64::MAX, |all, row| all & of(row))
            };
            for (index, (kept, thick)) in kept.row_mut(y).iter_mut().zip(thick.row(y)).enumerate() {
                if *thick != 0 {
                    let (left, own, right) =
                        (word(index.checked_sub(1)), word(Some(index)), word(index.checked_add(1)));
                    let within = own & (own << 1 | left >> 63) & (own >> 1 | right << 63);
                    *kept &= !(thick & within);
                }
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;
    use proptest::prelude::*;

    #[test]
    fn the_insides_of_areas_have_ink_all_around_them() {
        // Across the end of a word; the area's edge where a line runs into it counts, too.
        let rows = |row: &str| format!("{}{row}\n", ".".repeat(58));
        let text: String =
            [".........", ".######..", ".########", ".######..", ".######..", ".........", "#########"]
                .map(rows)
                .concat();
        let ink = Bitmap::from_picture(&text).unwrap();
        let left: String =
            [".........", ".######..", ".#....###", ".#....#..", ".######..", ".........", "#########"]
                .map(rows)
                .concat();
        assert_eq!(Opening::of_lines(2).without_insides(ink).to_string(), left);
    }

    /// A picture of lines from place to place, so wide, and of discs.
    fn picture(width: u32, height: u32, is_ink: impl Fn(f64, f64) -> bool) -> Bitmap {
        let mut ink = Bitmap::new(width, height).unwrap();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            ink.set(Pixel::new(x, y), is_ink(f64::from(x) + 0.5, f64::from(y) + 0.5));
        }
        ink
    }

    #[test]
    fn where_wide_lines_meet_is_no_area() {
        // A T of lines of 16 px: a disc of 20 px fits where they meet.
        let bar = |x: f64, y: f64| (20.0..220.0).contains(&x) && (40.0..56.0).contains(&y);
        let stem = |x: f64, y: f64| (112.0..128.0).contains(&x) && (40.0..180.0).contains(&y);
        let ink = picture(240, 200, |x, y| bar(x, y) || stem(x, y));
        assert!(Opening::of_lines(18).split_of(&ink).thick.count() > 250);
        assert_eq!(Opening::of_drawing(18, 3).split_of(&ink).thick.count(), 0);
        // As large a square at the end of a thin line is one.
        let square = |x: f64, y: f64| (110.0..134.0).contains(&x) && (40.0..64.0).contains(&y);
        let ink = picture(240, 200, |x, y| square(x, y) || (120.0..123.0).contains(&x) && y > 50.0);
        assert!(Opening::of_drawing(18, 3).split_of(&ink).thick.count() >= 24 * 24);
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn where_wide_lines_meet_is_no_area_in_whatever_direction_they_run() {
        // A T, a cross and a Y of lines of 16 px, of whose ends none is near.
        let meetings: [&[f64]; 3] = [&[0.0, 180.0, 90.0], &[0.0, 180.0, 90.0, 270.0], &[0.0, 120.0, 240.0]];
        for (arms, turn) in meetings.iter().flat_map(|arms| (0..24).map(move |turn| (arms, turn))) {
            let turn_deg = 3.75 * f64::from(turn);
            let is_ink = |x: f64, y: f64| {
                arms.iter().any(|arm| {
                    let (sin, cos) = libm::sincos((arm + turn_deg).to_radians());
                    let (x, y) = (x - 110.3, y - 110.6);
                    let along = x * cos + y * sin;
                    (0.0..=100.0).contains(&along) && (y * cos - x * sin).abs() <= 8.0
                })
            };
            let ink = picture(220, 220, is_ink);
            let areas = Opening::of_drawing(18, 3).split_of(&ink).thick;
            assert_eq!(areas.count(), 0, "{arms:?} turned by {turn_deg}");
        }
    }

    #[test]
    fn a_line_goes_on_through_a_mark_and_one_that_ends_at_it_does_not() {
        let line = |_: f64, y: f64| (y - 40.5).abs() <= 1.5;
        let stem = |x: f64, y: f64| (x - 60.0).abs() <= 1.5 && y < 40.0;
        let mark = |x: f64, y: f64| libm::hypot((x - 60.0) / 9.0, (y - 40.5) / 7.0) <= 1.0;
        let ink = picture(120, 80, |x, y| line(x, y) || stem(x, y) || mark(x, y));
        let WidthSplit { thick, thin } = Opening::of_drawing(18, 3).split_of(&ink);
        let inside = |ink: &Bitmap, y: u32| (53..67).filter(|x| ink.get(Pixel::new(*x, y))).count();
        assert!(thick.count() > 170 && inside(&thick, 40) == 14, "{thick}");
        // The line's three rows, and nothing of the stem.
        assert_eq!([38, 39, 40, 41, 42].map(|y| inside(&thin, y)), [0, 14, 14, 14, 0], "{thin}");
        // A dot by itself is no mark on lines.
        let ink = picture(120, 80, |x, y| mark(x, y) || y < 3.0);
        assert_eq!(Opening::of_drawing(18, 3).split_of(&ink).thick.count(), 0);
    }

    #[test]
    fn where_an_area_gets_narrow_it_is_still_one() {
        // Two squares of 40 px, and a neck of 14 px between them; and a line of 14 px that leaves them.
        let squares = |x: f64, y: f64| {
            (20.0..60.0).contains(&y) && ((20.0..60.0).contains(&x) || (80.0..120.0).contains(&x))
        };
        let neck = |x: f64, y: f64| (33.0..47.0).contains(&y) && (50.0..90.0).contains(&x);
        let line = |x: f64, y: f64| (33.0..47.0).contains(&y) && x >= 120.0;
        let ink = picture(300, 80, |x, y| squares(x, y) || neck(x, y) || line(x, y));
        let WidthSplit { thick, thin } = Opening::of_drawing(18, 3).split_of(&ink);
        assert!((60..80).all(|x| (34..46).all(|y| thick.get(Pixel::new(x, y)))), "{thick}");
        assert!((150..300).all(|x| (33..47).all(|y| thin.get(Pixel::new(x, y)))), "{thin}");
    }

    /// Bars and discs on a tall picture.
    fn bars() -> impl Strategy<Value = Bitmap> {
        let bar = (0_u32..80, 0_u32..560, 1_u32..70, 1_u32..70, 0..5_u8);
        proptest::collection::vec(bar, 1..24).prop_map(|bars| {
            let mut ink = Bitmap::new(80, 600).unwrap();
            for (left, top, width, height, kind) in bars {
                // Lines of 3 px along and across, squares, and paper.
                let (width, height) = match kind {
                    0 | 1 => (width, 3),
                    2 | 3 => (3, height),
                    _ => (width.min(30), height.min(30)),
                };
                for y in top..(top + height).min(600) {
                    (left..(left + width).min(80)).for_each(|x| ink.set(Pixel::new(x, y), true));
                }
            }
            ink
        })
    }

    proptest! {
        #[test]
        fn a_band_of_a_drawing_is_split_as_in_the_whole(
            ink in bars(),
            max_line_px in 8_u32..12,
            start in 150_u32..400,
            count in 1_u32..60,
        ) {
            let opening = Opening::of_drawing(max_line_px, 3);
            let context = opening.rows_of_context();
            let whole = opening.split_of(&ink);
            prop_assert!(whole.thick.clone().united(&whole.thin) == ink);
            let end = start + count;
            let (from, to) = (start.saturating_sub(context), (end + context).min(ink.height()));
            let band = opening.split_of(&ink.band(from..to));
            prop_assert_eq!(band.thick.band(start - from..end - from), whole.thick.band(start..end));
            prop_assert_eq!(band.thin.band(start - from..end - from), whole.thin.band(start..end));
        }
    }
}
