//! A two-phase encoder on two input pins, polled.
//!
//! Poll it more often than its edges come: with x1 decoding four times in a period of a phase, so that no high
//! half of A passes unseen; with x4 once in a quarter of it. A shaft at 100 turns/s with 500 lines has 50 000
//! periods a second and wants an interrupt or a timer in encoder mode; the decoders of [`plotter_motion`] take
//! its levels just as well.

use core::fmt;
use embedded_hal::digital::{self, InputPin};
use plotter_motion::{Decoding, Direction, Phases, QuadratureX1, QuadratureX4};

/// Two input pins and the decoder behind them.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Read};
/// use plotter_hal::Quadrature;
/// use plotter_motion::{Decoding, Direction};
///
/// let a = Pin::new(&[Read::get(Low), Read::get(High), Read::get(High)]);
/// let b = Pin::new(&[Read::get(High), Read::get(High), Read::get(Low)]);
/// let mut encoder = Quadrature::new(a, b, Decoding::X1);
/// assert_eq!(encoder.poll()?, None); // where the shaft stands
/// assert_eq!(encoder.poll()?, Some(Direction::Plus)); // A rose while B was high
/// assert_eq!(encoder.poll()?, None);
/// # let (mut a, mut b) = encoder.release();
/// # a.done();
/// # b.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quadrature<A, B> {
    a: A,
    b: B,
    decoding: Decoding,
    /// `None` until the shaft has been seen once.
    decoder: Option<Decoder>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Decoder {
    X1(QuadratureX1),
    X4(QuadratureX4),
}

impl<A, B> Quadrature<A, B>
where
    A: InputPin,
    B: InputPin<Error = A::Error>,
{
    /// The encoder on pins `a` and `b`. The pins are first read by [`poll`](Self::poll).
    pub const fn new(a: A, b: B, decoding: Decoding) -> Self {
        Self { a, b, decoding, decoder: None }
    }

    /// Reads both pins; says whether the shaft went on by a count. The first call notes where it stands.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the encoder is then as if this call had not been made.
    pub fn poll(&mut self) -> Result<Option<Direction>, Error<A::Error>> {
        let phases =
            Phases { a: self.a.is_high().map_err(Error::Pin)?, b: self.b.is_high().map_err(Error::Pin)? };
        Ok(match &mut self.decoder {
            Some(Decoder::X1(decoder)) => decoder.update(phases),
            Some(Decoder::X4(decoder)) => decoder.update(phases),
            None => {
                self.decoder = Some(match self.decoding {
                    Decoding::X4 => Decoder::X4(QuadratureX4::new(phases)),
                    _ => Decoder::X1(QuadratureX1::new(phases)),
                });
                None
            }
        })
    }

    /// How many times both phases changed between two polls, so that counts were missed: poll more often. x1
    /// decoding cannot tell and says 0.
    pub const fn missed(&self) -> u32 {
        match &self.decoder {
            Some(Decoder::X4(decoder)) => decoder.illegal(),
            Some(Decoder::X1(_)) | None => 0,
        }
    }

    /// Gives the pins back.
    pub fn release(self) -> (A, B) {
        (self.a, self.b)
    }
}

/// A pin of an encoder could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin> {
    /// The pin's own error.
    Pin(Pin),
}

impl<Pin: digital::Error> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Pin(cause) = self;
        write!(f, "pin of the encoder: {}", cause.kind())
    }
}

impl<Pin: digital::Error> core::error::Error for Error<Pin> {}
