//! Runs of equal pixels in a row of words.

use core::ops::Range;

/// The runs of ink in a row of words, from the left.
pub(crate) fn ink_runs(words: &[u64]) -> impl Iterator<Item = Range<u32>> {
    let end = bits(words.len());
    let mut from = 0;
    core::iter::from_fn(move || {
        let start = next(words, from, 0)?;
        let stop = next(words, start, u64::MAX).unwrap_or(end);
        from = stop;
        Some(start..stop)
    })
}

/// The runs of paper in the first `width` pixels of a row of words, from the left.
pub(crate) fn paper_runs(words: &[u64], width: u32) -> impl Iterator<Item = Range<u32>> {
    let mut from = 0;
    core::iter::from_fn(move || {
        let start = next(words, from, u64::MAX).filter(|start| *start < width)?;
        let stop = next(words, start, 0).unwrap_or(width);
        from = stop;
        Some(start..stop)
    })
}

/// Makes a run ink or paper; what lies right of the words is ignored.
pub(crate) fn set_run(words: &mut [u64], run: Range<u32>, ink: bool) {
    let (first, last) = ((run.start / 64) as usize, run.end.div_ceil(64) as usize);
    for (word, left) in words.iter_mut().zip((0_u32..).step_by(64)).take(last).skip(first) {
        let (from, to) = (run.start.max(left) - left, run.end.min(left + 64).saturating_sub(left));
        // 1 to 64 bits of the word.
        let mask = u64::MAX.checked_shr(64 - to.saturating_sub(from)).unwrap_or(0) << from;
        *word = if ink { *word | mask } else { *word & !mask };
    }
}

/// The next set bit at `from` or right of it, of the words with the bits of `flip` inverted.
fn next(words: &[u64], from: u32, flip: u64) -> Option<u32> {
    let mut at = (from / 64) as usize;
    let mut word = (words.get(at)? ^ flip) & (u64::MAX << (from % 64));
    while word == 0 {
        at += 1;
        word = words.get(at)? ^ flip;
    }
    Some(bits(at) + word.trailing_zeros())
}

fn bits(words: usize) -> u32 {
    // A row has at most `MAX_SIDE_PX` pixels.
    u32::try_from(words * 64).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_cross_words_and_end_with_the_row() {
        let words = [1 << 63 | 0b1101, 0b1, 0, u64::MAX];
        assert_eq!(ink_runs(&words).collect::<Vec<_>>(), [0..1, 2..4, 63..65, 192..256]);
        assert_eq!(paper_runs(&words[..3], 130).collect::<Vec<_>>(), [1..2, 4..63, 65..130]);
        assert_eq!(ink_runs(&[]).count() + paper_runs(&[], 0).count(), 0);
    }

    #[test]
    fn a_run_is_set_and_cleared_alone() {
        for run in [0..1, 3..64, 63..65, 64..128, 10..192, 5..5] {
            let mut words = [0; 3];
            set_run(&mut words, run.clone(), true);
            let expected: Vec<_> = core::iter::once(run.clone()).filter(|run| !run.is_empty()).collect();
            assert_eq!(ink_runs(&words).collect::<Vec<_>>(), expected);
            set_run(&mut words, run, false);
            assert_eq!(words, [0; 3]);
        }
    }
}
