//! Bad input of the line followers: each ends in a state that says what and where, within a bound, inside of
//! the machine's area.
#![allow(clippy::cast_possible_truncation, reason = "small numbers, and bytes of noise")]

use crate::law_cases::cases;
use plotter_vector::follow::{
    End, LineFollower, Lost, MappingFollower, MappingSettings, Paper, PublishedFollower, PublishedSettings,
    SimulatedCamera, Step,
};
use plotter_vector::{Gray, PxPoint};
use proptest::prelude::*;

/// Windows after which a run is stopped by ours.
const MOST_WINDOWS: u64 = 200;

/// Pictures in a row that may show no line: the default of both.
const TRIES: usize = 8;

fn area() -> [PxPoint; 2] {
    [PxPoint::new(10.0, 20.0), PxPoint::new(390.0, 280.0)]
}

/// Ours, the published one, and the published one with joined exits only.
fn followers() -> [(&'static str, Box<dyn LineFollower>); 3] {
    let area = Some(area());
    let ours = MappingSettings::default().with_area(area).with_max_windows(MOST_WINDOWS);
    let published = PublishedSettings::for_lines(4).with_area(area);
    let connected = published.with_only_connected(true);
    [
        ("ours", Box::new(MappingFollower::new(ours))),
        ("published", Box::new(PublishedFollower::new(published))),
        ("connected", Box::new(PublishedFollower::new(connected))),
    ]
}

/// What came of a run on an exact table.
struct Run {
    end: Option<End>,
    lost: Vec<Lost>,
    way_px: f64,
    at: PxPoint,
}

/// Shows window after window, and asserts that no move leaves the area.
fn run(
    follower: &mut dyn LineFollower,
    start: PxPoint,
    mut window: impl FnMut(usize, PxPoint) -> Gray,
) -> Run {
    let [from, to] = area();
    let mut run = Run { end: None, lost: Vec::new(), way_px: 0.0, at: start };
    for index in 0..MOST_WINDOWS as usize + 2 {
        match follower.observe(&window(index, run.at), run.at) {
            Step::Move { path, .. } => {
                assert!(path.len() < 10_000, "{} places", path.len());
                for place in path {
                    // A command may be rounded by less than a pixel's thousandth.
                    let inside = (from.x - 1e-3..=to.x + 1e-3).contains(&place.x)
                        && (from.y - 1e-3..=to.y + 1e-3).contains(&place.y);
                    assert!(inside, "{place:?} is outside");
                    run.way_px += run.at.distance(place);
                    run.at = place;
                }
            }
            Step::LineLost { at, tries, why } => {
                assert_eq!(at, run.at);
                assert!((1..=TRIES as u32).contains(&tries));
                run.lost.push(why);
            }
            Step::Done(end) => {
                assert_eq!(follower.observe(&window(index, run.at), run.at), Step::Done(end), "it stays so");
                run.end = Some(end);
                break;
            }
        }
    }
    run
}

fn one_colour(side: u32, level: u8) -> Gray {
    Gray::new(side, side, vec![level; (side * side) as usize]).unwrap()
}

/// A camera over a drawing, without blur and noise.
fn camera(strokes: &[(Vec<PxPoint>, f64)], window_px: u32) -> SimulatedCamera {
    let settings = plotter_vector::follow::CameraSettings::default()
        .with_width_px(window_px)
        .with_height_px(window_px)
        .with_blur_px(0.7)
        .with_noise_levels(1.0)
        .with_rim_light(1.0);
    SimulatedCamera::new(&Paper::drawn(400, 300, strokes).unwrap(), settings)
}

fn level_line(y: f64, pen_px: f64) -> (Vec<PxPoint>, f64) {
    (vec![PxPoint::new(40.0, y), PxPoint::new(360.0, y)], pen_px)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn no_line_in_view_is_retried_and_told_with_its_place() {
    for level in [0, 128, 255] {
        for (name, mut follower) in followers() {
            let start = PxPoint::new(200.0, 150.0);
            let run = run(follower.as_mut(), start, |_, _| one_colour(120, level));
            let Some(End::NoLine { at, why }) = run.end else { panic!("{name}, {level}: {:?}", run.end) };
            assert_eq!(at, run.at, "{name}, {level}");
            // Black may be a covered lens, or ink all over.
            let told = why == Lost::OneColour || (level == 0 && why == Lost::TooThick);
            assert!(told, "{name}, {level}: {why:?}");
            if name != "ours" {
                // Ours first looks elsewhere in the area.
                assert_eq!(run.lost, [Lost::OneColour; TRIES], "{name}, {level}");
            }
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn white_paper_under_a_light_that_falls_off_has_no_line() {
    for size in [120, 140, 200, 300] {
        // Blur, noise, and light that falls to 60 %.
        let settings =
            plotter_vector::follow::CameraSettings::default().with_width_px(size).with_height_px(size);
        let mut camera = SimulatedCamera::new(&Paper::drawn(400, 300, &[]).unwrap(), settings);
        let ours = MappingSettings::default().with_area(Some(area()));
        let mut follower = MappingFollower::new(ours);
        let run = run(&mut follower, PxPoint::new(200.0, 150.0), |_, at| camera.window(at));
        assert!(matches!(run.end, Some(End::NoLine { .. })), "{size}: {:?} {:?}", run.end, follower.report());
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_lost_on_the_way_is_told_and_found_again() {
    for (name, mut follower) in followers() {
        let mut camera = camera(&[level_line(150.0, 5.0)], 120);
        let start = PxPoint::new(60.0, 150.0);
        // The paper is gone in windows 12 to 15 and comes back.
        let gone = 12..16;
        let mut seen = 0;
        let mut shown = |index: usize, at: PxPoint| {
            seen = index;
            if gone.contains(&index) { one_colour(120, 230) } else { camera.window(at) }
        };
        let found = run(follower.as_mut(), start, &mut shown);
        assert_eq!(found.lost, [Lost::OneColour; 4], "{name}: {:?}", found.end);
        assert!(found.way_px > 250.0 && seen > 16, "{name}: it goes on: {}", found.way_px);
    }
    for (name, mut follower) in followers() {
        let mut camera = camera(&[level_line(150.0, 5.0)], 120);
        let start = PxPoint::new(60.0, 150.0);
        let lost =
            run(
                follower.as_mut(),
                start,
                |index, at| {
                    if index >= 12 { one_colour(120, 230) } else { camera.window(at) }
                },
            );
        assert_eq!(lost.lost, [Lost::OneColour; TRIES], "{name}");
        assert_eq!(lost.end, Some(End::NoLine { at: lost.at, why: Lost::OneColour }), "{name}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_line_too_thick_for_the_window_is_told() {
    // 150 px of ink in a window of 100.
    for y in [150.0, 212.0] {
        for (name, mut follower) in followers() {
            let mut camera = camera(&[level_line(150.0, 150.0)], 100);
            let run = run(follower.as_mut(), PxPoint::new(200.0, y), |_, at| camera.window(at));
            let Some(End::NoLine { why, .. }) = run.end else {
                // The published one may walk along an edge that it sees.
                assert!(name != "ours" && y > 150.0, "{name}, {y}: {:?}", run.end);
                continue;
            };
            assert!(matches!(why, Lost::TooThick | Lost::OneColour), "{name}, {y}: {why:?}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_filled_area_is_no_line() {
    let square: Vec<_> = (0..40).map(|i| level_line(100.0 + 3.0 * f64::from(i), 4.0)).collect();
    for (name, mut follower) in followers() {
        let mut camera = camera(&square, 100);
        let run = run(follower.as_mut(), PxPoint::new(200.0, 150.0), |_, at| camera.window(at));
        let Some(End::NoLine { why, .. }) = run.end else { panic!("{name}: {:?}", run.end) };
        assert!(matches!(why, Lost::TooThick | Lost::OneColour), "{name}: {why:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_filled_area_does_not_hide_the_lines_beside_it() {
    let mut strokes: Vec<_> = (0..30)
        .map(|i| {
            (
                vec![
                    PxPoint::new(40.0, 60.0 + 3.0 * f64::from(i)),
                    PxPoint::new(160.0, 60.0 + 3.0 * f64::from(i)),
                ],
                4.0,
            )
        })
        .collect();
    let line = vec![PxPoint::new(220.0, 60.0), PxPoint::new(340.0, 240.0)];
    strokes.push((line.clone(), 4.0));
    let mut camera = camera(&strokes, 120);
    let settings = MappingSettings::default().with_area(Some(area())).with_max_windows(4000);
    let mut follower = MappingFollower::new(settings);
    let mut at = PxPoint::new(300.0, 150.0);
    let end = loop {
        match follower.observe(&camera.window(at), at) {
            Step::Move { path, .. } => at = path.last().copied().unwrap_or(at),
            Step::LineLost { .. } => {}
            Step::Done(end) => break end,
        }
    };
    let report = follower.report();
    assert_eq!(end, End::Complete, "{report:?}");
    let inside = |at: &PxPoint| (30.0..170.0).contains(&at.x) && (50.0..160.0).contains(&at.y);
    assert!(!report.areas.is_empty() && report.areas.iter().all(inside), "{report:?}");
    let length = line[0].distance(line[1]);
    assert!(report.followed_px > 0.97 * length, "{report:?}");
}

#[test]
fn the_published_follower_turns_round_at_the_edge_of_the_area() {
    let settings = PublishedSettings::for_lines(5).with_area(Some(area()));
    let mut follower = PublishedFollower::new(settings);
    let mut camera = camera(&[(vec![PxPoint::new(-50.0, 150.0), PxPoint::new(450.0, 150.0)], 5.0)], 120);
    let run = run(&mut follower, PxPoint::new(200.0, 150.0), |_, at| camera.window(at));
    // To and fro between the edges, 380 px apart.
    assert!(run.end.is_none() && run.way_px > 4.0 * 380.0, "{:?} {}", run.end, run.way_px);
}

/// Any grey picture, among them thresholded noise of coarse grain, which has something like lines.
fn any_window() -> impl Strategy<Value = Gray> {
    (1_u32..90, 1_u32..90, 1_u32..8, any::<u64>(), 0_u8..4).prop_map(|(width, height, grain, seed, kind)| {
        let mut state = seed | 1;
        let mut next = || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 32) as u8
        };
        let columns = width.div_ceil(grain);
        let coarse: Vec<u8> = (0..columns * height.div_ceil(grain)).map(|_| next()).collect();
        let level = |x: u32, y: u32| {
            let level = coarse[(y / grain * columns + x / grain) as usize];
            match kind {
                0 => level,
                1 => {
                    if level < 90 {
                        0
                    } else {
                        255
                    }
                }
                2 => {
                    if level < 170 {
                        20
                    } else {
                        200
                    }
                }
                _ => 100 + level / 16,
            }
        };
        let levels =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| level(x, y)).collect();
        Gray::new(width, height, levels).unwrap()
    })
}

proptest! {
    #![proptest_config(cases(8))]

    /// Whatever the windows show, and of whatever size: ours ends within its limit, the published ones answer
    /// each, no move leaves the area, and every place is a number (which `run` asserts).
    #[test]
    fn any_windows_are_answered_inside_of_the_area(
        windows in prop::collection::vec(any_window(), 1..6),
        same_size in any::<bool>(),
        x in 10.0..390.0,
        y in 20.0..280.0,
    ) {
        for (name, mut follower) in followers() {
            let shown = |index: usize, _: PxPoint| {
                let count = if same_size { 1 } else { windows.len() };
                windows[index % count].clone()
            };
            let run = run(follower.as_mut(), PxPoint::new(x, y), shown);
            prop_assert!(run.end.is_some() || name != "ours", "{name}");
        }
    }
}
