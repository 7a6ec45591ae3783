//! An encoder with one phase on an input pin, or on a hardware counter.
//!
//! It counts up, and the sign of the voltage that the motor gets, or got last, says which way that is: the
//! logic, and what it cannot see, are [`PulseCounter`]'s. Use [`PulseInput`] where the program sees the edges
//! itself, from an interrupt or polled at least twice in a half of a period; and [`CounterDelta`] where a
//! timer counts them. [`TimerCount`] is for a timer that counts both phases of an encoder, forth and back.

use core::fmt;
use embedded_hal::digital::{self, InputPin};
use plotter_motion::{Axis, Drive, encoder::PulseCounter};

/// One input pin and the counter behind it. A pulse is a rising edge.
///
/// ```
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Read};
/// use plotter_hal::PulseInput;
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// let pin = Pin::new(&[Read::get(Low), Read::get(High), Read::get(Low), Read::get(High)]);
/// let mut encoder = PulseInput::new(Axis::X, pin);
/// let back = Demand { x: Duty::saturating(-0.5), y: Duty::ZERO };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// encoder.driven(gate.pass(back));
/// for _ in 0..4 {
///     encoder.poll()?;
/// }
/// assert_eq!(encoder.counter().position(), -2);
/// # encoder.release().done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PulseInput<Pin> {
    axis: Axis,
    pin: Pin,
    counter: PulseCounter,
    /// The level seen last; `None` until the pin has been read.
    was_high: Option<bool>,
}

impl<Pin: InputPin> PulseInput<Pin> {
    /// The encoder of the motor of `axis` on `pin`, which is first read by [`poll`](Self::poll).
    pub fn new(axis: Axis, pin: Pin) -> Self {
        Self { axis, pin, counter: PulseCounter::default(), was_high: None }
    }

    /// Takes what the motors get from now on: the drive that passed the safety gate, not what was asked for.
    pub fn driven(&mut self, drive: Drive) {
        self.counter.driven(drive.axis(self.axis));
    }

    /// Reads the pin; says whether a pulse has come. The first call notes the level.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the encoder is then as if this call had not been made.
    pub fn poll(&mut self) -> Result<bool, Error<Pin::Error>> {
        let is_high = self.pin.is_high().map_err(Error::Pin)?;
        let came = self.was_high.replace(is_high) == Some(false) && is_high;
        if came {
            self.counter.pulses(1);
        }
        Ok(came)
    }

    /// Position and direction.
    pub const fn counter(&self) -> PulseCounter {
        self.counter
    }

    /// Gives the pin back.
    pub fn release(self) -> Pin {
        self.pin
    }
}

#[cfg(feature = "async")]
impl<Pin: InputPin + embedded_hal_async::digital::Wait> PulseInput<Pin> {
    /// Waits for a pulse. For shafts that turn slowly: each edge is a turn of the executor.
    ///
    /// Can be dropped at any time.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the position is as before.
    pub async fn pulse(&mut self) -> Result<(), Error<Pin::Error>> {
        loop {
            match self.was_high {
                None => {
                    self.poll()?;
                }
                Some(true) => {
                    self.pin.wait_for_low().await.map_err(Error::Pin)?;
                    self.was_high = Some(false);
                }
                Some(false) => {
                    self.pin.wait_for_high().await.map_err(Error::Pin)?;
                    self.was_high = Some(true);
                    self.counter.pulses(1);
                    return Ok(());
                }
            }
        }
    }
}

/// What a hardware counter of 16 or 32 bits, which wraps, has counted since it was read last.
///
/// Read it before it has gone all the way round: one of 16 bits at 100 000 pulses/s every 0.65 s.
///
/// ```
/// # use plotter_hal::CounterDelta;
/// # use plotter_motion::{Duty, encoder::PulseCounter};
/// let mut delta = CounterDelta::new(65_530_u16);
/// let mut counter = PulseCounter::default();
/// counter.driven(Duty::FULL);
/// counter.pulses(delta.since_last(4)); // it has wrapped
/// assert_eq!(counter.position(), 10);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct CounterDelta<Count> {
    last: Count,
}

impl<Count> CounterDelta<Count> {
    /// Begins at what the counter shows now.
    pub const fn new(count: Count) -> Self {
        Self { last: count }
    }
}

impl CounterDelta<u16> {
    /// Takes what the counter shows now; gives the pulses since the last time.
    pub const fn since_last(&mut self, count: u16) -> u32 {
        let pulses = count.wrapping_sub(self.last);
        self.last = count;
        pulses as u32
    }
}

impl CounterDelta<u32> {
    /// Takes what the counter shows now; gives the pulses since the last time.
    pub const fn since_last(&mut self, count: u32) -> u32 {
        let pulses = count.wrapping_sub(self.last);
        self.last = count;
        pulses
    }
}

/// The position of a two-phase encoder that a timer counts by itself, forth and back, in 16 bits that wrap:
/// timers of the STM32 in encoder mode, PIO of the RP2040, QDEC of the nRF52.
///
/// Read it before the shaft can have gone half the way round, 32,767 counts: at 200 000 counts/s every 0.16
/// s. Farther than that it cannot be told from the other way.
///
/// ```
/// # use plotter_hal::TimerCount;
/// let mut encoder = TimerCount::new(65_530); // what the timer shows now is the origin
/// assert_eq!(encoder.update(4), 10); // it has wrapped: ten counts forth
/// assert_eq!(encoder.update(65_526), -14); // and fourteen back
/// assert_eq!(encoder.position(), -4);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TimerCount {
    last: u16,
    position: i32,
}

impl TimerCount {
    /// The encoder, at 0 where the timer shows `count`.
    pub const fn new(count: u16) -> Self {
        Self { last: count, position: 0 }
    }

    /// Takes what the timer shows now; gives the counts since the last time, with their sign: those that a
    /// controller takes as edges.
    pub const fn update(&mut self, count: u16) -> i16 {
        let moved = count.wrapping_sub(self.last).cast_signed();
        self.last = count;
        self.position = self.position.wrapping_add(moved as i32);
        moved
    }

    /// Where the shaft is, counts from where it was first seen. Wraps at the ends of `i32`.
    pub const fn position(&self) -> i32 {
        self.position
    }
}

/// The pin of a pulse encoder could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin> {
    /// The pin's own error.
    Pin(Pin),
}

impl<Pin: digital::Error> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Pin(cause) = self;
        write!(f, "pin of the pulse encoder: {}", cause.kind())
    }
}

impl<Pin: digital::Error> core::error::Error for Error<Pin> {}

crate::which_pin::formats_as_shown!(<Pin: digital::Error> Error<Pin>);
