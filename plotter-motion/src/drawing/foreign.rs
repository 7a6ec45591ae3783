//! Types of other crates, behind the features `kurbo` and `mint`.

#[cfg(feature = "kurbo")]
mod of_kurbo {
    use crate::drawing::{Drawing, PathSegment, Shape, Stroke};
    use crate::{Point, Vec2};
    use alloc::vec::Vec;
    use core::f64::consts::FRAC_PI_8;
    use kurbo::{BezPath, PathEl};

    impl From<Point> for kurbo::Point {
        fn from(at: Point) -> Self {
            Self::new(at.x, at.y)
        }
    }

    impl From<kurbo::Point> for Point {
        fn from(at: kurbo::Point) -> Self {
            Self::new(at.x, at.y)
        }
    }

    impl From<Vec2> for kurbo::Vec2 {
        fn from(way: Vec2) -> Self {
            Self::new(way.x, way.y)
        }
    }

    impl From<kurbo::Vec2> for Vec2 {
        fn from(way: kurbo::Vec2) -> Self {
            Self::new(way.x, way.y)
        }
    }

    impl From<&Stroke> for BezPath {
        /// Arcs become cubic curves of an eighth of a turn at most, within 4·10⁻⁶ of their radius; one that
        /// ends where it begins is closed.
        fn from(stroke: &Stroke) -> Self {
            let mut path = Self::new();
            path.move_to(stroke.from);
            for (from, segment) in stroke.segments() {
                match segment.shape {
                    Shape::Line => path.line_to(segment.to),
                    Shape::Cubic { handles: [a, b] } => path.curve_to(a, b, segment.to),
                    Shape::Arc { centre, sweep_rad } => {
                        let count = libm::ceil(libm::fabs(sweep_rad) / (2.0 * FRAC_PI_8)).clamp(1.0, 8.0);
                        let reach = 4.0 / 3.0 * libm::tan(0.25 * sweep_rad / count);
                        let handle =
                            |at: Point, sign: f64| at + (at - centre).perpendicular() * (sign * reach);
                        let mut begin = 0.0;
                        while begin < count {
                            let (here, there) =
                                (segment.at(from, begin / count), segment.at(from, (begin + 1.0) / count));
                            path.curve_to(handle(here, 1.0), handle(there, -1.0), there);
                            begin += 1.0;
                        }
                    }
                }
            }
            if stroke.is_closed() {
                path.close_path();
            }
            path
        }
    }

    impl From<&BezPath> for Drawing {
        /// A stroke for each part of the path; quadratic curves become cubic ones, which they are.
        fn from(path: &BezPath) -> Self {
            let mut drawing = Self::new();
            let (mut start, mut at) = (Point::ORIGIN, Point::ORIGIN);
            let mut segments: Vec<PathSegment> = Vec::new();
            let mut end = |start: Point, segments: &mut Vec<PathSegment>| {
                if !segments.is_empty() {
                    let segments = core::mem::take(segments);
                    drawing.strokes.push(Stroke { from: start, segments, ..Stroke::default() });
                }
            };
            for element in path.elements() {
                match *element {
                    PathEl::MoveTo(to) => {
                        end(start, &mut segments);
                        (start, at) = (to.into(), to.into());
                        continue;
                    }
                    PathEl::LineTo(to) => segments.push(PathSegment::line(to.into())),
                    PathEl::QuadTo(by, to) => {
                        let (by, to): (Point, Point) = (by.into(), to.into());
                        let handles = [at.lerp(by, 2.0 / 3.0), to.lerp(by, 2.0 / 3.0)];
                        segments.push(PathSegment::cubic(handles, to));
                    }
                    PathEl::CurveTo(a, b, to) => {
                        segments.push(PathSegment::cubic([a.into(), b.into()], to.into()));
                    }
                    PathEl::ClosePath => {
                        if at.distance(start) > 0.0 {
                            segments.push(PathSegment::line(start));
                        }
                        end(start, &mut segments);
                        at = start;
                        continue;
                    }
                }
                at = segments.last().map_or(at, |segment| segment.to);
            }
            end(start, &mut segments);
            drawing
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;
        use std::vec;

        #[test]
        fn a_path_of_beziers_and_back() {
            let from = Point::new(1.0, 0.0);
            let quarter = PathSegment::arc(Point::ORIGIN, 4.0 * FRAC_PI_8, Point::new(0.0, 1.0));
            let stroke = Stroke {
                from,
                segments: vec![quarter, PathSegment::line(Point::ORIGIN), PathSegment::line(from)],
                ..Stroke::default()
            };
            let path = BezPath::from(&stroke);
            // A quarter of a circle about the origin: a quarter of π.
            assert!((kurbo::Shape::area(&path) - 2.0 * FRAC_PI_8).abs() < 1e-5);
            let back = Drawing::from(&path);
            assert_eq!((back.strokes.len(), back.strokes[0].is_closed()), (1, true));
            assert!((back.length_mm() - stroke.length_mm()).abs() < 1e-5);
        }

        #[test]
        fn parts_and_quadratic_curves() {
            let path = BezPath::from_svg("M0 0L3 4M10 0Q11 2 12 0Z").unwrap();
            let drawing = Drawing::from(&path);
            assert_eq!(drawing.strokes.len(), 2);
            assert_eq!(
                drawing.strokes[1].segments[0].at(drawing.strokes[1].from, 0.5),
                Point::new(11.0, 1.0)
            );
            assert!(drawing.strokes[1].is_closed());
        }
    }
}

#[cfg(feature = "mint")]
mod of_mint {
    use crate::{Point, Vec2};

    impl From<Point> for mint::Point2<f64> {
        fn from(at: Point) -> Self {
            Self { x: at.x, y: at.y }
        }
    }

    impl From<mint::Point2<f64>> for Point {
        fn from(at: mint::Point2<f64>) -> Self {
            Self::new(at.x, at.y)
        }
    }

    impl From<Vec2> for mint::Vector2<f64> {
        fn from(way: Vec2) -> Self {
            Self { x: way.x, y: way.y }
        }
    }

    impl From<mint::Vector2<f64>> for Vec2 {
        fn from(way: mint::Vector2<f64>) -> Self {
            Self::new(way.x, way.y)
        }
    }
}
