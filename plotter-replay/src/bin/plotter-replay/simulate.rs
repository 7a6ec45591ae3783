//! `simulate`: a machine that is not there, on a pseudo terminal.

use crate::commands::{Done, Verdict, say};
use crate::machine::{clock_bits, read_machine};
use clap::Args;
use plotter_replay::live::{PortLine, SimulatedMachine};
use plotter_replay::serial::Port;
use std::io::Write;
use std::path::PathBuf;
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
}

impl Simulate {
    /// Does it until the terminal is closed.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let machine = read_machine(self.machine.as_deref())?;
        let (end, port) = Port::pseudo_terminal().map_err(|error| error.to_string())?;
        say(out, &format!("{} is simulated on {}", machine.config().name, port.name()));
        say(out, &format!("try: plotter-replay live --port {} drawing.hpgl", port.name()));
        let _ = out.flush(); // who closed it has seen enough: the machine goes on
        let line = PortLine::new(end).map_err(|error| error.to_string())?;
        let line = Arc::new(line);
        let simulated = if self.digits {
            SimulatedMachine::of_digits(&machine, line, self.speed)
        } else {
            SimulatedMachine::start(&machine, line, self.speed, clock_bits())
        };
        let error = simulated.wait();
        drop(port); // kept open until here: a program that closes its end must not hang up the machine
        error.map_or(Ok(Verdict::Clean), |error| Err(error.to_string()))
    }
}
