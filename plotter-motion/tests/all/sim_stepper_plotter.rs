//! The stepper plotter's controller against simulated motors that lose steps, and simulated limit switches.

use crate::drawings;
use crate::stepper_bench;

use crate::law_cases::cases;
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::plant::{StepperAxis, StepperSettings};
use plotter_motion::{
    Direction, PlannerSettings, PlotOp, Point, StepPoint, gcode,
    toolpath::{circle, rectangle},
};
use proptest::prelude::*;
use stepper_bench::{Bench, Made, distance_mm};

const STEPS_PER_MM: f64 = 87.58;
/// A step, and the hundredth of a millimetre of mDraw's two decimals.
const PATH_MM: f64 = 1.0 / STEPS_PER_MM + 0.01;
/// Where friction leaves a rotor, steps (see `sim_stepper.rs`).
const FRICTION_STEPS: f64 = 1.5;

fn settings(dialect: Dialect) -> StepperPlotterSettings {
    StepperPlotterSettings { dialect, ..StepperPlotterSettings::default() }
}

/// Both motors stand where the controller says, and none has lost a step.
fn assert_true(bench: &Bench) {
    assert_eq!(bench.lost(), [0, 0]);
    let plant = bench.rested().expect("a bench with motors");
    let began = StepPoint::new(500, 500);
    for (motor, carriage, origin) in
        [(plant.x, bench.carriage[0], began.x), (plant.y, bench.carriage[1], began.y)]
    {
        assert!((motor.position_steps() - f64::from(carriage - origin)).abs() <= FRICTION_STEPS, "{motor:?}");
    }
}

fn at_mm(made: &Made) -> Point {
    Point::new(f64::from(made.position.x) / STEPS_PER_MM, f64::from(made.position.y) / STEPS_PER_MM)
}

/// Distance of the farthest step of a lowered pen from the drawing, and whether each vertex was passed.
fn assert_drawn(bench: &Bench, first: usize, path: &[Point]) {
    let drawn: Vec<Point> = bench.made[first..].iter().filter(|made| made.pen_deg == 90).map(at_mm).collect();
    assert!(!drawn.is_empty());
    let farthest = drawn.iter().map(|at| distance_mm(*at, path)).fold(0.0, f64::max);
    assert!(
        farthest <= PATH_MM,
        "{farthest} mm off, {:?}",
        drawn.iter().find(|at| distance_mm(**at, path) > PATH_MM)
    );
    for vertex in path {
        assert!(drawn.iter().any(|at| at.distance(*vertex) <= 2.0 * PATH_MM), "{vertex:?} was not drawn");
    }
}

fn vertices(ops: impl IntoIterator<Item = PlotOp>) -> Vec<Point> {
    ops.into_iter().filter_map(PlotOp::target).collect()
}

fn square_and_circle() -> [Vec<Point>; 2] {
    [
        vertices(rectangle(Point::new(20.0, 20.0), 40.0, 30.0)),
        vertices(circle(Point::new(100.0, 60.0), 25.0, 60)),
    ]
}

/// As mDraw does it: to the first point, pen down, 200 ms, the line, pen up, 200 ms.
fn draw_with_mdraw(bench: &mut Bench, path: &[Point]) {
    let say = |bench: &mut Bench, line: String| {
        let answer = bench.ask(&line);
        assert!(answer.ends_with("OK\r\n") && !answer.contains("error"), "{line}: {answer}");
    };
    for (index, at) in path.iter().enumerate() {
        say(bench, format!("G1 X{:.2} Y{:.2}\n", at.x, at.y));
        if index == 0 {
            say(bench, "M1 90\n".to_owned());
            bench.run_for(Duration::from_millis(200));
        }
    }
    say(bench, "M1 160\n".to_owned());
    bench.run_for(Duration::from_millis(200));
}

/// A program that counts characters: 128 bytes are on the way at the most.
fn stream(bench: &mut Bench, text: &str) {
    let mut lines = text.split_inclusive('\n').peekable();
    let mut owed = std::collections::VecDeque::new();
    while lines.peek().is_some() || !owed.is_empty() {
        while let Some(line) = lines.next_if(|line| owed.iter().sum::<usize>() + line.len() <= 128) {
            owed.push_back(line.len());
            bench.send(line);
        }
        bench.run_for(Duration::from_millis(2));
        for answer in bench.take_answers().lines() {
            assert!(!answer.starts_with("error") && !answer.starts_with("ALARM"), "{answer}");
            if answer == "ok" {
                owed.pop_front();
            }
        }
    }
    bench.run_out();
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn mdraw_draws_a_square_and_a_circle_without_losing_a_step() {
    let mut bench = Bench::new(settings(Dialect::MDraw)).with_plant();
    for path in square_and_circle() {
        let first = bench.made.len();
        draw_with_mdraw(&mut bench, &path);
        assert_drawn(&bench, first, &path);
        let end = bench.plotter.position_mm();
        assert!(end.distance(path[path.len() - 1]) <= PATH_MM, "{end:?}");
    }
    assert_true(&bench);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_stream_draws_a_square_and_a_circle_without_losing_a_step() {
    let mut bench = Bench::new(settings(Dialect::Grbl)).with_plant();
    bench.ask("");
    for path in square_and_circle() {
        let first = bench.made.len();
        let mut text = String::new();
        for (index, at) in path.iter().enumerate() {
            let code = if index == 0 { "G0" } else { "G1" };
            text +=
                &format!("{code} X{:.3} Y{:.3} F3000\n{}", at.x, at.y, if index == 0 { "M3\n" } else { "" });
        }
        stream(&mut bench, &(text + "M5\n"));
        assert_drawn(&bench, first, &path);
    }
    // And a whole circle by one line.
    let first = bench.made.len();
    stream(&mut bench, "G0 X150 Y100\nM3\nG2 I-20\nM5\n");
    let round = vertices(circle(Point::new(110.0, 100.0), 20.0, 2_000));
    assert_drawn(&bench, first, &round);
    assert_true(&bench);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn it_homes_from_any_place() {
    for dialect in [Dialect::MDraw, Dialect::Grbl] {
        for carriage in [[0, 0], [34_000, 28_000], [17_000, 3], [33_990, 14_000], [-20, 28_020]] {
            let settings = StepperPlotterSettings { homing: true, ..settings(dialect) };
            let mut bench = Bench::new(settings).with_plant();
            bench.ask("");
            bench.carriage = carriage;
            let answer = bench.ask(if dialect == Dialect::MDraw { "G28\n" } else { "$H\n" });
            assert!(answer == "OK\r\n" || answer == "ok\r\n", "{answer}");
            assert_eq!(bench.carriage, [88, 88]);
            assert_eq!(bench.plotter.position(), StepPoint::default());
            assert_eq!(bench.lost(), [0, 0]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(24) })]

    #[test]
    fn an_emergency_stop_in_a_stroke_knows_where_the_pen_is(stop_ms in 0..4_000_u64, grbl in any::<bool>()) {
        let dialect = if grbl { Dialect::Grbl } else { Dialect::MDraw };
        let mut bench = Bench::new(settings(dialect)).with_plant();
        bench.ask("");
        bench.send(if grbl { "M3\nG1 X60 Y20 F3000\nG1 X0 Y40\n" } else { "G1 X150 Y50\n" });
        bench.run_for(Duration::from_millis(stop_ms));
        let count = bench.made.len();
        bench.stop_button(true);
        bench.run_for(Duration::from_secs(1));
        prop_assert_eq!(bench.made.len(), count);
        let position = bench.plotter.position();
        prop_assert_eq!(bench.carriage, [500 + position.x, 500 + position.y]);
        // The rotors turn on, swing back and come to rest at the last step: at these speeds none is lost.
        if let Some(plant) = bench.rested() {
            for (motor, steps) in [(plant.x, position.x), (plant.y, position.y)] {
                prop_assert!((motor.position_steps() - f64::from(steps)).abs() <= FRICTION_STEPS, "{:?}", motor);
            }
        }
    }
}

/// The drawings that planning is measured on, at the source's rates: base 2000, lines 4000, travels 8000
/// pulses/s.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn planned_drawings_lose_no_step_where_a_sudden_start_does() {
    for (draw_hz, travel_hz) in [(2_000.0, 8_000.0), (4_000.0, 8_000.0), (8_000.0, 8_000.0)] {
        let planner = PlannerSettings {
            speed_mm_s: draw_hz / STEPS_PER_MM,
            travel_speed_mm_s: travel_hz / STEPS_PER_MM,
            ..settings(Dialect::Grbl).planner
        };
        for drawing in drawings::built() {
            let mut bench =
                Bench::new(StepperPlotterSettings { planner, ..settings(Dialect::Grbl) }).with_plant();
            bench.ask("");
            let options = gcode::WriteOptions { feed_mm_s: planner.speed_mm_s, ..Default::default() };
            let mut writer = gcode::Writer::with_options(String::new(), options);
            for op in drawing.ops {
                writer.push(op).unwrap();
            }
            let text = writer.finish().unwrap();
            stream(&mut bench, &text);
            assert_true(&bench);
            let seconds = bench.made.last().unwrap().at.as_secs_f64();
            println!("{} at {draw_hz} pulses/s: {} steps, {seconds:.1} s", drawing.name, bench.made.len());
        }
    }
    // The same motor, from rest to 10,000 pulses/s at once.
    let mut motor = StepperAxis::new(StepperSettings::default());
    for step in 1..=2_000 {
        motor.pulse(Duration::from_secs(1) * step / 10_000, Direction::Plus);
    }
    motor.settle();
    assert!(motor.lost_steps() > 1_000, "{}", motor.lost_steps());
}
