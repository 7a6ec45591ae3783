//! [`ExitStatus`]: what the exit codes of all tools mean, in one place.

use std::fmt::Write as _;
use std::process::ExitCode;

/// How a tool ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitStatus {
    /// All was done.
    Done,
    /// It was not, or not as well as promised.
    Failed,
    /// The command line was wrong.
    WrongUse,
    /// Ctrl-C ended it.
    Interrupted,
}

impl ExitStatus {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Done, Self::Failed, Self::WrongUse, Self::Interrupted];

    /// What a shell sees. Of an interrupt it is 128 and the number of the signal.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => 1,
            Self::WrongUse => 2,
            Self::Interrupted => 130,
        }
    }

    /// What it means. Commands on recordings tell a recording that is unlike another, 1, from one that cannot
    /// be read, 2.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Done => "done; of a recording: nothing wrong was found",
            Self::Failed => "not done, or not as promised; of a recording: damage or a difference was found",
            Self::WrongUse => "wrong command line; of a recording: it cannot be read or written",
            Self::Interrupted => "ended by Ctrl-C; nothing is written",
        }
    }

    /// All of them as lines of a help.
    #[must_use]
    pub fn table() -> String {
        let mut text = String::from("Exit status:");
        for status in Self::ALL {
            let _ = write!(text, "\n  {:<4}{}", status.code(), status.meaning());
        }
        text
    }
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        status.code().into()
    }
}
