//! [`Lettering`]: which strokes are letters, and in which order they are read.
//!
//! ```text
//!   bent strokes near each     the direction in which        what lies in a line's band,
//!   other, of like size        most bottoms are aligned      letter by letter
//!     ┌─┐ ┌─┐ ┌─┐              R 5 0 ────────► u            ┌─┬─┬───┬─┬─┬─┐
//!     │R│·│5│·│0│              ─ ─ ─ bottoms                │A│1│ - │2│0│…│   one line
//!     └─┘ └─┘ └─┘              │ v                          └─┴─┴───┴─┴─┴─┘
//! ```

mod direction;
mod mark;
mod row;

use crate::disjoint_sets::DisjointSets;
use crate::order::plan::{Stroke, strokes_of};
use crate::order::point_tree::PointTree;
use crate::stroke::Drawing;
use crate::stroke::curve::CHORD_ERROR_PX;
use direction::{direction, median};
use mark::{LIKE_SIZE, Mark, Placed};
use row::Row;

/// Parts of the letters' height: how exactly bottoms and tops are aligned; how far a letter may reach out of
/// its line (the tail of a `g`), and a straight stroke that belongs to one; the space between the lines of a
/// block.
const ALIGNED: f64 = 0.1;
const TAIL: f64 = 0.35;
const STRAIGHT_TAIL: f64 = 0.15;
const LINE_SPACE: f64 = 1.0;

/// Widest letter, and the greatest median width of a line's letters, in heights: arrowheads are wider.
const WIDEST: f64 = 2.0;
const WIDE: f64 = 1.25;

/// Limits for drawings with very many small strokes in few places: neighbours of a stroke that are looked at,
/// blocks that may still go on.
const NEAR: usize = 24;
const OPEN_BLOCKS: usize = 32;

/// Finds lettering among strokes, in any direction.
///
/// A line of lettering is a row of at least two *bent* strokes of like height on a common base line, with
/// gaps up to `max_gap_heights`, and of the smaller and the straight strokes in its band (the bar of an A, a
/// full stop). Rows of straight strokes alone are hatching or dashes. The direction is the one in which most
/// bottoms are aligned; it is read from the left or, if vertical, from below, as ISO 3098 and ISO 129 letter
/// drawings. Lines less than their height apart, one below the other, are a block.
///
/// What the letters *say* is not found. Of the crates that recognize text, `ocrs` (pure Rust) needs models
/// that are fetched apart, `rusto-rs` runs its models on a C++ engine, `tesseract-rs` builds a C++ engine and
/// fetches its data while it is built; `ocr` 0.1.0, pure Rust with its templates inside, knows one bitmap
/// font of 5 × 7 dots, and `outis-core` embeds a model, for captchas. None reads a drawing's lettering with
/// what a package brings along: it stays strokes, and HPGL gets no `LB`.
///
/// ```
/// use plotter_vector::{Drawing, PxPoint, order::Lettering};
/// // 7 L 7, 12 px high, and a line below it.
/// let mut drawing = Drawing::new(100, 100);
/// for (x, glyph) in [(34.0, "L"), (10.0, "7"), (22.0, "7 again")] {
///     let shape = if glyph == "L" { [(0, 0), (0, 12), (8, 12)] } else { [(0, 0), (8, 0), (3, 12)] };
///     drawing.push(shape.map(|(dx, y)| PxPoint::new(x + f64::from(dx), 20.0 + f64::from(y))));
/// }
/// drawing.push([PxPoint::new(0.0, 40.0), PxPoint::new(90.0, 40.0)]);
/// let blocks = Lettering::default().find(&drawing);
/// assert_eq!(blocks.len(), 1);
/// assert_eq!(blocks[0].lines[0].letters, [[1], [2], [0]]);
/// assert_eq!((blocks[0].lines[0].height_px, blocks[0].lines[0].angle_rad), (12.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct Lettering {
    /// Height of the smallest letters, px.
    pub min_height_px: f64,
    /// Height of the largest letters, px.
    pub max_height_px: f64,
    /// Widest space between neighbours of one line, in letter heights.
    pub max_gap_heights: f64,
}

impl Lettering {
    /// The same with another [`Lettering::min_height_px`].
    #[must_use]
    pub const fn with_min_height_px(self, min_height_px: f64) -> Self {
        Self { min_height_px, ..self }
    }

    /// The same with another [`Lettering::max_height_px`].
    #[must_use]
    pub const fn with_max_height_px(self, max_height_px: f64) -> Self {
        Self { max_height_px, ..self }
    }

    /// The same with another [`Lettering::max_gap_heights`].
    #[must_use]
    pub const fn with_max_gap_heights(self, max_gap_heights: f64) -> Self {
        Self { max_gap_heights, ..self }
    }
}

impl Default for Lettering {
    /// 6 to 100 px (letters of 2.5 mm to 8 mm at 300 dots per inch), gaps up to one and a half heights:
    /// a space between words.
    fn default() -> Self {
        Self { min_height_px: 6.0, max_height_px: 100.0, max_gap_heights: 1.5 }
    }
}

/// Letters in a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextLine {
    /// The strokes (their numbers in the drawing) of each letter, in reading order.
    pub letters: Vec<Vec<usize>>,
    /// Direction of reading: 0 to the right, −π/2 up the picture, positive clockwise; −π/2 ≤ angle < π/2.
    pub angle_rad: f64,
    /// Median height of its bent strokes, px.
    pub height_px: f64,
}

/// Lines of lettering one below the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextBlock {
    /// The lines in reading order.
    pub lines: Vec<TextLine>,
}

impl TextBlock {
    /// The strokes of each letter in reading order, line by line.
    pub fn letters(&self) -> impl Iterator<Item = &[usize]> {
        self.lines.iter().flat_map(|line| &line.letters).map(Vec::as_slice)
    }
}

impl Lettering {
    /// The blocks of lettering, in the order of their first strokes. A stroke belongs to one block at most.
    #[must_use]
    pub fn find(&self, drawing: &Drawing) -> Vec<TextBlock> {
        self.find_in(&strokes_of(&drawing.chords(CHORD_ERROR_PX)))
    }

    /// The blocks of strokes that have no arcs.
    pub(crate) fn find_in(&self, strokes: &[Stroke<'_>]) -> Vec<TextBlock> {
        let marks: Vec<Mark<'_>> =
            strokes.iter().enumerate().filter_map(|(index, stroke)| Mark::new(index, stroke)).collect();
        // A letter is at most as wide as it is high, so across a box it is 1.5 times as long in any
        // direction.
        let small: Vec<&Mark<'_>> =
            marks.iter().filter(|mark| mark.size() <= 1.5 * self.max_height_px).collect();
        let (bent, straight): (Vec<&Mark<'_>>, Vec<&Mark<'_>>) =
            small.into_iter().partition(|mark| mark.bent && mark.size() >= self.min_height_px);
        let mut rows: Vec<Row<'_>> =
            self.groups(&bent).into_iter().flat_map(|group| self.rows(&group)).collect();
        self.add_straight(&mut rows, &straight);
        let rows = self.join_rows(rows);
        let lines: Vec<Row<'_>> = rows.into_iter().flat_map(|row| self.split_at_gaps(row)).collect();
        blocks(lines)
    }

    /// Bent strokes that are linked by nearness, likeness and pen.
    fn groups<'a>(&self, bent: &[&'a Mark<'a>]) -> Vec<Vec<&'a Mark<'a>>> {
        let place = |mark: u32| bent.get(mark as usize).map(|mark| mark.middle()).unwrap_or_default();
        let tree = PointTree::new(bent.len(), &place);
        let mut together = DisjointSets::new(bent.len());
        for (index, mark) in bent.iter().enumerate() {
            let reach = mark.size() * (1.0 + self.max_gap_heights) * LIKE_SIZE;
            let mut looked = 0;
            tree.visit(mark.middle(), reach * reach, &place, &mut |other, _| {
                let other = other as usize;
                looked += 1;
                if bent.get(other).is_some_and(|other| mark.is_neighbour(other, self.max_gap_heights)) {
                    together.join(index, other);
                }
                if looked < NEAR { reach * reach } else { -1.0 }
            });
        }
        let mut rooted: Vec<(usize, &Mark<'_>)> =
            bent.iter().enumerate().map(|(index, mark)| (together.root(index), *mark)).collect();
        rooted.sort_by_key(|(root, mark)| (*root, mark.stroke));
        rooted
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|group| group.len() > 1)
            .map(|group| group.iter().map(|(_, mark)| *mark).collect())
            .collect()
    }

    /// The rows of a group, read in the direction in which most of its bottoms are aligned.
    fn rows<'a>(&self, group: &[&'a Mark<'a>]) -> Vec<Row<'a>> {
        let angle = direction(group);
        let mut letters: Vec<Placed<'_>> = group.iter().map(|mark| Placed::new(mark, angle)).collect();
        letters.sort_by(|a, b| (a.top + a.bottom).total_cmp(&(b.top + b.bottom)));
        let mut rows: Vec<Vec<Placed<'_>>> = Vec::new();
        let mut reach = (0.0, 0.0);
        for letter in letters {
            let common = letter.bottom.min(reach.1) - letter.top.max(reach.0);
            match rows.last_mut() {
                Some(row) if 2.0 * common >= (letter.bottom - letter.top).min(reach.1 - reach.0) => {
                    reach = (letter.top.min(reach.0), letter.bottom.max(reach.1));
                    row.push(letter);
                }
                _ => {
                    reach = (letter.top, letter.bottom);
                    rows.push(vec![letter]);
                }
            }
        }
        rows.into_iter().filter_map(|row| self.row(row, angle)).collect()
    }

    /// The row without what reaches out of its band; `None` when it is none.
    fn row<'a>(&self, letters: Vec<Placed<'a>>, angle: f64) -> Option<Row<'a>> {
        let top = median(letters.iter().map(|letter| letter.top))?;
        let bottom = median(letters.iter().map(|letter| letter.bottom))?;
        let mut row = Row { angle, top, bottom, letters: Vec::new() };
        let height = row.height();
        row.letters = letters.into_iter().filter(|letter| row.holds(letter, TAIL)).collect();
        // Two that fill the band; of less it is not known what line they are on.
        let full = |letter: &&Placed<'_>| {
            (letter.top - top).abs() <= 2.0 * ALIGNED * height
                && (letter.bottom - bottom).abs() <= 2.0 * ALIGNED * height
        };
        let width = median(row.letters.iter().map(|letter| letter.right - letter.left))?;
        let is_row = width <= WIDE * height
            && (self.min_height_px..=self.max_height_px).contains(&height)
            && row.letters.iter().filter(full).count() > 1;
        is_row.then_some(row)
    }

    /// Adds the straight and the small strokes to the rows in whose bands they lie.
    fn add_straight<'a>(&self, rows: &mut [Row<'a>], straight: &[&'a Mark<'a>]) {
        let near: Vec<(usize, Placed<'a>)> = rows
            .iter()
            .enumerate()
            .flat_map(|(row, line)| line.letters.iter().map(move |letter| (row, *letter)))
            .collect();
        let place = |letter: u32| {
            near.get(letter as usize).map(|(_, letter)| letter.mark.middle()).unwrap_or_default()
        };
        let tree = PointTree::new(near.len(), &place);
        for mark in straight {
            let reach = self.max_height_px * (1.0 + self.max_gap_heights);
            let mut found = None;
            let mut looked = 0;
            tree.visit(mark.middle(), reach * reach, &place, &mut |other, squared| {
                looked += 1;
                if let Some((row, letter)) = near.get(other as usize) {
                    let fits = rows.get(*row).is_some_and(|line| {
                        let placed = Placed::new(mark, line.angle);
                        mark.pen == letter.mark.pen
                            && line.holds(&placed, STRAIGHT_TAIL)
                            && placed.gap(letter) <= self.max_gap_heights * line.height()
                    });
                    if fits {
                        found = Some(*row);
                        return squared;
                    }
                }
                if looked < NEAR { reach * reach } else { -1.0 }
            });
            if let Some(row) = found.and_then(|row| rows.get_mut(row)) {
                row.letters.push(Placed::new(mark, row.angle));
            }
        }
    }

    /// Rows that go on in each other: parts of one line between which straight letters stand.
    fn join_rows<'a>(&self, rows: Vec<Row<'a>>) -> Vec<Row<'a>> {
        let letters: Vec<(usize, Placed<'a>)> = rows
            .iter()
            .enumerate()
            .flat_map(|(row, line)| line.letters.iter().map(move |letter| (row, *letter)))
            .collect();
        let place = |letter: u32| {
            letters.get(letter as usize).map(|(_, letter)| letter.mark.middle()).unwrap_or_default()
        };
        let tree = PointTree::new(letters.len(), &place);
        let mut together = DisjointSets::new(rows.len());
        for (row, letter) in &letters {
            let Some(line) = rows.get(*row) else { continue };
            let reach = line.height() * (2.0 * WIDEST + self.max_gap_heights);
            let mut looked = 0;
            tree.visit(letter.mark.middle(), reach * reach, &place, &mut |other, _| {
                looked += 1;
                if let Some((other_row, other)) = letters.get(other as usize).filter(|other| other.0 != *row)
                {
                    let goes_on = rows.get(*other_row).is_some_and(|other_line| {
                        let near = Placed::new(other.mark, line.angle).gap(letter);
                        near <= self.max_gap_heights * line.height() && line.goes_on(other_line, other)
                    });
                    if goes_on {
                        // The earlier row keeps its direction.
                        together.join((*row).max(*other_row), (*row).min(*other_row));
                    }
                }
                if looked < NEAR { reach * reach } else { -1.0 }
            });
        }
        let mut joined: Vec<Row<'a>> = rows.iter().map(|row| Row { letters: Vec::new(), ..*row }).collect();
        for (row, letter) in letters {
            if let Some(line) = joined.get_mut(together.root(row)) {
                line.letters.push(Placed::new(letter.mark, line.angle));
            }
        }
        joined
    }

    /// The row from left to right, cut where the space is too wide; parts with fewer than two bent strokes
    /// are none.
    fn split_at_gaps<'a>(&self, mut row: Row<'a>) -> Vec<Row<'a>> {
        row.letters.sort_by(|a, b| a.left.total_cmp(&b.left).then(a.mark.stroke.cmp(&b.mark.stroke)));
        let widest = self.max_gap_heights * row.height();
        let mut parts: Vec<Row<'a>> = Vec::new();
        let mut right = f64::NEG_INFINITY;
        for letter in core::mem::take(&mut row.letters) {
            if letter.left - right > widest {
                parts.push(Row { letters: Vec::new(), ..row });
            }
            right = right.max(letter.right);
            if let Some(part) = parts.last_mut() {
                part.letters.push(letter);
            }
        }
        let bent = |part: &Row<'_>| part.letters.iter().filter(|letter| letter.mark.bent).count();
        parts.retain(|part| bent(part) > 1 && part.letters_apart().len() > 1);
        parts
    }
}

/// Lines that lie below each other, closer than their height, as blocks.
fn blocks(mut lines: Vec<Row<'_>>) -> Vec<TextBlock> {
    lines.sort_by(|a, b| {
        a.angle.total_cmp(&b.angle).then(a.top.total_cmp(&b.top)).then(a.left().total_cmp(&b.left()))
    });
    let mut blocks: Vec<Vec<Row<'_>>> = Vec::new();
    for line in lines {
        let follows = |block: &&mut Vec<Row<'_>>| {
            block.last().is_some_and(|above| {
                let space = line.top - above.bottom;
                above.angle == line.angle
                    && above.pen() == line.pen()
                    && space >= -TAIL * line.height()
                    && space <= LINE_SPACE * line.height().min(above.height())
                    && line.left() <= above.right()
                    && above.left() <= line.right()
            })
        };
        match blocks.iter_mut().rev().take(OPEN_BLOCKS).find(follows) {
            Some(block) => block.push(line),
            None => blocks.push(vec![line]),
        }
    }
    let text = |row: &Row<'_>| TextLine {
        letters: row.letters_apart(),
        angle_rad: row.angle,
        height_px: row.height(),
    };
    let mut found: Vec<TextBlock> =
        blocks.iter().map(|block| TextBlock { lines: block.iter().map(text).collect() }).collect();
    found.sort_by_key(|block| block.letters().flatten().copied().min());
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stroke::PxPoint;

    /// Strokes of a letter 4 wide and 6 high, y down; `-` and `.` and `/` are straight.
    fn glyph(letter: char) -> Vec<Vec<(f64, f64)>> {
        let strokes: &[&[(u8, u8)]] = match letter {
            'A' => &[&[(0, 6), (2, 0), (4, 6)], &[(1, 4), (3, 4)]],
            'C' => &[&[(4, 0), (0, 0), (0, 6), (4, 6)]],
            'L' => &[&[(0, 0), (0, 6), (4, 6)]],
            'X' => &[&[(0, 0), (4, 6)], &[(4, 0), (0, 6)]],
            'O' => &[&[(0, 0), (4, 0), (4, 6), (0, 6), (0, 0)]],
            'g' => &[&[(4, 6), (0, 6), (0, 2), (4, 2), (4, 8), (0, 8)]],
            '-' => &[&[(1, 3), (3, 3)]],
            '.' => &[&[(2, 6)]],
            '/' => &[&[(0, 6), (4, 0)]],
            _ => &[],
        };
        strokes
            .iter()
            .map(|stroke| stroke.iter().map(|(x, y)| (f64::from(*x), f64::from(*y))).collect())
            .collect()
    }

    /// Writes letters 12 px high with a pitch of 12 px, turned about their lower left.
    fn write(drawing: &mut Drawing, text: &str, at: (f64, f64), angle: f64) {
        for (letter, column) in text.chars().zip(0_u32..) {
            for stroke in glyph(letter) {
                drawing.push(stroke.iter().map(|(x, y)| {
                    let (along, across) = (2.0 * x + 12.0 * f64::from(column), 2.0 * y - 12.0);
                    let (cos, sin) = (libm::cos(angle), libm::sin(angle));
                    PxPoint::new(at.0 + along * cos - across * sin, at.1 + along * sin + across * cos)
                }));
            }
        }
    }

    fn found(drawing: &Drawing) -> Vec<Vec<Vec<Vec<usize>>>> {
        let letters = |block: &TextBlock| block.lines.iter().map(|line| line.letters.clone()).collect();
        Lettering::default().find(drawing).iter().map(letters).collect()
    }

    #[test]
    fn letters_are_read_in_any_direction() {
        for degrees in [0.0, 10.0, 30.0, 60.0, 85.0, -20.0, -45.0, -75.0, -90.0_f64] {
            let angle = degrees.to_radians();
            let mut drawing = Drawing::new(300, 300);
            write(&mut drawing, "AL-XO.C", (150.0, 150.0), angle);
            let blocks = Lettering::default().find(&drawing);
            assert_eq!(
                found(&drawing),
                [[[vec![0, 1], vec![2], vec![3], vec![4, 5], vec![6], vec![7], vec![8]]]],
                "{degrees}"
            );
            assert!((blocks[0].lines[0].angle_rad - angle).abs() < 0.02, "{degrees}");
            assert!((blocks[0].lines[0].height_px - 12.0).abs() < 1.0, "{degrees}");
        }
    }

    #[test]
    fn slanted_letters_are_read_from_the_left_whichever_was_drawn_first() {
        for degrees in [10.0, 30.0, 60.0, -20.0, -45.0, -75.0_f64] {
            let mut forth = Drawing::new(300, 300);
            write(&mut forth, "LOCL", (150.0, 150.0), degrees.to_radians());
            let mut back = Drawing::new(300, 300);
            (0..4).rev().for_each(|stroke| back.push(forth.stroke(stroke).iter().copied()));
            assert_eq!(found(&back), [[[[3], [2], [1], [0]]]], "{degrees}");
        }
    }

    #[test]
    fn letters_of_two_pens_are_two_blocks() {
        let mut one = Drawing::new(300, 300);
        write(&mut one, "LOCO", (50.0, 100.0), 0.0);
        let mut drawing = Drawing::new(300, 300);
        for (stroke, pen) in one.strokes().zip([1, 2, 1, 2]) {
            drawing.push_with_pen(pen, stroke.iter().copied());
        }
        assert_eq!(found(&drawing), [[[[0], [2]]], [[[1], [3]]]]);
    }

    #[test]
    fn words_of_one_row_far_apart_are_two_lines() {
        // A long word below is near to both: all three are one group.
        let mut drawing = Drawing::new(300, 300);
        write(&mut drawing, "LO    CL", (50.0, 100.0), 0.0);
        write(&mut drawing, "OLOCLOCL", (50.0, 120.0), 0.0);
        let lines: Vec<usize> = found(&drawing).iter().flatten().map(Vec::len).collect();
        assert_eq!(lines.iter().filter(|letters| **letters == 2).count(), 2, "{lines:?}");
    }

    #[test]
    fn a_row_of_wide_shapes_is_no_lettering() {
        let mut drawing = Drawing::new(300, 300);
        for x in [20.0, 55.0, 90.0, 125.0] {
            drawing.push([(x, 100.0), (x + 20.0, 100.0), (x + 20.0, 112.0)].map(|(x, y)| PxPoint::new(x, y)));
        }
        assert_eq!(Lettering::default().find(&drawing), []);
    }

    #[test]
    fn only_letters_of_the_heights_that_are_asked_for_are_found() {
        let mut drawing = Drawing::new(300, 300);
        write(&mut drawing, "LOCO", (50.0, 100.0), 0.0);
        let with = |min_height_px, max_height_px| {
            Lettering { min_height_px, max_height_px, ..Lettering::default() }.find(&drawing).len()
        };
        assert_eq!((with(6.0, 100.0), with(13.0, 100.0), with(2.0, 11.0)), (1, 0, 0));
    }

    #[test]
    fn lines_below_each_other_are_a_block_read_line_by_line() {
        let mut drawing = Drawing::new(300, 300);
        write(&mut drawing, "CC", (50.0, 120.0), 0.0);
        write(&mut drawing, "OLO", (50.0, 100.0), 0.0);
        write(&mut drawing, "LL", (50.0, 150.0), 0.0);
        // The third line is farther down than a line is high.
        assert_eq!(
            found(&drawing),
            [vec![vec![vec![2], vec![3], vec![4]], vec![vec![0], vec![1]]], vec![vec![vec![5], vec![6]]]]
        );
    }

    #[test]
    fn tails_and_spaces_do_not_end_a_line() {
        let mut drawing = Drawing::new(300, 300);
        write(&mut drawing, "OgC Lg", (50.0, 100.0), 0.0);
        assert_eq!(found(&drawing), [[[[0], [1], [2], [3], [4]]]]);
    }

    #[test]
    fn hatching_dashes_arrows_and_large_shapes_are_no_lettering() {
        let mut drawing = Drawing::new(900, 900);
        write(&mut drawing, "//////", (50.0, 100.0), 0.0);
        write(&mut drawing, "------", (50.0, 200.0), 0.0);
        for x in [300.0, 340.0] {
            drawing.push([(x + 18.0, 300.0), (x, 306.0), (x + 18.0, 312.0)].map(|(x, y)| PxPoint::new(x, y)));
        }
        for x in [100.0, 300.0, 500.0] {
            drawing.push([(x, 500.0), (x, 700.0), (x + 150.0, 700.0)].map(|(x, y)| PxPoint::new(x, y)));
        }
        assert_eq!(Lettering::default().find(&drawing), []);
    }

    #[test]
    fn very_many_bent_strokes_in_one_place_are_looked_at_in_bounded_time() {
        let mut drawing = Drawing::new(9, 9);
        for k in 0..20_000_u32 {
            let x = f64::from(k % 7);
            drawing.push([(x, 0.0), (x + 5.0, 9.0), (x, 9.0)].map(|(x, y)| PxPoint::new(x, y)));
        }
        // Whatever they are taken for: no stroke is read twice.
        let mut read: Vec<usize> = Lettering::default()
            .find(&drawing)
            .iter()
            .flat_map(TextBlock::letters)
            .flatten()
            .copied()
            .collect();
        let count = read.len();
        read.sort_unstable();
        read.dedup();
        assert_eq!(read.len(), count);
    }
}
