//! [`shorten`]: a route is changed piece by piece until no small change makes it shorter, then shaken and
//! mended again as long as the budget lasts.
//!
//! ```text
//!   turn (2-opt)              move (Or-opt)                shake (double bridge)
//!   a─b     a b               a─b   c─d    a───b c d       a B C d   becomes   a C B d
//!        →  │ │  (or ×)         └x──┘   →     x┘ (1 to 3 strokes, either way round)
//!   d─c     d c
//! ```
//!
//! Sources: G. A. Croes, "A method for solving traveling-salesman problems" (1958): two ways are replaced,
//! what lies between them is turned round. I. Or, "Traveling salesman-type combinatorial problems" (1976): up
//! to three stops are moved elsewhere. J. L. Bentley, "Fast algorithms for geometric traveling salesman
//! problems" (1992) and D. S. Johnson and L. A. McGeoch, "The traveling salesman problem: a case study in
//! local optimization" (1997): neighbour lists, a queue of the stops near a change, the array that turns its
//! shorter side, and the limit of what is turned. O. Martin, S. W. Otto and E. W. Felten, "Large-step Markov
//! chains for the traveling salesman problem" (1991): shaking with the double bridge, kept local.

use super::route::{Reading, Route};
use super::sites::{NEIGHBOURS, Site, Sites};
use crate::stroke::PxPoint;
use plotter_motion::SplitMix64;
use std::collections::VecDeque;

/// Gain below which nothing is changed, px: far below any pen, far above the rounding of a sum of four ways.
const LEAST_GAIN_PX: f64 = 1e-7;

/// Most things moved together.
const MOVED_TOGETHER: usize = 3;

/// Most things turned by one change, in the first descent and after a shake.
const TURNED_AT_FIRST: usize = 50_000;
const TURNED_LATER: usize = 1_000;

/// Longest stretch that a shake moves.
const SHAKEN: usize = 30;

/// Most shakes for each thing, and at least so many; a small drawing has been through all that helps long
/// before its budget ends.
const SHAKES: u64 = 30;
const FEWEST_SHAKES: u64 = 300;

/// A shorter order of the visits, by the places where they are entered. `budget` counts what is looked at and
/// what is moved.
pub(super) fn shorten(
    sites: &Sites<'_>,
    entries: Vec<u32>,
    from: Option<PxPoint>,
    budget: u64,
    shakes: bool,
) -> Vec<u32> {
    if entries.len() != sites.len() || entries.len() < 2 || !has_way(sites, &entries, from) {
        return entries;
    }
    let mut search = Search::new(sites, &entries, from, budget);
    search.settle();
    if shakes {
        search.turned = TURNED_LATER;
        search.shake();
    }
    search.route.visits().into_iter().map(|visit| visit.entry).collect()
}

/// Whether the pen travels at all: a million dots in one place are in order, and no look makes them more so.
fn has_way(sites: &Sites<'_>, entries: &[u32], from: Option<PxPoint>) -> bool {
    let mut at = from;
    let mut visits = entries.iter().filter_map(|entry| sites.enter(*entry));
    visits.any(|visit| at.replace(sites.place(visit.exit)).is_some_and(|at| at != sites.place(visit.entry)))
}

/// A change of the route, as read in a direction.
#[derive(Clone, Copy, Debug)]
enum Change {
    /// From the first thing to the last one everything is turned round.
    Turn { first: u32, last: u32 },
    /// From the first thing to the last one everything is put after another thing.
    Move { first: u32, last: u32, after: u32, reversed: bool },
    /// A ring is put after another thing (or stays) and entered at a place.
    Ring { site: u32, after: u32, place: u32 },
}

struct Search<'a> {
    sites: &'a Sites<'a>,
    near: Vec<[u32; NEIGHBOURS]>,
    route: Route,
    /// Things near which something was changed, each once.
    queue: VecDeque<u32>,
    queued: Vec<bool>,
    looked: u64,
    budget: u64,
    turned: usize,
}

/// The change that gains most so far, by what the way grows.
type Best = Option<(f64, Reading, Change)>;

impl<'a> Search<'a> {
    /// Before the first change; everything is queued.
    fn new(sites: &'a Sites<'a>, entries: &[u32], from: Option<PxPoint>, budget: u64) -> Self {
        let mut search = Self {
            sites,
            near: sites.neighbours(),
            route: Route::new(sites, entries, from),
            queue: VecDeque::new(),
            queued: vec![false; entries.len() + 1],
            looked: 0,
            budget,
            turned: TURNED_AT_FIRST,
        };
        entries.iter().for_each(|entry| search.enqueue(sites.owner(*entry)));
        search
    }

    fn spent(&self) -> bool {
        self.looked + self.route.moved >= self.budget
    }

    fn enqueue(&mut self, site: u32) {
        if !core::mem::replace(&mut self.queued[site as usize], true) {
            self.queue.push_back(site);
        }
    }

    /// Changes the route until nothing near the queue gains; returns by how much it grew (never above 0).
    fn settle(&mut self) -> f64 {
        let mut growth = 0.0;
        while let Some(site) = self.queue.pop_front() {
            self.queued[site as usize] = false;
            while !self.spent() {
                let Some(gain) = self.improve(site) else { break };
                growth += gain;
            }
        }
        growth
    }

    /// Makes the best change that begins with a new way to or from `site`; returns by how much the way grew.
    fn improve(&mut self, site: u32) -> Option<f64> {
        let mut turns = true;
        loop {
            let mut best = None;
            self.look_beyond_the_exit(Reading::Up, site, turns, &mut best);
            self.look_beyond_the_exit(Reading::Down, site, turns, &mut best);
            self.look_round_the_ring(site, &mut best);
            let (growth, reading, change) = best.filter(|(growth, ..)| *growth < -LEAST_GAIN_PX)?;
            let made = self.make(growth, reading, change);
            if made.is_some() || !turns {
                return made;
            }
            // One-way things spoil the turn: what else is there?
            turns = false;
        }
    }

    /// Changes that replace the way after `site` by a shorter one from its exit.
    fn look_beyond_the_exit(&mut self, reading: Reading, site: u32, turns: bool, best: &mut Best) {
        let route = &self.route;
        let exit = route.exit(reading, site);
        let next = route.next(reading, site);
        let way = route.distance(exit, route.entry(reading, next));
        let Some(near) = self.near.get(exit as usize).filter(|_| way > LEAST_GAIN_PX) else { return };
        for place in near.iter().copied() {
            self.looked += 1;
            let other = self.sites.owner(place);
            let new = if other == u32::MAX { f64::INFINITY } else { route.distance(exit, place) };
            if new >= way {
                break;
            }
            let at_exit = place == route.exit(reading, other);
            let at_entry = place == route.entry(reading, other);
            if at_exit && turns {
                let after = route.next(reading, other);
                let across = route.distance(route.entry(reading, next), route.entry(reading, after));
                let growth = new + across - way - route.way(reading, other);
                let count = route.steps(reading, next, other) + 1;
                if count.min(route.len() - count) <= self.turned {
                    consider(best, growth, reading, Change::Turn { first: next, last: other });
                }
            }
            if !at_exit && !at_entry {
                self.looked += 1;
                self.consider_ring(other, site, place, reading, best);
                continue;
            }
            let back = reading.other();
            let stretches = [
                // Others come here: a stretch that begins, or ends, at the place.
                at_entry.then_some((other, reading, site, false)),
                at_exit.then_some((other, back, site, true)),
                // Or a stretch that ends with this one goes there.
                at_entry.then_some((site, back, route.before(reading, other), false)),
                at_exit.then_some((site, back, other, true)),
            ];
            for (seed, outwards, after, reversed) in stretches.into_iter().flatten() {
                let growth = Moved::new(route, (reading, outwards), seed, after, reversed);
                let mut far = seed;
                for _ in 0..MOVED_TOGETHER {
                    if far == after || (reversed && !route.may_turn(far)) {
                        break;
                    }
                    self.looked += 1;
                    let (first, last) = if outwards == reading { (seed, far) } else { (far, seed) };
                    if after != route.before(reading, first) {
                        let change = Change::Move { first, last, after, reversed };
                        consider(best, growth.up_to(route, far), reading, change);
                    }
                    far = route.next(outwards, far);
                }
            }
        }
    }

    /// Another place of the ring itself, and places beside the neighbours of all its places.
    fn look_round_the_ring(&mut self, site: u32, best: &mut Best) {
        let reading = Reading::Up;
        if site as usize >= self.sites.len() || self.sites.kind(site) != Site::Ring {
            return;
        }
        let (before, after) = (self.route.before(reading, site), self.route.next(reading, site));
        let (from, to) = (self.route.exit(reading, before), self.route.entry(reading, after));
        let ways = self.route.way(reading, before) + self.route.way(reading, site);
        let saved = ways - self.route.distance(from, to);
        for place in self.sites.of(site) {
            self.looked += 1;
            let here = self.route.distance(from, place) + self.route.distance(place, to);
            consider(best, here - ways, reading, Change::Ring { site, after: before, place });
            let Some(near) = self.near.get(place as usize) else { continue };
            for other_place in near.iter().copied() {
                let other = self.sites.owner(other_place);
                if other == u32::MAX || self.route.distance(place, other_place) >= saved {
                    break;
                }
                self.looked += 1;
                for reading in [Reading::Up, Reading::Down] {
                    if other_place == self.route.exit(reading, other) {
                        self.consider_ring(site, other, place, reading, best);
                    }
                }
            }
        }
    }

    /// The ring, entered at a place, between `after` and the next one.
    fn consider_ring(&self, site: u32, after: u32, place: u32, reading: Reading, best: &mut Best) {
        let route = &self.route;
        let (before, next, beyond) =
            (route.before(reading, site), route.next(reading, site), route.next(reading, after));
        if self.sites.kind(site) != Site::Ring || after == before || after == site {
            return;
        }
        let left = route.distance(route.exit(reading, before), route.entry(reading, next))
            - route.way(reading, before)
            - route.way(reading, site);
        let put = route.distance(route.exit(reading, after), place)
            + route.distance(place, route.entry(reading, beyond))
            - route.way(reading, after);
        consider(best, left + put, reading, Change::Ring { site, after, place });
    }

    /// Makes a change and queues what it touches; `None`, and nothing is changed, when it gains nothing after
    /// all.
    fn make(&mut self, growth: f64, mut reading: Reading, change: Change) -> Option<f64> {
        let route = &mut self.route;
        let touched = match change {
            Change::Turn { first, last } => {
                let (before, after) = (route.before(reading, first), route.next(reading, last));
                let changes = route.changes();
                let growth = growth + route.turn(&mut reading, first, last);
                if growth >= -LEAST_GAIN_PX {
                    route.undo_to(changes);
                    return None;
                }
                [before, first, last, after].iter().for_each(|site| self.enqueue(*site));
                return Some(growth);
            }
            Change::Move { first, last, after, reversed } => {
                move_after(route, reading, (first, last), after, reversed)
            }
            Change::Ring { site, after, place } => {
                let touched = if after == route.before(reading, site) {
                    [after, site, site, site, site, route.next(reading, site)]
                } else {
                    move_after(route, reading, (site, site), after, false)
                };
                route.enter(site, place);
                touched
            }
        };
        touched.iter().for_each(|site| self.enqueue(*site));
        Some(growth)
    }

    /// Shakes the route at one place after the other; what does not make it shorter is undone.
    fn shake(&mut self) {
        let all = self.route.len();
        // Two stretches and two things beside them.
        let Some(most) = all.checked_sub(3).filter(|most| *most > 0) else { return };
        // The last thing may turn where all may.
        let turnable = self.route.may_turn(self.route.home());
        let mut random = SplitMix64::new(0);
        for _ in 0..FEWEST_SHAKES.max(SHAKES.saturating_mul(all as u64)) {
            if self.spent() {
                break;
            }
            self.route.keep();
            let after = self.route.at(random.below(all));
            let moved = 1 + random.below(most.min(SHAKEN));
            let passed = 1 + random.below((all - 2 - moved).min(SHAKEN));
            let first = self.route.ahead(after, 1);
            let last = self.route.ahead(after, moved);
            let target = self.route.ahead(after, moved + passed);
            self.looked += (moved + passed) as u64 / 4;
            let reversed = random.below(2) == 0 && turnable;
            let growth = growth_of_move(&self.route, Reading::Up, (first, last), target, reversed);
            let touched = move_after(&mut self.route, Reading::Up, (first, last), target, reversed);
            touched.iter().for_each(|site| self.enqueue(*site));
            if growth + self.settle() >= 0.0 {
                self.route.undo_to(0);
            }
            // Out of budget, the queue is not empty.
            while let Some(site) = self.queue.pop_front() {
                self.queued[site as usize] = false;
            }
        }
        self.route.keep();
    }
}

fn consider(best: &mut Best, growth: f64, reading: Reading, change: Change) {
    if best.is_none_or(|(least, ..)| growth < least) {
        *best = Some((growth, reading, change));
    }
}

/// What is the same for all stretches that go on from one thing outwards and are put after the same other
/// thing: the sum for each is that of [`growth_of_move`].
struct Moved {
    outwards: Reading,
    /// Whether the stretch is read outwards too.
    is_along: bool,
    /// The place before the first thing, and the way from there.
    before: u32,
    gap: f64,
    /// The places between which the stretch is put, and the way between them.
    put: (u32, u32),
    put_gap: f64,
    /// Whether the first thing comes to the first of these places, and how far it is from its own one.
    is_first: bool,
    near: f64,
}

impl Moved {
    fn new(
        route: &Route,
        (reading, outwards): (Reading, Reading),
        seed: u32,
        after: u32,
        reversed: bool,
    ) -> Self {
        let is_along = outwards == reading;
        let before = route.exit(outwards, route.before(outwards, seed));
        let own = route.entry(outwards, seed);
        let put = (route.exit(reading, after), route.entry(reading, route.next(reading, after)));
        let is_first = is_along != reversed;
        Self {
            outwards,
            is_along,
            before,
            gap: route.distance(before, own),
            put,
            put_gap: route.distance(put.0, put.1),
            is_first,
            near: route.distance(own, if is_first { put.0 } else { put.1 }),
        }
    }

    /// By how much the way grows with the stretch up to a thing.
    fn up_to(&self, route: &Route, far: u32) -> f64 {
        let own = route.exit(self.outwards, far);
        let next = route.entry(self.outwards, route.next(self.outwards, far));
        let closed = route.distance(self.before, next);
        let gap = route.distance(own, next);
        let left = if self.is_along { closed - self.gap - gap } else { closed - gap - self.gap };
        if self.is_first {
            left + self.near + route.distance(own, self.put.1) - self.put_gap
        } else {
            left + route.distance(self.put.0, own) + self.near - self.put_gap
        }
    }
}

/// By how much the way grows when a stretch is put after a thing that is neither in it nor just before it.
fn growth_of_move(
    route: &Route,
    reading: Reading,
    (first, last): (u32, u32),
    after: u32,
    reversed: bool,
) -> f64 {
    let (before, next) = (route.before(reading, first), route.next(reading, last));
    let beyond = route.next(reading, after);
    let (mut head, mut tail) = (route.entry(reading, first), route.exit(reading, last));
    let left = route.distance(route.exit(reading, before), route.entry(reading, next))
        - route.distance(route.exit(reading, before), head)
        - route.distance(tail, route.entry(reading, next));
    if reversed {
        (head, tail) = (tail, head);
    }
    let (from, to) = (route.exit(reading, after), route.entry(reading, beyond));
    left + route.distance(from, head) + route.distance(tail, to) - route.distance(from, to)
}

/// Puts a stretch after a thing, by turning it together with what lies between, and that back again. Returns
/// the things whose ways are new.
fn move_after(
    route: &mut Route,
    mut reading: Reading,
    (first, last): (u32, u32),
    after: u32,
    reversed: bool,
) -> [u32; 6] {
    let (before, next) = (route.before(reading, first), route.next(reading, last));
    let beyond = route.next(reading, after);
    let reading = &mut reading;
    if route.steps(*reading, last, after) < route.steps(*reading, after, first) {
        route.turn(reading, first, after);
        route.turn(reading, after, next);
    } else {
        route.turn(reading, beyond, last);
        route.turn(reading, before, beyond);
    }
    if !reversed {
        route.turn(reading, last, first);
    }
    [before, first, last, next, after, beyond]
}

#[cfg(test)]
mod tests {
    use super::super::sites::{RING_PLACES, Visit};
    use super::*;

    fn at(x: i32, y: i32) -> PxPoint {
        PxPoint::new(x.into(), y.into())
    }

    /// Lines in the order in which they are drawn, each from its first place to its second one.
    fn lines(ends: impl IntoIterator<Item = ((i32, i32), (i32, i32))>) -> (Sites<'static>, Vec<u32>) {
        let mut sites = Sites::new(&[]);
        let mut visits = Vec::new();
        for ((from, to), site) in ends.into_iter().zip(0..) {
            sites.push_line((at(from.0, from.1), at(to.0, to.1)));
            visits.push(2 * site);
        }
        (sites, visits)
    }

    #[test]
    fn where_the_pen_never_travels_there_is_no_way() {
        let (sites, visits) = lines([((0, 0), (5, 5)), ((5, 5), (9, 0))]);
        assert!(!has_way(&sites, &visits, None) && !has_way(&sites, &visits, Some(at(0, 0))));
        assert!(has_way(&sites, &visits, Some(at(1, 0))));
        let (sites, visits) = lines([((0, 0), (5, 5)), ((5, 6), (9, 0))]);
        assert!(has_way(&sites, &visits, None));
    }

    /// What is left when no small change gains any more, before anything is shaken: the things in order,
    /// negative less one where drawn from their second place, and the way.
    fn settled((sites, visits): &(Sites<'_>, Vec<u32>)) -> (Vec<i64>, f64) {
        let mut search = Search::new(sites, visits, None, u64::MAX);
        search.settle();
        let name = |visit: &Visit| {
            let site = i64::from(visit.site);
            if visit.entry > visit.exit { -site - 1 } else { site }
        };
        (search.route.visits().iter().map(name).collect(), search.route.length())
    }

    #[test]
    fn a_long_stretch_drawn_from_its_far_end_is_turned_round() {
        // Three columns of five lines, each drawn downwards: 2 x 208 px between them where 2 x 200 do. To
        // move three lines or fewer elsewhere makes it longer.
        let down = |x: i32| (0..5).rev().map(move |k| ((x, 12 * k + 10), (x, 12 * k)));
        let (order, length) = settled(&lines([0, 200, 400].into_iter().flat_map(down)));
        assert_eq!(length, 2.0 * 200.0 + 3.0 * 4.0 * 2.0, "{order:?}");
    }

    #[test]
    fn lines_left_behind_are_drawn_on_the_way() {
        // One, two or three lines beside the way are drawn last: all of them are moved, in their order or
        // turned.
        for left in 1..=3 {
            for is_turned in [false, true] {
                let mut beside: Vec<_> = (0..left).map(|k| ((200 + 4 * k, 6), (202 + 4 * k, 6))).collect();
                if is_turned {
                    beside = beside.into_iter().rev().map(|(from, to)| (to, from)).collect();
                }
                let row = (0..40).map(|k| ((10 * k, 0), (10 * k + 8, 0)));
                let (order, length) = settled(&lines(row.chain(beside)));
                // Before the last line of the row there is nothing but what was left.
                assert!(order.iter().take(3).eq(&[0, 1, 2]), "{left}: {order:?}");
                assert!(length < 39.0 * 2.0 + 20.0, "{left}, {is_turned}: {length} px by {order:?}");
            }
        }
    }

    #[test]
    fn a_ring_is_drawn_on_the_way_from_the_place_that_is_near() {
        let mut sites = Sites::new(&[]);
        let mut visits = Vec::new();
        for (x, site) in (0..200).step_by(10).zip(0..) {
            sites.push_line((at(x, 0), at(x + 8, 0)));
            visits.push(2 * site);
        }
        // A square beside the middle of the row, drawn last and from its far corner.
        sites.push_ring(
            &[(99, 61), (69, 31), (99, 1), (129, 31)].map(|(x, y)| (at(x, y), 0)),
            1,
            RING_PLACES,
        );
        visits.push(40);
        let (order, length) = settled(&(sites, visits));
        assert_eq!(order.iter().position(|site| *site == 20), Some(10), "{order:?}");
        assert!(length < 18.0 * 2.0 + 3.0, "{length}");
    }

    #[test]
    fn the_work_ends_with_the_budget() {
        // What one thing at most takes beyond it: looking all round, and turning half of all.
        const BEYOND: u64 = 300 + 1000;
        let scattered = |k: i32| ((k * 7919 % 1000, k * 104_729 % 1000), (k * 31 % 1000, k * 977 % 1000));
        let (sites, visits) = lines((0..2000).map(scattered));
        for budget in [0, 1, 1000, 20_000, 500_000] {
            let mut search = Search::new(&sites, &visits, None, budget);
            let before = search.route.length();
            search.settle();
            search.shake();
            let work = search.looked + search.route.moved;
            assert!(work <= budget + BEYOND, "{work} of {budget}");
            assert!(search.route.length() < before || budget < 1000);
        }
    }

    #[test]
    fn what_a_move_gains_is_the_same_to_the_last_bit_however_it_is_summed_up() {
        let end = |n: i32| ((n * 37) % 101, (n * 53) % 89);
        let (sites, visits) = lines((0..12).map(|n| (end(2 * n), end(2 * n + 1))));
        let route = Route::new(&sites, &visits, None);
        for reading in [Reading::Up, Reading::Down] {
            for (outwards, reversed) in
                [reading, reading.other()].into_iter().flat_map(|way| [(way, false), (way, true)])
            {
                for (seed, after) in (2..9).flat_map(|seed| [(seed, 0), (seed, 11)]) {
                    let moved = Moved::new(&route, (reading, outwards), seed, after, reversed);
                    let mut far = seed;
                    for _ in 0..2 {
                        let stretch = if outwards == reading { (seed, far) } else { (far, seed) };
                        let growth = growth_of_move(&route, reading, stretch, after, reversed);
                        assert_eq!(moved.up_to(&route, far).to_bits(), growth.to_bits());
                        far = route.next(outwards, far);
                    }
                }
            }
        }
    }
}
