//! Corners of a single line: thinning rounds them off; the two straight parts beside them say where they are.
//!
//! ```text
//!   ──────────╮          the skeleton takes the short cut
//!             │
//!   ──────────┼ P        the straight parts, continued, meet in P: the pen was there
//!             │
//! ```
//!
//! A tight bend is told from a corner by the ink: a pen that went to P has left ink around P, half its width far.

use super::junction::THIN_PX;
use super::site::{Role, Scan, Site};
use crate::PxPoint;

/// Least turn of a corner: cos 25°. Less is within the tolerance of any drawing, or a curve.
pub(super) const TURN_COS: f64 = 0.906_307_8;

/// Greatest root mean square distance of the sites of a straight part, px.
const STRAIGHT_PX: f64 = 0.4;

/// Sites that are looked at for the width of the line around one.
const WIDTH_SITES: usize = 8;

/// A corner of a line.
struct Corner {
    /// Site in the middle of it.
    index: usize,
    /// Sites to either side that it replaces.
    gap: usize,
    /// Where it is.
    at: PxPoint,
    /// Cosine of the turn: the smaller, the sharper.
    cos: f64,
}

/// The sites of a line, the first one after the last if it is closed.
#[derive(Clone, Copy)]
struct Line<'a> {
    sites: &'a [Site],
    closed: bool,
}

/// Sharpens the corners of a line's undisturbed sites: the site in the middle of one moves there, those beside it go.
pub(super) fn sharpen(sites: &mut [Site], closed: bool, scan: Scan<'_>) {
    let line = Line { sites, closed };
    let mut corners = line.corners(scan);
    // The sharpest ones first; what overlaps with them is their flank. Of equals the upper one: whichever way the line runs.
    let place =
        |corner: &Corner| sites.get(corner.index).map_or((0.0, 0.0), |site| (site.centre.y, site.centre.x));
    corners.sort_by(|a, b| {
        let ((top, left), (y, x)) = (place(a), place(b));
        a.cos.total_cmp(&b.cos).then(top.total_cmp(&y)).then(left.total_cmp(&x))
    });
    let mut roles = vec![Role::Course; sites.len()];
    let mut moved = Vec::new();
    for corner in corners {
        let span: Vec<usize> =
            (0..=2 * corner.gap).filter_map(|step| line.index(corner.index, step, corner.gap)).collect();
        let taken = |index: &usize| roles.get(*index).is_none_or(|role| *role != Role::Course);
        if span.iter().any(taken) {
            continue;
        }
        for index in span {
            if let Some(role) = roles.get_mut(index) {
                *role = if index == corner.index { Role::Corner } else { Role::Left };
            }
        }
        moved.push((corner.index, corner.at));
    }
    for (site, role) in sites.iter_mut().zip(roles) {
        site.role = role;
    }
    for (index, at) in moved {
        if let Some(site) = sites.get_mut(index) {
            site.centre = at;
        }
    }
}

impl Line<'_> {
    /// The index `ahead` sites after `index` and `back` before it, around the end of a closed line.
    fn index(&self, index: usize, ahead: usize, back: usize) -> Option<usize> {
        let count = self.sites.len();
        if self.closed && count > 0 {
            Some((index + ahead + count - back % count) % count)
        } else {
            (index + ahead).checked_sub(back).filter(|index| *index < count)
        }
    }

    fn place(&self, index: usize, ahead: usize, back: usize) -> Option<PxPoint> {
        self.sites.get(self.index(index, ahead, back)?).map(|site| site.centre)
    }

    /// Width of the line around a site: the least one near it, for a corner only widens it.
    fn width_px(&self, index: usize) -> f64 {
        let near = (0..=2 * WIDTH_SITES).step_by(2).filter_map(|step| self.index(index, step, WIDTH_SITES));
        near.filter_map(|index| self.sites.get(index)).map(|site| site.width_px).fold(f64::INFINITY, f64::min)
    }

    /// All corners, those that overlap too.
    fn corners(&self, scan: Scan<'_>) -> Vec<Corner> {
        /// Sites to either side whose chords give a first look at the turn.
        const LOOK: usize = 6;
        let count = self.sites.len();
        if count <= 2 * LOOK {
            return Vec::new();
        }
        let turn = |index: usize| {
            let (before, at, after) =
                (self.place(index, 0, LOOK)?, self.place(index, 0, 0)?, self.place(index, LOOK, 0)?);
            Some(cos(direction(before, at)?, direction(at, after)?))
        };
        let turns: Vec<f64> = (0..count).map(|index| turn(index).unwrap_or(1.0)).collect();
        let mut found = Vec::new();
        for (index, turn) in turns.iter().enumerate().filter(|(_, turn)| **turn < TURN_COS) {
            let near = (0..=4).filter_map(|step| self.index(index, step, 2));
            let sharpest = near.filter_map(|index| turns.get(index)).fold(f64::INFINITY, |a, b| a.min(*b));
            if *turn <= sharpest {
                found.extend(self.corner(scan, index));
            }
        }
        found
    }

    /// The corner at a place, if the parts beside it are straight and meet where the pen has been.
    fn corner(&self, scan: Scan<'_>, index: usize) -> Option<Corner> {
        let width_px = self.width_px(index);
        if width_px <= THIN_PX {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a width below 200 px")]
        let (gap, mut support) =
            (libm::ceil(0.6 * width_px) as usize + 1, libm::ceil(1.2 * width_px) as usize + 5);
        let (before, after) = loop {
            let side = |ahead: bool| {
                straight((gap..gap + support).map_while(|step| {
                    if ahead { self.place(index, step, 0) } else { self.place(index, 0, step) }
                }))
            };
            if let (Some(before), Some(after)) = (side(false), side(true)) {
                break (before, after);
            }
            support -= 2;
            if support < 4 {
                return None;
            }
        };
        // The line before runs away from the corner, so it is turned around.
        let cos = -(before.1.0 * after.1.0 + before.1.1 * after.1.1);
        if cos > TURN_COS {
            return None;
        }
        let ((a, u), (b, v)) = (before, after);
        let cross = u.0 * v.1 - u.1 * v.0;
        if cross.abs() < 0.1 {
            return None;
        }
        let t = ((b.x - a.x) * v.1 - (b.y - a.y) * v.0) / cross;
        let at = PxPoint::new(a.x + u.0 * t, a.y + u.1 * t);
        let near = self.place(index, 0, 0)?.distance(at) <= 1.2 * width_px + 1.0;
        let half_px = 0.5 * width_px;
        let pen_was_there = scan.radius_px(at, half_px + 1.0) >= half_px - (0.1 * width_px).max(0.45);
        (near && pen_was_there).then_some(Corner { index, gap, at, cos })
    }
}

/// The line through places, none when they are not straight: their mean, and the direction from the first to the
/// last.
fn straight(places: impl Iterator<Item = PxPoint>) -> Option<(PxPoint, (f64, f64))> {
    let (mut n, mut x, mut y, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    let (mut first, mut last) = (None, None);
    for place in places {
        let origin = *first.get_or_insert(place);
        last = Some(place);
        let (dx, dy) = (place.x - origin.x, place.y - origin.y);
        (n, x, y) = (n + 1.0, x + dx, y + dy);
        (xx, xy, yy) = (xx + dx * dx, xy + dx * dy, yy + dy * dy);
    }
    let (origin, last) = (first?, last?);
    if n < 3.0 {
        return None;
    }
    (x, y) = (x / n, y / n);
    (xx, xy, yy) = (xx / n - x * x, xy / n - x * y, yy / n - y * y);
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let (mut dx, mut dy) = (libm::cos(angle), libm::sin(angle));
    if (last.x - origin.x) * dx + (last.y - origin.y) * dy < 0.0 {
        (dx, dy) = (-dx, -dy);
    }
    let across = xx * dy * dy - 2.0 * xy * dx * dy + yy * dx * dx;
    (across <= STRAIGHT_PX * STRAIGHT_PX).then_some((PxPoint::new(origin.x + x, origin.y + y), (dx, dy)))
}

fn direction(from: PxPoint, to: PxPoint) -> Option<(f64, f64)> {
    let length = from.distance(to);
    (length > 0.0).then(|| ((to.x - from.x) / length, (to.y - from.y) / length))
}

fn cos(a: (f64, f64), b: (f64, f64)) -> f64 {
    a.0 * b.0 + a.1 * b.1
}
