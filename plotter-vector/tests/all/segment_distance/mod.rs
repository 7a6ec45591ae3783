//! Distance of a point from a segment.

use plotter_vector::PxPoint;

pub(crate) fn segment_distance(at: PxPoint, from: PxPoint, to: PxPoint) -> f64 {
    let (x, y) = (to.x - from.x, to.y - from.y);
    let square = x * x + y * y;
    let share = if square > 0.0 { ((at.x - from.x) * x + (at.y - from.y) * y) / square } else { 0.0 };
    let share = share.clamp(0.0, 1.0);
    at.distance(PxPoint::new(from.x + x * share, from.y + y * share))
}
