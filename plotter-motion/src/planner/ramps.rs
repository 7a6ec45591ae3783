//! [`Ramps`]: the phases of a block with constant accelerations.

use super::Phase;
use super::block::Block;
use super::limits::Limits;
use super::modes::Modes;
use crate::extremes::{greatest, least};
use crate::root::root;

/// Longest phase, s: a feed hold begins to act after that time at the latest. Only where a ramp lasts six years are they longer.
const LONGEST_S: f32 = 3.0 / 64.0;
const PER_LONGEST: f32 = 1.0 / LONGEST_S;
/// A shorter part of a block, or a lesser change of speed, as a share, is what rounding leaves between two ramps.
const ROUNDING: f32 = 2.5e-7;
/// Squares of speeds that differ less are alike.
const ALIKE: f32 = 4e-7;

/// A time with a constant acceleration: to a place on the block, so far from its end, which is passed with a speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp {
    duration_s: f32,
    accel: f32,
    rest_mm: f32,
    speed: f32,
}

/// Speeding up, cruising, braking: what is left of a block.
///
/// Places are told by what is left of the block behind them, so that they are right to the last bit where the least of it is left: there
/// a speed is right for no other place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    length_mm: f32,
    cruise2: f32,
    /// The greatest speed on it.
    cruise: f32,
    /// Square of the speed at its end.
    exit2: f32,
    /// How much the phases taken so far leave of it, and the speed there.
    rest_mm: f32,
    speed: f32,
    /// How many phases of the ramp under way are left, and how long each of them is.
    left: u32,
    phase_s: f32,
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
        rest_mm: 0.0,
        speed: 0.0,
        left: 0,
        phase_s: 0.0,
        ramps: [Ramp { duration_s: 0.0, accel: 0.0, rest_mm: 0.0, speed: 0.0 }; 3],
        next: usize::MAX,
    };

    /// Begins the next block: the quickest way along it that leaves it with the given square of a speed.
    pub(super) fn begin<M: Modes>(&mut self, block: &Block, exit2: f32, limits: &Limits) {
        if !(block.is_path() && block.length() > 0.0 && block.cruise2 > 0.0) {
            *self = Self::OVER;
            return;
        }
        // Most blocks are entered as the one before was left, and have the same greatest speed.
        if self.exit2 != block.entry2 || self.rest_mm > 0.0 {
            self.speed = root(block.entry2);
        }
        if self.cruise2 != block.cruise2 {
            self.cruise_at(block.cruise2);
        }
        (self.length_mm, self.rest_mm) = (block.length(), block.length());
        let exit = if exit2 == self.cruise2 { self.cruise } else { root(exit2) };
        self.plan_from::<M>(block.entry2, (exit2, exit), limits);
    }

    /// Plans what is left of the block.
    pub(super) fn plan<M: Modes>(&mut self, exit2: f32, limits: &Limits) {
        self.plan_from::<M>(self.speed2(), (exit2, root(exit2)), limits);
    }

    /// From a square of a speed to another speed, of which both the square and the root are given.
    fn plan_from<M: Modes>(&mut self, entry2: f32, (exit2, exit): (f32, f32), limits: &Limits) {
        let rest_mm = self.rest_mm;
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
            return self.put_through(exit, limits);
        }
        let cruise2 = self.cruise2;
        if peak2 >= cruise2 {
            let down_mm = (cruise2 - exit2) * limits.per_twice_accel;
            let up_mm = (cruise2 - entry2) * limits.per_twice_accel;
            self.put_ramp(0.0, (self.cruise, exit), limits);
            self.put_cruise(rest_mm - down_mm - up_mm, down_mm);
            self.put_ramp(rest_mm - up_mm, (self.speed, self.cruise), limits);
        } else {
            let peak = root(peak2);
            let up_mm = (peak2 - entry2) * limits.per_twice_accel;
            self.put_ramp(0.0, (peak, exit), limits);
            self.put_ramp(rest_mm - up_mm, (self.speed, peak), limits);
        }
        // Whatever rounding has left out, the block ends where and as it should.
        if self.is_over() {
            (self.rest_mm, self.speed) = (0.0, exit);
        } else if let Some(last) = self.ramps.last_mut() {
            (last.rest_mm, last.speed) = (0.0, exit);
        }
    }

    /// From a speed above the greatest one: brakes to that, goes on with it, and brakes for the end; or brakes all the way.
    fn plan_down(&mut self, entry2: f32, (exit2, exit): (f32, f32), limits: &Limits) {
        let rest_mm = self.rest_mm;
        let cruise2 = self.cruise2;
        let first_mm = (entry2 - cruise2) * limits.per_twice_accel;
        let last_mm = greatest(cruise2 - exit2, 0.0) * limits.per_twice_accel;
        let cruise_mm = rest_mm - first_mm - last_mm;
        if exit2 > cruise2 * (1.0 + ALIKE) || !self.counts(cruise_mm) {
            return self.put_through(exit, limits);
        }
        self.put_ramp(0.0, (self.cruise, exit), limits);
        self.put_cruise(cruise_mm, last_mm);
        self.put_ramp(rest_mm - first_mm, (self.speed, self.cruise), limits);
        if let Some(last) = self.ramps.last_mut() {
            (last.rest_mm, last.speed) = (0.0, exit);
        }
    }

    /// Nothing is to come, up to the end with this square of a speed.
    fn begin_anew(&mut self, exit2: f32) {
        (self.exit2, self.left, self.next) = (exit2, 0, self.ramps.len());
    }

    /// Another greatest speed holds on what is left of the block.
    pub(super) fn cruise_at(&mut self, cruise2: f32) {
        (self.cruise2, self.cruise) = (cruise2, root(cruise2));
    }

    /// Whether a part of what is left of the block is longer than what rounding leaves.
    fn counts(&self, way_mm: f32) -> bool {
        way_mm > ROUNDING * self.rest_mm
    }

    /// Puts a change of speed all the way to the end: a little less hard than could be, and never harder. Where rounding would have it so,
    /// the place is left some last bits of the braking way before the end, or after it.
    fn put_through(&mut self, exit: f32, limits: &Limits) {
        let change = exit - self.speed;
        let duration_s = greatest(2.0 * self.rest_mm / (self.speed + exit), change.abs() * limits.per_accel);
        if duration_s > 0.0 {
            self.put(Ramp { duration_s, accel: change / duration_s, rest_mm: 0.0, speed: exit });
        }
    }

    /// Puts a change of speed at full acceleration before those put so far.
    fn put_ramp(&mut self, rest_mm: f32, (from, speed): (f32, f32), limits: &Limits) {
        let change = speed - from;
        if change.abs() > ROUNDING * greatest(from, speed) {
            let accel = limits.accel.copysign(change);
            let duration_s = change.abs() * limits.per_accel;
            self.put(Ramp { duration_s, accel, rest_mm, speed });
        }
    }

    /// Puts a way at the greatest speed before those put so far.
    fn put_cruise(&mut self, way_mm: f32, rest_mm: f32) {
        if self.counts(way_mm) {
            self.put(Ramp { duration_s: way_mm / self.cruise, accel: 0.0, rest_mm, speed: self.cruise });
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
        let way_mm = least(self.speed2() * limits.per_twice_accel, self.rest_mm);
        let is_short = self.forced2(limits) > 0.0;
        let (rest_mm, exit) = if is_short { (0.0, root(exit2)) } else { (self.rest_mm - way_mm, 0.0) };
        self.begin_anew(exit2);
        self.put_ramp(rest_mm, (self.speed, exit), limits);
        if self.is_over() {
            (self.rest_mm, self.speed) = (rest_mm, exit);
        }
    }

    /// Square of the speed at the end of the block, however hard it brakes from here on: no more than was planned, whatever the rounding.
    pub(super) fn forced2(&self, limits: &Limits) -> f32 {
        greatest(least(self.speed2() - 2.0 * limits.accel * self.rest_mm, self.exit2), 0.0)
    }

    /// Square of the speed at the end of the phases taken.
    pub(super) fn speed2(&self) -> f32 {
        self.speed * self.speed
    }

    /// How much of the block is left.
    pub(super) const fn rest_mm(&self) -> f32 {
        self.rest_mm
    }

    /// Whether no phase is left, be it that the machine was held in the middle.
    pub(super) const fn is_over(&self) -> bool {
        self.next >= self.ramps.len()
    }

    /// The next phase. Those of a ramp are alike, and what is left of it is told by their number: nothing adds up, and it ends.
    pub(super) fn next(&mut self) -> Option<Phase> {
        let ramp = *self.ramps.get(self.next)?;
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

    /// The next phase, and how many like it are left of the ramp, with it: all of them are taken.
    pub(super) fn next_whole(&mut self) -> Option<(Phase, u32)> {
        let ramp = *self.ramps.get(self.next)?;
        let phase = self.phase(&ramp);
        let count = core::mem::take(&mut self.left);
        self.next += 1;
        (self.speed, self.rest_mm) = (ramp.speed, ramp.rest_mm);
        Some((phase, count))
    }

    /// The next phase of the ramp under way.
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

/// How many phases a time is, at least one; no more than a `u32` counts.
fn phases(duration_s: f32) -> u32 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole ones, saturating; no time is below 0"
    )]
    let whole = (duration_s * PER_LONGEST) as u32;
    whole.saturating_add(1)
}

/// To the last bit of an `f32`.
#[expect(clippy::cast_precision_loss, reason = "as it says")]
fn number(phases: u32) -> f32 {
    phases as f32
}

#[cfg(test)]
mod tests {
    use super::super::{AllModes, PlannerSettings, Shape};
    use super::*;
    use crate::{Pen, Point};

    fn ramps(length_mm: f32, speed_mm_s: f32) -> Ramps {
        let limits = Limits::of(&PlannerSettings::default());
        let to = Point::new(length_mm.into(), 0.0);
        let cruise2 = speed_mm_s * speed_mm_s;
        let mut block = Block::path(Shape::Line, to, length_mm, Pen::Down, 0, cruise2);
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
            assert_eq!(ramps.next().map(|phase| phase.from_mm), Some(0.0));
            // The cruise.
            let first = ramps.next().unwrap();
            let all = ramps.left;
            let time_s = f64::from(first.duration_s) * (f64::from(all) + 1.0);
            let due_s = f64::from(length_mm) / f64::from(speed_mm_s);
            assert!((time_s / due_s - 1.0).abs() < 1e-6, "{time_s} s for {due_s} s");
            for left in [all / 2, 100_000, 100, 3] {
                ramps.left = left;
                let before = ramps.next().unwrap();
                let phase = ramps.next().unwrap();
                let rest_mm = length_mm * (number(left) / number(all));
                assert!((length_mm - phase.from_mm - rest_mm).abs() <= 2e-7 * length_mm, "{before:?}");
                assert_eq!((phase.duration_s, phase.speed_mm_s), (first.duration_s, speed_mm_s));
            }
            // One more of the cruise, and the stop.
            assert!(ramps.next().is_some() && ramps.next().is_some() && ramps.next().is_none());
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
