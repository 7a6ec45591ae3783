//! From where the reference lines are found to where the sketch must be drawn.

use crate::{FrameReadings, Mark};
use core::fmt;
use plotter_motion::{PlotOp, Point, Vec2};

/// Shortest distance between the two scans of the Y markers that tells a rotation, mm: a reading wrong by
/// 0.02 mm turns a baseline of this length by 0.002 rad, as much as the paper itself ever turns.
const SHORTEST_BASELINE_MM: f64 = 10.0;

/// Greatest rotation that is believed, rad: five times the greatest that the source met. Beyond it a mark was
/// mistaken for another.
const GREATEST_ANGLE_RAD: f64 = 0.01;

/// No sheet reaches farther, mm: a thousand kilometres. Up to here nothing below overflows.
const FARTHEST_MM: f64 = 1e9;

/// How a frame lies under the machine: turned by a small angle and shifted.
///
/// ```text
/// machine = R(angle) · sketch + shift
/// ```
///
/// with the angle counter-clockwise. [`from_readings`](Self::from_readings) finds it as published; the
/// numbers of this example can be followed by hand:
///
/// ```
/// use plotter_motion::Point;
/// use plotter_stitch::{FrameReadings, FrameTransform, Reading};
///
/// // The sheet moved by 2 mm along x, and its Y markers by 1 mm on the left and 3 mm on the right.
/// let readings = FrameReadings {
///     x_border1: Reading { expected_mm: 50.0, found_mm: 52.0, scan_at_mm: 0.0 },
///     x_border2: Reading { expected_mm: 950.0, found_mm: 952.0, scan_at_mm: 0.0 },
///     y_left: Reading { expected_mm: 40.0, found_mm: 41.0, scan_at_mm: 0.0 },
///     y_right: Reading { expected_mm: 40.0, found_mm: 43.0, scan_at_mm: 1000.0 },
/// };
/// let transform = FrameTransform::from_readings(&readings)?;
/// assert!((transform.angle_rad() - 0.002).abs() < 1e-8); // 2 mm in 1000 mm
///
/// let corner = transform.to_machine(Point::new(0.0, 0.0));
/// assert_eq!(corner, Point::new(2.0, 1.0));
/// let right = transform.to_machine(Point::new(1000.0, 0.0));
/// assert!(right.distance(Point::new(1001.998, 3.0)) < 1e-5); // 1000 cos 0.002 = 999.998
/// # Ok::<(), plotter_stitch::joint::TransformError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameTransform {
    angle_rad: f64,
    cos: f64,
    sin: f64,
    shift: Vec2,
}

impl FrameTransform {
    /// The sheet lies as the machine does.
    pub const IDENTITY: Self = Self { angle_rad: 0.0, cos: 1.0, sin: 0.0, shift: Vec2::new(0.0, 0.0) };

    /// Turned counter-clockwise about the origin by `angle_rad`, then shifted, mm.
    ///
    /// # Errors
    ///
    /// [`TransformError::NotFinite`] without a mark if one of the numbers is not finite.
    pub fn new(angle_rad: f64, shift: Vec2) -> Result<Self, TransformError> {
        if let Some(value) = [angle_rad, shift.x, shift.y].into_iter().find(|value| !value.is_finite()) {
            return Err(TransformError::NotFinite { mark: None, value });
        }
        Ok(Self { angle_rad, cos: libm::cos(angle_rad), sin: libm::sin(angle_rad), shift })
    }

    /// The transform as published: the shift along x from the first border, the shift along y from the left Y
    /// marker, the rotation from both Y markers.
    ///
    /// ```text
    /// tan angle = ((Y_right found - expected) - (Y_left found - expected)) / (x of the right scan - x of the left)
    /// shift x   =  X_border1 found - expected
    /// shift y   =  Y_left found - expected
    /// ```
    ///
    /// The sheet is taken to be turned about the place through which the first scans of both directions pass,
    /// (x of the left scan, y of the border's scan): the head's start, (0, 0), in the published procedure.
    /// About any other place a rotation would show in both shifts: by 0.1 mm for the frame's own corner,
    /// 50 mm away.
    ///
    /// What remains is the method's own error: a line that is both shifted by `s` across the scan and turned
    /// by α is met a distance `s` tan α farther on, and a line at distance `a` by `a` (1/cos α - 1). With the
    /// greatest shift of 5 mm and 0.002 rad that is 0.0101 mm in each direction and 0.0143 mm together,
    /// everywhere on the frame: below the required 0.05 mm, and proved by a property test. The second border
    /// takes no part; see [`Residual`](crate::joint::Residual).
    ///
    /// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV.
    /// The source computes in 10-byte floats; in `f64` there and back over 30 m ends within 1e-9 mm (a test).
    ///
    /// # Errors
    ///
    /// [`TransformError`] if a reading is not finite or no place on a sheet, if the Y markers were scanned
    /// too near to each other, and if the rotation is greater than any sheet's.
    pub fn from_readings(readings: &FrameReadings) -> Result<Self, TransformError> {
        for mark in Mark::ALL {
            let reading = readings.reading(mark);
            let values = [reading.expected_mm, reading.found_mm, reading.scan_at_mm];
            // A NaN lies in no range.
            let is_a_place = |mm: f64| (-FARTHEST_MM..=FARTHEST_MM).contains(&mm);
            if let Some(value) = values.into_iter().find(|value| !is_a_place(*value)) {
                return Err(TransformError::NotFinite { mark: Some(mark), value });
            }
        }
        let FrameReadings { x_border1, y_left, y_right, .. } = readings;
        let baseline_mm = y_right.scan_at_mm - y_left.scan_at_mm;
        if libm::fabs(baseline_mm) < SHORTEST_BASELINE_MM {
            return Err(TransformError::Baseline { baseline_mm, least_mm: SHORTEST_BASELINE_MM });
        }
        let angle_rad = libm::atan((y_right.shift_mm() - y_left.shift_mm()) / baseline_mm);
        if libm::fabs(angle_rad) > GREATEST_ANGLE_RAD {
            return Err(TransformError::Angle { angle_rad, most_rad: GREATEST_ANGLE_RAD });
        }
        let centre = Vec2::new(y_left.scan_at_mm, x_border1.scan_at_mm);
        let at_centre = Vec2::new(x_border1.shift_mm(), y_left.shift_mm());
        Self::new(angle_rad, centre + at_centre - centre.rotated(angle_rad))
    }

    /// Rotation of the sheet, counter-clockwise, rad.
    #[must_use]
    pub const fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Where the sketch's origin lies, mm.
    #[must_use]
    pub const fn shift(&self) -> Vec2 {
        self.shift
    }

    /// Where the machine must go for a place of the sketch.
    #[must_use]
    pub fn to_machine(&self, sketch: Point) -> Point {
        Point::new(
            self.cos * sketch.x - self.sin * sketch.y + self.shift.x,
            self.sin * sketch.x + self.cos * sketch.y + self.shift.y,
        )
    }

    /// Which place of the sketch lies under a place of the machine: undoes [`to_machine`](Self::to_machine).
    #[must_use]
    pub fn to_sketch(&self, machine: Point) -> Point {
        let (x, y) = (machine.x - self.shift.x, machine.y - self.shift.y);
        Point::new(self.cos * x + self.sin * y, self.cos * y - self.sin * x)
    }

    /// The transform that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let origin = self.to_sketch(Point::ORIGIN) - Point::ORIGIN;
        Self { angle_rad: -self.angle_rad, cos: self.cos, sin: -self.sin, shift: origin }
    }

    /// First `first`, then this one, as one transform.
    ///
    /// ```
    /// # use plotter_motion::{Point, Vec2};
    /// # use plotter_stitch::FrameTransform;
    /// let turned = FrameTransform::new(std::f64::consts::FRAC_PI_2, Vec2::default())?;
    /// let shifted = FrameTransform::new(0.0, Vec2::new(2.0, 0.0))?;
    /// let both = turned.after(&shifted); // (1, 0) goes to (3, 0), and up
    /// assert!(both.to_machine(Point::new(1.0, 0.0)).distance(Point::new(0.0, 3.0)) < 1e-15);
    /// # Ok::<(), plotter_stitch::joint::TransformError>(())
    /// ```
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let angle_rad = self.angle_rad + first.angle_rad;
        let shift = self.to_machine(Point::ORIGIN + first.shift) - Point::ORIGIN;
        Self { angle_rad, cos: libm::cos(angle_rad), sin: libm::sin(angle_rad), shift }
    }

    /// An operation of the sketch as the machine must do it: its places are transformed, all else stays.
    ///
    /// ```
    /// # use plotter_motion::{PlotOp, Point, Vec2};
    /// # use plotter_stitch::FrameTransform;
    /// let shifted = FrameTransform::new(0.0, Vec2::new(2.0, 1.0))?;
    /// let line = PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: Some(30.0) };
    /// assert_eq!(
    ///     shifted.op_to_machine(line),
    ///     PlotOp::Draw { to: Point::new(12.0, 1.0), feed_mm_s: Some(30.0) }
    /// );
    /// assert_eq!(shifted.op_to_machine(PlotOp::NewPage), PlotOp::NewPage);
    /// # Ok::<(), plotter_stitch::joint::TransformError>(())
    /// ```
    #[must_use]
    pub fn op_to_machine(&self, op: PlotOp) -> PlotOp {
        match op {
            PlotOp::Travel { to } => PlotOp::Travel { to: self.to_machine(to) },
            PlotOp::Draw { to, feed_mm_s } => PlotOp::Draw { to: self.to_machine(to), feed_mm_s },
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => PlotOp::DrawArc {
                centre: self.to_machine(centre),
                sweep_rad,
                to: self.to_machine(to),
                feed_mm_s,
            },
            other => other,
        }
    }
}

/// Why no transform can be told from a frame's readings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TransformError {
    /// A number is not finite, or too great to compute with.
    NotFinite {
        /// The reference line it was read from, if any.
        mark: Option<Mark>,
        /// The number.
        value: f64,
    },
    /// The Y markers were scanned too near to each other to tell a rotation.
    Baseline {
        /// From the left scan to the right one, mm.
        baseline_mm: f64,
        /// The least there must be, mm.
        least_mm: f64,
    },
    /// The rotation is greater than any sheet's: a mark was mistaken for another.
    Angle {
        /// The rotation, rad.
        angle_rad: f64,
        /// The greatest that is believed, rad.
        most_rad: f64,
    },
}

impl fmt::Display for TransformError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { mark: Some(mark), value } => {
                write!(f, "{mark}: {value} mm is no place on a sheet; search the line again")
            }
            Self::NotFinite { mark: None, value } => write!(f, "{value} is no finite shift or angle"),
            Self::Baseline { baseline_mm, least_mm } => write!(
                f,
                "the y markers were scanned {baseline_mm} mm apart, at least {least_mm} mm tell a rotation; scan \
                 the right one farther to the right"
            ),
            Self::Angle { angle_rad, most_rad } => write!(
                f,
                "the sheet would be turned by {angle_rad:.6} rad, at most {most_rad} rad are believed; look for a \
                 mark mistaken for another"
            ),
        }
    }
}

impl core::error::Error for TransformError {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Reading;
    use std::string::ToString;

    fn readings(left_found_mm: f64, right_found_mm: f64, right_scan_mm: f64) -> FrameReadings {
        let still = Reading { expected_mm: 50.0, found_mm: 50.0, scan_at_mm: 0.0 };
        FrameReadings {
            x_border1: still,
            x_border2: still,
            y_left: Reading { found_mm: left_found_mm, ..still },
            y_right: Reading { found_mm: right_found_mm, scan_at_mm: right_scan_mm, ..still },
        }
    }

    #[test]
    fn a_sheet_that_did_not_move_needs_no_correction() {
        let transform = FrameTransform::from_readings(&readings(50.0, 50.0, 2_000.0));
        assert_eq!(transform, Ok(FrameTransform::IDENTITY));
    }

    #[test]
    fn the_scans_may_lie_away_from_the_origin() {
        // Turned by 1 mm in 1000 mm about (100, -50), where both scans pass: that place stays.
        let mut turned = readings(50.0, 51.0, 1_100.0);
        turned.y_left.scan_at_mm = 100.0;
        turned.x_border1.scan_at_mm = -50.0;
        let transform = FrameTransform::from_readings(&turned).unwrap();
        /// The place is 112 mm away from the origin: rounding is some 1e-14 mm.
        const ROUNDING_MM: f64 = 1e-12;
        let centre = Point::new(100.0, -50.0);
        assert!(transform.to_machine(centre).distance(centre) < ROUNDING_MM);
    }

    #[test]
    fn what_no_sheet_can_do_is_refused_with_a_remedy() {
        let refused = |readings| FrameTransform::from_readings(&readings).unwrap_err().to_string();
        assert_eq!(
            refused(readings(50.0, 50.0, 5.0)),
            "the y markers were scanned 5 mm apart, at least 10 mm tell a rotation; scan the right one farther to \
             the right"
        );
        assert_eq!(
            refused(readings(50.0, 70.0, 1_000.0)),
            "the sheet would be turned by 0.019997 rad, at most 0.01 rad are believed; look for a mark mistaken \
             for another"
        );
        assert_eq!(
            refused(readings(f64::NAN, 50.0, 1_000.0)),
            "left y marker: NaN mm is no place on a sheet; search the line again"
        );
    }

    #[test]
    fn a_transform_is_made_of_finite_numbers_only() {
        assert!(FrameTransform::new(f64::INFINITY, Vec2::default()).is_err());
        assert!(FrameTransform::new(0.0, Vec2::new(0.0, f64::NAN)).is_err());
    }
}
