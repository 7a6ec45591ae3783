//! [`Axes`]: both axes of the table, each with its play: where commands lead, and which commands lead somewhere.

use super::play::Play;
use crate::stroke::{PxPoint, PxVec};

/// An axis that goes back by more has to cross its play, px.
const TURN_PX: f64 = 0.3;

/// Both axes, x first.
#[derive(Clone, Debug, Default)]
pub(super) struct Axes([Play; 2]);

impl Axes {
    /// Begins at a place.
    pub(super) fn forget(&mut self, at: PxPoint) {
        self.0[0].forget(at.x);
        self.0[1].forget(at.y);
    }

    /// Estimated play of each, px.
    pub(super) fn play_px(&self) -> [f64; 2] {
        [self.0[0].play_px(), self.0[1].play_px()]
    }

    /// Whether the play of one is not known well yet.
    pub(super) fn is_unknown(&self) -> bool {
        self.0.iter().any(Play::is_unknown)
    }

    /// The true place that belongs to a command, in the mean, and the standard deviations of what the play may hide of it, px.
    pub(super) fn place(&self, command: PxPoint) -> (PxPoint, [f64; 2]) {
        let [x, y] = &self.0;
        (PxPoint::new(x.place(command.x), y.place(command.y)), [x.doubt_px(command.x), y.doubt_px(command.y)])
    }

    /// Takes the true place that a picture shows, and which direction of it it shows well.
    pub(super) fn measure(&mut self, command: PxPoint, place: PxPoint, is_sure: [bool; 2]) {
        self.0[0].measure(command.x, place.x, is_sure[0]);
        self.0[1].measure(command.y, place.y, is_sure[1]);
    }

    /// All places of the map are found to be so much farther, x first, px.
    pub(super) fn shift(&mut self, PxVec { x, y }: PxVec) {
        self.0[0].shift(x);
        self.0[1].shift(y);
    }

    /// How much of the way to a place both may go in one move, as a share.
    pub(super) fn share(&self, to: PxPoint) -> f64 {
        self.0[0].share(to.x).min(self.0[1].share(to.y))
    }

    /// Whether an axis goes back on the way from one place to another.
    pub(super) fn turns(&self, from: PxPoint, to: PxPoint) -> bool {
        let PxVec { x: dx, y: dy } = to - from;
        [dx, dy].iter().zip(&self.0).any(|(way, play)| way * play.side() < -TURN_PX)
    }

    /// How far the command that leads to a place is beyond the machine's area, in either axis, px.
    pub(super) fn beyond_px(&self, to: PxPoint, area: Option<[PxPoint; 2]>) -> f64 {
        let x = self.0[0].beyond_px(to.x, area.map(|[from, to]| [from.x, to.x]));
        x.max(self.0[1].beyond_px(to.y, area.map(|[from, to]| [from.y, to.y])))
    }

    /// The command that takes the axes which turn round on the way to a place across their play, if any does.
    pub(super) fn crossing(&mut self, to: PxPoint, area: Option<[PxPoint; 2]>) -> Option<PxPoint> {
        let [x, y] = &mut self.0;
        let across = x.crossing(to.x, area.map(|[from, to]| [from.x, to.x]));
        let down = y.crossing(to.y, area.map(|[from, to]| [from.y, to.y]));
        let sent = PxPoint::new(x.sent_px(), y.sent_px());
        (across.is_some() || down.is_some()).then_some(sent)
    }

    /// The commands that lead through places, inside of the machine's area. An axis that turns round crosses its play before the
    /// other one moves, or the tool would leave the line on the side of the other.
    pub(super) fn commands(&mut self, path: &[PxPoint], area: Option<[PxPoint; 2]>) -> Vec<PxPoint> {
        let limits = [area.map(|[from, to]| [from.x, to.x]), area.map(|[from, to]| [from.y, to.y])];
        let [x, y] = &mut self.0;
        let mut commands = Vec::with_capacity(path.len());
        for to in path {
            let sent = PxPoint::new(x.sent_px(), y.sent_px());
            let (x, y) = (x.command(to.x, limits[0]), y.command(to.y, limits[1]));
            if x.crosses_to_px.is_some() || y.crosses_to_px.is_some() {
                let (across, down) = (x.crosses_to_px.unwrap_or(sent.x), y.crosses_to_px.unwrap_or(sent.y));
                commands.push(PxPoint::new(across, down));
            }
            commands.push(PxPoint::new(x.end_px, y.end_px));
        }
        commands
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::follow::{SimulatedTable, TableError, Tool};

    /// Axes with 3 px of play that have learned it, at the end of a move to the lower right, and their table.
    fn learned() -> (Axes, SimulatedTable) {
        let mut table =
            SimulatedTable::new(PxPoint::new(50.0, 50.0), TableError { play_px: 3.0, ..Default::default() });
        let mut axes = Axes::default();
        axes.forget(table.place());
        for i in 0..161_u8 {
            let way = 10.0 * (f64::from(i) * 0.2).sin();
            let to = PxPoint::new(50.0 + way, 50.0 + way);
            axes.commands(&[to], None).into_iter().for_each(|to| table.go(to, Tool::Up));
            axes.measure(table.commanded(), table.place(), [true; 2]);
        }
        (axes, table)
    }

    #[test]
    fn a_crossing_moves_the_command_and_not_the_tool() {
        let (mut axes, mut table) = learned();
        let from = table.place();
        let x = axes.0[0].side();
        assert_eq!(axes.crossing(PxPoint::new(from.x + 4.0 * x, from.y), None), None);
        let before = table.commanded();
        let command = axes.crossing(PxPoint::new(from.x - 4.0 * x, from.y), None).unwrap();
        assert!((command.x - before.x + 3.0 * x).abs() < 0.2 && command.y == before.y, "{command:?}");
        table.go(command, Tool::Down);
        assert!(table.place().distance(from) < 0.2);
        // Then there is nothing left to cross.
        axes.measure(command, table.place(), [true; 2]);
        assert_eq!(axes.crossing(PxPoint::new(from.x - 4.0 * x, from.y), None), None);
    }

    #[test]
    fn a_turn_of_one_axis_leaves_the_line_straight() {
        let (mut axes, mut table) = learned();
        assert!(!axes.is_unknown() && axes.play_px().iter().all(|play| (play - 3.0).abs() < 0.1));
        let from = table.place();
        let (x, y) = (axes.0[0].side(), axes.0[1].side());
        // x turns round, y goes on.
        let to = PxPoint::new(from.x - 4.0 * x, from.y + 4.0 * y);
        assert!(axes.turns(from, to) && !axes.turns(from, PxPoint::new(from.x + 4.0 * x, to.y)));
        let commands = axes.commands(&[to], None);
        assert_eq!(commands.len(), 2);
        commands.into_iter().for_each(|to| table.go(to, Tool::Down));
        assert!(table.place().distance(to) < 0.2, "{:?} for {to:?}", table.place());
        let off =
            table.strokes().iter().flatten().map(|at| ((at.x - from.x) * x + (at.y - from.y) * y).abs());
        // With a single command x would stand still for 3 of 7 px, in which y goes 1.7 px beside the line.
        assert!(off.fold(0.0, f64::max) < 0.3);
    }
}
