//! The command `long_sheet` on drawings: what it draws and measures, and what it says to bad input.

use crate::built_example;

use built_example::{Folder, complaint, data, run_example, run_with_input};
use serde_json::Value;

impl Folder {
    /// The report of a sheet that is drawn.
    fn long_sheet_report(&self, arguments: &[&str]) -> Value {
        let report = self.file("report.json");
        let output = run_example("long_sheet", &[arguments, &["--report", &report]].concat());
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap()
    }
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap()
}

/// A pattern that is soon drawn.
const COARSE: [&str; 2] = ["--chord-mm", "10"];

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_built_in_pattern_joins_within_a_tenth_of_a_millimetre() {
    let folder = Folder::new();
    let svg = folder.file("sheet.svg");
    let report = folder.long_sheet_report(&[&COARSE[..], &["--svg", &svg]].concat());
    // 30 m in frames of 0.95 m
    assert_eq!(report["frames"], 32);
    assert!(number(&report, "joint_worst_mm") < 0.1 && number(&report, "drift_worst_mm") < 3.0);
    assert!(number(&report, "anchor_worst_mm") <= 0.01);
    assert_eq!(report["outside"], 0);
    // Each of ten waves is cut, but those of which a stroke ends at the joint.
    assert!(report["joints"].as_array().unwrap().iter().all(|joint| joint["breaks"].as_u64().unwrap() >= 7));
    let svg = std::fs::read_to_string(svg).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert_eq!(svg.matches(">joint ").count(), 6);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_procedure_misses_by_half_of_the_pens_line() {
    let folder = Folder::new();
    let report = folder.long_sheet_report(&[&COARSE[..], &["--method", "published"]].concat());
    assert!((0.1..1.0).contains(&number(&report, "joint_worst_mm")));
}

#[test]
fn a_file_is_drawn_and_blank_frames_follow_it() {
    let folder = Folder::new();
    let line = folder.write("line.plt", "IN;SP1;PU4000,0;PD8000,60000;PU;SP0;PG;");
    let report = folder.long_sheet_report(&[&line, "--frames", "5"]);
    // 1.5 m: two frames with the line, cut once, and three blank ones
    assert_eq!((report["frames"].as_u64(), report["breaks"].as_u64()), (Some(5), Some(1)));
    assert_eq!(report["fold_probes"], 4);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn paper_of_any_width_anywhere_is_found_and_drawn_on() {
    let folder = Folder::new();
    let change = folder.file("change.svg");
    let report = folder.long_sheet_report(
        &[
            &COARSE[..],
            &["--length-m", "4", "--paper-edges", "412.5,1290", "--change", &change, "--change-frame", "2"],
        ]
        .concat(),
    );
    assert_eq!((report["frames"].as_u64(), report["outside"].as_u64()), (Some(5), Some(0)));
    assert!(number(&report, "joint_worst_mm") < 0.1);
    let change = std::fs::read_to_string(change).unwrap();
    assert!(change.contains("Frame 2 on the table") && change.trim_end().ends_with("</svg>"));

    // A field of 877.5 less twice 55 mm, and what the paper lies askew.
    let line = folder.write("line.plt", "IN;SP1;PU0,0;PD32000,8000;SP0;");
    let said = complaint("long_sheet", &[&line, "--paper-edges", "412.5,1290"]);
    assert!(said.contains("x = 800 mm lies beside the frame, which takes 0..=767 mm"), "{said}");
    let said = complaint("long_sheet", &["--paper-edges", "-80,1290"]);
    assert!(said.contains("left edge lies beyond -50 mm"), "{said}");
    let said = complaint("long_sheet", &["--paper-edges", "300,400"]);
    assert!(said.contains("no width of a drawing"), "{said}");
    let said = complaint(
        "long_sheet",
        &["--length-m", "1", "--change", &folder.file("no.svg"), "--change-frame", "7"],
    );
    assert!(said.contains("--change-frame 7: the drawing has 2 frames"), "{said}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn folds_are_found() {
    let folder = Folder::new();
    let report = folder.long_sheet_report(&[&COARSE[..], &["--folds", "1"]].concat());
    assert_eq!((report["folds"].as_u64(), report["folds_missed"].as_u64()), (Some(31), Some(0)));
    // The run stopped at each, and went on after the paper was fitted.
    assert_eq!(report["fold_stops"], 31);
    assert!(
        report["joints"][7]["fold"].as_str().unwrap().ends_with("fitted by hand 1 times and measured anew")
    );
    assert!(number(&report, "joint_worst_mm") < 0.1);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_same_seed_gives_the_same_sheet() {
    let folder = Folder::new();
    let report = |seed| folder.long_sheet_report(&["--length-m", "4", "--chord-mm", "10", "--seed", seed]);
    assert_eq!(report("3"), report("3"));
    assert_ne!(report("3")["joints"], report("4")["joints"]);
}

#[test]
fn bad_drawings_are_refused_by_name_and_nothing_is_drawn() {
    let folder = Folder::new();
    let refused = |name: &str, text: &str, wanted: &str| {
        let (path, svg) = (folder.write(name, text), folder.file("out.svg"));
        let said = complaint("long_sheet", &[&path, "--svg", &svg]);
        assert!(said.contains(wanted), "{said}");
        assert!(!std::path::Path::new(&svg).exists());
    };
    refused("empty.plt", "", "empty");
    refused("blank.plt", "IN;SP1;PU100,100;SP0;", "nothing is drawn");
    refused("wide.plt", "IN;SP1;PU0,0;PD84000,4000;SP0;", "x = 2100 mm lies beside the frame");
    refused("below.plt", "IN;SP1;PU0,0;PD400,-400;SP0;", "before the first frame");
    refused("pages.plt", "IN;SP1;PU0,0;PD400,400;PG;PU0,0;PD400,400;SP0;", "second page");
}

#[test]
fn machines_that_move_no_sheet_are_refused() {
    let machine = data("../machines/stepper-plotter.toml");
    let said = complaint("long_sheet", &["--machine", &machine]);
    assert!(said.contains("sheet.frame_mm is 0"), "{said}");
    let folder = Folder::new();
    let text = std::fs::read_to_string(data("../machines/textile-plotter.toml")).unwrap();
    let zero = folder.write("zero.toml", text.replace("frame_mm = 950.0", "frame_mm = -1.0"));
    let said = complaint("long_sheet", &["--machine", &zero]);
    assert!(said.contains("sheet.frame_mm: -1 mm lies outside"), "{said}");
}

#[test]
fn a_drawing_comes_through_a_pipe() {
    let folder = Folder::new();
    let line = folder.write("line.plt", "IN;SP1;PU4000,0;PD8000,60000;SP0;");
    let output = run_with_input("long_sheet", &["-"], std::fs::File::open(line).unwrap());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 (1.9 m)"));
}
