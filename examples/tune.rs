//! Finds the gains of a DC machine's motors, and says what margins they leave.
//!
//! The motors are simulated from the machine's file, if you like so many percent off it, as a real one would be; the experiments
//! do with them what they would do with yours: let them go a few millimetres to and fro, or let a relay swing them. From what the
//! encoder counted come a model, gains by a named rule, and the margins of the loop as it runs, beside those of the published
//! gains.
//!
//! Look at the column *phase margin*: the published x axis has less than half a degree, and swings. Then at the picture, where its
//! curve passes through -1.
//!
//! ```text
//! cargo run --release --example tune -- --svg tune.svg
//! cargo run --release --example tune -- --motor-off 0.3 --method step
//! cargo run --release --example tune -- --machine mine.toml --margin 1.4 --report tune.json
//! ```

use clap::{Parser, ValueEnum};
use plotter_examples::{
    Law, LoopChart, LoopCurve, SimulatedAxis, StepResponse, at, loop_charts_svg, print, read_file, run,
    write_file,
};
use plotter_motion::control::tuning::{
    ContouringBandwidth, ExperimentSettings, IdentifiedMotor, IntegratingProcess, LoopMargins, RelayPoint,
    SampledLoop, Simc, TuningError,
};
use plotter_motion::{Axis, AxisConfig, DriveChoice, Machine, MachineConfig, Pid, SumPid};
use serde::Serialize;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Finds gains for the DC motors of a machine, simulated from its file, and the margins that they leave.
///
/// Of every loop the margins are those on the motor as it is, sampled, its duties held, its derivative filtered. The published
/// gains stand beside ours as they are in the machine's file, called as often as our loop.
#[derive(Debug, Parser)]
#[command(
    name = "tune",
    after_help = "Methods:\n  \
                  lambda  from the motor's data in the file: lambda tuning (internal model control) by Skogestad's rules\n  \
                  step    the motor is switched on and off; the same rules for the model that fits what it did\n  \
                  relay   a relay swings the motor; gains by Åström and Hägglund, and by Tyreus and Luyben\n\n\
                  Examples:\n  \
                  tune --svg tune.svg\n  \
                  tune --method step --motor-off 0.3\n  \
                  tune --machine mine.toml --margin 1.4 --report tune.json\n\n\
                  Exit status: 0 tuned; 1 a machine without DC motors, or no method gave gains; 2 wrong options."
)]
struct Arguments {
    /// The machine's TOML file [default: machines/semi-virtual-gantry.toml]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// How the gains are found
    #[arg(long, value_enum, default_value = "all")]
    method: Method,
    /// Which motor
    #[arg(long, value_enum, default_value = "both")]
    axis: Axes,
    /// Greatest sensitivity Ms, 1.1 to 3; 1.7 promises a gain margin of 2.43 and a phase margin of 34 degrees
    #[arg(long, value_name = "MS", default_value = "1.7", value_parser = sensitivity, allow_negative_numbers = true)]
    margin: f64,
    /// Phase margin for the relay's gains, degrees, 10 to 70
    #[arg(long, value_name = "DEG", default_value = "45", value_parser = phase_margin, allow_negative_numbers = true)]
    phase_margin: f64,
    /// How far the simulated motors are from their description, as a share: heavier, rougher, of more resistance, on less
    /// voltage
    #[arg(long, value_name = "SHARE", default_value = "0", value_parser = share, allow_negative_numbers = true)]
    motor_off: f64,
    /// Runs of the loop a second [default: the machine's]
    #[arg(long, value_name = "HZ", value_parser = loop_hz, allow_negative_numbers = true)]
    loop_hz: Option<f64>,
    /// How far the experiments may go to either side, mm [default: a tenth of the axis]
    #[arg(long, value_name = "MM", value_parser = length_mm, allow_negative_numbers = true)]
    travel_mm: Option<f64>,
    /// Step of the setpoint that the loops are tried with, mm [default: 2, or 80 counts if that is more]
    #[arg(long, value_name = "MM", value_parser = length_mm, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    /// Writes the loops as a picture: steps, Bode's and Nyquist's
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// All of them
    All,
    /// From the motor's data
    Lambda,
    /// From step responses
    Step,
    /// From a relay's swing
    Relay,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Axes {
    /// The first
    X,
    /// The second
    Y,
    /// One after the other
    Both,
}

impl Method {
    fn includes(self, other: Self) -> bool {
        self == Self::All || self == other
    }
}

impl Axes {
    const fn list(self) -> &'static [Axis] {
        match self {
            Self::X => &[Axis::X],
            Self::Y => &[Axis::Y],
            Self::Both => &Axis::BOTH,
        }
    }
}

fn within(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| String::from("give a number"))?;
    if (least..=most).contains(&number) { Ok(number) } else { Err(format!("give {least} to {most}")) }
}

fn sensitivity(text: &str) -> Result<f64, String> {
    within(text, 1.1, 3.0)
}

fn phase_margin(text: &str) -> Result<f64, String> {
    within(text, 10.0, 70.0)
}

fn share(text: &str) -> Result<f64, String> {
    within(text, -0.5, 2.0)
}

fn loop_hz(text: &str) -> Result<f64, String> {
    within(text, 10.0, 100_000.0)
}

fn length_mm(text: &str) -> Result<f64, String> {
    within(text, 0.001, 100_000.0)
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    run("tune", || tune(&arguments))
}

fn tune(arguments: &Arguments) -> Result<(), String> {
    let machine = machine(arguments)?;
    let config = machine.config();
    let loop_hz = arguments.loop_hz.unwrap_or(config.control.contouring.loop_hz);
    let axes: Vec<TunedAxis> =
        arguments.axis.list().iter().map(|axis| TunedAxis::new(arguments, config, *axis, loop_hz)).collect();

    let mut text = format!("{}, {loop_hz} runs a second", config.name.as_str());
    if arguments.motor_off != 0.0 {
        let _ = write!(text, ", motors {:+.0} % off their description", 100.0 * arguments.motor_off);
    }
    text.push('\n');
    for axis in &axes {
        axis.write(&mut text);
    }
    let lines = toml_lines(&axes, loop_hz);
    let _ = writeln!(text, "\n{lines}");
    if let Some(path) = &arguments.svg {
        let charts: Vec<_> = axes.iter().map(|axis| axis.chart(arguments)).collect();
        write_file(path, loop_charts_svg(&charts))?;
    }
    if let Some(path) = &arguments.report {
        let report = Report::new(arguments, config, loop_hz, &axes, &lines);
        let json = serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?;
        write_file(path, json + "\n")?;
    }
    print(text.trim_end())?;
    print("\n")?;
    let failures: Vec<_> = axes.iter().flat_map(TunedAxis::failures).collect();
    if axes.iter().all(|axis| axis.own().next().is_none()) {
        return Err(format!("no method gave gains: {}", failures.first().map_or("none was tried", |f| f)));
    }
    for failure in failures {
        eprintln!("warning: {failure}");
    }
    Ok(())
}

fn machine(arguments: &Arguments) -> Result<Machine, String> {
    let Some(path) = &arguments.machine else {
        return Machine::new(MachineConfig::default()).map_err(|error| error.to_string());
    };
    let text = String::from_utf8(read_file(path)?)
        .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
    let machine = Machine::from_toml(&text).map_err(|error| at(path, &error))?;
    if machine.config().drive != DriveChoice::Dc {
        let text = "this machine has stepper motors, which follow their steps without a loop to tune: take one with drive = \
                    \"dc\", as machines/semi-virtual-gantry.toml";
        return Err(at(path, &text));
    }
    Ok(machine)
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
struct Loop {
    name: String,
    /// What was asked of them.
    stated: Option<Stated>,
    law: Law,
    margins: LoopMargins,
    response: StepResponse,
}

#[derive(Clone, Copy)]
enum Stated {
    Sensitivity(f64),
    PhaseMarginDeg(f64),
}

/// All of one axis.
struct TunedAxis {
    axis: Axis,
    described: AxisConfig,
    tick_s: f64,
    step_mm: f64,
    described_process: IntegratingProcess,
    process: IntegratingProcess,
    true_friction: f64,
    identified: Option<Result<IdentifiedMotor, TuningError>>,
    relay: Option<Result<RelayPoint, TuningError>>,
    /// Rules that gave none: whose, and why.
    refused: Vec<(String, TuningError)>,
    loops: Vec<Loop>,
    contouring: Result<ContouringBandwidth, TuningError>,
    /// Of the contouring controller as the file has it.
    present: ContouringBandwidth,
}

impl TunedAxis {
    fn new(arguments: &Arguments, config: &MachineConfig, axis: Axis, loop_hz: f64) -> Self {
        let (described, length_mm) = match axis {
            Axis::X => (config.x, config.area.width_mm),
            Axis::Y => (config.y, config.area.height_mm),
        };
        let truth = true_axis(&described, arguments.motor_off);
        let tick_s = 1.0 / loop_hz;
        let travel_mm = arguments.travel_mm.unwrap_or(0.1 * length_mm);
        let bounds = ExperimentSettings::of(&described, axis, loop_hz, travel_mm);
        let plant = SimulatedAxis::new(&truth, axis, tick_s);
        let method = arguments.method;
        let identified = method.includes(Method::Step).then(|| plant.step_experiment(bounds));
        let relay = method.includes(Method::Relay).then(|| plant.relay_experiment(bounds));

        let described_process = IntegratingProcess::of(&described);
        let process = IntegratingProcess::of(&truth);
        let step_mm = arguments.step_mm.unwrap_or((80.0 / described.counts_per_mm).max(2.0));
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
                config.control.contouring.bandwidth_hz,
                config.control.contouring.observer_hz,
            ),
        };
        tuned.try_all(arguments, config, plant);
        tuned
    }

    fn try_all(&mut self, arguments: &Arguments, config: &MachineConfig, plant: SimulatedAxis) {
        let published = &config.control.published;
        let (kd, limit) = match self.axis {
            Axis::X => (published.kd_x, published.duty_limit_x),
            Axis::Y => (published.kd_y, published.duty_limit_y),
        };
        let gains = SumPid { kp: published.kp, ki: published.ki, kd };
        self.add("published", None, Ok(Law::Published(gains, limit)), plant);

        let rule = Simc { max_sensitivity: arguments.margin, ..Simc::default() };
        let stated = Some(Stated::Sensitivity(arguments.margin));
        let tick_s = self.tick_s;
        let simc = |process: &IntegratingProcess| rule.tune(process, tick_s).map(|tuned| Law::Pid(tuned.pid));
        if arguments.method.includes(Method::Lambda) {
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
            let law = point.and_then(|point| point.astrom_hagglund(arguments.phase_margin)).map(Law::Pid);
            self.add(
                "relay, Åström-Hägglund",
                Some(Stated::PhaseMarginDeg(arguments.phase_margin)),
                law,
                plant,
            );
            if let Ok(point) = point {
                self.add("relay, Tyreus-Luyben", None, Ok(Law::Pid(point.tyreus_luyben())), plant);
            }
        }
        let process = self.found().map_or(self.described_process, |found| found.process);
        self.contouring = ContouringBandwidth::tune(&self.described, &process, tick_s, arguments.margin);
    }

    fn found(&self) -> Option<IdentifiedMotor> {
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
                    margins: LoopMargins::of(&cut),
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

    fn name(&self) -> &'static str {
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

    /// The gains to take: of what was measured before what was described.
    fn chosen(&self) -> Option<(&Loop, Pid)> {
        self.own().find(|(tried, _)| tried.name == "step").or_else(|| self.own().next())
    }

    fn failures(&self) -> Vec<String> {
        let rules = self.refused.iter().map(|(name, error)| format!("axis {}, {name}: {error}", self.name()));
        let contouring =
            self.contouring.err().map(|error| format!("axis {}, contouring: {error}", self.name()));
        rules.chain(contouring).collect()
    }

    fn write(&self, text: &mut String) {
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

    fn chart(&self, arguments: &Arguments) -> LoopChart {
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
            max_sensitivity: arguments.margin,
            curves: curves.collect(),
        }
    }
}

/// Gains in units of time and of the whole duty, of either form.
fn time_form(law: Law, tick_s: f64) -> Pid {
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

/// Lines for a machine's file. The gains are comments: the published program is called at every edge, where a sum and a difference
/// by the call are something else.
fn toml_lines(axes: &[TunedAxis], loop_hz: f64) -> String {
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

/// All figures.
#[derive(Serialize)]
struct Report {
    machine: String,
    loop_hz: f64,
    motor_off: f64,
    stated_max_sensitivity: f64,
    stated_phase_margin_deg: f64,
    axes: Vec<AxisReport>,
    toml: String,
}

#[derive(Serialize)]
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

#[derive(Serialize)]
struct ProcessReport {
    gain_counts_s: f64,
    time_constant_s: f64,
    second_time_constant_s: f64,
    dead_time_s: f64,
    dry_friction_duty: f64,
}

#[derive(Serialize)]
struct ExperimentReport {
    took_s: f64,
    used_mm: f64,
    breakaway_duty: f64,
    rms_counts: f64,
}

#[derive(Serialize)]
struct RelayReport {
    took_s: f64,
    used_mm: f64,
    ultimate_gain: f64,
    ultimate_period_s: f64,
    hysteresis_counts: i32,
    swing_counts: i32,
}

#[derive(Serialize)]
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
#[derive(Serialize)]
struct MarginsReport {
    stable: bool,
    max_sensitivity: f64,
    gain_margin: f64,
    phase_margin_deg: f64,
    delay_margin_s: f64,
    crossover_hz: f64,
}

#[derive(Serialize)]
struct ContouringReport {
    bandwidth_hz: f64,
    observer_hz: f64,
    #[serde(flatten)]
    margins: MarginsReport,
}

impl Report {
    fn new(
        arguments: &Arguments,
        config: &MachineConfig,
        loop_hz: f64,
        axes: &[TunedAxis],
        lines: &str,
    ) -> Self {
        Self {
            machine: config.name.as_str().into(),
            loop_hz,
            motor_off: arguments.motor_off,
            stated_max_sensitivity: arguments.margin,
            stated_phase_margin_deg: arguments.phase_margin,
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
