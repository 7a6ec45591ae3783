//! [`LongSheet`]: a sheet of any length, simulated from frame to frame.

use super::noise::Noise;
use super::{
    Feed, FeedSettings, JoinError, JoinFrames, Joined, PaperEdge, PaperMove, SensedJoint, SensorNoise,
};
use crate::field::EDGE_BESIDE_MM;
use crate::{
    Anchor, Chain, Crossing, Field, FrameTransform, Optics,
    joint::{AnchorSettings, Drift, JointSigma},
    marks::{DrawnStrip, frame_ops},
};
use alloc::vec::Vec;
use core::f64::consts::FRAC_1_SQRT_2;
use plotter_motion::{Axis, PlotOp, Point, Vec2};

/// Where in a frame both edges are looked for, as shares of its length: near both ends, where it tells a turn
/// best.
const EDGE_SCANS: [f64; 8] = [0.02, 0.13, 0.24, 0.35, 0.74, 0.85, 0.96, 1.07];

/// What the joint of a method that does not say how well it knows it is taken for by the anchor: a tact's
/// way, evenly spread, over the distance of both Y scans.
const PUBLISHED_SIGMA: JointSigma = JointSigma { lateral_mm: 0.17, angle_rad: 1.2e-4 };

/// What a simulated sheet is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct SheetSettings {
    /// How the paper is moved.
    pub feed: FeedSettings,
    /// The optical head.
    pub optics: Optics,
    /// How far its sensing is from an ideal one.
    pub noise: SensorNoise,
    /// Standard deviation of the bends of the paper's edges, mm.
    pub edge_mm: f64,
    /// Where on the table each frame lies.
    pub field: Field,
    /// The most that lines may be moved at a joint to keep the drawing along the edge, mm; 0 for a sheet
    /// without an anchor.
    pub anchor_mm: f64,
}

impl SheetSettings {
    /// The same with another [`SheetSettings::feed`].
    #[must_use]
    pub const fn with_feed(self, feed: FeedSettings) -> Self {
        Self { feed, ..self }
    }

    /// The same with another [`SheetSettings::optics`].
    #[must_use]
    pub const fn with_optics(self, optics: Optics) -> Self {
        Self { optics, ..self }
    }

    /// The same with another [`SheetSettings::noise`].
    #[must_use]
    pub const fn with_noise(self, noise: SensorNoise) -> Self {
        Self { noise, ..self }
    }

    /// The same with another [`SheetSettings::edge_mm`].
    #[must_use]
    pub const fn with_edge_mm(self, edge_mm: f64) -> Self {
        Self { edge_mm, ..self }
    }

    /// The same with another [`SheetSettings::field`].
    #[must_use]
    pub const fn with_field(self, field: Field) -> Self {
        Self { field, ..self }
    }

    /// The same with another [`SheetSettings::anchor_mm`].
    #[must_use]
    pub const fn with_anchor_mm(self, anchor_mm: f64) -> Self {
        Self { anchor_mm, ..self }
    }
}

impl Default for SheetSettings {
    /// The documented textile plotter with the paper's edges as anchor.
    fn default() -> Self {
        Self {
            feed: FeedSettings::default(),
            optics: Optics::default(),
            noise: SensorNoise::default(),
            edge_mm: 0.1,
            field: Field::default(),
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
    /// From where a line of the frame before ends to where it goes on, at a place of the joint in the frame's
    /// own place on the table.
    #[must_use]
    pub fn discrepancy(&self, place: Point) -> Vec2 {
        self.drawn.to_machine(place) - self.truth.to_machine(place)
    }
}

/// A sheet that is drawn frame by frame on a simulated machine: paper that walks, an optical head that looks
/// for marks, a procedure that tells how the next frame lies. An endless row of joints; the same seed gives
/// the same ones.
///
/// ```
/// use plotter_stitch::{LongSheet, ReferenceLines, SheetSettings, StripJoin, sense::SearchSettings};
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
    pub(super) settings: SheetSettings,
    pub(super) method: M,
    pub(super) feed: Feed,
    edges: [PaperEdge; 2],
    pub(super) random: Noise,
    anchor: Option<Anchor>,
    /// How the last frame was drawn on the table.
    pub(super) drawn: FrameTransform,
    /// Where it lies on the sheet.
    chain: Chain,
    /// The lines of the frame before the joint, at its end.
    strip: DrawnStrip,
    /// Whether the last frame has been drawn; a blank one has no lines.
    is_drawn: bool,
    /// The frame change under way.
    pub(super) change: Option<Change>,
    /// How far to the right of its place the right border was at the joint before, and at this one, mm.
    pub(super) x_border2_mm: [f64; 2],
    /// The marks' greatest residual, mm, where the procedure tells it.
    pub(super) residual_mm: Option<f64>,
    /// Probes drawn in the coming frame, in its coordinates.
    pub(super) probes: Vec<[Point; 2]>,
    /// Whether the paper must be fitted before anything else is drawn.
    pub(super) is_stopped: bool,
    /// Whether it is known how the coming frame lies.
    is_joined: bool,
}

/// A frame change, and what was before it, so that it can be measured again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Change {
    /// How the lines of the frame before lie now.
    pub(super) truth: FrameTransform,
    stretch: f64,
    swelling: f64,
    pub(super) fold_mm: Option<f64>,
    drawn: FrameTransform,
    chain: Chain,
    anchor: Option<Anchor>,
}

impl<M: JoinFrames> LongSheet<M> {
    /// A sheet with its first frame drawn: along the edge if there is an anchor, otherwise as the machine
    /// stands.
    ///
    /// # Errors
    ///
    /// [`JoinError::Transform`] if the settings are no numbers.
    pub fn new(settings: SheetSettings, method: M, seed: u64) -> Result<Self, JoinError> {
        let mut random = Noise::new(seed);
        let feed = Feed::new(settings.feed, random.bits());
        let edges = [0, 1].map(|_| PaperEdge::new(settings.edge_mm, random.bits()));
        let mut sheet = Self {
            settings,
            method,
            feed,
            edges,
            random,
            anchor: None,
            drawn: FrameTransform::IDENTITY,
            chain: Chain::new(),
            strip: DrawnStrip::new(&settings.field),
            is_drawn: false,
            change: None,
            x_border2_mm: [0.0; 2],
            residual_mm: None,
            probes: Vec::new(),
            is_stopped: false,
            is_joined: true,
        };
        if settings.anchor_mm > 0.0 {
            let anchoring = AnchorSettings {
                frame_mm: settings.field.frame_mm,
                joint: sheet.joint(),
                most_mm: settings.anchor_mm,
                // Bends, and the head's own reading of them; the middle of both edges is off by less.
                edge_sigma_mm: (libm::hypot(settings.edge_mm, settings.noise.texture_mm) * FRAC_1_SQRT_2)
                    .max(1e-3),
            };
            let seen = sheet.see_middle(&FrameTransform::IDENTITY);
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
        self.settings.field.joint()
    }

    /// How the last frame was drawn.
    #[must_use]
    pub const fn drawn(&self) -> FrameTransform {
        self.drawn
    }

    /// Draws the last frame: finds places for its marks among its lines, which are given in the frame's
    /// coordinates, and tells what the machine does, in order: marks with their pen, if any, then the frame.
    /// A frame for which this is not called is blank.
    ///
    /// # Errors
    ///
    /// [`JoinError::Marks`]: a mark has no place; [`JoinError::Stopped`]: the paper has folded;
    /// [`JoinError::Unjoined`]: it is not known how it lies. Nothing must be drawn.
    pub fn draw<I: Iterator<Item = PlotOp>, F: Fn() -> I>(
        &mut self,
        pen: Option<u8>,
        frame: F,
    ) -> Result<impl Iterator<Item = PlotOp> + use<I, F, M>, JoinError> {
        self.may_go_on()?;
        self.method = self.marks_of(&frame)?;
        self.strip = DrawnStrip::new(&self.settings.field);
        frame().for_each(|op| self.strip.push(op));
        self.is_drawn = true;
        Ok(frame_ops(&self.settings.field, &self.drawn, self.method.strokes(), pen, frame()))
    }

    /// The procedure with its marks at the end of a frame.
    pub(super) fn marks_of<I: Iterator<Item = PlotOp>>(
        &self,
        frame: &impl Fn() -> I,
    ) -> Result<M, JoinError> {
        let mut strip = DrawnStrip::new(&self.settings.field);
        frame().for_each(|op| strip.push(op));
        let mut method = self.method.clone();
        method.place(&strip).map_err(JoinError::Marks)?;
        Ok(method)
    }

    /// The scans over the last frame's marks, as if the paper were moved as it should be.
    #[must_use]
    pub fn crossings(&self) -> &[Crossing] {
        self.method.crossings()
    }

    /// The strokes of the last frame's marks, where they are looked for, in the machine's coordinates.
    #[must_use]
    pub fn strokes(&self) -> Vec<[Point; 2]> {
        self.method.strokes()
    }

    /// Moves the paper on, looks for the marks, and tells how the next frame lies.
    ///
    /// # Errors
    ///
    /// [`JoinError`]: the marks were not found or do not agree. The paper has moved, and nothing more is
    /// drawn or moved until [`measure_anew`](Self::measure_anew) tells how it lies. [`JoinError::Stopped`]
    /// and [`JoinError::Unjoined`]: it was so before, and the paper has not moved.
    pub fn next_joint(&mut self) -> Result<JointReport, JoinError> {
        self.may_go_on()?;
        let frame_mm = self.settings.field.frame_mm;
        // The machine knows how far off the last frame was, and moves the paper by as much more.
        let moved = self.feed.next_move(frame_mm + self.drawn.shift().y);
        let before = moved.motion.after(&self.drawn);
        let truth = FrameTransform::new(
            before.angle_rad(),
            before.to_machine(Point::new(0.0, frame_mm)) - Point::ORIGIN,
        )
        .map_err(JoinError::Transform)?;
        if !core::mem::take(&mut self.is_drawn) {
            self.strip = DrawnStrip::new(&self.settings.field);
        }
        self.probes.clear();
        self.x_border2_mm[0] = self.x_border2_mm[1];
        let Self { drawn, chain, anchor, .. } = *self;
        let PaperMove { stretch, swelling, fold_mm, .. } = moved;
        self.change = Some(Change { truth, stretch, swelling, fold_mm, drawn, chain, anchor });
        self.measure()
    }

    /// Refuses where nothing must be drawn or moved.
    pub(super) const fn may_go_on(&self) -> Result<(), JoinError> {
        match (self.is_stopped, self.is_joined) {
            (true, _) => Err(JoinError::Stopped),
            (false, false) => Err(JoinError::Unjoined),
            (false, true) => Ok(()),
        }
    }

    /// Looks for the marks anew, after a search that failed or was broken off: somebody has cleaned the
    /// sensor or drawn a mark after.
    ///
    /// # Errors
    ///
    /// As [`next_joint`](Self::next_joint); [`JoinError::NoJoint`] before the first one.
    pub fn measure_anew(&mut self) -> Result<JointReport, JoinError> {
        self.measure()
    }

    /// Somebody has looked at the paper after [`FitError::Shrunk`](crate::FitError::Shrunk): it lies flat.
    /// The marks are looked for anew and believed.
    ///
    /// # Errors
    ///
    /// As [`measure_anew`](Self::measure_anew).
    pub fn seen_flat(&mut self) -> Result<JointReport, JoinError> {
        let usual = self.method.clone();
        self.method = usual.on_flat_paper();
        let told = self.measure();
        self.method = usual;
        told
    }

    /// Looks for the marks, as often as is asked, and tells how the frame lies.
    pub(super) fn measure(&mut self) -> Result<JointReport, JoinError> {
        self.is_joined = self.change.is_none();
        let Change { truth, stretch, swelling, fold_mm, drawn, chain, anchor } =
            self.change.ok_or(JoinError::NoJoint)?;
        (self.drawn, self.chain, self.anchor) = (drawn, chain, anchor);
        let frame_mm = self.settings.field.frame_mm;
        // The head looks where the last frame lay across the table.
        let view = Vec2::new(self.drawn.shift().x, 0.0);
        let seen =
            FrameTransform::new(truth.angle_rad(), truth.shift() - view).map_err(JoinError::Transform)?;
        let crossings = self.method.crossings().iter();
        let stretched: Vec<Crossing> =
            crossings.map(|crossing| self.stretched(*crossing, stretch, swelling)).collect();
        let SheetSettings { optics, noise, .. } = self.settings;
        let mut joint = SensedJoint::new(&stretched, &seen, optics, noise, self.random.bits()).with_drawing(
            &stretched,
            &seen,
            self.strip.lines(),
        );
        let joined = self.method.join(&mut joint)?;
        let transform = FrameTransform::new(joined.transform.angle_rad(), joined.transform.shift() + view)
            .map_err(JoinError::Transform)?;
        let [_, corner] = self.joint();
        // On the table, not from where the head looked.
        let x_border2_mm =
            joined.x_border2_mm.map_or(transform.to_machine(corner).x - corner.x, |mm| mm + view.x);
        let joined = Joined { transform, x_border2_mm: Some(x_border2_mm), ..joined };
        (self.x_border2_mm[1], self.residual_mm) = (x_border2_mm, joined.residual_mm);

        let offset = FrameTransform::new(0.0, Vec2::new(0.0, frame_mm)).map_err(JoinError::Transform)?;
        let middle = self.see_middle(&truth.after(&offset.inverse()).after(&self.chain.pose().inverse()));
        let drawn = self.anchor.as_mut().map_or(transform, |anchor| {
            anchor.steer(&transform, joined.sigma.unwrap_or(PUBLISHED_SIGMA), &middle)
        });
        let moved_by = |place: Point| drawn.to_machine(place).distance(transform.to_machine(place));
        let anchored_mm = self.joint().map(moved_by).into_iter().fold(0.0, f64::max);
        // On the sheet the frame lies where it was drawn, seen from the lines of the one before.
        self.chain.push(&offset.after(&truth.inverse().after(&drawn)));
        self.drawn = drawn;
        self.is_joined = true;
        Ok(JointReport {
            frame: self.chain.frames(),
            joined,
            drawn,
            truth,
            anchored_mm,
            drift: self.chain.drift(frame_mm),
            fold_mm,
        })
    }

    /// The paper's middle as the head finds it between both edges, in the machine's coordinates.
    fn see_middle(&mut self, sheet_to_machine: &FrameTransform) -> Vec<Point> {
        let Field { left_mm, begin_mm, frame_mm, .. } = self.settings.field;
        let at_mm = [left_mm - EDGE_BESIDE_MM, self.settings.field.right_mm() + EDGE_BESIDE_MM];
        EDGE_SCANS
            .iter()
            .map(|share| {
                let y_mm = begin_mm + share * frame_mm;
                let [left, right] = [0, 1].map(|side: usize| {
                    let along_mm = sheet_to_machine.to_sketch(Point::new(at_mm[side], y_mm)).y;
                    let edge = Point::new(at_mm[side] + self.edges[side].off_mm(along_mm), along_mm);
                    let [noise_mm, _] = self.random.normals(self.settings.noise.texture_mm);
                    sheet_to_machine.to_machine(edge) + Vec2::new(noise_mm, 0.0)
                });
                left.lerp(right, 0.5)
            })
            .collect()
    }

    /// A mark as it lies on paper that has become longer along y, from the joint on, and wider, from its
    /// middle on.
    fn stretched(&self, crossing: Crossing, stretch: f64, swelling: f64) -> Crossing {
        let Field { left_mm, width_mm, begin_mm, .. } = self.settings.field;
        let (still_mm, by) = match crossing.axis {
            Axis::Y => (begin_mm, stretch),
            Axis::X => (left_mm + 0.5 * width_mm, swelling),
        };
        Crossing { mark_mm: still_mm + (crossing.mark_mm - still_mm) * (1.0 + by), ..crossing }
    }
}
