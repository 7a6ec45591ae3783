//! A drawing longer than the table, at the moment between two frames: how does the sheet lie now?
//!
//! The head has scanned the marks of the frame before, and what it sampled is in files. From that follows by how much the sheet is
//! turned and shifted, how sure that is, and whether it can be told at all: where dust was taken for marks, or too few are left,
//! a refusal says why, for the next frame would miss the last one.
//!
//! Look at `inliers`, the crossings that agree, and at the deviations: with sixteen crossings a joint is known to a few hundredths
//! of a millimetre, with the three of the published method (`--set paper`) to some tenths.
//!
//! ```text
//! cargo run --release --example long_sheet -- --traces joint1.json joint2.json --out joints.json
//! ```

use clap::{Parser, ValueEnum};
use plotter_examples::{CrossingSet, JointAnswer, answer_traces, at, print, read_file, run, write_file};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Joints that are printed; a batch may have thousands.
const MOST_PRINTED: usize = 20;

/// Tells from recorded scans how a sheet lies between two frames.
///
/// Reads stitch-trace/1 (one joint) and stitch-batch/1 (many) and writes a list with an object for each joint: theta (rad), tx and ty
/// (mm) of machine = R(theta) frame + t, their standard deviations and the crossings that agree, or refused with the reason.
#[derive(Debug, Parser)]
#[command(
    name = "long_sheet",
    after_help = "Examples:\n  \
                  long_sheet --traces joint.json --out pose.json\n  \
                  long_sheet --traces joints/*.json --set paper --out published.json\n\n\
                  Exit status: 0 every file was read (joints may be refused); 1 a file was not, the others are written; 2 wrong \
                  options."
)]
struct Arguments {
    /// Recorded scans
    #[arg(long, value_name = "FILE", num_args = 1.., required = true)]
    traces: Vec<PathBuf>,
    /// Which crossings are used, and by which method
    #[arg(long, value_enum, default_value = "strip16")]
    set: Set,
    /// Where the list is written; - is the standard output
    #[arg(long, value_name = "F.json", default_value = "-")]
    out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Set {
    /// The three crossings of the published procedure, by the published method
    Paper,
    /// Sixteen crossings in the strip that can still be reached, by ours
    Strip16,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("long_sheet", || traces(&arguments))
}

fn traces(arguments: &Arguments) -> Result<(), String> {
    let set = match arguments.set {
        Set::Paper => CrossingSet::Paper,
        Set::Strip16 => CrossingSet::Strip16,
    };
    let (mut answers, mut unread) = (Vec::new(), Vec::new());
    for path in &arguments.traces {
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
    if arguments.out == Path::new("-") {
        print(&text)?;
    } else {
        if arguments.traces.iter().any(|trace| is_same(trace, &arguments.out)) {
            return Err(at(&arguments.out, &"the traces would be written over"));
        }
        write_file(&arguments.out, text)?;
        print(&summary(&answers))?;
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
