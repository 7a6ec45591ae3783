//! The standard output, as the commands write to it.

use std::io::{self, Write};

/// The standard output, with the first failure to write to it. A closed pipe is none, and who writes on is told of it: whoever closed
/// it has seen enough.
#[derive(Debug, Default)]
pub(crate) struct Output {
    failure: Option<io::Error>,
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Err(error) = io::stdout().write_all(bytes) {
            if error.kind() == io::ErrorKind::BrokenPipe {
                return Err(error);
            }
            self.failure.get_or_insert(error);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stdout().flush()
    }
}

impl Output {
    pub(crate) fn finish(mut self) -> Result<(), String> {
        let flushed = self.flush().err().filter(|error| error.kind() != io::ErrorKind::BrokenPipe);
        match self.failure.or(flushed) {
            Some(error) => Err(format!("standard output: cannot be written: {error}")),
            None => Ok(()),
        }
    }
}
