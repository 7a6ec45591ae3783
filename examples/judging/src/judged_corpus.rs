//! [`judge_corpus`]: traces every picture of the corpus, and compares it with the truth.

use crate::corpus::{Truth, all};
use crate::{JudgedDrawing, Judgement};
use image::ImageFormat;
use plotter_vector::{Vectorizer, decode};
use rayon::prelude::*;
use std::io::Cursor;

/// Draws the corpus, vectorizes each picture with the default settings, in colour where it has several
/// colours, and compares it with the drawn lines. The greatest distance of the ink is measured on lines 1 px
/// wide.
///
/// # Errors
///
/// The picture that could not be vectorized, and why.
pub fn judge_corpus() -> Result<Vec<(Truth, Judgement)>, String> {
    all()
        .into_par_iter()
        .map(|picture| {
            let judge = || {
                let truth = Truth::of(&picture);
                let mut file = Cursor::new(Vec::new());
                picture.draw().write_to(&mut file, ImageFormat::Png).map_err(|error| error.to_string())?;
                let file = file.into_inner();
                let in_colour = truth.polylines.iter().any(|line| line.color != truth.polylines[0].color);
                let JudgedDrawing { drawing, pens } = JudgedDrawing::traced(&file, in_colour)?;
                let gray = decode(&file).map_err(|error| error.to_string())?;
                let ink = (truth.widest_px() <= 1.0).then(|| Vectorizer::default().ink(&gray));
                let judgement = Judgement::new(&drawing, &pens, &truth, ink.as_ref())?;
                Ok((truth, judgement))
            };
            judge().map_err(|error: String| format!("{}: {error}", picture.name))
        })
        .collect()
}
