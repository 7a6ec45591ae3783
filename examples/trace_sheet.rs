//! A scan of any length to pen strokes, row by row: a sheet of A0 at 1200 dots per inch in the memory of a small picture.
//!
//! The file is read by rows and never held whole. Look at the last line: the memory hardly grows with the sheet, and the
//! strokes are the same with one thread and with many.
//!
//! ```text
//! cargo run --release --example draw_corpus -- --sheet a1 --dpi 600 a1.pbm
//! cargo run --release --example trace_sheet -- a1.pbm --svg a1.svg
//! ```

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::{print, run, write_file};
use plotter_motion::Point;
use plotter_vector::{Progress, RowSource as _, Scale, Scan, Vectorizer, hpgl, svg};
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Size of a pixel in the HPGL file, mm: 254 dots per inch, 4 plotter units a pixel.
const MM_PER_PX: f64 = 0.1;

/// Steps of the progress bar.
const STEPS: f64 = 1000.0;

/// Traces a scan of any length row by row.
#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  trace_sheet a1.pbm --svg a1.svg --threads 2")]
struct Arguments {
    /// PNG, TIFF, PBM or PGM picture of lines
    scan: PathBuf,
    /// Writes the strokes as SVG: the picture's size in px, y down, pixel centres at .5
    #[arg(long, value_name = "F")]
    svg: Option<PathBuf>,
    /// Writes the strokes as HPGL, 0.1 mm a pixel, y up from the centre of the lower left pixel
    #[arg(long, value_name = "F")]
    hpgl: Option<PathBuf>,
    /// Circular arcs and circles where they save vertices, within the same error
    #[arg(long)]
    arcs: bool,
    /// Cubic curves where they save vertices, within the same error; chords in the HPGL
    #[arg(long, conflicts_with = "arcs")]
    curves: bool,
    /// Threads [default: as many as the machine has]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    threads: usize,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("trace_sheet", || trace(&arguments))
}

fn trace(arguments: &Arguments) -> Result<(), String> {
    let path = &arguments.scan;
    let start = Instant::now();
    let mut scan = Scan::open(path).map_err(|error| format!("{}: {error}", path.display()))?;
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a share of a thousand steps"
    )]
    let steps = |share: f64| (STEPS * share) as u64;
    let bar = ProgressBar::new(steps(1.0));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} % {eta:>4}") {
        bar.set_style(style);
    }
    let mut report = |done: f64| {
        bar.set_position(steps(done));
        ControlFlow::Continue(())
    };
    let threads = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build();
    let threads = threads.map_err(|error| format!("threads: {error}"))?;
    let vectorizer = Vectorizer { arcs: arguments.arcs, curves: arguments.curves, ..Vectorizer::default() };
    let sheet = threads
        .install(|| vectorizer.vectorize_rows(&mut scan, &mut Progress::new(&mut report)))
        .map_err(|error| format!("{}: {error}", path.display()))?;
    bar.finish_and_clear();
    let drawing = &sheet.drawing;
    let seconds = start.elapsed().as_secs_f64();
    let megapixels = f64::from(scan.width()) * f64::from(scan.height()) / 1e6;
    let memory = peak_memory_mib().map_or("unknown".to_owned(), |mib| format!("{mib:.0} MiB"));
    print(&format!(
        "{} x {} px, pen {} px\n{} strokes, {} vertices\n{seconds:.2} s, {:.2} ms a megapixel, peak memory {memory}\n",
        scan.width(),
        scan.height(),
        sheet.pen_px.unwrap_or(0),
        drawing.strokes().len(),
        drawing.vertices(),
        1e3 * seconds / megapixels.max(1e-6),
    ))?;
    if let Some(file) = &arguments.svg {
        let mut out = String::new();
        svg(drawing, 1.0, &mut out).map_err(|error| error.to_string())?;
        write_file(file, out)?;
    }
    if let Some(file) = &arguments.hpgl {
        let scale = Scale::new(scan.height(), MM_PER_PX, Point { x: 0.0, y: 0.0 });
        let scale = scale.map_err(|error| error.to_string())?;
        let mut out = String::new();
        hpgl(drawing, scale, &mut out).map_err(|error| error.to_string())?;
        write_file(file, out)?;
    }
    Ok(())
}

/// Most memory that this process has had, MiB; where the system tells.
fn peak_memory_mib() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib / 1024.0)
}
