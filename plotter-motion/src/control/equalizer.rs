//! [`Equalizer`]: leads two unequal motors to speeds in the wanted proportion.
//!
//! ```text
//!  base drive ──┬─▶ × (1 − trim) ─▶ motor 1 ─▶ counts 1 ──▶ ÷ wanted share ─┐
//!               │        ▲                                                  ▼
//!               │        └────────────── PID ◀───────────────────────── difference
//!               │        ▼                                                  ▲
//!               └─▶ × (1 + trim) ─▶ motor 2 ─▶ counts 2 ──▶ ÷ wanted share ─┘
//! ```

/// What the marking board's authors wished for (section 0.2.4 of their report) and did not build: *voltages
/// adjusted automatically until both speeds are equal*.
///
/// A cross-coupled controller: the measured counts of both motors since the last run, over the time between,
/// are their speeds; what it leads to zero is how far motor 1 is ahead of motor 2, which is the sum of the
/// differences of those speeds, so that a difference that has been is made up for and does not stay as drift.
///
/// Source of the coupling: Y. Koren, "Cross-Coupled Biaxial Computer Control for Manufacturing Systems"
/// (1980).
///
/// Gains by pole placement. A motor with gear and load is of first order: its speed follows the drive with
/// the time constant T, so trims of ∓u on both change the difference of their speeds, as a share of the
/// wanted speed v, by T d'' = −d' + 2 v u for the lead d. With u = kd d' + kp d + ki ∫d the loop is T s³ +
/// s² + 2v (kd s² + kp s + ki), and it has its three poles at −w for
///
/// ```text
/// 2 v kd = 3 T w − 1      2 v kp = 3 T w²      2 v ki = T w³
/// ```
///
/// A larger w lets less drift arise and makes more of the encoder's grain: see [`EqualizerSettings`].
///
/// ```
/// # use plotter_motion::control::{Equalizer, EqualizerSettings};
/// let mut equalizer = Equalizer::new(EqualizerSettings::default());
/// // motor 1 made 14 counts, motor 2 only 12: the first gets less than the second from now on
/// let (first, second) = equalizer.update([14, 12], [1.0, 1.0], 0.01);
/// assert!(first < 1.0 && second > 1.0);
/// assert!((first + second - 2.0).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equalizer {
    settings: EqualizerSettings,
    /// How far motor 1 is ahead of motor 2, counts.
    lead: f32,
    integral: f32,
}

/// What an [`Equalizer`] must know.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct EqualizerSettings {
    /// Time constant of the motors with what they move, s.
    pub time_constant_s: f32,
    /// The three poles w, 1/s.
    pub pole_rad_s: f32,
    /// Speed at full drive, counts/s.
    pub full_speed_counts_s: f32,
    /// Greatest trim, 0 to 1.
    pub most_trim: f32,
}

impl Default for EqualizerSettings {
    /// The simulated marking board: 25 ms, 3400 counts/s at 12 V; poles at 40/s, as quick as the motors
    /// themselves. At 30 mm/s one count more or less in a run of 5 ms is then a trim of 0.15, which the
    /// motors' inertia averages.
    fn default() -> Self {
        Self { time_constant_s: 0.025, pole_rad_s: 40.0, full_speed_counts_s: 3400.0, most_trim: 0.5 }
    }
}

impl Equalizer {
    /// An equalizer that has learnt nothing yet.
    #[must_use]
    pub const fn new(settings: EqualizerSettings) -> Self {
        Self { settings, lead: 0.0, integral: 0.0 }
    }

    /// Forgets how far either motor is ahead: a new move begins. What was learnt of the motors' difference
    /// stays.
    pub const fn restart(&mut self) {
        self.lead = 0.0;
    }

    /// The factors for both drives: 1 − trim and 1 + trim.
    ///
    /// `counts` are those of each motor since the last run, `dt_s` ago, and `wanted` is its drive, with sign;
    /// the speeds are led to the same proportion. Nothing changes while either wants no drive, or when a
    /// number is not finite.
    pub fn update(&mut self, counts: [i32; 2], wanted: [f32; 2], dt_s: f32) -> (f32, f32) {
        let EqualizerSettings { time_constant_s, pole_rad_s: w, full_speed_counts_s, most_trim } =
            self.settings;
        let [drive_1, drive_2] = wanted;
        let size = 0.5 * (drive_1.abs() + drive_2.abs());
        let usable = drive_1 != 0.0 && drive_2 != 0.0 && size.is_finite() && dt_s.is_finite() && dt_s > 0.0;
        if !usable {
            return (1.0, 1.0);
        }
        #[expect(clippy::cast_precision_loss, reason = "counts of one run")]
        let [made_1, made_2] = counts.map(|count| count as f32);
        let gained = made_1 * size / drive_1 - made_2 * size / drive_2;
        self.lead += gained;
        let gain = 2.0 * full_speed_counts_s * size;
        let kd = (3.0 * time_constant_s * w - 1.0).max(0.0) / gain;
        let kp = 3.0 * time_constant_s * w * w / gain;
        let ki = time_constant_s * w * w * w / gain;
        // The integral alone never asks for more than there is, however long a motor is held fast.
        self.integral = (self.integral + ki * self.lead * dt_s).clamp(-most_trim, most_trim);
        let trim = (kd * gained / dt_s + kp * self.lead + self.integral).clamp(-most_trim, most_trim);
        (1.0 - trim, 1.0 + trim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two motors of first order, the second 10 % slower: the trims must become what makes them equal.
    #[test]
    fn unequal_motors_come_to_equal_speeds_and_places() {
        const DT_S: f32 = 0.005;
        const TIME_CONSTANT_S: f32 = 0.025;
        const FULL: [f32; 2] = [3400.0, 3060.0];
        let mut equalizer = Equalizer::new(EqualizerSettings::default());
        let (mut speed, mut place) = ([0.0_f32; 2], [0.0_f32; 2]);
        let (mut last, mut trims) = ([0_i32; 2], (1.0, 1.0));
        for _ in 0..600 {
            for (i, factor) in [trims.0, trims.1].into_iter().enumerate() {
                speed[i] += (FULL[i] * 0.35 * factor - speed[i]) * (DT_S / TIME_CONSTANT_S);
                place[i] += speed[i] * DT_S;
            }
            let now = place.map(|p| crate::toolpath::from_mm(f64::from(p), 1.0));
            trims = equalizer.update([now[0] - last[0], now[1] - last[1]], [0.35, 0.35], DT_S);
            last = now;
        }
        // less than a count apart, and speeds equal within the grain: 3 s at 1200 counts/s
        assert!((place[0] - place[1]).abs() < 1.5, "{place:?}");
        assert!((speed[0] / speed[1] - 1.0).abs() < 0.1, "{speed:?}");
    }

    #[test]
    fn a_motor_that_shall_stand_is_no_reason_to_trim() {
        let mut equalizer = Equalizer::new(EqualizerSettings::default());
        assert_eq!(equalizer.update([50, 0], [0.3, 0.0], 0.01), (1.0, 1.0));
        assert_eq!(equalizer.update([50, 0], [0.3, f32::NAN], 0.01), (1.0, 1.0));
        assert_eq!(equalizer.update([50, 0], [0.3, 0.3], 0.0), (1.0, 1.0));
    }

    #[test]
    fn a_motor_held_fast_asks_for_no_more_than_the_most() {
        let mut equalizer = Equalizer::new(EqualizerSettings::default());
        for _ in 0..10_000 {
            let (first, second) = equalizer.update([5, 0], [0.3, 0.3], 0.002);
            assert!((0.5..=1.0).contains(&first) && (1.0..=1.5).contains(&second));
        }
    }
}
