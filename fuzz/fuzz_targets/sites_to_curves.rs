//! Any sites become lines, arcs and cubic curves that keep their promise.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_vector::{Curve, PxPoint, stroke::Bounded};

/// Most sites: what is slow for a few is not found with many.
const MOST_SITES: usize = 400;

/// What rounding may add to the tolerance, and how far chords lie from their curve, px.
const SLACK_PX: f64 = 1e-3;

fuzz_target!(|bytes: &[u8]| {
    let [tolerance, closed, steps @ ..] = bytes else { return };
    let tolerance_px = f64::from(*tolerance) / 64.0;
    let closed = closed % 2 == 1;
    let mut at = PxPoint::new(0.0, 0.0);
    // Steps of up to 4 px in parts of a 32nd; the least number of them is a number that is none.
    let step = |pair: &[u8]| {
        let part = |index: usize| pair.get(index).map_or(0.0, |byte| (f64::from(*byte) - 128.0) / 32.0);
        at = PxPoint::new(at.x + part(0), at.y + part(1));
        if pair == [0, 0] { PxPoint::new(f64::NAN, 0.0) } else { at }
    };
    let sites: Vec<PxPoint> = steps.chunks(2).take(MOST_SITES).map(step).collect();
    let bounded = Bounded::default().with_tolerance_px(tolerance_px);
    let straight = bounded.polyline(&sites, closed);
    for curve in [bounded.arcs(&sites, closed), bounded.cubics(&sites, closed)] {
        assert!(curve.vertices.len() <= straight.len().max(3), "{curve:?}");
        check(&curve, &sites, closed, tolerance_px + SLACK_PX);
    }
});

/// The half of the promise that is cheap to see: every site is near the curve, and its ends are the line's.
fn check(curve: &Curve, sites: &[PxPoint], closed: bool, limit_px: f64) {
    let sites: Vec<PxPoint> =
        sites.iter().copied().filter(|at| at.x.is_finite() && at.y.is_finite()).collect();
    let places = curve.chords(SLACK_PX);
    assert!(places.iter().all(|at| at.x.is_finite() && at.y.is_finite()), "{curve:?}");
    if !closed {
        assert_eq!((places.first(), places.last()), (sites.first(), sites.last()));
    }
    for site in &sites {
        let ends = places.iter().zip(places.iter().skip(1).chain(places.last()));
        let near = ends.map(|(from, to)| distance(*site, *from, *to)).fold(f64::INFINITY, f64::min);
        assert!(near <= limit_px + SLACK_PX, "{site:?} is {near} px off {curve:?}");
    }
}

fn distance(at: PxPoint, from: PxPoint, to: PxPoint) -> f64 {
    let (x, y) = (to.x - from.x, to.y - from.y);
    let squared = x * x + y * y;
    let along = (at.x - from.x) * x + (at.y - from.y) * y;
    let part = if squared > 0.0 { (along / squared).clamp(0.0, 1.0) } else { 0.0 };
    at.distance(PxPoint::new(from.x + part * x, from.y + part * y))
}
