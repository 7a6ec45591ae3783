//! [`Sheet`]: a picture in the making, red, green and blue from 0 to 255 and beyond.

use super::plane::Plane;
use super::texture::grain;
use crate::corpus::random::Random;
use image::{DynamicImage, GrayImage, Luma, Rgb, RgbImage};

/// Of a camera's noise, this share of the standard deviation is the same in all colours, and this is each
/// colour's own; the squares' sum is 1.
const NOISE_SHARES: (f64, f64) = (0.8, 0.6);

/// Three planes of the same size.
#[derive(Clone, Debug)]
pub(crate) struct Sheet {
    pub(crate) channels: [Plane; 3],
}

impl Sheet {
    /// Paper, or a board, that a share of ink covers.
    pub(crate) fn inked(paper: [f64; 3], ink: [f64; 3], cover: &Plane) -> Self {
        let mut colours = paper.into_iter().zip(ink);
        let channels = [(); 3].map(|()| {
            let (under, over) = colours.next().unwrap_or_default();
            cover.map(|share| under + (over - under) * share)
        });
        Self { channels }
    }

    pub(crate) fn size(&self) -> (usize, usize) {
        (self.channels[0].width, self.channels[0].height)
    }

    /// Each pixel changed by the same rule for all colours.
    pub(crate) fn changed(&self, by: &Plane, rule: impl Fn(f64, f64) -> f64) -> Self {
        Self { channels: self.channels.each_ref().map(|plane| plane.with(by, &rule)) }
    }

    pub(crate) fn lit(&self, light: &Plane) -> Self {
        self.changed(light, |value, light| value * light)
    }

    pub(crate) fn plus(&self, levels: &Plane) -> Self {
        self.changed(levels, |value, more| value + more)
    }

    pub(crate) fn blurred(&self, sd_px: f64) -> Self {
        Self { channels: self.channels.each_ref().map(|plane| plane.blurred(sd_px)) }
    }

    /// With a camera's noise: `sd` levels, resembling over `size_px`.
    pub(crate) fn noisy(&self, sd: f64, size_px: f64, random: &mut Random) -> Self {
        let (width, height) = self.size();
        let (shared, own) = NOISE_SHARES;
        let all = grain(width, height, size_px, random).map(|value| value * sd * shared);
        let channels = self.channels.each_ref().map(|plane| {
            let one = grain(width, height, size_px, random);
            plane.with(&all, |value, noise| value + noise).with(&one, |value, noise| value + sd * own * noise)
        });
        Self { channels }
    }

    /// As levels.
    pub(crate) fn picture(&self) -> DynamicImage {
        let (width, height) = self.size();
        let [red, green, blue] = &self.channels;
        let mut pixels = red.values.iter().zip(&green.values).zip(&blue.values);
        RgbImage::from_fn(small(width), small(height), |_, _| {
            let ((red, green), blue) = pixels.next().unwrap_or(((&0.0, &0.0), &0.0));
            Rgb([level(*red), level(*green), level(*blue)])
        })
        .into()
    }
}

/// A plane as a grey picture.
pub(crate) fn grey_picture(plane: &Plane) -> DynamicImage {
    let mut values = plane.values.iter();
    GrayImage::from_fn(small(plane.width), small(plane.height), |_, _| {
        Luma([level(values.next().copied().unwrap_or(0.0))])
    })
    .into()
}

/// Ink as black, the rest white: where at least half of a pixel is covered.
pub(crate) fn ink_picture(cover: &Plane) -> GrayImage {
    grey_picture(&cover.map(|share| if share >= 0.5 { 0.0 } else { 255.0 })).into_luma8()
}

fn small(size: usize) -> u32 {
    u32::try_from(size).unwrap_or(0)
}

fn level(value: f64) -> u8 {
    let value = libm::round(value).clamp(0.0, 255.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and from 0 to 255")]
    let value = value as u8;
    value
}
