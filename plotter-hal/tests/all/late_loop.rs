//! The stepper plotter's controller in main loops that are too slow for its steps, with real drivers on pins:
//! no step is lost.

use core::convert::Infallible;
use core::time::Duration;
use embedded_hal::digital::{self, OutputPin};
use plotter_hal::a4988::Timing;
use plotter_hal::{A4988, NoPin, StepperAxes};
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{
    Dialect, Drivers, Lateness, Link, Motion, Receive, StepperPlotterSettings,
};
use plotter_motion::{Axis, LimitSwitches, SafetyGate, StepPoint};
use std::cell::{Cell, RefCell};
use std::rc::Rc;

/// Two lines, there and back: 100 mm and 3 mm of 87.58 steps/mm at the machine's greatest speed.
const DRAWING: &str = "M3\nG1 X100 Y20 F6000\nG1 X97 Y22\nM5\n";
const END: StepPoint = StepPoint::new(8495, 1927);

/// A pin: its level, and when it rose, and where the motor came to by that.
#[derive(Clone, Debug, Default)]
struct Wire {
    now: Rc<Cell<Duration>>,
    high: Rc<Cell<bool>>,
    rises: Rc<RefCell<Vec<Duration>>>,
    /// Of a STEP wire: the DIR wire, and the motor's place.
    direction: Option<Rc<Cell<bool>>>,
    place: Rc<Cell<i32>>,
}

impl digital::ErrorType for Wire {
    type Error = Infallible;
}

impl OutputPin for Wire {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.high.set(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        if !self.high.replace(true) {
            self.rises.borrow_mut().push(self.now.get());
            let plus = self.direction.as_ref().is_some_and(|direction| direction.get());
            self.place.set(self.place.get() + if plus { 1 } else { -1 });
        }
        Ok(())
    }
}

type Motor = A4988<Wire, Wire, NoPin, NoPin>;

struct Board {
    now: Rc<Cell<Duration>>,
    motors: StepperAxes<Motor, Motor>,
    steps: [Wire; 2],
}

impl Board {
    fn new() -> Self {
        let now = Rc::new(Cell::new(Duration::ZERO));
        let motor = |axis| {
            let dir = Wire { now: now.clone(), ..Wire::default() };
            let step = Wire { now: now.clone(), direction: Some(dir.high.clone()), ..Wire::default() };
            (A4988::new(axis, step.clone(), dir, Timing::A4988), step)
        };
        let ((x, x_step), (y, y_step)) = (motor(Axis::X), motor(Axis::Y));
        let mut motors = StepperAxes::new(x, y);
        motors.start(Duration::ZERO).unwrap();
        Self { now, motors, steps: [x_step, y_step] }
    }

    fn wait(&self, time: Duration) -> Duration {
        self.now.set(self.now.get() + time);
        self.now.get()
    }

    /// Where the pins have taken the motors.
    fn place(&self) -> StepPoint {
        let [x, y] = &self.steps;
        StepPoint::new(x.place.get(), y.place.get())
    }

    /// The shortest time between two steps of a motor.
    fn shortest(&self) -> Duration {
        let shortest = |step: &Wire| {
            step.rises.borrow().windows(2).map(|pair| pair[1] - pair[0]).min().unwrap_or(Duration::MAX)
        };
        self.steps.iter().map(shortest).min().unwrap_or(Duration::MAX)
    }
}

fn settings() -> StepperPlotterSettings {
    StepperPlotterSettings { dialect: Dialect::Grbl, ..StepperPlotterSettings::default() }
}

/// A main loop of such turns, from the drawing's first byte until the machine is idle for a second.
fn draw(mut turn: impl FnMut(u32) -> Duration) -> (Board, StepperPlotter) {
    let (mut board, mut plotter) = (
        Board::new(),
        StepperPlotter::new(settings(), SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap(),
    );
    let mut now = board.wait(Duration::from_millis(5));
    for byte in DRAWING.bytes() {
        plotter.receive(now, byte);
    }
    let (mut turns, mut idle_since) = (0, now);
    while now < idle_since + Duration::from_secs(1) {
        now = board.wait(turn(turns));
        turns += 1;
        board.motors.tick(now).unwrap();
        while let Some(step) = plotter.poll(now, board.motors.drivers()) {
            board.motors.step(step.pulse, now).unwrap();
            idle_since = now;
        }
        while plotter.transmit(now).is_some() {}
        if plotter.due().is_some() {
            idle_since = now;
        }
    }
    (board, plotter)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn however_slow_the_loop_no_step_is_refused_or_lost() {
    for turn_us in [1, 50, 100, 300, 20_000] {
        let turn = Duration::from_micros(turn_us);
        let (board, plotter) = draw(|_| turn);
        assert_eq!(board.place(), plotter.position(), "{turn_us} us: what is counted has been made");
        assert_eq!(board.place(), END, "{turn_us} us: and all of it");
        let late = plotter.lateness();
        std::println!("{turn_us} us: {late:?}, least interval {:?}", board.shortest());
        assert_eq!(late.steps() > 0, late.greatest() > Lateness::ALLOWED, "{late:?}");
        assert_eq!(late.steps() > 0, turn_us >= 100, "{turn_us} us: {late:?}");
        assert!(
            board.shortest() >= turn.max(Duration::from_micros(2)),
            "{turn_us} us: {:?}",
            board.shortest()
        );
    }
}

#[test]
fn a_loop_that_stands_still_for_a_while_is_not_followed_by_a_burst() {
    /// Of the fastest steps: 8000 in a second.
    const FASTEST: Duration = Duration::from_micros(125);
    /// Turns of 5 us, and one of 20 ms in the middle of the long line.
    const TURN: Duration = Duration::from_micros(5);
    let pause = Duration::from_millis(20);
    let (board, plotter) = draw(|turn| if turn == 200_000 { pause } else { TURN });
    assert_eq!((board.place(), plotter.position()), (END, END));
    let late = plotter.lateness();
    assert_eq!(late.steps(), 1, "the rest is put off with it: {late:?}");
    assert!(late.greatest() <= pause + TURN && late.greatest() + FASTEST + TURN >= pause, "{late:?}");
    let least = FASTEST - Lateness::ALLOWED - 3 * TURN;
    assert!(board.shortest() >= least, "{:?}", board.shortest());
}

#[test]
fn a_motion_task_that_comes_late_loses_no_step_either() {
    for turn_us in [100, 300, 1_000] {
        let mut board = Board::new();
        let (mut receive, mut motion) = (
            Receive::new(settings()),
            Motion::new(settings(), SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap(),
        );
        let mut link = Link::default();
        let mut wire = DRAWING.bytes();
        for turn in 0..1_000_000_u32 {
            let now = board.wait(Duration::from_micros(turn_us));
            board.motors.tick(now).unwrap();
            while let Some(step) = motion.poll(now, board.motors.drivers(), &mut link) {
                board.motors.step(step.pulse, now).unwrap();
            }
            if turn % 10 == 0 {
                wire.by_ref().take(8).filter_map(|byte| receive.receive(byte)).for_each(drop);
                receive.work(&motion.status(now), &mut link);
                while receive.transmit().is_some() {}
            }
            if board.place() == END && motion.position() == END {
                break;
            }
        }
        assert_eq!((board.place(), motion.position()), (END, END), "{turn_us} us");
        assert!(motion.lateness().steps() > 0);
    }
}

#[test]
fn a_step_that_the_drivers_cannot_take_is_not_counted_and_stays_due() {
    let mut plotter =
        StepperPlotter::new(settings(), SafetyGate::new(LimitSwitches::RELEASED, false)).unwrap();
    let mut now = Duration::ZERO;
    for byte in "G0 X1\n".bytes() {
        plotter.receive(now, byte);
    }
    // Up to the first step.
    for _ in 0..100 {
        while plotter.transmit(now).is_some() {}
        assert_eq!(plotter.poll(now, Drivers::Busy), None);
        now = plotter.due().map_or(now, |due| due.max(now));
    }
    assert_eq!((plotter.position(), plotter.due()), (StepPoint::default(), Some(now)));
    let later = now + Duration::from_micros(40);
    assert_eq!(plotter.poll(later, Drivers::Busy), None);
    let step = plotter.poll(later, Drivers::Ready).unwrap();
    assert_eq!((step.at, plotter.position()), (now, StepPoint::new(1, 0)));
    assert_eq!(plotter.lateness(), Lateness::default(), "40 us are nothing");
}
