//! [`Stroke`]: a stroke as it grows from fragments. What is long is simplified piece by piece, before its ends are known.
//!
//! ```text
//!   ....|=============|===============|.....     | places at every 4096th row of the picture, 2048 places apart or more
//!   open     done            done      open
//! ```
//!
//! Whether a piece is cut out depends on its own places and a few beside it, so a stroke comes to the same pieces
//! whatever it was put together from. Both pieces at a cut find the same vertex there from the places around it; it goes
//! again where the line is straight.

use super::Place;
use super::centreline::{Centreline, Whole, fill_gaps, keeps_pixels, most_smoothed_px, width_px};
use super::smooth::smooth;
use super::straight::Straightened;
use crate::stroke::Pieces;
use crate::stroke::{Bounded, Curve, PxPoint, PxVec};
use std::collections::VecDeque;

/// Where long strokes are cut.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cuts {
    /// Rows of the picture from one cut to the next.
    pub(crate) rows: i32,
    /// Fewest places of a piece.
    pub(crate) least: usize,
}

impl Default for Cuts {
    /// Shorter pieces would have more vertices, and longer ones take more memory.
    fn default() -> Self {
        Self { rows: 4096, least: 2048 }
    }
}

/// Places beside a cut that decide about its vertex, and about the smoothed line near it.
const BESIDE: usize = 64;

/// How far the places around a cut may lie from a straight line that counts as theirs, px.
const STRAIGHT_PX: f64 = 0.6;

/// Part of the tolerance of the pieces that dropping their common vertices may add.
const MORE_OF_TOLERANCE: f64 = 0.15 / 0.85;

/// A part of a stroke. Parts that follow each other share a place.
#[derive(Clone, Debug, PartialEq)]
enum Run {
    /// As it was found.
    Open(VecDeque<Place>),
    /// Simplified, with the places at its two ends.
    Done { ends: [Vec<Place>; 2], line: Vec<PxPoint> },
}

impl Run {
    fn reverse(&mut self) {
        match self {
            Self::Open(places) => places.make_contiguous().reverse(),
            Self::Done { ends, line } => {
                ends.swap(0, 1);
                ends.iter_mut().for_each(|places| places.reverse());
                line.reverse();
            }
        }
    }

    /// The places beside its start (`false`) or its end (`true`), which is not among them; none of an open one.
    fn inside(&self, at_last: bool) -> &[Place] {
        match self {
            Self::Open(_) => &[],
            Self::Done { ends: [_, end], .. } if at_last => {
                end.split_last().map_or(&[], |(_, inside)| inside)
            }
            Self::Done { ends: [start, _], .. } => start.split_first().map_or(&[], |(_, inside)| inside),
        }
    }
}

/// A stroke, or what is known of one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// The first and the last one of an open stroke are open.
    runs: VecDeque<Run>,
    /// Whether the end joins the start.
    closed: bool,
}

impl Stroke {
    pub(crate) fn new(places: Vec<Place>, closed: bool) -> Self {
        Self { runs: [Run::Open(places.into())].into(), closed }
    }

    /// Joins the end to the start.
    pub(crate) fn close(&mut self) {
        self.closed = true;
        if self.runs.len() > 1
            && let (Some(Run::Open(mut last)), Some(Run::Open(first))) =
                (self.runs.pop_back(), self.runs.pop_front())
        {
            last.extend(first);
            self.runs.push_back(Run::Open(last));
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.runs.iter().all(|run| matches!(run, Run::Open(places) if places.is_empty()))
    }

    /// Places, and vertices of what is done.
    pub(crate) fn len(&self) -> usize {
        let len = |run: &Run| match run {
            Run::Open(places) => places.len(),
            Run::Done { line, .. } => line.len(),
        };
        self.runs.iter().map(len).sum()
    }

    pub(crate) fn reverse(&mut self) {
        self.runs.make_contiguous().reverse();
        self.runs.iter_mut().for_each(Run::reverse);
    }

    /// Goes on with another one.
    pub(crate) fn append(&mut self, mut other: Self) {
        if let (Some(Run::Open(end)), Some(Run::Open(start))) = (self.runs.back_mut(), other.runs.front_mut())
        {
            reserve(end, start.len());
            end.append(start);
            other.runs.pop_front();
        }
        self.runs.append(&mut other.runs);
    }

    /// Begins with another one.
    pub(crate) fn prepend(&mut self, mut other: Self) {
        if let (Some(Run::Open(start)), Some(Run::Open(end))) = (self.runs.front_mut(), other.runs.back()) {
            reserve(start, end.len());
            end.iter().rev().for_each(|place| start.push_front(*place));
            other.runs.pop_back();
        }
        other.runs.into_iter().rev().for_each(|run| self.runs.push_front(run));
    }

    /// Whether there may be a piece to cut out.
    pub(crate) fn is_long(&self, cuts: Cuts) -> bool {
        self.runs.iter().any(|run| matches!(run, Run::Open(places) if places.len() > cuts.least))
    }

    /// Cuts out the pieces that nothing more can change, and simplifies them.
    pub(crate) fn cut(&mut self, cuts: Cuts, bounded: Bounded) {
        if !self.is_long(cuts) {
            return;
        }
        if let (true, [Run::Open(ring)]) = (self.closed, &*self.runs.make_contiguous()) {
            if let Some(runs) = cut_ring(ring, cuts, bounded) {
                self.runs = runs;
            }
            return;
        }
        let pieces = |(index, run): (usize, &Run)| match run {
            Run::Open(places) if places.len() > cuts.least => {
                let (before, after) = self.beside(index);
                let line = Stretch::new(before, places, after);
                let pieces = line.pieces(&crossings(places.iter(), cuts), cuts);
                (!pieces.is_empty()).then(|| line.cut(&pieces, bounded))
            }
            _ => None,
        };
        let cut: Vec<Option<Vec<Run>>> = self.runs.iter().enumerate().map(pieces).collect();
        if cut.iter().any(Option::is_some) {
            let runs = core::mem::take(&mut self.runs).into_iter().zip(cut);
            self.runs = runs.flat_map(|(run, cut)| cut.unwrap_or_else(|| vec![run])).collect();
        }
    }

    /// The places beside a run, of the runs before and after it.
    fn beside(&self, index: usize) -> (&[Place], &[Place]) {
        let count = self.runs.len();
        let run = |index: Option<usize>| index.and_then(|index| self.runs.get(index));
        let around = self.closed && count > 1;
        let before = index.checked_sub(1).or(around.then(|| count - 1));
        let after = if index + 1 == count && around { Some(0) } else { Some(index + 1) };
        (run(before).map_or(&[], |run| run.inside(true)), run(after).map_or(&[], |run| run.inside(false)))
    }

    /// The line with few vertices, its first one again at the end of a closed one, of the pieces that it may have: if
    /// others than lines, it must not have been cut.
    pub(crate) fn curve(mut self, cuts: Cuts, bounded: Bounded, pieces: Pieces) -> Curve {
        match self.runs.make_contiguous() {
            [Run::Open(places)] if pieces != Pieces::Lines => {
                let places = core::mem::take(places).into();
                Centreline::of(Whole { places, closed: self.closed }).curve(bounded, pieces)
            }
            _ => self.polyline(cuts, bounded).into(),
        }
    }

    fn polyline(mut self, cuts: Cuts, bounded: Bounded) -> Vec<PxPoint> {
        self.cut(cuts, bounded);
        if let [Run::Open(places)] = self.runs.make_contiguous() {
            let places = core::mem::take(places).into();
            return Centreline::of(Whole { places, closed: self.closed })
                .curve(bounded, Pieces::Lines)
                .vertices;
        }
        // Each vertex, and whether it is a cut.
        let mut vertices: Vec<(PxPoint, bool)> = Vec::new();
        let count = self.runs.len();
        for (index, run) in self.runs.iter().enumerate() {
            let line = match run {
                Run::Done { line, .. } => line.clone(),
                Run::Open(places) => {
                    let (before, after) = self.beside(index);
                    Stretch::new(before, places, after).polyline(0, places.len().saturating_sub(1), bounded)
                }
            };
            let ends = line.len().saturating_sub(1);
            let again = usize::from(!vertices.is_empty());
            let is_cut = |at: usize| at == ends && (index + 1 < count || self.closed);
            vertices
                .extend(line.into_iter().enumerate().skip(again).map(|(at, vertex)| (vertex, is_cut(at))));
        }
        if self.closed {
            turn_to_first(&mut vertices);
        } else if before(vertices.iter().rev(), vertices.iter()) {
            vertices.reverse();
        }
        without_needless_cuts(&vertices, MORE_OF_TOLERANCE * bounded.tolerance_px)
    }
}

/// Room for so many places more, without twice as much as there are.
fn reserve(places: &mut VecDeque<Place>, more: usize) {
    if places.capacity() < places.len() + more {
        places.reserve_exact(more.max(places.len() / 4));
    }
}

/// The places at which a line comes to a row of cuts, of each step over it the lower one.
fn crossings<'a>(places: impl Iterator<Item = &'a Place>, cuts: Cuts) -> Vec<usize> {
    let mut found = Vec::new();
    let mut last: Option<i32> = None;
    for (index, place) in places.enumerate() {
        let block = place.row().div_euclid(cuts.rows.max(1));
        if let Some(last) = last.filter(|last| *last != block) {
            let lower = if block > last { index } else { index - 1 };
            if found.last() != Some(&lower) {
                found.push(lower);
            }
        }
        last = Some(block);
    }
    found
}

/// Consecutive places of a stroke, with some that lie before and after them.
struct Stretch {
    places: Vec<Place>,
    /// Places before and after.
    before: usize,
    after: usize,
}

impl Stretch {
    fn new<'a>(before: &[Place], own: impl IntoIterator<Item = &'a Place>, after: &[Place]) -> Self {
        let mut places = before.to_vec();
        places.extend(own);
        places.extend_from_slice(after);
        Self { places, before: before.len(), after: after.len() }
    }

    /// Own places.
    fn len(&self) -> usize {
        self.places.len() - self.before - self.after
    }

    /// The first and last places of the pieces that can be cut out: both known, and those beside them too.
    fn pieces(&self, crossings: &[usize], cuts: Cuts) -> Vec<(usize, usize)> {
        let last = self.len().saturating_sub(1);
        // Where others are done, the stretch begins and ends with a cut.
        let start = (self.before > 0).then_some(0).filter(|start| crossings.first() != Some(start));
        let end = (self.after > 0).then_some(last).filter(|end| crossings.last() != Some(end));
        let all: Vec<usize> = start.into_iter().chain(crossings.iter().copied()).chain(end).collect();
        let pairs = all.iter().copied().zip(all.iter().copied().skip(1));
        pairs
            .filter(|(from, to)| to - from >= cuts.least)
            .filter(|(from, to)| self.before + from >= BESIDE && last - to + self.after >= BESIDE)
            .collect()
    }

    /// The runs that it becomes when pieces are cut out.
    fn cut(&self, pieces: &[(usize, usize)], bounded: Bounded) -> Vec<Run> {
        let own =
            |from: usize, to: usize| self.places.get(self.before + from..=self.before + to).unwrap_or(&[]);
        let last = self.len().saturating_sub(1);
        let mut runs = Vec::new();
        let mut done = 0;
        for (from, to) in pieces.iter().copied() {
            if from > done {
                runs.push(Run::Open(own(done, from).to_vec().into()));
            }
            let ends = [own(from, from + BESIDE).to_vec(), own(to - BESIDE, to).to_vec()];
            runs.push(Run::Done { ends, line: self.polyline(from, to, bounded) });
            done = to;
        }
        if done < last || runs.is_empty() {
            runs.push(Run::Open(own(done, last).to_vec().into()));
        }
        runs
    }

    /// The line from one place to another with few vertices. Smoothed as a part of the whole; where the stroke goes on it
    /// ends with the vertex of the cut.
    fn polyline(&self, from: usize, to: usize, bounded: Bounded) -> Vec<PxPoint> {
        let (from, to) = (self.before + from, self.before + to);
        let low = from.saturating_sub(BESIDE);
        let high = (to + BESIDE).min(self.places.len().saturating_sub(1));
        let cuts = [from, to].map(|at| self.vertex_of_cut(at));
        let own = self.places.get(from..=to).unwrap_or(&[]);
        let turned = own.iter().rev().lt(own.iter());
        let mut places = self.places.get(low..=high).unwrap_or(&[]).to_vec();
        let mut ends = [(own.first(), cuts[0]), (own.last(), cuts[1])];
        if turned {
            places.reverse();
            ends.reverse();
        }
        let [(first, first_cut), (last, last_cut)] = ends;
        let mut line = smoothed(places);
        let is_end = |end: Option<&Place>, place: &Place| end.is_some_and(|end| end.at() == place.at());
        let start = line.places.iter().position(|place| is_end(first, place)).unwrap_or(0);
        let end = line.places.iter().rposition(|place| is_end(last, place)).unwrap_or(0).max(start);
        let mut course =
            line.course.drain(start..=end.min(line.course.len().saturating_sub(1))).collect::<Vec<_>>();
        if let (Some(slot), Some(cut)) = (course.first_mut(), first_cut) {
            *slot = cut;
        }
        if let (Some(slot), Some(cut)) = (course.last_mut(), last_cut) {
            *slot = cut;
        }
        let inner = line.corners.into_iter().filter(|corner| *corner > start && *corner < end);
        let corners = inner.map(|corner| corner - start).collect();
        let mut vertices =
            Centreline { places: course, corners, width_px: line.width_px, ..Centreline::default() }
                .curve(bounded, Pieces::Lines)
                .vertices;
        if turned {
            vertices.reverse();
        }
        vertices
    }

    /// The vertex of a cut at a place, of the stroke's places around it; none at the stroke's end.
    fn vertex_of_cut(&self, at: usize) -> Option<PxPoint> {
        let mut around = self.places.get(at.checked_sub(BESIDE)?..=at + BESIDE)?.to_vec();
        let place = *around.get(BESIDE)?;
        if around.iter().rev().lt(around.iter()) {
            around.reverse();
        }
        let line = smoothed(around);
        if place.is_corner() || line.keeps_pixels {
            return Some(place.at());
        }
        let straight = line.corners.is_empty().then(|| on_straight_line(place.at(), &line.places)).flatten();
        straight.or_else(|| {
            let index = line.places.iter().position(|one| one.at() == place.at())?;
            line.course.get(index).copied()
        })
    }
}

/// The runs of a ring of which something is cut out.
fn cut_ring(ring: &VecDeque<Place>, cuts: Cuts, bounded: Bounded) -> Option<VecDeque<Run>> {
    let count = ring.len();
    let all = || ring.iter().cycle();
    let mut found = crossings(all().take(count + 1), cuts);
    found.iter_mut().for_each(|at| *at %= count);
    found.sort_unstable();
    found.dedup();
    let first = *found.first()?;
    // Once around from a crossing to the same, with what lies beside it.
    let own: Vec<Place> = all().skip(first).take(count + 1).copied().collect();
    let after: Vec<Place> = all().skip(first + 1).take(BESIDE).copied().collect();
    let before: Vec<Place> = all().skip(first + count - BESIDE % count).take(BESIDE).copied().collect();
    let line = Stretch::new(&before, &own, &after);
    found.iter_mut().for_each(|at| *at -= first);
    found.push(count);
    let mut pieces = line.pieces(&found, cuts);
    pieces.retain(|(from, to)| count - (to - from) >= 2 * BESIDE);
    if pieces.is_empty() {
        return None;
    }
    let mut runs: VecDeque<Run> = line.cut(&pieces, bounded).into();
    if let (Some(Run::Open(_)), Some(Run::Open(_))) = (runs.front(), runs.back())
        && let (Some(Run::Open(mut last)), Some(Run::Open(first))) = (runs.pop_back(), runs.pop_front())
    {
        // They share the crossing.
        last.extend(first.into_iter().skip(1));
        runs.push_back(Run::Open(last));
    }
    Some(runs)
}

/// A line with its places filled up, and where they lie when smoothed.
struct Smoothed {
    places: Vec<Place>,
    course: Vec<PxPoint>,
    corners: Vec<usize>,
    width_px: f64,
    keeps_pixels: bool,
}

fn smoothed(mut places: Vec<Place>) -> Smoothed {
    places.dedup_by_key(|place| place.at());
    let width_px = width_px(&places);
    let keeps_pixels = keeps_pixels(&places, width_px);
    let most_px = most_smoothed_px(&places, width_px);
    if !keeps_pixels {
        fill_gaps(&mut places, false);
    }
    let corner = |(index, place): (usize, &Place)| place.is_corner().then_some(index);
    let corners: Vec<usize> = places.iter().enumerate().filter_map(corner).collect();
    let course = if keeps_pixels {
        places.iter().map(|place| place.at()).collect()
    } else {
        smooth(&Straightened::of(&places, false, &corners, width_px), false, &corners, most_px)
    };
    Smoothed { places, course, corners, width_px, keeps_pixels }
}

/// Where a place comes to lie on the straight line through it and others, by least squares; none when they are not
/// straight.
fn on_straight_line(place: PxPoint, others: &[Place]) -> Option<PxPoint> {
    let ways: Vec<PxVec> = others.iter().map(|other| other.at() - place).collect();
    let span = |of: fn(&PxVec) -> f64| {
        let (low, high) = ways.iter().map(of).fold((0.0, 0.0), |(low, high), v| (v.min(low), v.max(high)));
        high - low
    };
    let upright = span(|way| way.y) >= span(|way| way.x);
    let along_across = |way: &PxVec| if upright { (way.y, way.x) } else { (way.x, way.y) };
    let (mut n, mut u, mut v, mut uu, mut uv) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (along, across) in ways.iter().map(along_across) {
        (n, u, v, uu, uv) = (n + 1.0, u + along, v + across, uu + along * along, uv + along * across);
    }
    let determinant: f64 = n * uu - u * u;
    if determinant <= 0.0 {
        return None;
    }
    let (offset, slope) = ((v * uu - u * uv) / determinant, (n * uv - u * v) / determinant);
    let far = |(along, across): (f64, f64)| (across - offset - slope * along).abs();
    let straight = ways.iter().map(along_across).all(|way| far(way) <= STRAIGHT_PX);
    let moved = if upright { (offset, 0.0) } else { (0.0, offset) };
    straight.then(|| PxPoint::new(place.x + moved.0, place.y + moved.1))
}

/// Whether vertices come before others, in turn from the top.
fn before<'a>(
    one: impl Iterator<Item = &'a (PxPoint, bool)>,
    other: impl Iterator<Item = &'a (PxPoint, bool)>,
) -> bool {
    let compare = |((a, _), (b, _)): (&(PxPoint, bool), &(PxPoint, bool))| {
        a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x))
    };
    one.zip(other).map(compare).find(|order| order.is_ne()).is_some_and(core::cmp::Ordering::is_lt)
}

/// Turns a closed line, whose last vertex is its first one, so that it comes in the least of all orders.
fn turn_to_first(vertices: &mut Vec<(PxPoint, bool)>) {
    let last = vertices.pop();
    if let (Some(first), Some(last)) = (vertices.first_mut(), last) {
        *first = last;
    }
    let mut best: Option<Vec<(PxPoint, bool)>> = None;
    let least =
        vertices.iter().map(|(at, _)| *at).min_by(|a, b| a.y.total_cmp(&b.y).then(a.x.total_cmp(&b.x)));
    let starts = vertices.iter().enumerate().filter(|(_, (at, _))| Some(*at) == least);
    for start in starts.map(|(start, _)| start) {
        let mut turned = vertices.clone();
        turned.rotate_left(start);
        let mut back = turned.clone();
        back.get_mut(1..).unwrap_or_default().reverse();
        for way in [turned, back] {
            if best.as_ref().is_none_or(|best| before(way.iter(), best.iter())) {
                best = Some(way);
            }
        }
    }
    if let Some(best) = best {
        *vertices = best;
    }
    vertices.extend(vertices.first().copied());
}

/// Leaves out the cuts that lie on the straight line between their neighbours, but for `slack_px`.
fn without_needless_cuts(vertices: &[(PxPoint, bool)], slack_px: f64) -> Vec<PxPoint> {
    let mut kept: Vec<PxPoint> = Vec::with_capacity(vertices.len());
    let mut left_out: Vec<PxPoint> = Vec::new();
    for (index, (at, is_cut)) in vertices.iter().enumerate() {
        let link = kept.last().zip(vertices.get(index + 1));
        if let Some((from, (to, _))) = link.filter(|_| *is_cut) {
            left_out.push(*at);
            if left_out.iter().all(|at| distance_px(*at, *from, *to) <= slack_px) {
                continue;
            }
        }
        left_out.clear();
        kept.push(*at);
    }
    kept
}

/// From a place to a segment.
fn distance_px(at: PxPoint, from: PxPoint, to: PxPoint) -> f64 {
    let (PxVec { x: dx, y: dy }, PxVec { x, y }) = (to - from, at - from);
    let squared = dx * dx + dy * dy;
    let part = if squared > 0.0 { ((x * dx + y * dy) / squared).clamp(0.0, 1.0) } else { 0.0 };
    libm::hypot(x - part * dx, y - part * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUTS: Cuts = Cuts { rows: 300, least: 200 };
    const BOUNDED: Bounded = Bounded { tolerance_px: 0.425 };

    /// A way along places about a pixel apart, as the middle of a line 4 px wide has them: on half pixels.
    fn places(count: u32, way: impl Fn(f64) -> (f64, f64)) -> Vec<Place> {
        let place = |at: u32| {
            let (x, y) = way(f64::from(at));
            Place::new(PxPoint::new(libm::round(2.0 * x) / 2.0, libm::floor(y) + 0.5), 4.0, false)
        };
        (0..count).map(place).collect()
    }

    /// The stroke put together from pieces that begin at `from` and are so long, with what is long simplified on the way.
    fn grown(all: &[Place], step: usize, from: usize, closed: bool) -> Stroke {
        let mut parts = all.chunks(step).map(|part| Stroke::new(part.to_vec(), false));
        let mut stroke = parts.by_ref().nth(from / step).unwrap();
        for part in parts {
            stroke.append(part);
            stroke.cut(CUTS, BOUNDED);
        }
        for part in all.chunks(step).take(from / step).rev() {
            let mut part = Stroke::new(part.iter().rev().copied().collect(), false);
            part.reverse();
            stroke.prepend(part);
            stroke.cut(CUTS, BOUNDED);
        }
        if closed {
            stroke.close();
        }
        stroke
    }

    fn farthest_px(places: &[Place], line: &[PxPoint]) -> f64 {
        let far = |place: &Place| {
            line.windows(2)
                .map(|link| distance_px(place.at(), link[0], link[1]))
                .fold(f64::INFINITY, f64::min)
        };
        places.iter().map(far).fold(0.0, f64::max)
    }

    #[test]
    fn a_long_stroke_is_the_same_however_it_grew() {
        let wave = places(3000, |t| (500.0 + 60.0 * libm::sin(t / 90.0), 0.9 * t + 3.3));
        let whole = Stroke::new(wave.clone(), false).polyline(CUTS, BOUNDED);
        assert!(farthest_px(&wave, &whole) < 1.2, "{}", farthest_px(&wave, &whole));
        for (step, from) in [(40, 0), (170, 1500), (700, 2900), (3000, 0)] {
            let mut stroke = grown(&wave, step, from, false);
            assert!(step == 3000 || stroke.runs.len() > 5, "{}", stroke.runs.len());
            assert_eq!(stroke.clone().polyline(CUTS, BOUNDED), whole, "{step}");
            stroke.reverse();
            assert_eq!(stroke.polyline(CUTS, BOUNDED), whole, "{step}, from its end");
        }
        let uncut = Stroke::new(wave, false).polyline(Cuts::default(), BOUNDED);
        assert!(whole.len() <= uncut.len() + 8, "{} {}", whole.len(), uncut.len());
    }

    #[test]
    fn a_long_ring_is_the_same_wherever_it_closes() {
        let circle = |t: f64| {
            let angle = core::f64::consts::TAU * t / 4000.0;
            (900.0 + 630.0 * libm::cos(angle), 777.0 + 630.0 * libm::sin(angle))
        };
        let frame = |t: f64| match t {
            ..1000.0 => (t, 100.0),
            ..2000.0 => (1000.0, t - 900.0),
            ..3000.0 => (3000.0 - t, 1100.0),
            _ => (0.0, 4100.0 - t),
        };
        let ways: [&dyn Fn(f64) -> (f64, f64); 2] = [&circle, &frame];
        for way in ways {
            let ring = |from: f64| places(4000, |t| way((t + from) % 4000.0));
            let whole = Stroke::new(ring(0.0), true).polyline(CUTS, BOUNDED);
            assert_eq!(whole.first(), whole.last());
            assert!(farthest_px(&ring(0.0), &whole) < 1.2);
            for (step, from, turn) in
                [(60, 0, 0.0), (333, 999, 1234.0), (4000, 0, 3999.0), (900, 1800, 2500.0)]
            {
                let mut stroke = grown(&ring(turn), step, from, true);
                assert_eq!(stroke.clone().polyline(CUTS, BOUNDED), whole, "{step}");
                stroke.reverse();
                assert_eq!(stroke.polyline(CUTS, BOUNDED), whole, "{step}, backwards");
            }
        }
    }

    #[test]
    fn a_straight_line_has_hardly_a_vertex_at_its_cuts() {
        for slope in [0.0, 0.013, 0.3] {
            let line = places(4000, |t| (20.0 + slope * t, t));
            assert!(grown(&line, 100, 0, false).runs.len() > 10);
            let uncut = Stroke::new(line.clone(), false).polyline(Cuts::default(), BOUNDED).len();
            let cut = Stroke::new(line, false).polyline(CUTS, BOUNDED).len();
            assert!(cut <= 3 && uncut == 2, "{slope}: {cut}");
        }
    }

    #[test]
    fn a_long_stroke_that_waits_takes_little() {
        let line = places(4000, |t| (20.0 + 0.013 * t, t));
        let waiting = grown(&line, 100, 0, false);
        let held = |run: &Run| match run {
            Run::Open(places) => places.len(),
            Run::Done { ends, line } => ends.iter().map(Vec::len).sum::<usize>() + 2 * line.len(),
        };
        assert!(waiting.runs.iter().map(held).sum::<usize>() < 2500);
    }

    #[test]
    fn a_short_stroke_is_not_cut() {
        let line = places(250, |t| (20.0, 200.0 + t));
        let mut stroke = Stroke::new(line.clone(), false);
        stroke.cut(CUTS, BOUNDED);
        assert_eq!(stroke, Stroke::new(line, false));
    }
}
