//! [`centred`]: places of a thinned line are put into the middle between its rims, and its corners where its straight parts meet.
//!
//! Thinning rounds corners, is drawn into the foot of a tee, and cuts the inside of narrow turns. Where a cut across shows one line,
//! its middle counts; what lies between two such parts is straight if they are on one line, and a corner if their lines meet here.

use super::corners::{CORNER_COS, LONG, crossing, is_bent, is_curve, sharpen, square, straight, turn};
use super::crowd::Crowd;
use super::flat::Flat;
use super::lines::cosine;
use super::profile::across;
use super::tips::fitted;
use crate::stroke::{PxPoint, PxVec};

/// A place that moves farther than this, as a share of the line's width, is on another line.
const FARTHEST_SHARE: f64 = 0.5;

/// Ink wider than this share of the line's width, and 0.8 px, is more than one line.
const ONE_LINE: f64 = 1.2;

/// A part between two others is straight when they turn by less: cosine of 12 degrees.
const STRAIGHT_COS: f64 = 0.978;

/// Lines that turn by more have a bend: cosine of 5 degrees.
pub(super) const BENT_COS: f64 = 0.9962;

/// As straight are the parts of a line that meet in a corner, and as straight those by which a curve is told, px.
const STRAIGHT_OFF_PX: f64 = 0.3;
const CURVED_OFF_PX: f64 = 0.5;

/// A curve turns by less to either side of the straight way over it: cosine of 35 degrees.
const CURVE_COS: f64 = 0.82;

/// Where a line turns back, its arms are one piece of ink as far as they are nearer to each other than its width and this, px.
const ONE_INK_PX: f64 = 2.5;

/// A line has a width of its own when it differs by more than this share of the others' width, and this, px; and by how many cuts.
const OTHER_SHARE: f64 = 0.25;
const OTHER_PX: f64 = 0.5;
const LEAST_CUTS: usize = 6;

/// A line turns back where the way along it is longer than the straight one by this factor.
const TURN_FACTOR: f64 = 1.3;

/// Places before and behind a turn that are looked at.
pub(super) const TURN_PLACES: usize = 40;

/// Puts the places of lines, about 2 px from each other, into their middles; the first and the last of each stay.
pub(super) fn centred(flat: &Flat, lines: &mut [Vec<PxPoint>], widths_px: &[f64]) {
    let crowd = Crowd::of(lines, widths_px, flat.size(), ONE_INK_PX);
    for (line, (places, width_px)) in lines.iter_mut().zip(widths_px).enumerate() {
        let beside: Vec<bool> = places.iter().map(|at| crowd.is_near(line, *at)).collect();
        centre(flat, places, &beside, *width_px);
    }
}

/// The width of each line, px: that of most, but where a line is clearly thinner or thicker.
pub(super) fn widths_px(flat: &Flat, lines: &[Vec<PxPoint>], most_px: f64) -> Vec<f64> {
    let width_px = |places: &Vec<PxPoint>| {
        let mut cuts: Vec<f64> =
            places.windows(3).filter_map(|three| width_at(flat, three, most_px)).collect();
        cuts.sort_by(f64::total_cmp);
        let own_px = cuts.get(cuts.len() / 2).copied().filter(|_| cuts.len() >= LEAST_CUTS);
        own_px.filter(|own_px| (own_px - most_px).abs() > OTHER_SHARE * most_px + OTHER_PX).unwrap_or(most_px)
    };
    lines.iter().map(width_px).collect()
}

/// The width of the ink across the middle one of three places, px, if it is one line.
fn width_at(flat: &Flat, three: &[PxPoint], most_px: f64) -> Option<f64> {
    let &[a, at, b] = three else { return None };
    let PxVec { x, y } = b - a;
    let length = libm::hypot(x, y);
    let cut = across(flat, at, PxVec::new(-y / length.max(1e-9), x / length.max(1e-9)), most_px)?;
    (!cut.is_lopsided).then_some(cut.width_px)
}

/// Puts the places of a line into its middle, but those with another line `beside` them.
fn centre(flat: &Flat, places: &mut [PxPoint], beside: &[bool], width_px: f64) {
    let mut is_sound = vec![false; places.len()];
    let in_turn = turns(places, width_px);
    let stays =
        |i: usize| [in_turn.get(i), beside.get(i)].into_iter().any(|stays| stays.copied().unwrap_or(true));
    for _ in 0..2 {
        let before = places.to_vec();
        for (i, three) in before.windows(3).enumerate() {
            let &[a, at, b] = three else { continue };
            let PxVec { x, y } = b - a;
            let length = libm::hypot(x, y);
            let turns = cosine(at - a, b - at) < CORNER_COS;
            if length < 1.0 || turns || stays(i + 1) {
                continue;
            }
            let normal = PxVec::new(-y / length, x / length);
            let Some(cut) = across(flat, at, normal, width_px) else { continue };
            let is_one = cut.width_px < ONE_LINE * width_px + 0.8 && !cut.is_lopsided;
            if is_one && cut.middle_px.abs() < FARTHEST_SHARE * width_px {
                if let Some(place) = places.get_mut(i + 1) {
                    *place = at + normal * (0.8 * cut.middle_px);
                }
                if let Some(sound) = is_sound.get_mut(i + 1) {
                    *sound = true;
                }
            }
        }
    }
    bridge(places, &is_sound, width_px);
    turn(flat, places, &in_turn, width_px);
    square(flat, places, width_px);
    sharpen(flat, places, width_px);
}

/// The places that are in sharp turns.
pub(super) fn turns(places: &[PxPoint], width_px: f64) -> Vec<bool> {
    let mut found: Vec<bool> = (0..places.len()).map(|i| is_in_turn(places, i, width_px)).collect();
    // From the tip itself both arms go off straight.
    let mut last = None;
    for i in 0..found.len() {
        if !found.get(i).copied().unwrap_or(false) {
            continue;
        }
        if let Some(last) = last.filter(|last| i - last <= 4) {
            found.iter_mut().take(i).skip(last).for_each(|tip| *tip = true);
        }
        last = Some(i);
    }
    found
}

/// Whether a place is so near to a sharp turn that the line's other arm is in the same ink.
fn is_in_turn(places: &[PxPoint], i: usize, width_px: f64) -> bool {
    let Some(at) = places.get(i) else { return false };
    let turns_back = |other: &PxPoint, count: usize| {
        let way_px = super::lines::count_f64(count) * super::lines::SPACING_PX;
        at.is_within((width_px + ONE_INK_PX).min((way_px - 1.0) / TURN_FACTOR), *other)
    };
    let before = places.get(..i).unwrap_or(&[]).iter().rev().take(TURN_PLACES).enumerate();
    let behind = places.get(i + 1..).unwrap_or(&[]).iter().take(TURN_PLACES).enumerate();
    before.chain(behind).any(|(k, other)| turns_back(other, k + 1))
}

/// How a line goes on between two parts of it.
enum Between {
    Straight,
    /// Around the place where both parts, which are straight, meet.
    Corner(PxPoint),
    /// With the curvature that it has before and behind, 1/px.
    Curve(f64),
}

/// How a line goes on between two places of it, by the parts before and behind them.
fn between(places: &[PxPoint], first: usize, last: usize) -> Between {
    let arms = |long: usize| {
        let arm = |from: Option<usize>, to: usize| from.and_then(|from| places.get(from..=to)).unwrap_or(&[]);
        [arm(first.checked_sub(long), first), arm(Some(last), last + long)]
    };
    let [before, behind] = arms(LONG);
    let (Some(one), Some(other)) =
        (straight(before, LONG, CURVED_OFF_PX), straight(behind, LONG, CURVED_OFF_PX))
    else {
        return Between::Straight;
    };
    // The longer the arms, the better they tell whether they are bent.
    let are_curves = |arms: &[&[PxPoint]; 2]| {
        arms.iter().all(|arm| arm.len() > LONG && (arm.len() == LONG + 1 || is_curve(arm)))
    };
    let longest = [3 * LONG, 2 * LONG, LONG].into_iter().map(arms).find(are_curves);
    if let Some(curvature) = longest.and_then(curvature_between) {
        return Between::Curve(curvature);
    }
    if cosine(one.1, other.1) > BENT_COS {
        return Between::Straight;
    }
    let are_straight = [before, behind].iter().all(|arm| straight(arm, LONG, STRAIGHT_OFF_PX).is_some());
    let met = crossing(one, other);
    let (Some(from), Some(to)) = (places.get(first), places.get(last)) else { return Between::Straight };
    let way = *to - *from;
    let off = met - *from;
    let share = off.dot(way) / way.length_squared();
    if are_straight && (0.1..0.9).contains(&share) { Between::Corner(met) } else { Between::Straight }
}

/// The curvature of a line between two arms of it, 1/px; none if they are not bent as much.
fn curvature_between(arms: [&[PxPoint]; 2]) -> Option<f64> {
    let (one, other) = (fitted(arms[0])?, fitted(arms[1])?);
    let turn_cos = cosine(one.1, other.1);
    if turn_cos > BENT_COS || !is_bent(arms, [one, other], turn_cos) {
        return None;
    }
    let side = libm::copysign(1.0, one.1.cross(other.1));
    Some(side * libm::acos(turn_cos.clamp(-1.0, 1.0)) / one.0.distance(other.0))
}

/// Runs of places that are no line of their own, over a crossing or the foot of a tee, go straight on.
fn bridge(places: &mut [PxPoint], is_sound: &[bool], width_px: f64) {
    let sound = |i: usize| is_sound.get(i).copied().unwrap_or(false);
    let mut i = 4;
    while i < places.len() {
        if sound(i) || !sound(i - 1) {
            i += 1;
            continue;
        }
        let end = (i..places.len()).find(|j| sound(*j)).unwrap_or(places.len());
        // The neighbours of a foot lean to it already.
        let (first, last) = (i - 2, end + 1);
        if let (Some(before), Some(from), Some(to), Some(behind)) = (
            first.checked_sub(3).and_then(|j| places.get(j)).copied(),
            places.get(first).copied(),
            places.get(last).copied(),
            places.get(last + 3).copied(),
        ) {
            let (way, length) = (to - from, from.distance(to));
            let course = between(places, first, last);
            let least_cos = if let Between::Curve(_) = course { CURVE_COS } else { STRAIGHT_COS };
            let agree = cosine(from - before, way) > least_cos && cosine(behind - to, way) > least_cos;
            if agree && length < 8.0 * width_px + 20.0 {
                let bend = if let Between::Corner(met) = course { met } else { from + way * 0.5 };
                let parts = [from.distance(bend), bend.distance(to)];
                // The middle of a curve is off the straight way by an eighth of its length squared and its curvature.
                let beside = match course {
                    Between::Curve(curvature) => {
                        PxVec::new(0.5 * curvature * length * way.y, -0.5 * curvature * length * way.x)
                    }
                    _ => PxVec::default(),
                };
                for (k, place) in places.iter_mut().enumerate().take(last).skip(first + 1) {
                    let share = super::lines::count_f64(k - first) / super::lines::count_f64(last - first);
                    let gone = share * (parts[0] + parts[1]);
                    let at = if gone < parts[0] {
                        from + (bend - from) * (gone / parts[0])
                    } else {
                        bend + (to - bend) * ((gone - parts[0]) / parts[1].max(1e-9))
                    };
                    *place = at + beside * (share * (1.0 - share));
                }
            }
        }
        i = end + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    #[test]
    fn a_rounded_corner_becomes_one_and_a_line_goes_to_its_middle() {
        let corner = [(20.0, 60.0), (80.0, 60.0), (80.0, 120.0)].map(|(x, y)| PxPoint::new(x, y));
        let paper = Paper::drawn(140, 140, &[(corner.to_vec(), 5.0)]).unwrap();
        let settings = CameraSettings { width_px: 140, height_px: 140, ..CameraSettings::default() };
        let flat =
            Flat::of(&SimulatedCamera::new(&paper, settings).window(PxPoint::new(70.0, 70.0)), None, None);
        // Cut by 1.5 px, and half a pixel beside the line.
        let rounded =
            [(20.0, 60.5), (78.5, 60.5), (79.5, 62.0), (79.5, 120.0)].map(|(x, y)| PxPoint::new(x, y));
        let mut lines = [super::super::lines::resampled(&rounded, 2.0)];
        centred(&flat, &mut lines, &[5.0]);
        let [places] = lines;
        let nearest = places.iter().map(|at| at.distance(corner[1])).fold(f64::MAX, f64::min);
        assert!(nearest < 0.25, "{nearest}");
        let inner = places.iter().filter(|at| at.x > 30.0 && at.x < 70.0);
        let off = inner.map(|at| (at.y - 60.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.2, "{off}");
    }
}
