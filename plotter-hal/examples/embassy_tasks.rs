//! The drivers in asynchronous tasks, as with Embassy: four tasks of a pen plotter, none of which ever
//! blocks.
//!
//! The controller draws two lines of G-code that come over the serial line. One byte of the second line
//! arrives damaged, so that it is refused and the host sends it again; then somebody presses the emergency
//! stop while the pen is down. Look at the pen: it is lowered slowly, the motors wait for it, and the stop
//! lifts it within one period of the servo's pulse (20 ms).
//!
//! ```text
//! cargo run -p plotter-hal --example embassy_tasks
//! ```
//!
//! On a board the tasks stay as they are: `clock.until(at)` is `Timer::at(at)`, the cell with the controller
//! a `Mutex<ThreadModeRawMutex, RefCell<_>>`, and `#[embassy_executor::task]` and the spawner take the place
//! of [`run`]. Here the hardware is simulated, in the module `desk`, and the clock jumps to the next time
//! that a task waits for, so this runs at once and prints always the same.

mod desk;

use core::cell::{Cell, RefCell};
use core::future::Future;
use core::pin::{Pin, pin};
use core::task::{Context, Poll, Waker};
use core::time::Duration;
use desk::{Clock, Motors, Port, Pwm, Switch};
use plotter_hal::{
    EstopChange, EstopInput, LimitSwitch, LimitSwitchGroup, PenServo, PenServoSettings, SerialLine,
    SwitchSettings,
};
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::{Axis, Direction, SafetyGate};
use std::error::Error;

type Controller = RefCell<StepperPlotter>;
type Switches = LimitSwitchGroup<Switch, Switch, Switch, Switch>;

const MS: Duration = Duration::from_millis(1);
const US: Duration = Duration::from_micros(1);

/// Lines that the host sends, and when, ms. The `?` is a byte that arrives damaged.
const HOST_SENDS: [(u64, &str); 4] = [
    (40, "G21 G90 M5\n"),
    (60, "G0 X5 Y5\nM3\nG1 X15 Y5 F1200\n"),
    (1400, "G1 X1? Y15 F1200\n"),
    (1500, "G1 X15 Y15 F1200\n"),
];
/// Times at which the emergency stop is pressed and released, ms. Its contact bounces.
const STOP_MS: [(u64, u64); 3] = [(1800, 1802), (1804, 1805), (1807, 2100)];
/// Length of the story.
const RUN_FOR: Duration = Duration::from_millis(2400);

fn main() -> Result<(), Box<dyn Error>> {
    let time = Timer::default();
    let clock = time.clock.clone();
    // The servo's pulse: a period of 20,000 us, its width in whole microseconds.
    let pwm = Pwm { clock: clock.clone(), name: "servo", full: 20_000, duty: None, least_change: 1 };
    let pen = PenServo::new(pwm, PenServoSettings::default().with_lowering_deg_s(600.0))?;
    let settings = StepperPlotterSettings {
        dialect: Dialect::Grbl,
        pen_settle: pen.lowering_time(), // the controller waits for as long as the pen takes
        ..StepperPlotterSettings::default()
    };
    let button =
        EstopInput::new(Switch { clock: clock.clone(), high_ms: STOP_MS.into() }, SwitchSettings::default());
    let switch =
        || LimitSwitch::new(Switch { clock: clock.clone(), high_ms: vec![] }, SwitchSettings::default());
    let switches = LimitSwitchGroup { x_min: switch(), x_max: switch(), y_min: switch(), y_max: switch() };
    // Before the first task has run: nobody has looked at button and switches yet, so they count as pressed.
    let gate = SafetyGate::new(switches.limits(), button.is_pressed());
    let plotter = RefCell::new(StepperPlotter::new(settings, gate)?);

    let line = SerialLine::new(Port::new(&clock, &HOST_SENDS));
    let (mut motors, steps) = desk::motors();
    motors.start(clock.now())?;
    run(
        &time,
        [
            pin!(serial(&time, &plotter, line)),
            pin!(motion(&time, &plotter, motors)),
            pin!(servo(&time, &plotter, pen)),
            pin!(safety(&time, &plotter, button, switches)),
        ],
    );
    let at = plotter.borrow().position_mm();
    let [x, y] = steps.map(|pin| pin.rises());
    clock.say("at", &format!("({:.2}, {:.2}) mm after {x} and {y} steps", at.x, at.y));
    Ok(())
}

/// Hands bytes to the controller and sends its answers.
async fn serial(time: &Timer, plotter: &Controller, mut line: SerialLine<Port>) {
    loop {
        let now = time.clock.now();
        while let Some(received) = line.receive() {
            if let Some(fault) = received.fault {
                time.clock.say("serial", &fault.to_string());
            }
            plotter.borrow_mut().receive(now, received.byte);
        }
        if let Err(fault) = line.send(|| plotter.borrow_mut().transmit(now)) {
            time.clock.say("serial", &fault.to_string());
        }
        time.until(now + MS).await;
    }
}

/// Makes the controller's steps at their times.
async fn motion(time: &Timer, plotter: &Controller, mut motors: Motors) {
    let mut moving = false;
    loop {
        let now = time.clock.now();
        let mut steps = 0;
        let mut outcome = motors.tick(now);
        // A step for which the drivers are not ready stays due.
        while let Some(step) = plotter.borrow_mut().poll(now, motors.drivers()) {
            outcome = outcome.and(motors.step(step.pulse, now));
            steps += 1;
        }
        if let Err(error) = outcome {
            time.clock.say("motors", &error.to_string());
        }
        let due = plotter.borrow().due();
        // They stand if nothing is due within 20 ms.
        if moving != (steps > 0) && (steps > 0 || due.is_none_or(|due| due > now + MS * 20)) {
            moving = steps > 0;
            let at = plotter.borrow().position_mm();
            let what = if moving { "run from" } else { "stand at" };
            time.clock.say("motors", &format!("{what} ({:.2}, {:.2}) mm", at.x, at.y));
        }
        let next = [due, motors.due()].into_iter().flatten().min().unwrap_or(now + MS);
        time.until(next.clamp(now + US, now + MS)).await;
    }
}

/// Turns the pen's servo to where the controller wants it.
async fn servo(time: &Timer, plotter: &Controller, mut pen: PenServo<Pwm>) {
    let mut settled = false;
    loop {
        let now = time.clock.now();
        let wanted_deg = f32::from(plotter.borrow().pen_deg());
        if let Err(error) = pen.turn_to(now, wanted_deg) {
            time.clock.say("pen", &error.to_string()); // it is tried again in a millisecond
        }
        if core::mem::replace(&mut settled, pen.is_settled()) != settled && settled {
            time.clock.say("pen", &format!("settled at {wanted_deg} deg"));
        }
        time.until(now + MS).await;
    }
}

/// Tells the controller of emergency stop and limit switches, every millisecond.
async fn safety(time: &Timer, plotter: &Controller, mut button: EstopInput<Switch>, mut switches: Switches) {
    loop {
        check_safety_inputs(&time.clock, &mut plotter.borrow_mut(), &mut button, &mut switches);
        time.until(time.clock.now() + MS).await;
    }
}

fn check_safety_inputs(
    clock: &Clock,
    plotter: &mut StepperPlotter,
    button: &mut EstopInput<Switch>,
    switches: &mut Switches,
) {
    let now = clock.now();
    let change = button.tick(now);
    plotter.emergency_stop(now, button.is_pressed());
    match change {
        Ok(Some(EstopChange::FreeSinceStart)) => {
            clock.say("button", "free since the start: ready");
            plotter.restart(now); // it has refused everything so far, for the button counted as pressed
        }
        Ok(Some(change)) => clock.say("button", &format!("{change:?}")),
        Ok(None) => {}
        Err(error) => clock.say("button", &error.to_string()),
    }
    if let Err(error) = switches.tick(now) {
        clock.say("switches", &error.to_string());
    }
    let limits = switches.limits();
    for axis in Axis::BOTH {
        for end in [Direction::Minus, Direction::Plus] {
            plotter.limit_switch(now, axis, end, limits.blocks(axis, end));
        }
    }
}

/// A clock, and the next time that a task waits for.
#[derive(Debug, Default)]
struct Timer {
    clock: Clock,
    next: Cell<Option<Duration>>,
}

impl Timer {
    async fn until(&self, at: Duration) {
        core::future::poll_fn(|_| {
            if self.clock.now() >= at {
                return Poll::Ready(());
            }
            self.next.set(Some(self.next.get().map_or(at, |next| next.min(at))));
            Poll::Pending
        })
        .await;
    }
}

/// Calls all tasks at the times that they wait for, until [`RUN_FOR`] is over.
fn run(time: &Timer, mut tasks: [Pin<&mut dyn Future<Output = ()>>; 4]) {
    let mut context = Context::from_waker(Waker::noop());
    while time.clock.now() < RUN_FOR {
        time.next.set(None);
        for task in &mut tasks {
            let _ = task.as_mut().poll(&mut context);
        }
        let Some(next) = time.next.get() else { return };
        time.clock.set(next);
    }
}
