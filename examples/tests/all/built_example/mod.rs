//! Runs an example as a stranger does.

#![expect(unreachable_pub, reason = "shared by tests, not an interface")]

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// The outcome of the built example `name` with `arguments`.
pub fn run_example(name: &str, arguments: &[&str]) -> Output {
    run_with_input(name, arguments, Stdio::null())
}

/// As [`run_example`], with something at the standard input.
pub fn run_with_input(name: &str, arguments: &[&str], input: impl Into<Stdio>) -> Output {
    let test = std::env::current_exe().unwrap();
    let built = test.parent().and_then(Path::parent).unwrap().join("examples").join(name);
    let output = Command::new(&built).args(arguments).stdin(input).output();
    output.unwrap_or_else(|error| panic!("{}: {error}: cargo build --example {name}", built.display()))
}

/// The one line that a failed run says.
pub fn complaint(name: &str, arguments: &[&str]) -> String {
    let output = run_example(name, arguments);
    assert!(!output.status.success(), "{arguments:?} was accepted");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "one line: {text}");
    text.trim_end().to_owned()
}

/// A file that comes with the examples.
#[allow(dead_code, reason = "not every command takes a file of these")]
pub fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data").join(name).to_str().unwrap().to_owned()
}

/// The file of a machine that comes with the examples.
#[allow(dead_code, reason = "not every command takes a machine")]
pub fn machine(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("machines").join(name).to_str().unwrap().to_owned()
}

/// A folder for the results of a test.
#[allow(dead_code, reason = "not every command writes files")]
pub struct Folder(pub tempfile::TempDir);

#[allow(dead_code, reason = "not every command writes files")]
impl Folder {
    /// An empty one, which is gone when the test is over.
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// The path of a file in it.
    pub fn file(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// Writes a file; gives its path.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> String {
        let path = self.file(name);
        std::fs::write(&path, contents).unwrap();
        path
    }
}
