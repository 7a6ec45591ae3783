//! [`Ridges`]: how dark the ink is, told along the middles of its lines.

use super::paper::Paper;
use super::plane::{LEVEL, Plane};
use crate::picture::histogram;

/// A middle of a line stands out of the noise by so many standard deviations, and is darker than the paper by
/// so many levels.
const OUT_OF_NOISE: f32 = 6.0;
const LEAST_LEVELS: u16 = 8 << 8;

/// A middle is as dark as all places so far around, px.
const AROUND_PX: usize = 2;

/// Two kinds of ink: their means explain this part of all differences, the pale one is at most so dark beside
/// the other, and there are so many places of the dark one. A pencil beside a pen is darker; what shines
/// through the paper, its ruling and its specks are paler.
const TOLD_APART: f64 = 0.75;
const PALE: f64 = 0.35;
const LEAST_PLACES: u64 = 50;

/// Ink is at least so dark beside the usual one, where there is one kind.
const FAINTEST: f32 = 0.12;

/// How dark the middles of lines are, in levels of a plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ridges {
    /// The usual ink.
    pub(super) ink: f32,
    /// A paler kind that is none.
    pub(super) pale: Option<f32>,
}

impl Ridges {
    /// Of a picture's darkness; none where nothing stands out. `keeps_pale` takes all for ink.
    pub(super) fn of(darkness: &Plane, paper: &Paper, keeps_pale: bool) -> Option<Self> {
        let mut counts = [0_u64; 256];
        for y in 0..darkness.height {
            let noise = paper.noise_row(y);
            let rows = y.saturating_sub(AROUND_PX)..(y + AROUND_PX + 1).min(darkness.height);
            for (x, (value, noise)) in darkness.row(y).iter().zip(noise).enumerate() {
                if f32::from(*value) <= OUT_OF_NOISE * noise || *value <= LEAST_LEVELS {
                    continue;
                }
                let columns = x.saturating_sub(AROUND_PX)..(x + AROUND_PX + 1).min(darkness.width);
                let none_darker =
                    |y| darkness.row(y).get(columns.clone()).unwrap_or(&[]).iter().all(|near| near <= value);
                if rows.clone().all(none_darker)
                    && let Some(n) = counts.get_mut(usize::from(value >> 8))
                {
                    *n += 1;
                }
            }
        }
        let of = Class::of(&counts, 0);
        let median = of.median?;
        let mut found = Self { ink: f32::from(median) * LEVEL, pale: None };
        if let (Some(split), false) = (histogram::otsu(&counts, 0), keeps_pale) {
            let (below, above) = counts.split_at(usize::from(split) + 1);
            let (pale, dark) = (Class::of(below, 0), Class::of(above, u16::from(split) + 1));
            let between =
                |class: &Class| class.places_f64() * (class.mean - of.mean) * (class.mean - of.mean);
            let are_two = between(&pale) + between(&dark) > TOLD_APART * of.spread;
            if are_two && pale.mean < PALE * dark.mean && dark.places > LEAST_PLACES {
                #[expect(clippy::cast_possible_truncation, reason = "levels")]
                let level = |mean: f64| mean as f32 * LEVEL;
                found = Self { ink: level(dark.mean), pale: Some(level(pale.mean)) };
            }
        }
        Some(found)
    }

    /// What is paler is no ink.
    pub(super) fn least_ink(&self) -> f32 {
        self.pale.map_or(FAINTEST * self.ink, |pale| pale.midpoint(self.ink))
    }
}

/// What counts of levels say.
struct Class {
    places: u64,
    mean: f64,
    median: Option<u16>,
    /// The sum of all squared distances from the mean.
    spread: f64,
}

impl Class {
    /// Of counts whose first is that of level `first`.
    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    fn of(counts: &[u64], first: u16) -> Self {
        let levels = || (first..).zip(counts.iter().copied());
        let places: u64 = counts.iter().sum();
        let sum: f64 = levels().map(|(level, n)| f64::from(level) * n as f64).sum();
        let mean = sum / places.max(1) as f64;
        let mut below = 0;
        let half = levels().find(|(_, n)| {
            below += n;
            below > 0 && 2 * below >= places
        });
        let off = |(level, n): (u16, u64)| n as f64 * (f64::from(level) - mean) * (f64::from(level) - mean);
        Self { places, mean, median: half.map(|(level, _)| level), spread: levels().map(off).sum() }
    }

    #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
    fn places_f64(&self) -> f64 {
        self.places as f64
    }
}
