//! [`Canvas`]: the ink that pens are held against, and how far what they draw is from it.
//!
//! Only pixels on the wrong side of a pen's edge cost anything, and of a good plan there are few. So all pens
//! are drawn first by squares alone. How far a pixel that contradicts them lies off is found for it alone, as
//! long as the plan can still win.

use super::pens::{Bundle, COLUMNS, Capsule, INK, LANES, PAPER, capsules};
use super::prices::FARTHEST_PX;
use crate::PxVec;
use crate::centreline::graph::Scan;
use crate::picture::{Bitmap, Pixel};
use crate::stroke::PxPoint;
use core::cell::RefCell;

/// Farthest pixel of a canvas from its middle, px: it has a hundred columns and rows at most.
const MOST_PX: f64 = 48.0;

/// Ink in a square of a picture.
pub(crate) struct Canvas {
    /// The square's upper left corner.
    corner: PxPoint,
    /// Pixels of a row, whole [`LANES`].
    stride: usize,
    /// What each pixel is: [`INK`], [`PAPER`] or, where it does not matter, 0.
    asked: Vec<u32>,
    /// What was last drawn: memory for the next.
    cells: RefCell<Vec<u32>>,
}

/// What some pens have drawn on a canvas.
pub(crate) struct Layer {
    cells: Vec<u32>,
    pens: Vec<Bundle>,
}

impl Canvas {
    /// The ink within a radius of a place; none of one that is too large.
    pub(crate) fn around(scan: Scan<'_>, centre: PxPoint, radius_px: f64) -> Option<Self> {
        if radius_px > MOST_PX {
            return None;
        }
        let corner = |v: f64| libm::floor(v - radius_px).max(0.0);
        let corner = PxPoint::new(corner(centre.x), corner(centre.y));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 98")]
        let side = libm::ceil(2.0 * radius_px + 1.0) as usize;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
        let (left, top) = (corner.x as u32, corner.y as u32);
        let mut canvas = Self::empty(corner, side, side);
        let PxVec { x, y } = centre - corner;
        for ((row, line), at_y) in (top..).zip(canvas.asked.chunks_exact_mut(canvas.stride)).zip(&COLUMNS) {
            let dy = f64::from(*at_y) - y;
            let mut ink = scan.ink_from(Pixel::new(left, row));
            for (ask, at_x) in line.iter_mut().zip(&COLUMNS).take(side) {
                let dx = f64::from(*at_x) - x;
                if dx * dx + dy * dy <= radius_px * radius_px {
                    *ask = if ink & 1 == 1 { INK } else { PAPER };
                }
                ink >>= 1;
            }
        }
        Some(canvas)
    }

    /// All of a small picture; what of a large one lies below or to the right does not matter.
    pub(crate) fn of(ink: &Bitmap) -> Self {
        let side = |px: u32| (px as usize).min(COLUMNS.len());
        let (width, height) = (ink.width(), ink.height());
        let mut canvas = Self::empty(PxPoint::default(), side(width), side(height));
        for (y, line) in (0..height).zip(canvas.asked.chunks_exact_mut(canvas.stride)) {
            for (x, ask) in (0..width).zip(line) {
                *ask = if ink.get(Pixel::new(x, y)) { INK } else { PAPER };
            }
        }
        canvas
    }

    fn empty(corner: PxPoint, width: usize, height: usize) -> Self {
        let stride = width.next_multiple_of(LANES);
        Self { corner, stride, asked: vec![0; height * stride], cells: RefCell::default() }
    }

    /// Adds what a pen covers that goes through some places, each with half its width there; px.
    pub(crate) fn add_pen(&self, places: impl Iterator<Item = (PxPoint, f64)>, pens: &mut Vec<Capsule>) {
        capsules(places.map(|(at, half_px)| (self.inside(at), half_px)), pens);
    }

    /// A place as seen from the canvas' corner.
    fn inside(&self, at: PxPoint) -> PxPoint {
        let PxVec { x, y } = at - self.corner;
        PxPoint::new(x, y)
    }

    /// What some pens draw.
    pub(crate) fn layer(&self, pens: &[Capsule]) -> Layer {
        let mut cells = vec![0; self.asked.len()];
        pens.iter().for_each(|pen| pen.draw(&mut cells, self.stride));
        Layer { cells, pens: Bundle::of(pens) }
    }

    /// How much the ink differs from what a layer's pens and some more leave, when that is less than `limit`:
    /// the squared distances of all pixels whose middles are on the wrong side of the pens' edges, px².
    pub(crate) fn residual(&self, under: &Layer, pens: &[Capsule], limit: f64) -> Option<f64> {
        let bundles = Bundle::of(pens);
        let outside_px = |x: f32, y: f32| {
            let all = bundles.iter().chain(&under.pens);
            all.fold(FARTHEST_PX, |least, bundle| bundle.outside_px(x, y, least))
        };
        let mut cells = self.cells.borrow_mut();
        cells.clone_from(&under.cells);
        pens.iter().for_each(|pen| pen.draw(&mut cells, self.stride));
        let mut residual = 0.0;
        let rows = cells.chunks_exact(self.stride).zip(self.asked.chunks_exact(self.stride)).zip(&COLUMNS);
        for ((cells, asked), y) in rows {
            let wrong = |(cell, asked): (&u32, &u32)| (cell ^ INK) & asked;
            if cells.iter().zip(asked).map(wrong).fold(0, |any, wrong| any | wrong) == 0 {
                continue;
            }
            for (pixel, x) in cells.iter().zip(asked).zip(&COLUMNS) {
                let off_px = match wrong(pixel) {
                    0 => continue,
                    INK => outside_px(*x, *y),
                    _ => -outside_px(*x, *y),
                };
                let off_px = f64::from(off_px).clamp(0.0, FARTHEST_PX.into());
                residual += off_px * off_px;
            }
            if residual >= limit {
                return None;
            }
        }
        (residual < limit).then_some(residual)
    }

    /// The pixel of ink that some pens leave farthest from their edges, and how far, px; none where no ink is
    /// bare.
    pub(crate) fn barest(&self, pens: &[Capsule]) -> Option<(PxPoint, f64)> {
        let layer = self.layer(pens);
        let mut best: Option<(PxPoint, f32)> = None;
        let rows = layer.cells.chunks_exact(self.stride).zip(self.asked.chunks_exact(self.stride));
        for ((cells, asked), y) in rows.zip(&COLUMNS) {
            for ((cell, asked), x) in cells.iter().zip(asked).zip(&COLUMNS) {
                if (cell ^ INK) & asked != INK {
                    continue;
                }
                let off_px =
                    layer.pens.iter().fold(f32::INFINITY, |least, bundle| bundle.outside_px(*x, *y, least));
                if best.is_none_or(|(_, most_px)| off_px > most_px) {
                    best = Some((self.corner + PxVec::new((*x).into(), (*y).into()), off_px));
                }
            }
        }
        best.map(|(at, off_px)| (at, off_px.into()))
    }
}
