//! [`TunedAxis`]: gains for one axis by every method, and what they do on the motor as it is.

use crate::tune::{Law, LoopChart, LoopCurve, SimulatedAxis, StepResponse};
use clap::ValueEnum;
use plotter_motion::control::tuning::{
    ContouringBandwidth, ExperimentSettings, IdentifiedMotor, IntegratingProcess, LoopMargins, RelayPoint,
    SampledLoop, Simc, TuningError,
};
use plotter_motion::{
    Axis, MachineConfig,
    config::{AxisConfig, DcConfig},
    control::{Pid, SumPid},
};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// What is tried, and on what motor.
#[derive(Clone, Copy, Debug)]
pub struct TuningSettings {
    /// How the gains are found.
    pub method: TuningMethod,
    /// Greatest sensitivity Ms.
    pub max_sensitivity: f64,
    /// Phase margin for the relay's gains, degrees.
    pub phase_margin_deg: f64,
    /// How far the simulated motors are from their description, as a share.
    pub motor_off: f64,
    /// Runs of the loop a second.
    pub loop_hz: f64,
    /// How far the experiments may go to either side, mm; a tenth of the axis if not given.
    pub travel_mm: Option<f64>,
    /// Step of the setpoint that the loops are tried with, mm; 2, or 80 counts if that is more, if not given.
    pub step_mm: Option<f64>,
}

/// How gains are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TuningMethod {
    /// All of them
    All,
    /// From the motor's data
    Lambda,
    /// From step responses
    Step,
    /// From a relay's swing
    Relay,
}

impl TuningMethod {
    fn includes(self, other: Self) -> bool {
        self == Self::All || self == other
    }
}

/// The axis as it is: `share` off its description.
fn true_axis(described: &AxisConfig, share: f64) -> AxisConfig {
    let mut axis = *described;
    axis.motor.inertia_kg_m2 *= 1.0 + share;
    axis.load.inertia_kg_m2 *= 1.0 + share;
    axis.motor.resistance_ohm *= 1.0 + 0.5 * share;
    axis.motor.supply_v *= 1.0 - 0.3 * share;
    axis.load.coulomb_n_m *= (1.0 + 2.0 * share).max(0.0);
    axis.load.static_n_m *= (1.0 + 2.0 * share).max(0.0);
    axis
}

/// Gains of one method, and what they do on the motor as it is.
#[derive(Clone, Debug)]
pub(crate) struct Loop {
    pub(crate) name: String,
    /// What was asked of them.
    pub(crate) stated: Option<Stated>,
    pub(crate) law: Law,
    pub(crate) margins: LoopMargins,
    pub(crate) response: StepResponse,
}

/// What was asked of gains.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stated {
    Sensitivity(f64),
    PhaseMarginDeg(f64),
}

/// All of one axis.
#[derive(Clone, Debug)]
pub struct TunedAxis {
    pub(crate) axis: Axis,
    pub(crate) described: AxisConfig,
    pub(crate) tick_s: f64,
    pub(crate) step_mm: f64,
    pub(crate) described_process: IntegratingProcess,
    pub(crate) process: IntegratingProcess,
    pub(crate) true_friction: f64,
    pub(crate) identified: Option<Result<IdentifiedMotor, TuningError>>,
    pub(crate) relay: Option<Result<RelayPoint, TuningError>>,
    /// Rules that gave none: whose, and why.
    pub(crate) refused: Vec<(String, TuningError)>,
    pub(crate) loops: Vec<Loop>,
    pub(crate) contouring: Result<ContouringBandwidth, TuningError>,
    /// Of the contouring controller as the file has it.
    pub(crate) present: ContouringBandwidth,
}

impl TunedAxis {
    /// Tries all that is asked for on a motor of the machine.
    #[must_use]
    pub fn new(settings: &TuningSettings, config: &MachineConfig, axis: Axis) -> Self {
        let dc = config.dc().copied().unwrap_or_default();
        let (described, length_mm) = match axis {
            Axis::X => (dc.x, config.area.width_mm),
            Axis::Y => (dc.y, config.area.height_mm),
        };
        let truth = true_axis(&described, settings.motor_off);
        let tick_s = 1.0 / settings.loop_hz;
        let travel_mm = settings.travel_mm.unwrap_or(0.1 * length_mm);
        let bounds = ExperimentSettings::of(&described, axis, settings.loop_hz, travel_mm);
        let plant = SimulatedAxis::new(&truth, axis, tick_s);
        let method = settings.method;
        let identified = method.includes(TuningMethod::Step).then(|| plant.step_experiment(bounds));
        let relay = method.includes(TuningMethod::Relay).then(|| plant.relay_experiment(bounds));

        let described_process = IntegratingProcess::of(&described);
        let process = IntegratingProcess::of(&truth);
        let step_mm = settings.step_mm.unwrap_or((80.0 / described.counts_per_mm).max(2.0));
        let mut tuned = Self {
            axis,
            described,
            tick_s,
            step_mm,
            described_process,
            process,
            true_friction: IntegratingProcess::dry_friction_duty(&truth),
            identified,
            relay,
            refused: Vec::new(),
            loops: Vec::new(),
            contouring: Err(TuningError::NotAMotor),
            present: ContouringBandwidth::evaluate(
                &described,
                &process,
                tick_s,
                dc.control.contouring.bandwidth_hz,
                dc.control.contouring.observer_hz,
            ),
        };
        tuned.try_all(settings, &dc, plant);
        tuned
    }

    fn try_all(&mut self, settings: &TuningSettings, dc: &DcConfig, plant: SimulatedAxis) {
        let published = &dc.control.published;
        let (kd, limit) = match self.axis {
            Axis::X => (published.kd_x, published.duty_limit_x),
            Axis::Y => (published.kd_y, published.duty_limit_y),
        };
        let gains = SumPid { kp: published.kp, ki: published.ki, kd };
        self.add("published", None, Ok(Law::Published(gains, limit)), plant);

        let rule = Simc { max_sensitivity: settings.max_sensitivity, ..Simc::default() };
        let stated = Some(Stated::Sensitivity(settings.max_sensitivity));
        let tick_s = self.tick_s;
        let simc = |process: &IntegratingProcess| rule.tune(process, tick_s).map(|tuned| Law::Pid(tuned.pid));
        if settings.method.includes(TuningMethod::Lambda) {
            self.add("lambda", stated, simc(&self.described_process), plant);
        }
        if let Some(identified) = self.identified {
            self.add("step", stated, identified.and_then(|found| simc(&found.process)), plant);
        }
        if let Some(relay) = self.relay {
            // What friction does to the swing: as it was found, or as it is described.
            let friction = self.found().map_or_else(
                || IntegratingProcess::dry_friction_duty(&self.described),
                |found| found.dry_friction_duty,
            );
            let point = relay.map(|point| point.without_friction(friction));
            let law = point.and_then(|point| point.astrom_hagglund(settings.phase_margin_deg)).map(Law::Pid);
            self.add(
                "relay, Åström-Hägglund",
                Some(Stated::PhaseMarginDeg(settings.phase_margin_deg)),
                law,
                plant,
            );
            if let Ok(point) = point {
                self.add("relay, Tyreus-Luyben", None, Ok(Law::Pid(point.tyreus_luyben())), plant);
            }
        }
        let process = self.found().map_or(self.described_process, |found| found.process);
        self.contouring =
            ContouringBandwidth::tune(&self.described, &process, tick_s, settings.max_sensitivity);
    }

    pub(crate) fn found(&self) -> Option<IdentifiedMotor> {
        self.identified.and_then(Result::ok)
    }

    fn add(
        &mut self,
        name: &str,
        stated: Option<Stated>,
        law: Result<Law, TuningError>,
        plant: SimulatedAxis,
    ) {
        /// As long as a slow loop needs, and a motor that creeps shows it.
        const WATCHED_S: f64 = 2.0;
        match law {
            Ok(law) => {
                let compensator = law.compensator();
                let cut = SampledLoop { process: self.process, compensator, tick_s: self.tick_s };
                let response = plant.step_response(law, self.step_counts(), self.tick_s, WATCHED_S);
                self.loops.push(Loop {
                    name: name.into(),
                    stated,
                    law,
                    margins: LoopMargins::from_loop(&cut),
                    response,
                });
            }
            Err(error) => self.refused.push((name.into(), error)),
        }
    }

    fn step_counts(&self) -> i32 {
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let counts = (self.step_mm * self.described.counts_per_mm).round() as i32;
        counts.max(1)
    }

    pub(crate) fn name(&self) -> &'static str {
        match self.axis {
            Axis::X => "x",
            Axis::Y => "y",
        }
    }

    /// The loops that are not as published.
    fn own(&self) -> impl Iterator<Item = (&Loop, Pid)> {
        self.loops.iter().filter_map(|tried| match tried.law {
            Law::Pid(pid) => Some((tried, pid)),
            Law::Published(..) => None,
        })
    }

    /// Whether a method gave gains.
    #[must_use]
    pub fn is_tuned(&self) -> bool {
        self.own().next().is_some()
    }

    /// The gains to take: of what was measured before what was described.
    pub(crate) fn chosen(&self) -> Option<(&Loop, Pid)> {
        self.own().find(|(tried, _)| tried.name == "step").or_else(|| self.own().next())
    }

    /// What gave no gains, and why.
    #[must_use]
    pub fn failures(&self) -> Vec<String> {
        let rules = self.refused.iter().map(|(name, error)| format!("axis {}, {name}: {error}", self.name()));
        let contouring =
            self.contouring.err().map(|error| format!("axis {}, contouring: {error}", self.name()));
        rules.chain(contouring).collect()
    }

    /// What was found, for people.
    pub fn write(&self, text: &mut String) {
        let _ = writeln!(text, "\naxis {}", self.name());
        let found = self.found();
        let _ = writeln!(text, "  {:<28} {:>10} {:>10} {:>10}", "motor", "described", "true", "found");
        let mut row = |name: &str, described: f64, truth: f64, found: Option<f64>, digits: usize| {
            let found = found.map_or_else(|| String::from("-"), |v| format!("{v:.digits$}"));
            let _ = writeln!(text, "  {name:<28} {described:>10.digits$} {truth:>10.digits$} {found:>10}");
        };
        let (d, t) = (self.described_process, self.process);
        let of = |value: fn(&IdentifiedMotor) -> f64| found.as_ref().map(value);
        row("gain K, counts/s", d.gain_counts_s, t.gain_counts_s, of(|f| f.process.gain_counts_s), 0);
        let ms = 1e3;
        row(
            "time constant T, ms",
            ms * d.time_constant_s,
            ms * t.time_constant_s,
            of(|f| 1e3 * f.process.time_constant_s),
            2,
        );
        // What the current takes acts as a dead time.
        row(
            "dead time, ms",
            ms * d.second_time_constant_s,
            ms * t.second_time_constant_s,
            of(|f| 1e3 * f.process.dead_time_s),
            2,
        );
        let described_friction = 100.0 * IntegratingProcess::dry_friction_duty(&self.described);
        row(
            "dry friction, % duty",
            described_friction,
            100.0 * self.true_friction,
            of(|f| 100.0 * f.dry_friction_duty),
            2,
        );
        let mm = |counts: i32| f64::from(counts) / self.described.counts_per_mm;
        if let Some(found) = found {
            let _ = writeln!(
                text,
                "  steps: {:.1} s, within {:.1} mm of the start; breaks loose at {:.1} %; {:.2} counts from the fitted curves",
                found.took_s,
                mm(found.used_counts),
                100.0 * found.breakaway_duty,
                found.rms_counts
            );
        }
        if let Some(Ok(point)) = self.relay {
            let _ = writeln!(
                text,
                "  relay: {:.1} s, within {:.2} mm of the start; swings {} counts in {:.2} ms, Ku = {:.4} duty/count",
                point.took_s,
                mm(point.used_counts),
                point.swing_counts,
                1e3 * point.ultimate_period_s(),
                point.ultimate_gain()
            );
        }
        self.write_loops(text);
    }

    fn write_loops(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\n  {:<24} {:>8} {:>8} {:>9} {:>7} | {:>7} {:>6} {:>6} {:>7} {:>7} {:>7} | {:>6} {:>7}",
            "gains",
            "kp",
            "ki",
            "kd",
            "filter",
            "asked",
            "Ms",
            "gain",
            "phase",
            "delay",
            "cross",
            "over",
            "settled"
        );
        let _ = writeln!(
            text,
            "  {:<24} {:>8} {:>8} {:>9} {:>7} | {:>7} {:>6} {:>6} {:>7} {:>7} {:>7} | {:>6} {:>7}",
            "", "/count", "/count/s", "s/count", "ms", "", "", "margin", "deg", "ms", "Hz", "%", "ms"
        );
        for tried in &self.loops {
            let pid = time_form(tried.law, self.tick_s);
            let m = &tried.margins;
            let asked = match tried.stated {
                Some(Stated::Sensitivity(most)) => format!("Ms {most}"),
                Some(Stated::PhaseMarginDeg(margin)) => format!("{margin}°"),
                None => String::from("-"),
            };
            let settled = tried.response.settled_s.map_or("never".into(), |s| format!("{:.0}", 1e3 * s));
            let _ = writeln!(
                text,
                "  {:<24} {:>8.5} {:>8.4} {:>9.7} {:>7.3} | {asked:>7} {:>6} {:>6} {:>7} {:>7.2} {:>7.1} | {:>6.0} {settled:>7}",
                tried.name,
                pid.kp,
                pid.ki,
                pid.kd,
                1e3 * pid.derivative_filter_s,
                if m.max_sensitivity < 999.0 { format!("{:.2}", m.max_sensitivity) } else { "-".into() },
                format!("{:.2}", m.gain_margin),
                format!("{:.1}", m.phase_margin_deg),
                1e3 * m.delay_margin_s,
                m.crossover_hz,
                tried.response.overshoot_percent
            );
        }
        for (name, error) in &self.refused {
            let _ = writeln!(text, "  {name:<24} none: {error}");
        }
        let p = &self.present;
        let _ = writeln!(
            text,
            "  contouring as in the file, {} and {} Hz: Ms {:.2}, gain margin {:.2}, phase margin {:.1}°, delay margin {:.2} ms",
            p.bandwidth_hz,
            p.observer_hz,
            p.margins.max_sensitivity,
            p.margins.gain_margin,
            p.margins.phase_margin_deg,
            1e3 * p.margins.delay_margin_s
        );
    }

    /// Picture of the control loops.
    #[must_use]
    pub fn chart(&self, settings: &TuningSettings) -> LoopChart {
        let slowest_s =
            self.own().filter_map(|(tried, _)| tried.response.settled_s).fold(20.0 * self.tick_s, f64::max);
        let shown_s = (2.0 * slowest_s).min(2.0);
        let curves = self.loops.iter().map(|tried| {
            let cut = SampledLoop {
                process: self.process,
                compensator: tried.law.compensator(),
                tick_s: self.tick_s,
            };
            let step = tried.response.places.iter().take_while(|(time_s, _)| *time_s <= shown_s);
            LoopCurve {
                name: tried.name.clone(),
                step: step
                    .map(|(time_s, count)| (1e3 * time_s, f64::from(*count) / self.described.counts_per_mm))
                    .collect(),
                response: cut.sweep().map(|rad_s| (rad_s / TAU, cut.response(rad_s))).collect(),
            }
        });
        LoopChart {
            title: format!("axis {}: published and tuned loops at {:.0} Hz", self.name(), 1.0 / self.tick_s),
            step_mm: f64::from(self.step_counts()) / self.described.counts_per_mm,
            max_sensitivity: settings.max_sensitivity,
            curves: curves.collect(),
        }
    }
}

/// Gains in units of time and of the whole duty, of either form.
pub(crate) fn time_form(law: Law, tick_s: f64) -> Pid {
    match law {
        Law::Pid(pid) => pid,
        Law::Published(SumPid { kp, ki, kd }, limit) => {
            #[expect(clippy::cast_possible_truncation, reason = "f32 gains")]
            let tick_s = tick_s as f32;
            Pid {
                kp: kp / 255.0,
                ki: ki / 255.0 / tick_s,
                kd: kd / 255.0 * tick_s,
                derivative_filter_s: 0.0,
                output_min: -limit / 255.0,
                output_max: limit / 255.0,
            }
        }
    }
}
