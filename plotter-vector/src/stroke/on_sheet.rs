//! Traced drawings as drawings of the sheet ([`plotter_motion::drawing::Drawing`]), and back.

use crate::stroke::curve::Segment;
use crate::stroke::{Curve, Drawing, PxPoint, Scale};
use plotter_motion::Point;
use plotter_motion::drawing::{self, PathSegment, Shape, Stroke};

impl Drawing {
    /// The same strokes on the sheet, mm: arcs and cubic curves stay what they are.
    ///
    /// ```
    /// # use plotter_vector::{Drawing, PxPoint, Scale};
    /// use plotter_motion::Point;
    /// let mut drawing = Drawing::new(20, 10);
    /// drawing.push([PxPoint::new(2.0, 10.0), PxPoint::new(2.0, 4.0)]);
    /// let sheet = drawing.on_sheet(Scale::new(10, 0.5, Point::ORIGIN)?);
    /// assert_eq!((sheet.strokes[0].from, sheet.strokes[0].to()), (Point::new(1.0, 0.0), Point::new(1.0, 3.0)));
    /// # Ok::<(), plotter_vector::stroke::ScaleError>(())
    /// ```
    #[must_use]
    pub fn on_sheet(&self, scale: Scale) -> drawing::Drawing {
        let strokes = (0..self.strokes().len()).filter_map(|index| {
            let from = scale.to_sheet(*self.stroke(index).first()?);
            let mut segments: Vec<PathSegment> = self
                .course(index)
                .segments()
                .map(|segment| match segment {
                    Segment::Line(_, to) => PathSegment::line(scale.to_sheet(to)),
                    // The picture's y is down.
                    Segment::Arc(arc) => {
                        PathSegment::arc(scale.to_sheet(arc.centre), -arc.sweep_rad, scale.to_sheet(arc.to))
                    }
                    Segment::Cubic(cubic) => {
                        let handles = cubic.handles.map(|at| scale.to_sheet(at));
                        PathSegment::cubic(handles, scale.to_sheet(cubic.to))
                    }
                })
                .collect();
            if segments.is_empty() {
                segments.push(PathSegment::line(from));
            }
            Some(Stroke { pen: self.pen(index), from, segments, ..Stroke::default() })
        });
        drawing::Drawing { strokes: strokes.collect(), ..drawing::Drawing::default() }
    }

    /// What is drawn on the sheet as a drawing on a picture of that size. Arcs and cubic curves stay what
    /// they are; layers, speeds and what happens between strokes are left out.
    #[must_use]
    pub fn of_sheet(sheet: &drawing::Drawing, (width_px, height_px): (u32, u32), scale: Scale) -> Self {
        let mut drawing = Self::new(width_px, height_px);
        for stroke in &sheet.strokes {
            drawing.push_curve(stroke.pen, curve(stroke, |at| scale.to_picture(at), -1.0));
        }
        drawing
    }
}

/// A stroke as a curve, whose places `place` gives; `sense` is −1 where it turns the y axis over.
pub(crate) fn curve(stroke: &Stroke, place: impl Fn(Point) -> PxPoint, sense: f64) -> Curve {
    let mut curve = Curve { vertices: vec![place(stroke.from)], ..Curve::default() };
    if stroke.is_dot() {
        return curve;
    }
    if stroke.segments.iter().all(|segment| segment.shape == Shape::Line) {
        curve.vertices.extend(stroke.segments.iter().map(|segment| place(segment.to)));
        return curve;
    }
    let (mut has_arcs, mut has_cubics) = (false, false);
    let halves = stroke.segments().flat_map(|(from, segment)| halved(from, segment));
    for segment in halves {
        let (mut bulge, mut handles) = (0.0, None);
        match segment.shape {
            Shape::Line => {}
            Shape::Arc { sweep_rad, .. } => {
                bulge = sense * libm::tan(0.25 * sweep_rad);
                has_arcs = true;
            }
            Shape::Cubic { handles: both } => {
                handles = Some(both.map(&place));
                has_cubics = true;
            }
        }
        curve.bulges.push(bulge);
        curve.handles.push(handles);
        curve.vertices.push(place(segment.to));
    }
    if !has_arcs {
        curve.bulges = Vec::new();
    }
    if !has_cubics {
        curve.handles = Vec::new();
    }
    curve
}

/// A segment, but of a whole turn its halves: an arc between two vertices has a chord.
pub(crate) fn halved(from: Point, segment: &PathSegment) -> impl Iterator<Item = PathSegment> + use<> {
    let (first, second) = if is_whole_turn(from, segment) {
        (segment.part(from, 0.0, 0.5), Some(segment.part(from, 0.5, 1.0)))
    } else {
        (*segment, None)
    };
    core::iter::once(first).chain(second)
}

/// Whether a segment is an arc that comes back to where it begins.
pub(crate) fn is_whole_turn(from: Point, segment: &PathSegment) -> bool {
    matches!(segment.shape, Shape::Arc { .. }) && segment.to == from && !segment.is_dot(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_turn_is_a_circle() {
        let from = Point::new(7.0, 4.0);
        let turn = PathSegment::arc(Point::new(4.0, 4.0), core::f64::consts::TAU, from);
        let sheet = drawing::Drawing {
            strokes: vec![Stroke { from, segments: vec![turn], ..Stroke::default() }],
            ..drawing::Drawing::default()
        };
        let drawing = Drawing::of_sheet(&sheet, (10, 10), Scale::new(10, 1.0, Point::ORIGIN).unwrap());
        let (centre, radius_px) = drawing.curve(0).circle().unwrap();
        assert!(centre.distance(PxPoint::new(4.0, 6.0)) < 1e-9 && (radius_px - 3.0).abs() < 1e-9);
    }

    #[test]
    fn there_and_back_is_the_same_drawing() {
        let scale = Scale::new(10, 0.25, Point::new(3.0, 4.0)).unwrap();
        let mut drawing = Drawing::new(20, 10);
        drawing.push([PxPoint::new(0.5, 0.5)]);
        let vertices = vec![
            PxPoint::new(2.0, 2.0),
            PxPoint::new(8.0, 2.0),
            PxPoint::new(8.0, 8.0),
            PxPoint::new(2.0, 9.0),
        ];
        let handles = vec![None, None, Some([PxPoint::new(7.0, 9.0), PxPoint::new(3.0, 9.0)]), None];
        drawing.push_curve(3, Curve { vertices, bulges: vec![0.5, 0.0, 0.0, 0.0], handles });
        let sheet = drawing.on_sheet(scale);
        assert_eq!(sheet.check(), Ok(()));
        let px = 1.0 / scale.mm_per_px();
        let length_px = sheet.length_mm() * px;
        assert!((length_px - drawing.pen_down_px()).abs() < 1e-3, "{length_px} {}", drawing.pen_down_px());
        let back = Drawing::of_sheet(&sheet, (20, 10), scale);
        assert_eq!(back.strokes().len(), 2);
        for index in 0..2 {
            assert_eq!(
                (back.pen(index), back.stroke(index).len()),
                (drawing.pen(index), drawing.stroke(index).len())
            );
            for (one, other) in back.stroke(index).iter().zip(drawing.stroke(index)) {
                assert!(one.distance(*other) < 1e-9);
            }
            for (one, other) in back.bulges(index).iter().zip(drawing.bulges(index)) {
                assert!((one - other).abs() < 1e-9);
            }
        }
        assert_eq!(back.handles(1).len(), 4);
    }
}
