//! [`Port`]: a serial port of this computer; [`find`] chooses one by its name or its device.

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
/// port.send(&[3, 9, 9, 2, 0, 5, 5, 9, 3, 1])?; // a target in ten digits, counts of x and y: see `digits`
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

/// An error of a serial port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortError {
    /// Name of the port.
    pub port: String,
    /// What went wrong.
    pub kind: PortErrorKind,
}

/// Kinds of errors of a serial port.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PortErrorKind {
    /// No port has this name.
    NotFound {
        /// Names of the ports that exist.
        existing: Vec<String>,
    },
    /// Several ports may be meant, or none exists.
    Ambiguous {
        /// Names of the ports that may be meant.
        candidates: Vec<String>,
    },
    /// Another program uses the port.
    Busy,
    /// This user may not open the port.
    PermissionDenied,
    /// The port has disappeared, as an unplugged one does.
    Gone,
    /// The port has taken no bytes for five seconds.
    Stuck,
    /// Another error, as the operating system describes it.
    Other(String),
}

impl fmt::Display for PortError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: ", self.port)?;
        match &self.kind {
            PortErrorKind::NotFound { existing } if existing.is_empty() => {
                f.write_str("there is no such serial port, and no other: is the machine plugged in and on?")
            }
            PortErrorKind::NotFound { existing } => {
                write!(f, "there is no such serial port; there are {}", existing.join(", "))
            }
            PortErrorKind::Ambiguous { candidates } if candidates.is_empty() => {
                f.write_str("no serial port was found: is the machine plugged in and on?")
            }
            PortErrorKind::Ambiguous { candidates } => {
                write!(f, "which serial port? There are {}", candidates.join(", "))
            }
            PortErrorKind::Busy => f.write_str("another program uses this serial port: close it first"),
            PortErrorKind::PermissionDenied => f.write_str(
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

/// Name of the serial port that `wanted` means:
///
/// - `auto`: the only port on USB, or if none is, the only port;
/// - the name of a port, or a path that exists: that;
/// - anything else: the port whose name or USB description contains the text, in upper or lower case. If no
///   port does, `wanted` itself, so that [`Port::open`] says what is wrong with it.
///
/// # Errors
///
/// [`PortErrorKind::Ambiguous`] if several ports fit, or if `auto` finds none.
pub fn find(wanted: &str) -> Result<String, PortError> {
    let ports = serialport::available_ports().unwrap_or_default();
    choose(wanted, &ports.into_iter().map(known).collect::<Vec<_>>())
}

/// A port as the system lists it.
#[derive(Clone, Debug)]
struct KnownPort {
    name: String,
    /// Maker, product and serial number of the device on USB; empty elsewhere.
    description: String,
    is_usb: bool,
}

fn known(port: serialport::SerialPortInfo) -> KnownPort {
    match port.port_type {
        serialport::SerialPortType::UsbPort(usb) => {
            let description =
                [usb.manufacturer, usb.product, usb.serial_number].map(Option::unwrap_or_default).join(" ");
            KnownPort { name: port.port_name, description, is_usb: true }
        }
        _ => KnownPort { name: port.port_name, description: String::new(), is_usb: false },
    }
}

fn choose(wanted: &str, ports: &[KnownPort]) -> Result<String, PortError> {
    // The only one of several ports, or an error that names them.
    let only = |candidates: Vec<&KnownPort>| match candidates.as_slice() {
        [port] => Ok(port.name.clone()),
        several => {
            let candidates = several.iter().map(|port| port.name.clone()).collect();
            Err(PortError { port: wanted.to_owned(), kind: PortErrorKind::Ambiguous { candidates } })
        }
    };
    if wanted.eq_ignore_ascii_case("auto") {
        let on_usb: Vec<&KnownPort> = ports.iter().filter(|port| port.is_usb).collect();
        return only(if on_usb.is_empty() { ports.iter().collect() } else { on_usb });
    }
    if ports.iter().any(|port| port.name == wanted) || std::path::Path::new(wanted).exists() {
        return Ok(wanted.to_owned());
    }
    let lower = wanted.to_ascii_lowercase();
    let has = |text: &str| text.to_ascii_lowercase().contains(&lower);
    let alike: Vec<_> = ports.iter().filter(|port| has(&port.name) || has(&port.description)).collect();
    if alike.is_empty() { Ok(wanted.to_owned()) } else { only(alike) }
}

/// How long a byte may wait to be sent: a machine that stops the line for longer hangs. It is also the
/// time-out of reading between calls, which none relies on.
const SEND_TIMEOUT: Duration = Duration::from_secs(5);
/// Shortest time-out that is asked for: the library counts whole milliseconds.
const LEAST_TIMEOUT: Duration = Duration::from_millis(1);
/// Time-out of both ends of a relay: how soon it notices that it shall end.
const RELAY_TIMEOUT: Duration = Duration::from_millis(200);

impl Port {
    /// Opens the port `name` (`/dev/ttyUSB0`, `COM3`, …) at `baud` bits a second, and discards input
    /// received before.
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
        let builder = serialport::new(name, baud).timeout(SEND_TIMEOUT).flow_control(flow);
        let inner = builder.open().map_err(|error| {
            // `serialport` 4 reports a locked port as `NoDevice`: only its text tells it, or that the path
            // exists.
            let kind = match error.kind {
                ErrorKind::NoDevice if error.description.contains("lock") => PortErrorKind::Busy,
                ErrorKind::NoDevice if std::path::Path::new(name).exists() => PortErrorKind::Busy,
                ErrorKind::NoDevice | ErrorKind::Io(io::ErrorKind::NotFound) => PortErrorKind::NotFound {
                    existing: serialport::available_ports()
                        .unwrap_or_default()
                        .into_iter()
                        .map(|port| port.port_name)
                        .collect(),
                },
                ErrorKind::Io(io::ErrorKind::PermissionDenied) => PortErrorKind::PermissionDenied,
                ErrorKind::Io(io::ErrorKind::ResourceBusy) => PortErrorKind::Busy,
                _ => PortErrorKind::Other(error.description),
            };
            PortError { port: name.to_owned(), kind }
        })?;
        let port = Self { name: name.to_owned(), inner };
        port.inner.clear(ClearBuffer::Input).map_err(|error| port.io_error(&error.into()))?;
        Ok(port)
    }

    /// A second handle of the same port, for another thread.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the system gives none.
    pub fn try_clone(&self) -> Result<Self, PortError> {
        let inner = self.inner.try_clone().map_err(|error| self.io_error(&error.into()))?;
        Ok(Self { name: self.name.clone(), inner })
    }

    /// Names of this computer's serial ports.
    #[must_use]
    pub fn names() -> Vec<String> {
        let ports = serialport::available_ports().unwrap_or_default();
        ports.into_iter().map(|port| port.port_name).collect()
    }

    /// A pseudo terminal: (the machine's end, the host's end). Any program may open the host's end by its
    /// name, which [`name`](Self::name) of both ends returns.
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
            _ => self.io_error(&error),
        })
    }

    /// Sends as many of `bytes` as the port takes at once, which may be none; returns how many.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the port is gone.
    pub fn offer(&mut self, bytes: &[u8]) -> Result<usize, PortError> {
        self.inner.set_timeout(LEAST_TIMEOUT).map_err(|error| self.io_error(&error.into()))?;
        let result = match self.inner.write(bytes) {
            Ok(count) => Ok(count),
            Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) => {
                Ok(0)
            }
            Err(error) => Err(self.io_error(&error)),
        };
        let restored = self.inner.set_timeout(SEND_TIMEOUT).map_err(|error| self.io_error(&error.into()));
        restored.and(result)
    }

    /// Waits at most `wait` for bytes; returns how many came, which may be none.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the port is gone.
    pub fn receive(&mut self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        // The library waits at least a millisecond: too long for a caller that does not want to wait.
        if wait.is_zero() && self.inner.bytes_to_read().is_ok_and(|waiting| waiting == 0) {
            return Ok(0);
        }
        let until = Instant::now() + wait;
        self.inner.set_timeout(wait.max(LEAST_TIMEOUT)).map_err(|error| self.io_error(&error.into()))?;
        let result = loop {
            match self.inner.read(bytes) {
                Ok(0) if !bytes.is_empty() => break Err(self.error(PortErrorKind::Gone)),
                Ok(count) => break Ok(count),
                Err(error) if error.kind() == io::ErrorKind::TimedOut => break Ok(0),
                Err(error) if error.kind() == io::ErrorKind::Interrupted && Instant::now() < until => {}
                Err(error) if error.kind() == io::ErrorKind::Interrupted => break Ok(0),
                Err(error) => break Err(self.io_error(&error)),
            }
        };
        let restored = self.inner.set_timeout(SEND_TIMEOUT).map_err(|error| self.io_error(&error.into()));
        restored.and(result)
    }

    /// Both directions of the port for a [`relay`](crate::record::relay), with time-outs of 200 ms.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the system gives no second handle.
    pub fn into_relay_end(mut self) -> Result<crate::record::RelayEnd, PortError> {
        let prepared = self.inner.set_timeout(RELAY_TIMEOUT).and_then(|()| self.inner.try_clone());
        let writer = prepared.map_err(|error| self.io_error(&error.into()))?;
        Ok(crate::record::RelayEnd {
            name: self.name,
            reader: Box::new(self.inner),
            writer: Box::new(writer),
        })
    }

    /// Name of the port.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    fn error(&self, kind: PortErrorKind) -> PortError {
        PortError { port: self.name.clone(), kind }
    }

    fn io_error(&self, error: &io::Error) -> PortError {
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
        let port = |name: &str, description: &str, is_usb| KnownPort {
            name: name.to_owned(),
            description: description.to_owned(),
            is_usb,
        };
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
        assert!(matches!(error.kind, PortErrorKind::NotFound { .. }), "{error:?}");
        assert!(
            error.to_string().starts_with("/dev/no-such-plotter: there is no such serial port"),
            "{error}"
        );
    }
}
