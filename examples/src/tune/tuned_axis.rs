//! [`SimulatedAxis`]: an axis of a machine on which the tuning experiments and position loops run, through
//! the gate.

use plotter_motion::control::tuning::{
    Compensator, ExperimentSettings, IdentifiedMotor, RelayExperiment, RelayPoint, StepExperiment,
    TuningError,
};
use plotter_motion::plant::AxisPlant;
use plotter_motion::{
    Axis, Demand, Duty, LimitSwitches, SafetyGate,
    config::AxisConfig,
    control::{Pid, PidState, SumPid, SumPidState},
};

/// Longest step of the simulated motor, s.
const LONGEST_STEP_S: f64 = 5e-5;

/// A controller of one axis, as it runs.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    /// Ours.
    Pid(Pid),
    /// The published one, with its limit, in steps of 255.
    Published(SumPid, f32),
}

impl Law {
    /// As a filter, for its margins.
    #[must_use]
    pub fn compensator(&self) -> Compensator {
        match *self {
            Self::Pid(pid) => Compensator::Pid(pid),
            Self::Published(gains, _) => Compensator::SumPid { gains, full_output: FULL_DUTY.into() },
        }
    }
}

/// The published duty runs from 0 to 255.
const FULL_DUTY: f32 = 255.0;

/// An axis at rest.
#[derive(Clone, Copy, Debug)]
pub struct SimulatedAxis {
    axis: Axis,
    plant: AxisPlant,
    steps: u32,
    count: i32,
}

/// The gate of a simulated axis, which has neither switches nor a button.
const fn free() -> SafetyGate {
    SafetyGate::new(LimitSwitches::RELEASED, false)
}

/// What a step of the setpoint did, as the encoder counts it.
#[derive(Clone, Debug, Default)]
pub struct StepResponse {
    /// Time, s, and place, counts.
    pub places: Vec<(f64, i32)>,
    /// Beyond the target, percent of the step.
    pub overshoot_percent: f64,
    /// When it came within 2 % of the step, or two counts, for good, s.
    pub settled_s: Option<f64>,
}

impl SimulatedAxis {
    /// The motor and the load of `config`, for a loop that runs every `tick_s`.
    #[must_use]
    pub fn new(config: &AxisConfig, axis: Axis, tick_s: f64) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "2000 for a loop of 10 Hz"
        )]
        let steps = (tick_s / LONGEST_STEP_S).ceil().max(1.0) as u32;
        let plant = AxisPlant::new(config, tick_s / f64::from(steps));
        Self { axis, plant, steps, count: 0 }
    }

    fn tick(&mut self, gate: &SafetyGate, demand: Demand) {
        let drive = gate.pass(demand);
        for _ in 0..self.steps {
            self.plant.step(drive.axis(self.axis), |edge| self.count += edge.direction.sign());
        }
    }

    /// Switches the motor on and off until it is known.
    ///
    /// # Errors
    ///
    /// What the experiment says.
    pub fn step_experiment(mut self, settings: ExperimentSettings) -> Result<IdentifiedMotor, TuningError> {
        let (mut experiment, gate) = (StepExperiment::new(settings), free());
        loop {
            let demand = experiment.tick(self.count);
            self.tick(&gate, demand);
            if let Some(outcome) = experiment.outcome() {
                return outcome;
            }
        }
    }

    /// Lets a relay swing it.
    ///
    /// # Errors
    ///
    /// What the experiment says.
    pub fn relay_experiment(mut self, settings: ExperimentSettings) -> Result<RelayPoint, TuningError> {
        let (mut experiment, gate) = (RelayExperiment::new(settings), free());
        loop {
            let demand = experiment.tick(self.count);
            self.tick(&gate, demand);
            if let Some(outcome) = experiment.outcome() {
                return outcome;
            }
        }
    }

    /// A step of the setpoint by `counts` under a controller, for `watched_s`.
    #[must_use]
    pub fn step_response(mut self, law: Law, counts: i32, tick_s: f64, watched_s: f64) -> StepResponse {
        let (mut pid_state, mut sum_state) = (PidState::default(), SumPidState::default());
        let mut response = StepResponse::default();
        let gate = free();
        let band = (0.02 * f64::from(counts)).max(2.0);
        let mut most = 0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "seconds of a loop")]
        let ticks = (watched_s / tick_s) as u32;
        for tick in 0..ticks {
            #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "f32 loop")]
            let duty = match law {
                Law::Pid(pid) => pid.update(&mut pid_state, counts as f32, self.count as f32, tick_s as f32),
                Law::Published(gains, limit) => {
                    let error = (counts - self.count) as f32;
                    gains.update(&mut sum_state, error).clamp(-limit, limit) / FULL_DUTY
                }
            };
            let duty = Duty::saturating(duty);
            let demand = match self.axis {
                Axis::X => Demand { x: duty, ..Demand::NONE },
                Axis::Y => Demand { y: duty, ..Demand::NONE },
            };
            let now_s = f64::from(tick) * tick_s;
            response.places.push((now_s, self.count));
            self.tick(&gate, demand);
            most = most.max(self.count);
            if f64::from(self.count - counts).abs() > band {
                response.settled_s = None;
            } else if response.settled_s.is_none() {
                response.settled_s = Some(now_s + tick_s);
            }
        }
        response.overshoot_percent = (100.0 * (f64::from(most) / f64::from(counts) - 1.0)).max(0.0);
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proportional_loop_comes_to_its_target_and_a_weak_one_does_not() {
        let config = AxisConfig::default();
        let law = |kp| {
            Law::Pid(Pid {
                kp,
                ki: 0.0,
                kd: 0.0,
                derivative_filter_s: 0.0,
                output_min: -1.0,
                output_max: 1.0,
            })
        };
        let run = |kp| SimulatedAxis::new(&config, Axis::Y, 4e-4).step_response(law(kp), 200, 4e-4, 0.5);
        let good = run(0.01);
        assert!(good.settled_s.is_some_and(|s| s < 0.3) && good.places.len() == 1250, "{:?}", good.settled_s);
        assert_eq!(good.places[0], (0.0, 0));
        // 1.5 % of the duty are friction
        assert_eq!(run(0.000_05).settled_s, None);
    }
}
