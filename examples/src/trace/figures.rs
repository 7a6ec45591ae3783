//! The figures of a tracing, as JSON and as a table.

use super::settings::Settings;
use super::traced::Traced;
use crate::shared::{Paper, PaperReport, PictureSize, assumed, told_bare, told_insides, told_notes};
use plotter_vector::{
    Drawing, ErrorReport,
    picture::{FileNotes, Ground},
    report::{Bin, Spots},
    trace::SheetErrors,
};
use serde::Serialize;
use std::fmt::Write as _;

/// The figures of a tracing.
#[derive(Debug, Serialize)]
pub(super) struct Report<'a> {
    picture: PictureReport,
    /// The sheet that was straightened; of it are all of the figures.
    #[serde(skip_serializing_if = "Option::is_none")]
    paper: Option<PaperReport>,
    /// What was taken from the file or assumed, a line each.
    assumed: Vec<String>,
    /// The same as rows of the table.
    #[serde(skip)]
    told: Vec<(&'static str, String)>,
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
    /// strokes, none inside of an area is left out, nothing drawn lies farther from the ink than that or the
    /// half pixel that the raster leaves open, and nothing was taken for dirt.
    kept: Option<bool>,
    /// Ink that lies farther from the strokes than the greatest error.
    bare: Option<Spots>,
    /// Ink inside of areas that the pen does not draw.
    areas: Option<Spots>,
    dirt: Dirt,
    pen_down_px: f64,
    pen_up_px: f64,
    /// From the file to ordered strokes and their errors, without writing them; of pens without reading it.
    time_ms: f64,
    peak_rss_mb: Option<f64>,
}

impl<'a> Report<'a> {
    pub(super) fn new(settings: &Settings, traced: &'a Traced) -> Self {
        let drawing = &traced.drawing;
        let errors: Option<&ErrorReport> = traced.errors.as_ref().map(|errors| &errors.report);
        let ours = settings.vectorizer.ours();
        let mut told = vec![("size", settings.size.told())];
        told.extend(told_notes(&traced.notes));
        told.extend(traced.ink.iter().cloned());
        Self {
            picture: PictureReport::new(&traced.notes, &settings.size),
            paper: traced.paper.as_ref().map(Paper::report),
            assumed: assumed(&told),
            told,
            mode: ours.map(|ours| ours.mode),
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
            kept: traced.errors.as_ref().zip(ours).map(|(errors, ours)| {
                traced.removed.removed_marks == 0
                    && traced.left_out == 0
                    && errors.are_within(ours.tolerance_px)
            }),
            bare: traced.errors.as_ref().filter(|_| ours.is_some()).map(|errors| errors.bare.clone()),
            areas: traced.errors.as_ref().filter(|_| ours.is_some()).map(|errors| errors.insides.clone()),
            dirt: Dirt {
                marks: traced.removed.removed_marks,
                px: traced.removed.removed_px,
                largest_px: traced.removed.largest_removed_px,
            },
            pen_down_px: drawing.pen_down_px(),
            pen_up_px: drawing.pen_up_px(),
            time_ms: traced.time.as_secs_f64() * 1e3,
            peak_rss_mb: peak_rss_mb(),
        }
    }
}

/// What the file says of its picture, and how large that is on the sheet.
#[derive(Debug, Serialize)]
struct PictureReport {
    format: String,
    width_px: u32,
    height_px: u32,
    /// As in EXIF, 1 to 8: how it is stored.
    orientation: u8,
    page: u32,
    pages: u32,
    is_animated: bool,
    /// What a transparent one was laid on.
    ground: Option<&'static str>,
    /// Dots per inch across and down, as the file says, whatever it says.
    dpi: Option<[f64; 2]>,
    width_mm: f64,
    height_mm: f64,
    mm_per_px: f64,
}

impl PictureReport {
    fn new(notes: &FileNotes, size: &PictureSize) -> Self {
        let [width_mm, height_mm] = size.sheet_mm;
        Self {
            format: notes.format.to_string(),
            width_px: notes.width_px,
            height_px: notes.height_px,
            orientation: notes.orientation.number(),
            page: notes.page,
            pages: notes.pages,
            is_animated: notes.is_animated,
            ground: notes.ground.map(|ground| match ground {
                Ground::White => "white",
                Ground::Black => "black",
            }),
            dpi: notes.resolution.map(|resolution| resolution.dpi()),
            width_mm,
            height_mm,
            mm_per_px: size.mm_per_px,
        }
    }
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

/// What was taken for dirt, if anything.
fn dirt_of(report: &Report<'_>) -> Option<String> {
    let Dirt { marks, px, largest_px } = report.dirt;
    let of = if marks == 1 { "mark" } else { "marks" };
    (marks > 0).then(|| format!("{marks} {of} left out: {px} px of ink, the largest {largest_px} px"))
}

pub(super) fn table(title: &str, report: &Report<'_>, megapixels: f64, circled: Option<String>) -> String {
    let rss = report.peak_rss_mb.map_or("-".into(), |rss| format!("{rss:.1} MB"));
    let px = |error_px: Option<f64>| error_px.map(|error_px| format!("{error_px:.4} px"));
    let told = report.told.iter().map(|(name, text)| (*name, Some(text.clone())));
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
        ("bare", report.bare.as_ref().and_then(told_bare)),
        ("areas", report.areas.as_ref().and_then(told_insides)),
        ("dirt", dirt_of(report)),
    ];
    let mut out = format!("{title}\n");
    let rows: Vec<(&str, Option<String>)> = told.chain(rows).collect();
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
