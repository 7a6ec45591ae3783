//! The stepper plotter's controller in two halves: a main loop that is away now and then, and an interrupt
//! that comes in time. Beside it the same controller in one piece, whose main loop is always there.

use crate::drawings;
use crate::sampled::sampled;
use crate::stepper_bench;

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Activity, Dialect, Drivers, Planning, StepperPlotterSettings, Stepping, StepsAhead, Underruns,
};
use plotter_motion::kinematics::Backlash;
use plotter_motion::planner::PathMode;
use plotter_motion::{
    Axis, Direction, LimitSwitches, PlannerSettings, PlotOp, Point, SafetyGate, StepPair, StepPoint, Vec2,
};
use proptest::prelude::*;
use std::collections::VecDeque;
use stepper_bench::Bench;

/// A step as it was made, us.
type Made = (u64, StepPair);

/// The interrupt's clock, which has 32 bits.
fn clock(us: u64) -> u32 {
    u32::try_from(us & u64::from(u32::MAX)).unwrap()
}

/// Both halves on a desk.
struct Halves {
    planning: Planning<'static>,
    stepping: Stepping<'static>,
    now_us: u64,
    /// Whether the main loop is there at a time, us.
    is_there: fn(u64) -> bool,
    made: Vec<Made>,
    pen: Vec<(u64, u8)>,
    answers: String,
}

/// How often the main loop comes, us.
const LOOP_US: u64 = 500;

impl Halves {
    fn new<const N: usize>(settings: StepperPlotterSettings, is_there: fn(u64) -> bool) -> Self {
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let memory = Box::leak(Box::new(StepsAhead::<N>::new()));
        let (planning, stepping) = StepperPlotter::new(settings, gate).unwrap().split(memory).unwrap();
        Self { planning, stepping, now_us: 0, is_there, made: vec![], pen: vec![], answers: String::new() }
    }

    fn now(&self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    /// The timer's interrupt.
    fn interrupt(&mut self) {
        let now_us = clock(self.now_us);
        while let Some(pulse) = self.stepping.tick(now_us, Drivers::Ready) {
            self.made.push((self.now_us, pulse.into()));
        }
        let deg = self.stepping.pen_deg();
        if self.pen.last().is_none_or(|(_, last)| *last != deg) {
            self.pen.push((self.now_us, deg));
        }
    }

    /// A turn of the main loop.
    fn turn(&mut self) {
        let now = self.now();
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

    fn send(&mut self, text: &str) {
        for byte in text.bytes() {
            self.planning.receive(self.now(), byte);
        }
    }

    /// Lets time pass until `end_us`.
    fn run_to(&mut self, end_us: u64) {
        while self.now_us < end_us {
            let next_turn = (self.now_us / LOOP_US + 1) * LOOP_US;
            let after = self.stepping.due().map(|due| due.wrapping_sub(clock(self.now_us)));
            // What is due and was not given, since something else comes first, is no more than now.
            let due = after.filter(|after| *after < u32::MAX / 2).map(|after| self.now_us + u64::from(after));
            self.now_us = due.map_or(next_turn, |due| due.min(next_turn)).min(end_us);
            self.interrupt();
            if self.now_us == next_turn && (self.is_there)(self.now_us) {
                self.turn();
            }
        }
    }

    fn run_for_ms(&mut self, ms: u64) {
        self.run_to(self.now_us + 1000 * ms);
    }

    /// A program that counts characters.
    fn stream(&mut self, text: &str) {
        let mut lines = text.split_inclusive('\n').peekable();
        let mut owed = VecDeque::new();
        let now = self.now();
        while lines.peek().is_some() || !owed.is_empty() {
            while let Some(line) = lines.next_if(|line| owed.iter().sum::<usize>() + line.len() <= 127) {
                owed.push_back(line.len());
                self.send(line);
            }
            // The line is fast: what the loop answers is heard at once while it is there.
            if (self.is_there)(self.now_us) {
                self.turn();
            }
            let taken = core::mem::take(&mut self.answers);
            for answer in taken.lines() {
                assert!(!answer.starts_with("error") && !answer.starts_with("ALARM"), "{answer}");
                if answer == "ok" {
                    owed.pop_front();
                }
            }
            if !taken.contains("ok") {
                let next = self.now_us / LOOP_US * LOOP_US + LOOP_US;
                self.run_to(next);
            }
            assert!(
                self.now() < now + Duration::from_secs(3_600),
                "it does not end: {:?}, {:?}, {owed:?}",
                self.planning.status(self.now()),
                self.planning.underruns()
            );
        }
        for _ in 0..100_000 {
            if self.planning.status(self.now()).activity == Activity::Idle {
                return;
            }
            self.run_for_ms(1);
        }
        panic!("it does not come to rest: {:?}", self.planning.status(self.now()));
    }
}

/// The same text by one whose loop is always there.
fn in_one(settings: StepperPlotterSettings, text: &str) -> (Vec<Made>, StepPoint) {
    let mut bench = Bench::new(settings);
    bench.switches = false;
    let mut lines = text.split_inclusive('\n').peekable();
    let mut owed = VecDeque::new();
    bench.run_to(Duration::from_micros(LOOP_US));
    bench.take_answers();
    while lines.peek().is_some() || !owed.is_empty() {
        while let Some(line) = lines.next_if(|line| owed.iter().sum::<usize>() + line.len() <= 127) {
            owed.push_back(line.len());
            bench.send(line);
        }
        let answers = bench.take_answers();
        owed.drain(..answers.matches("ok").count());
        if !answers.contains("ok") {
            let Some(due) = bench.plotter.due() else { panic!("{answers}, and nothing due") };
            bench.run_to(due);
        }
    }
    bench.run_out();
    let mut last = StepPoint::default();
    let steps = bench.made.iter().map(|made| {
        let (x, y) = (made.position.x - last.x, made.position.y - last.y);
        last = made.position;
        let step = StepPair { x: x.try_into().unwrap(), y: y.try_into().unwrap() };
        (u64::try_from(made.at.as_micros()).unwrap(), step)
    });
    (steps.collect(), bench.plotter.position())
}

fn settings(planner: PlannerSettings) -> StepperPlotterSettings {
    StepperPlotterSettings { dialect: Dialect::Grbl, planner, ..StepperPlotterSettings::default() }
}

/// A star, a spiral of chords, a circle, dots and a text-like zigzag.
fn drawing() -> String {
    let mut text = String::from("G21 G90\n");
    let mut line = |points: &[(f64, f64)]| {
        for (number, (x, y)) in points.iter().enumerate() {
            text += &if number == 0 {
                format!("G0 X{x:.3} Y{y:.3}\nM3\n")
            } else {
                format!("G1 X{x:.3} Y{y:.3} F5000\n")
            };
        }
        text += "M5\n";
    };
    let star: Vec<_> = (0..=5_u8)
        .map(|k| {
            let turn = f64::from(k) * 0.8 * std::f64::consts::PI;
            (60.0 + 40.0 * turn.sin(), 60.0 + 40.0 * turn.cos())
        })
        .collect();
    line(&star);
    let spiral: Vec<_> = (0..200_u8)
        .map(|k| {
            let turn = f64::from(k) * 0.2;
            (150.0 + turn * turn.sin(), 80.0 + turn * turn.cos())
        })
        .collect();
    line(&spiral);
    let zigzag: Vec<_> = (0..60_u8).map(|k| (20.0 + f64::from(k), 120.0 + 5.0 * f64::from(k % 3))).collect();
    line(&zigzag);
    text + "G0 X200 Y150\nM3\nG2 I-20 F4000\nM5\nG0 X10 Y10\nM3\nG4 P0.05\nM5\nM2\n"
}

fn modes() -> [PlannerSettings; 4] {
    let exact = PlannerSettings { accel_mm_s2: 2000.0, ..PlannerSettings::default() };
    let within = PathMode::Tolerance { path_tolerance_mm: 0.1 };
    [
        exact,
        PlannerSettings { path: within, ..exact },
        PlannerSettings { jerk_mm_s3: Some(50_000.0), ..exact },
        PlannerSettings { path: within, jerk_mm_s3: Some(50_000.0), ..exact },
    ]
}

/// Away for 20 ms in every 100 ms.
fn away_20(now_us: u64) -> bool {
    now_us % 100_000 < 80_000
}

/// Draws in two halves and in one, and compares every step and its time; gives how many there were.
fn assert_in_time<const N: usize>(settings: StepperPlotterSettings, text: &str) -> usize {
    let planner = settings.planner;
    let (alone, end) = in_one(settings, text);
    let mut halves = Halves::new::<N>(settings, away_20);
    halves.run_to(LOOP_US);
    halves.answers.clear();
    halves.stream(text);
    assert_eq!(halves.planning.position(), end);
    assert_eq!(halves.planning.lateness().steps(), 0, "{planner:?}");
    assert_eq!(halves.planning.underruns(), Underruns::default(), "{planner:?}");
    assert_eq!(halves.made.len(), alone.len(), "{planner:?}");
    let (mut shift, mut last) = (None, 0);
    for (number, (ahead, alone)) in halves.made.iter().zip(&alone).enumerate() {
        assert_eq!(ahead.1, alone.1, "step {number}, {planner:?}");
        let here = ahead.0.cast_signed() - alone.0.cast_signed();
        if shift != Some(here) {
            // It began anew: it stood before, and the main loop was away when it was to begin.
            assert!(alone.0 - last > 20_000 || number == 0, "step {number} of {planner:?}: {here} {shift:?}");
            shift = Some(here);
        }
        last = alone.0;
    }
    alone.len()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_step_is_at_its_tick_while_the_main_loop_is_away() {
    for planner in modes() {
        assert!(assert_in_time::<4096>(settings(planner), &drawing()) > 100_000);
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn forty_thousand_steps_a_second_of_both_motors_are_at_their_ticks() {
    // 457 mm/s along both axes.
    let speed_mm_s = 40_000.0 / 87.58 * 2.0_f64.sqrt();
    let fast = PlannerSettings {
        speed_mm_s,
        travel_speed_mm_s: speed_mm_s,
        accel_mm_s2: 10_000.0,
        ..PlannerSettings::default()
    };
    let text = "M3\nG1 X300 Y290 F50000\nX0 Y0\nX250 Y240\nX0\nM5\nM2\n";
    assert!(assert_in_time::<8192>(settings(fast), text) > 90_000);
}

/// The greatest acceleration that steps show, mm/s²: second differences over 16 ms of their places, each the
/// mean over a smooth window of 64 ms, in which a step of 0.01 mm counts for little.
fn felt(made: &[Made], steps_per_mm: f64) -> f64 {
    const BY_S: f64 = 0.016;
    let (Some(first), Some(last)) = (made.first(), made.last()) else { return 0.0 };
    let mut at = (0.0, 0.0);
    // At the time of a step the machine is half way between both places.
    let mut known = vec![(first.0 as f64 * 1e-6 - 0.2, at)];
    for (us, step) in made {
        let before = at;
        at = (at.0 + f64::from(step.x), at.1 + f64::from(step.y));
        known.push((*us as f64 * 1e-6, ((before.0 + at.0) / 2.0, (before.1 + at.1) / 2.0)));
    }
    known.push((last.0 as f64 * 1e-6 + 0.2, at));
    let place = |time_s: f64| {
        let behind = known.partition_point(|known| known.0 <= time_s).min(known.len() - 1).max(1);
        let ((t, a), (u, b)) = (known[behind - 1], known[behind]);
        // A step that is long in coming was for the most of that time not on its way.
        let share = ((time_s - u) / (u - t).min(0.02) + 1.0).clamp(0.0, 1.0);
        Vec2::new(a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1)) * (1.0 / steps_per_mm)
    };
    let smooth = |time_s: f64| {
        let (mut sum, mut all) = (Vec2::default(), 0.0);
        for k in -32..=32_i32 {
            let weight = 1.0 + (f64::from(k) * std::f64::consts::PI / 33.0).cos();
            sum = sum + place(time_s + f64::from(k) * 0.001) * weight;
            all += weight;
        }
        sum * (1.0 / all)
    };
    let span_s = (last.0 - first.0) as f64 * 1e-6;
    let looks = core::iter::successors(Some(0.0), |at_s| Some(at_s + 0.004))
        .take_while(|at_s| *at_s < span_s)
        .map(|at_s| first.0 as f64 * 1e-6 + at_s);
    let accel = |time_s: f64| {
        let [a, b, c] = [-BY_S, 0.0, BY_S].map(|by| smooth(time_s + by));
        (a + c - b * 2.0).length() / (BY_S * BY_S)
    };
    looks.map(accel).fold(0.0, f64::max)
}

/// Away for 400 ms in every 700 ms.
fn away_400(now_us: u64) -> bool {
    now_us % 700_000 < 300_000
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_that_runs_out_of_steps_comes_to_rest_within_its_limits_and_goes_on() {
    let planner = PlannerSettings { accel_mm_s2: 1000.0, ..PlannerSettings::default() };
    let settings = settings(planner);
    let text = "G0 X150 Y60\nM3\nG1 X20 Y150 F6000\nM5\nG0 X60 Y100\nM3\nG2 I80 F6000\nM5\n";
    let (alone, end) = in_one(settings, text);
    let mut halves = Halves::new::<2048>(settings, away_400);
    halves.run_to(LOOP_US);
    halves.answers.clear();
    halves.stream(text);
    let Underruns { slowed_steps, stops } = halves.planning.underruns();
    assert!(stops >= 4 && slowed_steps > 1000, "{stops} {slowed_steps}");
    assert_eq!(halves.planning.lateness().steps(), 0);
    assert_eq!(halves.planning.position(), end);
    // The same way, only slower.
    let ways = |made: &[Made]| made.iter().map(|made| made.1).collect::<Vec<_>>();
    assert!(ways(&halves.made) == ways(&alone));
    let (before, now) = (felt(&alone, 87.58), felt(&halves.made, 87.58));
    println!("{before:.0} mm/s² as planned, {now:.0} with {stops} stops");
    assert!(now < 1.05 * before.max(1000.0), "{now} {before}");
    // A machine that stops dead is found by the same measure.
    let cut: Vec<Made> =
        alone.iter().map(|(at, step)| (at + if *at > 1_500_000 { 300_000 } else { 0 }, *step)).collect();
    assert!(felt(&cut, 87.58) > 2.0 * before, "{}", felt(&cut, 87.58));
}

#[test]
fn a_memory_too_small_for_its_speed_makes_it_slower_and_is_told() {
    let planner = PlannerSettings { accel_mm_s2: 500.0, ..PlannerSettings::default() };
    let settings = settings(planner);
    let text = "G0 X150\nG0 X0\n";
    let mut halves = Halves::new::<256>(settings, |_| true);
    halves.run_to(LOOP_US);
    halves.answers.clear();
    halves.stream(text);
    let Underruns { slowed_steps, stops } = halves.planning.underruns();
    assert!(slowed_steps > 1000 && stops == 0, "{slowed_steps} {stops}");
    let felt = felt(&halves.made, 87.58);
    assert!(felt < 1.05 * 500.0, "{felt}");
    assert_eq!(halves.planning.position(), StepPoint::default());
}

#[test]
fn what_is_answered_at_a_standstill_is_answered_when_the_motors_stand() {
    let mut halves = Halves::new::<4096>(settings(PlannerSettings::default()), |_| true);
    halves.run_for_ms(5);
    halves.answers.clear();
    halves.send("G0 X20\nG4 P0.1\n");
    while !halves.answers.contains("ok\r\nok") {
        assert!(halves.now_us < 5_000_000, "{}", halves.answers);
        halves.run_to(halves.now_us + 500);
    }
    let last = halves.made.last().unwrap().0;
    assert_eq!(halves.planning.position(), StepPoint::new(1752, 0));
    assert!((100_000..105_000).contains(&(halves.now_us - last)), "{}", halves.now_us - last);
    // On its way it tells where it is, not what it has planned.
    halves.answers.clear();
    halves.send("G0 X0\n");
    halves.run_for_ms(180);
    halves.send("?");
    halves.run_for_ms(1);
    let at = halves.planning.position().x;
    assert!((100..1700).contains(&at), "{at}");
    let told: f64 = halves.answers.split("MPos:").nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((told * 87.58 - f64::from(at)).abs() < 10.0, "{} {at}", halves.answers);
    assert!(halves.answers.contains("<Run"), "{}", halves.answers);
}

/// A main loop that sleeps until it is due, through pauses too, longer and shorter than a second.
#[test]
fn a_main_loop_that_comes_when_it_is_due_is_enough() {
    let settings = settings(PlannerSettings::default());
    let text = "M3\nG1 X10 F3000\nG4 P2.5\nG1 Y20 F5400\nG4 P0.2\nG1 X0 Y0 F0.9\n";
    let text = text.replace("X0 Y0 F0.9", "X9.9 F0.6");
    let (alone, end) = in_one(settings, &text);
    let mut halves = Halves::new::<1024>(settings, |_| false);
    halves.turn();
    halves.send(&text);
    let mut turns = 0;
    while let Some(due) = {
        halves.turn();
        halves.planning.due()
    } {
        turns += 1;
        let due_us = u64::try_from(due.as_micros()).unwrap();
        assert!(due_us > halves.now_us || turns < 10, "{due:?}");
        halves.run_to(due_us.max(halves.now_us + 1));
        assert!(turns < 40_000, "it does not come to rest: {:?}", halves.planning.status(halves.now()));
    }
    assert_eq!(halves.planning.position(), end);
    assert!(halves.made.iter().map(|made| made.1).eq(alone.iter().map(|made| made.1)));
    assert_eq!((halves.planning.underruns(), halves.planning.lateness().steps()), (Underruns::default(), 0));
}

#[test]
fn a_press_that_is_over_before_the_main_loop_comes_latches_all_the_same() {
    let mut halves = on_its_way();
    halves.stepping.emergency_stop(true);
    halves.run_for_ms(5);
    halves.stepping.emergency_stop(false);
    halves.run_for_ms(5);
    // It is unlocked, and before the interrupt hears of that the button is pressed again, and let go.
    halves.send("$X\nG1 X50 F3000\n");
    while halves.planning.plan(halves.now()) {}
    assert!(!halves.planning.status(halves.now()).emergency_stop);
    let before = halves.made.len();
    halves.stepping.emergency_stop(true);
    halves.stepping.emergency_stop(false);
    halves.run_for_ms(500);
    assert_eq!(halves.made.len(), before);
    assert!(halves.planning.status(halves.now()).emergency_stop, "{}", halves.answers);
    halves.send("$X\nG0 X0\n");
    halves.run_for_ms(3000);
    assert_eq!(halves.planning.position(), StepPoint::default(), "{}", halves.answers);
}

/// A line that is being drawn at full speed.
fn on_its_way() -> Halves {
    let mut halves = Halves::new::<4096>(settings(PlannerSettings::default()), |_| true);
    halves.run_for_ms(5);
    halves.send("M3\nG1 X100 F5000\n");
    halves.run_for_ms(800);
    assert!(!halves.made.is_empty() && halves.stepping.pen_deg() == 90);
    halves.answers.clear();
    halves
}

#[test]
fn a_reset_ends_the_steps_at_once_and_the_place_stays_known() {
    let mut halves = on_its_way();
    let before = halves.made.len();
    halves.send("\u{18}");
    halves.run_for_ms(500);
    assert_eq!(halves.made.len(), before);
    let at = halves.stepping.position();
    assert_eq!((halves.planning.position(), halves.stepping.pen_deg()), (at, 160));
    assert!(halves.answers.contains("Grbl 1.1"), "{}", halves.answers);
    assert!(halves.answers.contains("ALARM:3"), "{}", halves.answers);
    halves.answers.clear();
    halves.send("$X\nG0 X0\n");
    halves.run_for_ms(3000);
    assert_eq!(halves.planning.position(), StepPoint::new(0, 0), "{}", halves.answers);
    let back = halves.made[before..].iter().map(|made| i32::from(made.1.x)).sum::<i32>();
    assert_eq!(back, -at.x);
}

#[test]
fn the_button_and_a_switch_end_the_steps_whichever_half_sees_them() {
    for by_stepping in [false, true] {
        let mut halves = on_its_way();
        let before = halves.made.len();
        if by_stepping {
            halves.stepping.emergency_stop(true);
        } else {
            halves.planning.emergency_stop(halves.now(), true);
        }
        halves.run_for_ms(300);
        assert_eq!(halves.made.len(), before);
        assert!(halves.answers.contains("ALARM:10"), "{}", halves.answers);
        assert!(halves.planning.status(halves.now()).emergency_stop);
        halves.answers.clear();
        halves.send("$X\nG0 X0\n");
        halves.run_for_ms(300);
        assert_eq!(halves.made.len(), before, "the button is still pressed");
        if by_stepping {
            halves.stepping.emergency_stop(false);
        } else {
            halves.planning.emergency_stop(halves.now(), false);
        }
        halves.run_for_ms(10);
        halves.send("$X\nG0 X0\n");
        halves.run_for_ms(3000);
        assert_eq!(halves.planning.position(), StepPoint::new(0, 0), "{}", halves.answers);

        let mut halves = on_its_way();
        let before = halves.made.len();
        if by_stepping {
            halves.stepping.limit_switch(Axis::X, Direction::Plus, true);
        } else {
            halves.planning.limit_switch(halves.now(), Axis::X, Direction::Plus, true);
        }
        halves.run_for_ms(300);
        assert_eq!(halves.made.len(), before);
        assert!(halves.answers.contains("ALARM:1"), "{}", halves.answers);
        assert!(halves.planning.status(halves.now()).limits.x_max);
        // Away from the switch it is free.
        halves.send("$X\nG0 X0\n");
        halves.run_for_ms(3000);
        assert_eq!(halves.planning.position(), StepPoint::new(0, 0), "{}", halves.answers);
    }
}

#[test]
fn a_hold_brakes_along_the_path_and_goes_on() {
    let mut halves = on_its_way();
    let running = halves.planning.position().x;
    halves.send("!");
    halves.run_for_ms(1000);
    let held = halves.planning.position().x;
    assert!(held > running && held < 8758, "{running} {held}");
    assert_eq!(halves.stepping.pen_deg(), 160);
    halves.send("?");
    halves.run_for_ms(1);
    assert!(halves.answers.contains("<Hold:0"), "{}", halves.answers);
    halves.send("~");
    halves.run_for_ms(3000);
    assert_eq!(halves.planning.position(), StepPoint::new(8758, 0));
    let felt = felt(&halves.made, 87.58);
    assert!(felt < 1.05 * 1000.0, "{felt}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn it_homes_with_its_place_known_again() {
    let homing = StepperPlotterSettings { homing: true, ..settings(PlannerSettings::default()) };
    let mut halves = Halves::new::<1024>(homing, |_| true);
    halves.run_for_ms(5);
    halves.send("$H\n");
    // Both carriages are 3 mm from their lower switches.
    let mut at = [263_i32, 263];
    let (mut seen, mut now) = (0, halves.now_us);
    while !halves.answers.contains("ok") {
        now += 500;
        halves.run_to(now);
        for (_, step) in &halves.made[seen..] {
            at[0] += i32::from(step.x);
            at[1] += i32::from(step.y);
        }
        seen = halves.made.len();
        for (axis, at) in [(Axis::X, at[0]), (Axis::Y, at[1])] {
            halves.planning.limit_switch(halves.now(), axis, Direction::Minus, at <= 0);
            halves.planning.limit_switch(halves.now(), axis, Direction::Plus, at >= 33_300);
        }
        assert!(now < 120_000_000, "{} {at:?}", halves.answers);
    }
    assert_eq!(halves.planning.position(), StepPoint::default());
    halves.send("G0 X10 Y5\n");
    halves.run_for_ms(2000);
    assert_eq!(halves.planning.position(), StepPoint::new(876, 438), "{}", halves.answers);
    assert_eq!(halves.stepping.position(), StepPoint::new(876, 438));
}

#[test]
fn play_is_taken_up_the_same() {
    let settings = StepperPlotterSettings {
        backlash: Backlash { x_steps: 7, y_steps: 5 },
        ..settings(PlannerSettings::default())
    };
    let text = "G0 X10 Y10\nG0 X5\nG0 Y3\nG0 X8 Y7\nG0 X0 Y0\n";
    let (alone, end) = in_one(settings, text);
    let mut halves = Halves::new::<2048>(settings, |_| true);
    halves.run_to(LOOP_US);
    halves.answers.clear();
    halves.stream(text);
    assert_eq!(halves.planning.position(), end);
    let ways = |made: &[Made]| made.iter().map(|made| made.1).collect::<Vec<_>>();
    assert!(ways(&halves.made) == ways(&alone));
}

#[test]
fn delays_in_a_stream_are_the_same_steps() {
    let run = |streams: bool| {
        let mut halves = Halves::new::<8192>(settings(PlannerSettings::default()), |_| true);
        halves.send("M3\nG1 X10 Y3 F3000\nG1 X12 Y8\nM5\n");
        let (mut steps, mut now_us) = (Vec::new(), 0_u64);
        for turn in 0..8000_u64 {
            let now = Duration::from_micros(turn * 500);
            halves.planning.plan(now);
            while halves.planning.transmit(now).is_some() {}
            if streams {
                now_us = now_us.max(turn * 500);
                while let Some((after_us, pulse)) = halves.stepping.stream() {
                    now_us += u64::from(after_us);
                    if let Some(pulse) = pulse {
                        steps.push(StepPair::from(pulse));
                    }
                }
            } else {
                while let Some(due) = halves.stepping.due().or(Some(clock(turn * 500))) {
                    let Some(pulse) = halves.stepping.tick(due, Drivers::Ready) else { break };
                    steps.push(StepPair::from(pulse));
                }
            }
        }
        (steps, halves.stepping.position())
    };
    let (streamed, at) = run(true);
    assert_eq!((streamed.len(), at), (run(false).0.len(), StepPoint::new(1051, 701)));
}

proptest! {
    #![proptest_config(cases(24))]

    /// Whatever a host sends and whenever the main loop and both switches come: what is told as the place is
    /// what the motors made, and nothing moves behind a stop.
    #[test]
    fn the_place_is_what_the_motors_made(
        bytes in proptest::collection::vec(
            prop_oneof![
                Just("G0 X20\n"), Just("G1 X5 Y9 F900\n"), Just("G2 I3 F600\n"), Just("!"), Just("~"),
                Just("\u{18}"), Just("$X\n"), Just("M3\n"), Just("M5\n"), Just("$J=G91 X3 F500\n"), Just("G4 P0.01\n"),
                Just("?"), Just("M0\n"), Just("$H\n"),
            ],
            1..40,
        ),
        waits in proptest::collection::vec(0_u64..300, 40),
        button_at in 0_usize..60,
    ) {
        let mut halves = Halves::new::<512>(settings(PlannerSettings::default()), |now| now % 50_000 < 30_000);
        halves.run_for_ms(3);
        for (number, (text, wait)) in bytes.iter().zip(&waits).enumerate() {
            halves.send(text);
            halves.run_for_ms(*wait);
            if number == button_at {
                halves.stepping.emergency_stop(true);
                let before = halves.made.len();
                halves.run_for_ms(100);
                prop_assert_eq!(halves.made.len(), before);
                halves.stepping.emergency_stop(false);
            }
        }
        halves.run_for_ms(5000);
        let sum = halves.made.iter().fold((0, 0), |sum, made| (sum.0 + i32::from(made.1.x), sum.1 + i32::from(made.1.y)));
        prop_assert_eq!(halves.planning.position(), StepPoint::new(sum.0, sum.1));
        prop_assert_eq!(halves.stepping.position(), StepPoint::new(sum.0, sum.1));
        let told = halves.planning.status(halves.now()).at;
        prop_assert!(told.distance(Point::new(f64::from(sum.0) / 87.58, f64::from(sum.1) / 87.58)) < 1e-9);
    }
}

#[test]
fn two_threads_make_every_step_once_and_in_order() {
    let settings = settings(PlannerSettings::default());
    let text = "M3\nG1 X30 Y10 F5400\nG1 X2 Y20\nG3 I4 F3000\nG1 X0 Y0\nM5\nM2\n";
    let (alone, _) = in_one(settings, text);
    let mut memory = StepsAhead::<1024>::new();
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let (mut planning, mut stepping) =
        StepperPlotter::new(settings, gate).unwrap().split(&mut memory).unwrap();
    let ends = core::sync::atomic::AtomicBool::new(false);
    let made = std::thread::scope(|scope| {
        let stepper = scope.spawn(|| {
            let (mut made, mut now_us) = (Vec::new(), 0_u32);
            while !ends.load(core::sync::atomic::Ordering::Acquire) {
                // Its own time, which runs as fast as it can.
                now_us = stepping.due().map_or(now_us, |due| due);
                match stepping.tick(now_us, Drivers::Ready) {
                    Some(pulse) => made.push(StepPair::from(pulse)),
                    None => std::thread::yield_now(),
                }
            }
            made
        });
        for byte in text.bytes() {
            planning.receive(Duration::ZERO, byte);
        }
        let mut answers = String::new();
        let mut now = Duration::ZERO;
        while !answers.contains("Pgm End") {
            now += Duration::from_millis(1);
            planning.plan(now);
            while let Some(byte) = planning.transmit(now) {
                answers.push(char::from(byte));
            }
            assert!(now < Duration::from_secs(100_000), "{answers}");
        }
        ends.store(true, core::sync::atomic::Ordering::Release);
        stepper.join().unwrap()
    });
    assert!(made == alone.iter().map(|made| made.1).collect::<Vec<_>>());
}

/// A drawing as G-code: its strokes with the pen down, all that the area takes.
fn as_text(ops: &[PlotOp]) -> String {
    let mut text = String::new();
    let (mut is_down, mut at) = (false, Point::ORIGIN);
    for op in ops {
        let (to, draws) = match *op {
            PlotOp::Travel { to } => (to, false),
            PlotOp::Draw { to, .. } | PlotOp::DrawArc { to, .. } => (to, true),
            _ => continue,
        };
        if draws != is_down {
            text += if draws { "M3\n" } else { "M5\n" };
            is_down = draws;
        }
        let (x, y) = (to.x.clamp(0.0, 380.0), to.y.clamp(0.0, 310.0));
        text += &match *op {
            PlotOp::DrawArc { centre, sweep_rad, .. } => {
                let code = if sweep_rad > 0.0 { 3 } else { 2 };
                let out = centre - at;
                format!("G{code}X{x:.4}Y{y:.4}I{:.4}J{:.4}F6000\n", out.x, out.y)
            }
            _ if draws => format!("G1X{x:.4}Y{y:.4}F6000\n"),
            _ => format!("G0X{x:.4}Y{y:.4}\n"),
        };
        at = Point::new(x, y);
    }
    text + "M5\nM2\n"
}

/// The drawings on which planning is measured, four of them of other programs.
#[test]
#[ignore = "long: .ci/run has it in release"]
fn every_step_of_the_measured_drawings_is_at_its_tick() {
    for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
        let text = as_text(&drawing.ops);
        for (planner, mode) in modes().into_iter().zip(["exact", "tolerance", "s-curve", "tolerance s-curve"])
        {
            let steps = assert_in_time::<8192>(settings(planner), &text);
            println!("{} {mode}: {steps} steps, none late, none slowed", drawing.name);
        }
    }
}

/// A row of steps and the times between them as a number, by FNV-1a as in `examples/firmware/counts`.
/// Where a machine stood it may begin again whenever its main loop is there.
fn row(made: &[Made]) -> u64 {
    let (mut sum, mut last_us) = (0xCBF2_9CE4_8422_2325_u64, None);
    for (us, step) in made {
        let after: u64 = last_us.map_or(0, |last_us| us - last_us);
        let after = if after > 20_000 { 0 } else { after };
        let bytes = [step.x, step.y].map(|step| step.to_le_bytes()[0]);
        for byte in after.to_le_bytes().into_iter().chain(bytes) {
            sum = (sum ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3);
        }
        last_us = Some(*us);
    }
    sum
}

/// The drawings on which planning is measured as `examples/firmware/counts/check --drawings` wants them, in
/// the file that `PLOTTER_DRAWINGS` names: a line with a name and what [`row`] is in each mode, then the
/// drawing's lines.
#[test]
#[ignore = "by hand: examples/firmware/counts/check --drawings runs it"]
fn the_drawings_for_a_board() {
    let Some(path) = std::env::var_os("PLOTTER_DRAWINGS") else { return };
    let mut file = String::new();
    for drawing in drawings::built().into_iter().chain(drawings::real()) {
        let text = as_text(&drawing.ops);
        assert!(!text.contains(';') && text.lines().all(|line| line.len() < 48), "{}", drawing.name);
        let rows = modes().map(|planner| format!("{:x}", row(&in_one(settings(planner), &text).0)));
        file += &format!(";{}\t{}\n{text}", drawing.name, rows.join("\t"));
    }
    std::fs::write(path, file).unwrap();
}
