//! Plot operations as a drawing, and back.

use super::{Drawing, Mark, PathSegment, Shape, Stroke};
use crate::{PlotOp, Point};
use alloc::vec::Vec;

impl FromIterator<PlotOp> for Drawing {
    /// Ways of the lifted pen are left out, and so is a power that no line has.
    fn from_iter<I: IntoIterator<Item = PlotOp>>(ops: I) -> Self {
        let mut drawing = Self::new();
        drawing.extend(ops);
        drawing
    }
}

impl Extend<PlotOp> for Drawing {
    fn extend<I: IntoIterator<Item = PlotOp>>(&mut self, ops: I) {
        let mut at = Point::ORIGIN;
        let mut pen = 0;
        let mut power = None;
        let mut is_down = false;
        let mut before = Vec::new();
        for op in ops {
            let (shape, to, feed_mm_s) = match op {
                PlotOp::Travel { to } => {
                    (is_down, at) = (false, to);
                    continue;
                }
                PlotOp::Draw { to, feed_mm_s } => (Shape::Line, to, feed_mm_s),
                PlotOp::DrawArc { centre, sweep_rad, to, feed_mm_s } => {
                    (Shape::Arc { centre, sweep_rad }, to, feed_mm_s)
                }
                PlotOp::LaserPower { share } => {
                    power = Some(share);
                    continue;
                }
                PlotOp::SelectPen { pen: next } => {
                    is_down = false;
                    pen = next;
                    if next == 0 {
                        before.push(Mark::PutPenAway);
                    }
                    continue;
                }
                PlotOp::Dwell { duration } => {
                    is_down = false;
                    before.push(Mark::Dwell(duration));
                    continue;
                }
                PlotOp::NewPage => {
                    is_down = false;
                    before.push(Mark::NewPage);
                    continue;
                }
            };
            let segment = PathSegment { shape, to, feed_mm_s, power };
            match self.strokes.last_mut() {
                Some(stroke) if is_down => stroke.segments.push(segment),
                _ => self.strokes.push(Stroke {
                    pen,
                    layer: 0,
                    before: core::mem::take(&mut before),
                    from: at,
                    segments: alloc::vec![segment],
                }),
            }
            (is_down, at) = (true, to);
        }
        self.after.append(&mut before);
    }
}

impl Drawing {
    /// It as plot operations. Cubic curves are lines within `tolerance_mm`.
    pub fn ops(&self, tolerance_mm: f64) -> impl Iterator<Item = PlotOp> + '_ {
        let (mut pen, mut power) = (0, None);
        let strokes = self.strokes.iter().flat_map(move |stroke| {
            let mut ops: Vec<PlotOp> = stroke.before.iter().map(|mark| mark.op()).collect();
            if stroke.before.contains(&Mark::PutPenAway) {
                pen = 0;
            }
            if stroke.pen != 0 && stroke.pen != pen {
                pen = stroke.pen;
                ops.push(PlotOp::SelectPen { pen });
            }
            ops.push(PlotOp::Travel { to: stroke.from });
            for (from, segment) in stroke.segments() {
                let feed_mm_s = segment.feed_mm_s;
                if let Some(share) = segment.power.filter(|share| power != Some(*share)) {
                    power = Some(share);
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
        });
        strokes.chain(self.after.iter().map(|mark| mark.op()))
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
