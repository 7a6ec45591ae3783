//! Whether a second pose explains what the first one leaves over: strokes of the drawing beside the marks, or
//! the marks beside strokes; and whether enough marks agree where there are strokes.

use super::equations::Row;
use crate::marks::MOST_CROSSINGS;
use plotter_motion::{Axis, Point};

/// Ink nearer to a mark's place than this is that mark, smeared or roughly drawn, mm: the width of a pen's
/// line.
const APART_MM: f32 = 0.5;

/// Places of one pose are this near to each other, mm, and three of their deviations.
const NEAR_MM: f32 = 0.05;

/// A pose that is turned otherwise is told by two places this far apart, mm.
const BASELINE_MM: f32 = 100.0;

/// Axis along which another pose explains places that the told one does not, and at how many crossings.
///
/// Where marks stand in straight rows one stroke imitates a row, and what is left over may be all that is
/// seen of the marks. Dust lies anywhere, hardly ever two grains the same way beside their marks: so two
/// crossings that tell the same other shift are enough. Of marks with a pattern a stroke imitates one in a
/// row: three of one shift are more than strokes beside some rows come to, and so are two along each axis.
///
/// A pose that is turned otherwise is one if it explains half as many crossings as the told one where marks
/// stand in rows, two thirds elsewhere. It may also share the marks at one side of the field with the told
/// one: then it must explain as many but for one, and two of them must be left over, as one grain of dust
/// turns a pose too.
pub(super) fn rival(
    rows: &[Row],
    inliers: u64,
    residuals_mm: &[f32; MOST_CROSSINGS],
    agree: [u32; 2],
    greatest_angle_rad: f32,
) -> Option<(Axis, u32)> {
    let mut alike = [0; 2];
    for (axis, (agree, alike)) in [Axis::X, Axis::Y].into_iter().zip(agree.into_iter().zip(&mut alike)) {
        let mut seen = Seen { places: [Place::NONE; MOST_CROSSINGS], count: 0 };
        for (index, (row, &off_mm)) in rows.iter().zip(residuals_mm).enumerate() {
            let is_left = off_mm.abs() > APART_MM;
            if row.axis == axis && (is_left || inliers >> index & 1 == 1) {
                seen.push(Place::of(row, off_mm, is_left));
            }
        }
        let in_row = has_straight_row(rows, axis);
        *alike = seen.of_one_shift();
        if *alike >= if in_row { 2 } else { 3 } {
            return Some((axis, *alike));
        }
        let least_left = if in_row { agree.div_ceil(2) } else { (2 * agree).div_ceil(3) };
        if let Some(crossings) = seen.turned(greatest_angle_rad, least_left.max(3), agree.max(4) - 1) {
            return Some((axis, crossings));
        }
    }
    // Two of one shift are as likely dust along one axis as not; along both they are marks.
    let [x, y] = alike;
    (x.min(y) >= 2).then_some((Axis::Y, y))
}

/// Whether two marks of an axis stand on one line.
fn has_straight_row(rows: &[Row], axis: Axis) -> bool {
    let of = |index: usize| rows.iter().skip(index).filter(|row| row.axis == axis);
    rows.iter().enumerate().filter(|(_, row)| row.axis == axis).any(|(index, row)| {
        of(index + 1).any(|other| other.crossing != row.crossing && other.mark_mm == row.mark_mm)
    })
}

/// At so many crossings of an axis something else was seen besides what agrees: strokes of the drawing, as
/// dust hardly ever lies on two.
const STROKES: u32 = 2;

/// Where there are strokes, so many marks at one side of the field must agree: a stroke imitates two of a
/// pattern at the most, and so do two strokes by chance.
pub(super) const LEAST_BESIDE_STROKES: u32 = 3;

/// At how many crossings of each axis strokes of the drawing were seen; 0 where it may be dust.
pub(super) fn strokes(rows: &[Row], residuals_mm: &[f32; MOST_CROSSINGS]) -> [u32; 2] {
    [Axis::X, Axis::Y].map(|axis| {
        let left = |(row, off_mm): &(&Row, &f32)| row.axis == axis && off_mm.abs() > APART_MM;
        let mask = rows.iter().zip(residuals_mm).filter(left).fold(0_u64, |mask, (row, _)| mask | bit(row));
        Some(mask.count_ones()).filter(|count| *count >= STROKES).unwrap_or(0)
    })
}

/// Of an axis along which there are strokes, how many marks agree at the side of the field that counts, if
/// those are too few.
///
/// The place along the joint is told by the marks of either side, so the better one counts; the place across
/// it and the turn by those of both, so the worse one does.
pub(super) fn too_few_beside(
    rows: &[Row],
    inliers: u64,
    joint: [Point; 2],
    strokes: [u32; 2],
) -> Option<(Axis, u32)> {
    let (middle, way) = (joint[0].lerp(joint[1], 0.5), joint[1] - joint[0]);
    [Axis::X, Axis::Y].into_iter().zip(strokes).filter(|(_, strokes)| *strokes > 0).find_map(|(axis, _)| {
        let mut sides = [0_u64; 2];
        for (_, row) in
            rows.iter().enumerate().filter(|(index, row)| inliers >> index & 1 == 1 && row.axis == axis)
        {
            let place = match axis {
                Axis::X => Point::new(row.mark_mm, row.scan_at_mm),
                Axis::Y => Point::new(row.scan_at_mm, row.mark_mm),
            };
            sides[usize::from((place - middle).dot(way) > 0.0)] |= bit(row);
        }
        let [one, other] = sides.map(u64::count_ones);
        let counts = if axis == axis_along(joint) { one.max(other) } else { one.min(other) };
        (counts < LEAST_BESIDE_STROKES).then_some((axis, counts))
    })
}

/// The axis along which the joint goes.
fn axis_along(joint: [Point; 2]) -> Axis {
    let way = joint[1] - joint[0];
    if libm::fabs(way.x) > libm::fabs(way.y) { Axis::X } else { Axis::Y }
}

/// A crossing's place in a mask.
fn bit(row: &Row) -> u64 {
    1 << (row.crossing % 64)
}

/// What was seen along one axis.
struct Seen {
    places: [Place; MOST_CROSSINGS],
    count: usize,
}

impl Seen {
    fn push(&mut self, place: Place) {
        if let Some(slot) = self.places.get_mut(self.count) {
            *slot = place;
            self.count += 1;
        }
    }

    fn places(&self) -> &[Place] {
        &self.places[..self.count]
    }

    fn left(&self) -> impl Iterator<Item = &Place> {
        self.places().iter().filter(|place| place.is_left)
    }

    /// The most crossings at which places that are left over lie the same way beside the told pose: all near
    /// to each other, not only to one in their middle, as strokes beside a pattern lie close.
    fn of_one_shift(&self) -> u32 {
        let beside = |one: &Place| {
            let near = |other: &&Place| {
                let off_mm = other.off_mm - one.off_mm;
                off_mm >= 0.0 && one.is_near(other, off_mm)
            };
            crossings(self.left().filter(near))
        };
        self.left().map(beside).max().unwrap_or(0)
    }

    /// The most crossings that a pose explains which is turned otherwise, if it explains so many that are
    /// left over, or two of them and so many in all.
    fn turned(&self, greatest_angle_rad: f32, least_left: u32, least: u32) -> Option<u32> {
        let explained = |one: &Place, other: &Place| {
            let baseline_mm = other.lever_mm - one.lever_mm;
            let slope = (other.off_mm - one.off_mm) / baseline_mm;
            let is_turn = one.crossing != other.crossing && baseline_mm.abs() >= BASELINE_MM;
            // What both explain alike is no other pose.
            let is_other = !one.is_near(other, other.off_mm - one.off_mm);
            if !(is_turn && is_other && slope.abs() <= greatest_angle_rad) {
                return None;
            }
            let near = |third: &&Place| {
                let there_mm = one.off_mm + slope * (third.lever_mm - one.lever_mm);
                one.is_near(third, third.off_mm - there_mm)
            };
            let (left, all) =
                (crossings(self.left().filter(near)), crossings(self.places().iter().filter(near)));
            (left >= least_left || left >= 2 && all >= least).then_some(all)
        };
        let pairs = self.left().flat_map(|one| self.places().iter().map(move |other| (one, other)));
        pairs.filter_map(|(one, other)| explained(one, other)).max()
    }
}

/// At how many different crossings some places lie.
fn crossings<'a>(places: impl Iterator<Item = &'a Place>) -> u32 {
    places.fold(0_u64, |mask, place| mask | 1 << (place.crossing % 64)).count_ones()
}

/// A place that was seen, and how far beside the told pose it lies.
#[derive(Clone, Copy)]
struct Place {
    crossing: usize,
    /// Whether the told pose leaves it over.
    is_left: bool,
    off_mm: f32,
    lever_mm: f32,
    variance: f32,
}

impl Place {
    const NONE: Self = Self { crossing: 0, is_left: false, off_mm: 0.0, lever_mm: 0.0, variance: 0.0 };

    #[allow(clippy::cast_possible_truncation, reason = "single precision is enough to tell 0.05 mm")]
    fn of(row: &Row, off_mm: f32, is_left: bool) -> Self {
        let (lever_mm, weight) = (row.scan_at_mm as f32, row.weight as f32);
        Self { crossing: row.crossing, is_left, off_mm, lever_mm, variance: 1.0 / weight }
    }

    /// Whether both are near to each other that are so far apart, mm. As squares: a root is dear where there
    /// are many pairs.
    fn is_near(&self, other: &Self, apart_mm: f32) -> bool {
        let over_mm = (apart_mm.abs() - NEAR_MM).max(0.0);
        over_mm * over_mm <= 9.0 * (self.variance + other.variance)
    }
}
