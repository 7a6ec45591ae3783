//! Draws `docs/pictures/photograph.png`: a simulated photograph of a drawing on a table, and the strokes that
//! our vectorizer finds on its sheet.
//!
//! The photograph, on the left, is from the corpus of degraded drawings: perspective, shade, blur and noise.
//! On the right is what `trace --paper auto` draws of it, each stroke in a colour of its own. Look at the
//! figures as well: how many strokes were drawn, and how many are found.
//!
//! ```text
//! cargo run --release -p plotter-judging --example draw_photograph               # rewrites that picture
//! cargo run --release -p plotter-judging --example draw_photograph -- FILE.png
//! ```

use clap::Parser;
use image::{RgbImage, imageops};
use plotter_examples::shared::{print, run};
use plotter_judging::degraded::{Drawn, Kind, Strength, drawing};
use plotter_vector::picture::SheetQuad;
use plotter_vector::{Drawing, Ours, Prefer, Vectorizer, decode};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tiny_skia::{Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Seed of the corpus.
const SEED: u64 = 1;
/// Number of the drawing in the corpus: a page of cartoons.
const NUMBER: u32 = 4;
/// Number of the drawing on the back of the sheet, which a photograph in perspective does not show.
const BACK_NUMBER: u32 = NUMBER + 101;
/// Height of both panels, px.
const HEIGHT_PX: u32 = 520;
/// Distance between the panels, px.
const GAP_PX: u32 = 24;
/// Width of a stroke in the right panel, px.
const PEN_PX: f32 = 1.6;
/// Colours of the strokes, one after the other.
const COLOURS: [[u8; 3]; 6] =
    [[20, 90, 200], [205, 30, 30], [20, 130, 60], [170, 80, 170], [200, 110, 0], [0, 140, 150]];

/// Draws a photograph of a drawing beside the strokes that are found on it.
#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  draw_photograph photograph.png")]
struct Arguments {
    /// PNG to write [default: docs/pictures/photograph.png of the project]
    file: Option<PathBuf>,
}

fn main() -> ExitCode {
    let Arguments { file } = Arguments::parse();
    run("draw_photograph", || draw(file))
}

fn draw(file: Option<PathBuf>) -> Result<(), String> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures/photograph.png");
    let file = file.unwrap_or_else(default);
    let drawn = Drawn::new(drawing(SEED, NUMBER), &drawing(SEED, BACK_NUMBER));
    let photograph = drawn
        .degraded(Kind::Perspective, Strength::Middle, SEED, NUMBER)
        .map_err(|error| format!("the photograph: {error}"))?;
    let gray = decode(&photograph.file).map_err(|error| error.to_string())?;
    let quad = SheetQuad::find(&gray).map_err(|error| error.to_string())?;
    let sheet = quad
        .straightened(quad.proportion(gray.width(), gray.height()))
        .ok_or("the sheet is seen from its edge")?
        .gray(&gray);
    let vectorizer = Vectorizer::from(Ours::default().with_prefer(Prefer::Strokes));
    let found = vectorizer.vectorize(&sheet).map_err(|error| error.to_string())?.drawing;

    let photo = image::load_from_memory(&photograph.file).map_err(|error| error.to_string())?;
    let photo = photo.resize(u32::MAX, HEIGHT_PX, imageops::FilterType::Triangle).into_rgb8();
    let strokes = strokes(&found)?;
    let mut both =
        RgbImage::from_pixel(photo.width() + GAP_PX + strokes.width(), HEIGHT_PX, image::Rgb([u8::MAX; 3]));
    imageops::replace(&mut both, &photo, 0, 0);
    imageops::replace(&mut both, &strokes, i64::from(photo.width() + GAP_PX), 0);
    both.save(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let (true_strokes, strokes) = (photograph.truth.polylines.len(), found.strokes().len());
    print(&format!("{true_strokes} strokes were drawn, {strokes} are found\n"))
}

/// The right panel: the strokes on a white sheet with a grey edge.
fn strokes(drawing: &Drawing) -> Result<RgbImage, String> {
    let scale = f64::from(HEIGHT_PX) / f64::from(drawing.height_px().max(1));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a panel's width")]
    let width = (f64::from(drawing.width_px()) * scale) as u32;
    let mut panel = Pixmap::new(width, HEIGHT_PX).ok_or("the panel has no pixels")?;
    panel.fill(Color::WHITE);
    for (stroke, [red, green, blue]) in drawing.strokes().zip(COLOURS.into_iter().cycle()) {
        let mut path = PathBuilder::new();
        for (index, at) in stroke.iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "to be drawn on a small picture")]
            let (x, y) = ((at.x * scale) as f32, (at.y * scale) as f32);
            if index == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color_rgba8(red, green, blue, 255);
        let pen = Stroke {
            width: PEN_PX,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        if let Some(path) = path.finish() {
            panel.stroke_path(&path, &paint, &pen, Transform::identity(), None);
        }
    }
    let pixels: Vec<u8> = panel.pixels().iter().flat_map(|at| [at.red(), at.green(), at.blue()]).collect();
    let mut panel = RgbImage::from_raw(width, HEIGHT_PX, pixels).ok_or("the panel has another size")?;
    // The sheet's grey edge.
    for (x, y) in (0..width).flat_map(|x| [(x, 0), (x, HEIGHT_PX - 1)]) {
        panel.put_pixel(x, y, image::Rgb([190; 3]));
    }
    for (x, y) in (0..HEIGHT_PX).flat_map(|y| [(0, y), (width - 1, y)]) {
        panel.put_pixel(x, y, image::Rgb([190; 3]));
    }
    Ok(panel)
}
