//! Figures for line followers, and runs over them: the four kinds of figure of C. Ekholm's thesis (Kajaani,
//! 2005), drawn after its description, and others.
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

/// A line through these points, px.
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
    // Tips of 21 to 26 degrees so far; then 15.6, 12.7 and 11.0.
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

/// (d) Dense parallel lines: one serpentine with square turns, and hatching beside it. The paper between
/// lines is as wide as they are.
pub fn dense() -> Figure {
    dense_with(4.0, 4.0, false)
}

/// As [`dense`], with lines and gaps of these widths; the serpentine's turns are half circles if `is_round`.
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

/// The four kinds of figure of the thesis, (a) to (d).
pub fn figures() -> [Figure; 4] {
    [corners(), tips(), junctions(), dense()]
}

/// Tips of 13, 9, 7, 5, 3 and 21 degrees. The ink of both arms of the sharpest merges over 80 px.
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

/// Result of a run.
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

/// Lets [`MappingFollower`], ours, follow a figure from `start`.
pub fn follow_figure(
    figure: &Figure,
    start: PxPoint,
    camera: CameraSettings,
    table: TableError,
    settings: MappingSettings,
) -> Run {
    follow_paper(&figure.paper(), &figure.lines, start, camera, table, settings)
}

/// Lets [`MappingFollower`] follow the lines of a paper from `start`.
pub fn follow_paper(
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

/// Lets [`PublishedFollower`] follow a figure until the tool has gone `laps` times the length of all lines.
pub fn follow_published(
    figure: &Figure,
    start: PxPoint,
    camera: CameraSettings,
    table: TableError,
    laps: f64,
) -> Vec<Vec<PxPoint>> {
    let mut camera = SimulatedCamera::new(&figure.paper(), camera);
    let mut table = SimulatedTable::new(start, table);
    // It takes pictures until there is a line, as published.
    let settings = PublishedSettings::default().with_max_tries(u32::MAX);
    let mut follower = PublishedFollower::new(settings);
    let wanted_px: f64 = laps * figure.lines.iter().map(|line| length(line)).sum::<f64>();
    // A window takes the tool some 100 px on; one that has needed twice as many windows is stuck.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred windows")]
    let most_windows = (2.0 * wanted_px / 100.0).ceil() as u32;
    for _ in 0..most_windows {
        let gone_px: f64 = table.strokes().iter().map(|stroke| length(stroke)).sum();
        if gone_px > wanted_px {
            break;
        }
        let window = camera.window(table.place());
        if let Step::Move { path, tool } = follower.observe(&window, table.commanded()) {
            path.into_iter().for_each(|to| table.go(to, tool));
        }
    }
    table.strokes().to_vec()
}

/// Length of a line, px.
pub fn length(line: &[PxPoint]) -> f64 {
    line.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Wrong choices of a tool on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WrongChoices {
    /// Ways of more than [`SHORTCUT_PX`] outside the ink.
    pub shortcuts: u32,
    /// Times that the tool turned back on a line elsewhere than at its ends.
    pub turns: u32,
}

impl WrongChoices {
    pub const NONE: Self = Self { shortcuts: 0, turns: 0 };

    /// Both kinds together.
    pub fn count(self) -> u32 {
        self.shortcuts + self.turns
    }
}

/// Least way outside the ink that counts as a shortcut, px: nearly a pen's width of 5.
const SHORTCUT_PX: f64 = 4.0;
/// Tips sharper than this, 60 degrees, are left out near their vertex, rad.
const SHARP_RAD: f64 = 1.05;
/// Radius of the camera's blur, by which merged ink of a tip reaches farther than its arms touch, px.
const BLUR_PX: f64 = 6.0;
/// Least way back along a line that counts as turning, and the surroundings of a line's end where turning is
/// right, px: twice the blur.
const TURN_PX: f64 = 12.0;
/// A tool whose place on a line jumps by more than this has come to it anew, px: more than a window's way.
const JUMP_PX: f64 = 130.0;

/// Where a tool is on a line.
#[derive(Clone, Copy)]
struct OnLine {
    /// Number of the line.
    line: usize,
    /// How far along the line the tool was at most, in its direction, px.
    farthest: f64,
    /// 1 along the line, -1 against it, 0 if not known yet.
    direction: f64,
}

impl OnLine {
    /// The tool is next at `along` px of the same line; returns whether it has turned back.
    fn advance(&mut self, along: f64) -> bool {
        let step = along - self.farthest;
        if self.direction == 0.0 {
            if step.abs() > TURN_PX {
                (self.farthest, self.direction) = (along, step.signum());
            }
            return false;
        }
        let has_turned = step * self.direction < -TURN_PX;
        if has_turned {
            self.direction = -self.direction;
        }
        if has_turned || step * self.direction > 0.0 {
            self.farthest = along;
        }
        has_turned
    }
}

/// Counts the wrong choices of `strokes` that follow a figure. Near a sharp tip the ink of both arms merges,
/// so points there are not judged.
pub fn wrong_choices(figure: &Figure, strokes: &[Vec<PxPoint>]) -> WrongChoices {
    let route = Route::of(&figure.lines);
    let ends: Vec<PxPoint> = figure.lines.iter().flat_map(|line| [line[0], line[line.len() - 1]]).collect();
    let sharp = sharp_tips(figure);
    let outside_px = 0.5 * figure.pen_px + 1.0;
    let mut wrong = WrongChoices::default();
    for stroke in strokes {
        let mut gone_outside_px = 0.0;
        let mut on: Option<OnLine> = None;
        for pair in stroke.windows(2) {
            let at = pair[1];
            let Some((_, line, along)) = route.nearest(at, outside_px) else {
                let before = gone_outside_px;
                gone_outside_px += pair[0].distance(at);
                wrong.shortcuts += u32::from(before <= SHORTCUT_PX && gone_outside_px > SHORTCUT_PX);
                continue;
            };
            gone_outside_px = 0.0;
            if sharp.iter().any(|(tip, reach_px)| tip.distance(at) < *reach_px) {
                continue;
            }
            let is_near_end = ends.iter().any(|end| end.distance(at) < TURN_PX);
            match &mut on {
                Some(on) if on.line == line && (along - on.farthest).abs() < JUMP_PX && !is_near_end => {
                    wrong.turns += u32::from(on.advance(along));
                }
                _ => on = Some(OnLine { line, farthest: along, direction: 0.0 }),
            }
        }
    }
    wrong
}

/// The sharp tips of a figure, and how far from each the ink of its arms merges, px.
fn sharp_tips(figure: &Figure) -> Vec<(PxPoint, f64)> {
    let corners = figure.lines.iter().flat_map(|line| line.windows(3));
    corners
        .filter_map(|three| {
            let a = (three[0].x - three[1].x, three[0].y - three[1].y);
            let b = (three[2].x - three[1].x, three[2].y - three[1].y);
            let angle = ((a.0 * b.0 + a.1 * b.1) / (a.0.hypot(a.1) * b.0.hypot(b.1))).acos();
            let merged_px = 0.5 * figure.pen_px / (0.5 * angle).sin();
            (angle < SHARP_RAD).then_some((three[1], merged_px + BLUR_PX))
        })
        .collect()
}
