//! Lower bound on the time of a jerk-limited motion along a planned path.
//!
//! Between two places that are passed at no more than V₁ and V₂ with the accelerations a₁ and a₂, a motion
//! whose jerk is within ±J covers in the time T no more than one with the jerk +J, −J, +J: the distance is
//! the integral of (T − t)²/2 times the jerk, the two speeds and accelerations fix those of 1 and T − t, and
//! what maximizes the one under the others changes its sign where a parabola does; nor can its speed exceed
//! what jerk and acceleration allow from either end. From that the least T for each stretch as a function of
//! both accelerations; and since neighbours share one, the least sum over a whole stroke by dynamic
//! programming over it. In cells, each with what favours the motion: so the sum is a bound. The speeds at
//! those places are the trapezoids', which no motion within the same acceleration exceeds anywhere. A line
//! from rest to rest has its optimum in closed form.

use crate::auditor;
use crate::drawings;

use auditor::planned;
use drawings::Drawing;
use plotter_motion::{MotionLimits, PathMode, Planner, PlannerSettings, planner::Action, profile::SCurve};

const JERK: f64 = 20_000.0;
/// Cells of the acceleration, from -A to A.
const CELLS: usize = 16;
/// Times are tried this far apart; what is found may be so much too long, and is made shorter by it.
const RATIO: f64 = 1.005;

/// Slower is at rest, mm/s.
const STANDSTILL_MM_S: f64 = 1e-6;

/// A stretch of path: its length, and the greatest speed at its end, mm and mm/s.
struct Stretch {
    length_mm: f64,
    exit: f64,
}

/// The ways from rest to rest of a drawing, with the speeds that trapezoids have at the ends of their
/// stretches.
fn runs(settings: PlannerSettings, drawing: &Drawing) -> Vec<Vec<Stretch>> {
    let mut planner = Planner::<1024>::new(settings).expect("settings of a machine");
    let mut ops = drawing.ops.iter().copied().peekable();
    let mut runs: Vec<Vec<Stretch>> = Vec::new();
    let mut begun_mm = None;
    loop {
        while planner.has_room()
            && let Some(op) = ops.next()
        {
            planner.push(op).expect("a good drawing");
        }
        if ops.peek().is_none() && planner.has_room() {
            planner.finish().expect("there is room");
        }
        match planner.next_action() {
            Some(Action::Course(course)) => begun_mm = Some(course.length_mm),
            Some(Action::Phase(phase)) => {
                let Some(length_mm) = begun_mm.take() else { continue };
                let stretch = Stretch { length_mm: f64::from(length_mm), exit: 0.0 };
                let speed_mm_s = f64::from(phase.speed_mm_s);
                match runs.last_mut().filter(|_| speed_mm_s > STANDSTILL_MM_S) {
                    Some(run) => {
                        if let Some(before) = run.last_mut() {
                            before.exit = speed_mm_s;
                        }
                        run.push(stretch);
                    }
                    None => runs.push(vec![stretch]),
                }
            }
            Some(_) => {}
            None => return runs,
        }
    }
}

/// Points at which the greatest speeds are taken.
const POINTS: u32 = 32;

/// Integral of the greatest speed that either end allows, the acceleration and the cruising speed within
/// their limits.
fn within_mm(t: f64, (entry, exit): (f64, f64), (a, b): (f64, f64), settings: PlannerSettings) -> f64 {
    let most = settings.accel_mm_s2;
    let reached = |from: f64, accel: f64, time: f64| {
        let to_most = ((most - accel) / JERK).min(time);
        let rest = time - to_most;
        from + to_most * (accel + 0.5 * JERK * to_most) + most * rest
    };
    let points = (0..POINTS).map(|point| {
        let at = t * (f64::from(point) + 0.5) / f64::from(POINTS);
        reached(entry, a, at).min(reached(exit, -b, t - at)).min(settings.speed_mm_s).max(0.0)
    });
    points.sum::<f64>() * t / f64::from(POINTS)
}

/// Whether no motion covers `length_mm` in the time `t`, with the speeds at both ends and the accelerations
/// there.
fn is_too_far(
    length_mm: f64,
    t: f64,
    (entry, exit): (f64, f64),
    (a, b): (f64, f64),
    settings: PlannerSettings,
) -> bool {
    // Whatever the accelerations are: the jerk is -J all the way.
    let free_mm = 0.5 * (entry + exit) * t + JERK * t * t * t / 12.0;
    // `a` is the most of its cell and `b` the least: only this way are they farther apart than the jerk
    // reaches.
    if free_mm < length_mm || b - a > JERK * t * (1.0 + 1e-9) {
        return true;
    }
    let middle = 0.5 * (t - (b - a) / JERK);
    if middle > 0.0 && middle < t {
        let begin = t - 0.5 * middle - (0.5 * t * t - (exit - entry - a * t) / JERK) / (2.0 * middle);
        // What can be reached at all grows with both speeds and `a`, and shrinks with `b`. Where these cannot
        // be reached, others of the cells may be: nothing is said then.
        if begin >= 0.0 && begin + middle <= t {
            // The integral of (T - t)²/2 times the jerk.
            let (late, early) = (t - begin - middle, t - begin);
            let of_jerk = JERK * (t * t * t / 6.0 - (early * early * early - late * late * late) / 3.0);
            if entry * t + 0.5 * a * t * t + of_jerk < length_mm {
                return true;
            }
        }
    }
    within_mm(t, (entry, exit), (a, b), settings) < length_mm
}

/// Least time for a stretch; from the first that could be enough on.
fn least_s(length_mm: f64, speeds: (f64, f64), accels: (f64, f64), settings: PlannerSettings) -> f64 {
    // Below this not even free accelerations suffice.
    let (mut low, mut high) = (0.0, 2.0 * length_mm / (speeds.0 + speeds.1).max(1e-9) + 10.0);
    for _ in 0..60 {
        let t = 0.5 * (low + high);
        let free_mm =
            (0.5 * (speeds.0 + speeds.1) * t + JERK * t * t * t / 12.0).min(settings.speed_mm_s * t);
        if free_mm >= length_mm { high = t } else { low = t }
    }
    let mut t = low.max(1e-9);
    // Ends: with time, any accelerations are possible and any way is covered.
    while is_too_far(length_mm, t, speeds, accels, settings) && t < 20.0 {
        t *= RATIO;
    }
    (t / RATIO).max(low)
}

/// Least time for a stroke.
#[expect(clippy::cast_precision_loss, reason = "a handful of cells")]
fn bound_s(run: &[Stretch], settings: PlannerSettings) -> f64 {
    let most = settings.accel_mm_s2;
    if let [only] = run {
        let limits = MotionLimits { speed_mm_s: settings.speed_mm_s, accel_mm_s2: most, jerk_mm_s3: JERK };
        return SCurve::plan(only.length_mm, limits).expect("a way of some length").duration_s();
    }
    let edge = |cell: usize| most * (2.0 * cell as f64 / CELLS as f64 - 1.0);
    // At rest it has no acceleration.
    let mut least = vec![(0.0, (0.0, 0.0))];
    let mut entry = 0.0;
    for stretch in run {
        let ends: Vec<(f64, f64)> = if stretch.exit > 0.0 {
            (0..CELLS).map(|cell| (edge(cell), edge(cell + 1))).collect()
        } else {
            vec![(0.0, 0.0)]
        };
        let next = ends.into_iter().map(|end| {
            let time_s = least
                .iter()
                .map(|(time_s, (_, begin))| {
                    // What favours the motion: it begins with the most acceleration, and ends with the least.
                    time_s + least_s(stretch.length_mm, (entry, stretch.exit), (*begin, end.0), settings)
                })
                .fold(f64::INFINITY, f64::min);
            (time_s, end)
        });
        least = next.collect();
        entry = stretch.exit;
    }
    least.into_iter().map(|(time_s, _)| time_s).fold(f64::INFINITY, f64::min)
}

/// Times of a drawing, s: trapezoids, S-curves, and the bound of these.
fn times(path: PathMode, drawing: &Drawing) -> (f64, f64, f64) {
    let settings = PlannerSettings { path, ..PlannerSettings::default() };
    let curved = PlannerSettings { jerk_mm_s3: Some(JERK), ..settings };
    let bound: f64 = runs(settings, drawing).iter().map(|run| bound_s(run, settings)).sum();
    (planned::<1024>(settings, &drawing.ops).0, planned::<1024>(curved, &drawing.ops).0, bound)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn no_motion_is_quicker_than_the_bound() {
    for drawing in [drawings::hatch(4), drawings::zigzag(25)] {
        let (plain, curved, bound) = times(PathMode::Exact, &drawing);
        assert!(bound <= curved, "{}: {curved} s, bound {bound} s", drawing.name);
        // And it says something: more than that trapezoids are quicker.
        assert!(bound > plain, "{}: {plain} s, bound {bound} s", drawing.name);
    }
    // 1 mm from rest to rest takes cbrt(32 L / j) = 0.11696 s; without knowing, the general way finds it too.
    let found = least_s(1.0, (0.0, 0.0), (0.0, 0.0), PlannerSettings::default());
    assert!((found / libm::cbrt(32.0 / JERK) - 1.0).abs() < RATIO - 1.0, "{found}");
}

/// Prints the table of docs/results/stepper-motion.md: no drawing is planned in less than the least time, nor
/// that below the trapezoid's.
#[test]
#[ignore = "a minute: the table of docs/results/stepper-motion.md, with the command that stands there"]
fn table_of_bounds() {
    println!("| drawing | trapezoid | bound | S-curve | bound / trapezoid | S-curve / bound |");
    let slow = ["zigzag", "owl", "curves", "curves in arcs", "Cassini"];
    let within = PathMode::Tolerance { path_tolerance_mm: 0.05 };
    for (mode, path) in [("exact", PathMode::Exact), ("within 0.05 mm", within)] {
        let drawings = drawings::built().into_iter().chain(drawings::real());
        for drawing in drawings.filter(|drawing| slow.contains(&drawing.name)) {
            let (plain, curved, bound) = times(path, &drawing);
            println!(
                "| {}, {mode} | {plain:.2} | {bound:.2} | {curved:.2} | {:.3} | {:.3} |",
                drawing.name,
                bound / plain,
                curved / bound
            );
            let name = drawing.name;
            assert!(
                plain <= bound && bound <= RATIO * curved,
                "{name}, {mode}: {plain}, {bound}, {curved} s"
            );
        }
    }
}
