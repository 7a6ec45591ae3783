//! Followers over drawings, under a camera that blurs and on a table that misses: the thesis' four kinds of
//! figure.

use crate::follow_figures;
use crate::sampled::sampled;

use follow_figures::{
    Figure, Run, WrongChoices, dense_with, figures, follow_figure, follow_published, mixed, polyline,
    sharper_tips, wrong_choices,
};
use plotter_vector::PxPoint;
use plotter_vector::follow::{CameraSettings, End, MappingSettings, TableError};

/// The table of the tests: 1 px of random error on the way of a window, 3 px of play.
fn table(seed: u64) -> TableError {
    TableError { random_px: 1.0, play_px: 3.0, seed }
}

fn settings(figure: &Figure) -> MappingSettings {
    let far = PxPoint::new(f64::from(figure.width), f64::from(figure.height));
    MappingSettings::default().with_area(Some([PxPoint::new(0.0, 0.0), far])).with_max_windows(20_000)
}

fn lap(figure: &Figure, error: TableError, seed: u64) -> Run {
    let start = PxPoint::new(300.0, 300.0);
    follow_figure(figure, start, CameraSettings::default().with_seed(seed), error, settings(figure))
}

/// A lap of a small figure, under a camera of 160 x 160 px.
fn small_lap(name: &'static str, lines: &[&[(f64, f64)]], pen_px: f64) -> Run {
    let lines = lines.iter().map(|line| polyline(line)).collect();
    let figure = Figure { name, width: 260, height: 210, lines, pen_px };
    let camera = CameraSettings::default().with_width_px(160).with_height_px(160);
    let run = follow_figure(&figure, PxPoint::new(120.0, 100.0), camera, table(3), settings(&figure));
    println!("{name}: {:?} {:?}", run.judged, run.report);
    assert_eq!(
        (run.end, wrong_choices(&figure, &run.strokes)),
        (End::Complete, WrongChoices::NONE),
        "{name}"
    );
    run
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_crossing_and_a_corner_are_followed_once() {
    let corner = [(40.3, 170.2), (110.7, 40.1), (180.4, 165.8)];
    let across = [(30.2, 100.4), (220.9, 110.3)];
    let run = small_lap("corner", &[&corner, &across], 4.0);
    assert!(run.judged.coverage > 0.98 && run.judged.rms_px < 0.4, "{:?}", run.judged);
    assert!(run.judged.repeated < 0.03 && run.report.lifts < 4, "{:?} {:?}", run.judged, run.report);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn tips_are_followed_to_and_fro() {
    let run = small_lap(
        "tips",
        &[&[(50.3, 170.2), (80.1, 40.4), (112.6, 168.3), (150.4, 42.2), (195.1, 165.9)]],
        5.0,
    );
    assert!(run.judged.coverage > 0.98 && run.judged.rms_px < 0.5, "{:?}", run.judged);
    assert!(run.judged.repeated < 0.05 && run.report.lifts < 4, "{:?} {:?}", run.judged, run.report);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn junctions_are_lifted_over_as_seldom_as_can_be() {
    let run = small_lap(
        "junctions",
        &[&[(40.2, 60.3), (220.4, 68.1)], &[(80.6, 40.1), (88.3, 170.5)], &[(150.2, 65.1), (140.7, 172.4)]],
        5.0,
    );
    // Six odd nodes, the ends and the foot of the tee: three strokes.
    assert!(run.judged.coverage > 0.99 && run.judged.rms_px < 0.4, "{:?}", run.judged);
    assert!(run.judged.repeated < 0.02 && run.report.lifts == 2, "{:?} {:?}", run.judged, run.report);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn dense_lines_are_followed_one_by_one() {
    // An end of them is seen at the start: a line of which none is in view is begun in its middle, and takes
    // a lift more.
    let rows: Vec<[(f64, f64); 2]> =
        (0..5).map(|i| 70.3 + 8.0 * f64::from(i)).map(|y| [(70.2, y), (190.4, y)]).collect();
    let lines: Vec<&[(f64, f64)]> = rows.iter().map(<[_; 2]>::as_slice).collect();
    let run = small_lap("dense", &lines, 4.0);
    assert!(run.judged.coverage > 0.99 && run.judged.rms_px < 0.4, "{:?}", run.judged);
    assert!(run.judged.repeated < 0.01 && run.report.lifts == 4, "{:?} {:?}", run.judged, run.report);
}

/// From an end that is some px behind the line it meets the tool goes back to where they meet, not slantwise
/// to what is ahead of that line.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn from_an_end_behind_another_line_the_tool_goes_back_to_where_they_meet() {
    let mut greatest = 0.0_f64;
    for behind_px in [5.0, 7.0, 9.0] {
        let lines = vec![
            polyline(&[(130.6 - behind_px, 100.4), (245.2, 96.4)]),
            polyline(&[(132.5, 10.4), (128.6, 198.6)]),
        ];
        let figure = Figure { name: "end behind", width: 260, height: 210, lines, pen_px: 5.0 };
        let camera = CameraSettings::default().with_width_px(160).with_height_px(160);
        let start = PxPoint::new(245.0, 97.0);
        let run = follow_figure(&figure, start, camera, TableError::default(), settings(&figure));
        println!("{:?} {:?}", run.judged, run.report.lifts);
        assert!(run.end == End::Complete && run.judged.coverage > 0.999, "{:?}", run.judged);
        greatest = greatest.max(run.judged.max_px);
    }
    assert!(greatest < 0.3, "{greatest}");
}

/// A table that has gone astray is at its limits before the line is: the tool does not leave the line there.
#[test]
#[ignore = "long: .ci/run has it in release"]
fn at_the_limits_of_the_machine_the_tool_stays_on_the_line() {
    let (mut greatest, mut leaves) = (0.0_f64, 0);
    for seed in 0..2 {
        let lines =
            vec![polyline(&[(430.3, 290.2), (-4.2, 120.6)]), polyline(&[(430.3, 90.7), (-4.6, 230.4)])];
        let figure = Figure { name: "limits", width: 460, height: 340, lines, pen_px: 4.0 };
        let camera = CameraSettings::default().with_width_px(160).with_height_px(160).with_seed(seed);
        let error = TableError { random_px: 4.0, play_px: 3.0, seed };
        let run = follow_figure(&figure, PxPoint::new(230.0, 180.0), camera, error, settings(&figure));
        println!("{:?} {:?} {:?}", run.end, run.judged, run.report);
        greatest = greatest.max(run.judged.max_px);
        leaves += run.report.leaves.len();
    }
    assert!(greatest < 4.0 && leaves > 0, "{greatest} {leaves}");
}

/// Along bare walls windows do not tell how far the camera went, and the table misses 3 px on the way round:
/// where the way meets its beginning all that was seen is settled anew, and the tool is on the lines, too,
/// that are followed later.
#[test]
#[ignore = "long: .ci/run has it in release"]
fn a_way_round_bare_walls_comes_back_to_its_beginning() {
    let lines = vec![
        polyline(&[(60.3, 60.2), (660.4, 60.2), (660.4, 460.7), (60.3, 460.7), (60.3, 60.2)]),
        polyline(&[(60.3, 260.3), (260.2, 260.3), (260.2, 200.6)]),
        polyline(&[(340.6, 260.3), (660.4, 260.3)]),
        polyline(&[(560.2, 360.4), (560.2, 460.7)]),
    ];
    let figure = Figure { name: "rooms", width: 720, height: 520, lines, pen_px: 5.0 };
    let mut greatest = 0.0_f64;
    for seed in 0..2 {
        let camera = CameraSettings::default().with_width_px(160).with_height_px(160).with_seed(seed);
        let error = TableError { random_px: 1.5, play_px: 3.0, seed };
        let run = follow_figure(&figure, PxPoint::new(260.0, 230.0), camera, error, settings(&figure));
        println!("{:?} {:?} {:?}", run.end, run.judged, run.report);
        assert!(run.end == End::Complete && run.judged.coverage > 0.9999, "{seed}: {:?}", run.judged);
        greatest = greatest.max(run.judged.max_px);
    }
    assert!(greatest < 1.0, "{greatest}");
}

/// 1 px between lines is nothing under 1.5 px of blur, and no window shows where they end: no look for that
/// goes on for ever.
#[test]
#[ignore = "long: .ci/run has it in release"]
fn lines_that_are_one_under_the_blur_come_to_an_end() {
    let rows: Vec<_> = (0..6)
        .map(|i| 120.3 + 5.0 * f64::from(i))
        .map(|y| polyline(&[(110.2, y), (350.7, y + 18.0)]))
        .collect();
    let figure = Figure { name: "one", width: 460, height: 340, lines: rows, pen_px: 4.0 };
    for (seed, error) in [(1, TableError::default()), (2, table(2))] {
        let camera = CameraSettings::default().with_width_px(240).with_height_px(240).with_seed(seed);
        let run = follow_figure(&figure, figure.lines[0][0], camera, error, settings(&figure));
        println!("{:?} {:?} {:?}", run.end, run.report, run.judged);
        assert!(run.report.windows < 4000, "{:?} {:?}", run.end, run.report);
    }
}

#[test]
#[ignore = "three laps of each figure, a minute in release: .ci/run runs it"]
fn every_figure_is_covered_without_a_wrong_choice() {
    let figures = figures();
    let laps = figures.iter().zip([3, 1, 10, 13]).flat_map(|lifted| [0, 1, 2].map(|seed| (lifted, seed)));
    for ((figure, most_lifts), seed) in sampled(laps) {
        let run = lap(figure, table(seed), seed);
        let name = format!("{} {seed}", figure.name);
        println!("{name}: {:?} {:?}", run.judged, run.report);
        assert_eq!(
            (run.end, wrong_choices(figure, &run.strokes)),
            (End::Complete, WrongChoices::NONE),
            "{name}"
        );
        assert!(run.judged.coverage > 0.995 && run.judged.rms_px < 0.25, "{name}: {:?}", run.judged);
        assert!(run.judged.max_px < 1.0, "{name}: {:?}", run.judged);
        assert!(run.judged.repeated < 0.02, "{name}: {:?}", run.judged);
        assert!(run.report.lifts <= most_lifts, "{name}: {:?}", run.report);
    }
}

#[test]
#[ignore = "a lap of each figure, a quarter of a minute in release: .ci/run runs it"]
fn an_exact_table_leaves_what_the_picture_leaves() {
    for figure in sampled(figures()) {
        let run = lap(&figure, TableError::default(), 1);
        let name = figure.name;
        println!("{name}: {:?} {:?}", run.judged, run.report);
        assert_eq!((run.end, run.lost), (End::Complete, 0), "{name}");
        assert!(run.judged.coverage > 0.995 && run.judged.rms_px < 0.12, "{name}: {:?}", run.judged);
        assert!(run.judged.max_px < 1.0, "{name}: {:?}", run.judged);
        assert_eq!(wrong_choices(&figure, &run.strokes), WrongChoices::NONE, "{name}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_published_follower_is_never_right_on_dense_lines() {
    let [_, _, _, dense] = figures();
    let start = PxPoint::new(90.0, 80.3);
    let strokes = follow_published(&dense, start, CameraSettings::default(), table(1), 1.0);
    let wrong = wrong_choices(&dense, &strokes);
    assert!(wrong.count() > 5, "{wrong:?}");
}

/// Laps of each figure: the table of `docs/results/line-following.md`. `SEEDS=from..to` are the laps,
/// `FIGURE` is a figure's name; each lap is a line, so that a run can be split, stopped and gone on with.
#[test]
#[ignore = "minutes in release: SEEDS=0..3 cargo test --release -p plotter-vector --test all sim_follow::laps -- --ignored --nocapture"]
fn laps_of_the_four_figures() {
    let seeds = std::env::var("SEEDS").unwrap_or_else(|_| "0..3".to_owned());
    let (from, to) = seeds.split_once("..").unwrap();
    let only = std::env::var("FIGURE").unwrap_or_default();
    println!("| figure, lap | wrong | coverage | twice | rms | greatest | lifts | windows | end |");
    // Beyond the four figures nothing is promised but an end.
    let more = [dense_with(4.0, 4.0, true), sharper_tips(), mixed()].map(|figure| (figure, false));
    let all = figures().map(|figure| (figure, true)).into_iter().chain(more);
    for (figure, is_promised) in
        &all.filter(|(figure, _)| only.is_empty() || figure.name == only).collect::<Vec<_>>()
    {
        for seed in from.parse::<u64>().unwrap()..to.parse().unwrap() {
            let run = lap(figure, table(seed), seed);
            let wrong = wrong_choices(figure, &run.strokes);
            println!("| {} {seed} | {}, {} | {}", figure.name, wrong.shortcuts, wrong.turns, run.cells());
            assert_eq!(run.end, End::Complete, "{} {seed}", figure.name);
            let is_good =
                wrong == WrongChoices::NONE && run.judged.coverage > 0.9999 && run.judged.rms_px <= 0.5;
            assert!(!is_promised || is_good, "{} {seed}", figure.name);
        }
    }
}

/// The published follower on the same laps.
#[test]
#[ignore = "a minute in release, prints wrong choices: SEEDS=0..10 cargo test --release -p plotter-vector --test all sim_follow::published_laps -- --ignored --nocapture"]
fn published_laps() {
    let seeds = std::env::var("SEEDS").unwrap_or_else(|_| "0..3".to_owned());
    let (from, to) = seeds.split_once("..").unwrap();
    for figure in figures() {
        let mut all = WrongChoices::default();
        for seed in from.parse::<u64>().unwrap()..to.parse().unwrap() {
            let camera = CameraSettings::default().with_seed(seed);
            let strokes = follow_published(&figure, figure.lines[0][0], camera, table(seed), 1.0);
            let wrong = wrong_choices(&figure, &strokes);
            all.shortcuts += wrong.shortcuts;
            all.turns += wrong.turns;
        }
        println!("| {} | {} shortcuts, {} turned back |", figure.name, all.shortcuts, all.turns);
        // Corners have one way on: there is nothing to choose wrongly.
        assert!(figure.name == "corners" || all.count() > 0, "{}", figure.name);
    }
}
