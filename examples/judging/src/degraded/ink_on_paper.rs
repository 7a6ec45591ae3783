//! Ways in which ink, graphite and chalk lie on what they are drawn on.

use super::kind::Strength;
use super::parameters as p;
use super::plane::Plane;
use super::sheet::Sheet;
use super::texture::{clouds, grain, quantile, step, streaks};
use crate::corpus::random::Random;

/// Noise of the scanner that pencil, marker and print are taken with, sd, levels: that of a clean scan.
const SCANNER_NOISE: f64 = 2.5;
/// Grain of drawing paper, of a board and of newsprint, sd, px: a tooth of about 0.2 mm at 120 dots per inch.
const TOOTH_PX: f64 = 0.8;
const BOARD_GRAIN_PX: f64 = 1.0;
const FIBRE_PX: f64 = 1.4;
/// From half to nothing and to all, in standard deviations of a ground's height: powder lies on slopes too.
const SLOPE: f64 = 0.45;

fn size(cover: &Plane) -> (usize, usize) {
    (cover.width, cover.height)
}

/// How much of what a stroke carries stays on a rough ground: less than half in the deepest `gaps` of it,
/// nothing far below, all above.
fn kept(grain: &Plane, gaps: f64) -> Plane {
    let lowest = quantile(gaps);
    grain.map(|height| step(lowest - SLOPE, lowest + SLOPE, height))
}

/// A rim that comes and goes by about `uneven_px`: the soft edge is cut at a level that changes from place to
/// place.
fn crept(cover: &Plane, soft_px: f64, uneven_px: f64, random: &mut Random) -> Plane {
    let (width, height) = size(cover);
    let soft = cover.blurred(soft_px.max(0.6));
    // A soft edge rises by about 0.4 of its height within one standard deviation.
    let rise = 0.4 * uneven_px / soft_px.max(0.6);
    let fibres = grain(width, height, FIBRE_PX, random);
    soft.with(&fibres, |share, fibre| {
        // Where there is no rim there is nothing to move.
        (share + rise * fibre * 4.0 * share * (1.0 - share)).clamp(0.0, 1.0)
    })
}

/// Graphite: gaps where paper is deep, a soft rim, pressure that changes.
pub(crate) fn pencil(cover: &Plane, strength: Strength, random: &mut Random) -> Plane {
    let (width, height) = size(cover);
    let tooth = grain(width, height, TOOTH_PX, random);
    let deposit = kept(&tooth, p::PENCIL_GAPS.at(strength));
    let press = clouds(width, height, 70.0, random).map(|value| 1.0 + p::PENCIL_PRESS.at(strength) * value);
    let soft = cover.blurred(p::PENCIL_BLUR.at(strength));
    let graphite = soft.with(&deposit, |share, kept| share * kept).with(&press, |share, press| share * press);
    let (paper, ink) = (244.0, p::PENCIL_INK.at(strength));
    let noise = grain(width, height, 0.5, random);
    let tone = clouds(width, height, 240.0, random);
    graphite
        .blurred(0.45)
        .map(|share| paper + (ink - paper) * share.min(1.0))
        .with(&noise, |value, noise| value + SCANNER_NOISE * noise)
        .with(&tone, |value, tone| value + 1.5 * tone)
}

/// Chalk on a board that was wiped: light lines with gaps, dust in streaks, veils beside the lines.
pub(crate) fn chalk(cover: &Plane, strength: Strength, random: &mut Random) -> Sheet {
    let (width, height) = size(cover);
    let rough = grain(width, height, BOARD_GRAIN_PX, random);
    let deposit = kept(&rough, p::CHALK_GAPS.at(strength));
    let line = crept(cover, 0.9, 0.5, random).with(&deposit, |share, kept| share * kept);
    let smear = p::CHALK_SMEAR.at(strength);
    let wipes = streaks((width, height), (60.0, 5.0), random);
    let patches = clouds(width, height, 260.0, random);
    let dust = wipes.with(&patches, |wipe, patch| smear * (0.25 + 0.22 * wipe + 0.3 * patch).clamp(0.0, 1.0));
    let veil = cover.blurred_apart(16.0, 4.0).map(|share| 0.7 * smear * share.min(1.0));
    let board = p::CHALK_BOARD.at(strength);
    let white = p::CHALK_INK.at(strength);
    Sheet::inked([0.86 * board, 1.08 * board, board], [white, white, 0.97 * white], &line.blurred(0.4))
        .plus(&dust)
        .plus(&veil)
        .plus(&rough.map(|value| 2.5 * value))
        .noisy(3.0, 0.5, random)
}

/// A felt pen: ink that creeps into the paper, streaks where it runs dry.
pub(crate) fn marker(cover: &Plane, strength: Strength, random: &mut Random) -> Sheet {
    let (width, height) = size(cover);
    let creep = crept(cover, p::MARKER_BLUR.at(strength), p::MARKER_CREEP.at(strength), random);
    let streaks = grain(width, height, 2.2, random)
        .with(&creep, |streak, share| p::MARKER_STREAKS.at(strength) * libm::fabs(streak) * share);
    Sheet::inked([245.0, 244.0, 240.0], [38.0, 42.0, 62.0], &creep).plus(&streaks).noisy(
        SCANNER_NOISE,
        0.5,
        random,
    )
}

/// Printed on grey, fibrous paper full of specks.
pub(crate) fn newsprint(cover: &Plane, strength: Strength, random: &mut Random) -> Sheet {
    let (width, height) = size(cover);
    let spread = crept(cover, 1.0, p::NEWS_SPREAD.at(strength), random);
    let sunk = grain(width, height, 1.2, random);
    let ink = spread.with(&sunk, |share, depth| (share * (1.0 - 0.12 * libm::fabs(depth))).clamp(0.0, 1.0));
    let mottle = clouds(width, height, 14.0, random)
        .with(&clouds(width, height, 3.0, random), |slow, fast| 0.8 * slow + 0.6 * fast);
    let dirt = specks((width, height), strength, random);
    let paper = p::NEWS_PAPER.at(strength);
    let dark = p::NEWS_INK.at(strength);
    Sheet::inked([paper, 0.975 * paper, 0.9 * paper], [dark, dark, 0.97 * dark], &ink)
        .plus(&mottle.map(|value| p::NEWS_MOTTLE.at(strength) * value))
        .plus(&dirt)
        .noisy(SCANNER_NOISE, 0.5, random)
}

/// Short dark fibres and specks, as levels below the paper.
fn specks((width, height): (usize, usize), strength: Strength, random: &mut Random) -> Plane {
    use super::cover::cover;
    use crate::corpus::strokes::{Look, Picture, polar};
    let count = p::NEWS_SPECKS.at(strength) * (width * height) as f64 / 1e4;
    let mut layers = Plane::even(width, height, 0.0);
    // Three tones are enough for none to look like another.
    for tone in [0.45, 0.7, 1.0] {
        let mut picture = Picture::new("specks", (1, 1), Look::Smooth, 1.0);
        let mut number = 0.0;
        while number < count / 3.0 {
            let at = (random.between(0.0, width as f64), random.between(0.0, height as f64));
            picture.pen(random.between(0.7, 1.9));
            if random.chance(0.3) {
                let (angle, long) = (random.between(0.0, core::f64::consts::TAU), random.between(6.0, 22.0));
                let middle = polar(at, 0.5 * long, angle);
                picture.line(&[at, middle, polar(middle, 0.5 * long, angle + random.between(-0.8, 0.8))]);
            } else {
                picture.line(&[at]);
            }
            number += 1.0;
        }
        let layer = cover(&picture.strokes, (width, height), |at| at, |pen| pen);
        layers = layers.with(&layer, |sum, share| sum.max(tone * share));
    }
    layers.map(|share| -p::NEWS_SPECK_LEVEL.at(strength) * share)
}
