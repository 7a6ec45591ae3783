//! [`JoinFrames`]: the procedure at a frame change, as published and ours.

use super::SensedJoint;
use crate::{
    Crossing, FitError, FrameTransform, JointSigma, MarkSearch, Optics, PublishedSearch, ReferenceLines,
    Residual, RigidFit, SearchError, SearchSettings, TransformError,
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
    /// Where the frame's second border was found, mm, if it was looked for.
    pub x_border2_mm: Option<f64>,
    /// The greatest distance of a mark from where the transform puts it, mm, where there is a choice.
    pub residual_mm: Option<f64>,
}

/// A procedure at a frame change: which marks, how they are looked for, and what is made of them.
pub trait JoinFrames {
    /// The scans over the marks.
    fn crossings(&self) -> &[Crossing];

    /// Looks for them under the head, and tells how the next frame lies.
    ///
    /// # Errors
    ///
    /// [`JoinError`]: nothing must be drawn.
    fn join(&self, joint: &mut SensedJoint) -> Result<Joined, JoinError>;
}

/// As published: four scans at 0.3 m/s, [`FrameTransform::from_readings`].
#[derive(Clone, Debug, PartialEq)]
pub struct PublishedJoin {
    crossings: [Crossing; 4],
    optics: Optics,
}

impl PublishedJoin {
    /// With these four marks, in the order of [`Mark::ALL`](crate::Mark::ALL), and that optical head.
    #[must_use]
    pub const fn new(crossings: [Crossing; 4], optics: Optics) -> Self {
        Self { crossings, optics }
    }
}

impl Default for PublishedJoin {
    /// [`ReferenceLines::published`], under the published head.
    ///
    /// ```
    /// # use plotter_stitch::{JoinFrames, PublishedJoin};
    /// assert_eq!(PublishedJoin::default().crossings()[1].mark_mm, 1820.0);
    /// ```
    fn default() -> Self {
        let nowhere = Crossing { axis: Axis::X, mark_mm: 0.0, scan_at_mm: 0.0 };
        let mut crossings = [nowhere; 4];
        for (slot, crossing) in crossings.iter_mut().zip(ReferenceLines::published().crossings()) {
            *slot = crossing;
        }
        Self::new(crossings, Optics::default())
    }
}

impl JoinFrames for PublishedJoin {
    fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    fn join(&self, joint: &mut SensedJoint) -> Result<Joined, JoinError> {
        let mut search = PublishedSearch::new(self.crossings, self.optics);
        joint.run(&mut search).map_err(JoinError::Search)?;
        let readings = search.readings().map_err(JoinError::Search)?;
        let transform = FrameTransform::from_readings(&readings).map_err(JoinError::Transform)?;
        let residual_mm = Some(Residual::of(&transform, &readings).max_mm());
        let x_border2_mm = Some(readings.x_border2.found_mm);
        Ok(Joined { transform, sigma: None, marks: 4, x_border2_mm, residual_mm })
    }
}

/// Ours: many crossings in the strip that is still in reach, each passed slowly both ways, and a robust fit.
#[derive(Clone, Debug, PartialEq)]
pub struct StripJoin {
    crossings: Vec<Crossing>,
    joint: [Point; 2],
    settings: SearchSettings,
    fit: RigidFit,
}

impl StripJoin {
    /// With these marks.
    ///
    /// ```
    /// # use plotter_stitch::{JoinFrames, ReferenceLines, SearchSettings, StripJoin};
    /// let join = StripJoin::new(&ReferenceLines::strip16(), SearchSettings::default());
    /// assert_eq!(join.crossings().len(), 16);
    /// ```
    #[must_use]
    pub fn new(lines: &ReferenceLines, settings: SearchSettings) -> Self {
        let fit = RigidFit { joint: lines.joint, ..RigidFit::default() };
        Self { crossings: lines.crossings().collect(), joint: lines.joint, settings, fit }
    }
}

impl JoinFrames for StripJoin {
    fn crossings(&self) -> &[Crossing] {
        &self.crossings
    }

    fn join(&self, joint: &mut SensedJoint) -> Result<Joined, JoinError> {
        let mut search = MarkSearch::new(&self.crossings, self.settings);
        joint.run(&mut search).map_err(JoinError::Search)?;
        let found = search.found().map_err(JoinError::Search)?;
        let estimate = self.fit.estimate(&self.crossings, found).map_err(JoinError::Fit)?;
        let middle = self.joint[0].lerp(self.joint[1], 0.5);
        let sigma =
            JointSigma { lateral_mm: estimate.sigma_at_mm(middle).y, angle_rad: estimate.sigma_angle_rad() };
        Ok(Joined {
            transform: estimate.transform,
            sigma: Some(sigma),
            marks: estimate.inlier_count(),
            x_border2_mm: None,
            residual_mm: None,
        })
    }
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
}

impl fmt::Display for JoinError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Search(error) => error.fmt(f),
            Self::Transform(error) => error.fmt(f),
            Self::Fit(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for JoinError {}
