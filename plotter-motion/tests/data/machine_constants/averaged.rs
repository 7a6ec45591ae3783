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
/// Bits a second of its line.
pub const BAUD: u32 = 115200;
/// Its settings.
pub const SETTINGS: StepperPlotterSettings = plotter_motion::two_axes!(StepperPlotterSettings { dialect: Dialect::Grbl, stored: StoredSettings { width_mm: 380, height_mm: 310, x_direction: 0, y_direction: 0, speed_percent: 80, pen_up_deg: 160, pen_down_deg: 90 }, x_steps_per_mm: 87.58, y_steps_per_mm: 87.58, planner: plotter_motion::jerk_limited!(Vector PlannerSettings { path: PathMode::Tolerance { path_tolerance_mm: 0.05 }, speed_mm_s: 45.0, travel_speed_mm_s: 90.0, accel_mm_s2: 250.0, accel_limit: AccelLimit::Vector, jerk_mm_s3: Some(10000.0), junction_deviation_mm: 0.01, resolution_mm: 0.005709065996802923, allowance_mm: 0.011418131993605847 }), pen_settle: Duration::from_nanos(200000000), laser: false, pen: PenConvention::Spindle, gather: Duration::from_nanos(50000000), backlash: Backlash { x_steps: 0, y_steps: 0 }, homing: false, home_x: HomingAxis { start_hz: 2000, fast_hz: 8000, slow_hz: 1000, accel_hz_s: 21895, pull_off_steps: 87, release_steps: 437, known_steps: 23996, most_steps: 39411 }, home_y: HomingAxis { start_hz: 2000, fast_hz: 8000, slow_hz: 1000, accel_hz_s: 21895, pull_off_steps: 87, release_steps: 437, known_steps: 23996, most_steps: 39411 } });
/// Whether a laser takes the place of its pen.
pub const LASER: bool = false;
/// Its controller, with what its settings need.
pub type StepperPlotter = plotter_motion::firmware::StepperPlotter<Grbl<SpindlePen>, planner::AllModes>;
/// The same settings, looked at by the compiler.
pub static CHECKED: CheckedSettings<planner::AllModes> = match SETTINGS.checked() {
Ok(checked) => checked,
Err(_) => panic!("no machine can be driven with them"),
};
}
