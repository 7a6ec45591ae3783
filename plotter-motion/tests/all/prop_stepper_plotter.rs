//! Laws of the stepper plotter's controller, whatever is sent and pressed.

use crate::stepper_bench;
use crate::switches::stands_in_the_way;

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Activity, Dialect, Drivers, StepperPlotterSettings};
use plotter_motion::kinematics::Backlash;
use plotter_motion::{Axis, Direction, LimitSwitches, PathMode, SafetyGate, StepPoint, toolpath::from_mm};
use proptest::prelude::*;
use std::collections::VecDeque;
use stepper_bench::Bench;

/// Grbl's receive buffer, as its interface states it.
const RX_BYTES: usize = 128;

fn settings(dialect: Dialect) -> StepperPlotterSettings {
    StepperPlotterSettings { dialect, ..StepperPlotterSettings::default() }
}

/// A line of G-code whose answer does not depend on when it comes.
fn grbl_line() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => (0..40_u8, 0..40_u8).prop_map(|(x, y)| format!("G1 X{x} Y{y} F6000")),
        2 => (0..40_u8).prop_map(|x| format!("x{x}")),
        1 => Just("G4 P0.01".to_owned()),
        1 => Just("G4 P0".to_owned()),
        1 => Just("M2".to_owned()),
        1 => Just("G55".to_owned()),
        1 => Just("M3 S90".to_owned()),
        1 => Just("M5".to_owned()),
        1 => Just("$G".to_owned()),
        1 => Just(String::new()),
        1 => Just("(remark) ; and more".to_owned()),
        1 => Just("G1 X".to_owned()),
        1 => Just("M77".to_owned()),
        1 => Just("$nothing".to_owned()),
        1 => (60..120_usize).prop_map(|len| "G1X1".to_owned() + &"0".repeat(len - 4)),
    ]
}

fn is_answer(line: &str) -> bool {
    line == "ok" || line.starts_with("error:")
}

/// A program that streams: it sends a line when its rule lets it, in pieces, with time between them.
struct Sender {
    counts_characters: bool,
    lines: VecDeque<Vec<u8>>,
    /// Lengths of lines that were sent and not answered.
    owed: VecDeque<usize>,
    /// What has been begun to be sent.
    wire: VecDeque<u8>,
    answers: Vec<String>,
}

impl Sender {
    fn new(lines: &[String], end: &str, counts_characters: bool) -> Self {
        let lines = lines.iter().map(|line| format!("{line}{end}").into_bytes()).collect();
        Self { counts_characters, lines, owed: VecDeque::new(), wire: VecDeque::new(), answers: Vec::new() }
    }

    fn go_on(&mut self) {
        while let Some(line) = self.lines.front() {
            let may = if self.counts_characters {
                self.owed.iter().sum::<usize>() + line.len() <= RX_BYTES
            } else {
                self.owed.is_empty()
            };
            if !may {
                return;
            }
            self.owed.push_back(line.len());
            self.wire.extend(line);
            self.lines.pop_front();
        }
    }

    fn hear(&mut self, text: &str) {
        for line in text.lines().filter(|line| is_answer(line)) {
            assert!(self.owed.pop_front().is_some(), "an answer to nothing: {line}");
            self.answers.push(line.to_owned());
        }
    }
}

/// Streams all lines in pieces; gives the answers in their order.
fn stream(lines: &[String], end: &str, counts_characters: bool, pieces: &[(u8, u8, bool)]) -> Vec<String> {
    let mut bench = Bench::new(settings(Dialect::Grbl));
    let mut sender = Sender::new(lines, end, counts_characters);
    for &(bytes, ms, asks) in pieces.iter().cycle().take(200_000) {
        sender.go_on();
        if sender.owed.is_empty() {
            break;
        }
        for _ in 0..=bytes {
            if let Some(byte) = sender.wire.pop_front() {
                bench.send(std::str::from_utf8(&[byte]).unwrap_or_default());
            }
        }
        if asks {
            bench.send("?");
        }
        bench.run_for(Duration::from_millis(ms.into()));
        sender.hear(&bench.take_answers());
    }
    bench.run_out();
    assert!(sender.owed.is_empty() && sender.lines.is_empty(), "not all lines were answered");
    sender.answers
}

#[derive(Clone, Debug)]
enum Input {
    Text(String),
    Byte(u8),
    Wait(u16),
    Switch(Axis, Direction, bool),
    Button(bool),
    Reset,
    Restart,
}

fn input(dialect: Dialect) -> impl Strategy<Value = Input> {
    let axis = prop_oneof![Just(Axis::X), Just(Axis::Y)];
    let end = prop_oneof![Just(Direction::Plus), Just(Direction::Minus)];
    let text = match dialect {
        Dialect::MDraw => prop_oneof![
            4 => (0..60_u8, 0..60_u8).prop_map(|(x, y)| format!("G1 X{x} Y{y}\n")),
            1 => Just("G28\n".to_owned()),
            1 => Just("M1 90\n".to_owned()),
            1 => Just("M4 255\n".to_owned()),
        ]
        .boxed(),
        Dialect::Grbl => prop_oneof![
            4 => (0..60_u8, 0..60_u8).prop_map(|(x, y)| format!("G1 X{x} Y{y} F6000\n")),
            1 => Just("M3 S1000\n".to_owned()),
            1 => Just("$H\n".to_owned()),
            1 => Just("$X\n".to_owned()),
            1 => Just("!".to_owned()),
            1 => Just("~".to_owned()),
            1 => Just("$J=G91 X7 Y-3 F3000\n".to_owned()),
            1 => Just("$120=300\n".to_owned()),
            1 => Just("\u{18}".to_owned()),
        ]
        .boxed(),
    };
    prop_oneof![
        4 => text.prop_map(Input::Text),
        1 => (0x84..0xA0_u8).prop_map(Input::Byte),
        4 => (0..2_000_u16).prop_map(Input::Wait),
        2 => (axis, end, any::<bool>()).prop_map(|(axis, end, pressed)| Input::Switch(axis, end, pressed)),
        1 => any::<bool>().prop_map(Input::Button),
        1 => Just(Input::Reset),
        1 => Just(Input::Restart),
    ]
}

/// What the emitted steps must obey.
struct Watch {
    plotter: StepperPlotter,
    now: Duration,
    limits: LimitSwitches,
    button: bool,
    latched: bool,
    last_step: Duration,
}

impl Watch {
    /// Every step that is due.
    fn steps(&mut self) -> Result<(), TestCaseError> {
        loop {
            let (before, activity) = (self.plotter.position(), self.plotter.status(self.now).activity);
            let Some(step) = self.plotter.poll(self.now, Drivers::Ready) else { return Ok(()) };
            let (at, moves) = (step.at, [(Axis::X, step.pulse.x()), (Axis::Y, step.pulse.y())]);
            prop_assert!(moves.iter().any(|(_, sign)| *sign != 0));
            for (axis, sign) in moves.into_iter().filter(|(_, sign)| *sign != 0) {
                let direction = if sign > 0 { Direction::Plus } else { Direction::Minus };
                prop_assert!(
                    !stands_in_the_way(self.limits, axis, direction),
                    "into a switch: {moves:?} at {at:?}"
                );
            }
            // Grbl's $X ends an emergency stop, once the button has been released.
            self.latched &= self.button || self.plotter.status(self.now).emergency_stop;
            prop_assert!(!self.latched, "a step while stopped");
            prop_assert!(at <= self.now && at >= self.last_step, "{moves:?} of {at:?} at {:?}", self.now);
            self.last_step = at;
            if activity != Activity::Home {
                let [x, y] = moves.map(|(_, sign)| i32::from(sign));
                prop_assert_eq!(self.plotter.position(), StepPoint::new(before.x + x, before.y + y));
            }
        }
    }

    /// All that is to be done now: what is answered may make room for a line that is due at once.
    fn settle(&mut self) -> Result<(), TestCaseError> {
        loop {
            self.steps()?;
            while self.plotter.transmit(self.now).is_some() {}
            if self.plotter.due().is_none_or(|due| due > self.now) {
                break;
            }
        }
        self.latched &= self.button || self.plotter.status(self.now).emergency_stop;
        prop_assert_eq!(self.latched, self.plotter.status(self.now).emergency_stop);
        if self.latched {
            prop_assert_eq!(self.plotter.beam().power(), 0);
            prop_assert_eq!(self.plotter.pen_deg(), 160, "the pen is up");
            prop_assert_eq!(self.plotter.due(), None, "nothing is due");
        }
        Ok(())
    }

    fn run_to(&mut self, end: Duration) -> Result<(), TestCaseError> {
        while let Some(due) = self.plotter.due().filter(|due| *due <= end) {
            self.now = self.now.max(due);
            self.settle()?;
        }
        self.now = end;
        self.settle()
    }

    fn take(&mut self, input: &Input) -> Result<(), TestCaseError> {
        match input {
            Input::Text(text) => {
                for byte in text.bytes() {
                    self.plotter.receive(self.now, byte);
                }
            }
            Input::Byte(byte) => self.plotter.receive(self.now, *byte),
            Input::Wait(ms) => self.run_to(self.now + Duration::from_millis((*ms).into()))?,
            Input::Switch(axis, end, pressed) => {
                self.limits.set(*axis, *end, *pressed);
                self.plotter.limit_switch(self.now, *axis, *end, *pressed);
            }
            Input::Button(pressed) => {
                self.button = *pressed;
                self.latched |= pressed;
                self.plotter.emergency_stop(self.now, *pressed);
            }
            Input::Reset => {
                prop_assert_eq!(self.plotter.reset_emergency_stop(self.now), !self.button);
                self.latched = self.button;
            }
            Input::Restart => {
                self.plotter.restart(self.now);
                self.latched = self.button;
            }
        }
        self.settle()
    }
}

fn watch(dialect: Dialect, laser: bool, play: u16, inputs: &[Input]) -> Result<(), TestCaseError> {
    let backlash = Backlash { x_steps: play, y_steps: play / 2 };
    let settings = StepperPlotterSettings { laser, backlash, ..settings(dialect) };
    let mut watch = Watch {
        plotter: StepperPlotter::new(settings, SafetyGate::new(LimitSwitches::RELEASED, false))
            .map_err(|error| TestCaseError::fail(error.to_string()))?,
        now: Duration::ZERO,
        limits: LimitSwitches::default(),
        button: false,
        latched: false,
        last_step: Duration::ZERO,
    };
    for input in inputs {
        watch.take(input)?;
    }
    Ok(())
}

/// What a person does by hand, at the edge of the area too.
fn by_hand() -> impl Strategy<Value = Input> {
    let side = |most: u16| prop_oneof![Just(0), Just(most), 0..most];
    let text = prop_oneof![
        4 => (side(380), side(310), 60..9_000_u16).prop_map(|(x, y, f)| format!("G1 X{x} Y{y} F{f}\n")),
        1 => (side(380), side(310)).prop_map(|(x, y)| format!("G0 X{x} Y{y}\n")),
        1 => (0..200_u16).prop_map(|x| format!("G3 X{} Y100 I{} F6000\n", x + 100, x)),
        3 => (-200..200_i16, -200..200_i16).prop_map(|(x, y)| format!("$J=G91 X{x} Y{y} F9000\n")),
        1 => Just("!".to_owned()),
        2 => Just("~".to_owned()),
        1 => Just("\u{18}$X\n".to_owned()),
        1 => Just("$X\n".to_owned()),
    ];
    prop_oneof![
        5 => text.prop_map(Input::Text),
        3 => prop_oneof![Just(0x85), 0x90..0x98_u8].prop_map(Input::Byte),
        5 => (0..1_500_u16).prop_map(Input::Wait),
    ]
}

/// Steps of the carriage outside of the area, at most.
fn outside(at: StepPoint) -> i32 {
    let most = StepPoint::new(from_mm(380.0, 87.58), from_mm(310.0, 87.58));
    [-at.x, -at.y, at.x - most.x, at.y - most.y].into_iter().max().unwrap_or(0)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn each_line_of_a_stream_has_one_answer_in_its_order(
        lines in prop::collection::vec(grbl_line(), 1..40),
        end in prop_oneof![Just("\n"), Just("\r"), Just("\r\n")],
        pieces in prop::collection::vec((0..60_u8, 1..40_u8, any::<bool>()), 1..20),
    ) {
        // One line at a time, each carried out before the next.
        let mut bench = Bench::new(settings(Dialect::Grbl));
        bench.ask("");
        let mut expected = Vec::new();
        for line in &lines {
            let text = bench.ask(&format!("{line}\n"));
            let answers: Vec<_> = text.lines().filter(|line| is_answer(line)).collect();
            prop_assert_eq!(answers.len(), 1, "{}: {:?}", line, text);
            expected.push(answers[0].to_owned());
        }
        for counts_characters in [true, false] {
            prop_assert_eq!(&stream(&lines, end, counts_characters, &pieces), &expected);
        }
    }

    #[test]
    fn each_line_has_one_answer_however_many_are_sent_ahead(
        bursts in prop::collection::vec((prop::collection::vec(grbl_line(), 1..40), 0..400_u16), 1..4),
    ) {
        let mut bench = Bench::new(settings(Dialect::Grbl));
        bench.ask("");
        let (mut sent, mut answers) = (0, String::new());
        for (lines, wait_ms) in &bursts {
            for line in lines {
                bench.send(&format!("{line}\n"));
                sent += 1;
            }
            bench.run_for(Duration::from_millis((*wait_ms).into()));
            answers += &bench.take_answers();
        }
        bench.run_out();
        answers += &bench.take_answers();
        prop_assert_eq!(answers.lines().filter(|line| is_answer(line)).count(), sent);
        prop_assert_eq!(bench.ask("G1 X1 F6000\n"), "ok\r\n");
    }

    #[test]
    fn each_line_of_mdraw_has_one_ok(
        bytes in prop::collection::vec(
            prop_oneof![
                1 => any::<u8>(),
                3 => prop::sample::select(b"GMPXYAUDHWSB 0123456789.-\n".to_vec()),
                1 => Just(b'\n'),
            ],
            0..400,
        ),
        waits in prop::collection::vec(0..3_000_u64, 1..20),
    ) {
        let mut bench = Bench::new(settings(Dialect::MDraw));
        bench.switches = false;
        let mut waits = waits.iter().cycle();
        for byte in &bytes {
            bench.plotter.receive(bench.now, *byte);
            if byte % 7 == 0 {
                bench.run_for(Duration::from_millis(*waits.next().unwrap_or(&0)));
            }
        }
        bench.run_out();
        let answers = bench.take_answers();
        let lines = bytes.iter().filter(|byte| **byte == b'\n').count();
        prop_assert_eq!(answers.matches("OK").count(), lines, "{}", answers);
        prop_assert_eq!(answers.lines().filter(|line| *line == "OK").count(), lines);
    }

    #[test]
    fn no_step_leads_into_a_switch_or_comes_while_stopped_with_mdraw(
        inputs in prop::collection::vec(input(Dialect::MDraw), 1..60), laser in any::<bool>(), play in 0..9_u16,
    ) {
        watch(Dialect::MDraw, laser, play, &inputs)?;
    }

    #[test]
    fn no_step_leads_into_a_switch_or_comes_while_stopped_with_grbl(
        inputs in prop::collection::vec(input(Dialect::Grbl), 1..60), laser in any::<bool>(), play in 0..9_u16,
    ) {
        watch(Dialect::Grbl, laser, play, &inputs)?;
    }

    #[test]
    fn no_bytes_do_harm_to_grbl(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
        let mut bench = Bench::new(settings(Dialect::Grbl));
        for byte in &bytes {
            bench.plotter.receive(bench.now, *byte);
        }
        bench.run_for(Duration::from_secs(60));
        // Held or in an alarm: it can be woken.
        bench.send("~\u{18}");
        bench.run_for(Duration::from_secs(60));
        bench.take_answers();
        let answers = bench.ask("\n$X\n");
        prop_assert!(answers.ends_with("ok\r\n"), "{}", answers);
    }
}

proptest! {
    // Each case is minutes of the machine's time.
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(64) })]

    #[test]
    fn nothing_done_by_hand_leads_out_of_the_area_or_loses_the_place(
        inputs in prop::collection::vec(by_hand(), 1..60),
        jerk_mm_s3 in prop_oneof![Just(None), Just(Some(20_000.0))],
        averages in prop::bool::ANY,
        play in 0..9_u16,
    ) {
        let mut machine = settings(Dialect::Grbl);
        machine.planner.jerk_mm_s3 = jerk_mm_s3;
        if averages {
            machine.planner.path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
            #[cfg(feature = "averaged-steps")]
            (machine.planner.jerk_limit = plotter_motion::planner::JerkLimit::Vector);
        }
        machine.backlash = Backlash { x_steps: play, y_steps: play / 2 };
        let mut bench = Bench::new(machine);
        bench.switches = false;
        for input in &inputs {
            match input {
                Input::Text(text) => bench.send(text),
                Input::Byte(byte) => bench.send_bytes(&[*byte]),
                Input::Wait(ms) => bench.run_for(Duration::from_millis((*ms).into())),
                _ => {}
            }
        }
        // A hold or a cancelled jog ends at rest, and whatever was asked for, a line goes where it says.
        bench.send("!");
        bench.send_bytes(&[0x85]);
        bench.run_for(Duration::from_secs(20));
        let stands = bench.plotter.position();
        bench.run_for(Duration::from_secs(20));
        prop_assert_eq!(bench.plotter.position(), stands);
        bench.send("\u{18}");
        bench.run_out();
        bench.take_answers();
        let answers = bench.ask("$X\nG90\nG1 X12 Y34 F3000\n");
        prop_assert!(answers.ends_with("ok\r\nok\r\nok\r\n"), "{}", answers);
        // The carriages, from the motors' steps alone.
        let mut gap = [0_i32; 2];
        let most = [i32::from(play), i32::from(play / 2)];
        let (mut motors, mut carriage) = (StepPoint::default(), StepPoint::default());
        for made in &bench.made {
            let ways = [made.position.x - motors.x, made.position.y - motors.y];
            for ((gap, way), most) in gap.iter_mut().zip(ways).zip(most) {
                *gap = (*gap + way).clamp(0, most);
            }
            motors = made.position;
            carriage = StepPoint::new(motors.x - gap[0], motors.y - gap[1]);
            // Within the tolerance the path itself may lie outside.
            let most = if averages { from_mm(0.05, 87.58) + 1 } else { 0 };
            prop_assert!(outside(carriage) <= most, "{:?}", carriage);
        }
        prop_assert_eq!(carriage, StepPoint::new(from_mm(12.0, 87.58), from_mm(34.0, 87.58)));
    }
}
