//! [`Joiner`]: fragments of strokes, band after band, made whole.

use super::Place;
use super::fragment::{Fragment, Joint};
use std::collections::{HashMap, VecDeque};

/// A stroke whose ends are both known.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Whole {
    /// Its places; the first one is not repeated at the end of a closed stroke.
    pub(crate) places: Vec<Place>,
    /// Whether the end joins the start.
    pub(crate) closed: bool,
}

/// A stroke that still has an end in what has not come yet.
#[derive(Debug)]
struct Part {
    places: VecDeque<Place>,
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
    pub(crate) fn push(&mut self, fragment: Fragment) -> Option<Whole> {
        let Some(joints) = fragment.joints else {
            return Some(Whole { places: fragment.places, closed: true });
        };
        let mut part = Part { places: fragment.places.into(), joints };
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
            return Some(Whole { places: part.places.into(), closed: true });
        }
        if part.joints == [Joint::Free; 2] {
            return Some(Whole { places: part.places.into(), closed: false });
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

    /// What is left after the last band: strokes whose counterpart never came.
    pub(crate) fn finish(self) -> impl Iterator<Item = Whole> {
        self.parts.into_iter().flatten().map(|part| Whole { places: part.places.into(), closed: false })
    }
}

/// Two parts that share a joint as one; the shorter one's places move.
fn joined(mut one: Part, mut other: Part, joint: Joint) -> Part {
    if one.places.len() < other.places.len() {
        (one, other) = (other, one);
    }
    let [start, end] = other.joints;
    let from_start = start == joint;
    let far = if from_start { end } else { start };
    // Away from the joint.
    let mut places = other.places.into_iter();
    let mut next = || if from_start { places.next() } else { places.next_back() };
    let [start, end] = one.joints;
    if end == joint {
        one.places.extend(core::iter::from_fn(next));
        one.joints = [start, far];
    } else {
        while let Some(place) = next() {
            one.places.push_front(place);
        }
        one.joints = [far, end];
    }
    one
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Pixel, PxPoint};

    fn joint(name: u32) -> Joint {
        Joint::Cut(Pixel::new(name, 0), Pixel::new(name, 1))
    }

    fn fragment(places: &[u8], joints: [Joint; 2]) -> Fragment {
        let place = |x: &u8| Place::new(PxPoint::new(f64::from(*x), 0.0), 1.0, false);
        Fragment { places: places.iter().map(place).collect(), joints: Some(joints) }
    }

    fn names(whole: &Whole) -> Vec<f64> {
        whole.places.iter().map(|place| place.at().x).collect()
    }

    #[test]
    fn pieces_in_any_direction_become_one_stroke() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.push(fragment(&[4, 3], [joint(2), joint(1)])), None);
        assert_eq!(joiner.push(fragment(&[1, 2], [Joint::Free, joint(1)])), None);
        let whole = joiner.push(fragment(&[7, 6, 5], [Joint::Free, joint(2)])).unwrap();
        let mut places = names(&whole);
        if places[0] > 1.0 {
            places.reverse();
        }
        assert_eq!(places, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        assert!(!whole.closed);
    }

    #[test]
    fn two_halves_of_a_ring_close() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.push(fragment(&[1, 2], [joint(1), joint(2)])), None);
        let ring = joiner.push(fragment(&[3, 4], [joint(2), joint(1)])).unwrap();
        assert!(ring.closed);
        assert_eq!(ring.places.len(), 4);
    }

    #[test]
    fn what_never_meets_its_counterpart_comes_in_the_end() {
        let mut joiner = Joiner::default();
        assert_eq!(joiner.push(fragment(&[1], [Joint::Free, joint(1)])), None);
        assert_eq!(joiner.finish().count(), 1);
    }
}
