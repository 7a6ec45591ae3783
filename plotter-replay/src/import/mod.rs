//! Recordings of other tools, as logs of this crate.
//!
//! Many tools record serial lines, each in a text format of its own. All of them have the same content: a
//! time, a direction and bytes.
//!
//! | tool | how it is run | what tells the direction |
//! |---|---|---|
//! | [`Tool::Socat`] | `socat -x -v PTY,link=plotter /dev/ttyUSB0 2>FILE` | `>` is the host |
//! | [`Tool::Jpnevulator`] | `jpnevulator --read --ascii --timing-print --pass --tty A --tty B` | the name of the port |
//! | [`Tool::Candump`] | lines of `(seconds.micros) NAME XX` | the name |
//! | [`Tool::Saleae`] | Logic 1 and 2: export of the async serial analyzer as CSV | a file, or the analyzer's name |
//! | [`Tool::Sigrok`] | `sigrok-cli -P uart:rx=D0 -A uart=rx-data --protocol-decoder-samplenum` | a file, or the decoder's and its row's name |
//! | [`Tool::Raw`] | `cat /dev/ttyUSB0 >FILE`: bare bytes | a file; times are made from the baud rate |
//! | [`Tool::PlotterRaw`] | `t_us,H\|D,hex` after a line `# plotter-raw/1` | `H` is the host |
//!
//! A line that cannot be read is reported with its number, and the rest is taken.

mod candump;
mod clock;
mod detect;
mod hex_dump;
mod jpnevulator;
mod merge;
mod plotter_raw;
mod protocol;
mod raw;
mod saleae;
mod sides;
mod sigrok;
mod socat;

pub use detect::detect;
pub use merge::{ImportError, Imported, import};
pub use protocol::protocol_of;

use core::fmt;
use std::io::{self, BufRead};

/// Tools that write recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Tool {
    /// socat with `-x`, with or without `-v`.
    Socat,
    /// jpnevulator with `--timing-print`.
    Jpnevulator,
    /// candump and those who write like it.
    Candump,
    /// Saleae Logic, table of an async serial analyzer.
    Saleae,
    /// sigrok-cli, annotations of the UART decoder with their samples.
    Sigrok,
    /// Bare bytes.
    Raw,
    /// `plotter-raw/1`.
    PlotterRaw,
}

/// Sender of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The computer.
    Host,
    /// The plotter's controller.
    Controller,
}

/// Settings of an import, beside its files.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImportSettings {
    /// Bits a second on the line.
    pub baud: u32,
    /// Samples a second of the logic analyzer, for sigrok; without it, it follows from the baud rate and the
    /// length of a byte.
    pub sample_rate_hz: Option<f64>,
    /// Name of the host in the recording (a port or an analyzer).
    pub host: Option<String>,
    /// Name of the controller in the recording.
    pub controller: Option<String>,
}

impl ImportSettings {
    /// The same with another [`ImportSettings::baud`].
    #[must_use]
    pub fn with_baud(self, baud: u32) -> Self {
        Self { baud, ..self }
    }

    /// The same with another [`ImportSettings::sample_rate_hz`].
    #[must_use]
    pub fn with_sample_rate_hz(self, sample_rate_hz: Option<f64>) -> Self {
        Self { sample_rate_hz, ..self }
    }

    /// The same with another [`ImportSettings::host`].
    #[must_use]
    pub fn with_host(self, host: Option<String>) -> Self {
        Self { host, ..self }
    }

    /// The same with another [`ImportSettings::controller`].
    #[must_use]
    pub fn with_controller(self, controller: Option<String>) -> Self {
        Self { controller, ..self }
    }
}

impl Default for ImportSettings {
    /// 256000 baud, the rest found out.
    fn default() -> Self {
        Self { baud: 256_000, sample_rate_hz: None, host: None, controller: None }
    }
}

impl ImportSettings {
    /// How long a byte with its start and stop bit takes, ns.
    fn byte_ns(&self) -> i128 {
        10_000_000_000 / i128::from(self.baud.max(1))
    }
}

/// A file to be imported. It is read twice: what a number means can depend on all others.
pub struct Source<'a> {
    /// Name of the source, for messages.
    pub name: String,
    /// Tool that wrote the file.
    pub tool: Tool,
    /// Sender of the bytes, if the source records one direction; `None` finds it out.
    pub side: Option<Side>,
    /// Opens it, at its beginning.
    pub open: Box<dyn Fn() -> io::Result<Box<dyn BufRead + 'a>> + 'a>,
}

impl fmt::Debug for Source<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, tool, side, .. } = self;
        f.debug_struct("Source")
            .field("name", name)
            .field("tool", tool)
            .field("side", side)
            .finish_non_exhaustive()
    }
}

/// Something that could not be read, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trouble {
    /// The file.
    pub file: String,
    /// The line, from 1; 0 for none.
    pub line: u64,
    /// The error message.
    pub message: String,
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.message),
            line => write!(f, "{} line {line}: {}", self.file, self.message),
        }
    }
}

impl Tool {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Socat,
        Self::Jpnevulator,
        Self::Candump,
        Self::Saleae,
        Self::Sigrok,
        Self::Raw,
        Self::PlotterRaw,
    ];

    /// Name on the command line and in a log's header.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Socat => "socat",
            Self::Jpnevulator => "jpnevulator",
            Self::Candump => "candump",
            Self::Saleae => "saleae",
            Self::Sigrok => "sigrok",
            Self::Raw => "raw",
            Self::PlotterRaw => "plotter-raw",
        }
    }

    /// Whether a file of it holds one direction only.
    #[must_use]
    pub const fn is_one_sided(self) -> bool {
        matches!(self, Self::Raw | Self::Sigrok)
    }
}

/// Bytes that a tool saw together.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Chunk {
    /// When the last bit of the last byte was through, on the tool's own clock.
    time_ns: i128,
    side: Saw,
    bytes: Vec<u8>,
}

/// What a tool says about who sent something.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Saw {
    /// It says who.
    Side(Side),
    /// It gives a name.
    Name(String),
    /// Nothing: it is the recording of one direction.
    File,
}

/// What comes of a line.
type Lines = Vec<Result<Chunk, String>>;

/// Reads the lines of one tool.
trait Format {
    /// Looks at a line before all are read, to find out what numbers mean.
    fn survey(&mut self, _line: &str) {}

    /// Reads a line.
    fn line(&mut self, line: &str, out: &mut Lines);

    /// There are no more lines.
    fn end(&mut self, _out: &mut Lines) {}
}

fn format_of(tool: Tool, settings: &ImportSettings) -> Option<Box<dyn Format>> {
    Some(match tool {
        Tool::Socat => Box::new(socat::Socat::default()),
        Tool::Jpnevulator => Box::new(jpnevulator::Jpnevulator::default()),
        Tool::Candump => Box::new(candump::Candump),
        Tool::Saleae => Box::new(saleae::Saleae::new(settings)),
        Tool::Sigrok => Box::new(sigrok::Sigrok::new(settings)),
        Tool::PlotterRaw => Box::new(plotter_raw::PlotterRaw),
        Tool::Raw => return None,
    })
}
