//! The contouring controller ends every line, on motors far from their description: there is no place where
//! it waits for ever.

#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "numbers by chance in small ranges"
)]

use crate::closed_loop;
use crate::loaded_gantry;

use closed_loop::Loop;
use core::time::Duration;
use loaded_gantry::{decoded, loaded_gantry};
use plotter_motion::{
    Duty, MachineConfig, StepPoint,
    config::{AxisConfig, Decoding},
};

/// Numbers by chance, the same on every machine (xorshift64*).
struct Chance(u64);

impl Chance {
    fn share(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.share()
    }
}

/// The semi-virtual gantry or the loaded one, with encoders decoded as said.
fn described(is_loaded: bool, decoding: Decoding) -> MachineConfig {
    if is_loaded { loaded_gantry(decoding) } else { decoded(MachineConfig::default(), decoding) }
}

/// The axis as it is: every figure of motor and load off by up to `off`, and rest up to 1.8 times as hard to
/// leave as motion.
fn as_it_is(axis: &AxisConfig, off: f64, chance: &mut Chance) -> AxisConfig {
    let mut real = *axis;
    let mut by = || 1.0 + chance.between(-off, off);
    real.motor.inertia_kg_m2 *= by();
    real.motor.resistance_ohm *= by();
    real.motor.torque_n_m_per_a *= by();
    real.motor.back_emf_v_s *= by();
    real.motor.supply_v *= by();
    real.load.inertia_kg_m2 *= by();
    real.load.viscous_n_m_s *= by();
    real.load.coulomb_n_m *= by();
    real.load.static_n_m = real.load.coulomb_n_m * chance.between(1.0, 1.8);
    real
}

/// How one line went.
struct Outcome {
    target: StepPoint,
    arrived_s: Option<f64>,
    /// How far from the target the worse of both shafts truly is.
    short_counts: f64,
}

/// A line of 1 mm to 60 mm in any direction, with shafts that begin anywhere between two edges.
fn line(is_loaded: bool, decoding: Decoding, off: f64, seed: u64, limit: Duration) -> Outcome {
    let mut chance = Chance(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let config = described(is_loaded, decoding);
    let mut plant = config;
    plant.dc_mut().unwrap().x = as_it_is(&config.dc().unwrap().x, off, &mut chance);
    plant.dc_mut().unwrap().y = as_it_is(&config.dc().unwrap().y, off, &mut chance);
    let mut closed_loop = Loop::new(&config, &plant);
    // Somebody has turned the shafts before the machine was switched on: their counts begin anywhere.
    let mut begun = [0.0; 2];
    for (axis, begun) in closed_loop.axes.iter_mut().zip(&mut begun) {
        let duty = Duty::saturating(chance.between(-0.3, 0.3) as f32);
        for _ in 0..chance.between(0.0, 3000.0) as u32 {
            axis.step(duty, |_| ());
        }
        for _ in 0..10_000 {
            axis.step(Duty::ZERO, |_| ());
        }
        *begun = axis.position_counts();
    }
    let length = 60.0_f64.powf(chance.share()) * config.dc().unwrap().x.counts_per_mm;
    let heading = chance.between(0.0, std::f64::consts::TAU);
    let target = StepPoint::new((length * heading.cos()) as i32, (length * heading.sin()) as i32);
    closed_loop.start(target);
    while !closed_loop.controller.has_arrived() && closed_loop.now < limit {
        closed_loop.step();
    }
    let [x, y] = [0, 1].map(|axis| closed_loop.axes[axis].position_counts() - begun[axis]);
    Outcome {
        target,
        arrived_s: closed_loop.controller.has_arrived().then_some(closed_loop.now.as_secs_f64()),
        short_counts: (x - f64::from(target.x)).abs().max((y - f64::from(target.y)).abs()),
    }
}

/// `lines` random lines for each machine and decoding, on motors off by `off`; each must end within `limit`.
fn every_line_ends(off: f64, lines: u64, limit: Duration) {
    for is_loaded in [false, true] {
        for decoding in [Decoding::X1, Decoding::X4] {
            let (mut slowest_s, mut farthest_counts, mut beside) = ((0.0_f64, 0), (0.0_f64, 0), [0_u64; 4]);
            for seed in 1..=lines {
                let outcome = line(is_loaded, decoding, off, seed, limit);
                let about = format!("loaded {is_loaded}, {decoding:?}, off by {off}, seed {seed}");
                let arrived_s = outcome.arrived_s.unwrap_or(f64::INFINITY);
                assert!(arrived_s.is_finite(), "{about}: {:?} not reached in {limit:?}", outcome.target);
                if arrived_s > slowest_s.0 {
                    slowest_s = (arrived_s, seed);
                }
                beside[(outcome.short_counts as usize).min(3)] += 1;
                if outcome.short_counts > farthest_counts.0 {
                    farthest_counts = (outcome.short_counts, seed);
                }
            }
            let ((slowest_s, slow), (farthest_counts, far)) = (slowest_s, farthest_counts);
            println!(
                "off by {off}, loaded {is_loaded}, {decoding:?}: {slowest_s:.2} s at most (seed {slow}), {farthest_counts:.2} counts off the target (seed {far}), {beside:?} by 0, 1, 2, 3 and more whole ones"
            );
            // x4 counts are where the shaft is. Of x1 ones the first is known to a count, since the shafts
            // begin anywhere, and it has two places (see QuadratureX1); a line that ends farther off has lost
            // one.
            let most_lost = match decoding {
                Decoding::X1 if off > 0.3 => lines / 20 + 2,
                Decoding::X1 => lines / 40,
                _ => 0,
            };
            let lost = beside[2] + beside[3];
            assert!(lost <= most_lost, "{lost} of {lines} lines");
            assert!(decoding == Decoding::X1 || farthest_counts < 1.0, "{farthest_counts} counts");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_line_ends_on_motors_a_tenth_off() {
    every_line_ends(0.1, 20, Duration::from_secs(1));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_line_ends_on_motors_a_quarter_off() {
    every_line_ends(0.25, 20, Duration::from_secs(2));
}

/// The gain of such a motor may be beyond the margin of the loop, which then swings about its reference: the
/// line still ends.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_line_ends_on_motors_of_which_nothing_is_right() {
    every_line_ends(0.4, 20, Duration::from_secs(10));
}

#[test]
#[ignore = "minutes, in release: --test all sim_every_line_ends:: -- --ignored --nocapture"]
fn every_line_of_many_ends() {
    every_line_ends(0.25, 1000, Duration::from_secs(5));
    every_line_ends(0.4, 1000, Duration::from_secs(30));
}

/// One shaft is held fast for the last millimetre and a second more: the line ends when it is let go, not
/// before.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_held_at_its_end_ends_when_it_is_let_go() {
    const LET_GO: Duration = Duration::from_millis(1500);
    for decoding in [Decoding::X1, Decoding::X4] {
        let config = described(true, decoding);
        let length = (20.0 * config.dc().unwrap().x.counts_per_mm) as i32;
        let mut closed_loop = Loop::new(&config, &config);
        closed_loop.start(StepPoint::new(length, length / 2));
        while !closed_loop.controller.has_arrived() && closed_loop.now < LET_GO * 2 {
            let is_held = closed_loop.axes[1].position_mm() > 9.0 && closed_loop.now < LET_GO;
            closed_loop.axes[1].stall(is_held);
            closed_loop.step();
        }
        assert!(closed_loop.controller.has_arrived() && closed_loop.now > LET_GO, "{:?}", closed_loop.now);
    }
}
