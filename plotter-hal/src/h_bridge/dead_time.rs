//! [`DeadTime`]: a pause between one direction of a motor and the other.

use super::Bridge;
use core::time::Duration;
use embedded_hal::delay::DelayNs;
use plotter_motion::{Axis, Direction, Drive};

/// A motor that gets no drive for a time before it is reversed, so that the switches of the bridge have
/// opened and the motor's current has run out.
///
/// Bridges with a dead time of their own need none, and a motor with a bridge alone has none. One that is
/// large for its supply may need some milliseconds.
///
/// Without waiting: [`drive`](Self::drive) takes a drive and the time. A motor that must wait gets none, and
/// [`due`](Self::due) says when to call it again, with what the gate lets through then: no drive is kept
/// here, which could be out of date. With waiting: [`drive_blocking`](Self::drive_blocking).
///
/// ```
/// # use core::time::Duration;
/// # use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// # use plotter_hal::h_bridge::{Decay, Drv8871};
/// # use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
/// use plotter_hal::h_bridge::DeadTime;
/// # let in1 = [SetDuty::set_duty_cycle(0), SetDuty::max_duty_cycle(200), SetDuty::set_duty_cycle(100)];
/// # let in2 = [SetDuty::set_duty_cycle(0), SetDuty::set_duty_cycle(0)];
/// # let motor = Drv8871::new(Axis::X, Pwm::new(&in1), Pwm::new(&in2), Decay::Fast);
///
/// let ms = Duration::from_millis;
/// let mut motor = DeadTime::new(motor, ms(2));
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// let demand = Demand { x: Duty::new(0.5)?, y: Duty::ZERO };
/// motor.drive(gate.pass(demand), ms(10))?; // what was before is not known
/// assert_eq!(motor.due(), Some(ms(12)));
/// motor.drive(gate.pass(demand), ms(12))?; // now it turns
/// assert_eq!(motor.due(), None);
/// # let (mut in1, mut in2) = motor.release().release();
/// # in1.done();
/// # in2.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DeadTime<Motor> {
    motor: Motor,
    dead_time: Duration,
    /// The direction last given.
    direction: Option<Direction>,
    /// When the drive was taken away; `None` while there is one, and when that is not known.
    free_since: Option<Duration>,
    /// Whether a drive was asked for that has not been given.
    waits: bool,
}

impl<Motor: Bridge> DeadTime<Motor> {
    /// The motor with a dead time. Leaves the pins as they are.
    pub const fn new(motor: Motor, dead_time: Duration) -> Self {
        Self { motor, dead_time, direction: None, free_since: None, waits: false }
    }

    /// The axis of the motor.
    pub fn axis(&self) -> Axis {
        self.motor.axis()
    }

    /// When [`drive`](Self::drive) is to be called again; later does no harm. `None` while the motor waits
    /// for none.
    pub fn due(&self) -> Option<Duration> {
        self.free_since.filter(|_| self.waits).map(|since| since.saturating_add(self.dead_time))
    }

    /// Brings the pins into a known state, without drive.
    ///
    /// # Errors
    ///
    /// Those of the motor.
    pub fn start(&mut self) -> Result<(), Motor::Error> {
        self.forget();
        self.motor.start()
    }

    /// Gives the motor its share of `drive`, or none while it has to wait: see [`due`](Self::due).
    ///
    /// # Errors
    ///
    /// Those of the motor; it waits for none then.
    pub fn drive(&mut self, drive: Drive, now: Duration) -> Result<(), Motor::Error> {
        self.waits = false;
        let direction = drive.axis(self.axis()).direction();
        if direction.is_some() && direction == self.direction {
            return self.give(drive);
        }
        if direction.is_none() || self.free_since.is_none() {
            self.take_away(now)?;
        }
        self.waits = direction.is_some();
        if self.due().is_some_and(|due| now >= due) { self.give(drive) } else { Ok(()) }
    }

    /// As [`drive`](Self::drive), and comes back when the motor has its drive.
    ///
    /// # Errors
    ///
    /// Those of the motor.
    pub fn drive_blocking(&mut self, drive: Drive, delay: &mut impl DelayNs) -> Result<(), Motor::Error> {
        self.drive(drive, Duration::ZERO)?;
        let Some(due) = self.due() else { return Ok(()) };
        delay.delay_ns(u32::try_from(self.dead_time.as_nanos()).unwrap_or(u32::MAX));
        self.drive(drive, due)
    }

    /// Takes the drive away; the motor waits for none any more.
    ///
    /// # Errors
    ///
    /// Those of the motor.
    pub fn stop(&mut self) -> Result<(), Motor::Error> {
        // No time is known: the next reversal takes the drive away once more, and counts from there.
        self.waits = false;
        self.free_since = None;
        self.motor.stop().inspect_err(|_| self.forget())
    }

    /// Gives the motor back, as it is: [`stop`](Self::stop) first.
    pub fn release(self) -> Motor {
        self.motor
    }

    fn give(&mut self, drive: Drive) -> Result<(), Motor::Error> {
        self.waits = false;
        self.free_since = None;
        self.direction = drive.axis(self.axis()).direction();
        self.motor.drive(drive).inspect_err(|_| self.forget())
    }

    fn take_away(&mut self, now: Duration) -> Result<(), Motor::Error> {
        self.motor.stop().inspect_err(|_| self.forget())?;
        // A motor that is free already has been so since then.
        self.free_since.get_or_insert(now);
        Ok(())
    }

    fn forget(&mut self) {
        self.direction = None;
        self.free_since = None;
        self.waits = false;
    }
}
