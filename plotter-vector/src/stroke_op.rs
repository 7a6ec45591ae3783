//! [`StrokeOp`]: a stroke on the sheet with its arcs, for the writers that can say them.

use crate::curve::pieces;
use crate::{Drawing, Scale};
use plotter_motion::{PlotOp, Point};

/// A plot operation, or an arc from where the pen stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StrokeOp {
    Op(PlotOp),
    Arc {
        centre: Point,
        /// Counter-clockwise above 0, y being up.
        sweep_rad: f64,
        to: Point,
    },
}

/// The operations of one stroke: those of [`Drawing::plot_ops`], but for the arcs.
pub(crate) fn stroke_ops(
    drawing: &Drawing,
    index: usize,
    scale: Scale,
) -> impl Iterator<Item = StrokeOp> + '_ {
    let stroke = drawing.stroke(index);
    let draw = move |to| StrokeOp::Op(PlotOp::Draw { to: scale.to_sheet(to), feed_mm_s: None });
    let travel = stroke.first().map(|to| StrokeOp::Op(PlotOp::Travel { to: scale.to_sheet(*to) }));
    let dot = if stroke.len() == 1 { stroke.first().map(|at| draw(*at)) } else { None };
    let drawn = pieces(stroke, drawing.bulges(index)).map(move |(_, to, arc)| match arc {
        Some(arc) => StrokeOp::Arc {
            centre: scale.to_sheet(arc.centre),
            // The picture's y is down.
            sweep_rad: -arc.sweep_rad,
            to: scale.to_sheet(to),
        },
        None => draw(to),
    });
    travel.into_iter().chain(drawn).chain(dot)
}
