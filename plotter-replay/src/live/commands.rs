//! [`Command`] and [`State`]: what a person may ask of a session, and what it is doing.

/// What a person asks of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// Begin with the drawing.
    Start,
    /// Send no further target; the one under way is finished.
    Pause,
    /// Go on, after a pause or an emergency stop.
    Resume,
    /// Emergency stop.
    Stop,
    /// Forget what was drawn so far, on the screen only.
    Clear,
}

impl Command {
    /// The command of a name: `start`, `pause`, `resume`, `stop`, `clear`.
    ///
    /// ```
    /// # use plotter_replay::live::Command;
    /// assert_eq!(Command::from_name("stop"), Some(Command::Stop));
    /// assert_eq!(Command::from_name("explode"), None);
    /// ```
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "start" => Self::Start,
            "pause" => Self::Pause,
            "resume" => Self::Resume,
            "stop" => Self::Stop,
            "clear" => Self::Clear,
            _ => return None,
        })
    }
}

/// What a session is doing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum State {
    /// It has a drawing and waits for [`Command::Start`].
    Ready,
    /// It has no drawing and listens only.
    Watching,
    /// It draws.
    Running,
    /// It sends no further target.
    Paused,
    /// The emergency stop is pressed.
    Stopped,
    /// Every target is reached, or as many as could be.
    Done,
    /// The line failed: why.
    Failed(String),
}

impl State {
    /// One word for it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ready => "ready",
            Self::Watching => "watching",
            Self::Running => "running",
            Self::Paused => "paused",
            Self::Stopped => "stopped",
            Self::Done => "done",
            Self::Failed(_) => "failed",
        }
    }

    /// Whether it stays so for ever.
    #[must_use]
    pub fn is_final(&self) -> bool {
        matches!(self, Self::Done | Self::Failed(_))
    }

    /// The state after a command.
    pub(super) fn after(&self, command: Command) -> Option<Self> {
        match (command, self) {
            (Command::Start, Self::Ready) | (Command::Resume, Self::Paused | Self::Stopped) => {
                Some(Self::Running)
            }
            (Command::Pause, Self::Running) => Some(Self::Paused),
            (Command::Stop, Self::Running | Self::Paused | Self::Ready | Self::Watching) => {
                Some(Self::Stopped)
            }
            _ => None,
        }
    }
}
