//! The command `compare_controllers`: what it writes, and what it says to bad input.

use crate::built_example;

use built_example::{complaint, data, run_example};

const QUICK: [&str; 2] = ["--only", "published,cross-coupled"];

fn machine(name: &str) -> String {
    format!("{}/machines/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn two_controllers_are_ranked_in_table_csv_and_page() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (csv, html, gantry) = (file("a.csv"), file("a.html"), machine("loaded-gantry"));
    let output = run_example(
        "compare_controllers",
        &[&QUICK[..], &["--machine", &gantry, "--csv", &csv, "--html", &html]].concat(),
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let place = |name: &str| text.find(name).unwrap_or_else(|| panic!("no {name} in {text}"));
    assert!(place("cross-coupled") < place(" published"), "ours first: {text}");
    assert!(text.contains("loaded-gantry: eight lines of 60 mm") && text.contains("8/8"));

    let rows = std::fs::read_to_string(&csv).unwrap();
    let mut rows = rows.lines();
    assert_eq!(rows.next(), Some("controller,plant,line,rms_um,max_um,settle_s,time_s,finished"));
    let rows: Vec<Vec<&str>> = rows.map(|row| row.split(',').collect()).collect();
    assert_eq!(rows.len(), 2 * 8);
    for row in &rows {
        assert_eq!((row.len(), row[1]), (8, "loaded-gantry"), "{row:?}");
        assert!(row[3].parse::<f64>().unwrap() >= 0.0 && row[4].parse::<f64>().unwrap() >= 0.0);
        assert!(row[5].is_empty() || row[5].parse::<f64>().unwrap() > 0.0);
        assert!(row[6].parse::<f64>().unwrap() > 0.0 && (row[7] == "true" || row[7] == "false"));
    }
    // ours settles everywhere; not so the published one
    let settled = |name: &str| rows.iter().filter(|row| row[0] == name && !row[5].is_empty()).count();
    assert_eq!(settled("cross-coupled"), 8);
    assert!(settled("published") < 8);

    let page = std::fs::read_to_string(&html).unwrap();
    // of each controller the way of its pen and the response of its worst line
    assert_eq!(page.matches("<svg").count(), 2 * 2);
    assert!(page.contains("contour error (µm)") && page.contains("distance from the line × "));
    assert!(
        !page.contains("src=") && !page.contains("href=") && !page.contains("<script"),
        "needs nothing else"
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_drawing_is_drawn_besides_and_several_machines_take_part() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, contents: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, contents).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let square = file("square.plt", "IN;SP1;PU400,400;PD800,400,800,800,400,800,400,400;PU0,0;");
    let csv = file("figures.csv", "");
    let (one, other) = (machine("loaded-gantry"), machine("semi-virtual-gantry"));
    let output = run_example(
        "compare_controllers",
        &[
            "--machine",
            &one,
            "--machine",
            &other,
            "--drawing",
            &square,
            "--only",
            "planned-pid",
            "--csv",
            &csv,
        ],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("loaded-gantry: square") && text.contains("semi-virtual-gantry: square"), "{text}");
    let rows = std::fs::read_to_string(&csv).unwrap();
    assert_eq!(rows.lines().filter(|row| row.contains(",square,")).count(), 2);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_controller_of_one_s_own_is_ranked_with_the_others() {
    let gantry = machine("loaded-gantry");
    let output = run_example("my_controller", &["--machine", &gantry, "--only", "published,mine"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    let place = |name: &str| text.find(name).unwrap_or_else(|| panic!("no {name} in {text}"));
    assert!(place(" mine ") < place(" published "), "{text}");
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, contents: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, contents).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let said = |arguments: &[&str]| complaint("compare_controllers", arguments);
    assert!(
        said(&["--machine", "no/such.toml"]).starts_with("compare_controllers: no/such.toml: cannot be read")
    );
    let typo = file("typo.toml", "schema = 1\n[x.transmission]\nbacklash_um = 50\n");
    assert!(said(&["--machine", &typo]).contains("line 3, column 1"), "{}", said(&["--machine", &typo]));
    let empty = file("empty.toml", "");
    assert!(said(&["--machine", &empty]).contains("schema"));
    assert!(said(&["--machine", &data("flag.png")]).contains("is not a text file"));
    assert!(said(&["--machine", &machine("stepper-plotter")]).contains("stepper motors"));
    let belt = said(&["--machine", &machine("marking-board")]);
    assert!(belt.contains("marking-board.toml: this machine has DC motors on one belt"), "{belt}");
    assert!(said(&["--only", "publishd"]).contains("there is no such controller; there are published,"));
    for wrong in ["-0.1", "0.6", "NaN", "inf"] {
        assert!(said(&["--wrong", wrong]).contains("give a share of 0 to 0.5"), "{wrong}");
    }
    assert!(said(&["--drawing", "no/such.png"]).contains("no/such.png: cannot be read"));
    let text = file("text.png", "this is no picture");
    assert!(said(&["--drawing", &text]).contains("is not PNG, JPEG"));
    let far = file("far.plt", "IN;SP1;PU0,0;PD99999,99999;");
    assert!(said(&["--drawing", &far]).starts_with(&format!("compare_controllers: {far}: ")));
    for bad in ["0", "-5", "NaN"] {
        assert!(said(&["--drawing", "builtin", "--width-mm", bad]).contains("give a width above 0 mm"));
    }
    let nowhere = directory.path().join("no/such/page.html");
    assert!(said(&["--html", nowhere.to_str().unwrap()]).contains("cannot be written"));
}

#[test]
fn help_shows_examples_and_where_to_begin() {
    let output = run_example("compare_controllers", &["--help"]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    for word in ["--machine", "--drawing", "--html", "--csv", "Examples:", "examples/my_controller.rs"] {
        assert!(text.contains(word), "{word}: {text}");
    }
}
