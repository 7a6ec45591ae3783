//! [`farthest`]: the longest segment that keeps a promise, by doubling and halving.

use super::MAX_REACH_PX;

/// What `reaches` gives for the greatest number of sites found for which it gives something, at most `last`
/// and [`MAX_REACH_PX`]; `next`, the segment to the very next site, is always there. `reaches` is asked twice
/// the logarithm of that number of times.
pub(super) fn farthest<T>(next: T, last: usize, reaches: impl Fn(usize) -> Option<T>) -> T {
    let mut best = next;
    let most = last.min(MAX_REACH_PX);
    let (mut good, mut bad, mut reach) = (1, most + 1, 2);
    let mut missed = false;
    while reach < bad {
        match reaches(reach) {
            Some(found) => (best, good) = (found, reach),
            // Noise may spoil one length where a greater one will do.
            None if missed => bad = reach,
            None => {
                missed = true;
                bad = bad.min(reach.max(most) + 1);
            }
        }
        if reach == most {
            break;
        }
        reach = (2 * reach).min(most);
    }
    // Somewhere between the greatest that did and the least that did not.
    bad = bad.min((2 * good).min(most) + 1);
    while good + 1 < bad {
        let middle = usize::midpoint(good, bad);
        match reaches(middle) {
            Some(found) => (best, good) = (found, middle),
            None => bad = middle,
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn up_to(good: impl Fn(usize) -> bool, last: usize) -> usize {
        farthest(1, last, |reach| good(reach).then_some(reach))
    }

    #[test]
    fn the_greatest_length_is_found() {
        for good in [1, 2, 3, 37, 64, 99, 100] {
            assert_eq!(up_to(|reach| reach <= good, 100), good);
        }
        assert_eq!(up_to(|_| true, 1_000_000), MAX_REACH_PX);
        assert_eq!(up_to(|_| true, 1), 1);
    }

    #[test]
    fn one_length_that_does_not_do_hides_no_greater_one() {
        assert_eq!(up_to(|reach| reach != 8 && reach <= 20, 100), 20);
    }
}
