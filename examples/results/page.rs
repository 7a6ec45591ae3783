//! Markdown of a topic.

use std::fmt::Write as _;

use crate::data::{Held, Part, Table, Topic};

/// The page of a topic.
pub(crate) fn of(topic: &Topic) -> String {
    let mut page = begin(&topic.title, &format!("results/{}.toml", topic.name));
    page.push_str(&elsewhere(topic));
    for part in &topic.parts {
        page.push('\n');
        page.push_str(&shown(part));
    }
    page
}

fn begin(title: &str, data: &str) -> String {
    format!("<!-- Made by `cargo run --example results` from {data}. -->\n\n# {title}\n")
}

/// What other pages tell of a topic.
fn elsewhere(topic: &Topic) -> String {
    let limits = topic.limits.as_ref().map(|place| format!("[what does not work](../limits.md#{place})"));
    let tried = topic.tried.as_ref().map(|page| format!("[what was tried](../notebook/{page})"));
    let there: Vec<String> = limits.into_iter().chain(tried).collect();
    if there.is_empty() { String::new() } else { format!("\nElsewhere: {}.\n", there.join(", ")) }
}

fn shown(part: &Part) -> String {
    if let Some(heading) = &part.heading {
        format!("{} {heading}\n", "#".repeat(part.level.unwrap_or(2)))
    } else if let Some(text) = &part.text {
        format!("{}\n", text.trim_end())
    } else if let Some(commands) = &part.run {
        format!("```sh\n{}\n```\n", commands.join("\n"))
    } else {
        part.table.as_ref().map(table).unwrap_or_default()
    }
}

fn row<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    let mut line = String::from("|");
    for cell in cells {
        let _ = if cell.is_empty() { write!(line, " |") } else { write!(line, " {cell} |") };
    }
    line.push('\n');
    line
}

fn table(table: &Table) -> String {
    let titles: Vec<String> = table
        .columns
        .iter()
        .map(|column| match &column.unit {
            Some(unit) => format!("{}, {unit}", column.title),
            None => column.title.clone(),
        })
        .collect();
    let mut text = row(titles.iter().map(String::as_str));
    text.push_str(&format!("|{}\n", "---|".repeat(titles.len())));
    for line in &table.rows {
        text.push_str(&row(line.cells.iter().map(String::as_str)));
    }
    format!("{text}\n{}", below(table))
}

/// How the figures of a table are made again, what holds them, when and where they were measured.
fn below(table: &Table) -> String {
    let mut text = format!("Again: `{}`.\n", table.command);
    let runs = match table.held {
        // What is long in a debug build is left out there.
        Held::Tests if table.command.contains("--release") => Some("cargo test --release --workspace"),
        Held::Tests => Some("cargo test --workspace"),
        Held::Ci => Some(".ci/run"),
        Held::Hand => None,
    };
    let _ = match (runs, &table.by) {
        (Some(runs), Some(tests)) => writeln!(text, "Held by the tests `{tests}` in `{runs}`."),
        (Some(runs), None) => writeln!(text, "`{runs}` runs it."),
        (None, _) => writeln!(text, "It is run by hand."),
    };
    if let Some(needs) = &table.needs {
        let _ = writeln!(text, "It needs {needs}.");
    }
    let (first, last) = table.dates();
    let days = if first == last { first.to_owned() } else { format!("{first} to {last}") };
    let _ = match table.machine.as_str() {
        "any" => writeln!(text, "Measured {days}; any machine gives the same."),
        machine => writeln!(text, "Measured {days} on {machine}."),
    };
    text
}

/// The page that names the others.
pub(crate) fn index(topics: &[Topic]) -> String {
    let mut page = begin("Results", "results/*.toml");
    page.push_str(
        "
What was asked for or published, what these crates reach, and the command that gives it. All figures come from
simulated machines and from our own drawings. Below each table stands the command that makes it again, and
what it needs besides a fresh clone: some compare with other programs, or read files of others.
[Limits](../limits.md) tell what does not work, the [notebook](../notebook/README.md) what was tried.

",
    );
    page.push_str("| page | tables |\n|---|---|\n");
    for topic in topics {
        let tables = topic.tables().count();
        let _ = writeln!(page, "| [{}]({}.md) | {tables} |", topic.title, topic.name);
    }
    page.push_str(
        "
These pages are made by `cargo run --example results` from `results/*.toml`, which say of each figure what it
is (asked, published, ours, of another program), its unit, its command, its date and its machine; `-- --list`
prints all of that, a figure a line. `-- --check` compares the pages, the commands, and the figures that the
READMEs quote; `cargo test` and `.ci/run` do the same. A date is that of the change that brought the figure.
",
    );
    page
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::SAMPLE;

    #[test]
    fn a_table_tells_how_it_is_made_again() {
        let page = of(&Topic::read("lines", SAMPLE).unwrap());
        let wanted = "| | by | mean, px | asked |\n|---|---|---|---|\n\
                      | flag | the paper | 0.0991 | 1 |\n| | ours | 0.0623 | 1,000 |\n";
        assert!(page.contains(wanted), "{page}");
        let wanted = "Again: `cargo test -p plotter-motion --test all sim_contour::`.\n\
                      `cargo test --workspace` runs it.\n\
                      Measured 2026-11-19 to 2026-11-21; any machine gives the same.\n";
        assert!(page.ends_with(wanted), "{page}");
        let released =
            SAMPLE.replace("cargo test -p plotter-motion", "cargo test --release -p plotter-motion");
        let page = of(&Topic::read("lines", &released).unwrap());
        assert!(page.contains("\n`cargo test --release --workspace` runs it.\n"), "{page}");
    }
}
