//! [`LineType`]: dashes and dots along a line: `LT`, `UL`.

use super::piece::Piece;

/// Dashes and gaps in one pattern, at most.
pub(super) const GAPS: usize = 20;
/// Numbers of the patterns: 1 to 8.
pub(super) const PATTERNS: usize = 8;
/// Most dashes, dots and gaps of one piece: where there would be more, it is drawn whole.
const MOST_PARTS: f64 = 20_000.0;

/// A dash shorter than this share of its pattern at the end of a line comes of rounding.
const LEAST_SHARE: f64 = 1e-5;

/// Lengths of dash, gap, dash, …: shares of the pattern's length that add up to 1. A dash of 0 is a dot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pattern {
    shares: [f32; GAPS],
    count: u8,
}

/// The patterns of HP-GL/2, in percent.
const USUAL: [&[f32]; PATTERNS] = [
    &[0.0, 100.0],
    &[50.0, 50.0],
    &[70.0, 30.0],
    &[80.0, 10.0, 0.0, 10.0],
    &[70.0, 10.0, 10.0, 10.0],
    &[50.0, 10.0, 10.0, 10.0, 10.0, 10.0],
    &[70.0, 10.0, 0.0, 10.0, 0.0, 10.0],
    &[50.0, 10.0, 0.0, 10.0, 10.0, 10.0, 0.0, 10.0],
];

impl Pattern {
    /// A pattern of these lengths; `None` if there are none, or too many, or one is negative, or all are 0.
    pub(super) fn new(lengths: impl IntoIterator<Item = f64> + Clone) -> Option<Self> {
        let total: f64 = lengths.clone().into_iter().sum();
        let mut pattern = Self { shares: [0.0; GAPS], count: 0 };
        for length in lengths {
            *pattern.shares.get_mut(usize::from(pattern.count))? = if length >= 0.0 {
                #[expect(clippy::cast_possible_truncation, reason = "a share needs no more digits")]
                let share = (length / total) as f32;
                share
            } else {
                return None;
            };
            pattern.count += 1;
        }
        (total > 0.0).then_some(pattern)
    }

    /// The pattern of HP-GL/2 with this number, from 0.
    pub(super) fn usual(index: usize) -> Self {
        let percents = USUAL.get(index).copied().unwrap_or(&[100.0]);
        Self::new(percents.iter().map(|percent| f64::from(*percent)))
            .unwrap_or(Self { shares: [1.0; GAPS], count: 1 })
    }

    fn share(&self, index: u8) -> f64 {
        self.shares.get(usize::from(index)).copied().map_or(0.0, f64::from)
    }
}

/// How lines look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LineType {
    Solid,
    /// Only a dot at the end of each line.
    Ends,
    /// A pattern of this length, units, which goes on round corners.
    Fixed {
        pattern: Pattern,
        length: f64,
    },
    /// As many whole patterns on each line as fit best, each beginning and ending in the middle of its first
    /// dash.
    Fitted {
        pattern: Pattern,
        length: f64,
    },
}

/// How far into a pattern the drawing is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Phase {
    /// Which dash or gap: dashes are even.
    index: u8,
    /// How much of it has been drawn, as a share of the pattern.
    drawn: f64,
}

/// A piece as dashes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Dashes {
    piece: Piece,
    length: f64,
    /// How far along the piece, units.
    along: f64,
    pattern: Option<(Pattern, f64)>,
    phase: Phase,
    /// Whether only the end is marked.
    ends: bool,
    done: bool,
}

impl Dashes {
    pub(super) fn new(piece: Piece, line_type: LineType, phase: Phase) -> Self {
        let length = piece.length();
        let mut dashes = Self { piece, length, along: 0.0, pattern: None, phase, ends: false, done: false };
        match line_type {
            LineType::Solid => {}
            LineType::Ends => dashes.ends = true,
            LineType::Fixed { pattern, length: of_pattern } => dashes.pattern = Some((pattern, of_pattern)),
            LineType::Fitted { pattern, length: of_pattern } => {
                let patterns = libm::fmax(1.0, libm::round(length / of_pattern));
                dashes.pattern = Some((pattern, length / patterns));
                dashes.phase = Phase { index: 0, drawn: 0.5 * pattern.share(0) };
            }
        }
        if let Some((pattern, of_pattern)) = dashes.pattern
            // A dot is a dot, and what is not a number is no pattern either.
            && !(length > 0.0 && length / of_pattern * f64::from(pattern.count) <= MOST_PARTS)
        {
            dashes.pattern = None;
        }
        dashes
    }

    /// Where the pattern stands after what has been drawn.
    pub(super) fn phase(&self) -> Phase {
        self.phase
    }

    /// What is left of the piece, whole.
    pub(super) fn rest(&mut self) -> Option<Piece> {
        let from = if self.length > 0.0 { self.along / self.length } else { 0.0 };
        (!core::mem::replace(&mut self.done, true)).then(|| self.piece.part(from, 1.0))
    }

    /// The next dash or dot.
    pub(super) fn next(&mut self) -> Option<Piece> {
        if self.done {
            return None;
        }
        if self.ends {
            self.done = true;
            return Some(self.piece.part(1.0, 1.0));
        }
        let Some((pattern, of_pattern)) = self.pattern else {
            self.done = true;
            return Some(self.piece);
        };
        loop {
            let share = pattern.share(self.phase.index);
            let left = (share - self.phase.drawn) * of_pattern;
            let (first, room) = (self.along, self.length - self.along);
            let dash = self.phase.index.is_multiple_of(2);
            if left > room {
                self.phase.drawn += room / of_pattern;
                self.done = true;
                // What is left by rounding is no dash.
                let seen = room > LEAST_SHARE * of_pattern;
                return (dash && seen).then(|| self.piece.part(first / self.length, 1.0));
            }
            self.along += libm::fmax(left, 0.0);
            self.phase.drawn = 0.0;
            self.phase.index = if self.phase.index + 1 < pattern.count { self.phase.index + 1 } else { 0 };
            if dash && (left > 0.0 || share == 0.0) {
                return Some(self.piece.part(first / self.length, self.along / self.length));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec2;
    use std::vec::Vec;

    fn dashes(line_type: LineType, phase: Phase, length: f64) -> (Vec<(f64, f64)>, Phase) {
        let piece = Piece::Line { from: Vec2::default(), to: Vec2::new(length, 0.0) };
        let mut dashes = Dashes::new(piece, line_type, phase);
        let rounded = |at: f64| libm::round(at * 1e3) / 1e3;
        let all = core::iter::from_fn(|| dashes.next())
            .map(|dash| (rounded(dash.from().x), rounded(dash.to().x)))
            .collect();
        (all, dashes.phase())
    }

    #[test]
    fn a_pattern_goes_on_with_the_next_line() {
        // 70, 10, 10 and 10 % of 100 units
        let line_type = LineType::Fixed { pattern: Pattern::usual(4), length: 100.0 };
        let (first, phase) = dashes(line_type, Phase::default(), 150.0);
        assert_eq!(first, [(0.0, 70.0), (80.0, 90.0), (100.0, 150.0)]);
        assert_eq!(dashes(line_type, phase, 60.0).0, [(0.0, 20.0), (30.0, 40.0), (50.0, 60.0)]);
    }

    #[test]
    fn a_fitted_pattern_begins_and_ends_alike() {
        // 250 units: three patterns of 83.3 with dashes of 41.7, the outer ones halved
        let line_type = LineType::Fitted { pattern: Pattern::usual(1), length: 100.0 };
        let (all, _) = dashes(line_type, Phase::default(), 250.0);
        assert_eq!(all, [(0.0, 20.833), (62.5, 104.167), (145.833, 187.5), (229.167, 250.0)]);
    }

    #[test]
    fn dots_have_no_length() {
        let dots = LineType::Fixed { pattern: Pattern::usual(0), length: 100.0 };
        assert_eq!(dashes(dots, Phase::default(), 150.0).0, [(0.0, 0.0), (100.0, 100.0)]);
        assert_eq!(dashes(LineType::Ends, Phase::default(), 150.0).0, [(150.0, 150.0)]);
    }

    #[test]
    fn what_would_be_too_fine_is_solid() {
        let dust = LineType::Fixed { pattern: Pattern::usual(1), length: 1e-9 };
        assert_eq!(dashes(dust, Phase::default(), 150.0).0, [(0.0, 150.0)]);
        assert_eq!(
            dashes(LineType::Fixed { pattern: Pattern::usual(1), length: 0.0 }, Phase::default(), 1.0).0,
            [(0.0, 1.0)]
        );
    }
}
