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
fn the_built_in_pattern_joins_within_a_tenth_of_a_millimetre() {
    let folder = Folder::new();
    let svg = folder.file("sheet.svg");
    let report = folder.long_sheet_report(&[&COARSE[..], &["--svg", &svg]].concat());
    // 30 m in frames of 1.8 m
    assert_eq!(report["frames"], 17);
    assert!(number(&report, "joint_worst_mm") < 0.1 && number(&report, "drift_worst_mm") < 3.0);
    assert!(number(&report, "anchor_worst_mm") <= 0.01);
    assert_eq!(report["outside"], 0);
    assert!(report["joints"].as_array().unwrap().iter().all(|joint| joint["breaks"].as_u64().unwrap() >= 10));
    let svg = std::fs::read_to_string(svg).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert_eq!(svg.matches(">joint ").count(), 6);
}

#[test]
fn the_published_procedure_misses_by_half_of_the_pens_line() {
    let folder = Folder::new();
    let report = folder.long_sheet_report(&[&COARSE[..], &["--method", "published"]].concat());
    assert!((0.1..1.0).contains(&number(&report, "joint_worst_mm")));
}

#[test]
fn a_file_is_drawn_and_blank_frames_follow_it() {
    let folder = Folder::new();
    let line = folder.write("line.plt", "IN;SP1;PU0,4000;PD120000,8000;PU;SP0;PG;");
    let report = folder.long_sheet_report(&[&line, "--frames", "5"]);
    // 3 m: two frames with the line, cut once, and three blank ones
    assert_eq!((report["frames"].as_u64(), report["breaks"].as_u64()), (Some(5), Some(1)));
    assert_eq!(report["fold_probes"], 4);
}

#[test]
fn folds_are_found() {
    let folder = Folder::new();
    let report = folder.long_sheet_report(&[&COARSE[..], &["--folds", "1"]].concat());
    assert_eq!((report["folds"].as_u64(), report["folds_missed"].as_u64()), (Some(16), Some(0)));
}

#[test]
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
    refused("wide.plt", "IN;SP1;PU0,0;PD4000,48000;SP0;", "y = 1200 mm lies beside the table");
    refused("left.plt", "IN;SP1;PU0,0;PD-400,400;SP0;", "before the first frame");
    refused("pages.plt", "IN;SP1;PU0,0;PD400,400;PG;PU0,0;PD400,400;SP0;", "second page");
}

#[test]
fn machines_that_move_no_sheet_are_refused() {
    let machine = data("../machines/stepper-plotter.toml");
    let said = complaint("long_sheet", &["--machine", &machine]);
    assert!(said.contains("sheet.frame_mm is 0"), "{said}");
    let folder = Folder::new();
    let text = std::fs::read_to_string(data("../machines/textile-plotter.toml")).unwrap();
    let zero = folder.write("zero.toml", text.replace("frame_mm = 1800.0", "frame_mm = -1.0"));
    let said = complaint("long_sheet", &["--machine", &zero]);
    assert!(said.contains("sheet.frame_mm: -1 mm lies outside"), "{said}");
}

#[test]
fn a_drawing_comes_through_a_pipe() {
    let folder = Folder::new();
    let line = folder.write("line.plt", "IN;SP1;PU0,4000;PD120000,8000;SP0;");
    let output = run_with_input("long_sheet", &["-"], std::fs::File::open(line).unwrap());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("2 (3.6 m)"));
}
