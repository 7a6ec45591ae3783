//! [`PlanError`]: what a planner cannot take.

use crate::Point;
use core::fmt;

/// Reasons why a planner refuses an operation or a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PlanError {
    /// No room is left for the operation: take what is planned first, then push it again.
    Full,
    /// A place that is not finite, or farther than 10⁷ mm out.
    Place {
        /// The place, mm.
        place: Point,
    },
    /// A speed below 10⁻¹⁶ mm/s, or one that is not finite as an `f32`: of 3.4·10³⁸ mm/s and more.
    Feed {
        /// The speed, mm/s.
        feed_mm_s: f64,
    },
    /// An arc of more than a whole turn, or an angle that is no number.
    Sweep {
        /// The angle, rad.
        sweep_rad: f64,
    },
    /// A power outside 0 to 1.
    Power {
        /// The share.
        share: f64,
    },
    /// An operation that this planner does not know.
    Unknown,
    /// A way of planning that this one was built without: see [`ExactOnly`](super::ExactOnly).
    Mode {
        /// The setting that asks for it.
        quantity: &'static str,
    },
    /// A limit that no path through corners has: they are jumps of the velocity.
    Corners {
        /// The limit.
        quantity: &'static str,
    },
    /// The jerk as a vector is limited by averaging the steps, which this does not go with.
    Averaging {
        /// What it does not go with.
        quantity: &'static str,
    },
    /// A jerk as a vector that takes a window with more steps than there is room for.
    Window {
        /// The greatest jerk, mm/s³.
        jerk_mm_s3: f64,
        /// The least that would do at these speeds, mm/s³.
        least_mm_s3: f64,
    },
    /// A setting outside its range.
    Setting {
        /// The setting.
        quantity: &'static str,
        /// The value of the setting.
        value: f64,
        /// Least allowed value.
        least: f64,
        /// Greatest allowed value.
        most: f64,
    },
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Full => f.write_str("no room for another operation: take what is planned first"),
            Self::Place { place: Point { x, y } } => {
                write!(f, "({x}, {y}) mm is no place: coordinates must be finite and within ±1e7 mm")
            }
            Self::Feed { feed_mm_s } => {
                write!(f, "a speed of {feed_mm_s} mm/s: it must lie within 1e-16 to 3.4e38")
            }
            Self::Sweep { sweep_rad } => {
                write!(f, "an arc of {sweep_rad} rad: it must lie within one turn, ±6.2832")
            }
            Self::Power { share } => write!(f, "a laser power of {share}: it must lie in 0..=1"),
            Self::Unknown => f.write_str("an operation that is not known here"),
            Self::Mode { quantity } => write!(
                f,
                "{quantity} asks for what is not built in: build with AllModes, or leave the path exact, the jerk without a limit, \
                 the axes without play and the laser away"
            ),
            Self::Corners { quantity } => write!(
                f,
                "{quantity} can be limited within a tolerance only: a corner that is passed through its vertex is a jump of the \
                 velocity"
            ),
            Self::Averaging { quantity } => write!(
                f,
                "the jerk is limited as a vector by averaging the steps, which does not go with {quantity}: limit it along \
                 the path, in a machine's file by planner.jerk_limit = \"path\""
            ),
            Self::Window { jerk_mm_s3, least_mm_s3 } => write!(
                f,
                "a jerk of {jerk_mm_s3} mm/s³ as a vector: at these speeds it must be at least {least_mm_s3:.0}, or more \
                 steps are averaged than there is room for; allow more jerk or less speed, or limit it along the path"
            ),
            Self::Setting { quantity, value, least, most } => {
                write!(f, "{quantity} is {value}: it must lie in {least}..={most}")
            }
        }
    }
}

impl core::error::Error for PlanError {}
