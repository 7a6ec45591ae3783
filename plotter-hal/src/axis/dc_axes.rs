//! [`DcAxes`]: two DC motors.

use super::Error;
use crate::h_bridge::{Bridge, DeadTime};
use core::time::Duration;
use plotter_motion::Drive;

/// Two DC motors on bridges, each with its dead time, fed by a [`Drive`].
///
/// ```
/// use core::time::Duration;
/// use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as SetDuty};
/// use plotter_hal::DcAxes;
/// use plotter_hal::h_bridge::{Decay, Drv8871};
/// use plotter_motion::{Axis, Demand, Duty, LimitSwitches, SafetyGate};
///
/// # fn input(duties: &[u16]) -> Pwm { Pwm::new(&duties.iter().map(|&duty| SetDuty::set_duty_cycle(duty)).collect::<Vec<_>>()) }
/// # let full = SetDuty::max_duty_cycle(200);
/// # let x_in1 = Pwm::new(&[SetDuty::set_duty_cycle(0), full.clone(), SetDuty::set_duty_cycle(100)]);
/// # let y_in2 = Pwm::new(&[SetDuty::set_duty_cycle(0), full, SetDuty::set_duty_cycle(50)]);
/// # let (x_in2, y_in1) = (input(&[0, 0]), input(&[0, 0]));
/// let x = Drv8871::new(Axis::X, x_in1, x_in2, Decay::Fast);
/// let y = Drv8871::new(Axis::Y, y_in1, y_in2, Decay::Fast);
/// let mut motors = DcAxes::new(x, y, Duration::ZERO);
/// let demand = Demand { x: Duty::new(0.5)?, y: Duty::new(-0.25)? };
/// let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
/// motors.drive(gate.pass(demand), Duration::ZERO)?;
/// # let (x, y) = motors.release();
/// # let ((mut a, mut b), (mut c, mut d)) = (x.release(), y.release());
/// # a.done();
/// # b.done();
/// # c.done();
/// # d.done();
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DcAxes<X, Y> {
    x: DeadTime<X>,
    y: DeadTime<Y>,
}

impl<X: Bridge, Y: Bridge> DcAxes<X, Y> {
    /// Both motors, which wait for `dead_time` before they are reversed; 0 for bridges that need none. Each
    /// takes the share of its own axis. Leaves the pins as they are: call [`start`](Self::start) for a known
    /// state.
    pub const fn new(x: X, y: Y, dead_time: Duration) -> Self {
        Self { x: DeadTime::new(x, dead_time), y: DeadTime::new(y, dead_time) }
    }

    /// When [`drive`](Self::drive) is to be called again, with what the gate lets through then; later does no
    /// harm. `None` while no motor waits for its drive.
    pub fn due(&self) -> Option<Duration> {
        match (self.x.due(), self.y.due()) {
            (Some(x), Some(y)) => Some(x.min(y)),
            (x, y) => x.or(y),
        }
    }

    /// Brings the pins of both motors into a known state, without drive, whatever was before.
    ///
    /// # Errors
    ///
    /// [`Error`] says what failed at which motor.
    pub fn start(&mut self) -> Result<(), Error<X::Error, Y::Error>> {
        let (x, y) = (self.x.start(), self.y.start());
        Error::check(x, y)
    }

    /// Gives both motors their share. One that waits for its dead time gets none: see [`due`](Self::due).
    ///
    /// # Errors
    ///
    /// [`Error`] says what failed at which motor; the other one has been stopped as well.
    pub fn drive(&mut self, drive: Drive, now: Duration) -> Result<(), Error<X::Error, Y::Error>> {
        let (x, y) = (self.x.drive(drive, now), self.y.drive(drive, now));
        self.check(x, y)
    }

    /// Takes the drive of both motors away; none waits any more.
    ///
    /// # Errors
    ///
    /// [`Error`] says what failed at which motor.
    pub fn stop(&mut self) -> Result<(), Error<X::Error, Y::Error>> {
        let (x, y) = (self.x.stop(), self.y.stop());
        Error::check(x, y)
    }

    /// Gives both motors back, as they are: [`stop`](Self::stop) first.
    pub fn release(self) -> (X, Y) {
        (self.x.release(), self.y.release())
    }

    /// A motor that failed has stopped itself: stops the other one.
    fn check(
        &mut self,
        x: Result<(), X::Error>,
        y: Result<(), Y::Error>,
    ) -> Result<(), Error<X::Error, Y::Error>> {
        match (x, y) {
            (Ok(()), Ok(())) => Ok(()),
            (Err(x), Ok(())) => Err(Error { x: Some(x), y: self.y.stop().err() }),
            (Ok(()), Err(y)) => Err(Error { x: self.x.stop().err(), y: Some(y) }),
            (Err(x), Err(y)) => Err(Error { x: Some(x), y: Some(y) }),
        }
    }
}
