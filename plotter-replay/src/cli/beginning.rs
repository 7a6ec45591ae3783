//! Start position and pen of a log, looked up before it is drawn.

use super::commands::open;
use crate::log::{Event, Header};
use crate::virtual_plotter::CountedBy;
use crate::{PlotterSettings, VirtualPlotter};
use plotter_motion::gcode::Detection;
use plotter_motion::{Point, StepPoint};
use std::path::Path;

/// By so much of what the host sent it is found out how the pen is lifted, bytes.
const MOST_TEXT: usize = 64 << 10;
/// Records after which no beginning is looked for any more.
const MOST_RECORDS: usize = 1_000_000;
/// Pulses that may be missing before the first target that is reached: more than a bad line loses of one way.
/// With more, the machine stood elsewhere when the log began.
const MOST_LOST: u32 = 16;

/// How a log is drawn, and what was found out for that.
#[derive(Clone, Debug)]
pub(crate) struct Beginning {
    pub(crate) settings: PlotterSettings,
    /// Where it begins, in words, if that is not the origin of the counts.
    pub(crate) words: Option<String>,
}

/// A place on a command line: two numbers, mm.
pub(crate) fn place(text: &str) -> Result<Point, String> {
    let expected = || format!("expected two numbers of mm within 100000 as 12.5,40, found {text:?}");
    let (x, y) = text.split_once(',').ok_or_else(expected)?;
    let number =
        |text: &str| text.trim().parse().ok().filter(|mm: &f64| mm.abs() <= 1e5).ok_or_else(expected);
    Ok(Point::new(number(x)?, number(y)?))
}

/// Looks at the beginning of a log. Its pen is at `origin` there, if that is said.
///
/// # Errors
///
/// The log cannot be read, or its header makes no sense.
pub(crate) fn beginning(path: &Path, origin: Option<Point>) -> Result<Beginning, String> {
    let header = open(path)?.header().clone();
    let mut settings =
        PlotterSettings::from_header(&header).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut words = origin.map(|at| format!("begins at ({:.3}, {:.3}) mm, as is said", at.x, at.y));
    settings.begins_at = origin;
    match settings.counted_by {
        CountedBy::Grbl | CountedBy::Marlin if header.text("controller").is_none() => {
            settings.pen = Detection::from_bytes(sent_text(path)?).options().pen;
        }
        CountedBy::Answers if origin.is_none() => {
            if let Some(at) = first_place(path, &header, settings)? {
                settings.begins_at = Some(at);
                words = Some(format!(
                    "begins at ({:.3}, {:.3}) mm: the first target that is reached tells",
                    at.x, at.y
                ));
            }
        }
        _ => {}
    }
    Ok(Beginning { settings, words })
}

/// The host's lines without what is no G-code.
fn sent_text(path: &Path) -> Result<Vec<u8>, String> {
    let mut text = Vec::new();
    for record in open(path)?.filter_map(Result::ok).take(MOST_RECORDS) {
        if let Event::Host(bytes) = record.event {
            text.extend(bytes.into_iter().filter(|byte| byte.is_ascii() && !b"?!~\x18".contains(byte)));
        }
        if text.len() > MOST_TEXT {
            break;
        }
    }
    let lines = text.split(|&byte| byte == b'\n').filter(|line| line.first() != Some(&b'$'));
    Ok(lines.collect::<Vec<_>>().join(&b'\n'))
}

/// Where a machine of digits stood when the log began, if its first target tells that it was elsewhere.
fn first_place(path: &Path, header: &Header, settings: PlotterSettings) -> Result<Option<Point>, String> {
    if header.text("protocol") == Some("messages") {
        return Ok(None);
    }
    let mut plotter = VirtualPlotter::new(settings);
    for record in open(path)?.filter_map(Result::ok).take(MOST_RECORDS) {
        plotter.push(&record);
        if plotter.is_linked() {
            return Ok(None);
        }
        if let Some(reached) = plotter.reached().next() {
            let StepPoint { x, y } = reached.error;
            let is_elsewhere = x.unsigned_abs().max(y.unsigned_abs()) > MOST_LOST;
            // Beyond what digits can say the beginning was misread, not the place.
            let at = StepPoint::new(x.saturating_neg(), y.saturating_neg());
            let is_place = x <= 0 && y <= 0;
            return Ok((is_elsewhere && is_place).then(|| settings.to_sheet(at)));
        }
    }
    Ok(None)
}
