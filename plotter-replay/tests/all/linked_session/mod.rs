//! A host that speaks frames, a line with faults, and a simulated machine, in one time.

#![allow(dead_code, clippy::unwrap_used, reason = "each test uses its part of this, and may panic")]

use plotter_motion::firmware::{Gantry, LinkedGantry};
use plotter_motion::plant::{Bench, BenchEvent, BenchSettings, SimulatedLine};
use plotter_motion::protocol::{HostSettings, LinkHost, LinkSettings, Order};
use plotter_motion::{LimitSwitches, Machine, PenMove, SafetyGate};
use plotter_replay::log::Event;
use plotter_replay::transport::{FaultInjector, Faults};
use std::collections::VecDeque;
use std::time::Duration;

/// The machine's number since it was switched on.
pub(crate) const BOOT: u32 = 4_711;

type Host = LinkHost<std::vec::IntoIter<PenMove>, 8, 128>;

/// What is recorded is what comes to the machine, and what it says, before the line has changed it.
pub(crate) struct LinkedSession {
    pub(crate) bench: Bench<std::iter::Empty<PenMove>, LinkedGantry<4, 64>>,
    pub(crate) host: Host,
    /// What a person orders, and when, ms.
    pub(crate) orders: VecDeque<(u64, Order)>,
    line: SimulatedLine,
    down: FaultInjector,
    up: FaultInjector,
    to_machine: VecDeque<(Duration, u8)>,
    to_host: VecDeque<(Duration, u8)>,
}

impl LinkedSession {
    pub(crate) fn new(machine: &Machine, faults: &Faults, seed: u64, moves: Vec<PenMove>) -> Self {
        let settings = LinkSettings::default();
        let controller = LinkedGantry::new(
            Gantry::new(machine, SafetyGate::new(LimitSwitches::RELEASED, false)),
            BOOT,
            settings,
        );
        let nothing = std::iter::empty();
        Self {
            bench: Bench::with_controller(machine, BenchSettings::default(), controller, nothing),
            host: LinkHost::new(9, settings, Duration::ZERO, HostSettings::default(), moves.into_iter()),
            orders: VecDeque::new(),
            line: SimulatedLine::new(machine.config().serial.baud),
            down: FaultInjector::new(faults.clone(), seed),
            up: FaultInjector::new(faults.clone(), !seed),
            to_machine: VecDeque::new(),
            to_host: VecDeque::new(),
        }
    }

    /// Goes on until the drawing is done, and a little longer; `inside` is told of all that a recorder in the
    /// machine sees, and `outside` of what the host sends and hears.
    pub(crate) fn run(
        &mut self,
        most: Duration,
        mut inside: impl FnMut(Duration, BenchEvent),
        mut outside: impl FnMut(Duration, Event),
    ) {
        let mut after = None;
        while after.is_none_or(|end| self.bench.now() < end) {
            let now = self.bench.now();
            assert!(now < most, "not done in time");
            if self.host.is_done() {
                after.get_or_insert(now + Duration::from_millis(300));
            }
            while let Some(byte) = due(&mut self.to_host, now) {
                outside(now, Event::Controller(vec![byte]));
                self.host.receive(now, byte);
            }
            if let Some(&(_, order)) =
                self.orders.front().filter(|&&(ms, _)| Duration::from_millis(ms) <= now)
            {
                self.orders.pop_front();
                self.host.order(order);
            }
            while self.host.poll(now).is_some() {}
            if self.line.next().is_none()
                && let Some(byte) = self.host.next_byte(now)
            {
                outside(now, Event::Host(vec![byte]));
                self.line.send(now, byte);
            }
            if let Some(at) = self.line.next().filter(|&at| at <= now)
                && let Some(byte) = self.line.take()
            {
                self.to_machine.extend(self.down.pass(at, byte));
            }
            while let Some(byte) = due(&mut self.to_machine, now) {
                self.bench.disturb(byte);
            }
            let Self { bench, up, to_host, .. } = self;
            bench.step(|time, event| {
                if let BenchEvent::ControllerByte(byte) = event {
                    to_host.extend(up.pass(time, byte));
                }
                inside(time, event);
            });
        }
    }
}

fn due(bytes: &mut VecDeque<(Duration, u8)>, now: Duration) -> Option<u8> {
    bytes.front().filter(|&&(at, _)| at <= now)?;
    bytes.pop_front().map(|(_, byte)| byte)
}
