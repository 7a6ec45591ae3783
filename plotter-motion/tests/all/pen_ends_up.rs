//! Whatever is drawn, the pen is off the sheet when the machine stands: at the end, in a pause, in a stop.

use crate::stepper_bench;

use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{Activity, Dialect, StepperPlotterSettings};
use plotter_motion::firmware::{Gantry, LinkedGantry, MarkingBoard};
use plotter_motion::gcode::{self, PenConvention};
use plotter_motion::hpgl;
use plotter_motion::kinematics::{Cartesian, MotorScale};
use plotter_motion::protocol::{Link, LinkSettings, Message};
use plotter_motion::{
    Axis, LimitSwitches, Machine, MachineConfig, PathMode, Pen, PenMove, Planner, PlannerSettings, PlotOp,
    Point, SafetyGate, StepGen, StepPoint,
    stepgen::{MotorEvent, StepGenSettings},
};
use stepper_bench::Bench;

/// Servo of the bench's machine.
const UP_DEG: u8 = 160;
const DOWN_DEG: u8 = 90;

/// What the motors and the pen did, in short: `d` and `u` for the pen, `-` for steps, `P` for another pen,
/// `N` for a new sheet.
fn done(settings: PlannerSettings, ops: &[PlotOp]) -> String {
    let motor = MotorScale { steps_per_mm: 10.0, inverted: false };
    let mut planner = Planner::<16>::new(settings).unwrap();
    let mut steps = StepGen::new(Cartesian::new(motor, motor).unwrap(), StepGenSettings::default());
    let mut done = String::new();
    let mut act = |planner: &mut Planner<16>| {
        let Some(action) = planner.next_action() else { return false };
        steps.push(action).unwrap();
        while let Some(event) = steps.next_event() {
            let letter = match event.event {
                MotorEvent::Step(_) if done.ends_with('-') => continue,
                MotorEvent::Step(_) => '-',
                MotorEvent::Pen(Pen::Down) => 'd',
                MotorEvent::Pen(Pen::Up) => 'u',
                MotorEvent::SelectPen(_) => 'P',
                MotorEvent::NewPage => 'N',
                _ => '?',
            };
            done.push(letter);
        }
        true
    };
    for op in ops {
        while !planner.has_room() && act(&mut planner) {}
        planner.push(*op).unwrap();
    }
    while !planner.has_room() && act(&mut planner) {}
    planner.finish().unwrap();
    while act(&mut planner) {}
    assert!(planner.is_empty());
    done
}

fn modes() -> [PlannerSettings; 3] {
    let exact = PlannerSettings::default();
    [
        exact,
        PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.1 }, ..exact },
        PlannerSettings { jerk_mm_s3: Some(20_000.0), ..exact },
    ]
}

fn of_hpgl(text: &str) -> Vec<PlotOp> {
    hpgl::plot_ops(text.as_bytes()).filter_map(Result::ok).collect()
}

fn of_gcode(text: &str) -> Vec<PlotOp> {
    gcode::plot_ops(text.as_bytes()).filter_map(Result::ok).collect()
}

#[test]
fn every_drawing_ends_lifted_however_its_text_ends() {
    let hpgl = [
        "IN;SP1;PU0,0;PD400,0,400,400;PU;",
        "IN;SP1;PU0,0;PD400,0,400,400;PU;SP0;",
        "IN;SP1;PU0,0;PD400,0,400,400;PU;PG;",
        "IN;SP1;PU0,0;PD400,0,400,400;",
        "IN;SP1;PU0,0;PD400,0,400,400",
        "IN;SP1;PU0,0;PD;",
        "IN;SP1;PU0,0;PD400,0;IN;",
        "IN;SP1;PU400,400;EA800,800;",
        "IN;SP1;PU400,400;PD;CI100;PU;",
        "PE<=0;",
        "IN;SP1;IW0,0,400,400;PU0,0;PD800,0;PU;",
    ];
    let gcode = [
        "M3\nG1 X10 F600\nG1 Y10\nM5\n",
        "M3\nG1 X10 F600\nG1 Y10\nM5\nM2\n",
        "M3\nG1 X10 F600\nG1 Y10\nM30\n",
        "M3\nG1 X10 F600\nG1 Y10\n",
        "M3\nG1 X10 F600\nG1 Y10",
        "G0 Z5\nG0 X0 Y0\nG1 Z-1 F300\nG1 X10 Y10\nG0 Z5\n",
        "G0 Z5\nG0 X0 Y0\nG1 Z-1 F300\nG1 X10 Y10\n",
        "M300 S50\nG0 X0 Y0\nM300 S30\nG1 X10 Y10 F600\nM300 S50\n",
        "G0 X0 Y0\nM4 S1000\nG1 X10 Y10 F600\nM5\n",
        "G0 X5 Y5\nG1 X10 Y10 F600\nG2 X20 Y10 I5 J0\n",
    ];
    let all =
        hpgl.iter().map(|text| (text, of_hpgl(text))).chain(gcode.iter().map(|text| (text, of_gcode(text))));
    for (text, ops) in all {
        for settings in modes() {
            let done = done(settings, &ops);
            let pens: String = done.chars().filter(|letter| "ud".contains(*letter)).collect();
            assert!(pens.is_empty() || pens.ends_with('u'), "{text}: {done}");
            assert!(pens.contains('d') || *text == "PE<=0;", "{text}: {done}");
            assert!(!pens.contains("uu") && !pens.contains("dd"), "{text}: {done}");
        }
    }
}

#[test]
fn operations_that_only_move_the_pen_are_kept_at_the_end() {
    let draw = PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: None };
    let lift = PlotOp::Travel { to: Point::new(10.0, 0.0) };
    assert_eq!(of_hpgl("PD400,0;PU;"), [draw, lift]);
    assert_eq!(of_hpgl("PD400,0;PU;PU;"), [draw, lift]);
    assert_eq!(of_hpgl("PD400,0;PU;SP0;"), [draw, PlotOp::SelectPen { pen: 0 }], "which lifts it");
    assert_eq!(of_hpgl("PD400,0;PU400,0;"), [draw, lift]);
    // What lies outside the window is not drawn; the pen stands at its edge.
    assert_eq!(of_hpgl("IW0,0,400,400;PD800,0;PU;"), [draw, lift]);
    for text in [
        "M3\nG1 X10 F600\nM5\n",
        "M3\nG1 X10 F600\nM5\nM2\n",
        "M3\nG1 X10 F600\nM2\n",
        "M3\nG1 X10 F600\nM5\nG4 P0.1\n",
    ] {
        let draw = PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: Some(10.0) };
        assert_eq!(of_gcode(text), [draw, lift], "{text}");
    }
    // A dot of the end is one, and lifted.
    assert_eq!(of_hpgl("PU400,0;PD;PU;"), [lift, draw, lift]);
}

#[test]
fn a_pen_that_was_lifted_is_up_while_the_machine_dwells_and_one_that_was_not_stays() {
    let lifted = of_gcode("M3\nG1 X10 F600\nM5\nG4 P5\nG0 X20\nM5\n");
    assert!(
        matches!(lifted[1..], [PlotOp::Travel { .. }, PlotOp::Dwell { .. }, PlotOp::Travel { .. }]),
        "{lifted:?}"
    );
    let down = of_gcode("M3\nG1 X10 F600\nG4 P5\nG1 X20\nM5\n");
    assert!(
        matches!(down[1..], [PlotOp::Dwell { .. }, PlotOp::Draw { .. }, PlotOp::Travel { .. }]),
        "{down:?}"
    );
}

#[test]
fn a_drawing_that_rests_goes_on_with_its_pen_down_and_one_that_is_over_does_not() {
    let mut planner = Planner::<16>::new(PlannerSettings::default()).unwrap();
    let draw = |x| PlotOp::Draw { to: Point::new(x, 0.0), feed_mm_s: None };
    let mut pens = |end: fn(&mut Planner<16>), x| {
        planner.push(draw(x)).unwrap();
        end(&mut planner);
        let actions = core::iter::from_fn(|| planner.next_action());
        let pens: Vec<Pen> = actions
            .filter_map(|action| {
                if let plotter_motion::planner::Action::Course(course) = action {
                    Some(course.pen)
                } else {
                    None
                }
            })
            .collect();
        pens
    };
    assert_eq!(pens(|planner| planner.rest().unwrap(), 10.0), [Pen::Down]);
    assert_eq!(pens(|planner| planner.finish().unwrap(), 20.0), [Pen::Down, Pen::Up]);
    assert_eq!(pens(|planner| planner.finish().unwrap(), 30.0), [Pen::Down, Pen::Up]);
}

fn bench(settings: StepperPlotterSettings) -> Bench {
    let mut bench = Bench::new(StepperPlotterSettings { dialect: Dialect::Grbl, ..settings });
    bench.ask("");
    bench
}

#[test]
fn the_firmware_lifts_at_the_end_of_a_program_whatever_lifts_its_pens() {
    let spindle = StepperPlotterSettings::default();
    let motion = StepperPlotterSettings { pen: PenConvention::Motion, ..spindle };
    let height = StepperPlotterSettings { pen: PenConvention::Height { threshold_mm: 0.0 }, ..spindle };
    for (settings, text) in [
        (spindle, "M3\nG1 X10 F6000\nM5\n"),
        (spindle, "M3\nG1 X10 F6000\nM2\n"),
        (spindle, "M3\nG1 X10 F6000\nM30\n"),
        (motion, "G1 X10 F6000\nM2\n"),
        (height, "G1 Z-1 F6000\nG1 X10\nG0 Z5\n"),
        (height, "G1 Z-1 F6000\nG1 X10\nM30\n"),
    ] {
        let mut bench = bench(settings);
        bench.ask(text);
        assert!(bench.made.iter().any(|made| made.pen_deg == DOWN_DEG), "{text}");
        assert_eq!(bench.plotter.pen_deg(), UP_DEG, "{text}");
        assert_eq!(bench.plotter.position(), StepPoint::new(876, 0), "{text}");
    }
}

#[test]
fn a_hold_lifts_the_pen_and_going_on_lowers_it_before_anything_moves() {
    let settings = StepperPlotterSettings::default();
    let mut held = bench(settings);
    held.send("M3\nG1 X100 F3000\nM5\n");
    held.run_for(Duration::from_millis(900));
    held.send("!");
    held.run_for(Duration::from_secs(1));
    assert_eq!(held.plotter.status(held.now).activity, Activity::Hold { stands: true });
    assert_eq!(held.plotter.pen_deg(), UP_DEG);
    let before = held.made.len();
    assert!(held.made[before - 1].pen_deg == DOWN_DEG, "it brakes along the line with the pen down");
    held.send("~");
    held.run_for(Duration::from_millis(1));
    assert_eq!(held.plotter.pen_deg(), DOWN_DEG);
    let lowered = held.now;
    held.run_out();
    assert!(held.made[before].at >= lowered + settings.pen_settle - Duration::from_millis(2));
    assert!(held.made[before].pen_deg == DOWN_DEG);
    assert_eq!((held.plotter.pen_deg(), held.plotter.position()), (UP_DEG, StepPoint::new(8758, 0)));
}

#[test]
fn a_hold_in_a_travel_or_after_the_last_line_leaves_no_dot() {
    let mut travel = bench(StepperPlotterSettings::default());
    travel.send("M3\nG1 X10 F6000\nM5\nG0 X200\n");
    travel.run_for(Duration::from_millis(1_500));
    travel.send("!");
    travel.run_for(Duration::from_secs(1));
    travel.send("~");
    travel.run_out();
    let lowered =
        travel.made.windows(2).filter(|pair| pair[0].pen_deg == UP_DEG && pair[1].pen_deg == DOWN_DEG);
    assert_eq!(lowered.count(), 0, "but before the first line");
    let mut after = bench(StepperPlotterSettings::default());
    after.ask("M3\nG1 X10 F6000\n");
    assert_eq!(after.plotter.pen_deg(), DOWN_DEG, "more of it may come");
    after.ask("!");
    assert_eq!(after.plotter.pen_deg(), UP_DEG);
    after.ask("~");
    assert_eq!(after.plotter.pen_deg(), UP_DEG, "there is nothing to draw");
    after.ask("G1 X20\n");
    assert!(after.made.last().unwrap().pen_deg == DOWN_DEG, "the line goes on");
    after.ask("M5\n");
    assert_eq!(after.plotter.pen_deg(), UP_DEG);
}

#[test]
fn a_pause_lifts_the_pen() {
    let mut bench = bench(StepperPlotterSettings::default());
    bench.ask("M3\nG1 X10 F6000\nM0\nG1 X20\n");
    assert_eq!((bench.plotter.pen_deg(), bench.plotter.position().x), (UP_DEG, 876));
    bench.ask("~");
    assert_eq!((bench.plotter.pen_deg(), bench.plotter.position().x), (DOWN_DEG, 1752));
    bench.ask("\u{18}");
    assert_eq!(bench.plotter.pen_deg(), UP_DEG, "a reset lifts it");
}

#[test]
fn other_settings_do_not_leave_a_pen_on_the_sheet_that_is_believed_to_be_up() {
    let mut bench = bench(StepperPlotterSettings::default());
    bench.ask("M3\nG1 X10 F6000\n");
    bench.ask("$120=300\n");
    assert_eq!(bench.plotter.pen_deg(), UP_DEG);
    let before = bench.made.len();
    bench.ask("M5\nG0 X20\n");
    assert!(bench.made[before..].iter().all(|made| made.pen_deg == UP_DEG));
}

#[test]
fn a_marking_board_that_has_arrived_or_is_stopped_has_its_pen_up() {
    let machine = Machine::new(MachineConfig::marking_board()).unwrap();
    let mut board = MarkingBoard::of(&machine, SafetyGate::new(LimitSwitches::RELEASED, false));
    let there = PenMove { pen: Pen::Down, target: StepPoint::new(463, 463) };
    board.start(Duration::ZERO, there);
    assert_eq!(board.pen(), Pen::Down);
    board.emergency_stop(Duration::from_millis(6), true);
    assert_eq!(board.pen(), Pen::Up);
    let mut board = MarkingBoard::of(&machine, SafetyGate::new(LimitSwitches::RELEASED, false));
    board.start(Duration::ZERO, PenMove { pen: Pen::Down, target: StepPoint::default() });
    for ms in (5..5_000).step_by(5) {
        board.tick(Duration::from_millis(ms));
    }
    assert!(board.has_arrived());
    assert_eq!(board.pen(), Pen::Up);
}

#[test]
fn a_linked_gantry_has_its_pen_down_on_the_way_of_a_line_only() {
    let machine = Machine::new(MachineConfig::default()).unwrap();
    let settings = LinkSettings::default();
    let mut gantry = LinkedGantry::<8, 128, _>::new(
        Gantry::new(&machine, SafetyGate::new(LimitSwitches::RELEASED, false)),
        1,
        settings,
    );
    let mut host = Link::<8, 128>::host(0x1234, settings);
    let (mut now, mut pens, mut sent) = (Duration::ZERO, Vec::new(), false);
    while now < Duration::from_secs(20) {
        now += Duration::from_millis(1);
        while let Some(byte) = host.transmit(now) {
            gantry.receive(now, byte);
        }
        let mut heard = [0; 64];
        while host.read(&mut heard) > 0 {}
        if host.session() != 0 && !sent {
            for (pen, x) in [(Pen::Up, 3), (Pen::Down, 40), (Pen::Down, 5)] {
                let (bytes, length) = Message::Target { pen, by: StepPoint::new(x, 0) }.encode();
                assert_eq!(host.write(&bytes[..length]), length);
            }
            sent = true;
        }
        // A motor that turns a count a millisecond wherever it is driven.
        let duties = gantry.gantry().drive().duties();
        for (axis, duty) in Axis::BOTH.into_iter().zip(duties) {
            if let Some(direction) = duty.direction() {
                gantry.gantry_mut().edge(now, axis, direction);
            }
        }
        if gantry.gantry().next_tick().is_some_and(|due| due <= now) {
            gantry.gantry_mut().tick(now);
        }
        gantry.poll(now);
        while let Some(byte) = gantry.transmit(now) {
            host.receive(now, byte);
        }
        if pens.last() != Some(&gantry.pen()) {
            pens.push(gantry.pen());
        }
    }
    assert_eq!(gantry.gantry().position(), StepPoint::new(48, 0));
    assert_eq!(pens, [Pen::Up, Pen::Down, Pen::Up], "from line to line it stays down");
}
