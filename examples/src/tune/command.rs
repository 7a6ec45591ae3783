//! The command line of `tune`, and its course.

use crate::shared::{Telling, at, read_file, run, write_file};
use crate::tune::{TunedAxis, TuningMethod, TuningReport, TuningSettings, loop_charts_svg, tuned_lines};
use clap::{Parser, ValueEnum};
use plotter_motion::config::DcConfig;
use plotter_motion::{Axis, Machine, MachineConfig, config::MachineKind};
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

/// Finds gains for the DC motors of a machine, simulated from its file, and the margins that they leave.
///
/// The margins of every loop are those on the simulated motor with sampling, held duties and filtered
/// derivative. The published gains, as in the machine's file, are shown beside ours at the same sampling
/// rate.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 100,
    name = "tune",
    after_help = "Methods:\n  \
                  lambda  from the motor's data in the file: lambda tuning (internal model control) by Skogestad's rules\n  \
                  step    the motor is switched on and off; the same rules for the model that fits what it did\n  \
                  relay   a relay swings the motor; gains by Åström and Hägglund, and by Tyreus and Luyben\n\n\
                  Examples:\n  \
                  plotter tune --svg tune.svg\n  \
                  plotter tune --method step --motor-off 0.3\n  \
                  plotter tune --machine mine.toml --margin 1.4 --report tune.json\n\n\
                  Exit status: 0 tuned; 1 a machine without DC motors, or no method gave gains; 2 wrong options.\n\n\
                  In a checkout of the project, `cargo run --release --example tune --` stands for `plotter tune`."
)]
pub struct TuneCommand {
    /// The machine's TOML file [default: machines/semi-virtual-gantry.toml]
    #[arg(long, value_name = "FILE")]
    machine: Option<PathBuf>,
    /// How the gains are found
    #[arg(long, value_enum, default_value = "all")]
    method: TuningMethod,
    /// Motor to tune
    #[arg(long, value_enum, default_value = "both")]
    axis: Axes,
    /// Greatest sensitivity Ms, 1.1 to 3; 1.7 promises a gain margin of 2.43 and a phase margin of 34 degrees
    #[arg(long, value_name = "MS", default_value = "1.7", value_parser = sensitivity, allow_negative_numbers = true)]
    margin: f64,
    /// Phase margin for the relay's gains, degrees, 10 to 70
    #[arg(long, value_name = "DEG", default_value = "45", value_parser = phase_margin, allow_negative_numbers = true)]
    phase_margin: f64,
    /// Deviation of the simulated motors from their description, as a fraction: more inertia, friction
    /// and resistance, less voltage
    #[arg(long, value_name = "SHARE", default_value = "0", value_parser = share, allow_negative_numbers = true)]
    motor_off: f64,
    /// Sampling rate of the loop, Hz [default: the machine's]
    #[arg(long, value_name = "HZ", value_parser = loop_hz, allow_negative_numbers = true)]
    loop_hz: Option<f64>,
    /// Greatest travel of the experiments to either side, mm [default: a tenth of the axis]
    #[arg(long, value_name = "MM", value_parser = length_mm, allow_negative_numbers = true)]
    travel_mm: Option<f64>,
    /// Setpoint step of the loops' step responses, mm [default: 2, or 80 counts if that is more]
    #[arg(long, value_name = "MM", value_parser = length_mm, allow_negative_numbers = true)]
    step_mm: Option<f64>,
    /// Writes a picture of the loops: step responses, Bode and Nyquist plots
    #[arg(long, value_name = "F.svg")]
    svg: Option<PathBuf>,
    /// Writes all figures as JSON
    #[arg(long, value_name = "F.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    telling: Telling,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Axes {
    /// The x axis
    X,
    /// The y axis
    Y,
    /// Both, one after the other
    Both,
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

impl TuneCommand {
    /// Runs the command; its help has the table of exit codes.
    #[must_use]
    pub fn run(self) -> ExitCode {
        let arguments = self;
        run("tune", || tune(&arguments))
    }
}

fn tune(arguments: &TuneCommand) -> Result<(), String> {
    let machine = machine(arguments)?;
    let config = machine.config();
    let dc = DcConfig::of(&machine);
    let loop_hz = arguments.loop_hz.unwrap_or(dc.control.contouring.loop_hz);
    let settings = TuningSettings {
        method: arguments.method,
        max_sensitivity: arguments.margin,
        phase_margin_deg: arguments.phase_margin,
        motor_off: arguments.motor_off,
        loop_hz,
        travel_mm: arguments.travel_mm,
        step_mm: arguments.step_mm,
    };
    let axes: Vec<TunedAxis> =
        arguments.axis.list().iter().map(|axis| TunedAxis::new(&settings, config, *axis)).collect();

    let mut text = format!("{}, {loop_hz} runs a second", config.name.as_str());
    if arguments.motor_off != 0.0 {
        let _ = write!(text, ", motors {:+.0} % off their description", 100.0 * arguments.motor_off);
    }
    text.push('\n');
    for axis in &axes {
        axis.write(&mut text);
    }
    let lines = tuned_lines(&axes, loop_hz);
    let _ = writeln!(text, "\n{lines}");
    if let Some(path) = &arguments.svg {
        let charts: Vec<_> = axes.iter().map(|axis| axis.chart(&settings)).collect();
        write_file(path, loop_charts_svg(&charts))?;
    }
    let json = || {
        let report = TuningReport::new(&settings, config, &axes, &lines);
        serde_json::to_string_pretty(&report).map(|json| json + "\n").map_err(|error| error.to_string())
    };
    if let Some(path) = &arguments.report {
        write_file(path, json()?)?;
    }
    arguments.telling.tell(&format!("{}\n", text.trim_end()), json)?;
    let failures: Vec<_> = axes.iter().flat_map(TunedAxis::failures).collect();
    if !axes.iter().any(TunedAxis::is_tuned) {
        return Err(format!("no method gave gains: {}", failures.first().map_or("none was tried", |f| f)));
    }
    for failure in failures {
        eprintln!("warning: {failure}");
    }
    Ok(())
}

fn machine(arguments: &TuneCommand) -> Result<Machine, String> {
    let Some(path) = &arguments.machine else {
        return Machine::new(MachineConfig::default()).map_err(|error| error.to_string());
    };
    let text = String::from_utf8(read_file(path)?)
        .map_err(|error| at(path, &format!("this is not a text file: {error}")))?;
    let machine = Machine::from_toml(&text).map_err(|error| at(path, &error))?;
    // Steppers follow their steps without a loop, and the motors of a belt have none of their own.
    machine.require(MachineKind::Gantry, "tune").map_err(|error| at(path, &error))?;
    Ok(machine)
}
