//! [`Wiper`]: discs of paper on a picture.
//!
//! The places of a line lie in the middle of a pixel or between two, and its width changes seldom. So the runs of pixels that
//! a disc covers are worked out once, and moved from place to place.

use crate::{Bitmap, PxPoint};

/// Widest disc that is kept, px: its runs fit into a word.
const WIDEST_PX: f64 = 60.0;

/// Discs that are kept.
const KEPT: usize = 256;

/// Draws discs in paper on a band of a picture that begins with row `first_row`.
pub(super) struct Wiper<'a> {
    bare: &'a mut Bitmap,
    first_row: u32,
    /// Discs in a row or column of pixels that are not drawn yet: the first one, the last one, their radius.
    drawn: Option<(PxPoint, PxPoint, f64)>,
    /// Each in the slot of its [`Disc::slot`].
    discs: Vec<Disc>,
}

/// A disc as seen from the pixel that its centre lies in.
#[derive(Clone, Default)]
struct Disc {
    radius_px: f64,
    /// Where in that pixel the centre is: at 0 or 0.5.
    x: f64,
    y: f64,
    /// First row, and in each row the first column and a bit for each column from there on.
    top: i32,
    runs: Vec<(i32, u64)>,
}

impl Disc {
    /// A disc with its centre at a place of the first pixel.
    #[expect(clippy::cast_possible_truncation, reason = "some tens of pixels")]
    fn new(radius_px: f64, x: f64, y: f64) -> Self {
        let first = libm::ceil(y - radius_px - 0.5);
        let mut runs = Vec::new();
        let mut row = first;
        while row + 0.5 <= y + radius_px {
            let dy = row + 0.5 - y;
            let half = libm::sqrt((radius_px * radius_px - dy * dy).max(0.0));
            let (from, to) = (libm::ceil(x - half - 0.5) as i32, libm::floor(x + half - 0.5) as i32);
            let count = u32::try_from(to + 1 - from).unwrap_or(0);
            runs.push((from, u64::MAX.checked_shr(u64::BITS - count).unwrap_or(0)));
            row += 1.0;
        }
        Self { radius_px, x, y, top: first as i32, runs }
    }

    /// Where a disc is kept.
    fn slot(radius_px: f64, x: f64, y: f64) -> usize {
        /// The golden section of 2⁶⁴ spreads numbers that differ in a few bits.
        const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;
        let place = u64::from(x > 0.0) + 2 * u64::from(y > 0.0);
        ((radius_px.to_bits() ^ place).wrapping_mul(SPREAD) >> 56) as usize % KEPT
    }
}

impl<'a> Wiper<'a> {
    /// For a picture whose first row is row `first_row`.
    pub(super) fn new(bare: &'a mut Bitmap, first_row: u32) -> Self {
        Self { bare, first_row, drawn: None, discs: vec![Disc::default(); KEPT] }
    }

    /// A disc more.
    pub(super) fn add(&mut self, at: PxPoint, radius_px: f64) {
        if let Some((first, last, radius)) = &mut self.drawn
            && radius.to_bits() == radius_px.to_bits()
            && (goes_on(first.x, last.x, at.x) && is_same(first.y, last.y, at.y)
                || goes_on(first.y, last.y, at.y) && is_same(first.x, last.x, at.x))
        {
            *last = at;
            return;
        }
        self.wipe();
        self.drawn = Some((at, at, radius_px));
    }

    /// Draws what is not drawn yet.
    pub(super) fn wipe(&mut self) {
        let Some((first, last, radius_px)) = self.drawn.take() else { return };
        if first != last || !self.wipe_disc(first, radius_px) {
            self.wipe_row(first, last, radius_px);
        }
    }

    /// Draws one disc as it is kept; not where it comes near the picture's left or right border.
    #[expect(clippy::cast_possible_truncation, reason = "within the picture")]
    fn wipe_disc(&mut self, at: PxPoint, radius_px: f64) -> bool {
        let (left, top) = (libm::floor(at.x), libm::floor(at.y));
        let (x, y) = (at.x - left, at.y - top);
        let is_kept = |part: f64| part == 0.0 || part == 0.5;
        let inside = at.x > WIDEST_PX && at.x + WIDEST_PX < f64::from(self.bare.width());
        if !(is_kept(x) && is_kept(y) && inside && radius_px < 0.5 * WIDEST_PX) {
            return false;
        }
        let Some(disc) = self.discs.get_mut(Disc::slot(radius_px, x, y)) else { return false };
        if (disc.radius_px, disc.x, disc.y) != (radius_px, x, y) {
            *disc = Disc::new(radius_px, x, y);
        }
        let (left, first) = (left as i32, (top as i32).wrapping_add(disc.top));
        let first = first.wrapping_sub_unsigned(self.first_row);
        for (row, (from, bits)) in (first..).zip(&disc.runs) {
            if let (Ok(row), Ok(column)) = (u32::try_from(row), u32::try_from(left + from))
                && row < self.bare.height()
            {
                self.bare.clear_bits(row, column, *bits);
            }
        }
        true
    }

    /// Draws discs in a row or column of pixels: in each row of pixels they are one run.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
    fn wipe_row(&mut self, first: PxPoint, last: PxPoint, radius_px: f64) {
        let (left, right) = (first.x.min(last.x), first.x.max(last.x));
        let (upper, lower) = (first.y.min(last.y), first.y.max(last.y));
        let (width, top) = (f64::from(self.bare.width()), f64::from(self.first_row));
        let bottom = top + f64::from(self.bare.height());
        let mut y = libm::ceil((upper - radius_px - 0.5).max(top));
        while y + 0.5 <= lower + radius_px && y < bottom {
            let centre = y + 0.5;
            let dy = if centre < upper { centre - upper } else { (centre - lower).max(0.0) };
            let half = libm::sqrt((radius_px * radius_px - dy * dy).max(0.0));
            let (from, to) = ((left - half - 0.5).max(0.0), (right + half - 0.5).min(width - 1.0));
            if to >= 0.0 {
                // Rounded up, and down.
                let (whole, to) = (from as u32, to as u32);
                let from = whole + u32::from(f64::from(whole) < from);
                if from <= to {
                    self.bare.clear_run((y - top) as u32, from..to + 1);
                }
            }
            y += 1.0;
        }
    }
}

/// Whether a coordinate goes on from pixel to pixel in one direction, at their centres.
fn goes_on(first: f64, last: f64, next: f64) -> bool {
    let step = next - last;
    (step == 1.0 && last >= first || step == -1.0 && last <= first) && last - libm::floor(last) == 0.5
}

fn is_same(first: f64, last: f64, next: f64) -> bool {
    first.to_bits() == last.to_bits() && last.to_bits() == next.to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Pixel;

    #[test]
    fn a_disc_covers_the_pixels_whose_middles_it_covers() {
        for (x, y) in [(80.5, 30.5), (80.0, 30.5), (80.5, 31.0), (64.0, 4.0), (90.25, 30.7), (2.5, 58.5)] {
            for quarter in 2..120_u32 {
                let (at, radius_px) = (PxPoint::new(x, y), f64::from(quarter) * 0.249);
                let mut bare = Bitmap::new(200, 60).unwrap();
                (0..60).for_each(|y| (0..200).for_each(|x| bare.set(Pixel::new(x, y), true)));
                let mut wiper = Wiper::new(&mut bare, 0);
                wiper.add(at, radius_px);
                wiper.wipe();
                for (x, y) in (0..60).flat_map(|y| (0..200).map(move |x| (x, y))) {
                    let pixel = Pixel::new(x, y);
                    let far = at.distance(pixel.into());
                    let sure = (far - radius_px).abs() > 1e-9;
                    assert!(!sure || bare.get(pixel) == (far > radius_px), "{at:?} {radius_px} {pixel:?}");
                }
            }
        }
    }
}
