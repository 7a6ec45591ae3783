//! [`BoxTree`]: which of many boxes touch one. A tree of boxes around boxes, halved at the middle, in one
//! array: the memory is a constant times the number of boxes, whatever they are.

use super::SvgError;
use crate::stroke::PxPoint;

/// Boxes that a search looks at one by one: halving further costs more than it saves.
const LEAF: usize = 8;

/// Most steps that cutting may take in all: at some 10⁸ a second, half a minute.
const MAX_STEPS: usize = 4_000_000_000;

/// A box: least and greatest x and y, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) least: PxPoint,
    pub(super) most: PxPoint,
}

impl Bounds {
    /// Around nothing.
    pub(super) const NONE: Self = Self {
        least: PxPoint { x: f64::INFINITY, y: f64::INFINITY },
        most: PxPoint { x: f64::NEG_INFINITY, y: f64::NEG_INFINITY },
    };

    pub(super) fn of(places: impl IntoIterator<Item = PxPoint>) -> Self {
        places.into_iter().fold(Self::NONE, |bounds, at| bounds.with(Self { least: at, most: at }))
    }

    pub(super) fn with(self, other: Self) -> Self {
        let (a, b, c, d) = (self.least, other.least, self.most, other.most);
        Self {
            least: PxPoint::new(a.x.min(b.x), a.y.min(b.y)),
            most: PxPoint::new(c.x.max(d.x), c.y.max(d.y)),
        }
    }

    pub(super) fn grown(self, by_px: f64) -> Self {
        Self {
            least: PxPoint::new(self.least.x - by_px, self.least.y - by_px),
            most: PxPoint::new(self.most.x + by_px, self.most.y + by_px),
        }
    }

    pub(super) fn touches(&self, other: &Self) -> bool {
        self.least.x <= other.most.x
            && other.least.x <= self.most.x
            && self.least.y <= other.most.y
            && other.least.y <= self.most.y
    }

    fn middle(&self, of_x: bool) -> f64 {
        if of_x { self.least.x + self.most.x } else { self.least.y + self.most.y }
    }
}

/// The budget of work that cutting has: it counts steps, so that no file takes hours.
#[derive(Debug, Default)]
pub(super) struct Steps(usize);

impl Steps {
    pub(super) fn add(&mut self, steps: usize) {
        self.0 = self.0.saturating_add(steps);
    }

    /// # Errors
    /// [`SvgError::TooMuchClipping`] after too many.
    pub(super) fn check(&self) -> Result<(), SvgError> {
        if self.0 > MAX_STEPS { Err(SvgError::TooMuchClipping) } else { Ok(()) }
    }
}

/// Boxes that can be searched.
#[derive(Clone, Debug, Default)]
pub(super) struct BoxTree {
    boxes: Vec<Bounds>,
    /// Their numbers, those near each other side by side.
    order: Vec<u32>,
    /// Around each part of `order`: the halves of part `n` are parts `2n + 1` and `2n + 2`.
    around: Vec<Bounds>,
}

impl BoxTree {
    pub(super) fn new(boxes: Vec<Bounds>) -> Self {
        let count = u32::try_from(boxes.len()).unwrap_or(u32::MAX);
        let mut made = Self { boxes, order: (0..count).collect(), around: Vec::new() };
        let mut order = core::mem::take(&mut made.order);
        made.divide(&mut order, 0);
        made.order = order;
        made
    }

    /// Around all of them.
    pub(super) fn bounds(&self) -> Bounds {
        self.around.first().copied().unwrap_or(Bounds::NONE)
    }

    fn of(&self, number: u32) -> Bounds {
        self.boxes.get(number as usize).copied().unwrap_or(Bounds::NONE)
    }

    /// As deep as the number of boxes can be halved.
    fn divide(&mut self, order: &mut [u32], part: usize) {
        let bounds = order.iter().fold(Bounds::NONE, |bounds, number| bounds.with(self.of(*number)));
        if self.around.len() <= part {
            self.around.resize(part + 1, Bounds::NONE);
        }
        if let Some(around) = self.around.get_mut(part) {
            *around = bounds;
        }
        if order.len() > LEAF {
            let of_x = bounds.most.x - bounds.least.x > bounds.most.y - bounds.least.y;
            let middle = |number: &u32| self.of(*number).middle(of_x);
            let half = order.len() / 2;
            order.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)).then(a.cmp(b)));
            let (left, right) = order.split_at_mut(half);
            self.divide(left, 2 * part + 1);
            self.divide(right, 2 * part + 2);
        }
    }

    /// Hands the numbers of those that touch a box to `visit`, until it says that it is enough.
    pub(super) fn find(&self, area: &Bounds, steps: &mut Steps, mut visit: impl FnMut(usize) -> bool) {
        let mut open = vec![(0, &self.order[..])];
        while let Some((part, order)) = open.pop() {
            steps.add(1);
            if !self.around.get(part).is_some_and(|around| around.touches(area)) {
                continue;
            }
            if order.len() > LEAF {
                let (left, right) = order.split_at(order.len() / 2);
                open.push((2 * part + 1, left));
                open.push((2 * part + 2, right));
                continue;
            }
            steps.add(order.len());
            for number in order {
                if self.of(*number).touches(area) && !visit(*number as usize) {
                    return;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn bounds((x, y, w, h): (f64, f64, f64, f64)) -> Bounds {
        Bounds { least: PxPoint::new(x, y), most: PxPoint::new(x + w, y + h) }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_search_finds_those_that_looking_at_each_finds(
            boxes in proptest::collection::vec((0.0..99.0, 0.0..99.0, 0.0..20.0, 0.0..20.0), 0..200),
            area in (0.0..99.0, 0.0..99.0, 0.0..30.0, 0.0..30.0),
        ) {
            let (boxes, area): (Vec<Bounds>, Bounds) = (boxes.into_iter().map(bounds).collect(), bounds(area));
            let all: Vec<usize> = (0..boxes.len()).filter(|n| boxes[*n].touches(&area)).collect();
            let mut found = Vec::new();
            BoxTree::new(boxes).find(&area, &mut Steps::default(), |n| { found.push(n); true });
            found.sort_unstable();
            prop_assert_eq!(found, all);
        }
    }
}
