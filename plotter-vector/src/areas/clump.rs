//! [`Clump`]: a compact piece of wide ink, and the lines that come to it.
//!
//! Ink that is wider than lines may be where several of them meet: then their pens, which go straight on, have
//! drawn all of it. Or it is a mark on lines, as the head of a note or the dot of a joint: lines that come to it
//! from opposite sides go on through it.
//!
//! ```text
//!   ███████████████         ▄██▄
//!   ███████████████      ██████████      left: where bar and stem meet is wider than both, but
//!        █████            ▀████▀         nothing is there that they have not drawn;
//!        █████                           right: a mark, and a line that goes through it
//! ```

use super::disc::index;
use crate::picture::joined_runs::JoinedRuns;
use crate::picture::runs::set_run;
use crate::picture::{Bitmap, Pixel};
use crate::stroke::{PxPoint, PxVec};
use core::ops::Range;

/// Steps from a clump at which its lines are told apart: nearer there are what an opening leaves of its rim.
const FIRST_STEP: usize = 2;

/// Fewest steps in which a line shows where it leads, and that it is as wide all along.
const FEWEST_STEPS: usize = 4;

/// Most times, and pixels more, that a line's front is as wide in one place as in another: one pixel for each
/// of its edges, and a quarter, for a step is not quite as far in all directions. A rest of an area gets
/// wider or narrower by more.
const STEADY_TIMES: f64 = 1.25;
const STEADY_PX: f64 = 2.0;

/// A piece of a line's front that is a smaller part of it than one in so many is a ragged edge, and the line
/// does not part there.
const RAGGED: usize = 4;

/// A line's pen covers so much beside half its width, px: half a pixel for the raster, and a quarter for its
/// width, which is a mean over a few steps.
const RASTER_PX: f64 = 0.75;

/// Part of a clump that the pens of its lines need not explain, for blur rounds the corners between them. Of
/// the dot of a joint, as small as is looked at, two lines leave a ninth bare, and of larger ones more.
const UNEXPLAINED: f64 = 0.08;

/// Least cosine of the angle between two lines that are one: 15 degrees, for of a thin line the eight pixels
/// by which it is told may lie a pixel aside at either end.
const THROUGH_COS: f64 = 0.966;

/// One pen makes lines whose widths differ by no more than so many times, and px: a pixel and a half for the
/// raster at both edges, and on wide lines a third for what a pen's pressure does.
const SAME_TIMES: f64 = 1.3;
const SAME_PX: f64 = 1.5;

/// Pixels that hang together, no longer in either direction than asked.
#[derive(Clone, Debug)]
pub(super) struct Clump {
    /// Rows with the columns in them.
    runs: Vec<(u32, Range<u32>)>,
    columns: Range<u32>,
    rows: Range<u32>,
}

/// What comes to a clump.
pub(super) struct Beside {
    /// The width of the widest ink that leads from it for some steps, px; none where it lies alone.
    pub(super) widest_px: Option<usize>,
    /// Those that are lines: straight, and as wide all along.
    pub(super) lines: Vec<LineIn>,
}

/// A line that comes to a clump.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineIn {
    /// The clump's upper left pixel.
    origin: Pixel,
    /// A place on its middle, before the clump, from there.
    root: PxPoint,
    /// The unit vector along it, into the clump.
    heading: PxVec,
    width_px: f64,
}

/// The compact pieces of a picture, up to `most_px` wide and high, in the order of their first rows.
pub(super) fn clumps(picture: &Bitmap, most_px: u32) -> Vec<Clump> {
    let (runs, parts) = JoinedRuns::of(picture).parts();
    let mut found: Vec<Clump> = Vec::with_capacity(parts);
    for (y, run, part) in runs {
        if part == found.len() {
            found.push(Clump { runs: Vec::new(), columns: run.clone(), rows: y..y });
        }
        let Some(clump) = found.get_mut(part) else { continue };
        clump.columns = clump.columns.start.min(run.start)..clump.columns.end.max(run.end);
        clump.rows.end = y + 1;
        // Of a large area not even the runs are kept.
        if clump.is_within(most_px) {
            clump.runs.push((y, run));
        } else {
            clump.runs = Vec::new();
        }
    }
    found.retain(|clump| clump.is_within(most_px));
    found
}

impl Clump {
    /// Whether it is no wider and no higher than this.
    fn is_within(&self, most_px: u32) -> bool {
        self.columns.end - self.columns.start <= most_px && self.rows.end - self.rows.start <= most_px
    }

    /// The upper left pixel of the box around it: places are told from there, so that they are rounded alike
    /// in every band.
    const fn origin(&self) -> Pixel {
        Pixel::new(self.columns.start, self.rows.start)
    }

    /// Makes its pixels ink or paper.
    pub(super) fn set(&self, picture: &mut Bitmap, ink: bool) {
        self.runs.iter().for_each(|(y, run)| set_run(picture.row_mut(*y), run.clone(), ink));
    }

    /// Its pixels.
    fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        self.runs.iter().flat_map(|(y, run)| run.clone().map(|x| Pixel::new(x, *y)))
    }

    /// What the ink within `reach` steps shows of what comes to it.
    pub(super) fn beside(&self, ink: &Bitmap, reach: u32) -> Beside {
        let mut fronts = Fronts::around(self, ink, reach);
        (0..reach).for_each(|step| fronts.step(step));
        let long = fronts.lines.iter().filter(|front| front.steps.len() >= FEWEST_STEPS);
        Beside {
            widest_px: long.map(Front::width_px).max(),
            lines: fronts.lines.iter().filter_map(|front| front.line(fronts.origin)).collect(),
        }
    }

    /// Whether the pens of its lines, which go straight on, have drawn it.
    pub(super) fn is_drawn_by(&self, lines: &[LineIn]) -> bool {
        let (mut all, mut bare) = (0.0, 0.0);
        for at in self.pixels() {
            all += 1.0;
            if !lines.iter().any(|line| line.covers(at)) {
                bare += 1.0;
            }
        }
        bare <= UNEXPLAINED * all
    }
}

impl LineIn {
    /// Whether its pen, which goes straight on, covers a pixel's middle.
    fn covers(&self, at: Pixel) -> bool {
        let at = from_origin(at, self.origin);
        let way = at - self.root;
        way.dot(self.heading) >= -1.0 && self.off_px(at) <= 0.5 * self.width_px + RASTER_PX
    }

    /// How far a place lies beside it, px.
    fn off_px(&self, at: PxPoint) -> f64 {
        (at - self.root).dot(self.heading.perpendicular()).abs()
    }

    /// How straight another line goes on from it through the ink between them, 0 to 1; none if it does not.
    fn straight_on(&self, other: &Self, ink: &Bitmap) -> Option<f64> {
        let (thin_px, wide_px) = (self.width_px.min(other.width_px), self.width_px.max(other.width_px));
        let cos = -self.heading.dot(other.heading);
        let off_px = self.off_px(other.root).max(other.off_px(self.root));
        let is_one = cos >= THROUGH_COS
            && off_px <= (0.5 * thin_px).max(1.0)
            && wide_px <= (SAME_TIMES * thin_px).max(thin_px + SAME_PX)
            && (other.root - self.root).dot(self.heading) > 0.0
            && self.is_ink_to(other.root, ink);
        is_one.then_some(cos)
    }

    /// Whether all places on the straight way to another lie in ink.
    fn is_ink_to(&self, to: PxPoint, ink: &Bitmap) -> bool {
        let way = to - self.root;
        let steps = libm::ceil(2.0 * way.length()).max(1.0);
        let mut step = 0.0;
        while step <= steps {
            let at = self.root + way * (step / steps);
            if !pixel_at(at, self.origin).is_some_and(|at| ink.get(at)) {
                return false;
            }
            step += 1.0;
        }
        true
    }
}

/// The middle of a pixel as seen from an origin.
fn from_origin(at: Pixel, origin: Pixel) -> PxPoint {
    PxPoint::new(0.5, 0.5) + (at - origin)
}

/// The pixel in which a place lies that is seen from an origin; none left of the picture or above it.
fn pixel_at(at: PxPoint, origin: Pixel) -> Option<Pixel> {
    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    let (x, y) = (libm::floor(at.x) as i32, libm::floor(at.y) as i32);
    Some(Pixel::new(origin.x.checked_add_signed(x)?, origin.y.checked_add_signed(y)?))
}

/// Which of the lines go on in each other.
pub(super) fn through(lines: &[LineIn], ink: &Bitmap) -> Vec<[LineIn; 2]> {
    let mut pairs = Vec::new();
    for (i, one) in lines.iter().enumerate() {
        for (j, other) in lines.iter().enumerate().skip(i + 1) {
            if let Some(cos) = one.straight_on(other, ink) {
                pairs.push((cos, i, j));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut used = vec![false; lines.len()];
    let mut found = Vec::new();
    for (_, i, j) in pairs {
        let (Some(one), Some(other)) = (lines.get(i), lines.get(j)) else { continue };
        if [i, j].iter().all(|index| used.get(*index) == Some(&false)) {
            [i, j]
                .iter()
                .for_each(|index| used.iter_mut().skip(*index).take(1).for_each(|used| *used = true));
            found.push([*one, *other]);
        }
    }
    found
}

/// Draws the line that two are one of, between them, where there is ink.
pub(super) fn draw_between([one, other]: [&LineIn; 2], ink: &Bitmap, picture: &mut Bitmap) {
    let half_px = 0.25 * (one.width_px + other.width_px);
    let (from, way) = (one.root, other.root - one.root);
    let squared = way.length_squared().max(f64::MIN_POSITIVE);
    let least = PxPoint::new(from.x.min(other.root.x) - half_px, from.y.min(other.root.y) - half_px);
    let most = PxPoint::new(from.x.max(other.root.x) + half_px, from.y.max(other.root.y) + half_px);
    let first = pixel_at(least, one.origin).unwrap_or_default();
    let Some(last) = pixel_at(most, one.origin) else { return };
    for (x, y) in (first.y..=last.y).flat_map(|y| (first.x..=last.x).map(move |x| (x, y))) {
        let at = Pixel::new(x, y);
        let to = from_origin(at, one.origin) - from;
        let part = to.dot(way) / squared;
        if (0.0..=1.0).contains(&part) && (to - way * part).length() <= half_px && ink.get(at) {
            picture.set(at, true);
        }
    }
}

/// What a pixel around a clump is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cell {
    Paper,
    /// Ink that no step has reached.
    Ink,
    /// Reached in the last step, or before; and by which line.
    Reached(Option<u16>),
    /// Reached in this step.
    New,
}

/// A line while it is followed away from a clump.
#[derive(Clone, Debug)]
struct Front {
    /// Of each step the middle of what it reached, and how many pixels these are.
    steps: Vec<(PxPoint, usize)>,
    /// Whether it meets others, or parts.
    ended: bool,
}

/// The ink around a clump, step by step away from it.
struct Fronts {
    /// The clump's upper left pixel, and from there that of the cells.
    origin: Pixel,
    corner: PxVec,
    width: usize,
    cells: Vec<Cell>,
    last: Vec<usize>,
    lines: Vec<Front>,
}

impl Fronts {
    fn around(clump: &Clump, ink: &Bitmap, reach: u32) -> Self {
        let (left, top) = (clump.columns.start.saturating_sub(reach), clump.rows.start.saturating_sub(reach));
        let right = clump.columns.end.saturating_add(reach).min(ink.width());
        let bottom = clump.rows.end.saturating_add(reach).min(ink.height());
        let width = (right - left) as usize;
        let mut cells = Vec::with_capacity(width * (bottom - top) as usize);
        for y in top..bottom {
            let cell = |x| if ink.get(Pixel::new(x, y)) { Cell::Ink } else { Cell::Paper };
            cells.extend((left..right).map(cell));
        }
        let origin = clump.origin();
        let corner = Pixel::new(left, top) - origin;
        let mut fronts = Self { origin, corner, width, cells, last: Vec::new(), lines: Vec::new() };
        for at in clump.pixels() {
            let index = (at.y - top) as usize * width + (at.x - left) as usize;
            if let Some(cell) = fronts.cells.get_mut(index) {
                *cell = Cell::Reached(None);
                fronts.last.push(index);
            }
        }
        fronts
    }

    /// The cells around one: beside, above and below it, then those across its corners.
    fn around_of(&self, index: usize) -> [Option<usize>; 8] {
        let (x, width) = (index % self.width.max(1), self.width);
        let left = |index: Option<usize>| index.filter(|_| x > 0).map(|index| index - 1);
        let right = |index: Option<usize>| index.filter(|_| x + 1 < width).map(|index| index + 1);
        let (above, below) =
            (index.checked_sub(width), Some(index + width).filter(|i| *i < self.cells.len()));
        let own = Some(index);
        [left(own), right(own), above, below, left(above), right(above), left(below), right(below)]
    }

    fn cell(&self, index: usize) -> Cell {
        self.cells.get(index).copied().unwrap_or(Cell::Paper)
    }

    fn set(&mut self, index: usize, to: Cell) {
        self.cells.iter_mut().skip(index).take(1).for_each(|cell| *cell = to);
    }

    /// One step: by turns without and with those across corners, which is nearly as far in all directions.
    fn step(&mut self, step: u32) {
        let beside = if step.is_multiple_of(2) { 4 } else { 8 };
        let mut new = Vec::new();
        for index in core::mem::take(&mut self.last) {
            for next in self.around_of(index).into_iter().take(beside).flatten() {
                if self.cell(next) == Cell::Ink {
                    self.set(next, Cell::New);
                    new.push(next);
                }
            }
        }
        let groups = self.groups(&new);
        if (step as usize) < FIRST_STEP {
            new.iter().for_each(|index| self.set(*index, Cell::Reached(None)));
        } else {
            self.follow(step as usize == FIRST_STEP, &groups);
        }
        self.last = new;
    }

    /// The new cells that hang together, and the lines that they go on from.
    fn groups(&mut self, new: &[usize]) -> Vec<(Vec<usize>, Vec<u16>)> {
        let mut groups = Vec::new();
        for start in new {
            if self.cell(*start) != Cell::New {
                continue;
            }
            self.set(*start, Cell::Reached(None));
            let (mut group, mut from) = (vec![*start], Vec::new());
            let mut next = 0;
            while let Some(index) = group.get(next).copied() {
                next += 1;
                for beside in self.around_of(index).into_iter().flatten() {
                    match self.cell(beside) {
                        Cell::New => {
                            self.set(beside, Cell::Reached(None));
                            group.push(beside);
                        }
                        Cell::Reached(Some(line)) if !from.contains(&line) => from.push(line),
                        _ => {}
                    }
                }
            }
            groups.push((group, from));
        }
        groups
    }

    /// Lets lines go on in the groups of new cells; all of these begin one in the first step.
    fn follow(&mut self, is_first: bool, groups: &[(Vec<usize>, Vec<u16>)]) {
        let mut went_on: Vec<Vec<usize>> = vec![Vec::new(); self.lines.len()];
        for (number, (group, from)) in groups.iter().enumerate() {
            if is_first {
                self.lines.push(Front { steps: vec![self.middle(group)], ended: false });
                self.name(group, self.lines.len() - 1);
            } else if let [line] = from.as_slice() {
                went_on.iter_mut().skip(usize::from(*line)).take(1).for_each(|on| on.push(number));
            } else {
                // Lines that meet end.
                for line in from {
                    self.lines.iter_mut().skip(usize::from(*line)).take(1).for_each(|line| line.ended = true);
                }
            }
        }
        for (line, on) in went_on.iter().enumerate() {
            let size = |number: &usize| groups.get(*number).map_or(0, |(group, _)| group.len());
            let all: usize = on.iter().map(size).sum();
            let parts: Vec<usize> = on.iter().copied().filter(|part| RAGGED * size(part) >= all).collect();
            let group = match parts.as_slice() {
                [part] => groups.get(*part).map(|(group, _)| group),
                _ => None,
            };
            let step = group.map(|group| self.middle(group));
            let Some(front) = self.lines.get_mut(line).filter(|front| !front.ended) else { continue };
            match (step, group) {
                (Some(step), Some(group)) => {
                    front.steps.push(step);
                    self.name(group, line);
                }
                _ => front.ended = true,
            }
        }
    }

    fn name(&mut self, group: &[usize], line: usize) {
        let line = u16::try_from(line).ok();
        group.iter().for_each(|index| self.set(*index, Cell::Reached(line)));
    }

    fn middle(&self, group: &[usize]) -> (PxPoint, usize) {
        let (mut x, mut y) = (0, 0);
        for index in group {
            x += index % self.width.max(1);
            y += index / self.width.max(1);
        }
        #[expect(clippy::cast_precision_loss, reason = "sums over a few thousand pixels")]
        let (x, y, count) = (x as f64, y as f64, group.len().max(1) as f64);
        (PxPoint::new(x / count + 0.5, y / count + 0.5) + self.corner, group.len())
    }
}

/// How many pixels each two steps in a row reach: of a slanted line every other step reaches twice as many.
fn in_pairs(steps: &[(PxPoint, usize)]) -> Vec<usize> {
    steps.windows(2).map(|pair| pair.iter().map(|(_, count)| count).sum()).collect()
}

/// Whether a line is as wide in most places as in others.
fn is_steady(steps: &[(PxPoint, usize)]) -> bool {
    let mut counts = in_pairs(steps);
    counts.sort_unstable();
    // One in eight at either side may be where something ends or joins.
    let rest = counts.len() / 8;
    let at = |rank: usize| counts.get(rank).map(|count| f64::from(index(*count)));
    match (at(rest), at(counts.len().saturating_sub(1 + rest))) {
        (Some(least), Some(most)) => most <= STEADY_TIMES * least + 2.0 * STEADY_PX,
        _ => false,
    }
}

impl Front {
    /// Its width in most places, px.
    fn width_px(&self) -> usize {
        let mut counts = in_pairs(&self.steps);
        let middle = counts.len() / 2;
        if counts.is_empty() { 0 } else { counts.select_nth_unstable(middle).1.div_ceil(2) }
    }

    /// The line, from where the clump's own form shows no more; none of a stub.
    fn line(&self, origin: Pixel) -> Option<LineIn> {
        let width = self.width_px();
        // Half a width from the clump the front lies across the line; two widths tell its direction.
        let first = width / 2 + 1;
        let steps = self.steps.iter().skip(first).take((2 * width).max(2 * FEWEST_STEPS));
        let steps: Vec<(PxPoint, usize)> = steps.copied().collect();
        if steps.len() < FEWEST_STEPS.max(width / 2) || !is_steady(&steps) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a few hundred steps")]
        let count = steps.len() as f64;
        let mut mean = PxVec::new(0.0, 0.0);
        steps.iter().for_each(|(at, _)| mean += (*at - PxPoint::default()) / count);
        let (mut along, mut squares, mut pixels) = (PxVec::new(0.0, 0.0), 0.0, 0.0);
        let mut from_middle = 0.5 - 0.5 * count;
        for (at, size) in &steps {
            along += (*at - PxPoint::default()) * from_middle;
            squares += from_middle * from_middle;
            #[expect(clippy::cast_precision_loss, reason = "a few hundred pixels")]
            let size = *size as f64;
            pixels += size;
            from_middle += 1.0;
        }
        let step = along / squares;
        let step_px = step.length();
        (step_px > 0.0).then(|| LineIn {
            origin,
            root: PxPoint::default() + mean - step * (0.5 * count - 0.5),
            heading: step * (-1.0 / step_px),
            width_px: pixels / (count * step_px),
        })
    }
}
