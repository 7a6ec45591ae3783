//! Reads the machines' TOML files on the host, with the checks of `plotter-motion`, and writes what the
//! firmwares need of them as constants. So neither a parser nor a check is in their program memory.

use plotter_motion::control::{ContouringSettings, LineTrackingSettings};
use plotter_motion::firmware::GantrySettings;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::gcode::PenConvention;
use plotter_motion::{
    Machine,
    config::{AxisConfig, ControllerChoice, MachineKind},
};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let board = if env::var_os("CARGO_FEATURE_BOARD_STM32F411").is_some() { "stm32f411" } else { "qemu" };
    fs::copy(format!("memory/{board}.x"), out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed=memory/{board}.x");
    println!("cargo:rerun-if-changed=build.rs");

    // Another machine: GANTRY=../my-gantry.toml, STEPPER_PLOTTER=../my-plotter.toml
    let gantry = machine("GANTRY", "../machines/semi-virtual-gantry.toml", MachineKind::Gantry)?;
    let plotter = machine("STEPPER_PLOTTER", "../machines/stepper-plotter.toml", MachineKind::Steppers)?;
    let mut text = String::new();
    gantry_constants(&gantry, &mut text)?;
    plotter_constants(&plotter, &mut text)?;
    fs::write(out.join("machine.rs"), text)?;
    Ok(())
}

fn machine(variable: &str, default: &str, kind: MachineKind) -> Result<Machine, Box<dyn Error>> {
    println!("cargo:rerun-if-env-changed={variable}");
    let path = env::var(variable).unwrap_or_else(|_| default.to_owned());
    println!("cargo:rerun-if-changed={path}");
    let text = fs::read_to_string(Path::new(&path)).map_err(|error| format!("{path}: {error}"))?;
    let machine = Machine::from_toml(&text).map_err(|error| format!("{path}: {error}"))?;
    machine.require(kind, "this firmware").map_err(|error| format!("{path}: {error}"))?;
    Ok(machine)
}

/// Floats are written as Rust's shortest text that reads as the same bits; a plain struct's `Debug` text is
/// its own Rust.
fn gantry_constants(machine: &Machine, text: &mut String) -> Result<(), Box<dyn Error>> {
    let config = machine.config();
    writeln!(
        text,
        "use plotter_motion::control::{{Contouring, ContouringSettings, LineTracking, LineTrackingSettings}};"
    )?;
    writeln!(text, "use plotter_motion::control::{{PositionGains, ShaftModel, ShaftSettings}};")?;
    writeln!(text, "use plotter_motion::firmware::GantrySettings;")?;
    writeln!(
        text,
        "use plotter_motion::{{MotionLimits, config::{{AxisConfig, Decoding, EncoderConfig, LoadConfig, MotorConfig, TransmissionConfig}}}};"
    )?;
    writeln!(
        text,
        "use plotter_motion::{{SafetyGate, StepPoint, config::{{PublishedConfig, StepperConfig}}, control::SyncStop}};"
    )?;
    writeln!(text, "/// Bits a second of the gantry's line.\npub const BAUD: u32 = {};", config.serial.baud)?;
    writeln!(
        text,
        "/// Steps of the PWM, x and y.\npub const PWM_STEPS: [u16; 2] = [{}, {}];",
        u16::try_from(config.x.motor.pwm_steps)?,
        u16::try_from(config.y.motor.pwm_steps)?
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
    writeln!(text, "const GANTRY: GantrySettings = {:?};", GantrySettings::of(machine))?;
    let name = match config.control.controller {
        ControllerChoice::Published => {
            writeln!(text, "const LINE: LineTrackingSettings = {:?};", LineTrackingSettings::of(machine))?;
            "LineTracking"
        }
        _ => {
            let settings = format!("{:?}", ContouringSettings::of(machine))
                .replace("decoding: ", "decoding: Decoding::");
            if settings.contains("CoastingBridge") {
                writeln!(text, "use plotter_motion::control::CoastingBridge;")?;
            }
            writeln!(text, "const LINE: ContouringSettings = {settings};")?;
            "Contouring"
        }
    };
    writeln!(
        text,
        "/// The gantry's controller.\npub type Gantry = plotter_motion::firmware::Gantry<{name}>;"
    )?;
    writeln!(text, "/// The gantry's controller, at rest at the origin.")?;
    writeln!(
        text,
        "#[must_use]\npub fn gantry(gate: SafetyGate) -> Gantry {{\n    Gantry::with_settings(GANTRY, {name}::with_settings(LINE), gate)\n}}"
    )?;
    Ok(())
}

fn axis_literal(axis: &AxisConfig) -> String {
    format!("{axis:?}").replace("decoding: ", "decoding: Decoding::")
}

/// The same for the stepper plotter, which speaks Grbl's language.
fn plotter_constants(machine: &Machine, text: &mut String) -> Result<(), Box<dyn Error>> {
    let settings = StepperPlotterSettings::of(machine, Dialect::Grbl);
    writeln!(text, "use core::time::Duration;")?;
    writeln!(
        text,
        "use plotter_motion::firmware::stepper_plotter::{{AnyPen, CheckedSettings, Dialect, Grbl, SpindlePen, StepperPlotterSettings, StoredSettings}};"
    )?;
    writeln!(text, "use plotter_motion::gcode::{{LaserCommand, PenConvention, ServoCommand}};")?;
    writeln!(text, "use plotter_motion::kinematics::Backlash;")?;
    writeln!(
        text,
        "use plotter_motion::{{PathMode, PlannerSettings, homing::HomingAxis, planner::AccelLimit}};"
    )?;
    let baud = machine.config().serial.baud;
    writeln!(
        text,
        "/// Bits a second of the stepper plotter's line.\npub const PLOTTER_BAUD: u32 = {baud};"
    )?;
    let mut literal = format!("{settings:?}");
    for (name, duration) in [("pen_settle", settings.pen_settle), ("gather", settings.gather)] {
        let nanos = duration.as_nanos();
        literal = literal
            .replace(&format!("{name}: {duration:?}"), &format!("{name}: Duration::from_nanos({nanos})"));
    }
    for (field, name) in [
        ("dialect", "Dialect"),
        ("path", "PathMode"),
        ("accel_limit", "AccelLimit"),
        ("pen", "PenConvention"),
        ("command", "LaserCommand"),
    ] {
        literal = literal.replace(&format!(" {field}: "), &format!(" {field}: {name}::"));
    }
    writeln!(
        text,
        "/// The stepper plotter's settings.\npub const PLOTTER: StepperPlotterSettings = {literal};"
    )?;
    writeln!(
        text,
        "/// Whether a laser takes the place of its pen.\npub const LASER: bool = {};",
        settings.laser
    )?;
    let modes = match (settings.is_plain(), settings.laser) {
        (true, false) => "ExactPen",
        (true, true) => "ExactOnly",
        (false, _) => "AllModes",
    };
    let pens =
        if settings.pen == PenConvention::Spindle && !settings.laser { "SpindlePen" } else { "AnyPen" };
    writeln!(
        text,
        "/// The stepper plotter's controller, with what its settings need.\npub type StepperPlotter = \
         plotter_motion::firmware::StepperPlotter<Grbl<{pens}>, plotter_motion::planner::{modes}>;"
    )?;
    writeln!(
        text,
        "/// The same, looked at by the compiler.\npub static CHECKED_PLOTTER: CheckedSettings<plotter_motion::planner::{modes}> = \
         match PLOTTER.checked() {{ Ok(checked) => checked, Err(_) => panic!(\"no machine can be driven with them\") }};"
    )?;
    Ok(())
}
