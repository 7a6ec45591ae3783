//! From a scanned line drawing to pen strokes: vectorization alone, without a machine.
//!
//! Shows the published vectorization and ours side by side on the same picture: trace it with both and compare the
//! vertices, the error and the travel with the pen up. Look at the SVG beside the picture: the published strokes
//! wander off slow curves and leave a pixel open where lines meet; ours stay within the promised error and close.
//!
//! Without a picture it traces the flag that comes with the examples:
//!
//! ```text
//! cargo run --release --example trace
//! cargo run --release --example trace -- scan.png --max-error-px 0.4 --svg scan.svg --hpgl scan.plt
//! ```

use clap::{Parser, ValueEnum};
use plotter_examples::{print, read_file, run, write_file};
use plotter_motion::Point;
use plotter_vector::{
    Algorithm, Bin, Bounded, Drawing, Scale, Vectorized, Vectorizer, decode, error_chart, hpgl, svg,
};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// The picture that is traced when none is given.
const FLAG: &[u8] = include_bytes!("data/flag.png");

/// Size of a pixel in the HPGL file, mm: 254 dots per inch, 4 plotter units a pixel.
const MM_PER_PX: f64 = 0.1;

/// Traces a scanned line drawing into pen strokes.
#[derive(Debug, Parser)]
#[command(
    after_help = "Example:\n  trace scan.png --max-error-px 0.4 --svg scan.svg --hpgl scan.plt --report scan.json"
)]
struct Arguments {
    /// PNG, JPEG, PBM or PGM picture of lines [default: the flag that comes with the examples]
    image: Option<PathBuf>,
    /// Vectorization
    #[arg(long, value_enum, default_value = "ours")]
    algorithm: Choice,
    /// Greatest distance of a pixel from the line that replaces it, px (ours only) [default: 0.5]
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    max_error_px: Option<f64>,
    /// Writes the strokes as SVG: the picture's size in px, y down, pixel centres at .5
    #[arg(long, value_name = "F")]
    svg: Option<PathBuf>,
    /// Writes the strokes as HPGL, 0.1 mm a pixel, y up from the centre of the lower left pixel
    #[arg(long, value_name = "F")]
    hpgl: Option<PathBuf>,
    /// Writes the vertices as text: x and y a line, in px as in the SVG, an empty line between strokes
    #[arg(long, value_name = "F")]
    points: Option<PathBuf>,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Writes the distribution of the errors as a bar chart
    #[arg(long, value_name = "F.svg")]
    error_plot: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Choice {
    /// Ordered tracking, pre-elimination, dynamic threshold: as published, without an error bound
    Published,
    /// Fewest vertices within the greatest error
    Ours,
}

/// The figures of a tracing.
#[derive(Debug, Serialize)]
struct Report<'a> {
    vertices: usize,
    strokes: usize,
    mean_px: f64,
    max_px: f64,
    sd_px: f64,
    histogram: &'a [Bin],
    pen_down_px: f64,
    pen_up_px: f64,
    /// From grey levels to ordered strokes, without reading and decoding the file.
    time_ms: f64,
    peak_rss_mb: Option<f64>,
}

fn main() -> ExitCode {
    run("trace", || trace(&Arguments::parse()))
}

fn trace(arguments: &Arguments) -> Result<(), String> {
    let vectorizer = vectorizer(arguments)?;
    let name = arguments.image.as_deref().unwrap_or(Path::new("flag.png")).display().to_string();
    let read = arguments.image.as_deref().map(read_file).transpose()?;
    let gray = decode(read.as_deref().unwrap_or(FLAG)).map_err(|error| format!("{name}: {error}"))?;

    let start = Instant::now();
    let traced = vectorizer.vectorize(&gray).map_err(|error| format!("{name}: {error}"))?;
    let time_ms = start.elapsed().as_secs_f64() * 1e3;

    let Vectorized { drawing, error, .. } = &traced;
    let report = Report {
        vertices: drawing.vertices(),
        strokes: drawing.strokes().len(),
        mean_px: error.mean_px,
        max_px: error.max_px,
        sd_px: error.sd_px,
        histogram: &error.histogram,
        pen_down_px: drawing.pen_down_px(),
        pen_up_px: drawing.pen_up_px(),
        time_ms,
        peak_rss_mb: peak_rss_mb(),
    };
    write_files(arguments, &traced, &report, &name)?;
    print_table(&format!("{name}: {} x {} px", gray.width(), gray.height()), &report, traced.split.is_none())
}

fn vectorizer(arguments: &Arguments) -> Result<Vectorizer, String> {
    match (arguments.algorithm, arguments.max_error_px) {
        (Choice::Published, Some(_)) => {
            Err("--max-error-px: the published algorithm has no error bound; take \
                                             --algorithm ours, or leave the option out"
                .into())
        }
        (Choice::Published, None) => {
            Ok(Vectorizer { algorithm: Algorithm::Published, ..Vectorizer::default() })
        }
        (Choice::Ours, None) => Ok(Vectorizer::default()),
        (Choice::Ours, Some(tolerance_px)) if tolerance_px > 0.0 && tolerance_px.is_finite() => {
            Ok(Vectorizer { ours: Bounded { tolerance_px }, ..Vectorizer::default() })
        }
        (Choice::Ours, Some(bad)) => {
            Err(format!("--max-error-px: {bad} px is not a positive number; 0.5 is half a pixel"))
        }
    }
}

fn write_files(
    arguments: &Arguments,
    traced: &Vectorized,
    report: &Report<'_>,
    name: &str,
) -> Result<(), String> {
    let drawing = &traced.drawing;
    let text = |error: std::fmt::Error| error.to_string();
    if let Some(path) = &arguments.svg {
        let mut out = String::new();
        svg(drawing, 1.0, &mut out).map_err(text)?;
        write_file(path, out)?;
    }
    if let Some(path) = &arguments.hpgl {
        // The picture's corner lies half a pixel off, so that the centre of its lower left pixel is the origin.
        let corner = Point::new(-0.5 * MM_PER_PX, -0.5 * MM_PER_PX);
        let scale = Scale::new(drawing.height_px(), MM_PER_PX, corner).map_err(|error| error.to_string())?;
        let mut out = String::new();
        hpgl(drawing, scale, &mut out).map_err(|error| error.to_string())?;
        write_file(path, out)?;
    }
    if let Some(path) = &arguments.points {
        write_file(path, points(drawing).map_err(text)?)?;
    }
    if let Some(path) = &arguments.error_plot {
        let mut out = String::new();
        // The file alone: a long path would not fit above the chart.
        let file = Path::new(name).file_name().map_or(name.into(), |file| file.to_string_lossy());
        error_chart(&traced.error, &format!("Error of the vectorization of {file}"), &[], &mut out)
            .map_err(text)?;
        write_file(path, out)?;
    }
    if let Some(path) = &arguments.report {
        let out = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
        write_file(path, out + "\n")?;
    }
    Ok(())
}

fn points(drawing: &Drawing) -> Result<String, std::fmt::Error> {
    let mut out = String::new();
    for (index, stroke) in drawing.strokes().enumerate() {
        if index > 0 {
            out.push('\n');
        }
        for vertex in stroke {
            writeln!(out, "{} {}", vertex.x, vertex.y)?;
        }
    }
    Ok(out)
}

fn print_table(title: &str, report: &Report<'_>, empty: bool) -> Result<(), String> {
    let mut out = String::new();
    let note = if empty { " (an empty sheet)" } else { "" };
    let rss = report.peak_rss_mb.map_or("-".into(), |rss| format!("{rss:.1} MB"));
    write!(
        out,
        "{title}{note}\n  vertices   {:>10}\n  strokes    {:>10}\n  mean error {:>10.4} px\n  max error  {:>10.4} px\n  \
         sd         {:>10.4} px\n  pen down   {:>10.1} px\n  pen up     {:>10.1} px\n  time       {:>10.2} ms\n  \
         memory     {rss:>13}\n",
        report.vertices,
        report.strokes,
        report.mean_px,
        report.max_px,
        report.sd_px,
        report.pen_down_px,
        report.pen_up_px,
        report.time_ms
    )
    .map_err(|error| error.to_string())?;
    print(&out)
}

/// Most memory the process has had, MB; known on Linux only.
fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
