//! The tables of a third motor: [`ZConfig`] and [`SecondMotorConfig`].

use super::Key;
use super::rules::{MachineKey, number};

/// A third axis: `[z]`, a tool that is raised and lowered by a stepper motor of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct ZConfig {
    /// Whether there is one.
    pub enabled: bool,
    /// Pulses (microsteps) to the millimetre.
    pub steps_per_mm: f64,
    /// Greatest speed, mm/s.
    pub speed_mm_s: f64,
    /// Greatest acceleration, mm/s^2.
    pub accel_mm_s2: f64,
    /// From the lowest place to the highest, mm.
    pub travel_mm: f64,
    /// Whether it lifts the pen, instead of being moved by the Z of a text.
    pub lifts_pen: bool,
    /// Height with the pen up, mm.
    pub up_mm: f64,
    /// Height with the pen down, mm.
    pub down_mm: f64,
    /// Whether it has a switch at its upper end, by which it is homed.
    pub homes: bool,
    /// Rate at which its motor may start and stop at once, pulses/s.
    pub start_rate_hz: f64,
}

impl Default for ZConfig {
    /// None; of one a spindle of 8 mm a turn with 3200 steps.
    fn default() -> Self {
        Self {
            enabled: false,
            steps_per_mm: 400.0,
            speed_mm_s: 10.0,
            accel_mm_s2: 100.0,
            travel_mm: 30.0,
            lifts_pen: false,
            up_mm: 5.0,
            down_mm: 0.0,
            homes: false,
            start_rate_hz: 2_000.0,
        }
    }
}

/// The axis with two motors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum SecondMotorChoice {
    /// Neither.
    #[default]
    None,
    /// The first.
    X,
    /// The second.
    Y,
}

/// Two motors on an axis: `[second_motor]`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct SecondMotorConfig {
    /// The axis with two motors.
    pub axis: SecondMotorChoice,
    /// How much farther the second one leaves its lower switch than the first, mm: what the switches are out
    /// of square.
    pub offset_mm: f64,
    /// How far one may go on alone where both are made square, mm.
    pub max_skew_mm: f64,
}

impl Default for SecondMotorConfig {
    /// None.
    fn default() -> Self {
        Self { axis: SecondMotorChoice::None, offset_mm: 0.0, max_skew_mm: 10.0 }
    }
}

/// Keys of the tables.
pub(super) static RULES: [MachineKey; 13] = [
    Key::switch("z.enabled"),
    number(
        "z.steps_per_mm",
        |c| c.z.steps_per_mm,
        (0.01, 10000.0),
        "steps/mm",
        "a spindle of 8 mm a turn with 3200 steps has 400",
    ),
    number(
        "z.speed_mm_s",
        |c| c.z.speed_mm_s,
        (0.01, 10000.0),
        "mm/s",
        "a spindle of 8 mm makes 10 with 75 turns a minute",
    ),
    number(
        "z.accel_mm_s2",
        |c| c.z.accel_mm_s2,
        (0.1, 1000000.0),
        "mm/s^2",
        "100 lifts a pen by 5 mm in half a second",
    ),
    number(
        "z.travel_mm",
        |c| c.z.travel_mm,
        (0.01, 65535.0),
        "mm",
        "how far the tool goes up and down in all",
    ),
    Key::switch("z.lifts_pen"),
    number("z.up_mm", |c| c.z.up_mm, (0.0, 65535.0), "mm", "a few millimetres above the sheet"),
    number("z.down_mm", |c| c.z.down_mm, (0.0, 65535.0), "mm", "where the pen touches the sheet"),
    Key::switch("z.homes"),
    number(
        "z.start_rate_hz",
        |c| c.z.start_rate_hz,
        (1.0, 1000000.0),
        "pulses/s",
        "a motor without a load starts with 2000 of 3200 steps a turn",
    ),
    Key::choice("second_motor.axis", &["none", "x", "y"]),
    number(
        "second_motor.offset_mm",
        |c| c.second_motor.offset_mm,
        (-100.0, 100.0),
        "mm",
        "measure both diagonals of a square that the machine has drawn",
    ),
    number(
        "second_motor.max_skew_mm",
        |c| c.second_motor.max_skew_mm,
        (0.01, 1000.0),
        "mm",
        "by how much the gantry may be racked without harm",
    ),
];
