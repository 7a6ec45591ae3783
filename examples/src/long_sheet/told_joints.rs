//! [`told_joints`]: recorded scans in files, poses or refusals in another.

use crate::long_sheet::{CrossingSet, JointAnswer, answer_traces};
use crate::shared::{Telling, at, print, read_file, write_file};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Joints that are printed; a batch may have thousands.
const MOST_PRINTED: usize = 20;

/// Tells the joints of recorded scans, one file after the other, and writes them as a list; `-` is the
/// standard output.
///
/// # Errors
///
/// What could not be read, or written. Files that could be read are told all the same.
pub fn told_joints(traces: &[PathBuf], set: CrossingSet, out: &Path, telling: Telling) -> Result<(), String> {
    let (mut answers, mut unread) = (Vec::new(), Vec::new());
    for path in traces {
        let name = path
            .file_stem()
            .map_or_else(|| path.to_string_lossy(), |stem| stem.to_string_lossy())
            .into_owned();
        match read_traces(path, &name, set) {
            Ok(told) => answers.extend(told),
            // The others count all the same.
            Err(why) => {
                answers.push(JointAnswer { case: name, joint: None, pose: Err(why.clone()) });
                unread.push(why);
            }
        }
    }
    let list: Vec<Value> = answers.iter().map(JointAnswer::to_json).collect();
    let text = format!("{}\n", lines(&list));
    if out == Path::new("-") {
        print(&text)?;
    } else {
        if traces.iter().any(|trace| is_same(trace, out)) {
            return Err(at(out, &"the traces would be written over"));
        }
        write_file(out, &text)?;
        telling.tell(&summary(&answers), || Ok(text))?;
    }
    match &unread[..] {
        [] => Ok(()),
        [why] => Err(why.clone()),
        [why, more @ ..] => Err(format!("{why}; and {} more files", more.len())),
    }
}

fn is_same(one: &Path, other: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().ok();
    real(one).is_some_and(|one| real(other) == Some(one))
}

fn read_traces(path: &Path, name: &str, set: CrossingSet) -> Result<Vec<JointAnswer>, String> {
    let bytes = read_file(path)?;
    let text = String::from_utf8(bytes).map_err(|_| at(path, &"is no text, let alone JSON"))?;
    answer_traces(&text, name, set).map_err(|error| at(path, &error))
}

/// A list with one joint a line.
fn lines(list: &[Value]) -> String {
    let joints: Vec<String> = list.iter().map(Value::to_string).collect();
    if joints.is_empty() { "[]".into() } else { format!("[\n{}\n]", joints.join(",\n")) }
}

fn summary(answers: &[JointAnswer]) -> String {
    let mut text = String::new();
    for answer in answers.iter().take(MOST_PRINTED) {
        let _ = match &answer.pose {
            Ok(pose) => writeln!(
                text,
                "{}: turned by {:.6} ± {:.6} rad, shifted by {:.3} ± {:.3} and {:.3} ± {:.3} mm, {} crossings agree",
                answer.case,
                pose.transform.angle_rad(),
                pose.sigma_angle_rad,
                pose.transform.shift().x,
                pose.sigma_shift_mm[0],
                pose.transform.shift().y,
                pose.sigma_shift_mm[1],
                pose.inliers,
            ),
            Err(why) => writeln!(text, "{}: refused: {why}", answer.case),
        };
    }
    if answers.len() > MOST_PRINTED {
        let _ = writeln!(text, "and {} more", answers.len() - MOST_PRINTED);
    }
    let refused = answers.iter().filter(|answer| answer.pose.is_err()).count();
    let _ = writeln!(text, "{} joints: {} told, {refused} refused", answers.len(), answers.len() - refused);
    text
}
