//! A small drawing in its frames, as a picture that one can look at: `tests/golden/split.svg`.

use plotter_motion::{PlotOp, Point};
use plotter_stitch::{FrameLayout, split::FramePasses};
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

/// Across borders at y = 100 and 200: a zigzag with a corner on one, a line that crosses it there, circles, a
/// dot on a border, a stroke that ends just behind one.
fn drawing() -> Vec<PlotOp> {
    // Written as it lies along the paper: way, then place across it.
    let travel = |y, x| PlotOp::Travel { to: Point::new(x, y) };
    let line = |y, x| PlotOp::Draw { to: Point::new(x, y), feed_mm_s: None };
    let arc = |cy, cx, sweep_rad, y, x| PlotOp::DrawArc {
        centre: Point::new(cx, cy),
        sweep_rad,
        to: Point::new(x, y),
        feed_mm_s: None,
    };
    vec![
        travel(20.0, 20.0),
        line(60.0, 60.0),
        line(100.0, 20.0),
        line(140.0, 60.0),
        line(180.0, 20.0),
        line(220.0, 60.0),
        line(280.0, 20.0),
        travel(20.0, 40.0),
        line(280.0, 42.0),
        travel(130.0, 100.0),
        arc(100.0, 100.0, TAU, 130.0, 100.0),
        travel(170.0, 100.0),
        arc(200.0, 100.0, -PI, 230.0, 100.0),
        travel(200.0, 80.0),
        line(200.0, 80.0),
        travel(60.0, 80.0),
        line(104.0, 82.0),
    ]
}

fn picture() -> String {
    let layout = FrameLayout { frame_mm: 100.0, width_mm: 140.0, window_mm: 8.0, ..FrameLayout::default() };
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 -300 140 300\" width=\"420\" height=\"900\">\n\
         <rect y=\"-300\" width=\"140\" height=\"300\" fill=\"#fff\"/>\n\
         <path d=\"M0 -100H140M0 -200H140\" stroke=\"#ccc\" stroke-dasharray=\"2 2\"/>\n",
    );
    let drawing = drawing();
    for (frame, colour) in
        FramePasses::new(|| drawing.iter().copied(), layout).zip(["#1565c0", "#c62828", "#2e7d32"])
    {
        let frame = frame.unwrap();
        let mut path = String::new();
        for op in frame.sheet_ops() {
            let _ = match op {
                PlotOp::Travel { to } => write!(path, "M{:.2} {:.2}", to.x, -to.y),
                PlotOp::Draw { to, .. } => write!(path, "L{:.2} {:.2}", to.x, -to.y),
                PlotOp::DrawArc { centre, sweep_rad, to, .. } => {
                    let radius = to.distance(centre);
                    let (large, sense) = (u8::from(sweep_rad.abs() > PI), u8::from(sweep_rad < 0.0));
                    write!(path, "A{radius:.2} {radius:.2} 0 {large} {sense} {:.2} {:.2}", to.x, -to.y)
                }
                _ => Ok(()),
            };
        }
        let _ = writeln!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\" stroke-linecap=\"round\"/>"
        );
        for place in frame.end_breaks() {
            let _ = writeln!(
                svg,
                "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"3\" fill=\"none\" stroke=\"#333\" stroke-width=\"0.5\"/>",
                place.x, -place.y
            );
        }
    }
    svg.push_str("</svg>\n");
    svg
}

/// After a change that is meant: look at the picture, and write it anew with
/// `BLESS=1 cargo test --test all golden_split::`.
#[test]
fn a_small_drawing_is_cut_as_the_picture_shows() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/split.svg");
    let picture = picture();
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(path, &picture).unwrap();
    }
    assert_eq!(picture, std::fs::read_to_string(path).unwrap());
}
