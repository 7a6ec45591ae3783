//! Files of other programs: small ones in their manner, of our own making, which every test reads, and those
//! of a folder that `PLOTTER_REAL_FILES` names, which are not in the repository.
//!
//! ```text
//! PLOTTER_REAL_FILES=../files cargo test --workspace     # holds the folders hpgl, gcode, logs, stitch
//! ```
//!
//! A test that finds none of the latter says `skipped` with its own name and what it left out, whatever the
//! test runner hides.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The variable that names the folder; a relative path counts from the workspace.
const VARIABLE: &str = "PLOTTER_REAL_FILES";

/// The folder of others' files of a kind, or `None` and a word of it. A folder that is named but not there
/// fails the test.
fn others(kind: &str) -> Option<PathBuf> {
    let Some(named) = std::env::var_os(VARIABLE).filter(|named| !named.is_empty()) else {
        let thread = std::thread::current();
        let test = thread.name().unwrap_or("a test");
        // Past what the test runner captures: a test that passes shows nothing otherwise.
        let _ =
            writeln!(std::io::stderr(), "skipped: {test}: {VARIABLE} names no folder with files of {kind}");
        return None;
    };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(named).join(kind);
    assert!(folder.is_dir(), "{VARIABLE}: {} is no folder", folder.display());
    Some(folder)
}

/// One of others' files, if there are any.
#[allow(dead_code, reason = "not every program of tests wants a single file")]
pub(crate) fn other(kind: &str, name: &str) -> Option<PathBuf> {
    others(kind).map(|folder| folder.join(name))
}

/// Ours of a kind, in the order of their names.
pub(crate) fn ours(kind: &str) -> Vec<PathBuf> {
    let of = match kind {
        "logs" => "plotter-replay/tests/data",
        "stitch" => "examples/tests/data",
        _ => "plotter-motion/tests/data",
    };
    let files = in_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(of).join(kind));
    assert!(!files.is_empty(), "the repository has files of {kind}");
    files
}

/// Ours of a kind, then others' if there are any.
#[allow(dead_code, reason = "not every program of tests wants all of them")]
pub(crate) fn all(kind: &str) -> Vec<PathBuf> {
    let others = others(kind).map(|folder| in_folder(&folder)).unwrap_or_default();
    ours(kind).into_iter().chain(others).collect()
}

fn in_folder(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
}

/// The name of a file, without its folder.
#[allow(dead_code, reason = "not every program of tests wants names")]
pub(crate) fn name_of(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
