//! [`sharpened`]: the tips of sharp corners, where two arms of a line run into each other.
//!
//! Near a tip there is no paper between the arms, so their ink has one middle: a stub, from which both arms go off. The arms are
//! taken from where they are apart, and meet where they meet.
//!
//! ```text
//!    \ /  arms             \   /
//!     Y                     \ /
//!     |   stub               V   the tip
//! ```

use super::corners::{BLURRED_END_PX, SHARP_COS, ink_end_px};
use super::flat::Flat;
use super::lines::cosine;
use super::paper::nearest;
use crate::stroke::{PxPoint, PxVec};

/// A straight arm deviates by less, px.
const STRAIGHT_PX: f64 = 0.5;

/// Ink goes on behind where straight arms meet by more than this, px: they are none.
const BENT_PX: f64 = 1.5;

/// A round end is so dark so many of its widths to either side of the pen's last place, as a share of there; a pointed one is not.
const ROUND_DARK: f32 = 0.5;
const ROUND_SHARE: f64 = 0.35;

/// A line turns back where the ways before and behind a place have this cosine at most.
const BACK_COS: f64 = -0.8;

/// A stub is at most so many widths and some pixels long.
const LONGEST_WIDTHS: f64 = 9.0;

/// Fewer places tell no direction.
const SHORT: usize = 8;

/// An arm at the foot of a stub.
#[derive(Clone, Debug)]
struct Arm {
    stroke: usize,
    /// Whether the arm is the stroke's part behind the foot.
    behind: bool,
    /// Places from the foot on.
    places: Vec<PxPoint>,
    direction: PxVec,
    middle: PxPoint,
}

/// Joins the arms of sharp tips in lines of some width; places along the strokes are about a pixel from each other.
pub(super) fn sharpened(flat: &Flat, mut strokes: Vec<Vec<PxPoint>>, width_px: f64) -> Vec<Vec<PxPoint>> {
    for stroke in &mut strokes {
        unfold(stroke, width_px);
        unhook(stroke, width_px);
    }
    without_crumbs(&mut strokes, &[], width_px);
    part_ends(&mut strokes, width_px);
    let longest = LONGEST_WIDTHS * width_px + 6.0;
    // Each tip takes its stub away: there are no more than stubs.
    for _ in 0..strokes.len() {
        let Some((stub, one, other, at)) = lonely(flat, &strokes, longest, width_px) else { break };
        join(&mut strokes, stub, &one, &other, at);
    }
    for _ in 0..strokes.len() {
        let Some((split, stub, one, other, at)) = grown_on(flat, &strokes, longest, width_px) else { break };
        strokes = split;
        join(&mut strokes, stub, &one, &other, at);
    }
    without_crumbs(&mut strokes, &[], width_px);
    strokes
}

/// A stub that a stroke goes along, back and along again is gone along once.
fn unfold(stroke: &mut Vec<PxPoint>, width_px: f64) {
    let short = super::whole::count(1.5 * width_px) + 3;
    // Longer ones only where there is no paper between the ways.
    let longest = super::whole::count(LONGEST_WIDTHS * width_px + 6.0);
    let turns_back = |stroke: &[PxPoint], i: usize| {
        let Some(&[before, _, at, _, behind]) = i.checked_sub(2).and_then(|i| stroke.get(i..i + 5)) else {
            return false;
        };
        cosine(at - before, behind - at) < BACK_COS
    };
    let is_one = |there: &[PxPoint], again: &[PxPoint]| {
        there.iter().all(|at| again.iter().any(|place| place.distance(*at) < 0.5 * width_px))
    };
    let mut i = 2;
    while i + 2 < stroke.len() {
        let Some(from) = stroke.get(i).copied().filter(|_| turns_back(stroke, i)) else {
            i += 1;
            continue;
        };
        let fold = (i + 2..=i + longest).filter(|j| turns_back(stroke, *j)).find_map(|back| {
            let again = stroke.iter().enumerate().skip(back + 1).take(longest);
            let again = again.min_by(|(_, a), (_, b)| a.distance(from).total_cmp(&b.distance(from)));
            let again = again.map_or(back, |(k, _)| k);
            let ways = (stroke.get(i..=back)?, stroke.get(back..=again)?);
            (back <= i + short || is_one(ways.0, ways.1)).then_some(again)
        });
        if let Some(again) = fold {
            stroke.drain(i + 1..again);
        }
        i += 1;
    }
}

/// The last bit of a stroke that turns back within a line's width, as thinning leaves it between two arms, goes.
fn unhook(stroke: &mut Vec<PxPoint>, width_px: f64) {
    /// From a place to those that tell the ways before and behind it: steps.
    const LOOK: usize = 2;
    for _ in 0..2 {
        stroke.reverse();
        let Some(last) = stroke.len().checked_sub(1) else { return };
        let turns = |i: &usize| {
            let ways = (stroke.get(*i), stroke.get(i.saturating_sub(LOOK)), stroke.get((i + LOOK).min(last)));
            let (Some(at), Some(before), Some(behind)) = ways else { return false };
            cosine(*at - *before, *behind - *at) < 0.0
        };
        let first = last.saturating_sub(super::whole::count(width_px) + 1).max(stroke.len() / 2).max(LOOK);
        if let Some(turn) = (first..last).find(turns) {
            stroke.truncate(turn + 1);
        }
    }
}

/// Blur fills acute angles to so much beyond the ink of both lines, px.
const FILLED_PX: f64 = 1.3;

/// Takes away what thinning leaves in corners: short strokes wholly inside of the ink of others, and of what blur fills between them.
/// Strokes without a width of their own are as wide as most.
pub(super) fn without_crumbs(strokes: &mut Vec<Vec<PxPoint>>, widths_px: &[f64], most_px: f64) {
    let width_of = |stroke: usize| widths_px.get(stroke).copied().unwrap_or(most_px);
    for i in 0..strokes.len() {
        let is_crumb = strokes.get(i).is_some_and(|stroke| {
            length(stroke) < 1.5 * most_px + 2.0
                && stroke.iter().all(|at| {
                    let others = strokes.iter().enumerate().filter(|(k, _)| *k != i);
                    others.flat_map(|(k, other)| other.windows(2).map(move |pair| (k, pair))).any(
                        |(k, pair)| {
                            let [a, b] = pair else { return false };
                            nearest(*at, *a, *b).distance(*at) < 0.6 * width_of(k) + FILLED_PX
                        },
                    )
                })
        });
        if is_crumb && let Some(stroke) = strokes.get_mut(i) {
            stroke.clear();
        }
    }
    strokes.retain(|stroke| !stroke.is_empty());
}

/// What blur fills between two lines is lighter than this share of both.
const RUNG_DARK: f32 = 0.75;

/// Takes away what thinning leaves between two lines side by side whose blur meets: short strokes from the one to the other that are
/// lighter on their way than at both of their ends.
pub(super) fn without_rungs(flat: &Flat, strokes: &mut Vec<Vec<PxPoint>>, most_px: f64) {
    strokes.retain(|stroke| {
        let (Some(first), Some(last)) = (stroke.first(), stroke.last()) else { return false };
        let ends = flat.at(*first).min(flat.at(*last));
        let on_the_way = stroke.iter().map(|at| flat.at(*at)).fold(ends, f32::min);
        length(stroke) >= 1.5 * most_px + 2.0 || on_the_way > RUNG_DARK * ends
    });
}

/// Two strokes that end together have a stub twice: it stays with one of them, on which the other ends.
fn part_ends(strokes: &mut [Vec<PxPoint>], width_px: f64) {
    for i in 0..strokes.len() {
        for is_last in [false, true] {
            let Some(own) = strokes.get(i) else { continue };
            let Some(end) = (if is_last { own.last() } else { own.first() }).copied() else { continue };
            let meets = |other: &Vec<PxPoint>| {
                other.first().into_iter().chain(other.last()).any(|at| at.distance(end) < 0.6 * width_px)
            };
            let beside = |at: &PxPoint, other: &[PxPoint]| {
                other.iter().any(|place| place.distance(*at) < 0.35 * width_px + 0.3)
            };
            let tail = |other: &[PxPoint]| {
                let from_end: Box<dyn Iterator<Item = &PxPoint>> =
                    if is_last { Box::new(own.iter().rev()) } else { Box::new(own.iter()) };
                from_end.take_while(|at| beside(at, other)).count()
            };
            let others = strokes.iter().enumerate().filter(|(k, other)| *k != i && meets(other));
            // A crumb beside the stub is no second arm.
            let tails = others.map(|(_, other)| (tail(other), other.len()));
            let tail = tails.filter(|(tail, len)| tail + 4 < *len).map(|(tail, _)| tail).max().unwrap_or(0);
            if tail > 3 && tail + 4 < own.len() {
                let rest = if is_last { own.get(..own.len() - tail) } else { own.get(tail..) };
                let rest = rest.unwrap_or(&[]).to_vec();
                if let Some(stroke) = strokes.get_mut(i) {
                    *stroke = rest;
                }
            }
        }
    }
}

/// A stub that is a stroke of its own, with its arms and its tip.
fn lonely(
    flat: &Flat,
    strokes: &[Vec<PxPoint>],
    longest: f64,
    width_px: f64,
) -> Option<(usize, Arm, Arm, PxPoint)> {
    strokes.iter().enumerate().filter(|(_, places)| places.len() > 1 && length(places) < longest).find_map(
        |(stub, places)| {
            let backward: Vec<PxPoint> = places.iter().rev().copied().collect();
            let found = tip(flat, strokes, stub, places, width_px)
                .or_else(|| tip(flat, strokes, stub, &backward, width_px));
            found.map(|(one, other, at)| (stub, one, other, at))
        },
    )
}

/// The strokes with a stub cut off.
type Cut = (Vec<Vec<PxPoint>>, usize, Arm, Arm, PxPoint);

/// A stub that one arm goes on into, and where the other arm ends: the strokes with the stub cut off.
fn grown_on(flat: &Flat, strokes: &[Vec<PxPoint>], longest: f64, width_px: f64) -> Option<Cut> {
    let reach = 0.8 * width_px + 2.0;
    for (index, stroke) in strokes.iter().enumerate() {
        for (other, end) in strokes.iter().enumerate().flat_map(|(other, ends)| {
            ends.first().into_iter().chain(ends.last()).map(move |end| (other, *end))
        }) {
            let nearest = stroke
                .iter()
                .enumerate()
                .min_by(|(_, a), (_, b)| a.distance(end).total_cmp(&b.distance(end)));
            let Some((at, _)) = nearest.filter(|(_, place)| other != index && place.distance(end) < reach)
            else {
                continue;
            };
            let (before, behind) = (stroke.get(..=at).unwrap_or(&[]), stroke.get(at..).unwrap_or(&[]));
            for (arm, stub, turned) in [(before, behind, false), (behind, before, true)] {
                if stub.len() < 3 || arm.len() < 4 || length(stub) >= longest {
                    continue;
                }
                let mut split = strokes.to_vec();
                if let Some(stroke) = split.get_mut(index) {
                    *stroke = arm.to_vec();
                }
                let mut places = stub.to_vec();
                if turned {
                    places.reverse();
                }
                split.push(places.clone());
                let last = split.len() - 1;
                if let Some((one, other, tip)) = tip(flat, &split, last, &places, width_px) {
                    return Some((split, last, one, other, tip));
                }
            }
        }
    }
    None
}

/// Puts one stroke over the tip in the place of the stub and the arms' strokes.
fn join(strokes: &mut Vec<Vec<PxPoint>>, stub: usize, one: &Arm, other: &Arm, at: PxPoint) {
    let mut whole: Vec<PxPoint> = one.places.iter().rev().copied().collect();
    whole.push(at);
    whole.extend(&other.places);
    for gone in [stub, one.stroke, other.stroke] {
        if let Some(stroke) = strokes.get_mut(gone) {
            stroke.clear();
        }
    }
    strokes.push(whole);
    strokes.retain(|stroke| !stroke.is_empty());
}

fn length(places: &[PxPoint]) -> f64 {
    places.windows(2).map(|pair| if let [a, b] = pair { a.distance(*b) } else { 0.0 }).sum()
}

/// Both arms and the tip, if a stroke is the stub of one, with its foot first.
fn tip(
    flat: &Flat,
    strokes: &[Vec<PxPoint>],
    stub: usize,
    places: &[PxPoint],
    width_px: f64,
) -> Option<(Arm, Arm, PxPoint)> {
    let (foot, free) = (*places.first()?, *places.last()?);
    let reach = 0.8 * width_px + 2.0;
    let mut arms: Vec<Arm> = Vec::new();
    for (index, stroke) in strokes.iter().enumerate().filter(|(index, _)| *index != stub) {
        let long = foot.distance(free);
        // What thinning leaves beside the stub is shorter than that.
        if length(stroke) < long {
            continue;
        }
        // Another line near the free end: no tip.
        let least = reach.min(0.5 * long + f64::min(0.4 * long, 1.0));
        if stroke.iter().any(|at| at.distance(free) < least) {
            return None;
        }
        let nearest =
            stroke.iter().enumerate().min_by(|(_, a), (_, b)| a.distance(foot).total_cmp(&b.distance(foot)));
        let Some((at, _)) = nearest.filter(|(_, place)| place.distance(foot) < reach) else { continue };
        for behind in [false, true] {
            let part: Vec<PxPoint> = if behind {
                stroke.iter().skip(at).copied().collect()
            } else {
                stroke.iter().take(at + 1).rev().copied().collect()
            };
            let own: Vec<PxPoint> =
                part.into_iter().skip_while(|place| place.distance(foot) < width_px + 2.0).collect();
            if own.len() < 4 {
                continue;
            }
            let (middle, direction) = arm(&own, width_px)?;
            arms.push(Arm { stroke: index, behind, places: own, direction, middle });
        }
    }
    let [one, other] = <[Arm; 2]>::try_from(arms).ok()?;
    if one.stroke == other.stroke && one.behind == other.behind {
        return None;
    }
    let out = free - foot;
    let mean = one.direction + other.direction;
    // The way of a short stub is mostly noise.
    let least = if foot.distance(free) < 1.2 * width_px { -0.5 } else { -0.85 };
    let between = cosine(one.direction, other.direction);
    // Thinning leaves a stub as long as the arms' ink is one.
    let longest = 0.8 * width_px / libm::sqrt(0.5 * (1.0 - between)).max(1e-3) + 0.5 * width_px + 2.0;
    if between < -0.3 || foot.distance(free) > longest || cosine(out, mean) > least {
        return None;
    }
    let cross = one.direction.cross(other.direction);
    let along = (other.middle - one.middle).cross(other.direction) / cross;
    let met = one.middle + one.direction * along;
    // The ink ends about half a width behind the tip, the more the sharper it is.
    let sound = cross.abs() > 0.03 && met.distance(free) < 1.5 * width_px + 0.4 * foot.distance(free) + 2.0;
    let mut at = if sound { met } else { free };
    // Arms that meet at a small angle hardly tell where, and those that are short or bent not at all; the end of their ink does.
    let way = -mean / mean.length();
    let ahead = (free - at).dot(way);
    let is_sharp = between > -SHARP_COS;
    let from = if is_sharp { at + way * ahead } else { free };
    if let Some(end_px) = ink_end_px(flat, from, way, width_px) {
        let end = from + way * (end_px - 0.5 * width_px + BLURRED_END_PX);
        if is_sharp || ((end - at).dot(way) > BENT_PX && is_round(flat, end, way, width_px)) {
            at = end;
        }
    }
    Some((one, other, at))
}

/// Whether ink is as wide as the line at a place that a round pen would end at.
fn is_round(flat: &Flat, end: PxPoint, PxVec { x, y }: PxVec, width_px: f64) -> bool {
    let beside = |side: f64| flat.at(end + PxVec::new(-y, x) * (side * ROUND_SHARE * width_px));
    beside(-1.0).min(beside(1.0)) > ROUND_DARK * flat.at(end)
}

/// The straight line through an arm's places, over as long a part of it as is straight.
fn arm(own: &[PxPoint], width_px: f64) -> Option<(PxPoint, PxVec)> {
    let is_straight = |part: &[PxPoint], (middle, PxVec { x, y }): (PxPoint, PxVec)| {
        part.iter().all(|at| {
            let off = *at - middle;
            (off.x * y - off.y * x).abs() < STRAIGHT_PX
        })
    };
    // Next to the foot blur draws the arms together.
    let clear = own.get(super::whole::count(width_px)..).filter(|clear| clear.len() > 24).unwrap_or(own);
    let part = |length_px: f64| clear.get(..super::whole::count(length_px).min(clear.len())).unwrap_or(clear);
    for widths in [16.0, 10.0] {
        let part = part(widths * width_px);
        if let Some(line) = fitted(part).filter(|line| is_straight(part, *line)) {
            return Some(line);
        }
    }
    // A line may turn soon: then as much counts as is straight.
    let (most, least) = (super::whole::count(5.0 * width_px + 8.0), super::whole::count(2.0 * width_px));
    let short = (least.max(SHORT)..most.min(own.len())).rev().find_map(|count| {
        let part = own.get(..count)?;
        fitted(part).filter(|line| is_straight(part, *line))
    });
    short.or_else(|| fitted(own.get(..most.min(own.len())).unwrap_or(own)))
}

/// The straight line through places, by least squares across it: its middle, and its direction from the first on.
pub(super) fn fitted(places: &[PxPoint]) -> Option<(PxPoint, PxVec)> {
    let count = f64::from(u32::try_from(places.len()).ok()?);
    let sum = places.iter().fold((0.0, 0.0), |sum, at| (sum.0 + at.x, sum.1 + at.y));
    let middle = PxPoint::new(sum.0 / count, sum.1 / count);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for at in places {
        let PxVec { x: dx, y: dy } = *at - middle;
        xx += dx * dx;
        xy += dx * dy;
        yy += dy * dy;
    }
    let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
    let direction = PxVec::new(libm::cos(angle), libm::sin(angle));
    let way = *places.last()? - *places.first()?;
    let sign = if way.dot(direction) < 0.0 { -1.0 } else { 1.0 };
    Some((middle, direction * sign))
}

#[cfg(test)]
mod tests {
    use super::super::lines::resampled;
    use super::*;
    use crate::follow::{CameraSettings, Paper, SimulatedCamera};

    const TIP: PxPoint = PxPoint { x: 40.0, y: 60.0 };

    /// An arm of the tip along this way: its places, a pixel apart, from one of them on.
    fn arm(way: PxVec, from: u8) -> Vec<PxPoint> {
        (from..80).map(|i| TIP + way * f64::from(i)).collect()
    }

    /// What a camera shows of the tip with arms along these ways.
    fn picture(ways: [PxVec; 2], width_px: f64) -> Flat {
        let paper = Paper::drawn(160, 160, &ways.map(|way| (arm(way, 0), width_px))).unwrap();
        let settings = CameraSettings { width_px: 160, height_px: 160, ..CameraSettings::default() };
        Flat::of(&SimulatedCamera::new(&paper, settings).window(PxPoint::new(80.0, 80.0)), None, None)
    }

    /// How far a stroke passes the tip.
    fn off_px(stroke: &[PxPoint]) -> f64 {
        stroke.iter().map(|at| at.distance(TIP)).fold(f64::MAX, f64::min)
    }

    #[test]
    fn a_stub_with_two_arms_becomes_a_tip() {
        // A tip of about 23 degrees; the arms part at 20 px from it.
        let ways = [PxVec::new(1.0, 0.2), PxVec::new(1.0, -0.2)];
        let mut one = arm(ways[0], 20);
        one.reverse();
        one.push(PxPoint::new(58.0, 60.0));
        one.extend(arm(ways[1], 20));
        let stub: Vec<PxPoint> = (38..=58).rev().map(|x| PxPoint::new(f64::from(x), 60.0)).collect();
        let strokes = sharpened(&picture(ways, 5.0), vec![one, stub], 5.0);
        assert_eq!(strokes.len(), 1);
        assert!(off_px(&strokes[0]) < 0.3, "{}", off_px(&strokes[0]));
    }

    #[test]
    fn a_stub_that_is_folded_is_a_tip() {
        // A tip of 18 degrees: one arm goes on to its end, the other as far, back and again to the end.
        let ways = [PxVec::new(-0.152, -0.988), PxVec::new(0.152, -0.988)];
        let one = [&[TIP + PxVec::new(0.0, -2.0)], &*arm(ways[0], 14)].concat();
        let stub = [-3.1, -6.8, -1.9].map(|y| PxPoint::new(TIP.x, TIP.y + y));
        let mut other = arm(ways[1], 9);
        other.reverse();
        other.extend(stub);
        let strokes = [one, other].map(|stroke| resampled(&stroke, 1.0));
        let strokes = sharpened(&picture(ways, 5.0), strokes.into(), 5.0);
        assert_eq!(strokes.len(), 1);
        assert!(off_px(&strokes[0]) < 0.5, "{}", off_px(&strokes[0]));
        let back = strokes[0].windows(5).filter(|w| cosine(w[2] - w[0], w[4] - w[2]) < BACK_COS);
        assert!(back.count() <= 1);
    }

    #[test]
    fn a_hook_at_an_end_goes() {
        let place = |(x, y): (f64, f64)| PxPoint::new(x, y);
        let line: Vec<PxPoint> = (0..=40).map(|y| PxPoint::new(50.0, f64::from(y))).collect();
        // 1.7 px back and 1 px on again; a little round the corner.
        for hook in [&[(49.6, 40.0), (49.3, 38.3), (49.5, 39.3)][..], &[(50.4, 39.4)]] {
            let mut stroke = line.clone();
            stroke.extend(hook.iter().copied().map(place));
            unhook(&mut stroke, 5.0);
            assert_eq!(stroke, line);
            let mut stroke: Vec<PxPoint> =
                hook.iter().rev().copied().map(place).chain(line.iter().rev().copied()).collect();
            unhook(&mut stroke, 5.0);
            assert!(stroke.iter().eq(line.iter().rev()), "{stroke:?}");
        }
        // What turns back farther from its end is an arm.
        let mut tip = line.clone();
        tip.extend((1..10).map(|y| place((50.0 + 0.4 * f64::from(y), 40.0 - f64::from(y)))));
        let whole = tip.clone();
        unhook(&mut tip, 5.0);
        assert_eq!(tip, whole);
    }

    #[test]
    fn a_long_stub_is_gone_along_once_but_arms_are_not() {
        // From the tip 13 px to where the arms part, back, and along an arm that turns off by 7 degrees.
        let at = |off: f64, y: i32| PxPoint::new(50.0 + off, f64::from(y));
        let folded = |off: f64, px: i32| -> Vec<PxPoint> {
            let slope = |y: i32| off * f64::from(y) / f64::from(px);
            let there = (0..=px).map(|y| at(0.0, y)).chain((0..px).rev().map(|y| at(-0.2 * slope(y), y)));
            there.chain((1..60).map(|y| at(slope(y), y))).collect()
        };
        let mut stub = folded(1.6, 13);
        unfold(&mut stub, 5.0);
        assert!(stub.windows(2).all(|pair| pair[1].y >= pair[0].y), "{stub:?}");
        assert_eq!((stub[0].y, stub[stub.len() - 1].y), (0.0, 59.0));
        // Three arms that are 10 px apart where they are farthest.
        let arms = folded(10.0, 40);
        let mut same = arms.clone();
        unfold(&mut same, 5.0);
        assert_eq!(same, arms);
    }

    #[test]
    fn a_crumb_beside_a_stub_hides_no_tip() {
        // A tip of 40 degrees as thinning left it: both arms have the stub for their last piece, and a crumb lies beside it.
        let ways = [PxVec::new(0.868, 0.496), PxVec::new(0.351, 0.936)];
        let from_tip = |(x, y): (f64, f64)| TIP + PxVec::new(x, y);
        let whole = |stub: [(f64, f64); 3], way: PxVec| {
            let mut places: Vec<PxPoint> = stub.map(from_tip).into();
            places.extend(arm(way, 15));
            resampled(&places, 1.0)
        };
        let one = whole([(0.7, 0.4), (4.0, 5.0), (9.0, 5.5)], ways[0]);
        let other = whole([(0.5, 1.3), (3.5, 4.7), (4.9, 12.6)], ways[1]);
        let crumb = resampled(&[(6.5, 0.6), (2.3, 2.8)].map(from_tip), 1.0);
        let strokes = sharpened(&picture(ways, 5.0), vec![one, crumb, other], 6.0);
        assert_eq!(strokes.len(), 1);
        assert!(off_px(&strokes[0]) < 0.5, "{}", off_px(&strokes[0]));
    }

    #[test]
    fn a_way_over_the_blur_between_two_lines_is_no_line() {
        // Lines of 2 px with 4 px of paper between them; at 180 px one leads from the one to the other.
        let at = |x: f64, y: f64| PxPoint::new(x, y);
        let lines = [
            vec![at(-50.0, 147.2), at(350.0, 147.2)],
            vec![at(-50.0, 153.2), at(350.0, 153.2)],
            vec![at(180.3, 147.2), at(180.3, 153.2)],
        ];
        let strokes: Vec<_> = lines.iter().map(|line| (line.clone(), 2.0)).collect();
        let paper = Paper::drawn(300, 300, &strokes).unwrap();
        let window =
            SimulatedCamera::new(&paper, CameraSettings::default()).window(PxPoint::new(150.0, 150.0));
        let rung = |x: f64| vec![at(x, 147.2), at(x, 149.2), at(x, 151.2), at(x, 153.2)];
        let mut found: Vec<_> = lines.iter().take(2).map(|line| resampled(line, 1.0)).collect();
        found.extend([rung(120.4), rung(180.3)]);
        without_rungs(&Flat::of(&window, None, None), &mut found, 4.0);
        let last: Vec<f64> = found.iter().filter_map(|stroke| stroke.first()).map(|at| at.x).collect();
        assert_eq!(last, [-50.0, -50.0, 180.3]);
    }

    #[test]
    fn what_blur_fills_between_two_lines_is_a_crumb() {
        let line = |places: &[(f64, f64)]| places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect();
        let left = |crumb: &[(f64, f64)]| {
            let (beam, roof) = ([(340.0, 250.6), (410.8, 250.6)], [(340.8, 189.2), (410.8, 250.6)]);
            let mut strokes: Vec<Vec<PxPoint>> = vec![line(&beam), line(&roof), line(crumb)];
            without_crumbs(&mut strokes, &[4.9, 4.9, 4.0], 4.9);
            strokes.len()
        };
        assert_eq!(left(&[(400.8, 246.7), (401.1, 248.7), (401.3, 250.6)]), 2);
        // Paper is between the lines there.
        assert_eq!(left(&[(385.0, 238.0), (385.0, 242.0), (385.0, 246.0)]), 3);
    }
}
