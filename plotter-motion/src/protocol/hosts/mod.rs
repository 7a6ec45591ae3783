//! Hosts for the languages that plotters speak: each sends a drawing to a machine, keeps account of what that
//! answers, and does what a person asks; sans-IO.
//!
//! ```text
//!  operations ─▶ MachineHost ─▶ next_byte ─▶ line ─▶ machine
//!  Request    ─▶             ◀─ receive   ◀─ line ◀─
//!                └─▶ HostStatus, MachineNotice
//! ```
//!
//! | host | machines | flow | place told | stop |
//! |---|---|---|---|---|
//! | [`Grbl`] | GRBL 1.1, GRBLHAL, `FluidNC` | bytes of its buffer | `?` | `0x18` |
//! | [`Marlin`] | Marlin 2 | a line at a time, with number and checksum | `M114` at rest | `M112` |
//! | [`Hpgl`] | pen plotters with HPGL on a serial line | free bytes of its buffer, `ESC .B`, or XON and XOFF, or DTR | `OA` at rest | none: `ESC .K` drops what is buffered |
//! | [`EbbHost`] | AxiDraw, EggBot | a command at a time | `QS` | `ES` |
//! | [`MDraw`] | Makeblock's XY plotter | a line at a time | `P` | none |
//!
//! All of them but [`EbbHost`], which plans the motion itself, are [`LineHost`]s of a [`Language`]. A machine
//! of the published digits, or of our link, has [`Host`](super::Host) and [`LinkHost`](super::LinkHost),
//! whose targets are counts.

mod ebb;
mod finder;
mod gcode_words;
mod grbl;
mod hpgl;
mod language;
mod line_host;
mod line_queue;
mod marlin;
mod mdraw;
mod notice;
mod ring;
mod trail;
mod words;

pub use ebb::{EbbHost, EbbHostSettings};
pub use finder::{Finder, Finding, Tongue};
pub use grbl::Grbl;
pub use hpgl::{Hpgl, HpglFlow};
pub use language::{Answer, Doing, Language, OpText, Report};
pub use line_host::{LineHost, LineHostSettings};
pub use line_queue::{InFlight, MOST_LINE, Purpose};
pub use marlin::Marlin;
pub use mdraw::MDraw;
pub use notice::MachineNotice;
pub use words::Words;

use crate::{Pen, PlotOp, Point, Vec2};
use core::time::Duration;

/// A host of a machine, whatever that speaks.
pub trait MachineHost {
    /// Looks at the clock; call it again at [`next_wake`](Self::next_wake) at the latest. Says what is new,
    /// one thing at a time.
    fn poll(&mut self, now: Duration) -> Option<MachineNotice>;

    /// The next byte for the line, if there is one for it now.
    #[must_use]
    fn next_byte(&mut self, now: Duration) -> Option<u8>;

    /// Takes a byte from the machine; what is new is told by [`poll`](Self::poll).
    fn receive(&mut self, now: Duration, byte: u8);

    /// When there is something to do, unless a byte comes before.
    #[must_use]
    fn next_wake(&self) -> Option<Duration>;

    /// What a person asks.
    ///
    /// # Errors
    ///
    /// [`NotNow`]: nothing was done.
    fn ask(&mut self, now: Duration, request: Request) -> Result<(), NotNow>;

    /// What stops the machine at once, in the middle of anything; none where the language has no such word.
    /// Whoever writes them on the line asks for [`Request::Stop`], too, which sends nothing more.
    #[must_use]
    fn stop_bytes(&self) -> &'static [u8];

    /// How it is.
    #[must_use]
    fn status(&self) -> HostStatus;
}

/// What a person asks of a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Request {
    /// Begin with the drawing, or go on with it: the pen is put back where it was lifted.
    GoOn,
    /// Draw the next operation, then pause.
    Next,
    /// Lift the pen where it is and wait.
    Pause,
    /// The emergency stop was sent: nothing more goes out.
    Stop,
    /// Take off the lock after a stop or an alarm.
    Unlock,
    /// Search for the limit switches.
    Home,
    /// This by hand, while nothing is drawn: travel, draw, arc, lift (travel to where the pen is).
    ByHand(PlotOp),
    /// Move by so much by hand, at this speed; may be ended on its way.
    Jog {
        /// By how much, mm.
        by: Vec2,
        /// Speed, mm/s.
        feed_mm_s: f64,
    },
    /// End a [`Jog`](Self::Jog) on its way.
    EndJog,
    /// Where the pen is now is this place of the sheet.
    StandsAt(Point),
    /// Speed of the drawing, per cent of what it asks for, 10 to 200.
    Feed {
        /// Per cent.
        percent: u8,
    },
    /// The number that lowers the pen, where it is one: `S` of GRBL's spindle, degrees of a servo.
    PenDownAt(u16),
}

/// Why nothing was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NotNow {
    /// Nothing was heard of the machine yet.
    Unheard,
    /// It draws: pause it first.
    Draws,
    /// It is locked or stopped: unlock it first.
    Locked,
    /// Nothing is under way that this would change.
    Nothing,
    /// The machine's language has no word for it.
    NoWord,
    /// It lost its place: lead it home, or say where it stands.
    PlaceLost,
    /// What was asked lies outside what can be said.
    OutOfRange,
    /// Too much is asked at once.
    Busy,
}

impl core::fmt::Display for NotNow {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Unheard => "nothing was heard of the machine yet",
            Self::Draws => "the machine draws: pause it first",
            Self::Locked => "the machine is stopped or locked: unlock it first",
            Self::Nothing => "there is nothing to change",
            Self::NoWord => "this machine's language has no word for it",
            Self::PlaceLost => "the machine has lost its place: lead it home, or say where it stands",
            Self::OutOfRange => "that is out of range",
            Self::Busy => "the machine has enough to do: wait for it",
        })
    }
}

impl core::error::Error for NotNow {}

/// What a host is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HostState {
    /// Nothing was heard of the machine yet.
    Unheard,
    /// The machine waits, and the drawing is not begun.
    Ready,
    /// It draws.
    Drawing,
    /// The pen is about to be lifted for a pause, a change, or the end.
    Ending,
    /// It waits with the pen lifted.
    Paused,
    /// It waits for a person to put in this pen.
    PenWanted(u8),
    /// It waits for a person to put in a new sheet.
    SheetWanted,
    /// It searches for its switches.
    Homing,
    /// Stopped by the emergency stop, or switched off and on: it waits for [`Request::Unlock`].
    Stopped,
    /// Locked by itself, with its code.
    Locked(u16),
    /// All is drawn, and the pen lifted.
    Done,
}

/// How a host is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostStatus {
    /// What it is doing.
    pub state: HostState,
    /// Where the pen is, as the machine told last, mm on the sheet.
    pub at: Option<Point>,
    /// How the pen is: as what is under way has it, or else what was sent last.
    pub pen: Pen,
    /// Operations of the drawing that were sent whole.
    pub sent: u64,
    /// Operations that the machine is known to have carried out.
    pub done: u64,
    /// Whether something by hand is under way as far as the host knows: not sent, not answered, or the place
    /// behind it not told by a machine that tells none on the way.
    pub is_led: bool,
    /// Speed of the drawing, per cent of what it asks for.
    pub feed_percent: u8,
    /// What the machine says of itself.
    pub limits: MachineLimits,
}

/// What a machine says of itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MachineLimits {
    /// Greatest speed of each axis, mm/s.
    pub speed_mm_s: [Option<f64>; 2],
    /// Greatest acceleration of each axis, mm/s².
    pub acceleration_mm_s2: [Option<f64>; 2],
    /// How far each axis goes, mm.
    pub travel_mm: [Option<f64>; 2],
    /// Steps in a millimetre.
    pub steps_per_mm: [Option<f64>; 2],
    /// Whether it refuses what lies beyond.
    pub refuses_beyond: Option<bool>,
}
