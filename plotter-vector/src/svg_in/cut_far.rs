//! Places far outside of any sheet: what of a stroke lies nearer.
//!
//! ```text
//!            ┌─────────┐ 277 m       lines are cut at the border of the square, curves halved until their parts
//!      ──────┼─────────┼──────       lie outside of it, or are no longer than the square is wide
//!            └─────────┘
//! ```

use super::MAX_PX;
use super::curve::Cubic;
use crate::stroke::{Curve, PxPoint};
use plotter_motion::{Point, Segment};

/// Where places are held that are farther out than numbers of a file reach, after any transforms, px.
const FARTHEST_PX: f64 = 1e15;
/// Halvings of a curve: from the farthest place to a part of the square.
const MOST_HALVINGS: u32 = 40;

/// A place as numbers can be reckoned with: those of single precision may have overflown.
pub(super) fn held(at: PxPoint) -> PxPoint {
    let hold = |px: f64| if px.is_nan() { FARTHEST_PX } else { px.clamp(-FARTHEST_PX, FARTHEST_PX) };
    PxPoint::new(hold(at.x), hold(at.y))
}

/// Whether a place lies outside of the square.
pub(super) fn is_far(at: PxPoint) -> bool {
    !(at.x.abs() <= MAX_PX && at.y.abs() <= MAX_PX)
}

/// Hands the ends of the chords of a curve that leaves the square to `push`: within the tolerance where they
/// lie in it.
pub(super) fn chords<E>(
    curve: &Cubic,
    tolerance_px: f64,
    push: &mut dyn FnMut(PxPoint) -> Result<(), E>,
) -> Result<(), E> {
    part(curve, tolerance_px, MOST_HALVINGS, push)
}

fn part<E>(
    curve: &Cubic,
    tolerance_px: f64,
    halvings: u32,
    push: &mut dyn FnMut(PxPoint) -> Result<(), E>,
) -> Result<(), E> {
    let span = |of: fn(&PxPoint) -> f64| {
        curve
            .0
            .iter()
            .map(of)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), at| (least.min(at), most.max(at)))
    };
    let (x, y) = (span(|at| at.x), span(|at| at.y));
    let is_outside = |(least, most): (f64, f64)| least > MAX_PX || most < -MAX_PX;
    if is_outside(x) || is_outside(y) || halvings == 0 {
        // It lies between its control points, and so does its chord.
        return push(curve.0[3]);
    }
    if x.1 - x.0 <= MAX_PX && y.1 - y.0 <= MAX_PX {
        return curve.chords(tolerance_px).try_for_each(push);
    }
    let [first, second] = curve.halves();
    part(&first, tolerance_px, halvings - 1, push)?;
    part(&second, tolerance_px, halvings - 1, push)
}

/// The parts of a stroke within the square; `None` where that is all of it.
pub(super) fn near_parts(stroke: &Curve) -> Option<Vec<Curve>> {
    if !stroke.vertices.iter().any(|at| is_far(*at)) {
        return None;
    }
    let mut parts: Vec<Curve> = Vec::new();
    let mut last: Option<PxPoint> = None;
    for (index, pair) in stroke.vertices.windows(2).enumerate() {
        let [from, to] = *pair else { continue };
        let Some((start, end)) = within(from, to) else { continue };
        if last != Some(start) || parts.is_empty() {
            parts.push(Curve::from(vec![start]));
        }
        if let Some(part) = parts.last_mut() {
            let bulge = stroke.bulges.get(index).copied().unwrap_or(0.0);
            if bulge != 0.0 {
                part.bulges.resize(part.vertices.len() - 1, 0.0);
                part.bulges.push(bulge);
            }
            part.vertices.push(end);
        }
        last = Some(end);
    }
    // A closed stroke that begins inside goes on over its beginning.
    let first = stroke.vertices.first();
    if parts.len() > 1 && first == stroke.vertices.last() && first.is_some_and(|at| !is_far(*at)) {
        let start = parts.remove(0);
        if let Some(end) = parts.last_mut() {
            end.append(start);
        }
    }
    Some(parts)
}

/// The part of a line within the square.
fn within(from: PxPoint, to: PxPoint) -> Option<(PxPoint, PxPoint)> {
    let line = Segment::new(Point::new(from.x, from.y), Point::new(to.x, to.y));
    let (enters, leaves) = line.shares_in(Point::new(-MAX_PX, -MAX_PX), Point::new(MAX_PX, MAX_PX))?;
    let at = |share: f64| {
        let hold = |px: f64| px.clamp(-MAX_PX, MAX_PX);
        PxPoint::new(hold(from.x + (to.x - from.x) * share), hold(from.y + (to.y - from.y) * share))
    };
    Some((if enters > 0.0 { at(enters) } else { from }, if leaves < 1.0 { at(leaves) } else { to }))
}
