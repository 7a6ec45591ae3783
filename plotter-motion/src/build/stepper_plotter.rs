//! [`stepper_plotter`]: a machine with stepper motors as constants.

use super::{ALLOWED, literal};
use crate::Machine;
use crate::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use crate::gcode::PenConvention;
use alloc::format;
use alloc::string::String;
use core::fmt::{self, Write as _};

/// A module `stepper_plotter` for a firmware: `BAUD`, `SETTINGS`, whether a `LASER` takes the place of the
/// pen, the type `StepperPlotter` with no more in it than these settings need, and `CHECKED`, the settings
/// looked at by the compiler.
///
/// ```
/// # use plotter_motion::firmware::stepper_plotter::Dialect;
/// # use plotter_motion::{Machine, MachineConfig, build};
/// let text = build::stepper_plotter(&Machine::new(MachineConfig::stepper_plotter())?, Dialect::Grbl)?;
/// assert!(text.contains("pub type StepperPlotter"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// None but those of memory, as with `write!`.
pub fn stepper_plotter(machine: &Machine, dialect: Dialect) -> Result<String, fmt::Error> {
    let settings = StepperPlotterSettings::of(machine, dialect).with_third_motor_of(machine);
    let has_third = settings.z.is_some() || settings.second.is_some();
    let mut text = String::new();
    writeln!(text, "/// A plotter with stepper motors, from its file.\n{ALLOWED}pub mod stepper_plotter {{")?;
    writeln!(text, "use core::time::Duration;\nuse plotter_motion::firmware::stepper_plotter::*;")?;
    writeln!(text, "use plotter_motion::gcode::{{LaserCommand, PenConvention, ServoCommand}};")?;
    writeln!(text, "use plotter_motion::homing::HomingAxis;\nuse plotter_motion::kinematics::Backlash;")?;
    writeln!(text, "use plotter_motion::planner::{{self, AccelLimit}};")?;
    writeln!(text, "use plotter_motion::{{PathMode, PlannerSettings}};")?;
    if has_third {
        writeln!(text, "use plotter_motion::Axis;")?;
    }
    writeln!(
        text,
        "/// Bits a second of its line.\npub const BAUD: u32 = {};",
        machine.config().serial.baud
    )?;
    writeln!(
        text,
        "/// Its settings.\npub const SETTINGS: StepperPlotterSettings = {};",
        constant(&settings)
    )?;
    writeln!(
        text,
        "/// Whether a laser takes the place of its pen.\npub const LASER: bool = {};",
        settings.laser
    )?;
    let modes = match (settings.is_plain(), settings.laser) {
        _ if has_third => "ThreeAxes",
        (true, false) => "ExactPen",
        (true, true) => "ExactOnly",
        (false, _) => "AllModes",
    };
    let pens = match settings.pen {
        PenConvention::Spindle if !settings.laser && !has_third => "SpindlePen",
        _ => "AnyPen",
    };
    let host = match dialect {
        Dialect::Grbl => format!("Grbl<{pens}>"),
        Dialect::MDraw => "MDraw".into(),
    };
    writeln!(text, "/// Its controller, with what its settings need.")?;
    writeln!(
        text,
        "pub type StepperPlotter = plotter_motion::firmware::StepperPlotter<{host}, planner::{modes}>;"
    )?;
    writeln!(text, "/// The same settings, looked at by the compiler.")?;
    writeln!(text, "pub static CHECKED: CheckedSettings<planner::{modes}> = match SETTINGS.checked() {{")?;
    writeln!(
        text,
        "Ok(checked) => checked,\nErr(_) => panic!(\"no machine can be driven with them\"),\n}};\n}}"
    )?;
    Ok(text)
}

fn constant(settings: &StepperPlotterSettings) -> String {
    let mut text = literal(
        settings,
        &[
            ("dialect", "Dialect"),
            ("path", "PathMode"),
            ("accel_limit", "AccelLimit"),
            ("pen", "PenConvention"),
            ("command", "LaserCommand"),
            ("axis", "Axis"),
        ],
    );
    for (name, duration) in [("pen_settle", settings.pen_settle), ("gather", settings.gather)] {
        let nanos = duration.as_nanos();
        text =
            text.replace(&format!("{name}: {duration:?}"), &format!("{name}: Duration::from_nanos({nanos})"));
    }
    // A firmware is built without the field that says what the jerk's limit limits, or with it.
    let limit = format!("{:?}", settings.planner.jerk_limit);
    text = text
        .replace(
            "planner: PlannerSettings {",
            &format!("planner: plotter_motion::jerk_limited!({limit} PlannerSettings {{"),
        )
        .replace(&format!(", jerk_limit: {limit} }}"), " })");
    // That of a third axis has no convention.
    text = text
        .replace("pen: PenConvention::Some(", "pen: Some(")
        .replace("pen: PenConvention::None", "pen: None");
    // A firmware with two axes is built without the fields of a third motor, or with them.
    match text.strip_suffix(", z: None, second: None }") {
        Some(fields) => format!("plotter_motion::two_axes!({fields} }})"),
        None => text,
    }
}
