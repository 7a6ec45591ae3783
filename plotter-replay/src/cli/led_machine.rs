//! [`LedMachine`]: a machine that another part of the program leads, step by step.

pub use super::live_hosted::Protocol;
use super::live_hosted::{lines_by_hand, protocol_of};
use super::live_targets::targets_by_hand;
use super::machine::{header_of, lines_header};
use crate::live::{Command, Hand, Recording, Session, State};
use crate::log::{self, LogFile};
use core::fmt;
use core::time::Duration;
use plotter_motion::config::MachineKind;
use plotter_motion::protocol::hosts::{MachineNotice, NotNow};
use plotter_motion::{Machine, Point};
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// So long a machine has, by the clock, to be heard first: a board that was reset greets within seconds.
const HEARD_WITHIN: Duration = Duration::from_secs(30);
/// So long it has for one step, by the clock: the longest way of a large machine takes minutes.
const ARRIVES_WITHIN: Duration = Duration::from_secs(600);
/// How often it is looked whether it has arrived.
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// Which machine.
#[derive(Clone, Copy, Debug)]
pub struct LedPort<'a> {
    /// Its port; `None` for one that is simulated in this program.
    pub port: Option<&'a str>,
    /// What a machine with stepper motors speaks.
    pub protocol: Protocol,
    /// Seconds of a simulated machine in one of ours.
    pub speed: f64,
    /// Where its recording goes.
    pub log: &'a Path,
}

/// A machine that is led from place to place, and says when it has arrived.
#[derive(Debug)]
pub struct LedMachine {
    session: Session,
    name: String,
    /// What was said of it last before it was led. What greets after that has forgotten where it is, though it
    /// may have stood between two ways when it did.
    said_before: Option<(Duration, String)>,
}

/// Why a machine did not go where it was led.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LedError {
    /// It was never heard.
    Unheard {
        /// What was said of it last.
        said: String,
    },
    /// It refused, in these words.
    Refused {
        /// Why.
        why: String,
    },
    /// Somebody has stopped it, or it has locked itself.
    Stopped {
        /// What it says.
        said: String,
    },
    /// Nothing comes from it any more.
    Silent,
    /// It was reset, or switched off and on, on its way: where it is is not known.
    Restarted,
    /// It does not say that it is there.
    NotArrived {
        /// Where it says to be, mm, in words.
        at: String,
    },
    /// Its line failed.
    Failed {
        /// Why.
        why: String,
    },
}

impl fmt::Display for LedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unheard { said } => {
                write!(f, "the machine is not heard: is it on, and its cable plugged in? {said}")
            }
            Self::Refused { why } => write!(f, "the machine was not led on: {why}"),
            Self::Stopped { said } => write!(f, "the machine was stopped: {said}"),
            Self::Silent => write!(f, "{}", MachineNotice::Silent),
            Self::Restarted => f.write_str(
                "the machine was switched off or reset on its way: lead it home, or say where it stands, then begin anew",
            ),
            Self::NotArrived { at } => write!(f, "the machine does not arrive: it says to be at {at} mm"),
            Self::Failed { why } => f.write_str(why),
        }
    }
}

impl core::error::Error for LedError {}

impl LedMachine {
    /// Opens the machine and waits until it is heard; nothing moves. What is said of it goes to `out`.
    ///
    /// # Errors
    ///
    /// The port's, the recording's, or that no machine is heard.
    pub fn open(machine: &Machine, led: LedPort<'_>, out: &mut impl Write) -> Result<Self, String> {
        let recording = |header| {
            log::create(led.log, &header)
                .map(Recording::<LogFile>::Line)
                .map_err(|error| format!("{}: {error}", led.log.display()))
        };
        let (session, name) = if machine.kind() == MachineKind::Steppers {
            let lines = lines_by_hand(machine, led.port, led.protocol, led.speed, out)?;
            let recording = recording(lines_header(machine, protocol_of(lines.tongue)))?;
            (Session::hosted(lines.line, lines.host, None, Some(recording), lines.settings), lines.name)
        } else {
            let targets = targets_by_hand(machine, led.port, led.speed)?;
            let protocol = if machine.kind() == MachineKind::Belt { "digits" } else { "link" };
            let recording = recording(header_of(machine, protocol, None))?;
            (Session::open(targets.line, None, Some(recording), None, targets.settings), targets.name)
        };
        let mut led = Self { session, name, said_before: None };
        let until = Instant::now() + HEARD_WITHIN;
        while led.session.state() == State::Connecting {
            if Instant::now() >= until {
                let said = led.said();
                return Err(LedError::Unheard { said }.to_string());
            }
            std::thread::sleep(LOOK_EVERY);
        }
        led.said_before = led.session.messages().pop();
        Ok(led)
    }

    /// Its port.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its session, to be watched and stopped.
    #[must_use]
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// Goes to a place with the pen lifted; where the machine then says to be.
    ///
    /// # Errors
    ///
    /// [`LedError`]: it is not there.
    pub fn go(&self, to: Point) -> Result<Point, LedError> {
        self.lead(Hand::GoTo(to))
    }

    /// Draws a line to a place; the pen stays lowered. Where the machine then says to be.
    ///
    /// # Errors
    ///
    /// [`LedError`]: it is not there.
    pub fn draw(&self, to: Point, speed_mm_s: f64) -> Result<Point, LedError> {
        self.lead(Hand::DrawTo(to, speed_mm_s))
    }

    /// Draws lines through these places with the pen down, at one go as far as the machine's buffer allows,
    /// and lifts it at their end, where the machine then says to be.
    ///
    /// # Errors
    ///
    /// [`LedError`]: it is not there.
    pub fn draw_through(&self, places: &[Point], speed_mm_s: f64) -> Result<Point, LedError> {
        let mut last = None;
        for &to in places {
            self.ask(Hand::DrawTo(to, speed_mm_s), false)?;
            last = Some(to);
        }
        match last {
            Some(to) => self.go(to),
            None => Ok(self.session.by_hand().at),
        }
    }

    /// Stops it at once, where its language has a word for that; nothing more is sent in any case.
    pub fn stop(&self) {
        self.session.command(Command::Stop);
    }

    fn said(&self) -> String {
        self.session.messages().pop().map_or_else(String::new, |(_, words)| words)
    }

    /// Leads it, and waits until it says that it is there.
    fn lead(&self, hand: Hand) -> Result<Point, LedError> {
        self.ask(hand, true)
    }

    /// Asks for something by hand, and waits until that is taken, or until the machine rests behind it; where
    /// it says to be.
    fn ask(&self, hand: Hand, until_it_rests: bool) -> Result<Point, LedError> {
        let until = Instant::now() + ARRIVES_WITHIN;
        let mut before = self.session.by_hand().taken;
        let known = self.session.messages().pop();
        self.session.command(Command::Hand(hand));
        loop {
            match self.session.state() {
                State::Failed(why) => return Err(LedError::Failed { why }),
                State::Stopped | State::Locked => return Err(LedError::Stopped { said: self.said() }),
                _ => {}
            }
            let said = self.session.messages();
            let is_said = |notice: MachineNotice, known: &Option<(Duration, String)>| {
                let words = notice.to_string();
                said.iter().rev().take_while(|said| Some(*said) != known.as_ref()).any(|said| said.1 == words)
            };
            if is_said(MachineNotice::Silent, &known) {
                return Err(LedError::Silent);
            }
            if is_said(MachineNotice::Greeted, &self.said_before) {
                return Err(LedError::Restarted);
            }
            let now = self.session.by_hand();
            if now.taken > before {
                match now.refused {
                    // A board that still has enough to do takes it later.
                    Some(why) if why == NotNow::Busy.to_string() => {
                        before = now.taken;
                        self.session.command(Command::Hand(hand));
                    }
                    Some(why) => return Err(LedError::Refused { why }),
                    None if now.rests || !until_it_rests => return Ok(now.at),
                    None => {}
                }
            }
            if Instant::now() >= until {
                let at = format!("({:.3}, {:.3})", now.at.x, now.at.y);
                return Err(LedError::NotArrived { at });
            }
            std::thread::sleep(LOOK_EVERY);
        }
    }
}
