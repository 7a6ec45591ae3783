//! [`SimulatedTable`]: moves as an inexact table makes them.

use super::Tool;
use super::random::Random;
use crate::stroke::{PxPoint, PxVec};

/// The way over which the random error of a table is given, px: from the middle of a window of 300 px to its border, what the
/// published follower moves between two pictures.
pub const ERROR_WAY_PX: f64 = 150.0;

/// What is wrong with a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TableError {
    /// Standard deviation, in each axis, of what a way of [`ERROR_WAY_PX`] adds to the error, px. Errors of equal pieces of the
    /// way are independent, so that it grows with the square root of the way.
    pub random_px: f64,
    /// Play: what each axis loses where it turns round, px.
    pub play_px: f64,
    /// Of the random error.
    pub seed: u64,
}

/// A table that moves the camera, and the tool with it, over the paper.
///
/// ```
/// # use plotter_vector::{PxPoint, follow::{SimulatedTable, TableError, Tool}};
/// let mut table = SimulatedTable::new(PxPoint::new(0.0, 0.0), TableError { play_px: 3.0, ..Default::default() });
/// table.go(PxPoint::new(10.0, 0.0), Tool::Up);
/// table.go(PxPoint::new(5.0, 0.0), Tool::Up);
/// // Half of the play either way: 10 came out as 8.5, and turning round costs 3 px.
/// assert_eq!(table.place(), PxPoint::new(6.5, 0.0));
/// ```
#[derive(Clone, Debug)]
pub struct SimulatedTable {
    error: TableError,
    commanded: PxPoint,
    /// Where the carriage would be without random errors.
    pushed: PxPoint,
    drift: PxPoint,
    random: Random,
    strokes: Vec<Vec<PxPoint>>,
    tool: Tool,
}

impl SimulatedTable {
    /// A table that stands at a place, with the tool lifted.
    #[must_use]
    pub fn new(at: PxPoint, error: TableError) -> Self {
        Self {
            error,
            commanded: at,
            pushed: at,
            drift: PxPoint::default(),
            random: Random::new(error.seed ^ 0x7ab1e),
            strokes: Vec::new(),
            tool: Tool::Up,
        }
    }

    /// Moves straight to a place, as far as the table knows; the tool is lifted or lowered before.
    pub fn go(&mut self, to: PxPoint, tool: Tool) {
        if tool == Tool::Down && self.tool == Tool::Up {
            self.strokes.push(vec![self.place()]);
        }
        self.tool = tool;
        let from = self.commanded;
        let way = from.distance(to);
        // Pieces of at most a pixel.
        let pieces = super::whole::count(libm::ceil(way)).max(1);
        let sd = self.error.random_px
            * libm::sqrt(way / f64::from(u32::try_from(pieces).unwrap_or(1)) / ERROR_WAY_PX);
        let half = 0.5 * self.error.play_px;
        for piece in 1..=pieces {
            #[expect(clippy::cast_precision_loss, reason = "a few pixels")]
            let part = piece as f64 / pieces as f64;
            let PxVec { x: dx, y: dy } = to - from;
            let command = from + PxVec::new(dx, dy) * part;
            self.pushed.x = self.pushed.x.clamp(command.x - half, command.x + half);
            self.pushed.y = self.pushed.y.clamp(command.y - half, command.y + half);
            if sd > 0.0 {
                self.drift.x += sd * self.random.normal();
                self.drift.y += sd * self.random.normal();
            }
            if tool == Tool::Down {
                let place = self.place();
                if let Some(stroke) = self.strokes.last_mut() {
                    stroke.push(place);
                }
            }
        }
        self.commanded = to;
    }

    /// Where the camera and the tool really are.
    #[must_use]
    pub fn place(&self) -> PxPoint {
        PxPoint::new(self.pushed.x + self.drift.x, self.pushed.y + self.drift.y)
    }

    /// Where the table believes them to be.
    #[must_use]
    pub const fn commanded(&self) -> PxPoint {
        self.commanded
    }

    /// The lines that the lowered tool has really drawn so far, a point at least each pixel.
    #[must_use]
    pub fn strokes(&self) -> &[Vec<PxPoint>] {
        &self.strokes
    }
}
