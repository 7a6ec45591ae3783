//! Errors that say which of a driver's pins failed: each pin has an error type of its own, because one may be
//! the chip's and another on a port expander.

/// Makes the error of a driver's pins: a variant a pin, with that pin's own error. It is an error of
/// `embedded-hal` itself, and shown by the name of the pin and the kind of its error, so nothing is asked of
/// a chip's own error that `embedded-hal` does not ask.
macro_rules! which_pin {
    ($(#[$doc:meta])* $name:ident: $hal:ident, $($pin:ident $text:literal),+ $(,)?) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum $name<$($pin),+> {
            $(
                #[doc = concat!("That of `", stringify!($pin), "`.")]
                $pin($pin)
            ),+
        }

        impl<$($pin: $hal::Error),+> $hal::Error for $name<$($pin),+> {
            fn kind(&self) -> $hal::ErrorKind {
                match self { $(Self::$pin(cause) => cause.kind()),+ }
            }
        }

        impl<$($pin: $hal::Error),+> core::fmt::Display for $name<$($pin),+> {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match self { $(Self::$pin(cause) => write!(f, $text, cause.kind())),+ }
            }
        }

        impl<$($pin: $hal::Error),+> core::error::Error for $name<$($pin),+> {}

        crate::which_pin::formats_as_shown!(<$($pin: $hal::Error),+> $name<$($pin),+>);
    };
}

/// `defmt` writes an error as people read it, by the kind of its cause: a derived form would ask a chip's own
/// error to be one that `defmt` knows.
macro_rules! formats_as_shown {
    (<$($bound:tt)*) => {
        crate::which_pin::formats_as_shown!(@ [] $($bound)*);
    };
    (@ [$($bound:tt)*] > $($name:tt)+) => {
        #[cfg(feature = "defmt")]
        impl<$($bound)*> defmt::Format for $($name)+ {
            fn format(&self, f: defmt::Formatter<'_>) {
                defmt::write!(f, "{}", defmt::Display2Format(self));
            }
        }
    };
    (@ [$($bound:tt)*] $next:tt $($rest:tt)*) => {
        crate::which_pin::formats_as_shown!(@ [$($bound)* $next] $($rest)*);
    };
}

pub(crate) use formats_as_shown;
pub(crate) use which_pin;
