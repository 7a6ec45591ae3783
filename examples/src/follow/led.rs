//! [`Led`]: a machine on its port, which goes where it is led and says when it is there.

use super::command::FollowCommand;
use plotter_motion::{Machine, Point};

#[cfg(feature = "live")]
use {
    clap::ValueEnum as _,
    plotter_replay::cli::{LedMachine, LedPort, Protocol},
    plotter_replay::live::Command,
    std::io,
};

/// What `--live` has for a machine that is simulated in this program.
#[cfg(feature = "live")]
const SIMULATED: &str = "simulated";

/// A machine on its port.
#[cfg(feature = "live")]
#[derive(Debug)]
pub(super) struct Led(LedMachine);

#[cfg(feature = "live")]
impl Led {
    /// What is wrong with the options for it.
    pub(super) fn misused(arguments: &FollowCommand) -> Option<String> {
        let error = Protocol::from_str(&arguments.protocol, true).err()?;
        let known: Vec<String> = Protocol::value_variants()
            .iter()
            .filter_map(|protocol| Some(protocol.to_possible_value()?.get_name().to_owned()))
            .collect();
        Some(format!("--protocol {}: {error}; known are {}", arguments.protocol, known.join(", ")))
    }

    /// Opens the port and waits until the machine is heard; nothing moves. Ctrl-C stops it from then on.
    ///
    /// # Errors
    ///
    /// The port's, or that no machine is heard.
    pub(super) fn open(machine: &Machine, port: &str, arguments: &FollowCommand) -> Result<Self, String> {
        let led = LedPort {
            port: Some(port).filter(|port| *port != SIMULATED),
            protocol: Protocol::from_str(&arguments.protocol, true)?,
            speed: arguments.speed,
            log: &arguments.log,
        };
        let led = LedMachine::open(machine, led, &mut io::stderr())?;
        let session = led.session().clone();
        // Where it cannot be caught, the machine's own switch is left.
        let _ = ctrlc::set_handler(move || session.command(Command::Stop));
        Ok(Self(led))
    }

    /// Goes to a place with the tool lifted; where the machine then says to be.
    pub(super) fn go(&self, to: Point) -> Result<Point, String> {
        self.0.go(to).map_err(|error| error.to_string())
    }

    /// Draws through these places, from the first to the last.
    pub(super) fn draw(&self, places: &[Point], speed_mm_s: f64) -> Result<(), String> {
        let [from, on @ ..] = places else { return Ok(()) };
        let drawn = self.0.go(*from).and_then(|_| self.0.draw_through(on, speed_mm_s));
        drawn.map(drop).map_err(|error| {
            self.0.stop(); // with the tool at work
            error.to_string()
        })
    }
}

/// None: the program was built without.
#[cfg(not(feature = "live"))]
#[derive(Debug)]
pub(super) enum Led {}

#[cfg(not(feature = "live"))]
impl Led {
    pub(super) fn misused(_: &FollowCommand) -> Option<String> {
        Some(String::from("--live needs a build with --features live"))
    }

    pub(super) fn open(_: &Machine, _: &str, arguments: &FollowCommand) -> Result<Self, String> {
        Err(Self::misused(arguments).unwrap_or_default())
    }

    pub(super) fn go(&self, _: Point) -> Result<Point, String> {
        match *self {}
    }

    pub(super) fn draw(&self, _: &[Point], _: f64) -> Result<(), String> {
        match *self {}
    }
}
