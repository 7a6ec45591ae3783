//! What the motion side does from one event to the next: from the queue to the planner, from there to the
//! step generator, and through the gate.

use super::super::homing_run::HomingRun;
use super::super::play::Play;
use super::super::{Command, Dialect, Drivers, Link, Report, Step, Stop, StoredSettings};
use super::{Motion, State};
use crate::planner::{Keep as _, Modes};
use crate::seconds::has_come;
#[cfg(feature = "averaged-steps")]
use crate::stepgen::Average;
use crate::{
    Pen, PlotOp, StepPair, StepPoint,
    planner::Action,
    safety::{Blocked, Pulse},
    stepgen::{MotorEvent, TimedEvent},
};
use core::time::Duration;

impl<M: Modes> Motion<M> {
    /// Carries out what is due.
    pub(super) fn give(&mut self, event: MotorEvent, link: &mut Link) -> Option<Pulse<'static>> {
        match event {
            MotorEvent::Step(step) => return self.pass(step, link),
            #[cfg(feature = "third-motor")]
            MotorEvent::StepZ(step) => return self.pass_z(step, link),
            // A gate that was stopped when the machine was made is noticed by what moves first.
            MotorEvent::Pen(_) if self.gate.is_stopped() => self.stop(Stop::Emergency, link),
            MotorEvent::Pen(pen) => {
                if self.settings.dialect == Dialect::Grbl {
                    self.put_pen(pen);
                }
            }
            MotorEvent::Laser(power) => {
                self.laser = power;
                self.shine();
            }
            // A person does that, and says when it is done.
            MotorEvent::SelectPen(_) | MotorEvent::NewPage => self.hold(),
        }
        None
    }

    /// The one way of a step to the motors.
    pub(super) fn pass(&mut self, step: StepPair, link: &mut Link) -> Option<Pulse<'static>> {
        let passed = self.gate.pass_step(step).map(Pulse::kept);
        self.count(passed, link)
    }

    /// A step that has passed the gate counts as made; one that has not stops the machine.
    #[inline(always)] // from one place where there are two motors
    pub(super) fn count(
        &mut self,
        passed: Result<Pulse<'static>, Blocked>,
        link: &mut Link,
    ) -> Option<Pulse<'static>> {
        match passed {
            Ok(pulse) => {
                self.position.x = self.position.x.saturating_add(pulse.x().into());
                self.position.y = self.position.y.saturating_add(pulse.y().into());
                if let Some(play) = self.play.get_mut() {
                    play.made(pulse);
                }
                Some(pulse)
            }
            Err(Blocked::Stopped) => {
                self.stop(Stop::Emergency, link);
                None
            }
            Err(Blocked::Limit { axis, end }) => {
                self.stop(Stop::Limit { axis, end }, link);
                None
            }
            #[cfg(feature = "third-motor")]
            Err(Blocked::LimitZ { .. }) => None,
        }
    }

    pub(super) fn put_pen(&mut self, pen: Pen) {
        let StoredSettings { pen_up_deg, pen_down_deg, .. } = self.settings.stored;
        self.pen_deg = if pen == Pen::Up { pen_up_deg } else { pen_down_deg };
    }

    /// Gets the next event, or does what is to be done at rest; says whether there may be more.
    #[cfg_attr(target_os = "none", inline(never))]
    pub(super) fn go_on(&mut self, now: Duration, link: &mut Link) -> bool {
        if let Some(event) = self.next_event() {
            self.next = Some(event);
            return true;
        }
        self.fill(now, link);
        if self.at_rest
            && let Some(start_at) = self.start_at.filter(|&at| !has_come(at, now))
            && self.planner.has_room()
            && link.commands.is_empty()
        {
            self.due = Some(start_at);
            return false;
        }
        #[cfg(feature = "step-ahead")]
        if self.plans_a_part() {
            return true;
        }
        if let Some(action) = self.planner.next_action() {
            self.start_at = None;
            if core::mem::take(&mut self.at_rest) {
                self.begin(now);
            }
            #[cfg(feature = "step-ahead")]
            self.ahead.note(&action);
            #[cfg(feature = "third-motor")]
            self.note_rise(&action);
            #[cfg(feature = "averaged-steps")]
            if let Some(average) = self.average.get_mut() {
                average.note(&action);
            }
            if let Action::Phase(phase) = action {
                self.phase = Some((self.time_of(self.tick()), phase));
            }
            let pushed = self.steps.push(action);
            debug_assert!(pushed.is_ok(), "all events have been taken");
            return true;
        }
        if !self.unfinished || self.held || self.cancelling {
            // The carriage too comes to where it should be.
            if let Some(event) = self.last_event() {
                self.next = Some(event);
                return true;
            }
        }
        if self.held {
            self.at_rest = true;
            // A pen that stands on the sheet leaves a blot.
            self.steps.lift();
            if self.settings.dialect == Dialect::Grbl {
                self.put_pen(Pen::Up);
            }
            return false;
        }
        if self.unfinished && !self.cancelling && self.planner.rest().is_ok() {
            self.unfinished = false;
            return true;
        }
        #[cfg(feature = "step-ahead")]
        if self.ahead.waits_for_motors() {
            return false;
        }
        (self.at_rest, self.start_at) = (true, None);
        // The last phase may last beyond its last step, and a pause has no step.
        let end = self.time_of(self.tick());
        if !has_come(end, now) {
            self.due = Some(end);
            return false;
        }
        self.phase = None;
        if self.cancelling {
            self.jogged(link);
            return true;
        }
        if core::mem::take(&mut self.jogs) {
            return true;
        }
        match link.commands.pop() {
            // What was sent before the stop was heard of.
            Some(Command::Servo(_) | Command::Home) if self.gate.is_stopped() => {
                self.stop(Stop::Emergency, link);
            }
            Some(command) => self.stand(command, now, link),
            None => return false,
        }
        true
    }

    /// The next event of what has been planned, averaged if it is to be, and of the play on its way.
    pub(super) fn next_event(&mut self) -> Option<TimedEvent> {
        loop {
            if let Some(event) = self.play.get_mut().and_then(Play::next_event) {
                return Some(event);
            }
            #[cfg(feature = "averaged-steps")]
            let event = match self.average.get_mut() {
                Some(average) => average.next_event(|| self.steps.next_event())?,
                None => self.steps.next_event()?,
            };
            #[cfg(not(feature = "averaged-steps"))]
            let event = self.steps.next_event()?;
            match self.play.get_mut() {
                Some(play) => {
                    if let Some(event) = play.push(event) {
                        return Some(event);
                    }
                }
                None => return Some(event),
            }
        }
    }

    /// The next event of motors on their way to where all that was planned has ended.
    fn last_event(&mut self) -> Option<TimedEvent> {
        #[cfg(feature = "averaged-steps")]
        if let Some(step) = self.average.get_mut().and_then(Average::rest) {
            return match self.play.get_mut() {
                Some(play) => play.push(step).or_else(|| play.next_event()),
                None => Some(step),
            };
        }
        self.play.get_mut().and_then(Play::rest)
    }

    /// Plans what the queue has and the planner takes.
    pub(super) fn fill(&mut self, now: Duration, link: &mut Link) {
        #[cfg(feature = "third-motor")]
        if M::Z {
            return self.fill_rising(now, link);
        }
        while self.planner.has_room()
            && !self.cancelling
            && let Some(Command::Jog { to, speed_mm_s }) = link.commands.first()
            && (self.jogs || (!self.unfinished && self.planner.is_empty()))
        {
            link.commands.pop();
            let planned = self.planner.push_jog(to, speed_mm_s);
            debug_assert!(planned.is_ok(), "the receive side has looked at it: {planned:?}");
            self.taken(now);
            self.jogs = true;
        }
        while self.planner.has_room()
            && !self.jogs
            && let Some(Command::Plot(op)) = link.commands.first()
        {
            link.commands.pop();
            if op == (PlotOp::LaserPower { share: 0.0 }) {
                self.dark = false;
            }
            let planned = self.planner.push(op);
            debug_assert!(planned.is_ok(), "the receive side has looked at {op:?}: {planned:?}");
            self.taken(now);
        }
        self.end_what_waits(link);
    }

    /// What comes next waits for a standstill: nothing more is planned together with this.
    pub(super) fn end_what_waits(&mut self, link: &Link) {
        let jogs = self.jogs;
        let waits = |next| match next {
            Command::Plot(_) => jogs,
            Command::Jog { .. } => !jogs,
            #[cfg(feature = "third-motor")]
            Command::ToZ(_) => jogs,
            #[cfg(feature = "third-motor")]
            Command::JogZ { .. } => !jogs,
            _ => true,
        };
        if self.unfinished && !self.cancelling && link.commands.first().is_some_and(waits) {
            self.unfinished = self.planner.rest().is_err();
        }
    }

    /// Something has been planned.
    pub(super) fn taken(&mut self, now: Duration) {
        self.unfinished = true;
        if self.at_rest && self.start_at.is_none() {
            // Lines that have been waiting are gathered already.
            let gather = if self.told_at == Some(now) { Duration::ZERO } else { self.settings.gather };
            self.start_at = now.checked_add(gather);
        }
    }

    /// Carries out what waits for a standstill, at a standstill.
    pub(super) fn stand(&mut self, command: Command, now: Duration, link: &mut Link) {
        match command {
            Command::Plot(_) | Command::Jog { .. } => debug_assert!(false, "an empty planner has room"),
            Command::Set(_) | Command::Restore => {
                self.leave_out(command);
                let _ = link.reports.push(Report::Set { at: self.position_mm() });
            }
            Command::Servo(deg) => {
                if deg != self.pen_deg {
                    self.pen_deg = deg;
                    self.wait(now, self.settings.pen_settle);
                }
            }
            Command::PenAngles { .. } => self.leave_out(command),
            Command::Home => {
                let up_deg = self.settings.stored.pen_up_deg;
                let settle = if core::mem::replace(&mut self.pen_deg, up_deg) == up_deg {
                    Duration::ZERO
                } else {
                    self.settings.pen_settle
                };
                let run = HomingRun::new(now.saturating_add(settle));
                #[cfg(feature = "third-motor")]
                self.begin_homing_z();
                self.state = State::Homing(run);
            }
            Command::Pause => self.hold(),
            Command::Finish | Command::End => {
                if command == Command::End {
                    self.end_overrides();
                }
                self.told_at = Some(now);
                let _ = link.reports.push(Report::Done);
            }
            Command::GoOn => {}
            #[cfg(feature = "third-motor")]
            Command::ToZ(_) | Command::JogZ { .. } => {}
            Command::Unlock => {
                self.gate.reset();
            }
        }
    }

    pub(super) fn wait(&mut self, now: Duration, duration: Duration) {
        self.begin(now);
        let pushed = self.steps.push(Action::Dwell(duration));
        debug_assert!(pushed.is_ok(), "all events have been taken");
    }

    /// One turn of homing.
    pub(super) fn home(&mut self, now: Duration, drivers: Drivers, link: &mut Link) -> Option<Step<'static>> {
        #[cfg(feature = "third-motor")]
        if M::Z && self.homes_z() {
            let step = self.home_z(now, drivers, link);
            if step.is_some() || self.homes_z() || self.state == State::Ready {
                return step;
            }
        }
        #[cfg(feature = "third-motor")]
        let limits = self.homing_limits();
        let State::Homing(run) = &mut self.state else { return None };
        #[cfg(not(feature = "third-motor"))]
        let limits = self.gate.limits();
        let result = match run.next(&self.settings, limits) {
            Ok((at, _)) if !has_come(at, now) || drivers == Drivers::Busy => {
                self.due = Some(at);
                return None;
            }
            Ok((at, step)) => {
                let is_late = self.lateness.given(at, now, &mut self.base);
                run.made(if is_late { now } else { at });
                return self.pass(step, link).map(|pulse| Step { at, pulse });
            }
            Err(result) => result,
        };
        if let Ok(homed) = result {
            if let Some(measured) = self.measured.get_mut() {
                let StepPoint { x, y } = self.position;
                let off = StepPoint::new(x.saturating_neg(), y.saturating_neg());
                measured.off = measured.is_placed.then_some(off);
                (measured.homed, measured.is_placed) = (Some(homed), true);
            }
            self.position = StepPoint::default();
            #[cfg(feature = "step-ahead")]
            self.ahead.homed();
            if let Some(play) = self.play.get_mut() {
                play.homed();
            }
        }
        self.halt(link);
        self.state = State::Ready;
        let _ = link.reports.push(Report::Homed { at: self.position_mm(), result });
        None
    }
}
