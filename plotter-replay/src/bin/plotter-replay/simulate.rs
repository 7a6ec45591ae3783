//! `simulate`: a machine that is not there, on a pseudo terminal.

use crate::commands::{Done, is_free, say};
use crate::machine::{clock_bits, header_of, read_machine_of};
use clap::Args;
use plotter_motion::{Machine, config::MachineKind};
use plotter_replay::live::{MachineLog, PortLine, SimulatedMachine};
use plotter_replay::log::{self, LogFile};
use plotter_replay::serial::Port;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Which machine.
#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// The machine's description [default: the semi-virtual gantry].
    machine: Option<PathBuf>,
    /// Seconds of the machine in one of ours; the host's patience is in ours.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = crate::machine::speed)]
    speed: f64,
    /// Speak the published digits only, as a machine without the reliable link does.
    #[arg(long)]
    digits: bool,
    /// Record what happens inside it, each edge and duty too, so that `check` can run its controller again to
    /// the same bytes.
    #[arg(short, long, value_name = "LOG")]
    output: Option<PathBuf>,
    /// Write over LOG if it is there.
    #[arg(long, requires = "output")]
    force: bool,
}

impl Simulate {
    /// Does it until the terminal is closed.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let machine = read_machine_of(MachineKind::Gantry, "simulate", self.machine.as_deref())?;
        let boot = (!self.digits).then(clock_bits);
        let simulated = SimulatedMachine::new(&machine, boot).map_err(|error| error.to_string())?;
        let log = self.output.as_deref().map(|path| self.log(path, &machine, boot)).transpose()?;
        let (end, port) = Port::pseudo_terminal().map_err(|error| error.to_string())?;
        say(out, &format!("{} is simulated on {}", machine.config().name, port.name()));
        say(out, &format!("try: plotter-replay live --port {} drawing.hpgl", port.name()));
        let _ = out.flush(); // who closed it has seen enough: the machine goes on
        let line = PortLine::new(end).map_err(|error| error.to_string())?;
        let error = match &log {
            Some(log) => simulated.logged(log.clone()).serve(&line, self.speed),
            None => simulated.serve(&line, self.speed),
        };
        drop(port); // kept open until here: a program that closes its end must not hang up the machine
        if let (Some(log), Some(path)) = (log, &self.output) {
            log.finish().map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Err(error.to_string())
    }

    fn log(&self, path: &Path, machine: &Machine, boot: Option<u32>) -> Result<MachineLog<LogFile>, String> {
        is_free(path, self.force)?;
        let header = header_of(machine, if self.digits { "digits" } else { "link" }, boot)
            .with_text("clock", "simulated");
        let writer = log::create(path, &header).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(MachineLog::new(writer))
    }
}
