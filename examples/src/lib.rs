//! What the examples share: one clear line for every error, and plots with their recordings: simulated, in the emulator, or on
//! a real machine.

mod arrangement;
mod controller_contest;
pub mod corpus;
mod diagnostics;
mod drawing_file;
mod drawn_extent;
mod emulated_plot;
mod emulator;
mod fit_drawing;
mod follow_gif;
mod follow_machine;
mod follow_moves;
mod follow_outcome;
mod follow_pictures;
mod followed_path;
mod font_files;
mod interrupt;
mod json_place;
mod judged_corpus;
mod judged_drawing;
mod judgement;
mod language;
mod long_sheet_report;
mod long_sheet_run;
mod long_sheet_svg;
mod loop_chart;
mod lost_ink;
mod marks_file;
mod near_lines;
mod overlay;
mod path_deviation;
mod pen_lines;
mod port_plot;
mod report;
mod simulated_board;
mod simulated_plot;
mod speed_audit;
mod speed_chart;
mod speed_trial;
mod step_file;
mod stepped_plot;
mod stepped_preview;
mod stepped_report;
mod stitch_traces;
mod streamed_steps;
mod svg_drawing;
mod svg_reading;
mod svg_text;
mod textile_pattern;
mod told_joints;
mod true_path;
mod tuned_axis;
mod tuning;
mod tuning_report;
#[cfg(all(feature = "camera", target_os = "linux"))]
mod v4l_camera;
mod vectorize_settings;
mod window_source;
mod wrong_choices;

pub use arrangement::{Arrangement, Crop, Effort, Mirror, Page};
pub use controller_contest::compare_controllers;
pub use diagnostics::Diagnostics;
pub use drawing_file::{Diagnostic, DrawingFile, Ops, Reading, Severity};
pub use drawn_extent::DrawnExtent;
pub use emulated_plot::{Recorded, plot_in_emulator};
pub use emulator::{BenchSwitches, Emulator, Told, built_firmware};
pub use fit_drawing::fit_drawing;
pub use follow_gif::FollowGif;
pub use follow_machine::FollowMachine;
pub use follow_moves::MovesFile;
pub use follow_outcome::FollowOutcome;
pub use follow_pictures::{FollowFrame, follow_page, follow_svg};
pub use followed_path::{FollowedPath, follow, predicted_s, rounding_mm, slowed};
pub use font_files::FontFiles;
pub use interrupt::{INTERRUPTED, Interrupt};
pub use json_place::JsonPlace;
pub use judged_corpus::judged_corpus;
pub use judged_drawing::JudgedDrawing;
pub use judgement::{Judgement, JunctionFigures};
pub use language::Language;
pub use long_sheet_report::{JointRow, LongSheetReport};
pub use long_sheet_run::{FrameFigures, JointFigures, LongSheetMachine, LongSheetRun, View};
pub use long_sheet_svg::long_sheet_svg;
pub use loop_chart::{LoopChart, LoopCurve, loop_charts_svg};
pub use lost_ink::{lost_ink, vectorized};
pub use marks_file::read_marks;
pub use near_lines::{LinePiece, NearLines};
pub use overlay::{Overlay, overlay_png, overlay_step};
pub use path_deviation::PathDeviation;
pub use pen_lines::PenLines;
pub use port_plot::{PortLanguage, plot_on_port};
use report::escaped;
pub use report::{Figure, html_page};
pub use simulated_board::{SimulatedBoard, board_header, simulate_board};
pub use simulated_plot::{PlotOutcome, simulate};
pub use speed_audit::{Moment, MostAccel, SpeedAudit};
pub use speed_chart::SpeedChart;
pub use speed_trial::{deviation_mm, speed_trial, test_figure};
pub use step_file::StepFile;
pub use stepped_plot::{BLOCKS, Happening, SteppedFigures, SteppedPlot};
pub use stepped_preview::{SteppedPreview, pen_colour, usual_colour};
pub use stepped_report::{PlotFigures, SteppedReport};
pub use stitch_traces::{CrossingSet, JointAnswer, JointPose, answer_traces};
pub use streamed_steps::{StreamedSteps, streamed_in_emulator, streamed_on_the_desk};
pub use svg_drawing::{SvgOps, svg_drawing};
pub use svg_reading::{Paper, PensBy, SvgReading};
pub use svg_text::SvgText;
pub use textile_pattern::TextilePattern;
pub use told_joints::told_joints;
pub use true_path::TruePath;
pub use tuned_axis::{Law, SimulatedAxis, StepResponse};
pub use tuning::{TunedAxis, TuningMethod, TuningSettings};
pub use tuning_report::{TuningReport, tuned_lines};
pub use vectorize_settings::vectorizer;
pub use window_source::WindowSource;
pub use wrong_choices::{WrongChoices, wrong_choices};

use std::fmt::Display;
use std::io::{Read, Write as _};
use std::path::Path;
use std::process::ExitCode;

/// Largest file that is read, bytes: an uncompressed picture of the greatest size has half of this.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Runs the example `name`: an error is one line on the standard error, and a failed exit.
pub fn run(name: &str, main: impl FnOnce() -> Result<(), String>) -> ExitCode {
    match main() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            // One line, whatever a path or a decoder put into it.
            eprintln!("{name}: {}", message.split_whitespace().collect::<Vec<_>>().join(" "));
            ExitCode::FAILURE
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

fn print_bytes(bytes: &[u8]) -> Result<(), String> {
    let mut out = std::io::stdout();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(format!("standard output: {error}"))
        }
        _ => Ok(()),
    }
}

/// What stands for the standard input and output in place of a file.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new("-")
}

/// Reads a file; an error names it.
///
/// # Errors
///
/// The file and why it could not be read, or that it is longer than 1 GiB.
pub fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    if path.is_dir() {
        return Err(at(path, &"this is a folder: name a file in it"));
    }
    let file = std::fs::File::open(path).map_err(|error| at(path, &format!("cannot be read: {error}")))?;
    read_all(file).map_err(|error| at(path, &error))
}

/// Reads the standard input to its end.
///
/// # Errors
///
/// Why it could not be read, or that it is longer than 1 GiB.
pub fn read_input() -> Result<Vec<u8>, String> {
    read_all(std::io::stdin().lock())
}

fn read_all(reader: impl Read) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // One byte more than allowed tells a file that is too long, even one without an end.
    let read = reader.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes);
    read.map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(format!("more than {} MiB; save it as PNG", MAX_FILE_BYTES >> 20));
    }
    Ok(bytes)
}

/// Writes a file, or the standard output for `-`; an error names it.
///
/// # Errors
///
/// The file and why it could not be written.
pub fn write_output(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), String> {
    if is_standard(path) { print_bytes(contents.as_ref()) } else { write_file(path, contents) }
}

/// Writes a file; an error names it.
///
/// # Errors
///
/// The file and why it could not be written; `-`, which would be a file of that name.
pub fn write_file(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), String> {
    if is_standard(path) {
        return Err(
            "-: the standard output has the figures already; name a file, as ./- for one of that name".into(),
        );
    }
    std::fs::write(path, contents).map_err(|error| at(path, &format!("cannot be written: {error}")))
}

/// An error with the file that it belongs to.
pub fn at(path: &Path, error: &impl Display) -> String {
    format!("{}: {error}", path.display())
}
