//! The machine that a command line names.

use super::commands::{MOST_MACHINE_BYTES, read_file};
#[cfg(feature = "live")]
use crate::log::Header;
#[cfg(feature = "live")]
use plotter_motion::config::{ControllerChoice, MachineKind};
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

/// The same, if it is of the kind that `user` needs.
///
/// # Errors
///
/// As [`read_machine`], and for a machine of another kind.
#[cfg(feature = "live")]
pub(crate) fn read_machine_of(
    kind: MachineKind,
    user: &'static str,
    path: Option<&Path>,
) -> Result<Machine, String> {
    let machine = read_machine(path)?;
    let place = path.map_or_else(String::new, |path| format!("{}: ", path.display()));
    machine.require(kind, user).map_err(|error| format!("{place}{error}"))?;
    Ok(machine)
}

/// What a log's header says of a machine; `boot` is that of one that is simulated here, and speaks frames.
#[cfg(feature = "live")]
pub(crate) fn header_of(machine: &Machine, protocol: &str, boot: Option<u32>) -> Header {
    let config = machine.config();
    let controller = match config.control.controller {
        ControllerChoice::Published => "published",
        _ => "contouring",
    };
    let header = Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", protocol)
        .with_text("machine", config.name.as_str())
        .with_text("controller", controller)
        .with_decimal("x_mm_per_pulse", 1.0 / config.x.counts_per_mm)
        .with_decimal("y_mm_per_pulse", 1.0 / config.y.counts_per_mm);
    match boot {
        Some(boot) => header.with_number("boot", boot.into()),
        None => header,
    }
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
