//! The drawings on which planning is measured.
#![allow(dead_code, clippy::cast_possible_truncation, reason = "each test takes what it needs")]

use crate::real_files::other;
use core::f64::consts::TAU;
use plotter_motion::{PlotOp, Point, gcode, hpgl};

/// A drawing with its name.
pub(crate) struct Drawing {
    pub(crate) name: &'static str,
    pub(crate) ops: Vec<PlotOp>,
}

fn polyline(points: impl IntoIterator<Item = Point>) -> Vec<PlotOp> {
    let mut ops = Vec::new();
    for to in points {
        ops.push(if ops.is_empty() { PlotOp::Travel { to } } else { PlotOp::Draw { to, feed_mm_s: None } });
    }
    ops
}

/// An Archimedean spiral about (70, 70) mm: radius from 1 mm on, 2.95 mm more and 250 segments a turn; with
/// 20 turns to 60 mm.
pub(crate) fn spiral(turns: u32) -> Drawing {
    let points = (0..=250 * turns).map(|index| {
        let turned = f64::from(index) / 250.0;
        let (radius, angle) = (1.0 + 2.95 * turned, TAU * turned);
        Point::new(70.0 + radius * libm::cos(angle), 70.0 + radius * libm::sin(angle))
    });
    Drawing { name: "spiral", ops: polyline(points) }
}

/// Lines of 80 mm to and fro at a pitch of 1 mm, in one stroke; with 60 of them 60 x 80 mm.
pub(crate) fn hatch(lines: u32) -> Drawing {
    let points = (0..lines).flat_map(|index| {
        let (x, up) = (f64::from(index), index % 2 == 0);
        let (from, to) = if up { (0.0, 80.0) } else { (80.0, 0.0) };
        [Point::new(x, from), Point::new(x, to)]
    });
    Drawing { name: "hatch", ops: polyline(points) }
}

/// Numbers from 0 to 1 by a seed.
pub(crate) fn chance(seed: u64) -> impl FnMut() -> f64 {
    // Any number but 0 is the state of the generator.
    let mut state = 0x2545_F491_4F6C_DD1D_u64 ^ seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    move || {
        // Marsaglia's xorshift: the same row of numbers everywhere.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        #[expect(clippy::cast_precision_loss, reason = "53 bits")]
        let share = (state >> 11) as f64 / (1_u64 << 53) as f64;
        share
    }
}

/// A job of some thirty lines and arcs, with travels between and a feed now and then.
pub(crate) fn job(random: &mut impl FnMut() -> f64) -> Vec<PlotOp> {
    let mut at = Point::ORIGIN;
    let mut heading = 0.0;
    let mut ops = Vec::new();
    for _ in 0..30 {
        let kind = random();
        // Slight turns and any.
        heading += if random() < 0.6 { random() - 0.5 } else { TAU * random() };
        let ahead = |length: f64| plotter_motion::Vec2::new(length, 0.0).rotated(heading);
        let feed_mm_s = (random() < 0.2).then(|| 5.0 + 100.0 * random());
        let op = if kind < 0.1 {
            PlotOp::Travel { to: at + ahead(2.0 * random()) }
        } else if kind < 0.35 {
            let (centre, sweep_rad) = (at + ahead(0.1 + 3.0 * random()), 8.0 * random() - 4.0);
            PlotOp::DrawArc { centre, sweep_rad, to: centre + (at - centre).rotated(sweep_rad), feed_mm_s }
        } else {
            PlotOp::Draw { to: at + ahead(3.0 * random().powi(3)), feed_mm_s }
        };
        at = op.target().unwrap_or(at);
        ops.push(op);
    }
    ops
}

/// Seeded segments of 0.1 to 5 mm in any direction, within 100 mm.
pub(crate) fn zigzag(segments: u32) -> Drawing {
    let mut random = chance(0);
    let mut at = Point::new(50.0, 50.0);
    let mut points = vec![at];
    for _ in 0..segments {
        let (length, angle) = (0.1 + 4.9 * random(), TAU * random());
        let to = Point::new(at.x + length * libm::cos(angle), at.y + length * libm::sin(angle));
        at = Point::new(to.x.clamp(0.0, 100.0), to.y.clamp(0.0, 100.0));
        points.push(at);
    }
    Drawing { name: "zigzag", ops: polyline(points) }
}

/// A circle of 300 points, radius 20 mm about (50, 50) mm.
pub(crate) fn circle() -> Drawing {
    let points = (0..=300).map(|index| {
        let angle = TAU * f64::from(index % 300) / 300.0;
        Point::new(50.0 + 20.0 * libm::cos(angle), 50.0 + 20.0 * libm::sin(angle))
    });
    Drawing { name: "circle", ops: polyline(points) }
}

/// Arcs with lines between: a clover of four three-quarter circles, radius 0.5 to 10 mm, and a full circle.
pub(crate) fn arcs() -> Drawing {
    let mut ops = Vec::new();
    for (index, radius) in [0.5, 2.0, 5.0, 10.0].into_iter().enumerate() {
        let centre = Point::new(20.0 + 25.0 * f64::from(index as u32), 30.0);
        let from = Point::new(centre.x, centre.y - radius);
        ops.push(PlotOp::Travel { to: Point::new(from.x - 3.0, from.y) });
        ops.push(PlotOp::Draw { to: from, feed_mm_s: None });
        let to = Point::new(centre.x - radius, centre.y);
        ops.push(PlotOp::DrawArc { centre, sweep_rad: 0.75 * TAU, to, feed_mm_s: None });
        ops.push(PlotOp::Draw { to: Point::new(to.x, to.y - 3.0), feed_mm_s: None });
    }
    let centre = Point::new(60.0, 60.0);
    let to = Point::new(80.0, 60.0);
    ops.push(PlotOp::Travel { to });
    ops.push(PlotOp::DrawArc { centre, sweep_rad: -TAU, to, feed_mm_s: None });
    Drawing { name: "arcs", ops }
}

/// The drawings that are built here.
pub(crate) fn built() -> [Drawing; 4] {
    [spiral(20), hatch(60), zigzag(1000), circle()]
}

/// Those that are files of others, where `PLOTTER_REAL_FILES` names them: an owl, curves in short chords, the
/// same in arcs, a space craft. Without the way home at their ends, and at the machine's own speed.
pub(crate) fn real() -> Vec<Drawing> {
    let files = [
        ("owl", "gcode", "unicorn_owl.gcode"),
        ("curves", "gcode", "svg2gcode_smooth_curves.gcode"),
        ("curves in arcs", "gcode", "svg2gcode_smooth_curves_arcs.gcode"),
        ("Cassini", "hpgl", "vk2bea_Cassini.hpgl"),
    ];
    files
        .into_iter()
        .filter_map(|(name, kind, file)| {
            let text = std::fs::read(other(kind, file)?).unwrap();
            let mut ops: Vec<PlotOp> = if kind == "hpgl" {
                hpgl::plot_ops(&text).filter_map(Result::ok).collect()
            } else {
                gcode::plot_ops(&text).filter_map(Result::ok).collect()
            };
            ops.retain(|op| op.target().is_some());
            for op in &mut ops {
                if let PlotOp::Draw { feed_mm_s, .. } | PlotOp::DrawArc { feed_mm_s, .. } = op {
                    *feed_mm_s = None;
                }
            }
            if name == "owl" {
                while matches!(ops.last(), Some(PlotOp::Travel { .. })) {
                    ops.pop();
                }
            }
            Some(Drawing { name, ops })
        })
        .collect()
}
