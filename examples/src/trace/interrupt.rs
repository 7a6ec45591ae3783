//! [`Interrupt`]: Ctrl-C asks a tool to stop; what it writes is whole or not there.

use crate::shared::ExitStatus;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the tool is to stop, and whether it may be ended on the spot.
static ASKED: AtomicBool = AtomicBool::new(false);
static WRITING: AtomicBool = AtomicBool::new(false);

/// Ctrl-C, as a request that long work looks at. A second one ends the process at once, unless files are
/// being written.
#[derive(Clone, Copy, Debug)]
pub struct Interrupt(());

impl Interrupt {
    /// Waits for Ctrl-C from now on; once a process.
    ///
    /// # Errors
    ///
    /// The system cannot, or it is waited for already.
    pub fn new() -> Result<Self, String> {
        let asked = || {
            if ASKED.swap(true, Ordering::SeqCst) && !WRITING.load(Ordering::SeqCst) {
                std::process::exit(ExitStatus::Interrupted.code().into());
            }
        };
        ctrlc::set_handler(asked).map_err(|error| format!("Ctrl-C cannot be waited for: {error}"))?;
        Ok(Self(()))
    }

    /// Whether the work is to stop.
    #[must_use]
    pub fn is_asked(self) -> bool {
        ASKED.load(Ordering::SeqCst)
    }

    /// Whether files may be written, which nothing breaks off from now on; not after a request to stop.
    #[must_use]
    pub fn may_write(self) -> bool {
        WRITING.store(true, Ordering::SeqCst);
        !self.is_asked()
    }
}
