//! [`straight_ends`]: lines that end on another one go straight on into it, as far as its middle.
//!
//! Thinning draws the last piece of such a line to where the ink of both has one middle.

use super::corners::{crossing, rim_px, straight};
use super::crowd::Crowd;
use super::flat::Flat;
use super::lines::{CORNER_COS, SPACING_PX, cosine};
use crate::stroke::{PxPoint, PxVec};

/// Places of a line before its end that tell where it goes on.
const ARM: usize = 7;

/// How far these may be off a straight line, px.
const MOST_OFF_PX: f64 = 0.35;
const LEAST_OFF_PX: f64 = 0.08;

/// Places that tell whether the line is a curve: one of a radius of 70 px is 1 px off a straight line over them.
const LONG_ARM: usize = 12;

/// Lines whose rims are nearer to each other than this, and a tenth of a width, have one ink, px.
const CLEAR_PX: f64 = 1.5;

/// The end that was found counts when it is farther behind the other line's middle, px.
const BEHIND_PX: f64 = 1.5;

/// And the ink behind the other line is so much farther from its middle than that line's own rim, px.
const STICKS_PX: f64 = 1.0;

/// Puts the ends of lines, whose places are about 2 px from each other and most of which are `most_px` wide, straight. Lines that
/// are centred tell by a longer part whether they are straight: one that is a curve has been gone on as such.
pub(super) fn straight_ends(
    flat: &Flat,
    lines: &mut [Vec<PxPoint>],
    widths_px: &[f64],
    most_px: f64,
    is_centred: bool,
) {
    let crowd = Crowd::of(lines, widths_px, flat.size(), 0.1 * most_px + CLEAR_PX);
    let thickest_px = widths_px.iter().copied().fold(0.0, f64::max);
    for line in 0..lines.len() {
        for is_last in [false, true] {
            let Some(mut places) = lines.get(line).cloned() else { continue };
            if places.len() < 4 || places.first() == places.last() {
                continue;
            }
            if is_last {
                places.reverse();
            }
            // As far as the other line's ink draws it.
            let touching = places.iter().take_while(|at| crowd.is_near(line, **at)).count();
            if touching == 0 || SPACING_PX * super::lines::count_f64(touching) > 4.0 * thickest_px + 4.0 {
                continue;
            }
            if let Some(mut tail) = tail(flat, lines, line, &places, touching, widths_px, is_centred) {
                tail.extend(places.drain(touching..));
                if is_last {
                    tail.reverse();
                }
                if let Some(line) = lines.get_mut(line) {
                    *line = tail;
                }
            }
        }
    }
}

/// Whether there is ink behind the line along `way` that one meets at a place, farther than that line's own.
fn sticks_out(flat: &Flat, met: PxPoint, way: PxVec, back: PxVec, width_px: f64) -> bool {
    let half = 0.5 * flat.at(met);
    let rim = |at: PxPoint| rim_px(flat, at, back, half, 3.0 * width_px + 4.0);
    let beside = [-1.0, 1.0].map(|side| rim(met + way * (side * (1.5 * width_px + 3.0))));
    match (rim(met), beside) {
        (Some(behind_px), [Some(one_px), Some(other_px)]) => behind_px > one_px.max(other_px) + STICKS_PX,
        _ => true,
    }
}

/// The first places of a line that begins at another one, instead of the `touching` ones.
fn tail(
    flat: &Flat,
    lines: &[Vec<PxPoint>],
    line: usize,
    places: &[PxPoint],
    touching: usize,
    widths_px: &[f64],
    is_centred: bool,
) -> Option<Vec<PxPoint>> {
    let arm = places.get(touching..(touching + ARM).min(places.len()))?;
    let own = straight(arm, 4, MOST_OFF_PX)?;
    if is_centred {
        // As straight as it must be to be gone on for so long; a short one all the more.
        let long = places.get(touching..(touching + (2 * touching).max(LONG_ARM)).min(places.len()))?;
        let share = (super::lines::count_f64(long.len()) / super::lines::count_f64(LONG_ARM)).min(1.0);
        straight(long, 4, (MOST_OFF_PX * share * share).max(LEAST_OFF_PX))?;
    }
    let (foot, end) = (*arm.first()?, *places.first()?);
    let back = -own.1;
    let along = |at: PxPoint| (at - own.0).dot(back);
    // The other line: the piece that is met first.
    let others = lines.iter().enumerate().filter(|(other, _)| *other != line);
    let width_of = |line: usize| widths_px.get(line).copied().unwrap_or(0.0);
    let (met, way, width_px) = others
        .flat_map(|(other, places)| {
            let width_px = width_of(line).max(width_of(other));
            places.windows(3).map(move |three| (three, width_px))
        })
        .filter_map(|(three, width_px)| {
            let [a, b, c] = three else { return None };
            if b.distance(end) > 1.5 * width_px + 2.0 {
                return None;
            }
            let way = *c - *a;
            let length = way.length();
            // Lines that meet at a smaller angle than a corner's have one ink for too long.
            if length < 1e-9 || cosine(way, back).abs() > CORNER_COS {
                return None;
            }
            let way = way / length;
            let met = crossing(own, (*b, way));
            (met.distance(*b) < SPACING_PX && along(met) > along(foot)).then_some((met, way, width_px))
        })
        .min_by(|a, b| along(a.0).total_cmp(&along(b.0)))?;
    let is_behind = along(end) > along(met) + BEHIND_PX && sticks_out(flat, met, way, back, width_px);
    let end_px = if is_behind { along(end) } else { along(met) };
    let foot = own.0 + back * along(foot);
    let tip = own.0 + back * end_px;
    // It ends before the other line where paper is between them.
    let is_ink = |part: f64| flat.at(end + (tip - end) * part) > 0.5 * flat.at(own.0);
    if end_px > along(end) && ![0.2, 0.4, 0.6, 0.8].into_iter().all(is_ink) {
        return None;
    }
    let parts = super::whole::count(libm::ceil(foot.distance(tip) / SPACING_PX)).max(1);
    let part = |k: usize| super::lines::count_f64(k) / super::lines::count_f64(parts);
    Some((0..parts).map(|k| tip + (foot - tip) * part(k)).collect())
}
