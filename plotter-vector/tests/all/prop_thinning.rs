//! Laws of thinning: topology, width, idempotence, and how far a pixel's influence reaches.

use crate::law_cases::cases;
use plotter_vector::{
    Bitmap, Pixel,
    raster::{Thinned, Thinning, ThinningMethod},
};
use proptest::prelude::*;

/// More than any picture below needs.
const ENOUGH_PASSES: u32 = 200;

fn method() -> impl Strategy<Value = ThinningMethod> {
    prop_oneof![Just(ThinningMethod::GuoHall), Just(ThinningMethod::ZhangSuen)]
}

/// Noise with an eighth to seven eighths of ink.
fn noise() -> impl Strategy<Value = Bitmap> {
    (1_u32..90, 1_u32..40, 1_u8..8).prop_flat_map(|(width, height, eighths)| {
        prop::collection::vec(0_u8..8, (width * height) as usize).prop_map(move |levels| {
            let mut ink = Bitmap::new(width, height).unwrap();
            let places = (0..height).flat_map(|y| (0..width).map(move |x| Pixel::new(x, y)));
            places.zip(levels).for_each(|(at, level)| ink.set(at, level < eighths));
            ink
        })
    })
}

/// Up to seven strokes with round ends, 1 to 12 px wide, some of them off the sheet.
fn strokes() -> impl Strategy<Value = Bitmap> {
    let stroke = (-10.0..110.0, -10.0..70.0, -10.0..110.0, -10.0..70.0, 0.5..6.0);
    prop::collection::vec(stroke, 1..8).prop_map(|strokes| {
        let mut ink = Bitmap::new(100, 60).unwrap();
        for (ax, ay, bx, by, half) in strokes {
            let (dx, dy): (f64, f64) = (bx - ax, by - ay);
            for at in (0..60).flat_map(|y| (0..100).map(move |x| Pixel::new(x, y))) {
                let (x, y) = (f64::from(at.x) + 0.5 - ax, f64::from(at.y) + 0.5 - ay);
                let share: f64 = (x * dx + y * dy) / (dx * dx + dy * dy);
                let along = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
                if libm::hypot(x - along * dx, y - along * dy) <= half {
                    ink.set(at, true);
                }
            }
        }
        ink
    })
}

fn picture() -> impl Strategy<Value = Bitmap> {
    prop_oneof![noise(), strokes()]
}

/// A picture with a margin of paper, so that neighbours can be asked for and the paper around is one piece.
struct Framed {
    width: usize,
    cells: Vec<bool>,
}

impl Framed {
    fn new(ink: &Bitmap) -> Self {
        let width = ink.width() as usize + 2;
        let mut cells = vec![false; width * (ink.height() as usize + 2)];
        for at in ink.ink() {
            cells[(at.y as usize + 1) * width + at.x as usize + 1] = true;
        }
        Self { width, cells }
    }

    /// The component of each cell: 8-connected ink, 4-connected paper; and how many there are of each.
    fn components(&self) -> (Vec<usize>, usize, usize) {
        let mut label = vec![usize::MAX; self.cells.len()];
        let mut counts = [0, 0];
        let mut next = 0;
        for start in 0..self.cells.len() {
            if label[start] != usize::MAX {
                continue;
            }
            let ink = self.cells[start];
            let mut front = vec![start];
            label[start] = next;
            while let Some(at) = front.pop() {
                let (x, y) = (at % self.width, at / self.width);
                for v in y.saturating_sub(1)..=y + 1 {
                    for u in x.saturating_sub(1)..=(x + 1).min(self.width - 1) {
                        let cell = v * self.width + u;
                        let joined = ink || u == x || v == y;
                        if joined && self.cells.get(cell) == Some(&ink) && label[cell] == usize::MAX {
                            label[cell] = next;
                            front.push(cell);
                        }
                    }
                }
            }
            counts[usize::from(ink)] += 1;
            next += 1;
        }
        (label, counts[1], counts[0])
    }
}

/// 8-connected pieces of the ink around a pixel, where the pixel itself is not counted.
fn is_simple_and_no_end(skeleton: &Bitmap, at: Pixel) -> bool {
    // The 3 x 3 around as a picture of its own, with and without the middle.
    let mut patch = Bitmap::new(3, 3).unwrap();
    for (dx, dy) in (0..3).flat_map(|dy| (0..3).map(move |dx| (dx, dy))) {
        if let (Some(x), Some(y)) = ((at.x + dx).checked_sub(1), (at.y + dy).checked_sub(1)) {
            patch.set(Pixel::new(dx, dy), skeleton.get(Pixel::new(x, y)));
        }
    }
    let neighbours = patch.count() - 1;
    let sides = [(1, 0), (0, 1), (2, 1), (1, 2)].map(|(x, y)| patch.get(Pixel::new(x, y)));
    patch.set(Pixel::new(1, 1), false);
    let (_, pieces, _) = Framed::new(&patch).components();
    // With ink on all four sides deleting the pixel makes a hole.
    neighbours >= 2 && pieces == 1 && sides.contains(&false)
}

proptest! {
    #![proptest_config(cases(256))]
    #[test]
    fn each_component_of_ink_and_paper_keeps_its_one_skeleton(ink in picture(), method in method()) {
        let thinned = Thinning::default().with_method(method).with_max_passes(ENOUGH_PASSES).thin(&ink);
        prop_assume!(thinned.converged);
        let (before, after) = (Framed::new(&ink), Framed::new(&thinned.skeleton));
        let (labels_before, ink_before, paper_before) = before.components();
        let (labels_after, ink_after, paper_after) = after.components();
        prop_assert_eq!((ink_before, paper_before), (ink_after, paper_after));
        let mut partner = vec![usize::MAX; ink_before + paper_before];
        for cell in 0..before.cells.len() {
            prop_assert!(before.cells[cell] || !after.cells[cell], "ink where none was");
            if before.cells[cell] == after.cells[cell] {
                let (old, new) = (labels_before[cell], labels_after[cell]);
                prop_assert!(partner[new] == usize::MAX || partner[new] == old, "components flow together");
                partner[new] = old;
            }
        }
    }

    #[test]
    fn topology_holds_however_few_the_passes(ink in noise(), method in method(), max_passes in 0_u32..3) {
        let thinned = Thinning::default().with_method(method).with_max_passes(max_passes).thin(&ink);
        let (_, ink_before, paper_before) = Framed::new(&ink).components();
        let (_, ink_after, paper_after) = Framed::new(&thinned.skeleton).components();
        prop_assert_eq!((ink_before, paper_before), (ink_after, paper_after));
    }

    #[test]
    fn lines_are_one_pixel_wide(ink in picture(), method in method()) {
        let Thinned { skeleton, converged, .. } = Thinning::default().with_method(method).with_max_passes(ENOUGH_PASSES).thin(&ink);
        prop_assume!(converged);
        for at in skeleton.ink() {
            prop_assert!(!is_simple_and_no_end(&skeleton, at), "{at:?} could go:\n{skeleton}");
        }
    }

    #[test]
    fn thinning_again_changes_nothing(ink in picture(), first in method(), second in method()) {
        let once = Thinning::default().with_method(first).with_max_passes(ENOUGH_PASSES).thin(&ink);
        prop_assume!(once.converged);
        let twice = Thinning::default().with_method(second).with_max_passes(ENOUGH_PASSES).thin(&once.skeleton);
        // Once for each kind of pass.
        let passes = if second == ThinningMethod::GuoHall { 2 } else { 1 };
        prop_assert_eq!((twice.passes, twice.converged), (passes, true));
        prop_assert_eq!(twice.skeleton, once.skeleton);
    }

    #[test]
    fn drawings_converge(ink in strokes(), method in method()) {
        let thinning = Thinning::default().with_method(method);
        prop_assert!(thinning.thin(&ink).converged);
    }

    #[test]
    fn a_band_with_its_context_is_thinned_as_the_whole(
        seed in any::<u64>(), share in 16_u64..240, method in method(), max_passes in 0_u32..4, from in 0_u32..130,
    ) {
        const BAND: u32 = 30;
        let thinning = Thinning::default().with_method(method).with_max_passes(max_passes);
        let context = thinning.rows_of_context();
        let whole = blotches(70, 190, share, seed);
        let first = from.saturating_sub(context);
        let band = rows(&whole, first, (from + BAND + context).min(190));
        let (whole, band) = (thinning.thin(&whole).skeleton, thinning.thin(&band).skeleton);
        prop_assert_eq!(
            rows(&whole, from, from + BAND).to_string(),
            rows(&band, from - first, from - first + BAND).to_string()
        );
    }

    #[test]
    fn moved_ink_has_a_moved_skeleton(ink in picture(), method in method(), dx in 0_u32..70, dy in 0_u32..5) {
        let moved = |ink: &Bitmap| {
            let mut moved = Bitmap::new(ink.width() + dx, ink.height() + dy).unwrap();
            ink.ink().for_each(|at| moved.set(Pixel::new(at.x + dx, at.y + dy), true));
            moved
        };
        let thinning = Thinning::default().with_method(method).with_max_passes(ENOUGH_PASSES);
        prop_assert_eq!(thinning.thin(&moved(&ink)).skeleton, moved(&thinning.thin(&ink).skeleton));
    }
}

/// Noise made of blotches 1 to 8 px wide: thick ink, tips and holes at once.
fn blotches(width: u32, height: u32, share: u64, seed: u64) -> Bitmap {
    let mut ink = Bitmap::new(width, height).unwrap();
    let mut state = seed;
    let mut draw = move |below: u64| {
        // Knuth's multiplier and increment of MMIX.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        u32::try_from((state >> 40) % below).unwrap()
    };
    for _ in 0..share * 2 {
        let (x, y) = (draw(u64::from(width)), draw(u64::from(height)));
        let (w, h) = (draw(8), draw(8));
        let paper = draw(4) == 0;
        for at in (y..=y + h).flat_map(|v| (x..=x + w).map(move |u| Pixel::new(u, v))) {
            ink.set(at, !paper);
        }
    }
    ink
}

/// Rows `from..to` of a picture.
fn rows(ink: &Bitmap, from: u32, to: u32) -> Bitmap {
    let mut part = Bitmap::new(ink.width(), to - from).unwrap();
    for at in ink.ink().filter(|at| (from..to).contains(&at.y)) {
        part.set(Pixel::new(at.x, at.y - from), true);
    }
    part
}

/// All 65 536 pictures of 4 x 4 in one, 3 px of paper between them.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_picture_of_four_by_four_keeps_its_topology() {
    const PITCH: u32 = 7;
    let mut all = Bitmap::new(256 * PITCH, 256 * PITCH).unwrap();
    for pattern in 0..1_u32 << 16 {
        for bit in (0..16).filter(|bit| pattern >> bit & 1 == 1) {
            let (left, top) = (pattern % 256 * PITCH, pattern / 256 * PITCH);
            all.set(Pixel::new(left + bit % 4, top + bit / 4), true);
        }
    }
    let (labels_before, ink_before, paper_before) = Framed::new(&all).components();
    for method in [ThinningMethod::GuoHall, ThinningMethod::ZhangSuen] {
        let thinned = Thinning::default().with_method(method).thin(&all);
        assert!(thinned.converged);
        let after = Framed::new(&thinned.skeleton);
        let (labels_after, ink_after, paper_after) = after.components();
        assert_eq!((ink_after, paper_after), (ink_before, paper_before));
        // As many components as before, and each of the ink's holds one: no picture lost one to another.
        let pairs: std::collections::BTreeSet<(usize, usize)> = (0..after.cells.len())
            .filter(|cell| after.cells[*cell])
            .map(|cell| (labels_before[cell], labels_after[cell]))
            .collect();
        assert_eq!(pairs.len(), ink_before);
        for at in thinned.skeleton.ink() {
            assert!(!is_simple_and_no_end(&thinned.skeleton, at), "{at:?}");
        }
    }
}
