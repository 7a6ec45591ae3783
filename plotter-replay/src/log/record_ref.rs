//! [`RecordRef`]: a record that borrows its bytes, for reading or writing many millions without allocation.

use super::{Event, Record, SwitchName};
use core::time::Duration;
use plotter_motion::{Axis, Direction, Pen};
use std::borrow::Cow;

/// A [`Record`] that borrows its bytes from the reader or the caller, so that nothing is allocated.
///
/// ```
/// # use plotter_replay::log::{EventRef, Header, Reader, RecordRef, Writer};
/// # use core::time::Duration;
/// let mut writer = Writer::new(Vec::new(), &Header::new())?;
/// writer.write_ref(&RecordRef { time: Duration::from_micros(39), event: EventRef::Host(&[7]) })?;
/// let log = writer.finish()?;
/// let mut reader = Reader::new(&log[..])?;
/// while let Some(item) = reader.next_ref() {
///     assert_eq!(item.map(|record| record.event), Ok(EventRef::Host(&[7])));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordRef<'a> {
    /// Time since the start of the log.
    pub time: Duration,
    /// The event.
    pub event: EventRef<'a>,
}

/// An [`Event`] that borrows its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EventRef<'a> {
    /// See [`Event::Host`].
    Host(&'a [u8]),
    /// See [`Event::Controller`].
    Controller(&'a [u8]),
    /// See [`Event::Edge`].
    Edge {
        /// The motor.
        axis: Axis,
        /// Direction of the edge.
        sign: Direction,
    },
    /// See [`Event::Drive`].
    Drive {
        /// The motor.
        axis: Axis,
        /// Signed steps of the PWM timer.
        duty: i32,
    },
    /// See [`Event::Switch`].
    Switch {
        /// The switch.
        name: Cow<'a, SwitchName>,
        /// Whether it has been pressed or released.
        pressed: bool,
    },
    /// See [`Event::Estop`].
    Estop(bool),
    /// See [`Event::Pen`].
    Pen(Pen),
    /// See [`Event::Target`].
    Target {
        /// Counts to the right.
        x: i32,
        /// Counts upwards.
        y: i32,
    },
    /// See [`Event::Note`].
    Note(Cow<'a, str>),
}

impl RecordRef<'_> {
    /// The same record with bytes of its own.
    #[must_use]
    pub fn to_record(&self) -> Record {
        let event = match &self.event {
            EventRef::Host(bytes) => Event::Host(bytes.to_vec()),
            EventRef::Controller(bytes) => Event::Controller(bytes.to_vec()),
            EventRef::Edge { axis, sign } => Event::Edge { axis: *axis, sign: *sign },
            EventRef::Drive { axis, duty } => Event::Drive { axis: *axis, duty: *duty },
            EventRef::Switch { name, pressed } => {
                Event::Switch { name: name.as_ref().clone(), pressed: *pressed }
            }
            EventRef::Estop(pressed) => Event::Estop(*pressed),
            EventRef::Pen(pen) => Event::Pen(*pen),
            EventRef::Target { x, y } => Event::Target { x: *x, y: *y },
            EventRef::Note(text) => Event::Note(text.clone().into_owned()),
        };
        Record { time: self.time, event }
    }
}

impl Record {
    /// The same without a copy of the bytes.
    #[must_use]
    pub fn view(&self) -> RecordRef<'_> {
        RecordRef { time: self.time, event: self.event.view() }
    }
}

impl Event {
    /// The same without a copy of the bytes.
    #[must_use]
    pub fn view(&self) -> EventRef<'_> {
        match self {
            Self::Host(bytes) => EventRef::Host(bytes),
            Self::Controller(bytes) => EventRef::Controller(bytes),
            Self::Edge { axis, sign } => EventRef::Edge { axis: *axis, sign: *sign },
            Self::Drive { axis, duty } => EventRef::Drive { axis: *axis, duty: *duty },
            Self::Switch { name, pressed } => {
                EventRef::Switch { name: Cow::Borrowed(name), pressed: *pressed }
            }
            Self::Estop(pressed) => EventRef::Estop(*pressed),
            Self::Pen(pen) => EventRef::Pen(*pen),
            Self::Target { x, y } => EventRef::Target { x: *x, y: *y },
            Self::Note(text) => EventRef::Note(Cow::Borrowed(text)),
        }
    }
}
