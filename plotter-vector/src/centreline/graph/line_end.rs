//! Where a line ends that leads nowhere else.
//!
//! A pen's line has a round end, so its middle ends half the line's width before the ink does. An end of another shape is
//! taken for a pen's all the same: of a square one the pen leaves the corners bare.
//!
//! ```text
//!   ─────────╲          thinning follows the ink into a corner of it; the middle of the undisturbed part goes
//!   ·  ·  ·  ·╳  E      straight on to E instead
//!   ──────────╱
//! ```
//!
//! What the rim of the picture cuts goes on beyond it: such a line ends on the rim, whatever the angle.

use super::arm::{Arm, typical_width_px};
use super::site::{Scan, Site, surely_px};
use crate::{PxVec, picture::Pixel, stroke::PxPoint};

/// What the raster takes of a pen's disc at a tip, which it cuts on both sides, px.
const TIP_RASTER_PX: f64 = 0.75;

/// Longest way into a corner of a line's end, in radii of the line: 1 / sin 22.5°, where the pen was cut off at 45 degrees.
/// What tapers longer is a point.
const MOST_RADII: f64 = 2.7;

/// The same where the picture's rim cuts it, at 10 degrees: 1 / sin 5°.
pub(super) const MOST_CUT_RADII: f64 = 11.5;

/// Farthest from the picture's rim that the tip of a skeleton lies which leads to it, px.
pub(super) const AT_RIM_PX: f64 = 2.5;

/// Least width of the ink along the rim, of the line's, where that cuts it: else it is the line's end.
const LEAST_CUT: f64 = 0.6;

/// The other part of the direction of a line along an axis: a rounding.
pub(super) const LEVEL: f64 = 1e-9;

/// Sites from a line's end on, whose pixels are given too, that lead into a corner of its ink or are disturbed by one: the
/// discs of ink around them are smaller than those of the line. Whether branches into its corners have gone is known.
pub(super) fn tail(
    scan: Scan<'_>,
    pixels: impl Iterator<Item = Pixel>,
    sites: &[Site],
    had_branches: bool,
) -> usize {
    let mut pixels = pixels.peekable();
    let Some(tip) = pixels.peek().copied() else { return 0 };
    let is_cut = scan.rim_px(tip.into()) <= AT_RIM_PX;
    // Of what the rim cuts at an acute angle much is narrower than the line.
    let width_px = typical_width_px(sites.get(if is_cut { sites.len() / 2 } else { 0 }..).unwrap_or(&[]));
    if width_px <= scan.thin_px() {
        return 0;
    }
    let half_px = 0.5 * width_px;
    let radius_px = |at: Pixel| scan.radius_px(at.into(), half_px + 1.0);
    let is_round = radius_px(tip) >= 0.5 * half_px;
    if is_round && !had_branches {
        return 0;
    }
    let radii = if is_cut { MOST_CUT_RADII } else { MOST_RADII };
    let least_px = surely_px(half_px, TIP_RASTER_PX);
    let is_near = |at: &Pixel| PxPoint::from(*at).distance(tip.into()) <= radii * half_px + 1.0;
    let corner = || pixels.take_while(is_near).position(|at| radius_px(at) >= least_px);
    let Some(corner) = (if is_round { Some(0) } else { corner() }) else { return 0 };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "half a width below 200 px")]
    let margin = libm::ceil((half_px - 2.0).max(0.0)) as usize;
    // A short line shows nothing better.
    if corner + margin + 8 <= sites.len() { corner + margin } else { 0 }
}

/// Where a line ends, from the course of its undisturbed part; and whether the picture's rim cuts it there.
pub(super) fn line_end(scan: Scan<'_>, arm: &Arm) -> (PxPoint, bool) {
    let back = -arm.direction;
    let longest_px = 3.0 * arm.width_px + 4.0 + start_px(arm);
    let rim_px = scan.rim_along_px(arm.origin, back);
    let reach_px = scan.reach_px(arm.origin, back, longest_px);
    let rim = arm.origin + back * rim_px;
    if reach_px + 1.0 >= rim_px && scan.is_cut_at(rim, back, LEAST_CUT * arm.width_px) {
        return (rim, true);
    }
    let end = |reach_px: f64| arm.at(-(reach_px - 0.5 * arm.width_px).max(0.0));
    let straight = end(reach_px);
    // A line that bends may leave the ink beside the straight way.
    if scan.is_ink_around(straight) {
        return (straight, false);
    }
    (end(scan.reach_along_px(longest_px, |t| arm.at(-t))), false)
}

/// The end of a line along the raster's axis, put across it where the ink's end has it; none where that tells nothing.
///
/// Along such a line the middle of each column is the same, wherever within half a pixel of it the pen went. But the end of a pen's line is the
/// same on both sides of that, and its columns get narrower: each has a middle less than half a pixel from the pen's way, and those of an even and of
/// an odd number of pixels lie half a pixel apart. Ends that are not even, and square ones, tell nothing more.
///
/// ```text
///   ■■■■■■■■■·        middles of the columns: 2.5, then 2.0 of rows 0 to 3: the way is between them
///   ■■■■■■■■■■
///   ■■■■■■■■■■        2.25 ± 0.25 instead of 2.5 ± 0.5
///   ■■■■■■■■■■
///   ■■■■■■■··
/// ```
pub(super) fn seated_across(scan: Scan<'_>, arm: &Arm, end: PxPoint) -> Option<PxPoint> {
    /// Of thinner lines the end is hardly narrower than the line.
    const LEAST_PX: f64 = 2.0;
    let PxVec { x: dx, y: dy } = arm.direction;
    let is_upright = dx.abs() < LEVEL;
    if scan.grey.is_some() || arm.width_px < LEAST_PX || !(is_upright || dy.abs() < LEVEL) {
        return None;
    }
    let across = if is_upright { PxVec::new(1.0, 0.0) } else { PxVec::new(0.0, 1.0) };
    let middle = |at: PxPoint| {
        let run = |way: PxVec| scan.pixels_of_ink(at, way, arm.width_px + 1.0);
        let (before, behind) = (run(-across), run(across));
        let place = if is_upright { libm::floor(at.x) } else { libm::floor(at.y) };
        (place + 0.5 + 0.5 * (behind - before), before + behind)
    };
    let mut range = (f64::NEG_INFINITY, f64::INFINITY);
    // From the undisturbed part to the last column of ink.
    let mut out_px = -0.5 * arm.width_px - 1.0;
    while out_px < arm.width_px {
        let at = end + PxVec::new(-dx, -dy) * out_px;
        if !scan.is_ink_around(at) {
            break;
        }
        let (middle_px, width_px) = middle(at);
        if width_px > arm.width_px + 1.0 {
            return None;
        }
        range = (range.0.max(middle_px - 0.5), range.1.min(middle_px + 0.5));
        out_px += 1.0;
    }
    // A pixel wide it is what one column tells; noise leaves nothing.
    if !(0.1..0.9).contains(&(range.1 - range.0)) {
        return None;
    }
    let seat = f64::midpoint(range.0, range.1);
    Some(if is_upright { PxPoint::new(seat, end.y) } else { PxPoint::new(end.x, seat) })
}

/// How far the fitted part of an arm begins from its tip, px.
fn start_px(arm: &Arm) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "a few sites")]
    let skip = arm.skip as f64;
    1.5 * skip
}
