//! [`Play`]: the play of both axes: its extra steps, and where the carriage is.

use super::StepperPlotterSettings;
use crate::kinematics::Backlash;
use crate::{
    StepPair, StepPoint,
    safety::Pulse,
    stepgen::{BacklashSteps, TimedEvent},
};

/// Ticks of the step generator in a second.
pub(super) const CLOCK_HZ: u32 = 1_000_000;

/// Takes up the play of the axes, and knows at every step which flank of its gap a motor drives: so the place
/// of the carriage is right also after a stop in the middle of a gap.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Play {
    steps: Option<BacklashSteps>,
    most: Backlash,
    gap: Gap,
}

/// How far each motor has come within its gap, from where it drives backwards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Gap([u16; 2]);

impl Gap {
    /// The motors have made a step.
    pub(super) fn made(&mut self, step: StepPair, most: Backlash) {
        let most = [most.x_steps, most.y_steps];
        for ((gap, most), step) in self.0.iter_mut().zip(most).zip([step.x, step.y]) {
            *gap = match step.signum() {
                1 => gap.saturating_add(1).min(most),
                -1 => gap.saturating_sub(1),
                _ => *gap,
            };
        }
    }

    /// Where the carriage is, in steps, with the motors at `motors`.
    pub(super) fn carriage(self, motors: StepPoint) -> StepPoint {
        let [x, y] = self.0.map(i32::from);
        StepPoint::new(motors.x.saturating_sub(x), motors.y.saturating_sub(y))
    }
}

#[cfg(feature = "step-ahead")]
impl Gap {
    /// Both numbers in one, and back.
    pub(super) fn bits(self) -> u32 {
        let [[a, b], [c, d]] = self.0.map(u16::to_le_bytes);
        u32::from_le_bytes([a, b, c, d])
    }

    pub(super) fn of_bits(bits: u32) -> Self {
        let [a, b, c, d] = bits.to_le_bytes();
        Self([u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d])])
    }
}

impl Play {
    /// After homing, which leaves both axes driven backwards.
    pub(super) fn new(settings: &StepperPlotterSettings) -> Self {
        let most = settings.backlash;
        let start_hz = settings.home_x.start_hz.min(settings.home_y.start_hz).max(1);
        let interval_ticks = CLOCK_HZ.div_ceil(start_hz).into();
        let has_play = most != Backlash::default();
        Self { steps: has_play.then(|| BacklashSteps::new(most, interval_ticks)), most, gap: Gap::default() }
    }

    /// The machine is another one from here on; nothing is owed.
    pub(super) fn begin_anew(&mut self, settings: &StepperPlotterSettings) {
        *self = Self { gap: self.gap, ..Self::new(settings) };
        self.stopped();
    }

    /// The next event that is due before any of the path that has not been pushed.
    pub(super) fn next_event(&mut self) -> Option<TimedEvent> {
        self.steps.as_mut()?.next_event()
    }

    /// Takes an event of the path; gives it back where there is no play.
    pub(super) fn push(&mut self, event: TimedEvent) -> Option<TimedEvent> {
        let Some(steps) = &mut self.steps else { return Some(event) };
        let pushed = steps.push(event);
        debug_assert!(pushed.is_ok(), "all events have been taken");
        None
    }

    /// An extra step that is still to come when the path has ended.
    pub(super) fn rest(&mut self) -> Option<TimedEvent> {
        self.steps.as_mut()?.rest()
    }

    /// The motors have made a step.
    pub(super) fn made(&mut self, pulse: Pulse) {
        self.gap.made(pulse.into(), self.most);
    }

    /// Where the carriage is, in steps, with the motors at `motors`.
    pub(super) fn carriage(&self, motors: StepPoint) -> StepPoint {
        self.gap.carriage(motors)
    }

    #[cfg(feature = "step-ahead")]
    pub(super) const fn gap(&self) -> Gap {
        self.gap
    }

    /// The motors have been stopped at once, where they have come to within their gaps.
    #[cfg(feature = "step-ahead")]
    pub(super) fn stopped_at(&mut self, gap: Gap) {
        self.gap = gap;
        self.stopped();
    }

    /// The motors have been stopped at once.
    pub(super) fn stopped(&mut self) {
        let Gap([x, y]) = self.gap;
        if let Some(steps) = &mut self.steps {
            steps.clear(x, y);
        }
    }

    /// Both axes stand where they have been driven backwards to.
    pub(super) fn homed(&mut self) {
        self.gap = Gap::default();
        self.stopped();
    }
}
