//! [`Prior`]: where the camera should be, and how well that is known.

use crate::stroke::{PxPoint, PxVec};

/// Standard deviations beyond which a place is excluded.
const EXCLUDED: f64 = 5.0;

/// Standard deviation of a move: that of the shortest, and what grows with the square root of the way, px.
const TABLE_BASE_PX: f64 = 0.2;
const TABLE_PX: f64 = 0.15;

/// Standard deviation of what a table makes of a way, in each axis, px.
pub(super) fn moved_sd_px(way_px: f64) -> f64 {
    TABLE_BASE_PX + TABLE_PX * libm::sqrt(way_px)
}

/// What a table alone tells of a place after a way.
pub(super) fn moved(way_px: f64) -> Information {
    Information::of_axes([moved_sd_px(way_px); 2])
}

/// Inverse of the covariance of a place, per px².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Information {
    pub(super) xx: f64,
    pub(super) xy: f64,
    pub(super) yy: f64,
}

impl Information {
    /// Of two axes with these standard deviations, px.
    pub(super) fn of_axes([x, y]: [f64; 2]) -> Self {
        Self { xx: 1.0 / (x * x), xy: 0.0, yy: 1.0 / (y * y) }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { xx: self.xx + other.xx, xy: self.xy + other.xy, yy: self.yy + other.yy }
    }

    pub(super) fn minus(self, other: Self) -> Self {
        self.plus(other.scaled(-1.0))
    }

    pub(super) fn scaled(self, by: f64) -> Self {
        Self { xx: by * self.xx, xy: by * self.xy, yy: by * self.yy }
    }

    pub(super) fn times(self, PxVec { x, y }: PxVec) -> PxVec {
        PxVec::new(self.xx * x + self.xy * y, self.xy * x + self.yy * y)
    }

    /// The inverse matrix: information from a covariance, or a covariance; diagonal where there is none.
    pub(super) fn inverse(self) -> Self {
        let determinant = self.xx * self.yy - self.xy * self.xy;
        if determinant <= 1e-9 * self.xx * self.yy {
            return Self { xx: 1.0 / self.xx.max(1e-9), xy: 0.0, yy: 1.0 / self.yy.max(1e-9) };
        }
        Self { xx: self.yy / determinant, xy: -self.xy / determinant, yy: self.xx / determinant }
    }

    /// What is left of it after a move that adds errors with these standard deviations in both axes, px.
    pub(super) fn after(self, [x, y]: [f64; 2]) -> Self {
        self.inverse().plus(Self { xx: x * x, xy: 0.0, yy: y * y }).inverse()
    }

    /// Standard deviations of `across_px` in the direction of which most is told, and of `along_px` in the other.
    pub(super) fn astray(self, across_px: f64, along_px: f64) -> Self {
        let [(one, most), (other, least)] = self.directions();
        let (one, most, least) = if most >= least { (one, most, least) } else { (other, least, most) };
        // As much is told of both: then no direction is that of the lines.
        let across_px = if least > 0.8 * most { f64::max(across_px, 1.0) } else { across_px };
        let PxVec { x: u, y: v } = one;
        let (a, b) = (1.0 / (across_px * across_px), 1.0 / (along_px * along_px));
        Self { xx: a * u * u + b * v * v, xy: (a - b) * u * v, yy: a * v * v + b * u * u }
    }

    /// Both directions of which most and least is known, each with its standard deviation, px.
    pub(super) fn known(self) -> [(PxVec, f64); 2] {
        self.directions().map(|(way, known)| (way, 1.0 / libm::sqrt(known.max(1e-6))))
    }

    /// The direction of which least is told, of length 1.
    pub(super) fn least_told(self) -> PxVec {
        let [(one, most), (other, least)] = self.directions();
        if most < least { one } else { other }
    }

    /// What solves the normal equations; no shift where nothing is told.
    pub(super) fn solve(self, PxVec { x: bx, y: by }: PxVec) -> PxVec {
        let determinant = self.xx * self.yy - self.xy * self.xy;
        if determinant <= 1e-12 * (self.xx + self.yy) * (self.xx + self.yy) {
            return PxVec::default();
        }
        PxVec::new((self.yy * bx - self.xy * by) / determinant, (self.xx * by - self.xy * bx) / determinant)
    }

    /// Both directions of which most and least is told, and how much.
    fn directions(self) -> [(PxVec, f64); 2] {
        let angle = 0.5 * libm::atan2(2.0 * self.xy, self.xx - self.yy);
        let (u, v) = (libm::cos(angle), libm::sin(angle));
        [(u, v), (-v, u)]
            .map(|(u, v)| (PxVec::new(u, v), u * u * self.xx + 2.0 * u * v * self.xy + v * v * self.yy))
    }

    /// What equations along unit vectors tell, the sum of whose weights is `sum`, and their right side, without what noise of those
    /// vectors across themselves pretends to tell; `noise` is its variance.
    pub(super) fn without_noise(self, PxVec { x: bx, y: by }: PxVec, noise: f64, sum: f64) -> (Self, PxVec) {
        let (mut told, mut right) = (Self::default(), PxVec::default());
        for (PxVec { x: u, y: v }, all) in self.directions() {
            let share = (1.0 - noise * (sum - all) / all.max(1e-12)).max(0.0);
            let (kept, along) = (share * all, share * (u * bx + v * by));
            told = told.plus(Self { xx: kept * u * u, xy: kept * u * v, yy: kept * v * v });
            right += PxVec::new(along * u, along * v);
        }
        (told, right)
    }

    /// The same with its directions turned to those of `told`, if that is of one direction only, and it differs from the one of which
    /// most is known by no more than `most`, as a sine. Where two such directions that are nearly one do not agree, a place far along the
    /// lines would be the only one that fits both.
    pub(super) fn turned(self, told: Self, most: f64) -> Self {
        let strongest_first =
            |[one, other]: [(PxVec, f64); 2]| if one.1 < other.1 { [other, one] } else { [one, other] };
        let [(PxVec { x: u, y: v }, all), (_, least)] = strongest_first(told.directions());
        let [(PxVec { x, y }, known), (_, weak)] = strongest_first(self.directions());
        if all <= 0.0 || least > 1e-6 * all || (u * y - v * x).abs() > most {
            return self;
        }
        Self {
            xx: known * u * u + weak * v * v,
            xy: (known - weak) * u * v,
            yy: known * v * v + weak * u * u,
        }
    }

    /// The solution in the directions of which at least `least` is told, and the information it carries when its standard
    /// deviation is `sd_px` where much is told.
    pub(super) fn told(self, PxVec { x: bx, y: by }: PxVec, least: f64, sd_px: f64) -> (PxVec, Self) {
        let (mut shift, mut sum) = (PxVec::default(), Self::default());
        for (PxVec { x: u, y: v }, told) in self.directions() {
            if told < least {
                continue;
            }
            let along = (u * bx + v * by) / told;
            shift += PxVec::new(along * u, along * v);
            let weight = told / (told + 4.0 * least) / (sd_px * sd_px);
            sum = sum.plus(Self { xx: weight * u * u, xy: weight * u * v, yy: weight * v * v });
        }
        (shift, sum)
    }

    /// Standard deviation of each axis whatever the other one is, px.
    pub(super) fn axis_sd(self) -> [f64; 2] {
        let part = |one: f64, other: f64| {
            let left = one - self.xy * self.xy / other.max(1e-9);
            1.0 / libm::sqrt(left.max(1e-9))
        };
        [part(self.xx, self.yy), part(self.yy, self.xx)]
    }
}

/// A place with its information.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Prior {
    pub(super) place: PxPoint,
    pub(super) information: Information,
}

impl Prior {
    /// With another doubt, a covariance, if there is any.
    pub(super) fn with(&self, doubt: Option<Information>) -> Self {
        let wider = |doubt: Information| self.information.inverse().plus(doubt).inverse();
        Self { place: self.place, information: doubt.map_or(self.information, wider) }
    }

    /// How far off a place is, in standard deviations.
    pub(super) fn off(&self, at: PxPoint) -> f64 {
        let off = at - self.place;
        let PxVec { x, y } = self.information.times(off);
        libm::sqrt((off.x * x + off.y * y).max(0.0))
    }

    /// Whether a place is not excluded.
    pub(super) fn allows(&self, at: PxPoint) -> bool {
        self.off(at) <= EXCLUDED
    }

    /// Both together.
    pub(super) fn fused(&self, other: &Self) -> Self {
        let information = self.information.plus(other.information);
        let off = other.place - self.place;
        let shift = information.solve(other.information.times(off));
        Self { place: self.place + shift, information }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_places_are_weighed_by_what_is_known_of_them() {
        let one = Prior { place: PxPoint::new(0.0, 0.0), information: Information::of_axes([1.0, 1.0]) };
        let other = Prior { place: PxPoint::new(5.0, 5.0), information: Information::of_axes([0.5, 2.0]) };
        // Weights of 1 to 4 in x, of 1 to a quarter in y.
        let both = one.fused(&other);
        assert!(both.place.distance(PxPoint::new(4.0, 1.0)) < 1e-9, "{both:?}");
        assert_eq!(both.information, Information { xx: 5.0, xy: 0.0, yy: 1.25 });
    }

    #[test]
    fn lines_that_are_nearly_one_direction_tell_one_only() {
        let line = |nx: f64| Information { xx: nx * nx, xy: nx, yy: 1.0 };
        let (told, right) = line(0.0).plus(line(0.02)).without_noise(PxVec::new(0.01, 0.5), 6e-4, 2.0);
        assert!(told.xx < 3e-4 && (told.yy - 2.0).abs() < 1e-3 && right.x.abs() < 6e-3, "{told:?} {right:?}");
        let (told, right) = line(0.0).plus(line(0.5)).without_noise(PxVec::new(0.1, 0.5), 6e-4, 2.25);
        assert!((told.xx - 0.25).abs() < 5e-3 && (right.x - 0.1).abs() < 5e-3, "{told:?} {right:?}");
    }

    #[test]
    fn what_tells_one_direction_is_turned_to_another_that_does() {
        // Both tell y, one of them turned by 0.01.
        let known = Information { xx: 0.01, xy: 0.0, yy: 100.0 };
        let told = Information { xx: 0.01, xy: 1.0, yy: 100.0 };
        let turned = known.turned(told, 0.1);
        assert!((turned.xx - 0.02).abs() < 1e-3 && (turned.xy - 1.0).abs() < 1e-3, "{turned:?}");
        // Not what tells both directions, nor another direction.
        assert_eq!(known.turned(Information::of_axes([1.0, 0.5]), 0.1), known);
        assert_eq!(known.turned(Information { xx: 9.0, xy: 3.0, yy: 1.0 }, 0.1), known);
    }

    #[test]
    fn a_move_adds_its_variance() {
        let after = Information::of_axes([3.0, 1.0]).after([4.0, 0.0]);
        assert!((after.xx - 1.0 / 25.0).abs() < 1e-9 && (after.yy - 1.0).abs() < 1e-9, "{after:?}");
    }

    #[test]
    fn a_place_is_excluded_from_five_standard_deviations_on() {
        let prior = Prior { place: PxPoint::new(1.0, 1.0), information: Information::of_axes([0.5, 2.0]) };
        assert!(prior.allows(PxPoint::new(3.4, 1.0)) && !prior.allows(PxPoint::new(3.6, 1.0)));
        assert!(prior.allows(PxPoint::new(1.0, 10.9)) && !prior.allows(PxPoint::new(1.0, 11.1)));
    }
}
