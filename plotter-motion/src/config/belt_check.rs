//! Checks of settings that must fit together in a machine with one belt.

use super::error::Bound;
use super::machine::MAX_COUNTS;
use super::{AreaConfig, ConfigError, DcConfig, Decoding, OneBeltConfig, PointToPointConfig};
use core::f64::consts::TAU;

/// Checks a machine whose motors `x` and `y` drive the same belt.
pub(super) fn check_belt(area: &AreaConfig, belt: &OneBeltConfig) -> Result<(), ConfigError> {
    check_motors(&belt.dc)?;
    check_place(area, belt)?;
    check_drive(&belt.point_to_point)?;
    check_rails(belt)
}

/// What both motors have in common.
fn check_motors(config: &DcConfig) -> Result<(), ConfigError> {
    for (key, decoding) in
        [("x.encoder.decoding", config.x.encoder.decoding), ("y.encoder.decoding", config.y.encoder.decoding)]
    {
        let value = match decoding {
            Decoding::X1 => "x1",
            Decoding::X2 => continue,
            Decoding::X4 => "x4",
        };
        return Err(ConfigError::Unfit {
            key,
            value,
            remedy: "does not go with kinematics.type = \"corexy\", whose encoders have one phase and count both its edges: \
                     write \"x2\", and half the pulses of a turn as lines_per_turn",
        });
    }
    for (key, hz) in [
        ("x.motor.enable_pwm_hz", config.x.motor.enable_pwm_hz),
        ("y.motor.enable_pwm_hz", config.y.motor.enable_pwm_hz),
    ] {
        let remedy = "the simulated motors of a belt brake between their pulses";
        ConfigError::demand(key, hz, (Bound::AtMost, 0.0), "Hz", remedy)?;
    }
    let lines = |axis: &super::AxisConfig| f64::from(axis.encoder.lines_per_turn);
    for (key, value, of_x, unit) in [
        ("y.counts_per_mm", config.y.counts_per_mm, config.x.counts_per_mm, "counts/mm"),
        ("y.encoder.lines_per_turn", lines(&config.y), lines(&config.x), ""),
    ] {
        let remedy = "both motors drive the same belt: write what x has";
        ConfigError::demand(key, value, (Bound::AtLeast, of_x), unit, remedy)?;
        ConfigError::demand(key, value, (Bound::AtMost, of_x), unit, remedy)?;
    }
    Ok(())
}

/// Area and start.
fn check_place(area: &AreaConfig, belt: &OneBeltConfig) -> Result<(), ConfigError> {
    // From one corner to the other across, one motor alone makes x + y.
    let farthest_mm = MAX_COUNTS / belt.dc.x.counts_per_mm;
    ConfigError::demand(
        "area.width_mm",
        area.width_mm,
        (Bound::AtMost, farthest_mm - area.height_mm),
        "mm",
        "a motor of a belt turns by width and height together, and up to 99999 counts are reckoned with: make the area \
         smaller or counts_per_mm less",
    )?;
    let inside = "that is the area: the pen is inside when the machine is switched on";
    ConfigError::demand(
        "belt.start_x_mm",
        belt.belt.start_x_mm,
        (Bound::AtMost, area.width_mm),
        "mm",
        inside,
    )?;
    ConfigError::demand(
        "belt.start_y_mm",
        belt.belt.start_y_mm,
        (Bound::AtMost, area.height_mm),
        "mm",
        inside,
    )
}

fn check_drive(config: &PointToPointConfig) -> Result<(), ConfigError> {
    ConfigError::demand(
        "point_to_point.drive_start",
        config.drive_start,
        (Bound::AtMost, config.drive_most),
        "",
        "that is point_to_point.drive_most, which the drive grows to",
    )
}

fn check_rails(config: &OneBeltConfig) -> Result<(), ConfigError> {
    let belt = &config.belt;
    // How far the pen goes along an axis for a radian of one motor, m.
    let m_per_rad = config.dc.x.counts_per_turn() / TAU / config.dc.x.counts_per_mm / 1000.0 / 2.0;
    let push_n = [&config.dc.x, &config.dc.y].map(|axis| {
        let stall_n_m = axis.motor.torque_n_m_per_a * axis.motor.supply_v / axis.motor.resistance_ohm;
        (stall_n_m - axis.load.static_n_m) / m_per_rad
    });
    let most_n: f64 = push_n.iter().sum();
    for (key, at_rest_n, sliding_n) in [
        ("belt.x_rail_static_n", belt.x_rail_static_n, belt.x_rail_coulomb_n),
        ("belt.y_rail_static_n", belt.y_rail_static_n, belt.y_rail_coulomb_n),
    ] {
        let remedy = "friction at rest is never less than that in motion";
        ConfigError::demand(key, at_rest_n, (Bound::AtLeast, sliding_n), "N", remedy)?;
        let remedy = "the force of both stalled motors, or the carriage never starts";
        ConfigError::demand(key, at_rest_n, (Bound::LessThan, most_n), "N", remedy)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::{ConfigError, Machine, MachineConfig};
    use std::string::ToString;

    fn refusal(change: fn(&mut MachineConfig)) -> ConfigError {
        let mut config = MachineConfig::marking_board();
        change(&mut config);
        Machine::new(config).expect_err("refused")
    }

    #[test]
    fn a_motor_turns_by_width_and_height_together() {
        // 99999 counts at 46.3 counts/mm are 2159.8 mm: 1959.8 mm beside a height of 200 mm.
        assert!(
            Machine::new(MachineConfig {
                area: crate::config::AreaConfig { width_mm: 1_959.0, height_mm: 200.0 },
                ..MachineConfig::marking_board()
            })
            .is_ok()
        );
        let refused = refusal(|c| c.area.width_mm = 1_960.0);
        assert_eq!(refused.key(), "area.width_mm");
        assert!(refused.to_string().contains("width and height together"), "{refused}");
    }

    #[test]
    fn what_contradicts_itself_on_a_belt_is_named() {
        assert_eq!(refusal(|c| c.dc_mut().unwrap().y.counts_per_mm = 46.0).key(), "y.counts_per_mm");
        assert_eq!(
            refusal(|c| c.dc_mut().unwrap().y.encoder.lines_per_turn = 24).key(),
            "y.encoder.lines_per_turn"
        );
        assert_eq!(refusal(|c| c.belt_mut().unwrap().belt.start_y_mm = 200.5).key(), "belt.start_y_mm");
        assert_eq!(
            refusal(|c| c.belt_mut().unwrap().point_to_point.drive_start = 0.5).key(),
            "point_to_point.drive_start"
        );
        assert_eq!(
            refusal(|c| c.belt_mut().unwrap().belt.x_rail_static_n = 5.0).key(),
            "belt.x_rail_static_n"
        );
        assert_eq!(
            refusal(|c| c.belt_mut().unwrap().belt.y_rail_static_n = 5_000.0).key(),
            "belt.y_rail_static_n"
        );
        // 12 V turn the second motor at 67.3 mm/s of its belt: 47.6 mm/s along a diagonal.
        assert_eq!(
            refusal(|c| c.dc_mut().unwrap().control.contouring.feed_mm_s = 48.0).key(),
            "y.motor.supply_v"
        );
        assert_eq!(
            refusal(|c| c.dc_mut().unwrap().x.encoder.decoding = crate::config::Decoding::X4).key(),
            "x.encoder.decoding"
        );
    }
}
