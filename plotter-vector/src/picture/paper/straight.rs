//! [`StraightSheet`]: a sheet as if it were looked at from straight above.

use super::homography::Homography;
use super::quad::SheetQuad;
use crate::parallel::each;
use crate::picture::{Colour, Gray, PxPoint, SizeError};

/// Proportions of what is called a sheet, width for height: beyond it a side is a few pixels.
const PROPORTIONS: core::ops::RangeInclusive<f64> = 0.02..=50.0;

/// Within this and so many deviations of its edge a sheet's rim is mixed with the table, px: what is drawn
/// next to it goes on as it is there.
const RIM_PX: f64 = 3.0;
const RIM_DEVIATIONS: f64 = 2.5;
const MOST_RIM_PX: f64 = 12.0;

/// Where the picture is made smaller by more than this, a pixel is the mean of several places.
const COARSER: f64 = 1.3;

/// Most of those, across and down: a sheet seen so flat shows nothing any more.
const MOST_PLACES: u8 = 4;

/// Rows that a thread makes at a time: enough work for it to begin.
const ROWS_TOGETHER: usize = 32;

/// A sheet of a picture, straightened: its size, and where its places are in the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct StraightSheet {
    width_px: u32,
    height_px: u32,
    /// Before they were rounded to whole pixels.
    size_px: [f64; 2],
    to_picture: Homography,
    rim_px: f64,
}

impl StraightSheet {
    pub(super) fn new(quad: &SheetQuad, proportion: f64) -> Option<Self> {
        let area = quad.area_px();
        if !(PROPORTIONS.contains(&proportion) && area >= 1.0 && area.is_finite()) {
            return None;
        }
        // As many pixels as in the picture: the scale is the same in the mean.
        let side = |px: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let side = libm::round(px).clamp(1.0, f64::from(u32::MAX)) as u32;
            side
        };
        let size_px = [libm::sqrt(area * proportion), libm::sqrt(area / proportion)];
        let [width_px, height_px] = size_px.map(side);
        SizeError::check(width_px, height_px).ok()?;
        let to_picture = Homography::of_quadrilateral(size_px.into(), quad.corners)?;
        let rim_px = (RIM_PX + RIM_DEVIATIONS * quad.error_px).min(MOST_RIM_PX);
        Some(Self { width_px, height_px, size_px, to_picture, rim_px })
    }

    /// Width of the straightened sheet, px.
    #[must_use]
    pub const fn width_px(&self) -> u32 {
        self.width_px
    }

    /// Height of the straightened sheet, px.
    #[must_use]
    pub const fn height_px(&self) -> u32 {
        self.height_px
    }

    /// Width and height of the sheet to a part of a pixel, so that its proportion is kept: its true width
    /// divided by this one is the size of a pixel.
    #[must_use]
    pub const fn size_px(&self) -> [f64; 2] {
        self.size_px
    }

    /// Where places of the straightened sheet are in the picture; both count from their upper left corners.
    #[must_use]
    pub const fn to_picture(&self) -> Homography {
        self.to_picture
    }

    /// How much of the straightened sheet at its edges is not looked at but continued from inside, px.
    #[must_use]
    pub const fn rim_px(&self) -> f64 {
        self.rim_px
    }

    /// The sheet out of a picture's levels.
    #[must_use]
    pub fn gray(&self, picture: &Gray) -> Gray {
        let source = Source { width: picture.width(), height: picture.height(), channels: picture.pixels() };
        Gray::of_checked_size(self.width_px, self.height_px, self.channels::<1>(source))
    }

    /// The same in colour.
    #[must_use]
    pub fn colour(&self, picture: &Colour) -> Colour {
        let pixels = picture.pixels().as_flattened();
        let source = Source { width: picture.width(), height: picture.height(), channels: pixels };
        Colour::of_checked_size(self.width_px, self.height_px, self.channels::<3>(source))
    }

    fn channels<const N: usize>(&self, source: Source<'_>) -> Vec<u8> {
        let row_length = self.width_px as usize * N;
        let mut out = vec![u8::MAX; row_length * self.height_px as usize];
        let parts = out.chunks_mut((row_length * ROWS_TOGETHER).max(1)).enumerate().collect();
        each(parts, |(index, rows): (usize, &mut [u8])| {
            for (y, row) in (index * ROWS_TOGETHER..).zip(rows.chunks_mut(row_length.max(1))) {
                for (x, pixel) in row.chunks_exact_mut(N).enumerate() {
                    let levels = self.mean::<N>(source, x as f64, y as f64);
                    pixel.iter_mut().zip(levels).for_each(|(channel, level)| *channel = level);
                }
            }
        });
        out
    }

    /// A pixel's channels: the mean of as many places as the picture shows of it.
    fn mean<const N: usize>(&self, source: Source<'_>, x: f64, y: f64) -> [u8; N] {
        let inside = |at: f64, length: f64| {
            let rim = self.rim_px.min(length / 2.0);
            at.clamp(rim, length - rim)
        };
        let [width, height] = self.size_px;
        let place = |x: f64, y: f64| {
            let at = PxPoint::new(inside(x, width), inside(y, height));
            self.to_picture.apply(at).unwrap_or_default()
        };
        let middle = place(x + 0.5, y + 0.5);
        let across = place(x + 1.0, y + 0.5).distance(place(x, y + 0.5));
        let down = place(x + 0.5, y + 1.0).distance(place(x + 0.5, y));
        let places = |scale: f64| {
            if scale <= COARSER {
                return 1;
            }
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let places = libm::ceil(scale).clamp(1.0, f64::from(MOST_PLACES)) as u8;
            places
        };
        let (columns, rows) = (places(across), places(down));
        let mut sums = [0.0; N];
        for row in 0..rows {
            for column in 0..columns {
                let at = if columns == 1 && rows == 1 {
                    middle
                } else {
                    let part = |index: u8, of: u8| (f64::from(index) + 0.5) / f64::from(of);
                    place(x + part(column, columns), y + part(row, rows))
                };
                let found = source.at::<N>(at);
                sums.iter_mut().zip(found).for_each(|(sum, channel)| *sum += channel);
            }
        }
        let count = f64::from(columns) * f64::from(rows);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the levels")]
        let level = |sum: f64| (sum / count + 0.5).clamp(0.0, 255.0) as u8;
        sums.map(level)
    }
}

/// A picture's channels.
#[derive(Clone, Copy)]
struct Source<'a> {
    width: u32,
    height: u32,
    channels: &'a [u8],
}

impl Source<'_> {
    /// The channels at a place, by cubic convolution; outside of the picture those at its edge.
    ///
    /// Source: R. G. Keys, "Cubic convolution interpolation for digital image processing" (1981), equation
    /// 15: lines stay as sharp as they are, where the mean of four pixels would blur them.
    fn at<const N: usize>(&self, at: PxPoint) -> [f64; N] {
        let (column, across) = split(at.x, self.width);
        let (row, down) = split(at.y, self.height);
        let (across, down) = (weights(across), weights(down));
        let width = self.width as usize;
        let mut sums = [0.0; N];
        for (y, by_row) in (-1..).zip(down) {
            let row = row.saturating_add_signed(y).min((self.height as usize).saturating_sub(1));
            for (x, by_column) in (-1..).zip(across) {
                let column = column.saturating_add_signed(x).min(width.saturating_sub(1));
                let index = (row * width + column) * N;
                let pixel = self.channels.get(index..index + N).unwrap_or(&[]);
                sums.iter_mut()
                    .zip(pixel)
                    .for_each(|(sum, channel)| *sum += by_row * by_column * f64::from(*channel));
            }
        }
        sums
    }
}

/// A coordinate as the pixel whose middle lies before it, and how far it is on to the next.
fn split(at: f64, length: u32) -> (usize, f64) {
    let at = (at - 0.5).clamp(0.0, f64::from(length.saturating_sub(1)));
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the picture")]
    let before = at as usize;
    (before, at - before as f64)
}

/// The weights of the pixels at -1, 0, 1 and 2 for a place at `t` from 0 to 1.
fn weights(t: f64) -> [f64; 4] {
    [
        ((2.0 - t) * t - 1.0) * t / 2.0,
        ((3.0 * t - 5.0) * t * t + 2.0) / 2.0,
        ((4.0 - 3.0 * t) * t + 1.0) * t / 2.0,
        (t - 1.0) * t * t / 2.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_are_those_of_the_book() {
        // Equation 15 at a half: -1/16, 9/16, 9/16, -1/16.
        assert_eq!(weights(0.5), [-0.0625, 0.5625, 0.5625, -0.0625]);
        assert_eq!(weights(0.0), [0.0, 1.0, 0.0, 0.0]);
        assert!((weights(0.3).iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_seen_straight_stays_as_it_is_and_a_ramp_stays_a_ramp() {
        let rectangle = [(10.0, 20.0), (110.0, 20.0), (110.0, 170.0), (10.0, 170.0)];
        let quad = SheetQuad::of_corners(rectangle.map(|(x, y)| PxPoint::new(x, y))).unwrap();
        let sheet = quad.straightened(quad.proportion(120, 190)).unwrap();
        assert_eq!((sheet.width_px(), sheet.height_px()), (100, 150));
        let level = |x: u32, y: u32| u8::try_from((x + 7 * y) % 251).unwrap();
        let levels = (0..190).flat_map(|y| (0..120).map(move |x| level(x, y))).collect();
        let picture = Gray::new(120, 190, levels).unwrap();
        let straight = sheet.gray(&picture);
        let at = |x: u32, y: u32| straight.get(crate::Pixel::new(x, y)).unwrap();
        assert_eq!((at(50, 70), at(3, 3), at(90, 140)), (level(60, 90), level(13, 23), level(100, 160)));
        // The rim is continued: the outermost pixels are as those inside of it.
        assert_eq!(at(0, 70), at(2, 70));
        // Twice as many columns as there were: between the middles of two lies their mean.
        let quad = SheetQuad::of_corners(
            [(0.0, 0.0), (8.0, 0.0), (8.0, 64.0), (0.0, 64.0)].map(|(x, y)| PxPoint::new(x, y)),
        );
        let ramp = Gray::new(8, 64, (0..8 * 64_u16).map(|at| u8::try_from(10 * (at % 8)).unwrap()).collect());
        let sheet = quad.unwrap().straightened(0.5).unwrap();
        let straight = sheet.gray(&ramp.unwrap());
        assert_eq!((straight.width(), straight.height()), (16, 32));
        let row: Vec<u8> = (6..10).map(|x| straight.get(crate::Pixel::new(x, 16)).unwrap()).collect();
        assert_eq!(row, [28, 33, 38, 43]);
    }

    #[test]
    fn what_is_no_picture_is_none() {
        let quad = SheetQuad::of_corners(
            [(0.0, 0.0), (9.0, 0.0), (9.0, 9.0), (0.0, 9.0)].map(|(x, y)| PxPoint::new(x, y)),
        );
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert_eq!(quad.unwrap().straightened(bad), None);
        }
        // Not convex; the wrong way around; three in a line.
        for bad in [
            [(0.0, 0.0), (9.0, 0.0), (2.0, 2.0), (0.0, 9.0)],
            [(0.0, 0.0), (0.0, 9.0), (9.0, 9.0), (9.0, 0.0)],
            [(0.0, 0.0), (4.0, 0.0), (9.0, 0.0), (0.0, 9.0)],
        ] {
            assert_eq!(SheetQuad::of_corners(bad.map(|(x, y)| PxPoint::new(x, y))), None);
        }
    }
}
