//! Ways in which scanners and programs degrade a drawing.

use super::drawn::Drawn;
use super::kind::Strength;
use super::parameters as p;
use super::plane::Plane;
use super::texture::grain;
use crate::corpus::random::Random;

/// A scan: soft, with a tone of paper and noise.
pub(crate) fn clean(cover: &Plane, strength: Strength, random: &mut Random) -> Plane {
    let tones = (p::CLEAN_PAPER.at(strength), p::CLEAN_INK.at(strength));
    scan(cover, p::CLEAN_BLUR.at(strength), tones, p::CLEAN_NOISE.at(strength), random)
}

fn scan(
    cover: &Plane,
    blur_px: f64,
    (paper, ink): (f64, f64),
    noise_levels: f64,
    random: &mut Random,
) -> Plane {
    let noise = grain(cover.width, cover.height, 0.0, random);
    cover
        .blurred(blur_px)
        .map(|share| paper + (ink - paper) * share)
        .with(&noise, |value, noise| value + noise_levels * noise)
}

/// What JPEG will be made of: a good scan.
pub(crate) fn for_jpeg(cover: &Plane, random: &mut Random) -> Plane {
    scan(cover, 0.5, (245.0, 35.0), 1.0, random)
}

/// Lines that are nearly the paper's tone.
pub(crate) fn faint(cover: &Plane, strength: Strength, random: &mut Random) -> Plane {
    let paper = 228.0;
    let tones = (paper, paper - p::FAINT_LEVEL.at(strength));
    scan(cover, 0.6, tones, p::FAINT_NOISE.at(strength), random)
}

/// A scan of a sheet whose back is drawn on too.
pub(crate) fn bleed_through(cover: &Plane, back: &Plane, strength: Strength, random: &mut Random) -> Plane {
    let (paper, ink) = (240.0, 40.0);
    let behind = back.blurred(p::BLEED_BLUR.at(strength));
    let share = p::BLEED_SHARE.at(strength);
    // What passes the paper darkens it; under ink nothing more is seen.
    let both = cover.blurred(0.6).with(&behind, |front, behind| 1.0 - (1.0 - front) * (1.0 - share * behind));
    let noise = grain(cover.width, cover.height, 0.0, random);
    both.map(|share| paper + (ink - paper) * share).with(&noise, |value, noise| value + 2.0 * noise)
}

/// A small picture of the drawing, one pixel for `factor` x `factor`, and the pens' widths in the large one.
pub(crate) fn small(drawn: &Drawn, factor: f64, strength: Strength) -> (Plane, impl Fn(f64) -> f64 + use<>) {
    let least = factor * p::ENLARGED_LEAST.at(strength);
    let pen = move |width_px: f64| width_px.max(least);
    // The centre of the first small pixel is that of the first factor x factor large ones.
    let place = |value: f64| (value - (factor - 1.0) / 2.0) / factor;
    let size = |large: usize| {
        let mut count = 0;
        while f64::from(count) * factor < large as f64 {
            count += 1;
        }
        usize::try_from(count).unwrap_or(0)
    };
    let (width, height) = (size(drawn.cover.width), size(drawn.cover.height));
    let cover = super::cover::cover(
        &drawn.picture.strokes,
        (width, height),
        |(x, y)| (place(x), place(y)),
        |width_px| pen(width_px) / factor,
    );
    (cover.map(|share| 250.0 - 235.0 * share), pen)
}
