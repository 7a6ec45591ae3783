//! Contour error: how far from the line that it should follow the pen was, over time.

use crate::{PlotterSettings, VirtualPlotter, virtual_plotter::Leg};
use core::time::Duration;
use plotter_motion::{Pen, Point, Segment};

/// Distance of the pen from the line that it should follow, at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContourSample {
    /// When.
    pub time: Duration,
    /// Distance from the nearest place of the segment, mm; never negative.
    pub error_mm: f64,
}

/// Contour error of a whole plot. Each recorded position counts once.
///
/// ```
/// # use plotter_replay::compare::{ContourError, contour_samples};
/// # use plotter_motion::{Point, Segment};
/// # use core::time::Duration;
/// let line = Segment::new(Point::ORIGIN, Point::new(10.0, 0.0));
/// let actual = [(0.0, 0.0), (5.0, 0.3), (10.4, 0.0)] // beside it by 0.3 mm, past its end by 0.4 mm
///     .map(|(x, y)| (Duration::ZERO, Point::new(x, y)));
/// let error: ContourError = contour_samples(actual, line).collect();
/// assert!((error.max_mm - 0.4).abs() < 1e-12);
/// assert!((error.rms_mm - (0.25_f64 / 3.0).sqrt()).abs() < 1e-12); // (0 + 0.09 + 0.16) / 3
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourError {
    /// Positions that were measured.
    pub samples: u64,
    /// Mean, mm.
    pub mean_mm: f64,
    /// Root of the mean square, mm.
    pub rms_mm: f64,
    /// Greatest, mm.
    pub max_mm: f64,
    /// When it was greatest.
    pub max_at: Duration,
}

/// Movements that are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ways {
    /// Those with the pen down.
    #[default]
    Drawn,
    /// All, pen-up travel too.
    All,
}

/// Distances of the positions `actual` from the segment `desired`.
pub fn contour_samples(
    actual: impl IntoIterator<Item = (Duration, Point)>,
    desired: Segment,
) -> impl Iterator<Item = ContourSample> {
    actual.into_iter().map(move |(time, at)| ContourSample { time, error_mm: desired.distance(at) })
}

/// A [`ContourError`] that is gathered piece by piece, in constant memory.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContourTally {
    error: ContourError,
    sum_mm: f64,
    sum_squares_mm2: f64,
}

impl ContourTally {
    /// Takes one sample.
    pub fn push(&mut self, sample: ContourSample) {
        self.error.samples = self.error.samples.saturating_add(1);
        self.sum_mm += sample.error_mm;
        self.sum_squares_mm2 += sample.error_mm * sample.error_mm;
        if sample.error_mm > self.error.max_mm {
            self.error.max_mm = sample.error_mm;
            self.error.max_at = sample.time;
        }
    }

    /// Takes ways from [`VirtualPlotter::take_legs`].
    pub fn extend(&mut self, legs: &[Leg], settings: &PlotterSettings, ways: Ways) {
        samples_of(legs, *settings, ways).for_each(|sample| self.push(sample));
    }

    /// Error so far.
    #[must_use]
    pub fn error(&self) -> ContourError {
        let mut error = self.error;
        if error.samples > 0 {
            #[expect(clippy::cast_precision_loss, reason = "a count below 2^53")]
            let count = error.samples as f64;
            error.mean_mm = self.sum_mm / count;
            error.rms_mm = libm::sqrt(self.sum_squares_mm2 / count);
        }
        error
    }
}

impl FromIterator<ContourSample> for ContourError {
    fn from_iter<I: IntoIterator<Item = ContourSample>>(samples: I) -> Self {
        let mut tally = ContourTally::default();
        samples.into_iter().for_each(|sample| tally.push(sample));
        tally.error()
    }
}

impl VirtualPlotter {
    /// Distance of each counted position from the line between the targets before and after it, mm. Ways
    /// without a known target are left out.
    pub fn contour_samples(&self, ways: Ways) -> impl Iterator<Item = ContourSample> {
        samples_of(self.legs(), *self.settings(), ways)
    }

    /// Contour error of the track as counted.
    #[must_use]
    pub fn contour_error(&self, ways: Ways) -> ContourError {
        self.contour_samples(ways).collect()
    }
}

fn samples_of(legs: &[Leg], settings: PlotterSettings, ways: Ways) -> impl Iterator<Item = ContourSample> {
    let measured = move |pen| ways == Ways::All || pen == Pen::Down;
    legs.iter().filter(move |leg| measured(leg.pen)).flat_map(move |leg| {
        leg.target.into_iter().flat_map(move |target| {
            let desired = Segment::new(settings.to_sheet(leg.from), settings.to_sheet(target));
            let actual = leg.points.iter().map(move |point| (point.time(), settings.to_sheet(point.at)));
            contour_samples(actual, desired)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Event, Record};

    #[test]
    fn a_plot_is_measured_against_its_own_targets() {
        let mut plotter = VirtualPlotter::new(PlotterSettings {
            x_mm_per_pulse: 1.0,
            y_mm_per_pulse: 1.0,
            ..PlotterSettings::default()
        });
        plotter.push(&Record::at_us(0, Event::Host(vec![3, 0, 0, 0, 0, 0, 0, 0, 0, 0])));
        // right, up, right, right, down: at (1, 1), (2, 1) and (3, 1) it is 1 mm off
        plotter.push(&Record::at_us(500, Event::Controller(b"131".to_vec())));
        plotter.push(&Record::at_us(900, Event::Controller(b"14+".to_vec())));
        plotter.finish();
        let error = plotter.contour_error(Ways::Drawn);
        assert_eq!((error.samples, error.max_mm, error.max_at), (6, 1.0, Duration::from_micros(500)));
        assert_eq!(error.mean_mm, 0.5);
        assert_eq!(error.rms_mm, libm::sqrt(0.5));
    }

    #[test]
    fn nothing_measured_is_no_error() {
        assert_eq!(ContourError::from_iter([]), ContourError::default());
    }
}
