//! [`SpeedAudit`]: speed and acceleration of a pen from nothing but the times of its steps.

use plotter_motion::{Point, Vec2};
use std::collections::VecDeque;

/// Time over which the position is averaged at least, ticks of a microsecond.
const BIN_TICKS: u64 = 1000;
const BIN_S: f64 = 1e-3;

/// Bins between the places that a speed is the difference of. A step of 0.01 mm more or less changes it by
/// some 0.3 mm/s.
const SPEED_BINS: usize = 10;

/// Fewest and most bins between the speeds that an acceleration is the difference of.
const ACCEL_BINS: (f64, f64) = (10.0, 100.0);

/// Share of the acceleration that a step more or less may make.
const STEP_SHARE: f64 = 0.03;

/// Where the direction turns by more than this from one window to the next is a corner, of which these
/// windows say nothing, rad.
const SHARP_RAD: f64 = 0.35;

/// Slower than this, a direction says nothing, mm/s.
const SLOW_MM_S: f64 = 2.0;

/// A standstill longer than this is not looked at to its end.
const LONG_BINS: u64 = 300;

/// What a moment looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// When, s.
    pub time_s: f64,
    /// Speed, mm/s, over 10 ms.
    pub speed_mm_s: f64,
    /// Acceleration along the path, mm/s²; 0 at corners.
    pub along_mm_s2: f64,
}

/// Differences of the place of a pen, which is told from step to step: means over 1 ms, compared over 10 ms
/// for the speed. The acceleration is compared over a window that is wider the slower the machine: over a
/// time t, a step of length s more or less looks like s/t².
#[derive(Clone, Debug)]
pub struct SpeedAudit {
    /// Bins of the window of accelerations.
    accel_bins: usize,
    /// The current place, and since when.
    at: Point,
    now: u64,
    /// What of the current bin is summed up.
    bin_end: u64,
    sum: Vec2,
    /// Sums of the means of the bins up to each of the last ones.
    sums: VecDeque<Vec2>,
    most_speed_mm_s: f64,
    most_accel: MostAccel,
    /// Whether velocities may jump, in corners.
    has_corners: bool,
}

/// The greatest accelerations, mm/s². Each is a mean over a window, so what was felt is at least that.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MostAccel {
    /// As a vector: what speeds up and what turns, together.
    pub vector_mm_s2: f64,
    /// Along x and along y.
    pub axes_mm_s2: [f64; 2],
    /// Along the path, and across it.
    pub along_mm_s2: f64,
    /// See above.
    pub across_mm_s2: f64,
}

impl SpeedAudit {
    /// A pen that stands at `at`, of a machine with steps of this length that is to keep to this
    /// acceleration. If its velocity may jump in corners, windows with a sharp turn say nothing; else nothing
    /// is left out.
    #[must_use]
    pub fn new(at: Point, step_mm: f64, accel_mm_s2: f64, has_corners: bool) -> Self {
        let window_s = (step_mm / (STEP_SHARE * accel_mm_s2)).sqrt();
        let bins = (window_s / BIN_S).round().clamp(ACCEL_BINS.0, ACCEL_BINS.1);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let accel_bins = bins as usize / 2 * 2;
        let mut audit = Self {
            accel_bins,
            at,
            now: 0,
            bin_end: BIN_TICKS,
            sum: Vec2::default(),
            sums: VecDeque::new(),
            most_speed_mm_s: 0.0,
            most_accel: MostAccel::default(),
            has_corners,
        };
        audit.stand();
        audit
    }

    /// Window of accelerations, ms.
    #[must_use]
    pub fn window_ms(&self) -> usize {
        self.accel_bins
    }

    /// Greatest speed so far, mm/s.
    #[must_use]
    pub fn most_speed_mm_s(&self) -> f64 {
        self.most_speed_mm_s
    }

    /// The greatest accelerations so far.
    #[must_use]
    pub fn most_accel(&self) -> MostAccel {
        self.most_accel
    }

    /// The pen goes to `to` at a tick of a microsecond. Each moment that this makes known is given to `each`.
    pub fn step(&mut self, tick: u64, to: Point, mut each: impl FnMut(Moment)) {
        self.until(tick, &mut each);
        self.at = to;
    }

    /// The pen stands at its last place until this tick, and some time longer.
    pub fn finish(&mut self, tick: u64, mut each: impl FnMut(Moment)) {
        self.until(tick + LONG_BINS * BIN_TICKS, &mut each);
    }

    fn until(&mut self, tick: u64, each: &mut impl FnMut(Moment)) {
        let long = 2 * LONG_BINS * BIN_TICKS;
        if tick.saturating_sub(self.now) > long {
            self.pass(self.now + LONG_BINS * BIN_TICKS, each);
            let skipped = (tick - self.now) / BIN_TICKS - 1;
            self.now += skipped * BIN_TICKS;
            self.bin_end += skipped * BIN_TICKS;
        }
        self.pass(tick, each);
    }

    fn pass(&mut self, tick: u64, each: &mut impl FnMut(Moment)) {
        while self.now < tick {
            let until = tick.min(self.bin_end);
            let share = ticks(until - self.now) / ticks(BIN_TICKS);
            self.sum = self.sum + (self.at - Point::ORIGIN) * share;
            self.now = until;
            if until == self.bin_end {
                self.bin_end += BIN_TICKS;
                let mean = std::mem::take(&mut self.sum);
                self.push(mean, each);
            }
        }
    }

    /// Forgets what was: the pen has stood where it is.
    fn stand(&mut self) {
        let place = self.at - Point::ORIGIN;
        let mut sum = Vec2::default();
        self.sums.clear();
        for _ in 0..=self.kept() {
            sum = sum + place;
            self.sums.push_back(sum);
        }
    }

    /// Bins that are looked at together.
    fn kept(&self) -> usize {
        2 * self.accel_bins + self.accel_bins / 2 + SPEED_BINS
    }

    fn push(&mut self, mean: Vec2, each: &mut impl FnMut(Moment)) {
        let last = self.sums.back().copied().unwrap_or_default();
        self.sums.push_back(last + mean);
        if self.sums.len() > self.kept() + 1 {
            self.sums.pop_front();
        }
        let speed_mm_s = self.velocity(0, SPEED_BINS).length();
        self.most_speed_mm_s = self.most_speed_mm_s.max(speed_mm_s);
        let window = self.accel_bins;
        let (before, after) = (self.velocity(window, window), self.velocity(0, window));
        let turn_rad = libm::atan2(before.cross(after), before.dot(after)).abs();
        let dt_s = BIN_S * ticks(window as u64);
        let slow = before.length().min(after.length()) < SLOW_MM_S;
        let mut along_mm_s2 = 0.0;
        let most = &mut self.most_accel;
        if !self.has_corners || slow || turn_rad < SHARP_RAD {
            let accel = (after + -before) * (1.0 / dt_s);
            most.vector_mm_s2 = most.vector_mm_s2.max(accel.length());
            let [x, y] = most.axes_mm_s2;
            most.axes_mm_s2 = [x.max(accel.x.abs()), y.max(accel.y.abs())];
        }
        if slow || turn_rad < SHARP_RAD {
            along_mm_s2 = (after.length() - before.length()) / dt_s;
            most.along_mm_s2 = most.along_mm_s2.max(along_mm_s2.abs());
        }
        if !slow && turn_rad < SHARP_RAD {
            // The mean of v²/r is that of the speed times the turning.
            let across = 0.5 * (before.length() + after.length()) * turn_rad / dt_s;
            most.across_mm_s2 = most.across_mm_s2.max(across);
        }
        let behind_ticks = BIN_TICKS * (SPEED_BINS as u64 * 3 / 4);
        let time_s = ticks((self.bin_end - BIN_TICKS).saturating_sub(behind_ticks)) * 1e-6;
        each(Moment { time_s, speed_mm_s, along_mm_s2 });
    }

    /// Velocity over a window that ends `ago` bins ago: from the mean over its half before to that at its
    /// end.
    fn velocity(&self, ago: usize, window: usize) -> Vec2 {
        let half = window / 2;
        let sum = |ago: usize| {
            let index = self.sums.len().checked_sub(1 + ago);
            index.and_then(|index| self.sums.get(index)).copied().unwrap_or_default()
        };
        let ends = sum(ago) + -sum(ago + half);
        let begins = sum(ago + window) + -sum(ago + window + half);
        (ends + -begins) * (1.0 / (ticks(half as u64) * ticks(window as u64) * BIN_S))
    }
}

/// Whole numbers below 2⁵³ are exact.
#[expect(clippy::cast_precision_loss, reason = "2^53 microseconds are 285 years")]
fn ticks(count: u64) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps of 0.01 mm along x by a law of the way, mm, over the time, s.
    fn audited(law: impl Fn(f64) -> f64, end_s: f64) -> SpeedAudit {
        let mut audit = SpeedAudit::new(Point::ORIGIN, 0.01, 1000.0, true);
        let (mut step, mut tick) = (0.0, 0);
        while ticks(tick) * 1e-6 < end_s {
            if law(ticks(tick) * 1e-6) >= (step + 0.5) * 0.01 {
                step += 1.0;
                audit.step(tick, Point::new(step * 0.01, 0.0), |_| {});
            }
            tick += 1;
        }
        audit.finish(tick, |_| {});
        audit
    }

    #[test]
    fn a_steady_speed_is_found() {
        let audit = audited(|t| 50.0 * t, 0.5);
        assert!((audit.most_speed_mm_s() - 50.0).abs() < 0.5, "{}", audit.most_speed_mm_s());
    }

    #[test]
    fn a_ramp_is_found() {
        // 100 ms at 1000 mm/s², then back; never farther than a tenth from the truth
        let law = |t: f64| {
            if t < 0.1 { 500.0 * t * t } else { 5.0 + 100.0 * (t - 0.1) - 500.0 * (t - 0.1).powi(2) }
        };
        let audit = audited(law, 0.2);
        let most = audit.most_accel();
        assert!((most.along_mm_s2 - 1000.0).abs() < 50.0, "{most:?}");
        assert!(most.across_mm_s2 < 1e-9, "{most:?}");
        assert_eq!((most.vector_mm_s2, most.axes_mm_s2), (most.along_mm_s2, [most.along_mm_s2, 0.0]));
        assert!((audit.most_speed_mm_s() - 97.0).abs() < 2.0, "{}", audit.most_speed_mm_s());
    }

    #[test]
    fn a_circle_accelerates_across() {
        // 30 mm/s on a radius of 10 mm: 90 mm/s²
        let mut audit = SpeedAudit::new(Point::new(10.0, 0.0), 0.01, 90.0, false);
        let mut at = (1000.0, 0.0);
        for tick in 0..2_000_000_u64 {
            let angle = 3.0 * ticks(tick) * 1e-6;
            let place = ((1000.0 * angle.cos()).round(), (1000.0 * angle.sin()).round());
            if place != at {
                at = place;
                audit.step(tick, Point::new(at.0 * 0.01, at.1 * 0.01), |_| {});
            }
        }
        let most = audit.most_accel();
        assert!((most.across_mm_s2 - 90.0).abs() < 5.0, "{most:?}");
        // Turning from the first moment on, 90 and a jump of 30 mm/s from rest.
        assert!(most.vector_mm_s2 >= most.across_mm_s2, "{most:?}");
    }

    #[test]
    fn an_hour_of_rest_is_passed_over() {
        let mut audit = SpeedAudit::new(Point::ORIGIN, 0.01, 1000.0, true);
        let mut moments = 0;
        audit.step(3_600_000_000, Point::new(0.01, 0.0), |_| moments += 1);
        audit.finish(3_600_000_000, |_| moments += 1);
        assert!(moments < 2000, "{moments}");
        assert!(audit.most_speed_mm_s() < 1.5);
    }
}
