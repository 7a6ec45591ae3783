//! [`BeltDrive`]: a motor that moves a carriage by a belt that stretches, with play.
//!
//! ```text
//!   motor, encoder        belt             carriage, pen
//!     i, w, angle ──┤ play ├──/\/\/\──[ mass ]══ rail, dry friction
//!                            └─[|─┘
//!   L di/dt = V - R i - Ke w                     F = k (s - play/2) + c ds/dt,  s = r angle - place, while |s| > play/2
//!   J dw/dt = Kt i - b w - T - r F               F = 0 while the motor crosses the play
//!   m dv/dt = F - rail friction                  dplace/dt = v
//! ```

use super::dc_motor::DcMotorState;
use super::matrix::{Matrix, exponential};
use crate::config::{AxisConfig, MotorConfig};

/// A DC motor, its belt and its carriage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BeltDriveState {
    /// The motor: current, speed and angle.
    pub motor: DcMotorState,
    /// Speed of the carriage, mm/s.
    pub carriage_mm_s: f64,
    /// Place of the carriage, mm.
    pub carriage_mm: f64,
}

/// Their equations over one fixed time step: exact for a voltage and friction held over the step, whether the
/// belt pulls or the motor crosses the play; so the stiffest belt cannot become unstable.
///
/// ```
/// # use plotter_motion::config::{AxisConfig, TransmissionConfig};
/// # use plotter_motion::plant::{BeltDrive, BeltDriveState};
/// let belt = TransmissionConfig { stiffness_n_per_mm: 50.0, carriage_kg: 1.0, ..TransmissionConfig::default() };
/// let drive = BeltDrive::new(&AxisConfig { transmission: belt, ..AxisConfig::default() }, 0.01);
/// // stretched by 1 mm and let go, with the motor held: a kilogram on 50 N/mm swings with 223.6 rad/s
/// let state = drive.step_held(BeltDriveState { carriage_mm: 1.0, ..BeltDriveState::default() }, 0.0);
/// assert!((state.carriage_mm - libm::cos(2.236)).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeltDrive {
    /// Next state from the present one and the inputs, while the belt pulls, while it does not, and with the
    /// motor held.
    pulling: Step,
    free: Step,
    held: Step,
    motor: MotorConfig,
    coulomb_n_m: f64,
    static_n_m: f64,
    rail_n: f64,
    mm_per_rad: f64,
    stiffness: f64,
    damping: f64,
    half_play_mm: f64,
}

/// Columns: current, speed, angle, carriage's speed and place; voltage, friction of the motor and of the
/// rail, end of the play.
const SIZE: usize = 9;
type Step = [[f64; SIZE]; 5];

/// What friction does to a body in a step.
#[derive(Clone, Copy)]
enum Friction {
    /// Holds it where it is.
    Holds(f64),
    /// Slows it down.
    Slows(f64),
}

impl Friction {
    fn of(speed: f64, pull: f64, sliding: f64, at_rest: f64) -> Self {
        if speed == 0.0 && pull.abs() <= at_rest && at_rest > 0.0 {
            return Self::Holds(pull);
        }
        let sense = if speed == 0.0 { pull } else { speed };
        Self::Slows(if sense == 0.0 { 0.0 } else { libm::copysign(sliding, sense) })
    }

    const fn force(self) -> f64 {
        match self {
            Self::Holds(force) | Self::Slows(force) => force,
        }
    }
}

impl BeltDrive {
    /// The drive of an axis of a checked [`Machine`](crate::Machine) whose `carriage_kg` is more than 0, over
    /// steps of `dt_s`.
    #[must_use]
    pub fn new(axis: &AxisConfig, dt_s: f64) -> Self {
        let AxisConfig { motor, load, transmission, .. } = axis;
        let mm_per_rad = axis.mm_per_rad();
        let (stiffness, damping) = (transmission.stiffness_n_per_mm, transmission.damping_n_s_per_mm);
        let step = |pulls: f64, turns: f64| -> Step {
            let (k, c) = (pulls * stiffness, pulls * damping);
            let (l, j) = (motor.inductance_h, motor.inertia_kg_m2 + load.inertia_kg_m2);
            // newtons at the belt to rad/s^2 of the motor and to mm/s^2 of the carriage
            let (at_motor, at_carriage) = (turns * mm_per_rad / 1e3 / j, 1e3 / transmission.carriage_kg);
            // the belt's force by (speed, angle, carriage's speed, its place, end of the play)
            let force = [c * mm_per_rad, k * mm_per_rad, -c, -k, -k];
            let [f_speed, f_angle, f_v, f_place, f_end] = force;
            let mut a: Matrix<SIZE> = [[0.0; SIZE]; SIZE];
            a[0] =
                [-motor.resistance_ohm / l, -motor.back_emf_v_s / l, 0.0, 0.0, 0.0, 1.0 / l, 0.0, 0.0, 0.0];
            a[1] = [
                turns * motor.torque_n_m_per_a / j,
                -turns * load.viscous_n_m_s / j - at_motor * f_speed,
                -at_motor * f_angle,
                -at_motor * f_v,
                -at_motor * f_place,
                0.0,
                -turns / j,
                0.0,
                -at_motor * f_end,
            ];
            a[2][1] = turns;
            a[3] = [
                0.0,
                at_carriage * f_speed,
                at_carriage * f_angle,
                at_carriage * f_v,
                at_carriage * f_place,
                0.0,
                0.0,
                -at_carriage,
                at_carriage * f_end,
            ];
            a[4][3] = 1.0;
            let [current, speed, angle, v, place, ..] = exponential(&a.map(|row| row.map(|v| v * dt_s)));
            [current, speed, angle, v, place]
        };
        Self {
            pulling: step(1.0, 1.0),
            free: step(0.0, 1.0),
            held: step(1.0, 0.0),
            motor: *motor,
            coulomb_n_m: load.coulomb_n_m,
            static_n_m: load.static_n_m,
            rail_n: transmission.rail_friction_n,
            mm_per_rad,
            stiffness,
            damping,
            half_play_mm: 0.5 * transmission.backlash_mm,
        }
    }

    /// How far the belt is stretched, the play included, mm.
    fn stretch_mm(&self, state: &BeltDriveState) -> f64 {
        self.mm_per_rad * state.motor.angle_rad - state.carriage_mm
    }

    /// Force of the belt on the carriage, forwards, N.
    #[must_use]
    pub fn force_n(&self, state: &BeltDriveState) -> f64 {
        let stretch_mm = self.stretch_mm(state);
        if stretch_mm.abs() < self.half_play_mm {
            return 0.0;
        }
        let rate = self.mm_per_rad * state.motor.speed_rad_s - state.carriage_mm_s;
        self.stiffness * (stretch_mm - libm::copysign(self.half_play_mm, stretch_mm)) + self.damping * rate
    }

    /// The state one step later under `voltage_v`, held over the step.
    #[must_use]
    pub fn step(&self, state: BeltDriveState, voltage_v: f64) -> BeltDriveState {
        let pull = self.motor.torque_n_m_per_a * state.motor.current_a
            - self.force_n(&state) * self.mm_per_rad / 1e3;
        let speed = state.motor.speed_rad_s;
        let friction = Friction::of(speed, pull, self.coulomb_n_m, self.static_n_m);
        let mut next = self.moved(state, voltage_v, friction.force(), false);
        match friction {
            Friction::Holds(_) => {
                (next.motor.speed_rad_s, next.motor.angle_rad) = (0.0, state.motor.angle_rad);
            }
            // friction stops a shaft, it never turns it round
            Friction::Slows(_) if speed * next.motor.speed_rad_s < 0.0 && self.coulomb_n_m > 0.0 => {
                next.motor.speed_rad_s = 0.0;
            }
            Friction::Slows(_) => {}
        }
        next
    }

    /// The state one step later with the motor's shaft held fast; the carriage swings on.
    #[must_use]
    pub fn step_held(&self, state: BeltDriveState, voltage_v: f64) -> BeltDriveState {
        let stopped = DcMotorState { speed_rad_s: 0.0, ..state.motor };
        self.moved(BeltDriveState { motor: stopped, ..state }, voltage_v, 0.0, true)
    }

    fn moved(&self, state: BeltDriveState, voltage_v: f64, friction_n_m: f64, held: bool) -> BeltDriveState {
        let stretch_mm = self.stretch_mm(&state);
        let pulls = stretch_mm.abs() >= self.half_play_mm;
        let rail = Friction::of(state.carriage_mm_s, self.force_n(&state), self.rail_n, self.rail_n);
        let end_mm = libm::copysign(self.half_play_mm, stretch_mm);
        let DcMotorState { current_a, speed_rad_s, angle_rad } = state.motor;
        let input = [
            current_a,
            speed_rad_s,
            angle_rad,
            state.carriage_mm_s,
            state.carriage_mm,
            voltage_v,
            friction_n_m,
            rail.force(),
            end_mm,
        ];
        let step = match (held, pulls) {
            (true, true) => &self.held,
            (false, true) => &self.pulling,
            (_, false) => &self.free,
        };
        let row = |row: &[f64; SIZE]| row.iter().zip(&input).map(|(a, b)| a * b).sum::<f64>();
        let [current, speed, angle, v, place] = step;
        let mut next = BeltDriveState {
            motor: DcMotorState { current_a: row(current), speed_rad_s: row(speed), angle_rad: row(angle) },
            carriage_mm_s: row(v),
            carriage_mm: row(place),
        };
        if held {
            (next.motor.speed_rad_s, next.motor.angle_rad) = (0.0, angle_rad);
        }
        match rail {
            Friction::Holds(_) => (next.carriage_mm_s, next.carriage_mm) = (0.0, state.carriage_mm),
            Friction::Slows(_) if state.carriage_mm_s * next.carriage_mm_s < 0.0 && self.rail_n > 0.0 => {
                next.carriage_mm_s = 0.0;
            }
            Friction::Slows(_) => {}
        }
        next
    }
}
