//! [`NoPin`]: in the place of a pin that a driver can do without.

use core::convert::Infallible;
use core::marker::PhantomData;
use embedded_hal::digital::{self, ErrorType, OutputPin};

/// An output that leads nowhere: the board has wired that input of the chip to a fixed level.
///
/// `E` is the error type of the driver's other pins; this one never fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NoPin<E = Infallible>(PhantomData<E>);

impl<E> NoPin<E> {
    /// No pin.
    #[must_use]
    pub const fn new() -> Self {
        Self(PhantomData)
    }
}

impl<E> Default for NoPin<E> {
    fn default() -> Self {
        Self::new()
    }
}

impl<E: digital::Error> ErrorType for NoPin<E> {
    type Error = E;
}

impl<E: digital::Error> OutputPin for NoPin<E> {
    fn set_low(&mut self) -> Result<(), E> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), E> {
        Ok(())
    }
}
