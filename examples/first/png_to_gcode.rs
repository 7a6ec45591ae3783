//! A PNG becomes G-code, as large as fits an A4 sheet.
//!
//! `cargo run --release --example png_to_gcode -- drawing.png drawing.gcode`

use plotter_motion::{Point, gcode::WriteOptions};
use plotter_vector::{Scale, Vectorizer, decode, gcode};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut names = std::env::args().skip(1);
    let from = names.next().ok_or("which picture?")?;
    let to = names.next().ok_or("which file for the G-code?")?;

    let drawing = Vectorizer::default().vectorize(&decode(&std::fs::read(from)?)?)?.drawing;
    let (lower_left, upper_right) = (Point::ORIGIN, Point::new(210.0, 297.0));
    let scale = Scale::fit(drawing.width_px(), drawing.height_px(), lower_left, upper_right, 10.0)?;
    let mut text = String::new();
    gcode(&drawing, scale, WriteOptions::default(), &mut text)?;
    std::fs::write(to, text)?;
    eprintln!("{} strokes, {} vertices", drawing.strokes().len(), drawing.vertices());
    Ok(())
}
