//! A picture as strokes: by rows, or whole where pens are told apart.

use super::command::{FLAG, TraceCommand};
use super::settings::Settings;
use crate::shared::{Paper, WorkShown, is_standard, read_file, read_input, told_ink};
use crate::trace::{Interrupt, overlay_step};
use plotter_vector::{
    Colour, DecodeError, Drawing, FileRows, Gray, Palette, Pixel, Progress, Rgb,
    ink::{Despeckled, Pens, Unassigned, pen_width_px},
    picture::{FileNotes, Row, RowSource as _, decode_page_in_colour},
    trace::{Doubt, SheetErrors},
};
use std::borrow::Cow;
use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Parts of the work that are told apart: hundredths.
const STEPS: f64 = 100.0;

/// What the overlay shows below the strokes.
#[derive(Debug)]
pub(super) enum Picture {
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
    pub(super) fn level(&self, at: Pixel) -> [u8; 3] {
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
pub(super) struct Traced {
    pub(super) drawing: Drawing,
    pub(super) errors: Option<SheetErrors>,
    /// What was taken for dirt.
    pub(super) removed: Despeckled,
    /// Specks that were left out before, of a picture that no single level tells.
    pub(super) left_out: usize,
    pub(super) palette: Palette,
    /// Width of the lines, px; unknown where pens were told apart, and without lines.
    pub(super) pen_px: Option<u32>,
    /// The same of the widest pen's, also where pens were told apart.
    pub(super) widest_px: Option<u32>,
    /// For the overlay, where one is asked for.
    pub(super) picture: Option<Picture>,
    pub(super) time: Duration,
    /// What the file says of itself.
    pub(super) notes: FileNotes,
    /// Why it may be no drawing.
    pub(super) doubt: Option<Doubt>,
    /// Whether no single level told it.
    pub(super) is_uneven: bool,
    /// How the ink was told from the paper, in words.
    pub(super) ink: Vec<(&'static str, String)>,
    /// Ink that none of several pens got.
    pub(super) unassigned: Option<Unassigned>,
    /// The sheet that was straightened, of which all of this is.
    pub(super) paper: Option<Paper>,
}

impl Traced {
    /// Says which sheet it was that was traced, and of which file.
    pub(super) fn straightened(&mut self, paper: &Paper, notes: FileNotes) {
        let mut told = paper.told();
        told.extend(paper.told_ends(&self.drawing, self.widest_px));
        told.append(&mut self.ink);
        (self.ink, self.notes, self.paper) = (told, notes, Some(paper.clone()));
    }
}

/// The picture's file: one that can be read as often as it takes, or the bytes of what cannot, as a pipe.
#[derive(Debug)]
pub(super) enum Input {
    File(PathBuf),
    Bytes(Cow<'static, [u8]>),
}

impl Input {
    /// The file, the standard input, or the picture that is taken where none is given.
    pub(super) fn open(path: Option<&Path>) -> Result<Self, String> {
        Ok(match path {
            None => Self::Bytes(FLAG.into()),
            Some(path) if is_standard(path) => {
                Self::Bytes(read_input().map_err(|error| format!("standard input: {error}"))?.into())
            }
            Some(path) if path.is_file() => Self::File(path.into()),
            Some(path) => Self::Bytes(read_file(path)?.into()),
        })
    }

    /// What it says of itself.
    pub(super) fn notes(&self, page: u32) -> Result<FileNotes, String> {
        let notes = match self {
            Self::File(path) => {
                let file = File::open(path).map_err(|error| format!("cannot be read: {error}"))?;
                FileNotes::read(file, page)
            }
            Self::Bytes(bytes) => FileNotes::read(Cursor::new(bytes), page),
        };
        notes.map_err(|error| error.to_string())
    }

    /// Its levels, whole.
    pub(super) fn gray(&self, page: u32) -> Result<Gray, String> {
        let bytes = self.bytes()?;
        let scan = FileRows::of_page(Cursor::new(&*bytes), page);
        scan.and_then(FileRows::into_gray).map_err(|error| error.to_string())
    }

    /// The whole file.
    pub(super) fn bytes(&self) -> Result<Cow<'_, [u8]>, String> {
        match self {
            Self::File(path) => read_file(path).map(Cow::Owned),
            Self::Bytes(bytes) => Ok(Cow::Borrowed(bytes)),
        }
    }
}

/// One pen, told by grey level: the file is read by rows, as often as it takes.
pub(super) fn by_rows<R: Read + Seek>(
    settings: &Settings,
    file: R,
    arguments: &TraceCommand,
    interrupt: Interrupt,
) -> Result<Traced, String> {
    let start = Instant::now();
    let mut scan = FileRows::of_page(file, settings.page).map_err(|error| error.to_string())?;
    let bar = progress(arguments);
    let mut report = |done: f64| {
        bar.set(steps(done));
        go_on(interrupt)
    };
    let (vectorizer, mut progress) = (&settings.vectorizer, Progress::new(&mut report));
    let sheet = if arguments.no_errors {
        vectorizer.vectorize_rows(&mut scan, &mut progress)
    } else {
        vectorizer.vectorize_rows_with_errors(&mut scan, &mut progress)
    };
    bar.finish();
    let sheet = sheet.map_err(|error| error.to_string())?;
    let time = start.elapsed();
    let picture = settings.overlay.as_ref().map(|_| thumbnail(&mut scan)).transpose()?;
    Ok(Traced {
        drawing: sheet.drawing,
        errors: sheet.errors,
        removed: sheet.removed,
        left_out: sheet.look.map_or(0, |look| look.left_out),
        doubt: sheet.doubt,
        palette: Palette::default(),
        pen_px: sheet.pen_px,
        is_uneven: sheet.look.is_some(),
        ink: told_ink(sheet.look, sheet.split),
        widest_px: sheet.pen_px,
        picture,
        time,
        notes: scan.notes().clone(),
        unassigned: None,
        paper: None,
    })
}

/// That the ruling of paper was left out.
fn told_ruling(ruling: Option<Rgb>) -> Vec<(&'static str, String)> {
    let told =
        |colour: Rgb| ("ruling", format!("left out: {colour} all over the sheet; --ruling keep draws it"));
    ruling.map(told).into_iter().collect()
}

fn go_on(interrupt: Interrupt) -> ControlFlow<()> {
    if interrupt.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

fn progress(arguments: &TraceCommand) -> WorkShown {
    WorkShown::of(arguments.telling, "tracing", steps(1.0), "%")
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a hundred")]
pub(super) fn steps(share: f64) -> u64 {
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
pub(super) fn in_colour(
    settings: &Settings,
    pens: &Pens,
    input: &Input,
    arguments: &TraceCommand,
    interrupt: Interrupt,
) -> Result<Traced, String> {
    let read = input.bytes()?;
    let (colour, notes) = decode_page_in_colour(&read, settings.page).map_err(|error| match error {
        DecodeError::TooLarge(_) | DecodeError::TooMuchMemory { .. } => format!(
            "--pens: colours are told apart on the whole picture, but {error}; or take --pens 1, which is traced by \
             rows at any size"
        ),
        other => other.to_string(),
    })?;
    drop(read);
    let start = Instant::now();
    let bar = progress(arguments);
    let mut report = |done: f64| {
        bar.set(steps(done));
        go_on(interrupt)
    };
    let found =
        settings.vectorizer.vectorize_colour_with_progress(&colour, pens, &mut Progress::new(&mut report));
    bar.finish();
    let found = found.map_err(|error| error.to_string())?;
    let time = start.elapsed();
    let drawing = found.traced.drawing;
    let errors = (!arguments.no_errors).then_some(SheetErrors {
        report: found.traced.error,
        worst: found.worst,
        beyond: found.traced.beyond,
        bare: found.traced.bare,
        insides: found.traced.insides,
    });
    let picture = settings.overlay.is_some().then_some(Picture::Colour(colour));
    let widest_px = found.inks.iter().filter_map(pen_width_px).max();
    let (removed, doubt) = (found.traced.removed, found.traced.doubt);
    Ok(Traced {
        errors,
        removed,
        left_out: 0,
        doubt,
        palette: found.palette,
        pen_px: None,
        widest_px,
        picture,
        time,
        notes,
        is_uneven: false,
        ink: told_ruling(found.ruling),
        unassigned: found.unassigned,
        paper: None,
        drawing,
    })
}
