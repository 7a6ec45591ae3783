//! [`NetLine`]: the line to a machine behind a TCP port: a board on a network, a server of serial ports, or
//! `simulate --tcp`.

use super::line::{LOOK_EVERY, Line, lock, send_all};
use super::tcp_line::passes;
use crate::serial::{PortError, PortErrorKind};
use core::time::Duration;
use std::io::{self, Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::Mutex;
use std::time::Instant;

/// So long a machine has to let a program in: one of the same house needs some milliseconds.
const CONNECT_WITHIN: Duration = Duration::from_secs(5);

/// The line to a machine behind a TCP port, which passes the bytes of a serial line and nothing else.
#[derive(Debug)]
pub struct NetLine {
    reader: Mutex<TcpStream>,
    writer: Mutex<TcpStream>,
    name: String,
}

impl NetLine {
    /// Connects to `address`, a host's name or number, a colon, and a port: `127.0.0.1:7000`.
    ///
    /// # Errors
    ///
    /// [`PortError`] if nobody there lets it in within five seconds.
    pub fn connect(address: &str) -> Result<Self, PortError> {
        let error = |error: &dyn core::fmt::Display| PortError {
            port: format!("tcp:{address}"),
            kind: PortErrorKind::Other(format!(
                "{error}: is the machine on, and are the host and its port right?"
            )),
        };
        let mut last = None;
        for place in address.to_socket_addrs().map_err(|failed| error(&failed))? {
            match TcpStream::connect_timeout(&place, CONNECT_WITHIN) {
                Ok(stream) => return Self::of(stream, address).map_err(|failed| error(&failed)),
                Err(failed) => last = Some(failed),
            }
        }
        Err(last.map_or_else(|| error(&"no such host"), |failed| error(&failed)))
    }

    fn of(stream: TcpStream, address: &str) -> io::Result<Self> {
        stream.set_nodelay(true)?; // what is written goes out at once: a line has no packets
        stream.set_nonblocking(true)?;
        let writer = Mutex::new(stream.try_clone()?);
        Ok(Self { reader: Mutex::new(stream), writer, name: format!("tcp:{address}") })
    }

    fn error(&self, words: &str) -> PortError {
        PortError { port: self.name.clone(), kind: PortErrorKind::Other(String::from(words)) }
    }
}

impl Line for NetLine {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        send_all(self, &self.name, bytes)
    }

    fn offer(&self, bytes: &[u8]) -> Result<usize, PortError> {
        match lock(&self.writer).write(bytes) {
            Ok(count) => Ok(count),
            Err(error) if passes(&error) => Ok(0),
            Err(error) => Err(self.error(&error.to_string())),
        }
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let until = Instant::now() + wait;
        loop {
            match lock(&self.reader).read(bytes) {
                Ok(0) if !bytes.is_empty() => {
                    return Err(self.error(
                        "the other end has closed the line: is it off, or has another program the line?",
                    ));
                }
                Ok(count) => return Ok(count),
                Err(error) if passes(&error) => {}
                Err(error) => return Err(self.error(&error.to_string())),
            }
            let rest = until.saturating_duration_since(Instant::now());
            if rest.is_zero() {
                return Ok(0);
            }
            std::thread::sleep(rest.min(LOOK_EVERY));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::TcpLine;

    #[test]
    fn bytes_go_both_ways_and_a_line_that_is_closed_says_so() {
        let machine = TcpLine::open(0).unwrap();
        let line = NetLine::connect(machine.name()).unwrap();
        line.send(b"?").unwrap();
        let mut bytes = [0; 8];
        let until = Instant::now() + Duration::from_secs(10);
        while machine.receive(&mut bytes, LOOK_EVERY).unwrap() == 0 {
            assert!(Instant::now() < until, "nothing came");
        }
        assert_eq!(bytes[0], b'?');
        assert_eq!(line.receive(&mut bytes, LOOK_EVERY).unwrap(), 0, "nobody has said anything");
        machine.send(b"ok").unwrap();
        let mut heard = Vec::new();
        while heard.len() < 2 {
            let count = line.receive(&mut bytes, Duration::from_millis(100)).unwrap();
            heard.extend_from_slice(&bytes[..count]);
            assert!(Instant::now() < until, "nothing came");
        }
        assert_eq!(heard, b"ok");
        let name = machine.name().to_owned();
        drop(machine);
        let closed = line.receive(&mut bytes, Duration::from_secs(10)).unwrap_err();
        assert!(closed.to_string().contains("has closed the line"), "{closed}");
        let refused = NetLine::connect(&name).unwrap_err().to_string();
        assert!(
            refused.starts_with(&format!("tcp:{name}: ")) && refused.contains("is the machine on"),
            "{refused}"
        );
    }
}
