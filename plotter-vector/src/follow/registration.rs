//! [`registered`]: where the camera truly is, from the lines that it sees and the map of those seen before.
//!
//! At each place of the map that the window should show, the line is cut across. How far its middle lies from where it should
//! be is one equation for the camera's shift; a straight line says nothing of the shift along it, curves, corners and
//! crossings tell both. Least squares with Huber's weights (P. J. Huber, "Robust estimation of a location parameter", 1964)
//! take the shift, less of it in a direction of which little is told.

use super::flat::Flat;
use super::line_map::LineMap;
use super::profile::{Cut, across};
use crate::PxPoint;

/// Most places that are cut.
const MOST_CUTS: usize = 64;

/// Distances beyond this weigh less, px.
const HUBER_PX: f64 = 0.4;

/// What as many places tell counts half: less is mostly what the rims near other lines pretend.
const HALF: f64 = 1.0;

/// So many places tell an axis well.
const SURE: f64 = 2.5;

/// Where the camera is, and how well that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fix {
    /// The camera's true place.
    pub(super) place: PxPoint,
    /// Whether x and y are told by lines.
    pub(super) is_sure: [bool; 2],
    /// Places where a line was found, and all where one should be.
    pub(super) found: usize,
    pub(super) expected: usize,
}

impl Fix {
    /// Whether what is seen is not what should be here.
    pub(super) fn is_lost(&self) -> bool {
        self.expected >= 4 && 3 * self.found < self.expected
    }
}

/// One equation: a node, the normal of its line, and how far the line lies along it.
struct Equation {
    node: u32,
    normal: (f64, f64),
    off_px: f64,
    /// 1, or 0 where another line is so near that it moves the rim.
    weight: f64,
}

/// What a window is compared with.
pub(super) struct View<'a> {
    pub(super) flat: &'a Flat,
    /// The window's middle, in its own pixels.
    pub(super) middle: PxPoint,
    pub(super) width_px: f64,
    /// How far from the middle places are compared, px.
    pub(super) reach_px: f64,
}

impl View<'_> {
    fn seen_at(&self, camera: PxPoint, place: PxPoint) -> PxPoint {
        self.middle.along(place.minus(camera), 1.0)
    }

    /// Some of the places that the window should show.
    fn places(&self, map: &LineMap, camera: PxPoint) -> Vec<(u32, (f64, f64))> {
        let margin = 0.5 * self.width_px + 6.0;
        let near: Vec<(u32, (f64, f64))> = map
            .near(camera, self.reach_px)
            .into_iter()
            .filter(|id| self.flat.holds(self.seen_at(camera, map.at(*id)), margin))
            .filter_map(|id| map.direction(id).map(|(x, y)| (id, (-y, x))))
            .collect();
        let step = near.len().div_ceil(MOST_CUTS).max(1);
        near.into_iter().step_by(step).collect()
    }

    fn equations(&self, map: &LineMap, places: &[(u32, (f64, f64))], camera: PxPoint) -> Vec<Equation> {
        let plausible = |cut: &Cut| {
            cut.width_px < 2.5 * self.width_px + 3.0
                && cut.width_px > 0.3 * self.width_px
                && cut.middle_px.abs() < 0.5 * self.width_px + 2.5
        };
        let equation = |(node, normal): &(u32, (f64, f64))| {
            let cut = across(self.flat, self.seen_at(camera, map.at(*node)), *normal, self.width_px);
            cut.filter(plausible).map(|cut| Equation {
                node: *node,
                normal: *normal,
                off_px: cut.middle_px,
                weight: if cut.is_lopsided { 0.0 } else { 1.0 },
            })
        };
        places.iter().filter_map(equation).collect()
    }

    /// The shift of the camera, whole pixels, at which most places of the map are dark.
    fn coarse(&self, map: &LineMap, places: &[(u32, (f64, f64))], camera: PxPoint, reach: i32) -> PxPoint {
        let step = (reach / 20).max(1);
        let mut best = (f32::NEG_INFINITY, camera);
        for dy in (-reach..=reach).step_by(usize::try_from(step).unwrap_or(1)) {
            for dx in (-reach..=reach).step_by(usize::try_from(step).unwrap_or(1)) {
                let moved = PxPoint::new(camera.x + f64::from(dx), camera.y + f64::from(dy));
                let dark: f32 = places
                    .iter()
                    .map(|(id, _)| self.flat.at(self.seen_at(moved, map.at(*id))).clamp(0.0, 1.0))
                    .sum();
                #[expect(
                    clippy::cast_precision_loss,
                    clippy::cast_possible_truncation,
                    reason = "small numbers"
                )]
                let score = dark / places.len().max(1) as f32
                    - 0.004 * libm::hypot(f64::from(dx), f64::from(dy)) as f32;
                if score > best.0 {
                    best = (score, moved);
                }
            }
        }
        best.1
    }
}

/// The camera's true place, from where it should be; `far` looks up to 40 px around when nothing fits. Places of the map that
/// are yet to be followed move a little to where they are seen. `None` when the window should show no line.
pub(super) fn registered(map: &mut LineMap, view: &View<'_>, predicted: PxPoint, far: bool) -> Option<Fix> {
    let places = view.places(map, predicted);
    if places.is_empty() {
        return None;
    }
    let mut camera = predicted;
    let mut equations = view.equations(map, &places, camera);
    if 10 * equations.len() < 7 * places.len() {
        for reach in [8, 40] {
            if reach == 40 && (!far || 3 * equations.len() >= places.len()) {
                break;
            }
            let moved = view.coarse(map, &places, camera, reach);
            let found = view.equations(map, &places, moved);
            if found.len() > equations.len() {
                (camera, equations) = (moved, found);
            }
        }
    }
    let mut information = [0.0; 3];
    for pass in 0..3 {
        if pass > 0 {
            equations = view.equations(map, &places, camera);
        }
        let shift;
        (shift, information) = solved(&equations);
        camera = camera.along(shift, 1.0);
        if pass > 0 && libm::hypot(shift.0, shift.1) < 0.02 {
            break;
        }
    }
    let expected = places.len();
    let found = equations.len();
    let fix = Fix { place: camera, is_sure: sure(information), found, expected };
    if !fix.is_lost() {
        for Equation { node, normal, .. } in &equations {
            refine(map, view, *node, *normal, camera);
        }
    }
    Some(fix)
}

/// The shift that explains the distances best, and the information on it.
fn solved(equations: &[Equation]) -> ((f64, f64), [f64; 3]) {
    let mut shift = (0.0, 0.0);
    let mut sums = [0.0; 3];
    for _ in 0..5 {
        let (mut xx, mut xy, mut yy, mut bx, mut by) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for Equation { normal: (nx, ny), off_px, weight, .. } in equations {
            let rest = off_px + nx * shift.0 + ny * shift.1;
            let weight = weight * if rest.abs() > HUBER_PX { HUBER_PX / rest.abs() } else { 1.0 };
            xx += weight * nx * nx;
            xy += weight * nx * ny;
            yy += weight * ny * ny;
            bx -= weight * nx * off_px;
            by -= weight * ny * off_px;
        }
        // Along the direction told best, and across it.
        let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
        let (u, v) = (libm::cos(angle), libm::sin(angle));
        let part = |u: f64, v: f64| {
            let told = u * u * xx + 2.0 * u * v * xy + v * v * yy;
            // Less than half a place tells nothing.
            if told < 0.5 { 0.0 } else { (u * bx + v * by) * told / (told * told + HALF * HALF) }
        };
        let (along, across) = (part(u, v), part(-v, u));
        shift = (along * u - across * v, along * v + across * u);
        sums = [xx, xy, yy];
    }
    (shift, sums)
}

/// Which of both axes are told, whatever the other one is.
fn sure([xx, xy, yy]: [f64; 3]) -> [bool; 2] {
    [xx - xy * xy / yy.max(1e-9) > SURE, yy - xy * xy / xx.max(1e-9) > SURE]
}

/// Moves a node to where its line is seen, the less the more often it was seen.
fn refine(map: &mut LineMap, view: &View<'_>, node: u32, normal: (f64, f64), camera: PxPoint) {
    let Some((at, seen)) = map.node(node).map(|node| (node.at, node.seen)) else { return };
    let is_ahead = map.links_of(node).any(|(_, link, _)| link.state == super::line_map::State::Ahead);
    if !is_ahead {
        return;
    }
    let Some(cut) = across(view.flat, view.seen_at(camera, at), normal, view.width_px) else { return };
    if !cut.is_lopsided && cut.middle_px.abs() < 1.0 && cut.width_px < 1.6 * view.width_px + 1.5 {
        let gain = 1.0 / f64::from(seen.min(8) + 1);
        map.shift(node, at.along(normal, gain * cut.middle_px));
    }
}
