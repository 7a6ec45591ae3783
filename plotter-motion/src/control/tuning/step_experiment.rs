//! [`StepExperiment`]: a motor is found out by switching it on.

use super::recording::Recording;
use super::step_fit::StepFit;
use super::{ExperimentSettings, IntegratingProcess, TuningError};
use crate::Demand;

/// Finds a motor's model from how its encoder counts after steps of the duty: an experiment that asks for duties, takes
/// counts, and ends with a model or with what is wrong.
///
/// ```text
///   duty │    ╱│                 ┌────┐              ┌────┐
///        │  ╱  │   rest   rest   │    │  rest  rest  │    │ rest  rest
///       ─┼╱────┴──────┐    ┌─────┘    └┐    ┌────────┘    └┐    ┌──────▶ t
///        │            │    │           └┬───┘              └┬───┘
///        │            └────┘            │                   │
///         breakaway   one try       the higher duty     the lower one, both ways
/// ```
///
/// First the duty grows until the motor turns: what it needs to break loose, and whether the encoder counts the right way.
/// Then a careful run finds out how far the motor goes until its speed is steady, and from that comes the greatest duty for
/// which the travel suffices. Eight runs follow, four with it and four with half of what it has beyond the breakaway, to and
/// fro; each is driven until the speed is steady, braked by the opposite duty, and left to rest. From each come lag and dead time
/// (`StepFit`), and from their speeds `v = K (duty - dry friction)`.
///
/// Each run is broken off at 40 % of the travel: braked as it was driven, an axis needs no more than that to stand. All runs lead
/// towards the start, so that it never is farther from it than 80 % of the travel, and after `most_s` it is over.
///
/// ```
/// # use plotter_motion::control::tuning::{ExperimentSettings, StepExperiment};
/// # use plotter_motion::plant::AxisPlant;
/// # use plotter_motion::{Axis, LimitSwitches, SafetyGate, config::AxisConfig};
/// let config = AxisConfig::default();
/// let mut plant = AxisPlant::new(&config, 1e-4);
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let mut experiment = StepExperiment::new(ExperimentSettings::of(&config, Axis::X, 2500.0, 30.0));
/// let mut count = 0;
/// let motor = loop {
///     if let Some(outcome) = experiment.outcome() {
///         break outcome?;
///     }
///     let drive = gate.pass(experiment.tick(count));
///     for _ in 0..4 {
///         plant.step(drive.x(), |edge| count += edge.direction.sign());
///     }
/// };
/// assert!((motor.process.gain_counts_s / 70_679.0 - 1.0).abs() < 0.03);
/// assert!((motor.process.time_constant_s / 5.98e-3 - 1.0).abs() < 0.05);
/// # Ok::<(), plotter_motion::control::tuning::TuningError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepExperiment {
    settings: ExperimentSettings,
    phase: Phase,
    /// Ticks since the start, and since the phase began.
    now: u32,
    since: u32,
    start: i32,
    count: i32,
    /// Greatest distance from the start so far.
    used: i32,
    /// Ticks since the count changed.
    quiet: u32,
    breakaway_duty: f64,
    plan: Plan,
    starts: u32,
    recording: Recording,
    runs: [Run; RUNS],
    outcome: Option<Result<IdentifiedMotor, TuningError>>,
}

/// Result of a [`StepExperiment`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifiedMotor {
    /// From duty to counts.
    pub process: IntegratingProcess,
    /// Share of the duty that dry friction takes from a turning motor.
    pub dry_friction_duty: f64,
    /// Duty at which the motor broke loose.
    pub breakaway_duty: f64,
    /// How far the counts were from the fitted curves, root of the mean square, counts; 0.29 is that of rounding.
    pub rms_counts: f64,
    /// Greatest distance from the start, counts.
    pub used_counts: i32,
    /// How long it took, s.
    pub took_s: f64,
}

/// Runs that are measured: two duties, both ways, twice.
const RUNS: usize = 8;
const RUNS_F64: f64 = 8.0;
/// Careful runs before, each with half of what the last one had beyond the breakaway.
const MOST_TRIES: usize = 6;
/// Times the measured runs are begun, each with so much of what the duty had beyond the breakaway.
const MOST_STARTS: u32 = 8;
const SLOWER: f64 = 0.7;
/// How far the two duties must be apart, as a share of the higher: what is wrong with their speeds is so much greater in K.
const LEAST_APART: f64 = 0.12;
/// How far a run may drive the axis, as a share of the travel, before it is braked.
const DRIVEN_SHARE: f64 = 0.4;

/// Which duties the runs have.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plan {
    /// Careful runs: the duty, and how many there have been.
    Try { duty: f64, tries: usize },
    /// Measured ones: the higher and the lower duty, and how many are done.
    Measure { high: f64, low: f64, done: usize },
}

/// A measured run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Run {
    duty: f64,
    fit: StepFit,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// The duty grows until the motor turns.
    Breakaway,
    /// No duty until nothing is counted any more.
    Rest,
    /// A duty, with its sign.
    Drive { duty: f64, from: i32 },
    /// Against the motion of the run before, until nothing is counted that way.
    Brake { duty: f64, farthest: i32, still: u32 },
}

impl StepExperiment {
    /// An experiment that begins with the first count it is told.
    #[must_use]
    pub const fn new(settings: ExperimentSettings) -> Self {
        Self {
            settings,
            phase: Phase::Breakaway,
            now: 0,
            since: 0,
            start: 0,
            count: 0,
            used: 0,
            quiet: 0,
            breakaway_duty: 0.0,
            plan: Plan::Try { duty: 0.0, tries: 0 },
            starts: 0,
            recording: Recording::new(),
            runs: [Run { duty: 0.0, fit: StepFit::NONE }; RUNS],
            outcome: None,
        }
    }

    /// The model or what is wrong, once it is over; from then on every demand is none.
    #[must_use]
    pub const fn outcome(&self) -> Option<Result<IdentifiedMotor, TuningError>> {
        self.outcome
    }

    /// Takes the encoder's count and says what the motor gets until the next call, `tick_s` later.
    pub fn tick(&mut self, count: i32) -> Demand {
        if self.outcome.is_some() {
            return Demand::NONE;
        }
        if self.now == 0 {
            (self.start, self.count) = (count, count);
        }
        self.quiet = if count == self.count { self.quiet.saturating_add(1) } else { 0 };
        self.count = count;
        let duty = match self.step() {
            Ok(duty) => duty,
            Err(error) => {
                self.outcome = Some(Err(error));
                0.0
            }
        };
        self.now = self.now.saturating_add(1);
        self.since = self.since.saturating_add(1);
        self.settings.demand(if self.outcome.is_some() { 0.0 } else { duty })
    }

    fn travelled(&self) -> i32 {
        self.count.saturating_sub(self.start)
    }

    /// One call, in the phase that it is in; gives the duty.
    fn step(&mut self) -> Result<f64, TuningError> {
        let travelled = self.travelled();
        self.used = self.used.max(travelled.saturating_abs());
        if travelled.saturating_abs() > self.settings.travel_counts {
            return Err(TuningError::LeftTravel { counts: travelled });
        }
        let took_s = self.settings.seconds(self.now);
        if took_s > self.settings.most_s {
            return Err(TuningError::NeverSettles { after_s: took_s });
        }
        match self.phase {
            Phase::Breakaway => self.breakaway(),
            Phase::Rest => self.rest(),
            Phase::Drive { duty, from } => self.drive(duty, from),
            Phase::Brake { duty, farthest, still } => self.brake(duty, farthest, still),
        }
    }

    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.since = 0;
        self.quiet = 0;
    }

    fn breakaway(&mut self) -> Result<f64, TuningError> {
        /// From nothing to the whole supply.
        const RAMP_S: f64 = 2.5;
        /// How long the greatest duty is held then.
        const HOLD_S: f64 = 1.0;
        /// What is counted of a motor that turns; one edge may come of trembling.
        const TURNS_COUNTS: i32 = 3;
        let since_s = self.settings.seconds(self.since);
        let duty = self.settings.whole(since_s / RAMP_S);
        let travelled = self.travelled();
        if travelled <= -TURNS_COUNTS {
            return Err(TuningError::EncoderReversed { counts: travelled });
        }
        if travelled >= TURNS_COUNTS {
            self.breakaway_duty = duty;
            // Twice what it needs to break loose, and a little for a motor without friction.
            self.plan = Plan::Try { duty: self.settings.whole(2.0 * duty + 0.05), tries: 0 };
            self.enter(Phase::Brake { duty: -duty, farthest: self.count, still: 0 });
            return Ok(-duty);
        }
        if since_s > RAMP_S * self.settings.most_duty + HOLD_S {
            return Err(TuningError::MotorDoesNotTurn { duty });
        }
        Ok(duty)
    }

    fn rest(&mut self) -> Result<f64, TuningError> {
        /// Nothing counted for so long is rest.
        const QUIET_S: f64 = 0.1;
        const MOST_S: f64 = 10.0;
        if self.quiet >= self.settings.ticks(QUIET_S) {
            let size = match self.plan {
                Plan::Try { duty, .. } => duty,
                Plan::Measure { high, low, done } => {
                    if done < RUNS / 2 {
                        high
                    } else {
                        low
                    }
                }
            };
            // towards the start
            let duty = if self.travelled() > 0 { -size } else { size };
            self.recording = Recording::new();
            self.enter(Phase::Drive { duty, from: self.count });
            return self.drive(duty, self.count);
        }
        let since_s = self.settings.seconds(self.since);
        if since_s > MOST_S { Err(TuningError::NeverSettles { after_s: since_s }) } else { Ok(0.0) }
    }

    fn drive(&mut self, duty: f64, from: i32) -> Result<f64, TuningError> {
        /// A motor that is driven and counts nothing for so long is held.
        const STALLED_S: f64 = 1.0;
        const MOST_S: f64 = 8.0;
        let sense = if duty < 0.0 { -1 } else { 1 };
        let way = self.count.saturating_sub(from).saturating_mul(sense);
        let kept = self.recording.push(self.since, self.settings.tick_s, f64::from(way));
        let most_way = DRIVEN_SHARE * f64::from(self.settings.travel_counts);
        let steady = kept && self.recording.is_steady();
        if steady || f64::from(way) >= most_way {
            self.ended(duty, way, steady)?;
            if self.outcome.is_some() {
                return Ok(0.0);
            }
            self.enter(Phase::Brake { duty: -duty, farthest: self.count, still: 0 });
            return Ok(-duty);
        }
        if self.quiet >= self.settings.ticks(STALLED_S) {
            return Err(TuningError::Stalled { counts: self.travelled() });
        }
        let since_s = self.settings.seconds(self.since);
        if since_s > MOST_S { Err(TuningError::NeverSettles { after_s: since_s }) } else { Ok(duty) }
    }

    /// Begins the measured runs, if there is anything between the two duties.
    fn measure(&mut self, high: f64) -> Result<(), TuningError> {
        let low = self.settings.whole(0.5 * (self.breakaway_duty + high));
        self.starts += 1;
        if high - low < LEAST_APART * high || low <= 0.0 || self.starts > MOST_STARTS {
            return Err(TuningError::TooLittleTravel { travel_counts: self.settings.travel_counts });
        }
        self.plan = Plan::Measure { high, low, done: 0 };
        Ok(())
    }

    /// Learns from a run, and decides on the next.
    fn ended(&mut self, duty: f64, way: i32, steady: bool) -> Result<(), TuningError> {
        let too_little = TuningError::TooLittleTravel { travel_counts: self.settings.travel_counts };
        match self.plan {
            Plan::Try { duty: size, tries } if !steady => {
                let less = self.settings.whole(0.5 * (self.breakaway_duty + size));
                if tries + 1 >= MOST_TRIES || less >= size {
                    return Err(too_little);
                }
                self.plan = Plan::Try { duty: less, tries: tries + 1 };
            }
            Plan::Try { duty: size, .. } => {
                // The way grows with the speed, which grows with what the duty has beyond friction.
                let room = 0.8 * DRIVEN_SHARE * f64::from(self.settings.travel_counts);
                let more = room / f64::from(way.max(1));
                let beyond = size - self.breakaway_duty;
                self.measure(self.settings.whole(self.breakaway_duty + beyond * more.max(1.0)))?;
            }
            Plan::Measure { high, .. } if !steady => {
                // More counts are told from a steady speed for longer: a little slower, and all over again.
                let high = self.settings.whole(self.breakaway_duty + SLOWER * (high - self.breakaway_duty));
                self.measure(high)?;
            }
            Plan::Measure { high, low, done } => {
                let fit = StepFit::of(self.recording.as_slice()).ok_or(TuningError::NotAMotor)?;
                if let Some(run) = self.runs.get_mut(done) {
                    *run = Run { duty: duty.abs(), fit };
                }
                self.plan = Plan::Measure { high, low, done: done + 1 };
            }
        }
        Ok(())
    }

    fn brake(&mut self, duty: f64, farthest: i32, still: u32) -> Result<f64, TuningError> {
        /// Nothing counted in the old direction for so long: it stands, or turns back.
        const STILL_S: f64 = 2e-3;
        const LEAST_TICKS: u32 = 2;
        const MOST_S: f64 = 8.0;
        let onwards = if duty > 0.0 { self.count < farthest } else { self.count > farthest };
        let (farthest, still) = if onwards { (self.count, 0) } else { (farthest, still + 1) };
        self.phase = Phase::Brake { duty, farthest, still };
        if still >= self.settings.ticks(STILL_S).max(LEAST_TICKS) {
            if matches!(self.plan, Plan::Measure { done: RUNS, .. }) {
                self.outcome = Some(self.model());
            }
            self.enter(Phase::Rest);
            return Ok(0.0);
        }
        let since_s = self.settings.seconds(self.since);
        if since_s > MOST_S { Err(TuningError::NeverSettles { after_s: since_s }) } else { Ok(duty) }
    }

    /// The model that all runs agree on best.
    fn model(&self) -> Result<IdentifiedMotor, TuningError> {
        // v = K duty - K friction, by least squares.
        let mean = |of: fn(&Run) -> f64| self.runs.iter().map(of).sum::<f64>() / RUNS_F64;
        let (duty, speed) = (mean(|run| run.duty), mean(|run| run.fit.speed_counts_s));
        let spread: f64 = self.runs.iter().map(|run| (run.duty - duty) * (run.duty - duty)).sum();
        let product: f64 =
            self.runs.iter().map(|run| (run.duty - duty) * (run.fit.speed_counts_s - speed)).sum();
        let gain = product / spread;
        if !(gain > 0.0 && gain.is_finite()) {
            return Err(TuningError::NotAMotor);
        }
        // A run says the more of lag and dead time, the more was counted during them.
        let weight: f64 = self.runs.iter().map(|run| run.fit.speed_counts_s).sum();
        let weighted = |of: fn(&StepFit) -> f64| {
            self.runs.iter().map(|run| run.fit.speed_counts_s * of(&run.fit)).sum::<f64>() / weight
        };
        Ok(IdentifiedMotor {
            process: IntegratingProcess {
                gain_counts_s: gain,
                time_constant_s: weighted(|fit| fit.time_constant_s),
                second_time_constant_s: 0.0,
                dead_time_s: weighted(|fit| fit.dead_time_s),
            },
            dry_friction_duty: (duty - speed / gain).max(0.0),
            breakaway_duty: self.breakaway_duty,
            rms_counts: libm::sqrt(mean(|run| run.fit.rms_counts * run.fit.rms_counts)),
            used_counts: self.used,
            took_s: self.settings.seconds(self.now),
        })
    }
}
