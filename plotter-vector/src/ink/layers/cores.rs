//! Cores: the pixels along the middle of lines, where a pen's colour is its own.
//!
//! Rims are mixtures with the paper, crossings are mixtures of pens. In the middle of a line that is wider than
//! its rims, among pixels of one colour, there is neither, so what differs there are pens: also a pencil beside
//! black, whose grey is on the line from paper to black. The colour is the mean of the cores around, in which
//! noise and blocks of compression are small.

use super::find_pens::{LEAST_PIXELS, LEAST_SHARE, SAME, WHOLE, ink_contrast};
use super::histogram::{BINS, Histogram, bin};
use super::mixing_line::MixingLine;
use crate::picture::oklab::OklabTable;
use crate::picture::{Bitmap, Colour, Oklab, Pixel, Rgb};

/// Least width of a line that has a core, px: a narrower one is all rim, and its colour is not its pen's.
const LEAST_WIDTH_PX: f64 = 2.4;
/// The width is looked for so far to each side, px.
const REACH_PX: u32 = 12;
/// A core is as dark as this part of the darkest across its line.
const DARK: f64 = 0.85;
/// A line reaches to where it is as dark as this part of its middle: a pixel that it covers by half, and noise.
const RIM: f64 = 0.4;
/// The mean is taken so far around, px, of this many cores at least.
const AROUND_PX: u32 = 2;
const LEAST_AROUND: u32 = 3;
/// The cores around are of one colour when they differ from their mean by this at most, root mean square, in
/// Oklab: more than noise does, less than two pens.
const PURE: f64 = 0.05;
/// A paler pen of the same hue covers less than this share: what a pen leaves between two such shares is its
/// pressure.
const PRESSURE: f64 = 0.3;
/// How far a core may be from the colour of its pen, in Oklab.
const STRAY: f64 = 2.0 * SAME;

/// A core and the mean colour around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core {
    at: Pixel,
    colour: Rgb,
}

/// The cores of a picture.
pub(super) fn cores(picture: &Colour, histogram: &Histogram) -> Vec<Core> {
    let least = ink_contrast(histogram);
    let mut contrasts = vec![0_u8; BINS];
    let mut colours = vec![Oklab::default(); BINS];
    for entry in &histogram.entries {
        if let (Some(contrast), Some(colour)) = (contrasts.get_mut(entry.bin), colours.get_mut(entry.bin)) {
            *colour = entry.oklab;
            if entry.contrast >= least {
                // As shares of a pen are: half of its rim's pixel is half as far.
                let channels = entry.mean.0.iter().zip(histogram.paper.0);
                *contrast = channels.map(|(level, paper)| level.abs_diff(paper)).max().unwrap_or(0).max(1);
            }
        }
    }
    let darkness: Vec<u8> =
        picture.pixels().iter().map(|pixel| contrasts.get(bin(*pixel)).copied().unwrap_or(0)).collect();
    let plane = Darkness { values: &darkness, width: picture.width(), height: picture.height() };
    let Ok(mut middle) = Bitmap::new(plane.width, plane.height) else { return Vec::new() };
    for y in 0..plane.height {
        for x in 0..plane.width {
            if plane.at(x, y) > 0 && plane.is_core(x, y) {
                middle.set(Pixel::new(x, y), true);
            }
        }
    }
    middle.ink().filter_map(|at| pure(picture, &middle, &colours, at)).collect()
}

/// The core with the mean colour of those around it, where these are of one colour.
fn pure(picture: &Colour, middle: &Bitmap, colours: &[Oklab], at: Pixel) -> Option<Core> {
    let (mut sums, mut count) = ([0_u32; 3], 0_u32);
    let (mut of_oklab, mut squares) = (Oklab::default(), 0.0);
    for y in at.y.saturating_sub(AROUND_PX)..=at.y + AROUND_PX {
        for x in at.x.saturating_sub(AROUND_PX)..=at.x + AROUND_PX {
            let Some(Rgb(colour)) = picture.pixel(x, y).filter(|_| middle.get(Pixel::new(x, y))) else {
                continue;
            };
            sums.iter_mut().zip(colour).for_each(|(sum, level)| *sum += u32::from(level));
            count += 1;
            let oklab = colours.get(bin(colour)).copied().unwrap_or_default();
            squares += oklab.squared(Oklab::default());
            of_oklab = Oklab { l: of_oklab.l + oklab.l, a: of_oklab.a + oklab.a, b: of_oklab.b + oklab.b };
        }
    }
    if count < LEAST_AROUND {
        return None;
    }
    let n = f64::from(count);
    let variance = squares / n - of_oklab.squared(Oklab::default()) / (n * n);
    let mean = sums.map(|sum| u8::try_from((sum + count / 2) / count).unwrap_or(u8::MAX));
    (variance <= PURE * PURE).then_some(Core { at, colour: Rgb(mean) })
}

/// How far each pixel is from the paper.
struct Darkness<'a> {
    values: &'a [u8],
    width: u32,
    height: u32,
}

impl Darkness<'_> {
    fn at(&self, x: u32, y: u32) -> u8 {
        if x >= self.width || y >= self.height {
            return 0;
        }
        self.values.get(y as usize * self.width as usize + x as usize).copied().unwrap_or(0)
    }

    /// Whether a pixel is in the middle of a line that is wide enough: across is where it is narrowest.
    fn is_core(&self, x: u32, y: u32) -> bool {
        let own = self.at(x, y);
        let mut narrowest = (f64::INFINITY, 0);
        for (dx, dy, step_px) in
            [(1, 0, 1.0), (0, 1, 1.0), (1, 1, core::f64::consts::SQRT_2), (1, -1, core::f64::consts::SQRT_2)]
        {
            let (mut pixels, mut darkest) = (1_u32, own);
            for sign in [1, -1] {
                for step in 1..=REACH_PX {
                    let along =
                        |from: u32, way: i32| from.checked_add_signed(sign * way * step.cast_signed());
                    let Some(found) = along(x, dx).zip(along(y, dy)).map(|(x, y)| self.at(x, y)) else {
                        break;
                    };
                    if f64::from(found) < RIM * f64::from(own) {
                        break;
                    }
                    pixels += 1;
                    darkest = darkest.max(found);
                }
            }
            let width = f64::from(pixels) * step_px;
            // Of equally narrow ways the one with the darker middle, whichever comes first: else the mirrored
            // picture has other cores.
            if width < narrowest.0 || width == narrowest.0 && darkest > narrowest.1 {
                narrowest = (width, darkest);
            }
        }
        narrowest.0 >= LEAST_WIDTH_PX && f64::from(own) >= DARK * f64::from(narrowest.1)
    }
}

/// The pens that have cores: groups of their colours, the largest first, each as the line to it.
pub(super) fn pens(cores: &[Core], paper: Rgb, table: &OklabTable) -> Vec<MixingLine> {
    let mut groups = Group::of(cores, table);
    let least = (LEAST_SHARE * count(cores.len())).max(LEAST_PIXELS);
    groups.retain(|group| group.pixels >= least);
    // Paler ones on a darker one's line are that pen's lighter pressure, as far as they follow each other.
    groups.sort_by(|one, other| one.oklab().l.total_cmp(&other.oklab().l));
    let mut kept: Vec<(Group, MixingLine, f64)> = Vec::new();
    for group in groups {
        let colour = group.colour();
        let lighter = kept.iter_mut().find(|(_, line, palest)| {
            line.distance(colour, table.oklab(colour)) <= SAME && line.share(colour) >= *palest - PRESSURE
        });
        if let Some((darker, line, palest)) = lighter {
            *palest = palest.min(line.share(colour));
            darker.pixels += group.pixels;
        } else {
            kept.push((group, MixingLine::new(paper, colour, table).with_core(), 1.0));
        }
    }
    kept.sort_by(|one, other| other.0.pixels.total_cmp(&one.0.pixels));
    kept.into_iter().map(|(_, line, _)| line).collect()
}

/// Cores of about one colour.
#[derive(Clone, Debug)]
struct Group {
    centre: Oklab,
    sums: [f64; 3],
    pixels: f64,
}

impl Group {
    fn colour(&self) -> Rgb {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a mean of bytes")]
        let channel = |sum: f64| (sum / self.pixels + 0.5).clamp(0.0, 255.0) as u8;
        Rgb(self.sums.map(channel))
    }

    fn oklab(&self) -> Oklab {
        self.centre
    }

    /// Groups whose middles are farther than [`SAME`] from each other.
    fn of(cores: &[Core], table: &OklabTable) -> Vec<Self> {
        let mut counts = vec![([0_u64; 3], 0_u32); BINS];
        for core in cores {
            if let Some((sums, count)) = counts.get_mut(bin(core.colour.0)) {
                sums.iter_mut().zip(core.colour.0).for_each(|(sum, level)| *sum += u64::from(level));
                *count += 1;
            }
        }
        let mut bins: Vec<Self> = counts
            .into_iter()
            .filter(|(_, count)| *count > 0)
            .map(|(sums, count)| {
                #[expect(clippy::cast_precision_loss, reason = "levels of a picture")]
                let sums = sums.map(|sum| sum as f64);
                let mut group = Self { centre: Oklab::default(), sums, pixels: f64::from(count) };
                group.centre = table.oklab(group.colour());
                group
            })
            .collect();
        bins.sort_by(|one, other| other.pixels.total_cmp(&one.pixels));
        let mut centres: Vec<Oklab> = Vec::new();
        let mut groups: Vec<Self> = Vec::new();
        for _ in 0..3 {
            groups =
                centres.iter().map(|centre| Self { centre: *centre, sums: [0.0; 3], pixels: 0.0 }).collect();
            for bin in &bins {
                let far = |group: &Self| group.centre.distance(bin.centre);
                let nearest = groups.iter_mut().min_by(|one, other| far(one).total_cmp(&far(other)));
                match nearest.filter(|group| far(group) <= SAME) {
                    Some(group) => group.add(bin),
                    None => groups.push(bin.clone()),
                }
            }
            groups.retain(|group| group.pixels > 0.0);
            groups.sort_by(|one, other| other.pixels.total_cmp(&one.pixels));
            centres.clear();
            for group in &groups {
                let centre = table.oklab(group.colour());
                if centres.iter().all(|other| other.distance(centre) > SAME) {
                    centres.push(centre);
                }
            }
        }
        for group in &mut groups {
            group.centre = table.oklab(group.colour());
        }
        groups
    }

    fn add(&mut self, other: &Self) {
        self.sums.iter_mut().zip(other.sums).for_each(|(sum, more)| *sum += more);
        self.pixels += other.pixels;
    }
}

/// The cores of each pen.
pub(super) fn seeds(
    cores: &[Core],
    lines: &[MixingLine],
    size: (u32, u32),
    table: &OklabTable,
) -> Vec<Bitmap> {
    let empty = || Bitmap::new(size.0, size.1).unwrap_or_else(|_| Bitmap::empty());
    let mut seeds: Vec<Bitmap> = lines.iter().map(|_| empty()).collect();
    for Core { at, colour } in cores {
        let oklab = table.oklab(*colour);
        // A core is all its pen's, or nearly.
        let far = |line: &MixingLine| line.distance_from(line.share(*colour).max(WHOLE), oklab);
        let nearest = lines.iter().map(far).enumerate().min_by(|one, other| one.1.total_cmp(&other.1));
        if let Some(seeds) = nearest.filter(|(_, far)| *far <= STRAY).and_then(|(pen, _)| seeds.get_mut(pen))
        {
            seeds.set(*at, true);
        }
    }
    seeds
}

#[expect(clippy::cast_precision_loss, reason = "a picture's pixels")]
fn count(pixels: usize) -> f64 {
    pixels as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_equally_narrow_ways_the_darker_middle_is_asked_from_either_side() {
        let rows = [[100_u8, 80, 0], [80, 80, 80], [80, 80, 0]];
        let mirrored = rows.map(|[left, middle, right]| [right, middle, left]);
        for values in [rows, mirrored] {
            let plane = Darkness { values: values.as_flattened(), width: 3, height: 3 };
            assert!(!plane.is_core(1, 1), "{values:?}");
        }
    }
}
