//! The two motors of a machine as one: what a safety gate let through, on the pins of both.
//!
//! ```text
//!  SafetyGate ──Drive──▶ DcAxes ──────▶ bridge of x, bridge of y
//!             ──Pulse──▶ StepperAxes ─▶ STEP and DIR of x, STEP and DIR of y
//! ```
//!
//! A fault of one motor stops both: with one alone the pen would leave its line. Both are tried whatever
//! fails, and [`Error`] says what became of either.
//!
//! A step may be held back for its setup time. The gate has let it through, and may have been stopped since:
//! so whoever stops the gate calls `stop` here as well. A drive is never held back: for its dead time none is
//! given, and then it is asked for anew.

mod dc_axes;
mod stepper_axes;

pub use dc_axes::DcAxes;
pub use stepper_axes::StepperAxes;

use core::fmt;

/// What failed at either motor, at one of them at least. Both have been stopped as far as this says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Error<X, Y = X> {
    /// At the first motor.
    pub x: Option<X>,
    /// At the second motor.
    pub y: Option<Y>,
}

impl<X, Y> Error<X, Y> {
    /// Both have been tried.
    fn check(x: Result<(), X>, y: Result<(), Y>) -> Result<(), Self> {
        if x.is_ok() && y.is_ok() { Ok(()) } else { Err(Self { x: x.err(), y: y.err() }) }
    }
}

impl<X: fmt::Display, Y: fmt::Display> fmt::Display for Error<X, Y> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.x, &self.y) {
            (Some(x), Some(y)) => write!(f, "axis x: {x}; axis y: {y}"),
            (Some(x), None) => write!(f, "axis x: {x}"),
            (None, Some(y)) => write!(f, "axis y: {y}"),
            (None, None) => write!(f, "no axis"),
        }
    }
}

impl<X, Y> core::error::Error for Error<X, Y>
where
    X: fmt::Debug + fmt::Display,
    Y: fmt::Debug + fmt::Display,
{
}

crate::which_pin::formats_as_shown!(<X: fmt::Display, Y: fmt::Display> Error<X, Y>);
