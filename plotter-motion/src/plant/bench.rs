//! A whole machine on the bench: host, serial line, controller, motors and encoders.

use super::{AxisPlant, DriveDelay, SimulatedLine};
use crate::config::DcConfig;
use crate::control::LineController;
use crate::firmware::{Gantry, LinkedGantry, Notice};
use crate::protocol::{Host, HostEvent, HostSettings};
use crate::{Axis, Direction, Drive, LimitSwitches, Machine, Pen, PenMove, Point, SafetyGate};
use alloc::collections::VecDeque;
use core::time::Duration;

/// How a machine is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
pub struct BenchSettings {
    /// Time step of the motors, 10 us by default; the drive changes between steps only. Taken as the nearest
    /// of 1 us to 1 ms, without what is below a microsecond.
    pub time_step: Duration,
    /// The host's patience.
    pub host: HostSettings,
}

impl Default for BenchSettings {
    fn default() -> Self {
        Self { time_step: Duration::from_micros(10), host: HostSettings::default() }
    }
}

/// Events on the bench, as a recorder beside the machine sees them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchEvent {
    /// A byte of the host is through.
    HostByte(u8),
    /// A byte of the controller is through.
    ControllerByte(u8),
    /// An encoder counted.
    Edge(Axis, Direction),
    /// The duty of a motor changed, in steps of its timer.
    Drive(Axis, i32),
    /// The host begins a move, has finished one, or noticed something.
    Host(HostEvent),
    /// The controller noticed something.
    Controller(Notice),
}

/// A controller that a [`Bench`] has on its end of the line.
pub trait BenchController {
    /// Takes a byte from the host.
    fn receive(&mut self, now: Duration, byte: u8);
    /// Takes an edge of an encoder.
    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction);
    /// When [`tick`](Self::tick) has something to do, if ever; what waits for the line is left out while that
    /// is busy.
    fn next_tick(&self, line_is_free: bool) -> Option<Duration>;
    /// Does what is due.
    fn tick(&mut self, now: Duration);
    /// The next byte for the host, if there is one.
    fn transmit(&mut self, now: Duration, line_is_free: bool) -> Option<u8>;
    /// The next thing that it noticed.
    fn take_notice(&mut self) -> Option<Notice>;
    /// What both motors get.
    fn drive(&self) -> Drive<'_>;
    /// Where the pen belongs, for a controller that is told; the digits protocol does not say.
    fn pen(&self) -> Option<Pen> {
        None
    }
}

/// Its bytes wait on the line, however many they are.
impl<C: LineController> BenchController for Gantry<C> {
    fn receive(&mut self, now: Duration, byte: u8) {
        Self::receive(self, now, byte);
    }
    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) {
        Self::edge(self, now, axis, direction);
    }
    fn next_tick(&self, _: bool) -> Option<Duration> {
        Self::next_tick(self)
    }
    fn tick(&mut self, now: Duration) {
        Self::tick(self, now);
    }
    fn transmit(&mut self, _: Duration, _: bool) -> Option<u8> {
        Self::transmit(self)
    }
    fn take_notice(&mut self) -> Option<Notice> {
        Self::take_notice(self)
    }
    fn drive(&self) -> Drive<'_> {
        Self::drive(self)
    }
}

/// It is asked for a byte whenever the line can take one.
impl<const WINDOW: usize, const PAYLOAD: usize, C: LineController> BenchController
    for LinkedGantry<WINDOW, PAYLOAD, C>
{
    fn receive(&mut self, now: Duration, byte: u8) {
        Self::receive(self, now, byte);
        self.poll(now);
    }
    fn edge(&mut self, now: Duration, axis: Axis, direction: Direction) {
        self.gantry_mut().edge(now, axis, direction);
        self.poll(now);
    }
    fn next_tick(&self, line_is_free: bool) -> Option<Duration> {
        let wake = self.next_wake().filter(|_| line_is_free);
        [self.gantry().next_tick(), wake].into_iter().flatten().min()
    }
    fn tick(&mut self, now: Duration) {
        self.gantry_mut().tick(now);
        self.poll(now);
    }
    fn transmit(&mut self, now: Duration, line_is_free: bool) -> Option<u8> {
        if line_is_free { Self::transmit(self, now) } else { None }
    }
    fn take_notice(&mut self) -> Option<Notice> {
        Self::take_notice(self)
    }
    fn pen(&self) -> Option<Pen> {
        Some(Self::pen(self))
    }
    fn drive(&self) -> Drive<'_> {
        self.gantry().drive()
    }
}

/// A host, a serial line, a [`Gantry`] or another [`BenchController`] and its two simulated motors in one
/// time.
///
/// Everything happens at whole microseconds; of what happens at the same one, the controller's tick comes
/// first. A byte is through ten bit times after it was put on the line. The crate's page shows one at work.
#[derive(Debug)]
pub struct Bench<I, C = Gantry> {
    now: Duration,
    time_step: Duration,
    host: Host<I>,
    controller: C,
    ticked: Option<Duration>,
    delay: DriveDelay,
    x: AxisPlant,
    y: AxisPlant,
    to_controller: SimulatedLine,
    to_host: SimulatedLine,
    /// Edges of the present time step.
    edges: VecDeque<(Duration, Axis, Direction)>,
    pwm_steps: [u16; 2],
    drive: [i32; 2],
}

/// What comes next.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    Tick,
    ToController,
    Edge,
    ToHost,
    Host,
}

impl<I: Iterator<Item = PenMove>> Bench<I> {
    /// A machine at rest at the origin, none of its switches pressed, and a host with `moves` to send, at the
    /// pace of the machine's `serial.byte_gap_ms`.
    #[must_use]
    pub fn new(machine: &Machine, settings: BenchSettings, moves: I) -> Self {
        let gate = SafetyGate::new(LimitSwitches::RELEASED, false);
        Self::with_controller(machine, settings, Gantry::new(machine, gate), moves)
    }
}

impl<I: Iterator<Item = PenMove>, C: BenchController> Bench<I, C> {
    /// The same with another controller, at rest at the origin.
    #[must_use]
    pub fn with_controller(machine: &Machine, settings: BenchSettings, controller: C, moves: I) -> Self {
        let (serial, DcConfig { x, y, .. }) = (machine.config().serial, DcConfig::of(machine));
        /// Shortest time step: the resolution of all recorded times.
        const SHORTEST: Duration = Duration::from_micros(1);
        const LONGEST: Duration = Duration::from_millis(1); // a few of the position loop's runs
        let time_step = Duration::from_micros(micros(settings.time_step.clamp(SHORTEST, LONGEST)));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a checked machine has 0 to 1000 ms"
        )]
        let byte_gap = Duration::from_micros(libm::round(serial.byte_gap_ms * 1e3) as u64);
        let axis = |axis| AxisPlant::new(axis, time_step.as_secs_f64());
        let pwm_steps =
            |axis: &crate::config::AxisConfig| u16::try_from(axis.motor.pwm_steps).unwrap_or(u16::MAX);
        Self {
            now: Duration::ZERO,
            time_step,
            host: Host::new(byte_gap, settings.host, moves),
            controller,
            ticked: None,
            delay: DriveDelay::of(machine),
            x: axis(&x),
            y: axis(&y),
            to_controller: SimulatedLine::new(serial.baud),
            to_host: SimulatedLine::new(serial.baud),
            edges: VecDeque::new(),
            pwm_steps: [pwm_steps(&x), pwm_steps(&y)],
            drive: [0; 2],
        }
    }

    /// Goes on by one time step; `record` is told of everything that happens in it, in order of time.
    pub fn step(&mut self, mut record: impl FnMut(Duration, BenchEvent)) {
        let end = self.now + self.time_step;
        let duties = self.delay.pass(self.now, self.controller.drive());
        for ((plant, axis), duty) in [(&mut self.x, Axis::X), (&mut self.y, Axis::Y)].into_iter().zip(duties)
        {
            let (now, time_step, edges) = (self.now, self.time_step, &mut self.edges);
            plant.step(duty, |edge| {
                let at = now + time_step.mul_f64(edge.share_of_step);
                edges.push_back((
                    Duration::from_micros(micros(at).max(micros(now) + 1)),
                    axis,
                    edge.direction,
                ));
            });
        }
        self.edges.make_contiguous().sort_by_key(|&(at, ..)| at);

        while let Some((at, next)) = self.next_event().filter(|&(at, _)| at <= end) {
            // what is overdue from before happens now
            let at = at.max(self.now);
            self.now = at;
            self.handle(at, next, &mut record);
        }
        self.now = end;
    }

    fn next_event(&self) -> Option<(Duration, Next)> {
        let line_is_free = self.to_host.next().is_none();
        // What has nothing to say although it is due is asked again a microsecond later.
        let tick = self.controller.next_tick(line_is_free);
        let later = self.ticked.map_or(Duration::ZERO, |at| at + Duration::from_micros(1));
        [
            (tick.map(|at| at.max(later)), Next::Tick),
            (self.to_controller.next(), Next::ToController),
            (self.edges.front().map(|&(at, ..)| at), Next::Edge),
            (self.to_host.next(), Next::ToHost),
            (self.host.next_wake(), Next::Host),
        ]
        .into_iter()
        .filter_map(|(at, next)| Some((at?.max(self.now), next)))
        .min()
    }

    fn handle(&mut self, at: Duration, next: Next, record: &mut impl FnMut(Duration, BenchEvent)) {
        match next {
            Next::Tick => {
                self.controller.tick(at);
                self.ticked = Some(at);
            }
            Next::ToController => {
                if let Some(byte) = self.to_controller.take() {
                    record(at, BenchEvent::HostByte(byte));
                    self.controller.receive(at, byte);
                }
            }
            Next::Edge => {
                if let Some((_, axis, direction)) = self.edges.pop_front() {
                    record(at, BenchEvent::Edge(axis, direction));
                    self.controller.edge(at, axis, direction);
                }
            }
            Next::ToHost => {
                if let Some(byte) = self.to_host.take() {
                    record(at, BenchEvent::ControllerByte(byte));
                    if let Some(event) = self.host.receive(at, byte) {
                        record(at, BenchEvent::Host(event));
                    }
                }
            }
            Next::Host => {
                if let Some(event) = self.host.poll(at) {
                    record(at, BenchEvent::Host(event));
                }
                if let Some(byte) = self.host.next_byte(at) {
                    self.to_controller.send(at, byte);
                }
            }
        }
        while let Some(byte) = self.controller.transmit(at, self.to_host.next().is_none()) {
            self.to_host.send(at, byte);
        }
        while let Some(notice) = self.controller.take_notice() {
            record(at, BenchEvent::Controller(notice));
        }
        let drive = self.controller.drive();
        for ((axis, before), steps) in Axis::BOTH.into_iter().zip(&mut self.drive).zip(self.pwm_steps) {
            let duty = drive.axis(axis).steps(steps);
            if duty != *before {
                *before = duty;
                record(at, BenchEvent::Drive(axis, duty));
            }
        }
    }

    /// Time since the start.
    #[must_use]
    pub const fn now(&self) -> Duration {
        self.now
    }

    /// Where the pen truly is, mm.
    #[must_use]
    pub fn position_mm(&self) -> Point {
        Point::new(self.x.position_mm(), self.y.position_mm())
    }

    /// The host.
    #[must_use]
    pub const fn host(&self) -> &Host<I> {
        &self.host
    }

    /// The controller.
    #[must_use]
    pub const fn controller(&self) -> &C {
        &self.controller
    }

    /// The controller, to press its switches.
    pub const fn controller_mut(&mut self) -> &mut C {
        &mut self.controller
    }

    /// The simulated motor of `axis`, to look at or to hold fast.
    pub const fn axis_mut(&mut self, axis: Axis) -> &mut AxisPlant {
        match axis {
            Axis::X => &mut self.x,
            Axis::Y => &mut self.y,
        }
    }

    /// Puts a byte on the line to the controller that the host did not send: noise.
    pub fn disturb(&mut self, byte: u8) {
        self.to_controller.send(self.now, byte);
    }

    /// Takes the next byte off the line to the controller; says which it was.
    pub fn lose_byte(&mut self) -> Option<u8> {
        self.to_controller.take()
    }
}

fn micros(time: Duration) -> u64 {
    u64::try_from(time.as_micros()).unwrap_or(u64::MAX)
}
