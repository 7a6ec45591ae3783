//! The exact mode beside the formulas of Klipper's look-ahead, to more digits than a table has.
//!
//! Klipper takes a corner on the circle of the junction deviation, and no faster than on an arc that begins
//! half a segment from it; it looks ahead without end. Source: K. O'Connor, Klipper's documentation of
//! kinematics, "Look-ahead". Here without what it adds for printers (smoothing by `minimum_cruise_ratio`),
//! which makes it slower.

use crate::auditor;
use crate::drawings;
use crate::figure::Figure;
use crate::papers::assert_in;

use auditor::planned;
use plotter_motion::{PathMode, PlannerSettings, PlotOp, Point, Vec2};

/// By how much the times may differ: the planner's corners are reckoned in single precision and rounded to
/// the safe side.
const ROUNDING_SHARE: f64 = 1e-5;

static APART: Figure = Figure::of("millionths apart");

/// Squares of speeds at the ends of a segment and on it make its time, s.
fn segment_s(length_mm: f64, [entry2, exit2, cruise2]: [f64; 3], accel: f64) -> f64 {
    let cruise2 = cruise2.min(0.5 * (entry2 + exit2) + accel * length_mm);
    let [entry, exit, cruise] = [entry2, exit2, cruise2].map(f64::sqrt);
    let ramps_mm = (2.0 * cruise2 - entry2 - exit2) / (2.0 * accel);
    (2.0 * cruise - entry - exit) / accel + (length_mm - ramps_mm).max(0.0) / cruise
}

/// Time of a stroke from rest to rest, s.
fn klipper_s(places: &[Point], settings: &PlannerSettings) -> f64 {
    let (accel, cruise2) = (settings.accel_mm_s2, settings.speed_mm_s * settings.speed_mm_s);
    let ways: Vec<Vec2> =
        places.windows(2).map(|ends| ends[1] - ends[0]).filter(|way| way.length() > 0.0).collect();
    // Squares of the greatest speeds at the vertices.
    let mut speeds2 = vec![0.0; ways.len() + 1];
    for (index, pair) in ways.windows(2).enumerate() {
        let [before_mm, after_mm] = [pair[0].length(), pair[1].length()];
        let cos = (-pair[0].dot(pair[1]) / (before_mm * after_mm)).clamp(-1.0, 1.0);
        let (sin_half, cos_half) = ((0.5 * (1.0 - cos)).sqrt(), (0.5 * (1.0 + cos)).sqrt());
        let of_deviation = accel * settings.junction_deviation_mm * sin_half / (1.0 - sin_half);
        let of_half = 0.5 * before_mm.min(after_mm) * accel * sin_half / cos_half;
        // Straight on both are infinite, or no number where the roots are rounded to 1 and 0.
        speeds2[index + 1] = [of_deviation, of_half].into_iter().fold(cruise2, f64::min);
    }
    for (index, way) in ways.iter().enumerate().skip(1).rev() {
        speeds2[index] = f64::min(speeds2[index], speeds2[index + 1] + 2.0 * accel * way.length());
    }
    for (index, way) in ways.iter().enumerate() {
        speeds2[index + 1] = f64::min(speeds2[index + 1], speeds2[index] + 2.0 * accel * way.length());
    }
    let time = |(index, way): (usize, &Vec2)| {
        segment_s(way.length(), [speeds2[index], speeds2[index + 1], cruise2], accel)
    };
    ways.iter().enumerate().map(time).sum()
}

/// Time of a drawing, each stroke and each travel from rest to rest, s; `None` if it has arcs.
fn drawing_s(ops: &[PlotOp], settings: &PlannerSettings) -> Option<f64> {
    let (mut time_s, mut run, mut pen_down) = (0.0, vec![Point::ORIGIN], false);
    for op in ops {
        let (to, draws) = match *op {
            PlotOp::Travel { to } => (to, false),
            PlotOp::Draw { to, .. } => (to, true),
            _ => return None,
        };
        if draws != pen_down {
            time_s += klipper_s(&run, settings);
            run.drain(..run.len() - 1);
            pen_down = draws;
        }
        run.push(to);
    }
    Some(time_s + klipper_s(&run, settings))
}

/// With every vertex the times are equal; that vertices nearer than half a step are left out only saves time.
#[test]
fn the_exact_mode_takes_as_long_as_klippers_formulas() {
    let settings = PlannerSettings::default();
    let every = PlannerSettings { resolution_mm: 0.0, ..settings };
    let within = PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, ..settings };
    // The drawings that README.md names, in its order; without the real files only the first.
    let named = ["hatch", "owl", "curves", "Cassini"];
    let mut shown = [const { Vec::new() }; 3];
    println!(
        "drawing: Klipper's formulas, exact mode with 1024 blocks and every vertex, and without those nearer than half a step, s"
    );
    for drawing in drawings::built().into_iter().chain(drawings::real()) {
        let Some(klipper_s) = drawing_s(&drawing.ops, &settings) else { continue };
        let [(every_s, _), (ours_s, _)] = [every, settings].map(|of| planned::<1024>(of, &drawing.ops));
        println!("{}: {klipper_s:.4} {every_s:.4} {ours_s:.4}", drawing.name);
        APART.note(1e6 * (every_s / klipper_s - 1.0).abs());
        assert!(
            (every_s / klipper_s - 1.0).abs() <= ROUNDING_SHARE,
            "{}: {every_s} {klipper_s}",
            drawing.name
        );
        assert!(ours_s <= klipper_s * (1.0 + ROUNDING_SHARE), "{}: {ours_s} {klipper_s}", drawing.name);
        if named.contains(&drawing.name) {
            let (within_s, _) = planned::<1024>(within, &drawing.ops);
            for (shown, time_s) in shown.iter_mut().zip([klipper_s, ours_s, within_s]) {
                shown.push(format!("{time_s:.1}"));
            }
        }
    }
    let rows = ["Klipper's rules", "ours, through every vertex", "ours, within 0.05 mm"];
    rows.iter().zip(&shown).for_each(|(row, shown)| assert_in("README.md", row, shown));
}
