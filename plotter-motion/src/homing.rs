//! [`Homing`]: finds both ends of both axes by their limit switches, and the steps between them.
//!
//! ```text
//!   lower switch                                                     upper switch
//!      ◀━━━━━━━━━━━━━━━━━━━━━━━━━ seek ━━━━━━━━━━━━━━━━ o             at the rate that may start and stop at once
//!      ┃──▶ off it, ◀── touch it slowly: count 0                     as far as the origin will be from it
//!      ┃━━━━━━━━━━━━━━━━━━━━ seek, fast ━━━━━━━━━━━━━━━━▶ slowly ──▶┃  fast only where the axis is known to go on
//!      ┃                                    off it ◀──, touch it ──▶┃  the count is the length
//!      ┃  0 ◀━━━━━━━━━━━━━━━━━━━ back to the origin ━━━━━━━━━━━━━━━━┃
//! ```
//!
//! x first, then y. It owns no motor: it says which step it wants ([`Homing::update`]) and is told when it
//! was made ([`Homing::made`]). No step is asked for into a pressed switch. A motor that stops at once from a
//! high rate loses steps, so a switch is only ever met at a rate that may be started and stopped at once. The
//! carriage moves fast for as long as the axis is known to go on, and slowly after that. Source: Dounaev and
//! Phan, "X-Y Plotter Project", section 2.2.3.3.

use crate::config::SteppersConfig;
use crate::decimal_text::{Plain, Whole};
use crate::{Axis, Direction, LimitSwitches, Machine, StepPair, config::StepperConfig};
use core::fmt;

/// How one axis is homed. Rates are pulses a second, lengths steps of the motor.
///
/// The default is an axis of the documented stepper plotter: more than 26,000 steps long, fast below 24,000.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct HomingAxis {
    /// Rate at which the motor may start and stop at once, pulses/s.
    pub start_hz: u32,
    /// Greatest rate, reached by acceleration where the way is known, pulses/s.
    pub fast_hz: u32,
    /// Rate at which a switch is touched, pulses/s; `start_hz` where that is less.
    pub slow_hz: u32,
    /// Acceleration, pulses/s^2.
    pub accel_hz_s: u32,
    /// From the lower switch to the origin; and how far it goes off a switch before touching it again. At
    /// least 1.
    pub pull_off_steps: u32,
    /// Within how many steps a switch must open when it is left.
    pub release_steps: u32,
    /// How long the axis is known to be at least: from an earlier homing, or by construction; 0 if not at
    /// all. On the way to the upper switch it is fast up to here, so leave a little; if the switch comes
    /// before, the axis is homed once more without.
    pub known_steps: u32,
    /// How long it may be at most: a switch that has not come by then is missing.
    pub most_steps: u32,
}

impl Default for HomingAxis {
    fn default() -> Self {
        Self {
            start_hz: 2_000,
            fast_hz: 8_000,
            slow_hz: 1_000,
            accel_hz_s: 21_818, // 2000 to 8000 pulses/s within half of 2750 steps
            pull_off_steps: 88, // 1 mm
            release_steps: 438, // 5 mm
            known_steps: 24_000,
            most_steps: 40_000,
        }
    }
}

impl HomingAxis {
    /// An axis of a checked machine with stepper motors; rates and lengths in whole pulses, rounded down.
    ///
    /// ```
    /// # use plotter_motion::{Axis, Machine, MachineConfig, homing::HomingAxis};
    /// let x = HomingAxis::of(&Machine::new(MachineConfig::stepper_plotter())?, Axis::X);
    /// assert_eq!((x.start_hz, x.fast_hz, x.known_steps), (2_000, 8_000, 23_996)); // 274 mm of 87.58 steps
    /// # Ok::<(), plotter_motion::ConfigError>(())
    /// ```
    #[must_use]
    pub fn of(machine: &Machine, axis: Axis) -> Self {
        let config = SteppersConfig::of(machine);
        let StepperConfig { steps_per_mm, start_rate_hz, .. } = match axis {
            Axis::X => config.x,
            Axis::Y => config.y,
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let whole = |value: f64| value as u32;
        let steps = |mm: f64| whole(mm * steps_per_mm);
        Self {
            start_hz: whole(start_rate_hz),
            fast_hz: whole(config.homing.fast_rate_hz),
            slow_hz: whole(config.homing.slow_rate_hz),
            accel_hz_s: steps(config.planner.accel_mm_s2),
            pull_off_steps: steps(config.homing.pull_off_mm).max(1),
            release_steps: steps(config.homing.release_mm).max(1),
            known_steps: steps(config.homing.known_travel_mm),
            most_steps: steps(config.homing.max_travel_mm),
        }
    }
}

/// Steps between the two switches of each axis, the lower one touched downwards and the upper one upwards:
/// with any play of the axis in it once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Homed {
    /// Of x.
    pub x_steps: u32,
    /// Of y.
    pub y_steps: u32,
}

impl Homed {
    /// Steps to the millimetre, x and y, if a person has found so many millimetres between the places where
    /// the carriage meets both switches of an axis.
    ///
    /// ```
    /// # use plotter_motion::homing::Homed;
    /// let homed = Homed { x_steps: 34_000, y_steps: 28_000 };
    /// let [x, y] = homed.steps_per_mm(388.2, 319.7);
    /// assert!((x - 87.584).abs() < 1e-3 && (y - 87.582).abs() < 1e-3);
    /// ```
    #[must_use]
    pub fn steps_per_mm(&self, x_mm: f64, y_mm: f64) -> [f64; 2] {
        [f64::from(self.x_steps) / x_mm, f64::from(self.y_steps) / y_mm]
    }
}

/// A step that homing asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HomingStep {
    /// The motor.
    pub axis: Axis,
    /// Direction of the motor.
    pub direction: Direction,
    /// Pulses a second: the step takes 1/`rate_hz` s.
    pub rate_hz: u32,
}

impl From<HomingStep> for StepPair {
    /// ```
    /// # use plotter_motion::{Axis, Direction, StepPair, homing::HomingStep};
    /// let back = HomingStep { axis: Axis::Y, direction: Direction::Minus, rate_hz: 400 };
    /// assert_eq!(StepPair::from(back), StepPair { x: 0, y: -1 });
    /// ```
    fn from(step: HomingStep) -> Self {
        let one = match step.direction {
            Direction::Plus => 1,
            Direction::Minus => -1,
        };
        match step.axis {
            Axis::X => Self { x: one, y: 0 },
            Axis::Y => Self { x: 0, y: one },
        }
    }
}

/// Where homing is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum HomingStatus {
    /// It wants a step.
    Step(HomingStep),
    /// Both axes stand at the origin, driven towards the lower switches last.
    Done(Homed),
    /// It gave up; no step is wanted.
    Failed(HomingError),
}

/// Why homing gave up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum HomingError {
    /// A switch did not come.
    Missing {
        /// The axis.
        axis: Axis,
        /// At which of its ends.
        end: Direction,
        /// How many steps were made towards it.
        steps: u32,
    },
    /// A switch stayed pressed while it was left.
    Stuck {
        /// The axis.
        axis: Axis,
        /// At which of its ends.
        end: Direction,
        /// How many steps were made away from it.
        steps: u32,
    },
    /// The other switch of the axis came.
    Wrong {
        /// The axis.
        axis: Axis,
        /// At which of its ends it sits.
        end: Direction,
    },
    /// Both switches of an axis are pressed.
    Both {
        /// The axis.
        axis: Axis,
    },
    /// The switches are so near to one another that there is no way between them.
    Short {
        /// The axis.
        axis: Axis,
        /// Steps between its switches.
        steps: u32,
    },
    /// On the way back the lower switch came before its place.
    Early {
        /// The axis.
        axis: Axis,
        /// How many steps before.
        steps: u32,
    },
}

impl HomingError {
    /// The axis that could not be homed.
    #[must_use]
    pub const fn axis(self) -> Axis {
        match self {
            Self::Missing { axis, .. }
            | Self::Stuck { axis, .. }
            | Self::Wrong { axis, .. }
            | Self::Both { axis }
            | Self::Short { axis, .. }
            | Self::Early { axis, .. } => axis,
        }
    }
}

impl fmt::Display for HomingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = Plain(match self.axis() {
            Axis::X => "x",
            Axis::Y => "y",
        });
        let name = |end| Plain(if end == Direction::Minus { "lower" } else { "upper" });
        let whole = |steps: u32| Whole(steps.into());
        match *self {
            Self::Missing { end, steps, .. } => write!(
                f,
                "axis {axis}: the {} limit switch did not come within {} steps; check its wire, whether the motor \
                 turns at all, and the greatest travel in the settings",
                name(end),
                whole(steps)
            ),
            Self::Stuck { end, steps, .. } => write!(
                f,
                "axis {axis}: the {} limit switch is still pressed {} steps off it; check whether it sticks or its \
                 wire is broken, and whether the motor turns the right way",
                name(end),
                whole(steps)
            ),
            Self::Wrong { end, .. } => write!(
                f,
                "axis {axis}: the {} limit switch came on the way to the other one; check whether the motor turns the \
                 wrong way or the wires of both switches are exchanged",
                name(end)
            ),
            Self::Both { .. } => write!(
                f,
                "axis {axis}: both limit switches are pressed; check whether they share a wire: each needs its own input"
            ),
            Self::Short { steps, .. } => write!(
                f,
                "axis {axis}: only {} steps between its limit switches; check what stands in the way, and the \
                 distance of the origin from the switch",
                whole(steps)
            ),
            Self::Early { steps, .. } => write!(
                f,
                "axis {axis}: the lower limit switch came {} steps too early; the motor lost steps: check its \
                 current and the belt, or home with lower rates",
                whole(steps)
            ),
        }
    }
}

impl core::error::Error for HomingError {}

/// What is done with one axis, one after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing yet.
    Start,
    /// To the switch at this end.
    Seek(Direction),
    /// Off it, and some way farther.
    Leave(Direction),
    /// To it once more, slowly.
    Touch(Direction),
    /// Back to the origin.
    Return,
}

/// The state machine of homing.
///
/// ```
/// # use plotter_motion::{Axis, Direction, LimitSwitches, homing::{Homed, Homing, HomingAxis, HomingStatus}};
/// // a machine whose axes are 3000 steps long, and stand anywhere
/// let (mut x, mut y) = (1_200, 2_950);
/// let short = HomingAxis { known_steps: 2_500, ..HomingAxis::default() };
/// let mut homing = Homing::new(short, short);
/// let homed = loop {
///     let limits = LimitSwitches { x_min: x <= 0, x_max: x >= 3_000, y_min: y <= 0, y_max: y >= 3_000 };
///     match homing.update(limits) {
///         HomingStatus::Step(step) => {
///             match step.axis {
///                 Axis::X => x += step.direction.sign(),
///                 Axis::Y => y += step.direction.sign(),
///             }
///             homing.made();
///         }
///         HomingStatus::Done(homed) => break homed,
///         HomingStatus::Failed(error) => panic!("{error}"),
///     }
/// };
/// assert_eq!(homed, Homed { x_steps: 3_000, y_steps: 3_000 });
/// assert_eq!((x, y), (88, 88)); // a millimetre off the lower switches
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Homing {
    x: HomingAxis,
    y: HomingAxis,
    progress: HomingProgress,
}

/// How far homing has come: all of [`Homing`] but the axes, which it is told each time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HomingProgress {
    axis: Axis,
    phase: Phase,
    /// Steps made in this phase.
    taken: u32,
    /// Whether the switch that the phase leaves has opened, and after how many steps.
    opened: Option<u32>,
    /// The axis has turned out to be shorter than was said.
    is_shorter: bool,
    /// Steps from where the lower switch was touched.
    count: i64,
    homed: Homed,
    wanted: Option<Direction>,
    ended: Option<Result<Homed, HomingError>>,
}

impl Homing {
    /// Homing of both axes of a checked machine with stepper motors.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        Self::new(HomingAxis::of(machine, Axis::X), HomingAxis::of(machine, Axis::Y))
    }

    /// Homing of both axes, from wherever they stand.
    #[must_use]
    pub const fn new(x: HomingAxis, y: HomingAxis) -> Self {
        Self { x, y, progress: HomingProgress::START }
    }

    /// Next motion, for the present state of the limit switches; to be called before every step.
    pub fn update(&mut self, limits: LimitSwitches) -> HomingStatus {
        self.progress.update([&self.x, &self.y], limits)
    }

    /// The step that was wanted has been made. A step that was not made (an emergency stop) is simply not
    /// told.
    pub fn made(&mut self) {
        self.progress.made();
    }
}

impl HomingProgress {
    pub(crate) const START: Self = Self {
        axis: Axis::X,
        phase: Phase::Start,
        taken: 0,
        opened: None,
        is_shorter: false,
        count: 0,
        homed: Homed { x_steps: 0, y_steps: 0 },
        wanted: None,
        ended: None,
    };

    /// As [`Homing::update`].
    pub(crate) fn update(&mut self, axes: [&HomingAxis; 2], limits: LimitSwitches) -> HomingStatus {
        // Ends: every phase wants a step, fails, or is followed by one that wants a step.
        loop {
            match self.ended {
                Some(Ok(homed)) => return HomingStatus::Done(homed),
                Some(Err(error)) => return HomingStatus::Failed(error),
                None => {}
            }
            match self.look(self.settings(axes), limits) {
                Ok(Some(direction)) => {
                    self.wanted = Some(direction);
                    let step = HomingStep {
                        axis: self.axis,
                        direction,
                        rate_hz: self.rate_hz(&self.settings(axes)),
                    };
                    return HomingStatus::Step(step);
                }
                Ok(None) => {} // the next phase looks at once
                Err(error) => self.ended = Some(Err(error)),
            }
            self.wanted = None;
        }
    }

    /// As [`Homing::made`].
    pub(crate) fn made(&mut self) {
        if let Some(direction) = self.wanted.take() {
            self.taken = self.taken.saturating_add(1);
            self.count += i64::from(direction.sign());
        }
    }

    /// The axis in hand, as it is now known to be.
    fn settings(&self, [x, y]: [&HomingAxis; 2]) -> HomingAxis {
        let axis = if self.axis == Axis::X { *x } else { *y };
        let known_steps = if self.is_shorter { 0 } else { axis.known_steps };
        HomingAxis { pull_off_steps: axis.pull_off_steps.max(1), known_steps, ..axis }
    }

    fn enter(&mut self, phase: Phase) {
        (self.phase, self.taken, self.opened) = (phase, 0, None);
    }

    /// The direction of the step that the phase wants; none where it is over.
    #[cfg_attr(target_os = "none", inline(never))]
    fn look(
        &mut self,
        settings: HomingAxis,
        limits: LimitSwitches,
    ) -> Result<Option<Direction>, HomingError> {
        let axis = self.axis;
        let pressed = |end| limits.blocks(axis, end);
        if pressed(Direction::Minus) && pressed(Direction::Plus) {
            return Err(HomingError::Both { axis });
        }
        match self.phase {
            Phase::Start => {
                let on_lower = pressed(Direction::Minus);
                self.enter(if on_lower {
                    Phase::Leave(Direction::Minus)
                } else {
                    Phase::Seek(Direction::Minus)
                });
                Ok(None)
            }
            Phase::Seek(end) => {
                self.leave(&settings, opposite(end), pressed(opposite(end)))?;
                if !pressed(end) {
                    self.within(settings.most_steps, end)?;
                    return Ok(Some(end));
                }
                if end == Direction::Plus && self.taken < settings.known_steps {
                    // Met where the axis was said to go on, perhaps at a rate that cannot be stopped without
                    // losing steps: all over again, without that knowledge.
                    self.is_shorter = true;
                    self.enter(Phase::Seek(Direction::Minus));
                } else {
                    self.enter(Phase::Leave(end));
                }
                Ok(None)
            }
            Phase::Leave(end) => {
                if pressed(opposite(end)) {
                    return Err(HomingError::Wrong { axis, end: opposite(end) });
                }
                self.leave(&settings, end, pressed(end))?;
                if self.opened.is_some_and(|opened| self.taken - opened >= settings.pull_off_steps) {
                    self.enter(Phase::Touch(end));
                    return Ok(None);
                }
                Ok(Some(opposite(end)))
            }
            Phase::Touch(end) => {
                if pressed(opposite(end)) {
                    return Err(HomingError::Wrong { axis, end: opposite(end) });
                }
                if pressed(end) {
                    self.touched(&settings, end)?;
                    return Ok(None);
                }
                self.within(settings.pull_off_steps.saturating_add(settings.release_steps), end)?;
                Ok(Some(end))
            }
            Phase::Return => {
                self.leave(&settings, Direction::Plus, pressed(Direction::Plus))?;
                let origin = i64::from(settings.pull_off_steps);
                if pressed(Direction::Minus) {
                    return Err(HomingError::Early {
                        axis,
                        steps: u32::try_from(self.count).unwrap_or_default(),
                    });
                }
                if self.count > origin {
                    return Ok(Some(Direction::Minus));
                }
                if axis == Axis::X {
                    (self.axis, self.is_shorter) = (Axis::Y, false);
                    self.enter(Phase::Start);
                } else {
                    self.ended = Some(Ok(self.homed));
                }
                Ok(None)
            }
        }
    }

    /// The switch at `end` was met slowly: the lower one is where counting begins, the upper one where it
    /// ends.
    fn touched(&mut self, settings: &HomingAxis, end: Direction) -> Result<(), HomingError> {
        if end == Direction::Minus {
            self.count = 0;
            self.enter(Phase::Seek(Direction::Plus));
            return Ok(());
        }
        let (axis, steps) = (self.axis, u32::try_from(self.count).unwrap_or_default());
        if steps <= settings.pull_off_steps.saturating_mul(2) {
            return Err(HomingError::Short { axis, steps });
        }
        match axis {
            Axis::X => self.homed.x_steps = steps,
            Axis::Y => self.homed.y_steps = steps,
        }
        self.enter(Phase::Return);
        Ok(())
    }

    /// Watches the switch at `end`, which this phase goes away from: pressed, it opens soon; open, it stays
    /// so.
    fn leave(&mut self, settings: &HomingAxis, end: Direction, pressed: bool) -> Result<(), HomingError> {
        let (axis, steps) = (self.axis, self.taken);
        let is_near = steps < settings.release_steps;
        match (pressed, self.opened) {
            (false, None) => self.opened = Some(steps),
            (true, None) if !is_near => return Err(HomingError::Stuck { axis, end, steps }),
            // A contact that opens may bounce; one that was open all the time does not.
            (true, Some(opened)) if opened > 0 && is_near => self.opened = None,
            (true, Some(_)) => return Err(HomingError::Wrong { axis, end }),
            _ => {}
        }
        Ok(())
    }

    /// Gives up a switch that has not come within `most` steps.
    fn within(&self, most: u32, end: Direction) -> Result<(), HomingError> {
        if self.taken < most {
            Ok(())
        } else {
            Err(HomingError::Missing { axis: self.axis, end, steps: self.taken })
        }
    }

    /// How fast the next step may be: v² = v0² + 2 a s from where the phase began, and from where it must be
    /// slow.
    fn rate_hz(&self, settings: &HomingAxis) -> u32 {
        let start_hz = settings.start_hz.min(settings.fast_hz).max(1);
        let slow_hz = settings.slow_hz.clamp(1, start_hz);
        // Steps for which the way is known to be free; the last of them is slow already.
        let known = match self.phase {
            Phase::Leave(_) | Phase::Touch(_) | Phase::Start => return slow_hz,
            Phase::Seek(Direction::Minus) => 0,
            Phase::Seek(Direction::Plus) => i64::from(settings.known_steps),
            Phase::Return => self.count + i64::from(self.taken) - i64::from(settings.pull_off_steps),
        };
        let before = i64::from(self.taken);
        let ahead = known - before;
        let slowly = if known > 0 { slow_hz } else { start_hz };
        let reached = |from_hz: u32, steps: i64| {
            let from_hz = u64::from(from_hz);
            let gained = u64::from(settings.accel_hz_s).saturating_mul(steps.max(0).unsigned_abs());
            root((from_hz * from_hz).saturating_add(gained.saturating_mul(2)))
        };
        reached(start_hz, before).min(reached(slowly, ahead - 1)).min(settings.fast_hz).max(1)
    }
}

/// The square root, rounded down: bit by bit, which takes the least program memory.
#[cfg_attr(target_os = "none", inline(never))]
fn root(square: u64) -> u32 {
    (0..u32::BITS).rev().fold(0, |root, bit| {
        let next = root | 1 << bit;
        if u64::from(next) * u64::from(next) <= square { next } else { root }
    })
}

fn opposite(end: Direction) -> Direction {
    match end {
        Direction::Plus => Direction::Minus,
        Direction::Minus => Direction::Plus,
    }
}
