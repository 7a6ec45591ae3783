//! [`ShaftMotion`]: place and speed of a shaft from the edges of its encoder, for estimators that differ in
//! what else they believe of it.

use crate::{Direction, config::Decoding};

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
    since_correction_s: f32,
    /// How far beyond an edge it was thought to be that has not come, counts.
    overrun: f32,
    /// How far `speed` may be off, counts/s, since the last edge said how fast it was.
    speed_doubt: f32,
    /// The same of a shaft that would have met an edge if it were so much faster: its place is known by that.
    /// What holds a shaft and lets it go is no even motion, so a drive goes by `speed_doubt`.
    even_doubt: f32,
    /// How far `offset` may be off, counts, since the last edge said where it was.
    place_doubt: f32,
    /// Where it was when that was last known, relative to `count`: at an edge, or at rest.
    from: f32,
    /// Whether it may have gone up or down from there.
    up: bool,
    down: bool,
    /// Whether it rests so near to the upper or the lower end of A's high half that it may be on either side
    /// of it.
    at_upper: bool,
    at_lower: bool,
    /// Twice a count, the way from edge to edge: sped up evenly from rest it is at its end twice as fast as in
    /// the mean. No bound where pulses move it, between which it slows down or stands.
    even_counts: f32,
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
            since_correction_s: 0.0,
            overrun: 0.0,
            speed_doubt: 0.0,
            even_doubt: 0.0,
            place_doubt: 0.0,
            from: offset,
            up: false,
            down: false,
            at_upper: false,
            at_lower: false,
            even_counts: 2.0,
        }
    }

    /// Pulses move it, from jerk to jerk.
    pub(super) const fn in_jerks(&mut self) {
        self.even_counts = f32::INFINITY;
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

    /// Turns on for `dt_s` under a constant acceleration, of which friction against `sense` is a part, and a
    /// damping.
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
    }

    /// Whether it turns towards `sense` for certain.
    pub(super) fn surely_turns(&self, sense: f32) -> bool {
        self.speed * sense > self.speed_doubt * sense.abs()
    }

    /// Pulses push it on by so many counts, and it stands between them.
    pub(super) fn creeps(&mut self, counts: f32) {
        self.offset += counts;
        self.up |= counts > 0.0;
        self.down |= counts < 0.0;
    }

    /// Takes note of a drive of `accel` counts/s^2 against a dry friction; says whether it may have turned
    /// the shaft round.
    pub(super) fn may_turn_under(&mut self, accel: f32, dry_friction: f32) -> bool {
        // A push of less than this share of the friction as it is known moves no shaft.
        const SHARE: f32 = 0.5;
        if accel.abs() > SHARE * dry_friction && !self.surely_turns(-accel) {
            self.up |= accel > 0.0;
            self.down |= accel < 0.0;
        }
        self.up && self.down
    }

    /// Its acceleration may be off by so much, counts/s^2, for `dt_s`.
    pub(super) fn doubts(&mut self, accel: f32, dt_s: f32) {
        self.place_doubt += (self.even_doubt + 0.5 * accel * dt_s) * dt_s;
        self.even_doubt += accel * dt_s;
        self.speed_doubt += accel * dt_s;
    }

    /// Whether an edge in this direction is the next one for certain.
    pub(super) fn goes_on(&self, direction: Direction) -> bool {
        match direction {
            Direction::Plus => self.up && !self.down,
            Direction::Minus => self.down && !self.up,
        }
    }

    /// Goes into the interval that an edge leads into; gives the edge's place there.
    pub(super) fn enter(&mut self, direction: Direction) -> f32 {
        let (count, place) = self.edge_place(direction);
        (self.up, self.down) = (direction == Direction::Plus, direction == Direction::Minus);
        (self.at_upper, self.at_lower) = (false, false);
        #[expect(clippy::cast_precision_loss, reason = "0, 1 or -1")]
        let counts = count.saturating_sub(self.count) as f32;
        (self.count, self.from, self.place_doubt) = (count, place, 0.0);
        self.offset -= counts;
        place
    }

    /// No edge has come: it is still between those next to it. Says whether it was thought to be beyond one.
    ///
    /// That it is late says that it was slower since the last edge, by what it is short of over that time.
    /// That it has not come where the shaft should have long been far beyond it says that something holds the
    /// shaft.
    pub(super) fn without_edge(&mut self, dry_friction: f32) -> bool {
        // So far beyond the edge it would have to be, counts, if nothing held it.
        const HELD_COUNTS: f32 = 1.5;
        let (least, most) = match self.decoding {
            // up from below A's high half there is an edge at its start, down from above it one at its end
            Decoding::X1 if self.up && !self.down => {
                (self.from, if self.from < 0.0 && !self.at_lower { 0.0 } else { 1.0 })
            }
            Decoding::X1 if self.down && !self.up => {
                (if self.from > 0.5 && !self.at_upper { 0.5 } else { -0.5 }, self.from)
            }
            Decoding::X1 => (-0.5, 1.0),
            Decoding::X2 | Decoding::X4 => (0.0, 1.0),
        };
        // Sped up evenly it would have left its interval by now.
        let evenly = self.even_counts / self.since_correction_s;
        if self.even_doubt > evenly {
            self.even_doubt = evenly;
        }
        let inside = self.offset.clamp(least, most);
        let beyond = self.offset - inside;
        if beyond == 0.0 {
            return false;
        }
        self.offset = inside;
        self.overrun += beyond.abs();
        if self.overrun > HELD_COUNTS + self.speed.abs() / self.observer_rad_s {
            self.overrun = 0.0;
            self.stands(dry_friction);
        } else {
            let (_, speed_gain, _) = self.gains();
            self.speed -= speed_gain * beyond;
        }
        true
    }

    /// From here on it stands, as near to where it is thought to be as its speed was known: a dry friction
    /// brought it to rest.
    ///
    /// So near to an edge it may stand on either side of it, and meet it however it goes on.
    pub(super) const fn stands(&mut self, dry_friction: f32) {
        if self.even_doubt > 0.0 {
            self.place_doubt += self.even_doubt * self.even_doubt / (2.0 * dry_friction);
        }
        (self.speed, self.speed_doubt, self.even_doubt, self.from) = (0.0, 0.0, 0.0, self.offset);
        if matches!(self.decoding, Decoding::X1) {
            // It came from below to the upper end, and from above to the lower one: from the other side it
            // would have met them.
            self.at_upper = (self.up || self.at_upper) && (self.offset - 0.5).abs() <= self.place_doubt;
            self.at_lower = (self.down || self.at_lower) && self.offset.abs() <= self.place_doubt;
        }
        (self.up, self.down) = (false, false);
    }

    /// The count after an edge, and the edge's place relative to it.
    fn edge_place(&self, direction: Direction) -> (i32, f32) {
        let next = self.count.saturating_add(direction.sign());
        let place = match direction {
            Direction::Plus => 0.0,
            Direction::Minus => match self.decoding {
                Decoding::X1 => 0.5,
                Decoding::X2 | Decoding::X4 => 1.0,
            },
        };
        // Between the edge that it may have rested at and the next one is at least a whole count of way, and
        // a slow shaft's way is known to a third of it.
        const AT_ONCE_COUNTS: f32 = 0.25;
        // One way only, it met the first edge on its way; from a rest at an edge that one at once or not at
        // all. Else it met the one that is nearer to where it is thought to be.
        let is_next = match (self.decoding, direction) {
            (Decoding::X2 | Decoding::X4, _) => true,
            (Decoding::X1, Direction::Plus) if !self.down && self.at_lower => {
                self.offset > self.from + AT_ONCE_COUNTS
            }
            (Decoding::X1, Direction::Minus) if !self.up && self.at_upper => {
                self.offset < self.from - AT_ONCE_COUNTS
            }
            (Decoding::X1, Direction::Plus) if !self.down => self.from >= 0.0,
            (Decoding::X1, Direction::Minus) if !self.up => self.from <= 0.5,
            (Decoding::X1, Direction::Plus) => self.offset >= 0.5,
            (Decoding::X1, Direction::Minus) => self.offset <= 0.0,
        };
        (if is_next { next } else { self.count }, place)
    }

    /// Takes a measured difference into place and speed; says what the third state may take of it.
    pub(super) fn correct(&mut self, difference: f32, share: f32) -> Fading {
        let (place_gain, speed_gain, fading) = self.gains();
        self.offset += difference * place_gain;
        self.speed += share * difference * speed_gain;
        (self.since_correction_s, self.overrun) = (0.0, 0.0);
        self.speed_doubt *= 0.5;
        self.even_doubt *= 0.5;
        fading
    }

    /// What of a difference place and speed take, and what an acceleration may take of it.
    fn gains(&self) -> (f32, f32, Fading) {
        let t = self.since_correction_s.max(SHORTEST_S);
        let z = libm::expf(-self.observer_rad_s * t);
        let fade = 1.0 - z;
        (1.0 - z * z * z, 1.5 * fade * fade * (1.0 + z) / t, Fading { fade, t })
    }
}

/// Below a few timer ticks a difference says nothing of the speed, s.
const SHORTEST_S: f32 = 2e-5;

#[cfg(test)]
mod tests {
    use super::*;

    const FRICTION: f32 = 1e5;

    /// A shaft that came up into count 1 and rests where it was thought to be within 0.03 counts.
    fn rests_at(offset: f32) -> ShaftMotion {
        let mut motion = ShaftMotion::at_rest(Decoding::X1, 900.0);
        motion.enter(Direction::Plus);
        motion.doubts(3e3, 4.5e-3); // 3000 * 0.0045^2 / 2 = 0.03 counts, and 13.5 counts/s
        motion.offset = offset;
        motion.stands(FRICTION);
        motion
    }

    /// The count after an edge that comes `way` counts down from the rest.
    fn count_after_an_edge_down(mut motion: ShaftMotion, way: f32) -> i32 {
        motion.may_turn_under(-FRICTION, FRICTION);
        motion.offset -= way;
        motion.enter(Direction::Minus);
        motion.count
    }

    /// A rises on the way down at 0.5 of a count, and on the way up at 0: a shaft that rests about 0.5 may
    /// have 0.5 or -0.5 next.
    #[test]
    fn a_shaft_that_rests_at_an_edge_meets_it_at_once_or_not_at_all() {
        for offset in [0.48, 0.497, 0.5, 0.52] {
            assert_eq!(count_after_an_edge_down(rests_at(offset), 0.01), 1, "{offset}");
            assert_eq!(count_after_an_edge_down(rests_at(offset), 0.4), 0, "{offset}");
        }
        // surely below it, and surely above it
        assert_eq!(count_after_an_edge_down(rests_at(0.44), 0.01), 0);
        assert_eq!(count_after_an_edge_down(rests_at(0.56), 0.06), 1);
        assert_eq!(count_after_an_edge_down(rests_at(0.56), 0.4), 1);
    }

    /// Pushed with about what friction holds, a shaft takes 14 ms to its edge: what its acceleration may be
    /// off by would make 4200 counts/s of that, and it had passed many edges by then.
    #[test]
    fn a_slow_shaft_is_known_to_be_slow() {
        let slow = |in_jerks| {
            let mut motion = ShaftMotion::at_rest(Decoding::X1, 900.0);
            if in_jerks {
                motion.in_jerks();
            }
            motion.enter(Direction::Plus);
            motion.offset = 0.3;
            for _ in 0..35 {
                motion.wait(4e-4);
                motion.doubts(3.0 * FRICTION, 4e-4);
                motion.without_edge(FRICTION);
            }
            motion.even_doubt
        };
        assert!((slow(false) - 2.0 / 14e-3).abs() < 1.0, "{}", slow(false));
        // pulses may have left it standing till the last one
        assert!((slow(true) - 4200.0).abs() < 1.0, "{}", slow(true));
    }

    #[test]
    fn a_shaft_that_has_just_met_an_edge_does_not_meet_it_again_on_the_same_way() {
        let mut motion = rests_at(0.25);
        motion.may_turn_under(-FRICTION, FRICTION);
        motion.enter(Direction::Minus); // count 0, at its 0.5
        motion.offset = 0.5;
        motion.stands(FRICTION);
        assert_eq!(count_after_an_edge_down(motion, 0.01), -1);
    }
}
