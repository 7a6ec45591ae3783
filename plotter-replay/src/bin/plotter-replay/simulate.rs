//! `simulate`: a machine that is not there, on a pseudo terminal.

use crate::commands::{Done, Verdict, is_free, say};
use crate::machine::{clock_bits, header_of, read_machine};
use clap::Args;
use plotter_motion::{DriveChoice, Machine};
use plotter_replay::live::{MachineLog, PortLine, SimulatedMachine};
use plotter_replay::log::{self, LogFile};
use plotter_replay::serial::Port;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Which machine.
#[derive(Debug, Args)]
pub(crate) struct Simulate {
    /// The machine's description [default: the semi-virtual gantry].
    machine: Option<PathBuf>,
    /// Seconds of the machine in one of ours.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = crate::machine::speed)]
    speed: f64,
    /// Speak the published digits only, as a machine without the reliable link does.
    #[arg(long)]
    digits: bool,
    /// Record what happens inside it, each edge and duty too, so that `check` can run its controller again to the same bytes.
    #[arg(short, long, value_name = "LOG")]
    output: Option<PathBuf>,
    /// Write over LOG if it is there.
    #[arg(long, requires = "output")]
    force: bool,
}

impl Simulate {
    /// Does it until the terminal is closed.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let machine = read_machine(self.machine.as_deref())?;
        if machine.config().drive == DriveChoice::Stepper {
            return Err(String::from(
                "this machine has stepper motors (drive = \"stepper\"), and what is simulated here are machines with encoders: give \
                 one with drive = \"dc\"",
            ));
        }
        let boot = (!self.digits).then(clock_bits);
        let log = self.output.as_deref().map(|path| self.log(path, &machine, boot)).transpose()?;
        let (end, port) = Port::pseudo_terminal().map_err(|error| error.to_string())?;
        say(out, &format!("{} is simulated on {}", machine.config().name, port.name()));
        say(out, &format!("try: plotter-replay live --port {} drawing.hpgl", port.name()));
        let _ = out.flush(); // who closed it has seen enough: the machine goes on
        let line = PortLine::new(end).map_err(|error| error.to_string())?;
        let simulated = SimulatedMachine::logged(&machine, Arc::new(line), self.speed, boot, log.clone());
        let error = simulated.wait();
        drop(port); // kept open until here: a program that closes its end must not hang up the machine
        if let (Some(log), Some(path)) = (log, &self.output) {
            log.finish().map_err(|error| format!("{}: {error}", path.display()))?;
        }
        error.map_or(Ok(Verdict::Clean), |error| Err(error.to_string()))
    }

    fn log(&self, path: &Path, machine: &Machine, boot: Option<u32>) -> Result<MachineLog<LogFile>, String> {
        is_free(path, self.force)?;
        let header = header_of(machine, if self.digits { "digits" } else { "link" }, boot)
            .with_text("clock", "simulated");
        let writer = log::create(path, &header).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(MachineLog::new(writer))
    }
}
