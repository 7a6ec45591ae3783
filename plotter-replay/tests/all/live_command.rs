//! `live` and `simulate` as a stranger uses them, without a browser.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const MACHINE: &str = "schema = 1\nname = \"test-bed\"\n[serial]\nbyte_gap_ms = 0.0\n[area]\nwidth_mm = 100.0\nheight_mm = 100.0\n";
/// Two motors on one belt.
const BELT: &str = "schema = 1\n[area]\nwidth_mm = 100.0\nheight_mm = 100.0\n[kinematics]\ntype = \"corexy\"\n[belt]\nstart_x_mm = 50.0\n\
    start_y_mm = 50.0\n[control.contouring]\nfeed_mm_s = 30.0\n[x]\nencoder.decoding = \"x2\"\n[y]\nencoder.decoding = \"x2\"\n";

fn run(arguments: &[&str], here: &Path) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args(arguments)
        .current_dir(here)
        .output()
        .unwrap();
    (status.code(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
}

#[test]
fn what_cannot_be_driven_is_said_in_a_line_with_status_2() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(
        here.join("stepper.toml"),
        "schema = 1\ndrive = \"stepper\"\n[area]\nwidth_mm = 100.0\nheight_mm = 100.0\n",
    )
    .unwrap();
    std::fs::write(here.join("belt.toml"), BELT).unwrap();
    std::fs::write(here.join("line.hpgl"), "IN;PU0,0;PD400,0;").unwrap();
    std::fs::write(here.join("far.hpgl"), "IN;PU900000,0;PD900000,100;").unwrap();
    std::fs::write(here.join("empty.hpgl"), "").unwrap();
    std::fs::write(here.join("log.hpgl"), "plotter-log 1 {}\n").unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = taken.local_addr().unwrap().port().to_string();
    let cases: &[(&[&str], &str)] = &[
        (&["nowhere.hpgl"], "nowhere.hpgl: cannot be read"),
        (&["."], "this is a folder"),
        (&["empty.hpgl"], "the file is empty"),
        (&["log.hpgl"], "a recording, not a drawing"),
        (&["far.hpgl"], "nothing in it that this machine could draw"),
        (&["line.hpgl", "--simulate", "nowhere.toml"], "nowhere.toml: cannot be read"),
        (&["line.hpgl", "--simulate", "line.hpgl"], "line.hpgl:"),
        (
            &["far.hpgl", "--simulate", "stepper.toml"],
            "and the machine from (0, 0) to (100, 100) mm: move or scale it",
        ),
        (
            &["line.hpgl", "--simulate", "belt.toml", "--link", "frames"],
            "a machine with one belt has digits only",
        ),
        (
            &["line.hpgl", "--port", "/dev/no-such-plotter", "--machine", "belt.toml"],
            "there is no such serial port",
        ),
        (&["line.hpgl", "--pen", "red"], "expected a number, `=` and a name"),
        (&["line.hpgl", "--pen", "0=red"], "1 to 255"),
        (&["line.hpgl", "--port", "/dev/no-such-plotter"], "there is no such serial port"),
        (&["line.hpgl", "-o", "no/such/folder.plog"], "no/such/folder.plog: the log cannot be written"),
        (&["line.hpgl", "--http-port", &taken], "used by another program"),
        (&["line.hpgl", "--port", "a", "--simulate", "machine.toml"], "cannot be used with"),
        (&["--start"], "required"),
        (&["line.hpgl", "--speed", "0"], "expected 0.01 to 1000000"),
        (&["line.hpgl", "--http-port", "http"], "invalid"),
    ];
    for (arguments, words) in cases {
        let (status, out, err) = run(&[&["live"], *arguments].concat(), here);
        assert_eq!(status, Some(2), "{arguments:?}: {out}{err}");
        assert!(err.contains(words), "{arguments:?}: {err}");
    }
    for (machine, dialect, words) in [
        ("belt.toml", "link", "this machine has DC motors on one belt"),
        ("belt.toml", "grbl", "this machine has DC motors on one belt"),
        ("stepper.toml", "digits", "this machine has stepper motors"),
        ("machine.toml", "mdraw", "this machine has DC motors that each move an axis"),
    ] {
        let (status, out, err) = run(&["simulate", machine, "--dialect", dialect], here);
        assert_eq!(status, Some(2), "{machine}: {out}{err}");
        assert!(err.starts_with(&format!("plotter-replay: {machine}: ")) && err.contains(words), "{err}");
    }
}

#[test]
fn a_drawing_in_any_language_is_drawn_and_recorded() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    let drawings = [
        ("a.hpgl", "IN;SP1;PU400,400;PD800,400;"),
        ("a.gcode", "G21\nG0 X10 Y10\nG1 X20 Y10\n"),
        ("a.txt", "PU, 00400, 00400\nPD, 00800, 00400\n"),
    ];
    for (name, text) in drawings {
        std::fs::write(here.join(name), text).unwrap();
        let arguments =
            ["live", name, "--simulate", "machine.toml", "--speed", "4", "--start", "-o", "a.plog"];
        let (status, out, err) = run(&arguments, here);
        assert_eq!((status, err.as_str()), (Some(0), ""), "{name}: {out}");
        assert!(out.contains("SIMULATED") && out.contains("http://127.0.0.1:"), "{out}");
        assert!(out.contains("targets: 2 of 2 reached"), "{name}: {out}");
        let (status, out, _) = run(&["info", "a.plog"], here);
        assert_eq!(status, Some(0));
        assert!(
            out.contains("targets: 2 sent, 2 reached") && out.contains("ends at (20.000, 10.000)"),
            "{out}"
        );
    }
    // What lies outside the machine is left out, said, and makes the status 1.
    std::fs::write(here.join("far.hpgl"), "IN;PU400,400;PD800,400,900000,400,800,800;").unwrap();
    let (status, out, _) =
        run(&["live", "far.hpgl", "--simulate", "machine.toml", "--speed", "4", "--start"], here);
    assert_eq!(status, Some(1));
    assert!(out.contains("far.hpgl: 1 errors, left out") && out.contains("lies outside"), "{out}");
}

/// The marking board, where this crate stands beside its machines.
const BOARD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/machines/marking-board.toml");

#[test]
fn a_board_with_one_belt_draws_from_where_its_pen_is_and_its_log_is_run_again() {
    if !Path::new(BOARD).exists() {
        println!("{BOARD} is not here: left out");
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("a.hpgl"), "IN;SP1;PU6400,4400;PD6800,4400,6800,4800;").unwrap();
    let arguments = ["live", "a.hpgl", "--simulate", BOARD, "--speed", "20", "--start", "-o", "belt.plog"];
    let (status, out, err) = run(&arguments, here);
    assert_eq!((status, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.contains("targets: 3 of 3 reached"), "{out}");
    let (_, out, _) = run(&["info", "belt.plog"], here);
    assert!(out.contains("targets: 3 sent, 3 reached") && out.contains("nothing lost"), "{out}");
    let (status, out, err) = run(&["check", "belt.plog", "--machine", BOARD], here);
    assert_eq!(status, Some(0), "{out}{err}");
}

/// A program that ends with the test.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A machine on a pseudo terminal, and its port.
fn simulated(arguments: &[&str], here: &Path) -> (Running, String) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args([&["simulate", "machine.toml"], arguments].concat())
        .current_dir(here)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let port = line.trim().split_once(" is simulated on ").unwrap().1.to_owned();
    (Running(child), port)
}

/// Lines of 5 mm, to and fro.
fn zigzag() -> String {
    let corners = (1..=40).map(|n| format!(",{},{}", n * 40, (n % 2) * 200));
    format!("IN;PU0,0;PD0,0{};", corners.collect::<String>())
}

fn info(log: &str, here: &Path) -> String {
    run(&["info", log], here).1
}

#[test]
fn a_host_that_was_killed_goes_on_from_its_log_and_every_target_is_drawn_once() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(here.join("drawing.hpgl"), zigzag()).unwrap();
    std::fs::write(here.join("other.hpgl"), "IN;PU0,0;PD400,0;").unwrap();
    let (_machine, port) = simulated(&["--speed", "2"], here);
    let drive = ["live", "--port", &port, "--machine", "machine.toml", "--start"];
    let first = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args([&drive[..], &["drawing.hpgl", "-o", "one.plog"]].concat())
        .current_dir(here)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut first = Running(first);
    let until = Instant::now() + Duration::from_secs(60);
    let reached = |log: &str| -> u32 {
        let said = info(log, here);
        let words = said.split(" reached").next().unwrap_or_default();
        words.rsplit(' ').next().and_then(|n| n.parse().ok()).unwrap_or(0)
    };
    while reached("one.plog") < 5 {
        assert!(Instant::now() < until, "{}", info("one.plog", here));
        std::thread::sleep(Duration::from_millis(50));
    }
    first.0.kill().unwrap();
    first.0.wait().unwrap();
    let before = reached("one.plog");
    assert!((5..41).contains(&before), "{before}");
    // Another drawing is refused, and so is a log that would be written over.
    for (arguments, word) in [
        (["other.hpgl", "--resume", "one.plog", "-o", "two.plog"], "another drawing"),
        (["drawing.hpgl", "--resume", "one.plog", "-o", "one.plog"], "give another one"),
        (["drawing.hpgl", "--resume", "machine.toml", "-o", "two.plog"], "machine.toml: "),
    ] {
        let (status, _, err) = run(&[&drive[..], &arguments].concat(), here);
        assert_eq!(status, Some(2), "{err}");
        assert!(err.contains(word), "{err}");
    }
    let (status, out, err) =
        run(&[&drive[..], &["drawing.hpgl", "--resume", "one.plog", "-o", "two.plog"]].concat(), here);
    assert_eq!((status, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.contains("targets: 41 of 41 reached"), "{out}");
    // The second log holds no target that the first host's machine had begun.
    let after = info("two.plog", here);
    assert!(after.contains("ends at (40.000, 0.000) mm") && after.contains("anomalies: 0"), "{after}");
    let sent: u32 = after.split("targets: ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(sent + before <= 41 && sent > 0, "{before} before, {sent} after\n{after}");
}

/// The machine's own log is run again to the same bytes; that of a recorder between the two, message by
/// message; and so is the host's.
#[test]
fn what_was_recorded_of_frames_in_the_machine_beside_it_and_at_the_host_is_run_again() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(here.join("line.hpgl"), "IN;PU0,0;PD200,0,200,200;PU0,0;").unwrap();
    let (machine, port) = simulated(&["--speed", "2", "-o", "machine.plog"], here);
    let relay = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args(["record", "--port", &port, "--pty", "between", "-o", "record.plog"])
        .current_dir(here)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut relay = Running(relay);
    let until = Instant::now() + Duration::from_secs(30);
    while !here.join("between").exists() {
        assert!(Instant::now() < until, "the recorder does not begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    let drive = ["live", "--port", "between", "--machine", "machine.toml", "--start", "line.hpgl"];
    let (status, out, err) = run(&[&drive[..], &["--link", "frames", "-o", "host.plog"]].concat(), here);
    assert_eq!((status, err.as_str()), (Some(0), ""), "{out}");
    std::thread::sleep(Duration::from_millis(700)); // what is older than half a second is in the log
    relay.0.kill().unwrap();
    relay.0.wait().unwrap();
    drop(machine); // killed
    for (log, words) in [
        ("machine.plog", ["equal: ", " duty cycles in "]),
        ("record.plog", ["the motors are where the machine told", "equal: "]),
        ("host.plog", ["the motors are where the machine told", "equal: "]),
    ] {
        let (status, out, err) = run(&["check", log, "--machine", "machine.toml"], here);
        assert_eq!((status, err.as_str()), (Some(0), ""), "{log}: {out}");
        assert!(words.iter().all(|word| out.contains(word)), "{log}: {out}");
    }
    // A machine half as wide refuses a target, and that is said.
    std::fs::write(here.join("small.toml"), MACHINE.replace("width_mm = 100.0", "width_mm = 4.0")).unwrap();
    for log in ["machine.plog", "record.plog"] {
        let (status, out, _) = run(&["check", log, "--machine", "small.toml"], here);
        assert_eq!(status, Some(1), "{log}: {out}");
        assert!(out.contains("first difference at "), "{log}: {out}");
        // What differs first is the answer or, where the target came just before a tick, a duty cycle.
        let (_, out, _) = run(&["replay", log, "--machine", "small.toml"], here);
        assert!(out.contains("refused 1"), "{log}: {out}");
    }
    let (status, out, _) = run(&["replay", "record.plog", "--machine", "machine.toml"], here);
    assert_eq!(status, Some(0));
    assert!(out.contains("target 200 0 pen down") && out.contains("reached 3"), "{out}");
}

#[test]
fn who_finds_a_stopped_machine_is_told() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(here.join("line.hpgl"), "IN;PU0,0;PD200,0;").unwrap();
    let (_machine, port) = simulated(&["--speed", "2"], here);
    std::fs::write(&port, "!").unwrap();
    let mut live = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args([
            "live",
            "--port",
            &port,
            "--machine",
            "machine.toml",
            "--start",
            "line.hpgl",
            "--link",
            "frames",
        ])
        .current_dir(here)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let said = BufReader::new(live.stdout.take().unwrap());
    let _live = Running(live);
    // (it waits until somebody presses Resume; the test ends by what it says, or by the machine's end)
    let said: Vec<String> =
        said.lines().map_while(Result::ok).take_while(|line| !line.contains(" reached")).take(3).collect();
    assert!(said.last().is_some_and(|line| line.contains("the machine is stopped")), "{said:?}");
}

#[test]
fn a_machine_that_knows_digits_only_is_spoken_to_in_digits_or_refused() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
    std::fs::write(here.join("line.hpgl"), "IN;PU0,0;PD200,0,200,200;PU0,0;").unwrap();
    let drive = |port: &str, link: &str, log: &str| {
        let arguments = [
            "live",
            "--port",
            port,
            "--machine",
            "machine.toml",
            "--start",
            "line.hpgl",
            "--link",
            link,
            "-o",
            log,
        ];
        run(&arguments, here)
    };
    let (_old, old) = simulated(&["--digits", "--speed", "2"], here);
    let (_new, new) = simulated(&["--speed", "2"], here);
    for (port, link, log, speech) in [
        (&old, "auto", "a.plog", "the machine knows the digits protocol only"),
        (&old, "digits", "b.plog", "protocol: \"digits\""),
        (&new, "digits", "c.plog", "protocol: \"digits\""),
        (&new, "frames", "d.plog", "protocol: \"link\""),
    ] {
        let (status, out, err) = drive(port, link, log);
        assert_eq!((status, err.as_str()), (Some(0), ""), "{log}: {out}");
        let said = info(log, here);
        assert!(said.contains(speech), "{log}: {said}");
        assert!(
            said.contains("targets: 3 sent, 3 reached") && said.contains("anomalies: 0"),
            "{log}: {said}"
        );
        assert!(said.contains("ends at (0.000, 0.000) mm"), "{log}: {said}");
    }
    let (status, _, err) = drive(&old, "frames", "e.plog");
    assert_eq!(status, Some(2), "{err}");
    assert!(err.contains("the machine knows the digits protocol only"), "{err}");
}
