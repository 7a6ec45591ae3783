//! [`wrong_choices`]: where a line follower's tool left the line that it was on.

use plotter_vector::PxPoint;
use plotter_vector::follow::Route;

/// Farthest from a line that is looked for, px.
const REACH_PX: f64 = 64.0;

/// So much way outside of the ink is no inaccuracy any more, px.
const OUTSIDE_PX: f64 = 4.0;

/// On another line for so long it has gone over to it, px.
const ON_OTHER_PX: f64 = 6.0;

/// So far back it has turned round, px.
const BACK_PX: f64 = 12.0;

/// Ends, junctions and sharp corners are near within this distance, px, and half of the line's width: there
/// one may turn.
const NEAR_END_PX: f64 = 20.0;

/// What a follower did wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WrongChoices {
    /// Ways of more than 4 px outside of the ink.
    pub shortcuts: u32,
    /// From a line to another whose ink it does not touch.
    pub jumps: u32,
    /// Turning round elsewhere than at ends, crossings and sharp corners.
    pub turns: u32,
}

impl WrongChoices {
    /// All together.
    #[must_use]
    pub const fn all(&self) -> u32 {
        self.shortcuts + self.jumps + self.turns
    }
}

/// Counts the wrong choices of a tool whose strokes have a place at least each pixel, over lines of one
/// width.
#[must_use]
pub fn wrong_choices(lines: &[Vec<PxPoint>], line_px: f64, strokes: &[Vec<PxPoint>]) -> WrongChoices {
    let route = Route::of(lines);
    let single: Vec<Route> = lines.iter().map(|line| Route::of(std::slice::from_ref(line))).collect();
    let places: Vec<PxPoint> = turning_places(lines, &single, line_px);
    let may_turn = |at: PxPoint| places.iter().any(|place| place.distance(at) < NEAR_END_PX + 0.5 * line_px);
    let touch = |one: usize, other: usize| {
        let near =
            |at: &PxPoint| single.get(other).is_some_and(|route| route.nearest(*at, line_px).is_some());
        let dense = |line: &Vec<PxPoint>| pieces(line).any(|at| near(&at));
        lines.get(one).is_some_and(dense)
    };
    let mut wrong = WrongChoices::default();
    for stroke in strokes {
        let mut outside = 0.0;
        // The line it is on, the farthest place along it in its direction, and the direction (0: not known
        // yet).
        let mut on: Option<(usize, f64, f64)> = None;
        let mut other_px = 0.0;
        for pair in stroke.windows(2) {
            let [from, at] = pair else { continue };
            let way = from.distance(*at);
            let Some((distance, line, along)) = route.nearest(*at, REACH_PX) else {
                outside += way;
                continue;
            };
            if distance > 0.5 * line_px + 1.0 {
                let before = outside;
                outside += way;
                wrong.shortcuts += u32::from(before <= OUTSIDE_PX && outside > OUTSIDE_PX);
                continue;
            }
            outside = 0.0;
            let Some((current, farthest, direction)) = on else {
                on = Some((line, along, 0.0));
                continue;
            };
            if line != current {
                other_px += way;
                if other_px > ON_OTHER_PX {
                    wrong.jumps += u32::from(!touch(current, line));
                    on = Some((line, along, 0.0));
                    other_px = 0.0;
                }
                continue;
            }
            other_px = 0.0;
            let gone = along - farthest;
            let is_over_the_seam = gone.abs() > 3.0 * BACK_PX;
            on = if may_turn(*at) || is_over_the_seam {
                Some((line, along, 0.0))
            } else if direction == 0.0 {
                let known = if gone.abs() > BACK_PX { gone.signum() } else { 0.0 };
                Some((line, if known == 0.0 { farthest } else { along }, known))
            } else if gone * direction > 0.0 {
                Some((line, along, direction))
            } else if gone.abs() > BACK_PX {
                wrong.turns += 1;
                Some((line, along, -direction))
            } else {
                on
            };
        }
    }
    wrong
}

/// Places on a polyline, at most 2 px apart.
fn pieces(line: &[PxPoint]) -> impl Iterator<Item = PxPoint> {
    line.windows(2).flat_map(|pair| {
        let (from, to) = if let [from, to] = pair { (*from, *to) } else { Default::default() };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
        let parts = (from.distance(to) / 2.0).ceil().clamp(1.0, 1e5) as u32;
        (0..=parts).map(move |part| {
            let share = f64::from(part) / f64::from(parts);
            PxPoint::new(from.x + share * (to.x - from.x), from.y + share * (to.y - from.y))
        })
    })
}

/// Ends of lines, corners of more than 90 degrees, and where lines cross.
fn turning_places(lines: &[Vec<PxPoint>], single: &[Route], line_px: f64) -> Vec<PxPoint> {
    let mut places: Vec<PxPoint> = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        places.extend(line.first().into_iter().chain(line.last()));
        for three in line.windows(3) {
            let [a, b, c] = three else { continue };
            if (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) < 0.0 {
                places.push(*b);
            }
        }
        let others = || single.iter().enumerate().filter(|(other, _)| *other != index);
        let crosses =
            |at: &PxPoint| others().any(|(_, route)| route.nearest(*at, line_px.min(3.0)).is_some());
        places.extend(pieces(line).filter(crosses));
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(places: &[(f64, f64)]) -> Vec<PxPoint> {
        let corners: Vec<PxPoint> = places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect();
        pieces(&corners).collect()
    }

    #[test]
    fn what_stays_on_its_line_is_right() {
        let lines = [line(&[(0.0, 0.0), (200.0, 0.0)]), line(&[(100.0, -50.0), (100.0, 50.0)])];
        // To the end and back, and off at the crossing.
        let right = line(&[(0.0, 0.5), (200.0, 0.5), (100.0, 0.5), (100.0, 50.0)]);
        assert_eq!(wrong_choices(&lines, 4.0, &[right]), WrongChoices::default());
    }

    #[test]
    fn jumps_shortcuts_and_turns_are_counted() {
        let lines = [line(&[(0.0, 0.0), (200.0, 0.0)]), line(&[(0.0, 5.0), (200.0, 5.0)])];
        let jump = line(&[(0.0, 0.0), (100.0, 0.0), (106.0, 5.0), (200.0, 5.0)]);
        assert_eq!(wrong_choices(&lines, 4.0, &[jump]), WrongChoices { jumps: 1, ..Default::default() });
        let turn = line(&[(0.0, 0.0), (100.0, 0.0), (50.0, 0.0)]);
        assert_eq!(wrong_choices(&lines, 4.0, &[turn]), WrongChoices { turns: 1, ..Default::default() });
        let corner = [line(&[(0.0, 0.0), (100.0, 0.0), (100.0, 100.0)])];
        let cut = line(&[(0.0, 0.0), (80.0, 0.0), (100.0, 20.0), (100.0, 100.0)]);
        assert_eq!(wrong_choices(&corner, 4.0, &[cut]), WrongChoices { shortcuts: 1, ..Default::default() });
    }
}
