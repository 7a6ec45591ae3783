//! [`Motion`]: the task that moves: commands in, steps out, each at its time.

#[cfg(feature = "step-ahead")]
mod ahead;
mod by_hand;
mod work;
#[cfg(feature = "third-motor")]
mod z;

#[cfg(feature = "step-ahead")]
pub(super) use ahead::{Made, whole_us};

use super::homing_run::HomingRun;
use super::play::{CLOCK_HZ, Play};
use super::{
    Activity, CheckedSettings, Command, Dialect, Drivers, Lateness, Link, Percents, Report, SettingsError,
    Signal, Status, StepperPlotterSettings, Stop, StoredSettings,
};
use crate::extremes::greatest;
#[cfg(feature = "averaged-steps")]
use crate::geom::single;
use crate::homing::Homed;
use crate::kinematics::{Cartesian, Kinematics};
use crate::planner::{AllModes, Keep as _, Modes};
use crate::seconds::has_come;
#[cfg(feature = "averaged-steps")]
use crate::stepgen::Average;
use crate::{
    Axis, Direction, LimitSwitches, Pen, Planner, PlotOp, Point, SafetyGate, StepGen, StepPoint,
    planner::Phase,
    safety::{Beam, Pulse},
    stepgen::{StepGenSettings, TimedEvent},
};
use core::time::Duration;

/// Blocks of the look-ahead.
const BLOCKS: usize = 16;

/// A step of the motors that passed the safety gate, at the time at which it was due. It ends when the
/// machine is told anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Step<'gate> {
    /// When it was due.
    pub at: Duration,
    /// Which motors, and which way: 1 towards larger coordinates.
    pub pulse: Pulse<'gate>,
}

/// What homing has measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Measured {
    homed: Option<Homed>,
    off: Option<StepPoint>,
    /// Its place has been known since the machine was switched on.
    is_placed: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Ready,
    Homing(HomingRun),
    /// Commands are left out until [`Command::GoOn`].
    Stopped,
}

/// The motion side: takes commands from the queue, plans, and gives every step at its time.
///
/// After each input, call [`poll`](Self::poll) until it gives no step, and say each time whether the drivers
/// can take one; then arm a timer for [`due`](Self::due) and call it again at that time. After each call, the
/// servo gets [`pen_deg`](Self::pen_deg) and the laser [`beam`](Self::beam).
#[derive(Debug, PartialEq)]
pub struct Motion<M: Modes = AllModes> {
    settings: StepperPlotterSettings,
    planner: Planner<BLOCKS, M>,
    steps: StepGen<Cartesian, M>,
    #[cfg(feature = "averaged-steps")]
    average: M::Kept<Average>,
    play: M::Kept<Play>,
    /// What it was switched on with.
    built: M::Kept<StepperPlotterSettings>,
    measured: M::Kept<Measured>,
    gate: SafetyGate,
    state: State,
    /// Steps really made.
    position: StepPoint,
    /// The event that is to come.
    next: Option<TimedEvent>,
    /// Tick 0 of the step generator.
    base: Duration,
    /// Nothing has been taken from the planner that still moves.
    at_rest: bool,
    /// When a machine at rest starts, whatever it knows by then.
    start_at: Option<Duration>,
    /// When the receive side was told last that all is done: what comes at that very time has waited for it.
    told_at: Option<Duration>,
    /// Operations have been planned that may have been put off.
    unfinished: bool,
    held: bool,
    /// What is planned are jogs; and they are to end.
    jogs: bool,
    cancelling: bool,
    dark: bool,
    /// The laser's power as the path has it, and the overrides in force.
    laser: u16,
    percents: Percents,
    /// The phase in progress and when it began.
    phase: Option<(Duration, Phase)>,
    pen_deg: u8,
    beam: Beam<'static>,
    due: Option<Duration>,
    lateness: Lateness,
    #[cfg(feature = "step-ahead")]
    ahead: ahead::Ahead,
    #[cfg(feature = "third-motor")]
    z: M::Rise<z::ZState>,
}

impl Motion {
    /// A machine at rest at the origin, pen up, with its switches and its button as the gate has them. If the
    /// gate is stopped, the first thing that is to move is refused and reported as [`Stop::Emergency`].
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for limits that no motion can be planned with.
    pub fn new(settings: StepperPlotterSettings, gate: SafetyGate) -> Result<Self, SettingsError> {
        Self::with_modes(settings, gate)
    }
}

impl<M: Modes> Motion<M> {
    /// As [`Motion::new`], with the modes of its type.
    ///
    /// # Errors
    ///
    /// [`SettingsError`] for limits that no motion can be planned with, and for a mode that is not among
    /// them.
    pub fn with_modes(settings: StepperPlotterSettings, gate: SafetyGate) -> Result<Self, SettingsError> {
        Ok(Self::from_checked(&settings.checked()?, gate))
    }

    /// The same, with settings that have been looked at.
    #[must_use]
    pub fn from_checked(checked: &CheckedSettings<M>, gate: SafetyGate) -> Self {
        let settings = checked.settings();
        #[cfg(feature = "averaged-steps")]
        let averaged = checked.limits.planned_of_checked();
        #[cfg(feature = "averaged-steps")]
        let limits = &averaged.settings;
        #[cfg(not(feature = "averaged-steps"))]
        let limits = &checked.limits;
        let mut planner = Planner::of_checked(limits);
        darken(&mut planner);
        let steps = step_gen(settings);
        #[cfg(feature = "averaged-steps")]
        let mut average = M::Kept::<Average>::default();
        #[cfg(feature = "averaged-steps")]
        if let Some(average) = average.get_mut() {
            *average = Average::of(&averaged, CLOCK_HZ);
        }
        let mut play = M::Kept::<Play>::default();
        if let Some(play) = play.get_mut() {
            *play = Play::new(settings);
        }
        let mut built = M::Kept::<StepperPlotterSettings>::default();
        if let Some(built) = built.get_mut() {
            *built = *settings;
        }
        #[cfg_attr(
            not(feature = "third-motor"),
            expect(unused_mut, reason = "nothing is told of a third axis")
        )]
        let mut motion = Self {
            settings: *settings,
            planner,
            steps,
            #[cfg(feature = "averaged-steps")]
            average,
            play,
            built,
            measured: M::Kept::default(),
            gate,
            state: State::Ready,
            position: StepPoint::default(),
            next: None,
            base: Duration::ZERO,
            at_rest: true,
            start_at: None,
            told_at: None,
            unfinished: false,
            held: false,
            jogs: false,
            cancelling: false,
            dark: false,
            laser: 0,
            percents: Percents::default(),
            phase: None,
            pen_deg: settings.stored.pen_up_deg,
            beam: Beam::OFF,
            due: None,
            lateness: Lateness::default(),
            #[cfg(feature = "step-ahead")]
            ahead: ahead::Ahead::default(),
            #[cfg(feature = "third-motor")]
            z: M::Rise::default(),
        };
        #[cfg(feature = "third-motor")]
        motion.tell_z();
        motion
    }

    /// The next step that is due by `now`, if there is one and the motors' drivers can take it. One that they
    /// cannot take is not counted, and stays due.
    #[inline]
    pub fn poll(&mut self, now: Duration, drivers: Drivers, link: &mut Link) -> Option<Step<'_>> {
        self.next_step(now, drivers, link)
    }

    /// The same, for who asks again when there was none.
    pub(super) fn next_step(
        &mut self,
        now: Duration,
        drivers: Drivers,
        link: &mut Link,
    ) -> Option<Step<'static>> {
        self.due = None;
        // Ends: every turn takes something from a queue, from the planner or from the step generator.
        loop {
            match self.state {
                State::Stopped => match link.commands.pop() {
                    None => return None,
                    Some(Command::GoOn) => self.make_ready(),
                    Some(Command::Unlock) => {
                        self.gate.reset();
                        self.make_ready();
                    }
                    Some(command @ (Command::Set(_) | Command::Restore)) => self.stand(command, now, link),
                    Some(command) => self.leave_out(command),
                },
                State::Homing(_) => {
                    let step = self.home(now, drivers, link);
                    if step.is_some() || matches!(self.state, State::Homing(_)) {
                        return step;
                    }
                }
                State::Ready => match self.next.map(|event| (event, self.time_of(event.tick))) {
                    Some((event, at)) if !has_come(at, now) || drivers.keep_back(event.event) => {
                        self.due = Some(at);
                        return None;
                    }
                    Some((event, at)) => {
                        self.next = None;
                        if let Some(pulse) = self.give(event.event, link) {
                            self.lateness.given(at, now, &mut self.base);
                            return Some(Step { at, pulse });
                        }
                    }
                    None if self.go_on(now, link) =>
                    {
                        #[cfg(feature = "step-ahead")]
                        if self.ahead.in_parts {
                            return None;
                        }
                    }
                    None => return None,
                },
            }
        }
    }

    /// When [`poll`](Self::poll) is to be called next, if nothing comes before; known after it has given no
    /// step.
    #[must_use]
    pub const fn due(&self) -> Option<Duration> {
        self.due
    }

    /// Commands have come for a side that waits for nothing.
    pub(super) fn wake(&mut self, now: Duration) {
        self.due = self.due.or(Some(now));
    }

    /// Takes a signal from the receive side.
    pub fn signal(&mut self, now: Duration, signal: Signal, link: &mut Link) {
        match signal {
            // A jog that is held is over, as in Grbl.
            Signal::Hold | Signal::JogCancel if self.jogs_now(link) => self.cancel(link),
            Signal::JogCancel => {}
            // Homing is not held, as in Grbl; what has been stopped neither.
            Signal::Hold if self.state == State::Ready => self.hold(),
            Signal::Hold => {}
            Signal::Speeds { draw_percent, travel_percent } => {
                if M::ALL {
                    (self.percents.draw, self.percents.travel) = (draw_percent, travel_percent);
                    self.override_speeds();
                }
            }
            Signal::LaserPercent(percent) => {
                self.percents.laser = percent;
                self.shine();
            }
            // A jog that ends is not to go on.
            Signal::Resume if self.cancelling => {}
            Signal::Resume => {
                self.held = false;
                self.planner.resume();
            }
            Signal::Reset => {
                let during = self.status(now).activity;
                self.gate.stop_by_host(true);
                self.stop(Stop::Reset { during }, link);
                self.end_overrides();
            }
            Signal::LaserOff => {
                self.dark = true;
                self.beam = Beam::OFF;
            }
        }
    }

    /// Takes the state of a limit switch.
    pub const fn limit_switch(&mut self, axis: Axis, end: Direction, pressed: bool) {
        let mut limits: LimitSwitches = self.gate.limits();
        limits.set(axis, end, pressed);
        self.gate.set_limits(limits);
    }

    /// Takes the state of the emergency stop button; pressed, it stops everything at once and latches.
    pub fn emergency_stop(&mut self, pressed: bool, link: &mut Link) {
        let was_latched = self.gate.is_latched();
        self.gate.emergency_stop(pressed);
        if pressed && !was_latched {
            self.stop(Stop::Emergency, link);
        }
    }

    /// Unlatches the emergency stop, unless the button is still pressed; says whether it did.
    pub const fn reset_emergency_stop(&mut self) -> bool {
        self.gate.reset()
    }

    /// Begins anew with what the host has stored: stops, if it moves, and stands where it is.
    pub fn restart(&mut self, stored: StoredSettings, link: &mut Link) {
        let settings = StepperPlotterSettings { stored, ..self.settings };
        let limits = settings.limits();
        // The window over which motion is averaged does not depend on what is stored.
        #[cfg(feature = "averaged-steps")]
        let limits = limits.planned_of_checked().settings;
        // The limits were good, and only become less: a planner that cannot be had leaves the old one.
        if let Ok(planner) = Planner::with_modes(limits) {
            self.settings = settings;
            self.planner = planner;
            #[cfg(feature = "third-motor")]
            self.tell_z();
        }
        self.percents = Percents::default();
        if self.gate.is_latched() {
            self.stop(Stop::Emergency, link);
        } else {
            self.halt(link);
            self.make_ready();
        }
    }

    /// A machine whose stop is latched when it is switched on begins stopped.
    pub(super) fn begin_stopped(&mut self, link: &mut Link) {
        if self.gate.is_stopped() {
            self.stop(Stop::Emergency, link);
        }
    }

    /// Servo of the pen, degrees.
    #[must_use]
    pub const fn pen_deg(&self) -> u8 {
        self.pen_deg
    }

    /// Power of the laser.
    #[must_use]
    pub const fn beam(&self) -> Beam<'_> {
        self.beam
    }

    /// The settings as they hold now.
    #[must_use]
    pub const fn settings(&self) -> &StepperPlotterSettings {
        &self.settings
    }

    /// How late steps have been given since the machine was switched on.
    #[must_use]
    pub const fn lateness(&self) -> Lateness {
        self.lateness
    }

    /// What homing has measured last: none before, nor with [`ExactOnly`](crate::planner::ExactOnly).
    #[must_use]
    pub fn homed(&self) -> Option<Homed> {
        self.measured.get()?.homed
    }

    /// Takes what an earlier homing has measured and a firmware has kept.
    pub(super) fn set_homed(&mut self, homed: Homed) {
        if let Some(measured) = self.measured.get_mut() {
            measured.homed = Some(homed);
        }
    }

    /// How many steps the carriage stood away from where it was believed to be, as the last homing has found:
    /// what motors have lost since the one before. None until the machine has homed twice.
    #[must_use]
    pub fn off_steps(&self) -> Option<StepPoint> {
        self.measured.get()?.off
    }

    /// Where the motors stand: steps really made, also those that take up play.
    #[must_use]
    pub const fn position(&self) -> StepPoint {
        self.position
    }

    /// Where the pen is by the steps really made, mm.
    #[must_use]
    pub fn position_mm(&self) -> Point {
        self.steps.kinematics().point_at(self.carriage().into())
    }

    /// What the receive side may know.
    #[must_use]
    pub fn status(&self, now: Duration) -> Status {
        let moves = self.moves(now);
        let has_work = moves || self.unfinished || !self.planner.is_empty();
        let activity = match self.state {
            State::Stopped => Activity::Stopped,
            State::Homing(_) => Activity::Home,
            State::Ready if self.jogs => Activity::Jog,
            State::Ready if self.held => Activity::Hold { stands: !moves },
            State::Ready if has_work => Activity::Run,
            State::Ready => Activity::Idle,
        };
        let speed_mm_s = self.phase.map_or(0.0, |(began, phase)| {
            let time_s = now.saturating_sub(began).as_secs_f32();
            if time_s > phase.duration_s { 0.0 } else { greatest(phase.speed_at::<M>(time_s), 0.0) }
        });
        #[cfg(feature = "third-motor")]
        let speed_mm_s = self.true_speed(speed_mm_s);
        #[cfg(feature = "averaged-steps")]
        let speed_mm_s = self.averaged_speed().unwrap_or(speed_mm_s);
        let planned = self.planner.blocks() + usize::from(has_work);
        Status {
            activity,
            planned: u8::try_from(planned).unwrap_or(u8::MAX),
            at: self.position_mm(),
            #[cfg(feature = "third-motor")]
            z_mm: self.z_mm(),
            #[cfg(feature = "third-motor")]
            z_switches: self.gate.z_limits(),
            #[cfg(feature = "third-motor")]
            second_switches: self.gate.second_limits(),
            #[cfg(feature = "third-motor")]
            skew_steps: self.skew_steps(),
            speed_mm_s,
            laser: self.beam.power(),
            percents: self.percents,
            limits: self.gate.limits(),
            emergency_stop: self.gate.is_latched(),
            emergency_button: self.gate.is_button_pressed(),
            restores: M::ALL,
        }
    }

    /// Where the carriage is, steps.
    fn carriage(&self) -> StepPoint {
        #[cfg(feature = "step-ahead")]
        if let Some(made) = self.ahead.made {
            return made.gap.carriage(made.at);
        }
        self.play.get().map_or(self.position, |play| play.carriage(self.position))
    }

    /// Gives the laser its share of the power.
    fn shine(&mut self) {
        if !M::LASER {
            return;
        }
        let power = u32::from(self.laser) * u32::from(self.percents.laser) / 100;
        let power = u16::try_from(power).unwrap_or(u16::MAX);
        self.beam = self.gate.pass_laser(if self.dark { 0 } else { power }).kept();
    }

    /// Whether something is on its way: steps, or a pause that is not over.
    fn moves(&self, now: Duration) -> bool {
        #[cfg(feature = "step-ahead")]
        if self.ahead.made.is_some_and(|made| !made.stands) {
            return true;
        }
        self.next.is_some() || !self.at_rest || !has_come(self.time_of(self.tick()), now)
    }

    /// When all that has been taken from the planner is over.
    fn tick(&self) -> u64 {
        #[cfg(feature = "averaged-steps")]
        if let Some(average) = self.average.get() {
            return self.steps.tick().saturating_add(average.delay_ticks());
        }
        self.steps.tick()
    }

    /// The speed by the steps of the window, if these are averaged, mm/s.
    #[cfg(feature = "averaged-steps")]
    fn averaged_speed(&self) -> Option<f32> {
        let [x_hz, y_hz] = self.average.get()?.rates_hz(CLOCK_HZ)?;
        let (x, y) = (single(self.settings.x_steps_per_mm), single(self.settings.y_steps_per_mm));
        let (x_mm_s, y_mm_s) = (x_hz / x, y_hz / y);
        Some(crate::root::root(x_mm_s * x_mm_s + y_mm_s * y_mm_s))
    }

    fn time_of(&self, tick: u64) -> Duration {
        self.base.saturating_add(Duration::from_micros(tick))
    }

    /// A machine that has stood begins now.
    fn begin(&mut self, now: Duration) {
        let late = now.saturating_sub(self.time_of(self.tick()));
        self.base = self.base.saturating_add(late);
    }

    fn hold(&mut self) {
        self.held = true;
        self.planner.hold();
    }

    /// Everything ceases, and the machine stands where it has been stepped to.
    fn halt(&mut self, link: &mut Link) {
        let at = self.position_mm();
        self.planner.clear(at);
        darken(&mut self.planner);
        self.steps.clear(self.carriage());
        #[cfg(feature = "averaged-steps")]
        if let Some(average) = self.average.get_mut() {
            average.clear(self.steps.tick());
        }
        #[cfg(feature = "third-motor")]
        self.tell_z();
        if let Some(play) = self.play.get_mut() {
            play.stopped();
        }
        while let Some(command) = link.commands.pop() {
            self.leave_out(command);
        }
        (self.next, self.phase, self.start_at) = (None, None, None);
        (self.at_rest, self.unfinished, self.held, self.dark) = (true, false, false, false);
        (self.jogs, self.cancelling, self.laser) = (false, false, 0);
        self.beam = Beam::OFF;
        self.put_pen(Pen::Up);
    }

    /// What does not move is done even so.
    fn leave_out(&mut self, command: Command) {
        match command {
            Command::PenAngles { up_deg, down_deg } => {
                self.settings.stored.pen_up_deg = up_deg;
                self.settings.stored.pen_down_deg = down_deg;
            }
            Command::Set(setting) => self.set(setting),
            Command::Restore => self.restore(),
            _ => {}
        }
    }

    /// Commands are carried out again, and the host's stop is over.
    const fn make_ready(&mut self) {
        self.gate.stop_by_host(false);
        self.state = State::Ready;
    }

    fn stop(&mut self, why: Stop, link: &mut Link) {
        self.halt(link);
        self.state = State::Stopped;
        // A full queue has a stop in it already.
        let _ = link.reports.push(Report::Stopped { at: self.position_mm(), why });
    }
}

/// What makes the steps of a machine.
fn step_gen<M: Modes>(settings: &StepperPlotterSettings) -> StepGen<Cartesian, M> {
    // mDraw moves the servo itself, and the motion waits for that.
    let pen_settle = match settings.dialect {
        Dialect::MDraw => Duration::ZERO,
        // A motor's steps are over when they are over.
        #[cfg(feature = "third-motor")]
        Dialect::Grbl if settings.z.is_some() => Duration::ZERO,
        Dialect::Grbl => settings.pen_settle,
    };
    let timing = StepGenSettings { clock_hz: CLOCK_HZ, pen_settle, laser: settings.laser };
    StepGen::with_modes(settings.cartesian(), timing)
}

/// The laser has no power until it is told one.
fn darken<M: Modes>(planner: &mut Planner<BLOCKS, M>) {
    if !M::LASER {
        return;
    }
    let pushed = planner.push(PlotOp::LaserPower { share: 0.0 });
    debug_assert!(pushed.is_ok(), "it is empty");
}

#[cfg(test)]
mod tests;
