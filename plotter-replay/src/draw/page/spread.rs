//! [`pulse_times`]: arrival times of pulses that were recorded with one time stamp.

use crate::virtual_plotter::TrackPoint;

/// Time of a byte at the thesis' 256000 baud, us: 10 bits take 39.06 us, rounded up. A few microseconds more
/// or less at another rate are invisible on a chart.
const BYTE_US: u64 = 40;

/// The times of `points`, us.
///
/// All bytes of one read carry the time of the last. The earlier ones are moved back, one byte time each, or
/// less if the previous read is nearer than that. Those of the first read keep their time: nothing tells when
/// their line began.
pub(crate) fn pulse_times(points: &[TrackPoint]) -> impl Iterator<Item = u64> {
    let mut previous_us: Option<u64> = None;
    points.chunk_by(|a, b| a.time_us == b.time_us).flat_map(move |run| {
        let end_us = run.last().map_or(0, |point| point.time_us);
        let count = run.len() as u64;
        let free_us = previous_us.replace(end_us).map_or(0, |previous_us| end_us.saturating_sub(previous_us));
        let span_us = free_us.min(BYTE_US.saturating_mul(count));
        (1..=count).map(move |index| end_us.saturating_sub(span_us.saturating_mul(count - index) / count))
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
            pulse_times(&points).collect::<Vec<_>>()
        };
        assert_eq!(times(&[100, 1_000, 1_000, 1_000]), [100, 920, 960, 1_000]);
        assert_eq!(times(&[100, 160, 160, 160]), [100, 120, 140, 160]);
        assert_eq!(times(&[7, 7, 7]), [7, 7, 7]); // the first read
    }
}
