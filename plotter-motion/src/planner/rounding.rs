//! [`Rounding`]: what is put off where corners are rounded within a tolerance, and where the lines meet that
//! are drawn in a corner's place.
//!
//! ```text
//!            moved
//!              ∧          the lines may lie outside of the path asked for by what the tolerance leaves,
//!            ╱   ╲        and the curve passes the corner asked for on its inner side by as much:
//!          ╱  asked ╲     so it has twice the tolerance to turn in
//! ```

use super::Shape;
use super::blend::{Blend, BlendArc, Room, half_turn};
use super::block::Bend;
use super::fit::Fitter;
use super::limits::Limits;
use super::merge::{Merged, Merger, Pace};
use super::modes::Keep;
use super::ring::narrow;
use super::stretch::{Stretch, direction};
use crate::extremes::least;
use crate::geom::single;
use crate::toolpath::chords::DividedArc;
use crate::{Point, Vec2};

/// Share of the path tolerance that vertices may be left out for; corners are rounded within the rest.
pub(super) const MERGED_SHARE: f64 = 0.5;
/// Greatest distance of an arc's chords from the arc, as a share of the path tolerance: small beside the half
/// of [`MERGED_SHARE`], so that arcs lose little of the rest.
pub(super) const CHORD_SHARE: f64 = 1.0 / 32.0;
/// Shortest line between two curves, mm: a shorter one is rounding of places up to a kilometre, and is left
/// out.
pub(super) const SHORTEST_MM: f64 = 1e-9;
/// A corner is moved outwards by at most the tolerance divided by this, so by twice the tolerance.
const LEAST_LEVEL: f64 = 0.5;
/// How often half the move is tried if the curve has no room to come back to the corner: down to a 16th of
/// it.
const TRIALS: u32 = 4;
/// What a level is multiplied by for the share of the tolerance that a corner takes: all of it for turns of
/// up to 151 degrees, none for a way straight back, which is drawn to its end. There is nothing to gain there
/// by less.
const SHARP: f64 = 4.0;

/// A corner of the path, and where the corner of the lines is that are drawn in its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Vertex {
    pub(super) asked: Point,
    pub(super) moved: Point,
    /// How far the path may be from it, mm.
    within_mm: f64,
    /// What holds before it.
    pub(super) before: Pace,
}

impl Vertex {
    /// Between two segments, of which the first begins at `from`; `within_mm` is what the tolerance is before
    /// any vertex is left out. It is moved as far as is useful and as `may_be`, which is true of a corner
    /// that is not moved.
    pub(super) fn new(
        from: &Point,
        (held, next): (&Merged, &Merged),
        within_mm: f64,
        limits: &Limits,
        may_be: impl Fn(&Self) -> bool,
    ) -> Self {
        let asked = held.to;
        let within_mm = within_mm - f64::from(held.deviation_mm.max(next.deviation_mm));
        let vertex = Self { asked, moved: asked, within_mm, before: held.pace };
        let mut off = vertex.off(from, next, limits);
        for _ in 0..TRIALS {
            let moved = Self { moved: asked + off, ..vertex };
            if off == Vec2::default() || may_be(&moved) {
                return moved;
            }
            off = off * 0.5;
        }
        vertex
    }

    /// Where the lines that are drawn in place of the corner, which comes from one place and goes to another,
    /// should meet: outside of it, so that the curve begins on the outer side of the path and passes the
    /// corner on the inner one, where the speed gains by that.
    fn off(&self, from: &Point, next: &Merged, limits: &Limits) -> Vec2 {
        let Self { asked, within_mm, .. } = *self;
        let (way_in, way_out) = (asked - *from, next.to - asked);
        let (in_mm, out_mm) = (way_in.length_near(), way_out.length_near());
        if !(in_mm > 0.0 && out_mm > 0.0) {
            return Vec2::default();
        }
        let (lean, inwards) = half_turn(way_in * (1.0 / in_mm), way_out * (1.0 / out_mm));
        let most = (f64::INFINITY, 0.5 * in_mm.min(out_mm));
        let room = self.room((lean, inwards), most, next.pace, limits);
        let wanted_mm = Blend::new(lean, room).deviation_mm(lean) - within_mm;
        // The lines may be off by as much across their way.
        let most_mm = taken_share(lean) * within_mm / level_of(lean).max(LEAST_LEVEL);
        -inwards * wanted_mm.min(most_mm).max(0.0)
    }

    /// The most of both lines that its curve can use, mm.
    pub(super) fn most_tangent_mm(&self, from: &Point, to: &Point) -> f64 {
        let (way_in, way_out) = (self.asked - *from, *to - self.asked);
        let (in_mm, out_mm) = (way_in.length_near(), way_out.length_near());
        let lean = if in_mm > 0.0 && out_mm > 0.0 {
            half_turn(way_in * (1.0 / in_mm), way_out * (1.0 / out_mm)).0
        } else {
            0.0
        };
        2.0 * (self.moved.distance(self.asked) + self.within_mm) / lean
    }

    /// Whether the curve there, from lines that come from one place and go to another, comes back to the
    /// corner asked for. `tangent_mm` is the room on the first line; on the second, of the pace `after`, it is
    /// the half.
    pub(super) fn is_passed(
        &self,
        (from, to): (&Point, &Point),
        tangent_mm: f64,
        after: Pace,
        limits: &Limits,
    ) -> bool {
        let (way_in, way_out) = (self.moved - *from, *to - self.moved);
        let (in_mm, out_mm) = (way_in.length_near(), way_out.length_near());
        if !(in_mm > 0.0 && out_mm > 0.0) {
            return false;
        }
        let (lean, inwards) = half_turn(way_in * (1.0 / in_mm), way_out * (1.0 / out_mm));
        let off = self.moved - self.asked;
        let most = (f64::INFINITY, tangent_mm.min(0.5 * out_mm));
        let room = self.room((lean, inwards), most, after, limits);
        let apex = off + inwards * Blend::new(lean, room).deviation_mm(lean);
        // Farther behind the corner it is only if there is room to spare.
        apex.dot(inwards) >= 0.0 || apex.length() <= self.within_mm
    }

    /// Square of the greatest speed on the curve there, if this holds after it.
    fn cruise2(&self, after: Pace) -> f32 {
        least(self.before.cruise2, after.cruise2)
    }

    fn room(
        &self,
        (lean, inwards): (f64, Vec2),
        (deviation_mm, tangent_mm): (f64, f64),
        after: Pace,
        limits: &Limits,
    ) -> Room {
        // An arc is accelerated towards every side in turn.
        let accel = if limits.has_jerk() {
            limits.turning_round()
        } else {
            limits.turning(direction(inwards), single(lean))
        };
        Room { deviation_mm, tangent_mm, cruise2: self.cruise2(after).into(), accel_mm_s2: accel.into() }
    }

    /// The curve between two directions, of which the second has this pace, and how far from the corner it
    /// touches the lines; none where there is no room for one.
    pub(super) fn blend(
        &self,
        (along, after): (Vec2, Vec2),
        tangent_mm: f64,
        pace: Pace,
        limits: &Limits,
    ) -> Option<(f64, Stretch)> {
        let Self { asked, moved, within_mm, .. } = *self;
        let (lean, inwards) = half_turn(along, after);
        let deviation_mm = reach_mm(moved - asked, inwards, within_mm * taken_share(lean));
        let room = self.room((lean, inwards), (deviation_mm, tangent_mm), pace, limits);
        let (tangent_mm, length_mm, shape, bend);
        if limits.has_jerk() {
            let arc = BlendArc::new(lean, room);
            (tangent_mm, length_mm) = (arc.tangent_mm, arc.length_mm());
            let side = if along.cross(after) > 0.0 { 1.0 } else { -1.0 };
            let centre = moved - along * tangent_mm + along.perpendicular() * (side * arc.radius_mm);
            let sweep_rad = single(side * arc.turn_rad);
            shape = Shape::Arc { centre, sweep_rad };
            bend = Bend::Arc { sweep_rad, form2: narrow(arc.form2) };
        } else {
            let parabola = Blend::new(lean, room);
            (tangent_mm, length_mm) = (parabola.tangent_mm, 2.0 * parabola.tangent_mm);
            shape = Shape::Parabola { control: moved };
            let inwards = limits.of_motors(direction(inwards))[0];
            bend = Bend::Parabola { lean: single(lean), inwards, form2: narrow(parabola.form2) };
        }
        let curve = Stretch {
            shape,
            to: moved + after * tangent_mm,
            length_mm: single(length_mm),
            entry: direction(along),
            exit: direction(after),
            feed2: self.cruise2(pace),
            bend,
        };
        (tangent_mm > SHORTEST_MM && length_mm > SHORTEST_MM).then_some((tangent_mm, curve))
    }
}

/// What is put off where corners are rounded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rounding {
    pub(super) merger: Merger,
    /// The last corner, from which the direction is not known yet.
    pub(super) corner: Option<Vertex>,
    /// The segment after it, whose end may still be a corner.
    pub(super) held: Option<Merged>,
    /// An arc whose chords have not all come.
    pub(super) arc: Option<DividedArc>,
}

impl Rounding {
    /// What is left of the tolerance for lines, mm.
    pub(super) fn within_mm(&self, path_tolerance_mm: f64) -> f64 {
        if self.merger.has_arcs { (1.0 - CHORD_SHARE) * path_tolerance_mm } else { path_tolerance_mm }
    }
}

/// What is put off to see what follows, as the way to follow the path wants it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PutOff {
    Exact(Fitter),
    Tolerance(Rounding),
}

impl Default for PutOff {
    fn default() -> Self {
        Self::Exact(Fitter::default())
    }
}

/// What is put off, if the modes do that at all.
pub(super) trait Waiting {
    fn fitter(&self) -> Option<&Fitter>;
    fn fitter_mut(&mut self) -> Option<&mut Fitter>;
    fn rounding(&self) -> Option<&Rounding>;
    fn rounding_mut(&mut self) -> Option<&mut Rounding>;
}

impl<K: Keep<PutOff>> Waiting for K {
    fn fitter(&self) -> Option<&Fitter> {
        if let Some(PutOff::Exact(fitter)) = self.get() { Some(fitter) } else { None }
    }

    fn fitter_mut(&mut self) -> Option<&mut Fitter> {
        if let Some(PutOff::Exact(fitter)) = self.get_mut() { Some(fitter) } else { None }
    }

    fn rounding(&self) -> Option<&Rounding> {
        if let Some(PutOff::Tolerance(rounding)) = self.get() { Some(rounding) } else { None }
    }

    /// The first time there is none yet.
    fn rounding_mut(&mut self) -> Option<&mut Rounding> {
        let put_off = self.get_mut()?;
        if let PutOff::Exact(_) = put_off {
            *put_off = PutOff::Tolerance(Rounding::default());
        }
        if let PutOff::Tolerance(rounding) = put_off { Some(rounding) } else { None }
    }
}

/// How far from a place that is `off` from the corner asked for, in a direction, one comes to where it is no
/// farther than this behind the corner, mm.
fn reach_mm(off: Vec2, direction: Vec2, behind_mm: f64) -> f64 {
    let (along, across) = (off.dot(direction), off.cross(direction));
    (libm::sqrt((behind_mm * behind_mm - across * across).max(0.0)) - along).max(0.0)
}

/// Share of the tolerance that a corner takes.
fn taken_share(lean: f64) -> f64 {
    (SHARP * level_of(lean)).min(1.0)
}

/// Cosine of half of a turn whose sine that is.
fn level_of(lean: f64) -> f64 {
    libm::sqrt((1.0 - lean * lean).max(0.0))
}
