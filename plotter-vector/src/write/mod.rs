//! Drawings written as SVG, G-code and HPGL.

mod gcode;
mod hpgl;
pub(crate) mod svg;

pub use gcode::gcode;
pub use hpgl::hpgl;
pub use svg::{svg, svg_in_colour};
