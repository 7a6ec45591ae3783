//! The simulated stepper plotter: two motors that follow every pulse, and the serial line, in the time of the
//! bench.

use super::bench::{Bench, Told};
use super::connection::Connection;
use super::pins::{Input, Output, Pwm, Step as StepPin, Wire};
use crate::board::{Event, Notice, StepperPins};
use crate::machine;
use core::cell::Cell;
use core::time::Duration;
use cortex_m::singleton;
use crc::{CRC_64_XZ, Crc, Digest};
use plotter_motion::firmware::stepper_plotter::Step;

static STEPS_CRC: Crc<u64> = Crc::<u64>::new(&CRC_64_XZ);

/// Steps of the servo's PWM in a frame.
pub const SERVO_STEPS: u16 = 20_000;

/// Pins of a motor's driver.
pub type Motor = StepperPins<StepPin, Output>;

/// All that the stepper plotter's firmware gets of its board.
#[derive(Debug)]
pub struct Parts {
    /// The motor to the right.
    pub x: Motor,
    /// The motor up.
    pub y: Motor,
    /// ENABLE of both drivers.
    pub enable: Output,
    /// Servo of the pen, 50 Hz.
    pub servo: Pwm,
    /// Laser.
    pub laser: Pwm,
    /// Limit switches, normally closed to ground: x lower, x upper, y lower, y upper.
    pub limits: [Input; 4],
    /// The emergency stop button: normally closed to ground, so high is pressed.
    pub stop: Input,
    /// The rest.
    pub rest: Rest,
}

/// What becomes the [`Board`].
#[derive(Debug)]
pub struct Rest {
    bench: Bench,
    cells: &'static Cells,
}

#[derive(Debug)]
struct Cells {
    step: [Wire; 2],
    dir: [Wire; 2],
    position: [Cell<i32>; 2],
    enable: Wire,
    servo: Cell<u16>,
    laser: Cell<u16>,
    limits: [Wire; 4],
    stop: Wire,
}

impl Cells {
    const fn new() -> Self {
        Self {
            step: [const { Cell::new(false) }; 2],
            dir: [const { Cell::new(false) }; 2],
            position: [const { Cell::new(0) }; 2],
            enable: Cell::new(true),
            servo: Cell::new(0),
            laser: Cell::new(0),
            limits: [const { Cell::new(false) }; 4],
            stop: Cell::new(false),
        }
    }
}

/// Takes the board; `None` the second time.
pub fn take() -> Option<Parts> {
    let cells: &'static Cells = singleton!(CELLS: Cells = Cells::new())?;
    let [x, y] = [0, 1].map(|axis| StepperPins {
        step: StepPin { level: &cells.step[axis], dir: &cells.dir[axis], position: &cells.position[axis] },
        dir: Output(&cells.dir[axis]),
    });
    Some(Parts {
        x,
        y,
        enable: Output(&cells.enable),
        servo: Pwm { steps: &cells.servo, full: SERVO_STEPS },
        laser: Pwm { steps: &cells.laser, full: 1_000 },
        limits: [0, 1, 2, 3].map(|end| Input(&cells.limits[end])),
        stop: Input(&cells.stop),
        rest: Rest { bench: Bench::new(), cells },
    })
}

/// What comes next.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    Due,
    ToController,
    ToHost,
    Host,
}

/// The simulated machine, with the time that passes on it.
pub struct Board {
    now_us: u64,
    cells: &'static Cells,
    connection: Connection,
    steps: u64,
    told_steps: u64,
    digest: Digest<'static, u64>,
}

impl Rest {
    /// Whether the watchdog has reset the processor.
    pub fn was_bitten(&self) -> bool {
        self.bench.restarted()
    }

    /// Starts the time.
    pub fn start(self) -> Board {
        let Self { mut bench, cells } = self;
        let now_us = bench.start_us();
        if bench.stop_pressed() {
            cells.stop.set(true);
            bench.tell(now_us, Told::Stop(true));
        }
        Board {
            now_us,
            cells,
            connection: Connection::new(machine::PLOTTER_BAUD, bench),
            steps: 0,
            told_steps: 0,
            digest: STEPS_CRC.digest(),
        }
    }
}

impl Board {
    /// The time.
    pub fn now(&mut self) -> Duration {
        Duration::from_micros(self.now_us)
    }

    /// Waits for what comes first: something happens, or it is `due`.
    pub fn wait(&mut self, due: Option<Duration>) -> (Duration, Event) {
        // A microsecond that has begun is over when it is due within it.
        let due_us = due.map(|due| due.as_nanos().div_ceil(1_000) as u64);
        loop {
            let next = [
                (due_us, Next::Due),
                (self.connection.to_controller_us(), Next::ToController),
                (self.connection.to_host_us(), Next::ToHost),
                (Some(self.connection.horizon_us()), Next::Host),
            ];
            let coming = next.into_iter().filter_map(|(at, next)| Some((at?.max(self.now_us), next)));
            let Some((at, next)) = coming.min() else { continue };
            self.now_us = at;
            let now = Duration::from_micros(at);
            match next {
                Next::Due => return (now, Event::Due),
                Next::ToController => {
                    if let Some(event) = self.connection.received(at) {
                        return (now, event);
                    }
                }
                Next::ToHost => {
                    // A host answers whole lines.
                    self.connection.sent(at, |byte| byte == b'\n');
                }
                Next::Host => {
                    self.tell_steps();
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

    /// A step that the motors got: the bench keeps account of all.
    pub fn stepped(&mut self, step: Step) {
        self.steps += 1;
        let at_us = step.at.as_micros() as u64;
        self.digest.update(&at_us.to_le_bytes());
        self.digest.update(&[step.pulse.x().cast_unsigned(), step.pulse.y().cast_unsigned()]);
    }

    /// Tells a person.
    pub fn notify(&mut self, notice: Notice) {
        self.connection.notify(self.now_us, notice);
    }

    /// Keeps the watchdog from biting.
    pub fn feed_watchdog(&mut self) {}

    fn tell_steps(&mut self) {
        if core::mem::replace(&mut self.told_steps, self.steps) != self.steps {
            self.connection.tell(self.now_us, Told::Steps(self.steps, self.digest.clone().finalize()));
            for (which, position) in self.cells.position.iter().enumerate() {
                self.connection.tell(self.now_us, Told::Position(which as u8, position.get()));
            }
        }
    }
}
