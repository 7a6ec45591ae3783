//! The command `judge`: what it prints, and what it says when a file is wrong.

use crate::built_example;

use built_example::{Folder, complaint, run_example};
use serde_json::Value;

const FLAG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/flag.png");
/// A line of 20 px from the centre of pixel (10, 10).
const TRUTH: &str = r##"{"name":"line","width":40,"height":20,"convention":"pixel-centre: so","stroke_width":[1.0],
    "polylines":[{"width":1.0,"color":"#000000","closed":false,"points":[[10,10],[30,10]]}],"junctions":[[20,10,4]]}"##;
/// A quarter of a pixel below it.
const SVG: &str = "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='20'>\
    <path d='M10.5 10.75H30.5' stroke='black'/></svg>";
/// The same place: 9.5 px above the centre of the lowest row and a quarter below, 10 of the left column; 4
/// units a pixel.
const HPGL: &str = "IN;SP1;PU40,35;PD120,35;PU;";

fn figures(arguments: &[&str]) -> Value {
    let output = run_example("judge", &[arguments, &["--report", "-"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report[0]["picture"], "line");
    report[0]["figures"].clone()
}

#[test]
fn svg_and_hpgl_of_the_same_line_have_the_same_figures() {
    let folder = Folder::new();
    let truth = folder.write("line.json", TRUTH);
    let (svg, plt) = (folder.write("line.svg", SVG), folder.write("line.plt", HPGL));
    let of_svg = figures(&[&svg, "--truth", &truth]);
    assert_eq!(of_svg, figures(&[&plt, "--truth", &truth, "--mm-per-px", "0.1"]));
    for figure in ["/mean_px", "/hausdorff_px", "/junctions/mean_px"] {
        assert_eq!(of_svg.pointer(figure).unwrap(), 0.25, "{figure}");
    }
    assert_eq!(
        (&of_svg["vertices"], &of_svg["strokes"], &of_svg["recall"]),
        (&2.into(), &1.into(), &1.0.into())
    );

    let table = run_example("judge", &[&svg, "--truth", &truth]);
    let said = String::from_utf8(table.stdout).unwrap();
    assert!(said.lines().count() == 3 && said.contains("| line | 2 | 1 | 0 | 0.250 | 0.25 |"), "{said}");
}

#[test]
fn a_drawing_seen_askew_is_judged_where_it_was_drawn() {
    // By hand: w = 1 + x / 30 halves the end at x = 30 and leaves 3/4 of x = 10, so that the line from (10,
    // 10) to (30, 10) is seen from (7.5, 7.5) to (15, 5) in a picture of 20 x 10 px.
    let view =
        r#","view":{"width":20,"height":10,"homography":[[1,0,0],[0,1,0],[0.03333333333333333,0,1]]}}"#;
    let folder = Folder::new();
    let truth = folder.write("askew.json", TRUTH.trim_end().trim_end_matches('}').to_owned() + view);
    let svg = folder.write(
        "askew.svg",
        "<svg xmlns='http://www.w3.org/2000/svg' width='20' height='10'><path d='M8 8L15.5 5.5' stroke='black'/></svg>",
    );
    let found = figures(&[&svg, "--truth", &truth]);
    assert!(found["hausdorff_px"].as_f64().unwrap() < 0.01, "{found}");
    assert!((found["pen_down_px"].as_f64().unwrap() - 20.0).abs() < 0.01, "{found}");
    assert_eq!((&found["recall_1_5_px"], &found["strokes_of_true"]), (&1.0.into(), &1.0.into()));
    assert!(complaint("judge", &[&svg, "--truth", &truth, "--picture", FLAG]).contains("askew"));
    let broken = folder.write(
        "broken.json",
        TRUTH.trim_end().trim_end_matches('}').to_owned() + &view.replace("[0,1,0]", "[1,0,0]"),
    );
    assert!(complaint("judge", &[&svg, "--truth", &broken]).contains("view.homography"));
}

#[test]
fn what_is_wrong_is_said_with_its_file() {
    let folder = Folder::new();
    let truth = folder.write("line.json", TRUTH);
    let svg = folder.write("line.svg", SVG);
    let empty = folder.write("empty.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='40' height='20'/>");
    assert!(complaint("judge", &[&empty, "--truth", &truth]).contains("empty.svg: it draws nothing"));
    assert!(complaint("judge", &[&svg, "--truth", &svg]).contains("draw_corpus"));
    assert!(complaint("judge", &[&folder.file("none"), "--truth", &truth]).contains("none: cannot be read"));
    let plt = folder.write("line.plt", HPGL);
    assert!(complaint("judge", &[&plt, "--truth", &truth, "--mm-per-px", "0"]).contains("mm a pixel"));
    let other = complaint("judge", &[&svg, "--truth", &truth, "--picture", FLAG]);
    assert!(other.contains("1014 x 673 px, but the truth is of 40 x 20 px"), "{other}");
    let help = String::from_utf8(run_example("judge", &["--help"]).stdout).unwrap();
    assert!(help.contains("Examples:") && help.contains("--truth"), "{help}");
    assert!(!run_example("judge", &[&svg]).status.success());
}
