//! The settings of a trace, from its options and the machine's file.

use super::command::{Choice, ModeChoice, OrderChoice, PreferChoice, RulingChoice, TraceCommand};
use crate::shared::{PictureSize, at, read_file};
use plotter_motion::Machine;
use plotter_vector::{
    Mode, Palette, Prefer, Vectorizer,
    ink::{MAX_PENS, Pens, ThresholdMethodError},
    order::OrderEffort,
    stroke::Pieces,
    trace::{PensChoice, VectorizeConfig},
};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Greatest errors that may be asked for, px: those of the machine's file.
const MAX_ERRORS_PX: RangeInclusive<f64> = 0.01..=100.0;

/// Widest pen that may be asked for, mm: that of the machine's file.
const MAX_PEN_MM: f64 = 100.0;

/// Most threads that are started.
const MAX_THREADS: usize = 1024;

/// What the options and the machine's file ask for, once the picture's size is known.
#[derive(Debug)]
pub(super) struct Settings {
    pub(super) vectorizer: Vectorizer,
    /// By colour; without, one pen draws all ink.
    pub(super) pens: Option<Pens>,
    pub(super) threads: Option<rayon::ThreadPool>,
    pub(super) overlay: Option<PathBuf>,
    pub(super) size: PictureSize,
    /// Of the file that is traced.
    pub(super) page: u32,
}

/// The same before anything is known of the picture: what is in mm waits.
#[derive(Debug)]
pub(super) struct Unscaled {
    vectorizer: Vectorizer,
    config: VectorizeConfig,
    pub(super) pens: Option<Pens>,
    threads: Option<rayon::ThreadPool>,
    pub(super) overlay: Option<PathBuf>,
    gap_mm: Option<f64>,
    min_stroke_mm: f64,
    keep_pale: bool,
}

impl Unscaled {
    /// For a picture of that size, on that page of its file.
    pub(super) fn in_size(self, size: PictureSize, page: u32) -> Result<Settings, String> {
        let Self { mut vectorizer, config, pens, threads, overlay, gap_mm, min_stroke_mm, keep_pale } = self;
        vectorizer.threshold.keep_pale = keep_pale;
        if let Some(ours) = vectorizer.ours_mut() {
            ours.gap_px = gap_mm.map(|gap_mm| gap_mm / size.mm_per_px);
            ours.min_stroke_px = min_stroke_mm / size.mm_per_px;
            ours.areas = config.ours(size.mm_per_px).map_err(|error| error.to_string())?.areas;
        }
        Ok(Settings { vectorizer, pens, threads, overlay, size, page })
    }
}

/// The machine's file, then the options: what they say wins.
pub(super) fn settings(arguments: &TraceCommand) -> Result<Unscaled, String> {
    let mut config = match &arguments.config {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?)
                .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
            Machine::from_toml_with(&text).map_err(|error| at(path, &error))?.1
        }
        None => VectorizeConfig::default(),
    };
    arguments.size.check()?;
    for (option, given) in [("--gap", arguments.gap), ("--min-stroke", arguments.min_stroke)] {
        if let Some(bad) = given.filter(|mm| !(*mm >= 0.0 && mm.is_finite())) {
            return Err(format!(
                "{option}: {bad} mm is no distance; give some tenths, as 0.5, or 0 for none"
            ));
        }
    }
    let (gap_mm, min_stroke_mm) = (arguments.gap, arguments.min_stroke.unwrap_or(0.0));
    let keep_pale = arguments.ruling == Some(RulingChoice::Keep);
    if let Some(text) = &arguments.threshold {
        config.threshold = text.parse().map_err(|error: ThresholdMethodError| format!("--{error}"))?;
    }
    let in_file = Some(i64::from(config.threads)).filter(|number| *number > 0);
    let threads = arguments.threads.or(in_file).map(threads).transpose()?;
    let in_file =
        Some(config.overlay).filter(|path| !path.is_none()).map(|path| PathBuf::from(path.as_str()));
    let overlay = arguments.overlay.clone().or(in_file);
    if matches!(arguments.algorithm, Choice::Published) {
        refuse_ours(arguments)?;
        let vectorizer = Vectorizer::published().with_threshold(config.threshold());
        return Ok(Unscaled {
            vectorizer,
            config,
            pens: None,
            threads,
            overlay,
            gap_mm,
            min_stroke_mm,
            keep_pale,
        });
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
    if arguments.arcs {
        config.pieces = Pieces::Arcs;
    } else if arguments.curves {
        config.pieces = Pieces::Cubics;
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
                config.mode = Mode::Mixed;
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
        Some(ModeChoice::Centreline) => config.mode = Mode::Centreline,
        Some(ModeChoice::Outline) => config.mode = Mode::Outline,
        Some(ModeChoice::Mixed) => config.mode = Mode::Mixed,
        None => {}
    }
    match arguments.order {
        Some(OrderChoice::None) => config.order = OrderEffort::None,
        Some(OrderChoice::Fast) => config.order = OrderEffort::Fast,
        Some(OrderChoice::Best) => config.order = OrderEffort::Best,
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
    let pens = pens(arguments, config.pens)?;
    let prefer = match arguments.prefer {
        Some(PreferChoice::Strokes) => Prefer::Strokes,
        Some(PreferChoice::Both) | None => Prefer::Both,
        Some(PreferChoice::Ink) => Prefer::Ink,
    };
    // What is in mm waits for the picture's size.
    let mut unscaled = config;
    (unscaled.hatch_mm, unscaled.pen_mm) = (0.0, 0.0);
    let ours = unscaled.ours(1.0).map_err(|error| error.to_string())?.with_prefer(prefer);
    let vectorizer = Vectorizer::from(ours).with_threshold(config.threshold());
    Ok(Unscaled { vectorizer, config, pens, threads, overlay, gap_mm, min_stroke_mm, keep_pale })
}

/// Refuses options that the published algorithm does not have.
fn refuse_ours(arguments: &TraceCommand) -> Result<(), String> {
    let given = [
        ("--max-error-px", "has no error bound", arguments.max_error_px.is_some()),
        ("--arcs", "draws straight lines", arguments.arcs),
        ("--curves", "draws straight lines", arguments.curves),
        ("--prefer", "adds no strokes", arguments.prefer.is_some()),
        ("--mode", "always follows the middle of lines", arguments.mode.is_some()),
        ("--pens", "draws with one pen", arguments.pens.is_some()),
        ("--gap", "joins no strokes", arguments.gap.is_some()),
        ("--min-stroke", "leaves out none", arguments.min_stroke.is_some()),
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
pub(super) fn pens(arguments: &TraceCommand, in_file: PensChoice) -> Result<Option<Pens>, String> {
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
    // What the machine's file says of the threshold rests when pens are asked for; the option would go
    // unheard.
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

pub(super) fn palette(asked: &str, path: &Path) -> Result<Palette, String> {
    let bytes = read_file(path)
        .map_err(|error| format!("{asked}: {error}; give 1 to {MAX_PENS}, auto, or a palette's TOML file"))?;
    let text =
        String::from_utf8(bytes).map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
    Palette::from_toml(&text).map_err(|error| at(path, &error))
}

pub(super) fn threads(given: i64) -> Result<rayon::ThreadPool, String> {
    let number = usize::try_from(given).ok().filter(|number| (1..=MAX_THREADS).contains(number));
    let number = number.ok_or_else(|| {
        format!("--threads: {given} lies outside 1..={MAX_THREADS}; leave it out for one a core")
    })?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number).build();
    pool.map_err(|error| format!("--threads: {number} cannot be started: {error}; take fewer"))
}
