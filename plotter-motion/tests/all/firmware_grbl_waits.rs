//! What a program that streams to Grbl counts on: how much may be sent ahead, and which answers come when the
//! motion is over.

use crate::stepper_bench;

use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::gcode::{PenConvention, ServoCommand};
use plotter_motion::{Machine, MachineConfig, StepPoint, config::PenLift};
use std::collections::VecDeque;
use stepper_bench::Bench;

/// Grbl's receive buffer, bytes.
const RX_BYTES: usize = 128;

fn settings() -> StepperPlotterSettings {
    StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() }
}

/// A machine that has been greeted.
fn bench() -> Bench {
    let mut bench = Bench::new(settings());
    bench.ask("");
    bench
}

/// What is answered to a line before any time passes.
fn at_once(bench: &mut Bench, line: &str) -> String {
    bench.send(line);
    bench.take_answers()
}

/// Sends slow lines until one is not answered, which then waits for the planner; gives how many were.
fn fill(bench: &mut Bench) -> usize {
    bench.ask("G90 G21\nM3\nG1 X10 Y10 F60\n");
    let mut count = 0;
    while at_once(bench, &format!("G1 X{}.000 Y10.0000\n", 20 + count % 2)) == "ok\r\n" {
        count += 1;
        assert!(count < 100, "a planner takes no end of lines");
    }
    count
}

#[test]
fn the_line_that_waits_for_the_planner_has_left_the_receive_buffer() {
    let mut bench = bench();
    let count = fill(&mut bench);
    assert!(count >= 15, "{count}");
    assert!(at_once(&mut bench, "?").contains("|Bf:0,128|"), "the line that waits takes no room");
    // 140 bytes with that line: six more of 20.
    for index in 0..6 {
        assert_eq!(at_once(&mut bench, &format!("G1 X{}.000 Y20.0000\n", 20 + index % 2)), "");
    }
    assert!(at_once(&mut bench, "?").contains("|Bf:0,8|"));
    bench.run_out();
    assert_eq!(bench.take_answers(), "ok\r\n".repeat(7));
    assert_eq!(bench.plotter.position(), StepPoint::new(1_839, 1_752)); // (21, 20) mm
}

#[test]
fn all_of_the_receive_buffer_may_be_sent_behind_the_line_that_waits() {
    let mut bench = bench();
    fill(&mut bench);
    // 128 bytes: seven of 18, and an empty one with a comment.
    for index in 0..7 {
        bench.send(&format!("G1 X{}.00 Y20.000\n", 20 + index % 2));
    }
    bench.send(";\n");
    assert!(at_once(&mut bench, "?").contains("|Bf:0,0|"));
    bench.run_out();
    assert_eq!(bench.take_answers(), "ok\r\n".repeat(9));
    assert_eq!(bench.plotter.position(), StepPoint::new(1_752, 1_752));
}

#[test]
fn a_question_is_answered_at_once_while_the_planner_is_full() {
    let count = fill(&mut bench());
    // As many lines as are answered, and none that waits: the next byte begins a line.
    let mut bench = bench();
    bench.ask("G90 G21\nM3\nG1 X10 Y10 F60\n");
    for index in 0..count {
        assert_eq!(at_once(&mut bench, &format!("G1 X{}.000 Y10.0000\n", 20 + index % 2)), "ok\r\n");
    }
    let modes = at_once(&mut bench, "$G\n");
    assert!(modes.starts_with("[GC:G1 ") && modes.ends_with("]\r\nok\r\n"), "{modes:?}");
    // What was answered takes no room: 128 bytes behind the line that waits are there as before.
    assert_eq!(at_once(&mut bench, "G1 X30.000 Y10.0000\n"), "");
    assert!(at_once(&mut bench, "?").contains("|Bf:0,128|"));
    // A question behind it has its turn after it, as all lines have.
    assert_eq!(at_once(&mut bench, "$G\n"), "");
    bench.run_out();
    let answers = bench.take_answers();
    assert!(answers.starts_with("ok\r\n[GC:G1 ") && answers.ends_with("ok\r\n"), "{answers}");
    assert_eq!(bench.plotter.position(), StepPoint::new(2_627, 876)); // (30, 10) mm
}

#[test]
fn a_line_that_finds_no_room_is_answered_in_its_turn_and_not_drawn_in_part() {
    let mut bench = bench();
    fill(&mut bench);
    for index in 0..10 {
        assert_eq!(at_once(&mut bench, &format!("G1 X{}.000 Y20.0000\n", 30 + index)), "");
    }
    bench.run_out();
    let answers = bench.take_answers();
    assert_eq!(answers, "ok\r\n".repeat(7) + &"error:11\r\n".repeat(4), "the seventh is cut after 8 bytes");
    assert_eq!(bench.plotter.position(), StepPoint::new(3_065, 1_752)); // (35, 20) mm
    assert_eq!(bench.ask("G1 X36 F600\n"), "ok\r\n");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_sender_that_counts_a_line_too_many_loses_none() {
    let mut bench = bench();
    bench.ask("M3\nG1 X10 Y10 F6000\n");
    let lines: Vec<String> =
        (0..478).map(|n| format!("G1 X{}.{:03} Y{}.000\n", 10 + n % 7, n, 10 + n % 11)).collect();
    let mut lines = lines.iter();
    // It believes that the line before the first of these has been answered, too.
    let (mut owed, mut one_more, mut answers) = (VecDeque::<usize>::new(), false, 0);
    for ms in 0..200_000 {
        let mut counted = owed.iter().skip(usize::from(one_more)).sum::<usize>();
        while let Some(line) = lines.clone().next().filter(|line| counted + line.len() <= RX_BYTES) {
            lines.next();
            (counted, _) = (counted + line.len(), owed.push_back(line.len()));
            bench.send(line);
        }
        // A person pauses and goes on.
        match ms {
            3_000 => bench.send("!"),
            5_000 => (one_more, _) = (true, bench.send("~")),
            _ => {}
        }
        bench.run_for(Duration::from_millis(1));
        for answer in bench.take_answers().lines() {
            assert_eq!(answer, "ok");
            owed.pop_front();
            answers += 1;
        }
        if answers == 478 {
            break;
        }
    }
    bench.run_out();
    assert_eq!(answers, 478);
    assert_eq!(bench.plotter.position(), StepPoint::new(1_005, 1_226)); // (11.477, 14) mm
}

#[test]
fn bf_tells_the_blocks_that_are_not_over() {
    let mut bench = bench();
    bench.send("G1 X10 F600\n");
    bench.run_for(Duration::from_millis(300));
    bench.take_answers();
    assert!(at_once(&mut bench, "?").contains("<Run|") && at_once(&mut bench, "?").contains("|Bf:14,128|"));
    bench.send("G1 X20\nG1 X10\n");
    bench.take_answers();
    assert!(at_once(&mut bench, "?").contains("|Bf:12,128|"));
    bench.run_out();
    bench.take_answers();
    assert!(at_once(&mut bench, "?").contains("<Idle|") && at_once(&mut bench, "?").contains("|Bf:15,128|"));
}

#[test]
fn a_dwell_is_answered_when_all_before_and_the_dwell_are_over() {
    let mut bench = bench();
    let begins = bench.now;
    assert_eq!(at_once(&mut bench, "G0 X100\n"), "ok\r\n");
    assert_eq!(at_once(&mut bench, "G4 P0.5\n"), "");
    bench.run_for(Duration::from_millis(500));
    assert_eq!(bench.take_answers(), "", "it is on its way");
    while bench.take_answers().is_empty() {
        bench.run_for(Duration::from_millis(1));
        assert!(bench.now - begins < Duration::from_secs(10));
    }
    assert_eq!(bench.plotter.position(), StepPoint::new(8_758, 0));
    let stood = bench.now - bench.made[bench.made.len() - 1].at;
    assert!(stood >= Duration::from_millis(500) && stood < Duration::from_millis(560), "{stood:?}");
    // A dwell of no time only waits.
    assert_eq!(at_once(&mut bench, "G4 P0\n"), "ok\r\n");
}

#[test]
fn a_dwell_after_the_pen_was_moved_is_answered_when_it_has_settled() {
    let mut bench = bench();
    for (command, deg) in [("M3", 90), ("M5", 160), ("M3", 90), ("M5", 160)] {
        assert_eq!(at_once(&mut bench, &format!("{command}\nG4 P0.1\n")), "ok\r\n", "{command}");
        bench.run_for(Duration::from_millis(190));
        assert_eq!((bench.take_answers().as_str(), bench.plotter.pen_deg()), ("", deg), "{command}");
        bench.run_for(Duration::from_millis(20));
        assert_eq!(bench.take_answers(), "ok\r\n", "{command}");
        bench.ask("G1 X5 F3000\n");
    }
    // The pen has not been put down twice.
    bench.ask("M3\nG4 P0.1\n");
    let before = bench.now;
    bench.ask("G1 X0 F3000\n");
    let first = bench.made.iter().find(|made| made.at > before).map(|made| made.at - before);
    assert!(first.is_some_and(|waits| waits < Duration::from_millis(70)), "{first:?}");
}

#[test]
fn what_has_waited_behind_a_dwell_starts_with_its_answer() {
    let mut bench = bench();
    bench.send("G4 P0.3\nG1 X10 F3000\nG1 X20\n");
    bench.run_out();
    assert_eq!(bench.take_answers(), "ok\r\n".repeat(3));
    let first = bench.made[0].at;
    assert!(first < Duration::from_millis(330), "{first:?}: no time to gather what is there");
}

#[test]
fn the_end_of_a_program_is_told_when_all_is_over() {
    for end in ["M2\n", "M30\n"] {
        let mut bench = bench();
        bench.send("M3\nG1 X20 F3000\n");
        bench.take_answers();
        assert_eq!(at_once(&mut bench, end), "");
        bench.run_for(Duration::from_millis(300));
        assert_eq!(bench.take_answers(), "");
        bench.run_out();
        assert_eq!(bench.take_answers(), "[MSG:Pgm End]\r\nok\r\n");
        assert_eq!((bench.plotter.position(), bench.plotter.pen_deg()), (StepPoint::new(1_752, 0), 160));
    }
}

#[test]
fn the_end_of_a_program_ends_overrides_and_chooses_g54() {
    let mut bench = bench();
    bench.send_bytes(&[0x91, 0x91, 0x97, 0x9A]);
    bench.ask("G55\nG91\n??");
    bench.ask("M30\n");
    assert!(bench.ask("??").contains("|Ov:100,100,100>"));
    assert!(bench.ask("$G\n").contains("[GC:G1 G54 G17 G21 G90 G94 M5 M9 "));
}

#[test]
fn a_hold_puts_off_the_answer_to_a_dwell_and_a_reset_forgets_it() {
    let mut bench = bench();
    bench.send("G1 X20 F3000\nG4 P0.1\n");
    bench.run_for(Duration::from_millis(200));
    bench.take_answers();
    bench.send("!");
    bench.run_for(Duration::from_secs(1));
    assert!(bench.ask("?").starts_with("<Hold:0|"));
    assert_eq!(bench.ask("~"), "ok\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(1_752, 0));
    bench.send("G1 X0\nG4 P0.1\nG1 X50\n");
    bench.run_for(Duration::from_millis(200));
    bench.take_answers();
    let stopped = bench.ask("\u{18}");
    assert!(stopped.starts_with("ALARM:3\r\n") && !stopped.contains("ok") && !stopped.contains("error"));
    assert_eq!(bench.ask("$X\nG4 P0\n"), "[MSG:Caution: Unlocked]\r\nok\r\nok\r\n");
}

#[test]
fn an_optional_stop_is_none() {
    let mut bench = bench();
    assert_eq!(bench.ask("M1\nG1 X1 F600\nM01\n"), "ok\r\n".repeat(3));
    assert_eq!(bench.plotter.position(), StepPoint::new(88, 0));
}

#[test]
fn each_coordinate_system_has_its_origin_and_is_told() {
    let mut bench = bench();
    bench.ask("G0 X10 Y20\n");
    assert_eq!(bench.ask("G10 L2 P2 X30 Y5\nG55\n"), "ok\r\n".repeat(2));
    assert!(bench.ask("$G\n").starts_with("[GC:G0 G55 "));
    assert!(bench.ask("?").contains("|WCO:30.000,5.000,0.000>"));
    bench.ask("G0 X1 Y1\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(2_715, 525)); // (31, 6) mm
    // Here is (2, 2) of G59, whichever is in force; then (0, 0) of the one in force by G92.
    bench.ask("G10 L20 P6 X2 Y2\nG92 X0 Y0\nG59\nG0 X1 Y0\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(2_715, 438)); // (29, 4) + (1, 1) + (1, 0) mm
    let told = bench.ask("$#\n");
    for line in ["[G54:0.000,0.000,0.000]", "[G55:30.000,5.000,0.000]", "[G59:29.000,4.000,0.000]"] {
        assert!(told.contains(line), "{line} in {told}");
    }
    assert!(told.contains("[G92:1.000,1.000,0.000]"), "{told}");
    bench.ask("\u{18}$X\n");
    assert!(bench.ask("$G\n").contains(" G54 ") && bench.ask("$#\n").contains("[G55:30.000,5.000,0.000]"));
    assert_eq!(bench.ask("G10 L2 P7 X0\n"), "error:29\r\n");
}

#[test]
fn what_the_spindle_was_told_is_told() {
    let mut bench = bench();
    bench.ask("M3 S500\n");
    assert!(bench.ask("$G\n").contains(" M3 M9 T0 F0 S500]"));
    bench.ask("M5\n");
    assert!(bench.ask("$G\n").contains(" M5 M9 T0 F0 S500]"));
}

#[test]
fn words_of_other_firmwares_are_errors_unless_they_lift_the_pen() {
    let mut bench = bench();
    for (line, answer) in [
        ("M7", "error:20"),
        ("M8", "ok"),
        ("M9", "ok"),
        ("G4 P0 Q3", "error:20"),
        ("N-1 G90", "error:4"),
        ("N1 G90", "ok"),
        ("M280 P0 S60", "error:20"),
        ("M115", "error:20"),
        ("M105", "error:20"),
        ("G0 H1", "error:20"),
        ("G0 D1", "error:20"),
        ("G0 O1", "error:20"),
        ("G64", "error:20"),
        ("G61", "ok"),
        ("G40 G49 G80 G94", "ok"),
        ("S-1", "error:4"),
    ] {
        assert_eq!(bench.ask(&format!("{line}\n")).trim_end(), answer, "{line}");
    }
    let pen = PenConvention::Servo { command: ServoCommand::M280, up: 20.0, down: 60.0 };
    let mut marlin = Bench::new(StepperPlotterSettings { pen, ..settings() });
    marlin.ask("");
    assert_eq!(marlin.ask("M280 P0 S60\nM84\nG1 X1 F600\n"), "ok\r\n".repeat(3));
    assert_eq!(marlin.plotter.pen_deg(), 90);
}

#[test]
fn an_unlock_of_what_is_not_locked_and_an_empty_line_for_the_start_are_no_errors() {
    let mut bench = bench();
    assert_eq!(bench.ask("$N0=\n$N1=\n"), "ok\r\n".repeat(2));
    assert_eq!(bench.ask("$N0=G21\n$N2=\n"), "ok\r\nerror:3\r\n");
    bench.send("G1 X10 F600\n");
    bench.run_for(Duration::from_millis(200));
    assert_eq!(bench.ask("$X\n$N\n"), "ok\r\nok\r\nerror:8\r\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(876, 0));
}

#[test]
fn who_checks_moves_nothing_and_who_sleeps_takes_nothing() {
    let mut bench = bench();
    bench.ask("G0 X10 Y10\n");
    let (at, made) = (bench.plotter.position(), bench.made.len());
    assert_eq!(bench.ask("$C\n"), "[MSG:Enabled]\r\nok\r\n");
    assert!(bench.ask("?").starts_with("<Check|"));
    assert_eq!(
        bench.ask("G1 X50 F1000\nG1 X5 R1\nM3 S10\nM2\n"),
        "ok\r\nerror:36\r\nok\r\n[MSG:Pgm End]\r\nok\r\n"
    );
    // What lies outside is told, and nothing moves for it.
    assert_eq!(bench.ask("G0 X1000\nG0 X10 Y10\n"), "error:33\r\nok\r\n");
    assert!(bench.ask("?").starts_with("<Check|") && bench.made.len() == made);
    let greeting = "\r\nGrbl 1.1h ['$' for help]\r\n";
    assert_eq!(bench.ask("$C\n"), format!("[MSG:Disabled]\r\nok\r\n{greeting}"));
    assert_eq!((bench.plotter.position(), bench.made.len()), (at, made));
    // And the next line begins where the machine stands.
    bench.ask("G91 G0 X1\n");
    assert_eq!(bench.plotter.position().x, 964); // 1 mm from 876 steps
    bench.ask("G90 M3\nG1 X20 F1000\n");
    assert_eq!(bench.ask("$SLP\n"), "ok\r\n[MSG:Sleeping]\r\n");
    assert_eq!(bench.plotter.pen_deg(), 160);
    let made = bench.made.len();
    assert_eq!(bench.ask("G0 X0\n"), "");
    assert!(bench.ask("?").starts_with("<Sleep|"));
    assert_eq!(bench.ask("\u{18}"), format!("{greeting}[MSG:'$H'|'$X' to unlock]\r\n"));
    assert_eq!(bench.ask("G0 X0\n"), "error:9\r\n");
    assert_eq!(bench.made.len(), made);
    assert!(bench.ask("$X\nG0 X0\n").ends_with("ok\r\nok\r\n"));
    assert_eq!(bench.plotter.position().x, 0);
}

#[test]
fn an_emergency_stop_ends_checking() {
    let mut bench = bench();
    bench.ask("$C\n");
    bench.stop_button(true);
    bench.stop_button(false);
    assert!(bench.ask("").contains("ALARM:10"));
    assert!(bench.ask("?").starts_with("<Alarm|"));
    assert!(bench.ask("$X\nG0 X1\n").ends_with("ok\r\nok\r\n"));
    assert_eq!(bench.plotter.position().x, 88); // 1 mm
}

#[test]
fn places_are_kept_and_gone_back_to_by_way_of_another() {
    let mut bench = bench();
    bench.ask("G0 X10 Y20\nG28.1\nG0 X40 Y30\nG30.1\nG0 X0 Y0\n");
    let told = bench.ask("$#\n");
    assert!(
        told.contains("[G28:10.000,20.000,0.000]") && told.contains("[G30:40.000,30.000,0.000]"),
        "{told}"
    );
    bench.ask("G30\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(3_503, 2_627)); // (40, 30) mm
    bench.ask("G28 X0\n");
    assert_eq!(bench.plotter.position(), StepPoint::new(876, 2_627)); // (0, 30), then (10, 30) mm
    assert!(bench.made.iter().any(|made| made.position == StepPoint::new(0, 2_627)));
    bench.ask("\u{18}");
    assert!(bench.ask("$#\n").contains("[G28:10.000,20.000,0.000]"), "a reset keeps them");
    assert!(bench.ask("$RST=#\n").starts_with("[MSG:Restoring defaults]\r\nok\r\n\r\nGrbl 1.1h"));
    assert!(bench.ask("$#\n").contains("[G28:0.000,0.000,0.000]"));
}

#[test]
fn by_inverse_time_a_line_takes_its_time_however_long_it_is() {
    let mut bench = bench();
    bench.ask("M3\nG1 X0.1 F600\n");
    for (line, asked_s) in
        [("G93 G1 X60 F6\n", 10.0), ("G2 X60 Y40 I0 J20 F6\n", 10.0), ("G1 X70 F12\n", 5.0)]
    {
        let first = bench.made.len();
        assert_eq!(bench.ask(line), "ok\r\n");
        let took_s = (bench.made.last().unwrap().at - bench.made[first].at).as_secs_f64();
        // It begins and ends at rest.
        assert!((took_s - asked_s).abs() < 0.1, "{line}: {took_s} s");
    }
    assert_eq!(bench.ask("G1 X80\n"), "error:22\r\n");
    assert_eq!(bench.ask("G94 G1 X80\n"), "error:22\r\n");
}

#[test]
fn a_pen_on_the_z_axis_is_lifted_by_the_height_that_the_file_of_the_machine_names() {
    let mut config = MachineConfig::stepper_plotter();
    (config.steppers_mut().unwrap().pen.lifted_by, config.steppers_mut().unwrap().pen.down_z_mm) =
        (PenLift::Height, 0.5);
    let machine = Machine::new(config).unwrap();
    let mut bench = Bench::new(StepperPlotterSettings::of(&machine, Dialect::Grbl));
    bench.ask("");
    let up_deg = bench.plotter.pen_deg();
    assert_eq!(bench.ask("G0 Z5\nG0 X10 Y10\nG1 Z0.5 F600\nG1 X20\n"), "ok\r\n".repeat(4));
    assert_ne!(bench.plotter.pen_deg(), up_deg);
    assert_eq!(bench.ask("G0 Z5\nG0 X0\n"), "ok\r\n".repeat(2));
    assert_eq!(bench.plotter.pen_deg(), up_deg);
}
