//! Why no pose is told.

use core::fmt;
use plotter_motion::Axis;

/// Why a sheet's pose is refused. A wrong one would draw the next frame beside the last.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FitError {
    /// A number is not finite, or on no machine.
    NotFinite {
        /// The crossing it belongs to, counted from 0.
        crossing: usize,
        /// The number.
        value: f64,
    },
    /// A place was found at a crossing that the layout does not have.
    Crossing {
        /// Which, counted from 0.
        crossing: usize,
        /// How many there are.
        crossings: usize,
    },
    /// More places than are taken.
    TooMany {
        /// How many.
        found: usize,
        /// Most that are taken.
        most: usize,
    },
    /// Too few marks were found.
    TooFew {
        /// Crossings at which something was found.
        seen: u32,
        /// Least number of them.
        least: u32,
    },
    /// Too few of the places that were found agree with one another.
    NoAgreement {
        /// How many agree.
        agree: u32,
        /// Crossings at which something was found.
        seen: u32,
        /// Least number that would have to agree.
        least: u32,
    },
    /// Less than half of the places along one axis agree with the others: something else may be the truth.
    Minority {
        /// The direction of those scans.
        axis: Axis,
        /// How many agree.
        agree: u32,
        /// Crossings along that axis at which something was found.
        seen: u32,
    },
    /// Another pose explains places that the told one leaves over: strokes beside the marks, or marks beside
    /// strokes.
    Ambiguous {
        /// The direction of those scans.
        axis: Axis,
        /// At how many crossings.
        crossings: u32,
    },
    /// Strokes of the drawing were seen beside the marks, and too few marks agree at one side of the field: a
    /// stroke imitates two.
    Strokes {
        /// The direction of those scans.
        axis: Axis,
        /// How many agree at that side.
        agree: u32,
        /// Least number that would have to agree.
        least: u32,
    },
    /// The crossings that are left lie so that they do not tell shift and rotation.
    Geometry {
        /// How many agree.
        agree: u32,
    },
    /// The pose is known too badly.
    Unsure {
        /// Standard deviation at the worse end of the joint, mm.
        sigma_mm: f64,
        /// The greatest that is taken, mm.
        most_mm: f64,
    },
    /// One place could be wrong without any other showing it.
    Unchecked {
        /// Its crossing, counted from 0.
        crossing: usize,
        /// How far the joint may be off if it is, mm.
        effect_mm: f64,
        /// The farthest that is taken, mm.
        most_mm: f64,
    },
    /// The marks at both ends lie nearer to each other than they were drawn, or may do so for all that is
    /// known: the paper has shrunk, or it has folded between them, and they do not tell which.
    Shrunk {
        /// By how much of their distance at the most.
        shrunk: f64,
        /// How far an end of the joint may be off if that is a fold, mm.
        effect_mm: f64,
        /// The farthest that is taken, mm.
        most_mm: f64,
    },
    /// Strokes of the drawing were seen beside the marks, and the paper would have swollen or shrunk: at one
    /// side they may have been taken for marks.
    Swollen {
        /// What the swelling would be; negative where the paper has shrunk.
        swelling: f64,
        /// How far an end of the joint may then be off, mm.
        effect_mm: f64,
        /// The farthest that is taken, mm.
        most_mm: f64,
    },
    /// The rotation is greater than any sheet's.
    Angle {
        /// The rotation, rad.
        angle_rad: f64,
        /// The greatest that is believed, rad.
        most_rad: f64,
    },
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { crossing, value } => {
                write!(f, "crossing {crossing}: {value} is no place or deviation on a machine; scan it again")
            }
            Self::Crossing { crossing, crossings } => {
                write!(
                    f,
                    "a place was found at crossing {crossing}, but there are only {crossings}, counted from 0"
                )
            }
            Self::TooMany { found, most } => {
                write!(f, "{found} places were found, at most {most} are taken; leave out what is no line")
            }
            Self::TooFew { seen, least } => write!(
                f,
                "only {seen} crossings found a line, at least {least} are needed; look whether the marks were drawn and the \
                 sensor is clean"
            ),
            Self::NoAgreement { agree, seen, least } => write!(
                f,
                "only {agree} of {seen} found places agree with one another, at least {least} are needed; look for dust and \
                 wrinkles"
            ),
            Self::Minority { axis, agree, seen } => write!(
                f,
                "along {} only {agree} of {seen} found places agree with the others, more than half are needed; look for dust",
                name(*axis)
            ),
            Self::Ambiguous { axis, crossings } => write!(
                f,
                "along {} another place of the sheet explains what was seen at {crossings} crossings besides; keep strokes off \
                 the marks, or give the marks a pattern",
                name(*axis)
            ),
            Self::Strokes { axis, agree, least } => write!(
                f,
                "along {} strokes of the drawing were seen beside the marks, and only {agree} marks agree at one side of the \
                 field, at least {least} are needed there; keep strokes off the marks",
                name(*axis)
            ),
            Self::Geometry { agree } => write!(
                f,
                "the {agree} crossings that agree do not tell shift and rotation; marks along both axes and far apart are needed"
            ),
            Self::Unsure { sigma_mm, most_mm } => write!(
                f,
                "the joint would be known to {sigma_mm:.3} mm only, {most_mm} mm are asked; scan more marks, or again"
            ),
            // Not how far: at the least redundancy the number means nothing.
            Self::Unchecked { crossing, effect_mm, most_mm } if *effect_mm > 10.0 * most_mm => {
                write!(
                    f,
                    "nothing checks crossing {crossing}, and without it the joint is not known; scan more marks"
                )
            }
            Self::Unchecked { crossing, effect_mm, most_mm } => write!(
                f,
                "too little checks crossing {crossing}: if it is wrong the joint may be off by {effect_mm:.3} mm, {most_mm} mm \
                 are taken; scan more marks"
            ),
            Self::Shrunk { shrunk, effect_mm, most_mm } => write!(
                f,
                "the marks at both ends may lie {:.3} % nearer to each other than they were drawn: if the paper has folded between \
                 them, an end of the joint is off by {effect_mm:.2} mm, {most_mm} mm are taken; look at the paper, and measure \
                 anew as flat if there is no fold",
                100.0 * shrunk
            ),
            Self::Swollen { swelling, effect_mm, most_mm } => write!(
                f,
                "strokes of the drawing were seen beside the marks, and marks lie as if the paper had swollen by {:.3} %: if \
                 these are strokes, an end of the joint is off by {effect_mm:.2} mm, {most_mm} mm are taken; keep strokes off \
                 the marks",
                100.0 * swelling
            ),
            Self::Angle { angle_rad, most_rad } => write!(
                f,
                "the sheet would be turned by {angle_rad:.6} rad, at most {most_rad} rad are believed; look for a mark mistaken \
                 for another"
            ),
        }
    }
}

const fn name(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "x",
        Axis::Y => "y",
    }
}

impl core::error::Error for FitError {}
