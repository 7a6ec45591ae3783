//! `live` and `simulate` as a stranger uses them, without a browser.
#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::expect_used,
    reason = "a test that fails says so by a panic"
)]

use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Output};

const MACHINE: &str = "schema = 1\nname = \"test-bed\"\n[serial]\nbyte_gap_ms = 0.0\n[area]\nwidth_mm = 100.0\nheight_mm = 100.0\n";

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
        (&["line.hpgl", "--simulate", "stepper.toml"], "drive = \"dc\""),
        (&["line.hpgl", "--port", "/dev/no-such-plotter"], "there is no such serial port"),
        (&["line.hpgl", "-o", "no/such/folder.plog"], "no/such/folder.plog: the log cannot be written"),
        (&["line.hpgl", "--http-port", &taken], "used by another program"),
        (&["line.hpgl", "--port", "a", "--simulate", "machine.toml"], "cannot be used with"),
        (&["--start"], "required"),
        (&["line.hpgl", "--speed", "0"], "expected 0.01 to 100"),
        (&["line.hpgl", "--http-port", "http"], "invalid"),
    ];
    for (arguments, words) in cases {
        let (status, out, err) = run(&[&["live"], *arguments].concat(), here);
        assert_eq!(status, Some(2), "{arguments:?}: {out}{err}");
        assert!(err.contains(words), "{arguments:?}: {err}");
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
