//! Draws pictures of which every line is known, so that a vectorization of them can be judged.
//!
//! Each `NAME.png` comes with a `NAME.json` that holds the strokes it was drawn from, their pen widths and
//! the points where they cross or meet: `judge` compares with it. Look at the pictures where tracers usually
//! fail: lines that cross at small angles, tiny marks, lettering, grey edges, and the noise of a scan. The
//! second form writes a technical sheet of any size row by row, to measure time and memory:
//!
//! ```text
//! cargo run --release --example draw_corpus                                  # into target/corpus
//! cargo run --release --example draw_corpus -- DIR
//! cargo run --release --example draw_corpus -- --sheet a1 --dpi 600 a1.pbm
//! cargo run --release --example draw_corpus -- --sheet a4 --dpi 600 --grey a4.pgm
//! ```

use clap::Parser;
use plotter_judging::corpus::{self, Sheet, Size, Truth};
use std::fs::{File, create_dir_all};
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

/// Draws test pictures with the strokes they consist of, or one large sheet.
#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  draw_corpus --sheet a1 --dpi 600 a1.pbm")]
struct Arguments {
    /// Folder of the pictures, or file of the sheet [default: target/corpus, or target/SHEET.pbm]
    out: Option<PathBuf>,
    /// Draw one technical sheet of this size instead of the pictures
    #[arg(long, value_enum)]
    sheet: Option<Size>,
    /// Pixels per inch of the sheet
    #[arg(long, default_value_t = 600, value_parser = clap::value_parser!(u32).range(50..=2400), requires = "sheet")]
    dpi: u32,
    /// Write the sheet as grey PGM with the noise of paper, not as PBM
    #[arg(long, requires = "sheet")]
    grey: bool,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse();
    match arguments.sheet {
        None => pictures(&arguments.out.unwrap_or_else(|| PathBuf::from("target/corpus"))),
        Some(size) => {
            let out = arguments.out.unwrap_or_else(|| {
                PathBuf::from(format!("target/sheet.{}", if arguments.grey { "pgm" } else { "pbm" }))
            });
            let mut file = BufWriter::with_capacity(1 << 20, File::create(out)?);
            let sheet = Sheet::new(size, arguments.dpi);
            if arguments.grey {
                sheet.write_pgm(&mut file)?
            } else {
                sheet.write_pbm(&mut file)?
            }
            Ok(file.flush()?)
        }
    }
}

fn pictures(directory: &Path) -> Result<(), Box<dyn std::error::Error>> {
    create_dir_all(directory)?;
    for picture in corpus::all() {
        picture.draw().save(directory.join(format!("{}.png", picture.name)))?;
        let file = BufWriter::new(File::create(directory.join(format!("{}.json", picture.name)))?);
        serde_json::to_writer(file, &Truth::of(&picture))?;
    }
    Ok(())
}
