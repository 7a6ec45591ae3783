//! A drawing, sent to a machine on a serial port, with its line recorded.

use crate::machine::PlotOutcome;
use core::time::Duration;
use plotter_motion::plant::{BenchEvent, BenchSettings};
use plotter_motion::protocol::{Host, HostEvent, HostNotice, LinkHost, LinkSettings, Wire};
use plotter_motion::{Machine, PenMove};
use plotter_replay::BenchRecorder;
use plotter_replay::serial::Port;
use std::io::Write;
use std::time::Instant;

/// Longest time for which the port is listened to at once.
const LISTEN: Duration = Duration::from_millis(5);

/// What is spoken with a machine on a port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PortLanguage {
    /// The reliable link if the machine knows it, else digits. The number is another one for each session,
    /// such as the low bits of a clock.
    Link(u16),
    /// Ten digits a target, as published; the machine is not asked for anything else.
    #[default]
    Digits,
}

type Moves = std::vec::IntoIter<PenMove>;

/// Hosts that send the drawing.
enum Sender {
    Digits(Box<Host<Moves>>),
    Link(Box<LinkHost<Moves, 8, 128>>),
}

impl Sender {
    fn new(language: PortLanguage, byte_gap: Duration, moves: Vec<PenMove>) -> Self {
        let (settings, moves) = (BenchSettings::default().host, moves.into_iter());
        match language {
            PortLanguage::Digits => Self::Digits(Box::new(Host::new(byte_gap, settings, moves))),
            PortLanguage::Link(nonce) => {
                let link = LinkSettings::default();
                Self::Link(Box::new(LinkHost::new(nonce, link, byte_gap, settings, moves)))
            }
        }
    }

    fn is_done(&self) -> bool {
        match self {
            Self::Digits(host) => host.is_done(),
            Self::Link(host) => host.is_done(),
        }
    }

    fn poll(&mut self, now: Duration) -> Option<HostEvent> {
        match self {
            Self::Digits(host) => host.poll(now),
            Self::Link(host) => host.poll(now),
        }
    }

    fn receive(&mut self, now: Duration, byte: u8) -> Option<HostEvent> {
        match self {
            Self::Digits(host) => host.receive(now, byte),
            Self::Link(host) => {
                host.receive(now, byte);
                host.poll(now)
            }
        }
    }

    fn next_byte(&mut self, now: Duration) -> Option<u8> {
        match self {
            Self::Digits(host) => host.next_byte(now),
            Self::Link(host) => host.next_byte(now),
        }
    }

    fn next_wake(&self) -> Option<Duration> {
        match self {
            Self::Digits(host) => host.next_wake(),
            Self::Link(host) => host.next_wake(),
        }
    }
}

/// Sends `moves` to the machine on `port`, in digits at the pace of its `serial.byte_gap_ms`; the recording's
/// times are this computer's.
///
/// # Errors
///
/// The port fails, or nobody answers on it.
pub fn plot_on_port<W: Write>(
    machine: &Machine,
    port: &str,
    language: PortLanguage,
    moves: Vec<PenMove>,
    recorder: &mut BenchRecorder<W>,
    mut progress: impl FnMut(u32),
) -> Result<PlotOutcome, String> {
    let serial = machine.config().serial;
    let mut port = Port::open(port, serial.baud).map_err(|error| error.to_string())?;
    let targets = u32::try_from(moves.len()).unwrap_or(u32::MAX);
    let mut outcome = PlotOutcome { targets, ..PlotOutcome::default() };
    let byte_gap = Duration::from_secs_f64(serial.byte_gap_ms / 1e3);
    let mut host = Sender::new(language, byte_gap, moves);
    let (mut wire, mut free) = (Wire::new(serial.baud), Duration::ZERO);
    let began = Instant::now();
    let mut answered = false;
    let mut bytes = [0; 256];
    while !host.is_done() {
        let now = began.elapsed();
        if let Some(event) = host.poll(now) {
            outcome.host(now, event, &mut progress);
            recorder.record(now, BenchEvent::Host(event));
            if let HostEvent::Notice(notice @ (HostNotice::MachineRestarted | HostNotice::NotUnderstood(_))) =
                event
            {
                return Err(format!("{}: {notice}", port.name()));
            }
            if let (HostEvent::Notice(HostNotice::GaveUp { .. }), false) = (event, answered) {
                return Err(format!(
                    "{}: the machine does not answer. Is it on, is it this port, and does it speak {} bits/s?",
                    port.name(),
                    serial.baud
                ));
            }
        }
        // No more than the line takes while the port is listened to.
        let mut sent = Vec::new();
        while free <= now + LISTEN
            && let Some(byte) = host.next_byte(now)
        {
            free = wire.send(now);
            sent.push(byte);
        }
        if !sent.is_empty() {
            port.send(&sent).map_err(|error| error.to_string())?;
            let now = began.elapsed();
            sent.iter().for_each(|&byte| recorder.record(now, BenchEvent::HostByte(byte)));
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
