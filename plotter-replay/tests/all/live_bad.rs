//! `live` with machines that do what none should: nothing moves unasked, each is a state that is said, and
//! the log is kept.
#![cfg(unix)]

use plotter_replay::live::Line as _;
use plotter_replay::serial::Port;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_plotter-replay");
const STEPPERS: &str = "schema = 1\nname = \"steppers\"\ndrive = \"stepper\"\n[area]\nwidth_mm = 60.0\nheight_mm = 40.0\n\
    [serial]\nbaud = 115200\n[pen]\nsettle_ms = 20.0\n[homing]\nknown_travel_mm = 0.0\nmax_travel_mm = 80.0\n";
const GANTRY: &str = "schema = 1\nname = \"test-bed\"\n[serial]\nbyte_gap_ms = 0.0\n[area]\nwidth_mm = 100.0\nheight_mm = 100.0\n";
const DRAWING: &str = "G21\nG90\nG0 X10 Y10\nM3 S90\nG1 X50 Y10 F1200\nX50 Y30\nX10 Y30\nX10 Y10\nM5\n";
const FOR_EVER: Duration = Duration::from_secs(120);

struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn start(arguments: &[&str], here: &Path) -> Running {
    let child = Command::new(PROGRAM)
        .args(arguments)
        .current_dir(here)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    Running(child)
}

/// A simulated machine to which something is done by hand, and its port.
fn simulated(machine: &str, dialect: &str, here: &Path) -> (Running, ChildStdin, String) {
    std::fs::write(here.join("machine.toml"), machine).unwrap();
    std::fs::write(here.join("drawing.gcode"), DRAWING).unwrap();
    let mut child = Command::new(PROGRAM)
        .args(["simulate", "machine.toml", "--dialect", dialect, "--by-hand", "-o", "machine.plog"])
        .current_dir(here)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let port = lines.next().unwrap().unwrap().split_once(" is simulated on ").unwrap().1.to_owned();
    std::thread::spawn(move || lines.for_each(drop));
    let hand = child.stdin.take().unwrap();
    (Running(child), hand, port)
}

/// How long the machine's log is when its host has seen something, by the machine's time.
fn last_time(log: &Path) -> Duration {
    plotter_replay::log::open(log).unwrap().filter_map(Result::ok).map(|record| record.time).max().unwrap()
}

/// Waits until a log has these words; what it has.
fn until(log: &Path, words: &str) -> String {
    let until = Instant::now() + FOR_EVER;
    loop {
        let text = std::fs::read_to_string(log).unwrap_or_default();
        if text.contains(words) {
            return text;
        }
        assert!(Instant::now() < until, "{words} is never said: {text}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Steps, or duties other than none, behind a time of a machine's log.
fn moves_behind(log: &Path, after: Duration) -> usize {
    let records = plotter_replay::log::open(log).unwrap().filter_map(Result::ok);
    let moves = records.filter(|record| {
        record.time > after && matches!(record.event, plotter_replay::log::Event::Edge { .. })
    });
    moves.count()
}

#[test]
fn a_machine_that_alarms_in_the_middle_is_locked_and_stands_until_it_is_asked() {
    stands_after("press x-max\n", "alarm 1: a limit switch was pressed");
}

#[test]
fn a_machine_that_is_reset_in_the_middle_stands_until_its_place_is_known() {
    stands_after("restart\n", "was switched off or reset before operation");
}

/// Something is done to a Grbl machine in the middle of its drawing; the host says so, and nothing moves.
fn stands_after(what: &str, words: &str) {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let (machine, mut hand, port) = simulated(STEPPERS, "grbl", here);
    let arguments = [
        "live",
        "drawing.gcode",
        "--port",
        &port,
        "--machine",
        "machine.toml",
        "--protocol",
        "grbl",
        "--start",
        "-o",
        "host.plog",
    ];
    let live = start(&arguments, here);
    until(&here.join("host.plog"), "done and sent: 1 ");
    hand.write_all(what.as_bytes()).unwrap();
    until(&here.join("host.plog"), words);
    std::thread::sleep(Duration::from_secs(1)); // its log is written through
    let at = last_time(&here.join("machine.plog"));
    std::thread::sleep(Duration::from_secs(2));
    drop((live, machine));
    let log = here.join("machine.plog");
    assert!(last_time(&log) > at && moves_behind(&log, Duration::ZERO) > 0);
    assert_eq!(moves_behind(&log, at), 0);
}

/// What is at the other end of a line: it answers to what it hears, and keeps that.
struct End {
    port: String,
    heard: Arc<Mutex<Vec<u8>>>,
    is_over: Arc<AtomicBool>,
}

impl End {
    fn new(mut answer: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static) -> Self {
        let (end, port) = Port::pseudo_terminal().unwrap();
        let name = port.name().to_owned();
        let line = plotter_replay::live::PortLine::new(end).unwrap();
        let (heard, is_over) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicBool::new(false)));
        let (keeps, ends) = (Arc::clone(&heard), Arc::clone(&is_over));
        std::thread::spawn(move || {
            let _port = port; // open, so that the line does not go away between two programs
            let mut bytes = [0; 256];
            while !ends.load(Ordering::SeqCst) {
                let count = line.receive(&mut bytes, Duration::from_millis(20)).unwrap_or(0);
                keeps.lock().unwrap().extend_from_slice(&bytes[..count]);
                let _ = line.offer(&answer(&bytes[..count]));
            }
        });
        Self { port: name, heard, is_over }
    }
}

impl Drop for End {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::SeqCst);
    }
}

#[test]
fn a_machine_that_answers_nonsense_is_no_machine_and_is_sent_nothing_that_moves() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), STEPPERS).unwrap();
    std::fs::write(here.join("drawing.gcode"), DRAWING).unwrap();
    let mut state = 1_u32;
    let noise = move |asked: &[u8]| -> Vec<u8> {
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            [b'#', b'%', b'\n', 0xC3, 0x28, b'{', 0x7F, b'~'][(state >> 24) as usize % 8]
        };
        (0..asked.len().max(3)).map(|_| next()).collect()
    };
    let end = End::new(noise);
    // Found out by itself: it is none of them.
    let arguments = [
        "live",
        "drawing.gcode",
        "--port",
        &end.port,
        "--machine",
        "machine.toml",
        "--baud",
        "115200",
        "--start",
        "-o",
        "found.plog",
    ];
    let mut live = start(&arguments, here);
    let until = Instant::now() + FOR_EVER;
    let status = loop {
        if let Some(status) = live.0.try_wait().unwrap() {
            break status;
        }
        assert!(Instant::now() < until);
        std::thread::sleep(Duration::from_millis(20));
    };
    let mut said = String::new();
    live.0.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(status.code(), Some(2), "{said}");
    assert!(said.contains("nothing that is there answers in a language known here"), "{said}");
    // Taken for a machine that it is not: it is asked how it is, and told nothing else.
    for protocol in ["grbl", "marlin", "mdraw", "ebb"] {
        end.heard.lock().unwrap().clear();
        let log = format!("{protocol}.plog");
        let arguments = [
            "live",
            "drawing.gcode",
            "--port",
            &end.port,
            "--machine",
            "machine.toml",
            "--protocol",
            protocol,
            "--start",
            "-o",
            &log,
        ];
        let live = start(&arguments, here);
        std::thread::sleep(Duration::from_secs(5));
        drop(live);
        let heard = String::from_utf8_lossy(&end.heard.lock().unwrap()).into_owned();
        for word in ["G0", "G1", "M3", "PD", "SM,", "LM,", "XM,"] {
            assert!(!heard.contains(word), "{protocol}: {heard}");
        }
        assert!(!heard.is_empty() && heard.len() < 400, "{protocol}: {} bytes", heard.len());
        assert!(here.join(&log).metadata().unwrap().len() > 100, "{protocol}");
    }
}

#[test]
fn a_machine_that_never_answers_is_said_to_be_silent_and_is_asked_no_more_than_that() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), GANTRY).unwrap();
    std::fs::write(here.join("drawing.gcode"), DRAWING).unwrap();
    // A machine of targets: it is called, and told no target.
    let end = End::new(|_| Vec::new());
    let arguments = [
        "live",
        "drawing.gcode",
        "--port",
        &end.port,
        "--machine",
        "machine.toml",
        "--link",
        "frames",
        "--start",
        "-o",
        "host.plog",
    ];
    let live = start(&arguments, here);
    std::thread::sleep(Duration::from_secs(4));
    drop(live);
    let heard = end.heard.lock().unwrap().len();
    // A call has some twenty bytes and comes at longer and longer times.
    assert!((10..2_000).contains(&heard), "{heard} bytes");
    assert!(here.join("host.plog").metadata().unwrap().len() > 50);
}

/// A machine that takes bytes until its buffer is full, and never says that a line is carried out.
#[test]
fn a_machine_whose_buffer_is_full_is_sent_no_more() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    std::fs::write(here.join("machine.toml"), STEPPERS).unwrap();
    let long: String = (0..400).map(|n| format!("G1 X{} Y{} F600\n", 10 + n % 40, 5 + n % 30)).collect();
    std::fs::write(here.join("drawing.gcode"), format!("G21\nG90\nM3\n{long}M5\n")).unwrap();
    let taken = Arc::new(Mutex::new(0_usize));
    let counts = Arc::clone(&taken);
    let end = End::new(move |asked| {
        let mut answer = Vec::new();
        for &byte in asked {
            if byte == b'?' {
                answer.extend_from_slice(b"<Run|MPos:1.000,1.000,0.000|FS:600,0>\r\n");
            } else if byte < 0x80 {
                *counts.lock().unwrap() += 1;
            }
        }
        if asked.contains(&b'$') {
            *counts.lock().unwrap() = 0; // (its settings are asked for: answered, so it is heard)
            answer.extend_from_slice(b"ok\r\n");
        }
        answer
    });
    let arguments = [
        "live",
        "drawing.gcode",
        "--port",
        &end.port,
        "--machine",
        "machine.toml",
        "--protocol",
        "grbl",
        "--start",
        "-o",
        "host.plog",
    ];
    let live = start(&arguments, here);
    std::thread::sleep(Duration::from_secs(8));
    drop(live);
    // Grbl's buffer has 128 bytes.
    let taken = *taken.lock().unwrap();
    assert!((60..=128).contains(&taken), "{taken} bytes without an answer");
}
