//! A drawing, sent to a machine on a serial port, with its line recorded.

use crate::PlotOutcome;
use core::time::Duration;
use plotter_motion::plant::{BenchEvent, BenchSettings};
use plotter_motion::protocol::{Host, HostEvent, HostNotice};
use plotter_motion::{Machine, PenMove};
use plotter_replay::BenchRecorder;
use plotter_replay::serial::Port;
use std::io::Write;
use std::time::Instant;

/// Longest time for which the port is listened to at once.
const LISTEN: Duration = Duration::from_millis(5);

/// Sends `moves` to the machine on `port` at the pace of its `serial.byte_gap_ms`; the recording's times are this
/// computer's.
///
/// # Errors
///
/// The port fails, or nobody answers on it.
pub fn plot_on_port<W: Write>(
    machine: &Machine,
    port: &str,
    moves: Vec<PenMove>,
    recorder: &mut BenchRecorder<W>,
    mut progress: impl FnMut(u32),
) -> Result<PlotOutcome, String> {
    let serial = machine.config().serial;
    let mut port = Port::open(port, serial.baud).map_err(|error| error.to_string())?;
    let targets = u32::try_from(moves.len()).unwrap_or(u32::MAX);
    let mut outcome = PlotOutcome { targets, ..PlotOutcome::default() };
    let byte_gap = Duration::from_secs_f64(serial.byte_gap_ms / 1e3);
    let mut host = Host::new(byte_gap, BenchSettings::default().host, moves.into_iter());
    let began = Instant::now();
    let mut answered = false;
    let mut bytes = [0; 256];
    while !host.is_done() {
        let now = began.elapsed();
        if let Some(event) = host.poll(now) {
            outcome.host(now, event, &mut progress);
            recorder.record(now, BenchEvent::Host(event));
            if let (HostEvent::Notice(HostNotice::GaveUp { .. }), false) = (event, answered) {
                return Err(format!(
                    "{}: the machine does not answer. Is it on, is it this port, and does it speak {} bits/s?",
                    port.name(),
                    serial.baud
                ));
            }
        }
        if let Some(byte) = host.next_byte(now) {
            port.send(&[byte]).map_err(|error| error.to_string())?;
            recorder.record(began.elapsed(), BenchEvent::HostByte(byte));
        }
        let wait = host.next_wake().map_or(LISTEN, |wake| wake.saturating_sub(began.elapsed()).min(LISTEN));
        let count = port.receive(&mut bytes, wait).map_err(|error| error.to_string())?;
        let now = began.elapsed();
        for &byte in bytes.get(..count).unwrap_or_default() {
            answered = true;
            recorder.record(now, BenchEvent::ControllerByte(byte));
            if let Some(event) = host.receive(now, byte) {
                outcome.host(now, event, &mut progress);
                recorder.record(now, BenchEvent::Host(event));
            }
        }
    }
    outcome.duration = began.elapsed();
    Ok(outcome)
}
