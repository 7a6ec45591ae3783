//! What the tools say of a picture alike: how its ink was told, and that noise is no drawing.

use crate::built_example;

use built_example::{Folder, complaint, run_example};
use plotter_motion::SplitMix64;
use serde_json::Value;

fn picture(folder: &Folder, name: &str, mut level: impl FnMut(u32, u32) -> u8) -> String {
    let path = folder.file(name);
    image::GrayImage::from_fn(240, 200, |x, y| image::Luma([level(x, y)])).save(&path).unwrap();
    path
}

/// A frame and a slope.
fn is_line(x: u32, y: u32) -> bool {
    let inside = (30..210).contains(&x) && (30..170).contains(&y);
    let frame = inside && !((34..206).contains(&x) && (34..166).contains(&y));
    frame || (inside && x.abs_diff(y + 40) < 3)
}

fn assumed(report: &str) -> Vec<String> {
    let value: Value = serde_json::from_str(&std::fs::read_to_string(report).unwrap()).unwrap();
    let lines = value["assumed"].as_array().unwrap();
    lines.iter().map(|line| line.as_str().unwrap().to_owned()).collect()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_tool_tells_how_ink_was_told_in_its_table_and_in_its_report() {
    let folder = Folder::new();
    let dark = picture(&folder, "dark.png", |x, y| if is_line(x, y) { 30 } else { 240 });
    // Paper at the right is darker than ink at the left.
    let shaded = picture(&folder, "shaded.png", |x, y| {
        let paper = 250 - x;
        u8::try_from(if is_line(x, y) { paper / 2 } else { paper }).unwrap()
    });
    for (image, says) in [(&dark, "ink: dark: levels up to "), (&shaded, "ink: dark, ")] {
        let (plot, report) = (folder.file("plot"), folder.file("r.json"));
        let in_plot = folder.file("plot/report.json");
        for (tool, options, written) in [
            ("trace", vec!["--report", &report], &report),
            ("plot", vec!["--out", &plot], &in_plot),
            ("max_error", vec!["--max-error-mm", "0.4", "--report", &report], &report),
            ("follow", vec!["--report", &report], &report),
        ] {
            let output = run_example(tool, &[&[image.as_str()], &options[..]].concat());
            assert!(output.status.success(), "{tool} {image}: {output:?}");
            let table = String::from_utf8(output.stdout).unwrap();
            assert!(table.lines().any(|line| line.trim_start().starts_with("ink")), "{tool}: {table}");
            assert!(
                assumed(written).iter().any(|line| line.starts_with(says)),
                "{tool}: {:?}",
                assumed(written)
            );
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn light_lines_are_followed_as_dark_ones_are_and_it_is_said() {
    let folder = Folder::new();
    let (dark, light) = (
        picture(&folder, "dark.png", |x, y| if is_line(x, y) { 30 } else { 240 }),
        picture(&folder, "light.png", |x, y| if is_line(x, y) { 225 } else { 15 }),
    );
    let report = folder.file("r.json");
    let of = |image: &str| -> Value {
        let output = run_example("follow", &[image, "--camera", "rim=1", "--report", &report]);
        assert!(output.status.success(), "{output:?}");
        serde_json::from_str(&std::fs::read_to_string(&report).unwrap()).unwrap()
    };
    let (one, other) = (of(&dark), of(&light));
    // The levels are the same, once dark and light are exchanged.
    for key in ["windows", "strokes", "coverage", "finished"] {
        assert_eq!(one[key], other[key], "{key}");
    }
    assert!(one["coverage"].as_f64().unwrap() > 0.98, "{one}");
    assert!(assumed(&report).iter().any(|line| line.starts_with("seen: with dark and light exchanged")));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn noise_is_no_success_of_any_tool_and_what_helps_is_said() {
    let folder = Folder::new();
    let mut random = SplitMix64::new(4);
    let noise = picture(&folder, "noise.png", |_, _| if random.unit() < 0.05 { 0 } else { 255 });
    let plot = folder.file("plot");
    for (tool, options, helps) in [
        ("trace", vec![], "--min-stroke 0 keeps every stroke"),
        ("plot", vec!["--out", plot.as_str()], "[vectorize]"),
        ("max_error", vec![], "[vectorize]"),
        ("follow", vec![], "plotter trace --ink"),
    ] {
        let said = complaint(tool, &[&[noise.as_str()], &options[..]].concat());
        assert!(said.contains("this is noise: ") && said.contains(helps), "{tool}: {said}");
    }
    // Who means it gets it.
    let meant = run_example("trace", &[&noise, "--min-stroke", "0"]);
    assert!(meant.status.success(), "{meant:?}");
    // An empty sheet is a success of trace, and said.
    let blank = picture(&folder, "blank.png", |_, _| 250);
    let output = run_example("trace", &[&blank]);
    let table = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(output.status.success() && table.contains("none: the sheet is empty"), "{output:?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_follower_that_may_see_no_more_windows_says_which_option_allows_more() {
    let folder = Folder::new();
    let dark = picture(&folder, "dark.png", |x, y| if is_line(x, y) { 30 } else { 240 });
    let said = complaint("follow", &[&dark, "--windows", "5"]);
    assert!(said.contains("as many windows as allowed were seen") && said.contains("--windows N"), "{said}");
}
