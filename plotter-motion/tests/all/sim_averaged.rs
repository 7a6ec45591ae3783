//! Motion that is averaged so that its jerk is limited as a vector: audited by nothing but its steps.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "what was measured, for whoever looks; ticks below 2^53"
)]

use crate::auditor::{planned, run};
use crate::drawings::{self, Drawing};
use crate::figure::Figure;
use crate::sampled::sampled;
use plotter_motion::{
    MachineConfig, PathMode, Pen, PlannerSettings, PlotOp, Point, StepPair, Vec2,
    planner::{AccelLimit, PlanError},
    stepgen::{AveragedSteps, MotorEvent, StepGenSettings, TimedEvent},
    toolpath::chords,
};
use std::collections::HashMap;

const TOLERANCE_MM: f64 = 0.05;
const JERK_MM_S3: f64 = 20_000.0;
/// Some forty times what a motor has, so that places are known well enough to be differentiated thrice.
const STEPS_PER_MM: f64 = 4_000.0;
const CLOCK_HZ: u32 = 10_000_000;
/// Steps of 42 ms at 100 mm/s of both motors: 33,600.
const ROOM: usize = 1 << 16;
/// Places are averaged over this, s.
const BIN_S: f64 = 0.000_5;
/// Accelerations are second differences over so many bins, and the jerk is the difference of two over so
/// many. A place is known to half a step at worst, which is 2000 mm/s³ then.
const ACCEL_BINS: usize = 12;
const JERK_BINS: usize = 30;
/// By how much what is measured may exceed a limit, as in the audit of the planner.
const MEASURED: f64 = 1.05;

static OF_JERK: Figure = Figure::of("of the jerk");

/// The greatest of everything.
#[derive(Debug, Default)]
struct Seen {
    speed_mm_s: f64,
    accel_mm_s2: f64,
    jerk_mm_s3: f64,
    from_drawing_mm: f64,
    from_pen_mm: f64,
    time_s: f64,
    end: Point,
}

/// Where the pen is, every bin of time; and where it is down, with the stroke.
struct Sampler {
    now: u64,
    at: [i64; 2],
    sum: [f64; 2],
    filled: u64,
    means: Vec<Vec2>,
    pen: Pen,
    /// Places of each stroke, a fiftieth of a millimetre apart.
    strokes: Vec<Vec<Point>>,
    /// What is to be drawn, and what is left of it to come near to.
    asked: Vec<Vec<Point>>,
    near: Near,
    from_pen_mm: f64,
}

/// How near the pen comes to the vertices of a stroke.
#[derive(Default)]
struct Near {
    vertices: Vec<Point>,
    least_mm: Vec<f64>,
    cells: HashMap<(i64, i64), Vec<usize>>,
    last: Point,
}

impl Near {
    const CELL_MM: f64 = 0.25;

    fn cell(at: Point) -> (i64, i64) {
        ((at.x / Self::CELL_MM).floor() as i64, (at.y / Self::CELL_MM).floor() as i64)
    }

    fn of(vertices: Vec<Point>, first: Point) -> Self {
        let mut cells: HashMap<_, Vec<usize>> = HashMap::new();
        for (index, at) in vertices.iter().enumerate() {
            cells.entry(Self::cell(*at)).or_default().push(index);
        }
        let mut near = Self { least_mm: vec![f64::INFINITY; vertices.len()], vertices, cells, last: first };
        near.look(first);
        near
    }

    /// Looks at places two micrometres apart.
    fn pass(&mut self, place: Point) {
        if self.last.distance(place) > 0.002 {
            self.look(place);
        }
    }

    fn look(&mut self, place: Point) {
        self.last = place;
        let (x, y) = Self::cell(place);
        for cell in (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| (x, y))) {
            for index in self.cells.get(&cell).into_iter().flatten() {
                let away_mm = self.vertices[*index].distance(place);
                self.least_mm[*index] = self.least_mm[*index].min(away_mm);
            }
        }
    }

    fn farthest_mm(&self) -> f64 {
        self.least_mm.iter().copied().fold(0.0, f64::max)
    }
}

impl Sampler {
    fn until(&mut self, tick: u64) {
        let whole = (BIN_S * f64::from(CLOCK_HZ)) as u64;
        assert!(tick >= self.now, "steps in their order");
        while self.now < tick {
            let part = (tick - self.now).min(whole - self.filled);
            for axis in 0..2 {
                self.sum[axis] += self.at[axis] as f64 * part as f64;
            }
            (self.now, self.filled) = (self.now + part, self.filled + part);
            if self.filled == whole {
                let scale = 1.0 / (STEPS_PER_MM * whole as f64);
                self.means.push(Vec2::new(self.sum[0] * scale, self.sum[1] * scale));
                (self.sum, self.filled) = ([0.0; 2], 0);
            }
        }
    }

    fn place(&self) -> Point {
        Point::new(self.at[0] as f64 / STEPS_PER_MM, self.at[1] as f64 / STEPS_PER_MM)
    }

    fn take(&mut self, TimedEvent { tick, event }: TimedEvent) {
        self.until(tick);
        match event {
            MotorEvent::Step(StepPair { x, y }) => {
                self.at[0] += i64::from(x);
                self.at[1] += i64::from(y);
            }
            MotorEvent::Pen(Pen::Down) => {
                self.pen = Pen::Down;
                let place = self.place();
                let asked = self.asked.get(self.strokes.len()).cloned().unwrap_or_default();
                self.near = Near::of(asked, place);
                self.strokes.push(vec![place]);
            }
            MotorEvent::Pen(Pen::Up) if self.pen == Pen::Down => {
                self.pen = Pen::Up;
                self.near.look(self.place());
                self.from_pen_mm = self.from_pen_mm.max(self.near.farthest_mm());
            }
            _ => {}
        }
        if self.pen == Pen::Down
            && let (place, Some(stroke)) = (self.place(), self.strokes.last_mut())
        {
            self.near.pass(place);
            if stroke.last().is_none_or(|last| last.distance(place) > 0.02) {
                stroke.push(place);
            }
        }
    }
}

fn averaged(settings: PlannerSettings, jerk_mm_s3: f64, ops: &[PlotOp]) -> (Seen, Sampler) {
    let of = settings.averaged(jerk_mm_s3).unwrap();
    let timing = StepGenSettings { clock_hz: CLOCK_HZ, ..StepGenSettings::default() };
    let mut steps = Box::new(AveragedSteps::<ROOM>::new(of.window_ticks(CLOCK_HZ)));
    let mut sampler = Sampler {
        now: 0,
        at: [0; 2],
        sum: [0.0; 2],
        filled: 0,
        means: Vec::new(),
        pen: Pen::Up,
        strokes: Vec::new(),
        asked: strokes(ops),
        near: Near::default(),
        from_pen_mm: 0.0,
    };
    let end = run::<64>(
        of.settings,
        timing,
        STEPS_PER_MM,
        ops,
        |_, _, _| {},
        |tick, event| {
            steps.push(TimedEvent { tick, event }).unwrap();
            while let Some(event) = steps.next_event() {
                sampler.take(event);
            }
        },
    );
    while let Some(event) = steps.rest() {
        sampler.take(event);
    }
    sampler.until(end + steps.delay_ticks());
    let (planned_s, later_s) =
        (planned::<64>(of.settings, ops).0, steps.delay_ticks() as f64 / f64::from(CLOCK_HZ));
    let mut seen = Seen {
        time_s: planned_s + later_s,
        end: sampler.place(),
        from_pen_mm: sampler.from_pen_mm,
        ..Seen::default()
    };
    let over_s = ACCEL_BINS as f64 * BIN_S;
    let accel = |bins: &[Vec2]| {
        let [before, now, after] = [bins[0], bins[ACCEL_BINS], bins[2 * ACCEL_BINS]];
        (before - now * 2.0 + after) * (1.0 / (over_s * over_s))
    };
    let accels: Vec<Vec2> = sampler.means.windows(2 * ACCEL_BINS + 1).map(accel).collect();
    for bins in sampler.means.windows(ACCEL_BINS + 1) {
        seen.speed_mm_s = seen.speed_mm_s.max((bins[ACCEL_BINS] - bins[0]).length() / over_s);
    }
    seen.accel_mm_s2 = accels.iter().map(|accel| accel.length()).fold(0.0, f64::max);
    let jerk = |pair: &[Vec2]| (pair[JERK_BINS] - pair[0]).length() / (JERK_BINS as f64 * BIN_S);
    seen.jerk_mm_s3 = accels.windows(JERK_BINS + 1).map(jerk).fold(0.0, f64::max);
    (seen, sampler)
}

fn distance(at: Point, from: Point, to: Point) -> f64 {
    let (way, off) = (to - from, at - from);
    let square = way.dot(way);
    let share = if square > 0.0 { (off.dot(way) / square).clamp(0.0, 1.0) } else { 0.0 };
    (off - way * share).length()
}

fn farthest(places: &[Point], line: &[Point]) -> f64 {
    let nearest = |at: &Point| {
        let dot = line.first().map_or(f64::INFINITY, |first| first.distance(*at));
        line.windows(2).map(|ends| distance(*at, ends[0], ends[1])).fold(dot, f64::min)
    };
    places.iter().map(nearest).fold(0.0, f64::max)
}

/// The strokes of a drawing, arcs in short chords.
fn strokes(ops: &[PlotOp]) -> Vec<Vec<Point>> {
    let (mut strokes, mut at, mut is_down): (Vec<Vec<Point>>, _, _) = (Vec::new(), Point::ORIGIN, false);
    for op in chords(ops.iter().copied(), 1e-4) {
        if let PlotOp::Draw { to, .. } = op {
            if !is_down {
                strokes.push(vec![at]);
            }
            strokes.last_mut().unwrap().push(to);
        }
        is_down = matches!(op, PlotOp::Draw { .. });
        at = op.target().unwrap_or(at);
    }
    strokes
}

/// Checks one drawing; gives what was seen.
fn check(drawing: &Drawing, settings: PlannerSettings, jerk_mm_s3: f64) -> Seen {
    let (mut seen, sampler) = averaged(settings, jerk_mm_s3, &drawing.ops);
    let asked = strokes(&drawing.ops);
    assert_eq!(asked.len(), sampler.strokes.len(), "{}", drawing.name);
    for (asked, drawn) in asked.iter().zip(&sampler.strokes) {
        seen.from_drawing_mm = seen.from_drawing_mm.max(farthest(drawn, asked));
    }
    let what = format!("{}: {seen:.4?}", drawing.name);
    println!("{what}");
    let PathMode::Tolerance { path_tolerance_mm } = settings.path else { panic!("{what}") };
    assert!(seen.speed_mm_s <= MEASURED * settings.speed_mm_s.max(settings.travel_speed_mm_s), "{what}");
    let accel_mm_s2 = match settings.accel_limit {
        AccelLimit::Vector => settings.accel_mm_s2,
        AccelLimit::Axes { x_mm_s2, y_mm_s2 } => x_mm_s2.hypot(y_mm_s2),
        AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } => {
            sum_mm_s2.hypot(difference_mm_s2) / 2.0_f64.sqrt()
        }
    };
    assert!(seen.accel_mm_s2 <= MEASURED * accel_mm_s2, "{what}");
    OF_JERK.note(seen.jerk_mm_s3 / jerk_mm_s3);
    assert!(seen.jerk_mm_s3 <= MEASURED * jerk_mm_s3, "{what}");
    // A step of the average and one of the plan, and half of what lies between two places that are looked at.
    let most_mm = path_tolerance_mm + settings.resolution_mm + 2.0 / STEPS_PER_MM + 0.001;
    assert!(seen.from_drawing_mm <= most_mm && seen.from_pen_mm <= most_mm, "{what}");
    let end = drawing.ops.iter().rev().find_map(|op| op.target()).unwrap_or_default();
    assert!(seen.end.distance(end) <= 1.0 / STEPS_PER_MM, "{what}");
    seen
}

fn within(path_tolerance_mm: f64) -> PlannerSettings {
    let path = PathMode::Tolerance { path_tolerance_mm };
    PlannerSettings { path, ..PlannerSettings::default() }
}

/// Drawings take megabytes of steps: more than a test's own stack has.
fn on_a_large_stack(work: impl FnOnce() + Send + 'static) {
    std::thread::Builder::new().stack_size(1 << 24).spawn(work).unwrap().join().unwrap();
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_jerk_is_limited_as_a_vector_and_the_path_is_kept() {
    on_a_large_stack(|| {
        for drawing in [
            drawings::spiral(2),
            drawings::hatch(4),
            drawings::zigzag(60),
            drawings::circle(),
            drawings::arcs(),
        ] {
            check(&drawing, within(TOLERANCE_MM), JERK_MM_S3);
        }
    });
}

/// The same plan as it is, averaged over a microsecond.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_audit_sees_a_jerk_that_is_not_averaged() {
    on_a_large_stack(|| {
        let of = within(TOLERANCE_MM).averaged(JERK_MM_S3).unwrap();
        let (seen, _) = averaged(of.settings, 1e9, &drawings::hatch(4).ops);
        assert!(seen.jerk_mm_s3 > 1.5 * JERK_MM_S3, "{seen:?}");
    });
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn jobs_of_chance_keep_the_jerk_with_any_limits() {
    on_a_large_stack(|| {
        let mut random = drawings::chance(34);
        for _ in 0..12 {
            let accel_mm_s2 = 200.0 * 10.0_f64.powf(random());
            let weak = accel_mm_s2 * (0.2 + 0.8 * random());
            let accel_limit = match random() {
                ..0.3 => AccelLimit::Axes { x_mm_s2: weak, y_mm_s2: accel_mm_s2 },
                ..0.6 => AccelLimit::Belts { sum_mm_s2: accel_mm_s2, difference_mm_s2: weak },
                _ => AccelLimit::Vector,
            };
            let settings = PlannerSettings { accel_mm_s2, accel_limit, ..within(0.02 + 0.1 * random()) };
            let jerk_mm_s3 = accel_mm_s2 * (20.0 + 40.0 * random());
            let ops = drawings::job(&mut random);
            check(&Drawing { name: "of chance", ops }, settings, jerk_mm_s3);
        }
    });
}

/// Prints the table of docs/results/stepper-motion.md.
#[test]
#[ignore = "a minute in a release build: .ci/run runs it, and it is a table of docs/results/stepper-motion.md"]
fn table_of_whole_drawings() {
    on_a_large_stack(|| {
        println!("| | s | of the acceleration | of the jerk | pen from drawing, mm | drawing from pen, mm |");
        for drawing in sampled(drawings::built().into_iter().chain(drawings::real())) {
            let seen = check(&drawing, within(TOLERANCE_MM), JERK_MM_S3);
            println!(
                "| {} | {:.2} | {:.3} | {:.3} | {:.4} | {:.4} |",
                drawing.name,
                seen.time_s,
                seen.accel_mm_s2 / within(TOLERANCE_MM).accel_mm_s2,
                seen.jerk_mm_s3 / JERK_MM_S3,
                seen.from_drawing_mm,
                seen.from_pen_mm
            );
        }
    });
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn a_machine_of_a_file_has_it_too() {
    let machine = plotter_motion::Machine::new(MachineConfig::stepper_plotter()).unwrap();
    let settings = PlannerSettings::of(&machine);
    let settings = PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, ..settings };
    on_a_large_stack(move || {
        check(&drawings::zigzag(20), settings, 10_000.0);
    });
}

#[test]
fn each_kind_of_limit_is_kept_as_it_is_divided() {
    let axes = AccelLimit::Axes { x_mm_s2: 3000.0, y_mm_s2: 4000.0 };
    let found = PlannerSettings { accel_limit: axes, ..within(0.05) }.averaged(20_000.0).unwrap();
    let AccelLimit::Axes { x_mm_s2, y_mm_s2 } = found.settings.accel_limit else { panic!() };
    assert!((2.0 * x_mm_s2.hypot(y_mm_s2) / found.window_s - 20_000.0).abs() < 1e-6);
    assert!((x_mm_s2 / y_mm_s2 - 0.75).abs() < 1e-12);
    // Both motors at their limits move the pen along an axis, at as much.
    let belts = AccelLimit::Belts { sum_mm_s2: 100.0, difference_mm_s2: 100.0 };
    let found = PlannerSettings { accel_limit: belts, ..within(0.05) }.averaged(20_000.0).unwrap();
    let AccelLimit::Belts { sum_mm_s2, difference_mm_s2 } = found.settings.accel_limit else { panic!() };
    assert!((sum_mm_s2 - 100.0).abs() < 1e-9 && (difference_mm_s2 - 100.0).abs() < 1e-9);
    assert!((found.window_s - 0.01).abs() < 1e-12, "2 · 100 mm/s² / J");
}

#[test]
fn what_cannot_be_planned_is_refused() {
    let exact = PlannerSettings::default().averaged(20_000.0).unwrap_err();
    assert!(
        exact.to_string().starts_with("the jerk as a vector can be limited within a tolerance only"),
        "{exact}"
    );
    for jerk_mm_s3 in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = within(0.05).averaged(jerk_mm_s3).unwrap_err();
        assert!(matches!(refused, PlanError::Setting { quantity: "jerk_mm_s3", .. }), "{refused}");
    }
    for accel_mm_s2 in [0.0, f64::INFINITY] {
        let refused = PlannerSettings { accel_mm_s2, ..within(0.05) }.averaged(20_000.0).unwrap_err();
        assert!(matches!(refused, PlanError::Setting { quantity: "accel_mm_s2", .. }), "{refused}");
    }
    // As little jerk as would take days for a line is still a motion.
    let slow = within(0.05).averaged(0.001).unwrap();
    assert!(slow.settings.accel_mm_s2 > 0.001 && slow.window_ticks(1_000_000) < u32::MAX >> 1);
}
