//! [`parts`]: the connected parts of ink, each with what tells it from noise.

use super::paper::Paper;
use super::plane::Plane;
use crate::picture::Bitmap;
use crate::picture::joined_runs::{JoinedRuns, PartRun};

/// A connected part of ink, over corners too.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Part {
    /// Its pixels.
    pub(super) area_px: usize,
    /// The longer side of the box around it, px.
    pub(super) extent_px: usize,
    /// The mean over its pixels, in levels of a plane.
    pub(super) mean: f32,
    /// Its darkest pixel, in standard deviations of the noise around.
    pub(super) peak_of_noise: f32,
    columns: [u32; 2],
    rows: [u32; 2],
}

/// The runs of ink of all rows, and the part of each.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) runs: Vec<PartRun>,
    pub(super) parts: Vec<Part>,
}

impl Parts {
    pub(super) fn of(ink: &Bitmap, darkness: &Plane, paper: &Paper) -> Self {
        let (runs, count) = JoinedRuns::of(ink).parts();
        let mut parts: Vec<Part> = Vec::with_capacity(count);
        for (y, run, part) in &runs {
            if *part == parts.len() {
                parts.push(Part { columns: [run.start, run.end], rows: [*y, *y], ..Part::default() });
            }
            let Some(found) = parts.get_mut(*part) else { continue };
            found.area_px += run.len();
            found.columns = [found.columns[0].min(run.start), found.columns[1].max(run.end)];
            found.rows[1] = *y;
            let levels = darkness.row(*y as usize).get(run.start as usize..run.end as usize).unwrap_or(&[]);
            found.mean += levels.iter().map(|level| f32::from(*level)).sum::<f32>();
            for (x, level) in (run.start as usize..).zip(levels) {
                let of_noise = f32::from(*level) / paper.noise_at(x, *y as usize).max(1.0);
                found.peak_of_noise = found.peak_of_noise.max(of_noise);
            }
        }
        #[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
        for part in &mut parts {
            part.mean /= part.area_px as f32;
            let side = |[from, to]: [u32; 2]| (to - from) as usize;
            part.extent_px = side(part.columns).max(side(part.rows) + 1);
        }
        Self { runs, parts }
    }
}
