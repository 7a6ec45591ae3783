//! An STM32F411 at 84 MHz from its internal oscillator: Nucleo-F411RE, Black Pill.
//!
//! | pin | gantry | stepper plotter |
//! |---|---|---|
//! | PA2, PA3 | serial line, out and in (on the Nucleo the ST-LINK's) | the same |
//! | PA8, PA9 | enable of the x and y bridge, PWM of 2.5 kHz | servo of the pen, 50 Hz; laser, PWM of 1 kHz on PB0 |
//! | PB12, PB13 | x forward, reverse | x STEP, DIR |
//! | PB14, PB15 | y forward, reverse | y STEP, DIR |
//! | PB6, PB7 | x encoder A, B | limit switches x lower, upper |
//! | PB8, PB9 | y encoder A, B | limit switches y lower, upper |
//! | PA10 | emergency stop button, normally closed to ground | the same |
//! | PA5 | lamp: look at the machine (the Nucleo's LD2) | the same |
//! | PB10 | | ENABLE of both motor drivers |
//!
//! Every output needs a resistor to ground (ENABLE of the motor drivers: to 3.3 V) that holds it at rest
//! while the processor starts, or has stopped: its pins are inputs then.

pub mod alarm;
mod clock;
pub mod gantry;
mod line;
pub mod pins;
pub mod plotter;
mod setup;

use stm32f4xx_hal::pac;

/// The panic handler's part: all pins become inputs, and the resistors on the board switch everything off.
#[allow(unsafe_code, reason = "whoever owned the pins has panicked")]
pub fn make_safe(_info: &core::panic::PanicInfo<'_>) {
    cortex_m::interrupt::disable();
    // SAFETY: interrupts are off and nothing else runs any more.
    let peripherals = unsafe { pac::Peripherals::steal() };
    peripherals.RCC.ahb1rstr().write(|w| w.gpioarst().set_bit().gpiobrst().set_bit());
}
