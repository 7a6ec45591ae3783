//! Plot operations as a drawing, and back.

use super::{Drawing, Mark, PathSegment, Shape, Stroke};
use crate::{PlotOp, Point};
use alloc::string::ToString;
use alloc::vec::Vec;

impl FromIterator<PlotOp> for Drawing {
    /// Ways of the lifted pen are left out, and so is a power that no line has.
    fn from_iter<I: IntoIterator<Item = PlotOp>>(ops: I) -> Self {
        let mut builder = DrawingBuilder::default();
        ops.into_iter().for_each(|op| builder.push(op));
        builder.finish()
    }
}

/// Makes a [`Drawing`] of plot operations one by one, and puts what follows on a layer.
///
/// ```
/// use plotter_motion::{PlotOp, Point, drawing::DrawingBuilder};
/// let mut builder = DrawingBuilder::default();
/// builder.set_layer(1);
/// builder.push(PlotOp::Draw { to: Point::new(3.0, 4.0), feed_mm_s: None });
/// let drawing = builder.finish();
/// assert_eq!((drawing.strokes[0].layer, drawing.length_mm()), (1, 5.0));
/// ```
#[derive(Clone, Debug, Default)]
pub struct DrawingBuilder {
    drawing: Drawing,
    at: Point,
    pen: u8,
    layer: u32,
    power: Option<f64>,
    is_down: bool,
    before: Vec<Mark>,
}

impl DrawingBuilder {
    /// What begins from here on lies on this layer.
    pub fn set_layer(&mut self, layer: u32) {
        self.is_down &= self.layer == layer;
        self.layer = layer;
    }

    /// Takes the next operation.
    pub fn push(&mut self, op: PlotOp) {
        let (shape, to, feed_mm_s) = match op {
            PlotOp::Draw { to, feed_mm_s } => (Shape::Line, to, feed_mm_s),
            PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                (Shape::Arc { centre, sweep_rad }, to, feed_mm_s)
            }
            PlotOp::LaserPower { share } => {
                self.power = Some(share);
                return;
            }
            lifting => {
                self.is_down = false;
                match lifting {
                    PlotOp::Travel { to } => self.at = to,
                    PlotOp::SelectPen { pen } => {
                        self.pen = pen;
                        self.before.extend((pen == 0).then_some(Mark::PutPenAway));
                    }
                    PlotOp::Dwell { duration } => self.before.push(Mark::Dwell(duration)),
                    PlotOp::NewPage => self.before.push(Mark::NewPage),
                    _ => {}
                }
                return;
            }
        };
        let segment = PathSegment { shape, to, feed_mm_s, power: self.power };
        match self.drawing.strokes.last_mut() {
            Some(stroke) if self.is_down => stroke.segments.push(segment),
            _ => self.drawing.strokes.push(Stroke {
                pen: self.pen,
                layer: self.layer,
                before: core::mem::take(&mut self.before),
                from: self.at,
                segments: alloc::vec![segment],
            }),
        }
        (self.is_down, self.at) = (true, to);
    }

    /// The drawing. Layers that have no name yet are called by their number.
    #[must_use]
    pub fn finish(mut self) -> Drawing {
        self.drawing.after.append(&mut self.before);
        let most = self.drawing.strokes.iter().map(|stroke| stroke.layer).max().unwrap_or(0);
        self.drawing.layers.extend((1..=most).map(|layer| layer.to_string()));
        self.drawing
    }
}

impl Drawing {
    /// It as plot operations. Cubic curves are lines within `tolerance_mm`.
    pub fn ops(&self, tolerance_mm: f64) -> impl Iterator<Item = PlotOp> + '_ {
        let mut state = State::default();
        let strokes = self.strokes.iter().flat_map(move |stroke| state.ops(stroke, tolerance_mm));
        strokes.chain(self.after.iter().map(|mark| mark.op()))
    }

    /// The same; each stroke is given free once it has been said.
    pub fn into_ops(self, tolerance_mm: f64) -> impl Iterator<Item = PlotOp> {
        let mut state = State::default();
        let strokes = self.strokes.into_iter().flat_map(move |stroke| state.ops(&stroke, tolerance_mm));
        strokes.chain(self.after.into_iter().map(Mark::op))
    }
}

impl Stroke {
    /// Its own operations: to its start with the pen up, and along it. Its pen is not selected.
    #[cfg(feature = "font")]
    pub(crate) fn ops(&self, tolerance_mm: f64) -> Vec<PlotOp> {
        State { pen: self.pen, power: None }.ops(self, tolerance_mm)
    }
}

/// What holds on the machine.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    pen: u8,
    power: Option<f64>,
}

impl State {
    /// The operations of a stroke.
    fn ops(&mut self, stroke: &Stroke, tolerance_mm: f64) -> Vec<PlotOp> {
        let mut ops = Vec::with_capacity(2 + stroke.before.len() + stroke.segments.len());
        ops.extend(stroke.before.iter().map(|mark| mark.op()));
        if stroke.before.contains(&Mark::PutPenAway) {
            self.pen = 0;
        }
        if stroke.pen != 0 && stroke.pen != self.pen {
            self.pen = stroke.pen;
            ops.push(PlotOp::SelectPen { pen: self.pen });
        }
        ops.push(PlotOp::Travel { to: stroke.from });
        for (from, segment) in stroke.segments() {
            let feed_mm_s = segment.feed_mm_s;
            if let Some(share) = segment.power.filter(|share| self.power != Some(*share)) {
                self.power = Some(share);
                ops.push(PlotOp::LaserPower { share });
            }
            match segment.shape {
                Shape::Line => ops.push(PlotOp::Draw { to: segment.to, feed_mm_s }),
                Shape::Arc { centre, sweep_rad } => {
                    ops.push(PlotOp::DrawArc { centre, sweep_rad, to: segment.to, feed_mm_s });
                }
                Shape::Cubic { .. } => {
                    let lines = segment.places(from, tolerance_mm);
                    ops.extend(lines.map(|to| PlotOp::Draw { to, feed_mm_s }));
                }
            }
        }
        ops
    }
}

impl Mark {
    fn op(self) -> PlotOp {
        match self {
            Self::Dwell(duration) => PlotOp::Dwell { duration },
            Self::NewPage => PlotOp::NewPage,
            Self::PutPenAway => PlotOp::SelectPen { pen: 0 },
        }
    }
}
