//! What the motion side does with a third motor: that of a third axis, or a second one of x or y.

use super::super::squaring::{SquaringAxis, SquaringProgress, SquaringStatus};
use super::super::z_axis::{ZHomingProgress, ZHomingStatus};
use super::super::{Command, Drivers, Link, Report, Step, Stop};
use super::{Motion, State};
use crate::geom::single;
use crate::planner::{Action, Keep as _, Modes, Shape};
use crate::safety::{Blocked, EndSwitches, Pulse};
use crate::seconds::has_come;
use crate::{Axis, Direction, LimitSwitches, PlotOp, Point};
use core::time::Duration;

/// Where the third axis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ZState {
    /// Steps really made, from the lowest place.
    position: i32,
    /// At which height the next operation ends, mm.
    to_mm: Option<f64>,
    homing: Option<ZHomingProgress>,
    /// How many steps below the place where homing found it, it was believed to be.
    off_steps: Option<i32>,
    squaring: Option<SquaringProgress>,
    /// Where the course in hand ends, and at which height, mm.
    planned_at: Point,
    planned_mm: f64,
    /// In how much smaller units than millimetres it is told: from 1 on.
    per_mm: f32,
    skew_steps: Option<i32>,
}

impl Default for ZState {
    fn default() -> Self {
        Self {
            position: 0,
            to_mm: None,
            homing: None,
            off_steps: None,
            squaring: None,
            planned_at: Point::ORIGIN,
            planned_mm: 0.0,
            per_mm: 1.0,
            skew_steps: None,
        }
    }
}

impl<M: Modes> Motion<M> {
    /// Tells planner and step generator of the axis, and where it stands.
    pub(super) fn tell_z(&mut self) {
        let at = self.position_mm();
        let (Some(z), Some(state)) = (self.settings.z, self.z.get_mut()) else { return };
        (state.to_mm, state.per_mm) = (None, 1.0);
        (state.planned_at, state.planned_mm) = (at, z.height_at(state.position));
        let told = self.planner.set_z_limits(&z.limits());
        debug_assert!(told.is_ok(), "the settings have been checked: {told:?}");
        if let Some(pen) = z.pen {
            self.planner.set_pen_heights(pen.up_mm, pen.down_mm);
        }
        self.planner.stand_at_height(z.height_at(state.position));
        self.steps.set_z(z.steps_per_mm, state.position);
    }

    /// The height by the steps really made, mm; none of a machine with two axes.
    #[must_use]
    pub fn z_mm(&self) -> Option<f64> {
        self.settings.z.zip(self.z.get()).map(|(z, state)| z.height_at(state.position))
    }

    /// The steps really made, from the lowest place.
    #[cfg(feature = "step-ahead")]
    pub(in super::super) fn z_steps(&self) -> Option<i32> {
        self.z.get().map(|state| state.position)
    }

    /// So many have really been made.
    #[cfg(feature = "step-ahead")]
    pub(super) fn stand_at_z(&mut self, steps: i32) {
        if let Some(state) = self.z.get_mut() {
            state.position = steps;
        }
    }

    /// Notes how a course rises: in which units it is told, and what it can be braked with.
    pub(super) fn note_rise(&mut self, action: &Action) {
        let (Some(z), Some(state), Action::Course(course)) = (self.settings.z, self.z.get_mut(), action)
        else {
            return;
        };
        let from = core::mem::replace(&mut state.planned_at, course.to);
        state.per_mm = 1.0;
        let Some(to_mm) = course.to_z_mm else { return };
        let by_mm = single(to_mm - core::mem::replace(&mut state.planned_mm, to_mm)).abs();
        if by_mm <= 0.0 {
            return;
        }
        let plane_mm = match course.shape {
            Shape::Arc { centre, sweep_rad } => single(centre.distance(course.to)) * sweep_rad.abs(),
            _ => single(from.distance(course.to)),
        };
        let length_mm = crate::root::root(plane_mm * plane_mm + by_mm * by_mm);
        if self.planner.settings().jerk_mm_s3.is_some() {
            state.per_mm = crate::extremes::greatest(1.0, course.length_mm / length_mm);
        }
        #[cfg(feature = "step-ahead")]
        {
            let of_z = single(z.accel_mm_s2) * length_mm / by_mm;
            // In units in which it is planned with the acceleration of all others, of which turning has a
            // part.
            let in_units = state.per_mm > 1.0;
            let of_all = crate::planner::HELIX_SHARE * single(self.planner.settings().accel_mm_s2);
            self.ahead.rises(if in_units { of_all } else { of_z });
        }
        #[cfg(not(feature = "step-ahead"))]
        let _ = z;
    }

    /// The true speed of one along the course in hand.
    pub(super) fn true_speed(&self, speed_mm_s: f32) -> f32 {
        self.z.get().map_or(speed_mm_s, |state| speed_mm_s / state.per_mm)
    }

    /// By how many steps the third axis stood higher than was believed, as its last homing has found.
    #[must_use]
    pub fn z_off_steps(&self) -> Option<i32> {
        self.z.get()?.off_steps
    }

    /// Takes the state of the limit switches of the third axis.
    pub const fn z_switches(&mut self, switches: EndSwitches) {
        self.gate.set_z_limits(switches);
    }

    /// The one way of a step to the third motor.
    pub(super) fn pass_z(&mut self, step: i8, link: &mut Link) -> Option<Pulse<'static>> {
        match self.gate.pass_z_step(step).map(Pulse::kept) {
            Ok(pulse) => {
                if let Some(state) = self.z.get_mut() {
                    state.position = state.position.saturating_add(pulse.z().into());
                }
                Some(pulse)
            }
            Err(Blocked::LimitZ { end }) => {
                self.stop(Stop::LimitZ { end }, link);
                None
            }
            Err(_) => {
                self.stop(Stop::Emergency, link);
                None
            }
        }
    }

    /// Plans what the queue has and the planner takes, with the heights among it.
    pub(super) fn fill_rising(&mut self, now: Duration, link: &mut Link) {
        while self.planner.has_room()
            && let Some(command) = link.commands.first()
        {
            let may_jog = !self.cancelling && (self.jogs || (!self.unfinished && self.planner.is_empty()));
            let to_mm = self.z.get().and_then(|state| state.to_mm);
            let planned = match command {
                Command::ToZ(mm) => {
                    if let Some(state) = self.z.get_mut() {
                        state.to_mm = Some(mm);
                    }
                    link.commands.pop();
                    continue;
                }
                Command::Jog { to, speed_mm_s } if may_jog => {
                    self.jogs = true;
                    self.planner.push_jog(to, speed_mm_s)
                }
                Command::JogZ { to, to_z_mm, speed_mm_s } if may_jog => {
                    self.jogs = true;
                    self.planner.jog_rising(to, to_z_mm, speed_mm_s)
                }
                Command::Plot(op) if !self.jogs => {
                    if op == (PlotOp::LaserPower { share: 0.0 }) {
                        self.dark = false;
                    }
                    match to_mm.filter(|_| op.target().is_some()) {
                        Some(height_mm) => self.planner.push_rising(op, height_mm),
                        None => self.planner.push(op),
                    }
                }
                _ => break,
            };
            link.commands.pop();
            debug_assert!(planned.is_ok(), "the receive side has looked at {command:?}: {planned:?}");
            let goes = matches!(command, Command::Plot(op) if op.target().is_some());
            if let Some(state) = self.z.get_mut().filter(|_| goes) {
                state.to_mm = None;
            }
            self.taken(now);
        }
        self.end_what_waits(link);
    }

    /// How many steps farther than the first the second motor of an axis went when both were made square
    /// last.
    #[must_use]
    pub fn skew_steps(&self) -> Option<i32> {
        self.z.get()?.skew_steps
    }

    /// Takes the state of the limit switches of the second motor of an axis.
    pub const fn second_switches(&mut self, switches: EndSwitches) {
        if let Some(second) = self.settings.second {
            self.gate.set_second_limits(second.axis, switches);
        }
    }

    /// The limit switches as homing looks at them: where an axis has two motors, either's counts.
    pub(super) fn homing_limits(&self) -> LimitSwitches {
        let mut limits = self.gate.limits();
        if let Some(second) = self.settings.second {
            let EndSwitches { lower, upper } = self.gate.second_limits();
            for (end, pressed) in [(Direction::Minus, lower), (Direction::Plus, upper)] {
                limits.set(second.axis, end, pressed || limits.blocks(second.axis, end));
            }
        }
        limits
    }

    /// Begins with the third axis, if it is homed, and makes two motors square.
    pub(super) fn begin_homing_z(&mut self) {
        let homes = self.settings.z.is_some_and(|z| z.home.is_some());
        if let Some(state) = self.z.get_mut() {
            state.homing = homes.then(ZHomingProgress::default);
            state.squaring = self.settings.second.map(|_| SquaringProgress::default());
        }
    }

    /// Whether a third motor has something to do before the axes are homed.
    pub(super) fn homes_z(&self) -> bool {
        let is_busy = self.z.get().is_some_and(|state| state.homing.is_some() || state.squaring.is_some());
        matches!(self.state, State::Homing(_)) && is_busy
    }

    /// One turn of that.
    pub(super) fn home_z(
        &mut self,
        now: Duration,
        drivers: Drivers,
        link: &mut Link,
    ) -> Option<Step<'static>> {
        if self.z.get().is_some_and(|state| state.homing.is_none()) {
            return self.make_square(now, drivers, link);
        }
        let switches = self.gate.z_limits();
        let z = self.settings.z?;
        let (State::Homing(run), Some(state)) = (&mut self.state, self.z.get_mut()) else { return None };
        let (settings, homing) = (z.home?, state.homing.as_mut()?);
        match homing.update(&settings, switches) {
            Ok(ZHomingStatus::Step { direction, rate_hz }) => {
                let at = run.after(rate_hz);
                if !has_come(at, now) || drivers == Drivers::Busy {
                    self.due = Some(at);
                    return None;
                }
                homing.made();
                let is_late = self.lateness.given(at, now, &mut self.base);
                run.made_other(if is_late { now } else { at });
                let way = if direction.sign() > 0 { 1 } else { -1 };
                self.pass_z(way, link).map(|pulse| Step { at, pulse })
            }
            Ok(ZHomingStatus::Done { .. }) => {
                let found = z.steps_at(z.travel_mm);
                state.off_steps = Some(found.saturating_sub(state.position));
                (state.position, state.homing) = (found, None);
                None
            }
            Err(error) => {
                state.homing = None;
                self.halt(link);
                self.state = State::Ready;
                let _ = link.reports.push(Report::NotHomedZ { at: self.position_mm(), error });
                None
            }
        }
    }

    /// One turn of making both motors of an axis square.
    fn make_square(&mut self, now: Duration, drivers: Drivers, link: &mut Link) -> Option<Step<'static>> {
        let second = self.settings.second?;
        let home = if second.axis == Axis::X { &self.settings.home_x } else { &self.settings.home_y };
        let axis = SquaringAxis {
            second,
            start_hz: home.start_hz.min(home.fast_hz),
            slow_hz: home.slow_hz.min(home.start_hz),
            pull_off_steps: home.pull_off_steps.max(1),
            release_steps: home.release_steps,
            most_steps: home.most_steps,
        };
        let limits = self.gate.limits();
        let first = EndSwitches {
            lower: limits.blocks(second.axis, Direction::Minus),
            upper: limits.blocks(second.axis, Direction::Plus),
        };
        let switches = [first, self.gate.second_limits()];
        let (State::Homing(run), Some(state)) = (&mut self.state, self.z.get_mut()) else { return None };
        let squaring = state.squaring.as_mut()?;
        match squaring.update(&axis, switches) {
            Ok(SquaringStatus::Step { ways, rate_hz }) => {
                let at = run.after(rate_hz);
                if !has_come(at, now) || drivers == Drivers::Busy {
                    self.due = Some(at);
                    return None;
                }
                squaring.made();
                let is_late = self.lateness.given(at, now, &mut self.base);
                run.made_other(if is_late { now } else { at });
                let passed = self.gate.pass_apart(second.axis, ways).map(Pulse::kept);
                self.count(passed, link).map(|pulse| Step { at, pulse })
            }
            Ok(SquaringStatus::Done { skew_steps }) => {
                (state.squaring, state.skew_steps) = (None, Some(skew_steps));
                None
            }
            Err(error) => {
                state.squaring = None;
                self.halt(link);
                self.state = State::Ready;
                let _ = link.reports.push(Report::NotSquared { at: self.position_mm(), error });
                None
            }
        }
    }
}
