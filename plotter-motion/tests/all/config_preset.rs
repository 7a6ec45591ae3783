//! The presets of the documented machines against the values in code.
#![cfg(feature = "toml")]

use plotter_motion::{Machine, MachineConfig, config::MachineName};
use std::{fs, path::Path};

/// What a preset must be.
struct Preset {
    file: &'static str,
    config: fn() -> MachineConfig,
    /// Keys of the machine and keys an axis, as docs/machine-config.md lists them for its kind of motor.
    keys: (usize, usize),
    /// From this line on come keys that had their comment above, under the first axis.
    repeats: &'static str,
}

const GANTRY: Preset = Preset {
    file: "semi-virtual-gantry.toml",
    config: MachineConfig::default,
    keys: (38, 20),
    repeats: "[y]",
};
const STEPPER_PLOTTER: Preset = Preset {
    file: "stepper-plotter.toml",
    config: MachineConfig::stepper_plotter,
    keys: (62, 5),
    repeats: "[y.stepper]",
};

const MARKING_BOARD: Preset = Preset {
    file: "marking-board.toml",
    config: MachineConfig::marking_board,
    keys: (55, 14),
    repeats: "[y]",
};

const TEXTILE_PLOTTER: Preset = Preset {
    file: "textile-plotter.toml",
    config: MachineConfig::textile_plotter,
    keys: (68, 5),
    repeats: "[y.stepper]",
};

const PLASMA_FOLLOWER: Preset =
    Preset { file: "plasma-follower.toml", config: plasma_follower, keys: (66, 5), repeats: "[y.stepper]" };

/// The camera and the torch are chosen, not documented: the code has no such machine, so it is said here.
fn plasma_follower() -> MachineConfig {
    let mut config = MachineConfig::stepper_plotter();
    config.name = MachineName::new("plasma-follower").unwrap_or(config.name);
    (config.area.width_mm, config.area.height_mm) = (1000.0, 500.0);
    let steppers = config.steppers_mut().unwrap();
    (steppers.planner.speed_mm_s, steppers.planner.travel_speed_mm_s) = (18.0, 80.0);
    steppers.pen.settle_ms = 800.0;
    (steppers.homing.known_travel_mm, steppers.homing.max_travel_mm) = (450.0, 1100.0);
    for axis in [&mut steppers.x, &mut steppers.y] {
        (axis.steps_per_mm, axis.backlash_mm) = (80.0, 0.3);
    }
    config
}

/// Each preset with its text; without text where this crate was unpacked alone.
fn presets() -> impl Iterator<Item = (Preset, String)> {
    [GANTRY, STEPPER_PLOTTER, MARKING_BOARD, TEXTILE_PLOTTER, PLASMA_FOLLOWER].into_iter().filter_map(
        |preset| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines").join(preset.file);
            let text = fs::read_to_string(&path).ok();
            if text.is_none() {
                eprintln!("{} is not here: nothing to compare", path.display());
            }
            text.map(|text| (preset, text))
        },
    )
}

#[test]
fn a_preset_says_what_the_code_says() {
    for (preset, text) in presets() {
        assert_eq!(MachineConfig::from_toml(&text), Ok((preset.config)()), "{}", preset.file);
    }
}

#[test]
fn a_preset_is_a_machine() {
    for (preset, text) in presets() {
        let machine = Machine::from_toml(&text).expect("accepted");
        assert_eq!(*machine.config(), (preset.config)());
    }
}

/// A key left out would go unseen above, since it has its default then.
#[test]
fn a_preset_has_every_key_of_its_kind_of_motor() {
    for (preset, text) in presets() {
        let keys = text.lines().filter(|line| !line.starts_with('#') && line.contains(" = ")).count();
        let (of_the_machine, of_an_axis) = preset.keys;
        assert_eq!(keys, of_the_machine + 2 * of_an_axis, "{}", preset.file);
    }
}

#[test]
fn every_key_of_a_preset_has_a_comment_above_it() {
    for (preset, text) in presets() {
        let mut above = "";
        for line in text.lines().take_while(|line| *line != preset.repeats) {
            if line.contains(" = ") && !line.starts_with('#') {
                assert!(above.starts_with('#'), "{}: no comment above `{line}`", preset.file);
            }
            above = line;
        }
    }
}
