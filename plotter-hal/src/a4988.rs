//! A stepper motor on a chip of the A4988 kind: a rising edge on STEP is a step, DIR says which way.
//!
//! ```text
//!              setup   high     low
//!             ├─────┤├──────┤├──────┤
//!  DIR    ────╳──────────────────────────────   may change only while STEP is low, and not
//!  STEP   __________┌───────┐_______┌───────┐    within `setup` before it rises
//!                   ├────┤
//!                    hold
//! ```
//!
//! Two forms of the same driver. Without waiting: [`step`](A4988::step) takes a step, [`tick`](A4988::tick)
//! ends the pulse, and [`due`](A4988::due) says when to call it. With waiting:
//! [`step_blocking`](A4988::step_blocking) comes back when the chip is ready for the next one.
//!
//! A step that comes before the chip is ready is put off, never lost: [`due`](A4988::due) says to when. One
//! can be put off at a time; a second is refused with [`Error::Busy`], and is still the caller's.
//!
//! Sources, named at each figure: Allegro, *A4988 DMOS Microstepping Driver with Translator and
//! Overcurrent Protection*, A4988-DS; Texas Instruments, *DRV8825 Stepper Motor Controller IC*, SLVSA73F;
//! Trinamic, *TMC2209 Datasheet*, Rev. 1.09.

mod error;
mod microsteps;
mod timing;

pub use error::{Error, ErrorOf, PinError, PinErrorOf};
use microsteps::MicrostepErrorOf;
pub use microsteps::{Chip, MicrostepPinError, MicrostepPins};
pub use timing::Timing;
use timing::TimingNs;

use crate::NoPin;
use core::time::Duration;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{OutputPin, PinState};
use plotter_motion::{Axis, Direction, safety::Pulse};

/// One stepper motor. It steps by nothing but a [`Pulse`], which only a safety gate makes.
///
/// Nothing moves, and no step is taken, before [`start`](Self::start). Whatever pin fails, the motor makes no
/// further step until it is started anew: see [`Error`]. Dropping the driver leaves the pins as they are;
/// call [`stop`](Self::stop) first.
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Set};
/// use plotter_hal::a4988::{A4988, Timing};
/// use plotter_motion::{Axis, LimitSwitches, SafetyGate, StepPair};
///
/// let step = Pin::new(&[Set::set(Low), Set::set(High), Set::set(Low)]);
/// let dir = Pin::new(&[Set::set(High)]);
/// let mut motor = A4988::new(Axis::X, step, dir, Timing::A4988);
/// motor.start(Duration::ZERO)?;
///
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let right = gate.pass_step(StepPair { x: 1, y: 0 }).map_err(|_| "stopped")?;
/// let us = Duration::from_micros;
/// motor.step(right, us(2000))?; // sets DIR; STEP must wait for its setup time
/// assert_eq!(motor.due(), Some(us(2000) + Duration::from_nanos(200)));
/// motor.tick(us(2001))?; // STEP rises
/// assert_eq!(motor.due(), Some(us(2002)));
/// motor.tick(us(2002))?; // and falls
/// assert_eq!(motor.due(), None);
/// # let (mut step, mut dir, _, _) = motor.release();
/// # step.done();
/// # dir.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A step that has not passed the gate does not turn a motor:
///
/// ```compile_fail
/// # use core::time::Duration;
/// # use embedded_hal_mock::eh1::digital::Mock as Pin;
/// # use plotter_hal::a4988::{A4988, Timing};
/// # use plotter_motion::{Axis, StepPair};
/// # let mut motor = A4988::new(Axis::X, Pin::new(&[]), Pin::new(&[]), Timing::A4988);
/// motor.step(StepPair { x: 1, y: 0 }, Duration::ZERO);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct A4988<Step, Dir, Enable, Sleep> {
    axis: Axis,
    #[cfg(feature = "third-motor")]
    part: Part,
    step: Step,
    dir: Dir,
    enable: Enable,
    sleep: Sleep,
    has_enable: bool,
    has_sleep: bool,
    timing: TimingNs,
    inverted: bool,
    on: bool,
    level: Level,
    /// When STEP may change next, ns.
    earliest: u64,
    /// What DIR says, if that is known.
    direction: Option<Direction>,
    /// The step that has been taken and has not risen.
    waiting: Option<Direction>,
}

/// Which motor it is.
#[cfg(feature = "third-motor")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// The one of its axis, or the first.
    First,
    /// The second of its axis.
    Second,
    /// The driver of a third axis.
    Z,
}

/// What STEP is known to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Low,
    High,
    Unknown,
}

impl<Step, Dir> A4988<Step, Dir, NoPin, NoPin> {
    /// The motor of `axis`, on a board that has ENABLE and SLEEP wired so that the chip is always on. Leaves
    /// the pins as they are.
    #[inline(always)] // so that a chip's times become whole numbers while the program is compiled
    pub const fn new(axis: Axis, step: Step, dir: Dir, timing: Timing) -> Self {
        Self {
            axis,
            #[cfg(feature = "third-motor")]
            part: Part::First,
            step,
            dir,
            enable: NoPin,
            sleep: NoPin,
            has_enable: false,
            has_sleep: false,
            timing: timing.in_ns(),
            inverted: false,
            on: false,
            level: Level::Unknown,
            earliest: 0,
            direction: None,
            waiting: None,
        }
    }
}

impl<Step, Dir, Enable, Sleep> A4988<Step, Dir, Enable, Sleep> {
    /// With a pin on ENABLE: low switches the outputs on.
    pub fn with_enable<Pin>(self, enable: Pin) -> A4988<Step, Dir, Pin, Sleep> {
        A4988 { has_enable: true, ..self.with_pins(|_, sleep| (enable, sleep)) }
    }

    /// With a pin on SLEEP: low puts the chip to sleep. On RESET it does as well, for low holds the chip in
    /// reset.
    pub fn with_sleep<Pin>(self, sleep: Pin) -> A4988<Step, Dir, Enable, Pin> {
        A4988 { has_sleep: true, ..self.with_pins(|enable, _| (enable, sleep)) }
    }

    fn with_pins<E, S>(self, pins: impl FnOnce(Enable, Sleep) -> (E, S)) -> A4988<Step, Dir, E, S> {
        let (enable, sleep) = pins(self.enable, self.sleep);
        A4988 {
            axis: self.axis,
            #[cfg(feature = "third-motor")]
            part: self.part,
            step: self.step,
            dir: self.dir,
            enable,
            sleep,
            has_enable: self.has_enable,
            has_sleep: self.has_sleep,
            timing: self.timing,
            inverted: self.inverted,
            on: self.on,
            level: self.level,
            earliest: self.earliest,
            direction: self.direction,
            waiting: self.waiting,
        }
    }

    /// With DIR low for steps to larger coordinates, for a motor that turns the other way round.
    #[must_use]
    pub fn with_inverted_direction(self) -> Self {
        Self { inverted: true, ..self }
    }

    /// As the motor of a third axis: of a [`Pulse`] it takes the step of z, upwards as to larger coordinates.
    ///
    /// ```
    /// # use core::time::Duration;
    /// # use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Set};
    /// # use plotter_hal::a4988::{A4988, Timing};
    /// # use plotter_motion::{Axis, LimitSwitches, SafetyGate};
    /// # let step = Pin::new(&[Set::set(Low), Set::set(High), Set::set(Low)]);
    /// # let dir = Pin::new(&[Set::set(Low)]);
    /// let mut lift = A4988::new(Axis::X, step, dir, Timing::DRV8825).of_z();
    /// lift.start(Duration::ZERO)?;
    /// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    /// let down = gate.pass_z_step(-1).map_err(|_| "stopped")?;
    /// lift.step(down, Duration::from_millis(2))?; // beside `motors.step(down, …)` of the other two
    /// while let Some(due) = lift.due() {
    ///     lift.tick(due)?;
    /// }
    /// # let (mut step, mut dir, _, _) = lift.release();
    /// # step.done();
    /// # dir.done();
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn of_z(self) -> Self {
        Self { part: Part::Z, ..self }
    }

    /// As the second motor of its axis: of a [`Pulse`] it takes what the first takes, but where both are made
    /// square.
    #[cfg(feature = "third-motor")]
    #[must_use]
    pub fn as_second(self) -> Self {
        Self { part: Part::Second, ..self }
    }

    /// The axis whose share of a [`Pulse`] this motor takes.
    pub const fn axis(&self) -> Axis {
        self.axis
    }

    /// Whether the motor takes steps: it has been started, and has not been stopped and not failed since.
    pub const fn is_on(&self) -> bool {
        self.on
    }

    /// Whether a step is put off, so that another one would be refused.
    pub const fn is_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    /// When [`tick`](Self::tick) is to be called; later does no harm. `None` while there is nothing to do.
    pub fn due(&self) -> Option<Duration> {
        self.falls_at().or(self.rises_at()).map(Duration::from_nanos)
    }

    /// Takes back a step that has been taken and has not been made, and says which. The motor keeps its
    /// current, so that it stands where it is: for an end of motion that is not an emergency.
    pub const fn cancel(&mut self) -> Option<Direction> {
        self.waiting.take()
    }

    /// Gives the pins back as they are: STEP, DIR, ENABLE, SLEEP. [`stop`](Self::stop) first.
    pub fn release(self) -> (Step, Dir, Enable, Sleep) {
        (self.step, self.dir, self.enable, self.sleep)
    }

    /// When the pulse may end, ns.
    pub(crate) fn falls_at(&self) -> Option<u64> {
        (self.level == Level::High).then_some(self.earliest)
    }

    /// When the step that waits may be made, ns; within a pulse, that one comes first.
    pub(crate) fn rises_at(&self) -> Option<u64> {
        self.is_waiting().then_some(self.earliest)
    }

    /// Whether a step waits for nothing but to be made.
    pub(crate) fn is_ready(&self, now_ns: u64) -> bool {
        self.level == Level::Low && self.waiting.is_some() && now_ns >= self.earliest
    }

    /// How long a blocking form has to wait, ns. Each begins at time 0, so that `earliest` is how long; what
    /// the other form has left behind is over after the longest time of all.
    pub(crate) fn settling(&self) -> u32 {
        u32::try_from(self.earliest).unwrap_or(u32::MAX).min(self.timing.longest())
    }

    /// It has waited.
    pub(crate) const fn settled(&mut self) {
        self.earliest = 0;
    }

    /// This motor's share of a pulse.
    const fn share(&self, pulse: Pulse) -> Option<Direction> {
        #[cfg(feature = "third-motor")]
        let pulse = match self.part {
            Part::First => pulse,
            Part::Second => pulse.of_second(self.axis),
            Part::Z => pulse.of_z(self.axis),
        };
        let step = match self.axis {
            Axis::X => pulse.x(),
            Axis::Y => pulse.y(),
        };
        match step {
            1.. => Some(Direction::Plus),
            0 => None,
            _ => Some(Direction::Minus),
        }
    }
}

impl<Step, Dir, Enable, Sleep> A4988<Step, Dir, Enable, Sleep>
where
    Step: OutputPin,
    Dir: OutputPin,
    Enable: OutputPin,
    Sleep: OutputPin,
{
    /// Brings every pin into a known state, whatever was before: STEP low, awake, outputs on. The motor
    /// holds; the first step rises when the chip has woken up.
    ///
    /// # Errors
    ///
    /// [`Error::Busy`] within a pulse; otherwise [`Error::Pin`] or [`Error::StillOn`].
    pub fn start(&mut self, now: Duration) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        self.can_start(now)?;
        self.halt();
        self.switch_on().map_err(|cause| self.after_pin(cause))?;
        let TimingNs { low, setup, wake, .. } = self.timing;
        self.earliest = nanos(now).saturating_add(wake.max(low).max(setup).into());
        self.on = true;
        Ok(())
    }

    /// As [`start`](Self::start), and comes back when the chip has woken up.
    ///
    /// # Errors
    ///
    /// As [`start`](Self::start), but never [`Error::Busy`].
    pub fn start_blocking(
        &mut self,
        delay: &mut impl DelayNs,
    ) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        self.settle(delay);
        self.start(Duration::ZERO)?;
        self.settle(delay);
        Ok(())
    }

    /// Takes the motor's share of a pulse; none is no step. Makes at once what can be made at once; the rest
    /// is [`tick`](Self::tick)'s.
    ///
    /// `now` is the time just before the call. An edge that comes later after its reading than the next one
    /// after its own shortens what lies between by the difference: where that counts, add it to the
    /// [`Timing`], as [`Timing::on_clock`] adds a tick of the clock.
    ///
    /// # Errors
    ///
    /// [`Error::Off`] before the start and after a stop or a fault; [`Error::Busy`] while another step is put
    /// off. The step has then not been taken. [`Error::Pin`] and [`Error::StillOn`] when a pin fails: steps
    /// may be lost.
    pub fn step(&mut self, pulse: Pulse, now: Duration) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        self.can_take(pulse)?;
        self.take(pulse);
        self.tick(now)
    }

    /// Does what is due: ends a pulse, begins one that was put off. Never more than one edge of STEP in a
    /// call.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`] and [`Error::StillOn`] when a pin fails.
    pub fn tick(&mut self, now: Duration) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        let now_ns = nanos(now);
        self.prepare(now_ns)?;
        if self.is_ready(now_ns) { self.rise(now_ns) } else { Ok(()) }
    }

    /// Makes the motor's share of a pulse, and comes back when the chip is ready for the next.
    ///
    /// # Errors
    ///
    /// As [`step`](Self::step).
    pub fn step_blocking(
        &mut self,
        pulse: Pulse,
        delay: &mut impl DelayNs,
    ) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        self.can_take(pulse)?;
        self.take(pulse);
        self.settle(delay);
        // Ends: each turn waits for the next of DIR set, STEP high, STEP low.
        while self.due().is_some() {
            self.tick(Duration::ZERO)?;
            self.settle(delay);
        }
        Ok(())
    }

    /// Sets the resolution of the chip; the next step waits for the setup time. Count and place of the motor
    /// are in other units afterwards, so set it before the first step.
    ///
    /// # Errors
    ///
    /// [`Error::Busy`] within a pulse and while a step is put off; [`Error::Microsteps`] for a resolution
    /// that the chip does not have; [`Error::Pin`] and [`Error::StillOn`] when a pin fails.
    pub fn set_microsteps<Ms1, Ms2, Ms3>(
        &mut self,
        pins: &mut MicrostepPins<Ms1, Ms2, Ms3>,
        microsteps: u16,
        now: Duration,
    ) -> Result<(), Error<MicrostepErrorOf<Ms1, Ms2, Ms3>>>
    where
        Ms1: OutputPin,
        Ms2: OutputPin,
        Ms3: OutputPin,
    {
        if let Some(until) = self.due() {
            return Err(Error::Busy { until });
        }
        let levels = pins.chip().levels(microsteps).ok_or(Error::Microsteps(microsteps))?;
        pins.set(levels).map_err(|cause| self.after_pin(cause))?;
        self.earliest = self.earliest.max(nanos(now).saturating_add(self.timing.setup.into()));
        Ok(())
    }

    /// Switches the outputs off at once: the motor has no current and turns freely, its place is lost.
    /// Without a pin on ENABLE the chip is put to sleep, and without either the motor gets no more steps and
    /// holds. A step put off is dropped, a pulse on STEP left to [`tick`](Self::tick). [`start`](Self::start)
    /// makes the motor ready again.
    ///
    /// # Errors
    ///
    /// [`Error::Pin`] and [`Error::StillOn`] when a pin fails.
    pub fn stop(&mut self) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        self.on = false;
        self.waiting = None;
        let off = if self.has_enable {
            self.enable.set_high().map_err(PinError::Enable)
        } else if self.has_sleep {
            self.sleep.set_low().map_err(PinError::Sleep)
        } else {
            Ok(())
        };
        off.map_err(|cause| self.after_pin(cause))
    }

    /// Stops, and puts the chip to sleep.
    ///
    /// # Errors
    ///
    /// As [`stop`](Self::stop).
    pub fn sleep(&mut self) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        self.stop()?;
        self.sleep.set_low().map_err(|cause| self.after_pin(PinError::Sleep(cause)))
    }

    /// Whether no pulse is cut short by a start.
    pub(crate) fn can_start(&self, now: Duration) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        if self.level != Level::Low && nanos(now) < self.earliest { Err(self.busy()) } else { Ok(()) }
    }

    /// Whether the motor's share of a pulse can be taken.
    pub(crate) fn can_take(&self, pulse: Pulse) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        match self.share(pulse) {
            Some(_) if !self.on => Err(Error::Off),
            Some(_) if self.waiting.is_some() => Err(self.busy()),
            _ => Ok(()),
        }
    }

    /// Notes the step, which can be taken.
    pub(crate) const fn take(&mut self, pulse: Pulse) {
        if let Some(direction) = self.share(pulse) {
            self.waiting = Some(direction);
        }
    }

    /// All that comes before STEP rises: it falls, and DIR changes.
    pub(crate) fn prepare(&mut self, now_ns: u64) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        if self.level == Level::High && now_ns >= self.earliest {
            self.step.set_low().map_err(|cause| self.after_pin(PinError::Step(cause)))?;
            self.level = Level::Low;
            self.earliest = now_ns.saturating_add(self.timing.low.into());
        }
        if self.level == Level::Low && self.waiting.is_some() && self.waiting != self.direction {
            self.turn().map_err(|cause| self.after_pin(PinError::Dir(cause)))?;
            self.earliest = self.earliest.max(now_ns.saturating_add(self.timing.setup.into()));
        }
        Ok(())
    }

    pub(crate) fn rise(&mut self, now_ns: u64) -> Result<(), ErrorOf<Step, Dir, Enable, Sleep>> {
        // DIR waits for STEP to fall, so the pulse lasts as long as DIR must hold.
        self.earliest = now_ns.saturating_add(self.timing.pulse.into());
        self.step.set_high().map_err(|cause| self.after_pin(PinError::Step(cause)))?;
        self.waiting = None;
        self.level = Level::High;
        Ok(())
    }

    const fn busy<Pin>(&self) -> Error<Pin> {
        Error::Busy { until: Duration::from_nanos(self.earliest) }
    }

    fn turn(&mut self) -> Result<(), Dir::Error> {
        let plus = self.waiting == Some(Direction::Plus);
        self.dir.set_state(PinState::from(plus != self.inverted))?;
        self.direction = self.waiting;
        Ok(())
    }

    fn switch_on(&mut self) -> Result<(), PinErrorOf<Step, Dir, Enable, Sleep>> {
        // STEP first: no edge when the chip wakes.
        self.step.set_low().map_err(PinError::Step)?;
        self.level = Level::Low;
        self.sleep.set_high().map_err(PinError::Sleep)?;
        self.enable.set_low().map_err(PinError::Enable)
    }

    fn settle(&mut self, delay: &mut impl DelayNs) {
        wait(self.settling(), delay);
        self.settled();
    }

    /// No steps, and nothing known of the pins.
    fn halt(&mut self) {
        self.on = false;
        self.waiting = None;
        self.direction = None;
        self.level = Level::Unknown;
    }

    /// A pin failed: no more steps, and no current if that can be had.
    fn after_pin<Pin>(&mut self, cause: Pin) -> Error<Pin> {
        self.halt();
        if self.switch_off() { Error::Pin(cause) } else { Error::StillOn(cause) }
    }

    /// Each way is tried twice: a fault may pass.
    fn switch_off(&mut self) -> bool {
        let disabled = self.has_enable && (self.enable.set_high().is_ok() || self.enable.set_high().is_ok());
        disabled || self.has_sleep && (self.sleep.set_low().is_ok() || self.sleep.set_low().is_ok())
    }
}

/// Nothing at all is not asked of a delay.
pub(crate) fn wait(time_ns: u32, delay: &mut impl DelayNs) {
    if time_ns > 0 {
        delay.delay_ns(time_ns);
    }
}

/// The time as whole nanoseconds: a comparison and a sum of these are few instructions in the interrupt.
/// Exact for 584 years, and then begins anew.
pub(crate) fn nanos(now: Duration) -> u64 {
    now.as_secs().wrapping_mul(1_000_000_000).wrapping_add(now.subsec_nanos().into())
}
