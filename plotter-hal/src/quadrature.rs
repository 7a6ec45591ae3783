//! A two-phase encoder on two input pins, from interrupts or polled.
//!
//! | decoding | interrupts | polls in a period of a phase, at least |
//! |---|---|---|
//! | x1, as published | both edges of A | 4: no half of A may pass unseen |
//! | x2 | both edges of A | 4 |
//! | x4 | every edge of both | 4 |
//!
//! In an interrupt call [`Quadrature::poll`], which reads both pins; or [`Quadrature::update`], where the
//! program has both levels at hand, from a port register, say. (A decoder of rising edges has to see the
//! falling ones too, or it takes two rising edges for one.) A shaft at 100 turns/s with 500 lines has 50 000
//! periods a second: 100 000 interrupts with x2, 200 000 with x4. Beyond what the chip can do, a timer in
//! encoder mode counts by itself.
//!
//! # What can go wrong
//!
//! | | x1 | x2, x4 |
//! |---|---|---|
//! | an edge bounces, or the shaft trembles about it | may count each time, and drift | counts forth and back |
//! | both phases have changed at once: an edge was missed | [`illegal`](Quadrature::illegal) | [`illegal`](Quadrature::illegal) |
//! | a phase is lost: a broken wire | counts on in one direction, or not at all | counts forth and back, so stands |
//!
//! A lost phase cannot be told from a shaft that trembles about one edge, but that does not happen to one
//! that is driven over more than a period: see [`lost_phase`](Quadrature::lost_phase).

#[cfg(feature = "async")]
use crate::waiting::{First, first};
use core::fmt;
use embedded_hal::digital::{self, InputPin};
#[cfg(feature = "async")]
use embedded_hal_async::digital::Wait;
use plotter_motion::{
    Direction,
    config::Decoding,
    encoder::{Phases, QuadratureX1, QuadratureX2, QuadratureX4},
};

/// Two input pins and the decoder behind them.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Read};
/// use plotter_hal::Quadrature;
/// use plotter_motion::{Direction, config::Decoding, encoder::Phases};
///
/// let a = Pin::new(&[Read::get(Low), Read::get(High), Read::get(High)]);
/// let b = Pin::new(&[Read::get(High), Read::get(High), Read::get(Low)]);
/// let mut encoder = Quadrature::new(a, b, Decoding::X1);
/// assert_eq!(encoder.poll()?, None); // where the shaft stands
/// assert_eq!(encoder.poll()?, Some(Direction::Plus)); // A rose while B was high
/// assert_eq!(encoder.poll()?, None);
/// assert_eq!(encoder.update(Phases { a: false, b: false }), None); // the same, with levels read elsewhere
/// assert_eq!(encoder.position(), 1);
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
    /// The decoder and the levels it has seen last; `None` until the shaft has been seen once.
    decoder: Option<(Decoder, Phases)>,
    position: i32,
    illegal: u32,
    /// The phase that has changed alone, and how often in a row.
    alone: Option<(Phase, u32)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Decoder {
    X1(QuadratureX1),
    X2(QuadratureX2),
    X4(QuadratureX4),
}

impl Decoder {
    const fn new(decoding: Decoding, phases: Phases) -> Self {
        match decoding {
            Decoding::X2 => Self::X2(QuadratureX2::new(phases)),
            Decoding::X4 => Self::X4(QuadratureX4::new(phases)),
            // Published, and the default.
            _ => Self::X1(QuadratureX1::new(phases)),
        }
    }

    const fn update(&mut self, phases: Phases) -> Option<Direction> {
        match self {
            Self::X1(decoder) => decoder.update(phases),
            Self::X2(decoder) => decoder.update(phases),
            Self::X4(decoder) => decoder.update(phases),
        }
    }
}

/// One of the two phases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Phase {
    /// Phase A.
    A,
    /// Phase B.
    B,
}

/// What can fail at an encoder on these pins.
type ErrorOf<A, B> = Error<PinError<<A as digital::ErrorType>::Error, <B as digital::ErrorType>::Error>>;

impl<A, B> Quadrature<A, B>
where
    A: InputPin,
    B: InputPin,
{
    /// The encoder on pins `a` and `b`. The pins are first read by [`poll`](Self::poll).
    pub const fn new(a: A, b: B, decoding: Decoding) -> Self {
        Self { a, b, decoding, decoder: None, position: 0, illegal: 0, alone: None }
    }

    /// Reads both pins; says whether the shaft went on by a count. The first call notes where it stands.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the encoder is then as if this call had not been made.
    pub fn poll(&mut self) -> Result<Option<Direction>, ErrorOf<A, B>> {
        let a = self.a.is_high().map_err(|cause| Error::Pin(PinError::A(cause)))?;
        let b = self.b.is_high().map_err(|cause| Error::Pin(PinError::B(cause)))?;
        Ok(self.update(Phases { a, b }))
    }

    /// Takes the levels of both pins as read elsewhere; says whether the shaft went on by a count.
    pub fn update(&mut self, phases: Phases) -> Option<Direction> {
        let Some((decoder, before)) = &mut self.decoder else {
            self.decoder = Some((Decoder::new(self.decoding, phases), phases));
            return None;
        };
        let before = core::mem::replace(before, phases);
        let counted = decoder.update(phases);
        self.note(before.a != phases.a, before.b != phases.b);
        if let Some(direction) = counted {
            self.position = self.position.wrapping_add(direction.sign());
        }
        counted
    }

    /// Where the shaft is, counts from where it was first seen. Wraps at the ends of `i32`: at 40 counts/mm
    /// after 53 km.
    pub const fn position(&self) -> i32 {
        self.position
    }

    /// How many times both phases had changed at once, which no shaft does: edges were missed, and the
    /// position is wrong by half a period or more. Poll more often, or look for noise on the wires. Only
    /// where both phases' edges are looked at; with interrupts at the edges of A alone B changes between two
    /// of them as it should.
    pub const fn illegal(&self) -> u32 {
        self.illegal
    }

    /// The phase that has not changed while the other one did so `edges` times in a row or more.
    ///
    /// While a motor is driven over more than a period, 8 edges are enough to say that a phase is lost: stop
    /// it, for its position is not known any more. A shaft at rest may tremble about an edge for ever, so ask
    /// only while there is drive. What looks like a shaft that stands, with both phases lost, is for the
    /// controller to notice.
    pub fn lost_phase(&self, edges: u32) -> Option<Phase> {
        match self.alone {
            Some((Phase::A, count)) if count >= edges => Some(Phase::B),
            Some((Phase::B, count)) if count >= edges => Some(Phase::A),
            _ => None,
        }
    }

    /// Gives the pins back.
    pub fn release(self) -> (A, B) {
        (self.a, self.b)
    }

    /// Keeps count of what no shaft does.
    const fn note(&mut self, a_changed: bool, b_changed: bool) {
        let phase = match (a_changed, b_changed) {
            (false, false) => return,
            (true, true) => {
                self.illegal = self.illegal.saturating_add(1);
                self.alone = None;
                return;
            }
            (true, false) => Phase::A,
            (false, true) => Phase::B,
        };
        let in_a_row = match (self.alone, phase) {
            (Some((Phase::A, count)), Phase::A) | (Some((Phase::B, count)), Phase::B) => count,
            _ => 0,
        };
        self.alone = Some((phase, in_a_row.saturating_add(1)));
    }
}

#[cfg(feature = "async")]
impl<A: InputPin + Wait, B: InputPin + Wait> Quadrature<A, B> {
    /// Waits until the shaft has gone on by a count. For shafts turned by hand: each edge is a turn of the
    /// executor. Where edges come faster, let a timer count them: [`TimerCount`](crate::TimerCount).
    ///
    /// Can be dropped at any time.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the position is as before.
    pub async fn counted(&mut self) -> Result<Direction, ErrorOf<A, B>> {
        loop {
            if let Some(direction) = self.poll()? {
                return Ok(direction);
            }
            let Some((_, Phases { a, b })) = self.decoder else { continue };
            let a = async { if a { self.a.wait_for_low().await } else { self.a.wait_for_high().await } };
            let b = async { if b { self.b.wait_for_low().await } else { self.b.wait_for_high().await } };
            match first(a, b).await {
                First::A(waited) => waited.map_err(PinError::A),
                First::B(waited) => waited.map_err(PinError::B),
            }
            .map_err(Error::Pin)?;
        }
    }
}

crate::which_pin::which_pin! {
    /// Which pin of an encoder could not be read.
    PinError: digital, A "phase A: {}", B "phase B: {}"
}

/// A pin of an encoder could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin> {
    /// The pin's own error.
    Pin(Pin),
}

impl<Pin: fmt::Display> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Pin(cause) = self;
        write!(f, "pin of the encoder: {cause}")
    }
}

impl<Pin: fmt::Debug + fmt::Display> core::error::Error for Error<Pin> {}

crate::which_pin::formats_as_shown!(<Pin: fmt::Display> Error<Pin>);
