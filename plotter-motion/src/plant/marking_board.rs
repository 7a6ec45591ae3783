//! A simulated marking board: two unequal motors on one belt, and rails that do not slide alike.

use super::dc_motor::{DcMotor, DcMotorState};
use crate::config::{DcConfig, OneBeltConfig};
use crate::kinematics::{CoreXy, Kinematics, MotorPoint};
use crate::{
    Axis, Duty, LimitSwitches, Machine, Point,
    config::{LoadConfig, MotorConfig},
};
use core::f64::consts::TAU;

/// Settings of a simulated board.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MarkingBoardPlantSettings {
    /// Directions and encoder pulses to the millimetre.
    pub belt: CoreXy,
    /// Both motors, with what turns with them: gear, pulley, their share of the carriage.
    pub motors: [(MotorConfig, LoadConfig); 2],
    /// Pulses in a turn of a motor's shaft.
    pub pulses_per_turn: f64,
    /// How far beyond a mark of its encoder each motor stands at first, pulses, 0 to 1: nobody knows it on a
    /// real board.
    pub phases: [f64; 2],
    /// Friction of the rail along x, N: sliding, and at rest.
    pub x_rail_n: [f64; 2],
    /// Friction of the rail along y, N: sliding, and at rest.
    pub y_rail_n: [f64; 2],
    /// Where the pen is at first, mm.
    pub start: Point,
    /// Where the switches at the upper and right end are pressed, mm; those at the left and lower end are
    /// at 0.
    pub most: Point,
}

impl MarkingBoardPlantSettings {
    /// The motors, rails and places of a machine with a belt, each encoder in the middle between two marks.
    ///
    /// The mass on the rails is left out: a kilogram moved by 0.52 mm a turn is 1.7e-9 kg m² at either motor,
    /// less than a thousandth of the documented board's gear.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let OneBeltConfig { dc: DcConfig { x, y, .. }, belt, .. } = OneBeltConfig::of(machine);
        let area = machine.config().area;
        Self {
            belt: CoreXy::of(machine),
            motors: [(x.motor, x.load), (y.motor, y.load)],
            pulses_per_turn: x.counts_per_turn(),
            phases: [0.5, 0.5],
            x_rail_n: [belt.x_rail_coulomb_n, belt.x_rail_static_n],
            y_rail_n: [belt.y_rail_coulomb_n, belt.y_rail_static_n],
            start: Point::new(belt.start_x_mm, belt.start_y_mm),
            most: Point::new(area.width_mm, area.height_mm),
        }
    }
}

/// A board moved on in fixed time steps.
///
/// Its encoders only count up: a pulse comes whenever a mark passes, whichever way
/// ([`PulseCounter`](crate::encoder::PulseCounter)), by a hundredth of a pulse: no comparator switches at
/// every tremble. Without drive the motors run down, short-circuited, against the friction of their gears and
/// of the rails; the rails pull at both motors, so one that runs can drag the other.
///
/// Friction is Coulomb's, at four places: both gears and both rails. In each time step the friction forces
/// are those, within their limits, that bring each place to rest or slow it down; found by going round the
/// four places until none changes (projected Gauss-Seidel). Source of the method: J. J. Moreau, "Unilateral
/// contact and dry friction in finite freedom dynamics" (1988).
///
/// ```
/// # use plotter_motion::plant::{MarkingBoardPlant, MarkingBoardPlantSettings};
/// # use plotter_motion::{Demand, Duty, LimitSwitches, Machine, MachineConfig, SafetyGate};
/// let settings = MarkingBoardPlantSettings::of(&Machine::new(MachineConfig::marking_board())?);
/// let mut board = MarkingBoardPlant::new(&settings, 1e-4);
/// let start = board.position_mm();
/// let demand = Demand { x: Duty::saturating(0.4), y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let right = gate.pass_belt(demand, settings.belt.signs(), 0.0);
/// for _ in 0..10_000 {
///     board.step(right.duties(), |_| ());
/// }
/// let moved = board.position_mm() - start;
/// assert!(moved.x > 20.0 && moved.y.abs() > 0.5); // a second: to the right, and not straight
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkingBoardPlant {
    settings: MarkingBoardPlantSettings,
    motors: [BoardMotor; 2],
    contacts: [Contact; 4],
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct BoardMotor {
    motor: DcMotor,
    state: DcMotorState,
    config: MotorConfig,
    /// Speed lost in a step by a torque, rad/s per N m.
    loss: f64,
    /// The mark that the encoder saw last on the way up: the shaft is between it and the next one.
    mark: f64,
}

/// A place that rubs: what each motor's speed makes of its speed, and the friction sliding and at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Contact {
    row: [f64; 2],
    sliding: f64,
    at_rest: f64,
}

impl Contact {
    fn speed(&self, speeds: [f64; 2]) -> f64 {
        let ([a, b], [first, second]) = (self.row, speeds);
        a * first + b * second
    }
}

/// So far beyond a mark the encoder's comparator switches, pulses: a shaft that stands at a mark and trembles
/// there by less makes no pulses. Comparators for such sensors have some hundredths of a period; this is at
/// the small end.
const HYSTERESIS_PULSES: f64 = 0.01;

/// Below this a shaft stands, rad/s: what the rounding of a friction that stops it leaves over.
const AT_REST_RAD_S: f64 = 1e-9;

impl MarkingBoardPlant {
    /// A board at rest, over steps of `dt_s`: 10 us to 1 ms suit. The motors' constants must be positive.
    #[must_use]
    pub fn new(settings: &MarkingBoardPlantSettings, dt_s: f64) -> Self {
        let [(config_1, load_1), (config_2, load_2)] = settings.motors;
        let [phase_1, phase_2] = settings.phases;
        let board_motor = |config: MotorConfig, load: LoadConfig, phase: f64| {
            let motor = DcMotor::new(&config, &load, dt_s);
            let loss = -motor.step(DcMotorState::default(), 0.0, 1.0).speed_rad_s;
            let angle_rad = phase / settings.pulses_per_turn * TAU;
            let state = DcMotorState { angle_rad, ..DcMotorState::default() };
            BoardMotor { motor, state, config, loss, mark: libm::floor(phase) }
        };
        let motors = [board_motor(config_1, load_1, phase_1), board_motor(config_2, load_2, phase_2)];
        let m_per_rad = settings.pulses_per_turn / TAU / settings.belt.steps_per_mm() / 1000.0;
        let signs = settings.belt.signs();
        let half = m_per_rad / 2.0;
        let (first, second) = (signs.twice_axes(half, 0.0), signs.twice_axes(0.0, half));
        let rail = |row, [sliding, at_rest]: [f64; 2]| Contact { row, sliding, at_rest };
        let contacts = [
            rail([1.0, 0.0], [load_1.coulomb_n_m, load_1.static_n_m]),
            rail([0.0, 1.0], [load_2.coulomb_n_m, load_2.static_n_m]),
            rail([first.0, second.0], settings.x_rail_n),
            rail([first.1, second.1], settings.y_rail_n),
        ];
        Self { settings: *settings, motors, contacts }
    }

    /// Goes on by one time step with these duties of both motors; `pulse` is told of every mark that passes
    /// an encoder: of the first motor (`X`) or the second (`Y`).
    pub fn step(&mut self, duties: [Duty; 2], mut pulse: impl FnMut(Axis)) {
        let [first, second] = &mut self.motors;
        let volts = [first.voltage_v(duties[0]), second.voltage_v(duties[1])];
        let now = [first.state.speed_rad_s, second.state.speed_rad_s];
        let free = [
            first.motor.step(first.state, volts[0], 0.0).speed_rad_s,
            second.motor.step(second.state, volts[1], 0.0).speed_rad_s,
        ];
        let torques = friction(&self.contacts, [first.loss, second.loss], now, free);
        for (axis, (motor, (volts, torque))) in
            Axis::BOTH.into_iter().zip([first, second].into_iter().zip(volts.into_iter().zip(torques)))
        {
            motor.state = motor.motor.step(motor.state, volts, torque);
            if motor.state.speed_rad_s.abs() < AT_REST_RAD_S {
                motor.state.speed_rad_s = 0.0;
            }
            let pulses = motor.state.angle_rad / TAU * self.settings.pulses_per_turn;
            let passed = motor.passes(pulses);
            for _ in 0..passed {
                pulse(axis);
            }
        }
    }

    /// Where both motors stand, pulses with fraction from the start.
    #[must_use]
    pub fn motors_counts(&self) -> MotorPoint {
        let [first, second] = &self.motors;
        let [phase_1, phase_2] = self.settings.phases;
        let turned = |motor: &BoardMotor| motor.state.angle_rad / TAU * self.settings.pulses_per_turn;
        MotorPoint { x: turned(first) - phase_1, y: turned(second) - phase_2 }
    }

    /// Where the pen truly is, mm.
    #[must_use]
    pub fn position_mm(&self) -> Point {
        self.settings.start + (self.settings.belt.point_at(self.motors_counts()) - Point::ORIGIN)
    }

    /// Current, speed and angle of both motors.
    #[must_use]
    pub fn states(&self) -> [DcMotorState; 2] {
        self.motors.map(|motor| motor.state)
    }

    /// Limit switches that the carriage presses.
    #[must_use]
    pub fn limit_switches(&self) -> LimitSwitches {
        let (at, most) = (self.position_mm(), self.settings.most);
        LimitSwitches { x_min: at.x <= 0.0, x_max: at.x >= most.x, y_min: at.y <= 0.0, y_max: at.y >= most.y }
    }
}

impl BoardMotor {
    /// How many marks pass its encoder when it turns to a place, in pulses.
    fn passes(&mut self, pulses: f64) -> u16 {
        let before = self.mark;
        self.mark =
            before.max(libm::floor(pulses - HYSTERESIS_PULSES)).min(libm::floor(pulses + HYSTERESIS_PULSES));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a few marks in a step; saturates"
        )]
        let passed = (self.mark - before).abs() as u16;
        passed
    }

    fn voltage_v(&self, duty: Duty) -> f64 {
        let steps = u16::try_from(self.config.pwm_steps).unwrap_or(u16::MAX);
        f64::from(duty.steps(steps)) / f64::from(steps) * self.config.supply_v
    }
}

/// The torque of all friction on both motors over a step, N m, from their speeds `now` and those that they
/// would have at its end without it.
fn friction(contacts: &[Contact; 4], loss: [f64; 2], now: [f64; 2], free: [f64; 2]) -> [f64; 2] {
    // Two motors and four places: what is left after so many rounds is far below a thousandth of the
    // friction.
    const ROUNDS: usize = 20;
    let mut speeds = free;
    let mut forces = [0.0; 4];
    let [loss_1, loss_2] = loss;
    for _ in 0..ROUNDS {
        for (contact, force) in contacts.iter().zip(&mut forces) {
            let [a, b] = contact.row;
            let slides = contact.speed(now).abs() > AT_REST_RAD_S * (a.abs() + b.abs());
            let most = if slides { contact.sliding } else { contact.at_rest };
            let give = a * a * loss_1 + b * b * loss_2;
            let next: f64 = (*force + contact.speed(speeds) / give).clamp(-most, most);
            let change = next - *force;
            *force = next;
            let [first, second] = &mut speeds;
            *first -= a * loss_1 * change;
            *second -= b * loss_2 * change;
        }
    }
    let torque = |of: fn(&Contact) -> f64| contacts.iter().zip(&forces).map(|(c, force)| of(c) * force).sum();
    [torque(|c| c.row[0]), torque(|c| c.row[1])]
}
