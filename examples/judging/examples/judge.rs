//! Measures how well a vectorization matches the drawn lines.
//!
//! `draw_corpus` writes pictures with the strokes that they were drawn from. Trace one of them, with ours or
//! any other program, and this says how far the result and those strokes are from each other: on the average,
//! at the worst place, at the junctions, how much is missing and how much is there that should not be. Look
//! at the junctions first: there programs differ most. Of a picture of `degrade_corpus` that shows its sheet
//! askew, the result is first put back onto the sheet; one that was traced with `--paper` is put back into
//! the picture before, by the homography that its SVG tells, or the report beside its HPGL.
//!
//! Without a file it draws the corpus, traces it with ours as it is set from the start, and prints a line for
//! each picture:
//!
//! ```text
//! cargo run --release --example judge
//! cargo run --release --example judge -- traced.svg --truth target/corpus/junctions_w5.json
//! cargo run --release --example judge -- traced.svg --truth DIR/flag_1px.json --picture DIR/flag_1px.png --report figures.json
//! cargo run --release --example judge -- traced.plt --mm-per-px 0.1 --truth DIR/flag_1px.json
//! ```

use clap::Parser;
use plotter_examples::shared::{at, is_standard, print, read_file, run, write_output};
use plotter_judging::corpus::Truth;
use plotter_judging::{JudgedDrawing, Judgement, StraightenedPaper, judge_corpus};
use plotter_vector::{Bitmap, Vectorizer, decode};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Compares a vector drawing with the strokes that its picture was drawn from.
#[derive(Debug, Parser)]
#[command(after_help = "Examples:\n  judge traced.svg --truth target/corpus/junctions_w5.json\n  \
                  judge traced.svg --truth flag_1px.json --picture flag_1px.png --report figures.json\n\n\
                  What each figure is: the page of `Judgement`. Lengths are px of the picture; of one that shows \
                  the drawing askew, px of the drawing.")]
struct Arguments {
    /// SVG whose sheet is the picture, y down, pixel centres at .5; or HPGL, y up from the centre of the
    /// lower left pixel [default: what ours makes of each picture of the corpus]
    #[arg(requires = "truth")]
    drawing: Option<PathBuf>,
    /// What is known about the picture, as `draw_corpus` writes it
    #[arg(long, value_name = "F.json", requires = "drawing")]
    truth: Option<PathBuf>,
    /// The picture: measures how far its ink lies from the drawing too, which says something of lines 1 px
    /// wide
    #[arg(long, value_name = "F.png", requires = "drawing")]
    picture: Option<PathBuf>,
    /// Size of a pixel in HPGL, mm
    #[arg(long, value_name = "MM", default_value_t = 0.1, allow_negative_numbers = true)]
    mm_per_px: f64,
    /// Of HPGL that was traced with `--paper`: the report of `trace`, which tells where the sheet lies in
    /// the picture; an SVG tells it itself
    #[arg(long, value_name = "F.json", requires = "drawing")]
    paper: Option<PathBuf>,
    /// Writes the figures as JSON; - is the standard output, in place of the table
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("judge", || judge(&arguments))
}

fn judge(arguments: &Arguments) -> Result<(), String> {
    let judged = match (&arguments.drawing, &arguments.truth) {
        (Some(drawing), Some(truth)) => vec![judged(drawing, truth, arguments)?],
        _ => judge_corpus()?.into_iter().map(|(truth, judgement)| (truth.name, judgement)).collect(),
    };
    if let Some(file) = &arguments.report {
        let figures: Vec<_> =
            judged.iter().map(|(name, figures)| json!({ "picture": name, "figures": figures })).collect();
        write_output(file, format!("{:#}\n", json!(figures)))?;
        if is_standard(file) {
            return Ok(());
        }
    }
    let rows: String = judged.iter().map(|(name, figures)| figures.row(name)).collect();
    print(&format!("{}{rows}", Judgement::HEAD))
}

fn judged(file: &Path, truth_file: &Path, arguments: &Arguments) -> Result<(String, Judgement), String> {
    let truth = Truth::from_json(&read_file(truth_file)?).map_err(|error| at(truth_file, &error))?;
    let bytes = read_file(file)?;
    let size = truth.view.map_or((truth.width, truth.height), |view| (view.width, view.height));
    let is_svg = bytes.iter().find(|byte| !byte.is_ascii_whitespace() && **byte < 0x80) == Some(&b'<');
    let paper = match &arguments.paper {
        Some(report) => {
            Some(StraightenedPaper::in_report(&read_file(report)?).map_err(|error| at(report, &error))?)
        }
        None if is_svg => StraightenedPaper::in_svg(&bytes).map_err(|error| at(file, &error))?,
        None => None,
    };
    let drawn_px = paper.map_or(size, |paper| paper.size_px);
    let read = if is_svg {
        JudgedDrawing::from_svg(&bytes, drawn_px)
    } else {
        JudgedDrawing::from_hpgl(&bytes, drawn_px, arguments.mm_per_px)
    };
    let mut read = read.map_err(|error| at(file, &error))?;
    if let Some(paper) = &paper {
        read = read.on_picture(paper, size).map_err(|error| at(file, &error))?;
    }
    if let Some(view) = &truth.view {
        if let Some(picture) = &arguments.picture {
            return Err(at(picture, &"is seen askew: the distance of its ink would be in other pixels"));
        }
        read = read.flattened(view, (truth.width, truth.height)).map_err(|error| at(file, &error))?;
    }
    let JudgedDrawing { drawing, pens } = read;
    let ink = arguments.picture.as_deref().map(|picture| ink(picture, &truth)).transpose()?;
    let figures = Judgement::new(&drawing, &pens, &truth, ink.as_ref()).map_err(|error| at(file, &error))?;
    Ok((truth.name, figures))
}

fn ink(picture: &Path, truth: &Truth) -> Result<Bitmap, String> {
    let gray = decode(&read_file(picture)?).map_err(|error| at(picture, &error))?;
    let ink = Vectorizer::default().ink(&gray);
    if (ink.width(), ink.height()) != (truth.width, truth.height) {
        return Err(at(
            picture,
            &format!(
                "{} x {} px, but the truth is of {} x {} px",
                ink.width(),
                ink.height(),
                truth.width,
                truth.height
            ),
        ));
    }
    Ok(ink)
}
