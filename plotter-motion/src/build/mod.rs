//! For build scripts: a machine's TOML file as constants for a firmware, feature `build`.
//!
//! ```text
//!  machine.toml ──build::machine──▶ Machine ──gantry, stepper_plotter──▶ text of Rust ──include!──▶ firmware
//!        on the host: read, checked                                       no parser, no check, no alloc
//! ```
//!
//! The build script of a firmware:
//!
//! ```no_run
//! use plotter_motion::build;
//! use plotter_motion::config::MachineKind;
//! use plotter_motion::firmware::stepper_plotter::Dialect;
//!
//! // Another machine: PLOTTER=my-plotter.toml cargo build
//! let machine = build::machine("PLOTTER", "machines/stepper-plotter.toml", MachineKind::Steppers)?;
//! let out = std::env::var("OUT_DIR")?;
//! std::fs::write(format!("{out}/machine.rs"), build::stepper_plotter(&machine, Dialect::Grbl)?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! and the firmware, where the text is a module `stepper_plotter`:
//!
//! ```ignore
//! include!(concat!(env!("OUT_DIR"), "/machine.rs"));
//! let plotter = stepper_plotter::StepperPlotter::from_checked(&stepper_plotter::CHECKED, gate);
//! ```

mod gantry;
mod stepper_plotter;

pub use gantry::gantry;
pub use stepper_plotter::stepper_plotter;

use crate::Machine;
use crate::config::MachineKind;
use alloc::string::{String, ToString as _};
use core::fmt;

/// A machine's file cannot be built into a firmware.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct BuildError {
    /// The file.
    pub path: String,
    /// The fault, and its place.
    pub problem: String,
}

impl fmt::Display for BuildError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path, self.problem)
    }
}

impl core::error::Error for BuildError {}

/// Reads and checks a machine's file in a build script: the one that the environment's `variable` names, else
/// `default`. Tells cargo to build anew when either changes.
///
/// # Errors
///
/// [`BuildError`] names the file, and what is wrong with it, with line, column and remedy.
pub fn machine(variable: &str, default: &str, kind: MachineKind) -> Result<Machine, BuildError> {
    let path = std::env::var(variable).unwrap_or_else(|_| default.into());
    #[expect(clippy::print_stdout, reason = "this is how a build script speaks with cargo")]
    {
        std::println!("cargo:rerun-if-env-changed={variable}");
        std::println!("cargo:rerun-if-changed={path}");
    }
    let failed = |problem: String| BuildError { path: path.clone(), problem };
    let text = std::fs::read_to_string(&path).map_err(|error| failed(error.to_string()))?;
    let machine = Machine::from_toml(&text).map_err(|error| failed(error.to_string()))?;
    machine.require(kind, "this firmware").map_err(|error| failed(error.to_string()))?;
    Ok(machine)
}

/// Lint of what is written: floats stand as their shortest text, and no program uses all of it.
const ALLOWED: &str = "#[allow(unused_imports, clippy::unreadable_literal, clippy::excessive_precision, \
                       clippy::wildcard_imports, reason = \"written by a build script\")]\n";

/// A value as Rust: the `Debug` text of a plain struct, with the path before each variant of an enum that
/// stands in one of `fields`. A float is its shortest text that reads as the same bits.
fn literal(value: &impl fmt::Debug, fields: &[(&str, &str)]) -> String {
    let mut text = alloc::format!("{value:?}");
    for (field, name) in fields {
        text = text.replace(&alloc::format!(" {field}: "), &alloc::format!(" {field}: {name}::"));
    }
    text.replace(": inf", ": f64::INFINITY")
}
