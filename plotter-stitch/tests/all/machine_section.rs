//! The section of a machine's file that this crate reads, and its refusals.

use plotter_motion::Machine;
use plotter_motion::config::{MachineConfig, Section, TomlError};
use plotter_stitch::sheet::SheetConfig;
use std::{fs, path::Path};

const TEXTILE: &str =
    "schema = 1\narea = { width_mm = 2000, height_mm = 1000 }\nx.counts_per_mm = 1\ny.counts_per_mm = 1\n";

fn read(rest: &str) -> Result<SheetConfig, TomlError> {
    Machine::from_toml_with(&format!("{TEXTILE}{rest}\n")).map(|(_, sheet)| sheet)
}

fn message(rest: &str) -> String {
    read(rest).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

#[test]
fn what_is_not_named_is_the_documented_machines() {
    assert_eq!(read(""), Ok(SheetConfig::default()));
    assert_eq!(read("sheet.frame_mm = 950"), Ok(SheetConfig::textile_plotter()));
}

#[test]
fn what_is_wrong_is_told_with_its_place_and_what_would_be_right() {
    assert_eq!(
        message("[sheet]\nframe_cm = 95"),
        "line 6, column 1: unknown key `sheet.frame_cm`; the unit here is mm: write `frame_mm = 950`"
    );
    assert_eq!(
        message("[sheet]\nsensing_mm_s = 0"),
        "line 6, column 16: sheet.sensing_mm_s: 0 mm/s lies outside 1..=10000 mm/s; the documented textile plotter senses \
         at 300"
    );
    assert_eq!(message("[sheat]"), "line 5, column 2: unknown key `sheat`; did you mean `sheet`?");
}

#[test]
fn a_frame_lies_in_the_area_with_the_windows_at_its_borders() {
    assert_eq!(message("sheet.frame_mm = 975"), "accepted");
    assert_eq!(
        message("sheet.frame_mm = 976"),
        "line 5, column 18: sheet.frame_mm: 976 mm must be at most 975 mm; the frame ends within the area: area.height_mm \
         less sheet.begin_mm and sheet.cut_window_mm"
    );
    assert_eq!(
        message("[sheet]\nframe_mm = 900\ncut_window_mm = 21"),
        "line 7, column 17: sheet.cut_window_mm: 21 mm must be at most 20 mm; the frame before and this one both draw there: \
         at most sheet.begin_mm and a quarter of sheet.frame_mm"
    );
}

#[test]
fn no_number_lies_outside_of_its_range() {
    for (key, ((least, most), _)) in
        SheetConfig::keys().iter().filter_map(|key| Some((key.key(), key.range()?)))
    {
        for value in [
            format!("{:e}", least - 1e-9),
            format!("{}", most * 1.001),
            "nan".into(),
            "inf".into(),
            "-inf".into(),
        ] {
            match read(&format!("{key} = {value}")) {
                Err(TomlError::Invalid { at: Some(_), error }) => assert_eq!(error.key(), key),
                other => panic!("{key} = {value}: {other:?}"),
            }
        }
    }
}

#[test]
fn the_check_is_the_same_without_a_file() {
    let mut sheet = SheetConfig::textile_plotter();
    assert!(sheet.checked(&MachineConfig::textile_plotter()).is_ok());
    sheet.frame_mm = 980.0;
    assert_eq!(sheet.checked(&MachineConfig::textile_plotter()).unwrap_err().key(), "sheet.frame_mm");
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

#[test]
fn the_documentation_page_gives_every_key_with_its_range_and_default() {
    let Some(page) = beside_the_crate("docs/machine-config.md") else { return };
    for key in SheetConfig::keys() {
        let row = page.lines().find(|line| line.contains(&format!("| `{}` |", key.key())));
        let cells: Vec<_> =
            row.unwrap_or_else(|| panic!("no row for `{}`", key.key())).split('|').map(str::trim).collect();
        let ((least, most), unit) = key.range().unwrap();
        assert_eq!(cells[2], unit, "unit of `{}`", key.key());
        let (low, high) = cells[3].split_once("..").unwrap();
        assert_eq!((low.parse(), high.parse()), (Ok(least), Ok(most)), "range of `{}`", key.key());
        assert_eq!(cells[4].parse().ok(), key.value(&SheetConfig::default()), "default of `{}`", key.key());
    }
}

#[test]
fn the_preset_says_what_the_code_says() {
    let Some(text) = beside_the_crate("examples/machines/textile-plotter.toml") else { return };
    let (machine, sheet) = Machine::from_toml_with::<SheetConfig>(&text).unwrap();
    assert_eq!(
        (*machine.config(), sheet),
        (MachineConfig::textile_plotter(), SheetConfig::textile_plotter())
    );
}
