//! A drawing on any simulated machine, with what its motors were told to follow and where the pen truly was.

use crate::machine::{PlotEvent, SimulatedBoard, SteppedPlot};
use crate::max_error::TruePath;
use core::time::Duration;
use plotter_motion::config::{DcConfig, SteppersConfig};
use plotter_motion::firmware::MarkingBoardSettings;
use plotter_motion::kinematics::MotorScale;
use plotter_motion::plant::{Bench, BenchEvent, BenchSettings, MarkingBoardPlantSettings, StepperPlant};
use plotter_motion::protocol::HostEvent;
use plotter_motion::{
    Axis, Direction, Machine, MachineConfig, MotionLimits, PathMode, Pen, PenMove, PlannerSettings, PlotOp,
    Point, StepPoint,
    budget::Budget,
    config::MachineKind,
    profile::SCurve,
    stepgen::StepGenSettings,
    toolpath::{OutOfReach, targets},
};

/// Where the marks of a marking board's encoders may stand when it is switched on: right at a mark is the
/// worst, half a pulse from the middle, which is what they are taken to stand in.
const WORST_PHASES: [f64; 2] = [0.0, 0.0];

/// A move of a marking board that is not done by then never is.
const PATIENCE: Duration = Duration::from_secs(60);

/// After the last step before the pen is lifted the rotors still swing; so long that is seen, in steps of a
/// millisecond.
const SWING_MS: u64 = 20;

/// Rounding of corners from which on a planner is asked for it, mm: less is what it cannot do.
const LEAST_BLEND_MM: f64 = 1e-3;

/// Result of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FollowedPath {
    /// Where the pen truly was while it was down, stroke by stroke, mm.
    pub drawn: Vec<Vec<Point>>,
    /// What the motors were to follow: the drawing, rounded to counts where targets are counts.
    pub commanded: Vec<Vec<Point>>,
    /// Time of the machine.
    pub duration: Duration,
    /// Whether all of it was drawn.
    pub is_done: bool,
}

/// Greatest distance of what counts or steps make of a place, mm.
#[must_use]
pub fn rounding_mm(machine: &Machine) -> f64 {
    let dc = DcConfig::of(machine);
    let half = |per_mm: f64| 0.5 / per_mm;
    match machine.kind() {
        // What is commanded is not rounded before it is stepped: the steps are part of what is measured.
        MachineKind::Steppers => 0.0,
        // Half a count of both motors is one along an axis, and none along the other.
        MachineKind::Belt => half(dc.x.counts_per_mm),
        MachineKind::Gantry => half(dc.x.counts_per_mm).hypot(half(dc.y.counts_per_mm)),
    }
}

/// The machine, slowed down as a budget asks.
///
/// # Errors
///
/// It becomes slower than any machine may be described.
pub fn slowed(machine: &Machine, budget: &Budget) -> Result<Machine, String> {
    let mut config: MachineConfig = *machine.config();
    if let Some(dc) = config.dc_mut() {
        let contouring = &mut dc.control.contouring;
        (contouring.feed_mm_s, contouring.accel_mm_s2, contouring.jerk_mm_s3) =
            budget.slowed(contouring.feed_mm_s, contouring.accel_mm_s2, contouring.jerk_mm_s3);
    }
    if let Some(steppers) = config.steppers_mut() {
        let planner = &mut steppers.planner;
        (planner.speed_mm_s, planner.accel_mm_s2, planner.jerk_mm_s3) =
            budget.slowed(planner.speed_mm_s, planner.accel_mm_s2, planner.jerk_mm_s3);
        for of_motor in [&mut planner.accel_x_mm_s2, &mut planner.accel_y_mm_s2] {
            (_, *of_motor, _) = budget.slowed(0.0, *of_motor, 0.0);
        }
    }
    Machine::new(config).map_err(|error| error.to_string())
}

/// Draws `ops` on the simulated machine; corners are rounded by up to `blend_mm` by a machine that does not
/// stop in them.
///
/// # Errors
///
/// A place out of reach, or settings that cannot be planned with.
pub fn follow(machine: &Machine, ops: &[PlotOp], blend_mm: f64) -> Result<FollowedPath, String> {
    match machine.kind() {
        MachineKind::Steppers => on_steppers(machine, ops, blend_mm),
        MachineKind::Belt => on_the_board(machine, ops),
        MachineKind::Gantry => on_the_gantry(machine, ops),
    }
}

/// How long that takes, s: exact for a planner, within a few per cent where targets are sent one by one.
///
/// # Errors
///
/// As [`follow`].
pub fn predicted_s(machine: &Machine, ops: &[PlotOp], blend_mm: f64) -> Result<f64, String> {
    let config = machine.config();
    let dc = DcConfig::of(machine);
    if machine.kind() == MachineKind::Steppers {
        let mut plot = stepped(machine, blend_mm)?;
        for op in ops {
            plot.push(*op, &mut |_| {}).map_err(|error| error.to_string())?;
        }
        return plot.finish(&mut |_| {}).map(|figures| figures.total_s).map_err(|error| error.to_string());
    }
    let contouring = &dc.control.contouring;
    let limits = MotionLimits {
        speed_mm_s: contouring.feed_mm_s,
        accel_mm_s2: contouring.accel_mm_s2,
        jerk_mm_s3: contouring.jerk_mm_s3,
    };
    let is_belt = machine.kind() == MachineKind::Belt;
    // Ten digits of ten bits.
    let byte_s = 10.0 / f64::from(config.serial.baud) + 1e-3 * config.serial.byte_gap_ms;
    let a_move_s = 1e-3 * contouring.settle_ms + if is_belt { 0.0 } else { 10.0 * byte_s };
    let mut at = if is_belt { MarkingBoardSettings::of(machine).start } else { Point::ORIGIN };
    let mut sum_s = 0.0;
    for to in ops.iter().filter_map(|op| op.target()) {
        sum_s += a_move_s + SCurve::plan(at.distance(to), limits).map_or(0.0, |plan| plan.duration_s());
        at = to;
    }
    Ok(sum_s)
}

fn on_the_gantry(machine: &Machine, ops: &[PlotOp]) -> Result<FollowedPath, String> {
    let moves: Result<Vec<PenMove>, OutOfReach> = targets(machine, ops.iter().copied()).collect();
    let moves = moves.map_err(|error| error.to_string())?;
    let dc = DcConfig::of(machine);
    let on_sheet =
        |p: StepPoint| Point::new(f64::from(p.x) / dc.x.counts_per_mm, f64::from(p.y) / dc.y.counts_per_mm);
    let commanded = commanded(Point::ORIGIN, &moves, on_sheet);
    let (count, mut reached) = (moves.len(), 0);
    let mut bench = Bench::new(machine, BenchSettings::default(), moves.into_iter());
    let mut path = TruePath::default();
    while !bench.host().is_done() {
        let mut pen = None;
        bench.step(|_, event| match event {
            BenchEvent::Host(HostEvent::Begun(next)) => pen = Some(next.pen),
            BenchEvent::Host(HostEvent::Reached(_)) => reached += 1,
            _ => {}
        });
        if let Some(pen) = pen {
            path.put(pen);
        }
        path.at(bench.position_mm());
    }
    Ok(FollowedPath { drawn: path.finish(), commanded, duration: bench.now(), is_done: reached == count })
}

fn on_the_board(machine: &Machine, ops: &[PlotOp]) -> Result<FollowedPath, String> {
    let settings = MarkingBoardSettings::of(machine);
    let moves: Result<Vec<PenMove>, OutOfReach> = settings.moves(ops.iter().copied()).collect();
    let moves = moves.map_err(|error| error.to_string())?;
    let plant = MarkingBoardPlantSettings { phases: WORST_PHASES, ..MarkingBoardPlantSettings::of(machine) };
    let mut board = SimulatedBoard::with_plant(machine, &plant);
    let commanded = commanded(settings.start, &moves, |counts| board.on_sheet(counts));
    let mut path = TruePath::default();
    let mut is_done = true;
    for next in moves {
        let until = board.now() + PATIENCE;
        path.put(next.pen);
        path.at(board.position_mm());
        board.start(next);
        while !board.has_arrived() && board.now() < until {
            board.step(|_, _, _| ());
            path.at(board.position_mm());
        }
        is_done &= board.has_arrived();
        if !is_done {
            break;
        }
    }
    Ok(FollowedPath { drawn: path.finish(), commanded, duration: board.now(), is_done })
}

fn on_steppers(machine: &Machine, ops: &[PlotOp], blend_mm: f64) -> Result<FollowedPath, String> {
    let steppers = SteppersConfig::of(machine);
    let scales = [&steppers.x, &steppers.y].map(|stepper| stepper.steps_per_mm);
    let mut motors = SteppedMotors {
        plant: StepperPlant::new(steppers.stepper_motor, steppers.stepper_motor),
        path: TruePath::default(),
        last: Duration::ZERO,
        scales,
    };
    let mut plot = stepped(machine, blend_mm)?;
    for op in ops {
        plot.push(*op, &mut |event| motors.take(event)).map_err(|error| error.to_string())?;
    }
    let figures = plot.finish(&mut |event| motors.take(event)).map_err(|error| error.to_string())?;
    let mut commanded: Vec<Vec<Point>> = Vec::new();
    let (mut at, mut pen) = (Point::ORIGIN, Pen::Up);
    for op in ops {
        let Some(to) = op.target() else { continue };
        if matches!(op, PlotOp::Travel { .. }) {
            pen = Pen::Up;
        } else {
            if pen == Pen::Up {
                commanded.push(vec![at]);
            }
            pen = Pen::Down;
            commanded.iter_mut().last().into_iter().for_each(|stroke| stroke.push(to));
        }
        at = to;
    }
    motors.settle();
    Ok(FollowedPath {
        drawn: motors.path.finish(),
        commanded,
        duration: Duration::from_secs_f64(figures.total_s),
        is_done: true,
    })
}

fn stepped(machine: &Machine, blend_mm: f64) -> Result<SteppedPlot, String> {
    let steppers = SteppersConfig::of(machine);
    let path = if blend_mm >= LEAST_BLEND_MM {
        PathMode::Tolerance { path_tolerance_mm: blend_mm }
    } else {
        PathMode::Exact
    };
    let settings = PlannerSettings::of(machine).following(path);
    let motor = |steps_per_mm| MotorScale { steps_per_mm, inverted: false };
    let motors = [motor(steppers.x.steps_per_mm), motor(steppers.y.steps_per_mm)];
    SteppedPlot::new(settings, StepGenSettings::of(machine), motors)
}

/// The two rotors behind the steps.
struct SteppedMotors {
    plant: StepperPlant,
    path: TruePath,
    last: Duration,
    scales: [f64; 2],
}

impl SteppedMotors {
    fn take(&mut self, event: PlotEvent) {
        match event {
            PlotEvent::Step { tick_us, dx, dy, .. } => {
                let at = Duration::from_micros(tick_us);
                self.plant.run_to(at);
                self.see();
                for (axis, step) in Axis::BOTH.into_iter().zip([dx, dy]) {
                    match step {
                        0 => {}
                        1.. => self.plant.pulse(at, axis, Direction::Plus),
                        _ => self.plant.pulse(at, axis, Direction::Minus),
                    }
                }
                self.last = at;
            }
            PlotEvent::Pen(pen) => {
                self.settle();
                self.path.put(pen);
                self.see();
            }
            _ => {}
        }
    }

    /// What the rotors do when the steps have ended.
    fn settle(&mut self) {
        for ms in 1..=SWING_MS {
            self.plant.run_to(self.last + Duration::from_millis(ms));
            self.see();
        }
    }

    fn see(&mut self) {
        let [x_scale, y_scale] = self.scales;
        let place =
            Point::new(self.plant.x.position_steps() / x_scale, self.plant.y.position_steps() / y_scale);
        self.path.at(place);
    }
}

/// The strokes of moves.
fn commanded(start: Point, moves: &[PenMove], on_sheet: impl Fn(StepPoint) -> Point) -> Vec<Vec<Point>> {
    let mut strokes: Vec<Vec<Point>> = Vec::new();
    let (mut at, mut pen) = (start, Pen::Up);
    for next in moves {
        let to = on_sheet(next.target);
        if next.pen == Pen::Down {
            if pen == Pen::Up {
                strokes.push(vec![at]);
            }
            strokes.iter_mut().last().into_iter().for_each(|stroke| stroke.push(to));
        }
        (at, pen) = (to, next.pen);
    }
    strokes
}
