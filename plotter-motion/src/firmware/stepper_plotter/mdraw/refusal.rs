//! [`Refusal`]: why a line is not carried out.

use super::super::Stop;
use crate::homing::HomingError;
use core::fmt;

/// Why a line is not carried out, told in the line before its `OK`. No text may hold the letters `OK`: mDraw
/// looks for them anywhere in a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Refusal {
    TooLong,
    Broken,
    Early,
    NoNumber {
        command: &'static str,
    },
    Range {
        command: &'static str,
        least: i32,
        most: i32,
    },
    Area {
        x: f32,
        y: f32,
        width_mm: u16,
        height_mm: u16,
    },
    Stopped(Stop),
    Homing(HomingError),
    #[cfg(feature = "third-motor")]
    HomingZ(super::super::ZHomingError),
    #[cfg(feature = "third-motor")]
    Squaring(super::super::SquaringError),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong => {
                write!(f, "more than {} bytes in a line: left out", super::MOST_BYTES)
            }
            Self::Broken => f.write_str("a byte of this line came broken: left out"),
            Self::Early => f.write_str("sent before the line before it was answered: left out"),
            Self::NoNumber { command } => write!(f, "{command} lacks its number: left out"),
            Self::Range { command, least, most } => {
                write!(f, "{command} must lie in {least}..={most}: left out")
            }
            Self::Area { x, y, width_mm, height_mm } => {
                write!(f, "({x:.2}, {y:.2}) mm lies outside (0, 0)..=({width_mm}, {height_mm}) mm: left out")
            }
            Self::Stopped(stop) => stop.fmt(f),
            Self::Homing(error) => error.fmt(f),
            #[cfg(feature = "third-motor")]
            Self::HomingZ(error) => error.fmt(f),
            #[cfg(feature = "third-motor")]
            Self::Squaring(error) => error.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::firmware::stepper_plotter::Activity;
    use crate::{Axis, Direction};
    use std::string::ToString;

    #[test]
    fn no_refusal_can_be_taken_for_an_answer() {
        let (axis, end, steps) = (Axis::X, Direction::Minus, u32::MAX);
        let refusals = [
            Refusal::TooLong,
            Refusal::Broken,
            Refusal::Early,
            Refusal::NoNumber { command: "M1" },
            Refusal::Range { command: "W", least: 1, most: 10_000 },
            Refusal::Area { x: f32::MAX, y: f32::MIN, width_mm: u16::MAX, height_mm: u16::MAX },
            Refusal::Stopped(Stop::Emergency),
            Refusal::Stopped(Stop::Limit { axis, end }),
            Refusal::Stopped(Stop::Reset { during: Activity::Run }),
            Refusal::Homing(HomingError::Missing { axis, end, steps }),
            Refusal::Homing(HomingError::Stuck { axis, end, steps }),
            Refusal::Homing(HomingError::Wrong { axis, end }),
            Refusal::Homing(HomingError::Both { axis }),
            Refusal::Homing(HomingError::Short { axis, steps }),
            Refusal::Homing(HomingError::Early { axis, steps }),
        ];
        for refusal in refusals {
            let text = refusal.to_string();
            assert!(!text.contains("OK") && !text.contains('\n'), "{text}");
            assert!(text.len() < super::super::MOST_ANSWER - 16, "{} bytes: {text}", text.len());
        }
    }
}
