//! [`FaultInjector`]: one direction of a serial line that damages what goes over it.

use core::ops::Range;
use core::time::Duration;
use plotter_motion::SplitMix64;

/// What happens to bytes on a bad line. Each probability is that of a byte, 0 to 1; of several faults a byte
/// has one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// It is lost.
    pub drop: f64,
    /// It comes as another one, any of the 255.
    pub flip: f64,
    /// It comes twice.
    pub duplicate: f64,
    /// Another one comes before it.
    pub insert: f64,
    /// It is held back, and all behind it, for [`held_for`](Self::held_for): an adapter's buffer.
    pub delay: f64,
    /// For how long.
    pub held_for: Duration,
    /// Noise begins with it, as of a motor or a relay that is switched: this byte and those behind it come as
    /// other ones.
    pub burst: f64,
    /// How many bytes the noise changes in all, one after the other.
    pub burst_bytes: u32,
    /// When the cable is out: nothing comes.
    pub cut: Vec<Range<Duration>>,
}

impl Faults {
    /// Each fifth of `share` of all bytes is lost, changed, doubled, comes after another one, or is held back
    /// for 20 ms.
    ///
    /// ```
    /// # use plotter_replay::transport::Faults;
    /// assert_eq!(Faults::mixed(0.01).flip, 0.002);
    /// ```
    #[must_use]
    pub fn mixed(share: f64) -> Self {
        let each = share / 5.0;
        Self {
            drop: each,
            flip: each,
            duplicate: each,
            insert: each,
            delay: each,
            held_for: Duration::from_millis(20),
            burst: 0.0,
            burst_bytes: 0,
            cut: Vec::new(),
        }
    }
}

/// Counts of the faults that a [`FaultInjector`] has made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts {
    /// Bytes offered.
    pub bytes: u64,
    /// Of these, lost by a fault.
    pub dropped: u64,
    /// Changed.
    pub flipped: u64,
    /// Doubled.
    pub duplicated: u64,
    /// Preceded by another.
    pub inserted: u64,
    /// Held back.
    pub delayed: u64,
    /// Changed by noise that lasts.
    pub burst: u64,
    /// Lost while the cable was out.
    pub cut: u64,
}

impl FaultCounts {
    /// Bytes that did not come as they were sent, or not at once.
    #[must_use]
    pub const fn damaged(&self) -> u64 {
        self.dropped + self.flipped + self.duplicated + self.inserted + self.delayed + self.burst + self.cut
    }
}

/// Damages bytes by lot; the same seed always in the same way.
///
/// ```
/// # use core::time::Duration;
/// # use plotter_replay::transport::{FaultInjector, Faults};
/// let mut line = FaultInjector::new(Faults { duplicate: 1.0, ..Faults::default() }, 7);
/// let came: Vec<_> = line.pass(Duration::from_millis(5), b'+').collect();
/// assert_eq!(came, [(Duration::from_millis(5), b'+'), (Duration::from_millis(5), b'+')]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FaultInjector {
    faults: Faults,
    random: SplitMix64,
    held_until: Duration,
    /// Bytes that the noise of now still changes.
    burst_left: u32,
    counts: FaultCounts,
}

impl FaultInjector {
    /// A line with `faults`.
    #[must_use]
    pub const fn new(faults: Faults, seed: u64) -> Self {
        Self {
            faults,
            random: SplitMix64::new(seed),
            held_until: Duration::ZERO,
            burst_left: 0,
            counts: FaultCounts {
                bytes: 0,
                dropped: 0,
                flipped: 0,
                duplicated: 0,
                inserted: 0,
                delayed: 0,
                burst: 0,
                cut: 0,
            },
        }
    }

    /// Counts of the faults made so far.
    #[must_use]
    pub const fn counts(&self) -> FaultCounts {
        self.counts
    }

    /// What comes of a byte that would be through at `time`, and when: none, one or two bytes, never before
    /// those of an earlier call.
    pub fn pass(&mut self, time: Duration, byte: u8) -> impl Iterator<Item = (Duration, u8)> + use<> {
        let mut came = [None, None];
        self.counts.bytes += 1;
        let lot = self.random.unit();
        let [other, ..] = self.random.bits().to_be_bytes();
        let Faults { drop, flip, duplicate, insert, delay, burst, burst_bytes, .. } = self.faults;
        let mut below = 0.0;
        let mut falls = |probability: f64| {
            let fell = (below..below + probability).contains(&lot);
            below += probability;
            fell
        };
        let counts = &mut self.counts;
        if self.faults.cut.iter().any(|cut| cut.contains(&time)) {
            counts.cut += 1;
        } else if let Some(left) = self.burst_left.checked_sub(1) {
            self.burst_left = left;
            counts.burst += 1;
            came = [Some(byte ^ (other % 255 + 1)), None];
        } else if falls(drop) {
            counts.dropped += 1;
        } else if falls(flip) {
            counts.flipped += 1;
            // 1 to 255: another one for certain
            came = [Some(byte ^ (other % 255 + 1)), None];
        } else if falls(duplicate) {
            counts.duplicated += 1;
            came = [Some(byte), Some(byte)];
        } else if falls(insert) {
            counts.inserted += 1;
            came = [Some(other), Some(byte)];
        } else if falls(delay) {
            counts.delayed += 1;
            self.held_until = self.held_until.max(time.saturating_add(self.faults.held_for));
            came = [Some(byte), None];
        } else if burst_bytes > 0 && falls(burst) {
            self.burst_left = burst_bytes - 1;
            counts.burst += 1;
            came = [Some(byte ^ (other % 255 + 1)), None];
        } else {
            came = [Some(byte), None];
        }
        let time = time.max(self.held_until);
        came.into_iter().flatten().map(move |byte| (time, byte))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_fault_has_its_share_and_the_seed_decides() {
        let run = |seed| {
            let mut line = FaultInjector::new(Faults::mixed(0.05), seed);
            let came: Vec<_> = (0..100_000)
                .flat_map(|n| line.pass(Duration::from_micros(39 * n), n.to_le_bytes()[0]))
                .collect();
            (came, line.counts())
        };
        let (came, counts) = run(1);
        for count in [counts.dropped, counts.flipped, counts.duplicated, counts.inserted, counts.delayed] {
            assert!((900..1100).contains(&count), "{counts:?}");
        }
        assert_eq!(came.len() as u64, 100_000 - counts.dropped + counts.duplicated + counts.inserted);
        assert!(came.is_sorted_by_key(|&(at, _)| at));
        assert_eq!(run(1).0, came);
        assert_ne!(run(2).0, came);
    }

    #[test]
    fn a_burst_changes_as_many_bytes_as_it_lasts() {
        let faults = Faults { burst: 0.001, burst_bytes: 20, ..Faults::default() };
        let mut line = FaultInjector::new(faults, 1);
        let came: Vec<u8> = (0..100_000)
            .flat_map(|n| line.pass(Duration::from_micros(39 * n), 7))
            .map(|(_, byte)| byte)
            .collect();
        let changed = came.iter().filter(|byte| **byte != 7).count();
        assert_eq!((came.len(), changed as u64), (100_000, line.counts().burst));
        // A hundred bursts in what is not burst: 100,000 / 1.02 of a thousandth, 20 bytes each.
        assert!((1500..2500).contains(&changed), "{changed}");
        let runs = came.chunk_by(|a, b| (*a == 7) == (*b == 7)).filter(|run| run[0] != 7);
        assert!(runs.map(<[u8]>::len).all(|length| length % 20 == 0 || length == changed % 20));
    }

    #[test]
    fn nothing_comes_over_a_cable_that_is_out() {
        let cut = vec![Duration::from_secs(1)..Duration::from_secs(2)];
        let mut line = FaultInjector::new(Faults { cut, ..Faults::default() }, 1);
        assert_eq!(line.pass(Duration::from_millis(1500), 1).count(), 0);
        assert_eq!(line.pass(Duration::from_secs(2), 1).count(), 1);
    }
}
