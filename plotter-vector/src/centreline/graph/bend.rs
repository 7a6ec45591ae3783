//! [`Redrawn::bend_ends`]: the end of a stroke that comes to another one at another place, round a corner.
//!
//! ```text
//!    |            |
//!    |-----       |  /---     what is left of the counter between both is less than the pen's disc:
//!    |            |/          the ink is filled, and thinning sees the shorter way
//! ```

use super::redraw::Redrawn;
use crate::centreline::fit::prices::VERTEX_PX2;
use crate::stroke::{PxPoint, PxVec};

/// Most ends that are bent.
const MOST_BENT: usize = 2;

/// Most ways of bending an end in which all vertices are moved.
const MOST_TRIED: usize = 3;

/// How far from a stroke's end its new corner is looked for, and how far along the other stroke its new end, widths of the pen.
const AWAY_WIDTHS: [f64; 2] = [1.5, 2.5];

/// Farthest place of another stroke that an end comes to, px.
const ON_PX: f64 = 1.0;

impl Redrawn<'_> {
    /// Bends ends of strokes where that meets the ink so much better that it is worth a vertex.
    pub(super) fn bend_ends(&mut self) {
        for _ in 0..MOST_BENT {
            if self.cost <= VERTEX_PX2 {
                return;
            }
            let ends = (0..self.strokes.len()).flat_map(|index| [(index, false), (index, true)]);
            let mut all: Vec<Self> = ends.flat_map(|(index, last)| self.bent(index, last)).collect();
            all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            all.truncate(MOST_TRIED);
            for bent in &mut all {
                bent.settle_all();
                while bent.join_ends() {}
            }
            let good = all.into_iter().filter(|bent| bent.worth() < self.worth());
            let Some(best) = good.min_by(|a, b| a.worth().total_cmp(&b.worth())) else { return };
            *self = best;
        }
    }

    /// A stroke's end bent in all ways that are tried.
    fn bent(&self, index: usize, last: bool) -> Vec<Self> {
        let Some(stroke) = self.strokes.get(index).filter(|stroke| stroke.len() > 1) else {
            return Vec::new();
        };
        let mut own = stroke.clone();
        if !last {
            own.reverse();
        }
        let [.., before, end] = own.as_slice() else { return Vec::new() };
        let (before, end) = (*before, *end);
        let length = before.distance(end);
        let mut found = Vec::new();
        for (away, along) in self
            .directions_at(end, (index, last))
            .into_iter()
            .flat_map(|along| AWAY_WIDTHS.map(|away| (away, along)))
        {
            let away_px = 2.0 * self.half_px * away;
            if away_px + 1.0 > length {
                continue;
            }
            let PxVec { x, y } = before - end;
            let corner = end + PxVec::new(x / length, y / length) * away_px;
            let mut bent = own.clone();
            bent.pop();
            bent.extend([corner, end + along * away_px]);
            let places = [bent.len() - 2, bent.len() - 1];
            let places = if last { places } else { [1, 0] };
            if !last {
                bent.reverse();
            }
            let mut strokes = self.strokes.clone();
            if let Some(stroke) = strokes.get_mut(index) {
                *stroke = bent;
            }
            let mut other = self.with(strokes);
            other.settle_some(&places.map(|vertex| (index, vertex)), 2);
            found.push(other);
        }
        found
    }

    /// The directions in which other segments than that of the end itself go on from where it lies.
    fn directions_at(&self, end: PxPoint, (index, last): (usize, bool)) -> Vec<PxVec> {
        let closed = self.strokes.get(index).is_some_and(|stroke| stroke.first() == stroke.last());
        let mut meets_other = !closed;
        let mut found = Vec::new();
        for (other, stroke) in self.strokes.iter().enumerate() {
            let segments = stroke.len().saturating_sub(1);
            for (at, pair) in stroke.windows(2).enumerate() {
                let is_own = other == index && at == if last { segments - 1 } else { 0 };
                let [a, b] = pair else { continue };
                let length = a.distance(*b);
                if is_own || length <= 0.0 {
                    continue;
                }
                let PxVec { x, y } = *b - *a;
                let (dx, dy) = (x / length, y / length);
                let PxVec { x: u, y: v } = end - *a;
                let along = u * dx + v * dy;
                let across = (v * dx - u * dy).abs();
                if across > ON_PX || along < -ON_PX || along > length + ON_PX {
                    continue;
                }
                meets_other |= other != index;
                if along < length - ON_PX {
                    found.push(PxVec::new(dx, dy));
                }
                if along > ON_PX {
                    found.push(PxVec::new(-dx, -dy));
                }
            }
        }
        // A ring that nothing meets has no end.
        if meets_other { found } else { Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::redraw::tests::{polyline, redrawn};

    /// Half of the pen's width: what is filled between two of its lines hides where they meet.
    const NEAR_PX: f64 = 1.5;

    #[test]
    fn a_line_that_comes_round_a_corner_to_its_own_start_is_bent() {
        // A 6. The line that closes its bowl is found as going straight on to the corner above.
        let drawn = polyline(&[
            (10.4, 1.8),
            (4.2, 6.3),
            (4.2, 17.0),
            (15.0, 17.0),
            (15.0, 6.3),
            (9.1, 6.3),
            (4.2, 11.2),
        ]);
        let bowl = [(4.2, 6.3), (15.0, 6.3), (15.0, 17.0), (4.2, 17.0), (4.2, 6.3)];
        let found = redrawn(std::slice::from_ref(&drawn), &[&[(10.4, 1.8), (4.2, 6.3)], &bowl]).unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].len(), drawn.len(), "{found:?}");
        let mut found = found[0].clone();
        if found[0].y > 8.0 {
            found.reverse();
        }
        for (found, drawn) in found.iter().zip(&drawn) {
            assert!(found.distance(*drawn) < NEAR_PX, "{found:?} for {drawn:?}");
        }
    }

    #[test]
    fn a_line_that_ends_on_another_stays_straight() {
        let drawn = [polyline(&[(4.2, 2.0), (4.2, 17.0)]), polyline(&[(4.2, 9.3), (16.0, 9.3)])];
        let found = redrawn(&drawn, &[&[(4.2, 2.0), (4.2, 17.0)], &[(5.6, 8.1), (15.2, 10.4)]]).unwrap();
        assert_eq!(found.iter().map(Vec::len).sum::<usize>(), 4, "{found:?}");
    }
}
