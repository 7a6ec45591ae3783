//! The operations of a stroke with its arcs, for the writers that can say them.

use crate::stroke::curve::{CHORD_ERROR_PX, Segment};
use crate::stroke::{Drawing, Scale};
use plotter_motion::PlotOp;

/// The operations of one stroke: those of [`Drawing::plot_ops`], but for the arcs. Cubic curves come as
/// chords, as there.
pub(crate) fn stroke_ops(drawing: &Drawing, index: usize, scale: Scale) -> impl Iterator<Item = PlotOp> + '_ {
    let stroke = drawing.stroke(index);
    let draw = move |to| PlotOp::Draw { to: scale.to_sheet(to), feed_mm_s: None };
    let travel = stroke.first().map(|to| PlotOp::Travel { to: scale.to_sheet(*to) });
    let dot = if stroke.len() == 1 { stroke.first().map(|at| draw(*at)) } else { None };
    let drawn = drawing.course(index).segments().flat_map(move |segment| {
        let arc = if let Segment::Arc(arc) = segment { Some(arc) } else { None };
        let arc_op = arc.map(|arc| PlotOp::DrawArc {
            centre: scale.to_sheet(arc.centre),
            // The picture's y is down.
            sweep_rad: -arc.sweep_rad,
            to: scale.to_sheet(arc.to),
            feed_mm_s: None,
        });
        let chords = arc.is_none().then(|| segment.chords(CHORD_ERROR_PX).map(draw));
        arc_op.into_iter().chain(chords.into_iter().flatten())
    });
    travel.into_iter().chain(drawn).chain(dot)
}
