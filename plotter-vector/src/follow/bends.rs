//! [`bends`]: where lines have a corner under others.

use super::centred::BENT_COS;
use super::corners::{CORNER_COS, SHARP_COS, SQUARE_DARK, crossing, is_bent, reaches, runs, straight};
use super::flat::Flat;
use super::lines::cosine;
use crate::stroke::PxPoint;
use core::ops::Range;

/// Places of an arm that tell its direction: at least, at most, and how far they may be off a straight line, px.
const LEAST: usize = 6;
const MOST: usize = 12;
const STRAIGHT_OFF_PX: f64 = 0.3;

/// Corners that nothing shows, each with the place of the line that is nearest: where the straight parts of a line before and behind a
/// part that is hidden meet within it. What is bent as much on both sides of it is a curve, and has none.
pub(super) fn bends(
    flat: &Flat,
    places: &[PxPoint],
    is_hidden: &[bool],
    width_px: f64,
) -> Vec<(usize, PxPoint)> {
    runs(is_hidden).filter_map(|run| bend(flat, places, is_hidden, run, width_px)).collect()
}

fn bend(
    flat: &Flat,
    places: &[PxPoint],
    is_hidden: &[bool],
    run: Range<usize>,
    width_px: f64,
) -> Option<(usize, PxPoint)> {
    let is_seen = |k: &usize| is_hidden.get(*k) == Some(&false);
    let before = (0..run.start).rev().take(MOST).take_while(is_seen).last()?..run.start;
    let behind = run.end..(run.end..places.len()).take(MOST).take_while(is_seen).last()? + 1;
    let arms = [places.get(before)?, places.get(behind)?];
    let [one, other] = arms.map(|arm| straight(arm, LEAST, STRAIGHT_OFF_PX));
    let (one, other) = (one?, other?);
    let turn_cos = cosine(one.1, other.1);
    if !(SHARP_COS..BENT_COS).contains(&turn_cos) || is_bent(arms, [one, other], turn_cos) {
        return None;
    }
    let met = crossing(one, other);
    let off = |k: &usize| places.get(*k).map_or(f64::MAX, |at| at.distance(met));
    // Of the last places that are seen on both sides none may be nearer.
    let nearest = (run.start.checked_sub(1)?..=run.end).min_by(|a, b| off(a).total_cmp(&off(b)))?;
    if !run.contains(&nearest) {
        return None;
    }
    if turn_cos < CORNER_COS {
        let dark = f32::min(flat.at(one.0), flat.at(other.0));
        let at = places.get(nearest)?;
        if flat.at(met) < SQUARE_DARK * dark || !reaches(flat, *at, met, [one, other], width_px) {
            return None;
        }
    }
    Some((nearest, met))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::lines::Lines;
    use crate::follow::paper::nearest;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};
    use crate::stroke::PxVec;

    /// How far the lines that a window shows are from those that were drawn, at most, px.
    fn off_px(lines: &[(Vec<PxPoint>, f64)], at: PxPoint) -> f64 {
        let paper = Paper::drawn(300, 300, lines).unwrap();
        let window = SimulatedCamera::new(&paper, CameraSettings::default()).window(at);
        let found = Lines::of(&Flat::of(&window, None, None), 40);
        let moved = |place: &PxPoint| PxPoint::new(place.x + at.x - 150.0, place.y + at.y - 150.0);
        let off = |place: PxPoint| {
            let parts = lines.iter().flat_map(|(line, _)| line.windows(2));
            parts.map(|part| nearest(place, part[0], part[1]).distance(place)).fold(f64::MAX, f64::min)
        };
        assert!(!found.pieces.is_empty());
        found.pieces.iter().flat_map(|piece| &piece.places).map(|place| off(moved(place))).fold(0.0, f64::max)
    }

    #[test]
    fn rays_from_one_point_have_their_corner_there() {
        let middle = PxPoint::new(150.3, 149.6);
        let ray = |k: u8| {
            let (sin, cos) = f64::sin_cos(0.12 + f64::from(k) * std::f64::consts::TAU / 7.0);
            (vec![middle, middle + PxVec::new(cos, sin) * 140.0], 4.0)
        };
        let off_px = off_px(&(0..7).map(ray).collect::<Vec<_>>(), PxPoint::new(150.0, 150.0));
        assert!(off_px < 0.4, "{off_px}");
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn a_wall_and_a_thinner_one_meet_where_their_middles_do() {
        let at = |x, y| PxPoint::new(x, y);
        // A thick wall, at the corner of which a thin one goes on, and a third one begins.
        let lines = [
            (vec![at(40.0, 150.0), at(150.0, 150.0), at(150.0, 260.0)], 7.0),
            (vec![at(150.0, 150.0), at(260.0, 110.0)], 4.0),
        ];
        for camera in [at(150.0, 150.0), at(120.0, 140.0), at(170.0, 165.0)] {
            let off_px = off_px(&lines, camera);
            assert!(off_px < 0.5, "{off_px} from {camera:?}");
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn each_arm_of_a_corner_has_its_own_width() {
        let corner = PxPoint::new(150.2, 149.7);
        for turn in [80.0_f64, 90.0, 110.0] {
            let (sin, cos) = f64::sin_cos(turn.to_radians());
            let lines = [
                (vec![corner, corner + PxVec::new(cos, sin) * 120.0], 7.0),
                (vec![corner, corner + PxVec::new(1.0, 0.0) * 120.0], 3.0),
            ];
            let off_px = off_px(&lines, PxPoint::new(160.0, 155.0));
            assert!(off_px < 0.5, "{off_px} at {turn} degrees");
        }
    }

    #[test]
    fn what_is_bent_on_both_sides_is_a_curve() {
        let arc = |radius: f64| -> Vec<PxPoint> {
            let on = |k: u8| 2.0 * f64::from(k) / radius;
            (0..40).map(|k| PxPoint::new(radius * f64::cos(on(k)), radius * f64::sin(on(k)))).collect()
        };
        let corner: Vec<PxPoint> =
            (0..40_u8).map(|k| PxPoint::new(2.0 * f64::from(k), 0.7 * f64::from(k.max(20) - 20))).collect();
        let is_hidden: Vec<bool> = (0..40).map(|k| (17..24).contains(&k)).collect();
        let flat = Flat::default();
        for radius in [40.0, 60.0, 110.0] {
            assert_eq!(bends(&flat, &arc(radius), &is_hidden, 4.0), []);
        }
        assert!(
            matches!(bends(&flat, &corner, &is_hidden, 4.0)[..], [(20, at)] if at.distance(corner[20]) < 1e-6)
        );
    }
}
