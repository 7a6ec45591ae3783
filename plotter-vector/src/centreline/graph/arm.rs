//! [`Arm`]: a line that leaves a junction, and where it would go on to inside it.

use super::site::{Site, slack_px};
use crate::stroke::{PxPoint, PxVec};

/// Fewest sites that give a direction.
const MIN_SUPPORT: usize = 3;

/// Fewest sites that are looked at for a direction, calm or not.
const MIN_CALM: usize = 8;

/// Typical error of a single site, px: the edges of a line are known to half a pixel either way.
const SITE_ERROR_PX: f64 = 0.25;

/// A line from where it is undisturbed, with the curve that continues it into the junction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arm {
    /// Sites of the edge, counted from the junction, that are disturbed by it.
    pub(crate) skip: usize,
    /// Where the undisturbed part begins, on the fitted curve.
    pub(crate) origin: PxPoint,
    /// Unit vector along the line there, out of the junction.
    pub(crate) direction: PxVec,
    /// The curve is origin + t·direction + bend·t²·normal, t in px.
    pub(crate) bend_per_px: f64,
    /// Width of the line, px.
    pub(crate) width_px: f64,
    /// Length of the part that was fitted, px; 0 when there was none and the direction is a guess.
    pub(crate) support_px: f64,
}

impl Arm {
    /// The arm of an edge whose sites are given from the junction outwards; `reserved` of them at the far end
    /// belong to the next junction. Of its course at most `longest` sites are looked at.
    pub(crate) fn of(sites: &[Site], reserved: usize, longest: usize) -> Option<Self> {
        let width_px = typical_width_px(sites);
        let limit_px = width_px + slack_px(width_px);
        // The width of a slanted line goes up and down by a pixel's part from site to site.
        let is_calm = |three: &[Site]| three.iter().map(|site| site.width_px).sum::<f64>() <= 3.0 * limit_px;
        let free = sites.len().saturating_sub(reserved).max(sites.len().div_ceil(2));
        // Three calm sites in a row end the disturbance; a line one pixel wide has none.
        let calm_from = sites.windows(3).position(is_calm).unwrap_or(sites.len());
        // Up to where the next junction begins; a line that leads to none may taper.
        let mut further = sites.windows(3).skip(calm_from);
        let calm =
            further.position(|three| reserved > 0 && !is_calm(three)).map_or(sites.len(), |calm| calm + 1);
        let free = free.min(calm_from + calm.max(MIN_CALM));
        let margin = if width_px > 1.5 { to_whole(0.25 * width_px) } else { 0 };
        let wanted = to_whole(2.5 * width_px + 8.0).clamp(12, 48).min(longest);
        // A short line has no room for a margin.
        for skip in [calm_from + margin, calm_from] {
            if skip + MIN_SUPPORT > free {
                continue;
            }
            let mut support = wanted.min(free - skip);
            loop {
                let part = sites.get(skip..skip + support)?;
                let (arm, rms_px) = fit(part, skip, width_px)?;
                if rms_px <= 2.0 * SITE_ERROR_PX || support <= 2 * MIN_SUPPORT {
                    return Some(arm);
                }
                support = support * 2 / 3;
            }
        }
        // Too short to be undisturbed anywhere: from end to end.
        let (from, to) = (sites.first()?.centre, sites.last()?.centre);
        let length = from.distance(to);
        let direction = if length > 0.0 { (to - from) / length } else { PxVec::new(1.0, 0.0) };
        let middle = sites.get(sites.len() / 2)?;
        Some(Self {
            skip: sites.len() / 2,
            origin: middle.centre,
            direction,
            bend_per_px: 0.0,
            width_px,
            support_px: 0.0,
        })
    }

    /// The place `t` px along the line, negative into the junction.
    pub(crate) fn at(&self, t: f64) -> PxPoint {
        let PxVec { x: dx, y: dy } = self.direction;
        let across = self.bend_per_px * t * t;
        PxPoint::new(self.origin.x + dx * t - dy * across, self.origin.y + dy * t + dx * across)
    }

    /// How far along the line a place lies.
    pub(crate) fn along(&self, place: PxPoint) -> f64 {
        let PxVec { x: dx, y: dy } = self.direction;
        (place.x - self.origin.x) * dx + (place.y - self.origin.y) * dy
    }

    /// The unit vector along the line at `t`.
    pub(crate) fn direction_at(&self, t: f64) -> PxVec {
        let PxVec { x: dx, y: dy } = self.direction;
        let slope = 2.0 * self.bend_per_px * t;
        let length = libm::sqrt(1.0 + slope * slope);
        PxVec::new((dx - dy * slope) / length, (dy + dx * slope) / length)
    }

    /// Standard error across the line of the place at `t`, px: the line's position and slope are as sure as its
    /// support is long.
    pub(crate) fn error_px(&self, t: f64) -> f64 {
        if self.support_px <= 0.0 {
            return f64::INFINITY;
        }
        let beyond = (0.5 * self.support_px - t) / self.support_px;
        let curved = if self.bend_per_px == 0.0 { 1.0 } else { 2.5 };
        curved * SITE_ERROR_PX * libm::sqrt((1.0 + 12.0 * beyond * beyond) / self.support_px.max(1.0)) + 0.05
    }
}

/// Sites that show the course of a line that is straight for long, and of one that soon bends.
pub(crate) const LONG: usize = 48;
pub(crate) const SHORT: usize = 6;

/// Fewer sites are a short line.
const SHORT_SITES: usize = 12;

/// Sites from a line's end on that tell its width there.
pub(crate) const TYPICAL_SITES: usize = 64;

/// Least width that most of a line's sites have: a junction only ever widens it.
pub(crate) fn typical_width_px(sites: &[Site]) -> f64 {
    let mut widths: Vec<f64> = sites.iter().take(TYPICAL_SITES).map(|site| site.width_px).collect();
    // Most of a short line may lie within a junction.
    let rank = if widths.len() < SHORT_SITES { widths.len() / 4 } else { widths.len() * 2 / 5 };
    if widths.is_empty() { 1.0 } else { *widths.select_nth_unstable_by(rank, f64::total_cmp).1 }
}

/// Whether lines differ so much in width that one pen cannot have drawn both, however its width was measured in a figure that
/// is nowhere undisturbed.
pub(crate) fn are_of_two_pens(one_px: f64, other_px: f64) -> bool {
    one_px.max(other_px) > 1.3 * one_px.min(other_px) + 1.5
}

/// A small positive number, rounded up.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "widths are below 200 px")]
fn to_whole(number: f64) -> usize {
    libm::ceil(number.clamp(0.0, 1e6)) as usize
}

/// A parabola through sites by least squares, or a straight line when the bend says nothing; and the root mean square
/// of the distances.
fn fit(part: &[Site], skip: usize, width_px: f64) -> Option<(Arm, f64)> {
    let (first, last) = (part.first()?.centre, part.last()?.centre);
    #[expect(clippy::cast_precision_loss, reason = "at most 48 sites")]
    let count = part.len() as f64;
    // Main axis of the sites: the direction with the least squared distances.
    let mean_x = part.iter().map(|site| site.centre.x).sum::<f64>() / count;
    let mean_y = part.iter().map(|site| site.centre.y).sum::<f64>() / count;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for site in part {
        let (x, y) = (site.centre.x - mean_x, site.centre.y - mean_y);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let (mut dx, mut dy) = (libm::cos(angle), libm::sin(angle));
    if (last.x - first.x) * dx + (last.y - first.y) * dy < 0.0 {
        (dx, dy) = (-dx, -dy);
    }
    // In the frame of the axis: v = a + b·u + c·u².
    let local = |site: &Site| {
        let (x, y) = (site.centre.x - mean_x, site.centre.y - mean_y);
        (x * dx + y * dy, y * dx - x * dy)
    };
    let mut sums = [0.0; 5];
    let mut values = [0.0; 3];
    for (u, v) in part.iter().map(local) {
        let mut power = 1.0;
        for (index, sum) in sums.iter_mut().enumerate() {
            *sum += power;
            if let Some(value) = values.get_mut(index) {
                *value += power * v;
            }
            power *= u;
        }
    }
    let (mut a, mut b, mut c) = solve(sums, values).unwrap_or((0.0, 0.0, 0.0));
    let start = part.iter().map(|site| local(site).0).fold(f64::INFINITY, f64::min);
    let end = part.iter().map(|site| local(site).0).fold(f64::NEG_INFINITY, f64::max);
    let support_px = end - start;
    // The bend's own standard error is σ·√(180/n)/L²; less than three of it is noise.
    let bend_error = SITE_ERROR_PX * libm::sqrt(180.0 / count) / (support_px * support_px).max(1.0);
    if c.abs() < 3.0 * bend_error {
        (a, b, c) = (0.0, 0.0, 0.0);
    }
    let squares: f64 = part.iter().map(local).map(|(u, v)| v - a - b * u - c * u * u).map(|e| e * e).sum();
    let slope = b + 2.0 * c * start;
    let length = libm::sqrt(1.0 + slope * slope);
    let across = a + b * start + c * start * start;
    let origin = PxPoint::new(mean_x + dx * start - dy * across, mean_y + dy * start + dx * across);
    let direction = PxVec::new((dx - dy * slope) / length, (dy + dx * slope) / length);
    let bend_per_px = c / (length * length * length);
    Some((Arm { skip, origin, direction, bend_per_px, width_px, support_px }, libm::sqrt(squares / count)))
}

/// The parabola a, b, c from the sums of u⁰…u⁴ and of v, v·u, v·u².
fn solve([s0, s1, s2, s3, s4]: [f64; 5], [v0, v1, v2]: [f64; 3]) -> Option<(f64, f64, f64)> {
    let minor = (s2 * s4 - s3 * s3, s1 * s4 - s2 * s3, s1 * s3 - s2 * s2);
    let determinant = s0 * minor.0 - s1 * minor.1 + s2 * minor.2;
    if determinant.abs() < 1e-9 {
        return None;
    }
    let a = (v0 * minor.0 - s1 * (v1 * s4 - v2 * s3) + s2 * (v1 * s3 - v2 * s2)) / determinant;
    let b = (s0 * (v1 * s4 - v2 * s3) - v0 * minor.1 + s2 * (s1 * v2 - s2 * v1)) / determinant;
    let c = (s0 * (s2 * v2 - s3 * v1) - s1 * (s1 * v2 - s2 * v1) + v0 * minor.2) / determinant;
    Some((a, b, c))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centreline::graph::site::Role;

    fn sites(path: impl Fn(f64) -> PxPoint, widths: &[f64]) -> Vec<Site> {
        (0..40_u8)
            .map(|index| Site {
                centre: path(f64::from(index)),
                width_px: widths.get(usize::from(index)).copied().unwrap_or(5.0),
                role: Role::Course,
            })
            .collect()
    }

    #[test]
    fn a_straight_arm_is_continued_straight_through_its_disturbance() {
        let line = sites(|t| PxPoint::new(3.0 + t, if t < 5.0 { 9.0 } else { 0.5 * t }), &[9.0; 5]);
        let arm = Arm::of(&line, 0, LONG).unwrap();
        assert_eq!(arm.skip, 7);
        let back = arm.at(arm.along(PxPoint::new(3.0, 0.0)));
        assert!(back.distance(PxPoint::new(3.0, 0.0)) < 1e-9, "{back:?}");
    }

    #[test]
    fn a_curved_arm_goes_on_curved() {
        let radius = 30.0;
        let circle = |t: f64| {
            let angle = t / radius;
            PxPoint::new(radius * libm::cos(angle), radius * libm::sin(angle))
        };
        let arm = Arm::of(&sites(circle, &[]), 0, LONG).unwrap();
        assert!(arm.bend_per_px > 0.0);
        let before = arm.at(-6.0);
        assert!((libm::hypot(before.x, before.y) - radius).abs() < 0.15, "{before:?}");
    }

    #[test]
    fn an_arm_without_calm_sites_is_a_guess() {
        let arm = Arm::of(&sites(|t| PxPoint::new(t, 0.0), &[])[..2], 0, LONG).unwrap();
        assert_eq!(arm.support_px, 0.0);
        assert_eq!(arm.error_px(0.0), f64::INFINITY);
    }
}
