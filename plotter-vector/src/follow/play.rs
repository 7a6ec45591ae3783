//! [`Play`]: what each axis of the table loses where it turns round, learned on the way.
//!
//! ```text
//!   pushed   stays where it is while the command is within half of the play, and is pushed along beyond
//!   place  = pushed + offset
//!   command  that pushes it to a place = place − offset ± half of the play        + upwards, − downwards
//! ```
//!
//! An axis that moved in the pictures is pushed in this direction at the end of the move, so that its place less its command is
//! the offset less (upwards) or more (downwards) half of the play: once seen in both directions, the play is known.

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

/// An axis that was seen pushed.
#[derive(Clone, Copy, Debug)]
struct Pushed {
    /// Place less command, px.
    off_px: f64,
    /// All the way that was commanded till then, px.
    way_px: f64,
}

/// Play and offset of an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Play {
    /// Estimated play, px.
    pub(super) play_px: f64,
    /// True place less that of what is pushed.
    offset_px: f64,
    pushed_px: f64,
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
    /// How often the play was learned, and what the last turns showed.
    learned: u32,
    shown_px: [f64; 9],
    /// Command and true place when last looked.
    last: Option<(f64, f64)>,
}

impl Play {
    /// What is pushed at a command.
    fn pushed(&self, command: f64) -> f64 {
        let half = 0.5 * self.play_px;
        self.pushed_px.clamp(command - half, command + half)
    }

    /// The true place that belongs to a command.
    pub(super) fn place(&self, command: f64) -> f64 {
        self.pushed(command) + self.offset_px
    }

    /// The command that leads to a place.
    pub(super) fn command(&mut self, wanted: f64) -> f64 {
        let target = wanted - self.offset_px;
        let way = target - self.pushed_px;
        if way.abs() < NO_MOVE_PX {
            return self.sent_px;
        }
        let command = target + libm::copysign(0.5 * self.play_px, way);
        let moved = command - self.sent_px;
        if moved != 0.0 {
            let side = libm::copysign(1.0, moved);
            if side != self.side {
                (self.side, self.since_turn_px, self.is_learned) = (side, 0.0, false);
                self.has_turned = true;
            }
            self.since_turn_px += moved.abs();
            self.way_px += moved.abs();
        }
        (self.sent_px, self.pushed_px) = (command, target);
        command
    }

    /// How far the axis may go on to `wanted` in one move, as a share: a turn whose play is not known well is gone in
    /// small moves, with a look after each.
    pub(super) fn share(&self, from: f64, wanted: f64) -> f64 {
        let way = wanted - from;
        let turns = way * self.side <= 0.0 || (!self.is_learned && self.since_turn_px < TURNING_PX);
        if turns && self.is_unknown() && way.abs() > 0.4 { 0.4 / way.abs() } else { 1.0 }
    }

    /// Whether the play is not known well yet.
    pub(super) const fn is_unknown(&self) -> bool {
        self.learned < 2
    }

    /// Standard deviation of what the play may hide in the next picture, px, after the axis was sent to `command`.
    pub(super) fn doubt_px(&self, command: f64) -> f64 {
        if !self.is_unknown() {
            return if self.has_turned { 0.3 } else { 0.0 };
        }
        self.last.map_or(0.0, |(last, _)| 0.5 * (command - last).abs().min(TURNING_PX))
    }

    /// Takes the true place that a picture shows, if it shows it well.
    pub(super) fn measure(&mut self, command: f64, place: f64, is_sure: bool) {
        self.pushed_px = self.pushed(command);
        self.sent_px = command;
        self.offset_px = place - self.pushed_px;
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
            self.learn((other.off_px - seen.off_px) * self.side);
        }
        self.pushed_px = command - 0.5 * self.play_px * self.side;
        self.offset_px = place - self.pushed_px;
    }

    /// The mean of the middle half of what the last turns showed: a single one may be far off.
    fn learn(&mut self, play_px: f64) {
        let slot = usize::try_from(self.learned).unwrap_or(0) % self.shown_px.len();
        if let Some(shown) = self.shown_px.get_mut(slot) {
            *shown = play_px.clamp(0.0, MOST_PX);
        }
        self.learned = self.learned.saturating_add(1);
        let known = usize::try_from(self.learned).unwrap_or(usize::MAX).min(self.shown_px.len());
        let mut sorted = self.shown_px;
        if let Some(known) = sorted.get_mut(..known) {
            known.sort_by(f64::total_cmp);
            let middle = known.get(known.len() / 4..known.len() - known.len() / 4).unwrap_or(&[]);
            self.play_px =
                middle.iter().sum::<f64>() / f64::from(u32::try_from(middle.len().max(1)).unwrap_or(1));
        }
    }

    /// Begins at a place.
    pub(super) fn forget(&mut self, place: f64) {
        (self.pushed_px, self.sent_px, self.offset_px) = (place, place, 0.0);
        (self.last, self.seen) = (None, [None; 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis that loses 3 px at each turn, seen exactly after each move.
    #[test]
    fn the_play_is_known_after_two_turns() {
        let (mut play, mut command, mut pushed) = (Play::default(), 0.0_f64, 0.0_f64);
        let mut go = |play: &mut Play, wanted: f64| -> f64 {
            command = play.command(wanted);
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
