//! Auto-tuning: from a motor's data, or from an experiment on it, to gains and the margins that they leave.
//!
//! ```text
//!  description ─▶ IntegratingProcess::of ─┐
//!  StepExperiment ─▶ IdentifiedMotor ─────┴▶ Simc ──────────────▶ Pid ─┐
//!  RelayExperiment ─▶ RelayPoint ─▶ astrom_hagglund, tyreus_luyben ────┴▶ SampledLoop ─▶ LoopMargins
//! ```
//!
//! | from | by | to |
//! |---|---|---|
//! | the motor's data (Öcal, section 4.6.1) | its transfer function | [`IntegratingProcess`] |
//! | steps of the duty | [`StepExperiment`]: lag, dead time, gain and friction fitted to the counts | [`IdentifiedMotor`] |
//! | a relay that swings the axis | [`RelayExperiment`] (Åström and Hägglund, 1984) | [`RelayPoint`] |
//! | a process | [`Simc`]: lambda tuning to a stated sensitivity (Skogestad, 2003) | [`Pid`](crate::control::Pid) |
//! | a relay's point | Åström and Hägglund to a stated phase margin; Tyreus and Luyben | [`Pid`](crate::control::Pid) |
//! | a process | [`ContouringBandwidth`]: the stiffest loop of a stated sensitivity | `bandwidth_hz`, `observer_hz` |
//! | any loop, the published gains too | [`LoopMargins`] of a [`SampledLoop`] | gain, phase, delay margin, sensitivity |
//!
//! Both experiments are state machines without I/O: they take a count every tick and make a
//! [`Demand`](crate::Demand), which goes through the [`SafetyGate`](crate::SafetyGate) like every other. They
//! end in bounded time and within a bounded travel, with a result or with a [`TuningError`] that says what is
//! wrong. Duties are shares of the supply, positions encoder counts.
//!
//! All of it is `f64` and takes thousands of sines for one result: on a desktop milliseconds, on a small
//! microcontroller seconds. The experiments' ticks are cheap, but for the last one of each run, which fits a
//! curve.

mod compensator;
mod complex;
mod contouring_bandwidth;
mod contouring_feedback;
mod experiment;
mod integrating_process;
mod loop_margins;
mod recording;
mod relay_experiment;
mod relay_point;
mod sample_point;
mod sampled_loop;
mod simc;
mod step_experiment;
mod step_fit;
mod tuning_error;

pub use compensator::Compensator;
pub use complex::Complex;
pub use contouring_bandwidth::ContouringBandwidth;
pub use contouring_feedback::ContouringFeedback;
pub use experiment::ExperimentSettings;
pub use integrating_process::IntegratingProcess;
pub use loop_margins::LoopMargins;
pub use relay_experiment::RelayExperiment;
pub use relay_point::RelayPoint;
pub use sampled_loop::SampledLoop;
pub use simc::{Simc, TunedPid};
pub use step_experiment::{IdentifiedMotor, StepExperiment};
pub use tuning_error::TuningError;
