//! What of a picture is ink, and which pen drew it: thresholds, light, dirt, colours, widths.

pub(crate) mod evened;
mod evenness;
mod grain;
pub(crate) mod hairlines;
pub(crate) mod illumination;
mod layers;
pub(crate) mod line_width;
pub(crate) mod mark_sizes;
mod palette;
pub(crate) mod pen;
pub(crate) mod row_threshold;
pub(crate) mod row_window;
pub(crate) mod speckle;
mod threshold;

pub(crate) use evened::Evened;
pub use evened::Look;
pub use layers::{Layers, Pens, PensError, Unassigned};
pub use line_width::{LineWidth, pen_width_px};
pub use palette::{MAX_PENS, Palette, PaletteError, PalettePen};
#[cfg(feature = "toml")]
pub use palette::{PalettePlace, PaletteTomlError};
pub(crate) use row_threshold::{RowThreshold, Survey};
pub(crate) use speckle::context_rows;
pub use speckle::{Despeckled, despeckle, smallest_mark_px};
pub(crate) use threshold::told;
pub use threshold::{Polarity, Split, Threshold, ThresholdMethod, ThresholdMethodError};

#[cfg(test)]
mod prop_tests;
