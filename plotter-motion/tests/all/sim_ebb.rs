//! Drawings as commands of an EBB: how long an AxiDraw takes for them, by the board's own arithmetic.
#![allow(clippy::print_stdout, reason = "what was measured, for whoever looks")]

use crate::drawings;
use crate::prop_ebb::{Made, axidraw, make};
use core::time::Duration;
use plotter_motion::kinematics::Kinematics;
use plotter_motion::protocol::ebb::{EbbCommand, EbbMotionSettings};
use plotter_motion::toolpath::chords;
use plotter_motion::{PathMode, PlannerSettings, PlotOp, Point};
use std::fmt::Write as _;

/// Names a folder that the drawings' strokes are written to, for other planners: a file a drawing, JSON.
const STROKES_TO: &str = "PLOTTER_STROKES_TO";
/// Speed with the pen down and up, mm/s, acceleration, mm/s², and deviation at corners, mm: what saxi has as
/// its defaults with the pen down, and its speed with the pen up.
const LIMITS: (f64, f64, f64, f64) = (50.0, 200.0, 200.0, 0.127);
/// What a motor feels is the second difference of places so far apart, ticks: 40 ms, in which a step of 1/80
/// mm is 4 % of the limit.
const LENS: usize = 1_000;

fn limits(path: PathMode) -> PlannerSettings {
    let (speed_mm_s, travel_speed_mm_s, accel_mm_s2, junction_deviation_mm) = LIMITS;
    PlannerSettings {
        path,
        speed_mm_s,
        travel_speed_mm_s,
        accel_mm_s2,
        junction_deviation_mm,
        ..PlannerSettings::default()
    }
}

/// Greatest acceleration over 40 ms as a share of the limit.
fn felt(made: &Made) -> f64 {
    let at = |tick: usize| axidraw().point_at(made.places[tick].into());
    let seconds = LENS as f64 / 25_000.0;
    let (_, _, accel_mm_s2, _) = LIMITS;
    (LENS..made.places.len().saturating_sub(LENS))
        .step_by(25)
        .map(|tick| {
            let (before, now, after) = (at(tick - LENS), at(tick), at(tick + LENS));
            ((after - now) - (now - before)).length() / (seconds * seconds * accel_mm_s2)
        })
        .fold(0.0, f64::max)
}

/// Strokes in chords, as JSON.
fn strokes(ops: &[PlotOp]) -> String {
    let mut text = String::from("[");
    let mut at = Point::ORIGIN;
    let mut is_open = false;
    for op in chords(ops.iter().copied(), 0.005) {
        let Some(to) = op.target() else { continue };
        if matches!(op, PlotOp::Draw { .. }) {
            if !is_open {
                let comma = if text.len() > 1 { "," } else { "" };
                write!(text, "{comma}[[{},{}]", at.x, at.y).unwrap();
            }
            write!(text, ",[{},{}]", to.x, to.y).unwrap();
            is_open = true;
        } else if std::mem::take(&mut is_open) {
            text.push(']');
        }
        at = to;
    }
    text + if is_open { "]]" } else { "]" }
}

#[test]
#[ignore = "seconds in a release build: a table of docs/results/stepper-motion.md, with the command that stands there"]
fn table_of_times() {
    let settings = EbbMotionSettings { pen_settle: Duration::ZERO, ..EbbMotionSettings::default() };
    println!(
        "| drawing | planned exact | board | commands | felt | planned within 0.05 mm | board | commands | felt |"
    );
    for drawing in drawings::built().into_iter().chain(drawings::real()) {
        if let Some(folder) = std::env::var_os(STROKES_TO) {
            let path = std::path::Path::new(&folder).join(format!("{}.json", drawing.name));
            std::fs::write(path, strokes(&drawing.ops)).unwrap();
        }
        print!("| {} ", drawing.name);
        for path in [PathMode::Exact, PathMode::Tolerance { path_tolerance_mm: 0.05 }] {
            let made = make(&drawing.ops, limits(path), settings);
            let lasts_s = (made.places.len() - 1) as f64 / 25_000.0;
            let moves = |command: &&EbbCommand| matches!(command, EbbCommand::LowLevel(_));
            let count = made.commands.iter().filter(moves).count();
            print!("| {:.2} | {lasts_s:.2} | {count} | {:.2} ", made.planned_s, felt(&made));
            assert_eq!(*made.places.last().unwrap(), made.end);
            // A hundredth, and some milliseconds for each of a few hundred strokes.
            assert!(lasts_s <= 1.03 * made.planned_s, "{}: {lasts_s} s for {}", drawing.name, made.planned_s);
        }
        println!("|");
    }
}

#[test]
fn a_circle_takes_as_long_as_planned_and_is_few_commands() {
    let drawing = drawings::circle();
    let settings = EbbMotionSettings { pen_settle: Duration::ZERO, ..EbbMotionSettings::default() };
    let made = make(&drawing.ops, limits(PathMode::Exact), settings);
    let lasts_s = (made.places.len() - 1) as f64 / 25_000.0;
    assert!((lasts_s - made.planned_s).abs() <= 0.02, "{lasts_s} s, planned {} s", made.planned_s);
    assert!(made.commands.len() <= 120, "{}", made.commands.len());
}
