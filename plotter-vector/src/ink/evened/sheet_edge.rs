//! [`SheetEdge`]: where the sheet ends and the table begins, in a photograph that shows both.

use super::plane::{LEVEL, Plane, mean};
use crate::picture::Bitmap;
use crate::picture::runs::ink_runs;

/// The sheet is looked for in a picture of about this many columns and rows.
const COARSE_PX: usize = 256;

/// The sheet covers at least this part of the picture, and something else at least that one: less is a
/// scanner's rim.
const LEAST_SHEET: f32 = 0.2;
const LEAST_REST: f32 = 0.04;

/// How much of the region its four-sided outline holds, and how much of that is the region: a round patch of
/// light fills no more than two thirds.
const FILLED: core::ops::RangeInclusive<f32> = 0.93..=1.07;

/// The table is darker than the sheet by this many levels, right beside its edge; a shadow falls off softly.
const LEAST_STEP: f32 = 24.0;

/// Inside and outside of the edge, coarse pixels from it.
const BESIDE: f32 = 3.0;

/// The part of the places along the edge that must show the step.
const MOST_OF_EDGE: f32 = 0.75;

/// A side is none of the picture's where something lies beside so many of its places.
const HALF_A_SIDE: f32 = 15.0;

/// A single step across the picture is the edge of a shadow where ink lies as close beside it as on it, to
/// this part: a table has no lines as dark as the drawing's, or few.
const GOES_ON: f32 = 0.5;

/// What is nearer to the sheet's edge belongs to the edge, as a part of the picture's shorter side.
const EDGE: f32 = 0.008;

/// A light sheet on a darker table: its four corners, px, around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SheetEdge {
    pub(super) corners: [(f32, f32); 4],
    margin_px: f32,
    /// How many of its sides are no sides of the picture.
    sides: u8,
}

impl SheetEdge {
    /// The sheet in a picture, where something else is seen beside it.
    #[expect(clippy::cast_precision_loss, reason = "a coarse picture's side")]
    pub(super) fn of(levels: &Plane) -> Option<Self> {
        let (full_width, full_height) = (levels.width, levels.height);
        let mut coarse = levels.clone();
        let mut scale = 1.0_f32;
        while coarse.width.max(coarse.height) > COARSE_PX {
            coarse = coarse.halved(mean);
            scale *= 2.0;
        }
        // Lines on the sheet are closed.
        let coarse = coarse.closed(2);
        let (width, height) = (coarse.width, coarse.height);
        let mut counts = [0_u64; 256];
        for value in &coarse.values {
            if let Some(n) = counts.get_mut(usize::from(value >> 8)) {
                *n += 1;
            }
        }
        let split = u16::from(crate::picture::histogram::otsu(&counts, 24)?) << 8 | 0xff;
        let region = largest(&coarse, split)?;
        let total = (width * height) as f32;
        let area = region.len() as f32;
        if area < LEAST_SHEET * total || area > (1.0 - LEAST_REST) * total {
            return None;
        }
        // The corners are farthest along the diagonals.
        let farthest = |along: fn(f32, f32) -> f32| {
            let place = |at: &usize| ((at % width) as f32 + 0.5, (at / width) as f32 + 0.5);
            region.iter().map(place).max_by(|a, b| along(a.0, a.1).total_cmp(&along(b.0, b.1)))
        };
        let corners = [
            farthest(|x, y| -x - y)?,
            farthest(|x, y| x - y)?,
            farthest(|x, y| x + y)?,
            farthest(|x, y| y - x)?,
        ];
        let next = |index: usize| corners.get((index + 1) % 4).copied().unwrap_or_default();
        let sides = || corners.iter().enumerate().map(|(index, from)| (*from, next(index)));
        let outline: f32 = sides().map(|((x, y), (to_x, to_y))| x * to_y - to_x * y).sum::<f32>() / 2.0;
        if !FILLED.contains(&(area / outline.max(1.0))) {
            return None;
        }
        // Along the sides, but for those that are the picture's own: is there a step?
        let (mut places, mut steps, mut seen) = (0.0_f32, 0.0_f32, 0);
        for ((x, y), (to_x, to_y)) in sides() {
            let before = places;
            let length = libm::hypotf(to_x - x, to_y - y).max(1.0);
            let (out_x, out_y) = ((to_y - y) / length * BESIDE, (x - to_x) / length * BESIDE);
            for part in 1..32_u8 {
                let part = f32::from(part) / 32.0;
                let (at_x, at_y) = (x + (to_x - x) * part, y + (to_y - y) * part);
                let level = |x: f32, y: f32| {
                    let inside = x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32;
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "inside the picture"
                    )]
                    inside.then(|| f32::from(coarse.near(x as usize, y as usize, 0, 0)) / LEVEL)
                };
                let beside = (level(at_x - out_x, at_y - out_y), level(at_x + out_x, at_y + out_y));
                if let (Some(inside), Some(outside)) = beside {
                    places += 1.0;
                    steps += f32::from(u8::from(inside - outside > LEAST_STEP));
                }
            }
            seen += u8::from(places - before > HALF_A_SIDE);
        }
        if places < 16.0 || steps < MOST_OF_EDGE * places {
            return None;
        }
        let margin_px = EDGE * full_width.min(full_height) as f32 + scale;
        Some(Self { corners: corners.map(|(x, y)| (x * scale, y * scale)), margin_px, sides: seen })
    }

    /// Whether it may be the edge of a shadow: one step across the picture, and no more sides.
    pub(super) fn may_be_shadow(&self) -> bool {
        self.sides < 2
    }

    /// Whether the drawing goes on beside it.
    pub(super) fn has_ink_beside(&self, ink: &Bitmap) -> bool {
        let mut ink_px = [0_u64; 2];
        let mut all_px = [0_u64; 2];
        for y in 0..ink.height() {
            let on_sheet = self.columns(y as usize, ink.width() as usize);
            let [inside, outside] = &mut all_px;
            *inside += on_sheet.len() as u64;
            *outside += (u64::from(ink.width())).saturating_sub(on_sheet.len() as u64);
            for x in ink_runs(ink.row(y)).flatten() {
                let [inside, outside] = &mut ink_px;
                *(if on_sheet.contains(&(x as usize)) { inside } else { outside }) += 1;
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
        let share = |ink_px: u64, px: u64| ink_px as f32 / px.max(1) as f32;
        let ([ink_in, ink_out], [all_in, all_out]) = (ink_px, all_px);
        share(ink_out, all_out) > GOES_ON * share(ink_in, all_in)
    }

    /// The columns of row `y` that are surely on the sheet.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a picture's side"
    )]
    pub(super) fn columns(&self, y: usize, width: usize) -> core::ops::Range<usize> {
        let y = y as f32 + 0.5;
        let (mut from, mut to) = (0.0_f32, width as f32);
        for (index, (x0, y0)) in self.corners.iter().enumerate() {
            let (x1, y1) = self.corners.get((index + 1) % 4).copied().unwrap_or_default();
            // The corners go around clockwise: inside lies to the right of each side.
            let (dx, dy) = (x1 - x0, y1 - y0);
            let margin = self.margin_px * libm::hypotf(dx, dy);
            // dx (y - y0) - dy (x - x0) > margin.
            let rest = dx * (y - y0) - margin + dy * x0;
            if dy.abs() < 1e-3 {
                if rest < 0.0 {
                    return 0..0;
                }
            } else if dy > 0.0 {
                to = to.min(rest / dy);
            } else {
                from = from.max(rest / dy);
            }
        }
        let from = libm::ceilf(from.max(0.0)) as usize;
        from..(to.max(0.0) as usize).max(from)
    }
}

/// The places of the largest region of values above a level.
fn largest(levels: &Plane, above: u16) -> Option<Vec<usize>> {
    let width = levels.width;
    let mut seen: Vec<bool> = levels.values.iter().map(|value| *value <= above).collect();
    let mut best: Vec<usize> = Vec::new();
    for start in 0..seen.len() {
        let mut region = Vec::new();
        let mut open = vec![start];
        while let Some(at) = open.pop() {
            if seen.get(at).copied() != Some(false) {
                continue;
            }
            if let Some(seen) = seen.get_mut(at) {
                *seen = true;
            }
            region.push(at);
            let column = at % width;
            open.extend((column > 0).then(|| at - 1));
            open.extend((column + 1 < width).then_some(at + 1));
            open.extend(at.checked_sub(width));
            open.push(at + width);
        }
        if region.len() > best.len() {
            best = region;
        }
    }
    (!best.is_empty()).then_some(best)
}
