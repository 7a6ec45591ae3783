//! [`Planning`]: the half in the main loop.

#[cfg(feature = "third-motor")]
mod third;
mod told;

use super::super::motion::{Made, whole_us};
use super::super::{Drivers, Host, Receive, SettingsError, Signal, StepperPlotter, Stop};
use super::Stepping;
use super::energy::{Curve, Energy};
use super::makes::Makes;
#[cfg(feature = "third-motor")]
use super::shared::Third;
use super::shared::{Found, In, Orders, StepsAhead, either};
use super::words::{MOST_AFTER_US, MOST_WAIT_US, MOST_WORDS, Stretch, Word};
use crate::extremes::{greatest, least};
use crate::planner::{AllModes, Modes, Phase, PlanError};
use crate::safety::Blocked;
use crate::{Axis, Direction, PlannerSettings, StepPair};
use core::sync::atomic::Ordering;
use core::time::Duration;

/// Steps of a stretch, at most: four words of its own on sixteen of steps.
const STEPS: usize = 16;
/// Room that [`Planning::plan`] needs to go on: a stretch of so many steps with a wait before each, the
/// servo, the laser.
const ROOM: u32 = MOST_WORDS * (16 + 3);
/// A stretch ends after this, us: what is braked away on it counts from step to step alike, though the speed
/// changes; at 1000 mm/s² by 2 mm/s in that time.
const STRETCH_US: u64 = 2_000;
/// Events farther ahead than this are waited for, us: a second. So no pause fills the memory.
const FAR_US: u64 = 1_000_000;
/// With this more than it takes to brake a host is waited for that has sent too little to look ahead, us:
/// some lines of a slow line, and a main loop that is away.
const WAITS_US: u64 = 50_000;
/// Most things that one call of [`Planning::plan`] puts in: its longest time is that of two stretches, and
/// what the planner needs for a block, or for a part of a search for one: see [`Planner::prepare`].
///
/// [`Planner::prepare`]: crate::Planner::prepare
const MOST_PUT: usize = 32;

/// How often there may be more room, a stop that has been heard of or a standstill: a tenth of what is
/// planned more than it takes to brake.
const EVERY: Duration = Duration::from_millis(5);

/// Why all that waits is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flush {
    /// The machine was stopped.
    Stop(Stop),
    /// The motors stand at the origin.
    Homed,
}

/// Steps that are still to be put in.
#[derive(Clone, Debug, Default)]
struct Gathered {
    /// Which motors, and how long after what was before, us.
    steps: [(Makes, u64); STEPS],
    count: usize,
    ways: StepPair,
    /// The number of their phase, which begins with them.
    stretch: u32,
    begins: bool,
    /// When what was before the first of them was due, and how long all of them take, us.
    began_us: u64,
    us: u64,
}

/// Plans ahead of the steps: the whole of a [`StepperPlotter`] but what makes them. For a main loop or a task
/// of low priority.
///
/// After each input, and again and again, call [`plan`](Self::plan); fetch the answers
/// ([`transmit`](Self::transmit)). It may come late as long as there are steps for [`Stepping`].
#[derive(Debug)]
pub struct Planning<'a, H: Host = Receive, M: Modes = AllModes> {
    plotter: StepperPlotter<H, M>,
    steps: In<'a>,
    energy: Energy,
    gathered: Gathered,
    /// The phase of what was gathered last: when it began, us, itself, and how its path curves.
    phase: (u64, Phase, Curve),
    /// When what was put in last is due, as planned, us.
    clock_us: u64,
    orders: Orders,
    /// Its limit switches, and the steps at which the other half began to count.
    #[cfg(feature = "third-motor")]
    third: Third,
    #[cfg(feature = "third-motor")]
    z_from: i32,
    /// What the other half has not heard of yet.
    waits_for: Option<Flush>,
    put_off_us: u32,
    /// In this call something was planned without the lines that a host may still send.
    is_behind: bool,
    pen_deg: u8,
    power: u16,
    was_dark: bool,
    was_latched: bool,
    /// Presses of the button that the other half has told of.
    presses: u8,
    /// When [`plan`](Self::plan) was called last.
    planned_at: Duration,
}

impl<H: Host, M: Modes> StepperPlotter<H, M> {
    /// Takes a machine that stands, one that was just made, apart: into one half that plans in the main loop
    /// and one that steps in a timer's interrupt, with `memory` between them.
    ///
    /// # Errors
    ///
    /// [`PlanError::Averaging`] for a jerk that is limited as a vector: how hard a machine may brake whose
    /// steps run out is known of planned motion only, not of its average.
    pub fn split<const N: usize>(
        mut self,
        memory: &mut StepsAhead<N>,
    ) -> Result<(Planning<'_, H, M>, Stepping<'_>), SettingsError> {
        let motion = &mut self.motion;
        let settings = *motion.settings();
        if settings.planner.vector_jerk().is_some() {
            return Err(SettingsError::Planner(PlanError::Averaging { quantity: "two halves" }));
        }
        let at = motion.stands_at();
        let (limits, is_latched) = (motion.gate().limits(), motion.gate().is_latched());
        let is_pressed = motion.gate().is_button_pressed();
        let (steps, out) = memory.ends(at.0, at.1);
        let gate = motion.begin_ahead();
        let stepping = Stepping::new(out, gate, at, settings.backlash, motion.pen_deg());
        #[cfg(feature = "third-motor")]
        let stepping = stepping.with_second(settings.second.map(|second| second.axis));
        #[cfg(feature = "third-motor")]
        let (third, z_from) = (
            Third { z: motion.gate().z_limits(), second: motion.gate().second_limits() },
            motion.z_steps().unwrap_or_default(),
        );
        let orders = Orders { limits, button: is_pressed, latched: is_latched, ..Orders::default() };
        let steps_per_mm = settings.x_steps_per_mm.max(settings.y_steps_per_mm);
        let pen_deg = motion.pen_deg();
        let energy = Energy::of(&motion.limits(), steps_per_mm);
        let planning = Planning {
            plotter: self,
            steps,
            energy,
            gathered: Gathered { ways: StepPair { x: 1, y: 1 }, ..Gathered::default() },
            phase: (0, Phase::default(), Curve::Line),
            clock_us: 0,
            orders,
            #[cfg(feature = "third-motor")]
            third,
            #[cfg(feature = "third-motor")]
            z_from,
            waits_for: None,
            put_off_us: 0,
            is_behind: false,
            pen_deg,
            power: 0,
            was_dark: false,
            was_latched: is_latched,
            presses: 0,
            planned_at: Duration::ZERO,
        };
        planning.order();
        #[cfg(feature = "third-motor")]
        planning.steps.shared.third.store(planning.third.bits().into(), Ordering::Release);
        Ok((planning, stepping))
    }
}

impl<H: Host, M: Modes> Planning<'_, H, M> {
    /// Takes a byte from the host.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        self.look(now);
        match self.plotter.receive.receive(byte) {
            // What it did is told with where it really stopped.
            Some(Signal::Reset) => {
                let during = self.plotter.motion.status(now).activity;
                self.plotter.motion.stop_by_host();
                self.stop(Stop::Reset { during });
            }
            Some(signal) => self.plotter.motion.signal(now, signal, &mut self.plotter.link),
            None => {}
        }
        self.end_call(now);
    }

    /// Plans as much as there is room for, a few steps at a time; says whether it is to be called again at
    /// once, since there is more. Then, and whenever it has been called, let the other half look whether
    /// there is something for it, if that is armed for no time: [`Stepping::tick`].
    pub fn plan(&mut self, now: Duration) -> bool {
        self.look(now);
        self.planned_at = now;
        self.is_behind = false;
        let more = self.plan_some(now);
        if !more || self.is_behind {
            self.put_gathered();
        }
        self.end_call(now);
        more
    }

    /// Plans some things, or a part of one that takes long; says whether there may be more.
    fn plan_some(&mut self, now: Duration) -> bool {
        for _ in 0..MOST_PUT {
            if !self.plan_one(now) {
                return self.is_behind;
            }
            if self.plotter.motion.take_in_parts() {
                break;
            }
        }
        true
    }

    /// Plans one thing, if there is one and room for it; says whether there may be more.
    fn plan_one(&mut self, now: Duration) -> bool {
        if self.waits_for.is_some() || self.steps.room() < ROOM {
            return false;
        }
        let StepperPlotter { motion, link, .. } = &mut self.plotter;
        if motion.waits_for_time() || (motion.has_ended() && link.commands.is_empty()) {
            return self.is_at_rest() && self.ask(now);
        }
        let Some(at_us) = motion.event_us() else { return self.plan_more(now) };
        if at_us.saturating_sub(self.clock_us) > FAR_US {
            // A long pause, or hardly any speed at all.
            if !self.is_at_rest() {
                return false;
            }
            self.clock_us = whole_us(now);
            if at_us.saturating_sub(self.clock_us) > FAR_US {
                return false;
            }
        }
        let StepperPlotter { motion, link, .. } = &mut self.plotter;
        match motion.take_planned(link) {
            Some(step) => self.gather(at_us, step),
            None => self.put_others(at_us),
        }
        self.plotter.motion.note_given();
        true
    }

    /// Asks the planner for more; says whether there may be.
    fn plan_more(&mut self, now: Duration) -> bool {
        if self.plotter.link.commands.is_empty() && self.plotter.motion.could_take_more() {
            // A host that sends little by little: what is not taken from the planner yet can be planned anew.
            let ahead_us = self.clock_us.saturating_sub(whole_us(now));
            let PlannerSettings { speed_mm_s, travel_speed_mm_s, .. } = self.plotter.motion.limits();
            let fastest = crate::geom::single(speed_mm_s.max(travel_speed_mm_s));
            let enough_us = self.energy.braking_us(fastest).saturating_add(WAITS_US);
            if !self.has_work_done(now) {
                if self.steps.is_half_full() || ahead_us > enough_us {
                    return false;
                }
                // One more, and then the host is heard first.
                if core::mem::replace(&mut self.is_behind, true) {
                    return false;
                }
            }
        }
        let StepperPlotter { motion, link, .. } = &mut self.plotter;
        motion.plan_more(self.clock_us, link)
            || if motion.has_ended() { self.is_at_rest() && self.ask(now) } else { self.has_work_done(now) }
    }

    /// Whether all has been made that was planned up to a standstill.
    fn is_at_rest(&mut self) -> bool {
        self.put_gathered();
        self.steps.tell_rest();
        self.steps.is_drained()
    }

    /// Whether the receive side has anything for the motion side.
    fn has_work_done(&mut self, now: Duration) -> bool {
        let before = self.plotter.link.commands.len();
        self.plotter.work(now);
        self.plotter.link.commands.len() > before
    }

    /// Asks the motion side what it does at this time, where it stands or homes.
    fn ask(&mut self, now: Duration) -> bool {
        let motion = &mut self.plotter.motion;
        // What has been put off puts off what waits for the end of a pause, too.
        let put_off_us = self.steps.shared.put_off_us.load(Ordering::Acquire);
        let more_us = put_off_us.wrapping_sub(core::mem::replace(&mut self.put_off_us, put_off_us));
        motion.put_off(Duration::from_micros(more_us.into()));
        motion.come_to_rest();
        let made = self.made(true);
        self.plotter.motion.note_made(made);
        self.clock_us = whole_us(now);
        let before = (self.plotter.link.commands.len(), self.pen_deg, self.power);
        #[cfg(feature = "third-motor")]
        let second = self.plotter.settings().second;
        let step = self.plotter.poll(now, Drivers::Ready).map(|step| {
            #[cfg(feature = "third-motor")]
            if let Some(makes) = third::makes(step.pulse, second) {
                return (step.at, makes);
            }
            (step.at, Makes::Pair(step.pulse.into()))
        });
        #[cfg(feature = "third-motor")]
        self.note_homed_z(made.z, step.map(|(_, makes)| makes));
        self.put_others(self.clock_us);
        if self.plotter.motion.take_homed() {
            self.flush(Flush::Homed);
            self.order();
            return false;
        }
        if let Some((at, step)) = step {
            self.gather(whole_us(at), step);
            self.put_gathered();
            self.plotter.motion.note_given();
            return true;
        }
        !self.plotter.motion.waits_for_time()
            || before != (self.plotter.link.commands.len(), self.pen_deg, self.power)
    }

    /// Puts in what servo and laser do, if that has changed.
    fn put_others(&mut self, at_us: u64) {
        let motion = &self.plotter.motion;
        let (pen_deg, power, is_dark) = (motion.pen_deg(), motion.beam().power(), motion.is_dark());
        let ends_darkness = core::mem::replace(&mut self.was_dark, is_dark) && !is_dark;
        if pen_deg == self.pen_deg && power == self.power && !ends_darkness {
            return;
        }
        self.put_gathered();
        let us = self.after_us(at_us);
        put_wait(&mut self.steps, us);
        if core::mem::replace(&mut self.pen_deg, pen_deg) != pen_deg {
            self.steps.put(Word::Pen(pen_deg));
        }
        if core::mem::replace(&mut self.power, power) != power || ends_darkness {
            self.steps.put(Word::Laser { power, ends_darkness });
        }
        self.steps.tell(0);
    }

    /// How long after what was put in last this is, us.
    fn after_us(&mut self, at_us: u64) -> u64 {
        let after_us = at_us.saturating_sub(self.clock_us);
        self.clock_us = self.clock_us.max(at_us);
        after_us
    }

    /// Takes a step that is due at a time.
    fn gather(&mut self, at_us: u64, makes: Makes) {
        let step = makes.pair();
        let began_us = self.clock_us;
        let us = self.after_us(at_us);
        let stretch = self.plotter.motion.stretch();
        let own = |way: i8, old: i8| way == 0 || way == old;
        let Gathered { ways, count, .. } = self.gathered;
        let goes_on = count > 0
            && count < STEPS
            && own(step.x, ways.x)
            && own(step.y, ways.y)
            && stretch == self.gathered.stretch
            && self.gathered.us + us <= STRETCH_US;
        if !goes_on {
            self.put_gathered();
            let way = |way: i8, old: i8| if way == 0 { old } else { way };
            let gathered = &mut self.gathered;
            gathered.ways = StepPair { x: way(step.x, ways.x), y: way(step.y, ways.y) };
            gathered.begins = stretch != gathered.stretch;
            (gathered.stretch, gathered.began_us, gathered.us) = (stretch, began_us, 0);
        }
        if let Some(slot) = self.gathered.steps.get_mut(self.gathered.count) {
            *slot = (makes, us);
            self.gathered.count += 1;
        }
        self.gathered.us = self.gathered.us.saturating_add(us);
        // Its phase is the one in progress only until the next is asked for.
        self.phase = self.plotter.motion.phased();
    }

    /// Puts in what has been gathered, as one stretch.
    fn put_gathered(&mut self) {
        let Gathered { count, ways, begins, began_us, us, .. } = self.gathered;
        if count == 0 {
            return;
        }
        let (phase_us, phase, curve) = self.phase;
        let [from_s, to_s] = [began_us, began_us.saturating_add(us)].map(|at_us| {
            // Not longer than a phase is, 47 ms, by far.
            let us = u32::try_from(at_us.saturating_sub(phase_us)).unwrap_or(u32::MAX);
            #[expect(clippy::cast_precision_loss, reason = "a time within a phase, to 2^-23")]
            let seconds = us as f32 * 1e-6;
            least(seconds, phase.duration_s)
        });
        let fastest = greatest(phase.speed_at::<M>(from_s), phase.speed_at::<M>(to_s));
        let way_mm = phase.way_mm::<M>(to_s) - phase.way_mm::<M>(from_s);
        let steps = u16::try_from(count).unwrap_or(u16::MAX);
        let per_step = self.energy.per_step(curve, fastest, way_mm, steps);
        let from_rest = begins && phase.speed_mm_s <= 0.0;
        if from_rest {
            self.steps.tell_rest();
        }
        let energy = self.energy.at_speed(fastest);
        self.steps.put(Word::Stretch(Stretch { from_rest, ways, per_step, energy }));
        for &(makes, us) in self.gathered.steps.iter().take(count) {
            let after_us = u16::try_from(us).ok().filter(|us| *us <= MOST_AFTER_US);
            if after_us.is_none() {
                put_wait(&mut self.steps, us);
            }
            let after_us = after_us.unwrap_or(0);
            self.steps.put(match makes {
                Makes::Pair(step) => Word::Step { x: step.x != 0, y: step.y != 0, after_us },
                #[cfg(feature = "third-motor")]
                Makes::Z(way) => Word::StepZ { up: way > 0, after_us },
                #[cfg(feature = "third-motor")]
                Makes::Apart(axis, ways) => Word::Apart { axis, ways, after_us },
            });
        }
        self.steps.tell(u32::from(per_step) * u32::from(steps));
        self.gathered.count = 0;
    }

    /// What has really been made.
    fn made(&self, stands: bool) -> Made {
        let (at, gap) = self.steps.made();
        Made {
            at,
            gap,
            #[cfg(feature = "third-motor")]
            z: self.z_from.wrapping_add(self.steps.made_z()),
            stands,
        }
    }

    /// Hears what the other half has found, and lets the motion side know where the machine really is.
    fn look(&mut self, now: Duration) {
        let found = Found::of_bits(self.steps.shared.found.load(Ordering::Acquire));
        let made = self.made(self.gathered.count == 0 && self.steps.is_drained());
        let motion = &mut self.plotter.motion;
        if self.waits_for != Some(Flush::Homed) {
            motion.note_made(made);
        }
        #[cfg(feature = "third-motor")]
        {
            let Third { z, second } = self.third.or(found.third);
            motion.z_switches(z);
            motion.second_switches(second);
        }
        let limits = either(self.orders.limits, found.limits);
        let is_pressed_anew = core::mem::replace(&mut self.presses, found.presses) != found.presses;
        if is_pressed_anew {
            // It latches even if it has been released by now.
            motion.note_switches(limits, true);
        }
        motion.note_switches(limits, self.orders.button | found.button);
        if is_pressed_anew {
            self.stop(Stop::Emergency);
        } else if let Some(blocked) = found.blocked
            && self.waits_for.is_none()
        {
            let why = match blocked {
                Blocked::Limit { axis, end } => Stop::Limit { axis, end },
                #[cfg(feature = "third-motor")]
                Blocked::LimitZ { end } => Stop::LimitZ { end },
                Blocked::Stopped => Stop::Emergency,
            };
            self.stop(why);
        } else if let Some(what) = self.waits_for
            && found.flushes == self.orders.flushes
        {
            self.waits_for = None;
            self.orders.homed = false;
            self.gathered.count = 0;
            self.steps.tell_rest();
            self.clock_us = whole_us(now);
            let motion = &mut self.plotter.motion;
            motion.note_made(Made { stands: true, ..made });
            motion.come_back_to(made.at, made.gap);
            match what {
                // A step that homing makes into a switch is not missed: homing sees the switch itself.
                Flush::Stop(Stop::Limit { .. }) if motion.is_homing() => {}
                #[cfg(feature = "third-motor")]
                Flush::Stop(Stop::LimitZ { .. }) if motion.is_homing() => {}
                Flush::Stop(why) => motion.stop_for(why, &mut self.plotter.link),
                Flush::Homed => {}
            }
            self.put_others(self.clock_us);
        }
    }

    /// All that waits is to be left out.
    fn stop(&mut self, why: Stop) {
        // What stops the machine first is what is told.
        if !matches!(self.waits_for, Some(Flush::Stop(_))) {
            self.flush(Flush::Stop(why));
        }
    }

    fn flush(&mut self, what: Flush) {
        self.waits_for = Some(what);
        self.orders.homed |= what == Flush::Homed;
        self.orders.flushes = self.orders.flushes.wrapping_add(1);
    }

    /// Lets the other half know at once what it must.
    fn order(&self) {
        self.steps.shared.orders.store(self.orders.bits(), Ordering::Release);
    }

    fn end_call(&mut self, now: Duration) {
        if self.waits_for.is_none() {
            self.plotter.work(now);
        }
        let motion = &self.plotter.motion;
        let is_latched = motion.gate().is_latched();
        if core::mem::replace(&mut self.was_latched, is_latched) && !is_latched {
            self.orders.resets = self.orders.resets.wrapping_add(1);
        }
        self.orders.latched = is_latched;
        self.orders.host_stop = motion.gate().is_stopped() && !is_latched;
        if motion.is_dark() && !self.was_dark {
            self.was_dark = true;
            self.orders.dark = self.orders.dark.wrapping_add(1);
        }
        self.order();
    }

    /// When [`plan`](Self::plan) is to be called next if nothing comes before and it has not asked to be
    /// called at once; none while nothing is to be done. While steps are made it is every 5 ms, and sooner or
    /// later does no harm.
    #[must_use]
    pub fn due(&self) -> Option<Duration> {
        let motion = &self.plotter.motion;
        let stands = motion.waits_for_time() && self.steps.is_drained() && self.waits_for.is_none();
        let again = self.planned_at.saturating_add(EVERY);
        if stands { motion.due() } else { Some(again) }
    }

    /// The next byte for the host, if there is one.
    pub fn transmit(&mut self, now: Duration) -> Option<u8> {
        let byte = self.plotter.receive.transmit();
        if byte.is_some() {
            return byte;
        }
        self.look(now);
        self.end_call(now);
        self.plotter.receive.transmit()
    }

    /// Takes the state of a limit switch: no step towards it is made from here on. Or
    /// [`Stepping::limit_switch`] does.
    pub fn limit_switch(&mut self, now: Duration, axis: Axis, end: Direction, pressed: bool) {
        self.orders.limits.set(axis, end, pressed);
        self.look(now);
        self.end_call(now);
    }

    /// Takes the state of the emergency stop button: pressed, no step is made from here on, and it latches.
    /// Or [`Stepping::emergency_stop`] does.
    pub fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        let was_latched = self.plotter.motion.gate().is_latched();
        self.orders.button = pressed;
        self.look(now);
        if pressed && !was_latched {
            self.stop(Stop::Emergency);
        }
        self.end_call(now);
    }

    /// Lets the machine go on after an emergency stop, unless the button is still pressed; says whether it
    /// did.
    pub fn reset_emergency_stop(&mut self, now: Duration) -> bool {
        self.look(now);
        let free = self.plotter.motion.reset_emergency_stop();
        self.end_call(now);
        free
    }
}

fn put_wait(steps: &mut In<'_>, us: u64) {
    if us > 0 {
        steps.put(Word::Wait(u32::try_from(us).unwrap_or(u32::MAX).min(MOST_WAIT_US)));
    }
}
