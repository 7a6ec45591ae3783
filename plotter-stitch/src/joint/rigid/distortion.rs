//! What a sheet does besides turning and shifting: it swells, and the line between its frames bows.

use super::equations::{PER_LEVER, Row, Solution, single};
use crate::marks::MOST_CROSSINGS;
use plotter_motion::{Axis, Point, Vec2};

/// How many ways there are: swelling, bow, and what it swells more across the joint than along it.
const WAYS: usize = 3;

/// How likely each of them is taken to be before the marks are looked at, against not being there: then a
/// swelling that is three of its own deviations counts for about half, and one that is not there costs
/// nothing that shows.
const ODDS: f32 = 0.03;

/// The same where it is told how sure that is: as likely as not, since on paper that does swell what is too
/// small to be believed is still there.
const ODDS_OF_DOUBT: f32 = 2.0;

/// A way whose usual size is less than a tenth of what the marks know of it is not looked for, and stays in
/// the deviation that is told as it is: the square of that. Marks beside the field show no bow between them.
const LEAST_SHOWN: f32 = 0.01;

/// The expected deviation counts for as many residuals as this against those that are seen.
pub(super) const PRIOR_RESIDUALS: f32 = 4.0;

/// How far one place moves, mm, single precision: what is left after turn and shift is tenths of a
/// millimetre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Move {
    x: f32,
    y: f32,
}

/// What the ways are, for one layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ways {
    origin: [f32; 2],
    along: [f32; 2],
    length_mm: f32,
    /// Standard deviations where they are there: of swelling, of bow in mm, of the rest of swelling.
    spread: [f32; WAYS],
}

impl Ways {
    pub(super) fn new(joint: [Point; 2], swelling: f64, bow_mm: f64) -> Self {
        let [from, to] = joint.map(|end| [single(end.x), single(end.y)]);
        let way = [to[0] - from[0], to[1] - from[1]];
        let length_mm = libm::sqrtf(way[0] * way[0] + way[1] * way[1]);
        let spread = |value: f64| if value > 0.0 && length_mm > 0.0 { single(value) } else { 0.0 };
        Self {
            origin: from,
            along: way.map(|way| way / length_mm),
            length_mm,
            spread: [spread(swelling), spread(bow_mm), spread(swelling)],
        }
    }

    /// How each way moves a place of the frame, per unit of it, mm.
    ///
    /// ```text
    /// t from 0 to 1 along the joint, c its middle:
    ///   swelling  place - c        bow  4 t (1 - t), across       the rest  what of place - c is across
    /// ```
    fn moves(&self, [x, y]: [f32; 2]) -> [Move; WAYS] {
        let [along_x, along_y] = self.along;
        let (x, y) = (x - self.origin[0], y - self.origin[1]);
        let u = x * along_x + y * along_y;
        let v = y * along_x - x * along_y;
        let t = u / self.length_mm;
        let from_middle = u - 0.5 * self.length_mm;
        let bow = 4.0 * t * (1.0 - t);
        let across = |by: f32| Move { x: -along_y * by, y: along_x * by };
        let (wide, bowed) = (across(v), across(bow));
        let swollen = Move { x: along_x * from_middle + wide.x, y: along_y * from_middle + wide.y };
        [swollen, bowed, wide]
    }
}

/// How much of each way there is, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distortion {
    ways: Ways,
    /// Of each way, how much of those before it is taken out, so that they can be told one after the other.
    mixed: [[f32; WAYS]; WAYS],
    /// Which turn and shift imitate it best, in the unknowns of the equations.
    imitated: [[f32; 3]; WAYS],
    amount: [f32; WAYS],
    variance: [f32; WAYS],
    /// Weighted sum of the squares that is left.
    pub(super) squares: f32,
}

impl Distortion {
    /// What the residuals of the rows in `mask`, mm, say. What is believed is taken off all of them.
    ///
    /// Each way is either not there or has a normal size: how likely it is follows from how much better it
    /// explains the residuals (the ratio of both marginal likelihoods), and as much of it is believed. So a
    /// sheet that only turns and shifts is told as well as if nothing else had been asked for, and there is
    /// no threshold at which an answer would jump.
    ///
    /// Source: J. A. Hoeting, D. Madigan, A. E. Raftery, C. T. Volinsky, "Bayesian model averaging: a
    /// tutorial" (1999), equations 1 to 3.
    pub(super) fn of(
        ways: Ways,
        rows: &[Row],
        mask: u64,
        solution: &Solution,
        residuals_mm: &mut [f32; MOST_CROSSINGS],
    ) -> Self {
        let mut this = Self {
            ways,
            mixed: [[0.0; WAYS]; WAYS],
            imitated: [[0.0; 3]; WAYS],
            amount: [0.0; WAYS],
            variance: [0.0; WAYS],
            squares: single(solution.squares),
        };
        let mut lines = [At::NOWHERE; MOST_CROSSINGS];
        let shift = solution.pose.shift();
        let shift_mm = [single(shift.x), single(shift.y)];
        for (index, (line, row)) in lines.iter_mut().zip(rows).enumerate() {
            *line = At::of(row, shift_mm, &ways);
            if mask >> index & 1 == 0 {
                line.weight = 0.0;
            }
        }
        let lines = &mut lines[..rows.len()];
        let cofactor: [[f32; 3]; 3] = core::array::from_fn(|row| {
            core::array::from_fn(|column| single(solution.cofactor[(row, column)]))
        });
        let (mut sums, mut products) = ([0.0_f32; WAYS], [0.0_f32; WAYS]);
        for way in 0..WAYS {
            if ways.spread[way] <= 0.0 {
                continue;
            }
            let mut right = [0.0_f32; 3];
            for line in &*lines {
                let by = line.weight * line.by[way];
                (0..3).for_each(|unknown| right[unknown] += by * line.slope[unknown]);
            }
            this.imitated[way] = cofactor.map(|of| dot(&of, &right));
            for line in &mut *lines {
                line.by[way] -= dot(&this.imitated[way], &line.slope);
            }
            for (before, sum) in sums.into_iter().enumerate().take(way).filter(|(_, sum)| *sum > 0.0) {
                let shared: f32 = lines.iter().map(|line| line.weight * line.by[before] * line.by[way]).sum();
                let mixed = shared / sum;
                this.mixed[way][before] = mixed;
                lines.iter_mut().for_each(|line| line.by[way] -= mixed * line.by[before]);
            }
            for (line, residual_mm) in lines.iter().zip(&*residuals_mm) {
                let by = line.weight * line.by[way];
                sums[way] += by * line.by[way];
                products[way] += by * residual_mm;
            }
            // Marks that do not show it leave rounding in its place.
            if ways.spread[way] * ways.spread[way] * sums[way] < LEAST_SHOWN {
                (sums[way], products[way]) = (0.0, 0.0);
            }
        }
        this.judge(sums, products, solution.rows);
        for (line, residual_mm) in lines.iter().zip(residuals_mm) {
            *residual_mm -= dot(&line.by, &this.amount);
        }
        this
    }

    /// From what each way has in the residuals to how much of it is believed.
    fn judge(&mut self, sums: [f32; WAYS], products: [f32; WAYS], rows: u32) {
        let all = self.squares;
        let explained: f32 =
            sums.iter().zip(&products).filter(|(sum, _)| **sum > 0.0).map(|(sum, by)| by * by / sum).sum();
        #[expect(clippy::cast_precision_loss, reason = "at most 64 rows")]
        let free = rows.saturating_sub(6) as f32;
        // What the paper is rougher than expected explains too.
        let rough = ((PRIOR_RESIDUALS + (all - explained).max(0.0)) / (PRIOR_RESIDUALS + free)).max(1.0);
        for way in 0..WAYS {
            let (sum, product) = (sums[way], products[way]);
            let spread = self.ways.spread[way];
            let ratio = spread * spread * sum / rough;
            if ratio.is_nan() || ratio <= 0.0 {
                // What no mark shows may be there in full.
                self.variance[way] = spread * spread;
                continue;
            }
            let kept = ratio / (1.0 + ratio);
            let gain = 0.5 * product * product / (sum * rough) * kept;
            // Above 80 nothing changes any more, and the power would leave single precision.
            let likelier = libm::expf(gain.min(80.0)) / libm::sqrtf(1.0 + ratio);
            let share = |odds: f32| odds / (1.0 + odds);
            let full = product / sum * kept;
            let amount = share(ODDS * likelier) * full;
            self.amount[way] = amount;
            // Where it is there for certain, or is not, around what is told.
            let there = share(ODDS_OF_DOUBT * likelier);
            let missed = full - amount;
            self.variance[way] =
                there * (rough * kept / sum + missed * missed) + (1.0 - there) * amount * amount;
            self.squares -= amount * (2.0 * product - amount * sum);
        }
        self.squares = self.squares.max(0.0);
    }

    /// Each way from how it is before the ones before it are taken out.
    fn each(&self, raw: impl Fn(usize) -> f32) -> [f32; WAYS] {
        let mut freed = [0.0_f32; WAYS];
        for way in 0..WAYS {
            let taken: f32 = (0..way).map(|before| self.mixed[way][before] * freed[before]).sum();
            freed[way] = raw(way) - taken;
        }
        freed
    }

    /// How far it moves a place of the frame, mm, from where turn and shift alone would have it.
    pub(super) fn moved(&self, place: Point) -> Vec2 {
        let ways = self.freed(place);
        let sum = |of: fn(&Move) -> f32| -> f32 {
            ways.iter().zip(&self.amount).map(|(by, amount)| of(by) * amount).sum()
        };
        Vec2::new(f64::from(sum(|by| by.x)), f64::from(sum(|by| by.y)))
    }

    /// Variances of that, mm².
    pub(super) fn variances(&self, place: Point) -> [f64; 2] {
        let ways = self.freed(place);
        let sum = |of: fn(&Move) -> f32| -> f32 {
            ways.iter().zip(&self.variance).map(|(by, variance)| of(by) * of(by) * variance).sum()
        };
        [f64::from(sum(|by| by.x)), f64::from(sum(|by| by.y))]
    }

    fn freed(&self, place: Point) -> [Move; WAYS] {
        let at = [single(place.x), single(place.y)];
        if self.amount == [0.0; WAYS] && self.variance == [0.0; WAYS] {
            return [Move::default(); WAYS];
        }
        let moves = self.ways.moves(at);
        // In the equations an unknown is what is taken off the found place, so what it imitates comes back
        // with the other sign.
        let turned = |way: usize| self.imitated[way][0] * single(PER_LEVER);
        let x = self.each(|way| moves[way].x + self.imitated[way][1] - turned(way) * at[1]);
        let y = self.each(|way| moves[way].y + self.imitated[way][2] + turned(way) * at[0]);
        core::array::from_fn(|way| Move { x: x[way], y: y[way] })
    }

    /// Swelling along the joint, and bow, mm.
    pub(super) fn amounts(&self) -> [f64; 2] {
        // A way that has others taken out is there with all of itself; those others lose as much.
        let mut amount = self.amount;
        for way in (0..WAYS).rev() {
            for before in 0..way {
                amount[before] -= self.mixed[way][before] * amount[way];
            }
        }
        [f64::from(amount[0]), f64::from(amount[1])]
    }

    /// Standard deviation of the swelling.
    pub(super) fn sigma_swelling(&self) -> f64 {
        f64::from(libm::sqrtf(self.variance[0]))
    }
}

/// A row in single precision.
#[derive(Clone, Copy)]
struct At {
    /// 1 / variance, 1/mm², or 0 if it takes no part.
    weight: f32,
    /// How its residual changes with the three unknowns, but for a thousandth of it that the turn itself
    /// makes.
    slope: [f32; 3],
    /// How each way moves it along its scan, mm.
    by: [f32; WAYS],
}

impl At {
    const NOWHERE: Self = Self { weight: 0.0, slope: [0.0; 3], by: [0.0; WAYS] };

    fn of(row: &Row, shift_mm: [f32; 2], ways: &Ways) -> Self {
        let (mark_mm, scan_mm) = (single(row.mark_mm), single(row.scan_at_mm));
        let weight = single(row.weight);
        match row.axis {
            Axis::X => {
                let y = scan_mm - shift_mm[1];
                let by = ways.moves([mark_mm, y]).map(|by| by.x);
                Self { weight, slope: [y * single(PER_LEVER), -1.0, 0.0], by }
            }
            Axis::Y => {
                let x = scan_mm - shift_mm[0];
                let by = ways.moves([x, mark_mm]).map(|by| by.y);
                Self { weight, slope: [-x * single(PER_LEVER), 0.0, -1.0], by }
            }
        }
    }
}

fn dot(one: &[f32; 3], other: &[f32; 3]) -> f32 {
    one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
}
