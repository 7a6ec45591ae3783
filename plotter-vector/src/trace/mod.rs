//! From picture to drawing: the vectorizer, for whole pictures, for colours, and row by row.

pub(crate) mod bare_ink;
mod doubt;
mod in_colour;
pub(crate) mod ours;
pub(crate) mod pipeline;
mod progress;
mod sheet;
mod vectorize_config;
mod vectorize_error;

pub use doubt::Doubt;
pub use in_colour::VectorizedColour;
pub use ours::{Mode, Ours, Prefer};
pub use pipeline::{Algorithm, MAX_INK_PIXELS, Published, Vectorized, Vectorizer};
pub use progress::{Cancelled, Progress};
pub use sheet::{MAX_LINE_PIXELS, MAX_SHEET_STROKES, SheetError, SheetErrors, TracedSheet};
pub use vectorize_config::{PensChoice, TooCloseError, VectorizeConfig};
pub use vectorize_error::VectorizeError;
