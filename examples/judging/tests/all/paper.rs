//! A sheet on a table, straightened: its corners where they are, its strokes where they were drawn, and a
//! wrong map noticed.

use crate::built_example;

use built_example::{Folder, complaint, run_example};
use plotter_examples::shared::{PaperChoice, PaperOption, SizeOptions, Straightened, vectorized};
use plotter_judging::corpus::{Truth, all};
use plotter_judging::degraded::{Degraded, Drawn, Kind, Strength};
use plotter_vector::{PxPoint, Vectorizer, svg};
use serde_json::Value;
use std::sync::OnceLock;

/// Farthest that a corner may be off, px: half of what is asked of the median.
const CORNER_PX: f64 = 0.75;

/// From a place that is counted from a pixel's centre to one counted from its corner, px.
const CENTRE_PX: f64 = 0.5;

fn photograph(strength: Strength) -> Degraded {
    let sheet = || all().into_iter().find(|picture| picture.name == "techdraw_w3").unwrap();
    Drawn::new(sheet(), &sheet()).degraded(Kind::Perspective, strength, 4, 0).unwrap()
}

fn straightened(degraded: &Degraded) -> Straightened {
    let auto = PaperOption { paper: Some(PaperChoice::Auto) };
    auto.straightened(&degraded.file, 1, false, &SizeOptions::default()).unwrap().unwrap()
}

/// A photograph, the sheet that is found on it, and the strokes on that as `trace --paper` writes them.
struct Traced {
    degraded: Degraded,
    found: Straightened,
    svg: String,
}

/// That of the strength that is usual: tracing takes most of the time, so it is done once for all tests.
fn middle() -> &'static Traced {
    static MIDDLE: OnceLock<Traced> = OnceLock::new();
    MIDDLE.get_or_init(|| {
        let degraded = photograph(Strength::Middle);
        let found = straightened(&degraded);
        let (traced, _) = vectorized(&Vectorizer::default(), found.file.clone(), 1).unwrap();
        let mut text = String::new();
        svg(&traced.drawing, 1.0, &mut text).unwrap();
        let svg = text.replacen("<svg ", &format!("<svg {} ", found.paper.svg_attributes()), 1);
        Traced { degraded, found, svg }
    })
}

fn figures(svg: &str, truth: &str) -> Value {
    let output = run_example("judge", &[svg, "--truth", truth, "--report", "-"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    report[0]["figures"].clone()
}

fn true_corners(truth: &Truth) -> [PxPoint; 4] {
    let (width, height) = (f64::from(truth.width), f64::from(truth.height));
    [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)].map(|(x, y)| {
        let seen = truth.view.unwrap().homography.apply(PxPoint::new(x, y)).unwrap();
        PxPoint::new(seen.x + CENTRE_PX, seen.y + CENTRE_PX)
    })
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn strokes_of_a_straightened_sheet_lie_where_they_were_drawn() {
    let folder = Folder::new();
    let Traced { degraded, svg, .. } = middle();
    let truth = folder.write("truth.json", serde_json::to_string(&degraded.truth).unwrap());
    let of = figures(&folder.write("traced.svg", svg), &truth);
    let figure = |of: &Value, name: &str| of[name].as_f64().unwrap();
    let (recall, precision) = (figure(&of, "recall_1_5_px"), figure(&of, "precision_1_5_px"));
    println!("recall {recall:.4}, precision {precision:.4}");
    assert!(recall > 0.98 && precision > 0.97, "{of}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn corners_of_a_sheet_are_found_where_they_are() {
    for strength in Strength::ALL {
        let degraded = photograph(strength);
        let found = straightened(&degraded);
        for (corner, wanted) in found.paper.quad.corners.iter().zip(true_corners(&degraded.truth)) {
            let off_px = corner.distance(wanted);
            assert!(off_px < CORNER_PX, "{strength:?}: {corner:?} is {off_px:.2} px off");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_wrong_map_is_noticed() {
    let folder = Folder::new();
    let Traced { degraded, found, svg: text } = middle();
    let truth = folder.write("truth.json", serde_json::to_string(&degraded.truth).unwrap());
    let [[_, _, right], [_, _, down], _] = found.paper.sheet.to_picture().0;
    // Four pixels to the right and up: lines in both directions are missed by as much.
    let moved = text.replacen(&format!(" {right} "), &format!(" {} ", right + 4.0), 1);
    let moved = moved.replacen(&format!(" {down} "), &format!(" {} ", down - 4.0), 1);
    assert_ne!(moved, *text);
    let of = figures(&folder.write("moved.svg", &moved), &truth);
    assert!(of["recall_1_5_px"].as_f64().unwrap() < 0.5, "{of}");
    // Without it the sheet is taken for the picture.
    let without = text.replacen("data-homography", "data-nothing", 1);
    let of = figures(&folder.write("without.svg", &without), &truth);
    assert!(of["recall_1_5_px"].as_f64().unwrap() < 0.5, "{of}");
    // That of another picture is none of this one.
    let other = text.replacen("data-picture=\"", "data-picture=\"1", 1);
    assert!(
        complaint("judge", &[&folder.write("other.svg", &other), "--truth", &truth])
            .contains("out of a picture")
    );
    let broken = text.replacen("data-homography=\"", "data-homography=\"nothing ", 1);
    let said = complaint("judge", &[&folder.write("broken.svg", &broken), "--truth", &truth]);
    assert!(said.contains("data-homography"), "{said}");
}
