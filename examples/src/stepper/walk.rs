//! [`walk`] hands the operations of a drawing to the planner one by one; [`Writers`] receive its steps.

use super::command::{Outside, StepperCommand};
use crate::drawings::{Diagnostic, Diagnostics, DrawingFile, Ops, Severity};
use crate::machine::PlotEvent;
use crate::shared::WorkShown;
use crate::stepper::{DrawnExtent, SpeedChart, StepFile, SteppedPreview};
use plotter_motion::{Pen, PlotOp, Point, planner::PlanError};

/// Greatest coordinate that is planned, mm: 100 m, more than any plotter reaches.
const FARTHEST_MM: f64 = 100_000.0;

/// Reads the drawing, hands its operations to `push` one by one, and returns the colours of its pens.
///
/// `push` returns `Ok(Err(_))` for an operation that cannot be planned and is left out, and `Err(_)` if
/// nothing more can be done.
pub(super) fn walk(
    arguments: &StepperCommand,
    drawing: &DrawingFile,
    mut ops: Ops<'_>,
    extent: &mut DrawnExtent,
    said: &mut Diagnostics,
    mut push: impl FnMut(PlotOp) -> Result<Result<(), PlanError>, String>,
) -> Result<Vec<[u8; 3]>, String> {
    let colours = std::mem::take(&mut ops.colours);
    let what = if arguments.estimate { "estimating" } else { "plotting" };
    let bar = WorkShown::of_bytes(arguments.telling, what, drawing.length_bytes());
    // Whether an operation was left out, so that the pen is not where the next line begins.
    let mut is_lost = false;
    let mut shown = 0;
    let name = drawing.name();
    while let Some(item) = ops.next() {
        if ops.bytes() != shown {
            shown = ops.bytes();
            bar.set(shown);
        }
        let op = match item {
            Ok(op) => op,
            Err(found) => {
                if arguments.strict && found.severity == Severity::Error {
                    return Err(format!("{name}: {found}"));
                }
                said.push(found);
                continue;
            }
        };
        let op = extent.count(op, ops.line(), arguments.ignore_feed);
        let outside = extent.add_to_extent(op);
        if let Some(place) = op.target().filter(|place| !is_near(*place)) {
            let text = format!("({}, {}) mm is farther than any machine reaches: left out", place.x, place.y);
            let found = Diagnostic { line: ops.line(), ..Diagnostic::new(Severity::Error, text) };
            if arguments.strict {
                return Err(format!("{name}: {found}"));
            }
            said.push(found);
            is_lost = true;
            continue;
        }
        if let (true, Some(warning)) = (outside && arguments.strict, extent.outside_diagnostic()) {
            return Err(format!("{name}: {warning}"));
        }
        let leaves_out = outside && arguments.outside == Outside::LeaveOut;
        let Some(to) = op.target() else {
            plan(op, ops.line(), &mut push, said)?;
            continue;
        };
        if leaves_out {
            is_lost = true;
            continue;
        }
        // After an operation was left out, the pen travels to where the next one ends: a line from elsewhere
        // is not in the drawing.
        let op = if std::mem::take(&mut is_lost) { PlotOp::Travel { to } } else { op };
        if plan(op, ops.line(), &mut push, said)? {
            extent.count_planned(op);
        } else {
            is_lost = true;
        }
    }
    bar.finish();
    Ok(colours)
}

fn is_near(place: Point) -> bool {
    place.x.abs() <= FARTHEST_MM && place.y.abs() <= FARTHEST_MM
}

/// Hands an operation to `push`; returns whether it could be planned. If not, `said` has the reason.
pub(super) fn plan(
    op: PlotOp,
    line: Option<u32>,
    push: &mut impl FnMut(PlotOp) -> Result<Result<(), PlanError>, String>,
    said: &mut Diagnostics,
) -> Result<bool, String> {
    if let Err(error) = push(op)? {
        said.push(Diagnostic { line, ..Diagnostic::new(Severity::Error, error.to_string()) });
        return Ok(false);
    }
    Ok(true)
}

/// The files that are made of the steps, each only if it was asked for.
pub(super) struct Writers {
    pub(super) preview: Option<SteppedPreview>,
    pub(super) chart: Option<SpeedChart>,
    pub(super) steps: Option<StepFile>,
    pub(super) pen: Pen,
}

impl Writers {
    pub(super) fn take(&mut self, event: PlotEvent) {
        match (event, &mut self.preview) {
            (PlotEvent::Pen(pen), preview) => {
                self.pen = pen;
                if let Some(preview) = preview {
                    preview.put(pen);
                }
            }
            (PlotEvent::SelectPen(pen), Some(preview)) => preview.select(pen),
            (PlotEvent::Step { at, .. }, Some(preview)) => preview.step(at),
            _ => {}
        }
        if let (PlotEvent::Moment(moment, pen), Some(chart)) = (event, &mut self.chart) {
            chart.push(moment, pen);
        }
        if let Some(steps) = &mut self.steps {
            steps.take(event, self.pen);
        }
    }
}
