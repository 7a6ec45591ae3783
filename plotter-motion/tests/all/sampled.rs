//! A share of many cases, other ones with each commit.

use std::env::var;

/// Those of `cases` that this run tries: all of them, or one in `SAMPLE_ONE_IN`, which `.ci/run` sets because all
/// take longer than it may. Which ones, the seed of the property tests tells.
pub(crate) fn sampled<T>(cases: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    let number = |name: &str, otherwise: usize| {
        var(name)
            .map_or(otherwise, |text| text.parse().unwrap_or_else(|error| panic!("{name}={text}: {error}")))
    };
    let (one_in, seed) = (number("SAMPLE_ONE_IN", 1), number("PROPTEST_RNG_SEED", 0));
    assert!(one_in > 0, "SAMPLE_ONE_IN=0 would try nothing");
    cases.into_iter().skip(seed % one_in).step_by(one_in)
}
