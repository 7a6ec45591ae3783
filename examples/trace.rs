//! From a scanned line drawing to pen strokes: vectorization alone, without a machine.
//!
//! Shows the published vectorization and ours side by side on the same picture: trace it with both and compare the
//! vertices, the error and the travel with the pen up. Look at the SVG beside the picture: the published strokes
//! wander off slow curves and leave a pixel open where lines meet; ours stay within the promised error and close.
//!
//! The picture is read by rows and never held whole, so a sheet may have any size: look at the last line of an A1 scan,
//! whose memory is that of a small picture. Only `--pens` needs all of it at once. Ctrl-C stops it between two bands, and
//! nothing is written.
//!
//! Without a picture it traces the flag that comes with the examples:
//!
//! ```text
//! cargo run --release --example trace
//! cargo run --release --example trace -- scan.png --max-error-px 0.4 --svg scan.svg --hpgl scan.plt
//! cargo run --release --example trace -- scan.png --arcs --svg scan.svg --gcode scan.gcode
//! cargo run --release --example trace -- photo.jpg --pens 3 --svg pens.svg --overlay pens.png
//! scanimage --format png | cargo run --release --example trace -- - --hpgl - > scan.plt
//! cargo run --release --example draw_corpus -- --sheet a1 --dpi 600 a1.pbm
//! cargo run --release --example trace -- a1.pbm --svg a1.svg
//! ```

use clap::{Parser, ValueEnum};
use indicatif::{ProgressBar, ProgressStyle};
use plotter_examples::shared::{
    at, is_standard, lost_ink, print, read_file, read_input, run, vectorizer, write_output,
};
use plotter_examples::trace::{INTERRUPTED, Interrupt, Overlay, overlay_png, overlay_step};
use plotter_motion::gcode::{PenControl, WriteOptions};
use plotter_motion::hpgl::UNITS_PER_MM;
use plotter_motion::{
    Machine, Point,
    config::{PensChoice, StrokeOrder, ThresholdChoice, VectorizeConfig, VectorizeMode},
};
use plotter_vector::{
    Algorithm, Colour, DecodeError, Drawing, ErrorReport, FileRows, Palette, Pixel, Prefer, Progress,
    PxPoint, Scale, ThresholdMethod, Vectorizer, decode_colour, gcode, hpgl,
    ink::{Despeckled, MAX_PENS, Pens, pen_width_px},
    picture::{Row, RowSource as _},
    report::{Bin, error_chart},
    trace::SheetErrors,
    write::svg_in_colour,
};
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::ops::{ControlFlow, RangeInclusive};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The picture that is traced when none is given.
const FLAG: &[u8] = include_bytes!("data/flag.png");

/// Farthest that the chords for a machine without arcs are from them, mm.
const MDRAW_CHORD_MM: f64 = 0.01;

/// Steps of the progress bar.
const STEPS: f64 = 1000.0;

/// Greatest errors that may be asked for, px: those of the machine's file.
const MAX_ERRORS_PX: RangeInclusive<f64> = 0.01..=100.0;

/// Widest pen that may be asked for, mm: that of the machine's file.
const MAX_PEN_MM: f64 = 100.0;

/// What HPGL and G-code, as they are written here, tell apart, mm: a plotter unit, and the third decimal.
const UNIT_MM: f64 = 1.0 / UNITS_PER_MM;
const GCODE_MM: f64 = 0.001;

/// Part of a pixel that a raster leaves open: the border of ink passes anywhere between the middles of two
/// pixels.
const RASTER_PX: f64 = 0.5;

/// Drawings up to this side are dots, px.
const DOT_PX: f64 = 3.0;

/// With more pixels to that step shapes fall together.
const COARSE_PX: f64 = 4.0;

/// Most threads that are started.
const MAX_THREADS: usize = 1024;

/// Traces a scanned line drawing into pen strokes.
#[derive(Debug, Parser)]
#[command(
    after_help = "Examples:\n  trace scan.png --max-error-px 0.4 --svg scan.svg --hpgl scan.plt --report scan.json\n  \
                  trace photo.jpg --threshold adaptive --mode mixed --hatch 0.5 --overlay look.png\n  \
                  trace drawing.png --pens 3 --svg pens.svg --hpgl pens.plt\n  \
                  scanimage --format png | trace - --hpgl - > scan.plt\n  \
                  trace a0.tif --no-errors --svg a0.svg\n\n\
                  One of the files that are written may be -, the standard output; the figures then go to the standard error."
)]
struct Arguments {
    /// PNG, JPEG, TIFF, PBM, PGM or PPM picture of lines, of any size but for --pens; - is the standard input [default: the flag
    /// that comes with the examples]
    image: Option<PathBuf>,
    /// Vectorization
    #[arg(long, value_enum, default_value = "ours")]
    algorithm: Choice,
    /// Greatest distance of a pixel from the line that replaces it, px (ours only) [default: 0.5]
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    max_error_px: Option<f64>,
    /// Circular arcs and circles where they save vertices, within the same error (ours only): CI and AA, G2 and G3, A
    #[arg(long)]
    arcs: bool,
    /// Cubic curves instead of arcs where they save vertices, within the same error (ours only): C in SVG, chords in HPGL and G-code
    #[arg(long)]
    curves: bool,
    /// What is drawn of the ink (ours only) [default: centreline, with --hatch mixed]
    #[arg(long, value_enum)]
    mode: Option<ModeChoice>,

    /// What is given up where one stroke a line leaves ink bare (ours only) [default: both]
    #[arg(long, value_name = "WHAT")]
    prefer: Option<PreferChoice>,
    /// How ink is told from paper: otsu, adaptive (uneven light), or a level from 0 to 255 [default: otsu]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    threshold: Option<String>,
    /// Pens told apart by colour: how many, auto, or a palette's TOML file (ours only) [default: 1, by grey level]
    #[arg(long, value_name = "N|auto|F.toml", allow_negative_numbers = true)]
    pens: Option<String>,
    /// How hard an order with little travel is searched for (ours only) [default: best]
    #[arg(long, value_enum)]
    order: Option<OrderChoice>,
    /// Hatches areas with lines this far apart, mm on the sheet (ours only)
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    hatch: Option<f64>,
    /// Width of the pen that areas are outlined and hatched with, mm on the sheet: its ink ends at their edge (ours only) [default: a pixel]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pen_mm: Option<f64>,
    /// What is wider is an area, px (ours only) [default: found from the picture]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_line_px: Option<i64>,
    /// Size of a pixel on the sheet, mm: 0.1 is 254 dots per inch, 4 plotter units a pixel
    #[arg(long, value_name = "MM", default_value_t = 0.1, allow_negative_numbers = true)]
    mm_per_px: f64,
    /// A machine's TOML file, whose table [vectorize] is taken where no option says otherwise
    #[arg(long, value_name = "F.toml")]
    config: Option<PathBuf>,
    /// Threads to work with; the result is the same with any number [default: one a core]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    threads: Option<i64>,
    /// Writes the strokes as SVG: the picture's size in px, y down, pixel centres at .5
    #[arg(long, value_name = "F")]
    svg: Option<PathBuf>,
    /// Writes the strokes as HPGL, y up from the centre of the lower left pixel
    #[arg(long, value_name = "F")]
    hpgl: Option<PathBuf>,
    /// Writes the strokes as G-code in mm, y up as in the HPGL
    #[arg(long, value_name = "F")]
    gcode: Option<PathBuf>,
    /// How the G-code lifts the pen
    #[arg(long, value_enum, default_value = "servo")]
    gcode_pen: GcodePen,
    /// Writes the vertices as text: x and y a line, in px as in the SVG, an empty line between strokes; where an arc begins
    /// its bulge too, the tangent of a quarter of its angle, positive from x towards y; where a cubic curve begins the x and y
    /// of its two handles too
    #[arg(long, value_name = "F")]
    points: Option<PathBuf>,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    /// Writes the distribution of the errors as a bar chart
    #[arg(long, value_name = "F.svg")]
    error_plot: Option<PathBuf>,
    /// Leaves out how far the ink lies from the strokes: the file is read twice less
    #[arg(long, conflicts_with = "error_plot")]
    no_errors: bool,
    /// Writes the strokes on the pale picture, with the pixel of the greatest error circled unless --no-errors is given
    #[arg(long, value_name = "F.png")]
    overlay: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Choice {
    /// Ordered tracking, pre-elimination, dynamic threshold: as published, without an error bound
    Published,
    /// Fewest vertices within the greatest error
    Ours,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ModeChoice {
    /// The middle of lines; what is far wider is outlined
    Centreline,
    /// The outlines of everything
    Outline,
    /// The middle of lines, and areas already at three times their width
    Mixed,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PreferChoice {
    /// Fewest strokes: ink that stays bare is told
    Strokes,
    /// Strokes are added where more than spots are bare and the pen fits into the ink
    Both,
    /// Strokes are added for spots too, until the ink is covered within the greatest error
    Ink,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum GcodePen {
    /// M3 S90 down, M5 up: GRBL with a servo as its spindle
    Servo,
    /// G1 Z0 down, G0 Z5 up
    Z,
    /// M1 90 down, M1 160 up: mDraw, which knows no arcs and gets chords
    Mdraw,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum OrderChoice {
    /// As they are found
    None,
    /// From each end to the nearest stroke
    Fast,
    /// With all improvements
    Best,
}

/// What the options and the machine's file ask for.
#[derive(Debug)]
struct Settings {
    vectorizer: Vectorizer,
    /// By colour; without, one pen draws all ink.
    pens: Option<Pens>,
    threads: Option<rayon::ThreadPool>,
    overlay: Option<PathBuf>,
}

/// What the overlay shows below the strokes.
#[derive(Debug)]
enum Picture {
    /// Of every `step`th column and row the level; `columns` in a row.
    Gray {
        levels: Vec<u8>,
        columns: usize,
        step: usize,
    },
    Colour(Colour),
}

impl Picture {
    /// The colour of a pixel; white outside.
    fn level(&self, at: Pixel) -> [u8; 3] {
        match self {
            Self::Gray { levels, columns, step } => {
                let index = at.y as usize / step * columns + at.x as usize / step;
                levels.get(index).map(|level| [*level; 3])
            }
            Self::Colour(colour) => {
                colour.pixels().get(at.y as usize * colour.width() as usize + at.x as usize).copied()
            }
        }
        .unwrap_or([u8::MAX; 3])
    }
}

/// What was traced.
#[derive(Debug)]
struct Traced {
    drawing: Drawing,
    errors: Option<SheetErrors>,
    /// What was taken for dirt.
    removed: Despeckled,
    palette: Palette,
    /// Width of the lines, px; unknown where pens were told apart, and without lines.
    pen_px: Option<u32>,
    /// The same of the widest pen's, also where pens were told apart.
    widest_px: Option<u32>,
    /// For the overlay, where one is asked for.
    picture: Option<Picture>,
    time: Duration,
}

/// The figures of a tracing.
#[derive(Debug, Serialize)]
struct Report<'a> {
    /// What was drawn of the ink; the published algorithm has no choice.
    mode: Option<plotter_vector::Mode>,
    pens: Vec<PenReport<'a>>,
    vertices: usize,
    strokes: usize,
    /// Width of the lines; unknown where pens were told apart, and without lines.
    pen_px: Option<u32>,
    mean_px: Option<f64>,
    max_px: Option<f64>,
    sd_px: Option<f64>,
    histogram: Option<&'a [Bin]>,
    /// What the pens draw beside the ink.
    beyond_ink: Option<BeyondReport>,
    /// Whether all ink is drawn within the greatest error, and nothing else: no ink lies farther from the
    /// strokes, nothing drawn farther from the ink than that or the half pixel that the raster leaves open,
    /// and nothing was taken for dirt.
    kept: Option<bool>,
    dirt: Dirt,
    pen_down_px: f64,
    pen_up_px: f64,
    /// From the file to ordered strokes and their errors, without writing them; of pens without reading it.
    time_ms: f64,
    peak_rss_mb: Option<f64>,
}

/// What is drawn and is no ink.
#[derive(Debug, Serialize)]
struct BeyondReport {
    px: u64,
    /// Greatest distance from ink.
    max_px: f64,
    /// Where that is.
    at: Option<[u32; 2]>,
}

/// Ink that was taken for dirt, and is not drawn.
#[derive(Debug, Serialize)]
struct Dirt {
    marks: u64,
    px: u64,
    /// Of the largest mark.
    largest_px: u64,
}

/// What one pen draws.
#[derive(Debug, Serialize)]
struct PenReport<'a> {
    number: u8,
    name: &'a str,
    colour: String,
    strokes: usize,
    pen_down_px: f64,
}

fn main() -> ExitCode {
    let mut stopped = false;
    let code = run("trace", || trace(&Arguments::parse(), &mut stopped));
    if stopped { INTERRUPTED.into() } else { code }
}

/// Traces and writes; `stopped` says that Ctrl-C came before anything was written.
fn trace(arguments: &Arguments, stopped: &mut bool) -> Result<(), String> {
    let settings = settings(arguments)?;
    let interrupt = Interrupt::new()?;
    let prints_file = prints_file(arguments, &settings)?;
    let name = match arguments.image.as_deref() {
        Some(path) if is_standard(path) => "standard input".into(),
        given => given.unwrap_or(Path::new("flag.png")).display().to_string(),
    };
    let here = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let work = || match (&settings.pens, &arguments.image) {
        (Some(pens), path) => {
            in_colour(&settings, pens, path.as_deref(), arguments, interrupt).map_err(|error| here(&error))
        }
        (None, Some(path)) if path.is_file() => {
            let file = File::open(path).map_err(|error| at(path, &format!("cannot be read: {error}")))?;
            by_rows(&settings, file, arguments, interrupt).map_err(|error| here(&error))
        }
        // What cannot be read twice, as a pipe, is kept.
        (None, Some(path)) => {
            let bytes = Cursor::new(picture_bytes(path)?);
            by_rows(&settings, bytes, arguments, interrupt).map_err(|error| here(&error))
        }
        (None, None) => {
            by_rows(&settings, Cursor::new(FLAG), arguments, interrupt).map_err(|error| here(&error))
        }
    };
    let traced = match &settings.threads {
        Some(pool) => pool.install(work),
        None => work(),
    };
    if !interrupt.may_write() {
        *stopped = true;
        return Err(format!("{name}: stopped; nothing is written"));
    }
    let traced = traced?;
    let drawing = &traced.drawing;
    let errors: Option<&ErrorReport> = traced.errors.as_ref().map(|errors| &errors.report);
    let ours = settings.vectorizer.algorithm == Algorithm::Ours;
    let report = Report {
        mode: ours.then_some(settings.vectorizer.mode),
        pens: traced.palette.pens().iter().map(|pen| pen_report(pen, drawing)).collect(),
        vertices: drawing.vertices(),
        strokes: drawing.strokes().len(),
        pen_px: traced.pen_px,
        mean_px: errors.map(|errors| errors.mean_px),
        max_px: errors.map(|errors| errors.max_px),
        sd_px: errors.map(|errors| errors.sd_px),
        histogram: errors.map(|errors| errors.histogram.as_slice()),
        beyond_ink: traced.errors.as_ref().map(|SheetErrors { beyond, .. }| BeyondReport {
            px: beyond.pixels,
            max_px: beyond.max_px,
            at: beyond.worst.map(|at| [at.x, at.y]),
        }),
        kept: traced.errors.as_ref().filter(|_| ours).map(|errors| {
            let tolerance_px = settings.vectorizer.ours.tolerance_px;
            traced.removed.removed_marks == 0
                && errors.report.max_px <= tolerance_px
                && errors.beyond.max_px <= tolerance_px.max(RASTER_PX)
        }),
        dirt: Dirt {
            marks: traced.removed.removed_marks,
            px: traced.removed.removed_px,
            largest_px: traced.removed.largest_removed_px,
        },
        pen_down_px: drawing.pen_down_px(),
        pen_up_px: drawing.pen_up_px(),
        time_ms: traced.time.as_secs_f64() * 1e3,
        peak_rss_mb: peak_rss_mb(),
    };
    check_size(arguments, drawing)?;
    write_files(arguments, &traced, &report, &name)?;
    let mut worst = None;
    if let (Some(path), Some(picture)) = (&settings.overlay, &traced.picture) {
        worst = traced.errors.as_ref().and_then(|errors| errors.worst);
        let palette = settings.pens.as_ref().map(|_| &traced.palette);
        let overlay = Overlay { drawing, palette, worst: worst.map(|(pixel, _)| pixel) };
        write_output(path, overlay_png(overlay, |pixel| picture.level(pixel))?)?;
    }
    let (width, height) = (drawing.width_px(), drawing.height_px());
    let empty = if drawing.strokes().len() == 0 { " (an empty sheet)" } else { "" };
    let megapixels = f64::from(width) * f64::from(height) / 1e6;
    let circled = match worst {
        Some((pixel, error_px)) => Some(format!("{error_px:.4} px at {}, {}", pixel.x, pixel.y)),
        None if settings.overlay.is_some() && arguments.no_errors => {
            Some("- no pixel: --no-errors leaves out which lies farthest".into())
        }
        None => None,
    };
    let table = table(&format!("{name}: {width} x {height} px{empty}"), &report, megapixels, circled);
    if prints_file {
        eprint!("{table}");
    } else {
        print(&table)?;
    }
    // Everything is written: what was traced may still be of use.
    match &traced.errors {
        Some(errors) => {
            lost_ink(&settings.vectorizer, errors, traced.widest_px).map_err(|error| here(&error))
        }
        None => Ok(()),
    }
}

fn picture_bytes(path: &Path) -> Result<Vec<u8>, String> {
    if is_standard(path) {
        read_input().map_err(|error| format!("standard input: {error}"))
    } else {
        read_file(path)
    }
}

/// Whether one of the files is the standard output; two would be mixed.
fn prints_file(arguments: &Arguments, settings: &Settings) -> Result<bool, String> {
    let files = [
        ("--svg", &arguments.svg),
        ("--hpgl", &arguments.hpgl),
        ("--gcode", &arguments.gcode),
        ("--points", &arguments.points),
        ("--report", &arguments.report),
        ("--error-plot", &arguments.error_plot),
        ("--overlay", &settings.overlay),
    ];
    let mut printed = files.iter().filter(|(_, path)| path.as_deref().is_some_and(is_standard));
    match (printed.next(), printed.next()) {
        (Some((one, _)), Some((other, _))) => Err(format!(
            "{one} and {other}: one file at most can go to the standard output (-); name a file for the other"
        )),
        (first, _) => Ok(first.is_some()),
    }
}

/// Refuses a size of pixels with which a drawing becomes a point, and warns of one with which its shapes fall together.
fn check_size(arguments: &Arguments, drawing: &Drawing) -> Result<(), String> {
    let mm_per_px = arguments.mm_per_px;
    let bounds = drawing.strokes().flatten().fold(None, |bounds: Option<(PxPoint, PxPoint)>, at| {
        let (least, most) = bounds.unwrap_or((*at, *at));
        let least = PxPoint::new(least.x.min(at.x), least.y.min(at.y));
        Some((least, PxPoint::new(most.x.max(at.x), most.y.max(at.y))))
    });
    let side_px = bounds.map_or(0.0, |(least, most)| (most.x - least.x).max(most.y - least.y));
    let steps =
        [("--hpgl", arguments.hpgl.is_some(), UNIT_MM), ("--gcode", arguments.gcode.is_some(), GCODE_MM)];
    for (option, _, step_mm) in steps.iter().filter(|(_, is_asked, _)| *is_asked) {
        let step_px = step_mm / mm_per_px;
        // What is smaller than that is a dot on any sheet.
        if side_px >= DOT_PX && side_px < step_px {
            return Err(format!(
                "--mm-per-px: with {mm_per_px} mm the whole drawing is less than the {step_mm} mm that {option} tells apart; \
                 0.1 gives 254 dots per inch"
            ));
        }
        if side_px >= DOT_PX && step_px > COARSE_PX {
            eprintln!(
                "trace: warning: --mm-per-px: with {mm_per_px} mm the {step_mm} mm that {option} tells apart are {step_px:.0} px, \
                 and small shapes fall together; 0.1 gives 254 dots per inch"
            );
        }
    }
    Ok(())
}

/// One pen, told by grey level: the file is read by rows, as often as it takes.
fn by_rows<R: Read + Seek>(
    settings: &Settings,
    file: R,
    arguments: &Arguments,
    interrupt: Interrupt,
) -> Result<Traced, String> {
    let start = Instant::now();
    let mut scan = FileRows::new(file).map_err(|error| error.to_string())?;
    let bar = progress_bar();
    let mut report = |done: f64| {
        bar.set_position(steps(done));
        go_on(interrupt)
    };
    let (vectorizer, mut progress) = (&settings.vectorizer, Progress::new(&mut report));
    let sheet = if arguments.no_errors {
        vectorizer.vectorize_rows(&mut scan, &mut progress)
    } else {
        vectorizer.vectorize_rows_with_errors(&mut scan, &mut progress)
    };
    bar.finish_and_clear();
    let sheet = sheet.map_err(|error| error.to_string())?;
    let time = start.elapsed();
    let picture = settings.overlay.as_ref().map(|_| thumbnail(&mut scan)).transpose()?;
    Ok(Traced {
        drawing: sheet.drawing,
        errors: sheet.errors,
        removed: sheet.removed,
        palette: Palette::default(),
        pen_px: sheet.pen_px,
        widest_px: sheet.pen_px,
        picture,
        time,
    })
}

fn go_on(interrupt: Interrupt) -> ControlFlow<()> {
    if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(steps(1.0));
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} % {eta:>4}") {
        bar.set_style(style);
    }
    bar
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a thousand steps")]
fn steps(share: f64) -> u64 {
    (STEPS * share) as u64
}

/// What the overlay shows of a scan.
fn thumbnail<R: Read + Seek>(scan: &mut FileRows<R>) -> Result<Picture, String> {
    let step = overlay_step(scan.width(), scan.height()) as usize;
    let columns = (scan.width() as usize).div_ceil(step);
    let mut levels = Vec::new();
    let failed = |error: DecodeError| error.to_string();
    scan.rewind().map_err(failed)?;
    let mut y = 0;
    while let Some(row) = scan.next_row().map_err(failed)? {
        if y % step == 0 {
            let level = |x: usize| match row {
                Row::Grey(row) => row.get(x).copied(),
                Row::Bits(words) => {
                    words.get(x / 64).map(|word| if word >> (x % 64) & 1 == 1 { 0 } else { 255 })
                }
            };
            levels.extend((0..columns).map(|column| level(column * step).unwrap_or(u8::MAX)));
        }
        y += 1;
    }
    Ok(Picture::Gray { levels, columns, step })
}

/// Pens told apart by colour, on the whole picture.
fn in_colour(
    settings: &Settings,
    pens: &Pens,
    path: Option<&Path>,
    arguments: &Arguments,
    interrupt: Interrupt,
) -> Result<Traced, String> {
    let read = path.map(picture_bytes).transpose()?;
    let colour = decode_colour(read.as_deref().unwrap_or(FLAG)).map_err(|error| match error {
        DecodeError::TooLarge(_) | DecodeError::TooMuchMemory { .. } => format!(
            "--pens: colours are told apart on the whole picture, but {error}; or take --pens 1, which is traced by \
             rows at any size"
        ),
        other => other.to_string(),
    })?;
    drop(read);
    let start = Instant::now();
    let bar = progress_bar();
    let mut report = |done: f64| {
        bar.set_position(steps(done));
        go_on(interrupt)
    };
    let found =
        settings.vectorizer.vectorize_colour_with_progress(&colour, pens, &mut Progress::new(&mut report));
    bar.finish_and_clear();
    let found = found.map_err(|error| error.to_string())?;
    let time = start.elapsed();
    let drawing = found.traced.drawing;
    let errors = SheetErrors { report: found.traced.error, worst: found.worst, beyond: found.traced.beyond };
    let errors = (!arguments.no_errors).then_some(errors);
    let picture = settings.overlay.is_some().then_some(Picture::Colour(colour));
    let widest_px = found.inks.iter().filter_map(pen_width_px).max();
    let removed = found.traced.removed;
    Ok(Traced { errors, removed, palette: found.palette, pen_px: None, widest_px, picture, time, drawing })
}

fn pen_report<'a>(pen: &'a plotter_vector::ink::PalettePen, drawing: &Drawing) -> PenReport<'a> {
    let own = drawing.of_pen(pen.number);
    PenReport {
        number: pen.number,
        name: &pen.name,
        colour: pen.colour.to_string(),
        strokes: own.strokes().len(),
        pen_down_px: own.pen_down_px(),
    }
}

/// The machine's file, then the options: what they say wins.
fn settings(arguments: &Arguments) -> Result<Settings, String> {
    let mut config = match &arguments.config {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            Machine::from_toml(&text).map_err(|error| at(path, &error))?.config().vectorize
        }
        None => VectorizeConfig::default(),
    };
    let mm_per_px = arguments.mm_per_px;
    if !(mm_per_px > 0.0 && mm_per_px.is_finite()) {
        return Err(format!(
            "--mm-per-px: {mm_per_px} mm is not a positive number; 0.1 gives 254 dots per inch"
        ));
    }
    if let Some(text) = &arguments.threshold {
        config.threshold = match text.parse::<ThresholdMethod>().map_err(|error| format!("--{error}"))? {
            ThresholdMethod::Otsu => ThresholdChoice::Otsu,
            ThresholdMethod::Adaptive => ThresholdChoice::Adaptive,
            ThresholdMethod::Level(level) => ThresholdChoice::Level(level),
        };
    }
    let in_file = Some(i64::from(config.threads)).filter(|number| *number > 0);
    let threads = arguments.threads.or(in_file).map(threads).transpose()?;
    let in_file =
        Some(config.overlay).filter(|path| !path.is_none()).map(|path| PathBuf::from(path.as_str()));
    let overlay = arguments.overlay.clone().or(in_file);
    if matches!(arguments.algorithm, Choice::Published) {
        refuse_ours(arguments)?;
        let threshold =
            vectorizer(&VectorizeConfig { threshold: config.threshold, ..Default::default() }, 1.0)?;
        let vectorizer = Vectorizer { algorithm: Algorithm::Published, ..threshold };
        return Ok(Settings { vectorizer, pens: None, threads, overlay });
    }
    match arguments.max_error_px {
        Some(bad) if !(bad > 0.0 && bad.is_finite()) => {
            return Err(format!("--max-error-px: {bad} px is not a positive number; 0.5 is half a pixel"));
        }
        Some(bad) if !MAX_ERRORS_PX.contains(&bad) => {
            let (least, most) = (MAX_ERRORS_PX.start(), MAX_ERRORS_PX.end());
            return Err(format!(
                "--max-error-px: {bad} px lies outside {least}..={most} px; 0.5 is half a pixel"
            ));
        }
        given => config.max_error_px = given.unwrap_or(config.max_error_px),
    }
    // An option wins over the file, which may ask for the other.
    if arguments.arcs || arguments.curves {
        (config.arcs, config.curves) = (arguments.arcs, arguments.curves);
    }
    match arguments.hatch {
        Some(bad) if !(bad >= 0.0 && bad.is_finite()) => {
            return Err(format!(
                "--hatch: {bad} mm is no distance; give a pen's width, as 0.5, or 0 for none"
            ));
        }
        Some(hatch_mm) => {
            config.hatch_mm = hatch_mm;
            if hatch_mm > 0.0 {
                config.mode = VectorizeMode::Mixed;
            }
        }
        None => {}
    }
    match arguments.pen_mm {
        Some(bad) if !(0.0..=MAX_PEN_MM).contains(&bad) => {
            return Err(format!(
                "--pen-mm: {bad} mm lies outside 0..={MAX_PEN_MM} mm; a fineliner draws 0.3 to 0.8"
            ));
        }
        given => config.pen_mm = given.unwrap_or(config.pen_mm),
    }
    match arguments.mode {
        Some(ModeChoice::Centreline) => config.mode = VectorizeMode::Centreline,
        Some(ModeChoice::Outline) => config.mode = VectorizeMode::Outline,
        Some(ModeChoice::Mixed) => config.mode = VectorizeMode::Mixed,
        None => {}
    }
    match arguments.order {
        Some(OrderChoice::None) => config.order = StrokeOrder::None,
        Some(OrderChoice::Fast) => config.order = StrokeOrder::Fast,
        Some(OrderChoice::Best) => config.order = StrokeOrder::Best,
        None => {}
    }
    if let Some(given) = arguments.max_line_px {
        let fits = u32::try_from(given).ok().filter(|px| *px <= plotter_vector::areas::MAX_LINE_PX);
        config.max_line_px = fits.ok_or_else(|| {
            format!(
                "--max-line-px: {given} px lies outside 0..={} px; 0 finds it from the picture",
                plotter_vector::areas::MAX_LINE_PX
            )
        })?;
    }
    // The file's own, for options exclude each other.
    if let (Some(path), true) = (&arguments.config, config.arcs && config.curves && !arguments.arcs) {
        return Err(at(path, &"[vectorize] arcs and curves: strokes have one of them; leave one out"));
    }
    let pens = pens(arguments, config.pens)?;
    let prefer = match arguments.prefer {
        Some(PreferChoice::Strokes) => Prefer::Strokes,
        Some(PreferChoice::Both) | None => Prefer::Both,
        Some(PreferChoice::Ink) => Prefer::Ink,
    };
    let vectorizer = Vectorizer { prefer, ..vectorizer(&config, mm_per_px)? };
    Ok(Settings { vectorizer, pens, threads, overlay })
}

/// Refuses options that the published algorithm does not have.
fn refuse_ours(arguments: &Arguments) -> Result<(), String> {
    let given = [
        ("--max-error-px", "has no error bound", arguments.max_error_px.is_some()),
        ("--arcs", "draws straight lines", arguments.arcs),
        ("--curves", "draws straight lines", arguments.curves),
        ("--prefer", "adds no strokes", arguments.prefer.is_some()),
        ("--mode", "always follows the middle of lines", arguments.mode.is_some()),
        ("--pens", "draws with one pen", arguments.pens.is_some()),
        ("--order", "draws in the order of tracking", arguments.order.is_some()),
        ("--hatch", "has no areas", arguments.hatch.is_some()),
        ("--pen-mm", "has no areas", arguments.pen_mm.is_some()),
        ("--max-line-px", "has no areas", arguments.max_line_px.is_some()),
    ];
    match given.iter().find(|(.., given)| *given) {
        Some((option, why, _)) => Err(format!(
            "{option}: the published algorithm {why}; take --algorithm ours, or leave the option out"
        )),
        None => Ok(()),
    }
}

/// The pens that the option names, else those that the machine's file says; none: one pen, by grey level.
fn pens(arguments: &Arguments, in_file: PensChoice) -> Result<Option<Pens>, String> {
    let pens = match arguments.pens.as_deref() {
        None => match in_file {
            PensChoice::Count(number) => count(number as usize),
            PensChoice::Auto => Some(Pens::Found),
            PensChoice::Palette(path) => {
                Some(Pens::Given(palette("vectorize.pens", Path::new(path.as_str()))?))
            }
            _ => None,
        },
        Some("auto") => Some(Pens::Found),
        Some(text) => match text.parse::<i64>() {
            Ok(number) => match usize::try_from(number).ok().filter(|number| (1..=MAX_PENS).contains(number))
            {
                Some(number) => count(number),
                None => {
                    return Err(format!(
                        "--pens: {number} pens cannot be found: ask for 1 to {MAX_PENS}, or auto"
                    ));
                }
            },
            Err(_) => Some(Pens::Given(palette("--pens", Path::new(text))?)),
        },
    };
    // What the machine's file says of the threshold rests when pens are asked for; the option would go unheard.
    if pens.is_some() && arguments.threshold.is_some() {
        return Err(
            "--threshold: pens are told apart by colour, without a level; leave it out, or take --pens 1"
                .into(),
        );
    }
    Ok(pens)
}

fn count(pens: usize) -> Option<Pens> {
    (pens > 1).then_some(Pens::Count(pens))
}

fn palette(asked: &str, path: &Path) -> Result<Palette, String> {
    let bytes = read_file(path)
        .map_err(|error| format!("{asked}: {error}; give 1 to {MAX_PENS}, auto, or a palette's TOML file"))?;
    let text =
        String::from_utf8(bytes).map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
    Palette::from_toml(&text).map_err(|error| at(path, &error))
}

fn threads(given: i64) -> Result<rayon::ThreadPool, String> {
    let number = usize::try_from(given).ok().filter(|number| (1..=MAX_THREADS).contains(number));
    let number = number.ok_or_else(|| {
        format!("--threads: {given} lies outside 1..={MAX_THREADS}; leave it out for one a core")
    })?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number).build();
    pool.map_err(|error| format!("--threads: {number} cannot be started: {error}; take fewer"))
}

fn write_files(
    arguments: &Arguments,
    traced: &Traced,
    report: &Report<'_>,
    name: &str,
) -> Result<(), String> {
    let drawing = &traced.drawing;
    let text = |error: std::fmt::Error| error.to_string();
    if let Some(path) = &arguments.svg {
        let mut out = String::new();
        svg_in_colour(drawing, &traced.palette, 1.0, &mut out).map_err(text)?;
        write_output(path, out)?;
    }
    if let Some(path) = &arguments.hpgl {
        let mut out = String::new();
        hpgl(drawing, sheet(arguments, drawing)?, &mut out).map_err(|error| error.to_string())?;
        write_output(path, out)?;
    }
    if let Some(path) = &arguments.gcode {
        write_output(path, gcode_text(drawing, sheet(arguments, drawing)?, arguments.gcode_pen)?)?;
    }
    if let Some(path) = &arguments.points {
        write_output(path, points(drawing).map_err(text)?)?;
    }
    if let (Some(path), Some(errors)) = (&arguments.error_plot, &traced.errors) {
        let mut out = String::new();
        // The file alone: a long path would not fit above the chart.
        let file = Path::new(name).file_name().map_or(name.into(), |file| file.to_string_lossy());
        let title = format!("Error of the vectorization of {file}");
        error_chart(&errors.report, &title, &[], &mut out).map_err(text)?;
        write_output(path, out)?;
    }
    if let Some(path) = &arguments.report {
        let out = serde_json::to_string_pretty(report).map_err(|error| error.to_string())?;
        write_output(path, out + "\n")?;
    }
    Ok(())
}

/// From the picture to the plotter's sheet.
fn sheet(arguments: &Arguments, drawing: &Drawing) -> Result<Scale, String> {
    let mm_per_px = arguments.mm_per_px;
    // The picture's corner lies half a pixel off, so that the centre of its lower left pixel is the origin.
    let corner = Point::new(-0.5 * mm_per_px, -0.5 * mm_per_px);
    Scale::new(drawing.height_px(), mm_per_px, corner).map_err(|error| error.to_string())
}

fn gcode_text(drawing: &Drawing, scale: Scale, pen: GcodePen) -> Result<String, String> {
    let usual = WriteOptions::default();
    let options = match pen {
        GcodePen::Servo => usual,
        GcodePen::Z => WriteOptions { pen: PenControl::Height { up_mm: 5.0, down_mm: 0.0 }, ..usual },
        // What sends the text waits for the servo.
        GcodePen::Mdraw => WriteOptions {
            pen: PenControl::Commands { up: "M1 160", down: "M1 90" },
            settle: Duration::ZERO,
            ..usual
        },
    };
    let chords = match pen {
        GcodePen::Mdraw => drawing.chords(MDRAW_CHORD_MM / scale.mm_per_px()),
        _ => Cow::Borrowed(drawing),
    };
    let mut out = String::new();
    gcode(&chords, scale, options, &mut out).map_err(|error| error.to_string())?;
    Ok(out)
}

fn points(drawing: &Drawing) -> Result<String, std::fmt::Error> {
    let mut out = String::new();
    for (index, stroke) in drawing.strokes().enumerate() {
        if index > 0 {
            out.push('\n');
        }
        let bulges = drawing.bulges(index).iter().copied().chain(std::iter::repeat(0.0));
        let handles = drawing.handles(index).iter().copied().chain(std::iter::repeat(None));
        for ((vertex, bulge), handles) in stroke.iter().zip(bulges).zip(handles) {
            write!(out, "{} {}", vertex.x, vertex.y)?;
            if let Some([first, second]) = handles {
                write!(out, " {} {} {} {}", first.x, first.y, second.x, second.y)?;
            } else if bulge != 0.0 {
                write!(out, " {bulge}")?;
            }
            out.push('\n');
        }
    }
    Ok(out)
}

/// What was taken for dirt, if anything.
fn dirt_of(report: &Report<'_>) -> Option<String> {
    let Dirt { marks, px, largest_px } = report.dirt;
    let of = if marks == 1 { "mark" } else { "marks" };
    (marks > 0).then(|| format!("{marks} {of} left out: {px} px of ink, the largest {largest_px} px"))
}

fn table(title: &str, report: &Report<'_>, megapixels: f64, circled: Option<String>) -> String {
    let rss = report.peak_rss_mb.map_or("-".into(), |rss| format!("{rss:.1} MB"));
    let px = |error_px: Option<f64>| error_px.map(|error_px| format!("{error_px:.4} px"));
    let rows = [
        ("line width", report.pen_px.map(|pen_px| format!("{pen_px} px"))),
        ("vertices", Some(report.vertices.to_string())),
        ("strokes", Some(report.strokes.to_string())),
        ("mean error", px(report.mean_px)),
        ("max error", px(report.max_px)),
        ("sd", px(report.sd_px)),
        ("beyond ink", px(report.beyond_ink.as_ref().map(|beyond| beyond.max_px))),
        ("pen down", Some(format!("{:.1} px", report.pen_down_px))),
        ("pen up", Some(format!("{:.1} px", report.pen_up_px))),
        ("time", Some(format!("{:.2} ms", report.time_ms))),
        // Of a small picture it would say nothing.
        ("", (megapixels >= 1.0).then(|| format!("{:.2} ms a megapixel", report.time_ms / megapixels))),
        ("memory", Some(rss)),
        ("circled", circled),
        ("dirt", dirt_of(report)),
    ];
    let mut out = format!("{title}\n");
    for (name, value) in rows.iter().filter_map(|(name, value)| Some((name, value.as_ref()?))) {
        let (number, unit) = value.split_once(' ').unwrap_or((value, ""));
        out.push_str(format!("  {name:10} {number:>10} {unit}").trim_end());
        out.push('\n');
    }
    if let [_, _, ..] = report.pens.as_slice() {
        for pen in &report.pens {
            let _ = writeln!(out, "  pen {:<6} {:>10} strokes, {}", pen.number, pen.strokes, pen.name);
        }
    }
    out
}

/// Most memory the process has had, MB; known on Linux only.
fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}
