//! The command `stepper`: what it writes and measures, and what it says to bad input.

use crate::built_example;

use crate::real_files::all;
use built_example::{Folder, complaint, data, run_example, run_with_input};
use serde_json::Value;
use std::fmt::Write as _;

impl Folder {
    /// The report of a plot that succeeds.
    fn stepper_report(&self, arguments: &[&str]) -> Value {
        let report = self.file("report.json");
        let output = run_example("stepper", &[arguments, &["--report", &report]].concat());
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap()
    }
}

fn number(report: &Value, key: &str) -> f64 {
    report[key].as_f64().unwrap()
}

/// The limits that published figures are measured with.
const MEASURED: [&str; 9] = [
    "--max-speed",
    "100",
    "--accel",
    "1000",
    "--junction-deviation",
    "0.01",
    "--steps-per-mm",
    "100",
    "--ignore-feed",
];

#[test]
fn the_built_in_drawing_gives_every_file() {
    let folder = Folder::new();
    let (svg, chart, steps) = (folder.file("a.svg"), folder.file("b.svg"), folder.file("c.txt"));
    let report = folder.stepper_report(&["--svg", &svg, "--speed-plot", &chart, "--steps", &steps]);
    let read = |path: &str| std::fs::read_to_string(path).unwrap();
    assert!(read(&svg).contains("width=\"390.000mm\""));
    assert_eq!(["pen-1", "pen-2", "pen-3"].map(|pen| read(&svg).matches(pen).count()), [1, 1, 1]);
    assert!(read(&chart).contains("speed (mm/s)") && read(&chart).contains("pen up"));
    let lines = read(&steps).lines().filter(|line| !line.starts_with('#')).count();
    assert_eq!(lines as u64, report["steps"].as_u64().unwrap());
    // The figures of the machine: 45 and 90 mm/s, 250 mm/s², 200 ms for the pen.
    assert!(number(&report, "max_speed_mm_s") < 91.0 && number(&report, "max_speed_mm_s") > 89.0);
    assert!(number(&report, "max_accel_mm_s2") < 1.08 * 250.0);
    let pen_s = 0.2 * (number(&report, "strokes") + number(&report, "pen_lifts"));
    assert!((number(&report, "time_with_pen_s") - number(&report, "time_s") - pen_s).abs() < 0.01);
    // Both ends of a line and the pen between them are rounded to steps of 1/87.58 mm.
    assert!(number(&report, "max_deviation_mm") < number(&report, "allowance_mm") + 1.25 / 87.58);
    assert_eq!(report["diagnostics"], Value::Array(vec![]));
}

#[test]
fn a_line_takes_the_time_of_the_book() {
    let folder = Folder::new();
    let line = folder.write("line.txt", "PD, 04000, 00000\n");
    // 100 mm at 100 mm/s, and 0.1 s for the ramps
    let exact = folder.stepper_report(&[&[line.as_str()][..], &MEASURED].concat());
    assert_eq!(exact["language"], "thesis");
    assert!((number(&exact, "time_s") - 1.1).abs() < 1e-3, "{exact}");
    assert!((number(&exact, "max_accel_mm_s2") - 1000.0).abs() < 60.0, "{exact}");
    assert_eq!(
        (&exact["segments"], &exact["steps"], &exact["pen_lifts"]),
        (&1.into(), &10_000.into(), &1.into())
    );
    // With 20 m/s³ 0.9 of the acceleration is used: the ramps take 100 mm/s / 900 mm/s² + 900 mm/s² / 20000
    // mm/s³ = 0.156 s.
    let options = ["--s-curve", "--jerk", "20000"];
    let s_curve = folder.stepper_report(&[&[line.as_str()][..], &MEASURED, &options].concat());
    assert!((number(&s_curve, "time_s") - 1.1561).abs() < 1e-3, "{s_curve}");
}

#[test]
fn a_feed_counts_unless_it_is_ignored() {
    let folder = Folder::new();
    let text = folder.write("a.gcode", "M3 S90\nG1 X100 F600\nM5\n");
    let time_s = |options: &[&str]| {
        let limits = ["--max-speed", "100", "--accel", "1000"];
        number(&folder.stepper_report(&[&[text.as_str()][..], &limits, options].concat()), "time_s")
    };
    assert!((time_s(&[]) - 10.01).abs() < 1e-3);
    assert!((time_s(&["--ignore-feed"]) - 1.1).abs() < 1e-3);
}

#[test]
fn rounded_corners_are_faster_and_within_the_tolerance() {
    let folder = Folder::new();
    let zigzag: String = (0..200).map(|i| format!("PD{},{};", 40 * i, 10 * (i % 2))).collect();
    let zigzag = folder.write("zigzag.plt", format!("IN;PU0,0;{zigzag}PU;"));
    let exact = folder.stepper_report(&[&[zigzag.as_str()][..], &MEASURED].concat());
    let rounded =
        folder.stepper_report(&[&[zigzag.as_str()][..], &MEASURED, &["--tolerance-mm", "0.1"]].concat());
    assert_eq!((&exact["mode"], &rounded["mode"]), (&"exact".into(), &"tolerance".into()));
    assert!(number(&rounded, "time_s") < 0.8 * number(&exact, "time_s"));
    assert!(number(&exact, "max_deviation_mm") < 0.0125);
    let deviation = number(&rounded, "max_deviation_mm");
    assert!(deviation > 0.05 && deviation < 0.1125, "{deviation}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_jerk_is_limited_as_a_vector_where_that_is_asked_for() {
    let folder = Folder::new();
    let square = folder.write(
        "square.txt",
        "PD, 00800, 00000\nPD, 00800, 00800\nPD, 00000, 00800\nPU, 02000, 02000\nPD, 02400, 02000\n",
    );
    let (steps, plain_steps) = (folder.file("steps.txt"), folder.file("plain.txt"));
    let measured = [&MEASURED[..6], &["--steps-per-mm", "1000", "--tolerance-mm", "0.05"]].concat();
    let options = [&[square.as_str()][..], &measured].concat();
    let plain = folder.stepper_report(&[&options[..], &["--steps", &plain_steps]].concat());
    // Within a tolerance it is the vector, unless something else is said.
    let limit = ["--s-curve", "--jerk", "20000", "--steps", &steps];
    let averaged = folder.stepper_report(&[&options[..], &limit].concat());
    assert_eq!(averaged["limits"]["jerk_mm_s3"], 20_000.0);
    assert_eq!(averaged["limits"]["jerk_limit"], "vector");
    assert_eq!(averaged["strokes"], plain["strokes"]);
    assert!(number(&averaged, "max_deviation_mm") <= 0.05 + 2.0 / 1000.0, "{averaged}");
    let ratio = number(&averaged, "time_s") / number(&plain, "time_s");
    assert!((1.1..2.0).contains(&ratio), "{ratio}");
    // It is estimated without steps, too, and is what it was along the path if that is asked for.
    let estimate = [&options[..], &limit[..3], &["--estimate"]].concat();
    let estimated = folder.stepper_report(&estimate);
    for figure in ["time_s", "time_with_pen_s", "draw_mm"] {
        assert!(
            (number(&estimated, figure) - number(&averaged, figure)).abs() < 1e-5,
            "{estimated} {averaged}"
        );
    }
    let along = folder.stepper_report(&[&options[..], &limit[..3], &["--jerk-limit", "path"]].concat());
    assert_eq!(along["limits"]["jerk_limit"], "path");
    assert!(number(&along, "time_s") < number(&averaged, "time_s"), "{along}");
    // Both end in the same place, and the jerk, by differences of places 12 ms apart, is what was asked for.
    let (end, jerk) = steps_seen(&steps);
    let (plain_end, plain_jerk) = steps_seen(&plain_steps);
    assert_eq!(end, plain_end);
    assert!(jerk <= 1.1 * 20_000.0 && plain_jerk > 2.0 * 20_000.0, "{jerk}, {plain_jerk} mm/s³");
    // Where a travel is the last thing the motors go to its end as well, and all is as slow there.
    let home = folder.write("home.txt", "PD, 00800, 00000\nPU, 00000, 00000\n");
    let options = [&[home.as_str()][..], &measured].concat();
    let travelled = folder.stepper_report(&[&options[..], &limit].concat());
    let (end, jerk) = steps_seen(&steps);
    assert!(end == [0, 0] && jerk <= 1.1 * 20_000.0, "{end:?}, {jerk} mm/s³");
    assert!(number(&travelled, "max_accel_mm_s2") <= 1.1 * 416.0, "{travelled}");
    // A corner of the exact mode is a jump of the velocity: no jerk is limited there.
    let exact = [square.as_str(), "--mode", "exact", "--s-curve", "--jerk-limit", "vector"];
    let said = complaint("stepper", &exact);
    assert!(said.contains("the jerk as a vector can be limited within a tolerance only"), "{said}");
    // Hours of motion have no room.
    let much = [&options[..], &["--s-curve", "--jerk", "1"]].concat();
    let said = complaint("stepper", &much);
    assert!(said.contains("allow more jerk"), "{said}");
}

/// Where the steps of a file at 1000 steps/mm end, and the greatest jerk as a vector over 12 ms, mm/s³.
fn steps_seen(file: &str) -> ([i32; 2], f64) {
    const MS: usize = 1000;
    let (mut at, mut places, mut now) = ([0_i32; 2], Vec::new(), 0);
    let mut sum = [0.0; 2];
    for line in std::fs::read_to_string(file).unwrap().lines().filter(|line| !line.starts_with('#')) {
        let number: Vec<i64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        while now < usize::try_from(number[0]).unwrap() {
            (sum[0], sum[1]) = (sum[0] + f64::from(at[0]), sum[1] + f64::from(at[1]));
            now += 1;
            if now % MS == 0 {
                places.push(sum.map(|sum| sum / 1000.0 / 1000.0));
                sum = [0.0; 2];
            }
        }
        at[0] += i32::try_from(number[1]).unwrap();
        at[1] += i32::try_from(number[2]).unwrap();
    }
    let jerk = |places: &[[f64; 2]]| {
        let third = |axis: usize| {
            let of = |index: usize| places[index][axis];
            (of(36) - 3.0 * of(24) + 3.0 * of(12) - of(0)) / 0.012_f64.powi(3)
        };
        third(0).hypot(third(1))
    };
    (at, places.windows(37).map(jerk).fold(0.0, f64::max))
}

#[test]
fn what_lies_outside_is_told_with_its_line() {
    let folder = Folder::new();
    let text = folder.write("large.plt", "IN;PU0,0;\nPD400,0;\nPD400,-40;\nPD800,0;\nPD1200,0;\nPU;");
    let drawn = folder.stepper_report(&[&text]);
    assert_eq!((&drawn["outside"], &drawn["warnings"]), (&2.into(), &1.into()));
    assert_eq!(drawn["diagnostics"][0]["line"], 3);
    assert!(drawn["diagnostics"][0]["text"].as_str().unwrap().contains("(10.000, -1.000) mm lies outside"));
    // The two lines that leave the area are gone; what follows begins where the pen is told.
    let inside = folder.stepper_report(&[&text, "--outside", "leave-out"]);
    assert!(number(&inside, "draw_mm") < 20.0 + 1e-9, "{inside}");
    assert!(number(&drawn, "draw_mm") > 21.0, "{drawn}");
    assert!(complaint("stepper", &[&text, "--strict"]).contains("line 3: the point (10.000, -1.000) mm"));
}

#[test]
fn places_beyond_any_machine_are_left_out() {
    let folder = Folder::new();
    let text = folder.write("far.gcode", "M3\nG1 X10 F600\nG1 X900000000\nG1 X20\nG1 Y5\n");
    let report = folder.stepper_report(&[&text]);
    assert_eq!((&report["errors"], &report["diagnostics"][0]["line"]), (&1.into(), &3.into()));
    // Neither the line out there nor the one back.
    assert!((number(&report, "draw_mm") - 15.0).abs() < 1e-9, "{}", report["draw_mm"]);
}

#[test]
fn errors_have_a_place_and_the_rest_is_plotted() {
    let folder = Folder::new();
    let text = folder.write("a.nc", "M3 S90\nG1 X10 F600\nG1 X1O\nM104 S200\nG1 Y5\nM5\n");
    let report = folder.stepper_report(&[&text]);
    assert_eq!((&report["errors"], &report["notices"]), (&1.into(), &1.into()));
    assert_eq!(
        (&report["diagnostics"][0]["line"], &report["diagnostics"][0]["column"]),
        (&3.into(), &6.into())
    );
    assert!((number(&report, "draw_mm") - 15.0).abs() < 1e-9);
    assert!(
        complaint("stepper", &[&text, "--strict"]).contains("a.nc: line 3, column 6: O lacks its number")
    );
}

#[test]
fn svg_and_pipes_are_read() {
    let folder = Folder::new();
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='50mm' height='50mm' viewBox='0 0 50 50'>\
               <path d='M5 5H45' stroke='#00f'/><circle cx='25' cy='25' r='10' fill='none' stroke='red'/></svg>";
    let path = folder.write("a.svg", svg);
    let (out, report) = (folder.file("out.svg"), folder.file("r.json"));
    let file = std::fs::File::open(path).unwrap();
    let output = run_with_input("stepper", &["-", "--svg", &out, "--report", &report], file);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    assert!((number(&report, "draw_mm") - 40.0 - 20.0 * std::f64::consts::PI).abs() < 0.02, "{report}");
    let picture = std::fs::read_to_string(out).unwrap();
    assert!(picture.contains("#0000ff") && picture.contains("#ff0000"));
}

#[test]
fn what_cannot_be_plotted_is_said_in_one_line() {
    let folder = Folder::new();
    let file = |name: &str, contents: &[u8]| folder.write(name, contents);
    let said = |path: &str| complaint("stepper", &[path]);
    assert!(said("no/such.plt").starts_with("stepper: no/such.plt: cannot be read"));
    assert!(said(folder.0.path().to_str().unwrap()).contains("this is a folder"));
    assert!(said(&file("empty.plt", b"")).contains("the file is empty"));
    assert!(said(&file("up.plt", b"IN;PU100,100;PU;")).contains("nothing is drawn by it, read as hpgl"));
    let junk = data("flag.png");
    assert!(said(&junk).contains("none of HPGL, G-code, SVG"));
    assert!(said(&file("prose", b"Dear plotter, please draw.")).contains("none of HPGL"));
    assert!(said(&file("bad.svg", b"<svg")).contains("bad.svg: ")); // with line and column as the parser has them
    let text = file("a.plt", b"IN;PU0,0;PD400,0;");
    assert!(complaint("stepper", &[&text, "--machine", &text]).contains("line 1"));
    let dc = file("dc.toml", b"schema = 1\n");
    assert!(complaint("stepper", &[&text, "--machine", &dc]).contains("stepper needs stepper motors"));
    assert!(complaint("stepper", &[&text, "--svg", "/no/such/a.svg"]).contains("cannot be written"));
    // Junk in a language that is forced is not drawn either, and does no harm.
    for language in ["hpgl", "gcode", "thesis", "svg"] {
        let output = run_example("stepper", &[&junk, "--language", language]);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{language}: {:?}", output.status);
    }
}

#[test]
fn wrong_options_are_usage() {
    for bad in [
        &["--max-speed", "0"][..],
        &["--accel", "NaN"],
        &["--tolerance-mm", "-1"],
        &["--language", "latin"],
        &["--mode", "exact", "--tolerance-mm", "0.1"],
        &["--steps-per-mm", "1e9"],
    ] {
        let output = run_example("stepper", bad);
        assert_eq!(output.status.code(), Some(2), "{bad:?}");
        assert!(!output.stderr.is_empty());
    }
    let help = String::from_utf8(run_example("stepper", &["--help"]).stdout).unwrap();
    assert!(help.contains("Examples:") && help.contains("Exit status: 0"), "{help}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn many_bytes_are_read_in_little_memory() {
    // A stroke of 100,000 lines, more than are held at once.
    let folder = Folder::new();
    let mut text = String::from("IN;PU0,0;");
    for i in 0..100_000_u32 {
        let _ = write!(text, "PD{},{};", 4 * (i % 1000), 4 * ((i / 1000) % 50) + i % 2);
    }
    let report =
        folder.stepper_report(&[&folder.write("long.plt", text), "--max-speed", "1000", "--accel", "100000"]);
    assert_eq!(report["strokes"], 1);
    assert!(number(&report, "max_deviation_mm") < 0.0143, "{}", report["max_deviation_mm"]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_real_file_is_plotted_within_its_limits() {
    let folder = Folder::new();
    for (kind, language) in [("hpgl", "hpgl"), ("gcode", "gcode")] {
        for file in all(kind) {
            for (options, tolerance_mm) in [(&[][..], 0.0), (&["--tolerance-mm", "0.05"][..], 0.05)] {
                let path = file.to_str().unwrap();
                let report = folder.stepper_report(&[&[path][..], &MEASURED, options].concat());
                let name = file.file_name().unwrap().to_string_lossy();
                assert_eq!(report["language"], language, "{name}");
                assert!(number(&report, "time_s") > 1.0 && number(&report, "draw_mm") > 50.0, "{name}");
                // 1 % and 8 % are what a step more or less of either motor makes of the windows that are
                // compared.
                assert!(number(&report, "max_speed_mm_s") < 101.5, "{name}: {}", report["max_speed_mm_s"]);
                // In exact mode a slight corner is a jump that no window leaves out.
                let kind = if tolerance_mm > 0.0 { "max_accel_mm_s2" } else { "max_accel_along_mm_s2" };
                assert!(number(&report, kind) < 1080.0, "{name}: {}", report[kind]);
                let deviation = number(&report, "max_deviation_mm");
                let allowance_mm = report["allowance_mm"].as_f64().unwrap_or(0.0);
                assert!(deviation < tolerance_mm + allowance_mm + 0.0135, "{name}: {deviation}");
            }
        }
    }
}

/// That an estimate says of a plot what its steps do, but what only they can tell; gives its report.
fn estimated_as_stepped(folder: &Folder, arguments: &[&str]) -> Value {
    /// What adding up a million floats leaves of a time, s.
    const ROUNDING_S: f64 = 1e-6;
    let stepped = folder.stepper_report(arguments);
    let estimated = folder.stepper_report(&[arguments, &["--estimate"]].concat());
    for (key, value) in estimated.as_object().unwrap() {
        match (value.as_f64(), stepped[key].as_f64()) {
            (Some(one), Some(other)) => {
                assert!((one - other).abs() < ROUNDING_S, "{arguments:?}: {key} is {one}, not {other}");
            }
            _ if key == "estimated" => assert_eq!((value, &stepped[key]), (&true.into(), &false.into())),
            _ => assert_eq!(value, &stepped[key], "{arguments:?}: {key}"),
        }
    }
    let missing = stepped.as_object().unwrap().keys().filter(|key| estimated.get(key).is_none());
    let only_steps = |key: &String| key.starts_with("max_") || key == "steps" || key == "accel_window_ms";
    assert!(
        missing.clone().count() == 11 && missing.clone().all(only_steps),
        "{:?}",
        missing.collect::<Vec<_>>()
    );
    estimated
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn an_estimate_says_what_the_steps_say() {
    let folder = Folder::new();
    for options in
        [&[][..], &["--s-curve"], &["--tolerance-mm", "0.05"], &["--tolerance-mm", "0.05", "--s-curve"]]
    {
        let report = estimated_as_stepped(&folder, options);
        assert!(number(&report, "time_s") > 60.0, "{report}");
    }
    // Dwells, pens, sheets, feeds; what is wrong; what lies outside.
    let gcode = folder.write(
        "a.nc",
        "M3 S90\nG1 X10 F600\nG1 X1O\nG4 P250\nM104 S200\nG2 X20 I5 J0\nM5\nT2 M6\nM3\nG1 Y-5\nM0 (new sheet)\nG1 X900000000\n\
         G1 X2 Y2\nM5\n",
    );
    let report = estimated_as_stepped(&folder, &[&gcode]);
    assert_eq!((&report["errors"], &report["outside"]), (&2.into(), &3.into()), "{report}");
    estimated_as_stepped(&folder, &[&gcode, "--outside", "leave-out", "--ignore-feed"]);
    let hpgl = folder
        .write("a.plt", "IN;SP1;VS2;PU400,400;PD800,400,800,800;CI200;SP2;PD;PU;PG;PD40,0,80;PU0,0;SP0;");
    estimated_as_stepped(&folder, &[&hpgl]);
    let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='50mm' height='50mm' viewBox='0 0 50 50'>\
               <path d='M5 5H45V30' fill='none' stroke='#00f'/><circle cx='25' cy='25' r='10' fill='none' stroke='red'/></svg>";
    let report = estimated_as_stepped(&folder, &[&folder.write("a.svg", svg)]);
    assert_eq!(report["strokes"], 2);
}

#[test]
fn an_estimate_of_a_bad_file_says_so_as_a_plot_does() {
    let folder = Folder::new();
    let text = folder.write("up.plt", "IN;PU100,100;PU;");
    assert_eq!(complaint("stepper", &[&text, "--estimate"]), complaint("stepper", &[&text]));
    let text = folder.write("a.nc", "M3 S90\nG1 X10 F600\nG1 X1O\nG1 Y5\nM5\n");
    let strict = complaint("stepper", &[&text, "--estimate", "--strict"]);
    assert!(strict.contains("a.nc: line 3, column 6: O lacks its number"), "{strict}");
    let output = run_example("stepper", &["--estimate", "--steps", "steps.txt"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot be used with"), "{output:?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn real_files_are_estimated_as_they_are_stepped() {
    let folder = Folder::new();
    for file in ["hpgl", "gcode"].into_iter().flat_map(all) {
        for options in [&[][..], &["--tolerance-mm", "0.05"]] {
            estimated_as_stepped(&folder, &[&[file.to_str().unwrap()][..], options].concat());
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn published_times_are_found_again() {
    /// Of the times as published, which are rounded to this.
    const ROUNDING_S: f64 = 0.1;
    let folder = Folder::new();
    let published = [
        // With the way home, which takes 0.3 s.
        ("gcode", "unicorn_owl.gcode", 26.2, 21.26),
        ("gcode", "svg2gcode_smooth_curves.gcode", 30.6, 29.9),
        // 0.3 s of it are 15 lifts where the pen stands: it stops there.
        ("hpgl", "vk2bea_Cassini.hpgl", 625.9, 610.8),
    ];
    for (kind, name, exact_s, tolerance_s) in published {
        for file in all(kind).iter().filter(|file| file.ends_with(name)) {
            for (options, time_s) in [(&[][..], exact_s), (&["--tolerance-mm", "0.05"][..], tolerance_s)] {
                let report =
                    folder.stepper_report(&[&[file.to_str().unwrap()][..], &MEASURED, options].concat());
                let found_s = number(&report, "time_s");
                assert!((found_s - time_s).abs() <= ROUNDING_S, "{name}: {found_s} s, not {time_s} s");
            }
        }
    }
}
