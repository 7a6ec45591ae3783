//! [`Grain`]: pits in strokes, and specks on paper, counted while rows pass.

use std::collections::VecDeque;

/// How far a pit and what is around it reach, px.
const REACH: usize = 2;

/// Rows that are held.
const ROWS: usize = 2 * REACH + 1;

/// The ways across a pixel: the first step, and how many are gone to either side. A line between two others
/// leads out along one of them, whichever way it runs; out of a pit none leads.
const ACROSS: [(isize, isize, isize); 8] =
    [(1, 0, 2), (0, 1, 2), (1, 1, 2), (-1, 1, 2), (2, 1, 1), (1, 2, 1), (-1, 2, 1), (-2, 1, 1)];

/// Shallower pits do not count, levels.
const SHALLOWEST: u8 = 24;

/// Grain from so many pits on, a share of the ink's pixels: chalk and pencil in strokes of five pixels have
/// one in 200 to 700. The counters of small letters are pits, too, one in 2500 pixels of an eye chart.
const PITS: f64 = 1.0 / 1000.0;

/// In a noisy picture there are pits in the paper as well, specks. Grain has so many times more.
const TIMES_SPECKS: f64 = 4.0;

/// Pixels that something lighter, or darker, surrounds, up to two wide.
#[derive(Clone, Debug)]
pub(crate) struct Grain {
    rows: VecDeque<Vec<u8>>,
    /// How many are so much darker than all around.
    dark: [u64; 256],
    /// And lighter.
    light: [u64; 256],
}

impl Grain {
    pub(crate) fn new() -> Self {
        Self { rows: VecDeque::new(), dark: [0; 256], light: [0; 256] }
    }

    /// The next row. With `is_asked` the row [`Grain::BEHIND`] ones before it is looked at.
    pub(crate) fn push(&mut self, levels: &[u8], is_asked: bool) {
        let mut row = if self.rows.len() < ROWS { None } else { self.rows.pop_front() }.unwrap_or_default();
        row.clear();
        row.extend_from_slice(levels);
        self.rows.push_back(row);
        if is_asked && self.rows.len() == ROWS {
            self.look();
        }
    }

    /// A row can be looked at when so many more have come.
    pub(crate) const BEHIND: u32 = 2;

    fn look(&mut self) {
        let Some(row) = self.rows.get(REACH) else { return };
        for (x, window) in row.windows(ROWS).enumerate() {
            let [a, b, at, c, d] = *window else { continue };
            // Most pixels are paper, or no pit in their own row.
            let lightest = a.max(b).min(c.max(d));
            let darkest = a.min(b).max(c.min(d));
            let at_x = x + REACH;
            if lightest.saturating_sub(at) >= SHALLOWEST {
                let depth = self.depth(at_x, |level| level).saturating_sub(at);
                count(&mut self.dark, depth);
            } else if at.saturating_sub(darkest) >= SHALLOWEST {
                let depth = self.depth(at_x, |level| !level).saturating_sub(!at);
                count(&mut self.light, depth);
            }
        }
    }

    /// The least, over all ways across a place, of the lightest levels on both its sides.
    fn depth(&self, x: usize, of: impl Fn(u8) -> u8) -> u8 {
        let level = |dx: isize, dy: isize| {
            let row = self.rows.get(REACH.saturating_add_signed(dy));
            row.and_then(|row| row.get(x.saturating_add_signed(dx))).map_or(0, |level| of(*level))
        };
        let lightest = |dx: isize, dy: isize, steps: isize| {
            (1..=steps).map(|step| level(step * dx, step * dy)).max().unwrap_or(0)
        };
        let both = |(dx, dy, steps)| lightest(dx, dy, steps).min(lightest(-dx, -dy, steps));
        ACROSS.into_iter().map(both).min().unwrap_or(0)
    }

    /// Whether the strokes have pits as deep as half of the contrast, given how many pixels of the rows that
    /// were looked at are ink and paper.
    pub(crate) fn is_grainy(&self, ink_is_dark: bool, contrast: f64, ink: f64, paper: f64) -> bool {
        let (of_ink, of_paper) =
            if ink_is_dark { (&self.light, &self.dark) } else { (&self.dark, &self.light) };
        #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
        let deep = |pits: &[u64; 256]| {
            let deep = (0_u16..).zip(pits).filter(|(depth, _)| f64::from(*depth) > contrast / 2.0);
            deep.map(|(_, pits)| *pits).sum::<u64>() as f64
        };
        let (pits, specks) = (deep(of_ink), deep(of_paper));
        pits > PITS * ink && pits * paper > TIMES_SPECKS * specks * ink
    }
}

fn count(pits: &mut [u64; 256], depth: u8) {
    if let Some(pits) = pits.get_mut(usize::from(depth)).filter(|_| depth >= SHALLOWEST) {
        *pits += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a picture of 60 x 60 px is grainy, of 200 for ink and 0 for paper; and the other way around.
    fn is_grainy(is_ink: impl Fn(i32, i32) -> bool) -> bool {
        let both = [false, true].map(|ink_is_dark| {
            let mut grain = Grain::new();
            let mut ink = 0.0;
            for y in 0..60 {
                let row: Vec<bool> = (0..60).map(|x| is_ink(x, y)).collect();
                ink += row.iter().map(|is_ink| f64::from(u8::from(*is_ink))).sum::<f64>();
                let level = |is_ink: &bool| if *is_ink == ink_is_dark { 0 } else { 200 };
                grain.push(&row.iter().map(level).collect::<Vec<u8>>(), true);
            }
            grain.is_grainy(ink_is_dark, 200.0, ink, 3600.0 - ink)
        });
        assert_eq!(both[0], both[1]);
        both[0]
    }

    #[test]
    fn pits_in_strokes_are_grain_whatever_way_these_run() {
        for (a, b) in [(1, 0), (0, 1), (1, 1), (2, 1), (1, -2), (3, 1)] {
            let is_line = move |x: i32, y: i32| (a * x + b * y).rem_euclid(24) < 8 * a.abs().max(b.abs());
            let is_pit = move |x: i32, y: i32| (x * 7 + y * 13).rem_euclid(41) == 0;
            assert!(!is_grainy(is_line), "{a} {b}");
            assert!(is_grainy(|x, y| is_line(x, y) && !is_pit(x, y)), "{a} {b}");
        }
    }

    #[test]
    fn close_lines_of_any_direction_are_no_grain() {
        for (a, b) in [(1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0), (1.0, -2.0), (3.0, 1.0), (1.0, 5.0)] {
            // Lines of 3 px with a way of one pixel between them.
            let length = libm::hypot(a, b);
            let is_line = move |x: i32, y: i32| {
                let across = (a * f64::from(x) + b * f64::from(y)) / length + 1000.0;
                across % 4.0 < 3.0
            };
            assert!(!is_grainy(is_line), "{a} {b}");
        }
    }

    #[test]
    fn specks_on_paper_and_in_ink_alike_are_noise() {
        let is_line = |x: i32, _: i32| x % 20 < 8;
        let is_speck = |x: i32, y: i32| (x * 7 + y * 13).rem_euclid(97) == 0;
        assert!(!is_grainy(|x, y| is_line(x, y) != is_speck(x, y)));
        assert!(!is_grainy(|_, _| false));
        assert!(!is_grainy(|_, _| true));
    }
}
