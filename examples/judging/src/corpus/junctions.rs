//! Junctions of a drawing, where strokes cross or meet, computed from their geometry.

use super::strokes::{At, Stroke};

/// Points nearer to each other than this are one, px: ten times what rounding the points can move a crossing
/// of lines that meet at 10 degrees.
const SAME_PX: f64 = 0.05;

/// A straight piece of a stroke.
struct Piece {
    from: At,
    to: At,
    stroke: usize,
    index: usize,
}

/// All points with three or more arms, in the order of rows: x, y, number of arms.
pub(crate) fn of(strokes: &[Stroke]) -> Vec<(f64, f64, u32)> {
    let mut pieces: Vec<Piece> = Vec::new();
    for (stroke, line) in strokes.iter().enumerate() {
        for (index, pair) in line.points.windows(2).enumerate() {
            pieces.push(Piece { from: pair[0], to: pair[1], stroke, index });
        }
    }
    pieces.sort_by(|a, b| left(a).total_cmp(&left(b)));

    let mut meetings: Vec<At> = Vec::new();
    for (place, a) in pieces.iter().enumerate() {
        let right = a.from.0.max(a.to.0) + SAME_PX;
        for b in pieces[place + 1..].iter().take_while(|b| left(b) <= right) {
            // Neighbours on one stroke share a corner, which is no meeting.
            if a.stroke != b.stroke || a.index.abs_diff(b.index) > 1 {
                meeting(a, b, &mut meetings);
            }
        }
    }
    meetings.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.total_cmp(&b.0)));

    let mut found: Vec<(f64, f64, u32)> = Vec::new();
    for at in meetings {
        if found.iter().all(|(x, y, _)| libm::hypot(x - at.0, y - at.1) > 2.0 * SAME_PX) {
            let arms = pieces.iter().map(|piece| arms(piece, at)).sum();
            if arms >= 3 {
                found.push((at.0, at.1, arms));
            }
        }
    }
    found
}

fn left(piece: &Piece) -> f64 {
    piece.from.0.min(piece.to.0)
}

/// Distance from a piece, and the foot point as a share of its length.
fn distance(piece: &Piece, at: At) -> f64 {
    let (dx, dy) = (piece.to.0 - piece.from.0, piece.to.1 - piece.from.1);
    let along = ((at.0 - piece.from.0) * dx + (at.1 - piece.from.1) * dy) / (dx * dx + dy * dy);
    let share = along.clamp(0.0, 1.0);
    libm::hypot(at.0 - piece.from.0 - share * dx, at.1 - piece.from.1 - share * dy)
}

/// How many arms of a piece leave from a point: 2 from its inside, 1 from an end.
fn arms(piece: &Piece, at: At) -> u32 {
    if distance(piece, at) > SAME_PX {
        return 0;
    }
    let leaves = |end: At| u32::from(libm::hypot(end.0 - at.0, end.1 - at.1) > SAME_PX);
    leaves(piece.from) + leaves(piece.to)
}

fn meeting(a: &Piece, b: &Piece, meetings: &mut Vec<At>) {
    let (ux, uy) = (a.to.0 - a.from.0, a.to.1 - a.from.1);
    let (vx, vy) = (b.to.0 - b.from.0, b.to.1 - b.from.1);
    let (wx, wy) = (b.from.0 - a.from.0, b.from.1 - a.from.1);
    let cross = ux * vy - uy * vx;
    // Pieces nearly in line meet in their ends, if at all.
    if libm::fabs(cross) > 0.01 * libm::hypot(ux, uy) * libm::hypot(vx, vy) {
        let (s, t) = ((wx * vy - wy * vx) / cross, (wx * uy - wy * ux) / cross);
        if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
            meetings.push((a.from.0 + s * ux, a.from.1 + s * uy));
            return;
        }
    }
    for (end, other) in [(a.from, b), (a.to, b), (b.from, a), (b.to, a)] {
        if distance(other, end) <= SAME_PX {
            meetings.push(end);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::strokes::{Look, Picture};

    fn junctions(draw: impl Fn(&mut Picture)) -> Vec<(f64, f64, u32)> {
        let mut picture = Picture::new("test", (100, 100), Look::Ink, 3.0);
        draw(&mut picture);
        of(&picture.strokes)
    }

    #[test]
    fn two_lines_that_cross_have_four_arms() {
        let found = junctions(|picture| {
            picture.line(&[(0.0, 0.0), (10.0, 10.0)]);
            picture.line(&[(0.0, 10.0), (10.0, 0.0)]);
        });
        assert_eq!(found, [(5.0, 5.0, 4)]);
    }

    #[test]
    fn a_line_that_ends_on_another_has_three_arms() {
        let found = junctions(|picture| {
            picture.line(&[(0.0, 0.0), (10.0, 0.0)]);
            picture.line(&[(4.0, 0.0), (4.0, 9.0)]);
        });
        assert_eq!(found, [(4.0, 0.0, 3)]);
    }

    #[test]
    fn a_corner_is_no_junction() {
        assert!(junctions(|picture| picture.rectangle((0.0, 0.0), (10.0, 10.0))).is_empty());
        assert!(junctions(|picture| picture.circle((50.0, 50.0), 20.0)).is_empty());
    }

    #[test]
    fn a_star_of_six_rays_is_one_junction() {
        let found =
            junctions(|picture| picture.rays((50.0, 50.0), 30.0, &[0.0, 60.0, 120.0, 180.0, 240.0, 300.0]));
        assert_eq!(found, [(50.0, 50.0, 6)]);
    }

    #[test]
    fn a_line_through_a_circle_crosses_it_twice() {
        let found = junctions(|picture| {
            picture.circle((50.0, 50.0), 20.0);
            picture.line(&[(10.0, 50.5), (90.0, 50.5)]);
        });
        assert_eq!(found.iter().map(|(_, _, arms)| *arms).collect::<Vec<_>>(), [4, 4]);
    }
}
