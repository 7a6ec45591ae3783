//! A laser on a PWM output: lit by nothing but a beam that passed the safety gate, and only in motion.
//!
//! ```text
//!  beam    ┌──────────────────────────────          asked for
//!          │
//!  moved       ▲ ▲  ▲  ▲  ▲ ▲                       steps made, or edges of an encoder
//!                           │◀ timeout ▶│
//!  light       ┌────────────────────────┐           out, and only a new beam lights it again:
//!          ────┘                        └──         one that stands still burns a hole
//! ```
//!
//! The documented stepper plotter drives its laser with 1 kHz, mDraw's 0 to 255 as 0 to 999 steps (Dounaev
//! and Phan, "X-Y Plotter Project", section 2.2.4.3). Its straight lines came out dotted because they were
//! faster than its curves (section 3.1); here the power follows the speed:
//! [`StepGen`](plotter_motion::StepGen) gives out a power that does, and [`power_at_speed`] makes one of a
//! measured speed.

use core::fmt;
use core::time::Duration;
use embedded_hal::pwm::{self, SetDutyCycle};
use plotter_motion::safety::Beam;

/// A laser. Dark unless it was given a [`Beam`] and the machine moves.
///
/// [`moved`](Self::moved) tells it of every step or encoder edge. When none has come for the time given to
/// [`new`](Self::new), the next call of whatever kind darkens it, and a beam asked for before that pause is
/// forgotten: the last power of a movement that broke off must not light the next one. Times never go back.
///
/// Nothing is switched while nothing is called. A program that may hang with the beam on wants
/// [`tick`](Self::tick) in the interrupt of a timer, or the chip's watchdog and a pin that is dark after a
/// reset.
///
/// It goes dark when it is dropped, too. The beam is kept until another is asked for: whoever stops the gate
/// gives [`Beam::OFF`] here, or calls [`off`](Self::off).
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::Laser;
/// use plotter_motion::{LimitSwitches, SafetyGate};
///
/// let pwm = Pwm::new(&[
///     SetDuty::set_duty_cycle(0), // a laser that is taken over is dark
///     SetDuty::max_duty_cycle(999),
///     SetDuty::set_duty_cycle(499), // 32768 of 65535 of 999 steps, rounded down
///     SetDuty::set_duty_cycle(0), // it stood still for too long
///     SetDuty::set_duty_cycle(0), // given back
/// ]);
/// # let mut check = pwm.clone();
/// let ms = Duration::from_millis;
/// let mut laser = Laser::new(pwm, ms(20));
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// laser.shine(ms(0), gate.pass_laser(32_768))?; // not yet: it stands
/// laser.moved(ms(1))?;
/// laser.tick(ms(20))?; // the step was 19 ms ago: still lit
/// assert_eq!(laser.due(), Some(ms(21)));
/// laser.tick(ms(21))?;
/// assert!(!laser.is_lit());
/// let (pwm, dark) = laser.release();
/// dark?;
/// # check.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A number is no beam:
///
/// ```compile_fail
/// # use core::time::Duration;
/// # use embedded_hal_mock::eh1::pwm::Mock as Pwm;
/// # let mut laser = plotter_hal::Laser::new(Pwm::new(&[]), Duration::ZERO);
/// laser.shine(Duration::ZERO, 32_768_u16);
/// ```
#[derive(Debug)]
pub struct Laser<Pwm: SetDutyCycle> {
    /// `None` only once it has been given back: what is dropped then is an empty shell.
    pwm: Option<Pwm>,
    timeout: Duration,
    /// The power asked for, and when.
    beam: Option<(u16, Duration)>,
    last_motion: Option<Duration>,
    /// The power that the PWM has been set to; `None` if it failed, and nobody knows.
    light: Option<u16>,
}

impl<Pwm: SetDutyCycle> Laser<Pwm> {
    /// The laser on `pwm`, which is darkened; if that fails, the first [`tick`](Self::tick) tries again and
    /// tells.
    ///
    /// `timeout` after a step or edge the machine stands: longer than the time between two steps of a line,
    /// short enough that the beam does not burn in. At 250 mm/s² the first step of 1/87.58 mm takes √(2
    /// s/a) = 9.6 ms, and no later one as long; 20 ms suit that machine.
    pub fn new(pwm: Pwm, timeout: Duration) -> Self {
        let mut laser = Self { pwm: Some(pwm), timeout, beam: None, last_motion: None, light: None };
        // What fails here stays unknown, and is tried again.
        let _ = laser.off();
        laser
    }

    /// Takes the beam that is wanted from now on: [`Beam::OFF`] at once, any other while the machine moves.
    ///
    /// # Errors
    ///
    /// [`Error`] if the PWM fails; it says what became of the light.
    pub fn shine(&mut self, now: Duration, beam: Beam) -> Result<(), Error<Pwm::Error>> {
        self.forget_if_still(now);
        self.beam = (beam.power() > 0).then_some((beam.power(), now));
        self.update()
    }

    /// Takes note of motion: a step was made, or an encoder's edge came.
    ///
    /// # Errors
    ///
    /// [`Error`] if the PWM fails; it says what became of the light.
    pub fn moved(&mut self, now: Duration) -> Result<(), Error<Pwm::Error>> {
        self.forget_if_still(now);
        self.last_motion = Some(now);
        self.update()
    }

    /// Darkens a laser that does not move any more, and tries again what failed. Never waits.
    ///
    /// # Errors
    ///
    /// [`Error`] if the PWM fails; it says what became of the light.
    pub fn tick(&mut self, now: Duration) -> Result<(), Error<Pwm::Error>> {
        self.forget_if_still(now);
        self.update()
    }

    /// When [`tick`](Self::tick) has to be called if nothing moves before: then a laser that is lit goes out.
    /// `None` while it is dark.
    pub fn due(&self) -> Option<Duration> {
        let at = self.last_motion.map_or(Duration::ZERO, |at| at.saturating_add(self.timeout));
        self.is_lit().then_some(at)
    }

    /// Darkens it, whatever it is thought to be, and forgets the beam.
    ///
    /// # Errors
    ///
    /// [`Error`] if the PWM fails; it says what became of the light.
    pub fn off(&mut self) -> Result<(), Error<Pwm::Error>> {
        self.beam = None;
        self.write(0)
    }

    /// Whether there may be light: also if the PWM failed and could not be switched off.
    pub fn is_lit(&self) -> bool {
        self.light != Some(0)
    }

    /// Darkens it, says whether that went well, and gives the PWM back. It is always there: it is an
    /// [`Option`] since a thing that goes dark when dropped cannot be taken apart. Who lends the PWM,
    /// `Laser::new(&mut pwm, ..)`, has it back without that when the laser is dropped.
    pub fn release(mut self) -> (Option<Pwm>, Result<(), Error<Pwm::Error>>) {
        let dark = self.off();
        (self.pwm.take(), dark)
    }

    fn is_over(&self, now: Duration, at: Duration) -> bool {
        now.saturating_sub(at) >= self.timeout
    }

    /// A pause ends what was asked for before it, however late it is noticed.
    fn forget_if_still(&mut self, now: Duration) {
        if self.last_motion.is_none_or(|at| self.is_over(now, at)) {
            self.last_motion = None;
            self.beam = self.beam.filter(|&(_, asked)| !self.is_over(now, asked));
        }
    }

    /// Lights or darkens it as beam and motion say.
    fn update(&mut self) -> Result<(), Error<Pwm::Error>> {
        let power = match (self.beam, self.last_motion) {
            (Some((power, _)), Some(_)) => power,
            (None, _) | (_, None) => 0,
        };
        if self.light == Some(power) { Ok(()) } else { self.write(power) }
    }

    /// Sets the PWM. What fails leaves it dark, if it can be done at all.
    fn write(&mut self, power: u16) -> Result<(), Error<Pwm::Error>> {
        // Nothing is left that could light.
        let Some(pwm) = &mut self.pwm else { return Ok(()) };
        let set = match power {
            0 => pwm.set_duty_cycle_fully_off(),
            _ => pwm.set_duty_cycle(steps(power, pwm.max_duty_cycle())),
        };
        let Err(cause) = set else {
            self.light = Some(power);
            return Ok(());
        };
        self.beam = None;
        if pwm.set_duty_cycle_fully_off().is_ok() {
            self.light = Some(0);
            Err(Error::Pwm(cause))
        } else {
            self.light = None;
            Err(Error::NotOff(cause))
        }
    }
}

impl<Pwm: SetDutyCycle> Drop for Laser<Pwm> {
    fn drop(&mut self) {
        // Nobody is left to be told.
        let _ = self.off();
    }
}

/// Of `full` steps of a PWM as many as `power` of 65535, rounded down: never more than was asked for.
fn steps(power: u16, full: u16) -> u16 {
    let steps = u32::from(power) * u32::from(full) / u32::from(u16::MAX);
    u16::try_from(steps).unwrap_or(full)
}

/// The power that burns a line as dark at `speed_mm_s` as `power` does at `full_speed_mm_s`: in proportion to
/// the speed, and `power` at most. 0 for a speed that is no number.
///
/// For machines that measure their speed. A [`StepGen`](plotter_motion::StepGen) does this by itself.
///
/// ```
/// # use plotter_hal::power_at_speed;
/// assert_eq!(power_at_speed(40_000, 15.0, 60.0), 10_000);
/// assert_eq!(power_at_speed(40_000, 61.0, 60.0), 40_000);
/// assert_eq!(power_at_speed(40_000, 0.0, 0.0), 0);
/// ```
#[must_use]
pub fn power_at_speed(power: u16, speed_mm_s: f32, full_speed_mm_s: f32) -> u16 {
    let share = speed_mm_s / full_speed_mm_s;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 65535")]
    let power = if share > 0.0 { (f32::from(power) * share.min(1.0)) as u16 } else { 0 };
    power
}

/// The PWM of a laser failed. The beam is forgotten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error<Pwm> {
    /// It failed once, and the laser was darkened at a second attempt.
    Pwm(Pwm),
    /// The laser could not be darkened: cut its supply. Every call tries again.
    NotOff(Pwm),
}

impl<Pwm: pwm::Error> fmt::Display for Error<Pwm> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pwm(cause) => write!(f, "pwm of the laser: {}; the laser is dark", cause.kind()),
            Self::NotOff(cause) => {
                write!(f, "pwm of the laser: {}; the laser may be lit: cut its supply", cause.kind())
            }
        }
    }
}

impl<Pwm: pwm::Error> core::error::Error for Error<Pwm> {}

crate::which_pin::formats_as_shown!(<Pwm: pwm::Error> Error<Pwm>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_is_rounded_down_to_steps() {
        assert_eq!(steps(0, 999), 0);
        assert_eq!(steps(u16::MAX, 999), 999);
        assert_eq!(steps(u16::MAX - 1, 999), 998);
        assert_eq!(steps(65, 999), 0); // less than a step is none
        assert_eq!(steps(u16::MAX, u16::MAX), u16::MAX);
    }

    #[test]
    fn no_speed_and_no_number_is_no_power() {
        assert_eq!(power_at_speed(40_000, f32::NAN, 60.0), 0);
        assert_eq!(power_at_speed(40_000, -15.0, 60.0), 0);
        assert_eq!(power_at_speed(40_000, 15.0, 0.0), 40_000); // faster than no speed at all
    }
}
