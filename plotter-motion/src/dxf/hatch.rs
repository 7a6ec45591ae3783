//! [`Hatch`]: an area, and the lines that fill it.

use super::path::Bow;
use super::spline::Spline;
use crate::drawing::affine::sin_cos;
use crate::drawing::scan::{Rows, TooMany};
use crate::drawing::{Affine, PathSegment, Stroke};
use crate::{Point, Vec2};
use alloc::vec::Vec;

/// Most repetitions of the dashes of one line: 10 m of them at 0.1 mm.
const MOST_DASHES: f64 = 100_000.0;
/// The shortest dashes as a share of how far the line runs from where they begin: millions of times the
/// rounding of their ends.
const LEAST_DASHES: f64 = 1e-9;
/// Most lines and dashes of one area, but for the dashes of the last line: a dash each mm² of an A0 sheet.
const MOST_DRAWN: usize = 1_000_000;

/// A part of an area's outline.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Edge {
    Line { from: Point, to: Point },
    Bow(Bow),
    Spline(Spline),
}

/// Lines at equal distances.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Family {
    pub(super) turned_rad: f64,
    /// Where one of them begins.
    pub(super) base: Point,
    /// From there to where the next one does.
    pub(super) offset: Vec2,
    /// Dashes, and gaps below 0; none for whole lines.
    pub(super) dashes: Vec<f64>,
}

/// An area.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Hatch {
    /// Its outlines: what lies within an odd number of them is filled.
    pub(super) outlines: Vec<Vec<Edge>>,
    pub(super) families: Vec<Family>,
    pub(super) is_solid: bool,
}

impl Hatch {
    /// Its outlines on the sheet, which end where they begin.
    pub(super) fn outlines(&self, plane: &Affine, tolerance_mm: f64) -> Vec<Stroke> {
        self.outlines.iter().filter_map(|edges| outline(edges, plane, tolerance_mm)).collect()
    }

    /// The lines that fill it, on the sheet, by the rule of odd and even.
    ///
    /// # Errors
    ///
    /// Lines that are too many, or have no distance.
    pub(super) fn lines(&self, plane: &Affine, tolerance_mm: f64) -> Result<Vec<(Point, Point)>, TooMany> {
        let outlines = self.outlines(plane, tolerance_mm);
        let outlines: Vec<Vec<Point>> =
            outlines.iter().map(|outline| outline.places(tolerance_mm).collect()).collect();
        let mut drawn = Vec::new();
        for family in &self.families {
            family.fill(plane, &outlines, &mut drawn)?;
        }
        Ok(drawn)
    }
}

fn outline(edges: &[Edge], plane: &Affine, tolerance_mm: f64) -> Option<Stroke> {
    let from = match edges.first()? {
        Edge::Line { from, .. } => plane.apply(*from),
        Edge::Bow(bow) => bow.from(plane),
        Edge::Spline(spline) => plane.apply(spline.points.first()?.flat()),
    };
    let mut stroke = Stroke { from, ..Stroke::default() };
    for edge in edges {
        match edge {
            Edge::Line { to, .. } => stroke.segments.push(PathSegment::line(plane.apply(*to))),
            Edge::Bow(bow) => bow.draw(plane, None, &mut stroke),
            Edge::Spline(spline) => {
                let scale = libm::fmax(plane.x.length(), plane.y.length());
                let places = spline.places(tolerance_mm / libm::fmax(scale, f64::MIN_POSITIVE));
                stroke
                    .segments
                    .extend(places.into_iter().map(|at| PathSegment::line(plane.apply(at.flat()))));
            }
        }
    }
    if stroke.to() != from {
        stroke.segments.push(PathSegment::line(from));
    }
    Some(stroke)
}

impl Family {
    fn fill(
        &self,
        plane: &Affine,
        outlines: &[Vec<Point>],
        drawn: &mut Vec<(Point, Point)>,
    ) -> Result<(), TooMany> {
        let (sin, cos) = sin_cos(self.turned_rad);
        let seen = plane.way(Vec2::new(cos, sin));
        let stretch = seen.length();
        let (Some(way), offset) = (seen.normalized(), plane.way(self.offset)) else { return Ok(()) };
        let rows = Rows { base: plane.apply(self.base), way, distance_mm: way.perpendicular().dot(offset) };
        // The dashes of each line begin where the offset, which need not be across the lines, has carried
        // them.
        let shift_mm = way.dot(offset);
        rows.fill(outlines, |row, from, to| {
            let begins = shift_mm * row;
            if drawn.len() > MOST_DRAWN {
                return;
            }
            self.dash(from - begins, to - begins, stretch, |a, b| {
                drawn.push((rows.place(row, a + begins), rows.place(row, b + begins)));
            });
        })?;
        if drawn.len() > MOST_DRAWN {
            Err(TooMany { lines: f64::INFINITY, most: MOST_DRAWN as f64 })
        } else {
            Ok(())
        }
    }

    /// The dashes of a line that begins at 0 and is seen from one length to another.
    fn dash(&self, from: f64, to: f64, stretch: f64, mut push: impl FnMut(f64, f64)) {
        let total = stretch * self.dashes.iter().map(|part| libm::fabs(*part)).sum::<f64>();
        let farthest = libm::fmax(libm::fabs(from), libm::fabs(to));
        if total <= LEAST_DASHES * farthest || (to - from) / total > MOST_DASHES {
            push(from, to);
            return;
        }
        let mut at = libm::floor(from / total) * total;
        while at < to {
            for part in &self.dashes {
                let end = at + stretch * libm::fabs(*part);
                if *part >= 0.0 && end >= from && at <= to {
                    push(libm::fmax(at, from), libm::fmin(end, to));
                }
                at = end;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;

    fn square(from: f64, to: f64) -> Vec<Edge> {
        let places =
            [(from, from), (to, from), (to, to), (from, to), (from, from)].map(|(x, y)| Point::new(x, y));
        places.windows(2).map(|pair| Edge::Line { from: pair[0], to: pair[1] }).collect()
    }

    fn family(dashes: &[f64]) -> Family {
        Family {
            offset: Vec2::new(0.0, 1.0),
            base: Point::new(0.0, 0.5),
            dashes: dashes.to_vec(),
            turned_rad: 0.0,
        }
    }

    #[test]
    fn a_square_with_a_hole_is_filled_round_it() {
        let hatch = Hatch {
            outlines: vec![square(0.0, 10.0), square(4.0, 6.0)],
            families: vec![family(&[])],
            is_solid: false,
        };
        let lines = hatch.lines(&Affine::IDENTITY, 0.01).unwrap();
        // Ten lines, of which the two at 4.5 and 5.5 are in two parts.
        assert_eq!(lines.len(), 12);
        let length: f64 = lines.iter().map(|(from, to)| from.distance(*to)).sum();
        assert!((length - 96.0).abs() < 1e-9, "{length}");
    }

    #[test]
    fn dashes_keep_their_places_on_each_line() {
        let hatch = Hatch {
            outlines: vec![square(1.0, 10.0)],
            families: vec![family(&[2.0, -1.0])],
            is_solid: false,
        };
        let lines = hatch.lines(&Affine::IDENTITY, 0.01).unwrap();
        let first: Vec<_> = lines.iter().take(4).map(|(from, to)| (from.x, to.x)).collect();
        assert_eq!(first, [(1.0, 2.0), (3.0, 5.0), (6.0, 8.0), (9.0, 10.0)]);
    }

    #[test]
    fn lines_without_a_distance_fill_nothing() {
        let families = vec![Family { offset: Vec2::new(1.0, 0.0), ..family(&[]) }];
        let hatch = Hatch { outlines: vec![square(0.0, 1.0)], families, is_solid: false };
        assert!(hatch.lines(&Affine::IDENTITY, 0.01).is_err());
    }

    #[test]
    fn dashes_that_nobody_can_tell_apart_are_a_line() {
        // So far from where the dashes begin, the end of a dash is its start.
        let far = Family { base: Point::new(-1e20, 0.5), ..family(&[2.0, -1.0]) };
        let hatch = Hatch { outlines: vec![square(0.0, 1e5)], families: vec![far], is_solid: false };
        assert_eq!(hatch.lines(&Affine::IDENTITY, 0.01).map(|lines| lines.len()), Ok(100_000));
    }

    #[test]
    fn dashes_beyond_all_measure_are_told() {
        let families = vec![family(&[0.01, -0.01])];
        let hatch = Hatch { outlines: vec![square(0.0, 1500.0)], families, is_solid: false };
        assert!(hatch.lines(&Affine::IDENTITY, 0.01).is_err());
    }

    #[test]
    fn lines_that_nobody_can_count_end() {
        // At 10²⁰ the next line has the number of this one.
        let families = vec![Family { base: Point::new(0.0, -1e20), ..family(&[]) }];
        let hatch = Hatch { outlines: vec![square(0.0, 1e5)], families, is_solid: false };
        assert!(hatch.lines(&Affine::IDENTITY, 0.01).is_err());
    }
}
