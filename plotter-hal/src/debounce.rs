//! A contact that bounces, as a state machine without pins.
//!
//! ```text
//!  contact   ────┐ ┌┐ ┌┐               ┌┐ ┌───    high: pressed
//!                └─┘└─┘└───────────────┘└─┘
//!  taken as  ─────────────────────┐    ┌──────    released once it has lasted, pressed at once
//!                                 └────┘
//!                      │◀────────▶│
//!                      release_after
//! ```

use core::time::Duration;
use embedded_hal::digital::{InputPin, PinState};

/// How a switch is wired, and how long its contact bounces.
///
/// A press is taken at once and a release only when it has lasted. That is the safe side: what is late is the
/// permission to move. A press believed 20 ms late would be 1.8 mm of travel into the end of an axis at 90
/// mm/s. The price is that one spike on the wire counts as a press; where that happens, `press_after` asks
/// for more.
///
/// ```
/// # use core::time::Duration;
/// # use embedded_hal::digital::PinState;
/// # use plotter_hal::SwitchSettings;
/// let normally_open = SwitchSettings::default().with_pressed_at(PinState::Low);
/// assert_eq!(normally_open.release_after, Duration::from_millis(20));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct SwitchSettings {
    /// Level of the pin while the switch is pressed. A normally closed switch from the pin to ground, with a
    /// pull-up, shows [`PinState::High`] then, and so does a broken wire; a normally open one shows
    /// [`PinState::Low`], and its broken wire is found by nobody.
    pub pressed_at: PinState,
    /// For how long the pin must show that it is pressed before that is believed; 0 is at once.
    pub press_after: Duration,
    /// For how long it must show without a break that it is not, before that is believed.
    pub release_after: Duration,
}

impl SwitchSettings {
    /// The same with another [`SwitchSettings::press_after`].
    #[must_use]
    pub const fn with_press_after(self, press_after: Duration) -> Self {
        Self { press_after, ..self }
    }

    /// The same with another [`SwitchSettings::pressed_at`].
    #[must_use]
    pub const fn with_pressed_at(self, pressed_at: PinState) -> Self {
        Self { pressed_at, ..self }
    }

    /// The same with another [`SwitchSettings::release_after`].
    #[must_use]
    pub const fn with_release_after(self, release_after: Duration) -> Self {
        Self { release_after, ..self }
    }
}

impl Default for SwitchSettings {
    /// Normally closed; pressed at once, released after 20 ms.
    ///
    /// Switches of 18 kinds were measured to bounce for at most 6.2 ms, an outlier apart (J. Ganssle, "A
    /// Guide to Debouncing", 2004); 20 ms leave room for a worn one.
    fn default() -> Self {
        Self {
            pressed_at: PinState::High,
            press_after: Duration::ZERO,
            release_after: Duration::from_millis(20),
        }
    }
}

/// A contact on a pin, and what is believed of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Contact<Pin> {
    pin: Pin,
    debounce: Debounce,
}

/// What a look at a contact told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Seen {
    /// Level of the pin now.
    pub(crate) shows_press: bool,
    /// What is believed.
    pub(crate) is_pressed: bool,
}

impl<Pin: InputPin> Contact<Pin> {
    pub(crate) const fn new(pin: Pin, settings: SwitchSettings) -> Self {
        Self { pin, debounce: Debounce::new(settings) }
    }

    /// Reads the pin. One that cannot be read is pressed, at once.
    pub(crate) fn read(&mut self, now: Duration) -> Result<Seen, Pin::Error> {
        match self.pin.is_high() {
            Ok(is_high) => {
                let shows_press = self.debounce.shows_press(is_high);
                Ok(Seen { shows_press, is_pressed: self.debounce.update(now, shows_press) })
            }
            Err(cause) => {
                self.debounce.unreadable();
                Err(cause)
            }
        }
    }
}

impl<Pin> Contact<Pin> {
    pub(crate) const fn is_pressed(&self) -> bool {
        self.debounce.pressed
    }

    /// When what is believed changes, if the contact goes on showing what it shows.
    pub(crate) fn due(&self) -> Option<Duration> {
        self.debounce.due()
    }

    pub(crate) fn release(self) -> Pin {
        self.pin
    }
}

#[cfg(feature = "async")]
impl<Pin: InputPin + embedded_hal_async::digital::Wait> Contact<Pin> {
    /// Waits until the pin shows something else than it did when it was read last, and says whether that is a
    /// press. It counts as a look at the pin, so that what is over by the next one has been seen. Changes
    /// nothing when it is dropped before.
    pub(crate) async fn shows_other(&mut self, clock: &impl Fn() -> Duration) -> Result<bool, Pin::Error> {
        let shows_press = !self.debounce.showed_press();
        let is_high = self.debounce.shows_press(true) == shows_press;
        let waited = if is_high { self.pin.wait_for_high().await } else { self.pin.wait_for_low().await };
        match waited {
            Ok(()) => {
                self.debounce.update(clock(), shows_press);
                Ok(shows_press)
            }
            Err(cause) => {
                self.debounce.unreadable();
                Err(cause)
            }
        }
    }
}

/// What is believed of a contact. Nothing is known of it at first: it counts as pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Debounce {
    settings: SwitchSettings,
    pressed: bool,
    /// Since when the contact has shown the opposite without a break.
    differs_since: Option<Duration>,
}

impl Debounce {
    const fn new(settings: SwitchSettings) -> Self {
        Self { settings, pressed: true, differs_since: None }
    }

    /// Whether this level of the pin is that of a pressed switch.
    fn shows_press(&self, is_high: bool) -> bool {
        PinState::from(is_high) == self.settings.pressed_at
    }

    /// State of the last reading; a pin that could not be read counts as pressed.
    #[cfg(feature = "async")]
    const fn showed_press(&self) -> bool {
        self.pressed != self.differs_since.is_some()
    }

    /// Takes what the contact shows now; says what is believed.
    fn update(&mut self, now: Duration, shows_press: bool) -> bool {
        if shows_press == self.pressed {
            self.differs_since = None;
            return self.pressed;
        }
        let since = *self.differs_since.get_or_insert(now);
        if has_come(self.needed(), now.saturating_sub(since)) {
            self.pressed = shows_press;
            self.differs_since = None;
        }
        self.pressed
    }

    /// The contact cannot be read: pressed, at once.
    const fn unreadable(&mut self) {
        self.pressed = true;
        self.differs_since = None;
    }

    /// When what is believed changes, if the contact goes on showing what it shows.
    fn due(&self) -> Option<Duration> {
        self.differs_since.map(|since| since.saturating_add(self.needed()))
    }

    /// How long the opposite of what is believed must last.
    const fn needed(&self) -> Duration {
        if self.pressed { self.settings.release_after } else { self.settings.press_after }
    }
}

/// Whether that time has come, or passed. On a small processor each comparison of two [`Duration`]s is 44
/// bytes wherever it stands, and half of that where it is called.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn has_come(at: Duration, now: Duration) -> bool {
    at <= now
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    fn after(settings: SwitchSettings, shown: &[(u32, bool)]) -> Debounce {
        let mut debounce = Debounce::new(settings);
        for &(at_ms, shows_press) in shown {
            debounce.update(MS * at_ms, shows_press);
        }
        debounce
    }

    #[test]
    fn a_release_must_last_without_a_break() {
        let settings = SwitchSettings::default();
        assert!(after(settings, &[(0, false), (19, false)]).pressed);
        assert!(!after(settings, &[(0, false), (20, false)]).pressed);
        assert!(after(settings, &[(0, false), (19, true), (20, false), (39, false)]).pressed);
        assert_eq!(after(settings, &[(5, false)]).due(), Some(MS * 25));
    }

    #[test]
    fn a_press_is_taken_at_once_or_after_its_own_time() {
        let free = [(0, false), (20, false)];
        let at_once = SwitchSettings::default();
        assert!(after(at_once, &[free[0], free[1], (21, true)]).pressed);
        let patient = SwitchSettings { press_after: MS * 3, ..at_once };
        assert!(!after(patient, &[free[0], free[1], (21, true), (23, true)]).pressed);
        assert!(after(patient, &[free[0], free[1], (21, true), (24, true)]).pressed);
    }

    #[test]
    fn a_clock_that_goes_back_releases_nothing() {
        assert!(after(SwitchSettings::default(), &[(30, false), (0, false), (49, false)]).pressed);
    }
}
