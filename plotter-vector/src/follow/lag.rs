//! [`Lag`]: where in the play of its axis the piece that is pushed may be.
//!
//! ```text
//!   pushed   stays where it is while the command is within half of the play, and is pushed along beyond
//!   pushed'  = min(max(pushed, command − half), command + half)
//! ```
//!
//! Some moves after each other do what a single one of this form does, so that two bounds are all that is kept of a path. What a
//! picture then shows of the way makes some of the places where it may have been likelier than others (Bayes' rule on a row of them).

/// Places in the play that are told apart.
const PLACES: usize = 61;

/// How likely each is before anything is known.
#[expect(clippy::cast_precision_loss, reason = "a small number")]
const EVEN: f64 = 1.0 / PLACES as f64;

/// How likely it is that it is anywhere at all, whatever the pictures till now have said: the play is not known exactly.
const ANYWHERE: f64 = 1e-2;

/// How likely a picture that speaks against all places is, beside one that fits.
const UNFIT: f64 = 1e-4;

/// How likely the places in the play are, and where a path since the last picture has pushed them.
///
/// Places are relative to the command at the last picture, px; `half_px` is half of the play.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lag {
    /// From half of the play below the command to half of it above; their sum is 1.
    likely: [f64; PLACES],
    /// What the path since then does: it brings what is below the first up to it, and what is above the second down to it.
    pushes: [f64; 2],
}

impl Default for Lag {
    /// Anywhere.
    fn default() -> Self {
        Self { likely: [EVEN; PLACES], pushes: [f64::NEG_INFINITY, f64::INFINITY] }
    }
}

/// What of a place a command leaves.
fn pushed(at: f64, command: f64, half_px: f64) -> f64 {
    at.max(command - half_px).min(command + half_px)
}

impl Lag {
    /// Pushed upwards (1) or downwards (−1): it hangs behind by half of the play.
    #[cfg(test)]
    pub(super) fn behind(side: f64) -> Self {
        let mut likely = [0.0; PLACES];
        let end = if side > 0.0 { likely.first_mut() } else { likely.last_mut() };
        if let Some(end) = end {
            *end = 1.0;
        }
        Self { likely, ..Self::default() }
    }

    /// The places with how likely they are.
    fn places(&self, half_px: f64) -> impl Iterator<Item = (f64, f64)> {
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        let at = move |i: usize| half_px * (2.0 * i as f64 / (PLACES - 1) as f64 - 1.0);
        self.likely.iter().enumerate().map(move |(i, likely)| (at(i), *likely))
    }

    fn after(&self, at: f64) -> f64 {
        at.max(self.pushes[0]).min(self.pushes[1])
    }

    /// Takes a command of the path.
    pub(super) fn go(&mut self, command: f64, half_px: f64) {
        self.pushes = self.pushes.map(|at| pushed(at, command, half_px));
    }

    /// The places with how likely they are, and how far the path and then a command move each of them.
    pub(super) fn moves(&self, command: f64, half_px: f64) -> impl Iterator<Item = (f64, f64)> {
        self.places(half_px).map(move |(at, likely)| (likely, pushed(self.after(at), command, half_px) - at))
    }

    /// Takes a picture at a command: how far it moved since the last one, and how well that is known, or nothing if the picture does not
    /// tell. Returns how well that fits, 1 at most.
    pub(super) fn see(&mut self, moved: Option<(f64, f64)>, command: f64, half_px: f64) -> f64 {
        self.go(command, half_px);
        let mut likely = [0.0; PLACES];
        let mut sum = 0.0;
        for (at, before) in self.places(half_px) {
            let after = self.after(at);
            let fits = moved.map_or(1.0, |(way, sd)| {
                let off = (after - at - way) / sd;
                // Beyond ten it is less than what a sum with the next number shows.
                UNFIT + if off.abs() < 10.0 { libm::exp(-0.5 * off * off) } else { 0.0 }
            });
            let now = (before + ANYWHERE * EVEN) * fits;
            sum += now;
            // Between two places of the row each gets its part.
            #[expect(clippy::cast_precision_loss, reason = "a small number")]
            let last = (PLACES - 1) as f64;
            let row = if half_px > 0.0 {
                (0.5 * last * ((after - command) / half_px + 1.0)).clamp(0.0, last)
            } else {
                0.0
            };
            let first = super::whole::count(libm::floor(row)).min(PLACES - 2);
            #[expect(clippy::cast_precision_loss, reason = "a small number")]
            let part = row - first as f64;
            for (place, share) in [(first, 1.0 - part), (first + 1, part)] {
                if let Some(place) = likely.get_mut(place) {
                    *place += share * now;
                }
            }
        }
        if sum > 0.0 {
            *self = Self { likely: likely.map(|likely| likely / sum), ..Self::default() };
        } else {
            *self = Self::default();
        }
        sum / ((1.0 + ANYWHERE) * (1.0 + UNFIT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How far a command moves it in the mean.
    fn mean(lag: &Lag, command: f64, half_px: f64) -> f64 {
        lag.moves(command, half_px).map(|(likely, moved)| likely * moved).sum()
    }

    #[test]
    fn a_turn_costs_what_is_left_of_the_play() {
        // 3 px of play, pushed upwards to a command of 0: it hangs behind by 1.5 px.
        let mut lag = Lag::behind(1.0);
        assert!((mean(&lag, 2.0, 1.5) - 2.0).abs() < 1e-9);
        assert!((mean(&lag, -5.0, 1.5) + 2.0).abs() < 1e-9 && mean(&lag, -3.0, 1.5).abs() < 1e-9);
        // Down by 2 px, seen well: then it is 0.5 px above the command, which has to go 2 px up before it is pushed.
        lag.see(Some((0.0, 0.1)), -2.0, 1.5);
        assert!((mean(&lag, -2.0, 1.5) + 1.0).abs() < 0.05, "{}", mean(&lag, -2.0, 1.5));
        assert!((mean(&lag, 3.0, 1.5) - 1.0).abs() < 0.05, "{}", mean(&lag, 3.0, 1.5));
    }

    #[test]
    fn what_a_move_did_tells_where_it_was() {
        // Anywhere in 4 px of play; a command of 3 px moved it by 1: it was 2 px short of being pushed.
        let mut lag = Lag::default();
        lag.see(Some((1.0, 0.1)), 3.0, 2.0);
        assert!((mean(&lag, 1.0, 2.0) - 1.0).abs() < 0.05);
        // Two moves, of 1 and of 3 px downwards, are all of the play.
        let mut lag = Lag::behind(1.0);
        lag.go(-1.0, 2.0);
        assert!(mean(&lag, -4.0, 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_play_that_is_too_small_fits_worse() {
        // Pushed upwards, then 2 px down, and it stood still: there are 3 px of play, not one.
        let fit = |half_px: f64| Lag::behind(1.0).see(Some((0.0, 0.1)), -2.0, half_px);
        assert!(fit(1.5) > 0.9 && fit(0.5) < 0.02, "{} {}", fit(1.5), fit(0.5));
    }
}
