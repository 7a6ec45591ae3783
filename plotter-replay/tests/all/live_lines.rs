//! `live` with machines that are led by lines, each on a pseudo terminal: drawn whole, killed and gone on
//! with, and what can go wrong at the desk.
#![cfg(unix)]

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_plotter-replay");
const MACHINE: &str = "schema = 1\nname = \"steppers\"\ndrive = \"stepper\"\n[area]\nwidth_mm = 60.0\nheight_mm = 40.0\n\
    [serial]\nbaud = 115200\n[pen]\nsettle_ms = 20.0\n[homing]\nknown_travel_mm = 0.0\nmax_travel_mm = 80.0\n";
const DRAWING: &str = "G21\nG90\nG0 X10 Y10\nM3 S90\nG1 X50 Y10 F2400\nX50 Y30\nX10 Y30\nX10 Y10\nM5\nG0 X20 Y20\nM3 S90\n\
    G1 X40 Y20\nX30 Y28\nX20 Y20\nM5\n";

struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A machine that speaks so, and the port where it does.
fn machine(dialect: &str, speed: &str, here: &Path) -> (Running, String) {
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(here.join("drawing.gcode"), DRAWING).unwrap();
    let arguments =
        ["simulate", "machine.toml", "--dialect", dialect, "--speed", speed, "-o", "machine.plog", "--force"];
    let mut child =
        Command::new(PROGRAM).args(arguments).current_dir(here).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let port = lines.next().unwrap().unwrap().split_once(" is simulated on ").unwrap().1.to_owned();
    std::thread::spawn(move || lines.for_each(drop)); // so that it is never held up by what it says
    (Running(child), port)
}

fn live(arguments: &[&str], here: &Path) -> Running {
    let child = Command::new(PROGRAM)
        .arg("live")
        .args(arguments)
        .current_dir(here)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    Running(child)
}

/// Its status, and all that it said.
fn finish(mut live: Running) -> (Option<i32>, String) {
    let until = Instant::now() + Duration::from_secs(120);
    let status = loop {
        if let Some(status) = live.0.try_wait().unwrap() {
            break status;
        }
        assert!(Instant::now() < until, "it does not end");
        std::thread::sleep(Duration::from_millis(20));
    };
    let mut said = String::new();
    live.0.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    live.0.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    (status.code(), said)
}

fn info(log: &str, here: &Path) -> String {
    let output = Command::new(PROGRAM).args(["info", log]).current_dir(here).output().unwrap();
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_drawing_is_sent_to_a_machine_that_is_found_by_itself() {
    let languages = [
        ("grbl", "Grbl", None),
        ("mdraw", "mDraw", Some("mdraw")),
        ("marlin", "Marlin", Some("marlin")),
        ("hpgl", "HPGL", Some("hpgl")),
        ("ebb", "EBB", None),
    ];
    for (dialect, language, extra) in languages {
        let directory = tempfile::tempdir().unwrap();
        let here = directory.path();
        let (_machine, port) = machine(dialect, "4", here);
        let mut arguments =
            vec!["drawing.gcode", "--port", &port, "--machine", "machine.toml", "--start", "-o", "host.plog"];
        // (a machine that does not greet is asked behind five seconds: once is enough)
        arguments.extend(extra.iter().flat_map(|name| ["--protocol", name]));
        let (status, said) = finish(live(&arguments, here));
        assert_eq!(status, Some(0), "{said}");
        assert!(said.contains(&format!("speaks {language}")), "{said}");
        assert!(said.contains("operations: 10 of 10 drawn"), "{said}");
        let info = info("host.plog", here);
        assert!(info.contains("anomalies: 0") && info.contains("nothing lost"), "{info}");
    }
}

#[test]
fn a_drawing_goes_on_after_its_host_was_killed() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let (_machine, port) = machine("grbl", "1", here);
    let arguments =
        ["drawing.gcode", "--port", &port, "--machine", "machine.toml", "--start", "--protocol", "grbl"];
    let mut first = live(&[&arguments[..], &["-o", "first.plog"]].concat(), here);
    let until = Instant::now() + Duration::from_secs(60);
    // Killed while it draws: once the log says that something is done.
    while !std::fs::read_to_string(here.join("first.plog")).is_ok_and(|log| log.contains("done and sent: 2 "))
    {
        assert!(Instant::now() < until, "it does not begin");
        std::thread::sleep(Duration::from_millis(20));
    }
    first.0.kill().unwrap();
    first.0.wait().unwrap();
    let second = live(&[&arguments[..], &["--resume", "first.plog", "-o", "second.plog"]].concat(), here);
    let (status, said) = finish(second);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("operations: 10 of 10 drawn"), "{said}");
    let log = std::fs::read_to_string(here.join("second.plog")).unwrap();
    assert!(!log.contains("nothing ends that the last host has sent"), "{log}");
}

#[test]
fn a_drawing_that_is_larger_than_the_machine_is_refused_before_anything_moves() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(here.join("large.gcode"), "G21\nG90\nM3\nG1 X70 Y10 F900\nM5\n").unwrap();
    let (status, said) = finish(live(&["large.gcode", "--simulate", "machine.toml", "--start"], here));
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("to (70.0, 10.0) mm, and the machine from (0, 0) to (60, 40) mm"), "{said}");
}

#[test]
fn a_port_where_nothing_answers_is_left_with_a_word() {
    let (_end, port) = plotter_replay::serial::Port::pseudo_terminal().unwrap();
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    let (status, said) = finish(live(&["--port", port.name(), "--machine", "machine.toml"], here));
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("nothing that is there answers in a language known here"), "{said}");
}

#[test]
fn a_port_that_vanishes_ends_it_with_a_word_and_the_log_is_kept() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let (machine, port) = machine("grbl", "1", here);
    let arguments =
        ["drawing.gcode", "--port", &port, "--machine", "machine.toml", "--start", "--protocol", "grbl"];
    let live = live(&[&arguments[..], &["-o", "host.plog"]].concat(), here);
    std::thread::sleep(Duration::from_millis(1_500));
    drop(machine);
    let (status, said) = finish(live);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("the recording up to here is in host.plog"), "{said}");
    let log = std::fs::read_to_string(here.join("host.plog")).unwrap();
    assert!(log.contains("the session failed"), "{log}");
    assert!(info("host.plog", here).contains("nothing lost"));
}
