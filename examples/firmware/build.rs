//! The machines' TOML files as constants, by `plotter_motion::build`: so neither a parser nor a check is in
//! the firmwares' program memory.

use plotter_motion::build;
use plotter_motion::config::MachineKind;
use plotter_motion::firmware::stepper_plotter::Dialect;
use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let board = if env::var_os("CARGO_FEATURE_BOARD_STM32F411").is_some() { "stm32f411" } else { "qemu" };
    fs::copy(format!("memory/{board}.x"), out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed=memory/{board}.x");
    println!("cargo:rerun-if-changed=build.rs");

    // Another machine: GANTRY=../my-gantry.toml, STEPPER_PLOTTER=../my-plotter.toml
    let gantry = build::machine("GANTRY", "../machines/semi-virtual-gantry.toml", MachineKind::Gantry)?;
    let plotter =
        build::machine("STEPPER_PLOTTER", "../machines/stepper-plotter.toml", MachineKind::Steppers)?;
    let text = build::gantry(&gantry)? + &build::stepper_plotter(&plotter, Dialect::Grbl)?;
    fs::write(out.join("machine.rs"), text)?;
    Ok(())
}
