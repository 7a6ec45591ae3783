//! A drawing on a machine, simulated, in the emulator or by its steps, and what the pen did there.

mod emulated_plot;
mod emulator;
mod path_deviation;
mod simulated_board;
mod simulated_plot;
mod speed_audit;
mod stepped_plot;
mod streamed_steps;

pub use emulated_plot::{Recorded, plot_in_emulator};
pub use emulator::{BenchSwitches, Emulator, Told, built_firmware};
pub use path_deviation::PathDeviation;
pub use simulated_board::{SimulatedBoard, board_header, simulate_board};
pub use simulated_plot::{PlotOutcome, simulate};
pub use speed_audit::{Moment, MostAccel, SpeedAudit};
pub use stepped_plot::{BLOCKS, PlotEvent, SteppedFigures, SteppedPlot};
pub use streamed_steps::{StreamedSteps, streamed_in_emulator, streamed_on_the_desk};
