//! Simulated joints: how far lines miss each other at the border, by the published method and by ours.
//!
//! ```text
//! cargo test --release -p plotter-stitch --test all sim_joints:: -- --ignored --nocapture
//! ```

use crate::joints;

use joints::{Outcome, least_mean_square_mm2, many, ours, published, sheet};
use plotter_stitch::{
    Crossing, MarkSearch, Optics, ReferenceLines, RigidFit,
    sense::SearchSettings,
    sheet::{SensedJoint, SensorNoise},
};

/// Edges that are rough by 0.02 mm each leave their middle known to this, mm.
const LEAST_SINGLE_MM: f64 = 0.02 * std::f64::consts::FRAC_1_SQRT_2;

fn layout(crossings: usize) -> Vec<Crossing> {
    let lines = match crossings {
        16 => ReferenceLines::strip16(),
        24 => ReferenceLines::strip24(),
        _ => ReferenceLines::strip32(),
    };
    lines.crossings().collect()
}

fn with_faults(missed: f64, dust: f64) -> SensorNoise {
    SensorNoise { missed, dust, ..SensorNoise::default() }
}

/// The detector tells how much is covered, to 0.02 of the disc.
fn with_signal() -> SensorNoise {
    SensorNoise { gives_signal: true, signal: 0.02, ..SensorNoise::default() }
}

fn ours_on(joints: u64, crossings: &[Crossing], noise: SensorNoise) -> Outcome {
    many(joints, |joint| ours(joint, crossings, noise, &RigidFit::default()))
}

fn published_on(joints: u64, noise: SensorNoise) -> Outcome {
    many(joints, |joint| published(joint, noise))
}

/// Root of the mean square at the border's ends against the least that is possible, both mm.
fn against_the_least(crossings: &[Crossing], outcome: &Outcome) -> (f64, f64) {
    (outcome.ends_rms_mm, least_mean_square_mm2(crossings, LEAST_SINGLE_MM, 0.01).sqrt())
}

/// What a single crossing is known to, mm: paper and head disturb, the pen's offset is common to all.
fn single_crossing_mm(joints: u64, noise: SensorNoise) -> f64 {
    let noise = SensorNoise { pen_mm: 0.0, ..noise };
    let crossings = layout(32);
    let (mut squares, mut count) = (0.0, 0.0);
    for joint in 0..joints {
        let sheet = sheet(joint);
        let mut sensed = SensedJoint::new(&crossings, &sheet, Optics::default(), noise, joint);
        let mut search = MarkSearch::new(&crossings, SearchSettings::default());
        sensed.run(&mut search).unwrap();
        for found in search.found().unwrap() {
            squares += (found.at_mm - crossings[found.crossing].place_mm(&sheet)).powi(2);
            count += 1.0;
        }
    }
    f64::sqrt(squares / count)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn ours_joins_far_better_than_the_published_method_on_the_same_joints() {
    const JOINTS: u64 = 2_000;
    let published = published_on(JOINTS, SensorNoise::default());
    let ours = ours_on(JOINTS, &layout(16), SensorNoise::default());
    println!("published {published}\nours      {ours}");
    println!("figure: {:.4} mm, 99 %\nfigure: {:.4} mm at most", ours.p99_mm, ours.max_mm);
    // As long as the published tact: some tenths of a millimetre.
    assert!((0.4..0.55).contains(&published.p99_mm), "{published}");
    assert!(ours.p99_mm <= 0.045, "{ours}");
    assert!(ours.max_mm <= 0.075, "{ours}");
    assert_eq!(ours.silent, 0, "{ours}");
    let (rms_mm, least_mm) = against_the_least(&layout(16), &ours);
    // 2,000 joints know a root mean square to 2 %; hits without a signal cost 3 %.
    assert!((0.95 * least_mm..1.08 * least_mm).contains(&rms_mm), "{rms_mm} of {least_mm}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_told_covariance_is_that_of_the_errors() {
    let noises = [
        ("as expected", SensorNoise::default()),
        ("with a noisy signal", with_signal()),
        ("missed marks and dust", with_faults(0.05, 0.05)),
    ];
    for (what, noise) in noises {
        let outcome = ours_on(1_500, &layout(16), noise);
        println!("{what}: {outcome}");
        println!("figure: {:.2} squares, {what}", outcome.normalized[3] / 3.0);
        for square in outcome.normalized.into_iter().zip([1.0, 1.0, 1.0, 3.0]).map(|(square, is)| square / is)
        {
            // The mean of 1,500 squares of a normal number is known to 0.037: four of these.
            assert!((0.85..1.15).contains(&square), "{what}: {outcome}");
        }
        // A share of 95 % of 1,500: to 0.6 %.
        assert!((0.925..0.97).contains(&outcome.within95), "{what}: {outcome}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn what_is_wrong_with_the_marks_is_refused_or_does_no_harm() {
    const JOINTS: u64 = 1_500;
    for (missed, dust, most_silent) in [(0.02, 0.02, 3), (0.1, 0.05, 20), (0.25, 0.2, 250)] {
        let noise = with_faults(missed, dust);
        let (published, ours) = (published_on(JOINTS, noise), ours_on(JOINTS, &layout(16), noise));
        println!("{missed} missed, {dust} dust\npublished {published}\nours      {ours}");
        assert_eq!(ours.wrong, 0, "{ours}");
        assert!(ours.silent <= most_silent, "{ours}");
        assert!(published.wrong > 20, "{published}");
    }
}

/// The asked figures, on a hundred thousand joints, or as many as `PROFILE_JOINTS` says, and on a fifth of them
/// with faults.
#[test]
#[ignore = "half a million joints, eight minutes of a core in release; .ci/run runs a fifth of them"]
fn a_hundred_thousand_joints() {
    let joints = std::env::var("PROFILE_JOINTS").ok().and_then(|text| text.parse().ok()).unwrap_or(100_000);
    let faulty = joints / 5;
    let show = |what: &str, outcome: &Outcome| println!("{what:36} {outcome}");
    let signal = with_signal();
    println!(
        "single crossing: {:.4} mm by hits, {:.4} by the signal, least {LEAST_SINGLE_MM:.4}",
        single_crossing_mm(1_000, SensorNoise::default()),
        single_crossing_mm(1_000, signal),
    );
    show("published", &published_on(joints, SensorNoise::default()));
    for (crossings, p99_mm, max_mm) in [(16, 0.045, 0.075), (24, 0.037, 0.060), (32, 0.037, 0.060)] {
        let outcome = ours_on(joints, &layout(crossings), SensorNoise::default());
        show(&format!("ours, {crossings} crossings"), &outcome);
        let (rms_mm, least_mm) = against_the_least(&layout(crossings), &outcome);
        println!(
            "    at the ends {rms_mm:.5} mm rms, least {least_mm:.5}: {:.1} %",
            100.0 * rms_mm / least_mm
        );
        assert!(outcome.p99_mm <= p99_mm && outcome.max_mm <= max_mm, "{outcome}");
        // A mark whose edges are rough by chance in four deviations, and one more, may leave too little: one
        // joint in ten thousand.
        assert!(outcome.silent <= 10, "{outcome}");
    }
    show("ours, 16 crossings, signal", &ours_on(faulty, &layout(16), signal));
    let each = SensorNoise { texture_mm: 0.0, pen_mm: 0.0, mark_mm: 0.0245, ..SensorNoise::default() };
    show("each mark alone 0.0245 mm, 16", &ours_on(faulty, &layout(16), each));
    show("each mark alone 0.0245 mm, 32", &ours_on(faulty, &layout(32), each));
    for (missed, dust, most_wrong) in [(0.02, 0.02, 0), (0.1, 0.05, 2), (0.25, 0.2, 20)] {
        let noise = with_faults(missed, dust);
        let what = format!("{} % missed, {} % dust", 100.0 * missed, 100.0 * dust);
        show(&format!("{what}: published"), &published_on(faulty, noise));
        let outcome = ours_on(faulty, &layout(16), noise);
        show(&format!("{what}: ours"), &outcome);
        assert!(outcome.wrong <= most_wrong, "{outcome}");
    }
}
