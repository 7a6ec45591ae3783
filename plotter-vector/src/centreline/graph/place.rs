//! [`Place`]: a place on a centreline as it waits for the rest of its stroke.

use crate::stroke::PxPoint;

/// Steps in a pixel: what a band's own origin adds to the rounding of a coordinate is far below one of them, so a place is
/// the same in every band that finds it. Columns up to 2^17 px fit into 32 bits, rows up to 2^26 px into 40.
const STEPS: f64 = 8192.0;

/// Most steps down.
const MOST_DOWN: i64 = (1 << 39) - 1;

/// Steps in a pixel of width.
const WIDTH_STEPS: f64 = 64.0;

/// A place on a centreline, how wide the ink is there, and whether the line has a corner or ends there. A whole sheet of
/// strokes that have not ended yet may wait like this: 12 bytes each.
///
/// Places are ordered as one reads, from the top.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    /// The highest 8 bits of the steps down, and the others.
    y_high: i8,
    y_low: u32,
    x: i32,
    width: i16,
    role: Role,
}

/// What a line has at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Role {
    Course,
    Tip,
    SeatedTip,
    Corner,
}

impl Place {
    /// A place, px of the whole picture; the width, px, is a negative number where no ink was measured (in a junction).
    pub(crate) fn new(at: PxPoint, width_px: f64, corner: bool) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let x = libm::round(at.x * STEPS) as i32;
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let y = (libm::round(at.y * STEPS) as i64).clamp(-MOST_DOWN, MOST_DOWN);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the bits in two parts")]
        let (y_high, y_low) = ((y >> 32) as i8, y as u32);
        #[expect(clippy::cast_possible_truncation, reason = "a float cast saturates")]
        let width = libm::round(width_px * WIDTH_STEPS) as i16;
        Self { y_high, y_low, x, width, role: if corner { Role::Corner } else { Role::Course } }
    }

    /// The place where a line ends that joins nothing there.
    pub(crate) fn tip(at: PxPoint) -> Self {
        Self { role: Role::Tip, ..Self::new(at, -1.0, false) }
    }

    /// The same where it is known to lie across the line.
    pub(crate) fn seated_tip(at: PxPoint) -> Self {
        Self { role: Role::SeatedTip, ..Self::tip(at) }
    }

    /// Where.
    pub(crate) fn at(self) -> PxPoint {
        const HIGH: f64 = 4_294_967_296.0;
        let y = f64::from(self.y_high) * HIGH + f64::from(self.y_low);
        PxPoint::new(f64::from(self.x) / STEPS, y / STEPS)
    }

    /// Row of pixels that it lies in.
    pub(crate) fn row(self) -> i32 {
        // STEPS is 2 to the power of 13, and 19 of the low bits are left of them.
        i32::from(self.y_high) << 19 | (self.y_low >> 13).cast_signed()
    }

    /// From edge to edge, px; none where no ink was measured.
    pub(crate) fn width_px(self) -> Option<f64> {
        (self.width > 0).then(|| f64::from(self.width) / WIDTH_STEPS)
    }

    /// Whether it is a pixel's middle, or half way between two: what 1 bit a pixel can tell.
    pub(crate) fn is_on_raster(self) -> bool {
        // Half of STEPS is 2 to the power of 12.
        (self.x.cast_unsigned() | self.y_low).trailing_zeros() >= 12
    }

    /// Whether the line has a corner here.
    pub(crate) fn is_corner(self) -> bool {
        self.role == Role::Corner
    }

    /// Whether the line ends here and joins nothing.
    pub(crate) fn is_tip(self) -> bool {
        matches!(self.role, Role::Tip | Role::SeatedTip)
    }

    /// Whether it ends here, and lies here across its line.
    pub(crate) fn is_seated_tip(self) -> bool {
        self.role == Role::SeatedTip
    }

    /// The same width at another place, which is no corner.
    pub(crate) fn moved(self, at: PxPoint) -> Self {
        Self { width: self.width, ..Self::new(at, 0.0, false) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_sheet_has_its_places() {
        for v in [0.5, 131_071.5, 131_072.0, 77.125] {
            let place = Place::new(PxPoint::new(v, -v), 3.5, true);
            assert_eq!((place.at(), place.width_px()), (PxPoint::new(v, -v), Some(3.5)));
        }
        assert_eq!(
            [-0.5, 0.0, 7.999, 8.0].map(|y| Place::new(PxPoint::new(0.0, y), 1.0, false).row()),
            [-1, 0, 7, 8]
        );
        assert_eq!(Place::new(PxPoint::default(), -1.0, false).width_px(), None);
        assert_eq!(size_of::<Place>(), 12);
    }

    #[test]
    fn rows_far_down_are_as_exact_as_the_first_ones() {
        for (v, row) in
            [(262_144.0, 262_144), (524_288.5, 524_288), (4_194_303.125, 4_194_303), (-524_288.5, -524_289)]
        {
            let place = Place::new(PxPoint::new(1.5, v), 1.0, false);
            assert_eq!((place.at(), place.row()), (PxPoint::new(1.5, v), row));
        }
        let order = [-4e5, -0.5, 0.0, 5.0, 3e5, 9e5].map(|y| Place::new(PxPoint::new(0.0, y), 1.0, false));
        assert!(order.is_sorted());
        assert!(Place::new(PxPoint::new(0.0, 524_288.5), 1.0, false).is_on_raster());
    }

    #[test]
    fn the_origin_of_a_band_does_not_show() {
        let (y, first_row) = (1.0 / 3.0, 70_001.0);
        let inside = (y + 1_234.0) - 1_234.0;
        let place = |y: f64| Place::new(PxPoint::new(0.0, y + first_row), 1.0, false);
        assert_eq!(place(y), place(inside));
    }
}
