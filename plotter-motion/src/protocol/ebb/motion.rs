//! [`EbbMotion`]: planned motion as commands of the board.

use super::command::{EbbCommand, EbbEvent};
use super::piece::Piece;
use crate::kinematics::{Kinematics, MotorPoint};
use crate::planner::{Action, Course, Phase};
use crate::stepgen::{Busy, place_on};
use crate::{Pen, Point, StepPoint};
use core::time::Duration;

/// Longest command, ms: a person who stops the machine waits for it. Twice as long makes a 64 mm line at
/// 50 mm/s 20 commands instead of 21: what is longer saves nothing.
const LONGEST_MS: usize = 64;
/// A millisecond, s.
const MS: f64 = 1e-3;
/// What is less than this of a millisecond is left out, s: a phase's times have 24 bits.
const LEAST_S: f64 = 1e-7;
/// A motion that ends nearer than this to the end of its course ends there, mm.
const LATE_MM: f64 = 1e-3;
/// The direction of a course at its ends is that of this share of it.
const NEAR_SHARE: f64 = 1e-3;
/// At a corner the speed of a motor jumps by more than this, steps/ms: half of it for half a millisecond is a
/// quarter of a step beside the path.
const CORNER_STEPS_MS: f64 = 0.5;

/// Motion commands that the board knows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum EbbDialect {
    /// LM with a parameter that clears the accumulators: firmware 2.7.0 and later.
    #[default]
    LowLevel,
    /// SM alone: constant speeds, for older firmware.
    Constant,
}

/// How a motion is divided into commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EbbMotionSettings {
    /// Motion commands to use.
    pub dialect: EbbDialect,
    /// How long the machine stands after the pen has been lowered or lifted.
    pub pen_settle: Duration,
    /// Shortest move, ms, 1 to 32. By default 4: the documentation's section "Performance" says that a board
    /// keeps up with moves of 3 to 5 ms, one after the other.
    pub shortest_ms: u8,
    /// By how much more than a step a motor may be from its place, steps. By default a quarter: without, a
    /// move ends wherever the acceleration changes by little.
    pub allowance_steps: f64,
}

impl Default for EbbMotionSettings {
    fn default() -> Self {
        Self {
            dialect: EbbDialect::default(),
            pen_settle: Duration::from_millis(200),
            shortest_ms: 4,
            allowance_steps: 0.25,
        }
    }
}

/// What is said once the motion before it is over.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Next {
    Nothing,
    Pen(Pen),
    Wait(u32),
    Event(EbbEvent),
}

/// Turns the actions of a [`Planner`](crate::Planner) into commands of the board: planned motion is looked at
/// each millisecond, and as long a stretch as one move can follow becomes a move.
///
/// - Each move leads both motors from whole step to whole step, so that a drawing ends exactly where it was
///   to end, whatever was rounded on the way.
/// - A motor is never farther from its planned place than a step and
///   [`allowance_steps`](EbbMotionSettings::allowance_steps), where no two corners are nearer to each other
///   than [`shortest_ms`](EbbMotionSettings::shortest_ms).
/// - A run from rest to rest takes up to [`shortest_ms`](EbbMotionSettings::shortest_ms) more than planned,
///   and a sharp corner up to a millisecond.
///
/// Push an action, take events until there are none, push the next; [`rest`](Self::rest) at the end.
///
/// ```
/// # use plotter_motion::kinematics::{Cartesian, MotorScale};
/// # use plotter_motion::protocol::ebb::{EbbCommand, EbbEvent, EbbMotion, EbbMotionSettings};
/// # use plotter_motion::{Planner, PlannerSettings, PlotOp, Point};
/// let motor = MotorScale { steps_per_mm: 80.0, inverted: false };
/// let mut motion = EbbMotion::new(Cartesian::new(motor, motor)?, EbbMotionSettings::default());
/// let mut planner = Planner::<16>::new(PlannerSettings::default())?; // 100 mm/s, 1000 mm/s²
/// planner.push(PlotOp::Travel { to: Point::new(10.0, 0.0) })?;
/// planner.finish()?;
/// let (mut steps, mut lines) = (0, 0);
/// let mut count = |event| {
///     let EbbEvent::Command(EbbCommand::LowLevel(of)) = event else { return };
///     (steps, lines) = (steps + of.motors[0].steps, lines + 1);
/// };
/// while let Some(action) = planner.next_action() {
///     motion.push(action)?;
///     while let Some(event) = motion.next_event() {
///         count(event);
///     }
/// }
/// motion.rest();
/// while let Some(event) = motion.next_event() {
///     count(event);
/// }
/// assert_eq!(steps, 800);
/// assert!(lines < 20); // 200 ms
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct EbbMotion<K> {
    kinematics: K,
    settings: EbbMotionSettings,
    /// Where the course begins, the course, and where on it the last phase ended.
    from: Point,
    course: Course,
    at: Point,
    /// Speed at the end of the last phase, mm/s.
    speed_mm_s: f64,
    phase: Option<Phase>,
    /// When the next sample is due, from the start of the phase, s.
    due_s: f64,
    samples: [MotorPoint; LONGEST_MS + 1],
    /// Samples behind the first, which is where the last move ended.
    count: usize,
    /// Whether the machine stands at the last of them.
    is_resting: bool,
    made: StepPoint,
    pen: Pen,
    next: Next,
    /// What comes behind a pen that is lifted for it.
    after: Option<EbbEvent>,
    most_off: f64,
}

impl<K: Kinematics> EbbMotion<K> {
    /// Of a machine that stands at the origin with its pen up.
    #[must_use]
    pub fn new(kinematics: K, settings: EbbMotionSettings) -> Self {
        let settings = EbbMotionSettings {
            shortest_ms: settings.shortest_ms.clamp(1, 32),
            allowance_steps: settings.allowance_steps.clamp(0.0, 100.0),
            ..settings
        };
        let mut motion = Self {
            kinematics,
            settings,
            from: Point::ORIGIN,
            course: Course::default(),
            at: Point::ORIGIN,
            speed_mm_s: 0.0,
            phase: None,
            due_s: MS,
            samples: [MotorPoint::default(); LONGEST_MS + 1],
            count: 0,
            is_resting: false,
            made: StepPoint::default(),
            pen: Pen::Up,
            next: Next::Nothing,
            after: None,
            most_off: 0.0,
        };
        motion.stand_at(StepPoint::default());
        motion
    }

    /// Forgets all that was pushed: the motors stand here, with the pen up.
    pub fn stand_at(&mut self, made: StepPoint) {
        let at = MotorPoint::from(made);
        (self.made, self.pen) = (made, Pen::Up);
        self.from = self.kinematics.point_at(at);
        self.at = self.from;
        self.course = Course { to: self.from, ..Course::default() };
        (self.phase, self.due_s, self.next, self.after) = (None, MS, Next::Nothing, None);
        (self.samples, self.count, self.is_resting) = ([at; LONGEST_MS + 1], 0, false);
    }

    /// Whether no event is left of what was pushed.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.phase.is_none() && !self.is_resting && self.next == Next::Nothing
    }

    /// Makes what follows of these commands.
    pub const fn set_dialect(&mut self, dialect: EbbDialect) {
        self.settings.dialect = dialect;
    }

    /// Where the motors stand behind the last event.
    #[must_use]
    pub const fn made(&self) -> StepPoint {
        self.made
    }

    /// How far a motor was at most from its place, steps, looked at each millisecond; 1 at least.
    #[must_use]
    pub const fn most_off(&self) -> f64 {
        self.most_off
    }

    /// The kinematics.
    #[must_use]
    pub const fn kinematics(&self) -> &K {
        &self.kinematics
    }

    /// Takes an action of a planner.
    ///
    /// # Errors
    ///
    /// [`Busy`]: events of the action before are left.
    pub fn push(&mut self, action: Action) -> Result<(), Busy> {
        if !self.is_idle() {
            return Err(Busy);
        }
        match action {
            Action::Course(course) => {
                if course.pen != self.pen {
                    self.rest_for(Next::Pen(course.pen));
                } else if self.due_s < MS - LEAST_S && self.is_corner(&course) {
                    // A move may end there.
                    let at = self.kinematics.motors_at(self.course.to);
                    self.push_sample(at);
                    self.due_s = MS;
                }
                (self.from, self.course) = (self.course.to, course);
                self.at = self.from;
            }
            Action::Phase(phase) => {
                self.phase = (f64::from(phase.duration_s) > 0.0).then_some(phase);
            }
            Action::Dwell(time) => {
                let ms = u32::try_from(time.as_millis()).unwrap_or(u32::MAX);
                self.rest_for(if ms == 0 { Next::Nothing } else { Next::Wait(ms) });
            }
            Action::SelectPen(pen) => self.rest_lifted(EbbEvent::SelectPen(pen)),
            Action::NewPage => self.rest_lifted(EbbEvent::NewPage),
        }
        Ok(())
    }

    /// Says that no action comes for now: the machine stands where the last one ended.
    pub fn rest(&mut self) {
        if self.phase.is_none() && !self.is_resting {
            self.rest_for(Next::Nothing);
        }
    }

    fn rest_lifted(&mut self, event: EbbEvent) {
        if self.pen == Pen::Down {
            self.rest_for(Next::Pen(Pen::Up));
            self.after = Some(event);
        } else {
            self.rest_for(Next::Event(event));
        }
    }

    fn rest_for(&mut self, next: Next) {
        self.next = next;
        let place = self.rest_place();
        let at = self.kinematics.motors_at(place);
        // What is left of a millisecond is one.
        if self.due_s < MS - LEAST_S {
            self.push_sample(at);
        } else if let Some(last) = self.samples.get_mut(self.count).filter(|_| self.count > 0) {
            *last = at;
        }
        self.at = place;
        self.due_s = MS;
        self.is_resting = self.count > 0;
    }

    /// Whether a motor's speed jumps where a course follows that was pushed, so that no move leads past it.
    fn is_corner(&self, next: &Course) -> bool {
        let corner = self.course.to;
        let before = place_on(&self.course, &self.from, 1.0 - NEAR_SHARE);
        let after = place_on(next, &corner, NEAR_SHARE);
        let (Some(before), Some(after)) = ((corner - before).normalized(), (after - corner).normalized())
        else {
            return false;
        };
        let jump_mm = (after - before) * (self.speed_mm_s * MS);
        let jump = self.kinematics.motors_at(Point::ORIGIN + jump_mm);
        jump.x.abs().max(jump.y.abs()) > CORNER_STEPS_MS
    }

    /// Where the motion ends that was pushed: at the end of its course, unless the machine was held before.
    fn rest_place(&self) -> Point {
        if self.at.distance(self.course.to) <= LATE_MM { self.course.to } else { self.at }
    }

    fn push_sample(&mut self, at: MotorPoint) {
        if let Some(slot) = self.samples.get_mut(self.count + 1) {
            *slot = at;
            self.count += 1;
        }
    }

    /// The next event, if what was pushed gives one.
    pub fn next_event(&mut self) -> Option<EbbEvent> {
        loop {
            if self.is_resting {
                return Some(self.cut(true));
            }
            match core::mem::replace(&mut self.next, Next::Nothing) {
                Next::Nothing => {}
                Next::Pen(pen) => {
                    self.pen = pen;
                    self.next = self.after.take().map_or(Next::Nothing, Next::Event);
                    let settle = self.settings.pen_settle.as_millis();
                    let duration_ms = u16::try_from(settle).unwrap_or(u16::MAX);
                    return Some(EbbEvent::Command(EbbCommand::Pen { pen, duration_ms }));
                }
                Next::Wait(left_ms) => {
                    // The board leaves a longer wait out.
                    let duration_ms = left_ms.min(60_000);
                    if left_ms > duration_ms {
                        self.next = Next::Wait(left_ms - duration_ms);
                    }
                    return Some(EbbEvent::Command(EbbCommand::Constant { duration_ms, steps: [0; 2] }));
                }
                Next::Event(event) => return Some(event),
            }
            let phase = self.phase?;
            let lasts_s = f64::from(phase.duration_s);
            while self.due_s <= lasts_s && self.count < LONGEST_MS {
                let at = self.kinematics.motors_at(self.place(&phase, self.due_s));
                self.push_sample(at);
                self.due_s += MS;
            }
            if self.count == LONGEST_MS {
                return Some(self.cut(false));
            }
            self.at = self.place(&phase, lasts_s);
            self.speed_mm_s = phase.at(lasts_s).speed_mm_s;
            self.due_s -= lasts_s;
            self.phase = None;
        }
    }

    fn place(&self, phase: &Phase, time_s: f64) -> Point {
        let length_mm = f64::from(self.course.length_mm);
        let way_mm = phase.at(time_s).distance_mm;
        let share = if length_mm > 0.0 { (way_mm / length_mm).clamp(0.0, 1.0) } else { 1.0 };
        place_on(&self.course, &self.from, share)
    }

    /// The longest move that follows the samples from the first.
    fn cut(&mut self, is_rest: bool) -> EbbEvent {
        let shortest = usize::from(self.settings.shortest_ms);
        // A run that is too short takes longer.
        while is_rest && self.count < shortest {
            let last = self.samples.get(self.count).copied().unwrap_or_default();
            self.push_sample(last);
        }
        let allowed = 1.0 + self.settings.allowance_steps;
        let mut chosen = None;
        // Where more comes, enough for another move is kept for it.
        let most = if is_rest { self.count } else { self.count.saturating_sub(shortest).max(shortest) };
        for count in (shortest..=most).rev() {
            let ends = is_rest && count == self.count;
            // What is left is no move too short.
            if is_rest && !ends && self.count - count < shortest && count != shortest {
                continue;
            }
            let Some(samples) = self.samples.get(..=count) else { continue };
            let Some((piece, off)) = Piece::fit(self.made, samples, ends, self.settings.dialect) else {
                continue;
            };
            chosen = Some((count, piece, off));
            if off <= allowed {
                break;
            }
        }
        let (count, piece, off) = chosen.unwrap_or_default();
        self.most_off = self.most_off.max(off);
        self.samples.copy_within(count.min(LONGEST_MS).., 0);
        self.count -= count;
        self.is_resting = is_rest && self.count > 0;
        self.made = piece.end(self.made);
        EbbEvent::Command(match (self.settings.dialect, piece.steps()) {
            (_, [0, 0]) | (EbbDialect::Constant, _) => {
                EbbCommand::Constant { duration_ms: piece.ms(), steps: piece.steps() }
            }
            (EbbDialect::LowLevel, _) => EbbCommand::LowLevel(piece.low_level()),
        })
    }
}
