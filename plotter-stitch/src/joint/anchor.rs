//! [`Anchor`]: the paper's edge keeps a long drawing straight.

use crate::{FrameTransform, joint::TransformError};
use plotter_motion::{Point, Vec2};

/// Number of frames over which an offset is taken back, unless a joint may add less. Fewer would bend the
/// drawing more sharply at each joint.
const FRAMES_TO_RETURN: f64 = 8.0;

/// Least distance of two places of the edge that tell its direction, mm: over less, the edge's bends of some
/// tenths of a millimetre are all that is seen.
const SHORTEST_EDGE_MM: f64 = 10.0;

/// What an anchor knows of its sheet, and how much it may add at a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AnchorSettings {
    /// Length of a frame, mm.
    pub frame_mm: f64,
    /// Both ends of a joint, in the coordinates of the frame that it begins, mm.
    pub joint: [Point; 2],
    /// The most that lines may be moved at a joint, anywhere on it, mm.
    pub most_mm: f64,
    /// Standard deviation of where the edge is found, from where a straight one would be, mm.
    pub edge_sigma_mm: f64,
}

impl AnchorSettings {
    /// The same with another [`AnchorSettings::frame_mm`].
    #[must_use]
    pub const fn with_frame_mm(self, frame_mm: f64) -> Self {
        Self { frame_mm, ..self }
    }

    /// The same with another [`AnchorSettings::joint`].
    #[must_use]
    pub const fn with_joint(self, joint: [Point; 2]) -> Self {
        Self { joint, ..self }
    }

    /// The same with another [`AnchorSettings::most_mm`].
    #[must_use]
    pub const fn with_most_mm(self, most_mm: f64) -> Self {
        Self { most_mm, ..self }
    }

    /// The same with another [`AnchorSettings::edge_sigma_mm`].
    #[must_use]
    pub const fn with_edge_sigma_mm(self, edge_sigma_mm: f64) -> Self {
        Self { edge_sigma_mm, ..self }
    }
}

impl Default for AnchorSettings {
    /// Fields of 1980 x 950 mm, 0.01 mm at a joint, an edge that is straight to 0.1 mm.
    fn default() -> Self {
        Self {
            frame_mm: 950.0,
            joint: [Point::ORIGIN, Point::new(1_980.0, 0.0)],
            most_mm: 0.01,
            edge_sigma_mm: 0.1,
        }
    }
}

/// How well a joint is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct JointSigma {
    /// Standard deviation across the sheet, mm.
    pub lateral_mm: f64,
    /// Standard deviation of the turn, rad.
    pub angle_rad: f64,
}

/// Steers the frames of a sheet along its edge.
///
/// Every joint is a little off, and nothing in the reference lines tells by how much: the turns add up to a
/// random walk, and the lateral place is the sum of that walk, so that it grows with the power 1.5 of the
/// number of frames. The edge of the paper is rough, but it does not drift. Two numbers are estimated, the
/// offset e of a frame's beginning from the edge and the turn φ between them,
///
/// ```text
/// next frame:  e ← e - frame_mm φ + (error of the joint),   φ ← φ + (error of the joint)
/// edge at y:   e - φ y + (roughness)
/// ```
///
/// by a Kalman filter (R. E. Kalman, "A new approach to linear filtering and prediction problems", 1960), and
/// the frame is turned about the middle of its joint, towards an offset that dies away. A turn moves the ends
/// of the joint by half its length times the turn, which is never more than [`AnchorSettings::most_mm`].
///
/// ```
/// use plotter_motion::Point;
/// use plotter_stitch::{Anchor, FrameTransform, joint::{AnchorSettings, JointSigma}};
///
/// // The drawing lies straight, 55 mm from the edge on its left. Then the edge comes 1 mm nearer.
/// let (mut anchor, first) = Anchor::new(AnchorSettings::default(), &[Point::new(-55.0, 0.0), Point::new(-55.0, 950.0)])?;
/// assert_eq!(first, FrameTransform::IDENTITY);
/// let sigma = JointSigma { lateral_mm: 0.01, angle_rad: 1e-5 };
/// let edge = [Point::new(-54.0, 0.0), Point::new(-54.0, 950.0)];
/// let drawn = anchor.steer(&FrameTransform::IDENTITY, sigma, &edge);
/// // So the drawing has come too near: it is turned away, by 0.01 mm at either end of 1980 mm.
/// assert!((drawn.angle_rad() + 0.02 / 1980.0).abs() < 1e-15);
/// # Ok::<(), plotter_stitch::joint::TransformError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anchor {
    settings: AnchorSettings,
    /// The edge's x in the frames' coordinates where nothing is off, mm.
    edge_mm: f64,
    offset_mm: f64,
    turn_rad: f64,
    /// Variances of both, and their covariance.
    covariance: [f64; 3],
}

impl Anchor {
    /// Looks at the edge before the first frame: places of the edge in the machine's coordinates, two or
    /// more. Gives how the first frame must lie to be parallel to it.
    ///
    /// # Errors
    ///
    /// [`TransformError`] if the places tell no direction, or one that no sheet has.
    pub fn new(settings: AnchorSettings, edge: &[Point]) -> Result<(Self, FrameTransform), TransformError> {
        if let Some(value) = edge.iter().flat_map(|place| [place.x, place.y]).find(|value| !value.is_finite())
        {
            return Err(TransformError::NotFinite { mark: None, value });
        }
        let (mut count, mut sum) = (0.0, Vec2::default());
        for place in edge {
            count += 1.0;
            sum = sum + (*place - Point::ORIGIN);
        }
        let mean = Point::ORIGIN + sum * (1.0 / f64::max(count, 1.0));
        let (mut squares, mut products) = (0.0, 0.0);
        for place in edge {
            let off = *place - mean;
            squares += off.y * off.y;
            products += off.x * off.y;
        }
        let extent_mm = libm::sqrt(squares);
        if extent_mm < SHORTEST_EDGE_MM {
            return Err(TransformError::Baseline { baseline_mm: extent_mm, least_mm: SHORTEST_EDGE_MM });
        }
        let first = FrameTransform::new(-libm::atan(products / squares), Vec2::default())?;
        let variance = settings.edge_sigma_mm * settings.edge_sigma_mm;
        let anchor = Self {
            settings,
            edge_mm: first.to_sketch(mean).x,
            offset_mm: 0.0,
            turn_rad: 0.0,
            // The first frame's own place is what later ones are held against: only its turn is uncertain.
            covariance: [0.0, 0.0, variance / squares],
        };
        Ok((anchor, first))
    }

    /// How the next frame is drawn: `joint` is how it must lie to meet the last one, `edge` are places of the
    /// edge in the machine's coordinates, none or more.
    pub fn steer(&mut self, joint: &FrameTransform, sigma: JointSigma, edge: &[Point]) -> FrameTransform {
        self.predict(sigma);
        for place in edge.iter().filter(|place| place.is_finite()) {
            self.correct(joint.to_sketch(*place));
        }
        let turn_rad = self.wanted_turn();
        self.turn_rad += turn_rad;
        let [one, other] = self.settings.joint;
        let middle = one.lerp(other, 0.5) - Point::ORIGIN;
        let turned = FrameTransform::new(turn_rad, middle - middle.rotated(turn_rad));
        turned.map_or(*joint, |turned| joint.after(&turned))
    }

    /// How far to the right of its place the drawing is believed to be, mm, at the beginning of the last
    /// frame.
    #[must_use]
    pub const fn offset_mm(&self) -> f64 {
        self.offset_mm
    }

    fn predict(&mut self, sigma: JointSigma) {
        // A frame that is turned counter-clockwise leads to the left.
        let length = -self.settings.frame_mm;
        let [ee, ep, pp] = self.covariance;
        self.offset_mm += length * self.turn_rad;
        self.covariance = [
            ee + 2.0 * length * ep + length * length * pp + sigma.lateral_mm * sigma.lateral_mm,
            ep + length * pp,
            pp + sigma.angle_rad * sigma.angle_rad,
        ];
    }

    /// Takes a place of the edge, in the coordinates of the frame.
    fn correct(&mut self, place: Point) {
        let [ee, ep, pp] = self.covariance;
        let back_mm = -place.y;
        let (he, hp) = (ee + back_mm * ep, ep + back_mm * pp);
        let variance = he + back_mm * hp + self.settings.edge_sigma_mm * self.settings.edge_sigma_mm;
        if variance <= 0.0 {
            return;
        }
        // The edge seems to lie farther left by as much as the drawing has come to the right.
        let surprise_mm = self.edge_mm - place.x - (self.offset_mm + self.turn_rad * back_mm);
        let (gain_e, gain_p) = (he / variance, hp / variance);
        self.offset_mm += gain_e * surprise_mm;
        self.turn_rad += gain_p * surprise_mm;
        self.covariance = [ee - gain_e * he, ep - gain_e * hp, pp - gain_p * hp];
    }

    /// The turn at this joint: towards a direction in which the offset dies away, slow enough to be stopped
    /// again.
    fn wanted_turn(&self) -> f64 {
        let [one, other] = self.settings.joint;
        // The ends of the joint go round its middle; the chord is a little shorter than the arc.
        let most_rad = 2.0 * self.settings.most_mm / one.distance(other);
        let length = self.settings.frame_mm;
        let offset_mm = libm::fabs(self.offset_mm);
        let braking_mm = libm::sqrt(2.0 * most_rad * length * offset_mm);
        let wanted_rad = (offset_mm / FRAMES_TO_RETURN).min(braking_mm) / length;
        let wanted_rad = libm::copysign(wanted_rad, self.offset_mm);
        (wanted_rad - self.turn_rad).clamp(-most_rad, most_rad)
    }
}
