//! [`FollowOutcome`]: the figures of a line follower's run, to be read and as JSON.

use crate::machine::SteppedFigures;
use crate::shared::assumed;
use plotter_vector::PxPoint;
use plotter_vector::follow::{FollowReport, Judged};
use std::fmt::Write as _;

/// Result of a run of a line follower.
#[derive(Clone, Debug)]
pub struct FollowOutcome<'a> {
    /// What was followed.
    pub name: &'a str,
    /// Windows looked at.
    pub windows: u64,
    /// Moves made.
    pub moves: u64,
    /// Windows without the line.
    pub lost: u64,
    /// Times that the tool was lifted between two lines.
    pub lifts: usize,
    /// Whether the follower says that it did all.
    pub finished: bool,
    /// How it ended.
    pub said: String,
    /// The tool's path beside the drawing's lines, where those are known and there are any.
    pub judged: Option<Judged>,
    /// What was taken from the picture's file or assumed, each with its name.
    pub told: Vec<(&'static str, String)>,
    /// What ours knows.
    pub map: Option<FollowReport>,
    /// What the machine did.
    pub motion: SteppedFigures,
}

impl FollowOutcome<'_> {
    /// The figures, to be read.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = format!(
            "{}: {}\n  windows {}, moves {}, pictures without the line {}, lifts {}\n",
            self.name, self.said, self.windows, self.moves, self.lost, self.lifts
        );
        if let Some(judged) = self.judged.as_ref().filter(|judged| judged.true_px > 0.0) {
            let _ = writeln!(
                text,
                "  covered {:.2} % of {:.0} px of lines, followed twice {:.2} %",
                100.0 * judged.coverage,
                judged.true_px,
                100.0 * judged.repeated
            );
        }
        if let Some(judged) = self.judged.as_ref().filter(|judged| judged.path_px > 0.0) {
            let _ = writeln!(
                text,
                "  path {:.0} px, off the middle of the lines: rms {:.2} px, at most {:.2} px at ({:.0}, {:.0})",
                judged.path_px, judged.rms_px, judged.max_px, judged.worst.x, judged.worst.y
            );
        }
        for (name, said) in &self.told {
            let _ = writeln!(text, "  {name}: {said}");
        }
        let _ = writeln!(
            text,
            "  machine: {:.1} s in motion, {} steps",
            self.motion.motion_s, self.motion.step_events
        );
        if let Some(map) = &self.map {
            if map.followed_px > 0.0 {
                let _ = writeln!(
                    text,
                    "  lines {:.1} px wide; play found: {:.2} and {:.2} px",
                    map.line_width_px, map.play_px[0], map.play_px[1]
                );
            }
            if map.outside_px > 0.0 {
                let _ = writeln!(
                    text,
                    "  outside of the machine's area: {:.0} px of the lines that were seen",
                    map.outside_px
                );
            }
            for (what, places) in
                [("a line leaves the machine's area", &map.leaves), ("an area of ink, left out", &map.areas)]
            {
                if let Some(first) = places.first() {
                    let _ = writeln!(
                        text,
                        "  {what}: {} times, first at ({:.0}, {:.0})",
                        places.len(),
                        first.x,
                        first.y
                    );
                }
            }
        }
        text
    }

    /// The figures and the path, as JSON.
    ///
    /// # Errors
    ///
    /// None that is known.
    pub fn json(&self, strokes: &[Vec<PxPoint>]) -> Result<String, String> {
        let pairs = |stroke: &Vec<PxPoint>| -> Vec<[f64; 2]> {
            stroke.iter().map(|at| [at.x, at.y].map(|v| libm::round(1000.0 * v) / 1000.0)).collect()
        };
        let strokes: Vec<Vec<[f64; 2]>> = strokes.iter().map(pairs).collect();
        let judged = self.judged.as_ref();
        let value = serde_json::json!({
            "windows": self.windows,
            "moves": self.moves,
            "lost": self.lost,
            "lifts": self.lifts,
            "finished": self.finished,
            "end": self.said,
            "coverage": judged.map(|judged| judged.coverage),
            "repeated": judged.map(|judged| judged.repeated),
            "rms_px": judged.map(|judged| judged.rms_px),
            "max_px": judged.map(|judged| judged.max_px),
            "lines_px": judged.map(|judged| judged.true_px),
            "path_px": judged.map(|judged| judged.path_px),
            "motion_s": self.motion.motion_s,
            "steps": self.motion.step_events,
            "map": self.map,
            "assumed": assumed(&self.told),
            "path_points": strokes.concat(),
            "strokes": strokes,
        });
        serde_json::to_string(&value).map(|text| text + "\n").map_err(|error| error.to_string())
    }
}
