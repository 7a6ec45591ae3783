//! The log of a plotter's serial line: one line of text per record, each with its own checksum.
//!
//! ```text
//! plotter-log 1 {"baud":256000,"protocol":"digits","machine":"semi-virtual-gantry"}
//! 0 > 03 09 09 02 00 05 05 09 03 01 *89
//! 10312 < 31 33 31 *87
//! 10350 @ edge x+ *5a
//! 10351 @ drive x 20 *04
//! │     │ │          └── CRC-8/SMBUS of everything before the asterisk, the space included
//! │     │ └── bytes in hex, or an event that is not a byte: an edge, a drive
//! │     └── > host to controller, < controller to host, @ an event that is not on the serial line
//! └── microseconds since the start, never decreasing
//! ```
//!
//! Two logs can be compared with `diff` and searched with `grep`, and a killed recorder loses at most one
//! line. `docs/log-format.md` in the repository describes the format in full.
//!
//! [`Writer`] appends whole lines. [`Reader`] continues after any damage and reports what was lost. It
//! refuses a log of another version than [`VERSION`].

mod damage;
mod file;
mod header;
mod line_source;
mod reader;
mod record;
mod record_ref;
mod salvage;
mod text;
mod writer;

pub use damage::{Damage, DamageKind, Summary, SyntaxError};
pub use file::{FileReader, FileWriter, LogFile, create, open};
pub use header::{Header, HeaderError};
pub(crate) use line_source::LineSource;
pub use reader::{ReadError, Reader};
pub use record::{Event, Record, SwitchName, SwitchNameError};
pub use record_ref::{EventRef, RecordRef};
pub(crate) use text::write_line;
pub use writer::{WriteError, Writer};

/// First word of every log.
pub const MAGIC: &str = "plotter-log";
/// The version of the format that this crate writes and reads.
pub const VERSION: u32 = 1;
/// Longest line, in bytes with its end: a longer one is damage, and is never held in memory.
pub const MAX_LINE_BYTES: usize = 65_536;
