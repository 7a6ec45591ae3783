//! [`FoldProbe`]: the two strokes, and the scans over them.

use super::FoldDirection;
use plotter_motion::{PlotOp, Point, Vec2};

/// How far the strokes reach to both sides of their middle, mm: within the square in any direction, with the
/// pen's width.
const HALF_STROKE_MM: f64 = 9.0;
/// Half of the length over which scans are spread, mm: two thirds of the half stroke, so that all scans meet
/// the line well inside its ends.
const HALF_SPREAD_MM: f64 = 6.0;
/// A scan reaches this far to both sides of the line, mm: over folds of a millimetre, and within the square.
const HALF_SCAN_MM: f64 = 3.0;

/// A line in an empty square, along the ridge that a fold would have, and scans across it.
///
/// ```
/// use plotter_motion::{PlotOp, Point};
/// use plotter_stitch::{FoldProbe, fold::FoldDirection};
///
/// let probe = FoldProbe::new(Point::new(500.0, 500.0), FoldDirection::Rising, 1000.0, 1000.0);
/// let [first, second] = probe.strokes();
/// // 9 mm to both sides along the diagonal, and back from the other end.
/// assert_eq!(first[1].target(), second[0].target());
/// let end = second[1].target().unwrap();
/// assert!(end.distance(Point::new(500.0 - 6.364, 500.0 - 6.364)) < 1e-3); // 9 / √2 = 6.364
/// assert_eq!(probe.scans().count(), 9);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FoldProbe {
    middle: Point,
    along: Vec2,
}

/// One scan across the line, in the frame's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProbeScan {
    /// Where it begins, mm.
    pub from: Point,
    /// Where it ends, mm.
    pub to: Point,
}

impl FoldProbe {
    /// How many scans there are.
    pub const SCANS: u8 = 9;

    /// In the empty square about `middle`, of a frame of that size.
    #[must_use]
    pub fn new(middle: Point, direction: FoldDirection, width_mm: f64, length_mm: f64) -> Self {
        Self { middle, along: direction.along(width_mm, length_mm) }
    }

    /// The line from one end, and the same line from the other, in the frame's coordinates. The pen is lifted
    /// between them, so that the paper may spring back.
    #[must_use]
    pub fn strokes(&self) -> [[PlotOp; 2]; 2] {
        let [from, to] = [-HALF_STROKE_MM, HALF_STROKE_MM].map(|way_mm| self.middle + self.along * way_mm);
        let line = |from, to| [PlotOp::Travel { to: from }, PlotOp::Draw { to, feed_mm_s: None }];
        [line(from, to), line(to, from)]
    }

    /// The scans across it, one beside the other.
    pub fn scans(&self) -> impl Iterator<Item = ProbeScan> + use<> {
        let Self { middle, along } = *self;
        let across = along.perpendicular() * HALF_SCAN_MM;
        let last = f64::from(Self::SCANS - 1);
        (0..Self::SCANS).map(move |number| {
            let way_mm = HALF_SPREAD_MM * (2.0 * f64::from(number) / last - 1.0);
            let at = middle + along * way_mm;
            ProbeScan { from: at - across, to: at + across }
        })
    }
}
