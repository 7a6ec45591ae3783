//! When a simulated stepper motor loses steps: as the documented machine does, and as torque and inertia say.

use core::time::Duration;
use plotter_motion::plant::{StepperAxis, StepperPlant, StepperSettings};
use plotter_motion::{
    Axis, Direction,
    profile::{Trapezoid, TrapezoidMove},
};

/// Rest position of a rotor in friction, as a part of the holding torque: asin(0.04/0.28) of a quarter turn
/// of the spring is 0.091 full steps, here 1.5 pulses; and the last swing leaves it anywhere within.
const FRICTION_STEPS: f64 = 1.5;

/// Pulses at the times that a planned speed gives, a step being its millimetre; and what was lost.
fn lost_along(asked: TrapezoidMove, settings: StepperSettings) -> i64 {
    #[expect(clippy::unwrap_used, reason = "the figures of these tests are motions")]
    let motion = Trapezoid::plan(asked).unwrap();
    let mut axis = StepperAxis::new(settings);
    let mut step = 0.0;
    while step < asked.length_mm {
        step += 1.0;
        axis.pulse(Duration::from_secs_f64(motion.time_at(step)), Direction::Plus);
    }
    axis.settle();
    axis.lost_steps()
}

fn lost_at_once(rate_hz: f64, steps: f64) -> i64 {
    let asked = TrapezoidMove {
        length_mm: steps,
        entry_mm_s: rate_hz,
        exit_mm_s: rate_hz,
        speed_mm_s: rate_hz,
        accel_mm_s2: 1.0,
    };
    lost_along(asked, StepperSettings::default())
}

/// From the source's base speed over `length_steps`, with its acceleration: 8000 pulses/s within half of 2750
/// steps, (8000² - 2000²) / 2750 pulses/s².
fn ramped(length_steps: f64, speed_hz: f64) -> TrapezoidMove {
    TrapezoidMove {
        length_mm: length_steps,
        entry_mm_s: 2_000.0,
        exit_mm_s: 2_000.0,
        speed_mm_s: speed_hz,
        accel_mm_s2: 6.0e7 / 2_750.0,
    }
}

#[test]
fn the_documented_rates_keep_and_lose_steps_as_documented() {
    // Base speed 2000 pulses/s, at once.
    assert_eq!(lost_at_once(2_000.0, 5_000.0), 0);
    // Up to 8000 pulses/s over 2750 steps (section 3.2), and far.
    assert_eq!(lost_along(ramped(2_750.0, 8_000.0), StepperSettings::default()), 0);
    assert_eq!(lost_along(ramped(26_000.0, 8_000.0), StepperSettings::default()), 0);
    // From 0 to 10,000 pulses/s at once (section 2.2.3.3).
    assert!(lost_at_once(10_000.0, 5_000.0) > 1_000);
    // The same rate by acceleration is no trouble (8000 to 10,000 there).
    assert_eq!(lost_along(ramped(26_000.0, 10_000.0), StepperSettings::default()), 0);
}

#[test]
fn beyond_the_pull_out_curve_no_ramp_helps() {
    // Friction 0.04 N m and 1e-3 N m s * 2 pi * f / 3200; torque 0.28 (40,000 - f) / 32,000 N m: equal at
    // 28,900/s.
    let far = |speed_hz| TrapezoidMove { accel_mm_s2: 1.0e5, ..ramped(20_000.0, speed_hz) };
    assert_eq!(lost_along(far(26_000.0), StepperSettings::default()), 0);
    assert!(lost_along(far(32_000.0), StepperSettings::default()) > 0);
}

#[test]
fn a_ramp_steeper_than_torque_over_inertia_loses_steps() {
    // (0.28 - 0.04) N m / 4.94e-5 kg m² = 4860 rad/s², 2.5 million pulses/s².
    let steep = |accel_mm_s2| TrapezoidMove { accel_mm_s2, ..ramped(20_000.0, 20_000.0) };
    assert_eq!(lost_along(steep(5.0e5), StepperSettings::default()), 0);
    assert!(lost_along(steep(4.0e6), StepperSettings::default()) > 0);
    // Three times the mass, a third of it.
    let heavy = StepperSettings { inertia_kg_m2: 3.0 * 4.94e-5, ..StepperSettings::default() };
    assert!(lost_along(steep(1.3e6), heavy) > 0);
}

/// Energy decides at a sudden start: in the field's frame the rotor runs backwards with the field's speed w
/// and must not climb over the spring: J w² / 2 < 2 T / p, without friction.
#[test]
fn the_greatest_rate_to_start_at_is_what_energy_says() {
    let free = StepperSettings {
        coulomb_n_m: 0.0,
        viscous_n_m_s: 0.0,
        max_rate_hz: 1.0e9,
        ..StepperSettings::default()
    };
    let pole_pairs = 50.0;
    let w = (4.0 * free.holding_n_m / (pole_pairs * free.inertia_kg_m2)).sqrt();
    let rate_hz = w / std::f64::consts::TAU * 3_200.0;
    let start = |rate_hz: f64| {
        let mut axis = StepperAxis::new(free);
        // (nothing damps it: 20 swings are enough to see whether it follows)
        let steps = 3_000;
        for step in 1..=steps {
            axis.pulse(Duration::from_secs_f64(f64::from(step) / rate_hz), Direction::Plus);
        }
        axis.lost_steps()
    };
    assert_eq!(start(0.97 * rate_hz), 0, "{rate_hz}");
    assert!(start(1.03 * rate_hz) > 0, "{rate_hz}");
}

#[test]
fn what_is_lost_are_whole_periods_and_position_and_loss_add_up() {
    for rate_hz in [9_000.0, 10_000.0, 12_000.0, 20_000.0] {
        let mut plant = StepperPlant::new(StepperSettings::default(), StepperSettings::default());
        for step in 1..=3_000 {
            let at = Duration::from_secs_f64(f64::from(step) / rate_hz);
            plant.pulse(at, Axis::X, Direction::Plus);
            if step % 8 == 0 {
                plant.pulse(at, Axis::Y, Direction::Minus);
            }
        }
        plant.x.settle();
        plant.y.settle();
        let (x, y) = (plant.x, plant.y);
        assert_eq!(x.lost_steps() % 64, 0); // four full steps of 16 pulses
        assert_eq!((x.commanded_steps(), y.commanded_steps(), y.lost_steps()), (3_000, -375, 0));
        for axis in [x, y] {
            let off = axis.commanded_steps() - axis.lost_steps();
            assert!((axis.position_steps() - off as f64).abs() <= FRICTION_STEPS, "{rate_hz}: {axis:?}");
        }
    }
}

#[test]
fn the_same_pulses_give_the_same_bits_and_odd_times_do_no_harm() {
    let run = || {
        let mut axis = StepperAxis::new(StepperSettings::default());
        for step in 1..500_u64 {
            let direction = if step % 7 < 5 { Direction::Plus } else { Direction::Minus };
            axis.pulse(Duration::from_micros(step * 137), direction);
        }
        axis.pulse(Duration::ZERO, Direction::Plus); // earlier than the last: counts as now
        axis.run_to(Duration::MAX);
        axis.pulse(Duration::MAX, Direction::Plus);
        axis.settle();
        axis.position_steps().to_bits()
    };
    assert_eq!(run(), run());
    assert!(f64::from_bits(run()).is_finite());
}

/// A rotor one small step off its field swings like a mass on a spring: J d²x/dt² = -T p x, once in 2 pi
/// sqrt(J / (T p)).
#[test]
fn a_small_swing_takes_as_long_as_a_spring_says() {
    /// The sine of 1/16 of a full step (5.6 degrees) is a spring to 0.2 %, and the simulation goes on in
    /// steps of 20 us.
    const DEVIATION: f64 = 0.005;
    let free = StepperSettings { coulomb_n_m: 0.0, viscous_n_m_s: 0.0, ..StepperSettings::default() };
    let swing_s = std::f64::consts::TAU * (free.inertia_kg_m2 / (free.holding_n_m * 50.0)).sqrt();
    for (quarters, steps) in [(1.0, 1.0), (2.0, 2.0), (3.0, 1.0), (4.0, 0.0), (40.0, 0.0)] {
        let mut axis = StepperAxis::new(free);
        axis.pulse(Duration::ZERO, Direction::Plus);
        axis.run_to(Duration::from_secs_f64(swing_s * quarters / 4.0));
        let late = (axis.position_steps() - steps).abs();
        assert!(
            late < DEVIATION * (1.0 + quarters),
            "after {quarters} quarters at {}",
            axis.position_steps()
        );
    }
}
