//! [`Pace`]: how fast recorded time goes by for who watches.

use core::time::Duration;

/// How a recording is played.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PaceSettings {
    /// How many times as fast as it was; `None` is without waiting at all. Finite and above 0.
    pub speed: Option<f64>,
    /// What comes before is not waited for, and is not to be shown.
    pub from: Duration,
    /// What comes after is left out.
    pub to: Duration,
    /// Silences longer than this last only so long.
    pub longest_gap: Duration,
}

impl PaceSettings {
    /// The same with another [`PaceSettings::speed`].
    #[must_use]
    pub const fn with_speed(self, speed: Option<f64>) -> Self {
        Self { speed, ..self }
    }

    /// The same with another [`PaceSettings::from`].
    #[must_use]
    pub const fn with_from(self, from: Duration) -> Self {
        Self { from, ..self }
    }

    /// The same with another [`PaceSettings::to`].
    #[must_use]
    pub const fn with_to(self, to: Duration) -> Self {
        Self { to, ..self }
    }

    /// The same with another [`PaceSettings::longest_gap`].
    #[must_use]
    pub const fn with_longest_gap(self, longest_gap: Duration) -> Self {
        Self { longest_gap, ..self }
    }
}

impl Default for PaceSettings {
    /// All of it, without waiting.
    fn default() -> Self {
        Self { speed: None, from: Duration::ZERO, to: Duration::MAX, longest_gap: Duration::MAX }
    }
}

/// Says how long to wait before each record; reads no clock itself.
///
/// ```
/// # use plotter_replay::player::{Pace, PaceSettings};
/// # use core::time::Duration;
/// let ms = Duration::from_millis;
/// let mut pace = Pace::new(PaceSettings::default().with_speed(Some(2.0)).with_longest_gap(ms(100)));
/// assert_eq!(pace.wait(ms(50), ms(0)), ms(25)); // twice as fast
/// assert_eq!(pace.wait(ms(60), ms(29)), ms(1)); // 4 ms late, so it is waited 1 ms instead of 5
/// assert_eq!(pace.wait(ms(9_060), ms(30)), ms(50)); // a gap of 9 s lasts 100 ms
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    settings: PaceSettings,
    /// Recorded time until where it was played, and the played time of that.
    recorded: Duration,
    played: Duration,
}

impl Pace {
    /// At the beginning.
    #[must_use]
    pub const fn new(settings: PaceSettings) -> Self {
        Self { settings, recorded: Duration::ZERO, played: Duration::ZERO }
    }

    /// How long to wait until the record of `time` is due, when `elapsed` has gone by since the beginning.
    pub fn wait(&mut self, time: Duration, elapsed: Duration) -> Duration {
        let from = self.recorded.max(self.settings.from);
        let gap = time.saturating_sub(from).min(self.settings.longest_gap);
        self.recorded = time.max(self.recorded);
        let Some(speed) = self.settings.speed.filter(|speed| speed.is_finite() && *speed > 0.0) else {
            return Duration::ZERO;
        };
        let lasts = Duration::try_from_secs_f64(gap.as_secs_f64() / speed).unwrap_or(Duration::MAX);
        self.played = self.played.saturating_add(lasts);
        self.played.saturating_sub(elapsed)
    }

    /// Whether the record of `time` is to be shown.
    #[must_use]
    pub fn shows(&self, time: Duration) -> bool {
        (self.settings.from..=self.settings.to).contains(&time)
    }

    /// Whether nothing after `time` is to be shown.
    #[must_use]
    pub fn is_over(&self, time: Duration) -> bool {
        time > self.settings.to
    }
}
