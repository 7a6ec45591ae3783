//! The ruling of squared and ruled paper, which no pen drew.
//!
//! It is paler than all that was drawn, level or upright, and all over the sheet up to its edges.

use super::mixing_line::MixingLine;
use crate::ink::line_width::pen_width_px;
use crate::picture::{Bitmap, Oklab};

/// The sheet is looked at in so many fields along each side. A hand leaves some of them free.
const FIELDS: u32 = 8;
/// Ruling is in this share of the fields, in each along half of a side at least.
const LEAST_FIELDS: f64 = 0.95;
/// Ink of ruling lies in level or upright runs of at least so many of its widths, but for this share: a sheet
/// that lies askew by a hundredth of its side has runs of a hundred px.
const RUN_WIDTHS: u32 = 6;
const LEAST_RULED: f64 = 0.6;

/// The index of the pen that is the paper's ruling, and no pen.
pub(super) fn ruling(lines: &[MixingLine], inks: &[Bitmap], paper: Oklab) -> Option<usize> {
    let contrast = |line: &MixingLine| line.pen_oklab().distance(paper);
    let (palest, line) =
        lines.iter().enumerate().min_by(|one, other| contrast(one.1).total_cmp(&contrast(other.1)))?;
    let ink = inks.get(palest)?;
    let is_paler = lines.len() > 1
        && lines.iter().enumerate().all(|(other, pen)| other == palest || contrast(line) < contrast(pen));
    (is_paler && is_everywhere(ink) && is_ruled(ink)).then_some(palest)
}

fn is_everywhere(ink: &Bitmap) -> bool {
    let (width, height) = (ink.width(), ink.height());
    let mut fields = [0_u32; (FIELDS * FIELDS) as usize];
    for at in ink.ink() {
        let (column, row) = (at.x * FIELDS / width.max(1), at.y * FIELDS / height.max(1));
        if let Some(field) = fields.get_mut((row * FIELDS + column) as usize) {
            *field += 1;
        }
    }
    let least = width.min(height) / FIELDS / 2;
    let full = fields.iter().filter(|pixels| **pixels >= least.max(1)).count();
    share(full as u64, u64::from(FIELDS * FIELDS)) >= LEAST_FIELDS
}

fn is_ruled(ink: &Bitmap) -> bool {
    let most = RUN_WIDTHS * pen_width_px(ink).unwrap_or(1);
    let sum = |(one, other): (u32, u32)| one + other + 1;
    let ruled = ink
        .ink()
        .filter(|at| sum(ink.run_level(*at, most)) >= most || sum(ink.run_upright(*at, most)) >= most);
    share(ruled.count() as u64, ink.count()) >= LEAST_RULED
}

#[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
fn share(part: u64, all: u64) -> f64 {
    part as f64 / all.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Pixel;

    fn squares(is_line: impl Fn(u32, u32) -> bool) -> Bitmap {
        let mut ink = Bitmap::new(400, 300).unwrap();
        for (x, y) in (0..300).flat_map(|y| (0..400).map(move |x| (x, y))).filter(|(x, y)| is_line(*x, *y)) {
            ink.set(Pixel::new(x, y), true);
        }
        ink
    }

    #[test]
    fn squares_over_all_of_a_sheet_are_ruling_and_a_drawn_grid_with_a_margin_is_none() {
        let is_line = |x: u32, y: u32| x % 30 < 2 || y % 30 < 2;
        let askew = |x: u32, y: u32| is_line(x + y / 80, y + 4 - x / 100);
        for ink in [squares(is_line), squares(askew)] {
            assert!(is_everywhere(&ink) && is_ruled(&ink));
        }
        let inside = squares(|x, y| (40..360).contains(&x) && (40..260).contains(&y) && is_line(x, y));
        assert!(!is_everywhere(&inside) && is_ruled(&inside));
        let slanting = squares(|x, y| (x + y) % 30 < 2);
        assert!(is_everywhere(&slanting) && !is_ruled(&slanting));
    }
}
