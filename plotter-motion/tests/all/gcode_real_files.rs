//! G-code files in the manner of programs, and of programs where they are at hand: each is read to its end.

use crate::real_files::{all, other, ours};
use plotter_motion::gcode::{Detection, DwellUnit, Error, PenConvention, plot_ops};
use plotter_motion::{PlotOp, Point, Segment, toolpath::chords};
use std::path::PathBuf;
use std::{fs, io};

/// A file of ours by its name.
fn our(name: &str) -> PathBuf {
    ours("gcode").into_iter().find(|file| file.ends_with(name)).unwrap()
}

/// Operations, and what was reported.
fn split(text: &[u8]) -> (Vec<PlotOp>, Vec<Error>) {
    let (ops, reports): (Vec<_>, Vec<_>) = plot_ops(text).partition(Result::is_ok);
    (ops.into_iter().flatten().collect(), reports.into_iter().filter_map(Result::err).collect())
}

#[test]
fn every_real_file_is_read_without_an_error() -> io::Result<()> {
    for file in all("gcode") {
        let text = fs::read(&file)?;
        let (ops, reports) = split(&text);
        let count = |kind: fn(&PlotOp) -> bool| ops.iter().filter(|op| kind(op)).count();
        println!(
            "{}: {:?}: {} travels, {} lines, {} arcs, {} dwells, reports {:#?}",
            file.display(),
            Detection::from_bytes(text.iter().copied()).options().pen,
            count(|op| matches!(op, PlotOp::Travel { .. })),
            count(|op| matches!(op, PlotOp::Draw { .. })),
            count(|op| matches!(op, PlotOp::DrawArc { .. })),
            count(|op| matches!(op, PlotOp::Dwell { .. })),
            reports.iter().map(ToString::to_string).collect::<Vec<_>>(),
        );
        assert!(reports.iter().all(Error::is_notice), "{}: {reports:?}", file.display());
    }
    Ok(())
}

#[test]
fn a_unicorns_drawing_has_all_its_strokes() -> io::Result<()> {
    let owl = other("gcode", "unicorn_owl.gcode").map(|file| (file, 13, 718));
    for (file, line, byte) in [Some((our("stars.gcode"), 11, 195)), owl].into_iter().flatten() {
        has_all_its_strokes(&fs::read(file)?, line, byte);
    }
    Ok(())
}

/// `line` and `byte` are where it waits after its test of the pen.
fn has_all_its_strokes(text: &[u8], line: usize, byte: usize) {
    let options = Detection::from_bytes(text.iter().copied()).options();
    assert_eq!((options.pen, options.dwell_unit), (PenConvention::UNICORN, DwellUnit::Milliseconds));
    let (ops, reports) = split(text);
    // The pause after the test of the pen is not made; nothing else is missing.
    let reports: Vec<String> = reports.iter().map(ToString::to_string).collect();
    assert_eq!(
        reports,
        [format!(
            "line {line}, column 1 (byte {byte}): M1 (pause: Was registration test successful?) is not supported and is left out"
        )]
    );
    // As many strokes as the file has `(pen down)` after its test of the pen, which leaves a dot where it
    // stands.
    let strokes = ops
        .windows(2)
        .filter(|pair| matches!(pair, [PlotOp::Travel { .. }, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }]));
    let lowered = String::from_utf8_lossy(text).lines().filter(|line| line.starts_with("M300 S30")).count();
    assert_eq!(strokes.count(), lowered - 1);
    assert_eq!(ops.first(), Some(&PlotOp::Draw { to: Point::ORIGIN, feed_mm_s: None }));
    assert_eq!(ops.last(), Some(&PlotOp::Travel { to: Point::ORIGIN }));
}

/// What a drawing leaves on the sheet, as lines.
fn marks(text: &[u8]) -> Vec<Segment> {
    const CHORD_MM: f64 = 0.001;
    let (ops, _) = split(text);
    let mut at = Point::ORIGIN;
    let mut marks = Vec::new();
    for op in chords(ops, CHORD_MM) {
        if let (PlotOp::Draw { .. }, Some(to)) = (op, op.target()) {
            marks.push(Segment::new(at, to));
        }
        at = op.target().unwrap_or(at);
    }
    marks
}

/// How far the ends and middles of these lines are from those, at most, mm.
fn farthest_mm(from: &[Segment], to: &[Segment]) -> f64 {
    let near = |place: Point| to.iter().map(|line| line.distance(place)).fold(f64::INFINITY, f64::min);
    let places = from.iter().flat_map(|line| [line.to, line.from.lerp(line.to, 0.5)]);
    places.map(near).fold(0.0, f64::max)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_drawing_in_chords_and_the_same_in_arcs_agree() -> io::Result<()> {
    // Measured: 0.0053 mm. Both are made from the same curves with a tolerance, and rounded to 0.001 mm.
    const TOLERANCE_MM: f64 = 0.01;
    let ours = [our("waves.gcode"), our("waves_arcs.gcode")];
    let others = ["svg2gcode_smooth_curves.gcode", "svg2gcode_smooth_curves_arcs.gcode"];
    for [lines, arcs] in [Some(ours), other_pair(others)].into_iter().flatten() {
        agree(&fs::read(lines)?, &fs::read(arcs)?, TOLERANCE_MM);
    }
    Ok(())
}

fn other_pair(names: [&str; 2]) -> Option<[PathBuf; 2]> {
    Some([other("gcode", names[0])?, other("gcode", names[1])?])
}

fn agree(lines: &[u8], arcs: &[u8], tolerance_mm: f64) {
    let (lines, arcs) = (marks(lines), marks(arcs));
    let (there, back) = (farthest_mm(&lines, &arcs), farthest_mm(&arcs, &lines));
    println!("{} lines, {} chords of arcs: {there:.4} mm and {back:.4} mm apart", lines.len(), arcs.len());
    assert!(!arcs.is_empty() && there < tolerance_mm && back < tolerance_mm, "{there} mm, {back} mm");
}
