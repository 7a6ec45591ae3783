//! How well a transform explains what was read.

use crate::{FrameReadings, FrameTransform, Mark};

/// Distance from where a transform puts each reference line to where it was found, along the scan, mm.
///
/// Two lines and two markers tell four numbers, and a transform has three: what is left over is the stretch
/// of the paper, a misread line, or the error of the method.
///
/// ```
/// use plotter_stitch::{FrameReadings, FrameTransform, Reading, joint::Residual};
///
/// let at = |expected_mm, found_mm, scan_at_mm| Reading { expected_mm, found_mm, scan_at_mm };
/// let readings = FrameReadings {
///     x_border1: at(50.0, 52.0, 0.0),
///     x_border2: at(950.0, 952.5, 0.0), // the paper stretched by half a millimetre
///     y_left: at(40.0, 41.0, 0.0),
///     y_right: at(40.0, 41.0, 1000.0),
/// };
/// let transform = FrameTransform::from_readings(&readings)?;
/// let residual = Residual::between(&transform, &readings);
/// assert_eq!(residual.x_border2_mm, 0.5);
/// assert_eq!(residual.max_mm(), 0.5);
/// assert_eq!(residual.rms_mm(), 0.25); // the root of 0.5² / 4
/// # Ok::<(), plotter_stitch::joint::TransformError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Residual {
    /// Of the left border.
    pub x_border1_mm: f64,
    /// Of the right border.
    pub x_border2_mm: f64,
    /// Of the left Y marker.
    pub y_left_mm: f64,
    /// Of the right Y marker.
    pub y_right_mm: f64,
}

impl Residual {
    /// Found minus transformed, for each line.
    ///
    /// A frame turned by α and shifted by (sx, sy) is met by a scan along x at y = v on its line x = a, and
    /// by one along y at x = u on its line y = b, at
    ///
    /// ```text
    /// x = a / cos α - (v - sy) tan α + sx
    /// y = b / cos α + (u - sx) tan α + sy
    /// ```
    ///
    /// (put the points (a, t) and (t, b) of the lines into the transform and remove t).
    #[must_use]
    pub fn between(transform: &FrameTransform, readings: &FrameReadings) -> Self {
        let (cos, tan) = (libm::cos(transform.angle_rad()), libm::tan(transform.angle_rad()));
        let shift = transform.shift();
        let of_mark = |mark: Mark| {
            let reading = readings.reading(mark);
            let transformed = if mark.is_border() {
                reading.expected_mm / cos - (reading.scan_at_mm - shift.y) * tan + shift.x
            } else {
                reading.expected_mm / cos + (reading.scan_at_mm - shift.x) * tan + shift.y
            };
            reading.found_mm - transformed
        };
        Self {
            x_border1_mm: of_mark(Mark::XBorder1),
            x_border2_mm: of_mark(Mark::XBorder2),
            y_left_mm: of_mark(Mark::YLeft),
            y_right_mm: of_mark(Mark::YRight),
        }
    }

    /// Root of the mean square of all four, mm.
    #[must_use]
    pub fn rms_mm(&self) -> f64 {
        let squares: f64 = self.all().into_iter().map(|mm| mm * mm).sum();
        libm::sqrt(squares / 4.0)
    }

    /// The greatest of all four without its sign, mm.
    #[must_use]
    pub fn max_mm(&self) -> f64 {
        self.all().into_iter().map(libm::fabs).fold(0.0, f64::max)
    }

    const fn all(&self) -> [f64; 4] {
        [self.x_border1_mm, self.x_border2_mm, self.y_left_mm, self.y_right_mm]
    }
}
