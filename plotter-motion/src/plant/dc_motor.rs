//! A DC motor: armature current, speed and angle under voltage and load torque.
//!
//! ```text
//!   L di/dt = V - R i - Ke w        J dw/dt = Kt i - b w - T        dangle/dt = w
//! ```
//!
//! Spec 1.8; the thesis' equations 4.1 to 4.12. Without load the transfer function is
//! angle/V = Kt / (s (J L s² + J R s + Ke Kt)) and the final speed (V - R T/Kt)/Ke.
//!
//! Discretization: exact for a voltage and a torque held over the step (zero-order hold), by the exponential
//! of the system's matrix, so a long step is as right as a short one and nothing can become unstable.

use super::matrix::{Matrix, exponential};
use crate::config::{LoadConfig, MotorConfig};

/// Current, speed and angle of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DcMotorState {
    /// Armature current, A.
    pub current_a: f64,
    /// Speed of the shaft, rad/s.
    pub speed_rad_s: f64,
    /// Angle of the shaft, rad.
    pub angle_rad: f64,
}

/// A motor's equations over one fixed time step.
///
/// ```
/// # use plotter_motion::{config::{LoadConfig, MotorConfig}, plant::{DcMotor, DcMotorState}};
/// let alone = LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0, static_n_m: 0.0, viscous_n_m_s: 0.0 };
/// let motor = DcMotor::new(&MotorConfig::default(), &alone, 1.0); // a step of one second
/// let state = motor.step(DcMotorState::default(), 12.0, 0.0);
/// assert!((state.speed_rad_s - 897.599).abs() < 1e-3); // 12 V / 13.369e-3 V s: full speed long ago
/// let held = motor.step_held(DcMotorState::default(), 12.0);
/// assert!((held.current_a - 6.316).abs() < 1e-3); // 12 V / 1.9 ohm
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DcMotor {
    /// Next (current, speed, angle) from the present ones (columns 0 to 2), voltage (3) and torque (4).
    next: [[f64; 5]; 3],
    /// The same with the shaft held: next current from the present one and the voltage.
    held: [f64; 2],
    torque_n_m_per_a: f64,
}

impl DcMotor {
    /// The motor with its load's inertia and viscous friction, over steps of `dt_s`. (Dry friction is not
    /// linear: [`AxisPlant`](super::AxisPlant) adds it as a torque.)
    ///
    /// The constants must be those of a checked [`Machine`](crate::Machine): positive.
    #[must_use]
    pub fn new(motor: &MotorConfig, load: &LoadConfig, dt_s: f64) -> Self {
        let (l, r) = (motor.inductance_h, motor.resistance_ohm);
        let j = motor.inertia_kg_m2 + load.inertia_kg_m2;
        let mut a: Matrix<5> = [[0.0; 5]; 5];
        a[0] = [-r / l, -motor.back_emf_v_s / l, 0.0, 1.0 / l, 0.0];
        a[1] = [motor.torque_n_m_per_a / j, -load.viscous_n_m_s / j, 0.0, 0.0, -1.0 / j];
        a[2] = [0.0, 1.0, 0.0, 0.0, 0.0];
        let [current, speed, angle, ..] = exponential(&a.map(|row| row.map(|v| v * dt_s)));
        let decay = libm::exp(-r / l * dt_s);
        Self {
            next: [current, speed, angle],
            held: [decay, (1.0 - decay) / r],
            torque_n_m_per_a: motor.torque_n_m_per_a,
        }
    }

    /// The state one step later under `voltage_v` and the load torque `torque_n_m` (positive: against
    /// forward motion), both held over the step.
    #[must_use]
    pub fn step(&self, state: DcMotorState, voltage_v: f64, torque_n_m: f64) -> DcMotorState {
        let input = [state.current_a, state.speed_rad_s, state.angle_rad, voltage_v, torque_n_m];
        let row = |row: &[f64; 5]| row.iter().zip(&input).map(|(a, b)| a * b).sum();
        let [current, speed, angle] = &self.next;
        DcMotorState { current_a: row(current), speed_rad_s: row(speed), angle_rad: row(angle) }
    }

    /// The state one step later with the shaft held fast.
    #[must_use]
    pub fn step_held(&self, state: DcMotorState, voltage_v: f64) -> DcMotorState {
        let [decay, gain] = self.held;
        DcMotorState { current_a: decay * state.current_a + gain * voltage_v, speed_rad_s: 0.0, ..state }
    }

    /// Torque of the armature at `state`, N m.
    #[must_use]
    pub fn armature_torque_n_m(&self, state: DcMotorState) -> f64 {
        self.torque_n_m_per_a * state.current_a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNLOADED: LoadConfig =
        LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0, static_n_m: 0.0, viscous_n_m_s: 0.0 };
    /// Share of the final value; what is left is rounding.
    const RELATIVE_ERROR: f64 = 1e-9;

    /// Speed and angle t after a step to V: w = V/Ke (1 + (p2 e^(p1 t) - p1 e^(p2 t))/(p1 - p2)) with the
    /// poles p of L J s² + R J s + Ke Kt, and its integral.
    fn analytic(motor: &MotorConfig, voltage_v: f64, t: f64) -> (f64, f64) {
        let (a, b) = (motor.inductance_h * motor.inertia_kg_m2, motor.resistance_ohm * motor.inertia_kg_m2);
        let root = libm::sqrt(b * b - 4.0 * a * motor.back_emf_v_s * motor.torque_n_m_per_a);
        let (p1, p2) = ((-b + root) / (2.0 * a), (-b - root) / (2.0 * a));
        let last = voltage_v / motor.back_emf_v_s;
        let (e1, e2) = (libm::exp(p1 * t), libm::exp(p2 * t));
        let speed = last * (1.0 + (p2 * e1 - p1 * e2) / (p1 - p2));
        let angle = last * (t + (p2 / p1 * (e1 - 1.0) - p1 / p2 * (e2 - 1.0)) / (p1 - p2));
        (speed, angle)
    }

    #[test]
    fn the_step_response_is_the_analytic_one_at_any_step_size() {
        let config = MotorConfig::default();
        for (dt_s, steps) in [(1e-6, 20_000), (1e-5, 2_000), (4e-4, 50), (2e-2, 1)] {
            let motor = DcMotor::new(&config, &UNLOADED, dt_s);
            let mut state = DcMotorState::default();
            for _ in 0..steps {
                state = motor.step(state, 12.0, 0.0);
            }
            let (speed, angle) = analytic(&config, 12.0, 0.02);
            assert!((state.speed_rad_s / speed - 1.0).abs() < RELATIVE_ERROR, "{dt_s}: {state:?} {speed}");
            assert!((state.angle_rad / angle - 1.0).abs() < RELATIVE_ERROR, "{dt_s}: {state:?} {angle}");
        }
    }

    #[test]
    fn the_final_speed_under_load_is_the_thesis_equation_4_5b() {
        let config = MotorConfig::default();
        let motor = DcMotor::new(&config, &UNLOADED, 1e-4);
        let (voltage_v, torque_n_m) = (6.0, 5e-3);
        let mut state = DcMotorState::default();
        for _ in 0..10_000 {
            state = motor.step(state, voltage_v, torque_n_m);
        }
        let expected = (voltage_v - 1.9 * torque_n_m / 13.4e-3) / 13.369e-3;
        assert!((state.speed_rad_s / expected - 1.0).abs() < RELATIVE_ERROR, "{state:?} {expected}");
    }

    #[test]
    fn a_held_shaft_draws_the_stall_current() {
        let motor = DcMotor::new(&MotorConfig::default(), &UNLOADED, 1e-3);
        let state = motor.step_held(DcMotorState::default(), 12.0);
        assert!((state.current_a / (12.0 / 1.9) - 1.0).abs() < RELATIVE_ERROR, "{state:?}");
        assert_eq!(state.speed_rad_s, 0.0);
    }
}
