//! With the feature `rayon`: the same result with any number of threads.
#![cfg(feature = "rayon")]
#![allow(clippy::cast_possible_truncation, reason = "a failure shows, and levels are made to fit")]

use plotter_vector::{
    Bitmap, Gray, Ours, Progress, Threshold, ThresholdMethod, Vectorizer, ink::despeckle, picture::BitmapRows,
};

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_number_of_threads_changes_nothing() {
    let (width, height) = (700, 1300);
    // Lines, and noise of all sizes.
    let level = |i: u32| match (i % width, i / width) {
        (x, y) if x % 97 < 3 || y % 89 < 3 => 30,
        (x, y) if (x * 31 + y * 17) % 101 < 2 || (x ^ y) % 61 == 7 => 50,
        (x, y) => 200 + (x * 13 + y * 7) % 31 - y / 20,
    };
    let levels = (0..width * height).map(|i| level(i) as u8).collect();
    let gray = Gray::new(width, height, levels).unwrap();
    for method in [ThresholdMethod::Auto, ThresholdMethod::Otsu, ThresholdMethod::Adaptive] {
        let threshold = Threshold::default().with_method(method);
        let mut results = [1, 2, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (mut ink, split) = threshold.apply(&gray);
                let changed = despeckle(&mut ink, 9);
                (ink, split, changed)
            })
        });
        // By itself dirt is left out before it is ink.
        assert!(results[0].2.removed_px > 0 || method == ThresholdMethod::Auto);
        results.rotate_left(1);
        assert!(results.windows(2).all(|pair| pair[0] == pair[1]));
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_sheet_by_rows_is_the_same_on_any_number_of_threads() {
    // Long enough for cuts: upright and slanted lines, and a frame.
    let line = |y: usize| {
        let row: String = (0..160)
            .map(|x| {
                let slanted = (x + y / 60) % 53 < 4;
                let frame = (8..152).contains(&x) && (100..8900).contains(&y);
                let inside = (12..148).contains(&x) && (104..8896).contains(&y);
                if slanted && inside || frame && !inside { '#' } else { '.' }
            })
            .collect();
        row + "\n"
    };
    let ink = Bitmap::from_picture(&(0..9000).map(line).collect::<String>()).unwrap();
    let vectorizer = Vectorizer::from(Ours::default().with_band_rows(500));
    let sheets = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut rows = BitmapRows::new(&ink);
            vectorizer.vectorize_rows_with_errors(&mut rows, &mut Progress::silent()).unwrap()
        })
    });
    assert!(sheets[0].drawing.vertices() > 20);
    assert!(sheets[0].errors.as_ref().is_some_and(|errors| errors.report.mean_px > 0.0));
    assert!(sheets.iter().all(|sheet| *sheet == sheets[0]));
}
