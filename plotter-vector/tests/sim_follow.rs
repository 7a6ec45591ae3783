//! Followers over drawings, under a camera that blurs and on a table that misses: the thesis' four kinds of figure.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test prints its table")]

mod follow_figures;

use follow_figures::{Figure, Run, dense_with, figures, ours, polyline, published, wrong_choices};
use plotter_vector::PxPoint;
use plotter_vector::follow::{CameraSettings, End, MappingSettings, TableError};

/// The table of the tests: 1 px of random error on the way of a window, 3 px of play.
fn table(seed: u64) -> TableError {
    TableError { random_px: 1.0, play_px: 3.0, seed }
}

fn settings(figure: &Figure) -> MappingSettings {
    let far = PxPoint::new(f64::from(figure.width), f64::from(figure.height));
    MappingSettings {
        area: Some([PxPoint::new(0.0, 0.0), far]),
        max_windows: 20_000,
        ..MappingSettings::default()
    }
}

fn lap(figure: &Figure, error: TableError, seed: u64) -> Run {
    let start = PxPoint::new(300.0, 300.0);
    ours(figure, start, CameraSettings { seed, ..CameraSettings::default() }, error, settings(figure))
}

#[test]
fn a_crossing_and_a_corner_are_followed_once() {
    let corner = polyline(&[(40.3, 170.2), (110.7, 40.1), (180.4, 165.8)]);
    let across = polyline(&[(30.2, 100.4), (220.9, 110.3)]);
    let figure = Figure { name: "small", width: 260, height: 210, lines: vec![corner, across], pen_px: 4.0 };
    let camera = CameraSettings { width_px: 160, height_px: 160, ..CameraSettings::default() };
    let run = ours(&figure, PxPoint::new(120.0, 100.0), camera, table(3), settings(&figure));
    println!("{:?} {:?}", run.judged, run.report);
    assert_eq!((run.end, wrong_choices(&figure, &run.strokes)), (End::Complete, (0, 0)));
    assert!(run.judged.coverage > 0.97 && run.judged.rms_px < 0.6, "{:?}", run.judged);
    assert!(run.judged.repeated < 0.05 && run.report.lifts < 5, "{:?} {:?}", run.judged, run.report);
}

#[test]
#[ignore = "half a minute in release"]
fn every_figure_is_covered_without_a_wrong_choice() {
    for figure in figures().iter().take(3) {
        let run = lap(figure, table(1), 1);
        let (shortcuts, turns) = wrong_choices(figure, &run.strokes);
        let name = figure.name;
        println!("{name}: {:?} {:?} {shortcuts} {turns}", run.judged, run.report);
        assert_eq!((run.end, shortcuts, turns), (End::Complete, 0, 0), "{name}");
        assert!(run.judged.coverage > 0.99, "{name}: {:?}", run.judged);
        assert!(run.judged.rms_px < 0.5, "{name}: {:?}", run.judged);
        assert!(run.judged.repeated < 0.03, "{name}: {:?}", run.judged);
    }
}

#[test]
#[ignore = "half a minute in release"]
fn an_exact_table_leaves_what_the_picture_leaves() {
    for figure in figures() {
        let run = lap(&figure, TableError::default(), 1);
        let name = figure.name;
        println!("{name}: {:?} {:?}", run.judged, run.report);
        assert_eq!((run.end, run.lost), (End::Complete, 0), "{name}");
        assert!(run.judged.coverage > 0.995 && run.judged.rms_px < 0.25, "{name}: {:?}", run.judged);
        assert_eq!(wrong_choices(&figure, &run.strokes), (0, 0), "{name}");
    }
}

#[test]
fn the_published_follower_is_never_right_on_dense_lines() {
    let [_, _, _, dense] = figures();
    let start = PxPoint::new(90.0, 80.3);
    let strokes = published(&dense, start, CameraSettings::default(), table(1), 1.0);
    let (shortcuts, turns) = wrong_choices(&dense, &strokes);
    assert!(shortcuts + turns > 5, "{shortcuts} {turns}");
}

/// Laps of each figure: the table of `docs/results.md`.
#[test]
#[ignore = "two minutes in release"]
fn laps_of_the_four_figures() {
    let laps: u64 = std::env::var("LAPS").map_or(10, |laps| laps.parse().unwrap());
    println!(
        "| figure | published: shortcuts, turned back | ours | coverage | twice | rms | greatest | lifts |"
    );
    for figure in figures() {
        let first = figure.lines[0][0];
        let (mut theirs, mut own) = ((0, 0), (0, 0));
        let (mut coverage, mut repeated, mut squares, mut most, mut lifts, mut wrong_laps, mut complete) =
            (1.0_f64, 0.0_f64, 0.0, 0.0_f64, 0, 0, 0);
        for seed in 0..laps {
            let camera = CameraSettings { seed, ..CameraSettings::default() };
            let wrong = wrong_choices(&figure, &published(&figure, first, camera, table(seed), 1.0));
            theirs = (theirs.0 + wrong.0, theirs.1 + wrong.1);
            let run = lap(&figure, table(seed), seed);
            let wrong = wrong_choices(&figure, &run.strokes);
            own = (own.0 + wrong.0, own.1 + wrong.1);
            wrong_laps += u32::from(wrong != (0, 0));
            complete += u32::from(run.end == End::Complete);
            coverage = coverage.min(run.judged.coverage);
            repeated = repeated.max(run.judged.repeated);
            squares += run.judged.rms_px * run.judged.rms_px;
            most = most.max(run.judged.max_px);
            lifts += run.report.lifts;
        }
        println!(
            "| {} | {}, {} | {}, {} in {wrong_laps} of {laps} laps, {complete} complete | {coverage:.4} | {repeated:.3} | {:.3} | {most:.2} | {:.1} |",
            figure.name,
            theirs.0,
            theirs.1,
            own.0,
            own.1,
            (squares / laps as f64).sqrt(),
            lifts as f64 / laps as f64
        );
    }
}

/// Where it still works: one thing changed at a time.
#[test]
#[ignore = "two minutes in release"]
fn where_it_still_works() {
    let said = |name: String, figure: &Figure, camera: CameraSettings, error: TableError| {
        let run = ours(figure, PxPoint::new(200.0, 200.0), camera, error, settings(figure));
        let judged = run.judged;
        println!(
            "| {name} | {:.4} | {:.3} | {:.2} | {:.2} | {} | {:?} |",
            judged.coverage, judged.repeated, judged.rms_px, judged.max_px, run.report.lifts, run.end
        );
    };
    println!("| | coverage | twice | rms | greatest | lifts | end |");
    let [_, _, junctions, _] = figures();
    for blur in 0..=4 {
        let camera = CameraSettings { blur_px: f64::from(blur), ..CameraSettings::default() };
        said(format!("blur {blur} px"), &junctions, camera, table(1));
    }
    for noise in [0, 5, 10, 20, 40] {
        let camera = CameraSettings { noise_levels: f64::from(noise), ..CameraSettings::default() };
        said(format!("noise {noise} levels"), &junctions, camera, table(1));
    }
    for pen in [1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 16.0, 20.0] {
        let figure = Figure { pen_px: pen, ..junctions.clone() };
        said(format!("line {pen} px"), &figure, CameraSettings::default(), table(1));
    }
    for error in 0..=6 {
        let error = f64::from(error);
        let table = TableError { random_px: error, play_px: error, seed: 1 };
        said(format!("table {error} px"), &junctions, CameraSettings::default(), table);
    }
    for gap in [1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0] {
        said(
            format!("gap {gap} px, exact table"),
            &dense_with(4.0, gap),
            CameraSettings::default(),
            TableError::default(),
        );
        said(format!("gap {gap} px"), &dense_with(4.0, gap), CameraSettings::default(), table(1));
    }
}
