//! What an optical sensor tells of a line: its crossings, found in one scan, and searched for over several.

mod crossing;
mod detector;
mod search;

pub use crossing::{Crossing, Found, Passed, found_at};
pub use detector::{BothEdges, FindLine, Optics, PublishedRule, ScanError, Sighting, Tact, disc_over_line};
pub use search::{Ask, PublishedSearch, Search, SearchError};
#[cfg(feature = "alloc")]
pub use search::{MarkSearch, SearchSettings};
