//! Laws of lines that are followed one by one.

use crate::law_cases::cases;
use crate::random::Random;
use plotter_vector::{Drawing, PxPoint, report::followed_lines};
use proptest::prelude::*;

/// From sample to sample a way within the bound is judged an eighth of it apart: what uses nearly all of it
/// may be missed.
const SURE: f64 = 0.99;

/// A wavy line from left to right at this height; the same waves for all.
fn wavy(y: f64, is_reversed: bool) -> Vec<PxPoint> {
    let mut places: Vec<_> = (0..=60)
        .map(|step| {
            let x = 20.0 + 5.0 * f64::from(step);
            PxPoint::new(x, y + 30.0 * libm::sin(0.02 * x))
        })
        .collect();
    if is_reversed {
        places.reverse();
    }
    places
}

/// So many of these rows can have one of those each, none farther than the bound: by trying each row's
/// alternatives.
fn most_matched(rows: &[f64], drawn: &[f64], bound: f64) -> usize {
    fn seek(
        row: usize,
        rows: &[f64],
        drawn: &[f64],
        bound: f64,
        seen: &mut [bool],
        of: &mut [Option<usize>],
    ) -> bool {
        for at in 0..drawn.len() {
            if (rows[row] - drawn[at]).abs() > bound || seen[at] {
                continue;
            }
            seen[at] = true;
            if of[at].is_none_or(|other| seek(other, rows, drawn, bound, seen, of)) {
                of[at] = Some(row);
                return true;
            }
        }
        false
    }
    let mut of = vec![None; drawn.len()];
    (0..rows.len())
        .filter(|row| seek(*row, rows, drawn, bound, &mut vec![false; drawn.len()], &mut of))
        .count()
}

proptest! {
    #![proptest_config(cases(24))]

    /// Of lines side by side as many are followed as can have a drawn one each.
    #[test]
    fn as_many_lines_are_followed_as_there_are_ways_for(
        gaps in proptest::collection::vec(3.0..8.0_f64, 1..8),
        drawn in proptest::collection::vec((0.0..60.0_f64, any::<bool>()), 0..9),
        bound_px in 2.0..12.0_f64,
    ) {
        let mut y = 100.0;
        let rows: Vec<f64> = gaps.iter().map(|gap| { y += gap; y }).collect();
        let heights: Vec<f64> = drawn.iter().map(|(off, _)| 98.0 + off).collect();
        let mut scan = Drawing::new(400, 300);
        rows.iter().for_each(|y| scan.push(wavy(*y, false)));
        let mut ink = Drawing::new(400, 300);
        for ((_, is_reversed), y) in drawn.iter().zip(&heights) {
            ink.push(wavy(*y, *is_reversed));
        }
        let followed = followed_lines(&scan, &ink, bound_px);
        prop_assert_eq!(followed.lines, rows.len());
        // Lines of one shape at two heights are nearer than the heights are apart, where they are steep: by 1
        // / sqrt(1 + 0.6^2) at most, so what is matched by height at the bound is sure, and what is not even
        // so is out.
        let least = most_matched(&rows, &heights, SURE * bound_px);
        let most = most_matched(&rows, &heights, bound_px * 1.0_f64.hypot(0.6));
        let told = format!("{rows:?} {heights:?}");
        prop_assert!((least..=most).contains(&followed.followed()), "{} of {least}..={most}: {told}", followed.followed());
        for start in &followed.dropped {
            let y = start.y - 30.0 * libm::sin(0.02 * start.x);
            prop_assert!(heights.iter().all(|there| (y - there).abs() > SURE * bound_px), "dropped at {y}: {told}");
        }
    }

    /// A drawing whose vertices each move by less than the bound is followed, in whatever order and sense it
    /// is drawn; of strokes that are left out each breaks a line.
    #[test]
    fn what_is_drawn_is_followed_and_what_is_left_out_is_missed(seed in 1_u64.., left_out in 0_usize..4) {
        const BOUND_PX: f64 = 3.0;
        let mut random = Random(seed);
        // One stroke in each square of 60 px, so that none comes near another.
        let strokes: Vec<Vec<PxPoint>> = (0..16)
            .map(|square| {
                let (column, row) = (f64::from(square % 4), f64::from(square / 4));
                (0..5).map(|_| PxPoint::new(60.0 * column + 45.0 * random.unit(), 60.0 * row + 45.0 * random.unit())).collect()
            })
            .collect();
        let mut scan = Drawing::new(240, 240);
        strokes.iter().for_each(|stroke| scan.push(stroke.iter().copied()));
        let mut ink = Drawing::new(240, 240);
        for stroke in strokes.iter().skip(left_out).rev() {
            ink.push(stroke.iter().rev().map(|at| {
                let mut moved = || 1.3 * (2.0 * random.unit() - 1.0);
                PxPoint::new(at.x + moved(), at.y + moved())
            }));
        }
        let followed = followed_lines(&scan, &ink, BOUND_PX);
        let first_row = |at: &PxPoint| at.y < 60.0 && at.x < 60.0 * f64::from(u32::try_from(left_out).unwrap());
        prop_assert!(followed.dropped.iter().filter(|at| first_row(at)).count() >= left_out, "{followed:?}");
        prop_assert!(followed.dropped.iter().all(first_row), "{followed:?}");
        // Pieces of a stroke that crosses itself may be too short to tell.
        prop_assert!(followed.merged.len() * 10 <= followed.lines, "{followed:?}");
    }
}
