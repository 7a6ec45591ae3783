//! [`Controller`]: what a player runs.

use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::{Axis, Direction};

/// A whole controller as a state machine without port, thread or clock: inputs with their times in, bytes and
/// duty cycles out.
///
/// Times never decrease. After each input and each tick, the bytes for the line are fetched until there are no
/// more.
pub trait Controller {
    /// A byte from the host; `now` is when its last bit came.
    fn receive(&mut self, now: Duration, byte: u8);

    /// A motor turned by one encoder count.
    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction);

    /// A limit switch or a button changed.
    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool);

    /// The emergency stop button changed.
    fn emergency_stop(&mut self, now: Duration, pressed: bool);

    /// When [`Controller::tick`] is to be called next, if ever.
    fn next_tick(&self) -> Option<Duration>;

    /// Runs what is due at `now`; [`Controller::next_tick`] is later than `now` afterwards.
    fn tick(&mut self, now: Duration);

    /// The next byte for the host, if there is one.
    fn transmit(&mut self) -> Option<u8>;

    /// Duty cycle of a motor, in signed steps of its PWM timer, as `@ drive` records it.
    fn duty(&self, axis: Axis) -> i32;
}
