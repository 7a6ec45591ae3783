//! Code that both firmwares of the stepper plotter share: the motors' drivers, the pen, the times.

use crate::board::plotter::SERVO_STEPS;
use crate::board::{StepperPins, Wire};
use crate::machine::PLOTTER;
use core::time::Duration;
use embedded_hal::digital::OutputPin;
use plotter_hal::a4988::Timing;
use plotter_hal::{A4988, CheckedPenServo, NoPin, PenServoSettings, StepperAxes};
use plotter_motion::{Axis, Direction};

/// How often the switches are looked at, and the watchdog is fed.
pub const LOOK: Duration = Duration::from_millis(1);
/// How long a laser may stay lit after a step: longer than from one step to the next, shorter than it takes
/// to burn.
pub const STANDSTILL: Duration = Duration::from_millis(20);
/// By then the switches have shown what they are.
pub const BUTTONS_KNOWN: Duration = Duration::from_millis(25);

/// The servo of the pen, looked at by the compiler: one that cannot be right does not get this far.
pub const PEN: CheckedPenServo =
    match PenServoSettings::DEFAULT.with_settle(PLOTTER.pen_settle).checked(SERVO_STEPS) {
        Ok(checked) => checked,
        Err(_) => panic!("no servo can be driven with them"),
    };

/// Where the limit switches are.
pub const ENDS: [(Axis, Direction); 4] = [
    (Axis::X, Direction::Minus),
    (Axis::X, Direction::Plus),
    (Axis::Y, Direction::Minus),
    (Axis::Y, Direction::Plus),
];

/// A motor's driver on its pins; ENABLE of both is one wire.
pub type Motor<Step, Dir, Enable> = A4988<Step, Dir, Wire<Enable>, NoPin>;

/// Both motors, turning as the machine's file says.
#[inline(always)] // in `main`, which it is a part of: elsewhere it is copied there
pub fn motors<Step: OutputPin, Dir: OutputPin, Enable: OutputPin>(
    [x, y]: [StepperPins<Step, Dir>; 2],
    enable: Enable,
) -> StepperAxes<Motor<Step, Dir, Enable>, Motor<Step, Dir, Enable>> {
    let inverted = [PLOTTER.stored.x_direction != 0, PLOTTER.stored.y_direction != 0];
    let x = A4988::new(Axis::X, x.step, x.dir, Timing::A4988);
    let y = A4988::new(Axis::Y, y.step, y.dir, Timing::A4988);
    let [x_enable, y_enable] = [Some(enable), None].map(Wire);
    let (x, y) = (x.with_enable(x_enable), y.with_enable(y_enable));
    let [x_inverted, y_inverted] = inverted;
    StepperAxes::new(
        if x_inverted { x.with_inverted_direction() } else { x },
        if y_inverted { y.with_inverted_direction() } else { y },
    )
}
