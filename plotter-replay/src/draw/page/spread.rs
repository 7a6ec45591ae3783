//! [`spread`]: when each of several pulses came that were recorded together.

use crate::virtual_plotter::TrackPoint;

/// Time of a byte at the published 256000 baud, us.
const BYTE_US: u64 = 40;

/// The times of `points`, us. Pulses that came in one read have one time, that of the last byte: those before
/// it are put a byte's time apart before that, as far back as the point before them allows.
pub(crate) fn spread(points: &[TrackPoint]) -> impl Iterator<Item = u64> {
    let mut before_us = None;
    points.chunk_by(|a, b| a.time_us == b.time_us).flat_map(move |run| {
        let to_us = run.last().map_or(0, |point| point.time_us);
        let count = run.len() as u64;
        let earliest_us = to_us.saturating_sub(BYTE_US.saturating_mul(count));
        let from_us = before_us.replace(to_us).map_or(to_us, |before_us: u64| before_us.max(earliest_us));
        let span_us = to_us.saturating_sub(from_us).min(BYTE_US.saturating_mul(count));
        (1..=count).map(move |place| to_us.saturating_sub(span_us.saturating_mul(count - place) / count))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::StepPoint;

    #[test]
    fn pulses_of_one_read_are_a_byte_apart() {
        let times = |given: &[u64]| {
            let points: Vec<_> =
                given.iter().map(|&time_us| TrackPoint { time_us, at: StepPoint::default() }).collect();
            spread(&points).collect::<Vec<_>>()
        };
        assert_eq!(times(&[100, 1_000, 1_000, 1_000]), [100, 920, 960, 1_000]);
        assert_eq!(times(&[100, 160, 160, 160]), [100, 120, 140, 160]);
        assert_eq!(times(&[7, 7, 7]), [7, 7, 7]); // nothing is known of before
    }
}
