//! Laws of the way from grey levels to clean ink.

use super::{Polarity, Survey, Threshold, ThresholdMethod, despeckle, speckle::context_rows};
use crate::picture::{Bitmap, Gray, Pixel};
use proptest::prelude::*;

/// A picture of lines and noise: a few levels, so that there are shapes.
fn picture() -> impl Strategy<Value = Gray> {
    (1_u32..150, 1_u32..60)
        .prop_flat_map(|(width, height)| {
            let levels = prop::collection::vec(
                prop_oneof![6 => 180_u8..=255, 2 => 0_u8..=60, 1 => any::<u8>()],
                (width * height) as usize,
            );
            (Just(width), Just(height), levels)
        })
        .prop_map(|(width, height, levels)| Gray::new(width, height, levels).unwrap())
}

fn ink() -> impl Strategy<Value = Bitmap> {
    (1_u32..140, 1_u32..50, 1_u32..10).prop_flat_map(|(width, height, tenths)| {
        prop::collection::vec(0_u32..10, (width * height) as usize).prop_map(move |marks| {
            let mut ink = Bitmap::new(width, height).unwrap();
            for (i, mark) in (0..).zip(marks) {
                ink.set(Pixel::new(i % width, i / width), mark < tenths);
            }
            ink
        })
    })
}

fn threshold() -> impl Strategy<Value = Threshold> {
    let method = prop_oneof![
        Just(ThresholdMethod::Otsu),
        Just(ThresholdMethod::Adaptive),
        any::<u8>().prop_map(ThresholdMethod::Level)
    ];
    let polarity = prop_oneof![Just(Polarity::Minority), Just(Polarity::DarkInk), Just(Polarity::LightInk)];
    (method, polarity, 0_u32..40, 0_u8..60).prop_map(|(method, polarity, window_px, min_contrast)| {
        Threshold { polarity, method, window_px, min_contrast, keep_pale: false }
    })
}

/// The components of a colour, by flooding.
fn components(ink: &Bitmap, of_ink: bool) -> Vec<Vec<Pixel>> {
    let (width, height) = (ink.width(), ink.height());
    let mut seen = Bitmap::new(width, height).unwrap();
    let mut found = Vec::new();
    for start in (0..height).flat_map(|y| (0..width).map(move |x| Pixel::new(x, y))) {
        let mut component = Vec::new();
        let mut open = vec![start];
        while let Some(at) = open.pop() {
            if at.x >= width || at.y >= height || ink.get(at) != of_ink || seen.get(at) {
                continue;
            }
            seen.set(at, true);
            component.push(at);
            for (dx, dy) in (0..3).flat_map(|dy| (0..3).map(move |dx| (dx, dy))) {
                if of_ink || dx == 1 || dy == 1 {
                    open.push(Pixel::new((at.x + dx).wrapping_sub(1), (at.y + dy).wrapping_sub(1)));
                }
            }
        }
        if !component.is_empty() {
            found.push(component);
        }
    }
    found
}

/// What [`despeckle`] says, word for word.
fn despeckled_slowly(ink: &Bitmap, smallest_px: u32) -> Bitmap {
    let mut clean = ink.clone();
    for mark in components(ink, true).iter().filter(|mark| mark.len() < smallest_px as usize) {
        mark.iter().for_each(|at| clean.set(*at, false));
    }
    let border =
        |at: &Pixel| at.x == 0 || at.y == 0 || at.x + 1 == clean.width() || at.y + 1 == clean.height();
    let holes = components(&clean, false);
    let holes: Vec<_> =
        holes.iter().filter(|hole| hole.len() < smallest_px as usize && !hole.iter().any(border)).collect();
    holes.into_iter().flatten().for_each(|at| clean.set(*at, true));
    clean
}

fn rows_of(ink: &Bitmap, from: u32, to: u32) -> Bitmap {
    let mut rows = Bitmap::new(ink.width(), to - from).unwrap();
    for at in ink.ink().filter(|at| (from..to).contains(&at.y)) {
        rows.set(Pixel::new(at.x, at.y - from), true);
    }
    rows
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn row_by_row_gives_the_ink_of_the_whole_picture(gray in picture(), threshold in threshold()) {
        let (whole, split) = threshold.apply(&gray);
        let mut survey = Survey::checked(threshold, gray.width(), gray.height());
        gray.rows().for_each(|levels| survey.push(levels));
        let rows = survey.finish();
        prop_assert_eq!(rows.is_some(), split.is_some());
        for (y, levels) in (0..).zip(gray.rows()) {
            let mut ink = vec![0; whole.row(y).len()];
            if let Some(rows) = &rows {
                rows.row(y, levels, &mut ink);
            }
            prop_assert_eq!(&ink, whole.row(y));
        }
        if let (Some(rows), Some(split)) = (rows, split) {
            prop_assert_eq!(rows.split(whole.count()), split);
        }
    }

    /// In even light of full paper the adaptive level is a level like any other.
    #[test]
    fn the_ink_of_a_negative_is_that_of_the_picture(gray in picture(), window_px in 8_u32..40) {
        let negative = gray.pixels().iter().map(|level| 255 - level).collect();
        let negative = Gray::new(gray.width(), gray.height(), negative).unwrap();
        let with = |polarity| Threshold { polarity, window_px, method: ThresholdMethod::Adaptive, ..Threshold::default() };
        let (dark, _) = with(Polarity::DarkInk).apply(&gray);
        let (light, _) = with(Polarity::LightInk).apply(&negative);
        prop_assert_eq!(dark.to_string(), light.to_string());
    }

    #[test]
    fn small_components_go_and_nothing_else(ink in ink(), smallest_px in 0_u32..30) {
        let mut clean = ink.clone();
        despeckle(&mut clean, smallest_px);
        prop_assert_eq!(clean.to_string(), despeckled_slowly(&ink, smallest_px).to_string());
        let again = despeckle(&mut clean.clone(), smallest_px);
        prop_assert_eq!((again.removed_px, again.filled_px), (0, 0));
    }

    #[test]
    fn a_band_with_its_context_comes_out_as_in_the_whole(
        ink in ink(), smallest_px in 0_u32..9, from in 0_u32..50, rows in 1_u32..9,
    ) {
        let (from, to) = (from.min(ink.height()), (from + rows).min(ink.height()));
        let context = context_rows(smallest_px);
        let (top, bottom) = (from.saturating_sub(context), (to + context).min(ink.height()));
        let mut band = rows_of(&ink, top, bottom);
        despeckle(&mut band, smallest_px);
        let mut whole = ink.clone();
        despeckle(&mut whole, smallest_px);
        prop_assert_eq!(rows_of(&band, from - top, to - top).to_string(), rows_of(&whole, from, to).to_string());
    }
}
