//! Simulated machines that speak Marlin's lines and HPGL: bytes in, bytes out, and what is drawn.

use crate::simulate::{self, Simulated};
use plotter_motion::{Axis, Machine, Pen};
use plotter_replay::live::{Line, MachineLine, MachineLog, SimulatedMachine, Spoken};
use plotter_replay::log::{self, Event, Header, LogFile, Record};
use plotter_replay::simulation::Script;
use plotter_replay::{AnyController, Player, PlayerSettings};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use tempfile::TempDir;

/// 60 by 40 mm, 20 steps to the millimetre, so that a step is 0.05 mm and two HPGL units.
const MACHINE: &str = "schema = 1\nname = \"small\"\ndrive = \"stepper\"\n[area]\nwidth_mm = 60.0\nheight_mm = 40.0\n\
    [x.stepper]\nsteps_per_mm = 20.0\n[y.stepper]\nsteps_per_mm = 20.0\n\
    [homing]\nfast_rate_hz = 4000.0\nslow_rate_hz = 400.0\npull_off_mm = 1.0\nrelease_mm = 5.0\nknown_travel_mm = 0.0\n\
    max_travel_mm = 100.0\n";

fn machine() -> Machine {
    Machine::from_toml(MACHINE).unwrap()
}

fn protocol(spoken: Spoken) -> &'static str {
    match spoken {
        Spoken::Marlin => "marlin",
        Spoken::Hpgl => "hpgl",
        _ => "grbl",
    }
}

/// A session with a simulated machine, in its time.
struct Session {
    line: MachineLine<LogFile>,
    log: MachineLog<LogFile>,
    spoken: Spoken,
    directory: TempDir,
}

impl Session {
    fn with_script(spoken: Spoken, script: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let header = Header::new()
            .with_number("baud", machine().config().serial.baud.into())
            .with_text("protocol", protocol(spoken))
            .with_decimal("x_mm_per_pulse", 0.05)
            .with_decimal("y_mm_per_pulse", 0.05);
        let log = MachineLog::new(log::create(&directory.path().join("machine.plog"), &header).unwrap());
        let simulated = SimulatedMachine::speaking(&machine(), spoken).unwrap();
        let simulated = simulated.with_script(Script::parse(script).unwrap());
        Self { line: simulated.logged(log.clone()).line(1e6), log, spoken, directory }
    }

    fn new(spoken: Spoken) -> Self {
        Self::with_script(spoken, "")
    }

    fn now(&self) -> Duration {
        self.line.now().unwrap()
    }

    fn say(&self, text: &str) {
        self.line.send(text.as_bytes()).unwrap();
    }

    /// What comes within so much of the machine's time.
    fn hear(&self, time: Duration) -> String {
        let until = self.now() + time;
        let (mut heard, mut bytes) = (Vec::new(), [0; 64]);
        while self.now() < until {
            let count = self.line.receive(&mut bytes, Duration::from_millis(1)).unwrap();
            heard.extend_from_slice(&bytes[..count]);
        }
        String::from_utf8(heard).unwrap()
    }

    /// What comes up to a text.
    fn until(&self, text: &str) -> String {
        let began = self.now();
        let (mut heard, mut bytes) = (Vec::new(), [0; 1]);
        loop {
            let count = self.line.receive(&mut bytes, Duration::from_millis(1)).unwrap();
            heard.extend_from_slice(&bytes[..count]);
            if heard.ends_with(text.as_bytes()) {
                return String::from_utf8(heard).unwrap();
            }
            let heard = String::from_utf8_lossy(&heard);
            assert!(self.now() < began + Duration::from_secs(200), "{text:?} does not come: {heard:?}");
        }
    }

    /// Says a text, and hears exactly this.
    fn ask(&self, text: &str, answer: &str) {
        self.say(text);
        assert_eq!(self.until(answer), answer, "after {text:?}");
    }

    /// Its log, which runs again to the same bytes.
    fn end(self) -> Drawn {
        self.log.finish().unwrap();
        let path = self.directory.path().join("machine.plog");
        let reader = log::open(&path).unwrap();
        let header = reader.header().clone();
        let records: Vec<Record> = reader.map(Result::unwrap).collect();
        let controller = AnyController::for_header(&header, Some(&machine())).unwrap();
        let player = Player::new(PlayerSettings::for_recording(&header, &records));
        let outcome = player.check(records.clone(), controller);
        assert!(outcome.is_equal(), "{} {outcome:?}", protocol(self.spoken));
        Drawn { records, path, directory: self.directory }
    }
}

/// What a machine has done.
struct Drawn {
    records: Vec<Record>,
    path: PathBuf,
    directory: TempDir,
}

impl Drawn {
    /// How many steps were made with the pen down and up, and where they lead.
    fn steps(&self) -> ([u32; 2], [i32; 2]) {
        let (mut made, mut at, mut is_down) = ([0, 0], [0, 0], 0);
        for record in &self.records {
            match record.event {
                Event::Pen(pen) => is_down = usize::from(pen == Pen::Down),
                Event::Edge { axis, sign } => {
                    made[1 - is_down] += 1;
                    at[usize::from(axis == Axis::Y)] += sign.sign();
                }
                _ => {}
            }
        }
        (made, at)
    }
}

const GREETING: &str = "start\necho:Marlin 2.1.2 (simulated)\n";

/// A line with its number and its checksum.
fn numbered(number: u32, line: &str) -> String {
    let text = format!("N{number} {line}");
    let checksum = text.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("{text}*{checksum}\n")
}

fn marlin() -> Session {
    let session = Session::new(Spoken::Marlin);
    session.ask("", GREETING);
    session
}

fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

#[test]
fn marlin_answers_each_command_as_documented() {
    let session = marlin();
    for (said, answer) in [
        ("M105\n", "ok T:20.00 /0.00 @:0\n"),
        ("M114\n", "X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0\nok\n"),
        ("G1 X10 Y5.5 F3000\n", "ok\n"),
        // The place is that of the plan, at once.
        ("M114\n", "X:10.00 Y:5.50 Z:0.00 E:0.00 Count X:200 Y:110 Z:0\nok\n"),
        ("G91\r\nG0 X-2.5 Z3\n", "ok\nok\n"),
        ("G92 X1 E7\n", "ok\n"),
        ("M114 ; where\n", "X:1.00 Y:5.50 Z:3.00 E:7.00 Count X:150 Y:110 Z:3\nok\n"),
        ("G90\nG20\nG1X1\nG21\n", "ok\nok\nok\nok\n"),
        ("M114\n", "X:25.40 Y:5.50 Z:3.00 E:7.00 Count X:638 Y:110 Z:3\nok\n"),
        ("M17\nM84\nM18\n", "ok\nok\nok\n"),
        ("G2 X1\n", "Error:G2/G3 bad parameters\nok\n"),
        ("M280 P0\n", "echo: Servo 0: 160\nok\n"),
        ("M280 P0 S90\nM280 P0\n", "ok\necho: Servo 0: 90\nok\n"),
        ("M280 P1 S3\n", "Error:Servo 1 out of range\nok\n"),
        ("M5\nM3\n", "ok\nok\n"),
        ("M999 X1\n", "echo:Unknown command: \"M999 X1\"\nok\n"),
        ("hello\n", "echo:Unknown command: \"hello\"\nok\n"),
        ("\n\r\n; nothing\nM400\n", "ok\n"),
        ("M110 N41\n", "ok\n"),
        (&numbered(42, "M400"), "ok\n"),
    ] {
        session.ask(said, answer);
    }
    session.say("M115\n");
    let said = session.until("ok\n");
    assert!(said.starts_with("FIRMWARE_NAME:Marlin 2.1.2 (simulated) "), "{said}");
    assert!(said.contains("\nCap:AUTOREPORT_TEMP:1\nCap:EMERGENCY_PARSER:1\n"), "{said}");
    // Nothing was said beyond that.
    assert_eq!(session.hear(seconds(1.0)), "");
    session.end();
}

#[test]
fn marlin_asks_again_for_a_line_that_is_damaged_or_not_the_next() {
    let session = marlin();
    session.ask(&numbered(0, "M110 N0"), "ok\n");
    session.ask(&numbered(1, "G91"), "ok\n");
    session.ask("N2 G1 X1*1\n", "Error:checksum mismatch, Last Line: 1\nResend: 2\nok\n");
    session.ask("N2 G1 X1\n", "Error:No Checksum with line number, Last Line: 1\nResend: 2\nok\n");
    let late = numbered(3, "G1 X1");
    session.ask(&late, "Error:Line Number is not Last Line Number+1, Last Line: 1\nResend: 2\nok\n");
    session.ask(&numbered(2, "G1 X1"), "ok\n");
    session.ask(&late, "ok\n");
    session.ask("M114\n", "X:2.00 Y:0.00 Z:0.00 E:0.00 Count X:40 Y:0 Z:0\nok\n");
    session.ask(&numbered(9, "M110 N100"), "ok\n");
    session.ask(&numbered(101, "G90"), "ok\n");
    session.end();
}

#[test]
fn marlin_says_that_it_is_busy_and_tells_temperatures_by_itself() {
    let session = marlin();
    let began = session.now();
    session.ask("G4 S5\n", "echo:busy: processing\necho:busy: processing\nok\n");
    let took = (session.now() - began).as_secs_f64();
    assert!((5.0..5.1).contains(&took), "{took}");
    // A movement that takes 5 s is planned at once; M400 waits for it.
    session.ask("G1 X25 F300\n", "ok\n");
    session.ask("M400\n", "echo:busy: processing\necho:busy: processing\nok\n");
    session.ask("G4 P1500\n", "ok\n");
    session.ask("M155 S2\n", "ok\n");
    assert_eq!(session.hear(seconds(5.0)), " T:20.00 /0.00 @:0\n T:20.00 /0.00 @:0\n");
    session.ask("M155 S0\n", "ok\n");
    assert_eq!(session.hear(seconds(5.0)), "");
    session.end();
}

#[test]
fn marlin_keeps_four_commands_and_127_bytes_and_loses_what_is_more() {
    let session = marlin();
    // The first is carried out for 10 s, three wait, and 127 bytes behind them: 12 whole lines and 7 bytes.
    session.say("G4 S10\nM400\nM400\nM400\n");
    let line = "G91;789012\n";
    session.say(&line.repeat(20));
    assert_eq!(session.hear(seconds(9.0)).matches("ok").count(), 0);
    session.until("ok\n");
    session.hear(seconds(1.0));
    // The rest of the thirteenth is a comment without end: the next line is its end.
    session.ask("\n", "ok\n");
    session.ask("M114\n", "X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0\nok\n");
    session.end();
}

#[test]
fn marlin_stops_at_once_and_halts_until_it_is_reset() {
    let session =
        Session::with_script(Spoken::Marlin, "20 restart\n30 press x-min\n31 release x-min\n32 reset\n");
    session.ask("", GREETING);
    session.ask("G1 X50 F600\nM400\n", "ok\n");
    session.hear(seconds(1.0));
    // A stop of the plan: the wait for it is over, the place is that of the motors, and lines go on.
    session.ask("M410\n", "ok\nok\n");
    session.say("M114\n");
    let place = session.until("ok\n");
    let x: f64 = place.split([':', ' ']).nth(1).unwrap().parse().unwrap();
    assert!((9.0..12.0).contains(&x), "{place}");
    session.ask("G1 X50 F600\nM400\n", "ok\n");
    session.hear(seconds(1.0));
    // A stop in a damaged line.
    session.ask("N7 M112*1\n", "Error:Printer halted. kill() called!\n");
    session.say("M105\nM114\n");
    assert_eq!(session.hear(seconds(4.0)), "");
    // It begins anew, where it stands.
    assert_eq!(session.until("(simulated)\n"), GREETING);
    session.ask("M114\n", "X:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0\nok\n");
    session.ask("G1 X5\nM400\n", "ok\nok\n");
    // A limit switch on its way.
    session.hear(seconds(29.0) - session.now());
    session.ask("G1 X-15 F300\nM400\n", "ok\nError:Printer halted. kill() called!\n");
    assert_eq!(session.until("(simulated)\n"), GREETING);
    session.ask("G28\n", "echo:busy: processing\nX:0.00 Y:0.00 Z:0.00 E:0.00 Count X:0 Y:0 Z:0\nok\n");
    // Homed, a target ends at the area.
    session.ask("G1 X100 Y-5 F3000\nM400\n", "ok\nok\n");
    session.ask("M114\n", "X:60.00 Y:0.00 Z:0.00 E:0.00 Count X:1200 Y:0 Z:0\nok\n");
    session.end();
}

fn hpgl() -> Session {
    Session::new(Spoken::Hpgl)
}

#[test]
fn a_7475a_answers_each_question_as_documented() {
    let session = hpgl();
    for (said, answer) in [
        ("\x1b.B", "1024\r"),
        ("\x1b.L", "1024\r"),
        ("\x1b.O", "8\r"),
        ("\x1b.E", "0\r"),
        ("OI;", "7475A\r"),
        // Just switched on, ready; told once.
        ("OS;", "24\r"),
        ("OS;", "16\r"),
        ("OF;", "40,40\r"),
        ("OH;", "0,0,2400,1600\r"),
        ("OP;", "0,0,2400,1600\r"),
        ("OE;", "0\r"),
        ("PU400,200;OA;", "400,200,0\r"),
        ("PD800,200;OA;", "800,200,1\r"),
        ("OS;", "17\r"),
        ("SC0,24,0,16;PU5,4;OC;", "5,4,0\r"),
        ("OA;", "500,400,0\r"),
        ("IP100,100,1100,1100;OS;", "18\r"),
        ("OP;", "100,100,1100,1100\r"),
        ("OS;", "16\r"),
        // No such instruction; an odd coordinate; a number that is none.
        ("QQ;OS;", "48\r"),
        ("OE;", "1\r"),
        ("PA3;OE;", "2\r"),
        ("VS1.2.3;OE;", "3\r"),
        ("OE;", "0\r"),
        ("\x1b.?\x1b.E", "11\r"),
        ("\x1b.Ix\x1b.E", "12\r"),
        ("\x1b.I2000;;17:\x1b.E", "13\r"),
        ("\x1b.N1;2;3;4;5;6;7;8;9;10;11;\x1b.E", "14\r"),
        ("\x1b.@;0:\x1b.J\x1b.E", "0\r"),
        ("\x1b.M;;;10:OI;", "7475A\n"),
        ("\x1b.M;;;13;10;62:OI;", ">7475A\r\n"),
        ("\x1b.ROI;", "7475A\r"),
        ("IN;OS;", "24\r"),
    ] {
        session.ask(said, answer);
    }
    assert_eq!(session.hear(seconds(1.0)), "");
    session.end();
}

#[test]
fn a_7475a_loses_what_its_buffer_has_no_room_for_and_says_error_16() {
    let session = hpgl();
    // A pen change takes a second, in which 1100 bytes come: at 115200 baud they need 0.1 s.
    session.say("SP1;");
    session.hear(seconds(0.05));
    session.say(&";".repeat(1000));
    session.hear(seconds(0.2));
    session.ask("\x1b.B\x1b.O", "24\r0\r");
    session.say(&";".repeat(100));
    session.hear(seconds(0.05));
    session.ask("\x1b.B\x1b.E\x1b.E", "0\r16\r0\r");
    // The size is told when it is empty, after the second is over.
    session.ask("\x1b.L", "1024\r");
    assert!(session.now() > seconds(1.0), "{:?}", session.now());
    session.end();
}

#[test]
fn a_7475a_stops_its_host_by_xoff_and_lets_it_go_on_by_xon() {
    let session = hpgl();
    session.say("\x1b.I81;;17:\x1b.N;19:SP1;");
    session.hear(seconds(0.05));
    session.say(&";".repeat(943));
    assert_eq!(session.hear(seconds(0.2)), ""); // 81 are free
    session.say(";");
    assert_eq!(session.hear(seconds(0.05)), "\x13");
    session.ask("\x1b.B", "80\r");
    assert_eq!(session.until("\x11"), "\x11");
    assert!(session.now() > seconds(1.0), "{:?}", session.now());
    session.end();
}

#[test]
fn a_7475a_drops_what_is_buffered_and_not_what_is_planned() {
    let session = hpgl();
    session.say("PU400,0;SP2;PU800,0;PU1200,0;");
    session.hear(seconds(0.3));
    session.say("\x1b.K");
    session.ask("\x1b.B", "1024\r");
    session.ask("OA;", "400,0,0\r");
    session.end();
}

#[test]
fn a_7475a_cuts_lines_and_arcs_at_its_area() {
    let session = hpgl();
    // Out at the right, back at the left: a line and its rest are drawn, what lies beyond is not.
    session.ask("PU2000,400;PD2800,400,2800,800,2000,800;PU;OA;", "2000,800,0\r");
    session.ask("PU0,800;CI200;OC;", "0,800,0\r");
    let drawn = session.end();
    // Two lines of 10 mm, and the right half of a circle of 5 mm, 15.7 mm long, of which the steps along x
    // and y are 2 · 5 and 10 mm.
    let ([down, _], at) = drawn.steps();
    assert!((795..=810).contains(&down), "{down}");
    assert_eq!(at, [0, 400]);
}

#[test]
fn a_pen_change_takes_a_second_and_the_button_stops_the_machine() {
    let session = Session::with_script(Spoken::Hpgl, "10 stop\n12 free\n13 reset\n");
    session.ask("PU400,0;OA;", "400,0,0\r");
    let began = session.now();
    session.ask("SP3;OA;", "400,0,0\r");
    let took = (session.now() - began).as_secs_f64();
    assert!((1.0..1.3).contains(&took), "{took}");
    session.hear(seconds(9.5) - session.now());
    session.say("VS1;PD2400,0;");
    session.hear(seconds(1.0));
    session.ask("\x1b.O", "24\r");
    session.say("OA;");
    assert_eq!(session.hear(seconds(1.0)), "");
    session.ask("\x1b.O", "16\r");
    session.hear(seconds(2.0));
    session.say("OA;");
    let place = session.until("\r");
    let x: i32 = place.split(',').next().unwrap().parse().unwrap();
    assert!((450..550).contains(&x), "{place}");
    session.end();
}

/// Squares and a half circle, as lines of Grbl's without the words for the pen, each with the pen.
fn drawing() -> Vec<(bool, String)> {
    let mut lines = Vec::new();
    for n in 0..4 {
        let (low, high) = (5 + n, 35 - n);
        lines.push((false, format!("X{low} Y{low}")));
        for [x, y] in [[high, low], [high, high], [low, high], [low, low]] {
            lines.push((true, format!("X{x} Y{y}")));
        }
    }
    lines.push((false, String::from("X50 Y10")));
    lines.push((true, String::from("X50 Y30 I0 J10")));
    lines.push((false, String::from("X0 Y0")));
    lines
}

/// The drawing through a machine of this language.
fn draw(spoken: Spoken) -> Drawn {
    let session = Session::new(spoken);
    let wait = |text: &str| {
        session.say(text);
        if spoken != Spoken::Hpgl {
            session.until("ok");
        }
    };
    if spoken == Spoken::Grbl {
        session.until("help]\r\n");
    }
    let mut is_down = false;
    for (down, words) in drawing() {
        let pen_changes = down != core::mem::replace(&mut is_down, down);
        let is_arc = words.contains('I');
        let code = match (down, is_arc) {
            (false, _) => "G0",
            (true, false) => "G1",
            (true, true) => "G3",
        };
        match spoken {
            Spoken::Hpgl => {
                let numbers: Vec<i32> = words.split(' ').map(|word| word[1..].parse().unwrap()).collect();
                let &[x, y, ..] = numbers.as_slice() else { unreachable!() };
                session.say(&match (down, numbers.as_slice()) {
                    (true, &[_, _, i, j]) => format!("PD;AA{},{},180;", 40 * (50 + i), 40 * (10 + j)),
                    (true, _) => format!("PD{},{};", 40 * x, 40 * y),
                    (false, _) => format!("PU{},{};", 40 * x, 40 * y),
                });
                session.hear(seconds(0.3)); // (a host that counts bytes is tested elsewhere)
            }
            Spoken::Marlin => {
                if pen_changes {
                    wait("M400\n");
                    wait(if down { "M280 P0 S90\n" } else { "M280 P0 S160\n" });
                }
                wait(&format!("{code} {words} F1500\n"));
            }
            _ => {
                if pen_changes {
                    wait(if down { "M3\n" } else { "M5\n" });
                }
                wait(&format!("{code} {words} F1500\n"));
            }
        }
    }
    match spoken {
        Spoken::Hpgl => session.ask("OA;", "0,0,0\r"),
        Spoken::Marlin => wait("M400\n"),
        _ => wait("G4 P0\n"),
    }
    session.end()
}

#[test]
fn a_drawing_is_the_same_steps_in_each_language() {
    let wanted = draw(Spoken::Grbl).steps();
    // 16 sides of squares, 2 · 560 mm in all less the ways; a half circle of 10 mm; 20 steps to the mm.
    assert_eq!(wanted.1, [0, 0]);
    assert!(wanted.0[0] > 8_000, "{wanted:?}");
    assert_eq!(draw(Spoken::Marlin).steps(), wanted);
    assert_eq!(draw(Spoken::Hpgl).steps(), wanted);
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

#[test]
fn a_log_is_read_drawn_and_run_again_by_the_program() {
    for spoken in [Spoken::Marlin, Spoken::Hpgl] {
        let drawn = draw(spoken);
        let here = drawn.directory.path();
        std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
        let log = drawn.path.to_str().unwrap();
        let (status, said) = run(&["check", log, "--machine", "machine.toml"], here);
        assert!(status == Some(0) && said.contains("equal: "), "{said}");
        let (status, said) = run(&["info", log], here);
        assert_eq!(status, Some(0), "{said}");
        assert!(said.contains("ends at (0.000, 0.000) mm") && said.contains("anomalies: 0"), "{said}");
        let (status, said) = run(&["render", log, "--svg", "drawn.svg"], here);
        assert_eq!(status, Some(0), "{said}");
        assert!(std::fs::read_to_string(here.join("drawn.svg")).unwrap().contains("<path"));
    }
}

#[test]
fn the_program_speaks_both_on_a_port() {
    for (dialect, said, answer) in [("marlin", "M105\n", "@:0\n"), ("hpgl", "OI;", "7475A\r")] {
        let directory = tempfile::tempdir().unwrap();
        let here = directory.path();
        std::fs::write(here.join("machine.toml"), MACHINE).unwrap();
        let arguments = ["machine.toml", "--tcp", "0", "--dialect", dialect, "-o", "machine.plog"];
        let simulated = Simulated::new(&arguments, here);
        let mut port = std::net::TcpStream::connect(&simulated.port).unwrap();
        port.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
        std::io::Write::write_all(&mut port, said.as_bytes()).unwrap();
        simulate::until(&mut port, answer);
        assert_eq!(simulated.end().0, Some(0));
        let (status, said) = run(&["check", "machine.plog", "--machine", "machine.toml"], here);
        assert!(status == Some(0) && said.contains("equal: "), "{dialect}: {said}");
        let header = log::open(&here.join("machine.plog")).unwrap().header().clone();
        assert_eq!(header.text("protocol"), Some(dialect));
    }
}

#[test]
fn a_laser_is_refused() {
    let machine = Machine::from_toml(&format!("{MACHINE}[laser]\nenabled = true\n")).unwrap();
    for spoken in [Spoken::Marlin, Spoken::Hpgl] {
        let error = SimulatedMachine::speaking(&machine, spoken).err().unwrap();
        assert!(error.to_string().contains("a machine with a laser"), "{error}");
    }
}
