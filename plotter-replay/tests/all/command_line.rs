//! The program as a user runs it: what it says, and its exit status.
#![cfg(feature = "cli")]

use plotter_motion::plant::{Bench, BenchSettings};
use plotter_motion::{Axis, Direction, Machine, MachineConfig, Pen, PenMove, StepPoint};
use plotter_replay::BenchRecorder;
use plotter_replay::log::{self, Event, Header, Record};
use std::path::Path;
use std::process::Command;

struct Ran {
    status: i32,
    out: String,
    err: String,
}

fn run(arguments: &[&str], directory: &Path) -> Ran {
    let output = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap();
    Ran {
        status: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Records 2.5 mm to the right and 1.25 mm up, drawn.
fn session(path: &Path) {
    let machine = Machine::new(MachineConfig::default()).unwrap();
    let target = StepPoint::new(100, 50);
    let mut bench =
        Bench::new(&machine, BenchSettings::default(), [PenMove { pen: Pen::Down, target }].into_iter());
    let header = Header::new()
        .with_number("baud", 256_000)
        .with_text("protocol", "digits")
        .with_text("controller", "contouring");
    let mut recorder = BenchRecorder::new(log::create(path, &header).unwrap());
    while !bench.host().is_done() {
        bench.step(|time, event| recorder.record(time, event));
    }
    recorder.finish().unwrap();
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_clean_log_is_described_drawn_and_re_run() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    session(&here.join("line.plog.gz"));

    let info = run(&["info", "line.plog.gz"], here);
    assert_eq!(info.status, 0, "{}", info.err);
    for line in
        ["  baud: 256000", "targets: 1 sent, 1 reached", "ends at (2.500, 1.250) mm, counted (100, 50)"]
    {
        assert!(info.out.lines().any(|l| l == line), "{line}: {}", info.out);
    }
    assert!(info.out.contains("nothing lost"), "{}", info.out);

    let check = run(&["check", "line.plog.gz"], here);
    assert_eq!(check.status, 0, "{}{}", check.out, check.err);
    assert!(check.out.contains("\nequal: "), "{}", check.out);

    let render = run(&["render", "line.plog.gz", "-o", "pictures", "--chart", "own.svg"], here);
    assert_eq!(render.status, 0, "{}", render.err);
    for name in ["pictures/plotted.svg", "pictures/response.svg", "own.svg"] {
        let svg = std::fs::read_to_string(here.join(name)).unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"), "{name}");
    }
    #[cfg(feature = "image")]
    assert!(std::fs::read(here.join("pictures/plotted.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn the_drawing_that_was_sent_tells_the_pen() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    // Pulses and targets alone: nothing in the log says that the first way has the pen up.
    let log = "plotter-log 1 {\"baud\":256000}\n\
        0 > 02 00 00 00 00 00 00 00 00 00 *SUM\n\
        100 < 31 31 2b *SUM\n\
        200 > 02 00 00 00 00 02 00 00 00 00 *SUM\n\
        300 < 33 33 2b *SUM\n";
    let sums = crc::Crc::<u8>::new(&crc::CRC_8_SMBUS);
    let log: String = log
        .lines()
        .map(|line| match line.strip_suffix("*SUM") {
            Some(covered) => format!("{covered}*{:02x}\n", sums.checksum(covered.as_bytes())),
            None => format!("{line}\n"),
        })
        .collect();
    std::fs::write(here.join("line.plog"), log).unwrap();
    std::fs::write(here.join("line.hpgl"), "IN;SP1;PU2,0;PD2,2;PU;").unwrap();
    let ink = |arguments: &[&str]| {
        let ran = run(&[&["render", "line.plog", "--svg", "line.svg"], arguments].concat(), here);
        assert_eq!(ran.status, 0, "{}{}", ran.out, ran.err);
        let svg = std::fs::read_to_string(here.join("line.svg")).unwrap();
        let path = svg.lines().find(|line| line.contains("#1a1a2e")).unwrap().to_owned();
        path.split_once(" d=\"").unwrap().1.to_owned()
    };
    // Two lines without the drawing, through three points; one with it. A point is two numbers.
    let numbers = |path: String| path.split(['L', ' ']).count();
    assert_eq!(numbers(ink(&[])), 6);
    assert_eq!(numbers(ink(&["--drawing", "line.hpgl"])), 4);

    std::fs::write(here.join("broken.hpgl"), "IN;PU2,0;PD2,,2;XX1;").unwrap();
    let broken = run(&["render", "line.plog", "--svg", "line.svg", "--drawing", "broken.hpgl"], here);
    assert_eq!(broken.status, 1, "{}{}", broken.out, broken.err);
    let nowhere = run(&["render", "line.plog", "--svg", "line.svg", "--drawing", "nowhere.hpgl"], here);
    assert_eq!((nowhere.status, nowhere.err.lines().count()), (2, 1));
}

#[test]
fn another_machine_is_a_difference() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    session(&here.join("line.plog"));
    std::fs::write(here.join("same.toml"), "schema = 1\n").unwrap();
    let same = run(&["check", "line.plog", "--machine", "same.toml"], here);
    assert_eq!(same.status, 0, "{}{}", same.out, same.err);
    std::fs::write(here.join("slow.toml"), "schema = 1\n[control.contouring]\nfeed_mm_s = 20.0\n").unwrap();
    let slow = run(&["check", "line.plog", "--machine", "slow.toml"], here);
    assert_eq!(slow.status, 1, "{}{}", slow.out, slow.err);
    assert!(slow.out.contains("first difference at "), "{}", slow.out);
    // Another kind of machine has never spoken what is in the log.
    let stepper = "schema = 1\ndrive = \"stepper\"\n[area]\nwidth_mm = 100.0\nheight_mm = 100.0\n";
    let belt = "schema = 1\n[area]\nwidth_mm = 300.0\nheight_mm = 200.0\n[kinematics]\ntype = \"corexy\"\n[control.contouring]\n\
        feed_mm_s = 30.0\n[x]\nencoder.decoding = \"x2\"\n[y]\nencoder.decoding = \"x2\"\n";
    for (name, text, has) in [("stepper.toml", stepper, "stepper motors"), ("belt.toml", belt, "one belt")] {
        std::fs::write(here.join(name), text).unwrap();
        for command in ["check", "replay"] {
            let refused = run(&[command, "line.plog", "--machine", name], here);
            assert_eq!(refused.status, 2, "{command} {name}: {}{}", refused.out, refused.err);
            assert!(refused.err.contains(has) && refused.err.contains("\"digits\""), "{}", refused.err);
        }
    }
    std::fs::write(here.join("wrong.toml"), "schema = 1\nspeed = 3\n").unwrap();
    let wrong = run(&["check", "line.plog", "--machine", "wrong.toml"], here);
    assert_eq!(wrong.status, 2);
    assert!(wrong.err.contains("wrong.toml") && wrong.err.contains("speed"), "{}", wrong.err);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_damaged_log_gives_status_1_and_the_place() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    session(&here.join("line.plog"));
    let mut text = std::fs::read_to_string(here.join("line.plog")).unwrap();
    text.truncate(text.len() - 6);
    std::fs::write(here.join("cut.plog"), text).unwrap();
    for command in ["info", "render", "check"] {
        let ran = run(&[command, "cut.plog"], here);
        assert_eq!(ran.status, 1, "{command}: {}", ran.err);
        assert!(ran.out.contains("the log ends inside this line"), "{command}: {}", ran.out);
        assert!(ran.out.contains("lost 1 line"), "{command}: {}", ran.out);
    }
}

#[test]
fn what_is_no_log_gives_status_2_and_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("picture.plog"), b"\x89PNG\r\n\x1a\n").unwrap();
    std::fs::write(here.join("empty.plog"), b"").unwrap();
    std::fs::write(here.join("scale.plog"), b"plotter-log 1 {\"x_mm_per_pulse\":0}\n").unwrap();
    for (file, word) in [
        ("picture.plog", "not a log"),
        ("empty.plog", "empty"),
        ("nowhere.plog", "cannot be read"),
        ("scale.plog", "x_mm_per_pulse"),
    ] {
        let ran = run(&["info", file], here);
        assert_eq!(ran.status, 2, "{file}");
        assert!(ran.err.contains(file) && ran.err.contains(word), "{}", ran.err);
        assert_eq!(ran.err.lines().count(), 1, "{}", ran.err);
    }
    let unwritable = run(&["render", "picture.plog", "-o", "pictures"], here);
    assert_eq!(unwritable.status, 2);
    assert!(!here.join("pictures").exists());
}

#[test]
fn every_help_has_an_example() {
    let here = Path::new(".");
    for arguments in [&["--help"][..], &["render", "--help"], &["check", "--help"], &["info", "--help"]] {
        let help = run(arguments, here);
        assert_eq!(help.status, 0);
        assert!(help.out.contains("Example: plotter-replay "), "{}", help.out);
    }
}

/// A device has no line ends and no end: each of these once read on for ever, or until the memory was full.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
#[cfg(target_os = "linux")]
fn what_never_ends_is_refused_in_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    session(&here.join("line.plog"));
    for arguments in [
        &["info", "/dev/zero"][..],
        &["check", "line.plog", "--machine", "/dev/zero"],
        &["render", "line.plog", "--drawing", "/dev/zero"],
    ] {
        let ran = run(arguments, here);
        assert_eq!((ran.status, ran.err.lines().count()), (2, 1), "{arguments:?}: {}", ran.err);
        assert!(ran.err.starts_with("plotter-replay: /dev/zero: "), "{}", ran.err);
    }
}

#[test]
#[cfg(target_os = "linux")]
fn what_cannot_be_written_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    session(&here.join("line.plog"));
    for place in ["/dev/full", "missing/line.svg", "."] {
        let ran = run(&["render", "line.plog", "--svg", place], here);
        assert_eq!(ran.status, 2, "{place}: {}", ran.err);
        let expected = format!("plotter-replay: {place}: cannot be written: ");
        assert!(ran.err.starts_with(&expected) && ran.err.lines().count() == 1, "{}", ran.err);
    }
    let full = std::fs::File::create("/dev/full").unwrap();
    let program = env!("CARGO_BIN_EXE_plotter-replay");
    let mut info = Command::new(program);
    let ran = info.args(["info", "line.plog"]).current_dir(here).stdout(full).output().unwrap();
    assert_eq!(ran.status.code(), Some(2));
    assert!(String::from_utf8(ran.stderr).unwrap().starts_with("plotter-replay: standard output: cannot be"));
}

#[test]
fn a_log_without_a_line_is_drawn_and_not_run_again() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let header = Header::new().with_text("protocol", "counts").with_text("belt_signs", "direction-table");
    let mut writer = log::create(&here.join("board.plog"), &header).unwrap();
    for (time, event) in [
        (0, Event::Target { x: 0, y: 1 }),
        (9, Event::Edge { axis: Axis::Y, sign: Direction::Plus }),
        (10, Event::Controller(b"+".to_vec())),
    ] {
        writer.write(&Record::at_us(time, event)).unwrap();
    }
    writer.finish().unwrap();
    let info = run(&["info", "board.plog"], here);
    assert!(info.out.contains("ends at (0.013, 0.013) mm, counted (0, 1)"), "{}", info.out);
    let check = run(&["check", "board.plog"], here);
    assert_eq!((check.status, check.err.lines().count()), (2, 1), "{}", check.err);
    assert!(
        check.err.contains("its protocol is \"counts\"") && check.err.contains("`render`"),
        "{}",
        check.err
    );
}
