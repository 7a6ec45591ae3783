//! The marks of a frame, from a TOML file.

use crate::{at, read_file};
use plotter_stitch::ReferenceLines;
use std::path::Path;

/// Reads a file such as those in `marks/`.
///
/// # Errors
///
/// The file, and where in it what is wrong.
pub fn read_marks(path: &Path) -> Result<ReferenceLines, String> {
    let text = String::from_utf8(read_file(path)?).map_err(|_| at(path, &"is no text"))?;
    let lines: ReferenceLines = toml::from_str(&text).map_err(|error| at(path, &error))?;
    lines.check().map_err(|error| at(path, &error))?;
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_hold_the_layouts_of_the_crate() {
        let layouts = [
            ("strip16", ReferenceLines::strip16()),
            ("strip24", ReferenceLines::strip24()),
            ("strip32", ReferenceLines::strip32()),
        ];
        for (name, lines) in layouts {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("marks").join(name).with_extension("toml");
            assert_eq!(read_marks(&path), Ok(lines), "{name}");
        }
    }

    #[test]
    fn what_is_wrong_in_a_file_is_said_with_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("marks.toml");
        let said = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read_marks(&path).unwrap_err()
        };
        assert!(said("schema = 1\njoint = 3\n").contains("line 2"), "{}", said("schema = 1\njoint = 3\n"));
        let unknown =
            "schema = 1\njoint = [{ x = 0.0, y = 0.0 }, { x = 0.0, y = 9.0 }]\nmarks = []\nmark = 1\n";
        assert!(said(unknown).contains("unknown field `mark`"), "{}", said(unknown));
        let empty = "schema = 1\njoint = [{ x = 0.0, y = 0.0 }, { x = 0.0, y = 9.0 }]\nmarks = []\n";
        assert!(
            said(empty).ends_with(
                "the layout has 0 crossings (marks times scans of each group), 3 to 64 are possible"
            )
        );
    }
}
