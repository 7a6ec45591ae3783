//! A host of a machine's language and a simulated machine, in the machine's time.

use plotter_motion::protocol::Wire;
use plotter_motion::protocol::hosts::{HostState, MachineHost, MachineNotice, Request};
use plotter_motion::stepgen::{MotorEvent, timed_events};
use plotter_motion::{Axis, Machine, MachineConfig, PlotOp, Point};
use plotter_replay::live::{Line, MachineLine, MachineLog, SimulatedMachine, Spoken};
use plotter_replay::log::{Event, Header, Reader, Writer};
use plotter_replay::simulation::Script;
use std::io::Write;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// What a log is written to while another looks at it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept(Arc<Mutex<Vec<u8>>>);

impl Write for Kept {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// What damages bytes on their way: `true` for the host's, the byte.
pub(crate) type Damage = Box<dyn FnMut(bool, u8) -> u8>;

/// A host at its desk, with a machine on its line.
pub(crate) struct Desk {
    pub host: Box<dyn MachineHost>,
    line: MachineLine<Kept>,
    log: MachineLog<Kept>,
    kept: Kept,
    wire: Wire,
    free: Duration,
    pub notices: Vec<MachineNotice>,
    /// Bytes that the host has sent.
    pub sent: Vec<u8>,
    pub damage: Option<Damage>,
}

impl Desk {
    pub(crate) fn new(host: Box<dyn MachineHost>, machine: &Machine, spoken: Spoken, script: &str) -> Self {
        let kept = Kept::default();
        let header = Header::new().with_number("baud", machine.config().serial.baud.into());
        let log = MachineLog::new(Writer::new(kept.clone(), &header).unwrap());
        let simulated = SimulatedMachine::speaking(machine, spoken).unwrap();
        let simulated = simulated.with_script(Script::parse(script).unwrap());
        let line = simulated.logged(log.clone()).line(1e9);
        let (wire, free) = (Wire::new(machine.config().serial.baud), Duration::ZERO);
        Self { host, line, log, kept, wire, free, notices: Vec::new(), sent: Vec::new(), damage: None }
    }

    pub(crate) fn now(&self) -> Duration {
        self.line.now().unwrap()
    }

    /// Another host comes to the same machine.
    pub(crate) fn with(self, host: Box<dyn MachineHost>) -> Self {
        let Self { line, log, kept, wire, free, sent, damage, .. } = self;
        Self { host, line, log, kept, wire, free, notices: Vec::new(), sent, damage }
    }

    /// Once round.
    pub(crate) fn round(&mut self) {
        const LISTEN: Duration = Duration::from_millis(2);
        let now = self.now();
        self.notices.extend(core::iter::from_fn(|| self.host.poll(now)));
        let mut out = Vec::new();
        while self.free <= now + LISTEN {
            let Some(byte) = self.host.next_byte(now) else { break };
            self.free = self.wire.send(now);
            self.sent.push(byte);
            out.push(self.damage.as_mut().map_or(byte, |damage| damage(true, byte)));
        }
        self.line.send(&out).unwrap();
        let mut bytes = [0; 256];
        let count = self.line.receive(&mut bytes, LISTEN).unwrap();
        let now = self.now();
        for &byte in &bytes[..count] {
            let byte = self.damage.as_mut().map_or(byte, |damage| damage(false, byte));
            self.host.receive(now, byte);
        }
    }

    /// Until the host's state is one of these, or `within` of the machine's time has passed: the state then.
    pub(crate) fn until(&mut self, states: &[HostState], within: Duration) -> HostState {
        let end = self.now() + within;
        while !states.contains(&self.host.status().state) && self.now() < end {
            self.round();
        }
        self.round(); // what it notices of it
        self.host.status().state
    }

    pub(crate) fn wait(&mut self, time: Duration) {
        let end = self.now() + time;
        while self.now() < end {
            self.round();
        }
    }

    pub(crate) fn ask(&mut self, request: Request) {
        let now = self.now();
        self.host.ask(now, request).unwrap_or_else(|error| panic!("{request:?}: {error}"));
    }

    /// Stops the machine as a session does: past everything that waits.
    pub(crate) fn stop(&mut self) {
        self.line.send(self.host.stop_bytes()).unwrap();
        self.ask(Request::Stop);
    }

    /// What happened in the machine.
    pub(crate) fn events(&self) -> Vec<(Duration, Event)> {
        self.log.finish().unwrap();
        let bytes = self.kept.0.lock().unwrap().clone();
        let reader = Reader::new(&bytes[..]).unwrap();
        reader.map(|record| record.unwrap()).map(|record| (record.time, record.event)).collect()
    }

    /// The steps that its motors were told.
    pub(crate) fn steps(&self) -> Vec<(Axis, i32)> {
        let steps = self.events().into_iter().filter_map(|(_, event)| match event {
            Event::Edge { axis, sign } => Some((axis, sign.sign())),
            _ => None,
        });
        steps.collect()
    }

    /// Where it drew: places with the pen down, each once, in steps, without their order.
    pub(crate) fn ink(&self) -> std::collections::BTreeSet<(i32, i32)> {
        let (mut at, mut down, mut ink) = ((0, 0), false, std::collections::BTreeSet::new());
        for (_, event) in self.events() {
            match event {
                Event::Edge { axis: Axis::X, sign } => at.0 += sign.sign(),
                Event::Edge { axis: Axis::Y, sign } => at.1 += sign.sign(),
                Event::Pen(pen) => down = pen == plotter_motion::Pen::Down,
                _ => continue,
            }
            if down {
                ink.insert(at);
            }
        }
        ink
    }
}

/// With room for the drawing, switches where homing finds them soon, and a pen that waits for next to
/// nothing.
pub(crate) fn machine() -> Machine {
    let mut config = MachineConfig::stepper_plotter();
    (config.area.width_mm, config.area.height_mm) = (60.0, 40.0);
    (
        config.steppers_mut().unwrap().homing.known_travel_mm,
        config.steppers_mut().unwrap().homing.max_travel_mm,
    ) = (0.0, 80.0);
    (config.steppers_mut().unwrap().homing.fast_rate_hz, config.steppers_mut().unwrap().homing.pull_off_mm) =
        (4_000.0, 1.0);
    config.steppers_mut().unwrap().pen.settle_ms = 20.0;
    Machine::new(config).unwrap()
}

/// The steps of the desktop's own plan.
pub(crate) fn planned(machine: &Machine, ops: &[PlotOp]) -> Vec<(Axis, i32)> {
    let events = timed_events(machine, ops.iter().copied()).unwrap();
    let steps = events.filter_map(|timed| match timed.unwrap().event {
        MotorEvent::Step(step) => Some([(Axis::X, i32::from(step.x)), (Axis::Y, i32::from(step.y))]),
        _ => None,
    });
    steps.flatten().filter(|&(_, sign)| sign != 0).collect()
}

/// A spiral of chords, a circle, two squares: some 100 operations within 60 by 40 mm. In whole hundredths, as
/// every language has them: steps are those of the plan then.
pub(crate) fn drawing() -> Vec<PlotOp> {
    let hundredths = |mm: f64| (mm * 100.0).round() / 100.0;
    let draw =
        |x: f64, y: f64| PlotOp::Draw { to: Point::new(hundredths(x), hundredths(y)), feed_mm_s: Some(40.0) };
    let mut ops = vec![PlotOp::Travel { to: Point::new(30.0, 20.0) }];
    for n in 1..=80 {
        let (angle, radius) = (f64::from(n) * 0.3, 0.12 * f64::from(n));
        ops.push(draw(30.0 + radius * angle.cos(), 20.0 + radius * angle.sin()));
    }
    let (centre, to) = (Point::new(50.0, 10.0), Point::new(56.0, 10.0));
    ops.push(PlotOp::Travel { to });
    ops.push(PlotOp::DrawArc { centre, sweep_rad: core::f64::consts::TAU, to, feed_mm_s: Some(40.0) });
    for side in [8.0, 4.0] {
        ops.push(PlotOp::Travel { to: Point::new(side, side) });
        ops.extend([
            draw(2.0 * side, side),
            draw(2.0 * side, 2.0 * side),
            draw(side, 2.0 * side),
            draw(side, side),
        ]);
    }
    ops
}
