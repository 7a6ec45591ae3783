//! [`LongSheetReport`]: the figures of a simulated sheet.

use crate::long_sheet::{FrameFigures, JointFigures};
use plotter_stitch::{FoldVerdict, sheet::FoldCheck};
use serde::Serialize;
use std::fmt::Write as _;

/// All figures of a sheet, for a person and for a program.
#[derive(Clone, Debug, Serialize)]
pub struct LongSheetReport {
    /// What was drawn.
    pub drawing: String,
    /// By which procedure.
    pub method: String,
    /// Seed of the simulation.
    pub seed: u64,
    /// Length of the drawing along the sheet, mm, up to its last frame's end.
    pub length_mm: f64,
    /// Frames that were drawn, those without a drawing among them.
    pub frames: usize,
    /// Lines and arcs.
    pub segments: u64,
    /// Lines cut at a border.
    pub breaks: usize,
    /// Places outside of the machine's area.
    pub outside: u64,
    /// Time of the machine, s, without its pen.
    pub motion_s: f64,
    /// Distance between both ends of cut lines, mm: root of the mean square, and the greatest.
    pub joint_rms_mm: f64,
    /// See above.
    pub joint_worst_mm: f64,
    /// Greatest drift across the sheet, mm, and that of the last frame.
    pub drift_worst_mm: f64,
    /// See above.
    pub drift_last_mm: f64,
    /// The most that lines were moved at a joint to keep the drawing straight, mm.
    pub anchor_worst_mm: f64,
    /// Probes for folds: drawn, and without an empty square.
    pub fold_probes: usize,
    /// See above.
    pub fold_no_square: usize,
    /// How often the run stopped for a fit by hand.
    pub fold_stops: u32,
    /// Folds that were reported, that were there and missed, and that were reported of flat paper.
    pub folds: usize,
    /// See above.
    pub folds_missed: usize,
    /// See above.
    pub false_alarms: usize,
    /// Joint by joint.
    pub joints: Vec<JointRow>,
}

/// One joint.
#[derive(Clone, Debug, Serialize)]
pub struct JointRow {
    /// The frame after it.
    pub frame: u32,
    /// Lines cut at it.
    pub breaks: usize,
    /// Greatest distance between both ends of a line, mm.
    pub worst_mm: f64,
    /// Root of the mean square, mm.
    pub rms_mm: f64,
    /// Turn of the frame on the machine, rad.
    pub angle_rad: f64,
    /// Its shift, mm.
    pub shift_mm: [f64; 2],
    /// Crossings whose marks agree.
    pub marks: u32,
    /// What was added to keep the drawing straight, mm.
    pub anchor_mm: f64,
    /// Drift across the sheet, mm.
    pub drift_mm: f64,
    /// What the fold probe said.
    pub fold: String,
}

impl LongSheetReport {
    /// Sums up.
    #[must_use]
    pub fn new(
        drawing: &str,
        method: &str,
        seed: u64,
        frame_mm: f64,
        joints: &[JointFigures],
        frames: &FrameFigures,
    ) -> Self {
        let (mut squares, mut count) = (0.0, 0_u32);
        for joint in joints {
            squares += joint.rms_mm * joint.rms_mm;
            count += 1;
        }
        let most = |of: &dyn Fn(&JointFigures) -> f64| joints.iter().map(of).fold(0.0, f64::max);
        let counted = |of: &dyn Fn(&JointFigures) -> bool| joints.iter().filter(|joint| of(joint)).count();
        let is_probed = |joint: &JointFigures| matches!(joint.fold, FoldCheck::Probed { .. });
        let is_fold = |joint: &JointFigures| {
            matches!(joint.fold, FoldCheck::Probed { verdict: FoldVerdict::Fold { .. }, .. })
        };
        Self {
            drawing: drawing.into(),
            method: method.into(),
            seed,
            length_mm: frame_mm * f64::from(count + 1),
            frames: joints.len() + 1,
            segments: frames.segments,
            breaks: joints.iter().map(|joint| joint.breaks).sum(),
            outside: frames.outside,
            motion_s: frames.motion_s,
            joint_rms_mm: (squares / f64::from(count.max(1))).sqrt(),
            joint_worst_mm: most(&|joint| joint.worst_mm),
            drift_worst_mm: most(&|joint| joint.report.drift.lateral_mm.abs()),
            drift_last_mm: joints.last().map_or(0.0, |joint| joint.report.drift.lateral_mm),
            anchor_worst_mm: most(&|joint| joint.report.anchored_mm),
            fold_probes: counted(&is_probed),
            fold_no_square: counted(&|joint| !is_probed(joint)),
            fold_stops: joints.iter().map(|joint| joint.fits).sum(),
            folds: counted(&is_fold),
            folds_missed: counted(&|joint| {
                joint.report.fold_mm.is_some() && is_probed(joint) && !is_fold(joint)
            }),
            false_alarms: counted(&|joint| joint.report.fold_mm.is_none() && is_fold(joint)),
            joints: joints.iter().map(JointRow::new).collect(),
        }
    }

    /// A table to print.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = String::new();
        let mut row = |name: &str, value: String| {
            let _ = writeln!(text, "{name:28} {value}");
        };
        row("drawing", self.drawing.clone());
        row("procedure", self.method.clone());
        row("frames", format!("{} ({:.1} m)", self.frames, self.length_mm / 1e3));
        row("lines and arcs", format!("{}, {} cut at a joint", self.segments, self.breaks));
        row("motion", format!("{:.1} s", self.motion_s));
        row("ends of cut lines, rms", format!("{:.4} mm", self.joint_rms_mm));
        row("ends of cut lines, greatest", format!("{:.4} mm", self.joint_worst_mm));
        row("drift, last frame", format!("{:.3} mm", self.drift_last_mm));
        row("drift, greatest", format!("{:.3} mm", self.drift_worst_mm));
        row("added at a joint, greatest", format!("{:.4} mm", self.anchor_worst_mm));
        row(
            "folds",
            format!(
                "{} of {} probes, {} missed, {} false; {} stops for a fit by hand; {} frames without an empty square",
                self.folds,
                self.fold_probes,
                self.folds_missed,
                self.false_alarms,
                self.fold_stops,
                self.fold_no_square
            ),
        );
        if self.outside > 0 {
            row("outside of the area", format!("{} places", self.outside));
        }
        text
    }
}

impl JointRow {
    fn new(joint: &JointFigures) -> Self {
        let report = &joint.report;
        let shift = report.drawn.shift();
        Self {
            frame: report.frame,
            breaks: joint.breaks,
            worst_mm: joint.worst_mm,
            rms_mm: joint.rms_mm,
            angle_rad: report.drawn.angle_rad(),
            shift_mm: [shift.x, shift.y],
            marks: report.joined.marks,
            anchor_mm: report.anchored_mm,
            drift_mm: report.drift.lateral_mm,
            fold: match joint.fits {
                0 => joint.fold.to_string(),
                fits => format!("{}; stopped, fitted by hand {fits} times and measured anew", joint.fold),
            },
        }
    }
}
