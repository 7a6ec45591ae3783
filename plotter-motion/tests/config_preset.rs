//! The preset of the documented gantry against the defaults in code.
#![cfg(feature = "toml")]

use plotter_motion::{Machine, MachineConfig};
use std::{fs, path::Path};

/// The preset, or `None` where this crate was unpacked alone.
fn preset() -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines/semi-virtual-gantry.toml");
    let text = fs::read_to_string(&path).ok();
    if text.is_none() {
        eprintln!("{} is not here: nothing to compare", path.display());
    }
    text
}

#[test]
fn the_preset_says_what_the_defaults_in_code_say() {
    let Some(text) = preset() else { return };
    assert_eq!(MachineConfig::from_toml(&text), Ok(MachineConfig::default()));
}

#[test]
fn the_preset_is_a_machine() {
    let Some(text) = preset() else { return };
    let machine = Machine::from_toml(&text).expect("accepted");
    assert_eq!(*machine.config(), MachineConfig::default());
}

/// A key left out would go unseen above, since it has its default then.
#[test]
fn the_preset_has_every_key() {
    let Some(text) = preset() else { return };
    let keys = text.lines().filter(|line| !line.starts_with('#') && line.contains(" = ")).count();
    // 34 of the machine and 14 an axis, as docs/machine-config.md lists them.
    assert_eq!(keys, 34 + 2 * 14);
}

#[test]
fn every_key_of_the_preset_has_a_comment_above_it() {
    let Some(text) = preset() else { return };
    let mut above = "";
    for line in text.lines().take_while(|line| *line != "[y]") {
        if line.contains(" = ") && !line.starts_with('#') {
            assert!(above.starts_with('#'), "no comment above `{line}`");
        }
        above = line;
    }
}
