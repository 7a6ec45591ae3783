//! Makes the pages of `docs/results` from the data in `results/*.toml`, and compares them.
//!
//! The figures are written down once, in the data; a page that was changed by hand, or a README that tells
//! another figure than the row it was taken from, is named with its line:
//!
//! ```text
//! cargo run --example results                # writes the pages
//! cargo run --example results -- --check     # writes nothing; exit 1 and a line for each difference
//! cargo run --example results -- --list      # every figure on a line of its own, for other programs
//! ```

mod commands;
mod data;
mod page;
mod quoted;

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{fs, io};

use clap::Parser;
use data::{Role, Topic};

/// Makes the pages of docs/results from the data in results/*.toml
#[derive(Parser)]
#[command(name = "results", version)]
struct Arguments {
    /// Writes nothing; says what differs from the data, and fails
    #[arg(long)]
    check: bool,
    /// Prints every figure with its row, column, unit, command, date and machine, separated by tabs
    #[arg(long, conflicts_with = "check")]
    list: bool,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            let _ = writeln!(io::stderr(), "{error}");
            ExitCode::FAILURE
        }
    }
}

/// Whether all is well.
fn run(arguments: &Arguments) -> io::Result<bool> {
    let root = root();
    let (topics, mut problems) = read(&root)?;
    if arguments.list {
        list(&topics)?;
    } else if arguments.check {
        problems.extend(differences(&root, &topics)?);
        problems.extend(commands::problems(&root, &topics));
        problems.extend(quoted::problems(&root, &topics)?);
    } else if problems.is_empty() {
        for (name, text) in pages(&topics) {
            fs::write(root.join(PAGES).join(name), text)?;
        }
    }
    for problem in &problems {
        writeln!(io::stderr(), "{problem}")?;
    }
    Ok(problems.is_empty())
}

/// Where the pages are.
const PAGES: &str = "docs/results";

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All data, in the order of their files' names, and what is wrong with them.
fn read(root: &Path) -> io::Result<(Vec<Topic>, Vec<String>)> {
    let mut files: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(root.join("results"))? {
        files.push(entry?.path());
    }
    files.retain(|file| file.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    let (mut topics, mut problems) = (Vec::new(), Vec::new());
    for file in files {
        let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        match Topic::read(&name, &fs::read_to_string(&file)?) {
            Ok(topic) => topics.push(topic),
            Err(error) => problems.push(format!("results/{name}.toml: {error}")),
        }
    }
    problems.extend(topics.iter().flat_map(Topic::problems));
    Ok((topics, problems))
}

/// The pages by the names of their files.
fn pages(topics: &[Topic]) -> BTreeMap<String, String> {
    let mut pages: BTreeMap<_, _> =
        topics.iter().map(|topic| (format!("{}.md", topic.name), page::of(topic))).collect();
    pages.insert("README.md".to_owned(), page::index(topics));
    pages
}

/// Where the pages differ from the data.
fn differences(root: &Path, topics: &[Topic]) -> io::Result<Vec<String>> {
    let mut problems = Vec::new();
    let pages = pages(topics);
    for (name, wanted) in &pages {
        match fs::read_to_string(root.join(PAGES).join(name)) {
            Ok(found) => problems.extend(difference(&format!("{PAGES}/{name}"), &found, wanted)),
            Err(error) => problems.push(format!("{PAGES}/{name}: {error}")),
        }
    }
    for entry in fs::read_dir(root.join(PAGES))? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if !pages.contains_key(&name) {
            problems.push(format!("{PAGES}/{name}: no data in results/ are behind this page"));
        }
    }
    Ok(problems)
}

/// The first line in which a page is not what the data make of it.
fn difference(page: &str, found: &str, wanted: &str) -> Option<String> {
    const REMEDY: &str = "change results/*.toml and run `cargo run --example results`";
    let (mut found, mut wanted) = (found.lines(), wanted.lines());
    for number in 1.. {
        let pair = (found.next(), wanted.next());
        if pair == (None, None) {
            break;
        }
        if pair.0 != pair.1 {
            let [is, should] = [pair.0, pair.1].map(|line| line.unwrap_or("(the end)"));
            return Some(format!("{page}:{number}: {is}\n  by the data: {should}\n  {REMEDY}"));
        }
    }
    None
}

/// Prints every figure.
fn list(topics: &[Topic]) -> io::Result<()> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    writeln!(out, "table\trow\tcolumn\tas\tunit\tfigure\tcommand\tdate\tmachine")?;
    for topic in topics {
        for table in topic.tables() {
            for (label, row) in table.labels().iter().zip(&table.rows) {
                for (column, cell) in table.columns.iter().zip(&row.cells) {
                    let role = table.role(column, row);
                    if role == Role::Of || cell.is_empty() {
                        continue;
                    }
                    let (name, title, unit) =
                        (&topic.name, &column.title, column.unit.as_deref().unwrap_or(""));
                    let (command, machine) = (&table.command, &table.machine);
                    let date = row.date.as_ref().unwrap_or(&table.date);
                    let role = role.name();
                    let place = format!("{name}/{}", table.name);
                    writeln!(
                        out,
                        "{place}\t{label}\t{title}\t{role}\t{unit}\t{cell}\t{command}\t{date}\t{machine}"
                    )?;
                }
            }
        }
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_and_what_is_quoted_are_those_of_the_data() {
        let root = root();
        let (topics, mut problems) = read(&root).unwrap();
        problems.extend(differences(&root, &topics).unwrap());
        problems.extend(commands::problems(&root, &topics));
        problems.extend(quoted::problems(&root, &topics).unwrap());
        assert!(topics.len() > 20 && problems.is_empty(), "{}", problems.join("\n"));
    }

    #[test]
    fn the_line_that_differs_is_named() {
        assert_eq!(difference("p", "a\nb\n", "a\nb\n"), None);
        for (found, wanted, place) in
            [("a\nb", "a\nc", "p:2: b"), ("a", "a\nb", "p:2: (the end)"), ("x\na", "a", "p:1: x")]
        {
            let said = difference("p", found, wanted).unwrap();
            assert!(said.starts_with(place), "{said}");
        }
    }
}
