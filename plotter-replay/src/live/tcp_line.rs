//! [`TcpLine`]: a line on a port of 127.0.0.1, for programs that know no pseudo terminals.

use super::line::{Line, lock, send_all};
use crate::serial::{PortError, PortErrorKind};
use core::time::Duration;
use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, TcpListener, TcpStream};
use std::sync::Mutex;

/// A line to whoever has connected to a port of this computer: one program at a time, as on a cable; who goes
/// away may come again. A second one is sent away.
#[derive(Debug)]
pub struct TcpLine {
    listener: TcpListener,
    host: Mutex<Option<TcpStream>>,
    news: Mutex<Vec<&'static str>>,
    name: String,
}

impl TcpLine {
    /// Listens on this port of 127.0.0.1; 0 takes any that is free.
    ///
    /// # Errors
    ///
    /// [`PortError`] if the port is taken.
    pub fn open(port: u16) -> Result<Self, PortError> {
        let refused = |error: io::Error| PortError {
            port: format!("127.0.0.1:{port}"),
            kind: match error.kind() {
                io::ErrorKind::AddrInUse => PortErrorKind::Busy,
                io::ErrorKind::PermissionDenied => PortErrorKind::PermissionDenied,
                _ => PortErrorKind::Other(error.to_string()),
            },
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        let name = listener.local_addr().map_err(refused)?.to_string();
        Ok(Self { listener, host: Mutex::default(), news: Mutex::default(), name })
    }

    /// Where it is.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Who has come and gone since it was asked last.
    #[must_use]
    pub fn take_news(&self) -> Vec<&'static str> {
        core::mem::take(&mut *lock(&self.news))
    }

    /// Lets in who waits; only the first.
    fn accept(&self, host: &mut Option<TcpStream>) {
        while let Ok((stream, _)) = self.listener.accept() {
            if host.is_some() {
                let _ = stream.shutdown(Shutdown::Both); // it may be gone already
                lock(&self.news).push("another program was sent away: one has the line");
                continue;
            }
            // What is written goes out at once: a line has no packets.
            let ready = stream.set_nodelay(true).and_then(|()| stream.set_nonblocking(true));
            if ready.is_ok() {
                lock(&self.news).push("a program has connected");
                *host = Some(stream);
            }
        }
    }

    /// What has come.
    fn read(&self, bytes: &mut [u8]) -> usize {
        let host = &mut *lock(&self.host);
        self.accept(host);
        let Some(stream) = host else { return 0 };
        match stream.read(bytes) {
            Ok(count) if count > 0 || bytes.is_empty() => count,
            Err(error) if passes(&error) => 0,
            _ => {
                self.lose(host);
                0
            }
        }
    }

    fn lose(&self, host: &mut Option<TcpStream>) {
        *host = None;
        lock(&self.news).push("the program has gone");
    }
}

/// Nothing there, or an interruption, after which the line is as before.
pub(super) fn passes(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}

impl Line for TcpLine {
    fn send(&self, bytes: &[u8]) -> Result<(), PortError> {
        send_all(self, &self.name, bytes)
    }

    fn offer(&self, bytes: &[u8]) -> Result<usize, PortError> {
        let host = &mut *lock(&self.host);
        let Some(stream) = host else { return Ok(bytes.len()) }; // said to nobody
        match stream.write(bytes) {
            Ok(count) => Ok(count),
            Err(error) if passes(&error) => Ok(0),
            Err(_) => {
                self.lose(host);
                Ok(bytes.len())
            }
        }
    }

    fn receive(&self, bytes: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let count = self.read(bytes);
        if count > 0 {
            return Ok(count);
        }
        // Systems wait for a socket in ticks of some milliseconds: a simulated machine would be that slow.
        std::thread::sleep(wait);
        Ok(self.read(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::NetLine;
    use std::sync::Arc;

    #[test]
    fn what_a_full_line_does_not_take_at_once_is_sent_later() {
        /// More than a socket keeps for a program that does not read.
        const BYTES: usize = 1 << 24;
        let machine = Arc::new(TcpLine::open(0).unwrap());
        let host = NetLine::connect(machine.name()).unwrap();
        host.send(b"?").unwrap();
        let mut byte = [0; 1];
        while machine.receive(&mut byte, Duration::from_millis(1)).unwrap() == 0 {}
        let answers: Arc<Vec<u8>> = Arc::new((0..=250_u8).cycle().take(BYTES).collect());
        let (line, sent) = (Arc::clone(&machine), Arc::clone(&answers));
        let sender = std::thread::spawn(move || line.send(&sent));
        std::thread::sleep(Duration::from_millis(50)); // nobody reads for a while
        let (mut heard, mut bytes) = (Vec::with_capacity(BYTES), vec![0; 1 << 16]);
        while heard.len() < BYTES {
            let count = host.receive(&mut bytes, Duration::from_secs(10)).unwrap();
            assert!(count > 0, "{} of {BYTES} bytes have come", heard.len());
            heard.extend_from_slice(&bytes[..count]);
        }
        sender.join().unwrap().unwrap();
        assert!(heard == *answers);
    }
}
