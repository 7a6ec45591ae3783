//! The figures of a drawing, and its picture.

use super::command::MaxErrorCommand;
use super::plan::{Plan, Refusal, SAFETY};
use super::scan::Scan;
use crate::max_error::{FollowedPath, TruePath};
use crate::shared::{assumed, told_insides, write_file};
use plotter_motion::{
    Machine,
    budget::{Budget, BudgetError, BudgetPart},
};
use plotter_replay::{Canvas, CanvasStyle, draw::Layer};
use plotter_vector::{
    ink::Despeckled,
    report::{FollowedLines, Spots},
};
use serde_json::json;

/// What was asked, promised and measured.
pub(super) struct Report<'a> {
    pub(super) args: &'a MaxErrorCommand,
    pub(super) name: String,
    pub(super) mm_per_px: f64,
    pub(super) plan: Plan,
    duration_s: f64,
    /// The ink from what was drawn, and that from the ink, mm.
    pub(super) measured: [f64; 2],
    /// Line by line.
    pub(super) followed: FollowedLines,
    pub(super) dirt: Despeckled,
    /// Ink of areas that outlines do not draw.
    insides: Spots,
    /// What was taken from the file or assumed.
    told: Vec<(&'static str, String)>,
}

impl<'a> Report<'a> {
    pub(super) fn new(
        args: &'a MaxErrorCommand,
        machine: &Machine,
        scan: &Scan,
        plan: Plan,
        path: &FollowedPath,
    ) -> Self {
        // Against all ink: what was taken for dirt counts, unless that is allowed.
        let ink = if args.allow_dirt { &scan.ink } else { &scan.all_ink };
        let drawn = scan.in_pixels(&path.drawn);
        let measured = scan.distance_mm(ink, &drawn);
        Self {
            followed: scan.followed(&drawn, args.max_error_mm),
            dirt: scan.dirt,
            insides: scan.insides.clone(),
            told: scan.told.clone(),
            args,
            name: machine.config().name.to_string(),
            mm_per_px: scan.scale.mm_per_px(),
            plan,
            duration_s: path.duration.as_secs_f64(),
            measured: measured.map(|mm| mm + TruePath::TOLERANCE_MM),
        }
    }

    pub(super) fn measured_mm(&self) -> f64 {
        self.measured.into_iter().fold(0.0, f64::max)
    }

    /// What was taken for dirt, if anything.
    pub(super) fn dirt(&self) -> Option<String> {
        let Despeckled { removed_marks, removed_px, largest_removed_px, .. } = self.dirt;
        let of = if removed_marks == 1 { "mark is" } else { "marks are" };
        (removed_marks > 0).then(|| {
            format!(
                "{removed_marks} {of} left out, {removed_px} px of ink (the largest {largest_removed_px} px)"
            )
        })
    }

    /// The part that takes most of what was promised.
    fn largest_part(&self) -> BudgetPart {
        let Budget { vectorization_mm, blend_mm, control_mm, .. } = self.plan.budget;
        if control_mm >= vectorization_mm.max(blend_mm) {
            BudgetPart::Control
        } else if vectorization_mm >= blend_mm {
            BudgetPart::Vectorization
        } else {
            BudgetPart::Blend
        }
    }

    pub(super) fn json(&self) -> serde_json::Value {
        let Plan { budget, traced, control, .. } = &self.plan;
        let [ink_mm, drawn_mm] = self.measured;
        json!({
            "machine": self.name,
            "asked_mm": self.args.max_error_mm,
            "assumed": assumed(&self.told),
            "promised_mm": budget.promised_mm(),
            "measured_mm": self.measured_mm(),
            "parts": {
                "vectorization_mm": budget.vectorization_mm,
                "blend_mm": budget.blend_mm,
                "control_mm": budget.control_mm,
            },
            "largest_part": self.largest_part().to_string(),
            "dirt": {
                "marks": self.dirt.removed_marks,
                "px": self.dirt.removed_px,
                "largest_px": self.dirt.largest_removed_px,
            },
            "areas": &self.insides,
            "lines": {
                "of_scan": self.followed.lines,
                "followed": self.followed.followed(),
                "merged": self.followed.merged.len(),
                "dropped": self.followed.dropped.len(),
            },
            "drawing_time_s": self.duration_s,
            "speed_share": budget.speed_share,
            "measured": { "ink_from_drawn_mm": ink_mm, "drawn_from_ink_mm": drawn_mm },
            "vectorization": {
                "mm_per_px": self.mm_per_px,
                "tolerance_px": traced.tolerance_px,
                "vertices": traced.drawing.vertices(),
                "strokes": traced.drawing.strokes().len(),
            },
            "control": {
                "rounding_mm": control.rounding_mm,
                "test_figure_mm": control.fast_mm,
                "test_figure_slowly_mm": control.slow_mm,
                "safety": SAFETY,
            },
        })
    }

    pub(super) fn table(&self) -> String {
        let Plan { budget, traced, .. } = &self.plan;
        let mm = |mm: f64| format!("{mm:.4} mm");
        let rows = [
            ("machine", self.name.clone()),
            ("asked", mm(self.args.max_error_mm)),
            ("promised", mm(budget.promised_mm())),
            ("  vectorization", mm(budget.vectorization_mm)),
            ("  blends", mm(budget.blend_mm)),
            ("  control", mm(budget.control_mm)),
            ("measured", mm(self.measured_mm())),
            ("  ink from what was drawn", mm(self.measured[0])),
            ("  what was drawn from ink", mm(self.measured[1])),
            ("lines followed", format!("{} of {}", self.followed.followed(), self.followed.lines)),
            ("  merged, dropped", format!("{}, {}", self.followed.merged.len(), self.followed.dropped.len())),
            ("vertices", traced.drawing.vertices().to_string()),
            ("share of the speed", format!("{:.0} %", 100.0 * budget.speed_share)),
            ("drawing time", format!("{:.1} s", self.duration_s)),
        ];
        let left_out: String = told_insides(&self.insides)
            .into_iter()
            .chain(self.dirt())
            .map(|told| format!("{told}\n"))
            .collect();
        let told = self.told.iter().cloned();
        told.chain(rows).map(|(name, value)| format!("{name:28} {value:>22}\n")).collect::<String>()
            + &left_out
    }
}

/// A refusal as JSON, where one was asked for; what cannot be written is no second error.
pub(super) fn report_refusal(args: &MaxErrorCommand, machine: &Machine, scan: &Scan, refusal: &Refusal) {
    let Some(file) = &args.report else { return };
    let mut report = json!({
        "machine": machine.config().name.to_string(),
        "asked_mm": args.max_error_mm,
        "assumed": assumed(&scan.told),
        "refused": refusal.to_string(),
    });
    if let (Refusal::Budget(BudgetError::TooSmall { limiting, smallest_mm, .. }), Some(keys)) =
        (refusal, report.as_object_mut())
    {
        keys.insert("limiting_part".into(), json!(limiting.to_string()));
        keys.insert("smallest_mm".into(), json!(smallest_mm));
    }
    let _ = write_file(file, format!("{report:#}\n"));
}

/// What was drawn, on a band as wide as the error allows about the scan's lines.
pub(super) fn picture(scan: &Scan, path: &FollowedPath, max_error_mm: f64) -> String {
    let mut canvas = Canvas::new();
    for stroke in scan.reference.strokes() {
        canvas.add(Layer::Desired, stroke.iter().map(|at| scan.scale.to_sheet(*at)));
    }
    for stroke in &path.drawn {
        canvas.add(Layer::Ink, stroke.iter().copied());
    }
    let style = canvas.fitted_style();
    let desired_width_mm = 2.0 * max_error_mm;
    canvas.to_svg(&CanvasStyle {
        desired_width_mm,
        ink_width_mm: (0.25 * desired_width_mm).min(0.1),
        margin_mm: style.margin_mm + max_error_mm,
        tolerance_mm: 0.01 * max_error_mm,
        ..style
    })
}
