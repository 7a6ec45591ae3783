//! The command `trace`: what it writes, and what it says to bad input.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by a panic and prints its table")]

mod built_example;

use built_example::{complaint, data, run_example};

#[test]
fn all_files_are_written_and_the_report_has_all_keys() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (svg, plt, points, json, plot) =
        (file("a.svg"), file("a.plt"), file("a.txt"), file("a.json"), file("b.svg"));
    let options =
        ["--svg", &svg, "--hpgl", &plt, "--points", &points, "--report", &json, "--error-plot", &plot];
    assert!(run_example("trace", &options).status.success());
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    let report: serde_json::Value = serde_json::from_str(&read(&json)).unwrap();
    let keys = [
        "vertices",
        "strokes",
        "mean_px",
        "max_px",
        "sd_px",
        "histogram",
        "pen_down_px",
        "pen_up_px",
        "time_ms",
        "peak_rss_mb",
    ];
    assert!(keys.iter().all(|key| report.get(key).is_some()), "{report}");
    let vertices = report["vertices"].as_u64().unwrap();
    assert_eq!(read(&points).lines().filter(|line| !line.is_empty()).count() as u64, vertices);
    assert!(read(&svg).contains("viewBox=\"0 0 1014 673\""));
    assert!(read(&plt).starts_with("IN;\nSP1;\nPU"));
    assert!(read(&plot).contains("distance of a pixel from its segment, px"));
}

#[test]
fn the_help_names_the_greatest_error_that_is_taken() {
    let help = String::from_utf8(run_example("trace", &["--help"]).stdout).unwrap();
    let default = plotter_vector::Bounded::default().tolerance_px;
    assert!(help.contains(&format!("(ours only) [default: {default}]")), "{help}");
}

#[test]
fn the_published_algorithm_refuses_a_greatest_error() {
    let said = complaint("trace", &["--algorithm", "published", "--max-error-px", "1"]);
    assert!(said.contains("has no error bound; take --algorithm ours"), "{said}");
}

#[test]
fn a_greatest_error_that_is_no_distance_is_refused() {
    for bad in ["0", "-1", "NaN", "inf"] {
        let said = complaint("trace", &[&data("flag.png"), "--max-error-px", bad]);
        assert!(said.contains("is not a positive number; 0.5 is half a pixel"), "{said}");
    }
}

#[test]
fn files_that_cannot_be_read_or_written_are_named() {
    assert!(
        complaint("trace", &["no/such/picture.png"])
            .starts_with("trace: no/such/picture.png: cannot be read")
    );
    assert!(
        complaint("trace", &[&data("flag.png"), "--svg", "/no/such/directory/a.svg"])
            .contains("a.svg: cannot be written")
    );
}

#[test]
fn bad_pictures_get_one_line_and_blank_ones_an_empty_drawing() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| {
        let path = directory.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let whole = std::fs::read(data("flag.png")).unwrap();
    assert!(complaint("trace", &[&file("empty.png", b"")]).contains("0 bytes"));
    assert!(
        complaint("trace", &[&file("cut.png", &whole[..whole.len() / 2])]).contains("damaged or cut off")
    );
    assert!(complaint("trace", &[&file("huge.pgm", b"P5 90000 90000 255\n")]).contains("too large"));
    let folder = directory.path().to_str().unwrap();
    assert!(complaint("trace", &[folder]).contains("cannot be read"));
    assert!(complaint("trace", &[&data("flag.png"), "--svg", folder]).contains("cannot be written"));
    assert!(complaint("trace", &[&file("text.png", b"hello")]).contains("is not PNG"));
    for (name, blank) in [("dot", "P1 1 1\n1"), ("white", "P1 3 2\n000000"), ("black", "P1 3 2\n111111")] {
        let output = run_example("trace", &[&file(name, blank.as_bytes())]);
        assert!(output.status.success(), "{name}");
        assert!(String::from_utf8(output.stdout).unwrap().contains("(an empty sheet)"), "{name}");
    }
}

#[test]
fn the_centre_of_the_lower_left_pixel_is_the_origin_of_the_plotter_file() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (picture, plt) = (file("line.pbm"), file("line.plt"));
    std::fs::write(&picture, "P1 5 3\n1 1 1 1 1\n0 0 0 0 0\n0 0 0 0 0\n").unwrap();
    assert!(run_example("trace", &[&picture, "--hpgl", &plt]).status.success());
    let text = std::fs::read_to_string(&plt).unwrap();
    // four plotter units a pixel: four pixels to the right, two above the lowest row
    assert!(text.contains("PU0,8;\nPD16,8;\n") || text.contains("PU16,8;\nPD0,8;\n"), "{text}");
}
