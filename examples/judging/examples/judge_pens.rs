//! Measures how well strokes are assigned to their pens, on sheets of up to eight pens whose strokes cross,
//! in eight kinds of pictures.
//!
//! Each sheet is drawn, shown as a picture, traced with the pens that are found, and compared with the drawn
//! strokes. Look at the share on the wrong pen, and at the least recall, which is 0 for a pen that is lost.
//!
//! ```text
//! cargo run --release --example judge_pens
//! cargo run --release --example judge_pens -- --seeds 3,4 --sheets 5 --kinds photo,squared --each --out DIR
//! ```

use clap::Parser;
use plotter_examples::shared::{print, run, write_output};
use plotter_judging::pens::{PenFigures, PenPicture, PenSheet};
use plotter_vector::{Vectorizer, decode_colour, ink::Pens, write::svg_in_colour};
use rayon::prelude::*;
use std::fs::create_dir_all;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Width of the strokes in the SVG, px.
const PEN_PX: f64 = 1.5;

/// Measures how well strokes are assigned to their pens.
#[derive(Debug, Parser)]
#[command(
    after_help = "Example:\n  judge_pens --seeds 3,4 --sheets 5 --kinds photo,squared --each --out DIR"
)]
struct Arguments {
    /// Seeds: strokes, pens and noise are others for each
    #[arg(long, value_delimiter = ',', default_value = "1")]
    seeds: Vec<u64>,
    /// Number of sheets of each seed
    #[arg(long, value_name = "N", default_value_t = 10)]
    sheets: u32,
    /// Kinds of pictures, separated by commas [default: all]
    #[arg(long, value_enum, value_delimiter = ',')]
    kinds: Vec<PenPicture>,
    /// Prints a line for each sheet as well
    #[arg(long)]
    each: bool,
    /// Writes the pictures, and the strokes found in them as SVG, into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("judge_pens", || judge(&arguments))
}

fn judge(arguments: &Arguments) -> Result<(), String> {
    if let Some(out) = &arguments.out {
        create_dir_all(out).map_err(|error| format!("{}: {error}", out.display()))?;
    }
    let kinds = if arguments.kinds.is_empty() { &PenPicture::ALL[..] } else { &arguments.kinds };
    print(PenFigures::HEAD)?;
    for kind in kinds {
        let of_seed = |seed: u64| (0..arguments.sheets).map(move |number| (seed, number));
        let sheets: Vec<(u64, u32)> = arguments.seeds.iter().copied().flat_map(of_seed).collect();
        let judged = |(seed, number): (u64, u32)| {
            let name = format!("{}_{seed}_{number:02}", kind.name());
            match figures((seed, number), *kind, &name, arguments.out.as_deref()) {
                Ok(figures) => Ok((figures, name)),
                Err(error) => Err(format!("{name}: {error}")),
            }
        };
        let found: Vec<(PenFigures, String)> =
            sheets.into_par_iter().map(judged).collect::<Result<_, _>>()?;
        if arguments.each {
            print(&found.iter().map(|(figures, name)| figures.row(name)).collect::<String>())?;
        }
        let figures: Vec<PenFigures> = found.into_iter().map(|(figures, _)| figures).collect();
        print(&PenFigures::mean(&figures).row(kind.name()))?;
    }
    Ok(())
}

/// Traces one sheet and compares it with what was drawn; writes picture and strokes into `out`.
fn figures(
    (seed, number): (u64, u32),
    kind: PenPicture,
    name: &str,
    out: Option<&Path>,
) -> Result<PenFigures, String> {
    let sheet = PenSheet::new(seed, number);
    let file = sheet.picture(kind, seed * 100 + u64::from(number)).map_err(|error| error.to_string())?;
    let picture = decode_colour(&file).map_err(|error| error.to_string())?;
    let found = Vectorizer::default().vectorize_colour(&picture, &Pens::Found);
    let found = found.map_err(|error| error.to_string())?;
    let drawing = &found.traced.drawing;
    if let Some(out) = out {
        let mut svg = String::new();
        svg_in_colour(drawing, &found.palette, None, PEN_PX, &mut svg).map_err(|error| error.to_string())?;
        write_output(&out.join(format!("{name}.{}", kind.extension())), file)?;
        write_output(&out.join(format!("{name}.svg")), svg)?;
    }
    Ok(PenFigures::new(drawing, &sheet))
}
