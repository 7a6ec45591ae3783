//! The start of a sketch: where on the table the paper lies, how wide it is, and where its frames go.

mod search;
#[cfg(feature = "alloc")]
mod sensed;

pub use search::{PaperSearch, PaperSettings};
#[cfg(feature = "alloc")]
pub use sensed::SensedPaper;

use crate::Field;
use crate::field::{EDGE_BESIDE_MM, MARGIN_MM};
use core::fmt;

/// How far an edge may be from a straight line through the others, mm: bends of rolls are some tenths, tears
/// are larger.
const STRAIGHT_MM: f64 = 2.0;

/// Greatest turn that a roll has, rad: five times what the source met.
const GREATEST_TURN_RAD: f64 = 0.01;

/// Where the paper lies.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Paper {
    /// The machine's x of the left edge where it reaches farthest into the table, mm.
    pub left_mm: f64,
    /// The machine's x of the right edge where it reaches farthest into the table, mm.
    pub right_mm: f64,
    /// Turn of the paper, counter-clockwise, rad: that of the edges' middle.
    pub turn_rad: f64,
}

impl Paper {
    /// The field for a drawing of that width, in the middle of the paper. Each frame begins at `begin_mm` and
    /// is `frame_mm` long.
    ///
    /// ```
    /// # use plotter_stitch::{Field, Paper};
    /// let paper = Paper { left_mm: 300.0, right_mm: 1500.0, turn_rad: 0.0 };
    /// // 100 mm are left on either side: 55 mm are needed for the marks.
    /// let field = paper.field(1000.0, 20.0, 950.0)?;
    /// assert_eq!(field, Field { left_mm: 400.0, width_mm: 1000.0, begin_mm: 20.0, frame_mm: 950.0 });
    /// assert_eq!(
    ///     paper.field(1100.0, 20.0, 950.0).unwrap_err().to_string(),
    ///     "the paper is 1200.0 mm wide, the drawing of 1100 mm needs 1210 mm with its marks beside it; take wider paper, or \
    ///      shrink the drawing"
    /// );
    /// # Ok::<(), plotter_stitch::paper::PaperError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`PaperError::TooNarrow`] if drawing and marks do not lie on the paper; [`PaperError::NoWidth`] if the
    /// width is none.
    pub fn field(&self, width_mm: f64, begin_mm: f64, frame_mm: f64) -> Result<Field, PaperError> {
        // A NaN lies in no range.
        if !(width_mm > 0.0 && width_mm.is_finite()) {
            return Err(PaperError::NoWidth { width_mm });
        }
        let (paper_mm, needed_mm) = (self.right_mm - self.left_mm, width_mm + 2.0 * EDGE_BESIDE_MM);
        if paper_mm < needed_mm {
            return Err(PaperError::TooNarrow { paper_mm, width_mm, needed_mm });
        }
        let left_mm = 0.5 * (self.left_mm + self.right_mm - width_mm);
        Ok(Field { left_mm, width_mm, begin_mm, frame_mm })
    }

    /// The widest field on this paper, mm.
    #[must_use]
    pub fn widest_mm(&self) -> f64 {
        (self.right_mm - self.left_mm - 2.0 * EDGE_BESIDE_MM).max(0.0)
    }
}

/// A side of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// That of smaller x.
    Left,
    /// That of larger x.
    Right,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Left => "left",
            Self::Right => "right",
        })
    }
}

/// Why the paper cannot be drawn on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PaperError {
    /// The search is not over yet.
    NotDone,
    /// No paper was seen.
    NoPaper {
        /// Where the head went, mm.
        y_mm: f64,
    },
    /// The paper reaches farther than the head.
    Beyond {
        /// On which side.
        side: Side,
        /// Where, mm.
        y_mm: f64,
        /// The head's last place, mm.
        reach_mm: f64,
    },
    /// An edge is not straight: torn, folded over, or under a stain.
    Torn {
        /// Which edge.
        side: Side,
        /// Where it is farthest from the line through the others, mm.
        y_mm: f64,
        /// By how much, mm; above 0 to the right.
        off_mm: f64,
    },
    /// The paper lies askew by more than any roll.
    Askew {
        /// Its turn, rad.
        turn_rad: f64,
    },
    /// A drawing has no such width.
    NoWidth {
        /// The width, mm.
        width_mm: f64,
    },
    /// Drawing and marks do not lie on the paper.
    TooNarrow {
        /// Width of the paper, mm.
        paper_mm: f64,
        /// Width of the drawing, mm.
        width_mm: f64,
        /// Width that is needed, mm.
        needed_mm: f64,
    },
}

impl fmt::Display for PaperError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotDone => f.write_str("the search for the paper is not over yet; do what it asks for"),
            Self::NoPaper { y_mm } => {
                write!(
                    f,
                    "no paper was seen at y = {y_mm} mm; look whether it is mounted and the lamps shine"
                )
            }
            Self::Beyond { side, y_mm, reach_mm } => write!(
                f,
                "at y = {y_mm} mm the paper's {side} edge lies beyond {reach_mm} mm, where the head does not come; move the rolls, or \
                 take narrower paper"
            ),
            Self::Torn { side, y_mm, off_mm } => write!(
                f,
                "the paper's {side} edge is {off_mm:.1} mm beside its line at y = {y_mm} mm, {STRAIGHT_MM} mm are taken: torn, folded \
                 over or under a stain; wind on past it"
            ),
            Self::Askew { turn_rad } => write!(
                f,
                "the paper lies askew by {turn_rad:.4} rad, at most {GREATEST_TURN_RAD} rad are taken; fit it by hand"
            ),
            Self::NoWidth { width_mm } => write!(f, "{width_mm} mm is no width of a drawing"),
            Self::TooNarrow { paper_mm, width_mm, needed_mm } => write!(
                f,
                "the paper is {paper_mm:.1} mm wide, the drawing of {width_mm} mm needs {needed_mm} mm with its marks beside it; take \
                 wider paper, or shrink the drawing"
            ),
        }
    }
}

impl core::error::Error for PaperError {}

/// The paper must reach farther than the marks.
const _: () = assert!(EDGE_BESIDE_MM > MARGIN_MM);
