#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod areas;
mod bare_ink;
mod bitmap;
mod centrelines;
mod colour;
mod continuity;
mod coverage;
mod covered;
mod cubic;
mod curve;
#[cfg(feature = "image")]
mod decode;
mod decode_error;
mod drawing;
mod drawn_error;
mod error_chart;
mod error_report;
mod figures;
pub mod follow;
mod followed_lines;
mod gcode;
mod graph;
mod gray;
mod hairlines;
mod histogram;
mod hpgl;
mod in_colour;
mod layers;
mod lettering;
mod light;
mod line_width;
mod oklab;
mod on_sheet;
mod order;
mod palette;
mod pen;
mod pipeline;
mod pre_elimination;
mod progress;
mod raster_corner;
mod rolling;
mod row_threshold;
mod rows;
mod runs;
#[cfg(feature = "image")]
mod scan;
mod sheet;
mod simplify;
mod speckle;
mod straight_on;
mod stroke_op;
mod svg;
#[cfg(feature = "svg-in")]
mod svg_in;
mod thinning;
mod threshold;
mod tracking;
mod turns;
mod within;

pub use areas::{
    AreaError, AreaPath, AreaStyle, Areas, Hatch, MAX_LINE_PX, MIN_PITCH_PX, Outline, Outlines, WidthSplit,
    inset_outlines, rows_of_width_context, split_by_width,
};
pub use bitmap::{Bitmap, MAX_PIXELS, MAX_SIDE_PX, Pixel, SizeError};
pub use colour::{Colour, ColourError, colour_on_white};
pub use continuity::{Joined, is_closed, join, link};
pub use coverage::{Beyond, beyond_ink, coverage, worst_pixel};
pub use cubic::Cubic;
pub use curve::{Arc, Curve};
#[cfg(feature = "image")]
pub use decode::{decode, decode_colour};
pub use decode_error::DecodeError;
pub use drawing::{Drawing, PxPoint, Scale, ScaleError};
pub use drawn_error::InkDistance;
pub use error_chart::error_chart;
pub use error_report::{Bin, ErrorReport, ErrorTally};
pub use figures::Figures;
pub use followed_lines::{FollowedLines, followed_lines};
pub use gcode::gcode;
pub use gray::{Gray, GrayError, gray_on_white};
pub use histogram::Histogram;
pub use hpgl::hpgl;
pub use in_colour::VectorizedColour;
pub use layers::{Layers, Pens, PensError};
pub use lettering::{Lettering, TextBlock, TextLine};
pub use line_width::{LineWidth, pen_width_px};
pub use oklab::{Oklab, Rgb, RgbError};
pub use order::{Order, OrderEffort, order};
pub use palette::{MAX_PENS, Palette, PaletteError, PalettePen};
#[cfg(feature = "toml")]
pub use palette::{PalettePlace, PaletteTomlError};
pub use pipeline::{Algorithm, MAX_INK_PIXELS, Mode, Prefer, VectorizeError, Vectorized, Vectorizer};
pub use pre_elimination::PreElimination;
pub use progress::{Cancelled, Progress};
pub use row_threshold::{RowThreshold, Survey};
pub use rows::{BitmapRows, Depth, GrayRows, MAX_SHEET_ROWS, Row, RowSource};
#[cfg(feature = "image")]
pub use scan::Scan;
pub use sheet::{MAX_LINE_PIXELS, MAX_SHEET_STROKES, SheetError, SheetErrors, TracedSheet};
pub use simplify::{Bounded, DynamicThreshold, MAX_REACH_PX, Simplify};
pub use speckle::{Despeckled, context_rows, despeckle, smallest_mark_px};
pub use svg::{svg, svg_in_colour};
#[cfg(feature = "svg-in")]
pub use svg_in::{
    SvgDrawing, SvgError, SvgLayer, SvgLeftOut, SvgMissingFonts, SvgOptions, SvgPens, SvgProblem, read_svg,
};
#[cfg(feature = "svg-text")]
pub use svg_in::{SvgFontError, SvgFonts, read_svg_with_fonts};
pub use thinning::{Thinned, Thinning, ThinningMethod, ThinningProgress};
pub use threshold::{Polarity, Split, Threshold, ThresholdMethod, ThresholdMethodError};
pub use tracking::{HISTORY, OrderedTracking, TooManyFigures};
