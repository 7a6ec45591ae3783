//! [`SimulatedCamera`]: what a cheap camera sees of a drawing.

use super::random::Random;
use super::whole::level;
use super::{Lens, Paper};
use crate::{picture::Gray, stroke::PxPoint};

/// Random levels that are drawn from; a power of two.
const NOISE: usize = 1 << 14;

/// A camera that looks at a drawing: its window, and all that is wrong with it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields, default)
)]
#[non_exhaustive]
pub struct CameraSettings {
    /// Width of the window, px.
    pub width_px: u32,
    /// Height of the window, px.
    pub height_px: u32,
    /// Standard deviation of the spot that a point becomes, px.
    pub blur_px: f64,
    /// Standard deviation of the noise, levels of 255.
    pub noise_levels: f64,
    /// Light at the corners, as a share of that in the middle; it falls with the square of the distance.
    pub rim_light: f64,
    /// Level of white paper in the middle.
    pub white_level: f64,
    /// What the lens does.
    pub lens: Lens,
    /// Of the noise.
    pub seed: u64,
}

impl CameraSettings {
    /// The same with another [`CameraSettings::width_px`].
    #[must_use]
    pub const fn with_width_px(self, width_px: u32) -> Self {
        Self { width_px, ..self }
    }

    /// The same with another [`CameraSettings::height_px`].
    #[must_use]
    pub const fn with_height_px(self, height_px: u32) -> Self {
        Self { height_px, ..self }
    }

    /// The same with another [`CameraSettings::blur_px`].
    #[must_use]
    pub const fn with_blur_px(self, blur_px: f64) -> Self {
        Self { blur_px, ..self }
    }

    /// The same with another [`CameraSettings::noise_levels`].
    #[must_use]
    pub const fn with_noise_levels(self, noise_levels: f64) -> Self {
        Self { noise_levels, ..self }
    }

    /// The same with another [`CameraSettings::rim_light`].
    #[must_use]
    pub const fn with_rim_light(self, rim_light: f64) -> Self {
        Self { rim_light, ..self }
    }

    /// The same with another [`CameraSettings::white_level`].
    #[must_use]
    pub const fn with_white_level(self, white_level: f64) -> Self {
        Self { white_level, ..self }
    }

    /// The same with another [`CameraSettings::lens`].
    #[must_use]
    pub const fn with_lens(self, lens: Lens) -> Self {
        Self { lens, ..self }
    }

    /// The same with another [`CameraSettings::seed`].
    #[must_use]
    pub const fn with_seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }
}

impl Default for CameraSettings {
    /// The camera of the tests: 300 x 300 px as its author found sufficient, badly focused (1.5 px), noise of 4 levels, light
    /// falling to 60 % at the rim, no distortion.
    fn default() -> Self {
        Self {
            width_px: 300,
            height_px: 300,
            blur_px: 1.5,
            noise_levels: 4.0,
            rim_light: 0.6,
            white_level: 230.0,
            lens: Lens::default(),
            seed: 1,
        }
    }
}

/// A camera over a drawing.
///
/// ```
/// # use plotter_vector::{PxPoint, follow::{CameraSettings, Paper, SimulatedCamera}};
/// let line = vec![PxPoint::new(0.0, 50.0), PxPoint::new(400.0, 50.0)];
/// let paper = Paper::drawn(400, 100, &[(line, 8.0)])?;
/// let mut camera = SimulatedCamera::new(&paper, CameraSettings::default().with_noise_levels(0.0));
/// let window = camera.window(PxPoint::new(200.0, 50.0));
/// let level = |x, y| window.get(plotter_vector::Pixel::new(x, y)).unwrap();
/// assert!(level(150, 150) < 20 && level(150, 100) > 200);
/// # Ok::<(), plotter_vector::picture::GrayError>(())
/// ```
#[derive(Clone, Debug)]
pub struct SimulatedCamera {
    paper: Paper,
    settings: CameraSettings,
    /// For each pixel of the window: where it looks, from the window's middle, and the light there.
    looks: Vec<[f32; 3]>,
    noise: Vec<f32>,
    random: Random,
}

impl SimulatedCamera {
    /// A camera over a paper.
    #[must_use]
    pub fn new(paper: &Paper, settings: CameraSettings) -> Self {
        let (width, height) = (f64::from(settings.width_px), f64::from(settings.height_px));
        let corner = 0.5 * libm::hypot(width, height);
        let look = |x: u32, y: u32| {
            let seen = PxPoint::new(f64::from(x) + 0.5 - 0.5 * width, f64::from(y) + 0.5 - 0.5 * height);
            let share = libm::hypot(seen.x, seen.y) / corner;
            let light = settings.white_level * (1.0 - (1.0 - settings.rim_light) * share * share);
            let true_place = settings.lens.straightened(seen, corner);
            #[expect(clippy::cast_possible_truncation, reason = "a window is small")]
            [true_place.x as f32, true_place.y as f32, light as f32]
        };
        let (columns, rows) = (settings.width_px, settings.height_px);
        let looks = (0..rows).flat_map(|y| (0..columns).map(move |x| look(x, y))).collect();
        let mut random = Random::new(settings.seed);
        #[expect(clippy::cast_possible_truncation, reason = "levels")]
        let noise = (0..NOISE).map(|_| (settings.noise_levels * random.normal()) as f32).collect();
        Self { paper: paper.blurred(settings.blur_px), settings, looks, noise, random }
    }

    /// The window when the camera's middle is over a place of the paper.
    #[must_use]
    pub fn window(&mut self, at: PxPoint) -> Gray {
        let noisy = self.settings.noise_levels > 0.0;
        let mut state = self.random.next() | 1;
        #[expect(clippy::cast_possible_truncation, reason = "a paper's places are small")]
        let (x, y) = (at.x as f32, at.y as f32);
        let mut levels = Vec::with_capacity(self.looks.len());
        for [dx, dy, light] in &self.looks {
            let mut seen = light * self.paper.at(x + dx, y + dy);
            if noisy {
                // Marsaglia's xorshift picks one of the numbers drawn before.
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                let index = usize::try_from(state >> 40).unwrap_or(0) % NOISE;
                seen += self.noise.get(index).copied().unwrap_or(0.0);
            }
            levels.push(level(seen));
        }
        Gray::of_checked_size(self.settings.width_px, self.settings.height_px, levels)
    }
}
