//! [`SCurveState`]: motion through the blocks ahead with a limited jerk along the path.
//!
//! The speeds that corners and curves allow are points that the motion must not pass too fast. A state of
//! motion (speed and acceleration) is *viable* if the hardest braking within acceleration and jerk would
//! still be in time for each of them. From one short time to the next the motion takes the greatest jerk
//! whose outcome is viable: so it speeds up as long as it may, and brakes as late as it must, whatever the
//! lengths of the blocks.

use super::Phase;
use super::ring::Ring;
use crate::extremes::{greatest, least};
use crate::geom::single;
use crate::root::root;
use crate::{MotionLimits, profile::SCurve};

/// Longest phase, s (47 ms): a feed hold begins to act after this time at the latest, as with trapezoids.
const LONGEST_S: f64 = 3.0 / 64.0;
/// Parts of the time from no acceleration to the greatest. A jerk is chosen for each part.
const PARTS: f64 = 32.0;
/// Shortest part, s: with great jerks the motion is nearly a trapezoid, and finer parts would only be more.
const SHORTEST_S: f64 = 0.000_2;
/// How much longer a part may be while nothing lies in the way: tried in this order.
const LONGER: [f64; 4] = [64.0, 16.0, 4.0, 1.0];
/// How nearly the greatest viable jerk is found: to 6e-8 of the range, as fine as `f32`, or until what lies
/// ahead is kept by no more than this, mm: a tenth of [`TIGHT_MM`].
const KEPT_SHARE: f64 = 6e-8;
const KEPT_MARGIN: f64 = 1e-7;
/// Distance by which rounding may make a braking end too late, mm: `f64` holds a block of a kilometre to a
/// tenth of it.
const SLACK_MM: f64 = 1e-9;
/// A braking that ends this near to its place is begun as a whole, mm: a nanometre, below any motor's step.
const TIGHT_MM: f64 = 1e-6;
/// A block with less than this left is done, mm: as [`SLACK_MM`].
const DONE_MM: f64 = 1e-9;
/// A phase no longer than this is rounding, s: a thousandth of a tick of a microsecond.
const SHORTEST_PHASE_S: f64 = 1e-9;
/// The acceleration rises to its greatest in no less than this, s, whatever jerk is allowed: a thousand of
/// the phases above.
const SHORTEST_RISE_S: f64 = 1e-6;
/// A lower speed is a standstill, mm/s: four orders below the least limit that is planned with.
const STANDSTILL_MM_S: f64 = 1e-7;

/// The limits along the path.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Limits {
    accel: f64,
    jerk: f64,
}

/// Speed and acceleration along the path, mm/s and mm/s².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct State {
    speed: f64,
    accel: f64,
}

/// The times of the hardest braking: to the deepest deceleration, with it, and back to none; s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Braking {
    in_s: f64,
    steady_s: f64,
    out_s: f64,
}

impl State {
    /// After a time with constant jerk; and how far it has come, mm.
    fn after(self, jerk: f64, time_s: f64) -> (Self, f64) {
        let Self { speed, accel } = self;
        let t = time_s;
        let way_mm = t * (speed + t * (accel / 2.0 + t * jerk / 6.0));
        (Self { speed: speed + t * (accel + t * jerk / 2.0), accel: accel + t * jerk }, way_mm)
    }

    /// The greatest speed within a time of constant jerk.
    fn peak_within(self, jerk: f64, time_s: f64) -> f64 {
        let turn_s = -self.accel / jerk;
        if self.accel > 0.0 && jerk < 0.0 && turn_s < time_s {
            self.speed + 0.5 * self.accel * turn_s
        } else {
            self.speed.max(self.after(jerk, time_s).0.speed)
        }
    }

    /// The speed that it comes to however soon its acceleration ends.
    fn peak(self, limits: Limits) -> f64 {
        let Self { speed, accel } = self;
        speed + if accel > 0.0 { 0.5 * accel * accel / limits.jerk } else { 0.0 }
    }

    /// Jerk and time, s, of the next phase of the quickest way to the cruising speed; none if it would go
    /// beyond it.
    fn next_to_cruise(self, cruise: f64, limits: Limits) -> Option<(f64, f64)> {
        if self.cruises(cruise, limits) {
            return None;
        }
        let Self { speed, accel } = self;
        let missing = 2.0 * limits.jerk * (cruise - speed);
        // Up to this acceleration and back to none.
        let peak = libm::sqrt((0.5 * (missing + accel * accel)).max(0.0)).min(limits.accel);
        let up_s = (peak - accel) / limits.jerk;
        if up_s > SHORTEST_PHASE_S {
            return Some((limits.jerk, up_s));
        }
        let excess = missing - accel * accel;
        if accel <= 0.0 || excess < -STANDSTILL_MM_S * limits.jerk {
            return None;
        }
        let steady_s = excess / (2.0 * limits.jerk * accel);
        if steady_s > SHORTEST_PHASE_S {
            Some((0.0, steady_s))
        } else {
            Some((-limits.jerk, accel / limits.jerk))
        }
    }

    /// Whether the motion goes on at cruising speed, but for rounding.
    fn cruises(self, cruise: f64, limits: Limits) -> bool {
        self.accel.abs() <= 1e-9 * limits.accel && self.speed >= cruise * (1.0 - 1e-9)
    }

    /// The hardest braking to a speed with no acceleration left; none if that speed is not exceeded in any
    /// case.
    fn braking(self, to: f64, limits: Limits) -> Braking {
        let Self { speed, accel } = self;
        let Limits { accel: most, jerk } = limits;
        let excess = speed - to;
        // What the speed changes while the acceleration goes back to none.
        let coming = 0.5 * accel * accel / jerk;
        if accel < 0.0 && excess < coming {
            // It is braking harder than it has to.
            let root = libm::sqrt((accel * accel - 2.0 * jerk * excess).max(0.0));
            let out_s = if excess > 0.0 { (-accel - root) / jerk } else { 0.0 };
            return Braking { out_s, ..Braking::default() };
        }
        let over = jerk * excess + 0.5 * accel * accel;
        if over <= 0.0 || (accel <= 0.0 && excess <= 0.0) {
            return Braking::default();
        }
        let deepest = libm::sqrt(over).min(most);
        let steady_s = ((excess + (0.5 * accel * accel - deepest * deepest) / jerk) / deepest).max(0.0);
        Braking { in_s: ((accel + deepest) / jerk).max(0.0), steady_s, out_s: deepest / jerk }
    }

    /// By how much a braking can be ended before the motion turns back, mm/s.
    fn to_let_go(self, limits: Limits) -> f64 {
        let coming = if self.accel < 0.0 { 0.5 * self.accel * self.accel / limits.jerk } else { 0.0 };
        self.speed + STANDSTILL_MM_S - coming
    }

    /// Whether the hardest braking to a speed ends within a distance in any case: by a bound on its length
    /// that takes no difference of numbers. It is at most twice as long as the braking, and so tells of most
    /// places that they do not matter; `f32` is some twenty times as quick on a small processor, and what it
    /// loses is far below the margin.
    fn surely_brakes_within(self, to: f64, limits: Limits, distance_mm: f64) -> bool {
        /// What rounding may take from the bound, as a share: hundreds of times what it does take.
        const MARGIN: f32 = 1.001;
        /// Share of a speed that both of two that are nearly the same may have lost by rounding.
        const ROUNDING: f32 = 4.0 * f32::EPSILON;
        let [speed, accel, to] = [self.speed, self.accel, to].map(single);
        let (most, jerk) = (single(limits.accel), single(limits.jerk));
        let rising = greatest(accel, 0.0);
        // As fast as it may come to be, and from there on to the speed.
        let coming = 0.5 * rising * rising / jerk;
        let peak = speed + coming;
        let excess = greatest(peak - to, 0.0) + ROUNDING * greatest(peak, 0.0);
        // To no acceleration; as a triangle or a trapezoid down to the speed.
        let deepest = least(root(jerk * excess), most);
        let down_s = if deepest > 0.0 { deepest / jerk + excess / deepest } else { 0.0 };
        let time_s = accel.abs() / jerk + down_s;
        greatest(peak, 0.0) * time_s * MARGIN < single(distance_mm)
    }

    /// Whether it ends within a distance.
    fn brakes_within(self, to: f64, limits: Limits, distance_mm: f64) -> bool {
        self.surely_brakes_within(to, limits, distance_mm) || self.braking_mm(to, limits) <= distance_mm
    }

    /// Length of the hardest braking to a speed, mm.
    fn braking_mm(self, to: f64, limits: Limits) -> f64 {
        let Braking { in_s, steady_s, out_s } = self.braking(to, limits);
        let (state, first_mm) = self.after(-limits.jerk, in_s);
        let (state, second_mm) = state.after(0.0, steady_s);
        first_mm + second_mm + state.after(limits.jerk, out_s).1
    }
}

/// The speeds that are allowed ahead: the first `count` places with their distance from the present one, mm
/// and mm/s.
#[derive(Clone, Copy, Debug)]
struct Ahead<const N: usize> {
    places: [(f64, f64); N],
    count: usize,
    /// Greatest speed up to the first of them.
    cruise: f64,
}

impl<const N: usize> Ahead<N> {
    fn new(ring: &Ring<N>, rest_mm: f64, limits: Limits) -> Self {
        let cruise = ring.get(0).map_or(0.0, |head| libm::sqrt(f64::from(head.cruise2)));
        // What lies farther away than any braking is long does not matter yet.
        let farthest_mm = State { speed: cruise, accel: limits.accel }.braking_mm(0.0, limits);
        let mut ahead = Self { places: [(0.0, 0.0); N], count: 0, cruise };
        let mut way_mm = rest_mm;
        for index in 1..=ring.len() {
            let next = ring.get(index);
            let most = next.map_or(0.0, |block| libm::sqrt(f64::from(block.max_entry2)));
            if let Some(place) = ahead.places.get_mut(ahead.count) {
                *place = (way_mm, most);
                ahead.count += 1;
            }
            way_mm += next.map_or(0.0, |block| f64::from(block.length()));
            if most <= 0.0 || way_mm > farthest_mm + rest_mm {
                break;
            }
        }
        ahead
    }

    fn places(&self) -> &[(f64, f64)] {
        self.places.get(..self.count).unwrap_or(&[])
    }

    /// Leaves out the places that a state keeps with room to spare: every state that is slower, has less
    /// acceleration and has not come so far keeps them too, for all of its brakings are shorter.
    fn leave_out_kept(&mut self, state: State, way_mm: f64, limits: Limits) {
        /// Margins, as a share of a speed and as a distance in mm, far above the rounding of either.
        const SPARE: f64 = 1e-9;
        const SPARE_MM: f64 = 1e-6;
        let peak = state.peak(limits);
        let mut count = 0;
        for index in 0..self.count {
            let Some(&(place_mm, most)) = self.places.get(index) else { break };
            let is_kept = peak * (1.0 + SPARE) <= most
                || state.brakes_within(most, limits, place_mm - way_mm - SPARE_MM);
            if !is_kept && let Some(place) = self.places.get_mut(count) {
                *place = (place_mm, most);
                count += 1;
            }
        }
        self.count = count;
    }

    /// Whether a state that is `way_mm` ahead can still keep everything.
    fn is_viable(&self, state: State, way_mm: f64, limits: Limits) -> bool {
        let peak = state.peak(limits);
        self.room_for(state, peak) >= 0.0
            && self.places().iter().all(|&(place_mm, most)| {
                peak <= most || state.brakes_within(most, limits, place_mm - way_mm + SLACK_MM)
            })
    }

    /// By how much it keeps everything, the least of speeds in mm/s and distances in mm; below 0 it does not.
    fn margin(&self, state: State, way_mm: f64, limits: Limits) -> f64 {
        let peak = state.peak(limits);
        let room = self.room_for(state, peak);
        if room < 0.0 {
            return room;
        }
        let beyond = self.places().iter().filter(|(_, most)| peak > *most);
        beyond.fold(room, |least, &(place_mm, most)| {
            least.min(place_mm - way_mm + SLACK_MM - state.braking_mm(most, limits))
        })
    }

    /// By how much a state is neither backwards nor beyond the cruising speed, mm/s.
    fn room_for(&self, state: State, peak: f64) -> f64 {
        let forwards = state.speed + STANDSTILL_MM_S;
        // How far it is from turning back does not fall with a greater jerk, and is no margin to go by.
        if forwards < 0.0 { forwards } else { self.cruise * (1.0 + 1e-12) + STANDSTILL_MM_S - peak }
    }
}

/// The greatest number of a range whose margin is not below 0, by less than [`KEPT_MARGIN`] or
/// [`KEPT_SHARE`] of the range; the least one if there is none. The margin falls.
///
/// By false position as the Illinois algorithm has it (M. Dowell and P. Jarratt, "A modified regula falsi
/// method for computing the root of an equation", BIT 11, 1971), with a halving wherever that gains little: a
/// third of the steps that halvings take.
fn greatest_kept([mut low, mut high]: [f64; 2], margin: impl Fn(f64) -> f64) -> f64 {
    let least_width = KEPT_SHARE * (high - low);
    let at_high = margin(high);
    if at_high >= 0.0 {
        return high;
    }
    // What the secant is drawn through: where an end stays twice, half of what is there.
    let mut ends = [margin(low), at_high];
    let mut stayed = None;
    let (mut width, mut steps) = (high - low, 0);
    // Ends: in three steps the range is at most half as wide.
    while high - low > least_width {
        // The least number stays even if it does not keep everything, but for rounding.
        let share = if steps < 2 && ends[0] > 0.0 { ends[0] / (ends[0] - ends[1]) } else { 0.5 };
        let share = if share.is_finite() { share.clamp(1e-3, 0.999) } else { 0.5 };
        let at = low + share * (high - low);
        let here = margin(at);
        let is_kept = here >= 0.0;
        if is_kept {
            (low, ends[0]) = (at, here);
            if here <= KEPT_MARGIN {
                break;
            }
        } else {
            (high, ends[1]) = (at, here);
        }
        // The end that stays is the other one.
        if stayed == Some(is_kept) {
            ends[usize::from(is_kept)] *= 0.5;
        }
        stayed = Some(is_kept);
        steps += 1;
        if high - low <= 0.5 * width {
            (width, steps) = (high - low, 0);
        } else if steps == 3 {
            steps = 0;
        }
    }
    low
}

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
            Self::None => None,
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
            Self::None | Self::One { .. } => None,
            Self::Braking(_, exit) => Some(exit),
            Self::RestToRest { .. } => Some(0.0),
        }
    }
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
        let limits = Limits { accel: accel_mm_s2, jerk: jerk_mm_s3.min(accel_mm_s2 / SHORTEST_RISE_S) };
        let length_mm = ring.get(0).map_or(0.0, |head| f64::from(head.length()));
        loop {
            if hold && (self.taken > 0 || self.taken_s > 0.0) {
                // What has not been taken of what was chosen is not wanted any more.
                self.choose_next(Chosen::None);
            }
            if let Some((jerk, time_s)) = self.chosen.phase(usize::from(self.taken), limits.jerk) {
                let rest_s = time_s - self.taken_s;
                if rest_s > LONGEST_S {
                    self.taken_s += LONGEST_S;
                    return Some(self.take(jerk, LONGEST_S));
                }
                (self.taken, self.taken_s) = (self.taken + 1, 0.0);
                if rest_s > 0.0 {
                    return Some(self.take(jerk, rest_s));
                }
                continue;
            }
            if let Some(exit) = self.chosen.exit() {
                self.done_mm = length_mm;
                self.state = State { speed: exit, accel: 0.0 };
            }
            self.choose_next(Chosen::None);
            let rest_mm = length_mm - self.done_mm;
            if rest_mm <= DONE_MM {
                break;
            }
            if hold {
                let braking = self.brake(rest_mm, limits);
                self.choose_next(braking);
                if self.chosen == Chosen::None {
                    self.state = State::default();
                    return None;
                }
                continue;
            }
            let chosen = self.choose(ring, rest_mm, limits);
            self.choose_next(chosen);
            if self.chosen == Chosen::None {
                break;
            }
        }
        self.begun = false;
        ring.pop();
        if ring.get(0).is_none_or(|next| next.max_entry2 <= 0.0) {
            self.state = State::default();
        }
        None
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

    fn take(&mut self, jerk: f64, time_s: f64) -> Phase {
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

    /// Chooses the next phase or phases, at least one.
    #[cfg_attr(target_os = "none", inline(never))] // most of what a planner is asked for are ramps
    fn choose<const N: usize>(&mut self, ring: &Ring<N>, rest_mm: f64, limits: Limits) -> Chosen {
        let mut ahead = Ahead::new(ring, rest_mm, limits);
        let state = self.state;
        let most = ahead.places().first().map_or(0.0, |place| place.1);
        let stands = state.speed <= STANDSTILL_MM_S && state.accel.abs() <= STANDSTILL_MM_S;
        if stands && most <= 0.0 {
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
                self.state.accel = 0.0;
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
        let mut low = (-limits.jerk).max((-limits.accel - state.accel) / time_s);
        let high = limits.jerk.min((limits.accel - state.accel) / time_s);
        if state.after(low, time_s).0.to_let_go(limits) < 0.0 {
            low = -greatest_kept([-high, -low], |back| state.after(-back, time_s).0.to_let_go(limits));
        }
        let (after, way_mm) = state.after(high, time_s);
        ahead.leave_out_kept(after, way_mm, limits);
        low = greatest_kept([low, high], |jerk| {
            let (after, way_mm) = state.after(jerk, time_s);
            let below_mm_s = ahead.cruise + STANDSTILL_MM_S - state.peak_within(jerk, time_s);
            below_mm_s.min(ahead.margin(after, way_mm, limits))
        });
        let (_, way_mm) = state.after(low, time_s);
        if way_mm <= DONE_MM && stands {
            // Too near to a corner that must be taken very slowly: there by itself, and then on.
            return rest_to_rest(rest_mm, ahead.cruise, limits);
        }
        if way_mm > rest_mm {
            time_s = self.time_to(rest_mm, low, time_s);
        }
        Chosen::One { jerk: low, time_s }
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

/// The quickest motion from standstill to standstill, in closed form.
fn rest_to_rest(way_mm: f64, cruise: f64, limits: Limits) -> Chosen {
    let limits = MotionLimits { speed_mm_s: cruise, accel_mm_s2: limits.accel, jerk_mm_s3: limits.jerk };
    SCurve::plan(way_mm, limits).map_or(Chosen::None, |motion| {
        let [jerk_s, steady_s, _, cruise_s, ..] = motion.phases_s();
        Chosen::RestToRest { jerk_s, steady_s, cruise_s }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn what_surely_ends_within_a_distance_does(
            speed in 0.0..1e3_f64,
            share in -1.0..1.0_f64,
            to in prop_oneof![Just(0.0), 0.0..1.0_f64, Just(1.0), 0.999_999..1.000_001],
            accel in 1.0..1e5_f64,
            jerk in 1.0..1e8_f64,
            distance in 0.1..3.0_f64,
        ) {
            let limits = Limits { accel, jerk };
            let (state, to) = (State { speed, accel: share * accel }, to * speed);
            let braking_mm = state.braking_mm(to, limits);
            let distance_mm = distance * braking_mm;
            if state.surely_brakes_within(to, limits, distance_mm) {
                prop_assert!(braking_mm <= distance_mm, "{state:?} to {to}: {braking_mm} mm");
            }
            // It tells where there is twice the room, and some for what rounding may take.
            prop_assert!(
                share < 0.0 || state.surely_brakes_within(to, limits, 2.1 * braking_mm + 0.01 * speed),
                "{state:?} to {to}: {braking_mm} mm"
            );
        }
    }
}
