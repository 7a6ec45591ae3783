//! What every tool needs: one clear line for every error, files, pages with pictures, how pictures are
//! traced.

mod command;
mod files;
mod fit_drawing;
mod lost_ink;
mod pen_colours;
mod report;
mod vectorize_settings;

pub use command::{at, print, run};
pub use files::{is_standard, read_file, read_input, write_file, write_output};
pub use fit_drawing::fit_drawing;
pub use lost_ink::{lost_ink, vectorized};
pub use pen_colours::{pen_colour, usual_colour};
pub(crate) use report::escaped;
pub use report::{Figure, html_page};
pub use vectorize_settings::vectorizer;
