//! Draws `docs/pictures/crossing.png`: two pen lines that cross, as scanned, as thinned, and as drawn by
//! ours.
//!
//! Left the scan, pixel by pixel. In the middle what thinning alone makes of it: the two lines run into each
//! other and share a stretch, `>--<`, which a plotter would draw. Right our strokes: two lines, each straight
//! through the other. Look at the figures as well: how far each drawing lies from the lines that were
//! scanned.
//!
//! ```text
//! cargo run --release --example draw_crossing                 # rewrites docs/pictures/crossing.png
//! cargo run --release --example draw_crossing -- FILE.png
//! ```

use clap::Parser;
use plotter_examples::shared::{print, run};
use plotter_vector::{Bitmap, Gray, Pixel, PxPoint, Threshold, Vectorizer};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use tiny_skia::{Color, LineCap, Paint, PathBuilder, Pixmap, Rect, Stroke, Transform};

/// Size of the scan, px, and of a scanned pixel in the picture.
const SCAN: (u32, u32) = (60, 38);
const ZOOM: u32 = 6;
/// Between the panels, px of the picture.
const GAP: u32 = 18;
/// The lines that are scanned, and their width, px.
const LINES: [[(f32, f32); 2]; 2] = [[(4.3, 11.2), (55.8, 26.1)], [(5.6, 27.7), (54.9, 8.4)]];
const PEN_PX: f32 = 7.0;

const WHITE: [u8; 3] = [255, 255, 255];
const OURS: [u8; 3] = [20, 90, 200];
const THINNED: [u8; 3] = [205, 30, 30];

/// Draws a crossing of two pen lines as scanned, as thinning alone leaves it, and as ours draws it.
#[derive(Debug, Parser)]
#[command(after_help = "Example:\n  draw_crossing crossing.png")]
struct Arguments {
    /// PNG to write [default: docs/pictures/crossing.png of the project]
    file: Option<PathBuf>,
}

fn main() -> ExitCode {
    let Arguments { file } = Arguments::parse();
    run("draw_crossing", || draw(file))
}

fn draw(file: Option<PathBuf>) -> Result<(), String> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/pictures/crossing.png");
    let file = file.unwrap_or_else(beside);
    let scan = scan()?;
    let thinned = thinned(&scan)?;
    let ours = ours(&scan)?;
    let picture = picture(&scan, &thinned, &ours)?;
    picture.save_png(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    print(&format!(
        "greatest distance from the scanned lines: thinning alone {:.2} px in {} strokes, ours {:.2} px in {}\n",
        farthest(&thinned),
        thinned.len(),
        farthest(&ours),
        ours.len()
    ))
}

/// The crossing with grey edges, as a scanner sees it.
fn scan() -> Result<Gray, String> {
    let mut sheet = pixmap(SCAN.0, SCAN.1)?;
    for line in LINES {
        stroke(&mut sheet, &line, PEN_PX, [0; 3]);
    }
    let light = sheet.pixels().iter().map(|pixel| pixel.red()).collect();
    Gray::new(SCAN.0, SCAN.1, light).map_err(|error| error.to_string())
}

/// Our strokes.
fn ours(scan: &Gray) -> Result<Vec<Vec<(f32, f32)>>, String> {
    let traced = Vectorizer::default().vectorize(scan).map_err(|error| error.to_string())?;
    Ok(traced.drawing.strokes().map(|stroke| stroke.iter().copied().map(narrow).collect()).collect())
}

/// The skeleton as thinning leaves it: a piece from each of its pixels to each neighbour.
fn thinned(scan: &Gray) -> Result<Vec<Vec<(f32, f32)>>, String> {
    let (ink, _) = Threshold::default().apply(scan);
    let skeleton = thinned_plainly(ink);
    let mut pieces = Vec::new();
    for at in skeleton.ink() {
        let right = Pixel::new(at.x + 1, at.y);
        let below = Pixel::new(at.x, at.y + 1);
        let across = [Pixel::new(at.x + 1, at.y + 1), Pixel::new(at.x.wrapping_sub(1), at.y + 1)];
        for side in [right, below] {
            if skeleton.get(side) {
                pieces.push(vec![narrow(at.into()), narrow(side.into())]);
            }
        }
        for corner in across {
            // Over a corner only where no side leads there.
            let sides = [Pixel::new(at.x, corner.y), Pixel::new(corner.x, at.y)];
            if skeleton.get(corner) && !sides.into_iter().any(|side| skeleton.get(side)) {
                pieces.push(vec![narrow(at.into()), narrow(corner.into())]);
            }
        }
    }
    Ok(pieces)
}

/// Thinning as published, and nothing else.
///
/// Source: Zhang and Suen, "A fast parallel algorithm for thinning digital patterns", Commun. ACM 27 (3),
/// 1984.
fn thinned_plainly(mut ink: Bitmap) -> Bitmap {
    loop {
        let before = ink.count();
        for first in [true, false] {
            let gone: Vec<Pixel> = ink.ink().filter(|at| deleted(&ink, *at, first)).collect();
            for at in gone {
                ink.set(at, false);
            }
        }
        if ink.count() == before {
            return ink;
        }
    }
}

/// Whether one of the two passes deletes the pixel.
fn deleted(ink: &Bitmap, at: Pixel, first: bool) -> bool {
    let get = |dx: i32, dy: i32| match (at.x.checked_add_signed(dx), at.y.checked_add_signed(dy)) {
        (Some(x), Some(y)) => ink.get(Pixel::new(x, y)),
        _ => false,
    };
    // P2 to P9 of the paper: from above, clockwise.
    let [north, ne, east, se, south, sw, west, nw] =
        [get(0, -1), get(1, -1), get(1, 0), get(1, 1), get(0, 1), get(-1, 1), get(-1, 0), get(-1, -1)];
    let ring = [north, ne, east, se, south, sw, west, nw, north];
    let neighbours = ring[..8].iter().filter(|ink| **ink).count();
    let rises = ring.windows(2).filter(|pair| !pair[0] && pair[1]).count();
    let (three, other) = if first {
        (north && east && south, east && south && west)
    } else {
        (north && east && west, north && south && west)
    };
    (2..=6).contains(&neighbours) && rises == 1 && !three && !other
}

/// Greatest distance of any vertex or middle of a piece from the nearer of the scanned lines, px.
fn farthest(strokes: &[Vec<(f32, f32)>]) -> f32 {
    let mut farthest = 0.0_f32;
    for pair in strokes.iter().flat_map(|stroke| stroke.windows(2)) {
        let middle = (f32::midpoint(pair[0].0, pair[1].0), f32::midpoint(pair[0].1, pair[1].1));
        for at in [pair[0], middle, pair[1]] {
            let nearest = LINES.iter().map(|line| distance(at, line)).fold(f32::INFINITY, f32::min);
            farthest = farthest.max(nearest);
        }
    }
    farthest
}

fn distance((x, y): (f32, f32), [from, to]: &[(f32, f32); 2]) -> f32 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let share = (((x - from.0) * dx + (y - from.1) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    libm::hypotf(x - from.0 - share * dx, y - from.1 - share * dy)
}

/// The three panels side by side.
fn picture(scan: &Gray, thinned: &[Vec<(f32, f32)>], ours: &[Vec<(f32, f32)>]) -> Result<Pixmap, String> {
    let (width, height) = (SCAN.0 * ZOOM, SCAN.1 * ZOOM);
    let mut sheet = pixmap(3 * width + 2 * GAP, height)?;
    for (place, (lines, colour)) in
        [(&[][..], WHITE), (thinned, THINNED), (ours, OURS)].into_iter().enumerate()
    {
        let mut panel = pixmap(width, height)?;
        // Behind strokes the scan is pale.
        let pale = if lines.is_empty() { 0.0 } else { 0.75 };
        for (y, row) in (0_u16..).zip(scan.rows()) {
            for (x, light) in (0_u16..).zip(row) {
                let light = f32::from(*light) / 255.0;
                let level = light + (1.0 - light) * pale;
                fill(&mut panel, f32::from(x), f32::from(y), level)?;
            }
        }
        for line in lines {
            let zoomed: Vec<(f32, f32)> = line.iter().map(|(x, y)| (x * zoom(), y * zoom())).collect();
            stroke(&mut panel, &zoomed, 2.5, colour);
        }
        let left =
            i32::try_from(place).ok().zip(i32::try_from(width + GAP).ok()).map_or(0, |(n, step)| n * step);
        sheet.draw_pixmap(
            left,
            0,
            panel.as_ref(),
            &tiny_skia::PixmapPaint::default(),
            Transform::identity(),
            None,
        );
    }
    Ok(sheet)
}

fn zoom() -> f32 {
    u16::try_from(ZOOM).map_or(1.0, f32::from)
}

/// One scanned pixel with a hair of paper round it.
fn fill(panel: &mut Pixmap, x: f32, y: f32, level: f32) -> Result<(), String> {
    let side = zoom() - 0.5;
    let square = Rect::from_xywh(x * zoom(), y * zoom(), side, side).ok_or("a pixel without area")?;
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    let level = level.clamp(0.0, 1.0);
    paint.set_color(Color::from_rgba(level, level, level, 1.0).ok_or("a level outside 0..=1")?);
    panel.fill_rect(square, &paint, Transform::identity(), None);
    Ok(())
}

fn stroke(sheet: &mut Pixmap, points: &[(f32, f32)], width: f32, [red, green, blue]: [u8; 3]) {
    let mut path = PathBuilder::new();
    for (place, (x, y)) in points.iter().enumerate() {
        if place == 0 { path.move_to(*x, *y) } else { path.line_to(*x, *y) }
    }
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, 255);
    let pen = Stroke { width, line_cap: LineCap::Round, ..Stroke::default() };
    if let Some(path) = path.finish() {
        sheet.stroke_path(&path, &paint, &pen, Transform::identity(), None);
    }
}

fn pixmap(width: u32, height: u32) -> Result<Pixmap, String> {
    let mut sheet = Pixmap::new(width, height).ok_or("a picture without pixels")?;
    let [red, green, blue] = WHITE;
    sheet.fill(Color::from_rgba8(red, green, blue, 255));
    Ok(sheet)
}

fn narrow(at: PxPoint) -> (f32, f32) {
    #[expect(clippy::cast_possible_truncation, reason = "to be drawn on a small picture")]
    let narrow = (at.x as f32, at.y as f32);
    narrow
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_alone_bends_the_lines_at_their_crossing() {
        // Half the pen is 3.5 px; the shared stretch lies off both lines.
        assert!(farthest(&thinned(&scan().unwrap()).unwrap()) > 1.0);
    }

    #[test]
    fn ours_is_two_lines_that_stay_on_theirs() {
        let ours = ours(&scan().unwrap()).unwrap();
        assert_eq!(ours.len(), 2);
        assert!(farthest(&ours) < 0.6, "{}", farthest(&ours));
    }

    #[test]
    fn a_bar_thins_to_its_middle() {
        let bar = Bitmap::from_picture("........\n.######.\n.######.\n.######.\n........\n").unwrap();
        assert_eq!(thinned_plainly(bar).to_string().lines().nth(2), Some("..###..."));
    }
}
