//! [`gantry`]: a machine with DC motors as constants.

use super::{ALLOWED, literal};
use crate::Machine;
use crate::config::DcConfig;
use crate::config::{AxisConfig, ControllerChoice};
use crate::control::{ContouringSettings, LineTrackingSettings};
use crate::firmware::GantrySettings;
use alloc::string::String;
use core::fmt::{self, Write as _};

/// A module `gantry` for a firmware: `BAUD`, `PWM_STEPS` and `DECODING` of both axes, the axes `X` and `Y`
/// for those who simulate them, the type `Gantry` with the controller that the file names, and a function
/// `gantry` that makes it.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, build};
/// let text = build::gantry(&Machine::new(MachineConfig::default())?)?;
/// assert!(text.contains("pub const BAUD: u32 = 256000;"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// None but those of memory, as with `write!`.
pub fn gantry(machine: &Machine) -> Result<String, fmt::Error> {
    let (baud, config) = (machine.config().serial.baud, DcConfig::of(machine));
    let mut text = String::new();
    writeln!(text, "/// A gantry with DC motors, from its file.\n{ALLOWED}pub mod gantry {{")?;
    writeln!(text, "use plotter_motion::config::*;\nuse plotter_motion::control::*;")?;
    writeln!(text, "use plotter_motion::firmware::GantrySettings;")?;
    writeln!(text, "use plotter_motion::{{MotionLimits, SafetyGate, StepPoint}};")?;
    writeln!(text, "/// Bits a second of its line.\npub const BAUD: u32 = {};", baud)?;
    writeln!(
        text,
        "/// Steps of the PWM, x and y.\npub const PWM_STEPS: [u16; 2] = [{}, {}];",
        config.x.motor.pwm_steps, config.y.motor.pwm_steps
    )?;
    writeln!(
        text,
        "/// How the encoders are counted, x and y.\npub const DECODING: [Decoding; 2] = [Decoding::{:?}, Decoding::{:?}];",
        config.x.encoder.decoding, config.y.encoder.decoding
    )?;
    for (name, axis) in [("X", &config.x), ("Y", &config.y)] {
        writeln!(
            text,
            "/// The axis, for those who simulate it.\npub const {name}: AxisConfig = {};",
            axis_literal(axis)
        )?;
    }
    writeln!(text, "const GANTRY: GantrySettings = {};", literal(&GantrySettings::of(machine), &[]))?;
    let name = match config.control.controller {
        ControllerChoice::Published => {
            let settings = literal(&LineTrackingSettings::of(machine), &[]);
            writeln!(text, "const LINE: LineTrackingSettings = {settings};")?;
            "LineTracking"
        }
        _ => {
            let settings = literal(&ContouringSettings::of(machine), &[("decoding", "Decoding")]);
            writeln!(text, "const LINE: ContouringSettings = {settings};")?;
            "Contouring"
        }
    };
    writeln!(text, "/// Its controller.\npub type Gantry = plotter_motion::firmware::Gantry<{name}>;")?;
    writeln!(text, "/// Its controller, at rest at the origin.\n#[must_use]")?;
    writeln!(text, "pub fn gantry(gate: SafetyGate) -> Gantry {{")?;
    writeln!(text, "Gantry::with_settings(GANTRY, {name}::with_settings(LINE), gate)\n}}\n}}")?;
    Ok(text)
}

fn axis_literal(axis: &AxisConfig) -> String {
    literal(axis, &[("decoding", "Decoding")])
}
