//! [`ReadOptions`]: what the text was written for.

use super::{DwellUnit, PenConvention};
use core::time::Duration;

/// What the machine that a text was written for makes of it.
///
/// The default is the reader's side of [`WriteOptions`](super::WriteOptions)' default: GRBL with a pen servo
/// as its spindle.
///
/// ```
/// # use plotter_motion::gcode::{DwellUnit, PenConvention, PlotOps, ReadOptions};
/// # use plotter_motion::{PlotOp, Point};
/// let unicorn =
///     ReadOptions { pen: PenConvention::UNICORN, dwell_unit: DwellUnit::Milliseconds, ..Default::default() };
/// let text = b"M300 S30\nG4 P150\nG1 X5 Y2 F3000\nM300 S50";
/// let ops: Vec<PlotOp> = PlotOps::with_options(text.iter().copied(), unicorn).collect::<Result<_, _>>()?;
/// let to = Point::new(5.0, 2.0);
/// assert_eq!(ops, [PlotOp::Draw { to, feed_mm_s: Some(50.0) }, PlotOp::Travel { to }]);
/// # Ok::<(), plotter_motion::gcode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct ReadOptions {
    /// How the pen is lifted and lowered.
    pub pen: PenConvention,
    /// Unit of `P` in a `G4`.
    pub dwell_unit: DwellUnit,
    /// The first `G4` after the pen was lifted or lowered belongs to its way if it is no longer than this,
    /// and is no [`PlotOp::Dwell`](crate::PlotOp::Dwell).
    pub settle: Duration,
    /// Treatment of lines that begin with `/`.
    pub block_delete: BlockDelete,
    /// Set of words that are known.
    pub words: Words,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            pen: PenConvention::Spindle,
            dwell_unit: DwellUnit::Seconds,
            settle: Duration::from_millis(500),
            block_delete: BlockDelete::LeaveOut,
            words: Words::Any,
        }
    }
}

/// Treatment of lines that begin with `/`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum BlockDelete {
    /// They are left out, without a word: a machine whose switch for it is on; and Makeblock's, to which they
    /// are comments.
    #[default]
    LeaveOut,
    /// They are carried out: GRBL.
    CarryOut,
}

/// Set of words that are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
pub enum Words {
    /// Those of every machine: a text is read for what it draws.
    #[default]
    Any,
    /// Those of GRBL, of which a plotter carries out all that move it, and `M6`; any other, and a number
    /// below 0 where GRBL takes none, is an error: a program that finds out what it talks to is to be told.
    Grbl,
    /// The same without `G18`, `G19`, `G43.1` and `G49`, for a small program: arcs lie in the sheet.
    GrblOnSheet,
}

impl Words {
    /// Whether the machine is GRBL: other words than its own are errors.
    pub(crate) const fn is_grbl(self) -> bool {
        !matches!(self, Self::Any)
    }
}
