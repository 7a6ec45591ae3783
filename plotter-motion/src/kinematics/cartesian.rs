//! [`Cartesian`]: each motor moves one axis.

use super::{Kinematics, MotorPoint};
use crate::config::SteppersConfig;
use crate::{Axis, Machine, Point, config::StepperConfig};
use core::fmt;

/// How one motor moves its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorScale {
    /// Steps of the motor, as its driver counts them (microsteps), to the millimetre: 1e-9 to 1e9.
    pub steps_per_mm: f64,
    /// Whether forward steps move the pen towards smaller coordinates.
    pub inverted: bool,
}

impl Default for MotorScale {
    /// 87.58 steps/mm, forwards: the Makeblock XY plotter with its drivers as delivered.
    fn default() -> Self {
        Self { steps_per_mm: 87.58, inverted: false }
    }
}

impl MotorScale {
    /// Steps to the millimetre with the sign of the direction.
    const fn check(self, axis: Axis) -> Result<f64, ScaleError> {
        let Self { steps_per_mm, inverted } = self;
        if steps_per_mm >= LEAST_STEPS_PER_MM && steps_per_mm <= MOST_STEPS_PER_MM {
            Ok(if inverted { -steps_per_mm } else { steps_per_mm })
        } else {
            Err(ScaleError { axis, steps_per_mm })
        }
    }
}

/// Steps per millimetre that no motor has.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScaleError {
    /// The axis.
    pub axis: Axis,
    /// Steps per millimetre.
    pub steps_per_mm: f64,
}

/// Beyond any machine; a product with a coordinate of 32 bits is far from overflow.
pub(super) const LEAST_STEPS_PER_MM: f64 = 1e-9;
pub(super) const MOST_STEPS_PER_MM: f64 = 1e9;

impl fmt::Display for ScaleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = match self.axis {
            Axis::X => "x",
            Axis::Y => "y",
        };
        let Self { steps_per_mm, .. } = self;
        write!(
            f,
            "axis {axis}: {steps_per_mm} steps/mm lies outside {LEAST_STEPS_PER_MM:e}..={MOST_STEPS_PER_MM:e} steps/mm; \
             for a motor that turns the wrong way invert the axis, not the sign"
        )
    }
}

impl core::error::Error for ScaleError {}

/// The first motor moves x and the second y.
///
/// ```
/// # use plotter_motion::kinematics::{Cartesian, Kinematics, MotorScale};
/// # use plotter_motion::{Point, StepPoint};
/// let x = MotorScale { steps_per_mm: 80.0, inverted: false };
/// let y = MotorScale { steps_per_mm: 100.0, inverted: true };
/// let machine = Cartesian::new(x, y)?;
/// assert_eq!(machine.steps_at(Point::new(10.0, 2.5)), StepPoint::new(800, -250));
/// assert_eq!(machine.point_at(StepPoint::new(800, -250).into()), Point::new(10.0, 2.5));
/// # Ok::<(), plotter_motion::kinematics::ScaleError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cartesian {
    /// Steps to the millimetre with the sign of the direction; neither is 0.
    x: f64,
    y: f64,
}

impl Cartesian {
    /// A machine with the given motors.
    ///
    /// # Errors
    ///
    /// [`ScaleError`] for steps per millimetre outside 1e-9 to 1e9; NaN lies outside.
    pub const fn new(x: MotorScale, y: MotorScale) -> Result<Self, ScaleError> {
        match (x.check(Axis::X), y.check(Axis::Y)) {
            (Ok(x), Ok(y)) => Ok(Self { x, y }),
            (Err(error), _) | (_, Err(error)) => Err(error),
        }
    }

    /// The same, of motors that have been checked and go forwards.
    pub(crate) const fn of_checked(x_steps_per_mm: f64, y_steps_per_mm: f64) -> Self {
        Self { x: x_steps_per_mm, y: y_steps_per_mm }
    }

    /// The stepper motors of a checked machine.
    ///
    /// ```
    /// # use plotter_motion::kinematics::{Cartesian, Kinematics};
    /// # use plotter_motion::{Machine, MachineConfig, Point, StepPoint};
    /// let machine = Machine::new(MachineConfig::stepper_plotter())?; // 87.58 steps/mm
    /// assert_eq!(Cartesian::of(&machine).steps_at(Point::new(100.0, 0.5)), StepPoint::new(8758, 44));
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let signed = |stepper: &StepperConfig| {
            if stepper.inverted { -stepper.steps_per_mm } else { stepper.steps_per_mm }
        };
        let SteppersConfig { x, y, .. } = SteppersConfig::of(machine);
        Self { x: signed(&x), y: signed(&y) }
    }
}

impl Kinematics for Cartesian {
    fn motors_at(&self, point: Point) -> MotorPoint {
        MotorPoint { x: point.x * self.x, y: point.y * self.y }
    }

    fn point_at(&self, motors: MotorPoint) -> Point {
        Point::new(motors.x / self.x, motors.y / self.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn a_scale_that_no_motor_has_is_named_with_its_axis() {
        let good = MotorScale::default();
        for steps_per_mm in [0.0, -80.0, f64::NAN, f64::INFINITY] {
            let bad = MotorScale { steps_per_mm, inverted: false };
            assert_eq!(Cartesian::new(bad, good).map_err(|error| error.axis), Err(Axis::X));
        }
        assert_eq!(
            Cartesian::new(good, MotorScale { steps_per_mm: -80.0, inverted: false })
                .unwrap_err()
                .to_string(),
            "axis y: -80 steps/mm lies outside 1e-9..=1e9 steps/mm; for a motor that turns the wrong way invert the \
             axis, not the sign"
        );
    }
}
