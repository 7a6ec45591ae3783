//! Pictures of recordings: what was drawn, charts over time, and a page that plays it.

mod canvas;
mod chart;
pub(crate) mod page;
mod thin;

#[cfg(feature = "image")]
pub use canvas::PngError;
pub use canvas::{Canvas, CanvasStyle, DesiredLine, Layer, Sketch, Visibility};
pub use chart::{Chart, Curve, Panel, Role, Run};
pub use page::{PageSettings, RecordingPage};
pub use thin::thin;
