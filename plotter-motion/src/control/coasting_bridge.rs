//! [`CoastingBridge`]: what pulses on a bridge's enable pin do, as the voltage that does the same without
//! pulses.

use crate::config::CLAMPS_V;
use crate::{Duty, config::AxisConfig};
use core::f64::consts::TAU;

/// A bridge that opens the motor's winding between its pulses.
///
/// In a pulse of the share `d` of its period T the current rises towards what supply V and back EMF e allow;
/// then it falls through the clamp diodes, against V + c, and is over after the time t2. From L di/dt = v - R
/// i over a period that begins and ends without a current:
///
/// ```text
///   R * mean current = (V - e) d - (V + c + e) t2/T        t2 = tau ln(1 + (V - e)(1 - exp(-d T/tau)) / (V + c + e)),  tau = L/R
/// ```
///
/// and at most what is left of the period. A motor under the voltage `R * mean current + e` gets the same
/// mean current: that is the voltage that a control law reckons with. All voltages are those in the direction
/// of the pulse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CoastingBridge {
    /// Period of the pulses, s.
    pub period_s: f32,
    /// L/R as a share of the pulses' period.
    pub tau_periods: f32,
    /// Back EMF as a share of the supply, by speed in counts/s.
    pub back_emf_s: f32,
    /// Voltage of the clamp diodes, as a fraction of the supply.
    pub clamps: f32,
}

impl CoastingBridge {
    /// That of an axis; `None` if its bridge brakes between its pulses.
    pub(super) fn of(axis: &AxisConfig) -> Option<Self> {
        let motor = &axis.motor;
        let rad_per_count = TAU / axis.counts_per_turn();
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        (motor.enable_pwm_hz > 0.0).then(|| Self {
            period_s: (1.0 / motor.enable_pwm_hz) as f32,
            tau_periods: (motor.inductance_h / motor.resistance_ohm * motor.enable_pwm_hz) as f32,
            back_emf_s: (motor.back_emf_v_s * rad_per_count / motor.supply_v) as f32,
            clamps: (CLAMPS_V / motor.supply_v) as f32,
        })
    }

    /// The share of the supply that does what pulses of `duty` do at `speed`, counts/s.
    pub(super) fn voltage(&self, duty: Duty, speed: f32) -> f32 {
        let (duty, back_emf) = (duty.value(), self.back_emf_s * speed);
        if duty == 0.0 {
            return back_emf; // no current
        }
        back_emf + libm::copysignf(self.pull(duty.abs(), libm::copysignf(1.0, duty) * back_emf).0, duty)
    }

    /// How fast pulses of `duty` push on a shaft that stands again before the next one, counts/s: one whose
    /// dry friction holds it against their mean, but not against their peaks. Friction, and what the whole
    /// supply accelerates it by, are in counts/s^2.
    ///
    /// The current of a short pulse rises to its peak and falls to nothing as straight lines. While it is
    /// above the friction the shaft gains speed, under a push that is a triangle; then friction takes it
    /// again, and the rest of the current holds half of the friction off.
    pub(super) fn creep(&self, duty: Duty, friction: f32, accel: f32) -> f32 {
        let (value, Circuit { rise, fall }) = (duty.value().abs(), self.circuit(0.0));
        // 1 - exp(-x) to 3 % for x up to 1, as short pulses have it
        let x = value / self.tau_periods;
        let peak = rise * x / (1.0 + 0.55 * x);
        let push = accel * peak;
        if push <= friction {
            return 0.0;
        }
        let (falls, held) = (self.tau_periods * peak / (fall + 0.5 * peak), friction / push);
        let above_s = (value + falls) * (1.0 - held) * self.period_s;
        let speed = 0.5 * (push - friction) * above_s;
        let tail_s = falls * held * self.period_s;
        libm::copysignf(0.5 * speed * (above_s + tail_s + speed / friction) / self.period_s, duty.value())
    }

    /// The duty, -1 to 1, whose pulses do at `speed` what the share `voltage` of the supply does.
    pub(super) fn duty(&self, voltage: f32, speed: f32) -> f32 {
        let back_emf = self.back_emf_s * speed;
        let wanted = voltage - back_emf;
        let against = libm::copysignf(1.0, wanted) * back_emf;
        let Circuit { rise, fall } = self.circuit(against);
        let wanted_pull = wanted.abs();
        // Short pulses give (V - e) d^2 T/2tau (1 + (V - e) / (V + c + e)), long ones at most (V - e) d.
        let short = libm::sqrtf(2.0 * self.tau_periods * wanted_pull / (rise * (1.0 + rise / fall)));
        let mut duty = short.max(wanted_pull / rise).min(1.0);
        // The pull grows faster and faster with the duty: Newton's steps come down to it from above, and
        // three are enough for a part in 255.
        const STEPS: u8 = 3;
        for _ in 0..STEPS {
            let (pull, slope) = self.pull(duty, against);
            duty = (duty + (wanted_pull - pull) / slope).clamp(0.0, 1.0);
        }
        if duty.is_finite() { libm::copysignf(duty, wanted) } else { 0.0 }
    }

    fn circuit(&self, against: f32) -> Circuit {
        // A motor turned faster than its supply can turn it takes no current from it; below this share none
        // counts.
        const LEAST: f32 = 1e-3;
        Circuit { rise: (1.0 - against).max(LEAST), fall: (1.0 + self.clamps + against).max(LEAST) }
    }

    /// R times the mean current under a duty above 0, with a back EMF `against` it, as a share of the supply;
    /// and its slope.
    fn pull(&self, duty: f32, against: f32) -> (f32, f32) {
        let Circuit { rise, fall } = self.circuit(against);
        let decay = libm::expf(-duty / self.tau_periods);
        let peak = 1.0 + rise * (1.0 - decay) / fall;
        let falls = self.tau_periods * libm::logf(peak);
        if falls > 1.0 - duty {
            // the current never ends: the mean of both voltages
            return (rise * duty - fall * (1.0 - duty), rise + fall);
        }
        (rise * duty - fall * falls, (rise * (1.0 - decay / peak)).max(f32::MIN_POSITIVE))
    }
}

/// What makes a current rise in a pulse, and fall after it, as shares of the supply.
struct Circuit {
    rise: f32,
    fall: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::MotorConfig;
    use crate::plant::AxisPlant;

    fn axis() -> AxisConfig {
        let mut axis = AxisConfig::default();
        axis.motor.enable_pwm_hz = 2_500.0;
        axis
    }

    /// The speed at which a motor without friction runs free, by pulses and by the voltage that does the
    /// same.
    #[test]
    fn pulses_do_what_their_voltage_does() {
        let mut axis = axis();
        axis.load =
            crate::config::LoadConfig { coulomb_n_m: 0.0, static_n_m: 0.0, viscous_n_m_s: 2e-5, ..axis.load };
        let bridge = CoastingBridge::of(&axis).unwrap();
        for duty in [-0.9_f32, 0.05, 0.1, 0.2, 0.5, 0.8, 1.0] {
            let mut plant = AxisPlant::new(&axis, 1e-6);
            for _ in 0..400_000 {
                plant.step(Duty::saturating(duty), |_| ());
            }
            let rad_s = plant.state().speed_rad_s;
            let MotorConfig { supply_v, back_emf_v_s, torque_n_m_per_a, resistance_ohm, .. } = axis.motor;
            // at rest of its speed the current is what viscous friction takes
            let expected =
                (resistance_ohm * axis.load.viscous_n_m_s / torque_n_m_per_a + back_emf_v_s) * rad_s;
            #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
            let speed = (rad_s * axis.counts_per_turn() / TAU) as f32;
            let found = f64::from(bridge.voltage(Duty::saturating(duty), speed)) * supply_v;
            assert!((found / expected - 1.0).abs() < 0.01, "{duty}: {found} V, {expected} V");
        }
    }

    #[test]
    fn the_duty_of_a_voltage_does_what_it_does() {
        let bridge = CoastingBridge::of(&axis()).unwrap();
        for speed in [-40_000.0_f32, -5_000.0, 0.0, 300.0, 20_000.0, 60_000.0] {
            for step in -95..=95_i16 {
                let voltage = f32::from(step) / 100.0;
                let duty = bridge.duty(voltage, speed);
                let found = bridge.voltage(Duty::saturating(duty), speed);
                assert!(
                    (found - voltage).abs() < 0.002 || duty.abs() == 1.0,
                    "{speed} {voltage}: {duty}, {found}"
                );
            }
        }
    }

    /// A shaft that friction holds against the mean of the pulses, and not against their peaks.
    #[test]
    fn a_shaft_creeps_under_pulses_below_its_friction() {
        let axis = axis();
        let (bridge, model) = (CoastingBridge::of(&axis).unwrap(), crate::control::ShaftModel::new(&axis));
        let accel = model.accel_per_volt * model.supply_v;
        let friction = model.dry_friction;
        for share in [0.5_f32, 0.8, 0.95] {
            let duty = Duty::saturating(bridge.duty(share * friction / accel, 0.0));
            let mut plant = AxisPlant::new(&axis, 1e-6);
            for _ in 0..400_000 {
                plant.step(duty, |_| ());
            }
            let counts_s = (plant.position_counts() - AxisPlant::new(&axis, 1e-6).position_counts()) / 0.4;
            let found = f64::from(bridge.creep(duty, friction, accel));
            assert!((found / counts_s - 1.0).abs() < 0.15, "{share}: {found} counts/s, {counts_s} counts/s");
        }
    }

    #[test]
    fn a_winding_that_is_open_is_not_braked() {
        let bridge = CoastingBridge::of(&axis()).unwrap();
        let own = bridge.voltage(Duty::ZERO, 10_000.0);
        // 10000 counts/s of 500 a turn: 125.66 rad/s, 1.68 V of 12
        assert!((own - 0.14).abs() < 1e-4, "{own}");
        assert_eq!(bridge.duty(own, 10_000.0), 0.0);
    }
}
