//! Detects the tool that wrote a file by its first lines.

use super::Tool;

/// The tool that wrote a file, from its beginning (a few kilobytes); `None` if none of those known here did.
/// Bare bytes look like nothing, so [`Tool::Raw`] is never found.
///
/// ```
/// # use plotter_replay::import::{Tool, detect};
/// assert_eq!(detect(b"> 2026/01/15 10:00:00.000352  length=10 from=0 to=9\n"), Some(Tool::Socat));
/// assert_eq!(detect(b"109-189 uart-1: 02\n"), Some(Tool::Sigrok));
/// assert_eq!(detect(b"IN;SP1;PU0,0;"), None);
/// ```
#[must_use]
pub fn detect(beginning: &[u8]) -> Option<Tool> {
    let text = String::from_utf8_lossy(beginning);
    // The beginning of a recording is often lost; its lines are all alike.
    text.trim_start_matches('\u{feff}').lines().take(64).find_map(|line| of_line(line.trim_end_matches('\r')))
}

fn of_line(line: &str) -> Option<Tool> {
    let mut words = line.split(' ');
    let (first, second) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
    // The digits of a text as 9, so that `2026/01/15` is `9999/99/99`.
    let shape =
        |text: &str| -> String { text.chars().map(|c| if c.is_ascii_digit() { '9' } else { c }).collect() };
    if line.starts_with("# plotter-raw/") {
        return Some(Tool::PlotterRaw);
    }
    if matches!(first, ">" | "<") && shape(second) == "9999/99/99" {
        return Some(Tool::Socat);
    }
    if shape(first) == "9999-99-99" && shape(second).starts_with("99:99:99.9") && second.ends_with(':') {
        return Some(Tool::Jpnevulator);
    }
    let time_ends = line.find(')').filter(|&end| end < 40 && line.starts_with('('));
    if time_ends.is_some_and(|end| line.get(1..end).is_some_and(|time| shape(time).contains("9.9"))) {
        return Some(Tool::Candump);
    }
    let lower = line.to_ascii_lowercase();
    if lower.starts_with("time [s],") && lower.contains("value")
        || lower.contains("start_time") && lower.contains("data")
    {
        return Some(Tool::Saleae);
    }
    if line
        .split_once(": ")
        .is_some_and(|(before, _)| before.rsplit(' ').next().is_some_and(|d| d.starts_with("uart-")))
    {
        return Some(Tool::Sigrok);
    }
    let mut cells = line.split(',');
    let is_number =
        cells.next().is_some_and(|cell| !cell.is_empty() && cell.bytes().all(|b| b.is_ascii_digit()));
    (is_number && matches!(cells.next(), Some("H" | "D"))).then_some(Tool::PlotterRaw)
}
