//! The machine that a command line names.

use super::commands::{MOST_MACHINE_BYTES, read_file};
#[cfg(feature = "live")]
use crate::log::Header;
#[cfg(feature = "live")]
use plotter_motion::config::{ControllerChoice, DcConfig, MachineKind, OneBeltConfig, SteppersConfig};
#[cfg(feature = "live")]
use plotter_motion::kinematics::Backlash;
use plotter_motion::{Machine, MachineConfig};
use std::path::Path;

/// The machine of a file, or the semi-virtual gantry.
///
/// # Errors
///
/// The file, and what is wrong with it.
pub(crate) fn read_machine(path: Option<&Path>) -> Result<Machine, String> {
    let Some(path) = path else {
        return Machine::new(MachineConfig::default()).map_err(|error| error.to_string());
    };
    let refused = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = String::from_utf8(read_file(path, MOST_MACHINE_BYTES)?)
        .map_err(|error| refused(&error.utf8_error()))?;
    Machine::from_toml(&text).map_err(|error| refused(&error))
}

/// What a log's header says of a machine; `boot` is that of one that is simulated here, and speaks frames.
#[cfg(feature = "live")]
pub(crate) fn header_of(machine: &Machine, protocol: &str, boot: Option<u32>) -> Header {
    let config = machine.config();
    let dc = DcConfig::of(machine);
    let controller = match dc.control.controller {
        ControllerChoice::Published => "published",
        _ => "contouring",
    };
    let header = Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", protocol)
        .with_text("machine", config.name.as_str())
        .with_text("controller", controller)
        .with_decimal("x_mm_per_pulse", 1.0 / dc.x.counts_per_mm)
        .with_decimal("y_mm_per_pulse", 1.0 / dc.y.counts_per_mm);
    match boot {
        Some(boot) => header.with_number("boot", boot.into()),
        None => header,
    }
}

/// The play of a machine's axes, where it has any, for the header of a log that has its steps.
#[cfg(feature = "live")]
fn with_play(header: Header, machine: &Machine) -> Header {
    let Backlash { x_steps, y_steps } = Backlash::of(machine);
    if (x_steps, y_steps) == (0, 0) {
        return header;
    }
    header.with_number("x_play_steps", x_steps.into()).with_number("y_play_steps", y_steps.into())
}

/// What a log's header says of a machine that is led by lines of text.
#[cfg(feature = "live")]
pub(crate) fn lines_header(machine: &Machine, protocol: &str) -> Header {
    let config = machine.config();
    let steppers = SteppersConfig::of(machine);
    let header = Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", protocol)
        .with_text("machine", config.name.as_str());
    // Another machine's controller is not that of the preset, and takes a description.
    let is_preset = *config == MachineConfig::stepper_plotter();
    let header = if is_preset { header.with_text("controller", "stepper-plotter") } else { header };
    let header = header
        .with_decimal("x_mm_per_pulse", 1.0 / steppers.x.steps_per_mm)
        .with_decimal("y_mm_per_pulse", 1.0 / steppers.y.steps_per_mm);
    with_play(header, machine)
}

/// What the log of a simulated machine says of it.
#[cfg(all(feature = "live", unix))]
pub(crate) fn simulated_header(machine: &Machine, spoken: crate::live::Spoken) -> Header {
    use crate::live::Spoken;
    let header = match (spoken, machine.kind()) {
        (_, MachineKind::Belt) => belt_header(machine),
        (Spoken::Link { boot }, _) => header_of(machine, "link", Some(boot)),
        (Spoken::Digits, _) => header_of(machine, "digits", None),
        (Spoken::Grbl, _) => lines_header(machine, "grbl"),
        (Spoken::MDraw, _) => lines_header(machine, "mdraw"),
        (Spoken::Marlin, _) => lines_header(machine, "marlin"),
        (Spoken::Hpgl, _) => lines_header(machine, "hpgl"),
        (Spoken::Ebb { is_mixed }, _) => ebb_header(machine, is_mixed),
    };
    header.with_text("clock", "simulated")
}

#[cfg(all(feature = "live", unix))]
fn ebb_header(machine: &Machine, is_mixed: bool) -> Header {
    let config = machine.config();
    let steppers = SteppersConfig::of(machine);
    let header = Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", "ebb")
        .with_text("machine", config.name.as_str())
        .with_decimal("x_mm_per_pulse", 1.0 / steppers.x.steps_per_mm)
        .with_decimal("y_mm_per_pulse", 1.0 / steppers.y.steps_per_mm);
    if is_mixed { header.with_text("belt_signs", "tracking-equations") } else { header }
}

/// How far beside its target a board with a belt may say that it has arrived, counts of a motor: within the
/// allowed error along both axes, one motor may be off by both.
#[cfg(feature = "live")]
pub(crate) fn belt_tolerance(machine: &Machine) -> f64 {
    let OneBeltConfig { dc, point_to_point, .. } = OneBeltConfig::of(machine);
    match dc.control.controller {
        ControllerChoice::Published => (2.0 * point_to_point.allowed_error_mm * dc.x.counts_per_mm).ceil(),
        _ => 1.0,
    }
}

/// What the log of a simulated board with a belt says of it.
#[cfg(feature = "live")]
pub(crate) fn belt_header(machine: &Machine) -> Header {
    use plotter_motion::firmware::MarkingBoardSettings;
    use plotter_motion::kinematics::BeltSigns;
    let config = machine.config();
    let settings = MarkingBoardSettings::of(machine);
    let mm_per_pulse = 1.0 / settings.belt.steps_per_mm();
    let signs = match settings.belt.signs() {
        BeltSigns::DirectionTable => "direction-table",
        BeltSigns::TrackingEquations => "tracking-equations",
    };
    let mut preset = MachineConfig::marking_board();
    if let Some(dc) = preset.dc_mut() {
        dc.control.controller = ControllerChoice::Published;
    }
    let header = Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", "counts")
        .with_text("machine", config.name.as_str());
    let header = if *config == preset { header.with_text("controller", "marking-board") } else { header };
    header
        .with_text("belt_signs", signs)
        .with_decimal("x_mm_per_pulse", mm_per_pulse)
        .with_decimal("y_mm_per_pulse", mm_per_pulse)
        .with_decimal("p1_x_mm", settings.start.x)
        .with_decimal("p1_y_mm", settings.start.y)
        .with_decimal("reached_tolerance_counts", belt_tolerance(machine))
}

/// How fast a simulated machine's time passes. No computer makes a million seconds of a machine in one.
#[cfg(feature = "live")]
pub(crate) fn speed(text: &str) -> Result<f64, String> {
    let factor: f64 = text.parse().map_err(|_| String::from("expected a number"))?;
    if (0.01..=1e6).contains(&factor) { Ok(factor) } else { Err(String::from("expected 0.01 to 1000000")) }
}

/// Bits that are others each time: of the clock.
#[cfg(feature = "live")]
pub(crate) fn clock_bits() -> u32 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    // (a session and a switching-on are told apart by them, no more: the millisecond does)
    u32::try_from(since.unwrap_or_default().as_millis() & 0xffff_ffff).unwrap_or(1)
}
