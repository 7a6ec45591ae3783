//! Code that every tool needs: one clear line for every error, exit codes, figures as a table or JSON,
//! progress, files, pages with pictures, how pictures are traced.

mod command;
mod doubted;
mod exit_status;
mod files;
mod fit_drawing;
mod lost_ink;
mod paper;
mod pen_colours;
mod picture_size;
mod report;
mod telling;
mod told_ink;
mod told_spots;
mod work_shown;

pub use command::{at, print, run};
pub use doubted::{IN_MACHINE_FILE, doubted};
pub use exit_status::ExitStatus;
pub use files::{is_standard, read_file, read_input, write_file, write_output};
pub use fit_drawing::{fit_drawing, fit_picture};
pub(crate) use lost_ink::no_pen_got;
pub use lost_ink::{lost_ink, vectorized};
pub use paper::{Paper, PaperChoice, PaperError, PaperOption, PaperReport, Straightened};
pub use pen_colours::{pen_colour, usual_colour};
pub use picture_size::{PictureSize, SizeOptions, UsualSize, told_notes};
pub(crate) use report::escaped;
pub use report::{Figure, html_page};
pub use telling::Telling;
pub use told_ink::{assumed, told_ink};
pub(crate) use told_spots::{told_bare, told_insides};
pub use work_shown::WorkShown;
