//! [`TuningReport`]: all figures of a tuning; [`tuned_lines`]: what of them goes into a machine's file.

use crate::tune::tuning::{Loop, Stated, TunedAxis, TuningSettings, time_form};
use plotter_motion::control::tuning::{ContouringBandwidth, IntegratingProcess, LoopMargins};
use plotter_motion::{
    MachineConfig,
    control::{Pid, SumPid},
};
use serde::Serialize;
use std::fmt::Write as _;

/// All figures of a tuning, as JSON.
#[derive(Debug, Serialize)]
pub struct TuningReport {
    machine: String,
    loop_hz: f64,
    motor_off: f64,
    stated_max_sensitivity: f64,
    stated_phase_margin_deg: f64,
    axes: Vec<AxisReport>,
    toml: String,
}

#[derive(Debug, Serialize)]
struct AxisReport {
    axis: &'static str,
    described: ProcessReport,
    #[serde(rename = "true")]
    truth: ProcessReport,
    found: Option<ProcessReport>,
    experiment: Option<ExperimentReport>,
    relay: Option<RelayReport>,
    loops: Vec<LoopReport>,
    failures: Vec<String>,
    contouring_present: ContouringReport,
    contouring_suggested: Option<ContouringReport>,
}

#[derive(Debug, Serialize)]
struct ProcessReport {
    gain_counts_s: f64,
    time_constant_s: f64,
    second_time_constant_s: f64,
    dead_time_s: f64,
    dry_friction_duty: f64,
}

#[derive(Debug, Serialize)]
struct ExperimentReport {
    took_s: f64,
    used_mm: f64,
    breakaway_duty: f64,
    rms_counts: f64,
}

#[derive(Debug, Serialize)]
struct RelayReport {
    took_s: f64,
    used_mm: f64,
    ultimate_gain: f64,
    ultimate_period_s: f64,
    hysteresis_counts: i32,
    swing_counts: i32,
}

#[derive(Debug, Serialize)]
struct LoopReport {
    name: String,
    stated: Option<String>,
    kp: f32,
    ki: f32,
    kd: f32,
    derivative_filter_s: f32,
    #[serde(flatten)]
    margins: MarginsReport,
    overshoot_percent: f64,
    settled_s: Option<f64>,
}

/// A figure that is infinite is null.
#[derive(Debug, Serialize)]
struct MarginsReport {
    stable: bool,
    max_sensitivity: f64,
    gain_margin: f64,
    phase_margin_deg: f64,
    delay_margin_s: f64,
    crossover_hz: f64,
}

#[derive(Debug, Serialize)]
struct ContouringReport {
    bandwidth_hz: f64,
    observer_hz: f64,
    #[serde(flatten)]
    margins: MarginsReport,
}

impl TuningReport {
    /// Of all axes, with the lines for a machine's file.
    #[must_use]
    pub fn new(settings: &TuningSettings, config: &MachineConfig, axes: &[TunedAxis], lines: &str) -> Self {
        Self {
            machine: config.name.as_str().into(),
            loop_hz: settings.loop_hz,
            motor_off: settings.motor_off,
            stated_max_sensitivity: settings.max_sensitivity,
            stated_phase_margin_deg: settings.phase_margin_deg,
            axes: axes.iter().map(AxisReport::new).collect(),
            toml: lines.into(),
        }
    }
}

impl AxisReport {
    fn new(axis: &TunedAxis) -> Self {
        let mm = |counts: i32| f64::from(counts) / axis.described.counts_per_mm;
        let described_friction = IntegratingProcess::dry_friction_duty(&axis.described);
        let found = axis.found();
        Self {
            axis: axis.name(),
            described: ProcessReport::new(&axis.described_process, described_friction),
            truth: ProcessReport::new(&axis.process, axis.true_friction),
            found: found.map(|found| ProcessReport::new(&found.process, found.dry_friction_duty)),
            experiment: found.map(|found| ExperimentReport {
                took_s: found.took_s,
                used_mm: mm(found.used_counts),
                breakaway_duty: found.breakaway_duty,
                rms_counts: found.rms_counts,
            }),
            relay: axis.relay.and_then(Result::ok).map(|point| RelayReport {
                took_s: point.took_s,
                used_mm: mm(point.used_counts),
                ultimate_gain: point.ultimate_gain(),
                ultimate_period_s: point.ultimate_period_s(),
                hysteresis_counts: point.hysteresis_counts,
                swing_counts: point.swing_counts,
            }),
            loops: axis.loops.iter().map(|tried| LoopReport::new(tried, axis.tick_s)).collect(),
            failures: axis.failures(),
            contouring_present: ContouringReport::new(&axis.present),
            contouring_suggested: axis.contouring.ok().map(|found| ContouringReport::new(&found)),
        }
    }
}

impl ProcessReport {
    fn new(process: &IntegratingProcess, dry_friction_duty: f64) -> Self {
        let IntegratingProcess { gain_counts_s, time_constant_s, second_time_constant_s, dead_time_s } =
            *process;
        Self { gain_counts_s, time_constant_s, second_time_constant_s, dead_time_s, dry_friction_duty }
    }
}

impl LoopReport {
    fn new(tried: &Loop, tick_s: f64) -> Self {
        let Pid { kp, ki, kd, derivative_filter_s, .. } = time_form(tried.law, tick_s);
        let stated = tried.stated.map(|stated| match stated {
            Stated::Sensitivity(most) => format!("Ms at most {most}"),
            Stated::PhaseMarginDeg(margin) => format!("phase margin of {margin} degrees"),
        });
        Self {
            name: tried.name.clone(),
            stated,
            kp,
            ki,
            kd,
            derivative_filter_s,
            margins: MarginsReport::new(&tried.margins),
            overshoot_percent: tried.response.overshoot_percent,
            settled_s: tried.response.settled_s,
        }
    }
}

impl MarginsReport {
    fn new(margins: &LoopMargins) -> Self {
        let LoopMargins {
            stable,
            max_sensitivity,
            gain_margin,
            phase_margin_deg,
            delay_margin_s,
            crossover_hz,
            ..
        } = *margins;
        Self { stable, max_sensitivity, gain_margin, phase_margin_deg, delay_margin_s, crossover_hz }
    }
}

impl ContouringReport {
    fn new(found: &ContouringBandwidth) -> Self {
        Self {
            bandwidth_hz: found.bandwidth_hz,
            observer_hz: found.observer_hz,
            margins: MarginsReport::new(&found.margins),
        }
    }
}

/// Lines for a machine's file. The gains are comments: the published program is called at every edge, where a
/// sum and a difference by the call are something else.
#[must_use]
pub fn tuned_lines(axes: &[TunedAxis], loop_hz: f64) -> String {
    let mut text = String::new();
    let chosen: Vec<_> =
        axes.iter().filter_map(|axis| axis.chosen().map(|(tried, pid)| (axis, tried, pid))).collect();
    if let Some((_, tried, _)) = chosen.first() {
        let _ = writeln!(
            text,
            "# Gains of \"{}\" in the published form, steps of 255 a count, for a loop that is called {loop_hz} times a second.\n\
             # The controller \"published\" is called at every edge instead, and does not draw with them.\n\
             # [control.published]",
            tried.name
        );
        #[expect(clippy::cast_possible_truncation, reason = "f32 gains")]
        let tick_s = (1.0 / loop_hz) as f32;
        let sums: Vec<_> =
            chosen.iter().map(|(axis, _, pid)| (axis.name(), pid.sum_form(tick_s, 255.0))).collect();
        // One gain for both axes: the lesser.
        let least =
            |of: fn(&SumPid) -> f32| sums.iter().map(|(_, sum)| of(sum)).fold(f32::INFINITY, f32::min);
        let _ = writeln!(text, "# kp = {:.4}\n# ki = {:.6}", least(|s| s.kp), least(|s| s.ki));
        for (name, sum) in &sums {
            let _ = writeln!(text, "# kd_{name} = {:.4}", sum.kd);
        }
    }
    let stiffness = axes.iter().filter_map(|axis| axis.contouring.ok());
    let least =
        stiffness.reduce(|least, next| if next.bandwidth_hz < least.bandwidth_hz { next } else { least });
    if let Some(found) = least {
        let m = &found.margins;
        // Cut, not rounded: what stands in the file keeps the margin.
        let _ = writeln!(
            text,
            "\n# The stiffest loop across the line of Ms {:.2}: gain margin {:.2}, phase margin {:.1} degrees, delay margin {:.2} ms.\n\
             [control.contouring]\nloop_hz = {loop_hz:?}\nbandwidth_hz = {:.1}\nobserver_hz = {:.1}",
            m.max_sensitivity,
            m.gain_margin,
            m.phase_margin_deg,
            1e3 * m.delay_margin_s,
            (10.0 * found.bandwidth_hz).floor() / 10.0,
            (10.0 * found.observer_hz).floor() / 10.0
        );
    }
    text
}
