//! Sheets of several pens: each stroke comes onto its own pen, whole, and no ink is left.

use plotter_judging::pens::{PenFigures, PenPicture, PenSheet};
use plotter_vector::{Vectorizer, decode_colour, ink::Pens};

/// What is asked of a sheet: recall and precision at 1.5 px, and the length on another pen.
const LEAST_RECALL: f64 = 0.98;
const LEAST_PRECISION: f64 = 0.97;
const MOST_ON_WRONG_PEN: f64 = 0.005;

/// Three pens, with a pencil beside black.
const THREE: u32 = 1;
const EIGHT: u32 = 4;

fn each_stroke_is_on_its_pen(kind: PenPicture, number: u32) {
    let sheet = PenSheet::new(1, number);
    let picture = decode_colour(&sheet.picture(kind, u64::from(number)).unwrap()).unwrap();
    let found = Vectorizer::default().vectorize_colour(&picture, &Pens::Found).unwrap();
    let figures = PenFigures::new(&found.traced.drawing, &sheet);
    let of = format!("{}, sheet {number}: {figures:?}", kind.name());
    println!("{of}");
    assert_eq!(figures.pens, (sheet.pens(), sheet.pens()), "{of}");
    assert!(figures.recall >= LEAST_RECALL && figures.precision >= LEAST_PRECISION, "{of}");
    assert!(figures.wrong_pen <= MOST_ON_WRONG_PEN, "{of}");
    assert_eq!(found.unassigned, None, "{of}");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn three_pens_have_each_their_strokes_in_every_kind_of_picture() {
    PenPicture::ALL.iter().for_each(|kind| each_stroke_is_on_its_pen(*kind, THREE));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn eight_pens_have_each_their_strokes_in_a_photograph() {
    each_stroke_is_on_its_pen(PenPicture::Photo, EIGHT);
}

#[test]
#[ignore = "long: .ci/run has it in release"]
fn eight_pens_have_each_their_strokes_in_every_kind_of_picture() {
    PenPicture::ALL.iter().for_each(|kind| each_stroke_is_on_its_pen(*kind, EIGHT));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "long in a debug build: .ci/run has it in release")]
fn fewer_pens_than_drew_the_sheet_are_seen_in_the_figures() {
    let sheet = PenSheet::new(1, 1);
    let picture = decode_colour(&sheet.picture(PenPicture::Soft, 1).unwrap()).unwrap();
    let found = Vectorizer::default().vectorize_colour(&picture, &Pens::Count(1)).unwrap();
    let figures = PenFigures::new(&found.traced.drawing, &sheet);
    assert_eq!((figures.pens, figures.least_recall, figures.pens_right), ((1, 3), 0.0, 0.0));
}
