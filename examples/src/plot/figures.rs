//! All figures of a plot, as JSON and as a table.

use crate::machine::PlotOutcome;
use crate::shared::{assumed, told_bare, told_insides};
use plotter_replay::compare::ContourError;
use plotter_vector::{Drawing, ErrorReport, ink::Despeckled, trace::SheetErrors};
use serde_json::json;

/// All figures of a plot.
pub(super) struct Summary<'a> {
    pub(super) drawing: &'a Drawing,
    pub(super) errors: &'a SheetErrors,
    /// Whether all ink is drawn within the greatest error, and nothing else; the published algorithm promises
    /// nothing.
    pub(super) kept: Option<bool>,
    pub(super) dirt: Despeckled,
    pub(super) outcome: &'a PlotOutcome,
    pub(super) plotted: ContourError,
    pub(super) anomalies: u64,
    pub(super) wall_s: f64,
    /// What was taken from the picture's file or assumed.
    pub(super) told: Vec<(&'static str, String)>,
}

impl Summary<'_> {
    pub(super) fn json(&self) -> String {
        let SheetErrors { report, beyond, bare, insides, .. } = self.errors;
        let ErrorReport { mean_px, max_px, sd_px, .. } = *report;
        let report = json!({
            "vertices": self.drawing.vertices(),
            "strokes": self.drawing.strokes().len(),
            "vector_error_px": { "mean": mean_px, "max": max_px, "sd": sd_px },
            "beyond_ink": { "px": beyond.pixels, "max_px": beyond.max_px },
            "kept": self.kept,
            "bare": bare,
            "areas": insides,
            "dirt": {
                "marks": self.dirt.removed_marks,
                "px": self.dirt.removed_px,
                "largest_px": self.dirt.largest_removed_px,
            },
            "contour_error_mm": { "rms": self.plotted.rms_mm, "max": self.plotted.max_mm },
            "true_contour_error_mm": { "rms": self.outcome.true_rms_mm, "max": self.outcome.true_max_mm },
            "targets": self.outcome.targets,
            "reached": self.outcome.reached,
            "anomalies": self.anomalies,
            "simulated_s": self.outcome.duration.as_secs_f64(),
            "wall_s": self.wall_s,
            "assumed": assumed(&self.told),
        });
        format!("{report:#}\n")
    }

    pub(super) fn table(&self) -> Vec<(&'static str, String)> {
        let Self { outcome, errors: SheetErrors { report: error, beyond, bare, insides, .. }, .. } = self;
        let Despeckled { removed_marks, largest_removed_px, .. } = self.dirt;
        let dirt = (removed_marks > 0)
            .then(|| ("marks left out as dirt", format!("{removed_marks}, up to {largest_removed_px} px")));
        let figures = vec![
            ("vertices", self.drawing.vertices().to_string()),
            ("strokes", self.drawing.strokes().len().to_string()),
            ("vector error, mean", format!("{:.4} px", error.mean_px)),
            ("vector error, max", format!("{:.4} px", error.max_px)),
            ("vector error, sd", format!("{:.4} px", error.sd_px)),
            ("drawn beyond ink, max", format!("{:.4} px", beyond.max_px)),
            ("contour error counted, rms", format!("{:.4} mm", self.plotted.rms_mm)),
            ("contour error counted, max", format!("{:.4} mm", self.plotted.max_mm)),
            ("contour error true, rms", known_mm(outcome.true_rms_mm)),
            ("contour error true, max", known_mm(outcome.true_max_mm)),
            ("targets reached", format!("{} of {}", outcome.reached, outcome.targets)),
            ("anomalies", self.anomalies.to_string()),
            ("time of the machine", format!("{:.2} s", outcome.duration.as_secs_f64())),
            ("wall time", format!("{:.2} s", self.wall_s)),
        ];
        let bare = told_bare(bare).map(|told| ("bare", told));
        let areas = told_insides(insides).map(|told| ("areas", told));
        self.told.iter().cloned().chain(figures).chain(bare).chain(areas).chain(dirt).collect()
    }
}

fn known_mm(value: Option<f64>) -> String {
    value.map_or_else(|| String::from("only the machine knows"), |value| format!("{value:.4} mm"))
}
