//! An RP2040 by rp2040-hal.

use core::time::Duration;
use plotter_hal::a4988::Timing;
use plotter_hal::embedded_hal::delay::DelayNs;
use plotter_hal::plotter_motion::{Axis, config::Decoding};
use plotter_hal::serial_line::{Fault, NbPort, Received};
use plotter_hal::{
    A4988, EstopInput, HBridge, Quadrature, SerialLine, SerialRx, SerialTx, StepperAxes, SwitchSettings,
    Tmc2209, tmc2209,
};
use rp2040_hal::gpio::{DynPinId, FunctionSioInput, FunctionSioOutput, Pin, PullDown, PullUp};
use rp2040_hal::pwm::{AnySlice, Channel, ChannelId};
use rp2040_hal::timer::Timer;
use rp2040_hal::uart::{Enabled, Reader, UartDevice, UartPeripheral, ValidUartPinout, Writer};

type Output = Pin<DynPinId, FunctionSioOutput, PullDown>;
type Input = Pin<DynPinId, FunctionSioInput, PullUp>;

/// A port as a whole.
pub fn line<D: UartDevice, P: ValidUartPinout<D>>(
    uart: UartPeripheral<Enabled, D, P>,
    next: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut line = SerialLine::new(uart);
    (line.receive(), line.send(next))
}

/// Its halves.
pub fn halves<D: UartDevice, P: ValidUartPinout<D>>(
    rx: Reader<D, P>,
    tx: Writer<D, P>,
    next: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(tx);
    (SerialRx::new(rx).receive(), tx.send(next))
}

/// Its halves, so that the kinds of faults are told apart.
pub fn words<D: UartDevice, P: ValidUartPinout<D>>(
    rx: Reader<D, P>,
    tx: Writer<D, P>,
    next: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(NbPort::new(tx));
    (SerialRx::new(NbPort::new(rx)).receive(), tx.send(next))
}

/// A TMC2209 on a port of its own.
pub fn chip<D: UartDevice, P: ValidUartPinout<D>>(
    uart: UartPeripheral<Enabled, D, P>,
    mut timer: Timer,
) -> Result<(), tmc2209::Error> {
    Tmc2209::new(uart, 0).configure(&tmc2209::Settings::default(), &mut timer)
}

/// Stepper motors.
pub fn steppers(x: [Output; 2], y: [Output; 2], enable: Output, mut timer: Timer) -> bool {
    let ([x_step, x_dir], [y_step, y_dir]) = (x, y);
    let x = A4988::new(Axis::X, x_step, x_dir, Timing::TMC2209).with_enable(enable);
    let y = A4988::new(Axis::Y, y_step, y_dir, Timing::TMC2209);
    timer.delay_us(1);
    StepperAxes::new(x, y).start_blocking(&mut timer).is_ok()
}

/// A DC motor with its encoder.
pub fn motor<S: AnySlice, C: ChannelId>(
    enable: Channel<S, C>,
    [a, b]: [Output; 2],
    [phase_a, phase_b]: [Input; 2],
) -> bool
where
    Channel<S, C>: plotter_hal::embedded_hal::pwm::SetDutyCycle,
{
    let mut encoder = Quadrature::new(phase_a, phase_b, Decoding::X4);
    HBridge::new(Axis::X, enable, a, b).start().is_ok() && encoder.poll().is_ok()
}

/// A button.
pub fn button(button: Input) -> bool {
    EstopInput::new(button, SwitchSettings::default()).tick(Duration::ZERO).is_ok()
}
