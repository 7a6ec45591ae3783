//! [`Redrawn::leave_out`]: a mark without the strokes and vertices that its ink does not need.

use super::redraw::Redrawn;
use crate::centreline::fit::prices::STROKE_PX2;
use crate::stroke::{PxPoint, PxVec};

/// Much more than moving the vertices beside a gap can mend, px².
const HOPELESS_PX2: f64 = 2.0 * STROKE_PX2;

/// Ends of two strokes so near each other may be one place, px.
const SAME_PLACE_PX: f64 = 3.0;

impl Redrawn<'_> {
    /// Leaves out what the ink does not need, and makes one stroke of two that end in one place.
    pub(super) fn leave_out(&mut self) {
        self.drop_strokes();
        self.merge_ends();
        while self.join_ends() {}
        self.drop_vertices();
    }

    /// Takes other strokes when they meet the ink nearly as well, once some of their vertices have moved.
    fn try_others(&mut self, strokes: Vec<Vec<PxPoint>>, vertices: &[(usize, usize)]) -> bool {
        let mut other = self.with(strokes);
        if other.cost < self.cost + HOPELESS_PX2 {
            other.settle_some(vertices, 1);
        }
        let taken = other.worth() <= self.worth();
        if taken {
            *self = other;
        }
        taken
    }

    /// Strokes whose ink other ones leave too, and dots that the nearest vertex may take the place of.
    fn drop_strokes(&mut self) {
        let mut index = 0;
        while index < self.strokes.len() && self.strokes.len() > 1 {
            let mut strokes = self.strokes.clone();
            let gone = strokes.remove(index);
            let dot = gone.first().copied().filter(|first| gone.iter().all(|at| at == first));
            let taken = self.try_others(strokes.clone(), &[])
                || dot.is_some_and(|dot| self.try_at_vertex(strokes, dot));
            index += usize::from(!taken);
        }
    }

    /// Takes other strokes with their vertex nearest to a place moved there, when they meet the ink nearly as well.
    fn try_at_vertex(&mut self, mut strokes: Vec<Vec<PxPoint>>, place: PxPoint) -> bool {
        let nearest =
            strokes.iter().flatten().copied().min_by(|a, b| a.distance(place).total_cmp(&b.distance(place)));
        let Some(nearest) = nearest.filter(|at| at.distance(place) < SAME_PLACE_PX) else { return false };
        strokes.iter_mut().flatten().filter(|at| **at == nearest).for_each(|at| *at = place);
        let index = strokes.iter().position(|stroke| stroke.contains(&place)).unwrap_or(0);
        let around =
            strokes.get(index).and_then(|stroke| stroke.iter().position(|at| *at == place)).unwrap_or(0);
        let vertices = [(index, around), (index, around.saturating_sub(1)), (index, around + 1)];
        self.try_others(strokes, &vertices)
    }

    /// Ends of strokes that lie near each other, as one place.
    fn merge_ends(&mut self) {
        for index in 0..self.strokes.len() {
            for last in [false, true] {
                let Some(from) = self.end(index, last) else { continue };
                let ends = (0..self.strokes.len()).filter(|other| *other != index);
                let near = ends
                    .flat_map(|other| [self.end(other, false), self.end(other, true)])
                    .flatten()
                    .filter(|to| *to != from && to.distance(from) < SAME_PLACE_PX)
                    .min_by(|a, b| a.distance(from).total_cmp(&b.distance(from)));
                let Some(to) = near else { continue };
                let middle = PxPoint::new(f64::midpoint(from.x, to.x), f64::midpoint(from.y, to.y));
                let merged = |at: &PxPoint| if *at == from || *at == to { middle } else { *at };
                let strokes: Vec<Vec<PxPoint>> =
                    self.strokes.iter().map(|stroke| stroke.iter().map(merged).collect()).collect();
                let same =
                    |stroke: &Vec<PxPoint>| stroke.iter().zip(stroke.iter().skip(1)).any(|(a, b)| a == b);
                if !strokes.iter().any(same) {
                    let end = strokes.get(index).map_or(0, |stroke| stroke.len().saturating_sub(1));
                    self.try_others(strokes, &[(index, if last { end } else { 0 })]);
                }
            }
        }
    }

    /// The first or last place of a stroke that goes from one to another.
    fn end(&self, index: usize, last: bool) -> Option<PxPoint> {
        let stroke = self.strokes.get(index).filter(|stroke| stroke.first() != stroke.last())?;
        if last { stroke.last().copied() } else { stroke.first().copied() }
    }

    /// Joins two strokes that end in one place: of several the two that go on the straightest. False without such.
    pub(super) fn join_ends(&mut self) -> bool {
        let ends: Vec<(usize, bool)> =
            (0..self.strokes.len()).flat_map(|index| [(index, false), (index, true)]).collect();
        let pairs = ends
            .iter()
            .enumerate()
            .flat_map(|(nth, one)| ends.iter().skip(nth + 1).map(move |other| (*one, *other)));
        let meet = |(one, other): &((usize, bool), (usize, bool))| {
            let place = self.end(one.0, one.1);
            one.0 != other.0 && place.is_some() && place == self.end(other.0, other.1)
        };
        let hairpin = |(one, other): &((usize, bool), (usize, bool))| {
            let (a, b) = (self.outward(*one), self.outward(*other));
            a.dot(b)
        };
        let straightest = pairs.filter(meet).min_by(|a, b| hairpin(a).total_cmp(&hairpin(b)));
        let Some((one, other)) = straightest else { return false };
        // The later one first: then the earlier one keeps its number.
        let (Some(mut tail), Some(head)) = (self.take(other.0), self.strokes.get_mut(one.0)) else {
            return false;
        };
        if !one.1 {
            head.reverse();
        }
        if other.1 {
            tail.reverse();
        }
        head.extend(tail.into_iter().skip(1));
        true
    }

    /// The direction in which a stroke ends.
    fn outward(&self, (index, last): (usize, bool)) -> PxVec {
        let Some(stroke) = self.strokes.get(index) else { return PxVec::default() };
        let (end, inner) = if last {
            (stroke.last(), stroke.len().checked_sub(2).and_then(|inner| stroke.get(inner)))
        } else {
            (stroke.first(), stroke.get(1))
        };
        let (Some(end), Some(inner)) = (end, inner) else { return PxVec::default() };
        let length = end.distance(*inner).max(f64::MIN_POSITIVE);
        let PxVec { x, y } = *end - *inner;
        PxVec::new(x / length, y / length)
    }

    fn take(&mut self, index: usize) -> Option<Vec<PxPoint>> {
        (index < self.strokes.len()).then(|| self.strokes.remove(index))
    }

    /// Vertices, of strokes with ends these too.
    fn drop_vertices(&mut self) {
        for index in 0..self.strokes.len() {
            let mut vertex = 0;
            while let Some(stroke) = self.strokes.get(index).filter(|stroke| vertex < stroke.len()) {
                let closed = stroke.first() == stroke.last();
                if stroke.len() <= if closed { 4 } else { 2 } {
                    break;
                }
                let is_end = vertex == 0 || vertex + 1 == stroke.len();
                let mut strokes = self.strokes.clone();
                if let Some(stroke) = strokes.get_mut(index) {
                    stroke.remove(vertex);
                }
                // An end stays: it may meet another stroke where the ink does not show it.
                let last = stroke.len() - 2;
                let beside = [vertex.saturating_sub(1), vertex].map(|vertex| (index, vertex));
                let moved: Vec<_> =
                    beside.into_iter().filter(|(_, at)| is_end || closed || *at > 0 && *at < last).collect();
                if closed && is_end || !self.try_others(strokes, &moved) {
                    vertex += 1;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::redraw::tests::{polyline, redrawn};

    #[test]
    fn strokes_that_end_in_one_place_are_one() {
        // The third one ends at a crossing of all: the two that go on the straightest are joined.
        let (middle, drawn) = ((10.0, 10.0), polyline(&[(4.0, 4.0), (16.0, 15.5)]));
        let drawn = [drawn, polyline(&[middle, (4.0, 16.0)])];
        let found =
            redrawn(&drawn, &[&[middle, (4.0, 16.0)], &[middle, (4.0, 4.0)], &[(16.0, 14.0), middle]])
                .unwrap();
        let lengths: Vec<usize> = found.iter().map(Vec::len).collect();
        assert!(lengths.iter().sum::<usize>() < 6 && lengths.len() == 2, "{found:?}");
    }

    #[test]
    fn a_gap_at_a_corner_is_closed() {
        let drawn = [polyline(&[(4.0, 8.0), (9.0, 4.0), (9.0, 16.0)])];
        let found = redrawn(&drawn, &[&[(4.0, 8.0), (8.4, 5.2)], &[(9.2, 3.8), (9.0, 16.0)]]).unwrap();
        assert!(found.len() == 1 && found[0].len() == 3, "{found:?}");
    }

    #[test]
    fn a_stroke_upon_another_goes() {
        let drawn = [polyline(&[(4.0, 4.0), (16.0, 15.5)])];
        let found = redrawn(&drawn, &[&[(4.0, 4.0), (16.0, 15.5)], &[(7.0, 7.0)]]).unwrap();
        assert_eq!(found, drawn);
    }

    #[test]
    fn the_tail_of_a_hook_goes() {
        let drawn = [polyline(&[(4.0, 4.0), (15.0, 5.0), (5.0, 16.0)])];
        let found = redrawn(&drawn, &[&[(4.0, 4.0), (15.0, 5.0), (5.0, 16.0), (5.6, 15.2)]]).unwrap();
        assert_eq!(found[0].len(), 3, "{found:?}");
    }
}
