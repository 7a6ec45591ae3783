//! [`Language`]: what a drawing's file is written in, told by its contents or its name.

use clap::ValueEnum;
use plotter_motion::hpgl::cutter::Dialect;
use plotter_motion::{gcode, hpgl};
use serde::Serialize;
use std::path::Path;

/// The language of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Language {
    /// HPGL and HP-GL/2
    Hpgl,
    /// One pen movement a line, in encoder counts: `PU, 02993, 13955`
    Thesis,
    /// G-code of pen plotters and lasers
    Gcode,
    /// Strokes of an SVG picture
    Svg,
    /// Roland's CAMM-GL mode 1 and DXY-GL, one letter a command; it is read, not written
    CammGl,
    /// Graphtec's GP-GL, also Silhouette's; it is read, not written
    GpGl,
    /// DXF of CAD programs, as text; it is read, not written
    Dxf,
}

impl Language {
    /// Its name, as options have it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Hpgl => "hpgl",
            Self::Thesis => "thesis",
            Self::Gcode => "gcode",
            Self::Svg => "svg",
            Self::CammGl => "camm-gl",
            Self::GpGl => "gp-gl",
            Self::Dxf => "dxf",
        }
    }

    /// The language that a file's name asks for.
    #[must_use]
    pub fn of_name(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?.to_ascii_lowercase();
        match suffix.as_str() {
            "hpgl" | "plt" | "hpg" | "hp" | "hgl" | "plo" | "pcl" => Some(Self::Hpgl),
            "gcode" | "gco" | "g" | "nc" | "ngc" | "tap" | "cnc" => Some(Self::Gcode),
            "svg" => Some(Self::Svg),
            "dxf" => Some(Self::Dxf),
            "gpgl" => Some(Self::GpGl),
            "camm" | "dxy" => Some(Self::CammGl),
            "txt" => Some(Self::Thesis),
            _ => None,
        }
    }

    /// How much of a text makes sense in this language, 0 to 1, where that is counted.
    pub(crate) fn sense_of(self, head: &[u8]) -> Option<f64> {
        match self {
            Self::Hpgl => Some(sense_in_hpgl(head)),
            Self::Gcode => Some(sense_in_gcode(head)),
            Self::Thesis | Self::Svg | Self::CammGl | Self::GpGl | Self::Dxf => None,
        }
    }

    /// The language of a text that begins with `head`: the one in which more of it makes sense than not.
    #[must_use]
    pub fn of_contents(head: &[u8]) -> Option<Self> {
        if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
            // UTF-16: of these languages only SVG is ever written so.
            let letters: Vec<u8> = head.iter().skip(2).copied().filter(|byte| *byte != 0).collect();
            return (letters.trim_ascii_start().starts_with(b"<") && contains(&letters, b"<svg"))
                .then_some(Self::Svg);
        }
        let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        if head.trim_ascii_start().starts_with(b"<") {
            return contains(head, b"<svg").then_some(Self::Svg);
        }
        if is_dxf(head) {
            return Some(Self::Dxf);
        }
        if head.split(|byte| *byte == b'\n').take(MOST_HEADERS).any(is_pen_movement) {
            return Some(Self::Thesis);
        }
        let (hpgl, gcode) = (sense_in_hpgl(head), sense_in_gcode(head));
        let best = if hpgl >= gcode { (hpgl, Self::Hpgl) } else { (gcode, Self::Gcode) };
        if let Some((dialect, sense)) = Dialect::detect(head)
            && sense > best.0
        {
            return Some(if dialect == Dialect::CammGl { Self::CammGl } else { Self::GpGl });
        }
        (best.0 > LEAST_SENSE).then_some(best.1)
    }
}

/// Whether a text begins as DM/PL does, Houston Instrument's language: `;:`, with which a program takes hold
/// of the plotter.
#[must_use]
pub(crate) fn is_dm_pl(head: &[u8]) -> bool {
    let mut signs = head.iter().filter(|byte| !byte.is_ascii_whitespace() && !byte.is_ascii_control());
    signs.next() == Some(&b';') && signs.next() == Some(&b':')
}

/// Whether a text begins as DXF does: a section, or comments (999) before it. What DXF is in other forms
/// counts too, so that it can be refused by name.
fn is_dxf(head: &[u8]) -> bool {
    if head.starts_with(b"AutoCAD Binary DXF") {
        return true;
    }
    let mut lines = head
        .split(|byte| matches!(byte, b'\n' | b'\r'))
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty());
    while let Some(code) = lines.next() {
        match (code, lines.next()) {
            (b"999", Some(_)) => {}
            (b"0", Some(b"SECTION")) => return true,
            _ => return false,
        }
    }
    false
}

/// Lines that may stand before the first movement.
const MOST_HEADERS: usize = 16;

/// Less than this share of what makes sense is chance: of two letters, every seventh pair is a command of
/// HPGL.
const LEAST_SENSE: f64 = 0.5;

fn contains(text: &[u8], word: &[u8]) -> bool {
    text.windows(word.len()).any(|window| window == word)
}

/// `PU, 02993, 13955`: the comma after the command and the lack of a `;` tell it from HPGL.
fn is_pen_movement(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let mut words = line.split(|byte| *byte == b',');
    let command = words.next().unwrap_or_default().trim_ascii();
    let is_number = |word: &[u8]| {
        let word = word.trim_ascii();
        !word.is_empty() && word.iter().all(u8::is_ascii_digit)
    };
    (command.eq_ignore_ascii_case(b"PU") || command.eq_ignore_ascii_case(b"PD"))
        && words.next().is_some_and(is_number)
        && words.next().is_some_and(is_number)
        && words.next().is_none()
}

fn share(good: u32, bad: u32) -> f64 {
    f64::from(good) / f64::from((good + bad).max(1))
}

/// Share of the commands that HPGL knows.
fn sense_in_hpgl(text: &[u8]) -> f64 {
    let mut reader = hpgl::Reader::new();
    let (mut good, mut bad) = (0, 0);
    for byte in text {
        match reader.push(*byte) {
            Some(Ok(hpgl::Event::Command { command, .. })) if command.meaning().is_some() => good += 1,
            Some(Ok(hpgl::Event::Command { .. }) | Err(_)) => bad += 1,
            _ => {}
        }
    }
    share(good, bad)
}

/// Share of the lines that G-code knows. Commands by their names say nothing: other languages have words,
/// too.
fn sense_in_gcode(text: &[u8]) -> f64 {
    let plain = |line: &&[u8]| {
        let is_reckoned = line.iter().any(|byte| matches!(byte, b'#' | b'['));
        !gcode::is_named(line) && !is_reckoned
    };
    let (mut reader, mut interpreter) = (gcode::Reader::new(), gcode::Interpreter::new());
    let (mut good, mut bad) = (0, 0);
    for byte in text.split_inclusive(|byte| matches!(byte, b'\n' | b'\r')).filter(plain).flatten() {
        let Some(block) = reader.push(*byte) else { continue };
        let lines = u32::from(block.as_ref().is_ok_and(|block| !block.words().is_empty()));
        if interpreter.push(block).is_err() {
            break;
        }
        let mut wrong = 0;
        while let Some(outcome) = interpreter.next_op() {
            wrong |= u32::from(outcome.is_err_and(|error| !error.is_notice()));
        }
        bad += wrong;
        good += lines.saturating_sub(wrong);
    }
    share(good, bad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_language_is_told_by_its_contents() {
        let told = |text: &[u8]| Language::of_contents(text);
        assert_eq!(told(b"IN;SP1;PU400,400;PD800,400;"), Some(Language::Hpgl));
        assert_eq!(told(b"\x1b.Y\x1b.I81;;17:IN\nPA1 2 PD;"), Some(Language::Hpgl));
        assert_eq!(told(b"G21\nG0 X10 Y10 (go)\nM3 S90\n"), Some(Language::Gcode));
        assert_eq!(
            told(b"START_PLOT PEN=1\nG28\nG90\nPEN_UP\nG1 X10 Y10\nPEN_DOWN\nG1 X4\n"),
            Some(Language::Gcode)
        );
        assert_eq!(told(b"#1=10\nG0 X[#1*2]\nM3\nG1 X4\n"), Some(Language::Gcode));
        assert_eq!(told(b"; made by hand\ng0x1y2\n"), Some(Language::Gcode));
        assert_eq!(told(b"H\nJ1\nM400,400\nD800,400,800,800\nI-400,-400\n"), Some(Language::CammGl));
        assert_eq!(told(b"H\x03M100,100\x03D200,100\x03"), Some(Language::GpGl));
        assert_eq!(told(b"\x1b\x04FX10,1\x03M100,100\x03D200,100\x03"), Some(Language::GpGl));
        assert_eq!(told(b"Command, X, Y\r\nPU, 02993, 13955\r\n"), Some(Language::Thesis));
        assert_eq!(told(b"\xef\xbb\xbf <?xml version='1.0'?>\n<svg/>"), Some(Language::Svg));
        assert_eq!(told(b"\xff\xfe<\0s\0v\0g\0/\0>\0"), Some(Language::Svg));
        assert_eq!(told(b"  0\r\nSECTION\r\n  2\r\nENTITIES\r\n"), Some(Language::Dxf));
        assert_eq!(told(b"999\nby hand\n0\nSECTION\n"), Some(Language::Dxf));
        for junk in
            [&b"Once upon a time there was a plotter.\nIt drew."[..], b"\x7fELF\x02\x01\x01", b"{}", b""]
        {
            assert_eq!(told(junk), None, "{junk:?}");
        }
    }

    #[test]
    fn names_count_without_case() {
        assert_eq!(Language::of_name(Path::new("a/b.PLT")), Some(Language::Hpgl));
        assert_eq!(Language::of_name(Path::new("b.nc")), Some(Language::Gcode));
        assert_eq!(Language::of_name(Path::new("b")), None);
    }
}
