//! Laws of the simplification with a promised error.

use crate::figure::Figure;
use crate::law_cases::cases;
use plotter_vector::{
    Pixel,
    report::ErrorTally,
    stroke::{Bounded, DynamicThreshold, Simplify},
};
use proptest::prelude::*;

static OF_TOLERANCE: Figure = Figure::of("of the tolerance");

/// What the tolerance may be missed by, px: the library adds as much so that "exactly on it" passes.
const ROUNDING_PX: f64 = 1e-8;

/// What the library itself adds to the tolerance, px: the plain search must allow what it allows.
const ADDED_PX: f64 = 1e-9;

/// Rounding of a sum of squares, px².
const ROUNDING_PX2: f64 = 1e-6;

/// A walk over neighbouring pixels that tends to go on as it went, like a drawn line; it may cross itself.
fn walks(longest: usize) -> impl Strategy<Value = Vec<Pixel>> {
    proptest::collection::vec((0_usize..8, 0_u8..10), 0..longest).prop_map(|steps| {
        const ROUND: [(i32, i32); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        let mut direction = 0;
        let mut at = (500, 500);
        let mut walk = vec![at];
        for (turn, straight) in steps {
            direction = match straight {
                0..=4 => direction,
                5..=6 => (direction + 1) % 8,
                7..=8 => (direction + 7) % 8,
                _ => turn,
            };
            at = (at.0 + ROUND[direction].0, at.1 + ROUND[direction].1);
            walk.push(at);
        }
        walk.into_iter().map(|(x, y)| Pixel::new(x.unsigned_abs(), y.unsigned_abs())).collect()
    })
}

fn distance(pixel: Pixel, from: Pixel, to: Pixel) -> f64 {
    let of = |pixel: Pixel| plotter_motion::Point::new(f64::from(pixel.x), f64::from(pixel.y));
    plotter_motion::Segment::new(of(from), of(to)).distance(of(pixel))
}

fn line_square(pixel: Pixel, from: Pixel, to: Pixel) -> f64 {
    let (x, y) = (f64::from(to.x) - f64::from(from.x), f64::from(to.y) - f64::from(from.y));
    let (u, v) = (f64::from(pixel.x) - f64::from(from.x), f64::from(pixel.y) - f64::from(from.y));
    let square = x * x + y * y;
    if square > 0.0 { (x * v - y * u) * (x * v - y * u) / square } else { u * u + v * v }
}

/// Squared distances to the line of one segment, or nothing when a pixel breaks the tolerance.
fn segment_cost(walk: &[Pixel], from: usize, to: usize, tolerance_px: f64) -> Option<f64> {
    let between = &walk[from + 1..to];
    let near = between.iter().all(|pixel| distance(*pixel, walk[from], walk[to]) <= tolerance_px + ADDED_PX);
    near.then(|| between.iter().map(|pixel| line_square(*pixel, walk[from], walk[to])).sum())
}

/// Segments and squares of the best polyline, by trying every one: all ways to choose the vertices between.
fn exhaustive(walk: &[Pixel], tolerance_px: f64) -> (usize, f64) {
    let last = walk.len() - 1;
    let mut best = (usize::MAX, f64::INFINITY);
    for chosen in 0_u32..1 << (last - 1) {
        let vertices: Vec<usize> =
            (0..=last).filter(|i| *i == 0 || *i == last || chosen >> (i - 1) & 1 == 1).collect();
        let costs: Option<Vec<f64>> =
            vertices.windows(2).map(|pair| segment_cost(walk, pair[0], pair[1], tolerance_px)).collect();
        if let Some(costs) = costs {
            let found = (costs.len(), costs.iter().sum());
            if found < best {
                best = found;
            }
        }
    }
    best
}

fn tolerances() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.0), Just(0.5), Just(1.0), 0.05..4.0_f64]
}

proptest! {
    // Some of the ways to miss the best polyline show in one walk of a thousand only.
    #![proptest_config(cases(5000))]

    #[test]
    fn no_polyline_within_the_tolerance_is_better(walk in walks(13), tolerance_px in tolerances()) {
        prop_assume!(walk.len() > 1);
        let kept = Bounded::default().with_tolerance_px(tolerance_px).keep(&walk);
        let squares: f64 =
            kept.windows(2).map(|pair| segment_cost(&walk, pair[0], pair[1], tolerance_px).unwrap()).sum();
        let (segments, least) = exhaustive(&walk, tolerance_px);
        prop_assert_eq!(kept.len() - 1, segments);
        prop_assert!((squares - least).abs() <= ROUNDING_PX2, "{squares} px² where {least} px² are possible");
    }
}

proptest! {
    #[test]
    fn vertices_are_pixels_in_order_with_both_ends(walk in walks(300), tolerance_px in tolerances()) {
        let kept = Bounded::default().with_tolerance_px(tolerance_px).keep(&walk);
        prop_assert_eq!((kept[0], kept[kept.len() - 1]), (0, walk.len() - 1));
        prop_assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn no_pixel_is_farther_from_its_segment_than_promised(walk in walks(400), tolerance_px in tolerances()) {
        let kept = Bounded::default().with_tolerance_px(tolerance_px).keep(&walk);
        for pair in kept.windows(2) {
            for pixel in &walk[pair[0]..pair[1]] {
                let error = distance(*pixel, walk[pair[0]], walk[pair[1]]);
                OF_TOLERANCE.note(if tolerance_px > 0.0 { error / tolerance_px } else { 0.0 });
                prop_assert!(error <= tolerance_px + ROUNDING_PX, "{error} px off");
            }
        }
    }

    #[test]
    fn never_more_vertices_than_published_at_its_own_greatest_error(walk in walks(300)) {
        let published = DynamicThreshold::default().keep(&walk);
        let mut tally = ErrorTally::default();
        tally.add(&walk, &published, (false, false));
        let ours = Bounded::default().with_tolerance_px(tally.report().max_px).keep(&walk);
        prop_assert!(ours.len() <= published.len());
    }

    #[test]
    fn any_pixels_at_all_are_simplified_without_a_panic(
        pixels in proptest::collection::vec((any::<u32>(), any::<u32>()), 0..40),
        tolerance_px in prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-1.0), 0.0..1e10_f64],
    ) {
        let pixels: Vec<Pixel> = pixels.into_iter().map(|(x, y)| Pixel::new(x, y)).collect();
        let kept = Bounded::default().with_tolerance_px(tolerance_px).keep(&pixels);
        prop_assert_eq!(kept.is_empty(), pixels.is_empty());
        let published = DynamicThreshold::default().keep(&pixels);
        prop_assert_eq!(published.last(), kept.last());
    }
}
