//! Uneven light: the level of the paper, tile by tile, and what follows for each pixel.
//!
//! A photographed or badly lit sheet gets darker toward a side, and what is paper here is ink there. But
//! light multiplies: ink reflects the same *share* of what paper reflects in the same place. So the paper's
//! level is measured in tiles (their median, for lines are the minority), each level is divided by it (paper
//! becomes white, ink keeps its share), Otsu's level of the whole sheet is taken there, and taken back to
//! each place:
//!
//! ```text
//!  level                          share of the paper
//!  255 ─────┐  ┌────              255 ───┐ ┌──────┐ ┌────
//!           │  │    ╲───┐ ┌──         - -│-│- - - │-│- - -   one level for the whole sheet
//!           └──┘        │ │               └─┘      └─┘
//!                       └─┘
//! ```
//!
//! Source: the division by an estimated background is that of S. Lu, B. Su, C. L. Tan, "Document image
//! binarization using background estimation and stroke edges" (2010), section 3.1; thresholds interpolated
//! between tiles are C. K. Chow, T. Kaneko, "Automatic boundary detection of the left ventricle from
//! cineangiograms" (1972).

use crate::picture::histogram::count;
use crate::picture::histogram::otsu;
use crate::{ink::Polarity, picture::Histogram};

/// Bits behind the point of an interpolated level.
const FRACTION: u32 = 16;

/// What is measured of one row of tiles.
#[derive(Clone, Debug, Default)]
pub(crate) struct TileRow {
    /// Median of each tile; where two are as good, both.
    medians: Vec<(u8, u8)>,
    /// Pixels darker and lighter than their tile's median by more than the least contrast.
    darker: u64,
    lighter: u64,
    /// Levels divided by the paper's; the second of the inverted picture.
    dark_ink: Histogram,
    light_ink: Histogram,
}

/// How a picture of `width` × `height` px is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tiles {
    width: usize,
    height: usize,
    side: usize,
    polarity: Polarity,
    min_contrast: u8,
}

/// What was found of a whole sheet: which levels are ink where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Light {
    tiles: Tiles,
    /// Greatest ink level in the middle of each tile, with [`FRACTION`] bits behind the point; of the
    /// inverted picture for light ink.
    greatest: Vec<i32>,
    pub(crate) ink_is_dark: bool,
    /// Otsu's level where the paper is white.
    pub(crate) level: u8,
}

impl Tiles {
    /// Tiles of `window_px` (8 to 1024; anything else is taken as the nearest) a side.
    pub(crate) fn new(width: u32, height: u32, window_px: u32, polarity: Polarity, min_contrast: u8) -> Self {
        let side = window_px.clamp(8, 1024) as usize;
        Self { width: width as usize, height: height as usize, side, polarity, min_contrast }
    }

    /// Number of tiles along a side of the picture. The last takes the rest: it is half a tile to one and a
    /// half long, for a narrow one would measure little but noise.
    fn along(self, length: usize) -> usize {
        ((length + self.side / 2) / self.side).max(1)
    }

    fn columns(self) -> usize {
        self.along(self.width)
    }

    fn rows(self) -> usize {
        self.along(self.height)
    }

    /// Number of levels in tile row `row`, all its pixel rows together; `None` below the picture.
    pub(crate) fn levels_of_row(self, row: usize) -> Option<usize> {
        let last = self.rows().checked_sub(row + 1)?;
        let height = if last == 0 { self.height - row * self.side } else { self.side };
        Some(height * self.width)
    }

    /// Measures one row of tiles, given all its levels.
    pub(crate) fn measure(self, levels: &[u8]) -> TileRow {
        let mut found = TileRow::default();
        for column in 0..self.columns() {
            let from = column * self.side;
            let to = if column + 1 == self.columns() { self.width } else { from + self.side };
            let mut counts = [[0_u32; 256]; 4];
            for row in levels.chunks(self.width.max(1)) {
                count(&mut counts, row.get(from..to).unwrap_or(&[]));
            }
            let [a, b, c, d] = &mut counts;
            for (((a, b), c), d) in a.iter_mut().zip(b).zip(c).zip(d) {
                *a += *b + *c + *d;
            }
            found.add_tile(a, self);
        }
        found
    }

    /// The rule for the whole sheet from its rows of tiles, top first; `None` for an empty sheet.
    pub(crate) fn finish(self, rows: Vec<TileRow>) -> Option<Light> {
        let mut whole = TileRow::default();
        for row in rows {
            whole.medians.extend(row.medians);
            whole.darker += row.darker;
            whole.lighter += row.lighter;
            whole.dark_ink.merge(&row.dark_ink);
            whole.light_ink.merge(&row.light_ink);
        }
        let ink_is_dark = match self.polarity {
            Polarity::Minority => whole.darker >= whole.lighter,
            Polarity::DarkInk => true,
            Polarity::LightInk => false,
        };
        let (flattened, paper): (_, Vec<u8>) = if ink_is_dark {
            (whole.dark_ink, whole.medians.iter().map(|(_, upper)| *upper).collect())
        } else {
            (whole.light_ink, whole.medians.iter().map(|(lower, _)| !*lower).collect())
        };
        let level = ink_level(flattened.counts(), self.min_contrast)?;
        let columns = self.columns();
        // A closing: a tile that ink fills takes its level from the paper around it. The border that is put
        // on first keeps the tiles at the edge of the sheet as they are where the light falls toward it.
        let lightest = around(&padded(&paper, columns, 2), columns + 4, |a, b| a.max(b));
        let paper = around(&lightest, columns + 2, |a, b| a.min(b));
        let greatest = paper
            .iter()
            .map(|paper| {
                let paper = i32::from(*paper) << FRACTION;
                // In the middle between the greatest level of ink, L, and the least of paper, L + 1; and
                // where the light is poor, half the least contrast below the paper, or its noise would be
                // ink.
                let share = paper / 510 * (2 * i32::from(level) + 1);
                share.min(paper - (i32::from(self.min_contrast) << FRACTION) / 2)
            })
            .collect();
        Some(Light { tiles: self, greatest, ink_is_dark, level: if ink_is_dark { level } else { !level } })
    }
}

/// Otsu's level, unless what lies below it is but the tail of the paper: noise in poor light, or light that
/// falls off within a tile. Ink has a peak of its own at its mean or, with several pens, below, or at least
/// (lines thinner than a pixel) as many pixels there as at the level; a tail that falls like e^(−x/λ) has its
/// mean at λ below any level, and there and below at most 1/e of the pixels. Between them, at half, lies the
/// border; a tail is left out and the rest split again, for few lines may lie behind it.
fn ink_level(mut counts: [u64; 256], min_contrast: u8) -> Option<u8> {
    loop {
        let level = otsu(&counts, min_contrast)?;
        let dark = || (0_u64..=u64::from(level)).zip(&counts);
        let mean =
            dark().map(|(level, n)| level * n).sum::<u64>() / dark().map(|(_, n)| n).sum::<u64>().max(1);
        let around = |level: usize| counts.iter().skip(level.saturating_sub(4)).take(9).sum::<u64>();
        let mean = usize::try_from(mean).unwrap_or(0);
        let peak = (0..=mean).map(around).max().unwrap_or(0);
        if 2 * peak >= around(usize::from(level)) {
            return Some(level);
        }
        // At least one level with pixels goes each time.
        counts.iter_mut().skip(usize::from(level) + 1).for_each(|n| *n = 0);
    }
}

/// A grid with `border` more tiles on each side, each as the nearest.
fn padded(tiles: &[u8], columns: usize, border: usize) -> Vec<u8> {
    let rows = tiles.len() / columns;
    let inside = |i: usize, length: usize| i.saturating_sub(border).min(length.saturating_sub(1));
    let places =
        (0..rows + 2 * border).flat_map(|row| (0..columns + 2 * border).map(move |column| (row, column)));
    places
        .filter_map(|(row, column)| tiles.get(inside(row, rows) * columns + inside(column, columns)))
        .copied()
        .collect()
}

/// The best of 3 × 3 tiles around each that has all its neighbours: the grid loses a tile on each side.
fn around(tiles: &[u8], columns: usize, best: impl Fn(u8, u8) -> u8) -> Vec<u8> {
    let rows: Vec<&[u8]> = tiles.chunks(columns).collect();
    let mut found = Vec::new();
    for three in rows.windows(3) {
        for column in 0..columns.saturating_sub(2) {
            let near = three.iter().flat_map(|row| row.get(column..column + 3).unwrap_or(&[]));
            found.extend(near.copied().reduce(&best));
        }
    }
    found
}

impl TileRow {
    fn add_tile(&mut self, counts: &[u32; 256], tiles: Tiles) {
        let total: u32 = counts.iter().sum();
        let (mut lower, mut upper) = (0_u8, 0_u8);
        let mut below = 0;
        for (level, n) in (0..=255).zip(counts) {
            lower = if below < total.div_ceil(2) { level } else { lower };
            upper = if below <= total / 2 { level } else { upper };
            below += n;
        }
        self.medians.push((lower, upper));
        let count = |levels: Option<&[u32]>| levels.unwrap_or(&[]).iter().map(|n| u64::from(*n)).sum::<u64>();
        self.darker += count(counts.get(..usize::from(lower.saturating_sub(tiles.min_contrast))));
        self.lighter += count(counts.get(usize::from(upper) + usize::from(tiles.min_contrast) + 1..));
        if tiles.polarity != Polarity::LightInk {
            flatten(&mut self.dark_ink, counts.iter(), upper);
        }
        if tiles.polarity != Polarity::DarkInk {
            flatten(&mut self.light_ink, counts.iter().rev(), !lower);
        }
    }
}

/// Counts the levels of a tile as they were if its `paper` were white.
fn flatten<'a>(flattened: &mut Histogram, counts: impl Iterator<Item = &'a u32>, paper: u8) {
    // 255 / paper with 16 bits behind the point, and half to round.
    let white = (255 << 16) / u32::from(paper.max(1));
    for (level, n) in (0_u32..).zip(counts) {
        let level = u8::try_from((level * white + (1 << 15)) >> 16).unwrap_or(u8::MAX);
        flattened.add(level, u64::from(*n));
    }
}

impl Light {
    /// For each pixel of row `y` the number of levels that are ink, from black (from white, for light ink).
    pub(crate) fn ink_levels(&self, y: u32) -> Vec<u8> {
        let Tiles { width, side, .. } = self.tiles;
        let (columns, rows) = (self.tiles.columns(), self.tiles.rows());
        // In half pixels, so that the middle of a pixel and that of a tile are whole numbers.
        let down = (2 * y as usize + 1).saturating_sub(side);
        let (row, part) = (down / (2 * side), down % (2 * side));
        let (row, part) = if row + 1 < rows { (row, part) } else { (rows - 1, 0) };
        let tiles = self.greatest.get(row * columns..).unwrap_or(&[]);
        let below = if part == 0 { tiles } else { tiles.get(columns..).unwrap_or(tiles) };
        let span = i32::try_from(2 * side).unwrap_or(i32::MAX);
        let part = i32::try_from(part).unwrap_or(0);
        let line: Vec<i32> =
            tiles.iter().zip(below).take(columns).map(|(a, b)| a + (b - a) / span * part).collect();

        let mut levels = Vec::with_capacity(width);
        let first = line.first().map_or(0, |greatest| ink_levels(*greatest));
        levels.resize(width.min(side / 2), first);
        for (column, pair) in line.windows(2).enumerate() {
            if let [a, b] = *pair {
                // The first pixel right of the tile's middle, and its distance from it in half pixels: 0
                // or 1.
                let from = side * (2 * column + 1) / 2;
                let to = side * (2 * column + 3) / 2;
                let odd = 1 - i32::from(side * (2 * column + 1) % 2 == 1);
                let step = (b - a) / span;
                let count = i32::try_from(to.min(width).saturating_sub(from)).unwrap_or(0);
                levels.extend((0..count).map(|x| ink_levels(a + step * (2 * x + odd))));
            }
        }
        levels.resize(width, line.last().map_or(0, |greatest| ink_levels(*greatest)));
        levels
    }
}

/// How many levels are not above the greatest.
fn ink_levels(greatest: i32) -> u8 {
    let [levels, ..] = ((greatest >> FRACTION) + 1).clamp(0, 255).to_le_bytes();
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The rule for a picture of `width` px, rows together.
    fn light(width: u32, side: u32, levels: &[u8]) -> Option<Light> {
        let height = u32::try_from(levels.len()).unwrap() / width;
        let tiles = Tiles::new(width, height, side, Polarity::Minority, 24);
        let mut rest = levels;
        let rows = (0..).map_while(|row| {
            let (these, below) = rest.split_at(tiles.levels_of_row(row)?);
            rest = below;
            Some(tiles.measure(these))
        });
        let rows = rows.collect();
        assert!(rest.is_empty());
        tiles.finish(rows)
    }

    #[test]
    fn where_the_light_is_even_one_level_holds_everywhere() {
        let mut levels = vec![200; 50 * 50];
        (0..50).for_each(|i| levels[i * 51] = 100);
        let found = light(50, 10, &levels).unwrap();
        // Half of the paper's level is 127 of 255; the level lies in the middle between it and white.
        assert_eq!((found.ink_is_dark, found.level), (true, 127 + (254 - 127) / 2));
        for y in 0..50 {
            assert_eq!(found.ink_levels(y), [150; 50]); // 0 ..= 190.5 / 255 · 200
        }
    }

    #[test]
    fn between_tiles_the_level_runs_straight() {
        // Paper of 100 and 200 in two tiles of 10 px, ink of half of it in one row of ten.
        let row = |ink: bool| (0..20).map(move |x| if x < 10 { 100 } else { 200 } / if ink { 2 } else { 1 });
        let levels: Vec<u8> = (0..10).flat_map(|y| row(y == 5)).collect();
        let found = light(20, 10, &levels).unwrap().ink_levels(3);
        assert_eq!((found[..5].to_vec(), found[15..].to_vec()), (vec![found[0]; 5], vec![found[19]; 5]));
        // Half a step from the tile's middle to that of the first pixel, then ten.
        for (x, pair) in found[4..16].windows(2).enumerate() {
            let expected = if x == 0 || x == 10 { 3..=4 } else { 7..=8 };
            assert!(expected.contains(&(pair[1] - pair[0])), "{x}: {found:?}");
        }
    }

    #[test]
    fn the_level_runs_down_the_sheet_as_it_runs_across() {
        let level = |across: usize, along: usize| {
            let paper = if across < 10 { 100 } else { 200 };
            if along == 5 { paper / 2 } else { paper }
        };
        let down: Vec<u8> = (0..20).flat_map(|y| (0..10).map(move |x| level(y, x))).collect();
        let across: Vec<u8> = (0..10).flat_map(|y| (0..20).map(move |x| level(x, y))).collect();
        let (down, across) = (light(10, 10, &down).unwrap(), light(20, 10, &across).unwrap());
        let rows: Vec<u8> = (0..20).map(|y| down.ink_levels(y)[3]).collect();
        assert_eq!(rows, across.ink_levels(3));
    }

    #[test]
    fn a_tile_full_of_ink_takes_its_paper_from_around() {
        let mut levels = vec![220; 50 * 50];
        for y in 20..30 {
            levels[y * 50 + 20..][..10].fill(40);
            levels[y * 50 + 5] = 40;
        }
        let found = light(50, 10, &levels).unwrap();
        assert!(found.ink_levels(25)[25] > 100);
    }

    #[test]
    fn ink_of_two_pens_is_ink_and_the_tail_of_the_paper_is_not() {
        let mut counts = [0; 256];
        for (level, n) in [(10, 300), (90, 500), (255, 9000)] {
            counts[level] = n;
        }
        (95..255).for_each(|level| counts[level] = 7);
        let level = ink_level(counts, 24).unwrap();
        assert!((100..200).contains(&level), "{level}");
        // Falls by half every 12 levels, from 4096 at 240; the few below 60 are lines.
        let mut tail = [0; 256];
        (0..16).for_each(|i| tail[240 - 12 * i..252 - 12 * i].fill(4096 >> i));
        assert_eq!(ink_level(tail, 24), None);
        tail[40] = 300;
        let level = ink_level(tail, 24).unwrap();
        assert!((40..180).contains(&level), "{level}");
    }

    #[test]
    fn the_narrow_rest_belongs_to_the_last_tile() {
        for (length, tiles) in [(0, 1), (1, 1), (8, 1), (11, 1), (12, 2), (19, 2), (20, 3)] {
            assert_eq!(Tiles::new(length, 1, 8, Polarity::Minority, 24).columns(), tiles);
        }
    }
}
