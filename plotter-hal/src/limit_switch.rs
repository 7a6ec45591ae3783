//! A limit switch on an input pin, debounced; and the four of a plotter.
//!
//! ```text
//!     +3.3 V                        switch │ pin    normally closed, with a pull-up
//!       │                           ───────┼──────────────────────────────────────────
//!      ┌┴┐                          free   │ low    closed: the current flows to ground
//!      └┬┘                          pressed│ high   open
//!       ├───── pin                  broken │ high   open: counts as pressed, and nothing
//!       └──o/o── ground             wire   │        drives towards that end
//! ```
//!
//! Read it by [`LimitSwitch::tick`] every millisecond or so, or from an interrupt at both edges of the pin
//! and at [`LimitSwitch::due`]. A drive towards a pressed switch is what the safety gate takes away (after
//! Khan and McGinn, "2D Controlled Marking Board", section 0.3); the group hands it [`LimitSwitches`].

use crate::SwitchSettings;
use crate::debounce::Contact;
#[cfg(feature = "async")]
use crate::waiting::{First, first, turn, wait_until_due};
use core::fmt;
use core::time::Duration;
use embedded_hal::digital::{self, InputPin};
#[cfg(feature = "async")]
use embedded_hal_async::{delay::DelayNs, digital::Wait};
use plotter_motion::{Axis, Direction, LimitSwitches};

/// One switch. Until it has shown for [`SwitchSettings::release_after`] that it is free, it counts as
/// pressed; and so does one whose pin cannot be read.
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Read};
/// use plotter_hal::{LimitSwitch, SwitchSettings};
///
/// let pin = Pin::new(&[Read::get(Low), Read::get(Low), Read::get(High)]);
/// let mut switch = LimitSwitch::new(pin, SwitchSettings::default());
/// assert!(switch.is_pressed()); // nobody has looked yet
/// assert!(switch.tick(Duration::ZERO)?);
/// assert_eq!(switch.due(), Some(Duration::from_millis(20)));
/// assert!(!switch.tick(Duration::from_millis(20))?); // free
/// assert!(switch.tick(Duration::from_millis(21))?); // pressed: taken at once
/// # switch.release().done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LimitSwitch<Pin> {
    contact: Contact<Pin>,
}

impl<Pin: InputPin> LimitSwitch<Pin> {
    /// The switch on `pin`, which is first read by [`tick`](Self::tick).
    pub const fn new(pin: Pin, settings: SwitchSettings) -> Self {
        Self { contact: Contact::new(pin, settings) }
    }

    /// Reads the pin; says whether the switch counts as pressed. Never waits.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the switch counts as pressed then.
    pub fn tick(&mut self, now: Duration) -> Result<bool, Error<Pin::Error>> {
        self.contact.read(now).map(|seen| seen.is_pressed).map_err(Error::Pin)
    }

    /// Whether it counts as pressed, as of the last [`tick`](Self::tick).
    pub const fn is_pressed(&self) -> bool {
        self.contact.is_pressed()
    }

    /// When to call [`tick`](Self::tick) next if no edge of the pin comes before; `None` if only an edge
    /// changes anything.
    pub fn due(&self) -> Option<Duration> {
        self.contact.due()
    }

    /// Gives the pin back.
    pub fn release(self) -> Pin {
        self.contact.release()
    }
}

#[cfg(feature = "async")]
impl<Pin: InputPin + Wait> LimitSwitch<Pin> {
    /// Waits until the switch counts as pressed or no longer does, and says which. A press too short to be
    /// read counts.
    ///
    /// Can be dropped at any time, as when something else comes first; what has been seen stays so.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`]; the switch counts as pressed then.
    pub async fn changed(
        &mut self,
        clock: impl Fn() -> Duration,
        delay: &mut impl DelayNs,
    ) -> Result<bool, Error<Pin::Error>> {
        let was_pressed = self.is_pressed();
        loop {
            let read = self.tick(clock());
            if read.is_err() {
                // A pin that fails for ever does not keep other tasks for ever.
                turn().await;
            }
            let is_pressed = read?;
            if is_pressed != was_pressed {
                return Ok(is_pressed);
            }
            let due = self.due();
            let other = self.contact.shows_other(&clock);
            if let First::A(Err(cause)) = first(other, wait_until_due(due, &clock, delay)).await {
                return Err(Error::Pin(cause));
            }
        }
    }
}

/// The pin of a switch could not be read; the switch counts as pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pin> {
    /// The pin's own error.
    Pin(Pin),
}

impl<Pin: digital::Error> fmt::Display for Error<Pin> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Pin(cause) = self;
        write!(f, "pin of the limit switch: {}; it counts as pressed", cause.kind())
    }
}

impl<Pin: digital::Error> core::error::Error for Error<Pin> {}

crate::which_pin::formats_as_shown!(<Pin: digital::Error> Error<Pin>);

/// The switches at both ends of both axes.
///
/// ```
/// # use core::time::Duration;
/// # use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Read};
/// # use plotter_hal::{LimitSwitch, LimitSwitchGroup, SwitchSettings};
/// # use plotter_motion::{Demand, Duty, SafetyGate};
/// let settings = SwitchSettings::default().with_release_after(Duration::ZERO);
/// let switch = |level| LimitSwitch::new(Pin::new(&[Read::get(level)]), settings);
/// let mut switches =
///     LimitSwitchGroup { x_min: switch(Low), x_max: switch(High), y_min: switch(Low), y_max: switch(Low) };
///
/// let gate = SafetyGate::new(switches.tick(Duration::ZERO)?, false);
/// let drive = gate.pass(Demand { x: Duty::FULL, y: Duty::FULL });
/// assert_eq!((drive.x(), drive.y()), (Duty::ZERO, Duty::FULL)); // not into the right end
/// # for switch in [switches.x_min, switches.x_max, switches.y_min, switches.y_max] {
/// #     switch.release().done();
/// # }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LimitSwitchGroup<XMin, XMax, YMin, YMax> {
    /// At the left end.
    pub x_min: LimitSwitch<XMin>,
    /// At the right end.
    pub x_max: LimitSwitch<XMax>,
    /// At the lower end.
    pub y_min: LimitSwitch<YMin>,
    /// At the upper end.
    pub y_max: LimitSwitch<YMax>,
}

impl<XMin, XMax, YMin, YMax> LimitSwitchGroup<XMin, XMax, YMin, YMax>
where
    XMin: InputPin,
    XMax: InputPin,
    YMin: InputPin,
    YMax: InputPin,
{
    /// Reads all four, whichever of them fails. Never waits.
    ///
    /// # Errors
    ///
    /// [`GroupError`] names the first switch whose pin could not be read. It counts as pressed in
    /// [`limits`](Self::limits), in which the others are up to date.
    #[expect(clippy::type_complexity, reason = "an error type for each of the four pins")]
    pub fn tick(
        &mut self,
        now: Duration,
    ) -> Result<LimitSwitches, GroupError<XMin::Error, XMax::Error, YMin::Error, YMax::Error>> {
        let x_min = self.x_min.tick(now).map_err(|Error::Pin(cause)| GroupError::XMin(cause));
        let x_max = self.x_max.tick(now).map_err(|Error::Pin(cause)| GroupError::XMax(cause));
        let y_min = self.y_min.tick(now).map_err(|Error::Pin(cause)| GroupError::YMin(cause));
        let y_max = self.y_max.tick(now).map_err(|Error::Pin(cause)| GroupError::YMax(cause));
        Ok(LimitSwitches { x_min: x_min?, x_max: x_max?, y_min: y_min?, y_max: y_max? })
    }

    /// Which of them count as pressed, as of the last [`tick`](Self::tick): all, before the first.
    pub const fn limits(&self) -> LimitSwitches {
        LimitSwitches {
            x_min: self.x_min.is_pressed(),
            x_max: self.x_max.is_pressed(),
            y_min: self.y_min.is_pressed(),
            y_max: self.y_max.is_pressed(),
        }
    }

    /// When to call [`tick`](Self::tick) next if no edge of a pin comes before.
    pub fn due(&self) -> Option<Duration> {
        let due = [self.x_min.due(), self.x_max.due(), self.y_min.due(), self.y_max.due()];
        due.into_iter().flatten().min()
    }
}

#[cfg(feature = "async")]
impl<XMin, XMax, YMin, YMax> LimitSwitchGroup<XMin, XMax, YMin, YMax>
where
    XMin: InputPin + Wait,
    XMax: InputPin + Wait,
    YMin: InputPin + Wait,
    YMax: InputPin + Wait,
{
    /// Waits until one of them counts as pressed or no longer does, and says what is pressed then: for the
    /// gate.
    ///
    /// Can be dropped at any time, as when something else comes first; what has been seen stays so.
    ///
    /// # Errors
    ///
    /// [`GroupError`] names the first switch whose pin could not be read. It counts as pressed in
    /// [`limits`](Self::limits).
    pub async fn changed(
        &mut self,
        clock: impl Fn() -> Duration,
        delay: &mut impl DelayNs,
    ) -> Result<LimitSwitches, GroupError<XMin::Error, XMax::Error, YMin::Error, YMax::Error>> {
        let before = self.limits();
        loop {
            let read = self.tick(clock());
            if read.is_err() {
                // A pin that fails for ever does not keep other tasks for ever.
                turn().await;
            }
            let limits = read?;
            if limits != before {
                return Ok(limits);
            }
            let due = self.due();
            let x = first(self.x_min.contact.shows_other(&clock), self.x_max.contact.shows_other(&clock));
            let y = first(self.y_min.contact.shows_other(&clock), self.y_max.contact.shows_other(&clock));
            return Err(match first(first(x, y), wait_until_due(due, &clock, delay)).await {
                First::A(First::A(First::A(Err(cause)))) => GroupError::XMin(cause),
                First::A(First::A(First::B(Err(cause)))) => GroupError::XMax(cause),
                First::A(First::B(First::A(Err(cause)))) => GroupError::YMin(cause),
                First::A(First::B(First::B(Err(cause)))) => GroupError::YMax(cause),
                First::A(_) | First::B(_) => continue,
            });
        }
    }
}

crate::which_pin::which_pin! {
    /// The pin of one of the four switches could not be read; that switch counts as pressed.
    GroupError: digital,
    XMin "axis x: pin of its lower limit switch: {}; it counts as pressed",
    XMax "axis x: pin of its upper limit switch: {}; it counts as pressed",
    YMin "axis y: pin of its lower limit switch: {}; it counts as pressed",
    YMax "axis y: pin of its upper limit switch: {}; it counts as pressed",
}

impl<XMin, XMax, YMin, YMax> GroupError<XMin, XMax, YMin, YMax> {
    /// Axis of the switch.
    pub const fn axis(&self) -> Axis {
        match self {
            Self::XMin(_) | Self::XMax(_) => Axis::X,
            Self::YMin(_) | Self::YMax(_) => Axis::Y,
        }
    }

    /// At which of its ends.
    pub const fn end(&self) -> Direction {
        match self {
            Self::XMin(_) | Self::YMin(_) => Direction::Minus,
            Self::XMax(_) | Self::YMax(_) => Direction::Plus,
        }
    }
}
