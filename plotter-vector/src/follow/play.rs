//! [`Play`]: what each axis of the table loses where it turns round, learned on the way.
//!
//! ```text
//!   command = wanted place − offset ± half of the play        + while the axis goes up, − while it goes down
//! ```
//!
//! When an axis turns round, the play is taken up at once. How large it is shows in the pictures: what is missing after a turn
//! is added to the estimate once the axis answers again.

/// A way back shorter than this is no turn, px: the axis waits.
const NO_TURN_PX: f64 = 0.3;

/// Farther from the turn the play is taken up, or the lines here do not show it, px.
const TURNING_PX: f64 = 5.0;

/// An axis that moved so far answers, px.
const ANSWERS_PX: f64 = 3.0;

/// Most play, px.
const MOST_PX: f64 = 30.0;

/// Play and offset of an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Play {
    /// Estimated play, px.
    pub(super) play_px: f64,
    /// True place minus command, in the middle of the play, px.
    offset_px: f64,
    /// The way that it went last: 1 up, −1 down, 0 not yet known.
    side: f64,
    /// The farthest place wanted since it turned.
    extreme_px: f64,
    /// Where it turned.
    turned_px: f64,
    /// How often the play was learned.
    learned: u32,
    /// The play that the last turns showed.
    shown_px: [f64; 9],
    /// The offset before it turned, until the play is taken up.
    before: Option<f64>,
    /// Command and true place when last looked.
    last: Option<(f64, f64)>,
}

impl Play {
    /// The true place that belongs to a command.
    pub(super) fn place(&self, command: f64) -> f64 {
        command + self.offset_px - 0.5 * self.play_px * self.side
    }

    /// The command that leads to a place.
    pub(super) fn command(&mut self, wanted: f64) -> f64 {
        let ahead = (wanted - self.extreme_px) * self.side;
        if self.side == 0.0 {
            if (wanted - self.extreme_px).abs() > NO_TURN_PX {
                self.side = libm::copysign(1.0, wanted - self.extreme_px);
                self.extreme_px = wanted;
            }
        } else if ahead > 0.0 {
            self.extreme_px = wanted;
        } else if -ahead > NO_TURN_PX {
            self.before = Some(self.offset_px);
            self.side = -self.side;
            self.turned_px = self.extreme_px;
            self.extreme_px = wanted;
        }
        wanted - self.offset_px + 0.5 * self.play_px * self.side
    }

    /// How far the axis may go on to `wanted` in one move, as a share: a turn whose play is not known well is gone in
    /// small moves, with a look after each.
    pub(super) fn share(&self, from: f64, wanted: f64) -> f64 {
        let way = wanted - from;
        let is_turning = self.before.is_some() && (self.extreme_px - self.turned_px).abs() < TURNING_PX;
        let turns = self.side == 0.0 || way * self.side < 0.0 || is_turning;
        if turns && self.is_unknown() && way.abs() > 0.4 { 0.4 / way.abs() } else { 1.0 }
    }

    /// Whether the play is not known well yet.
    pub(super) const fn is_unknown(&self) -> bool {
        self.learned < 2
    }

    /// Takes the true place that a picture shows, if it shows it well.
    pub(super) fn measure(&mut self, command: f64, place: f64, is_sure: bool) {
        self.offset_px = place - command + 0.5 * self.play_px * self.side;
        let last = self.last.replace((command, place));
        if !is_sure {
            return;
        }
        let (Some(before), Some((last_command, last_place))) = (self.before, last) else { return };
        let (commanded, moved) = (command - last_command, place - last_place);
        if commanded * self.side < 0.3 || (moved / commanded < 0.6 && moved * self.side < ANSWERS_PX) {
            return;
        }
        // It answers: what was missing on the way is play that was not known.
        let missing = (before - self.offset_px) * self.side;
        // The middle of what the last turns showed: a single one may be far off.
        let slot = usize::try_from(self.learned).unwrap_or(0) % self.shown_px.len();
        if let Some(shown) = self.shown_px.get_mut(slot) {
            *shown = (self.play_px + missing).clamp(0.0, MOST_PX);
        }
        self.learned = self.learned.saturating_add(1);
        let known = usize::try_from(self.learned).unwrap_or(usize::MAX).min(self.shown_px.len());
        let mut sorted = self.shown_px;
        if let Some(known) = sorted.get_mut(..known) {
            known.sort_by(f64::total_cmp);
            self.play_px = known.get((known.len() - 1) / 2).copied().unwrap_or(0.0);
        }
        self.before = None;
        self.offset_px = place - command + 0.5 * self.play_px * self.side;
    }

    /// Forgets the way: the machine stands somewhere else.
    pub(super) fn forget(&mut self, place: f64) {
        self.extreme_px = place;
        self.before = None;
        self.last = None;
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
