//! Joints under the judge, the second simulator: what the first one cannot show, since estimator and
//! simulator share their optics.
//!
//! ```text
//! TABLE=faults SEEDS=7000000..7020000 cargo test --release -p plotter-stitch --test all sim_judge:: -- --ignored --nocapture
//! TABLE=straight SEEDS=7000000..7020000 cargo test --release -p plotter-stitch --test all sim_judge:: -- --ignored --nocapture
//! TABLE=pattern SEEDS=7000000..7020000 cargo test --release -p plotter-stitch --test all sim_judge:: -- --ignored --nocapture
//! ```
//!
//! `WORLD=hatching` takes the rows of a table alone whose names have that in them.

use crate::judge::{Chance, Pen, Stroke, World, many, trial};
use plotter_motion::Axis;
use plotter_stitch::{Field, MarkGroup, ReferenceLines};

/// Which joints: `SEEDS=from..to`.
fn seeds(or: core::ops::Range<u64>) -> core::ops::Range<u64> {
    let Ok(text) = std::env::var("SEEDS") else { return or };
    let (from, to) = text.split_once("..").expect("SEEDS=from..to");
    from.parse().unwrap()..to.parse().unwrap()
}

/// The marks of `strip16` in straight rows, as they would stand without their pattern.
fn rows() -> ReferenceLines {
    let marks = |axis, at_mm: &[f64], scans_mm: &[f64]| MarkGroup {
        axis,
        at_mm: at_mm.into(),
        scans_mm: scans_mm.into(),
    };
    ReferenceLines {
        schema: 1,
        joint: Field::default().joint(),
        marks: vec![
            marks(Axis::Y, &[-34.0, -8.0, 18.0, 44.0, 70.0], &[-32.0, 2_032.0]),
            marks(Axis::X, &[-10.0, 2_010.0], &[-21.0, 31.0, 57.0]),
        ],
    }
}

/// The axes across and along the joint, in which marks are known.
fn axes(lines: &ReferenceLines) -> [Axis; 2] {
    let way = lines.joint[1] - lines.joint[0];
    if way.y.abs() > way.x.abs() { [Axis::X, Axis::Y] } else { [Axis::Y, Axis::X] }
}

fn beside(lines: &ReferenceLines, axes: &[Axis], at_mm: &[f64], slant_mm: f64) -> Vec<Stroke> {
    let strokes = |&axis| at_mm.iter().flat_map(move |&mm| Stroke::beside(lines, axis, mm, slant_mm));
    axes.iter().flat_map(strokes).collect()
}

/// Strokes from one side of a row to the other, the row between two of them.
fn hatching(pitch_mm: f64) -> Vec<f64> {
    (-4..4).map(|n| (f64::from(n) + 0.5) * pitch_mm).collect()
}

/// What is the matter, and its name.
fn faults() -> Vec<(&'static str, World)> {
    let usual = World::default;
    vec![
        ("as presumed", usual()),
        ("2 % missed, 2 % dust", World { missed: 0.02, dust: 0.02, ..usual() }),
        ("10 % missed, 5 % dust", World { missed: 0.1, dust: 0.05, ..usual() }),
        ("pen beside head by 0.05 mm", World { pen_mm: 0.05, ..usual() }),
        ("bow of 0.1 mm", World { bow_mm: 0.1, ..usual() }),
        ("swelling of 0.02 %", World { swelling: 2e-4, ..usual() }),
        ("swelling, twice that across", World { swelling: 2e-4, grain: 2.0, ..usual() }),
        ("delays 2 ms apart", World { latency_s: [1.05e-3, -0.95e-3], ..usual() }),
        ("delays of 2.1 and 0.1 ms", World { latency_s: [0.1e-3, 2.1e-3], ..usual() }),
        ("30 % smeared", World { smeared: 0.3, ..usual() }),
        ("line of 0.3 mm", World { line_mm: 0.3, ..usual() }),
        ("line of 0.7 mm", World { line_mm: 0.7, ..usual() }),
        (
            "pen, delays and swelling at once",
            World { pen_mm: 0.05, latency_s: [1.05e-3, -0.95e-3], swelling: 2e-4, ..usual() },
        ),
    ]
}

fn drawings(lines: &ReferenceLines) -> Vec<(&'static str, World)> {
    let [across, along] = axes(lines);
    let both = [across, along];
    let world = |strokes: Vec<Stroke>, missed: f64| World { strokes, missed, ..World::default() };
    vec![
        ("a stroke 3 mm beside the rows across", world(beside(lines, &[across], &[3.0], 0.0), 0.0)),
        ("the same on the other side", world(beside(lines, &[across], &[-3.0], 0.0), 0.0)),
        ("the same, 10 % missed", world(beside(lines, &[across], &[-3.0], 0.0), 0.1)),
        ("a stroke 3 mm beside the rows along", world(beside(lines, &[along], &[-3.0], 0.0), 0.0)),
        ("the same along, 10 % missed", world(beside(lines, &[along], &[-3.0], 0.0), 0.1)),
        ("strokes beside all, 60 % missed", world(beside(lines, &both, &[-3.0], 0.0), 0.6)),
        ("slanted strokes beside all, 30 % missed", world(beside(lines, &both, &[2.0], 1.5), 0.3)),
        ("hatching 5 mm apart across", world(beside(lines, &[across], &hatching(5.0), 0.0), 0.0)),
        ("hatching 5 mm apart everywhere", world(beside(lines, &both, &hatching(5.0), 0.0), 0.0)),
        ("hatching 2 mm apart everywhere", world(beside(lines, &both, &hatching(2.0), 0.0), 0.0)),
    ]
}

/// A stroke beside each row, each somewhere else and slanted otherwise.
fn strokes_anywhere(lines: &ReferenceLines, missed: f64, seed: u64) -> World {
    let mut chance = Chance::new(seed ^ 0x5EED);
    let mut up_to = |most: f64| most * (2.0 * chance.unit() - 1.0);
    let strokes =
        axes(lines).map(|axis| Stroke::beside_each(lines, axis, || [up_to(8.0), up_to(4.0)])).concat();
    World { strokes, missed, ..World::default() }
}

/// Copies of the marks themselves, the pattern too.
fn copies(lines: &ReferenceLines) -> Vec<(&'static str, World)> {
    let [across, along] = axes(lines);
    let of = |axes: &[Axis], mm: &[f64]| -> Vec<Stroke> {
        axes.iter().flat_map(|&axis| mm.iter().flat_map(move |&mm| Stroke::copies(lines, axis, mm))).collect()
    };
    let world = |strokes: Vec<Stroke>, missed: f64| World { strokes, missed, ..World::default() };
    vec![
        ("marks across copied 3 mm beside", world(of(&[across], &[-3.0]), 0.0)),
        ("the same, 10 % missed", world(of(&[across], &[-3.0]), 0.1)),
        ("all marks copied, 60 % missed", world(of(&[across, along], &[-3.0]), 0.6)),
        ("marks across copied every 5 mm", world(of(&[across], &[-7.5, -2.5, 2.5, 7.5]), 0.0)),
    ]
}

/// The judge sees what is wrong: without looking for swelling, and with a pen that nobody looked at, it says
/// so.
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_is_not_looked_for_is_found_by_the_judge() {
    let lines = ReferenceLines::strip16();
    let pen = World { pen_mm: 0.05, ..World::default() };
    let presumed = many(0..300, |seed| trial(&pen, &lines, Pen::Presumed, seed));
    assert!(presumed.answers_beyond > 0.3 && presumed.p99_mm > 0.12, "{presumed}");
    let seen = many(0..300, |seed| trial(&pen, &lines, Pen::Seen, seed));
    assert!(seen.answers_beyond < 0.02 && seen.p99_mm < 0.045, "{seen}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn pens_papers_and_heads_that_nobody_presumed_are_told_honestly() {
    let lines = ReferenceLines::strip16();
    for (what, world) in faults() {
        let tally = many(0..60, |seed| trial(&world, &lines, Pen::Seen, seed));
        // Marks beside the field show nothing of a bow between them: it stays in the middle of the joint, and
        // in the deviation that is told there. Three and a half of its own deviations in 60 sheets, 0.1 mm
        // each.
        let most_mm = if world.bow_mm > 0.0 { 0.36 } else { 0.13 };
        assert!(
            tally.wrong == 0 && tally.p99_mm < most_mm && tally.answers_beyond <= 0.05,
            "{what}: {tally}"
        );
        assert!(tally.refused <= 12, "{what}: {tally}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn strokes_of_the_drawing_are_never_taken_for_marks() {
    let (straight, pattern) = (rows(), ReferenceLines::strip16());
    for lines in [&straight, &pattern] {
        for (what, world) in drawings(lines) {
            let tally = many(0..25, |seed| trial(&world, lines, Pen::Presumed, seed));
            // Strokes beside straight rows with most marks missing are all that is seen once in a hundred
            // times.
            assert!(
                tally.wrong <= usize::from(what.contains("60 %") && lines == &straight),
                "{what}: {tally}"
            );
        }
    }
    for missed in [0.0, 0.3] {
        let tally = many(0..100, |seed| {
            trial(&strokes_anywhere(&pattern, missed, seed), &pattern, Pen::Presumed, seed)
        });
        assert_eq!(tally.wrong, 0, "strokes anywhere, {missed} missed: {tally}");
    }
    // One stroke beside marks with a pattern stops nothing.
    let (what, world) = drawings(&pattern).swap_remove(0);
    let tally = many(0..100, |seed| trial(&world, &pattern, Pen::Presumed, seed));
    assert!(tally.refused <= 3 && tally.p99_mm < 0.06, "{what}: {tally}");
}

#[test]
#[ignore = "tables of docs/results/joints.md: some 800,000 joints, twenty minutes in release, by hand with the commands above"]
fn tables() {
    let (straight, lines) = (rows(), ReferenceLines::strip16());
    let is_wanted = |what: &str| std::env::var("WORLD").map_or(true, |part| what.contains(&part));
    let wanted = |part: &str| std::env::var("TABLE").is_ok_and(|table| table == part);
    if wanted("faults") {
        for (what, world) in faults().into_iter().filter(|(what, _)| is_wanted(what)) {
            for pen in [Pen::Presumed, Pen::Seen] {
                let tally = many(seeds(0..2_000), |seed| trial(&world, &lines, pen, seed));
                println!("{what:36} {pen:8?} {tally}");
            }
        }
    }
    for (name, lines) in [("straight", &straight), ("pattern", &lines)] {
        if wanted(name) {
            let worlds = drawings(lines).into_iter().chain(copies(lines));
            for (what, world) in worlds.filter(|(what, _)| is_wanted(what)) {
                let tally = many(seeds(0..2_000), |seed| trial(&world, lines, Pen::Presumed, seed));
                println!("{what:42} {name:8} {tally}");
            }
            for missed in [0.0, 0.1, 0.3] {
                let what = format!("strokes anywhere beside all, {} % missed", 100.0 * missed);
                if is_wanted(&what) {
                    let tally = many(seeds(0..2_000), |seed| {
                        trial(&strokes_anywhere(lines, missed, seed), lines, Pen::Presumed, seed)
                    });
                    println!("{what:42} {name:8} {tally}");
                }
            }
        }
    }
}
