//! [`TimeLaw`]: how the course under way is passed, by ramps or by S-curves. The planner does not ask which.

use super::Phase;
use super::block::Block;
use super::limits::Limits;
use super::modes::{Choice as _, Modes};
use super::ramps::Ramps;
use super::ring::Ring;
use super::s_curve::SCurveState;

/// Looks of a search for a phase that are taken together: each reckons the braking for every place ahead, so
/// a part takes about as long as what goes before the search.
const LOOKS: u32 = 2;

/// What is left of the course given last: constant accelerations, or S-curves where the settings have a jerk.
/// An S-curve leaves its block in the ring until it is over, ramps take it out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TimeLaw<M: Modes>(M::Either<Ramps, SCurveState>);

impl<M: Modes> TimeLaw<M> {
    /// At rest, with nothing left.
    pub(super) fn over(limits: &Limits) -> Self {
        Self(M::Either::of(limits.settings.jerk_of::<M>().is_some()))
    }

    /// The ramps, if they leave something of the course.
    fn ramps_left(&mut self) -> Option<&mut Ramps> {
        self.0.first_mut().filter(|ramps| ramps.rest_mm() > 0.0)
    }

    /// Whether all of it has been taken, of ramps; what S-curves leave is in the ring.
    pub(super) fn is_over(&self) -> bool {
        self.0.first().is_none_or(|ramps| ramps.is_over() && ramps.rest_mm() <= 0.0)
    }

    /// Whether the machine is at rest after what has been taken.
    pub(super) fn stands<const N: usize>(&self, ring: &Ring<N>) -> bool {
        if let Some(s_curve) = self.0.second() {
            return s_curve.stands();
        }
        match self.0.first() {
            Some(ramps) if ramps.rest_mm() > 0.0 => ramps.speed2() <= 0.0,
            _ => ring.get(0).is_none_or(|next| next.entry2 <= 0.0),
        }
    }

    /// Brakes on what is left of the course, and with what speed is left on the next; an S-curve does where
    /// its next phase is asked for.
    pub(super) fn brake<const N: usize>(&mut self, ring: &mut Ring<N>, limits: &Limits) {
        if let Some(ramps) = self.ramps_left() {
            let exit2 = ring.enter_at_most(ramps.forced2(), limits);
            ramps.brake(exit2);
        }
    }

    /// Goes on after a feed hold.
    pub(super) fn go_on<const N: usize>(&mut self, ring: &mut Ring<N>, limits: &Limits) {
        if let Some(ramps) = self.ramps_left() {
            let exit2 = ring.enter_at_most(ramps.most_exit2(), limits);
            ramps.plan::<M>(exit2);
        }
    }

    /// Other greatest speeds hold: an S-curve that has been chosen and not been taken is chosen anew, and it
    /// is said that this is one.
    pub(super) fn choose_anew(&mut self) -> bool {
        if let Some(s_curve) = self.0.second_mut() {
            s_curve.choose_anew();
            return true;
        }
        false
    }

    /// Of ramps, the squares of the least speed at the end of the course under way, and of the one with which
    /// the next block is entered as planned.
    pub(super) fn forced2<const N: usize>(&mut self, ring: &Ring<N>) -> (f32, f32) {
        let next2 = ring.get(0).map_or(0.0, |head| head.entry2);
        let forced2 = self.ramps_left().map_or(next2, |ramps| ramps.forced2());
        (forced2, next2)
    }

    /// Other greatest speeds hold from here on, the square of that of the course under way among them: the
    /// blocks of the ring have them already, and are entered with `next2`.
    pub(super) fn change_speed<const N: usize>(
        &mut self,
        (cruise2, next2): (f32, f32),
        hold: bool,
        ring: &mut Ring<N>,
        limits: &Limits,
    ) {
        let Some(ramps) = self.ramps_left() else {
            return ring.enter_with(next2, limits);
        };
        ramps.cruise_at(cruise2);
        if hold { self.brake(ring, limits) } else { self.go_on(ring, limits) }
    }

    /// Begins the head of the ring, where it is a path, as an S-curve; whether it did.
    pub(super) fn begin_s_curve(&mut self, head: &Block) -> bool {
        if let Some(s_curve) = self.0.second_mut().filter(|_| head.is_path()) {
            s_curve.begin();
            return true;
        }
        false
    }

    /// Begins the head of the ring with ramps, and takes it out.
    pub(super) fn begin_ramps<const N: usize>(&mut self, ring: &mut Ring<N>, limits: &Limits) {
        if let Some(head) = ring.get(0) {
            if let Some(ramps) = self.0.first_mut() {
                ramps.begin::<M>(head, ring.next_entry2(), limits);
            }
            ring.pop();
        }
    }

    /// The next phase of a ramp.
    pub(super) fn next_ramp(&mut self) -> Option<Phase> {
        self.0.first_mut()?.next::<M>()
    }

    /// As [`Self::next_ramp`], for who does not want to hold the machine: a phase, and how many like it make
    /// the ramp.
    pub(super) fn next_whole_ramp(&mut self) -> Option<(Phase, u32)> {
        self.0.first_mut()?.next_whole::<M>()
    }

    /// The next phase of an S-curve over the head of the ring.
    pub(super) fn next_s_curve<const N: usize>(
        &mut self,
        ring: &mut Ring<N>,
        limits: &Limits,
        hold: bool,
        stale: &mut bool,
    ) -> Option<Phase> {
        let jerk_mm_s3 = limits.settings.jerk_of::<M>()?;
        let s_curve = self.0.second_mut()?;
        if core::mem::take(stale) {
            s_curve.choose_again();
        }
        s_curve.next_phase(ring, limits.along_with_jerk().into(), jerk_mm_s3, hold)
    }

    /// A part of the search for it; whether there is more to do first.
    pub(super) fn choose_part<const N: usize>(
        &mut self,
        ring: &Ring<N>,
        limits: &Limits,
        hold: bool,
        stale: &mut bool,
    ) -> bool {
        let Some(jerk_mm_s3) = limits.settings.jerk_of::<M>() else { return false };
        let Some(s_curve) = self.0.second_mut() else { return false };
        if core::mem::take(stale) {
            s_curve.choose_again();
        }
        s_curve.choose_part(LOOKS, ring, limits.along_with_jerk().into(), jerk_mm_s3, hold)
    }

    /// Something else is asked of it: what has been chosen before its time is chosen again.
    pub(super) fn choose_again(&mut self) {
        if let Some(s_curve) = self.0.second_mut() {
            s_curve.choose_again();
        }
    }
}
