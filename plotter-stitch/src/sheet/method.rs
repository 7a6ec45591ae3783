//! [`JoinFrames`]: the procedure at a frame change, as published and ours.

use super::SensedJoint;
use crate::marks::ASTRAY_MM;
use crate::{
    Crossing, Field, FitError, FrameTransform, JointEstimate, Mark, MarkPlacer, MarkSearch, Optics,
    ReferenceLines, RigidFit,
    joint::{JointSigma, Residual, TransformError},
    marks::{DrawnStrip, MarkError},
    sense::{PublishedSearch, SearchError, SearchSettings},
};
use alloc::vec::Vec;
use core::fmt;
use plotter_motion::{Axis, Point};

/// How the next frame lies, and how well that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joined {
    /// From the frame's own place on the table to where it must be drawn.
    pub transform: FrameTransform,
    /// How well the middle of the joint and the turn are known; the published procedure does not say.
    pub sigma: Option<JointSigma>,
    /// Of how many crossings the mark was found and believed.
    pub marks: u32,
    /// How far to the right of its place the right border was found, mm, if it was looked for.
    pub x_border2_mm: Option<f64>,
    /// The greatest distance of a mark that was believed from where the transform puts it, mm.
    pub residual_mm: Option<f64>,
}

/// A procedure at a frame change: which marks, how they are looked for, and what is made of them.
pub trait JoinFrames: Clone {
    /// The scans over the marks.
    fn crossings(&self) -> &[Crossing];

    /// Finds places for the marks at the end of a frame that is about to be drawn with these lines: from here
    /// on [`crossings`](Self::crossings) and [`strokes`](Self::strokes) are those.
    ///
    /// # Errors
    ///
    /// [`MarkError`]: a mark has no place, and the frame must not be drawn.
    fn place(&mut self, strip: &DrawnStrip) -> Result<(), MarkError>;

    /// The strokes that draw the marks, where they lie when they are looked for, in the machine's
    /// coordinates.
    fn strokes(&self) -> Vec<[Point; 2]>;

    /// Looks for them under the head, and tells how the next frame lies.
    ///
    /// # Errors
    ///
    /// [`JoinError`]: nothing must be drawn.
    fn join(&self, joint: &mut SensedJoint) -> Result<Joined, JoinError>;

    /// The same procedure on paper that somebody has looked at: it lies flat, and marks nearer to each other
    /// than they were drawn are on paper that has shrunk. The published procedure does not ask for that.
    #[must_use]
    fn on_flat_paper(&self) -> Self {
        self.clone()
    }
}

/// A mark reaches this far to both sides of its scan, mm: farther than the paper walks between two frames.
const MARK_REACH_MM: f64 = 8.0;

/// As published: four scans at 0.3 m/s, [`FrameTransform::from_readings`].
///
/// Each search ends at the first ink that it meets, and that to the right border comes through the field.
/// Where lines of the drawing are in its way, the scan is slid along the border, begun nearer to it, or the
/// border moved away from the field. The right border takes no part in the transform; where it contradicts
/// the left one by more than two tacts' ways nothing is told, which the source does not ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedJoin {
    /// Where the marks lie if no line is in the way.
    usual: [Crossing; 4],
    placed: [Crossing; 4],
    ahead_mm: [f64; 4],
    frame_mm: f64,
    optics: Optics,
}

impl PublishedJoin {
    /// With the published marks on that field, under that optical head.
    #[must_use]
    pub fn on(field: &Field, optics: Optics) -> Self {
        let mut usual = [Crossing { axis: Axis::X, mark_mm: 0.0, scan_at_mm: 0.0 }; 4];
        for (slot, crossing) in usual.iter_mut().zip(ReferenceLines::published_on(field).crossings()) {
            *slot = crossing;
        }
        Self {
            usual,
            placed: usual,
            ahead_mm: [PublishedSearch::AHEAD_MM; 4],
            frame_mm: field.frame_mm,
            optics,
        }
    }

    /// From where to where the frame before reaches along the paper, mm.
    const fn ends_mm(&self) -> [f64; 2] {
        let end_mm = self.usual[Mark::YLeft as usize].mark_mm;
        [end_mm - self.frame_mm, end_mm]
    }
}

impl Default for PublishedJoin {
    /// [`ReferenceLines::published`], under the published head.
    ///
    /// ```
    /// # use plotter_stitch::sheet::{JoinFrames, PublishedJoin};
    /// assert_eq!(PublishedJoin::default().crossings()[1].mark_mm, 1990.0);
    /// ```
    fn default() -> Self {
        Self::on(&Field::default(), Optics::default())
    }
}

impl JoinFrames for PublishedJoin {
    fn crossings(&self) -> &[Crossing] {
        &self.placed
    }

    fn place(&mut self, strip: &DrawnStrip) -> Result<(), MarkError> {
        /// More than the 5 mm by which the paper may lie beside its place across its way, and the 9 mm along
        /// it.
        const LEAST_AHEAD_MM: [f64; 2] = [8.0, 12.0];
        /// Two lines' ink, and what the head sees beside either.
        const BEHIND_MM: f64 = 2.0;
        /// From 50 mm before the frame's beginning up to where scans still keep off the next frame.
        const SLIDE_MM: [f64; 2] = [0.0, 35.0];
        /// From the field towards the Y markers, which begin 34 mm beside it: beyond the least way ahead,
        /// with the paper's walk.
        const MOVE_MM: f64 = 16.0;
        let (mut placed, mut ahead_mm) = (self.usual, self.ahead_mm);
        let border_mm = self.ends_mm().map(|y_mm| y_mm - self.usual[Mark::XBorder1 as usize].scan_at_mm);
        for mark in Mark::ALL {
            let index = mark as usize;
            let placer = MarkPlacer {
                ahead_mm: PublishedSearch::AHEAD_MM,
                least_ahead_mm: LEAST_AHEAD_MM[usize::from(!mark.is_border())],
                behind_mm: BEHIND_MM,
                reach_mm: if mark.is_border() { border_mm } else { [-MARK_REACH_MM, MARK_REACH_MM] },
                slide_mm: if mark.is_border() { SLIDE_MM } else { [0.0; 2] },
                move_mm: match mark {
                    Mark::XBorder1 => -MOVE_MM,
                    Mark::XBorder2 => MOVE_MM,
                    Mark::YLeft | Mark::YRight => 0.0,
                },
            };
            let mark = placer.place(self.usual[index], strip)?;
            (placed[index], ahead_mm[index]) = (mark.crossing, mark.ahead_mm);
        }
        (self.placed, self.ahead_mm) = (placed, ahead_mm);
        Ok(())
    }

    fn strokes(&self) -> Vec<[Point; 2]> {
        let ends_mm = self.ends_mm();
        let borders = [Mark::XBorder1, Mark::XBorder2].map(|mark| {
            let x_mm = self.placed[mark as usize].mark_mm;
            ends_mm.map(|y_mm| Point::new(x_mm, y_mm))
        });
        // At the frame's virtual beginning and end.
        let markers = [Mark::YLeft, Mark::YRight].into_iter().flat_map(|mark| {
            let x_mm = self.placed[mark as usize].scan_at_mm;
            ends_mm.map(|y_mm| [-MARK_REACH_MM, MARK_REACH_MM].map(|by_mm| Point::new(x_mm + by_mm, y_mm)))
        });
        borders.into_iter().chain(markers).collect()
    }

    fn join(&self, joint: &mut SensedJoint) -> Result<Joined, JoinError> {
        let mut search = PublishedSearch::new(self.placed, self.optics).beginning(self.ahead_mm);
        joint.run(&mut search).map_err(JoinError::Search)?;
        let readings = search.readings().map_err(JoinError::Search)?;
        let transform = FrameTransform::from_readings(&readings).map_err(JoinError::Transform)?;
        /// Both borders may be read by a tact's way beside their places; more no line that is one can be.
        const MOST_MM: f64 = 1.2;
        let residual_mm = Residual::between(&transform, &readings).max_mm();
        if residual_mm > MOST_MM {
            return Err(JoinError::Residual { residual_mm, most_mm: MOST_MM });
        }
        let residual_mm = Some(residual_mm);
        let x_border2_mm = Some(readings.x_border2.shift_mm());
        Ok(Joined { transform, sigma: None, marks: 4, x_border2_mm, residual_mm })
    }
}

/// Ours: many crossings in the strip that is still in reach, each passed slowly both ways, and a robust fit.
#[derive(Clone, Debug, PartialEq)]
pub struct StripJoin {
    lines: ReferenceLines,
    crossings: Vec<Crossing>,
    joint: [Point; 2],
    settings: SearchSettings,
    fit: RigidFit,
}

impl StripJoin {
    /// With these marks.
    ///
    /// ```
    /// # use plotter_stitch::{ReferenceLines, StripJoin, sense::SearchSettings, sheet::JoinFrames};
    /// let join = StripJoin::new(&ReferenceLines::strip16(), SearchSettings::default());
    /// assert_eq!(join.crossings().len(), 16);
    /// ```
    #[must_use]
    pub fn new(lines: &ReferenceLines, settings: SearchSettings) -> Self {
        Self {
            lines: lines.clone(),
            crossings: lines.crossings().collect(),
            joint: lines.joint,
            settings,
            fit: RigidFit::on(lines),
        }
    }
}

impl JoinFrames for StripJoin {
    fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    /// Marks of ours lie beside the field: they stay where they are, or are refused.
    fn place(&mut self, strip: &DrawnStrip) -> Result<(), MarkError> {
        let window_mm = self.settings.window_mm;
        self.crossings.iter().try_for_each(|crossing| {
            let placer = MarkPlacer {
                ahead_mm: window_mm,
                least_ahead_mm: window_mm,
                // The window ends at a place of the table too.
                reach_mm: [-MARK_REACH_MM, MARK_REACH_MM],
                behind_mm: window_mm + ASTRAY_MM[usize::from(crossing.axis == Axis::Y)],
                slide_mm: [0.0; 2],
                move_mm: 0.0,
            };
            placer.place(*crossing, strip).map(|_| ())
        })
    }

    fn strokes(&self) -> Vec<[Point; 2]> {
        self.lines.strokes(MARK_REACH_MM).collect()
    }

    fn join(&self, joint: &mut SensedJoint) -> Result<Joined, JoinError> {
        let mut search = MarkSearch::new(&self.crossings, self.settings);
        joint.run(&mut search).map_err(JoinError::Search)?;
        let found = search.found().map_err(JoinError::Search)?;
        let estimate = self.fit.estimate(&self.crossings, found).map_err(JoinError::Fit)?;
        let residual_mm = found
            .iter()
            .enumerate()
            .filter(|(index, _)| estimate.inliers >> index & 1 == 1)
            .filter_map(|(_, place)| {
                Some(libm::fabs(
                    place.at_mm - self.crossings.get(place.crossing)?.place_mm(&estimate.transform),
                ))
            })
            .fold(0.0, f64::max);
        let transform = at_joint(&estimate, self.joint).map_err(JoinError::Transform)?;
        let middle = self.joint[0].lerp(self.joint[1], 0.5);
        let sigma =
            JointSigma { lateral_mm: estimate.sigma_at_mm(middle).x, angle_rad: estimate.sigma_angle_rad() };
        Ok(Joined {
            transform,
            sigma: Some(sigma),
            marks: estimate.inlier_count(),
            x_border2_mm: None,
            residual_mm: Some(residual_mm),
        })
    }

    fn on_flat_paper(&self) -> Self {
        Self { fit: RigidFit { is_flat: true, ..self.fit }, ..self.clone() }
    }
}

/// The turn and shift that carry both ends of the joint nearest to where they lie on paper that has swollen:
/// those that fit the marks best lie towards the side whose marks are known better.
fn at_joint(estimate: &JointEstimate, joint: [Point; 2]) -> Result<FrameTransform, TransformError> {
    let [from, to] = joint.map(|end| estimate.to_machine(end));
    let (way, drawn) = (to - from, joint[1] - joint[0]);
    let angle_rad = libm::atan2(drawn.cross(way), drawn.dot(way));
    let middle = joint[0].lerp(joint[1], 0.5) - Point::ORIGIN;
    FrameTransform::new(angle_rad, from.lerp(to, 0.5) - Point::ORIGIN - middle.rotated(angle_rad))
}

/// Why two frames were not joined.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum JoinError {
    /// The marks were not found.
    Search(SearchError),
    /// The published transform cannot be told.
    Transform(TransformError),
    /// The marks that were found do not agree.
    Fit(FitError),
    /// Marks for the next frame change have no place.
    Marks(MarkError),
    /// The paper has folded, or its probe was not seen, and nobody has fitted it.
    Stopped,
    /// The frame change was broken off: it is not known how the paper lies.
    Unjoined,
    /// No paper has been moved yet.
    NoJoint,
    /// The published readings contradict each other.
    Residual {
        /// How far the right border lies from where the transform puts it, mm.
        residual_mm: f64,
        /// The farthest that is taken, mm.
        most_mm: f64,
    },
}

impl fmt::Display for JoinError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Search(error) => error.fmt(f),
            Self::Transform(error) => error.fmt(f),
            Self::Fit(error) => error.fmt(f),
            Self::Marks(error) => error.fmt(f),
            Self::Stopped => f.write_str(
                "the run has stopped: the paper has folded, or the probe for folds was not seen; fit the paper by hand, then \
                 measure anew",
            ),
            Self::Unjoined => f.write_str(
                "the frame change was broken off, and it is not known how the paper lies; measure anew",
            ),
            Self::Residual { residual_mm, most_mm } => write!(
                f,
                "the right border lies {residual_mm:.2} mm beside where the left one puts it, {most_mm} mm are taken; look for a stain \
                 or a fold at the borders"
            ),
            Self::NoJoint => f.write_str("there is no joint yet to measure anew; move the paper on"),
        }
    }
}

impl core::error::Error for JoinError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Search(error) => Some(error),
            Self::Transform(error) => Some(error),
            Self::Fit(error) => Some(error),
            Self::Marks(error) => Some(error),
            _ => None,
        }
    }
}
