//! [`Planning`]: the half in the main loop.

use super::super::motion::Made;
use super::super::{
    Drivers, Host, Lateness, Receive, Signal, StartupLines, Status, StepperPlotter, StepperPlotterSettings,
    Stop, StoredSettings,
};
use super::energy::{Energy, Stretch as Phased};
use super::shared::{Found, In, Orders, StepsAhead};
use super::words::{MOST_AFTER_US, MOST_WAIT_US, MOST_WORDS, Stretch, Word};
use super::{Stepping, Underruns};
use crate::planner::{AllModes, Modes};
use crate::safety::Blocked;
use crate::{Axis, Direction, StepPair, StepPoint};
use core::sync::atomic::Ordering;
use core::time::Duration;

/// Steps of a stretch, at most: four words of its own on sixteen of steps.
const STEPS: usize = 16;
/// Room that [`Planning::plan`] needs to go on: a stretch of so many steps with a wait before each, the servo,
/// the laser.
const ROOM: u32 = MOST_WORDS * (16 + 3);
/// A stretch ends after this, us: what is braked away on it counts from step to step alike, though the speed
/// changes; at 1000 mm/s² by 2 mm/s in that time.
const STRETCH_US: u64 = 2_000;
/// Events farther ahead than this are waited for. So no pause fills the memory.
const FAR: Duration = Duration::from_secs(1);
/// Most things that one call of [`Planning::plan`] puts in: its longest time is that of two stretches, and what
/// the planner needs for a block.
const MOST_PUT: u32 = 32;

/// Why all that waits is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Flush {
    /// The machine was stopped.
    Stop(Stop),
    /// The motors stand at the origin.
    Homed,
}

/// Steps that are still to be put in.
#[derive(Clone, Debug)]
struct Gathered {
    /// Which motors, and how long after what was before, us.
    steps: [(StepPair, u64); STEPS],
    count: usize,
    ways: StepPair,
    from_rest: bool,
    phased: Phased,
    /// Seconds of the phase at which they begin and end.
    began_s: f32,
    ends_s: f32,
    us: u64,
}

impl Gathered {
    const NONE: Self = Self {
        steps: [(StepPair { x: 0, y: 0 }, 0); STEPS],
        count: 0,
        ways: StepPair { x: 1, y: 1 },
        from_rest: false,
        phased: Phased {
            phase: crate::planner::Phase {
                duration_s: 0.0,
                from_mm: 0.0,
                speed_mm_s: 0.0,
                accel_mm_s2: 0.0,
                jerk_mm_s3: 0.0,
            },
            curve: super::energy::Curve::Line,
        },
        began_s: 0.0,
        ends_s: 0.0,
        us: 0,
    };
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
    /// When what was put in last is due, as planned.
    clock: Duration,
    orders: Orders,
    /// What the other half has not heard of yet.
    waits_for: Option<Flush>,
    put_off_us: u32,
    pen_deg: u8,
    power: u16,
    was_dark: bool,
    was_latched: bool,
}

impl<H: Host, M: Modes> StepperPlotter<H, M> {
    /// Takes a machine that stands, one that was just made, apart: into one half that plans in the main loop
    /// and one that steps in a timer's interrupt, with `memory` between them.
    pub fn split<const N: usize>(mut self, memory: &mut StepsAhead<N>) -> (Planning<'_, H, M>, Stepping<'_>) {
        let motion = &mut self.motion;
        let settings = *motion.settings();
        let at = motion.stands_at();
        let (limits, is_latched) = (motion.gate().limits(), motion.gate().is_latched());
        let is_pressed = motion.gate().is_button_pressed();
        let (steps, out) = memory.ends(at.0, at.1);
        let gate = motion.begin_ahead();
        let stepping = Stepping::new(out, gate, at, settings.backlash, motion.pen_deg());
        let orders = Orders { limits, button: is_pressed, latched: is_latched, ..Orders::default() };
        let steps_per_mm = settings.x_steps_per_mm.max(settings.y_steps_per_mm);
        let pen_deg = motion.pen_deg();
        let energy = Energy::of(&motion.limits(), steps_per_mm);
        let planning = Planning {
            plotter: self,
            steps,
            energy,
            gathered: Gathered::NONE,
            clock: Duration::ZERO,
            orders,
            waits_for: None,
            put_off_us: 0,
            pen_deg,
            power: 0,
            was_dark: false,
            was_latched: is_latched,
        };
        planning.order();
        (planning, stepping)
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
    /// once, since there is more. Then, and whenever it has been called, let the other half look whether there
    /// is something for it, if that is armed for no time: [`Stepping::tick`].
    pub fn plan(&mut self, now: Duration) -> bool {
        self.look(now);
        let mut put = 0;
        while self.waits_for.is_none() && put < MOST_PUT {
            if self.steps.room() < ROOM {
                break;
            }
            let Some(at) = self.next_time(now) else { break };
            let before = (self.plotter.link.commands.len(), self.pen_deg, self.power);
            let made =
                self.plotter.poll(at, Drivers::Ready).map(|step| (step.at, StepPair::from(step.pulse)));
            put += 1;
            self.put_others(at);
            if self.plotter.motion.take_homed() {
                self.flush(Flush::Homed);
                self.order();
                break;
            }
            if let Some((at, step)) = made {
                self.gather(at, step);
            } else if self.plotter.motion.event_at().is_none()
                && before == (self.plotter.link.commands.len(), self.pen_deg, self.power)
            {
                self.put_gathered();
                if self.plotter.motion.stands() {
                    self.steps.tell_rest();
                }
                break;
            }
            self.look(now);
        }
        let more = put == MOST_PUT;
        if !more {
            self.put_gathered();
        }
        self.end_call(now);
        more
    }

    /// The time at which the motion side is to be asked next: that of the next event, if one is planned. At a
    /// standstill it is asked at the time that it is, once all has really been done.
    fn next_time(&mut self, now: Duration) -> Option<Duration> {
        let is_drained = self.gathered.count == 0 && self.steps.is_drained();
        let motion = &mut self.plotter.motion;
        if let Some(at) = motion.event_at() {
            if at.saturating_sub(self.clock) < FAR {
                return Some(at);
            }
            // A long pause, or hardly any speed at all: that is waited for.
            if !is_drained {
                self.put_gathered();
                self.steps.tell_rest();
                return None;
            }
            self.clock = now;
            return (at.saturating_sub(now) < FAR).then_some(at);
        }
        if motion.waits_for_time() || (is_drained && motion.stands()) {
            if !is_drained {
                self.put_gathered();
                self.steps.tell_rest();
                return None;
            }
            // What has been put off puts off what waits for the end of a pause, too.
            let put_off_us = self.steps.shared.put_off_us.load(Ordering::Acquire);
            let more_us = put_off_us.wrapping_sub(core::mem::replace(&mut self.put_off_us, put_off_us));
            motion.put_off(Duration::from_micros(more_us.into()));
            motion.come_to_rest();
            self.clock = now;
            return Some(now);
        }
        // A host that sends little by little: what is not taken from the planner yet can be planned anew.
        if motion.could_take_more() && self.plotter.link.commands.is_empty() && self.steps.is_half_full() {
            self.put_gathered();
            return None;
        }
        Some(self.clock)
    }

    /// Puts in what servo and laser do, if that has changed.
    fn put_others(&mut self, at: Duration) {
        let motion = &self.plotter.motion;
        let (pen_deg, power, is_dark) = (motion.pen_deg(), motion.beam().power(), motion.is_dark());
        let ends_darkness = core::mem::replace(&mut self.was_dark, is_dark) && !is_dark;
        if pen_deg == self.pen_deg && power == self.power && !ends_darkness {
            return;
        }
        self.put_gathered();
        self.wait_until(at);
        if core::mem::replace(&mut self.pen_deg, pen_deg) != pen_deg {
            self.steps.put(Word::Pen(pen_deg));
        }
        if core::mem::replace(&mut self.power, power) != power || ends_darkness {
            self.steps.put(Word::Laser { power, ends_darkness });
        }
        self.steps.tell(0);
    }

    /// How long after what was put in last this is, us.
    fn after_us(&mut self, at: Duration) -> u64 {
        let after = at.saturating_sub(self.clock);
        self.clock = self.clock.max(at);
        u64::try_from(after.as_micros()).unwrap_or(u64::MAX)
    }

    /// Puts in a wait; none is longer than [`FAR`].
    fn wait_until(&mut self, at: Duration) {
        let us = self.after_us(at);
        put_wait(&mut self.steps, us);
    }

    /// Takes a step that is due at a time.
    fn gather(&mut self, at: Duration, step: StepPair) {
        let (began, phased, from_rest) = self.plotter.motion.phased();
        let before = self.clock;
        let us = self.after_us(at);
        let own = |way: i8, old: i8| way == 0 || way == old;
        let Gathered { ways, count, .. } = self.gathered;
        let goes_on = count > 0
            && count < STEPS
            && own(step.x, ways.x)
            && own(step.y, ways.y)
            && phased == self.gathered.phased
            && self.gathered.us.saturating_add(us) <= STRETCH_US;
        let seconds = |at: Duration| at.saturating_sub(began).as_secs_f32().min(phased.phase.duration_s);
        if !goes_on {
            self.put_gathered();
            let way = |way: i8, old: i8| if way == 0 { old } else { way };
            let is_new = phased != self.gathered.phased;
            self.gathered = Gathered {
                ways: StepPair { x: way(step.x, ways.x), y: way(step.y, ways.y) },
                from_rest: from_rest && is_new,
                phased,
                began_s: if is_new { 0.0 } else { seconds(before) },
                us: 0,
                ..self.gathered
            };
        }
        if let Some(slot) = self.gathered.steps.get_mut(self.gathered.count) {
            *slot = (step, us);
            self.gathered.count += 1;
        }
        self.gathered.us = self.gathered.us.saturating_add(us);
        self.gathered.ends_s = seconds(at);
    }

    /// Puts in what has been gathered, as one stretch.
    fn put_gathered(&mut self) {
        let Gathered { count, ways, from_rest, phased, began_s, ends_s, .. } = self.gathered;
        if count == 0 {
            return;
        }
        let Phased { phase, curve } = phased;
        let speeds = [phase.speed_at::<M>(began_s), phase.speed_at::<M>(ends_s)];
        let fastest = crate::extremes::greatest(speeds[0], speeds[1]);
        let way_mm = phase.way_mm::<M>(ends_s) - phase.way_mm::<M>(began_s);
        let steps = u16::try_from(count).unwrap_or(u16::MAX);
        let per_step = self.energy.per_step(curve, fastest, way_mm, steps);
        if from_rest {
            self.steps.tell_rest();
        }
        let energy = self.energy.at_speed(fastest);
        self.steps.put(Word::Stretch(Stretch { from_rest, ways, per_step, energy }));
        for &(step, us) in self.gathered.steps.iter().take(count) {
            let after_us = u16::try_from(us).ok().filter(|us| *us <= MOST_AFTER_US);
            if after_us.is_none() {
                put_wait(&mut self.steps, us);
            }
            let after_us = after_us.unwrap_or(0);
            self.steps.put(Word::Step { x: step.x != 0, y: step.y != 0, after_us });
        }
        self.steps.tell(u32::from(per_step) * u32::from(steps));
        self.gathered.count = 0;
    }

    /// Hears what the other half has found, and lets the motion side know where the machine really is.
    fn look(&mut self, now: Duration) {
        let found = Found::of_bits(self.steps.shared.found.load(Ordering::Acquire));
        let (at, gap) = self.steps.made();
        let motion = &mut self.plotter.motion;
        let stands = self.gathered.count == 0 && self.steps.is_drained();
        if self.waits_for != Some(Flush::Homed) {
            motion.note_made(Made { at, gap, stands });
        }
        let limits = super::shared::either(self.orders.limits, found.limits);
        motion.note_switches(limits, self.orders.button | found.button);
        if let Some(blocked) = found.blocked
            && self.waits_for.is_none()
        {
            let why = match blocked {
                Blocked::Limit { axis, end } => Stop::Limit { axis, end },
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
            self.clock = now;
            let motion = &mut self.plotter.motion;
            motion.note_made(Made { at, gap, stands: true });
            motion.come_back_to(at, gap);
            match what {
                // A step that homing makes into a switch is not missed: homing sees the switch itself.
                Flush::Stop(Stop::Limit { .. }) if motion.is_homing() => {}
                Flush::Stop(why) => motion.stop_for(why, &mut self.plotter.link),
                Flush::Homed => {}
            }
            self.put_others(now);
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

    /// When [`plan`](Self::plan) is to be called next if nothing comes before and it has not asked to be called
    /// at once; none while nothing is to be done. While there are steps to be made it may be called at any time.
    #[must_use]
    pub fn due(&self) -> Option<Duration> {
        self.plotter.due()
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

    /// Takes the state of the emergency stop button: pressed, no step is made from here on, and it latches. Or
    /// [`Stepping::emergency_stop`] does.
    pub fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        let was_latched = self.plotter.motion.gate().is_latched();
        self.orders.button = pressed;
        self.look(now);
        if pressed && !was_latched {
            self.stop(Stop::Emergency);
        }
        self.end_call(now);
    }

    /// Lets the machine go on after an emergency stop, unless the button is still pressed; says whether it did.
    pub fn reset_emergency_stop(&mut self, now: Duration) -> bool {
        self.look(now);
        let free = self.plotter.motion.reset_emergency_stop();
        self.end_call(now);
        free
    }

    /// See [`StepperPlotter::stored`].
    #[must_use]
    pub fn stored(&self) -> StoredSettings {
        self.plotter.stored()
    }

    /// See [`StepperPlotter::startup_lines`].
    #[must_use]
    pub fn startup_lines(&self) -> StartupLines {
        self.plotter.startup_lines()
    }

    /// See [`StepperPlotter::settings`].
    #[must_use]
    pub fn settings(&self) -> StepperPlotterSettings {
        self.plotter.settings()
    }

    /// What the machine does.
    #[must_use]
    pub fn status(&mut self, now: Duration) -> Status {
        self.look(now);
        self.plotter.status(now)
    }

    /// Where the motors stand: steps really made.
    #[must_use]
    pub fn position(&self) -> StepPoint {
        self.steps.made().0
    }

    /// How late steps have been given since the machine was switched on: whether the interrupt comes in time.
    #[must_use]
    pub fn lateness(&self) -> Lateness {
        let shared = self.steps.shared;
        Lateness::told(shared.late_steps.load(Ordering::Acquire), shared.latest_us.load(Ordering::Acquire))
    }

    /// How often there were too few steps: whether the main loop comes in time, and the memory is large enough.
    #[must_use]
    pub fn underruns(&self) -> Underruns {
        let shared = self.steps.shared;
        Underruns {
            slowed_steps: shared.slowed_steps.load(Ordering::Acquire),
            stops: shared.stops.load(Ordering::Acquire),
        }
    }
}

fn put_wait(steps: &mut In<'_>, us: u64) {
    if us > 0 {
        steps.put(Word::Wait(u32::try_from(us).unwrap_or(u32::MAX).min(MOST_WAIT_US)));
    }
}
