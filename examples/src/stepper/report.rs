//! [`SteppedReport`]: what is said of a plot by its steps.

use crate::drawings::{Diagnostic, Diagnostics, DrawingFile, Language};
use crate::machine::SteppedFigures;
use crate::stepper::DrawnExtent;
use plotter_motion::kinematics::MotorScale;
use plotter_motion::{Machine, PathMode, PlannerSettings, planner::JerkLimit, stepgen::PlotTime};
use serde::Serialize;
use std::fmt::Write as _;

/// Everything that is said of a plot, for a person and for a program.
#[derive(Clone, Debug, Serialize)]
pub struct SteppedReport {
    file: String,
    language: Language,
    machine: String,
    mode: &'static str,
    tolerance_mm: Option<f64>,
    allowance_mm: Option<f64>,
    s_curve: bool,
    /// Whether the times are those of the plan, without its steps.
    estimated: bool,
    limits: Limits,
    steps_per_mm: [f64; 2],
    time_s: f64,
    time_with_pen_s: f64,
    dwell_s: f64,
    draw_mm: f64,
    travel_mm: f64,
    segments: u64,
    courses: u64,
    strokes: u64,
    pen_lifts: u64,
    #[serde(flatten)]
    measured: Option<Measured>,
    bounds_mm: Option<[f64; 4]>,
    outside: u64,
    errors: usize,
    warnings: usize,
    notices: usize,
    diagnostics: Vec<Diagnostic>,
}

/// What only steps tell.
#[derive(Clone, Debug, Serialize)]
struct Measured {
    steps: u64,
    max_speed_mm_s: f64,
    max_accel_mm_s2: f64,
    max_accel_x_mm_s2: f64,
    max_accel_y_mm_s2: f64,
    max_accel_along_mm_s2: f64,
    max_accel_across_mm_s2: f64,
    accel_window_ms: usize,
    max_deviation_mm: f64,
    max_steps_from_drawing_mm: f64,
    max_drawing_from_steps_mm: f64,
}

impl Measured {
    fn of(figures: &SteppedFigures) -> Self {
        Self {
            steps: figures.step_events,
            max_speed_mm_s: figures.max_speed_mm_s,
            max_accel_mm_s2: figures.max_accel.vector_mm_s2,
            max_accel_x_mm_s2: figures.max_accel.axes_mm_s2[0],
            max_accel_y_mm_s2: figures.max_accel.axes_mm_s2[1],
            max_accel_along_mm_s2: figures.max_accel.along_mm_s2,
            max_accel_across_mm_s2: figures.max_accel.across_mm_s2,
            accel_window_ms: figures.accel_window_ms,
            max_deviation_mm: figures.max_steps_off_drawing_mm.max(figures.max_drawing_off_steps_mm),
            max_steps_from_drawing_mm: figures.max_steps_off_drawing_mm,
            max_drawing_from_steps_mm: figures.max_drawing_off_steps_mm,
        }
    }
}

/// What is known of a plot.
#[derive(Clone, Copy, Debug)]
pub enum PlotFigures<'a> {
    /// From its steps.
    Stepped(&'a SteppedFigures),
    /// From its plan.
    Estimated(&'a PlotTime),
}

#[derive(Clone, Debug, Serialize)]
struct Limits {
    speed_mm_s: f64,
    travel_speed_mm_s: f64,
    accel_mm_s2: f64,
    jerk_mm_s3: Option<f64>,
    /// What the jerk is limited of: `vector` or `path`.
    jerk_limit: Option<&'static str>,
    junction_deviation_mm: f64,
}

impl SteppedReport {
    /// The figures of a plot with these settings and these motors.
    #[must_use]
    pub fn new(
        drawing: &DrawingFile,
        machine: &Machine,
        settings: &PlannerSettings,
        motors: [MotorScale; 2],
        figures: PlotFigures<'_>,
        extent: &DrawnExtent,
        said: &Diagnostics,
    ) -> Self {
        let (tolerance_mm, allowance_mm) = match settings.path {
            PathMode::Tolerance { path_tolerance_mm } => (Some(path_tolerance_mm), None),
            _ => (None, Some(settings.allowance_mm)),
        };
        // Both have the same figures of time, path and pen.
        let (figures, measured) = match figures {
            PlotFigures::Stepped(figures) => (*figures, Some(Measured::of(figures))),
            PlotFigures::Estimated(time) => (SteppedFigures::from(time), None),
        };
        let Diagnostics { kept, errors, warnings, notices } = said.clone();
        Self {
            file: drawing.name().to_owned(),
            language: drawing.language(),
            machine: machine.config().name.as_str().to_owned(),
            mode: if tolerance_mm.is_some() { "tolerance" } else { "exact" },
            tolerance_mm,
            allowance_mm,
            s_curve: settings.jerk_mm_s3.is_some(),
            estimated: measured.is_none(),
            limits: Limits {
                speed_mm_s: settings.speed_mm_s,
                travel_speed_mm_s: settings.travel_speed_mm_s,
                accel_mm_s2: settings.accel_mm_s2,
                jerk_mm_s3: settings.jerk_mm_s3,
                jerk_limit: settings.jerk_mm_s3.map(|_| match settings.jerk_limit {
                    JerkLimit::Vector => "vector",
                    JerkLimit::Path => "path",
                }),
                junction_deviation_mm: settings.junction_deviation_mm,
            },
            steps_per_mm: motors.map(|motor| motor.steps_per_mm),
            time_s: figures.motion_s,
            time_with_pen_s: figures.total_s,
            dwell_s: figures.dwell_s,
            draw_mm: figures.draw_mm,
            travel_mm: figures.travel_mm,
            segments: extent.segments,
            courses: figures.courses,
            strokes: figures.strokes,
            pen_lifts: figures.pen_lifts,
            measured,
            bounds_mm: extent.min.zip(extent.max).map(|(min, max)| [min.x, min.y, max.x, max.y]),
            outside: extent.movements_outside,
            errors,
            warnings,
            notices,
            diagnostics: kept,
        }
    }

    /// The most important of it, for a person.
    #[must_use]
    pub fn table(&self) -> String {
        let mut out = format!("{} ({}), {}, {}", self.file, self.language.name(), self.machine, self.mode);
        if let Some(tolerance_mm) = self.tolerance_mm {
            let _ = write!(out, " {tolerance_mm} mm");
        }
        if let Some(allowance_mm) = self.allowance_mm.filter(|allowance_mm| *allowance_mm > 0.0) {
            let _ = write!(out, " give or take {} mm", (allowance_mm * 1e4).round() / 1e4);
        }
        if let (Some(jerk_mm_s3), Some(limit)) = (self.limits.jerk_mm_s3, self.limits.jerk_limit) {
            let of = if limit == "path" { "along the path" } else { "as a vector" };
            let _ = write!(out, ", a jerk of {jerk_mm_s3} mm/s³ {of}");
        }
        out.push_str(if self.estimated {
            ", estimated without steps
"
        } else {
            "
"
        });
        let mut rows = vec![
            ("time in motion", format!("{:.1}", self.time_s), "s"),
            ("with pen and pauses", format!("{:.1}", self.time_with_pen_s), "s"),
            ("pen down", format!("{:.1}", self.draw_mm), "mm"),
            ("pen up", format!("{:.1}", self.travel_mm), "mm"),
            ("strokes", self.strokes.to_string(), ""),
            ("lines and arcs", self.segments.to_string(), "read"),
            ("", self.courses.to_string(), "planned"),
        ];
        if let Some(measured) = &self.measured {
            rows.extend([
                ("steps", measured.steps.to_string(), ""),
                ("greatest speed", format!("{:.1}", measured.max_speed_mm_s), "mm/s"),
                ("acceleration", format!("{:.0}", measured.max_accel_mm_s2), "mm/s²"),
                ("along the path", format!("{:.0}", measured.max_accel_along_mm_s2), "mm/s²"),
                ("across, in curves", format!("{:.0}", measured.max_accel_across_mm_s2), "mm/s²"),
                ("from the drawing", format!("{:.4}", measured.max_deviation_mm), "mm"),
            ]);
        }
        for (name, value, unit) in rows {
            out.push_str(format!("  {name:20} {value:>12} {unit}").trim_end());
            out.push('\n');
        }
        out
    }
}
