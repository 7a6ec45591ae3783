//! [`Silences`]: gaps on the line.

use super::few::Longest;
use core::time::Duration;

/// Gaps that are kept at most: the longest.
const MOST_GAPS: usize = 200;

/// Finds the times in which neither side sent a byte.
#[derive(Clone, Debug)]
pub(super) struct Silences {
    after: Duration,
    last: Option<Duration>,
    /// Length and start.
    longest: Longest<(Duration, Duration)>,
}

impl Silences {
    /// Looks for silences of more than `after`.
    pub(super) fn new(after: Duration) -> Self {
        Self { after, last: None, longest: Longest::new(MOST_GAPS) }
    }

    /// A byte came.
    pub(super) fn byte(&mut self, now: Duration) {
        if let Some(last) = self.last.replace(now) {
            let silence = now.saturating_sub(last);
            if silence > self.after {
                self.longest.push((silence, last));
            }
        }
    }

    pub(super) fn count(&self) -> u64 {
        self.longest.count()
    }

    /// Start and length of the longest, in their order of time.
    pub(super) fn into_vec(self) -> Vec<(Duration, Duration)> {
        let mut gaps: Vec<_> =
            self.longest.into_vec().into_iter().map(|(length, start)| (start, length)).collect();
        gaps.sort_unstable();
        gaps
    }
}
