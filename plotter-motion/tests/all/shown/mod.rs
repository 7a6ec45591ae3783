//! Plot operations in short, for tests to compare.

use plotter_motion::hpgl::{UNITS_PER_MM, plot_ops};
use plotter_motion::{PlotOp, Point};

/// The operations of a text in plotter units, rounded to a thousandth: `U` travel, `D` draw, `A` arc (to
/// where, about which centre, by how many degrees), `S` pen, `N` page; errors in `<>`.
pub(crate) fn ops(text: &str) -> String {
    let shown: Vec<String> = plot_ops(text.as_bytes())
        .map(|op| match op {
            Ok(PlotOp::Travel { to }) => format!("U{}", place(to)),
            Ok(PlotOp::Draw { to, .. }) => format!("D{}", place(to)),
            Ok(PlotOp::DrawArc { centre, sweep_rad, to, .. }) => {
                format!("A{}({}){}", place(to), place(centre), rounded(sweep_rad.to_degrees()))
            }
            Ok(PlotOp::SelectPen { pen }) => format!("S{pen}"),
            Ok(PlotOp::NewPage) => "N".to_string(),
            Ok(other) => format!("{other:?}"),
            Err(error) => format!("<{error}>"),
        })
        .collect();
    shown.join(" ")
}

fn place(at: Point) -> String {
    format!("{},{}", rounded(at.x * UNITS_PER_MM), rounded(at.y * UNITS_PER_MM))
}

fn rounded(value: f64) -> f64 {
    // Adding 0 makes a 0 of a −0.
    (value * 1e3).round() / 1e3 + 0.0
}
