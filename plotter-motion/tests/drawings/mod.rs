//! The drawings on which planning is measured.
#![allow(dead_code, reason = "each test takes what it needs")]

use core::f64::consts::TAU;
use plotter_motion::{PlotOp, Point, circle};

/// A drawing with its name.
pub struct Drawing {
    pub name: &'static str,
    pub ops: Vec<PlotOp>,
}

fn polyline(points: impl IntoIterator<Item = Point>) -> Vec<PlotOp> {
    let mut ops = Vec::new();
    for to in points {
        ops.push(if ops.is_empty() { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } });
    }
    ops
}

/// An Archimedean spiral about (70, 70) mm: 20 turns, radius 1 to 60 mm, 5000 segments.
pub fn spiral() -> Drawing {
    let points = (0..=5000).map(|index| {
        let share = f64::from(index) / 5000.0;
        let (radius, angle) = (1.0 + 59.0 * share, 20.0 * TAU * share);
        Point::new(70.0 + radius * libm::cos(angle), 70.0 + radius * libm::sin(angle))
    });
    Drawing { name: "spiral", ops: polyline(points) }
}

/// 60 x 80 mm hatched to and fro at a pitch of 1 mm, in one stroke.
pub fn hatch() -> Drawing {
    let points = (0..60).flat_map(|index| {
        let (x, up) = (f64::from(index), index % 2 == 0);
        let (from, to) = if up { (0.0, 80.0) } else { (80.0, 0.0) };
        [Point::new(x, from), Point::new(x, to)]
    });
    Drawing { name: "hatch", ops: polyline(points) }
}

/// 1000 segments of 0.1 to 5 mm in seeded directions, within about 100 mm.
pub fn zigzag() -> Drawing {
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
    let mut random = move || {
        // Marsaglia's xorshift: the same row of numbers everywhere.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
        share
    };
    let mut at = Point::new(50.0, 50.0);
    let mut points = vec![at];
    for _ in 0..1000 {
        let (length, angle) = (0.1 + 4.9 * random(), TAU * random());
        let to = Point::new(at.x + length * libm::cos(angle), at.y + length * libm::sin(angle));
        at = Point::new(to.x.clamp(0.0, 100.0), to.y.clamp(0.0, 100.0));
        points.push(at);
    }
    Drawing { name: "zigzag", ops: polyline(points) }
}

/// A circle of 300 points, radius 20 mm about (50, 50) mm.
pub fn circle_of_300() -> Drawing {
    Drawing { name: "circle", ops: circle(Point::new(50.0, 50.0), 20.0, 300).collect() }
}

/// The drawings that are built here.
pub fn built() -> [Drawing; 4] {
    [spiral(), hatch(), zigzag(), circle_of_300()]
}
