//! [`Learning`]: what went wrong in the last run of a drawing is put right in the next.

use super::{ContourController, ContourState, ShaftModel};
use crate::config::DcConfig;
use crate::{Demand, Duty, Machine};
use core::f64::consts::TAU;

/// A stretch of time in what [`Learning`] remembers; a drawing that was never run has `LearnedBin::default()`
/// everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LearnedBin {
    /// Duty added to both axes.
    correction: [f32; 2],
    /// Sum of the errors at the edges of both axes in the present run, counts, and how many they were.
    sum: [f32; 2],
    edges: [u16; 2],
    /// Whether a line ends here.
    ends_line: bool,
}

impl LearnedBin {
    /// Duty added to both axes in this stretch.
    #[must_use]
    pub const fn correction(&self) -> [f32; 2] {
        self.correction
    }
}

/// How [`Learning`] learns.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LearningSettings {
    /// Length of a bin, s.
    pub bin_s: f32,
    /// Duty by a position error of both axes, 1/count.
    pub position: [f32; 2],
    /// Duty by a speed error, s/count.
    pub speed: [f32; 2],
    /// Duty by the integral of the position error over the line, 1/(count s).
    pub integral: [f32; 2],
    /// How long before an error is seen its cause is looked for, s.
    pub lead_s: f32,
    /// Time constant of the smoothing of what was learned, forwards and backwards, s.
    pub smoothing_s: f32,
}

impl LearningSettings {
    /// For a machine: the gains of its axes' controllers, bins of half a millisecond.
    #[must_use]
    pub fn of(machine: &Machine) -> Self {
        let config = DcConfig::of(machine);
        #[expect(clippy::cast_possible_truncation, reason = "f32 is the precision of the control loop")]
        let w = (config.control.contouring.bandwidth_hz * TAU) as f32;
        let per_supply = |axis| {
            let model = ShaftModel::new(axis);
            1.0 / (model.accel_per_volt * model.supply_v)
        };
        let [x, y] = [per_supply(&config.x), per_supply(&config.y)];
        Self {
            bin_s: 0.5e-3,
            position: [3.0 * w * w * x, 3.0 * w * w * y],
            speed: [3.0 * w * x, 3.0 * w * y],
            integral: [w * w * w * x, w * w * w * y],
            lead_s: 0.0,
            smoothing_s: 0.3 / w,
        }
    }
}

/// Iterative learning control: adds to another controller's duty what the last runs of the same drawing were
/// short of.
///
/// ```text
///   run k     duty = controller's + correction[line, time]            error e(t)
///   after it  correction[t] = smoothed(correction[t] + kp e(t + lead) + kd de/dt(t + lead))
///   run k+1   the same lines in the same order, from the same place
/// ```
///
/// What repeats is learned away: friction that is not as described, the pull of a cable, a coupling out of
/// true. The smoothing runs forwards and backwards over what was stored, so it shifts nothing in time; it
/// also keeps the learning to what the controller can answer for, so that it does not build up noise. Each
/// line has its own stretch of the store, in the order in which they come; where the store ends, nothing is
/// added.
///
/// The store is the caller's: it stays when the controller is made anew for the next run, and what the last
/// run left there is taken over then.
///
/// Source: S. Arimoto, S. Kawamura, F. Miyazaki, "Bettering Operation of Robots by Learning" (1984); D. A.
/// Bristow, M. Tharayil, A. G. Alleyne, "A Survey of Iterative Learning Control" (2006), for the filter
/// without shift (Q-filter) and the lead.
#[derive(Debug, PartialEq)]
pub struct Learning<'a, C> {
    controller: C,
    settings: LearningSettings,
    store: &'a mut [LearnedBin],
    /// Bins of the present line: from the first, so many.
    first: usize,
    length: usize,
}

impl<'a, C: ContourController> Learning<'a, C> {
    /// Takes over into the corrections what the last run left in the store, and begins the next one.
    #[must_use]
    pub fn new(controller: C, settings: LearningSettings, store: &'a mut [LearnedBin]) -> Self {
        take_over(store, &settings);
        Self { controller, settings, store, first: 0, length: 0 }
    }

    /// The bin at `time_s`, with fraction, from the middle of the first; on the present line.
    fn place(&self, time_s: f32) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "a line has far fewer than 2^24 bins")]
        let last = self.length.saturating_sub(1) as f32;
        (time_s / self.settings.bin_s - 0.5).clamp(0.0, last)
    }

    fn bin(&self, index: usize) -> Option<&LearnedBin> {
        (index < self.length).then(|| self.store.get(self.first.saturating_add(index))).flatten()
    }

    fn correction(&self, time_s: f32) -> [f32; 2] {
        let place = self.place(time_s);
        let (index, share) = (whole(place), place - libm::floorf(place));
        let Some(LearnedBin { correction: [x, y], .. }) = self.bin(index) else { return [0.0; 2] };
        let [next_x, next_y] = self.bin(index + 1).map_or([*x, *y], |bin| bin.correction);
        [x + (next_x - x) * share, y + (next_y - y) * share]
    }

    fn note(&mut self, state: &ContourState) {
        let index = whole(libm::roundf(self.place(state.plan_s - self.settings.lead_s)));
        let Some(bin) = self.store.get_mut(self.first.saturating_add(index)).filter(|_| index < self.length)
        else {
            return;
        };
        for ((sum, edges), axis) in bin.sum.iter_mut().zip(&mut bin.edges).zip([&state.x, &state.y]) {
            // A line whose end was waited at for long has more edges there than are counted.
            if let (Some(error), Some(more)) =
                (axis.edge_error.filter(|e| e.is_finite()), edges.checked_add(1))
            {
                *sum += error;
                *edges = more;
            }
        }
    }
}

/// A duty, whatever came of the sum.
fn within_supply(duty: f32) -> f32 {
    if duty.is_nan() { 0.0 } else { duty.clamp(-1.0, 1.0) }
}

fn whole(place: f32) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let whole = place as usize;
    whole
}

/// Adds to the corrections what they were short of, and smooths them, line by line.
fn take_over(store: &mut [LearnedBin], settings: &LearningSettings) {
    let share = settings.bin_s / (settings.smoothing_s.max(0.0) + settings.bin_s);
    for line in store.split_inclusive_mut(|bin| bin.ends_line) {
        for axis in [0, 1] {
            fill_gaps(line, axis);
            correct(line, axis, settings);
        }
        smooth(line.iter_mut(), share);
        smooth(line.iter_mut().rev(), share);
    }
}

/// Makes of the sums the errors themselves, straight from one to the next where no edge came; none before the
/// first, since the line began at rest in its place.
fn fill_gaps(line: &mut [LearnedBin], axis: usize) {
    let mut known = (0, 0.0);
    let mut index = 0;
    while index <= line.len() {
        let seen = line.get(index).and_then(|bin| {
            let (sum, edges) = (bin.sum.get(axis)?, bin.edges.get(axis)?);
            (*edges > 0).then(|| sum / f32::from(*edges))
        });
        let at_end = index == line.len();
        if let Some(error) = seen.or(at_end.then_some(known.1)) {
            let (from, level) = known;
            let length = index.saturating_sub(from).max(1);
            let between = line.iter_mut().take(index.saturating_add(1)).skip(from);
            for (step, bin) in between.enumerate() {
                #[expect(clippy::cast_precision_loss, reason = "a line has far fewer than 2^24 bins")]
                let passed = step as f32 / length as f32;
                if let Some((sum, edges)) = bin.sum.get_mut(axis).zip(bin.edges.get_mut(axis)) {
                    (*sum, *edges) = (level + (error - level) * passed, 0);
                }
            }
            known = (index, error);
        }
        index += 1;
    }
}

/// Adds to the corrections of an axis what a PID would have answered to the errors, with the slope at each
/// place itself.
fn correct(line: &mut [LearnedBin], axis: usize, settings: &LearningSettings) {
    let gain = |gains: [f32; 2]| gains.get(axis).copied().unwrap_or_default();
    let error = |line: &[LearnedBin], index: usize| {
        line.get(index).and_then(|bin| bin.sum.get(axis)).copied().unwrap_or_default()
    };
    let (mut before, mut integral) = (0.0, 0.0);
    for index in 0..line.len() {
        let here = error(line, index);
        let next = if index + 1 < line.len() { error(line, index + 1) } else { here };
        integral = within_supply(integral + gain(settings.integral) * here * settings.bin_s);
        let slope = (next - before) / (2.0 * settings.bin_s);
        let short = gain(settings.position) * here + gain(settings.speed) * slope + integral;
        before = here;
        if let Some(correction) = line.get_mut(index).and_then(|bin| bin.correction.get_mut(axis)) {
            *correction = within_supply(*correction + short);
        }
    }
    for bin in line {
        if let Some(sum) = bin.sum.get_mut(axis) {
            *sum = 0.0;
        }
    }
}

fn smooth<'a>(bins: impl Iterator<Item = &'a mut LearnedBin>, share: f32) {
    let mut level: Option<[f32; 2]> = None;
    for bin in bins {
        let [x, y] = level.unwrap_or(bin.correction);
        let [to_x, to_y] = bin.correction;
        bin.correction = [x + (to_x - x) * share, y + (to_y - y) * share];
        level = Some(bin.correction);
    }
}

impl<C: ContourController> ContourController for Learning<'_, C> {
    fn start(&mut self, duration_s: f32) {
        self.first = self.first.saturating_add(self.length);
        self.length = whole(libm::ceilf(duration_s / self.settings.bin_s)).max(1);
        if let Some(last) = self.store.get_mut(self.first.saturating_add(self.length - 1)) {
            last.ends_line = true;
        }
        self.controller.start(duration_s);
    }

    fn update(&mut self, state: &ContourState) -> Demand {
        let demand = self.controller.update(state);
        let [x, y] = self.correction(state.plan_s);
        self.note(state);
        Demand { x: Duty::saturating(demand.x.value() + x), y: Duty::saturating(demand.y.value() + y) }
    }
}
