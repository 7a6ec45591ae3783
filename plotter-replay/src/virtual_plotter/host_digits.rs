//! The host's side of a recorded line: digits into targets, whatever the log begins or ends with.

use super::AnomalyKind;
use core::time::Duration;
use plotter_motion::StepPoint;
use plotter_motion::protocol::digits::TARGET_BYTES;

/// Digits that are held back at most while it is open where the first target begins.
const MAX_OPEN: usize = 1_000;

/// What came out of the digits, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Decoded {
    Target(Duration, StepPoint),
    Odd(Duration, AnomalyKind),
}

/// Turns recorded host bytes into targets.
///
/// A log may begin anywhere, so it is open where the first target begins until the controller answers, which
/// it does only to a whole target: so many digits as are not a multiple of ten by then belong to a target
/// that began before the log.
#[derive(Clone, Debug)]
pub(super) struct HostDigits {
    resync_gap: Duration,
    digits: Vec<(Duration, u8)>,
    aligned: bool,
    last: Option<Duration>,
}

impl HostDigits {
    pub(super) fn new(resync_gap: Duration) -> Self {
        Self { resync_gap, digits: Vec::new(), aligned: false, last: None }
    }

    /// Takes one host byte.
    pub(super) fn push(&mut self, now: Duration, byte: u8) -> Vec<Decoded> {
        let mut out = Vec::new();
        let silence = self.last.map_or(Duration::ZERO, |last| now.saturating_sub(last));
        self.last = Some(now);
        if silence > self.resync_gap && !self.digits.is_empty() {
            // A host pauses so long only where a target ends.
            out.append(&mut self.align());
            if let digits @ 1.. = self.drop_partial() {
                out.push(Decoded::Odd(now, AnomalyKind::SilenceInsideTarget { silence, digits }));
            }
        }
        if byte > 9 {
            out.push(Decoded::Odd(now, AnomalyKind::NotADigit { byte }));
            return out;
        }
        self.digits.push((now, byte));
        if self.aligned {
            out.extend(self.take_target());
        } else if self.digits.len() >= MAX_OPEN {
            // As many digits without an answer are a recording of the host alone: taken from its beginning.
            self.aligned = true;
            out.append(&mut self.take_targets());
        }
        out
    }

    /// The digits so far end where a target ends: the controller answered.
    pub(super) fn align(&mut self) -> Vec<Decoded> {
        if self.aligned || self.digits.is_empty() {
            // An answer before the first digit settles that the next digit is a first one.
            self.aligned = true;
            return Vec::new();
        }
        self.aligned = true;
        let mut out = Vec::new();
        let over = self.digits.len() % TARGET_BYTES;
        if over > 0 {
            let time = self.digits.first().map_or(Duration::ZERO, |&(time, _)| time);
            self.digits.drain(..over);
            out.push(Decoded::Odd(time, AnomalyKind::BeganInsideTarget { digits: over }));
        }
        out.append(&mut self.take_targets());
        out
    }

    /// Drops an unfinished target; how many digits that were.
    pub(super) fn drop_partial(&mut self) -> usize {
        let digits = self.digits.len();
        self.digits.clear();
        digits
    }

    /// The digits of an unfinished target.
    pub(super) fn partial(&self) -> Vec<u8> {
        self.digits.iter().map(|&(_, digit)| digit).collect()
    }

    /// The log is over: what there is, is taken from its beginning.
    pub(super) fn finish(&mut self) -> Vec<Decoded> {
        self.aligned = true;
        self.take_targets()
    }

    fn take_targets(&mut self) -> Vec<Decoded> {
        core::iter::from_fn(|| self.take_target()).collect()
    }

    fn take_target(&mut self) -> Option<Decoded> {
        let (&(time, _), _) = self.digits.get(..TARGET_BYTES)?.split_last()?;
        let number = |digits: &[(Duration, u8)]| {
            digits.iter().rev().fold(0_i32, |sum, &(_, digit)| sum * 10 + i32::from(digit))
        };
        let (x, y) = self.digits.get(..TARGET_BYTES)?.split_at_checked(TARGET_BYTES / 2)?;
        let target = StepPoint::new(number(x), number(y));
        self.digits.drain(..TARGET_BYTES);
        Some(Decoded::Target(time, target))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GAP: Duration = Duration::from_millis(100);
    const MS: Duration = Duration::from_millis(1);

    fn push_all(digits: &mut HostDigits, from_ms: u32, bytes: &[u8]) -> Vec<Decoded> {
        bytes.iter().zip(from_ms..).flat_map(|(&byte, ms)| digits.push(MS * ms, byte)).collect()
    }

    #[test]
    fn the_first_answer_tells_where_the_targets_begin() {
        let mut digits = HostDigits::new(GAP);
        assert_eq!(push_all(&mut digits, 0, &[7, 7, 7, 3, 9, 9, 2, 0, 5, 5, 9, 3, 1]), []);
        assert_eq!(
            digits.align(),
            [
                Decoded::Odd(Duration::ZERO, AnomalyKind::BeganInsideTarget { digits: 3 }),
                Decoded::Target(MS * 12, StepPoint::new(2993, 13955)),
            ]
        );
        let next = push_all(&mut digits, 20, &[1, 0, 0, 0, 0, 2, 0, 0, 0, 0]);
        assert_eq!(next, [Decoded::Target(MS * 29, StepPoint::new(1, 2))]);
    }

    #[test]
    fn a_silence_inside_a_target_drops_what_came_of_it() {
        let mut digits = HostDigits::new(GAP);
        digits.align();
        push_all(&mut digits, 0, &[1, 2, 3]);
        let got = push_all(&mut digits, 103, &[1, 0, 0, 0, 0, 2, 0, 0, 0, 0]);
        let silence = MS * 101;
        assert_eq!(
            got,
            [
                Decoded::Odd(MS * 103, AnomalyKind::SilenceInsideTarget { silence, digits: 3 }),
                Decoded::Target(MS * 112, StepPoint::new(1, 2)),
            ]
        );
    }

    #[test]
    fn a_recording_of_the_host_alone_is_decoded_in_constant_memory() {
        let mut digits = HostDigits::new(GAP);
        let mut targets = 0;
        for _ in 0..10_000 {
            targets += digits.push(Duration::ZERO, 1).len();
            assert!(digits.digits.len() <= MAX_OPEN);
        }
        assert_eq!(targets, 1_000);
        assert_eq!(digits.finish(), []);
    }
}
