//! [`Error`]: what a stepper driver refuses, and what became of a motor whose pin failed.

use core::fmt;
use core::time::Duration;
use embedded_hal::digital;

/// A step could not be taken, or a pin of a stepper motor failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

impl<Pin: digital::Error> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Off => write!(f, "stepper motor: is off; start it first"),
            Self::Busy { until } => {
                write!(f, "stepper motor: not ready before {} ns", until.as_nanos())
            }
            Self::Microsteps(asked) => write!(f, "stepper motor: the chip has no {asked} microsteps"),
            Self::Pin(cause) => {
                write!(f, "pin of the stepper motor: {}; it has no current", cause.kind())
            }
            Self::StillOn(cause) => {
                write!(
                    f,
                    "pin of the stepper motor: {}; it gets no steps, but may have current",
                    cause.kind()
                )
            }
        }
    }
}

impl<Pin: digital::Error> core::error::Error for Error<Pin> {}
