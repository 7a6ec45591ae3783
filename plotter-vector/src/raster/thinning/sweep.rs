//! [`Sweeper`]: parallel steps on a bitmap, in place, only where something can change.

use super::deletion::Neighbours;
use super::tips;
use crate::picture::Bitmap;
use core::ops::Range;

/// One parallel step: all pixels that fulfil its condition go at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    GuoHallFirst,
    GuoHallSecond,
    ZhangSuenFirst,
    ZhangSuenSecond,
    /// North-east and south-west corners.
    CornersRising,
    /// North-west and south-east corners.
    CornersFalling,
    /// Tips beside thick ink.
    Tips,
    BareBelow,
    BareAbove,
    BareLeft,
    BareRight,
}

/// How many steps there are.
const STEPS: usize = Step::BareRight as usize + 1;

impl Step {
    /// How many rows away a pixel can lie that decides about another.
    pub(super) const fn reach(self) -> u32 {
        if matches!(self, Self::Tips) { tips::REACH } else { 1 }
    }
}

/// Does steps on one picture. Holds a bit of marks a word of the picture for each step, and what goes of
/// three rows.
///
/// Ink is only ever deleted. Whether a pixel goes in a step can therefore change only when one of its eight
/// neighbours goes (thick ink near a tip, [`tips::shrinking`], can vanish but not appear): a step looks at
/// all words with ink when it is done first, and then at those where a pixel in or beside the word has gone
/// since it was last done there.
#[derive(Debug)]
pub(super) struct Sweeper {
    /// Words of marks a row.
    per_row: usize,
    /// Rows that the steps are done in.
    rows: Range<u32>,
    /// The words with ink, a bit each.
    inked: Vec<u64>,
    /// For each step those that it has to look at; none of a step that was not done yet.
    open: [Vec<u64>; STEPS],
    /// Words of a row and beside that are to be looked at again.
    marks: Vec<u64>,
    /// What goes of the current row and of the two above it.
    gone: [Gone; 3],
}

/// Pixels of a row that go, word by word.
type Gone = Vec<(usize, u64)>;

/// What a row's neighbours are where the picture ends.
const OUTSIDE: &[u64] = &[];

impl Sweeper {
    /// For `ink`, before the first step.
    pub(super) fn new(ink: &Bitmap) -> Self {
        let per_row = ink.row(0).len().div_ceil(64);
        let mark = |words: &[u64]| words.iter().rev().fold(0, |mark, word| mark << 1 | u64::from(*word != 0));
        Self {
            per_row,
            rows: 0..ink.height(),
            inked: (0..ink.height()).flat_map(|y| ink.row(y).chunks(64).map(mark)).collect(),
            open: Default::default(),
            marks: vec![0; per_row],
            gone: Default::default(),
        }
    }

    /// Forgets what all but some steps have to look at: those are not done any more.
    pub(super) fn keep_only(&mut self, steps: &[Step]) {
        for (index, open) in self.open.iter_mut().enumerate() {
            if steps.iter().all(|step| *step as usize != index) {
                *open = Vec::new();
            }
        }
    }

    /// Does the steps one after the other in some rows; whether anything has gone.
    pub(super) fn pass(&mut self, ink: &mut Bitmap, rows: Range<u32>, steps: &[Step]) -> bool {
        self.rows = rows;
        let mut changed = false;
        for step in steps {
            // A closure each, so that each step is a loop of its own.
            changed |= match step {
                Step::GuoHallFirst => self.sweep(ink, *step, Neighbours::guo_hall),
                Step::GuoHallSecond => self.sweep(ink, *step, |n| n.half_turn().guo_hall()),
                Step::ZhangSuenFirst => self.sweep(ink, *step, Neighbours::zhang_suen),
                Step::ZhangSuenSecond => self.sweep(ink, *step, |n| n.half_turn().zhang_suen()),
                Step::CornersRising => self.sweep(ink, *step, |n| n.corner() | n.half_turn().corner()),
                Step::CornersFalling => self
                    .sweep(ink, *step, |n| n.quarter_turn().corner() | n.quarter_turn().half_turn().corner()),
                Step::Tips => self.sweep_rows(ink, *step, |here, n| n.tip(here), tips::shrinking),
                Step::BareBelow => self.sweep(ink, *step, Neighbours::bare_below),
                Step::BareAbove => self.sweep(ink, *step, |n| n.half_turn().bare_below()),
                Step::BareLeft => self.sweep(ink, *step, |n| n.quarter_turn().bare_below()),
                Step::BareRight => self.sweep(ink, *step, |n| n.quarter_turn().half_turn().bare_below()),
            };
        }
        changed
    }

    /// A step that looks at the neighbours alone.
    fn sweep(&mut self, ink: &mut Bitmap, step: Step, rule: impl Fn(Neighbours) -> u64) -> bool {
        self.sweep_rows(ink, step, |here, n| here & rule(n), |_, _, gone| gone)
    }

    /// One step, row by row from the top: `rule` says which pixels of a word go, and `confirm` which of them
    /// really do, given the rows from three above to three below (the first of them as the step has left it).
    fn sweep_rows(
        &mut self,
        ink: &mut Bitmap,
        step: Step,
        rule: impl Fn(u64, Neighbours) -> u64,
        confirm: impl Fn([&[u64]; 7], usize, u64) -> u64,
    ) -> bool {
        if let Some(open) = self.open.get_mut(step as usize).filter(|open| open.is_empty()) {
            open.clone_from(&self.inked);
        }
        let mut changed = false;
        for y in self.rows.clone() {
            if self.open_words(step, y).iter().all(|mark| *mark == 0) && self.gone.iter().all(Vec::is_empty) {
                continue;
            }
            let [mut current, above, higher] = core::mem::take(&mut self.gone);
            judge_row(ink, y, self.open_words(step, y), &rule, &confirm, &mut current);
            changed |= !current.is_empty();
            // The row two above is deleted from only now: until here it was to be seen as it was before the
            // step.
            let done = self.delete(ink, y.wrapping_sub(2), higher);
            self.gone = [done, current, above];
        }
        let [empty, above, higher] = core::mem::take(&mut self.gone);
        let higher = self.delete(ink, self.rows.end.wrapping_sub(2), higher);
        let above = self.delete(ink, self.rows.end.wrapping_sub(1), above);
        self.gone = [empty, above, higher];
        changed
    }

    /// The words of row `y` that a step has to look at.
    fn open_words(&mut self, step: Step, y: u32) -> &mut [u64] {
        let start = y as usize * self.per_row;
        let open = self.open.get_mut(step as usize);
        open.and_then(|open| open.get_mut(start..start + self.per_row)).unwrap_or_default()
    }

    /// Deletes what goes of row `y` and marks the words it is in and the words beside; hands the list back,
    /// empty.
    fn delete(&mut self, ink: &mut Bitmap, y: u32, mut gone: Gone) -> Gone {
        if gone.is_empty() {
            return gone;
        }
        let Self { per_row, open, marks, .. } = self;
        marks.fill(0);
        let mut mark = |at: usize| {
            if let Some(word) = marks.get_mut(at / 64) {
                *word |= 1 << (at % 64);
            }
        };
        let row = ink.row_mut(y);
        for (at, goes) in gone.drain(..) {
            if let Some(word) = row.get_mut(at) {
                *word &= !goes;
            }
            mark(at);
            if goes & 1 != 0 && at > 0 {
                mark(at - 1);
            }
            if goes >> 63 != 0 {
                mark(at + 1);
            }
        }
        let first = (y as usize).saturating_sub(1) * *per_row;
        for all in open {
            let end = all.len().min((y as usize + 2) * *per_row);
            for rows in all.get_mut(first..end).unwrap_or(&mut []).chunks_exact_mut(*per_row) {
                for (word, mark) in rows.iter_mut().zip(marks.iter()) {
                    *word |= mark;
                }
            }
        }
        gone
    }
}

/// What goes of row `y` in a step of the words that it has to look at, of which none is left.
fn judge_row(
    ink: &Bitmap,
    y: u32,
    open: &mut [u64],
    rule: impl Fn(u64, Neighbours) -> u64,
    confirm: impl Fn([&[u64]; 7], usize, u64) -> u64,
    gone: &mut Gone,
) {
    let above = |up: u32| y.checked_sub(up).map_or(OUTSIDE, |y| ink.row(y));
    let below = |down: u32| ink.row(y + down);
    let rows = [above(3), above(2), above(1), below(0), below(1), below(2), below(3)];
    let [_, _, north, middle, south, _, _] = rows;
    for (base, open) in (0..).step_by(64).zip(open) {
        let mut rest = core::mem::take(open);
        while rest != 0 {
            let at = base + rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let (word, w, e) = three(middle, at);
            if word == 0 {
                continue;
            }
            let (n, nw, ne) = three(north, at);
            let (s, sw, se) = three(south, at);
            let mut goes = rule(word, Neighbours { n, ne, e, se, s, sw, w, nw });
            if goes != 0 {
                goes = confirm(rows, at, goes);
            }
            if goes != 0 {
                gone.push((at, goes));
            }
        }
    }
}

/// Word `at` of a row, and the pixels to the left and to the right of its pixels.
#[inline]
fn three(row: &[u64], at: usize) -> (u64, u64, u64) {
    let (left, middle, right) = if let Some([left, middle, right]) = row.get(at.wrapping_sub(1)..at + 2) {
        (*left, *middle, *right)
    } else {
        // At the ends of the row, and outside the picture.
        let word = |index: usize| row.get(index).copied().unwrap_or(0);
        (word(at.wrapping_sub(1)), word(at), word(at + 1))
    };
    (middle, middle << 1 | left >> 63, middle >> 1 | right << 63)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;

    const ALL: [Step; 11] = [
        Step::GuoHallFirst,
        Step::Tips,
        Step::GuoHallSecond,
        Step::ZhangSuenFirst,
        Step::CornersRising,
        Step::ZhangSuenSecond,
        Step::CornersFalling,
        Step::BareBelow,
        Step::BareAbove,
        Step::BareLeft,
        Step::BareRight,
    ];

    /// Noise of the given share of ink in 256.
    fn noise(width: u32, height: u32, share: u64, seed: u64) -> Bitmap {
        let mut ink = Bitmap::new(width, height).unwrap();
        let mut state = seed;
        for y in 0..height {
            for x in 0..width {
                // Knuth's multiplier and increment of MMIX.
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                ink.set(Pixel::new(x, y), state >> 56 < share);
            }
        }
        ink
    }

    /// The step pixel by pixel, from a copy.
    fn one_by_one(ink: &Bitmap, step: Step) -> Bitmap {
        let at = |x: i64, y: i64| {
            u32::try_from(x).ok().zip(u32::try_from(y).ok()).is_some_and(|(x, y)| ink.get(Pixel::new(x, y)))
        };
        let mut after = ink.clone();
        for pixel in ink.ink() {
            let (x, y) = (i64::from(pixel.x), i64::from(pixel.y));
            let ring = |u: i64, v: i64| {
                let bit = |dx: i64, dy: i64| u64::from(at(u + dx, v + dy));
                Neighbours {
                    n: bit(0, -1),
                    ne: bit(1, -1),
                    e: bit(1, 0),
                    se: bit(1, 1),
                    s: bit(0, 1),
                    sw: bit(-1, 1),
                    w: bit(-1, 0),
                    nw: bit(-1, -1),
                }
            };
            let n = ring(x, y);
            let q = n.quarter_turn();
            let goes = match step {
                Step::GuoHallFirst => n.guo_hall(),
                Step::GuoHallSecond => n.half_turn().guo_hall(),
                Step::ZhangSuenFirst => n.zhang_suen(),
                Step::ZhangSuenSecond => n.half_turn().zhang_suen(),
                Step::CornersRising => n.corner() | n.half_turn().corner(),
                Step::CornersFalling => q.corner() | q.half_turn().corner(),
                Step::BareBelow => n.bare_below(),
                Step::BareAbove => n.half_turn().bare_below(),
                Step::BareLeft => q.bare_below(),
                Step::BareRight => q.half_turn().bare_below(),
                Step::Tips => {
                    let near = |reach: i64| {
                        (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (dx, dy)))
                    };
                    let thick = near(2).any(|(dx, dy)| {
                        let (u, v) = (x + dx, y + dy);
                        at(u, v) && at(u - 1, v) && at(u + 1, v) && at(u, v - 1) && at(u, v + 1)
                    });
                    let neighbours = |u: i64, v: i64| {
                        near(1)
                            .filter(|(dx, dy)| (*dx, *dy) != (0, 0) && at(u + dx, v + dy))
                            .map(move |(dx, dy)| (u + dx, v + dy))
                            .collect::<Vec<_>>()
                    };
                    let ring = neighbours(x, y);
                    let pair = ring.len() == 1 && ring.iter().all(|(u, v)| neighbours(*u, *v).len() == 1);
                    n.tip(1) & u64::from(thick && !pair)
                }
            };
            after.set(pixel, goes & 1 == 0);
        }
        after
    }

    #[test]
    fn a_sweep_in_place_is_the_step_on_a_copy() {
        for (index, (width, share)) in
            (0..).zip([(1, 200), (63, 90), (64, 130), (65, 170), (128, 220), (150, 240)])
        {
            let mut ink = noise(width, 40, share, index);
            let mut expected = ink.clone();
            let mut sweeper = Sweeper::new(&ink);
            for _ in 0..4 {
                let changed = sweeper.pass(&mut ink, 0..40, &ALL);
                let before = expected.clone();
                expected = ALL.iter().fold(expected, |ink, step| one_by_one(&ink, *step));
                assert_eq!(ink, expected, "{width} px wide");
                assert_eq!(changed, before != expected);
            }
        }
    }

    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn passes_by_turns_forget_no_word() {
        const TURNS: [&[Step]; 2] = [
            &[Step::GuoHallFirst, Step::CornersRising, Step::GuoHallSecond],
            &[Step::GuoHallFirst, Step::CornersFalling, Step::GuoHallSecond],
        ];
        for seed in 0..40 {
            let mut ink = noise(400, 30, 250, seed);
            let mut expected = ink.clone();
            let mut sweeper = Sweeper::new(&ink);
            for steps in TURNS.into_iter().cycle().take(12) {
                sweeper.pass(&mut ink, 0..30, steps);
                expected = steps.iter().fold(expected, |ink, step| one_by_one(&ink, *step));
                assert_eq!(ink, expected, "{seed}");
            }
        }
    }

    #[test]
    fn each_step_alone_is_the_step_on_a_copy() {
        for step in ALL {
            for share in [60, 128, 200, 235] {
                let mut ink = noise(70, 50, share, share);
                let expected = one_by_one(&ink, step);
                Sweeper::new(&ink).pass(&mut ink, 0..50, &[step]);
                assert_eq!(ink, expected, "{step:?}");
            }
        }
    }
}
