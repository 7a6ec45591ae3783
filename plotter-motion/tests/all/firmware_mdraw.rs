//! Whole conversations with mDraw, the host program of Makeblock's XY plotter, byte for byte.
//!
//! "The original" is that plotter's own firmware. The module `firmware::stepper_plotter` describes the
//! protocol.

use crate::stepper_bench;

use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{Activity, StepperPlotterSettings, StoredSettings};
use plotter_motion::{Axis, Direction, StepPoint};
use stepper_bench::Bench;

/// A conversation as text: `>` what mDraw sends, `<` the answer, `-` the state afterwards: the position in
/// steps and the servo's angle in degrees.
fn conversation(bench: &mut Bench, lines: &[&str]) -> String {
    let mut text = String::new();
    for line in lines {
        let answers = bench.ask(line);
        text += &format!("> {}\n", line.escape_debug());
        for answer in answers.split_inclusive('\n') {
            text += &format!("< {}\n", answer.escape_debug());
        }
        let (at, pen_deg) = (bench.plotter.position(), bench.plotter.pen_deg());
        text += &format!("- {} {} steps, servo {pen_deg}\n", at.x, at.y);
    }
    text
}

fn new_bench() -> Bench {
    Bench::new(StepperPlotterSettings::default())
}

#[test]
fn moves_report_their_distance() {
    insta::assert_snapshot!(conversation(
        &mut new_bench(),
        &[
            "G1 X10.00 Y5.00\n",
            "G0 X10.00 Y5.00\n",    // nothing to do: 0.00 even so
            "G1 X10.0005 Y5\n",     // less than 0.001 mm
            "G1 X13 A200\n",        // y stays
            "G1 Y9 Z3 F600 A0\r\n", // Z, F and CR are ignored
            "G1\n",                 // to where it is
            "P\n",
        ]
    ));
}

#[test]
fn g91_makes_coordinates_relative() {
    let mut bench = new_bench();
    let answers = ["G1 X10 Y5\n", "G91\n", "G1 X2.5\n", "G1 X-1 Y3\n", "P\n", "G90\n", "G1 X1\n", "P\n"]
        .map(|line| bench.ask(line));
    assert_eq!(answers[1], "OK\r\n");
    assert_eq!(answers[2], "distance=2.50\r\nOK\r\n");
    assert_eq!(answers[4], "POS X11.50 Y8.00\r\nOK\r\n");
    assert_eq!(answers[7], "POS X1.00 Y8.00\r\nOK\r\n");
    // A target outside is refused in relative coordinates too, and the pen stays.
    bench.ask("G91\n");
    assert!(bench.ask("G1 X-1.5\n").starts_with("error: "));
    assert_eq!(bench.ask("P\n"), answers[7]);
}

#[test]
fn pen_laser_delay_and_stored_settings_are_answered_by_ok_alone() {
    insta::assert_snapshot!(conversation(
        &mut new_bench(),
        &[
            "M1 90\n",
            "M1 160\n",
            "M2 U130 D20\n",
            "M3 2000\n",
            "M4 128\n",
            "M4 0.0\n",
            "M5 A1 B1 H300 W350 S50\n",
            "M10\n",
        ]
    ));
}

#[test]
fn reports_have_the_format_that_mdraw_reads() {
    let mut bench = new_bench();
    bench.ask("G1 X123.456 Y7.125\n");
    insta::assert_snapshot!(conversation(&mut bench, &["M10\n", "M11\n", "P\n"]));
}

#[test]
fn m11_reports_y_max_y_min_x_max_x_min_and_1_is_open() {
    let mut bench = new_bench();
    bench.switches = false;
    let mut text = String::new();
    for (axis, end) in [
        (Axis::Y, Direction::Plus),
        (Axis::Y, Direction::Minus),
        (Axis::X, Direction::Plus),
        (Axis::X, Direction::Minus),
    ] {
        bench.plotter.limit_switch(bench.now, axis, end, true);
        text += &bench.ask("M11\n");
        bench.plotter.limit_switch(bench.now, axis, end, false);
    }
    assert_eq!(text, "M11 0 1 1 1\r\nOK\r\nM11 1 0 1 1\r\nOK\r\nM11 1 1 0 1\r\nOK\r\nM11 1 1 1 0\r\nOK\r\n");
}

#[test]
fn unknown_and_malformed_lines_are_answered_by_one_ok() {
    insta::assert_snapshot!(conversation(
        &mut new_bench(),
        &[
            "\n",
            "\r\n",
            "G90\n",
            "G91\n",
            "G92 X0 Y0\n",
            "G20\n",
            "G21\n",
            "G2 X1 Y1 I1\n",
            "G4 P100\n",
            "M99\n",
            "g1 X10\n",
            "hello\n",
            "G1X10\n",
            "Gx\n",
            "M\n",
            "\u{fffd}\n",
        ]
    ));
}

#[test]
fn lines_the_original_firmware_misreads_are_refused_and_nothing_moves() {
    let mut bench = new_bench();
    bench.ask("G1 X1 Y1\n");
    let long = format!("G1 X10 Y10 {}\n", "A0 ".repeat(20));
    insta::assert_snapshot!(conversation(
        &mut bench,
        &[
            &long,             // longer than 64 bytes: the original's buffer wraps
            "G1 X380.01 Y1\n", // beyond the area
            "G1 X-0.01\n",
            "G1 X99999999999999999999999999999999999999999 Y1\n",
            "G1 X Y5\n", // no number: the original's `atof` reads 0
            "M1\n",
            "M1 181\n",
            "M4 256\n",
            "M4 -1\n",
            "M2 U200\n",
            "M5 S100\n",
            "M5 W0\n",
            "M3\n",
            "P\n",
            "M10\n",
        ]
    ));
    assert_eq!(bench.plotter.position(), StepPoint::new(88, 88));
}

/// The original counts steps in 16 bits, which overflow beyond 32,767 / 87.58 = 374.14 mm. Ours do not.
#[test]
fn the_whole_width_is_reached() {
    let mut bench = new_bench();
    assert_eq!(bench.ask("G1 X380 Y0\n"), "distance=380.00\r\nOK\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(33_280, 0)); // 380 * 87.58 = 33,280.4
}

#[test]
fn a_line_sent_before_the_answer_is_refused_and_the_move_is_finished() {
    let mut bench = new_bench();
    bench.send("G1 X50 Y0\n");
    bench.run_for(Duration::from_millis(500));
    bench.send("G1 X0 Y50\nP\n");
    assert_eq!(bench.take_answers(), "distance=50.00\r\n");
    bench.run_out();
    let early = "error: sent before the line before it was answered: left out\r\nOK\r\n";
    assert_eq!(bench.take_answers(), format!("OK\r\n{early}{early}"));
    assert_eq!(bench.plotter.position(), StepPoint::new(4379, 0));
}

#[test]
fn ok_comes_when_the_move_is_complete() {
    let mut bench = new_bench();
    bench.send("G1 X20 Y0\n");
    bench.run_out();
    let last = bench.made.last().unwrap().at;
    assert_eq!(bench.plotter.position(), StepPoint::new(1752, 0));
    assert_eq!(bench.take_answers(), "distance=20.00\r\nOK\r\n");
    assert!(bench.now >= last && bench.now < last + Duration::from_millis(50));
}

#[test]
fn the_motors_wait_until_the_pen_has_settled_and_m1_is_answered_before() {
    let mut bench = new_bench();
    bench.send("M1 90\n");
    assert_eq!(bench.take_answers(), "OK\r\n");
    assert_eq!(bench.plotter.pen_deg(), 90);
    bench.send("G1 X1 Y0\n");
    bench.run_out();
    assert!(bench.made[0].at >= Duration::from_millis(200), "{:?}", bench.made[0].at);
    // mDraw waits by itself, too: the controller does not wait a second time.
    bench.send("M1 160\n");
    bench.run_for(Duration::from_millis(200));
    let (began, count) = (bench.now, bench.made.len());
    bench.ask("G1 X2 Y0\n");
    assert!(bench.made[count].at < began + Duration::from_millis(10));
}

#[test]
fn the_delay_of_a_step_slows_it_down() {
    let seconds = |delay: &str| {
        let mut bench = new_bench();
        bench.ask(delay);
        let began = bench.now;
        bench.ask("G1 X100 Y0\n");
        (bench.now - began).as_secs_f64()
    };
    let (fast, slow) = (seconds("M3 0\n"), seconds("M3 1800\n"));
    // 200 us and 2000 us a step: 8758 steps take 1.8 s and 17.5 s, and the ramps
    assert!((fast - 1.98).abs() < 0.05, "{fast}");
    assert!((slow - 17.5).abs() < 0.1, "{slow}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn homing_finds_the_origin_with_the_pen_up() {
    let mut bench = new_bench();
    bench.carriage = [7_000, 12_345];
    let text = conversation(&mut bench, &["M1 90\n", "M3 500\n", "G28\n", "P\n", "M1 90\n", "G1 X1 Y0\n"]);
    assert_eq!(bench.carriage, [88 + 88, 88]); // 88 steps, a millimetre, off the switches, and the 88 of `G1 X1`
    insta::assert_snapshot!(text);
}

#[test]
fn homing_that_fails_says_why() {
    let mut bench = new_bench();
    bench.switches = false;
    insta::assert_snapshot!(conversation(&mut bench, &["G28\n", "G1 X1 Y1\n"]));
}

#[test]
fn an_emergency_stop_ends_the_line_and_refuses_the_next_until_it_is_reset() {
    let mut bench = new_bench();
    bench.ask("M1 90\n");
    bench.send("G1 X100 Y50\n");
    bench.run_for(Duration::from_millis(1_000));
    let before = bench.made.len();
    bench.stop_button(true);
    let mut text = bench.take_answers();
    assert_eq!(bench.plotter.pen_deg(), 160);
    bench.run_out();
    assert_eq!(bench.made.len(), before);
    text += &bench.ask("P\n");
    text += &bench.ask("G1 X0 Y0\n");
    bench.stop_button(false);
    text += &bench.ask("M1 90\n");
    assert!(bench.plotter.reset_emergency_stop(bench.now));
    text += &bench.ask("G1 X0 Y0\n");
    insta::assert_snapshot!(text);
    assert_eq!(bench.plotter.position(), StepPoint::new(0, 0));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn an_emergency_stop_while_homing_ends_it() {
    let mut bench = new_bench();
    bench.send("G28\n");
    bench.run_for(Duration::from_millis(100));
    bench.stop_button(true);
    assert_eq!(bench.take_answers(), "error: emergency stop: release the button, then reset\r\nOK\r\n");
    assert_eq!(bench.plotter.status(bench.now).activity, Activity::Stopped);
    bench.stop_button(false);
    bench.plotter.restart(bench.now);
    assert_eq!(bench.ask("G28\n"), "OK\r\n");
}

#[test]
fn a_limit_switch_ends_the_move_and_away_from_it_is_free() {
    let mut bench = new_bench();
    bench.length = [2_000, 28_000];
    let text = conversation(&mut bench, &["G1 X100 Y3\n", "P\n", "G1 X101 Y0\n", "G1 X0 Y0\n", "G28\n"]);
    insta::assert_snapshot!(text);
}

#[test]
fn stored_settings_take_effect_when_the_port_is_opened_again() {
    let mut bench = new_bench();
    bench.ask("M5 A1 B0 H200 W300 S50\n");
    bench.ask("M2 U130 D20\n");
    assert_eq!(bench.ask("G1 X310 Y0\n"), "distance=310.00\r\nOK\r\n", "not yet");
    bench.ask("G1 X10 Y0\n");
    bench.plotter.restart(bench.now);
    let expected = StoredSettings {
        width_mm: 300,
        height_mm: 200,
        x_direction: 1,
        y_direction: 0,
        speed_percent: 50,
        pen_up_deg: 130,
        pen_down_deg: 20,
    };
    assert_eq!(bench.plotter.stored(), expected);
    assert_eq!(bench.plotter.pen_deg(), 130);
    assert_eq!(bench.ask("P\n"), "POS X10.00 Y0.00\r\nOK\r\n", "what is known of the place is kept");
    assert_eq!(
        bench.ask("G1 X310 Y0\n"),
        "error: (310.00, 0.00) mm lies outside (0, 0)..=(300, 200) mm: left out\r\nOK\r\n"
    );
    let began = bench.now;
    bench.ask("G1 X110 Y0\n");
    let seconds = (bench.now - began).as_secs_f64();
    assert!((seconds - 4.5).abs() < 0.1, "8758 steps of 500 us: {seconds}");
}

#[test]
fn laser_power_follows_speed_and_is_off_at_rest() {
    let mut bench = Bench::new(StepperPlotterSettings { laser: true, ..Default::default() });
    bench.ask("G1 X10 Y10\nM4 255\n"); // M4 is sent before the move was answered, so it is refused
    bench.ask("M4 255\n");
    assert_eq!(bench.plotter.beam().power(), 0, "off at standstill");
    let count = bench.made.len();
    assert!(bench.made.iter().all(|made| made.laser == 0));
    bench.ask("G1 X60 Y10\n");
    let burnt = &bench.made[count..];
    let (starting, cruising) = (burnt[10].laser, burnt[2_000].laser);
    assert!(starting < cruising && cruising > 0xFE00, "nearly full power: {:?}", burnt[2_000]);
    assert_eq!(bench.plotter.beam().power(), 0);
    // mDraw's stop button sends M4 0 without waiting for the answer.
    bench.send("G1 X10 Y10\n");
    bench.run_for(Duration::from_millis(400));
    assert!(bench.plotter.beam().power() > 0);
    bench.send("M4 0\n");
    assert_eq!(bench.plotter.beam().power(), 0);
    let count = bench.made.len();
    bench.run_out();
    assert!(bench.made.len() > count + 1_000 && bench.made[count..].iter().all(|made| made.laser == 0));
}

#[test]
fn a_line_with_a_damaged_byte_is_refused_and_the_next_one_is_drawn() {
    // X1 and X12 are both good lines: the controller must not guess the damaged byte.
    insta::assert_snapshot!(conversation(&mut new_bench(), &["G1 X1\u{1a}2 Y5\n", "G1 X12 Y5\n"]), @r"
    > G1 X1\u{1a}2 Y5\n
    < error: a byte of this line came broken: left out\r\n
    < OK\r\n
    - 0 0 steps, servo 160
    > G1 X12 Y5\n
    < distance=13.00\r\n
    < OK\r\n
    - 1051 438 steps, servo 160
    ");
}
