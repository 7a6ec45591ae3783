//! The search for the marks at a frame change, as state machines without a machine.
//!
//! A search *asks* for one thing at a time: a travel, or a scan whose tacts it wants to see. Whoever moves
//! the head does it and says when it is done:
//!
//! ```text
//!            ask() ──▶ Travel { to } ──▶ arrived()
//!            ask() ──▶ Scan { … } ──▶ tact(…) tact(…) … ──▶ arrived()      (over as well once ask() says something else)
//!            ask() ──▶ Done
//! ```

#[cfg(feature = "alloc")]
mod line_width;
#[cfg(feature = "alloc")]
mod mark_search;
mod published_search;
#[cfg(feature = "alloc")]
mod shown_delays;

#[cfg(feature = "alloc")]
pub use mark_search::{MarkSearch, SearchSettings};
pub use published_search::PublishedSearch;

use crate::{Crossing, ScanError, sense::Tact};
use core::fmt;
use plotter_motion::{Axis, Point};

/// What a search wants to be done next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ask {
    /// The head shall go there, at any speed, mm.
    Travel {
        /// The place.
        to: Point,
    },
    /// From where it is the head shall move along one axis, and each tact shall be told.
    Scan {
        /// Which crossing of the layout is looked at, counted from 0.
        crossing: usize,
        /// Where the head is now, mm.
        from: Point,
        /// Along which axis it moves.
        axis: Axis,
        /// Up to this coordinate, mm.
        to_mm: f64,
        /// With this velocity, mm/s; negative towards smaller coordinates.
        velocity_mm_s: f64,
    },
    /// Nothing: the search is over.
    Done,
}

/// A search for marks; see the module.
pub trait Search {
    /// What shall be done now. Stays the same until it is done or, in a scan, enough was seen.
    fn ask(&self) -> Ask;

    /// The next tact of the scan that was asked for. Tacts beyond what was asked for are ignored.
    ///
    /// # Errors
    ///
    /// [`SearchError`] if it is none. The search stays where it is.
    fn tact(&mut self, tact: Tact) -> Result<(), SearchError>;

    /// What was asked for is done.
    ///
    /// # Errors
    ///
    /// [`SearchError`] if a mark was not found without which the search cannot go on.
    fn arrived(&mut self) -> Result<(), SearchError>;
}

/// Why a search failed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SearchError {
    /// A mark was not found.
    NotFound {
        /// Which crossing, counted from 0.
        index: usize,
        /// The mark, and where it was scanned.
        crossing: Crossing,
        /// From where, mm.
        from_mm: f64,
        /// To where, mm.
        to_mm: f64,
    },
    /// Too few marks were found.
    TooFew {
        /// At how many crossings something was found.
        found: usize,
        /// Of how many.
        crossings: usize,
        /// The first crossing without a mark, counted from 0.
        first_missed: usize,
        /// That mark.
        crossing: Crossing,
    },
    /// A tact is none.
    Tact {
        /// In the scan over which crossing, counted from 0.
        index: usize,
        /// What is wrong.
        error: ScanError,
    },
    /// The search is not over yet.
    NotDone,
}

impl fmt::Display for SearchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFound { index, crossing, from_mm, to_mm } => write!(
                f,
                "mark {index}, {crossing}, was not found between {from_mm} and {to_mm} mm; look whether it was drawn"
            ),
            Self::TooFew { found, crossings, first_missed, crossing } => write!(
                f,
                "marks were found at only {found} of {crossings} crossings; the first that was missed is mark {first_missed}, {crossing}"
            ),
            Self::Tact { index, error } => write!(f, "in the scan over mark {index}: {error}"),
            Self::NotDone => f.write_str("the search is not over yet; do what it asks for"),
        }
    }
}

impl core::error::Error for SearchError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Tact { error, .. } => Some(error),
            _ => None,
        }
    }
}

impl fmt::Display for Crossing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (mark, scan) = match self.axis {
            Axis::X => ('x', 'y'),
            Axis::Y => ('y', 'x'),
        };
        write!(f, "{mark} = {} mm scanned at {scan} = {} mm", self.mark_mm, self.scan_at_mm)
    }
}

/// The place of a scan: its own coordinate along the axis, the crossing's across it.
fn place(crossing: &Crossing, along_mm: f64) -> Point {
    match crossing.axis {
        Axis::X => Point::new(along_mm, crossing.scan_at_mm),
        Axis::Y => Point::new(crossing.scan_at_mm, along_mm),
    }
}
