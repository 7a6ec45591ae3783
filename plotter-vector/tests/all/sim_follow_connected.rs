//! The thesis' own idea for lines close together, never built there: only exits that are joined to the
//! current place count.

use plotter_vector::PxPoint;
use plotter_vector::follow::{
    CameraSettings, LineFollower, Paper, PublishedFollower, PublishedSettings, Route, SimulatedCamera,
    SimulatedTable, Step, TableError,
};

/// Windows of a run: each takes the follower on by about 100 px, so it passes its line some twenty times.
const WINDOWS: usize = 60;

/// A window that moves the camera by less, px, was of no use: at an end, where it turns round, that may be.
const IDLE_PX: f64 = 10.0;

/// Twelve lines from left to right, 300 px long.
fn hatching(pen_px: f64, gap_px: f64) -> Vec<Vec<PxPoint>> {
    let row = |i: i32| 60.3 + (pen_px + gap_px) * f64::from(i);
    (0..12).map(|i| vec![PxPoint::new(80.0, row(i)), PxPoint::new(380.0, row(i) + 20.0)]).collect()
}

/// How often the tool goes over to another line, and how many windows were of no use: with an exact table.
fn jumps(pen_px: f64, gap_px: f64, only_connected: bool) -> (usize, usize) {
    let lines = hatching(pen_px, gap_px);
    let strokes: Vec<_> = lines.iter().map(|line| (line.clone(), pen_px)).collect();
    let paper = Paper::drawn(460, 400, &strokes).unwrap();
    let mut camera = SimulatedCamera::new(&paper, CameraSettings::default());
    // On the sixth line: lines on both sides.
    let mut table = SimulatedTable::new(lines[5][0], TableError::default());
    // Lines of 4 px are 3 px wide where the blur is cut at level 100; runs of 3 must then stay.
    let settings = PublishedSettings::default().with_only_connected(only_connected).with_min_run(3);
    let mut follower = PublishedFollower::new(settings);
    let mut idle = 0;
    for _ in 0..WINDOWS {
        let at = table.place();
        if let Step::Move { path, tool } = follower.observe(&camera.window(at), table.commanded()) {
            path.into_iter().for_each(|to| table.go(to, tool));
        }
        idle += usize::from(at.distance(table.place()) < IDLE_PX);
    }
    let route = Route::of(&lines);
    let places = table.strokes().concat();
    let on: Vec<usize> =
        places.into_iter().filter_map(|at| route.nearest(at, 64.0)).map(|(_, line, _)| line).collect();
    (on.windows(2).filter(|pair| pair[0] != pair[1]).count(), idle)
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn only_joined_exits_keep_it_on_its_line() {
    println!("| line, px | gap, px | jumps, published | jumps, joined exits only |");
    for (pen, gap) in [(4.0, 3.0), (4.0, 4.0), (5.0, 4.0), (5.0, 5.0), (6.0, 10.0)] {
        let (published, _) = jumps(pen, gap, false);
        let (connected, idle) = jumps(pen, gap, true);
        println!("| {pen} | {gap} | {published} | {connected} |");
        assert_eq!(connected, 0, "{pen} {gap}");
        assert!(idle < WINDOWS / 4, "{pen} {gap}: it goes on: {idle}");
        assert!(published > 0 || gap > 4.0, "{pen} {gap}: what it was proposed against");
    }
}
