//! Simulated machines: motors, loads, encoders, and a whole machine on its serial line.

mod axis_plant;
#[cfg(feature = "alloc")]
mod bench;
mod dc_motor;
mod marking_board;
#[cfg(feature = "alloc")]
mod simulated_line;
mod stepper;

pub use axis_plant::{AxisPlant, CountedEdge, PhaseChange};
#[cfg(feature = "alloc")]
pub use bench::{Bench, BenchEvent, BenchSettings};
pub use dc_motor::{DcMotor, DcMotorState};
pub use marking_board::{MarkingBoardPlant, MarkingBoardPlantSettings};
#[cfg(feature = "alloc")]
pub use simulated_line::SimulatedLine;
pub use stepper::{StepperAxis, StepperPlant, StepperSettings};
