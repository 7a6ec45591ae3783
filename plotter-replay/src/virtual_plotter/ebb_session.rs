//! A session of the EBB's commands: what they move is what the board makes of them.

use super::VirtualPlotter;
use crate::player::Controller as _;
use core::time::Duration;

/// So long after the end of a log the board goes on with what it has: it keeps two commands, of minutes at the
/// most.
const FINISHES_WITHIN: Duration = Duration::from_secs(600);

impl VirtualPlotter {
    /// Takes a byte of the host.
    pub(super) fn ebb_byte(&mut self, byte: u8) {
        if let Some(board) = &mut self.board {
            board.receive(self.now, byte);
            while board.transmit().is_some() {} // what it says stands in the log
        }
    }

    /// The board's motors until a time.
    pub(super) fn run_board(&mut self, until: Duration) {
        while let Some(board) = &mut self.board {
            let Some(tick) = board.next_tick().filter(|tick| *tick < until) else { return };
            board.tick(tick);
            while board.transmit().is_some() {}
            let (step, pen) = (board.step(tick), board.pen());
            self.now = tick.max(self.now);
            if let Some(pen) = pen.filter(|_| !self.pen_recorded) {
                self.set_pen(pen);
            }
            let mut next = step;
            while let Some(step) = next {
                self.counted.x = self.counted.x.saturating_add(step.x.into());
                self.counted.y = self.counted.y.saturating_add(step.y.into());
                self.add_point();
                next = self.board.as_mut().and_then(|board| board.step(tick));
            }
        }
    }

    /// The log is over.
    pub(super) fn finish_board(&mut self) {
        self.run_board(self.now.saturating_add(FINISHES_WITHIN));
    }
}
