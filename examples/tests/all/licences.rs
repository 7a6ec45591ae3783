//! Licences of all dependencies allow what those of the crates allow.

use serde_json::Value;
use spdx::{Expression, LicenseReq, ParseMode};
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

const CRATES: [&str; 5] =
    ["plotter-motion", "plotter-hal", "plotter-vector", "plotter-stitch", "plotter-replay"];

/// What permits everything that MIT or Apache-2.0 do.
const PERMISSIVE: [&str; 8] =
    ["MIT", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "ISC", "Zlib", "0BSD", "Unicode-3.0"];
/// What binds only those who change the files: behind an optional feature, which its user turns on himself.
const BEHIND_A_FEATURE: &str = "MPL-2.0";

fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn permits(licence: &str, is_allowed: impl Fn(&str) -> bool) -> bool {
    let expression =
        Expression::parse_mode(licence, ParseMode::LAX).unwrap_or_else(|error| panic!("{licence}: {error}"));
    expression.evaluate(|required: &LicenseReq| {
        // What an exception adds is a permission.
        required.license.id().is_some_and(|id| is_allowed(id.name))
    })
}

fn is_permissive(licence: &str) -> bool {
    permits(licence, |name| PERMISSIVE.contains(&name))
}

/// The licence of each package that any feature can bring, by `name version`.
fn licences() -> BTreeMap<String, String> {
    let host = cargo_host();
    let told = cargo(&[
        "metadata",
        "--format-version",
        "1",
        "--all-features",
        "--locked",
        "--filter-platform",
        &host,
    ]);
    let told: Value = serde_json::from_str(&told).unwrap();
    let packages = told["packages"].as_array().unwrap().iter();
    packages
        .map(|package| {
            let text = |key: &str| package[key].as_str().unwrap_or_default().to_owned();
            (format!("{} {}", text("name"), text("version")), text("license"))
        })
        .collect()
}

fn cargo_host() -> String {
    let told = cargo(&["-vV"]);
    told.lines().find_map(|line| line.strip_prefix("host: ")).unwrap().to_owned()
}

/// What a crate brings to a program that depends on it, by `name version`.
fn tree(package: &str, features: &[&str]) -> BTreeSet<String> {
    let arguments =
        ["tree", "--locked", "-e", "normal,build", "--prefix", "none", "-f", "{p}", "-p", package];
    cargo(&[&arguments[..], features].concat())
        .lines()
        .filter_map(|line| {
            let mut words = line.split(' ');
            Some(format!("{} {}", words.next()?, words.next()?.strip_prefix('v')?))
        })
        .collect()
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn by_default_all_dependencies_are_permissive() {
    let licences = licences();
    for package in CRATES {
        let tree = tree(package, &[]);
        assert!(tree.len() > 1, "{package} has no dependencies: {tree:?}");
        for dependency in tree {
            assert!(
                is_permissive(&licences[&dependency]),
                "{package}: {dependency}: {}",
                licences[&dependency]
            );
        }
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn behind_features_files_may_be_bound_and_nothing_more() {
    let licences = licences();
    for package in CRATES {
        for dependency in tree(package, &["--all-features"]) {
            let licence = &licences[&dependency];
            let is_allowed = is_permissive(licence) || permits(licence, |name| name == BEHIND_A_FEATURE);
            assert!(is_allowed, "{package}: {dependency}: {licence}");
        }
    }
}

#[test]
fn other_licences_are_found() {
    for (licence, is_fine) in [
        ("MIT OR Apache-2.0", true),
        ("MIT/Apache-2.0", true),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", true),
        ("Apache-2.0 WITH LLVM-exception OR GPL-3.0-only", true),
        ("MPL-2.0", false),
        ("MIT AND MPL-2.0", false),
        ("GPL-3.0-or-later", false),
        ("BSL-1.0", false),
    ] {
        assert_eq!(is_permissive(licence), is_fine, "{licence}");
    }
}
