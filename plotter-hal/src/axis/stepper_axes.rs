//! [`StepperAxes`]: two stepper motors.

use super::Error;
use crate::a4988::{self, A4988, ErrorOf};
use core::time::Duration;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::OutputPin;
#[cfg(doc)]
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::Drivers;
use plotter_motion::{Direction, StepPair, safety::Pulse};

/// Two stepper motors on chips of the A4988 kind, fed by a [`Pulse`].
///
/// When both step, STEP rises at both at the same time: when one of them must wait, for its setup time or the
/// end of its last pulse, the other one waits with it. As with [one motor](A4988), one pulse can be put off;
/// a second is refused. So ask [`drivers`](StepperAxes::drivers) before a pulse is taken from its source: a
/// loop that comes late finds several due.
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction as Set};
/// use plotter_hal::a4988::{A4988, Timing};
/// use plotter_hal::StepperAxes;
/// use plotter_motion::{Axis, LimitSwitches, SafetyGate, StepPair};
///
/// # fn pin(levels: &[embedded_hal_mock::eh1::digital::State]) -> Pin { Pin::new(&levels.iter().map(|&level| Set::set(level)).collect::<Vec<_>>()) }
/// # let (x_step, x_dir) = (pin(&[Low, High, Low]), pin(&[High]));
/// # let (y_step, y_dir) = (pin(&[Low, High, Low]), pin(&[Low]));
/// let x = A4988::new(Axis::X, x_step, x_dir, Timing::DRV8825);
/// let y = A4988::new(Axis::Y, y_step, y_dir, Timing::DRV8825);
/// let mut motors = StepperAxes::new(x, y);
/// let us = Duration::from_micros;
/// motors.start(us(0))?;
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let diagonal = gate.pass_step(StepPair { x: 1, y: -1 }).map_err(|_| "stopped")?;
/// motors.step(diagonal, us(2000))?; // sets DIR of both
/// motors.tick(us(2001))?; // STEP rises at both
/// assert_eq!(motors.due(), Some(Duration::from_nanos(2_002_900)));
/// motors.tick(us(2003))?; // and falls
/// assert_eq!(motors.due(), None);
/// # let ((mut a, mut b, _, _), (mut c, mut d, _, _)) = { let (x, y) = motors.release(); (x.release(), y.release()) };
/// # a.done();
/// # b.done();
/// # c.done();
/// # d.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StepperAxes<X, Y> {
    x: X,
    y: Y,
}

/// What both motors can say.
type Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> =
    Result<(), Error<ErrorOf<XStep, XDir, XEnable, XSleep>, ErrorOf<YStep, YDir, YEnable, YSleep>>>;

impl<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep>
    StepperAxes<A4988<XStep, XDir, XEnable, XSleep>, A4988<YStep, YDir, YEnable, YSleep>>
where
    XStep: OutputPin,
    XDir: OutputPin,
    XEnable: OutputPin,
    XSleep: OutputPin,
    YStep: OutputPin,
    YDir: OutputPin,
    YEnable: OutputPin,
    YSleep: OutputPin,
{
    /// Both motors; each takes the share of its own axis. Leaves the pins as they are: nothing moves before
    /// [`start`](Self::start).
    pub const fn new(x: A4988<XStep, XDir, XEnable, XSleep>, y: A4988<YStep, YDir, YEnable, YSleep>) -> Self {
        Self { x, y }
    }

    /// Whether a pulse is put off, so that another one may be refused.
    pub const fn is_waiting(&self) -> bool {
        self.x.is_waiting() || self.y.is_waiting()
    }

    /// Whether both take a pulse now: what [`StepperPlotter::poll`] asks before it gives one, so that none is
    /// refused and lost.
    pub const fn drivers(&self) -> Drivers {
        if self.is_waiting() { Drivers::Busy } else { Drivers::Ready }
    }

    /// When [`tick`](Self::tick) is to be called; later does no harm. `None` while there is nothing to do.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn due(&self) -> Option<Duration> {
        let falls = sooner(self.x.falls_at(), self.y.falls_at());
        // A step of both waits for the later one.
        let rises = self.x.rises_at().max(self.y.rises_at());
        sooner(falls, rises).map(Duration::from_nanos)
    }

    /// Brings every pin of both motors into a known state, whatever was before: both hold, and wake up.
    ///
    /// # Errors
    ///
    /// As [`A4988::start`]; after a fault of a pin both motors have been stopped.
    pub fn start(
        &mut self,
        now: Duration,
    ) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        Error::check(self.x.can_start(now), self.y.can_start(now))?;
        let (x, y) = (self.x.start(now), self.y.start(now));
        self.check(x, y)
    }

    /// As [`start`](Self::start), and comes back when both chips have woken up.
    ///
    /// # Errors
    ///
    /// As [`start`](Self::start), but never [`Busy`](a4988::Error::Busy).
    pub fn start_blocking(
        &mut self,
        delay: &mut impl DelayNs,
    ) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        self.settle(delay);
        self.start(Duration::ZERO)?;
        self.settle(delay);
        Ok(())
    }

    /// Takes a pulse: a step of either motor or of both. Makes at once what can be made at once; the rest is
    /// [`tick`](Self::tick)'s.
    ///
    /// # Errors
    ///
    /// As [`A4988::step`]. A pulse that one motor cannot take is not taken by the other; after a fault of a
    /// pin both have been stopped.
    pub fn step(
        &mut self,
        pulse: Pulse,
        now: Duration,
    ) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        self.take(pulse)?;
        self.tick(now)
    }

    /// Does what is due: ends pulses, begins those that were put off.
    ///
    /// # Errors
    ///
    /// [`Error`] says what failed at which motor; both have been stopped.
    pub fn tick(
        &mut self,
        now: Duration,
    ) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        let now_ns = a4988::nanos(now);
        let (x, y) = (self.x.prepare(now_ns), self.y.prepare(now_ns));
        self.check(x, y)?;
        let (x_steps, y_steps) = (self.x.is_waiting(), self.y.is_waiting());
        if x_steps && !self.x.is_ready(now_ns) || y_steps && !self.y.is_ready(now_ns) {
            return Ok(());
        }
        let x = if x_steps { self.x.rise(now_ns) } else { Ok(()) };
        let y = if y_steps && x.is_ok() { self.y.rise(now_ns) } else { Ok(()) };
        self.check(x, y)
    }

    /// Makes a pulse, and comes back when both chips are ready for the next.
    ///
    /// # Errors
    ///
    /// As [`step`](Self::step).
    pub fn step_blocking(
        &mut self,
        pulse: Pulse,
        delay: &mut impl DelayNs,
    ) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        self.take(pulse)?;
        self.settle(delay);
        // Ends: each turn waits for the next of DIR set, STEP high, STEP low.
        while self.due().is_some() {
            self.tick(Duration::ZERO)?;
            self.settle(delay);
        }
        Ok(())
    }

    /// Takes back a pulse that has been taken and has not been made, and says which. The motors keep their
    /// current, so that they stand where they are: for an end of motion that is not an emergency.
    pub const fn cancel(&mut self) -> Option<StepPair> {
        match (self.x.cancel(), self.y.cancel()) {
            (None, None) => None,
            (x, y) => Some(StepPair { x: step_of(x), y: step_of(y) }),
        }
    }

    /// Switches the outputs of both motors off at once, as [`A4988::stop`]: for an emergency. A pulse that
    /// was put off is dropped.
    ///
    /// # Errors
    ///
    /// [`Error`] says what failed at which motor.
    pub fn stop(&mut self) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        let (x, y) = (self.x.stop(), self.y.stop());
        Error::check(x, y)
    }

    /// Gives both motors back, as they are: [`stop`](Self::stop) first.
    #[expect(clippy::type_complexity, reason = "these are the two that came in")]
    pub fn release(self) -> (A4988<XStep, XDir, XEnable, XSleep>, A4988<YStep, YDir, YEnable, YSleep>) {
        (self.x, self.y)
    }

    fn take(&mut self, pulse: Pulse) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        Error::check(self.x.can_take(pulse), self.y.can_take(pulse))?;
        self.x.take(pulse);
        self.y.take(pulse);
        Ok(())
    }

    fn settle(&mut self, delay: &mut impl DelayNs) {
        a4988::wait(self.x.settling().max(self.y.settling()), delay);
        self.x.settled();
        self.y.settled();
    }

    /// A motor that failed has stopped itself: stops the other one.
    fn check(
        &mut self,
        x: Result<(), ErrorOf<XStep, XDir, XEnable, XSleep>>,
        y: Result<(), ErrorOf<YStep, YDir, YEnable, YSleep>>,
    ) -> Outcome<XStep, XDir, XEnable, XSleep, YStep, YDir, YEnable, YSleep> {
        match (x, y) {
            (Ok(()), Ok(())) => Ok(()),
            (Err(x), Ok(())) => Err(Error { x: Some(x), y: self.y.stop().err() }),
            (Ok(()), Err(y)) => Err(Error { x: self.x.stop().err(), y: Some(y) }),
            (Err(x), Err(y)) => Err(Error { x: Some(x), y: Some(y) }),
        }
    }
}

fn sooner(one: Option<u64>, other: Option<u64>) -> Option<u64> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.min(other)),
        _ => one.or(other),
    }
}

const fn step_of(direction: Option<Direction>) -> i8 {
    match direction {
        Some(Direction::Plus) => 1,
        Some(Direction::Minus) => -1,
        None => 0,
    }
}
