//! [`Sketch`]: ways on a canvas, one by one.

use super::{Canvas, Layer};
use crate::draw::thin::thin;
use crate::{PlotterSettings, virtual_plotter::Leg};
use plotter_motion::{Pen, Point, Segment, StepPoint};

/// Puts the ways of a virtual plotter on a canvas as they come, thinned, so that a recording of any length
/// can be drawn: see [`crate::VirtualPlotter::take_noted`].
///
/// ```
/// # use plotter_replay::{PlotterSettings, VirtualPlotter, draw::{Layer, Sketch}, log::{Event, Record}};
/// let mut plotter = VirtualPlotter::new(PlotterSettings::default());
/// let mut sketch = Sketch::new(*plotter.settings(), 0.02).marking(0.03);
/// plotter.push(&Record::at_us(0, Event::Host(vec![3, 0, 0, 0, 0, 0, 0, 0, 0, 0])));
/// plotter.push(&Record::at_us(900, Event::Controller(b"13313441+".to_vec()))); // up to 0.075 mm off the line
/// plotter.take_noted().legs.iter().for_each(|leg| sketch.add(leg));
/// let canvas = sketch.finish();
/// assert_eq!(canvas.lines(Layer::Ink).count(), 1);
/// assert_eq!(canvas.lines(Layer::Differs).count(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct Sketch {
    settings: PlotterSettings,
    tolerance_mm: f64,
    mark_mm: f64,
    canvas: Canvas,
    desired: Joined,
    travel: Joined,
    ink: Joined,
    resynced: Joined,
    differs: Joined,
}

impl Sketch {
    /// A blank sheet under a plotter with these settings; lines are thinned to within `tolerance_mm`.
    #[must_use]
    pub fn new(settings: PlotterSettings, tolerance_mm: f64) -> Self {
        Self {
            settings,
            tolerance_mm,
            mark_mm: f64::INFINITY,
            canvas: Canvas::new(),
            desired: Joined::new(Layer::Desired),
            travel: Joined::new(Layer::Travel),
            ink: Joined::new(Layer::Ink),
            resynced: Joined::new(Layer::Resynced),
            differs: Joined::new(Layer::Differs),
        }
    }

    /// Marks ink that is more than `mark_mm` off its line, too.
    #[must_use]
    pub fn marking(mut self, mark_mm: f64) -> Self {
        self.mark_mm = mark_mm;
        self
    }

    /// Takes the next way.
    pub fn add(&mut self, leg: &Leg) {
        let settings = self.settings;
        let way = || leg.points.iter().map(|point| settings.to_sheet(point.at));
        let line =
            leg.target.map(|target| Segment::new(settings.to_sheet(leg.from), settings.to_sheet(target)));
        match leg.pen {
            Pen::Down => {
                let layer = Layer::of_pen(leg.pen_number);
                if self.ink.layer != layer {
                    let before = core::mem::replace(&mut self.ink, Joined::new(layer));
                    self.canvas
                        .lines
                        .extend((!before.line.is_empty()).then_some((before.layer, before.line)));
                }
                self.ink.add(&mut self.canvas, thin(way(), self.tolerance_mm));
                // The pieces of a way that was cut have one line.
                if let Some(line) = line.filter(|line| !self.desired.ends_with(*line)) {
                    self.desired.add(&mut self.canvas, vec![line.from, line.to]);
                }
            }
            Pen::Up => self.travel.add(&mut self.canvas, thin(way(), self.tolerance_mm)),
        }
        if leg.correction != StepPoint::default() && leg.pen == Pen::Down {
            let shift = settings.to_sheet(leg.correction) - settings.p1;
            self.resynced.add(&mut self.canvas, thin(way().map(|at| at + shift), self.tolerance_mm));
        }
        if let (Some(line), Pen::Down, true) = (line, leg.pen, self.mark_mm.is_finite()) {
            let places: Vec<_> = way().collect();
            let mark_mm = self.mark_mm;
            let is_off = |at: Point| line.distance(at) > mark_mm;
            for run in places.chunk_by(|&a, &b| is_off(a) == is_off(b)) {
                if run.first().is_some_and(|&at| is_off(at)) {
                    self.differs.add(&mut self.canvas, thin(run.iter().copied(), self.tolerance_mm));
                }
            }
        }
    }

    /// The canvas with all of it.
    #[must_use]
    pub fn finish(self) -> Canvas {
        let mut canvas = self.canvas;
        for joined in [self.desired, self.travel, self.ink, self.resynced, self.differs] {
            canvas.lines.extend((!joined.line.is_empty()).then_some((joined.layer, joined.line)));
        }
        canvas
    }
}

/// Joins ways that go on from each other.
#[derive(Clone, Debug)]
struct Joined {
    layer: Layer,
    line: Vec<Point>,
}

impl Joined {
    fn new(layer: Layer) -> Self {
        Self { layer, line: Vec::new() }
    }

    fn add(&mut self, canvas: &mut Canvas, way: Vec<Point>) {
        if self.line.is_empty() || self.line.last() != way.first() {
            canvas.add(self.layer, core::mem::replace(&mut self.line, way));
        } else {
            self.line.extend(way.into_iter().skip(1));
        }
    }

    fn ends_with(&self, line: Segment) -> bool {
        matches!(self.line.as_slice(), [.., from, to] if (*from, *to) == (line.from, line.to))
    }
}
