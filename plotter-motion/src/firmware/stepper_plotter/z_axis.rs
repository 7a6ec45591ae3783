//! [`ZAxis`]: a third motor, and how it is homed.

use crate::Direction;
use crate::decimal_text::Whole;
use crate::planner::{PlanError, ZLimits};
use crate::safety::EndSwitches;
use core::fmt;

/// Greatest travel that is taken, mm: as much as of the other two.
const MOST_MM: f64 = 65_535.0;
/// Least travel, mm.
const LEAST_MM: f64 = 0.01;

/// A third axis: a tool that is raised and lowered by a motor of its own. Its heights go from 0, the lowest,
/// to [`ZAxis::travel_mm`]. A machine that is switched on stands at 0, unless it homes.
///
/// The default has a spindle of 8 mm a turn with 3200 steps, 30 mm high, without a switch.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct ZAxis {
    /// Steps of its motor to the millimetre, upwards.
    pub steps_per_mm: f64,
    /// Greatest speed, mm/s.
    pub speed_mm_s: f64,
    /// Greatest acceleration, mm/s².
    pub accel_mm_s2: f64,
    /// From the lowest place to the highest, mm.
    pub travel_mm: f64,
    /// The heights of a pen that this axis lifts: the words that lift a pen
    /// ([`StepperPlotterSettings::pen`](super::StepperPlotterSettings::pen)) move it then. Without them the
    /// words X, Y and Z move the tool, as on a mill: `G0` travels, and all else draws.
    pub pen: Option<ZPen>,
    /// How it is homed: upwards, before the other two. Without it, it is not.
    pub home: Option<ZHoming>,
}

/// The heights of a pen.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ZPen {
    /// Up, mm.
    pub up_mm: f64,
    /// Down, mm.
    pub down_mm: f64,
}

impl Default for ZAxis {
    fn default() -> Self {
        Self {
            steps_per_mm: 400.0,
            speed_mm_s: 10.0,
            accel_mm_s2: 100.0,
            travel_mm: 30.0,
            pen: None,
            home: None,
        }
    }
}

impl ZAxis {
    /// What the planner is told of it.
    pub(super) const fn limits(&self) -> ZLimits {
        let Self { speed_mm_s, accel_mm_s2, steps_per_mm, .. } = *self;
        ZLimits { speed_mm_s, accel_mm_s2, step_mm: 1.0 / steps_per_mm }
    }

    /// `is_there`: whether the controller has a third axis.
    pub(super) const fn check(&self, is_there: bool) -> Result<(), PlanError> {
        const fn within(quantity: &'static str, value: f64, least: f64, most: f64) -> Result<(), PlanError> {
            if value >= least && value <= most {
                Ok(())
            } else {
                Err(PlanError::Setting { quantity, value, least, most })
            }
        }
        if !is_there {
            return Err(PlanError::Mode { quantity: "z" });
        }
        if let Err(error) = self.limits().check() {
            return Err(error);
        }
        if let Err(error) = within("z.travel_mm", self.travel_mm, LEAST_MM, MOST_MM) {
            return Err(error);
        }
        let Some(ZPen { up_mm, down_mm }) = self.pen else { return Ok(()) };
        match within("z.pen.up_mm", up_mm, 0.0, self.travel_mm) {
            Ok(()) => within("z.pen.down_mm", down_mm, 0.0, self.travel_mm),
            error => error,
        }
    }

    /// Steps from the lowest place.
    pub(super) fn steps_at(&self, height_mm: f64) -> i32 {
        crate::toolpath::from_mm(height_mm, self.steps_per_mm)
    }

    /// The height at so many steps, mm.
    pub(super) fn height_at(&self, steps: i32) -> f64 {
        f64::from(steps) / self.steps_per_mm
    }
}

/// How a third axis is homed: up to its upper switch, at a rate from which it may stop at once.
///
/// The default is that of [`ZAxis`]: 5 and 1 mm/s, 1 mm off the switch, 2 mm for it to open, 40 mm at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct ZHoming {
    /// Rate at which the motor may start and stop at once, pulses/s.
    pub start_hz: u32,
    /// Rate at which the switch is touched, pulses/s.
    pub slow_hz: u32,
    /// From the switch to the highest place, steps; at least 1.
    pub pull_off_steps: u32,
    /// Within how many steps the switch must open when it is left.
    pub release_steps: u32,
    /// A switch that has not come within so many steps is missing.
    pub most_steps: u32,
}

impl Default for ZHoming {
    fn default() -> Self {
        Self { start_hz: 2_000, slow_hz: 400, pull_off_steps: 400, release_steps: 800, most_steps: 16_000 }
    }
}

/// Why a third axis was not homed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ZHomingError {
    /// Its upper switch did not come.
    Missing {
        /// How many steps were made towards it.
        steps: u32,
    },
    /// Its upper switch stayed pressed while it was left.
    Stuck {
        /// How many steps were made away from it.
        steps: u32,
    },
    /// Its lower switch came on the way up, or did not open.
    Wrong,
}

impl fmt::Display for ZHomingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Missing { steps } => write!(
                f,
                "axis z: the upper limit switch did not come within {} steps; check its wire, and whether the \
                 motor turns at all",
                Whole(steps.into())
            ),
            Self::Stuck { steps } => write!(
                f,
                "axis z: the upper limit switch is still pressed {} steps off it; check whether it sticks, and \
                 whether the motor turns the right way",
                Whole(steps.into())
            ),
            Self::Wrong => f.write_str(
                "axis z: the lower limit switch was pressed on the way up; check whether it sticks, and whether \
                 the motor turns the right way",
            ),
        }
    }
}

impl core::error::Error for ZHomingError {}

/// How far its homing has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct ZHomingProgress {
    phase: Phase,
    /// Steps made in this phase, and after how many the switch that it leaves has opened.
    taken: u32,
    opened: Option<u32>,
    /// Steps upwards since the start.
    risen: i32,
    wanted: Option<Direction>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    #[default]
    Start,
    /// Up to the switch.
    Seek,
    /// Down off it, and some way farther.
    Leave,
    /// Up to it once more, slowly.
    Touch,
    /// Down to the highest place.
    PullOff,
}

/// What homing wants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ZHomingStatus {
    /// A step.
    Step { direction: Direction, rate_hz: u32 },
    /// Nothing: it stands at its highest place, and has risen by so many steps in all.
    Done { risen: i32 },
}

impl ZHomingProgress {
    /// What is wanted, with the switches as they are now.
    pub(super) fn update(
        &mut self,
        settings: &ZHoming,
        switches: EndSwitches,
    ) -> Result<ZHomingStatus, ZHomingError> {
        let pull_off_steps = settings.pull_off_steps.max(1);
        let (start_hz, slow_hz) = (settings.start_hz.max(1), settings.slow_hz.max(1));
        // Ends: every phase wants a step, fails, or is followed by one that wants a step.
        loop {
            let (direction, rate_hz) = match self.phase {
                Phase::Start => {
                    self.enter(if switches.upper { Phase::Leave } else { Phase::Seek });
                    continue;
                }
                Phase::Seek if switches.upper => {
                    self.enter(Phase::Leave);
                    continue;
                }
                Phase::Touch if switches.upper => {
                    self.enter(Phase::PullOff);
                    continue;
                }
                Phase::Seek => {
                    self.leave_lower(settings, switches)?;
                    self.within(settings.most_steps)?;
                    (Direction::Plus, start_hz)
                }
                Phase::Touch => {
                    self.within(pull_off_steps.saturating_add(settings.release_steps))?;
                    (Direction::Plus, slow_hz)
                }
                Phase::Leave | Phase::PullOff => {
                    self.leave_upper(settings, switches)?;
                    match (self.phase, self.opened) {
                        (Phase::Leave, Some(opened)) if self.taken - opened >= pull_off_steps => {
                            self.enter(Phase::Touch);
                            continue;
                        }
                        (Phase::PullOff, Some(_)) if self.taken >= pull_off_steps => {
                            return Ok(ZHomingStatus::Done { risen: self.risen });
                        }
                        _ => (Direction::Minus, slow_hz),
                    }
                }
            };
            self.wanted = Some(direction);
            return Ok(ZHomingStatus::Step { direction, rate_hz });
        }
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.taken, self.opened) = (phase, 0, None);
    }

    /// On the way up a lower switch opens soon, and then stays open.
    fn leave_lower(&mut self, settings: &ZHoming, switches: EndSwitches) -> Result<(), ZHomingError> {
        if !switches.lower {
            self.opened = self.opened.or(Some(self.taken));
        } else if self.opened.is_some_and(|opened| opened == 0) || self.taken >= settings.release_steps {
            return Err(ZHomingError::Wrong);
        }
        Ok(())
    }

    /// On the way down the upper switch opens soon; a contact may bounce.
    fn leave_upper(&mut self, settings: &ZHoming, switches: EndSwitches) -> Result<(), ZHomingError> {
        if !switches.upper {
            self.opened = self.opened.or(Some(self.taken));
        } else if self.taken >= settings.release_steps {
            return Err(ZHomingError::Stuck { steps: self.taken });
        } else {
            self.opened = None;
        }
        Ok(())
    }

    fn within(&self, most_steps: u32) -> Result<(), ZHomingError> {
        if self.taken < most_steps { Ok(()) } else { Err(ZHomingError::Missing { steps: self.taken }) }
    }

    /// The step that was wanted has been made.
    pub(super) fn made(&mut self) {
        if let Some(direction) = self.wanted.take() {
            self.taken = self.taken.saturating_add(1);
            self.risen = self.risen.saturating_add(direction.sign());
        }
    }
}
