//! [`Record`]: something that happened, and when.

use core::fmt;
use core::time::Duration;
use plotter_motion::{Axis, Direction, Pen};

/// Something that happened on or beside the serial line, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Record {
    /// Since the start of the log; a log keeps whole microseconds. A byte's time is that of its last bit.
    pub time: Duration,
    /// What happened.
    pub event: Event,
}

impl Record {
    /// `event` at `time_us` microseconds after the start.
    #[must_use]
    pub const fn at_us(time_us: u64, event: Event) -> Self {
        Self { time: Duration::from_micros(time_us), event }
    }
}

/// What a record says.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event {
    /// Bytes from the host to the controller, as they arrived together. At least one.
    Host(Vec<u8>),
    /// Bytes from the controller to the host, as they arrived together. At least one.
    Controller(Vec<u8>),
    /// A motor turned by one encoder count.
    Edge {
        /// Which motor.
        axis: Axis,
        /// Which way.
        sign: Direction,
    },
    /// A motor is driven with another duty cycle from here.
    Drive {
        /// Which motor.
        axis: Axis,
        /// Signed steps of the PWM timer (-255 to 255 for 8 bits).
        duty: i32,
    },
    /// A limit switch or button changed.
    Switch {
        /// Which one.
        name: SwitchName,
        /// Whether it is pressed now.
        pressed: bool,
    },
    /// The emergency stop button changed; `true` is pressed.
    Estop(bool),
    /// The pen was lifted or lowered.
    Pen(Pen),
    /// The controller took a target, in encoder counts.
    Target {
        /// To the right.
        x: i32,
        /// Up.
        y: i32,
    },
    /// Words for people. Any text: line ends and control characters are escaped in the log.
    Note(String),
}

/// Name of a switch: 1 to 32 printable ASCII characters without a space, as in `x-min`.
///
/// ```
/// # use plotter_replay::log::SwitchName;
/// assert_eq!(SwitchName::new("x-min").unwrap().as_str(), "x-min");
/// assert!(SwitchName::new("x min").is_err());
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SwitchName(String);

/// A name that no switch can have in a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SwitchNameError {
    /// The name.
    pub name: String,
}

impl SwitchName {
    /// Longest name, in characters.
    pub const MAX_LEN: usize = 32;

    /// Checks a name.
    ///
    /// # Errors
    ///
    /// [`SwitchNameError`] for an empty or longer name, a space, or a character outside printable ASCII.
    pub fn new(name: &str) -> Result<Self, SwitchNameError> {
        let fits = (1..=Self::MAX_LEN).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic());
        if fits { Ok(Self(name.to_owned())) } else { Err(SwitchNameError { name: name.to_owned() }) }
    }

    /// The name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for SwitchNameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "switch name {:?}: expected 1 to {} printable ASCII characters without a space",
            self.name,
            SwitchName::MAX_LEN
        )
    }
}

impl core::error::Error for SwitchNameError {}
