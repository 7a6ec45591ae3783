//! The simulated gantry: two motors, their encoders and the serial line, in the time of the bench.
//!
//! Everything happens as in `plotter_motion::plant::Bench`, in the same order and at the same microseconds,
//! but that here each level goes through a driver and its pins.

use super::bench::{Bench, Told};
use super::connection::Connection;
use super::pins::{Input, Output, Pwm, Wire};
use crate::board::{Event, MotorPins, Notice};
use crate::machine;
use core::cell::Cell;
use core::time::Duration;
use cortex_m::singleton;
use heapless::Deque;
use plotter_hal::Quadrature;
use plotter_motion::plant::AxisPlant;
use plotter_motion::{Axis, Direction, Duty, encoder::Phases};

/// Time step of the motors.
const TIME_STEP_US: u64 = 10;

/// Pins of a motor.
pub type Motor = MotorPins<Pwm, Output, Output>;
/// The encoder of an axis.
pub type Encoder = Quadrature<Input, Input>;

/// All that the gantry's firmware gets of its board.
#[derive(Debug)]
pub struct Parts {
    /// The motor to the right.
    pub x: Motor,
    /// The motor up.
    pub y: Motor,
    /// Phases A and B of the encoder of x.
    pub x_phases: (Input, Input),
    /// Those of y.
    pub y_phases: (Input, Input),
    /// The emergency stop button: normally closed to ground, so high is pressed.
    pub stop: Input,
    /// The rest.
    pub rest: Rest,
}

/// What becomes the [`Board`].
#[derive(Debug)]
pub struct Rest {
    bench: Bench,
    axes: [SimulatedAxis; 2],
    stop: &'static Wire,
}

#[derive(Debug)]
struct SimulatedAxis {
    axis: Axis,
    plant: AxisPlant,
    enable: &'static Cell<u16>,
    forward: &'static Wire,
    reverse: &'static Wire,
    a: &'static Wire,
    b: &'static Wire,
    /// Changes on the encoder's pins in the present time step.
    changes: Deque<(u64, Phases), 32>,
    /// The duty under which the plant did not change at all in the last step.
    rests_at: Option<i32>,
    /// The duty told last.
    told: i32,
}

impl SimulatedAxis {
    fn new(axis: Axis, cells: &'static AxisCells) -> Self {
        let config = match axis {
            Axis::X => &machine::X,
            Axis::Y => &machine::Y,
        };
        let time_step = Duration::from_micros(TIME_STEP_US);
        let plant = AxisPlant::new(config, time_step.as_secs_f64());
        let Phases { a, b } = plant.phases();
        cells.a.set(a);
        cells.b.set(b);
        Self {
            axis,
            plant,
            enable: &cells.enable,
            forward: &cells.forward,
            reverse: &cells.reverse,
            a: &cells.a,
            b: &cells.b,
            changes: Deque::new(),
            rests_at: None,
            told: 0,
        }
    }

    /// What the bridge puts on the motor: steps of the PWM with the sign of the direction.
    fn duty_steps(&self) -> i32 {
        let steps = i32::from(self.enable.get());
        match (self.forward.get(), self.reverse.get()) {
            (true, false) => steps,
            (false, true) => -steps,
            // Both ends of the motor at the same level.
            _ => 0,
        }
    }

    fn step(&mut self, now_us: u64) {
        let steps = self.duty_steps();
        if self.rests_at == Some(steps) {
            return;
        }
        let before = self.plant.state();
        let full = f32::from(machine::PWM_STEPS[self.axis as usize]);
        let changes = &mut self.changes;
        self.plant.turn(Duty::saturating(steps as f32 / full), |change| {
            let since = Duration::from_micros(TIME_STEP_US).mul_f64(change.share_of_step);
            let at = (Duration::from_micros(now_us) + since).as_micros() as u64;
            // A motor makes three a step at most.
            let _ = changes.push_back((at.max(now_us + 1), change.phases));
        });
        // The same numbers again under the same duty: it will stay so.
        self.rests_at = (self.plant.state() == before).then_some(steps);
    }
}

#[derive(Debug, Default)]
struct AxisCells {
    enable: Cell<u16>,
    forward: Wire,
    reverse: Wire,
    a: Wire,
    b: Wire,
}

impl AxisCells {
    const fn new() -> Self {
        Self {
            enable: Cell::new(0),
            forward: Cell::new(false),
            reverse: Cell::new(false),
            a: Cell::new(false),
            b: Cell::new(false),
        }
    }

    fn motor(&'static self, axis: Axis) -> Motor {
        MotorPins {
            enable: Pwm { steps: &self.enable, full: machine::PWM_STEPS[axis as usize] },
            forward: Output(&self.forward),
            reverse: Output(&self.reverse),
        }
    }

    fn phases(&'static self) -> (Input, Input) {
        (Input(&self.a), Input(&self.b))
    }
}

/// Takes the board; `None` the second time.
pub fn take() -> Option<Parts> {
    let x: &'static AxisCells = singleton!(X_CELLS: AxisCells = AxisCells::new())?;
    let y: &'static AxisCells = singleton!(Y_CELLS: AxisCells = AxisCells::new())?;
    let stop: &'static Wire = singleton!(STOP: Wire = Cell::new(false))?;
    let bench = Bench::new();
    let axes = [SimulatedAxis::new(Axis::X, x), SimulatedAxis::new(Axis::Y, y)];
    Some(Parts {
        x: x.motor(Axis::X),
        y: y.motor(Axis::Y),
        x_phases: x.phases(),
        y_phases: y.phases(),
        stop: Input(stop),
        rest: Rest { bench, axes, stop },
    })
}

/// What comes next.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    Due,
    ToController,
    Phase,
    ToHost,
    Host,
}

/// The simulated machine, with the time that passes on it.
#[derive(Debug)]
pub struct Board {
    now_us: u64,
    step_end_us: u64,
    axes: [SimulatedAxis; 2],
    encoders: [Encoder; 2],
    connection: Connection,
}

impl Rest {
    /// Whether the watchdog has reset the processor.
    pub fn was_bitten(&self) -> bool {
        self.bench.restarted()
    }

    /// Starts the time, with the encoders on their pins' interrupts.
    pub fn start(self, x: Encoder, y: Encoder) -> Board {
        let Self { mut bench, axes, stop } = self;
        let now_us = bench.start_us();
        if bench.stop_pressed() {
            stop.set(true);
            bench.tell(now_us, Told::Stop(true));
        }
        if bench.restarted() {
            // Whatever drove the motors when the processor began anew, its pins do not any more.
            bench.tell(now_us, Told::Duty(0, 0));
            bench.tell(now_us, Told::Duty(1, 0));
        }
        let mut board = Board {
            now_us,
            step_end_us: now_us,
            axes,
            encoders: [x, y],
            connection: Connection::new(machine::BAUD, bench),
        };
        for encoder in &mut board.encoders {
            // Notes where the shaft stands.
            let _ = encoder.poll();
        }
        board.begin_step();
        board
    }
}

impl Board {
    /// The time.
    pub fn now(&self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    /// Waits for what comes first: something happens, or it is `due`.
    pub fn wait(&mut self, due: Option<Duration>) -> (Duration, Event) {
        self.tell_duties();
        let due_us = due.map(|due| due.as_micros() as u64);
        loop {
            let Some((at, next)) = self.next(due_us).filter(|&(at, _)| at <= self.step_end_us) else {
                self.now_us = self.step_end_us;
                self.begin_step();
                continue;
            };
            self.now_us = at;
            let now = Duration::from_micros(at);
            match next {
                Next::Due => return (now, Event::Due),
                Next::ToController => {
                    if let Some(event) = self.connection.received(at) {
                        return (now, event);
                    }
                }
                Next::Phase => {
                    if let Some((axis, direction)) = self.phase() {
                        self.connection
                            .tell(at, Told::Edge(2 * (axis as u8) + u8::from(direction == Direction::Minus)));
                        return (now, Event::Edge(axis, direction));
                    }
                }
                Next::ToHost => {
                    // A count makes a host only wait longer.
                    self.connection.sent(at, |byte| !(b'1'..=b'4').contains(&byte));
                }
                Next::Host => {
                    self.connection.ask(at);
                }
            }
        }
    }

    /// Whether a byte can be sent.
    pub fn can_send(&self) -> bool {
        self.connection.can_send()
    }

    /// Sends a byte to the host.
    pub fn send(&mut self, byte: u8) {
        self.connection.send(self.now_us, byte);
    }

    /// Tells a person.
    pub fn notify(&mut self, notice: Notice) {
        self.connection.notify(self.now_us, notice);
    }

    /// Keeps the watchdog from biting.
    pub fn feed_watchdog(&mut self) {}

    fn begin_step(&mut self) {
        for axis in &mut self.axes {
            axis.step(self.now_us);
        }
        self.step_end_us = self.now_us + TIME_STEP_US;
    }

    fn next(&self, due_us: Option<u64>) -> Option<(u64, Next)> {
        let [x, y] = &self.axes;
        [
            (due_us, Next::Due),
            (self.connection.to_controller_us(), Next::ToController),
            (x.changes.front().map(|&(at, _)| at), Next::Phase),
            (y.changes.front().map(|&(at, _)| at), Next::Phase),
            (self.connection.to_host_us(), Next::ToHost),
            (Some(self.connection.horizon_us()), Next::Host),
        ]
        .into_iter()
        // what is overdue from before happens now
        .filter_map(|(at, next)| Some((at?.max(self.now_us), next)))
        .min()
    }

    /// The next change on an encoder's pins, and what its driver makes of it.
    fn phase(&mut self) -> Option<(Axis, Direction)> {
        let [x, y] = &self.axes;
        let at = |axis: &SimulatedAxis| axis.changes.front().map_or(u64::MAX, |&(at, _)| at);
        let index = usize::from(at(y) < at(x));
        let (axis, encoder) = (self.axes.get_mut(index)?, self.encoders.get_mut(index)?);
        let (_, Phases { a, b }) = axis.changes.pop_front()?;
        axis.a.set(a);
        axis.b.set(b);
        // A simulated pin does not fail.
        Some((axis.axis, encoder.poll().ok()??))
    }

    fn tell_duties(&mut self) {
        for (which, axis) in self.axes.iter_mut().enumerate() {
            let steps = axis.duty_steps();
            if steps != core::mem::replace(&mut axis.told, steps) {
                self.connection.tell(self.now_us, Told::Duty(which as u8, steps));
            }
        }
    }
}
