//! Dependencies that this crate brings into a firmware: few, and no new one by accident.

use std::collections::BTreeMap;

/// The crates that this one depends on by its manifest, and whether they are optional. Those of tests and
/// builds are left out.
fn dependencies(manifest: &str) -> BTreeMap<&str, bool> {
    let mut found = BTreeMap::new();
    let mut section = "";
    for line in manifest.lines().map(str::trim) {
        if let Some(header) = line.strip_prefix('[') {
            section = header.trim_end_matches(']');
            // Also one that is written as a table of its own, or for one target only.
            if let Some((before, name)) = section.split_once("dependencies.")
                && (before.is_empty() || before.ends_with('.'))
            {
                found.insert(name, false);
            }
        } else if let Some((key, value)) = line.split_once('=') {
            let in_list = section == "dependencies" || section.ends_with(".dependencies");
            if let Some((_, name)) =
                section.split_once("dependencies.").filter(|(before, _)| !before.ends_with('-'))
            {
                if key.trim() == "optional" && value.trim() == "true" {
                    found.insert(name, true);
                }
            } else if in_list {
                let name = key.trim().split('.').next().unwrap_or_default();
                found.insert(name, value.contains("optional = true"));
            }
        }
    }
    found
}

#[test]
fn a_firmware_gets_four_crates_with_this_one() {
    let expected = [
        ("defmt", true),
        ("embedded-hal", false),
        ("embedded-hal-async", true),
        ("embedded-hal-nb", true),
        ("embedded-io", false),
        ("embedded-io-06", true),
        ("embedded-io-async", true),
        ("libm", false),
        ("plotter-motion", false),
    ];
    assert_eq!(dependencies(include_str!("../../Cargo.toml")), BTreeMap::from(expected));
}

#[test]
fn the_manifest_is_read_in_all_its_forms() {
    let manifest = "[dependencies]\na.workspace = true\nb = { version = \"1\", optional = true }\n\
                    [dependencies.c]\nversion = \"1\"\noptional = true\n[dev-dependencies]\nd = \"1\"\n\
                    [dev-dependencies.e]\nversion = \"1\"\n[target.'cfg(unix)'.dependencies]\nf = \"1\"\n[features]\ng = []\n";
    assert_eq!(
        dependencies(manifest),
        BTreeMap::from([("a", false), ("b", true), ("c", true), ("f", false)])
    );
}
