//! [`polish`]: vertices moved to where the squared distances are least, within the promise.

use super::min_link_path::Vertex;
use super::promise::{Promise, distance_to_segment_squared};
use super::ray_cone::unit;
use crate::stroke::{PxPoint, PxVec};

/// Shortest move that is worth the check, px.
const LEAST_MOVE_PX: f64 = 0.01;

/// Sites of two links below which their vertex stays: nothing is left to average.
const FEWEST_SITES: usize = 4;

/// Part of a vertex' weight that holds it back where its two links are nearly in line.
const DAMPING: f64 = 0.01;

/// Steps that are tried on the way to the best place, each 0.4 times as long as the one before.
const TRIALS: usize = 3;

/// Moves each inner vertex in turn to where the sum of the squared distances of its two links is least, as
/// far as the promise allows (Gauss-Seidel on the Gauss-Newton equations of a linear spline with free knots);
/// up to `sweeps` times, there and back.
pub(super) fn polish(promise: Promise, sites: &[PxPoint], vertices: &mut [Vertex], sweeps: usize) {
    let mut moved = vec![true; vertices.len()];
    for sweep in 0..sweeps {
        let mut any = false;
        // A vertex is looked at again when it or a neighbour moved.
        for step in 1..vertices.len().saturating_sub(1) {
            let index = if sweep % 2 == 0 { step } else { vertices.len() - 1 - step };
            let Some([before, vertex, after]) = vertices.get(index - 1..index + 2) else { break };
            let stirred = moved.get(index - 1..index + 2).unwrap_or(&[]).contains(&true);
            if !stirred || after.done.saturating_sub(before.done) < FEWEST_SITES {
                continue;
            }
            let better = Corner { promise, sites, before: *before, vertex: *vertex, after: *after }.better();
            any |= better.is_some();
            if let Some(moved) = moved.get_mut(index) {
                *moved = better.is_some();
            }
            if let (Some(vertex), Some(better)) = (vertices.get_mut(index), better) {
                *vertex = better;
            }
        }
        if !any {
            break;
        }
    }
}

/// A vertex between its two neighbours.
struct Corner<'a> {
    promise: Promise,
    sites: &'a [PxPoint],
    before: Vertex,
    vertex: Vertex,
    after: Vertex,
}

/// Half of the normal equations: Σ w², Σ w e, Σ e² with the weight w of the vertex and the error e of a site.
#[derive(Clone, Copy, Default)]
struct Sums {
    weight: f64,
    pull: f64,
    squares: f64,
}

impl Corner<'_> {
    fn range(&self, from: usize, to: usize) -> &[PxPoint] {
        self.sites.get(from..to).unwrap_or(&[])
    }

    /// A place that fits better and keeps the promise.
    fn better(&self) -> Option<Vertex> {
        let at = self.vertex.at;
        let first = unit(at - self.before.at);
        let second = unit(self.after.at - at);
        let (n1, n2) = (first.or(second)?.perpendicular(), second.or(first)?.perpendicular());
        let a = sums(self.before.at, at, n1, self.range(self.before.done, self.vertex.done));
        let b = sums(self.after.at, at, n2, self.range(self.vertex.done, self.after.done));
        let damping = DAMPING * (a.weight + b.weight) + 1e-9;
        let (xx, xy, yy) = (
            a.weight * n1.x * n1.x + b.weight * n2.x * n2.x + damping,
            a.weight * n1.x * n1.y + b.weight * n2.x * n2.y,
            a.weight * n1.y * n1.y + b.weight * n2.y * n2.y + damping,
        );
        let (px, py) = (a.pull * n1.x + b.pull * n2.x, a.pull * n1.y + b.pull * n2.y);
        let determinant = xx * yy - xy * xy;
        let step = PxVec::new(px * yy - py * xy, py * xx - px * xy) / determinant;
        let squares = a.squares + b.squares;
        let mut scale = 1.0;
        for _ in 0..TRIALS {
            let length_squared = step.length_squared() * scale * scale;
            if length_squared.is_nan() || length_squared <= LEAST_MOVE_PX * LEAST_MOVE_PX {
                return None;
            }
            let moved = self.attached(at + step * scale);
            if self.squares(moved).is_some_and(|new| new < squares) {
                return Some(moved);
            }
            scale *= 0.4;
        }
        None
    }

    /// The sum of the squares with the vertex elsewhere, or nothing where the promise would break.
    fn squares(&self, vertex: Vertex) -> Option<f64> {
        let (before, after) = (self.sites.get(vertex.done.checked_sub(1)?)?, self.sites.get(vertex.done)?);
        // Two vertices between the same two sites would have to be in order there as well.
        let in_order = self.before.done < vertex.done && vertex.done < self.after.done;
        if !in_order || !self.promise.vertex(vertex.at, *before, *after) {
            return None;
        }
        let first = self.range(self.before.done, vertex.done);
        let second = self.range(vertex.done, self.after.done);
        Some(
            self.promise.link(self.before.at, vertex.at, first)?
                + self.promise.link(vertex.at, self.after.at, second)?,
        )
    }

    /// A place with the nearest way between two sites that follow each other, looked for from the present one
    /// on.
    fn attached(&self, at: PxPoint) -> Vertex {
        const LOOK_AHEAD: usize = 3;
        let first = self.before.done + 1;
        let last = self.after.done.saturating_sub(1);
        let distance = |done: usize| {
            let pair =
                done.checked_sub(1).and_then(|before| self.sites.get(before)).zip(self.sites.get(done));
            pair.map_or(f64::INFINITY, |(before, after)| distance_to_segment_squared(at, *before, *after))
        };
        let mut best = (distance(self.vertex.done), self.vertex.done);
        loop {
            let done = best.1;
            for other in done.saturating_sub(LOOK_AHEAD).max(first)..=(done + LOOK_AHEAD).min(last) {
                let there = distance(other);
                if there < best.0 {
                    best = (there, other);
                }
            }
            if best.1 == done {
                return Vertex { at, done };
            }
        }
    }
}

/// The sums over one link, which runs from its far end to the vertex.
fn sums(far: PxPoint, vertex: PxPoint, normal: PxVec, sites: &[PxPoint]) -> Sums {
    let way = vertex - far;
    let length_squared = way.length_squared();
    let inverse = if length_squared > 0.0 { 1.0 / length_squared } else { 0.0 };
    let along = way * inverse;
    let mut sums = Sums::default();
    for site in sites {
        let away = *site - far;
        let weight = along.dot(away).clamp(0.0, 1.0);
        let error = normal.dot(away);
        sums.weight += weight * weight;
        sums.pull += weight * error;
        sums.squares += error * error;
    }
    sums
}
