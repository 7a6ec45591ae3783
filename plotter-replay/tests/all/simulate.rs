//! `simulate` as other programs use it: a sender on its port, and its log run again.

use plotter_motion::gcode::{PlotOps, ReadOptions};
use plotter_motion::stepgen::{MotorEvent, timed_events};
use plotter_motion::{Axis, Machine};
use plotter_replay::log::{self, Event};
use std::io::{BufRead as _, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time that a test waits for an answer.
const PATIENCE: Duration = Duration::from_secs(120);

/// A simulated machine, which ends with the test.
struct Simulated {
    child: Child,
    said: BufReader<ChildStdout>,
    port: String,
}

impl Simulated {
    fn new(arguments: &[&str], here: &Path) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
            .arg("simulate")
            .args(arguments)
            .current_dir(here)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut said = BufReader::new(child.stdout.take().unwrap());
        let mut line = String::new();
        said.read_line(&mut line).unwrap();
        let port = line.trim().split_once(" is simulated on ").unwrap().1.to_owned();
        Self { child, said, port }
    }

    /// Its port, with time-outs of 50 ms.
    fn open(&self) -> Box<dyn serialport::SerialPort> {
        serialport::new(&self.port, 115_200).timeout(Duration::from_millis(50)).open().unwrap()
    }

    /// Ends it as Ctrl-C does; its status and the rest of what it said.
    fn end(mut self) -> (Option<i32>, String) {
        let ended =
            Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap().success();
        assert!(ended);
        let mut rest = String::new();
        self.said.read_to_string(&mut rest).unwrap();
        (self.child.wait().unwrap().code(), rest)
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn machines() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines")
}

fn run(arguments: &[&str], here: &Path) -> (Option<i32>, String) {
    let out = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args(arguments)
        .current_dir(here)
        .output()
        .unwrap();
    let text = [out.stdout, out.stderr].map(|bytes| String::from_utf8(bytes).unwrap()).concat();
    (out.status.code(), text)
}

/// Reads until this is there; all that came.
fn until(port: &mut (impl Read + ?Sized), words: &str) -> String {
    let (mut heard, began) = (String::new(), Instant::now());
    let mut bytes = [0; 256];
    while !heard.contains(words) {
        assert!(began.elapsed() < PATIENCE, "{words:?} did not come: {heard:?}");
        let count = port.read(&mut bytes).unwrap_or(0);
        heard.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
    heard
}

/// Sends lines as a program that streams to Grbl does: as many bytes ahead as its receive buffer has, each
/// line counted until its answer comes. How many answers were `ok`.
fn stream(port: &mut (impl Read + Write + ?Sized), lines: &[String]) -> usize {
    const BUFFER: usize = 128;
    let (mut waiting, mut heard, mut oks, began) =
        (std::collections::VecDeque::new(), String::new(), 0, Instant::now());
    let mut next = lines.iter().peekable();
    let mut bytes = [0; 256];
    while next.peek().is_some() || !waiting.is_empty() {
        assert!(began.elapsed() < PATIENCE, "{} lines wait for an answer", waiting.len());
        while let Some(line) = next.next_if(|line| waiting.iter().sum::<usize>() + line.len() < BUFFER) {
            port.write_all(format!("{line}\n").as_bytes()).unwrap();
            waiting.push_back(line.len() + 1);
        }
        let count = port.read(&mut bytes).unwrap_or(0);
        heard.push_str(&String::from_utf8_lossy(&bytes[..count]));
        while let Some((line, rest)) = heard.split_once("\r\n") {
            if line == "ok" || line.starts_with("error:") {
                oks += usize::from(line == "ok");
                waiting.pop_front().unwrap();
            }
            heard = rest.to_owned();
        }
    }
    oks
}

/// A spiral of chords and two squares, some 100 lines.
fn drawing() -> Vec<String> {
    let mut lines: Vec<String> = ["G21", "G90", "F2400", "G0 X30 Y20", "M3 S90"].map(String::from).to_vec();
    for n in 1..=80 {
        let (angle, radius) = (f64::from(n) * 0.3, 0.12 * f64::from(n));
        let (x, y) = (30.0 + radius * angle.cos(), 20.0 + radius * angle.sin());
        lines.push(format!("G1 X{x:.3} Y{y:.3}"));
    }
    for side in [8, 4] {
        lines.extend(["M5".into(), format!("G0 X{side} Y{side}"), "M3 S90".into()]);
        lines.extend([
            format!("G1 X{}", 2 * side),
            format!("Y{}", 2 * side),
            format!("X{side}"),
            format!("Y{side}"),
        ]);
    }
    lines.extend(["M5", "G0 X0 Y0"].map(String::from));
    lines
}

/// The steps of the desktop's own plan for G-code.
fn planned(machine: &Machine, text: &str) -> Vec<(Axis, i32)> {
    let ops = PlotOps::with_options(text.bytes(), ReadOptions::default()).map(Result::unwrap);
    let events = timed_events(machine, ops).unwrap();
    events
        .filter_map(|timed| match timed.unwrap().event {
            MotorEvent::Step(step) => Some([(Axis::X, i32::from(step.x)), (Axis::Y, i32::from(step.y))]),
            _ => None,
        })
        .flatten()
        .filter(|&(_, sign)| sign != 0)
        .collect()
}

/// The steps that a log has.
fn steps(log: &Path) -> Vec<(Axis, i32)> {
    let records = log::open(log).unwrap().map(Result::unwrap);
    records
        .filter_map(|record| match record.event {
            Event::Edge { axis, sign } => Some((axis, sign.sign())),
            _ => None,
        })
        .collect()
}

#[test]
fn a_sender_that_counts_characters_draws_the_steps_of_the_plan_on_a_pseudo_terminal() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let machine = machines().join("stepper-plotter.toml");
    let simulated = Simulated::new(&[machine.to_str().unwrap(), "--speed", "8", "-o", "machine.plog"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    let lines = drawing();
    assert_eq!(stream(&mut *port, &lines), lines.len());
    port.write_all(b"G4 P0\n").unwrap();
    until(&mut *port, "ok");
    port.write_all(b"?").unwrap();
    assert!(until(&mut *port, ">").contains("<Idle|MPos:0.000,0.000,0.000|"));
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("pen down") && !said.contains("lost steps"), "{said}");
    let machine = Machine::from_toml(&std::fs::read_to_string(machine).unwrap()).unwrap();
    let (made, wanted) = (steps(&here.join("machine.plog")), planned(&machine, &lines.join("\n")));
    assert!(wanted.len() > 5_000, "{}", wanted.len());
    assert!(made == wanted, "{} steps, {} planned", made.len(), wanted.len());
    let (status, said) = run(&["check", "machine.plog"], here);
    assert_eq!(status, Some(0), "{said}");
}
