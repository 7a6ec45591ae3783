//! The command `plot`: what it writes, and what it says to bad input.

use crate::built_example;

use built_example::{complaint, data, machine, run_example};
use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::plant::{Bench, BenchController, BenchEvent, BenchSettings};
use plotter_motion::protocol::LinkSettings;
use plotter_motion::{LimitSwitches, Machine, MachineConfig, PenMove, SafetyGate};
use plotter_replay::serial::Port;
use std::time::{Duration, Instant};

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_flag_is_plotted_and_its_recording_replays() {
    /// An encoder count is 0.025 mm: half of one is what counting alone makes of a perfect line.
    const GRAIN_MM: f64 = 0.0125;
    /// A tenth of an encoder count.
    const TRUE_MM: f64 = 0.0025;
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().to_str().unwrap();
    let output = run_example("plot", &["--out", out]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let file = |name: &str| std::fs::read(directory.path().join(name)).unwrap();
    for name in ["drawing.hpgl", "drawing.svg", "plotted.svg", "plotted.png", "response.svg", "errors.svg"] {
        assert!(!file(name).is_empty(), "{name}");
    }
    let page = String::from_utf8(file("report.html")).unwrap();
    assert_eq!(page.matches("<svg").count(), 4);
    assert_eq!(page.matches("data:image/png;base64,").count(), 1);
    assert!(!page.contains("src=\"http") && !page.contains("href="), "the page needs nothing else");

    let report: serde_json::Value = serde_json::from_slice(&file("report.json")).unwrap();
    let number = |path: &str| report.pointer(path).unwrap().as_f64().unwrap();
    assert!(number("/vertices") > 0.0 && number("/strokes") > 0.0);
    assert!(number("/vector_error_px/mean") <= 0.12 && number("/vector_error_px/sd") <= 0.25);
    assert!(number("/vector_error_px/max") <= 0.5);
    assert!(number("/beyond_ink/max_px") <= 0.71, "{}", number("/beyond_ink/max_px"));
    assert_eq!(number("/reached"), number("/targets"));
    assert_eq!(number("/anomalies"), 0.0);
    assert!(number("/contour_error_mm/rms") <= GRAIN_MM);
    assert!(number("/contour_error_mm/max") <= 2.0 * GRAIN_MM);
    assert!(number("/true_contour_error_mm/max") <= TRUE_MM);
    assert!(number("/simulated_s") > 0.0 && number("/wall_s") > 0.0);

    let machine = plotter_motion::Machine::new(plotter_motion::MachineConfig::default()).unwrap();
    let outcome = plotter_replay::golden::check(
        &directory.path().join("session.plog"),
        || plotter_replay::player::MachineController::new(&machine),
        plotter_replay::golden::Mode::Compare,
    );
    assert!(outcome.is_ok(), "{outcome:?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_controller_plots_too_and_shows_its_error() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().to_str().unwrap();
    let options = ["--algorithm", "published", "--controller", "published", "--out", out];
    assert!(run_example("plot", &options).status.success());
    let json = std::fs::read(directory.path().join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert!(report["true_contour_error_mm"]["max"].as_f64().unwrap() > 0.1);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_of_a_pen_is_drawn_once_unless_the_published_algorithm_is_asked_for() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let picture = file("wall.pgm");
    // A roof and a wall, 3 px wide: 34 px up and down, and 40 px along.
    let is_ink = |x: i32, y: i32| {
        let on_roof = (10..=44).contains(&x) && (y - (20 - (x - 27).abs() / 2)).abs() <= 1;
        on_roof || (10..=50).contains(&x) && (39..=41).contains(&y)
    };
    let levels = (0..60).flat_map(|y| (0..60).map(move |x| u8::from(!is_ink(x, y)) * 255));
    std::fs::write(&picture, [b"P5 60 60 255\n".to_vec(), levels.collect()].concat()).unwrap();
    let strokes = |options: &[&str]| {
        let out = file("out");
        let output = run_example("plot", &[&[picture.as_str(), "--out", &out], options].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report = std::fs::read(directory.path().join("out/report.json")).unwrap();
        serde_json::from_slice::<serde_json::Value>(&report).unwrap()["strokes"].as_u64().unwrap()
    };
    assert_eq!(strokes(&[]), 2);
    assert!(strokes(&["--algorithm", "published"]) >= 4);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_marking_board_plots_with_both_controllers_and_shows_its_response() {
    /// A count of a motor is 0.0108 mm of the pen, and the target is rounded to one; one and a half more
    /// while motors that a belt couples are found out.
    const TRUE_MM: f64 = 0.027;
    /// In the counts three of them, and some hundredths by which pulses come late.
    const COUNTED_MM: f64 = 0.0335;
    let board = machine("marking-board.toml");
    let plot = |controller: &str| {
        let directory = tempfile::tempdir().unwrap();
        let out = directory.path().to_str().unwrap();
        let options =
            ["--algorithm", "published", "--machine", &board, "--controller", controller, "--out", out];
        let output = run_example("plot", &options);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let file = |name: &str| std::fs::read_to_string(directory.path().join(name)).unwrap();
        // X, Y and the distance from the line, desired beside actual
        let response = file("response.svg");
        assert!(
            ["X (mm)", "Y (mm)", "contour error (mm)", "actual"].iter().all(|text| response.contains(text))
        );
        let log = file("session.plog");
        assert!(log.starts_with("plotter-log 1 {\"protocol\":\"counts\",\"belt_signs\":\"direction-table\""));
        let report: serde_json::Value = serde_json::from_str(&file("report.json")).unwrap();
        let number = |path: &str| report.pointer(path).unwrap().as_f64().unwrap();
        assert_eq!((number("/reached"), number("/anomalies")), (number("/targets"), 0.0), "{controller}");
        assert!(number("/targets") > 200.0);
        (number("/contour_error_mm/max"), number("/true_contour_error_mm/max"))
    };
    let (counted_mm, true_mm) = plot("contouring");
    assert!(true_mm < TRUE_MM && counted_mm < COUNTED_MM, "{counted_mm}, {true_mm}");
    let (_, true_mm) = plot("published");
    assert!(true_mm > 0.45, "{true_mm}");
    let out = tempfile::tempdir().unwrap();
    let said = complaint(
        "plot",
        &["--machine", &board, "--firmware", "qemu", "--out", out.path().to_str().unwrap()],
    );
    assert!(said.contains("one belt") && said.contains("leave --firmware out"), "{said}");
}

#[test]
fn what_is_wrong_is_said_in_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, contents: &str| {
        let path = directory.path().join(name);
        std::fs::write(&path, contents).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let machine = file("machine.toml", "schema = 1\n[area]\nwidth_cm = 4\n");
    let small = file("small.toml", "schema = 1\n[area]\nwidth_mm = 8.0\nheight_mm = 8.0\n");
    let stepper = file("stepper.toml", include_str!("../../machines/stepper-plotter.toml"));
    let text = file("text.png", "this is no picture");
    let empty = file("empty.png", "");
    let out = directory.path().join("out");
    let out = out.to_str().unwrap();
    assert!(
        complaint("plot", &["no/such.png", "--out", out]).starts_with("plot: no/such.png: cannot be read")
    );
    assert!(complaint("plot", &[&text, "--out", out]).contains("is not PNG, JPEG"));
    assert!(complaint("plot", &[&empty, "--out", out]).contains("is empty"));
    assert!(complaint("plot", &["--machine", &machine, "--out", out]).contains("line 3, column 1"));
    assert!(complaint("plot", &["--machine", &stepper, "--out", out]).contains("the example `stepper`"));
    assert!(complaint("plot", &["--machine", &small, "--out", out]).contains("margin"));
    for bad in ["0", "-5", "NaN", "inf"] {
        assert!(complaint("plot", &["--width-mm", bad, "--out", out]).contains("give a width above 0 mm"));
    }
    assert!(
        complaint("plot", &["--machine", &data("flag.png"), "--out", out]).contains("is not a text file")
    );
    assert!(complaint("plot", &["--out", &text]).contains("text.png: this folder cannot be made"));
}

#[test]
fn a_blank_sheet_gives_an_empty_plot() {
    let directory = tempfile::tempdir().unwrap();
    let blank = directory.path().join("blank.pgm");
    std::fs::write(&blank, "P2 3 2 255\n255 255 255 255 255 255\n").unwrap();
    let out = directory.path().join("out");
    let output = run_example("plot", &[blank.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!(report["targets"], 0);
    assert_eq!(report["vertices"], 0);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_technical_drawing_is_plotted_within_a_quarter_of_a_count() {
    const QUARTER_MM: f64 = 0.025 / 4.0;
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().to_str().unwrap();
    assert!(run_example("plot", &[&data("technical.png"), "--out", out]).status.success());
    let json = std::fs::read(directory.path().join("report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(report["reached"], report["targets"]);
    assert!(report["true_contour_error_mm"]["max"].as_f64().unwrap() <= QUARTER_MM);
}

#[test]
fn a_firmware_that_is_not_there_is_said_to_be_so() {
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().to_str().unwrap();
    let elf = directory.path().join("gantry");
    let said = complaint("plot", &["--firmware", "qemu", "--elf", elf.to_str().unwrap(), "--out", out]);
    assert!(said.contains("the firmware is not built") && said.contains("cargo build --release"), "{said}");
    let said = complaint("plot", &["--firmware", "/dev/no-such-plotter", "--out", out]);
    assert!(said.starts_with("plot: /dev/no-such-plotter: there is no such serial port"), "{said}");
}

/// A simulated machine at one end of a pseudo terminal, in the time of the clock, or slower where it is too much for this
/// computer, until nobody listens any more.
fn serve(machine: &Machine, controller: impl BenchController, mut line: Port) {
    /// Between two looks at the line, so that a machine that comes late still answers.
    const LONGEST_TURN: Duration = Duration::from_millis(5);
    let moves = std::iter::empty::<PenMove>();
    let mut bench = Bench::with_controller(machine, BenchSettings::default(), controller, moves);
    let began = Instant::now();
    let (mut bytes, mut answers) = ([0; 256], Vec::new());
    while began.elapsed() < Duration::from_secs(60) {
        let Ok(count) = line.receive(&mut bytes, Duration::from_millis(1)) else { return };
        bytes[..count].iter().for_each(|&byte| bench.disturb(byte));
        let until = began.elapsed().min(bench.now() + LONGEST_TURN);
        while bench.now() < until {
            bench.step(|_, event| {
                if let BenchEvent::ControllerByte(byte) = event {
                    answers.push(byte);
                }
            });
        }
        if !answers.is_empty() && line.send(&answers).is_err() {
            return;
        }
        answers.clear();
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_on_a_port_is_spoken_to_in_the_best_language_that_it_knows() {
    let directory = tempfile::tempdir().unwrap();
    let picture = directory.path().join("line.pbm");
    std::fs::write(&picture, "P1 9 3\n0 0 0 0 0 0 0 0 0\n0 1 1 1 1 1 1 1 0\n0 0 0 0 0 0 0 0 0\n").unwrap();
    let machine = Machine::new(MachineConfig::default()).unwrap();
    let linked = LinkedGantry::<4, 64>::new(
        Gantry::new(&machine, SafetyGate::new(LimitSwitches::RELEASED, false)),
        7,
        LinkSettings::default(),
    );
    // (the ports stay open: the last one to close a pseudo terminal hangs up the machine)
    let (first, new_port) = Port::pseudo_terminal().unwrap();
    let (second, old_port) = Port::pseudo_terminal().unwrap();
    std::thread::spawn(move || serve(&machine, linked, first));
    std::thread::spawn(move || {
        serve(&machine, Gantry::new(&machine, SafetyGate::new(LimitSwitches::RELEASED, false)), second)
    });
    for (port, frames) in [(&new_port, true), (&old_port, false)] {
        let out = directory.path().join(if frames { "new" } else { "old" });
        let output = run_example(
            "plot",
            &[
                picture.to_str().unwrap(),
                "--width-mm",
                "4",
                "--firmware",
                port.name(),
                "--out",
                out.to_str().unwrap(),
            ],
        );
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let report: serde_json::Value =
            serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
        assert_eq!((&report["reached"], &report["anomalies"]), (&report["targets"], &serde_json::json!(0)));
        assert!(report["targets"].as_u64() > Some(0));
        let said =
            String::from_utf8_lossy(&output.stdout).contains("the machine knows the digits protocol only");
        assert_eq!(said, !frames);
    }
}
