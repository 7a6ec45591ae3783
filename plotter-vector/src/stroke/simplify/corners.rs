//! Finds the vertices of a polyline that are corners of the drawn line.

use super::promise::Promise;
use crate::stroke::{MAX_REACH_PX, PxPoint, PxVec, turn::GOES_ON_COS};

/// Length of the shorter arm times the turn, in tolerances, above which a vertex is a corner.
///
/// The longest chords within e on either side of a circle of radius r are 4 √(r e) long and turn by 4 √(e /
/// r): their product is 16 e, whatever the circle; more where the bend changes.
const CORNER: f64 = 40.0;

/// Sites of each of the two parabolas, at most.
const ARM_SITES: usize = 8;

/// Fewest sites that make a parabola.
const LEAST_ARM_SITES: usize = 4;

/// A vertex of a polyline, and the site that it is near to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Anchor {
    pub(super) at: PxPoint,
    pub(super) site: usize,
    pub(super) is_corner: bool,
}

/// The vertices of a polyline as places along its sites, rising, the first and the last among them, each near
/// enough to a site of its own. For a closed line the last one is the first one a round later.
pub(super) fn anchors(
    promise: Promise,
    sites: &[PxPoint],
    straight: &[PxPoint],
    closed: bool,
) -> Vec<Anchor> {
    let count = sites.len();
    let Some(first) = straight.first() else { return Vec::new() };
    let start = if closed { nearest(sites, *first, 0, count).unwrap_or(0) } else { 0 };
    let end = if closed { start + count } else { count.saturating_sub(1) };
    let mut anchors: Vec<Anchor> = Vec::with_capacity(straight.len());
    let seam = near(promise, sites, *first, start);
    anchors.push(Anchor { at: seam, site: start, is_corner: false });
    for vertex in straight.get(1..straight.len().saturating_sub(1)).unwrap_or(&[]) {
        let Some(last) = anchors.last() else { break };
        let ahead = 2.0 * last.at.distance(*vertex) + 16.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
        let reach = (ahead as usize).min(MAX_REACH_PX);
        let (from, to) = (last.site + 1, (last.site + 1 + reach).min(end));
        let Some(site) = nearest(sites, *vertex, from, to) else { continue };
        let near = near(promise, sites, *vertex, site);
        anchors.push(Anchor { at: near, site, is_corner: false });
    }
    let last = if closed { seam } else { straight.last().copied().unwrap_or(*first) };
    anchors.push(Anchor { at: last, site: end, is_corner: false });
    let corners: Vec<bool> =
        (0..anchors.len()).map(|index| is_corner(promise, sites, &anchors, index, closed)).collect();
    anchors.iter_mut().zip(corners).for_each(|(anchor, is_corner)| anchor.is_corner = is_corner);
    anchors.iter_mut().filter(|_| closed).for_each(|anchor| anchor.site %= count.max(1));
    anchors
}

/// The place of a vertex, or the nearest to it that is near enough to a site: between two sites it may be
/// farther from both than from the way between them.
fn near(promise: Promise, sites: &[PxPoint], vertex: PxPoint, site: usize) -> PxPoint {
    sites.get(site % sites.len().max(1)).map_or(vertex, |site| {
        let (off, most_px) = (site.distance(vertex), 0.99 * promise.radius_px);
        if off <= most_px { vertex } else { *site + (vertex - *site) * (most_px / off) }
    })
}

/// The site of a range, around the end if it goes so far, that is nearest to a place.
fn nearest(sites: &[PxPoint], at: PxPoint, from: usize, to: usize) -> Option<usize> {
    let squared = |index: usize| {
        sites.get(index % sites.len()).map_or(f64::INFINITY, |site| (*site - at).length_squared())
    };
    (from..to).min_by(|one, other| squared(*one).total_cmp(&squared(*other)))
}

fn is_corner(promise: Promise, sites: &[PxPoint], anchors: &[Anchor], index: usize, closed: bool) -> bool {
    let count = anchors.len();
    // The seam of a closed one lies between the last but one and the second.
    let seam = index == 0 || index + 1 == count;
    if seam && !closed {
        return false;
    }
    let (before, after) = if seam { (count.saturating_sub(2), 1) } else { (index - 1, index + 1) };
    let (Some(anchor), Some(before), Some(after)) =
        (anchors.get(index), anchors.get(before), anchors.get(after))
    else {
        return false;
    };
    let (come, go) = (anchor.at - before.at, after.at - anchor.at);
    let shorter = libm::sqrt(come.length_squared().min(go.length_squared()));
    let turn = libm::atan2(come.cross(go).abs(), come.dot(go));
    if shorter * turn > CORNER * promise.radius_px {
        return true;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let arm = (shorter as usize).clamp(LEAST_ARM_SITES, ARM_SITES);
    // What comes and what goes is a parabola each. The nearest site need not be the one at the corner.
    (0..5).any(|step| {
        let site = anchor.site + sites.len() + step - 2;
        let (Some(come), Some(go)) =
            (slope(sites, site, arm, true, closed), slope(sites, site, arm, false, closed))
        else {
            return false;
        };
        let lengths = libm::sqrt(come.length_squared() * go.length_squared());
        lengths > 0.0 && -come.dot(go) < GOES_ON_COS * lengths
    })
}

/// The slope at a site of the parabola with the least squared distances through it and so many sites before
/// or after it, away from it; the site's index is more by once round. None beyond the ends of an open line.
fn slope(sites: &[PxPoint], site: usize, arm: usize, back: bool, closed: bool) -> Option<PxVec> {
    let count = sites.len();
    let own = site.checked_sub(count).filter(|own| closed || *own < count);
    let room =
        if back { own.is_some_and(|own| own >= arm) } else { own.is_some_and(|own| own + arm < count) };
    if !(room || closed) || count <= 2 * arm {
        return None;
    }
    let number = |n: usize| u32::try_from(n).map_or(0.0, f64::from);
    let (points, middle) = (number(arm + 1), 0.5 * number(arm));
    // Polynomials at right angles to each other: m − c, and its square less the mean of that.
    let mean = (points * points - 1.0) / 12.0;
    let (mut first, mut second) = (PxVec::default(), PxVec::default());
    let (mut first_squares, mut second_squares) = (0.0, 0.0);
    for step in 0..=arm {
        let at = sites.get(if back { site + count - step } else { site + step } % count)?;
        let one = number(step) - middle;
        let two = one * one - mean;
        first += PxVec::new(one * at.x, one * at.y);
        second += PxVec::new(two * at.x, two * at.y);
        (first_squares, second_squares) = (first_squares + one * one, second_squares + two * two);
    }
    let part = |one: f64, two: f64| one / first_squares - 2.0 * middle * two / second_squares;
    Some(PxVec::new(part(first.x, second.x), part(first.y, second.y)))
}
