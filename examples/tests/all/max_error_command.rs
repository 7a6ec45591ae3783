//! The command `max_error`: what it promises, what it measures, and what it says when that cannot be.

use crate::built_example;
use crate::papers::assert_in;
use crate::sampled::sampled;

use built_example::{complaint, data, machine, run_example};
use serde_json::Value;
use std::path::Path;
use std::sync::{Mutex, mpsc};

/// Of sums of promised parts.
const ROUNDING_MM: f64 = 1e-9;

const MACHINES: [&str; 3] = ["semi-virtual-gantry.toml", "marking-board.toml", "stepper-plotter.toml"];

/// A run's report; whether it drew.
fn report(image: &str, machine: &str, asked_mm: f64) -> (bool, Value) {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("report.json");
    let error = asked_mm.to_string();
    let arguments =
        [image, "--machine", machine, "--max-error-mm", &error, "--report", file.to_str().unwrap()];
    let output = run_example("max_error", &arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let text = std::fs::read_to_string(&file).unwrap_or_else(|_| panic!("{arguments:?}: {said}"));
    (output.status.success(), serde_json::from_str(&text).unwrap())
}

fn number(report: &Value, path: &str) -> f64 {
    report.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {report}"))
}

/// What every report of a drawing must say.
fn keeps_its_promise(report: &Value, asked_mm: f64) {
    let parts: f64 = ["vectorization", "blend", "control"]
        .map(|part| number(report, &format!("/parts/{part}_mm")))
        .iter()
        .sum();
    let promised_mm = number(report, "/promised_mm");
    assert_eq!(number(report, "/asked_mm"), asked_mm);
    assert!((parts - promised_mm).abs() < ROUNDING_MM && promised_mm <= asked_mm, "{report}");
    assert!(number(report, "/measured_mm") <= promised_mm, "{report}");
    // Line by line, too.
    let lines = number(report, "/lines/of_scan");
    assert!(lines >= 14.0 && number(report, "/lines/followed") == lines, "{report}");
    assert!(number(report, "/drawing_time_s") > 1.0);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_flag_stays_within_the_error_that_was_asked_and_its_picture_shows_it() {
    const ASKED_MM: f64 = 0.5;
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("drawn.svg");
    let (drawn, report) = report(&data("flag.png"), &machine("stepper-plotter.toml"), ASKED_MM);
    assert!(drawn);
    keeps_its_promise(&report, ASKED_MM);
    assert!(number(&report, "/parts/blend_mm") > 0.1, "{report}");
    let small = ["--width-mm", "20", "--machine", &machine("stepper-plotter.toml")];
    let output = run_example("max_error", &[&small[..], &["--picture", picture.to_str().unwrap()]].concat());
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && said.contains("promised") && said.contains("drawing time"), "{said}");
    let svg = std::fs::read_to_string(picture).unwrap();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
}

/// A machine that is less exact at its own speed than a small error allows is slowed down, and keeps it.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_that_is_too_quick_is_slowed_down() {
    const ASKED_MM: f64 = 0.1;
    let directory = tempfile::tempdir().unwrap();
    let quick = directory.path().join("quick.toml");
    let text = include_str!("../../machines/stepper-plotter.toml")
        .replace("\nspeed_mm_s = 45.0", "\nspeed_mm_s = 90.0")
        .replace("\naccel_mm_s2 = 250.0", "\naccel_mm_s2 = 2000.0");
    std::fs::write(&quick, text).unwrap();
    let run = |asked_mm| report(&data("flag.png"), quick.to_str().unwrap(), asked_mm);
    let (drawn, slowed) = run(ASKED_MM);
    assert!(drawn);
    keeps_its_promise(&slowed, ASKED_MM);
    let share = number(&slowed, "/speed_share");
    assert!(share < 0.9, "{share}");
    let (_, full) = run(10.0 * ASKED_MM);
    assert_eq!(number(&full, "/speed_share"), 1.0);
    assert!(number(&full, "/drawing_time_s") < number(&slowed, "/drawing_time_s"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_cannot_be_promised_is_refused_with_the_part_and_the_smallest_error() {
    let stepper = machine("stepper-plotter.toml");
    let said = complaint("max_error", &["--machine", &stepper, "--max-error-mm", "0.01"]);
    assert!(said.starts_with("max_error: 0.01 mm cannot be promised: control alone needs 0.0"), "{said}");
    assert!(said.contains("the smallest error that can be promised is 0.0"), "{said}");
    let (drawn, refused) = report(&data("flag.png"), &stepper, 0.01);
    assert!(!drawn);
    assert_eq!(refused["limiting_part"], "control");
    // Rounded up as the message does, it can be promised.
    let smallest_mm = (number(&refused, "/smallest_mm") * 1e4).ceil() / 1e4;
    assert!(said.ends_with(&format!("{smallest_mm:.4} mm")), "{said}");
    let (drawn, kept) = report(&data("flag.png"), &stepper, smallest_mm);
    assert!(drawn, "{kept}");
    keeps_its_promise(&kept, smallest_mm);
}

/// Within 1 mm the technical drawing has lines enough that lie closer together: those stay lines, unless the
/// user allows less.
#[test]
#[ignore = "two searches over twenty vectorizations: seconds in release, run by .ci/run"]
fn lines_run_together_only_where_that_is_allowed() {
    const ASKED_MM: &str = "1";
    let directory = tempfile::tempdir().unwrap();
    let run = |options: &[&str]| {
        let file = directory.path().join("report.json");
        let image = data("technical.png");
        let fixed =
            [&image, "--max-error-mm", ASKED_MM, "--width-mm", "30", "--report", file.to_str().unwrap()];
        let output = run_example("max_error", &[&fixed[..], options].concat());
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let report: Value = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        (output.status.success(), said, report)
    };
    let (drawn, said, report) = run(&[]);
    let lines = number(&report, "/lines/of_scan");
    assert!(drawn && lines > 200.0, "{said}");
    assert!(said.contains(&format!("{lines} of {lines}")), "{said}");
    let (drawn, said, merged) = run(&["--allow-merged-lines"]);
    assert!(drawn, "{said}");
    let count = |report: &Value, key: &str| number(report, &format!("/lines/{key}"));
    assert_eq!(count(&merged, "of_scan"), lines);
    assert_eq!(
        count(&merged, "followed") + count(&merged, "merged") + count(&merged, "dropped"),
        lines,
        "{merged}"
    );
    assert!(count(&merged, "merged") > 20.0, "{merged}");
    assert!(number(&merged, "/vectorization/strokes") < 0.7 * number(&report, "/vectorization/strokes"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_is_wrong_is_said_in_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, contents: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, contents).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let blank = file("blank.pgm", "P2 3 2 255\n255 255 255 255 255 255\n");
    let bad = file("bad.toml", "schema = 1\n[belt]\nrun_down_s = 1\n");
    assert!(complaint("max_error", &["no/such.png"]).starts_with("max_error: no/such.png: cannot be read"));
    assert!(complaint("max_error", &[&blank]).contains("there is no ink on it"));
    assert!(complaint("max_error", &[&file("empty.png", "")]).contains("is empty"));
    assert!(complaint("max_error", &["--machine", &bad]).contains("write `run_down_ms = 1000`"));
    for error in ["0", "-1", "NaN", "inf"] {
        let said = complaint("max_error", &["--max-error-mm", error]);
        assert!(said.starts_with("max_error: --max-error-mm: ") && said.contains("above 0"), "{said}");
    }
    assert!(complaint("max_error", &["--width-mm", "0"]).contains("give a width above 0 mm"));
    let typo = run_example("max_error", &["--max-eror-mm", "1"]);
    let said = String::from_utf8_lossy(&typo.stderr).into_owned();
    assert!(typo.status.code() == Some(2) && said.contains("--max-error-mm"), "{said}");
    let help = run_example("max_error", &["--help"]);
    let said = String::from_utf8_lossy(&help.stdout).into_owned();
    assert!(help.status.success() && said.contains("Examples:") && said.contains("--report"), "{said}");
}

/// All of docs/results/maximum-error.md: prints its table.
#[test]
#[ignore = "24 drawings: two minutes on two cores in release, run by .ci/run"]
fn every_error_is_kept_on_every_machine_and_less_takes_longer() {
    const ASKED_MM: [f64; 4] = [1.0, 0.5, 0.2, 0.1];
    let drawn = MACHINES
        .into_iter()
        .flat_map(|machine| ["flag.png", "technical.png"].map(|drawing| (machine, drawing)));
    let cases: Vec<_> = sampled(drawn)
        .flat_map(|(machine, drawing)| ASKED_MM.map(|asked_mm| (machine, drawing, asked_mm)))
        .collect();
    // Two at a time.
    let queue = Mutex::new(cases.iter().copied().enumerate().rev().collect::<Vec<_>>());
    let (done, results) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..2 {
            let (queue, done) = (&queue, done.clone());
            scope.spawn(move || {
                while let Some((index, (file, drawing, asked_mm))) = { queue.lock().unwrap().pop() } {
                    done.send((index, report(&data(drawing), &machine(file), asked_mm))).unwrap();
                }
            });
        }
    });
    drop(done);
    let mut results: Vec<_> = results.into_iter().collect();
    results.sort_by_key(|(index, _)| *index);
    println!(
        "| machine | drawing | asked | promised | vectorization | blends | control | measured | time | vertices | most |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let (mut before, mut rows) = (None, Vec::new());
    for ((file, drawing, asked_mm), (_, (drawn, report))) in cases.into_iter().zip(results) {
        assert!(drawn, "{file} {drawing} {asked_mm}: {report}");
        let time_s = number(&report, "/drawing_time_s");
        let mm = |path: &str| format!("{:.4}", number(&report, path));
        let cells = [
            mm("/promised_mm"),
            mm("/parts/vectorization_mm"),
            mm("/parts/blend_mm"),
            mm("/parts/control_mm"),
            mm("/measured_mm"),
            format!("{time_s:.1} s"),
            report["vectorization"]["vertices"].to_string(),
            report["largest_part"].as_str().unwrap().to_owned(),
        ];
        let begins = format!("{} | {} | {asked_mm} ", stem(file), stem(drawing));
        println!("| {begins}| {} |", cells.join(" | "));
        rows.push((begins, cells));
        keeps_its_promise(&report, asked_mm);
        // The errors of a machine and a drawing come from the greatest down.
        let same = (file, drawing);
        if let Some((_, faster_s)) = before.filter(|(other, _)| *other == same) {
            assert!(time_s >= faster_s, "{file} {drawing}: {asked_mm} mm take {time_s} s, more {faster_s} s");
        }
        before = Some((same, time_s));
    }
    for (begins, cells) in rows {
        assert_in("docs/results/maximum-error.md", &begins, &cells);
    }
}

fn stem(file: &str) -> &str {
    Path::new(file).file_stem().and_then(|stem| stem.to_str()).unwrap()
}
