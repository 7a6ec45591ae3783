//! `live`: a machine watched and driven while it draws.

use super::commands::Done;
use super::free_log;
use super::live_hosted::{Flow, Protocol};
use super::machine::{read_machine, speed};
use crate::live::LinkChoice;
use clap::{Args, ValueEnum};
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

/// How long a page has for the last of it.
pub(super) const LAST_LOOK: Duration = Duration::from_millis(1_500);

/// How often it is looked whether the machine is stopped.
pub(super) const LOOK_EVERY: Duration = Duration::from_millis(200);

/// What is driven, and what with.
#[derive(Debug, Args)]
pub(crate) struct Live {
    /// The drawing: HPGL, G-code or the thesis' text. Without one, the machine is led by hand.
    pub(super) drawing: Option<PathBuf>,
    /// The serial port of a machine: a name, a part of one that only it has, or `auto` for the only one there
    /// is; or tcp:HOST:PORT for one on a network.
    #[arg(long, value_name = "DEV", conflicts_with = "simulate")]
    pub(super) port: Option<String>,
    /// Simulate the machine of this file instead [default without --port: the semi-virtual gantry].
    #[arg(long, value_name = "MACHINE.toml")]
    pub(super) simulate: Option<PathBuf>,
    /// The description of the machine on the port [default: the semi-virtual gantry].
    #[arg(long, value_name = "MACHINE.toml", conflicts_with = "simulate")]
    pub(super) machine: Option<PathBuf>,
    /// What is spoken with the machine.
    #[arg(long, value_enum, default_value_t)]
    pub(super) link: Link,
    /// What a machine with stepper motors speaks.
    #[arg(long, value_enum, default_value_t)]
    pub(super) protocol: Protocol,
    /// How a pen plotter with HPGL says that it has no room.
    #[arg(long, value_enum, default_value_t)]
    pub(super) flow: Flow,
    /// Baud rate of the line to a machine with stepper motors [default: the machine's; where nothing answers,
    /// the usual ones].
    #[arg(long, value_name = "BITS", value_parser = clap::value_parser!(u32).range(50..=4_000_000))]
    pub(super) baud: Option<u32>,
    /// Go on with the drawing that the host of this log was sending when it ended; the machine must have been
    /// on since, and speak frames or lines of text.
    #[arg(long, value_name = "LOG", requires_all = ["drawing", "port"])]
    pub(super) resume: Option<PathBuf>,
    /// Seconds of a simulated machine in one of ours; more than this computer can is as fast as it goes.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = speed, conflicts_with = "port")]
    pub(super) speed: f64,
    /// What a pen is called, such as its colour: 2=red. Pens without a name are called by their numbers.
    #[arg(long = "pen", value_name = "NUMBER=NAME", value_parser = pen_name)]
    pub(super) pens: Vec<(u8, String)>,
    /// The recording [default: live.plog, or the first of live-2.plog, live-3.plog, ... that is not there].
    #[arg(short, long, value_name = "LOG", default_value_os_t = free_log("live"), hide_default_value = true)]
    pub(super) output: PathBuf,
    /// Show it in this terminal, not in a browser.
    #[arg(long)]
    pub(super) terminal: bool,
    /// Port of 127.0.0.1 for the page; 0 takes any that is free.
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    pub(super) http_port: u16,
    /// Begin at once, without waiting for Start.
    #[arg(long, requires = "drawing")]
    pub(super) start: bool,
}

/// What is spoken.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub(super) enum Link {
    /// The reliable link if the machine knows it, else digits; it is called at the start, at its origin
    #[default]
    Auto,
    /// The published ten digits a target; the machine is not called
    Digits,
    /// The reliable link, or nothing
    Frames,
}

impl From<Link> for LinkChoice {
    fn from(link: Link) -> Self {
        match link {
            Link::Auto => Self::Auto,
            Link::Digits => Self::Digits,
            Link::Frames => Self::Frames,
        }
    }
}

/// A pen's number and what it is called.
fn pen_name(text: &str) -> Result<(u8, String), String> {
    let (number, name) = text.split_once('=').ok_or("expected a number, `=` and a name, as in 2=red")?;
    let number = number.trim().parse::<u8>().ok().filter(|&number| number > 0);
    let number = number.ok_or("expected a pen's number, 1 to 255, before the `=`")?;
    // (it stands in a line of the page, of the terminal and of the recording)
    let name: String = name.trim().chars().filter(|c| !c.is_control()).take(60).collect();
    if name.is_empty() { Err(String::from("expected a name behind the `=`")) } else { Ok((number, name)) }
}

impl Live {
    /// Does it.
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let described = self.simulate.as_deref().or(self.machine.as_deref());
        let machine = read_machine(described)?;
        if Self::is_led_by_lines(&machine) {
            self.run_lines(&machine, out)
        } else {
            self.run_targets(&machine, out)
        }
    }
}
