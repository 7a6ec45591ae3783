//! Sessions of text, of Grbl, mDraw, Marlin, HPGL and EBB, as the virtual plotter draws them: what was sent, as
//! far as the machine has taken it and says to be.

use plotter_motion::{Axis, Direction, Pen, Point};
use plotter_replay::log::{Event, Header, Record};
use plotter_replay::virtual_plotter::{AnomalyKind, Leg};
use plotter_replay::{PlotterSettings, VirtualPlotter};

/// A recording in the making.
struct Talk {
    plotter: VirtualPlotter,
    time_us: u64,
}

impl Talk {
    fn of(protocol: &str) -> Self {
        let header = Header::new().with_text("protocol", protocol).with_decimal("x_mm_per_pulse", 0.01);
        let header = header.with_decimal("y_mm_per_pulse", 0.01);
        let settings = PlotterSettings::from_header(&header).unwrap();
        Self { plotter: VirtualPlotter::new(settings), time_us: 0 }
    }
    fn at_ms(mut self, ms: u64) -> Self {
        self.time_us = ms * 1_000;
        self
    }
    fn push(mut self, event: Event) -> Self {
        self.plotter.push(&Record::at_us(self.time_us, event));
        self
    }
    fn host(self, text: &str) -> Self {
        self.push(Event::Host(text.as_bytes().to_vec()))
    }
    fn says(self, text: &str) -> Self {
        self.push(Event::Controller(text.as_bytes().to_vec()))
    }
    /// A line that is taken at once.
    fn line(self, text: &str) -> Self {
        self.host(&format!("{text}\n")).says("ok\r\n")
    }
    fn end(mut self) -> VirtualPlotter {
        self.plotter.finish();
        self.plotter
    }
}

/// What was drawn: from, to, mm.
fn drawn(plotter: &VirtualPlotter) -> Vec<(Point, Point)> {
    let settings = *plotter.settings();
    let ends = |leg: &Leg| {
        let (from, to) = (leg.points.first().unwrap().at, leg.points.last().unwrap().at);
        (settings.to_sheet(from), settings.to_sheet(to))
    };
    let legs = plotter.legs().iter();
    legs.filter(|leg| leg.pen == Pen::Down && leg.points.len() > 1).map(ends).collect()
}

fn kinds(plotter: &VirtualPlotter) -> Vec<AnomalyKind> {
    plotter.anomalies().iter().map(|anomaly| anomaly.kind.clone()).collect()
}

const IDLE_AT_10_5: &str = "<Idle|MPos:10.000,5.000,0.000|Bf:15,128|FS:0,0>\r\n";

#[test]
fn lines_are_drawn_once_they_are_taken_and_the_machine_says_to_be_there() {
    let talk = Talk::of("grbl").line("G21").line("G0 X10").line("M3 S90").line("G1 Y5 F600");
    // Nothing says yet that any of it was drawn.
    assert!(talk.plotter.legs().is_empty());
    let plotter = talk.at_ms(2_000).host("?").says(IDLE_AT_10_5).end();
    assert_eq!(drawn(&plotter), [(Point::new(10.0, 0.0), Point::new(10.0, 5.0))]);
    assert_eq!((kinds(&plotter), plotter.reached_count()), (vec![], 2));
    let counts = plotter.line_counts().unwrap();
    assert_eq!((counts.sent, counts.accepted, counts.refused, counts.assumed), (4, 4, 0, 0));
    // 10 mm and 5 mm within the two seconds, evenly.
    let times: Vec<u64> = plotter.legs().iter().map(|leg| leg.points.last().unwrap().time_us).collect();
    assert_eq!(times, [1_333_333, 2_000_000]);
}

#[test]
fn a_machine_that_was_heard_last_on_its_way_has_not_drawn_the_rest() {
    let run = "<Run|MPos:6.000,0.000,0.000|Bf:10,90|FS:600,0>\r\n";
    let talk = Talk::of("grbl").line("M3").line("G1 X10 F600").line("G1 Y10").line("G1 X0");
    let plotter = talk.at_ms(600).host("?").says(run).at_ms(700).end();
    assert_eq!(drawn(&plotter), [(Point::ORIGIN, Point::new(6.0, 0.0))]);
    assert_eq!(kinds(&plotter), [AnomalyKind::NotKnownDrawn { moves: 3 }]);
    // With a line that is taken after it, the rest is taken for drawn, and said to be.
    let talk = Talk::of("grbl").line("M3").line("G1 X10 F600").line("G1 Y10");
    let plotter = talk.at_ms(600).host("?").says(run).at_ms(2_000).line("G1 X0").end();
    assert_eq!(plotter.position(), Point::new(0.0, 10.0));
    assert_eq!((kinds(&plotter), plotter.line_counts().unwrap().assumed), (vec![], 3));
}

#[test]
fn what_is_refused_reset_or_never_answered_is_not_drawn() {
    let talk = Talk::of("grbl").line("M3").line("G1 X5 F600");
    let plotter = talk.host("G1 X900\n").says("error:33\r\n").line("G4 P0").host("G1 X7\n").end();
    assert_eq!(drawn(&plotter), [(Point::ORIGIN, Point::new(5.0, 0.0))]);
    assert_eq!(
        kinds(&plotter),
        [AnomalyKind::LineRefused { line: "G1 X900".into(), code: 33 }, AnomalyKind::Unanswered { lines: 1 }]
    );
    let talk = Talk::of("grbl").line("M3").line("G1 X5 F600").push(Event::Host(vec![0x18]));
    let idle = "<Alarm|MPos:2.000,0.000,0.000|Bf:15,128|FS:0,0>\r\n";
    let plotter = talk.says("ALARM:3\r\n\r\nGrbl 1.1h ['$' for help]\r\n").host("?").says(idle).end();
    assert_eq!(drawn(&plotter), []);
    assert_eq!(plotter.position(), Point::new(2.0, 0.0));
}

#[test]
fn a_log_that_begins_elsewhere_begins_where_the_machine_first_says_to_be() {
    let talk = Talk::of("grbl").host("?").says("<Idle|MPos:40.000,30.000,0.000|Bf:15,128|FS:0,0>\r\n");
    let plotter = talk.line("M3").line("G1 Y35 F600").line("G4 P0").end();
    assert_eq!(drawn(&plotter), [(Point::new(40.0, 30.0), Point::new(40.0, 35.0))]);
    assert_eq!(kinds(&plotter), []);
    // Later it may only be where its lines lead.
    let talk = Talk::of("grbl").line("G0 X10").line("G4 P0").at_ms(900).host("?");
    let plotter = talk.says("<Idle|MPos:12.000,0.000,0.000|Bf:15,128|FS:0,0>\r\n").end();
    assert!(matches!(kinds(&plotter)[..], [AnomalyKind::ReportedElsewhere { off }] if off.x == 200));
    assert_eq!(plotter.position(), Point::new(12.0, 0.0));
}

#[test]
fn a_jog_moves_without_drawing_and_leaves_the_modes_as_they_were() {
    let talk = Talk::of("grbl").line("G91").line("$J=G90 G21 X10 Y5 F1000").line("M3").line("G1 X1 F600");
    let plotter = talk.line("G4 P0").end();
    assert_eq!(drawn(&plotter), [(Point::new(10.0, 5.0), Point::new(11.0, 5.0))]);
}

#[test]
fn mdraw_answers_when_it_has_moved() {
    let talk = Talk::of("mdraw").host("M1 90\n").says("OK\r\n").host("G1 X3 Y4\n").at_ms(500);
    let talk = talk.says("distance=5.00\r\nOK\r\n").host("G1 X900 Y4\n");
    let plotter = talk.says("error: (900.00, 4.00) mm lies outside\r\nOK\r\n").host("P\n");
    let plotter = plotter.says("POS X3.00 Y4.00\r\nOK\r\n").end();
    assert_eq!(drawn(&plotter), [(Point::ORIGIN, Point::new(3.0, 4.0))]);
    assert_eq!(kinds(&plotter), [AnomalyKind::LineRefused { line: "G1 X900 Y4".into(), code: 0 }]);
}

#[test]
fn where_the_log_has_the_steps_they_are_the_way() {
    let mut talk = Talk::of("grbl").line("M3").line("G1 X0.05 F600").push(Event::Pen(Pen::Down));
    for n in 1..=5 {
        let edge = |axis, sign| Event::Edge { axis, sign };
        talk = talk.at_ms(100 * n).push(edge(Axis::X, Direction::Plus));
        if n == 2 {
            talk = talk.push(edge(Axis::Y, Direction::Plus));
        }
        if n == 4 {
            talk = talk.push(edge(Axis::Y, Direction::Minus));
        }
    }
    let plotter = talk.end();
    let way: Vec<_> = plotter.legs()[0].points.iter().map(|point| (point.at.x, point.at.y)).collect();
    assert_eq!(way, [(0, 0), (1, 0), (2, 0), (2, 1), (3, 1), (4, 1), (4, 0), (5, 0)]);
    assert_eq!(plotter.reached_count(), 1);
}

/// Lines with numbers, of which the machine asks for one again; what it does not know is said.
#[test]
fn marlin_is_drawn_from_its_lines() {
    let talk = Talk::of("marlin").says("start\n").line("N0 M110 N0*125").line("N1 G28*18").line("N2 M3*87");
    let talk = talk.host("N3 G1 X10 F6O0*1\nN4 G1 Y5*96\n");
    let talk = talk.says("Error:checksum mismatch, Last Line: 2\nResend: 3\nok\n");
    let talk = talk.line("N3 G1 X10 F600*2").line("N4 G1 Y5*96").host("N5 M801*1\n");
    let talk = talk.says("echo:Unknown command: \"M801\"\nok\n").says("echo:busy: processing\n");
    let talk = talk.at_ms(2_000).line("N6 M400*1").host("M114\n");
    let plotter = talk.says("X:10.00 Y:5.00 Z:0.00 E:0.00 Count X:800 Y:400 Z:0\nok\n").end();
    let (origin, corner) = (Point::ORIGIN, Point::new(10.0, 0.0));
    assert_eq!(drawn(&plotter), [(origin, corner), (corner, Point::new(10.0, 5.0))]);
    let line = String::from("M801");
    assert_eq!(kinds(&plotter), [AnomalyKind::LineRefused { line, code: 0 }]);
    let counts = plotter.line_counts().unwrap();
    assert_eq!((counts.refused, counts.assumed), (1, 0));
    // It is led home behind what it draws, and tells where it is.
    let talk = Talk::of("marlin").line("M3").line("G1 X5").line("G28 X").host("M114\n");
    let plotter = talk.says("X:1.00 Y:0.00 Z:0.00 E:0.00 Count X:80 Y:0 Z:0\nok\n").end();
    assert_eq!(drawn(&plotter), [(origin, Point::new(5.0, 0.0))]);
    assert!(matches!(kinds(&plotter)[..], [AnomalyKind::ReportedElsewhere { .. }]));
}

#[test]
fn hpgl_is_drawn_from_its_commands() {
    let talk = Talk::of("hpgl").host("IN;SP2;PU400,0;PD800,0,800,400;PU;\u{1b}.B").says("1024\r");
    let plotter = talk.host("XX;PA0,0;OA;").says("0,0,0\r").end();
    let corner = Point::new(20.0, 0.0);
    assert_eq!(drawn(&plotter), [(Point::new(10.0, 0.0), corner), (corner, Point::new(20.0, 10.0))]);
    assert_eq!(kinds(&plotter), [AnomalyKind::LineNotUnderstood { line: String::from("XX") }]);
    // Nothing tells that they are drawn: three ways, and the one back.
    assert_eq!(plotter.line_counts().unwrap().assumed, 4);
}

/// The recording of a line alone shows what the steps of the machine show.
#[test]
fn a_recorded_line_leads_where_the_steps_of_its_machine_go() {
    // The board of the EBB loses steps while its button is pressed: its steps tell where it ends.
    let ends = [("marlin", Some(Point::new(4.0, 1.0))), ("hpgl", Some(Point::new(4.0, 2.0))), ("ebb", None)];
    for (name, end) in ends {
        let path = format!("{}/tests/golden/simulated.{name}.plog", env!("CARGO_MANIFEST_DIR"));
        let ends = |with_steps: bool| {
            let reader = plotter_replay::log::open(std::path::Path::new(&path)).unwrap();
            let mut plotter = VirtualPlotter::new(PlotterSettings::from_header(reader.header()).unwrap());
            for record in reader.map(Result::unwrap) {
                if with_steps || !matches!(record.event, Event::Edge { .. } | Event::Pen(_)) {
                    plotter.push(&record);
                }
            }
            plotter.finish();
            drawn(&plotter)
        };
        let lines = ends(false);
        let ends_there = |line: &(Point, Point)| end.is_none_or(|end| line.1.distance(end) < 1e-9);
        assert!(lines.last().is_some_and(ends_there), "{name}: {lines:?}");
        let near = |a: Point, b: Point| a.distance(b) < 0.051; // a step
        let steps = ends(true);
        let same = lines.iter().zip(&steps).all(|(a, b)| near(a.0, b.0) && near(a.1, b.1));
        assert!(steps.len() == lines.len() && same, "{name}: {lines:?}, {steps:?}");
    }
}

/// Of a machine of which nothing is said it is an AxiDraw: an inch is 2032 steps of both motors.
#[test]
fn an_axidraw_draws_an_inch() {
    let settings = PlotterSettings::from_header(&Header::new().with_text("protocol", "ebb")).unwrap();
    let talk = Talk { plotter: VirtualPlotter::new(settings), time_us: 0 };
    let talk = talk.host("EM,1,1\rSP,0,100\r").says("OK\r\nOK\r\n").at_ms(500);
    let plotter = talk.host("XM,1000,2032,0\rSP,1,100\r").says("OK\r\nOK\r\n").end();
    let at = plotter.position();
    assert!(at.distance(Point::new(25.4, 0.0)) < 1e-9, "{at:?}");
    assert_eq!(drawn(&plotter), [(Point::ORIGIN, at)]);
}

#[test]
fn an_unknown_protocol_is_none_of_these() {
    let error = PlotterSettings::from_header(&Header::new().with_text("protocol", "klipper")).unwrap_err();
    assert_eq!(error.key, "protocol");
}

/// Whatever bytes come, in whatever order: nothing panics, and memory has a bound.
#[test]
fn any_bytes_are_taken() {
    let mut random = plotter_motion::SplitMix64::new(43);
    for protocol in ["grbl", "mdraw", "marlin", "hpgl", "ebb"] {
        let mut talk = Talk::of(protocol);
        for n in 0..20_000 {
            let words = [
                "G1 X",
                "Y-",
                "9",
                "\n",
                "ok\r\n",
                "?",
                "<Run|MPos:",
                "1,2",
                ">",
                "$J=",
                "G2 I1",
                "M3",
                "OK",
                "\r",
                "N7 ",
                "*9",
                "Resend: 7\n",
                "G28",
                "start\n",
                "PD",
                "1,2;",
                "XM,10,2,-3\r",
                "SP,0\r",
            ];
            let bytes = match random.below(4) {
                0 => vec![u8::try_from(random.below(256)).unwrap()],
                _ => words[random.below(words.len())].as_bytes().to_vec(),
            };
            let event = if random.below(2) == 0 { Event::Host(bytes) } else { Event::Controller(bytes) };
            talk = talk.at_ms(n).push(event);
        }
        talk.end();
    }
}
