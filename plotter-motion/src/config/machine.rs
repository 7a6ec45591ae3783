//! [`Machine`]: a description that has been checked.

use super::belt_check::check_belt;
use super::error::Bound;
use super::rules::rules;
use super::transmission::check_transmission;
use super::{
    AreaConfig, AxisConfig, ConfigError, ContouringConfig, ControlConfig, ControllerChoice, DcConfig,
    DriveConfig, FileConfig, JerkChoice, MachineConfig, PathChoice, SerialConfig, StepperConfig,
    SteppersConfig,
};
use crate::plant::StepperSettings;

/// A machine whose description has been checked: the only thing that the rest of the crate accepts.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, config::AreaConfig};
/// let a3 = AreaConfig { width_mm: 420.0, height_mm: 297.0 };
/// let machine = Machine::new(MachineConfig::default().with_area(a3))?;
/// assert_eq!(machine.config().area.width_mm, 420.0);
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    config: MachineConfig,
}

impl Machine {
    /// Checks a description.
    ///
    /// First each value by itself: finite and in the range that `docs/machine-config.md` gives. Then those
    /// that depend on one another. With DC motors:
    ///
    /// - a target travels as five decimal digits an axis, so the far corner of the area lies at no more
    ///   than 99999 encoder counts;
    /// - a silence that means *broken off* is longer than the pause that the host makes after every byte, and
    ///   than the byte itself (10 bits at 8N1);
    /// - the loop runs at least ten times as often as the position loop's natural frequency, and four times
    ///   as often as the estimator's;
    /// - static friction is at least as great as Coulomb friction, and less than the motor's stall torque
    ///   Kt V / R: otherwise the axis could never start;
    /// - under the contouring controller, the feed lies below the speed at which the motor's back EMF
    ///   reaches the supply: V / Ke rad/s at the shaft;
    /// - a belt that stretches pulls at a carriage with a mass, and the rail's friction is less than the
    ///   motor can pull.
    ///
    /// With one belt the area and the start lie within what both motors can turn, and what is common to both
    /// motors is the same: see `docs/machine-config.md`. Its serial line is not read.
    ///
    /// With stepper motors, for each axis:
    ///
    /// - it starts at no more than its greatest rate, and homing runs at no more than that either;
    /// - neither speed of the planner asks for more than its greatest rate;
    /// - the far corner of the area has a number of steps that 32 bits hold, and the area lies between the
    ///   limit switches that homing expects;
    /// - a jerk that is limited as a vector goes with a tolerance, without a laser or a third axis, and is
    ///   not so small that more steps would have to be averaged than there is room for.
    ///
    /// The simulated motor has torque up to some rate, more than its friction.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] for the first value that is wrong, with its key and what would be right.
    pub fn new(config: MachineConfig) -> Result<Self, ConfigError> {
        if config.schema != 1 {
            return Err(ConfigError::Schema { found: config.schema });
        }
        let file = FileConfig::from(config);
        rules().try_for_each(|rule| rule.check(&file))?;
        match &config.drive {
            DriveConfig::Gantry(dc) => {
                check_area(&config.area, dc)?;
                check_serial(&config.serial)?;
                check_dc(dc, &config.drive)?;
            }
            DriveConfig::Belt(belt) => {
                check_belt(&config.area, belt)?;
                check_dc(&belt.dc, &config.drive)?;
            }
            DriveConfig::Steppers(steppers) => {
                check_stepper_motor(&steppers.stepper_motor)?;
                check_stepper(&steppers.x, &X, config.area.width_mm, steppers)?;
                check_stepper(&steppers.y, &Y, config.area.height_mm, steppers)?;
                check_jerk(steppers)?;
                #[cfg(feature = "third-motor")]
                check_third_axis(&steppers.z)?;
            }
        }
        Ok(Self { config })
    }

    /// The description that was checked.
    #[must_use]
    pub const fn config(&self) -> &MachineConfig {
        &self.config
    }
}

/// Greatest coordinate that five decimal digits carry (the published serial protocol).
pub(super) const MAX_COUNTS: f64 = 99_999.0;
/// Bits on the line for a byte: one to start, eight of data, one to stop.
const BITS_PER_BYTE: f64 = 10.0;
/// Runs of the loop in a period of the position loop: fewer, and the delay of a run eats the phase margin.
const RUNS_PER_POSITION_PERIOD: f64 = 10.0;
/// Runs of the loop in a period of the estimator: with fewer its discrete form rings.
const RUNS_PER_OBSERVER_PERIOD: f64 = 4.0;

fn check_area(area: &AreaConfig, dc: &DcConfig) -> Result<(), ConfigError> {
    let width_limit_mm = MAX_COUNTS / dc.x.counts_per_mm;
    let height_limit_mm = MAX_COUNTS / dc.y.counts_per_mm;
    ConfigError::demand(
        "area.width_mm",
        area.width_mm,
        (Bound::AtMost, width_limit_mm),
        "mm",
        "the serial protocol carries coordinates up to 99999 counts: make the area smaller or x.counts_per_mm less",
    )?;
    ConfigError::demand(
        "area.height_mm",
        area.height_mm,
        (Bound::AtMost, height_limit_mm),
        "mm",
        "the serial protocol carries coordinates up to 99999 counts: make the area smaller or y.counts_per_mm less",
    )
}

fn check_serial(serial: &SerialConfig) -> Result<(), ConfigError> {
    let byte_ms = 1_000.0 * BITS_PER_BYTE / f64::from(serial.baud);
    ConfigError::demand(
        "serial.resync_gap_ms",
        serial.resync_gap_ms,
        (Bound::MoreThan, serial.byte_gap_ms + byte_ms),
        "ms",
        "or every target would be dropped between two bytes: that is serial.byte_gap_ms and one byte's time",
    )
}

fn check_dc(dc: &DcConfig, drive: &DriveConfig) -> Result<(), ConfigError> {
    check_control(&dc.control.contouring)?;
    check_axis(&dc.x, &X, &dc.control, drive)?;
    check_axis(&dc.y, &Y, &dc.control, drive)?;
    check_transmission(dc)
}

fn check_control(contouring: &ContouringConfig) -> Result<(), ConfigError> {
    ConfigError::demand(
        "control.contouring.bandwidth_hz",
        contouring.bandwidth_hz,
        (Bound::AtMost, contouring.loop_hz / RUNS_PER_POSITION_PERIOD),
        "Hz",
        "a tenth of control.contouring.loop_hz: run the loop more often or take less bandwidth",
    )?;
    ConfigError::demand(
        "control.contouring.observer_hz",
        contouring.observer_hz,
        (Bound::AtMost, contouring.loop_hz / RUNS_PER_OBSERVER_PERIOD),
        "Hz",
        "a quarter of control.contouring.loop_hz: run the loop more often or estimate more slowly",
    )
}

/// A jerk that is limited as a vector goes with all else.
fn check_jerk(steppers: &SteppersConfig) -> Result<(), ConfigError> {
    let planner = &steppers.planner;
    let unfit = |remedy| Err(ConfigError::Unfit { key: "planner.jerk_limit", value: "vector", remedy });
    if planner.mode == PathChoice::Exact && planner.jerk_limit == Some(JerkChoice::Vector) {
        return unfit(
            "goes with planner.mode = \"tolerance\" only: a corner that is passed through its vertex is a jump of the \
             velocity; write \"path\", or leave it out",
        );
    }
    if !planner.s_curve || planner.jerk_limit_in_force() != JerkChoice::Vector {
        return Ok(());
    }
    if cfg!(not(feature = "averaged-steps")) {
        return unfit("takes the feature averaged-steps of plotter-motion: build with it, or write \"path\"");
    }
    if steppers.laser.enabled {
        return unfit(
            "does not go with laser.enabled: the steps are averaged, and the laser's power would not follow; write \"path\"",
        );
    }
    #[cfg(feature = "third-motor")]
    if steppers.z.enabled {
        return unfit(
            "does not go with z.enabled: the steps are averaged, and the third axis would not follow; write \"path\"",
        );
    }
    #[cfg(feature = "averaged-steps")]
    if let Err(crate::planner::PlanError::Window { jerk_mm_s3, least_mm_s3 }) =
        crate::PlannerSettings::of_steppers(steppers).check_room(
            steppers.x.steps_per_mm,
            steppers.y.steps_per_mm,
            crate::stepgen::AVERAGED_STEPS,
        )
    {
        return ConfigError::demand(
            "planner.jerk_mm_s3",
            jerk_mm_s3,
            (Bound::AtLeast, libm::ceil(least_mm_s3)),
            "mm/s^3",
            "or more steps are averaged than there is room for: allow more jerk, lower planner.speed_mm_s and \
             planner.travel_speed_mm_s, or write planner.jerk_limit = \"path\"",
        );
    }
    Ok(())
}

/// The keys of one axis that another value can contradict.
struct AxisKeys {
    static_friction: &'static str,
    supply: &'static str,
    enable_pwm: &'static str,
    start_rate: &'static str,
    area: &'static str,
}

const X: AxisKeys = AxisKeys {
    static_friction: "x.load.static_n_m",
    supply: "x.motor.supply_v",
    enable_pwm: "x.motor.enable_pwm_hz",
    start_rate: "x.stepper.start_rate_hz",
    area: "area.width_mm",
};
const Y: AxisKeys = AxisKeys {
    static_friction: "y.load.static_n_m",
    supply: "y.motor.supply_v",
    enable_pwm: "y.motor.enable_pwm_hz",
    start_rate: "y.stepper.start_rate_hz",
    area: "area.height_mm",
};

fn check_axis(
    axis: &AxisConfig,
    keys: &AxisKeys,
    control: &ControlConfig,
    drive: &DriveConfig,
) -> Result<(), ConfigError> {
    let AxisConfig { motor, load, .. } = axis;
    ConfigError::demand(
        keys.static_friction,
        load.static_n_m,
        (Bound::AtLeast, load.coulomb_n_m),
        "N m",
        "friction at rest is never less than coulomb_n_m, the friction in motion",
    )?;
    ConfigError::demand(
        keys.static_friction,
        load.static_n_m,
        (Bound::LessThan, motor.torque_n_m_per_a * motor.supply_v / motor.resistance_ohm),
        "N m",
        "the torque of the stalled motor (torque_n_m_per_a * supply_v / resistance_ohm), or it never starts",
    )?;
    if control.controller == ControllerChoice::Contouring {
        if motor.enable_pwm_hz > 0.0 {
            ConfigError::demand(
                keys.enable_pwm,
                motor.enable_pwm_hz,
                (Bound::AtLeast, control.contouring.loop_hz),
                "Hz",
                "control.contouring.loop_hz, or a run's drive has no pulse: run the loop less often or the PWM faster",
            )?;
        }
        let counts_per_rad = axis.counts_per_turn() / core::f64::consts::TAU;
        let motor_mm_s = control.contouring.feed_mm_s * drive.motor_mm_per_mm();
        let shaft_rad_s = motor_mm_s * axis.counts_per_mm / counts_per_rad;
        ConfigError::demand(
            keys.supply,
            motor.supply_v,
            (Bound::MoreThan, shaft_rad_s * motor.back_emf_v_s),
            "V",
            "the motor's own voltage at control.contouring.feed_mm_s: draw slower or raise the supply",
        )?;
    }
    Ok(())
}

/// Steps of the far corner: a million short of what 32 bits hold, for play and the way beyond the switches.
const MAX_STEPS: f64 = 2_146_000_000.0;

fn check_stepper_motor(motor: &StepperSettings) -> Result<(), ConfigError> {
    ConfigError::demand(
        "stepper_motor.max_rate_hz",
        motor.max_rate_hz,
        (Bound::MoreThan, motor.corner_rate_hz),
        "pulses/s",
        "that is stepper_motor.corner_rate_hz, up to which the motor has all its torque",
    )?;
    ConfigError::demand(
        "stepper_motor.coulomb_n_m",
        motor.coulomb_n_m,
        (Bound::LessThan, motor.holding_n_m),
        "N m",
        "the torque of the motor (holding_n_m), or it never starts",
    )
}

#[cfg(feature = "third-motor")]
fn check_third_axis(z: &super::ZConfig) -> Result<(), ConfigError> {
    /// Greatest rate of a motor, pulses/s: what a controller's clock of microseconds gives out evenly.
    const MOST_HZ: f64 = 1e5;
    if !z.enabled {
        return Ok(());
    }
    for (key, height_mm) in [("z.up_mm", z.up_mm), ("z.down_mm", z.down_mm)] {
        let remedy = "the axis goes no higher: z.travel_mm";
        ConfigError::demand(key, height_mm, (Bound::AtMost, z.travel_mm), "mm", remedy)?;
    }
    ConfigError::demand(
        "z.speed_mm_s",
        z.speed_mm_s,
        (Bound::AtMost, MOST_HZ / z.steps_per_mm),
        "mm/s",
        "a controller makes 100000 pulses/s at most: be slower, or make z.steps_per_mm less",
    )
}

fn check_stepper(
    stepper: &StepperConfig,
    keys: &AxisKeys,
    length_mm: f64,
    steppers: &SteppersConfig,
) -> Result<(), ConfigError> {
    ConfigError::demand(
        keys.start_rate,
        stepper.start_rate_hz,
        (Bound::AtMost, stepper.max_rate_hz),
        "pulses/s",
        "that is the greatest rate of the axis, max_rate_hz",
    )?;
    for (key, rate_hz) in [
        ("homing.fast_rate_hz", steppers.homing.fast_rate_hz),
        ("homing.slow_rate_hz", steppers.homing.slow_rate_hz),
    ] {
        let remedy = "that is the greatest rate of an axis, stepper.max_rate_hz";
        ConfigError::demand(key, rate_hz, (Bound::AtMost, stepper.max_rate_hz), "pulses/s", remedy)?;
    }
    for (key, speed_mm_s) in [
        ("planner.speed_mm_s", steppers.planner.speed_mm_s),
        ("planner.travel_speed_mm_s", steppers.planner.travel_speed_mm_s),
    ] {
        let most_mm_s = stepper.max_rate_hz / stepper.steps_per_mm;
        let remedy = "the greatest speed of an axis (stepper.max_rate_hz / stepper.steps_per_mm)";
        ConfigError::demand(key, speed_mm_s, (Bound::AtMost, most_mm_s), "mm/s", remedy)?;
    }
    ConfigError::demand(
        keys.area,
        length_mm,
        (Bound::AtMost, MAX_STEPS / stepper.steps_per_mm),
        "mm",
        "positions are steps of 32 bits: make the area smaller or stepper.steps_per_mm less",
    )?;
    ConfigError::demand(
        keys.area,
        length_mm,
        (Bound::AtMost, steppers.homing.max_travel_mm - 2.0 * steppers.homing.pull_off_mm),
        "mm",
        "the area lies between the limit switches: homing.max_travel_mm less homing.pull_off_mm at either end",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{AreaConfig, ContouringConfig, ControlConfig, LoadConfig};
    use std::string::ToString;

    fn refusal(config: MachineConfig) -> ConfigError {
        Machine::new(config).expect_err("refused")
    }

    #[test]
    fn the_documented_gantry_is_a_machine() {
        assert_eq!(Machine::new(MachineConfig::default()).map(|m| *m.config()), Ok(MachineConfig::default()));
    }

    #[test]
    fn the_far_corner_is_the_last_coordinate_that_five_digits_carry() {
        // 99999 counts at 40 counts/mm are 2499.975 mm.
        let wide = |width_mm| {
            let area = AreaConfig { width_mm, height_mm: 420.0 };
            Machine::new(MachineConfig { area, ..MachineConfig::default() })
        };
        assert!(wide(2_499.975).is_ok());
        assert_eq!(
            wide(2_500.0).expect_err("refused").to_string(),
            "area.width_mm: 2500 mm must be at most 2499.975 mm; the serial protocol carries coordinates up to \
             99999 counts: make the area smaller or x.counts_per_mm less"
        );
    }

    #[test]
    fn static_friction_lies_between_coulomb_friction_and_stall_torque() {
        // 13.4e-3 N m/A * 12 V / 1.9 ohm = 84.63 mN m.
        let axis = |static_n_m| {
            let load = LoadConfig { coulomb_n_m: 1.0e-3, static_n_m, ..LoadConfig::default() };
            let y = AxisConfig { load, ..AxisConfig::default() };
            MachineConfig::from(DcConfig { y, ..DcConfig::default() })
        };
        assert!(Machine::new(axis(1.0e-3)).is_ok());
        assert!(Machine::new(axis(0.0846)).is_ok());
        assert_eq!(refusal(axis(0.9e-3)).key(), "y.load.static_n_m");
        assert!(matches!(refusal(axis(0.0847)), ConfigError::Conflict { bound: Bound::LessThan, .. }));
    }

    #[test]
    fn a_feed_beyond_the_no_load_speed_is_refused_for_the_controller_that_runs_at_it() {
        // 12 V / 13.369e-3 V s = 897.6 rad/s = 142.86 turns/s, at 500 counts a turn and 40 counts/mm 1785.7
        // mm/s.
        let at = |feed_mm_s, controller| {
            let contouring = ContouringConfig { feed_mm_s, ..ContouringConfig::default() };
            let control = ControlConfig { controller, contouring, ..ControlConfig::default() };
            Machine::new(DcConfig { control, ..DcConfig::default() }.into())
        };
        assert!(at(1_785.0, ControllerChoice::Contouring).is_ok());
        assert_eq!(at(1_787.0, ControllerChoice::Contouring).expect_err("refused").key(), "x.motor.supply_v");
        assert!(at(1_787.0, ControllerChoice::Published).is_ok());
    }

    #[test]
    fn what_contradicts_itself_in_a_stepper_plotter_is_named() {
        let changed = |change: fn(&mut MachineConfig)| {
            let mut config = MachineConfig::stepper_plotter();
            change(&mut config);
            refusal(config).to_string()
        };
        assert_eq!(
            changed(|c| c.steppers_mut().unwrap().planner.travel_speed_mm_s = 100.0),
            "planner.travel_speed_mm_s: 100 mm/s must be at most 91.34505594884678 mm/s; the greatest speed of an \
             axis (stepper.max_rate_hz / stepper.steps_per_mm)"
        );
        assert_eq!(
            changed(|c| c.steppers_mut().unwrap().y.start_rate_hz = 9_000.0),
            "y.stepper.start_rate_hz: 9000 pulses/s must be at most 8000 pulses/s; that is the greatest rate of the \
             axis, max_rate_hz"
        );
        assert_eq!(
            changed(|c| c.area.width_mm = 449.0),
            "area.width_mm: 449 mm must be at most 448 mm; the area lies between the limit switches: \
             homing.max_travel_mm less homing.pull_off_mm at either end"
        );
        let key_of = |change: fn(&mut MachineConfig)| {
            let mut config = MachineConfig::stepper_plotter();
            change(&mut config);
            refusal(config).key()
        };
        assert_eq!(key_of(|c| c.steppers_mut().unwrap().x.max_rate_hz = 7_999.0), "homing.fast_rate_hz");
        assert_eq!(
            key_of(|c| c.steppers_mut().unwrap().stepper_motor.coulomb_n_m = 0.28),
            "stepper_motor.coulomb_n_m"
        );
        assert_eq!(
            key_of(|c| c.steppers_mut().unwrap().stepper_motor.max_rate_hz = 8_000.0),
            "stepper_motor.max_rate_hz"
        );
        // 1e5 steps/mm: 2146 million steps are 21.46 m, and 8e9 pulses/s would be no rate
        assert_eq!(
            key_of(|c| {
                let x = &mut c.steppers_mut().unwrap().x;
                (x.steps_per_mm, x.max_rate_hz) = (1e5, 1e6);
                (
                    c.steppers_mut().unwrap().planner.speed_mm_s,
                    c.steppers_mut().unwrap().planner.travel_speed_mm_s,
                ) = (10.0, 10.0);
                (c.area.width_mm, c.steppers_mut().unwrap().homing.max_travel_mm) = (22_000.0, 50_000.0);
            }),
            "area.width_mm"
        );
    }
}
