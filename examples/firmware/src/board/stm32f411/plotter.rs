//! The stepper plotter's pins on the STM32F411.

use super::clock::Clock;
use super::line::Line;
use super::pins::{PinA, PinB};
use super::setup;
use crate::board::{Event, Notice, StepperPins, has_come};
use crate::machine;
use core::convert::Infallible;
use core::time::Duration;
use embedded_hal::digital::OutputPin as _;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use plotter_motion::firmware::stepper_plotter::Step;
use stm32f4xx_hal::pac::{self, IWDG, TIM1, TIM3};

/// The servo's frame of 20 ms, in steps of a microsecond.
pub const SERVO_STEPS: u16 = 20_000;
/// The laser's PWM: 1 kHz.
const LASER_PERIOD_US: u16 = 1_000;
/// A loop that does not come round in 100 ms is reset: this many of the watchdog's eighths of a millisecond.
const WATCHDOG_EIGHTHS: u16 = 800;

/// Pins of a motor's driver.
pub type Motor = StepperPins<PinB, PinB>;

/// All that the stepper plotter's firmware gets of its board.
pub struct Parts {
    /// The motor to the right.
    pub x: Motor,
    /// The motor up.
    pub y: Motor,
    /// ENABLE of both drivers.
    pub enable: PinB,
    /// Servo of the pen, 50 Hz.
    pub servo: Servo,
    /// Laser.
    pub laser: Laser,
    /// Limit switches, normally closed to ground: x lower, x upper, y lower, y upper.
    pub limits: [PinB; 4],
    /// The emergency stop button: normally closed to ground, so high is pressed.
    pub stop: PinA,
    /// The rest.
    pub rest: Rest,
}

/// The servo's pulses, in steps of a microsecond.
pub struct Servo(TIM1);

impl ErrorType for Servo {
    type Error = Infallible;
}

impl SetDutyCycle for Servo {
    fn max_duty_cycle(&self) -> u16 {
        SERVO_STEPS
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.ccr1().write(|w| w.ccr().set(duty));
        Ok(())
    }
}

/// The laser's pulses, in steps of a microsecond.
pub struct Laser(TIM3);

impl ErrorType for Laser {
    type Error = Infallible;
}

impl SetDutyCycle for Laser {
    fn max_duty_cycle(&self) -> u16 {
        LASER_PERIOD_US
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.0.ccr3().write(|w| w.ccr().set(duty));
        Ok(())
    }
}

/// What becomes the [`Board`].
pub struct Rest {
    board: Board,
    was_bitten: bool,
}

/// Takes the board; `None` the second time.
pub fn take() -> Option<Parts> {
    let pac::Peripherals { RCC, FLASH, GPIOA, GPIOB, TIM1, TIM2, TIM3, USART2, IWDG, .. } =
        pac::Peripherals::take()?;
    let was_bitten = RCC.csr().read().wdgrstf().bit_is_set();
    RCC.csr().modify(|_, w| w.rmvf().set_bit());
    setup::set_up_clocks(&FLASH, &RCC);
    setup::set_up_pins(&GPIOA, &GPIOB);
    setup::set_up_timers(&TIM1, &TIM3, &TIM2, SERVO_STEPS, LASER_PERIOD_US);
    setup::set_up_serial::<{ machine::PLOTTER_BAUD }>(&USART2);
    let motor = |step, dir| StepperPins { step: PinB::new(step), dir: PinB::new(dir) };
    Some(Parts {
        x: motor(12, 13),
        y: motor(14, 15),
        enable: PinB::new(10),
        servo: Servo(TIM1),
        laser: Laser(TIM3),
        limits: [6, 7, 8, 9].map(PinB::new),
        stop: PinA::new(10),
        rest: Rest {
            board: Board {
                clock: Clock::new(TIM2),
                line: Line::new(USART2),
                lamp: PinA::new(5),
                watchdog: IWDG,
            },
            was_bitten,
        },
    })
}

/// The machine.
pub struct Board {
    clock: Clock,
    line: Line,
    lamp: PinA,
    watchdog: IWDG,
}

impl Rest {
    /// Whether the watchdog has reset the processor.
    pub fn was_bitten(&self) -> bool {
        self.was_bitten
    }

    /// Starts the watchdog.
    pub fn start(self) -> Board {
        let watchdog = &self.board.watchdog;
        // It starts its own oscillator of 32 kHz, of which it takes a quarter.
        watchdog.kr().write(|w| w.key().start());
        watchdog.kr().write(|w| w.key().unlock());
        watchdog.pr().write(|w| w.pr().divide_by4());
        watchdog.rlr().write(|w| w.rl().set(WATCHDOG_EIGHTHS));
        watchdog.kr().write(|w| w.key().feed());
        self.board
    }
}

impl Board {
    /// The time.
    pub fn now(&mut self) -> Duration {
        Duration::from_micros(self.clock.now_us())
    }

    /// Waits for what comes first: something happens, or it is `due`.
    pub fn wait(&mut self, due: Option<Duration>) -> (Duration, Event) {
        loop {
            self.line.pump();
            let now = self.now();
            // A step that is due is not kept waiting by bytes.
            if due.is_some_and(|due| has_come(due, now)) {
                return (now, Event::Due);
            }
            if let Some(came) = self.line.receive() {
                return (now, came.map_or(Event::LineFault, Event::Byte));
            }
        }
    }

    /// Whether a byte can be sent.
    pub fn can_send(&self) -> bool {
        self.line.has_room()
    }

    /// Sends a byte to the host.
    pub fn send(&mut self, byte: u8) {
        self.line.send(byte);
    }

    /// A step that the motors got: nobody keeps account here.
    pub fn stepped(&mut self, _step: Step) {}

    /// Tells a person: the lamp is on until the machine is switched off.
    pub fn notify(&mut self, _notice: Notice) {
        // It cannot fail.
        let _ = self.lamp.set_high();
    }

    /// Keeps the watchdog from biting.
    pub fn feed_watchdog(&mut self) {
        self.watchdog.kr().write(|w| w.key().feed());
    }
}
