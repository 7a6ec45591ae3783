//! Drawings through all languages and back: SVG, G-code, SVG, HPGL, SVG.

use crate::built_example::{Folder, run_example};
use plotter_examples::drawings::{DrawingFile, Reading};
use plotter_motion::{PlotOp, Point, Segment, toolpath::chords};
use std::fmt::Write as _;
use std::path::Path;

/// Half a plotter unit in both axes, half of the last digit in G-code and SVG, and what chords of arcs leave, mm.
const ALLOWED_MM: f64 = 0.5 * 0.025 * std::f64::consts::SQRT_2 + 0.5e-3 * std::f64::consts::SQRT_2 + 0.002;

fn strokes(path: &str) -> Vec<Vec<Point>> {
    let file = DrawingFile::open(Path::new(path), None).unwrap();
    let ops = file.ops(Reading::default()).unwrap().filter_map(Result::ok);
    let mut strokes: Vec<Vec<Point>> = Vec::new();
    for op in chords(ops, 0.001) {
        match op {
            PlotOp::Travel { to } => strokes.push(vec![to]),
            PlotOp::Draw { to, .. } => {
                if strokes.is_empty() {
                    strokes.push(vec![Point::ORIGIN]);
                }
                strokes.last_mut().unwrap().push(to);
            }
            _ => {}
        }
    }
    strokes.retain(|stroke| stroke.len() > 1);
    strokes
}

fn length_mm(strokes: &[Vec<Point>]) -> f64 {
    strokes.iter().flat_map(|stroke| stroke.windows(2)).map(|pair| pair[0].distance(pair[1])).sum()
}

/// The greatest distance of a place of one drawing from the stroke of the other that was made of it, either way.
fn difference_mm(one: &[Vec<Point>], other: &[Vec<Point>]) -> f64 {
    let away = |from: &[Vec<Point>], to: &[Vec<Point>]| {
        let mut most: f64 = 0.0;
        for (from, to) in from.iter().zip(to) {
            for pair in from.windows(2) {
                for at in [pair[0], pair[0].lerp(pair[1], 0.5), pair[1]] {
                    let near = to.windows(2).map(|line| Segment::new(line[0], line[1]).distance(at));
                    most = most.max(near.fold(f64::INFINITY, f64::min));
                }
            }
        }
        most
    };
    away(one, other).max(away(other, one))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn six_drawings_come_back_as_they_went() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut table = String::from(
        "drawing                                              strokes  length mm  back mm  difference mm\n",
    );
    for name in [
        "plotter-motion/tests/data/gcode/stars.gcode",
        "plotter-motion/tests/data/gcode/waves.gcode",
        "plotter-motion/tests/data/gcode/waves_arcs.gcode",
        "plotter-motion/tests/data/hpgl/plan.plt",
        "docs/pictures/tune.svg",
        "plotter-stitch/tests/golden/split.svg",
    ] {
        let folder = Folder::new();
        let mut file = root.join(name).to_str().unwrap().to_owned();
        let mut first = String::new();
        for next in ["1.svg", "2.gcode", "3.svg", "4.plt", "5.svg"] {
            let to = folder.file(next);
            let output = run_example("convert", &[&file, &to]);
            assert!(output.status.success(), "{name}, {next}: {}", String::from_utf8_lossy(&output.stderr));
            first = if first.is_empty() { to.clone() } else { first };
            file = to;
        }
        let (before, after) = (strokes(&first), strokes(&file));
        let (went_mm, back_mm) = (length_mm(&before), length_mm(&after));
        let difference_mm = difference_mm(&before, &after);
        let _ =
            writeln!(table, "{name:52} {:7} {went_mm:10.1} {back_mm:8.1} {difference_mm:14.4}", before.len());
        assert_eq!(before.len(), after.len(), "{name}\n{table}");
        assert!(difference_mm <= ALLOWED_MM, "{name}\n{table}");
    }
    println!("{table}");
}
