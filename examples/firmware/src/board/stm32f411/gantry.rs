//! The gantry's pins on the STM32F411.

use super::clock::Clock;
use super::line::Line;
use crate::board::{Event, MotorPins, Notice};
use crate::machine;
use core::cell::{Cell, RefCell};
use core::time::Duration;
use critical_section::Mutex;
use heapless::spsc::Queue;
use plotter_hal::Quadrature;
use plotter_motion::{Axis, Direction};
use stm32f4xx_hal::gpio::{Edge, ErasedPin, Input, Output};
use stm32f4xx_hal::pac::{self, EXTI, Interrupt, TIM1, interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use stm32f4xx_hal::serial;
use stm32f4xx_hal::timer::ErasedChannel;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// Ticks of the PWM's timer a second: 4800 steps in a period of 400 us.
const PWM_TICKS_HZ: u32 = 12_000_000;
/// The thesis' 2.5 kHz.
const PWM_PERIOD_US: u32 = 400;
/// A loop that does not come round in this time is reset: some of the position loop's periods.
const WATCHDOG_MS: u32 = 100;
/// Edges that may wait: of a shaft at full speed those of 5 ms.
const MOST_EDGES: usize = 32;

/// Pins of a motor.
pub type Motor = MotorPins<ErasedChannel<TIM1>, ErasedPin<Output>, ErasedPin<Output>>;
/// The encoder of an axis.
pub type Encoder = Quadrature<ErasedPin<Input>, ErasedPin<Input>>;

/// All that the gantry's firmware gets of its board.
pub struct Parts {
    /// The motor to the right.
    pub x: Motor,
    /// The motor up.
    pub y: Motor,
    /// Phases A and B of the encoder of x.
    pub x_phases: (ErasedPin<Input>, ErasedPin<Input>),
    /// Those of y.
    pub y_phases: (ErasedPin<Input>, ErasedPin<Input>),
    /// The emergency stop button: normally closed to ground, so high is pressed.
    pub stop: ErasedPin<Input>,
    /// The rest.
    pub rest: Rest,
}

/// What becomes the [`Board`].
pub struct Rest {
    clock: Clock,
    line: Line,
    lamp: ErasedPin<Output>,
    watchdog: IndependentWatchdog,
    exti: EXTI,
    was_bitten: bool,
}

/// Takes the board; `None` the second time.
pub fn take() -> Option<Parts> {
    let mut peripherals = pac::Peripherals::take()?;
    let was_bitten = peripherals.RCC.csr().read().wdgrstf().bit_is_set();
    peripherals.RCC.csr().modify(|_, w| w.rmvf().set_bit());
    let mut rcc = peripherals.RCC.freeze(Config::hsi().sysclk(84.MHz()));
    let a = peripherals.GPIOA.split(&mut rcc);
    let b = peripherals.GPIOB.split(&mut rcc);

    let (_, (x_enable, y_enable, ..)) =
        peripherals.TIM1.pwm::<PWM_TICKS_HZ>(PWM_PERIOD_US.micros(), &mut rcc);
    let (mut x_enable, mut y_enable) = (x_enable.with(a.pa8), y_enable.with(a.pa9));
    x_enable.enable();
    y_enable.enable();

    let mut clock = peripherals.TIM2.counter_us(&mut rcc);
    clock.start(u32::MAX.micros()).ok()?;
    let clock = clock.release().release();
    let config = serial::Config::default().baudrate(machine::BAUD.bps());
    let (port, _) =
        serial::Serial::<_, u8>::new(peripherals.USART2, (a.pa2, a.pa3), config, &mut rcc).ok()?.release();

    // Both edges of both phases of both encoders: lines 6 to 9, which share an interrupt.
    let mut syscfg = peripherals.SYSCFG.constrain(&mut rcc);
    let exti = &mut peripherals.EXTI;
    let mut phases = [
        b.pb6.into_pull_up_input().erase(),
        b.pb7.into_pull_up_input().erase(),
        b.pb8.into_pull_up_input().erase(),
        b.pb9.into_pull_up_input().erase(),
    ];
    for pin in &mut phases {
        pin.make_interrupt_source(&mut syscfg);
        pin.trigger_on_edge(exti, Edge::RisingFalling);
        pin.enable_interrupt(exti);
    }
    let [xa, xb, ya, yb] = phases;
    Some(Parts {
        x: MotorPins {
            enable: x_enable.erase(),
            forward: b.pb12.into_push_pull_output().erase(),
            reverse: b.pb13.into_push_pull_output().erase(),
        },
        y: MotorPins {
            enable: y_enable.erase(),
            forward: b.pb14.into_push_pull_output().erase(),
            reverse: b.pb15.into_push_pull_output().erase(),
        },
        x_phases: (xa, xb),
        y_phases: (ya, yb),
        stop: a.pa10.into_pull_up_input().erase(),
        rest: Rest {
            clock: Clock::new(clock),
            line: Line::new(port),
            lamp: a.pa5.into_push_pull_output().erase(),
            watchdog: IndependentWatchdog::new(peripherals.IWDG),
            exti: peripherals.EXTI,
            was_bitten,
        },
    })
}

/// What the encoders' interrupt shares with the loop.
struct Encoders {
    exti: EXTI,
    clock: Clock,
    encoders: [Encoder; 2],
    /// An edge found no room, or a pin no reader.
    failed: bool,
}

static ENCODERS: Mutex<RefCell<Option<Encoders>>> = Mutex::new(RefCell::new(None));

/// What they counted, and when. By itself, so that its memory is cleared at the start and not copied from
/// flash.
static EDGES: Mutex<RefCell<Queue<(u64, Axis, Direction), MOST_EDGES>>> =
    Mutex::new(RefCell::new(Queue::new()));

/// What the program calls at an edge: only one that has encoders carries what that takes.
static AT_EDGE: Mutex<Cell<Option<fn()>>> = Mutex::new(Cell::new(None));

#[interrupt]
fn EXTI9_5() {
    if let Some(at_edge) = critical_section::with(|cs| AT_EDGE.borrow(cs).get()) {
        at_edge();
    }
}

fn count_edges() {
    critical_section::with(|cs| {
        if let Some(shared) = ENCODERS.borrow_ref_mut(cs).as_mut() {
            // First, so that an edge from here on comes again.
            shared.exti.pr().write(|w| {
                w.pr6()
                    .clear_bit_by_one()
                    .pr7()
                    .clear_bit_by_one()
                    .pr8()
                    .clear_bit_by_one()
                    .pr9()
                    .clear_bit_by_one()
            });
            let now_us = shared.clock.now_us();
            let mut edges = EDGES.borrow_ref_mut(cs);
            for (encoder, axis) in shared.encoders.iter_mut().zip(Axis::BOTH) {
                let full = match encoder.poll() {
                    Ok(None) => false,
                    Ok(Some(direction)) => edges.enqueue((now_us, axis, direction)).is_err(),
                    Err(_) => true,
                };
                shared.failed |= full;
            }
        }
    });
}

/// The machine.
pub struct Board {
    line: Line,
    lamp: ErasedPin<Output>,
    watchdog: IndependentWatchdog,
    /// Times never go back, though an interrupt's may be earlier than what the loop has read.
    last: Duration,
}

impl Rest {
    /// Whether the watchdog has reset the processor.
    pub fn was_bitten(&self) -> bool {
        self.was_bitten
    }

    /// Starts the watchdog, and the encoders on their pins' interrupts.
    pub fn start(self, mut x: Encoder, mut y: Encoder) -> Board {
        let Self { clock, line, lamp, mut watchdog, exti, .. } = self;
        // Where the shafts stand.
        let failed = x.poll().is_err() | y.poll().is_err();
        critical_section::with(|cs| {
            ENCODERS.borrow_ref_mut(cs).replace(Encoders { exti, clock, encoders: [x, y], failed });
        });
        critical_section::with(|cs| AT_EDGE.borrow(cs).set(Some(count_edges)));
        unmask(Interrupt::EXTI9_5);
        watchdog.start(WATCHDOG_MS.millis());
        Board { line, lamp, watchdog, last: Duration::ZERO }
    }
}

/// Lets an interrupt through.
#[allow(unsafe_code, reason = "the crate cannot know that no lock is built on masking it")]
pub(super) fn unmask(interrupt: Interrupt) {
    // SAFETY: what an interrupt shares with the loop is behind a critical section, none of which is open
    // here.
    unsafe { cortex_m::peripheral::NVIC::unmask(interrupt) };
}

impl Board {
    /// The time.
    pub fn now(&mut self) -> Duration {
        let now_us = critical_section::with(|cs| {
            ENCODERS.borrow_ref_mut(cs).as_mut().map(|shared| shared.clock.now_us())
        });
        self.last = now_us.map_or(self.last, Duration::from_micros).max(self.last);
        self.last
    }

    /// Waits for what comes first: something happens, or it is `due`.
    pub fn wait(&mut self, due: Option<Duration>) -> (Duration, Event) {
        loop {
            self.line.pump();
            let edge = critical_section::with(|cs| {
                let failed = ENCODERS.borrow_ref(cs).as_ref().is_none_or(|shared| shared.failed);
                (failed, EDGES.borrow_ref_mut(cs).dequeue())
            });
            match edge {
                (_, Some((at_us, axis, direction))) => {
                    self.last = Duration::from_micros(at_us).max(self.last);
                    return (self.last, Event::Edge(axis, direction));
                }
                (true, None) => return (self.now(), Event::EncoderFault),
                (false, None) => {}
            }
            if let Some(came) = self.line.receive() {
                return (self.now(), came.map_or(Event::LineFault, Event::Byte));
            }
            let now = self.now();
            if due.is_some_and(|due| now >= due) {
                return (now, Event::Due);
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

    /// Tells a person: the lamp is on until the machine is switched off.
    pub fn notify(&mut self, _notice: Notice) {
        self.lamp.set_high();
    }

    /// Keeps the watchdog from biting.
    pub fn feed_watchdog(&mut self) {
        self.watchdog.feed();
    }
}
