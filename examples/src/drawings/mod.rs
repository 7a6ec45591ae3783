//! A drawing in any language: read, arranged, written.

mod arrangement;
mod diagnostics;
mod drawing_arguments;
mod drawing_file;
mod font_files;
mod language;
mod pen_lines;
mod svg_drawing;
mod svg_reading;
mod svg_text;

pub use arrangement::{Arrangement, Crop, Effort, Mirror, Page};
pub use diagnostics::Diagnostics;
pub use drawing_arguments::DrawingArguments;
pub use drawing_file::{Diagnostic, DrawingFile, Ops, Reading, Severity};
pub use font_files::FontFiles;
pub use language::Language;
pub use pen_lines::PenLines;
pub use svg_drawing::{SvgOps, svg_drawing};
pub use svg_reading::{Paper, PensBy, SvgReading};
pub use svg_text::SvgText;
