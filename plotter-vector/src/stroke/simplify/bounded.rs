//! [`Bounded`]: the fewest vertices for a promised error.

use super::Simplify;
use crate::picture::Pixel;
use crate::stroke::PxVec;

/// Longest range of pixels that one segment replaces, px: the work is bounded by pixels × reach.
pub const MAX_REACH_PX: usize = 8192;

/// Most pixels that are done in one go: with about 70 bytes each, 35 MiB. Twice as many would no longer keep
/// the sums exact on the longest side of a picture.
const PIECE_PX: usize = 1 << 19;

/// Added to the tolerance so that a pixel exactly on it passes in spite of rounding, px.
const ROUNDING_PX: f64 = 1e-9;

/// The fewest vertices such that no pixel is farther than a tolerance from the segment that replaced it.
///
/// The vertices are pixels of the figure, the first and the last among them. Each segment stands for the
/// pixels between its ends, and each of them lies within `tolerance_px` of it (of the *segment*, not of its
/// line). Of all such polylines this is one with the fewest vertices, and among those one with the least sum
/// of squared distances from the pixels to their segments' lines. So it never has more vertices than the
/// published algorithm at the published algorithm's own greatest error.
///
/// Three limits keep time and memory in bounds; a line of a drawing meets none of them, and the tolerance
/// holds all the same. No segment replaces more than [`MAX_REACH_PX`] pixels: a longer line gets a vertex
/// there. A figure of more than 2¹⁹ pixels (a blot, not a line) is done piece by piece, with a vertex at each
/// seam. And where a line turns back on itself so often that a pixel's candidates would have to be checked
/// one by one over more than `MAX_REACH_PX` pixels, the rest of them is left out.
///
/// Sources: H. Imai, M. Iri, "Polygonal approximations of a curve" (1988): shortest path over the allowed
/// segments; W. S. Chan, F. Chin, "Approximation of polygonal curves with minimum number of line segments"
/// (1992): a segment is within the tolerance when both rays along it are, and the directions allowed to a ray
/// form a cone that only shrinks.
///
/// ```
/// # use plotter_vector::{Pixel, stroke::{Bounded, Simplify}};
/// // A slope of 1 px in 10, as a raster has it: three stairs, never more than 0.5 px off the straight line.
/// let stairs: Vec<Pixel> = (0..31).map(|x| Pixel::new(x, (x + 5) / 10)).collect();
/// assert_eq!(Bounded::default().with_tolerance_px(0.5).keep(&stairs), [0, 30]);
/// assert_eq!(Bounded::default().with_tolerance_px(0.0).keep(&stairs).len(), 8); // every end of a stair
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bounded {
    /// Greatest distance of a pixel's centre from its segment, px. Negative and NaN act as 0: then only what
    /// lies exactly on a segment goes.
    pub tolerance_px: f64,
}

impl Bounded {
    /// The same with another [`Bounded::tolerance_px`].
    #[must_use]
    pub const fn with_tolerance_px(self, tolerance_px: f64) -> Self {
        Self { tolerance_px, ..self }
    }
}

impl Default for Bounded {
    /// Half a pixel: what the raster itself rounded away.
    fn default() -> Self {
        Self { tolerance_px: 0.5 }
    }
}

/// The best polyline from the first pixel to one.
#[derive(Clone, Copy, Debug)]
struct Best {
    /// Segments so far.
    segments: u32,
    /// Sum of squared distances of the replaced pixels, px².
    squares: f64,
    /// Vertex before this one.
    previous: usize,
}

impl Best {
    fn beats(&self, other: &Self) -> bool {
        self.segments < other.segments || (self.segments == other.segments && self.squares < other.squares)
    }
}

impl Simplify for Bounded {
    fn keep(&self, pixels: &[Pixel]) -> Vec<usize> {
        let Some(last) = pixels.len().checked_sub(1) else { return Vec::new() };
        let mut kept = vec![0];
        let mut start = 0;
        while start < last {
            // The last pixel of a piece is the first one of the next.
            let end = last.min(start + PIECE_PX);
            let piece = pixels.get(start..=end).unwrap_or(&[]);
            kept.extend(self.vertices_after_the_first(piece).into_iter().map(|vertex| start + vertex));
            start = end;
        }
        kept
    }
}

impl Bounded {
    /// The vertices of the best polyline, rising.
    fn vertices_after_the_first(&self, pixels: &[Pixel]) -> Vec<usize> {
        let best = self.shortest_paths(pixels);
        let mut kept = Vec::new();
        let mut vertex = pixels.len().saturating_sub(1);
        while vertex > 0 {
            kept.push(vertex);
            // Every path leads strictly back, so this ends at the first pixel.
            vertex = best.get(vertex).map_or(0, |best| best.previous.min(vertex - 1));
        }
        kept.reverse();
        kept
    }

    /// The best polyline to each pixel, from the first.
    fn shortest_paths(&self, pixels: &[Pixel]) -> Vec<Best> {
        let chain = Chain::new(pixels, self.tolerance_px.max(0.0) + ROUNDING_PX);
        let mut best = Vec::with_capacity(pixels.len());
        best.push(Best { segments: 0, squares: 0.0, previous: 0 });
        // The best vertex in the straight run that ends at the present pixel; see below.
        let mut in_run = Best { segments: 0, squares: 0.0, previous: 0 };
        for end in 1..pixels.len() {
            let Some(before) = best.get(end - 1).copied() else { break };
            let step = Best { segments: before.segments + 1, squares: before.squares, previous: end - 1 };
            let run = chain.run_start(end);
            // Within a straight run every segment is exact: no constraint to check and nothing to add up. The
            // best start in the run is therefore carried along instead of searched.
            if run + 1 == end || step.beats(&in_run) || end - in_run.previous > MAX_REACH_PX {
                in_run = step;
            }
            best.push(chain.search_back(end, run, in_run, &best));
        }
        best
    }
}

/// The pixels of a figure with what makes a range of them cheap to judge.
struct Chain<'a> {
    pixels: &'a [Pixel],
    radius_px: f64,
    /// For each pixel the first one of the straight run that ends here: all steps equal.
    run_starts: Vec<u32>,
    /// Sums over the pixels before each index, relative to the first pixel: x, y, x², xy, y². Whole numbers,
    /// exact below 2⁵³: always so within the size limits of a picture, for a piece has 2¹⁹ + 1 pixels, none
    /// farther than 2¹⁷ − 1 from its first.
    sums: Vec<[f64; 5]>,
}

impl<'a> Chain<'a> {
    fn new(pixels: &'a [Pixel], radius_px: f64) -> Self {
        let mut run_starts: Vec<u32> = Vec::with_capacity(pixels.len());
        let mut sums = Vec::with_capacity(pixels.len() + 1);
        let mut sum = [0.0; 5];
        sums.push(sum);
        let mut last_step = None;
        for (index, pixel) in pixels.iter().enumerate() {
            let PxVec { x, y } = pixels.first().map_or(PxVec::default(), |first| *pixel - *first);
            for (sum, term) in sum.iter_mut().zip([x, y, x * x, x * y, y * y]) {
                *sum += term;
            }
            sums.push(sum);
            let step = index.checked_sub(1).and_then(|before| pixels.get(before)).map(|from| *pixel - *from);
            let before = u32::try_from(index.saturating_sub(1)).unwrap_or(u32::MAX);
            let goes_on = step.is_some() && step == last_step;
            let start = if goes_on { run_starts.last().copied().unwrap_or(before) } else { before };
            run_starts.push(start);
            last_step = step;
        }
        Self { pixels, radius_px, run_starts, sums }
    }

    fn run_start(&self, index: usize) -> usize {
        self.run_starts.get(index).map_or(0, |start| *start as usize)
    }

    /// The best way to reach `end`: `known` from its own straight run, which starts at `run`, or better.
    ///
    /// Goes back from pixel to pixel while the cone of directions from `end` that pass all pixels so far is
    /// not empty. Only the ends of straight runs narrow it: the distance to a segment or a ray, a convex set,
    /// is a convex function, so along a straight run it is greatest at one of the run's ends.
    fn search_back(&self, end: usize, run: usize, known: Best, best: &[Best]) -> Best {
        let mut found = known;
        let Some(apex) = self.pixels.get(end).copied() else { return found };
        let mut cone = Cone::full();
        let mut farthest_squared = 0.0_f64;
        // Pixels that the second check may look at before it gives up: the work stays within pixels × reach.
        let mut budget = MAX_REACH_PX;
        let first = end.saturating_sub(MAX_REACH_PX);
        let mut corner = run;
        while corner > first {
            let Some(at) = self.pixels.get(corner) else { break };
            let away = *at - apex;
            farthest_squared = farthest_squared.max(away.length_squared());
            if !cone.narrow(away, self.radius_px) {
                break;
            }
            let next_corner = self.run_start(corner);
            // A line enters a convex cone and leaves it once: only the steps between are looked at.
            let step = self.pixels.get(corner - 1).map_or(PxVec::default(), |before| *before - *at);
            let steps = corner - next_corner.max(first);
            let Some((nearest, farthest)) = cone.steps_inside(away, step, steps) else {
                corner = next_corner;
                continue;
            };
            for start in (corner - farthest..=corner - nearest).rev() {
                let (Some(from), Some(path)) = (self.pixels.get(start), best.get(start)) else { break };
                let direction = *from - apex;
                if !cone.contains(direction) {
                    continue;
                }
                if path.segments + 1 > found.segments
                    || path.squares > found.squares && path.segments + 1 == found.segments
                {
                    continue;
                }
                let squares = path.squares + self.squares(start, end);
                let candidate = Best { segments: path.segments + 1, squares, previous: start };
                if !candidate.beats(&found) {
                    continue;
                }
                // The cone keeps the pixels near the ray from `end` through `start`. They are near the
                // segment unless they lie beyond `start`, and none does if none is farther from `end` than
                // `start` is.
                if farthest_squared <= direction.length_squared() || self.within(start, end, &mut budget) {
                    found = candidate;
                }
            }
            corner = next_corner;
        }
        found
    }

    /// Whether all pixels between are within the radius of the segment from `start` to `end`, looked at one
    /// by one.
    fn within(&self, start: usize, end: usize, budget: &mut usize) -> bool {
        let (Some(from), Some(to)) = (self.pixels.get(start), self.pixels.get(end)) else { return false };
        for pixel in self.pixels.get(start + 1..end).unwrap_or(&[]) {
            let Some(left) = budget.checked_sub(1) else { return false };
            *budget = left;
            if segment_distance_squared(*pixel, *from, *to) > self.radius_px * self.radius_px {
                return false;
            }
        }
        true
    }

    /// Sum over the pixels between of the squared distance to the line through `start` and `end`; to the
    /// point, where both are one. With v the direction and d a pixel from `end`: Σ (v × d)² / v².
    fn squares(&self, start: usize, end: usize) -> f64 {
        let (Some(before), Some(after)) = (self.sums.get(start + 1), self.sums.get(end)) else { return 0.0 };
        let (Some(from), Some(to), Some(origin)) =
            (self.pixels.get(start), self.pixels.get(end), self.pixels.first())
        else {
            return 0.0;
        };
        let [sx, sy, sxx, sxy, syy] =
            core::array::from_fn(|i| after.get(i).unwrap_or(&0.0) - before.get(i).unwrap_or(&0.0));
        #[expect(clippy::cast_precision_loss, reason = "a count of pixels, far below 2^53")]
        let count = (end - start - 1) as f64;
        let PxVec { x, y } = *to - *origin;
        let dxx = sxx - 2.0 * x * sx + count * x * x;
        let dxy = sxy - x * sy - y * sx + count * x * y;
        let dyy = syy - 2.0 * y * sy + count * y * y;
        let v = *from - *to;
        let length_squared = v.length_squared();
        if length_squared > 0.0 {
            // Rounding may leave a tiny negative number of an exact zero.
            ((v.x * v.x * dyy - 2.0 * v.x * v.y * dxy + v.y * v.y * dxx) / length_squared).max(0.0)
        } else {
            dxx + dyy
        }
    }
}

/// Directions from an apex, between two of them, less than a half turn apart; or all.
struct Cone {
    /// Clockwise and counter-clockwise border (seen with y up).
    borders: Option<(PxVec, PxVec)>,
}

impl Cone {
    const fn full() -> Self {
        Self { borders: None }
    }

    /// Keeps the directions whose ray passes within `radius_px` of the point `away` from the apex; `false`
    /// when none is left.
    fn narrow(&mut self, away: PxVec, radius_px: f64) -> bool {
        let tangent_squared = away.length_squared() - radius_px * radius_px;
        if tangent_squared <= 0.0 {
            return true; // The apex itself is near enough: any ray will do.
        }
        // The tangents of the disc: `away` turned by ± asin(r/|d|), times |d|.
        let cosine = libm::sqrt(tangent_squared);
        let right = PxVec::new(away.x * cosine + away.y * radius_px, away.y * cosine - away.x * radius_px);
        let left = PxVec::new(away.x * cosine - away.y * radius_px, away.y * cosine + away.x * radius_px);
        let other = Self { borders: Some((right, left)) };
        let Some((old_right, old_left)) = self.borders else {
            *self = other;
            return true;
        };
        let new_right = if self.contains(right) { right } else { old_right };
        let new_left = if self.contains(left) { left } else { old_left };
        self.borders = Some((new_right, new_left));
        // Either the new border replaced the old one, or the old one must lie in the new cone.
        other.contains(new_right) && other.contains(new_left)
    }

    /// The first and the last of `1..=steps` steps of a walk from `away` that may lie in the cone, up to one
    /// step too many at either end; `None` when none does.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "whole numbers between 1 and the reach"
    )]
    fn steps_inside(&self, away: PxVec, step: PxVec, steps: usize) -> Option<(usize, usize)> {
        let (mut first, mut last) = (1.0, steps as f64);
        let Some((right, left)) = self.borders else { return Some((1, steps)) };
        // Beside either border the signed distance is a + k·b, and not negative within.
        for (a, b) in [(right.cross(away), right.cross(step)), (away.cross(left), step.cross(left))] {
            if b > 0.0 {
                first = f64::max(first, libm::floor(-a / b) - 1.0);
            } else if b < 0.0 {
                last = f64::min(last, libm::ceil(-a / b) + 1.0);
            } else if a < 0.0 {
                return None;
            }
        }
        (first <= last).then_some((first as usize, last as usize))
    }

    fn contains(&self, direction: PxVec) -> bool {
        self.borders.is_none_or(|(right, left)| right.cross(direction) >= 0.0 && direction.cross(left) >= 0.0)
    }
}

/// Squared distance of a pixel's centre from the segment between two others, px².
pub(crate) fn segment_distance_squared(pixel: Pixel, from: Pixel, to: Pixel) -> f64 {
    let (along, away) = (to - from, pixel - from);
    let length_squared = along.length_squared();
    let dot = along.dot(away);
    if dot <= 0.0 {
        away.length_squared()
    } else if dot >= length_squared {
        (pixel - to).length_squared()
    } else {
        let area = along.cross(away);
        area * area / length_squared
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_longer_than_the_reach_gets_a_vertex_at_the_reach() {
        let level: Vec<Pixel> = (0..10_000).map(|x| Pixel::new(x, 0)).collect();
        let kept = Bounded::default().keep(&level);
        assert_eq!(kept.len(), 3);
        assert!(kept.windows(2).all(|pair| pair[1] - pair[0] <= MAX_REACH_PX), "{kept:?}");
    }

    #[test]
    fn a_figure_longer_than_a_piece_has_its_seam_as_a_vertex() {
        // A black block, row by row there and back: each row is a line, and each of its ends a vertex.
        let columns = 4_000;
        let across =
            |y: u32| (0..columns).map(move |x| if y.is_multiple_of(2) { x } else { columns - 1 - x });
        let block: Vec<Pixel> = (0..150).flat_map(|y| across(y).map(move |x| Pixel::new(x, y))).collect();
        assert!(block.len() > PIECE_PX);
        let kept = Bounded { tolerance_px: 0.1 }.keep(&block);
        assert!(kept.contains(&PIECE_PX));
        assert_eq!(kept.len(), 2 * 150 + 1);
    }

    #[test]
    fn a_cone_is_entered_and_left_where_its_borders_are_crossed() {
        // The rays from (0, 0) that pass within 5 px of (10, 0) rise by up to 5 / sqrt(75), 30 degrees; a
        // walk upwards at x = 20 from y = -50 is inside from y = -11.5 to 11.5, its steps 39 to 61.
        let mut cone = Cone::full();
        let (away, step) = (PxVec::new(20.0, -50.0), PxVec::new(0.0, 1.0));
        assert_eq!(cone.steps_inside(away, step, 100), Some((1, 100)));
        assert!(cone.narrow(PxVec::new(10.0, 0.0), 5.0));
        let (first, last) = cone.steps_inside(away, step, 100).unwrap();
        assert!((37..=39).contains(&first) && (61..=63).contains(&last), "{first} to {last}");
        assert_eq!(cone.steps_inside(away, step, 30), None);
        assert_eq!(cone.steps_inside(PxVec::new(-20.0, 0.0), PxVec::new(-1.0, 0.0), 100), None);
    }
}
