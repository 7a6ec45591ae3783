//! The standard output, as the commands write to it.

use std::io::{self, Write};

/// What of a command's lines is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Shown {
    /// They themselves.
    #[default]
    Lines,
    /// An object with them as a list, which is written as they come.
    Json,
    /// None.
    Nothing,
}

/// The standard output, with the first failure to write to it. A closed pipe is none, and who writes on is
/// told of it: whoever closed it has seen enough.
#[derive(Debug, Default)]
pub(crate) struct Output {
    shown: Shown,
    /// Of a line of JSON what has been written so far, and whether there was one before it.
    line: Vec<u8>,
    has_lines: bool,
    failure: Option<io::Error>,
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.shown {
            Shown::Lines => self.put(bytes)?,
            Shown::Nothing => {}
            Shown::Json => {
                for part in bytes.split_inclusive(|byte| *byte == b'\n') {
                    self.line.extend_from_slice(part);
                    if part.ends_with(b"\n") {
                        self.put_line()?;
                    }
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stdout().flush()
    }
}

impl Output {
    /// For the command of that name.
    pub(crate) fn new(shown: Shown, command: &str) -> Self {
        let mut out = Self { shown, ..Self::default() };
        if shown == Shown::Json {
            // A closed pipe is told again with the first line.
            let _ = out.put(format!("{{\"command\": {}, \"said\": [", quoted(command)).as_bytes());
        }
        out
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        if let Err(error) = io::stdout().write_all(bytes) {
            if error.kind() == io::ErrorKind::BrokenPipe {
                return Err(error);
            }
            self.failure.get_or_insert(error);
        }
        Ok(())
    }

    fn put_line(&mut self) -> io::Result<()> {
        let line = core::mem::take(&mut self.line);
        let line = String::from_utf8_lossy(&line);
        let comma = if core::mem::replace(&mut self.has_lines, true) { "," } else { "" };
        self.put(format!("{comma}\n  {}", quoted(line.trim_end())).as_bytes())
    }

    /// Ends what is shown; `error` is what the command failed with.
    pub(crate) fn finish(mut self, exit_status: u8, error: Option<&str>) -> Result<(), String> {
        if self.shown == Shown::Json {
            if !self.line.is_empty() {
                let _ = self.put_line();
            }
            let error = error.map(|error| format!(", \"error\": {}", quoted(error))).unwrap_or_default();
            let _ = self.put(format!("\n], \"exit_status\": {exit_status}{error}}}\n").as_bytes());
        }
        let flushed = self.flush().err().filter(|error| error.kind() != io::ErrorKind::BrokenPipe);
        match self.failure.or(flushed) {
            Some(error) => Err(format!("standard output: cannot be written: {error}")),
            None => Ok(()),
        }
    }
}

/// A text as JSON has it.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
