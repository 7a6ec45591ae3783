//! [`Feed`]: how the paper moves from frame to frame.

use super::noise::Noise;
use crate::FrameTransform;
use plotter_motion::Vec2;

/// How badly the paper is moved on.
///
/// The default is a machine at the limits that its source gives: rewinding stops up to 5 mm beside its place,
/// and the turn comes to 0.002 rad. The rolls lead a little: each time a part of walk and turn is taken back,
/// so that a sheet of any length stays on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct FeedSettings {
    /// How far from where it was meant to the paper may stop, mm.
    pub rewind_mm: f64,
    /// Sideways at each move, to the right: mean and standard deviation, mm.
    pub walk_mm: [f64; 2],
    /// Turn at each move: mean and standard deviation, rad.
    pub turn_rad: [f64; 2],
    /// Greatest turn, rad: the rolls allow no more.
    pub most_turn_rad: f64,
    /// Share of walk and turn that the rolls take back at each move.
    pub led: f64,
    /// Standard deviation of the paper's stretch between drawing and finding again, as a share of the length
    /// along the sheet.
    pub stretch: f64,
    /// Standard deviation of the paper's swelling across its way between drawing and finding again, as a
    /// share of its width.
    pub swelling: f64,
    /// Share of the moves at which the paper folds.
    pub folds: f64,
    /// How far a fold lets the two strokes of a probe lie apart: least and greatest, mm.
    pub fold_mm: [f64; 2],
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
    /// Where what lay under a place of the machine lies now.
    pub motion: FrameTransform,
    /// By which share the paper has become longer meanwhile.
    pub stretch: f64,
    /// By which share it has become wider meanwhile; negative where it has shrunk.
    pub swelling: f64,
    /// How far apart two strokes over the fold lie, mm, if the paper has folded.
    pub fold_mm: Option<f64>,
}

/// The rolls of a simulated machine: an endless row of moves. The same seed gives the same ones.
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
    /// Paper that lies straight at first.
    #[must_use]
    pub fn new(settings: FeedSettings, seed: u64) -> Self {
        let mut random = Noise::new(seed);
        // Neighbouring seeds shall have nothing in common.
        random = Noise::new(random.bits());
        Self { settings, random, walk_mm: 0.0, turn_rad: 0.0 }
    }

    /// How far the paper has walked sideways, mm.
    #[must_use]
    pub const fn walk_mm(&self) -> f64 {
        self.walk_mm
    }

    /// How far it is turned against the machine, rad.
    #[must_use]
    pub const fn turn_rad(&self) -> f64 {
        self.turn_rad
    }

    /// Moves the paper on by a length that was asked for, mm.
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

    /// Somebody fits the paper by hand, so that it lies straight up to a first move's walk and turn. Gives
    /// where what lay under a place of the machine lies now.
    pub fn fit(&mut self) -> FrameTransform {
        let before = pose(self.turn_rad, self.walk_mm);
        [self.walk_mm, _] = self.random.normals(self.settings.walk_mm[1]);
        let [turn_rad, _] = self.random.normals(self.settings.turn_rad[1]);
        self.turn_rad = turn_rad.clamp(-self.settings.most_turn_rad, self.settings.most_turn_rad);
        pose(self.turn_rad, self.walk_mm).after(&before.inverse())
    }
}

/// Paper that is turned and has walked sideways; numbers that are none leave it straight.
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
