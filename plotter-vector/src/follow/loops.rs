//! [`joined`] and [`begun_straight`]: a corner is inside of a line, not where lines end.

use super::lines::{CORNER_COS, cosine};
use crate::stroke::PxPoint;

/// How far to both sides the direction at a place is looked at, places about 2 px from each other.
const NEAR: usize = 3;
const FAR: usize = 12;

/// What looks at the arms of a corner goes along a line from its first place to its last one, so a loop must not begin in a corner. One
/// that does begins where it turns least instead. Other lines stay.
pub(super) fn begun_straight(places: Vec<PxPoint>) -> Vec<PxPoint> {
    let once = places.len().saturating_sub(1);
    if once < 2 * FAR || places.first() != places.last() {
        return places;
    }
    let at = |i: usize| places.get(i % once).copied().unwrap_or_default();
    let turn_cos = |i: usize, reach: usize| cosine(at(i) - (at(i + once - reach)), at(i + reach) - at(i));
    if turn_cos(0, NEAR) > CORNER_COS {
        return places;
    }
    let first = (0..once).max_by(|i, j| turn_cos(*i, FAR).total_cmp(&turn_cos(*j, FAR))).unwrap_or(0);
    (first..=first + once).map(at).collect()
}

/// Two lines whose ends are nearer to each other than this share of their width, and than this, px, are one line.
const JOINED_SHARE: f64 = 0.25;
const JOINED_PX: f64 = 1.0;

/// Lines that end in one place, where no third one ends, become one.
pub(super) fn joined(mut lines: Vec<Vec<PxPoint>>, width_px: f64) -> Vec<Vec<PxPoint>> {
    let reach_px = (JOINED_SHARE * width_px).max(JOINED_PX);
    let mut i = 0;
    while i < lines.len() {
        let Some((other, reverses)) = partner(&lines, i, reach_px) else {
            i += 1;
            continue;
        };
        // The later one goes into the earlier one, which may have another partner at its other end.
        let more = lines.remove(other);
        let Some(line) = lines.get_mut(i) else { break };
        let [from_first, to_last] = reverses;
        if from_first {
            line.reverse();
        }
        let meeting = line.pop().zip(if to_last { more.last() } else { more.first() });
        let middle = meeting.map(|(end, begin)| end + (*begin - end) * 0.5);
        line.extend(middle);
        if to_last {
            line.extend(more.iter().rev().skip(1));
        } else {
            line.extend(more.iter().skip(1));
        }
    }
    lines
}

/// A later line that ends where a line does, and of which of both the near end is not that where they are joined: the first one's first
/// place, the other one's last place.
fn partner(lines: &[Vec<PxPoint>], line: usize, reach_px: f64) -> Option<(usize, [bool; 2])> {
    let ends = |places: &[PxPoint]| [places.first().copied(), places.last().copied()];
    let own = ends(lines.get(line)?);
    [false, true].into_iter().find_map(|from_first| {
        let at = own[usize::from(!from_first)]?;
        let all = lines
            .iter()
            .enumerate()
            .flat_map(|(other, places)| [(other, false, ends(places)[0]), (other, true, ends(places)[1])]);
        let mut near = all
            .filter(|(other, is_last, _)| (*other, *is_last) != (line, !from_first))
            .filter(|(.., end)| end.is_some_and(|end| end.is_within(reach_px, at)));
        let (other, is_last, _) = near.next()?;
        (near.next().is_none() && other > line).then_some((other, [from_first, is_last]))
    })
}

#[cfg(test)]
mod tests {
    use super::super::lines::resampled;
    use super::*;

    fn polygon(corners: &[(f64, f64)]) -> Vec<PxPoint> {
        let corners: Vec<PxPoint> = corners.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect();
        resampled(&corners, 2.0)
    }

    #[test]
    fn a_loop_that_begins_in_its_tip_begins_on_an_arm_and_is_the_same_loop() {
        let tip = polygon(&[(0.0, 0.0), (120.0, 30.0), (120.0, -30.0), (0.0, 0.0)]);
        let begun = begun_straight(tip.clone());
        assert_eq!((begun.len(), begun.first()), (tip.len(), begun.last()));
        assert!(begun[0].distance(tip[0]) > 20.0 && (begun[0].x - 120.0).abs() > 20.0, "{:?}", begun[0]);
        let first = tip.iter().position(|at| *at == begun[0]).unwrap();
        assert_eq!(begun[..tip.len() - first], tip[first..]);
        assert_eq!(begun[tip.len() - first..], tip[1..=first]);
    }

    #[test]
    fn two_lines_that_end_in_one_place_are_one_and_three_are_not() {
        let at = |x: f64, y: f64| PxPoint::new(x, y);
        let arm = vec![at(40.0, 0.0), at(20.0, 0.0), at(0.4, 0.0)];
        let other = vec![at(0.0, 0.4), at(0.0, 20.0), at(0.0, 40.0)];
        let far = vec![at(0.0, 41.5), at(0.0, 60.0)];
        let one = vec![at(40.0, 0.0), at(20.0, 0.0), at(0.2, 0.2), at(0.0, 20.0), at(0.0, 40.0)];
        let reversed = |line: &[PxPoint]| line.iter().rev().copied().collect::<Vec<_>>();
        assert_eq!(joined(vec![arm.clone(), far.clone(), other.clone()], 4.0), [one.clone(), far.clone()]);
        assert_eq!(joined(vec![reversed(&arm), far.clone(), reversed(&other)], 4.0), [one, far]);
        let third = vec![at(0.2, 0.2), at(-30.0, -30.0)];
        assert_eq!(joined(vec![arm.clone(), other.clone(), third.clone()], 4.0), [arm, other, third]);
    }

    #[test]
    fn rings_and_open_lines_stay() {
        let on = |k: u8| f64::from(k % 60) * std::f64::consts::TAU / 60.0;
        let ring: Vec<PxPoint> =
            (0..=60).map(|k| PxPoint::new(20.0 * on(k).cos(), 20.0 * on(k).sin())).collect();
        assert_eq!(begun_straight(ring.clone()), ring);
        let open = polygon(&[(0.0, 0.0), (80.0, 0.0), (80.0, 90.0)]);
        assert_eq!(begun_straight(open.clone()), open);
    }
}
