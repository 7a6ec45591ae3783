//! [`Ramps`]: the phases of a block with constant accelerations.

use super::Phase;
use super::block::{Block, single};
use super::limits::Limits;
use super::modes::Modes;
use crate::extremes::{greater, smaller};

/// Longest phase, s: a feed hold begins to act after that time at the latest.
pub(super) const LONGEST_S: f64 = 0.05;
/// A shorter part of a block is what rounding leaves between two ramps: its acceleration would be noise.
const ROUNDING: f64 = 1e-12;
/// Squares of speeds that differ less, as `f32`, are alike.
const ALIKE: f32 = 4e-7;

/// A time with a constant acceleration: to a place on the block, which is passed with a speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp {
    duration_s: f64,
    accel: f64,
    end_mm: f64,
    speed: f64,
}

/// Speeding up, cruising, braking: what is left of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    length_mm: f64,
    cruise2: f32,
    /// The greatest speed on it.
    cruise: f64,
    /// Square of the speed at its end.
    exit2: f32,
    /// Where the phases taken so far end, and the speed there.
    done_mm: f64,
    speed: f64,
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
        ramps: [Ramp { duration_s: 0.0, accel: 0.0, end_mm: 0.0, speed: 0.0 }; 3],
        next: usize::MAX,
    };

    /// Begins the next block: the quickest way along it that leaves it with the given square of a speed.
    pub(super) fn begin<M: Modes>(&mut self, block: &Block, exit2: f32, limits: &Limits) {
        if !(block.is_path() && block.length_single() > 0.0 && block.cruise2 > 0.0) {
            *self = Self::OVER;
            return;
        }
        // Most blocks are entered as the one before was left, and have the same greatest speed.
        if self.exit2 != block.entry2 || self.rest_mm() > 0.0 {
            self.speed = root(block.entry2);
        }
        if self.cruise2 != block.cruise2 {
            (self.cruise2, self.cruise) = (block.cruise2, root(block.cruise2));
        }
        (self.length_mm, self.done_mm) = (block.length(), 0.0);
        let exit = if exit2 == self.cruise2 { self.cruise } else { root(exit2) };
        self.exit2 = exit2;
        self.plan_from::<M>(f64::from(block.entry2), (f64::from(exit2), exit), limits);
    }

    /// Plans what is left of the block.
    pub(super) fn plan<M: Modes>(&mut self, exit2: f64, limits: &Limits) {
        self.exit2 = single(exit2);
        self.plan_from::<M>(self.speed2(), (exit2, libm::sqrt(exit2)), limits);
    }

    /// From a square of a speed to another speed, of which both the square and the root are given.
    fn plan_from<M: Modes>(&mut self, entry2: f64, (exit2, exit): (f64, f64), limits: &Limits) {
        let rest_mm = self.rest_mm();
        self.next = self.ramps.len();
        // The greatest speed has become less meanwhile, by another share of it: that comes first.
        if M::ALL && entry2 > f64::from(self.cruise2) * (1.0 + f64::from(ALIKE)) {
            return self.plan_down(entry2, (exit2, exit), limits);
        }
        // Where speeding up and braking meet: first as `f32`, to see what there is to reckon.
        let (entry2_single, exit2_single) = (single(entry2), single(exit2));
        let peak2 = 0.5 * (entry2_single + exit2_single) + limits.accel_single * single(rest_mm);
        let faster2 = if entry2_single > exit2_single { entry2_single } else { exit2_single };
        let cruises = peak2 > self.cruise2 * (1.0 + ALIKE);
        if !cruises && peak2 - faster2 <= ALIKE * peak2 {
            // All the way faster, or slower; a little less hard than could be.
            let duration_s = 2.0 * rest_mm / (self.speed + exit);
            let accel = (exit - self.speed) / duration_s;
            return self.put(Ramp { duration_s, accel, end_mm: self.length_mm, speed: exit });
        }
        let cruise2 = f64::from(self.cruise2);
        let peak2 = if cruises { cruise2 } else { 0.5 * (entry2 + exit2) + limits.accel() * rest_mm };
        if peak2 >= cruise2 {
            let down_begin_mm = self.length_mm - (cruise2 - exit2) * limits.per_twice_accel;
            let up_mm = (cruise2 - entry2) * limits.per_twice_accel;
            let up_end_mm = self.done_mm + up_mm;
            self.put_ramp(self.length_mm - down_begin_mm, self.length_mm, (self.cruise, exit), limits);
            let cruise_mm = down_begin_mm - up_end_mm;
            if self.counts(cruise_mm) {
                let duration_s = cruise_mm / self.cruise;
                self.put(Ramp { duration_s, accel: 0.0, end_mm: down_begin_mm, speed: self.cruise });
            }
            self.put_ramp(up_mm, up_end_mm, (self.speed, self.cruise), limits);
        } else {
            let peak = libm::sqrt(peak2);
            let up_mm = (peak2 - entry2) * limits.per_twice_accel;
            self.put_ramp(rest_mm - up_mm, self.length_mm, (peak, exit), limits);
            self.put_ramp(up_mm, self.done_mm + up_mm, (self.speed, peak), limits);
        }
        // Whatever rounding has left out, the block ends where and as it should.
        if self.is_over() {
            (self.done_mm, self.speed) = (self.length_mm, exit);
        } else if let Some(last) = self.ramps.last_mut() {
            (last.end_mm, last.speed) = (self.length_mm, exit);
        }
    }

    /// From a speed above the greatest one: brakes to that, goes on with it, and brakes for the end; or brakes all the way.
    fn plan_down(&mut self, entry2: f64, (exit2, exit): (f64, f64), limits: &Limits) {
        let rest_mm = self.rest_mm();
        let cruise2 = f64::from(self.cruise2);
        let first_end_mm = self.done_mm + (entry2 - cruise2) * limits.per_twice_accel;
        let last_begin_mm = self.length_mm - greater(cruise2 - exit2, 0.0) * limits.per_twice_accel;
        let cruise_mm = last_begin_mm - first_end_mm;
        if exit2 > cruise2 * (1.0 + f64::from(ALIKE)) || !self.counts(cruise_mm) {
            let duration_s = 2.0 * rest_mm / (self.speed + exit);
            if duration_s > 0.0 {
                let accel = (exit - self.speed) / duration_s;
                self.put(Ramp { duration_s, accel, end_mm: self.length_mm, speed: exit });
            }
            return;
        }
        self.put_ramp(self.length_mm - last_begin_mm, self.length_mm, (self.cruise, exit), limits);
        let duration_s = cruise_mm / self.cruise;
        self.put(Ramp { duration_s, accel: 0.0, end_mm: last_begin_mm, speed: self.cruise });
        self.put_ramp(first_end_mm - self.done_mm, first_end_mm, (self.speed, self.cruise), limits);
        if let Some(last) = self.ramps.last_mut() {
            (last.end_mm, last.speed) = (self.length_mm, exit);
        }
    }

    /// Another greatest speed holds on what is left of the block.
    pub(super) fn cruise_at(&mut self, cruise2: f32) {
        (self.cruise2, self.cruise) = (cruise2, root(cruise2));
    }

    /// Whether a part of the block is longer than what rounding leaves.
    fn counts(&self, way_mm: f64) -> bool {
        single(way_mm) > single(ROUNDING) * single(self.length_mm)
    }

    /// Puts a change of speed at full acceleration before those put so far.
    fn put_ramp(&mut self, way_mm: f64, end_mm: f64, (from, speed): (f64, f64), limits: &Limits) {
        if self.counts(way_mm) {
            let change = speed - from;
            let accel = limits.accel().copysign(change);
            let duration_s = change.abs() * limits.per_accel;
            self.put(Ramp { duration_s, accel, end_mm, speed });
        }
    }

    fn put(&mut self, ramp: Ramp) {
        self.next = self.next.saturating_sub(1);
        if let Some(place) = self.ramps.get_mut(self.next) {
            *place = ramp;
        }
    }

    /// Plans to stop as soon as can be. Gives the square of the speed at the end of the block: above 0 when it is too short.
    pub(super) fn brake(&mut self, limits: &Limits) -> f64 {
        let exit2 = greater(self.speed2() - 2.0 * limits.accel() * self.rest_mm(), 0.0);
        let way_mm = smaller(self.speed2() * limits.per_twice_accel, self.rest_mm());
        let stands_mm = smaller(self.done_mm + way_mm, self.length_mm);
        let (end_mm, exit) = (if exit2 > 0.0 { self.length_mm } else { stands_mm }, libm::sqrt(exit2));
        self.next = self.ramps.len();
        self.exit2 = single(exit2);
        self.put_ramp(way_mm, end_mm, (self.speed, exit), limits);
        if self.is_over() {
            (self.done_mm, self.speed) = (end_mm, exit);
        }
        exit2
    }

    /// Square of the speed at the end of the phases taken.
    pub(super) fn speed2(&self) -> f64 {
        self.speed * self.speed
    }

    /// How much of the block is left.
    pub(super) const fn rest_mm(&self) -> f64 {
        self.length_mm - self.done_mm
    }

    /// Whether no phase is left, be it that the machine was held in the middle.
    pub(super) const fn is_over(&self) -> bool {
        self.next >= self.ramps.len()
    }

    /// The next phase.
    pub(super) fn next(&mut self) -> Option<Phase> {
        let ramp = self.ramps.get_mut(self.next)?;
        let mut phase = Phase {
            duration_s: ramp.duration_s,
            from_mm: self.done_mm,
            speed_mm_s: self.speed,
            accel_mm_s2: ramp.accel,
            jerk_mm_s3: 0.0,
        };
        if phase.duration_s > LONGEST_S {
            phase.duration_s = LONGEST_S;
            ramp.duration_s -= LONGEST_S;
            self.done_mm += LONGEST_S * self.speed;
            if ramp.accel != 0.0 {
                let change = ramp.accel * LONGEST_S;
                self.done_mm += 0.5 * LONGEST_S * change;
                self.speed += change;
            }
        } else {
            self.next += 1;
            (self.done_mm, self.speed) = (ramp.end_mm, ramp.speed);
        }
        Some(phase)
    }
}

/// The speed of which this is the square.
fn root(speed2: f32) -> f64 {
    if speed2 > 0.0 { libm::sqrt(f64::from(speed2)) } else { 0.0 }
}
