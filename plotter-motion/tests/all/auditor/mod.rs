//! Looks at nothing but the emitted steps: where the motors are when, and from that speed, acceleration and
//! jerk by differences.
#![allow(
    dead_code,
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    reason = "part of tests, each of which takes what it needs"
)]

use crate::felt;
use core::time::Duration;
use plotter_motion::kinematics::{Cartesian, MotorScale};
use plotter_motion::{
    PathMode, Planner, PlannerSettings, PlotOp, Point, Segment, StepGen, StepPair, StepPoint, Vec2,
    planner::{Action, Course, Shape},
    stepgen::{MotorEvent, StepGenSettings},
};
use std::collections::VecDeque;

/// How finely steps are looked at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    pub(crate) steps_per_mm: f64,
    pub(crate) clock_hz: f64,
    /// Time over which the position is averaged, the least one of all.
    pub(crate) bin_s: f64,
    /// Bins between the places that are compared where no corner is.
    pub(crate) window: usize,
    /// Bins between those that are compared across corners, so that a curve of many short segments counts as
    /// a curve.
    pub(crate) wide_window: usize,
}

/// What was seen. All greatest values.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Audit {
    pub(crate) speed_mm_s: f64,
    /// Along the path, and across it, mm/s², in windows without a corner.
    pub(crate) along_mm_s2: f64,
    pub(crate) across_mm_s2: f64,
    /// Along the path, mm/s³, in such windows.
    pub(crate) jerk_mm_s3: f64,
    /// Along and across in wide windows that may hold corners, if the direction changes little in all.
    pub(crate) wide_along_mm_s2: f64,
    pub(crate) wide_across_mm_s2: f64,
    /// Square of the speed at a corner as a share of what is allowed there: the greatest; and how many
    /// corners there were.
    pub(crate) corner_share: f64,
    pub(crate) corners: usize,
    /// The acceleration as a vector, as a share of its limit, in every window; in exact mode in those without
    /// a corner.
    pub(crate) vector_share: f64,
    /// The jerk as a vector, mm/s³, on average over 20 ms, in the same windows.
    pub(crate) vector_jerk_mm_s3: f64,
    /// Farthest place of the pen from the drawing, and of the drawing from the pen's way, mm.
    pub(crate) from_drawing_mm: f64,
    pub(crate) from_pen_mm: f64,
    /// Time of the steps, and that of the planner's phases; s.
    pub(crate) time_s: f64,
    pub(crate) planned_s: f64,
    pub(crate) steps: u64,
    pub(crate) end: StepPoint,
    /// Least time between two steps, s.
    pub(crate) least_interval_s: f64,
}

/// Every action of a drawing. `each` may touch the planner; one that it holds goes on when the machine
/// stands.
pub(crate) fn actions<const N: usize>(
    settings: PlannerSettings,
    ops: &[PlotOp],
    mut each: impl FnMut(Action, &mut Planner<N>),
) {
    let mut planner = Planner::<N>::new(settings).unwrap();
    let mut ops = ops.iter().copied();
    let mut finished = false;
    loop {
        while !finished && planner.has_room() {
            match ops.next() {
                Some(op) => planner.push(op).unwrap(),
                None => {
                    planner.finish().unwrap();
                    finished = true;
                }
            }
        }
        match planner.next_action() {
            Some(action) => each(action, &mut planner),
            None if planner.is_held() => planner.resume(),
            None => {
                assert!(finished, "a planner with room for more has actions or is done");
                return;
            }
        }
    }
}

/// Runs a drawing through planner and step generator; gives the tick at which it ends. `each` is told at
/// which tick an action begins.
pub(crate) fn run<const N: usize>(
    settings: PlannerSettings,
    step_settings: StepGenSettings,
    steps_per_mm: f64,
    ops: &[PlotOp],
    mut each: impl FnMut(Action, u64, &mut Planner<N>),
    mut event: impl FnMut(u64, MotorEvent),
) -> u64 {
    let motor = MotorScale { steps_per_mm, inverted: false };
    let mut steps = StepGen::new(Cartesian::new(motor, motor).unwrap(), step_settings);
    actions::<N>(settings, ops, |action, planner| {
        each(action, steps.tick(), planner);
        steps.push(action).unwrap();
        while let Some(timed) = steps.next_event() {
            event(timed.tick, timed.event);
        }
    });
    steps.tick()
}

/// The time that a drawing takes by the planner's own account, s, and how many courses it has.
pub(crate) fn planned<const N: usize>(settings: PlannerSettings, ops: &[PlotOp]) -> (f64, usize) {
    let (mut time_s, mut courses) = (0.0, 0);
    actions::<N>(settings, ops, |action, _| match action {
        Action::Phase(phase) => time_s += f64::from(phase.duration_s),
        Action::Course(_) => courses += 1,
        _ => {}
    });
    (time_s, courses)
}

/// Mean positions over bins of time.
struct Bins {
    ticks: f64,
    means: Vec<Point>,
    sum: (f64, f64),
    filled: f64,
    now: u64,
    at: (f64, f64),
}

impl Bins {
    fn new(lens: Lens) -> Self {
        Self {
            ticks: lens.bin_s * lens.clock_hz,
            means: Vec::new(),
            sum: (0.0, 0.0),
            filled: 0.0,
            now: 0,
            at: (0.0, 0.0),
        }
    }

    fn until(&mut self, tick: u64, mm_per_step: f64) {
        let mut rest = (tick - self.now) as f64;
        self.now = tick;
        while rest > 0.0 {
            let part = rest.min(self.ticks - self.filled);
            self.sum.0 += self.at.0 * part;
            self.sum.1 += self.at.1 * part;
            self.filled += part;
            rest -= part;
            if self.filled >= self.ticks - 1e-6 {
                let scale = mm_per_step / self.filled;
                self.means.push(Point::new(self.sum.0 * scale, self.sum.1 * scale));
                self.sum = (0.0, 0.0);
                self.filled = 0.0;
            }
        }
    }
}

/// Turning by less is no corner, rad.
const CORNER_RAD: f64 = 1e-3;
/// Where the direction turns by more than this within a window, differences say too little, rad: speeds at
/// corners and on curves are looked at step by step.
const SHARP_RAD: f64 = 0.35;
/// The same for narrow windows, where a chord must not be shorter than its curve by more than 0.2 %.
const NARROW_SHARP_RAD: f64 = 0.2;
/// Slower than this a direction says nothing, mm/s.
const SLOW_MM_S: f64 = 0.05;

/// A course and its first and last steps.
#[derive(Clone, Debug)]
struct Stretch {
    course: Course,
    from: Point,
    steps: u32,
    first: Vec<(u64, StepPoint)>,
    last: VecDeque<(u64, StepPoint)>,
}

/// Steps that are kept of each end.
const KEPT: usize = 65;

impl Stretch {
    fn new(course: Course, from: Point) -> Self {
        Self { course, from, steps: 0, first: Vec::new(), last: VecDeque::new() }
    }

    fn step(&mut self, tick: u64, at: StepPoint) {
        if self.first.len() < KEPT {
            self.first.push((tick, at));
        }
        if self.last.len() == KEPT {
            self.last.pop_front();
        }
        self.last.push_back((tick, at));
        self.steps += 1;
    }

    /// Length of way of a step, mm; on a line all are alike.
    fn step_mm(&self) -> f64 {
        f64::from(self.course.length_mm) / f64::from(self.steps)
    }

    /// Speeds between the first two steps and between the last two, mm/s, if there are three.
    fn end_speeds(&self, clock_hz: f64) -> Option<[f64; 2]> {
        if self.steps < 3 {
            return None;
        }
        let speed = |first: u64, second: u64| self.step_mm() * clock_hz / (second - first) as f64;
        let (last, before) = (self.last.back()?, self.last.iter().rev().nth(1)?);
        Some([speed(self.first[0].0, self.first[1].0), speed(before.0, last.0)])
    }

    /// Speeds and ways over the first and over the last steps that were kept, for a curve; mm/s and mm.
    fn curve_speeds(&self, lens: Lens) -> Option<[(f64, f64); 2]> {
        let over = |(begin, from): (u64, StepPoint), (end, to): (u64, StepPoint)| {
            let way = libm::hypot(f64::from(to.x - from.x), f64::from(to.y - from.y)) / lens.steps_per_mm;
            (way * lens.clock_hz / (end - begin) as f64, way)
        };
        let whole = self.first.len() == KEPT;
        whole.then(|| [over(self.first[0], self.first[KEPT - 1]), over(self.last[0], self.last[KEPT - 1])])
    }

    /// Directions of travel at both ends.
    fn directions(&self) -> (Vec2, Vec2) {
        let along = |radius: Vec2, sweep_rad: f64| {
            if sweep_rad > 0.0 { radius.perpendicular() } else { -radius.perpendicular() }
        };
        match self.course.shape {
            Shape::Line => (self.course.to - self.from, self.course.to - self.from),
            Shape::Arc { centre, sweep_rad } => {
                let sweep_rad = f64::from(sweep_rad);
                (along(self.from - centre, sweep_rad), along(self.course.to - centre, sweep_rad))
            }
            Shape::Parabola { control } => (control - self.from, self.course.to - control),
            shape => panic!("{shape:?} is not audited"),
        }
    }
}

/// Square of the speed allowed at a corner, by the formulas of the books with angles instead of cosines.
fn allowed2(turn_rad: f64, shorter_mm: f64, settings: &PlannerSettings) -> f64 {
    let half_angle = 0.5 * (core::f64::consts::PI - turn_rad);
    let by_deviation = settings.junction_deviation_mm * half_angle.sin() / (1.0 - half_angle.sin());
    let by_length = 0.5 * shorter_mm * half_angle.tan();
    settings.accel_mm_s2 * by_deviation.min(by_length)
}

/// Runs a drawing and audits its steps. The pen's delay separates what is drawn without a stop.
pub(crate) fn audit<const N: usize>(settings: PlannerSettings, lens: Lens, ops: &[PlotOp]) -> Audit {
    audit_touched::<N>(settings, lens, ops, |_| {})
}

/// The same of a machine that a person touches, after any of its actions.
pub(crate) fn audit_touched<const N: usize>(
    settings: PlannerSettings,
    lens: Lens,
    ops: &[PlotOp],
    mut touch: impl FnMut(&mut Planner<N>),
) -> Audit {
    let settle_s = lens.bin_s * (4 * lens.wide_window) as f64;
    let step_settings = StepGenSettings {
        clock_hz: lens.clock_hz as u32,
        pen_settle: Duration::from_secs_f64(settle_s),
        laser: false,
    };
    let mut seen = Audit { least_interval_s: f64::INFINITY, ..Audit::default() };
    let mut bins = Bins::new(lens);
    let mut nearness = Nearness::new(ops);
    // `waited` is what was settled before the last step: the lift at the end comes after it.
    let (mut at, mut last, mut settles, mut waited) = (StepPoint::default(), 0, 0, 0);
    let stretches = core::cell::RefCell::new(Vec::<Stretch>::new());
    let planned_s = core::cell::Cell::new(0.0);
    run::<N>(
        settings,
        step_settings,
        lens.steps_per_mm,
        ops,
        |action, _, planner| {
            match action {
                Action::Phase(phase) => planned_s.set(planned_s.get() + f64::from(phase.duration_s)),
                Action::Course(course) => {
                    let mut stretches = stretches.borrow_mut();
                    let from = stretches.last().map_or(Point::ORIGIN, |before| before.course.to);
                    stretches.push(Stretch::new(course, from));
                }
                _ => {}
            }
            touch(planner);
        },
        |tick, event| match event {
            MotorEvent::Step(StepPair { x, y }) => {
                assert!(tick >= last, "steps come in order of time");
                bins.until(tick, 1.0 / lens.steps_per_mm);
                if seen.steps > 0 {
                    seen.least_interval_s = seen.least_interval_s.min((tick - last) as f64 / lens.clock_hz);
                }
                last = tick;
                waited = settles;
                at = StepPoint::new(at.x + i32::from(x), at.y + i32::from(y));
                bins.at = (f64::from(at.x), f64::from(at.y));
                seen.steps += 1;
                stretches.borrow_mut().last_mut().unwrap().step(tick, at);
                if seen.steps.is_multiple_of(8) {
                    let place = Point::new(bins.at.0 / lens.steps_per_mm, bins.at.1 / lens.steps_per_mm);
                    seen.from_drawing_mm = seen.from_drawing_mm.max(nearness.distance(place));
                }
            }
            MotorEvent::Pen(_) => settles += 1,
            _ => {}
        },
    );
    seen.end = at;
    seen.planned_s = planned_s.get();
    seen.time_s = last as f64 / lens.clock_hz - f64::from(waited) * settle_s;
    seen.from_pen_mm = nearness.farthest();
    bins.until(last + (settle_s * lens.clock_hz) as u64, 1.0 / lens.steps_per_mm);
    let corners = corners(&stretches.borrow(), settings, lens, &mut seen);
    narrow_windows(&bins.means, &corners, lens, &mut seen);
    vectors(&bins.means, &corners, settings, lens, &mut seen);
    wide_windows(&bins.means, lens, &mut seen);
    seen
}

impl Stretch {
    /// Square of the speed at one of the ends, as the steps near it say: 0 is the first end, 1 the last.
    fn corner2(&self, end: usize, settings: PlannerSettings, lens: Lens) -> Option<f64> {
        let accel_mm_s2 = settings.accel_mm_s2;
        if self.course.shape == Shape::Line {
            // Between two steps the mean speed is that of a place a step away.
            let speed = self.end_speeds(lens.clock_hz)?[end];
            return Some(speed * speed - 2.0 * accel_mm_s2 * 1.5 * self.step_mm());
        }
        // From one chord to the next the times of single steps jump by less than a step; and as on curves,
        // the mean speed over some way is that in its middle.
        let (speed, way_mm) = self.curve_speeds(lens)?[end];
        Some(speed * speed - accel_mm_s2 * way_mm)
    }
}

/// Audits the speeds at the corners; gives the bins in which they are.
fn corners(stretches: &[Stretch], settings: PlannerSettings, lens: Lens, seen: &mut Audit) -> Vec<usize> {
    let mut bins = Vec::new();
    for pair in stretches.windows(2) {
        let [before, after] = pair else { continue };
        let (out, into) = (before.directions().1, after.directions().0);
        let turn_rad = libm::atan2(out.cross(into), out.dot(into)).abs();
        if turn_rad < CORNER_RAD || before.course.pen != after.course.pen {
            continue;
        }
        for step in [before.last.back(), after.first.first()].into_iter().flatten() {
            bins.push((step.0 as f64 / lens.clock_hz / lens.bin_s) as usize);
        }
        let shorter_mm = before.course.length_mm.min(after.course.length_mm);
        let allowed2 = allowed2(turn_rad, f64::from(shorter_mm), &settings);
        for at_corner2 in
            [before.corner2(1, settings, lens), after.corner2(0, settings, lens)].into_iter().flatten()
        {
            seen.corner_share = seen.corner_share.max(at_corner2 / allowed2);
            seen.corners += 1;
        }
    }
    bins.sort_unstable();
    bins
}

/// Means over half a window, and speeds from one window to the next.
fn smooth(means: &[Point], window: usize) -> Vec<Point> {
    let half = (window / 2).max(1);
    let mut sums = vec![Vec2::default()];
    for mean in means {
        let before = *sums.last().unwrap();
        sums.push(before + (*mean - Point::ORIGIN));
    }
    (0..means.len().saturating_sub(half))
        .map(|at| Point::ORIGIN + (sums[at + half] + -sums[at]) * (1.0 / half as f64))
        .collect()
}

/// Mean positions with the way and the time weighed by the speed that has passed at each.
struct Path {
    smooth: Vec<Point>,
    /// Way so far, mm, and the sum of dt / v, s²/mm.
    way: Vec<f64>,
    slowness: Vec<f64>,
}

impl Path {
    fn new(means: &[Point], window: usize, bin_s: f64) -> Self {
        let smooth = smooth(means, window);
        let near = (window / 4).max(1);
        let (mut way, mut slowness) = (vec![0.0], vec![0.0]);
        for at in 0..smooth.len() {
            let (from, to) = (at.saturating_sub(near / 2), (at + near.div_ceil(2)).min(smooth.len() - 1));
            let speed = smooth[from].distance(smooth[to]) / ((to - from) as f64 * bin_s);
            way.push(way[at] + speed * bin_s);
            slowness.push(slowness[at] + if speed > SLOW_MM_S { bin_s / speed } else { 0.0 });
        }
        Self { smooth, way, slowness }
    }

    /// The sum of dt / v up to the middle of the way between two places.
    fn slowness_at_middle(&self, from: usize, to: usize) -> f64 {
        let middle = 0.5 * (self.way[from] + self.way[to]);
        let after = (from + self.way[from..=to].partition_point(|&way| way < middle)).clamp(from + 1, to);
        let (low, high) = (self.way[after - 1], self.way[after]);
        let share = if high > low { (middle - low) / (high - low) } else { 0.0 };
        self.slowness[after - 1] + share * (self.slowness[after] - self.slowness[after - 1])
    }

    /// Acceleration along and across, between the means that begin at `at`, a window and two windows later;
    /// the greater speed; and how far the direction turns.
    ///
    /// The direction of a chord is that of the curve in the middle of its way. Where the radius is v² / a the
    /// direction turns by the integral of a dt / v, so a is the turning divided by that of dt / v, whatever
    /// the speed does meanwhile.
    fn difference(&self, at: usize, window: usize, bin_s: f64) -> (f64, f64, f64, f64) {
        let dt = window as f64 * bin_s;
        let speed = |at: usize| (self.smooth[at + window] - self.smooth[at]) * (1.0 / dt);
        let (before, after) = (speed(at), speed(at + window));
        let turn_rad = libm::atan2(before.cross(after), before.dot(after)).abs();
        let (slow, fast) = (before.length().min(after.length()), before.length().max(after.length()));
        let along = (after.length() - before.length()) / dt;
        if slow <= SLOW_MM_S {
            return (fast, along, 0.0, 0.0); // near rest a direction says nothing
        }
        let slowness =
            self.slowness_at_middle(at + window, at + 2 * window) - self.slowness_at_middle(at, at + window);
        (fast, along, turn_rad / slowness, turn_rad)
    }
}

fn narrow_windows(means: &[Point], corners: &[usize], lens: Lens, seen: &mut Audit) {
    let (window, path) = (lens.window, Path::new(means, lens.window, lens.bin_s));
    let span = 2 * window + window / 2 + 1;
    // Along the way, of short chords: on a curve those of a window are too short by what looks like a jerk.
    let way_accel = |at: usize| {
        let dt = window as f64 * lens.bin_s;
        (path.way[at + 2 * window] - 2.0 * path.way[at + window] + path.way[at]) / (dt * dt)
    };
    let mut along: Vec<Option<f64>> = Vec::new();
    for at in 0..path.smooth.len().saturating_sub(2 * window) {
        let next = corners.partition_point(|&corner| corner + 1 < at);
        let (speed, accel_along, across, turn_rad) = path.difference(at, window, lens.bin_s);
        seen.speed_mm_s = seen.speed_mm_s.max(speed);
        if turn_rad > NARROW_SHARP_RAD || corners.get(next).is_some_and(|&corner| corner <= at + span) {
            along.push(None);
            continue;
        }
        seen.along_mm_s2 = seen.along_mm_s2.max(accel_along.abs());
        seen.across_mm_s2 = seen.across_mm_s2.max(across.abs());
        along.push((speed > SLOW_MM_S && turn_rad <= 0.5 * NARROW_SHARP_RAD).then(|| way_accel(at)));
    }
    let dt = window as f64 * lens.bin_s;
    for pair in along.windows(window + 1) {
        if let (Some(Some(first)), Some(Some(second))) = (pair.first(), pair.last())
            && pair.iter().all(Option::is_some)
        {
            seen.jerk_mm_s3 = seen.jerk_mm_s3.max((second - first).abs() / dt);
        }
    }
}

/// Between which accelerations the jerk is looked at, s.
const JERK_S: f64 = 0.02;

/// The second difference of places is an average of the acceleration with weights above 0: where it is above
/// the limit, the acceleration is somewhere.
fn vectors(means: &[Point], corners: &[usize], settings: PlannerSettings, lens: Lens, seen: &mut Audit) {
    let (window, smooth) = (lens.window, smooth(means, lens.window));
    let dt = window as f64 * lens.bin_s;
    let span = 2 * window + window / 2 + 1;
    let in_exact = settings.path == PathMode::Exact;
    let apart = (JERK_S / lens.bin_s) as usize;
    let mut accels: Vec<Option<Vec2>> = Vec::new();
    for at in 0..smooth.len().saturating_sub(2 * window) {
        let next = corners.partition_point(|&corner| corner + 1 < at);
        if in_exact && corners.get(next).is_some_and(|&corner| corner <= at + span) {
            accels.push(None);
            continue;
        }
        let (before, middle, after) = (smooth[at], smooth[at + window], smooth[at + 2 * window]);
        let accel = ((after - middle) - (middle - before)) * (1.0 / (dt * dt));
        seen.vector_share = seen.vector_share.max(felt::share(accel, &settings));
        accels.push(Some(accel));
    }
    for pair in accels.windows(apart + 1) {
        if let (Some(Some(first)), Some(Some(second))) = (pair.first(), pair.last()) {
            let jerk = (*second - *first).length() / JERK_S;
            seen.vector_jerk_mm_s3 = seen.vector_jerk_mm_s3.max(jerk);
        }
    }
}

/// The greatest acceleration of a row of places, one a bin, as a share of the limit, corners and all.
pub(crate) fn share_of_limit(places: &[Point], settings: PlannerSettings, lens: Lens) -> f64 {
    let path = PathMode::Tolerance { path_tolerance_mm: 0.0 };
    let mut seen = Audit::default();
    vectors(places, &[], PlannerSettings { path, ..settings }, lens, &mut seen);
    seen.vector_share
}

fn wide_windows(means: &[Point], lens: Lens, seen: &mut Audit) {
    let (window, path) = (lens.wide_window, Path::new(means, lens.wide_window, lens.bin_s));
    for at in 0..path.smooth.len().saturating_sub(2 * window) {
        let (_, along, across, turn_rad) = path.difference(at, window, lens.bin_s);
        if turn_rad < SHARP_RAD {
            seen.wide_along_mm_s2 = seen.wide_along_mm_s2.max(along.abs());
            seen.wide_across_mm_s2 = seen.wide_across_mm_s2.max(across.abs());
        }
    }
}

/// The drawing in cells of a grid, to find how far a place is from it.
struct Nearness {
    cell_mm: f64,
    cells: std::collections::HashMap<(i32, i32), Vec<u32>>,
    segments: Vec<Segment>,
    /// For each vertex, the nearest that the pen has come.
    nearest_mm: Vec<f64>,
}

impl Nearness {
    fn new(ops: &[PlotOp]) -> Self {
        let (cell_mm, mut at) = (2.0, Point::ORIGIN);
        let mut segments = Vec::new();
        for op in plotter_motion::toolpath::chords(ops.iter().copied(), 1e-4) {
            if let Some(to) = op.target() {
                segments.push(Segment::new(at, to));
                at = to;
            }
        }
        let mut cells: std::collections::HashMap<(i32, i32), Vec<u32>> = std::collections::HashMap::new();
        for (index, segment) in segments.iter().enumerate() {
            let pieces = (segment.length() / (0.5 * cell_mm)).ceil().max(1.0) as u32;
            let mut before = None;
            for piece in 0..=pieces {
                let place = segment.from.lerp(segment.to, f64::from(piece) / f64::from(pieces));
                let cell = Self::cell(cell_mm, place);
                if before != Some(cell) {
                    before = Some(cell);
                    for dx in -1..=1 {
                        for dy in -1..=1 {
                            let list = cells.entry((cell.0 + dx, cell.1 + dy)).or_default();
                            if list.last() != Some(&(index as u32)) {
                                list.push(index as u32);
                            }
                        }
                    }
                }
            }
        }
        let nearest_mm = vec![f64::INFINITY; segments.len()];
        Self { cell_mm, cells, segments, nearest_mm }
    }

    fn cell(cell_mm: f64, place: Point) -> (i32, i32) {
        ((place.x / cell_mm).floor() as i32, (place.y / cell_mm).floor() as i32)
    }

    fn distance(&mut self, place: Point) -> f64 {
        let Some(list) = self.cells.get(&Self::cell(self.cell_mm, place)) else { return f64::INFINITY };
        let mut least = f64::INFINITY;
        for &index in list {
            let segment = self.segments[index as usize];
            least = least.min(segment.distance(place));
            let nearest = &mut self.nearest_mm[index as usize];
            *nearest = nearest.min(segment.to.distance(place));
        }
        least
    }

    fn farthest(&self) -> f64 {
        self.nearest_mm.iter().copied().fold(0.0, f64::max)
    }
}

/// What turns as sharply as the limit allows while it speeds up as hard as it allows is felt as √2 of the
/// limit: the auditor sees it. On a circle of radius r, v² / r comes to the limit A at 45 degrees of turn
/// from rest with the acceleration A.
#[test]
fn what_is_within_the_limit_along_and_across_apart_is_seen_to_be_beyond_it_together() {
    const RADIUS_MM: f64 = 10.0;
    const LENS: Lens =
        Lens { steps_per_mm: 10_000.0, clock_hz: 1e8, bin_s: 0.000_05, window: 50, wide_window: 560 };
    let path = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    let settings = PlannerSettings { path, ..PlannerSettings::default() };
    let share = |along: fn(f64) -> f64, end_s: f64| {
        let bins = (end_s / LENS.bin_s) as u32;
        let places = (0..bins).map(|bin| {
            let angle = along(f64::from(bin) * LENS.bin_s) / RADIUS_MM;
            let step = |mm: f64| (mm * LENS.steps_per_mm).round() / LENS.steps_per_mm;
            Point::new(step(RADIUS_MM * angle.cos()), step(RADIUS_MM * angle.sin()))
        });
        let mut seen = Audit::default();
        vectors(&places.collect::<Vec<_>>(), &[], settings, LENS, &mut seen);
        seen.vector_share
    };
    // 1000 mm/s² to 100 mm/s, and 100 mm/s all along.
    let both = share(|t| 500.0 * t * t, 0.1);
    assert!((1.35..1.45).contains(&both), "{both}");
    let turning = share(|t| 100.0 * t, 0.1);
    assert!((0.95..1.05).contains(&turning), "{turning}");
}
