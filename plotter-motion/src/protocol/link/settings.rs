//! [`LinkSettings`], how patient a link is, and [`LinkCounts`], what it has been through.

use core::time::Duration;

/// Times of a [`Link`](super::Link), and what its side can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct LinkSettings {
    /// Time between two calls or greetings that are not answered, 100 ms by default.
    pub call_again: Duration,
    /// How often a host calls before it takes the machine for one of the digits protocol, 10 times by
    /// default.
    pub most_calls: u8,
    /// Shortest time after which a frame without answer is sent again, 30 ms by default: adapters of USB hold
    /// bytes back for up to 16 ms.
    pub least_retry: Duration,
    /// Longest such time, 500 ms by default: so long at most after a cable is plugged in again, it goes on.
    pub most_retry: Duration,
    /// Silence after which a side says that it is there, 200 ms by default.
    pub keep_alive: Duration,
    /// Silence of the other side after which the link counts as interrupted, 1 s by default.
    pub interrupted_after: Duration,
    /// What else this side can do; the link knows nothing of it. No byte of a host's may be an
    /// [`Order`](super::super::Order): a machine without a session obeys it.
    pub capabilities: u32,
}

impl Default for LinkSettings {
    fn default() -> Self {
        Self {
            call_again: Duration::from_millis(100),
            most_calls: 10,
            least_retry: Duration::from_millis(30),
            most_retry: Duration::from_millis(500),
            keep_alive: Duration::from_millis(200),
            interrupted_after: Duration::from_secs(1),
            capabilities: 0,
        }
    }
}

/// Counters of a link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkCounts {
    /// Frames that came whole.
    pub frames: u32,
    /// Frames that came damaged, and noise between frames.
    pub damaged: u32,
    /// Frames that came a second time, or found no room.
    pub repeated: u32,
    /// Frames sent again.
    pub sent_again: u32,
}
