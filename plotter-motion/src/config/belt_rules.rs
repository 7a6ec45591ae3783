//! The keys of machines with a belt, with unit, range and what would be right.

use super::Key;
use super::rules::{MachineKey, number};

const SHARE: &str = "it is a share: 0.1 is a tenth";
const SIZE_OF_FRICTION: &str = "friction is given as a size, without sign: 0 for none";

/// Keys of `[kinematics]`, `[belt]` and `[point_to_point]`.
pub(super) static BELT: [MachineKey; 28] = [
    Key::choice("kinematics.type", &["cartesian", "corexy"]),
    Key::choice("kinematics.signs", &["direction-table", "tracking-equations"]),
    number(
        "belt.start_x_mm",
        |c| c.belt.start_x_mm,
        (0.0, 100_000.0),
        "mm",
        "the documented marking board is switched on in the middle, at 150",
    ),
    number(
        "belt.start_y_mm",
        |c| c.belt.start_y_mm,
        (0.0, 100_000.0),
        "mm",
        "the documented marking board is switched on in the middle, at 100",
    ),
    number(
        "belt.speed_window_mm_s",
        |c| c.belt.speed_window_mm_s,
        (0.01, 10_000.0),
        "mm/s",
        "the documented marking board has its full window of 100 ms at 30",
    ),
    Key::choice("belt.known_motors", &["each", "mean"]),
    number(
        "belt.run_down_ms",
        |c| c.belt.run_down_ms,
        (0.0, 10_000.0),
        "ms",
        "30 are enough for a small motor with a gear",
    ),
    number("belt.unequal_share", |c| c.belt.unequal_share, (0.0, 1.0), "", SHARE),
    number("belt.x_rail_coulomb_n", |c| c.belt.x_rail_coulomb_n, (0.0, 10_000.0), "N", SIZE_OF_FRICTION),
    number("belt.x_rail_static_n", |c| c.belt.x_rail_static_n, (0.0, 10_000.0), "N", SIZE_OF_FRICTION),
    number("belt.y_rail_coulomb_n", |c| c.belt.y_rail_coulomb_n, (0.0, 10_000.0), "N", SIZE_OF_FRICTION),
    number("belt.y_rail_static_n", |c| c.belt.y_rail_static_n, (0.0, 10_000.0), "N", SIZE_OF_FRICTION),
    number(
        "point_to_point.allowed_error_mm",
        |c| c.point_to_point.allowed_error_mm,
        (0.001, 100.0),
        "mm",
        "the documented marking board has 0.45",
    ),
    number(
        "point_to_point.period_ms",
        |c| c.point_to_point.period_ms,
        (0.1, 1_000.0),
        "ms",
        "5 are 200 runs a second",
    ),
    number("point_to_point.drive_start", |c| c.point_to_point.drive_start, (0.0, 1.0), "", SHARE),
    number("point_to_point.drive_step", |c| c.point_to_point.drive_step, (0.0, 1.0), "", SHARE),
    number(
        "point_to_point.drive_step_ms",
        |c| c.point_to_point.drive_step_ms,
        (0.0, 10_000.0),
        "ms",
        "the documented ramp has 100, and 0 is none",
    ),
    number("point_to_point.drive_most", |c| c.point_to_point.drive_most, (0.001, 1.0), "", SHARE),
    number(
        "point_to_point.slow_mm",
        |c| c.point_to_point.slow_mm,
        (0.0, 1_000.0),
        "mm",
        "a few times the run-down is a good choice, and 0 is none",
    ),
    number("point_to_point.factor_x", |c| c.point_to_point.factor_x, (0.001, 1.0), "", SHARE),
    number("point_to_point.factor_y", |c| c.point_to_point.factor_y, (0.001, 1.0), "", SHARE),
    number(
        "point_to_point.run_down_ms",
        |c| c.point_to_point.run_down_ms,
        (0.0, 10_000.0),
        "ms",
        "30 are enough for a small motor with a gear",
    ),
    number("point_to_point.unequal_share", |c| c.point_to_point.unequal_share, (0.0, 1.0), "", SHARE),
    Key::switch("point_to_point.equalize"),
    number(
        "point_to_point.equalizer_time_constant_ms",
        |c| c.point_to_point.equalizer_time_constant_ms,
        (0.1, 10_000.0),
        "ms",
        "the time in which a motor reaches two thirds of its speed: a small one with a gear has 10 to 100",
    ),
    number(
        "point_to_point.equalizer_pole_rad_s",
        |c| c.point_to_point.equalizer_pole_rad_s,
        (0.1, 10_000.0),
        "rad/s",
        "the inverse of the motors' time constant is a good choice",
    ),
    number(
        "point_to_point.equalizer_full_speed_mm_s",
        |c| c.point_to_point.equalizer_full_speed_mm_s,
        (0.01, 10_000.0),
        "mm/s",
        "measure it at full drive without a load",
    ),
    number(
        "point_to_point.equalizer_most_trim",
        |c| c.point_to_point.equalizer_most_trim,
        (0.0, 1.0),
        "",
        SHARE,
    ),
];
