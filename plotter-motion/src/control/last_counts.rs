//! [`LastCounts`]: how a shaft gets to rest in its target's count, whatever holds it.

use super::shaft_motion::ShaftMotion;
use crate::config::Decoding;

/// The end of a line on one axis.
///
/// A control law may hunt about the last counts for ever: it breaks a shaft loose with more than keeps it
/// going, and carries it past the target, again and again. So the last counts are gone one by one. A shaft
/// that stands is pushed harder and harder towards its target, and let go at the first edge. If a push was
/// too hard the shaft stands beyond, and the next one goes back.
///
/// This ends. A push ends in an edge, or has grown to the whole supply, and then something holds the shaft
/// that no motor moves. Each brings the shaft a count nearer at least or past its target; and every
/// [`TURNS_A_COUNT`] times that it has gone past, one count more is near enough, so that a shaft which jumps
/// over its target whenever it moves comes to rest beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LastCounts {
    resting: bool,
    /// How long there has been no edge, us.
    still_us: u32,
    /// Duty that grows while the shaft stands.
    leaning: f32,
    /// How far the last push had to go, counts; 0 before the first one of a line.
    pushed: f32,
    /// How many times a push went back where the one before it came from.
    turns: u16,
}

/// A shaft without an edge for so long, at the end of a line, stands.
const STANDS_US: u32 = 5_000;

/// So near to its target a shaft goes count by count, counts.
const NEAR_COUNTS: u32 = 4;

/// After so many turns a count more is near enough.
const TURNS_A_COUNT: u16 = 4;

impl LastCounts {
    pub(super) const AT_REST: Self =
        Self { resting: false, still_us: 0, leaning: 0.0, pushed: 0.0, turns: 0 };

    /// A line begins.
    pub(super) const fn start(&mut self) {
        (self.leaning, self.pushed, self.turns) = (0.0, 0.0, 0);
    }

    /// There was an edge.
    pub(super) const fn edge(&mut self) {
        self.still_us = 0;
    }

    /// A push that did not move it ends.
    pub(super) const fn let_go(&mut self) {
        self.leaning = 0.0;
    }

    /// Time passes.
    pub(super) const fn wait(&mut self, period_us: u32) {
        self.still_us = self.still_us.saturating_add(period_us);
    }

    /// Whether there has been no edge for so long that the shaft stands.
    pub(super) const fn stands(&self) -> bool {
        self.still_us >= STANDS_US
    }

    /// Whether the shaft may be left alone at `target`: it stands in the target's count, near its middle, or
    /// not far from it and without any edge for a while. Once left alone it stays so until it leaves the
    /// count.
    pub(super) fn rests(&mut self, motion: &ShaftMotion, target: i32, tolerance_counts: f32) -> bool {
        let not_far_counts = match motion.decoding {
            // Farther from the middle it may be outside A's high half, and be counted wrongly when it leaves.
            Decoding::X1 => 0.4,
            Decoding::X2 | Decoding::X4 => 0.6, // the whole count
        };
        let beside = self.turns / TURNS_A_COUNT;
        let distance = motion.distance_from(target).abs();
        let may_rest = self.resting
            || distance <= tolerance_counts
            || (self.stands() && distance <= f32::max(not_far_counts, tolerance_counts) + f32::from(beside));
        self.resting = motion.count.abs_diff(target) <= u32::from(beside) && may_rest;
        if self.resting {
            self.leaning = 0.0;
        }
        self.resting
    }

    /// Whether, with the plan over for so long, the last counts are better gone one by one than by the
    /// control law.
    pub(super) const fn is_near(&self, motion: &ShaftMotion, target: i32, over_us: u32) -> bool {
        const LATE_US: u32 = 100_000;
        over_us >= LATE_US || (over_us >= STANDS_US && motion.count.abs_diff(target) <= NEAR_COUNTS)
    }

    /// Whether it is so far from its target that a line there is sooner gone than single counts.
    pub(super) const fn is_far(&self, motion: &ShaftMotion, target: i32) -> bool {
        motion.count.abs_diff(target) > NEAR_COUNTS
    }

    /// The duty for a shaft that is `away` counts beyond its target: one that stands is pushed there, and let
    /// go at the first edge.
    pub(super) fn inch(&mut self, away: f32, period_us: u32) -> f32 {
        if !self.stands() {
            self.leaning = 0.0;
            return 0.0;
        }
        if self.leaning == 0.0 {
            self.turns = self.turns.saturating_add(u16::from(self.pushed * away > 0.0));
            self.pushed = -away;
        }
        self.push(-away, period_us)
    }

    /// The duty for a shaft on its way, beyond what the control law asks for: it grows while something
    /// `is_stuck` that should go `towards` a side, since a law without an integral may ask for less than it
    /// takes to break a shaft loose.
    pub(super) fn lean(&mut self, is_stuck: bool, towards: f32, period_us: u32) -> f32 {
        if !(is_stuck && self.stands()) {
            self.leaning = 0.0;
            return 0.0;
        }
        self.push(towards, period_us)
    }

    /// Goes on to one side until it is let go.
    fn push(&mut self, towards: f32, period_us: u32) -> f32 {
        const SUPPLIES_PER_US: f32 = 0.5e-6; // friction is a few hundredths of the supply: tens of milliseconds
        #[expect(clippy::cast_precision_loss, reason = "a period is far below 2^24 us")]
        let grown = SUPPLIES_PER_US * period_us as f32;
        let sense = if self.leaning == 0.0 { towards } else { self.leaning };
        self.leaning = (self.leaning + libm::copysignf(grown, sense)).clamp(-1.0, 1.0);
        self.leaning
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direction;

    const PERIOD_US: u32 = 400;

    /// Runs of the loop until the shaft rests, for a shaft that jumps by `jump` edges whenever the push
    /// reaches `breaks_loose`.
    fn runs_to_rest(target: i32, breaks_loose: f32, jump: u32) -> Option<u32> {
        let mut motion = ShaftMotion::at_rest(Decoding::X4, 900.0);
        let mut last = LastCounts::AT_REST;
        for run in 0..1_000_000 {
            last.wait(PERIOD_US);
            if last.rests(&motion, target, 0.25) {
                return Some(run);
            }
            let duty = last.inch(motion.distance_from(target), PERIOD_US);
            if duty.abs() >= breaks_loose {
                let direction = if duty > 0.0 { Direction::Plus } else { Direction::Minus };
                for _ in 0..jump {
                    let place = motion.enter(direction);
                    motion.offset = 1.0 - place; // it goes through the count
                    last.edge();
                }
                motion.offset = 0.5;
                motion.stands(1.0);
            }
        }
        None
    }

    #[test]
    fn a_shaft_goes_to_its_target_count_by_count() {
        // 5 ms to be sure that it stands, 0.02 / (0.5 / s) = 40 ms of pushing, four times; the runs before it
        // rests at once
        let runs = runs_to_rest(4, 0.02, 1);
        assert!(runs.is_some_and(|runs| (400..=470).contains(&runs)), "{runs:?}");
    }

    #[test]
    fn a_shaft_that_jumps_over_its_target_comes_to_rest_beside_it() {
        for jump in 2..6 {
            assert!(runs_to_rest(1, 0.05, jump).is_some(), "{jump}");
        }
    }

    #[test]
    fn a_shaft_that_is_held_fast_does_not_arrive_however_hard_it_is_pushed() {
        assert_eq!(runs_to_rest(1, 1.1, 1), None);
        assert!(runs_to_rest(1, 1.0, 1).is_some()); // the whole supply is tried
    }
}
