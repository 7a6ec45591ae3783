//! Figures that READMEs quote, and the rows that they are taken from.
//!
//! A README says below a table or a paragraph, in a comment that no reader sees, what it took from where:
//!
//! ```text
//! <!-- figures from results
//! eight lines of 60 mm :: 0.0422 0.00005 :: line-control/both :: rms over all lines
//! its time :: 25.9=25.87 :: stepper-motion/drawings :: **exact**
//! -->
//! ```
//!
//! with what the row or the paragraph has in its text, the figures, the table, and what its row is of. A figure
//! that is rounded or has another unit has the data's behind `=`.

use std::fs;
use std::io;
use std::path::Path;

use crate::data::Topic;

const BEGINS: &str = "<!-- figures from results";

/// Papers that quote.
const PAPERS: [&str; 7] = [
    "README.md",
    "examples/README.md",
    "plotter-hal/README.md",
    "plotter-motion/README.md",
    "plotter-replay/README.md",
    "plotter-stitch/README.md",
    "plotter-vector/README.md",
];

/// What quoted figures differ from the data.
pub(crate) fn problems(root: &Path, topics: &[Topic]) -> io::Result<Vec<String>> {
    let mut problems = Vec::new();
    for paper in PAPERS {
        problems.extend(of(paper, &fs::read_to_string(root.join(paper))?, topics));
    }
    Ok(problems)
}

fn of(paper: &str, text: &str, topics: &[Topic]) -> Vec<String> {
    let lines: Vec<&str> = text.lines().collect();
    let (mut problems, mut inside) = (Vec::new(), false);
    for (number, line) in lines.iter().enumerate() {
        if line.starts_with(BEGINS) {
            inside = true;
        } else if *line == "-->" {
            inside = false;
        } else if inside && let Err(problem) = compare(&lines, line, topics) {
            problems.push(format!("{paper}:{}: {problem}", number + 1));
        }
    }
    problems
}

fn compare(lines: &[&str], mark: &str, topics: &[Topic]) -> Result<(), String> {
    let fields: Vec<&str> = mark.split(" :: ").collect();
    let [place, figures, table, label] = fields[..] else {
        return Err("a mark is: PLACE :: FIGURES :: TOPIC/TABLE :: ROW".to_owned());
    };
    let shown = shown_at(lines, place).ok_or_else(|| format!("nothing here says: {place}"))?;
    let (topic, name) = table.split_once('/').unwrap_or((table, ""));
    let table = topics
        .iter()
        .filter(|known| known.name == topic)
        .flat_map(Topic::tables)
        .find(|known| known.name == name)
        .ok_or_else(|| format!("results/{topic}.toml has no table {name}"))?;
    let labels = table.labels();
    let row = labels
        .iter()
        .position(|known| known == label)
        .ok_or_else(|| format!("table {topic}/{name} has no row of: {label}"))?;
    let data = numbers(&table.rows[row].cells.join(" "));
    for figure in figures.split_whitespace() {
        let (said, written) = figure.split_once('=').unwrap_or((figure, figure));
        if !shown.iter().any(|number| number == said) {
            return Err(format!("\"{place}\" says {}, not {said}", shown.join(" ")));
        }
        if !data.iter().any(|number| number == written) {
            return Err(format!("{topic}/{name}, {label}: has {}, not {written}", data.join(" ")));
        }
        if !rounded(said, written) {
            return Err(format!("{said} is not {written} rounded, or with another unit"));
        }
    }
    Ok(())
}

/// The numbers of the row, or of the paragraph, in which these words are.
fn shown_at(lines: &[&str], place: &str) -> Option<Vec<String>> {
    let own = |line: &str| !line.contains(" :: ");
    let first = lines.iter().position(|line| own(line) && line.contains(place))?;
    if lines[first].starts_with('|') {
        return Some(numbers(lines[first]));
    }
    let is_text = |line: &&&str| !line.is_empty() && !line.starts_with('|') && !line.starts_with("<!--");
    let before: Vec<&str> = lines[..first].iter().rev().take_while(is_text).copied().collect();
    let from = first - before.len();
    let paragraph: Vec<&str> = lines[from..].iter().take_while(is_text).copied().collect();
    Some(numbers(&paragraph.join(" ")))
}

/// The numbers of a text as they stand there, without the commas between thousands.
fn numbers(text: &str) -> Vec<String> {
    let runs = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == ','));
    let runs = runs.map(|run| run.trim_matches(['.', ',']).replace(',', ""));
    runs.filter(|run| run.chars().any(|c| c.is_ascii_digit())).collect()
}

/// Whether the first is the second rounded to as many decimals, in the same unit or in one that differs by a
/// power of ten.
fn rounded(said: &str, written: &str) -> bool {
    let (Ok(value), Ok(data)) = (said.parse::<f64>(), written.parse::<f64>()) else { return false };
    let decimals = said.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let half = 0.5 * 10_f64.powi(-i32::try_from(decimals).unwrap_or(0));
    // What the decimal does to the binary number.
    let allowed = half * (1.0 + 1e-6);
    [0, -3, 3, -2, 2, -1, 1, -6, 6]
        .into_iter()
        .any(|power| (value - data * 10_f64.powi(power)).abs() <= allowed && value != 0.0)
        || value == data
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::SAMPLE;

    #[test]
    fn a_figure_is_in_the_paper_and_in_the_data() {
        let topics = [Topic::read("lines", SAMPLE).unwrap()];
        let paper = |mark: &str| {
            let text = format!(
                "Words.\n\nThe paper has 0.0991 px,\nours 62 µm or 0.06.\n\n\
                 | its mean | 0.0623 px |\n\n{BEGINS}\n{mark}\n-->\n"
            );
            of("P.md", &text, &topics)
        };
        for right in [
            "ours 62 :: 0.0991 :: lines/lines :: flag / the paper",
            "its mean :: 0.0623 :: lines/lines :: flag / ours",
            "The paper :: 62=0.0623 0.06=0.0623 :: lines/lines :: flag / ours",
        ] {
            assert_eq!(paper(right), Vec::<String>::new());
        }
        for (wrong, said) in [
            ("its mean :: 0.0991 :: lines/lines :: flag / the paper", "\"its mean\" says 0.0623, not 0.0991"),
            ("its mean :: 0.0623 :: lines/lines :: flag / the paper", "has 0.0991 1, not 0.0623"),
            ("its mode :: 0.0623 :: lines/lines :: flag / ours", "nothing here says: its mode"),
            ("its mean :: 0.0623 :: lines/curves :: flag / ours", "has no table curves"),
            ("its mean :: 0.0623 :: lines/lines :: flag", "has no row of: flag"),
            ("The paper :: 62=1000 :: lines/lines :: flag / ours", "62 is not 1000 rounded"),
            ("its mean :: 0.0623", "a mark is"),
        ] {
            let problems = paper(wrong);
            assert!(
                problems.len() == 1 && problems[0].starts_with("P.md:9: ") && problems[0].contains(said),
                "{problems:?}"
            );
        }
    }
}
