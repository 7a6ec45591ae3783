//! [`RelayExperiment`]: a motor is found out by letting a relay swing it.

use super::{Complex, ExperimentSettings, RelayPoint, TuningError};
use crate::Demand;
use core::f64::consts::TAU;

/// Finds one point of a motor's frequency response, the one that matters to a controller: an experiment that asks for duties,
/// takes counts, and ends with a [`RelayPoint`] or with what is wrong.
///
/// ```text
///   duty  +d ┌──────┐      ┌──────┐            the duty turns round when the count is
///            │      │      │      │            `hysteresis` beyond the start; what delay
///  count  ╱‾╲      ╱‾╲      ╱‾╲                there is in the loop lets it go on farther,
///   ─────╱───╲────╱───╲────╱───╲───▶ t         and the axis swings by itself at the frequency
///             ╲__╱     ╲__╱     ╲              at which it answers with the opposite sign
/// ```
///
/// A swing of fewer counts than `LEAST_SWING` says little through the encoder's grain; then the hysteresis is doubled, and the
/// point lies at a lower frequency. When the swing has settled, its period is measured over some cycles, and over as many more
/// the fundamental waves of duty and counts: their quotient is the response, whatever the shape of the swing.
///
/// Source: K. J. Åström, T. Hägglund, "Automatic tuning of simple regulators with specifications on phase and amplitude
/// margins", Automatica 20 (1984); of the quotient of the waves C. C. Hang, K. J. Åström, Q. G. Wang, "Relay feedback
/// auto-tuning of process controllers: a tutorial review", Journal of Process Control 12 (2002), section 4.
///
/// ```
/// # use plotter_motion::control::tuning::{ExperimentSettings, RelayExperiment};
/// # use plotter_motion::plant::AxisPlant;
/// # use plotter_motion::{Axis, LimitSwitches, SafetyGate, config::AxisConfig};
/// let config = AxisConfig::default();
/// let mut plant = AxisPlant::new(&config, 1e-4);
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let mut experiment = RelayExperiment::new(ExperimentSettings::of(&config, Axis::X, 2500.0, 30.0));
/// let mut count = 0;
/// let point = loop {
///     if let Some(outcome) = experiment.outcome() {
///         break outcome?;
///     }
///     let drive = gate.pass(experiment.tick(count));
///     for _ in 0..4 {
///         plant.step(drive.x(), |edge| count += edge.direction.sign());
///     }
/// };
/// // 1 / sqrt(6 ms lag * 0.2 ms of holding) is 900 rad/s, a period of 7 ms
/// assert!((5e-3..10e-3).contains(&point.ultimate_period_s()));
/// # Ok::<(), plotter_motion::control::tuning::TuningError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelayExperiment {
    settings: ExperimentSettings,
    duty: f64,
    hysteresis: i32,
    now: u32,
    start: i32,
    /// 1 while the duty is forward.
    sense: i8,
    switched: u32,
    switches: u32,
    swing: Swing,
    stage: Stage,
    used: i32,
    outcome: Option<Result<RelayPoint, TuningError>>,
}

/// The present cycle: it begins where the duty turns forward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Swing {
    least: i32,
    most: i32,
    /// Cycles since the stage began, and when it did.
    cycles: u32,
    since: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// The swing is let settle.
    Settle,
    /// Its period is measured.
    Period,
    /// The waves are summed up at that period, in ticks.
    Waves { period_ticks: f64, duty: Complex, counts: Complex },
}

/// Cycles in which a swing settles, and in which its period and then its waves are measured: the ticks' grain is averaged.
const SETTLE_CYCLES: u32 = 8;
const MEASURED_CYCLES: u32 = 24;
/// Counts from end to end that a swing has at the least.
const LEAST_SWING: i32 = 16;

impl RelayExperiment {
    /// An experiment that begins with the first count it is told, with the greatest duty that is allowed and a hysteresis
    /// of two counts.
    #[must_use]
    pub fn new(settings: ExperimentSettings) -> Self {
        Self {
            settings,
            duty: settings.whole(settings.most_duty),
            hysteresis: 2,
            now: 0,
            start: 0,
            sense: 1,
            switched: 0,
            switches: 0,
            swing: Swing::default(),
            stage: Stage::Settle,
            used: 0,
            outcome: None,
        }
    }

    /// The point or what is wrong, once it is over; from then on every demand is none.
    #[must_use]
    pub const fn outcome(&self) -> Option<Result<RelayPoint, TuningError>> {
        self.outcome
    }

    /// Takes the encoder's count and says what the motor gets until the next call, `tick_s` later.
    pub fn tick(&mut self, count: i32) -> Demand {
        if self.outcome.is_some() {
            return Demand::NONE;
        }
        if self.now == 0 {
            self.start = count;
        }
        let place = count.saturating_sub(self.start);
        if let Err(error) = self.step(place) {
            self.outcome = Some(Err(error));
        }
        self.now = self.now.saturating_add(1);
        self.settings.demand(if self.outcome.is_some() { 0.0 } else { self.relay_duty() })
    }

    fn relay_duty(&self) -> f64 {
        f64::from(self.sense) * self.duty
    }

    fn step(&mut self, place: i32) -> Result<(), TuningError> {
        /// A motor that is driven and does not come to where the duty turns for so long is held.
        const STALLED_S: f64 = 2.0;
        /// What is counted of a motor that turns.
        const TURNS_COUNTS: i32 = 3;
        self.used = self.used.max(place.saturating_abs());
        if self.used > self.settings.travel_counts {
            return Err(TuningError::LeftTravel { counts: place });
        }
        let took_s = self.settings.seconds(self.now);
        if took_s > self.settings.most_s {
            return Err(TuningError::DoesNotSwing { after_s: took_s });
        }
        if self.switches == 0 && place <= -TURNS_COUNTS {
            return Err(TuningError::EncoderReversed { counts: place });
        }
        if self.now.saturating_sub(self.switched) > self.settings.ticks(STALLED_S) {
            return Err(match self.used {
                0..TURNS_COUNTS => TuningError::MotorDoesNotTurn { duty: self.duty },
                _ => TuningError::Stalled { counts: place },
            });
        }
        self.swing.least = self.swing.least.min(place);
        self.swing.most = self.swing.most.max(place);
        let turns = if self.sense > 0 { place >= self.hysteresis } else { place <= -self.hysteresis };
        if turns {
            self.sense = -self.sense;
            self.switched = self.now;
            self.switches = self.switches.saturating_add(1);
            if self.sense > 0 {
                self.cycle()?;
            }
        }
        if let Stage::Waves { period_ticks, duty, counts } = &mut self.stage {
            let angle = TAU * f64::from(self.now - self.swing.since) / *period_ticks;
            let wave = Complex::polar(1.0, -angle);
            *duty = *duty + wave * (f64::from(self.sense) * self.duty);
            *counts = *counts + wave * f64::from(place);
        }
        Ok(())
    }

    /// Called where a cycle ends and the next one begins, before that one's first sample is summed up.
    fn cycle(&mut self) -> Result<(), TuningError> {
        self.swing.cycles += 1;
        let cycles = if self.stage == Stage::Settle { SETTLE_CYCLES } else { MEASURED_CYCLES };
        if self.swing.cycles < cycles {
            return Ok(());
        }
        let Swing { least, most, cycles, since } = self.swing;
        let period_ticks = f64::from(self.now - since) / f64::from(cycles);
        let next = match self.stage {
            Stage::Settle if most.saturating_sub(least) < LEAST_SWING => {
                self.hysteresis = self.hysteresis.saturating_mul(2);
                // A swing is some times as wide.
                if self.hysteresis > self.settings.travel_counts / 8 {
                    return Err(TuningError::TooLittleTravel { travel_counts: self.settings.travel_counts });
                }
                Stage::Settle
            }
            Stage::Settle => Stage::Period,
            Stage::Period => Stage::Waves { period_ticks, duty: Complex::ZERO, counts: Complex::ZERO },
            Stage::Waves { period_ticks: before, duty, counts } => {
                /// Periods that differ by more, as a share, are of a swing that has not settled.
                const EVEN: f64 = 0.05;
                if (period_ticks - before).abs() <= EVEN * before && duty.size() > 0.0 {
                    self.finish(before, counts / duty);
                    return Ok(());
                }
                Stage::Period
            }
        };
        self.stage = next;
        self.swing = Swing { since: self.now, ..Swing::default() };
        Ok(())
    }

    fn finish(&mut self, period_ticks: f64, response: Complex) {
        self.outcome = Some(Ok(RelayPoint {
            rad_s: TAU / (period_ticks * self.settings.tick_s),
            response,
            tick_s: self.settings.tick_s,
            duty: self.duty,
            hysteresis_counts: self.hysteresis,
            swing_counts: self.swing.most.saturating_sub(self.swing.least),
            used_counts: self.used,
            took_s: self.settings.seconds(self.now),
        }));
    }
}
