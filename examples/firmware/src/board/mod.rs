//! Everything of a firmware that depends on its board: see "Another board" in the README.

#[cfg(feature = "board-qemu")]
mod qemu;
#[cfg(feature = "board-qemu")]
pub use qemu::*;

#[cfg(feature = "board-stm32f411")]
mod stm32f411;
#[cfg(feature = "board-stm32f411")]
pub use stm32f411::*;

use core::fmt;
use core::time::Duration;
use embedded_hal::digital::{ErrorType, OutputPin};
use plotter_motion::firmware;
use plotter_motion::{Axis, Direction};

/// What a board's `wait` comes back with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// It is due.
    Due,
    /// A byte came over the serial line.
    Byte(u8),
    /// A byte came over the serial line and was lost, or damaged.
    LineFault,
    /// An encoder counted.
    Edge(Axis, Direction),
    /// An encoder's pin could not be read.
    EncoderFault,
}

/// The pins of a motor's H-bridge.
#[derive(Debug)]
pub struct MotorPins<Enable, Forward, Reverse> {
    /// PWM on the bridge's enable input.
    pub enable: Enable,
    /// High to turn to larger coordinates.
    pub forward: Forward,
    /// High to turn to smaller ones.
    pub reverse: Reverse,
}

/// The pins of a stepper motor's driver.
#[derive(Debug)]
pub struct StepperPins<Step, Dir> {
    /// A rising edge is a step.
    pub step: Step,
    /// High to turn to larger coordinates.
    pub dir: Dir,
}

/// A pin that the drivers of both motors are wired to, and one of them has: so both are of one type, and what
/// drives them is there once.
#[derive(Debug)]
pub struct Wire<Pin>(pub Option<Pin>);

impl<Pin: ErrorType> ErrorType for Wire<Pin> {
    type Error = Pin::Error;
}

impl<Pin: OutputPin> OutputPin for Wire<Pin> {
    fn set_low(&mut self) -> Result<(), Pin::Error> {
        self.0.as_mut().map_or(Ok(()), OutputPin::set_low)
    }

    fn set_high(&mut self) -> Result<(), Pin::Error> {
        self.0.as_mut().map_or(Ok(()), OutputPin::set_high)
    }
}

/// What a person at the machine should know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// From the controller.
    Controller(firmware::Notice),
    /// A byte of the host was lost.
    LineFault,
    /// The watchdog reset the processor: where the motors stand is not known any more, and they are stopped.
    Bitten,
    /// The emergency stop button was pressed.
    Stopped,
    /// A pin failed; the motors are stopped.
    PinFailed,
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controller(notice) => write!(f, "controller: {notice}"),
            Self::LineFault => f.write_str("firmware: a byte of the host was lost"),
            Self::Bitten => f.write_str("firmware: reset by its watchdog; the motors are stopped"),
            Self::Stopped => {
                f.write_str("firmware: emergency stop; switch off and on when the machine is free")
            }
            Self::PinFailed => f.write_str("firmware: a pin failed; the motors are stopped"),
        }
    }
}

/// Whether that time has come: a comparison that is there once.
#[inline(never)]
#[must_use]
pub fn has_come(at: Duration, now: Duration) -> bool {
    at <= now
}

/// Stands still for good, with the pins as they are: only after the motors have been stopped.
pub fn halt() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
