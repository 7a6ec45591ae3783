//! [`ContouringBandwidth`]: how stiff the contouring controller may be.

use super::{Compensator, ContouringFeedback, IntegratingProcess, LoopMargins, SampledLoop, TuningError};
use crate::config::AxisConfig;
use crate::control::{PositionGains, ShaftModel};
use core::f64::consts::TAU;

/// `bandwidth_hz` and `observer_hz` of the contouring controller, and the margins of its stiffest loop with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContouringBandwidth {
    /// Natural frequency of the position loop along the line, Hz; across it the loop is 1.6 times as stiff.
    pub bandwidth_hz: f64,
    /// Natural frequency of the estimator, Hz.
    pub observer_hz: f64,
    /// Of the loop across the line.
    pub margins: LoopMargins,
}

/// The loop across the line is so much stiffer than that along it, as in `ContouringSettings`.
const ACROSS_SHARE: f64 = 1.6;

/// The estimator is so much quicker than the position loop.
const OBSERVER_SHARE: f64 = 3.0;
/// What a [`Machine`](crate::Machine) allows of the estimator: a quarter of the loop's rate. (A tenth of the rate, which it allows of the
/// position loop, is more than a third of that.)
const OBSERVER_MOST: f64 = 0.25;

impl ContouringBandwidth {
    /// The stiffest pair with `observer_hz` three times `bandwidth_hz` whose loop across the line has a sensitivity of
    /// `max_sensitivity` at most, and that the rules of a [`Machine`](crate::Machine) allow at this rate of the loop.
    ///
    /// `believed` is what the controller takes the axis to be, its description; `process` is the motor as it is.
    ///
    /// ```
    /// # use plotter_motion::config::AxisConfig;
    /// # use plotter_motion::control::tuning::{ContouringBandwidth, IntegratingProcess};
    /// let axis = AxisConfig::default();
    /// let process = IntegratingProcess::of(&axis);
    /// let found = ContouringBandwidth::tune(&axis, &process, 4e-4, 1.7)?;
    /// assert!(found.margins.max_sensitivity <= 1.7 && found.margins.max_sensitivity > 1.69);
    /// assert!((45.0..60.0).contains(&found.bandwidth_hz)); // the gantry's 50 Hz
    /// # Ok::<(), plotter_motion::control::tuning::TuningError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`TuningError::MarginOutOfReach`] with the least sensitivity that any bandwidth gives.
    pub fn tune(
        believed: &AxisConfig,
        process: &IntegratingProcess,
        tick_s: f64,
        max_sensitivity: f64,
    ) -> Result<Self, TuningError> {
        /// Down from the greatest: 10 to the power of this many thirtieths.
        const THIRTIETHS: u32 = 120;
        const HALVINGS: u32 = 12;
        let most_hz = OBSERVER_MOST / (OBSERVER_SHARE * tick_s);
        let of = |hz: f64| Self::evaluate(believed, process, tick_s, hz, OBSERVER_SHARE * hz);
        let is_good = |found: &Self| found.margins.max_sensitivity <= max_sensitivity;
        let mut best = f64::INFINITY;
        let mut too_stiff_hz = most_hz;
        for thirtieth in 0..=THIRTIETHS {
            let mut found = of(most_hz * libm::pow(10.0, f64::from(thirtieth) / -30.0));
            best = best.min(found.margins.max_sensitivity);
            if !is_good(&found) {
                too_stiff_hz = found.bandwidth_hz;
                continue;
            }
            for _ in 0..HALVINGS {
                let middle = of(0.5 * (found.bandwidth_hz + too_stiff_hz));
                if is_good(&middle) {
                    found = middle;
                } else {
                    too_stiff_hz = middle.bandwidth_hz;
                }
            }
            return Ok(found);
        }
        Err(TuningError::MarginOutOfReach { asked: max_sensitivity, best })
    }

    /// Margins of the loop across the line, for two frequencies, a description of the axis that the controller believes, and
    /// the motor as it is.
    #[must_use]
    pub fn evaluate(
        believed: &AxisConfig,
        process: &IntegratingProcess,
        tick_s: f64,
        bandwidth_hz: f64,
        observer_hz: f64,
    ) -> Self {
        let w = ACROSS_SHARE * bandwidth_hz * TAU;
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let gains = PositionGains { position: (w * w) as f32, speed: (2.0 * w) as f32 };
        let feedback =
            ContouringFeedback { model: ShaftModel::new(believed), gains, observer_rad_s: observer_hz * TAU };
        let compensator = Compensator::Contouring(feedback);
        let margins = LoopMargins::from_loop(&SampledLoop { process: *process, compensator, tick_s });
        Self { bandwidth_hz, observer_hz, margins }
    }
}
