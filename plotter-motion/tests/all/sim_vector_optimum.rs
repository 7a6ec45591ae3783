//! How near the planned time is to the least time in which the planner's own path can be run within the
//! acceleration as a vector.
//!
//! The least time is found on a fine grid by the method of time-optimal path parameterization (J. E. Bobrow,
//! S. Dubowsky, J. S. Gibson 1985; H. Pham, Q.-C. Pham 2018): with w = ṡ², the acceleration is p′ α + p″ w
//! and dw/ds = 2 α. Backwards from the end w is as great as the hardest braking allows, then forwards as the
//! hardest speeding up does. Only motions count that could keep their speed at every place: in a sharp corner
//! one may be faster for an instant, while it brakes. It knows nothing of how the planner goes about it.
#![allow(
    clippy::print_stdout,
    clippy::cast_possible_truncation,
    reason = "what was measured, for whoever looks; counts of cells"
)]

use crate::sampled::sampled;
use crate::{auditor, drawings, felt};
use plotter_motion::{
    PathMode, Pen, PlannerSettings, PlotOp, Point, Vec2,
    planner::{Action, Course},
};

/// Length of a cell of the grid, mm, and fewest cells of a course: half as fine makes less than 0.1 % of the
/// time.
const CELL_MM: f64 = 0.01;
const FEWEST_CELLS: f64 = 12.0;

/// A cell: both derivatives in its middle, its length, and the greatest w.
struct Cell {
    along: Vec2,
    bend: Vec2,
    length_mm: f64,
    most_w: f64,
}

/// The accelerations α that keep the limit at a w: the roots of |p′ α + p″ w| = A.
fn range(cell: &Cell, w: f64, accel_mm_s2: f64) -> (f64, f64) {
    let a = cell.along.length_squared().max(1e-18);
    let b = w * cell.along.dot(cell.bend);
    let c = w * w * cell.bend.length_squared() - accel_mm_s2 * accel_mm_s2;
    let root = (b * b - a * c).max(0.0).sqrt();
    ((-b - root) / a, (-b + root) / a)
}

/// The least time of a stroke from rest to rest, s.
fn least_time_s(stroke: &[(Course, Point)], accel_mm_s2: f64) -> f64 {
    let mut cells = Vec::new();
    for (course, from) in stroke {
        let length_mm = f64::from(course.length_mm);
        let count = (length_mm / CELL_MM).max(FEWEST_CELLS).ceil();
        for index in 0..count as usize {
            let (along, bend) = felt::derivatives(course, *from, (index as f64 + 0.5) * length_mm / count);
            let feed = f64::from(course.feed_mm_s) / along.length().max(1e-9);
            // Faster than this it could not keep its speed: no α of 0 keeps the limit.
            let most_w = (feed * feed).min(accel_mm_s2 / bend.length().max(1e-300));
            cells.push(Cell { along, bend, length_mm: length_mm / count, most_w });
        }
    }
    let mut w = vec![0.0_f64; cells.len() + 1];
    for (index, cell) in cells.iter().enumerate().rev() {
        let hardest = range(cell, w[index + 1].min(cell.most_w), accel_mm_s2).0;
        let before = if index > 0 { cells[index - 1].most_w } else { 0.0 };
        w[index] = (w[index + 1] - 2.0 * hardest * cell.length_mm).min(cell.most_w).min(before);
    }
    for (index, cell) in cells.iter().enumerate() {
        let hardest = range(cell, w[index].min(cell.most_w), accel_mm_s2).1;
        w[index + 1] = (w[index] + 2.0 * hardest * cell.length_mm).clamp(0.0, w[index + 1]);
    }
    let time_s =
        |(index, cell): (usize, &Cell)| 2.0 * cell.length_mm / (w[index].sqrt() + w[index + 1].sqrt());
    cells.iter().enumerate().map(time_s).sum()
}

/// The planned time of a drawing, and the least one of the same path; s.
fn times(settings: PlannerSettings, ops: &[PlotOp]) -> (f64, f64) {
    let (mut at, mut pen) = (Point::ORIGIN, Pen::Up);
    let (mut planned_s, mut least_s, mut stroke) = (0.0, 0.0, Vec::new());
    auditor::actions::<16>(settings, ops, |action, _| match action {
        Action::Phase(phase) => planned_s += f64::from(phase.duration_s),
        Action::Course(course) => {
            if course.pen != pen {
                least_s += least_time_s(&stroke, settings.accel_mm_s2);
                (pen, stroke) = (course.pen, Vec::new());
            }
            if course.length_mm > 0.0 {
                stroke.push((course, at));
            }
            at = course.to;
        }
        _ => {}
    });
    (planned_s, least_s + least_time_s(&stroke, settings.accel_mm_s2))
}

/// Times of a planner elsewhere that keeps the acceleration as a vector, within 0.05 mm, s; and how many
/// times as long ours may take.
const REFERENCE: [(&str, f64); 6] = [
    ("spiral", 39.83),
    ("hatch", 56.06),
    ("circle", 2.32),
    ("owl", 20.92),
    ("curves", 29.03),
    ("Cassini", 612.07),
];
const REFERENCE_SHARE: f64 = 1.03;

/// Most that the planned time may be above the least one.
const NEAR: f64 = 1.01;

fn check(drawing: &drawings::Drawing) -> f64 {
    let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    let settings = PlannerSettings { path, ..PlannerSettings::default() };
    let (planned_s, least_s) = times(settings, &drawing.ops);
    let ratio = planned_s / least_s;
    println!("| {} | {planned_s:.3} | {least_s:.3} | {ratio:.4} |", drawing.name);
    // Below 1 by what the grid makes of it.
    assert!(ratio > 0.99 && ratio <= NEAR, "{}: {planned_s} s for {least_s} s", drawing.name);
    planned_s
}

#[test]
fn short_drawings_take_hardly_longer_than_their_path_needs() {
    for drawing in
        [drawings::spiral(2), drawings::hatch(6), drawings::zigzag(60), drawings::circle(), drawings::arcs()]
    {
        check(&drawing);
    }
}

#[test]
#[ignore = "seconds in a release build: .ci/run runs it, and it is a table of docs/results/stepper-motion.md"]
fn table_of_whole_drawings() {
    for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
        let planned_s = check(&drawing);
        let reference = REFERENCE.iter().find(|(name, _)| *name == drawing.name);
        let most_s = reference.map_or(f64::INFINITY, |(_, time_s)| REFERENCE_SHARE * time_s);
        assert!(planned_s <= most_s, "{}: {planned_s} s, {most_s} s at the most", drawing.name);
    }
}

/// The search sees what a planner gives away: the same path at half of its acceleration takes longer by the
/// root of 2, where no speed limits it.
#[test]
fn a_planner_that_gives_half_away_is_seen() {
    let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    let settings = PlannerSettings { path, speed_mm_s: 1e4, ..PlannerSettings::default() };
    let line = [PlotOp::Draw { to: Point::new(10.0, 0.0), feed_mm_s: None }];
    let (planned_s, least_s) = times(PlannerSettings { accel_mm_s2: 500.0, ..settings }, &line);
    assert!((planned_s / least_s - 1.0).abs() < 1e-3, "{planned_s} s for {least_s} s");
    // 2 √(10 / 1000) s
    let stroke = [(
        Course { to: Point::new(10.0, 0.0), length_mm: 10.0, feed_mm_s: 1e4, ..Course::default() },
        Point::ORIGIN,
    )];
    assert!((least_time_s(&stroke, 1000.0) - 0.2).abs() < 1e-4);
    assert!(planned_s / least_time_s(&stroke, 1000.0) > 1.4);
}
