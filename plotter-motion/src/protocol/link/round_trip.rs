//! [`RoundTrip`]: how long an answer takes.

use core::time::Duration;

/// Mean and mean deviation of the time from a frame's last byte to its answer (V. Jacobson, M. Karels,
/// "Congestion Avoidance and Control", 1988; RFC 6298, section 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RoundTrip {
    mean: Duration,
    deviation: Duration,
}

impl RoundTrip {
    /// After one more answer, which took this long.
    pub(super) fn after(before: Option<Self>, took: Duration) -> Self {
        match before {
            None => Self { mean: took, deviation: took / 2 },
            Some(Self { mean, deviation }) => {
                Self { mean: mean * 7 / 8 + took / 8, deviation: deviation * 3 / 4 + took.abs_diff(mean) / 4 }
            }
        }
    }

    /// When an answer is late.
    pub(super) fn late_after(self) -> Duration {
        self.mean.saturating_add(self.deviation.saturating_mul(4))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_learns_as_in_the_rfc() {
        let ms = Duration::from_millis;
        let first = RoundTrip::after(None, ms(80));
        assert_eq!(first.late_after(), ms(80 + 4 * 40));
        // deviation 3/4 of 40 + 1/4 of 80 = 50, mean 7/8 of 80 + 1/8 of 160 = 90
        assert_eq!(RoundTrip::after(Some(first), ms(160)).late_after(), ms(90 + 4 * 50));
    }
}
