//! [`DrawingFile`]: a drawing in HPGL, G-code or the thesis' text, read operation by operation.

use plotter_motion::hpgl::thesis_text;
use plotter_motion::{PlotOp, gcode, hpgl};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// By so much of its beginning a drawing's language is known.
const HEAD_BYTES: u64 = 64 << 10;
/// What is held in memory of something that is no file (a pipe), bytes.
const MOST_HELD_BYTES: u64 = 256 << 20;
/// Encoder counts to the millimetre in the thesis' text, where no machine says otherwise.
pub(crate) const USUAL_COUNTS_PER_MM: f64 = 40.0;

/// What a drawing is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Language {
    Hpgl,
    Gcode,
    Thesis,
}

/// A drawing's file, of a known language.
#[derive(Debug)]
pub(crate) struct DrawingFile {
    path: PathBuf,
    language: Language,
    gcode: gcode::ReadOptions,
    /// All of it, if it can be read but once.
    held: Option<Arc<[u8]>>,
}

/// An operation, or what of the drawing could not be read.
pub(crate) type Item = Result<PlotOp, String>;

impl DrawingFile {
    /// Opens a drawing and finds out its language.
    ///
    /// # Errors
    ///
    /// The file, and why it cannot be read or is no drawing.
    pub(crate) fn open(path: &Path) -> Result<Self, String> {
        let refused = |error: std::io::Error| format!("{}: cannot be read: {error}", path.display());
        let file = File::open(path).map_err(refused)?;
        let kind = file.metadata().map_err(refused)?;
        if kind.is_dir() {
            return Err(format!("{}: this is a folder: name a drawing in it", path.display()));
        }
        let (mut head, mut held) = (Vec::new(), None);
        if kind.is_file() {
            file.take(HEAD_BYTES).read_to_end(&mut head).map_err(refused)?;
        } else {
            let mut all = Vec::new();
            file.take(MOST_HELD_BYTES + 1).read_to_end(&mut all).map_err(refused)?;
            if all.len() as u64 > MOST_HELD_BYTES {
                let most = MOST_HELD_BYTES >> 20;
                return Err(format!("{}: longer than {most} MiB: save it as a file first", path.display()));
            }
            head.extend(all.iter().take(usize::try_from(HEAD_BYTES).unwrap_or(usize::MAX)));
            held = Some(Arc::from(all));
        }
        let language = language(path, &head).map_err(|error| format!("{}: {error}", path.display()))?;
        let mut drawing =
            Self { path: path.to_owned(), language, gcode: gcode::ReadOptions::default(), held };
        if language == Language::Gcode {
            let bytes = drawing.bytes()?;
            drawing.gcode = gcode::Detection::from_bytes(bytes).options();
        }
        Ok(drawing)
    }

    /// Its operations, from the start; a file is read as they are asked for.
    ///
    /// # Errors
    ///
    /// The file cannot be opened any more.
    pub(crate) fn ops(&self, counts_per_mm: f64) -> Result<Box<dyn Iterator<Item = Item> + Send>, String> {
        let bytes = self.bytes()?;
        Ok(match self.language {
            Language::Hpgl => Box::new(hpgl::PlotOps::new(bytes).filter_map(|op| match op {
                Err(error) if error.is_notice() => None,
                op => Some(op.map_err(|error| error.to_string())),
            })),
            Language::Gcode => {
                Box::new(gcode::PlotOps::with_options(bytes, self.gcode).filter_map(|op| match op {
                    Err(error) if error.is_notice() => None,
                    op => Some(op.map_err(|error| error.to_string())),
                }))
            }
            Language::Thesis => Box::new(
                thesis_text::plot_ops(bytes, counts_per_mm).map(|op| op.map_err(|error| error.to_string())),
            ),
        })
    }

    fn bytes(&self) -> Result<Box<dyn Iterator<Item = u8> + Send>, String> {
        if let Some(held) = &self.held {
            let held = Arc::clone(held);
            return Ok(Box::new((0..held.len()).map_while(move |place| held.get(place).copied())));
        }
        let file = File::open(&self.path)
            .map_err(|error| format!("{}: cannot be read: {error}", self.path.display()))?;
        // A disk that fails in the middle ends the drawing there.
        Ok(Box::new(BufReader::new(file).bytes().map_while(Result::ok)))
    }
}

/// The language: by what a file contains, and by its name where that leaves it open.
fn language(path: &Path, head: &[u8]) -> Result<Language, String> {
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    if text.is_empty() {
        return Err(String::from("the file is empty"));
    }
    if text.starts_with(b"plotter-log ") {
        return Err(format!(
            "this is a recording, not a drawing: look at it with `{} render`",
            super::program()
        ));
    }
    if text.starts_with(&[0x1f, 0x8b]) {
        return Err(String::from("the file is packed: unpack it first (gunzip)"));
    }
    if text.starts_with(b"<") {
        return Err(String::from(
            "this looks like SVG or another XML file: convert it to HPGL or G-code first",
        ));
    }
    if thesis_text::read(text).take(16).any(|line| matches!(line, Ok(thesis_text::Line::Move(_)))) {
        return Ok(Language::Thesis);
    }
    let suffix = path.extension().and_then(|suffix| suffix.to_str()).unwrap_or_default().to_ascii_lowercase();
    let (hpgl, gcode) = (sense_in_hpgl(text), sense_in_gcode(text));
    match suffix.as_str() {
        "gcode" | "gco" | "g" | "nc" | "ngc" | "tap" | "cnc" => Ok(Language::Gcode),
        "hpgl" | "plt" | "hpg" | "hp" | "hgl" | "plo" | "pcl" => Ok(Language::Hpgl),
        _ if hpgl.max(gcode) <= 0.5 => Err(String::from(
            "this looks like none of HPGL, G-code and the thesis' text (`PU, 02993, 13955`)",
        )),
        _ if hpgl >= gcode => Ok(Language::Hpgl),
        _ => Ok(Language::Gcode),
    }
}

fn share(good: u32, bad: u32) -> f64 {
    f64::from(good) / f64::from(good.saturating_add(bad).max(1))
}

/// Share of the commands that HPGL knows.
fn sense_in_hpgl(text: &[u8]) -> f64 {
    let mut reader = hpgl::Reader::new();
    let (mut good, mut bad) = (0_u32, 0_u32);
    for &byte in text {
        match reader.push(byte) {
            Some(Ok(hpgl::Event::Command { command, .. })) if command.meaning().is_some() => good += 1,
            Some(Ok(hpgl::Event::Command { .. }) | Err(_)) => bad += 1,
            _ => {}
        }
    }
    share(good, bad)
}

/// Share of the lines that G-code knows.
fn sense_in_gcode(text: &[u8]) -> f64 {
    let mut reader = gcode::Reader::new();
    let (mut good, mut bad) = (0_u32, 0_u32);
    for &byte in text {
        match reader.push(byte) {
            Some(Ok(block)) if !block.words().is_empty() => good += 1,
            Some(Err(_)) => bad += 1,
            _ => {}
        }
    }
    share(good, bad)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Vec<Item> {
        let held = Some(Arc::from(text));
        let language = language(Path::new("drawing"), text).unwrap();
        let file = DrawingFile { path: PathBuf::new(), language, gcode: gcode::ReadOptions::default(), held };
        file.ops(USUAL_COUNTS_PER_MM).unwrap().collect()
    }

    #[test]
    fn the_same_line_in_three_languages() {
        let texts: [&[u8]; 3] =
            [b"IN;PU400,0;PD800,400;", b"PU, 00400, 00000\nPD, 00800, 00400", b"G0 X10 Y0\nG1 X20 Y10\n"];
        for text in texts {
            let places: Vec<_> = read(text).into_iter().filter_map(|op| op.unwrap().target()).collect();
            assert_eq!(places.len(), 2);
            assert!((places[0].x - 10.0).abs() < 1e-5 && (places[1].y - 10.0).abs() < 1e-5, "{places:?}");
        }
    }

    #[test]
    fn what_is_no_drawing_is_named() {
        let refused = |text: &[u8]| language(Path::new("drawing"), text).unwrap_err();
        assert!(refused(b"plotter-log 1 {}\n").contains("a recording, not a drawing"));
        assert!(refused(b"  ").contains("empty"));
        assert!(refused(b"\x1f\x8b\x08").contains("packed"));
        assert!(refused(b"<svg/>").contains("SVG"));
        assert!(refused(b"Once upon a time there was a plotter.\nIt drew.").contains("none of"));
    }
}
