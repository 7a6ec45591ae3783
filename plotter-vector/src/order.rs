//! [`order`]: the same strokes with less travel.

use crate::{Drawing, PxPoint};

/// The same strokes, some drawn from their other end, ordered so that the pen travels less between them.
///
/// From the end of each stroke the pen goes to the nearest end of a stroke not yet drawn (of equally near ones to
/// that of the earlier stroke), beginning with the first stroke. Where that is not shorter than the given order, the given order
/// is returned: travel never grows. The ends lie in a k-d tree, so a stroke costs about log n.
///
/// ```
/// # use plotter_vector::{Drawing, PxPoint, order};
/// let line = |from, to| [PxPoint::new(from, 0.5), PxPoint::new(to, 0.5)];
/// let mut drawing = Drawing::new(40, 1);
/// drawing.push(line(0.5, 9.5));
/// drawing.push(line(30.5, 39.5));
/// drawing.push(line(20.5, 10.5));
/// assert_eq!(drawing.pen_up_px(), 21.0 + 19.0);
/// assert_eq!(order(&drawing).pen_up_px(), 1.0 + 10.0);
/// ```
#[must_use]
pub fn order(drawing: &Drawing) -> Drawing {
    let mut tree = EndTree::new(drawing);
    let mut ordered = Drawing::new(drawing.width_px(), drawing.height_px());
    let mut next = (drawing.strokes().len() > 0).then_some(0);
    while let Some(end) = next {
        let stroke = drawing.stroke(end / 2);
        tree.remove(end & !1);
        tree.remove(end | 1);
        let pen = if end % 2 == 0 {
            ordered.push(stroke.iter().copied());
            stroke.last()
        } else {
            ordered.push(stroke.iter().rev().copied());
            stroke.first()
        };
        next = pen.and_then(|pen| tree.nearest(*pen));
    }
    if ordered.pen_up_px() < drawing.pen_up_px() { ordered } else { drawing.clone() }
}

/// A stroke's end: twice the stroke's index, and 1 more for its last vertex.
#[derive(Clone, Copy, Debug)]
struct End {
    at: PxPoint,
    id: usize,
}

/// The ends of the strokes in a balanced k-d tree that forgets: the node of a range is its middle element, the
/// halves are its subtrees, split by x and y in turn.
struct EndTree {
    ends: Vec<End>,
    /// Ends left in the subtree of each node.
    left: Vec<usize>,
    /// Node of each end.
    nodes: Vec<usize>,
}

impl EndTree {
    fn new(drawing: &Drawing) -> Self {
        let mut ends: Vec<End> = Vec::with_capacity(2 * drawing.strokes().len());
        for (index, stroke) in drawing.strokes().enumerate() {
            for (last, at) in [stroke.first(), stroke.last()].into_iter().enumerate() {
                ends.push(End { at: at.copied().unwrap_or_default(), id: 2 * index + last });
            }
        }
        let mut left = vec![0; ends.len()];
        split(&mut ends, &mut left, false);
        let mut nodes = vec![0; ends.len()];
        for (node, end) in ends.iter().enumerate() {
            if let Some(slot) = nodes.get_mut(end.id) {
                *slot = node;
            }
        }
        Self { ends, left, nodes }
    }

    /// Takes an end out of the tree.
    fn remove(&mut self, id: usize) {
        let Some(node) = self.nodes.get(id).copied() else { return };
        let (mut low, mut high) = (0, self.ends.len());
        while low < high {
            let middle = low + (high - low) / 2;
            if let Some(count) = self.left.get_mut(middle) {
                *count = count.saturating_sub(1);
            }
            match node.cmp(&middle) {
                core::cmp::Ordering::Less => high = middle,
                core::cmp::Ordering::Equal => {
                    // Marked as gone: an end that is gone is not a candidate, its subtrees may be.
                    if let Some(slot) = self.nodes.get_mut(id) {
                        *slot = usize::MAX;
                    }
                    return;
                }
                core::cmp::Ordering::Greater => low = middle + 1,
            }
        }
    }

    /// The nearest end that is left.
    fn nearest(&self, pen: PxPoint) -> Option<usize> {
        let mut best = None;
        self.search(pen, 0, self.ends.len(), false, &mut best);
        best.map(|(_, id)| id)
    }

    /// Searches the range `low..high`; the recursion is as deep as the tree, the logarithm of the number of ends.
    fn search(&self, pen: PxPoint, low: usize, high: usize, by_y: bool, best: &mut Option<(f64, usize)>) {
        let middle = low + (high - low) / 2;
        let Some(end) = self.ends.get(middle).filter(|_| low < high && self.left.get(middle) != Some(&0))
        else {
            return;
        };
        if self.nodes.get(end.id) == Some(&middle) {
            let (dx, dy) = (end.at.x - pen.x, end.at.y - pen.y);
            let found = (dx * dx + dy * dy, end.id);
            if best.is_none_or(|best| found < best) {
                *best = Some(found);
            }
        }
        let beyond = if by_y { pen.y - end.at.y } else { pen.x - end.at.x };
        let halves = [(low, middle), (middle + 1, high)];
        let (near, far) = if beyond < 0.0 { (halves[0], halves[1]) } else { (halves[1], halves[0]) };
        self.search(pen, near.0, near.1, !by_y, best);
        // Equally near ends are looked at too, so that the choice does not hang on the tree's shape.
        if best.is_none_or(|(distance, _)| beyond * beyond <= distance) {
            self.search(pen, far.0, far.1, !by_y, best);
        }
    }
}

fn split(ends: &mut [End], left: &mut [usize], by_y: bool) {
    let count = ends.len();
    if count == 0 || left.len() != count {
        return;
    }
    let middle = count / 2;
    ends.select_nth_unstable_by(middle, |a, b| {
        let (a_at, b_at) = if by_y { (a.at.y, b.at.y) } else { (a.at.x, b.at.x) };
        a_at.total_cmp(&b_at).then(a.id.cmp(&b.id))
    });
    let (low_ends, high_ends) = ends.split_at_mut(middle);
    let (low_left, high_left) = left.split_at_mut(middle);
    if let (Some((_, high_ends)), Some((own, high_left))) =
        (high_ends.split_first_mut(), high_left.split_first_mut())
    {
        *own = count;
        split(low_ends, low_left, !by_y);
        split(high_ends, high_left, !by_y);
    }
}
