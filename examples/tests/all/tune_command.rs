//! The command `tune`: what it finds and writes, and what it says to bad input.

use crate::built_example;

use built_example::{Folder, complaint, data, run_example};
use plotter_motion::Machine;
use serde_json::Value;

impl Folder {
    /// The report of a run that succeeds, and what it says.
    fn tune_report(&self, arguments: &[&str]) -> (Value, String) {
        let report = self.file("report.json");
        let output = run_example("tune", &[arguments, &["--report", &report]].concat());
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        let value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
        (value, String::from_utf8(output.stdout).unwrap())
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn of_loop<'a>(axis: &'a Value, name: &str) -> &'a Value {
    axis["loops"].as_array().unwrap().iter().find(|tried| tried["name"] == name).unwrap()
}

fn machine(name: &str) -> String {
    format!("{}/machines/{name}.toml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_gantry_is_tuned_by_every_method() {
    let folder = Folder::new();
    let svg = folder.file("tune.svg");
    let (report, text) = folder.tune_report(&["--svg", &svg]);
    let axes = report["axes"].as_array().unwrap();
    assert_eq!(axes.len(), 2);
    for axis in axes {
        let (truth, found) = (&axis["true"], &axis["found"]);
        for key in ["gain_counts_s", "time_constant_s"] {
            assert!((number(&found[key]) / number(&truth[key]) - 1.0).abs() < 0.05, "{found}");
        }
        for name in ["lambda", "step"] {
            assert!(number(&of_loop(axis, name)["max_sensitivity"]) < 1.03 * 1.7, "{axis}");
        }
        let relay = of_loop(axis, "relay, Åström-Hägglund");
        assert!((number(&relay["phase_margin_deg"]) - 45.0).abs() < 4.0, "{relay}");
        for tried in axis["loops"].as_array().unwrap() {
            assert!(tried["stable"].as_bool().unwrap() && number(&tried["settled_s"]) < 0.1, "{tried}");
        }
        assert_eq!(axis["failures"], Value::Array(vec![]));
        // The gantry's own 50 Hz have a sensitivity of 1.7.
        let (present, suggested) = (&axis["contouring_present"], &axis["contouring_suggested"]);
        assert!((number(&present["max_sensitivity"]) - 1.7).abs() < 0.02, "{present}");
        assert!((number(&suggested["bandwidth_hz"]) - 50.0).abs() < 8.0, "{suggested}");
    }
    // The published x axis: as good as none, and no derivative.
    let published = of_loop(&axes[0], "published");
    assert!(number(&published["phase_margin_deg"]) < 0.5 && number(&published["kd"]) == 0.0, "{published}");
    assert!(text.contains("axis x") && text.contains("axis y") && text.contains("bandwidth_hz = "), "{text}");
    let picture = std::fs::read_to_string(svg).unwrap();
    assert_eq!(picture.matches("Nyquist").count(), 2);
    assert!(picture.contains("relay, Åström-Hägglund") && !picture.contains("NaN"));
}

#[test]
fn its_lines_can_be_pasted_into_a_machines_file() {
    let folder = Folder::new();
    let (report, text) = folder.tune_report(&["--axis", "x", "--margin", "1.6"]);
    let lines = report["toml"].as_str().unwrap();
    assert!(text.ends_with(lines), "{text}");
    let pasted = Machine::from_toml(&format!("schema = 1\n{lines}")).unwrap();
    let contouring = &pasted.config().dc().unwrap().control.contouring;
    let suggested = &report["axes"][0]["contouring_suggested"];
    let bandwidth_hz = number(&suggested["bandwidth_hz"]);
    assert!(contouring.bandwidth_hz <= bandwidth_hz && contouring.bandwidth_hz > bandwidth_hz - 0.11);
    // and tuned again it has what was asked
    let path = folder.write("mine.toml", format!("schema = 1\n{lines}"));
    let (again, _) = folder.tune_report(&["--machine", &path, "--axis", "x", "--method", "lambda"]);
    let present = &again["axes"][0]["contouring_present"];
    assert!(number(&present["max_sensitivity"]) < 1.61, "{present}");
    // without their marks the other lines are keys too
    let uncommented: String = lines
        .lines()
        .filter(|line| line.starts_with("# [") || line.starts_with('[') || line.contains(" = "))
        .map(|line| format!("{}\n", line.trim_start_matches("# ")))
        .collect();
    assert!(Machine::from_toml(&format!("schema = 1\n{uncommented}")).is_ok(), "{uncommented}");
}

#[test]
fn a_motor_off_its_description_is_found_by_the_experiments_only() {
    let folder = Folder::new();
    // Lighter, of less resistance, on more voltage: a loop for the described motor has too much gain.
    let (report, text) = folder.tune_report(&["--motor-off", "-0.4", "--axis", "y"]);
    assert!(
        text.starts_with("semi-virtual-gantry, 2500 runs a second, motors -40 % off their description"),
        "{text}"
    );
    let axis = &report["axes"][0];
    let (described, truth, found) = (&axis["described"], &axis["true"], &axis["found"]);
    let lag = |process: &Value| number(&process["time_constant_s"]);
    assert!(lag(truth) < 0.6 * lag(described), "{axis}");
    assert!((lag(found) / lag(truth) - 1.0).abs() < 0.06, "{axis}");
    let sensitivity = |name: &str| number(&of_loop(axis, name)["max_sensitivity"]);
    assert!(sensitivity("lambda") > 2.0 && sensitivity("step") < 1.03 * 1.7, "{axis}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_method_alone_runs_alone() {
    let folder = Folder::new();
    let names = |method: &str| {
        let (report, _) = folder.tune_report(&["--method", method, "--axis", "x"]);
        let loops = report["axes"][0]["loops"].as_array().unwrap().clone();
        loops.iter().map(|tried| tried["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names("lambda"), ["published", "lambda"]);
    assert_eq!(names("step"), ["published", "step"]);
    assert_eq!(names("relay"), ["published", "relay, Åström-Hägglund", "relay, Tyreus-Luyben"]);
    assert_eq!(folder.tune_report(&[]).0, folder.tune_report(&[]).0, "the same again");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_cannot_be_tuned_is_said_in_one_line() {
    let folder = Folder::new();
    let refused = complaint("tune", &["--machine", &machine("stepper-plotter")]);
    assert!(refused.contains("stepper-plotter.toml: this machine has stepper motors"), "{refused}");
    assert!(refused.contains("drive = \"dc\""), "{refused}");
    let refused = complaint("tune", &["--machine", &machine("marking-board")]);
    assert!(refused.contains("marking-board.toml: this machine has DC motors on one belt"), "{refused}");
    assert!(
        complaint("tune", &["--machine", "no/such.toml"]).starts_with("tune: no/such.toml: cannot be read")
    );
    assert!(complaint("tune", &["--machine", &data("flag.png")]).contains("this is not a text file"));
    let file = |name: &str, text: &str| folder.write(name, text);
    assert!(complaint("tune", &["--machine", &file("a.toml", "")]).contains("a.toml: "));
    assert!(
        complaint("tune", &["--machine", &file("b.toml", "schema = 1\n[x.motor]\nohm = 2\n")])
            .contains("line 3")
    );
    let narrow = complaint("tune", &["--method", "step", "--axis", "x", "--travel-mm", "1"]);
    assert!(narrow.contains("no method gave gains") && narrow.contains("allow more travel"), "{narrow}");
    assert!(complaint("tune", &["--svg", "/no/such/a.svg"]).contains("cannot be written"));
}

#[test]
fn one_method_that_fails_does_not_take_the_others_with_it() {
    let output = run_example("tune", &["--axis", "x", "--travel-mm", "1"]);
    assert!(output.status.success());
    let (text, said) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(text.contains("step                     none: 40 counts to either side"), "{text}");
    assert!(said.starts_with("warning: axis x, step: ") && said.lines().count() == 1, "{said}");
}

#[test]
fn wrong_options_are_usage() {
    for bad in [
        &["--method", "guess"][..],
        &["--axis", "z"],
        &["--margin", "1"],
        &["--margin", "NaN"],
        &["--phase-margin", "90"],
        &["--motor-off", "-0.9"],
        &["--loop-hz", "0"],
        &["--travel-mm", "-3"],
        &["--machines", "x"],
        &["extra"],
    ] {
        let output = run_example("tune", bad);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(!output.stderr.is_empty());
    }
    let help = String::from_utf8(run_example("tune", &["--help"]).stdout).unwrap();
    assert!(
        help.contains("Methods:") && help.contains("Examples:") && help.contains("Exit status: 0"),
        "{help}"
    );
}

#[test]
fn slow_and_quick_loops_are_tuned_too() {
    let folder = Folder::new();
    for hz in ["100", "20000"] {
        let (report, _) = folder.tune_report(&["--loop-hz", hz, "--axis", "x", "--method", "lambda"]);
        let tuned = of_loop(&report["axes"][0], "lambda");
        assert!(
            number(&tuned["max_sensitivity"]) <= 1.7 && number(&tuned["settled_s"]) < 1.0,
            "{hz}: {tuned}"
        );
    }
}
