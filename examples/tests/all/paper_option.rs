//! `--paper`: the sheet that a photograph shows, straightened in the tools.

use crate::built_example;
use crate::picture_files::extent_mm;

use built_example::{Folder, complaint, data, run_example};
use plotter_vector::{PxPoint, picture::Homography};
use serde_json::Value;

/// A sheet of 200 x 150 mm, in a picture of 500 x 420 px.
const SHEET_MM: (f64, f64) = (200.0, 150.0);
const WIDTH: u32 = 500;
const HEIGHT: u32 = 420;
const CORNERS: [(f64, f64); 4] = [(70.0, 60.0), (430.0, 45.0), (460.0, 370.0), (40.0, 350.0)];

/// On it an ell of lines 2 mm wide: 120 mm to the right and 80 mm down.
fn is_ink(x: f64, y: f64) -> bool {
    let near = |at: f64, line: f64| (at - line).abs() < 1.0;
    (near(y, 30.0) && (39.0..161.0).contains(&x)) || (near(x, 160.0) && (29.0..111.0).contains(&y))
}

/// The sheet on a table; with another line, which reaches over its right edge, if asked for.
fn photograph(reaches_over: bool) -> Vec<u8> {
    let corners = CORNERS.map(|(x, y)| PxPoint::new(x, y));
    let back = Homography::of_quadrilateral(SHEET_MM, corners).unwrap().inverse().unwrap();
    let level = |x: f64, y: f64| {
        let at = back.apply(PxPoint::new(x, y)).unwrap();
        let on_sheet = (0.0..SHEET_MM.0).contains(&at.x) && (0.0..SHEET_MM.1).contains(&at.y);
        let over = reaches_over && (at.y - 130.0).abs() < 1.0 && at.x > 100.0;
        if on_sheet && (is_ink(at.x, at.y) || over) {
            40.0
        } else if on_sheet {
            230.0
        } else {
            100.0
        }
    };
    let mut file = format!("P5 {WIDTH} {HEIGHT} 255\n").into_bytes();
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let rays = [0.25, 0.75].map(|down| [0.25, 0.75].map(|across| (across, down)));
            let sum: f64 = rays
                .as_flattened()
                .iter()
                .map(|(across, down)| level(f64::from(x) + across, f64::from(y) + down))
                .sum();
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a level")]
            file.push((sum / 4.0) as u8);
        }
    }
    file
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_sheet_of_known_size_is_drawn_in_its_true_size() {
    let folder = Folder::new();
    let picture = folder.write("sheet.pgm", photograph(false));
    let (plt, svg, report) = (folder.file("a.plt"), folder.file("a.svg"), folder.file("a.json"));
    let steps = folder.file("steps");
    // The sides as they are written or the other way around: which is which is seen.
    for asked in ["200x150", "150x200"] {
        let output = run_example(
            "trace",
            &[
                &picture,
                "--paper",
                asked,
                "--hpgl",
                &plt,
                "--svg",
                &svg,
                "--report",
                &report,
                "--explain",
                &steps,
            ],
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("as asked by --paper") && said.contains("homography"), "{said}");
        let [across_mm, down_mm] = extent_mm(&plt);
        // Half a pixel of 0.55 mm.
        assert!(
            (across_mm - 120.0).abs() < 0.28 && (down_mm - 80.0).abs() < 0.28,
            "{across_mm} x {down_mm} mm"
        );
    }
    let report: Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    let paper = &report["paper"];
    assert_eq!(paper["picture_px"], serde_json::json!([WIDTH, HEIGHT]));
    let corners: Vec<[f64; 2]> = serde_json::from_value(paper["corners_px"].clone()).unwrap();
    for ([x, y], corner) in corners.into_iter().zip(CORNERS) {
        assert!((x - corner.0).hypot(y - corner.1) < 0.3, "({x}, {y}) in place of {corner:?}");
    }
    // The map leads from the sheet's middle to where the diagonals cross in the picture.
    let homography: Homography =
        serde_json::from_value::<[[f64; 3]; 3]>(paper["homography"].clone()).map(Homography).unwrap();
    let side = |name: &str| paper[name].as_f64().unwrap();
    let middle = homography.apply(PxPoint::new(side("width_px") / 2.0, side("height_px") / 2.0)).unwrap();
    let true_map = Homography::of_quadrilateral(SHEET_MM, CORNERS.map(|(x, y)| PxPoint::new(x, y))).unwrap();
    let wanted = true_map.apply(PxPoint::new(100.0, 75.0)).unwrap();
    assert!(middle.distance(wanted) < 0.5, "{middle:?} in place of {wanted:?}");
    let svg = std::fs::read_to_string(&svg).unwrap();
    assert!(svg.contains("data-homography=\"") && svg.contains("data-picture=\"500 420\""), "{svg:.300}");
    for step in ["0-sides.png", "1-straightened.png", "3-ink.png"] {
        assert!(std::path::Path::new(&steps).join(step).is_file(), "{step}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_runs_over_the_edge_and_what_is_no_sheet_is_said() {
    let folder = Folder::new();
    let picture = folder.write("sheet.pgm", photograph(true));
    let output = run_example("trace", &[&picture, "--paper", "auto"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.contains("at its edge") && said.contains("1 stroke runs to the sheet's edge"), "{said}");
    // Of a scan nothing is straightened: it is traced, and the status is not that of a success.
    let svg = folder.file("flag.svg");
    let said = complaint("trace", &[&data("flag.png"), "--paper", "auto", "--quiet", "--svg", &svg]);
    assert!(said.contains("--paper: no edge of a light sheet"), "{said}");
    let text = std::fs::read_to_string(&svg).unwrap();
    assert!(text.contains("<polyline") && !text.contains("data-homography"), "{text:.300}");
    // None is as without.
    let none = folder.file("none.svg");
    assert!(run_example("trace", &[&data("flag.png"), "--paper", "none", "--svg", &none]).status.success());
    assert_eq!(std::fs::read_to_string(&none).unwrap(), text);
    // A machine draws nothing of what nobody meant.
    let out = folder.file("plotted");
    let said = complaint("plot", &[&data("flag.png"), "--paper", "a4", "--out", &out]);
    assert!(said.contains("--paper: no edge"), "{said}");
    assert!(!std::path::Path::new(&out).exists());
}

#[test]
fn sizes_that_are_none_are_wrong_use() {
    for bad in ["a9", "0x5", "210", "nanx3", ""] {
        let output = run_example("trace", &[&data("flag.png"), "--paper", bad]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{bad}: {said}");
        assert!(said.contains("--paper") && (bad.is_empty() || said.contains("210x297")), "{bad}: {said}");
    }
    let said = complaint("trace", &[&data("flag.png"), "--paper", "a4", "--width-mm", "100"]);
    assert!(said.contains("--paper and --width-mm"), "{said}");
}
