//! [`Ink`]: what has been drawn, so that it is found where something is to be drawn again.
//!
//! A line is kept by its direction (one of 128 sectors of half a turn), its length (levels of a factor 4),
//! and a cell of a grid that is turned as the sector is: four times as long as the line at most, and as
//! narrow as the tolerance or the sector's spread allow. So a line is in four cells at most, and what it may
//! lie on is in a few cells of each level. A line of which a part had been drawn is kept as a whole, for all
//! of it is drawn now, and what it covers is forgotten: so a line that is drawn a million times in parts
//! costs no more than in one. Arcs are kept by their circle and sixty-fourths of a turn.

use super::{PathSegment, Shape};
use crate::{Point, Vec2};
use alloc::collections::{BTreeMap, BTreeSet};
use alloc::vec::Vec;
use core::f64::consts::{PI, TAU};
use core::ops::RangeInclusive;

/// Least tolerance, mm: a nanometre, below any motor's step.
const LEAST_TOLERANCE_MM: f64 = 1e-6;

/// Farthest place that is looked at, mm: above, places are rounded by more than a tenth of the least
/// tolerance.
const FARTHEST_MM: f64 = 1e9;

/// Sine of the greatest angle between lines of which one lies on the other. Within a tolerance, a short line
/// may have any direction; a curve made of short lines would be cut wherever it crosses a line.
const STEEPEST: f64 = 0.03;

/// Sectors of half a turn, each 1.4 degrees: a little narrower than the greatest angle, whose sine is
/// [`STEEPEST`].
const SECTORS: i32 = 128;

/// Sectors on each side of its own in which a line may lie on another: the greatest angle ends in the second.
const REACH: i32 = 2;

/// Cells of a turn by which arcs are kept. A finer division makes more cells for each arc, a coarser one more
/// arcs in each cell.
const ARC_CELLS: f64 = 64.0;

/// Rows of cells that are looked at one by one. Where a line crosses more, all of its level between the first
/// and the last are.
const MOST_ROWS: f64 = 256.0;

/// Share of the tolerance that a line may lose when it stands for another: a millionth, for rounding.
const NEARLY: f64 = 1e-6;

/// Shorter lengths count as none, mm: a thousandth of the least tolerance.
pub(super) const NO_LENGTH_MM: f64 = 1e-9;

/// What has been drawn.
pub(super) struct Ink {
    tolerance_mm: f64,
    /// The x axes of the sectors' grids.
    axes: Vec<Vec2>,
    lines: Vec<Drawn>,
    /// By tool, sector, level, row and column.
    line_cells: BTreeMap<(u32, i32, i32, i64, i64), Vec<usize>>,
    /// Sectors and levels in which lines are.
    levels: BTreeSet<(u32, i32, i32)>,
    arcs: Vec<Round>,
    /// By tool, centre and radius, and part of a turn.
    arc_cells: BTreeMap<(u32, [i64; 3], i64), Vec<usize>>,
    /// Curves by their tool, the middle of their ends, and that of their handles.
    curves: BTreeMap<(u32, [i64; 4]), Vec<Curve>>,
    dots: BTreeMap<(u32, [i64; 2]), Vec<Point>>,
}

/// What of a segment had not been drawn.
pub(super) enum Rest {
    /// All of it.
    All,
    /// Nothing.
    None,
    /// Parts of it, each from and to a length along it, mm.
    Parts { length_mm: f64, left: Vec<(f64, f64)> },
}

/// A line within `off_mm` of what has been drawn.
#[derive(Clone, Copy)]
struct Drawn {
    from: Point,
    to: Point,
    off_mm: f64,
    is_forgotten: bool,
}

/// An arc, counter-clockwise, within `off_mm` of what has been drawn.
#[derive(Clone, Copy)]
struct Round {
    centre: Point,
    radius_mm: f64,
    /// From 0 to 2π.
    begin_rad: f64,
    sweep_rad: f64,
    off_mm: f64,
    is_forgotten: bool,
}

/// Four places of a curve, and how far round it goes if it is no cubic.
#[derive(Clone, Copy)]
struct Curve {
    places: [Point; 4],
    turn_rad: f64,
}

/// A part of what is to be drawn that lies within `off_mm` of what has been.
struct Cover {
    low_mm: f64,
    high_mm: f64,
    off_mm: f64,
}

/// What is left of a length, and how far the rest of it is from what has been drawn.
struct Left {
    parts: Vec<(f64, f64)>,
    off_mm: f64,
}

impl Ink {
    pub(super) fn new(tolerance_mm: f64) -> Self {
        let axis = |sector: i32| {
            let angle = (f64::from(sector) + 0.5) * PI / f64::from(SECTORS);
            Vec2::new(libm::cos(angle), libm::sin(angle))
        };
        Self {
            // Of a number and none, `fmax` is the number.
            tolerance_mm: libm::fmax(tolerance_mm, LEAST_TOLERANCE_MM),
            axes: (0..SECTORS).map(axis).collect(),
            lines: Vec::new(),
            line_cells: BTreeMap::new(),
            levels: BTreeSet::new(),
            arcs: Vec::new(),
            arc_cells: BTreeMap::new(),
            curves: BTreeMap::new(),
            dots: BTreeMap::new(),
        }
    }

    pub(super) fn tolerance_mm(&self) -> f64 {
        self.tolerance_mm
    }

    /// Draws a dot, unless there is one.
    pub(super) fn draw_dot(&mut self, tool: u32, at: Point) -> bool {
        if !is_near(at) {
            return true;
        }
        let cell_mm = 2.0 * self.tolerance_mm;
        for x in cells(at.x - self.tolerance_mm, at.x + self.tolerance_mm, cell_mm) {
            for y in cells(at.y - self.tolerance_mm, at.y + self.tolerance_mm, cell_mm) {
                let dots = self.dots.get(&(tool, [x, y]));
                if dots.into_iter().flatten().any(|dot| dot.distance(at) <= self.tolerance_mm) {
                    return false;
                }
            }
        }
        self.dots.entry((tool, [at.x, at.y].map(|place| cell(place, cell_mm)))).or_default().push(at);
        true
    }

    /// Draws what of a segment has not been drawn.
    pub(super) fn draw(&mut self, tool: u32, from: Point, segment: &PathSegment) -> Rest {
        let to = segment.to;
        if !(is_near(from) && is_near(to)) {
            return Rest::All;
        }
        match segment.shape {
            Shape::Line => self.draw_line(tool, from, to),
            Shape::Cubic { handles: [a, b] } => {
                self.draw_curve(tool, Curve { places: [from, a, b, to], turn_rad: 0.0 })
            }
            Shape::Arc { centre, sweep_rad } => {
                let (radius_mm, end_mm) = (from.distance(centre), to.distance(centre));
                // Rounded numbers of files are off by a fraction of the tolerance; a spiral is no part of a
                // circle.
                let is_round = libm::fabs(end_mm - radius_mm) <= 0.25 * self.tolerance_mm;
                if !(is_near(centre) && libm::fabs(sweep_rad) <= TAU) {
                    return Rest::All;
                }
                if !is_round {
                    let [a, b] = [1.0, 2.0].map(|third| segment.at(from, third / 3.0));
                    return self.draw_curve(tool, Curve { places: [from, a, b, to], turn_rad: sweep_rad });
                }
                let first = if sweep_rad < 0.0 { to } else { from } - centre;
                let begin_rad = libm::atan2(first.y, first.x);
                let begin_rad = if begin_rad < 0.0 { begin_rad + TAU } else { begin_rad };
                // It is within `off_mm` of its circle.
                let round = Round {
                    centre,
                    radius_mm,
                    begin_rad,
                    sweep_rad: libm::fabs(sweep_rad),
                    off_mm: libm::fabs(end_mm - radius_mm),
                    is_forgotten: false,
                };
                self.draw_arc(tool, round, sweep_rad < 0.0)
            }
        }
    }

    fn draw_line(&mut self, tool: u32, from: Point, to: Point) -> Rest {
        let length_mm = from.distance(to);
        if length_mm.is_nan() || length_mm <= NO_LENGTH_MM {
            return Rest::All;
        }
        let line = Drawn { from, to, off_mm: 0.0, is_forgotten: false };
        let (mut covers, within) = self.lines_under(tool, &line, length_mm);
        let left = left_of(&mut covers, length_mm, self.tolerance_mm);
        if left.parts.is_empty() {
            return Rest::None;
        }
        let tolerance_mm = self.tolerance_mm;
        for (index, off_mm) in within {
            if let Some(under) = self.lines.get_mut(index) {
                under.is_forgotten |= left.off_mm + off_mm <= under.off_mm + NEARLY * tolerance_mm;
            }
        }
        self.keep_line(tool, Drawn { off_mm: left.off_mm, ..line }, length_mm);
        let is_whole = left.parts.iter().any(|&(low, high)| low <= 0.0 && high >= length_mm);
        if left.off_mm > NEARLY * tolerance_mm {
            // What is new of it is exact.
            for &(low, high) in &left.parts {
                let part = Drawn {
                    from: from.lerp(to, low / length_mm),
                    to: from.lerp(to, high / length_mm),
                    ..line
                };
                self.keep_line(tool, part, high - low);
            }
        }
        if is_whole { Rest::All } else { Rest::Parts { length_mm, left: left.parts } }
    }

    fn keep_line(&mut self, tool: u32, line: Drawn, length_mm: f64) {
        let index = self.lines.len();
        self.lines.push(line);
        let (sector, level) = (sector_of(line.to - line.from), level_of(length_mm));
        let Some(&axis) = usize::try_from(sector).ok().and_then(|sector| self.axes.get(sector)) else {
            return;
        };
        self.levels.insert((tool, sector, level));
        let (column_mm, row_mm) = self.cell_size_mm(level);
        let [a, b] = [line.from, line.to].map(|at| turned(at, axis));
        for row in cells(a.y, b.y, row_mm) {
            for column in cells(a.x, b.x, column_mm) {
                self.line_cells.entry((tool, sector, level, row, column)).or_default().push(index);
            }
        }
    }

    /// Length and height of the cells of a level, mm.
    fn cell_size_mm(&self, level: i32) -> (f64, f64) {
        let longest_mm = libm::ldexp(1.0, 2 * level + 2);
        (longest_mm, libm::fmax(2.0 * self.tolerance_mm, 0.5 * PI / f64::from(SECTORS) * longest_mm))
    }

    /// What of a line lies on lines that have been drawn, and those of them that lie on it as a whole, with
    /// their distance.
    fn lines_under(&mut self, tool: u32, line: &Drawn, length_mm: f64) -> (Vec<Cover>, Vec<(usize, f64)>) {
        let (mut covers, mut within) = (Vec::new(), Vec::new());
        let sector = sector_of(line.to - line.from);
        let angle = angle_of(line.to - line.from);
        let width = PI / f64::from(SECTORS);
        let mut levels: Vec<(i32, i32)> = Vec::new();
        for step in -REACH..=REACH {
            let near = (sector + step).rem_euclid(SECTORS);
            // From the end of this sector, so much is between it and the line.
            let apart = libm::fabs(f64::from(sector + step) + 0.5 - angle / width) * width - 0.5 * width;
            let here = self.levels.range((tool, near, i32::MIN)..=(tool, near, i32::MAX));
            levels.extend(here.filter_map(|&(_, sector, level)| {
                let shorter_mm = libm::fmin(length_mm, libm::ldexp(1.0, 2 * level));
                (apart <= libm::fmin(STEEPEST, 2.0 * self.tolerance_mm / shorter_mm) + 1e-9)
                    .then_some((level, sector))
            }));
        }
        levels.sort_unstable_by(|a, b| b.cmp(a));
        let mut level_before = None;
        for (level, sector) in levels {
            // Long lines first: one of them may cover it, where short ones are many.
            if level_before.replace(level).is_some_and(|before| before != level)
                && left_of(&mut covers, length_mm, self.tolerance_mm).parts.is_empty()
            {
                break;
            }
            self.lines_in((tool, sector, level), line, length_mm, &mut covers, &mut within);
        }
        (covers, within)
    }

    /// The same of the lines of one sector and level.
    fn lines_in(
        &mut self,
        (tool, sector, level): (u32, i32, i32),
        line: &Drawn,
        length_mm: f64,
        covers: &mut Vec<Cover>,
        within: &mut Vec<(usize, f64)>,
    ) {
        let Some(&axis) = usize::try_from(sector).ok().and_then(|sector| self.axes.get(sector)) else {
            return;
        };
        let tolerance_mm = self.tolerance_mm;
        let (column_mm, row_mm) = self.cell_size_mm(level);
        let [a, b] = [line.from, line.to].map(|at| turned(at, axis));
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        let lines = &self.lines;
        let mut look = |indices: &mut Vec<usize>| {
            indices.retain(|&index| {
                let Some(under) = lines.get(index).filter(|under| !under.is_forgotten) else { return false };
                if let Some((cover, is_within)) = cover(line, length_mm, under, tolerance_mm) {
                    if is_within {
                        within.push((index, cover.off_mm - under.off_mm));
                    }
                    covers.push(cover);
                }
                true
            });
        };
        let rows = cells(a.y - tolerance_mm, b.y + tolerance_mm, row_mm);
        if (b.y - a.y) / row_mm > MOST_ROWS {
            let (first, last) = (
                (tool, sector, level, *rows.start(), i64::MIN),
                (tool, sector, level, *rows.end(), i64::MAX),
            );
            self.line_cells.range_mut(first..=last).for_each(|(_, indices)| look(indices));
            return;
        }
        for row in rows {
            // Where the line is in this row.
            #[expect(clippy::cast_precision_loss, reason = "below 10¹⁵")]
            let below = row as f64 * row_mm;
            let share = |y: f64| if b.y > a.y { ((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0) } else { 0.5 };
            let x = |share: f64| a.x + (b.x - a.x) * share;
            let (enters, leaves) = if b.y - a.y > tolerance_mm {
                (x(share(below - tolerance_mm)), x(share(below + row_mm + tolerance_mm)))
            } else {
                (a.x, b.x)
            };
            let columns = cells(
                libm::fmin(enters, leaves) - tolerance_mm,
                libm::fmax(enters, leaves) + tolerance_mm,
                column_mm,
            );
            let (first, last) =
                ((tool, sector, level, row, *columns.start()), (tool, sector, level, row, *columns.end()));
            self.line_cells.range_mut(first..=last).for_each(|(_, indices)| look(indices));
        }
    }

    fn draw_arc(&mut self, tool: u32, arc: Round, is_clockwise: bool) -> Rest {
        let length_mm = arc.radius_mm * arc.sweep_rad;
        if length_mm.is_nan() || length_mm <= NO_LENGTH_MM {
            return Rest::All;
        }
        let tolerance_mm = self.tolerance_mm;
        let cell_mm = 4.0 * tolerance_mm;
        let circle = [arc.centre.x, arc.centre.y, arc.radius_mm];
        let here = circle.map(|number| cell(number, cell_mm));
        let (mut covers, mut within) = (Vec::new(), Vec::new());
        for part in arc.cells() {
            let Some(indices) = self.arc_cells.get_mut(&(tool, here, part)) else { continue };
            indices.retain(|&index| {
                let Some(under) = self.arcs.get(index).filter(|under| !under.is_forgotten) else {
                    return false;
                };
                arc.covers(under, tolerance_mm, |cover, is_within| {
                    if is_within {
                        within.push((index, cover.off_mm - under.off_mm));
                    }
                    covers.push(cover);
                });
                true
            });
        }
        let left = left_of(&mut covers, length_mm, tolerance_mm);
        if left.parts.is_empty() {
            return Rest::None;
        }
        for (index, off_mm) in within {
            if let Some(under) = self.arcs.get_mut(index) {
                under.is_forgotten |= left.off_mm + off_mm <= under.off_mm + NEARLY * tolerance_mm;
            }
        }
        self.keep_arc(tool, Round { off_mm: libm::fmax(left.off_mm, arc.off_mm), ..arc });
        if left.off_mm > arc.off_mm + NEARLY * tolerance_mm {
            for &(low, high) in &left.parts {
                let begin_rad = libm::fmod(arc.begin_rad + low / arc.radius_mm, TAU);
                self.keep_arc(tool, Round { begin_rad, sweep_rad: (high - low) / arc.radius_mm, ..arc });
            }
        }
        if left.parts.iter().any(|&(low, high)| low <= 0.0 && high >= length_mm) {
            return Rest::All;
        }
        let mut left = left.parts;
        if is_clockwise {
            left.reverse();
            left.iter_mut().for_each(|part| *part = (length_mm - part.1, length_mm - part.0));
        }
        Rest::Parts { length_mm, left }
    }

    fn keep_arc(&mut self, tool: u32, arc: Round) {
        let index = self.arcs.len();
        self.arcs.push(arc);
        let [x, y, radius] = [arc.centre.x, arc.centre.y, arc.radius_mm].map(|number| {
            cells(number - self.tolerance_mm, number + self.tolerance_mm, 4.0 * self.tolerance_mm)
        });
        for x in x {
            for y in y.clone() {
                for radius in radius.clone() {
                    for part in arc.cells() {
                        self.arc_cells.entry((tool, [x, y, radius], part)).or_default().push(index);
                    }
                }
            }
        }
    }

    fn draw_curve(&mut self, tool: u32, curve: Curve) -> Rest {
        let [from, a, b, to] = curve.places;
        if !(is_near(a) && is_near(b)) {
            return Rest::All;
        }
        let (tolerance_mm, cell_mm) = (self.tolerance_mm, 4.0 * self.tolerance_mm);
        let (ends, handles) = (from.lerp(to, 0.5), a.lerp(b, 0.5));
        let middles = [ends.x, ends.y, handles.x, handles.y];
        let here = self.curves.get(&(tool, middles.map(|middle| cell(middle, cell_mm))));
        if here.into_iter().flatten().any(|drawn| drawn.is_same(&curve, tolerance_mm)) {
            return Rest::None;
        }
        let [x, y, z, w] = middles.map(|middle| cells(middle - tolerance_mm, middle + tolerance_mm, cell_mm));
        for x in x {
            for y in y.clone() {
                for z in z.clone() {
                    for w in w.clone() {
                        self.curves.entry((tool, [x, y, z, w])).or_default().push(curve);
                    }
                }
            }
        }
        Rest::All
    }
}

impl Curve {
    /// Whether another one is the same within a tolerance, either way round.
    fn is_same(&self, other: &Self, tolerance_mm: f64) -> bool {
        /// Turns of two curves that differ by less are equal, rad; places decide the rest within the
        /// tolerance.
        const SAME_RAD: f64 = 1e-3;
        let [a, b, c, d] = other.places;
        [([a, b, c, d], other.turn_rad), ([d, c, b, a], -other.turn_rad)].iter().any(|(places, turn_rad)| {
            libm::fabs(turn_rad - self.turn_rad) <= SAME_RAD
                && self.places.iter().zip(places).all(|(here, there)| here.distance(*there) <= tolerance_mm)
        })
    }
}

impl Round {
    /// The parts of a turn that it is in.
    fn cells(&self) -> impl Iterator<Item = i64> + use<> {
        let cell_rad = TAU / ARC_CELLS;
        let first = cell(self.begin_rad, cell_rad);
        let last = cell(self.begin_rad + self.sweep_rad, cell_rad).min(first + 63);
        (first..=last).map(|cell| cell.rem_euclid(64))
    }

    /// Tells the parts of it that lie on another arc, and whether the other one lies on it as a whole.
    fn covers(&self, under: &Self, tolerance_mm: f64, mut found: impl FnMut(Cover, bool)) {
        let apart_mm = self.centre.distance(under.centre) + libm::fabs(self.radius_mm - under.radius_mm);
        let off_mm = apart_mm + self.off_mm + under.off_mm;
        if off_mm.is_nan() || off_mm > tolerance_mm {
            return;
        }
        for turns in [-TAU, 0.0, TAU] {
            let begin = under.begin_rad - self.begin_rad + turns;
            let end = begin + under.sweep_rad;
            let (low, high) = (libm::fmax(begin, 0.0), libm::fmin(end, self.sweep_rad));
            let (low_mm, high_mm) = (low * self.radius_mm, high * self.radius_mm);
            if high_mm - low_mm > NO_LENGTH_MM {
                found(Cover { low_mm, high_mm, off_mm }, begin >= 0.0 && end <= self.sweep_rad);
            }
        }
    }
}

/// The part of a line that lies on another one, and whether the other one lies on it as a whole.
fn cover(line: &Drawn, length_mm: f64, under: &Drawn, tolerance_mm: f64) -> Option<(Cover, bool)> {
    let along = (line.to - line.from) * (1.0 / length_mm);
    let place = |at: Point| (along.dot(at - line.from), along.cross(at - line.from));
    let (mut first, mut last) = (place(under.from), place(under.to));
    if first.0 > last.0 {
        (first, last) = (last, first);
    }
    let (low_mm, high_mm) = (libm::fmax(first.0, 0.0), libm::fmin(last.0, length_mm));
    let slope = (last.1 - first.1) / (last.0 - first.0);
    if !(high_mm - low_mm > NO_LENGTH_MM && libm::fabs(slope) <= STEEPEST) {
        return None;
    }
    let beside = |at_mm: f64| libm::fabs(first.1 + (at_mm - first.0) * slope);
    let off_mm = libm::fmax(beside(low_mm), beside(high_mm)) + under.off_mm;
    let is_within = first.0 >= -NO_LENGTH_MM && last.0 <= length_mm + NO_LENGTH_MM;
    (off_mm <= tolerance_mm).then_some((Cover { low_mm, high_mm, off_mm }, is_within))
}

/// What covers leave of a length. A gap is none if all of it is within the tolerance of what lies beside it.
fn left_of(covers: &mut [Cover], length_mm: f64, tolerance_mm: f64) -> Left {
    covers.sort_unstable_by(|a, b| a.low_mm.total_cmp(&b.low_mm));
    let mut left = Left { parts: Vec::new(), off_mm: 0.0 };
    // Where the covers so far end, and how far that one is off.
    let (mut at_mm, mut last_off_mm) = (0.0, None);
    let end = Cover { low_mm: length_mm, high_mm: length_mm, off_mm: 0.0 };
    for (cover, off_mm) in covers.iter().map(|cover| (cover, Some(cover.off_mm))).chain([(&end, None)]) {
        let gap_mm = cover.low_mm - at_mm;
        if gap_mm > 0.0 {
            let away_mm = match (last_off_mm, off_mm) {
                (Some(one), Some(other)) => libm::hypot(libm::fmax(one, other), 0.5 * gap_mm),
                (Some(off_mm), None) | (None, Some(off_mm)) => libm::hypot(off_mm, gap_mm),
                (None, None) => f64::INFINITY,
            };
            if away_mm <= tolerance_mm || gap_mm <= NO_LENGTH_MM {
                left.off_mm = libm::fmax(left.off_mm, libm::fmin(away_mm, tolerance_mm));
            } else {
                left.parts.push((at_mm, cover.low_mm));
            }
        }
        if cover.high_mm > at_mm {
            at_mm = cover.high_mm;
            if let Some(off_mm) = off_mm {
                last_off_mm = Some(off_mm);
                left.off_mm = libm::fmax(left.off_mm, off_mm);
            }
        }
    }
    left
}

/// Whether a place is one that is looked at.
fn is_near(at: Point) -> bool {
    libm::fabs(at.x) <= FARTHEST_MM && libm::fabs(at.y) <= FARTHEST_MM
}

/// Along an axis, and to the left of it.
fn turned(at: Point, axis: Vec2) -> Vec2 {
    let out = at - Point::ORIGIN;
    Vec2::new(axis.dot(out), axis.cross(out))
}

/// Direction of a line, whichever way it goes: from 0 to less than π.
fn angle_of(way: Vec2) -> f64 {
    let angle = libm::atan2(way.y, way.x);
    let angle = if angle < 0.0 { angle + PI } else { angle };
    if angle < PI { angle } else { 0.0 }
}

fn sector_of(way: Vec2) -> i32 {
    #[expect(clippy::cast_possible_truncation, reason = "0 to 128")]
    let sector = libm::floor(angle_of(way) / PI * f64::from(SECTORS)) as i32;
    sector.rem_euclid(SECTORS)
}

/// Lines of a level are at least 4^level mm long, and shorter than four times that.
fn level_of(length_mm: f64) -> i32 {
    libm::ilogb(length_mm).div_euclid(2)
}

/// Which cell of a size a place is in.
fn cell(place: f64, size: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "places are near, sizes above 10⁻⁶")]
    let cell = libm::floor(place / size) as i64;
    cell
}

/// The cells between two places.
fn cells(one: f64, other: f64, size: f64) -> RangeInclusive<i64> {
    cell(libm::fmin(one, other), size)..=cell(libm::fmax(one, other), size)
}
