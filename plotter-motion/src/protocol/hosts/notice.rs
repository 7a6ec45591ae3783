//! [`MachineNotice`]: what a host of a machine noticed.

use super::HostState;
use crate::Point;
use core::fmt;

/// What a host noticed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MachineNotice {
    /// It does something else now.
    State(HostState),
    /// The machine has greeted.
    Greeted,
    /// Nothing comes from the machine, though it ought to answer.
    Silent,
    /// It is heard again.
    HeardAgain,
    /// The machine was switched off and on, or reset, in the middle of the drawing, before this operation was
    /// carried out.
    Restarted {
        /// The first operation that is not known to be carried out, from 0.
        op: u64,
    },
    /// The machine has refused a line: the drawing pauses.
    Refused {
        /// Of which operation; `None` for what was asked by hand.
        op: Option<u64>,
        /// The machine's code.
        code: u16,
    },
    /// The machine has stopped by itself and is locked.
    Alarm {
        /// Its code.
        code: u16,
    },
    /// An operation that cannot be said in its language: it was left out.
    LeftOut {
        /// Which one, from 0.
        op: u64,
    },
    /// Lines came wrong at the machine, and were sent again.
    SentAgain,
    /// An answer was lost; by what the machine says of itself all is taken.
    AnswerLost,
    /// A line of the machine that means nothing.
    Garbled,
    /// At rest the machine says to be elsewhere than it was led to.
    Elsewhere {
        /// Where it was led, mm.
        wanted: Point,
        /// Where it says to be, mm.
        told: Point,
    },
    /// The machine rests where no operation of the drawing ends that an earlier host may have sent.
    NotResumed {
        /// Where it says to be, mm.
        told: Point,
    },
}

impl fmt::Display for MachineNotice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(state) => match state {
                HostState::Unheard => f.write_str("waiting for the machine"),
                HostState::Ready => f.write_str("the machine is ready"),
                HostState::Drawing => f.write_str("drawing"),
                HostState::Ending => f.write_str("about to lift the pen"),
                HostState::Paused => f.write_str("paused, the pen is lifted"),
                HostState::PenWanted(pen) => write!(f, "pen {pen} is wanted: put it in, then go on"),
                HostState::SheetWanted => f.write_str("a new sheet is wanted: put it in, then go on"),
                HostState::Homing => f.write_str("searching for the limit switches"),
                HostState::Stopped => f.write_str("stopped: unlock the machine to go on"),
                HostState::Locked(0) => f.write_str(
                    "the machine is locked: lead it home, or unlock it if it stands where it says",
                ),
                HostState::Locked(code) => {
                    write!(f, "the machine is locked by alarm {code}")?;
                    remedy(f, grbl_alarm(*code))
                }
                HostState::Done => f.write_str("done, the pen is lifted"),
            },
            Self::Greeted => f.write_str("the machine has greeted"),
            Self::Silent => {
                f.write_str("nothing comes from the machine: is it on, and its cable plugged in?")
            }
            Self::HeardAgain => f.write_str("the machine is heard again"),
            Self::Restarted { op } => write!(
                f,
                "the machine was switched off or reset before operation {op} of the drawing was carried out: lead it \
                 home or say where it stands, then go on"
            ),
            Self::Refused { op: Some(op), code } => {
                write!(f, "the machine refused operation {op} of the drawing with error {code}")?;
                remedy(f, grbl_error(*code))
            }
            Self::Refused { op: None, code } => {
                write!(f, "the machine refused that with error {code}")?;
                remedy(f, grbl_error(*code))
            }
            Self::Alarm { code } => {
                write!(f, "the machine has stopped by itself, alarm {code}")?;
                remedy(f, grbl_alarm(*code))
            }
            Self::LeftOut { op } => {
                write!(f, "operation {op} of the drawing cannot be said to this machine: it was left out")
            }
            Self::SentAgain => f.write_str("a line came wrong at the machine: sent again"),
            Self::AnswerLost => f.write_str("an answer was lost; the machine has taken all lines, it says"),
            Self::Garbled => f.write_str("a line of the machine came wrong"),
            Self::Elsewhere { wanted, told } => write!(
                f,
                "the machine was led to ({:.3}, {:.3}) mm and says to be at ({:.3}, {:.3}) mm: a line came wrong",
                wanted.x, wanted.y, told.x, told.y
            ),
            Self::NotResumed { told } => write!(
                f,
                "the machine rests at ({:.3}, {:.3}) mm, where nothing ends that the last host has sent: it was moved or \
                 reset since; begin anew",
                told.x, told.y
            ),
        }
    }
}

fn remedy(f: &mut fmt::Formatter<'_>, words: &str) -> fmt::Result {
    if words.is_empty() { Ok(()) } else { write!(f, ": {words}") }
}

/// What GRBL's commoner errors ask for (its wiki, "Grbl v1.1 Interface", error messages); from 201 on those
/// of plotters with HPGL ([`Hpgl`](super::Hpgl)).
fn grbl_error(code: u16) -> &'static str {
    match code {
        8 | 9 => "it is locked or busy: unlock it, or wait until it stands",
        10 => "soft limits need homing: switch homing on ($22=1)",
        11 | 14 => "the line is too long for it",
        15 | 33 => "the movement leads outside the machine, or the arc is none: move or scale the drawing",
        20 => "it does not know the word",
        22 => "no speed was set",
        201 => "it does not know an instruction: the text came wrong, or is for a newer plotter",
        202 => "an instruction has the wrong number of parameters: it came wrong, or is for another plotter",
        203 => "a parameter is out of its range: it came wrong, or is for another plotter",
        205 => "it has no such set of characters",
        206 => "a place lies too far outside: scale the drawing",
        208 => "the paper is not held: lower the rollers or load the sheet, then go on",
        210..=215 => "bytes came wrong: look at the cable, at the speed of the line and at its parity",
        216 => "its buffer has overflown and lost bytes: begin the drawing anew",
        24 | 25 | 26 | 31 => "the line came wrong at the machine",
        _ => "",
    }
}

/// What GRBL's alarms mean (its wiki, "Grbl v1.1 Interface", alarm messages); 112 is Marlin's halt.
fn grbl_alarm(code: u16) -> &'static str {
    match code {
        1 => "a limit switch was pressed: free the carriage, then lead it home",
        2 => "the movement leads outside the machine: move or scale the drawing, then unlock",
        3 => "it was reset while it moved, and may have lost its place: lead it home",
        112 => "it has halted: reset it, then lead it home or say where it stands",
        6..=9 => "homing did not find or leave a switch: look at the switches and at the way to them",
        _ => "",
    }
}
