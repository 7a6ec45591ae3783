//! [`TuningError`]: why there are no gains.

use core::fmt;

/// Why an experiment gave no model, or a rule no gains. Each says what to look at.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TuningError {
    /// The encoder counted nothing under the greatest allowed duty.
    MotorDoesNotTurn {
        /// The duty, 0 to 1.
        duty: f64,
    },
    /// The encoder counted backwards under a forward duty.
    EncoderReversed {
        /// The counts.
        counts: i32,
    },
    /// Within the allowed travel there are too few counts, or too little time, to see the motor's speed settle.
    TooLittleTravel {
        /// The allowed travel to either side, counts.
        travel_counts: i32,
    },
    /// The motor did not come to a steady speed, or not to rest.
    NeverSettles {
        /// After so long, s.
        after_s: f64,
    },
    /// The axis went farther than it was allowed to.
    LeftTravel {
        /// Where it was, counts from its start.
        counts: i32,
    },
    /// The motor stopped counting in the middle of a run: something holds it, or the encoder's wire is loose.
    Stalled {
        /// Where it was, counts from its start.
        counts: i32,
    },
    /// Under the relay the axis did not swing evenly.
    DoesNotSwing {
        /// After so long, s.
        after_s: f64,
    },
    /// The measurement does not look like a motor: no lag or dead time makes a curve like it.
    NotAMotor,
    /// No gains of this rule reach the margin.
    MarginOutOfReach {
        /// The margin asked for, in the rule's own terms: a sensitivity, or a phase margin in degrees.
        asked: f64,
        /// The best that was found.
        best: f64,
    },
}

impl fmt::Display for TuningError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::MotorDoesNotTurn { duty } => {
                write!(
                    f,
                    "the motor does not turn at {:.0} % duty; check supply, wires, brake and encoder",
                    100.0 * duty
                )
            }
            Self::EncoderReversed { counts } => {
                write!(
                    f,
                    "the encoder counted {counts} while the motor was driven forwards; swap the motor's wires or the \
                     encoder's phases"
                )
            }
            Self::TooLittleTravel { travel_counts } => {
                write!(
                    f,
                    "{travel_counts} counts to either side are too little to see a steady speed; allow more travel, or count \
                     finer"
                )
            }
            Self::NeverSettles { after_s } => {
                write!(
                    f,
                    "the speed has not settled after {after_s:.1} s; something pushes or holds the axis"
                )
            }
            Self::LeftTravel { counts } => {
                write!(f, "the axis is at {counts} counts, beyond its allowed travel; start from the middle")
            }
            Self::Stalled { counts } => {
                write!(f, "the axis stopped at {counts} counts while it was driven; something holds it")
            }
            Self::DoesNotSwing { after_s } => {
                write!(f, "no even swing after {after_s:.1} s; more duty or more hysteresis may help")
            }
            Self::NotAMotor => write!(f, "the measured curve is not that of a motor with an encoder"),
            Self::MarginOutOfReach { asked, best } => {
                write!(
                    f,
                    "a margin of {asked} is out of reach, the best is {best:.2}; ask for less or run the loop more often"
                )
            }
        }
    }
}

impl core::error::Error for TuningError {}
