//! [`ShaftMotion`]: place and speed of a shaft from the edges of its encoder, for estimators that differ in what else they
//! believe of it.

use crate::{Decoding, Direction};

/// The first two states of an estimator, and what an edge, or none, says of them. The third is its owner's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ShaftMotion {
    pub(super) decoding: Decoding,
    observer_rad_s: f32,
    /// Count of the interval the shaft is in.
    pub(super) count: i32,
    /// Place relative to `count`, in counts.
    pub(super) offset: f32,
    pub(super) speed: f32,
    /// Least and greatest `offset` since the last edge.
    pub(super) least: f32,
    pub(super) most: f32,
    since_correction_s: f32,
}

/// How much of a difference a filter takes, by the time since it took the last.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fading {
    /// `1 - z` with `z = exp(-2 pi f T)`.
    pub(super) fade: f32,
    /// T, s.
    pub(super) t: f32,
}

impl ShaftMotion {
    /// A shaft at rest in the middle of count 0.
    pub(super) const fn at_rest(decoding: Decoding, observer_rad_s: f32) -> Self {
        let offset = decoding.rest_offset_counts();
        Self {
            decoding,
            observer_rad_s,
            count: 0,
            offset,
            speed: 0.0,
            least: offset,
            most: offset,
            since_correction_s: 0.0,
        }
    }

    /// How far the shaft is from the resting place of `count`, in counts.
    pub(super) fn distance_from(&self, count: i32) -> f32 {
        #[expect(clippy::cast_precision_loss, reason = "a checked machine has at most 99999 counts")]
        let whole = self.count.saturating_sub(count) as f32;
        whole + (self.offset - self.decoding.rest_offset_counts())
    }

    /// Time passes, whether the shaft turns or not.
    pub(super) fn wait(&mut self, dt_s: f32) {
        self.since_correction_s += dt_s;
    }

    /// Turns on for `dt_s` under a constant acceleration, of which friction against `sense` is a part, and a damping.
    pub(super) fn turn(&mut self, dt_s: f32, accel: f32, sense: f32, damping_per_s: f32) {
        // exact for a constant push: the speed tends to accel / damping with the time constant 1 / damping
        let decay = libm::expf(-damping_per_s * dt_s);
        let last = accel / damping_per_s;
        let next = last + (self.speed - last) * decay;
        if next * sense < 0.0 && self.speed != 0.0 {
            // friction stops the shaft on the way: it covers half of what it would at this speed until then
            self.offset += self.speed * self.speed / (self.speed - next) * dt_s / 2.0;
            self.speed = 0.0;
        } else {
            self.offset += last * dt_s + (self.speed - last) * ((1.0 - decay) / damping_per_s);
            self.speed = next;
        }
        self.least = self.least.min(self.offset);
        self.most = self.most.max(self.offset);
    }

    /// Goes into the interval that an edge leads into; gives the edge's place there. What is corrected then
    /// ends with [`stands_at`](Self::stands_at).
    pub(super) fn enter(&mut self, direction: Direction) -> f32 {
        let (count, place) = self.edge_place(direction);
        #[expect(clippy::cast_precision_loss, reason = "0, 1 or -1")]
        let moved = count.saturating_sub(self.count) as f32;
        self.count = count;
        self.offset -= moved;
        place
    }

    /// The place nearest to where it is thought to be at which no edge would have come; `None` if it is there.
    pub(super) fn without_edge(&self) -> Option<f32> {
        let (least, most) = match self.decoding {
            Decoding::X1 => (-0.5, 1.0),
            Decoding::X2 | Decoding::X4 => (0.0, 1.0),
        };
        let inside = self.offset.clamp(least, most);
        (inside != self.offset).then_some(inside)
    }

    /// From here on it is known to have been at `place` only.
    pub(super) const fn stands_at(&mut self, place: f32) {
        (self.least, self.most) = (place, place);
    }

    /// From here on it stands where it is thought to be.
    pub(super) const fn stands(&mut self) {
        self.speed = 0.0;
        self.stands_at(self.offset);
    }

    /// The same, in A's high half if its encoder is an x1.
    pub(super) fn rests(&mut self) {
        if self.decoding == Decoding::X1 {
            self.offset = self.offset.clamp(0.0, 0.5);
        }
        self.stands();
    }

    /// The count after an edge, and the edge's place relative to it.
    fn edge_place(&self, direction: Direction) -> (i32, f32) {
        // How far beyond an edge the estimate must have been for it to be met a second time.
        const BEYOND_COUNTS: f32 = 0.1;
        let next = self.count.saturating_add(direction.sign());
        match (self.decoding, direction) {
            (Decoding::X2 | Decoding::X4, Direction::Plus) => (next, 0.0),
            (Decoding::X2 | Decoding::X4, Direction::Minus) => (next, 1.0),
            // Forwards the counted edge is the start of A's high half, backwards its end.
            (Decoding::X1, Direction::Plus) => {
                let again = self.least < -BEYOND_COUNTS && self.offset < 0.5;
                (if again { self.count } else { next }, 0.0)
            }
            (Decoding::X1, Direction::Minus) => {
                let again = self.most > 0.5 + BEYOND_COUNTS && self.offset > 0.0;
                (if again { self.count } else { next }, 0.5)
            }
        }
    }

    /// Takes a measured difference into place and speed; says what the third state may take of it.
    pub(super) fn correct(&mut self, difference: f32) -> Fading {
        const SHORTEST_S: f32 = 2e-5; // below a few timer ticks a difference says nothing of the speed
        let t = self.since_correction_s.max(SHORTEST_S);
        let z = libm::expf(-self.observer_rad_s * t);
        let fade = 1.0 - z;
        self.offset += difference * (1.0 - z * z * z);
        self.speed += difference * 1.5 * fade * fade * (1.0 + z) / t;
        self.since_correction_s = 0.0;
        Fading { fade, t }
    }
}
