//! Texts that a firmware prints with `defmt`, among them errors of drivers whose pins have errors that
//! `defmt` does not know.

use embedded_hal::{digital, pwm};
use plotter_hal::serial_line::{Fault, FaultCounts, Received};
use plotter_hal::{
    EstopChange, a4988, axis, estop_input, h_bridge, laser, limit_switch, pen_servo, pulse_counter,
    quadrature,
};
use plotter_motion::encoder::{Phases, PulseCounter};
use plotter_motion::firmware::Notice;
use plotter_motion::firmware::stepper_plotter::{
    Command, Drivers, Lateness, Report, SettingsError, Signal, Status,
};
use plotter_motion::homing::{Homed, HomingError, HomingStatus};
use plotter_motion::planner::PlanError;
use plotter_motion::protocol::digits::{Dropped, Reply};
use plotter_motion::protocol::frame::DecodeError;
use plotter_motion::protocol::{LinkCounts, LinkState};
use plotter_motion::safety::{Beam, Blocked, DutyError, Pulse};
use plotter_motion::{
    Axis, ConfigError, Demand, Direction, Drive, Duty, LimitSwitches, Point, StepPair, StepPoint, gcode, hpgl,
};

/// A chip's own error: no `Format`, no `Display`.
#[derive(Debug)]
struct Own;

impl digital::Error for Own {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl pwm::Error for Own {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

const fn formats<T: defmt::Format>() {}

#[test]
fn errors_of_drivers_ask_no_more_of_a_pin_than_embedded_hal_does() {
    type Stepper = a4988::Error<a4988::PinError<Own, Own, Own, Own>>;
    type Motor = h_bridge::Error<h_bridge::PinError<Own, Own>, Own>;
    type Input = h_bridge::Error<core::convert::Infallible, h_bridge::InputError<Own, Own>>;
    formats::<axis::Error<Stepper, Motor>>();
    formats::<a4988::Error<a4988::MicrostepPinError<Own, Own, Own>>>();
    formats::<h_bridge::Error<h_bridge::Tb6612PinError<Own, Own, Own>, Own>>();
    formats::<Input>();
    formats::<laser::Error<Own>>();
    formats::<pen_servo::Error<Own>>();
    formats::<pen_servo::SettingsError>();
    formats::<limit_switch::Error<Own>>();
    formats::<limit_switch::GroupError<Own, Own, Own, Own>>();
    formats::<estop_input::Error<Own>>();
    formats::<pulse_counter::Error<Own>>();
    formats::<quadrature::Error<quadrature::PinError<Own, Own>>>();
    formats::<(EstopChange, Received, Fault, FaultCounts)>();
}

#[test]
fn what_goes_between_a_controller_and_its_drivers_can_be_printed() {
    formats::<(Axis, Direction, Point, StepPoint, StepPair, LimitSwitches)>();
    formats::<(Duty, DutyError, Demand, Drive<'static>, Pulse<'static>, Beam<'static>, Blocked)>();
    formats::<(Phases, PulseCounter, Homed, HomingStatus, HomingError)>();
    formats::<(Dropped, Reply, DecodeError, LinkState, LinkCounts)>();
    formats::<(ConfigError, PlanError, gcode::Error, hpgl::Error)>();
    formats::<(Command, Signal, Report, Status, Lateness, Drivers, SettingsError, Notice)>();
}
