//! Laws of tracking, linking, joining and ordering.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by a panic and prints its table")]

use plotter_motion::{Point, Segment};
use plotter_vector::{
    Algorithm, Bitmap, Drawing, Figures, OrderedTracking, Pixel, PxPoint, Vectorizer, join, link, order,
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
    #[test]
    fn every_ink_pixel_is_in_exactly_one_figure_once(ink in pictures(), min_run in 0_usize..20) {
        let figures = OrderedTracking { min_run, ..OrderedTracking::default() }.track(&ink).unwrap();
        let mut all: Vec<Pixel> = ink.ink().collect();
        all.sort_unstable();
        prop_assert_eq!(sorted(&figures), all);
    }

    #[test]
    fn a_figure_is_a_chain_of_touching_pixels(ink in pictures()) {
        let figures = OrderedTracking::default().track(&ink).unwrap();
        for figure in figures.iter().chain(link(&figures).iter()) {
            prop_assert!(figure.windows(2).all(|pair| pair[0].touches(pair[1])));
        }
    }

    #[test]
    fn linking_keeps_every_pixel_and_never_adds_figures(ink in pictures()) {
        let figures = OrderedTracking::default().track(&ink).unwrap();
        let linked = link(&figures);
        prop_assert_eq!(sorted(&linked), sorted(&figures));
        prop_assert!(linked.len() <= figures.len());
    }

    #[test]
    fn joining_only_borrows_ink_that_touches(ink in pictures()) {
        let figures = link(&OrderedTracking::default().track(&ink).unwrap());
        let joined = join(&figures, &ink);
        for ((figure, whole), (head, tail)) in figures.iter().zip(joined.figures.iter()).zip(&joined.borrowed) {
            let own = usize::from(*head)..whole.len() - usize::from(*tail);
            prop_assert_eq!(&whole[own], figure);
            prop_assert!(whole.windows(2).all(|pair| pair[0].touches(pair[1])));
            prop_assert!(whole.iter().all(|pixel| ink.get(*pixel)));
        }
    }

    #[test]
    fn the_promise_holds_for_every_ink_pixel_of_any_picture(ink in pictures(), tolerance_px in 0.05..3.0_f64) {
        let mut vectorizer = Vectorizer::default();
        vectorizer.ours.tolerance_px = tolerance_px;
        let traced = vectorizer.trace(&ink).unwrap();
        prop_assert_eq!(traced.error.pixels, ink.count());
        prop_assert!(traced.error.max_px <= tolerance_px + ROUNDING_PX);
    }

    #[test]
    fn every_ink_pixel_lies_near_a_stroke_as_drawn(
        ink in pictures_below(24, 16),
        tolerance_px in 0.05..3.0_f64,
    ) {
        let mut vectorizer = Vectorizer::default();
        vectorizer.ours.tolerance_px = tolerance_px;
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
        let published = Vectorizer { algorithm: Algorithm::Published, ..Vectorizer::default() };
        prop_assert_eq!(published.trace(&ink).unwrap().error.pixels, ink.count());
    }

    #[test]
    fn ordering_keeps_the_strokes_and_never_lengthens_travel(
        strokes in proptest::collection::vec(proptest::collection::vec((0_u32..40, 0_u32..40), 1..4), 0..60)
    ) {
        let mut drawing = Drawing::new(40, 40);
        for stroke in &strokes {
            drawing.push(stroke.iter().map(|(x, y)| PxPoint::from(Pixel::new(*x, *y))));
        }
        let ordered = order(&drawing);
        prop_assert!(ordered.pen_up_px() <= drawing.pen_up_px());
        // A stroke and its reverse are the same ink.
        let multiset = |drawing: &Drawing| {
            let name = |stroke: &[PxPoint]| {
                let there = format!("{stroke:?}");
                let back = format!("{:?}", stroke.iter().rev().collect::<Vec<_>>());
                if there < back { there } else { back }
            };
            let mut names: Vec<String> = drawing.strokes().map(name).collect();
            names.sort();
            names
        };
        prop_assert_eq!(multiset(&ordered), multiset(&drawing));
    }

    #[test]
    fn the_next_stroke_is_the_nearest_one_left(ends in proptest::collection::vec((0_u32..30, 0_u32..30), 1..40)) {
        // Dots, so that only places matter; compared with a plain search unless the given order was better.
        let mut drawing = Drawing::new(30, 30);
        for (x, y) in &ends {
            drawing.push([PxPoint::from(Pixel::new(*x, *y))]);
        }
        let mut left: Vec<PxPoint> = drawing.strokes().map(|stroke| stroke[0]).collect();
        let mut greedy = Drawing::new(30, 30);
        let mut pen = left[0];
        while !left.is_empty() {
            let key = |at: &PxPoint| (at.x - pen.x) * (at.x - pen.x) + (at.y - pen.y) * (at.y - pen.y);
            let nearest = (0..left.len()).min_by(|a, b| key(&left[*a]).total_cmp(&key(&left[*b]))).unwrap();
            pen = left.remove(nearest);
            greedy.push([pen]);
        }
        let best = greedy.pen_up_px().min(drawing.pen_up_px());
        prop_assert!((order(&drawing).pen_up_px() - best).abs() <= ROUNDING_PX);
    }
}
