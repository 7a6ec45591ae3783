//! [`Machine`]: a description that has been checked.

use super::error::Bound;
use super::rules::rules;
use super::{AxisConfig, ConfigError, ControllerChoice, MachineConfig};

/// A machine whose description has been checked: the only thing that the rest of the crate accepts.
///
/// ```
/// # use plotter_motion::{AreaConfig, Machine, MachineConfig};
/// let a3 = AreaConfig { width_mm: 420.0, height_mm: 297.0 };
/// let machine = Machine::new(MachineConfig { area: a3, ..MachineConfig::default() })?;
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
    /// that depend on one another:
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
    ///   reaches the supply: V / Ke rad/s at the shaft.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] for the first value that is wrong, with its key and what would be right.
    pub fn new(config: MachineConfig) -> Result<Self, ConfigError> {
        if config.schema != 1 {
            return Err(ConfigError::Schema { found: config.schema });
        }
        rules().try_for_each(|rule| rule.check(&config))?;
        check_area(&config)?;
        check_serial(&config)?;
        check_control(&config)?;
        check_axis(&config.x, &X, &config)?;
        check_axis(&config.y, &Y, &config)?;
        Ok(Self { config })
    }

    /// The description that was checked.
    #[must_use]
    pub fn config(&self) -> &MachineConfig {
        &self.config
    }
}

/// Greatest coordinate that five decimal digits carry (the published serial protocol).
const MAX_COUNTS: f64 = 99_999.0;
/// Bits on the line for a byte: one to start, eight of data, one to stop.
const BITS_PER_BYTE: f64 = 10.0;
/// Runs of the loop in a period of the position loop: fewer, and the delay of a run eats the phase margin.
const RUNS_PER_POSITION_PERIOD: f64 = 10.0;
/// Runs of the loop in a period of the estimator: with fewer its discrete form rings.
const RUNS_PER_OBSERVER_PERIOD: f64 = 4.0;

/// Refuses `value` behind `key` unless it lies on the right side of `limit`.
fn demand(
    key: &'static str,
    value: f64,
    (bound, limit): (Bound, f64),
    unit: &'static str,
    remedy: &'static str,
) -> Result<(), ConfigError> {
    if bound.holds(value, limit) {
        Ok(())
    } else {
        Err(ConfigError::Conflict { key, value, bound, limit, unit, remedy })
    }
}

fn check_area(config: &MachineConfig) -> Result<(), ConfigError> {
    let width_limit_mm = MAX_COUNTS / config.x.counts_per_mm;
    let height_limit_mm = MAX_COUNTS / config.y.counts_per_mm;
    demand(
        "area.width_mm",
        config.area.width_mm,
        (Bound::AtMost, width_limit_mm),
        "mm",
        "the serial protocol carries coordinates up to 99999 counts: make the area smaller or x.counts_per_mm less",
    )?;
    demand(
        "area.height_mm",
        config.area.height_mm,
        (Bound::AtMost, height_limit_mm),
        "mm",
        "the serial protocol carries coordinates up to 99999 counts: make the area smaller or y.counts_per_mm less",
    )
}

fn check_serial(config: &MachineConfig) -> Result<(), ConfigError> {
    let byte_ms = 1_000.0 * BITS_PER_BYTE / f64::from(config.serial.baud);
    demand(
        "serial.resync_gap_ms",
        config.serial.resync_gap_ms,
        (Bound::MoreThan, config.serial.byte_gap_ms + byte_ms),
        "ms",
        "or every target would be dropped between two bytes: that is serial.byte_gap_ms and one byte's time",
    )
}

fn check_control(config: &MachineConfig) -> Result<(), ConfigError> {
    let contouring = &config.control.contouring;
    demand(
        "control.contouring.bandwidth_hz",
        contouring.bandwidth_hz,
        (Bound::AtMost, contouring.loop_hz / RUNS_PER_POSITION_PERIOD),
        "Hz",
        "a tenth of control.contouring.loop_hz: run the loop more often or take less bandwidth",
    )?;
    demand(
        "control.contouring.observer_hz",
        contouring.observer_hz,
        (Bound::AtMost, contouring.loop_hz / RUNS_PER_OBSERVER_PERIOD),
        "Hz",
        "a quarter of control.contouring.loop_hz: run the loop more often or estimate more slowly",
    )
}

/// The keys of one axis that another value can contradict.
struct AxisKeys {
    static_friction: &'static str,
    supply: &'static str,
}

const X: AxisKeys = AxisKeys { static_friction: "x.load.static_n_m", supply: "x.motor.supply_v" };
const Y: AxisKeys = AxisKeys { static_friction: "y.load.static_n_m", supply: "y.motor.supply_v" };

fn check_axis(axis: &AxisConfig, keys: &AxisKeys, config: &MachineConfig) -> Result<(), ConfigError> {
    let AxisConfig { motor, load, .. } = axis;
    demand(
        keys.static_friction,
        load.static_n_m,
        (Bound::AtLeast, load.coulomb_n_m),
        "N m",
        "friction at rest is never less than coulomb_n_m, the friction in motion",
    )?;
    demand(
        keys.static_friction,
        load.static_n_m,
        (Bound::LessThan, motor.torque_n_m_per_a * motor.supply_v / motor.resistance_ohm),
        "N m",
        "the torque of the stalled motor (torque_n_m_per_a * supply_v / resistance_ohm), or it never starts",
    )?;
    if config.control.controller == ControllerChoice::Contouring {
        let counts_per_rad = axis.counts_per_turn() / core::f64::consts::TAU;
        let shaft_rad_s = config.control.contouring.feed_mm_s * axis.counts_per_mm / counts_per_rad;
        demand(
            keys.supply,
            motor.supply_v,
            (Bound::MoreThan, shaft_rad_s * motor.back_emf_v_s),
            "V",
            "the motor's own voltage at control.contouring.feed_mm_s: draw slower or raise the supply",
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AreaConfig, ContouringConfig, ControlConfig, LoadConfig};
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
            MachineConfig { y: AxisConfig { load, ..AxisConfig::default() }, ..MachineConfig::default() }
        };
        assert!(Machine::new(axis(1.0e-3)).is_ok());
        assert!(Machine::new(axis(0.0846)).is_ok());
        assert_eq!(refusal(axis(0.9e-3)).key(), "y.load.static_n_m");
        assert!(matches!(refusal(axis(0.0847)), ConfigError::Conflict { bound: Bound::LessThan, .. }));
    }

    #[test]
    fn a_feed_beyond_the_no_load_speed_is_refused_for_the_controller_that_runs_at_it() {
        // 12 V / 13.369e-3 V s = 897.6 rad/s = 142.86 turns/s, at 500 counts a turn and 40 counts/mm 1785.7 mm/s.
        let at = |feed_mm_s, controller| {
            let contouring = ContouringConfig { feed_mm_s, ..ContouringConfig::default() };
            let control = ControlConfig { controller, contouring, ..ControlConfig::default() };
            Machine::new(MachineConfig { control, ..MachineConfig::default() })
        };
        assert!(at(1_785.0, ControllerChoice::Contouring).is_ok());
        assert_eq!(at(1_787.0, ControllerChoice::Contouring).expect_err("refused").key(), "x.motor.supply_v");
        assert!(at(1_787.0, ControllerChoice::Published).is_ok());
    }
}
