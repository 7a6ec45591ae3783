//! The stepper plotter's pins on the STM32F411.

use super::clock::Clock;
use super::line::Line;
use crate::board::{Event, Notice, StepperPins};
use crate::machine;
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::Step;
use stm32f4xx_hal::gpio::{ErasedPin, Input, Output};
use stm32f4xx_hal::pac::{self, TIM1, TIM3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::serial;
use stm32f4xx_hal::timer::ErasedChannel;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// The servo's frame: 20 ms, in steps of a microsecond.
const SERVO_FRAME_MS: u32 = 20;
/// The laser's PWM: 1 kHz, in steps of a microsecond.
const LASER_PERIOD_US: u32 = 1_000;
/// A loop that does not come round in this time is reset.
const WATCHDOG_MS: u32 = 100;

/// Pins of a motor's driver.
pub type Motor = StepperPins<ErasedPin<Output>, ErasedPin<Output>>;

/// All that the stepper plotter's firmware gets of its board.
pub struct Parts {
    /// The motor to the right.
    pub x: Motor,
    /// The motor up.
    pub y: Motor,
    /// ENABLE of both drivers.
    pub enable: ErasedPin<Output>,
    /// Servo of the pen, 50 Hz.
    pub servo: ErasedChannel<TIM1>,
    /// Laser.
    pub laser: ErasedChannel<TIM3>,
    /// Limit switches, normally closed to ground: x lower, x upper, y lower, y upper.
    pub limits: [ErasedPin<Input>; 4],
    /// The emergency stop button: normally closed to ground, so high is pressed.
    pub stop: ErasedPin<Input>,
    /// The rest.
    pub rest: Rest,
}

/// What becomes the [`Board`].
pub struct Rest {
    board: Board,
    was_bitten: bool,
}

/// Takes the board; `None` the second time.
pub fn take() -> Option<Parts> {
    let peripherals = pac::Peripherals::take()?;
    let was_bitten = peripherals.RCC.csr().read().wdgrstf().bit_is_set();
    peripherals.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    let mut rcc = peripherals.RCC.freeze(Config::hsi().sysclk(84.MHz()));
    let a = peripherals.GPIOA.split(&mut rcc);
    let b = peripherals.GPIOB.split(&mut rcc);

    let (_, (servo, ..)) = peripherals.TIM1.pwm_us((SERVO_FRAME_MS * 1_000).micros(), &mut rcc);
    let (_, (_, _, laser, ..)) = peripherals.TIM3.pwm_us(LASER_PERIOD_US.micros(), &mut rcc);
    let (mut servo, mut laser) = (servo.with(a.pa8), laser.with(b.pb0));
    servo.enable();
    laser.enable();

    let mut clock = peripherals.TIM2.counter_us(&mut rcc);
    clock.start(u32::MAX.micros()).ok()?;
    let config = serial::Config::default().baudrate(machine::PLOTTER_BAUD.bps());
    let (tx, rx) = serial::Serial::new(peripherals.USART2, (a.pa2, a.pa3), config, &mut rcc).ok()?.split();
    let mut enable = b.pb10.into_push_pull_output();
    enable.set_high();
    let motor = |step, dir| StepperPins { step, dir };
    Some(Parts {
        x: motor(b.pb12.into_push_pull_output().erase(), b.pb13.into_push_pull_output().erase()),
        y: motor(b.pb14.into_push_pull_output().erase(), b.pb15.into_push_pull_output().erase()),
        enable: enable.erase(),
        servo: servo.erase(),
        laser: laser.erase(),
        limits: [
            b.pb6.into_pull_up_input().erase(),
            b.pb7.into_pull_up_input().erase(),
            b.pb8.into_pull_up_input().erase(),
            b.pb9.into_pull_up_input().erase(),
        ],
        stop: a.pa10.into_pull_up_input().erase(),
        rest: Rest {
            board: Board {
                clock: Clock::new(clock),
                line: Line::new(tx, rx),
                lamp: a.pa5.into_push_pull_output().erase(),
                watchdog: IndependentWatchdog::new(peripherals.IWDG),
            },
            was_bitten,
        },
    })
}

/// The machine.
pub struct Board {
    clock: Clock,
    line: Line,
    lamp: ErasedPin<Output>,
    watchdog: IndependentWatchdog,
}

impl Rest {
    /// Whether the watchdog has reset the processor.
    pub fn was_bitten(&self) -> bool {
        self.was_bitten
    }

    /// Starts the watchdog.
    pub fn start(mut self) -> Board {
        self.board.watchdog.start(WATCHDOG_MS.millis());
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
            if due.is_some_and(|due| now >= due) {
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
        self.lamp.set_high();
    }

    /// Keeps the watchdog from biting.
    pub fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }
}
