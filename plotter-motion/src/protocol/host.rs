//! The host of the published protocol: sends a drawing target by target and keeps account of the answers.

use super::digits::{OutOfRange, Reply, Sender};
use super::message::MessageError;
use crate::{Axis, Direction, PenMove, StepPoint};
use core::fmt;
use core::time::Duration;

/// How patient a host is. Both times count from the last byte of a target at the earliest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct HostSettings {
    /// Silence of the controller after which a target is sent again, 2 s by default.
    pub silence: Duration,
    /// Time without getting nearer to the target after which the host gives it up, 10 s by default.
    pub patience: Duration,
    /// How often a target is sent again before the host gives it up, twice by default.
    pub most_retries: u8,
    /// How many targets in a row the host gives up before it stops, 10 by default.
    pub most_given_up: u8,
    /// How far from the target, on either axis, a `+` is believed, encoder counts; 0 by default.
    pub tolerance_counts: u32,
}

impl Default for HostSettings {
    fn default() -> Self {
        Self {
            silence: Duration::from_secs(2),
            patience: Duration::from_secs(10),
            most_retries: 2,
            most_given_up: 10,
            tolerance_counts: 0,
        }
    }
}

/// Observations of a host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum HostNotice {
    /// The controller said `+` somewhere else; the target is sent again.
    ReachedElsewhere {
        /// The target sent.
        target: StepPoint,
        /// Where the controller's pulses say it is.
        position: StepPoint,
    },
    /// The controller was silent; the target is sent again.
    Silent {
        /// The target sent.
        target: StepPoint,
    },
    /// A byte that means nothing.
    Unknown {
        /// The byte.
        byte: u8,
    },
    /// A target that the protocol has no digits for; it is left out.
    Refused(OutOfRange),
    /// The motors came no nearer to the target for too long: the host goes on with the next.
    GaveUp {
        /// The target sent.
        target: StepPoint,
        /// Where the controller's pulses say it is.
        position: StepPoint,
    },
    /// A target outside the machine's area, encoder counts; it is left out.
    OutOfArea(StepPoint),
    /// The motors are off by an emergency stop, the machine says.
    Stopped,
    /// The machine begins no further target until it is told to go on.
    Held,
    /// Neither stopped nor held any more, the machine says.
    GoesOn,
    /// The machine knows the digits protocol only.
    DigitsOnly,
    /// Nothing comes from the machine any more.
    Interrupted,
    /// The machine is heard again, and the drawing goes on.
    Resumed,
    /// The machine was switched off in the middle of the drawing and does not know where its motors stand:
    /// nothing more is sent.
    MachineRestarted,
    /// The machine speaks another language: nothing more is sent.
    NotUnderstood(MessageError),
}

impl fmt::Display for HostNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = |p: &StepPoint| (p.x, p.y);
        match self {
            Self::ReachedElsewhere { target, position } => {
                write!(f, "controller says that it reached {:?} but counted {:?}", at(target), at(position))
            }
            Self::Silent { target } => write!(f, "controller is silent: sent {:?} again", at(target)),
            Self::Unknown { byte } => write!(f, "byte 0x{byte:02x} from the controller means nothing"),
            Self::Refused(error) => error.fmt(f),
            Self::GaveUp { target, position } => {
                write!(f, "gave up: {:?} was not reached, the motors stand at {:?}", at(target), at(position))
            }
            Self::OutOfArea(target) => {
                write!(f, "target {:?} lies outside the machine's area: it was left out", at(target))
            }
            Self::Stopped => f.write_str("the machine is stopped: both motors are off"),
            Self::Held => f.write_str("the machine waits after this target"),
            Self::GoesOn => f.write_str("the machine goes on"),
            Self::DigitsOnly => f.write_str("the machine knows the digits protocol only"),
            Self::Interrupted => f.write_str("nothing comes from the machine: is its cable plugged in?"),
            Self::Resumed => f.write_str("the machine is heard again: the drawing goes on"),
            Self::MachineRestarted => f.write_str(
                "the machine was switched off in the middle of the drawing and does not know where it stands: lead it \
                 to the origin and begin the drawing anew",
            ),
            Self::NotUnderstood(error) => write!(f, "the machine sends {error}"),
        }
    }
}

/// What a host is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Nothing sent yet, or the last target is reached.
    Ready,
    /// A target is out, or on its way.
    Waiting {
        /// Least distance from the target so far, counts of the farther axis, and when it was found.
        nearest: u32,
        nearer_at: Duration,
        heard: Duration,
        retries: u8,
    },
    /// No more targets, or too many given up.
    Done,
}

/// Sends the moves of a drawing, one on each `+`, and follows the controller's pulses; sans-IO.
///
/// At each `+` it compares the counted position with the target: in a protocol without checksum this is the
/// only sign of a digit that came wrong. Such a target, and one that is met with silence, is sent again.
///
/// ```
/// # use plotter_motion::{Pen, PenMove, StepPoint, protocol::{Host, HostEvent, HostSettings}};
/// # use core::time::Duration;
/// let dot = PenMove { pen: Pen::Down, target: StepPoint::new(2, 0) };
/// let mut host = Host::new(Duration::from_millis(10), HostSettings::default(), [dot].into_iter());
/// let mut now = Duration::ZERO;
/// assert_eq!(host.poll(now), Some(HostEvent::Begun(dot)));
/// let mut sent = Vec::new();
/// while sent.len() < 10 {
///     sent.extend(host.next_byte(now));
///     now = host.next_wake().unwrap();
/// }
/// assert_eq!(sent, [2, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
/// for pulse in *b"11" {
///     assert_eq!(host.receive(now, pulse), None);
/// }
/// assert_eq!(host.receive(now, b'+'), Some(HostEvent::Reached(dot)));
/// assert_eq!((host.poll(now), host.is_done()), (None, true));
/// ```
#[derive(Clone, Debug)]
pub struct Host<I> {
    settings: HostSettings,
    moves: I,
    sender: Sender,
    state: State,
    current: PenMove,
    position: StepPoint,
    sent: u32,
    reached: u32,
    given_up_in_a_row: u8,
    stays: bool,
}

impl<I: Iterator<Item = PenMove>> Host<I> {
    /// A host with a drawing to send; it pauses for `byte_gap` after each byte (10 ms as published).
    #[must_use]
    pub fn new(byte_gap: Duration, settings: HostSettings, moves: I) -> Self {
        Self {
            settings,
            moves,
            sender: Sender::new(byte_gap),
            state: State::Ready,
            current: PenMove::default(),
            position: StepPoint::default(),
            sent: 0,
            reached: 0,
            given_up_in_a_row: 0,
            stays: false,
        }
    }

    /// The same, which is never done for want of moves: it asks for one at each [`poll`](Self::poll) while
    /// nothing is under way, as a person leads a machine by hand.
    #[must_use]
    pub const fn staying(mut self) -> Self {
        self.stays = true;
        self
    }

    /// The same, of a machine whose motors stand here and not at the origin, encoder counts.
    #[must_use]
    pub const fn standing_at(mut self, position: StepPoint) -> Self {
        self.position = position;
        self
    }

    /// Leads the machine to another target than the one under way, of which no more is said. Says whether it
    /// does: not in the middle of a target's digits, and not to a target that has none.
    pub fn redirect(&mut self, now: Duration, next: PenMove) -> bool {
        if !self.sender.is_idle() || self.sender.start(now, next.target).is_err() {
            return false;
        }
        self.current = next;
        let nearest = self.distance();
        self.state = State::Waiting { nearest, nearer_at: now, heard: now, retries: 0 };
        true
    }

    /// Looks at the clock; call it again at [`next_wake`](Self::next_wake) at the latest. Says what is new:
    /// a move begun, or a notice.
    pub fn poll(&mut self, now: Duration) -> Option<HostEvent> {
        match self.state {
            State::Ready => {
                let Some(next) = self.moves.next() else {
                    if !self.stays {
                        self.state = State::Done;
                    }
                    return None;
                };
                match self.sender.start(now, next.target) {
                    Ok(()) => {
                        self.current = next;
                        self.sent = self.sent.saturating_add(1);
                        let nearest = self.distance();
                        self.state = State::Waiting { nearest, nearer_at: now, heard: now, retries: 0 };
                        Some(HostEvent::Begun(next))
                    }
                    Err(error) => Some(HostEvent::Notice(HostNotice::Refused(error))),
                }
            }
            State::Waiting { nearer_at, heard, retries, .. } => {
                let target = self.current.target;
                if !self.sender.is_idle() {
                    return None;
                }
                let late = now.saturating_sub(nearer_at) > self.settings.patience;
                let silent = now.saturating_sub(heard) > self.settings.silence;
                if late || (silent && retries >= self.settings.most_retries) {
                    return Some(self.give_up());
                }
                silent.then(|| {
                    self.again(now);
                    HostEvent::Notice(HostNotice::Silent { target })
                })
            }
            State::Done => None,
        }
    }

    /// Goes on without this target, or stops after too many.
    fn give_up(&mut self) -> HostEvent {
        self.given_up_in_a_row = self.given_up_in_a_row.saturating_add(1);
        self.state =
            if self.given_up_in_a_row < self.settings.most_given_up { State::Ready } else { State::Done };
        HostEvent::Notice(HostNotice::GaveUp { target: self.current.target, position: self.position })
    }

    /// Sends the target once more.
    fn again(&mut self, now: Duration) {
        // A target that was sent once has digits, so it can be sent again.
        let sent = self.sender.start(now, self.current.target).is_ok();
        let distance = self.distance();
        if let State::Waiting { nearest, nearer_at, heard, retries } = &mut self.state {
            (*nearest, *nearer_at, *heard) = (distance, now, now);
            *retries = retries.saturating_add(u8::from(sent));
        }
    }

    /// Distance from the target, counts of the farther axis.
    fn distance(&self) -> u32 {
        let StepPoint { x, y } = self.current.target;
        x.abs_diff(self.position.x).max(y.abs_diff(self.position.y))
    }

    /// When [`poll`](Self::poll) or [`next_byte`](Self::next_byte) has something to do, unless a byte comes
    /// before.
    #[must_use]
    pub fn next_wake(&self) -> Option<Duration> {
        const TICK: Duration = Duration::from_micros(1); // limits are exceeded one tick after they are met
        let patience = match self.state {
            State::Ready if self.stays => None, // whoever has a move polls it
            State::Ready => Some(Duration::ZERO),
            State::Waiting { nearer_at, heard, .. } if self.sender.is_idle() => {
                let late = nearer_at.saturating_add(self.settings.patience);
                let silent = heard.saturating_add(self.settings.silence);
                Some(late.min(silent).saturating_add(TICK))
            }
            State::Waiting { .. } | State::Done => None,
        };
        match (patience, self.sender.next_byte_at()) {
            (Some(a), Some(b)) => Some(a.min(b)),
            (a, b) => a.or(b),
        }
    }

    /// The next byte for the line, if it is time for one.
    #[must_use]
    pub fn next_byte(&mut self, now: Duration) -> Option<u8> {
        let byte = self.sender.next_byte(now)?;
        if let State::Waiting { nearer_at, heard, .. } = &mut self.state {
            // the controller can neither answer nor move before it has the whole target
            (*nearer_at, *heard) = (now, now);
        }
        Some(byte)
    }

    /// Takes a byte from the controller.
    pub fn receive(&mut self, now: Duration, byte: u8) -> Option<HostEvent> {
        if let State::Waiting { heard, .. } = &mut self.state {
            *heard = now;
        }
        let Some(reply) = Reply::from_byte(byte) else {
            return Some(HostEvent::Notice(HostNotice::Unknown { byte }));
        };
        match reply {
            Reply::Pulse(axis, direction) => self.count(now, axis, direction),
            Reply::Clear => self.position = StepPoint::default(),
            Reply::Stopped => return Some(HostEvent::Notice(HostNotice::Stopped)),
            Reply::GoesOn => return Some(HostEvent::Notice(HostNotice::GoesOn)),
            Reply::Reached => {
                let State::Waiting { retries, .. } = self.state else {
                    return None;
                };
                if !self.sender.is_idle() {
                    return None; // an answer to something else: this target is not even out
                }
                let target = self.current.target;
                let off = |a: i32, b: i32| a.abs_diff(b) > self.settings.tolerance_counts;
                if off(self.position.x, target.x) || off(self.position.y, target.y) {
                    let notice = HostNotice::ReachedElsewhere { target, position: self.position };
                    if retries >= self.settings.most_retries {
                        return Some(self.give_up());
                    }
                    self.again(now);
                    return Some(HostEvent::Notice(notice));
                }
                self.reached = self.reached.saturating_add(1);
                self.given_up_in_a_row = 0;
                self.state = State::Ready;
                return Some(HostEvent::Reached(self.current));
            }
        }
        None
    }

    fn count(&mut self, now: Duration, axis: Axis, direction: Direction) {
        let coordinate = match axis {
            Axis::X => &mut self.position.x,
            Axis::Y => &mut self.position.y,
        };
        *coordinate = coordinate.saturating_add(direction.sign());
        let distance = self.distance();
        if let State::Waiting { nearest, nearer_at, .. } = &mut self.state
            && distance < *nearest
        {
            *nearest = distance;
            *nearer_at = now;
        }
    }

    /// Whether there is nothing more to send, or the host stopped.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.state == State::Done
    }

    /// Where the controller's pulses say the motors are.
    #[must_use]
    pub const fn position(&self) -> StepPoint {
        self.position
    }

    /// Targets sent and targets reached.
    #[must_use]
    pub const fn progress(&self) -> (u32, u32) {
        (self.sent, self.reached)
    }
}

/// Events at the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostEvent {
    /// A move is about to be sent.
    Begun(PenMove),
    /// A move's target is reached.
    Reached(PenMove),
    /// Something is wrong.
    Notice(HostNotice),
}
