//! [`Ahead`]: what the motion has to keep.

use super::motion::{Limits, STANDSTILL_MM_S, State};
use crate::planner::ring::Ring;

/// Distance by which rounding may make a braking end too late, mm: `f64` holds a block of a kilometre to a
/// tenth of it.
pub(super) const SLACK_MM: f64 = 1e-9;
/// The speeds that are allowed ahead: the first `count` places with their distance from the present one, mm
/// and mm/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead<const N: usize> {
    places: [(f64, f64); N],
    count: usize,
    /// Greatest speed up to the first of them.
    pub(super) cruise: f64,
}

impl<const N: usize> Ahead<N> {
    pub(super) fn new(ring: &Ring<N>, rest_mm: f64, limits: Limits) -> Self {
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

    pub(super) fn places(&self) -> &[(f64, f64)] {
        self.places.get(..self.count).unwrap_or(&[])
    }

    /// Leaves out the places that a state keeps with room to spare: every state that is slower, has less
    /// acceleration and has not come so far keeps them too, for all of its brakings are shorter.
    pub(super) fn leave_out_kept(&mut self, state: State, way_mm: f64, limits: Limits) {
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
    pub(super) fn is_viable(&self, state: State, way_mm: f64, limits: Limits) -> bool {
        let peak = state.peak(limits);
        self.room_for(state, peak) >= 0.0
            && self.places().iter().all(|&(place_mm, most)| {
                peak <= most || state.brakes_within(most, limits, place_mm - way_mm + SLACK_MM)
            })
    }

    /// By how much it keeps everything, the least of speeds in mm/s and distances in mm; below 0 it does not.
    pub(super) fn margin(&self, state: State, way_mm: f64, limits: Limits) -> f64 {
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
    pub(super) fn room_for(&self, state: State, peak: f64) -> f64 {
        let forwards = state.speed + STANDSTILL_MM_S;
        // How far it is from turning back does not fall with a greater jerk, and is no margin to go by.
        if forwards < 0.0 { forwards } else { self.cruise * (1.0 + 1e-12) + STANDSTILL_MM_S - peak }
    }
}
