//! `export`: a log for other programs.

use super::commands::{Done, Verdict, cannot, is_free, open, read, say, say_damage};
use crate::export;
use crate::log::Record;
use clap::{Args, ValueEnum};
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Export {
    /// The log; packed if its name ends in .gz.
    log: PathBuf,
    /// Format of the output.
    #[arg(long, value_name = "FORMAT")]
    to: To,
    /// File to write [default: standard output; MCAP needs a file].
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Overwrite FILE if it exists.
    #[arg(long, requires = "out")]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum To {
    /// A table with bytes in hex.
    Csv,
    /// The lines of the log with their meaning in words.
    Text,
    /// For Foxglove.
    Mcap,
}

impl Export {
    /// Whether it goes to the standard output.
    pub(crate) fn prints_file(&self) -> bool {
        self.out.is_none()
    }

    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let contents = read(&self.log, |_| {})?;
        let header = &contents.header;
        let records = open(&self.log)?.filter_map(Result::ok);
        let verdict = Verdict::of(contents.summary);
        let Some(path) = &self.out else {
            // What comes out is read by another program: it is told of damage by the exit status only.
            let written = match self.to {
                To::Csv => export::csv(header, records, &mut *out),
                To::Text => export::text(header, records, &mut *out),
                To::Mcap => {
                    return Err(String::from(
                        "export: MCAP is not written to the standard output: give -o FILE",
                    ));
                }
            };
            return match written {
                Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                    Err(cannot("written", "standard output".as_ref(), &error))
                }
                // Whoever closed the pipe has seen enough.
                _ => Ok(verdict),
            };
        };
        is_free(path, self.force)?;
        let unwritable = |error: std::io::Error| cannot("written", path, &error);
        let file = BufWriter::new(File::create(path).map_err(unwritable)?);
        match self.to {
            To::Csv => export::csv(header, records, file).map_err(unwritable)?,
            To::Text => export::text(header, records, file).map_err(unwritable)?,
            To::Mcap => {
                write_mcap(header, records, file).map_err(|error| format!("{}: {error}", path.display()))?
            }
        }
        say_damage(out, &contents);
        say(out, &format!("wrote {}", path.display()));
        Ok(verdict)
    }
}

#[cfg(feature = "mcap")]
fn write_mcap(
    header: &crate::log::Header,
    records: impl Iterator<Item = Record>,
    file: BufWriter<File>,
) -> Result<(), String> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float cast saturates")]
    let began_ns = (header.number("began_unix_us").unwrap_or(0.0) * 1e3) as u64;
    let settings = export::McapSettings { began_ns, ..export::McapSettings::default() };
    export::mcap(header, records, settings, file).map_err(|error| error.to_string())
}

#[cfg(not(feature = "mcap"))]
fn write_mcap(
    _: &crate::log::Header,
    _: impl Iterator<Item = Record>,
    _: BufWriter<File>,
) -> Result<(), String> {
    Err(format!("this program was built without MCAP: {}", super::with_feature("mcap")))
}
