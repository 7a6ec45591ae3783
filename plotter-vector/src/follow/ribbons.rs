//! [`fitted`]: lines lie where their ink, drawn together and blurred, is that of the window.
//!
//! A cut across shows the middle of a line only where paper is on both sides of it. Where two lines run into each other, at a small
//! angle or side by side, one rim of each is left; where one lies on the other, none. So each line is a ribbon: the ink of all is
//! drawn and blurred as the camera does it, and where the window is darker or lighter it moves the rims that no other line covers. A
//! line follows its rims smoothly, and goes on with its curvature where it has none.
//!
//! After M. Kass, A. Witkin, D. Terzopoulos, "Snakes: active contour models" (1988), and, for ribbons, P. Fua and Y. G. Leclerc, "Model
//! driven edge detection" (1990). How far a rim is off follows from the blur: a line of darkness d whose rim is moved by s changes the window
//! by d·s times the blur's bell, the squares of which are 1/(2·√π·blur) in sum.

use super::centred::{TURN_PLACES, turns};
use super::crowd::Crowd;
use super::flat::Flat;
use super::ink_map::{BLUR_PX, InkMap};
use super::lines::{CORNER_COS, SPACING_PX, cosine, count_f64};
use crate::stroke::{PxPoint, PxVec};
use core::ops::Range;
use std::f64::consts::{PI, SQRT_2};

/// Rounds of drawing and moving; none follows one in which no place moved farther, px.
const ROUNDS: usize = 8;
const SETTLED_PX: f64 = 0.08;

/// A place moves no farther in a round, and a line's half width changes by no more, px.
const MOST_PX: f64 = 0.8;
const MOST_WIDER_PX: f64 = 0.3;

/// How well a width must be known to be changed, in darknesses per px: a few places with both rims.
const LEAST_KNOWN: f64 = 4.0;

/// Half of the thinnest line, px.
const THINNEST_PX: f64 = 0.2;

/// Weights of a place of which no rim is seen, of each rim, and of a place in a sharp turn, which is told otherwise and stays.
const BLIND: f64 = 1e-3;
const RIM: f64 = 0.5;
const STAYS: f64 = 3.0;

/// A place that weighs less is hidden under other lines.
const HIDDEN: f64 = 0.05;

/// A rim is seen if other lines' ink is so far away, px.
const CLEAR_PX: f64 = 1.0;

/// Beside another line's end, and so far from its ink, there may be ink that it leaves unexplained, px.
const ENDS_PX: f64 = 1.0;

/// Places of a loop before its first and behind its last one that are looked at again.
const AROUND: usize = 12;

/// What a pen leaves along a line.
#[derive(Clone, Debug)]
struct Ribbon {
    /// Half of its width at each place, px; the same from corner to corner.
    halves_px: Vec<f64>,
    dark: f64,
}

/// The share of a line's darkness that blur leaves in its middle.
fn left_in_middle(half_px: f64) -> f64 {
    libm::erf(half_px / (SQRT_2 * BLUR_PX))
}

impl Ribbon {
    /// Of a line, by the width that it shows at half of its darkness. Full ink has a darkness of `full`.
    fn of(flat: &Flat, places: &[PxPoint], width_px: f64, full: f64) -> Self {
        let dark = ranked(places.iter().map(|at| f64::from(flat.at(*at))), 0.5).unwrap_or(full);
        let ribbon = |half_px: f64, dark: f64| Self { halves_px: vec![half_px; places.len()], dark };
        if width_px > 3.0 * BLUR_PX {
            return ribbon(0.5 * width_px, dark / left_in_middle(0.5 * width_px));
        }
        // Of a thin line blur leaves the width, and takes the darkness.
        let (mut thin, mut wide) = (THINNEST_PX, 2.0 * BLUR_PX);
        for _ in 0..24 {
            let middle = f64::midpoint(thin, wide);
            if full * left_in_middle(middle) < dark { thin = middle } else { wide = middle }
        }
        ribbon(thin, full)
    }

    fn half_px(&self, number: usize) -> f64 {
        self.halves_px.get(number).copied().unwrap_or(THINNEST_PX)
    }

    /// Its width in the mean, px.
    fn width_px(&self) -> f64 {
        2.0 * self.halves_px.iter().sum::<f64>() / count_f64(self.halves_px.len().max(1))
    }
}

/// The number that a share of all are below.
fn ranked(numbers: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let rank = super::whole::count(share * count_f64(sorted.len().saturating_sub(1)));
    sorted.get(rank).copied()
}

/// Puts lines, whose places are about 2 px from each other, where they explain the window best. Widths are those that they show, px.
pub(super) fn fitted(flat: &Flat, lines: &mut Vec<Vec<PxPoint>>, widths_px: &[f64]) {
    let darks = lines.iter().flatten().map(|at| f64::from(flat.at(*at)));
    let full = ranked(darks, 0.98).unwrap_or(1.0).max(0.1);
    let ribbon = |(places, width_px): (&Vec<PxPoint>, &f64)| Ribbon::of(flat, places, *width_px, full);
    let mut ribbons: Vec<Ribbon> = lines.iter().zip(widths_px).map(ribbon).collect();
    let (mut missing, mut left) = unexplained(flat, lines, &ribbons);
    for _ in 0..ROUNDS {
        missing.blur();
        let widths_px: Vec<f64> = ribbons.iter().map(Ribbon::width_px).collect();
        let crowd = Crowd::of(lines, &widths_px, flat.size(), CLEAR_PX);
        let ends: Vec<Vec<PxPoint>> = lines.iter().map(|places| ends(places)).collect();
        let ends = Crowd::of(&ends, &widths_px, flat.size(), ENDS_PX);
        let work = Work { flat, lines, crowd: &crowd, ends: &ends, missing: &missing };
        let moved: Vec<(Vec<PxPoint>, Ribbon)> =
            ribbons.iter().enumerate().map(|(line, ribbon)| work.moved(line, ribbon)).collect();
        let (next, next_ribbons): (Vec<_>, Vec<_>) = moved.into_iter().unzip();
        let (next_missing, next_left) = unexplained(flat, &next, &next_ribbons);
        if next_left >= left {
            break;
        }
        let places = lines.iter().flatten().zip(next.iter().flatten());
        let is_last = places.map(|(one, other)| one.distance(*other)).fold(0.0, f64::max) < SETTLED_PX;
        (*lines, ribbons, missing, left) = (next, next_ribbons, next_missing, next_left);
        if is_last {
            break;
        }
    }
}

/// The first and the last place of a line that is no loop.
fn ends(places: &[PxPoint]) -> Vec<PxPoint> {
    let ends = places.first().into_iter().chain(places.last());
    ends.filter(|_| places.first() != places.last()).copied().collect()
}

/// The stretches of a line from corner to corner, each with the corner that ends it.
fn stretches(is_corner: &[bool]) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut end = 0;
    is_corner.split_inclusive(|corner| *corner).map(move |stretch| {
        let first = end;
        end += stretch.len();
        first..end
    })
}

/// What the window shows more than the lines, and the sum of its squares.
fn unexplained(flat: &Flat, lines: &[Vec<PxPoint>], ribbons: &[Ribbon]) -> (InkMap, f64) {
    let mut map = InkMap::of(flat);
    for (places, ribbon) in lines.iter().zip(ribbons) {
        for (number, pair) in places.windows(2).enumerate() {
            if let [from, to] = pair {
                let half_px = f64::midpoint(ribbon.half_px(number), ribbon.half_px(number + 1));
                map.draw(*from, *to, half_px, ribbon.dark);
            }
        }
    }
    map.blur();
    let left = map.taken_from(flat);
    (map, left)
}

/// What lines are moved by.
struct Work<'a> {
    flat: &'a Flat,
    lines: &'a [Vec<PxPoint>],
    crowd: &'a Crowd<'a>,
    /// The ends of those that are no loops.
    ends: &'a Crowd<'a>,
    missing: &'a InkMap,
}

impl Work<'_> {
    /// A line after a round, and what its pen leaves.
    fn moved(&self, line: usize, ribbon: &Ribbon) -> (Vec<PxPoint>, Ribbon) {
        let places = self.lines.get(line).map_or(&[][..], Vec::as_slice);
        if places.len() < 4 {
            return (places.to_vec(), ribbon.clone());
        }
        // A loop is gone on around at both of its ends.
        let is_loop = places.first() == places.last();
        let once = places.len() - usize::from(is_loop);
        let around = if is_loop { AROUND.min(once) } else { 0 };
        let numbers: Vec<usize> = (once - around..once).chain(0..once).chain(0..around).collect();
        let all: Vec<PxPoint> = numbers.iter().filter_map(|i| places.get(*i)).copied().collect();

        let norm = ribbon.dark / (2.0 * libm::sqrt(PI) * BLUR_PX);
        // Of a short loop the other side is not behind a turn.
        let is_short = is_loop && once <= 2 * TURN_PLACES;
        let long = places.get(..once).filter(|_| !is_short).unwrap_or(&[]);
        let in_turn = turns(long, ribbon.width_px());
        let (mut targets, mut weights) = (all.clone(), vec![BLIND; all.len()]);
        let mut is_corner = vec![false; all.len()];
        // How much wider each place shows to be, and how well that is known.
        let mut wider = vec![[0.0; 2]; all.len()];
        for (k, number) in numbers.iter().enumerate() {
            let before = all.get(k.saturating_sub(1)).copied();
            let behind = all.get(k + 1).or(all.last()).copied();
            let (Some(before), Some(at), Some(behind)) = (before, all.get(k).copied(), behind) else { break };
            let turns = before != at && at != behind && cosine(at - before, behind - at) < CORNER_COS;
            if let Some(corner) = is_corner.get_mut(k) {
                *corner = turns;
            }
            let Some(weight) = weights.get_mut(k) else { break };
            if in_turn.get(*number) == Some(&true) {
                *weight = STAYS;
                continue;
            }
            let PxVec { x, y } = behind - before;
            let length = libm::hypot(x, y);
            if turns || length < 1e-9 || self.ends.is_near(line, at) {
                continue;
            }
            let normal = PxVec::new(-y / length, x / length);
            let half_px = ribbon.half_px(*number);
            let shared = libm::exp(-(half_px * half_px) / (BLUR_PX * BLUR_PX));
            let rims = [1.0, -1.0].map(|side| at + normal * (side * half_px));
            let [one, other] =
                rims.map(|rim| self.seen(rim, (line, *number), half_px, is_loop.then_some(once)));
            let [darker, other_darker] = rims.map(|rim| self.missing.at(rim));
            let both = one * one + other * other;
            let stiffness = norm * (both - 2.0 * one * other * shared);
            if both < 0.05 || stiffness < 1e-3 {
                continue;
            }
            if let Some(wider) = wider.get_mut(k) {
                *wider = [one * darker + other * other_darker, norm * (both + 2.0 * one * other * shared)];
            }
            let by = ((one * darker - other * other_darker) / stiffness).clamp(-MOST_PX, MOST_PX);
            *weight = BLIND + RIM * both;
            if let Some(target) = targets.get_mut(k) {
                *target = at + normal * by;
            }
        }
        let is_hidden: Vec<bool> = weights.iter().map(|weight| *weight < BLIND + HIDDEN).collect();
        for (k, corner) in super::bends::bends(self.flat, &targets, &is_hidden, ribbon.width_px()) {
            if let (Some(target), Some(weight), Some(turns)) =
                (targets.get_mut(k), weights.get_mut(k), is_corner.get_mut(k))
            {
                (*target, *weight, *turns) = (corner, 2.0 * RIM, true);
            }
        }
        let found = super::stiff::stiff(&targets, &weights, &is_corner);
        let mut found = found.get(around..around + once).unwrap_or(places).to_vec();
        if is_loop {
            found.extend(found.first().copied());
        }
        let mut halves_px = ribbon.halves_px.clone();
        let sum =
            |sums: &[[f64; 2]]| sums.iter().fold([0.0; 2], |sum, more| [sum[0] + more[0], sum[1] + more[1]]);
        let all_wider = sum(&wider);
        for stretch in stretches(&is_corner) {
            let own = sum(wider.get(stretch.clone()).unwrap_or(&[]));
            let [wider, known] = if own[1] > LEAST_KNOWN { own } else { all_wider };
            let wider = if known > 0.0 { wider / known } else { 0.0 };
            for number in numbers.get(stretch).unwrap_or(&[]) {
                if let Some(half_px) = halves_px.get_mut(*number) {
                    *half_px = (ribbon.half_px(*number) + wider.clamp(-MOST_WIDER_PX, MOST_WIDER_PX))
                        .max(THINNEST_PX);
                }
            }
        }
        if is_loop && let (Some(first), Some(last)) = (halves_px.first().copied(), halves_px.last_mut()) {
            *last = first;
        }
        (found, Ribbon { halves_px, dark: ribbon.dark })
    }

    /// How much of the rim beside a place of a line, by line and number, is seen, from 0 to 1. A loop has so many places around.
    fn seen(&self, rim: PxPoint, (line, number): (usize, usize), half_px: f64, around: Option<usize>) -> f64 {
        let is_own = |other: usize, index: usize| {
            let apart = index.abs_diff(number);
            let apart = around.map_or(apart, |around| apart.min(around.saturating_sub(apart)));
            other == line && SPACING_PX * count_f64(apart) < 6.0 * (half_px + 1.0)
        };
        (self.crowd.outside_px(rim, is_own) / CLEAR_PX).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::lines::resampled;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};
    use std::f64::consts::TAU;

    #[test]
    fn a_ring_is_put_in_its_place_and_stays_closed() {
        for radius_px in [7.0, 40.0] {
            let middle = PxPoint::new(150.2, 149.7);
            let ring = |radius_px: f64| -> Vec<PxPoint> {
                let on = |k: u8| TAU * f64::from(k % 120) / 120.0;
                let at = |k| middle + PxVec::new(libm::cos(on(k)), libm::sin(on(k))) * radius_px;
                (0..=120).map(at).collect()
            };
            let paper = Paper::drawn(300, 300, &[(ring(radius_px), 5.0)]).unwrap();
            let window =
                SimulatedCamera::new(&paper, CameraSettings::default()).window(PxPoint::new(150.0, 150.0));
            let mut lines = vec![resampled(&ring(radius_px + 1.2), SPACING_PX)];
            fitted(&Flat::of(&window, None, None), &mut lines, &[5.0]);
            let off_px = |at: &PxPoint| (at.distance(middle) - radius_px).abs();
            assert!(lines.iter().flatten().all(|at| off_px(at) < 0.3), "{radius_px}: {lines:?}");
            assert_eq!(lines[0].first(), lines[0].last());
        }
    }
}
