//! The four kinds of figure that the thesis tests with, drawn after its description, and runs over them.
#![allow(unreachable_pub, dead_code, reason = "shared by tests, not an interface")]

use plotter_vector::PxPoint;
use plotter_vector::follow::{
    CameraSettings, End, FollowReport, Judged, LineFollower, MappingFollower, MappingSettings, Paper,
    PublishedFollower, PublishedSettings, Route, SimulatedCamera, SimulatedTable, Step, TableError, judge,
};

/// A figure: polylines and the width of the pen.
#[derive(Clone, Debug)]
pub struct Figure {
    pub name: &'static str,
    pub width: u32,
    pub height: u32,
    pub lines: Vec<Vec<PxPoint>>,
    pub pen_px: f64,
}

impl Figure {
    pub fn paper(&self) -> Paper {
        let strokes: Vec<_> = self.lines.iter().map(|line| (line.clone(), self.pen_px)).collect();
        Paper::drawn(self.width, self.height, &strokes).unwrap()
    }
}

pub fn polyline(places: &[(f64, f64)]) -> Vec<PxPoint> {
    places.iter().map(|(x, y)| PxPoint::new(*x, *y)).collect()
}

/// (a) Corners that invite a shortcut, with junctions: a closed line with pointed teeth, and lines across it.
pub fn corners() -> Figure {
    let outline = polyline(&[
        (80.3, 420.7),
        (80.3, 120.2),
        (200.1, 80.4),
        (235.6, 310.2),
        (270.9, 78.1),
        (420.4, 120.9),
        (300.2, 200.6),
        (560.8, 170.3),
        (600.5, 430.1),
        (430.7, 330.4),
        (520.2, 560.6),
        (330.9, 470.2),
        (290.4, 600.3),
        (250.1, 470.8),
        (80.3, 420.7),
    ]);
    let across = polyline(&[(80.3, 300.5), (160.7, 330.2), (330.9, 470.2)]);
    let stub = polyline(&[(580.65, 300.2), (660.2, 280.5), (690.3, 360.7)]);
    Figure { name: "corners", width: 760, height: 680, lines: vec![outline, across, stub], pen_px: 5.0 }
}

/// (b) Very sharp tips on one long line.
pub fn tips() -> Figure {
    let mut line = vec![(60.2, 420.5)];
    for i in 0..8 {
        let x = 120.0 + 70.0 * f64::from(i);
        line.push((x, if i % 2 == 0 { 90.0 + 4.0 * f64::from(i) } else { 470.0 - 9.0 * f64::from(i) }));
    }
    // Tips of 18 degrees so far; then 15, 12 and 10.
    line.extend([(660.3, 84.0), (700.2, 420.5), (734.6, 90.7), (766.4, 450.1)]);
    Figure { name: "tips", width: 880, height: 560, lines: vec![polyline(&line)], pen_px: 5.0 }
}

/// (c) Junctions: crossings, tees and a star.
pub fn junctions() -> Figure {
    let lines = vec![
        polyline(&[(60.4, 100.3), (640.2, 120.8)]),
        polyline(&[(70.1, 330.6), (650.5, 300.2)]),
        polyline(&[(60.7, 540.1), (640.9, 560.4)]),
        polyline(&[(110.2, 50.5), (130.8, 610.2)]),
        polyline(&[(330.5, 60.1), (310.4, 600.7)]),
        polyline(&[(590.3, 60.9), (600.6, 610.5)]),
        polyline(&[(180.1, 106.0), (250.5, 324.5)]),
        polyline(&[(380.2, 360.4), (540.9, 520.6)]),
        polyline(&[(380.7, 500.2), (540.3, 370.8)]),
        polyline(&[(320.9, 210.5), (593.2, 200.1)]),
    ];
    Figure { name: "junctions", width: 720, height: 660, lines, pen_px: 5.0 }
}

/// (d) Dense parallel lines: one to and fro with square turns, and hatching beside it; as much paper between
/// lines as they are wide.
pub fn dense() -> Figure {
    dense_with(4.0, 4.0, false)
}

pub fn dense_with(pen_px: f64, gap_px: f64, is_round: bool) -> Figure {
    let pitch = pen_px + gap_px;
    let mut snake = Vec::new();
    for i in 0..12 {
        let y = 80.3 + pitch * f64::from(i);
        let ends = [(70.2, y), (440.6, y)];
        let [from, to] = if i % 2 == 0 { ends } else { [ends[1], ends[0]] };
        snake.extend([from, to]);
        let out = if i % 2 == 0 { 1.0 } else { -1.0 };
        let turn = |k: i32| std::f64::consts::PI * f64::from(k) / 12.0;
        if i < 11 && is_round {
            snake.extend((1..12).map(|k| {
                (to.0 + out * 0.5 * pitch * turn(k).sin(), y + 0.5 * pitch * (1.0 - turn(k).cos()))
            }));
        }
    }
    let mut lines = vec![polyline(&snake)];
    for i in 0..12 {
        let x = 90.4 + pitch * f64::from(i);
        lines.push(polyline(&[(x, 300.1), (x + 60.0, 560.6)]));
    }
    let name = if is_round { "round dense" } else { "dense" };
    Figure { name, width: 520, height: 620, lines, pen_px }
}

pub fn figures() -> [Figure; 4] {
    [corners(), tips(), junctions(), dense()]
}

/// Tips of 9, 7, 5 and 3 degrees: the ink of the last one's arms is one over 80 px.
pub fn sharper_tips() -> Figure {
    let mut line = vec![(60.3, 420.4)];
    let mut x = 110.2;
    for (i, step) in [0.0, 30.0, 24.0, 18.0, 12.0, 8.0].into_iter().enumerate() {
        x += step;
        line.push((x, if i % 2 == 0 { 80.5 } else { 420.4 }));
    }
    line.push((330.6, 60.2));
    Figure { name: "sharper tips", width: 400, height: 500, lines: vec![polyline(&line)], pen_px: 5.0 }
}

/// The built-in drawing of the `follow` example: rings of three widths, a line through them, tips, a
/// rectangle and hatching.
pub fn mixed() -> Figure {
    let circle = |x: f64, y: f64, radius: f64| -> Vec<PxPoint> {
        let at = |i: i32| f64::from(i) * std::f64::consts::TAU / 120.0;
        (0..=120).map(|i| PxPoint::new(x + radius * at(i).cos(), y + radius * at(i).sin())).collect()
    };
    let mut lines = vec![
        circle(260.0, 260.0, 180.0),
        circle(260.0, 260.0, 110.0),
        circle(310.0, 260.0, 40.0),
        polyline(&[(40.0, 262.0), (480.0, 255.0)]),
        polyline(&[(520.0, 90.0), (560.0, 430.0), (610.0, 95.0), (650.0, 425.0), (690.0, 100.0)]),
        polyline(&[(560.0, 480.0), (820.0, 480.0), (820.0, 620.0), (560.0, 620.0), (560.0, 480.0)]),
    ];
    for i in 0..9 {
        let x = 120.0 + 11.0 * f64::from(i);
        lines.push(polyline(&[(x, 500.0), (x + 120.0, 640.0)]));
    }
    Figure { name: "mixed", width: 880, height: 700, lines, pen_px: 4.0 }
}

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Run {
    pub end: End,
    pub report: FollowReport,
    pub judged: Judged,
    pub strokes: Vec<Vec<PxPoint>>,
    pub lost: u32,
}

impl Run {
    /// Coverage, followed twice, rms, greatest distance and its place, lifts, windows and end, as a table's
    /// cells.
    pub fn cells(&self) -> String {
        let Self { judged, report, end, .. } = self;
        format!(
            "{:.4} | {:.4} | {:.3} | {:.2} at {:.0} {:.0} | {} | {} | {end:?} |",
            judged.coverage,
            judged.repeated,
            judged.rms_px,
            judged.max_px,
            judged.worst.x,
            judged.worst.y,
            report.lifts,
            report.windows,
        )
    }
}

/// Lets ours follow a figure from a place.
pub fn ours(
    figure: &Figure,
    start: PxPoint,
    camera: CameraSettings,
    table: TableError,
    settings: MappingSettings,
) -> Run {
    over(&figure.paper(), &figure.lines, start, camera, table, settings)
}

/// Lets ours follow the lines of a paper from a place.
pub fn over(
    paper: &Paper,
    lines: &[Vec<PxPoint>],
    start: PxPoint,
    camera: CameraSettings,
    table: TableError,
    settings: MappingSettings,
) -> Run {
    let mut camera = SimulatedCamera::new(paper, camera);
    let mut table = SimulatedTable::new(start, table);
    let mut follower = MappingFollower::new(settings);
    let mut lost = 0;
    let end = loop {
        let window = camera.window(table.place());
        match follower.observe(&window, table.commanded()) {
            Step::Move { path, tool } => path.into_iter().for_each(|to| table.go(to, tool)),
            Step::LineLost { .. } => lost += 1,
            Step::Done(end) => break end,
        }
    };
    let judged = judge(lines, table.strokes(), 2.0);
    Run { end, report: follower.report(), judged, strokes: table.strokes().to_vec(), lost }
}

/// Lets the published follower go over a figure until the tool's way is as long as its lines so many times.
pub fn published(
    figure: &Figure,
    start: PxPoint,
    camera: CameraSettings,
    table: TableError,
    laps: f64,
) -> Vec<Vec<PxPoint>> {
    let mut camera = SimulatedCamera::new(&figure.paper(), camera);
    let mut table = SimulatedTable::new(start, table);
    // It takes pictures until there is a line, as published.
    let settings = PublishedSettings { max_tries: u32::MAX, ..PublishedSettings::default() };
    let mut follower = PublishedFollower::new(settings);
    let lines: f64 = figure.lines.iter().map(|line| length(line)).sum();
    // A window takes it 100 px on, or it is stuck.
    let mut windows = 0.0;
    while windows < laps * lines / 50.0 {
        windows += 1.0;
        let way: f64 = table.strokes().iter().map(|stroke| length(stroke)).sum();
        if way > laps * lines {
            break;
        }
        let window = camera.window(table.place());
        if let Step::Move { path, tool } = follower.observe(&window, table.commanded()) {
            path.into_iter().for_each(|to| table.go(to, tool));
        }
    }
    table.strokes().to_vec()
}

pub fn length(line: &[PxPoint]) -> f64 {
    line.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Wrong choices of a tool on its way: shortcuts (more than 4 px of way outside of the ink) and turning back
/// on a line elsewhere than at its ends. In a sharp tip the arms' ink is one, and which arm the tool is on
/// shows behind it only.
pub fn wrong_choices(figure: &Figure, strokes: &[Vec<PxPoint>]) -> (u32, u32) {
    let route = Route::of(&figure.lines);
    let ends: Vec<PxPoint> = figure.lines.iter().flat_map(|line| [line[0], line[line.len() - 1]]).collect();
    let sharp: Vec<(PxPoint, f64)> = figure
        .lines
        .iter()
        .flat_map(|line| line.windows(3))
        .filter_map(|three| {
            let a = (three[0].x - three[1].x, three[0].y - three[1].y);
            let b = (three[2].x - three[1].x, three[2].y - three[1].y);
            let angle = ((a.0 * b.0 + a.1 * b.1) / (a.0.hypot(a.1) * b.0.hypot(b.1))).acos();
            // As far as the arms' ink is one, and the camera's blur.
            (angle < 1.05).then(|| (three[1], 0.5 * figure.pen_px / (0.5 * angle).sin() + 6.0))
        })
        .collect();
    let outside_px = 0.5 * figure.pen_px + 1.0;
    let (mut shortcuts, mut turns) = (0, 0);
    for stroke in strokes {
        let mut outside = 0.0;
        // The line that the tool is on, where it was farthest along it, and which way it goes.
        let mut on: Option<(usize, f64, f64)> = None;
        for pair in stroke.windows(2) {
            let at = pair[1];
            let near = route.nearest(at, outside_px);
            if near.is_none() {
                let before = outside;
                outside += pair[0].distance(at);
                if before <= 4.0 && outside > 4.0 {
                    shortcuts += 1;
                }
                continue;
            }
            outside = 0.0;
            let Some((_, line, along)) = near else { continue };
            if sharp.iter().any(|(tip, reach_px)| tip.distance(at) < *reach_px) {
                continue;
            }
            let near_end = ends.iter().any(|end| end.distance(at) < 12.0);
            on = match on {
                Some((same, farthest, way))
                    if same == line && (along - farthest).abs() < 130.0 && !near_end =>
                {
                    let ahead = (along - farthest) * way;
                    if way == 0.0 {
                        if (along - farthest).abs() > 12.0 {
                            Some((line, along, (along - farthest).signum()))
                        } else {
                            on
                        }
                    } else if ahead > 0.0 {
                        Some((line, along, way))
                    } else if -ahead > 12.0 {
                        turns += 1;
                        Some((line, along, -way))
                    } else {
                        on
                    }
                }
                _ => Some((line, along, 0.0)),
            };
        }
    }
    (shortcuts, turns)
}
