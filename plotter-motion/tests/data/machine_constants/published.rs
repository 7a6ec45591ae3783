/// A gantry with DC motors, from its file.
#[allow(unused_imports, clippy::unreadable_literal, clippy::excessive_precision, clippy::wildcard_imports, reason = "written by a build script")]
pub mod gantry {
use plotter_motion::config::*;
use plotter_motion::control::*;
use plotter_motion::firmware::GantrySettings;
use plotter_motion::{MotionLimits, SafetyGate, StepPoint};
/// Bits a second of its line.
pub const BAUD: u32 = 256000;
/// Steps of the PWM, x and y.
pub const PWM_STEPS: [u16; 2] = [255, 255];
/// How the encoders are counted, x and y.
pub const DECODING: [Decoding; 2] = [Decoding::X1, Decoding::X1];
/// The axis, for those who simulate it.
pub const X: AxisConfig = AxisConfig { counts_per_mm: 40.0, encoder: EncoderConfig { lines_per_turn: 500, decoding: Decoding::X1 }, motor: MotorConfig { supply_v: 12.0, pwm_steps: 255, enable_pwm_hz: 0.0, resistance_ohm: 1.9, inductance_h: 6.5e-5, back_emf_v_s: 0.013369, torque_n_m_per_a: 0.0134, inertia_kg_m2: 5.7e-7 }, load: LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0013, static_n_m: 0.0013, viscous_n_m_s: 1e-6 }, transmission: TransmissionConfig { backlash_mm: 0.0, stiffness_n_per_mm: 0.0, damping_n_s_per_mm: 0.0, carriage_kg: 0.0, rail_friction_n: 0.0 } };
/// The axis, for those who simulate it.
pub const Y: AxisConfig = AxisConfig { counts_per_mm: 40.0, encoder: EncoderConfig { lines_per_turn: 500, decoding: Decoding::X1 }, motor: MotorConfig { supply_v: 12.0, pwm_steps: 255, enable_pwm_hz: 0.0, resistance_ohm: 1.9, inductance_h: 6.5e-5, back_emf_v_s: 0.013369, torque_n_m_per_a: 0.0134, inertia_kg_m2: 5.7e-7 }, load: LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0013, static_n_m: 0.0013, viscous_n_m_s: 1e-6 }, transmission: TransmissionConfig { backlash_mm: 0.0, stiffness_n_per_mm: 0.0, damping_n_s_per_mm: 0.0, carriage_kg: 0.0, rail_friction_n: 0.0 } };
const GANTRY: GantrySettings = GantrySettings { resync_gap_us: 100000, most: StepPoint { x: 23760, y: 16800 } };
const LINE: LineTrackingSettings = LineTrackingSettings { published: PublishedConfig { kp: 15.0, ki: 1e-5, kd_x: 0.0, kd_y: 10.0, duty_limit_x: 20.0, duty_limit_y: 255.0, duty_limit_y_vertical: 15.0 }, sync_stop: SyncStop { slope_counts: 10.0, offset_counts: 10.0 } };
/// Its controller.
pub type Gantry = plotter_motion::firmware::Gantry<LineTracking>;
/// Its controller, at rest at the origin.
#[must_use]
pub fn gantry(gate: SafetyGate) -> Gantry {
Gantry::with_settings(GANTRY, LineTracking::with_settings(LINE), gate)
}
}
