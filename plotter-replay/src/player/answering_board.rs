//! [`AnsweringBoard`]: a marking board that says when it has arrived.

use super::Controller;
use super::board::PWM_STEPS;
use super::machine::gate;
use crate::log::SwitchName;
use core::time::Duration;
use plotter_motion::control::ChosenController;
use plotter_motion::firmware::MarkingBoard;
use plotter_motion::protocol::digits::Reply;
use plotter_motion::{Axis, Direction, Machine, Pen, StepPoint};

/// [`MarkingBoard`] as a log of the protocol `counts` has it: its moves are the `@ pen` and `@ target`
/// records, and it answers each by `+` once it has arrived.
#[derive(Debug, PartialEq)]
pub struct AnsweringBoard {
    board: MarkingBoard<ChosenController>,
    is_under_way: bool,
    answer: Option<u8>,
}

impl AnsweringBoard {
    /// Steps of the timers of its motors, as the log has their duties.
    pub const PWM_STEPS: u16 = PWM_STEPS;

    /// The controller of this machine, at rest where it is switched on.
    #[must_use]
    pub fn new(machine: &Machine) -> Self {
        Self { board: MarkingBoard::of(machine, gate()), is_under_way: false, answer: None }
    }

    /// The controller itself.
    #[must_use]
    pub fn board(&self) -> &MarkingBoard<ChosenController> {
        &self.board
    }

    fn look(&mut self) {
        if self.is_under_way && self.board.has_arrived() {
            self.is_under_way = false;
            self.answer = Some(Reply::Reached.byte());
        }
    }
}

impl Controller for AnsweringBoard {
    fn receive(&mut self, _: Duration, _: u8) {}

    fn edge(&mut self, now: Duration, axis: Axis, _: Direction) {
        self.board.pulse(now, axis);
        self.look();
    }

    fn switch(&mut self, now: Duration, name: &SwitchName, pressed: bool) {
        Controller::switch(&mut self.board, now, name, pressed);
    }

    fn emergency_stop(&mut self, now: Duration, pressed: bool) {
        self.board.emergency_stop(now, pressed);
    }

    fn next_tick(&self) -> Option<Duration> {
        Some(self.board.next_tick())
    }

    fn tick(&mut self, now: Duration) {
        self.board.tick(now);
        self.look();
    }

    fn transmit(&mut self) -> Option<u8> {
        self.answer.take()
    }

    fn duty(&self, axis: Axis) -> i32 {
        Controller::duty(&self.board, axis)
    }

    fn target(&mut self, now: Duration, pen: Pen, target: StepPoint) {
        self.is_under_way = true;
        Controller::target(&mut self.board, now, pen, target);
        self.look();
    }
}
