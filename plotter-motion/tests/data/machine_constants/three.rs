/// A plotter with stepper motors, from its file.
#[allow(unused_imports, clippy::unreadable_literal, clippy::excessive_precision, clippy::wildcard_imports, reason = "written by a build script")]
pub mod stepper_plotter {
use core::time::Duration;
use plotter_motion::firmware::stepper_plotter::*;
use plotter_motion::gcode::{LaserCommand, PenConvention, ServoCommand};
use plotter_motion::homing::HomingAxis;
use plotter_motion::kinematics::Backlash;
use plotter_motion::planner::{self, AccelLimit};
use plotter_motion::{PathMode, PlannerSettings};
use plotter_motion::Axis;
/// Bits a second of its line.
pub const BAUD: u32 = 115200;
/// Its settings.
pub const SETTINGS: StepperPlotterSettings = StepperPlotterSettings { dialect: Dialect::Grbl, stored: StoredSettings { width_mm: 380, height_mm: 310, x_direction: 0, y_direction: 0, speed_percent: 80, pen_up_deg: 160, pen_down_deg: 90 }, x_steps_per_mm: 87.58, y_steps_per_mm: 87.58, planner: plotter_motion::jerk_limited!(Path PlannerSettings { path: PathMode::Exact, speed_mm_s: 45.0, travel_speed_mm_s: 90.0, accel_mm_s2: 250.0, accel_limit: AccelLimit::Vector, jerk_mm_s3: None, junction_deviation_mm: 0.01, resolution_mm: 0.005709065996802923, allowance_mm: 0.011418131993605847 }), pen_settle: Duration::from_nanos(200000000), laser: false, pen: PenConvention::Spindle, gather: Duration::from_nanos(50000000), backlash: Backlash { x_steps: 0, y_steps: 0 }, homing: false, home_x: HomingAxis { start_hz: 2000, fast_hz: 8000, slow_hz: 1000, accel_hz_s: 21895, pull_off_steps: 87, release_steps: 437, known_steps: 23996, most_steps: 39411 }, home_y: HomingAxis { start_hz: 2000, fast_hz: 8000, slow_hz: 1000, accel_hz_s: 21895, pull_off_steps: 87, release_steps: 437, known_steps: 23996, most_steps: 39411 }, z: Some(ZAxis { steps_per_mm: 400.0, speed_mm_s: 10.0, accel_mm_s2: 100.0, travel_mm: 30.0, pen: Some(ZPen { up_mm: 5.0, down_mm: 0.0 }), home: Some(ZHoming { start_hz: 2000, slow_hz: 1000, pull_off_steps: 400, release_steps: 2000, most_steps: 14400 }) }), second: Some(SecondMotor { axis: Axis::Y, offset_steps: -44, most_skew_steps: 876 }) };
/// Whether a laser takes the place of its pen.
pub const LASER: bool = false;
/// Its controller, with what its settings need.
pub type StepperPlotter = plotter_motion::firmware::StepperPlotter<Grbl<AnyPen>, planner::ThreeAxes>;
/// The same settings, looked at by the compiler.
pub static CHECKED: CheckedSettings<planner::ThreeAxes> = match SETTINGS.checked() {
Ok(checked) => checked,
Err(_) => panic!("no machine can be driven with them"),
};
}
