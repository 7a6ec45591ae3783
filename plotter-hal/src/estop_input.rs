//! The emergency stop button on an input pin.
//!
//! Wire it as a limit switch (see [`limit_switch`](crate::limit_switch)): normally closed to ground with a
//! pull-up, so that a cut wire stops the machine. A press is taken at once and latched by the safety gate,
//! which takes all drive away until somebody resets it. ISO 13850 asks for both: a stop that stays, and a
//! release that by itself starts nothing.
//!
//! ```text
//!            power on    first tick          release_after      pressed          let go
//!  is_pressed ──┬──────────┬─────────────────┐                  ┌──────────────┐
//!               │ pressed  │ pressed         └──────────────────┘              └──────────
//!  tick         │ (nobody  │                 FreeSinceStart     Pressed        Released
//!               │ looked)  │                 the one time that a firmware may reset the gate by itself
//! ```

use crate::SwitchSettings;
use crate::debounce::Contact;
#[cfg(feature = "async")]
use crate::waiting::{First, first, turn, wait_until_due};
use core::fmt;
use core::time::Duration;
use embedded_hal::digital::{self, InputPin};
#[cfg(feature = "async")]
use embedded_hal_async::{delay::DelayNs, digital::Wait};

/// The button. Pressed until it has shown that it is not, so a machine that is switched on with its stop
/// pressed, or with its wire cut, never starts.
///
/// It remembers nothing of a press that is over: pass what it says to the gate, or to the controller that has
/// one, after every [`tick`](Self::tick), *and once before the first*.
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Read};
/// use plotter_hal::{EstopChange, EstopInput, SwitchSettings};
/// use plotter_motion::{LimitSwitches, SafetyGate};
///
/// let pin = Pin::new(&[Read::get(Low), Read::get(Low), Read::get(High), Read::get(Low)]);
/// let mut button = EstopInput::new(pin, SwitchSettings::default());
/// let mut gate = SafetyGate::new(LimitSwitches::RELEASED, button.is_pressed());
/// assert!(gate.is_stopped()); // nobody has looked yet
///
/// for at_ms in [0, 20, 21, 22] {
///     let change = button.tick(Duration::from_millis(at_ms));
///     gate.emergency_stop(button.is_pressed());
///     if change? == Some(EstopChange::FreeSinceStart) {
///         assert!(gate.reset()); // after 20 ms: it was not pressed when the machine was switched on
///     }
/// }
/// assert!(gate.is_stopped()); // pressed after 21 ms; that it was let go changes nothing
/// # button.release().done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EstopInput<Pin> {
    contact: Contact<Pin>,
    /// Whether it has shown since the start nothing but that it is free.
    unpressed: bool,
}

/// Changes of the button.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum EstopChange {
    /// It is known to be free, and has not been seen pressed since the machine was switched on. Comes once at
    /// most. A firmware without a reset button may reset the safety gate now, or start its controller
    /// ([`StepperPlotter::restart`](plotter_motion::firmware::StepperPlotter::restart)).
    FreeSinceStart,
    /// It is pressed, or its wire is cut.
    Pressed,
    /// It has been let go. The gate stays latched.
    Released,
}

impl<Pin: InputPin> EstopInput<Pin> {
    /// The button on `pin`, which is first read by [`tick`](Self::tick).
    pub const fn new(pin: Pin, settings: SwitchSettings) -> Self {
        Self { contact: Contact::new(pin, settings), unpressed: true }
    }

    /// Reads the pin; says what has changed. Never waits.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the button counts as pressed then.
    pub fn tick(&mut self, now: Duration) -> Result<Option<EstopChange>, Error<Pin::Error>> {
        let was_pressed = self.is_pressed();
        let seen = self.contact.read(now);
        self.unpressed &= seen.as_ref().is_ok_and(|seen| !seen.shows_press);
        seen.map_err(Error::Pin)?;
        Ok(self.change(was_pressed))
    }

    /// What has become of it.
    const fn change(&self, was_pressed: bool) -> Option<EstopChange> {
        match (was_pressed, self.is_pressed()) {
            (false, true) => Some(EstopChange::Pressed),
            (true, false) if self.unpressed => Some(EstopChange::FreeSinceStart),
            (true, false) => Some(EstopChange::Released),
            (true, true) | (false, false) => None,
        }
    }

    /// Whether the button counts as pressed, as of the last [`tick`](Self::tick).
    pub const fn is_pressed(&self) -> bool {
        self.contact.is_pressed()
    }

    /// When to call [`tick`](Self::tick) next if no edge of the pin comes before.
    pub fn due(&self) -> Option<Duration> {
        self.contact.due()
    }

    /// Gives the pin back.
    pub fn release(self) -> Pin {
        self.contact.release()
    }
}

#[cfg(feature = "async")]
impl<Pin: InputPin + Wait> EstopInput<Pin> {
    /// Waits until something becomes of the button. A press too short to be read counts.
    ///
    /// Can be dropped at any time, as when something else comes first; what has been seen stays so, and
    /// [`is_pressed`](Self::is_pressed) tells it to the gate.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the button counts as pressed then.
    pub async fn changed(
        &mut self,
        clock: impl Fn() -> Duration,
        delay: &mut impl DelayNs,
    ) -> Result<EstopChange, Error<Pin::Error>> {
        loop {
            let read = self.tick(clock());
            if read.is_err() {
                // A pin that fails for ever does not keep other tasks for ever.
                turn().await;
            }
            if let Some(change) = read? {
                return Ok(change);
            }
            let (was_pressed, due) = (self.is_pressed(), self.due());
            let other = self.contact.shows_other(&clock);
            if let First::A(seen) = first(other, wait_until_due(due, &clock, delay)).await {
                self.unpressed &= seen.as_ref().is_ok_and(|&shows_press| !shows_press);
                seen.map_err(Error::Pin)?;
                if let Some(change) = self.change(was_pressed) {
                    return Ok(change);
                }
            }
        }
    }
}

/// The pin of the emergency stop could not be read; it counts as pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin> {
    /// The pin's own error.
    Pin(Pin),
}

impl<Pin: digital::Error> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Pin(cause) = self;
        write!(f, "pin of the emergency stop: {}; it counts as pressed", cause.kind())
    }
}

impl<Pin: digital::Error> core::error::Error for Error<Pin> {}

crate::which_pin::formats_as_shown!(<Pin: digital::Error> Error<Pin>);
