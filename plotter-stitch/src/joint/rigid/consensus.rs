//! Which of the found places agree with one another.

use super::equations::{Row, single};
use crate::marks::MOST_CROSSINGS;
use plotter_motion::Axis;

/// Places of one pose lie this near to it, mm: a pair of crossings a fifth of the layout apart tells the
/// angle well enough for that.
const NEAR_MM: f32 = 0.15;

/// Two crossings tell an angle if they lie at least this share of the layout's extent apart.
const BASELINE: f32 = 0.2;

/// Marks that only swelling brings together count if they are more than one, which a grain of dust would be:
/// near places count for almost 1 each.
const SWOLLEN_GAIN: f32 = 1.5;

/// The rows, as a mask, that agree best with one small turn and two shifts, and that turn, rad.
///
/// For a turn α the shift that each row tells is `found - mark ± α · (place of the scan)`. All marks of one
/// axis tell the same one, and dust tells any. So each pair of rows of one axis proposes an angle, and for
/// each angle both axes are asked where most of their rows gather. A row that is off by d counts 1 - (d /
/// 0.15 mm)². All pairs are tried, so nothing is left to chance.
///
/// On a wide field paper that swells carries marks at both sides farther apart than 0.15 mm. So once the turn
/// is known, pairs of an axis propose a swelling too, and it is taken where it brings more than one further
/// mark.
///
/// Single precision is enough to tell 0.15 mm, and a Cortex-M4 has it in hardware.
///
/// Source: Fischler and Bolles, "Random sample consensus" (1981), with all samples instead of random ones;
/// the score is Torr and Zisserman's, "MLESAC" (2000), section 4.
pub(super) fn agreeing(rows: &[Row], greatest_angle_rad: f64, most_swelling: f64) -> (u64, f64) {
    let mut sheet = Spread::new(rows);
    let mut best = (0.0, 0, 0.0);
    for first in 0..sheet.count {
        for second in first + 1..sheet.count {
            let Some(slope) = sheet.angle(first, second) else { continue };
            if slope.abs() > single(greatest_angle_rad) {
                continue;
            }
            if let Some((score, mask)) = sheet.gather(slope, best.0) {
                best = (score, mask, slope);
            }
        }
    }
    let mask = if best.1 == 0 { 0 } else { sheet.gather_swollen(best.2, single(most_swelling)) };
    (mask, f64::from(best.2))
}

/// The rows, x first, as numbers near zero.
struct Spread {
    count: usize,
    /// How many of them are scanned along x.
    along_x: usize,
    /// Which row it was.
    index: [u8; MOST_CROSSINGS],
    /// Shift from where it was expected, from that of the first of its axis, mm.
    shift_mm: [f32; MOST_CROSSINGS],
    /// Place of the scan, from that of the first row, with the sign of its axis, mm.
    lever_mm: [f32; MOST_CROSSINGS],
    /// The mark, from that of the first row of its axis, mm.
    along_mm: [f32; MOST_CROSSINGS],
    /// Shifts for the angle that is being tried, mm.
    turned_mm: [f32; MOST_CROSSINGS],
    least_baseline_mm: f32,
    /// How many rows are scanned along y: the most that they can score.
    most_y: f32,
}

impl Spread {
    fn new(rows: &[Row]) -> Self {
        let mut sheet = Self {
            count: 0,
            along_x: 0,
            index: [0; MOST_CROSSINGS],
            shift_mm: [0.0; MOST_CROSSINGS],
            lever_mm: [0.0; MOST_CROSSINGS],
            along_mm: [0.0; MOST_CROSSINGS],
            turned_mm: [0.0; MOST_CROSSINGS],
            least_baseline_mm: 0.0,
            most_y: 0.0,
        };
        let mut extent_mm = 0.0_f32;
        for axis in Axis::BOTH {
            let (mut least, mut most) = (f32::MAX, f32::MIN);
            let mut first: Option<&Row> = None;
            for (index, row) in (0_u8..).zip(rows) {
                if row.axis != axis {
                    continue;
                }
                let first = *first.get_or_insert(row);
                let lever_mm = single(row.scan_at_mm - first.scan_at_mm);
                (least, most) = (least.min(lever_mm), most.max(lever_mm));
                let at = sheet.count;
                sheet.index[at] = index;
                sheet.shift_mm[at] = single(row.shift_mm() - first.shift_mm());
                sheet.along_mm[at] = single(row.mark_mm - first.mark_mm);
                sheet.lever_mm[at] = if axis == Axis::X { lever_mm } else { -lever_mm };
                sheet.count += 1;
                if axis == Axis::Y {
                    sheet.most_y += 1.0;
                }
            }
            if axis == Axis::X {
                sheet.along_x = sheet.count;
            }
            extent_mm = extent_mm.max(most - least);
        }
        sheet.least_baseline_mm = BASELINE * extent_mm;
        sheet
    }

    /// The angle that two rows of one axis tell.
    fn angle(&self, first: usize, second: usize) -> Option<f32> {
        if (first < self.along_x) != (second < self.along_x) {
            return None;
        }
        let baseline_mm = self.lever_mm[second] - self.lever_mm[first];
        (baseline_mm.abs() > self.least_baseline_mm.max(f32::MIN_POSITIVE))
            .then(|| (self.shift_mm[first] - self.shift_mm[second]) / baseline_mm)
    }

    /// How well the rows agree at that angle, and which do; none if that is no better than `so_far`.
    fn gather(&mut self, angle_rad: f32, so_far: f32) -> Option<(f32, u64)> {
        self.turn(angle_rad);
        let (score_x, mask_x) = self.densest(&self.turned_mm, 0, self.along_x);
        // Even if all others agreed.
        if score_x + self.most_y <= so_far {
            return None;
        }
        let (score_y, mask_y) = self.densest(&self.turned_mm, self.along_x, self.count);
        let score = score_x + score_y;
        (score > so_far).then_some((score, mask_x | mask_y))
    }

    fn turn(&mut self, angle_rad: f32) {
        for row in 0..self.count {
            self.turned_mm[row] = self.shift_mm[row] + angle_rad * self.lever_mm[row];
        }
    }

    /// Which rows agree at that angle, each axis with the swelling that brings most of its rows together.
    fn gather_swollen(&mut self, angle_rad: f32, most_swelling: f32) -> u64 {
        self.turn(angle_rad);
        let mut mask = 0;
        for (from, to) in [(0, self.along_x), (self.along_x, self.count)] {
            let flat = self.densest(&self.turned_mm, from, to);
            let mut best = (flat.0 + SWOLLEN_GAIN, flat.1);
            let pairs = (from..to).flat_map(|first| (first + 1..to).map(move |second| (first, second)));
            for (first, second) in pairs {
                let baseline_mm = self.along_mm[second] - self.along_mm[first];
                let apart_mm = self.turned_mm[second] - self.turned_mm[first];
                let is_swelling = apart_mm.abs() <= most_swelling * baseline_mm.abs();
                if !is_swelling || apart_mm.abs() < NEAR_MM {
                    continue;
                }
                let swelling = apart_mm / baseline_mm;
                let mut shrunk_mm = self.turned_mm;
                for (shift_mm, along_mm) in shrunk_mm.iter_mut().zip(&self.along_mm) {
                    *shift_mm -= swelling * along_mm;
                }
                let swollen = self.densest(&shrunk_mm, from, to);
                if swollen.0 > best.0 {
                    best = swollen;
                }
            }
            mask |= best.1;
        }
        mask
    }

    /// The row around which most others lie.
    fn densest(&self, shifts_mm: &[f32; MOST_CROSSINGS], from: usize, to: usize) -> (f32, u64) {
        let turned_mm = &shifts_mm[from..to];
        let mut best = (0.0, 0.0);
        let mut take = |scores: &[f32], centres_mm: &[f32]| {
            for (&score, &centre_mm) in scores.iter().zip(centres_mm) {
                if score > best.0 {
                    best = (score, centre_mm);
                }
            }
        };
        let (fours, rest) = turned_mm.as_chunks::<4>();
        for centres_mm in fours {
            take(&scores(turned_mm, *centres_mm), centres_mm);
        }
        for centre_mm in rest {
            take(&scores(turned_mm, [*centre_mm]), &[*centre_mm]);
        }
        let mut mask = 0;
        for (&off_mm, &index) in turned_mm.iter().zip(&self.index[from..to]) {
            if (off_mm - best.1).abs() < NEAR_MM {
                mask |= 1 << index;
            }
        }
        (best.0, mask)
    }
}

/// How many rows lie around each of some places, those that are off for less. The sums lie side by side: as
/// many as the narrowest vector unit is wide, and as the registers of a processor hold that has none.
fn scores<const N: usize>(turned_mm: &[f32], centres_mm: [f32; N]) -> [f32; N] {
    /// One over the square of [`NEAR_MM`], 1/mm²: a product in place of a quotient in the inner loop.
    const PER_SQUARE: f32 = 1.0 / (NEAR_MM * NEAR_MM);
    let mut scores = [0.0; N];
    for &other_mm in turned_mm {
        for (score, centre_mm) in scores.iter_mut().zip(centres_mm) {
            let off_mm = other_mm - centre_mm;
            let near = 1.0 - off_mm * off_mm * PER_SQUARE;
            *score += if near > 0.0 { near } else { 0.0 };
        }
    }
    scores
}
