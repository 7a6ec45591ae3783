//! The drivers of `plotter-hal` with the types of `rp2040-hal`, for the RP2040.
//!
//! It is compiled and never run: it shows which types fit, and how a call looks.

use core::time::Duration;
use plotter_hal::a4988::Timing;
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

/// Receives a byte and sends what `next_byte` gives, by a port that is not split.
pub fn whole_port<D: UartDevice, P: ValidUartPinout<D>>(
    uart: UartPeripheral<Enabled, D, P>,
    next_byte: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut line = SerialLine::new(uart);
    (line.receive(), line.send(next_byte))
}

/// The same by a port that is split into receiver and transmitter, with a queue of 8 bytes for what is sent.
pub fn split_port<D: UartDevice, P: ValidUartPinout<D>>(
    rx: Reader<D, P>,
    tx: Writer<D, P>,
    next_byte: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(tx);
    (SerialRx::new(rx).receive(), tx.send(next_byte))
}

/// The same through [`NbPort`], which tells framing, parity and overrun faults apart.
pub fn split_port_with_fault_kinds<D: UartDevice, P: ValidUartPinout<D>>(
    rx: Reader<D, P>,
    tx: Writer<D, P>,
    next_byte: impl FnMut() -> Option<u8>,
) -> (Option<Received>, Result<(), Fault>) {
    let mut tx: SerialTx<_, 8> = SerialTx::new(NbPort::new(tx));
    (SerialRx::new(NbPort::new(rx)).receive(), tx.send(next_byte))
}

/// Configures a TMC2209 that has a serial port to itself.
pub fn configure_tmc2209<D: UartDevice, P: ValidUartPinout<D>>(
    uart: UartPeripheral<Enabled, D, P>,
    mut timer: Timer,
) -> Result<(), tmc2209::Error> {
    const ADDRESS: u8 = 0; // pins MS1 and MS2 low
    Tmc2209::new(uart, ADDRESS).configure(&tmc2209::Settings::default(), &mut timer)
}

/// Starts two step/dir drivers; returns whether all pins obeyed.
pub fn start_steppers(x: [Output; 2], y: [Output; 2], enable: Output, mut timer: Timer) -> bool {
    let ([x_step, x_dir], [y_step, y_dir]) = (x, y);
    // A TMC2209 is stepped like an A4988, with times of its own.
    let x = A4988::new(Axis::X, x_step, x_dir, Timing::TMC2209).with_enable(enable);
    let y = A4988::new(Axis::Y, y_step, y_dir, Timing::TMC2209);
    StepperAxes::new(x, y).start_blocking(&mut timer).is_ok()
}

/// Starts a DC motor and reads its encoder; returns whether all pins obeyed.
pub fn start_dc_motor<S: AnySlice, C: ChannelId>(
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

/// Reads an emergency stop button; returns whether its pin could be read.
pub fn read_estop(button: Input) -> bool {
    EstopInput::new(button, SwitchSettings::default()).tick(Duration::ZERO).is_ok()
}
