//! [`Ramps`]: the phases of a block with constant accelerations.

use super::Phase;
use super::block::Block;
use super::limits::Limits;
use super::modes::Modes;
use crate::extremes::{greatest, least};
use crate::root::root;

/// Longest phase, s: a feed hold begins to act after that time at the latest. Sums of it are exact, so that nothing adds up on the longest
/// lines.
const LONGEST_S: f32 = 3.0 / 64.0;
/// A shorter part of a block, or a lesser change of speed, as a share, is what rounding leaves between two ramps.
const ROUNDING: f32 = 2.5e-7;
/// Squares of speeds that differ less are alike.
const ALIKE: f32 = 4e-7;

/// A time with a constant acceleration: to a place on the block, which is passed with a speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp {
    duration_s: f32,
    accel: f32,
    end_mm: f32,
    speed: f32,
}

/// Speeding up, cruising, braking: what is left of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    length_mm: f32,
    cruise2: f32,
    /// The greatest speed on it.
    cruise: f32,
    /// Square of the speed at its end.
    exit2: f32,
    /// Where the phases taken so far end, and the speed there.
    done_mm: f32,
    speed: f32,
    /// How much of the next ramp they are, and the place and the speed at its start.
    taken_s: f32,
    begin_mm: f32,
    begin_speed: f32,
    /// What is to come, from `next` on.
    ramps: [Ramp; 3],
    next: usize,
}

impl Ramps {
    /// Nothing left.
    pub(super) const OVER: Self = Self {
        length_mm: 0.0,
        cruise2: 0.0,
        cruise: 0.0,
        exit2: 0.0,
        done_mm: 0.0,
        speed: 0.0,
        taken_s: 0.0,
        begin_mm: 0.0,
        begin_speed: 0.0,
        ramps: [Ramp { duration_s: 0.0, accel: 0.0, end_mm: 0.0, speed: 0.0 }; 3],
        next: usize::MAX,
    };

    /// Begins the next block: the quickest way along it that leaves it with the given square of a speed.
    pub(super) fn begin<M: Modes>(&mut self, block: &Block, exit2: f32, limits: &Limits) {
        if !(block.is_path() && block.length() > 0.0 && block.cruise2 > 0.0) {
            *self = Self::OVER;
            return;
        }
        // Most blocks are entered as the one before was left, and have the same greatest speed.
        if self.exit2 != block.entry2 || self.rest_mm() > 0.0 {
            self.speed = root(block.entry2);
        }
        if self.cruise2 != block.cruise2 {
            self.cruise_at(block.cruise2);
        }
        (self.length_mm, self.done_mm) = (block.length(), 0.0);
        let exit = if exit2 == self.cruise2 { self.cruise } else { root(exit2) };
        self.plan_from::<M>(block.entry2, (exit2, exit), limits);
    }

    /// Plans what is left of the block.
    pub(super) fn plan<M: Modes>(&mut self, exit2: f32, limits: &Limits) {
        self.plan_from::<M>(self.speed2(), (exit2, root(exit2)), limits);
    }

    /// From a square of a speed to another speed, of which both the square and the root are given.
    fn plan_from<M: Modes>(&mut self, entry2: f32, (exit2, exit): (f32, f32), limits: &Limits) {
        let rest_mm = self.rest_mm();
        self.begin_anew(exit2);
        // The greatest speed has become less meanwhile, by another share of it: that comes first.
        if M::ALL && entry2 > self.cruise2 * (1.0 + ALIKE) {
            return self.plan_down(entry2, (exit2, exit), limits);
        }
        // Where speeding up and braking meet.
        let peak2 = 0.5 * (entry2 + exit2) + limits.accel * rest_mm;
        let faster2 = greatest(entry2, exit2);
        let cruises = peak2 > self.cruise2 * (1.0 + ALIKE);
        if !cruises && peak2 - faster2 <= ALIKE * peak2 {
            // All the way faster, or slower; a little less hard than could be.
            let duration_s = 2.0 * rest_mm / (self.speed + exit);
            let accel = (exit - self.speed) / duration_s;
            return self.put(Ramp { duration_s, accel, end_mm: self.length_mm, speed: exit });
        }
        let cruise2 = self.cruise2;
        if peak2 >= cruise2 {
            let down_mm = (cruise2 - exit2) * limits.per_twice_accel;
            let up_mm = (cruise2 - entry2) * limits.per_twice_accel;
            self.put_ramp(self.length_mm, (self.cruise, exit), limits);
            self.put_cruise(rest_mm - down_mm - up_mm, self.length_mm - down_mm);
            self.put_ramp(self.done_mm + up_mm, (self.speed, self.cruise), limits);
        } else {
            let peak = root(peak2);
            let up_mm = (peak2 - entry2) * limits.per_twice_accel;
            self.put_ramp(self.length_mm, (peak, exit), limits);
            self.put_ramp(self.done_mm + up_mm, (self.speed, peak), limits);
        }
        // Whatever rounding has left out, the block ends where and as it should.
        if self.is_over() {
            (self.done_mm, self.speed) = (self.length_mm, exit);
        } else if let Some(last) = self.ramps.last_mut() {
            (last.end_mm, last.speed) = (self.length_mm, exit);
        }
    }

    /// From a speed above the greatest one: brakes to that, goes on with it, and brakes for the end; or brakes all the way.
    fn plan_down(&mut self, entry2: f32, (exit2, exit): (f32, f32), limits: &Limits) {
        let rest_mm = self.rest_mm();
        let cruise2 = self.cruise2;
        let first_mm = (entry2 - cruise2) * limits.per_twice_accel;
        let last_mm = greatest(cruise2 - exit2, 0.0) * limits.per_twice_accel;
        let cruise_mm = rest_mm - first_mm - last_mm;
        if exit2 > cruise2 * (1.0 + ALIKE) || !self.counts(cruise_mm) {
            let duration_s = 2.0 * rest_mm / (self.speed + exit);
            if duration_s > 0.0 {
                let accel = (exit - self.speed) / duration_s;
                self.put(Ramp { duration_s, accel, end_mm: self.length_mm, speed: exit });
            }
            return;
        }
        self.put_ramp(self.length_mm, (self.cruise, exit), limits);
        self.put_cruise(cruise_mm, self.length_mm - last_mm);
        self.put_ramp(self.done_mm + first_mm, (self.speed, self.cruise), limits);
        if let Some(last) = self.ramps.last_mut() {
            (last.end_mm, last.speed) = (self.length_mm, exit);
        }
    }

    /// Nothing is to come, up to the end with this square of a speed.
    fn begin_anew(&mut self, exit2: f32) {
        (self.exit2, self.taken_s, self.next) = (exit2, 0.0, self.ramps.len());
    }

    /// Another greatest speed holds on what is left of the block.
    pub(super) fn cruise_at(&mut self, cruise2: f32) {
        (self.cruise2, self.cruise) = (cruise2, root(cruise2));
    }

    /// Whether a part of the block is longer than what rounding leaves.
    fn counts(&self, way_mm: f32) -> bool {
        way_mm > ROUNDING * self.length_mm
    }

    /// Puts a change of speed at full acceleration before those put so far.
    fn put_ramp(&mut self, end_mm: f32, (from, speed): (f32, f32), limits: &Limits) {
        let change = speed - from;
        if change.abs() > ROUNDING * greatest(from, speed) {
            let accel = limits.accel.copysign(change);
            let duration_s = change.abs() * limits.per_accel;
            self.put(Ramp { duration_s, accel, end_mm, speed });
        }
    }

    /// Puts a way at the greatest speed before those put so far.
    fn put_cruise(&mut self, way_mm: f32, end_mm: f32) {
        if self.counts(way_mm) {
            self.put(Ramp { duration_s: way_mm / self.cruise, accel: 0.0, end_mm, speed: self.cruise });
        }
    }

    fn put(&mut self, ramp: Ramp) {
        self.next = self.next.saturating_sub(1);
        if let Some(place) = self.ramps.get_mut(self.next) {
            *place = ramp;
        }
    }

    /// Plans to stop as soon as can be: where the block is too short for that, to leave it with this square of a speed.
    pub(super) fn brake(&mut self, exit2: f32, limits: &Limits) {
        let way_mm = least(self.speed2() * limits.per_twice_accel, self.rest_mm());
        let stands_mm = least(self.done_mm + way_mm, self.length_mm);
        let is_short = self.forced2(limits) > 0.0;
        let (end_mm, exit) = if is_short { (self.length_mm, root(exit2)) } else { (stands_mm, 0.0) };
        self.begin_anew(exit2);
        self.put_ramp(end_mm, (self.speed, exit), limits);
        if self.is_over() {
            (self.done_mm, self.speed) = (end_mm, exit);
        }
    }

    /// Square of the speed at the end of the block, however hard it brakes from here on.
    pub(super) fn forced2(&self, limits: &Limits) -> f32 {
        let (speed2, twice) = (self.speed2(), 2.0 * limits.accel);
        let left2 = speed2 - twice * self.rest_mm();
        // What is less is rounding, of the place along the block and of the square.
        if left2 > ALIKE * speed2 + twice * ROUNDING * self.length_mm { left2 } else { 0.0 }
    }

    /// Square of the speed at the end of the phases taken.
    pub(super) fn speed2(&self) -> f32 {
        self.speed * self.speed
    }

    /// How much of the block is left.
    pub(super) const fn rest_mm(&self) -> f32 {
        self.length_mm - self.done_mm
    }

    /// Whether no phase is left, be it that the machine was held in the middle.
    pub(super) const fn is_over(&self) -> bool {
        self.next >= self.ramps.len()
    }

    /// The next phase.
    pub(super) fn next(&mut self) -> Option<Phase> {
        let Ramp { duration_s, accel, end_mm, speed } = *self.ramps.get(self.next)?;
        let left_s = duration_s - self.taken_s;
        let phase = Phase {
            duration_s: least(left_s, LONGEST_S),
            from_mm: self.done_mm,
            speed_mm_s: self.speed,
            accel_mm_s2: accel,
            jerk_mm_s3: 0.0,
        };
        if left_s > LONGEST_S {
            if self.taken_s == 0.0 {
                (self.begin_mm, self.begin_speed) = (self.done_mm, self.speed);
            }
            self.taken_s += LONGEST_S;
            let change = accel * self.taken_s;
            self.done_mm = self.begin_mm + self.taken_s * (self.begin_speed + 0.5 * change);
            self.speed = self.begin_speed + change;
        } else {
            (self.next, self.taken_s) = (self.next + 1, 0.0);
            (self.done_mm, self.speed) = (end_mm, speed);
        }
        Some(phase)
    }
}
