//! [`Merger`]: leaves out vertices that a tolerance does not need.

use crate::{Point, Segment};

/// Most vertices that one segment stands for.
const MOST: usize = 8;

/// A straight segment that stands for one or more of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Merged {
    pub(super) from: Point,
    pub(super) to: Point,
    /// Farthest that a vertex left out is from it, mm.
    pub(super) deviation_mm: f64,
    /// Square of the greatest speed, mm²/s².
    pub(super) cruise2: f32,
}

/// Joins segments as long as one straight line is near enough to all their vertices: the greedy form of polyline
/// simplification (W. E. Reumann, A. P. M. Witkam 1974; here with the distance from the segment itself), with a bounded memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Merger {
    from: Point,
    to: Point,
    /// The vertices from the start on, to the one where the segment ends: ways from the start, mm, which single precision says far
    /// better than any tolerance.
    points: [(f32, f32); MOST],
    count: usize,
    deviation_mm: f64,
    cruise2: f32,
}

impl Merger {
    /// Takes the line from where the path is, `from`, to `to`. Gives the segment that ends at `from`, if it does.
    pub(super) fn push(&mut self, from: Point, to: Point, cruise2: f32, tolerance_mm: f64) -> Option<Merged> {
        if self.count > 0
            && self.count < MOST
            && self.cruise2.total_cmp(&cruise2).is_eq()
            && let Some(deviation_mm) = self.deviation(to, tolerance_mm)
        {
            self.deviation_mm = deviation_mm;
            self.add(to);
            return None;
        }
        let ended = self.end();
        *self = Self { from, cruise2, ..Self::default() };
        self.add(to);
        ended
    }

    /// Ends the segment in progress.
    pub(super) fn end(&mut self) -> Option<Merged> {
        let Self { from, to, deviation_mm, cruise2, .. } = *self;
        if core::mem::take(&mut self.count) == 0 {
            return None;
        }
        Some(Merged { from, to, deviation_mm, cruise2 })
    }

    fn add(&mut self, point: Point) {
        let way = point - self.from;
        if let Some(slot) = self.points.get_mut(self.count) {
            #[expect(clippy::cast_possible_truncation, reason = "rounded, as the field says")]
            let rounded = (way.x as f32, way.y as f32);
            *slot = rounded;
            self.count += 1;
            self.to = point;
        }
    }

    /// How far the vertices are from a segment that ends at `to`; `None` for farther than the tolerance.
    fn deviation(&self, to: Point, tolerance_mm: f64) -> Option<f64> {
        let segment = Segment::new(Point::ORIGIN, Point::ORIGIN + (to - self.from));
        let mut most2 = 0.0_f64;
        for &(x, y) in self.points.get(..self.count)? {
            let point = Point::new(f64::from(x), f64::from(y));
            let away = point - segment.nearest(point);
            most2 = most2.max(away.length_squared());
            if most2 > tolerance_mm * tolerance_mm {
                return None;
            }
        }
        Some(libm::sqrt(most2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shallow_bend_is_left_out_and_a_deep_one_stays() {
        let mut merger = Merger::default();
        let at = |x, y| Point::new(x, y);
        assert_eq!(merger.push(at(0.0, 0.0), at(1.0, 0.01), 1.0, 0.02), None);
        assert_eq!(merger.push(at(1.0, 0.01), at(2.0, 0.0), 1.0, 0.02), None);
        let merged = merger.push(at(2.0, 0.0), at(2.0, 1.0), 1.0, 0.02).unwrap();
        assert_eq!((merged.from, merged.to), (at(0.0, 0.0), at(2.0, 0.0)));
        /// What single precision leaves of 0.01.
        const ROUNDING_MM: f64 = 1e-9;
        assert!((merged.deviation_mm - 0.01).abs() < ROUNDING_MM);
    }

    #[test]
    fn another_speed_ends_the_segment() {
        let mut merger = Merger::default();
        let at = |x| Point::new(x, 0.0);
        merger.push(at(0.0), at(1.0), 1.0, 0.1);
        assert!(merger.push(at(1.0), at(2.0), 4.0, 0.1).is_some());
    }
}
