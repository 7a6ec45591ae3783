#![allow(dead_code, reason = "each test uses its part of this")]
#![allow(unreachable_pub, reason = "shared by tests, not an interface")]
//! Experiments and position loops on a simulated axis, through the gate.

use plotter_motion::control::tuning::{
    Compensator, ExperimentSettings, IdentifiedMotor, IntegratingProcess, LoopMargins, RelayExperiment,
    RelayPoint, SampledLoop, StepExperiment, TuningError,
};
use plotter_motion::plant::AxisPlant;
use plotter_motion::{
    Axis, Demand, Duty, LimitSwitches, SafetyGate,
    config::AxisConfig,
    control::{Pid, PidState},
};

/// Steps of the plant in a tick.
const STEPS: u32 = 8;

/// An axis whose loop runs every `tick_s`; between a count and the duty that comes of it `delay` ticks pass.
pub struct Bench {
    pub plant: AxisPlant,
    pub count: i32,
    pub gate: SafetyGate,
    pub reversed: bool,
    /// Farthest true place from the start, counts.
    pub farthest: f64,
}

impl Bench {
    pub fn new(config: &AxisConfig, tick_s: f64) -> Self {
        Self {
            plant: AxisPlant::new(config, tick_s / f64::from(STEPS)),
            count: 0,
            gate: SafetyGate::new(LimitSwitches::RELEASED, false),
            reversed: false,
            farthest: 0.0,
        }
    }

    pub fn tick(&mut self, demand: Demand) {
        let drive = self.gate.pass(demand);
        let sign = if self.reversed { -1 } else { 1 };
        for _ in 0..STEPS {
            self.plant.step(drive.x(), |edge| self.count += sign * edge.direction.sign());
            self.farthest = self.farthest.max(self.plant.position_counts().abs());
        }
    }
}

pub fn step_experiment(
    bench: &mut Bench,
    settings: ExperimentSettings,
) -> Result<IdentifiedMotor, TuningError> {
    let mut experiment = StepExperiment::new(settings);
    loop {
        let demand = experiment.tick(bench.count);
        bench.tick(demand);
        if let Some(outcome) = experiment.outcome() {
            return outcome;
        }
    }
}

pub fn relay_experiment(bench: &mut Bench, settings: ExperimentSettings) -> Result<RelayPoint, TuningError> {
    let mut experiment = RelayExperiment::new(settings);
    loop {
        let demand = experiment.tick(bench.count);
        bench.tick(demand);
        if let Some(outcome) = experiment.outcome() {
            return outcome;
        }
    }
}

/// How a step of the setpoint went, as the encoder counts it.
#[derive(Clone, Copy, Debug)]
pub struct StepResult {
    /// Beyond the target, as a share of the step.
    pub overshoot: f64,
    /// When the axis came within 2 % of the step, or two counts, for good: with more friction at rest than in
    /// motion an integral never stands still.
    pub settled_s: Option<f64>,
    /// How far the counts are from the true place at the end: x1 decoding counts a shaft away that trembles
    /// about an edge.
    pub drift_counts: f64,
}

/// A step of `counts` under a controller, watched for `watched_s`.
pub fn step_response(axis: &AxisConfig, pid: &Pid, tick_s: f64, counts: i32, watched_s: f64) -> StepResult {
    let mut bench = Bench::new(axis, tick_s);
    let mut state = PidState::default();
    let band = (0.02 * f64::from(counts)).max(2.0);
    let (mut most, mut settled_s, mut now_s) = (0, None, 0.0);
    while now_s < watched_s {
        #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "small numbers")]
        let output = pid.update(&mut state, counts as f32, bench.count as f32, tick_s as f32);
        bench.tick(Demand { x: Duty::saturating(output), y: Duty::ZERO });
        now_s += tick_s;
        most = most.max(bench.count);
        if f64::from(bench.count - counts).abs() > band {
            settled_s = None;
        } else if settled_s.is_none() {
            settled_s = Some(now_s);
        }
    }
    StepResult {
        overshoot: (f64::from(most) / f64::from(counts) - 1.0).max(0.0),
        settled_s,
        drift_counts: (bench.plant.position_counts() - f64::from(bench.count)).abs(),
    }
}

/// The margins of a controller on an axis as it is.
pub fn margins(axis: &AxisConfig, pid: &Pid, tick_s: f64) -> LoopMargins {
    let process = IntegratingProcess::of(axis);
    LoopMargins::from_loop(&SampledLoop { process, compensator: Compensator::Pid(*pid), tick_s })
}

pub fn settings(axis: &AxisConfig, loop_hz: f64, travel_mm: f64) -> ExperimentSettings {
    ExperimentSettings::of(axis, Axis::X, loop_hz, travel_mm)
}
