//! Faults, and how the firmwares handle them.
//!
//! The gantry's firmware runs in the emulator and is sent a line of 40 mm. Its watchdog bites half way, its
//! emergency stop is pressed when it is switched on, or its receiver loses a byte. After each, look at what
//! the motors get, and at what a person is told. Build the firmware first: see examples/firmware/README.md.

use clap::Parser;
use core::time::Duration;
use plotter_examples::machine::{
    BenchSwitches, Recorded, StreamedSteps, built_firmware, plot_in_emulator, streamed_in_emulator,
};
use plotter_examples::shared::{print, run};
use plotter_motion::{Machine, MachineConfig, Pen, PenMove, StepPoint};
use plotter_replay::BenchRecorder;
use plotter_replay::log::{Event, Header, Reader, Record, Writer};
use std::fmt::Write as _;
use std::process::ExitCode;

/// Breaks things, and looks at what the firmwares in the emulator do.
#[derive(Parser)]
#[command(name = "bad_day", after_help = "Example:\n  cargo run --release --example bad_day")]
struct Args {}

fn main() -> ExitCode {
    let Args {} = Args::parse();
    run("bad_day", bad_day)
}

/// A line of 40 mm, and what happened on it.
struct Line {
    reached: u32,
    notices: Vec<String>,
    records: Vec<Record>,
}

impl Line {
    fn draw(switches: BenchSwitches) -> Result<Self, String> {
        let machine = Machine::new(MachineConfig::default()).map_err(|error| error.to_string())?;
        let writer = Writer::new(Vec::new(), &Header::new()).map_err(|error| error.to_string())?;
        let mut recorder = BenchRecorder::new(writer);
        let there = PenMove { pen: Pen::Down, target: StepPoint::new(1600, 800) };
        let elf = built_firmware("gantry");
        let recorded = Recorded { drive: true };
        let outcome =
            plot_in_emulator(&machine, &elf, switches, vec![there], recorded, &mut recorder, |_| {})?;
        let log = recorder.finish().map_err(|error| error.to_string())?;
        let reader = Reader::new(&log[..]).map_err(|error| error.to_string())?;
        let records = reader.collect::<Result<_, _>>().map_err(|damage| damage.to_string())?;
        Ok(Self { reached: outcome.reached, notices: outcome.notices, records })
    }

    /// The greatest duty that a motor got from `from` on, steps.
    fn most_duty_from(&self, from: Duration) -> u32 {
        let duties = self.records.iter().filter(|record| record.time >= from);
        duties
            .map(|record| if let Event::Drive { duty, .. } = record.event { duty.unsigned_abs() } else { 0 })
            .max()
            .unwrap_or(0)
    }

    fn noticed(&self, words: &str) -> bool {
        self.notices.iter().any(|notice| notice.contains(words))
    }
}

fn bad_day() -> Result<(), String> {
    let mut text = String::new();
    let mut expect = |what: &str, holds: bool| {
        let _ = writeln!(text, "{:4} {what}", if holds { "yes" } else { "NO" });
        holds
    };
    let mut good = true;

    let line = Line::draw(BenchSwitches::default())?;
    good &= expect("an undisturbed line is drawn", line.reached == 1 && line.notices.is_empty());

    // The target is complete after 91 ms, and the line takes some 350 ms. Between two of the controller's
    // ticks, so that what is recorded from then on comes after the bite.
    const BITE_US: u32 = 250_150;
    let bite = Duration::from_micros(BITE_US.into());
    let line = Line::draw(BenchSwitches { bite_at_us: BITE_US, ..BenchSwitches::default() })?;
    let before = line.records.iter().filter(|record| record.time < bite);
    let moving = before.filter(|record| matches!(record.event, Event::Drive { .. })).count();
    good &= expect("watchdog, in the middle of a line: the motors were driven until then", moving > 2);
    good &= expect("watchdog: from then on both motors are off", line.most_duty_from(bite) == 0);
    good &= expect("watchdog: it is told", line.noticed("reset by its watchdog"));
    good &= expect(
        "watchdog: the host learns that the target is not reached",
        line.reached == 0 && line.noticed("host"),
    );

    let line = Line::draw(BenchSwitches { stop_pressed: true, ..BenchSwitches::default() })?;
    good &=
        expect("stop pressed at power-up: no motor is ever driven", line.most_duty_from(Duration::ZERO) == 0);
    good &= expect("stop pressed at power-up: nothing is reached", line.reached == 0);

    let line = Line::draw(BenchSwitches { overrun_at_byte: 4, ..BenchSwitches::default() })?;
    good &= expect("overrun of the receiver: it is told", line.noticed("a byte of the host was lost"));
    good &=
        expect("overrun: the target is sent again and reached", line.reached == 1 && line.noticed("silent"));

    let machine = Machine::new(MachineConfig::stepper_plotter()).map_err(|error| error.to_string())?;
    let elf = built_firmware("stepper_plotter");
    let square = "G21 G90\nM3S90\nG1X10F1800\nY10\nX0\nY0\nM5\n";
    let stream = |switches| -> Result<StreamedSteps, String> {
        streamed_in_emulator(&machine, &elf, switches, square)
    };
    let made = stream(BenchSwitches::default())?;
    good &= expect(
        "stepper plotter: an undisturbed square is drawn",
        made.steps == 4 * 876 && made.refused.is_empty(),
    );
    let made = stream(BenchSwitches { stop_pressed: true, ..BenchSwitches::default() })?;
    good &= expect(
        "stepper plotter, stop pressed at power-up: no step, and an alarm",
        made.steps == 0 && !made.refused.is_empty(),
    );
    let made = stream(BenchSwitches { overrun_at_byte: 20, ..BenchSwitches::default() })?;
    good &= expect(
        "stepper plotter, overrun: its line is refused and told",
        made.refused.len() == 1 && !made.notes.is_empty(),
    );

    print(&text)?;
    if good { Ok(()) } else { Err(String::from("a firmware did not do what it should")) }
}
