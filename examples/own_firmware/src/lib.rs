//! A controller of one's own: it reads targets of ten digits as the semi-virtual gantry does, drives one
//! motor after the other with full duty, and slows down near the target.
//!
//! It knows nothing of logs or tests: this is what would run on the microcontroller. What makes it testable
//! is its shape: bytes, edges and time go in, bytes and duty cycles come out, and it reads no clock.

#![no_std]
#![forbid(unsafe_code)]

use core::time::Duration;
use plotter_motion::protocol::digits::{Receiver, Reply};
use plotter_motion::{Axis, Direction, StepPoint};

/// Steps of the PWM timer at full speed, and near the target.
const FULL: i32 = 255;
const SLOW: i32 = 60;
/// Encoder counts before the target from which on it is slow.
const NEAR: i32 = 20;

/// The controller.
#[derive(Clone, Debug)]
pub struct OwnFirmware {
    receiver: Receiver,
    position: StepPoint,
    target: Option<StepPoint>,
    /// What waits to be sent: at most a pulse for each edge, and `+`.
    answers: [u8; 16],
    waiting: usize,
}

impl Default for OwnFirmware {
    fn default() -> Self {
        Self {
            receiver: Receiver::new(Duration::from_millis(100)),
            position: StepPoint::default(),
            target: None,
            answers: [0; 16],
            waiting: 0,
        }
    }
}

impl OwnFirmware {
    /// A byte has come.
    pub fn receive(&mut self, now: Duration, byte: u8) {
        if let Some(target) = self.receiver.push(now, byte).target {
            self.target = Some(target);
            self.arrive();
        }
    }

    /// An encoder has counted.
    pub fn edge(&mut self, axis: Axis, direction: Direction) {
        match axis {
            Axis::X => self.position.x += direction.sign(),
            Axis::Y => self.position.y += direction.sign(),
        }
        self.answer(Reply::Pulse(axis, direction));
        self.arrive();
    }

    /// The next byte to be sent.
    pub fn transmit(&mut self) -> Option<u8> {
        let (&first, _) = self.answers.get(..self.waiting)?.split_first()?;
        self.answers.copy_within(1.., 0);
        self.waiting -= 1;
        Some(first)
    }

    /// Duty cycle of a motor: first x, then y.
    pub fn duty(&self, axis: Axis) -> i32 {
        let Some(target) = self.target else { return 0 };
        let (x, y) = (target.x - self.position.x, target.y - self.position.y);
        let left = match axis {
            Axis::X => x,
            Axis::Y if x == 0 => y,
            Axis::Y => 0,
        };
        left.signum() * if left.abs() > NEAR { FULL } else { SLOW }
    }

    fn arrive(&mut self) {
        if self.target == Some(self.position) {
            self.target = None;
            self.answer(Reply::Reached);
        }
    }

    fn answer(&mut self, reply: Reply) {
        if let Some(place) = self.answers.get_mut(self.waiting) {
            *place = reply.byte();
            self.waiting += 1;
        }
    }
}
