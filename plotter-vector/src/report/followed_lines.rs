//! [`followed_lines`]: whether each line of a scan was drawn, as a line of its own and in its order.
//!
//! Distances to the nearest ink say nothing of which line it is: where two lines lie closer together than the
//! bound, one stroke is near all ink of both, and so is a stroke that runs to and fro. Here each line asks
//! for a way of its own along what was drawn:
//!
//! ```text
//!   line      ●━━━●━━━●━━━●━━━●      place by place within the bound, and neither goes back: the discrete
//!              \   \   |   |  |      Fréchet distance (Eiter and Mannila, 1994, section 3); of all such
//!   drawn   ────○───○──○───○──○───   ways the one that is nearest on average
//!
//!   line      ●━━━●━━━●━━━●━━━●      its way is used up: merged
//!   line      ●━━━●━━━●━━━●━━━●
//! ```

use crate::stroke::curve::CHORD_ERROR_PX;
use crate::stroke::{Drawing, PxPoint};
use std::collections::BTreeMap;

/// Strokes of the scan's lines that come as near to each other as this meet there, px: their common place is
/// found within half a pixel along each of them.
const MEETING_PX: f64 = 1.0;

/// Share of the bound from sample to sample: a way that keeps the bound is missed where it uses more than
/// 0.998 of it.
const STEP_SHARE: f64 = 0.125;

/// Samples lie no closer than this, px; a bound below eight of them is judged more strictly than asked.
const LEAST_STEP_PX: f64 = 0.1;

/// Samples of either drawing; they take some 60 bytes each, and the states of one line at a time come to
/// that. Longer drawings have samples that lie farther apart, which is the strict side.
const MOST_SAMPLES: f64 = 4e6;

/// So many ways are tried for a line, its own and those of lines that make room for it, one for the other:
/// bounds the time. Where more lines than that are drawn each beside itself, by more than they are apart,
/// some are said to be merged.
const MOST_TRIED: u32 = 8;

/// How the lines of a scan were drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FollowedLines {
    /// Lines of the scan: its strokes from meeting to meeting.
    pub lines: usize,
    /// Of these, where each begins whose only way along what was drawn belongs to another line, too.
    pub merged: Vec<PxPoint>,
    /// Of these, where each begins along which nothing was drawn within the bound.
    pub dropped: Vec<PxPoint>,
}

impl FollowedLines {
    /// Lines that have a way of their own.
    #[must_use]
    pub fn followed(&self) -> usize {
        self.lines.saturating_sub(self.broken())
    }

    /// Lines that were merged or dropped.
    #[must_use]
    pub fn broken(&self) -> usize {
        self.merged.len() + self.dropped.len()
    }
}

/// How `drawn` follows `lines`, which are best a vectorization of the scan within half a pixel: each of them,
/// from where it meets others to where it meets others again, by strokes end to end, either way round, no
/// farther than `bound_px` from it.
///
/// No part of what was drawn stands for two lines, but near their ends, where they meet: within the bound, or
/// a quarter of their length if that is less. A bound below 0, or that is no number, drops every line. The
/// time grows with how much is drawn within the bound of a line.
///
/// ```
/// # use plotter_vector::{Drawing, PxPoint, report::followed_lines};
/// let drawing = |rows: &[f64]| {
///     let mut drawing = Drawing::new(100, 20);
///     rows.iter().for_each(|&y| drawing.push([PxPoint::new(5.0, y), PxPoint::new(95.0, y)]));
///     drawing
/// };
/// let scan = drawing(&[8.0, 11.0]);
/// assert_eq!(followed_lines(&scan, &drawing(&[11.5, 8.5]), 2.0).followed(), 2);
/// let one = followed_lines(&scan, &drawing(&[9.5]), 2.0); // near both
/// assert_eq!((one.lines, one.followed(), one.merged.len()), (2, 1, 1));
/// let far = followed_lines(&scan, &drawing(&[8.0, 14.0]), 2.0);
/// assert_eq!(far.dropped, [PxPoint::new(5.0, 11.0)]);
/// ```
#[must_use]
pub fn followed_lines(lines: &Drawing, drawn: &Drawing, bound_px: f64) -> FollowedLines {
    let lines = lines_from_meeting_to_meeting(lines);
    let step_px = step_px(drawn, (STEP_SHARE * bound_px).max(LEAST_STEP_PX));
    let length_px = lines.iter().map(|line| length_px(line)).sum::<f64>();
    let sampled = DrawnSamples::new(drawn, bound_px, step_px.max(length_px / MOST_SAMPLES));
    let mut nearest: Vec<_> =
        lines.iter().enumerate().map(|(line, places)| (sampled.align(places, |_| false), line)).collect();
    // Those that are nearest first: of two that want the same, mostly the one whose it is.
    let mean_px = |alignment: &Option<Alignment>| {
        alignment.as_ref().map_or(f64::INFINITY, |alignment| alignment.mean_px)
    };
    nearest.sort_by(|a, b| mean_px(&a.0).total_cmp(&mean_px(&b.0)).then(a.1.cmp(&b.1)));
    let mut shares = Shares::new(&lines, &sampled);
    let mut result = FollowedLines { lines: lines.len(), ..FollowedLines::default() };
    for (round, (alignment, line)) in (1..).zip(nearest) {
        let start = lines.get(line).and_then(|places| places.first()).copied();
        match alignment {
            None => result.dropped.extend(start),
            Some(alignment) => {
                shares.tries = MOST_TRIED;
                if !shares.give_if_free(line, &alignment) && !shares.find(line, round) {
                    result.merged.extend(start);
                }
            }
        }
    }
    result
}

/// What each line has of what was drawn.
struct Shares<'a> {
    lines: &'a [Vec<PxPoint>],
    sampled: &'a DrawnSamples,
    /// Whose each sample is.
    owners: Vec<Option<usize>>,
    /// What each line has.
    owned: Vec<Vec<u32>>,
    /// In which round a way over each sample was last asked for.
    asked: Vec<usize>,
    /// Ways that may still be tried for a line.
    tries: u32,
}

impl<'a> Shares<'a> {
    fn new(lines: &'a [Vec<PxPoint>], sampled: &'a DrawnSamples) -> Self {
        let samples = sampled.places.len();
        Self {
            lines,
            sampled,
            owners: vec![None; samples],
            owned: vec![Vec::new(); lines.len()],
            asked: vec![0; samples],
            tries: MOST_TRIED,
        }
    }

    /// A way of its own for a line: a free one, or one whose owners can take another. These are the
    /// augmenting paths of Kuhn's assignment (1955), with a way of many samples in place of one partner.
    /// Whether there is one.
    fn find(&mut self, line: usize, round: usize) -> bool {
        let (lines, sampled) = (self.lines, self.sampled);
        let Some(places) = lines.get(line) else { return false };
        let Some(shared) = Shared::new(places, sampled.bound_px) else { return false };
        // Each turn asks for samples that were not asked for in this round, so it ends.
        loop {
            let is_asked = |sample: u32| self.asked.get(sample as usize) == Some(&round);
            let owner = |sample: u32| self.owners.get(sample as usize).copied().flatten();
            let is_anothers = |sample: u32| owner(sample).is_some_and(|owner| owner != line);
            if let Some(alignment) = sampled.align(places, |sample| is_asked(sample) || is_anothers(sample)) {
                self.give(line, &alignment, &shared);
                return true;
            }
            if self.tries == 0 {
                return false;
            }
            let Some(alignment) = sampled.align(places, is_asked) else { return false };
            self.tries -= 1;
            let wanted: Vec<u32> =
                alignment.samples.iter().copied().filter(|at| !sampled.is_shared(&shared, *at)).collect();
            let mut owners: Vec<usize> = wanted.iter().filter_map(|at| owner(*at)).collect();
            owners.sort_unstable();
            owners.dedup();
            let mut is_new = false;
            for sample in wanted {
                if let Some(asked) = self.asked.get_mut(sample as usize) {
                    is_new |= core::mem::replace(asked, round) != round;
                }
            }
            if !is_new {
                return false;
            }
            if owners.into_iter().all(|owner| owner == line || self.find(owner, round)) {
                self.give(line, &alignment, &shared);
                return true;
            }
        }
    }

    /// Gives a line this way, if it is no other's.
    fn give_if_free(&mut self, line: usize, alignment: &Alignment) -> bool {
        let places = self.lines.get(line).map_or(&[][..], Vec::as_slice);
        let Some(shared) = Shared::new(places, self.sampled.bound_px) else { return false };
        let is_free = alignment.samples.iter().all(|sample| {
            self.owners.get(*sample as usize) == Some(&None) || self.sampled.is_shared(&shared, *sample)
        });
        if is_free {
            self.give(line, alignment, &shared);
        }
        is_free
    }

    /// What a line has from now on, instead of what it had.
    fn give(&mut self, line: usize, alignment: &Alignment, shared: &Shared) {
        let sampled = self.sampled;
        let samples: Vec<u32> =
            alignment.samples.iter().copied().filter(|at| !sampled.is_shared(shared, *at)).collect();
        let Some(owned) = self.owned.get_mut(line) else { return };
        let had = core::mem::replace(owned, samples.clone());
        let mut set = |sample: u32, owner: Option<usize>| {
            if let Some(place) = self.owners.get_mut(sample as usize) {
                *place = owner;
            }
        };
        had.into_iter().for_each(|sample| set(sample, None));
        samples.into_iter().for_each(|sample| set(sample, Some(line)));
    }
}

fn length_px(line: &[PxPoint]) -> f64 {
    line.windows(2).map(|pair| pair.first().zip(pair.last()).map_or(0.0, |(a, b)| a.distance(*b))).sum()
}

/// Places along a stroke, no farther apart than `step_px`, its vertices among them.
fn sampled(stroke: &[PxPoint], step_px: f64) -> Vec<PxPoint> {
    let mut places: Vec<_> = stroke.first().copied().into_iter().collect();
    for pair in stroke.windows(2) {
        let [from, to] = pair else { continue };
        let count = (from.distance(*to) / step_px).ceil().clamp(1.0, MOST_SAMPLES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        for index in 1..=count as u32 {
            let share = f64::from(index) / count;
            places.push(PxPoint::new(from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share));
        }
    }
    places
}

/// From place to place, so that a whole drawing has at most [`MOST_SAMPLES`].
fn step_px(drawing: &Drawing, wanted_px: f64) -> f64 {
    wanted_px.max(drawing.pen_down_px() / MOST_SAMPLES)
}

/// Samples by the square that they lie in.
#[derive(Debug)]
struct Squares {
    side_px: f64,
    samples: BTreeMap<(i64, i64), Vec<u32>>,
}

impl Squares {
    fn new(places: &[PxPoint], side_px: f64) -> Self {
        let mut squares = Self { side_px, samples: BTreeMap::new() };
        for (index, at) in (0..).zip(places) {
            let square = squares.square(*at);
            squares.samples.entry(square).or_default().push(index);
        }
        squares
    }

    #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
    fn square(&self, at: PxPoint) -> (i64, i64) {
        ((at.x / self.side_px).floor() as i64, (at.y / self.side_px).floor() as i64)
    }

    /// All samples that may lie within a side of a place.
    fn about(&self, at: PxPoint) -> impl Iterator<Item = u32> {
        let (x, y) = self.square(at);
        (-1..=1).flat_map(move |dx| {
            let column = x.saturating_add(dx);
            let rows = (column, y.saturating_sub(1))..=(column, y.saturating_add(1));
            self.samples.range(rows).flat_map(|(_, samples)| samples.iter().copied())
        })
    }
}

/// The strokes of a drawing, cut where they meet.
fn lines_from_meeting_to_meeting(drawing: &Drawing) -> Vec<Vec<PxPoint>> {
    let step_px = step_px(drawing, 0.5 * MEETING_PX);
    let chords = drawing.chords(CHORD_ERROR_PX);
    let strokes: Vec<_> = chords.strokes().map(|stroke| sampled(stroke, step_px)).collect();
    let meetings = Meetings::new(&strokes);
    let mut lines = Vec::new();
    let mut first = 0;
    for stroke in &strokes {
        let mut begun = 0;
        for cut in meetings.along(first, stroke.len()).chain([stroke.len().saturating_sub(1)]) {
            let line = stroke.get(begun..=cut).unwrap_or_default();
            // What is left of a stroke that ends within reach of another is the end of the line before.
            if length_px(line) > MEETING_PX || begun == 0 && cut + 1 == stroke.len() {
                lines.push(line.to_vec());
                begun = cut;
            }
        }
        first += stroke.len();
    }
    lines
}

/// Samples of all strokes, and which of them are near another stroke.
struct Meetings {
    places: Vec<PxPoint>,
    /// The stroke of each, and how far along it is.
    along: Vec<(usize, f64)>,
    squares: Squares,
}

impl Meetings {
    /// Of one stroke, what is this far along it from a place is another line, px: nearer it is the turn of a
    /// corner.
    const OTHER_PX: f64 = 4.0 * MEETING_PX;

    fn new(strokes: &[Vec<PxPoint>]) -> Self {
        let places: Vec<_> = strokes.iter().flatten().copied().collect();
        let mut along = Vec::with_capacity(places.len());
        for (index, stroke) in strokes.iter().enumerate() {
            let mut along_px = 0.0;
            along.extend(stroke.first().map(|_| (index, along_px)));
            along.extend(stroke.windows(2).map(|pair| {
                along_px += length_px(pair);
                (index, along_px)
            }));
        }
        let squares = Squares::new(&places, MEETING_PX);
        Self { places, along, squares }
    }

    /// How near another line comes to a sample, px; infinite if none comes as near as lines that meet.
    fn nearest_other_px(&self, sample: usize) -> f64 {
        let Some((at, (stroke, along_px))) = self.places.get(sample).zip(self.along.get(sample)) else {
            return f64::INFINITY;
        };
        let others = self.squares.about(*at).filter_map(|other| {
            let (other_stroke, other_along_px) = self.along.get(other as usize)?;
            let is_other = stroke != other_stroke || (along_px - other_along_px).abs() > Self::OTHER_PX;
            is_other.then(|| self.places.get(other as usize).map(|there| at.distance(*there)))?
        });
        others.filter(|px| *px <= MEETING_PX).fold(f64::INFINITY, f64::min)
    }

    /// Where a stroke meets others: of samples in a row that are near another, the nearest.
    fn along(&self, first: usize, count: usize) -> impl Iterator<Item = usize> {
        let mut nearest: Option<(f64, usize)> = None;
        (0..count).filter_map(move |index| {
            let px = self.nearest_other_px(first + index);
            if px.is_infinite() {
                return nearest.take().map(|(_, index)| index);
            }
            if nearest.is_none_or(|(least_px, _)| px < least_px) {
                nearest = Some((px, index));
            }
            None
        })
    }
}

/// Which samples of what was drawn stand for a line, in their order: its way along it.
#[derive(Clone, Debug)]
struct Alignment {
    /// How far it is from the line, on average.
    mean_px: f64,
    /// Which samples of what was drawn it has, from the line's end to its beginning.
    samples: Vec<u32>,
}

/// Samples of all that was drawn, with which lines are aligned.
#[derive(Debug)]
struct DrawnSamples {
    bound_px: f64,
    step_px: f64,
    places: Vec<PxPoint>,
    /// Whether a sample is the first and the last of its stroke.
    ends: Vec<[bool; 2]>,
    squares: Squares,
}

/// From where a way comes to a state: one of the same place of the line, or of the place before.
#[derive(Clone, Copy, Debug)]
enum CameFrom {
    Start,
    Here(usize),
    Before(usize),
}

/// All states at one place of the line. State 2 k is sample `near[k]`, passed in its stroke's sense; state 2
/// k + 1 the same sample passed against it.
#[derive(Clone, Debug, Default)]
struct Layer {
    /// Ascending.
    near: Vec<u32>,
    distance_px: Vec<f64>,
    cost_px: Vec<f64>,
    came_from: Vec<CameFrom>,
}

impl Layer {
    fn state(&self, sample: u32, is_back: bool) -> Option<usize> {
        self.near.binary_search(&sample).ok().map(|k| 2 * k + usize::from(is_back))
    }

    fn cost_px(&self, state: usize) -> f64 {
        self.cost_px.get(state).copied().unwrap_or(f64::INFINITY)
    }

    /// Takes a cheaper way to a state.
    fn reach(&mut self, state: usize, cost_before_px: f64, came_from: CameFrom) {
        let Some(distance_px) = self.distance_px.get(state / 2) else { return };
        let cost_px = cost_before_px + distance_px;
        if cost_px < self.cost_px(state) {
            if let Some(cost) = self.cost_px.get_mut(state) {
                *cost = cost_px;
            }
            if let Some(from) = self.came_from.get_mut(state) {
                *from = came_from;
            }
        }
    }

    fn best(&self) -> Option<(usize, f64)> {
        let cheapest = self.cost_px.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        cheapest.map(|(state, cost)| (state, *cost)).filter(|(_, cost)| cost.is_finite())
    }
}

impl DrawnSamples {
    fn new(drawn: &Drawing, bound_px: f64, step_px: f64) -> Self {
        let (mut places, mut ends) = (Vec::new(), Vec::new());
        for stroke in drawn.chords(CHORD_ERROR_PX).strokes() {
            let samples = sampled(stroke, step_px);
            let last = samples.len().saturating_sub(1);
            ends.extend((0..samples.len()).map(|index| [index == 0, index == last]));
            places.extend(samples);
        }
        let squares = Squares::new(&places, bound_px.max(step_px));
        Self { bound_px, step_px, places, ends, squares }
    }

    /// The way that is nearest to a line, if one follows it within the bound over samples that are not taken.
    fn align(&self, line: &[PxPoint], is_taken: impl Fn(u32) -> bool) -> Option<Alignment> {
        let shared = Shared::new(line, self.bound_px)?;
        let mut layers: Vec<Layer> = Vec::new();
        for at in sampled(line, self.step_px) {
            let mut layer = self.near(at, &shared, &is_taken);
            match layers.last() {
                Some(before) => self.come(before, &mut layer),
                None => (0..layer.cost_px.len()).for_each(|state| layer.reach(state, 0.0, CameFrom::Start)),
            }
            self.go_along(&mut layer);
            self.go_over(&mut layer);
            layer.best()?;
            layers.push(layer);
        }
        let (mut state, cost_px) = layers.last()?.best()?;
        let mut samples = Vec::new();
        while let Some(layer) = layers.last() {
            samples.extend(layer.near.get(state / 2));
            match layer.came_from.get(state)? {
                CameFrom::Start => break,
                CameFrom::Here(from) => state = *from,
                CameFrom::Before(from) => {
                    state = *from;
                    layers.pop();
                }
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "far below 2^53")]
        let mean_px = cost_px / samples.len().max(1) as f64;
        Some(Alignment { mean_px, samples })
    }

    /// The samples within the bound that a line may have.
    fn near(&self, at: PxPoint, shared: &Shared, is_taken: impl Fn(u32) -> bool) -> Layer {
        let mut near: Vec<(u32, f64)> = self
            .squares
            .about(at)
            .filter_map(|sample| {
                let there = *self.places.get(sample as usize)?;
                let distance_px = at.distance(there);
                let is_free = shared.has(there) || !is_taken(sample);
                (is_free && distance_px <= self.bound_px).then_some((sample, distance_px))
            })
            .collect();
        near.sort_unstable_by_key(|(sample, _)| *sample);
        let states = 2 * near.len();
        let (near, distance_px) = near.into_iter().unzip();
        let (cost_px, came_from) = (vec![f64::INFINITY; states], vec![CameFrom::Start; states]);
        Layer { near, distance_px, cost_px, came_from }
    }

    /// The sample that comes before one, passed so, on its stroke.
    fn previous(&self, sample: u32, is_back: bool) -> Option<u32> {
        let [is_first, is_last] = *self.ends.get(sample as usize)?;
        match is_back {
            false if !is_first => sample.checked_sub(1),
            true if !is_last => sample.checked_add(1),
            _ => None,
        }
    }

    /// From the place of the line before: the way stays where it is, or goes on by a sample.
    fn come(&self, before: &Layer, layer: &mut Layer) {
        for state in 0..layer.cost_px.len() {
            let Some(&sample) = layer.near.get(state / 2) else { continue };
            let is_back = state % 2 == 1;
            for from in [Some(sample), self.previous(sample, is_back)].into_iter().flatten() {
                if let Some(from) = before.state(from, is_back) {
                    layer.reach(state, before.cost_px(from), CameFrom::Before(from));
                }
            }
        }
    }

    /// The line stays where it is, and the way goes on along its stroke.
    fn go_along(&self, layer: &mut Layer) {
        let count = layer.near.len();
        for is_back in [false, true] {
            for index in 0..count {
                let k = if is_back { count - 1 - index } else { index };
                let Some(&sample) = layer.near.get(k) else { continue };
                let from = self.previous(sample, is_back).and_then(|from| layer.state(from, is_back));
                if let Some(from) = from {
                    layer.reach(2 * k + usize::from(is_back), layer.cost_px(from), CameFrom::Here(from));
                }
            }
        }
    }

    /// The line stays where it is, and the way goes over from a stroke's end to one of another, or of the
    /// same.
    fn go_over(&self, layer: &mut Layer) {
        let is_end = |state: usize, leaves: bool| {
            let ends = layer.near.get(state / 2).and_then(|sample| self.ends.get(*sample as usize));
            // A stroke is left at its last sample, or at its first when it is passed against its sense.
            ends.is_some_and(|ends| if leaves == state.is_multiple_of(2) { ends[1] } else { ends[0] })
        };
        let states = 0..layer.cost_px.len();
        let left = states
            .clone()
            .filter(|state| is_end(*state, true))
            .min_by(|a, b| layer.cost_px(*a).total_cmp(&layer.cost_px(*b)))
            .filter(|state| layer.cost_px(*state).is_finite());
        let Some(left) = left else { return };
        let begins: Vec<_> = states.filter(|state| is_end(*state, false)).collect();
        let cost_px = layer.cost_px(left);
        for state in begins {
            layer.reach(state, cost_px, CameFrom::Here(left));
        }
        self.go_along(layer);
    }

    fn is_shared(&self, shared: &Shared, sample: u32) -> bool {
        self.places.get(sample as usize).is_some_and(|at| shared.has(*at))
    }
}

/// Where a line may meet others: within the bound of its ends, or a quarter of its length if that is less.
#[derive(Clone, Copy, Debug)]
struct Shared {
    ends: [PxPoint; 2],
    near_px: f64,
}

impl Shared {
    fn new(line: &[PxPoint], bound_px: f64) -> Option<Self> {
        let ends = [*line.first()?, *line.last()?];
        Some(Self { ends, near_px: bound_px.min(0.25 * length_px(line)) })
    }

    fn has(&self, at: PxPoint) -> bool {
        self.ends.iter().any(|end| end.distance(at) <= self.near_px)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(strokes: &[&[(f64, f64)]]) -> Drawing {
        let mut drawing = Drawing::new(200, 200);
        strokes.iter().for_each(|stroke| drawing.push(stroke.iter().map(|&(x, y)| PxPoint::new(x, y))));
        drawing
    }

    /// Lines, merged, dropped.
    fn counts(scan: &Drawing, drawn: &Drawing, bound_px: f64) -> [usize; 3] {
        let found = followed_lines(scan, drawn, bound_px);
        [found.lines, found.merged.len(), found.dropped.len()]
    }

    #[test]
    fn a_cross_is_four_lines_whichever_way_its_strokes_turn() {
        let scan = drawing(&[&[(10.0, 100.0), (190.0, 100.0)], &[(100.0, 10.0), (100.0, 190.0)]]);
        let turned = drawing(&[
            &[(10.0, 100.0), (100.0, 100.0), (100.0, 10.0)],
            &[(190.0, 100.0), (100.0, 100.0), (100.0, 190.0)],
        ]);
        assert_eq!(counts(&scan, &scan, 1.0), [4, 0, 0]);
        assert_eq!(counts(&scan, &turned, 1.0), [4, 0, 0]);
        let three =
            drawing(&[&[(10.0, 100.0), (100.0, 100.0), (100.0, 10.0)], &[(190.0, 100.0), (100.0, 100.0)]]);
        assert_eq!(counts(&scan, &three, 1.0), [4, 0, 1]);
    }

    #[test]
    fn a_ring_may_be_begun_anywhere_and_drawn_either_way() {
        let ring = |from: u32, clockwise: bool| {
            let places = (0..=120).map(|step| {
                let turn = f64::from(from + if clockwise { step } else { 120 - step }) / 120.0;
                let (sin, cos) = libm::sincos(turn * core::f64::consts::TAU);
                PxPoint::new(100.0 + 50.0 * cos, 100.0 + 50.0 * sin)
            });
            let mut drawing = Drawing::new(200, 200);
            drawing.push(places);
            drawing
        };
        for (from, clockwise) in [(0, true), (31, true), (31, false), (77, false)] {
            assert_eq!(counts(&ring(0, true), &ring(from, clockwise), 0.5), [1, 0, 0], "{from} {clockwise}");
        }
    }

    #[test]
    fn out_of_order_is_not_followed_though_all_of_it_is_near() {
        // A hairpin, 4 px from way to way, and a stroke that runs across its ways: within 5 px of each other,
        // place by place.
        let ways: Vec<(f64, f64)> = (0..10)
            .flat_map(|way| {
                let y = 20.0 + 4.0 * f64::from(way);
                let (from, to) = if way % 2 == 0 { (20.0, 60.0) } else { (60.0, 20.0) };
                [(from, y), (to, y)]
            })
            .collect();
        let across: Vec<(f64, f64)> = ways.iter().map(|&(x, y)| (y, x)).collect();
        let scan = drawing(&[&ways]);
        assert_eq!(counts(&scan, &drawing(&[&across]), 5.0), [1, 0, 1]);
        assert_eq!(counts(&scan, &drawing(&[&ways]), 5.0), [1, 0, 0]);
    }

    #[test]
    fn of_three_lines_that_run_together_two_are_merged_and_neighbours_keep_their_own() {
        let rows = |rows: &[f64]| {
            let mut drawing = Drawing::new(200, 200);
            rows.iter().for_each(|&y| drawing.push([PxPoint::new(10.0, y), PxPoint::new(190.0, y)]));
            drawing
        };
        let scan = rows(&[50.0, 53.0, 56.0, 59.0]);
        assert_eq!(counts(&scan, &rows(&[53.0, 59.0]), 8.0), [4, 2, 0]);
        // All of them moved by more than the way from one to the next: each within the bound has one of its
        // own.
        assert_eq!(counts(&scan, &rows(&[54.0, 57.0, 60.0, 63.0]), 8.0), [4, 0, 0]);
    }

    #[test]
    fn nothing_is_total() {
        let nothing = Drawing::new(10, 10);
        let dot = drawing(&[&[(5.0, 5.0)]]);
        assert_eq!(followed_lines(&nothing, &dot, 1.0), FollowedLines::default());
        assert_eq!(counts(&dot, &nothing, 1.0), [1, 0, 1]);
        assert_eq!(counts(&dot, &dot, 1.0), [1, 0, 0]);
        for bound_px in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            let dropped = usize::from(bound_px.is_nan() || bound_px < 0.0);
            assert_eq!(counts(&dot, &dot, bound_px), [1, 0, dropped], "{bound_px}");
        }
    }
}
