//! [`Piece`]: a stretch of the pen's way, in plotter units.

use crate::Vec2;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// A stretch of the pen's way. Places are plotter units from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    /// With the pen up.
    Travel { to: Vec2 },
    /// A straight line; one without length is a dot.
    Line { from: Vec2, to: Vec2 },
    /// An arc of a circle.
    Arc(Arc),
}

/// An arc of a circle from one place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    pub(super) centre: Vec2,
    pub(super) from: Vec2,
    /// Counter-clockwise above 0, at most a whole turn.
    pub(super) sweep_rad: f64,
    pub(super) to: Vec2,
}

impl Piece {
    pub(super) fn to(self) -> Vec2 {
        match self {
            Self::Travel { to } | Self::Line { to, .. } => to,
            Self::Arc(arc) => arc.to,
        }
    }

    pub(super) fn from(self) -> Vec2 {
        match self {
            Self::Travel { to } => to,
            Self::Line { from, .. } => from,
            Self::Arc(arc) => arc.from,
        }
    }

    /// Length, units; 0 for a travel, which leaves no mark.
    pub(super) fn length(self) -> f64 {
        match self {
            Self::Travel { .. } => 0.0,
            Self::Line { from, to } => (to - from).length(),
            Self::Arc(arc) => arc.radius() * libm::fabs(arc.sweep_rad),
        }
    }

    /// The part from the share `first` of its length to the share `last`; its own ends where these are 0
    /// and 1.
    pub(super) fn part(self, first: f64, last: f64) -> Self {
        match self {
            Self::Travel { .. } => self,
            Self::Line { from, to } => {
                let place = |share: f64| {
                    if share <= 0.0 {
                        from
                    } else if share >= 1.0 {
                        to
                    } else {
                        from + (to - from) * share
                    }
                };
                Self::Line { from: place(first), to: place(last) }
            }
            Self::Arc(arc) => Self::Arc(Arc {
                from: arc.place(first),
                to: arc.place(last),
                sweep_rad: if first <= 0.0 && last >= 1.0 {
                    arc.sweep_rad
                } else {
                    arc.sweep_rad * (last - first)
                },
                ..arc
            }),
        }
    }
}

impl Arc {
    pub(super) fn radius(self) -> f64 {
        (self.from - self.centre).length()
    }

    /// The place after this share of the way round.
    pub(super) fn place(self, share: f64) -> Vec2 {
        if share <= 0.0 {
            self.from
        } else if share >= 1.0 {
            self.to
        } else {
            self.centre + (self.from - self.centre).rotated(self.sweep_rad * share)
        }
    }

    /// The share of the way round after which the arc first comes in this direction from its centre, from 0;
    /// above 1 if it does not come so far.
    pub(super) fn share_at(self, direction_rad: f64) -> f64 {
        let out = self.from - self.centre;
        let start_rad = libm::atan2(out.y, out.x);
        let way_rad =
            if self.sweep_rad < 0.0 { start_rad - direction_rad } else { direction_rad - start_rad };
        let turned_rad = way_rad - TAU * libm::floor(way_rad / TAU);
        turned_rad / libm::fabs(self.sweep_rad)
    }

    /// The whole circle about `centre` through the place that lies `radius` from it.
    #[cfg(test)]
    pub(super) fn circle(centre: Vec2, radius: Vec2) -> Self {
        Self { centre, from: centre + radius, sweep_rad: TAU, to: centre + radius }
    }

    /// The arc from one place through another to a third; `None` where these lie on a line.
    pub(super) fn through(from: Vec2, middle: Vec2, to: Vec2) -> Option<Self> {
        let (a, b) = (middle - from, to - from);
        let twice_area = 2.0 * a.cross(b);
        let flat = libm::fabs(twice_area) <= FLAT * a.length() * b.length();
        if flat || twice_area == 0.0 {
            return None;
        }
        let (aa, bb) = (a.length_squared(), b.length_squared());
        let out = Vec2::new(b.y * aa - a.y * bb, a.x * bb - b.x * aa) * (1.0 / twice_area);
        let centre = from + out;
        let turn = (from - centre, to - centre);
        let shorter = libm::atan2(turn.0.cross(turn.1), turn.0.dot(turn.1));
        // Over the middle, the way to the end turns left: counter-clockwise.
        let sweep_rad = match (twice_area > 0.0, shorter > 0.0) {
            (true, false) => shorter + TAU,
            (false, true) => shorter - TAU,
            _ => shorter,
        };
        Some(Self { centre, from, sweep_rad, to })
    }
}

/// Sine of the angle below which three places lie on a line.
const FLAT: f64 = 1e-9;

/// `out` turned by whole degrees, right angles exactly.
pub(super) fn turned_deg(out: Vec2, angle_deg: f64) -> Vec2 {
    let quarters = angle_deg / 90.0;
    if libm::trunc(quarters) == quarters && libm::fabs(quarters) <= 4.0 {
        let mut turned = out;
        let mut left = libm::fabs(quarters);
        while left > 0.5 {
            turned = if quarters > 0.0 { turned.perpendicular() } else { -turned.perpendicular() };
            left -= 1.0;
        }
        return turned;
    }
    out.rotated(angle_deg.to_radians())
}

/// An angle of whole degrees in rad, right angles to the nearest number.
pub(super) fn rad(angle_deg: f64) -> f64 {
    match angle_deg {
        90.0 => FRAC_PI_2,
        180.0 => PI,
        360.0 => TAU,
        -360.0 => -TAU,
        _ => angle_deg.to_radians(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_places_make_an_arc_the_way_the_middle_says() {
        let place = |x, y| Vec2::new(x, y);
        let left = Arc::through(place(10.0, 0.0), place(0.0, 10.0), place(-10.0, 0.0)).unwrap();
        assert!(left.centre.length() < 1e-12 && (left.sweep_rad - PI).abs() < 1e-12);
        let right = Arc::through(place(10.0, 0.0), place(0.0, -10.0), place(0.0, 10.0)).unwrap();
        assert!((right.sweep_rad + 1.5 * PI).abs() < 1e-12, "{right:?}");
        assert_eq!(Arc::through(place(0.0, 0.0), place(1.0, 1.0), place(2.0, 2.0)), None);
    }

    #[test]
    fn right_angles_are_exact() {
        assert_eq!(turned_deg(Vec2::new(3.0, 1.0), -90.0), Vec2::new(1.0, -3.0));
        assert_eq!(turned_deg(Vec2::new(3.0, 1.0), 180.0), Vec2::new(-3.0, -1.0));
    }
}
