//! [`RecordingTraits`]: what a recording has that decides how it is run again.

use super::{EdgeSource, LinkedMachine, PlayerSettings};
use crate::frames::{Introduction, IntroductionSearch};
use crate::log::{Event, Header, Record};
use core::time::Duration;

/// Time by which an answer may be off when the edges are only known from the pulses.
const PULSE_TOLERANCE: Duration = Duration::from_millis(50);
/// The same where they are known from messages, which a bad line holds up.
const MESSAGE_TOLERANCE: Duration = Duration::from_secs(1);

/// What a recording has that decides how it is run again, gathered record by record.
#[derive(Clone, Debug, Default)]
pub struct RecordingTraits {
    has_edges: bool,
    has_duties: bool,
    search: IntroductionSearch,
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
    }

    /// How such a recording with this header is run again: with its edges if it has any, exactly; else with
    /// what the machine told of its motors, within 50 ms by pulses and within 1 s by messages. A controller
    /// that `makes_steps` needs no edges.
    #[must_use]
    pub fn settings(&self, header: &Header, makes_steps: bool) -> PlayerSettings {
        let (edges, tolerance) = match (self.has_edges || makes_steps, self.search.found) {
            (true, _) => (EdgeSource::Records, Duration::ZERO),
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

    /// Targets that the machine had taken and not reached when it was heard first: with them the recording
    /// begins in the middle of a way that it does not show.
    #[must_use]
    pub fn under_way_before(&self) -> u32 {
        self.search.found.map_or(0, |found| found.taken.wrapping_sub(found.reached))
    }
}
