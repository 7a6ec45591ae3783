//! Draws `docs/pictures/photograph.png`: a drawing on a table as a telephone sees it, and the strokes that
//! ours finds on its sheet.
//!
//! Left the photograph, made by the corpus of degraded drawings: perspective, shade, blur and noise. Right
//! what `trace --paper auto` draws of it, each stroke in a colour of its own. Look at the figures as well:
//! how many strokes were drawn, and how many are found.
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
use plotter_vector::{Drawing, Prefer, Vectorizer, decode};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tiny_skia::{Color, LineCap, LineJoin, Paint, PathBuilder, Pixmap, Stroke, Transform};

/// Of the corpus: a page of cartoons.
const SEED: u64 = 1;
const NUMBER: u32 = 4;
/// Height of both panels, and the way between them, px.
const HEIGHT_PX: u32 = 520;
const GAP_PX: u32 = 24;
/// Width of a stroke as it is shown, px.
const PEN_PX: f32 = 1.6;
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
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures/photograph.png");
    let file = file.unwrap_or_else(beside);
    let drawn = Drawn::new(drawing(SEED, NUMBER), &drawing(SEED, NUMBER + 101));
    let photograph = drawn
        .degraded(Kind::Perspective, Strength::Middle, SEED, NUMBER)
        .map_err(|error| format!("the photograph: {error}"))?;
    let gray = decode(&photograph.file).map_err(|error| error.to_string())?;
    let quad = SheetQuad::find(&gray).map_err(|error| error.to_string())?;
    let sheet = quad
        .straightened(quad.proportion(gray.width(), gray.height()))
        .ok_or("a sheet that is seen from its edge")?
        .gray(&gray);
    let vectorizer = Vectorizer { prefer: Prefer::Strokes, ..Vectorizer::default() };
    let found = vectorizer.vectorize(&sheet).map_err(|error| error.to_string())?.drawing;

    let seen = image::load_from_memory(&photograph.file).map_err(|error| error.to_string())?;
    let seen = seen.resize(u32::MAX, HEIGHT_PX, imageops::FilterType::Triangle).into_rgb8();
    let strokes = strokes(&found)?;
    let mut both =
        RgbImage::from_pixel(seen.width() + GAP_PX + strokes.width(), HEIGHT_PX, image::Rgb([u8::MAX; 3]));
    imageops::replace(&mut both, &seen, 0, 0);
    imageops::replace(&mut both, &strokes, i64::from(seen.width() + GAP_PX), 0);
    both.save(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    let (true_strokes, strokes) = (photograph.truth.polylines.len(), found.strokes().len());
    print(&format!("{true_strokes} strokes were drawn, {strokes} are found\n"))
}

/// The strokes on a white sheet with a rim.
fn strokes(drawing: &Drawing) -> Result<RgbImage, String> {
    let scale = f64::from(HEIGHT_PX) / f64::from(drawing.height_px().max(1));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a panel's width")]
    let width = (f64::from(drawing.width_px()) * scale) as u32;
    let mut panel = Pixmap::new(width, HEIGHT_PX).ok_or("a sheet without pixels")?;
    panel.fill(Color::WHITE);
    for (stroke, [red, green, blue]) in drawing.strokes().zip(COLOURS.into_iter().cycle()) {
        let mut path = PathBuilder::new();
        for (place, at) in stroke.iter().enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "to be drawn on a small picture")]
            let (x, y) = ((at.x * scale) as f32, (at.y * scale) as f32);
            if place == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
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
    let mut panel = RgbImage::from_raw(width, HEIGHT_PX, pixels).ok_or("a panel of another size")?;
    // The sheet's edge.
    for (x, y) in (0..width).flat_map(|x| [(x, 0), (x, HEIGHT_PX - 1)]) {
        panel.put_pixel(x, y, image::Rgb([190; 3]));
    }
    for (x, y) in (0..HEIGHT_PX).flat_map(|y| [(0, y), (width - 1, y)]) {
        panel.put_pixel(x, y, image::Rgb([190; 3]));
    }
    Ok(panel)
}
