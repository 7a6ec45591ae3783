//! [`Ramps`]: the phases of a block with constant accelerations.

use super::Phase;
use super::block::{Block, Kind};
use super::law::Law;
use super::limits::Limits;
use super::modes::Modes;
use crate::extremes::{greatest, least};
use crate::root::root;

/// Longest phase, s (47 ms): a feed hold begins to act after this time at the latest. The number is exact in
/// `f32`, as is its inverse to a last bit. Phases are longer only on a ramp of six years.
const LONGEST_S: f32 = 3.0 / 64.0;
const PER_LONGEST: f32 = 1.0 / LONGEST_S;
/// As a share: a shorter part of a block, or a smaller change of speed, is only what rounding leaves between
/// two ramps. About two last bits of `f32`.
const ROUNDING: f32 = 2.5e-7;
/// As a share: squares of speeds that differ less count as equal. About three last bits of `f32`.
const ALIKE: f32 = 4e-7;

/// Most ramps of a part of a block: up, along, down.
const RAMPS: u8 = 3;

/// A stretch with constant acceleration: the place on the block where it ends, told by its distance from the
/// block's end, and the speed there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp {
    duration_s: f32,
    accel: f32,
    rest_mm: f32,
    speed: f32,
}

/// The rest of a block: speeding up, cruising, braking.
///
/// An arc is passed in several parts. The greatest speed on a part says which acceleration is left on it: see
/// [`Law`]. A part is planned when the previous one is over.
///
/// Places are told by the distance to the block's end. So they are exact to the last bit near the end, where
/// the speed fits one place only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    law: Law,
    length_mm: f32,
    /// Number of its parts, of equal length.
    parts: u16,
    cruise2: f32,
    /// The greatest speed on the block.
    cruise: f32,
    /// Square of the speed at its end.
    exit2: f32,
    /// Length that the phases taken so far leave, and the speed there.
    rest_mm: f32,
    speed: f32,
    /// Number of phases left of the current ramp, and the duration of each.
    left: u32,
    phase_s: f32,
    /// The ramps of the current part; those from `next` on are to come.
    ramps: [Ramp; 3],
    next: u8,
    /// Whether the machine stops as soon as it can.
    stops: bool,
}

impl Default for Ramps {
    fn default() -> Self {
        Self::OVER
    }
}

/// An acceleration, and one over it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Steepness {
    accel: f32,
    per_accel: f32,
}

impl Steepness {
    fn new(accel: f32) -> Self {
        Self { accel, per_accel: 1.0 / accel }
    }

    /// The distance over which the square of a speed changes by `change2`.
    fn way_mm(self, change2: f32) -> f32 {
        change2 * (0.5 * self.per_accel)
    }
}

impl Ramps {
    /// Nothing left.
    pub(super) const OVER: Self = Self {
        law: Law::Line(0.0),
        length_mm: 0.0,
        parts: 1,
        cruise2: 0.0,
        cruise: 0.0,
        exit2: 0.0,
        rest_mm: 0.0,
        speed: 0.0,
        left: 0,
        phase_s: 0.0,
        ramps: [Ramp { duration_s: 0.0, accel: 0.0, rest_mm: 0.0, speed: 0.0 }; 3],
        next: u8::MAX,
        stops: false,
    };

    /// Begins the next block: the quickest motion along it that leaves it at `exit2`.
    pub(super) fn begin<M: Modes>(&mut self, block: &Block, exit2: f32, limits: &Limits) {
        if !(block.is_path() && block.length() > 0.0 && block.cruise2 > 0.0) {
            *self = Self::OVER;
            return;
        }
        // Most blocks are entered at the speed at which the previous one was left, and have the same greatest
        // speed.
        if self.exit2 != block.entry2 || self.rest_mm > 0.0 {
            self.speed = root(block.entry2);
        }
        if self.cruise2 != block.cruise2 {
            self.cruise_at(block.cruise2);
        }
        self.law = block.law(limits);
        (self.length_mm, self.rest_mm) = (block.length(), block.length());
        // Most sharp corners are passed at one speed. An arc may be long, and a machine that is held should
        // brake harder as it gets slower.
        let cruise2 = block.cruise2;
        let is_even = block.kind == Kind::Parabola && block.entry2 == cruise2 && exit2 == cruise2;
        self.parts = if is_even { 1 } else { block.pieces() };
        (self.exit2, self.stops) = (exit2, false);
        self.plan_part::<M>(block.entry2);
    }

    /// Plans the rest of the block.
    pub(super) fn plan<M: Modes>(&mut self, exit2: f32) {
        (self.exit2, self.stops) = (exit2, false);
        self.plan_part::<M>(self.speed2());
    }

    /// Length of one of its parts, mm.
    fn part_mm(&self) -> f32 {
        self.length_mm / f32::from(self.parts)
    }

    /// Length of so many of its parts, mm.
    fn parts_mm(&self, parts: u16) -> f32 {
        if parts > 0 { f32::from(parts) * self.part_mm() } else { 0.0 }
    }

    /// Number of parts after the current one.
    fn parts_left(&self) -> u16 {
        /// Greatest rounding of that number.
        const ROUNDING: f32 = 1e-3;
        if self.parts > 1 { whole(self.rest_mm / self.part_mm() - ROUNDING) } else { 0 }
    }

    /// How hard the machine may speed up and brake on the part that has `parts_left` parts after it.
    fn laws(&self, parts_left: u16) -> (Law, Law) {
        let before = self.parts.saturating_sub(1).saturating_sub(parts_left);
        (self.law.on_part(before, self.parts), self.law.on_part(parts_left, self.parts))
    }

    /// Square of the greatest speed at which the last `parts` parts can be entered, if the block is left as
    /// planned.
    fn before2(&self, parts: u16) -> f32 {
        let mut speed2 = self.exit2;
        for part in 0..parts {
            if speed2 >= self.cruise2 {
                break;
            }
            speed2 = self.laws(part).1.reach2(speed2, self.part_mm());
        }
        speed2
    }

    /// Square of the greatest speed at which the block can be left.
    pub(super) fn most_exit2(&self) -> f32 {
        let left = self.parts_left();
        let mut way_mm = self.rest_mm - self.parts_mm(left);
        let mut speed2 = self.speed2();
        for part in (0..=left).rev() {
            if speed2 >= self.cruise2 {
                break;
            }
            speed2 = self.laws(part).0.reach2(speed2, way_mm);
            way_mm = self.part_mm();
        }
        speed2
    }

    /// Plans the part that begins here, entered at `entry2`.
    fn plan_part<M: Modes>(&mut self, entry2: f32) {
        let (left, cruise2) = (self.parts_left(), self.cruise2);
        let end_mm = self.parts_mm(left);
        let way_mm = self.rest_mm - end_mm;
        let laws = self.laws(left);
        let exit2 = if left > 0 {
            let most2 = least(self.before2(left), cruise2);
            if entry2 > cruise2 {
                // The greatest speed was lowered meanwhile.
                greatest(most2, entry2 - 2.0 * laws.1.accel_at(entry2) * way_mm)
            } else {
                least(most2, laws.0.reach2(entry2, way_mm))
            }
        } else {
            self.exit2
        };
        let exit = if exit2 == cruise2 { self.cruise } else { root(exit2) };
        self.begin_anew();
        // An override has lowered the speed: braking to it comes first.
        if M::ALL && entry2 > cruise2 * (1.0 + ALIKE) {
            self.plan_down(entry2, (exit2, exit), end_mm, laws.1);
        } else {
            self.plan_up(entry2, (exit2, exit), end_mm, laws);
        }
        // Whatever was rounded, the part ends at its place and speed.
        if self.has_none() {
            (self.rest_mm, self.speed) = (end_mm, exit);
        } else if let Some(last) = self.ramps.last_mut() {
            (last.rest_mm, last.speed) = (end_mm, exit);
        }
    }

    /// From one speed, given by its square, to another, given by its square and its root.
    fn plan_up(&mut self, entry2: f32, (exit2, exit): (f32, f32), end_mm: f32, (up, down): (Law, Law)) {
        let (rest_mm, cruise2) = (self.rest_mm, self.cruise2);
        let way_mm = rest_mm - end_mm;
        // The place where speeding up and braking meet, for the stricter of both laws.
        let law = up.stricter(down);
        let peak2 = law.reach2(0.5 * (entry2 + exit2), 0.5 * way_mm);
        let faster2 = greatest(entry2, exit2);
        let cruises = peak2 > cruise2 * (1.0 + ALIKE);
        if !cruises && peak2 - faster2 <= ALIKE * peak2 {
            let law = if exit2 > entry2 { up } else { down };
            return self.put_through(exit, end_mm, Steepness::new(law.accel_at(faster2)));
        }
        let steepness = Steepness::new(law.accel_at(least(peak2, cruise2)));
        // Rounding may make one end faster than the cruise.
        let down_mm = steepness.way_mm(greatest(cruise2 - exit2, 0.0));
        let up_mm = steepness.way_mm(greatest(cruise2 - entry2, 0.0));
        let cruise_mm = way_mm - down_mm - up_mm;
        if peak2 >= cruise2 && self.counts(cruise_mm) {
            self.put_ramp(down_mm, end_mm, (self.cruise, exit), steepness);
            self.put_cruise(cruise_mm, end_mm + down_mm);
            self.put_ramp(up_mm, rest_mm - up_mm, (self.speed, self.cruise), steepness);
            return;
        }
        let (peak2, peak) = if peak2 >= cruise2 { (cruise2, self.cruise) } else { (peak2, root(peak2)) };
        let split = match law {
            Law::Line(_) => steepness,
            // On a fast curve the acceleration is known only to some hundred thousandths, so the time comes
            // from the distance.
            _ => Steepness::new((2.0 * peak2 - entry2 - exit2) / (2.0 * way_mm)),
        };
        let up_mm = least(greatest(split.way_mm(peak2 - entry2), 0.0), way_mm);
        self.put_ramp(way_mm - up_mm, end_mm, (peak, exit), steepness);
        self.put_ramp(up_mm, rest_mm - up_mm, (self.speed, peak), steepness);
    }

    /// From a speed above the greatest one: brakes to that, keeps it, and brakes for the end, or brakes all
    /// the way.
    fn plan_down(&mut self, entry2: f32, (exit2, exit): (f32, f32), end_mm: f32, down: Law) {
        let (rest_mm, cruise2) = (self.rest_mm, self.cruise2);
        let steepness = Steepness::new(down.accel_at(entry2));
        let first_mm = steepness.way_mm(entry2 - cruise2);
        let last_mm = steepness.way_mm(greatest(cruise2 - exit2, 0.0));
        let cruise_mm = rest_mm - end_mm - first_mm - last_mm;
        if exit2 > cruise2 * (1.0 + ALIKE) || !self.counts(cruise_mm) {
            return self.put_through(exit, end_mm, steepness);
        }
        self.put_ramp(last_mm, end_mm, (self.cruise, exit), steepness);
        self.put_cruise(cruise_mm, end_mm + last_mm);
        self.put_ramp(first_mm, rest_mm - first_mm, (self.speed, self.cruise), steepness);
    }

    /// Nothing is to come.
    fn begin_anew(&mut self) {
        (self.left, self.next) = (0, RAMPS);
    }

    /// Another greatest speed holds on the rest of the block.
    pub(super) fn cruise_at(&mut self, cruise2: f32) {
        (self.cruise2, self.cruise) = (cruise2, root(cruise2));
    }

    /// Whether a distance is more than rounding leaves of the rest of the block.
    fn counts(&self, way_mm: f32) -> bool {
        way_mm > ROUNDING * self.rest_mm
    }

    /// Puts a change of speed all the way to the end of the part, a little less hard than allowed and never
    /// harder. If rounding asks for it, the ramp ends some last bits of the braking distance before or after
    /// that end.
    fn put_through(&mut self, exit: f32, end_mm: f32, steepness: Steepness) {
        let change = exit - self.speed;
        let even_s = self.even_s(self.rest_mm - end_mm, (self.speed, exit));
        let duration_s = match self.law {
            Law::Line(_) => greatest(even_s, change.abs() * steepness.per_accel),
            _ => self.curve_s(self.rest_mm - end_mm, (self.speed, exit), steepness),
        };
        if duration_s > 0.0 {
            self.put(Ramp { duration_s, accel: change / duration_s, rest_mm: end_mm, speed: exit });
        }
    }

    /// The time for a distance along which the speed changes linearly.
    fn even_s(&self, way_mm: f32, (from, speed): (f32, f32)) -> f32 {
        2.0 * way_mm / (from + speed)
    }

    /// The same on a curve. There a change as small as rounding may take a whole part, and its distance is
    /// known better than its acceleration. The acceleration is used only if the time is so short that
    /// rounding would change the acceleration by more than a thousandth.
    fn curve_s(&self, way_mm: f32, (from, speed): (f32, f32), steepness: Steepness) -> f32 {
        /// As a share of the time for the whole speed, and of the rest of the block: a thousand times the
        /// last bits of two `f32`.
        const SHORT: f32 = 1.2e-4;
        let even_s = self.even_s(way_mm, (from, speed));
        let is_long = even_s * self.law.accel_at(0.0) > SHORT * greatest(from, speed);
        if is_long && way_mm > SHORT * self.rest_mm {
            even_s
        } else {
            greatest(even_s, (speed - from).abs() * steepness.per_accel)
        }
    }

    /// Puts a change of speed at full acceleration before the ramps put so far: `way_mm` long, to a place
    /// `rest_mm` before the block's end.
    fn put_ramp(&mut self, way_mm: f32, rest_mm: f32, (from, speed): (f32, f32), steepness: Steepness) {
        let change = speed - from;
        let changes = change.abs() > ROUNDING * greatest(from, speed);
        if let Law::Line(_) = self.law {
            if changes {
                let accel = steepness.accel.copysign(change);
                let duration_s = change.abs() * steepness.per_accel;
                self.put(Ramp { duration_s, accel, rest_mm, speed });
            }
        } else if changes || self.counts(way_mm) {
            let duration_s = self.curve_s(way_mm, (from, speed), steepness);
            self.put(Ramp { duration_s, accel: change / duration_s, rest_mm, speed });
        }
    }

    /// Puts a stretch at the greatest speed before the ramps put so far.
    fn put_cruise(&mut self, way_mm: f32, rest_mm: f32) {
        if self.counts(way_mm) {
            self.put(Ramp { duration_s: way_mm / self.cruise, accel: 0.0, rest_mm, speed: self.cruise });
        }
    }

    fn put(&mut self, ramp: Ramp) {
        self.next = self.next.saturating_sub(1);
        if let Some(place) = self.ramps.get_mut(usize::from(self.next)) {
            *place = ramp;
        }
    }

    /// Plans to stop as soon as possible. If the block is too short for that, it is left at `exit2`.
    pub(super) fn brake(&mut self, exit2: f32) {
        (self.exit2, self.stops) = (exit2, true);
        self.brake_part();
    }

    /// Brakes in the part that begins here.
    fn brake_part(&mut self) {
        let (left, speed2) = (self.parts_left(), self.speed2());
        let end_mm = self.parts_mm(left);
        let steepness = Steepness::new(self.laws(left).1.accel_at(speed2));
        let (part_mm, stop_mm) = (self.rest_mm - end_mm, steepness.way_mm(speed2));
        let left2 = speed2 - 2.0 * steepness.accel * part_mm;
        let (way_mm, rest_mm, exit) = if left2 <= 0.0 {
            (stop_mm, self.rest_mm - least(stop_mm, self.rest_mm), 0.0)
        } else if left > 0 {
            (part_mm, end_mm, root(left2))
        } else {
            (part_mm, 0.0, root(self.exit2))
        };
        self.begin_anew();
        self.put_ramp(way_mm, rest_mm, (self.speed, exit), steepness);
        if self.has_none() {
            (self.rest_mm, self.speed) = (rest_mm, exit);
        }
    }

    /// Square of the speed at the end of the block if the machine brakes as hard as it can from here on.
    /// Rounding never makes it more than was planned.
    pub(super) fn forced2(&self) -> f32 {
        let left = self.parts_left();
        let mut way_mm = self.rest_mm - self.parts_mm(left);
        let mut speed2 = self.speed2();
        for part in (0..=left).rev() {
            speed2 -= 2.0 * self.laws(part).1.accel_at(speed2) * way_mm;
            way_mm = self.part_mm();
            if speed2 <= 0.0 {
                break;
            }
        }
        greatest(least(speed2, self.exit2), 0.0)
    }

    /// Square of the speed at the end of the phases taken.
    pub(super) fn speed2(&self) -> f32 {
        self.speed * self.speed
    }

    /// Length that is left of the block.
    pub(super) const fn rest_mm(&self) -> f32 {
        self.rest_mm
    }

    /// Whether no ramp of the part under way is left.
    const fn has_none(&self) -> bool {
        self.next >= RAMPS
    }

    /// Whether no phase is left, also because the machine was held in the middle.
    pub(super) fn is_over(&self) -> bool {
        self.has_none() && (self.rest_mm <= 0.0 || (self.stops && self.speed <= 0.0))
    }

    /// The current ramp: the first one of the next part, if the previous part is over.
    fn ramp<M: Modes>(&mut self) -> Option<Ramp> {
        while self.has_none() {
            if self.is_over() {
                return None;
            }
            let (rest_mm, speed2) = (self.rest_mm, self.speed2());
            if self.stops {
                self.brake_part();
            } else {
                self.plan_part::<M>(self.speed2());
            }
            if self.has_none() && self.rest_mm >= rest_mm && self.speed2() >= speed2 {
                // The machine can pass none of it.
                self.rest_mm = 0.0;
            }
        }
        self.ramps.get(usize::from(self.next)).copied()
    }

    /// The next phase. All phases of a ramp are alike, and the rest of the ramp is told by their number, so
    /// no rounding adds up and the ramp ends.
    pub(super) fn next<M: Modes>(&mut self) -> Option<Phase> {
        let ramp = self.ramp::<M>()?;
        let phase = self.phase(&ramp);
        self.left -= 1;
        if self.left == 0 {
            self.next += 1;
        }
        let left_s = number(self.left) * self.phase_s;
        let change = ramp.accel * left_s;
        self.speed = ramp.speed - change;
        self.rest_mm = ramp.rest_mm + left_s * (ramp.speed - 0.5 * change);
        Some(phase)
    }

    /// The next phase, and how many like it are left of the ramp, this one included. All of them are taken.
    pub(super) fn next_whole<M: Modes>(&mut self) -> Option<(Phase, u32)> {
        let ramp = self.ramp::<M>()?;
        let phase = self.phase(&ramp);
        let count = core::mem::take(&mut self.left);
        self.next += 1;
        (self.speed, self.rest_mm) = (ramp.speed, ramp.rest_mm);
        Some((phase, count))
    }

    /// The next phase of the current ramp.
    fn phase(&mut self, ramp: &Ramp) -> Phase {
        if self.left == 0 {
            self.left = phases(ramp.duration_s);
            self.phase_s = ramp.duration_s / number(self.left);
        }
        Phase {
            duration_s: self.phase_s,
            from_mm: self.length_mm - self.rest_mm,
            speed_mm_s: self.speed,
            accel_mm_s2: ramp.accel,
            jerk_mm_s3: 0.0,
        }
    }
}

/// The whole number below a number of at most some dozens; 0 for negative ones.
fn whole(number: f32) -> u16 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let whole = number as u16;
    whole
}

/// How many phases a time takes: at least one, at most what a `u32` counts.
fn phases(duration_s: f32) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole ones, saturating; no time is below 0"
    )]
    let whole = (duration_s * PER_LONGEST) as u32;
    whole.saturating_add(1)
}

/// Exact to the last bit of an `f32`.
#[expect(clippy::cast_precision_loss, reason = "as it says")]
fn number(phases: u32) -> f32 {
    phases as f32
}

#[cfg(test)]
mod tests {
    use super::super::block::Bend;
    use super::super::{AllModes, PlannerSettings, Shape};
    use super::*;
    use crate::{Pen, Point};

    fn ramps(length_mm: f32, speed_mm_s: f32) -> Ramps {
        let limits = Limits::of(&PlannerSettings::default());
        let to = Point::new(length_mm.into(), 0.0);
        let cruise2 = speed_mm_s * speed_mm_s;
        let mut block = Block::path(
            Shape::Line,
            to,
            length_mm,
            (Pen::Down, 0),
            cruise2,
            Bend::Line { accel: limits.accel() },
        );
        block.cruise2 = cruise2;
        let mut ramps = Ramps::OVER;
        ramps.begin::<AllModes>(&block, 0.0, &limits);
        ramps
    }

    #[test]
    fn lines_of_months_and_of_decades_are_told_by_the_number_of_their_phases() {
        // 10 m at 0.1 mm/min, 1.2 m at the least feed of the firmware.
        for (length_mm, speed_mm_s) in [(1e4, 0.1 / 60.0), (1.2e3, 1e-3)] {
            let mut ramps = ramps(length_mm, speed_mm_s);
            assert_eq!(ramps.next::<AllModes>().map(|phase| phase.from_mm), Some(0.0));
            // The cruise.
            let first = ramps.next::<AllModes>().unwrap();
            let all = ramps.left;
            let time_s = f64::from(first.duration_s) * (f64::from(all) + 1.0);
            let due_s = f64::from(length_mm) / f64::from(speed_mm_s);
            assert!((time_s / due_s - 1.0).abs() < 1e-6, "{time_s} s for {due_s} s");
            for left in [all / 2, 100_000, 100, 3] {
                ramps.left = left;
                let before = ramps.next::<AllModes>().unwrap();
                let phase = ramps.next::<AllModes>().unwrap();
                let rest_mm = length_mm * (number(left) / number(all));
                assert!((length_mm - phase.from_mm - rest_mm).abs() <= 2e-7 * length_mm, "{before:?}");
                assert_eq!((phase.duration_s, phase.speed_mm_s), (first.duration_s, speed_mm_s));
            }
            // One more of the cruise, and the stop.
            assert!(
                ramps.next::<AllModes>().is_some()
                    && ramps.next::<AllModes>().is_some()
                    && ramps.next::<AllModes>().is_none()
            );
            assert_eq!((ramps.rest_mm, ramps.speed), (0.0, 0.0));
        }
    }

    #[test]
    fn phases_are_as_long_as_a_hold_may_wait() {
        for duration_s in [1e-30, 1e-3, LONGEST_S, 1.0, 1e3, 1e6, 1.9e8] {
            let phase_s = duration_s / number(phases(duration_s));
            assert!(phase_s > 0.0 && phase_s <= LONGEST_S, "{duration_s} s: {phase_s} s");
        }
        assert_eq!([f32::INFINITY, f32::MAX].map(phases), [u32::MAX; 2]);
    }
}
