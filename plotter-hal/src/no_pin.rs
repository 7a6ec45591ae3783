//! [`NoPin`]: in the place of a pin that a driver can do without.

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, OutputPin};

/// An output that leads nowhere: the board has wired that input of the chip to a fixed level. It never fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct NoPin;

impl ErrorType for NoPin {
    type Error = Infallible;
}

impl OutputPin for NoPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
