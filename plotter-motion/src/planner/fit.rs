//! [`Fitter`]: lines and arcs through vertices that are known only within an allowance.
//!
//! ```text
//!        o   ·  o          o vertices, each rounded to the last digit of a file
//!     o ────────── o       ─ one arc that passes all of them within the allowance
//!   ·      o         ·
//! ```
//!
//! A file rounds each vertex to its last digit. On short lines this turns the directions far more than the
//! meant curve does, so a machine that obeys every vertex brakes for noise. A path that passes each vertex
//! within the allowance says the same as the file.
//!
//! A piece begins at a given place. A circle through that place has two parameters: its slope t there,
//! against a chosen direction, and its curvature k. If (x, y) is a vertex in that frame and r its distance,
//! the circle passes it at about
//!
//! ```text
//! y − t x − k r²/2
//! ```
//!
//! which is linear in t and k and exact where it is 0. Each vertex thus allows a strip of the (t, k) plane,
//! and all vertices together a convex polygon. As long as the polygon is not empty, one arc is enough for any
//! number of vertices. This is the method of J. O'Rourke, "An on-line algorithm for fitting straight lines
//! between data ranges" (1981), with circles through a point in the place of lines.
//!
//! The arc that reaches farthest has used up the allowance at its end, and the next arc would begin badly. So
//! the arc ends some vertices earlier, where it passes in the middle of them, and the next arc gets these
//! vertices. A vertex far from the arc is a corner of the drawing: there the piece ends at the vertex itself.

use crate::Vec2;
use crate::extremes::{greatest, least};
use crate::geom::{Vec2Single, single};

/// Vertices before the end of an arc that the next arc gets. Measured: with 4 the seeded curves of the tests
/// take at most 2 % longer than with 16.
const GIVEN_BACK: usize = 4;
/// Most corners of the polygon. If there are more, one is dropped; the rest is a part of the polygon, so the
/// arcs stay within the allowance. It bounds memory and time.
const CORNERS: usize = 8;
/// Greatest slope at the start: 76°. An allowance turns a chord of its own length by less.
const MOST_SLOPE: f32 = 4.0;
/// Greatest curvature, as a share of 1 / allowance. Narrower arcs, with a radius below 8 allowances, are
/// corners of the drawing.
const MOST_CURVATURE: f32 = 0.125;
/// Vertices nearer to the start than this share of the allowance are passed by the start itself.
const NEAR_SHARE: f32 = 0.5;
/// Share of the allowance by which vertices may go back along the path. [`ACROSS_SHARE`] is what that leaves
/// for the distance across: √(1 − (1/8)²), less some hundredths for rounding, for arcs that are a little
/// longer than the chords they are measured by, and for [`FLAT_SHARE`].
const BACK_SHARE: f32 = 0.125;
const ACROSS_SHARE: f32 = 0.96;
/// An arc nearer to a chord than this share of the allowance is not checked at the beginning of the chord.
const FLAT_SHARE: f32 = 0.02;
/// A vertex farther from the arc than this many allowances does not belong to it. Arc, vertex and the vertex
/// at the end of the arc may each be off by one allowance, which makes 3.
const CORNER_SHARE: f32 = 3.0;
/// Longest piece of more than one line, in allowances: 2¹⁶. Up to there `f32` holds its vertices to a
/// hundredth of the allowance.
const LONGEST: f32 = 65_536.0;
/// As a share of the allowance: an arc that bends less is a line, and an end nearer to a vertex is that
/// vertex.
const ROUNDING_SHARE: f64 = 1.0 / 256.0;

/// A circle through the start: its slope there, and its curvature, 1/mm; above 0 it turns counter-clockwise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Circle {
    slope: f32,
    curvature: f32,
}

impl Circle {
    /// The direction in which it passes a place that is on it.
    fn tangent_at(self, x: f32, y: f32) -> Vec2Single {
        Vec2Single { x: 1.0 - self.curvature * y, y: self.slope + self.curvature * x }
    }
}

/// The circles with `slope · t + curvature · k ≤ most`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HalfPlane {
    slope: f32,
    curvature: f32,
    most: f32,
}

impl HalfPlane {
    /// By how much a circle is outside; below 0 inside.
    fn outside(&self, circle: Circle) -> f32 {
        self.slope * circle.slope + self.curvature * circle.curvature - self.most
    }

    /// Where the way from one circle to another, on the other side, meets the edge.
    fn between(from: (Circle, f32), to: (Circle, f32)) -> Circle {
        let share = from.1 / (from.1 - to.1);
        Circle {
            slope: from.0.slope + share * (to.0.slope - from.0.slope),
            curvature: from.0.curvature + share * (to.0.curvature - from.0.curvature),
        }
    }
}

/// A convex polygon of circles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Polygon {
    corners: [Circle; CORNERS],
    count: u8,
}

impl Polygon {
    fn whole(allowance_mm: f32) -> Self {
        let (slope, curvature) = (MOST_SLOPE, MOST_CURVATURE / allowance_mm);
        let mut whole = Self::default();
        for (slope, curvature) in
            [(-slope, -curvature), (slope, -curvature), (slope, curvature), (-slope, curvature)]
        {
            whole.add(Circle { slope, curvature });
        }
        whole
    }

    /// Nothing but straight on.
    fn straight() -> Self {
        let mut straight = Self::default();
        straight.add(Circle::default());
        straight
    }

    fn add(&mut self, corner: Circle) {
        if let Some(slot) = self.corners.get_mut(usize::from(self.count)) {
            *slot = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[Circle] {
        self.corners.get(..usize::from(self.count)).unwrap_or_default()
    }

    /// What is left of it (I. E. Sutherland, G. W. Hodgman 1974).
    fn cut(&self, plane: HalfPlane) -> Self {
        let mut left = Self::default();
        let Some(&last) = self.corners().last() else { return left };
        let mut before = (last, plane.outside(last));
        for &corner in self.corners() {
            let now = (corner, plane.outside(corner));
            if (before.1 < 0.0 && now.1 > 0.0) || (before.1 > 0.0 && now.1 < 0.0) {
                left.add(HalfPlane::between(before, now));
            }
            if now.1 <= 0.0 {
                left.add(corner);
            }
            before = now;
        }
        left
    }

    /// Where the edge of a half-plane enters and leaves it.
    fn across(&self, edge: HalfPlane) -> Option<(Circle, Circle)> {
        let mut before = self.corners().last().map(|&last| (last, edge.outside(last)))?;
        let mut found: Option<(Circle, Circle)> = None;
        for &corner in self.corners() {
            let now = (corner, edge.outside(corner));
            if before.1 != now.1 && (before.1 <= 0.0) != (now.1 <= 0.0) {
                let at = HalfPlane::between(before, now);
                found = Some(found.map_or((at, at), |(first, _)| (first, at)));
            }
            before = now;
        }
        found
    }

    /// The circles that pass a vertex, and its chord from the one before, within the allowance.
    fn passing(&self, vertex: Vertex) -> Self {
        let Vertex { x, y, half_square, bulge, room_mm } = vertex;
        let planes = [
            HalfPlane { slope: x, curvature: half_square + bulge, most: room_mm + y },
            HalfPlane { slope: x, curvature: half_square - bulge, most: room_mm + y },
            HalfPlane { slope: -x, curvature: bulge - half_square, most: room_mm - y },
            HalfPlane { slope: -x, curvature: -bulge - half_square, most: room_mm - y },
        ];
        // It lies ahead: a circle also passes what is behind its start, the other way round.
        let ahead = HalfPlane { slope: -y, curvature: 0.0, most: x };
        planes.into_iter().chain([ahead]).fold(*self, Self::within)
    }

    /// Those of at most this curvature.
    fn bent_at_most(&self, curvature: f32) -> Self {
        let planes = [1.0, -1.0].map(|side| HalfPlane { slope: 0.0, curvature: side, most: curvature });
        planes.into_iter().fold(*self, Self::within)
    }

    fn within(self, plane: HalfPlane) -> Self {
        if self.corners().iter().any(|corner| plane.outside(*corner) > 0.0) { self.cut(plane) } else { self }
    }

    fn most_curvature(&self) -> f32 {
        self.corners().iter().fold(0.0, |most, corner| greatest(most, corner.curvature.abs()))
    }

    /// One in the middle: straight if there is such a one.
    fn middle(&self) -> Circle {
        let straight = HalfPlane { slope: 0.0, curvature: 1.0, most: 0.0 };
        if let Some((one, other)) = self.across(straight) {
            return Circle { slope: 0.5 * (one.slope + other.slope), curvature: 0.0 };
        }
        let mut sum = Circle::default();
        for corner in self.corners() {
            sum.slope += corner.slope;
            sum.curvature += corner.curvature;
        }
        let share = 1.0 / f32::from(self.count.max(1));
        Circle { slope: sum.slope * share, curvature: sum.curvature * share }
    }

    /// One that passes through a place itself, if there is one.
    fn through(&self, x: f32, y: f32, half_square: f32) -> Option<Circle> {
        let (one, other) = self.across(HalfPlane { slope: x, curvature: half_square, most: y })?;
        let lowest = least(one.curvature, other.curvature);
        if lowest <= 0.0 && greatest(one.curvature, other.curvature) >= 0.0 && x > 0.0 {
            return Some(Circle { slope: y / x, curvature: 0.0 });
        }
        Some(Circle {
            slope: 0.5 * (one.slope + other.slope),
            curvature: 0.5 * (one.curvature + other.curvature),
        })
    }
}

/// A vertex, in the form that cuts a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Vertex {
    x: f32,
    y: f32,
    /// Half the square of its distance from the start, mm².
    half_square: f32,
    /// At a curvature of 1: the distance of the arc from its chord, and by how much the linear distance is
    /// too small.
    bulge: f32,
    room_mm: f32,
}

/// A line or an arc from the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// To its end, mm.
    pub(super) way: Vec2,
    /// Directions at its ends, of length 1.
    pub(super) entry: Vec2,
    pub(super) exit: Vec2,
    /// Its turn, rad; 0 on a line.
    pub(super) sweep_rad: f64,
    /// Vector from the start to the centre, and its length, mm.
    pub(super) to_centre: Vec2,
    pub(super) radius_mm: f64,
    pub(super) length_mm: f64,
    /// Whether it ends exactly at the requested vertex.
    pub(super) at_vertex: bool,
}

/// Finds how far one arc reaches. All vectors begin at the start of the piece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Fitter {
    /// Vertices of the piece.
    count: u16,
    /// Square of the greatest speed on it, mm²/s².
    cruise2: f32,
    /// Direction that slopes are measured against; none until a vertex lies so far from the start that the
    /// start does not pass it.
    along: Option<Vec2Single>,
    circles: Polygon,
    /// The vertex that lies farthest along, and the greatest distance of a vertex, mm.
    farthest: Vec2Single,
    farthest_mm: f32,
    /// The last vertices, the newest last, and the vertex before them.
    last: [Vec2Single; GIVEN_BACK + 1],
}

impl Fitter {
    pub(super) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Square of the greatest speed on the vertices taken so far, mm²/s².
    pub(super) const fn cruise2(&self) -> f32 {
        self.cruise2
    }

    /// Whether the vertices taken so far were asked for at another speed.
    pub(super) fn is_other(&self, cruise2: f32) -> bool {
        self.count > 0 && self.cruise2.total_cmp(&cruise2).is_ne()
    }

    /// Takes the next vertex if one arc is enough with it. The first vertex is always taken.
    pub(super) fn take(&mut self, way: Vec2Single, cruise2: f32, allowance_mm: f32) -> bool {
        let distance_mm = way.length_near();
        let Some(circles) = self.with(way, distance_mm, allowance_mm) else { return false };
        self.circles = circles;
        self.cruise2 = cruise2;
        self.add(way, distance_mm);
        true
    }

    /// The circles that are left with another vertex; `None` if there are none.
    fn with(&mut self, way: Vec2Single, distance_mm: f32, allowance_mm: f32) -> Option<Polygon> {
        let near_mm = NEAR_SHARE * allowance_mm;
        let is_free = self.farthest_mm <= near_mm;
        if !is_free
            && (distance_mm < self.farthest_mm - BACK_SHARE * allowance_mm
                || distance_mm > LONGEST * allowance_mm)
        {
            return None;
        }
        if distance_mm <= near_mm {
            return Some(self.circles);
        }
        let (before, room_mm) = (self.newest(), ACROSS_SHARE * allowance_mm);
        let chord = way.plus(before.times(-1.0));
        // The sagitta of a chord c is c² k / 8.
        let sagitta = 0.125 * chord.dot(chord);
        let passing = |along: Vec2Single, circles: &Polygon| {
            // Inside of a circle the distance d differs from the linear one by d² k / 2.
            let bulge = sagitta + 0.5 * allowance_mm * allowance_mm;
            let vertex = |way: Vec2Single| Vertex {
                x: along.dot(way),
                y: along.cross(way),
                half_square: 0.5 * way.dot(way),
                bulge,
                room_mm,
            };
            let left = circles.passing(vertex(way));
            if is_free {
                // The chord begins beside the start.
                left.bent_at_most(greatest(room_mm - before.length_near(), 0.0) / sagitta)
            } else if sagitta * left.most_curvature() > FLAT_SHARE * room_mm {
                left.passing(vertex(before))
            } else {
                left
            }
        };
        if let Some(along) = self.along {
            let left = passing(along, &self.circles);
            // After a turn, a vertex may lie farther from the start without lying farther along.
            let ahead = left.middle().tangent_at(along.dot(way), along.cross(way));
            let step = way.plus(self.farthest.times(-1.0));
            let step_mm = ahead.dot(Vec2Single { x: along.dot(step), y: along.cross(step) });
            let goes_back = step_mm < -BACK_SHARE * allowance_mm * ahead.length_near();
            if left.count > 0 && (is_free || !goes_back) {
                return Some(left);
            }
            if !is_free {
                return None;
            }
        }
        // Only the start binds it: it may go there in a straight line.
        let along = way.times(1.0 / distance_mm);
        self.along = Some(along);
        let left = passing(along, &Polygon::whole(allowance_mm));
        Some(if left.count > 0 { left } else { Polygon::straight() })
    }

    fn newest(&self) -> Vec2Single {
        self.last.last().copied().unwrap_or_default()
    }

    fn add(&mut self, way: Vec2Single, distance_mm: f32) {
        self.count = self.count.saturating_add(1);
        if distance_mm >= self.farthest_mm {
            (self.farthest, self.farthest_mm) = (way, distance_mm);
        }
        self.last.rotate_left(1);
        if let Some(newest) = self.last.last_mut() {
            *newest = way;
        }
    }

    /// The vertex `beyond` was not taken. Ends the piece some vertices earlier, if the next piece goes on as
    /// smoothly, and begins the next piece with them. `None` at a corner of the drawing.
    pub(super) fn shorten(&mut self, beyond: Vec2Single, allowance_mm: f32) -> Option<Piece> {
        let along = self.along?;
        let circle = self.circles.middle();
        let (x, y) = (along.dot(beyond), along.cross(beyond));
        let miss_mm = y - circle.slope * x - 0.5 * circle.curvature * beyond.dot(beyond);
        let corner_mm = CORNER_SHARE * allowance_mm;
        let goes_back = beyond.length_near() < self.farthest_mm;
        if goes_back || miss_mm * miss_mm > corner_mm * corner_mm * (1.0 + circle.slope * circle.slope) {
            return None;
        }
        let given_back = usize::from(self.count / 2).min(GIVEN_BACK);
        let end = *self.last.get(GIVEN_BACK - given_back)?;
        if given_back == 0 || end.length_near() <= allowance_mm {
            return None;
        }
        let piece = Piece::new(along, circle, end, allowance_mm);
        let way = Vec2Single { x: single(piece.way.x), y: single(piece.way.y) };
        let moved = self.last.map(|vertex| vertex.plus(way.times(-1.0)));
        let mut next = Self {
            along: Some(Vec2Single { x: single(piece.exit.x), y: single(piece.exit.y) }),
            circles: Polygon::whole(allowance_mm),
            ..Self::default()
        };
        let mut given = moved.into_iter().skip(GIVEN_BACK - given_back);
        if let (Some(end), Some(newest)) = (given.next(), next.last.last_mut()) {
            *newest = end;
        }
        // The previous arc passes these vertices, and goes on from here unchanged: a misfit is rounding.
        if !given.all(|vertex| next.take(vertex, self.cruise2, allowance_mm)) {
            return None;
        }
        *self = next;
        Some(piece)
    }

    /// If no arc ends at the last vertex: ends the piece some vertices earlier, so that an arc of the next
    /// piece does. Gives the square of its greatest speed, too.
    pub(super) fn shorten_to_end(&mut self, allowance_mm: f32) -> Option<(Piece, f32)> {
        let (along, end, cruise2) = (self.along?, self.newest(), self.cruise2);
        let half_square = 0.5 * end.dot(end);
        if self.circles.through(along.dot(end), along.cross(end), half_square).is_some() {
            return None;
        }
        self.shorten(end, allowance_mm).map(|piece| (piece, cruise2))
    }

    /// Ends the piece at its last vertex and starts the next one there.
    pub(super) fn end(&mut self, allowance_mm: f32) -> Option<Piece> {
        let Self { count, along, circles, .. } = *self;
        let end = self.newest();
        *self = Self::default();
        let along = along.filter(|_| count > 1)?;
        let half_square = 0.5 * end.dot(end);
        let circle = circles
            .through(along.dot(end), along.cross(end), half_square)
            .unwrap_or_else(|| circles.middle());
        let piece = Piece::new(along, circle, end, allowance_mm);
        if let Some(newest) = self.last.last_mut().filter(|_| !piece.at_vertex) {
            // The drawing goes on beside the start.
            *newest = Vec2Single { x: end.x - single(piece.way.x), y: end.y - single(piece.way.y) };
        }
        Some(piece)
    }
}

impl Piece {
    /// Along a circle to the place that is nearest to a vertex.
    fn new(along: Vec2Single, circle: Circle, vertex: Vec2Single, allowance_mm: f32) -> Self {
        let wide = |way: Vec2Single| Vec2::new(f64::from(way.x), f64::from(way.y));
        let [slope, curvature, allowance_mm] = [circle.slope, circle.curvature, allowance_mm].map(f64::from);
        let tangent = wide(along) + wide(along).perpendicular() * slope;
        let steep = tangent.length();
        let entry = tangent * (1.0 / steep);
        let curvature = curvature / steep;
        let vertex = wide(vertex);
        let (x, y) = (entry.dot(vertex), entry.cross(vertex));
        let near_mm = ROUNDING_SHARE * allowance_mm;
        if 0.125 * curvature.abs() * vertex.length_squared() <= near_mm {
            let at_vertex = y.abs() <= near_mm;
            let way = if at_vertex { vertex } else { entry * x };
            return Self {
                way,
                entry,
                exit: entry,
                sweep_rad: 0.0,
                to_centre: Vec2::default(),
                radius_mm: f64::INFINITY,
                length_mm: x,
                at_vertex,
            };
        }
        // The ray from the centre, 1/k to the side, through the vertex, which is ahead.
        let (sin, cos) = (curvature * x.max(0.0), 1.0 - curvature * y);
        let share = 1.0 / libm::sqrt(sin * sin + cos * cos);
        let (sin, cos) = (sin * share, cos * share);
        let radius_mm = 1.0 / curvature;
        let side = entry.perpendicular();
        // 1 − cos = sin² / (1 + cos), without the cancellation; past a quarter turn there is none.
        let rest = if cos > 0.0 { sin * sin / (1.0 + cos) } else { 1.0 - cos };
        let way = entry * (sin * radius_mm) + side * (rest * radius_mm);
        let sweep_rad = libm::atan2(sin, cos);
        Self {
            way,
            entry,
            exit: entry * cos + side * sin,
            sweep_rad,
            to_centre: side * radius_mm,
            radius_mm: radius_mm.abs(),
            length_mm: sweep_rad * radius_mm,
            at_vertex: (vertex - way).length() <= near_mm,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALLOWANCE_MM: f32 = 0.01;

    fn at(x: f64, y: f64) -> Vec2Single {
        Vec2Single { x: single(x), y: single(y) }
    }

    #[test]
    fn vertices_of_a_circle_are_one_arc_and_its_radius() {
        let mut fitter = Fitter::default();
        // Quarter of a circle of radius 5 mm about (0, 5), with 0.004 mm of noise to and fro.
        for index in 1..=60_i32 {
            let angle_rad = 0.025 * f64::from(index);
            let radius_mm = 5.0 + 0.004 * f64::from(index % 3 - 1);
            let way = at(radius_mm * libm::sin(angle_rad), 5.0 - radius_mm * libm::cos(angle_rad));
            assert!(fitter.take(way, 1.0, ALLOWANCE_MM), "{index}");
        }
        let piece = fitter.end(ALLOWANCE_MM).unwrap();
        assert!((piece.radius_mm - 5.0).abs() < 0.05, "{piece:?}");
        assert!((piece.sweep_rad - 1.5).abs() < 0.02, "{piece:?}");
        assert!(fitter.is_empty());
    }

    #[test]
    fn noise_along_a_line_leaves_it_straight_and_ends_at_its_last_vertex() {
        let mut fitter = Fitter::default();
        for (x, y) in [(0.1, 0.005), (0.2, -0.005), (0.3, 0.005), (0.4, 0.0)] {
            assert!(fitter.take(at(x, y), 1.0, ALLOWANCE_MM));
        }
        let piece = fitter.end(ALLOWANCE_MM).unwrap();
        assert!(piece.at_vertex && piece.sweep_rad == 0.0, "{piece:?}");
    }

    #[test]
    fn a_corner_is_not_shortened_and_a_bend_is() {
        let mut fitter = Fitter::default();
        for part in 1..=10 {
            assert!(fitter.take(at(0.1 * f64::from(part), 0.0), 1.0, ALLOWANCE_MM));
        }
        let (corner, bend) = (at(1.0, 0.1), at(1.1, 0.029));
        assert!(!fitter.take(corner, 1.0, ALLOWANCE_MM) && !fitter.take(bend, 1.0, ALLOWANCE_MM));
        assert_eq!(fitter.shorten(corner, ALLOWANCE_MM), None);
        // Four vertices earlier.
        let piece = fitter.shorten(bend, ALLOWANCE_MM).unwrap();
        assert!((piece.length_mm - 0.6).abs() < 1e-6, "{piece:?}");
        let from_there = at(0.5, 0.029);
        assert!(fitter.take(from_there, 1.0, ALLOWANCE_MM));
    }

    #[test]
    fn what_goes_back_is_not_passed() {
        let mut fitter = Fitter::default();
        assert!(fitter.take(at(10.0, 0.0), 1.0, ALLOWANCE_MM));
        assert!(!fitter.take(at(5.0, 0.0), 1.0, ALLOWANCE_MM));
        assert!(!fitter.take(at(-20.0, 0.0), 1.0, ALLOWANCE_MM));
    }
}
