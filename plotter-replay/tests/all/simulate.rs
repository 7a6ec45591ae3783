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
pub(crate) struct Simulated {
    child: Child,
    said: BufReader<ChildStdout>,
    pub(crate) port: String,
}

impl Simulated {
    pub(crate) fn new(arguments: &[&str], here: &Path) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
            .arg("simulate")
            .args(arguments)
            .current_dir(here)
            .stdin(Stdio::piped())
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
    pub(crate) fn end(mut self) -> (Option<i32>, String) {
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
pub(crate) fn until(port: &mut (impl Read + ?Sized), words: &str) -> String {
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
    lines.extend(["M5", "G0 X40 Y20", "M3", "G2 X40 Y20 I-10 J0", "G3 X20 Y20 R10"].map(String::from));
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
    // What its log is decoded as: all places are met, arcs among them, and nothing lies beside its line.
    let (status, info) = run(&["info", "machine.plog"], here);
    assert_eq!(status, Some(0), "{info}");
    let numbers = |begins: &str| -> Vec<f64> {
        let line = info.lines().find_map(|line| line.strip_prefix(begins)).unwrap();
        line.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
    };
    let targets = numbers("targets: ");
    assert!(targets[0] > 150.0 && targets[0] == targets[1], "{info}");
    assert!(numbers("contour error: ")[1] < 0.05, "{info}"); // mm: four steps
    assert!(info.contains("anomalies: 0"), "{info}");
}

const STEPPERS: &str = "schema = 1\nname = \"small\"\ndrive = \"stepper\"\n[area]\nwidth_mm = 60.0\nheight_mm = 40.0\n\
    [homing]\nfast_rate_hz = 8000.0\nslow_rate_hz = 4000.0\npull_off_mm = 1.0\nrelease_mm = 5.0\nknown_travel_mm = 20.0\n\
    max_travel_mm = 100.0\n";

/// A small machine with steppers, its log `machine.plog`.
fn small(arguments: &[&str], here: &Path) -> Simulated {
    std::fs::write(here.join("small.toml"), STEPPERS).unwrap();
    Simulated::new(&[&["small.toml", "-o", "machine.plog"], arguments].concat(), here)
}

/// Waits until the machine says to stand at this place, whatever else it says meanwhile.
fn rests_at(port: &mut (impl Read + Write + ?Sized), place: &str) {
    let began = Instant::now();
    loop {
        port.write_all(b"?").unwrap();
        let heard = until(port, ">");
        if heard.contains(&format!("<Idle|MPos:{place}")) {
            return;
        }
        assert!(began.elapsed() < PATIENCE, "it is not at {place}: {heard}");
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// Its log is whole, and its controller does the same again.
fn assert_runs_again(here: &Path) -> String {
    let (status, said) = run(&["check", "machine.plog", "--machine", "small.toml"], here);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("equal: "), "{said}");
    let (_, info) = run(&["info", "machine.plog"], here);
    info
}

#[test]
fn a_machine_homes_by_its_switches_and_a_held_carriage_loses_steps() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut simulated = small(&["--speed", "20", "--by-hand"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    port.write_all(b"$22=1\n").unwrap();
    until(&mut *port, "ok");
    port.write_all(b"$H\n").unwrap();
    until(&mut *port, "ok");
    port.write_all(b"G1 X10 F2000\nG4 P0\n").unwrap();
    until(&mut *port, "ok\r\nok");
    port.write_all(b"?").unwrap();
    assert!(until(&mut *port, ">").contains("<Idle|MPos:10.00"));
    // A hand in the way.
    simulated.child.stdin.as_mut().unwrap().write_all(b"explode\nhold x\n").unwrap();
    std::thread::sleep(Duration::from_millis(500));
    port.write_all(b"G1 X20\nG4 P0\n").unwrap();
    until(&mut *port, "ok\r\nok");
    std::thread::sleep(Duration::from_millis(600));
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    assert!(
        said.contains("homes at") && said.contains("found \"explode\"") && said.contains("lost steps: x "),
        "{said}"
    );
    assert!(assert_runs_again(here).contains("switches: "));
}

#[test]
fn a_script_stops_presses_and_lays_paper() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let script = "0 paper 15 40\n4 stop\n5 free\n5.5 reset\n";
    std::fs::write(here.join("script.txt"), script).unwrap();
    let simulated = small(&["--script", "script.txt"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    port.write_all(b"M3\nG1 X20 F1200\nG1 X40 F60\n").unwrap();
    let heard = until(&mut *port, "ALARM:10");
    assert!(heard.starts_with("ok") || heard.contains("ok"), "{heard}");
    std::thread::sleep(Duration::from_secs(2));
    port.write_all(b"$X\n").unwrap();
    until(&mut *port, "ok");
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("beside the paper") && said.contains("stopped by its button"), "{said}");
    let info = assert_runs_again(here);
    assert!(info.contains("emergency stops: 2") && info.contains("alarm 10"), "{info}");
}

#[test]
fn a_simulation_that_is_killed_keeps_its_log_but_for_the_last_half_second() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--speed", "4"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    port.write_all(b"G1 X10 F600\n").unwrap();
    rests_at(&mut *port, "10.00");
    std::thread::sleep(Duration::from_millis(700));
    drop(simulated); // by SIGKILL
    // Whoever has the port open is told so.
    let began = Instant::now();
    while port.write_all(b"?").is_ok() {
        assert!(began.elapsed() < PATIENCE, "the port of a machine that is gone still takes bytes");
        std::thread::sleep(Duration::from_millis(20));
    }
    let info = assert_runs_again(here);
    assert!(info.contains("nothing lost") && info.contains("ends at (10.00"), "{info}");
}

#[test]
fn a_port_that_is_closed_and_opened_again_finds_the_machine_as_it_was() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--speed", "4"], here);
    {
        let mut port = simulated.open();
        until(&mut *port, "Grbl 1.1");
        port.write_all(b"G91\nG1 X10 F600\n").unwrap();
        until(&mut *port, "ok\r\nok");
    }
    // It goes on while nobody listens, and is not reset: a pseudo terminal has no DTR, as Grbl on USB of
    // its own.
    std::thread::sleep(Duration::from_millis(500));
    let mut port = simulated.open();
    port.write_all(b"G1 X5\n").unwrap();
    assert!(!until(&mut *port, "ok").contains("Grbl"));
    rests_at(&mut *port, "15.00");
    assert_eq!(simulated.end().0, Some(0));
    assert_runs_again(here);
}

#[test]
fn half_a_line_waits_for_its_other_half_whoever_sends_it() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--speed", "4"], here);
    {
        let mut port = simulated.open();
        until(&mut *port, "Grbl 1.1");
        port.write_all(b"G1 X1").unwrap();
    }
    let mut port = simulated.open();
    std::thread::sleep(Duration::from_millis(500));
    port.write_all(b"?").unwrap();
    assert!(until(&mut *port, ">").contains("<Idle|MPos:0.000")); // nothing moves by half a line
    port.write_all(b"0 F600\n").unwrap();
    rests_at(&mut *port, "10.00");
    assert_eq!(simulated.end().0, Some(0));
    let info = assert_runs_again(here);
    assert!(info.contains("lines: 1 sent, 1 taken by the machine, 0 refused"), "{info}");
}

#[test]
fn noise_is_refused_line_by_line_and_moves_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--speed", "4"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    // Unprintable bytes are passed over, as Grbl does; what is left are two lines that are none, and one
    // that is too long.
    port.write_all(b"\x00\x07G1 Q\x7f9\nGG\n").unwrap();
    until(&mut *port, "error:");
    port.write_all(&[&[b'X'; 100][..], b"\n"].concat()).unwrap();
    until(&mut *port, "error:11");
    // Every byte but those of its own orders (reset, jog cancel, questions), in lines.
    let all: Vec<u8> =
        (0..=255).filter(|byte| !matches!(byte, 0x18 | 0x85 | b'?' | b'!' | b'~' | b'$')).collect();
    for piece in all.chunks(20) {
        port.write_all(&[piece, b"\n"].concat()).unwrap();
        std::thread::sleep(Duration::from_millis(20));
    }
    port.write_all(b"G1 X10 F600\n").unwrap();
    rests_at(&mut *port, "10.00");
    assert_eq!(simulated.end().0, Some(0));
    let info = assert_runs_again(here);
    assert!(info.contains("nothing lost") && info.contains("refused: error 11"), "{info}");
}

#[test]
fn a_flood_without_waiting_is_refused_by_whole_lines_and_the_rest_is_drawn() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--speed", "4"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    port.write_all(b"F600\n").unwrap();
    until(&mut *port, "ok");
    let flood: String = (0..400).map(|n| format!("G1 X{} Y{}\n", 10 + n % 2, n % 3)).collect();
    port.write_all(flood.as_bytes()).unwrap();
    let heard = until(&mut *port, "error:11");
    assert!(heard.contains("ok"), "{heard}");
    // It does what it is told once what was taken before is drawn.
    std::thread::sleep(Duration::from_millis(500));
    port.write_all(b"G1 X20 Y5\n").unwrap();
    rests_at(&mut *port, "20.00");
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    let info = assert_runs_again(here);
    assert!(info.contains("nothing lost") && info.contains("refused: error 11"), "{info}");
}

#[test]
fn two_senders_at_once_are_one_line_of_bytes_as_on_a_cable() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--speed", "4"], here);
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    // Half a line of each is one line.
    let mut other = std::fs::OpenOptions::new().write(true).open(&simulated.port).unwrap();
    other.write_all(b"G1 X1").unwrap();
    std::thread::sleep(Duration::from_millis(200));
    port.write_all(b"5 F600\n").unwrap();
    until(&mut *port, "ok");
    rests_at(&mut *port, "15.00");
    other.write_all(b"?").unwrap(); // each hears what was asked by either
    until(&mut *port, ">");
    drop((other, port));
    assert_eq!(simulated.end().0, Some(0));
    let info = assert_runs_again(here);
    assert!(info.contains("lines: 1 sent, 1 taken by the machine, 0 refused"), "{info}");
}

#[test]
fn a_host_that_never_reads_does_not_hold_up_the_machine() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut simulated = small(&["--speed", "50"], here);
    let mut port = simulated.open();
    // Some 60 bytes each: far more than a line, a system and the machine keep.
    for _ in 0..100 {
        port.write_all(&[b'?'; 40]).unwrap();
        std::thread::sleep(Duration::from_millis(20));
    }
    let (mut line, began) = (String::new(), Instant::now());
    while !line.contains("bytes said that nobody has read") {
        assert!(began.elapsed() < PATIENCE, "{line}");
        line.clear();
        simulated.said.read_line(&mut line).unwrap();
    }
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    assert_runs_again(here);
}

#[test]
fn on_a_port_of_this_computer_one_program_at_a_time_has_the_line() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--tcp", "0", "--dialect", "mdraw"], here);
    let connect = || {
        let stream = std::net::TcpStream::connect(&simulated.port).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
        stream
    };
    let mut first = connect();
    first.write_all(b"M10\n").unwrap();
    assert!(until(&mut first, "OK").contains("M10 XY 60 40 0.00 0.00 A0 B0 H0 S80 U160 D90"));
    let mut second = connect();
    let mut byte = [0];
    let began = Instant::now();
    while !matches!(second.read(&mut byte), Ok(0)) {
        assert!(began.elapsed() < PATIENCE, "the second program was not sent away");
    }
    drop(first);
    std::thread::sleep(Duration::from_millis(300));
    let mut third = connect();
    third.write_all(b"G1 X3 Y4\n").unwrap();
    assert!(until(&mut third, "OK").contains("distance=5.00"));
    third.write_all(b"P\n").unwrap();
    assert!(until(&mut third, "OK").contains("POS X3.00 Y4.00"));
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("another program was sent away") && said.contains("has gone"), "{said}");
    let info = assert_runs_again(here);
    assert!(info.contains("lines: 3 sent, 3 taken by the machine"), "{info}");
}

#[test]
fn a_marking_board_draws_targets_in_digits_and_its_log_is_run_again() {
    use plotter_motion::StepPoint;
    use plotter_motion::protocol::digits;
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let machine = machines().join("marking-board.toml");
    let machine = machine.to_str().unwrap();
    let simulated = Simulated::new(&[machine, "--speed", "4", "-o", "board.plog"], here);
    let mut port = simulated.open();
    // From the middle, (150, 100) mm, 5 mm to the right and 3 mm up, of 46.3 counts to the millimetre.
    port.write_all(&digits::encode(StepPoint::new(7_176, 4_769)).unwrap()).unwrap();
    until(&mut *port, "+");
    std::thread::sleep(Duration::from_millis(400));
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    let (status, said) = run(&["check", "board.plog", "--machine", machine], here);
    assert!(status == Some(0) && said.contains("equal: 1 answered bytes"), "{said}");
    let (_, info) = run(&["info", "board.plog"], here);
    assert!(info.contains("targets: 1 sent, 1 reached") && info.contains("anomalies: 0"), "{info}");
}

#[test]
fn an_ebb_answers_on_a_pseudo_terminal_and_its_log_is_run_again() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let simulated = small(&["--dialect", "ebb", "--speed", "4"], here);
    let mut port = simulated.open();
    port.write_all(b"V\r").unwrap();
    until(&mut *port, "EBBv13_and_above EB Firmware Version 2.8.1\r\n");
    port.write_all(b"EM,1,1\rSP,0,100\rXM,200,40,20\rSM,10,0,0\rSM,10,0,0\rQS\r").unwrap();
    until(&mut *port, "60,20\n\rOK\r\n");
    std::thread::sleep(Duration::from_millis(400));
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    assert_runs_again(here);
}

#[test]
fn a_script_that_is_none_is_refused_with_its_line() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("script.txt"), "1 press x-min\nsoon stop\n").unwrap();
    let (status, said) = run(&["simulate", "--script", "script.txt"], here);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("script.txt: line 2: expected seconds"), "{said}");
}

#[test]
fn the_page_of_a_machine_shows_where_it_is_and_stops_it() {
    use tungstenite::client::IntoClientRequest as _;
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut simulated = small(&["--page"], here);
    let mut line = String::new();
    simulated.said.read_line(&mut line).unwrap();
    let address = line.trim().strip_prefix("look at http://").unwrap().to_owned();
    let host = address.split('/').next().unwrap();
    let mut request = format!("ws://{address}socket").into_client_request().unwrap();
    request.headers_mut().insert("Origin", format!("http://{host}").parse().unwrap());
    let stream = std::net::TcpStream::connect(host).unwrap();
    let (mut page, _) = tungstenite::client(request, stream).unwrap();
    let mut port = simulated.open();
    until(&mut *port, "Grbl 1.1");
    port.write_all(b"G1 X30 F1200\n").unwrap();
    let wait_for = |page: &mut tungstenite::WebSocket<_>, is: &dyn Fn(&serde_json::Value) -> bool| {
        let began = Instant::now();
        loop {
            assert!(began.elapsed() < PATIENCE, "the page does not show it");
            let message = page.read().unwrap();
            let Ok(text) = message.to_text() else { continue };
            let Ok(update) = serde_json::from_str(text) else { continue };
            if is(&update) {
                return;
            }
        }
    };
    // On its way, by the steps that it makes.
    wait_for(&mut page, &|update| update["at"][0].as_f64().is_some_and(|x| (1.0..29.0).contains(&x)));
    page.send(tungstenite::Message::text("stop")).unwrap();
    until(&mut *port, "ALARM:10");
    wait_for(&mut page, &|update| update["state"] == "stopped");
    let (status, said) = simulated.end();
    assert_eq!(status, Some(0), "{said}");
    let info = assert_runs_again(here);
    assert!(info.contains("emergency stops: 1"), "{info}");
}
