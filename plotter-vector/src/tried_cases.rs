//! A share of the cases of a unit test that is long in a debug build.

/// All of `0..number`, or one in `one_in` of them in a debug build: which ones, `PROPTEST_RNG_SEED` tells,
/// and `.ci/run` takes others with each commit.
pub(crate) fn tried(number: u8, one_in: u8) -> Vec<u8> {
    if !cfg!(debug_assertions) {
        return (0..number).collect();
    }
    let seed = std::env::var("PROPTEST_RNG_SEED").ok().and_then(|seed| seed.parse::<u64>().ok());
    let first = seed.unwrap_or(0) % u64::from(one_in);
    (0..number).filter(|case| u64::from(case % one_in) == first).collect()
}
