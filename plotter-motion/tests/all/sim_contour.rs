//! The published controller and ours on the same simulated gantry, line by line.
//!
//! `cargo test --release -p plotter-motion --test all sim_contour:: -- --nocapture` prints the tables of
//! docs/results/line-control.md.

use crate::closed_loop;
use crate::figure::Figure;
use crate::papers;

use closed_loop::{LineResult, Loop, draw_line, machine};
use core::time::Duration;
use papers::{assert_in, row_of};
use plotter_motion::{
    MachineConfig, StepPoint,
    config::{ControllerChoice, Decoding, EncoderConfig, LoadConfig},
    toolpath::from_mm,
};

const LENGTH_COUNTS: f64 = 2400.0; // 60 mm
/// All quadrants, flat, steep and vertical.
const HEADINGS_DEG: [f64; 8] = [0.0, 30.0, 75.0, 90.0, 135.0, 195.0, 250.0, 315.0];
const LIMIT: Duration = Duration::from_secs(5);

fn target(heading_deg: f64) -> StepPoint {
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    StepPoint::new(from_mm(LENGTH_COUNTS * cos, 1.0), from_mm(LENGTH_COUNTS * sin, 1.0))
}

/// The lines of all headings by the controller of `config` on the motors of `plant`, as a table.
fn run(name: &str, config: &MachineConfig, plant: &MachineConfig, headings: &[f64]) -> Vec<LineResult> {
    println!(
        "\n{name}\n| heading | rms mm  | max mm  | arrived | settled | off target mm | count drift mm |"
    );
    println!("|---------|---------|---------|---------|---------|---------------|----------------|");
    let seconds = |s: Option<f64>| s.map_or("never".into(), |s| format!("{s:.2} s"));
    let lines = headings.iter().map(|&heading| {
        let r = draw_line(Loop::new(config, plant), target(heading), LIMIT, |_| ());
        let (arrived, settled) = (seconds(r.arrived_s), seconds(r.settled_s));
        println!(
            "| {heading:5}° | {:7.5} | {:7.4} | {arrived:>7} | {settled:>7} | {:13.4} | {:14.4} |",
            r.rms_mm(),
            r.max_mm,
            r.short_mm,
            r.drift_mm
        );
        r
    });
    let lines: Vec<_> = lines.collect();
    println!("rms of all lines: {:.5} mm", total_rms_mm(&lines));
    lines
}

fn total_rms_mm(lines: &[LineResult]) -> f64 {
    let square: f64 = lines.iter().map(|r| r.square_mm2).sum();
    (square / lines.iter().map(|r| f64::from(r.samples)).sum::<f64>()).sqrt()
}

static FARTHEST: Figure = Figure::of("mm at most");

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ours_has_less_than_a_hundredth_of_the_published_contour_error() {
    const TIMES_BETTER: f64 = 100.0;
    /// A tenth of an encoder count.
    const EVERY_LINE_MM: f64 = 0.0025;
    let (published, ours) = (machine(ControllerChoice::Published), machine(ControllerChoice::Contouring));
    let theirs = run("published, x1", &published, &published, &HEADINGS_DEG);
    let own = run("contouring, x1", &ours, &ours, &HEADINGS_DEG);
    let ratio = total_rms_mm(&theirs) / total_rms_mm(&own);
    println!("published / contouring: {ratio:.0}");
    Figure::of("times better").note(ratio);
    assert!(ratio >= TIMES_BETTER, "{ratio}");
    let shown = [format!("{:.4} mm", total_rms_mm(&theirs)), format!("{:.5} mm", total_rms_mm(&own))];
    assert_in("README.md", "eight lines of 60 mm: distance from the line, rms", &shown);
    for line in &own {
        assert!(line.arrived_s.is_some() && line.settled_s.is_some(), "{line:?}");
        FARTHEST.note(line.max_mm.max(line.drift_mm));
        assert!(line.max_mm <= EVERY_LINE_MM && line.drift_mm <= EVERY_LINE_MM, "{line:?}");
    }
    // and it is not bought with time
    let time =
        |lines: &[LineResult]| lines.iter().map(|r| r.arrived_s.unwrap_or(LIMIT.as_secs_f64())).sum::<f64>();
    println!("time: published {:.2} s, contouring {:.2} s", time(&theirs), time(&own));
    assert!(time(&own) <= 1.2 * time(&theirs));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn steep_and_vertical_lines_are_as_good_as_flat_ones() {
    const AS_GOOD: f64 = 2.0;
    let ours = machine(ControllerChoice::Contouring);
    let max = |headings: &[f64]| {
        run("contouring", &ours, &ours, headings).iter().map(|r| r.max_mm).fold(0.0, f64::max)
    };
    let (flat, steep) = (max(&[2.0, 5.0, 10.0, 20.0]), max(&[88.0, 85.0, 80.0, 70.0, 90.0]));
    assert!(steep <= AS_GOOD * flat, "steep {steep} mm, flat {flat} mm");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_rule_never_ends_on_steep_lines_with_unloaded_motors_and_ours_does() {
    /// Which of the steep lines never end depends on the last bit of the start: look at many.
    const STEEP_DEG: [f64; 15] =
        [46.0, 49.0, 52.0, 55.0, 58.0, 61.0, 64.0, 67.0, 70.0, 73.0, 76.0, 79.0, 82.0, 85.0, 88.0];
    const STUCK_MM: f64 = 0.5;
    let unloaded = |choice| {
        let mut config = machine(choice);
        let dc = config.dc_mut().unwrap();
        for axis in [&mut dc.x, &mut dc.y] {
            axis.load =
                LoadConfig { inertia_kg_m2: 0.0, coulomb_n_m: 0.0, static_n_m: 0.0, viscous_n_m_s: 0.0 };
        }
        config
    };
    let (published, ours) = (unloaded(ControllerChoice::Published), unloaded(ControllerChoice::Contouring));
    let theirs = run("published, unloaded", &published, &published, &STEEP_DEG);
    let own = run("contouring, unloaded", &ours, &ours, &STEEP_DEG);
    let stuck = theirs.iter().filter(|r| r.arrived_s.is_none() && r.short_mm > STUCK_MM).count();
    println!("published: {stuck} of {} never end", theirs.len());
    assert!(stuck >= 1, "{theirs:?}");
    if let Some(row) = row_of("README.md", "steep lines, unloaded motors") {
        assert_eq!((stuck, row[1].as_str()), (2, "two of 15 never end"));
    }
    assert!(own.iter().all(|r| r.arrived_s.is_some() && r.short_mm < closed_loop::SETTLED_MM), "{own:?}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn x2_and_x4_encoders_of_as_much_fewer_lines_do_as_well() {
    /// A tenth of an encoder count.
    const EVERY_LINE_MM: f64 = 0.0025;
    for (name, lines_per_turn, decoding) in
        [("contouring, x2", 250, Decoding::X2), ("contouring, x4", 125, Decoding::X4)]
    {
        let mut ours = machine(ControllerChoice::Contouring);
        let dc = ours.dc_mut().unwrap();
        for axis in [&mut dc.x, &mut dc.y] {
            axis.encoder = EncoderConfig { lines_per_turn, decoding };
        }
        for line in &run(name, &ours, &ours, &HEADINGS_DEG) {
            assert!(line.arrived_s.is_some() && line.max_mm <= EVERY_LINE_MM, "{name}: {line:?}");
            assert!(line.drift_mm <= EVERY_LINE_MM, "{name}: {line:?}");
        }
    }
}

/// The controller knows the machine from its description only; real motors differ.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_motor_that_differs_from_its_description_stays_within_its_counts() {
    for (share, allowed_max_mm) in [(0.1, 0.05), (0.3, 0.1)] {
        let ours = machine(ControllerChoice::Contouring);
        let mut plant = ours;
        // x heavier, rougher and weaker, y lighter, smoother and stronger, and a flat battery for both
        let dc = plant.dc_mut().unwrap();
        for (axis, sign) in [(&mut dc.x, share), (&mut dc.y, -share)] {
            axis.load.coulomb_n_m *= 1.0 + 2.0 * sign;
            axis.load.static_n_m *= 1.0 + 2.0 * sign;
            axis.load.inertia_kg_m2 = 0.0;
            axis.motor.inertia_kg_m2 *= 1.0 + sign;
            axis.motor.resistance_ohm *= 1.0 + 0.5 * sign;
            axis.motor.supply_v *= 1.0 - 0.3 * share;
        }
        let lines = run(&format!("contouring, motors {share} off"), &ours, &plant, &HEADINGS_DEG);
        let published = machine(ControllerChoice::Published);
        let theirs = run(&format!("published, motors {share} off"), &published, &plant, &HEADINGS_DEG);
        println!("published / contouring: {:.1}", total_rms_mm(&theirs) / total_rms_mm(&lines));
        assert!(total_rms_mm(&lines) < total_rms_mm(&theirs));
        if share == 0.1 {
            let shown = [&theirs, &lines].map(|lines| format!("{:.4} mm", total_rms_mm(lines)));
            assert_in("README.md", "the same, motors 10 % off their description", &shown);
        }
        for line in &lines {
            assert!(line.arrived_s.is_some() && line.max_mm <= allowed_max_mm, "{line:?}");
            assert!(line.drift_mm <= 0.025, "{line:?}"); // less than a count: none was miscounted
        }
    }
}
