//! [`Port`]: a serial port of this computer, with a machine on it.

use core::fmt;
use core::time::Duration;
use serialport::{ClearBuffer, ErrorKind, FlowControl, SerialPort};
use std::io::{self, Read, Write};
use std::time::Instant;

/// An open serial port: 8 data bits, no parity, 1 stop bit, no flow control.
///
/// ```no_run
/// # use core::time::Duration;
/// # use plotter_replay::serial::Port;
/// let mut port = Port::open("/dev/ttyUSB0", 256_000)?;
/// port.send(&[3, 9, 9, 2, 0, 5, 5, 9, 3, 1])?;
/// let mut answer = [0; 64];
/// let bytes = port.receive(&mut answer, Duration::from_millis(10))?;
/// println!("{:?}", &answer[..bytes]);
/// # Ok::<(), plotter_replay::serial::PortError>(())
/// ```
pub struct Port {
    name: String,
    inner: Box<dyn SerialPort>,
}

impl fmt::Debug for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Port").field("name", &self.name).finish_non_exhaustive()
    }
}

/// What is wrong with a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortError {
    /// Its name.
    pub port: String,
    /// What it is.
    pub kind: PortErrorKind,
}

/// What is wrong with a port.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PortErrorKind {
    /// There is no such port; those that there are.
    NotThere {
        /// Their names.
        others: Vec<String>,
    },
    /// None was named, and there is not just one.
    WhichOne {
        /// Those that there are.
        others: Vec<String>,
    },
    /// Another program has it.
    Busy,
    /// This user may not open it.
    NotAllowed,
    /// It has gone away.
    Gone,
    /// It takes no more bytes.
    Stuck,
    /// Something else, in the system's words.
    Other(String),
}

impl fmt::Display for PortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.port)?;
        match &self.kind {
            PortErrorKind::NotThere { others } if others.is_empty() => {
                f.write_str("there is no such serial port, and no other: is the machine plugged in and on?")
            }
            PortErrorKind::NotThere { others } => {
                write!(f, "there is no such serial port; there are {}", others.join(", "))
            }
            PortErrorKind::WhichOne { others } if others.is_empty() => {
                f.write_str("no serial port was found: is the machine plugged in and on?")
            }
            PortErrorKind::WhichOne { others } => {
                write!(f, "which serial port? There are {}", others.join(", "))
            }
            PortErrorKind::Busy => f.write_str("another program uses this serial port: close it first"),
            PortErrorKind::NotAllowed => f.write_str(
                "this user may not open the serial port: on Linux, become a member of its group (`ls -l` names it, \
                 often dialout) and log in again",
            ),
            PortErrorKind::Gone => f.write_str("the serial port has gone away: was the machine unplugged?"),
            PortErrorKind::Stuck => f.write_str("the serial port takes no more bytes"),
            PortErrorKind::Other(message) => f.write_str(message),
        }
    }
}

impl core::error::Error for PortError {}

/// The serial port that is meant: `auto` is the only one on USB, else the only one at all; a name that no
/// port has may be a part of its name or of what the device on USB calls itself, if only one has it.
///
/// # Errors
///
/// [`PortErrorKind::WhichOne`] if there are several, or none.
pub fn find(wanted: &str) -> Result<String, PortError> {
    let ports = serialport::available_ports().unwrap_or_default();
    choose(wanted, &ports.into_iter().map(known).collect::<Vec<_>>())
}

/// A port: its name, what its device says of itself, whether it is on USB.
type Known = (String, String, bool);

fn known(port: serialport::SerialPortInfo) -> Known {
    match port.port_type {
        serialport::SerialPortType::UsbPort(usb) => {
            let words =
                [usb.manufacturer, usb.product, usb.serial_number].map(Option::unwrap_or_default).join(" ");
            (port.port_name, words, true)
        }
        _ => (port.port_name, String::new(), false),
    }
}

fn choose(wanted: &str, ports: &[Known]) -> Result<String, PortError> {
    let names = |of: &[&Known]| of.iter().map(|(name, ..)| name.clone()).collect::<Vec<_>>();
    let which = |others: Vec<String>| {
        Err(PortError { port: wanted.to_owned(), kind: PortErrorKind::WhichOne { others } })
    };
    if wanted.eq_ignore_ascii_case("auto") {
        let on_usb: Vec<&Known> = ports.iter().filter(|(.., usb)| *usb).collect();
        let all: Vec<&Known> = ports.iter().collect();
        return match (on_usb.as_slice(), all.as_slice()) {
            ([(name, ..)], _) | ([], [(name, ..)]) => Ok(name.clone()),
            ([], all) => which(names(all)),
            (several, _) => which(names(several)),
        };
    }
    if ports.iter().any(|(name, ..)| name == wanted) || std::path::Path::new(wanted).exists() {
        return Ok(wanted.to_owned());
    }
    let lower = wanted.to_ascii_lowercase();
    let has = |text: &str| text.to_ascii_lowercase().contains(&lower);
    let alike: Vec<&Known> = ports.iter().filter(|(name, words, _)| has(name) || has(words)).collect();
    match alike.as_slice() {
        // Opening it says what is wrong.
        [] => Ok(wanted.to_owned()),
        [(name, ..)] => Ok(name.clone()),
        several => which(names(several)),
    }
}

/// How long a byte may wait to be sent.
const SEND_WITHIN: Duration = Duration::from_secs(5);

impl Port {
    /// Opens the port `name` (`/dev/ttyUSB0`, `COM3`, …) at `baud` bits a second, and forgets what came
    /// before.
    ///
    /// # Errors
    ///
    /// [`PortError`] if that cannot be done.
    pub fn open(name: &str, baud: u32) -> Result<Self, PortError> {
        Self::open_with(name, baud, FlowControl::None)
    }

    /// The same of a machine that says by a line of its cable that it has no room, which comes to the CTS of
    /// this computer: bytes wait for it ([`offer`](Self::offer) says how many did not).
    ///
    /// # Errors
    ///
    /// [`PortError`] if that cannot be done.
    pub fn open_with_handshake(name: &str, baud: u32) -> Result<Self, PortError> {
        Self::open_with(name, baud, FlowControl::Hardware)
    }

    fn open_with(name: &str, baud: u32, flow: FlowControl) -> Result<Self, PortError> {
        let builder = serialport::new(name, baud).timeout(SEND_WITHIN).flow_control(flow);
        let inner = builder.open().map_err(|error| {
            let kind = match error.kind {
                ErrorKind::NoDevice if error.description.contains("lock") => PortErrorKind::Busy,
                ErrorKind::NoDevice if std::path::Path::new(name).exists() => PortErrorKind::Busy,
                ErrorKind::NoDevice | ErrorKind::Io(io::ErrorKind::NotFound) => PortErrorKind::NotThere {
                    others: serialport::available_ports()
                        .unwrap_or_default()
                        .into_iter()
                        .map(|port| port.port_name)
                        .collect(),
                },
                ErrorKind::Io(io::ErrorKind::PermissionDenied) => PortErrorKind::NotAllowed,
                ErrorKind::Io(io::ErrorKind::ResourceBusy) => PortErrorKind::Busy,
                _ => PortErrorKind::Other(error.description),
            };
            PortError { port: name.to_owned(), kind }
        })?;
        let port = Self { name: name.to_owned(), inner };
        port.inner.clear(ClearBuffer::Input).map_err(|error| port.other(&error.into()))?;
        Ok(port)
    }

    /// A second handle of the same port, for another thread.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the system has none.
    pub fn try_clone(&self) -> Result<Self, PortError> {
        let inner = self.inner.try_clone().map_err(|error| self.other(&error.into()))?;
        Ok(Self { name: self.name.clone(), inner })
    }

    /// The names of this computer's serial ports.
    #[must_use]
    pub fn names() -> Vec<String> {
        let ports = serialport::available_ports().unwrap_or_default();
        ports.into_iter().map(|port| port.port_name).collect()
    }

    /// A pseudo terminal: its machine's end, and the port at the other end, which any program may open by its
    /// name.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the system has no more of them.
    #[cfg(unix)]
    pub fn pseudo_terminal() -> Result<(Self, Self), PortError> {
        let failed = |error: serialport::Error| PortError {
            port: String::from("pseudo terminal"),
            kind: PortErrorKind::Other(error.description),
        };
        let (machine, port) = serialport::TTYPort::pair().map_err(failed)?;
        let name = SerialPort::name(&port).unwrap_or_default();
        let port = Self { name: name.clone(), inner: Box::new(port) };
        Ok((Self { name, inner: Box::new(machine) }, port))
    }

    /// Sends all of `bytes`.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the port takes nothing for five seconds, or is gone.
    pub fn send(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        let sent = self.inner.write_all(bytes).and_then(|()| self.inner.flush());
        sent.map_err(|error| match error.kind() {
            io::ErrorKind::TimedOut => self.error(PortErrorKind::Stuck),
            _ => self.other(&error),
        })
    }

    /// Sends as many of `bytes` as the port takes at once, which may be none; says how many.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the port is gone.
    pub fn offer(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.inner.set_timeout(Duration::from_millis(1)).map_err(|error| self.other(&error.into()))?;
        let result = match self.inner.write(bytes) {
            Ok(count) => Ok(count),
            Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) => {
                Ok(0)
            }
            Err(error) => Err(self.other(&error)),
        };
        let restored = self.inner.set_timeout(SEND_WITHIN).map_err(|error| self.other(&error.into()));
        restored.and(result)
    }

    /// Waits at most `wait` for bytes; says how many came, which may be none.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the port is gone.
    pub fn receive(&mut self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        // Time-outs have a millisecond at least, which is much for who does not want to wait.
        if wait.is_zero() && self.inner.bytes_to_read().is_ok_and(|waiting| waiting == 0) {
            return Ok(0);
        }
        let until = Instant::now() + wait;
        self.inner
            .set_timeout(wait.max(Duration::from_millis(1)))
            .map_err(|error| self.other(&error.into()))?;
        let result = loop {
            match self.inner.read(bytes) {
                Ok(0) if !bytes.is_empty() => break Err(self.error(PortErrorKind::Gone)),
                Ok(count) => break Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => break Ok(0),
                Err(error) if error.kind() == io::ErrorKind::Interrupted && Instant::now() < until => {}
                Err(error) if error.kind() == io::ErrorKind::Interrupted => break Ok(0),
                Err(error) => break Err(self.other(&error)),
            }
        };
        let restored = self.inner.set_timeout(SEND_WITHIN).map_err(|error| self.other(&error.into()));
        restored.and(result)
    }

    /// Both directions of it for a [`relay`](crate::record::relay), with time-outs of a fifth of a second.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the system gives no second handle.
    pub fn into_relay_end(mut self) -> Result<crate::record::RelayEnd, PortError> {
        let prepared =
            self.inner.set_timeout(Duration::from_millis(200)).and_then(|()| self.inner.try_clone());
        let writer = prepared.map_err(|error| self.other(&error.into()))?;
        Ok(crate::record::RelayEnd {
            name: self.name,
            reader: Box::new(self.inner),
            writer: Box::new(writer),
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn error(&self, kind: PortErrorKind) -> PortError {
        PortError { port: self.name.clone(), kind }
    }

    fn other(&self, error: &io::Error) -> PortError {
        self.error(match error.kind() {
            io::ErrorKind::BrokenPipe | io::ErrorKind::NotFound | io::ErrorKind::UnexpectedEof => {
                PortErrorKind::Gone
            }
            _ => PortErrorKind::Other(error.to_string()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_is_found_by_what_is_known_of_it() {
        let port = |name: &str, words: &str, usb| (name.to_owned(), words.to_owned(), usb);
        let ports = [
            port("/dev/ttyS0", "", false),
            port("/dev/ttyUSB0", "FTDI FT232R A50285BI", true),
            port("/dev/ttyACM3", "STMicroelectronics Nucleo 066", true),
        ];
        assert_eq!(choose("nucleo", &ports).unwrap(), "/dev/ttyACM3");
        assert_eq!(choose("ttyUSB0", &ports).unwrap(), "/dev/ttyUSB0");
        assert_eq!(choose("/dev/ttyUSB7", &ports).unwrap(), "/dev/ttyUSB7");
        assert_eq!(choose("auto", &ports[..2]).unwrap(), "/dev/ttyUSB0");
        assert_eq!(choose("auto", &ports[..1]).unwrap(), "/dev/ttyS0");
        assert_eq!(
            choose("auto", &ports).unwrap_err().to_string(),
            "auto: which serial port? There are /dev/ttyUSB0, /dev/ttyACM3"
        );
        assert!(choose("tty", &ports).is_err());
        let none = choose("auto", &[]).unwrap_err().to_string();
        assert_eq!(none, "auto: no serial port was found: is the machine plugged in and on?");
    }

    #[test]
    fn a_port_that_is_not_there_is_said_to_be_so() {
        let error = Port::open("/dev/no-such-plotter", 9_600).unwrap_err();
        assert!(matches!(error.kind, PortErrorKind::NotThere { .. }), "{error:?}");
        assert!(
            error.to_string().starts_with("/dev/no-such-plotter: there is no such serial port"),
            "{error}"
        );
    }
}
