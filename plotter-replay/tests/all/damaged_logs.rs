//! A hundred cuts and a hundred flipped bytes: each costs at most the record that it hits, and each is told.

use plotter_replay::log::{Reader, Record};

/// A recorded session of a simulated machine.
const LOG: &[u8] = include_bytes!("../golden/line.plog");

/// A random number from a seed: SplitMix64.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

fn below(state: &mut u64, most: usize) -> usize {
    usize::try_from(random(state) % u64::try_from(most).unwrap()).unwrap()
}

fn read(log: &[u8]) -> (Vec<Record>, bool) {
    let mut reader = Reader::new(log).unwrap();
    let records = reader.by_ref().filter_map(Result::ok).collect();
    (records, !reader.summary().is_clean())
}

/// The record that a byte belongs to, from 0; its line end is part of it. `None` in the first line.
fn record_at(at: usize) -> Option<usize> {
    LOG[..at].iter().filter(|&&byte| byte == b'\n').count().checked_sub(1)
}

#[test]
fn a_cut_costs_at_most_the_record_that_it_hits() {
    let (all, is_damaged) = read(LOG);
    assert!(!is_damaged && all.len() > 400);
    let first = LOG.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let mut seed = 1;
    for _ in 0..100 {
        let at = first + below(&mut seed, LOG.len() - first);
        let (left, is_told) = read(&LOG[..at]);
        let whole = record_at(at).unwrap();
        // Cut right behind a checksum, only the line end is missing.
        assert!(left == all[..whole] || left == all[..=whole], "cut at {at}");
        let is_between = LOG[at - 1] == b'\n' || left.len() > whole;
        assert!(is_told || is_between, "cut at {at} is not told");
    }
}

#[test]
fn a_flipped_byte_costs_at_most_the_record_that_it_hits() {
    let (all, _) = read(LOG);
    let mut seed = 2;
    for _ in 0..100 {
        let at = below(&mut seed, LOG.len());
        let mut hit = LOG.to_vec();
        hit[at] ^= 1 << below(&mut seed, 8);
        let (left, is_told) = read(&hit);
        let mut without = all.clone();
        if let Some(record) = record_at(at) {
            without.remove(record);
        }
        assert!(left == all || left == without, "byte {at}: {} of {}", left.len(), all.len());
        assert!(is_told, "byte {at} is not told");
    }
}
