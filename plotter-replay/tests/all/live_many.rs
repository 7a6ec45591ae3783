//! A drawing of a million targets, shown twenty times a second.
//!
//! ```text
//! cargo test --release -p plotter-replay --features cli,live --test all live_many:: -- --include-ignored --nocapture
//! ```

use crate::driven::machine;
use plotter_motion::gcode::WriteOptions;
use plotter_motion::protocol::hosts::{Grbl, LineHost, LineHostSettings};
use plotter_motion::{Pen, PenMove, PlotOp, Point, StepPoint};
use plotter_replay::PlotterSettings;
use plotter_replay::live::{
    Command, DrawingStep, Line, LinkChoice, LivePage, Plan, Recording, Server, Session, SessionSettings,
    State, Timetable,
};
use plotter_replay::log::LogFile;
use plotter_replay::serial::PortError;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// A machine of digits that is at each target at once, and tells each count on its way.
#[derive(Debug, Default)]
struct Quick(Mutex<(Vec<u8>, StepPoint, Vec<u8>)>);

impl Line for Quick {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        let mut inside = self.0.lock().unwrap();
        let (digits, at, answers) = &mut *inside;
        digits.extend(bytes);
        while digits.len() >= 10 {
            let number = |part: &[u8]| part.iter().rev().fold(0, |sum, &digit| sum * 10 + i32::from(digit));
            let to = StepPoint::new(number(&digits[..5]), number(&digits[5..10]));
            digits.drain(..10);
            for (by, plus, minus) in [(to.x - at.x, b'1', b'2'), (to.y - at.y, b'3', b'4')] {
                answers.extend((0..by.abs()).map(|_| if by > 0 { plus } else { minus }));
            }
            answers.push(b'+');
            *at = to;
        }
        Ok(())
    }
    fn receive(&self, bytes: &mut [u8], _: Duration) -> Result<usize, PortError> {
        let mut inside = self.0.lock().unwrap();
        let count = inside.2.len().min(bytes.len());
        bytes[..count].copy_from_slice(&inside.2[..count]);
        inside.2.drain(..count);
        Ok(count)
    }
}

/// A machine of Grbl's lines that is at each place at once.
#[derive(Debug, Default)]
struct Obedient(Mutex<(Vec<u8>, [f64; 2], Vec<u8>)>);

impl Line for Obedient {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        let mut inside = self.0.lock().unwrap();
        let (line, at, answers) = &mut *inside;
        for &byte in bytes {
            match byte {
                b'?' => {
                    let [x, y] = *at;
                    answers.extend(format!("<Idle|MPos:{x:.3},{y:.3},0.000|FS:0,0>\r\n").bytes());
                }
                0x18 => answers.extend(b"\r\nGrbl 1.1h ['$' for help]\r\n"),
                b'\n' => {
                    let text = String::from_utf8(std::mem::take(line)).unwrap();
                    // A word begins with its letter.
                    let word = |letter| text.split_once(letter)?.1.split(|c: char| c.is_alphabetic()).next();
                    for (place, letter) in at.iter_mut().zip(['X', 'Y']) {
                        *place = word(letter).map_or(*place, |number| number.trim().parse().unwrap());
                    }
                    answers.extend(b"ok\r\n");
                }
                byte => line.push(byte),
            }
        }
        Ok(())
    }
    fn receive(&self, bytes: &mut [u8], _: Duration) -> Result<usize, PortError> {
        let mut inside = self.0.lock().unwrap();
        let count = inside.2.len().min(bytes.len());
        bytes[..count].copy_from_slice(&inside.2[..count]);
        inside.2.drain(..count);
        Ok(count)
    }
}

/// Lines of two hundredths of a millimetre, up and down the sheet.
fn operation(n: u64) -> PlotOp {
    let StepPoint { x, y } = target(n).target;
    PlotOp::Draw { to: Point::new(0.01 * f64::from(x), 0.01 * f64::from(y)), feed_mm_s: None }
}

/// Targets two counts apart, up and down the sheet.
fn target(n: u64) -> PenMove {
    let (row, along) = (n / 10_000, n % 10_000);
    let along = if row.is_multiple_of(2) { along } else { 9_999 - along };
    let count = |value: u64| i32::try_from(value).unwrap();
    PenMove { pen: Pen::Down, target: StepPoint::new(count(2 * along), count(2 * row)) }
}

/// Draws so many targets on a machine of digits.
fn watched(targets: u64) -> (f64, usize) {
    let mut page = LivePage::new("quick", PlotterSettings::default());
    (0..targets).for_each(|n| page.push(target(n)));
    let settings = SessionSettings::default()
        .with_byte_gap(Duration::ZERO)
        .with_link(LinkChoice::Digits)
        .with_baud(1_000_000_000)
        .with_plan(Some(Plan { targets, way_mm: page.plan().way_mm }));
    let drawing = Box::new((0..targets).map(|n| DrawingStep::from(target(n))));
    let session =
        Session::open(Arc::new(Quick::default()), Some(drawing), None::<Recording<LogFile>>, None, settings);
    looked_at(&session, page, targets)
}

/// The same of a machine that answers lines.
fn watched_on_grbl(operations: u64) -> (f64, usize) {
    let mut page = LivePage::new("quick", PlotterSettings::default());
    let mut table = Timetable::new(&machine()).unwrap();
    let mut from = Point::ORIGIN;
    for op in (0..operations).map(operation) {
        page.push_op(from, op, 1);
        table.push(op);
        from = op.target().unwrap_or(from);
    }
    page.takes(table.finish());
    let options = WriteOptions { settle: Duration::ZERO, ..WriteOptions::default() };
    let host = LineHost::new(Grbl::new(options), LineHostSettings::default(), (0..operations).map(operation));
    let settings = SessionSettings::default().with_baud(1_000_000_000);
    let line = Arc::new(Obedient::default());
    let session = Session::hosted(line, Box::new(host), Some(table), None::<Recording<LogFile>>, settings);
    while session.state() != State::Ready {
        assert!(!session.wait(Duration::from_millis(1)).is_final(), "{:?}", session.state());
    }
    looked_at(&session, page, operations)
}

/// Draws while a page looks on: updates a second, and the longest one in bytes.
fn looked_at(session: &Session, page: LivePage, targets: u64) -> (f64, usize) {
    let server =
        Server::open(session.clone(), 0, |sources| page.finish([0.0, 0.0, 500.0, 20.0], sources)).unwrap();
    let address = server.address().strip_prefix("http://").unwrap().to_owned();
    let (host, path) = address.split_once('/').unwrap();
    // The page itself is small, however many targets there are.
    let mut stream = TcpStream::connect(host).unwrap();
    write!(stream, "GET /{path} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
    let mut text = Vec::new();
    stream.read_to_end(&mut text).unwrap();
    assert!(text.len() < 2_500_000, "{} bytes", text.len());
    let stream = TcpStream::connect(host).unwrap();
    let request = tungstenite::http::Request::builder()
        .uri(format!("ws://{host}/{path}socket"))
        .header("Host", host)
        .header("Origin", format!("http://{host}"))
        .header("Connection", "Upgrade")
        .header("Upgrade", "websocket")
        .header("Sec-WebSocket-Version", "13")
        .header("Sec-WebSocket-Key", tungstenite::handshake::client::generate_key())
        .body(())
        .unwrap();
    let (mut socket, _) = tungstenite::client(request, stream).unwrap();
    session.command(Command::Start);
    let (began, mut updates, mut longest) = (Instant::now(), Vec::new(), 0);
    while let Ok(message) = socket.read() {
        if let tungstenite::Message::Text(text) = message {
            updates.push(Instant::now());
            longest = longest.max(text.len());
        }
    }
    let took = began.elapsed();
    assert_eq!((session.wait(Duration::ZERO), session.reached()), (State::Done, targets));
    updates.pop(); // the last one comes with the end
    let periods = u32::try_from(updates.len() - 1).unwrap();
    let rate = f64::from(periods) / (*updates.last().unwrap() - updates[0]).as_secs_f64();
    println!("{targets} targets in {took:.1?}: {rate:.1} updates/s, at most {longest} bytes");
    (rate, longest)
}

#[test]
fn a_page_is_told_twenty_times_a_second_in_short_messages() {
    let (rate, longest) = watched(60_000);
    // (a busy computer may be late, and is never early)
    assert!(rate > 10.0 && rate < 25.0, "{rate}");
    assert!(longest < 1_000_000, "{longest}");
}

#[test]
fn of_a_machine_of_lines_as_often() {
    let (rate, longest) = watched_on_grbl(60_000);
    assert!(rate > 10.0 && rate < 25.0, "{rate}");
    assert!(longest < 1_000_000, "{longest}");
}

#[test]
#[ignore = "a million targets: cargo test --release -p plotter-replay --features cli,live --test all live_many:: -- --include-ignored --nocapture"]
fn also_of_a_million_targets() {
    for (rate, longest) in [watched(1_000_000), watched_on_grbl(1_000_000)] {
        assert!(rate > 19.0, "{rate}");
        assert!(longest < 1_000_000, "{longest}");
    }
}
