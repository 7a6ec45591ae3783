//! Finds the pens that are none: the colour of two others' mixture, always beside them.
//!
//! Where black is drawn over blue, a dark blue lies between; where a picture's colours are smeared, as in
//! JPEG, it lies along the whole stroke. A dark blue pen has the same colour, but strokes of its own.

use super::bridge_gaps::grown;
use super::find_pens::makers;
use super::mixing_line::MixingLine;
use crate::picture::Bitmap;
use crate::picture::oklab::OklabTable;

/// Least share of a pen's ink that lies apart from the pens that could make its colour.
const LEAST_APART: f64 = 0.25;

/// A pen without a line of its own has at least so many pixels: others' rims have some of any colour.
const LEAST_INK: u64 = 12;

/// The lines that are left, or `None` when all are pens. `ink` is the ink of each.
pub(super) fn without_mixtures(
    lines: &[MixingLine],
    ink: &[Bitmap],
    table: &OklabTable,
) -> Option<Vec<MixingLine>> {
    let is_pen = |(index, (line, own)): (usize, (&MixingLine, &Bitmap))| {
        if lines.len() > 1 && !line.has_core() && own.count() < LEAST_INK {
            return false;
        }
        let makers = makers(lines, index, line.pen(), table);
        if makers == 0 {
            return true;
        }
        let mut beside: Option<Bitmap> = None;
        for (_, ink) in ink.iter().enumerate().filter(|(maker, _)| makers & 1 << maker != 0) {
            beside = Some(beside.map_or_else(|| ink.clone(), |all| all.united(ink)));
        }
        let Some(beside) = beside.map(|ink| grown(&grown(&ink))) else { return true };
        let apart = own.ink().filter(|at| !beside.get(*at)).count();
        #[expect(clippy::cast_precision_loss, reason = "at most 2²⁸")]
        let (apart, all) = (apart as f64, own.count() as f64);
        apart >= LEAST_APART * all
    };
    let pens = lines.iter().zip(ink).enumerate();
    let left: Vec<MixingLine> = pens.filter(|pen| is_pen(*pen)).map(|(_, (line, _))| line.clone()).collect();
    (left.len() < lines.len()).then_some(left)
}
