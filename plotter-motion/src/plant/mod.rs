//! Simulated machines: motors, loads, encoders, and a whole machine on its serial line.

mod axis_plant;
mod belt_drive;
#[cfg(feature = "alloc")]
mod bench;
mod dc_motor;
mod drive_delay;
mod enable_pwm;
mod marking_board;
mod matrix;
#[cfg(feature = "alloc")]
mod simulated_line;
mod stepper;

pub use axis_plant::{AxisPlant, CountedEdge, PhaseChange};
pub use belt_drive::{BeltDrive, BeltDriveState};
#[cfg(feature = "alloc")]
pub use bench::{Bench, BenchController, BenchEvent, BenchSettings};
pub use dc_motor::{DcMotor, DcMotorState};
pub use drive_delay::DriveDelay;
pub use marking_board::{MarkingBoardPlant, MarkingBoardPlantSettings};
#[cfg(feature = "alloc")]
pub use simulated_line::SimulatedLine;
pub use stepper::{StepperAxis, StepperPlant, StepperSettings};
