//! [`Route`]: an order of things that can be changed and changed back cheaply.

use super::sites::{Site, Sites, Visit, number};
use crate::stroke::PxPoint;

/// Things in a cycle, one more than there are: the last one is where the pen comes from and goes to. The way
/// from its entry is free, so the way round the cycle is the way that is looked for.
///
/// Turning a stretch round is the same as turning the rest round, read the other way; so the shorter one is
/// turned. One-way things keep their direction as read from the last thing on.
#[derive(Debug)]
pub(crate) struct Route {
    /// Things in the order in which they stand in the cycle.
    order: Vec<u32>,
    /// Where each thing stands.
    place: Vec<u32>,
    /// Places at which each thing is entered and left when the cycle is walked upwards.
    ports: Vec<[u32; 2]>,
    /// Coordinates of the places.
    places: Vec<PxPoint>,
    /// Places from this one on are as near to everything as can be.
    anywhere: u32,
    one_way: Vec<u32>,
    is_one_way: Vec<bool>,
    /// What was done since the last [`Route::keep`].
    log: Vec<Change>,
    /// Things touched by all changes: what the work has cost.
    pub(crate) moved: u64,
}

#[derive(Clone, Copy, Debug)]
enum Change {
    /// Things from one standing to another, upwards.
    Turned(u32, u32),
    /// A ring that was entered at this place.
    Entered(u32, u32),
}

/// A direction of reading: everything below is said once and holds both ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reading {
    Up,
    Down,
}

impl Reading {
    pub(crate) fn other(self) -> Self {
        if self == Self::Up { Self::Down } else { Self::Up }
    }
}

impl Route {
    /// The route of the visits that enter at these places, each thing once, from a place or from anywhere.
    pub(crate) fn new(sites: &Sites<'_>, entries: &[u32], from: Option<PxPoint>) -> Self {
        let visits: Vec<Visit> = entries.iter().filter_map(|entry| sites.enter(*entry)).collect();
        let mut places: Vec<PxPoint> = (0..sites.places()).map(|place| sites.place(place)).collect();
        let (start, end) = (number(places.len()), number(places.len() + 1));
        places.extend([from.unwrap_or_default(), PxPoint::default()]);
        let home = number(visits.len());
        let mut ports = vec![[0; 2]; visits.len() + 1];
        let mut place = vec![0; visits.len() + 1];
        for (visit, standing) in visits.iter().zip(0..) {
            ports[visit.site as usize] = [visit.entry, visit.exit];
            place[visit.site as usize] = standing;
        }
        ports[home as usize] = [end, start];
        place[home as usize] = home;
        let is_one_way: Vec<bool> =
            (0..=home).map(|site| site < home && matches!(sites.kind(site), Site::OneWay)).collect();
        Self {
            order: visits.iter().map(|visit| visit.site).chain([home]).collect(),
            place,
            ports,
            places,
            anywhere: if from.is_some() { end } else { start },
            one_way: (0..home).filter(|site| is_one_way[*site as usize]).collect(),
            is_one_way,
            log: Vec::new(),
            moved: 0,
        }
    }

    /// Number of things, with the last one that stands for the way's ends.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    pub(crate) fn at(&self, standing: usize) -> u32 {
        let all = self.order.len();
        self.order[if standing < all { standing } else { standing % all }]
    }

    /// The last thing: the ends of the way.
    pub(crate) fn home(&self) -> u32 {
        number(self.order.len() - 1)
    }

    pub(crate) fn distance(&self, a: u32, b: u32) -> f64 {
        if a >= self.anywhere || b >= self.anywhere {
            return 0.0;
        }
        let (a, b) = (self.places[a as usize], self.places[b as usize]);
        let (dx, dy) = (a.x - b.x, a.y - b.y);
        libm::sqrt(dx * dx + dy * dy)
    }

    /// Place at which a thing is left as read.
    pub(crate) fn exit(&self, reading: Reading, site: u32) -> u32 {
        self.ports[site as usize][usize::from(reading == Reading::Up)]
    }

    /// Place at which a thing is entered as read.
    pub(crate) fn entry(&self, reading: Reading, site: u32) -> u32 {
        self.exit(reading.other(), site)
    }

    pub(crate) fn next(&self, reading: Reading, site: u32) -> u32 {
        let standing = self.place[site as usize] as usize;
        let last = self.order.len() - 1;
        let next = match reading {
            Reading::Up if standing == last => 0,
            Reading::Up => standing + 1,
            Reading::Down if standing == 0 => last,
            Reading::Down => standing - 1,
        };
        self.order[next]
    }

    /// The thing so many steps on, upwards.
    pub(crate) fn ahead(&self, site: u32, steps: usize) -> u32 {
        self.at(self.place[site as usize] as usize + steps)
    }

    pub(crate) fn before(&self, reading: Reading, site: u32) -> u32 {
        self.next(reading.other(), site)
    }

    /// Way from a thing to the next one.
    pub(crate) fn way(&self, reading: Reading, site: u32) -> f64 {
        self.distance(self.exit(reading, site), self.entry(reading, self.next(reading, site)))
    }

    /// Steps from one thing to another as read.
    pub(crate) fn steps(&self, reading: Reading, from: u32, to: u32) -> usize {
        let (from, to) = (self.place[from as usize] as usize, self.place[to as usize] as usize);
        let (from, to) = if reading == Reading::Up { (from, to) } else { (to, from) };
        if to >= from { to - from } else { to + self.order.len() - from }
    }

    /// Whether a thing may be turned as if its way were the same from both ends. Turning the last thing turns
    /// all others, so with one-way things among them it may not.
    pub(crate) fn may_turn(&self, site: u32) -> bool {
        self.one_way.is_empty() || (site as usize + 1 < self.order.len() && !self.is_one_way[site as usize])
    }

    /// Turns the things from `first` to `last`, as read, round. Returns by how much the way grows because
    /// one-way things keep their direction. The reading is changed so that it reads on as if only this
    /// stretch were turned.
    pub(crate) fn turn(&mut self, reading: &mut Reading, first: u32, last: u32) -> f64 {
        let count = self.steps(*reading, first, last) + 1;
        let (low, high) = if *reading == Reading::Up { (first, last) } else { (last, first) };
        let (low, high) = (self.place[low as usize], self.place[high as usize]);
        let all = self.order.len();
        let (low, high) = if 2 * count > all {
            *reading = reading.other();
            (number((high as usize + 1) % all), number((low as usize + all - 1) % all))
        } else {
            (low, high)
        };
        if count == all {
            return 0.0;
        }
        self.log.push(Change::Turned(low, high));
        self.turn_standing(low as usize, high as usize)
    }

    /// Turns the things that stand from `low` up to `high` round.
    fn turn_standing(&mut self, low: usize, high: usize) -> f64 {
        let all = self.order.len();
        let count = (high + all - low) % all + 1;
        let (mut a, mut b) = (low, high);
        for _ in 0..count.div_ceil(2) {
            let (at_a, at_b) = (self.order[a], self.order[b]);
            self.stand(at_b, a);
            if a != b {
                self.stand(at_a, b);
            }
            a = if a + 1 == all { 0 } else { a + 1 };
            b = if b == 0 { all - 1 } else { b - 1 };
        }
        self.moved += (count as u64) / 2 + 1;
        self.keep_directions(low, count)
    }

    fn stand(&mut self, site: u32, standing: usize) {
        self.order[standing] = site;
        self.place[site as usize] = number(standing);
        self.ports[site as usize].swap(0, 1);
    }

    /// Turns the one-way things back that were turned as read from the last thing on.
    fn keep_directions(&mut self, low: usize, count: usize) -> f64 {
        if self.one_way.is_empty() {
            return 0.0;
        }
        let all = self.order.len();
        // Steps up from the first that was turned.
        let steps = |site: u32| {
            let standing = self.place[site as usize] as usize;
            if standing >= low { standing - low } else { standing + all - low }
        };
        // With the last thing among those turned, everything is read from the other side.
        let turned = if steps(self.home()) < count { count..all } else { 0..count };
        let mut found: Vec<u32> = if turned.len() < self.one_way.len() {
            let at = |steps: usize| self.at(low + steps);
            turned.map(at).filter(|site| self.is_one_way[*site as usize]).collect()
        } else {
            self.one_way.iter().copied().filter(|site| turned.contains(&steps(*site))).collect()
        };
        // The sum is the same wherever they stand.
        found.sort_unstable();
        let mut growth = 0.0;
        for site in found {
            let ways = |route: &Self| route.way(Reading::Up, site) + route.way(Reading::Down, site);
            growth -= ways(self);
            self.ports[site as usize].swap(0, 1);
            growth += ways(self);
        }
        self.moved += self.one_way.len() as u64;
        growth
    }

    /// Enters a ring at another place.
    pub(crate) fn enter(&mut self, site: u32, place: u32) {
        self.log.push(Change::Entered(site, self.ports[site as usize][0]));
        self.ports[site as usize] = [place; 2];
    }

    /// How much was done since the last `keep`.
    pub(crate) fn changes(&self) -> usize {
        self.log.len()
    }

    /// Makes what was done final.
    pub(crate) fn keep(&mut self) {
        self.log.clear();
    }

    /// Undoes all but the first so many changes.
    pub(crate) fn undo_to(&mut self, changes: usize) {
        while self.log.len() > changes {
            match self.log.pop() {
                Some(Change::Turned(low, high)) => {
                    self.turn_standing(low as usize, high as usize);
                }
                Some(Change::Entered(site, place)) => self.ports[site as usize] = [place; 2],
                None => {}
            }
        }
    }

    /// The visits in order.
    pub(crate) fn visits(&self) -> Vec<Visit> {
        let home = self.home();
        // Upwards when the last thing's exit is where the pen comes from.
        let start = number(self.places.len() - 2);
        let reading = if self.exit(Reading::Up, home) == start { Reading::Up } else { Reading::Down };
        let mut visits = Vec::with_capacity(self.order.len() - 1);
        let mut site = self.next(reading, home);
        while site != home {
            visits.push(Visit { site, entry: self.entry(reading, site), exit: self.exit(reading, site) });
            site = self.next(reading, site);
        }
        visits
    }

    /// Whole way.
    #[cfg(test)]
    pub(crate) fn length(&self) -> f64 {
        self.order.iter().map(|site| self.way(Reading::Up, *site)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: u32) -> PxPoint {
        PxPoint::new(f64::from(x), 0.0)
    }

    /// Lines of 1 px, 10 px apart; the third one is one-way.
    fn row() -> (Sites<'static>, Route) {
        let mut sites = Sites::new(&[]);
        for k in 0..6 {
            let (from, to) = (at(10 * k), at(10 * k + 1));
            if k == 2 { sites.push_one_way((from, to)) } else { sites.push_line((from, to)) }
        }
        let visits = sites.nearest_first(None);
        let route = Route::new(&sites, &visits, None);
        (sites, route)
    }

    #[test]
    fn turning_a_stretch_is_read_as_that_whichever_side_was_turned() {
        for (first, last, order) in [(0, 1, [1, 0, 2, 3, 4, 5]), (1, 4, [0, 4, 3, 2, 1, 5])] {
            let (_, mut route) = row();
            let mut reading = Reading::Up;
            route.turn(&mut reading, first, last);
            let sites: Vec<u32> = route.visits().iter().map(|visit| visit.site).collect();
            assert_eq!(sites, order);
            // The first of the stretch is now its last.
            assert_eq!(route.next(reading, first), last + 1);
        }
    }

    #[test]
    fn one_way_things_keep_their_direction_and_the_growth_is_told() {
        let (sites, mut route) = row();
        let before = route.length();
        // Symmetric: the ways inside the stretch stay, two change.
        let two = route.distance(route.exit(Reading::Up, 0), route.exit(Reading::Up, 4))
            + route.distance(route.entry(Reading::Up, 1), route.entry(Reading::Up, 5));
        let two = two - route.way(Reading::Up, 0) - route.way(Reading::Up, 4);
        let growth = route.turn(&mut Reading::Up, 1, 4);
        assert!((route.length() - before - two - growth).abs() < 1e-9);
        for visit in route.visits() {
            assert!(
                visit.site != 2 || (visit.entry, visit.exit) == (sites.of(2).start, sites.of(2).start + 1)
            );
        }
        route.undo_to(0);
        assert_eq!(route.length(), before);
        let entries: Vec<u32> = route.visits().iter().map(|visit| visit.entry).collect();
        assert_eq!(entries, sites.nearest_first(None));
    }
}
