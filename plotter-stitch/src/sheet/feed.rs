//! [`Feed`]: simulates how the paper moves from frame to frame.

use super::noise::Noise;
use crate::FrameTransform;
use plotter_motion::Vec2;

/// Errors of the paper feed.
///
/// The default is a machine at the limits that Ivanov et al. give: rewinding stops up to 5 mm off its target,
/// and the paper turns by up to 0.002 rad. The rolls guide the paper a little: each move takes back a part of
/// drift and turn, so that a sheet of any length stays on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct FeedSettings {
    /// Greatest error of the distance that the paper is moved, mm.
    pub rewind_mm: f64,
    /// Drift to the right at each move: mean and standard deviation, mm.
    pub walk_mm: [f64; 2],
    /// Turn at each move: mean and standard deviation, rad.
    pub turn_rad: [f64; 2],
    /// Greatest turn, rad: the rolls allow no more.
    pub most_turn_rad: f64,
    /// Fraction of drift and turn that the rolls take back at each move, 0 to 1.
    pub led: f64,
    /// Standard deviation of the paper's stretch between drawing a mark and finding it again, as a fraction
    /// of the length along the sheet.
    pub stretch: f64,
    /// Standard deviation of the paper's swelling across its way between drawing and finding again, as a
    /// fraction of its width.
    pub swelling: f64,
    /// Fraction of the moves at which the paper folds, 0 to 1.
    pub folds: f64,
    /// Distance between the two strokes of a probe across a fold: least and greatest, mm.
    pub fold_mm: [f64; 2],
}

impl FeedSettings {
    /// The same with another [`FeedSettings::rewind_mm`].
    #[must_use]
    pub const fn with_rewind_mm(self, rewind_mm: f64) -> Self {
        Self { rewind_mm, ..self }
    }

    /// The same with another [`FeedSettings::walk_mm`].
    #[must_use]
    pub const fn with_walk_mm(self, walk_mm: [f64; 2]) -> Self {
        Self { walk_mm, ..self }
    }

    /// The same with another [`FeedSettings::turn_rad`].
    #[must_use]
    pub const fn with_turn_rad(self, turn_rad: [f64; 2]) -> Self {
        Self { turn_rad, ..self }
    }

    /// The same with another [`FeedSettings::most_turn_rad`].
    #[must_use]
    pub const fn with_most_turn_rad(self, most_turn_rad: f64) -> Self {
        Self { most_turn_rad, ..self }
    }

    /// The same with another [`FeedSettings::led`].
    #[must_use]
    pub const fn with_led(self, led: f64) -> Self {
        Self { led, ..self }
    }

    /// The same with another [`FeedSettings::stretch`].
    #[must_use]
    pub const fn with_stretch(self, stretch: f64) -> Self {
        Self { stretch, ..self }
    }

    /// The same with another [`FeedSettings::swelling`].
    #[must_use]
    pub const fn with_swelling(self, swelling: f64) -> Self {
        Self { swelling, ..self }
    }

    /// The same with another [`FeedSettings::folds`].
    #[must_use]
    pub const fn with_folds(self, folds: f64) -> Self {
        Self { folds, ..self }
    }

    /// The same with another [`FeedSettings::fold_mm`].
    #[must_use]
    pub const fn with_fold_mm(self, fold_mm: [f64; 2]) -> Self {
        Self { fold_mm, ..self }
    }
}

impl Default for FeedSettings {
    fn default() -> Self {
        Self {
            rewind_mm: 5.0,
            walk_mm: [0.02, 0.4],
            turn_rad: [2e-5, 3e-4],
            most_turn_rad: 0.002,
            led: 0.05,
            stretch: 1e-5,
            swelling: 0.0,
            folds: 0.0,
            fold_mm: [0.2, 2.0],
        }
    }
}

/// One move of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperMove {
    /// From where a point of the paper was before to where it is now, both in the machine's coordinates.
    pub motion: FrameTransform,
    /// Stretch of the paper since the last move, as a fraction of the length.
    pub stretch: f64,
    /// Growth of the paper's width meanwhile, as a fraction of it; negative where it has shrunk.
    pub swelling: f64,
    /// Distance between two strokes across the fold, mm, if the paper has folded.
    pub fold_mm: Option<f64>,
}

/// The rolls of a simulated machine: an endless sequence of moves. The same seed gives the same sequence.
///
/// ```
/// use plotter_motion::Point;
/// use plotter_stitch::sheet::{Feed, FeedSettings};
///
/// let mut feed = Feed::new(FeedSettings::default(), 1);
/// let moved = feed.next_move(950.0).motion.to_machine(Point::new(0.0, 970.0));
/// assert!((moved.y - 20.0).abs() <= 5.01);
/// assert!(feed.turn_rad().abs() <= 0.002);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Feed {
    settings: FeedSettings,
    random: Noise,
    walk_mm: f64,
    turn_rad: f64,
}

impl Feed {
    /// Paper that lies straight before the first move.
    #[must_use]
    pub fn new(settings: FeedSettings, seed: u64) -> Self {
        let mut random = Noise::new(seed);
        // Seeded twice, so that neighbouring seeds have nothing in common.
        random = Noise::new(random.bits());
        Self { settings, random, walk_mm: 0.0, turn_rad: 0.0 }
    }

    /// Drift of the paper to the right so far, mm.
    #[must_use]
    pub const fn walk_mm(&self) -> f64 {
        self.walk_mm
    }

    /// Turn of the paper relative to the machine, rad.
    #[must_use]
    pub const fn turn_rad(&self) -> f64 {
        self.turn_rad
    }

    /// Moves the paper by `by_mm`, with the errors of the settings.
    pub fn next_move(&mut self, by_mm: f64) -> PaperMove {
        let FeedSettings { rewind_mm, walk_mm, turn_rad, most_turn_rad, led, .. } = self.settings;
        let before = pose(self.turn_rad, self.walk_mm);
        let [walk, _] = self.random.normals(walk_mm[1]);
        let [turn, _] = self.random.normals(turn_rad[1]);
        self.walk_mm = self.walk_mm * (1.0 - led) + walk_mm[0] + walk;
        self.turn_rad =
            (self.turn_rad * (1.0 - led) + turn_rad[0] + turn).clamp(-most_turn_rad, most_turn_rad);
        let length_mm = by_mm + self.random.between(-rewind_mm, rewind_mm);
        let along = FrameTransform::new(0.0, Vec2::new(0.0, -length_mm)).unwrap_or(FrameTransform::IDENTITY);
        let motion = pose(self.turn_rad, self.walk_mm).after(&along).after(&before.inverse());
        let [stretch, _] = self.random.normals(self.settings.stretch);
        let folds = self.random.unit() < self.settings.folds;
        let [least_mm, most_mm] = self.settings.fold_mm;
        let fold_mm = self.random.between(least_mm, most_mm);
        let [swelling, _] = self.random.normals(self.settings.swelling);
        PaperMove { motion, stretch, swelling, fold_mm: folds.then_some(fold_mm) }
    }

    /// A person straightens the paper by hand, up to the drift and turn of one move. Returns where a point of
    /// the paper was before to where it is now.
    pub fn fit(&mut self) -> FrameTransform {
        let before = pose(self.turn_rad, self.walk_mm);
        [self.walk_mm, _] = self.random.normals(self.settings.walk_mm[1]);
        let [turn_rad, _] = self.random.normals(self.settings.turn_rad[1]);
        self.turn_rad = turn_rad.clamp(-self.settings.most_turn_rad, self.settings.most_turn_rad);
        pose(self.turn_rad, self.walk_mm).after(&before.inverse())
    }
}

/// The pose of paper with this turn and drift; numbers that are not finite leave it straight.
fn pose(turn_rad: f64, walk_mm: f64) -> FrameTransform {
    FrameTransform::new(turn_rad, Vec2::new(walk_mm, 0.0)).unwrap_or(FrameTransform::IDENTITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::Point;

    #[test]
    fn a_perfect_machine_moves_by_a_frame() {
        let perfect = FeedSettings {
            rewind_mm: 0.0,
            walk_mm: [0.0; 2],
            turn_rad: [0.0; 2],
            stretch: 0.0,
            ..FeedSettings::default()
        };
        let mut feed = Feed::new(perfect, 3);
        let moved = feed.next_move(950.0);
        assert_eq!(moved.motion.to_machine(Point::new(500.0, 970.0)), Point::new(500.0, 20.0));
        assert_eq!((moved.stretch, moved.fold_mm), (0.0, None));
    }

    #[test]
    fn a_thousand_moves_stay_on_the_table_and_have_the_stated_faults() {
        let mut feed = Feed::new(FeedSettings { folds: 0.1, ..FeedSettings::default() }, 1);
        let (mut most_walk_mm, mut most_turn_rad, mut folds) = (0.0_f64, 0.0_f64, 0);
        for _ in 0..1_000 {
            folds += u32::from(feed.next_move(950.0).fold_mm.is_some());
            most_walk_mm = most_walk_mm.max(feed.walk_mm().abs());
            most_turn_rad = most_turn_rad.max(feed.turn_rad().abs());
        }
        assert!((1.0..8.0).contains(&most_walk_mm), "{most_walk_mm}");
        assert!((0.001..=0.002).contains(&most_turn_rad), "{most_turn_rad}");
        // 100 and three standard deviations of 9.5.
        assert!((71..=129).contains(&folds), "{folds}");
    }
}
