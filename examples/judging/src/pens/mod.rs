//! Sheets that several pens drew, as scanners, programs and telephones show them. What `judge_pens` judges.
//!
//! [`PenSheet::new`] draws, another sheet for each seed and number: up to eight pens, neighbours in hue among
//! them, whose strokes cross each other. [`PenSheet::picture`] shows it in one of the [`PenPicture`] kinds,
//! and [`PenFigures`] says how well each stroke has come onto its own pen.

mod figures;
mod sheet;
mod shown;

pub use figures::PenFigures;
pub use sheet::PenSheet;
pub use shown::PenPicture;
