//! [`registered`]: where the camera truly is, from the lines that it sees and the map of those seen before.
//!
//! At each place of the map that the window should show, the line is cut across. How far its middle lies from where it should
//! be is one equation for the camera's shift; a straight line says nothing of the shift along it, curves, corners and
//! crossings tell both. The most probable shift, given where the camera should be, is that of least squares with Huber's weights
//! (P. J. Huber, "Robust estimation of a location parameter", 1964) and the prior.

use super::flat::Flat;
use super::line_map::LineMap;
use super::prior::{Information, Prior};
use super::profile::{Cut, across};
use crate::stroke::{PxPoint, PxVec};

/// Most places that are cut.
const MOST_CUTS: usize = 64;

/// Distances beyond this weigh less, px.
const HUBER_PX: f64 = 0.4;

/// Standard deviation of one distance, px.
const CUT_PX: f64 = 0.3;

/// Lines next to each other are off together: more places than this tell no more.
const INDEPENDENT: f64 = 8.0;

/// So far to either side of a place the line is cut for its direction, px.
const ASIDE_PX: f64 = 5.0;

/// Standard deviation of a line's direction. A bend of the map that the line does not have, however small, would tell a place along it,
/// the same one in each picture.
const DIRECTION_SD: f64 = 0.025;

/// What only tells one direction is told of the same one as before when both differ by less than this: sine.
const MOST_TURNED: f64 = 4.0 * DIRECTION_SD;

/// Nearer to the tool than this a place goes by so much of the way to where it is seen: the tool comes there next.
const NEAR_TOOL_PX: f64 = 25.0;
const NEAR_GAIN: f64 = 0.5;

/// Standard deviation of an axis that is told well, px.
const SURE_PX: f64 = 0.25;

/// Where the camera is, and how well that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fix {
    /// The camera's true place.
    pub(super) place: PxPoint,
    /// What the lines tell of it.
    pub(super) told: Information,
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
    normal: PxVec,
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
        self.middle + (place - camera)
    }

    /// Some of the places that the window should show.
    fn places(&self, map: &LineMap, camera: PxPoint) -> Vec<(u32, PxVec)> {
        let margin = 0.5 * self.width_px + 6.0;
        let near: Vec<(u32, PxVec)> = map
            .near(camera, self.reach_px)
            .into_iter()
            .filter(|id| self.flat.holds(self.seen_at(camera, map.at(*id)), margin))
            .filter_map(|id| map.direction(id).map(|way| (id, way.perpendicular())))
            .filter(|(id, _)| !map.is_crowded(*id, 1.2 * self.width_px + 1.0))
            .collect();
        let step = near.len().div_ceil(MOST_CUTS).max(1);
        near.into_iter().step_by(step).collect()
    }

    fn equations(&self, map: &LineMap, places: &[(u32, PxVec)], camera: PxPoint) -> Vec<Equation> {
        let plausible = |cut: &Cut| {
            cut.width_px < 2.5 * self.width_px + 3.0
                && cut.width_px > 0.3 * self.width_px
                && cut.middle_px.abs() < 0.5 * self.width_px + 2.5
        };
        let cut = |at: PxPoint, normal| across(self.flat, at, normal, self.width_px).filter(plausible);
        let equation = |(node, normal): &(u32, PxVec)| {
            let at = self.seen_at(camera, map.at(*node));
            let middle = cut(at, *normal)?;
            let PxVec { x, y } = *normal;
            let beside = [-ASIDE_PX, ASIDE_PX].map(|way| cut(at + PxVec::new(y, -x) * way, *normal));
            // The line's own direction: where the map has a step its nodes have another one.
            let slope = match beside {
                [Some(one), Some(other)] => (other.middle_px - one.middle_px) / (2.0 * ASIDE_PX),
                _ => 0.0,
            };
            let length = libm::hypot(1.0, slope);
            Some(Equation {
                node: *node,
                normal: PxVec::new((x - slope * y) / length, (y + slope * x) / length),
                off_px: middle.middle_px,
                weight: if middle.is_lopsided { 0.0 } else { 1.0 },
            })
        };
        places.iter().filter_map(equation).collect()
    }

    /// Of the camera's places so many whole pixels around, that at which most places of the map are dark; of alike ones the most
    /// probable.
    fn coarse(&self, map: &LineMap, places: &[(u32, PxVec)], prior: &Prior, reach: i32) -> PxPoint {
        let step = usize::try_from((reach / 20).max(1)).unwrap_or(1);
        let count = f64::from(u32::try_from(places.len().max(1)).unwrap_or(u32::MAX));
        let mut best = (f64::NEG_INFINITY, prior.place);
        for dy in (-reach..=reach).step_by(step) {
            for dx in (-reach..=reach).step_by(step) {
                let off = PxVec::new(f64::from(dx), f64::from(dy));
                let moved = prior.place + off;
                let dark: f64 = places
                    .iter()
                    .map(|(id, _)| f64::from(self.flat.at(self.seen_at(moved, map.at(*id)))).clamp(0.0, 1.0))
                    .sum();
                let score = dark / count - 0.01 * prior.off(moved);
                if score > best.0 {
                    best = (score, moved);
                }
            }
        }
        best.1
    }
}

/// The camera's true place, from where it should be; `reach_px` around when nothing fits. Places of the map that
/// are yet to be followed move a little to where they are seen. `None` when the window should show no line.
pub(super) fn registered(map: &mut LineMap, view: &View<'_>, prior: &Prior, reach_px: i32) -> Option<Fix> {
    let places = view.places(map, prior.place);
    if places.is_empty() {
        return None;
    }
    let mut camera = prior.place;
    let mut equations = view.equations(map, &places, camera);
    if 10 * equations.len() < 7 * places.len() && reach_px > 0 {
        let moved = view.coarse(map, &places, prior, reach_px);
        let found = view.equations(map, &places, moved);
        if found.len() > equations.len() {
            (camera, equations) = (moved, found);
        }
    }
    // Found elsewhere than it should be: the prior was wrong.
    let is_elsewhere = !prior.allows(camera);
    let mut told = Information::default();
    for pass in 0..3 {
        if pass > 0 {
            equations = view.equations(map, &places, camera);
        }
        let known = if is_elsewhere {
            Prior { place: camera, information: Information::of_axes([2.0, 2.0]) }
        } else {
            *prior
        };
        let shift;
        (shift, told) = solved(&equations, camera, &known);
        camera += shift;
        if pass > 0 && shift.length() < 0.02 {
            break;
        }
    }
    let expected = places.len();
    let found = equations.len();
    let fix = Fix { place: camera, told, found, expected };
    if !fix.is_lost() {
        for Equation { node, normal, .. } in &equations {
            refine(map, view, *node, *normal, camera);
        }
    }
    Some(fix)
}

/// The most probable shift, and the information on it that the lines carry.
fn solved(equations: &[Equation], camera: PxPoint, prior: &Prior) -> (PxVec, Information) {
    let off = prior.place - camera;
    let (mut shift, mut told) = (PxVec::default(), Information::default());
    for _ in 0..5 {
        let (mut bx, mut by, mut sum) = (0.0, 0.0, 0.0);
        told = Information::default();
        for Equation { normal: PxVec { x: nx, y: ny }, off_px, weight, .. } in equations {
            let rest = off_px + nx * shift.x + ny * shift.y;
            let weight = weight * if rest.abs() > HUBER_PX { HUBER_PX / rest.abs() } else { 1.0 };
            told =
                told.plus(Information { xx: weight * nx * nx, xy: weight * nx * ny, yy: weight * ny * ny });
            bx -= weight * nx * off_px;
            by -= weight * ny * off_px;
            sum += weight;
        }
        let scale = (INDEPENDENT / f64::max(sum, 1e-9)).min(1.0) / (CUT_PX * CUT_PX);
        (told, PxVec { x: bx, y: by }) =
            told.without_noise(PxVec::new(bx, by), DIRECTION_SD * DIRECTION_SD, sum);
        told = told.scaled(scale);
        let before = prior.information.turned(told, MOST_TURNED);
        let PxVec { x: px, y: py } = before.times(off);
        shift = told.plus(before).solve(PxVec::new(scale * bx + px, scale * by + py));
    }
    (shift, told)
}

/// Which of both axes are told well.
pub(super) fn sure(told: Information) -> [bool; 2] {
    told.axis_sd().map(|sd| sd < SURE_PX)
}

/// Moves a node to where its line is seen, the less the more often it was seen.
fn refine(map: &mut LineMap, view: &View<'_>, node: u32, normal: PxVec, camera: PxPoint) {
    let Some((at, seen)) = map.node(node).map(|node| (node.at, node.seen)) else { return };
    let is_ahead = map.links_of(node).any(|(_, link, _)| link.state == super::line_map::State::Ahead);
    // What goes on from an end that no window has shown may turn there, and its ink is then beside this line's.
    if !is_ahead || map.is_near_open_end(node, 1.2 * view.width_px + 1.0) {
        return;
    }
    let Some(cut) = across(view.flat, view.seen_at(camera, at), normal, view.width_px) else { return };
    if cut.is_lopsided || cut.middle_px.abs() > 0.4 * view.width_px {
        return;
    }
    // Ink as wide as the line is one line: then it is where it is seen.
    if cut.width_px < 1.2 * view.width_px + 0.6 && at.distance(camera) < NEAR_TOOL_PX {
        map.shift(node, at + normal * (NEAR_GAIN * cut.middle_px));
    } else if cut.width_px < 1.6 * view.width_px + 1.5 {
        map.shift(node, at + normal * (cut.middle_px / f64::from(seen.min(8) + 1)));
    }
}

#[cfg(test)]
mod tests {
    use super::super::lines::Piece;
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    #[test]
    fn a_line_that_goes_on_unseen_stays_straight_up_to_there() {
        // A tip of 40 degrees at (100, 100), of which windows have shown one arm up to 2 px before it.
        let tip = PxPoint::new(100.0, 100.0);
        let arm = |PxVec { x, y }: PxVec| (vec![tip, tip + PxVec::new(x, y) * 90.0], 5.0);
        let paper =
            Paper::drawn(200, 200, &[arm(PxVec::new(-1.0, 0.0)), arm(PxVec::new(-0.766, 0.643))]).unwrap();
        let settings = CameraSettings { width_px: 200, height_px: 200, ..CameraSettings::default() };
        let mut camera = SimulatedCamera::new(&paper, settings);
        let places = (0..40).map(|i| PxPoint::new(20.0 + 2.0 * f64::from(i), 100.0)).collect();
        let mut map = LineMap::default();
        map.insert(&[Piece { places, closed: false, open: [false, true] }], 5.0, &|_| true);
        let (at, middle) = (PxPoint::new(85.0, 95.0), PxPoint::new(100.0, 100.0));
        for _ in 0..6 {
            let flat = Flat::of(&camera.window(at), None, None);
            let view = View { flat: &flat, middle, width_px: 5.0, reach_px: 92.0 };
            let prior = Prior { place: at, information: Information::of_axes([0.1; 2]) };
            registered(&mut map, &view, &prior, 0);
        }
        let off = map.nodes.iter().map(|node| (node.at.y - 100.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.3, "{off}");
    }

    /// How far a camera is held back that goes along a straight line by what the map has of it: a place for each x, px.
    fn held_px(place: impl Fn(f64) -> PxPoint) -> f64 {
        let line = vec![PxPoint::new(-50.0, 100.0), PxPoint::new(700.0, 100.0)];
        let paper = Paper::drawn(600, 200, &[(line, 5.0)]).unwrap();
        let settings = CameraSettings { width_px: 200, height_px: 200, ..CameraSettings::default() };
        let mut camera = SimulatedCamera::new(&paper, settings);
        let places = (0..200).map(|i| place(100.0 + 2.0 * f64::from(i))).collect();
        let mut map = LineMap::default();
        map.insert(&[Piece { places, closed: false, open: [true, true] }], 5.0, &|_| true);
        let middle = PxPoint::new(100.0, 100.0);
        let (mut off, mut greatest) = (0.0_f64, 0.0_f64);
        for i in 0..40_u8 {
            let at = PxPoint::new(260.0 + 2.0 * f64::from(i), 100.0);
            let flat = Flat::of(&camera.window(at), None, None);
            let view = View { flat: &flat, middle, width_px: 5.0, reach_px: 92.0 };
            let prior =
                Prior { place: at + PxVec::new(off, 0.1), information: Information::of_axes([1.8, 0.06]) };
            off = registered(&mut map.clone(), &view, &prior, 0).unwrap().place.x - at.x;
            greatest = greatest.max(off.abs());
        }
        greatest
    }

    #[test]
    fn a_bend_that_only_the_map_has_does_not_hold_the_camera() {
        // By a degree at 300 px.
        let held = held_px(|x| PxPoint::new(x, 100.0 + 0.0175 * (x - 300.0).max(0.0)));
        assert!(held < 0.5, "{held}");
    }

    #[test]
    fn a_step_that_only_the_map_has_does_not_hold_the_camera() {
        let held = held_px(|x| PxPoint::new(x, if x > 300.0 { 97.7 } else { 100.0 }));
        assert!(held < 0.5, "{held}");
    }
}
