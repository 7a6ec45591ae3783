//! The drawings of `plotter-motion/tests/all/drawings`, made as they are asked for, and one like the owl
//! there: short strokes.

use core::f64::consts::TAU;
use plotter_motion::{PlotOp, Point};

fn draw(first: bool, to: Point) -> PlotOp {
    if first { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } }
}

/// An Archimedean spiral of 4 turns, 250 segments each.
pub fn spiral() -> impl Iterator<Item = PlotOp> {
    (0..=1000).map(|index| {
        let turned = f64::from(index) / 250.0;
        let (radius, angle) = (1.0 + 2.95 * turned, TAU * turned);
        draw(index == 0, Point::new(70.0 + radius * libm::cos(angle), 70.0 + radius * libm::sin(angle)))
    })
}

/// 60 lines of 80 mm to and fro at a pitch of 1 mm, in one stroke.
pub fn hatch() -> impl Iterator<Item = PlotOp> {
    (0..120).map(|index| {
        let up = matches!(index % 4, 1 | 2);
        draw(index == 0, Point::new(f64::from(index / 2), if up { 80.0 } else { 0.0 }))
    })
}

/// Marsaglia's xorshift: the same row of numbers from 0 to 1 everywhere.
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

const SEED: u64 = 0x2545_F491_4F6C_DD1D;

/// 1000 segments of 0.1 to 5 mm in any direction, within 100 mm.
pub fn zigzag() -> impl Iterator<Item = PlotOp> {
    let (mut state, mut at) = (SEED, Point::new(50.0, 50.0));
    (0..=1000).map(move |index| {
        if index > 0 {
            let (length, angle) = (0.1 + 4.9 * random(&mut state), TAU * random(&mut state));
            let to = Point::new(at.x + length * libm::cos(angle), at.y + length * libm::sin(angle));
            at = Point::new(to.x.clamp(0.0, 100.0), to.y.clamp(0.0, 100.0));
        }
        draw(index == 0, at)
    })
}

/// 60 strokes of 15 segments of 0.2 to 1.5 mm that bend a little from one to the next, somewhere on 100 x 100
/// mm.
pub fn strokes() -> impl Iterator<Item = PlotOp> {
    let (mut state, mut at, mut heading) = (SEED, Point::ORIGIN, 0.0);
    (0..60 * 16).map(move |index| {
        let first = index % 16 == 0;
        if first {
            at = Point::new(100.0 * random(&mut state), 100.0 * random(&mut state));
            heading = TAU * random(&mut state);
        } else {
            heading += random(&mut state) - 0.5;
            let length = 0.2 + 1.3 * random(&mut state);
            at = Point::new(at.x + length * libm::cos(heading), at.y + length * libm::sin(heading));
        }
        draw(first, at)
    })
}
