//! Drawings through planner and step generator, audited by their steps.
#![allow(
    clippy::print_stdout,
    clippy::cast_precision_loss,
    reason = "what was measured, for whoever looks; ticks below 2^53"
)]

use crate::auditor;
use crate::drawings;
use crate::sampled::sampled;

use auditor::{Audit, Lens, audit, audit_touched, planned};
use core::time::Duration;
use drawings::Drawing;
use plotter_motion::plant::{StepperPlant, StepperSettings};
use plotter_motion::{
    Axis, Direction, Machine, MachineConfig, PathMode, PlannerSettings, StepPair,
    planner::AccelLimit,
    stepgen::{MotorEvent, StepGenSettings},
};

/// A hundred times as fine as a motor, so that differences of places are accelerations and not roundings.
const FINE: Lens =
    Lens { steps_per_mm: 10_000.0, clock_hz: 1e8, bin_s: 0.000_05, window: 50, wide_window: 560 };
/// For long drawings.
const MIDDLE: Lens =
    Lens { steps_per_mm: 4_000.0, clock_hz: 1e8, bin_s: 0.000_05, window: 80, wide_window: 560 };
/// By how much what is measured may exceed a limit.
const MEASURED: f64 = 1.05;
/// By how much the times of planner and steps may differ, but for the way from the last step to rest.
const TIME_SHARE: f64 = 0.001;

/// The time from the last step to rest, s: up to a step of each motor is left then, the longest on a slope.
fn last_s(settings: &PlannerSettings, step_mm: f64) -> f64 {
    let left_mm = 2.0 * step_mm;
    match settings.jerk_mm_s3 {
        Some(jerk_mm_s3) => (6.0 * left_mm / jerk_mm_s3).cbrt(),
        None => (2.0 * left_mm / settings.accel_mm_s2).sqrt(),
    }
}
const TOLERANCE_MM: f64 = 0.05;
/// Of the simulated motors, and of the documented machine.
const MICROSTEPS: f64 = 16.0;
const STEPS_PER_MM: f64 = 87.58;

fn modes() -> [(&'static str, PlannerSettings); 4] {
    let exact = PlannerSettings::default();
    let path = PathMode::Tolerance { path_tolerance_mm: TOLERANCE_MM };
    let tolerance = PlannerSettings { path, ..exact };
    let curved = |settings| PlannerSettings { jerk_mm_s3: Some(20_000.0), ..settings };
    [
        ("exact", exact),
        ("tolerance", tolerance),
        ("exact s-curve", curved(exact)),
        ("tolerance s-curve", curved(tolerance)),
    ]
}

fn check(drawing: &Drawing, lens: Lens) {
    for (mode, settings) in modes() {
        // Jerks are differences of differences: they want longer windows.
        let lens =
            if settings.jerk_mm_s3.is_some() { Lens { window: lens.window * 3, ..lens } } else { lens };
        let seen: Audit = audit::<16>(settings, lens, &drawing.ops);
        let what = format!("{} {mode}: {seen:.4?}", drawing.name);
        println!("{what}");
        assert!(seen.speed_mm_s <= MEASURED * settings.speed_mm_s, "{what}");
        // Of short chords in exact mode, which are all corners, the curve that they stand for.
        for accel in [seen.along_mm_s2, seen.wide_along_mm_s2, seen.wide_across_mm_s2] {
            assert!(accel <= MEASURED * settings.accel_mm_s2, "{what}");
        }
        assert!(seen.corner_share <= MEASURED && seen.vector_share <= MEASURED, "{what}");
        if let Some(jerk_mm_s3) = settings.jerk_mm_s3 {
            assert!(seen.jerk_mm_s3 <= MEASURED * jerk_mm_s3, "{what}");
        }
        let step_mm = 1.0 / lens.steps_per_mm;
        let tolerance_mm = if settings.path == PathMode::Exact { 0.0 } else { TOLERANCE_MM };
        let most_mm = tolerance_mm + settings.resolution_mm + step_mm;
        assert!(seen.from_drawing_mm <= most_mm && seen.from_pen_mm <= most_mm, "{what}");
        let most_s = TIME_SHARE * seen.planned_s + last_s(&settings, step_mm);
        assert!((seen.time_s - seen.planned_s).abs() <= most_s, "{what}");
        let end = drawing.ops.iter().rev().find_map(|op| op.target()).unwrap_or_default();
        let steps = |mm: f64| plotter_motion::toolpath::from_mm(mm, lens.steps_per_mm);
        assert_eq!((seen.end.x, seen.end.y), (steps(end.x), steps(end.y)), "{what}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn short_drawings_keep_every_limit() {
    for drawing in [drawings::spiral(2), drawings::hatch(4), drawings::zigzag(60), drawings::circle()] {
        check(&drawing, FINE);
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn arcs_are_run_as_arcs_within_every_limit() {
    check(&drawings::arcs(), FINE);
    // Courses, not chords.
    assert_eq!(planned::<16>(PlannerSettings::default(), &drawings::arcs().ops).1, 19);
}

#[test]
#[ignore = "two minutes in a release build: .ci/run runs it"]
fn whole_drawings_keep_every_limit() {
    for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
        check(&drawing, if drawing.name == "Cassini" { MIDDLE } else { FINE });
    }
}

/// How a job of chance is run: settings, and the lens for its acceleration. Presets, and speeds and
/// accelerations of chance, in every mode and with every kind of limit.
fn chance(random: &mut impl FnMut() -> f64) -> (PlannerSettings, Lens) {
    let preset = |config| PlannerSettings::of(&Machine::new(config).unwrap());
    let chosen = PlannerSettings {
        speed_mm_s: 20.0 + 280.0 * random(),
        travel_speed_mm_s: 150.0,
        accel_mm_s2: 500.0 * 20.0_f64.powf(random()),
        ..PlannerSettings::default()
    };
    let chosen = match random() {
        ..0.17 => preset(MachineConfig::stepper_plotter()),
        ..0.33 => PlannerSettings { accel_mm_s2: 5_000.0, ..preset(MachineConfig::textile_plotter()) },
        _ => chosen,
    };
    let (strong, weak) = (chosen.accel_mm_s2, chosen.accel_mm_s2 * (0.2 + 0.8 * random()));
    let accel_limit = match random() {
        ..0.2 => AccelLimit::Axes { x_mm_s2: weak, y_mm_s2: strong },
        ..0.4 => AccelLimit::Belts { sum_mm_s2: strong, difference_mm_s2: weak },
        _ => AccelLimit::Vector,
    };
    let path = if random() < 0.75 {
        PathMode::Tolerance { path_tolerance_mm: 0.01 + 0.19 * random() }
    } else {
        PathMode::Exact
    };
    let jerk_mm_s3 = (random() < 0.2).then_some(30.0 * strong);
    // A step more or less looks like s / t²: a hundredth of the lesser limit.
    let window_s = (1.0 / (FINE.steps_per_mm * 0.01 * weak)).sqrt();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred")]
    let window = (window_s / FINE.bin_s).ceil() as usize;
    (PlannerSettings { path, accel_limit, jerk_mm_s3, ..chosen }, Lens { window, ..FINE })
}

/// Jobs of chance with lines, arcs and feeds, which a person slows down, speeds up and holds.
fn check_jobs(seeds: impl Iterator<Item = u64>) {
    let mut worst = 0.0_f64;
    for seed in seeds {
        let mut random = drawings::chance(seed);
        let (settings, lens) = chance(&mut random);
        let job = drawings::job(&mut random);
        let touched = random() < 0.5;
        let seen = audit_touched::<16>(settings, lens, &job, |planner| {
            if touched && random() < 0.03 {
                if random() < 0.33 {
                    planner.hold();
                } else {
                    planner.override_speeds(0.3 + random(), 0.3 + random());
                }
            }
        });
        worst = worst.max(seen.vector_share);
        assert!(seen.vector_share <= MEASURED, "{seed}: {} of the limit, {settings:?}", seen.vector_share);
        let most_s = TIME_SHARE * seen.planned_s + last_s(&settings, 1.0 / lens.steps_per_mm);
        assert!((seen.time_s - seen.planned_s).abs() <= most_s, "{seed}: {seen:?}");
    }
    println!("jobs of chance: at most {worst:.3} of the limit");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_few_jobs_of_chance_keep_the_limit() {
    check_jobs(0..8);
}

#[test]
#[ignore = "minutes in a release build: .ci/run runs it"]
fn whole_jobs_of_chance_keep_the_limit() {
    check_jobs(sampled(1000..1200));
}

/// The documented machine: 87.58 steps/mm, so up to 8758 pulses/s, and simulated motors that lose steps.
#[test]
#[ignore = "half a minute in a release build: .ci/run runs it"]
fn whole_drawings_lose_no_step() {
    let drawings = sampled(drawings::built().into_iter().chain(drawings::real()));
    for drawing in drawings {
        for (mode, settings) in modes() {
            let mut plant = StepperPlant::new(StepperSettings::default(), StepperSettings::default());
            let clock = StepGenSettings::default();
            let mut fastest_hz = 0.0_f64;
            let mut last = [0; 2];
            // How far the rotor is behind its field at any step, full steps: beyond two it falls to another
            // place of rest, and two such falls may cancel each other.
            let mut most_lag = 0.0_f64;
            auditor::run::<16>(
                settings,
                clock,
                STEPS_PER_MM,
                &drawing.ops,
                |_, _, _| {},
                |tick, event| {
                    let MotorEvent::Step(StepPair { x, y }) = event else { return };
                    let at_s = tick as f64 / f64::from(clock.clock_hz);
                    for (axis, step) in [(Axis::X, x), (Axis::Y, y)] {
                        if step != 0 {
                            let direction = if step > 0 { Direction::Plus } else { Direction::Minus };
                            plant.pulse(Duration::from_secs_f64(at_s), axis, direction);
                            let motor = if axis == Axis::X { &plant.x } else { &plant.y };
                            let behind = motor.commanded_steps() as f64 - motor.position_steps();
                            most_lag = most_lag.max(behind.abs() / MICROSTEPS);
                            let last = &mut last[axis as usize];
                            fastest_hz =
                                fastest_hz.max(f64::from(clock.clock_hz) / (tick - *last).max(1) as f64);
                            *last = tick;
                        }
                    }
                },
            );
            plant.x.settle();
            plant.y.settle();
            println!(
                "{} {mode}: up to {fastest_hz:.0} pulses/s, {most_lag:.3} full steps behind",
                drawing.name
            );
            assert!(most_lag < 2.0, "{} {mode}: {most_lag} full steps behind", drawing.name);
            assert_eq!((plant.x.lost_steps(), plant.y.lost_steps()), (0, 0), "{} {mode}", drawing.name);
        }
    }
}

/// A motor with this much more torque than the limit asks for: 1.2 was asked.
const RESERVE: f64 = 1.2;
/// Dry friction, as a share of the torque that the acceleration takes: so little that the acceleration, not
/// the friction, is what the motor is nearly too weak for.
const FRICTION_SHARE: f64 = 0.1;
/// Damping of the rotor's swing, as a share of the least at which it does not swing. A rotor that nothing
/// damps goes beyond its place by as much as it was behind with every jump of the acceleration, and rows of
/// corners make it swing more and more: it needs up to eight times the torque.
const DAMPING_SHARE: f64 = 0.4;
/// The steps of these motors, which are so fine that a motor is not helped by being two full steps behind: on
/// the documented machine that is a third of a millimetre.
const FINE_STEPS_PER_MM: f64 = 400.0;
/// A rotor that is so far from its field falls to another place of rest, full steps.
const FALLS: f64 = 2.0;

/// A motor whose torque is so many times what `accel_mm_s2` asks of it, friction included, damped as one with
/// [`RESERVE`], and as strong at every rate.
fn motor_for(accel_mm_s2: f64, times: f64) -> StepperSettings {
    let plain = StepperSettings { viscous_n_m_s: 0.0, max_rate_hz: 1e9, ..StepperSettings::default() };
    let full_steps = f64::from(plain.full_steps_per_turn);
    let rad_per_mm = FINE_STEPS_PER_MM * core::f64::consts::TAU / (full_steps * MICROSTEPS);
    let inertia_n_m = plain.inertia_kg_m2 * accel_mm_s2 * rad_per_mm;
    let needed_n_m = (1.0 + FRICTION_SHARE) * inertia_n_m;
    // As of a spring that turns the rotor's inertia: 2 √(J p T).
    let stiffness = 0.25 * full_steps * RESERVE * needed_n_m;
    StepperSettings {
        holding_n_m: times * needed_n_m,
        coulomb_n_m: FRICTION_SHARE * inertia_n_m,
        damping_n_m_s: DAMPING_SHARE * 2.0 * (plain.inertia_kg_m2 * stiffness).sqrt(),
        ..plain
    }
}

/// The steps of a drawing: when, s, of which axis and which way.
fn steps_of(settings: PlannerSettings, drawing: &Drawing) -> Vec<(Duration, Axis, Direction)> {
    let clock = StepGenSettings::default();
    let mut steps = Vec::new();
    auditor::run::<16>(
        settings,
        clock,
        FINE_STEPS_PER_MM,
        &drawing.ops,
        |_, _, _| {},
        |tick, event| {
            let MotorEvent::Step(StepPair { x, y }) = event else { return };
            let at = Duration::from_secs_f64(tick as f64 / f64::from(clock.clock_hz));
            for (axis, step) in [(Axis::X, x), (Axis::Y, y)] {
                if step != 0 {
                    steps.push((at, axis, if step > 0 { Direction::Plus } else { Direction::Minus }));
                }
            }
        },
    );
    steps
}

/// How far a rotor is from its field at any step, full steps; no more is looked for once it falls.
fn greatest_lag(steps: &[(Duration, Axis, Direction)], motor: StepperSettings) -> f64 {
    let mut plant = StepperPlant::new(motor, motor);
    let mut most_lag = 0.0_f64;
    for &(at, axis, direction) in steps {
        plant.pulse(at, axis, direction);
        let motor = if axis == Axis::X { &plant.x } else { &plant.y };
        let behind = motor.commanded_steps() as f64 - motor.position_steps();
        most_lag = most_lag.max(behind.abs() / MICROSTEPS);
        if most_lag >= FALLS {
            break;
        }
    }
    most_lag
}

/// With a fifth more torque than the limit asks for no step is lost, and planned at one and a half times the
/// limit the same drawing loses some on the same motors. An S-curve uses 0.9 of the limit in exact mode and
/// 0.7 within a tolerance, so that it may not.
fn check_reserve(drawing: &Drawing) {
    const FASTER: f64 = 1.5;
    for (mode, settings) in modes() {
        let limit = settings.accel_mm_s2;
        let faster = PlannerSettings { accel_mm_s2: FASTER * limit, ..settings };
        let [steps, faster_steps] = [settings, faster].map(|of| steps_of(of, drawing));
        let lag = greatest_lag(&steps, motor_for(limit, RESERVE));
        let faster_lag = greatest_lag(&faster_steps, motor_for(limit, RESERVE));
        // The least torque that is enough, by halving.
        let (mut low, mut high) = (0.5, RESERVE);
        for _ in 0..6 {
            let middle = 0.5 * (low + high);
            if greatest_lag(&steps, motor_for(limit, middle)) < FALLS { high = middle } else { low = middle }
        }
        println!(
            "| {} | {mode} | {lag:.2} | {high:.2} | {} |",
            drawing.name,
            if faster_lag < FALLS { format!("{faster_lag:.2}") } else { "loses steps".into() }
        );
        assert!(lag < FALLS, "{} {mode}: loses steps with {RESERVE} of the torque", drawing.name);
        assert!(
            settings.jerk_mm_s3.is_some() || faster_lag >= FALLS,
            "{} {mode}: {faster_lag}",
            drawing.name
        );
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn motors_with_a_fifth_to_spare_lose_no_step_and_at_half_more_they_do() {
    for drawing in [drawings::hatch(4), drawings::zigzag(60), drawings::circle()] {
        check_reserve(&drawing);
    }
}

#[test]
#[ignore = "a minute in a release build: .ci/run runs it, and it is a table of docs/results/stepper-motion.md"]
fn whole_drawings_have_a_fifth_to_spare() {
    println!("drawing, mode, greatest lag of 2 full steps, least torque / what the limit asks for, at 1.5 x");
    for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
        check_reserve(&drawing);
    }
}

/// Prints the table of docs/results/stepper-motion.md:
/// `cargo test --release -p plotter-motion --test all sim_planner::table -- --ignored --nocapture`
#[test]
#[ignore = "seconds in a release build: the table of docs/results/stepper-motion.md, with the command that stands there"]
fn table_of_times() {
    let modes = modes();
    println!(
        "| drawing | courses | exact | 16 blocks | tolerance | 16 blocks | s-curve exact | s-curve tolerance |"
    );
    for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
        let [exact, tolerance, curved, curved_tolerance] = modes.map(|(_, settings)| {
            (planned::<1024>(settings, &drawing.ops), planned::<16>(settings, &drawing.ops).0)
        });
        // A short look-ahead, a path that must be kept exactly and a bounded jerk take time, and save none.
        // An S-curve takes the greatest jerk that still lets it keep what lies ahead, which is not always the
        // quickest: who sees less ahead, and holds back, may be quicker by as much as this further on.
        const SAVED_BY_CHANCE: f64 = 2e-4;
        let saved_shares = [1e-9, 1e-9, SAVED_BY_CHANCE, SAVED_BY_CHANCE];
        for (((long, courses), short), saved) in
            [exact, tolerance, curved, curved_tolerance].into_iter().zip(saved_shares)
        {
            assert!(
                courses > 0 && long > 0.0 && short >= long * (1.0 - saved),
                "{}: {long}, {short} s",
                drawing.name
            );
        }
        // In exact mode the short chords of a curve are corners, and what jumps there counts for nothing:
        // that saves up to a thousandth.
        let saved = |less: ((f64, usize), f64), more: ((f64, usize), f64)| less.0.0 <= 1.001 * more.0.0;
        assert!(
            saved(tolerance, exact) && saved(exact, curved) && saved(tolerance, curved_tolerance),
            "{}",
            drawing.name
        );
        let row = |((long, _), short): ((f64, usize), f64)| format!("{long:.2} | {:.4}", short / long);
        let ratio = |curved: ((f64, usize), f64), plain: ((f64, usize), f64)| {
            format!("{:.2} ({:.3})", curved.0.0, curved.0.0 / plain.0.0)
        };
        println!(
            "| {} | {} | {} | {} | {} | {} |",
            drawing.name,
            exact.0.1,
            row(exact),
            row(tolerance),
            ratio(curved, exact),
            ratio(curved_tolerance, tolerance)
        );
    }
}
