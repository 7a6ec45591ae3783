//! [`SpeedMeter`]: speed from counts over a window of time.

use core::time::Duration;

/// Samples that are kept: a window is at most this many sampling periods.
const SAMPLES: usize = 10;

/// s(t) = (P(t) − P(t − dt))/dt with dt = 100 ms at 30 mm/s, and shorter for slow motion (Khan and McGinn,
/// section 0.2.5).
///
/// The window is as many sampling periods as the last speed asks for: all ten from `full_window_counts_s` on,
/// in proportion below, never less than two. With 46.3 counts to the millimetre a window of 100 ms at 30 mm/s
/// holds 139 counts, so the grain of the result is 0.7 %; a short window follows a slow start at once, but
/// its grain is one count in 20 ms, 1.1 mm/s. What has to be straight to a count is therefore led by counts,
/// not by this.
///
/// ```
/// # use plotter_motion::control::SpeedMeter;
/// let mut meter = SpeedMeter::new(1389.0); // 30 mm/s
/// let mut count = 0;
/// for _ in 0..20 {
///     count += 14; // every 10 ms
///     meter.sample(count);
/// }
/// assert!((meter.speed_counts_s() - 1400.0).abs() < 1e-3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedMeter {
    full_window_counts_s: f32,
    counts: [i32; SAMPLES + 1],
    taken: usize,
    speed: f32,
}

impl SpeedMeter {
    /// How often [`sample`](Self::sample) is to be called.
    pub const PERIOD: Duration = Duration::from_millis(10);

    /// A meter at rest at count 0, with the speed from which on the window is 100 ms long.
    #[must_use]
    pub const fn new(full_window_counts_s: f32) -> Self {
        Self { full_window_counts_s, counts: [0; SAMPLES + 1], taken: 0, speed: 0.0 }
    }

    /// Takes the count at the end of a sampling period.
    pub fn sample(&mut self, count: i32) {
        // newest first; what has not been taken yet is as at the start
        self.counts.rotate_right(1);
        if let Some(newest) = self.counts.first_mut() {
            *newest = count;
        }
        self.taken = (self.taken + 1).min(SAMPLES);
        const LEAST: usize = 2;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "at most 10 periods; a float cast saturates"
        )]
        let wanted = (self.speed.abs() / self.full_window_counts_s * SAMPLES as f32) as usize;
        let periods = wanted.clamp(LEAST, SAMPLES).min(self.taken);
        let before = self.counts.get(periods).copied().unwrap_or(count);
        #[expect(clippy::cast_precision_loss, reason = "counts of a tenth of a second")]
        let (counts, periods) = (count.wrapping_sub(before) as f32, periods as f32);
        self.speed = counts / (periods * Self::PERIOD.as_secs_f32());
    }

    /// Speed, counts/s with sign.
    #[must_use]
    pub const fn speed_counts_s(&self) -> f32 {
        self.speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_motion_is_measured_over_a_shorter_time() {
        // A tenth of the full speed for a while, then rest: two periods later nothing is left of it.
        let mut slow = SpeedMeter::new(1000.0);
        let mut fast = SpeedMeter::new(100.0);
        for count in 1..=20 {
            slow.sample(count);
            fast.sample(count);
        }
        for _ in 0..2 {
            slow.sample(20);
            fast.sample(20);
        }
        assert_eq!(slow.speed_counts_s(), 0.0);
        // ten periods before, nine now that it is a tenth slower, of which two stood
        assert!((fast.speed_counts_s() - 7.0 / 0.09).abs() < 1e-3);
    }

    #[test]
    fn the_first_sample_is_over_one_period() {
        let mut meter = SpeedMeter::new(1000.0);
        meter.sample(-5);
        assert_eq!(meter.speed_counts_s(), -500.0);
    }
}
