//! The drivers of `plotter-hal` with the types of `embassy-stm32`, for an STM32F4. Compiled and never run.

use core::time::Duration;
use embassy_stm32::exti::ExtiInput;
use embassy_stm32::gpio::{Input, Output};
use embassy_stm32::mode::{Async, Blocking};
use embassy_stm32::timer::GeneralInstance4Channel;
use embassy_stm32::timer::simple_pwm::SimplePwmChannel;
use embassy_stm32::usart::{BufferedUartRx, BufferedUartTx, RingBufferedUartRx, UartRx, UartTx};
use plotter_hal::a4988::Timing;
use plotter_hal::embedded_hal_async::delay::DelayNs;
use plotter_hal::plotter_motion::{Axis, config::Decoding};
use plotter_hal::serial_line::{Fault, NbPort, Received};
use plotter_hal::{A4988, EstopInput, HBridge, Quadrature, SerialRx, SerialTx, StepperAxes, SwitchSettings};

/// A task that hands each received byte to `take`.
pub async fn receive(rx: BufferedUartRx<'static>, mut take: impl FnMut(Received)) {
    let mut rx = SerialRx::new(rx);
    while let Some(received) = rx.received().await {
        take(received);
    }
}

/// The same by DMA into a ring buffer.
pub async fn receive_by_dma(rx: RingBufferedUartRx<'static>, mut take: impl FnMut(Received)) {
    let mut rx = SerialRx::new(rx);
    while let Some(received) = rx.received().await {
        take(received);
    }
}

/// A task that sends the bytes that `next_byte` gives.
pub async fn send(tx: BufferedUartTx<'static>, next_byte: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
    let mut tx: SerialTx<_> = SerialTx::new(tx);
    tx.sent(next_byte).await
}

/// The same by DMA. The future must run to its end: a dropped one loses bytes.
pub async fn send_by_dma(
    tx: UartTx<'static, Async>,
    next_byte: impl FnMut() -> Option<u8>,
) -> Result<(), Fault> {
    let mut tx: SerialTx<_> = SerialTx::new(tx);
    tx.sent(next_byte).await
}

/// Receives and sends without waiting: bytes to send go into the port's own buffer.
pub fn poll(
    rx: BufferedUartRx<'static>,
    tx: BufferedUartTx<'static>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(tx);
    (SerialRx::new(rx).receive(), tx.write_queued())
}

/// Receives and sends by a port without a buffer.
pub fn unbuffered(
    rx: UartRx<'static, Blocking>,
    tx: UartTx<'static, Blocking>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(tx);
    (SerialRx::new(NbPort::new(rx)).receive(), tx.write_queued())
}

/// Starts two step/dir drivers; returns whether all pins obeyed.
pub fn start_steppers(x: [Output<'static>; 2], y: [Output<'static>; 2], enable: Output<'static>) -> bool {
    let ([x_step, x_dir], [y_step, y_dir]) = (x, y);
    let x = A4988::new(Axis::X, x_step, x_dir, Timing::TMC2209).with_enable(enable);
    let y = A4988::new(Axis::Y, y_step, y_dir, Timing::TMC2209);
    StepperAxes::new(x, y).start(Duration::ZERO).is_ok()
}

/// Starts a DC motor and reads its encoder; returns whether all pins obeyed.
pub fn start_dc_motor<T: GeneralInstance4Channel>(
    enable: SimplePwmChannel<'static, T>,
    [a, b]: [Output<'static>; 2],
    phases: [Input<'static>; 2],
) -> bool {
    let [phase_a, phase_b] = phases;
    let mut encoder = Quadrature::new(phase_a, phase_b, Decoding::X4);
    HBridge::new(Axis::X, enable, a, b).start().is_ok() && encoder.poll().is_ok()
}

/// Waits for an emergency stop button on a pin with an interrupt. Clock and delay are the executor's.
pub async fn wait_for_estop(
    button: ExtiInput<'static, Async>,
    clock: impl Fn() -> Duration,
    delay: &mut impl DelayNs,
) -> bool {
    EstopInput::new(button, SwitchSettings::default()).changed(clock, delay).await.is_ok()
}
