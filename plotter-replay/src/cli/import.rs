//! `import`: what another tool recorded, as a log.

use super::commands::{Done, Verdict, cannot, is_free, say, say_first};
use crate::import::{ImportError, ImportSettings, Imported, Side, Source, Tool, detect, import, protocol_of};
use crate::log::{self, Header};
use clap::{Args, ValueEnum};
use std::fs::File;
use std::io::{BufReader, Read as _, Write};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct Import {
    /// The recordings; both files of a tool that writes one file per direction.
    #[arg(value_name = "FILE", required_unless_present_any = ["host", "controller"])]
    files: Vec<PathBuf>,
    /// A recording of the bytes from the host.
    #[arg(long, value_name = "FILE")]
    host: Vec<PathBuf>,
    /// A recording of the bytes from the controller.
    #[arg(long, value_name = "FILE")]
    controller: Vec<PathBuf>,
    /// The tool that wrote them [default: found from their contents].
    #[arg(long, value_name = "TOOL")]
    from: Option<From>,
    /// The log; packed if its name ends in .gz.
    #[arg(short, long, value_name = "LOG")]
    out: PathBuf,
    /// Overwrite LOG if it exists.
    #[arg(long)]
    force: bool,
    /// Baud rate of the line, bits per second.
    #[arg(long, value_name = "RATE", default_value_t = 256_000, value_parser = clap::value_parser!(u32).range(50..))]
    baud: u32,
    /// Sample rate of the logic analyzer, Hz, for sigrok [default: computed from the baud rate and the
    /// length of a byte].
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// Name of the host in the recording (a port, an analyzer) [default: by its words, else the first
    /// that sends].
    #[arg(long, value_name = "NAME")]
    host_name: Option<String>,
    /// Name of the controller in the recording.
    #[arg(long, value_name = "NAME")]
    controller_name: Option<String>,
    /// Protocol of the line, for the log's header [default: found from what is said].
    #[arg(long, value_name = "NAME")]
    protocol: Option<String>,
}

/// As [`Tool`], for the command line.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum From {
    Socat,
    Jpnevulator,
    Candump,
    Saleae,
    Sigrok,
    Raw,
    PlotterRaw,
}

impl From {
    fn tool(self) -> Tool {
        match self {
            Self::Socat => Tool::Socat,
            Self::Jpnevulator => Tool::Jpnevulator,
            Self::Candump => Tool::Candump,
            Self::Saleae => Tool::Saleae,
            Self::Sigrok => Tool::Sigrok,
            Self::Raw => Tool::Raw,
            Self::PlotterRaw => Tool::PlotterRaw,
        }
    }
}

/// A file that is taken away again, unless it has got another name by then.
struct Part(PathBuf);

impl Drop for Part {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0); // it is gone where all went well
    }
}

/// The name of a log that is being written, packed if `path` is.
fn part_of(path: &Path) -> Part {
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Part(path.with_file_name(format!(".part-{name}")))
}

/// The beginning of a file that tells which tool wrote it, bytes.
const BEGINNING: u64 = 16_384;

fn tool_of(path: &Path) -> Result<Tool, String> {
    let mut beginning = Vec::new();
    File::open(path)
        .and_then(|file| file.take(BEGINNING).read_to_end(&mut beginning))
        .map_err(|error| cannot("read", path, &error))?;
    if beginning.starts_with(log::MAGIC.as_bytes()) {
        return Err(format!("{}: is a log already", path.display()));
    }
    detect(&beginning).ok_or_else(|| {
        let tools: Vec<_> = Tool::ALL.iter().map(|tool| tool.name()).collect();
        format!("{}: no tool known here wrote this: say --from ({})", path.display(), tools.join(", "))
    })
}

/// Length of a log's beginning that tells its protocol, bytes: it holds some ten thousand bytes of the line
/// where each has a record of its own.
const LOG_BEGINNING: usize = 1 << 18;

/// The beginning of a log, which nothing is written into behind that.
#[derive(Default)]
struct Beginning(Vec<u8>);

impl Write for Beginning {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.0.len() >= LOG_BEGINNING {
            return Err(std::io::ErrorKind::FileTooLarge.into());
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Import {
    /// The files, each with the tool that wrote it.
    fn sources(&self) -> Result<Vec<Source<'static>>, String> {
        let none = self.files.iter().map(|path| (path, None));
        let host = self.host.iter().map(|path| (path, Some(Side::Host)));
        let controller = self.controller.iter().map(|path| (path, Some(Side::Controller)));
        let mut sources = Vec::new();
        for (path, side) in none.chain(host).chain(controller) {
            let tool = match self.from {
                Some(from) => from.tool(),
                None => tool_of(path)?,
            };
            // Opened once before anything is written.
            File::open(path).map_err(|error| cannot("read", path, &error))?;
            let path = path.clone();
            let name = path.display().to_string();
            let open = Box::new(move || {
                let file = File::open(&path)?;
                Ok(Box::new(BufReader::new(file)) as Box<dyn std::io::BufRead>)
            });
            sources.push(Source { name, tool, side, open });
        }
        Ok(sources)
    }

    /// Which protocol it is of, by its beginning.
    fn found_protocol(&self, settings: &ImportSettings) -> Result<&'static str, String> {
        let mut beginning = Beginning::default();
        let writer = log::Writer::new(&mut beginning, &Header::new());
        let mut writer = writer.map_err(|error| error.to_string())?;
        match import(self.sources()?, settings, &mut writer, drop) {
            Ok(_) | Err(ImportError::Log(_)) => {}
            Err(error) => return Err(error.to_string()),
        }
        let _ = writer.finish(); // as much as there is room for
        let (mut host, mut machine) = (Vec::new(), Vec::new());
        let reader = log::Reader::new(beginning.0.as_slice()).map_err(|error| error.to_string())?;
        for record in reader.flatten() {
            match record.event {
                log::Event::Host(bytes) => host.extend(bytes),
                log::Event::Controller(bytes) => machine.extend(bytes),
                _ => {}
            }
        }
        Ok(protocol_of(&host, &machine))
    }

    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        let sources = self.sources()?;
        is_free(&self.out, self.force)?;
        let settings = ImportSettings {
            baud: self.baud,
            sample_rate_hz: self.sample_rate,
            host: self.host_name.clone(),
            controller: self.controller_name.clone(),
        };
        let found = match &self.protocol {
            Some(_) => None,
            None => Some(self.found_protocol(&settings)?),
        };
        let protocol = self.protocol.as_deref().or(found).unwrap_or_default();
        let tool = sources.first().map_or("", |source| source.tool.name());
        let header = Header::new()
            .with_number("baud", u64::from(self.baud))
            .with_text("protocol", protocol)
            .with_text("recorded_by", tool);
        let failed = |error: log::WriteError| format!("{}: {error}", self.out.display());
        // Under another name until it is whole: what fails leaves no log, and the old one as it was.
        let part = part_of(&self.out);
        let mut writer = log::create(&part.0, &header).map_err(failed)?;
        let mut troubles = Vec::new();
        let imported = import(sources, &settings, &mut writer, |trouble| {
            if troubles.len() < super::commands::MOST_SHOWN {
                troubles.push(trouble);
            }
        });
        let Imported { host_bytes, controller_bytes, troubles: count, sides } =
            imported.map_err(|error| error.to_string())?;
        writer.finish().map_err(failed)?;
        std::fs::rename(&part.0, &self.out).map_err(|error| cannot("written", &self.out, &error))?;
        for (name, side) in sides {
            let side = if side == Side::Host { "the host" } else { "the controller" };
            say(out, &format!("{name}: {side}"));
        }
        say(out, &format!("{tool}: {host_bytes} bytes of the host, {controller_bytes} of the controller"));
        match found {
            Some("unknown") => {
                say(out, "its protocol is none that is known here: drawn as none (--protocol says it)")
            }
            Some(protocol) => {
                say(out, &format!("protocol: {protocol}, by what is said (--protocol says another)"))
            }
            None => {}
        }
        say(out, &format!("wrote {}", self.out.display()));
        if host_bytes + controller_bytes == 0 {
            say(out, "nothing was found in it");
        }
        say(out, &format!("not read as it stands: {count}"));
        say_first(out, &troubles, count);
        Ok(if count == 0 && host_bytes + controller_bytes > 0 { Verdict::Clean } else { Verdict::Found })
    }
}
