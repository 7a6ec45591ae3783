//! `record` as a user runs it: between two pseudo terminals, killed, with a full disk, with a plotter that is
//! unplugged.
#![cfg(all(feature = "cli", feature = "serial", target_os = "linux"))]

use plotter_replay::log::{self, Event, Record};
use serialport::{SerialPort, TTYPort};
use std::fs::File;
use std::io::{Read, Write};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A plotter: the far end of a pseudo terminal, whose near end the program takes for a serial port.
struct Plotter {
    line: TTYPort,
    /// Open as long as the plotter is plugged in.
    port: Option<File>,
    name: String,
}

impl Plotter {
    fn new() -> Self {
        let (mut line, other) = TTYPort::pair().unwrap();
        line.set_timeout(Duration::from_secs(20)).unwrap();
        let name = other.name().unwrap();
        // Without the lock of a serial port, which is for the program.
        let port = File::options().read(true).write(true).custom_flags(libc::O_NOCTTY).open(&name).unwrap();
        Self { line, port: Some(port), name }
    }

    fn expect(&mut self, bytes: &[u8]) {
        let mut got = vec![0; bytes.len()];
        self.line.read_exact(&mut got).unwrap();
        assert_eq!(got, bytes);
    }
}

fn arguments<'a>(plotter: &'a Plotter, more: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec!["record", "--port", &plotter.name, "--pty", "plotter", "-o", "session.plog"];
    all.extend(more);
    all
}

/// Starts recording and waits until the port for the host is there.
fn start(plotter: &Plotter, here: &Path, more: &[&str]) -> (Child, Box<dyn SerialPort>) {
    begin("", &arguments(plotter, more), here)
}

/// The far ends of pseudo terminals are inherited by every program that a test starts, and then never close:
/// they are closed first.
const CLOSE_OTHERS: &str =
    "for fd in /proc/$$/fd/*; do fd=${fd##*/}; [ $fd -gt 2 ] && eval \"exec $fd>&-\"; done;";

fn begin(limits: &str, arguments: &[&str], here: &Path) -> (Child, Box<dyn SerialPort>) {
    let mut command = Command::new("bash");
    command.args([
        "-c",
        &format!("{CLOSE_OTHERS} {limits} exec \"$0\" \"$@\""),
        env!("CARGO_BIN_EXE_plotter-replay"),
    ]);
    command.args(arguments);
    let child = command.current_dir(here).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let link = here.join("plotter");
    let log = here.join("session.plog");
    wait_for("the port and the log", || link.exists() && log.exists());
    let host =
        serialport::new(link.to_str().unwrap(), 256_000).timeout(Duration::from_secs(20)).open().unwrap();
    (child, host)
}

fn wait_for(what: &str, mut is_there: impl FnMut() -> bool) {
    let began = Instant::now();
    while !is_there() {
        assert!(began.elapsed() < Duration::from_secs(60), "{what} did not come");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// All bytes of either direction in a log.
fn bytes(path: &Path) -> (Vec<u8>, Vec<u8>, Vec<Record>) {
    let records: Vec<Record> = log::open(path).unwrap().filter_map(Result::ok).collect();
    let (mut host, mut controller) = (Vec::new(), Vec::new());
    for record in &records {
        match &record.event {
            Event::Host(bytes) => host.extend(bytes),
            Event::Controller(bytes) => controller.extend(bytes),
            _ => {}
        }
    }
    (host, controller, records)
}

fn ended(child: Child) -> (i32, String, String) {
    let output = child.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

const TARGET: [u8; 10] = [2, 0, 0, 0, 0, 1, 0, 0, 0, 0];

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_goes_over_the_line_is_passed_on_and_recorded() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut plotter = Plotter::new();
    let (child, mut host) = start(&plotter, here, &["--for", "3", "--machine", "test"]);
    for _ in 0..20 {
        host.write_all(&TARGET).unwrap();
        plotter.expect(&TARGET);
        plotter.line.write_all(b"113+").unwrap();
        let mut answer = [0; 4];
        host.read_exact(&mut answer).unwrap();
        assert_eq!(&answer, b"113+");
    }
    let (status, out, err) = ended(child);
    assert_eq!(status, 0, "{out}{err}");
    assert!(out.contains("200 bytes of the host, 80 of the controller"), "{out}");
    let (sent, answered, records) = bytes(&here.join("session.plog"));
    assert_eq!((sent, answered), (TARGET.repeat(20), b"113+".repeat(20)));
    // An answer comes after what it answers.
    assert!(matches!(records[0].event, Event::Host(_)), "{records:?}");
    assert!(records.is_sorted_by_key(|record| record.time));
    let header = log::open(&here.join("session.plog")).unwrap().header().clone();
    assert_eq!((header.baud(), header.text("machine")), (Some(256_000), Some("test")));
    assert!(!here.join("plotter").exists(), "the link is left");

    // A second recording does not write over the first.
    let again = Command::new(env!("CARGO_BIN_EXE_plotter-replay"))
        .args(arguments(&plotter, &[]))
        .current_dir(here)
        .output()
        .unwrap();
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8(again.stderr).unwrap().contains("session.plog: is there already"));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_killed_recorder_has_lost_nothing_older_than_half_a_second() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut plotter = Plotter::new();
    let (mut child, mut host) = start(&plotter, here, &[]);
    let mut sent = Vec::new();
    let began = Instant::now();
    while began.elapsed() < Duration::from_millis(1_500) {
        host.write_all(&TARGET).unwrap();
        plotter.expect(&TARGET);
        // When it had gone through.
        sent.push(began.elapsed());
        std::thread::sleep(Duration::from_millis(5));
    }
    let killed = began.elapsed();
    child.kill().unwrap(); // kill -9
    child.wait().unwrap();
    let (recorded, _, _) = bytes(&here.join("session.plog"));
    let old = sent.iter().filter(|&&at| at + Duration::from_millis(500) < killed).count();
    println!("{} of {} targets recorded, {old} older than half a second", recorded.len() / 10, sent.len());
    assert!(recorded.len() >= old * 10 && old > 10, "{} of {old}", recorded.len() / 10);
    let summary = {
        let mut reader = log::open(&here.join("session.plog")).unwrap();
        reader.by_ref().for_each(drop);
        reader.summary()
    };
    assert!(summary.damaged_lines <= 1, "{summary}");
}

/// A disk with room for a few kilobytes: the system's limit for a file stands for it.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_full_disk_stops_the_recording_and_not_the_drawing() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut plotter = Plotter::new();
    let (child, mut host) = begin("trap '' XFSZ; ulimit -f 8;", &arguments(&plotter, &[]), here);
    // 20 kB of log, and all of it gets through.
    for _ in 0..300 {
        host.write_all(&TARGET).unwrap();
        plotter.expect(&TARGET);
        plotter.line.write_all(b"+").unwrap();
        let mut answer = [0];
        host.read_exact(&mut answer).unwrap();
    }
    // As Ctrl-C.
    Command::new("kill").arg(child.id().to_string()).status().unwrap();
    let (status, _, err) = ended(child);
    assert_eq!(status, 2, "{err}");
    assert!(
        err.contains("cannot be written")
            && err.contains("nothing is recorded any more; the bytes still go on"),
        "{err}"
    );
    let (recorded, ..) = bytes(&here.join("session.plog"));
    assert!(recorded.len() > 100, "{} bytes recorded before", recorded.len());
}

#[test]
fn a_plotter_that_is_unplugged_ends_it_with_a_word() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let mut plotter = Plotter::new();
    let (child, mut host) = start(&plotter, here, &[]);
    host.write_all(&TARGET).unwrap();
    plotter.expect(&TARGET);
    plotter.port.take();
    drop(plotter);
    let (status, _, err) = ended(child);
    assert_eq!(status, 2, "{err}");
    assert!(err.contains("has gone away") && err.contains("what came until then is recorded"), "{err}");
    let (recorded, _, records) = bytes(&here.join("session.plog"));
    assert_eq!(recorded, TARGET);
    assert!(matches!(&records.last().unwrap().event, Event::Note(note) if note.contains("has gone away")));
}

#[test]
fn what_cannot_begin_is_said_in_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let plotter = Plotter::new();
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_plotter-replay"));
        let output = command.args(arguments).current_dir(here).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    let missing = run(&["record", "--port", "/dev/no-such-plotter", "--pty", "p", "-o", "x.plog"]);
    assert_eq!(missing.0, 2);
    assert!(missing.1.contains("there is no such serial port"), "{}", missing.1);
    for (log, word) in [("/dev/full", "cannot be written"), ("no/such/place.plog", "cannot be written")] {
        let (status, err) = run(&["record", "--port", &plotter.name, "--pty", "p", "-o", log]);
        assert_eq!((status, err.lines().count()), (2, 1), "{err}");
        assert!(err.contains(log) && err.contains(word), "{err}");
    }
    std::fs::write(here.join("taken"), "a file of the user").unwrap();
    let (status, err) = run(&["record", "--port", &plotter.name, "--pty", "taken", "-o", "y.plog"]);
    assert_eq!((status, err.lines().count()), (2, 1), "{err}");
    assert_eq!(std::fs::read(here.join("taken")).unwrap(), b"a file of the user");
    let (status, _) = run(&["record", "--port", &plotter.name, "-o", "y.plog"]);
    assert_eq!(status, 2);
    assert!(!PathBuf::from("y.plog").exists());
}

/// Time on the processor of all threads of a process.
fn on_processor(process: u32) -> Duration {
    let threads = std::fs::read_dir(format!("/proc/{process}/task")).unwrap();
    let ns = threads.map(|thread| {
        let stat = std::fs::read_to_string(thread.unwrap().path().join("schedstat")).unwrap();
        stat.split(' ').next().unwrap().parse::<u64>().unwrap()
    });
    Duration::from_nanos(ns.sum())
}

/// What a recorder takes of a core while both sides send `text` over and over, a line full both ways, in
/// pieces as a USB adapter hands them over, each millisecond.
fn share_of_a_core(baud: u32, [host_text, plotter_text]: [&'static [u8]; 2]) -> f64 {
    let directory = tempfile::tempdir().unwrap();
    let here = directory.path();
    let plotter = Plotter::new();
    let (mut child, host) = start(&plotter, here, &["--baud", &baud.to_string()]);
    let Plotter { line, port, .. } = plotter;
    // A start bit, eight of data and a stop bit.
    let bytes_in =
        move |time: Duration| usize::try_from(time.as_micros() * u128::from(baud) / 10_000_000).unwrap();
    let far = line.try_clone_native().unwrap();
    let near = host.try_clone().unwrap();
    let before = on_processor(child.id());
    let mut threads = Vec::new();
    for (text, mut to, mut from) in [
        (plotter_text, Box::new(far) as Box<dyn Write + Send>, Box::new(near) as Box<dyn Read + Send>),
        (host_text, Box::new(host), Box::new(line)),
    ] {
        threads.push(std::thread::spawn(move || {
            let began = Instant::now();
            let mut sent = 0;
            while began.elapsed() < LASTS {
                std::thread::sleep(Duration::from_millis(1));
                let due = bytes_in(began.elapsed());
                let piece: Vec<u8> = (sent..due).map(|n| text[n % text.len()]).collect();
                to.write_all(&piece).unwrap();
                sent = due;
            }
            sent
        }));
        threads.push(std::thread::spawn(move || {
            let began = Instant::now();
            let (mut buffer, mut got) = ([0; 4_096], 0);
            while began.elapsed() < LASTS {
                got += from.read(&mut buffer).unwrap_or(0);
            }
            got
        }));
    }
    let counts: Vec<usize> = threads.into_iter().map(|thread| thread.join().unwrap()).collect();
    let took = on_processor(child.id()) - before;
    child.kill().unwrap();
    child.wait().unwrap();
    drop(port);
    let share = took.as_secs_f64() / LASTS.as_secs_f64();
    println!("{baud} baud, sent and got {counts:?}: {:.2} % of a core", 100.0 * share);
    let least = bytes_in(LASTS) / 5 * 4;
    assert!(counts.iter().all(|&count| count > least), "{counts:?}");
    share
}

/// How long a full line is recorded.
const LASTS: Duration = Duration::from_secs(10);
/// What a host of Grbl sends, and what a machine answers: a line each, and a report now and then.
const TEXT: [&[u8]; 2] = [
    b"G1 X120.392 Y64.000\nG1 X121.276 Y65.896\nG1 X121.818 Y67.916\n",
    b"ok\r\nok\r\nok\r\n<Run|MPos:120.392,64.000,0.000|Bf:0,17|FS:2700,0>\r\n",
];

#[test]
#[ignore = "the recorder's share of a core, half a minute: cargo test --release -p plotter-replay --features cli,serial --test all record_command:: -- --ignored"]
fn a_full_line_takes_below_a_hundredth_of_a_core() {
    for (baud, texts) in [(256_000, [&b"1"[..], b"1"]), (256_000, TEXT), (115_200, TEXT)] {
        let share = share_of_a_core(baud, texts);
        assert!(share < 0.01, "{share}");
    }
}
