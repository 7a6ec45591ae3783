//! [`join_gaps`]: strokes that go on in each other beyond a gap become one.

use crate::stroke::{Curve, Drawing, PxPoint, PxVec};

/// A stroke goes on in another when neither turns by more than so much to get there: cos 40° over the widest
/// gap, and the more the narrower it is, up to cos 75°.
const STRAIGHT_ON: f64 = 0.766;
const TURNED: f64 = 0.259;

/// The direction of an end is that from as far along the stroke as this part of the widest gap.
const ALONG: f64 = 0.5;

/// Ends as near as this touch, px: the way from one to the other says nothing of a direction.
const TOUCHING_PX: f64 = 1.5;

/// An end of a stroke.
#[derive(Clone, Copy, Debug)]
struct End {
    /// Twice the stroke's number, and one more for its last vertex.
    number: usize,
    pen: u8,
    at: PxPoint,
    /// The direction in which the stroke goes on there, of length 1.
    on: PxVec,
}

/// Joins strokes of a pen, by straight lines, where one ends no farther than `gap_px` from an end of another
/// and both point at each other; the nearest first. A stroke that meets its own beginning so is closed.
pub(crate) fn join_gaps(drawing: Drawing, gap_px: f64) -> Drawing {
    let mut ends: Vec<End> = Vec::new();
    for (index, stroke) in drawing.strokes().enumerate() {
        let pen = drawing.pen(index);
        if let (Some(first), Some(last)) = (stroke.first(), stroke.last())
            && stroke.len() > 1
            && first != last
        {
            let direction = |at: PxPoint, vertices: &mut dyn Iterator<Item = &PxPoint>| {
                let (mut before, mut left_px) = (at, ALONG * gap_px);
                for vertex in vertices {
                    let step_px = vertex.distance(before);
                    if step_px >= left_px {
                        before = before + (*vertex - before) * (left_px / step_px.max(f64::MIN_POSITIVE));
                        break;
                    }
                    (before, left_px) = (*vertex, left_px - step_px);
                }
                let way = at - before;
                let length = way.length();
                (length > 0.0).then(|| way * (1.0 / length))
            };
            let start = direction(*first, &mut stroke.iter().skip(1));
            let end = direction(*last, &mut stroke.iter().rev().skip(1));
            ends.extend(start.map(|on| End { number: 2 * index, pen, at: *first, on }));
            ends.extend(end.map(|on| End { number: 2 * index + 1, pen, at: *last, on }));
        }
    }
    ends.sort_by(|one, other| one.at.x.total_cmp(&other.at.x).then(one.number.cmp(&other.number)));
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (index, one) in ends.iter().enumerate() {
        for other in ends.iter().skip(index + 1).take_while(|other| other.at.x - one.at.x <= gap_px) {
            let way = other.at - one.at;
            let far_px = way.length();
            let are_close = far_px <= gap_px && one.pen == other.pen;
            let point_at_each_other = if far_px < TOUCHING_PX {
                -one.on.dot(other.on) >= STRAIGHT_ON
            } else {
                let least = TURNED + (STRAIGHT_ON - TURNED) * far_px / gap_px;
                one.on.dot(way) >= least * far_px && -other.on.dot(way) >= least * far_px
            };
            if are_close && point_at_each_other {
                pairs.push((far_px, one.number, other.number));
            }
        }
    }
    pairs.sort_by(|one, other| one.0.total_cmp(&other.0).then((one.1, one.2).cmp(&(other.1, other.2))));
    let mut beyond: Vec<Option<usize>> = vec![None; 2 * drawing.strokes().len()];
    for (_, one, other) in pairs {
        if beyond.get(one) == Some(&None) && beyond.get(other) == Some(&None) {
            for (from, to) in [(one, other), (other, one)] {
                if let Some(slot) = beyond.get_mut(from) {
                    *slot = Some(to);
                }
            }
        }
    }
    if beyond.iter().all(Option::is_none) {
        return drawing;
    }
    chained(&drawing, &beyond)
}

/// Strokes in chains, given what lies beyond each end.
fn chained(drawing: &Drawing, beyond: &[Option<usize>]) -> Drawing {
    let strokes = drawing.strokes().len();
    let next_of = |end: usize| beyond.get(end).copied().flatten();
    let mut out = Drawing::new(drawing.width_px(), drawing.height_px());
    let mut is_done = vec![false; strokes];
    for index in 0..strokes {
        if is_done.get(index) != Some(&false) {
            continue;
        }
        // Back to where the chain begins, or once around.
        let mut start = 2 * index;
        let mut closed = false;
        while let Some(end) = next_of(start) {
            start = end ^ 1;
            if start == 2 * index {
                closed = true;
                break;
            }
        }
        let mut curve: Option<Curve> = None;
        let mut at = start;
        loop {
            if let Some(done) = is_done.get_mut(at / 2) {
                *done = true;
            }
            let mut next = drawing.curve(at / 2);
            if at % 2 == 1 {
                next.reverse();
            }
            match &mut curve {
                Some(curve) => curve.append(next),
                none => *none = Some(next),
            }
            match next_of(at ^ 1) {
                Some(next) if next != start => at = next,
                _ => break,
            }
        }
        if let Some(mut curve) = curve {
            if closed && let Some(first) = curve.vertices.first().copied() {
                curve.append(vec![first].into());
            }
            out.push_curve(drawing.pen(index), curve);
        }
    }
    out
}

/// The drawing without the strokes that are shorter than `least_px`.
pub(crate) fn without_short(drawing: Drawing, least_px: f64) -> Drawing {
    let mut out = Drawing::new(drawing.width_px(), drawing.height_px());
    for index in 0..drawing.strokes().len() {
        let curve = drawing.curve(index);
        if curve.length_px() >= least_px {
            out.push_curve(drawing.pen(index), curve);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing(strokes: &[&[(f64, f64)]]) -> Drawing {
        let mut drawing = Drawing::new(100, 100);
        for stroke in strokes {
            drawing.push(stroke.iter().map(|(x, y)| PxPoint::new(*x, *y)));
        }
        drawing
    }

    #[test]
    fn dashes_on_a_line_become_one_and_a_line_beside_stays() {
        let dashes = drawing(&[
            &[(0.0, 0.0), (10.0, 0.0)],
            &[(24.0, 1.0), (14.0, 0.0)],
            &[(27.0, 1.0), (40.0, 1.0)],
            &[(12.0, 5.0), (20.0, 30.0)],
        ]);
        let joined = join_gaps(dashes.clone(), 5.0);
        assert_eq!(joined.strokes().len(), 2);
        let line: Vec<f64> = joined.stroke(0).iter().map(|vertex| vertex.x).collect();
        assert_eq!(line, [0.0, 10.0, 14.0, 24.0, 27.0, 40.0]);
        assert_eq!(join_gaps(dashes.clone(), 2.0), dashes);
    }

    #[test]
    fn a_ring_with_a_gap_is_closed_and_one_of_two_pieces_is_one() {
        let ring: &[(f64, f64)] =
            &[(5.0, 0.0), (20.0, 0.0), (20.0, 20.0), (-10.0, 20.0), (-10.0, 0.0), (2.0, 0.0)];
        let closed = join_gaps(drawing(&[ring]), 4.0);
        assert_eq!(closed.stroke(0).first(), closed.stroke(0).last());
        let halves: &[&[(f64, f64)]] = &[
            &[(5.0, 0.0), (20.0, 0.0), (20.0, 10.0)],
            &[(20.0, 12.0), (20.0, 20.0), (-10.0, 20.0), (-10.0, 0.0), (2.0, 0.0)],
        ];
        let closed = join_gaps(drawing(halves), 4.0);
        assert_eq!(closed.strokes().len(), 1);
        assert_eq!(closed.stroke(0).first(), closed.stroke(0).last());
    }

    #[test]
    fn short_strokes_are_left_out() {
        let kept = without_short(drawing(&[&[(0.0, 0.0), (1.0, 0.0)], &[(0.0, 0.0), (9.0, 0.0)]]), 2.0);
        assert_eq!(kept.strokes().len(), 1);
    }
}
