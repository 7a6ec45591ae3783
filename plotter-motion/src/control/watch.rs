//! [`Watch`]: whether what an encoder says can be true of a shaft under such a drive.

use crate::{Axis, Direction};
use core::fmt;

/// Faults of an axis that its encoder and its drive show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Trouble {
    /// The motor does not move under a drive that overcomes any friction. It is released, and tried again
    /// after longer and longer pauses.
    Held,
    /// The motor turns against its drive, faster and faster. Both motors are left without drive.
    WrongWay,
    /// The encoder's edges come as no shaft can turn, so the position is lost. Both motors are left without
    /// drive.
    Encoder,
    /// The motor answers its drive differently than a moment ago. Control continues with its new behaviour.
    Changed,
}

impl Trouble {
    /// Whether nothing may be driven any more.
    #[must_use]
    pub const fn stops(self) -> bool {
        matches!(self, Self::WrongWay | Self::Encoder)
    }
}

/// An axis and what is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct AxisTrouble {
    /// The axis.
    pub axis: Axis,
    /// The fault.
    pub trouble: Trouble,
}

impl fmt::Display for AxisTrouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = match self.axis {
            Axis::X => 'x',
            Axis::Y => 'y',
        };
        match self.trouble {
            Trouble::Held => write!(
                f,
                "motor {axis} is driven and does not turn: something holds it, or its encoder is silent; trying again"
            ),
            Trouble::WrongWay => write!(
                f,
                "motor {axis} turns against its drive: stopped; are its two wires, or the encoder's two phases, crossed?"
            ),
            Trouble::Encoder => write!(
                f,
                "the encoder of motor {axis} counts what no shaft can turn: stopped; home the machine, and look at its wires"
            ),
            Trouble::Changed => write!(
                f,
                "motor {axis} answers its drive otherwise than before: going on; is the supply or the load another one?"
            ),
        }
    }
}

/// Looks for what no shaft does.
///
/// Edges may be told late, several at once, or to the nearest tenth of a millisecond: nothing is concluded
/// from one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Watch {
    /// Speed and way since the last edge of a shaft that is harder to turn than any description says,
    /// counts/s and counts; while it is tried again, of one that nothing holds.
    slowest: [f32; 2],
    since_edge_s: f32,
    /// Which way the shaft went at the last edge: 1 or -1; how many edges it has gone that way since the last
    /// of `times_s` ended.
    sense: f32,
    edges: u8,
    /// How long the last rows of [`ROW`] edges one way took, s, the present one first; 0 where there was
    /// none.
    times_s: [f32; 3],
    /// The time before the last edge, s, and how many edges in a row came in pairs.
    before_s: f32,
    pairs: u8,
    /// The greatest drive one way and the other since the row before the last began, counts/s^2.
    drives: [f32; 2],
    /// For how long it has turned against its drive, s, and what speed that took from it, counts/s; how many
    /// edges came meanwhile, and the time between the first two of them.
    against_s: f32,
    taken: f32,
    against: u8,
    first_s: f32,
    /// How many times its friction, as it is believed, it took to move the shaft after it was held.
    stiffness: f32,
    /// How many times in a row it did not move, and for how long it is let alone now.
    tries: u8,
    pause_s: f32,
    /// How long a change is told.
    changed_s: f32,
    stopped: Option<Trouble>,
}

/// Edges whose time is looked at together: then one that is late by itself does not matter.
const ROW: u8 = 4;

/// What brakes a shaft at the most, as so many times what the whole supply does at rest: twice that brakes a
/// motor at its greatest speed, friction adds to it, and all of it may be known badly.
const MOST_BRAKING: f32 = 6.0;

impl Watch {
    pub(super) const NOTHING: Self = Self {
        slowest: [0.0; 2],
        since_edge_s: 0.0,
        sense: 0.0,
        edges: 0,
        times_s: [0.0; 3],
        before_s: 0.0,
        pairs: 0,
        drives: [0.0; 2],
        against_s: 0.0,
        taken: 0.0,
        against: 0,
        first_s: 0.0,
        stiffness: 1.0,
        tries: 0,
        pause_s: 0.0,
        changed_s: 0.0,
        stopped: None,
    };

    /// What is wrong now.
    pub(super) const fn trouble(&self) -> Option<Trouble> {
        if let Some(stopped) = self.stopped {
            Some(stopped)
        } else if self.tries > 0 {
            Some(Trouble::Held)
        } else if self.changed_s > 0.0 {
            Some(Trouble::Changed)
        } else {
            None
        }
    }

    /// Whether the shaft is to be left without drive.
    pub(super) const fn lets_go(&self) -> bool {
        self.stopped.is_some() || self.pause_s > 0.0
    }

    /// Somebody wants it to move again: what stopped it may be mended.
    pub(super) const fn start(&mut self) {
        *self = Self::NOTHING;
    }

    /// The motor was found to be another one.
    pub(super) const fn changed(&mut self) {
        const TOLD_S: f32 = 0.2;
        self.changed_s = TOLD_S;
    }

    /// The greatest acceleration that a shaft which did not move is tried with, counts/s^2: it grows from one
    /// try to the next. `None` for any.
    pub(super) fn most_accel(&self, dry_friction: f32) -> Option<f32> {
        (self.tries > 0).then(|| self.tried() * dry_friction)
    }

    fn tried(&self) -> f32 {
        self.stiffness + f32::from(self.tries)
    }

    /// Time passes under a drive of `accel` counts/s^2 against a dry friction.
    pub(super) fn pass(&mut self, dt_s: f32, accel: f32, dry_friction: f32) {
        // A shaft of so little of the acceleration and so much of the friction that are believed is beyond
        // all that a description or a supply that sags can be wrong by. If that one had gone so far, this one
        // is held.
        const SLOWEST: [f32; 3] = [0.4, 2.5, 2.0];
        // After a while without an edge the doubt is on the other side: what is let go for nothing is tried
        // again at once.
        const LATE_S: f32 = 0.03;
        const SLOW: [f32; 3] = [0.7, 1.5, 2.0];
        // A try ends when a shaft that nothing holds had gone so far: without an edge nobody knows that it
        // does not.
        const TRIED: [f32; 3] = [1.0, 1.0, 8.0];
        // The first pause, s; each is twice as long as the one before.
        const PAUSE_S: f32 = 0.05;
        const MOST_DOUBLINGS: u8 = 8;
        self.since_edge_s += dt_s;
        self.note_drive(dt_s, accel, dry_friction);
        self.changed_s = (self.changed_s - dt_s).max(0.0);
        if self.pause_s > 0.0 {
            self.pause_s -= dt_s;
            return;
        }
        let [push, friction, counts] = match self.tries {
            0 if self.since_edge_s < LATE_S => SLOWEST,
            0 => SLOW,
            1.. => TRIED,
        };
        let [speed, way] = &mut self.slowest;
        let friction = friction * self.stiffness * dry_friction;
        *speed = (*speed + (push * accel.abs() - friction) * dt_s).max(0.0);
        *way += *speed * dt_s;
        if *way > counts {
            self.slowest = [0.0; 2];
            self.pause_s = PAUSE_S * f32::from(1_u16 << self.tries.min(MOST_DOUBLINGS));
            self.tries = self.tries.saturating_add(1);
        }
    }

    fn note_drive(&mut self, dt_s: f32, accel: f32, dry_friction: f32) {
        let [forwards, backwards] = &mut self.drives;
        *forwards = forwards.max(accel);
        *backwards = backwards.max(-accel);
        // A drive of less than this share of the friction drives nothing.
        const SHARE: f32 = 0.5;
        if accel * self.sense < -SHARE * dry_friction {
            self.against_s += dt_s;
            self.taken += accel.abs() * dt_s;
        } else {
            (self.against_s, self.taken, self.against) = (0.0, 0.0, 0);
        }
    }

    /// An edge came; `most_accel` is what the whole supply does, and `braking` what friction and damping
    /// take, counts/s^2; by a share `doubt` all of it may be wrong.
    pub(super) fn edge(&mut self, direction: Direction, most_accel: f32, braking: f32, doubt: f32) {
        #[expect(clippy::cast_precision_loss, reason = "1 or -1")]
        let sense = direction.sign() as f32;
        let since_s = self.since_edge_s;
        let most_braking = MOST_BRAKING * most_accel;
        if sense == self.sense {
            self.looks_for_pairs(since_s, most_braking);
            self.goes_on(since_s, braking, doubt);
        } else {
            self.pairs = 0;
            self.turns(since_s, most_braking);
        }
        self.sense = sense;
        if self.tries > 0 {
            self.stiffness = self.tried();
        }
        (self.slowest, self.since_edge_s, self.tries, self.pause_s) = ([0.0; 2], 0.0, 0, 0.0);
    }

    /// Whether edges come two by two, as where each is counted twice. A shaft that is hard to move turns by
    /// jerks, too, but from one to the next it has to come to rest.
    fn looks_for_pairs(&mut self, since_s: f32, most_braking: f32) {
        // A loop that looks for edges tells some two by two as well. One that looks each tenth of a
        // millisecond, as contouring wants it, makes no gaps of so many seconds.
        const LEAST_GAP_S: f32 = 4e-4;
        // A gap to a time within a pair: the marks of a bad encoder are off by a quarter.
        const UNEVEN: f32 = 8.0;
        const SURE_EDGES: u8 = 8;
        let [short_s, long_s] =
            if since_s < self.before_s { [since_s, self.before_s] } else { [self.before_s, since_s] };
        self.before_s = since_s;
        // So fast it goes on for more than a count, whatever brakes it.
        let is_fast = most_braking * short_s * short_s < 0.5;
        let is_pair = is_fast && UNEVEN * short_s < long_s && long_s > LEAST_GAP_S;
        self.pairs = if is_pair { self.pairs + 1 } else { 0 };
        if self.pairs >= SURE_EDGES {
            (self.pairs, self.stopped) = (0, Some(Trouble::Encoder));
        }
    }

    /// Another edge the same way.
    fn goes_on(&mut self, since_s: f32, braking: f32, doubt: f32) {
        // A drive of so little of what is believed takes all the speed from a shaft that comes on by itself.
        // One that still comes on is driven there.
        const LEAST: f32 = 0.3;
        const SURE_EDGES: u8 = 3;
        if self.against_s >= since_s {
            self.against = self.against.saturating_add(1);
            if self.against == 1 {
                self.first_s = since_s;
            }
            if self.against >= SURE_EDGES && LEAST * self.taken * self.first_s > 1.0 {
                self.stopped = Some(Trouble::WrongWay);
            }
        }
        let [now_s, before_s, old_s] = &mut self.times_s;
        *now_s += since_s;
        self.edges += 1;
        if self.edges < ROW {
            return;
        }
        // Beyond what its drive had left for it and so many times what is not known of both lies no shaft's
        // gain of speed.
        const MOST_DOUBTS: f32 = 4.0;
        // Edges that are told late by themselves do not make a row of four so much shorter.
        const SOONER: f32 = 0.6;
        if *old_s > 0.0 && *now_s < SOONER * *old_s {
            let speed = |time_s: f32| f32::from(ROW) / time_s;
            let gained = speed(*now_s) - speed(*old_s);
            let time_s = 0.5 * *now_s + *before_s + 0.5 * *old_s;
            let [forwards, backwards] = self.drives;
            let drive = if self.sense > 0.0 { forwards } else { backwards };
            let most = (drive - braking).max(0.0) + MOST_DOUBTS * doubt * (drive + braking);
            if gained > most * time_s {
                self.stopped = Some(Trouble::Encoder);
            }
        }
        (self.times_s, self.edges) = ([0.0, *now_s, *before_s], 0);
        if self.times_s[2] == 0.0 {
            self.drives = [0.0; 2];
        }
    }

    /// An edge the other way.
    fn turns(&mut self, since_s: f32, most_braking: f32) {
        let [_, before_s, _] = self.times_s;
        if before_s > 0.0 {
            let speed = f32::from(ROW) / before_s;
            if speed > most_braking * (since_s + 0.5 * before_s) {
                self.stopped = Some(Trouble::Encoder);
            }
        }
        (self.times_s, self.edges, self.drives) = ([0.0; 3], 0, [0.0; 2]);
        (self.against_s, self.taken, self.against) = (0.0, 0.0, 0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges two by two, `short_s` apart and each pair 40 ms after the last, of a motor that brakes with 1e5
    /// counts/s^2 at the supply.
    fn in_pairs(short_s: f32) -> Option<Trouble> {
        let mut watch = Watch::NOTHING;
        for edge in 0..40 {
            watch.pass(if edge % 2 == 0 { 0.04 } else { short_s }, 0.0, 1e4);
            watch.edge(Direction::Plus, 1e5, 1e4, 0.3);
        }
        watch.trouble()
    }

    #[test]
    fn a_shaft_that_turns_by_jerks_has_no_bad_encoder() {
        // 250 counts/s, from which six times the supply brakes within 0.05 counts
        assert_eq!(in_pairs(4e-3), None);
        // 10,000 counts/s: that takes 83 counts
        assert_eq!(in_pairs(1e-4), Some(Trouble::Encoder));
    }
}
