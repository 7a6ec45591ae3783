//! [`CoreXy`]: one belt and two motors, each of which moves the pen along a diagonal.
//!
//! ```text
//!        up                    direction table (Khan and McGinn 2017, table 1):
//!   M2'   │   M2                motor 1 forwards: right and down, M1 = x − y
//!     ╲   │   ╱                 motor 2 forwards: right and up,   M2 = x + y
//!      ╲  │  ╱
//!  left ──●── right            tracking equations (section 0.2.3): x = (A − B)/2, y = (A + B)/2
//!      ╱  │  ╲                  motor A forwards: right and up,   A = x + y
//!     ╱   │   ╲                 motor B forwards: left and up,    B = y − x
//!   M1'   │   M1
//!       down                   M1' and M2': that motor backwards
//! ```
//!
//! The report gives both and they look as if they disagreed: with A for motor 1 and B for motor 2 "right"
//! would be up. They agree when A is motor 2 and B is motor 1 counted the other way round, A = M2 and B =
//! −M1. [`BeltSigns`] has a name for either, and everything that mixes axes into motors says which it means.

use super::cartesian::{LEAST_STEPS_PER_MM, MOST_STEPS_PER_MM};
use super::{Kinematics, MotorPoint, ScaleError};
use crate::config::OneBeltConfig;
use crate::{Axis, Machine, Point};
use core::ops::{Add, Sub};

/// Directions of the two motors of a belt for a move of the pen.
///
/// ```
/// # use plotter_motion::kinematics::BeltSigns;
/// assert_eq!(BeltSigns::DirectionTable.motors(1, 0), (1, 1)); // right: both forwards
/// assert_eq!(BeltSigns::TrackingEquations.motors(1, 0), (1, -1)); // right: A forwards, B backwards
/// assert_eq!(BeltSigns::DirectionTable.twice_axes(1, 0), (1, -1)); // motor 1 alone: half a step right, half a step down
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum BeltSigns {
    /// x = (M1 + M2)/2, y = (M2 − M1)/2: as the report's table of directions says.
    #[default]
    DirectionTable,
    /// x = (A − B)/2, y = (A + B)/2: as its equations for the position say.
    TrackingEquations,
}

impl BeltSigns {
    /// What both motors do for a move by (`x`, `y`). The sums must be within the range of the numbers: counts
    /// of 32 bits are taken as `i64`.
    pub fn motors<T: Copy + Add<Output = T> + Sub<Output = T>>(self, x: T, y: T) -> (T, T) {
        match self {
            Self::DirectionTable => (x - y, x + y),
            Self::TrackingEquations => (x + y, y - x),
        }
    }

    /// *Twice* the move that both motors make, so that it is exact in whole counts too.
    pub fn twice_axes<T: Copy + Add<Output = T> + Sub<Output = T>>(self, first: T, second: T) -> (T, T) {
        match self {
            Self::DirectionTable => (first + second, second - first),
            Self::TrackingEquations => (first - second, first + second),
        }
    }
}

/// A belt machine: both motors with the same pulley.
///
/// ```
/// # use plotter_motion::kinematics::{BeltSigns, CoreXy, Kinematics};
/// # use plotter_motion::{Point, StepPoint};
/// let board = CoreXy::new(BeltSigns::DirectionTable, 46.3)?; // pulses to the millimetre of the marking board
/// assert_eq!(board.steps_at(Point::new(10.0, 0.0)), StepPoint::new(463, 463));
/// assert_eq!(board.steps_at(Point::new(0.0, 10.0)), StepPoint::new(-463, 463));
/// # Ok::<(), plotter_motion::kinematics::ScaleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(try_from = "Unchecked"))]
pub struct CoreXy {
    signs: BeltSigns,
    steps_per_mm: f64,
}

/// What a file says of one.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Unchecked {
    signs: BeltSigns,
    steps_per_mm: f64,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for CoreXy {
    type Error = ScaleError;

    fn try_from(said: Unchecked) -> Result<Self, ScaleError> {
        Self::new(said.signs, said.steps_per_mm)
    }
}

impl CoreXy {
    /// A machine whose motors make `steps_per_mm` steps (or encoder counts) when the pen moves a millimetre
    /// along an axis.
    ///
    /// # Errors
    ///
    /// [`ScaleError`] for steps per millimetre outside 1e-9 to 1e9; NaN lies outside. It names axis x, though
    /// both have the same scale.
    pub fn new(signs: BeltSigns, steps_per_mm: f64) -> Result<Self, ScaleError> {
        if (LEAST_STEPS_PER_MM..=MOST_STEPS_PER_MM).contains(&steps_per_mm) {
            Ok(Self { signs, steps_per_mm })
        } else {
            Err(ScaleError { axis: Axis::X, steps_per_mm })
        }
    }

    /// The belt of a checked machine, with the scale of its first motor.
    ///
    /// ```
    /// # use plotter_motion::kinematics::{CoreXy, Kinematics};
    /// # use plotter_motion::{Machine, MachineConfig, Point, StepPoint};
    /// let board = CoreXy::of(&Machine::new(MachineConfig::marking_board())?); // 46.3 pulses/mm
    /// assert_eq!(board.steps_at(Point::new(10.0, 10.0)), StepPoint::new(0, 926));
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let belt = OneBeltConfig::of(machine);
        Self { signs: belt.signs, steps_per_mm: belt.dc.x.counts_per_mm }
    }

    /// Directions of the motors.
    #[must_use]
    pub const fn signs(&self) -> BeltSigns {
        self.signs
    }

    /// Steps of either motor to a millimetre along an axis.
    #[must_use]
    pub const fn steps_per_mm(&self) -> f64 {
        self.steps_per_mm
    }
}

impl Kinematics for CoreXy {
    fn motors_at(&self, point: Point) -> MotorPoint {
        let (x, y) = self.signs.motors(point.x, point.y);
        MotorPoint { x: x * self.steps_per_mm, y: y * self.steps_per_mm }
    }

    fn point_at(&self, motors: MotorPoint) -> Point {
        let (x, y) = self.signs.twice_axes(motors.x, motors.y);
        Point::new(x / 2.0 / self.steps_per_mm, y / 2.0 / self.steps_per_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A row of the report's table 1.
    struct Row {
        name: &'static str,
        axes: (i32, i32),
        motors: (i32, i32),
    }

    const fn row(name: &'static str, axes: (i32, i32), motors: (i32, i32)) -> Row {
        Row { name, axes, motors }
    }

    const TABLE: [Row; 8] = [
        row("left", (-1, 0), (-1, -1)),
        row("right", (1, 0), (1, 1)),
        row("up", (0, 1), (-1, 1)),
        row("down", (0, -1), (1, -1)),
        row("left and up", (-1, 1), (-1, 0)),
        row("left and down", (-1, -1), (0, -1)),
        row("right and up", (1, 1), (0, 1)),
        row("right and down", (1, -1), (1, 0)),
    ];

    #[test]
    fn the_direction_table_holds_row_by_row() {
        for Row { name, axes: (x, y), motors } in TABLE {
            let (first, second) = BeltSigns::DirectionTable.motors(x, y);
            assert_eq!((first.signum(), second.signum()), motors, "{name}");
            // and back: motors driven so move the pen so
            let (x2, y2) = BeltSigns::DirectionTable.twice_axes(motors.0, motors.1);
            assert_eq!((x2.signum(), y2.signum()), (x, y), "{name}");
        }
    }

    #[test]
    fn the_tracking_equations_hold() {
        for (a, b) in [(0, 0), (7, 3), (-40, 40), (463, -463), (5, -8)] {
            // X = (A - B)/2, Y = (A + B)/2, both sides doubled
            assert_eq!(BeltSigns::TrackingEquations.twice_axes(a, b), (a - b, a + b));
        }
        let board = CoreXy::new(BeltSigns::TrackingEquations, 1.0).unwrap();
        assert_eq!(board.point_at(MotorPoint { x: 7.0, y: 3.0 }), Point::new(2.0, 5.0));
    }

    #[test]
    fn both_agree_when_a_is_motor_2_and_b_is_motor_1_backwards() {
        for (x, y) in [(1, 0), (0, 1), (3, -8), (-5, -5)] {
            let (m1, m2) = BeltSigns::DirectionTable.motors(x, y);
            assert_eq!(BeltSigns::TrackingEquations.motors(x, y), (m2, -m1));
        }
    }

    #[test]
    fn a_scale_that_no_belt_has_is_refused() {
        for steps_per_mm in [0.0, -46.3, f64::NAN, f64::INFINITY] {
            assert!(CoreXy::new(BeltSigns::default(), steps_per_mm).is_err());
        }
    }
}
