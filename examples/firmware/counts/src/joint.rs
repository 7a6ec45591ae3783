//! A sheet told from 16 crossings: all marks where they are, and some of them dust.

use crate::counter::{Counter, Tally};
use core::hint::black_box;
use plotter_motion::{Axis, Vec2};
use plotter_stitch::{Crossing, FitError, FrameTransform, JointEstimate, RigidFit, sense::Found};

/// The layout of `ReferenceLines::strip16`, without a heap.
fn crossings() -> [Crossing; 16] {
    // How far each mark is moved from its row, in steps of 0.65 mm: powers of 2 mod 11, less 5.5, and of 3
    // mod 7, less 3.5.
    const MOVED: [f64; 16] =
        [-4.5, -3.5, -1.5, 2.5, -0.5, 4.5, 3.5, 1.5, -2.5, 0.5, -2.5, -0.5, -1.5, 2.5, 0.5, 1.5];
    core::array::from_fn(|index| {
        let (axis, row_mm, scan_at_mm) = if index < 10 {
            (Axis::Y, [-34.0, -8.0, 18.0, 44.0, 70.0][index / 2], [-32.0, 2032.0][index % 2])
        } else {
            (Axis::X, [-10.0, 2010.0][(index - 10) / 3], [-21.0, 31.0, 57.0][(index - 10) % 3])
        };
        Crossing { axis, mark_mm: row_mm + 0.65 * MOVED[index], scan_at_mm }
    })
}

#[inline(never)]
fn estimate(fit: &RigidFit, crossings: &[Crossing], found: &[Found]) -> Result<JointEstimate, FitError> {
    fit.estimate(crossings, found)
}

/// Counts the estimates of a hundred joints with so many grains of dust each, and how many told nothing.
pub fn joints(counter: &Counter, dust: usize) -> (Tally, u32) {
    let (crossings, fit) = (crossings(), RigidFit::default());
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    // Evenly spread about zero.
    let mut random = |most: f64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        most * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let (mut tally, mut silent) = (Tally::default(), 0);
    for _ in 0..100 {
        let shift = Vec2::new(random(5.0), random(5.0));
        let Ok(sheet) = FrameTransform::new(random(0.002), shift) else { continue };
        let mut found = [Found { crossing: 0, at_mm: 0.0, sigma_mm: 0.006 }; 16];
        for (index, place) in found.iter_mut().enumerate() {
            (place.crossing, place.at_mm) = (index, crossings[index].place_mm(&sheet) + random(0.025));
        }
        for grain in 0..dust {
            // Five apart: never the same crossing twice, and of both axes.
            found[(2 + 5 * grain) % 16].at_mm += 6.0 + random(5.0);
        }
        let (told, instructions) =
            counter.count(|| estimate(black_box(&fit), black_box(&crossings), black_box(&found)));
        silent += u32::from(told.is_err());
        tally.add(instructions);
    }
    (tally, silent)
}
