//! Any bytes read as HPGL: no panic, no end of reports, no place that is none; and what was read is written
//! and read again.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_motion::PlotOp;
use plotter_motion::hpgl::{Coordinates, Interpreter, PlotOps, ReadOptions, WriteOptions, Writer, plot_ops};

/// Operations after which a text has shown what it can do: there are texts that fill sheets with dots for a
/// few bytes.
const MOST_OPS: usize = 20_000;

fuzz_target!(|bytes: &[u8]| {
    let interpreter = Interpreter::<64>::with_options(ReadOptions::default());
    let mut ops = Vec::new();
    let mut reports = 0;
    for outcome in PlotOps::with_interpreter(bytes.iter().copied(), interpreter).take(MOST_OPS) {
        match outcome {
            Ok(op) => {
                assert!(op.target().is_none_or(|to| to.is_finite()), "{op:?}");
                if let PlotOp::DrawArc { centre, sweep_rad, .. } = op {
                    assert!(centre.is_finite() && sweep_rad.abs() <= std::f64::consts::TAU, "{op:?}");
                }
                ops.push(op);
            }
            Err(report) => {
                assert!(report.position().offset <= bytes.len() as u64);
                assert!(!report.to_string().is_empty());
                reports += 1;
            }
        }
    }
    assert!(reports <= bytes.len() + 1);
    // Strictly, it is the same up to the first error.
    let strict = plot_ops(bytes)
        .strict()
        .take(MOST_OPS)
        .filter(|outcome| outcome.as_ref().is_err_and(|error| !error.is_notice()));
    assert!(strict.count() <= 1);
    for coordinates in [Coordinates::Absolute, Coordinates::Relative, Coordinates::Encoded] {
        let mut writer =
            Writer::with_options(String::new(), WriteOptions { coordinates, ..Default::default() });
        // What lies out of range is refused, and nothing else.
        let written = ops.iter().filter(|op| writer.push(**op).is_ok()).count();
        let text = writer.finish().expect("a string takes all");
        let read: Vec<PlotOp> =
            plot_ops(text.as_bytes()).collect::<Result<_, _>>().expect("it was written here");
        assert!(read.len() >= written, "{coordinates:?}: {text}");
    }
});
