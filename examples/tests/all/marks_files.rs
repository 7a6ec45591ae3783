//! The files of `marks/` hold the layouts of plotter-stitch, and what is wrong in one is said with its place.

use plotter_stitch::ReferenceLines;
use std::path::Path;

#[test]
fn the_files_hold_the_layouts_of_the_crate() {
    let layouts = [
        ("strip16", ReferenceLines::strip16()),
        ("strip24", ReferenceLines::strip24()),
        ("strip32", ReferenceLines::strip32()),
    ];
    for (name, lines) in layouts {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("marks").join(name).with_extension("toml");
        let text = std::fs::read_to_string(path).unwrap();
        assert_eq!(toml::from_str(&text), Ok(lines), "{name}");
    }
}

#[test]
fn what_is_wrong_in_a_file_is_said_with_its_place() {
    let said = |text: &str| toml::from_str::<ReferenceLines>(text).unwrap_err().to_string();
    let no_joint = said("schema = 1\njoint = 3\n");
    assert!(no_joint.contains("line 2"), "{no_joint}");
    let joint = "schema = 1\njoint = [{ x = 0.0, y = 0.0 }, { x = 0.0, y = 9.0 }]\nmarks = []\n";
    let unknown = said(&format!("{joint}mark = 1\n"));
    assert!(unknown.contains("unknown field `mark`"), "{unknown}");
    let empty = said(joint);
    let why = "the layout has 0 crossings (marks times scans of each group), 3 to 64 are possible";
    assert!(empty.contains(why), "{empty}");
}
