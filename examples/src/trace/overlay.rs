//! [`overlay_png`]: the strokes on the picture that they were made from.

use plotter_vector::{Drawing, Palette, Pixel, Rgb};
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PremultipliedColorU8, Stroke, Transform,
};

/// Small pictures are enlarged up to this side, px.
const SIDE_PX: u32 = 2000;
/// Most times that a picture is enlarged.
const MOST_TIMES: u32 = 4;
/// Larger pictures are made smaller, so that this is the longest side, px.
const LONGEST_PX: u32 = 8192;
/// How much of the picture's contrast is left.
const PALE: f32 = 0.35;
/// Farthest that arcs are from the chords that are shown, px.
const CHORD_ERROR_PX: f64 = 0.05;
/// What is drawn where there are no colours.
const RED: Rgb = Rgb([208, 24, 24]);
const MAGENTA: Rgb = Rgb([224, 0, 200]);

/// How the picture is shown.
#[derive(Clone, Copy, Debug)]
pub struct Overlay<'a> {
    /// The strokes.
    pub drawing: &'a Drawing,
    /// Colours of the pens; without them everything is red.
    pub palette: Option<&'a Palette>,
    /// The pixel that is circled.
    pub worst: Option<Pixel>,
}

/// Of a picture of this size only every so manyth column and row is asked for.
#[must_use]
pub fn overlay_step(width: u32, height: u32) -> u32 {
    width.max(height).max(1).div_ceil(LONGEST_PX)
}

/// Draws strokes on a pale picture, as PNG: enlarged two to four times where it stays below 2000 px, and then
/// with a dot on each vertex. `level` gives the picture's colours.
///
/// # Errors
///
/// A picture without pixels, or that memory does not hold.
pub fn overlay_png(overlay: Overlay<'_>, level: impl Fn(Pixel) -> [u8; 3]) -> Result<Vec<u8>, String> {
    let drawing = overlay.drawing;
    let (width, height) = (drawing.width_px(), drawing.height_px());
    let times = (SIDE_PX / width.max(height).max(1)).clamp(1, MOST_TIMES);
    let smaller = overlay_step(width, height);
    let size = |side: u32| side.saturating_mul(times).div_ceil(smaller);
    let mut pixmap = Pixmap::new(size(width), size(height))
        .ok_or_else(|| format!("{width} x {height} px cannot be shown: leave --overlay out"))?;

    let columns = pixmap.width();
    for (index, pixel) in (0_u32..).zip(pixmap.pixels_mut()) {
        let at = Pixel::new(index % columns * smaller / times, index / columns * smaller / times);
        let [red, green, blue] = level(at).map(pale);
        if let Some(colour) = PremultipliedColorU8::from_rgba(red, green, blue, u8::MAX) {
            *pixel = colour;
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "at most 4 and 16")]
    let scale = times as f32 / smaller as f32;
    let width = if times > 1 { 1.5 } else { 1.0 };
    for (index, stroke) in drawing.strokes().enumerate() {
        let colour = match overlay.palette {
            Some(palette) => palette.pen(drawing.pen(index)).map_or(Rgb::BLACK, |pen| pen.colour),
            None => RED,
        };
        let mut line = PathBuilder::new();
        let mut dots = PathBuilder::new();
        // A path of one place is not drawn; one that goes nowhere is, as a round dot.
        let dot = if stroke.len() == 1 { stroke } else { &[] };
        for (at, place) in drawing.curve(index).chords(CHORD_ERROR_PX).iter().chain(dot).enumerate() {
            let (x, y) = (single(place.x) * scale, single(place.y) * scale);
            if at == 0 { line.move_to(x, y) } else { line.line_to(x, y) }
        }
        for vertex in stroke {
            let (x, y) = (single(vertex.x) * scale, single(vertex.y) * scale);
            if times > 1 || stroke.len() == 1 {
                dots.push_circle(x, y, 1.0 + 0.4 * scale);
            }
        }
        draw(&mut pixmap, line, colour, width);
        if let Some(dots) = dots.finish() {
            let rule = FillRule::Winding;
            pixmap.fill_path(&dots, &paint(darker(colour)), rule, Transform::identity(), None);
        }
    }
    if let Some(worst) = overlay.worst {
        #[expect(clippy::cast_precision_loss, reason = "a picture's side")]
        let (x, y) = ((worst.x as f32 + 0.5) * scale, (worst.y as f32 + 0.5) * scale);
        let mut circle = PathBuilder::new();
        circle.push_circle(x, y, 10.0 + 2.0 * scale);
        draw(&mut pixmap, circle, MAGENTA, 2.0);
    }
    pixmap.encode_png().map_err(|error| format!("the overlay cannot be encoded: {error}"))
}

fn draw(pixmap: &mut Pixmap, path: PathBuilder, colour: Rgb, width: f32) {
    let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
    if let Some(path) = path.finish() {
        pixmap.stroke_path(&path, &paint(colour), &stroke, Transform::identity(), None);
    }
}

fn paint(Rgb([red, green, blue]): Rgb) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(Color::from_rgba8(red, green, blue, u8::MAX));
    paint
}

/// Vertices stand out from their lines; those of black ones by their size alone.
fn darker(Rgb(channels): Rgb) -> Rgb {
    Rgb(channels.map(|channel| channel / 2))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to 255")]
fn pale(level: u8) -> u8 {
    (255.0 - PALE * f32::from(u8::MAX - level)) as u8
}

#[expect(clippy::cast_possible_truncation, reason = "a place on a screen")]
fn single(place: f64) -> f32 {
    place as f32
}
