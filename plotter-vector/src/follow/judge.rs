//! [`judge`]: how well a tool followed the lines that it should.

use super::paper::nearest;
use crate::stroke::{PxPoint, PxVec};
use std::collections::HashMap;

/// Side of the cells of the index, px.
const CELL_PX: f64 = 16.0;

/// Spacing of the places that are judged, px.
const STEP_PX: f64 = 0.5;

/// Farther lines are looked for one by one, px.
const NEAR_PX: f64 = 64.0;

/// How well lines were followed.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Judged {
    /// The share of the true lines' length that the tool passed within the reach.
    pub coverage: f64,
    /// Length of the true lines that the tool passed once more than it had to, as a share of their length.
    pub repeated: f64,
    /// Length of the true lines, px.
    pub true_px: f64,
    /// Length of the tool's path, px.
    pub path_px: f64,
    /// Root of the mean square of the path's distances from the true lines, px.
    pub rms_px: f64,
    /// Greatest distance of the path from the true lines, px; 0 without lines.
    pub max_px: f64,
    /// Where that is.
    pub worst: PxPoint,
    /// The longest piece of the true lines that was not passed, px.
    pub longest_miss_px: f64,
}

/// Pieces of straight lines, found by place.
#[derive(Clone, Debug, Default)]
pub struct Route {
    pieces: Vec<[PxPoint; 2]>,
    /// Of each piece: its line, and how far along it begins, px.
    places: Vec<(usize, f64)>,
    cells: HashMap<(i32, i32), Vec<usize>>,
}

impl Route {
    /// The pieces of polylines.
    #[must_use]
    pub fn of(lines: &[Vec<PxPoint>]) -> Self {
        let mut route = Self::default();
        for (line, vertices) in lines.iter().enumerate() {
            let mut along = 0.0;
            for pair in vertices.windows(2) {
                let [a, b] = pair else { continue };
                route.push([*a, *b], (line, along));
                along += a.distance(*b);
            }
            if let [dot] = vertices.as_slice() {
                route.push([*dot, *dot], (line, 0.0));
            }
        }
        route
    }

    fn push(&mut self, piece: [PxPoint; 2], place: (usize, f64)) {
        let cell = |at: f64| super::whole::floor(at / CELL_PX);
        let [a, b] = piece;
        let index = self.pieces.len();
        for y in cell(a.y.min(b.y))..=cell(a.y.max(b.y)) {
            for x in cell(a.x.min(b.x))..=cell(a.x.max(b.x)) {
                self.cells.entry((x, y)).or_default().push(index);
            }
        }
        self.pieces.push(piece);
        self.places.push(place);
    }

    /// The distance of the nearest place, however far, px; 0 without any.
    fn far(&self, at: PxPoint) -> f64 {
        let distances = self.pieces.iter().map(|[a, b]| at.distance(nearest(at, *a, *b)));
        distances.min_by(f64::total_cmp).unwrap_or(0.0)
    }

    /// The nearest place within `reach_px`: its distance, its line, and how far along the line it is, px.
    #[must_use]
    pub fn nearest(&self, at: PxPoint, reach_px: f64) -> Option<(f64, usize, f64)> {
        let mut best: Option<(f64, usize, f64)> = None;
        for index in self.near(at, reach_px) {
            let (Some([a, b]), Some((line, along))) = (self.pieces.get(index), self.places.get(index)) else {
                continue;
            };
            let foot = nearest(at, *a, *b);
            let distance = at.distance(foot);
            if distance <= reach_px && best.is_none_or(|(least, ..)| distance < least) {
                best = Some((distance, *line, along + a.distance(foot)));
            }
        }
        best
    }

    fn near(&self, at: PxPoint, reach_px: f64) -> Vec<usize> {
        let cell = |at: f64| super::whole::floor(at / CELL_PX);
        let mut found = Vec::new();
        for y in cell(at.y - reach_px)..=cell(at.y + reach_px) {
            for x in cell(at.x - reach_px)..=cell(at.x + reach_px) {
                found.extend(self.cells.get(&(x, y)).into_iter().flatten().copied());
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// Places along a polyline, half a pixel from each other, each with the way there.
fn places(line: &[PxPoint]) -> impl Iterator<Item = (PxPoint, PxVec)> {
    line.windows(2).flat_map(|pair| {
        let (a, b) = if let [a, b] = pair { (*a, *b) } else { (PxPoint::default(), PxPoint::default()) };
        let parts = super::whole::count(libm::ceil(a.distance(b) / STEP_PX)).clamp(1, 1 << 20);
        (0..parts).map(move |i| {
            #[expect(clippy::cast_precision_loss, reason = "a small number")]
            let part = (i as f64 + 0.5) / parts as f64;
            (a + (b - a) * part, b - a)
        })
    })
}

/// Compares what a tool drew with the true lines; all places in px. A place of a true line is passed when the path comes within
/// `reach_px` in the line's direction (within 30 degrees; within the reach of its ends and corners in any).
///
/// ```
/// # use plotter_vector::{PxPoint, follow::judge};
/// let line = vec![PxPoint::new(0.0, 0.0), PxPoint::new(100.0, 0.0)];
/// let path = vec![PxPoint::new(0.0, 0.5), PxPoint::new(80.0, 0.5), PxPoint::new(60.0, 0.5)];
/// let judged = judge(&[line], &[path], 1.0);
/// assert!((judged.coverage - 0.81).abs() < 0.01 && (0.08..=0.2).contains(&judged.repeated), "{judged:?}");
/// assert!((judged.rms_px - 0.5).abs() < 1e-9);
/// ```
#[must_use]
pub fn judge(truth: &[Vec<PxPoint>], path: &[Vec<PxPoint>], reach_px: f64) -> Judged {
    let true_route = Route::of(truth);
    let mut judged = Judged::default();
    let length = |lines: &[Vec<PxPoint>]| -> f64 {
        lines
            .iter()
            .flat_map(|line| line.windows(2))
            .map(|pair| if let [a, b] = pair { a.distance(*b) } else { 0.0 })
            // From 0: the sum of nothing is -0.
            .fold(0.0, |sum, px| sum + px)
    };
    (judged.true_px, judged.path_px) = (length(truth), length(path));

    let (mut squares, mut count) = (0.0, 0.0);
    for (at, _) in path.iter().flat_map(|line| places(line)) {
        let distance =
            true_route.nearest(at, NEAR_PX).map_or_else(|| true_route.far(at), |(distance, ..)| distance);
        squares += distance * distance;
        count += 1.0;
        if distance > judged.max_px {
            (judged.max_px, judged.worst) = (distance, at);
        }
    }
    judged.rms_px = if count > 0.0 { libm::sqrt(squares / count) } else { 0.0 };

    let tool = Route::of(path);
    let (mut passed, mut total) = (0.0, 0.0);
    for line in truth {
        let ends: Vec<PxPoint> = corners(line);
        let mut miss = 0.0;
        for (at, way) in places(line) {
            total += 1.0;
            let any = ends.iter().any(|end| end.distance(at) <= reach_px + 1.0);
            let is_passed = tool.near(at, reach_px).into_iter().any(|index| {
                let Some([a, b]) = tool.pieces.get(index) else { return false };
                let near = at.distance(nearest(at, *a, *b)) <= reach_px;
                near && (any || super::lines::cosine(*b - *a, way).abs() > 0.866 || a.distance(*b) < 2.0)
            });
            if is_passed {
                passed += 1.0;
                miss = 0.0;
            } else {
                miss += STEP_PX;
                judged.longest_miss_px = f64::max(judged.longest_miss_px, miss);
            }
        }
    }
    judged.coverage = if total > 0.0 { passed / total } else { 1.0 };
    judged.repeated = repeated(&true_route, path, reach_px, judged.true_px);
    judged
}

/// The ends and the corners of a polyline.
fn corners(line: &[PxPoint]) -> Vec<PxPoint> {
    let mut found: Vec<PxPoint> = line.first().into_iter().chain(line.last()).copied().collect();
    for three in line.windows(3) {
        if let [a, b, c] = three
            && super::lines::cosine(*b - *a, *c - *b) < 0.8
        {
            found.push(*b);
        }
    }
    found
}

/// How often the tool was on each pixel of the lines' length, beyond the first time; the last 10 px before a turn do not count.
fn repeated(route: &Route, path: &[Vec<PxPoint>], reach_px: f64, true_px: f64) -> f64 {
    // A pass is one way over a pixel of a line without leaving it for more than a few.
    let mut passes: HashMap<(usize, i32), u32> = HashMap::new();
    for stroke in path {
        let mut last: Option<(usize, i32)> = None;
        let mut recent: Vec<(usize, i32)> = Vec::new();
        for (at, _) in places(stroke) {
            let Some((_, line, along)) = route.nearest(at, reach_px) else { continue };
            let bin = (line, super::whole::floor(along / 2.0));
            if last == Some(bin) {
                continue;
            }
            last = Some(bin);
            // The table's noise may step back a little.
            if recent.contains(&bin) {
                continue;
            }
            *passes.entry(bin).or_default() += 1;
            recent.push(bin);
            if recent.len() > 4 {
                recent.remove(0);
            }
        }
    }
    let again: u32 = passes.values().map(|count| count - 1).sum();
    if true_px > 0.0 { 2.0 * f64::from(again) / true_px } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_far_from_all_lines_is_as_far_off_as_it_is() {
        let line = [vec![PxPoint::new(0.0, 0.0), PxPoint::new(100.0, 0.0)]];
        let path = [vec![PxPoint::new(400.0, 400.0), PxPoint::new(400.0, 401.0)]];
        // From (100, 0) to (400, 400.75), the middle of the last half pixel: √(300² + 400.75²).
        let judged = judge(&line, &path, 2.0);
        assert!((judged.max_px - 500.6).abs() < 0.01, "{judged:?}");
        assert_eq!(judge(&[], &path, 2.0).max_px, 0.0);
    }
}
