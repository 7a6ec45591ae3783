//! Laws of tracking.

use crate::law_cases::cases;
use plotter_motion::{Point, Segment};
use plotter_vector::{
    Bitmap, Ours, Pixel, PxPoint, Vectorizer,
    picture::Figures,
    raster::{OrderedTracking, Thinning},
};
use proptest::prelude::*;

/// Rounding of a sum of a few hundred lengths, px.
const ROUNDING_PX: f64 = 1e-9;

fn pictures() -> impl Strategy<Value = Bitmap> {
    pictures_below(90, 24)
}

fn pictures_below(width: u32, height: u32) -> impl Strategy<Value = Bitmap> {
    (1..width, 1..height, 0.02..0.98_f64).prop_flat_map(|(width, height, ink)| {
        let count = (width * height) as usize;
        proptest::collection::vec(proptest::bool::weighted(ink), count).prop_map(move |marks| {
            let mut bitmap = Bitmap::new(width, height).unwrap();
            for (index, _) in (0..).zip(&marks).filter(|(_, mark)| **mark) {
                bitmap.set(Pixel::new(index % width, index / width), true);
            }
            bitmap
        })
    })
}

fn sorted(figures: &Figures) -> Vec<Pixel> {
    let mut pixels: Vec<Pixel> = figures.iter().flatten().copied().collect();
    pixels.sort_unstable();
    pixels
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn every_ink_pixel_is_in_exactly_one_figure_once(ink in pictures(), min_run in 0_usize..20) {
        let figures = OrderedTracking::default().with_min_run(min_run).track(&ink).unwrap();
        let mut all: Vec<Pixel> = ink.ink().collect();
        all.sort_unstable();
        prop_assert_eq!(sorted(&figures), all);
    }

    #[test]
    fn a_figure_is_a_chain_of_touching_pixels(ink in pictures()) {
        let figures = OrderedTracking::default().track(&ink).unwrap();
        for figure in figures.iter() {
            prop_assert!(figure.windows(2).all(|pair| pair[0].touches(pair[1])));
        }
    }

    #[test]
    fn the_promise_holds_for_every_pixel_of_lines_one_pixel_wide(
        ink in pictures(),
        tolerance_px in 0.05..3.0_f64,
    ) {
        let ink = Thinning::default().thin(&ink).skeleton;
        let vectorizer = Vectorizer::from(Ours::default().with_tolerance_px(tolerance_px));
        let traced = vectorizer.trace(&ink).unwrap();
        prop_assert_eq!(traced.error.pixels, ink.count());
        prop_assert!(traced.error.max_px <= tolerance_px + ROUNDING_PX);
    }

    #[test]
    fn every_ink_pixel_lies_near_a_stroke_as_drawn(
        ink in pictures_below(24, 16),
        tolerance_px in 0.05..3.0_f64,
    ) {
        let ink = Thinning::default().thin(&ink).skeleton;
        let vectorizer = Vectorizer::from(Ours::default().with_tolerance_px(tolerance_px));
        let drawing = vectorizer.trace(&ink).unwrap().drawing;
        let place = |at: &PxPoint| Point::new(at.x, at.y);
        let mut segments = Vec::new();
        for stroke in drawing.strokes() {
            // A dot is a segment from its place to its place.
            segments.extend(stroke.first().map(|dot| Segment::new(place(dot), place(dot))));
            segments.extend(stroke.windows(2).map(|pair| Segment::new(place(&pair[0]), place(&pair[1]))));
        }
        for pixel in ink.ink() {
            let centre = place(&PxPoint::from(pixel));
            let near = segments.iter().any(|line| line.distance(centre) <= tolerance_px + ROUNDING_PX);
            prop_assert!(near, "{pixel:?} of\n{ink}");
        }
    }

    #[test]
    fn published_counts_every_ink_pixel_too(ink in pictures()) {
        let published = Vectorizer::published();
        prop_assert_eq!(published.trace(&ink).unwrap().error.pixels, ink.count());
    }
}
