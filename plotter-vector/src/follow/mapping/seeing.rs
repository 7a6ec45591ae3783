//! What a window shows: where the camera is by it, and what it adds to the map.

use super::super::Lost;
use super::super::align::aligned;
use super::super::flat::Flat;
use super::super::line_map::State;
use super::super::lines::Lines;
use super::super::prior::{Information, Prior, moved_sd_px};
use super::super::registration::{View, registered};
use super::MappingFollower;
use crate::stroke::PxPoint;

/// A line ends where the machine would have to go farther than this beyond its area, px.
const BEYOND_PX: f64 = 0.5;

/// Most windows in a row that are looked at wholly because one shows something elsewhere.
const MOST_AGAIN: u32 = 3;

/// So many places of lines, 2 px from each other, tell their width.
const LEAST_PLACES: usize = 15;

/// Lines that are thinner than this share of what they were are believed after so many looks.
const THIN_SHARE: f64 = 0.6;
const THIN_LOOKS: u32 = 3;

/// A place whose better known direction is known worse than this adds nothing to the map, px.
const STRANGE_PX: f64 = 1.0;

/// What a window says of the camera's place.
pub(super) struct Seen {
    pub(super) place: PxPoint,
    pub(super) told: Information,
    /// With what was known before.
    pub(super) known: Information,
    /// It does not show what it should.
    pub(super) is_lost: bool,
}

impl MappingFollower {
    /// Where the camera should be by what is known of the table, with the last move's errors.
    pub(super) fn prior(&self, pose: PxPoint) -> Prior {
        let way = self.last_pose.map_or(0.0, |last| last.distance(pose));
        let random = moved_sd_px(way);
        let (place, doubt_px) = self.axes.place(pose);
        let sd = doubt_px.map(|doubt| libm::hypot(random, doubt));
        Prior { place, information: self.known.after(sd) }
    }

    /// Where the camera is by a window: from the last one that was looked at wholly, then from the map.
    pub(super) fn registered(&mut self, flat: &Flat, middle: PxPoint, prior: &Prior, reach_px: f64) -> Seen {
        let moved = self.keyframes.place(flat, middle, prior, 0.6 * self.width_px);
        let known = moved.unwrap_or(*prior);
        // A window that fits the last one is not searched for elsewhere; one that does not, farther each time.
        let search_px = match (moved, self.tries) {
            (Some(_), _) => 0,
            (None, 0) => 6,
            (None, 1) => 12,
            _ => 40,
        };
        let view = View { flat, middle, width_px: self.width_px, reach_px };
        let fix = registered(&mut self.map, &view, &known, search_px);
        let own = moved.map_or_else(Information::default, |moved| moved.information.minus(prior.information));
        Seen {
            place: fix.map_or(known.place, |fix| fix.place),
            told: fix.map_or(own, |fix| own.plus(fix.told)),
            known: known.information.plus(fix.map_or_else(Information::default, |fix| fix.told)),
            is_lost: fix.is_some_and(|fix| fix.is_lost()),
        }
    }

    /// Puts all that a window shows into the map.
    pub(super) fn look(&mut self, flat: &Flat, middle: PxPoint) -> usize {
        let place = self.keyframes.choose(flat, middle, self.place, self.told, 0.1 * self.width_px);
        let shifts = self.keyframes.settled();
        self.map.keyframe = self.keyframes.number();
        let place = shifts.as_ref().map_or(place, |by| place + by.of(self.map.keyframe));
        if let Some(by) = shifts {
            self.map.move_with(&by);
            self.seats.forget();
        }
        self.axes.shift(place - self.place);
        self.place = place;
        let lines = Lines::of(flat, self.settings.max_line_px);
        self.looked_at = Some(place);
        // A crumb of a line at the window's rim does not tell how wide lines are.
        let places: usize = lines.pieces.iter().map(|piece| piece.places.len()).sum();
        if lines.width_px > 0.0 && places >= LEAST_PLACES {
            // Nor does one window in which they are much thinner than in all others.
            let is_thin = !self.map.nodes.is_empty() && lines.width_px < THIN_SHARE * self.width_px;
            self.thin_looks = if is_thin { self.thin_looks + 1 } else { 0 };
            if !is_thin || self.thin_looks >= THIN_LOOKS {
                (self.width_px, self.margin_px) = (lines.width_px, lines.margin_px);
            }
        }
        self.last_seen = if lines.has_ink { Lost::TooThick } else { Lost::OneColour };
        if let Some(area) = lines.area {
            let at = place + (area - middle);
            if self.report.areas.iter().all(|known| known.distance(at) > 60.0)
                && self.report.areas.len() < 1000
            {
                self.report.areas.push(at);
            }
        }
        let mut pieces = lines.pieces;
        for at in pieces.iter_mut().flat_map(|piece| &mut piece.places) {
            *at = place + (*at - middle);
        }
        let (known, first_link) = (self.map.nodes.len(), self.map.links.len());
        aligned(&mut self.map, flat, &pieces, middle, place, self.margin_px);
        if self.seats.seat(&mut self.map, &pieces, place, self.width_px) && self.looks_again < MOST_AGAIN {
            (self.looked_at, self.looks_again) = (None, self.looks_again + 1);
        } else {
            self.looks_again = 0;
        }
        let dark_at = |at: PxPoint| flat.at(middle + (at - place));
        let mut darks: Vec<f32> =
            pieces.iter().flat_map(|piece| &piece.places).step_by(7).map(|at| dark_at(*at)).collect();
        darks.sort_by(f32::total_cmp);
        let half = 0.5 * darks.get(darks.len() / 2).copied().unwrap_or(1.0);
        let new = self.map.insert(&pieces, self.width_px, &|at| dark_at(at) > half);
        self.mark_outside(first_link);
        self.find_ghosts(flat, middle, known);
        let trusted = (middle.x - self.margin_px, middle.y - self.margin_px);
        if let Some(search) = &mut self.search {
            search.see(place, trusted);
        }
        new
    }

    /// Whether what is seen may be put into the map: not where the camera came without lines to lines that it should know.
    pub(super) fn knows_place(&self, middle: PxPoint) -> bool {
        let [(_, one_px), (_, other_px)] = self.known.known();
        let reach = libm::hypot(middle.x, middle.y) + 4.0 * f64::max(one_px, other_px);
        f64::min(one_px, other_px) < STRANGE_PX || self.map.near(self.place, reach).is_empty()
    }

    pub(super) fn is_reachable(&self, at: PxPoint) -> bool {
        self.settings.area.is_none_or(|[from, to]| {
            at.x >= from.x - 0.5 && at.y >= from.y - 0.5 && at.x <= to.x + 0.5 && at.y <= to.y + 0.5
        })
    }

    /// New links that lead out of the area are not followed.
    pub(super) fn mark_outside(&mut self, first_link: usize) {
        for id in first_link..self.map.links.len() {
            let Some(link) = self.map.links.get(id).copied().filter(|link| !link.contact) else { continue };
            let inside = link.ends.map(|end| self.is_reachable(self.map.at(end)));
            if inside == [true, true] {
                continue;
            }
            if let Some(link) = self.map.links.get_mut(id) {
                link.state = State::Outside;
            }
            let at = self.map.at(if inside[0] { link.ends[0] } else { link.ends[1] });
            if inside[0] || inside[1] {
                self.leaves_at(at);
            }
        }
    }

    /// A line leaves the machine's area at a place.
    pub(super) fn leaves_at(&mut self, at: PxPoint) {
        let is_new = self.report.leaves.iter().all(|known| known.distance(at) > 10.0);
        if is_new && self.report.leaves.len() < 1000 {
            self.report.leaves.push(at);
        }
    }

    /// Whether the machine's limits keep the tool from a place.
    pub(super) fn is_beyond(&self, at: PxPoint) -> bool {
        self.axes.beyond_px(at, self.settings.area) > BEYOND_PX
    }

    /// Lines of the map that are not there.
    pub(super) fn find_ghosts(&mut self, flat: &Flat, middle: PxPoint, known: usize) {
        let reach = libm::hypot(middle.x, middle.y);
        for id in self.map.near(self.place, reach) {
            let seen_at = middle + (self.map.at(id) - self.place);
            let is_ahead =
                self.map.links_of(id).any(|(_, link, _)| link.state == State::Ahead && !link.contact);
            let inside = flat.holds(seen_at, self.margin_px + 8.0);
            if (id as usize) < known && is_ahead && inside && flat.at(seen_at) < 0.05 + 2.0 * flat.noise {
                self.map.miss(id);
            }
        }
    }
}
