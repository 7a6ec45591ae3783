//! [`proportion`]: how wide a sheet is for its height, from the perspective in which it is seen.

use crate::picture::{PxPoint, PxVec};

/// Focal lengths that a camera may have, as parts of its picture's longer side: 18 to 144 mm on film of 36 mm.
const FOCAL: core::ops::RangeInclusive<f64> = 0.5..=4.0;

/// The focal length where the perspective does not tell it: a telephone's main lens, 26 mm on film of 36 mm.
const USUAL_FOCAL: f64 = 0.72;

/// Below this the sides are so nearly parallel that half a pixel at a corner turns the focal length into any
/// other: change of the scale over the sheet.
const TOLD_BY: f64 = 0.04;

/// Width for height of a rectangle whose corners, clockwise from the upper left, are seen in a picture of this
/// size, taken whole by a camera with square pixels.
///
/// Source: Z. Zhang, L. He, "Whiteboard scanning and image enhancement", *Digital Signal Processing* 17
/// (2007), section 4, equations 11 to 21: the principal point in the picture's middle, the focal length from
/// the two directions of the sides, which are at right angles on the sheet. Where a pair of sides is all but
/// parallel the focal length cannot be told: theirs is the mean of opposite sides then, here it is the usual
/// one, which comes to the same where both pairs are.
pub(super) fn proportion(corners: [PxPoint; 4], (width_px, height_px): (f64, f64)) -> Option<f64> {
    let longer = width_px.max(height_px);
    let middle = PxPoint::new(width_px / 2.0, height_px / 2.0);
    // In parts of the longer side about the principal point; m1 to m4 as they are named there.
    let [one, two, four, three] = corners.map(|at| (at - middle) / longer);
    let k2 = triple(one, four, three) / triple(two, four, three);
    let k3 = triple(one, four, two) / triple(three, four, two);
    // n2 and n3, each with its third component.
    let (across, across_w) = (two * k2 - one, k2 - 1.0);
    let (down, down_w) = (three * k3 - one, k3 - 1.0);
    let told = libm::fabs(across_w) > TOLD_BY && libm::fabs(down_w) > TOLD_BY;
    let squared = -across.dot(down) / (across_w * down_w);
    let focal = if told && squared > 0.0 {
        libm::sqrt(squared).clamp(*FOCAL.start(), *FOCAL.end())
    } else {
        USUAL_FOCAL
    };
    let length = |way: PxVec, w: f64| libm::hypot(way.length() / focal, w);
    let proportion = length(across, across_w) / length(down, down_w);
    (proportion > 0.0 && proportion.is_finite()).then_some(proportion)
}

/// (a × b) · c of places with the third component 1.
fn triple(a: PxVec, b: PxVec, c: PxVec) -> f64 {
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a sheet of 210 x 297 mm seen by a camera 500 mm away, whose focal length is that part of
    /// its picture's longer side, tilted by these angles about the picture's axes.
    fn seen(focal: f64, tilt_rad: f64, turn_rad: f64, roll_rad: f64) -> [PxPoint; 4] {
        let rectangle = [(-105.0, -148.5), (105.0, -148.5), (105.0, 148.5), (-105.0, 148.5)];
        rectangle.map(|(x, y)| {
            let flat = PxVec::new(x, y).rotated(roll_rad);
            let (sin, cos) = libm::sincos(tilt_rad);
            let (x, y, z) = (flat.x, flat.y * cos, flat.y * sin);
            let (sin, cos) = libm::sincos(turn_rad);
            let (x, z) = (x * cos - z * sin, x * sin + z * cos + 500.0);
            PxPoint::new(1500.0 + 4000.0 * focal * x / z, 2000.0 + 4000.0 * focal * y / z)
        })
    }

    #[test]
    fn a_camera_does_not_change_the_proportion() {
        /// Rounding: the cameras here are without any error.
        const ROUNDING: f64 = 1e-6;
        for focal in [0.6, 0.72, 1.2] {
            for (tilt, turn) in [(0.4, 0.3), (-0.5, 0.35), (0.3, -0.3)] {
                let found = proportion(seen(focal, tilt, turn, 0.2), (3000.0, 4000.0)).unwrap();
                assert!((found - 210.0 / 297.0).abs() < ROUNDING, "{focal} {tilt} {turn}: {found}");
            }
        }
        // From straight above the focal length is of no matter; tilted about one axis the usual one is taken.
        assert!(
            (proportion(seen(1.5, 0.0, 0.0, 0.0), (3000.0, 4000.0)).unwrap() - 210.0 / 297.0).abs()
                < ROUNDING
        );
        let usual = proportion(seen(USUAL_FOCAL, 0.5, 0.0, 0.0), (3000.0, 4000.0)).unwrap();
        assert!((usual - 210.0 / 297.0).abs() < ROUNDING, "{usual}");
    }
}
