//! A share of many cases, other ones with each commit.

use std::env::var;

/// Those of `cases` that this run tries: all of them, or one in `SAMPLE_ONE_IN`, at least one. `.ci/run` sets
/// it because all take longer than it may; which ones, the seed of the property tests tells.
pub(crate) fn sampled<T>(cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    let number = |name: &str, otherwise: usize| {
        var(name)
            .map_or(otherwise, |text| text.parse().unwrap_or_else(|error| panic!("{name}={text}: {error}")))
    };
    one_in(number("SAMPLE_ONE_IN", 1), number("PROPTEST_RNG_SEED", 0), cases)
}

fn one_in<T>(number: usize, seed: usize, cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    let cases: Vec<T> = cases.into_iter().collect();
    let number = number.min(cases.len()).max(1);
    cases.into_iter().skip(seed % number).step_by(number)
}

#[test]
fn seeds_share_the_cases_and_none_has_no_case() {
    for (number, many) in [(1, 4), (3, 10), (6, 4), (6, 6)] {
        let shares: Vec<Vec<u32>> = (0..number).map(|seed| one_in(number, seed, 0..many).collect()).collect();
        assert!(shares.iter().all(|share| !share.is_empty()), "{number} {shares:?}");
        assert!(
            (0..many).all(|case| shares.iter().any(|share| share.contains(&case))),
            "{number} {shares:?}"
        );
    }
}
