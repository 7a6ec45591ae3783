//! The stepper plotter's firmware in two halves: planning in the main loop, steps from the timer's interrupt.
//! No step is late, whatever the main loop does and however long it takes.
//!
//! The controller is `plotter_motion::firmware::StepperPlotter`, taken apart by its `split`.
#![no_std]
#![no_main]

use core::cell::RefCell;
use core::time::Duration;
use cortex_m::singleton;
use cortex_m_rt::entry;
use critical_section::Mutex;
use plotter_firmware::board::plotter::{Laser as LaserPin, Servo};
use plotter_firmware::board::{self, Event, Notice, alarm, pins::PinB};
use plotter_firmware::machine::{CHECKED_PLOTTER, LASER, StepperPlotter};
use plotter_firmware::stepper::{self, BUTTONS_KNOWN, ENDS, LOOK, PEN, STANDSTILL};
use plotter_hal::{
    EstopChange, EstopInput, Laser, LimitSwitch, LimitSwitchGroup, PenServo, StepperAxes, SwitchSettings,
};
use plotter_motion::SafetyGate;
use plotter_motion::firmware::stepper_plotter::{Host, Planning, Stepping, StepsAhead};
use plotter_motion::planner::Modes;
use plotter_motion::protocol::SUBSTITUTE;

/// Words between the halves, eight kilobytes: the steps of 37 mm along an axis, four words on sixteen of them
/// for what they have in common. This machine brakes within 5 mm from 45 mm/s, so the loop may be away for
/// more than half a second.
const WORDS: usize = 4096;
/// Most bytes of the half in the main loop: with the words, the interrupt's half and 2 KiB of stack it stays
/// below 16 KiB.
const PLANNING_BYTES: usize = 5 * 1024;

/// Whether the half in the main loop is no larger than that.
const fn is_small<H: Host, M: Modes>(_: &Planning<'_, H, M>) {
    const { assert!(size_of::<Planning<'_, H, M>>() <= PLANNING_BYTES, "it takes too much memory") }
}

type Motor = stepper::Motor<PinB, PinB, PinB>;

/// What the interrupt has.
struct Steps {
    stepping: Stepping<'static>,
    motors: StepperAxes<Motor, Motor>,
    servo: PenServo<Servo>,
    laser: Laser<LaserPin>,
    pen_deg: Option<u8>,
    /// The clock's time at the last call, which the drivers count on in 64 bits.
    now_us: u64,
    failed: bool,
}

impl Steps {
    /// What is due; gives when there is more.
    fn at_time(&mut self, now_32: u32) -> Option<u32> {
        self.now_us += u64::from(now_32.wrapping_sub(low_half(self.now_us)));
        let now = Duration::from_micros(self.now_us);
        let mut failed = self.motors.tick(now).is_err() | self.servo.tick(now).is_err();
        failed |= LASER && self.laser.tick(now).is_err();
        while let Some(pulse) = self.stepping.tick(now_32, self.motors.drivers()) {
            failed |= self.motors.step(pulse, now).is_err();
            failed |= LASER && self.laser.moved(now).is_err();
        }
        failed |= LASER && self.laser.shine(now, self.stepping.beam()).is_err();
        let deg = self.stepping.pen_deg();
        if self.pen_deg.replace(deg) != Some(deg) {
            failed |= self.servo.turn_to(now, f32::from(deg)).is_err();
        }
        if failed && !self.failed {
            // Nothing that cannot be trusted goes on.
            let _ = (self.motors.stop(), self.laser.off());
            self.stepping.emergency_stop(true);
            self.failed = true;
        }
        if self.failed {
            return None;
        }
        // A step that waits for the drivers is due when they are ready.
        let of_steps = if self.motors.is_waiting() { None } else { self.stepping.due() };
        let of_laser = if LASER { self.laser.due() } else { None };
        let others = [self.motors.due(), self.servo.due(), of_laser].into_iter().flatten();
        let of_others = others.map(|due| low_half(whole_us(due).saturating_sub(self.now_us)) + 1).min();
        let after_us = of_steps.map(|due| due.wrapping_sub(now_32));
        let after_us = after_us.into_iter().chain(of_others).min()?;
        Some(now_32.wrapping_add(after_us))
    }
}

/// What a clock of 32 bits shows.
const fn low_half(us: u64) -> u32 {
    (us & 0xFFFF_FFFF) as u32
}

/// A time in microseconds: `as_micros` reckons with 128 bits.
const fn whole_us(time: Duration) -> u64 {
    time.as_secs().saturating_mul(1_000_000).saturating_add(time.subsec_micros() as u64)
}

static STEPS: Mutex<RefCell<Option<Steps>>> = Mutex::new(RefCell::new(None));

fn at_time(now_us: u32) -> Option<u32> {
    critical_section::with(|cs| STEPS.borrow_ref_mut(cs).as_mut().and_then(|steps| steps.at_time(now_us)))
}

#[entry]
fn main() -> ! {
    let Some(parts) = board::plotter::take() else { board::halt() };
    let mut motors = stepper::motors([parts.x, parts.y], parts.enable);
    let laser = Laser::new(parts.laser, STANDSTILL);
    let Ok(servo) = PenServo::from_checked(parts.servo, PEN) else { board::halt() };
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
    let Some(memory) = singleton!(MEMORY: StepsAhead<WORDS> = StepsAhead::new()) else { board::halt() };
    let Ok(plotter) = StepperPlotter::from_checked(&CHECKED_PLOTTER, gate) else { board::halt() };
    let Ok((mut planning, stepping)) = plotter.split(memory) else { board::halt() };
    is_small(&planning);
    let steps = Steps { stepping, motors, servo, laser, pen_deg: None, now_us: 0, failed: false };
    critical_section::with(|cs| STEPS.borrow_ref_mut(cs).replace(steps));
    alarm::start(at_time);
    planning.emergency_stop(now, button.is_pressed());

    let mut look = now;
    loop {
        let more = planning.plan(now);
        // There may be a first step, or an order that must be carried out at once.
        alarm::ring();
        while board.can_send()
            && let Some(byte) = planning.transmit(now)
        {
            board.send(byte);
        }
        let due = if more { now } else { look };
        let event;
        (now, event) = board.wait(Some(due));
        match event {
            Event::Byte(byte) => planning.receive(now, byte),
            Event::LineFault => {
                board.notify(Notice::LineFault);
                planning.receive(now, SUBSTITUTE);
            }
            Event::Due | Event::Edge(..) => {}
            Event::EncoderFault => failed = true,
        }
        if board::has_come(look, now) {
            look = now.saturating_add(LOOK);
            board.feed_watchdog();
            let before = limits.limits();
            failed |= limits.tick(now).is_err();
            let after = limits.limits();
            for (axis, end) in ENDS {
                let pressed = after.blocks(axis, end);
                if pressed != before.blocks(axis, end) {
                    planning.limit_switch(now, axis, end, pressed);
                }
            }
            match button.tick(now) {
                Ok(None) => {}
                Ok(Some(_)) => planning.emergency_stop(now, button.is_pressed()),
                Err(_) => failed = true,
            }
            let steps_failed = critical_section::with(|cs| {
                STEPS.borrow_ref_mut(cs).as_mut().is_none_or(|steps| {
                    if failed && !steps.failed {
                        let _ = (steps.motors.stop(), steps.laser.off());
                        steps.stepping.emergency_stop(true);
                        steps.failed = true;
                    }
                    steps.failed
                })
            });
            if steps_failed {
                board.notify(Notice::PinFailed);
                board::halt();
            }
        }
    }
}
