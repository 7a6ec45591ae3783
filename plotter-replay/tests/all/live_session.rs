//! A drawing sent to a simulated machine, without a browser: the stop, the server's door, what goes wrong.

use plotter_motion::protocol::frame::{Decoder, Kind};
use plotter_motion::{Pen, PenMove, StepPoint, toolpath::from_mm};
use plotter_replay::live::{
    Command, DrawingStep, Line, LinkChoice, LivePage, MachineLog, Plan, Recording, Server, ServerError,
    Session, SessionSettings, SimulatedMachine, State, Telemetry,
};
use plotter_replay::log::{Event, Header, LogFile, Reader, Writer, create, open};
use plotter_replay::serial::{PortError, PortErrorKind};
use plotter_replay::{AnyController, PlotterSettings, VirtualPlotter, golden};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::watched::{
    AS_FAST_AS_IT_GOES, FOR_EVER, Step, ask_for, during, machine, until_it_is, until_it_moves, watched,
};

/// A square of 30 mm.
fn square() -> Vec<PenMove> {
    let corners = [(1_200, 0), (1_200, 1_200), (0, 1_200), (0, 0)];
    corners.map(|(x, y)| PenMove { pen: Pen::Down, target: StepPoint::new(x, y) }).to_vec()
}

fn settings(targets: u64) -> SessionSettings {
    let plan = Some(Plan { targets, way_mm: 120.0 });
    SessionSettings::default().with_byte_gap(Duration::ZERO).with_plan(plan)
}

#[test]
fn an_emergency_stop_takes_the_drive_within_one_control_period() {
    let machine = machine();
    let line = SimulatedMachine::new(&machine, Some(7)).unwrap().line(AS_FAST_AS_IT_GOES);
    let stops = Arc::new(Mutex::new(Vec::new()));
    let moved = Arc::new(Mutex::new(0));
    let mut steps = vec![ask_for(Command::Start)];
    for n in 1..=3 {
        let (stops, moved) = (Arc::clone(&stops), Arc::clone(&moved));
        steps.extend([
            until_it_moves(),
            ask_for(Command::Stop),
            Box::new(move |_, now| match now.stopped {
                Some((pressed, Some(off))) => {
                    let mut stops = stops.lock().unwrap();
                    let is_new = stops.last() != Some(&(pressed, off));
                    if is_new {
                        stops.push((pressed, off));
                    }
                    is_new && stops.len() == n
                }
                _ => false,
            }),
            until_it_is(State::Stopped),
            during(Duration::from_millis(300), move |session, now| {
                let is_still = now.duty == [0, 0] && session.state() == State::Stopped;
                *moved.lock().unwrap() += u32::from(!is_still);
            }),
            ask_for(Command::Resume),
            Box::new(|session, _| session.state() != State::Stopped),
        ]);
    }
    let session = watched(line, square(), None::<Recording<LogFile>>, settings(4), steps);
    assert_eq!(session.reached(), 4);
    let period = Duration::from_secs_f64(1.0 / machine.config().dc().unwrap().control.contouring.loop_hz);
    let stops = stops.lock().unwrap();
    assert!(stops.len() == 3 && stops.iter().all(|&(pressed, off)| off - pressed <= period), "{stops:?}");
    assert_eq!(*moved.lock().unwrap(), 0, "moved while it was stopped");
}

#[test]
fn a_paused_session_finishes_its_target_and_sends_no_other() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("session.plog");
    let recording = Some(Recording::Line(create(&path, &Header::new()).unwrap()));
    let line = SimulatedMachine::new(&machine(), Some(7)).unwrap().line(AS_FAST_AS_IT_GOES);
    let reached = Arc::new(Mutex::new(Vec::new()));
    let noted = Arc::clone(&reached);
    let steps = vec![
        ask_for(Command::Start),
        until_it_moves(),
        ask_for(Command::Pause),
        until_it_is(State::Paused),
        // a line of 30 mm takes a third of a second
        during(Duration::from_secs(2), |_, _| ()),
        during(Duration::from_secs(2), move |session, _| {
            noted.lock().unwrap().push((session.reached(), session.state()));
        }),
        ask_for(Command::Resume),
    ];
    watched(line, square(), recording, settings(4), steps);
    let reached = reached.lock().unwrap();
    assert!(
        reached.len() > 100 && reached.iter().all(|at| *at == (1, State::Paused)),
        "{:?}",
        reached.last()
    );
    // What was recorded is what was drawn.
    let mut plotter = VirtualPlotter::new(PlotterSettings::default());
    open(&path).unwrap().for_each(|record| plotter.push(&record.unwrap()));
    plotter.finish();
    assert_eq!((plotter.reached_count(), plotter.anomaly_count()), (4, 0));
}

/// A line that nothing is at the other end of.
#[derive(Debug)]
struct Cut;

impl Line for Cut {
    fn send(&self, _: &[u8]) -> Result<(), PortError> {
        Ok(())
    }

    fn receive(&self, _: &mut [u8], _: Duration) -> Result<usize, PortError> {
        Err(PortError { port: String::from("here"), kind: PortErrorKind::Gone })
    }
}

#[test]
fn a_machine_that_goes_away_fails_the_session() {
    let moves = Some(Box::new(square().into_iter().map(DrawingStep::from)) as _);
    let session = Session::open(Arc::new(Cut), moves, None::<Recording<LogFile>>, None, settings(4));
    let State::Failed(why) = session.wait(FOR_EVER) else { panic!("{:?}", session.state()) };
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
        let writer = || Writer::new(Disk(3_000), &Header::new()).unwrap();
        let simulated = SimulatedMachine::new(&machine(), Some(7)).unwrap();
        let log = MachineLog::new(writer());
        let recording = if is_machines { Recording::Machine(log.clone()) } else { Recording::Line(writer()) };
        let line = simulated.logged(log).line(AS_FAST_AS_IT_GOES);
        let was = Arc::new(Mutex::new(String::new()));
        let noted = Arc::clone(&was);
        let steps: Vec<Step> = vec![
            Box::new(move |session, _| {
                *noted.lock().unwrap() = session.recording();
                true
            }),
            ask_for(Command::Start),
        ];
        let session = watched(line, square(), Some(recording), settings(4), steps);
        assert_eq!((session.reached(), was.lock().unwrap().as_str()), (4, "on"));
        let said = session.recording();
        assert!(said.starts_with("stopped: the log cannot be written"), "{said}");
    }
}

/// What a simulated machine has recorded of itself is run again to the same bytes: by frames and by digits,
/// with a stop in it.
#[test]
fn a_session_with_a_simulated_machine_is_run_again_to_the_same_bytes() {
    let directory = tempfile::tempdir().unwrap();
    for boot in [Some(7), None] {
        let path = directory.path().join("session.plog.gz");
        let header = Header::new().with_number("baud", 256_000);
        let header = boot.map_or(header.clone(), |boot| header.with_number("boot", boot.into()));
        let log = MachineLog::new(create(&path, &header).unwrap());
        let machine = machine();
        let line =
            SimulatedMachine::new(&machine, boot).unwrap().logged(log.clone()).line(AS_FAST_AS_IT_GOES);
        let link = if boot.is_some() { LinkChoice::Frames } else { LinkChoice::Digits };
        let settings = settings(4).with_link(link);
        let steps = vec![
            ask_for(Command::Start),
            until_it_moves(),
            ask_for(Command::Stop),
            until_it_is(State::Stopped),
            Box::new(|_: &Session, now: Telemetry| now.duty == [0, 0]) as Step,
            ask_for(Command::Resume),
        ];
        let session = watched(line, square(), Some(Recording::Machine(log)), settings, steps);
        assert_eq!(session.recording(), "complete");
        golden::check(
            &path,
            || AnyController::for_log(&path, Some(&machine)).unwrap(),
            golden::Mode::Compare,
        )
        .unwrap();
        let mut plotter = VirtualPlotter::new(PlotterSettings::default());
        open(&path).unwrap().for_each(|record| plotter.push(&record.unwrap()));
        plotter.finish();
        assert_eq!((plotter.reached_count(), plotter.anomaly_count(), plotter.stop_count()), (4, 0, 1));
    }
}

/// A quarter of a circle in forty lines of 0.4 mm: more targets than the link has on its way at once.
fn quarter() -> Vec<PenMove> {
    let at = |n: u32| {
        let angle = f64::from(n) / 40.0 * core::f64::consts::FRAC_PI_2;
        StepPoint::new(from_mm(10.0 * angle.sin(), 40.0), from_mm(10.0 * (1.0 - angle.cos()), 40.0))
    };
    (1..=40).map(|n| PenMove { pen: Pen::Down, target: at(n) }).collect()
}

/// Where the bytes of a log go.
#[derive(Clone, Default)]
struct Kept(Arc<Mutex<Vec<u8>>>);

impl Write for Kept {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The log of a machine whose host draws a quarter at this speed and after each so many looks is away for a
/// while.
fn quarter_at(speed: f64, away: Option<u32>) -> Vec<u8> {
    let kept = Kept::default();
    let log = MachineLog::new(Writer::new(kept.clone(), &Header::new()).unwrap());
    let simulated = SimulatedMachine::new(&machine(), Some(7)).unwrap().logged(log.clone());
    let mut looks = 0_u32;
    let busy: Step = Box::new(move |session, _| {
        looks += 1;
        if away.is_some_and(|each| looks.is_multiple_of(each)) {
            std::thread::sleep(Duration::from_millis(30));
        }
        session.reached() >= 39
    });
    let steps = vec![ask_for(Command::Start), busy];
    let line = simulated.line(speed);
    let telemetry = line.telemetry();
    let session = watched(line, quarter(), Some(Recording::Machine(log)), settings(40), steps);
    assert_eq!(session.reached(), 40);
    let took = telemetry.lock().unwrap().time;
    assert!(took < Duration::from_secs(5), "{took:?} of the machine");
    kept.0.lock().unwrap().clone()
}

/// Payloads that a side sent again.
fn sent_again(log: &[u8], is_hosts: bool) -> u32 {
    let mut decoder = Decoder::new();
    let (mut session, mut next, mut again) = (0, 0_u8, 0);
    let mut greeting = Decoder::new();
    for record in Reader::new(log).unwrap() {
        let (bytes, is_side) = match record.unwrap().event {
            Event::Host(bytes) => (bytes, is_hosts),
            Event::Controller(bytes) => (bytes, !is_hosts),
            _ => continue,
        };
        for byte in bytes {
            if let Some(Ok(frame)) = greeting.push(byte, 0)
                && frame.kind == Kind::Hello
                && let Some(hello) = plotter_motion::protocol::Hello::from_bytes(frame.payload)
            {
                session = hello.session;
            }
            if is_side
                && let Some(Ok(frame)) = decoder.push(byte, session)
                && frame.kind == Kind::Data
            {
                let is_next = frame.sequence == next;
                again += u32::from(!is_next);
                next = next.wrapping_add(u8::from(is_next));
            }
        }
    }
    again
}

/// Host and machine share the machine's time: neither is impatient with the other because this computer is
/// slow, at any speed.
#[test]
fn a_session_is_the_same_at_any_speed_and_sends_nothing_twice() {
    let usual = quarter_at(AS_FAST_AS_IT_GOES, None);
    assert_eq!((sent_again(&usual, true), sent_again(&usual, false)), (0, 0));
    for (speed, away) in [(4.0, None), (10.0, None), (50.0, Some(40)), (200.0, None), (1e6, Some(40))] {
        let log = quarter_at(speed, away);
        assert!(log == usual, "at {speed} times its time, away after {away:?} looks");
    }
}

/// What the server answers to a request for a page.
fn ask(address: &str, path: &str, headers: &str) -> String {
    ask_by("GET", address, path, headers)
}

/// The same with another method: the head of the answer at least.
fn ask_by(method: &str, address: &str, path: &str, headers: &str) -> String {
    let host = address.strip_prefix("http://").unwrap().split('/').next().unwrap();
    let mut stream = TcpStream::connect(host).unwrap();
    let host_line = if headers.contains("Host:") { String::new() } else { format!("Host: {host}\r\n") };
    // At once, and not always to its end: who is refused at the first line is not listened to any further.
    let _ = stream.write_all(format!("{method} {path} HTTP/1.1\r\n{host_line}{headers}\r\n").as_bytes());
    stream.set_read_timeout(Some(FOR_EVER)).unwrap();
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
    let session =
        Session::open(Arc::new(Cut), None, None::<Recording<LogFile>>, None, SessionSettings::default());
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
    assert!(ask_by("HEAD", &address, &format!("/{path}"), "").starts_with("HTTP/1.1 200 OK\r\n"));
    assert!(ask_by("POST", &address, &format!("/{path}"), "").starts_with("HTTP/1.1 404"));
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
