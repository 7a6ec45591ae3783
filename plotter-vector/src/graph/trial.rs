//! [`Trial`]: the lines of a junction drawn again, and held against the ink.
//!
//! The arms of a junction can be taken to go on in several ways. A pen of each line's width that goes these ways must
//! leave the ink that is there.

use super::junction::{ArmOf, Way};
use super::site::{Scan, Site};
use crate::{Pixel, PxPoint};

/// Cost that the raster alone explains, px².
pub(super) const GOOD_PX2: f64 = 0.5;

/// Whether ways of one cost are better than those of another: by more than the raster alone explains.
pub(super) fn is_better(cost: f64, than: f64) -> bool {
    cost < 0.8 * than || cost + GOOD_PX2 < than
}

/// Nothing costs more than a pixel as far as this from where it should be, px.
const FARTHEST_PX: f64 = 2.0;

/// Largest junction that is drawn again, px from its middle.
const MOST_PX: f64 = 48.0;

/// The ink around a junction.
pub(super) struct Trial<'a> {
    scan: Scan<'a>,
    arms: &'a [ArmOf],
    /// The sites of each arm, from the junction out.
    sites: &'a [Vec<Site>],
    centre: PxPoint,
    radius_px: f64,
    left: u32,
    top: u32,
    side: u32,
}

impl<'a> Trial<'a> {
    /// For a junction; none when it is too large to be drawn again.
    pub(super) fn new(
        scan: Scan<'a>,
        centre: PxPoint,
        arms: &'a [ArmOf],
        sites: &'a [Vec<Site>],
    ) -> Option<Self> {
        let far = |(one, sites): (&ArmOf, &Vec<Site>)| {
            let first = sites.get(one.arm.skip).or(sites.last())?;
            Some(first.centre.distance(centre) + 0.5 * one.arm.width_px + 2.0)
        };
        let radius_px = arms.iter().zip(sites).filter_map(far).fold(0.0, f64::max);
        if radius_px > MOST_PX {
            return None;
        }
        let corner = |v: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
            let corner = libm::floor(v - radius_px).max(0.0) as u32;
            corner
        };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 98")]
        let side = libm::ceil(2.0 * radius_px + 1.0) as u32;
        Some(Self {
            scan,
            arms,
            sites,
            centre,
            radius_px,
            left: corner(centre.x),
            top: corner(centre.y),
            side,
        })
    }

    /// How much the ink around the junction differs from what pens draw that go these ways: the squared distances of
    /// all pixels whose centres are on the wrong side of the lines' edges, px².
    pub(super) fn cost(&self, ways: &[Way]) -> f64 {
        let mut field = vec![FARTHEST_PX; (self.side * self.side) as usize];
        for Way { one, other, points } in ways {
            let mut before = None;
            let width_px = one.arm.width_px;
            let theirs = other.map_or(width_px, |other| other.arm.width_px);
            let count = points.len().max(1);
            let along = self.course(one).into_iter().rev().map(|at| (at, width_px));
            let inner = points.iter().enumerate().map(|(index, at)| {
                // From one line's width to the other's.
                #[expect(clippy::cast_precision_loss, reason = "a few points")]
                let t = (index as f64 + 0.5) / count as f64;
                (*at, width_px + (theirs - width_px) * t)
            });
            let beyond = other.iter().flat_map(|other| self.course(other)).map(|at| (at, theirs));
            for (at, width_px) in along.chain(inner).chain(beyond) {
                self.draw(&mut field, before.unwrap_or(at), at, 0.5 * width_px);
                before = Some(at);
            }
        }
        let mut cost = 0.0;
        let reach = self.radius_px * self.radius_px;
        for (row, values) in (self.top..).zip(field.chunks_exact(self.side as usize)) {
            for (column, value) in (self.left..).zip(values) {
                let at = Pixel::new(column, row);
                let (x, y) = PxPoint::from(at).minus(self.centre);
                if x * x + y * y > reach {
                    continue;
                }
                let off_px = if self.scan.is_ink_at(at) { *value } else { -*value };
                if off_px > 0.0 {
                    cost += off_px * off_px;
                }
            }
        }
        cost
    }

    /// The ways with their few places moved to where they cost least: a pattern search, from `cost` down.
    pub(super) fn settle(&self, mut ways: Vec<Way>, mut cost: f64) -> Vec<Way> {
        /// Ways with more places are curves.
        const MOST_PLACES: usize = 2;
        const MOST_LOOKS: usize = 96;
        const STEPS_PX: [f64; 3] = [0.8, 0.4, 0.2];
        const AROUND: [(f64, f64); 4] = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
        /// Of thinner lines the edges are too near each other to tell where within them the middle is.
        const WIDE_PX: f64 = 2.0;
        if self.arms.iter().any(|one| one.arm.width_px < WIDE_PX) {
            return ways;
        }
        let mut looks = 0;
        for step_px in STEPS_PX {
            for (way, place) in places(&ways, MOST_PLACES) {
                let mut direction = 0;
                // Round by round until no direction is better.
                while direction < AROUND.len() && cost > GOOD_PX2 && looks < MOST_LOOKS {
                    let Some(at) = ways.get(way).and_then(|way| way.points.get(place)).copied() else {
                        break;
                    };
                    let step = AROUND.get(direction).copied().unwrap_or_default();
                    let moved = at.along(step, step_px);
                    let mut other = ways.clone();
                    // Ways that share the place move with it.
                    for point in other
                        .iter_mut()
                        .filter(|way| way.points.len() <= MOST_PLACES)
                        .flat_map(|way| &mut way.points)
                    {
                        if *point == at {
                            *point = moved;
                        }
                    }
                    looks += 1;
                    let less = self.cost(&other);
                    if less < 0.8 * cost {
                        (ways, cost, direction) = (other, less, 0);
                    } else {
                        direction += 1;
                    }
                }
            }
        }
        ways
    }

    /// The places of an arm's undisturbed part that lie around the junction, from the inside out.
    fn course(&self, one: &ArmOf) -> Vec<PxPoint> {
        let sites =
            self.arms.iter().position(|arm| arm.end == one.end).and_then(|index| self.sites.get(index));
        let sites = sites.and_then(|sites| sites.get(one.arm.skip..)).unwrap_or(&[]);
        let reach_px = self.radius_px + 0.5 * one.arm.width_px + 1.0;
        sites.iter().map(|site| site.centre).take_while(|at| at.distance(self.centre) <= reach_px).collect()
    }

    /// Notes how far each pixel lies outside of a pen's edge on its way.
    fn draw(&self, field: &mut [f64], from: PxPoint, to: PxPoint, half_px: f64) {
        /// Discs as far apart cover a line 3 px wide but for 0.2 px at its edges, and wider ones better.
        const APART_PX: f64 = 1.5;
        let steps = libm::ceil(from.distance(to) / APART_PX).clamp(1.0, 2.0 * MOST_PX);
        let mut step = 1.0;
        while step <= steps {
            let t = step / steps;
            self.dab(
                field,
                PxPoint::new(from.x + (to.x - from.x) * t, from.y + (to.y - from.y) * t),
                half_px,
            );
            step += 1.0;
        }
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the field")]
    fn dab(&self, field: &mut [f64], at: PxPoint, half_px: f64) {
        let reach_px = half_px + FARTHEST_PX;
        let range = |v: f64, first: u32| {
            let v = v - f64::from(first);
            let from = libm::ceil(v - reach_px - 0.5).clamp(0.0, f64::from(self.side));
            let to = libm::floor(v + reach_px + 0.5).clamp(0.0, f64::from(self.side));
            from as u32..to as u32
        };
        for row in range(at.y, self.top) {
            for column in range(at.x, self.left) {
                let pixel = PxPoint::from(Pixel::new(self.left + column, self.top + row));
                let (x, y) = pixel.minus(at);
                let squared = x * x + y * y;
                if let Some(value) = field.get_mut((row * self.side + column) as usize)
                    && squared < (*value + half_px) * (*value + half_px)
                {
                    *value = libm::sqrt(squared) - half_px;
                }
            }
        }
    }
}

/// The places of ways that have few of them, each once: indices of way and place.
fn places(ways: &[Way], most: usize) -> Vec<(usize, usize)> {
    let mut seen: Vec<PxPoint> = Vec::new();
    let mut found = Vec::new();
    for (index, way) in ways.iter().enumerate().filter(|(_, way)| way.points.len() <= most) {
        for (place, at) in way.points.iter().enumerate() {
            if !seen.contains(at) {
                seen.push(*at);
                found.push((index, place));
            }
        }
    }
    found
}
