//! [`straight_ends`]: lines that end on another one go straight on into it, as far as its middle.
//!
//! Thinning draws the last piece of such a line to where the ink of both has one middle.

use super::corners::{crossing, straight};
use super::crowd::Crowd;
use super::flat::Flat;
use super::lines::{SPACING_PX, cosine};
use crate::PxPoint;

/// Places of a line before its end that tell where it goes on.
const ARM: usize = 7;

/// How far these may be off a straight line, px.
const MOST_OFF_PX: f64 = 0.35;

/// Lines that meet at a smaller angle have one ink for too long: cosine of 25 degrees.
const ALONG_COS: f64 = 0.906;

/// The end that was found counts when it is farther behind the other line's middle, px.
const BEHIND_PX: f64 = 1.5;

/// Puts the ends of lines, whose places are about 2 px from each other, straight.
pub(super) fn straight_ends(flat: &Flat, lines: &mut [Vec<PxPoint>], width_px: f64) {
    let crowd = Crowd::of(lines, flat.size(), 1.1 * width_px + 1.5);
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
            if touching == 0 || SPACING_PX * super::lines::count_f64(touching) > 4.0 * width_px + 4.0 {
                continue;
            }
            if let Some(mut tail) = tail(lines, line, &places, touching, width_px) {
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

/// The first places of a line that begins at another one, instead of the `touching` ones.
fn tail(
    lines: &[Vec<PxPoint>],
    line: usize,
    places: &[PxPoint],
    touching: usize,
    width_px: f64,
) -> Option<Vec<PxPoint>> {
    let arm = places.get(touching..(touching + ARM).min(places.len()))?;
    let own = straight(arm, 4, MOST_OFF_PX)?;
    let (foot, end) = (*arm.first()?, *places.first()?);
    let back = (-own.1.0, -own.1.1);
    let along = |at: PxPoint| {
        let off = at.minus(own.0);
        off.0 * back.0 + off.1 * back.1
    };
    // The other line: the piece that is met first.
    let others = lines.iter().enumerate().filter(|(other, _)| *other != line);
    let met = others
        .flat_map(|(_, other)| other.windows(3))
        .filter_map(|three| {
            let [a, b, c] = three else { return None };
            if b.distance(end) > 1.5 * width_px + 2.0 {
                return None;
            }
            let way = c.minus(*a);
            let length = libm::hypot(way.0, way.1);
            if length < 1e-9 || cosine(way, back).abs() > ALONG_COS {
                return None;
            }
            let met = crossing(own, (*b, (way.0 / length, way.1 / length)));
            (met.distance(*b) < SPACING_PX && along(met) > along(foot)).then_some(met)
        })
        .min_by(|a, b| along(*a).total_cmp(&along(*b)))?;
    let end_px = if along(end) > along(met) + BEHIND_PX { along(end) } else { along(met) };
    let foot = own.0.along(back, along(foot));
    let tip = own.0.along(back, end_px);
    let parts = super::whole::count(libm::ceil(foot.distance(tip) / SPACING_PX)).max(1);
    let part = |k: usize| super::lines::count_f64(k) / super::lines::count_f64(parts);
    Some((0..parts).map(|k| tip.along(foot.minus(tip), part(k))).collect())
}
