//! What a person does while a stepper plotter draws for a program that streams to Grbl: other speeds, jogs,
//! settings. And the play of its axes.

use crate::stepper_bench;

use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Activity, Dialect, Drivers, Grbl, Host, SpindlePen, StepperPlotterSettings,
};
use plotter_motion::kinematics::Backlash;
use plotter_motion::{
    LimitSwitches, Point, SafetyGate, StepPoint,
    planner::{ExactOnly, ExactPen, Modes},
    toolpath::from_mm,
};
use stepper_bench::Bench;

const STEPS_PER_MM: f64 = 87.58;
const JOG_CANCEL: u8 = 0x85;
const FEED_100: u8 = 0x90;
const FEED_MORE_10: u8 = 0x91;
const FEED_LESS_10: u8 = 0x92;
const RAPID_25: u8 = 0x97;
const LASER_LESS_10: u8 = 0x9B;

fn settings() -> StepperPlotterSettings {
    StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() }
}

fn bench_with(settings: StepperPlotterSettings) -> Bench {
    let mut bench = Bench::new(settings);
    bench.ask("");
    bench
}

/// Pulses of x in the next `ms`, as a speed in mm/s.
fn speed_mm_s(bench: &mut Bench, ms: u32) -> f64 {
    let before = bench.plotter.position_mm();
    bench.run_for(Duration::from_millis(ms.into()));
    bench.plotter.position_mm().distance(before) * 1e3 / f64::from(ms)
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 0.01 * expected, "{found} instead of {expected}");
}

#[test]
fn feeds_are_overridden_on_the_way_and_told() {
    let mut bench = bench_with(settings());
    bench.send("M3\nG1 X300 F2400\n");
    bench.run_for(Duration::from_millis(1_500));
    assert_near(speed_mm_s(&mut bench, 200), 40.0);
    bench.send_bytes(&[FEED_LESS_10; 5]);
    bench.run_for(Duration::from_millis(200));
    assert_near(speed_mm_s(&mut bench, 200), 20.0);
    bench.send_bytes(&[FEED_MORE_10; 7]);
    bench.run_for(Duration::from_millis(300));
    assert_near(speed_mm_s(&mut bench, 200), 48.0);
    bench.take_answers();
    bench.send("??");
    let told = bench.take_answers();
    assert!(told.contains("|Ov:120,100,100>"), "{told}");
    bench.send_bytes(&[FEED_100]);
    bench.run_for(Duration::from_millis(200));
    assert_near(speed_mm_s(&mut bench, 200), 40.0);
    // The machine's own limit is one whatever is asked for: 91.3 mm/s.
    bench.run_out();
    bench.send("G1 X10 F5000\n");
    bench.send_bytes(&[FEED_MORE_10; 15]);
    bench.run_for(Duration::from_millis(1_500));
    assert_near(speed_mm_s(&mut bench, 100), 8_000.0 / STEPS_PER_MM);
    bench.run_out();
    assert_eq!(bench.plotter.position(), StepPoint::new(876, 0));
}

#[test]
fn travels_have_a_share_of_their_own() {
    let mut bench = bench_with(settings());
    bench.send_bytes(&[RAPID_25]);
    bench.send("G0 X300\n");
    bench.run_for(Duration::from_millis(1_000));
    assert_near(speed_mm_s(&mut bench, 200), 0.25 * 8_000.0 / STEPS_PER_MM);
    // A reset ends all overrides.
    bench.send("\u{18}$X\nG0 X0\n");
    bench.run_for(Duration::from_millis(300));
    assert!(speed_mm_s(&mut bench, 50) > 50.0);
}

#[test]
fn a_laser_has_a_share_of_its_power() {
    let mut bench = bench_with(StepperPlotterSettings { laser: true, ..settings() });
    bench.send("M4 S1000\nG1 X100 F2400\n");
    bench.run_for(Duration::from_millis(700));
    let full = bench.plotter.beam().power();
    bench.send_bytes(&[LASER_LESS_10; 4]);
    bench.run_for(Duration::from_millis(10));
    let less = bench.plotter.beam().power();
    assert!((f64::from(less) - 0.6 * f64::from(full)).abs() < 2.0, "{less} of {full}");
}

#[test]
fn a_hold_and_overrides_end_at_rest_and_the_path_goes_on() {
    for jerk_mm_s3 in [None, Some(20_000.0)] {
        let mut machine = settings();
        machine.planner.jerk_mm_s3 = jerk_mm_s3;
        let mut bench = bench_with(machine);
        bench.send("M3\nG1 X200 F4800\n");
        bench.run_for(Duration::from_millis(1_000));
        bench.send("!");
        bench.send_bytes(&[FEED_LESS_10; 8]);
        bench.run_for(Duration::from_secs(2));
        let stands = bench.plotter.position();
        bench.send_bytes(&[FEED_MORE_10; 3]);
        bench.run_for(Duration::from_secs(2));
        assert_eq!(bench.plotter.position(), stands, "{jerk_mm_s3:?}");
        assert_eq!(bench.plotter.status(bench.now).activity, Activity::Hold { stands: true });
        bench.send("~");
        bench.run_for(Duration::from_millis(500));
        assert_near(speed_mm_s(&mut bench, 200), 40.0);
        bench.run_out();
        assert_eq!(bench.plotter.position().x, from_mm(200.0, STEPS_PER_MM));
    }
}

#[test]
fn a_jog_has_its_own_speed_and_is_told_as_one() {
    let mut bench = bench_with(settings());
    bench.send_bytes(&[RAPID_25, FEED_LESS_10]);
    bench.send("$J=G91 X50 F1200\n");
    bench.run_for(Duration::from_millis(500));
    assert_near(speed_mm_s(&mut bench, 200), 20.0);
    bench.take_answers();
    bench.send("?");
    assert!(bench.take_answers().starts_with("<Jog|"), "no override changes a jog");
    bench.run_out();
    bench.send("?");
    assert!(bench.take_answers().starts_with("<Idle|"));
    assert_eq!(bench.plotter.position().x, from_mm(50.0, STEPS_PER_MM));
    // F in inches a minute, and no faster than travels
    bench.send("$J=G20 G90 X1 F60\n");
    bench.run_for(Duration::from_millis(500));
    assert_near(speed_mm_s(&mut bench, 200), 25.4);
    bench.run_out();
    bench.send("$J=G90 X300 F99999\n");
    bench.run_for(Duration::from_millis(1_500));
    assert_near(speed_mm_s(&mut bench, 200), 8_000.0 / STEPS_PER_MM);
}

#[test]
fn a_jog_is_cancelled_on_its_path_and_all_that_wait_are_forgotten() {
    for cancel in [JOG_CANCEL, b'!'] {
        let mut bench = bench_with(settings());
        bench.send("$J=G91 X30 Y10 F3000\n$J=G91 X30 F3000\n$J=G91 Y30 F3000\n");
        bench.run_for(Duration::from_millis(400));
        assert_eq!(bench.take_answers(), "ok\r\n".repeat(3));
        assert_eq!(bench.ask("").len(), 0, "nothing more is said");
        let mut bench = bench_with(settings());
        bench.send("$J=G91 X30 Y10 F3000\n$J=G91 X30 F3000\n$J=G91 Y30 F3000\n");
        bench.run_for(Duration::from_millis(400));
        bench.take_answers();
        bench.send_bytes(&[cancel]);
        bench.send("G1 X1 F100\n");
        bench.run_out();
        // Lines of G-code are locked out while it brakes.
        assert_eq!(bench.take_answers(), "error:9\r\n");
        let at = bench.plotter.position_mm();
        assert!(
            at.x > 5.0 && at.x < 29.0 && (at.y - at.x / 3.0).abs() < 0.02,
            "{at:?} on the way to (30, 10)"
        );
        assert_eq!(bench.plotter.status(bench.now).activity, Activity::Stopped);
        // From where it stands, exactly.
        let steps = bench.plotter.position();
        assert_eq!(bench.ask("$J=G91 X1 F600\nG1 X2 F600\n"), "ok\r\nerror:9\r\n");
        assert_eq!(bench.plotter.position().y, steps.y);
        assert!((bench.plotter.position_mm().x - at.x - 1.0).abs() <= 1.0 / STEPS_PER_MM);
        assert_eq!(bench.ask("G1 X7 Y8 F3000\n"), "ok\r\n");
        assert_eq!(bench.plotter.position(), StepPoint::new(613, 701));
    }
}

#[test]
fn a_cancel_touches_nothing_but_jogs_and_a_jog_waits_for_rest() {
    let mut bench = bench_with(settings());
    bench.send("G1 X20 F3000\n");
    bench.run_for(Duration::from_millis(200));
    bench.send_bytes(&[JOG_CANCEL]);
    bench.send("$J=X5 F600\n");
    bench.run_out();
    assert_eq!(bench.take_answers(), "ok\r\nerror:8\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(1_752, 0));
    // A cancelled jog that has not begun: nothing moves.
    bench.send("$J=X5 F600\n");
    bench.send_bytes(&[JOG_CANCEL]);
    bench.run_out();
    assert_eq!(bench.plotter.position(), StepPoint::new(1_752, 0));
    assert_eq!(bench.ask("G1 X10 F3000\n"), "ok\r\nok\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(876, 0));
}

#[test]
fn settings_are_changed_at_rest_within_their_ranges() {
    let mut bench = bench_with(settings());
    let answers = |bench: &mut Bench, lines: &[&str]| {
        lines
            .iter()
            .map(|line| format!("{line} {}", bench.ask(&format!("{line}\n")).trim()))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        answers(
            &mut bench,
            &[
                "$110=3000",
                "$111=2400.5",
                "$120=500",
                "$11=0.02",
                "$130=200.9",
                "$131=100",
                "$100=100",
                "$101=50",
                "$27=2",
                "$3=2",
                "$0=10",
                "$0=11",
                "$5=1",
                "$32=1",
                "$110=-1",
                "$110=0",
                "$110=99999999",
                "$100=1000000",
                "$110=500000",
                "$130=70000",
                "$3=1.5",
                "$110=fast",
                "$110=",
                "$110",
                "$999=1",
                "$1x=2",
                "$110=1e3"
            ]
        ),
        [
            "$110=3000 ok",
            "$111=2400.5 ok",
            "$120=500 ok",
            "$11=0.02 ok",
            "$130=200.9 ok",
            "$131=100 ok",
            "$100=100 ok",
            "$101=50 ok",
            "$27=2 ok",
            "$3=2 ok",
            "$0=10 ok",
            "$0=11 error:3",
            "$5=1 error:3",
            "$32=1 error:3",
            "$110=-1 error:4",
            "$110=0 error:52",
            "$110=99999999 error:52",
            "$100=1000000 error:52",
            "$110=500000 error:12",
            "$130=70000 error:52",
            "$3=1.5 error:52",
            "$110=fast error:2",
            "$110= error:2",
            "$110 error:3",
            "$999=1 error:3",
            "$1x=2 error:3",
            "$110=1e3 error:2",
        ]
    );
    let listing = bench.ask("$$\n");
    for line in
        ["$3=2", "$11=0.020", "$27=2.000", "$100=100.000", "$101=50.000", "$110=2400.500", "$111=2400.500"]
    {
        assert!(listing.contains(&format!("{line}\r\n")), "{line} in {listing}");
    }
    for line in ["$120=500.000", "$121=500.000", "$130=200.000", "$131=100.000"] {
        assert!(listing.contains(&format!("{line}\r\n")), "{line} in {listing}");
    }
    // They hold: for the scale, the area and the speed.
    assert_eq!(
        bench.ask("G1 X20 Y10 F99999\nG1 X201\n$X\n"),
        "ok\r\nALARM:2\r\nerror:33\r\n[MSG:Caution: Unlocked]\r\nok\r\n"
    );
    assert_eq!(bench.plotter.position(), StepPoint::new(2_000, 500));
    bench.send("G1 X190 F99999\n");
    bench.run_for(Duration::from_millis(1_000));
    assert_near(speed_mm_s(&mut bench, 200), 2400.5 / 60.0);
    assert_eq!(bench.ask("$110=3000\n"), "ok\r\nerror:8\r\n", "not while it moves");
    // To be kept.
    let kept = bench.plotter.settings();
    assert_eq!((kept.stored.width_mm, kept.stored.y_direction, kept.x_steps_per_mm), (200, 1, 100.0));
}

#[test]
fn all_settings_that_are_listed_can_be_sent_back() {
    let mut bench = bench_with(settings());
    let listing = bench.ask("$$\n");
    let lines: Vec<&str> = listing.lines().filter(|line| line.starts_with('$')).collect();
    assert_eq!(lines.len(), 34);
    for line in &lines {
        assert_eq!(bench.ask(&format!("{line}\n")), "ok\r\n", "{line}");
    }
    assert_eq!(bench.ask("$$\n"), listing);
}

#[test]
fn another_scale_leaves_the_motors_where_they_are() {
    let mut bench = bench_with(settings());
    bench.ask("G1 X100 F5000\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(8_758, 0));
    bench.ask("$100=175.16\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(8_758, 0));
    assert!((bench.plotter.position_mm().x - 50.0).abs() < 1e-9);
    bench.ask("G91\nG1 X1 F1000\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(8_933, 0));
}

const PLAY: Backlash = Backlash { x_steps: 20, y_steps: 13 };

/// Carriages that stand while their motor crosses the gap, driven backwards last.
struct Gaps {
    gap: [i32; 2],
    motors: StepPoint,
}

impl Gaps {
    const fn new() -> Self {
        Self { gap: [0; 2], motors: StepPoint { x: 0, y: 0 } }
    }

    /// Where the carriages are after the motors have come here.
    fn carriage(&mut self, motors: StepPoint) -> StepPoint {
        let ways = [motors.x - self.motors.x, motors.y - self.motors.y];
        let play = [i32::from(PLAY.x_steps), i32::from(PLAY.y_steps)];
        for ((gap, way), play) in self.gap.iter_mut().zip(ways).zip(play) {
            *gap = (*gap + way).clamp(0, play);
        }
        self.motors = motors;
        StepPoint::new(motors.x - self.gap[0], motors.y - self.gap[1])
    }
}

#[test]
fn play_is_taken_up_where_an_axis_turns_round() {
    let mut bench = bench_with(StepperPlotterSettings { backlash: PLAY, ..settings() });
    let mut gaps = Gaps::new();
    let at_mm = |at: StepPoint| Point::new(f64::from(at.x) / STEPS_PER_MM, f64::from(at.y) / STEPS_PER_MM);
    for (x, y) in [(30.0, 20.0), (10.0, 20.0), (10.0, 40.0), (30.0, 5.0), (0.0, 0.0), (12.0, 7.0)] {
        let began = bench.made.len();
        bench.ask(&format!("G1 X{x} Y{y} F3000\n"));
        let carriages: Vec<StepPoint> =
            bench.made[began..].iter().map(|made| gaps.carriage(made.position)).collect();
        let end = *carriages.last().unwrap_or(&StepPoint::default());
        assert_eq!(end, StepPoint::new(from_mm(x, STEPS_PER_MM), from_mm(y, STEPS_PER_MM)));
        assert_eq!(bench.plotter.position_mm(), at_mm(end), "it knows the carriage, not the motor");
    }
}

#[test]
fn a_stop_within_the_play_loses_no_place() {
    for after_ms in (40..120).step_by(7) {
        let mut bench = bench_with(StepperPlotterSettings { backlash: PLAY, ..settings() });
        bench.ask("G1 X30 Y20 F3000\n");
        bench.send("G1 X10 Y10\n");
        bench.run_for(Duration::from_millis(after_ms));
        bench.send("\u{18}");
        bench.run_out();
        bench.send("$X\nG1 X12 Y34 F3000\n");
        bench.run_out();
        let mut gaps = Gaps::new();
        let carriages: Vec<StepPoint> = bench.made.iter().map(|made| gaps.carriage(made.position)).collect();
        let end = StepPoint::new(from_mm(12.0, STEPS_PER_MM), from_mm(34.0, STEPS_PER_MM));
        assert_eq!(carriages.last(), Some(&end), "stopped after {after_ms} ms");
    }
}

#[test]
fn a_small_controller_overrides_the_laser_alone_and_tells_so() {
    let mut small = StepperPlotter::<Grbl<SpindlePen>, ExactOnly>::with_modes(
        settings(),
        SafetyGate::new(LimitSwitches::RELEASED, false),
    )
    .unwrap_or_else(|error| unreachable!("{error}"));
    for byte in [FEED_LESS_10, LASER_LESS_10, b'?', b'?'] {
        small.receive(Duration::ZERO, byte);
        while small.transmit(Duration::ZERO).is_some() {}
    }
    let percents = small.status(Duration::ZERO).percents;
    assert_eq!((percents.draw, percents.travel, percents.laser), (100, 100, 90));
}

#[test]
fn a_small_controller_has_no_laser_and_says_so() {
    let machine = StepperPlotterSettings { laser: true, ..settings() };
    let small = StepperPlotter::<Grbl<SpindlePen>, ExactOnly>::with_modes(
        machine,
        SafetyGate::new(LimitSwitches::RELEASED, false),
    );
    let error = small.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.starts_with("the pen is lifted by Laser") && error.ends_with("Grbl<AnyPen>"), "{error}");
}

#[test]
fn a_small_controller_has_no_play_and_says_so() {
    let machine = StepperPlotterSettings { backlash: PLAY, ..settings() };
    let small = StepperPlotter::<Grbl<SpindlePen>, ExactOnly>::with_modes(
        machine,
        SafetyGate::new(LimitSwitches::RELEASED, false),
    );
    let error = small.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.starts_with("backlash"), "{error}");
}

#[test]
fn a_controller_of_exact_pens_has_no_laser_whatever_its_words_and_says_so() {
    let machine = StepperPlotterSettings { laser: true, ..settings() };
    let small = StepperPlotter::<Grbl, ExactPen>::with_modes(
        machine,
        SafetyGate::new(LimitSwitches::RELEASED, false),
    );
    let error = small.err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.starts_with("laser") && error.contains("AllModes"), "{error}");
    assert!(
        StepperPlotter::<Grbl, ExactOnly>::with_modes(
            machine,
            SafetyGate::new(LimitSwitches::RELEASED, false)
        )
        .is_ok()
    );
}

/// All steps of a text, with a hold after so many of them.
fn steps_of<H: Host, M: Modes>(text: &str, hold_after: usize) -> Vec<(Duration, [i8; 2])> {
    let mut plotter =
        StepperPlotter::<H, M>::with_modes(settings(), SafetyGate::new(LimitSwitches::RELEASED, false))
            .unwrap_or_else(|error| unreachable!("{error}"));
    let (mut now, mut made) = (Duration::ZERO, Vec::new());
    for byte in text.bytes() {
        plotter.receive(now, byte);
        while plotter.transmit(now).is_some() {}
    }
    loop {
        while let Some(step) = plotter.poll(now, Drivers::Ready) {
            made.push((step.at, [step.pulse.x(), step.pulse.y()]));
            if made.len() == hold_after {
                plotter.receive(now, b'!');
            }
        }
        while plotter.transmit(now).is_some() {}
        match plotter.due() {
            Some(due) => now = due,
            None if matches!(plotter.status(now).activity, Activity::Hold { .. }) => {
                plotter.receive(now, b'~')
            }
            None => return made,
        }
    }
}

#[test]
fn a_small_controller_makes_the_steps_of_a_great_one() {
    let text = "M3\nG1X20F3000\nG2X30Y10I0J10\nX20Y0R10\nM5\nG0X0Y5\nM3\nG1X1\nX2Y6\nX40\nM5\n";
    for hold_after in [0, 500, 1_700, 3_000] {
        let small = steps_of::<Grbl<SpindlePen>, ExactPen>(text, hold_after);
        assert!(small.len() > 5_000, "{}", small.len());
        assert_eq!(
            small,
            steps_of::<Grbl, plotter_motion::planner::AllModes>(text, hold_after),
            "{hold_after}"
        );
    }
}
