//! Constants that a build script writes for a firmware: compiled here, they equal the machine's file.
//!
//! The texts lie in `tests/data/machine_constants`; `UPDATE_GOLDEN=1` writes them anew.

use plotter_motion::config::{
    AccelChoice, ControllerChoice, JerkChoice, PathChoice, PenLift, SecondMotorChoice,
};
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::{LimitSwitches, Machine, MachineConfig, SafetyGate, build, control, firmware};

#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod contouring {
    include!("../data/machine_constants/contouring.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod published {
    include!("../data/machine_constants/published.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod plain {
    include!("../data/machine_constants/plain.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod smooth {
    include!("../data/machine_constants/smooth.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod averaged {
    include!("../data/machine_constants/averaged.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod height {
    include!("../data/machine_constants/height.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod three {
    include!("../data/machine_constants/three.rs");
}
#[allow(dead_code, unreachable_pub, reason = "a firmware uses it all")]
mod mdraw {
    include!("../data/machine_constants/mdraw.rs");
}

fn machine(config: MachineConfig, change: impl FnOnce(&mut MachineConfig)) -> Machine {
    let mut config = config;
    change(&mut config);
    Machine::new(config).unwrap()
}

/// Steppers in every mode: within a tolerance, with a limited jerk, each axis its own limit, with play and a
/// laser.
fn every_mode() -> Machine {
    machine(MachineConfig::stepper_plotter(), |config| {
        config.steppers_mut().unwrap().planner.mode = PathChoice::Tolerance;
        config.steppers_mut().unwrap().planner.s_curve = true;
        config.steppers_mut().unwrap().planner.jerk_limit = Some(JerkChoice::Path);
        config.steppers_mut().unwrap().planner.accel_limit = AccelChoice::Axes;
        config.steppers_mut().unwrap().x.backlash_mm = 0.1;
        config.steppers_mut().unwrap().y.inverted = true;
        config.steppers_mut().unwrap().laser.enabled = true;
    })
}

/// With the jerk limited as a vector.
fn averaged() -> Machine {
    machine(MachineConfig::stepper_plotter(), |config| {
        config.steppers_mut().unwrap().planner.mode = PathChoice::Tolerance;
        config.steppers_mut().unwrap().planner.s_curve = true;
    })
}

/// With a third axis that is homed, and two motors on y.
fn three_axes() -> Machine {
    machine(MachineConfig::stepper_plotter(), |config| {
        (
            config.steppers_mut().unwrap().z.enabled,
            config.steppers_mut().unwrap().z.homes,
            config.steppers_mut().unwrap().z.lifts_pen,
        ) = (true, true, true);
        (
            config.steppers_mut().unwrap().second_motor.axis,
            config.steppers_mut().unwrap().second_motor.offset_mm,
        ) = (SecondMotorChoice::Y, -0.5);
    })
}

fn lifted_by_height() -> Machine {
    machine(MachineConfig::stepper_plotter(), |config| {
        config.steppers_mut().unwrap().pen.lifted_by = PenLift::Height
    })
}

#[track_caller]
fn is_golden(name: &str, text: &str) {
    let path = format!("{}/tests/data/machine_constants/{name}.rs", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, text).unwrap();
    }
    assert_eq!(text, std::fs::read_to_string(&path).unwrap(), "{path}: UPDATE_GOLDEN=1 writes it anew");
}

fn is_settings_of(name: &str, machine: &Machine, dialect: Dialect, settings: &StepperPlotterSettings) {
    is_golden(name, &build::stepper_plotter(machine, dialect).unwrap());
    let expected = StepperPlotterSettings::of(machine, dialect).with_third_motor_of(machine);
    assert_eq!(*settings, expected, "{name}");
}

#[test]
fn a_gantry_is_what_its_file_says() {
    let machine = machine(MachineConfig::default(), |config| {
        config.dc_mut().unwrap().control.controller = ControllerChoice::Contouring
    });
    let config = machine.config();
    is_golden("contouring", &build::gantry(&machine).unwrap());
    assert_eq!(
        (contouring::gantry::X, contouring::gantry::Y),
        (config.dc().unwrap().x, config.dc().unwrap().y)
    );
    assert_eq!(
        contouring::gantry::DECODING,
        [config.dc().unwrap().x.encoder.decoding, config.dc().unwrap().y.encoder.decoding]
    );
    assert_eq!(
        contouring::gantry::PWM_STEPS.map(u32::from),
        [config.dc().unwrap().x.motor.pwm_steps, config.dc().unwrap().y.motor.pwm_steps]
    );
    assert_eq!(contouring::gantry::BAUD, config.serial.baud);
    let gate = || SafetyGate::new(LimitSwitches::RELEASED, false);
    let settings = firmware::GantrySettings::of(&machine);
    let controller = control::Contouring::with_settings(control::ContouringSettings::of(&machine));
    let expected = firmware::Gantry::with_settings(settings, controller, gate());
    assert_eq!(contouring::gantry::gantry(gate()), expected);
}

#[test]
fn the_published_controller_is_the_one_that_the_file_names() {
    let machine = machine(MachineConfig::default(), |config| {
        config.dc_mut().unwrap().control.controller = ControllerChoice::Published
    });
    is_golden("published", &build::gantry(&machine).unwrap());
    let gate = || SafetyGate::new(LimitSwitches::RELEASED, false);
    let controller = control::LineTracking::with_settings(control::LineTrackingSettings::of(&machine));
    let settings = firmware::GantrySettings::of(&machine);
    let expected = firmware::Gantry::with_settings(settings, controller, gate());
    assert_eq!(published::gantry::gantry(gate()), expected);
}

#[test]
fn a_stepper_plotter_is_what_its_file_says_in_every_mode() {
    let documented = Machine::new(MachineConfig::stepper_plotter()).unwrap();
    is_settings_of("plain", &documented, Dialect::Grbl, &plain::stepper_plotter::SETTINGS);
    is_settings_of("smooth", &every_mode(), Dialect::Grbl, &smooth::stepper_plotter::SETTINGS);
    is_settings_of("averaged", &averaged(), Dialect::Grbl, &averaged::stepper_plotter::SETTINGS);
    is_settings_of("height", &lifted_by_height(), Dialect::Grbl, &height::stepper_plotter::SETTINGS);
    is_settings_of("mdraw", &documented, Dialect::MDraw, &mdraw::stepper_plotter::SETTINGS);
    is_settings_of("three", &three_axes(), Dialect::Grbl, &three::stepper_plotter::SETTINGS);
    assert_eq!(three::stepper_plotter::SETTINGS.second.unwrap().offset_steps, -44); // 0.5 mm of 87.58
    const { assert!(smooth::stepper_plotter::LASER && !plain::stepper_plotter::LASER) };
    // The types can be made of them.
    let gate = || SafetyGate::new(LimitSwitches::RELEASED, false);
    assert!(
        plain::stepper_plotter::StepperPlotter::from_checked(&plain::stepper_plotter::CHECKED, gate())
            .is_ok()
    );
    assert!(
        smooth::stepper_plotter::StepperPlotter::from_checked(&smooth::stepper_plotter::CHECKED, gate())
            .is_ok()
    );
    assert!(
        averaged::stepper_plotter::StepperPlotter::from_checked(&averaged::stepper_plotter::CHECKED, gate())
            .is_ok()
    );
    assert!(
        height::stepper_plotter::StepperPlotter::from_checked(&height::stepper_plotter::CHECKED, gate())
            .is_ok()
    );
    assert!(
        three::stepper_plotter::StepperPlotter::from_checked(&three::stepper_plotter::CHECKED, gate())
            .is_ok()
    );
    assert!(
        mdraw::stepper_plotter::StepperPlotter::from_checked(&mdraw::stepper_plotter::CHECKED, gate())
            .is_ok()
    );
}

#[test]
fn a_file_that_is_wrong_is_named_with_what_is_wrong() {
    let folder = tempfile_path();
    let path = folder.to_str().unwrap();
    std::fs::write(&folder, "schema = 1\nkind = 7\n").unwrap();
    let error = build::machine("PLOTTER_NO_SUCH_VARIABLE", path, plotter_motion::config::MachineKind::Gantry);
    std::fs::remove_file(&folder).unwrap();
    let error = error.unwrap_err();
    assert_eq!(error.path, path);
    assert!(error.to_string().starts_with(path) && error.problem.contains("line 2"), "{error}");
    let missing =
        build::machine("PLOTTER_NO_SUCH_VARIABLE", path, plotter_motion::config::MachineKind::Gantry);
    assert!(missing.unwrap_err().to_string().starts_with(path));
}

fn tempfile_path() -> std::path::PathBuf {
    std::env::temp_dir().join(format!("plotter-build-{}.toml", std::process::id()))
}
