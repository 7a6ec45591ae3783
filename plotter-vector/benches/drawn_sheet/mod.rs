//! A sheet of a line drawing with soft rims, as a scanner sees it: what the benchmarks of the whole way work
//! on.

use plotter_vector::{Bitmap, Colour, Gray, Threshold};

/// Widths and heights of the sheets, px: 1, 4 and 16 megapixels.
pub(crate) const SIDES_PX: [u32; 3] = [1000, 2000, 4000];

/// Half the width of the lines, px.
const HALF_PX: f64 = 2.6;
/// Side of a cell of the pattern, px: a circle, two lines across it, and a short stroke.
const CELL_PX: u32 = 200;
/// Paper, and the pens of the cells by turns.
const PAPER: [u8; 3] = [248, 246, 240];
const PENS: [[u8; 3]; 3] = [[30, 30, 34], [200, 28, 30], [26, 60, 180]];

/// How much of a pixel is ink, 0 to 1, and which pen's.
fn ink_at(x: u32, y: u32) -> (f64, usize) {
    let pen = (x / CELL_PX + y / CELL_PX) as usize % PENS.len();
    let (u, v) = (f64::from(x % CELL_PX) - 100.0, f64::from(y % CELL_PX) - 100.0);
    let segment = |from: (f64, f64), to: (f64, f64)| {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let share = ((u - from.0) * dx + (v - from.1) * dy) / (dx * dx + dy * dy);
        let share = share.clamp(0.0, 1.0);
        libm::hypot(u - from.0 - share * dx, v - from.1 - share * dy)
    };
    let distances = [
        (libm::hypot(u, v) - 70.0).abs(),
        segment((-85.0, -60.0), (85.0, 40.0)),
        segment((-20.0, 85.0), (35.0, -85.0)),
        segment((70.0, 75.0), (88.0, 88.0)),
    ];
    let nearest = distances.into_iter().fold(f64::INFINITY, f64::min);
    ((HALF_PX + 0.5 - nearest).clamp(0.0, 1.0), pen)
}

fn mixed(paper: u8, pen: u8, share: f64) -> u8 {
    let level = f64::from(paper) + share * (f64::from(pen) - f64::from(paper));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between two levels")]
    let level = libm::round(level) as u8;
    level
}

/// The sheet in colour, a pen for each cell.
#[allow(dead_code, reason = "not every benchmark needs it")]
#[expect(clippy::expect_used, reason = "a benchmark without its picture measures nothing")]
pub(crate) fn colour(side_px: u32) -> Colour {
    let mut levels = Vec::new();
    for (x, y) in places(side_px) {
        let (share, pen) = ink_at(x, y);
        let pen = PENS.get(pen).copied().unwrap_or_default();
        levels.extend(PAPER.iter().zip(pen).map(|(paper, pen)| mixed(*paper, pen, share)));
    }
    Colour::new(side_px, side_px, levels).expect("three levels for each pixel")
}

/// The sheet in grey, drawn with one pen.
#[expect(clippy::expect_used, reason = "a benchmark without its picture measures nothing")]
pub(crate) fn gray(side_px: u32) -> Gray {
    let levels = places(side_px).map(|(x, y)| mixed(245, 30, ink_at(x, y).0)).collect();
    Gray::new(side_px, side_px, levels).expect("a level for each pixel")
}

/// Its ink.
#[allow(dead_code, reason = "not every benchmark needs it")]
pub(crate) fn ink(side_px: u32) -> Bitmap {
    Threshold::default().apply(&gray(side_px)).0
}

fn places(side_px: u32) -> impl Iterator<Item = (u32, u32)> {
    (0..side_px).flat_map(move |y| (0..side_px).map(move |x| (x, y)))
}
