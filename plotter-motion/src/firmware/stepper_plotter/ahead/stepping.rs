//! [`Stepping`]: the half in the timer's interrupt.

#[cfg(feature = "third-motor")]
mod third;

use super::super::play::Gap;
use super::super::{Drivers, Lateness};
use super::energy::LEAST_ENERGY;
use super::makes::Makes;
use super::shared::{Found, Orders, Out, either};
use super::words::{MOST_WAIT_US, Word};
use crate::kinematics::Backlash;
use crate::safety::{Beam, Blocked, Pulse};
use crate::{Axis, Direction, SafetyGate, StepPair, StepPoint};
use core::sync::atomic::Ordering;

/// What waits for its time.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Thing {
    /// Nothing does.
    None,
    /// A wait ends.
    Wait,
    Step(Makes),
    Pen(u8),
    Laser {
        power: u16,
        ends_darkness: bool,
    },
}

/// Makes what [`Planning`](super::Planning) has planned, each step at its time. It has the machine's
/// [`SafetyGate`], and is all that a timer's interrupt needs.
///
/// Times are microseconds of a clock of 32 bits, which goes round after 71 minutes. When the timer comes,
/// call [`tick`](Self::tick) until it gives no step, and arm the timer for [`due`](Self::due); when there is
/// none, [`Planning::plan`](super::Planning::plan) says when to call it again. After each call the servo gets
/// [`pen_deg`](Self::pen_deg) and the laser [`beam`](Self::beam).
#[derive(Debug)]
pub struct Stepping<'a> {
    out: Out<'a>,
    gate: SafetyGate,
    orders: u32,
    #[cfg(feature = "third-motor")]
    third: u32,
    /// The axis that has two motors.
    #[cfg(feature = "third-motor")]
    second: Option<Axis>,
    #[cfg(feature = "third-motor")]
    z: i32,
    found: Found,
    position: StepPoint,
    gap: Gap,
    play: Backlash,
    thing: Thing,
    /// When that is due, and when the one before was.
    due_us: u32,
    time_us: u32,
    /// All has been done, and the machine stands: what comes next begins when it comes.
    idle: bool,
    ways: StepPair,
    per_step: u16,
    /// The energy that the plan has at this step, and what can be braked away on all steps up to this one.
    planned: u32,
    here: u32,
    /// The energy that the machine has, where that is less.
    slowed: bool,
    energy: u32,
    pen_deg: u8,
    power: u16,
    dark: bool,
    put_off_us: u32,
    lateness: Lateness,
    slowed_steps: u32,
    stops: u32,
}

impl<'a> Stepping<'a> {
    pub(super) fn new(
        out: Out<'a>,
        gate: SafetyGate,
        at: (StepPoint, Gap),
        play: Backlash,
        pen_deg: u8,
    ) -> Self {
        let ways = StepPair { x: 1, y: 1 };
        Self {
            out,
            gate,
            orders: 0,
            #[cfg(feature = "third-motor")]
            third: 0,
            #[cfg(feature = "third-motor")]
            second: None,
            #[cfg(feature = "third-motor")]
            z: 0,
            found: Found::default(),
            position: at.0,
            gap: at.1,
            play,
            thing: Thing::None,
            due_us: 0,
            time_us: 0,
            idle: true,
            ways,
            per_step: 0,
            planned: 0,
            here: 0,
            slowed: false,
            energy: 0,
            pen_deg,
            power: 0,
            dark: false,
            put_off_us: 0,
            lateness: Lateness::default(),
            slowed_steps: 0,
            stops: 0,
        }
    }

    /// The next step that is due by `now_us`, if there is one and the motors' drivers can take it. It counts
    /// as made from here on, and [`due`](Self::due) tells when the next one is.
    pub fn tick(&mut self, now_us: u32, drivers: Drivers) -> Option<Pulse<'_>> {
        self.next_step(now_us, drivers).then_some(())?;
        let Thing::Step(step) = core::mem::replace(&mut self.thing, Thing::None) else { return None };
        let passed = match step {
            Makes::Pair(pair) => self.gate.pass_step(pair),
            #[cfg(feature = "third-motor")]
            Makes::Z(way) => self.gate.pass_z_step(way),
            #[cfg(feature = "third-motor")]
            Makes::Apart(axis, ways) => self.gate.pass_apart(axis, ways),
        };
        match passed.map(Pulse::kept) {
            Ok(pulse) => {
                self.given(now_us);
                self.count(pulse.into());
                #[cfg(feature = "third-motor")]
                if pulse.z() != 0 {
                    self.count_z(pulse.z());
                }
                self.out.done();
                // When the next one is due is known at once, so an interrupt is one call.
                self.fetch(now_us);
                Some(pulse)
            }
            Err(blocked) => {
                self.found.blocked = Some(blocked);
                self.leave_out();
                None
            }
        }
    }

    /// The next thing with how long after the one before it is due, us, without a look at any clock: for PIO,
    /// RMT, a timer with DMA, whatever makes steps from a buffer of delays. With no pulse it is a pause, or
    /// the servo or the laser: from then on [`pen_deg`](Self::pen_deg) and [`beam`](Self::beam) hold.
    ///
    /// A step counts as made when it has been given. What was still in the buffer when that was stopped is
    /// told by [`not_made`](Self::not_made).
    pub fn stream(&mut self) -> Option<(u32, Option<Pulse<'_>>)> {
        self.obey();
        let before_us = self.time_us;
        if self.thing == Thing::None && !self.fetch(before_us) {
            return None;
        }
        let at_us = self.due_us;
        let after_us = at_us.wrapping_sub(before_us);
        if let Thing::Step(_) = self.thing {
            return Some((after_us, Some(self.tick(at_us, Drivers::Ready)?)));
        }
        self.time_us = at_us;
        self.do_other();
        Some((after_us, None))
    }

    /// A step of a stream that was not made, since the stream was stopped.
    pub fn not_made(&mut self, step: StepPair) {
        let back = StepPair { x: step.x.saturating_neg(), y: step.y.saturating_neg() };
        self.count(back);
    }

    /// Goes on to the next step that is due; says whether there is one.
    #[inline(always)] // in `tick`, which is the interrupt
    fn next_step(&mut self, now_us: u32, drivers: Drivers) -> bool {
        loop {
            if self.orders != self.out.shared.orders.load(Ordering::Acquire) {
                self.obey();
            }
            #[cfg(feature = "third-motor")]
            if self.third != self.out.shared.third.load(Ordering::Acquire) {
                self.read_switches();
            }
            if self.thing == Thing::None && !self.fetch(now_us) {
                return false;
            }
            // Nothing is due farther away than half of what the clock counts.
            if now_us.wrapping_sub(self.due_us) > u32::MAX / 2 {
                return false;
            }
            if let Thing::Step(_) = self.thing {
                return drivers == Drivers::Ready;
            }
            self.given(now_us);
            self.do_other();
        }
    }

    /// When [`tick`](Self::tick) is to be called next, us; none while there is nothing to do.
    #[must_use]
    pub fn due(&self) -> Option<u32> {
        (self.thing != Thing::None).then_some(self.due_us)
    }

    /// Takes the next thing out, and finds when it is due; says whether there is one.
    #[inline(always)] // in `tick`, which is the interrupt
    fn fetch(&mut self, now_us: u32) -> bool {
        if self.found.blocked.is_some() {
            return false;
        }
        loop {
            let Some(word) = self.out.next() else {
                self.run_out();
                return false;
            };
            if core::mem::take(&mut self.idle) {
                self.time_us = now_us;
            }
            let after_us = match word {
                Word::Step { x, y, after_us } => {
                    let step =
                        StepPair { x: if x { self.ways.x } else { 0 }, y: if y { self.ways.y } else { 0 } };
                    self.makes(Makes::Pair(step), after_us)
                }
                #[cfg(feature = "third-motor")]
                Word::StepZ { up, after_us } => self.makes(Makes::Z(if up { 1 } else { -1 }), after_us),
                #[cfg(feature = "third-motor")]
                Word::Apart { axis, ways, after_us } => self.makes(Makes::Apart(axis, ways), after_us),
                Word::Stretch(stretch) => {
                    if stretch.from_rest {
                        self.slowed = false;
                    }
                    (self.ways, self.per_step, self.planned) =
                        (stretch.ways, stretch.per_step, stretch.energy);
                    continue;
                }
                Word::Wait(us) => {
                    self.thing = Thing::Wait;
                    self.stretched(us)
                }
                Word::Pen(deg) => {
                    self.thing = Thing::Pen(deg);
                    0
                }
                Word::Laser { power, ends_darkness } => {
                    self.thing = Thing::Laser { power, ends_darkness };
                    0
                }
            };
            self.due_us = self.time_us.wrapping_add(after_us);
            return true;
        }
    }

    /// The next thing is what motors make; gives how long after the one before.
    #[inline(always)] // in `tick`, which is the interrupt
    fn makes(&mut self, makes: Makes, after_us: u16) -> u32 {
        self.thing = Thing::Step(makes);
        let after_us = self.stretched(after_us.into());
        self.here = self.here.wrapping_add(self.per_step.into());
        after_us
    }

    /// How long after the thing before the next one is due, as fast as the machine may be: it must be able to
    /// brake on the steps that are known.
    #[inline(always)] // in `tick`, which is the interrupt
    fn stretched(&mut self, after_us: u32) -> u32 {
        let left = self.out.shared.end.load(Ordering::Relaxed).wrapping_sub(self.here);
        if self.planned <= left && !self.slowed { after_us } else { self.slowed_down(after_us, left) }
    }

    /// The same where the steps that are known may not be enough.
    #[inline(never)]
    fn slowed_down(&mut self, after_us: u32, left: u32) -> u32 {
        // The plan itself brakes where the machine is to stand.
        let to_rest = self.out.shared.rest.load(Ordering::Acquire).wrapping_sub(self.here);
        let stands_ahead = to_rest <= u32::MAX / 2;
        let most = if stands_ahead { self.planned } else { self.planned.min(left) };
        // It speeds up again no faster than it brakes.
        let reached =
            if self.slowed { self.energy.saturating_add(self.per_step.into()) } else { self.planned };
        self.energy = reached.min(most).max(LEAST_ENERGY);
        self.slowed = self.energy < self.planned;
        if !self.slowed {
            return after_us;
        }
        self.slowed_steps = self.slowed_steps.wrapping_add(1);
        self.out.shared.slowed_steps.store(self.slowed_steps, Ordering::Relaxed);
        #[expect(clippy::cast_precision_loss, reason = "a ratio, to 2^-23")]
        let ratio = libm::sqrtf(self.planned as f32 / self.energy as f32);
        #[expect(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a time that is stretched, to 2^-23; the cast saturates"
        )]
        let stretched = (after_us as f32 * ratio) as u32;
        stretched.min(MOST_WAIT_US)
    }

    /// There is nothing more: the machine stands, as planned or because nothing more has come.
    #[inline(never)]
    fn run_out(&mut self) {
        if !self.idle && self.out.shared.rest.load(Ordering::Acquire) != self.here {
            self.stops = self.stops.wrapping_add(1);
            self.out.shared.stops.store(self.stops, Ordering::Relaxed);
            (self.slowed, self.energy) = (true, 0);
        }
        self.idle = true;
    }

    /// Something is done now that was due before.
    #[inline(always)] // in `tick`, which is the interrupt
    fn given(&mut self, now_us: u32) {
        let late_us = now_us.wrapping_sub(self.due_us);
        self.time_us = self.due_us;
        if late_us > Lateness::ALLOWED_US {
            self.late(late_us);
        }
    }

    #[inline(never)]
    fn late(&mut self, late_us: u32) {
        self.time_us = self.time_us.wrapping_add(late_us);
        self.put_off_us = self.put_off_us.wrapping_add(late_us);
        self.out.shared.put_off_us.store(self.put_off_us, Ordering::Relaxed);
        if let Thing::None = self.thing {
            // A step, which has been taken out already.
            self.lateness.count(late_us);
            self.out.shared.late_steps.store(self.lateness.steps(), Ordering::Relaxed);
            self.out.shared.latest_us.store(self.lateness.greatest_us(), Ordering::Relaxed);
        }
    }

    /// Does what is no step.
    fn do_other(&mut self) {
        match core::mem::replace(&mut self.thing, Thing::None) {
            Thing::Pen(deg) => self.pen_deg = deg,
            Thing::Laser { power, ends_darkness } => {
                self.power = power;
                self.dark &= !ends_darkness;
            }
            Thing::None | Thing::Wait | Thing::Step(_) => {}
        }
        self.out.done();
    }

    #[inline(always)] // in `tick`, which is the interrupt
    fn count(&mut self, step: StepPair) {
        let shared = self.out.shared;
        if step.x != 0 {
            self.position.x = self.position.x.wrapping_add(step.x.into());
            shared.x.store(self.position.x, Ordering::Relaxed);
        }
        if step.y != 0 {
            self.position.y = self.position.y.wrapping_add(step.y.into());
            shared.y.store(self.position.y, Ordering::Relaxed);
        }
        if self.play != Backlash::default() {
            self.gap.made(step, self.play);
            shared.gap.store(self.gap.bits(), Ordering::Relaxed);
        }
    }

    /// Carries out what has been ordered at once.
    #[inline(never)]
    fn obey(&mut self) {
        let bits = self.out.shared.orders.load(Ordering::Acquire);
        if bits == self.orders {
            return;
        }
        let (before, orders) = (Orders::of_bits(self.orders), Orders::of_bits(bits));
        self.orders = bits;
        if orders.latched {
            self.gate.emergency_stop(true);
        }
        self.read_switches();
        if orders.resets != before.resets {
            self.gate.reset();
        }
        self.gate.stop_by_host(orders.host_stop);
        self.dark |= orders.dark != before.dark;
        if orders.flushes != before.flushes {
            self.leave_out();
            self.found.blocked = None;
            // Where it stands now counts from here.
            self.here = self.out.shared.end.load(Ordering::Relaxed);
            self.idle = true;
            if orders.homed {
                (self.position, self.gap) = (StepPoint::default(), Gap::default());
                self.out.shared.x.store(0, Ordering::Relaxed);
                self.out.shared.y.store(0, Ordering::Relaxed);
                self.out.shared.gap.store(self.gap.bits(), Ordering::Relaxed);
            }
            (self.slowed, self.planned, self.power) = (false, 0, 0);
            self.found.flushes = orders.flushes;
            self.tell();
        }
    }

    /// Forgets all that waits.
    fn leave_out(&mut self) {
        self.thing = Thing::None;
        self.power = 0;
        self.out.leave_out();
        self.tell();
    }

    fn tell(&self) {
        self.out.shared.found.store(self.found.bits(), Ordering::Release);
    }

    /// Takes the state of a limit switch, where an interrupt of its own sees it; or
    /// [`Planning::limit_switch`](super::Planning::limit_switch) does.
    pub fn limit_switch(&mut self, axis: Axis, end: Direction, pressed: bool) {
        self.found.limits.set(axis, end, pressed);
        self.read_switches();
        self.tell();
    }

    /// Takes the state of the emergency stop button; pressed, no step is given any more, and it latches. Or
    /// [`Planning::emergency_stop`](super::Planning::emergency_stop) does.
    pub fn emergency_stop(&mut self, pressed: bool) {
        if pressed && !self.found.button {
            self.found.presses = self.found.presses.wrapping_add(1);
            self.found.blocked = Some(Blocked::Stopped);
            self.leave_out();
        }
        self.found.button = pressed;
        self.read_switches();
        self.tell();
    }

    fn read_switches(&mut self) {
        let orders = Orders::of_bits(self.orders);
        self.gate.set_limits(either(orders.limits, self.found.limits));
        self.gate.emergency_stop(orders.button | self.found.button);
        #[cfg(feature = "third-motor")]
        self.read_third();
    }

    /// Servo of the pen, degrees.
    #[must_use]
    pub const fn pen_deg(&self) -> u8 {
        self.pen_deg
    }

    /// Power of the laser.
    #[must_use]
    pub fn beam(&self) -> Beam<'_> {
        self.gate.pass_laser(if self.dark { 0 } else { self.power })
    }

    /// Where the motors stand: steps really made.
    #[must_use]
    pub const fn position(&self) -> StepPoint {
        self.position
    }
}
