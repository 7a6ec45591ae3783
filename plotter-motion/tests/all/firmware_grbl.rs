//! Whole conversations with programs that stream G-code to Grbl.

use crate::stepper_bench;

use core::time::Duration;
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Dialect, Grbl, SpindlePen, StartupLines, StepperPlotterSettings, StoredSettings,
};
use plotter_motion::gcode::PenConvention;
use plotter_motion::homing::Homed;
use plotter_motion::{Axis, Direction, LimitSwitches, Point, SafetyGate, StepPoint, planner::ExactPen};
use stepper_bench::Bench;

fn settings() -> StepperPlotterSettings {
    StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() }
}

/// A machine that has been greeted.
fn bench() -> Bench {
    let mut bench = Bench::new(settings());
    assert_eq!(bench.ask(""), "\r\nGrbl 1.1h ['$' for help]\r\n");
    bench
}

/// One that homes, and so begins locked; it has been unlocked.
fn homing_bench() -> Bench {
    let mut bench = Bench::new(StepperPlotterSettings { homing: true, ..settings() });
    assert_eq!(bench.ask(""), "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    assert_eq!(bench.ask("G0 X1\n"), "error:9\r\n");
    assert!(bench.ask("?").starts_with("<Alarm|"));
    assert_eq!(bench.ask("$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    bench
}

/// `>` what is sent, `<` what is answered when nothing more happens.
fn conversation(bench: &mut Bench, lines: &[&str]) -> String {
    let mut text = String::new();
    for line in lines {
        let answers = bench.ask(line);
        text += &format!("> {}\n", line.escape_debug());
        for answer in answers.split_inclusive('\n') {
            text += &format!("< {}\n", answer.trim_end_matches("\r\n"));
        }
    }
    text
}

#[test]
fn questions_are_answered_as_programs_expect() {
    insta::assert_snapshot!(conversation(
        &mut bench(),
        &[
            "$\n",
            "$I\n",
            "$$\n",
            "$#\n",
            "$G\n",
            "$N\n",
            "?",
            "?",
            "\n",
            "\r\n",
            "(comment)\n",
            "$J\n",
            "$5=1\n"
        ]
    ));
}

#[test]
fn each_line_has_its_answer_and_each_error_its_number() {
    insta::assert_snapshot!(conversation(
        &mut bench(),
        &[
            "G21 G90\n",
            "G1 X10\n", // no feed: 22
            "G1 X10 F1200\n",
            "g1x20y5 (lower case)\n",
            "10\n",   // no letter: 1
            "G1 X\n", // no number: 2
            "G1 X1.2.3\n",
            "$Q\n",        // unknown: 3
            "G1 X1 F-5\n", // below 0: 4
            "G1 X1 F0\n",
            "G17 G38.2 X1\n", // not supported: 20
            "M77\n",
            "G0 G1 X1\n",     // one group: 21
            "M3.5\n",         // whole number: 23
            "G92 G1 X1\n",    // both need X: 24
            "G1 X1 X2\n",     // twice: 25
            "G4\n",           // lacks P: 28
            "G80 X1\n",       // X without a motion: 31
            "G2 X30 Y5 I2\n", // not a circle: 33
            "G2 X30 Y5 R1\n", // radius: 34
            "G2 X30 Y5\n",    // centre: 35
            "G1 X1 R5\n",     // R unused: 36
            "G1 X22 (much in the comment does not count, as long as nobody asks for it to be kept anyway)\n",
            "G1 X10.000000000000000000000000000000000000000000 Y10.000000000000000000000000000000\n", // 82 characters
            "?",
        ]
    ));
}

#[test]
fn soft_limits_are_an_alarm_and_what_was_accepted_is_drawn() {
    let mut bench = bench();
    let text = conversation(
        &mut bench,
        &[
            "M3\nG1 X50 Y10 F6000\nG1 X400\nG1 X0\n",
            "?",
            "$X\n",
            "G3 X80 Y10 I15\n", // an arc that leaves the area between its ends
            "$X\n",
            "F6000\nG1 X60\nM5\n",
            "?",
        ],
    );
    assert_eq!(bench.plotter.pen_deg(), 160);
    insta::assert_snapshot!(text);
}

#[test]
fn flat_arcs_leave_the_area_where_they_do() {
    let stored = |width_mm, height_mm| StoredSettings { width_mm, height_mm, ..StoredSettings::default() };
    let small = stored(300, 200);
    // The area, where the arc begins, the arc, and whether it stays within.
    for (stored, begin, arc, stays) in [
        // 0.022 mm.
        (small, "M3\nG1 X0 Y199.996 F60000\n", "G2 X296.394 Y199.996 I148.1970 J-416660.671\n", false),
        // 0.013 mm.
        (small, "M3\nG1 X0 Y199.968 F60000\n", "G2 X286.118 Y199.968 I143.0590 J-532655.666\n", true),
        (small, "M3\nG1 X299.996 Y0 F60000\n", "G3 X299.996 Y196 I-416660.671 J98\n", false), // 0.008 mm
        (small, "M3\nG1 X0.02 Y0 F60000\n", "G2 X0.02 Y196 I416660.671 J98\n", true),         // 0.008 mm
    ] {
        let mut bench = Bench::new(StepperPlotterSettings { stored, ..settings() });
        bench.ask("");
        bench.send(begin);
        bench.run_out();
        assert_eq!(bench.take_answers(), "ok\r\n".repeat(2));
        let answer = bench.ask(arc);
        assert_eq!(answer, if stays { "ok\r\n" } else { "ALARM:2\r\nerror:33\r\n" }, "{arc}");
    }
}

#[test]
fn the_pen_follows_m3_and_m5_and_waits() {
    let mut bench = bench();
    bench.send("G0 X5\nM3 S90\nG1 Y5 F3000\nM5\n");
    bench.run_out();
    assert_eq!(bench.take_answers(), "ok\r\n".repeat(4));
    assert_eq!(bench.plotter.pen_deg(), 160);
    let first_down = bench.made.iter().position(|made| made.pen_deg == 90).unwrap();
    assert_eq!(first_down, 438); // 5 mm up to there
    let pause = bench.made[first_down].at - bench.made[first_down - 1].at;
    assert!(pause >= Duration::from_millis(200) && pause < Duration::from_millis(220), "{pause:?}");
}

#[test]
fn hold_brakes_on_the_path_and_resume_goes_on() {
    let mut bench = bench();
    bench.send("G1 X100 F6000\n");
    bench.run_for(Duration::from_millis(900));
    bench.send("!?");
    let braking = bench.take_answers();
    bench.run_for(Duration::from_secs(2));
    let stands = bench.plotter.position();
    bench.send("?");
    bench.run_for(Duration::from_secs(5));
    let held = bench.take_answers();
    assert_eq!(bench.plotter.position(), stands);
    bench.send("~");
    bench.run_out();
    assert!(braking.contains("<Hold:1|"), "{braking}");
    assert!(held.contains("<Hold:0|") && held.contains("FS:0,0"), "{held}");
    assert_eq!(bench.plotter.position(), StepPoint::new(8758, 0));
    // A machine that rests is held too, and lines wait.
    assert_eq!(bench.ask("!G1 X90\n"), "ok\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(8758, 0));
    bench.ask("~");
    assert_eq!(bench.plotter.position(), StepPoint::new(7882, 0));
}

#[test]
fn m0_waits_for_resume_and_is_answered_then() {
    let mut bench = bench();
    assert_eq!(bench.ask("G1 X5 F600\nM0\nG1 X10\n"), "ok\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(438, 0));
    assert_eq!(bench.ask("~"), "ok\r\nok\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(876, 0));
}

#[test]
fn reset_stops_at_once_and_keeps_the_place() {
    let mut bench = bench();
    assert_eq!(bench.ask("\u{18}"), "\r\nGrbl 1.1h ['$' for help]\r\n", "at rest there is no alarm");
    bench.send("G91\nM3\nG1 X50 F3000\nG1 Y50\n");
    bench.run_for(Duration::from_millis(1_000));
    let (count, at) = (bench.made.len(), bench.plotter.position());
    bench.take_answers();
    bench.send("G1 X1\u{18}");
    assert_eq!(bench.plotter.pen_deg(), 160);
    bench.run_out();
    assert_eq!(bench.made.len(), count);
    insta::assert_snapshot!(conversation(&mut bench, &["", "?", "G1 X1 F600\n", "$X\n", "$G\n"]));
    assert_eq!(bench.plotter.position(), at);
}

#[test]
fn an_emergency_stop_is_an_alarm_until_the_button_is_released_and_x_is_sent() {
    let mut bench = homing_bench();
    bench.send("G1 X50 F3000\nG1 Y50\n$$\n");
    bench.run_for(Duration::from_millis(700));
    let mut text = bench.take_answers();
    let count = bench.made.len();
    bench.stop_button(true);
    text += &bench.take_answers();
    text += &conversation(&mut bench, &["G1 X0 F600\n", "$X\n", "$H\n", "?", "\u{18}", "$X\n"]);
    bench.stop_button(false);
    text += &conversation(&mut bench, &["?", "G1 X0 F600\n"]);
    assert_eq!(bench.made.len(), count);
    text += &conversation(&mut bench, &["$X\n", "G1 X0 Y0 F3000\n"]);
    insta::assert_snapshot!(text);
    assert_eq!(bench.plotter.position(), StepPoint::new(0, 0));
}

#[test]
fn a_limit_switch_is_an_alarm_and_away_from_it_is_free() {
    let mut bench = homing_bench();
    bench.length = [2_000, 28_000];
    let text = conversation(&mut bench, &["G0 X100 Y10\nG0 X0\n", "?", "$X\nG0 X10\n", "?", "$H\n", "?"]);
    insta::assert_snapshot!(text);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn homing_is_answered_when_it_is_done() {
    let mut bench = homing_bench();
    bench.carriage = [5_000, 6_000];
    bench.send("$H\n?");
    assert!(bench.take_answers().starts_with("<Home|MPos:0.000,0.000,0.000|"));
    bench.send("G0 X1\n");
    bench.run_out();
    assert_eq!(bench.take_answers(), "ok\r\nok\r\n");
    assert_eq!(bench.carriage, [88 + 88, 88]);
    bench.switches = false;
    bench.plotter.limit_switch(bench.now, Axis::X, Direction::Minus, true);
    bench.plotter.limit_switch(bench.now, Axis::X, Direction::Plus, true);
    insta::assert_snapshot!(conversation(&mut bench, &["$H\n", "G0 X2\n"]));
}

#[test]
fn an_offset_by_g92_is_told_and_a_stream_of_short_lines_runs_through() {
    let mut bench = bench();
    bench.ask("G0 X10 Y10\nG92 X0 Y0\n");
    bench.ask("?");
    for _ in 0..10 {
        bench.ask("?");
    }
    let status = bench.ask("?");
    assert_eq!(status, "<Idle|MPos:10.002,10.002,0.000|Bf:15,128|FS:0,0|WCO:10.000,10.000,0.000>\r\n");
    // 200 lines of 0.5 mm at 50 mm/s: 2 s, not 200 starts
    let began = bench.now;
    let mut sent = 0;
    let mut owed = 0;
    while sent < 200 || owed > 0 {
        while sent < 200 && owed < 6 {
            sent += 1;
            owed += 1;
            bench.send(&format!("G1 X{:.2} F3000\n", f64::from(sent) * 0.5));
        }
        bench.run_for(Duration::from_millis(1));
        owed -= bench.take_answers().matches("ok").count();
    }
    bench.run_out();
    let seconds = (bench.now - began).as_secs_f64();
    assert!(seconds < 2.5, "{seconds}");
    assert!(bench.plotter.position_mm().distance(Point::new(110.0, 10.0)) < 0.02);
}

#[test]
fn the_button_zero_of_a_sender_sets_the_origin_and_is_told_at_once() {
    let mut bench = bench();
    bench.ask("G0 X10 Y20\n??");
    assert_eq!(bench.ask("G10 P0 L20 X0 Y0 Z0\n"), "ok\r\n");
    // 10 mm are 875.8 steps, and 876 steps 10.002 mm.
    assert_eq!(
        bench.ask("?"),
        "<Idle|MPos:10.002,20.005,0.000|Bf:15,128|FS:0,0|WCO:10.000,20.000,0.000>\r\n"
    );
    bench.ask("G0 X5\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(1314, 1752));
    // A reset ends the offset of G92 and keeps that of G10.
    bench.ask("G92 X0\n");
    let offsets = |bench: &mut Bench| {
        let told = bench.ask("$#\n");
        told.lines()
            .filter(|line| line.starts_with("[G54") || line.starts_with("[G92"))
            .map(str::to_owned)
            .collect()
    };
    let before: Vec<String> = offsets(&mut bench);
    assert_eq!(before, ["[G54:10.000,20.000,0.000]", "[G92:5.000,0.000,0.000]"]);
    bench.ask("\u{18}");
    let after: Vec<String> = offsets(&mut bench);
    assert_eq!(after, ["[G54:10.000,20.000,0.000]", "[G92:0.000,0.000,0.000]"]);
}

#[test]
fn a_feed_next_to_nothing_still_moves() {
    let mut bench = bench();
    bench.send("M3\nG1 X1 F0.0000001\n");
    bench.run_for(Duration::from_secs(700));
    assert_eq!(bench.take_answers(), "ok\r\nok\r\n");
    let steps = bench.plotter.position().x;
    assert!((60..=62).contains(&steps), "0.7 mm of 87.58 steps: {steps}");
}

#[test]
fn a_jog_moves_the_raised_pen_and_changes_nothing_else() {
    let mut bench = bench();
    insta::assert_snapshot!(conversation(
        &mut bench,
        &[
            "$J=G91 X10 F600\n",
            "$J=G91 X10 Y5 F600\n",
            "?",
            "$J=G90 X-1 F600\n",
            "$J=X1\n",
            "$J=G2 X1 F100\n",
            "$G\n",
            "G0 X1\n",
        ]
    ));
    assert_eq!(bench.plotter.position(), StepPoint::new(88, 438));
}

#[test]
fn a_laser_burns_while_it_moves_and_not_in_g0() {
    let mut bench = Bench::new(StepperPlotterSettings { laser: true, ..settings() });
    bench.ask("");
    bench.ask("M4 S500 F3000\nG0 X10\n");
    assert!(bench.made.iter().all(|made| made.laser == 0));
    let count = bench.made.len();
    bench.ask("G1 X60\nM5\n");
    let strongest = bench.made[count..].iter().map(|made| made.laser).max().unwrap();
    assert!(strongest.abs_diff(0x8000) < 0x100, "{strongest:04x}");
    assert_eq!(bench.plotter.beam().power(), 0);
    bench.send("M4 S1000\nG1 X10\n");
    bench.run_for(Duration::from_millis(300));
    assert!(bench.plotter.beam().power() > 0);
    bench.stop_button(true);
    assert_eq!(bench.plotter.beam().power(), 0);
}

#[test]
fn a_line_with_a_broken_byte_is_refused_and_the_next_one_is_drawn() {
    let lines = ["G1 X1\u{1a}2 F600\n", "(\u{1a}) G1 X3 F600\n", "G1 X4 F600\n"];
    insta::assert_snapshot!(conversation(&mut bench(), &lines), @r"
    > G1 X1\u{1a}2 F600\n
    < error:11
    > (\u{1a}) G1 X3 F600\n
    < error:11
    > G1 X4 F600\n
    < ok
    ");
}

/// What a firmware has kept is carried out at each start, as `$N` tells it.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn startup_lines_are_carried_out_once_the_machine_may_move() {
    let lines = StartupLines::new(["G1X2F6000", "G55"]).unwrap();
    let mut bench = Bench::new(settings());
    bench.plotter.set_startup_lines(&lines);
    let hello = "\r\nGrbl 1.1h ['$' for help]\r\n>G1X2F6000:ok\r\n>G55:ok\r\n";
    assert_eq!(bench.ask(""), hello);
    assert_eq!(bench.plotter.position(), StepPoint::new(175, 0), "2 mm of 87.58 steps");
    assert_eq!(bench.ask("\x18"), hello);
    assert_eq!(bench.plotter.startup_lines(), lines);
    bench.plotter.restart(bench.now);
    assert_eq!(bench.ask(""), hello, "the port has been opened anew");

    // One that homes: not before it has, and then before `$H` is answered.
    let mut bench = Bench::new(StepperPlotterSettings { homing: true, ..settings() });
    bench.plotter.set_startup_lines(&lines);
    assert_eq!(bench.ask(""), "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
    assert_eq!(
        bench.ask("$H\n$G\n"),
        ">G1X2F6000:ok\r\n>G55:ok\r\nok\r\n[GC:G1 G55 G17 G21 G90 G94 M5 M9 T0 F6000 S0]\r\nok\r\n"
    );
    // Locked, it looks at a line and does not move.
    let mut bench = Bench::new(StepperPlotterSettings { homing: true, ..settings() });
    let _ = bench.ask("");
    let asked = bench.ask("$N0=G0X5\n$N1=G99\n$N\n$X\n$G\n");
    assert_eq!(
        asked,
        "ok\r\nerror:20\r\n$N0=G0X5\r\n$N1=\r\nok\r\n[MSG:Caution: Unlocked]\r\nok\r\n\
         [GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]\r\nok\r\n"
    );
    assert_eq!(bench.plotter.position(), StepPoint::new(0, 0));

    // What leads out of the area is an alarm, and the next line is not carried out.
    let mut bench = Bench::new(settings());
    bench.plotter.set_startup_lines(&StartupLines::new(["G0X999", "G0X5"]).unwrap());
    assert_eq!(bench.ask(""), "\r\nGrbl 1.1h ['$' for help]\r\nALARM:2\r\n>G0X999:error:33\r\n");
    assert_eq!(bench.ask("G0X1\n"), "error:9\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(0, 0));
}

#[test]
fn settings_are_restored_on_both_sides_and_the_place_stays() {
    let mut bench = bench();
    assert_eq!(bench.ask("G0 X10\n"), "ok\r\n");
    for line in ["$100=100\n", "$130=50\n", "$22=1\n", "$27=3\n", "$120=77\n"] {
        assert_eq!(bench.ask(line), "ok\r\n", "{line}");
    }
    assert_ne!(bench.plotter.settings(), settings());
    let steps = bench.plotter.position();
    assert_eq!(bench.ask("$RST=$\n"), "[MSG:Restoring defaults]\r\nok\r\n\r\nGrbl 1.1h ['$' for help]\r\n");
    assert_eq!(bench.plotter.settings(), settings());
    assert_eq!(bench.plotter.position(), steps);
    assert_eq!(bench.ask("G0 X100\n"), "ok\r\n", "the area is the old one");
    assert_eq!(bench.plotter.position(), StepPoint::new(8758, 0), "and so are the steps to the millimetre");
}

/// Seen from above an arc that stands on the sheet is a line to its end; a tool's length is added to a
/// height.
#[test]
fn arcs_that_stand_on_the_sheet_are_lines_there_and_a_length_is_added_to_a_height() {
    let pen = PenConvention::Height { threshold_mm: 0.0 };
    let mut bench = Bench::new(StepperPlotterSettings { pen, ..settings() });
    let _ = bench.ask("");
    let down = bench.plotter.settings().stored.pen_down_deg;
    let drawn = |bench: &mut Bench, lines: &[&str]| {
        bench.made.clear();
        for line in lines {
            assert_eq!(bench.ask(&format!("{line}\n")), "ok\r\n", "{line}");
        }
        let marks: Vec<_> = bench.made.iter().filter(|made| made.pen_deg == down).collect();
        (marks.len(), bench.plotter.position())
    };
    // Down into the sheet in the air, then 8 mm on it, and up again.
    let eased =
        drawn(&mut bench, &["G0 Z5", "G18 G2 X5 Z0 I5 K0 F6000", "G1 X13", "G3 X18 Z5 I0 K5", "G17 G0 X20"]);
    assert_eq!(eased, (1139 - 438, StepPoint::new(1752, 0)), "from 5 to 13 mm");
    // A pen that is one millimetre longer does not reach the sheet at 0, but at -1.
    let longer = drawn(&mut bench, &["G0 X0 Z5", "G43.1 Z1", "G1 Z0 F6000", "G1 X10", "G0 Z5"]);
    assert_eq!(longer.0, 0);
    let reached = drawn(&mut bench, &["G1 Z-1", "G1 X0", "G0 Z5", "G49"]);
    assert_eq!(reached, (876, StepPoint::new(0, 0)));
    let without = drawn(&mut bench, &["G1 Z0", "G1 X10", "G0 Z5"]);
    assert_eq!(without.0, 876);
}

/// A small program leaves them out, and says so by the number of what is not there.
#[test]
fn a_small_grbl_names_what_it_leaves_out() {
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let mut small = StepperPlotter::<Grbl<SpindlePen>, ExactPen>::with_modes(settings(), gate).unwrap();
    let mut said = String::new();
    for line in ["$I", "G18", "G43.1 Z1", "G49", "$N0=G55", "$N0=", "$N", "$RST=$", "$RST=*", "$RST=#"] {
        for byte in line.bytes().chain([b'\n']) {
            small.receive(Duration::ZERO, byte);
            while let Some(byte) = small.transmit(Duration::ZERO) {
                said.push(byte.into());
            }
        }
    }
    let said: Vec<_> = said.lines().filter(|line| !line.is_empty()).collect();
    assert_eq!(
        said.join("|"),
        "Grbl 1.1h ['$' for help]|[VER:1.1h.20190830:plotter-motion]|[OPT:VZT*$IEW,15,128]|ok|error:20|error:20|ok|error:3|ok|\
         $N0=|$N1=|ok|error:3|error:3|[MSG:Restoring defaults]|ok|Grbl 1.1h ['$' for help]"
    );
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn homing_warns_of_an_axis_that_is_not_as_it_was_said_to_be() {
    let mut bench = homing_bench();
    assert_eq!((bench.plotter.homed(), bench.plotter.off_steps()), (None, None));
    assert_eq!(bench.ask("$H\n"), "ok\r\n");
    let homed = Homed { x_steps: 34_000, y_steps: 28_000 };
    assert_eq!((bench.plotter.homed(), bench.plotter.off_steps()), (Some(homed), None));
    // The motors lose steps, which the next homing finds; the axes are as long as before.
    bench.ask("G0 X50 Y50\n");
    (bench.carriage[0], bench.carriage[1]) = (bench.carriage[0] - 12, bench.carriage[1] + 5);
    assert_eq!(bench.ask("$H\n"), "ok\r\n");
    assert_eq!(bench.plotter.off_steps(), Some(StepPoint::new(-12, 5)));
    // Half a millimetre is 43.8 steps.
    bench.length = [34_040, 27_900];
    assert_eq!(bench.ask("$H\n"), "[MSG:Warning: y is 27900 steps long, was 28000]\r\nok\r\n");
    // Something lies on the rails of x: (27088 - 88) / 87.58 mm can be reached of 380.
    bench.length = [27_088, 27_900];
    assert_eq!(bench.ask("$H\n"), "[MSG:Warning: x is 27088 steps long, was 34040]\r\nok\r\n");
    assert_eq!(bench.ask("$H\n"), "[MSG:Warning: x reaches 308.290 mm, $130=380]\r\nok\r\n");
    assert_eq!(bench.ask("$130=308\n$H\n"), "ok\r\nok\r\n");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_an_earlier_homing_has_measured_is_kept_by_the_firmware() {
    let homed = Homed { x_steps: 33_900, y_steps: 28_020 };
    let mut bench = homing_bench();
    bench.plotter.set_homed(Homed::from_bytes(&homed.to_bytes()).unwrap());
    assert_eq!(bench.plotter.homed(), Some(homed));
    assert_eq!(bench.ask("$H\n"), "[MSG:Warning: x is 34000 steps long, was 33900]\r\nok\r\n");
    for at in 0..Homed::BYTES {
        let mut bytes = homed.to_bytes();
        bytes[at] ^= 0x10;
        assert_eq!(Homed::from_bytes(&bytes), None, "byte {at}");
        assert_eq!(Homed::from_bytes(&homed.to_bytes()[..at]), None);
    }
}
