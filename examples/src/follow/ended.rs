//! How a run ended.

use plotter_vector::{PxPoint, follow::End};

/// What helps where the machine reaches none of the lines.
const REACH_REMEDY: &str =
    "all that were seen lie outside of the machine's area; a smaller --mm-per-px or another --start may help";

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ended {
    Said(End),
    /// All lines that were seen lie outside of the machine's area.
    OutOfReach,
    /// After as many windows as were allowed.
    Stopped,
    /// The folder has no more.
    NoMorePictures(PxPoint),
    /// The camera, or a picture.
    Failed(String),
}

impl Ended {
    pub(super) fn told(&self, windows: u64) -> String {
        match self {
            Self::Said(end) => end.to_string(),
            Self::OutOfReach => format!("no line can be reached: {REACH_REMEDY}"),
            Self::Stopped => format!("stopped after {windows} windows; it never ends by itself"),
            Self::NoMorePictures(at) => {
                format!(
                    "no more pictures after {windows}; lines may be left; stopped at ({:.1}, {:.1}) px",
                    at.x, at.y
                )
            }
            Self::Failed(error) => error.clone(),
        }
    }
}
