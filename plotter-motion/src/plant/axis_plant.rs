//! One simulated axis: motor, friction, encoder, and a hand that can hold the shaft.

use super::belt_drive::{BeltDrive, BeltDriveState};
use super::dc_motor::{DcMotor, DcMotorState};
use super::enable_pwm::EnablePwm;
use crate::{
    Direction, Duty,
    config::{AxisConfig, Decoding, LoadConfig},
    encoder::{Phases, QuadratureX1, QuadratureX2, QuadratureX4},
};
use core::f64::consts::TAU;

/// A motor with its load and its encoder, moved on in fixed time steps.
///
/// Friction is Coulomb's: constant against the motion, and at rest as much as is needed up to the static
/// friction. The voltage is the mean of the pulse width modulation, `duty * supply` in whole steps of the
/// timer, as in the transfer function of Öcal's thesis (section 4.6.1); or pulse by pulse, where they are on
/// the bridge's enable pin ([`MotorConfig::enable_pwm_hz`](crate::config::MotorConfig::enable_pwm_hz)) and
/// the motor coasts in between.
///
/// Positions are counted as the encoder counts them, with the shaft in the middle of the interval that
/// belongs to count 0 at the start (see [`Decoding::rest_offset_counts`]).
///
/// ```
/// # use plotter_motion::{Duty, config::AxisConfig, plant::AxisPlant};
/// let mut axis = AxisPlant::new(&AxisConfig::default(), 1e-5);
/// let mut count = 0;
/// for _ in 0..20_000 {
///     axis.step(Duty::saturating(0.2), |edge| count += edge.direction.sign());
/// }
/// let ahead = axis.position_counts() - f64::from(count);
/// assert!(count > 1_000 && (-0.25..0.75).contains(&ahead)); // between two edges, from the middle of A's high half
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisPlant {
    motor: DcMotor,
    state: DcMotorState,
    pulses: Option<EnablePwm>,
    /// Into how many steps of its own a step is cut.
    cuts: u32,
    config: AxisConfig,
    quarters_per_rad: f64,
    decoder: Decoder,
    stalled: bool,
    /// What the shaft moves, with a carriage that it is rigidly coupled to.
    load: LoadConfig,
    train: Train,
}

/// What lies between the shaft and the pen.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a machine has two axes, and no heap to put it on")]
enum Train {
    /// Nothing: the pen is where the shaft is.
    Rigid,
    /// Play: the pen is pushed by either end of it. (Its friction keeps it where it is in between.)
    Play { half_mm: f64, pen_mm: f64 },
    /// A belt that stretches: the carriage has a speed of its own.
    Belt { drive: BeltDrive, start_mm: f64, carriage_mm: f64, carriage_mm_s: f64 },
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Decoder {
    X1(QuadratureX1),
    X2(QuadratureX2),
    X4(QuadratureX4),
}

/// An edge that the encoder's decoder counted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CountedEdge {
    /// When, as a share of the step, 0 to 1.
    pub share_of_step: f64,
    /// Direction.
    pub direction: Direction,
}

/// A change of the levels on an encoder's pins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseChange {
    /// When, as a share of the step, 0 to 1.
    pub share_of_step: f64,
    /// The levels from then on.
    pub phases: Phases,
}

impl AxisPlant {
    /// An axis at rest, over steps of `dt_s`: 1 us to 1 ms suit small motors. The axis must be one of a
    /// checked [`Machine`](crate::Machine). In a step in which its shaft would turn by more than 10,000
    /// quarters of a period it stands still.
    #[must_use]
    pub fn new(config: &AxisConfig, dt_s: f64) -> Self {
        let quarters_per_rad = f64::from(config.encoder.lines_per_turn) * 4.0 / TAU;
        let decoding = config.encoder.decoding;
        let start_quarters = f64::from(decoding.rest_offset_counts()) * quarters_per_count(decoding);
        let phases = Phases::of_quarter(floor(start_quarters));
        let load = rigid_load(config);
        let cuts = EnablePwm::steps_in(&config.motor, dt_s);
        let dt_s = dt_s / f64::from(cuts);
        let transmission = &config.transmission;
        let train = if transmission.stiffness_n_per_mm > 0.0 {
            let start_mm = start_quarters / quarters_per_rad * config.mm_per_rad();
            let drive = BeltDrive::new(config, dt_s);
            Train::Belt { drive, start_mm, carriage_mm: start_mm, carriage_mm_s: 0.0 }
        } else if transmission.backlash_mm > 0.0 {
            Train::Play { half_mm: 0.5 * transmission.backlash_mm, pen_mm: 0.0 }
        } else {
            Train::Rigid
        };
        Self {
            motor: DcMotor::new(&config.motor, &load, dt_s),
            pulses: EnablePwm::of(&config.motor, dt_s),
            cuts,
            state: DcMotorState { angle_rad: start_quarters / quarters_per_rad, ..DcMotorState::default() },
            config: *config,
            quarters_per_rad,
            decoder: match decoding {
                Decoding::X1 => Decoder::X1(QuadratureX1::new(phases)),
                Decoding::X2 => Decoder::X2(QuadratureX2::new(phases)),
                Decoding::X4 => Decoder::X4(QuadratureX4::new(phases)),
            },
            stalled: false,
            load,
            train,
        }
    }

    /// Holds the shaft fast, or lets it go.
    pub const fn stall(&mut self, stalled: bool) {
        self.stalled = stalled;
    }

    /// Where the shaft truly stands, in encoder counts from its start.
    #[must_use]
    pub fn position_counts(&self) -> f64 {
        let decoding = self.config.encoder.decoding;
        self.state.angle_rad * self.quarters_per_rad / quarters_per_count(decoding)
            - f64::from(decoding.rest_offset_counts())
    }

    /// By how many whole counts `count` is wrong about where the shaft truly stands: 0 for one that a decoder
    /// may rightly have, which with x1 may be either of two, as the edge of a count backwards lies half a
    /// count beyond that forwards.
    ///
    /// ```
    /// # use plotter_motion::{config::AxisConfig, plant::AxisPlant};
    /// let axis = AxisPlant::new(&AxisConfig::default(), 1e-5);
    /// assert_eq!([-2, -1, 0, 1, 2].map(|count| axis.counts_from(count)), [2, 1, 0, 1, 2]);
    /// ```
    #[must_use]
    pub fn counts_from(&self, count: i32) -> u32 {
        let decoding = self.config.encoder.decoding;
        // The places of a count reach so far on both sides of where a shaft rests in it: x1 -0.5 to 1.0 about
        // 0.25, else 0 to 1 about 0.5.
        let reach = match decoding {
            Decoding::X1 => 0.75,
            Decoding::X2 | Decoding::X4 => 0.5,
        };
        let beyond = (self.position_counts() - f64::from(count)).abs() - reach;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let whole = libm::ceil(beyond).max(0.0) as u32;
        whole
    }

    /// Where the pen truly stands, mm from its start: where the shaft is, less what play and belt keep back.
    ///
    /// ```
    /// # use plotter_motion::{Duty, config::{AxisConfig, TransmissionConfig}, plant::AxisPlant};
    /// let worn = TransmissionConfig { backlash_mm: 0.4, ..TransmissionConfig::default() };
    /// let mut axis = AxisPlant::new(&AxisConfig { transmission: worn, ..AxisConfig::default() }, 1e-5);
    /// for _ in 0..20_000 {
    ///     axis.step(Duty::saturating(0.2), |_| ());
    /// }
    /// let behind_mm = axis.position_counts() / 40.0 - axis.position_mm();
    /// assert!((behind_mm - 0.2).abs() < 1e-9); // it began in the middle of its play
    /// ```
    #[must_use]
    pub fn position_mm(&self) -> f64 {
        match self.train {
            Train::Rigid => self.shaft_mm(),
            Train::Play { pen_mm, .. } => pen_mm,
            Train::Belt { start_mm, carriage_mm, .. } => carriage_mm - start_mm,
        }
    }

    fn shaft_mm(&self) -> f64 {
        self.position_counts() / self.config.counts_per_mm
    }

    /// Current, speed and angle.
    #[must_use]
    pub const fn state(&self) -> DcMotorState {
        self.state
    }

    /// Power that the motor takes from its supply under `duty` now, W; negative while it brakes and gives
    /// back.
    ///
    /// ```
    /// # use plotter_motion::{Duty, config::AxisConfig, plant::AxisPlant};
    /// let mut axis = AxisPlant::new(&AxisConfig::default(), 1e-3);
    /// axis.stall(true);
    /// axis.step(Duty::FULL, |_| ());
    /// assert!((axis.power_w(Duty::FULL) - 75.8).abs() < 0.1); // 12 V * 12 V / 1.9 ohm
    /// ```
    #[must_use]
    pub fn power_w(&self, duty: Duty) -> f64 {
        let (share, current_a) = (self.share(duty), self.state.current_a);
        match &self.pulses {
            Some(pulses) => pulses.power_w(share, current_a),
            None => share * self.config.motor.supply_v * current_a,
        }
    }

    /// The levels on the encoder's pins.
    #[must_use]
    pub fn phases(&self) -> Phases {
        Phases::of_quarter(floor(self.state.angle_rad * self.quarters_per_rad))
    }

    /// Goes on by one time step under `duty`; `edge` is told of every counted edge, in order.
    pub fn step(&mut self, duty: Duty, mut edge: impl FnMut(CountedEdge)) {
        let mut decoder = self.decoder;
        self.turn(duty, |PhaseChange { share_of_step, phases }| {
            let counted = match &mut decoder {
                Decoder::X1(decoder) => decoder.update(phases),
                Decoder::X2(decoder) => decoder.update(phases),
                Decoder::X4(decoder) => decoder.update(phases),
            };
            if let Some(direction) = counted {
                edge(CountedEdge { share_of_step, direction });
            }
        });
        self.decoder = decoder;
    }

    /// As [`step`](Self::step), for a decoder elsewhere: `change` is told of every change on the encoder's
    /// pins, in order, and nothing is counted here.
    pub fn turn(&mut self, duty: Duty, mut change: impl FnMut(PhaseChange)) {
        let cuts = self.cuts;
        for cut in 0..cuts {
            self.turn_once(duty, |PhaseChange { share_of_step, phases }| {
                let share_of_step = (f64::from(cut) + share_of_step) / f64::from(cuts);
                change(PhaseChange { share_of_step, phases });
            });
        }
    }

    fn turn_once(&mut self, duty: Duty, mut change: impl FnMut(PhaseChange)) {
        let before = self.state.angle_rad * self.quarters_per_rad;
        let voltage_v = self.voltage_v(duty);
        self.move_on(voltage_v);
        let after = self.state.angle_rad * self.quarters_per_rad;

        let (first, last) = (floor(before), floor(after));
        let forwards = last > first;
        let mut quarter = first;
        while quarter != last {
            // the border crossed lies above the quarter that is left, or below it
            let (border, next) = if forwards { (quarter + 1, quarter + 1) } else { (quarter, quarter - 1) };
            quarter = next;
            #[expect(clippy::cast_precision_loss, reason = "a shaft's quarters stay far below 2^53")]
            let share_of_step = ((border as f64 - before) / (after - before)).clamp(0.0, 1.0);
            change(PhaseChange { share_of_step, phases: Phases::of_quarter(quarter) });
        }
    }

    fn voltage_v(&mut self, duty: Duty) -> f64 {
        let share = self.share(duty);
        match &mut self.pulses {
            Some(pulses) => pulses.voltage_v(share, self.state),
            None => share * self.config.motor.supply_v,
        }
    }

    /// A duty as the timer makes it.
    fn share(&self, duty: Duty) -> f64 {
        let steps = u16::try_from(self.config.motor.pwm_steps).unwrap_or(u16::MAX);
        f64::from(duty.steps(steps)) / f64::from(steps)
    }

    /// Goes on by one step, with what lies between shaft and pen.
    fn move_on(&mut self, voltage_v: f64) {
        if let Train::Belt { drive, carriage_mm, carriage_mm_s, .. } = &mut self.train {
            let state = BeltDriveState {
                motor: self.state,
                carriage_mm: *carriage_mm,
                carriage_mm_s: *carriage_mm_s,
            };
            let mut next =
                if self.stalled { drive.step_held(state, voltage_v) } else { drive.step(state, voltage_v) };
            let turned = (next.motor.angle_rad - self.state.angle_rad) * self.quarters_per_rad;
            if turned.is_nan() || turned.abs() > MOST_QUARTERS_PER_STEP {
                next = BeltDriveState { motor: DcMotorState { speed_rad_s: 0.0, ..self.state }, ..state };
            }
            (*carriage_mm, *carriage_mm_s) = (next.carriage_mm, next.carriage_mm_s);
            self.state = next.motor;
            return;
        }
        self.state = self.moved(voltage_v);
        let shaft_mm = self.shaft_mm();
        if let Train::Play { half_mm, pen_mm } = &mut self.train {
            *pen_mm = pen_mm.clamp(shaft_mm - *half_mm, shaft_mm + *half_mm);
        }
    }

    /// The shaft's state one step later.
    fn moved(&self, voltage_v: f64) -> DcMotorState {
        let state = self.state;
        let load = &self.load;
        if self.stalled {
            return self.motor.step_held(state, voltage_v);
        }
        let pull = self.motor.armature_torque_n_m(state);
        let sense = if state.speed_rad_s != 0.0 {
            state.speed_rad_s
        } else if pull.abs() <= load.static_n_m && load.static_n_m > 0.0 {
            return self.motor.step_held(state, voltage_v);
        } else {
            pull
        };
        let friction = if sense == 0.0 { 0.0 } else { libm::copysign(load.coulomb_n_m, sense) };
        let mut next = self.motor.step(state, voltage_v, friction);
        if state.speed_rad_s * next.speed_rad_s < 0.0 && load.coulomb_n_m > 0.0 {
            // friction stops a shaft, it never turns it round; whether it goes on is settled in the next step
            next.speed_rad_s = 0.0;
        }
        let turned = (next.angle_rad - state.angle_rad) * self.quarters_per_rad;
        if turned.abs() <= MOST_QUARTERS_PER_STEP { next } else { self.motor.step_held(state, voltage_v) }
    }
}

/// A shaft cannot turn faster than this in one step; what is beyond it is not a motor any more.
const MOST_QUARTERS_PER_STEP: f64 = 10_000.0;

/// What the shaft of an axis without stretch moves: its own load, and the carriage on its rail.
fn rigid_load(config: &AxisConfig) -> LoadConfig {
    let (load, transmission) = (config.load, config.transmission);
    let m_per_rad = config.mm_per_rad() / 1e3;
    let rail_n_m = transmission.rail_friction_n * m_per_rad;
    LoadConfig {
        inertia_kg_m2: load.inertia_kg_m2 + transmission.carriage_kg * m_per_rad * m_per_rad,
        coulomb_n_m: load.coulomb_n_m + rail_n_m,
        static_n_m: load.static_n_m + rail_n_m,
        ..load
    }
}

fn quarters_per_count(decoding: Decoding) -> f64 {
    4.0 / f64::from(decoding.counts_per_line())
}

fn floor(value: f64) -> i64 {
    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    let whole = libm::floor(value) as i64;
    whole
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::LoadConfig;

    const DT_S: f64 = 1e-5;

    fn run(axis: &mut AxisPlant, duty: f32, steps: usize) -> i32 {
        let mut count = 0;
        for _ in 0..steps {
            axis.step(Duty::saturating(duty), |edge| count += edge.direction.sign());
        }
        count
    }

    #[test]
    fn the_encoder_counts_what_the_shaft_turned() {
        for decoding in [Decoding::X1, Decoding::X2, Decoding::X4] {
            let mut config = AxisConfig::default();
            config.encoder.decoding = decoding;
            let mut axis = AxisPlant::new(&config, DT_S);
            assert_eq!(axis.position_counts(), 0.0);
            let count = run(&mut axis, 0.2, 50_000);
            let difference =
                axis.position_counts() + f64::from(decoding.rest_offset_counts()) - f64::from(count);
            assert!((0.0..1.0).contains(&difference), "{decoding:?}: {count} {difference}");
        }
    }

    #[test]
    fn static_friction_holds_against_a_weak_drive() {
        // 1 step of 255: 12/255 V / 1.9 ohm * 13.4e-3 N m/A = 0.33e-3 N m
        let mut config = AxisConfig::default();
        config.load = LoadConfig { coulomb_n_m: 0.3e-3, static_n_m: 0.4e-3, ..config.load };
        let mut axis = AxisPlant::new(&config, DT_S);
        assert_eq!(run(&mut axis, 1.0 / 255.0, 10_000), 0);
        assert!(run(&mut axis, 2.0 / 255.0, 50_000) > 0);
    }

    #[test]
    fn a_stalled_axis_stands_and_goes_on_when_freed() {
        let mut axis = AxisPlant::new(&AxisConfig::default(), DT_S);
        run(&mut axis, 0.2, 10_000);
        axis.stall(true);
        let held = axis.position_counts();
        assert_eq!(run(&mut axis, 0.2, 10_000), 0);
        assert_eq!(axis.position_counts(), held);
        axis.stall(false);
        assert!(run(&mut axis, 0.2, 10_000) > 10);
    }

    #[test]
    fn without_drive_friction_brings_it_to_rest_and_never_back() {
        let mut axis = AxisPlant::new(&AxisConfig::default(), DT_S);
        run(&mut axis, 0.5, 10_000);
        let running_down = run(&mut axis, 0.0, 20_000);
        assert!(running_down > 0);
        assert_eq!(axis.state().speed_rad_s, 0.0);
    }
}
