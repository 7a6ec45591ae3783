//! A tool's end and words: what it prints, and one clear line for an error.

use super::exit_status::ExitStatus;
use std::fmt::Display;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

/// Runs the example `name`: an error is one line on the standard error, and a failed exit.
pub fn run(name: &str, main: impl FnOnce() -> Result<(), String>) -> ExitCode {
    match main() {
        Ok(()) => ExitStatus::Done.into(),
        Err(message) => {
            // One line, whatever a path or a decoder put into it.
            eprintln!("{name}: {}", message.split_whitespace().collect::<Vec<_>>().join(" "));
            ExitStatus::Failed.into()
        }
    }
}

/// Writes text to the standard output. A reader who has seen enough (`| head -1`) is no failure.
///
/// # Errors
///
/// Any other failure.
pub fn print(text: &str) -> Result<(), String> {
    print_bytes(text.as_bytes())
}

pub(super) fn print_bytes(bytes: &[u8]) -> Result<(), String> {
    let mut out = std::io::stdout();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: {error}"))
        }
        _ => Ok(()),
    }
}

/// An error with the file that it belongs to.
pub fn at(path: &Path, error: &impl Display) -> String {
    format!("{}: {error}", path.display())
}
