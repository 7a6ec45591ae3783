//! [`LinkedGantry`] as a controller that can be re-run.

use super::Controller;
use super::gantry::PWM_STEPS;
use super::machine::{gate, pwm_steps, steps_of};
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::control::LineController;
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::protocol::LinkSettings;
use plotter_motion::{Axis, Direction, Machine};

/// As [`LinkedController`], with motors of 255 steps of PWM.
impl<const WINDOW: usize, const PAYLOAD: usize, C: LineController> Controller
    for LinkedGantry<WINDOW, PAYLOAD, C>
{
    fn receive(&mut self, now: Duration, byte: u8) {
        Self::receive(self, now, byte);
        self.poll(now);
    }

    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
        self.gantry_mut().edge(now, axis, sign);
        self.poll(now);
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        Controller::switch(self.gantry_mut(), now, name, pressed);
        self.poll(now);
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.gantry_mut().emergency_stop(now, pressed);
        self.poll(now);
    }

    fn next_tick(&self) -> Option<Duration> {
        self.gantry().next_tick()
    }

    fn tick(&mut self, now: Duration) {
        self.gantry_mut().tick(now);
        self.poll(now);
    }

    fn transmit(&mut self) -> Option<u8> {
        None // asked with the time only
    }

    fn transmit_at(&mut self, now: Duration) -> Option<u8> {
        Self::transmit(self, now)
    }

    fn waits_for_line(&self) -> bool {
        true
    }

    fn next_transmission(&self) -> Option<Duration> {
        self.next_wake()
    }

    fn duty(&self, axis: Axis) -> i32 {
        self.gantry().drive().axis(axis).steps(PWM_STEPS)
    }
}

/// The controller of a machine behind the reliable link, as the machine's description makes it: with digits
/// from the first byte on, and frames once a host has called.
///
/// Its window and its payload are part of what it says; those of a simulated machine are 4 frames and 64
/// bytes.
#[derive(Debug, PartialEq)]
pub struct LinkedController<const WINDOW: usize = 4, const PAYLOAD: usize = 64> {
    linked: LinkedGantry<WINDOW, PAYLOAD>,
    pwm_steps: [u16; 2],
}

impl<const WINDOW: usize, const PAYLOAD: usize> LinkedController<WINDOW, PAYLOAD> {
    /// The controller of this machine, at rest at (0, 0); `boot` is its number since it was switched on,
    /// which it tells its host.
    #[must_use]
    pub fn new(machine: &Machine, boot: u32) -> Self {
        let linked = LinkedGantry::new(Gantry::new(machine, gate()), boot, LinkSettings::default());
        Self { linked, pwm_steps: pwm_steps(machine) }
    }

    /// The controller itself.
    #[must_use]
    pub const fn linked(&self) -> &LinkedGantry<WINDOW, PAYLOAD> {
        &self.linked
    }
}

impl<const WINDOW: usize, const PAYLOAD: usize> Controller for LinkedController<WINDOW, PAYLOAD> {
    fn receive(&mut self, now: Duration, byte: u8) {
        Controller::receive(&mut self.linked, now, byte);
    }
    fn edge(&mut self, now: Duration, axis: Axis, sign: Direction) {
        self.linked.edge(now, axis, sign);
    }
    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        self.linked.switch(now, name, pressed);
    }
    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.linked.emergency_stop(now, pressed);
    }
    fn next_tick(&self) -> Option<Duration> {
        self.linked.next_tick()
    }
    fn tick(&mut self, now: Duration) {
        self.linked.tick(now);
    }
    fn transmit(&mut self) -> Option<u8> {
        None // asked with the time only
    }
    fn transmit_at(&mut self, now: Duration) -> Option<u8> {
        self.linked.transmit_at(now)
    }
    fn waits_for_line(&self) -> bool {
        true
    }
    fn next_transmission(&self) -> Option<Duration> {
        self.linked.next_transmission()
    }
    fn duty(&self, axis: Axis) -> i32 {
        self.linked.gantry().drive().axis(axis).steps(steps_of(self.pwm_steps, axis))
    }
}
