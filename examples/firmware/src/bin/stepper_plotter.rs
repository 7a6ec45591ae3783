//! The stepper plotter's firmware: Grbl's language on the serial line, two stepper motors, a pen on a servo,
//! a laser.
//!
//! The controller is `plotter_motion::firmware::StepperPlotter`, the drivers are those of `plotter-hal`.
#![no_std]
#![no_main]

use cortex_m::singleton;
use cortex_m_rt::entry;
use plotter_firmware::board::{self, Event, Notice};
use plotter_firmware::machine::{CHECKED_PLOTTER, LASER, StepperPlotter};
use plotter_firmware::stepper::{self, BUTTONS_KNOWN, ENDS, LOOK, PEN, STANDSTILL};
use plotter_hal::{EstopChange, EstopInput, Laser, LimitSwitch, LimitSwitchGroup, PenServo, SwitchSettings};
use plotter_motion::SafetyGate;
use plotter_motion::firmware::stepper_plotter::SettingsError;
use plotter_motion::protocol::SUBSTITUTE;

type Controller = Result<StepperPlotter, SettingsError>;

/// The controller, where it stays. By itself, so that the stack is free again of what it takes to put it
/// there.
#[inline(never)]
fn controller(gate: SafetyGate) -> Option<&'static mut StepperPlotter> {
    singleton!(CELL: Controller = StepperPlotter::from_checked(&CHECKED_PLOTTER, gate))?.as_mut().ok()
}

#[entry]
fn main() -> ! {
    let Some(parts) = board::plotter::take() else { board::halt() };
    let mut motors = stepper::motors([parts.x, parts.y], parts.enable);
    // Off from here on, also where there is none.
    let mut laser = Laser::new(parts.laser, STANDSTILL);
    let Ok(mut servo) = PenServo::from_checked(parts.servo, PEN) else { board::halt() };
    let switch = SwitchSettings::default();
    let [x_min, x_max, y_min, y_max] = parts.limits.map(|pin| LimitSwitch::new(pin, switch));
    let mut limits = LimitSwitchGroup { x_min, x_max, y_min, y_max };
    let mut button = EstopInput::new(parts.stop, switch);
    let was_bitten = parts.rest.was_bitten();
    let mut board = parts.rest.start();

    // Nothing is promised to a host before it is known what the switches say.
    let began = board.now();
    let mut failed = motors.start(began).is_err();
    let mut free = false;
    let mut now = began;
    while !board::has_come(began.saturating_add(BUTTONS_KNOWN), now) {
        failed |= limits.tick(now).is_err();
        match button.tick(now) {
            Ok(change) => free |= change == Some(EstopChange::FreeSinceStart),
            Err(_) => failed = true,
        }
        (now, _) = board.wait(Some(now.saturating_add(LOOK)));
    }
    if was_bitten {
        // Where the motors stand is not known: a person looks first, and says so by `$X` or by homing.
        board.notify(Notice::Bitten);
    }
    let gate = SafetyGate::new(limits.limits(), was_bitten || !free);
    let Some(plotter) = controller(gate) else { board::halt() };
    plotter.emergency_stop(now, button.is_pressed());

    let mut pen_deg = None;
    let mut look = now;
    // The controller is asked when something came for it, and when it is due: neither sooner nor later.
    let mut asked = true;
    loop {
        if asked {
            // What they have no room for stays due, and is not counted.
            while let Some(step) = plotter.poll(now, motors.drivers()) {
                failed |= motors.step(step.pulse, now).is_err();
                failed |= LASER && laser.moved(now).is_err();
                board.stepped(step);
            }
            failed |= LASER && laser.shine(now, plotter.beam()).is_err();
            if pen_deg.replace(plotter.pen_deg()) != Some(plotter.pen_deg()) {
                failed |= servo.turn_to(now, f32::from(plotter.pen_deg())).is_err();
            }
        }
        // A long answer goes on whenever there is room for more of it.
        while board.can_send()
            && let Some(byte) = plotter.transmit(now)
        {
            board.send(byte);
        }
        if failed {
            // Nothing that cannot be trusted goes on: all is switched off until the machine is.
            let _ = (motors.stop(), laser.off());
            board.notify(Notice::PinFailed);
            board::halt();
        }
        let mut due = look;
        let of_laser = if LASER { laser.due() } else { None };
        // A step that waits for the drivers is due when they are ready.
        let of_plotter = if motors.is_waiting() { None } else { plotter.due() };
        for other in [of_plotter, motors.due(), servo.due(), of_laser] {
            due = other.map_or(due, |other| if board::has_come(other, due) { other } else { due });
        }
        let event;
        (now, event) = board.wait(Some(due));
        asked = true;
        match event {
            Event::Byte(byte) => plotter.receive(now, byte),
            Event::LineFault => {
                board.notify(Notice::LineFault);
                plotter.receive(now, SUBSTITUTE);
            }
            Event::Due | Event::Edge(..) => {
                asked = plotter.due().is_some_and(|due| board::has_come(due, now))
            }
            Event::EncoderFault => failed = true,
        }
        failed |= motors.tick(now).is_err() | servo.tick(now).is_err();
        failed |= LASER && laser.tick(now).is_err();
        if board::has_come(look, now) {
            look = now.saturating_add(LOOK);
            board.feed_watchdog();
            let before = limits.limits();
            failed |= limits.tick(now).is_err();
            let after = limits.limits();
            for (axis, end) in ENDS {
                let pressed = after.blocks(axis, end);
                if pressed != before.blocks(axis, end) {
                    plotter.limit_switch(now, axis, end, pressed);
                    asked = true;
                }
            }
            match button.tick(now) {
                Ok(None) => {}
                Ok(Some(_)) => {
                    plotter.emergency_stop(now, button.is_pressed());
                    asked = true;
                }
                Err(_) => failed = true,
            }
        }
    }
}
