//! `plot`: a drawing sent to a machine on a serial port.

mod port_plot;

pub use port_plot::{PortLanguage, plot_on_port};
