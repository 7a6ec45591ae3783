//! The drivers in interrupts, as with RTIC: three of a laser plotter, each of which does its bit and returns.
//!
//! The controller burns two lines that come over the serial line. In the middle of the second one the switch
//! at the right end is pressed: the step that would lead farther into it is not made, and in its place the
//! laser goes dark. Look at its duty, which follows the speed: it grows as the machine accelerates and fades
//! as it brakes.
//!
//! ```text
//! cargo run -p plotter-hal --example rtic_style
//! ```
//!
//! With RTIC the struct [`Shared`] gets `#[shared]`, the three functions
//! `#[task(binds = .., priority = ..)]`, and the hardware the part of [`main`] that calls whichever is due
//! next; what they do stays as it is. The highest priority makes the steps: whatever else goes on, they come
//! in time.

mod desk;

use core::time::Duration;
use desk::{Clock, Line, Motors, Port, Pwm, Switch};
use plotter_hal::{Laser, LimitSwitch, LimitSwitchGroup, SerialLine, SwitchSettings};
use plotter_motion::firmware::StepperPlotter;
use plotter_motion::firmware::stepper_plotter::{Dialect, StepperPlotterSettings};
use plotter_motion::{Axis, Direction, SafetyGate};
use std::error::Error;

/// What more than one interrupt uses. RTIC locks it.
struct Shared {
    plotter: StepperPlotter,
    motors: Motors,
    laser: Laser<Pwm>,
}

type Switches = LimitSwitchGroup<Switch, Switch, Switch, Switch>;

const MS: Duration = Duration::from_millis(1);

/// What the host sends, and when, ms.
const HOST: [(u64, &str); 2] = [(40, "G21 G90 M3 S1000\nG1 X10 Y5 F1200\n"), (900, "G1 X40 Y5 F1800\n")];
/// When the switch at the right end is pressed, ms.
const RIGHT_END_MS: (u64, u64) = (1700, 3000);
const END: Duration = Duration::from_millis(2000);
/// No step is longer than this in a line (see [`Laser::new`]).
const LASER_TIMEOUT: Duration = Duration::from_millis(20);

/// The timer's compare interrupt, priority 3: the steps that are due, and the laser with each of them. Says
/// when it wants to be called again.
fn timer(shared: &mut Shared, clock: &Clock) -> Duration {
    let now = clock.now();
    let Shared { plotter, motors, laser } = shared;
    tell(clock, motors.tick(now));
    // A step for which the drivers are not ready stays due.
    while let Some(step) = plotter.poll(now, motors.drivers()) {
        tell(clock, motors.step(step.pulse, now));
        tell(clock, laser.moved(now));
    }
    tell(clock, laser.shine(now, plotter.beam()));
    let due = [plotter.due(), motors.due()].into_iter().flatten().min();
    due.unwrap_or(now + MS).max(now + Duration::from_micros(1)).min(now + MS)
}

/// The serial port's interrupt, priority 2: a byte has come, or there is room for one.
fn usart(shared: &mut Shared, clock: &Clock, line: &mut SerialLine<Port>) -> Duration {
    let now = clock.now();
    while let Some(received) = line.receive() {
        if let Some(fault) = received.fault {
            clock.say("serial", &fault.to_string());
        }
        shared.plotter.receive(now, received.byte);
    }
    if let Err(fault) = line.send(|| shared.plotter.transmit(now)) {
        clock.say("serial", &fault.to_string());
    }
    now + MS / 10
}

/// The millisecond's interrupt, priority 1: the switches, and a laser that stands still is put out.
fn millisecond(shared: &mut Shared, clock: &Clock, switches: &mut Switches) -> Duration {
    let now = clock.now();
    let before = switches.limits();
    if let Err(error) = switches.tick(now) {
        clock.say("switches", &error.to_string());
    }
    let limits = switches.limits();
    if limits != before {
        clock.say(
            "switches",
            &format!("x {} {}, y {} {}", limits.x_min, limits.x_max, limits.y_min, limits.y_max),
        );
    }
    for axis in Axis::BOTH {
        for end in [Direction::Minus, Direction::Plus] {
            shared.plotter.limit_switch(now, axis, end, limits.blocks(axis, end));
        }
    }
    tell(clock, shared.laser.tick(now));
    now + MS
}

fn tell<E: std::fmt::Display>(clock: &Clock, result: Result<(), E>) {
    if let Err(error) = result {
        clock.say("fault", &error.to_string());
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let clock = Clock::default();
    let settings =
        StepperPlotterSettings { dialect: Dialect::Grbl, laser: true, ..StepperPlotterSettings::default() };
    let pwm = Pwm { clock: clock.clone(), name: "laser", full: 999, duty: None, least_change: 150 };
    let (mut motors, steps) = desk::motors();
    motors.start(clock.now())?;
    let mut line = SerialLine::new(Port::new(&clock, &HOST));
    let switch =
        |high_ms| LimitSwitch::new(Switch { clock: clock.clone(), high_ms }, SwitchSettings::default());
    let mut switches = LimitSwitchGroup {
        x_min: switch(vec![]),
        x_max: switch(vec![RIGHT_END_MS]),
        y_min: switch(vec![]),
        y_max: switch(vec![]),
    };
    // Nobody has looked at the switches yet, so they count as pressed; there is no button.
    let plotter = StepperPlotter::new(settings, SafetyGate::new(switches.limits(), false))?;
    let mut shared = Shared { plotter, motors, laser: Laser::new(pwm, LASER_TIMEOUT) };

    // The interrupt controller: the next one that is due, and of two at the same time the one with the higher
    // priority.
    let mut due = [Duration::ZERO; 3];
    while let Some((priority, &at)) =
        due.iter().enumerate().rev().min_by_key(|(_, at)| **at).filter(|(_, at)| **at < END)
    {
        clock.set(at);
        let next = match priority {
            2 => timer(&mut shared, &clock),
            1 => usart(&mut shared, &clock, &mut line),
            _ => millisecond(&mut shared, &clock, &mut switches),
        };
        due[priority] = next;
    }
    let at = shared.plotter.position_mm();
    let [x, y] = steps.map(|line| Line::rises(&line));
    clock.say("at", &format!("({:.2}, {:.2}) mm after {x} and {y} steps", at.x, at.y));
    clock.say("late", &format!("{} steps", shared.plotter.lateness().steps()));
    Ok(())
}
