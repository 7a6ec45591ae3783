//! A drawing sent to a simulated machine, without a browser: the stop, the server's door, what goes wrong.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::expect_used,
    reason = "a test that fails says so by a panic"
)]

use plotter_motion::{Machine, MachineConfig, Pen, PenMove, SerialConfig, StepPoint};
use plotter_replay::live::{
    Command, Line, LinkChoice, LivePage, MachineLog, Pipe, Plan, Recording, Server, ServerError, Session,
    SessionSettings, SimulatedMachine, State,
};
use plotter_replay::log::{Header, LogFile, Writer, create, open};
use plotter_replay::{AnyController, PlotterSettings, VirtualPlotter, golden};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The gantry with a host that does not pause between bytes.
fn machine() -> Machine {
    let config = MachineConfig::default();
    Machine::new(MachineConfig { serial: SerialConfig { byte_gap_ms: 0.0, ..config.serial }, ..config })
        .unwrap()
}

/// A square of 30 mm.
fn square() -> Vec<PenMove> {
    let corners = [(1_200, 0), (1_200, 1_200), (0, 1_200), (0, 0)];
    corners.map(|(x, y)| PenMove { pen: Pen::Down, target: StepPoint::new(x, y) }).to_vec()
}

fn settings(targets: u64) -> SessionSettings {
    let plan = Some(Plan { targets, way_mm: 120.0 });
    SessionSettings { byte_gap: Duration::ZERO, plan, ..SessionSettings::default() }
}

fn until(what: &str, mut is_so: impl FnMut() -> bool) {
    let end = Instant::now() + Duration::from_secs(20);
    while !is_so() {
        assert!(Instant::now() < end, "in vain: {what}");
        std::thread::sleep(Duration::from_micros(200));
    }
}

#[test]
fn an_emergency_stop_takes_the_drive_within_one_control_period() {
    let machine = machine();
    let (host, end) = Pipe::pair();
    let simulated = SimulatedMachine::start(&machine, Arc::new(end), 1.0, 7);
    let telemetry = simulated.telemetry();
    let session = Session::open(
        Arc::new(host),
        Some(Box::new(square().into_iter())),
        None::<Recording<LogFile>>,
        Some(telemetry.clone()),
        settings(4),
    );
    assert_eq!(session.state(), State::Ready);
    session.command(Command::Start);
    let period = Duration::from_secs_f64(1.0 / machine.config().control.contouring.loop_hz);
    for _ in 0..3 {
        until("it moves", || telemetry.lock().unwrap().duty != [0, 0]);
        let before = telemetry.lock().unwrap().stopped;
        session.command(Command::Stop);
        let last = || telemetry.lock().unwrap().stopped;
        until("it stopped", || last() != before && matches!(last(), Some((_, Some(_)))));
        let (pressed, off) = telemetry.lock().unwrap().stopped.unwrap();
        assert!(off.unwrap() - pressed <= period, "{pressed:?} {off:?}");
        until("the session knows", || session.state() == State::Stopped);
        std::thread::sleep(Duration::from_millis(30));
        assert_eq!(telemetry.lock().unwrap().duty, [0, 0]);
        session.command(Command::Resume);
        until("it goes on", || session.state() != State::Stopped);
    }
    assert_eq!(session.wait(Duration::from_secs(20)), State::Done);
    assert_eq!(session.reached(), 4);
}

#[test]
fn a_paused_session_finishes_its_target_and_sends_no_other() {
    let machine = machine();
    let (host, end) = Pipe::pair();
    let _simulated = SimulatedMachine::start(&machine, Arc::new(end), 4.0, 7);
    let settings = SessionSettings { speed: 4.0, ..settings(4) };
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("session.plog");
    let recorder = create(&path, &Header::new()).unwrap();
    let moves = Box::new(square().into_iter());
    let session = Session::open(Arc::new(host), Some(moves), Some(Recording::Line(recorder)), None, settings);
    session.command(Command::Start);
    session.command(Command::Pause);
    until("the target under way is finished", || session.reached() == 1 || session.state() == State::Paused);
    std::thread::sleep(Duration::from_millis(400));
    let reached = session.reached();
    assert!(reached <= 1);
    std::thread::sleep(Duration::from_millis(200));
    assert_eq!((session.reached(), session.state()), (reached, State::Paused));
    session.command(Command::Resume);
    assert_eq!(session.wait(Duration::from_secs(20)), State::Done);
    // What was recorded is what was drawn.
    let mut plotter = VirtualPlotter::new(PlotterSettings::default());
    open(&path).unwrap().for_each(|record| plotter.push(&record.unwrap()));
    plotter.finish();
    assert_eq!((plotter.reached_count(), plotter.anomaly_count()), (4, 0));
}

#[test]
fn a_machine_that_goes_away_fails_the_session() {
    let (host, end) = Pipe::pair();
    let session = Session::open(
        Arc::new(host),
        Some(Box::new(square().into_iter())),
        None::<Recording<LogFile>>,
        None,
        settings(4),
    );
    session.command(Command::Start);
    drop(end);
    let State::Failed(why) = session.wait(Duration::from_secs(5)) else { panic!("{:?}", session.state()) };
    assert!(why.contains("gone away"), "{why}");
}

/// A disk with room for so many bytes.
struct Disk(usize);

impl Write for Disk {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_stops_the_recording_and_not_the_drawing() {
    for is_machines in [false, true] {
        let writer = Writer::new(Disk(3_000), &Header::new()).unwrap();
        let (host, end) = Pipe::pair();
        let log = MachineLog::new(writer);
        let (recording, log) = if is_machines {
            (Recording::Machine(log.clone()), Some(log))
        } else {
            (Recording::Line(Writer::new(Disk(3_000), &Header::new()).unwrap()), None)
        };
        let _simulated = SimulatedMachine::logged(&machine(), Arc::new(end), 4.0, Some(7), log);
        let moves = Box::new(square().into_iter());
        let settings = SessionSettings { speed: 4.0, ..settings(4) };
        let session = Session::open(Arc::new(host), Some(moves), Some(recording), None, settings);
        assert_eq!(session.recording(), "on");
        session.command(Command::Start);
        assert_eq!(session.wait(Duration::from_secs(20)), State::Done);
        assert_eq!(session.reached(), 4);
        assert!(
            session.recording().starts_with("stopped: the log cannot be written"),
            "{}",
            session.recording()
        );
    }
}

/// What a simulated machine has recorded of itself is run again to the same bytes: by frames and by digits, with a stop in it.
#[test]
fn a_session_with_a_simulated_machine_is_run_again_to_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    for boot in [Some(7), None] {
        let path = directory.path().join("session.plog.gz");
        let header = Header::new().with_number("baud", 256_000);
        let header = boot.map_or(header.clone(), |boot| header.with_number("boot", boot.into()));
        let log = MachineLog::new(create(&path, &header).unwrap());
        let (host, end) = Pipe::pair();
        let machine = machine();
        let simulated = SimulatedMachine::logged(&machine, Arc::new(end), 2.0, boot, Some(log.clone()));
        let telemetry = simulated.telemetry();
        let link = if boot.is_some() { LinkChoice::Frames } else { LinkChoice::Digits };
        let settings = SessionSettings { speed: 2.0, link, ..settings(4) };
        let moves = Box::new(square().into_iter());
        let recording = Some(Recording::Machine(log));
        let session =
            Session::open(Arc::new(host), Some(moves), recording, Some(telemetry.clone()), settings);
        session.command(Command::Start);
        until("it moves", || telemetry.lock().unwrap().duty != [0, 0]);
        session.command(Command::Stop);
        until("it is stopped", || session.state() == State::Stopped);
        // On a busy computer the machine may learn of the stop later than the session.
        until("the motors are off", || telemetry.lock().unwrap().duty == [0, 0]);
        session.command(Command::Resume);
        assert_eq!(session.wait(Duration::from_secs(20)), State::Done);
        assert_eq!(session.recording(), "complete");
        golden::check(&path, || AnyController::of_log(&path, Some(&machine)).unwrap(), golden::Mode::Compare)
            .unwrap();
        let mut plotter = VirtualPlotter::new(PlotterSettings::default());
        open(&path).unwrap().for_each(|record| plotter.push(&record.unwrap()));
        plotter.finish();
        assert_eq!((plotter.reached_count(), plotter.anomaly_count(), plotter.stop_count()), (4, 0, 1));
    }
}

/// What the server answers to a request.
fn ask(address: &str, path: &str, headers: &str) -> String {
    let host = address.strip_prefix("http://").unwrap().split('/').next().unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let host_line = if headers.contains("Host:") { String::new() } else { format!("Host: {host}\r\n") };
    write!(stream, "GET {path} HTTP/1.1\r\n{host_line}{headers}\r\n").unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    let (mut answer, mut part) = (Vec::new(), [0; 1_024]);
    while !answer.windows(2).any(|end| end == b"\r\n") {
        match stream.read(&mut part) {
            Ok(count @ 1..) => answer.extend_from_slice(&part[..count]),
            _ => break,
        }
    }
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn only_who_knows_the_token_and_comes_from_this_page_gets_in() {
    let (host, _machine) = Pipe::pair();
    let line: Arc<dyn Line> = Arc::new(host);
    let session = Session::open(line, None, None::<Recording<LogFile>>, None, SessionSettings::default());
    let page = LivePage::new("gantry", PlotterSettings::default());
    let server =
        Server::open(session.clone(), 0, |sources| page.finish([0.0, 0.0, 1.0, 1.0], sources)).unwrap();
    let address = server.address().to_owned();
    let path = address.split_once("//").unwrap().1.split_once('/').unwrap().1;
    let own = format!("http://{}", address.strip_prefix("http://").unwrap().split('/').next().unwrap());
    let status =
        |path: &str, headers: &str| ask(&address, path, headers).chars().skip(9).take(3).collect::<String>();
    assert_eq!(path.len(), 33, "128 bits in hex");
    assert_eq!(status(&format!("/{path}"), ""), "200");
    assert_eq!(status("/", ""), "403");
    assert_eq!(status(&format!("/{}/", "0".repeat(32)), ""), "403");
    assert_eq!(status(&format!("/{}", &path[..31]), ""), "403");
    assert_eq!(status(&format!("/{path}"), "Host: plotter.example\r\n"), "403");
    assert_eq!(status(&format!("/{path}elsewhere"), ""), "404");
    let upgrade = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    let socket = format!("/{path}socket");
    assert_eq!(status(&socket, upgrade), "403", "no origin");
    assert_eq!(status(&socket, &format!("{upgrade}Origin: http://plotter.example\r\n")), "403");
    assert_eq!(status("/0/socket", &format!("{upgrade}Origin: {own}\r\n")), "403");
    assert_eq!(status(&socket, &format!("{upgrade}Origin: {own}\r\n")), "101");
    assert_eq!(status("nonsense", ""), "403");
    assert_eq!(status("three words here", ""), "400");
    // Too long a head is not read to its end, so its answer may be lost with the connection.
    assert_ne!(status(&format!("/{path}"), &format!("X: {}\r\n", "x".repeat(20_000))), "200");

    // A second one on the same port is refused, with what to do.
    let port = own.rsplit(':').next().unwrap().parse().unwrap();
    let error = Server::open(session, port, |_| String::new()).unwrap_err();
    assert_eq!(error, ServerError::InUse { port });
    assert!(error.to_string().contains("another one"), "{error}");
}
