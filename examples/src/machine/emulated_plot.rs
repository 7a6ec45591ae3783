//! A drawing, sent to a gantry's firmware in the emulator, with everything that happens recorded.

use crate::machine::{BenchSwitches, Emulator, PlotOutcome, Told};
use core::time::Duration;
use plotter_motion::plant::{BenchEvent, BenchSettings};
use plotter_motion::protocol::{Host, HostEvent};
use plotter_motion::{Machine, PenMove};
use plotter_replay::BenchRecorder;
use plotter_replay::log::Event;
use plotter_replay::serial::Port;
use std::io::Write;
use std::path::Path;

/// What of a simulated plot is recorded beyond the line, the encoders and the pen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Recorded {
    /// The motors' duty, each time that it changes; it follows from the rest, and is half of the log.
    pub drive: bool,
}

/// Sends `moves` to the firmware in `elf`. The emulator's time is the host's: each goes on only as far as the
/// other has said all that it has to say until then, so the recording is the same each time, and that of the
/// simulated machine.
///
/// # Errors
///
/// The emulator or the port fails.
pub fn plot_in_emulator<W: Write>(
    machine: &Machine,
    elf: &Path,
    switches: BenchSwitches,
    moves: Vec<PenMove>,
    recorded: Recorded,
    recorder: &mut BenchRecorder<W>,
    mut progress: impl FnMut(u32),
) -> Result<PlotOutcome, String> {
    let settings = BenchSettings::default();
    let targets = u32::try_from(moves.len()).unwrap_or(u32::MAX);
    let mut outcome = PlotOutcome { targets, ..PlotOutcome::default() };
    let mut emulator = Emulator::start(elf, switches)?;
    let mut port = Port::open(emulator.port(), machine.config().serial.baud).map_err(|e| e.to_string())?;
    let byte_gap = Duration::from_secs_f64(machine.config().serial.byte_gap_ms / 1e3);
    let mut host = Host::new(byte_gap, settings.host, moves.into_iter());
    // The simulated machine is looked at in whole time steps, and so ends with one.
    let mut end = None;
    loop {
        let (now, told) = emulator.next_told()?;
        match told {
            Told::Ask => {
                if end.is_some_and(|end| now >= end) {
                    break;
                }
                let mut bytes = Vec::new();
                let wake = loop {
                    if let Some(event) = host.poll(now) {
                        outcome.host(now, event, &mut progress);
                        recorder.record(now, BenchEvent::Host(event));
                    }
                    bytes.extend(host.next_byte(now));
                    match host.next_wake() {
                        Some(wake) if wake <= now => {}
                        wake => break wake,
                    }
                };
                port.send(&bytes).map_err(|error| error.to_string())?;
                if host.is_done() && end.is_none() {
                    let step = settings.time_step.as_micros();
                    let steps = now.as_micros().div_ceil(step).max(1);
                    end = Some(Duration::from_micros(u64::try_from(steps * step).unwrap_or(u64::MAX)));
                }
                let ask_at = end.or(wake);
                if end.is_some_and(|end| now >= end) {
                    break;
                }
                emulator.go_on(bytes.len(), ask_at.map(|at| at - now))?;
            }
            Told::HostByte(byte) => recorder.record(now, BenchEvent::HostByte(byte)),
            Told::ControllerByte(byte) => {
                let mut came = [0];
                if port.receive(&mut came, Duration::from_secs(5)).map_err(|e| e.to_string())? == 0 {
                    return Err(format!("the machine sent {byte:#04x}, and it did not come over the line"));
                }
                if came != [byte] {
                    return Err(format!(
                        "the machine sent {byte:#04x}, and {:#04x} came over the line",
                        came[0]
                    ));
                }
                recorder.record(now, BenchEvent::ControllerByte(byte));
                if let Some(event) = host.receive(now, byte) {
                    outcome.host(now, event, &mut progress);
                    recorder.record(now, BenchEvent::Host(event));
                }
            }
            Told::Edge(axis, direction) => recorder.record(now, BenchEvent::Edge(axis, direction)),
            Told::Duty(axis, steps) => {
                if recorded.drive {
                    recorder.record(now, BenchEvent::Drive(axis, steps));
                }
            }
            Told::Stop(pressed) => recorder.write(now, Event::Estop(pressed)),
            Told::Note(text) => {
                outcome.notices.push(format!("{:.3} s: {text}", now.as_secs_f64()));
                recorder.write(now, Event::Note(text));
            }
            Told::Start { .. } | Told::Steps { .. } | Told::Position(..) => {}
        }
    }
    outcome.duration = end.unwrap_or_default();
    Ok(outcome)
}

impl PlotOutcome {
    /// Takes note of what happened at the host.
    pub(crate) fn host(&mut self, now: Duration, event: HostEvent, progress: &mut impl FnMut(u32)) {
        match event {
            HostEvent::Begun(_) => {}
            HostEvent::Reached(_) => {
                self.reached += 1;
                progress(self.reached);
            }
            HostEvent::Notice(notice) => self.note(now, "host", &notice),
        }
    }
}
