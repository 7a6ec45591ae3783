//! The drivers of `plotter-hal` with the types of `stm32f4xx-hal`, for an STM32F4. Compiled and never run.
//!
//! The crate's transmitters implement `embedded-io` 0.6, its receivers do not.

use core::time::Duration;
use plotter_hal::a4988::Timing;
use plotter_hal::plotter_motion::{Axis, config::Decoding};
use plotter_hal::serial_line::{Fault, Io06Port, NbPort, Received};
use plotter_hal::{
    A4988, EstopInput, HBridge, Quadrature, SerialLine, SerialRx, SerialTx, StepperAxes, SwitchSettings,
    Tmc2209, tmc2209,
};
use stm32f4xx_hal::gpio::{ErasedPin, Input, Output};
use stm32f4xx_hal::pac::{TIM1, USART2};
use stm32f4xx_hal::serial::{Rx, Serial, Tx};
use stm32f4xx_hal::timer::{ErasedChannel, SysDelay};

/// Receives a byte and sends what `next_byte` gives, by a port that is not split.
pub fn whole_port(
    port: Serial<USART2>,
    next_byte: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut line = SerialLine::new(NbPort::new(port));
    (line.receive(), line.send(next_byte))
}

/// The same by a port that is split into receiver and transmitter, with a queue of 8 bytes for what is sent.
pub fn split_port(
    rx: Rx<USART2>,
    tx: Tx<USART2>,
    next_byte: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(NbPort::new(tx));
    (SerialRx::new(NbPort::new(rx)).receive(), tx.send(next_byte))
}

/// Sends by `embedded-io` 0.6. A busy transmitter takes nothing and does not wait.
pub fn send(tx: Tx<USART2>, next_byte: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
    let mut tx: SerialTx<_> = SerialTx::new(Io06Port::new(tx));
    tx.queue(next_byte);
    tx.write_queued()
}

/// Configures a TMC2209 that has a serial port to itself.
pub fn configure_tmc2209(port: Serial<USART2>, mut delay: SysDelay) -> Result<(), tmc2209::Error> {
    Tmc2209::new(NbPort::new(port), 0).configure(&tmc2209::Settings::default(), &mut delay)
}

/// Starts two step/dir drivers; returns whether all pins obeyed.
pub fn start_steppers(
    x: [ErasedPin<Output>; 2],
    y: [ErasedPin<Output>; 2],
    enable: ErasedPin<Output>,
    mut delay: SysDelay,
) -> bool {
    let ([x_step, x_dir], [y_step, y_dir]) = (x, y);
    let x = A4988::new(Axis::X, x_step, x_dir, Timing::TMC2209).with_enable(enable);
    let y = A4988::new(Axis::Y, y_step, y_dir, Timing::TMC2209);
    StepperAxes::new(x, y).start_blocking(&mut delay).is_ok()
}

/// Starts a DC motor and reads its encoder; returns whether all pins obeyed.
pub fn start_dc_motor(
    enable: ErasedChannel<TIM1>,
    [a, b]: [ErasedPin<Output>; 2],
    [phase_a, phase_b]: [ErasedPin<Input>; 2],
) -> bool {
    let mut encoder = Quadrature::new(phase_a, phase_b, Decoding::X4);
    HBridge::new(Axis::X, enable, a, b).start().is_ok() && encoder.poll().is_ok()
}

/// Reads an emergency stop button; returns whether its pin could be read.
pub fn read_estop(button: ErasedPin<Input>) -> bool {
    EstopInput::new(button, SwitchSettings::default()).tick(Duration::ZERO).is_ok()
}
