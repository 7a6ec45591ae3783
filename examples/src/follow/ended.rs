//! Ends of a run, with a remedy for each.

use plotter_vector::{
    PxPoint,
    follow::{End, Lost},
};

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
    /// In words; `over` is what the camera went over.
    pub(super) fn told(&self, windows: u64, over: Over) -> String {
        match self {
            Self::Said(end) => format!("{end}{}", remedy(end, over)),
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

/// What the camera went over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Over {
    /// A picture with lines.
    Lines,
    /// A picture without.
    Nothing,
    /// What a real camera saw, or the pictures that stand for one.
    Unknown,
}

/// What helps where it ended too early; of a simulated camera nothing that only a real one can suffer.
fn remedy(end: &End, over: Over) -> &'static str {
    match (end, over) {
        (End::Complete, _) => "",
        (End::WindowLimit { .. }, _) => "; --windows N allows more",
        (End::NoLine { .. }, Over::Nothing) => {
            "; no line was found in the picture either: the sheet is empty"
        }
        (End::NoLine { why: Lost::OneColour, .. }, Over::Lines) => {
            "; the picture has lines: --start X,Y puts the camera over one, and --camera with less blur and noise shows \
             it more of them"
        }
        (End::NoLine { why: Lost::Elsewhere, .. }, Over::Lines) => {
            "; the follower lost its line there, not the drawing: a smaller --table-error or --play, or larger windows \
             (--camera size=PX), keep it on the line"
        }
        (End::NoLine { why: Lost::Elsewhere, .. }, Over::Unknown) => {
            "; larger windows (--window), a --correction of the lens, or shorter moves keep it on the line"
        }
        (End::NoLine { why: Lost::TooThick, .. }, _) => {
            "; lines of more than 40 px are areas here: a picture with fewer dots per inch has thinner ones"
        }
        (End::NoLine { why: Lost::OneColour, .. }, Over::Unknown) => "; it follows dark lines on light paper",
        (End::NoLine { why: Lost::WindowSize, .. }, _) => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ended_too_early_says_what_helps_and_never_that_simulated_paper_moved() {
        let at = PxPoint::new(1.0, 2.0);
        let told = |why, over| Ended::Said(End::NoLine { at, why }).told(7, over);
        assert!(told(Lost::OneColour, Over::Lines).contains("--start X,Y"));
        assert!(told(Lost::OneColour, Over::Nothing).ends_with("the sheet is empty"));
        assert!(told(Lost::OneColour, Over::Unknown).ends_with("dark lines on light paper"));
        let lost = told(Lost::Elsewhere, Over::Lines);
        assert!(
            lost.contains("the follower lost its line there") && lost.contains("--table-error"),
            "{lost}"
        );
        assert!(told(Lost::TooThick, Over::Lines).contains("fewer dots per inch"));
        let limit = Ended::Said(End::WindowLimit { at }).told(7, Over::Lines);
        assert!(limit.ends_with("--windows N allows more"), "{limit}");
        assert_eq!(Ended::Said(End::Complete).told(7, Over::Lines), End::Complete.to_string());
    }
}
