//! Simulated pins: the firmware's drivers hold one end, the simulated machine the other.

use core::cell::Cell;
use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};

/// A wire: high or low.
pub type Wire = Cell<bool>;

/// An output pin.
#[derive(Clone, Copy, Debug)]
pub struct Output(pub &'static Wire);

/// An output pin on a motor driver's STEP: the motor goes on at its rising edges, to where DIR says then.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The level.
    pub level: &'static Wire,
    /// DIR.
    pub dir: &'static Wire,
    /// Where the motor stands.
    pub position: &'static Cell<i32>,
}

impl ErrorType for Step {
    type Error = Infallible;
}

impl OutputPin for Step {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.level.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        if !self.level.replace(true) {
            let by = if self.dir.get() { 1 } else { -1 };
            self.position.set(self.position.get().wrapping_add(by));
        }
        Ok(())
    }
}

/// An input pin.
#[derive(Clone, Copy, Debug)]
pub struct Input(pub &'static Wire);

/// An output of a PWM timer.
#[derive(Clone, Copy, Debug)]
pub struct Pwm {
    /// Steps that the output is high, of `full`.
    pub steps: &'static Cell<u16>,
    /// Steps of a period.
    pub full: u16,
}

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(true);
        Ok(())
    }
}

impl ErrorType for Input {
    type Error = Infallible;
}

impl InputPin for Input {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.get())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.get())
    }
}

impl pwm::ErrorType for Pwm {
    type Error = Infallible;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        self.full
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.steps.set(duty.min(self.full));
        Ok(())
    }
}
