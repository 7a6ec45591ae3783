//! [`RayCone`]: the directions in which a ray from one point meets every disc so far.

use crate::stroke::{PxPoint, PxVec};

/// A cone of directions from an apex, less than a half turn wide; or all directions.
///
/// Source: W. S. Chan, F. Chin, "Approximation of polygonal curves with minimum number of line segments"
/// (1992).
#[derive(Clone, Copy, Debug)]
pub(super) struct RayCone {
    pub(super) apex: PxPoint,
    radius_px: f64,
    /// Both borders, once a disc has set them.
    pub(super) borders: Option<Borders>,
    /// Farthest that a site lay along the right border, px.
    farthest_px: f64,
}

/// Clockwise and counter-clockwise border (seen with y up): unit vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Borders {
    pub(super) right: PxVec,
    pub(super) left: PxVec,
    /// Index of the site that set the right border, and the left one.
    pub(super) touches: (usize, usize),
}

impl Borders {
    /// The direction in the middle.
    pub(super) fn middle(self) -> PxVec {
        unit(self.right + self.left).unwrap_or(self.right)
    }
}

impl RayCone {
    pub(super) const fn new(apex: PxPoint, radius_px: f64) -> Self {
        Self { apex, radius_px, borders: None, farthest_px: 0.0 }
    }

    /// Keeps the directions whose rays meet the disc about the site with this index; `false`, and unchanged
    /// borders, when none is left or the site lies too far back.
    #[inline]
    pub(super) fn narrow(&mut self, site: PxPoint, index: usize) -> bool {
        let away = site - self.apex;
        let radius = self.radius_px;
        let Some(old) = self.borders else { return self.first(away, index) };
        let along = old.right.dot(away);
        let (from_right, to_left) = (old.right.cross(away), away.cross(old.left));
        // Turned back by more than two discs overlap: no order of the points that met them would do.
        if along < self.farthest_px - 2.0 * radius {
            return false;
        }
        self.farthest_px = self.farthest_px.max(along);
        // The disc is met by both borders, hence by all between: the usual case, without a root.
        if from_right.abs() <= radius && to_left.abs() <= radius && along > 0.0 {
            return true;
        }
        self.cut(away, index, old)
    }

    #[cold]
    fn first(&mut self, away: PxVec, index: usize) -> bool {
        let Some((right, left)) = tangents(away, self.radius_px) else { return away.x.is_finite() };
        self.borders = Some(Borders { right, left, touches: (index, index) });
        right.x.is_finite()
    }

    #[inline]
    fn cut(&mut self, away: PxVec, index: usize, old: Borders) -> bool {
        // The apex itself is near enough: any ray will do.
        let Some((right, left)) = tangents(away, self.radius_px) else { return true };
        if !(away.dot(old.right) > 0.0 || away.dot(old.left) > 0.0) {
            return false;
        }
        let mut new = old;
        if old.right.cross(right) > 0.0 {
            (new.right, new.touches.0) = (right, index);
        }
        if left.cross(old.left) > 0.0 {
            (new.left, new.touches.1) = (left, index);
        }
        if new.right.cross(new.left) < 0.0 || new.right.dot(new.left) <= -0.5 {
            return false;
        }
        self.borders = Some(new);
        true
    }

    /// The offsets along `normal` from `at` that rays of the cone pass, between −1 and 1 times the radius.
    pub(super) fn interval(&self, at: PxPoint, normal: PxVec) -> Option<(f64, f64)> {
        let radius = self.radius_px;
        let Some(borders) = self.borders else { return Some((-radius, radius)) };
        let away = at - self.apex;
        let meet = |border: PxVec| {
            let slope = border.cross(normal);
            (slope.abs() > 1e-6).then(|| -border.cross(away) / slope)
        };
        let (a, b) = (meet(borders.right)?, meet(borders.left)?);
        let (low, high) = (a.min(b).max(-radius), a.max(b).min(radius));
        (low <= high).then_some((low, high))
    }
}

/// The unit directions of the tangents from the origin to a disc, right and left; `None` inside.
#[inline]
fn tangents(away: PxVec, radius_px: f64) -> Option<(PxVec, PxVec)> {
    let squared = away.length_squared();
    let tangent_squared = squared - radius_px * radius_px;
    if tangent_squared <= 0.0 {
        return None;
    }
    // `away` turned by ± asin(r/|d|), over |d|.
    let (cosine, sine) = (libm::sqrt(tangent_squared) / squared, radius_px / squared);
    let right = PxVec::new(away.x * cosine + away.y * sine, away.y * cosine - away.x * sine);
    let left = PxVec::new(away.x * cosine - away.y * sine, away.y * cosine + away.x * sine);
    Some((right, left))
}

/// The vector over its length; `None` for one without a direction.
pub(super) fn unit(a: PxVec) -> Option<PxVec> {
    let length = a.length_near();
    (length > 0.0 && length.is_finite()).then(|| a / length)
}
