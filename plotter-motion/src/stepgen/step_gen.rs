//! [`StepGen`]: actions in, timed events out.

use super::chord::Chords;
use super::moment::Moment;
use super::slice::{Slice, speed_fixed};
use crate::config::SteppersConfig;
use crate::extremes::greatest;
use crate::geom::single;
use crate::kinematics::Kinematics;
use crate::planner::{AllModes, Keep as _, Modes};
use crate::{
    Bresenham, Machine, Pen, Point, StepPair, StepPoint,
    planner::{Action, Course, Phase},
};
use core::fmt;
use core::marker::PhantomData;
use core::time::Duration;

/// Greatest distance of a chord from its course, steps: with the half step of rounding a motor stays within
/// one step.
const CHORD_STEPS: f32 = 0.25;
/// A phase that ends nearer than this to the end of its course ends there, mm: far below a motor's step.
const LATE_MM: f32 = 2e-6;
/// The same as a share of the course, for long ones: two last bits of `f32`.
const LATE_SHARE: f32 = 2.5e-7;
/// A course that ends slower than this ends at rest, mm/s: the least limit that is planned with.
const STANDSTILL_MM_S: f32 = 1e-3;

/// How steps are timed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct StepGenSettings {
    /// Ticks of the clock in a second: 1000 to 10⁹. The default is a microsecond.
    pub clock_hz: u32,
    /// How long the machine stands after the pen has been lowered or lifted.
    pub pen_settle: Duration,
    /// Whether a laser takes the place of the pen: it is on while it moves, and its power follows the speed.
    pub laser: bool,
}

impl Default for StepGenSettings {
    /// Microseconds, and the 200 ms that the documented machine's pen needs: with less, dots get tails.
    fn default() -> Self {
        Self { clock_hz: 1_000_000, pen_settle: Duration::from_millis(200), laser: false }
    }
}

impl StepGenSettings {
    /// Those of a machine with stepper motors, in microseconds.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let config = SteppersConfig::of(machine);
        Self {
            pen_settle: Duration::from_secs_f64(config.pen.settle_ms / 1e3),
            laser: config.laser.enabled,
            ..Self::default()
        }
    }

    /// With a clock as fast as can be counted, and no laser where none is built in.
    pub(super) fn checked<M: Modes>(self) -> Self {
        Self { clock_hz: self.clock_hz.clamp(1_000, 1_000_000_000), laser: self.laser && M::LASER, ..self }
    }

    /// How long the machine stands for a pen that goes from one state to another; none where it does not, and
    /// a laser never does.
    pub(super) fn pen_time<M: Modes>(&self, from: Pen, to: Pen) -> Option<Duration> {
        (from != to && !(M::LASER && self.laser)).then_some(self.pen_settle)
    }
}

/// Events for the motors, the pen and the laser.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum MotorEvent {
    /// A step of either motor or of both.
    Step(StepPair),
    /// A step of the third motor: 1 upwards, -1 downwards.
    #[cfg(feature = "third-motor")]
    StepZ(i8),
    /// The pen is lowered or lifted.
    Pen(Pen),
    /// The laser's power from here on, in 65535ths.
    Laser(u16),
    /// Another pen is taken.
    SelectPen(u8),
    /// A new sheet.
    NewPage,
}

/// An event with its time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct TimedEvent {
    /// Ticks of the clock since the start.
    pub tick: u64,
    /// The event.
    pub event: MotorEvent,
}

/// The action before has not been finished: take its events first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy;

impl fmt::Display for Busy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the events of the action before have not all been taken")
    }
}

impl core::error::Error for Busy {}

/// A phase that is being stepped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Running {
    phase: Phase,
    end: Moment,
    /// Ticks to its end from the start of the slice.
    left: i64,
    slice: Slice,
    /// Ticks of the slice at which the last step was, and until the next one is guessed to be due, and by how
    /// much that changes.
    at: i64,
    interval: i64,
    change: i64,
}

/// Turns the actions of a [`Planner`](crate::Planner) into timed steps of the motors.
///
/// Push an action, take events until there are none, push the next.
///
/// ```
/// # use plotter_motion::kinematics::{Cartesian, MotorScale};
/// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point, StepGen};
/// # use plotter_motion::stepgen::{MotorEvent, StepGenSettings};
/// let mut planner = Planner::<16>::new(PlannerSettings::default())?;
/// let motor = MotorScale { steps_per_mm: 100.0, inverted: false };
/// let mut steps = StepGen::new(Cartesian::new(motor, motor)?, StepGenSettings::default());
/// planner.push(PlotOp::Travel { to: Point::new(10.0, 0.0) })?;
/// planner.finish()?;
/// let mut ticks = Vec::new();
/// while let Some(action) = planner.next_action() {
///     steps.push(action)?;
///     while let Some(event) = steps.next_event() {
///         ticks.push(event.tick);
///     }
/// }
/// assert_eq!(ticks.len(), 1000);
/// // the first is due after half a step, 0.005 mm: sqrt(2 s / a) = 3.162 ms after the start
/// assert_eq!(ticks[0], 3162);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct StepGen<K, M: Modes = AllModes> {
    modes: PhantomData<M>,
    kinematics: K,
    settings: StepGenSettings,
    chord_tolerance_mm: f32,
    seconds_per_tick: f32,
    /// The end of the action pushed last.
    now: Moment,
    /// Where the path and the motors are.
    at: Point,
    pen: Pen,
    course: Course,
    /// Its speed in mm a tick, 52 bits of fraction.
    course_speed: i64,
    chords: Chords,
    /// The chord in progress: its steps to come, and the distance along the course at which the next one is
    /// due, that of the chord's end, and how the due distances go on.
    line: Bresenham,
    due: Option<Due>,
    chord_from: i64,
    /// Whether the course is over, and its remaining steps are due at once.
    late: bool,
    /// An action that waits for them.
    put_off: Option<Action>,
    running: Option<Running>,
    /// Tick of the last step, and how long after the one before.
    last_step: u64,
    interval: i64,
    /// The laser's power that was given out last, 0 at a standstill.
    laser: u16,
    waiting: [Option<TimedEvent>; 2],
    z: M::Rise<ZSteps>,
}

/// The third motor: its steps come evenly along a course, whatever the others do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ZSteps {
    steps_per_mm: f64,
    /// Where it has been stepped to.
    at: i32,
    up: bool,
    due: Option<Due>,
    /// When its last step was.
    tick: u64,
}

#[cfg(feature = "third-motor")]
impl ZSteps {
    /// Goes to a height along a course of this length, mm with 32 bits of fraction.
    fn begin(&mut self, to_mm: f64, length: i64) {
        let to = crate::toolpath::from_mm(to_mm, self.steps_per_mm);
        self.up = to > self.at;
        self.due = Due::new(0, length, to.abs_diff(self.at));
    }

    /// Its step that is due.
    fn step(&mut self, tick: u64) -> Option<TimedEvent> {
        let left = self.due.as_mut()?.advance();
        if !left {
            self.due = None;
        }
        let way = if self.up { 1 } else { -1 };
        self.at = self.at.saturating_add(way.into());
        self.tick = tick;
        Some(TimedEvent { tick, event: MotorEvent::StepZ(way) })
    }
}

/// The distances at which the steps of a chord are due: evenly spaced, the first half a space after its
/// start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Due {
    /// mm with 32 bits of fraction, and the rest of the division.
    at: i64,
    rest: i64,
    space: i64,
    space_rest: i64,
    steps: i64,
    left: u32,
}

impl Due {
    fn new(from: i64, to: i64, steps: u32) -> Option<Self> {
        let count = i64::from(steps);
        if count == 0 {
            return None;
        }
        // Neither is below 0.
        let way = (to - from).max(0);
        let (space, space_rest) = (way / count, way % count);
        // Half a space is half of it and half of what an odd one leaves.
        let (half, half_rest) = (space >> 1, (space & 1) * count + space_rest);
        Some(Self { at: from + half, rest: half_rest >> 1, space, space_rest, steps: count, left: steps })
    }

    fn advance(&mut self) -> bool {
        self.left -= 1;
        self.at += self.space;
        self.rest += self.space_rest;
        if self.rest >= self.steps {
            self.rest -= self.steps;
            self.at += 1;
        }
        self.left > 0
    }
}

impl<K: Kinematics> StepGen<K> {
    /// Motors that stand where the pen is at the origin.
    pub fn new(kinematics: K, settings: StepGenSettings) -> Self {
        Self::with_modes(kinematics, settings)
    }
}

impl<K: Kinematics, M: Modes> StepGen<K, M> {
    /// As [`StepGen::new`], for a planner with the modes of its type; without a laser among them there is
    /// none.
    pub fn with_modes(kinematics: K, settings: StepGenSettings) -> Self {
        let scale = |x, y| {
            let motors = kinematics.motors_at(Point::new(x, y));
            greatest(single(motors.x).abs(), single(motors.y).abs())
        };
        let steps_per_mm = greatest(scale(1.0, 0.0), scale(0.0, 1.0));
        let settings = settings.checked::<M>();
        let steps = kinematics.steps_at(Point::ORIGIN);
        Self {
            modes: PhantomData,
            kinematics,
            settings,
            chord_tolerance_mm: CHORD_STEPS / steps_per_mm,
            #[expect(clippy::cast_precision_loss, reason = "to the last bit")]
            seconds_per_tick: 1.0 / settings.clock_hz as f32,
            now: Moment::default(),
            at: Point::ORIGIN,
            pen: Pen::Up,
            course: Course::default(),
            course_speed: 0,
            chords: Chords::default(),
            line: Bresenham::new(steps, steps),
            due: None,
            chord_from: 0,
            late: false,
            put_off: None,
            running: None,
            last_step: 0,
            interval: 0,
            laser: 0,
            waiting: [None; 2],
            z: M::Rise::default(),
        }
    }

    /// How the motors move the pen.
    #[must_use]
    pub const fn kinematics(&self) -> &K {
        &self.kinematics
    }

    /// Where the motors have been stepped to.
    #[must_use]
    pub const fn steps(&self) -> StepPoint {
        self.line.position()
    }

    /// Forgets everything: the motors have been stopped and stand at `steps`, the pen is up and the laser
    /// off. The clock goes on from where it is.
    pub fn clear(&mut self, steps: StepPoint) {
        let at = self.kinematics.point_at(steps.into());
        self.at = at;
        self.pen = Pen::Up;
        (self.course, self.course_speed) = (Course { to: at, ..Course::default() }, 0);
        self.chords = Chords::default();
        self.line = Bresenham::new(steps, steps);
        (self.due, self.late, self.running, self.laser) = (None, false, None, 0);
        (self.put_off, self.waiting) = (None, [None; 2]);
        if let Some(z) = self.z.get_mut() {
            z.due = None;
        }
    }

    /// Whether steps of the course are left.
    #[inline(always)] // one comparison where there are two axes
    fn owes_steps(&self) -> bool {
        self.due.is_some() || self.z.get().is_some_and(|z| z.due.is_some())
    }

    /// The pen has been lifted by somebody else, while the motors stand: what draws next lowers it first.
    pub(crate) const fn lift(&mut self) {
        self.pen = Pen::Up;
    }

    /// The end of the last action, in ticks: when the next one begins.
    #[must_use]
    pub const fn tick(&self) -> u64 {
        self.now.tick
    }

    /// Takes the next action.
    ///
    /// # Errors
    ///
    /// [`Busy`] while events of the action before are left; the action is not taken.
    pub fn push(&mut self, action: Action) -> Result<(), Busy> {
        if self.running.is_some() || self.late || self.waiting.iter().any(Option::is_some) {
            return Err(Busy);
        }
        if self.owes_steps() && !matches!(action, Action::Phase(_)) {
            // What rounding has left of the course before comes first.
            self.late = true;
            self.put_off = Some(action);
            return Ok(());
        }
        self.start(action);
        Ok(())
    }

    fn start(&mut self, action: Action) {
        match action {
            Action::Course(course) => self.begin(course),
            Action::Phase(phase) => self.run(phase),
            Action::Dwell(duration) => self.wait(duration),
            Action::SelectPen(pen) => {
                self.put(Pen::Up);
                self.give(MotorEvent::SelectPen(pen));
            }
            Action::NewPage => {
                self.put(Pen::Up);
                self.give(MotorEvent::NewPage);
            }
        }
    }

    /// The next event; `None` when another action is wanted.
    pub fn next_event(&mut self) -> Option<TimedEvent> {
        if let Some(waiting) = self.waiting.iter_mut().find(|slot| slot.is_some()) {
            return waiting.take();
        }
        if self.late {
            return self.late_step();
        }
        loop {
            let running = self.running.as_mut()?;
            #[cfg(feature = "third-motor")]
            if M::Z
                && let Some(z) = self.z.get_mut()
                && let Some(at) = z.due.map(|due| due.at)
                && self.due.is_none_or(|due| at <= due.at)
            {
                if let Some(at) = running.slice.tick_of::<M>(at, running.at.max(0), running.guess()) {
                    // Where only z moves, its steps are those from which the next is guessed.
                    if self.due.is_none() {
                        running.step_at(at);
                    }
                    return z.step(running.slice.base.saturating_add_signed(at));
                }
                if !running.next_slice::<M>() {
                    return self.end_phase();
                }
                continue;
            }
            let Some(due) = self.due else { return self.end_phase() };
            if let Some(at) = running.slice.tick_of::<M>(due.at, running.at.max(0), running.guess()) {
                running.step_at(at);
                let tick = running.slice.base.saturating_add_signed(at);
                // A step's time is to the nearest tick: no step comes before one of the third motor.
                let tick = self.z.get().map_or(tick, |z| tick.max(z.tick));
                let speed = if self.settings.laser && M::LASER { running.slice.speed::<M>(at) } else { 0 };
                let power = self.power(speed);
                let step = self.step(tick)?;
                if !M::LASER || power == self.laser {
                    return Some(step);
                }
                self.laser = power;
                self.waiting = [Some(step), None];
                return Some(TimedEvent { tick, event: MotorEvent::Laser(power) });
            }
            if !running.next_slice::<M>() {
                return self.end_phase();
            }
        }
    }

    /// The step that is due, at a tick.
    fn step(&mut self, tick: u64) -> Option<TimedEvent> {
        let StepPair { x, y } = self.line.next()?;
        let left = self.due.as_mut().is_some_and(Due::advance);
        if !left {
            self.next_chord();
        }
        Some(TimedEvent { tick, event: MotorEvent::Step(StepPair { x, y }) })
    }

    /// The chord after the one that has been stepped, if it is not shorter than a step.
    fn next_chord(&mut self) {
        self.due = None;
        while let Some(chord) = self.chords.next::<M>(&self.course, &self.kinematics) {
            self.line = Bresenham::new(self.line.position(), chord.to);
            self.due = Due::new(self.chord_from, chord.end_mm_q32, self.line.remaining());
            self.chord_from = chord.end_mm_q32;
            if self.due.is_some() {
                return;
            }
        }
    }

    /// The laser's power at a speed in mm a tick, 52 bits of fraction: proportional to it, in 256 grades;
    /// none for a pen that is up.
    fn power(&self, speed: i64) -> u16 {
        let dark = self.course.pen == Pen::Up || self.course.laser_power == 0;
        if !M::LASER || !self.settings.laser || dark || self.course_speed <= 0 {
            return 0;
        }
        let (speed, full) = (speed.max(0).unsigned_abs(), self.course_speed.unsigned_abs());
        // So that the product fits; 16 bits less of such speeds are no loss.
        let (speed, full) = if speed >= 1 << 47 { (speed >> 16, (full >> 16).max(1)) } else { (speed, full) };
        let power = speed * u64::from(self.course.laser_power) / full;
        let power = u16::try_from(power).unwrap_or(u16::MAX).min(self.course.laser_power);
        // A laser that is on at all has some power.
        (power & !0xFF) | 0x80
    }

    /// The phase is over.
    fn end_phase(&mut self) -> Option<TimedEvent> {
        let running = self.running.take()?;
        let Phase { duration_s, from_mm, .. } = running.phase;
        self.now = running.end;
        self.last_step = running.slice.base.saturating_add_signed(running.at);
        self.interval = running.interval;
        if M::LASER && self.laser != 0 && running.phase.speed_at::<M>(duration_s) < STANDSTILL_MM_S {
            self.laser = 0;
            self.give(MotorEvent::Laser(0));
        }
        // What rounding has left of the course comes at its end.
        let left_mm = self.course.length_mm - (from_mm + running.phase.way_mm::<M>(duration_s));
        self.late = left_mm <= LATE_MM + LATE_SHARE * self.course.length_mm;
        self.next_event()
    }

    fn late_step(&mut self) -> Option<TimedEvent> {
        #[cfg(feature = "third-motor")]
        if M::Z
            && let Some(step) = self.z.get_mut().and_then(|z| z.step(self.now.tick))
        {
            return Some(step);
        }
        if self.due.is_none() {
            self.late = false;
            let action = self.put_off.take()?;
            self.start(action);
            return self.next_event();
        }
        self.step(self.now.tick)
    }

    fn give(&mut self, event: MotorEvent) {
        let event = TimedEvent { tick: self.now.tick, event };
        if let Some(slot) = self.waiting.iter_mut().find(|slot| slot.is_none()) {
            *slot = Some(event);
        }
    }

    fn wait(&mut self, duration: Duration) {
        self.now = self.now.after(duration, self.settings.clock_hz);
    }

    fn put(&mut self, pen: Pen) {
        if let Some(time) = self.settings.pen_time::<M>(self.pen, pen) {
            self.give(MotorEvent::Pen(pen));
            self.wait(time);
        }
        self.pen = pen;
    }

    #[cfg_attr(target_os = "none", inline(never))]
    fn begin(&mut self, course: Course) {
        self.put(course.pen);
        self.chords = Chords::new::<M>(&course, &self.at, self.chord_tolerance_mm);
        if M::LASER {
            self.course_speed = speed_fixed(course.feed_mm_s * self.seconds_per_tick);
        }
        self.course = course;
        self.at = course.to;
        self.chord_from = 0;
        self.next_chord();
        #[cfg(feature = "third-motor")]
        if let (Some(z), Some(to_mm)) = (self.z.get_mut(), course.to_z_mm) {
            z.begin(to_mm, super::slice::fixed(course.length_mm, super::slice::FRACTION_BITS));
        }
        // A course without length has no phase; its steps, if rounding has made one, are late.
        self.late = course.length_mm <= LATE_MM;
    }

    fn run(&mut self, phase: Phase) {
        self.put(self.course.pen);
        let Moment { tick, part } = self.now;
        let (end, left) = self.now.after_phase(phase.duration_s, self.settings.clock_hz);
        let slice = Slice::new::<M>(&phase, self.seconds_per_tick, (tick, part), left);
        let at = i64::try_from(tick.saturating_sub(self.last_step)).map_or(0, |since| -since);
        self.running = Some(Running { phase, end, left, slice, at, interval: self.interval, change: 0 });
    }
}

#[cfg(feature = "third-motor")]
impl<K: Kinematics, M: Modes> StepGen<K, M> {
    /// The third motor has so many steps to the millimetre, and stands at `steps`. Only with
    /// [`ThreeAxes`](crate::planner::ThreeAxes).
    pub fn set_z(&mut self, steps_per_mm: f64, steps: i32) {
        if let Some(z) = self.z.get_mut() {
            *z = ZSteps { steps_per_mm, at: steps, ..ZSteps::default() };
        }
    }

    /// Where the third motor has been stepped to.
    #[must_use]
    pub fn z_steps(&self) -> i32 {
        self.z.get().map_or(0, |z| z.at)
    }
}

impl Running {
    /// When the next step may be due, if the intervals go on changing as they did.
    fn guess(&self) -> i64 {
        self.at.saturating_add(self.interval).saturating_add(self.change)
    }

    fn step_at(&mut self, at: i64) {
        let interval = at - self.at;
        self.change = interval - self.interval;
        self.interval = interval;
        self.at = at;
    }

    /// Goes on with the next slice of the phase; says whether there is one.
    fn next_slice<M: Modes>(&mut self) -> bool {
        let left = self.left - self.slice.last;
        if left <= 0 {
            return false;
        }
        self.left = left;
        self.at -= self.slice.last;
        self.slice = self.slice.following::<M>(self.left);
        true
    }
}
