//! [`Chart`]: curves over a common time, in panels one below the other.

mod axis;
mod decimate;
mod svg;

use crate::{VirtualPlotter, compare::Ways};
use core::time::Duration;
use decimate::Decimator;
use plotter_motion::{Axis, Point, Segment};

/// A time and a value.
type Sample = (Duration, f64);

/// How a curve runs from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Run {
    /// Straight.
    Straight,
    /// Level, with a step at the next sample.
    Steps,
}

/// Meaning of a curve, which gives its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// The commanded value: grey.
    Setpoint,
    /// The desired value: blue, broad and pale.
    Desired,
    /// The actual value: dark.
    Actual,
    /// An error: red.
    Error,
}

/// Values over time, thinned so that peaks stay.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    label: String,
    role: Role,
    run: Run,
    samples: Vec<Sample>,
}

impl Curve {
    /// Most samples that a curve keeps.
    pub const MOST_SAMPLES: usize = decimate::MOST_SAMPLES;

    /// The curve through `samples`, which lie between `from` and `to` in time. Where there are more than a
    /// picture can show, the first, least, greatest and last of each short stretch are kept. Values that are
    /// not finite are left out.
    pub fn new(
        label: &str,
        role: Role,
        run: Run,
        (from, to): (Duration, Duration),
        samples: impl IntoIterator<Item = (Duration, f64)>,
    ) -> Self {
        let mut decimator = Decimator::new(from, to);
        samples.into_iter().for_each(|sample| decimator.push(sample));
        Self { label: label.to_owned(), role, run, samples: decimator.finish() }
    }

    /// Samples that are kept.
    #[must_use]
    pub fn samples(&self) -> &[(Duration, f64)] {
        &self.samples
    }
}

/// A panel of a chart: curves over one value axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Label of the value axis, with its unit.
    pub label: String,
    /// The curves; the last is on top.
    pub curves: Vec<Curve>,
}

/// Panels over a common time axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Title of the chart.
    pub title: String,
    /// From top to bottom.
    pub panels: Vec<Panel>,
}

impl Chart {
    /// The response of both motors: X and Y over time, desired beside actual, and the contour error.
    ///
    /// *target* is the commanded coordinate, *on the line* that of the place on the desired line nearest to
    /// the pen, and *actual* the position as counted.
    ///
    /// ```
    /// # use plotter_replay::{Chart, PlotterSettings, VirtualPlotter, log::{Event, Record}};
    /// let mut plotter = VirtualPlotter::new(PlotterSettings::default());
    /// plotter.push(&Record::at_us(0, Event::Host(vec![2, 0, 0, 0, 0, 1, 0, 0, 0, 0])));
    /// plotter.push(&Record::at_us(900, Event::Controller(b"131+".to_vec())));
    /// plotter.finish();
    /// assert_eq!(Chart::response("one line", &plotter).panels.len(), 3);
    /// ```
    #[must_use]
    pub fn response(title: &str, plotter: &VirtualPlotter) -> Self {
        let times = || {
            let points = plotter.legs().iter().flat_map(|leg| [leg.points.first(), leg.points.last()]);
            points.flatten().map(|point| point.time())
        };
        let sent = plotter.targets().iter().map(|&(time, _)| time);
        let from = times().chain(sent.clone()).min().unwrap_or(Duration::ZERO);
        let to = times().chain(sent).max().unwrap_or(Duration::ZERO);
        let span = (from, to);
        let motor = |name: &str, axis| Panel {
            label: format!("{name} (mm)"),
            curves: vec![
                Curve::new("target", Role::Setpoint, Run::Steps, span, targets(plotter, axis, to)),
                Curve::new("on the line", Role::Desired, Run::Straight, span, on_line(plotter, axis)),
                Curve::new("actual", Role::Actual, Run::Straight, span, actual(plotter, axis)),
            ],
        };
        let error = plotter.contour_samples(Ways::All).map(|sample| (sample.time, sample.error_mm));
        Self {
            title: title.to_owned(),
            panels: vec![
                motor("X", Axis::X),
                motor("Y", Axis::Y),
                Panel {
                    label: String::from("contour error (mm)"),
                    curves: vec![Curve::new(
                        "distance from the line",
                        Role::Error,
                        Run::Straight,
                        span,
                        error,
                    )],
                },
            ],
        }
    }
}

fn coordinate(axis: Axis, at: Point) -> f64 {
    match axis {
        Axis::X => at.x,
        Axis::Y => at.y,
    }
}

fn targets(plotter: &VirtualPlotter, axis: Axis, to: Duration) -> impl Iterator<Item = Sample> {
    let sent = plotter.targets().iter().copied();
    let last = plotter.targets().last().map(|&(_, target)| (to, target));
    let settings = *plotter.settings();
    sent.chain(last).map(move |(time, target)| (time, coordinate(axis, settings.to_sheet(target))))
}

fn actual(plotter: &VirtualPlotter, axis: Axis) -> impl Iterator<Item = Sample> {
    let settings = *plotter.settings();
    let points = plotter.legs().iter().flat_map(|leg| leg.points.iter());
    points.map(move |point| (point.time(), coordinate(axis, settings.to_sheet(point.at))))
}

fn on_line(plotter: &VirtualPlotter, axis: Axis) -> impl Iterator<Item = Sample> {
    let settings = *plotter.settings();
    plotter.legs().iter().flat_map(move |leg| {
        leg.target.into_iter().flat_map(move |target| {
            let line = Segment::new(settings.to_sheet(leg.from), settings.to_sheet(target));
            let nearest = move |at| coordinate(axis, line.nearest(settings.to_sheet(at)));
            leg.points.iter().map(move |point| (point.time(), nearest(point.at)))
        })
    })
}
