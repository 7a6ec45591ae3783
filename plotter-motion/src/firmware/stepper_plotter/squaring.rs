//! [`SecondMotor`]: two motors on one axis, and how they are made square.
//!
//! ```text
//!   first   ◀━━━━━━━━━━━━━┃        both seek; each stops at its own switch, the other one goes on
//!   second  ◀━━━━━━━━━━━━━━━━━┃    so the gantry comes to stand as the switches do
//!           off them together ──▶, ◀── touch slowly, each its own; by the offset off: square
//! ```

use crate::Axis;
use crate::decimal_text::{Plain, Whole};
use crate::safety::EndSwitches;
use core::fmt;

/// A second motor of an axis: of a gantry that one alone would rack. It makes every step of the first, and
/// has limit switches of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SecondMotor {
    /// Of which axis.
    pub axis: Axis,
    /// By how many steps the second motor leaves its lower switch farther than the first, so that the gantry
    /// is square: what the switches are out of square. Below 0 it is the first that does.
    pub offset_steps: i32,
    /// How many steps one motor may go on alone; with more something else is wrong, and nothing is bent
    /// farther.
    pub most_skew_steps: u32,
}

/// Why two motors were not made square.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SquaringError {
    /// Neither switch came.
    Missing {
        /// Of which axis.
        axis: Axis,
        /// How many steps were made towards them.
        steps: u32,
    },
    /// One switch came and the other did not.
    Skewed {
        /// Of which axis.
        axis: Axis,
        /// Whether it is the second motor that did not come to its switch.
        second: bool,
        /// How many steps that motor went on alone.
        steps: u32,
    },
    /// A switch stayed pressed while both motors left theirs.
    Stuck {
        /// Of which axis.
        axis: Axis,
        /// Whether it is that of the second motor.
        second: bool,
        /// How many steps were made away from it.
        steps: u32,
    },
}

impl fmt::Display for SquaringError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |axis: Axis| Plain(if axis == Axis::X { "x" } else { "y" });
        let which = |second: bool| Plain(if second { "second" } else { "first" });
        match *self {
            Self::Missing { axis, steps } => write!(
                f,
                "axis {}: neither lower limit switch came within {} steps; check their wires, and whether the \
                 motors turn at all",
                name(axis),
                Whole(steps.into())
            ),
            Self::Skewed { axis, second, steps } => write!(
                f,
                "axis {}: the {} motor did not come to its lower limit switch within {} steps alone; check \
                 whether it turns, and the wire of the switch",
                name(axis),
                which(second),
                Whole(steps.into())
            ),
            Self::Stuck { axis, second, steps } => write!(
                f,
                "axis {}: the lower limit switch of the {} motor is still pressed {} steps off it; check whether \
                 it sticks",
                name(axis),
                which(second),
                Whole(steps.into())
            ),
        }
    }
}

impl core::error::Error for SquaringError {}

/// How far squaring has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SquaringProgress {
    phase: Phase,
    /// Steps made in this phase, and how many of them by one motor alone.
    taken: u32,
    alone: u32,
    /// After how many both switches have opened.
    opened: Option<u32>,
    /// How much farther the second motor went than the first.
    skew: i32,
    wanted: Option<[i8; 2]>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// Down, each to its own switch.
    #[default]
    Seek,
    /// Up, both off theirs.
    Leave,
    /// Down once more, slowly.
    Touch,
    /// One of them up by the offset.
    Offset,
}

/// What squaring wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SquaringStatus {
    /// A step of the first motor, of the second, or of both.
    Step { ways: [i8; 2], rate_hz: u32 },
    /// Nothing. The second motor has gone so many steps farther than the first, to their switches.
    Done { skew_steps: i32 },
}

/// What is to be known of the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct SquaringAxis {
    pub(super) second: SecondMotor,
    pub(super) start_hz: u32,
    pub(super) slow_hz: u32,
    pub(super) pull_off_steps: u32,
    pub(super) release_steps: u32,
    pub(super) most_steps: u32,
}

impl SquaringProgress {
    /// What is wanted, with the switches of both motors as they are now.
    pub(super) fn update(
        &mut self,
        settings: &SquaringAxis,
        [first, second]: [EndSwitches; 2],
    ) -> Result<SquaringStatus, SquaringError> {
        let axis = settings.second.axis;
        // Ends: every phase wants a step, fails, or is followed by one that wants a step.
        loop {
            let rate_hz = if self.phase == Phase::Seek { settings.start_hz } else { settings.slow_hz }.max(1);
            let ways = match self.phase {
                Phase::Seek | Phase::Touch => match (first.lower, second.lower) {
                    (true, true) => {
                        self.enter(if self.phase == Phase::Seek { Phase::Leave } else { Phase::Offset });
                        continue;
                    }
                    (false, false) => {
                        if self.taken >= settings.most_steps {
                            return Err(SquaringError::Missing { axis, steps: self.taken });
                        }
                        [-1, -1]
                    }
                    (at_first, _) => {
                        if self.alone >= settings.second.most_skew_steps {
                            let steps = self.alone;
                            return Err(SquaringError::Skewed { axis, second: at_first, steps });
                        }
                        if at_first { [0, -1] } else { [-1, 0] }
                    }
                },
                Phase::Leave => {
                    if first.lower || second.lower {
                        if self.taken >= settings.release_steps {
                            let (second, steps) = (second.lower, self.taken);
                            return Err(SquaringError::Stuck { axis, second, steps });
                        }
                        self.opened = None;
                    } else if self.taken - *self.opened.get_or_insert(self.taken) >= settings.pull_off_steps {
                        self.enter(Phase::Touch);
                        continue;
                    }
                    [1, 1]
                }
                Phase::Offset => {
                    let offset = settings.second.offset_steps;
                    if self.taken >= offset.unsigned_abs() {
                        return Ok(SquaringStatus::Done { skew_steps: self.skew });
                    }
                    if offset > 0 { [0, 1] } else { [1, 0] }
                }
            };
            self.wanted = Some(ways);
            return Ok(SquaringStatus::Step { ways, rate_hz });
        }
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.taken, self.alone, self.opened) = (phase, 0, 0, None);
    }

    /// The step that was wanted has been made.
    pub(super) fn made(&mut self) {
        let Some([first, second]) = self.wanted.take() else { return };
        self.taken = self.taken.saturating_add(1);
        if first != second {
            self.alone = self.alone.saturating_add(1);
            // Downwards, as the switches were met.
            if matches!(self.phase, Phase::Seek | Phase::Touch) {
                self.skew = self.skew.saturating_add(i32::from(first - second));
            }
        }
    }
}
