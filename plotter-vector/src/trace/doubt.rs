//! [`Doubt`]: why what was traced may be no drawing.

use crate::ink::mark_sizes::{MarkSizes, SmallMarks};
use crate::ink::{Despeckled, Look};
use crate::stroke::{Drawing, PxPoint};
use core::fmt;

/// Strokes shorter than so many widths of the lines are short: dots, and what grain and dirt make.
const SHORT_WIDTHS: f64 = 3.0;

/// Marks smaller than so many widths of the lines are looked at.
const SMALL_WIDTHS: u32 = 5;

/// Fewer short strokes than this are soon drawn and soon rubbed out.
const FEW_SHORT: usize = 150;

/// From so many short strokes on they are doubted whatever they look like: a pen that lifts once a second
/// makes them in five hours and a half.
const MANY_SHORT: usize = 20_000;

/// Noise of single pixels runs together, where it covers a third of a sheet, in strokes of some widths. From
/// so many strokes on, no longer than this in the mean, they are looked at, too.
const MANY: usize = 1000;
const MEAN_WIDTHS: f64 = 20.0;

/// The spread of the logarithms of small marks' sizes, where these are as many as half of the short strokes
/// (those that a textured line falls into are none): dots of one pen have .1 to .45, in a row or strewn,
/// and some that run together; grain, spots that noise makes and the blocks of a JPEG file have .68 to .9.
const LEAST_SPREAD: f64 = 0.6;

/// Where a pen makes dots of several sizes it makes none that are smaller than itself. Noise does: so many
/// were left out beside those that were kept, or so many have one or two pixels where a pen is as fine.
const LEFT_OUT: f64 = 0.05;
const LEAST_PART: f64 = 0.1;

/// Paper that looks empty and whose noise has this standard deviation, levels, after smoothing by a pixel,
/// may have anything on it: a photograph's has 1 to 4.
const ROUGH_LEVELS: f32 = 8.0;

/// Why what was traced may be no drawing: what a program should say in place of a success. The strokes are
/// what was found all the same.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Doubt {
    /// No ink was found, for nothing stands out of what is rough all over the picture: no sheet of paper, or
    /// one full of lines.
    Rough {
        /// Standard deviation of what looks like paper, levels.
        noise_levels: f32,
    },
    /// The ink's pixels lie as if thrown at random.
    Thrown {
        /// All strokes.
        strokes: usize,
    },
    /// Most strokes are short, and of all sizes down to the smallest, as grain, dirt and what a camera makes
    /// of paper.
    Specks {
        /// All strokes.
        strokes: usize,
        /// Those shorter than three widths of the lines.
        short: usize,
    },
    /// Nearly all strokes are short, and there are more than 20,000 of them.
    ManyShort {
        /// All strokes.
        strokes: usize,
        /// Those shorter than three widths of the lines.
        short: usize,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rough { noise_levels } => write!(
                f,
                "no ink was found, but nothing could have stood out: what looks like paper is rough by {noise_levels:.0} \
                 levels"
            ),
            Self::Thrown { strokes } => write!(
                f,
                "this is noise: the pixels that were taken for ink lie as if thrown at random, and make {strokes} strokes"
            ),
            Self::Specks { strokes, short } => write!(
                f,
                "this looks like noise: {short} of {strokes} strokes are shorter than three widths of the lines, and their \
                 marks have all sizes, as grain and dirt"
            ),
            Self::ManyShort { strokes, short } => {
                write!(f, "{short} of {strokes} strokes are shorter than three widths of the lines")
            }
        }
    }
}

impl Doubt {
    /// Of a picture that was looked at, without strokes.
    pub(super) fn of_empty(look: &Look) -> Option<Self> {
        let noise_levels = look.noise_levels;
        (noise_levels > ROUGH_LEVELS).then_some(Self::Rough { noise_levels })
    }

    /// Of a drawing by ours with lines so wide. `sizes` counts the marks of its ink, and is asked only where
    /// the strokes alone leave a doubt.
    pub(super) fn of<E>(
        drawing: &Drawing,
        line_px: u32,
        dirt: Dirt,
        sizes: impl FnOnce() -> Result<MarkSizes, E>,
    ) -> Result<Option<Self>, E> {
        let line_px = line_px.max(1);
        let (strokes, mut short) = (drawing.strokes().len(), 0);
        let mut length_px = 0.0;
        for stroke in drawing.strokes() {
            let px: f64 = stroke.windows(2).map(way).sum();
            short += usize::from(px < SHORT_WIDTHS * f64::from(line_px));
            length_px += px;
        }
        let are_short = short >= FEW_SHORT && 2 * short > strokes;
        #[expect(clippy::cast_precision_loss, reason = "a drawing's strokes")]
        let are_many = strokes >= MANY && length_px < MEAN_WIDTHS * f64::from(line_px) * strokes as f64;
        if !are_short && !are_many {
            return Ok(None);
        }
        let SmallMarks { marks, spread, least_part, as_thrown } =
            sizes()?.finish(SMALL_WIDTHS * line_px, dirt.least_px);
        if as_thrown {
            return Ok(Some(Self::Thrown { strokes }));
        }
        #[expect(clippy::cast_precision_loss, reason = "a picture's marks")]
        let part_left_out = (dirt.removed.removed_marks as f64 + dirt.left_out as f64) / marks.max(1) as f64;
        let has_crumbs = part_left_out > LEFT_OUT || least_part > LEAST_PART;
        Ok(if are_short && 2 * marks > short && spread > LEAST_SPREAD && has_crumbs {
            Some(Self::Specks { strokes, short })
        } else if short > MANY_SHORT && 10 * short > 9 * strokes {
            Some(Self::ManyShort { strokes, short })
        } else {
            None
        })
    }
}

/// What of the ink was taken for dirt.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dirt {
    /// Smaller marks are dirt, px.
    pub(super) least_px: u32,
    pub(super) removed: Despeckled,
    /// Specks that were left out before.
    pub(super) left_out: usize,
}

fn way(pair: &[PxPoint]) -> f64 {
    match pair {
        [from, to] => from.distance(*to),
        _ => 0.0,
    }
}
