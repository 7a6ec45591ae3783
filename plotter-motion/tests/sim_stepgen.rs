//! When steps come: to the tick where the plan has them; and a laser that is as strong as it is fast.

mod auditor;

use auditor::run;
use core::cell::RefCell;
use plotter_motion::{Action, MotorEvent, Phase, PlannerSettings, PlotOp, Point, StepGenSettings};

const STEPS_PER_MM: f64 = 100.0;

/// A grade of the power, of 65535.
const GRADE: f64 = 256.0;
/// By how much the speed changes from one interval to the next where it is not slow.
const INTERVALS: f64 = 0.06;
const SLOW_MM_S: f64 = 10.0;

/// A phase with its begin in ticks, and the ticks of the steps that came in it.
type Stepped = (f64, Phase, Vec<u64>);

fn line(settings: PlannerSettings, clock_hz: f64, to: Point) -> (f64, Vec<Stepped>) {
    let phases = RefCell::new(Vec::<Stepped>::new());
    let length_mm = to.distance(Point::ORIGIN);
    let step_settings = StepGenSettings { clock_hz, ..StepGenSettings::default() };
    run::<16>(
        settings,
        step_settings,
        STEPS_PER_MM,
        &[PlotOp::Travel { to }],
        |action, _| {
            if let Action::Phase(phase) = action {
                let mut phases = phases.borrow_mut();
                let begin =
                    phases.last().map_or(0.0, |(begin, phase, _)| begin + phase.duration_s * clock_hz);
                phases.push((begin, phase, Vec::new()));
            }
        },
        |tick, event| {
            if matches!(event, MotorEvent::Step { .. })
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
    for (settings, clock_hz) in [(plain, 1e6), (curved, 1e6), (plain, 84e6), (plain, 1e5)] {
        for to in
            [Point::new(50.0, 0.0), Point::new(-3.0, 7.0), Point::new(0.4, 0.3), Point::new(120.0, 119.0)]
        {
            let (length_mm, phases) = line(settings, clock_hz, to);
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
                        off_mm <= tick_mm + 1e-7,
                        "step {index}: {off_mm} mm off, a tick is {tick_mm} mm"
                    );
                }
            }
        }
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
        |_, _| {},
        |tick, event| match event {
            MotorEvent::Laser(now) => {
                power = now;
                highest = highest.max(now);
            }
            MotorEvent::Step { .. } => {
                let speed = 1e6 / STEPS_PER_MM / (tick - last) as f64;
                last = tick;
                if power > 0 {
                    lit_mm += 1.0 / STEPS_PER_MM;
                    // Of 65535: half at 50 mm/s; in 256 grades. The interval is that before the power: near rest that says little.
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
