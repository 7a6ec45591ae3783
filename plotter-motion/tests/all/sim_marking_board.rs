//! The marking board: published, with the equalizer, and ours, on the same two unequal motors and rails.
//!
//! `cargo test --release -p plotter-motion --test all sim_marking_board:: -- --nocapture --test-threads 1`
//! prints the tables of docs/results/marking-board.md.

use crate::marking;

use core::time::Duration;
use marking::{Run, TIME_STEP, belt, contouring, equalized, plant, published};
use plotter_motion::control::LineController;
use plotter_motion::firmware::MarkingBoardSettings;
use plotter_motion::kinematics::{BeltSigns, CoreXy};
use plotter_motion::plant::{MarkingBoardPlant, MarkingBoardPlantSettings};
use plotter_motion::{
    Demand, Drive, Duty, LimitSwitches, Pen, PenMove, PlotOp, Point, SafetyGate, StepPoint, Vec2,
    toolpath::{circle, rectangle},
};

/// Where the encoders' marks are when the board is switched on: in the middle, right at a mark, and odd ones.
const PHASES: [[f64; 2]; 3] = [[0.5, 0.5], [0.0, 0.0], [0.05, 0.97]];

/// What came of straight moves.
struct Straight {
    done: bool,
    /// Greatest distance from the line on the way, mm.
    widest_mm: f64,
    /// The same of the place of rest, mm.
    at_end_mm: f64,
}

/// Straight moves of 30 mm along the axes, there and back, and a rest after each.
fn straight(
    name: &str,
    phases: [f64; 2],
    (settings, controller): (MarkingBoardSettings, impl LineController),
) -> Straight {
    let mut run = Run::with_phases(settings, controller, phases);
    let mut result = Straight { done: true, widest_mm: 0.0, at_end_mm: 0.0 };
    for (dx, dy) in [(30.0, 0.0), (-30.0, 0.0), (0.0, 30.0), (0.0, -30.0)] {
        let from = run.plant.position_mm();
        let along = Vec2::new(dx, dy) * (1.0 / 30.0);
        let beside = |at: Point| (along.x * (at - from).y - along.y * (at - from).x).abs();
        let to = PlotOp::Draw { to: run.board.position_mm() + Vec2::new(dx, dy), feed_mm_s: None };
        result.done &=
            run.draw_all(&settings, [to], |at| result.widest_mm = result.widest_mm.max(beside(at)));
        run.rest(Duration::from_millis(300));
        result.at_end_mm = result.at_end_mm.max(beside(run.plant.position_mm()));
    }
    println!(
        "| {name} | {phases:?} | {:.4} | {:.4} | {:.4} | {:.1} s |",
        result.widest_mm,
        result.at_end_mm,
        run.miscounted_mm(),
        run.now.as_secs_f64()
    );
    result
}

/// The same drive on both motors until the pen is 30 mm further right: how far it is beside then, mm.
fn uncontrolled_drift_mm() -> f64 {
    let mut plant = MarkingBoardPlant::new(&plant(), TIME_STEP.as_secs_f64());
    let from = plant.position_mm();
    let demand = Demand { x: Duty::saturating(0.45), y: Duty::ZERO };
    let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
    let right = gate.pass_belt(demand, belt().signs(), 0.0);
    while (plant.position_mm() - from).x < 30.0 {
        plant.step(right.duties(), |_| ());
    }
    (plant.position_mm() - from).y.abs()
}

/// The rectangle of 60 mm by 40 mm ten times: how far apart the rounds' corners are at most, true places, mm.
fn rectangles(
    name: &str,
    phases: [f64; 2],
    (settings, controller): (MarkingBoardSettings, impl LineController),
) -> (bool, f64) {
    let mut run = Run::with_phases(settings, controller, phases);
    let mut rounds: Vec<Vec<Point>> = Vec::new();
    let mut done = true;
    for _ in 0..10 {
        let mut corners = Vec::new();
        for next in settings.moves(rectangle(settings.start, 60.0, 40.0)) {
            done &= run.draw(next.unwrap(), |_| ());
            corners.push(run.plant.position_mm());
        }
        rounds.push(corners);
    }
    let mut spread = 0.0_f64;
    for (i, first) in rounds.iter().enumerate() {
        for second in &rounds[..i] {
            for (a, b) in first.iter().zip(second).skip(1) {
                spread = spread.max(a.distance(*b));
            }
        }
    }
    println!(
        "| {name} | {phases:?} | {spread:.4} | {:.4} | {:.1} s |",
        run.miscounted_mm(),
        run.now.as_secs_f64()
    );
    (done, spread)
}

/// The circle of radius 50 mm by 300 points: the difference of its greatest and least distance from the
/// middle, and its size, true places, mm.
fn circles(
    name: &str,
    phases: [f64; 2],
    (settings, controller): (MarkingBoardSettings, impl LineController),
) -> (bool, f64) {
    let mut run = Run::with_phases(settings, controller, phases);
    let start = Point::new(100.0, 100.0);
    let centre = start + Vec2::new(50.0, 0.0);
    let mut ops = circle(start, 50.0, 300);
    let mut done = run.draw_all(&settings, ops.next(), |_| ());
    let (mut least, mut most) = (f64::MAX, 0.0_f64);
    let (mut low, mut high) = (Point::new(1e9, 1e9), Point::new(-1e9, -1e9));
    done &= run.draw_all(&settings, ops, |at| {
        let r = at.distance(centre);
        (least, most) = (least.min(r), most.max(r));
        low = Point::new(low.x.min(at.x), low.y.min(at.y));
        high = Point::new(high.x.max(at.x), high.y.max(at.y));
    });
    println!(
        "| {name} | {phases:?} | {:.3} x {:.3} | {least:.3} to {most:.3} | {:.4} | {:.4} | {:.1} s |",
        high.x - low.x,
        high.y - low.y,
        most - least,
        run.miscounted_mm(),
        run.now.as_secs_f64()
    );
    done &= run.board.points_done() == 301;
    (done, most - least)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_straight_move_of_30_mm_stays_straight() {
    /// Asked; their least was 1 mm.
    const DRIFT_MM: f64 = 0.05;
    let free = uncontrolled_drift_mm();
    println!("the same drive on both motors: {free:.3} mm beside after 30 mm");
    println!("| | phases | on the way mm | at rest mm | miscounted mm | time |");
    let theirs = straight("published", PHASES[0], published());
    assert!(free > 1.0 && theirs.widest_mm > 0.4); // up to the allowed error, which stops it
    for phases in PHASES {
        for line in [
            straight("published directions, equalizer", phases, equalized()),
            straight("contouring", phases, contouring()),
        ] {
            assert!(line.done && line.widest_mm < DRIFT_MM && line.at_end_mm < DRIFT_MM, "{phases:?}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ten_rectangles_lie_on_each_other() {
    /// Asked; theirs was below 1 mm.
    const SPREAD_MM: f64 = 0.1;
    println!("| | phases | corners apart mm | miscounted mm | time |");
    rectangles("published", PHASES[0], published());
    rectangles("published directions, equalizer", PHASES[0], equalized());
    for phases in PHASES {
        let (done, spread_mm) = rectangles("contouring", phases, contouring());
        assert!(done && spread_mm < SPREAD_MM, "{phases:?}: {spread_mm}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_circle_of_300_points_is_round() {
    /// Asked; theirs was 3 to 5 mm.
    const ROUND_MM: f64 = 0.1;
    println!("| | phases | size mm | radius mm | roundness mm | miscounted mm | time |");
    let (_, theirs) = circles("published", PHASES[0], published());
    circles("published directions, equalizer", PHASES[0], equalized());
    assert!(theirs > 10.0 * ROUND_MM);
    for phases in PHASES {
        let (done, round_mm) = circles("contouring", phases, contouring());
        assert!(done && round_mm < ROUND_MM, "{phases:?}: {round_mm}");
    }
}

/// Down along the pressed right switch, where the stronger motor is the one that pushes at it.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_carriage_does_not_go_into_a_switch_along_which_it_moves() {
    /// The pen of this plant moves by a hundredth of a millimetre between two states of its switches.
    const INTO_MM: f64 = 0.01;
    let into = |unequal_share| {
        let start = Point::new(300.0, 150.0);
        let settings = MarkingBoardPlantSettings { start, ..plant() };
        let mut plant = MarkingBoardPlant::new(&settings, TIME_STEP.as_secs_f64());
        // the switch is held down, so nothing but the gate keeps the pen from it
        let gate = SafetyGate::new(LimitSwitches { x_max: true, ..LimitSwitches::RELEASED }, false);
        let down_and_right = Demand { x: Duty::saturating(0.4), y: Duty::saturating(-0.4) };
        let mut farthest = 0.0_f64;
        for _ in 0..20_000 {
            plant.step(gate.pass_belt(down_and_right, belt().signs(), unequal_share).duties(), |_| ());
            farthest = farthest.max(plant.position_mm().x - start.x);
        }
        println!(
            "share {unequal_share}: {farthest:.3} mm into the switch, {:.1} mm down",
            start.y - plant.position_mm().y
        );
        farthest
    };
    assert!(into(0.0) > 1.0);
    assert!(into(0.15) < INTO_MM);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn an_emergency_stop_ends_in_the_run_down() {
    /// At 30 mm/s: the motors' time constant of 27 ms, 0.8 mm without friction.
    const RUN_DOWN_MM: f64 = 0.8;
    let (settings, controller) = contouring();
    let mut run = Run::new(settings, controller);
    run.board.start(run.now, PenMove { pen: Pen::Down, target: StepPoint::new(2315, 2315) });
    run.rest(Duration::from_millis(600));
    let speeds = run.board.speeds_counts_s();
    assert!(speeds.iter().all(|&speed| (speed / 1389.0 - 1.0).abs() < 0.05), "{speeds:?}");
    let pressed_at = run.plant.position_mm();
    run.board.emergency_stop(run.now, true);
    assert_eq!(run.board.drive(), Drive::default());
    run.rest(Duration::from_millis(500));
    let ran_on = run.plant.position_mm().distance(pressed_at);
    println!("ran on for {ran_on:.3} mm, miscounted {:.4} mm", run.miscounted_mm());
    assert!(ran_on > 0.1 && ran_on < RUN_DOWN_MM, "{ran_on}");
    assert!(run.miscounted_mm() < 0.025, "the run-down is counted: {}", run.miscounted_mm());
    // let go and reset, it goes on to its target
    run.board.emergency_stop(run.now, false);
    assert!(run.board.reset_emergency_stop(run.now));
    run.rest(Duration::from_secs(5));
    assert!(run.board.has_arrived());
    assert!(run.plant.position_mm().distance(settings.start + Vec2::new(50.0, 0.0)) < 0.05);
}

/// Which motor is the stronger one, which rail the rougher one, and how the motors are wired does not matter
/// to ours.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn other_boards_are_drawn_on_as_well() {
    const CORNER_MM: f64 = 0.05;
    let other_signs = CoreXy::new(BeltSigns::TrackingEquations, 46.3).unwrap();
    for belt in [belt(), other_signs] {
        let unequal = MarkingBoardPlantSettings { belt, ..plant() };
        let [first, second] = unequal.motors;
        let swapped = MarkingBoardPlantSettings {
            motors: [second, first],
            x_rail_n: unequal.y_rail_n,
            y_rail_n: unequal.x_rail_n,
            phases: [0.8, 0.4],
            ..unequal
        };
        let (settings, controller) = contouring();
        let settings = MarkingBoardSettings { belt, ..settings };
        let mut run = Run::on(settings, controller, &swapped);
        let ops = rectangle(settings.start, 20.0, 10.0);
        for (op, next) in ops.clone().zip(settings.moves(ops)) {
            assert!(run.draw(next.unwrap(), |_| ()), "{belt:?}");
            let (pen, corner) = (run.plant.position_mm(), op.target().unwrap());
            assert!(pen.distance(corner) < CORNER_MM, "{belt:?}: {pen:?} for {corner:?}");
        }
    }
}
