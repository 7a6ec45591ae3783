//! [`Error`]: what a stepper driver refuses, and what became of a motor whose pin failed.

use core::fmt;
use core::time::Duration;
use embedded_hal::digital::{self, ErrorType};

crate::which_pin::which_pin! {
    /// A pin of a stepper motor's driver failed.
    PinError: digital, Step "STEP: {}", Dir "DIR: {}", Enable "ENABLE: {}", Sleep "SLEEP: {}"
}

/// Error of a motor on these pins.
pub type PinErrorOf<Step, Dir, Enable, Sleep> = PinError<
    <Step as ErrorType>::Error,
    <Dir as ErrorType>::Error,
    <Enable as ErrorType>::Error,
    <Sleep as ErrorType>::Error,
>;

/// The error of a motor on these pins.
pub type ErrorOf<Step, Dir, Enable, Sleep> = Error<PinErrorOf<Step, Dir, Enable, Sleep>>;

/// A step could not be taken, or a pin of a stepper motor failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin> {
    /// The motor is off: start it first.
    Off,
    /// The chip is not ready; the step has not been taken.
    Busy {
        /// When to call [`tick`](super::A4988::tick), and to offer the step again.
        until: Duration,
    },
    /// The chip does not have this many microsteps to a full step.
    Microsteps(u16),
    /// A pin failed; the outputs are off, the motor has no current. Its place is lost.
    Pin(Pin),
    /// A pin failed and the outputs could not be switched off, or have no pin for that: the motor gets no
    /// more steps and may hold.
    StillOn(Pin),
}

impl<Pin: fmt::Display> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => write!(f, "stepper motor: is off; start it first"),
            Self::Busy { until } => {
                write!(f, "stepper motor: not ready before {} ns", until.as_nanos())
            }
            Self::Microsteps(asked) => write!(f, "stepper motor: the chip has no {asked} microsteps"),
            Self::Pin(cause) => {
                write!(f, "pin of the stepper motor: {cause}; it has no current")
            }
            Self::StillOn(cause) => {
                write!(f, "pin of the stepper motor: {cause}; it gets no steps, but may have current")
            }
        }
    }
}

impl<Pin: fmt::Debug + fmt::Display> core::error::Error for Error<Pin> {}

crate::which_pin::formats_as_shown!(<Pin: fmt::Display> Error<Pin>);
