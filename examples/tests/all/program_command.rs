//! The program `plotter`, whose subcommands are the examples and the commands on recordings.

use crate::built_example::{Folder, data, machine, run_example};
use plotter_examples::shared::ExitStatus;
use std::process::{Command, Output};

/// The tools, each with the example that runs the same code.
const TOOLS: [(&str, &str); 9] = [
    ("trace", "trace"),
    ("plot", "plot"),
    ("convert", "convert"),
    ("stepper", "stepper"),
    ("max-error", "max_error"),
    ("follow", "follow"),
    ("long-sheet", "long_sheet"),
    ("tune", "tune"),
    ("compare", "compare_controllers"),
];

/// Subcommands on recordings, and those for completions and manual pages.
const OTHERS: [&str; 10] =
    ["render", "check", "replay", "compare-logs", "record", "import", "export", "info", "completions", "man"];

/// Most columns of a page of help.
const COLUMNS: usize = 100;

fn plotter(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_plotter")).args(arguments).output().unwrap()
}

/// Output as text.
fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs a wrong command line, and returns its error message.
fn refused(arguments: &[&str]) -> String {
    let output = plotter(arguments);
    assert_eq!(output.status.code(), Some(ExitStatus::WrongUse.code().into()), "{arguments:?}");
    text(&output.stderr)
}

/// Names of all subcommands.
fn all() -> impl Iterator<Item = &'static str> {
    TOOLS.into_iter().map(|(name, _)| name).chain(OTHERS)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn the_program_and_the_example_give_the_same_bytes() {
    let folder = Folder::new();
    let flag = data("flag.png");
    let gantry = machine("semi-virtual-gantry.toml");
    let plt = folder.write("square.plt", "IN;SP1;PU0,0;PD4000,0,4000,4000,0,4000,0,0;PU;");
    let jobs: [&[&str]; 5] = [
        &["trace", &flag, "--hpgl", "-", "--quiet"],
        &["convert", &plt, "-", "--to", "gcode"],
        &["stepper", &plt, "--json"],
        &["tune", "--machine", &gantry, "--axis", "x", "--method", "lambda"],
        &["max-error", "--max-error-mm", "0.000001"],
    ];
    for job in jobs {
        let (tool, rest) = job.split_first().unwrap();
        let example = TOOLS.iter().find(|(name, _)| name == tool).unwrap().1;
        let (one, other) = (plotter(job), run_example(example, rest));
        assert_eq!(one.status.code(), other.status.code(), "{job:?}");
        assert_eq!(text(&one.stdout), text(&other.stdout), "{job:?}");
        assert_eq!(text(&one.stderr), text(&other.stderr), "{job:?}");
        assert!(!one.stdout.is_empty() || !one.status.success(), "{job:?}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_help_fits_a_page_and_has_an_example() {
    let whole = text(&plotter(&["--help"]).stdout);
    for name in all() {
        assert!(whole.lines().any(|line| line.starts_with(&format!("  {name} "))), "{name}: {whole}");
        let help = text(&plotter(&[name, "--help"]).stdout);
        for line in help.lines().chain(whole.lines()) {
            assert!(line.chars().count() <= COLUMNS, "{name}: {line}");
        }
        assert!(help.contains(&format!("plotter {name} ")), "{name}: {help}");
        assert!(help.contains("Example"), "{name}: {help}");
        let version = text(&plotter(&[name, "--version"]).stdout);
        assert!(version.trim_end().ends_with(env!("CARGO_PKG_VERSION")), "{name}: {version}");
    }
    for (tool, example) in TOOLS {
        let help = text(&run_example(example, &["--help"]).stdout);
        assert!(help.contains(&format!("--example {example} --")), "{tool}: {help}");
        assert!(!run_example(example, &["--version"]).stdout.is_empty(), "{example}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn every_command_with_figures_has_quiet_and_json() {
    for name in all().filter(|name| !["completions", "man"].contains(name)) {
        let help = text(&plotter(&[name, "--help"]).stdout);
        for option in ["--quiet", "--json"] {
            assert!(help.contains(option), "{name} without {option}: {help}");
        }
        assert!(refused(&[name, "--quiet", "--json"]).contains("cannot be used with"), "{name}");
    }
    assert!(plotter(&["tune", "--axis", "x", "--method", "lambda", "--quiet"]).stdout.is_empty());
    for job in [
        &["trace", "--json"][..],
        &["stepper", "--estimate", "--json"],
        &["tune", "--axis", "x", "--method", "lambda", "--json"],
    ] {
        let output = plotter(job);
        assert!(output.status.success(), "{job:?}: {}", text(&output.stderr));
        let figures: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert!(figures.as_object().is_some_and(|figures| figures.len() > 3), "{job:?}: {figures}");
    }
}

#[test]
fn commands_on_recordings_print_figures_and_errors_as_json() {
    let folder = Folder::new();
    let log = folder.write("line.plog", "plotter-log 1 {\"protocol\":\"digits\",\"baud\":256000}\n");
    let told = |arguments: &[&str]| {
        let output = plotter(arguments);
        let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(told["exit_status"], output.status.code().unwrap(), "{told}");
        assert_eq!(told["command"], arguments[0], "{told}");
        told
    };
    let lines = told(&["info", &log, "--json"]);
    assert!(lines["said"].as_array().unwrap().len() > 3, "{lines}");
    let none = told(&["info", "no-such.plog", "--json"]);
    assert!(none["error"].as_str().unwrap().contains("no-such.plog"), "{none}");
    assert!(plotter(&["info", &log, "--quiet"]).stdout.is_empty());
}

#[test]
fn a_misspelt_word_is_answered_with_the_nearest_one() {
    for (wrong, right) in [
        (&["trce"][..], "'trace'"),
        (&["compare-log"], "'compare-logs'"),
        (&["trace", "--treshold", "otsu"], "'--threshold'"),
        (&["trace", "--mode", "centerline"], "'centreline'"),
        (&["info", "--jsn"], "'--json'"),
        (&["completions", "bsh"], "'bash'"),
    ] {
        let said = refused(wrong);
        assert!(said.contains("tip:") && said.contains(right), "{wrong:?}: {said}");
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn completions_and_manual_pages_name_every_subcommand() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = text(&plotter(&["completions", shell]).stdout);
        for name in all() {
            assert!(script.contains(name), "{shell}: {name}");
        }
        assert!(script.contains("max-error-px") && script.contains("centreline"), "{shell}");
    }
    let page = text(&plotter(&["man"]).stdout);
    let folder = Folder::new();
    let pages = folder.file("man1");
    let output = plotter(&["man", &pages]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for name in all() {
        let roff = name.replace('-', "\\-");
        assert!(page.contains(&format!("plotter\\-{roff}(1)")), "{name}: {page}");
        let own = std::fs::read_to_string(format!("{pages}/plotter-{name}.1")).unwrap();
        assert!(own.contains(".SH NAME") && own.contains("\\-\\-help"), "{name}: {own}");
    }
    assert!(std::fs::exists(format!("{pages}/plotter.1")).unwrap());
}

#[test]
fn exit_codes_are_those_of_the_table_which_the_help_and_the_readme_have() {
    let folder = Folder::new();
    let damaged = folder.write("damaged.plog", "plotter-log 1 {\"protocol\":\"digits\"}\nno record\n");
    let plt = folder.write("line.plt", "IN;SP1;PU0,0;PD4000,0;");
    for (job, status) in [
        (&["convert", &plt, "-", "--to", "svg"][..], ExitStatus::Done),
        (&["convert", "no-such.plt", "-", "--to", "svg"], ExitStatus::Failed),
        (&["convert", &plt, "no-suffix"], ExitStatus::WrongUse),
        (&["convert"], ExitStatus::WrongUse),
        (&["info", &damaged], ExitStatus::Failed),
        (&["info", "no-such.plog"], ExitStatus::WrongUse),
        (&["--help"], ExitStatus::Done),
        (&[], ExitStatus::WrongUse),
    ] {
        let output = plotter(job);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(status.code().into()), "{job:?}: {said}");
    }
    let help = text(&plotter(&["--help"]).stdout);
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    for status in ExitStatus::ALL {
        let (code, meaning) = (status.code(), status.meaning());
        assert!(help.contains(&format!("  {code:<4}{meaning}")), "{code}: {help}");
        assert!(readme.contains(&format!("| {code} | {meaning} |")), "{code}: {meaning}");
    }
}
