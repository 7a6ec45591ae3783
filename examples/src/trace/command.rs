//! The command line of `trace`, and its course.

use super::explain::{check as check_folder, explain};
use super::figures::{Report, table};
use super::files::{check_size, prints_file, write_files};
use super::settings::settings;
use super::traced::{Input, by_rows, in_colour};
use crate::shared::{
    ExitStatus, PaperError, PaperOption, SizeOptions, Telling, UsualSize, doubted, is_standard, lost_ink,
    no_pen_got, run, write_output,
};
use crate::trace::{Interrupt, Overlay, overlay_png};
use clap::{Parser, ValueEnum};
use plotter_vector::trace::{Doubt, Prefer};
use std::fs::File;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Size of a pixel if neither the file nor an option states it, mm.
const MM_PER_PX: f64 = 0.1;

/// Remedies if a picture does not look like a drawing.
const REMEDY: &str = "--ink F.png shows what was taken for ink; another way to tell it (--threshold otsu, or a level as --threshold \
                      100) or --min-stroke MM may leave the noise out, and --min-stroke 0 keeps every stroke";

/// The picture that is traced when none is given.
pub(super) const FLAG: &[u8] = include_bytes!("../../data/flag.png");

/// Traces a scanned line drawing into pen strokes.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    after_help = "Examples:\n  plotter trace scan.png --max-error-px 0.4 --svg scan.svg --hpgl scan.plt --report scan.json\n  \
                  plotter trace photo.jpg --mode mixed --hatch 0.5 --overlay look.png --explain steps\n  \
                  plotter trace drawing.png --pens 3 --svg pens.svg --hpgl pens.plt\n  \
                  scanimage --format png | plotter trace - --hpgl - > scan.plt\n  \
                  plotter trace a0.tif --no-errors --svg a0.svg\n\n\
                  One of the files that are written may be -, the standard output; the figures then go to the standard error.\n\n\
                  In a checkout of the project, `cargo run --release --example trace --` stands for `plotter trace`."
)]
pub struct TraceCommand {
    /// PNG, JPEG, TIFF, WebP, BMP, GIF, PBM, PGM or PPM picture of lines, of any size except with
    /// --pens; - is the standard input [default: the flag that comes with the examples]
    image: Option<PathBuf>,
    /// Algorithm of the vectorization
    #[arg(long, value_enum, default_value = "ours")]
    pub(super) algorithm: Choice,
    /// Greatest distance of a pixel from the line that replaces it, px (ours only) [default: 0.5]
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub(super) max_error_px: Option<f64>,
    /// Uses circular arcs and circles where they save vertices, within the same error (ours only): CI
    /// and AA in HPGL, G2 and G3 in G-code, A in SVG
    #[arg(long, conflicts_with = "curves")]
    pub(super) arcs: bool,
    /// Uses cubic curves instead of arcs where they save vertices, within the same error (ours only): C
    /// in SVG, chords in HPGL and G-code
    #[arg(long)]
    pub(super) curves: bool,
    /// Whether lines are drawn by their middle or their outline (ours only) [default: centreline, with
    /// --hatch mixed]
    #[arg(long, value_enum)]
    pub(super) mode: Option<ModeChoice>,

    /// Whether strokes are added where one stroke per line leaves ink bare (ours only) [default: both]
    #[arg(long, value_name = "WHAT")]
    pub(super) prefer: Option<PreferChoice>,
    /// How ink is told from paper: auto (chosen by the picture: one level for a clean scan, more for
    /// photographs, pencil and faint lines), otsu, adaptive (uneven light), or a level from 0 to 255
    /// [default: auto]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(super) threshold: Option<String>,
    /// Keeps or drops marks much paler than the ink, such as the ruling of paper or print from the other
    /// side (with --threshold auto) [default: drop]
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(super) ruling: Option<RulingChoice>,
    /// Joins strokes across gaps up to this length if one continues the other, mm on the sheet (ours
    /// only) [default: none; for pencil and chalk three line widths, for photographs two]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) gap: Option<f64>,
    /// Leaves out strokes shorter than this, mm on the sheet (ours only); 0 accepts a picture of
    /// thousands of dots, which is refused as noise otherwise
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) min_stroke: Option<f64>,
    /// Pens told apart by colour: a number, auto, or the TOML file of a palette (ours only) [default: 1,
    /// by grey level]
    #[arg(long, value_name = "N|auto|F.toml", allow_negative_numbers = true)]
    pub(super) pens: Option<String>,
    /// How thoroughly an order of the strokes with little travel is searched for (ours only) [default:
    /// best]
    #[arg(long, value_enum)]
    pub(super) order: Option<OrderChoice>,
    /// Hatches areas with lines this far apart, mm on the sheet (ours only)
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) hatch: Option<f64>,
    /// Width of the pen that outlines and hatches areas, mm on the sheet: its ink ends at their edge
    /// (ours only) [default: a pixel]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    pub(super) pen_mm: Option<f64>,
    /// Ink wider than this is an area, px (ours only) [default: found from the picture]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(super) max_line_px: Option<i64>,
    #[command(flatten)]
    pub(super) size: SizeOptions,
    #[command(flatten)]
    pub(super) paper: PaperOption,
    /// Number of the picture in a TIFF with several, from 1
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(super) page: u32,
    /// A machine's TOML file: its table [vectorize] sets the defaults of the options
    #[arg(long, value_name = "F.toml")]
    pub(super) config: Option<PathBuf>,
    /// Threads to work with; the result does not depend on their number [default: one per core]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(super) threads: Option<i64>,
    /// Writes the strokes as SVG in true size; its unit is the picture's px, y down, pixel centres at .5
    #[arg(long, value_name = "F")]
    pub(super) svg: Option<PathBuf>,
    /// Writes the strokes as HPGL, y up from the centre of the lower left pixel
    #[arg(long, value_name = "F")]
    pub(super) hpgl: Option<PathBuf>,
    /// Writes the strokes as G-code in mm, y up as in the HPGL
    #[arg(long, value_name = "F")]
    pub(super) gcode: Option<PathBuf>,
    /// How the G-code lifts the pen
    #[arg(long, value_enum, default_value = "servo")]
    pub(super) gcode_pen: GcodePen,
    /// Writes the vertices as text: one line with x and y each, in px as in the SVG, and an empty line
    /// between strokes. A third number is the bulge of an arc that begins there, the tangent of a
    /// quarter of its angle, positive from x towards y; four more numbers are the x and y of both
    /// handles of a cubic curve
    #[arg(long, value_name = "F")]
    pub(super) points: Option<PathBuf>,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    pub(super) report: Option<PathBuf>,
    /// Writes the distribution of the errors as a bar chart
    #[arg(long, value_name = "F.svg")]
    pub(super) error_plot: Option<PathBuf>,
    /// Writes the traced ink, black on white, in the picture's pixels
    #[arg(long, value_name = "F.png")]
    pub(super) ink: Option<PathBuf>,
    /// Prints what was found in the picture, and writes the picture of each step into a folder: its
    /// levels, the evened levels if one level does not tell the ink, and the ink
    #[arg(long, value_name = "FOLDER")]
    pub(super) explain: Option<PathBuf>,
    /// Does not measure the distances between ink and strokes: the file is read twice less
    #[arg(long, conflicts_with = "error_plot")]
    pub(super) no_errors: bool,
    /// Writes the strokes on the pale picture, with the pixel of the greatest error circled unless
    /// --no-errors is given
    #[arg(long, value_name = "F.png")]
    pub(super) overlay: Option<PathBuf>,
    #[command(flatten)]
    pub(super) telling: Telling,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Choice {
    /// As published: ordered tracking, pre-elimination, dynamic threshold, without an error bound
    Published,
    /// Fewest vertices within the greatest error
    Ours,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ModeChoice {
    /// The middle of lines; much wider ink is outlined
    Centreline,
    /// The outlines of everything
    Outline,
    /// The middle of lines, and areas already at three times their width
    Mixed,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum PreferChoice {
    /// Fewest strokes; ink that stays bare is reported
    Strokes,
    /// Adds strokes where more than spots stay bare and the pen fits into the ink
    Both,
    /// Adds strokes for spots too, until the ink is covered within the greatest error
    Ink,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum RulingChoice {
    /// Such marks are ink
    Keep,
    /// Such marks are left out
    Drop,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum GcodePen {
    /// M3 S90 down, M5 up: GRBL with a servo as its spindle
    Servo,
    /// G1 Z0 down, G0 Z5 up
    Z,
    /// M1 90 down, M1 160 up: mDraw, which has no arcs and gets chords
    Mdraw,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum OrderChoice {
    /// As they are found
    None,
    /// From each end to the nearest stroke
    Fast,
    /// With all improvements
    Best,
}

impl TraceCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let mut stopped = false;
        let code = run("trace", || trace(&self, &mut stopped));
        if stopped { ExitStatus::Interrupted.into() } else { code }
    }
}

/// Traces and writes the files; `stopped` returns whether Ctrl-C came before anything was written.
pub(super) fn trace(arguments: &TraceCommand, stopped: &mut bool) -> Result<(), String> {
    let settings = settings(arguments)?;
    let interrupt = Interrupt::new()?;
    check_folder(arguments.explain.as_deref())?;
    let prints_file = prints_file(arguments, &settings)?;
    let input = Input::open(arguments.image.as_deref())?;
    let name = match arguments.image.as_deref() {
        Some(path) if is_standard(path) => "standard input".into(),
        given => given.unwrap_or(Path::new("flag.png")).display().to_string(),
    };
    let here = |error: &dyn std::fmt::Display| format!("{name}: {error}");
    let mut notes = input.notes(arguments.page).map_err(|error| here(&error))?;
    let (mut input, mut page, mut asked) = (input, arguments.page, arguments.size);
    let (mut paper, mut no_sheet) = (None, None);
    if arguments.paper.is_asked() {
        let bytes = input.bytes().map_err(|error| here(&error))?;
        match arguments.paper.straightened(&bytes, page, settings.pens.is_some(), &asked) {
            Ok(Some(found)) => {
                (page, asked) = (1, found.paper.sized(&asked));
                input = Input::Bytes(found.file.into());
                notes = found.notes;
                paper = Some((found.paper, found.photograph));
            }
            Ok(None) => {}
            // The picture may be of use as it is; that it was not straightened is told at the end, too.
            Err(error @ PaperError::NoSheet(_)) => no_sheet = Some(error.told()),
            Err(error) => return Err(here(&error.told())),
        }
    }
    let mut settings = settings.in_size(asked.of(&notes, UsualSize::MmPerPx(MM_PER_PX))?, page)?;
    // A photograph's rims are ragged, in even light, too: ink that is bare there is worth no stroke.
    if paper.is_some()
        && arguments.prefer.is_none()
        && let Some(ours) = settings.vectorizer.ours_mut()
    {
        ours.prefer = Prefer::Strokes;
    }
    let work = || {
        let traced = match (&settings.pens, &input) {
            (Some(pens), _) => in_colour(&settings, pens, &input, arguments, interrupt),
            (None, Input::File(path)) => {
                let file = File::open(path).map_err(|error| format!("cannot be read: {error}"));
                file.and_then(|file| by_rows(&settings, file, arguments, interrupt))
            }
            (None, Input::Bytes(bytes)) => by_rows(&settings, Cursor::new(bytes), arguments, interrupt),
        };
        traced.map_err(|error| here(&error))
    };
    let traced = match &settings.threads {
        Some(pool) => pool.install(work),
        None => work(),
    };
    if !interrupt.may_write() {
        *stopped = true;
        return Err(format!("{name}: stopped; nothing is written"));
    }
    let mut traced = traced?;
    if let Some((paper, _)) = &paper {
        traced.straightened(paper, notes);
    } else if let Some(why) = &no_sheet {
        traced.ink.insert(0, ("paper", format!("as it is: {}", why.trim_start_matches("--paper: "))));
    }
    let traced = traced;
    let drawing = &traced.drawing;
    let report = Report::new(&settings, &traced);
    check_size(arguments, &settings.size, drawing)?;
    write_files(arguments, &settings.size, &traced, &report, &name)?;
    let photograph = paper.as_ref().map(|(paper, photograph)| (&paper.quad, photograph));
    explain(arguments, &settings, &input, photograph).map_err(|error| here(&error))?;
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
    let json = || serde_json::to_string_pretty(&report).map_err(|error| error.to_string());
    if prints_file {
        arguments.telling.tell_aside(&table, json)?;
    } else {
        arguments.telling.tell(&table, json)?;
    }
    // Everything is written: what was traced may still be of use.
    if let Some(why) = no_sheet {
        return Err(here(&why));
    }
    if let Some(left) = traced.unassigned {
        return Err(here(&no_pen_got(left)));
    }
    let is_meant = arguments.min_stroke.is_some() && !matches!(traced.doubt, Some(Doubt::Rough { .. }));
    doubted(traced.doubt.filter(|_| !is_meant), REMEDY).map_err(|error| here(&error))?;
    match &traced.errors {
        Some(errors) => {
            lost_ink(&settings.vectorizer, errors, traced.widest_px, traced.is_uneven || paper.is_some())
                .map_err(|error| here(&error))
        }
        None => Ok(()),
    }
}
