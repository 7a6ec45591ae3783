//! [`SteppedPlot`]: plots a drawing with simulated stepper motors, and measures every step.

use crate::machine::{Moment, MostAccel, PathDeviation, SpeedAudit};
use plotter_motion::kinematics::{Cartesian, Kinematics as _, MotorScale};
use plotter_motion::{
    Pen, Planner, PlannerSettings, PlotOp, Point, StepGen, StepPair, StepPoint,
    planner::{Action, Averaged, PlanError},
    stepgen::{AveragedSteps, MotorEvent, PlotTime, StepGenSettings, TimedEvent},
    toolpath::chords,
};

/// Blocks of look-ahead: four times as many as Grbl has on an Arduino (16).
pub const BLOCKS: usize = 64;

/// Ticks a second of the steps, so that a tick is 1 us.
const CLOCK_HZ: u32 = 1_000_000;

/// Steps within the window of an average that have room: 80 ms of both motors at 100 mm/s and 1000 steps/mm,
/// where 20,000 mm/s³ within 0.05 mm take 42 ms.
const WINDOW_STEPS: usize = 1 << 14;

/// How far chords may be from the arcs in whose place steps are compared with them, mm: a hundredth of a step
/// at 100 steps/mm.
const CHORD_MM: f64 = 1e-4;

/// Figures of a plot, measured on its steps; lengths and counts are those of the planned path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SteppedFigures {
    /// Time in motion, s, without the pen's delays and pauses.
    pub motion_s: f64,
    /// Time of the whole plot, s.
    pub total_s: f64,
    /// Pauses that the drawing asks for, s.
    pub dwell_s: f64,
    /// Planned path with the pen down, mm.
    pub draw_mm: f64,
    /// Planned path with the pen up, mm.
    pub travel_mm: f64,
    /// Lines and arcs after planning, which joins some and rounds corners: the planner's
    /// [`Course`](plotter_motion::planner::Course)s.
    pub courses: u64,
    /// Moments at which one motor or both stepped.
    pub step_events: u64,
    /// Times that the pen was lowered.
    pub strokes: u64,
    /// Times that the pen was lifted.
    pub pen_lifts: u64,
    /// Greatest speed, mm/s.
    pub max_speed_mm_s: f64,
    /// Greatest accelerations.
    pub max_accel: MostAccel,
    /// Window over which an acceleration is computed as a difference of speeds, ms.
    pub accel_window_ms: usize,
    /// Greatest distance of a step with the pen down from the drawing, mm.
    pub max_steps_off_drawing_mm: f64,
    /// Greatest distance of a vertex of the drawing from the steps, mm.
    pub max_drawing_off_steps_mm: f64,
}

impl From<&PlotTime> for SteppedFigures {
    /// The figures of a plan; those that need steps are 0.
    fn from(time: &PlotTime) -> Self {
        Self {
            motion_s: time.motion.as_secs_f64(),
            total_s: time.total.as_secs_f64(),
            dwell_s: time.dwell.as_secs_f64(),
            draw_mm: time.draw_mm,
            travel_mm: time.travel_mm,
            courses: time.courses,
            strokes: time.strokes,
            pen_lifts: time.pen_lifts,
            ..Self::default()
        }
    }
}

/// An event of a plot, for those who draw it or write it down.
#[derive(Clone, Copy, Debug)]
pub enum PlotEvent {
    /// The pen is lifted or lowered.
    Pen(Pen),
    /// Another pen is taken.
    SelectPen(u8),
    /// A new sheet is put in.
    NewPage,
    /// One motor or both make a step.
    Step {
        /// Time since the start, us.
        tick_us: u64,
        /// The x motor's step: −1, 0 or 1.
        dx: i8,
        /// The y motor's step: −1, 0 or 1.
        dy: i8,
        /// The pen's position after the step, mm.
        at: Point,
    },
    /// Speed and acceleration some milliseconds ago, and whether the pen is down.
    Moment(Moment, Pen),
}

/// A planner and a step generator, and an audit of what they do.
#[derive(Debug)]
pub struct SteppedPlot {
    planner: Planner<BLOCKS>,
    kinematics: Cartesian,
    steps: StepGen<Cartesian>,
    /// What averages the steps, where the jerk is limited as a vector.
    averaged: Option<Box<AveragedSteps<WINDOW_STEPS>>>,
    deviation: PathDeviation,
    audit: SpeedAudit,
    figures: SteppedFigures,
    /// Where the last operation pushed ends; the steps are behind by what is planned.
    drawn_to: Point,
    /// Position of the motors.
    at: StepPoint,
    /// The pen after the last step.
    pen: Pen,
    /// Tick of the last event.
    last_tick: u64,
}

impl SteppedPlot {
    /// A machine that stands at the origin. Its clock counts microseconds: `timing.clock_hz` is ignored. Its
    /// motion is averaged where the jerk is limited as a vector.
    ///
    /// # Errors
    ///
    /// A setting out of range; for a jerk as a vector a laser, or more steps in the window than have room.
    pub fn new(
        settings: PlannerSettings,
        timing: StepGenSettings,
        motors: [MotorScale; 2],
    ) -> Result<Self, String> {
        let of = settings.planned().map_err(|error| error.to_string())?;
        let averaged = AveragedSteps::of(&of, CLOCK_HZ).map(Box::new);
        if averaged.is_some() {
            if timing.laser {
                return Err(PlanError::Averaging { quantity: "a laser" }.to_string());
            }
            check_window(&of, motors)?;
        }
        let settings = of.settings;
        let planner = Planner::new(settings).map_err(|error| error.to_string())?;
        let kinematics = Cartesian::new(motors[0], motors[1]).map_err(|error| error.to_string())?;
        // Distances up to twice the allowed one, and up to two steps, are found fast. Greater ones are
        // faults, and may take longer to find.
        let reach_mm = match settings.path {
            plotter_motion::PathMode::Tolerance { path_tolerance_mm } => 2.0 * path_tolerance_mm,
            _ => 2.0 * settings.allowance_mm,
        };
        let coarsest = motors[0].steps_per_mm.min(motors[1].steps_per_mm);
        let timing = StepGenSettings { clock_hz: CLOCK_HZ, ..timing };
        Ok(Self {
            planner,
            kinematics,
            steps: StepGen::new(kinematics, timing),
            averaged,
            deviation: PathDeviation::new(reach_mm.max(2.0 / coarsest)),
            audit: SpeedAudit::new(
                Point::ORIGIN,
                1.0 / coarsest,
                settings.accel_mm_s2,
                settings.path == plotter_motion::PathMode::Exact,
            ),
            figures: SteppedFigures::default(),
            drawn_to: Point::ORIGIN,
            at: StepPoint::default(),
            pen: Pen::Up,
            last_tick: 0,
        })
    }

    /// Plans the next operation; meanwhile hands every event of the plot to `on_event`.
    ///
    /// # Errors
    ///
    /// An operation that cannot be planned; it is left out.
    pub fn push(&mut self, op: PlotOp, on_event: &mut impl FnMut(PlotEvent)) -> Result<(), PlanError> {
        while !self.planner.has_room() && self.advance(on_event) {}
        self.planner.push(op)?;
        let from = self.drawn_to;
        match op {
            PlotOp::Travel { .. } | PlotOp::SelectPen { .. } | PlotOp::NewPage => self.deviation.lift(),
            PlotOp::Draw { to, .. } => self.deviation.draw(from, to),
            PlotOp::DrawArc { .. } => {
                let mut at = from;
                // The first operation takes the arc to its place.
                for chord in chords([PlotOp::Travel { to: from }, op], CHORD_MM).skip(1) {
                    if let Some(to) = chord.target() {
                        self.deviation.draw(at, to);
                        at = to;
                    }
                }
            }
            _ => {}
        }
        self.drawn_to = op.target().unwrap_or(from);
        Ok(())
    }

    /// Runs until the machine stands, without lifting the pen, for a pause in the input. More may be pushed
    /// afterwards.
    ///
    /// # Errors
    ///
    /// None in practice: the planner refuses a rest only while it is full, and room is made first.
    pub fn rest(&mut self, on_event: &mut impl FnMut(PlotEvent)) -> Result<(), PlanError> {
        while !self.planner.has_room() && self.advance(on_event) {}
        self.planner.rest()?;
        while self.advance(on_event) {}
        self.arrive(on_event);
        Ok(())
    }

    /// Seconds since the machine began.
    #[must_use]
    pub fn now_s(&self) -> f64 {
        seconds(self.tick())
    }

    /// When what has been planned is over.
    fn tick(&self) -> u64 {
        self.steps.tick() + self.later()
    }

    /// How much later than planned all is, because the motion is averaged.
    fn later(&self) -> u64 {
        self.averaged.as_ref().map_or(0, |averaged| averaged.delay_ticks())
    }

    /// The motors come to where all that was planned has ended.
    fn arrive(&mut self, on_event: &mut impl FnMut(PlotEvent)) {
        while let Some(event) = self.averaged.as_mut().and_then(|averaged| averaged.rest()) {
            self.happens(event, on_event);
        }
    }

    /// Runs until the machine stands, lifts the pen, and returns the figures of the plot.
    ///
    /// # Errors
    ///
    /// None in practice, as of [`rest`](Self::rest).
    pub fn finish(mut self, on_event: &mut impl FnMut(PlotEvent)) -> Result<SteppedFigures, PlanError> {
        self.rest(on_event)?;
        self.planner.finish()?;
        self.deviation.lift();
        while self.advance(on_event) {}
        self.arrive(on_event);
        let pen = self.pen;
        let tick = self.tick().max(self.last_tick);
        self.audit.finish(tick, |moment| on_event(PlotEvent::Moment(moment, pen)));
        let (max_steps_off_drawing_mm, max_drawing_off_steps_mm) = self.deviation.most_mm();
        Ok(SteppedFigures {
            max_speed_mm_s: self.audit.most_speed_mm_s(),
            max_accel: self.audit.most_accel(),
            accel_window_ms: self.audit.window_ms(),
            max_steps_off_drawing_mm,
            max_drawing_off_steps_mm,
            // Each rest takes the window more over which motion is averaged.
            motion_s: self.figures.motion_s + seconds(self.later()),
            total_s: seconds(tick),
            ..self.figures
        })
    }

    /// Takes the planner's next action and makes all its steps; returns whether there was an action.
    fn advance(&mut self, on_event: &mut impl FnMut(PlotEvent)) -> bool {
        let Some(action) = self.planner.next_action() else { return false };
        let figures = &mut self.figures;
        let is_motion = match action {
            Action::Course(course) => {
                // A lift where the pen stands is neither line nor arc.
                figures.courses += u64::from(course.pen == Pen::Down || course.length_mm > 0.0);
                match course.pen {
                    Pen::Up => figures.travel_mm += f64::from(course.length_mm),
                    Pen::Down => figures.draw_mm += f64::from(course.length_mm),
                }
                if self.averaged.is_none() {
                    self.move_pen(course.pen, on_event);
                }
                false
            }
            Action::Phase(_) => true,
            Action::Dwell(duration) => {
                figures.dwell_s += duration.as_secs_f64();
                false
            }
            // Another pen, another sheet: the planner has lifted the pen for them.
            _ => {
                if self.averaged.is_none() {
                    self.move_pen(Pen::Up, on_event);
                }
                false
            }
        };
        let before = self.steps.tick();
        // It refuses an action only while events of the one before are left; the loop below takes them all.
        let pushed = self.steps.push(action);
        debug_assert!(pushed.is_ok(), "{pushed:?}");
        while let Some(event) = self.steps.next_event() {
            let Some(averaged) = &mut self.averaged else {
                self.happens(event, on_event);
                continue;
            };
            if averaged.push(event).is_err() {
                return false;
            }
            while let Some(event) = self.averaged.as_mut().and_then(|averaged| averaged.next_event()) {
                self.happens(event, on_event);
            }
        }
        if let (Action::Dwell(_), Some(averaged)) = (action, &mut self.averaged) {
            averaged.arrive();
        }
        if is_motion {
            self.figures.motion_s += seconds(self.steps.tick() - before);
        }
        true
    }

    fn happens(&mut self, TimedEvent { tick, event }: TimedEvent, on_event: &mut impl FnMut(PlotEvent)) {
        self.last_tick = tick;
        match event {
            MotorEvent::Step(StepPair { x, y }) => self.step(tick, x, y, on_event),
            MotorEvent::SelectPen(pen) => on_event(PlotEvent::SelectPen(pen)),
            MotorEvent::NewPage => on_event(PlotEvent::NewPage),
            MotorEvent::Pen(pen) if self.averaged.is_some() => self.move_pen(pen, on_event),
            _ => {}
        }
    }

    fn move_pen(&mut self, pen: Pen, on_event: &mut impl FnMut(PlotEvent)) {
        if self.pen == pen {
            return;
        }
        self.pen = pen;
        match pen {
            Pen::Down => {
                self.figures.strokes += 1;
                self.deviation.step(self.pen_position());
            }
            Pen::Up => {
                self.figures.pen_lifts += 1;
                self.deviation.lifted();
            }
        }
        on_event(PlotEvent::Pen(pen));
    }

    fn step(&mut self, tick_us: u64, dx: i8, dy: i8, on_event: &mut impl FnMut(PlotEvent)) {
        self.figures.step_events += 1;
        self.at =
            StepPoint::new(self.at.x.saturating_add(i32::from(dx)), self.at.y.saturating_add(i32::from(dy)));
        let (at, pen) = (self.pen_position(), self.pen);
        if pen == Pen::Down {
            self.deviation.step(at);
        }
        self.audit.step(tick_us, at, |moment| on_event(PlotEvent::Moment(moment, pen)));
        on_event(PlotEvent::Step { tick_us, dx, dy, at });
    }

    fn pen_position(&self) -> Point {
        self.kinematics.point_at(self.at.into())
    }
}

/// Refuses a window with more steps than have room.
fn check_window(of: &Averaged, motors: [MotorScale; 2]) -> Result<(), String> {
    let Averaged { settings, window_s } = of;
    let speed_mm_s = settings.speed_mm_s.max(settings.travel_speed_mm_s);
    let steps = window_s * speed_mm_s * (motors[0].steps_per_mm + motors[1].steps_per_mm);
    #[expect(clippy::cast_precision_loss, reason = "a power of two")]
    let most = WINDOW_STEPS as f64;
    if steps <= most {
        return Ok(());
    }
    Err(format!(
        "averaging over {window_s:.3} s takes {steps:.0} steps at {speed_mm_s} mm/s, and {most} have room: allow more jerk, a \
         lower speed, or fewer steps to the millimetre, or limit the jerk along the path"
    ))
}

#[expect(clippy::cast_precision_loss, reason = "2^53 microseconds are 285 years")]
fn seconds(ticks: u64) -> f64 {
    ticks as f64 * 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(settings: PlannerSettings, ops: &[PlotOp]) -> SteppedFigures {
        let motor = MotorScale { steps_per_mm: 100.0, inverted: false };
        let mut plot = SteppedPlot::new(settings, StepGenSettings::default(), [motor; 2]).unwrap();
        for op in ops {
            plot.push(*op, &mut |_| {}).unwrap();
        }
        plot.finish(&mut |_| {}).unwrap()
    }

    #[test]
    fn a_line_and_the_way_back_take_the_textbook_time() {
        let ops = [
            PlotOp::Draw { to: Point::new(60.0, 80.0), feed_mm_s: None },
            PlotOp::Travel { to: Point::ORIGIN },
        ];
        let found = figures(PlannerSettings::default(), &ops);
        // 100 mm at 100 mm/s and 1000 mm/s²: 1 s and 0.1 s for the ramps, twice
        assert!((found.motion_s - 2.2).abs() < 1e-4, "{found:?}");
        // the pen goes down and up, 200 ms each
        assert!((found.total_s - 2.6).abs() < 1e-4, "{found:?}");
        assert!((found.draw_mm - 100.0).abs() < 1e-9 && (found.travel_mm - 100.0).abs() < 1e-9);
        assert_eq!((found.strokes, found.pen_lifts, found.step_events), (1, 1, 16_000));
        assert!((found.max_speed_mm_s - 100.0).abs() < 1.0, "{found:?}");
        assert!((found.max_accel.along_mm_s2 - 1000.0).abs() < 50.0, "{found:?}");
        assert!(
            found.max_steps_off_drawing_mm <= 0.0051 && found.max_drawing_off_steps_mm <= 0.0051,
            "{found:?}"
        );
    }

    #[test]
    fn a_lift_where_the_pen_stands_ends_a_stroke() {
        let draw = |x, y| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
        let lift = PlotOp::Travel { to: Point::new(50.0, 0.0) };
        let found = figures(PlannerSettings::default(), &[draw(50.0, 0.0), lift, lift, draw(50.0, 50.0)]);
        assert_eq!((found.strokes, found.pen_lifts), (2, 2), "and the end lifts it");
        // Each stroke is compared with its own steps.
        assert!(found.max_steps_off_drawing_mm < 0.01 && found.max_drawing_off_steps_mm < 0.01, "{found:?}");
    }

    #[test]
    fn rounded_corners_stay_within_the_tolerance_and_near_it() {
        let path = plotter_motion::PathMode::Tolerance { path_tolerance_mm: 0.2 };
        let ops: Vec<PlotOp> = [(20.0, 0.0), (20.0, 20.0), (0.0, 20.0)]
            .map(|(x, y)| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None })
            .to_vec();
        let found = figures(PlannerSettings { path, ..PlannerSettings::default() }, &ops);
        assert!(found.max_drawing_off_steps_mm > 0.1 && found.max_drawing_off_steps_mm < 0.21, "{found:?}");
        assert!(found.max_steps_off_drawing_mm < 0.21, "{found:?}");
    }
}
