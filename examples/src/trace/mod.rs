//! `trace`: strokes over the picture that they were made from, whole or not written.

mod interrupt;
mod overlay;

pub use interrupt::{INTERRUPTED, Interrupt};
pub use overlay::{Overlay, overlay_png, overlay_step};
