//! Ink that no stroke draws: there is none on pictures of which every line is known.

use image::ImageFormat;
use plotter_examples::shared::{lost_ink, vectorized};
use plotter_judging::corpus::all;
use plotter_vector::Vectorizer;
use std::io::Cursor;

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn no_picture_of_the_corpus_has_lost_ink() {
    let vectorizer = Vectorizer::default();
    for picture in all() {
        let mut file = Cursor::new(Vec::new());
        picture.draw().write_to(&mut file, ImageFormat::Png).unwrap();
        let (traced, _) = vectorized(&vectorizer, file.into_inner(), 1).unwrap();
        let errors = traced.errors.unwrap();
        let name = picture.name;
        println!("{name:16} width {:?} px, greatest error {:.2} px", traced.pen_px, errors.report.max_px);
        assert_eq!(lost_ink(&vectorizer, &errors, traced.pen_px, traced.look.is_some()), Ok(()), "{name}");
    }
}
