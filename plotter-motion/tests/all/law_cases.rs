//! How many cases a law is tried with.

use std::env::var;

use proptest::test_runner::Config;

/// `number` cases, or as many as `PROPTEST_CASES` tells. In a debug build, where each takes some ten times as
/// long, one in 32 of them, at least 4: the seed of a commit chooses others each time.
pub(crate) fn cases(number: u32) -> Config {
    if var("PROPTEST_CASES").is_ok() {
        return Config::default();
    }
    Config::with_cases(if cfg!(debug_assertions) { (number / 32).max(4).min(number) } else { number })
}
