//! When steps come: to the tick where the plan has them; and a laser that is as strong as it is fast.

use crate::auditor;

use auditor::run;
use core::cell::{Cell, RefCell};
use plotter_motion::{
    PlannerSettings, PlotOp, Point, StepPair, StepPoint,
    planner::{Action, Phase},
    stepgen::{MotorEvent, StepGenSettings},
    toolpath::from_mm,
};

const STEPS_PER_MM: f64 = 100.0;

/// What `f32` leaves of the 5 mm that a phase goes at the most.
const ROUNDING_MM: f64 = 5e-7;
/// A grade of the power, of 65535.
const GRADE: f64 = 256.0;
/// By how much the speed changes from one interval to the next where it is not slow.
const INTERVALS: f64 = 0.06;
const SLOW_MM_S: f64 = 10.0;

/// A phase with its begin in ticks, and the ticks of the steps that came in it.
type Stepped = (f64, Phase, Vec<u64>);

fn line(settings: PlannerSettings, clock_hz: u32, to: Point) -> (f64, Vec<Stepped>) {
    let phases = RefCell::new(Vec::<Stepped>::new());
    let length_mm = to.distance(Point::ORIGIN);
    let step_settings = StepGenSettings { clock_hz, ..StepGenSettings::default() };
    run::<16>(
        settings,
        step_settings,
        STEPS_PER_MM,
        &[PlotOp::Travel { to }],
        |action, _, _| {
            if let Action::Phase(phase) = action {
                let mut phases = phases.borrow_mut();
                let begin = phases.last().map_or(0.0, |(begin, phase, _)| {
                    begin + f64::from(phase.duration_s) * f64::from(clock_hz)
                });
                phases.push((begin, phase, Vec::new()));
            }
        },
        |tick, event| {
            if matches!(event, MotorEvent::Step(_))
                && let Some(last) = phases.borrow_mut().last_mut()
            {
                last.2.push(tick);
            }
        },
    );
    (length_mm, phases.into_inner())
}

#[test]
fn every_step_comes_within_a_tick_of_its_place() {
    let plain = PlannerSettings::default();
    let curved = PlannerSettings { jerk_mm_s3: Some(20_000.0), ..plain };
    for (settings, clock_hz) in
        [(plain, 1_000_000), (curved, 1_000_000), (plain, 84_000_000), (plain, 100_000)]
    {
        for to in
            [Point::new(50.0, 0.0), Point::new(-3.0, 7.0), Point::new(0.4, 0.3), Point::new(120.0, 119.0)]
        {
            let (length_mm, phases) = line(settings, clock_hz, to);
            let clock_hz = f64::from(clock_hz);
            let count: usize = phases.iter().map(|(_, _, ticks)| ticks.len()).sum();
            let major = to.x.abs().max(to.y.abs()) * STEPS_PER_MM;
            assert_eq!(count as f64, libm::round(major));
            let mut index = 0.0;
            for (begin, phase, ticks) in &phases {
                for &tick in ticks {
                    // The place at the tick is no farther from where the step is due than a tick's way.
                    let at = phase.at((tick as f64 - begin) / clock_hz);
                    let due_mm = (index + 0.5) / major * length_mm;
                    index += 1.0;
                    let tick_mm = (at.speed_mm_s.abs() + settings.accel_mm_s2 / clock_hz) / clock_hz;
                    let off_mm = (at.distance_mm - due_mm).abs();
                    assert!(
                        off_mm <= tick_mm + ROUNDING_MM,
                        "step {index}: {off_mm} mm off, a tick is {tick_mm} mm"
                    );
                }
            }
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_roll_of_ten_metres_is_stepped_to_the_last_step_and_in_time() {
    /// Four fifths of a step, two last bits of ten metres: what `f32` leaves of places along them.
    const PLACES_MM: f64 = 2e-3;
    /// What it leaves of times and speeds, as a share.
    const TIMES: f64 = 2e-7;
    const STEPS_PER_MM: f64 = 400.0;
    const ACCEL: f64 = 1000.0;
    let settings = PlannerSettings { accel_mm_s2: ACCEL, ..PlannerSettings::default() };
    for (to, speed) in [
        (Point::new(9_999.998_7, 0.0), 100.0),
        (Point::new(0.6, -9_876.543_2), 80.0),
        (Point::new(7_777.7, 6_666.6), 33.3),
    ] {
        let settings = PlannerSettings { travel_speed_mm_s: speed, ..settings };
        let (mut ticks, mut at, planned_s) = (Vec::new(), StepPoint::default(), Cell::new(0.0));
        run::<16>(
            settings,
            StepGenSettings::default(),
            STEPS_PER_MM,
            &[PlotOp::Travel { to }],
            |action, _, _| {
                if let Action::Phase(phase) = action {
                    planned_s.set(planned_s.get() + f64::from(phase.duration_s));
                }
            },
            |tick, event| {
                if let MotorEvent::Step(StepPair { x, y }) = event {
                    at = StepPoint::new(at.x + i32::from(x), at.y + i32::from(y));
                    ticks.push(tick);
                }
            },
        );
        assert_eq!(at, StepPoint::new(from_mm(to.x, STEPS_PER_MM), from_mm(to.y, STEPS_PER_MM)));
        let (length_mm, up_s) = (to.distance(Point::ORIGIN), speed / ACCEL);
        let all_s = length_mm / speed + up_s;
        let space_mm = length_mm / ticks.len() as f64;
        for (index, tick) in ticks.iter().enumerate() {
            // By the book: up, on, down.
            let (t, left) = (*tick as f64 / 1e6, all_s - *tick as f64 / 1e6);
            let from_begin_mm = if t < up_s { 0.5 * ACCEL * t * t } else { speed * (t - 0.5 * up_s) };
            let place_mm =
                if left < up_s { length_mm - 0.5 * ACCEL * left.max(0.0).powi(2) } else { from_begin_mm };
            let off_mm = (place_mm - (index as f64 + 0.5) * space_mm).abs();
            let most_mm = PLACES_MM + TIMES * place_mm.min(speed * all_s) + speed * 1e-6;
            assert!(off_mm <= most_mm, "{to:?}, step {index} at {t} s: {off_mm} mm");
        }
        let planned_s = planned_s.get();
        assert!((planned_s - all_s).abs() <= TIMES * all_s, "{planned_s} of {all_s} s");
    }
}

#[test]
fn a_lasers_power_follows_its_speed_and_is_none_at_rest() {
    let ops = [
        PlotOp::Travel { to: Point::new(10.0, 0.0) },
        PlotOp::LaserPower { share: 0.5 },
        PlotOp::Draw { to: Point::new(40.0, 0.0), feed_mm_s: Some(50.0) },
        PlotOp::Draw { to: Point::new(40.0, 20.0), feed_mm_s: Some(50.0) },
        PlotOp::Travel { to: Point::new(0.0, 0.0) },
    ];
    let step_settings = StepGenSettings { laser: true, ..StepGenSettings::default() };
    let (mut power, mut last, mut pairs, mut highest) = (0_u16, 0_u64, 0, 0);
    let mut lit_mm = 0.0;
    run::<16>(
        PlannerSettings::default(),
        step_settings,
        STEPS_PER_MM,
        &ops,
        |_, _, _| {},
        |tick, event| match event {
            MotorEvent::Laser(now) => {
                power = now;
                highest = highest.max(now);
            }
            MotorEvent::Step(_) => {
                let speed = 1e6 / STEPS_PER_MM / (tick - last) as f64;
                last = tick;
                if power > 0 {
                    lit_mm += 1.0 / STEPS_PER_MM;
                    // Of 65535: half at 50 mm/s; in 256 grades. The interval is that before the power: near
                    // rest that says little.
                    let meant = 0.5 * f64::from(u16::MAX) * speed / 50.0;
                    let near = (f64::from(power) - meant).abs() < GRADE + INTERVALS * meant;
                    assert!(near || speed < SLOW_MM_S, "{power} at {speed} mm/s");
                    pairs += 1;
                }
            }
            MotorEvent::Pen(_) => panic!("a laser has no pen"),
            _ => {}
        },
    );
    assert_eq!(power, 0, "dark at the end");
    assert!((50.0_f64 - lit_mm).abs() < 0.1, "{lit_mm} mm lit of 50");
    assert!(pairs > 4900 && (32_000..=32_896).contains(&highest), "{pairs} steps, highest {highest}");
}
