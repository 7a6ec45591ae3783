//! From a tool path to the targets of a machine that takes them one by one.

use crate::config::DcConfig;
use crate::{
    Axis, Machine, Pen, PenMove, PlotOp, Point, StepPoint,
    toolpath::{chords, from_mm},
};
use core::fmt;

/// A point that a machine cannot reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfReach {
    /// Number of the operation in the tool path, from 0.
    pub index: usize,
    /// The target in mm.
    pub point: Point,
    /// The axis on which it lies outside.
    pub axis: Axis,
    /// Greatest coordinate on that axis, mm.
    pub most_mm: f64,
}

impl fmt::Display for OutOfReach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { index, point: Point { x, y }, axis, most_mm } = self;
        let axis = match axis {
            Axis::X => "x",
            Axis::Y => "y",
        };
        write!(
            f,
            "operation {index}, point ({x:.3}, {y:.3}) mm: axis {axis} lies outside 0.000..={most_mm:.3} mm; \
             move or shrink the drawing, or enlarge the machine's area"
        )
    }
}

impl core::error::Error for OutOfReach {}

/// The moves of a tool path in encoder counts, each rounded to nearest. Arcs are chords that lie within half
/// a count of them, each an operation of its own. Operations that do not move the pen are left out, and so is
/// a travel to where the pen is.
///
/// # Errors
///
/// [`OutOfReach`] for a point outside the machine's area, or one that is not finite. The moves after it
/// follow; the line that would have begun there is a move with the pen up to its end, so that nothing is
/// drawn that the tool path does not hold.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, Pen, PenMove, PlotOp, Point, StepPoint, toolpath::targets};
/// let machine = Machine::new(MachineConfig::default())?; // 40 counts to the millimetre
/// let path = [PlotOp::Travel { to: Point::new(10.0, 5.0) }, PlotOp::Draw { to: Point::new(10.0, -1.0), feed_mm_s: None }];
/// let mut moves = targets(&machine, path);
/// assert_eq!(moves.next(), Some(Ok(PenMove { pen: Pen::Up, target: StepPoint::new(400, 200) })));
/// assert_eq!(
///     moves.next().unwrap().unwrap_err().to_string(),
///     "operation 1, point (10.000, -1.000) mm: axis y lies outside 0.000..=420.000 mm; \
///      move or shrink the drawing, or enlarge the machine's area"
/// );
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn targets<I: IntoIterator<Item = PlotOp>>(
    machine: &Machine,
    ops: I,
) -> impl Iterator<Item = Result<PenMove, OutOfReach>> + use<I> {
    let (area, DcConfig { x, y, .. }) = (machine.config().area, DcConfig::of(machine));
    let mut position = StepPoint::default();
    let mut lost = false;
    let tolerance_mm = 0.5 / x.counts_per_mm.max(y.counts_per_mm);
    chords(ops, tolerance_mm).enumerate().filter_map(move |(index, op)| {
        let (pen, point) = match op {
            PlotOp::Travel { to } => (Pen::Up, to),
            PlotOp::Draw { to, .. } => (Pen::Down, to),
            _ => return None,
        };
        let outside = |axis, coordinate: f64, most_mm: f64, counts_per_mm: f64| {
            // a point that rounds to the border is on it
            let inside = from_mm(coordinate, counts_per_mm) <= from_mm(most_mm, counts_per_mm)
                && from_mm(coordinate, counts_per_mm) >= 0
                && coordinate.is_finite();
            (!inside).then_some(OutOfReach { index, point, axis, most_mm })
        };
        if let Some(error) = outside(Axis::X, point.x, area.width_mm, x.counts_per_mm)
            .or_else(|| outside(Axis::Y, point.y, area.height_mm, y.counts_per_mm))
        {
            lost = true;
            return Some(Err(error));
        }
        let target = StepPoint::new(from_mm(point.x, x.counts_per_mm), from_mm(point.y, y.counts_per_mm));
        let pen = if core::mem::take(&mut lost) { Pen::Up } else { pen };
        let stays = pen == Pen::Up && target == position;
        position = target;
        (!stays).then_some(Ok(PenMove { pen, target }))
    })
}
