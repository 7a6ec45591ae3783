//! [`Tap`]: the host's own end of a line, recorded.

use super::Recorder;
use crate::import::Side;
use std::io::{self, Read, Write};

/// A connection to a plotter that records what is sent and what comes: put it round a port, and use it as the
/// port.
///
/// ```
/// # use plotter_replay::log::{Header, Writer};
/// # use plotter_replay::record::{Recorder, Tap};
/// # use std::io::{Cursor, Read, Write};
/// let recorder = Recorder::new(Writer::new(Vec::new(), &Header::new())?, |error| eprintln!("{error}"))?;
/// let mut port = Tap::new(Cursor::new(b"131+".to_vec()), recorder.clone());
/// let mut answer = [0; 3];
/// port.read_exact(&mut answer)?;
/// port.write_all(&[2])?;
/// let recorded = recorder.finish()?;
/// assert_eq!((recorded.controller_bytes, recorded.host_bytes), (3, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Tap<P> {
    port: P,
    recorder: Recorder,
}

impl<P> Tap<P> {
    /// A recorded connection.
    #[must_use]
    pub const fn new(port: P, recorder: Recorder) -> Self {
        Self { port, recorder }
    }

    /// The connection itself.
    #[must_use]
    pub const fn get_ref(&self) -> &P {
        &self.port
    }

    /// The connection itself, to be set up.
    pub const fn get_mut(&mut self) -> &mut P {
        &mut self.port
    }

    /// Gives the connection back, and the recording.
    #[must_use]
    pub fn into_parts(self) -> (P, Recorder) {
        (self.port, self.recorder)
    }
}

impl<P: Read> Read for Tap<P> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.port.read(buffer)?;
        self.recorder.bytes(Side::Controller, buffer.get(..count).unwrap_or_default());
        Ok(count)
    }
}

impl<P: Write> Write for Tap<P> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.port.write(bytes)?;
        self.recorder.bytes(Side::Host, bytes.get(..count).unwrap_or_default());
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.port.flush()
    }
}
