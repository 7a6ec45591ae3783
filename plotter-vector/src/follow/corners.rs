//! Corners of lines where their straight parts meet: thinning and blur round them, and draw the arms of sharp ones together.

use super::flat::Flat;
use super::lines::cosine;
use crate::stroke::{PxPoint, PxVec};
use core::ops::Range;

/// A corner turns by more: cosine of 35 degrees.
pub(super) const CORNER_COS: f64 = 0.82;

/// The arms of sharper tips meet at too small an angle for their crossing: cosine of a turn by 145 degrees.
pub(super) const SHARP_COS: f64 = -0.82;

/// Places of a straight line that a curve of a few widths has not.
pub(super) const LONG: usize = 6;

/// Places at the end of an arm that a turn draws to its inside.
const DRAWN: usize = 2;

/// A curve is nowhere farther from a parabola, px, and its arms nowhere farther from a straight line.
const CURVED_PX: f64 = 0.3;
const BOWED_PX: f64 = 0.8;

/// Blur takes a little off a corner's rim: of what a curve would be short of it less than this share.
const BLURRED_SHARE: f64 = 0.65;

/// A turn is a curve's if the bend of its arms tells of so much of it.
const CURVE_SHARE: f64 = 0.5;

/// The corner of a square turn is as dark as the line, but for blur; beside a round one it is about 0.7 as dark.
pub(super) const SQUARE_DARK: f32 = 0.84;

/// How far behind a sharp tip its ink ends, but for half of the pen's width: blur takes as much of a round end, px.
pub(super) const BLURRED_END_PX: f64 = 0.5;

/// The runs of places that are in a sharp turn, each from its first place to that behind its last one.
pub(super) fn runs(in_turn: &[bool]) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut end = 0;
    in_turn.chunk_by(PartialEq::eq).filter_map(move |run| {
        let first = end;
        end += run.len();
        (run.first() == Some(&true)).then_some(first..end)
    })
}

/// The arms of a sharp turn go on straight from where they are apart to where they meet.
pub(super) fn turn(flat: &Flat, places: &mut [PxPoint], in_turn: &[bool], width_px: f64) {
    for run in runs(in_turn) {
        let Some((corner, met)) = meeting(flat, places, run.start, run.end, width_px) else { continue };
        let from = run.start.checked_sub(1).and_then(|before| places.get(before)).copied();
        let to = places.get(run.end).copied();
        for (k, place) in places.iter_mut().enumerate().take(run.end).skip(run.start) {
            let (other, parts) =
                if k < corner { (from, corner + 1 - run.start) } else { (to, run.end - corner) };
            let share = super::lines::count_f64(k.abs_diff(corner)) / super::lines::count_f64(parts);
            *place = met + (other.unwrap_or(met) - met) * share;
        }
    }
}

/// Where the arms before place `first` and from place `end` on meet, and the place between them that is nearest to it.
fn meeting(
    flat: &Flat,
    places: &[PxPoint],
    first: usize,
    end: usize,
    width_px: f64,
) -> Option<(usize, PxPoint)> {
    let run = places.get(first..end)?;
    // As much of each arm as must be gone on for.
    let fit = run.len().max(8);
    let before = places.get(first.saturating_sub(fit)..first)?;
    let behind = places.get(end..(end + fit).min(places.len()))?;
    let (one, other) = (straight(before, 4, 0.35)?, straight(behind, 4, 0.35)?);
    let cross = one.1.cross(other.1);
    let turn_cos = cosine(one.1, other.1);
    if cross.abs() < 0.05 || turn_cos > CORNER_COS {
        return None;
    }
    let mut met = crossing(one, other);
    if turn_cos < SHARP_COS {
        // Where along the middle of the arms they meet is better told by the end of their ink.
        let way = one.1 - other.1;
        let way = way / way.length();
        // From beside the tip that thinning left: arms of a narrow curve meet far behind it.
        let along = |at: &PxPoint| (*at - met).dot(way);
        let tip_px =
            run.iter().map(along).max_by(f64::total_cmp).filter(|tip_px| tip_px.abs() < 2.0 * width_px)?;
        let from = met + way * tip_px;
        if let Some(end_px) = ink_end_px(flat, from, way, width_px) {
            met = from + way * (end_px - 0.5 * width_px + BLURRED_END_PX);
        }
    }
    let cut_px = cut_px(flat, (met, one.0), turn_cos, width_px);
    let nearest = run.iter().enumerate().min_by(|(_, a), (_, b)| a.distance(met).total_cmp(&b.distance(met)));
    let is_corner = |at: &PxPoint| {
        at.distance(met) < cut_px + 1.0
            && (turn_cos < SHARP_COS || reaches(flat, *at, met, [one, other], width_px))
    };
    nearest.filter(|(_, at)| is_corner(at)).map(|(k, _)| (first + k, met))
}

/// How much of a corner thinning may have cut off, px: a little, or, where there is as much ink as on the line, all as far as where
/// the middles of both arms' ink meet.
fn cut_px(flat: &Flat, (corner, on_line): (PxPoint, PxPoint), turn_cos: f64, width_px: f64) -> f64 {
    let half_sin = libm::sqrt(0.5 * (1.0 + turn_cos)).max(0.1);
    let is_ink = flat.at(corner) >= SQUARE_DARK * flat.at(on_line);
    f64::max(0.6 * width_px, if is_ink { 0.5 * width_px / half_sin + 0.5 } else { 0.0 })
}

/// Whether the ink goes around the place where two arms meet as far as it goes beside them, and not only around the curve that
/// thinning left.
pub(super) fn reaches(
    flat: &Flat,
    curve: PxPoint,
    met: PxPoint,
    arms: [(PxPoint, PxVec); 2],
    width_px: f64,
) -> bool {
    let cut_px = curve.distance(met);
    if cut_px < f64::min(0.2 * width_px, 1.0) {
        return true;
    }
    let [(one, PxVec { x, y }), (other, PxVec { x: u, y: v })] = arms;
    let out = (x - u, y - v);
    let length = libm::hypot(out.0, out.1);
    let side = libm::copysign(1.0, y * u - x * v);
    let half = 0.25 * (flat.at(one) + flat.at(other));
    let rim = |at: PxPoint, way: PxVec| rim_px(flat, at, way, half, 2.0 * width_px);
    let beside = [rim(one, PxVec::new(-side * y, side * x)), rim(other, PxVec::new(-side * v, side * u))];
    let (Some(around), [Some(one_px), Some(other_px)]) =
        (rim(met, PxVec::new(out.0 / length, out.1 / length)), beside)
    else {
        return true;
    };
    around > 0.5 * (one_px + other_px) - BLURRED_SHARE * cut_px
}

/// From a place to the rim of its ink, as dark as `half`, along a direction of length 1, px; none farther than `most_px`.
pub(super) fn rim_px(flat: &Flat, at: PxPoint, way: PxVec, half: f32, most_px: f64) -> Option<f64> {
    let steps = super::whole::count(2.0 * most_px);
    let dark = |step: usize| flat.at(at + way * (0.5 * super::lines::count_f64(step)));
    let Some(step) = (0..=steps).find(|step| dark(*step) < half)?.checked_sub(1) else { return Some(0.0) };
    let (inner, outer) = (dark(step), dark(step + 1));
    Some(0.5 * (super::lines::count_f64(step) + f64::from((inner - half) / (inner - outer))))
}

/// How far from a place in ink, along a direction of length 1, the ink ends: where it is half as dark as at its darkest.
pub(super) fn ink_end_px(flat: &Flat, at: PxPoint, way: PxVec, width_px: f64) -> Option<f64> {
    let steps = 2 * super::whole::count(4.0 * width_px + 8.0);
    let first_px = -2.0 * width_px - 4.0;
    let dark: Vec<f32> = (0..=steps)
        .map(|step| flat.at(at + way * (first_px + 0.5 * super::lines::count_f64(step))))
        .collect();
    let half = 0.5 * dark.iter().copied().fold(0.0, f32::max);
    let first = dark.iter().position(|dark| *dark >= half)?;
    let last = first + dark.get(first..)?.iter().position(|dark| *dark < half)?;
    let (inner, outer) = (*dark.get(last - 1)?, *dark.get(last)?);
    Some(first_px + 0.5 * (super::lines::count_f64(last) - f64::from((half - outer) / (inner - outer))))
}

/// Square turns from one line to the next beside it have their two corners, which thinning cuts off; round ones stay.
pub(super) fn square(flat: &Flat, places: &mut [PxPoint], width_px: f64) {
    let most = super::whole::count(2.0 * width_px) + 4;
    let mut i = LONG;
    while i + LONG < places.len() {
        let found = (i + 2..=i + most).find_map(|j| Some((j, corners(flat, places, i, j, width_px)?)));
        let Some((j, [one, other])) = found else {
            i += 1;
            continue;
        };
        let (begins, ends) = (i - DRAWN, (j + DRAWN).min(places.len() - 1));
        let (Some(from), Some(to)) = (places.get(begins).copied(), places.get(ends).copied()) else { break };
        let way = [from.distance(one), one.distance(other), other.distance(to)];
        let parts = super::lines::count_f64(ends - begins) / (way[0] + way[1] + way[2]);
        // As many places as before, a corner at the nearest of each.
        let first = (begins + super::whole::count(way[0] * parts + 0.5)).clamp(begins + 1, ends - 2);
        let second = (ends - super::whole::count(way[2] * parts + 0.5).min(ends)).clamp(first + 1, ends - 1);
        for ([a, b], [begin, end]) in
            [([from, one], [begins, first]), ([one, other], [first, second]), ([other, to], [second, ends])]
        {
            let count = super::lines::count_f64(end - begin);
            for (k, place) in places.iter_mut().enumerate().take(end + 1).skip(begin) {
                *place = a + (b - a) * (super::lines::count_f64(k - begin) / count);
            }
        }
        i = j + 1;
    }
}

/// The corners of a square turn between an arm that ends at place `i` and one that begins at place `j`.
fn corners(flat: &Flat, places: &[PxPoint], i: usize, j: usize, width_px: f64) -> Option<[PxPoint; 2]> {
    if j < i + 3 {
        return None;
    }
    let before = straight(places.get(i - LONG..=i)?, LONG, 0.3)?;
    let behind = straight(places.get(j..=j + LONG)?, LONG, 0.3)?;
    // A turn draws the last places of its arms a little.
    let clear = |part: Option<&[PxPoint]>| part.and_then(|part| straight(part, LONG, 0.3));
    let before = clear(places.get((i - LONG).saturating_sub(DRAWN)..=i - DRAWN)).unwrap_or(before);
    let behind = clear(places.get(j + DRAWN..=j + DRAWN + LONG)).unwrap_or(behind);
    let ((at, along), (other, back)) = (before, behind);
    let apart_px = (other - at).cross(along).abs();
    let is_turn = cosine(along, back) < -0.9 && apart_px > 1.2 * width_px && apart_px < 4.0 * width_px;
    // The arms end here: behind them the line is bent.
    let goes_on = straight(places.get(i + 1 - LONG..=i + 1)?, LONG, 0.3).is_some()
        || straight(places.get(j - 1..j + LONG)?, LONG, 0.3).is_some();
    if !is_turn || goes_on {
        return None;
    }
    let run = places.get(i..=j)?;
    let far = |place: &PxPoint| (*place - at).dot(along);
    let top = run.iter().max_by(|a, b| far(a).total_cmp(&far(b)))?;
    let out = along - back;
    let side = *top + along * (third_side(flat, *top, [before, behind], width_px)? - far(top));
    let meet = |(from, way): (PxPoint, PxVec)| from + way * ((side - from).dot(out) / way.dot(out));
    let corners = [meet(before), meet(behind)];
    let is_near = corners.iter().all(|corner| run.iter().any(|at| at.distance(*corner) < width_px));
    // In a round turn it does not reach as far.
    let third = (side, corners[1] - corners[0]);
    let third = (third.0, third.1 / third.1.length().max(1e-9));
    let all_reach = corners.iter().zip([[before, third], [third, behind]]).all(|(corner, arms)| {
        let cut = run.iter().min_by(|a, b| a.distance(*corner).total_cmp(&b.distance(*corner)));
        cut.is_some_and(|cut| reaches(flat, *cut, *corner, arms, width_px))
    });
    (is_near && all_reach).then_some(corners)
}

/// How far along its first arm the third side of a square turn is: as far from the rim of its ink as the arms are from theirs.
fn third_side(
    flat: &Flat,
    top: PxPoint,
    [(at, along), (other, back)]: [(PxPoint, PxVec); 2],
    width_px: f64,
) -> Option<f64> {
    let PxVec { x, y } = other - at;
    let apart_px = x * -along.y + y * along.x;
    // To the side of the other arm.
    let over = along.perpendicular();
    let outer = libm::copysign(1.0, apart_px);
    let rim_of = |at: PxPoint, way| rim_px(flat, at, way, 0.5 * flat.at(at), 2.0 * width_px);
    let rim = |at: PxPoint, PxVec { x: u, y: v }: PxVec| rim_of(at, PxVec::new(u * outer, v * outer));
    let beside_px =
        0.5 * (rim(at, PxVec::new(along.y, -along.x))? + rim(other, PxVec::new(back.y, -back.x))?);
    let far = |place: PxPoint| (place - at).dot(along);
    let across = |place: PxPoint| (place - at).dot(over);
    let mut rims = 0.0;
    for share in [0.3, 0.5, 0.7] {
        let level = top + over * (share * apart_px - across(top));
        // From the darkest place there outwards.
        let steps = (-4..=4).map(|k| level + along * (0.25 * f64::from(k) * width_px));
        let ink = steps.max_by(|a, b| flat.at(*a).total_cmp(&flat.at(*b)))?;
        rims += (far(ink) + rim_of(ink, along)?) / 3.0;
    }
    Some(rims - beside_px)
}

/// Corners are where the straight parts on both sides meet.
pub(super) fn sharpen(flat: &Flat, places: &mut [PxPoint], width_px: f64) {
    let old = places.to_vec();
    // Of each side: what the corner bends, px; how much behind it is looked at, px; least number of places; and how far these may be off
    // a straight line, px. A narrow turn of a curve is none.
    for (skip_px, fit_px, least, most_off_px) in
        [(1.1 * width_px, 12.0, 4, 0.35), (0.6 * width_px, 5.0, 3, 0.2)]
    {
        let (skip, fit) = (super::whole::count(0.5 * skip_px).max(1), super::whole::count(0.5 * fit_px));
        let mut done_till = 0;
        for i in 0..old.len() {
            if i < done_till || i < skip + least {
                continue;
            }
            let Some(at) = old.get(i) else { break };
            let before = old.get((i - skip).saturating_sub(fit)..=i - skip).unwrap_or(&[]);
            let behind = old.get(i + skip..(i + skip + fit + 1).min(old.len())).unwrap_or(&[]);
            let (Some(one), Some(other)) =
                (straight(before, least, most_off_px), straight(behind, least, most_off_px))
            else {
                continue;
            };
            // A curve is bent on both sides.
            let far =
                [old.get((i - skip).saturating_sub(LONG)..=i - skip), old.get(i + skip..=i + skip + LONG)];
            let is_long =
                |arm: Option<&[PxPoint]>| arm.is_some_and(|arm| straight(arm, LONG, most_off_px).is_some());
            if fit < LONG && !far.into_iter().any(is_long) {
                continue;
            }
            let turn = cosine(one.1, other.1);
            if !(SHARP_COS..CORNER_COS).contains(&turn) || is_bent([before, behind], [one, other], turn) {
                continue;
            }
            let met = crossing(one, other);
            // Beside a narrow turn that is round the ink is lighter.
            if fit < LONG && flat.at(met) < SQUARE_DARK * flat.at(one.0) {
                continue;
            }
            // This is the place of the corner, none beside it.
            let nearest = old
                .iter()
                .enumerate()
                .skip(i - skip)
                .take(2 * skip + 1)
                .min_by(|(_, a), (_, b)| a.distance(met).total_cmp(&b.distance(met)));
            let cut_px = cut_px(flat, (met, one.0), turn, width_px);
            let is_far = at.distance(met) > cut_px || !reaches(flat, *at, met, [one, other], width_px);
            if nearest.is_none_or(|(k, _)| k != i) || is_far {
                continue;
            }
            for (k, place) in places.iter_mut().enumerate().skip(i - skip).take(2 * skip + 1) {
                let end = old.get(if k < i { i - skip } else { i + skip }).copied().unwrap_or(met);
                let share = super::lines::count_f64(k.abs_diff(i)) / super::lines::count_f64(skip);
                *place = met + (end - met) * share;
            }
            done_till = i + skip;
        }
        if done_till > 0 && skip_px > width_px {
            // The corners that are farther from each other are done; nearer ones are tried only without them.
            return;
        }
    }
}

/// Whether a turn is that of a curve, whose arms are bent as well: their bends go on over as much of it.
pub(super) fn is_bent(arms: [&[PxPoint]; 2], lines: [(PxPoint, PxVec); 2], turn_cos: f64) -> bool {
    let [(at, way), (other, other_way)] = lines;
    let side = libm::copysign(1.0, way.cross(other_way));
    let [one_curve, other_curve] = [curvature(arms[0], at, way), curvature(arms[1], other, other_way)];
    let bent = 0.5 * (one_curve + other_curve) * side * at.distance(other);
    bent > CURVE_SHARE * libm::acos(turn_cos.clamp(-1.0, 1.0))
}

/// Whether places are on a curve without corners: nowhere far from the parabola that is nearest to them.
pub(super) fn is_curve(places: &[PxPoint]) -> bool {
    let Some((middle, along)) = straight(places, 1, BOWED_PX) else { return false };
    let bend = Parabola::of(places, middle, along);
    places
        .iter()
        .all(|at| (local(*at, middle, along).1 - bend.at(local(*at, middle, along).0)).abs() < CURVED_PX)
}

/// The curvature of the parabola that is nearest to places along a direction, 1/px.
fn curvature(places: &[PxPoint], middle: PxPoint, along: PxVec) -> f64 {
    2.0 * Parabola::of(places, middle, along).bend
}

/// A place along a direction and beside it.
fn local(at: PxPoint, middle: PxPoint, along: PxVec) -> (f64, f64) {
    let PxVec { x, y } = at - middle;
    (x * along.x + y * along.y, y * along.x - x * along.y)
}

/// The parabola that is nearest to places whose nearest straight line is known.
struct Parabola {
    bend: f64,
    /// Mean of the squares of the ways along the line, and what of them grows with the way.
    mean: f64,
    slope: f64,
}

impl Parabola {
    fn of(places: &[PxPoint], middle: PxPoint, along: PxVec) -> Self {
        let sum =
            |power: fn(f64) -> f64| places.iter().map(|at| power(local(*at, middle, along).0)).sum::<f64>();
        let (squares, cubes) = (sum(|s| s * s), sum(|s| s * s * s));
        let mut parabola = Self {
            bend: 1.0,
            mean: squares / super::lines::count_f64(places.len()),
            slope: if squares > 0.0 { cubes / squares } else { 0.0 },
        };
        let (off, own) =
            places.iter().map(|at| local(*at, middle, along)).fold((0.0, 0.0), |(off, own), (s, o)| {
                let square = parabola.at(s);
                (off + square * o, own + square * square)
            });
        parabola.bend = if own > 0.0 { off / own } else { 0.0 };
        parabola
    }

    /// How far it is beside the line: the square of the way, less what a straight line has of it.
    fn at(&self, s: f64) -> f64 {
        self.bend * (s * s - self.mean - s * self.slope)
    }
}

/// Where two lines cross that are not parallel, each a place and its direction of length 1.
pub(super) fn crossing(one: (PxPoint, PxVec), other: (PxPoint, PxVec)) -> PxPoint {
    let cross = one.1.cross(other.1);
    one.0 + one.1 * ((other.0 - one.0).cross(other.1) / cross)
}

/// Middle and direction of places that are on a straight line.
pub(super) fn straight(places: &[PxPoint], least: usize, most_off_px: f64) -> Option<(PxPoint, PxVec)> {
    if places.len() < least {
        return None;
    }
    let (middle, direction) = super::tips::fitted(places)?;
    let off = |at: &PxPoint| (*at - middle).cross(direction).abs();
    places.iter().all(|at| off(at) < most_off_px).then_some((middle, direction))
}
