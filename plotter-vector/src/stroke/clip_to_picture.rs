//! [`within`]: a stroke kept on its picture.
//!
//! Ink never lies outside of the picture, but what is drawn of it may: a junction where arms meet that were
//! continued beyond the border, a line smoothed or simplified as its tolerance allows, an arc that bulges.
//! Each point of such a stroke goes to the nearest one of the picture.
//!
//! ```text
//!             V            V is outside: the line through it goes along the border instead, from a over v to b. Whatever
//!            / \           lies inside is no farther from its nearest place on the picture than from the place itself,
//!   ────────a─v─b───────   for the picture is convex: promised distances hold.
//!          /     \
//! ```

use crate::stroke::curve::{CHORD_ERROR_PX, Segment};
use crate::stroke::{Arc, Cubic, Curve, PxPoint, PxVec};

/// What arcs and cubic curves may bulge over the border, px: they are no more exact.
const ROUNDING_PX: f64 = 1e-6;

/// A stroke each point of which is within a picture of this size, px: of what leaves it the nearest point on
/// the border. Vertices are exactly within, arcs and curves but for rounding: one that bulges over the border
/// gives way to its chords. The handles of a curve may lie outside, as long as the curve does not.
pub(crate) fn within(stroke: Curve, width_px: u32, height_px: u32) -> Curve {
    let border = Border { x: width_px.into(), y: height_px.into() };
    if border.has_all(&stroke.vertices) && stroke.course().segments().all(|segment| border.has(&segment)) {
        return stroke;
    }
    let Some(first) = stroke.vertices.first() else { return stroke };
    let mut kept = Curve::from(vec![border.nearest(*first)]);
    let segments = stroke.course().segments().zip(&stroke.vertices).enumerate();
    for (index, (segment, from)) in segments {
        if border.has(&segment) {
            // Its ends are moved by a rounding at most.
            kept.append(Curve {
                vertices: [*from, segment.to()].map(|at| border.nearest(at)).to_vec(),
                bulges: stroke.bulges.get(index).copied().into_iter().collect(),
                handles: stroke.handles.get(index).copied().into_iter().collect(),
            });
            continue;
        }
        let mut from = *from;
        for to in segment.chords(CHORD_ERROR_PX) {
            let mut places = vec![border.nearest(from)];
            places.extend(border.crossings(from, to).into_iter().map(|at| border.nearest(at)));
            places.push(border.nearest(to));
            places.dedup();
            kept.append(places.into());
            from = to;
        }
    }
    kept
}

/// The border of a picture: two sides on the axes, the others at these places.
#[derive(Clone, Copy)]
struct Border {
    x: f64,
    y: f64,
}

impl Border {
    /// The nearest place within it.
    fn nearest(&self, at: PxPoint) -> PxPoint {
        PxPoint::new(at.x.clamp(0.0, self.x), at.y.clamp(0.0, self.y))
    }

    fn has_all(&self, places: &[PxPoint]) -> bool {
        places.iter().all(|at| self.nearest(*at) == *at)
    }

    /// Whether a segment does not bulge over it; of one whose ends are within, whether it is within.
    fn has(&self, segment: &Segment) -> bool {
        let nearly = |at: PxPoint| self.nearest(at).distance(at) <= ROUNDING_PX;
        match segment {
            Segment::Line(from, to) => nearly(*from) && nearly(*to),
            Segment::Arc(arc) => nearly(arc.from) && nearly(arc.to) && outermost(arc).all(nearly),
            Segment::Cubic(cubic) => {
                let ends = [cubic.from, cubic.to];
                // It lies between its ends and handles.
                ends.into_iter().all(nearly)
                    && (cubic.handles.into_iter().all(nearly)
                        || turns(cubic).map(|t| cubic.at(t)).all(nearly))
            }
        }
    }

    /// Where a line comes to one of the four straight lines that the border lies on, in order.
    fn crossings(&self, from: PxPoint, to: PxPoint) -> Vec<PxPoint> {
        let way = to - from;
        let sides = [
            (0.0 - from.x, way.x),
            (self.x - from.x, way.x),
            (0.0 - from.y, way.y),
            (self.y - from.y, way.y),
        ];
        let mut parts: Vec<f64> = sides.into_iter().map(|(to_side, way)| to_side / way).collect();
        parts.retain(|part| *part > 0.0 && *part < 1.0);
        parts.sort_unstable_by(f64::total_cmp);
        parts.into_iter().map(|part| from + way * part).collect()
    }
}

/// The places of an arc farthest to one side, but for its ends.
fn outermost(arc: &Arc) -> impl Iterator<Item = PxPoint> + '_ {
    PxVec::AXES
        .into_iter()
        .map(|side| arc.centre + side * arc.radius_px)
        .filter(|at| arc.distance(*at) <= ROUNDING_PX)
}

/// Where on its way, 0 to 1, a cubic curve goes no farther to one side: its speed is 3 (s² u + 2 s t v + t²
/// w) with s = 1 − t.
fn turns(cubic: &Cubic) -> impl Iterator<Item = f64> {
    let [b, c] = cubic.handles;
    let (u, v, w) = (b - cubic.from, c - b, cubic.to - c);
    let along = |u: f64, v: f64, w: f64| {
        let (square, half, whole) = (u - 2.0 * v + w, v - u, u);
        let root = libm::sqrt(half * half - square * whole);
        // Of the two forms the one that does not take a number from one like it; what there is none of is no
        // number.
        let sum = if half < 0.0 { half - root } else { half + root };
        [-sum / square, -whole / sum]
    };
    let all = [along(u.x, v.x, w.x), along(u.y, v.y, w.y)];
    all.into_iter().flatten().filter(|t| *t > 0.0 && *t < 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64) -> PxPoint {
        PxPoint::new(x, y)
    }

    fn line(places: &[(f64, f64)]) -> Curve {
        places.iter().map(|(x, y)| at(*x, *y)).collect::<Vec<_>>().into()
    }

    #[test]
    fn a_corner_beyond_the_border_becomes_a_piece_of_the_border() {
        let kept = within(line(&[(2.0, 4.0), (6.0, -4.0), (10.0, 4.0)]), 20, 10);
        assert_eq!(kept, line(&[(2.0, 4.0), (4.0, 0.0), (6.0, 0.0), (8.0, 0.0), (10.0, 4.0)]));
    }

    #[test]
    fn a_line_around_a_corner_of_the_picture_goes_through_it() {
        let kept = within(line(&[(-2.0, 4.0), (4.0, -2.0), (4.0, 3.0)]), 20, 10);
        assert_eq!(kept.vertices.first(), Some(&at(0.0, 4.0)));
        // Here it crosses the picture's corner; farther out it would run along both sides.
        assert_eq!(kept, line(&[(0.0, 4.0), (0.0, 2.0), (2.0, 0.0), (4.0, 0.0), (4.0, 3.0)]));
        let out = within(line(&[(-4.0, 2.0), (2.0, -4.0)]), 20, 10);
        assert_eq!(out, line(&[(0.0, 2.0), (0.0, 0.0), (2.0, 0.0)]));
    }

    #[test]
    fn what_is_within_stays_as_it_is() {
        let inside = line(&[(0.0, 0.0), (20.0, 10.0), (0.0, 10.0), (0.0, 0.0)]);
        assert_eq!(within(inside.clone(), 20, 10), inside);
        let round = Curve { bulges: vec![1.0, 1.0, 0.0], ..line(&[(5.0, 5.0), (15.0, 5.0), (5.0, 5.0)]) };
        assert_eq!(within(round.clone(), 20, 10), round);
        // A flat arch whose handles are outside.
        let handles = vec![Some([at(4.0, -0.3), at(8.0, -0.3)]), None];
        let arch = Curve { handles, ..line(&[(2.0, 1.0), (10.0, 1.0)]) };
        assert_eq!(within(arch.clone(), 20, 10), arch);
    }

    #[test]
    fn a_dot_and_a_line_outside_are_put_on_the_border() {
        assert_eq!(within(line(&[(-1.0, 3.0)]), 20, 10), line(&[(0.0, 3.0)]));
        assert_eq!(within(line(&[(-3.0, 3.0), (-1.0, 3.0)]), 20, 10), line(&[(0.0, 3.0)]));
    }

    #[test]
    fn an_arc_and_a_curve_over_the_border_give_way_to_chords() {
        let lowest = |curve: &Curve| curve.chords(1e-3).iter().map(|at| at.y).fold(f64::INFINITY, f64::min);
        let arc = Curve {
            bulges: vec![1.0, 0.0, 0.3],
            ..line(&[(2.0, 3.0), (10.0, 3.0), (10.0, 8.0), (2.0, 8.0)])
        };
        let handles = vec![Some([at(2.0, -4.0), at(10.0, -4.0)])];
        let cubic = Curve { handles, ..line(&[(2.0, 3.0), (10.0, 3.0)]) };
        assert!(lowest(&arc) < -0.9 && lowest(&cubic) < -0.9);
        for over in [arc.clone(), cubic] {
            let kept = within(over.clone(), 20, 10);
            assert_eq!((lowest(&kept), kept.vertices.first()), (0.0, over.vertices.first()));
            // Nothing in the picture is farther from it.
            for place in (0..=20).flat_map(|x| (0..=10).map(move |y| at(x.into(), y.into()))) {
                let off = |curve: &Curve| {
                    curve
                        .chords(1e-3)
                        .iter()
                        .map(|vertex| vertex.distance(place))
                        .fold(f64::INFINITY, f64::min)
                };
                assert!(off(&kept) <= off(&over) + 2.0 * CHORD_ERROR_PX + 0.5, "{place:?}");
            }
        }
        // The other arc of the stroke is still one.
        let kept = within(arc, 20, 10);
        assert_eq!(kept.bulges.iter().filter(|bulge| **bulge != 0.0).count(), 1);
    }
}
