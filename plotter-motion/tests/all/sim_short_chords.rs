//! Curves of many short chords, whose vertices are rounded to the last digit of a file: exact mode with an
//! allowance.

use crate::auditor::{Lens, audit, planned};
use crate::drawings;
use crate::short_chords::{CHORDS_MM, CURVES, Curve, Rule, rule_s, stroke};
use plotter_motion::{PathMode, Planner, PlannerSettings, PlotOp, Point, planner::ExactOnly};

/// By how much what is measured may exceed a limit.
const MEASURED: f64 = 1.05;
/// By how much the exact mode may take longer than Grbl's rule.
const OVER_GRBL: f64 = 1.1;
/// Machines: speed, acceleration, step; mm and s. That of the motion table with fine steps, and the
/// documented one.
const MACHINES: [(f64, f64, f64); 2] = [(100.0, 1000.0, 0.001), (45.0, 250.0, 1.0 / 87.58)];

/// Settings that take every vertex as it is.
fn by_vertex((speed_mm_s, accel_mm_s2, step_mm): (f64, f64, f64)) -> PlannerSettings {
    PlannerSettings {
        speed_mm_s,
        travel_speed_mm_s: speed_mm_s,
        accel_mm_s2,
        resolution_mm: 0.5 * step_mm,
        allowance_mm: 0.0,
        ..PlannerSettings::default()
    }
}

/// The same for a file with so many decimals.
fn by_digits(machine: (f64, f64, f64), decimals: i32) -> PlannerSettings {
    PlannerSettings { allowance_mm: machine.2, ..by_vertex(machine) }.for_digits_of(10.0_f64.powi(-decimals))
}

/// Time of a stroke without the way to its start, s.
fn stroke_s<const N: usize>(settings: PlannerSettings, places: &[Point]) -> f64 {
    planned::<N>(settings, &stroke(places)).0 - planned::<N>(settings, &stroke(&places[..1])).0
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn rounding_to_the_last_digit_does_not_brake() {
    for machine in MACHINES {
        for curve in CURVES {
            for decimals in 1..=4 {
                for chord_mm in CHORDS_MM {
                    let places = curve.written(chord_mm, decimals);
                    let settings = by_digits(machine, decimals);
                    let (ours_s, grbl_s) =
                        (stroke_s::<16>(settings, &places), rule_s(&places, &settings, Rule::Grbl));
                    assert!(
                        ours_s <= OVER_GRBL * grbl_s,
                        "{curve:?}, {decimals} decimals, chords of {chord_mm} mm: {ours_s:.3} s, Grbl's rule {grbl_s:.3} s"
                    );
                }
            }
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn rounded_curves_keep_the_limits_and_the_allowance() {
    const LENS: Lens =
        Lens { steps_per_mm: 10_000.0, clock_hz: 1e8, bin_s: 0.000_05, window: 50, wide_window: 560 };
    for (curve, decimals, chord_mm) in [
        (Curve::Circle, 3, 0.01),
        (Curve::Circle, 1, 0.1),
        (Curve::Free, 2, 0.05),
        (Curve::Free, 3, 0.5),
        (Curve::Free, 4, 0.02),
        (Curve::Spiral, 2, 0.2),
    ] {
        let settings = by_digits(MACHINES[0], decimals);
        let seen = audit::<16>(settings, LENS, &stroke(&curve.written(chord_mm, decimals)));
        let what = format!("{curve:?}, {decimals} decimals, {chord_mm} mm: {seen:.4?}");
        println!("{what}");
        assert!(seen.speed_mm_s <= MEASURED * settings.speed_mm_s, "{what}");
        for accel in [seen.along_mm_s2, seen.across_mm_s2, seen.wide_along_mm_s2, seen.wide_across_mm_s2] {
            assert!(accel <= MEASURED * settings.accel_mm_s2, "{what}");
        }
        assert!(seen.corner_share <= MEASURED && seen.vector_share <= MEASURED, "{what}");
        // A step of each motor.
        let most_mm = settings.allowance_mm + 2.0_f64.sqrt() / LENS.steps_per_mm;
        assert!(seen.from_drawing_mm <= most_mm && seen.from_pen_mm <= most_mm, "{what}");
    }
}

/// Corners of long lines, and of lines that are divided finely.
#[test]
fn corners_of_the_drawing_stay_and_brake_as_before() {
    const SHARE: f64 = 1e-4;
    let machine = MACHINES[1];
    let turns = [90.0_f64, -45.0, 150.0, -20.0, 5.0, -120.0, 90.0, 30.0];
    for divided in [1, 40] {
        let (mut at, mut direction_rad) = (Point::new(50.0, 50.0), 0.0);
        let (mut places, mut corners) = (vec![at], vec![at]);
        for turn_deg in turns {
            let way = plotter_motion::Vec2::new(12.0, 0.0).rotated(direction_rad);
            for part in 1..=divided {
                places.push(at + way * (f64::from(part) / f64::from(divided)));
            }
            at += way;
            corners.push(at);
            direction_rad += turn_deg.to_radians();
        }
        let exact_s = stroke_s::<64>(by_vertex(machine), &corners);
        for decimals in [3, 4] {
            let settings = by_digits(machine, decimals);
            let ours_s = stroke_s::<64>(settings, &places);
            assert!((ours_s / exact_s - 1.0).abs() < SHARE, "{divided}: {ours_s} s, by vertices {exact_s} s");
        }
        let (_, courses) = planned::<64>(by_digits(machine, 3), &stroke(&places));
        // One for each line, the way to the start and the lift at the end; between lines of a third of a
        // millimetre, 5 degrees are a curve.
        assert!(courses <= turns.len() + 3, "{divided}: {courses}");
    }
}

#[test]
fn a_stroke_within_the_allowance_leaves_a_dot() {
    let at = Point::new(10.0, 10.0);
    let mut ops = vec![PlotOp::Travel { to: at }];
    for (x, y) in [(0.004, 0.0), (0.004, 0.004), (0.0, 0.0)] {
        ops.push(PlotOp::Draw { to: Point::new(at.x + x, at.y + y), feed_mm_s: None });
    }
    // The way there, the dot, and the lift.
    assert_eq!(planned::<16>(by_digits(MACHINES[1], 3), &ops).1, 3);
}

/// What the modes of small programs can do they do alike, whatever the allowance.
#[test]
fn a_small_program_takes_every_vertex() {
    let ops = stroke(&Curve::Circle.written(0.5, 3));
    let planned = |settings| {
        let mut planner = Planner::<512, ExactOnly>::with_modes(settings).unwrap();
        for op in &ops {
            planner.push(*op).unwrap();
        }
        planner.finish().unwrap();
        core::iter::from_fn(|| planner.next_action()).collect::<Vec<_>>()
    };
    let actions = planned(by_digits(MACHINES[0], 2));
    assert!(actions.len() > ops.len(), "{}", actions.len());
    assert_eq!(actions, planned(by_vertex(MACHINES[0])));
}

/// Curves in chords that end in many places, and go on from there as an arc of the file: hardly longer than
/// with the arc in chords, too.
#[test]
fn chords_end_on_the_arc_that_follows_them() {
    const RADIUS_MM: f64 = 10.0;
    const SWEEP_RAD: f64 = 2.0;
    let settings = PlannerSettings { allowance_mm: 0.01, ..by_vertex(MACHINES[0]) };
    let (mut arcs_s, mut chords_s, mut worst) = (0.0, 0.0, 0.0_f64);
    for curve in [Curve::Free, Curve::Spiral] {
        let places = curve.written(0.2, 2);
        for count in (40..600).step_by(7) {
            let Some(chords) = places.get(..count) else { break };
            let (before, at) = (chords[count - 4], chords[count - 1]);
            let ahead = (at - before) * (1.0 / at.distance(before));
            let centre = at + ahead.perpendicular() * RADIUS_MM;
            let on_arc = |part: f64| centre + (at - centre).rotated(SWEEP_RAD * part);
            let mut with_arc = stroke(chords);
            with_arc.push(PlotOp::DrawArc { centre, sweep_rad: SWEEP_RAD, to: on_arc(1.0), feed_mm_s: None });
            let mut in_chords = stroke(chords);
            in_chords.extend(
                (1..=100_u32)
                    .map(|part| PlotOp::Draw { to: on_arc(f64::from(part) / 100.0), feed_mm_s: None }),
            );
            let [arc_s, chord_s] = [with_arc, in_chords].map(|ops| planned::<256>(settings, &ops).0);
            (arcs_s, chords_s, worst) = (arcs_s + arc_s, chords_s + chord_s, worst.max(arc_s / chord_s));
        }
    }
    println!("with arcs {arcs_s:.3} s, in chords {chords_s:.3} s, at worst {worst:.4}");
    assert!(arcs_s <= 1.001 * chords_s && worst <= 1.005, "{arcs_s} s, in chords {chords_s} s, {worst}");
}

/// Most that a drawing may take longer with an allowance: the way that the pen goes is a little longer than
/// its chords.
const LONGER: f64 = 1.003;

/// The table of docs/results/stepper-motion.md, with blocks enough for the best: no row takes longer than
/// Grbl's rule, and no drawing longer with an allowance than without.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn table_of_short_chords() {
    for machine in MACHINES {
        println!("{machine:?}");
        println!(
            "| curve | decimals | chords, mm | allowance, mm | before | now | Grbl's rule | the curve itself | tolerance | courses |"
        );
        for curve in CURVES {
            for decimals in 1..=4 {
                for chord_mm in CHORDS_MM {
                    let places = curve.written(chord_mm, decimals);
                    let (before, now) = (by_vertex(machine), by_digits(machine, decimals));
                    let path = PathMode::Tolerance { path_tolerance_mm: now.allowance_mm };
                    let (now_s, grbl_s) =
                        (stroke_s::<64>(now, &places), rule_s(&places, &before, Rule::Grbl));
                    assert!(
                        now_s <= OVER_GRBL * grbl_s,
                        "{curve:?}, {decimals}, {chord_mm}: {now_s} s, {grbl_s} s"
                    );
                    println!(
                        "| {curve:?} | {decimals} | {chord_mm} | {:.4} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {} of {} |",
                        now.allowance_mm,
                        stroke_s::<64>(before, &places),
                        now_s,
                        grbl_s,
                        rule_s(&curve.places(0.02), &before, Rule::Klipper),
                        stroke_s::<64>(PlannerSettings { path, ..before }, &places),
                        planned::<64>(now, &stroke(&places)).1 - 1,
                        places.len() - 1,
                    );
                }
            }
        }
    }
    println!("drawing: exact, with an allowance of 0.01 mm, with 16 blocks, s; with S-curves");
    for drawing in drawings::built().into_iter().chain(drawings::real()) {
        let exact = PlannerSettings { allowance_mm: 0.0, ..PlannerSettings::default() };
        let with = PlannerSettings { allowance_mm: 0.01, ..exact };
        let time = |settings| planned::<1024>(settings, &drawing.ops).0;
        let curved = |settings| PlannerSettings { jerk_mm_s3: Some(20_000.0), ..settings };
        let (exact_s, with_s) = (time(exact), time(with));
        assert!(with_s <= LONGER * exact_s, "{}: {with_s} s, exact {exact_s} s", drawing.name);
        println!(
            "{}: {:.4} {:.4} {:.4}; {:.2} {:.2}",
            drawing.name,
            exact_s,
            with_s,
            planned::<16>(with, &drawing.ops).0,
            time(curved(exact)),
            time(curved(with))
        );
    }
}
