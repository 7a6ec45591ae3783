//! [`EdgeLine`]: straight edges of a picture, light on one side.

use super::coarse::Coarse;
use crate::picture::{PxPoint, PxVec};
use core::f64::consts::TAU;

/// Least slope of an edge, levels a coarse px: a step of 15 levels, three pixels wide.
const LEAST_SLOPE: f32 = 5.0;

/// What is steeper than this counts no more, levels a coarse px: a black table is no better an edge than a
/// brown one.
const MOST_SLOPE: f32 = 12.0;

/// Directions and distances that are told apart: degrees and coarse px to a bin.
const DEGREES: usize = 360;
const BIN_PX: f64 = 2.0;

/// An edge's direction is known to so many degrees, from the pixels around one.
const KNOWN_DEGREES: usize = 3;

/// Lines that differ less than that in both are one, degrees and bins.
const SAME_DEGREES: usize = 5;
const SAME_BINS: usize = 3;

/// Most lines that are looked at: all fours of them are tried, 4845.
const MOST_LINES: usize = 20;

/// A line has at least this part of the picture's shorter side of edges.
const LEAST_LENGTH: f64 = 0.12;

/// How far edges may lie from their line, coarse px, and turned, as the cosine.
const NEAR_PX: f64 = 3.0;
const NEAR_COS: f64 = 0.97;

/// A straight edge: the places p with p · out = away, light where p · out is less.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EdgeLine {
    /// Across the line, from light to dark; of length 1.
    pub(super) out: PxVec,
    pub(super) away: f64,
}

impl EdgeLine {
    /// How far a place lies on the dark side.
    pub(super) fn beyond(self, at: PxPoint) -> f64 {
        (at - PxPoint::default()).dot(self.out) - self.away
    }

    /// Where two lines cross; none for parallels.
    pub(super) fn crossing(self, other: Self) -> Option<PxPoint> {
        let cross = self.out.cross(other.out);
        let at = PxPoint::new(
            (self.away * other.out.y - other.away * self.out.y) / cross,
            (other.away * self.out.x - self.away * other.out.x) / cross,
        );
        at.is_finite().then_some(at)
    }

    /// The line nearest to weighted places in the sense of least squares, on whose `out` side this one's lies.
    pub(super) fn fitted(self, places: impl Iterator<Item = (PxPoint, f64)> + Clone) -> Option<Self> {
        let weight: f64 = places.clone().map(|(_, weight)| weight).sum();
        if !(weight > 0.0 && weight.is_finite()) {
            return None;
        }
        let sum = places
            .clone()
            .fold(PxVec::default(), |sum, (at, weight)| sum + (at - PxPoint::default()) * weight);
        let middle = PxPoint::default() + sum / weight;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (at, weight) in places {
            let from = at - middle;
            xx += weight * from.x * from.x;
            xy += weight * from.x * from.y;
            yy += weight * from.y * from.y;
        }
        // The greater principal axis lies along the line.
        let angle = 0.5 * libm::atan2(2.0 * xy, xx - yy);
        let across = PxVec::new(0.0, 1.0).rotated(angle);
        let out = if across.dot(self.out) < 0.0 { -across } else { across };
        Some(Self { out, away: (middle - PxPoint::default()).dot(out) })
    }
}

/// A place on an edge.
#[derive(Clone, Copy, Debug)]
struct Edge {
    at: PxPoint,
    out: PxVec,
    weight: f64,
}

/// The longest straight edges of a coarse picture, by the Hough transform with the edges' own directions.
///
/// Source: R. O. Duda, P. E. Hart, "Use of the Hough transformation to detect lines and curves in pictures"
/// (1972); the direction of each edge as the centre of its votes, D. H. Ballard, "Generalizing the Hough
/// transform to detect arbitrary shapes" (1981), section 2.
pub(super) fn edge_lines(coarse: &Coarse) -> Vec<EdgeLine> {
    let edges = edges(coarse);
    let reach = libm::hypot(coarse.width as f64, coarse.height as f64);
    let bins = 2 * bin(reach, 0.0) + 3;
    let mut votes = vec![0.0_f64; DEGREES * bins];
    let middle = PxPoint::new(coarse.width as f64 / 2.0, coarse.height as f64 / 2.0);
    for edge in &edges {
        let degree = degree(edge.out);
        for turn in 0..=2 * KNOWN_DEGREES {
            let degree = (degree + DEGREES + turn - KNOWN_DEGREES) % DEGREES;
            let away = (edge.at - middle).dot(direction(degree));
            if let Some(votes) = votes.get_mut(degree * bins + bin(away, reach)) {
                *votes += edge.weight;
            }
        }
    }
    let least = LEAST_LENGTH * coarse.width.min(coarse.height) as f64;
    let mut found: Vec<EdgeLine> = Vec::new();
    while found.len() < MOST_LINES {
        let best = votes.iter().enumerate().max_by(|one, other| one.1.total_cmp(other.1));
        let Some((at, votes_there)) = best else { break };
        if *votes_there < least {
            break;
        }
        let (best_degree, best_bin) = (at / bins, at % bins);
        for turn in 0..=2 * SAME_DEGREES {
            let degree = (best_degree + DEGREES + turn - SAME_DEGREES) % DEGREES;
            let from = degree * bins + best_bin.saturating_sub(SAME_BINS);
            let to = degree * bins + (best_bin + SAME_BINS + 1).min(bins);
            votes.get_mut(from..to).unwrap_or_default().fill(0.0);
        }
        let out = direction(best_degree);
        let from_middle = (best_bin as f64 + 0.5) * BIN_PX - reach;
        let line = EdgeLine { out, away: from_middle + (middle - PxPoint::default()).dot(out) };
        if let Some(line) = refined(line, &edges)
            && !found.iter().any(|other| is_same(*other, line, middle))
        {
            found.push(line);
        }
    }
    found
}

/// The line through the edges near a line; twice, for the first may miss the ends of a long one.
fn refined(line: EdgeLine, edges: &[Edge]) -> Option<EdgeLine> {
    let fitted = |line: EdgeLine| {
        let is_near =
            |edge: &&Edge| libm::fabs(line.beyond(edge.at)) < NEAR_PX && edge.out.dot(line.out) > NEAR_COS;
        line.fitted(edges.iter().filter(is_near).map(|edge| (edge.at, edge.weight)))
    };
    fitted(fitted(line)?)
}

/// Whether two lines came to the same place.
fn is_same(one: EdgeLine, other: EdgeLine, middle: PxPoint) -> bool {
    one.out.dot(other.out) > 0.9995 && libm::fabs(one.beyond(middle) - other.beyond(middle)) < BIN_PX
}

/// The steepest places of edges, each with its direction from light to dark.
fn edges(coarse: &Coarse) -> Vec<Edge> {
    let slope = |x: usize, y: usize| {
        let across = coarse.get(x + 1, y) - coarse.get(x.saturating_sub(1), y);
        let down = coarse.get(x, y + 1) - coarse.get(x, y.saturating_sub(1));
        (across / 2.0, down / 2.0)
    };
    let steepness = |x: usize, y: usize| {
        let (across, down) = slope(x, y);
        libm::hypotf(across, down)
    };
    let mut found = Vec::new();
    for y in 1..coarse.height.saturating_sub(1) {
        for x in 1..coarse.width.saturating_sub(1) {
            let (across, down) = slope(x, y);
            let steep = libm::hypotf(across, down);
            if steep < LEAST_SLOPE {
                continue;
            }
            // Steeper than the next pixels across the edge, of the eight around.
            let step = |part: f32| {
                if part > 0.38 * steep {
                    1
                } else if part < -0.38 * steep {
                    -1
                } else {
                    0_isize
                }
            };
            let (dx, dy) = (step(across), step(down));
            let ahead = steepness(x.saturating_add_signed(dx), y.saturating_add_signed(dy));
            let behind = steepness(x.saturating_add_signed(-dx), y.saturating_add_signed(-dy));
            if steep < ahead || steep <= behind {
                continue;
            }
            found.push(Edge {
                at: PxPoint::new(x as f64 + 0.5, y as f64 + 0.5),
                out: PxVec::new(f64::from(-across / steep), f64::from(-down / steep)),
                weight: f64::from(steep.min(MOST_SLOPE) / MOST_SLOPE),
            });
        }
    }
    found
}

fn direction(degree: usize) -> PxVec {
    PxVec::new(1.0, 0.0).rotated(degree as f64 * TAU / DEGREES as f64)
}

fn degree(out: PxVec) -> usize {
    let degrees = libm::atan2(out.y, out.x) / TAU * DEGREES as f64;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0.5 to 720.5")]
    let degree = (degrees + DEGREES as f64 + 0.5) as usize;
    degree % DEGREES
}

/// The bin of a distance of -`reach` or more.
fn bin(away: f64, reach: f64) -> usize {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a picture's diagonal at most"
    )]
    let bin = ((away + reach).max(0.0) / BIN_PX) as usize;
    bin
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_cross_where_they_should() {
        // x = 3 and y = 5, light to the left and above.
        let right = EdgeLine { out: PxVec::new(1.0, 0.0), away: 3.0 };
        let lower = EdgeLine { out: PxVec::new(0.0, 1.0), away: 5.0 };
        assert_eq!(right.crossing(lower), Some(PxPoint::new(3.0, 5.0)));
        assert_eq!(right.crossing(right), None);
        assert_eq!(right.beyond(PxPoint::new(5.0, 0.0)), 2.0);
    }

    #[test]
    fn a_fitted_line_goes_through_its_places() {
        // 3 x - 4 y + 7 = 0 has the normal (0.6, -0.8).
        let on = [0.0, 1.0, 5.0, 20.0].map(|t| (PxPoint::new(-1.0 + 4.0 * t, 1.0 + 3.0 * t), 1.0));
        let start = EdgeLine { out: PxVec::new(0.0, -1.0), away: 0.0 };
        let line = start.fitted(on.into_iter()).unwrap();
        assert!((line.out - PxVec::new(0.6, -0.8)).length() < 1e-12, "{line:?}");
        assert!((line.away + 1.4).abs() < 1e-9, "{line:?}");
    }
}
