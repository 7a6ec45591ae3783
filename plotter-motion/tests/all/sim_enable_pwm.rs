//! Pulses on a bridge's enable pin against the circuit itself, solved in steps of 20 ns: supply, two diodes,
//! winding, rotor.

#![expect(clippy::cast_possible_truncation, reason = "some millions of steps; duties in 255ths")]

use crate::figure::Figure;
use core::time::Duration;
use plotter_motion::plant::AxisPlant;
use plotter_motion::{
    Duty,
    config::{AxisConfig, LoadConfig},
};

/// Speed, rad/s, and angle, rad, after a time from rest; the greatest current, A.
fn circuit(axis: &AxisConfig, duty: f64, time: Duration) -> [f64; 3] {
    const DT_S: f64 = 20e-9;
    // The diodes of an L293D: 1.3 V each (SLRS008D).
    const DIODES_V: f64 = 2.6;
    let motor = &axis.motor;
    let inertia = motor.inertia_kg_m2 + axis.load.inertia_kg_m2;
    let (mut current, mut speed, mut angle, mut greatest) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let steps = (time.as_secs_f64() / DT_S).round() as u64;
    let period = (1.0 / motor.enable_pwm_hz / DT_S).round() as u64;
    for step in 0..steps {
        let is_on = ((step % period) as f64) < duty.abs() * period as f64;
        let emf_v = motor.back_emf_v_s * speed;
        let voltage = if is_on {
            motor.supply_v * duty.signum()
        } else {
            -(motor.supply_v + DIODES_V) * current.signum()
        };
        let before = current;
        if is_on || current != 0.0 {
            current += DT_S * (voltage - motor.resistance_ohm * current - emf_v) / motor.inductance_h;
        }
        if !is_on && before * current < 0.0 {
            current = 0.0; // a diode does not let it through the other way
        }
        greatest = greatest.max(current.abs());
        let pull = motor.torque_n_m_per_a * current - axis.load.viscous_n_m_s * speed;
        let friction = if speed == 0.0 {
            pull.clamp(-axis.load.static_n_m, axis.load.static_n_m)
        } else {
            axis.load.coulomb_n_m * speed.signum()
        };
        let next = speed + DT_S * (pull - friction) / inertia;
        speed = if speed * next < 0.0 { 0.0 } else { next };
        angle += DT_S * speed;
    }
    [speed, angle, greatest]
}

fn axis(hz: f64, inductance_h: f64) -> AxisConfig {
    let mut axis = AxisConfig::default();
    (axis.motor.enable_pwm_hz, axis.motor.inductance_h) = (hz, inductance_h);
    axis.load = LoadConfig { inertia_kg_m2: 5e-6, coulomb_n_m: 1e-3, static_n_m: 1e-3, viscous_n_m_s: 1e-6 };
    axis
}

static SLOWER: Figure = Figure::of("% beyond 0.1 rad/s");

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn pulses_turn_a_motor_as_their_circuit_does() {
    let time = Duration::from_millis(60);
    for (hz, inductance_h) in [(2_500.0, 6.5e-5), (2_500.0, 1e-3), (20_000.0, 6.5e-5), (500.0, 2e-5)] {
        let axis = axis(hz, inductance_h);
        for steps in [51, 102, -153, 255] {
            let duty = f64::from(steps) / 255.0;
            let [speed, angle, current] = circuit(&axis, duty, time);
            for step in [Duration::from_micros(10), Duration::from_micros(200)] {
                let mut plant = AxisPlant::new(&axis, step.as_secs_f64());
                for _ in 0..time.as_micros() / step.as_micros() {
                    plant.step(Duty::saturating(duty as f32), |_| ());
                }
                let found = plant.state();
                let about = format!(
                    "{hz} Hz, {inductance_h} H, duty {duty:.2}, steps of {step:?}: {found:?}, {speed} {angle} {current}"
                );
                // of the speed, or of one that is nearly none
                let slack = 0.02 * speed.abs() + 0.1;
                SLOWER.note(100.0 * ((found.speed_rad_s - speed).abs() - 0.1).max(0.0) / speed.abs());
                assert!((found.speed_rad_s - speed).abs() <= slack, "{about}");
                assert!((found.angle_rad - angle).abs() <= 0.02 * angle.abs() + 2e-3, "{about}");
            }
        }
    }
}

/// What the mean of the voltage would say is far from it: so the test above sees which of both is simulated.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_mean_voltage_is_another_motor() {
    let pulsed = axis(2_500.0, 6.5e-5);
    let [speed, ..] = circuit(&pulsed, 0.2, Duration::from_millis(300));
    let mut plant = AxisPlant::new(&axis(0.0, 6.5e-5), 1e-5);
    for _ in 0..30_000 {
        plant.step(Duty::saturating(0.2), |_| ());
    }
    let mean = plant.state().speed_rad_s;
    assert!((mean / speed - 1.0).abs() > 0.2, "{mean} {speed}");
}

/// Let go, a shaft is slowed down by its friction only; a bridge that brakes in between stops it with its own
/// voltage, too.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn without_pulses_the_motor_runs_free() {
    let ways = [2_500.0, 0.0].map(|hz| {
        let axis = axis(hz, 6.5e-5);
        let mut plant = AxisPlant::new(&axis, 1e-5);
        for _ in 0..20_000 {
            plant.step(Duty::saturating(0.5), |_| ());
        }
        let (before, speed) = (plant.state().angle_rad, plant.state().speed_rad_s);
        for _ in 0..300_000 {
            plant.step(Duty::ZERO, |_| ());
        }
        assert_eq!(plant.state().speed_rad_s, 0.0);
        // v^2 / 2a, with the little that viscous friction adds to a
        let free = speed * speed * 5.57e-6 / (2.0 * 1e-3);
        (plant.state().angle_rad - before) / free
    });
    assert!((0.7..=1.0).contains(&ways[0]) && ways[1] < 0.2, "{ways:?}");
}
