//! [`SCurveState`]: motion through the blocks ahead with a limited jerk along the path.
//!
//! The speeds that corners and curves allow are points that the motion must not pass too fast. A state of
//! motion (speed and acceleration) is *viable* if the hardest braking within acceleration and jerk would
//! still be in time for each of them. From one short time to the next the motion takes the greatest jerk
//! whose outcome is viable: so it speeds up as long as it may, and brakes as late as it must, whatever the
//! lengths of the blocks.

mod ahead;
mod greatest_kept;
mod motion;

use self::ahead::{Ahead, SLACK_MM};
use self::greatest_kept::GreatestKept;
use self::motion::{Braking, Limits, SHORTEST_PHASE_S, STANDSTILL_MM_S, State};
use super::Phase;
use super::ring::Ring;
use crate::geom::single;
use crate::{MotionLimits, profile::SCurve};

/// Longest phase, s (47 ms): a feed hold begins to act after this time at the latest, as with trapezoids.
const LONGEST_S: f64 = 3.0 / 64.0;
/// Parts of the time from no acceleration to the greatest. A jerk is chosen for each part.
const PARTS: f64 = 32.0;
/// Shortest part, s: with great jerks the motion is nearly a trapezoid, and finer parts would only be more.
const SHORTEST_S: f64 = 0.000_2;
/// How much longer a part may be while nothing lies in the way: tried in this order.
const LONGER: [f64; 4] = [64.0, 16.0, 4.0, 1.0];
/// A braking that ends this near to its place is begun as a whole, mm: a nanometre, below any motor's step.
const TIGHT_MM: f64 = 1e-6;
/// A block with less than this left is done, mm: as rounding may leave.
const DONE_MM: f64 = 1e-9;

/// Where the jerk-limited motion stands within the head of the ring.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SCurveState {
    /// Whether the head's course has been given out.
    begun: bool,
    done_mm: f64,
    state: State,
    /// The phases that have been chosen, and how many of them have been taken.
    chosen: Chosen,
    taken: u8,
    /// How much of the next of them has been taken, s: a long one is given out in pieces.
    taken_s: f64,
}

/// Phases that go on as a whole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Chosen {
    #[default]
    None,
    One {
        jerk: f64,
        time_s: f64,
    },
    /// Not yet: the greatest jerk for this time is being looked for.
    Sought {
        jerk: GreatestKept,
        time_s: f64,
    },
    /// To the end of the block, and the speed there.
    Braking(Braking, f64),
    /// To the end of the block, from standstill to standstill: see [`SCurve::phases_s`].
    RestToRest {
        jerk_s: f64,
        steady_s: f64,
        cruise_s: f64,
    },
}

impl Chosen {
    /// The phase after so many: its jerk and its length; and the speed at the end of the block, if it goes
    /// there.
    fn phase(&self, taken: usize, jerk: f64) -> Option<(f64, f64)> {
        match *self {
            Self::None | Self::Sought { .. } => None,
            Self::One { jerk, time_s } => [(jerk, time_s)].get(taken).copied(),
            Self::Braking(Braking { in_s, steady_s, out_s }, _) => {
                [(-jerk, in_s), (0.0, steady_s), (jerk, out_s)].get(taken).copied()
            }
            Self::RestToRest { jerk_s, steady_s, cruise_s } => [
                (jerk, jerk_s),
                (0.0, steady_s),
                (-jerk, jerk_s),
                (0.0, cruise_s),
                (-jerk, jerk_s),
                (0.0, steady_s),
                (jerk, jerk_s),
            ]
            .get(taken)
            .copied(),
        }
    }

    /// The speed at the end of the block, where they lead to it.
    fn exit(&self) -> Option<f64> {
        match *self {
            Self::None | Self::One { .. } | Self::Sought { .. } => None,
            Self::Braking(_, exit) => Some(exit),
            Self::RestToRest { .. } => Some(0.0),
        }
    }
}

/// What there is for who asks for a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Choice {
    /// One with this jerk, of which so much is left, s; which of those that were chosen.
    Phase { next: u8, jerk: f64, rest_s: f64 },
    /// The block is done.
    Over,
    /// The motion stands, as it was told to.
    Held,
    /// A search is not over.
    Unfinished,
}

impl SCurveState {
    /// The head of the ring is under way.
    pub(super) fn begin(&mut self) {
        self.begun = true;
        self.done_mm = 0.0;
        self.choose_next(Chosen::None);
    }

    /// What has been chosen and not been taken is chosen anew: other speeds are allowed.
    pub(super) fn choose_anew(&mut self) {
        self.choose_next(Chosen::None);
    }

    fn choose_next(&mut self, chosen: Chosen) {
        (self.chosen, self.taken, self.taken_s) = (chosen, 0, 0.0);
    }

    /// The next phase of the head; `None` when it is done, and taken from the ring, or has not begun.
    pub(super) fn next_phase<const N: usize>(
        &mut self,
        ring: &mut Ring<N>,
        accel_mm_s2: f64,
        jerk_mm_s3: f64,
        hold: bool,
    ) -> Option<Phase> {
        if !self.begun {
            return None;
        }
        let limits = Limits::new(accel_mm_s2, jerk_mm_s3);
        match self.choose_up_to(u32::MAX, ring, limits, hold) {
            Choice::Phase { next, jerk, rest_s } => {
                let is_whole = rest_s <= LONGEST_S;
                let before_s = if next == self.taken { self.taken_s } else { 0.0 };
                (self.taken, self.taken_s) =
                    if is_whole { (next + 1, 0.0) } else { (next, before_s + LONGEST_S) };
                let phase = self.take(jerk, if is_whole { rest_s } else { LONGEST_S }, limits);
                if self.next_chosen(limits).is_none() {
                    self.end_chosen(ring);
                }
                Some(phase)
            }
            Choice::Held => {
                self.choose_next(Chosen::None);
                self.state = State::default();
                None
            }
            Choice::Over | Choice::Unfinished => {
                self.begun = false;
                ring.pop();
                if ring.get(0).is_none_or(|next| next.max_entry2 <= 0.0) {
                    self.state = State::default();
                }
                None
            }
        }
    }

    /// A part of what the next phase needs: of a search, so many looks. Whether there is more to do before
    /// [`next_phase`](Self::next_phase) only has to take it.
    pub(super) fn choose_part<const N: usize>(
        &mut self,
        looks: u32,
        ring: &Ring<N>,
        accel_mm_s2: f64,
        jerk_mm_s3: f64,
        hold: bool,
    ) -> bool {
        let limits = Limits::new(accel_mm_s2, jerk_mm_s3);
        self.begun && matches!(self.choose_up_to(looks, ring, limits, hold), Choice::Unfinished)
    }

    /// What has been chosen, or is being looked for, before its time is chosen again.
    pub(super) fn choose_again(&mut self) {
        if self.taken == 0 && self.taken_s <= 0.0 {
            self.choose_next(Chosen::None);
        }
    }

    /// What is left of what has been chosen: the next phase that takes any time.
    fn next_chosen(&self, limits: Limits) -> Option<Choice> {
        let (mut next, mut taken_s) = (self.taken, self.taken_s);
        loop {
            let (jerk, time_s) = self.chosen.phase(next.into(), limits.jerk)?;
            let rest_s = time_s - taken_s;
            if rest_s > 0.0 {
                return Some(Choice::Phase { next, jerk, rest_s });
            }
            (next, taken_s) = (next + 1, 0.0);
        }
    }

    /// What was chosen has been taken: where it leads to the end of the block, the motion is there.
    fn end_chosen<const N: usize>(&mut self, ring: &Ring<N>) {
        if let Some(exit) = self.chosen.exit() {
            self.done_mm = head_mm(ring);
            self.state = State { speed: exit, accel: 0.0 };
            self.choose_next(Chosen::None);
        }
    }

    /// Chooses phases, with so many looks of a search for them at most, until one is there to be taken.
    fn choose_up_to<const N: usize>(
        &mut self,
        looks: u32,
        ring: &Ring<N>,
        limits: Limits,
        hold: bool,
    ) -> Choice {
        loop {
            if hold && (self.taken > 0 || self.taken_s > 0.0) {
                // What has not been taken of what was chosen is not wanted any more.
                self.choose_next(Chosen::None);
            }
            if let Some(phase) = self.next_chosen(limits) {
                return phase;
            }
            self.end_chosen(ring);
            let rest_mm = head_mm(ring) - self.done_mm;
            let chosen = match self.chosen {
                _ if rest_mm <= DONE_MM => return Choice::Over,
                _ if hold => {
                    let braking = self.brake(rest_mm, limits);
                    if braking == Chosen::None {
                        return Choice::Held;
                    }
                    braking
                }
                Chosen::Sought { jerk, time_s } => {
                    let ahead = self.ahead_of_search(ring, rest_mm, time_s, limits);
                    self.seek(looks, jerk, time_s, &ahead, rest_mm, limits)
                }
                _ => self.choose(looks, ring, rest_mm, limits),
            };
            self.choose_next(chosen);
            match chosen {
                Chosen::None => return Choice::Over,
                Chosen::Sought { .. } => return Choice::Unfinished,
                _ => {}
            }
        }
    }

    /// Whether the motion has come to rest, wherever it is.
    pub(super) fn stands(&self) -> bool {
        self.state == State::default()
    }

    /// The next part of a braking to rest, no farther than the end of the block; none at rest.
    fn brake(&self, rest_mm: f64, limits: Limits) -> Chosen {
        let Braking { in_s, steady_s, out_s } = self.state.braking(0.0, limits);
        for (jerk, time_s) in [(-limits.jerk, in_s), (0.0, steady_s), (limits.jerk, out_s)] {
            if time_s <= SHORTEST_PHASE_S {
                continue;
            }
            let within = self.state.after(jerk, time_s).1 <= rest_mm;
            let time_s = if within { time_s } else { self.time_to(rest_mm, jerk, time_s) };
            return Chosen::One { jerk, time_s };
        }
        Chosen::None
    }

    fn take(&mut self, jerk: f64, time_s: f64, limits: Limits) -> Phase {
        if jerk == 0.0 && self.state.keeps_its_speed(limits) {
            self.state.accel = 0.0;
        }
        let phase = Phase {
            duration_s: single(time_s),
            from_mm: single(self.done_mm),
            speed_mm_s: single(self.state.speed),
            accel_mm_s2: single(self.state.accel),
            jerk_mm_s3: single(jerk),
        };
        let (state, way_mm) = self.state.after(jerk, time_s);
        self.state = State { speed: state.speed.max(0.0), ..state };
        self.done_mm += way_mm;
        phase
    }

    /// Chooses the next phase or phases, at least one; or begins a search for one, with so many looks at
    /// most.
    #[cfg_attr(target_os = "none", inline(never))] // most of what a planner is asked for are ramps
    fn choose<const N: usize>(&mut self, looks: u32, ring: &Ring<N>, rest_mm: f64, limits: Limits) -> Chosen {
        let mut ahead = Ahead::new(ring, rest_mm, limits);
        let state = self.state;
        let most = ahead.places().first().map_or(0.0, |place| place.1);
        if state.is_at_standstill() && most <= 0.0 {
            return rest_to_rest(rest_mm, ahead.cruise, limits);
        }
        // A braking for the end of this block that can be put off no longer.
        if state.speed > most && (rest_mm - state.braking_mm(most, limits)).abs() <= TIGHT_MM {
            let braking = state.braking(most, limits);
            // Unless a slower place behind it wants the braking to go on.
            let end = State { speed: most, accel: 0.0 };
            if braking.in_s + braking.steady_s > 0.0 && ahead.is_viable(end, rest_mm, limits) {
                return Chosen::Braking(braking, most);
            }
        }
        // A machine that is at full speed before it is at full acceleration has that time instead.
        let part_s = (limits.accel / limits.jerk).min(libm::sqrt(ahead.cruise / limits.jerk)) / PARTS;
        let part_s = part_s.max(SHORTEST_S);
        // At full speed: as long as there is nothing to brake for.
        if state.cruises(ahead.cruise, limits) {
            let free_mm = ahead.places().iter().fold(rest_mm, |free_mm, &(place_mm, most)| {
                free_mm.min(place_mm - state.braking_mm(most, limits))
            });
            let time_s = free_mm / state.speed;
            if time_s > part_s || free_mm >= rest_mm {
                return Chosen::One { jerk: 0.0, time_s };
            }
        }
        // Faster than is wanted from now on: braking to that, unless a place ahead wants more.
        if state.speed > ahead.cruise + STANDSTILL_MM_S
            && let Some(phase) = self.slow_down(&ahead, rest_mm, part_s, limits)
        {
            return phase;
        }
        // The quickest way to full speed, as long as nothing has to be braked for at the end of its next
        // phase.
        if let Some((jerk, time_s)) = state.next_to_cruise(ahead.cruise, limits) {
            let (after, way_mm) = state.after(jerk, time_s);
            if way_mm <= rest_mm && ahead.is_viable(after, way_mm, limits) {
                return Chosen::One { jerk, time_s };
            }
        }
        let to_full_s = (limits.accel - state.accel).max(0.0) / limits.jerk;
        let (most_jerk, up_s) =
            if to_full_s > 1e-6 * part_s { (limits.jerk, to_full_s) } else { (0.0, f64::INFINITY) };
        for longer in LONGER {
            let time_s = (longer * part_s).min(up_s);
            let (after, way_mm) = state.after(most_jerk, time_s);
            if way_mm <= rest_mm && ahead.is_viable(after, way_mm, limits) {
                return Chosen::One { jerk: most_jerk, time_s };
            }
        }
        // A braking for a place farther on that can be put off no longer is followed phase by phase.
        if let Some(phase) = self.follow(&ahead, rest_mm, part_s, limits) {
            return phase;
        }
        // Within one part: no farther than the end of the block.
        let mut time_s = part_s;
        let coasted_mm = state.after(0.0, part_s).1;
        if coasted_mm > rest_mm && state.speed > 0.0 {
            time_s = part_s * rest_mm / coasted_mm;
        }
        // The deepest braking begins where its jerk ends.
        let to_deepest_s = (limits.accel + state.accel) / limits.jerk;
        if to_deepest_s > 1e-6 * part_s {
            time_s = time_s.min(to_deepest_s);
        }
        let [mut low, high] = self.jerks_within(time_s, limits);
        if state.after(low, time_s).0.to_let_go(limits) < 0.0 {
            let to_let_go = |back: f64| state.after(-back, time_s).0.to_let_go(limits);
            low = -GreatestKept::new([-high, -low], to_let_go).whole(to_let_go);
        }
        let (after, way_mm) = state.after(high, time_s);
        ahead.leave_out_kept(after, way_mm, limits);
        let jerk = GreatestKept::new([low, high], |jerk| self.margin(jerk, time_s, &ahead, limits));
        self.seek(looks, jerk, time_s, &ahead, rest_mm, limits)
    }

    /// The jerks that keep the acceleration for a time.
    fn jerks_within(&self, time_s: f64, limits: Limits) -> [f64; 2] {
        let accel = self.state.accel;
        let low = (-limits.jerk).max((-limits.accel - accel) / time_s);
        [low, limits.jerk.min((limits.accel - accel) / time_s)]
    }

    /// What a search that has begun has to keep.
    fn ahead_of_search<const N: usize>(
        &self,
        ring: &Ring<N>,
        rest_mm: f64,
        time_s: f64,
        limits: Limits,
    ) -> Ahead<N> {
        let mut ahead = Ahead::new(ring, rest_mm, limits);
        let (after, way_mm) = self.state.after(self.jerks_within(time_s, limits)[1], time_s);
        ahead.leave_out_kept(after, way_mm, limits);
        ahead
    }

    /// By how much a jerk for a time keeps everything: see [`Ahead::margin`].
    fn margin<const N: usize>(&self, jerk: f64, time_s: f64, ahead: &Ahead<N>, limits: Limits) -> f64 {
        let (after, way_mm) = self.state.after(jerk, time_s);
        let below_mm_s = ahead.cruise + STANDSTILL_MM_S - self.state.peak_within(jerk, time_s);
        below_mm_s.min(ahead.margin(after, way_mm, limits))
    }

    /// The greatest jerk for a time, no farther than the end of the block: what so many looks give.
    fn seek<const N: usize>(
        &self,
        looks: u32,
        mut jerk: GreatestKept,
        mut time_s: f64,
        ahead: &Ahead<N>,
        rest_mm: f64,
        limits: Limits,
    ) -> Chosen {
        for _ in 0..looks {
            if jerk.is_found() {
                break;
            }
            jerk.look(|jerk| self.margin(jerk, time_s, ahead, limits));
        }
        if !jerk.is_found() {
            return Chosen::Sought { jerk, time_s };
        }
        let jerk = jerk.number();
        let (_, way_mm) = self.state.after(jerk, time_s);
        if way_mm <= DONE_MM && self.state.is_at_standstill() {
            // Too near to a corner that must be taken very slowly: there by itself, and then on.
            return rest_to_rest(rest_mm, ahead.cruise, limits);
        }
        if way_mm > rest_mm {
            time_s = self.time_to(rest_mm, jerk, time_s);
        }
        Chosen::One { jerk, time_s }
    }

    /// The next part of the braking to the cruising speed, if it keeps what lies ahead.
    fn slow_down<const N: usize>(
        &self,
        ahead: &Ahead<N>,
        rest_mm: f64,
        part_s: f64,
        limits: Limits,
    ) -> Option<Chosen> {
        let state = self.state;
        let Braking { in_s, steady_s, out_s } = state.braking(ahead.cruise, limits);
        let phases = [(-limits.jerk, in_s), (0.0, steady_s), (limits.jerk, out_s)];
        let &(jerk, time_s) = phases.iter().find(|phase| phase.1 > SHORTEST_PHASE_S)?;
        let time_s = time_s.min(part_s);
        let (after, way_mm) = state.after(jerk, time_s);
        let keeps = ahead.places().iter().all(|&(place_mm, most)| {
            after.speed <= most || after.brakes_within(most, limits, place_mm - way_mm + SLACK_MM)
        });
        if jerk >= 0.0 && !keeps {
            return None;
        }
        let time_s = if way_mm > rest_mm { self.time_to(rest_mm, jerk, time_s) } else { time_s };
        Some(Chosen::One { jerk, time_s })
    }

    /// The next phase of the braking for the place that leaves no time, if there is one.
    fn follow<const N: usize>(
        &self,
        ahead: &Ahead<N>,
        rest_mm: f64,
        part_s: f64,
        limits: Limits,
    ) -> Option<Chosen> {
        let state = self.state;
        let slack = |&&(place_mm, most): &&(f64, f64)| {
            state.speed > most
                && !state.surely_brakes_within(most, limits, place_mm - TIGHT_MM)
                && (place_mm - state.braking_mm(most, limits)).abs() <= TIGHT_MM
        };
        let &(_, most) = ahead.places().iter().find(slack)?;
        let Braking { in_s, steady_s, out_s } = state.braking(most, limits);
        let phases = [(-limits.jerk, in_s), (0.0, steady_s), (limits.jerk, out_s.min(part_s))];
        let &(jerk, time_s) = phases.iter().find(|phase| phase.1 > SHORTEST_PHASE_S)?;
        let (after, way_mm) = state.after(jerk, time_s);
        if jerk > 0.0 && !ahead.is_viable(after, way_mm, limits) {
            return None; // a slower place behind it wants more
        }
        let time_s = if way_mm > rest_mm { self.time_to(rest_mm, jerk, time_s) } else { time_s };
        Some(Chosen::One { jerk, time_s })
    }

    /// When a distance has been covered with this jerk, before `most_s`.
    fn time_to(&self, way_mm: f64, jerk: f64, most_s: f64) -> f64 {
        let (mut low, mut high) = (0.0, most_s);
        for _ in 0..52 {
            let middle = 0.5 * (low + high);
            if self.state.after(jerk, middle).1 >= way_mm { high = middle } else { low = middle }
        }
        high
    }
}

/// Length of the block under way, mm.
fn head_mm<const N: usize>(ring: &Ring<N>) -> f64 {
    ring.get(0).map_or(0.0, |head| head.length().into())
}

/// The quickest motion from standstill to standstill, in closed form.
fn rest_to_rest(way_mm: f64, cruise: f64, limits: Limits) -> Chosen {
    let limits = MotionLimits { speed_mm_s: cruise, accel_mm_s2: limits.accel, jerk_mm_s3: limits.jerk };
    SCurve::plan(way_mm, limits).map_or(Chosen::None, |motion| {
        let [jerk_s, steady_s, _, cruise_s, ..] = motion.phases_s();
        Chosen::RestToRest { jerk_s, steady_s, cruise_s }
    })
}
