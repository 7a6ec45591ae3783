//! [`Joiner`]: fragments of strokes, band after band, made whole.

use super::fragment::{Fragment, Joint};
use super::{Cuts, Stroke};
use crate::parallel::each;
use crate::stroke::Bounded;
use std::collections::HashMap;

/// A stroke that still has an end in what has not come yet.
#[derive(Debug)]
struct Part {
    stroke: Stroke,
    joints: [Joint; 2],
}

/// Puts fragments together at their joints. Each joint of a picture occurs twice, in any order.
#[derive(Debug, Default)]
pub(crate) struct Joiner {
    /// Parts, and free slots.
    parts: Vec<Option<Part>>,
    free: Vec<usize>,
    /// The part that has a joint at an end.
    open: HashMap<Joint, usize>,
}

impl Joiner {
    /// Takes a fragment; gives the stroke that it completes.
    pub(crate) fn push(&mut self, fragment: Fragment) -> Option<Stroke> {
        let Some(joints) = fragment.joints else {
            return Some(Stroke::new(fragment.places, true));
        };
        let mut part = Part { stroke: Stroke::new(fragment.places, false), joints };
        while let Some((joint, slot)) =
            part.joints.iter().find_map(|joint| Some((*joint, self.open.remove(joint)?)))
        {
            let Some(other) = self.parts.get_mut(slot).and_then(Option::take) else { continue };
            self.free.push(slot);
            for joint in other.joints {
                self.open.remove(&joint);
            }
            part = joined(other, part, joint);
        }
        let [start, end] = part.joints;
        if start == end && start != Joint::Free {
            part.stroke.close();
            return Some(part.stroke);
        }
        if part.joints == [Joint::Free; 2] {
            return Some(part.stroke);
        }
        let slot = self.free.pop().unwrap_or_else(|| {
            self.parts.push(None);
            self.parts.len() - 1
        });
        for joint in part.joints.into_iter().filter(|joint| *joint != Joint::Free) {
            self.open.insert(joint, slot);
        }
        if let Some(place) = self.parts.get_mut(slot) {
            *place = Some(part);
        }
        None
    }

    /// Simplifies what is long of the strokes that wait for their ends.
    pub(crate) fn cut(&mut self, cuts: Cuts, bounded: Bounded) {
        let strokes = self.parts.iter_mut().flatten().map(|part| &mut part.stroke);
        let long = strokes.filter(|stroke| stroke.is_long(cuts)).collect();
        each(long, |stroke: &mut Stroke| stroke.cut(cuts, bounded));
    }

    /// What is left after the last band: strokes whose counterpart never came.
    pub(crate) fn finish(self) -> impl Iterator<Item = Stroke> {
        self.parts.into_iter().flatten().map(|part| part.stroke)
    }
}

/// Two parts that share a joint as one; the shorter one moves.
fn joined(mut one: Part, mut other: Part, joint: Joint) -> Part {
    if one.stroke.len() < other.stroke.len() {
        (one, other) = (other, one);
    }
    let ([start, end], [other_start, other_end]) = (one.joints, other.joints);
    let from_start = other_start == joint;
    let far = if from_start { other_end } else { other_start };
    let at_end = end == joint;
    if at_end != from_start {
        other.stroke.reverse();
    }
    if at_end {
        one.stroke.append(other.stroke);
        one.joints = [start, far];
    } else {
        one.stroke.prepend(other.stroke);
        one.joints = [far, end];
    }
    one
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::centreline::graph::Place;
    use crate::{picture::Pixel, stroke::PxPoint};

    fn joint(name: u32) -> Joint {
        Joint::Cut(Pixel::new(name, 0), Pixel::new(name, 1))
    }

    fn places(names: &[u8]) -> Vec<Place> {
        names.iter().map(|x| Place::new(PxPoint::new(f64::from(*x), 0.0), 1.0, false)).collect()
    }

    fn fragment(names: &[u8], joints: [Joint; 2]) -> Fragment {
        Fragment { places: places(names), joints: Some(joints) }
    }

    #[test]
    fn pieces_in_any_direction_become_one_stroke() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.push(fragment(&[4, 3], [joint(2), joint(1)])), None);
        assert_eq!(joiner.push(fragment(&[1, 2], [Joint::Free, joint(1)])), None);
        let mut whole = joiner.push(fragment(&[7, 6, 5], [Joint::Free, joint(2)])).unwrap();
        let expected = Stroke::new(places(&[1, 2, 3, 4, 5, 6, 7]), false);
        if whole != expected {
            whole.reverse();
        }
        assert_eq!(whole, expected);
    }

    #[test]
    fn two_halves_of_a_ring_close() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.push(fragment(&[1, 2], [joint(1), joint(2)])), None);
        let ring = joiner.push(fragment(&[3, 4], [joint(2), joint(1)])).unwrap();
        assert_eq!(ring, Stroke::new(places(&[1, 2, 3, 4]), true));
    }

    #[test]
    fn what_never_meets_its_counterpart_comes_in_the_end() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.push(fragment(&[1], [Joint::Free, joint(1)])), None);
        assert_eq!(joiner.finish().count(), 1);
    }
}
