//! [`RecordingTraits`]: what a recording has that decides how it is run again.

use super::{EdgeSource, LinkedMachine, PlayerSettings};
use crate::frames::{Introduction, IntroductionSearch};
use crate::log::{Event, Header, Record};
use core::time::Duration;

/// Time by which an answer may be off when the edges are only known from the pulses.
const PULSE_TOLERANCE: Duration = Duration::from_millis(50);
/// The same where they are known from messages, which a bad line holds up.
const MESSAGE_TOLERANCE: Duration = Duration::from_secs(1);
/// Bytes in which a machine would have greeted.
const MOST_FIRST: usize = 64;

/// What a recording has that decides how it is run again, gathered record by record.
#[derive(Clone, Debug, Default)]
pub struct RecordingTraits {
    has_edges: bool,
    has_duties: bool,
    search: IntroductionSearch,
    /// The machine's first bytes.
    first: Vec<u8>,
}

impl RecordingTraits {
    /// Takes the next record.
    pub fn look(&mut self, record: &Record) {
        match record.event {
            Event::Edge { .. } => self.has_edges = true,
            Event::Drive { .. } => self.has_duties = true,
            Event::Host(_) | Event::Controller(_) => self.search.push(record),
            _ => {}
        }
        if let Event::Controller(bytes) = &record.event {
            let room = MOST_FIRST.saturating_sub(self.first.len());
            self.first.extend(bytes.iter().take(room));
        }
    }

    /// How such a recording with this header is run again: with its edges if it has any, exactly; else with
    /// what the machine told of its motors, within 50 ms by pulses and within 1 s by messages. A controller
    /// that `makes_steps` needs no edges: without them its bytes are compared within 50 ms, and not its
    /// steps.
    #[must_use]
    pub fn settings(&self, header: &Header, makes_steps: bool) -> PlayerSettings {
        let (edges, tolerance) = match (self.has_edges, self.search.found) {
            (true, _) => (EdgeSource::Records, Duration::ZERO),
            // The steps of a machine on a line are in no log of that line: its bytes are compared.
            (false, _) if makes_steps => (EdgeSource::Pulses, PULSE_TOLERANCE),
            (false, Some(_)) => (EdgeSource::Messages, MESSAGE_TOLERANCE),
            (false, None) => (EdgeSource::Pulses, PULSE_TOLERANCE),
        };
        PlayerSettings {
            edges,
            tolerance,
            tells_duties: self.has_duties,
            ..PlayerSettings::from_header(header)
        }
    }

    /// The header with what the machine says of itself, if it speaks frames.
    #[must_use]
    pub fn header(&self, header: &Header) -> Header {
        match self.search.found {
            Some(Introduction { hello, boot, .. }) => {
                LinkedMachine { boot, window: hello.window, payload: hello.payload }
                    .written_to(header.clone())
            }
            None => header.clone(),
        }
    }

    /// Whether the machine of a session of lines was on before the log began: it does not greet in it.
    pub(super) fn is_greeted_before(&self) -> bool {
        !self.first.is_empty() && !self.first.windows(5).any(|window| window == b"Grbl ")
    }

    /// Targets that the machine had taken and not reached when it was heard first: with them the recording
    /// begins in the middle of a way that it does not show.
    #[must_use]
    pub fn under_way_before(&self) -> u32 {
        self.search.found.map_or(0, |found| found.taken.wrapping_sub(found.reached))
    }
}
