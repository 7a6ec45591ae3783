//! [`parts`]: the connected parts of ink, each with what tells it from noise.

use super::paper::Paper;
use super::plane::Plane;
use crate::disjoint_sets::DisjointSets;
use crate::picture::Bitmap;
use crate::picture::runs::ink_runs;
use core::ops::Range;

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
    pub(super) runs: Vec<(u32, Range<u32>, usize)>,
    pub(super) parts: Vec<Part>,
}

impl Parts {
    pub(super) fn of(ink: &Bitmap, darkness: &Plane, paper: &Paper) -> Self {
        let mut runs: Vec<(u32, Range<u32>, usize)> = Vec::new();
        let mut sets = DisjointSets::new(0);
        let mut above = 0..0;
        for y in 0..ink.height() {
            let first = runs.len();
            let mut from = above.start;
            for run in ink_runs(ink.row(y)) {
                let own = sets.push();
                // Over a corner, too: a run that ends where this one begins touches it.
                while let Some((_, upper, part)) = runs.get(from).filter(|_| from < above.end) {
                    if upper.end < run.start {
                        from += 1;
                        continue;
                    }
                    if upper.start > run.end {
                        break;
                    }
                    sets.join_to_lower(*part, own);
                    if upper.end > run.end {
                        break;
                    }
                    from += 1;
                }
                runs.push((y, run, own));
            }
            above = first..runs.len();
        }
        let mut number = vec![usize::MAX; runs.len()];
        let mut parts: Vec<Part> = Vec::new();
        for (y, run, part) in &mut runs {
            let root = sets.root(*part);
            let Some(slot) = number.get_mut(root) else { continue };
            if *slot == usize::MAX {
                *slot = parts.len();
                parts.push(Part { columns: [run.start, run.end], rows: [*y, *y], ..Part::default() });
            }
            *part = *slot;
            let Some(found) = parts.get_mut(*slot) else { continue };
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
