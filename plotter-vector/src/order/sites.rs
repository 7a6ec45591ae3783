//! [`Sites`]: what the search of a short way orders, each thing with the places where the pen can enter and
//! leave it.

use super::point_tree::PointTree;
use crate::parallel::each;
use crate::stroke::PxPoint;

/// Nearest things that each place knows: with more the search finds little more (D. S. Johnson and L. A.
/// McGeoch, "The traveling salesman problem: a case study in local optimization", 1997, section 3.3).
pub(crate) const NEIGHBOURS: usize = 8;

/// Most places of a ring that a search considers, and of all rings; of very many rings each has two.
pub(crate) const RING_PLACES: usize = 12;
const ALL_RING_PLACES: usize = 240_000;

/// Places whose neighbours are looked for in one go.
const PLACES_TOGETHER: usize = 1024;

/// No place.
pub(super) const NONE: u32 = u32::MAX;

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

/// A thing where it stands in the way: its number and the places (numbered as in [`Sites`]) of entry and
/// exit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Visit {
    pub(crate) site: u32,
    pub(crate) entry: u32,
    pub(crate) exit: u32,
}

/// Things to be ordered, with their places and the neighbours of those.
#[derive(Debug, Default)]
pub(crate) struct Sites<'a> {
    kinds: Vec<Site>,
    /// One past the last place of each thing; nothing as long as each has two.
    ends: Vec<u32>,
    /// Vertices of the drawing, and places that are none.
    vertices: &'a [PxPoint],
    between: Vec<PxPoint>,
    /// Each place by its number among the vertices, or beyond them among the others.
    places: Vec<u32>,
    /// Thing of each place; nothing as long as each has two.
    owners: Vec<u32>,
    /// Vertex of the ring that a place is, or lies behind; nothing as long as there is no ring.
    ring_vertices: Vec<u32>,
}

/// A place of the drawing: one of its vertices by number, or one between them.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stop {
    Vertex(u32),
    Between(PxPoint),
}

impl From<PxPoint> for Stop {
    fn from(at: PxPoint) -> Self {
        Self::Between(at)
    }
}

/// A number that fits, as every number of a drawing in memory does.
pub(crate) fn number(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(NONE)
}

impl<'a> Sites<'a> {
    /// Nothing yet of a drawing with these vertices.
    pub(crate) fn new(vertices: &'a [PxPoint]) -> Self {
        Self { vertices, ..Self::default() }
    }

    /// Makes room for so many lines.
    pub(crate) fn reserve(&mut self, lines: usize) {
        self.kinds.reserve_exact(lines);
        self.places.reserve_exact(2 * lines);
    }

    /// Adds a line; its places are its ends.
    pub(crate) fn push_line<P: Into<Stop>>(&mut self, (from, to): (P, P)) {
        self.add(Site::Line, [(from.into(), 0), (to.into(), 0)].into_iter());
    }

    /// Adds what is drawn from the first place to the second one only.
    pub(crate) fn push_one_way<P: Into<Stop>>(&mut self, (from, to): (P, P)) {
        self.add(Site::OneWay, [(from.into(), 0), (to.into(), 0)].into_iter());
    }

    /// Adds one of so many rings (or dots); its places are at most so many of these, evenly chosen, each with
    /// the vertex before.
    pub(crate) fn push_ring<P: Into<Stop> + Copy>(&mut self, ring: &[(P, u32)], rings: usize, most: usize) {
        let few = (ALL_RING_PLACES / rings.max(1)).clamp(2, most.max(2)).min(ring.len());
        let places = (0..few).filter_map(|k| ring.get(k * ring.len() / few.max(1)).copied());
        self.add(Site::Ring, places.map(|(place, vertex)| (place.into(), vertex)));
    }

    fn add(&mut self, kind: Site, places: impl Iterator<Item = (Stop, u32)>) {
        let site = number(self.kinds.len());
        for (place, vertex) in places {
            self.places.push(match place {
                Stop::Vertex(vertex) => vertex,
                Stop::Between(at) => {
                    self.between.push(at);
                    number(self.vertices.len() + self.between.len() - 1)
                }
            });
            if vertex > 0 || !self.ring_vertices.is_empty() {
                self.ring_vertices.reserve_exact(self.places.capacity() - self.ring_vertices.len());
                self.ring_vertices.resize(self.places.len() - 1, 0);
                self.ring_vertices.push(vertex);
            }
        }
        self.kinds.push(kind);
        let (places, two) = (number(self.places.len()), 2 * site);
        if places != two + 2 || !self.ends.is_empty() {
            if self.ends.is_empty() {
                self.ends.reserve_exact(self.kinds.capacity());
                self.owners.reserve_exact(self.places.capacity());
                self.ends.extend((1..=site).map(|site| 2 * site));
                self.owners.extend((0..two).map(|place| place / 2));
            }
            self.ends.push(places);
            self.owners.resize(self.places.len(), site);
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.kinds.len()
    }

    pub(crate) fn kind(&self, site: u32) -> Site {
        self.kinds.get(site as usize).copied().unwrap_or(Site::Ring)
    }

    /// The places of a thing.
    pub(crate) fn of(&self, site: u32) -> core::ops::Range<u32> {
        if site as usize >= self.len() {
            return 0..0;
        }
        if self.ends.is_empty() {
            return 2 * site..2 * site + 2;
        }
        let from =
            (site as usize).checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0);
        from..self.ends.get(site as usize).copied().unwrap_or(from)
    }

    /// Number of places.
    pub(crate) fn places(&self) -> u32 {
        number(self.places.len())
    }

    /// Where a place lies.
    pub(crate) fn place(&self, place: u32) -> PxPoint {
        let Some(place) = self.places.get(place as usize).map(|place| *place as usize) else {
            return PxPoint::default();
        };
        let between = || self.between.get(place - self.vertices.len());
        self.vertices.get(place).or_else(between).copied().unwrap_or_default()
    }

    pub(crate) fn owner(&self, place: u32) -> u32 {
        if place as usize >= self.places.len() {
            return NONE;
        }
        self.owners.get(place as usize).copied().unwrap_or(place / 2)
    }

    /// Vertex of the ring that a place is, or lies behind.
    pub(crate) fn ring_vertex(&self, place: u32) -> u32 {
        self.ring_vertices.get(place as usize).copied().unwrap_or(0)
    }

    /// The visit that enters at a place; `None` for the end of a one-way line.
    pub(crate) fn enter(&self, place: u32) -> Option<Visit> {
        let site = Some(self.owner(place)).filter(|site| *site != NONE)?;
        let own = self.of(site);
        let exit = match self.kind(site) {
            Site::Ring => place,
            Site::Line => own.start + own.end.checked_sub(place + 1)?,
            Site::OneWay => (place == own.start).then_some(place + 1)?,
        };
        Some(Visit { site, entry: place, exit })
    }

    /// From each exit to the nearest thing not yet drawn, from a place if there is one, else with the first
    /// thing first. Each by the place where it is entered.
    pub(crate) fn nearest_first(&self, from: Option<PxPoint>) -> Vec<u32> {
        let place = |place: u32| self.place(place);
        let mut tree = PointTree::new(self.places.len(), &place);
        for end in (0..self.places()).filter(|place| self.enter(*place).is_none()) {
            tree.remove(end, &place);
        }
        let mut entries = Vec::with_capacity(self.len());
        let mut next = from.map_or_else(|| self.enter(0), |pen| self.enter(tree.nearest(pen, &place)?));
        while let Some(visit) = next {
            self.of(visit.site).for_each(|own| tree.remove(own, &place));
            entries.push(visit.entry);
            next = tree.nearest(self.place(visit.exit), &place).and_then(|place| self.enter(place));
        }
        entries
    }

    /// For each place the nearest place of each of the nearest other things, nearest first; `NONE` where
    /// there are no more.
    pub(crate) fn neighbours(&self) -> Vec<[u32; NEIGHBOURS]> {
        let place = |place: u32| self.place(place);
        let tree = PointTree::new(self.places.len(), &place);
        let near = |own: u32| {
            let owner = self.owner(own);
            let mut found = [(f64::INFINITY, NONE); NEIGHBOURS];
            tree.visit(self.place(own), f64::INFINITY, &place, &mut |place, squared| {
                let other = self.owner(place);
                if other != owner {
                    insert(&mut found, (squared, place), |kept| self.owner(kept) == other);
                }
                found.last().map_or(0.0, |(far, _)| *far)
            });
            found.map(|(_, place)| place)
        };
        let mut all = vec![[NONE; NEIGHBOURS]; self.places.len()];
        let chunks = (0..).step_by(PLACES_TOGETHER).zip(all.chunks_mut(PLACES_TOGETHER));
        each(chunks.collect(), |(from, found): (u32, &mut [[u32; NEIGHBOURS]])| {
            for (own, found) in (from..).zip(found) {
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
        let mut sites = Sites::new(&[]);
        sites.push_line((at(0), at(1)));
        sites.push_ring(&[(at(7), 0), (at(5), 1), (at(6), 2)], 1, RING_PLACES);
        sites.push_one_way((at(9), at(30)));
        let near = sites.neighbours();
        assert_eq!(near[1], [3, 5, NONE, NONE, NONE, NONE, NONE, NONE]);
        assert_eq!(near[6], [2, 1, NONE, NONE, NONE, NONE, NONE, NONE]);
    }

    #[test]
    fn a_one_way_line_is_never_entered_at_its_end() {
        let mut sites = Sites::new(&[]);
        sites.push_line((at(0), at(10)));
        sites.push_one_way((at(30), at(11)));
        assert_eq!(sites.nearest_first(None), [0, 2]);
        assert_eq!(sites.enter(2), Some(Visit { site: 1, entry: 2, exit: 3 }));
        assert_eq!(sites.enter(3), None);
    }
}
