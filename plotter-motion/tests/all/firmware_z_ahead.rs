//! Three motors in two halves: a third axis, and a second motor of an axis, planned in the main loop and
//! stepped in an interrupt. Beside it the same controller in one piece.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Activity, Dialect, Drivers, Planning, Receive, SecondMotor, StepperPlotterSettings, Stepping, StepsAhead,
    Underruns, ZAxis, ZHoming, ZPen,
};
use plotter_motion::planner::{PathMode, ThreeAxes};
use plotter_motion::safety::{EndSwitches, Pulse};
use plotter_motion::{Axis, Direction, LimitSwitches, PlannerSettings, SafetyGate};
use proptest::prelude::*;
use std::collections::VecDeque;

/// A step of x, y, z and the second motor of y, and when it was made, us.
type Made = (u64, [i8; 4]);

fn step(pulse: Pulse<'_>) -> [i8; 4] {
    [pulse.x(), pulse.y(), pulse.z(), pulse.second(Axis::Y)]
}

/// How often the main loop comes, us.
const LOOP_US: u64 = 500;
/// Where the upper switches of x, y and z are, and that of the second motor of y, steps.
const ENDS: [i32; 4] = [34_000, 28_000, 12_400, 28_000];

/// Both halves, four motors that lose no step, and their switches.
struct Halves {
    planning: Planning<'static, Receive, ThreeAxes>,
    stepping: Stepping<'static>,
    now_us: u64,
    is_there: fn(u64) -> bool,
    /// Whether the interrupt looks at the switches, and not the main loop.
    looks: bool,
    at: [i32; 4],
    made: Vec<Made>,
    answers: String,
}

impl Halves {
    fn new(settings: StepperPlotterSettings, is_there: fn(u64) -> bool) -> Self {
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let memory = Box::leak(Box::new(StepsAhead::<4096>::new()));
        let plotter = StepperPlotter::with_modes(settings, gate).unwrap();
        let (planning, stepping) = plotter.split(memory).unwrap();
        let mut halves = Self {
            planning,
            stepping,
            now_us: 0,
            is_there,
            looks: false,
            at: [500, 500, 0, 500],
            made: vec![],
            answers: String::new(),
        };
        halves.run_to(LOOP_US);
        halves.answers.clear();
        halves
    }

    fn now(&self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    fn switch(&mut self) {
        let [x, y, z, second] = [0, 1, 2, 3]
            .map(|motor| EndSwitches { lower: self.at[motor] <= 0, upper: self.at[motor] >= ENDS[motor] });
        // A z that has no lower switch.
        let z = EndSwitches { lower: false, ..z };
        let now = self.now();
        for (axis, ends) in [(Axis::X, x), (Axis::Y, y)] {
            for (end, pressed) in [(Direction::Minus, ends.lower), (Direction::Plus, ends.upper)] {
                if self.looks {
                    self.stepping.limit_switch(axis, end, pressed);
                } else {
                    self.planning.limit_switch(now, axis, end, pressed);
                }
            }
        }
        if self.looks {
            self.stepping.z_switches(z);
            self.stepping.second_switches(second);
        } else {
            self.planning.z_switches(now, z);
            self.planning.second_switches(now, second);
        }
    }

    fn interrupt(&mut self) {
        let now_us = u32::try_from(self.now_us).unwrap();
        while let Some(pulse) = self.stepping.tick(now_us, Drivers::Ready) {
            let step = step(pulse);
            self.made.push((self.now_us, step));
            for (at, step) in self.at.iter_mut().zip(step) {
                *at += i32::from(step);
            }
            if self.looks {
                self.switch();
            }
        }
    }

    fn turn(&mut self) {
        let now = self.now();
        self.switch();
        loop {
            let more = self.planning.plan(now);
            self.interrupt();
            while let Some(byte) = self.planning.transmit(now) {
                self.answers.push(char::from(byte));
            }
            if !more {
                break;
            }
        }
    }

    fn run_to(&mut self, end_us: u64) {
        while self.now_us < end_us {
            let next_turn = (self.now_us / LOOP_US + 1) * LOOP_US;
            let due = self.stepping.due().map_or(next_turn, u64::from).max(self.now_us);
            self.now_us = due.min(next_turn).min(end_us);
            self.interrupt();
            if self.now_us == next_turn && (self.is_there)(self.now_us) {
                self.turn();
            }
        }
    }

    fn send(&mut self, text: &str) {
        for byte in text.bytes() {
            self.planning.receive(self.now(), byte);
        }
    }

    /// Sends lines as a program that counts characters, and waits until the machine stands; gives what was
    /// answered.
    fn ask(&mut self, text: &str) -> String {
        let mut lines = text.split_inclusive('\n').peekable();
        let (mut owed, mut all) = (VecDeque::new(), String::new());
        let end_us = self.now_us + 600_000_000;
        // It stands for good when it has done so for a while: lines wait for more of them.
        let mut stood = 0;
        loop {
            while let Some(line) = lines.next_if(|line| owed.iter().sum::<usize>() + line.len() <= 127) {
                owed.push_back(line.len());
                self.send(line);
            }
            self.run_to((self.now_us / LOOP_US + 1) * LOOP_US);
            let taken = core::mem::take(&mut self.answers);
            for answer in taken.lines().filter(|answer| *answer == "ok" || answer.starts_with("error")) {
                assert!(owed.pop_front().is_some(), "{answer}");
            }
            all += &taken;
            let activity = self.planning.status(self.now()).activity;
            let stands = matches!(activity, Activity::Idle | Activity::Stopped);
            stood = if lines.peek().is_none() && owed.is_empty() && stands { stood + 1 } else { 0 };
            if stood > 200 {
                return all;
            }
            assert!(self.now_us < end_us, "it does not end: {activity:?}, {owed:?}, {all}");
        }
    }

    /// Where z stands by what is told, and by its motor.
    fn heights(&mut self) -> (f64, i32) {
        let now = self.now();
        (self.planning.z_mm(now).unwrap(), self.at[2])
    }
}

/// The same text by a controller in one piece whose loop is always there.
fn in_one(settings: StepperPlotterSettings, text: &str) -> Vec<Made> {
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut plotter = StepperPlotter::<Receive, ThreeAxes>::with_modes(settings, gate).unwrap();
    let mut lines = text.split_inclusive('\n').peekable();
    let (mut owed, mut made, mut now) = (VecDeque::new(), Vec::new(), Duration::from_micros(LOOP_US));
    while plotter.transmit(now).is_some() {}
    loop {
        while let Some(line) = lines.next_if(|line| owed.iter().sum::<usize>() + line.len() <= 127) {
            owed.push_back(line.len());
            for byte in line.bytes() {
                plotter.receive(now, byte);
            }
        }
        while let Some(step_made) = plotter.poll(now, Drivers::Ready) {
            made.push((u64::try_from(step_made.at.as_micros()).unwrap(), step(step_made.pulse)));
        }
        let mut answers = String::new();
        while let Some(byte) = plotter.transmit(now) {
            answers.push(char::from(byte));
        }
        let oks = answers.matches("ok").count();
        owed.drain(..oks);
        if oks == 0 {
            match plotter.due() {
                Some(due) => now = now.max(due),
                None => return made,
            }
        }
    }
}

fn settings(planner: PlannerSettings, z: ZAxis) -> StepperPlotterSettings {
    StepperPlotterSettings {
        dialect: Dialect::Grbl,
        planner,
        z: Some(z),
        ..StepperPlotterSettings::default()
    }
}

/// A tool on a spindle.
const TOOL: ZAxis = ZAxis {
    steps_per_mm: 400.0,
    speed_mm_s: 10.0,
    accel_mm_s2: 100.0,
    travel_mm: 30.0,
    pen: None,
    home: None,
};

fn away_20(now_us: u64) -> bool {
    now_us % 100_000 < 80_000
}

/// Each step of one that plans ahead is at the tick of the other's, but for when it begins after a
/// standstill.
fn assert_same(settings: StepperPlotterSettings, text: &str) {
    let alone = in_one(settings, text);
    let mut halves = Halves::new(settings, away_20);
    let answers = halves.ask(text);
    let good = |answer: &str| answer == "ok" || answer == "[MSG:Pgm End]" || answer.is_empty();
    assert!(answers.lines().all(good), "{answers}");
    assert_eq!(halves.planning.lateness().steps(), 0);
    assert_eq!(halves.planning.underruns(), Underruns::default());
    assert_eq!(halves.made.len(), alone.len());
    let (mut shift, mut last_us) = (None, 0);
    for (number, (ahead, alone)) in halves.made.iter().zip(&alone).enumerate() {
        assert_eq!(ahead.1, alone.1, "step {number}");
        let here = ahead.0.cast_signed() - alone.0.cast_signed();
        if shift != Some(here) {
            assert!(number == 0 || alone.0 - last_us > 20_000, "step {number}: {here} {shift:?}");
            shift = Some(here);
        }
        last_us = alone.0;
    }
    // What is told is what the motor has made.
    let (told_mm, z) = halves.heights();
    let most = halves.made.iter().filter(|(_, step)| step[2] != 0).count();
    assert!(most > 100 && (told_mm * TOOL.steps_per_mm - f64::from(z)).abs() < 1e-6, "{most} {told_mm} {z}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_step_of_a_tool_that_rises_is_at_its_tick() {
    let wave: String = (0..120)
        .map(|n| {
            let x = 40.0 + 0.5 * f64::from(n);
            format!("G1 X{x:.3} Y{:.3} Z{:.3} F3000\n", 0.5 * x, 3.0 + 2.0 * (0.3 * x).sin())
        })
        .collect();
    let text = format!(
        "G0 Z5\nG0 X40 Y20\nG1 Z3 F300\n{wave}G2 X119.5 Y49.75 I10 J0 Z1 F2000\nG0 Z10\nG0 X10 Y10 Z2\nG4 P0.05\nG0 Z4\nM2\n"
    );
    for path in [PathMode::Exact, PathMode::Tolerance { path_tolerance_mm: 0.1 }] {
        for jerk_mm_s3 in [None, Some(50_000.0)] {
            let planner =
                PlannerSettings { accel_mm_s2: 2000.0, path, jerk_mm_s3, ..PlannerSettings::default() };
            assert_same(settings(planner, TOOL), &text);
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_step_of_a_pen_that_z_lifts_is_at_its_tick() {
    let pen = Some(ZPen { up_mm: 4.0, down_mm: 1.0 });
    let strokes: String =
        (0..12).map(|n| format!("G0 X{} Y{}\nM3\nG1 X{} F4000\nM5\n", 10 + n, 5 * n, 60 + n)).collect();
    assert_same(settings(PlannerSettings::default(), ZAxis { pen, ..TOOL }), &strokes);
}

/// Greatest acceleration of z in 40 ms, mm/s².
fn felt_by_z(made: &[Made]) -> f64 {
    const WINDOW: usize = 40;
    let steps: Vec<_> = made.iter().filter(|(_, step)| step[2] != 0).collect();
    let mut hardest = 0.0_f64;
    for three in steps.windows(2 * WINDOW + 1) {
        let way: i32 = three[1..].iter().map(|(_, step)| i32::from(step[2])).sum();
        let [first, middle, last] = [0, WINDOW, 2 * WINDOW].map(|at| three[at].0 as f64 * 1e-6);
        if way.unsigned_abs() as usize == 2 * WINDOW {
            let speed = |from: f64, to: f64| WINDOW as f64 / TOOL.steps_per_mm / (to - from);
            let change = speed(middle, last) - speed(first, middle);
            hardest = hardest.max(change.abs() / (0.5 * (last - first)));
        }
    }
    hardest
}

/// Away for two seconds in every 2.2.
fn away_2_000(now_us: u64) -> bool {
    now_us % 2_200_000 < 200_000
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_tool_that_runs_out_of_steps_is_braked_within_its_limits() {
    let text = "G0 Z20\nG0 X60 Y30 Z2\nG1 X10 Y60 Z22 F3000\nG0 Z1\n";
    for jerk_mm_s3 in [None, Some(50_000.0)] {
        let settings = settings(PlannerSettings { jerk_mm_s3, ..PlannerSettings::default() }, TOOL);
        let alone = in_one(settings, text);
        // Four thousand words of 16 bits are a second of this tool, and the loop is away for longer now and
        // then.
        let mut halves = Halves::new(settings, away_2_000);
        halves.ask(text);
        let Underruns { slowed_steps, stops } = halves.planning.underruns();
        assert!(stops >= 3 && slowed_steps > 500, "{stops} {slowed_steps}");
        let ways = |made: &[Made]| made.iter().map(|made| made.1).collect::<Vec<_>>();
        assert!(ways(&halves.made) == ways(&alone));
        let (before, now) = (felt_by_z(&alone), felt_by_z(&halves.made));
        println!("z, {jerk_mm_s3:?}: {before:.1} mm/s² as planned, {now:.1} with {stops} stops");
        assert!(before <= 105.0 && now <= 105.0, "{before} {now}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_tool_is_homed_and_its_place_is_told_from_there() {
    for looks in [false, true] {
        let z = ZAxis { home: Some(ZHoming::default()), ..TOOL };
        let settings = StepperPlotterSettings { homing: true, ..settings(PlannerSettings::default(), z) };
        let mut halves = Halves::new(settings, |_| true);
        halves.looks = looks;
        halves.at = [500, 700, 3_000, 700];
        assert_eq!(halves.ask("$H\n"), "ok\r\n");
        assert_eq!(halves.at[..3], [88, 88, 12_000]);
        let (told_mm, _) = halves.heights();
        assert!((told_mm - 30.0).abs() < 1e-9, "{told_mm}");
        assert_eq!(halves.planning.z_off_steps(), Some(3_000));
        assert_eq!(halves.ask("G0 X5 Z10\n"), "ok\r\n");
        assert_eq!(halves.at[..3], [88 + 438, 88, 4_000]);
        // Steps that are lost are found by the next.
        halves.at[2] -= 37;
        assert_eq!(halves.ask("$H\n"), "ok\r\n");
        assert_eq!((halves.at[2], halves.planning.z_off_steps()), (12_000, Some(-37)));
    }
}

#[test]
fn the_switch_of_a_tool_ends_the_steps_whichever_half_sees_it() {
    for looks in [false, true] {
        let mut halves = Halves::new(settings(PlannerSettings::default(), TOOL), |_| true);
        halves.looks = looks;
        halves.at[2] = 11_000;
        let answers = halves.ask("G0 X20 Z20\n");
        assert!(
            answers.ends_with(
                "ALARM:1\r\n[MSG:axis z: stopped by its upper limit switch; home the machine]\r\n"
            ),
            "{answers}"
        );
        // At 10 mm/s it makes two steps before the main loop looks.
        let beyond = halves.at[2] - ENDS[2];
        assert!((0..=if looks { 0 } else { 4 }).contains(&beyond), "{beyond}");
        let (told_mm, z) = halves.heights();
        assert_eq!(told_mm, f64::from(z - 11_000) / 400.0);
        // Away from it is free.
        assert_eq!(halves.ask("$X\nG53 G0 Z0.5\n"), "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
        assert_eq!(halves.at[2], 11_200);
    }
}

#[test]
fn a_reset_and_the_button_end_the_steps_of_a_tool_and_its_place_stays_known() {
    for by_button in [false, true] {
        let mut halves = Halves::new(settings(PlannerSettings::default(), TOOL), |_| true);
        halves.send("G1 Z20 F600\n");
        let end_us = halves.now_us + 900_000;
        halves.run_to(end_us);
        let before = halves.at[2];
        assert!(before > 100 && before < 7_900, "{before}");
        if by_button {
            halves.stepping.emergency_stop(true);
            halves.run_to(end_us + 100_000);
            halves.stepping.emergency_stop(false);
        } else {
            halves.send("\u{18}");
        }
        halves.run_to(end_us + 200_000);
        assert_eq!(halves.at[2], before);
        let (told_mm, z) = halves.heights();
        assert_eq!(told_mm, f64::from(z) / 400.0);
        halves.answers.clear();
        assert_eq!(halves.ask("$X\nG0 Z1\n"), "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
        assert_eq!(halves.at[2], 400);
    }
}

proptest! {
    #![proptest_config(cases(16))]

    /// Two motors of an axis are made square by the halves, too, and stay so.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn two_motors_of_an_axis_are_made_square_in_two_halves(first in 0_i32..4_000, racked in -300_i32..300) {
        let second = Some(SecondMotor { axis: Axis::Y, offset_steps: 0, most_skew_steps: 400 });
        let settings = StepperPlotterSettings {
            second,
            homing: true,
            z: None,
            ..settings(PlannerSettings::default(), TOOL)
        };
        let mut halves = Halves::new(settings, |_| true);
        // A motor stops where the interrupt sees its switch.
        halves.looks = true;
        halves.at = [500, first, 0, (first + racked).max(0)];
        let ahead = halves.at[3] - first;
        let answers = halves.ask("$H\n");
        let (which, steps) = (if ahead < 0 { "first" } else { "second" }, ahead.abs());
        prop_assert_eq!(answers, format!("[MSG:Squared: the {which} motor was {steps} steps ahead]\r\nok\r\n"));
        prop_assert_eq!(halves.planning.skew_steps(), Some(ahead));
        prop_assert_eq!(halves.at[3], halves.at[1]);
        let origin = halves.at[1];
        prop_assert_eq!(halves.ask("G0 X10 Y10\nG0 Y3\n"), "ok\r\nok\r\n");
        prop_assert_eq!((halves.at[3], halves.at[1]), (origin + 263, origin + 263));
    }
}
