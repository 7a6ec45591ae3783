//! [`Play`]: what each axis of the table loses where it turns round, learned on the way.
//!
//! Each play that an axis may have goes with a [`Lag`], where in it the pushed piece may be. What a picture shows of the last move makes some
//! of them likelier than others (Bayes' rule), and a command leads where they do in the mean. So a turn that a picture showed badly
//! does no harm, and what is not known is as large as it is.

use super::lag::Lag;

/// Moves shorter than this are not made, px: the axis waits.
const NO_MOVE_PX: f64 = 0.12;

/// An axis stays so much behind where it is sent, px, and no more than so great a share of its play: what it is short of it makes
/// good without crossing its play, what it is beyond not.
const BEHIND_PX: f64 = 0.12;
const BEHIND_SHARE: f64 = 0.05;

/// A move whose standard deviation is greater is made in parts, px, each at least such a share of it.
const CAREFUL_PX: f64 = 0.45;
const LEAST_SHARE: f64 = 0.2;

/// Plays that are told apart: from one to the next, px, and as a share of itself.
const STEP_PX: f64 = 0.2;
const STEP_SHARE: f64 = 0.06;

/// Most play, px.
const MOST_PX: f64 = 30.0;

/// Before anything is known a play is the less likely the larger it is: its mean, px.
const USUAL_PX: f64 = 4.0;

/// What is less likely does not count.
const UNLIKELY: f64 = 1e-4;

/// How likely each play stays that all pictures speak against, as a share of how likely it was at first: it is not the same everywhere on a table.
const STAYS: f64 = 1e-6;

/// How likely it is that a picture shows something else than the table did: what speaks against a play counts no more.
const ODD: f64 = 0.02;

/// A play with a greater standard deviation is not known yet, px.
const UNKNOWN_PX: f64 = 0.4;

/// Standard deviation of the way between two pictures that this axis did not go by its play: of the places that they show, and of
/// the table's error, which grows with the square root of the way, px.
const SEEN_PX: f64 = 0.15;
const TABLE_PX: f64 = 0.1;

/// An axis is near a limit, px: nearer than it goes in one move along a line.
const NEAR_LIMIT_PX: f64 = 40.0;

/// A command to an axis, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Command {
    /// Where it begins to move, if it has to cross some of its play first.
    pub(super) crosses_to_px: Option<f64>,
    /// The whole way.
    pub(super) end_px: f64,
}

/// A play that the axis may have.
#[derive(Clone, Copy, Debug)]
struct Guess {
    half_px: f64,
    /// How likely it was before anything was known, and is now: the sum of all is 1.
    first: f64,
    likely: f64,
    /// Where in the play it may be.
    lag: Lag,
}

impl Guess {
    /// How far the path and then a command move the piece, with how likely it is.
    fn moves(&self, command: f64) -> impl Iterator<Item = (f64, f64)> {
        self.lag.moves(command, self.half_px).map(|(share, moved)| (self.likely * share, moved))
    }
}

/// Play of an axis, and where it is in it.
#[derive(Clone, Debug)]
pub(super) struct Play {
    guesses: Vec<Guess>,
    /// Where it was in the last picture, and the command then.
    place_px: f64,
    seen_at_px: f64,
    /// The last command, and all the way commanded.
    sent_px: f64,
    way_px: f64,
    /// The direction of the last command, 1 up, −1 down, 0 not yet known.
    side: f64,
    /// Whether it turned since the last picture.
    has_turned: bool,
    /// Whether the last picture showed it well, and all the way that was commanded till then.
    is_seen: bool,
    last_way_px: f64,
}

/// Plays that an axis may have, px, each with how likely it is before anything is known; their sum is 1.
fn plays() -> impl Iterator<Item = (f64, f64)> {
    let next = |play: &f64| Some(play + STEP_PX.max(STEP_SHARE * play)).filter(|next| *next <= MOST_PX);
    let all = move || {
        let plays = core::iter::successors(Some(0.0), next);
        plays.map(|play: f64| (play, STEP_PX.max(STEP_SHARE * play) * libm::exp(-play / USUAL_PX)))
    };
    let sum: f64 = all().map(|(_, likely)| likely).sum();
    all().map(move |(play, likely)| (play, likely / sum))
}

impl Default for Play {
    /// Of any play, at 0.
    fn default() -> Self {
        let guess =
            |(play, likely)| Guess { half_px: 0.5 * play, first: likely, likely, lag: Lag::default() };
        Self {
            guesses: plays().map(guess).collect(),
            place_px: 0.0,
            seen_at_px: 0.0,
            sent_px: 0.0,
            way_px: 0.0,
            side: 0.0,
            has_turned: false,
            is_seen: false,
            last_way_px: 0.0,
        }
    }
}

impl Play {
    fn likely(&self) -> impl Iterator<Item = &Guess> {
        self.guesses.iter().filter(|guess| guess.likely > UNLIKELY)
    }

    /// Mean and standard deviation of the play, px.
    fn known(&self) -> (f64, f64) {
        moments(self.likely().map(|guess| (guess.likely, 2.0 * guess.half_px)))
    }

    /// Estimated play, px.
    pub(super) fn play_px(&self) -> f64 {
        self.known().0
    }

    /// How far it is moved since the last picture if it is sent to `command`: mean and standard deviation, px.
    fn moved(&self, command: f64) -> (f64, f64) {
        let command = command - self.seen_at_px;
        moments(self.likely().flat_map(|guess| guess.moves(command)))
    }

    /// The true place that belongs to a command, in the mean.
    pub(super) fn place(&self, command: f64) -> f64 {
        self.place_px + self.moved(command).0
    }

    /// The command that leads to a place in the mean.
    fn command_to(&self, wanted: f64) -> f64 {
        let most = self.likely().map(|guess| 2.0 * guess.half_px).fold(0.0, f64::max) + 1.0;
        let way = self.seen_at_px + wanted - self.place_px;
        let (mut low, mut high) = (way - most, way + most);
        for _ in 0..32 {
            let middle = 0.5 * (low + high);
            if self.place(middle) < wanted { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// The command that leads to a place, or as far towards it as the machine's limits let the axis go.
    pub(super) fn command(&mut self, wanted: f64, limits: Option<[f64; 2]>) -> Command {
        let command = self.course(wanted, limits);
        self.send(command.end_px);
        command
    }

    /// The command that crosses the play and no more, if the axis has to cross some on the way to a place.
    pub(super) fn crossing(&mut self, wanted: f64, limits: Option<[f64; 2]>) -> Option<f64> {
        let crosses_to_px = self.course(wanted, limits).crosses_to_px?;
        self.send(crosses_to_px);
        Some(crosses_to_px)
    }

    fn course(&self, wanted: f64, limits: Option<[f64; 2]>) -> Command {
        let inside = |command: f64| limits.map_or(command, |[from, to]| command.max(from).min(to.max(from)));
        let way = wanted - self.place(self.sent_px);
        if self.waits(way) {
            return Command { crosses_to_px: None, end_px: inside(self.sent_px) };
        }
        let command = self.command_to(wanted);
        let lost = inside(command) - self.sent_px - way;
        let crosses = lost * way > 0.0 && lost.abs() > NO_MOVE_PX;
        Command {
            crosses_to_px: crosses.then_some(inside(self.sent_px + lost)),
            end_px: inside(command - libm::copysign(self.behind_px(), way)),
        }
    }

    /// How far beyond the machine's limits the command is that leads to a place, px.
    pub(super) fn beyond_px(&self, wanted: f64, limits: Option<[f64; 2]>) -> f64 {
        let Some([from, to]) = limits else { return 0.0 };
        // Nowhere else it matters.
        if self.sent_px > from + NEAR_LIMIT_PX && self.sent_px < to - NEAR_LIMIT_PX {
            return 0.0;
        }
        let command = self.command_to(wanted);
        (from - command).max(command - to).max(0.0)
    }

    fn send(&mut self, command: f64) {
        let moved = command - self.sent_px;
        if moved != 0.0 {
            let side = libm::copysign(1.0, moved);
            if side != self.side {
                (self.side, self.has_turned) = (side, true);
            }
            self.way_px += moved.abs();
        }
        self.sent_px = command;
        for guess in &mut self.guesses {
            guess.lag.go(command - self.seen_at_px, guess.half_px);
        }
    }

    /// Whether it is not worth while to go so far.
    fn waits(&self, way: f64) -> bool {
        way.abs() < if way * self.side < 0.0 { NO_MOVE_PX } else { NO_MOVE_PX + self.behind_px() }
    }

    /// How much it stays behind where it is sent, px.
    fn behind_px(&self) -> f64 {
        BEHIND_PX.min(BEHIND_SHARE * self.play_px())
    }

    /// How much of the way to `wanted` the axis may go in one move, as a share: where it is not known well how far a command moves it, less, with
    /// a look after it.
    pub(super) fn share(&self, wanted: f64) -> f64 {
        if self.waits(wanted - self.place(self.sent_px)) {
            return 1.0;
        }
        let (_, sd) = self.moved(self.command_to(wanted));
        if sd > 0.0 { (CAREFUL_PX / sd).clamp(LEAST_SHARE, 1.0) } else { 1.0 }
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
    pub(super) fn is_unknown(&self) -> bool {
        self.known().1 > UNKNOWN_PX
    }

    /// Standard deviation of what the play may hide in the next picture, px, after the axis was sent to `command`.
    pub(super) fn doubt_px(&self, command: f64) -> f64 {
        self.moved(command).1.max(if self.has_turned { 0.3 } else { 0.0 })
    }

    /// Takes the true place that a picture shows, if it shows it well.
    pub(super) fn measure(&mut self, command: f64, place: f64, is_sure: bool) {
        let way_px = self.way_px - core::mem::replace(&mut self.last_way_px, self.way_px);
        let sd = libm::hypot(SEEN_PX, TABLE_PX * libm::sqrt(way_px.max(0.0)));
        let moved = (is_sure && self.is_seen).then_some((place - self.place_px, sd));
        let mut sum = 0.0;
        for guess in &mut self.guesses {
            let fit = guess.lag.see(moved, command - self.seen_at_px, guess.half_px);
            guess.likely = guess.likely * (fit + ODD) + STAYS * guess.first;
            sum += guess.likely;
        }
        if sum > 0.0 {
            self.guesses.iter_mut().for_each(|guess| guess.likely /= sum);
        }
        (self.place_px, self.seen_at_px, self.sent_px) = (place, command, command);
        (self.has_turned, self.is_seen) = (false, is_sure);
    }

    /// All places of the map are found to be `by` px farther: the axis did not move.
    pub(super) fn shift(&mut self, by: f64) {
        self.place_px += by;
    }

    /// Begins at a place.
    pub(super) fn forget(&mut self, place: f64) {
        *self = Self { place_px: place, seen_at_px: place, sent_px: place, ..Self::default() };
    }
}

/// Mean and standard deviation of values with how likely they are.
fn moments(values: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let (mut sum, mut mean, mut square) = (0.0, 0.0, 0.0);
    for (likely, value) in values {
        sum += likely;
        mean += likely * value;
        square += likely * value * value;
    }
    if sum <= 0.0 {
        return (0.0, 0.0);
    }
    let mean = mean / sum;
    (mean, libm::sqrt((square / sum - mean * mean).max(0.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis of 3 px of play that was pushed upwards to a command of 0.
    fn pushed_up() -> Play {
        let guesses = vec![Guess { half_px: 1.5, first: 1.0, likely: 1.0, lag: Lag::behind(1.0) }];
        Play { guesses, place_px: -1.5, side: 1.0, ..Play::default() }
    }

    #[test]
    fn at_a_limit_an_axis_knows_what_was_sent() {
        let mut play = pushed_up();
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
    fn a_place_behind_a_limit_is_known() {
        let play = pushed_up();
        // The command for 9.5 is 11.
        let beyond = [Some([0.0, 10.0]), Some([0.0, 11.5]), None].map(|limits| play.beyond_px(9.5, limits));
        assert!((beyond[0] - 1.0).abs() < 1e-6 && beyond[1] == 0.0 && beyond[2] == 0.0, "{beyond:?}");
    }

    #[test]
    fn a_place_that_is_corrected_is_no_move() {
        let mut play = pushed_up();
        let turned = |mut play: Play| {
            let from = play.place_px;
            let command = play.command(from - 2.0, None);
            (command.crosses_to_px, command.end_px)
        };
        let before = turned(play.clone());
        play.shift(4.0);
        play.measure(0.0, 2.5, true);
        let crosses = [turned(play.clone()), before].map(|(crosses, _)| crosses.unwrap_or(0.0));
        assert!((crosses[0] - crosses[1]).abs() < 0.05 && crosses[1] < -2.9, "{crosses:?}");
        assert!((turned(play.clone()).1 + 5.0 - BEHIND_PX).abs() < 0.05, "{:?}", turned(play.clone()));
    }

    /// An axis that loses 3 px at each turn, seen exactly after each move.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
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
        assert!((play.play_px() - 3.0).abs() < 0.5, "{play:?}");
        let worst = (400..800).map(|i| go(&mut play, wave(i))).fold(0.0, f64::max);
        assert!(worst < 0.5, "{worst}");
    }

    #[test]
    fn an_axis_turns_for_what_is_worth_its_play() {
        let to = |by: f64| pushed_up().command(by - 1.5, None).end_px;
        // It stays 0.12 px behind: nearer than that to 0.12 px before its end it waits, and beyond it by as much it turns round.
        assert!((to(0.3) - 0.18).abs() < 1e-6 && to(0.2) == 0.0, "{} {}", to(0.3), to(0.2));
        assert!(to(-0.1) == 0.0 && (to(-0.3) + 3.18).abs() < 1e-6, "{} {}", to(-0.1), to(-0.3));
    }

    #[test]
    fn what_is_not_known_is_gone_in_parts() {
        // Pushed upwards it goes on by what is commanded, whatever its play.
        assert_eq!(pushed_up().share(5.0), 1.0);
        // Anywhere in 3 px of play: standard deviation 3 / sqrt(12) = 0.87 px.
        let anywhere = Guess { half_px: 1.5, first: 1.0, likely: 1.0, lag: Lag::default() };
        let play = Play { guesses: vec![anywhere], ..Play::default() };
        assert!((play.share(9.0) - CAREFUL_PX / 0.87).abs() < 0.02, "{}", play.share(9.0));
    }

    #[test]
    fn moves_that_pictures_showed_badly_do_no_harm() {
        // To and fro by 0.3 px within 3 px of play, and each picture shows it moved by that, as noise may have it.
        let mut play = Play::default();
        let mut command = 0.0;
        for i in 0..6_u8 {
            command += if i % 2 == 0 { 0.3 } else { -0.3 };
            play.measure(command, command, true);
        }
        let mut pushed = command;
        for i in 0..60_u8 {
            command = 12.0 * (f64::from(i) * 0.2).sin();
            pushed = f64::max(pushed, command - 1.5).min(command + 1.5);
            play.measure(command, pushed, true);
        }
        assert!((play.play_px() - 3.0).abs() < 0.2, "{}", play.play_px());
    }

    #[test]
    fn one_picture_is_not_believed() {
        // Of 8.1 px 5.2 were lost: a play of 5.2 px, or a place that was found wrongly.
        let mut play = Play::default();
        play.measure(0.0, 0.0, true);
        play.measure(8.1, 2.9, true);
        assert!(play.is_unknown(), "{:?}", play.known());
    }
}
