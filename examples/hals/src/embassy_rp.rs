//! The drivers of `plotter-hal` with the types of `embassy-rp`, for the RP2040. Compiled and never run.

use core::time::Duration;
use embassy_rp::gpio::{Input, Output};
use embassy_rp::pwm::PwmOutput;
use embassy_rp::uart::{Blocking, BufferedUart, BufferedUartRx, BufferedUartTx, UartRx, UartTx};
use plotter_hal::a4988::Timing;
use plotter_hal::embedded_hal_async::delay::DelayNs;
use plotter_hal::plotter_motion::{Axis, config::Decoding};
use plotter_hal::serial_line::{Fault, NbPort, Received};
use plotter_hal::{
    A4988, EstopInput, HBridge, Laser, Quadrature, SerialRx, SerialTx, StepperAxes, SwitchSettings,
};

/// A task that hands each received byte to `take`.
pub async fn receive(rx: BufferedUartRx, mut take: impl FnMut(Received)) {
    let mut rx = SerialRx::new(rx);
    while let Some(received) = rx.received().await {
        take(received);
    }
}

/// A task that sends the bytes that `next_byte` gives.
pub async fn send(tx: BufferedUartTx, next_byte: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
    let mut tx: SerialTx<_> = SerialTx::new(tx);
    tx.sent(next_byte).await
}

/// Receives and sends without waiting: bytes to send go into the port's own buffer.
pub fn poll(
    uart: BufferedUart,
    mut take: impl FnMut(Received),
    next_byte: impl FnMut() -> Option<u8>,
) -> Result<(), Fault> {
    let (tx, rx) = uart.split();
    let (mut tx, mut rx): (SerialTx<_, 8>, _) = (SerialTx::new(tx), SerialRx::new(rx));
    while let Some(received) = rx.receive() {
        take(received);
    }
    tx.queue(next_byte);
    tx.write_queued()
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
pub fn start_dc_motor(
    enable: PwmOutput<'static>,
    [a, b]: [Output<'static>; 2],
    phases: [Input<'static>; 2],
) -> bool {
    let [phase_a, phase_b] = phases;
    let mut encoder = Quadrature::new(phase_a, phase_b, Decoding::X4);
    HBridge::new(Axis::X, enable, a, b).start().is_ok() && encoder.poll().is_ok()
}

/// Waits for an emergency stop button, then for an encoder that is turned by hand. Clock and delay are the
/// executor's.
pub async fn wait_for_inputs(
    button: Input<'static>,
    phases: [Input<'static>; 2],
    clock: impl Fn() -> Duration,
    delay: &mut impl DelayNs,
) -> bool {
    let mut button = EstopInput::new(button, SwitchSettings::default());
    let [a, b] = phases;
    button.changed(clock, delay).await.is_ok() && Quadrature::new(a, b, Decoding::X4).counted().await.is_ok()
}

/// Reads the button that stops a laser, and switches the laser off; returns whether all pins obeyed.
pub fn laser(pwm: PwmOutput<'static>, button: Input<'static>) -> bool {
    let mut button = EstopInput::new(button, SwitchSettings::default());
    let mut laser = Laser::new(pwm, Duration::from_millis(20));
    button.tick(Duration::ZERO).is_ok() && laser.off().is_ok()
}
