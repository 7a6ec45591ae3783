//! Drawings as people have them, of which every line is known: photographed, in pencil, enlarged, faint.
//!
//! For each drawing, kind and strength it writes `KIND_STRENGTH_NN.png` (`.jpg` where compression is part of
//! it), a `.json` with the strokes for `judge`, and `.ink.png`, the undegraded ink in the same pixels. Look
//! at the same drawing in several kinds side by side; another seed makes other drawings and other noise:
//!
//! ```text
//! cargo run --release --example degrade_corpus -- target/degraded --seed 1
//! cargo run --release --example degrade_corpus -- DIR --seed 6 --kinds photo,pencil --strength strong --drawings 8
//! cargo run --release --example degrade_corpus -- --parameters               # what the strengths are in numbers
//! ```

use clap::Parser;
use plotter_examples::shared::{print, run, write_output};
use plotter_judging::degraded::{Drawn, Kind, Strength, drawing, parameter_table};
use rayon::prelude::*;
use std::fs::create_dir_all;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Draws sheets and degrades them as scanners, telephones, pencils and programs do.
#[derive(Debug, Parser)]
#[command(
    after_help = "Example:\n  degrade_corpus target/degraded --seed 6 --kinds photo,pencil --strength strong"
)]
struct Arguments {
    /// Folder of the pictures
    #[arg(required_unless_present = "parameters")]
    out: Option<PathBuf>,
    /// Other drawings and other noise for each number
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Kinds, separated by commas [default: all]
    #[arg(long, value_enum, value_delimiter = ',')]
    kinds: Vec<Kind>,
    /// Strength [default: all three]
    #[arg(long, value_enum)]
    strength: Option<Strength>,
    /// How many drawings
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=99))]
    drawings: u32,
    /// Prints what the strengths are in numbers, and draws nothing
    #[arg(long)]
    parameters: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("degrade_corpus", || match &arguments.out {
        Some(out) if !arguments.parameters => draw(out, &arguments),
        _ => print(&parameter_table()),
    })
}

fn draw(out: &Path, arguments: &Arguments) -> Result<(), String> {
    create_dir_all(out).map_err(|error| format!("{}: {error}", out.display()))?;
    let kinds = if arguments.kinds.is_empty() { &Kind::ALL[..] } else { &arguments.kinds };
    let strengths = arguments.strength.map_or(Strength::ALL.to_vec(), |one| vec![one]);
    (0..arguments.drawings).into_par_iter().try_for_each(|number| {
        // The back is a drawing that the corpus does not have.
        let drawn = Drawn::new(drawing(arguments.seed, number), &drawing(arguments.seed, number + 101));
        for kind in kinds {
            for strength in &strengths {
                let found = drawn
                    .degraded(*kind, *strength, arguments.seed, number)
                    .map_err(|error| format!("{}, drawing {number}: {error}", kind.name()))?;
                let name = &found.truth.name;
                let truth = serde_json::to_string(&found.truth).map_err(|error| error.to_string())?;
                write_output(&out.join(format!("{name}.{}", found.extension)), found.file)?;
                write_output(&out.join(format!("{name}.json")), truth)?;
                let ink = out.join(format!("{name}.ink.png"));
                found.ink.save(&ink).map_err(|error| format!("{}: {error}", ink.display()))?;
            }
        }
        Ok(())
    })
}
