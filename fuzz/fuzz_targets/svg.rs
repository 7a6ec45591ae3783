//! Any bytes read as SVG, in each way: no panic, no place that is none, and no more vertices than are
//! allowed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use plotter_vector::{SvgOptions, read_svg, svg_in::SvgPens};

/// Vertices after which a file has shown what it can do.
const MOST_VERTICES: usize = 20_000;

fuzz_target!(|bytes: &[u8]| {
    // The first byte chooses how the others are read.
    let Some((how, bytes)) = bytes.split_first() else { return };
    let pens = [SvgPens::ByColour, SvgPens::ByLayer, SvgPens::ByOrder, SvgPens::One];
    let options = SvgOptions::default()
        .with_arcs(how & 1 != 0)
        .with_keeps_clipped(how & 2 != 0)
        .with_occludes(how & 4 != 0)
        .with_pens(pens[usize::from(how >> 3) % pens.len()])
        .with_paper(None)
        .with_max_vertices(MOST_VERTICES);
    match read_svg(bytes, &options) {
        Ok(read) => {
            assert!(read.drawing.vertices() <= MOST_VERTICES);
            assert!(read.drawing.strokes().flatten().all(|at| at.x.is_finite() && at.y.is_finite()));
            let strokes = read.drawing.strokes().len();
            assert!(read.layers.iter().filter_map(|layer| layer.first_stroke).all(|first| first < strokes));
            assert!(read.problems.iter().all(|problem| problem.line > 0 && problem.column > 0));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
