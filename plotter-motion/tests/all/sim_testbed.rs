//! The control test bed on the loaded gantry: how hard it is, and what ours make of it, beside the figures of
//! a trial elsewhere.
//!
//! `cargo test --release -p plotter-motion --test all sim_testbed:: -- --nocapture` prints the tables;
//! `cargo run --release --example compare_controllers` gives them with pictures.

#![cfg(feature = "alloc")]

use crate::loaded_gantry;
use crate::papers::row_of;

use loaded_gantry::loaded_gantry;
use plotter_motion::testbed::{Drawing, Entry, Ranking, Score, TestBed, TestBedSettings};
use plotter_motion::{
    Machine, MachineConfig,
    config::{Decoding, MachineName},
};

/// The machine of examples/machines/loaded-gantry.toml, or of loaded-gantry-x4.toml.
fn described(decoding: Decoding) -> MachineConfig {
    let mut config = loaded_gantry(decoding);
    config.name = MachineName::new("loaded-gantry").unwrap();
    if decoding == Decoding::X4 {
        config.name = MachineName::new("loaded-gantry-x4").unwrap();
        let contouring = &mut config.dc_mut().unwrap().control.contouring;
        (contouring.bandwidth_hz, contouring.observer_hz) = (100.0, 500.0);
    }
    config
}

/// The ranking of the entries with these names on the eight lines, with descriptions that are wrong by
/// `share`.
fn ranking(decoding: Decoding, share: f64, names: &[&str]) -> Ranking {
    let machine = Machine::new(described(decoding)).unwrap();
    let settings = TestBedSettings { wrong_share: share, ..TestBedSettings::default() };
    let bed = TestBed::new(&machine, settings).unwrap();
    let mut entries = Entry::standard();
    entries.retain(|entry| names.contains(&entry.name()));
    assert_eq!(entries.len(), names.len());
    let ranking = Ranking::run(&entries, &bed, &Drawing::star(&bed));
    println!("\n{}, described wrongly by {share}\n{ranking}", machine.config().name);
    ranking
}

fn score<'a>(ranking: &'a Ranking, name: &str) -> &'a Score {
    ranking.scores().iter().find(|score| score.entry == name).unwrap()
}

/// Asserts the figures of README.md: `place` is 0 for x1 and 1 for x4.
fn assert_shown(ranking: &Ranking, place: usize) {
    let Some(row) = row_of("README.md", "the same with ten times the inertia, described 25 % wrong") else {
        return;
    };
    let figures = |text: &str| {
        let pair = text.trim_end_matches(" mm").split(", ");
        pair.map(str::to_owned).collect::<Vec<_>>()
    };
    let ours = row[2].strip_prefix("cross-coupled ").unwrap();
    let (ours, learning) = ours.split_once("; with learning ").unwrap();
    let rms = |name| score(ranking, name).total().rms_mm();
    assert_eq!(figures(&row[1])[place], format!("{:.3}", rms("published")));
    assert_eq!(figures(ours)[place], format!("{:.4}", rms("cross-coupled")));
    assert_eq!(figures(learning)[place], format!("{:.4}", rms("learning")));
}

fn um(mm: f64) -> f64 {
    mm * 1e3
}

/// Figures of a trial elsewhere, um: its published PID, 393 rms and 1687 at worst, did not settle on two of
/// eight lines.
const TRIAL_PUBLISHED_UM: (f64, f64) = (393.0, 1687.0);

/// Every line finished and settled, within these, um.
fn assert_within(ranking: &Ranking, name: &str, rms_um: f64, max_um: f64) {
    let score = score(ranking, name);
    assert_eq!((score.finished(), score.settled()), (8, 8), "{name}");
    let total = score.total();
    let (rms, max) = (um(total.rms_mm()), um(total.max_mm));
    assert!(rms <= rms_um && max <= max_um, "{name}: {rms} um rms, {max} um at most");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_plant_is_at_least_as_hard_for_the_published_controller_as_the_trial_s() {
    for decoding in [Decoding::X1, Decoding::X4] {
        let ranking = ranking(decoding, 0.25, &["published"]);
        let published = score(&ranking, "published");
        assert!(um(published.total().rms_mm()) >= TRIAL_PUBLISHED_UM.0);
        assert!(um(published.total().max_mm) >= TRIAL_PUBLISHED_UM.1);
        assert!(published.settled() <= 6, "two lines of eight at least do not settle");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn with_x1_encoders_and_a_wrong_description_ours_has_less_than_a_hundredth() {
    for share in [0.25, -0.25] {
        let ranking = ranking(
            Decoding::X1,
            share,
            &["published", "contouring", "planned-pid", "feed-forward", "cross-coupled", "learning"],
        );
        if share == 0.25 {
            assert_shown(&ranking, 0);
        }
        let published = score(&ranking, "published").total().rms_mm();
        for name in ["contouring", "planned-pid", "feed-forward", "cross-coupled", "learning"] {
            // the trial's 3.0 um rms; its 15 um at most are a share of what its published controller had
            let most = 15.0 / TRIAL_PUBLISHED_UM.1 * um(score(&ranking, "published").total().max_mm);
            assert_within(&ranking, name, 3.0, most);
            assert!(published / score(&ranking, name).total().rms_mm() >= 100.0, "{name}");
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn with_x4_encoders_ours_has_less_than_a_three_hundredth_and_with_learning_an_eight_hundredth() {
    for share in [0.25, -0.25] {
        let names = ["published", "contouring", "planned-pid", "feed-forward", "cross-coupled", "learning"];
        let ranking = ranking(Decoding::X4, share, &names);
        if share == 0.25 {
            assert_shown(&ranking, 1);
        }
        let published = score(&ranking, "published").total().rms_mm();
        // the trial's figures for each, and a tenth of a micrometre and two for the greatest of contouring
        // and cross-coupled: what the first edges say of the motor is taken in later than it was by an
        // estimator that was told less
        for (name, rms_um, max_um, times) in [
            ("planned-pid", 2.8, 12.0, 300.0),
            ("contouring", 1.1, 6.6, 300.0),
            ("feed-forward", 1.1, 6.4, 300.0),
            ("cross-coupled", 0.84, 5.0, 300.0),
            ("learning", 0.49, 2.7, 800.0),
        ] {
            assert_within(&ranking, name, rms_um, max_um);
            assert!(published / score(&ranking, name).total().rms_mm() >= times, "{name}");
        }
    }
}

#[cfg(feature = "toml")]
#[test]
fn the_files_describe_the_plants_of_these_tests() {
    for decoding in [Decoding::X1, Decoding::X4] {
        let config = described(decoding);
        let file = format!("{}/../examples/machines/{}.toml", env!("CARGO_MANIFEST_DIR"), config.name);
        let Ok(text) = std::fs::read_to_string(&file) else {
            eprintln!("{file} is not here: nothing to compare");
            continue;
        };
        assert_eq!(MachineConfig::from_toml(&text), Ok(config));
    }
}

#[cfg(feature = "toml")]
#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_preset_with_dc_motors_is_a_test_bed() {
    for name in ["worn-gantry", "marking-board-motors", "semi-virtual-gantry"] {
        let file = format!("{}/../examples/machines/{name}.toml", env!("CARGO_MANIFEST_DIR"));
        let Ok(text) = std::fs::read_to_string(&file) else {
            eprintln!("{file} is not here: nothing to compare");
            continue;
        };
        let machine = Machine::from_toml(&text).unwrap_or_else(|error| panic!("{file}: {error}"));
        assert_eq!(machine.config().name.as_str(), name);
        let bed = TestBed::new(&machine, TestBedSettings::default()).unwrap();
        let entries = Entry::standard();
        let pid = entries.iter().find(|entry| entry.name() == "planned-pid").unwrap();
        let figures = pid.run(&bed, &Drawing::line(&bed, 30.0, 10.0), |_| ());
        assert!(figures.is_finished() && figures.settled.is_some(), "{name}: {figures:?}");
    }
}
