//! Any bytes read as a language of cutters: no panic, no end of reports, no place that is none.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_motion::hpgl::cutter::{Dialect, PlotOps, ReadOptions};

/// Operations after which a text has shown what it can do.
const MOST_OPS: usize = 20_000;

fuzz_target!(|bytes: &[u8]| {
    let found = Dialect::detect(bytes).map(|(dialect, _)| dialect);
    for dialect in [Dialect::CammGl, Dialect::GpGl].into_iter().chain(found) {
        for item in PlotOps::with_options(bytes.iter().copied(), ReadOptions::for_dialect(dialect)).take(MOST_OPS) {
            match item {
                Ok(op) => assert!(op.target().is_none_or(|to| to.is_finite()), "{op:?}"),
                Err(error) => {
                    assert!(error.at.offset <= bytes.len() as u64);
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
});
