//! Laws of auto-tuning for any plausible motor: an experiment ends in bounded time and travel, with an error
//! or with gains that are stable on the true motor; margins are what the loop does.

use crate::tuning_bench;

use crate::law_cases::cases;
use plotter_motion::control::tuning::{
    Compensator, ExperimentSettings, IntegratingProcess, LoopMargins, RelayExperiment, SampledLoop, Simc,
    StepExperiment,
};
use plotter_motion::{
    Axis, Demand,
    config::{AxisConfig, Decoding, EncoderConfig, LoadConfig, MotorConfig},
    control::Pid,
};
use proptest::prelude::*;
use tuning_bench::{Bench, margins, relay_experiment, step_experiment};

fn decoding() -> impl Strategy<Value = Decoding> {
    prop_oneof![Just(Decoding::X1), Just(Decoding::X2), Just(Decoding::X4)]
}

/// From `low` to `high`, evenly in decades.
fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

/// Small gear motors and large ones, stiff and worn, with coarse encoders and fine ones.
fn axis() -> impl Strategy<Value = AxisConfig> {
    let motor =
        (decades(0.3, 30.0), decades(1e-5, 1e-3), decades(3e-3, 0.1), decades(1.5e-3, 0.1), 6.0..48.0_f64);
    let load = (0.0..5.0_f64, 0.0..0.15_f64, 1.0..1.5_f64, 0.0..0.3_f64);
    let encoder = (decades(12.0, 2000.0), decoding(), prop_oneof![Just(100_u32), Just(255), Just(1000)]);
    (motor, load, encoder).prop_map(|(motor, load, encoder)| {
        let (r, electrical_s, k, mechanical_s, supply_v) = motor;
        let (inertias, friction, stiction, viscous) = load;
        let (lines, decoding, pwm_steps) = encoder;
        // the lag R J / k² of the rotor alone, 1.5 to 100 ms
        let rotor = mechanical_s * k * k / r;
        let coulomb = friction * k * supply_v / r;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "12 to 2000")]
        let lines_per_turn = lines as u32;
        AxisConfig {
            encoder: EncoderConfig { lines_per_turn, decoding },
            motor: MotorConfig {
                supply_v,
                pwm_steps,
                enable_pwm_hz: 0.0,
                resistance_ohm: r,
                inductance_h: electrical_s * r,
                back_emf_v_s: k,
                torque_n_m_per_a: k,
                inertia_kg_m2: rotor,
            },
            load: LoadConfig {
                inertia_kg_m2: inertias * rotor,
                coulomb_n_m: coulomb,
                static_n_m: stiction * coulomb,
                viscous_n_m_s: viscous * k * k / r,
            },
            ..AxisConfig::default()
        }
    })
}

fn settings(tick_s: f64, travel_counts: i32, axis: &AxisConfig) -> ExperimentSettings {
    ExperimentSettings {
        axis: Axis::X,
        tick_s,
        travel_counts,
        most_duty: 0.6,
        pwm_steps: u16::try_from(axis.motor.pwm_steps).unwrap_or(u16::MAX),
        most_s: 20.0,
    }
}

fn tick_s() -> impl Strategy<Value = f64> {
    prop_oneof![Just(2e-4), Just(4e-4), Just(1e-3), Just(2e-3)]
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn a_step_experiment_ends_in_its_bounds_with_an_error_or_a_loop_that_is_stable(
        axis in axis(), tick_s in tick_s(), travel in decades(100.0, 20_000.0), reversed in prop::bool::weighted(0.05),
    ) {
        #[expect(clippy::cast_possible_truncation, reason = "up to 20000")]
        let bounds = settings(tick_s, travel as i32, &axis);
        let mut bench = Bench::new(&axis, tick_s);
        bench.reversed = reversed;
        let outcome = step_experiment(&mut bench, bounds);
        // a count beside the true place, and as much way as two ticks at full speed take
        let ticks = 2.0 * tick_s * IntegratingProcess::of(&axis).gain_counts_s;
        prop_assert!(bench.farthest <= f64::from(bounds.travel_counts) + 2.0 + ticks, "{} of {travel}", bench.farthest);
        let Ok(found) = outcome else { return Ok(()) };
        prop_assert!(!reversed && found.took_s <= bounds.most_s);
        for _ in 0..1000 {
            bench.tick(Demand::NONE); // it runs down
        }
        prop_assert!(bench.farthest <= f64::from(bounds.travel_counts), "{} of {travel}", bench.farthest);
        let tuned = Simc::default().tune(&found.process, tick_s).unwrap();
        let reached = margins(&axis, &tuned.pid, tick_s);
        prop_assert!(reached.stable, "{found:?} {tuned:?} {reached:?}");
        // asked are 1.6; what some hundred counts of a coarse encoder tell is not exact
        prop_assert!(reached.max_sensitivity < 3.0, "{found:?} {tuned:?} {reached:?}, true {:?}", IntegratingProcess::of(&axis));
    }

    #[test]
    fn a_relay_experiment_ends_in_its_bounds_with_an_error_or_a_loop_that_is_stable(
        axis in axis(), tick_s in tick_s(), travel in decades(100.0, 20_000.0), reversed in prop::bool::weighted(0.05),
    ) {
        #[expect(clippy::cast_possible_truncation, reason = "up to 20000")]
        let bounds = settings(tick_s, travel as i32, &axis);
        let mut bench = Bench::new(&axis, tick_s);
        bench.reversed = reversed;
        let outcome = relay_experiment(&mut bench, bounds);
        let process = IntegratingProcess::of(&axis);
        let ticks = 2.0 * tick_s * process.gain_counts_s;
        prop_assert!(bench.farthest <= f64::from(bounds.travel_counts) + 2.0 + ticks, "{} of {travel}", bench.farthest);
        let Ok(found) = outcome else { return Ok(()) };
        prop_assert!(!reversed && found.took_s <= bounds.most_s);
        let found = found.without_friction(IntegratingProcess::dry_friction_duty(&axis));
        if let Ok(pid) = found.astrom_hagglund(45.0) {
            let reached = margins(&axis, &pid, tick_s);
            // friction of up to a quarter of the relay's duty is put to account, but what it makes of the
            // swing's shape is not
            prop_assert!(reached.stable && reached.phase_margin_deg > 15.0, "{found:?} {reached:?} {process:?}");
        }
    }

    /// Whatever an encoder counts, the experiments end, and ask for no more than they may.
    #[test]
    fn experiments_end_whatever_is_counted(
        counts in prop::collection::vec(prop_oneof![4 => -3..4_i32, 1 => -1000..1000_i32, 1 => any::<i32>()], 1..200),
        adds in any::<bool>(), odd in prop::option::weighted(0.2, prop::array::uniform3(any::<f64>())),
    ) {
        let bounds = ExperimentSettings { most_s: 5.0, ..settings(1e-3, 2000, &AxisConfig::default()) };
        let bounds = match odd {
            Some([tick_s, most_duty, most_s]) => ExperimentSettings { tick_s, most_duty, most_s, ..bounds },
            None => bounds,
        };
        let (mut step, mut relay) = (StepExperiment::new(bounds), RelayExperiment::new(bounds));
        let mut count = 0_i32;
        for tick in 0..5_002_usize {
            let next = counts.get(tick % counts.len()).copied().unwrap_or_default();
            count = if adds { count.saturating_add(next) } else { next };
            for demand in [step.tick(count), relay.tick(count)] {
                let most = if odd.is_some() { 1.0 } else { 0.6 + 1e-6 };
                prop_assert!(demand.x.value().abs() <= most && demand.y.value() == 0.0);
            }
        }
        prop_assert!(odd.is_some() || (step.outcome().is_some() && relay.outcome().is_some()));
    }

    /// A loop of any numbers has some margins, in bounded time.
    #[test]
    fn margins_are_total(
        process in prop::array::uniform4(prop_oneof![3 => decades(1e-6, 1e6), 1 => any::<f64>()]),
        gains in prop::array::uniform4(prop_oneof![3 => 1e-6..1e3_f32, 1 => any::<f32>()]),
        tick_s in prop_oneof![5 => decades(1e-6, 1.0), 1 => any::<f64>()],
    ) {
        let [gain_counts_s, time_constant_s, second_time_constant_s, dead_time_s] = process;
        let process = IntegratingProcess { gain_counts_s, time_constant_s, second_time_constant_s, dead_time_s };
        let [kp, ki, kd, derivative_filter_s] = gains;
        let pid = Pid { kp, ki, kd, derivative_filter_s, output_min: -1.0, output_max: 1.0 };
        let reached = LoopMargins::from_loop(&SampledLoop { process, compensator: Compensator::Pid(pid), tick_s });
        prop_assert!(!reached.stable || reached.gain_margin >= 1.0, "{reached:?}");
    }

    /// The margins of any PID are where Nyquist's criterion changes its mind.
    #[test]
    fn a_loop_is_stable_up_to_its_gain_margin(
        axis in axis(), tick_s in tick_s(), delay_ticks in prop_oneof![4 => 0.0..4.0_f64, 1 => 4.0..100.0],
        lambda_share in decades(0.05, 50.0), factor in decades(0.1, 10.0),
    ) {
        let process = IntegratingProcess { dead_time_s: delay_ticks * tick_s, ..IntegratingProcess::of(&axis) };
        let pid = Simc::gains(&process, tick_s, lambda_share * process.lag_and_delay_s(tick_s).1);
        #[expect(clippy::cast_possible_truncation, reason = "f32 gains")]
        let factor = factor as f32;
        let pid = Pid { kp: pid.kp * factor, ki: pid.ki * factor, kd: pid.kd * factor, ..pid };
        let cut = SampledLoop { process, compensator: Compensator::Pid(pid), tick_s };
        let reached = LoopMargins::from_loop(&cut);
        prop_assert!(!reached.gain_margin.is_nan() && !reached.max_sensitivity.is_nan() && reached.max_sensitivity >= 1.0 - 1e-9);
        if reached.stable {
            prop_assert!(reached.gain_margin > 1.0 && reached.gain_reduction < 1.0, "{reached:?}");
            prop_assert!(cut.is_stable(0.99 * reached.gain_margin.min(1e6)), "{reached:?}");
            prop_assert!(cut.is_stable(1.01 * reached.gain_reduction.max(1e-6)), "{reached:?}");
            if reached.gain_margin < 1e6 {
                prop_assert!(!cut.is_stable(1.01 * reached.gain_margin), "{reached:?}");
            }
            // as much delay as it stands, and no more
            let later = |share: f64| SampledLoop {
                process: IntegratingProcess { dead_time_s: process.dead_time_s + share * reached.delay_margin_s, ..process },
                ..cut
            };
            if reached.crossover_hz * tick_s < 0.1 {
                prop_assert!(later(0.97).is_stable(1.0), "{reached:?}");
                prop_assert!(!later(1.05).is_stable(1.0), "{reached:?}");
            }
        } else if reached.gain_margin > 0.0 {
            prop_assert!(cut.is_stable(0.99 * reached.gain_margin) && reached.phase_margin_deg < 0.0, "{reached:?}");
        }
    }
}
