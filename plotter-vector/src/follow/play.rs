//! [`Play`]: what each axis of the table loses where it turns round, learned on the way.
//!
//! An axis that moved in the pictures is pushed in this direction at the end of the move, so that its place less its command is
//! an offset less (upwards) or more (downwards) half of the play: once seen in both directions, the play is known. From then on
//! [`Lag`] tells where in the play it may be after moves that did not cross it.

use super::lag::Lag;

/// Moves shorter than this are not made, px: the axis waits.
const NO_MOVE_PX: f64 = 0.12;

/// An axis that moved so far in the pictures is pushed, px.
const PUSHED_PX: f64 = 0.3;

/// After so much way in one direction it is pushed, or the lines here do not show it, px.
const TURNING_PX: f64 = 5.0;

/// A way beyond which an old turn tells nothing about the play, px: the random error grows with it.
const MEMORY_PX: f64 = 60.0;

/// Most play, px.
const MOST_PX: f64 = 30.0;

/// Standard deviation of the way between two pictures that this axis did not go by its play: of the places that they show, and of
/// the table's error, which grows with the square root of the way, px.
const SEEN_PX: f64 = 0.15;
const TABLE_PX: f64 = 0.1;

/// How much the play may change from turn to turn, px: it is not the same everywhere on a table.
const CHANGE_PX: f64 = 0.03;

/// An axis that was seen pushed.
#[derive(Clone, Copy, Debug)]
struct Pushed {
    /// Place less command, px.
    off_px: f64,
    /// All the way that was commanded till then, px.
    way_px: f64,
}

/// A command to an axis, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Command {
    /// Where it begins to move, if it has to cross some of its play first.
    pub(super) crosses_to_px: Option<f64>,
    /// The whole way.
    pub(super) end_px: f64,
}

/// Play of an axis, and where it is in it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Play {
    /// Estimated play, px.
    pub(super) play_px: f64,
    /// Where it was in the last picture, and the command then.
    place_px: f64,
    seen_at_px: f64,
    /// Where in the play it may be.
    lag: Lag,
    /// The last command, and all the way commanded.
    sent_px: f64,
    way_px: f64,
    /// The direction of the last command, 1 up, −1 down, 0 not yet known, and the way since it turned.
    side: f64,
    since_turn_px: f64,
    /// Whether it turned since the last picture.
    has_turned: bool,
    /// When it was seen pushed last, downwards and upwards.
    seen: [Option<Pushed>; 2],
    /// Whether the play of this turn is learned.
    is_learned: bool,
    /// How often the play was learned, and the variance of what is known of it, px².
    learned: u32,
    variance: f64,
    /// Command and true place of the last picture, if it showed it well.
    last: Option<(f64, f64)>,
    /// All the way that was commanded till then.
    last_way_px: f64,
}

impl Play {
    fn half_px(&self) -> f64 {
        0.5 * self.play_px
    }

    /// The lag after a command.
    fn lag_at(&self, command: f64) -> Lag {
        let mut lag = self.lag;
        lag.go(command - self.seen_at_px, self.half_px());
        lag
    }

    /// The true place that belongs to a command, in the mean.
    pub(super) fn place(&self, command: f64) -> f64 {
        self.place_px + self.lag_at(command).moved(self.half_px()).0
    }

    /// The command that leads to a place, or as far towards it as the machine's limits let the axis go.
    pub(super) fn command(&mut self, wanted: f64, limits: Option<[f64; 2]>) -> Command {
        let half_px = self.half_px();
        let inside = |command: f64| limits.map_or(command, |[from, to]| command.max(from).min(to.max(from)));
        let way = wanted - self.place_px - self.lag.moved(half_px).0;
        if way.abs() < NO_MOVE_PX {
            return Command { crosses_to_px: None, end_px: inside(self.sent_px) };
        }
        let command = inside(self.seen_at_px + self.lag.command(wanted - self.place_px, half_px));
        let moved = command - self.sent_px;
        let lost = moved - way;
        let crosses = lost * way > 0.0 && lost.abs() > NO_MOVE_PX;
        let crosses_to_px = crosses.then_some(inside(self.sent_px + lost));
        if moved != 0.0 {
            let side = libm::copysign(1.0, moved);
            if side != self.side {
                (self.side, self.since_turn_px, self.is_learned) = (side, 0.0, false);
                self.has_turned = true;
            }
            self.since_turn_px += moved.abs();
            self.way_px += moved.abs();
        }
        self.sent_px = command;
        self.lag.go(command - self.seen_at_px, half_px);
        Command { crosses_to_px, end_px: command }
    }

    /// How far the axis may go on to `wanted` in one move, as a share: a turn whose play is not known well is gone in
    /// small moves, with a look after each.
    pub(super) fn share(&self, from: f64, wanted: f64) -> f64 {
        let way = wanted - from;
        let turns = way * self.side <= 0.0 || (!self.is_learned && self.since_turn_px < TURNING_PX);
        if turns && self.is_unknown() && way.abs() > 0.4 { 0.4 / way.abs() } else { 1.0 }
    }

    /// The last command.
    pub(super) const fn sent_px(&self) -> f64 {
        self.sent_px
    }

    /// The direction of its last command, 1 or −1; 0 before the first.
    pub(super) const fn side(&self) -> f64 {
        self.side
    }

    /// Whether the play is not known well yet.
    pub(super) const fn is_unknown(&self) -> bool {
        self.learned < 2
    }

    /// Standard deviation of what the play may hide in the next picture, px, after the axis was sent to `command`.
    pub(super) fn doubt_px(&self, command: f64) -> f64 {
        if !self.is_unknown() {
            let (_, sd) = self.lag_at(command).moved(self.half_px());
            return sd.max(if self.has_turned { 0.3 } else { 0.0 });
        }
        self.last.map_or(0.0, |(last, _)| 0.5 * (command - last).abs().min(TURNING_PX))
    }

    /// Takes the true place that a picture shows, if it shows it well.
    pub(super) fn measure(&mut self, command: f64, place: f64, is_sure: bool) {
        let way_px = self.way_px - core::mem::replace(&mut self.last_way_px, self.way_px);
        let sd = libm::hypot(SEEN_PX, TABLE_PX * libm::sqrt(way_px.max(0.0)));
        let moved = (is_sure && self.last.is_some()).then_some((place - self.place_px, sd));
        self.lag.see(moved, command - self.seen_at_px, self.half_px());
        (self.place_px, self.seen_at_px, self.sent_px) = (place, command, command);
        let has_turned = core::mem::take(&mut self.has_turned);
        if !is_sure {
            self.last = None;
            return;
        }
        let Some((last_command, last_place)) = self.last.replace((command, place)) else { return };
        let (commanded, moved) = ((command - last_command) * self.side, (place - last_place) * self.side);
        // A move that went to and fro tells nothing; nor does one that ended before it began to push.
        let to_and_fro = has_turned && self.since_turn_px > commanded + NO_MOVE_PX;
        if commanded <= 0.0 || moved < PUSHED_PX || moved > commanded + 1.0 || to_and_fro {
            return;
        }
        let seen = Pushed { off_px: place - command, way_px: self.way_px };
        let [down, up] = &mut self.seen;
        let (own, other) = if self.side > 0.0 { (up, down) } else { (down, up) };
        *own = Some(seen);
        let other = other.filter(|other| seen.way_px - other.way_px < MEMORY_PX);
        if let (Some(other), false) = (other, self.is_learned) {
            self.is_learned = true;
            self.learn((other.off_px - seen.off_px) * self.side, seen.way_px - other.way_px);
            self.lag = Lag::behind(self.side);
        }
    }

    /// Weighs what a turn showed of the play, after `way_px` of commands, by how well it shows it.
    fn learn(&mut self, shown_px: f64, way_px: f64) {
        let shown_px = shown_px.clamp(0.0, MOST_PX);
        let noise = 2.0 * SEEN_PX * SEEN_PX + TABLE_PX * TABLE_PX * way_px.max(0.0);
        self.learned = self.learned.saturating_add(1);
        if self.learned == 1 {
            (self.play_px, self.variance) = (shown_px, noise);
            return;
        }
        let (known, off) = (self.variance + CHANGE_PX * CHANGE_PX, shown_px - self.play_px);
        // What is too far off to be its noise was perhaps no turn of this play: it counts less the farther it is.
        let surprise = off * off / (9.0 * (known + noise));
        let gain = known / (known + noise * surprise.max(1.0));
        self.play_px += gain * off;
        self.variance = known * (1.0 - gain);
    }

    /// All places of the map are found to be `by` px farther: the axis did not move.
    pub(super) fn shift(&mut self, by: f64) {
        self.place_px += by;
        if let Some((_, place)) = &mut self.last {
            *place += by;
        }
        self.seen.iter_mut().flatten().for_each(|pushed| pushed.off_px += by);
    }

    /// Begins at a place.
    pub(super) fn forget(&mut self, place: f64) {
        (self.place_px, self.seen_at_px, self.sent_px) = (place, place, place);
        (self.last, self.seen, self.lag) = (None, [None; 2], Lag::default());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_a_limit_an_axis_knows_what_was_sent() {
        let lag = Lag::behind(1.0);
        let mut play = Play { play_px: 3.0, place_px: -1.5, side: 1.0, lag, learned: 2, ..Play::default() };
        // Upwards it hangs 1.5 px behind: the command for 9.5 would be 11.
        let limits = Some([0.0, 10.0]);
        let command = play.command(9.5, limits).end_px;
        assert_eq!(command, 10.0);
        assert!((play.place(command) - 8.5).abs() < 1e-9, "{}", play.place(command));
        // And it goes no farther, nor back.
        assert_eq!(play.command(9.5, limits).end_px, 10.0);
        assert!((play.place(10.0) - 8.5).abs() < 1e-9);
    }

    #[test]
    fn a_place_that_is_corrected_is_no_move() {
        let lag = Lag::behind(1.0);
        let mut play = Play { play_px: 3.0, place_px: -1.5, side: 1.0, lag, learned: 2, ..Play::default() };
        let turned = |mut play: Play| {
            let from = play.place_px;
            let command = play.command(from - 2.0, None);
            (command.crosses_to_px, command.end_px)
        };
        let before = turned(play);
        play.shift(4.0);
        play.measure(0.0, 2.5, true);
        let crosses = [turned(play), before].map(|(crosses, _)| crosses.unwrap_or(0.0));
        assert!((crosses[0] - crosses[1]).abs() < 0.05 && crosses[1] < -2.9, "{crosses:?}");
        assert!((turned(play).1 + 5.0).abs() < 0.05, "{:?}", turned(play));
    }

    /// An axis that loses 3 px at each turn, seen exactly after each move.
    #[test]
    fn the_play_is_known_after_two_turns() {
        let (mut play, mut command, mut pushed) = (Play::default(), 0.0_f64, 0.0_f64);
        let mut go = |play: &mut Play, wanted: f64| -> f64 {
            command = play.command(wanted, None).end_px;
            pushed = pushed.clamp(command - 1.5, command + 1.5);
            play.measure(command, pushed, true);
            (pushed - wanted).abs()
        };
        let wave = |i: i32| 20.0 * (f64::from(i) * 0.05).sin();
        let first = (0..400).map(|i| go(&mut play, wave(i))).fold(0.0, f64::max);
        assert!(first < 3.1, "never farther off than the play: {first}");
        assert!((play.play_px - 3.0).abs() < 0.5, "{play:?}");
        let worst = (400..800).map(|i| go(&mut play, wave(i))).fold(0.0, f64::max);
        assert!(worst < 0.5, "{worst}");
    }
}
