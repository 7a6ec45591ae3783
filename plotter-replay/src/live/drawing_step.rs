//! [`DrawingStep`]: a drawing as a machine of targets takes it, with what a person does in between.

use plotter_motion::toolpath::{OutOfReach, targets};
use plotter_motion::{Machine, PenMove, PlotOp};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// The next of a drawing, for a machine that takes one target after the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingStep {
    /// A straight move.
    Move(PenMove),
    /// A person puts in this pen.
    Pen(u8),
    /// A person puts in a new sheet.
    Sheet,
}

impl From<PenMove> for DrawingStep {
    fn from(next: PenMove) -> Self {
        Self::Move(next)
    }
}

/// The steps of a tool path, as [`targets`] has its moves: pens and sheets stand before the move that follows
/// them, and those behind the last move are left out.
///
/// ```
/// # use plotter_motion::{Machine, MachineConfig, Pen, PenMove, PlotOp, Point, StepPoint};
/// # use plotter_replay::live::{DrawingStep, drawing_steps};
/// let machine = Machine::new(MachineConfig::default())?; // 40 counts to the millimetre
/// let path = [PlotOp::SelectPen { pen: 2 }, PlotOp::Draw { to: Point::new(10.0, 5.0), feed_mm_s: None }];
/// let steps: Vec<_> = drawing_steps(&machine, path).map(Result::unwrap).collect();
/// let line = PenMove { pen: Pen::Down, target: StepPoint::new(400, 200) };
/// assert_eq!(steps, [DrawingStep::Pen(2), DrawingStep::Move(line)]);
/// # Ok::<(), plotter_motion::ConfigError>(())
/// ```
///
/// # Errors
///
/// [`OutOfReach`] as [`targets`] says it.
pub fn drawing_steps<I: IntoIterator<Item = PlotOp>>(
    machine: &Machine,
    ops: I,
) -> impl Iterator<Item = Result<DrawingStep, OutOfReach>> + use<I> {
    // Operations that do not move the pen are passed over by `targets`: they are noted as they go by.
    let passed = Arc::new(Mutex::new(VecDeque::new()));
    let noted = Arc::clone(&passed);
    let ops = ops.into_iter().inspect(move |op| {
        let step = match op {
            PlotOp::SelectPen { pen } if *pen > 0 => DrawingStep::Pen(*pen),
            PlotOp::NewPage => DrawingStep::Sheet,
            _ => return,
        };
        noted.lock().unwrap_or_else(PoisonError::into_inner).push_back(step);
    });
    let mut moves = targets(machine, ops);
    let mut next = None;
    core::iter::from_fn(move || {
        if next.is_none() {
            next = moves.next();
        }
        let passed = passed.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
        match passed {
            Some(step) if next.is_some() => Some(Ok(step)),
            _ => next.take().map(|next| next.map(DrawingStep::Move)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use plotter_motion::{MachineConfig, Point};

    #[test]
    fn pens_stand_before_what_they_draw_and_none_stands_at_the_end() {
        let machine = Machine::new(MachineConfig::default()).unwrap();
        let travel = |x| PlotOp::Travel { to: Point::new(x, 0.0) };
        let pen = |pen| PlotOp::SelectPen { pen };
        let ops = [pen(1), travel(1.0), pen(0), pen(2), PlotOp::NewPage, travel(2.0), travel(3.0), pen(1)];
        let names: Vec<String> = drawing_steps(&machine, ops)
            .map(|step| match step.unwrap() {
                DrawingStep::Move(next) => format!("{}", next.target.x),
                DrawingStep::Pen(pen) => format!("pen {pen}"),
                DrawingStep::Sheet => String::from("sheet"),
            })
            .collect();
        assert_eq!(names, ["pen 1", "40", "pen 2", "sheet", "80", "120"]);
    }
}
