//! A third axis: planned and stepped within its limits, moved by Grbl's words, homed before the others.

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Dialect, Drivers, Receive, SecondMotor, SettingsError, StepperPlotterSettings, ZAxis, ZHoming, ZPen,
};
use plotter_motion::gcode::PenConvention;
use plotter_motion::kinematics::{Cartesian, MotorScale};
use plotter_motion::planner::{AllModes, Modes, PathMode, PlanError, ThreeAxes, ZLimits};
use plotter_motion::safety::EndSwitches;
use plotter_motion::stepgen::{MotorEvent, StepGenSettings, TimedEvent};
use plotter_motion::{
    Axis, Direction, LimitSwitches, Planner, PlannerSettings, PlotOp, Point, SafetyGate, StepGen,
};
use proptest::prelude::*;

const Z: ZLimits = ZLimits { speed_mm_s: 5.0, accel_mm_s2: 50.0, step_mm: 0.0025 };

fn motors<M: Modes>() -> StepGen<Cartesian, M> {
    let motor = MotorScale { steps_per_mm: 100.0, inverted: false };
    let timing = StepGenSettings { pen_settle: Duration::ZERO, ..StepGenSettings::default() };
    StepGen::with_modes(Cartesian::new(motor, motor).unwrap(), timing)
}

/// All events of a planner that is kept full.
fn events<M: Modes>(
    planner: &mut Planner<16, M>,
    steps: &mut StepGen<Cartesian, M>,
    ops: &[(PlotOp, Option<f64>)],
) -> Vec<TimedEvent> {
    let (mut ops, mut ended, mut events) = (ops.iter(), false, Vec::new());
    loop {
        while planner.has_room() && !ended {
            match ops.next() {
                Some(&(op, Some(height_mm))) => planner.push_rising(op, height_mm).unwrap(),
                Some(&(op, None)) => planner.push(op).unwrap(),
                None => {
                    planner.finish().unwrap();
                    ended = true;
                }
            }
        }
        let Some(action) = planner.next_action() else { return events };
        steps.push(action).unwrap();
        while let Some(event) = steps.next_event() {
            events.push(event);
        }
    }
}

fn rising(settings: PlannerSettings, ops: &[(PlotOp, Option<f64>)]) -> Vec<TimedEvent> {
    let mut planner = Planner::<16, ThreeAxes>::with_modes(settings).unwrap();
    planner.set_z_limits(&Z).unwrap();
    let mut steps = motors::<ThreeAxes>();
    steps.set_z(1.0 / Z.step_mm, 0);
    events(&mut planner, &mut steps, ops)
}

/// Where the motors have come to.
fn end(events: &[TimedEvent]) -> [i32; 3] {
    let mut at = [0; 3];
    for timed in events {
        match timed.event {
            MotorEvent::Step(pair) => {
                at[0] += i32::from(pair.x);
                at[1] += i32::from(pair.y);
            }
            MotorEvent::StepZ(step) => at[2] += i32::from(step),
            _ => {}
        }
    }
    at
}

/// Greatest speed and acceleration of z, over windows of so many steps, from the times of its steps alone.
fn felt(events: &[TimedEvent]) -> (f64, f64) {
    const WINDOW: usize = 50;
    let mut at = 0;
    let mut made = vec![(0.0, 0)];
    for timed in events {
        if let MotorEvent::StepZ(step) = timed.event {
            at += i32::from(step);
            #[expect(clippy::cast_precision_loss, reason = "microseconds of some minutes")]
            made.push((timed.tick as f64 * 1e-6, at));
        }
    }
    let speed = |from: (f64, i32), to: (f64, i32)| f64::from(to.1 - from.1) * Z.step_mm / (to.0 - from.0);
    let (mut fastest, mut hardest) = (0.0_f64, 0.0_f64);
    for three in made.windows(2 * WINDOW + 1) {
        let (first, middle, last) = (three[0], three[WINDOW], three[2 * WINDOW]);
        // Where it turns round it stands.
        if (last.1 - first.1).unsigned_abs() as usize != 2 * WINDOW {
            continue;
        }
        let (before, after) = (speed(first, middle), speed(middle, last));
        fastest = fastest.max(before.abs());
        hardest = hardest.max((after - before).abs() / (0.5 * (last.0 - first.0)));
    }
    (fastest, hardest)
}

fn path() -> impl Strategy<Value = PathMode> {
    prop_oneof![Just(PathMode::Exact), Just(PathMode::Tolerance { path_tolerance_mm: 0.05 })]
}

/// Trapezoids, or S-curves.
fn jerk() -> impl Strategy<Value = Option<f64>> {
    prop::option::of(1_000.0..50_000.0)
}

/// Lines, arcs, travels and z alone, in steps of a tenth of a millimetre.
fn op() -> impl Strategy<Value = (PlotOp, Option<f64>)> {
    let place =
        (0_i32..800, 0_i32..800).prop_map(|(x, y)| Point::new(f64::from(x) / 10.0, f64::from(y) / 10.0));
    let height = prop_oneof![
        1 => Just(None),
        3 => (-40_i32..40).prop_map(|z| Some(f64::from(z) / 20.0)),
    ];
    (place, 0_u8..4, 1_u32..80, height).prop_map(|(to, kind, feed, height)| {
        let feed_mm_s = Some(f64::from(feed));
        let op = match kind {
            0 => PlotOp::Travel { to },
            1 => PlotOp::DrawArc { centre: Point::new(to.x + 10.0, to.y), sweep_rad: 2.0, to, feed_mm_s },
            _ => PlotOp::Draw { to, feed_mm_s },
        };
        (op, height)
    })
}

proptest! {
    #![proptest_config(cases(64))]

    /// Where a tool path has led, all three motors are, to the step; and z is never driven harder than it is
    /// said to stand.
    #[test]
    fn three_motors_end_where_they_are_told_and_z_keeps_its_limits(
        ops in prop::collection::vec(op(), 1..30),
        path in path(),
        jerk_mm_s3 in jerk(),
    ) {
        let settings = PlannerSettings { path, jerk_mm_s3, ..PlannerSettings::default() };
        let events = rising(settings, &ops);
        prop_assert!(events.is_sorted_by_key(|timed| timed.tick));
        let to = ops.last().and_then(|(op, _)| op.target()).unwrap();
        let height_mm = ops.iter().rev().find_map(|(_, height)| *height).unwrap_or(0.0);
        let expected = [to.x * 100.0, to.y * 100.0, height_mm / Z.step_mm];
        prop_assert_eq!(end(&events).map(f64::from), expected.map(f64::round));
        let (fastest, hardest) = felt(&events);
        prop_assert!(fastest <= 1.05 * Z.speed_mm_s, "{} mm/s", fastest);
        prop_assert!(hardest <= 1.05 * Z.accel_mm_s2, "{} mm/s²", hardest);
    }

    /// What has no height is drawn by a machine with three axes as by one with two, to the tick.
    #[test]
    fn a_drawing_without_heights_is_stepped_as_with_two_axes(
        ops in prop::collection::vec(op().prop_map(|(op, _)| (op, None)), 1..30),
        path in path(),
        jerk_mm_s3 in jerk(),
    ) {
        let settings = PlannerSettings { path, jerk_mm_s3, ..PlannerSettings::default() };
        let mut planner = Planner::<16, AllModes>::with_modes(settings).unwrap();
        let flat = events(&mut planner, &mut motors::<AllModes>(), &ops);
        prop_assert_eq!(rising(settings, &ops), flat);
    }
}

#[test]
fn a_slope_in_short_lines_is_one_slope() {
    let line = |x: f64| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: Some(20.0) };
    let one = rising(PlannerSettings::default(), &[(line(32.0), Some(2.0))]);
    let short: Vec<_> = (1..=32).map(|n| (line(f64::from(n)), Some(f64::from(n) / 16.0))).collect();
    let many = rising(PlannerSettings::default(), &short);
    assert_eq!(end(&one), [3200, 0, 800]);
    assert_eq!(end(&many), [3200, 0, 800]);
    let (one_us, many_us) = (one.last().unwrap().tick, many.last().unwrap().tick);
    assert!(many_us.abs_diff(one_us) < 100, "{one_us} {many_us}");
    // 32.062 mm at 20 mm/s, and 25 ms for the ends: z's 50 mm/s² are 801 mm/s² along the path.
    assert!(one_us.abs_diff(1_628_000) < 500, "{one_us}");
}

/// A surface that is followed up and down in short lines: many small changes of slope.
#[test]
fn a_wave_in_short_lines_keeps_the_limits_of_z() {
    let at = |n: u32| f64::from(n) / 5.0;
    let wave: Vec<_> = (1..=300)
        .map(|n| {
            let to = Point::new(at(n), 0.5 * at(n));
            (PlotOp::Draw { to, feed_mm_s: Some(40.0) }, Some(1.5 * at(n).sin()))
        })
        .collect();
    let events = rising(PlannerSettings::default(), &wave);
    let (fastest, hardest) = felt(&events);
    assert!(fastest <= 1.05 * Z.speed_mm_s && hardest <= 1.05 * Z.accel_mm_s2, "{fastest} {hardest}");
    // Not at a crawl: 60 mm to the right and 57 mm up and down, of which z may make 5 mm/s.
    let time_s = Duration::from_micros(events.last().unwrap().tick).as_secs_f64();
    assert!((11.4..30.0).contains(&time_s), "{time_s}");
}

/// With a limited jerk z alone is an S-curve of its own limits, and of the jerk its share.
#[test]
fn a_tool_that_rises_alone_makes_an_s_curve() {
    let jerk = PlannerSettings { jerk_mm_s3: Some(20_000.0), ..PlannerSettings::default() };
    let alone = [(PlotOp::Travel { to: Point::ORIGIN }, Some(10.0))];
    let events = rising(jerk, &alone);
    assert_eq!(end(&events), [0, 0, 4000]);
    // 1000 mm/s² times 0.9 along the path are 18 times z's 50, so its jerk is 1111 mm/s³: 10 mm at 5 mm/s,
    // 0.1 s to speed up and to brake, and 45 ms of jerk. The last step is made half a step before the end.
    let took_s = events.last().unwrap().tick as f64 * 1e-6;
    assert!((took_s - 2.145).abs() < 0.02, "{took_s}");
    let trapezoid_s = rising(PlannerSettings::default(), &alone).last().unwrap().tick as f64 * 1e-6;
    assert!((trapezoid_s - 2.1).abs() < 0.01, "{trapezoid_s}");
    let (fastest, hardest) = felt(&events);
    assert!(fastest <= 1.01 * Z.speed_mm_s && hardest <= 1.01 * Z.accel_mm_s2, "{fastest} {hardest}");
    // Before and after what rises with the others the machine stands: 20 mm/s are not kept.
    let line = |x: f64| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: Some(20.0) };
    let events = rising(jerk, &[(line(20.0), None), (line(40.0), Some(2.0)), (line(60.0), None)]);
    assert_eq!(end(&events), [6000, 0, 800]);
    for x in [2000, 4000] {
        let mut at = 0;
        let near: Vec<_> = events
            .iter()
            .filter_map(|timed| {
                let MotorEvent::Step(pair) = timed.event else { return None };
                at += i32::from(pair.x);
                (at - x).abs().lt(&3).then_some(timed.tick)
            })
            .collect();
        let slowest_us = near.windows(2).map(|two| two[1] - two[0]).max().unwrap();
        assert!(slowest_us > 5_000, "{x}: {near:?}");
    }
}

#[test]
fn z_is_refused_where_there_is_none() {
    let up = PlotOp::Travel { to: Point::ORIGIN };
    let mut flat = Planner::<16>::new(PlannerSettings::default()).unwrap();
    assert_eq!(flat.push_rising(up, 1.0), Err(PlanError::Mode { quantity: "z" }));
    assert_eq!(flat.set_z_limits(&Z), Err(PlanError::Mode { quantity: "z" }));
    let mut planner = Planner::<16, ThreeAxes>::with_modes(PlannerSettings::default()).unwrap();
    assert_eq!(planner.push_rising(up, 1.0), Err(PlanError::Mode { quantity: "z" }));
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for limits in [
            ZLimits { speed_mm_s: bad, ..Z },
            ZLimits { accel_mm_s2: bad, ..Z },
            ZLimits { step_mm: bad, ..Z },
        ] {
            assert!(matches!(planner.set_z_limits(&limits), Err(PlanError::Setting { .. })), "{limits:?}");
        }
    }
    let mut planner = Planner::<16, ThreeAxes>::with_modes(PlannerSettings::default()).unwrap();
    planner.set_z_limits(&Z).unwrap();
    for bad in [f64::NAN, f64::INFINITY, 1e8] {
        assert!(matches!(planner.push_rising(up, bad), Err(PlanError::Place { .. })), "{bad}");
    }
    assert!(planner.is_empty());
}

/// The controller, three motors that lose no step, and their switches.
struct Bench {
    plotter: StepperPlotter<Receive, ThreeAxes>,
    now: Duration,
    /// Steps from the lower switches.
    at: [i32; 3],
    /// Whether the upper switch of z is stuck, pressed or open.
    stuck: Option<bool>,
    lower: bool,
    /// The second motor of y: where it is, and its switches are, in the first one's steps.
    second: Option<(i32, [i32; 2])>,
    answers: String,
}

const LENGTHS: [i32; 3] = [34_000, 28_000, 12_400];

fn settings() -> StepperPlotterSettings {
    let z = ZAxis { home: Some(ZHoming::default()), ..ZAxis::default() };
    StepperPlotterSettings { dialect: Dialect::Grbl, z: Some(z), ..StepperPlotterSettings::default() }
}

fn with_z(z: ZAxis) -> StepperPlotterSettings {
    StepperPlotterSettings { z: Some(z), ..settings() }
}

impl Bench {
    fn new(settings: StepperPlotterSettings) -> Self {
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        let plotter = StepperPlotter::with_modes(settings, gate).unwrap();
        let mut bench = Self {
            plotter,
            now: Duration::ZERO,
            at: [500, 500, 0],
            stuck: None,
            lower: false,
            second: None,
            answers: String::new(),
        };
        let greeting = bench.ask("");
        assert!(greeting.starts_with("\r\nGrbl 1.1h ['$' for help]\r\n"), "{greeting}");
        bench
    }

    fn switch(&mut self) {
        let pressed = |axis: usize| (self.at[axis] <= 0, self.at[axis] >= LENGTHS[axis]);
        for (axis, number) in [(Axis::X, 0), (Axis::Y, 1)] {
            let (lower, upper) = pressed(number);
            self.plotter.limit_switch(self.now, axis, Direction::Minus, lower);
            self.plotter.limit_switch(self.now, axis, Direction::Plus, upper);
        }
        let upper = self.stuck.unwrap_or(pressed(2).1);
        self.plotter.z_switches(self.now, EndSwitches { lower: self.lower, upper });
        if let Some((at, [lower, upper])) = self.second {
            let switches = EndSwitches { lower: at <= lower, upper: at >= upper };
            self.plotter.second_switches(self.now, switches);
        }
    }

    fn settle(&mut self) {
        while let Some(step) = self.plotter.poll(self.now, Drivers::Ready) {
            let by = [step.pulse.x(), step.pulse.y(), step.pulse.z()];
            for (at, by) in self.at.iter_mut().zip(by) {
                *at += i32::from(by);
            }
            if let Some((at, [lower, _])) = &mut self.second {
                *at += i32::from(step.pulse.second(Axis::Y));
                assert!(at >= lower, "{at} {lower}");
            }
            self.switch();
            // No motor is driven into its switch.
            assert!(self.at[2] <= LENGTHS[2] && self.at[0] >= 0 && self.at[1] >= 0, "{:?}", self.at);
        }
        while let Some(byte) = self.plotter.transmit(self.now) {
            self.answers.push(byte.into());
        }
    }

    fn send(&mut self, text: &str) {
        self.switch();
        self.settle();
        for byte in text.bytes() {
            self.plotter.receive(self.now, byte);
            self.settle();
        }
    }

    fn run_for(&mut self, time: Duration) {
        let end = self.now + time;
        while let Some(due) = self.plotter.due().filter(|due| *due <= end) {
            self.now = self.now.max(due);
            self.settle();
        }
        self.now = end;
        self.settle();
    }

    /// Sends text and waits until nothing more happens; gives the answers.
    fn ask(&mut self, text: &str) -> String {
        self.send(text);
        while let Some(due) = self.plotter.due() {
            self.now = self.now.max(due);
            self.settle();
        }
        core::mem::take(&mut self.answers)
    }

    /// The place that is told, and whether that of the motors is the same.
    fn place(&mut self) -> String {
        let report = self.ask("?");
        let place = report.split(['|', '\r']).find(|part| part.starts_with("MPos:")).unwrap().to_owned();
        let z = self.plotter.z_mm().unwrap();
        assert!((z * 400.0 - f64::from(self.at[2])).abs() < 1e-6, "{z} {:?}", self.at);
        place
    }
}

#[test]
fn the_words_of_a_line_move_all_three() {
    let mut bench = Bench::new(settings());
    for (line, place) in [
        ("G0 Z5", "MPos:0.000,0.000,5.000"),
        ("G1 X10 Y10 Z0 F600", "MPos:10.002,10.002,0.000"),
        ("G2 X20 I5 J0 Z2", "MPos:20.005,10.002,2.000"),
        ("G91 G1 Z-0.5", "MPos:20.005,10.002,1.500"),
        ("G90 G20 G1 Z0.1 F30", "MPos:20.005,10.002,2.540"),
        ("G21 G92 Z1", "MPos:20.005,10.002,2.540"),
        ("G0 Z2", "MPos:20.005,10.002,3.540"),
        ("G53 G0 Z4", "MPos:20.005,10.002,4.000"),
        ("G92.1", "MPos:20.005,10.002,4.000"),
        ("G10 L2 P2 Z10", "MPos:20.005,10.002,4.000"),
        ("G55 G0 Z1", "MPos:20.005,10.002,11.000"),
        ("G10 L20 P2 Z0", "MPos:20.005,10.002,11.000"),
        ("G0 Z-1", "MPos:20.005,10.002,10.000"),
        ("G43.1 Z2", "MPos:20.005,10.002,10.000"),
        ("G0 Z-1", "MPos:20.005,10.002,12.000"),
        ("G49", "MPos:20.005,10.002,12.000"),
        ("G54", "MPos:20.005,10.002,12.000"),
        ("G30.1", "MPos:20.005,10.002,12.000"),
        ("G0 X1 Y1 Z1", "MPos:1.005,1.005,1.000"),
        ("G30 Z20", "MPos:1.005,1.005,12.000"),
        ("G0 Z1", "MPos:1.005,1.005,1.000"),
        ("G28", "MPos:0.000,0.000,0.000"),
        ("$J=G91 X2 Z3 F600", "MPos:1.998,0.000,3.000"),
        ("M5", "MPos:1.998,0.000,3.000"),
        ("G1 X3 F600", "MPos:3.003,0.000,3.000"),
    ] {
        assert_eq!(bench.ask(&format!("{line}\n")), "ok\r\n", "{line}");
        assert_eq!(bench.place(), place, "{line}");
    }
    let offsets = bench.ask("$#\n");
    for told in ["[G54:0.000,0.000,0.000]", "[G55:0.000,0.000,11.000]", "[G30:20.000,10.000,12.000]"] {
        assert!(offsets.contains(told), "{offsets}");
    }
}

#[test]
fn its_offsets_are_told_when_they_change() {
    let mut bench = Bench::new(settings());
    for _ in 0..3 {
        bench.ask("?");
    }
    assert_eq!(bench.ask("G92 Z-3\n"), "ok\r\n");
    assert!(bench.ask("?").contains("|WCO:0.000,0.000,3.000>"));
    assert!(bench.ask("$#\n").contains("[G92:0.000,0.000,3.000]\r\n"));
}

#[test]
fn what_leaves_its_travel_is_refused() {
    let mut bench = Bench::new(settings());
    assert_eq!(bench.ask("$J=Z31 F600\n"), "error:15\r\n");
    assert_eq!(bench.ask("G1 Z1\n"), "error:22\r\n");
    assert_eq!(bench.ask("G93\nG1 Z1 F2\nG94\n"), "ok\r\nerror:20\r\nok\r\n");
    for line in ["G0 Z-0.01", "G0 X5 Z30.01", "G91 G0 Z31"] {
        assert_eq!(bench.ask(&format!("{line}\n")), "ALARM:2\r\nerror:33\r\n", "{line}");
        assert_eq!(bench.ask("G0 X1\n"), "error:9\r\n");
        assert_eq!(bench.ask("$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    }
    // What was refused has left nothing behind.
    assert_eq!(bench.place(), "MPos:0.000,0.000,0.000");
    assert_eq!(bench.ask("$C\nG0 Z10\n$C\n").lines().filter(|line| *line == "ok").count(), 3);
    assert_eq!(bench.ask("G90 G91 G0\nG91\nG0 Z1\n").lines().last(), Some("ok"));
    assert_eq!(bench.place(), "MPos:0.000,0.000,1.000");
}

#[test]
fn its_settings_are_read_and_changed() {
    let mut bench = Bench::new(settings());
    let all = bench.ask("$$\n");
    for told in ["$102=400.000\r\n", "$112=600.000\r\n", "$122=100.000\r\n", "$132=30.000\r\n"] {
        assert!(all.contains(told), "{all}");
    }
    assert_eq!(bench.ask("$132=12.5\n$112=300\n$122=40\n"), "ok\r\nok\r\nok\r\n");
    assert_eq!(bench.ask("$112=20000\n$102=0\n"), "error:12\r\nerror:52\r\n"); // 333 mm/s of 400 steps
    let z = bench.plotter.settings().z.unwrap();
    assert_eq!((z.travel_mm, z.speed_mm_s, z.accel_mm_s2), (12.5, 5.0, 40.0));
    assert_eq!(bench.ask("G0 Z12\n"), "ok\r\n");
    let began = bench.now;
    assert_eq!(bench.ask("G0 Z2\nG4 P0\n"), "ok\r\nok\r\n");
    // 10 mm at 5 mm/s, and 0.125 s for speeding up and braking, halves of which are lost.
    let took_s = (bench.now - began).as_secs_f64();
    assert!((took_s - 2.125 - 0.05).abs() < 0.06, "{took_s}");
    assert_eq!(bench.ask("$102=200\n"), "ok\r\n");
    assert_eq!(bench.ask("?").split('|').nth(1), Some("MPos:0.000,0.000,4.000")); // 800 steps
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn it_is_homed_before_the_others_and_tells_how_far_it_was_off() {
    let mut bench = Bench::new(StepperPlotterSettings { homing: true, ..settings() });
    bench.at = [500, 700, 3_000];
    bench.send("$H\n");
    bench.run_for(Duration::from_secs(1));
    assert_eq!(bench.at[..2], [500, 700]);
    assert!(bench.at[2] > 3_000 && bench.plotter.z_off_steps().is_none());
    assert_eq!(bench.ask(""), "ok\r\n");
    assert_eq!(bench.at, [88, 88, 12_000]);
    assert_eq!(bench.place(), "MPos:0.000,0.000,30.000");
    assert_eq!(bench.plotter.z_off_steps(), Some(3_000));
    // Steps that are lost are found by the next.
    bench.ask("G0 Z10\n");
    bench.at[2] -= 37;
    assert_eq!(bench.ask("$H\n"), "ok\r\n");
    assert_eq!((bench.at[2], bench.plotter.z_off_steps()), (12_000, Some(-37)));
}

#[test]
fn homing_gives_up_at_a_switch_that_is_not_right() {
    type Spoil = fn(&mut Bench);
    let cases: [(Spoil, &str, &str); 3] = [
        (|bench| bench.stuck = Some(false), "9", "did not come within 12100 steps"),
        (|bench| bench.stuck = Some(true), "8", "still pressed 800 steps off it"),
        (|bench| bench.lower = true, "9", "the lower limit switch was pressed on the way up"),
    ];
    for (spoil, alarm, text) in cases {
        let home = ZHoming { most_steps: 12_100, ..ZHoming::default() };
        let z = ZAxis { home: Some(home), ..ZAxis::default() };
        let mut bench = Bench::new(StepperPlotterSettings { homing: true, ..with_z(z) });
        spoil(&mut bench);
        let answers = bench.ask("$H\n");
        assert!(answers.starts_with(&format!("ALARM:{alarm}\r\n[MSG:axis z: ")), "{answers}");
        assert!(answers.contains(text) && answers.ends_with("error:9\r\n"), "{answers}");
        assert_eq!(bench.at[..2], [500, 500]);
    }
}

#[test]
fn its_switch_stops_the_machine() {
    let mut bench = Bench::new(settings());
    bench.at[2] = 12_000;
    let answers = bench.ask("G0 X20 Z20\n");
    assert_eq!(
        answers,
        "ok\r\nALARM:1\r\n[MSG:axis z: stopped by its upper limit switch; home the machine]\r\n"
    );
    assert_eq!(bench.at[2], LENGTHS[2]);
    assert!(bench.ask("?").contains("|Pn:Z"));
    assert_eq!(bench.plotter.z_mm(), Some(1.0));
    // Away from it is free.
    assert_eq!(bench.ask("$X\nG53 G0 Z0.5\n"), "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
    assert_eq!(bench.at[2], LENGTHS[2] - 200);
}

#[test]
fn a_jog_that_is_cancelled_and_a_reset_know_where_it_stands() {
    let mut bench = Bench::new(settings());
    bench.send("$J=X50 Z20 F600\n");
    bench.run_for(Duration::from_millis(700));
    bench.send("\u{85}".get(0..0).unwrap());
    bench.plotter.receive(bench.now, 0x85);
    assert_eq!(bench.ask(""), "ok\r\n");
    let (x, z) = (bench.at[0], bench.at[2]);
    assert!(x > 600 && z > 500 && z < 7_900, "{x} {z}");
    let place = bench.place();
    assert_eq!(bench.ask("G0\n"), "ok\r\n");
    assert_eq!(bench.place(), place);
    // From there the next line goes on.
    assert_eq!(bench.ask("G0 Z0.25\n"), "ok\r\n");
    assert_eq!(bench.at[2], 100);
    bench.send("G1 Z20 F600\n");
    bench.run_for(Duration::from_millis(900));
    let answers = bench.ask("\u{18}");
    assert!(answers.contains("ALARM:3") && answers.contains("Grbl 1.1h"), "{answers}");
    assert!(bench.at[2] > 100 && bench.at[2] < 7_900);
    bench.place();
    assert_eq!(bench.ask("$X\nG91 G0 Z1\n"), "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
}

#[test]
fn it_lifts_a_pen_at_a_standstill_of_the_others() {
    let pen = Some(ZPen { up_mm: 4.0, down_mm: 1.0 });
    let mut bench = Bench::new(with_z(ZAxis { pen, ..ZAxis::default() }));
    bench.ask("G0 X1\n");
    assert_eq!(bench.at[2], 1_600);
    bench.send("M3\nG1 X10 F600\nM5\nG0 X0\n");
    let mut low = Vec::new();
    while let Some(due) = bench.plotter.due() {
        let before = bench.at;
        bench.now = bench.now.max(due);
        while let Some(step) = bench.plotter.poll(bench.now, Drivers::Ready) {
            assert!(step.pulse.z() == 0 || (step.pulse.x() == 0 && step.pulse.y() == 0));
            bench.at[0] += i32::from(step.pulse.x());
            bench.at[2] += i32::from(step.pulse.z());
        }
        while bench.plotter.transmit(bench.now).is_some() {}
        if before[0] != bench.at[0] {
            low.push((bench.at[0] - 500, bench.at[2]));
        }
    }
    // What is drawn is drawn at the height of the pen that is down, and travelled at that of one that is up.
    let drawn: Vec<_> = low.iter().filter(|(_, z)| *z == 400).map(|(x, _)| *x).collect();
    assert_eq!((drawn.first(), drawn.last(), drawn.len()), (Some(&89), Some(&876), 788));
    assert!(low.iter().all(|(_, z)| *z == 400 || *z == 1_600));
    assert_eq!((bench.at[0], bench.at[2]), (500, 1_600));
    // Words of z do not move it then.
    bench.answers.clear();
    assert_eq!(bench.ask("G0 Z20\n"), "ok\r\n");
    assert_eq!(bench.at[2], 1_600);
}

fn with_second(offset_steps: i32) -> StepperPlotterSettings {
    let second = Some(SecondMotor { axis: Axis::Y, offset_steps, most_skew_steps: 400 });
    StepperPlotterSettings { second, homing: true, z: None, ..settings() }
}

proptest! {
    #![proptest_config(cases(48))]

    /// However the gantry is racked, both motors come to their own switches, no farther, and stand as they
    /// are to stand to each other from then on.
    #[test]
    #[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
    fn two_motors_of_an_axis_are_made_square(
        first in 0_i32..27_000,
        racked in -400_i32..400,
        lower in -20_i32..20,
        offset in -50_i32..50,
    ) {
        let mut bench = Bench::new(with_second(offset));
        bench.at[1] = first;
        let at = (first + racked).max(lower);
        bench.second = Some((at, [lower, LENGTHS[1] + 500]));
        let answers = bench.ask("$H\n");
        // The second went this much farther to its switch than the first.
        let ahead = (at - lower) - first;
        let (which, steps) = (if ahead < 0 { "first" } else { "second" }, ahead.abs());
        if steps < 400 {
            prop_assert_eq!(answers, format!("[MSG:Squared: the {which} motor was {steps} steps ahead]\r\nok\r\n"));
            prop_assert_eq!(bench.plotter.skew_steps(), Some(ahead));
            let apart = bench.second.unwrap().0 - bench.at[1];
            prop_assert_eq!(apart, lower + offset);
            // The place counts from where either switch was met last.
            let origin = bench.at[1];
            prop_assert!((88 - offset.abs()..=88 + offset.abs() + 20).contains(&origin), "{}", origin);
            bench.ask("G0 X10 Y10\nG0 Y3\n");
            prop_assert_eq!(bench.second.unwrap().0 - bench.at[1], lower + offset);
            prop_assert_eq!(bench.at[1] - origin, 263);
        }
    }
}

#[test]
fn a_gantry_that_cannot_be_made_square_is_not_bent() {
    let cases = [
        // The second motor does not turn, or its switch has no wire.
        (
            500,
            [-10_000, 30_000],
            "ALARM:9\r\n[MSG:axis y: the second motor did not come to its lower limit switch within 400 steps alone;",
        ),
        (
            -4_000,
            [-4_000, 30_000],
            "ALARM:9\r\n[MSG:axis y: the first motor did not come to its lower limit switch within 400 steps alone;",
        ),
    ];
    for (at, switches, told) in cases {
        let mut bench = Bench::new(with_second(0));
        bench.at[1] = 4_000;
        bench.second = Some((at, switches));
        let answers = bench.ask("$H\n");
        assert!(answers.starts_with(told) && answers.ends_with("error:9\r\n"), "{answers}");
        assert_eq!((bench.at[0], bench.plotter.skew_steps()), (500, None));
    }
}

#[test]
fn the_switch_of_a_second_motor_stops_the_machine() {
    let mut bench = Bench::new(with_second(0));
    bench.second = Some((500, [0, 2_000]));
    assert_eq!(bench.ask("$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    assert_eq!(
        bench.ask("G0 Y50\n"),
        "ok\r\nALARM:1\r\n[MSG:axis y: stopped by its upper limit switch; home the machine]\r\n"
    );
    assert_eq!((bench.at[1], bench.second.unwrap().0), (2_000, 2_000));
    assert!(bench.ask("?").contains("|Pn:Y"));
    assert_eq!(bench.ask("$X\nG0 Y1\n"), "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
}

#[test]
fn a_controller_with_two_axes_refuses_a_third() {
    let gate = || SafetyGate::new(LimitSwitches::RELEASED, false);
    let refused = StepperPlotter::new(settings(), gate());
    assert_eq!(refused.err(), Some(SettingsError::Planner(PlanError::Mode { quantity: "z" })));
    let refused = StepperPlotter::new(with_second(0), gate());
    assert_eq!(refused.err(), Some(SettingsError::Planner(PlanError::Mode { quantity: "second" })));
    for (z, quantity) in [
        (ZAxis { travel_mm: 0.0, ..ZAxis::default() }, "z.travel_mm"),
        (ZAxis { speed_mm_s: f64::NAN, ..ZAxis::default() }, "z.speed_mm_s"),
        (ZAxis { pen: Some(ZPen { up_mm: 31.0, down_mm: 0.0 }), ..ZAxis::default() }, "z.pen.up_mm"),
        (ZAxis { pen: Some(ZPen { up_mm: 1.0, down_mm: -1.0 }), ..ZAxis::default() }, "z.pen.down_mm"),
    ] {
        let refused = StepperPlotter::<Receive, ThreeAxes>::with_modes(with_z(z), gate()).err();
        assert!(
            matches!(refused, Some(SettingsError::Planner(PlanError::Setting { quantity: found, .. })) if found == quantity),
            "{refused:?}"
        );
    }
}

/// With three axes in the program and none told, the controller answers as one with two.
#[test]
fn a_machine_whose_third_axis_is_not_told_is_one_with_two() {
    let plain =
        StepperPlotterSettings { z: None, pen: PenConvention::Height { threshold_mm: 0.5 }, ..settings() };
    let gate = || SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut three = StepperPlotter::<Receive, ThreeAxes>::with_modes(plain, gate()).unwrap();
    let mut two = StepperPlotter::new(plain, gate()).unwrap();
    let text = "G0 X5 Z5\nG1 Z0 F600\nG1 X20 Y5\nG2 X30 I5 J0\nG0 Z5\n$$\n$#\nG0 X0\n?$132=3\n$J=Z5 F100\n";
    let mut now = Duration::ZERO;
    for byte in text.bytes() {
        three.receive(now, byte);
        two.receive(now, byte);
        loop {
            let steps = (
                three.poll(now, Drivers::Ready).map(|step| step.pulse.x()),
                two.poll(now, Drivers::Ready).map(|step| step.pulse.x()),
            );
            assert_eq!(steps.0, steps.1);
            if steps.0.is_none() {
                let bytes = (three.transmit(now), two.transmit(now));
                assert_eq!(bytes.0, bytes.1);
                if bytes.0.is_some() {
                    continue;
                }
                assert_eq!((three.due(), three.pen_deg()), (two.due(), two.pen_deg()));
                match two.due() {
                    Some(due) if byte == b'\n' => now = now.max(due),
                    _ => break,
                }
            }
        }
    }
    assert_eq!(three.position(), two.position());
}
