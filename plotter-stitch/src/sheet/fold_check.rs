//! [`FoldCheck`]: before a frame is drawn, whether the paper has folded; and the stop if it has.

use super::{JoinError, JoinFrames, JointReport, LongSheet, SensedProbe};
use crate::{
    FoldProbe, FoldTest, FoldVerdict, FrameTransform,
    fold::{EmptySquare, FoldDirection},
};
use alloc::vec::Vec;
use core::fmt;
use plotter_motion::{PlotOp, Point, Vec2};

/// What looking for a fold came to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FoldCheck {
    /// A line was drawn twice and scanned.
    Probed {
        /// The line and its scans, in the frame's coordinates.
        probe: FoldProbe,
        /// What they tell.
        verdict: FoldVerdict,
    },
    /// There is no empty square of 20 mm on the diagonal: nothing can be drawn to look for a fold.
    NoSquare {
        /// The diagonal along which a fold would lie.
        direction: FoldDirection,
        /// The greatest distance of a mark from where the transform puts it, mm: what else can tell. A fold
        /// between marks brings them nearer to each other.
        residual_mm: Option<f64>,
    },
}

impl FoldCheck {
    /// Whether the run stops: at a fold, and where the probe was not seen.
    #[must_use]
    pub const fn stops(&self) -> bool {
        matches!(self, Self::Probed { verdict: FoldVerdict::Fold { .. } | FoldVerdict::Unclear { .. }, .. })
    }
}

impl fmt::Display for FoldCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Probed { verdict, .. } => verdict.fmt(f),
            Self::NoSquare { direction, residual_mm } => {
                let diagonal = match direction {
                    FoldDirection::Rising => "rising",
                    FoldDirection::Falling => "falling",
                };
                write!(
                    f,
                    "no empty square of 20 mm on the {diagonal} diagonal, so no fold can be looked for; "
                )?;
                match residual_mm {
                    Some(mm) => write!(
                        f,
                        "marks lie up to {mm:.3} mm beside their places, a fold between them would show there"
                    ),
                    None => f.write_str("look at the paper"),
                }
            }
        }
    }
}

impl<M: JoinFrames> LongSheet<M> {
    /// Looks for a fold before the coming frame is drawn, whose operations are given in its coordinates:
    /// finds an empty square among its strokes, all marks and earlier probes, on the diagonal that the
    /// paper's walk tells; draws a line in it twice and scans it.
    ///
    /// If that stops the run, [`draw`](Self::draw) and [`next_joint`](Self::next_joint) refuse until the
    /// paper was fitted by hand, [`fitted`](Self::fitted).
    ///
    /// Source: Ivanov, Gueorguiev, Georgieva, Nenova, "Sketch drawing on infinite paper sheets", section IV.
    ///
    /// # Errors
    ///
    /// [`JoinError::Stopped`] if it is called again without that; [`JoinError::Unjoined`] if it is not known
    /// how the frame lies; [`JoinError::Marks`] if the frame cannot have its marks.
    pub fn check_fold<I: Iterator<Item = PlotOp>>(
        &mut self,
        test: &FoldTest,
        frame: impl Fn() -> I,
    ) -> Result<FoldCheck, JoinError> {
        self.may_go_on()?;
        let field = self.settings.field;
        let [before_mm, now_mm] = self.x_border2_mm;
        let direction = FoldDirection::from_borders(before_mm, now_mm).unwrap_or(FoldDirection::Rising);
        let mut square = EmptySquare::new(direction, field.width_mm, field.frame_mm);
        let mut line = |from: Point, to: Point| {
            square.push(PlotOp::Travel { to: from });
            square.push(PlotOp::Draw { to, feed_mm_s: None });
        };
        // Those of the frame before lie about this one's beginning, its own about its end.
        let own = self.marks_of(&frame)?;
        let at_end = Vec2::new(0.0, field.frame_mm);
        for [from, to] in self.method.strokes() {
            line(from - field.corner(), to - field.corner());
        }
        for [from, to] in own.strokes() {
            line(from - field.corner() + at_end, to - field.corner() + at_end);
        }
        self.probes.iter().for_each(|[from, to]| line(*from, *to));
        square.push(PlotOp::Travel { to: Point::ORIGIN });
        frame().for_each(|op| square.push(op));
        let Some(middle) = square.find() else {
            return Ok(FoldCheck::NoSquare { direction, residual_mm: self.residual_mm });
        };
        let probe = FoldProbe::new(middle, direction, field.width_mm, field.frame_mm);
        self.probes
            .extend(probe.strokes().iter().filter_map(|[from, to]| Some([from.target()?, to.target()?])));
        let apart_mm = self.change.and_then(|change| change.fold_mm).unwrap_or(0.0);
        let seed = self.random.bits();
        let (once, twice) =
            SensedProbe::new(apart_mm, self.settings.optics, self.settings.noise, seed).scans();
        let check = FoldCheck::Probed { probe, verdict: test.judge(&once, &twice) };
        self.is_stopped = check.stops();
        Ok(check)
    }

    /// The strokes of a probe as the machine draws them: the line, and after the first scans the same line
    /// from its other end.
    #[must_use]
    pub fn probe_ops(&self, probe: &FoldProbe) -> [Vec<PlotOp>; 2] {
        let on_table = FrameTransform::new(0.0, self.settings.field.corner());
        let on_machine = on_table.map_or(self.drawn, |corner| self.drawn.after(&corner));
        probe.strokes().map(|stroke| stroke.into_iter().map(|op| on_machine.op_to_machine(op)).collect())
    }

    /// Somebody has fitted the paper by hand: it is flat, and lies elsewhere. The marks of the frame before
    /// are looked for anew.
    ///
    /// # Errors
    ///
    /// [`JoinError`], as [`next_joint`](Self::next_joint); [`JoinError::NoJoint`] before the first one.
    pub fn fitted(&mut self) -> Result<JointReport, JoinError> {
        let by = self.feed.fit();
        let change = self.change.as_mut().ok_or(JoinError::NoJoint)?;
        change.truth = by.after(&change.truth);
        change.fold_mm = None;
        self.is_stopped = false;
        self.measure()
    }
}
