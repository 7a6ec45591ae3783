//! Anomalies: records of a log that do not fit the protocol or each other.

use crate::import::Side;
use core::fmt;
use core::time::Duration;
use plotter_motion::StepPoint;

/// Something in a log that does not fit, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Anomaly {
    /// When.
    pub time: Duration,
    /// What.
    pub kind: AnomalyKind,
}

/// Kinds of anomalies.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum AnomalyKind {
    /// A host byte that is no digit (0 to 9); skipped.
    NotADigit {
        /// The byte.
        byte: u8,
    },
    /// A controller byte that says nothing in this protocol; skipped.
    UnknownReply {
        /// The byte.
        byte: u8,
    },
    /// The log begins inside a target: its last digits were dropped.
    BeganInsideTarget {
        /// How many digits.
        digits: usize,
    },
    /// The host fell silent inside a target: its first digits were dropped.
    SilenceInsideTarget {
        /// How long.
        silence: Duration,
        /// How many digits.
        digits: usize,
    },
    /// The controller reached a target of which the log has some digits only: they were dropped.
    ReachedInsideTarget {
        /// How many digits.
        digits: usize,
    },
    /// The log ends inside a target.
    PartialTargetAtEnd {
        /// Digits of the target so far, in the order sent.
        digits: Vec<u8>,
    },
    /// The host sent further targets before the present one was reached.
    ExtraTargets {
        /// How many more than one.
        count: u64,
    },
    /// The controller says that it reached a target, and none was sent.
    ReachedNothing,
    /// The pulses do not lead to the target that the controller says it reached: bytes were lost or misread.
    ReachedElsewhere {
        /// Where the pulses lead, counted from the last reached target, minus the target.
        off: StepPoint,
    },
    /// The line was silent with a target under way.
    Silence {
        /// How long.
        silence: Duration,
    },
    /// The controller took another target than the host sent.
    TargetDiffers {
        /// Sent.
        sent: StepPoint,
        /// Taken.
        taken: StepPoint,
    },
    /// A frame of the reliable link came damaged, or of a session that began before the log; who sent it,
    /// sends it again.
    DamagedFrame {
        /// Who.
        side: Side,
    },
    /// Frames of the reliable link came, and are not in the log: what they said is not known.
    FramesMissing {
        /// How many; 0 if only that makes sense of what came.
        count: u64,
    },
    /// The machine refused a target that lies outside its area.
    Refused {
        /// The target.
        target: StepPoint,
    },
    /// A target that is not in the given drawing; its way is drawn.
    NotInDrawing {
        /// The target.
        target: StepPoint,
    },
    /// The machine has refused a line.
    LineRefused {
        /// The line.
        line: String,
        /// The number of its error; 0 where it has none.
        code: u16,
    },
    /// The machine has taken a line that says nothing known here: what it draws is missing.
    LineNotUnderstood {
        /// The line.
        line: String,
    },
    /// The machine says to be elsewhere than its lines lead.
    ReportedElsewhere {
        /// Where it says to be, minus where it should be.
        off: StepPoint,
    },
    /// The machine has raised an alarm.
    Alarm {
        /// Its number.
        number: u16,
    },
    /// The log ends before lines were answered: they are not drawn.
    Unanswered {
        /// How many.
        lines: u64,
    },
    /// The machine was on its way when it was heard last: what comes after that is not drawn.
    NotKnownDrawn {
        /// How many moves.
        moves: u64,
    },
    /// The path is longer than what is kept; from here on only positions are counted.
    PathTooLong,
}

impl fmt::Display for Anomaly {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} us: {}", self.time.as_micros(), self.kind)
    }
}

impl fmt::Display for AnomalyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotADigit { byte } => write!(f, "host byte 0x{byte:02x} is no digit: skipped"),
            Self::UnknownReply { byte } => write!(f, "controller byte 0x{byte:02x} says nothing: skipped"),
            Self::BeganInsideTarget { digits } => {
                write!(f, "the log begins inside a target: dropped its last {digits} digits")
            }
            Self::SilenceInsideTarget { silence, digits } => write!(
                f,
                "host silent for {} ms inside a target: dropped its first {digits} digits",
                silence.as_millis()
            ),
            Self::ReachedInsideTarget { digits } => {
                write!(f, "target reached of which the log has only {digits} of 10 digits: dropped them")
            }
            Self::PartialTargetAtEnd { digits } => {
                write!(f, "the log ends inside a target, after {} of 10 digits", digits.len())
            }
            Self::ExtraTargets { count } => {
                write!(f, "{count} further target(s) sent before the controller reached the one before")
            }
            Self::ReachedNothing => write!(f, "target reached, but none was sent"),
            Self::ReachedElsewhere { off } => write!(
                f,
                "target reached, but the pulses lead ({}, {}) counts beside it: bytes were lost or a digit misread",
                off.x, off.y
            ),
            Self::Silence { silence } => {
                write!(f, "no byte for {} ms with a target under way", silence.as_millis())
            }
            Self::TargetDiffers { sent, taken } => write!(
                f,
                "the host sent target ({}, {}), the controller took ({}, {})",
                sent.x, sent.y, taken.x, taken.y
            ),
            Self::DamagedFrame { side: Side::Host } => f.write_str("a frame of the host came damaged"),
            Self::DamagedFrame { side: Side::Controller } => {
                f.write_str("a frame of the controller came damaged")
            }
            Self::FramesMissing { count: 0 } => {
                f.write_str("frames are missing in the log: what came makes no sense")
            }
            Self::FramesMissing { count } => write!(f, "{count} frame(s) came that are not in the log"),
            Self::Refused { target } => {
                write!(f, "target ({}, {}) was refused: outside the machine's area", target.x, target.y)
            }
            Self::NotInDrawing { target } => {
                write!(f, "target ({}, {}) is not in the drawing: its way is drawn", target.x, target.y)
            }
            Self::LineRefused { line, code: 0 } => write!(f, "line {line:?} was refused"),
            Self::LineRefused { line, code } => write!(f, "line {line:?} was refused: error {code}"),
            Self::LineNotUnderstood { line } => {
                write!(f, "line {line:?} was taken and is not understood here: what it draws is missing")
            }
            Self::ReportedElsewhere { off } => {
                write!(f, "the machine says to be ({}, {}) steps beside where its lines lead", off.x, off.y)
            }
            Self::Alarm { number } => write!(f, "the machine raised alarm {number}"),
            Self::Unanswered { lines } => write!(f, "{lines} line(s) without an answer: not drawn"),
            Self::NotKnownDrawn { moves } => write!(
                f,
                "{moves} move(s) were taken, and the machine was on its way to them when it was heard last: not drawn"
            ),
            Self::PathTooLong => {
                write!(f, "the path is too long to keep: from here only positions are counted")
            }
        }
    }
}
