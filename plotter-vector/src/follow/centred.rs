//! [`centred`]: places of a thinned line are put into the middle between its rims, and its corners where its straight parts meet.
//!
//! Thinning rounds corners, is drawn into the foot of a tee, and cuts the inside of narrow turns. Where a cut across shows one line,
//! its middle counts; what lies between two such parts is straight if they are on one line, and a corner if their lines meet here.

use super::flat::Flat;
use super::lines::cosine;
use super::profile::across;
use crate::PxPoint;

/// A place that moves farther than this, as a share of the line's width, is on another line.
const FARTHEST_SHARE: f64 = 0.5;

/// Ink wider than this share of the line's width, and 0.8 px, is more than one line.
const ONE_LINE: f64 = 1.2;

/// A part between two others is straight when they turn by less: cosine of 12 degrees.
const STRAIGHT_COS: f64 = 0.978;

/// A corner turns by more: cosine of 35 degrees.
const CORNER_COS: f64 = 0.82;

/// Puts the places of a line, about 2 px from each other, into its middle; the first and the last stay.
pub(super) fn centred(flat: &Flat, places: &mut [PxPoint], width_px: f64) {
    let mut is_sound = vec![false; places.len()];
    for _ in 0..2 {
        let before = places.to_vec();
        for (i, three) in before.windows(3).enumerate() {
            let &[a, at, b] = three else { continue };
            let (x, y) = b.minus(a);
            let length = libm::hypot(x, y);
            if length < 1.0 || cosine(at.minus(a), b.minus(at)) < CORNER_COS {
                continue;
            }
            let normal = (-y / length, x / length);
            let Some(cut) = across(flat, at, normal, width_px) else { continue };
            let is_one = cut.width_px < ONE_LINE * width_px + 0.8 && !cut.is_lopsided;
            if is_one && cut.middle_px.abs() < FARTHEST_SHARE * width_px {
                if let Some(place) = places.get_mut(i + 1) {
                    *place = at.along(normal, 0.8 * cut.middle_px);
                }
                if let Some(sound) = is_sound.get_mut(i + 1) {
                    *sound = true;
                }
            }
        }
    }
    bridge(places, &is_sound, width_px);
    sharpen(places, width_px);
}

/// Runs of places that are no line of their own, over a crossing or the foot of a tee, go straight on.
fn bridge(places: &mut [PxPoint], is_sound: &[bool], width_px: f64) {
    let sound = |i: usize| is_sound.get(i).copied().unwrap_or(false);
    let mut i = 4;
    while i < places.len() {
        if sound(i) || !sound(i - 1) {
            i += 1;
            continue;
        }
        let end = (i..places.len()).find(|j| sound(*j)).unwrap_or(places.len());
        // The neighbours of a foot lean to it already.
        let (first, last) = (i - 2, end + 1);
        if let (Some(before), Some(from), Some(to), Some(behind)) = (
            first.checked_sub(3).and_then(|j| places.get(j)).copied(),
            places.get(first).copied(),
            places.get(last).copied(),
            places.get(last + 3).copied(),
        ) {
            let way = to.minus(from);
            let agree = cosine(from.minus(before), way) > STRAIGHT_COS
                && cosine(behind.minus(to), way) > STRAIGHT_COS;
            if agree && from.distance(to) < 3.0 * width_px + 10.0 {
                let parts = super::lines::count_f64(last - first);
                for (k, place) in places.iter_mut().enumerate().take(last).skip(first + 1) {
                    *place = from.along(way, super::lines::count_f64(k - first) / parts);
                }
            }
        }
        i = end + 1;
    }
}

/// Corners are where the straight parts on both sides meet.
fn sharpen(places: &mut [PxPoint], width_px: f64) {
    let old = places.to_vec();
    // Of each side: what the corner bends, px; how much behind it is looked at, px; least number of places; and how far these may be off
    // a straight line, px. A narrow turn of a curve is none.
    for (skip_px, fit_px, least, most_off_px) in
        [(1.1 * width_px, 12.0, 4, 0.35), (0.6 * width_px, 5.0, 3, 0.2)]
    {
        let (skip, fit) = (super::whole::count(0.5 * skip_px).max(1), super::whole::count(0.5 * fit_px));
        let mut done_till = 0;
        for i in 0..old.len() {
            if i < done_till || i < skip + least {
                continue;
            }
            let Some(at) = old.get(i) else { break };
            let before = old.get((i - skip).saturating_sub(fit)..=i - skip).unwrap_or(&[]);
            let behind = old.get(i + skip..(i + skip + fit + 1).min(old.len())).unwrap_or(&[]);
            let (Some(one), Some(other)) =
                (straight(before, least, most_off_px), straight(behind, least, most_off_px))
            else {
                continue;
            };
            let turn = cosine(one.1, other.1);
            if !(-0.7..CORNER_COS).contains(&turn) {
                continue;
            }
            let cross = one.1.0 * other.1.1 - one.1.1 * other.1.0;
            let between = other.0.minus(one.0);
            let along = (between.0 * other.1.1 - between.1 * other.1.0) / cross;
            let met = one.0.along(one.1, along);
            // This is the place of the corner, none beside it.
            let nearest = old
                .iter()
                .enumerate()
                .skip(i - skip)
                .take(2 * skip + 1)
                .min_by(|(_, a), (_, b)| a.distance(met).total_cmp(&b.distance(met)));
            if nearest.is_none_or(|(k, _)| k != i) || at.distance(met) > 0.6 * width_px {
                continue;
            }
            for (k, place) in places.iter_mut().enumerate().skip(i - skip).take(2 * skip + 1) {
                let end = old.get(if k < i { i - skip } else { i + skip }).copied().unwrap_or(met);
                let share = super::lines::count_f64(k.abs_diff(i)) / super::lines::count_f64(skip);
                *place = met.along(end.minus(met), share);
            }
            done_till = i + skip;
        }
        if done_till > 0 && skip_px > width_px {
            // The corners that are farther from each other are done; nearer ones are tried only without them.
            return;
        }
    }
}

/// Middle and direction of places that are on a straight line.
fn straight(places: &[PxPoint], least: usize, most_off_px: f64) -> Option<(PxPoint, (f64, f64))> {
    if places.len() < least {
        return None;
    }
    let (middle, direction) = super::tips::fitted(places)?;
    let off = |at: &PxPoint| {
        let (x, y) = at.minus(middle);
        (x * direction.1 - y * direction.0).abs()
    };
    places.iter().all(|at| off(at) < most_off_px).then_some((middle, direction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    #[test]
    fn a_rounded_corner_becomes_one_and_a_line_goes_to_its_middle() {
        let corner = [(20.0, 60.0), (80.0, 60.0), (80.0, 120.0)].map(|(x, y)| PxPoint::new(x, y));
        let paper = Paper::drawn(140, 140, &[(corner.to_vec(), 5.0)]).unwrap();
        let settings = CameraSettings { width_px: 140, height_px: 140, ..CameraSettings::default() };
        let flat =
            Flat::of(&SimulatedCamera::new(&paper, settings).window(PxPoint::new(70.0, 70.0)), None, None);
        // Cut by 1.5 px, and half a pixel beside the line.
        let rounded =
            [(20.0, 60.5), (78.5, 60.5), (79.5, 62.0), (79.5, 120.0)].map(|(x, y)| PxPoint::new(x, y));
        let mut places = super::super::lines::resampled(&rounded, 2.0);
        centred(&flat, &mut places, 5.0);
        let nearest = places.iter().map(|at| at.distance(corner[1])).fold(f64::MAX, f64::min);
        assert!(nearest < 0.25, "{nearest}");
        let inner = places.iter().filter(|at| at.x > 30.0 && at.x < 70.0);
        let off = inner.map(|at| (at.y - 60.0).abs()).fold(0.0, f64::max);
        assert!(off < 0.2, "{off}");
    }
}
