//! The sections of a machine's file that this crate reads, and their refusals.

use plotter_motion::Machine;
use plotter_motion::config::{ConfigError, FileName, Key, MachineConfig, Section, TomlError};
use plotter_vector::follow::FollowerConfig;
use plotter_vector::trace::{PensChoice, VectorizeConfig};
use plotter_vector::{Mode, ThresholdMethod};
use std::{fs, path::Path};

fn read<S: Section + serde::de::DeserializeOwned>(rest: &str) -> Result<S, TomlError> {
    Machine::from_toml_with(&format!("schema = 1\n{rest}\n")).map(|(_, section)| section)
}

fn message<S: Section + serde::de::DeserializeOwned>(rest: &str) -> String {
    read::<S>(rest).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

fn is_out_of_range<S>(outcome: &Result<S, TomlError>) -> bool {
    matches!(outcome, Err(TomlError::Invalid { error: ConfigError::OutOfRange { .. }, .. }))
}

#[test]
fn a_section_is_read_beside_the_machine() {
    let text = "schema = 1\narea.width_mm = 300\n[vectorize]\nmode = \"mixed\"\nthreshold = 128\npens = 3\n\
                [follower]\ncamera_x_mm = -20\n";
    let (machine, vectorize) = Machine::from_toml_with::<VectorizeConfig>(text).unwrap();
    assert_eq!(machine.config().area.width_mm, 300.0);
    assert_eq!((vectorize.mode, vectorize.threshold), (Mode::Mixed, ThresholdMethod::Level(128)));
    assert_eq!(vectorize.pens, PensChoice::Count(3));
    let (_, follower) = Machine::from_toml_with::<FollowerConfig>(text).unwrap();
    assert_eq!(follower.camera_x_mm, -20.0);
    assert_eq!(read::<VectorizeConfig>(""), Ok(VectorizeConfig::default()));
}

#[test]
fn what_is_wrong_is_told_with_its_place_and_what_would_be_right() {
    let said = message::<VectorizeConfig>;
    assert_eq!(
        said("[vectorize]\nmax_eror_px = 1"),
        "line 3, column 1: unknown key `vectorize.max_eror_px`; did you mean `max_error_px`?"
    );
    assert_eq!(
        said("[vectorize]\nhatch_cm = 0.1"),
        "line 3, column 1: unknown key `vectorize.hatch_cm`; the unit here is mm: write `hatch_mm = 1`"
    );
    assert_eq!(
        said("[vectorize]\nbaud = 9600"),
        "line 3, column 1: unknown key `vectorize.baud`; `baud` belongs under [serial]"
    );
    assert_eq!(
        said("max_error_px = 1"),
        "line 2, column 1: unknown key `max_error_px`; `max_error_px` belongs under [vectorize]"
    );
    assert_eq!(
        said("[vectorize]\n\nmax_error_px = 0"),
        "line 4, column 16: vectorize.max_error_px: 0 px lies outside 0.01..=100 px; 0.5 is half a pixel"
    );
    assert_eq!(
        said("[vectorize]\nmode = \"outlin\""),
        "line 3, column 8: vectorize.mode: the text \"outlin\"; write \"centreline\" or \"outline\" or \"mixed\": did you mean \
         \"outline\"?"
    );
    assert_eq!(
        said("[vectorize]\nthreshold = true"),
        "line 3, column 13: vectorize.threshold: true; write \"auto\", \"otsu\", \"adaptive\" or a level from 0 to 255"
    );
    assert!(is_out_of_range(&read::<VectorizeConfig>("vectorize.threshold = 256")));
    assert_eq!(
        said("[vectorize]\ncurves = true"),
        "line 3, column 1: unknown key `vectorize.curves`; write `pieces = \"cubics\"` for `curves = true`, and nothing for \
         `curves = false`"
    );
    assert_eq!(
        message::<FollowerConfig>("[follower]\nkerf_mm = -1"),
        "line 3, column 11: follower.kerf_mm: -1 mm lies outside 0..=50 mm; 0 for a pen; a plasma torch takes 1 to 3"
    );
    // The first of the file, whoever owns it.
    assert!(said("[vectorize]\nzzz = 1\n[area]\naaa = 1").starts_with("line 3"));
    assert!(said("[area]\naaa = 1\n[vectorize]\nzzz = 1").starts_with("line 3"));
}

#[test]
fn pens_are_a_number_auto_or_a_palettes_file() {
    let pens = |value: &str| read::<VectorizeConfig>(&format!("vectorize.pens = {value}"));
    let read_pens = |value: &str| pens(value).map(|config| config.pens);
    assert_eq!(read_pens("3"), Ok(PensChoice::Count(3)));
    assert_eq!(read_pens("\"auto\""), Ok(PensChoice::Auto));
    assert_eq!(read_pens("\"pens.toml\""), Ok(PensChoice::Palette(FileName::new("pens.toml").unwrap())));
    assert!(is_out_of_range(&pens("17")) && is_out_of_range(&pens("-1")));
    let said = pens("\"three\"").unwrap_err().to_string();
    assert!(said.starts_with("line 2, column 18: vectorize.pens") && said.contains("\"auto\""), "{said}");
    let bytes = FileName::MAX_BYTES.to_string();
    assert!(said.contains(&format!("at most {bytes} bytes")), "{said}");
    let long = format!("\"{}.toml\"", "x".repeat(FileName::MAX_BYTES));
    assert!(pens(&long).is_err());
    assert!(read::<VectorizeConfig>(&format!("vectorize.overlay = {long}")).is_err());
}

/// Every number of a section: none, infinite or beyond either end is refused, the ends themselves are not.
fn the_ranges_hold<S: Section + serde::de::DeserializeOwned + Clone>() {
    for (key, ((least, most), _)) in S::keys().iter().filter_map(|key| Some((key.key(), key.range()?))) {
        let with = |value: &str| read::<S>(&format!("{key} = {value}"));
        let whole =
            key.ends_with("pens") || key.ends_with("_px") && most == 512.0 || key.ends_with("threads");
        let whole = whole || key.ends_with("threshold");
        for value in [least - 1.0, most + 1.0] {
            match with(&format!("{value}")) {
                Err(TomlError::Invalid { at: Some(_), error }) => assert_eq!(error.key(), key),
                other => panic!("{key} = {value}: {:?}", other.err()),
            }
        }
        for value in [least, most] {
            let outcome = with(&format!("{value}"));
            assert!(outcome.is_ok(), "{key} = {value}: {:?}", outcome.err());
        }
        if !whole {
            for value in ["nan", "inf", "-inf"] {
                assert!(is_out_of_range(&with(value)), "{key} = {value}");
            }
        }
    }
}

#[test]
fn no_number_lies_outside_of_its_range() {
    the_ranges_hold::<VectorizeConfig>();
    the_ranges_hold::<FollowerConfig>();
}

#[test]
fn the_check_is_the_same_without_a_file() {
    let mut config = VectorizeConfig::default();
    config.max_error_px = f64::NAN;
    let refused = config.checked(&MachineConfig::default()).unwrap_err();
    assert_eq!(refused.key(), "vectorize.max_error_px");
}

/// A file of the repository beside this crate; a crate unpacked alone does not have it.
fn beside_the_crate(path: &str) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    let text = fs::read_to_string(&path).ok();
    if text.is_none() {
        eprintln!("{} is not here: nothing to compare", path.display());
    }
    text
}

/// The row of each key in the documentation: its unit, its range and its default.
fn is_documented<S: Section>() {
    let Some(page) = beside_the_crate("docs/machine-config.md") else { return };
    for key in S::keys() {
        let row = page.lines().find(|line| line.contains(&format!("| `{}` |", key.key())));
        let cells: Vec<_> =
            row.unwrap_or_else(|| panic!("no row for `{}`", key.key())).split('|').map(str::trim).collect();
        let Some(((least, most), unit)) = key.range().filter(|_| !cells[3].contains('"')) else { continue };
        assert_eq!(cells[2], unit, "unit of `{}`", key.key());
        let (low, high) = cells[3].split_once("..").unwrap();
        assert_eq!((low.parse(), high.parse()), (Ok(least), Ok(most)), "range of `{}`", key.key());
        assert_eq!(cells[4].parse().ok(), key.value(&S::default()), "default of `{}`", key.key());
    }
    let of_the_section = page.lines().filter(|line| line.starts_with(&format!("| `{}.", S::NAME))).count();
    assert_eq!(of_the_section, S::keys().len());
    assert!(S::keys().iter().map(Key::key).all(|key| key.starts_with(S::NAME)));
}

#[test]
fn the_documentation_page_gives_every_key_with_its_range_and_default() {
    is_documented::<VectorizeConfig>();
    is_documented::<FollowerConfig>();
}

#[test]
fn a_preset_says_what_the_code_says() {
    for name in
        ["semi-virtual-gantry", "stepper-plotter", "marking-board", "textile-plotter", "plasma-follower"]
    {
        let Some(text) = beside_the_crate(&format!("examples/machines/{name}.toml")) else { return };
        let (_, vectorize) = Machine::from_toml_with::<VectorizeConfig>(&text).unwrap();
        assert_eq!(vectorize, VectorizeConfig::default(), "{name}");
        let (_, follower) = Machine::from_toml_with::<FollowerConfig>(&text).unwrap();
        assert_eq!(follower, FollowerConfig::default(), "{name}");
    }
}
