//! Settings of the parts between a DC motor's shaft and the pen, `[x.transmission]` and `[y.transmission]`,
//! and of the delay of its drive.

use super::error::Bound;
use super::rules::{MachineKey, number, whole};
use super::{AxisConfig, ConfigError, DcConfig};
use core::f64::consts::TAU;

/// Belt, carriage and rail between a DC motor's shaft, where the encoder is, and the pen.
///
/// The default is none: the pen is where the shaft is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct TransmissionConfig {
    /// Play where the motion turns round, mm.
    pub backlash_mm: f64,
    /// Stiffness of the belt, N/mm; 0 for one that does not stretch.
    pub stiffness_n_per_mm: f64,
    /// Damping of the belt's oscillation, N s/mm.
    pub damping_n_s_per_mm: f64,
    /// Mass of the carriage, kg.
    pub carriage_kg: f64,
    /// Friction of the rail that it slides on, N.
    pub rail_friction_n: f64,
}

impl AxisConfig {
    /// How far the pen goes for a radian of the motor's shaft, mm.
    ///
    /// ```
    /// # use plotter_motion::config::AxisConfig;
    /// // 500 counts a turn at 40 counts/mm: 12.5 mm a turn
    /// assert!((AxisConfig::default().mm_per_rad() - 12.5 / core::f64::consts::TAU).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn mm_per_rad(&self) -> f64 {
        self.counts_per_turn() / TAU / self.counts_per_mm
    }
}

/// Stiffnesses of belts on small plotters; more than that swings too fast to matter.
const BELT: &str = "a belt of 6 mm gives 20 to 200 by its length; 0 for one that does not stretch";
const SIZE: &str = "it is given as a size, without sign: 0 for none";

macro_rules! transmission_rules {
    ($axis:ident) => {
        [
            number(
                concat!(stringify!($axis), ".transmission.backlash_mm"),
                |c| c.$axis.transmission.backlash_mm,
                (0.0, 10.0),
                "mm",
                SIZE,
            ),
            number(
                concat!(stringify!($axis), ".transmission.stiffness_n_per_mm"),
                |c| c.$axis.transmission.stiffness_n_per_mm,
                (0.0, 1.0e5),
                "N/mm",
                BELT,
            ),
            number(
                concat!(stringify!($axis), ".transmission.damping_n_s_per_mm"),
                |c| c.$axis.transmission.damping_n_s_per_mm,
                (0.0, 1.0e3),
                "N s/mm",
                SIZE,
            ),
            number(
                concat!(stringify!($axis), ".transmission.carriage_kg"),
                |c| c.$axis.transmission.carriage_kg,
                (0.0, 1.0e3),
                "kg",
                SIZE,
            ),
            number(
                concat!(stringify!($axis), ".transmission.rail_friction_n"),
                |c| c.$axis.transmission.rail_friction_n,
                (0.0, 1.0e4),
                "N",
                SIZE,
            ),
        ]
    };
}

/// The keys of both axes' transmissions, and the latency.
pub(super) static X_TRANSMISSION: [MachineKey; 5] = transmission_rules!(x);
pub(super) static Y_TRANSMISSION: [MachineKey; 5] = transmission_rules!(y);
pub(super) static LATENCY: [MachineKey; 1] = [whole(
    "control.latency_periods",
    |c| f64::from(c.control.latency_periods),
    (0.0, 100.0),
    "",
    "a controller that writes its duty at the next interrupt has 1",
)];

/// Refuses a transmission that cannot be.
pub(super) fn check_transmission(config: &DcConfig) -> Result<(), ConfigError> {
    let keys = [
        ("x.transmission.carriage_kg", "x.transmission.rail_friction_n"),
        ("y.transmission.carriage_kg", "y.transmission.rail_friction_n"),
    ];
    for (axis, (carriage, rail)) in [&config.x, &config.y].into_iter().zip(keys) {
        let TransmissionConfig { stiffness_n_per_mm, carriage_kg, rail_friction_n, .. } = axis.transmission;
        if stiffness_n_per_mm > 0.0 && carriage_kg <= 0.0 {
            return Err(ConfigError::Conflict {
                key: carriage,
                value: carriage_kg,
                bound: Bound::MoreThan,
                limit: 0.0,
                unit: "kg",
                remedy: "a belt that stretches (stiffness_n_per_mm) pulls at a mass",
            });
        }
        let motor = &axis.motor;
        let most_n_m = motor.torque_n_m_per_a * motor.supply_v / motor.resistance_ohm - axis.load.static_n_m;
        let most_n = most_n_m / (axis.mm_per_rad() / 1e3);
        if rail_friction_n >= most_n && rail_friction_n > 0.0 {
            return Err(ConfigError::Conflict {
                key: rail,
                value: rail_friction_n,
                bound: Bound::LessThan,
                limit: most_n,
                unit: "N",
                remedy: "what the stalled motor pulls with beyond its own static friction, or it never starts",
            });
        }
    }
    Ok(())
}
