//! Many joints before the judge.

use super::World;
use plotter_motion::Point;
use plotter_stitch::{Crossing, MarkSearch, ReferenceLines, RigidFit, sense::SearchSettings};

/// A joint is looked at in so many places: its ends, its middle, and between.
const PLACES: usize = 5;

/// What became of one joint.
#[derive(Clone, Copy, Debug)]
pub enum Verdict {
    /// The greatest of the distances at five places from end to end of the joint, mm; and the errors there
    /// along both axes over the deviations that were told for them.
    Told {
        off_mm: f64,
        z: [f64; 2 * PLACES],
    },
    Refused,
}

/// What is known of the pen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pen {
    /// What the estimator presumes.
    Presumed,
    /// The marks are looked for once where they were just drawn, before the paper moves.
    Seen,
}

/// One joint with its marks, under a head that knows only the layout.
pub fn trial(world: &World, lines: &ReferenceLines, pen: Pen, seed: u64) -> Verdict {
    let crossings: Vec<Crossing> = lines.crossings().collect();
    let [mut before, mut bench] = world.benches(lines, seed);
    let mut fit = RigidFit::on(lines);
    if pen == Pen::Seen {
        let mut search = MarkSearch::new(&crossings, SearchSettings::default());
        let seen = before.run(&mut search).ok().and_then(|_| {
            fit.with_pen_seen(&crossings, search.found().ok()?).map_err(|error| why(seed, &error)).ok()
        });
        let Some(seen) = seen else { return Verdict::Refused };
        fit = seen;
    }
    let mut search = MarkSearch::new(&crossings, SearchSettings::default());
    let told = bench.run(&mut search).ok().and_then(|_| {
        let found = search.found().ok()?;
        fit.estimate(&crossings, found).map_err(|error| why(seed, &error)).ok()
    });
    let Some(told) = told else { return Verdict::Refused };
    let place = |index: usize| lines.joint[0].lerp(lines.joint[1], index as f64 / (PLACES - 1) as f64);
    let off = |place: Point| told.to_machine(place) - bench.sheet().to_machine(place);
    let off_mm = (0..PLACES).map(|index| off(place(index)).length()).fold(0.0, f64::max);
    let mut z = [0.0; 2 * PLACES];
    for index in 0..PLACES {
        let (off, sigma) = (off(place(index)), told.sigma_at_mm(place(index)));
        (z[2 * index], z[2 * index + 1]) = (off.x / sigma.x, off.y / sigma.y);
    }
    if std::env::var("WHY").is_ok() && off_mm > 0.3 {
        println!("WRONG {seed}: {off_mm:.3} mm, {} of them agree", told.inlier_count());
    }
    Verdict::Told { off_mm, z }
}

/// Shows each refusal to who asks for it.
fn why(seed: u64, error: &dyn core::fmt::Display) {
    if std::env::var("WHY").is_ok() {
        println!("WHY {seed}: {error}");
    }
}

/// The same for all seeds of a range, on both cores.
pub fn many(seeds: core::ops::Range<u64>, each: impl Fn(u64) -> Verdict + Sync) -> Tally {
    let middle = u64::midpoint(seeds.start, seeds.end);
    let verdicts: Vec<Verdict> = std::thread::scope(|scope| {
        let threads = [seeds.start..middle, middle..seeds.end].map(|seeds| {
            let each = &each;
            scope.spawn(move || seeds.map(each).collect::<Vec<_>>())
        });
        threads.into_iter().flat_map(|thread| thread.join().unwrap()).collect()
    });
    Tally::of(&verdicts)
}

/// What many joints came to.
#[derive(Clone, Copy, Debug)]
pub struct Tally {
    pub joints: usize,
    pub refused: usize,
    /// More than 0.5 mm off.
    pub wrong: usize,
    pub p99_mm: f64,
    pub max_mm: f64,
    /// Of all errors, how many are beyond three of the deviations that were told for them.
    pub beyond: f64,
    /// Of all answers, how many have such an error.
    pub answers_beyond: f64,
}

impl Tally {
    fn of(verdicts: &[Verdict]) -> Self {
        let told = || {
            verdicts.iter().filter_map(|verdict| match verdict {
                Verdict::Told { off_mm, z } => Some((*off_mm, z)),
                Verdict::Refused => None,
            })
        };
        let mut off: Vec<f64> = told().map(|(off_mm, _)| off_mm).collect();
        off.sort_by(f64::total_cmp);
        let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
        let is_beyond = |z: &f64| z.abs() > 3.0;
        Self {
            joints: verdicts.len(),
            refused: verdicts.len() - off.len(),
            wrong: off.iter().filter(|mm| **mm > 0.5).count(),
            p99_mm: off.get(off.len() * 99 / 100).copied().unwrap_or(f64::NAN),
            max_mm: off.last().copied().unwrap_or(f64::NAN),
            beyond: share(
                told().flat_map(|(_, z)| z).filter(|z| is_beyond(z)).count(),
                2 * PLACES * off.len(),
            ),
            answers_beyond: share(told().filter(|(_, z)| z.iter().any(is_beyond)).count(), off.len()),
        }
    }
}

impl core::fmt::Display for Tally {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let share = |count: usize| 100.0 * count as f64 / self.joints as f64;
        write!(
            f,
            "p99 {:.4} max {:.4} mm, refused {:.2} %, wrong {:.2} % ({}), |z| > 3: {:.2} % of errors, {:.2} % of answers",
            self.p99_mm,
            self.max_mm,
            share(self.refused),
            share(self.wrong),
            self.wrong,
            100.0 * self.beyond,
            100.0 * self.answers_beyond,
        )
    }
}
