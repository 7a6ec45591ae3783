//! The files that are written.

use super::command::{GcodePen, TraceCommand};
use super::figures::Report;
use super::settings::Unscaled;
use super::traced::Traced;
use crate::shared::{PictureSize, is_standard, write_output};
use plotter_motion::{
    Point,
    gcode::{PenControl, WriteOptions},
    hpgl::UNITS_PER_MM,
};
use plotter_vector::{Drawing, PxPoint, Scale, gcode, hpgl, report::error_chart, write::svg_in_colour};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Duration;

/// Farthest that the chords for a machine without arcs are from them, mm.
const MDRAW_CHORD_MM: f64 = 0.01;

/// What HPGL and G-code, as they are written here, tell apart, mm: a plotter unit, and the third decimal.
const UNIT_MM: f64 = 1.0 / UNITS_PER_MM;
const GCODE_MM: f64 = 0.001;

/// Drawings up to this side are dots, px.
const DOT_PX: f64 = 3.0;

/// With more pixels to that step shapes fall together.
const COARSE_PX: f64 = 4.0;

/// Whether one of the files is the standard output; two would be mixed.
pub(super) fn prints_file(arguments: &TraceCommand, settings: &Unscaled) -> Result<bool, String> {
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

/// Refuses a size of pixels with which a drawing becomes a point, and warns of one with which its shapes fall
/// together.
pub(super) fn check_size(
    arguments: &TraceCommand,
    size: &PictureSize,
    drawing: &Drawing,
) -> Result<(), String> {
    let mm_per_px = size.mm_per_px;
    let asked = size.asked.unwrap_or("--mm-per-px");
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
                "{asked}: with {mm_per_px} mm the whole drawing is less than the {step_mm} mm that {option} tells apart; \
                 0.1 gives 254 dots per inch"
            ));
        }
        if side_px >= DOT_PX && step_px > COARSE_PX {
            eprintln!(
                "trace: warning: {asked}: with {mm_per_px} mm the {step_mm} mm that {option} tells apart are {step_px:.0} px, \
                 and small shapes fall together; 0.1 gives 254 dots per inch"
            );
        }
    }
    Ok(())
}

pub(super) fn write_files(
    arguments: &TraceCommand,
    size: &PictureSize,
    traced: &Traced,
    report: &Report<'_>,
    name: &str,
) -> Result<(), String> {
    let drawing = &traced.drawing;
    let text = |error: std::fmt::Error| error.to_string();
    if let Some(path) = &arguments.svg {
        let mut out = String::new();
        svg_in_colour(drawing, &traced.palette, Some(size.mm_per_px), 1.0, &mut out).map_err(text)?;
        if let Some(paper) = &traced.paper {
            out = out.replacen("<svg ", &format!("<svg {} ", paper.svg_attributes()), 1);
        }
        write_output(path, out)?;
    }
    if let Some(path) = &arguments.hpgl {
        let mut out = String::new();
        hpgl(drawing, sheet(size, drawing)?, &mut out).map_err(|error| error.to_string())?;
        write_output(path, out)?;
    }
    if let Some(path) = &arguments.gcode {
        write_output(path, gcode_text(drawing, sheet(size, drawing)?, arguments.gcode_pen)?)?;
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
pub(super) fn sheet(size: &PictureSize, drawing: &Drawing) -> Result<Scale, String> {
    let mm_per_px = size.mm_per_px;
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

pub(super) fn points(drawing: &Drawing) -> Result<String, std::fmt::Error> {
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
