//! Real G-code files, where a collection of them lies beside the checkout: each is read to its end.

use plotter_motion::gcode::{Detection, DwellUnit, Error, PenConvention, plot_ops};
use plotter_motion::{PlotOp, Point, Segment, chords};
use std::path::PathBuf;
use std::{fs, io};

fn collection() -> Option<PathBuf> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/real/gcode"));
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: there is no collection of real files beside the checkout");
    None
}

fn read(name: &str) -> io::Result<Option<Vec<u8>>> {
    collection().map(|folder| fs::read(folder.join(name))).transpose()
}

/// Operations, and what was reported.
fn split(text: &[u8]) -> (Vec<PlotOp>, Vec<Error>) {
    let (ops, reports): (Vec<_>, Vec<_>) = plot_ops(text).partition(Result::is_ok);
    (ops.into_iter().flatten().collect(), reports.into_iter().filter_map(Result::err).collect())
}

#[test]
fn every_real_file_is_read_without_an_error() -> io::Result<()> {
    let Some(folder) = collection() else { return Ok(()) };
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    files.sort();
    for file in files {
        let text = fs::read(&file)?;
        let (ops, reports) = split(&text);
        let count = |kind: fn(&PlotOp) -> bool| ops.iter().filter(|op| kind(op)).count();
        println!(
            "{}: {:?}: {} travels, {} lines, {} arcs, {} dwells, reports {:#?}",
            file.display(),
            Detection::of(text.iter().copied()).options().pen,
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
fn the_owl_is_a_unicorns_and_has_all_its_strokes() -> io::Result<()> {
    let Some(text) = read("unicorn_owl.gcode")? else { return Ok(()) };
    let options = Detection::of(text.iter().copied()).options();
    assert_eq!((options.pen, options.dwell_unit), (PenConvention::UNICORN, DwellUnit::Milliseconds));
    let (ops, reports) = split(&text);
    // The pause after the test of the pen is not made; nothing else is missing.
    let reports: Vec<String> = reports.iter().map(ToString::to_string).collect();
    assert_eq!(reports, ["line 13, column 1 (byte 718): M1 (pause) is not supported and is left out"]);
    // As many strokes as the file has `(pen down)` after its test of the pen, which leaves a dot where it stands.
    let strokes = ops
        .windows(2)
        .filter(|pair| matches!(pair, [PlotOp::Travel { .. }, PlotOp::Draw { .. } | PlotOp::DrawArc { .. }]));
    let lowered = String::from_utf8_lossy(&text).lines().filter(|line| line.starts_with("M300 S30")).count();
    assert_eq!(strokes.count(), lowered - 1);
    assert_eq!(ops.first(), Some(&PlotOp::Draw { to: Point::ORIGIN, feed_mm_s: None }));
    assert_eq!(ops.last(), Some(&PlotOp::Travel { to: Point::ORIGIN }));
    Ok(())
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
fn a_drawing_in_chords_and_the_same_in_arcs_agree() -> io::Result<()> {
    // Measured: 0.0053 mm. Both are made from the same curves with a tolerance, and rounded to 0.001 mm.
    const TOLERANCE_MM: f64 = 0.01;
    let (Some(lines), Some(arcs)) =
        (read("svg2gcode_smooth_curves.gcode")?, read("svg2gcode_smooth_curves_arcs.gcode")?)
    else {
        return Ok(());
    };
    let (lines, arcs) = (marks(&lines), marks(&arcs));
    let (there, back) = (farthest_mm(&lines, &arcs), farthest_mm(&arcs, &lines));
    println!("{} lines, {} chords of arcs: {there:.4} mm and {back:.4} mm apart", lines.len(), arcs.len());
    assert!(there < TOLERANCE_MM && back < TOLERANCE_MM, "{there} mm, {back} mm");
    Ok(())
}
