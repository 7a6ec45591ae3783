//! What `live` is given that is no HPGL and no G-code: an SVG, a DXF or a picture, made into a drawing first
//! by the tools of this program.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Names of files that `convert` reads and `live` does not.
const DRAWINGS: [&str; 2] = ["svg", "dxf"];
/// Names of files that `trace` reads.
const PICTURES: [&str; 9] = ["png", "jpg", "jpeg", "pbm", "pgm", "ppm", "pnm", "bmp", "gif"];

/// A file that goes away with the program.
pub(crate) struct Kept(PathBuf);

impl Drop for Kept {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// The command line with a drawing in the place of a picture or an SVG behind `live`, and that drawing.
///
/// # Errors
///
/// The status of the tool that could not make one: it has said why.
pub(crate) fn made(mut arguments: Vec<OsString>) -> Result<(Vec<OsString>, Option<Kept>), ExitCode> {
    let is_live = arguments.get(1).is_some_and(|name| name == "live");
    let Some(place) =
        is_live.then(|| arguments.iter().skip(2).position(|argument| tool(argument).is_some())).flatten()
    else {
        return Ok((arguments, None));
    };
    let Some(given) = arguments.get_mut(place + 2) else { return Ok((arguments, None)) };
    // One of each running program: two of them may be given files of one name.
    let made = std::env::temp_dir().join(format!("plotter-live-{}.plt", std::process::id()));
    let tool = tool(given).unwrap_or("convert");
    let program = std::env::current_exe().map_err(|error| fail(&error))?;
    let mut command = Command::new(program);
    command.arg(tool).arg(&*given);
    if tool == "trace" {
        command.arg("--hpgl");
    }
    let status = command.arg(&made).status().map_err(|error| fail(&error))?;
    let kept = Kept(made.clone());
    // (a status of 1 says that something of it was left out, which the tool has said)
    if !matches!(status.code(), Some(0 | 1)) || !made.is_file() {
        return Err(ExitCode::from(u8::try_from(status.code().unwrap_or(2)).unwrap_or(2)));
    }
    *given = made.into_os_string();
    Ok((arguments, Some(kept)))
}

fn fail(error: &std::io::Error) -> ExitCode {
    eprintln!("live: the drawing cannot be made: {error}");
    ExitCode::from(2)
}

/// Which tool makes a drawing of a file of this name.
fn tool(name: &OsStr) -> Option<&'static str> {
    let suffix = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
    let is_one = |names: &[&str]| names.contains(&suffix.as_str());
    match () {
        () if is_one(&DRAWINGS) => Some("convert"),
        () if is_one(&PICTURES) => Some("trace"),
        () => None,
    }
}
