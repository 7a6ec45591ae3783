//! The operations of a drawing on their way to the planner, and who looks at the steps.

use super::command::{Outside, StepperCommand};
use crate::drawings::{Diagnostic, Diagnostics, DrawingFile, Ops, Severity};
use crate::machine::Happening;
use crate::shared::WorkShown;
use crate::stepper::{DrawnExtent, SpeedChart, StepFile, SteppedPreview};
use plotter_motion::{Pen, PlotOp, Point, planner::PlanError};

/// Greatest side of a machine's area, mm: beyond it nothing is planned.
const FARTHEST_MM: f64 = 100_000.0;

/// Reads the drawing, and hands over its operations one by one to be planned; gives the colours of its pens.
/// `push` says what is wrong with an operation, or why it cannot go on at all.
pub(super) fn walk(
    arguments: &StepperCommand,
    drawing: &DrawingFile,
    mut ops: Ops<'_>,
    read: &mut DrawnExtent,
    said: &mut Diagnostics,
    mut push: impl FnMut(PlotOp) -> Result<Result<(), PlanError>, String>,
) -> Result<Vec<[u8; 3]>, String> {
    let colours = std::mem::take(&mut ops.colours);
    let what = if arguments.estimate { "estimating" } else { "plotting" };
    let bar = WorkShown::of_bytes(arguments.telling, what, drawing.length_bytes());
    // Whether the pen is not where the next line begins, because an operation was left out.
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
        let op = read.take(op, ops.line(), arguments.ignore_feed);
        let outside = read.outside(op);
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
        if outside && arguments.strict {
            return Err(format!("{name}: {}", read.complaint()));
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
        // Nothing is drawn that the drawing does not hold: the way from what is left out is made with the pen
        // up.
        let op = if std::mem::take(&mut is_lost) { PlotOp::Travel { to } } else { op };
        if plan(op, ops.line(), &mut push, said)? {
            read.drawn += u64::from(!matches!(op, PlotOp::Travel { .. }));
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

/// Says whether the operation could be planned.
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

/// Who looks at the steps.
pub(super) struct Writers {
    pub(super) preview: Option<SteppedPreview>,
    pub(super) chart: Option<SpeedChart>,
    pub(super) steps: Option<StepFile>,
    pub(super) pen: Pen,
}

impl Writers {
    pub(super) fn take(&mut self, happening: Happening) {
        match (happening, &mut self.preview) {
            (Happening::Pen(pen), preview) => {
                self.pen = pen;
                if let Some(preview) = preview {
                    preview.put(pen);
                }
            }
            (Happening::SelectPen(pen), Some(preview)) => preview.select(pen),
            (Happening::Step(_, _, _, place), Some(preview)) => preview.step(place),
            _ => {}
        }
        if let (Happening::Moment(moment, pen), Some(chart)) = (happening, &mut self.chart) {
            chart.push(moment, pen);
        }
        if let Some(steps) = &mut self.steps {
            steps.take(happening, self.pen);
        }
    }
}
