//! The drivers of `plotter-hal` with the types of `embassy-nrf`, for an nRF52840. Compiled and never run.
//!
//! Servo, laser and H-bridge are missing: the crate's PWM has none of `embedded-hal`'s traits.

use core::time::Duration;
use embassy_nrf::buffered_uarte::{BufferedUarteRx, BufferedUarteTx};
use embassy_nrf::gpio::{Input, Output};
use embassy_nrf::uarte::UarteTx;
use plotter_hal::a4988::Timing;
use plotter_hal::embedded_hal_async::delay::DelayNs;
use plotter_hal::plotter_motion::{Axis, config::Decoding};
use plotter_hal::serial_line::{Fault, Received};
use plotter_hal::{A4988, EstopInput, Quadrature, SerialRx, SerialTx, StepperAxes, SwitchSettings};

/// A task that hands each received byte to `take`.
pub async fn receive(rx: BufferedUarteRx<'static>, mut take: impl FnMut(Received)) {
    let mut rx = SerialRx::new(rx);
    while let Some(received) = rx.received().await {
        take(received);
    }
}

/// A task that sends the bytes that `next_byte` gives.
pub async fn send(tx: BufferedUarteTx<'static>, next_byte: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
    let mut tx: SerialTx<_> = SerialTx::new(tx);
    tx.sent(next_byte).await
}

/// The same by DMA. The future must run to its end: a dropped one loses bytes.
pub async fn send_by_dma(tx: UarteTx<'static>, next_byte: impl FnMut() -> Option<u8>) -> Result<(), Fault> {
    let mut tx: SerialTx<_> = SerialTx::new(tx);
    tx.sent(next_byte).await
}

/// Starts two step/dir drivers; returns whether all pins obeyed.
pub fn start_steppers(x: [Output<'static>; 2], y: [Output<'static>; 2], enable: Output<'static>) -> bool {
    let ([x_step, x_dir], [y_step, y_dir]) = (x, y);
    let x = A4988::new(Axis::X, x_step, x_dir, Timing::TMC2209).with_enable(enable);
    let y = A4988::new(Axis::Y, y_step, y_dir, Timing::TMC2209);
    StepperAxes::new(x, y).start(Duration::ZERO).is_ok()
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
