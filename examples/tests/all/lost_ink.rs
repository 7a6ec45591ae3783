//! Ink that no stroke draws: the commands say so and fail; on pictures that are drawn well they never do.

use crate::built_example;

use built_example::{Folder, data, run_example};
use image::ImageFormat;
use plotter_examples::corpus::all;
use plotter_examples::{lost_ink, vectorized};
use plotter_vector::Vectorizer;
use std::io::Cursor;

/// Half of the width of the pen that draws the picture here.
const HALF_PEN_PX: f64 = 0.85;

/// A circle of 21 px and two lines 2.2 px apart, of which the nearer one touches it, at 1 bit: by one stroke
/// a line a part of the lines is not drawn, up to 7.5 px from the nearest stroke.
fn nearly_tangent() -> Vec<u8> {
    const CENTRE: [f64; 2] = [119.5, 99.5];
    const RADIUS: f64 = 21.0;
    const ANGLE_RAD: f64 = 0.4;
    const LINES_FROM_CENTRE: [f64; 2] = [21.0, 23.2];
    const HALF_LENGTH: f64 = 70.0;
    let is_ink = |x: u32, y: u32| {
        let (x, y) = (f64::from(x) - CENTRE[0], f64::from(y) - CENTRE[1]);
        let (along, across) =
            (x * ANGLE_RAD.cos() - y * ANGLE_RAD.sin(), -x * ANGLE_RAD.sin() - y * ANGLE_RAD.cos());
        let beyond = (along.abs() - HALF_LENGTH).max(0.0);
        let line = LINES_FROM_CENTRE.map(|from| beyond.hypot(across - from));
        let circle = (x.hypot(y) - RADIUS).abs();
        circle.min(line[0]).min(line[1]) <= HALF_PEN_PX
    };
    let levels =
        (0..200).flat_map(|y| (0..260).map(move |x| (x, y))).map(|(x, y)| u8::from(!is_ink(x, y)) * 255);
    [b"P5 260 200 255\n".to_vec(), levels.collect()].concat()
}

#[test]
fn lost_ink_is_said_with_its_place_after_the_file_is_written() {
    let folder = Folder::new();
    let picture = folder.write("tangent.pgm", nearly_tangent());
    let svg = folder.file("a.svg");
    let output = run_example("trace", &[picture.as_str(), "--prefer", "strokes", "--svg", &svg]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    for part in ["tangent.pgm: ink at (", "from the nearest stroke", "0.5 px were promised"] {
        assert!(said.contains(part), "{said}");
    }
    assert!(std::fs::read_to_string(svg).unwrap().contains("</svg>"));
    // Nothing is known of the errors then.
    assert!(run_example("trace", &[&picture, "--prefer", "strokes", "--no-errors"]).status.success());
    // Usually it is drawn.
    assert!(run_example("trace", &[&picture]).status.success());
    assert!(run_example("trace", &[&picture, "--algorithm", "published"]).status.success());
}

#[test]
fn no_picture_of_the_corpus_and_no_example_has_lost_ink() {
    let vectorizer = Vectorizer::default();
    let drawn = all().into_iter().map(|picture| {
        let mut file = Cursor::new(Vec::new());
        picture.draw().write_to(&mut file, ImageFormat::Png).unwrap();
        (picture.name.to_string(), file.into_inner())
    });
    let examples =
        ["flag.png", "technical.png"].map(|name| (name.to_string(), std::fs::read(data(name)).unwrap()));
    for (name, file) in drawn.chain(examples) {
        let traced = vectorized(&vectorizer, file).unwrap();
        let errors = traced.errors.unwrap();
        println!("{name:16} width {:?} px, greatest error {:.2} px", traced.pen_px, errors.report.max_px);
        assert_eq!(lost_ink(&vectorizer, &errors, traced.pen_px), Ok(()), "{name}");
    }
}
