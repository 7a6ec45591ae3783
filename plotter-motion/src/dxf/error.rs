//! [`Error`]: what is wrong with a text, what is not drawn of it, and what helps.

use alloc::string::String;
use core::fmt;

/// Something in a text that is not drawn as it stands there. The rest of it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// Line of the text, from 1; 0 for one that belongs to no line.
    pub line: u32,
    /// The problem.
    pub problem: Problem,
}

/// Problems in a DXF file: faults, and parts that are not drawn.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Problem {
    /// The file is not DXF in text.
    OtherFormat {
        /// The format that it has, and the remedy.
        what: &'static str,
    },
    /// A line that is no group code, where one belongs.
    NoCode {
        /// The line.
        text: String,
    },
    /// The text ends within a group or a section.
    Cut,
    /// An entity without what it needs, or with numbers that are none. It is left out.
    BadEntity {
        /// Kind of the entity, such as `CIRCLE`.
        kind: String,
        /// The fault.
        what: &'static str,
    },
    /// A block that is not there, with all that it would draw.
    NoBlock {
        /// Name of the block.
        name: String,
    },
    /// Blocks within each other, deeper than 32: one of them holds itself.
    Depth {
        /// Name of the block that is left out.
        name: String,
    },
    /// More than 4 million entities by blocks: what follows is left out.
    Many,
    /// Entities of a kind that no pen draws, or that is not read. A notice.
    NotDrawn {
        /// Their kind.
        kind: String,
        /// How many.
        count: u32,
        /// Why, and what helps.
        why: &'static str,
    },
    /// A part that is drawn differently from its looks. A notice.
    Otherwise {
        /// What, how, and what helps.
        what: &'static str,
        /// How many.
        count: u32,
    },
    /// Entities on a layer that is off, frozen or not for plots. A notice.
    Hidden {
        /// Name of the layer.
        layer: String,
        /// How many.
        count: u32,
    },
    /// Letters that the font does not have; a gap stands in their place. A notice.
    NoLetter {
        /// The first of them.
        letter: char,
        /// How many.
        count: u32,
    },
    /// The file does not say its unit, and millimetres are taken. A notice.
    NoUnit,
}

impl Error {
    /// Whether the file is right, and only something of it is not done here or needs to be known.
    #[must_use]
    pub fn is_notice(&self) -> bool {
        matches!(
            self.problem,
            Problem::NotDrawn { .. }
                | Problem::Otherwise { .. }
                | Problem::Hidden { .. }
                | Problem::NoLetter { .. }
                | Problem::NoUnit
        )
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        self.problem.fmt(f)
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let times = |f: &mut fmt::Formatter<'_>, count: u32| match count {
            1 => Ok(()),
            _ => write!(f, " ({count} of them)"),
        };
        match self {
            Self::OtherFormat { what } => f.write_str(what),
            Self::NoCode { text } => write!(
                f,
                "`{text}` stands where the number of a group belongs: lines are passed over up to the next one; save the drawing again \
                 as ASCII DXF"
            ),
            Self::Cut => f.write_str("the file ends here, before its end: what follows is missing; save or send it again"),
            Self::BadEntity { kind, what } => write!(f, "a {kind} is left out: {what}"),
            Self::NoBlock { name } => {
                write!(f, "the block `{name}` is not in the file: what it draws is left out; bind references and save again")
            }
            Self::Depth { name } => write!(
                f,
                "the block `{name}` is left out: blocks lie in each other more than 32 deep, so that one holds itself"
            ),
            Self::Many => f.write_str(
                "more than 4 million entities by blocks in each other: what follows is left out; explode or purge the blocks",
            ),
            Self::NotDrawn { kind, count, why } => {
                write!(f, "{kind} is not drawn")?;
                times(f, *count)?;
                write!(f, ": {why}")
            }
            Self::Otherwise { what, count } => {
                f.write_str(what)?;
                times(f, *count)
            }
            Self::Hidden { layer, count } => {
                let (noun, verb) = if *count == 1 { ("entity", "is") } else { ("entities", "are") };
                let (why, remedy) = if layer.eq_ignore_ascii_case(super::drawing::NEVER_PLOTTED) {
                    ("no CAD program plots", "move what is to be drawn to another one")
                } else {
                    ("is off, frozen or not for plots", "turn it on")
                };
                write!(f, "{count} {noun} of the layer `{layer}`, which {why}, {verb} left out: {remedy}")
            }
            Self::NoLetter { letter, count } => {
                write!(f, "the letter `{letter}` is not in the font of single lines: a gap stands for it")?;
                times(f, *count)
            }
            Self::NoUnit => f.write_str(
                "the file does not say what its unit is: it is taken for a millimetre; say it if the drawing has another size",
            ),
        }
    }
}

impl core::error::Error for Error {}
