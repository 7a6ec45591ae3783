//! [`Ramps`]: the phases of a block with constant accelerations.

use super::Phase;
use super::block::Block;

/// Longest phase, s: a feed hold begins to act after that time at the latest.
pub(super) const LONGEST_S: f64 = 0.05;

/// A shorter part of a block is what rounding leaves between two ramps: its acceleration would be noise.
const ROUNDING: f64 = 1e-12;

/// A way with a constant acceleration: to a place on the block, which is passed with a speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ramp {
    end_mm: f64,
    speed: f64,
}

/// Speeding up, cruising, braking: what is left of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramps {
    length_mm: f64,
    cruise2: f64,
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
        done_mm: 0.0,
        speed: 0.0,
        ramps: [Ramp { end_mm: 0.0, speed: 0.0 }; 3],
        next: usize::MAX,
    };

    /// The quickest way along a block that leaves it with the given square of a speed.
    pub(super) fn new(block: &Block, exit2: f64, accel_mm_s2: f64) -> Self {
        let (length_mm, cruise2) = (block.length(), f64::from(block.cruise2));
        if !(block.is_path() && length_mm > 0.0 && cruise2 > 0.0) {
            return Self::OVER;
        }
        let speed = libm::sqrt(f64::from(block.entry2));
        let mut ramps = Self { length_mm, cruise2, speed, ..Self::OVER };
        ramps.plan(exit2, accel_mm_s2);
        ramps
    }

    /// Plans what is left of the block.
    pub(super) fn plan(&mut self, exit2: f64, accel_mm_s2: f64) {
        let (rest_mm, entry2) = (self.rest_mm(), self.speed * self.speed);
        // Where speeding up and braking meet.
        let peak2 = (0.5 * (entry2 + exit2) + accel_mm_s2 * rest_mm).min(self.cruise2).max(entry2).max(exit2);
        let up_mm = ((peak2 - entry2) / (2.0 * accel_mm_s2)).min(rest_mm);
        let down_mm = ((peak2 - exit2) / (2.0 * accel_mm_s2)).min(rest_mm - up_mm);
        let (peak, exit) = (libm::sqrt(peak2), libm::sqrt(exit2));
        self.ramps = [
            Ramp { end_mm: self.done_mm + up_mm, speed: peak },
            Ramp { end_mm: self.length_mm - down_mm, speed: peak },
            Ramp { end_mm: self.length_mm, speed: exit },
        ];
        self.next = 0;
    }

    /// Plans to stop as soon as can be. Gives the square of the speed at the end of the block: above 0 when it is too short.
    pub(super) fn brake(&mut self, accel_mm_s2: f64) -> f64 {
        let exit2 = self.speed * self.speed - 2.0 * accel_mm_s2 * self.rest_mm();
        let end_mm = self.done_mm + self.speed * self.speed / (2.0 * accel_mm_s2);
        let end = Ramp { end_mm: end_mm.min(self.length_mm), speed: libm::sqrt(exit2.max(0.0)) };
        self.ramps = [end; 3];
        self.next = 2;
        exit2.max(0.0)
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
        while let Some(&Ramp { end_mm, speed }) = self.ramps.get(self.next) {
            let (way_mm, from_mm, from) = (end_mm - self.done_mm, self.done_mm, self.speed);
            if way_mm > ROUNDING * self.length_mm && from + speed > 0.0 {
                let whole_s = 2.0 * way_mm / (from + speed);
                let accel_mm_s2 = (speed - from) / whole_s;
                let duration_s = whole_s.min(LONGEST_S);
                if duration_s < whole_s {
                    self.done_mm += duration_s * (from + 0.5 * accel_mm_s2 * duration_s);
                    self.speed += accel_mm_s2 * duration_s;
                } else {
                    self.next += 1;
                    (self.done_mm, self.speed) = (end_mm, speed);
                }
                return Some(Phase { duration_s, from_mm, speed_mm_s: from, accel_mm_s2, jerk_mm_s3: 0.0 });
            }
            self.next += 1;
            (self.done_mm, self.speed) = (end_mm, speed);
        }
        None
    }
}
