//! Pins by their port and number. The board's library has a type for each pin, or one for all that says its
//! port with every access; this takes less program memory than either.

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use stm32f4xx_hal::pac::{GPIOA, GPIOB};

macro_rules! port {
    ($(#[$of:meta])* $name:ident $gpio:ident) => {
        $(#[$of])*
        #[derive(Debug)]
        pub struct $name(u16);

        impl $name {
            /// The pin with this number, which has been set up.
            pub const fn new(number: u8) -> Self {
                Self(1 << number)
            }
        }

        impl ErrorType for $name {
            type Error = Infallible;
        }

        impl OutputPin for $name {
            #[allow(unsafe_code, reason = "a write to this register touches no other pin")]
            fn set_low(&mut self) -> Result<(), Infallible> {
                // SAFETY: the register has no state that is shared.
                unsafe { $gpio::steal().bsrr().write(|w| w.bits(u32::from(self.0) << 16)) };
                Ok(())
            }

            #[allow(unsafe_code, reason = "a write to this register touches no other pin")]
            fn set_high(&mut self) -> Result<(), Infallible> {
                // SAFETY: as above.
                unsafe { $gpio::steal().bsrr().write(|w| w.bits(self.0.into())) };
                Ok(())
            }
        }

        impl InputPin for $name {
            #[allow(unsafe_code, reason = "reading this register changes nothing")]
            fn is_high(&mut self) -> Result<bool, Infallible> {
                // SAFETY: as it says.
                Ok(unsafe { $gpio::steal() }.idr().read().bits() & u32::from(self.0) != 0)
            }

            fn is_low(&mut self) -> Result<bool, Infallible> {
                self.is_high().map(|is_high| !is_high)
            }
        }
    };
}

port! {
    /// A pin of port A.
    PinA GPIOA
}
port! {
    /// A pin of port B.
    PinB GPIOB
}
