//! [`cut_at_turns`]: a figure that turns where others touch it is cut there.
//!
//! ```text
//!   a.....b        the tracking went down a and on along c; b and d were left, or went round the
//!   .a...b.        corner, too. Cut in the middle, each arm is free to go straight on, or, where
//!   ...a...        nothing does, to turn as it did.
//!   .d...c.
//! ```

use crate::picture::{Bitmap, Figures, Pixel};
use crate::raster::continuity::{is_closed, neighbours};
use crate::raster::straight_on::beside_line_px;

/// Pixels before and after a turn that show both directions.
const ARM_PX: usize = 8;

/// How far these may lie beside a straight line, px.
const LINE_PX: f64 = 0.75;

/// Cosine of the least turn: 15 degrees, three times what the raster makes of a straight line of 16 px.
const TURN_COS: f64 = 0.966;

/// Figures that were cut.
#[derive(Default)]
pub(crate) struct Cut {
    pub(crate) figures: Figures,
    /// Ends that were cut from each other: twice a figure's index, and 1 more for its last pixel.
    pub(crate) ends: Vec<(usize, usize)>,
}

impl Cut {
    /// The next piece of a figure.
    fn push(&mut self, pixels: impl IntoIterator<Item = Pixel>, is_first: bool) {
        let index = self.figures.len();
        self.figures.push(pixels);
        if !is_first && index > 0 {
            self.ends.push((2 * index - 1, 2 * index));
        }
    }
}

/// Cuts figures where they turn and other ink touches them. All pixels stay, once.
pub(crate) fn cut_at_turns(figures: &Figures, ink: &Bitmap) -> Cut {
    let mut cut = Cut::default();
    for figure in figures.iter() {
        let mut from = 0;
        if !is_closed(figure) {
            for at in turns(figure, ink) {
                cut.push(figure.get(from..at).unwrap_or(&[]).iter().copied(), from == 0);
                from = at;
            }
            cut.push(figure.get(from..).unwrap_or(&[]).iter().copied(), from == 0);
            continue;
        }
        // Round and round, so that a turn at the start shows, too.
        let count = figure.len();
        let around: Vec<Pixel> = figure.iter().cycle().take(count + 2 * ARM_PX).copied().collect();
        let mut at: Vec<usize> = turns(&around, ink).into_iter().map(|at| at % count).collect();
        at.sort_unstable();
        at.dedup();
        let Some(first) = at.first().copied().filter(|_| at.len() > 1) else {
            cut.push(figure.iter().copied(), true);
            continue;
        };
        let all = || figure.iter().cycle().copied();
        let next = at.iter().copied().skip(1).chain([first + count]);
        let index = cut.figures.len();
        for (from, to) in at.iter().copied().zip(next) {
            cut.push(all().skip(from).take(to - from), from == first);
        }
        cut.ends.push((2 * index, 2 * cut.figures.len() - 1));
    }
    cut
}

/// Where a figure turns at other ink: indices of the first pixels after each turn.
fn turns(figure: &[Pixel], ink: &Bitmap) -> Vec<usize> {
    let mut found: Vec<(usize, f64)> = Vec::new();
    for at in ARM_PX..figure.len().saturating_sub(ARM_PX) {
        let Some(cos) = turn(figure, at).filter(|_| touches_others(figure, at, ink)) else { continue };
        match found.last_mut().filter(|(last, _)| at < last + ARM_PX) {
            Some(last) if cos < last.1 => *last = (at, cos),
            Some(_) => {}
            None => found.push((at, cos)),
        }
    }
    found.into_iter().map(|(at, _)| at).collect()
}

/// Cosine of the turn before a pixel, if both arms are straight and it is one.
fn turn(figure: &[Pixel], at: usize) -> Option<f64> {
    let (before, after) = (figure.get(at - ARM_PX..at)?, figure.get(at..at + ARM_PX)?);
    let (come, go) = (*before.last()? - *before.first()?, *after.last()? - *after.first()?);
    let squares = come.length_squared() * go.length_squared();
    let cos = if squares > 0.0 { come.dot(go) / libm::sqrt(squares) } else { 1.0 };
    let is_straight = |arm: &[Pixel]| beside_line_px(arm, &[]) <= LINE_PX;
    (cos < TURN_COS && is_straight(before) && is_straight(after)).then_some(cos)
}

/// Whether ink touches a figure around a place that is not the figure's own there.
fn touches_others(figure: &[Pixel], at: usize, ink: &Bitmap) -> bool {
    let own = figure.get(at.saturating_sub(ARM_PX)..(at + ARM_PX).min(figure.len())).unwrap_or(&[]);
    let near = figure.get(at.saturating_sub(2)..(at + 2).min(figure.len())).unwrap_or(&[]);
    near.iter().flat_map(|at| neighbours(*at)).any(|at| ink.get(at) && !own.contains(&at))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(figures: &[Vec<Pixel>]) -> Vec<Vec<Pixel>> {
        let mut ink = Bitmap::new(41, 41).unwrap();
        let mut all = Figures::default();
        for figure in figures {
            figure.iter().for_each(|at| ink.set(*at, true));
            all.push(figure.iter().copied());
        }
        cut_at_turns(&all, &ink).figures.iter().map(<[Pixel]>::to_vec).collect()
    }

    /// Along a row to the middle, and down from there.
    fn corner() -> Vec<Pixel> {
        let level = (0..20).map(|x| Pixel::new(x, 20));
        level.chain((20..41).map(|y| Pixel::new(20, y))).collect()
    }

    #[test]
    fn a_line_that_turned_at_a_crossing_is_cut_there() {
        let rest: Vec<Pixel> = (21..41).map(|x| Pixel::new(x, 20)).collect();
        let pieces = cut(&[corner(), rest.clone()]);
        assert_eq!(pieces, [corner()[..20].to_vec(), corner()[20..].to_vec(), rest]);
    }

    #[test]
    fn a_corner_that_nothing_touches_and_a_line_that_does_not_turn_are_whole() {
        assert_eq!(cut(&[corner()]), [corner()]);
        let level: Vec<Pixel> = (0..41).map(|x| Pixel::new(x, 20)).collect();
        let upright: Vec<Pixel> = (0..20).map(|y| Pixel::new(20, y)).collect();
        assert_eq!(cut(&[level.clone(), upright.clone()]), [level, upright]);
    }

    #[test]
    fn a_closed_line_is_cut_where_others_touch_two_of_its_corners() {
        let side = |to: fn(u32) -> (u32, u32)| (0..20).map(to).map(|(x, y)| Pixel::new(10 + x, 10 + y));
        let sides = side(|i| (i, 0))
            .chain(side(|i| (20, i)))
            .chain(side(|i| (20 - i, 20)))
            .chain(side(|i| (0, 20 - i)));
        let square: Vec<Pixel> = sides.collect();
        let beside = |x: u32| (0..10).map(move |y| Pixel::new(x, y)).collect::<Vec<_>>();
        assert_eq!(cut(&[square.clone(), beside(10)])[0], square);
        let pieces = cut(&[square, beside(10), beside(30)]);
        assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [20, 60, 10, 10]);
    }
}
