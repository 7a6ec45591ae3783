#![allow(dead_code, reason = "each test uses its part of this")]
#![allow(unreachable_pub, reason = "shared by tests, not an interface")]
//! A line controller, its gate and two simulated motors, without host and serial line.

use core::time::Duration;
use plotter_motion::control::{Contouring, LineController, LineTracking};
use plotter_motion::plant::AxisPlant;
use plotter_motion::{
    Axis, Demand, Direction, LimitSwitches, Machine, MachineConfig, Point, SafetyGate, Segment, StepPoint,
    config::ControllerChoice,
};

pub const TIME_STEP: Duration = Duration::from_micros(10);

pub struct Loop {
    pub now: Duration,
    pub controller: Box<dyn LineController>,
    pub axes: [AxisPlant; 2],
    pub counts_per_mm: f64,
    gate: SafetyGate,
    demand: Demand,
    next_tick: Option<Duration>,
}

impl Loop {
    /// The controller that `machine` chooses, on the motors of `plant`.
    pub fn new(machine: &MachineConfig, plant: &MachineConfig) -> Self {
        let checked = Machine::new(*machine).unwrap();
        let controller: Box<dyn LineController> = match machine.dc().unwrap().control.controller {
            ControllerChoice::Published => Box::new(LineTracking::new(&checked)),
            _ => Box::new(Contouring::new(&checked)),
        };
        let dt_s = TIME_STEP.as_secs_f64();
        Self {
            now: Duration::ZERO,
            next_tick: controller.period(),
            controller,
            axes: [
                AxisPlant::new(&plant.dc().unwrap().x, dt_s),
                AxisPlant::new(&plant.dc().unwrap().y, dt_s),
            ],
            counts_per_mm: machine.dc().unwrap().x.counts_per_mm,
            gate: SafetyGate::new(LimitSwitches::RELEASED, false),
            demand: Demand::NONE,
        }
    }

    pub fn start(&mut self, target: StepPoint) {
        let demand = self.controller.start(self.now, target);
        self.apply(demand);
    }

    fn apply(&mut self, demand: Demand) {
        self.demand = demand;
        self.controller.applied(self.gate.pass(demand));
    }

    pub fn step(&mut self) {
        let end = self.now + TIME_STEP;
        let mut edges: Vec<(Duration, Axis, Direction)> = Vec::new();
        let drive = self.gate.pass(self.demand);
        for (plant, axis) in self.axes.iter_mut().zip(Axis::BOTH) {
            plant.step(drive.axis(axis), |edge| {
                let at = self.now + TIME_STEP.mul_f64(edge.share_of_step);
                edges.push((Duration::from_micros(at.as_micros().try_into().unwrap()), axis, edge.direction));
            });
        }
        edges.sort_by_key(|&(at, ..)| at);
        for (at, axis, direction) in edges {
            self.ticks_until(at);
            let demand = self.controller.edge(at, axis, direction);
            self.apply(demand);
        }
        self.ticks_until(end);
        self.now = end;
    }

    fn ticks_until(&mut self, end: Duration) {
        while let (Some(due), Some(period)) = (self.next_tick, self.controller.period()) {
            if due > end {
                return;
            }
            let demand = self.controller.tick(due);
            self.apply(demand);
            self.next_tick = Some(due + period);
        }
    }

    pub fn true_position(&self) -> Point {
        Point::new(self.axes[0].position_mm(), self.axes[1].position_mm())
    }

    pub fn counted_position(&self) -> Point {
        let StepPoint { x, y } = self.controller.position();
        Point::new(f64::from(x) / self.counts_per_mm, f64::from(y) / self.counts_per_mm)
    }
}

/// How one line went.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineResult {
    pub samples: u32,
    /// Sum of squares of the true distance from the line, until arrival.
    pub square_mm2: f64,
    pub max_mm: f64,
    /// When the controller said that it had arrived.
    pub arrived_s: Option<f64>,
    /// When the pen came within `SETTLED_MM` of the target for good, as far as it was watched.
    pub settled_s: Option<f64>,
    /// True distance from the target at the end.
    pub short_mm: f64,
    /// Distance between the true and the counted position at the end.
    pub drift_mm: f64,
}

/// Two encoder counts: nearer than that no ×1 encoder can tell.
pub const SETTLED_MM: f64 = 0.05;

impl LineResult {
    pub fn rms_mm(&self) -> f64 {
        (self.square_mm2 / f64::from(self.samples.max(1))).sqrt()
    }
}

/// Draws the straight line from the origin by (`dx`, `dy`) counts, watches it up to `limit`, and on for a
/// tenth of a second after the arrival; `disturb` may interfere at any time.
pub fn draw_line(
    mut closed_loop: Loop,
    target: StepPoint,
    limit: Duration,
    mut disturb: impl FnMut(&mut Loop),
) -> LineResult {
    const WATCH_ON: Duration = Duration::from_millis(100);
    let end = Point::new(
        f64::from(target.x) / closed_loop.counts_per_mm,
        f64::from(target.y) / closed_loop.counts_per_mm,
    );
    let line = Segment::new(Point::ORIGIN, end);
    let mut result = LineResult::default();
    closed_loop.start(target);
    let mut arrived: Option<Duration> = None;
    while closed_loop.now < arrived.map_or(limit, |at| at + WATCH_ON) {
        disturb(&mut closed_loop);
        closed_loop.step();
        let pen = closed_loop.true_position();
        if arrived.is_none() {
            let error = line.distance(pen);
            result.samples += 1;
            result.square_mm2 += error * error;
            result.max_mm = result.max_mm.max(error);
            arrived = closed_loop.controller.has_arrived().then_some(closed_loop.now);
        }
        if pen.distance(end) > SETTLED_MM {
            result.settled_s = None;
        } else if result.settled_s.is_none() {
            result.settled_s = Some(closed_loop.now.as_secs_f64());
        }
    }
    result.arrived_s = arrived.map(|at| at.as_secs_f64());
    result.short_mm = closed_loop.true_position().distance(end);
    result.drift_mm = closed_loop.true_position().distance(closed_loop.counted_position());
    result
}

pub fn machine(choice: ControllerChoice) -> MachineConfig {
    let mut config = MachineConfig::default();
    config.dc_mut().unwrap().control.controller = choice;
    config
}
