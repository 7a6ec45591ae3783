//! Any bytes read as DXF: no panic, no end of entities, no place that is none, and complaints that have a
//! line of the text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_motion::PlotOp;
use plotter_motion::dxf::{Drawing, Pens, ReadOptions};

/// Operations after which a text has shown what it can do: blocks multiply few bytes.
const MOST_OPS: usize = 20_000;

fuzz_target!(|bytes: &[u8]| {
    let Ok(drawing) = Drawing::read(bytes.iter().copied()) else { return };
    let lines = 1 + bytes.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count();
    for pens in [Pens::ByLayer, Pens::ByLayerNumber, Pens::ByColour] {
        let options = ReadOptions { tolerance_mm: 0.1, pens, ..ReadOptions::default() };
        for item in drawing.plot_ops(options).take(MOST_OPS) {
            match item {
                Ok(op) => {
                    assert!(op.target().is_none_or(|to| to.is_finite()), "{op:?}");
                    if let PlotOp::DrawArc { centre, sweep_rad, .. } = op {
                        assert!(centre.is_finite() && sweep_rad.abs() <= std::f64::consts::TAU, "{op:?}");
                    }
                }
                Err(error) => {
                    assert!(error.line as usize <= lines, "{error}");
                    assert!(!error.to_string().is_empty());
                }
            }
        }
    }
});
