//! Distance of found strokes from the straight lines that were drawn.
#![allow(unreachable_pub, reason = "shared by tests, not an interface")]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "lengths of a few hundred px")]

use crate::segment_distance;

use plotter_vector::{Drawing, PxPoint};
use segment_distance::segment_distance;

/// The greatest distance between the lines and what was found of them, px, either way.
pub fn off_px(lines: &[[PxPoint; 2]], found: &Drawing) -> f64 {
    let pieces: Vec<[PxPoint; 2]> = (0..found.strokes().len())
        .flat_map(|i| found.stroke(i).windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>())
        .collect();
    let off = |at: PxPoint, all: &[[PxPoint; 2]]| {
        all.iter().map(|[from, to]| segment_distance(at, *from, *to)).fold(f64::INFINITY, f64::min)
    };
    let places = |[from, to]: &[PxPoint; 2]| {
        let (from, to, steps) = (*from, *to, libm::ceil(from.distance(*to)).max(1.0) as u32);
        (0..=steps).map(move |i| {
            let part = f64::from(i) / f64::from(steps);
            PxPoint::new(from.x + part * (to.x - from.x), from.y + part * (to.y - from.y))
        })
    };
    let missed = lines.iter().flat_map(places).map(|at| off(at, &pieces)).fold(0.0, f64::max);
    pieces.iter().flat_map(places).map(|at| off(at, lines)).fold(missed, f64::max)
}
