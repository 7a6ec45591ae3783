//! From what the optical head samples along a scan to where it saw a line.
//!
//! Published and ours stand behind one trait, [`FindLine`]: tacts are pushed in the order in which the head
//! passes them, and each line, or what looks like one, comes out once it is over.

mod both_edges;
mod coverage;
mod optics;
mod published_rule;

pub use both_edges::BothEdges;
pub use coverage::disc_over_line;
pub use optics::Optics;
pub use published_rule::PublishedRule;

use core::fmt;

/// Farthest that a head can be, mm. Up to here nothing below overflows.
const FARTHEST_MM: f64 = 1e9;

/// What the head saw in one tact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tact {
    /// Where the head was in the middle of the tact, along the scan, mm.
    pub position_mm: f64,
    /// In how many of its two samples a line was seen: 0, 1 or 2.
    pub hits: u8,
    /// Share of the disc that was covered in either sample, if the detector gives it; noise may carry it
    /// below 0 and above 1.
    pub covered: Option<[f64; 2]>,
}

/// Something dark that the head passed over.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sighting {
    /// Its middle, along the scan, mm.
    pub at_mm: f64,
    /// How long it was seen, mm.
    pub span_mm: f64,
    /// Standard deviation of `at_mm` from the sampling alone, mm.
    pub sigma_mm: f64,
    /// Whether it was seen for about as long as a pen's line is.
    pub like_a_line: bool,
}

/// Finds lines in the tacts of one scan.
pub trait FindLine {
    /// Takes the next tact; the answer is what ended before it.
    ///
    /// # Errors
    ///
    /// [`ScanError`] if the tact is none, or does not follow the last one. It is left out, the scan may go
    /// on.
    fn push(&mut self, tact: Tact) -> Result<Option<Sighting>, ScanError>;

    /// The scan is over: what was still under the head.
    fn finish(&mut self) -> Option<Sighting>;
}

/// Why a tact was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ScanError {
    /// A position or a coverage is not finite, or no machine is so large.
    NotFinite {
        /// The number.
        value: f64,
    },
    /// A tact has two samples.
    Hits {
        /// How many were said to have seen the line.
        hits: u8,
    },
    /// The head did not move on.
    Order {
        /// Its last position, mm.
        last_mm: f64,
        /// Its position now, mm.
        position_mm: f64,
    },
}

impl fmt::Display for ScanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { value } => write!(f, "{value} is no position or coverage of a scan"),
            Self::Hits { hits } => {
                write!(f, "{hits} hits in a tact that has two samples; 0, 1 or 2 are possible")
            }
            Self::Order { last_mm, position_mm } => write!(
                f,
                "the tact at {position_mm} mm does not follow the one at {last_mm} mm; give the tacts in the order of the scan"
            ),
        }
    }
}

impl core::error::Error for ScanError {}

/// The order of tacts, which both detectors ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Order {
    /// 1 or -1: the way the head goes.
    sign: f64,
    last_mm: Option<f64>,
}

impl Order {
    fn new(velocity_mm_s: f64) -> Self {
        Self { sign: if velocity_mm_s < 0.0 { -1.0 } else { 1.0 }, last_mm: None }
    }

    /// Whether the tact may come now.
    fn check(&mut self, tact: &Tact) -> Result<(), ScanError> {
        let is_a_place = |mm: f64| (-FARTHEST_MM..=FARTHEST_MM).contains(&mm);
        if let Some(value) = core::iter::once(tact.position_mm)
            .chain(tact.covered.into_iter().flatten())
            .find(|&value| !is_a_place(value))
        {
            return Err(ScanError::NotFinite { value });
        }
        if tact.hits > 2 {
            return Err(ScanError::Hits { hits: tact.hits });
        }
        if let Some(last_mm) = self.last_mm
            && (tact.position_mm - last_mm) * self.sign <= 0.0
        {
            return Err(ScanError::Order { last_mm, position_mm: tact.position_mm });
        }
        self.last_mm = Some(tact.position_mm);
        Ok(())
    }
}
