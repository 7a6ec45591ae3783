//! Whether the commands that the data name are there: a test that was renamed would leave figures that
//! nothing makes.

use std::fs;
use std::path::Path;

use crate::data::{Held, Part, Table, Topic};

/// What is wrong with the commands of all tables.
pub(crate) fn problems(root: &Path, topics: &[Topic]) -> Vec<String> {
    let ci = fs::read_to_string(root.join(".ci/run")).unwrap_or_default();
    let mut problems = Vec::new();
    for topic in topics {
        let commands = topic.parts.iter().flat_map(named);
        let wrong = commands.flat_map(|command| missing(root, &command));
        problems.extend(wrong.map(|wrong| format!("results/{}.toml: {wrong}", topic.name)));
        for table in topic.tables() {
            let mut wrong = missing(root, &table.command);
            if let Some(tests) = &table.by {
                wrong.extend(missing(root, &format!("cargo test -p {tests}")));
            }
            wrong.extend(unheld(table, &ci));
            let (name, place) = (&topic.name, &table.name);
            problems.extend(
                wrong.into_iter().map(|wrong| format!("results/{name}.toml: table {place}: {wrong}")),
            );
        }
    }
    problems
}

/// The commands that a part of a page names besides those of tables: in its list, and in its text between
/// backquotes.
fn named(part: &Part) -> Vec<String> {
    let listed = part.run.iter().flatten().filter_map(|line| line.split(" #").next());
    let text = part.text.as_deref().unwrap_or_default();
    let told = text.split('`').skip(1).step_by(2).filter(|span| span.starts_with("cargo "));
    listed.chain(told).map(str::to_owned).collect()
}

/// What of a command is not in the repository.
fn missing(root: &Path, command: &str) -> Vec<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let after = |flag: &str| words.windows(2).find(|pair| pair[0] == flag).map(|pair| pair[1]);
    let folder = match after("-p") {
        Some("plotter-examples") => "examples",
        Some("plotter-judging") => "examples/judging",
        Some(package) => package,
        None => "",
    };
    let mut missing = Vec::new();
    let mut want = |places: &[String], what: &str| {
        if !places.iter().any(|place| root.join(place).exists()) {
            missing.push(format!("there is no {what}"));
        }
    };
    if !folder.is_empty() {
        want(&[format!("{folder}/Cargo.toml")], &format!("package {folder}"));
        for word in words.iter().filter(|word| word.contains("::") && !words.contains(&"--lib")) {
            let module = word.split("::").next().unwrap_or_default();
            let tests = format!("{folder}/tests/all/{module}");
            want(&[format!("{tests}.rs"), tests.clone()], &format!("{tests}.rs"));
        }
        if let Some(bench) = after("--bench") {
            let bench = format!("{folder}/benches/{bench}.rs");
            want(std::slice::from_ref(&bench), &bench);
        }
    }
    if let Some(example) = after("--example") {
        let manifest = fs::read_to_string(root.join("examples/Cargo.toml")).unwrap_or_default();
        if !manifest.contains(&format!("name = \"{example}\"")) {
            want(&[format!("examples/judging/examples/{example}.rs")], &format!("example {example}"));
        }
    }
    for word in words.iter().filter(|word| word.starts_with("examples/") || word.starts_with(".ci/")) {
        want(&[(*word).to_owned()], word);
    }
    missing
}

/// Why what is said to run the command does not.
fn unheld(table: &Table, ci: &str) -> Option<String> {
    let command = &table.command;
    let word = |wanted: &str| command.split_whitespace().any(|word| word == wanted);
    let tests = table.by.as_ref().unwrap_or(command);
    let module = tests.split_whitespace().find_map(|word| word.split_once("::")).map(|(module, _)| module);
    match table.held {
        Held::Tests if table.by.is_none() && (word("--ignored") || !command.starts_with("cargo test")) => {
            Some(format!("`cargo test --workspace` does not run {command}"))
        }
        Held::Ci => {
            let first = command.split_whitespace().next().unwrap_or_default();
            let named = module.unwrap_or(first);
            (!ci.contains(named)).then(|| format!(".ci/run does not name {named}"))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::SAMPLE;

    #[test]
    fn a_command_that_names_nothing_is_found() {
        let root = crate::root();
        for (command, wrong) in [
            ("cargo test -p plotter-motion --test all sim_contour::", 0),
            ("cargo test -p plotter-motion --test all sim_kontour::", 1),
            ("cargo test -p plotter-emotion --test all", 1),
            ("cargo run --example plot -- examples/data/flag.png", 0),
            ("cargo run --example blot -- examples/data/flagg.png", 2),
            ("cargo bench -p plotter-stitch --bench joint", 0),
            ("cargo bench -p plotter-stitch --bench joints", 1),
        ] {
            assert_eq!(missing(&root, command).len(), wrong, "{command}: {:?}", missing(&root, command));
        }
    }

    #[test]
    fn commands_of_the_text_and_of_lists_are_looked_at() {
        let text = "`no` words, `cargo test -p plotter-motion --test all\nsim_stepgen::`.";
        let topic = |parts: &str| Topic::read("lines", &format!("title = \"\"\n{parts}")).unwrap();
        let told = topic(&format!("[[part]]\ntext = '''{text}'''"));
        assert_eq!(named(&told.parts[0]), ["cargo test -p plotter-motion --test all\nsim_stepgen::"]);
        let listed = topic("[[part]]\nrun = [\"cargo run --example plott   # draws\"]");
        let found = problems(&crate::root(), &[told, listed]);
        assert_eq!(found, ["results/lines.toml: there is no example plott"]);
    }

    #[test]
    fn what_nothing_runs_is_found() {
        let unheld_with = |right: &str, wrong: &str| {
            let topic = Topic::read("lines", &SAMPLE.replace(right, wrong)).unwrap();
            unheld(topic.tables().next().unwrap(), "sim_joints:: --ignored")
        };
        assert_eq!(unheld_with("", ""), None);
        assert!(unheld_with("sim_contour::\"", "sim_contour:: -- --ignored\"").is_some());
        assert!(
            unheld_with("\"cargo test\"", "\".ci/run\"").is_some_and(|said| said.contains("sim_contour"))
        );
        let joints = SAMPLE.replace("sim_contour", "sim_joints").replace("\"cargo test\"", "\".ci/run\"");
        assert_eq!(
            unheld(Topic::read("lines", &joints).unwrap().tables().next().unwrap(), "sim_joints::"),
            None
        );
    }
}
