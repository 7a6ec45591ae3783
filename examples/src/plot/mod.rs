//! `plot`: from a scan to ink, on a simulated machine or on one at a serial port.

mod command;
mod figures;
mod pictures;
mod port_plot;
mod recording;

pub use command::PlotCommand;
pub use port_plot::{PortLanguage, plot_on_port};
