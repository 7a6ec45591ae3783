//! Finds the pens of a picture.
//!
//! A stroke with soft rims has every colour between paper and pen, so a pen is not a cluster of colours
//! around a point but the line from the paper to it. Pens are the k such lines that explain the most ink: the
//! first by greedy choice (each next pen is the colour whose line explains most of what is left), then moved
//! as k-means moves its centres, each to the mean of the colours that are wholly its own.
//!
//! Source: S. P. Lloyd, "Least squares quantization in PCM" (1982), for the turn of sharing out and moving;
//! for lines in place of centres P. S. Bradley, O. L. Mangasarian, "k-plane clustering" (2000).

use super::histogram::{Entry, Histogram};
use super::mixing_line::{MixingLine, mixture};
use crate::picture::oklab::OklabTable;
use crate::{
    ink::{MAX_PENS, Palette, PalettePen},
    picture::{Oklab, Rgb},
};

/// Most contrast that is asked for, however noisy the sheet: the half of its pixels may be ink.
const MOST_CONTRAST: f64 = 0.25;
/// Colours within this of a line belong to it, in Oklab: the noise of a scan and the bend of a line by
/// another mixing.
pub(super) const SAME: f64 = 0.06;
/// Least contrast between paper and a pen, in Oklab: a pale yellow marker has 0.1, 24 grey levels below white
/// 0.08.
const LEAST_CONTRAST: f64 = 0.08;
/// A pixel is wholly a pen's from this share on.
pub(super) const WHOLE: f64 = 0.75;
/// Least number of pixels that are wholly a pen's.
pub(super) const LEAST_PIXELS: f64 = 12.0;
/// Least share of the ink that is wholly a pen's: a short word in another colour.
pub(super) const LEAST_SHARE: f64 = 0.003;
/// The same for a colour that two other pens make where they cross.
const LEAST_SHARE_OF_MIXTURE: f64 = 0.01;
/// Least share that either pen has in a mixture of two; with less it is the other pen.
const LEAST_OF_BOTH: f64 = 0.1;
/// Colours that are tried as pens, and colours that they must explain: the most frequent ones.
const CANDIDATES: usize = 128;
/// As above.
const EXPLAINED: usize = 2048;
/// Turns of sharing out and moving.
const TURNS: usize = 3;
/// Weight of the distance to the pen itself: it decides between pens of one line.
pub(super) const NEARER_PEN: f64 = 0.05;
/// How far the ink of a given pen may be from the colour that the palette says, in Oklab.
const FADED: f64 = 0.2;

/// From this contrast on a colour is no paper.
pub(super) fn ink_contrast(histogram: &Histogram) -> f64 {
    (4.0 * histogram.noise).clamp(LEAST_CONTRAST, MOST_CONTRAST)
}

/// The lines of the pens, the darkest first: `count` of them, or fewer when there are no more; `None` finds
/// as many as are distinct and draw something. Those of `cores`, the largest first, come before all others.
pub(super) fn find(
    histogram: &Histogram,
    cores: Vec<MixingLine>,
    count: Option<usize>,
    table: &OklabTable,
) -> Vec<MixingLine> {
    let ink = most_frequent_ink(histogram);
    let most = count.unwrap_or(MAX_PENS).min(MAX_PENS);
    let mut lines = cores;
    lines.truncate(most);
    let candidates = candidates(histogram, &ink, table);
    let on_a_line = |entry: &Entry| lines.iter().any(|line| line.distance(entry.mean, entry.oklab) <= SAME);
    let mut explained: Vec<bool> = ink.iter().map(on_a_line).collect();
    let total = weight(&ink);
    let mut tried = vec![false; candidates.len()];
    while lines.len() < most {
        let gain = |candidate: &Candidate| -> f64 {
            let rest = candidate.explains.iter().filter(|index| explained.get(**index) == Some(&false));
            rest.filter_map(|index| ink.get(*index)).map(|entry| f64::from(entry.count)).sum()
        };
        let gains = candidates.iter().enumerate().filter(|(index, _)| tried.get(*index) == Some(&false));
        // Of equal gains the earlier candidate, the more frequent colour.
        let best = gains
            .map(|(index, candidate)| (gain(candidate), index))
            .fold((0.0, None), |best, next| if next.0 > best.0 { (next.0, Some(next.1)) } else { best });
        let (gain, Some(index)) = best else { break };
        if gain < LEAST_PIXELS {
            break;
        }
        let Some(candidate) = candidates.get(index) else { break };
        if let Some(slot) = tried.get_mut(index) {
            *slot = true;
        }
        let whole = candidate.whole(&ink, &explained);
        let least = if count.is_some() {
            0.0
        } else if makers(&lines, MAX_PENS, candidate.line.pen(), table) != 0 {
            LEAST_SHARE_OF_MIXTURE * total
        } else {
            LEAST_SHARE * total
        };
        if whole < least.max(LEAST_PIXELS) {
            continue;
        }
        for at in &candidate.explains {
            if let Some(slot) = explained.get_mut(*at) {
                *slot = true;
            }
        }
        lines.push(candidate.line.clone());
    }
    for _ in 0..TURNS {
        move_lines(&mut lines, &ink, histogram.paper, table, f64::INFINITY);
        drop_rims(&mut lines, table);
    }
    lines
}

/// Leaves out the pens that have turned out to be on the line of another one, the paler ones.
fn drop_rims(lines: &mut Vec<MixingLine>, table: &OklabTable) {
    let mut kept: Vec<MixingLine> = Vec::with_capacity(lines.len());
    lines.sort_by(|a, b| a.pen_oklab().l.total_cmp(&b.pen_oklab().l).then(a.pen().cmp(&b.pen())));
    let cores: Vec<MixingLine> = lines.iter().filter(|line| line.has_core()).cloned().collect();
    for line in lines.drain(..) {
        let on_line = |other: &MixingLine| other.distance(line.pen(), table.oklab(line.pen())) <= SAME;
        // Near black the line is bent: what is as near to the pen itself is that pen.
        let is_same =
            |core: &MixingLine| on_line(core) || core.pen_oklab().distance(line.pen_oklab()) <= 1.5 * SAME;
        if line.has_core() || !kept.iter().any(on_line) && !cores.iter().any(is_same) {
            kept.push(line);
        }
    }
    *lines = kept;
}

/// The lines of given pens, each moved to the colour that its ink has on this picture, as far as it may have
/// faded.
pub(super) fn seen(histogram: &Histogram, palette: &Palette, table: &OklabTable) -> Vec<MixingLine> {
    let ink = most_frequent_ink(histogram);
    let line = |pen: &PalettePen| MixingLine::new(histogram.paper, pen.colour, table);
    let mut lines: Vec<MixingLine> = palette.pens().iter().map(line).collect();
    move_lines(&mut lines, &ink, histogram.paper, table, FADED);
    lines
}

/// The most frequent colours that are no paper.
fn most_frequent_ink(histogram: &Histogram) -> Vec<Entry> {
    let least = ink_contrast(histogram);
    let mut ink: Vec<Entry> =
        histogram.entries.iter().filter(|entry| entry.contrast >= least).copied().collect();
    ink.sort_unstable_by(|a, b| b.count.cmp(&a.count).then(a.bin.cmp(&b.bin)));
    ink.truncate(EXPLAINED);
    ink
}

fn weight(ink: &[Entry]) -> f64 {
    ink.iter().map(|entry| f64::from(entry.count)).sum()
}

/// A colour that may be a pen's.
struct Candidate {
    line: MixingLine,
    /// Indices of the inks on its line.
    explains: Vec<usize>,
}

impl Candidate {
    /// Pixels that are wholly this pen's, of those not explained yet.
    fn whole(&self, ink: &[Entry], explained: &[bool]) -> f64 {
        let rest = self.explains.iter().filter(|index| explained.get(**index) == Some(&false));
        let whole = |entry: &&Entry| self.line.share(entry.mean) >= WHOLE;
        rest.filter_map(|index| ink.get(*index)).filter(whole).map(|entry| f64::from(entry.count)).sum()
    }
}

/// The most frequent colours, none nearer than half of [`SAME`] to a more frequent one.
fn candidates(histogram: &Histogram, ink: &[Entry], table: &OklabTable) -> Vec<Candidate> {
    let mut chosen: Vec<Entry> = Vec::new();
    for entry in ink {
        if chosen.len() == CANDIDATES {
            break;
        }
        if chosen.iter().all(|other| other.oklab.distance(entry.oklab) > SAME / 2.0) {
            chosen.push(*entry);
        }
    }
    let candidate = |entry: &Entry| {
        let line = MixingLine::new(histogram.paper, entry.mean, table);
        let on_line = |entry: &Entry| line.distance(entry.mean, entry.oklab) <= SAME;
        let explains = ink.iter().enumerate().filter(|(_, entry)| on_line(entry)).map(|(index, _)| index);
        Candidate { explains: explains.collect(), line: line.clone() }
    };
    chosen.iter().map(candidate).collect()
}

/// The pens that make a colour where two of them cross, a bit each; pen `own` is not asked.
pub(super) fn makers(lines: &[MixingLine], own: usize, colour: Rgb, table: &OklabTable) -> u16 {
    let oklab = table.oklab(colour);
    let others = || lines.iter().enumerate().filter(|(index, _)| *index != own);
    let mut makers = 0;
    for (index, one) in others() {
        for (other_index, other) in others().filter(|(other_index, _)| *other_index > index) {
            let (shares, made) = mixture(one, other, colour);
            let of_both = shares.iter().all(|share| *share >= LEAST_OF_BOTH);
            if of_both && table.oklab(made).distance(oklab) <= 1.5 * SAME {
                makers |= 1 << index | 1 << other_index;
            }
        }
    }
    makers
}

/// The pen whose line a colour is nearest to, by index, and how near that is.
pub(super) fn nearest(lines: &[MixingLine], colour: Rgb, oklab: Oklab) -> Option<(usize, f64)> {
    let mut best: Option<(f64, usize, f64)> = None;
    for (index, line) in lines.iter().enumerate() {
        let beside = line.distance(colour, oklab);
        let score = beside + NEARER_PEN * line.pen_oklab().distance(oklab);
        if best.is_none_or(|(least, ..)| score < least) {
            best = Some((score, index, beside));
        }
    }
    best.map(|(_, index, beside)| (index, beside))
}

/// Shares the ink out among the lines and moves each pen to the mean of the upper quarter of its own, by
/// share: that is the colour of strokes with rims, and also of strokes so thin that they are all rim. A pen
/// moves at most `farthest`.
fn move_lines(lines: &mut [MixingLine], ink: &[Entry], paper: Rgb, table: &OklabTable, farthest: f64) {
    let mut own: Vec<Vec<(f64, Entry)>> = vec![Vec::new(); lines.len()];
    for entry in ink {
        let Some((index, beside)) = nearest(lines, entry.mean, entry.oklab) else { continue };
        let Some(line) = lines.get(index).filter(|_| beside <= 2.0 * SAME) else { continue };
        if let Some(own) = own.get_mut(index) {
            own.push((line.share(entry.mean), *entry));
        }
    }
    // Rims of a pen have a paler one's colour: its own is that of its cores.
    let mixed: Vec<bool> = lines
        .iter()
        .map(|line| {
            line.has_core() && lines.iter().any(|other| line.is_rim_of(other) || other.is_rim_of(line))
        })
        .collect();
    for ((line, mut own), _) in lines.iter_mut().zip(own).zip(mixed).filter(|(_, mixed)| !mixed) {
        own.sort_by(|a, b| b.0.total_cmp(&a.0));
        let all: u64 = own.iter().map(|(_, entry)| u64::from(entry.count)).sum();
        if all < 12 {
            continue;
        }
        let (mut sums, mut taken) = ([0_u64; 3], 0_u64);
        for (_, entry) in &own {
            let count = u64::from(entry.count);
            for (sum, channel) in sums.iter_mut().zip(entry.mean.0) {
                *sum += u64::from(channel) * count;
            }
            taken += count;
            if 4 * taken >= all {
                break;
            }
        }
        let mean = sums.map(|sum| {
            (sum + taken / 2).checked_div(taken).and_then(|mean| u8::try_from(mean).ok()).unwrap_or(0)
        });
        let moved = Rgb(mean);
        if moved != paper && table.oklab(moved).distance(line.pen_oklab()) <= farthest {
            *line = line.moved(paper, moved, table);
        }
    }
}
