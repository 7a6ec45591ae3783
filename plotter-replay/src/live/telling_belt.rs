//! [`TellingBelt`]: a board with a belt that tells the host of its digits where it goes.

use super::simulated::Steps;
use crate::player::AnsweringBoard;
use crate::simulation::{Act, ActError, Belt, Seen, Simulation, Take, belt};
use core::time::Duration;
use plotter_motion::config::DcConfig;
use plotter_motion::protocol::digits::Reply;
use plotter_motion::toolpath::from_mm;
use plotter_motion::{Axis, Direction, Machine, StepPoint};

/// A simulated board, and what reads digits for it: that tells each count of the axes, too, as a gantry does.
/// The board's log has its targets and its edges instead.
pub(super) struct TellingBelt {
    board: Simulation<AnsweringBoard, Belt>,
    counts_per_mm: f64,
    told: StepPoint,
    said: Vec<u8>,
}

impl TellingBelt {
    pub(super) fn new(machine: &Machine) -> Self {
        let counts_per_mm = DcConfig::of(machine).x.counts_per_mm;
        let mut board =
            Self { board: belt(machine), counts_per_mm, told: StepPoint::default(), said: Vec::new() };
        board.told = board.counted();
        board
    }

    /// Where the board has counted to, counts of both axes.
    fn counted(&self) -> StepPoint {
        let at = self.board.controller().board().position_mm();
        StepPoint::new(from_mm(at.x, self.counts_per_mm), from_mm(at.y, self.counts_per_mm))
    }
}

impl Steps for TellingBelt {
    fn now(&self) -> Duration {
        self.board.now()
    }
    fn byte(&mut self, byte: u8) {
        self.board.byte(byte);
    }
    fn on_line(&self) -> usize {
        self.board.on_line()
    }
    fn step(&mut self, sink: Take<'_>) {
        self.board.step(sink);
        let (at, told) = (self.counted(), self.told);
        for (axis, by) in [(Axis::X, at.x - told.x), (Axis::Y, at.y - told.y)] {
            let direction = if by > 0 { Direction::Plus } else { Direction::Minus };
            self.said.extend((0..by.abs()).map(|_| Reply::Pulse(axis, direction).byte()));
        }
        self.told = at;
    }
    fn act(&mut self, act: &Act) -> Result<(), ActError> {
        self.board.act(act)
    }
    fn seen(&self) -> Seen {
        self.board.seen()
    }
    fn said(&mut self) -> Vec<u8> {
        core::mem::take(&mut self.said)
    }
}
