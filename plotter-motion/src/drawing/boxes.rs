//! [`BoxTree`]: which of many boxes meet another one, without asking each of them.

use super::Bounds;
use alloc::collections::BinaryHeap;
use alloc::vec::Vec;
use core::ops::ControlFlow;

/// Most boxes of a leaf: so few are asked one by one as quickly as by way of halves.
const LEAF: usize = 8;

/// Boxes, halved again and again along the longer side of the box round them.
///
/// Its size grows with the number of boxes alone, however large and far apart they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BoxTree {
    /// Each box with its number, ordered so that every node has a range of them.
    items: Vec<(usize, Bounds)>,
    /// A node stands before all nodes within it.
    nodes: Vec<Node>,
}

#[derive(Clone, Debug, PartialEq)]
struct Node {
    bounds: Bounds,
    /// The greatest number within it.
    greatest: usize,
    /// Its items, of a leaf.
    begin: usize,
    end: usize,
    /// The node behind all those within it.
    next: usize,
}

impl BoxTree {
    /// Boxes are known by their number, from 0; empty ones are never found.
    pub(super) fn new(boxes: impl IntoIterator<Item = Bounds>) -> Self {
        let items: Vec<_> = boxes.into_iter().enumerate().filter(|(_, bounds)| !bounds.is_empty()).collect();
        let mut tree = Self { nodes: Vec::new(), items };
        tree.halve(0, tree.items.len());
        tree
    }

    /// Calls itself as deep as boxes can be halved: 61 times for all that memory can hold.
    fn halve(&mut self, begin: usize, end: usize) {
        let Some(items) = self.items.get_mut(begin..end) else { return };
        let mut node = Node {
            bounds: Bounds::default(),
            greatest: 0,
            begin,
            end,
            next: self.nodes.len().saturating_add(1),
        };
        for (number, bounds) in &*items {
            node.greatest = node.greatest.max(*number);
            node.bounds.join(bounds);
        }
        let at = self.nodes.len();
        let middle = items.len() / 2;
        if items.len() <= LEAF {
            self.nodes.push(node);
            return;
        }
        let (width_mm, height_mm) = node.bounds.size_mm();
        let twice_centre = |(_, bounds): &(usize, Bounds)| {
            if width_mm > height_mm { bounds.least.x + bounds.most.x } else { bounds.least.y + bounds.most.y }
        };
        items.select_nth_unstable_by(middle, |a, b| twice_centre(a).total_cmp(&twice_centre(b)));
        node.end = begin;
        self.nodes.push(node);
        self.halve(begin, begin + middle);
        self.halve(begin + middle, end);
        let next = self.nodes.len();
        if let Some(node) = self.nodes.get_mut(at) {
            node.next = next;
        }
    }

    /// The box round all of them.
    pub(super) fn bounds(&self) -> Bounds {
        self.nodes.first().map_or_else(Bounds::default, |root| root.bounds)
    }

    fn items_of(&self, node: &Node) -> &[(usize, Bounds)] {
        self.items.get(node.begin..node.end).unwrap_or_default()
    }

    /// The numbers of the boxes that are met, in no order. Where `meets` is false of a box it must be false
    /// of all boxes within that.
    pub(super) fn each(&self, meets: impl Fn(&Bounds) -> bool, mut found: impl FnMut(usize)) {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !meets(&node.bounds) {
                at = node.next;
                continue;
            }
            self.items_of(node)
                .iter()
                .filter(|(_, bounds)| meets(bounds))
                .for_each(|(number, _)| found(*number));
            at += 1;
        }
    }

    /// The numbers of the boxes that are met, from the greatest down to `least`, until `found` breaks off.
    pub(super) fn back_from_last(
        &self,
        least: usize,
        meets: impl Fn(&Bounds) -> bool,
        mut found: impl FnMut(usize) -> ControlFlow<()>,
    ) {
        // What is not yet looked into: nodes by the greatest number within them, and boxes.
        let mut open: BinaryHeap<(usize, Option<usize>)> = BinaryHeap::new();
        let look = |open: &mut BinaryHeap<_>, at: usize| {
            let node = self.nodes.get(at).filter(|node| node.greatest >= least && meets(&node.bounds));
            if let Some(node) = node {
                open.push((node.greatest, Some(at)));
            }
        };
        look(&mut open, 0);
        while let Some((number, at)) = open.pop() {
            let Some(at) = at else {
                if found(number).is_break() {
                    return;
                }
                continue;
            };
            let Some(node) = self.nodes.get(at) else { continue };
            let items = self.items_of(node).iter();
            open.extend(
                items
                    .filter(|(number, bounds)| *number >= least && meets(bounds))
                    .map(|(number, _)| (*number, None)),
            );
            let mut within = at + 1;
            while within < node.next {
                look(&mut open, within);
                within = self.nodes.get(within).map_or(node.next, |node| node.next);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Point;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<Bounds>> {
        let number = prop_oneof![9 => -50.0..50.0, 1 => Just(1e30), 1 => Just(f64::NAN)];
        let place = (number.clone(), number).prop_map(|(x, y)| Point::new(x, y));
        let bounds = (place, 0.0..20.0, 0.0..20.0).prop_map(|(least, width, height)| Bounds {
            least,
            most: Point::new(least.x + width, least.y + height),
        });
        proptest::collection::vec(bounds, 0..80)
    }

    proptest! {
        #[test]
        fn it_finds_what_asking_each_finds(boxes in boxes(), asked in 0..80_usize, least in 0..80_usize, most in 0..80_usize) {
            let Some(asked) = boxes.get(asked).copied() else { return Ok(()) };
            let tree = BoxTree::new(boxes.iter().copied());
            let wanted: Vec<usize> = (0..boxes.len()).filter(|at| asked.meets(&boxes[*at])).collect();
            let mut found = Vec::new();
            tree.each(|bounds| asked.meets(bounds), |at| found.push(at));
            found.sort_unstable();
            prop_assert_eq!(&found, &wanted);
            let mut found = Vec::new();
            tree.back_from_last(least, |bounds| asked.meets(bounds), |at| {
                found.push(at);
                if found.len() > most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            });
            let last: Vec<usize> = wanted.into_iter().rev().filter(|at| *at >= least).take(most + 1).collect();
            prop_assert_eq!(found, last);
        }
    }
}
