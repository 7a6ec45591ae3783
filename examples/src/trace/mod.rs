//! `trace`: a picture as strokes, and these over the picture; whole, or not written.

mod command;
mod explain;
mod figures;
mod files;
mod interrupt;
mod overlay;
mod settings;
mod traced;

pub use command::TraceCommand;
pub use interrupt::Interrupt;
pub use overlay::{Overlay, overlay_png, overlay_step};
