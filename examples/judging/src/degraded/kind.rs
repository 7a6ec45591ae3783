//! [`Kind`] and [`Strength`]: in which way a drawing is degraded, and how much.

use clap::ValueEnum;

/// A way in which drawings reach a vectorizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Kind {
    /// Ink on paper from a flat-bed scanner
    Clean,
    /// Graphite on rough paper
    Pencil,
    /// Light lines on a dark board, with smears
    Chalk,
    /// A felt pen whose ink creeps
    Marker,
    /// Photographed in uneven light
    Photo,
    /// Photographed below lamps or windows
    Reflections,
    /// On squared paper, photographed
    Squared,
    /// A sheet that lies askew on a table
    Perspective,
    /// Saved by JPEG's lossy compression
    Jpeg,
    /// Enlarged, each pixel as a square
    EnlargedNearest,
    /// Enlarged, with smooth edges
    EnlargedBicubic,
    /// Lines that hardly differ from their paper
    Faint,
    /// The other side of the sheet shows through
    BleedThrough,
    /// On dark, fibrous paper, into which ink spreads
    Newsprint,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Clean,
        Self::Pencil,
        Self::Chalk,
        Self::Marker,
        Self::Photo,
        Self::Reflections,
        Self::Squared,
        Self::Perspective,
        Self::Jpeg,
        Self::EnlargedNearest,
        Self::EnlargedBicubic,
        Self::Faint,
        Self::BleedThrough,
        Self::Newsprint,
    ];

    /// Name in names of files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Pencil => "pencil",
            Self::Chalk => "chalk",
            Self::Marker => "marker",
            Self::Photo => "photo",
            Self::Reflections => "reflections",
            Self::Squared => "squared",
            Self::Perspective => "perspective",
            Self::Jpeg => "jpeg",
            Self::EnlargedNearest => "enlarged_nearest",
            Self::EnlargedBicubic => "enlarged_bicubic",
            Self::Faint => "faint",
            Self::BleedThrough => "bleed_through",
            Self::Newsprint => "newsprint",
        }
    }
}

/// How much a drawing is degraded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Strength {
    /// Less than usual
    Weak,
    /// As such pictures usually are
    Middle,
    /// Near the end of what a person makes out without effort
    Strong,
}

impl Strength {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Weak, Self::Middle, Self::Strong];

    /// Name in names of files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Weak => "weak",
            Self::Middle => "middle",
            Self::Strong => "strong",
        }
    }
}
