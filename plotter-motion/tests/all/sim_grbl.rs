//! The planner beside the rule of Grbl, at the same limit of each axis: the times of both, and what the axes
//! feel of both.
//!
//! Grbl takes a corner at the speed of the circle that its junction deviation allows, whatever the lengths of
//! the segments beside it, and looks ahead over the squares of speeds. Source: S. K. Jeon and others, grbl
//! 1.1, planner.c. Here it looks ahead without end, which only makes it quicker.
#![allow(clippy::print_stdout, reason = "what was measured, for whoever looks")]

use crate::auditor;
use crate::drawings;
use crate::sampled::sampled;

use auditor::{Lens, audit, planned, share_of_limit};
use plotter_motion::{PathMode, PlannerSettings, PlotOp, Point, Vec2, planner::AccelLimit};

const ACCEL_MM_S2: f64 = 1000.0;
/// Differences over 10 ms: a jump of the velocity in a corner of a few mm/s is within the limit then, and what
/// a row of corners does to a motor is seen.
const LENS: Lens = Lens { steps_per_mm: 1_000.0, clock_hz: 1e7, bin_s: 0.000_5, window: 20, wide_window: 60 };
/// By how much what is measured may exceed a limit, as in the audit of the planner.
const MEASURED: f64 = 1.05;
/// By how much the times may differ: single precision, as beside Klipper's rule.
const ROUNDING_SHARE: f64 = 1e-5;

fn settings(path: PathMode) -> PlannerSettings {
    let accel_limit = AccelLimit::Axes { x_mm_s2: ACCEL_MM_S2, y_mm_s2: ACCEL_MM_S2 };
    PlannerSettings { path, accel_limit, ..PlannerSettings::default() }
}

/// A segment with its direction, its acceleration and the speeds at its ends.
struct Run {
    from: Point,
    along: Vec2,
    length_mm: f64,
    accel: f64,
    speeds: [f64; 2],
}

/// The greatest acceleration in a direction that both axes allow.
fn of_axes(along: Vec2) -> f64 {
    ACCEL_MM_S2 / along.x.abs().max(along.y.abs())
}

fn runs(places: &[Point], settings: &PlannerSettings) -> Vec<Run> {
    /// Of a turn's cosine: Grbl takes what is nearer to -1 for straight back and to 1 for straight on.
    const STRAIGHT: f64 = 0.999_999;
    let ways = places.windows(2).map(|ends| (ends[0], ends[1] - ends[0]));
    let mut runs: Vec<Run> = ways
        .filter(|(_, way)| way.length() > 0.0)
        .map(|(from, way)| {
            let along = way * (1.0 / way.length());
            Run { from, along, length_mm: way.length(), accel: of_axes(along), speeds: [0.0; 2] }
        })
        .collect();
    let most2 = settings.speed_mm_s * settings.speed_mm_s;
    let mut speeds2 = vec![0.0; runs.len() + 1];
    for (index, pair) in runs.windows(2).enumerate() {
        let cos = -pair[0].along.dot(pair[1].along);
        let inwards = pair[1].along - pair[0].along;
        let sin_half = (0.5 * (1.0 - cos)).sqrt();
        let of_deviation = settings.junction_deviation_mm * sin_half / (1.0 - sin_half);
        speeds2[index + 1] = if cos > STRAIGHT {
            0.0
        } else if cos < -STRAIGHT {
            most2
        } else {
            most2.min(of_axes(inwards * (1.0 / inwards.length())) * of_deviation)
        };
    }
    for (index, run) in runs.iter().enumerate().skip(1).rev() {
        speeds2[index] = f64::min(speeds2[index], speeds2[index + 1] + 2.0 * run.accel * run.length_mm);
    }
    for (index, run) in runs.iter_mut().enumerate() {
        speeds2[index + 1] = f64::min(speeds2[index + 1], speeds2[index] + 2.0 * run.accel * run.length_mm);
        run.speeds = [speeds2[index].sqrt(), speeds2[index + 1].sqrt()];
    }
    runs
}

impl Run {
    /// The greatest speed on it, and the times of speeding up, of that speed and of braking, s.
    fn times_s(&self, most: f64) -> (f64, [f64; 3]) {
        let [entry, exit] = self.speeds;
        let cruise = (0.5 * (entry * entry + exit * exit) + self.accel * self.length_mm).sqrt().min(most);
        let [up_s, down_s] = [entry, exit].map(|speed| (cruise - speed) / self.accel);
        let left_mm = self.length_mm - 0.5 * ((cruise + entry) * up_s + (cruise + exit) * down_s);
        (cruise, [up_s, left_mm.max(0.0) / cruise, down_s])
    }

    /// How far it has come after a time, mm.
    fn way_mm(&self, time_s: f64, (cruise, [up_s, steady_s, down_s]): (f64, [f64; 3])) -> f64 {
        let [entry, exit] = self.speeds;
        if time_s < up_s {
            return time_s * (entry + 0.5 * self.accel * time_s);
        }
        let left_s = up_s + steady_s + down_s - time_s;
        if left_s < down_s {
            return self.length_mm - left_s * (exit + 0.5 * self.accel * left_s);
        }
        0.5 * (cruise + entry) * up_s + cruise * (time_s - up_s)
    }
}

/// The time of a drawing of lines by Grbl's rule, s, and the greatest acceleration of an axis as a share of
/// its limit; `None` of one with arcs. Pens rest between strokes for as long as the audit looks at once.
fn grbl(ops: &[PlotOp], settings: PlannerSettings) -> Option<(f64, f64)> {
    let mut strokes = vec![vec![Point::ORIGIN]];
    let mut is_down = false;
    for op in ops {
        let (to, draws) = match *op {
            PlotOp::Travel { to } => (to, false),
            PlotOp::Draw { to, .. } => (to, true),
            _ => return None,
        };
        if draws != is_down {
            let begin = *strokes.last()?.last()?;
            strokes.push(vec![begin]);
            is_down = draws;
        }
        strokes.last_mut()?.push(to);
    }
    let (mut time_s, mut places, mut into_s) = (0.0, Vec::new(), 0.0);
    for stroke in &strokes {
        for run in runs(stroke, &settings) {
            let times = run.times_s(settings.speed_mm_s);
            let whole_s: f64 = times.1.iter().sum();
            while into_s < whole_s {
                places.push(run.from + run.along * run.way_mm(into_s, times));
                into_s += LENS.bin_s;
            }
            into_s -= whole_s;
            time_s += whole_s;
        }
        places.extend(std::iter::repeat_n(*stroke.last()?, 4 * LENS.window));
    }
    Some((time_s, share_of_limit(&places, settings, LENS)))
}

/// Within the limits of its axes the planner is as quick as Grbl's rule or quicker. Where it is slower, that
/// rule asks the motors for more than their limit by far.
fn check(drawing: &drawings::Drawing) {
    let exact = settings(PathMode::Exact);
    let within = settings(PathMode::Tolerance { path_tolerance_mm: 0.05 });
    let Some((grbl_s, grbl_share)) = grbl(&drawing.ops, exact) else { return };
    let [(exact_s, _), (within_s, _)] = [exact, within].map(|of| planned::<1024>(of, &drawing.ops));
    let share = audit::<16>(within, LENS, &drawing.ops).vector_share;
    println!(
        "| {} | {grbl_s:.2} | {grbl_share:.2} | {exact_s:.2} | {within_s:.2} | {share:.3} |",
        drawing.name
    );
    assert!(share <= MEASURED, "{}: {share} of the limit of an axis", drawing.name);
    let least_s = exact_s.min(within_s);
    assert!(
        least_s <= grbl_s * (1.0 + ROUNDING_SHARE) || grbl_share > 2.0,
        "{}: {least_s} s, Grbl {grbl_s} s with {grbl_share} of the limit",
        drawing.name
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_circle_and_short_lines_are_no_slower_than_by_grbls_rule() {
    for drawing in [drawings::spiral(2), drawings::hatch(6), drawings::zigzag(60), drawings::circle()] {
        check(&drawing);
    }
}

#[test]
#[ignore = "seconds in a release build: .ci/run runs it, and it is a table of docs/results/stepper-motion.md"]
fn table_of_whole_drawings() {
    println!(
        "drawing, Grbl's rule, s, greatest acceleration of an axis / limit; ours exact, within, its share"
    );
    for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
        check(&drawing);
    }
}

/// A corner passed at a constant speed is a jump of the velocity, and the audit sees it: a right angle at 20
/// mm/s changes each axis by that within 10 ms, of which an average over half of them shows seven eighths.
#[test]
fn a_corner_that_is_too_fast_is_seen() {
    let place = |time_s: f64| {
        let mm = 20.0 * (time_s - 0.5);
        Point::new(mm.min(0.0), mm.max(0.0))
    };
    let places: Vec<Point> = (0..2000_u32).map(|bin| place(f64::from(bin) * LENS.bin_s)).collect();
    let share = share_of_limit(&places, settings(PathMode::Exact), LENS);
    assert!((share - 0.875 * 2.0).abs() < 0.01, "{share}");
}
