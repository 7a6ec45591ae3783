//! [`Drawing::crop`]: what lies in an area, or outside of it.

use super::region::Keep;
use super::remains::{Part, Remains};
use super::{Bounds, CutCount, Drawing, Region};
use crate::Point;
use alloc::vec::Vec;

impl Drawing {
    /// Leaves of it what lies on one side of the border of a region; lines, arcs and curves are cut where
    /// they cross it.
    ///
    /// Arcs stay arcs and curves curves, and each piece has the pen, layer, speed and power that it had.
    /// Lines on the border count as inside. Pieces of less than a tenth of a micrometre go. What happens
    /// before a stroke that goes happens before the next one.
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Bounds, Drawing, Keep, Region, Stroke}};
    /// // A line of 10 mm, and a square of 2 mm about its middle: 2 mm lie within, and two lines of 4 mm without.
    /// let line = Stroke::through([Point::new(-5.0, 0.0), Point::new(5.0, 0.0)]).unwrap();
    /// let drawing = Drawing { strokes: vec![line], ..Drawing::new() };
    /// let square = Region::rectangle(Bounds::between(Point::new(-1.0, -1.0), Point::new(1.0, 1.0)));
    /// let (mut inner, mut outer) = (drawing.clone(), drawing);
    /// assert_eq!((inner.crop(&square, Keep::Inside).shortened, inner.length_mm()), (1, 2.0));
    /// assert_eq!((outer.crop(&square, Keep::Outside).shortened, outer.strokes.len(), outer.length_mm()), (1, 2, 8.0));
    /// ```
    pub fn crop(&mut self, region: &Region, keep: Keep) -> CutCount {
        let mut remains = Remains::default();
        let (mut shares, mut parts) = (Vec::new(), Vec::new());
        for stroke in core::mem::take(&mut self.strokes) {
            parts.clear();
            for (number, (from, segment)) in stroke.segments().enumerate() {
                shares.clear();
                shares.push((0.0, 1.0));
                region.keep(keep, from, segment, &segment.bounds(from), &mut shares);
                parts.extend(shares.iter().map(|&(begin, end)| Part { segment: number, begin, end }));
            }
            remains.take(stroke, &parts);
        }
        remains.into_drawing(self)
    }

    /// Leaves what lies in a rectangle or on its sides, which may lie at infinity: see [`crop`](Self::crop).
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Bounds, Drawing, PathSegment, Stroke}};
    /// // A circle of radius 2 about the corner of a rectangle: a quarter of it is left, π mm.
    /// let from = Point::new(2.0, 0.0);
    /// let circle = PathSegment::arc(Point::ORIGIN, std::f64::consts::TAU, from);
    /// let mut drawing = Drawing { strokes: vec![Stroke { from, segments: vec![circle], ..Stroke::default() }], ..Drawing::new() };
    /// drawing.crop_to_rectangle(Bounds::between(Point::ORIGIN, Point::new(9.0, 9.0)));
    /// assert!((drawing.length_mm() - std::f64::consts::PI).abs() < 1e-9);
    /// ```
    pub fn crop_to_rectangle(&mut self, rectangle: Bounds) -> CutCount {
        // No farther out than 1 mm beyond all that is drawn: the places of sides at infinity cannot be
        // reckoned.
        let all = self.bounds().wider(1.0);
        let least = Point::new(
            libm::fmax(rectangle.least.x, all.least.x),
            libm::fmax(rectangle.least.y, all.least.y),
        );
        let most =
            Point::new(libm::fmin(rectangle.most.x, all.most.x), libm::fmin(rectangle.most.y, all.most.y));
        self.crop(&Region::rectangle(Bounds { least, most }), Keep::Inside)
    }

    /// Leaves what lies in a polygon or on its sides, of which the last one leads back to the first corner:
    /// see [`crop`](Self::crop).
    ///
    /// ```
    /// use plotter_motion::{Point, drawing::{Drawing, Stroke}};
    /// // The triangle is 4 mm wide at half its height.
    /// let line = Stroke::through([Point::new(-9.0, 3.0), Point::new(9.0, 3.0)]).unwrap();
    /// let mut drawing = Drawing { strokes: vec![line], ..Drawing::new() };
    /// drawing.crop_to_polygon(&[Point::new(-4.0, 0.0), Point::new(4.0, 0.0), Point::new(0.0, 6.0)]);
    /// assert!((drawing.length_mm() - 4.0).abs() < 1e-9);
    /// ```
    pub fn crop_to_polygon(&mut self, corners: &[Point]) -> CutCount {
        self.crop(&Region::polygons([corners.iter().copied()]), Keep::Inside)
    }
}
