//! [`Redrawn`]: the strokes of a small mark, moved until a pen that draws them leaves the ink that is there.
//!
//! As in a [trial](super::trial), a pixel is ink when its middle is within the pen's disc, and what contradicts that
//! costs the square of how far it lies off.

use super::trial::{Capsule, FARTHEST_PX, GOOD_PX2};
use crate::{
    PxVec,
    picture::{Bitmap, Pixel},
    stroke::PxPoint,
};
use core::ops::Range;

/// How far vertices move at a time, px.
pub(super) const STEPS_PX: [f64; 3] = [0.8, 0.4, 0.2];

/// Most times that all vertices are tried with one step.
const MOST_ROUNDS: usize = 6;

/// Most vertices that are moved: more is no letter, and takes long.
const MOST_VERTICES: usize = 48;

/// Less is no gain, px².
const LEAST_GAIN_PX2: f64 = 0.02;

/// How far a pen may be thinner or wider than its line seems to be where it is thin, px.
const THINNER_PX: f64 = 0.25;
const WIDER_PX: f64 = 0.25;

/// How far around its segments a vertex may move at a time, px.
const SLACK_PX: f64 = 2.5;

/// What the ink may be met worse for a vertex less, px².
pub(super) const DROPPED_PX2: f64 = 0.3;

/// What a stroke more must gain, px².
const STROKE_PX2: f64 = 1.5;

/// Most strokes that are added.
const MOST_ADDED: usize = 3;

/// Bare ink that may be a stroke begins so far from the pen's edge, px.
const BARE_PX: f64 = 0.25;

/// The strokes of a mark, and its pen.
pub(super) struct Redrawn<'a> {
    ink: &'a Bitmap,
    /// Polylines; of a closed one the first vertex is the last one, too.
    pub(super) strokes: Vec<Vec<PxPoint>>,
    /// Half the pen's width, px.
    pub(super) half_px: f64,
    /// What it may be, px.
    least_px: f64,
    most_px: f64,
    pub(super) cost: f64,
}

impl<'a> Redrawn<'a> {
    /// Strokes drawn by a pen about `width_px` wide, moved; none when they meet the ink as they are.
    pub(super) fn of(ink: &'a Bitmap, strokes: Vec<Vec<PxPoint>>, width_px: f64) -> Option<Self> {
        let vertices: usize = strokes.iter().map(Vec::len).sum();
        if vertices > MOST_VERTICES {
            return None;
        }
        let half_px = 0.5 * width_px;
        let (least_px, most_px) = (half_px - 0.5 * THINNER_PX, half_px + 0.5 * WIDER_PX);
        let mut drawn = Self { ink, strokes, half_px, least_px, most_px, cost: 0.0 };
        drawn.cost = drawn.whole_cost();
        drawn.fit_pen();
        let before = drawn.cost;
        if before > GOOD_PX2 {
            for step_px in STEPS_PX {
                drawn.descend(step_px);
            }
            drawn.bend_ends();
            drawn.add_strokes();
        }
        drawn.leave_out();
        let fewer = drawn.strokes.iter().map(Vec::len).sum::<usize>() < vertices;
        (drawn.cost < 0.5 * before || fewer && drawn.cost <= before.max(GOOD_PX2)).then_some(drawn)
    }

    /// For each pixel of a part the squared distance to the nearest of some segments.
    fn squared(&self, part: &Part, wanted: impl Fn(&[PxPoint; 2]) -> bool) -> Vec<f32> {
        let mut squared = vec![f32::INFINITY; part.len()];
        let all = self.strokes.iter().flat_map(|stroke| segments(stroke));
        all.filter(wanted).for_each(|ends| part.approach(ends, &mut squared));
        squared
    }

    /// What a pen costs in a part that draws some segments, and what lies at squared distances from others.
    fn cost_of(&self, part: &Part, others: &[f32], segments: &[[PxPoint; 2]], half_px: f64) -> f64 {
        let mut squared = others.to_vec();
        segments.iter().for_each(|ends| part.approach(*ends, &mut squared));
        #[expect(clippy::cast_possible_truncation, reason = "a width in a picture of 40 px")]
        let half = half_px as f32;
        let mut cost = 0.0;
        for (y, line) in part.rows.clone().zip(squared.chunks_exact(part.columns.len().max(1))) {
            for (x, squared) in part.columns.clone().zip(line) {
                if self.ink.get(Pixel::new(x, y)) != (*squared <= half * half) {
                    let off = f64::from((libm::sqrtf(*squared) - half).abs().min(FARTHEST_PX));
                    cost += off * off;
                }
            }
        }
        cost
    }

    /// What the strokes cost as they are.
    pub(super) fn whole_cost(&self) -> f64 {
        let all = Part::of(self.ink);
        self.cost_of(&all, &self.squared(&all, |_| true), &[], self.half_px)
    }

    /// Another width of the pen where that is better.
    fn fit_pen(&mut self) {
        let all = Part::of(self.ink);
        let everything = self.squared(&all, |_| true);
        for way in [-0.125, 0.125] {
            while self.half_px + way >= self.least_px && self.half_px + way <= self.most_px {
                let cost = self.cost_of(&all, &everything, &[], self.half_px + way);
                if cost >= self.cost - LEAST_GAIN_PX2 {
                    break;
                }
                (self.cost, self.half_px) = (cost, self.half_px + way);
            }
        }
    }

    /// Moves all vertices, those that share a place together, until no step of that length is better.
    pub(super) fn descend(&mut self, step_px: f64) {
        for _ in 0..MOST_ROUNDS {
            let before = self.cost;
            for vertex in self.vertices() {
                self.move_vertex(vertex, step_px);
            }
            self.fit_pen();
            if self.cost >= before {
                break;
            }
        }
    }

    /// One of the vertices at each place: its stroke and its index.
    fn vertices(&self) -> Vec<(usize, usize)> {
        let mut seen: Vec<PxPoint> = Vec::new();
        let mut found = Vec::new();
        for (index, stroke) in self.strokes.iter().enumerate() {
            for (vertex, at) in stroke.iter().enumerate() {
                if !seen.contains(at) {
                    seen.push(*at);
                    found.push((index, vertex));
                }
            }
        }
        found
    }

    /// Moves a vertex, and those at the same place, as long as a step is better.
    pub(super) fn move_vertex(&mut self, (stroke, vertex): (usize, usize), step_px: f64) {
        let Some(mut at) = self.strokes.get(stroke).and_then(|stroke| stroke.get(vertex)).copied() else {
            return;
        };
        let start = at;
        let touches = |ends: &[PxPoint; 2]| ends.contains(&start);
        let own: Vec<[PxPoint; 2]> =
            self.strokes.iter().flat_map(|stroke| segments(stroke)).filter(|ends| touches(ends)).collect();
        let part = Part::around(&own, self.half_px + SLACK_PX, self.ink);
        let others = self.squared(&part, |ends| !touches(ends));
        let mut here = self.cost_of(&part, &others, &own, self.half_px);
        let outside = self.cost - here;
        let mut direction = 0;
        while let Some(way) = PxVec::AXES.get(direction).copied() {
            let next = at + way * step_px;
            let moved: Vec<[PxPoint; 2]> =
                own.iter().map(|ends| ends.map(|end| if end == start { next } else { end })).collect();
            let cost = self.cost_of(&part, &others, &moved, self.half_px);
            if cost < here - LEAST_GAIN_PX2 && next.distance(start) < SLACK_PX {
                (at, here, direction) = (next, cost, 0);
            } else {
                direction += 1;
            }
        }
        self.cost = outside + here;
        for place in self.strokes.iter_mut().flatten().filter(|place| **place == start) {
            *place = at;
        }
    }

    /// Adds strokes where ink is bare.
    fn add_strokes(&mut self) {
        /// Half the length that a stroke begins with, px.
        const HALF_PX: [f64; 2] = [0.5, 2.0];
        const ALONG: [PxVec; 4] =
            [PxVec::new(1.0, 0.0), PxVec::new(0.0, 1.0), PxVec::new(0.7, 0.7), PxVec::new(0.7, -0.7)];
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
                for step_px in STEPS_PX {
                    for vertex in [0, 1] {
                        more.move_vertex((index, vertex), step_px);
                    }
                }
                if best.as_ref().is_none_or(|best| more.cost < best.cost) {
                    best = Some(more);
                }
            }
            let Some(mut best) = best.map(Self::joined) else { return };
            for step_px in STEPS_PX {
                best.descend(step_px);
            }
            if best.cost > 0.5 * self.cost || best.cost + STROKE_PX2 > self.cost {
                return;
            }
            *self = best;
        }
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
        let all = Part::of(self.ink);
        let others = self.squared(&all, |_| true);
        let mut best = (self.cost + DROPPED_PX2, last.clone());
        for (stroke, vertex) in self.vertices() {
            let Some(at) = self.strokes.get(stroke).and_then(|stroke| stroke.get(vertex)) else { continue };
            for end in 0..last.len() {
                let mut moved = last.clone();
                if let Some(place) = moved.get_mut(end) {
                    *place = *at;
                }
                let ends: Vec<[PxPoint; 2]> = segments(&moved).collect();
                let cost = self.cost_of(&all, &others, &ends, self.half_px);
                if cost <= best.0 {
                    best = (cost, moved);
                }
            }
        }
        self.with_stroke(best.1)
    }

    /// The pixel of ink that the pen leaves farthest away.
    fn barest(&self) -> Option<PxPoint> {
        let mut best: Option<(f32, PxPoint)> = None;
        let all = Part::of(self.ink);
        for (squared, pixel) in self.squared(&all, |_| true).into_iter().zip(all.pixels()) {
            if self.ink.get(pixel) && best.is_none_or(|(most, _)| squared > most) {
                best = Some((squared, pixel.into()));
            }
        }
        let (squared, at) = best?;
        let reach_px = self.half_px + BARE_PX;
        (f64::from(squared) > reach_px * reach_px).then_some(at)
    }
}

/// The segments of a polyline; of a dot one from it to itself.
fn segments(stroke: &[PxPoint]) -> impl Iterator<Item = [PxPoint; 2]> + '_ {
    let dot = if let [dot] = stroke { Some([*dot; 2]) } else { None };
    dot.into_iter().chain(stroke.iter().zip(stroke.iter().skip(1)).map(|(from, to)| [*from, *to]))
}

/// Some columns and rows of a picture.
struct Part {
    columns: Range<u32>,
    rows: Range<u32>,
}

impl Part {
    /// All of it.
    fn of(picture: &Bitmap) -> Self {
        Self { columns: 0..picture.width(), rows: 0..picture.height() }
    }

    /// What lies at most `reach_px` from the frame of some segments.
    fn around(segments: &[[PxPoint; 2]], reach_px: f64, picture: &Bitmap) -> Self {
        let range = |of: fn(&PxPoint) -> f64, side: u32| {
            let all = segments.iter().flatten().map(of);
            let low = all.clone().fold(f64::INFINITY, f64::min) - reach_px;
            let high = all.fold(f64::NEG_INFINITY, f64::max) + reach_px;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a float cast saturates"
            )]
            let range = (low as u32).min(side)..(high as u32).saturating_add(1).min(side);
            range
        };
        Self { columns: range(|at| at.x, picture.width()), rows: range(|at| at.y, picture.height()) }
    }

    fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Its pixels, row by row.
    fn pixels(&self) -> impl Iterator<Item = Pixel> + '_ {
        self.rows.clone().flat_map(move |y| self.columns.clone().map(move |x| Pixel::new(x, y)))
    }

    /// Lessens the squared distance of each pixel to that from a segment.
    #[expect(clippy::cast_precision_loss, reason = "at most 40 columns and rows")]
    fn approach(&self, [from, to]: [PxPoint; 2], squared: &mut [f32]) {
        let pen = Capsule::new(from, to, 0.0);
        for (y, line) in self.rows.clone().zip(squared.chunks_exact_mut(self.columns.len().max(1))) {
            let y = y as f32 + 0.5;
            for (x, least) in self.columns.clone().zip(line) {
                let here = pen.squared(x as f32 + 0.5, y);
                *least = if here < *least { here } else { *least };
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn polyline(places: &[(f64, f64)]) -> Vec<PxPoint> {
        places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect()
    }

    /// What a pen 3 px wide leaves on 20 x 20 px.
    fn ink(strokes: &[Vec<PxPoint>]) -> Bitmap {
        let mut ink = Bitmap::new(20, 20).unwrap();
        let all = Part::of(&ink);
        let mut squared = vec![f32::INFINITY; all.len()];
        strokes.iter().flat_map(|stroke| segments(stroke)).for_each(|ends| all.approach(ends, &mut squared));
        all.pixels().zip(squared).for_each(|(pixel, squared)| ink.set(pixel, squared <= 2.25));
        ink
    }

    pub(in super::super) fn redrawn(
        drawn: &[Vec<PxPoint>],
        found: &[&[(f64, f64)]],
    ) -> Option<Vec<Vec<PxPoint>>> {
        let ink = ink(drawn);
        let strokes = found.iter().map(|stroke| polyline(stroke)).collect();
        Some(Redrawn::of(&ink, strokes, 3.0)?.strokes)
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
