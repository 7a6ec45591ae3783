//! [`Evened`]: a picture in uneven light, faint, rough or on dirty paper, as if its ink were black and its
//! paper white.
//!
//! ```text
//!   levels ─▶ smoothed ─▶ which side is ink ─▶ closing: the paper ─▶ darkness, a share of it
//!                                                                         │
//!     white paper, black ink ◀─ parts that stand out ◀─ half of the ink ◀─┴─▶ noise, how dark ink is,
//!     grey rims                 of the noise              in each place        how wide the lines are
//! ```
//!
//! The closing (the least of the greatest levels in windows wider than the lines) follows shadows and the
//! edges of reflections to a pixel, and bridges lines. Divided by it, paper is white wherever it lies. What
//! is left of the paper, its noise, is measured in tiles. A pixel is ink where it is darker than half of the
//! darkest around it, so that a faint line beside a black one has its own width, and darker than the noise
//! can be. Strokes with grain and gaps, of pencil and chalk, are first looked at in long narrow windows along
//! them.
//!
//! Source: the closing as background, J. Serra, *Image Analysis and Mathematical Morphology* (1982), chapter
//! 12 (the black top hat); the division by it, S. Lu, B. Su, C. L. Tan, "Document image binarization using
//! background estimation and stroke edges" (2010), section 3.1; a threshold from the darkness of ink near
//! edges, B. Su, S. Lu, C. L. Tan, "Robust document image binarization technique for degraded document
//! images" (2013), section III.

mod look;
mod oriented;
mod paper;
mod parts;
mod plane;
mod ridges;
mod sheet_edge;
mod side;

use crate::ink::evenness::Evenness;
use crate::ink::{Polarity, pen_width_px};
use crate::picture::runs::ink_runs;
use crate::picture::{Bitmap, Gray, Pixel};
pub use look::Look;
use paper::{DARKEST_PAPER, Paper};
use parts::{Part, Parts};
use plane::{LEVEL, Plane, WHITE, mean, rounded, whole};
use ridges::Ridges;
use sheet_edge::SheetEdge;

/// The first look smooths so much, px: the noise of single pixels, and no line.
const FIRST_SIGMA_PX: f32 = 1.0;

/// The second one smooths by this part of the lines' width, within these bounds, px: rough rims become
/// smooth, corners stay where they are.
const SIGMA_OF_WIDTH: f32 = 0.18;
const SIGMA_PX: core::ops::RangeInclusive<f32> = 0.8..=4.0;

/// What was smoothed is sharpened by taking away what is smoothed so many times more; not what is enlarged,
/// for the steps of its pixels would come out again.
const SHARPENED_BY: f32 = 1.5;

/// And the noise's standard deviation becomes so many times what it is. Of white noise that was smoothed by σ,
/// with the power exp(−σ²ω²), the gain 2 − exp(−(1.5 σ)² ω² / 2) leaves, over the plane, a variance of
/// 4 − 4 / (1 + 1.5² / 2) + 1 / (1 + 1.5²) = 2.43 times.
const SHARPENED_NOISE: f32 = 1.56;

/// Rough strokes are looked at as sharply as this, px, for windows along them smooth enough.
const ROUGH_SIGMA_PX: f32 = 0.6;

/// Windows of the closing reach so far, px: a part of the picture's shorter side at first, then some widths
/// of the lines, and never less than twelve pixels.
const FIRST_REACH: usize = 32;
const REACH_WIDTHS: usize = 6;
const LEAST_REACH_PX: usize = 12;

/// Ink is darker than the paper by so many standard deviations of its noise, and a part of it is somewhere by
/// so many.
const OUT_OF_NOISE: f32 = 5.0;
const SURELY_OUT: f32 = 8.0;

/// Ink is darker than this part of the darkest around.
const HALF: f32 = 0.5;

/// The darkness of sure ink, as a part of the usual.
const SURE_INK: f32 = 0.3;

/// Strokes have gaps when they fall into so many times the parts that they are when blurred by half a width,
/// and some parts more: the letters of a word run together, too.
const BROKEN: f32 = 1.5;
const FEW_PARTS: f32 = 20.0;
const BLURRED_WIDTHS: f32 = 0.5;

/// A part is a stroke, and no speck, from so much of a square of the lines' width on.
const LEAST_SQUARES: f32 = 0.4;

/// A part shorter than so many widths of the lines must be as dark as this part of the usual ink, a longer
/// one as that: fibres and specks are short and pale.
const SHORT_WIDTHS: f32 = 8.0;
const DARK_IF_SHORT: f32 = 0.6;
const DARK_IF_LONG: f32 = 0.3;

/// How far the rims of what is left out reach, px.
const RIM_PX: u32 = 2;

/// And those of ink, px: blurred by a camera, too.
const NEAR_PX: u32 = 4;

/// A picture whose ink is black and whose paper is white.
#[derive(Clone, Debug)]
pub(crate) struct Evened {
    /// The levels: up to [`Evened::LEVEL`] is ink.
    pub(crate) gray: Gray,
    /// What was found.
    pub(crate) look: Look,
}

impl Evened {
    /// Levels up to this one are ink.
    pub(crate) const LEVEL: u8 = 127;

    /// Most pixels of a picture that is looked at so, which takes 10 bytes each.
    pub(crate) const MAX_PIXELS: u64 = 1 << 26;

    /// Evens a picture; `keeps_pale` takes what is much paler than the lines for ink, too.
    pub(crate) fn of(gray: &Gray, polarity: Polarity, keeps_pale: bool) -> Self {
        let (width, height) = (gray.width() as usize, gray.height() as usize);
        let mut smooth = Plane::smoothed(gray, FIRST_SIGMA_PX, false);
        let seen_sheet = SheetEdge::of(&smooth);
        let sheet = seen_sheet.filter(|sheet| !sheet.may_be_shadow());
        let light_ink = match polarity {
            Polarity::Minority => side::ink_is_light(&smooth),
            Polarity::DarkInk => false,
            Polarity::LightInk => true,
        };
        if light_ink {
            smooth.in_rows(|_, row| row.iter_mut().for_each(|value| *value = WHITE.saturating_sub(*value)));
        }
        let first_reach = (width.min(height) / FIRST_REACH).max(LEAST_REACH_PX);
        let (first, paper) = darkness(smooth, first_reach, sheet);
        let mut look = Look { light_ink, noise_levels: paper.usual_noise / LEVEL, ..Look::default() };
        look.sheet = seen_sheet.map(|sheet| sheet.corners);
        let Some(ridges) = Ridges::of(&first, &paper, keeps_pale) else { return Self::empty(gray, look) };
        look.ink_levels = ridges.ink / LEVEL;
        let evenness = Evenness::of(gray);
        let contrast = f64::from(look.ink_levels) * mean_light(gray, light_ink);
        look.enlarged = evenness.is_enlarged(contrast);
        look.pale_levels = ridges.pale.map(|pale| pale / LEVEL);

        let sure = Sure { noise: OUT_OF_NOISE, darkness: HALF * ridges.ink };
        let sure_ink = sure.ink(&first, &paper, 3);
        let sheet = seen_sheet.filter(|sheet| !(sheet.may_be_shadow() && sheet.has_ink_beside(&sure_ink)));
        look.sheet = sheet.map(|sheet| sheet.corners);
        let (pen_px, ink_pixels) = (pen_width_px(&sure_ink).unwrap_or(3), sure_ink.count());
        drop((first, sure_ink));
        let mut width_px = px(pen_px);
        let reach = (REACH_WIDTHS * pen_px as usize).clamp(LEAST_REACH_PX, first_reach);
        let sigma_px = (SIGMA_OF_WIDTH * width_px).clamp(*SIGMA_PX.start(), *SIGMA_PX.end());
        let (mut dark, mut paper) = darkness(Plane::smoothed(gray, sigma_px, light_ink), reach, sheet);
        let sure = Sure { noise: 0.0, darkness: ridges.least_ink().max(SURE_INK * ridges.ink) };
        let pieces = |dark: &Plane, paper: &Paper| {
            let ink = sure.ink(dark, paper, pen_px as usize / 2 + 1);
            Parts::of(&ink, dark, paper).parts.iter().filter(|part| part.area_px >= 3).count()
        };
        let blurred = dark.blurred(BLURRED_WIDTHS * width_px);
        look.broken = count(pieces(&dark, &paper)) > BROKEN * count(pieces(&blurred, &paper)) + FEW_PARTS
            || evenness.is_grainy(!light_ink, contrast, ink_pixels);
        drop(blurred);
        if look.broken {
            drop(dark); // its memory is needed
            let smooth = Plane::smoothed(gray, ROUGH_SIGMA_PX, light_ink);
            let (rough, rough_paper) = darkness(smooth, reach, sheet);
            loop {
                dark = oriented::along_lines(&rough, width_px, OUT_OF_NOISE * rough_paper.usual_noise);
                paper = rough_paper.again(&dark, sheet);
                paper.take_from(&mut dark);
                // What lay in pieces seemed narrower than it is.
                let whole_px = pen_width_px(&sure.ink(&dark, &paper, pen_px as usize / 2 + 1));
                match whole_px.map(px) {
                    Some(whole_px) if whole_px > width_px && whole_px <= 2.0 * px(pen_px) => {
                        width_px = whole_px
                    }
                    _ => break,
                }
            }
        } else if !look.enlarged {
            dark.sharpen(SHARPENED_BY * sigma_px);
            paper.make_rougher(SHARPENED_NOISE);
        }
        look.line_px = width_px;
        let radius_px = width_px / 2.0 + sigma_px;
        let (mut levels, mut ink) = leveled(&dark, &paper, radius_px, ridges.least_ink(), sheet);
        let found = Parts::of(&ink, &dark, &paper);
        let kept = strokes(&found.parts, width_px);
        look.left_out = kept.iter().filter(|kept| !**kept).count();
        leave_out(&found, &kept, &mut ink, &mut levels);
        if ink.count() == 0 {
            return Self::empty(gray, look);
        }
        whiten_far_from(&ink, &mut levels);
        Self { gray: Gray::of_checked_size(gray.width(), gray.height(), levels), look }
    }

    /// Whether nothing is ink.
    pub(crate) fn is_empty(&self) -> bool {
        self.gray.pixels().iter().all(|level| *level > Self::LEVEL)
    }

    /// Without ink: its noise is that of the picture itself, for nothing tells which side is ink.
    fn empty(gray: &Gray, mut look: Look) -> Self {
        look.noise_levels = Paper::medians(&Plane::smoothed(gray, FIRST_SIGMA_PX, false)).usual_noise / LEVEL;
        let white = vec![u8::MAX; gray.pixels().len()];
        Self { gray: Gray::of_checked_size(gray.width(), gray.height(), white), look }
    }
}

/// How much darker each place is than the paper there, as a share of 255 levels, and what is left of the
/// paper. Beside the sheet, where that is known, nothing is dark.
fn darkness(smooth: Plane, reach_px: usize, sheet: Option<SheetEdge>) -> (Plane, Paper) {
    /// The closing's own steps are smoothed so much, of half as many pixels.
    const STEPS_PX: f32 = 1.5;
    /// Paper may be lighter than the closing says by so many levels, which its noise needs to be measured.
    const LIGHTER: f32 = 16.0;
    let radius = reach_px.div_ceil(2);
    let light = smooth.halved(mean).closed(radius).blurred(STEPS_PX);
    let mut darkness = smooth;
    darkness.in_rows(|y, row| {
        let mut paper = vec![0.0_f32; row.len()];
        light.doubled_row(y, &mut paper);
        for (value, paper) in row.iter_mut().zip(paper) {
            let share = 1.0 - f32::from(*value) / paper.max(DARKEST_PAPER * LEVEL);
            *value = rounded((share * 255.0 + LIGHTER) * LEVEL);
        }
    });
    let paper = Paper::of(&darkness, &light, sheet);
    paper.take_from(&mut darkness);
    if let Some(sheet) = sheet {
        let width = darkness.width;
        darkness.in_rows(|y, row| {
            let on_sheet = sheet.columns(y, width);
            (0..).zip(row).filter(|(x, _)| !on_sheet.contains(x)).for_each(|(_, value)| *value = 0);
        });
    }
    (darkness, paper)
}

/// The mean level, as a part of white, of a picture that is mostly paper: how light that is in the mean.
fn mean_light(gray: &Gray, ink_is_light: bool) -> f64 {
    let all: u64 = gray.pixels().iter().map(|level| u64::from(*level)).sum();
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    let mean = all as f64 / gray.pixels().len().max(1) as f64 / 255.0;
    if ink_is_light { 1.0 - mean } else { mean }
}

/// What is ink for sure.
#[derive(Clone, Copy, Debug)]
struct Sure {
    /// In standard deviations of the noise.
    noise: f32,
    /// In levels of a plane.
    darkness: f32,
}

impl Sure {
    /// The pixels that are darker than that, and than half of the darkest so far around.
    fn ink(self, dark: &Plane, paper: &Paper, radius_px: usize) -> Bitmap {
        let peaks = dark.halved(u16::max).extreme(radius_px.div_ceil(2), false);
        marked(dark, |y, is_ink| {
            let mut around = vec![0.0; dark.width];
            peaks.doubled_row(y, &mut around);
            let noise = paper.noise_row(y);
            for (((is_ink, value), around), noise) in
                is_ink.iter_mut().zip(dark.row(y)).zip(around).zip(noise)
            {
                let least = (HALF * around).max(self.darkness).max(self.noise * noise);
                *is_ink = f32::from(*value) > least;
            }
        })
    }
}

/// The pixels of a plane that `mark` says are ink, row by row.
fn marked(dark: &Plane, mut mark: impl FnMut(usize, &mut [bool])) -> Bitmap {
    let side = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    // A plane is of a picture's size, so the empty bitmap is never wrong.
    let Ok(mut ink) = Bitmap::new(side(dark.width), side(dark.height)) else { return Bitmap::empty() };
    let mut is_ink = vec![false; dark.width];
    for y in 0..dark.height {
        mark(y, &mut is_ink);
        for (x, _) in (0..).zip(&is_ink).filter(|(_, is_ink)| **is_ink) {
            ink.set(Pixel::new(x, side(y)), true);
        }
    }
    ink
}

/// Levels in which half of the darkest around is the level of ink, and the ink.
fn leveled(
    dark: &Plane,
    paper: &Paper,
    radius_px: f32,
    least: f32,
    sheet: Option<SheetEdge>,
) -> (Vec<u8>, Bitmap) {
    // The peaks stand for the ink around when they are smoothed by about half the way to the next.
    let peaks = dark.halved(u16::max).extreme(whole(radius_px / 2.0) + 1, false);
    let peaks = peaks.blurred((radius_px / 4.0).max(0.5));
    let mut levels = vec![u8::MAX; dark.width * dark.height];
    let mut rows = levels.chunks_mut(dark.width.max(1));
    let ink = marked(dark, |y, is_ink| {
        let mut around = vec![0.0; dark.width];
        peaks.doubled_row(y, &mut around);
        let on_sheet = sheet.map_or(0..dark.width, |sheet| sheet.columns(y, dark.width));
        let levels = rows.next().unwrap_or_default();
        let places = levels.iter_mut().zip(is_ink).zip(dark.row(y)).zip(around).zip(paper.noise_row(y));
        for (x, ((((level, is_ink), value), around), noise)) in places.enumerate() {
            let half = (HALF * around).max(OUT_OF_NOISE * noise).max(least).max(1.0);
            if on_sheet.contains(&x) {
                *level = to_level(255.0 - 127.5 * f32::from(*value) / half);
            }
            *is_ink = *level <= Evened::LEVEL;
        }
    });
    (levels, ink)
}

/// Which parts are strokes.
fn strokes(parts: &[Part], width_px: f32) -> Vec<bool> {
    let stands_out = |part: &&Part| part.peak_of_noise > SURELY_OUT;
    // Half of all ink is in parts darker than this.
    let mut by_darkness: Vec<&Part> = parts.iter().filter(stands_out).collect();
    by_darkness.sort_by(|one, other| one.mean.total_cmp(&other.mean));
    let all: usize = by_darkness.iter().map(|part| part.area_px).sum();
    let mut paler = 0;
    let half = by_darkness.iter().find(|part| {
        paler += part.area_px;
        2 * paler >= all
    });
    let usual = half.map_or(0.0, |part| part.mean);
    let is_stroke = |part: &Part| {
        let is_short = count(part.extent_px) < SHORT_WIDTHS * width_px;
        let least = if is_short { DARK_IF_SHORT } else { DARK_IF_LONG };
        stands_out(&part)
            && part.mean > least * usual
            && count(part.area_px) > LEAST_SQUARES * width_px * width_px
    };
    parts.iter().map(is_stroke).collect()
}

/// Makes paper of the parts that are not kept, with their rims.
fn leave_out(found: &Parts, kept: &[bool], ink: &mut Bitmap, levels: &mut [u8]) {
    let (width, height) = (ink.width(), ink.height());
    let left_out = || found.runs.iter().filter(|(_, _, part)| kept.get(*part) != Some(&true));
    for (y, run, _) in left_out() {
        run.clone().for_each(|x| ink.set(Pixel::new(x, *y), false));
    }
    for (y, run, _) in left_out() {
        let columns = run.start.saturating_sub(RIM_PX)..(run.end + RIM_PX).min(width);
        for row in y.saturating_sub(RIM_PX)..(y + RIM_PX + 1).min(height) {
            for x in columns.clone().filter(|x| !ink.get(Pixel::new(*x, row))) {
                if let Some(level) = levels.get_mut(row as usize * width as usize + x as usize) {
                    *level = u8::MAX;
                }
            }
        }
    }
}

/// Makes paper white where no ink is near: whoever looks at a part of it alone sees no noise.
fn whiten_far_from(ink: &Bitmap, levels: &mut [u8]) {
    let width = ink.width() as usize;
    let mut is_near = vec![false; width];
    for (y, levels) in (0..ink.height()).zip(levels.chunks_mut(width.max(1))) {
        is_near.fill(false);
        for row in y.saturating_sub(NEAR_PX)..(y + NEAR_PX + 1).min(ink.height()) {
            for run in ink_runs(ink.row(row)) {
                let near = run.start.saturating_sub(NEAR_PX) as usize..(run.end + NEAR_PX) as usize;
                if let Some(near) = is_near.get_mut(near.start..near.end.min(width)) {
                    near.fill(true);
                }
            }
        }
        for (level, _) in levels.iter_mut().zip(&is_near).filter(|(_, is_near)| !**is_near) {
            *level = u8::MAX;
        }
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the levels")]
fn to_level(level: f32) -> u8 {
    (level + 0.5).clamp(0.0, 255.0) as u8
}

#[expect(clippy::cast_precision_loss, reason = "a width of some pixels")]
fn px(width_px: u32) -> f32 {
    width_px as f32
}

#[expect(clippy::cast_precision_loss, reason = "a picture's parts")]
fn count(parts: usize) -> f32 {
    parts as f32
}
