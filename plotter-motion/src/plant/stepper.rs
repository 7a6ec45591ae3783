//! A simulated stepper motor that loses steps where a real one does.
//!
//! The driver's pulses turn a magnetic field; the rotor is drawn after it as by a spring that slips:
//!
//! ```text
//!   J dw/dt = -T(f) sin(p (angle - field)) - d (w - field's) - b w - friction        dangle/dt = w
//!
//!   torque ▲                          T(f), f pulses a second:
//!   T ─────┼────────╮                 flat to the corner rate, then straight down
//!          │         ╲                to nothing at the greatest rate
//!          └──────────┴──▶ f
//! ```
//!
//! with p pole pairs (a full step is a quarter of the spring's period, so 50 for 200 full steps a turn). A
//! rotor that falls more than two full steps behind is drawn to the next place of rest, four full steps away:
//! those are lost. So nothing here says *lose steps above this rate*; it follows from torque, inertia and
//! friction, whether the field starts too suddenly (pull-in), turns too fast (pull-out) or changes its speed
//! too quickly.
//!
//! Source: P. P. Acarnley, "Stepping Motors: A Guide to Theory and Practice" (4th edition, 2002), chapters 3
//! to 5 (static torque, single-step response, pull-out torque over the stepping rate).

use crate::{Axis, Direction};
use core::f64::consts::TAU;
use core::time::Duration;

/// A stepper motor, its driver and what it moves.
///
/// The default is an axis of the documented stepper plotter: a 42BYG motor of 1.8 degrees on an A4988 in
/// sixteenths of a step, and a belt that makes 87.58 of these to the millimetre. Documented there are the
/// rates: 2000 pulses/s may start at once, up to 8000 were reached by acceleration, and 10,000 at once lose
/// steps. Torque, mass and friction are not; they are those of common motors and rails, chosen so that the
/// documented rates come out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct StepperSettings {
    /// Full steps in a turn of the shaft: 200 for 1.8 degrees.
    pub full_steps_per_turn: u32,
    /// Pulses to a full step.
    pub microsteps: u32,
    /// Holding torque at the driver's current, N m.
    pub holding_n_m: f64,
    /// Rate up to which the torque is the holding torque, pulses/s.
    pub corner_rate_hz: f64,
    /// Rate at which there is none left, pulses/s; more than `corner_rate_hz`.
    pub max_rate_hz: f64,
    /// Moment of inertia of the rotor and of all it moves, kg m^2; more than 0.
    pub inertia_kg_m2: f64,
    /// Dry friction, N m.
    pub coulomb_n_m: f64,
    /// Viscous friction, N m s (per radian).
    pub viscous_n_m_s: f64,
    /// Damping of the rotor's swing about its field, N m s (per radian): what the currents that the swing
    /// induces take from it. Nothing by default, the worst that a motor can do.
    pub damping_n_m_s: f64,
}

impl Default for StepperSettings {
    fn default() -> Self {
        Self {
            full_steps_per_turn: 200,
            microsteps: 16,
            holding_n_m: 0.28, // 0.4 N m at 1.7 A; an A4988 without fan gives about 1.2 A
            corner_rate_hz: 8_000.0,
            max_rate_hz: 40_000.0,
            // rotor 5.4e-6; 1.3 kg on a pulley of 3200 / 87.58 = 36.54 mm a turn, radius 5.815 mm: 4.4e-5
            inertia_kg_m2: 4.94e-5,
            coulomb_n_m: 0.04, // 7 N at the belt
            viscous_n_m_s: 1.0e-3,
            damping_n_m_s: 0.0,
        }
    }
}

/// Longest time over which the rotor's equation is taken as one step, s.
const LONGEST_STEP_S: f64 = 20e-6;
/// The same as a share of the rotor's own time constant: within it the rotor turns a tenth of a radian of its
/// swing.
const SHARE_OF_SWING: f64 = 0.1;
/// Most steps over one pause. At 20 us they are 20 s: a rotor has come to rest long before.
const MOST_STEPS_A_PAUSE: f64 = 1.0e6;

/// One axis driven by a stepper motor: pulses in, true position out.
///
/// The rotor's equation is taken in steps of at most 20 us from pulse to pulse, so the same pulses give the
/// same bits; an axis takes about a second of computing for eight minutes of motion on a desktop (3.6 million
/// pulses a second at 8000 pulses/s).
///
/// Times are those of the caller's clock and never go back; one that does counts as the last one.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_motion::{Direction, plant::{StepperAxis, StepperSettings}};
/// let run = |pulses_per_s: u32| {
///     let mut axis = StepperAxis::new(StepperSettings::default());
///     for i in 1..=2_000 {
///         axis.pulse(Duration::from_secs(1) * i / pulses_per_s, Direction::Plus);
///     }
///     axis.settle();
///     axis.lost_steps()
/// };
/// assert_eq!(run(2_000), 0); // the source's base speed: may start at once
/// assert!(run(10_000) > 1_500); // at once, the rotor trembles and stays behind
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepperAxis {
    settings: StepperSettings,
    /// Radians of the shaft to a pulse.
    rad_per_pulse: f64,
    /// p, pole pairs.
    pole_pairs: f64,
    step_s: f64,
    now: Duration,
    /// The last pulse, and how long before it the one before came.
    last_pulse: Option<Duration>,
    interval_s: f64,
    /// Where the field points, pulses.
    field: i64,
    /// The rotor, radians ahead of where the field began.
    angle_rad: f64,
    speed_rad_s: f64,
}

impl StepperAxis {
    /// An axis at rest. The settings must be as their documentation says: positive, and finite.
    #[must_use]
    pub fn new(settings: StepperSettings) -> Self {
        let full_steps = f64::from(settings.full_steps_per_turn.max(1));
        let pole_pairs = full_steps / 4.0;
        let swing_rad_s = libm::sqrt(pole_pairs * settings.holding_n_m / settings.inertia_kg_m2);
        Self {
            settings,
            rad_per_pulse: TAU / (full_steps * f64::from(settings.microsteps.max(1))),
            pole_pairs,
            step_s: (SHARE_OF_SWING / swing_rad_s).min(LONGEST_STEP_S),
            now: Duration::ZERO,
            last_pulse: None,
            interval_s: f64::INFINITY,
            field: 0,
            angle_rad: 0.0,
            speed_rad_s: 0.0,
        }
    }

    /// A pulse at the time `at`: the field goes on by one microstep.
    pub fn pulse(&mut self, at: Duration, direction: Direction) {
        self.run_to(at);
        if let Some(last) = self.last_pulse {
            self.interval_s = self.now.saturating_sub(last).as_secs_f64();
        }
        self.last_pulse = Some(self.now);
        self.field = self.field.saturating_add(i64::from(direction.sign()));
        // What damps the rotor against a standing field takes it along with one that turns: for each step by
        // the same, however fast the step is.
        let StepperSettings { inertia_kg_m2, damping_n_m_s, .. } = self.settings;
        self.speed_rad_s += damping_n_m_s * f64::from(direction.sign()) * self.rad_per_pulse / inertia_kg_m2;
    }

    /// Lets time pass until `now`. Pauses beyond some 20 s count as 20 s.
    pub fn run_to(&mut self, now: Duration) {
        let pause_s = now.saturating_sub(self.now).as_secs_f64();
        let since_s =
            self.last_pulse.map_or(f64::INFINITY, |last| self.now.saturating_sub(last).as_secs_f64());
        self.now = self.now.max(now);
        let steps = libm::ceil(pause_s / self.step_s).min(MOST_STEPS_A_PAUSE);
        let dt_s = (pause_s / steps).min(LONGEST_STEP_S);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped; a NaN gives 0")]
        let steps = steps as u32;
        for step in 0..steps {
            // A field that stands longer than between its last pulses has slowed down.
            let interval_s = self.interval_s.max(since_s + f64::from(step) * dt_s);
            if !self.turn(self.torque_n_m(1.0 / interval_s), dt_s) {
                break;
            }
        }
    }

    /// Lets the rotor come to rest, after the last pulse: half a second.
    pub fn settle(&mut self) {
        self.run_to(self.now.saturating_add(Duration::from_millis(500)));
    }

    /// Where the driver believes the axis to be: pulses forwards less pulses back.
    #[must_use]
    pub const fn commanded_steps(&self) -> i64 {
        self.field
    }

    /// Where the axis truly is, in steps (pulses) from its start.
    #[must_use]
    pub fn position_steps(&self) -> f64 {
        self.angle_rad / self.rad_per_pulse
    }

    /// How many steps (pulses) the rotor is behind for good, with sign: a multiple of four full steps. While
    /// it moves, it may be up to two full steps behind without having lost any.
    #[must_use]
    pub fn lost_steps(&self) -> i64 {
        let period = 4 * i64::from(self.settings.microsteps.max(1));
        #[expect(clippy::cast_precision_loss, reason = "pulses stay far below 2^53")]
        let periods = (self.field as f64 - self.position_steps()) / period as f64;
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let periods = libm::round(periods) as i64;
        periods.saturating_mul(period)
    }

    /// Greatest torque of the field at a steady rate, N m: the pull-out curve, before friction.
    ///
    /// ```
    /// # use plotter_motion::plant::{StepperAxis, StepperSettings};
    /// let axis = StepperAxis::new(StepperSettings::default());
    /// assert_eq!(axis.torque_n_m(2_000.0), 0.28);
    /// assert!((axis.torque_n_m(24_000.0) - 0.14).abs() < 1e-12); // half way from 8000 to 40,000
    /// assert_eq!(axis.torque_n_m(50_000.0), 0.0);
    /// ```
    #[must_use]
    pub fn torque_n_m(&self, rate_hz: f64) -> f64 {
        let StepperSettings { holding_n_m, corner_rate_hz, max_rate_hz, .. } = self.settings;
        if rate_hz <= corner_rate_hz {
            holding_n_m
        } else {
            holding_n_m * ((max_rate_hz - rate_hz) / (max_rate_hz - corner_rate_hz)).max(0.0)
        }
    }

    /// Goes on by `dt_s`; says whether anything moves. First the speed, then the angle with it (the
    /// symplectic Euler method, which neither feeds the swing of a spring nor damps it).
    fn turn(&mut self, most_n_m: f64, dt_s: f64) -> bool {
        let StepperSettings { inertia_kg_m2, coulomb_n_m, viscous_n_m_s, damping_n_m_s, .. } = self.settings;
        #[expect(clippy::cast_precision_loss, reason = "pulses stay far below 2^53")]
        let behind_rad = self.field as f64 * self.rad_per_pulse - self.angle_rad;
        let pull = most_n_m * libm::sin(self.pole_pairs * behind_rad);
        if self.speed_rad_s == 0.0 && libm::fabs(pull) <= coulomb_n_m {
            return false;
        }
        let sense = if self.speed_rad_s == 0.0 { pull } else { self.speed_rad_s };
        let friction =
            libm::copysign(coulomb_n_m, sense) + (viscous_n_m_s + damping_n_m_s) * self.speed_rad_s;
        let speed_rad_s = self.speed_rad_s + dt_s * (pull - friction) / inertia_kg_m2;
        // Friction stops a rotor, it never turns it round; whether it goes on is settled in the next step.
        let turned_round = speed_rad_s * self.speed_rad_s < 0.0 && coulomb_n_m > 0.0;
        self.speed_rad_s = if turned_round { 0.0 } else { speed_rad_s };
        self.angle_rad += dt_s * self.speed_rad_s;
        true
    }
}

/// Both axes of a plotter driven by stepper motors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepperPlant {
    /// First motor.
    pub x: StepperAxis,
    /// Second motor.
    pub y: StepperAxis,
}

impl StepperPlant {
    /// Both at rest.
    #[must_use]
    pub fn new(x: StepperSettings, y: StepperSettings) -> Self {
        Self { x: StepperAxis::new(x), y: StepperAxis::new(y) }
    }

    /// A pulse of one motor at the time `at`; the other goes on to its own next pulse then.
    pub fn pulse(&mut self, at: Duration, axis: Axis, direction: Direction) {
        match axis {
            Axis::X => self.x.pulse(at, direction),
            Axis::Y => self.y.pulse(at, direction),
        }
    }

    /// Lets time pass for both until `now`.
    pub fn run_to(&mut self, now: Duration) {
        self.x.run_to(now);
        self.y.run_to(now);
    }
}
