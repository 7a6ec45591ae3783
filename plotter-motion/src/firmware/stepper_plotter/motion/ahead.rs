//! What the motion side does differently when it is asked for its steps ahead of their time.

use super::super::ahead::energy::Curve;
use super::super::ahead::makes::Makes;
use super::super::play::Gap;
use super::super::{Link, Stop};
use super::{Motion, State};
use crate::planner::{Action, Keep as _, Modes, Phase};
use crate::stepgen::MotorEvent;
use crate::{LimitSwitches, PlannerSettings, SafetyGate, StepPoint};
use core::time::Duration;

/// What the motors have really done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Made {
    /// Steps made.
    pub(in super::super) at: StepPoint,
    pub(in super::super) gap: Gap,
    /// Steps of a third motor made.
    #[cfg(feature = "third-motor")]
    pub(in super::super) z: i32,
    /// Whether these are all that have been given.
    pub(in super::super) stands: bool,
}

/// What only a motion side needs that is ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ahead {
    /// None while it is not.
    pub(super) made: Option<Made>,
    curve: Curve,
    /// How many courses and phases there have been.
    stretches: u32,
    /// All that is planned has been given; the motors are not there yet.
    ended: bool,
    /// What the planner does next is done in part.
    pub(super) in_parts: bool,
    has_homed: bool,
}

impl Ahead {
    /// Notes how the path goes on.
    pub(super) fn note(&mut self, action: &Action) {
        self.ended = false;
        self.stretches = self.stretches.wrapping_add(1);
        if let Action::Course(course) = action {
            self.curve = Curve::of(&course.shape, course.length_mm);
        }
    }

    /// The course in hand rises; z is driven as hard as it may be by so much along it, mm/s².
    #[cfg(feature = "third-motor")]
    pub(super) const fn rises(&mut self, of_z_mm_s2: f32) {
        let bends = matches!(self.curve, Curve::Arc(_));
        self.curve = Curve::Rising { of_z_mm_s2, bends };
    }

    /// All that is planned has been given: whether the motors have yet to make it.
    pub(super) fn waits_for_motors(&mut self) -> bool {
        self.ended = self.made.is_some_and(|made| !made.stands);
        self.ended
    }

    /// The motors stand at the origin from here on.
    pub(super) fn homed(&mut self) {
        if let Some(made) = &mut self.made {
            (made.at, made.gap) = (StepPoint::default(), Gap::default());
            self.has_homed = true;
        }
    }
}

impl<M: Modes> Motion<M> {
    /// From here on steps are given ahead of their time; the gate goes to who makes them.
    pub(in super::super) fn begin_ahead(&mut self) -> SafetyGate {
        let (at, gap) = self.stands_at();
        self.ahead.made = Some(Made {
            at,
            gap,
            #[cfg(feature = "third-motor")]
            z: self.z_steps().unwrap_or_default(),
            stands: true,
        });
        let gate = &self.gate;
        let mut own = SafetyGate::new(gate.limits(), gate.is_latched());
        #[cfg(feature = "third-motor")]
        {
            own.set_z_limits(gate.z_limits());
            if let Some(second) = self.settings.second {
                own.set_second_limits(second.axis, gate.second_limits());
            }
        }
        own.emergency_stop(gate.is_button_pressed());
        core::mem::replace(&mut self.gate, own)
    }

    /// Where the motors stand, and how far each has come within its play.
    pub(in super::super) fn stands_at(&self) -> (StepPoint, Gap) {
        (self.position, self.play.get().map(super::Play::gap).unwrap_or_default())
    }

    pub(in super::super) const fn gate(&self) -> &SafetyGate {
        &self.gate
    }

    /// The limits in force.
    pub(in super::super) const fn limits(&self) -> PlannerSettings {
        *self.planner.settings()
    }

    /// When the next event is due of what is planned, us; none where the planner is to be asked first.
    pub(in super::super) fn event_us(&mut self) -> Option<u64> {
        if self.next.is_none() && !self.waits_for_time() {
            self.next = self.next_event();
        }
        Some(whole_us(self.base).saturating_add(self.next?.tick))
    }

    /// Asks the planner for more, at the time of the last event; says whether there may be an event now.
    pub(in super::super) fn plan_more(&mut self, clock_us: u64, link: &mut Link) -> bool {
        !self.waits_for_time() && self.go_on(Duration::from_micros(clock_us), link)
    }

    /// Whether a part of what the planner has to do next was done, and there is more of it.
    pub(super) fn plans_a_part(&mut self) -> bool {
        self.ahead.in_parts = self.ahead.made.is_some() && self.planner.prepare();
        self.ahead.in_parts
    }

    /// Whether there was, which is left for the next call.
    pub(in super::super) const fn take_in_parts(&mut self) -> bool {
        core::mem::replace(&mut self.ahead.in_parts, false)
    }

    /// Takes that event: a step, or something else that is done at once.
    pub(in super::super) fn take_planned(&mut self, link: &mut Link) -> Option<Makes> {
        let event = self.next.take()?.event;
        match event {
            // Whether a limit switch is in its way is known at its time, to the gate of who makes it.
            MotorEvent::Step(step) if !self.gate.is_stopped() => return Some(Makes::Pair(step)),
            MotorEvent::Step(_) => self.stop(Stop::Emergency, link),
            #[cfg(feature = "third-motor")]
            MotorEvent::StepZ(way) if !self.gate.is_stopped() => return Some(Makes::Z(way)),
            #[cfg(feature = "third-motor")]
            MotorEvent::StepZ(_) => self.stop(Stop::Emergency, link),
            _ => {
                self.give(event, link);
            }
        }
        None
    }

    /// Whether what it does next depends on what time it is: a machine that stands, or homes, or is stopped.
    pub(in super::super) fn waits_for_time(&self) -> bool {
        self.state != State::Ready || self.at_rest
    }

    /// Whether all that is planned has been given.
    pub(in super::super) const fn has_ended(&self) -> bool {
        self.ahead.ended
    }

    /// The motors have come to where they were to.
    pub(in super::super) const fn come_to_rest(&mut self) {
        self.at_rest |= self.ahead.ended;
    }

    pub(in super::super) fn is_homing(&self) -> bool {
        matches!(self.state, State::Homing(_))
    }

    pub(in super::super) const fn is_dark(&self) -> bool {
        self.dark
    }

    /// Whether the planner has room for what a host may send.
    pub(in super::super) fn could_take_more(&self) -> bool {
        !self.held && !self.cancelling && self.planner.has_room()
    }

    /// The number of the phase in which steps are planned.
    pub(in super::super) const fn stretch(&self) -> u32 {
        self.ahead.stretches
    }

    /// That phase, and when it began, us.
    pub(in super::super) fn phased(&self) -> (u64, Phase, Curve) {
        let (began, phase) = self.phase.unwrap_or((Duration::ZERO, Phase::default()));
        (whole_us(began), phase, self.ahead.curve)
    }

    /// All that is to come is put off.
    pub(in super::super) fn put_off(&mut self, by: Duration) {
        self.base = self.base.saturating_add(by);
    }

    /// There is something for the motors to make.
    pub(in super::super) const fn note_given(&mut self) {
        if let Some(made) = &mut self.ahead.made {
            made.stands = false;
        }
    }

    pub(in super::super) fn note_made(&mut self, made: Made) {
        self.ahead.made = Some(made);
        #[cfg(feature = "third-motor")]
        self.stand_at_z(made.z);
    }

    /// Whether it has just homed: the motors stand at the origin from here on.
    pub(in super::super) const fn take_homed(&mut self) -> bool {
        core::mem::replace(&mut self.ahead.has_homed, false)
    }

    /// Notes all switches and the button.
    pub(in super::super) const fn note_switches(&mut self, limits: LimitSwitches, button: bool) {
        self.gate.set_limits(limits);
        self.gate.emergency_stop(button);
    }

    pub(in super::super) const fn stop_by_host(&mut self) {
        self.gate.stop_by_host(true);
    }

    /// The motors were stopped here; what was given after that was not made.
    pub(in super::super) fn come_back_to(&mut self, at: StepPoint, gap: Gap) {
        self.position = at;
        if let Some(play) = self.play.get_mut() {
            play.stopped_at(gap);
        }
    }

    /// They were stopped for this.
    pub(in super::super) fn stop_for(&mut self, why: Stop, link: &mut Link) {
        self.stop(why, link);
        self.ahead.ended = false;
        if let Stop::Reset { .. } = why {
            self.end_overrides();
        }
    }
}

/// A time in microseconds.
pub(in super::super) fn whole_us(time: Duration) -> u64 {
    // `as_micros` reckons with 128 bits.
    time.as_secs().saturating_mul(1_000_000).saturating_add(time.subsec_micros().into())
}
