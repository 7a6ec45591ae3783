//! `record`: between a host program and a plotter.

use super::commands::{Done, seconds};
use clap::Args;
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct Record {
    /// The port that the plotter is on: a name, a part of one that only it has, or `auto` for the only one
    /// there is.
    #[arg(long, value_name = "NAME", default_value = "auto")]
    port: String,
    /// Bits a second, any number that the port can.
    #[arg(long, value_name = "RATE", default_value_t = 256_000, value_parser = clap::value_parser!(u32).range(50..))]
    baud: u32,
    /// The port that the host is on.
    #[arg(long, value_name = "NAME", conflicts_with = "pty", required_unless_present = "pty")]
    host_port: Option<String>,
    /// Make a port for a host program on this computer, and a link to it of this name.
    #[arg(long, value_name = "LINK")]
    pty: Option<PathBuf>,
    /// The log; packed if its name ends in .gz.
    #[arg(short, long, value_name = "LOG")]
    out: PathBuf,
    /// Overwrite LOG if it exists.
    #[arg(long)]
    force: bool,
    /// Stop after so many seconds [default: Ctrl-C].
    #[arg(long = "for", value_name = "S", value_parser = seconds)]
    lasts: Option<Duration>,
    /// What the line speaks, for the log's header [default: told by what was said whenever the log is read]
    #[arg(long, value_name = "NAME")]
    protocol: Option<String>,
    /// What the machine is called, for the log's header.
    #[arg(long, value_name = "NAME")]
    machine: Option<String>,
}

#[cfg(not(feature = "serial"))]
impl Record {
    pub(crate) fn run(self, _: &mut impl Write) -> Done {
        Err(format!(
            "{}: this program was built without serial ports: {}",
            self.port,
            super::with_feature("serial")
        ))
    }
}

#[cfg(feature = "serial")]
impl Record {
    pub(crate) fn run(self, out: &mut impl Write) -> Done {
        use super::commands::{Verdict, is_free, say};
        use crate::record::{Recorder, RelayStop, relay};
        use crate::serial::{Port, find};
        use std::sync::Arc;
        use std::sync::atomic::{AtomicBool, Ordering};

        is_free(&self.out, self.force)?;
        let words = |error: crate::serial::PortError| error.to_string();
        let name = find(&self.port).map_err(words)?;
        let controller = Port::open(&name, self.baud).and_then(Port::into_relay_end).map_err(words)?;
        let (host, link) = self.host_end()?;
        let recorder = Recorder::create(&self.out, &self.header(&name), |error| {
            let told = writeln!(
                std::io::stderr(),
                "{}: {error}: nothing is recorded any more; the bytes still go on between host and plotter",
                super::program()
            );
            drop(told);
        })
        .map_err(|error| format!("{}: {error}", self.out.display()))?;
        let stop = Arc::new(AtomicBool::new(false));
        let asked = Arc::clone(&stop);
        ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed))
            .map_err(|error| format!("Ctrl-C cannot be waited for: {error}"))?;
        say(
            out,
            &format!("recording {name} and {} at {} baud into {}", host.name, self.baud, self.out.display()),
        );
        let _ = out.flush();
        if let Some(lasts) = self.lasts {
            let over = Arc::clone(&stop);
            // Not waited for: the process ends before it, if it is stopped.
            std::thread::spawn(move || {
                std::thread::sleep(lasts);
                over.store(true, Ordering::Relaxed);
            });
        }
        let stopped = relay(host, controller, self.baud, &recorder, &stop);
        drop(link);
        let recorded = recorder.finish().map_err(|error| format!("{}: {error}", self.out.display()))?;
        say(
            out,
            &format!(
                "{stopped}: {} bytes of the host, {} of the controller, {:.1} s",
                recorded.host_bytes,
                recorded.controller_bytes,
                recorder.elapsed().as_secs_f64()
            ),
        );
        if recorded.lost_bytes > 0 {
            say(
                out,
                &format!("{} bytes came too fast for the disk and are not in the log", recorded.lost_bytes),
            );
        }
        match stopped {
            RelayStop::Asked if recorded.lost_bytes == 0 => Ok(Verdict::Clean),
            RelayStop::Asked => Ok(Verdict::Found),
            gone => Err(gone.to_string()),
        }
    }

    fn header(&self, port: &str) -> crate::log::Header {
        let mut header = crate::log::Header::new()
            .with_number("baud", u64::from(self.baud))
            .with_text("clock", "monotonic")
            .with_text("port", port);
        if let Some(protocol) = &self.protocol {
            header = header.with_text("protocol", protocol);
        }
        if let Some(machine) = &self.machine {
            header = header.with_text("machine", machine);
        }
        // When it began, for people and for programs that show times of day; records count from there.
        if let Ok(since) = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH) {
            header = header.with_number("began_unix_us", u64::try_from(since.as_micros()).unwrap_or(0));
        }
        header
    }

    /// The host's end, and what must be kept as long as it is used.
    fn host_end(&self) -> Result<(crate::record::RelayEnd, Option<PtyLink>), String> {
        use crate::serial::{Port, find};
        match (&self.host_port, &self.pty) {
            (Some(name), _) => {
                let name = find(name).map_err(|error| error.to_string())?;
                let end = Port::open(&name, self.baud).and_then(Port::into_relay_end);
                Ok((end.map_err(|error| error.to_string())?, None))
            }
            (None, Some(link)) => pty_end(link).map(|(end, link)| (end, Some(link))),
            (None, None) => {
                Err(String::from("record: which port is the host on? --host-port, or --pty to make one"))
            }
        }
    }
}

/// A link to a pseudo terminal, taken away at the end.
#[cfg(feature = "serial")]
#[derive(Debug)]
struct PtyLink {
    link: PathBuf,
    /// Kept open: when no program has the other end open, reading would fail.
    #[cfg(unix)]
    _other: std::fs::File,
}

#[cfg(feature = "serial")]
impl Drop for PtyLink {
    fn drop(&mut self) {
        // It is only a name.
        let _ = std::fs::remove_file(&self.link);
    }
}

#[cfg(all(feature = "serial", unix))]
fn pty_end(link: &std::path::Path) -> Result<(crate::record::RelayEnd, PtyLink), String> {
    use serialport::{SerialPort, TTYPort};
    use std::os::unix::fs::OpenOptionsExt as _;
    let cannot = |error: serialport::Error| format!("a port for the host cannot be made: {error}");
    let (mut ours, other) = TTYPort::pair().map_err(cannot)?;
    let name =
        other.name().ok_or_else(|| String::from("a port for the host cannot be made: it has no name"))?;
    // Held open without the lock that a serial port takes: the host program is to open it.
    let held = std::fs::OpenOptions::new()
        .read(true)
        .write(true)
        .custom_flags(libc::O_NOCTTY)
        .open(&name)
        .map_err(|error| super::commands::cannot("opened", name.as_ref(), &error))?;
    drop(other);
    ours.set_timeout(Duration::from_millis(200)).map_err(cannot)?;
    let writer = ours.try_clone_native().map_err(cannot)?;
    if link.is_symlink() {
        // Left by one that was killed; anything else of this name is refused below.
        let _ = std::fs::remove_file(link);
    }
    std::os::unix::fs::symlink(&name, link).map_err(|error| super::commands::cannot("made", link, &error))?;
    let end = crate::record::RelayEnd {
        name: link.display().to_string(),
        reader: Box::new(ours),
        writer: Box::new(writer),
    };
    Ok((end, PtyLink { link: link.to_owned(), _other: held }))
}

#[cfg(all(feature = "serial", not(unix)))]
fn pty_end(_: &std::path::Path) -> Result<(crate::record::RelayEnd, PtyLink), String> {
    Err(String::from(
        "--pty: this system has no pseudo terminals: use --host-port with a pair of virtual ports",
    ))
}
