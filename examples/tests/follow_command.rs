//! The commands `follow` and `calibrate_camera`: what they write and measure, and what they say to bad input.
#![allow(clippy::unwrap_used, reason = "a test fails by a panic")]

mod built_example;

use built_example::{complaint, data, run_example};
use serde_json::Value;

fn picture(folder: &tempfile::TempDir, name: &str, is_ink: impl Fn(u32, u32) -> bool) -> String {
    let path = folder.path().join(name);
    let image = image::GrayImage::from_fn(400, 300, |x, y| image::Luma([if is_ink(x, y) { 0 } else { 255 }]));
    image.save(&path).unwrap();
    path.to_str().unwrap().to_owned()
}

/// A ring, a cross in it, and a line of its own.
fn drawing(x: u32, y: u32) -> bool {
    let (dx, dy) = (f64::from(x) - 150.0, f64::from(y) - 150.0);
    let radius = dx.hypot(dy);
    (radius - 100.0).abs() < 2.5
        || (radius < 100.0 && (dx.abs() < 2.0 || dy.abs() < 2.0))
        || ((330..334).contains(&x) && (40..260).contains(&y))
}

#[test]
fn a_drawing_is_followed_and_every_file_written() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", drawing);
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (svg, page, report) = (file("f.svg"), file("f.html"), file("f.json"));
    let arguments =
        [&image, "--camera", "size=160", "--svg", &svg, "--animation", &page, "--report", &report];
    let output = run_example("follow", &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value: Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    assert_eq!(value["finished"], true);
    let number = |key: &str| value[key].as_f64().unwrap();
    assert!(number("coverage") > 0.99 && number("rms_px") < 0.5 && number("repeated") < 0.03, "{output:?}");
    assert!(
        number("windows") > 50.0
            && number("moves") <= number("windows")
            && number("max_px") >= number("rms_px")
    );
    assert!(value["path_points"].as_array().unwrap().len() > 800);
    assert!(std::fs::read_to_string(&svg).unwrap().contains("<polyline"));
    assert!(std::fs::read_to_string(&page).unwrap().contains("requestAnimationFrame"));
}

#[test]
fn the_published_follower_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let image = picture(&folder, "drawing.png", drawing);
    let output =
        run_example("follow", &[&image, "--method", "published", "--hand", "left", "--windows", "20"]);
    assert!(output.status.success());
    assert!(String::from_utf8(output.stdout).unwrap().contains("stopped after 20 windows"));
}

#[test]
fn bad_input_is_told_in_a_line() {
    let folder = tempfile::tempdir().unwrap();
    let white = picture(&folder, "white.png", |_, _| false);
    assert!(complaint("follow", &[&white]).contains("no line in view at"));
    assert!(complaint("follow", &["missing.png"]).contains("missing.png: cannot be read"));
    assert!(complaint("calibrate_camera", &[&white]).contains("0 crossings of lines"));
    assert!(complaint("calibrate_camera", &[&data("flag.png")]).contains("flag.png: "));
    let output = run_example("follow", &["--camera", "blurr=2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("none of blur, noise, rim, barrel, size"));
}

#[test]
fn a_grid_calibrates_the_simulated_camera() {
    let output = run_example("calibrate_camera", &["--barrel", "0.05"]);
    let text = String::from_utf8(output.stdout).unwrap();
    let pitch = text.split("pitch ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    let pitch_px: f64 = pitch.parse().unwrap();
    assert!(output.status.success() && (pitch_px - 20.0).abs() < 0.1, "{text}");
}
