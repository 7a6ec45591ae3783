//! [`Sites`]: what the search of a short way orders, each thing with the places where the pen can enter and leave it.

use super::point_tree::PointTree;
use crate::PxPoint;
use crate::centrelines::each;

/// Nearest things that each place knows: with more the search finds little more (D. S. Johnson and L. A. McGeoch,
/// "The traveling salesman problem: a case study in local optimization", 1997, section 3.3).
pub(crate) const NEIGHBOURS: usize = 8;

/// Most places of a ring that the search considers, and of all rings; of very many rings each has two.
pub(crate) const RING_PLACES: usize = 12;
const ALL_RING_PLACES: usize = 240_000;

/// Places whose neighbours are looked for in one go.
const PLACES_TOGETHER: usize = 1024;

/// No place.
const NONE: u32 = u32::MAX;

/// How a thing is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Site {
    /// From one of its two places to the other, either way.
    Line,
    /// From the first place to the second one.
    OneWay,
    /// From the place at which it is entered back to that place.
    Ring,
}

/// A thing where it stands in the way: its number and the places (numbered as in [`Sites`]) of entry and exit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Visit {
    pub(crate) site: u32,
    pub(crate) entry: u32,
    pub(crate) exit: u32,
}

/// Things to be ordered, with their places and the neighbours of those.
#[derive(Debug, Default)]
pub(crate) struct Sites {
    kinds: Vec<Site>,
    /// One past the last place of each thing.
    ends: Vec<u32>,
    pub(crate) places: Vec<PxPoint>,
    /// Thing of each place.
    owners: Vec<u32>,
    /// Vertex of the ring that a place is, or lies behind.
    pub(crate) vertices: Vec<u32>,
}

/// A number that fits, as every number of a drawing in memory does.
pub(crate) fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(NONE)
}

impl Sites {
    /// Adds a line; its places are its ends.
    pub(crate) fn push_line(&mut self, (from, to): (PxPoint, PxPoint)) {
        self.add(Site::Line, [(from, 0), (to, 0)].into_iter());
    }

    /// Adds what is drawn from the first place to the second one only.
    pub(crate) fn push_one_way(&mut self, (from, to): (PxPoint, PxPoint)) {
        self.add(Site::OneWay, [(from, 0), (to, 0)].into_iter());
    }

    /// Adds one of so many rings (or dots); its places are some of these, evenly chosen, each with the vertex
    /// before.
    pub(crate) fn push_ring(&mut self, ring: &[(PxPoint, u32)], rings: usize) {
        let few = (ALL_RING_PLACES / rings.max(1)).clamp(2, RING_PLACES).min(ring.len());
        let places = (0..few).filter_map(|k| ring.get(k * ring.len() / few.max(1)).copied());
        self.add(Site::Ring, places);
    }

    fn add(&mut self, kind: Site, places: impl Iterator<Item = (PxPoint, u32)>) {
        for (place, vertex) in places {
            self.places.push(place);
            self.vertices.push(vertex);
            self.owners.push(number(self.kinds.len()));
        }
        self.kinds.push(kind);
        self.ends.push(number(self.places.len()));
    }

    pub(crate) fn len(&self) -> usize {
        self.kinds.len()
    }

    pub(crate) fn kind(&self, site: u32) -> Site {
        self.kinds.get(site as usize).copied().unwrap_or(Site::Ring)
    }

    /// The places of a thing.
    pub(crate) fn of(&self, site: u32) -> core::ops::Range<u32> {
        let from =
            (site as usize).checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        from..self.ends.get(site as usize).copied().unwrap_or(from)
    }

    /// Where a place lies.
    pub(crate) fn place(&self, place: u32) -> PxPoint {
        self.places.get(place as usize).copied().unwrap_or_default()
    }

    pub(crate) fn owner(&self, place: u32) -> u32 {
        self.owners.get(place as usize).copied().unwrap_or(NONE)
    }

    /// The visit that enters at a place; `None` for the end of a one-way line.
    fn enter(&self, place: u32) -> Option<Visit> {
        let site = self.owner(place);
        let own = self.of(site);
        let exit = match self.kind(site) {
            Site::Ring => place,
            Site::Line => own.start + own.end.checked_sub(place + 1)?,
            Site::OneWay => (place == own.start).then_some(place + 1)?,
        };
        Some(Visit { site, entry: place, exit })
    }

    /// From each exit to the nearest thing not yet drawn, from a place if there is one, else with the first thing first.
    pub(crate) fn nearest_first(&self, from: Option<PxPoint>) -> Vec<Visit> {
        let mut tree = PointTree::new(self.places.iter().copied());
        for place in (0..number(self.places.len())).filter(|place| self.enter(*place).is_none()) {
            tree.remove(place);
        }
        let mut visits = Vec::with_capacity(self.len());
        let mut next = from.map_or_else(|| self.enter(0), |pen| self.enter(tree.nearest(pen)?));
        while let Some(visit) = next {
            self.of(visit.site).for_each(|place| tree.remove(place));
            visits.push(visit);
            next = tree.nearest(self.place(visit.exit)).and_then(|place| self.enter(place));
        }
        visits
    }

    /// For each place the nearest place of each of the nearest other things, nearest first; `NONE` where there are
    /// no more.
    pub(crate) fn neighbours(&self) -> Vec<[u32; NEIGHBOURS]> {
        let tree = PointTree::new(self.places.iter().copied());
        let near = |(at, owner): (&PxPoint, &u32)| {
            let mut found = [(f64::INFINITY, NONE); NEIGHBOURS];
            tree.visit(*at, f64::INFINITY, &mut |place, squared| {
                let other = self.owner(place);
                if other != *owner {
                    insert(&mut found, (squared, place), |kept| self.owner(kept) == other);
                }
                found.last().map_or(0.0, |(far, _)| *far)
            });
            found.map(|(_, place)| place)
        };
        let mut all = vec![[NONE; NEIGHBOURS]; self.places.len()];
        let places = self.places.chunks(PLACES_TOGETHER).zip(self.owners.chunks(PLACES_TOGETHER));
        each(places.zip(all.chunks_mut(PLACES_TOGETHER)).collect(), |((places, owners), found)| {
            for (own, found) in places.iter().zip(owners).zip(found) {
                *found = near(own);
            }
        });
        all
    }
}

/// Puts a place into the sorted list: in the stead of a farther one of the same thing, else of the last one.
fn insert(found: &mut [(f64, u32)], new: (f64, u32), same: impl Fn(u32) -> bool) {
    let own = found.iter().position(|(_, kept)| *kept != NONE && same(*kept)).unwrap_or(found.len() - 1);
    if found.get(own).is_none_or(|kept| kept.0 <= new.0) {
        return;
    }
    let at = found.partition_point(|kept| kept.0 <= new.0).min(own);
    if let Some(stretch) = found.get_mut(at..=own) {
        stretch.rotate_right(1);
        if let Some(slot) = stretch.first_mut() {
            *slot = new;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: u32) -> PxPoint {
        PxPoint::new(f64::from(x), 0.0)
    }

    #[test]
    fn a_place_knows_each_near_thing_once_by_its_nearest_place() {
        let mut sites = Sites::default();
        sites.push_line((at(0), at(1)));
        sites.push_ring(&[(at(7), 0), (at(5), 1), (at(6), 2)], 1);
        sites.push_one_way((at(9), at(30)));
        let near = sites.neighbours();
        assert_eq!(near[1], [3, 5, NONE, NONE, NONE, NONE, NONE, NONE]);
        assert_eq!(near[6], [2, 1, NONE, NONE, NONE, NONE, NONE, NONE]);
    }

    #[test]
    fn a_one_way_line_is_never_entered_at_its_end() {
        let mut sites = Sites::default();
        sites.push_line((at(0), at(10)));
        sites.push_one_way((at(30), at(11)));
        let visits = sites.nearest_first(None);
        assert_eq!(visits[1], Visit { site: 1, entry: 2, exit: 3 });
    }
}
