//! The plot itself: on a simulated machine or with a firmware, recorded; and the recording on the virtual
//! plotter.

use super::command::{EMULATED, LinkArg, PlotCommand, controller_name};
use crate::machine::{
    BenchSwitches, PlotOutcome, Recorded, board_header, built_firmware, plot_in_emulator, simulate,
    simulate_board,
};
use crate::plot::{PortLanguage, plot_on_port};
use crate::shared::{WorkShown, at};
use plotter_motion::config::DcConfig;
use plotter_motion::{Machine, PenMove, config::MachineKind};
use plotter_replay::{BenchRecorder, PlotterSettings, VirtualPlotter, log, log::Header};
use std::path::Path;

/// Plots on the simulated machine, or with a firmware, and records the serial line.
pub(super) fn record(
    args: &PlotCommand,
    machine: &Machine,
    moves: Vec<PenMove>,
    path: &Path,
) -> Result<PlotOutcome, String> {
    let config = machine.config();
    let is_real = args.firmware.as_ref().is_some_and(|firmware| firmware != EMULATED);
    let is_belt = machine.kind() == MachineKind::Belt;
    let may_be_linked = is_real && args.link == LinkArg::Auto;
    let header = if is_belt { board_header(machine) } else { line_header(machine, may_be_linked) };
    let header = header
        .with_text("machine", config.name.as_str())
        .with_text("controller", controller_name(machine))
        .with_text("clock", if is_real { "host" } else { "simulated" });
    let writer = log::create(path, &header).map_err(|error| at(path, &error))?;
    let bar = WorkShown::of(args.telling, "plotting", moves.len() as u64, "targets");
    let mut recorder = BenchRecorder::new(writer);
    let recorded = Recorded { drive: args.record_drive };
    let progress = |reached: u32| bar.set(reached.into());
    let outcome = match args.firmware.as_deref() {
        None if is_belt => Ok(simulate_board(machine, moves, recorded, &mut recorder, progress)),
        None => Ok(simulate(machine, moves, recorded, &mut recorder, progress)),
        Some(EMULATED) => {
            let elf = args.elf.clone().unwrap_or_else(|| built_firmware("gantry"));
            let switches = BenchSwitches::default();
            plot_in_emulator(machine, &elf, switches, moves, recorded, &mut recorder, progress)
        }
        Some(port) => {
            let language =
                if may_be_linked { PortLanguage::Link(clock_bits()) } else { PortLanguage::Digits };
            plot_on_port(machine, port, language, moves, &mut recorder, progress)
        }
    };
    bar.finish();
    let outcome = outcome?;
    recorder.finish().map_err(|error| at(path, &error))?;
    Ok(outcome)
}

/// Bits that are others each time.
fn clock_bits() -> u16 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    u16::try_from(since.as_millis() & 0xffff).unwrap_or(1)
}

/// What a log says of its line: that of the published protocol, or of the reliable link.
fn line_header(machine: &Machine, may_be_linked: bool) -> Header {
    let config = machine.config();
    let dc = DcConfig::of(machine);
    Header::new()
        .with_number("baud", config.serial.baud.into())
        .with_text("protocol", if may_be_linked { "link" } else { "digits" })
        .with_decimal("x_mm_per_pulse", 1.0 / dc.x.counts_per_mm)
        .with_decimal("y_mm_per_pulse", 1.0 / dc.y.counts_per_mm)
}

/// Draws on the virtual plotter what a recording says.
pub(super) fn replay(path: &Path) -> Result<VirtualPlotter, String> {
    let mut reader = log::open(path).map_err(|error| at(path, &error))?;
    let settings = PlotterSettings::from_header(reader.header()).map_err(|error| at(path, &error))?;
    let mut plotter = VirtualPlotter::new(settings);
    for record in &mut reader {
        plotter.push(&record.map_err(|damage| at(path, &damage))?);
    }
    plotter.finish();
    Ok(plotter)
}
