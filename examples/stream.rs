//! The same steps on the desk and in the firmware.
//!
//! G-code is streamed to the stepper plotter's controller, once as it runs on this computer and once in its
//! firmware on an emulated Cortex-M4. Each step's time and direction goes into a checksum. Both must be the
//! same: then what is planned and simulated here is what the board does.
//!
//! Look at the last column. Build the firmware first: see examples/firmware/README.md.

use clap::Parser;
use core::f64::consts::TAU;
use core::time::Duration;
use plotter_examples::machine::{
    BenchSwitches, StreamedSteps, built_firmware, streamed_in_emulator, streamed_on_the_desk,
};
use plotter_examples::shared::{at, print, read_file, run};
use plotter_motion::{Machine, MachineConfig, StepPoint, config::MachineKind};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Compares the steps of the stepper plotter's firmware with those of its controller on the desk.
#[derive(Parser)]
#[command(
    name = "stream",
    after_help = "Examples:\n  cargo run --release --example stream\n  \
                  cargo run --release --example stream -- drawing.gcode"
)]
struct Args {
    /// G-code as programs stream it to Grbl; without any, a spiral, a hatch and a clover
    files: Vec<PathBuf>,
    /// The machine's TOML file, the same that the firmware was built with [default: the stepper plotter]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// The firmware [default: the stepper plotter's, as built in examples/firmware]
    #[arg(long, value_name = "ELF")]
    elf: Option<PathBuf>,
}

fn main() -> ExitCode {
    run("stream", || stream(&Args::parse()))
}

fn stream(args: &Args) -> Result<(), String> {
    let machine = match &args.machine {
        Some(path) => {
            let text = String::from_utf8(read_file(path)?).map_err(|error| at(path, &error))?;
            let machine = Machine::from_toml(&text).map_err(|error| at(path, &error))?;
            machine.require(MachineKind::Steppers, "stream").map_err(|error| at(path, &error))?;
            machine
        }
        None => Machine::new(MachineConfig::stepper_plotter()).map_err(|error| error.to_string())?,
    };
    let mut drawings = vec![("spiral", spiral()), ("hatch", hatch()), ("clover", clover())]
        .into_iter()
        .map(|(name, text)| (name.to_owned(), text))
        .collect::<Vec<_>>();
    if !args.files.is_empty() {
        drawings.clear();
        for path in &args.files {
            let text = String::from_utf8_lossy(&read_file(path)?).into_owned();
            drawings.push((path.display().to_string(), text));
        }
    }
    let elf = args.elf.clone().unwrap_or_else(|| built_firmware("stepper_plotter"));
    let mut table = format!("{:20} {:>8}  {:16}  {:16}\n", "drawing", "steps", "desk", "firmware");
    let mut different = 0;
    for (name, gcode) in &drawings {
        let firmware = streamed_in_emulator(&machine, &elf, BenchSwitches::default(), gcode)?;
        // The firmware looks at its switches first: the controller's time begins a byte before its first word
        // is through.
        let byte = Duration::from_micros(10_000_000_u64.div_ceil(machine.config().serial.baud.into()));
        let desk = streamed_on_the_desk(&machine, firmware.first_byte.saturating_sub(byte), gcode)?;
        if desk.steps == 0 || !desk.refused.is_empty() {
            return Err(format!("{name}: {} steps; the controller refused {:?}", desk.steps, desk.refused));
        }
        let key = |made: &StreamedSteps| (made.steps, made.crc, made.position, made.refused.clone());
        different += u32::from(key(&desk) != key(&firmware));
        let _ = writeln!(table, "{name:20} {:>8}  {:016x}  {:016x}", desk.steps, desk.crc, firmware.crc);
        if key(&desk) != key(&firmware) {
            let StepPoint { x, y } = firmware.position;
            let _ = writeln!(
                table,
                "  the firmware made {} steps, to ({x}, {y}); {:?}",
                firmware.steps, firmware.refused
            );
        }
    }
    print(&table)?;
    if different > 0 {
        return Err(format!("{different} of {} drawings have other steps in the firmware", drawings.len()));
    }
    Ok(())
}

/// An Archimedean spiral of short lines: the look-ahead is never empty.
fn spiral() -> String {
    let mut text = String::from("G21 G90\nF2400\n");
    for index in 0..=500_u32 {
        let turned = f64::from(index) / 100.0;
        let (radius, angle) = (1.0 + 2.0 * turned, TAU * turned);
        let (x, y) = (30.0 + radius * angle.cos(), 30.0 + radius * angle.sin());
        let _ = writeln!(text, "{}X{x:.3}Y{y:.3}", if index == 0 { "G0" } else { "G1" });
        if index == 0 {
            text.push_str("M3S90\n");
        }
    }
    text + "M5\nG0X0Y0\n"
}

/// Lines to and fro, the pen lifted between them.
fn hatch() -> String {
    let mut text = String::from("G21 G90\nF2700\n");
    for index in 0..12_u32 {
        let (from, to) = if index % 2 == 0 { (5, 45) } else { (45, 5) };
        let _ = write!(text, "G0X{index}Y{from}\nM3S90\nG1Y{to}\nM5\n");
    }
    text
}

/// Arcs either way, from quarters of a turn to a whole one.
fn clover() -> String {
    let mut text = String::from("G21 G90\nG0X60Y60\nM3S90\nF1800\n");
    for (x, y, i, j) in [(60, 80, 0, 10), (80, 60, 10, -10), (60, 40, -10, -10), (40, 60, -10, 10)] {
        let _ = writeln!(text, "G2X{x}Y{y}I{i}J{j}");
    }
    text + "G3X40Y60I20J0\nM5\nG0X0Y0\n"
}
