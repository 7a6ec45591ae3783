//! [`Trial`]: the lines of a junction drawn again, and held against the ink.
//!
//! The arms of a junction can be taken to go on in several ways. A pen of each line's width that goes these ways must
//! leave the ink that is there.

use super::arm::are_of_two_pens;
use super::connection::Way;
use super::junction::ArmOf;
use super::site::{Scan, Site};
use crate::centreline::fit::prices::{self, RASTER_PX2, WIDE_PX};
use crate::centreline::fit::search::{distinct, settle, shifted};
use crate::centreline::fit::{Canvas, Capsule, Layer};
use crate::stroke::PxPoint;
use std::borrow::Cow;

/// The ink around a junction.
pub(super) struct Trial<'a> {
    arms: &'a [ArmOf],
    radius_px: f64,
    /// Where the undisturbed part of each arm begins; of one without such a part its origin.
    roots: Vec<Option<PxPoint>>,
    canvas: Canvas,
    /// The undisturbed parts of the arms, which all plans share.
    courses: Layer,
}

impl<'a> Trial<'a> {
    /// For a junction, with the sites of each arm from the junction out; none when it is too large to be drawn again.
    pub(super) fn new(
        scan: Scan<'_>,
        centre: PxPoint,
        arms: &'a [ArmOf],
        sites: &[Cow<'_, [Site]>],
    ) -> Option<Self> {
        let far = |(one, sites): (&ArmOf, &Cow<'_, [Site]>)| {
            let first = sites.get(one.arm.skip).or(sites.last())?;
            Some(first.centre.distance(centre) + 0.5 * one.arm.width_px + 2.0)
        };
        Self::within(scan, centre, arms.iter().zip(sites).filter_map(far).fold(0.0, f64::max), arms, sites)
    }

    /// The same, for what lies within a radius.
    pub(super) fn within(
        scan: Scan<'_>,
        centre: PxPoint,
        radius_px: f64,
        arms: &'a [ArmOf],
        sites: &[Cow<'_, [Site]>],
    ) -> Option<Self> {
        let canvas = Canvas::around(scan, centre, radius_px)?;
        let (mut roots, mut courses) = (Vec::new(), Vec::new());
        for (one, sites) in arms.iter().zip(sites) {
            // The sites of the undisturbed part that lie around the junction, from the inside out.
            let half_px = 0.5 * one.arm.width_px;
            let reach_px = radius_px + half_px + 1.0;
            let places = sites.get(one.arm.skip..).unwrap_or(&[]).iter().map(|site| site.centre);
            let mut course = places.take_while(|at| at.distance(centre) <= reach_px).peekable();
            let all_disturbed = one.arm.skip >= sites.len();
            roots.push(course.peek().copied().or(all_disturbed.then_some(one.arm.origin)));
            canvas.add_pen(course.map(|at| (at, half_px)), &mut courses);
        }
        let courses = canvas.layer(&courses);
        Some(Self { arms, radius_px, roots, canvas, courses })
    }

    /// How far from the junction's middle ink is looked at, px.
    pub(super) fn radius_px(&self) -> f64 {
        self.radius_px
    }

    /// How much the ink around the junction differs from what pens draw that go these ways, when that is less than
    /// `limit`: the squared distances of all pixels whose centres are on the wrong side of the
    /// lines' edges, px².
    pub(super) fn cost(&self, ways: &[Way], limit: f64) -> Option<f64> {
        let mut pens: Vec<Capsule> = Vec::new();
        for Way { one, other, points } in ways {
            let width_px = one.arm.width_px;
            let theirs = other.map_or(width_px, |other| other.arm.width_px);
            let count = points.len().max(1);
            // Lines of two pens that meet in a point come to it as wide as they are.
            let meet = count == 1 && are_of_two_pens(width_px, theirs);
            let inner = points.iter().enumerate().flat_map(|(index, at)| {
                // Else from one line's width to the other's.
                #[expect(clippy::cast_precision_loss, reason = "a few points")]
                let t = (index as f64 + 0.5) / count as f64;
                let one_px = if meet { width_px } else { width_px + (theirs - width_px) * t };
                [Some((*at, one_px)), meet.then_some((*at, theirs))].into_iter().flatten()
            });
            let from = self.root(one).map(|at| (at, width_px));
            let to = other.and_then(|other| self.root(&other)).map(|at| (at, theirs));
            let way = from.into_iter().chain(inner).chain(to);
            self.canvas.add_pen(way.map(|(at, width_px)| (at, 0.5 * width_px)), &mut pens);
        }
        self.canvas.residual(&self.courses, &pens, limit)
    }

    /// Where an arm's undisturbed part begins.
    fn root(&self, one: &ArmOf) -> Option<PxPoint> {
        let index = self.arms.iter().position(|arm| arm.end == one.end)?;
        self.roots.get(index).copied().flatten()
    }

    /// The ways with their few places moved to where they cost least, from `cost` down, and what they cost
    /// there.
    pub(super) fn settle(&self, ways: Vec<Way>, cost: f64) -> (Vec<Way>, f64) {
        /// Ways with more places are curves.
        const MOST_PLACES: usize = 2;
        const MOST_LOOKS: usize = 96;
        if self.arms.iter().any(|one| one.arm.width_px < WIDE_PX) {
            return (ways, cost);
        }
        let few = |ways: &[Way]| {
            distinct(
                ways.iter().filter(|way| way.points.len() <= MOST_PLACES).flat_map(|way| way.points.clone()),
            )
        };
        // Ways that share the place move with it.
        let moved = |mut ways: Vec<Way>, from: PxPoint, to: PxPoint| {
            let few = ways.iter_mut().filter(|way| way.points.len() <= MOST_PLACES);
            few.flat_map(|way| &mut way.points).filter(|at| **at == from).for_each(|at| *at = to);
            ways
        };
        let mut looks = 0;
        let mut fit = (ways, cost);
        settle(
            &mut fit,
            1,
            |(ways, _)| few(ways),
            |(ways, cost), start, step_px| {
                let (at, less) = shifted(start, step_px, *cost, |to, cost| {
                    if cost <= RASTER_PX2 || looks >= MOST_LOOKS {
                        return None;
                    }
                    looks += 1;
                    self.cost(&moved(ways.clone(), start, to), prices::step(cost))
                });
                *ways = moved(core::mem::take(ways), start, at);
                *cost = less;
                at != start
            },
        );
        fit
    }
}
