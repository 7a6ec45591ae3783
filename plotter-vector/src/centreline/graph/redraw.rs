//! [`Redrawn`]: the strokes of a small mark, moved until a pen that draws them leaves the ink that is there.

use crate::centreline::fit::prices::{GAIN_PX2, RASTER_PX2, STROKE_PX2, VERTEX_PX2};
use crate::centreline::fit::search::{distinct, settle, shifted};
use crate::centreline::fit::{Canvas, Capsule};
use crate::{PxVec, stroke::PxPoint};

/// Most times that all vertices are tried with one step.
const MOST_ROUNDS: usize = 6;

/// Most vertices that are moved: more is no letter, and takes long.
const MOST_VERTICES: usize = 48;

/// How far a pen's edge may lie from where its line seems to have it where it is thin, px.
const EDGE_PX: f64 = 0.125;

/// Most strokes that are added.
const MOST_ADDED: usize = 3;

/// Bare ink that may be a stroke begins so far from the pen's edge, px.
const BARE_PX: f64 = 0.25;

/// The strokes of a mark, and its pen.
#[derive(Clone)]
pub(super) struct Redrawn<'a> {
    canvas: &'a Canvas,
    /// Polylines; of a closed one the first vertex is the last one, too.
    pub(super) strokes: Vec<Vec<PxPoint>>,
    /// Half the pen's width, and what it seems to be, px.
    pub(super) half_px: f64,
    seen_px: f64,
    pub(super) cost: f64,
}

impl<'a> Redrawn<'a> {
    /// Strokes drawn by a pen about `width_px` wide, moved; none when they meet the ink as they are.
    pub(super) fn of(canvas: &'a Canvas, strokes: Vec<Vec<PxPoint>>, width_px: f64) -> Option<Self> {
        let vertices: usize = strokes.iter().map(Vec::len).sum();
        if vertices > MOST_VERTICES {
            return None;
        }
        let half_px = 0.5 * width_px;
        let mut drawn = Self { canvas, strokes, half_px, seen_px: half_px, cost: 0.0 };
        drawn.cost = drawn.whole_cost();
        drawn.fit_pen();
        let worth = drawn.worth();
        if drawn.cost > RASTER_PX2 {
            drawn.settle_all();
            drawn.bend_ends();
            drawn.add_strokes();
        }
        drawn.leave_out();
        (drawn.worth() < worth).then_some(drawn)
    }

    /// Its pen along some of its segments.
    fn pens(&self, half_px: f64, wanted: impl Fn(&[PxPoint; 2]) -> bool) -> Vec<Capsule> {
        let segments = self.strokes.iter().flat_map(|stroke| segments(stroke)).filter(wanted);
        segments.map(|[from, to]| Capsule::new(from, to, half_px)).collect()
    }

    /// What the strokes cost as they are.
    fn whole_cost(&self) -> f64 {
        self.cost_of(self.half_px)
    }

    /// The same with another pen.
    fn cost_of(&self, half_px: f64) -> f64 {
        let pens = self.pens(half_px, |_| true);
        self.canvas.residual(&self.canvas.layer(&[]), &pens, f64::INFINITY).unwrap_or(f64::INFINITY)
    }

    /// Another width of the pen where that is better.
    fn fit_pen(&mut self) {
        for half_px in [self.seen_px - EDGE_PX, self.seen_px, self.seen_px + EDGE_PX] {
            let cost = self.cost_of(half_px);
            if cost < self.cost - GAIN_PX2 {
                (self.cost, self.half_px) = (cost, half_px);
            }
        }
    }

    /// Moves all vertices, those that share a place together, and changes the pen, until nothing is better.
    pub(super) fn settle_all(&mut self) {
        settle(self, MOST_ROUNDS, Self::vertices, |drawn, at, step_px| {
            let moved = drawn.shift(at, step_px);
            drawn.fit_pen();
            moved
        });
    }

    /// Moves some vertices, given as their strokes and indices.
    pub(super) fn settle_some(&mut self, vertices: &[(usize, usize)], rounds: usize) {
        let places = |drawn: &Self| {
            let at = |(stroke, vertex): &(usize, usize)| drawn.strokes.get(*stroke)?.get(*vertex).copied();
            distinct(vertices.iter().filter_map(at))
        };
        settle(self, rounds, places, Self::shift);
    }

    /// The places of all vertices.
    fn vertices(&self) -> Vec<PxPoint> {
        distinct(self.strokes.iter().flatten().copied())
    }

    /// Moves the vertices at a place as long as a step is better; whether it was.
    fn shift(&mut self, start: PxPoint, step_px: f64) -> bool {
        let touches = |ends: &[PxPoint; 2]| ends.contains(&start);
        let others = self.canvas.layer(&self.pens(self.half_px, |ends| !touches(ends)));
        let own: Vec<[PxPoint; 2]> =
            self.strokes.iter().flat_map(|stroke| segments(stroke)).filter(touches).collect();
        let (at, cost) = shifted(start, step_px, self.cost, |to, cost| {
            let moved = |end: PxPoint| if end == start { to } else { end };
            let pens: Vec<Capsule> =
                own.iter().map(|[a, b]| Capsule::new(moved(*a), moved(*b), self.half_px)).collect();
            self.canvas.residual(&others, &pens, cost - GAIN_PX2)
        });
        self.cost = cost;
        self.strokes.iter_mut().flatten().filter(|place| **place == start).for_each(|place| *place = at);
        at != start
    }

    /// Adds strokes where ink is bare.
    fn add_strokes(&mut self) {
        /// Half the length that a stroke begins with, px.
        const HALF_PX: [f64; 2] = [0.5, 2.0];
        const HALF: f64 = core::f64::consts::FRAC_1_SQRT_2;
        const ALONG: [PxVec; 4] =
            [PxVec::new(1.0, 0.0), PxVec::new(0.0, 1.0), PxVec::new(HALF, HALF), PxVec::new(HALF, -HALF)];
        for _ in 0..MOST_ADDED {
            if self.cost <= STROKE_PX2 {
                return;
            }
            let Some(bare) = self.barest() else { return };
            let mut best: Option<Self> = None;
            for (half_px, along) in HALF_PX.into_iter().flat_map(|half| ALONG.map(|along| (half, along))) {
                let ends = [bare - along * half_px, bare + along * half_px];
                let mut more = self.with_stroke(ends.to_vec());
                let index = more.strokes.len() - 1;
                more.settle_some(&[(index, 0), (index, 1)], 1);
                if best.as_ref().is_none_or(|best| more.cost < best.cost) {
                    best = Some(more);
                }
            }
            let Some(mut best) = best.map(Self::joined) else { return };
            best.settle_all();
            if best.worth() >= self.worth() {
                return;
            }
            *self = best;
        }
    }

    /// What they cost, with the prices of what is drawn.
    pub(super) fn worth(&self) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "some tens")]
        let (vertices, strokes) = (self.vertices().len() as f64, self.strokes.len() as f64);
        self.cost + VERTEX_PX2 * vertices + STROKE_PX2 * strokes
    }

    /// The same pen with other strokes.
    pub(super) fn with(&self, strokes: Vec<Vec<PxPoint>>) -> Self {
        let mut other = Self { strokes, ..*self };
        other.cost = other.whole_cost();
        other
    }

    /// The same with a stroke more.
    fn with_stroke(&self, stroke: Vec<PxPoint>) -> Self {
        self.with(self.strokes.iter().cloned().chain([stroke]).collect())
    }

    /// The last stroke begins or ends where a vertex of another one is, if the ink allows it: pens are lifted elsewhere.
    fn joined(mut self) -> Self {
        let Some(last) = self.strokes.pop() else { return self };
        let others = self.canvas.layer(&self.pens(self.half_px, |_| true));
        let mut best = (self.cost + VERTEX_PX2, last.clone());
        for at in self.vertices() {
            for end in 0..last.len() {
                let mut moved = last.clone();
                moved.iter_mut().skip(end).take(1).for_each(|place| *place = at);
                let pens: Vec<Capsule> =
                    segments(&moved).map(|[from, to]| Capsule::new(from, to, self.half_px)).collect();
                if let Some(cost) = self.canvas.residual(&others, &pens, best.0) {
                    best = (cost, moved);
                }
            }
        }
        self.with_stroke(best.1)
    }

    /// The pixel of ink that the pen leaves farthest away.
    fn barest(&self) -> Option<PxPoint> {
        let barest = self.canvas.barest(&self.pens(self.half_px, |_| true));
        barest.filter(|(_, off_px)| *off_px > BARE_PX).map(|(at, _)| at)
    }
}

/// The segments of a polyline; of a dot one from it to itself.
fn segments(stroke: &[PxPoint]) -> impl Iterator<Item = [PxPoint; 2]> + '_ {
    let dot = if let [dot] = stroke { Some([*dot; 2]) } else { None };
    dot.into_iter().chain(stroke.iter().zip(stroke.iter().skip(1)).map(|(from, to)| [*from, *to]))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::picture::{Bitmap, Pixel};

    pub(in super::super) fn polyline(places: &[(f64, f64)]) -> Vec<PxPoint> {
        places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect()
    }

    /// What a pen 3 px wide leaves on 20 x 20 px.
    fn ink(strokes: &[Vec<PxPoint>]) -> Bitmap {
        let mut ink = Bitmap::new(20, 20).unwrap();
        let off_px = |at: PxPoint, [from, to]: [PxPoint; 2]| {
            let way = to - from;
            let part = (at - from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
            at.distance(from + way * part.clamp(0.0, 1.0))
        };
        for at in (0..20).flat_map(|y| (0..20).map(move |x| Pixel::new(x, y))) {
            let mut all = strokes.iter().flat_map(|stroke| segments(stroke));
            ink.set(at, all.any(|ends| off_px(at.into(), ends) <= 1.5));
        }
        ink
    }

    pub(in super::super) fn redrawn(
        drawn: &[Vec<PxPoint>],
        found: &[&[(f64, f64)]],
    ) -> Option<Vec<Vec<PxPoint>>> {
        let ink = ink(drawn);
        let strokes = found.iter().map(|stroke| polyline(stroke)).collect();
        Some(Redrawn::of(&Canvas::of(&ink), strokes, 3.0)?.strokes)
    }

    /// Half a pixel of the raster's, and a step.
    const NEAR_PX: f64 = 0.7;

    #[test]
    fn a_corner_that_was_cut_goes_where_the_ink_has_it() {
        let drawn = [polyline(&[(4.3, 3.1), (14.8, 4.2), (6.2, 15.6)])];
        let found = redrawn(&drawn, &[&[(5.0, 3.4), (13.1, 4.9), (6.9, 14.5)]]).unwrap();
        assert_eq!(found.len(), 1);
        for (found, drawn) in found[0].iter().zip(&drawn[0]) {
            assert!(found.distance(*drawn) < NEAR_PX, "{found:?} for {drawn:?}");
        }
    }

    #[test]
    fn lines_that_share_a_place_go_on_sharing_it() {
        // A T: the second line ends at a vertex of the first one.
        let drawn =
            [polyline(&[(4.0, 4.0), (15.0, 10.0), (4.0, 16.0)]), polyline(&[(15.0, 10.0), (18.0, 17.0)])];
        let found = [&[(4.0, 4.0), (13.0, 11.0), (4.0, 16.0)][..], &[(13.0, 11.0), (18.0, 17.0)]];
        let found = redrawn(&drawn, &found).unwrap();
        assert_eq!(found[0][1], found[1][0]);
        assert!(found[0][1].distance(drawn[0][1]) < NEAR_PX, "{found:?}");
    }

    #[test]
    fn the_flag_of_a_one_is_found() {
        let drawn = [polyline(&[(6.2, 7.4), (10.4, 4.2), (10.4, 16.4)])];
        let found = redrawn(&drawn, &[&[(10.4, 4.2), (10.4, 16.4)]]).unwrap();
        let flag = drawn[0][0];
        let nearest = found.iter().flatten().map(|at| at.distance(flag)).fold(f64::INFINITY, f64::min);
        assert!(found.len() == 1 && found[0].len() == 3 && nearest < 2.0 * NEAR_PX, "{found:?}");
    }

    #[test]
    fn a_vertex_on_a_straight_line_goes() {
        let drawn = [polyline(&[(4.0, 4.0), (15.0, 12.0)])];
        let found = redrawn(&drawn, &[&[(4.0, 4.0), (9.0, 9.5), (15.0, 12.0)]]).unwrap();
        assert_eq!(found[0].len(), 2);
    }

    #[test]
    fn what_meets_the_ink_stays() {
        let drawn = [polyline(&[(4.3, 3.1), (14.8, 4.2), (6.2, 15.6)])];
        assert_eq!(redrawn(&drawn, &[&[(4.3, 3.1), (14.8, 4.2), (6.2, 15.6)]]), None);
    }
}
