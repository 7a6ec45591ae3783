//! A host and a machine on a serial line with faults, in simulated time.

#![allow(dead_code, reason = "each test uses its part of this")]

use core::time::Duration;
use plotter_motion::plant::SimulatedLine;
use plotter_replay::transport::{FaultInjector, Faults};
use std::collections::VecDeque;

/// One end: bytes in, bytes out.
pub(crate) trait End {
    /// Takes a byte; afterwards does all that follows from it.
    fn receive(&mut self, now: Duration, byte: u8);
    /// Does what is due.
    fn poll(&mut self, now: Duration);
    /// The next byte for the line.
    fn transmit(&mut self, now: Duration) -> Option<u8>;
    /// When it wants to be asked again.
    fn next_wake(&self) -> Option<Duration>;
}

/// One direction: the sender is asked for a byte whenever the line is free.
pub(crate) struct Direction {
    line: SimulatedLine,
    faults: FaultInjector,
    came: VecDeque<(Duration, u8)>,
}

impl Direction {
    fn new(baud: u32, faults: Faults, seed: u64) -> Self {
        let faults = FaultInjector::new(faults, seed);
        Self { line: SimulatedLine::new(baud), faults, came: VecDeque::new() }
    }

    fn fill(&mut self, now: Duration, end: &mut impl End) {
        if self.line.next().is_none()
            && let Some(byte) = end.transmit(now)
        {
            self.line.send(now, byte);
        }
    }
}

/// Both directions and both ends.
pub(crate) struct Connection<H, M> {
    pub(crate) now: Duration,
    pub(crate) host: H,
    pub(crate) machine: M,
    pub(crate) to_machine: Direction,
    pub(crate) to_host: Direction,
}

impl Direction {
    fn came_by(&mut self, now: Duration) -> Option<u8> {
        self.came.front().filter(|&&(at, _)| at <= now)?;
        self.came.pop_front().map(|(_, byte)| byte)
    }

    /// What became of the bytes.
    pub(crate) fn counts(&self) -> plotter_replay::transport::FaultCounts {
        self.faults.counts()
    }
}

impl<H: End, M: End> Connection<H, M> {
    pub(crate) fn new(baud: u32, faults: &Faults, seed: u64, host: H, machine: M) -> Self {
        Self {
            now: Duration::ZERO,
            host,
            machine,
            to_machine: Direction::new(baud, faults.clone(), seed),
            to_host: Direction::new(baud, faults.clone(), seed ^ 0xABCD_EF01),
        }
    }

    /// Goes on until `done`, or `until`; says whether it was done.
    pub(crate) fn run(&mut self, until: Duration, mut done: impl FnMut(&H, &M) -> bool) -> bool {
        while self.now < until {
            self.host.poll(self.now);
            self.machine.poll(self.now);
            if done(&self.host, &self.machine) {
                return true;
            }
            self.to_machine.fill(self.now, &mut self.host);
            self.to_host.fill(self.now, &mut self.machine);
            let times = [
                self.to_machine.line.next(),
                self.to_host.line.next(),
                self.to_machine.came.front().map(|&(at, _)| at),
                self.to_host.came.front().map(|&(at, _)| at),
                self.host.next_wake(),
                self.machine.next_wake(),
            ];
            let later = self.now + Duration::from_micros(1);
            let next = times.into_iter().flatten().min().map_or(until, |at| at.max(later));
            self.now = next.min(until);
            for direction in [&mut self.to_machine, &mut self.to_host] {
                while let Some(at) = direction.line.next().filter(|&at| at <= self.now) {
                    if let Some(byte) = direction.line.take() {
                        direction.came.extend(direction.faults.pass(at, byte));
                    }
                }
            }
            while let Some(byte) = self.to_machine.came_by(self.now) {
                self.machine.receive(self.now, byte);
            }
            while let Some(byte) = self.to_host.came_by(self.now) {
                self.host.receive(self.now, byte);
            }
        }
        done(&self.host, &self.machine)
    }
}
