//! Records a plotter's serial line, shows what a log of it holds, draws it, and runs the controller again on
//! it.
//!
//! Exit status: 0 clean, 1 damage or a difference found, 2 unreadable, not writable or a wrong command line.

use std::process::ExitCode;

/// Records a plotter's serial line, shows what a log of it holds, draws it, and runs the controller again on
/// it.
///
/// Exit status: 0 clean, 1 damage or a difference found, 2 unreadable, not writable or a wrong command line.
#[derive(Debug, Parser)]
#[command(version, after_help = "Example: plotter-replay render session.plog.gz -o pictures")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let mut out = Output::default();
    let done = Arguments::parse().command.run(&mut out);
    match done.and_then(|verdict| out.finish().map(|()| verdict)) {
        Ok(Verdict::Clean) => ExitCode::SUCCESS,
        Ok(Verdict::Found) => ExitCode::from(1),
        Err(message) => {
            // Nobody is left to tell when standard error is closed.
            let _ = writeln!(std::io::stderr(), "plotter-replay: {message}");
            ExitCode::from(2)
        }
    }
}

/// The standard output, with the first failure to write to it. A closed pipe is none, and who writes on is
/// told of it: whoever closed it has seen enough.
#[derive(Debug, Default)]
struct Output {
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
    fn finish(mut self) -> Result<(), String> {
        let flushed = self.flush().err().filter(|error| error.kind() != io::ErrorKind::BrokenPipe);
        match self.failure.or(flushed) {
            Some(error) => Err(format!("standard output: cannot be written: {error}")),
            None => Ok(()),
        }
    }
}
