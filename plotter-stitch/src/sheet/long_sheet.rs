//! [`LongSheet`]: a sheet of any length, simulated from frame to frame.

use super::noise::Noise;
use super::{Feed, FeedSettings, JoinError, JoinFrames, Joined, PaperEdge, SensedJoint, SensorNoise};
use crate::{Anchor, AnchorSettings, Chain, Crossing, Drift, FrameTransform, JointSigma, Optics};
use alloc::vec::Vec;
use plotter_motion::{Axis, Point, Vec2};

/// The edge of the paper lies this far below the drawing, mm.
const EDGE_BELOW_MM: f64 = 30.0;

/// Where in a frame the edge is looked for, as shares of its length: near both ends, where it tells a turn best.
const EDGE_SCANS: [f64; 8] = [0.02, 0.13, 0.24, 0.35, 0.74, 0.85, 0.96, 1.07];

/// What the joint of a method that does not say how well it knows it is taken for by the anchor: a tact's way, evenly spread, over the
/// distance of both Y scans.
const PUBLISHED_SIGMA: JointSigma = JointSigma { lateral_mm: 0.17, angle_rad: 1.4e-4 };

/// What a simulated sheet is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct SheetSettings {
    /// How the paper is moved.
    pub feed: FeedSettings,
    /// The optical head.
    pub optics: Optics,
    /// How far its sensing is from an ideal one.
    pub noise: SensorNoise,
    /// Standard deviation of the bends of the paper's edge, mm.
    pub edge_mm: f64,
    /// Length of a frame along the sheet, mm.
    pub frame_mm: f64,
    /// Where on the table each frame begins, mm.
    pub begin_mm: f64,
    /// Height of the frame, which is the length of a joint, mm.
    pub height_mm: f64,
    /// The most that lines may be moved at a joint to keep the drawing along the edge, mm; 0 for a sheet without an anchor.
    pub anchor_mm: f64,
}

impl Default for SheetSettings {
    /// The documented textile plotter with the paper's edge as anchor.
    fn default() -> Self {
        Self {
            feed: FeedSettings::default(),
            optics: Optics::default(),
            noise: SensorNoise::default(),
            edge_mm: 0.1,
            frame_mm: 1_800.0,
            begin_mm: 20.0,
            height_mm: 1_000.0,
            anchor_mm: 0.01,
        }
    }
}

/// What became of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointReport {
    /// The frame after the joint, from 1.
    pub frame: u32,
    /// What the procedure told.
    pub joined: Joined,
    /// How the frame was drawn: that, and what the anchor added.
    pub drawn: FrameTransform,
    /// How the lines of the frame before lie now: what the procedure was to find.
    pub truth: FrameTransform,
    /// The most that the anchor moved a line at the joint, mm.
    pub anchored_mm: f64,
    /// Where the frame lies on the sheet.
    pub drift: Drift,
    /// How far apart two strokes over a fold lie, mm, if the paper has folded.
    pub fold_mm: Option<f64>,
}

impl JointReport {
    /// From where a line of the frame before ends to where it goes on, at a place of the joint in the frame's own place on the table.
    #[must_use]
    pub fn discrepancy(&self, place: Point) -> Vec2 {
        self.drawn.to_machine(place) - self.truth.to_machine(place)
    }
}

/// A sheet that is drawn frame by frame on a simulated machine: paper that walks, an optical head that looks for marks, a procedure that
/// tells how the next frame lies. An endless row of joints; the same seed gives the same ones.
///
/// ```
/// use plotter_stitch::{LongSheet, ReferenceLines, SearchSettings, SheetSettings, StripJoin};
///
/// let join = StripJoin::new(&ReferenceLines::strip16(), SearchSettings::default());
/// let mut sheet = LongSheet::new(SheetSettings::default(), join, 1)?;
/// let report = sheet.next_joint()?;
/// for place in sheet.joint() {
///     assert!(report.discrepancy(place).length() < 0.1); // mm
/// }
/// # Ok::<(), plotter_stitch::JoinError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LongSheet<M> {
    settings: SheetSettings,
    method: M,
    feed: Feed,
    edge: PaperEdge,
    random: Noise,
    anchor: Option<Anchor>,
    /// How the last frame was drawn on the table.
    drawn: FrameTransform,
    /// Where it lies on the sheet.
    chain: Chain,
}

impl<M: JoinFrames> LongSheet<M> {
    /// A sheet with its first frame drawn: along the edge if there is an anchor, otherwise as the machine stands.
    ///
    /// # Errors
    ///
    /// [`JoinError::Transform`] if the settings are no numbers.
    pub fn new(settings: SheetSettings, method: M, seed: u64) -> Result<Self, JoinError> {
        let mut random = Noise::new(seed);
        let feed = Feed::new(settings.feed, random.bits());
        let edge = PaperEdge::new(settings.edge_mm, random.bits());
        let mut sheet = Self {
            settings,
            method,
            feed,
            edge,
            random,
            anchor: None,
            drawn: FrameTransform::IDENTITY,
            chain: Chain::new(),
        };
        if settings.anchor_mm > 0.0 {
            let anchoring = AnchorSettings {
                frame_mm: settings.frame_mm,
                joint: sheet.joint(),
                most_mm: settings.anchor_mm,
                // Bends, and the head's own reading of them.
                edge_sigma_mm: libm::hypot(settings.edge_mm, settings.noise.texture_mm).max(1e-3),
            };
            let seen = sheet.see_edge(&FrameTransform::IDENTITY);
            let (anchor, first) = Anchor::new(anchoring, &seen).map_err(JoinError::Transform)?;
            sheet.anchor = Some(anchor);
            sheet.drawn = first;
            sheet.chain = Chain::beginning_at(&first);
        }
        Ok(sheet)
    }

    /// Both ends of the joint, in the frame's own place on the table, mm.
    #[must_use]
    pub fn joint(&self) -> [Point; 2] {
        let SheetSettings { begin_mm, height_mm, .. } = self.settings;
        [Point::new(begin_mm, 0.0), Point::new(begin_mm, height_mm)]
    }

    /// How the last frame was drawn.
    #[must_use]
    pub const fn drawn(&self) -> FrameTransform {
        self.drawn
    }

    /// Moves the paper on, looks for the marks, and draws the next frame.
    ///
    /// # Errors
    ///
    /// [`JoinError`]: the marks were not found or do not agree. Nothing is drawn then, and the paper has moved: no line can be
    /// joined to this sheet any more.
    pub fn next_joint(&mut self) -> Result<JointReport, JoinError> {
        let frame_mm = self.settings.frame_mm;
        // The machine knows how far off the last frame was, and moves the paper by as much more.
        let moved = self.feed.next_move(frame_mm + self.drawn.shift().x);
        let before = moved.motion.after(&self.drawn);
        let truth = FrameTransform::new(
            before.angle_rad(),
            before.to_machine(Point::new(frame_mm, 0.0)) - Point::ORIGIN,
        )
        .map_err(JoinError::Transform)?;

        // The head looks where the last frame lay across the table.
        let view = Vec2::new(0.0, self.drawn.shift().y);
        let seen =
            FrameTransform::new(truth.angle_rad(), truth.shift() - view).map_err(JoinError::Transform)?;
        let stretched: Vec<Crossing> =
            self.method.crossings().iter().map(|crossing| self.stretched(*crossing, moved.stretch)).collect();
        let SheetSettings { optics, noise, .. } = self.settings;
        let mut joint = SensedJoint::new(&stretched, &seen, optics, noise, self.random.bits());
        let joined = self.method.join(&mut joint)?;
        let transform = FrameTransform::new(joined.transform.angle_rad(), joined.transform.shift() + view)
            .map_err(JoinError::Transform)?;
        let joined = Joined { transform, ..joined };

        let offset = FrameTransform::new(0.0, Vec2::new(frame_mm, 0.0)).map_err(JoinError::Transform)?;
        let edge = self.see_edge(&truth.after(&offset.inverse()).after(&self.chain.pose().inverse()));
        let drawn = self.anchor.as_mut().map_or(transform, |anchor| {
            anchor.steer(&transform, joined.sigma.unwrap_or(PUBLISHED_SIGMA), &edge)
        });
        let moved_by = |place: Point| drawn.to_machine(place).distance(transform.to_machine(place));
        let anchored_mm = self.joint().map(moved_by).into_iter().fold(0.0, f64::max);
        // On the sheet the frame lies where it was drawn, seen from the lines of the one before.
        self.chain.push(&offset.after(&truth.inverse().after(&drawn)));
        self.drawn = drawn;
        Ok(JointReport {
            frame: self.chain.frames(),
            joined,
            drawn,
            truth,
            anchored_mm,
            drift: self.chain.drift(frame_mm),
            fold_mm: moved.fold_mm,
        })
    }

    /// Places of the edge as the head finds them, in the machine's coordinates.
    fn see_edge(&mut self, sheet_to_machine: &FrameTransform) -> Vec<Point> {
        EDGE_SCANS
            .iter()
            .map(|share| {
                let x_mm = self.settings.begin_mm + share * self.settings.frame_mm;
                let along_mm = sheet_to_machine.to_sketch(Point::new(x_mm, -EDGE_BELOW_MM)).x;
                let edge = Point::new(along_mm, self.edge.off_mm(along_mm) - EDGE_BELOW_MM);
                let [noise_mm, _] = self.random.normals(self.settings.noise.texture_mm);
                sheet_to_machine.to_machine(edge) + Vec2::new(0.0, noise_mm)
            })
            .collect()
    }

    /// A mark as it lies on paper that has become longer along x, from the joint on.
    fn stretched(&self, crossing: Crossing, stretch: f64) -> Crossing {
        let begin_mm = self.settings.begin_mm;
        match crossing.axis {
            Axis::X => {
                Crossing { mark_mm: begin_mm + (crossing.mark_mm - begin_mm) * (1.0 + stretch), ..crossing }
            }
            Axis::Y => crossing,
        }
    }
}
