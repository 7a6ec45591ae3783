//! From strokes to pixels: a round pen moved along each polyline.
//!
//! A pixel is ink when its centre lies within half a pen width of the stroke. Smooth pictures ask the same of
//! 8 x 8 points in each pixel, kept as the 64 bits of one word. A pen of 1 px draws one pixel per column
//! where the line is flat and one per row where it is steep, as thinned line art looks.

use super::random::Random;
use super::strokes::{At, Look, Picture, Stroke};
use image::{DynamicImage, GrayImage, Luma};
use image::{Rgb, RgbImage};

/// So much farther than half a pen width still counts, px: rounding must not decide about whole rows of
/// pixels.
const EDGE_PX: f64 = 1e-9;

/// Paper light of the scan from the upper left to the lower right corner, and its ink likewise.
const LIGHT: (f64, f64) = (255.0, 170.0);
const DARK: (f64, f64) = (40.0, 90.0);
/// Standard deviation of the scan's noise, and the share of its pixels that are black or white by accident.
const NOISE: f64 = 8.0;
const SPECKLES: f64 = 0.005;

impl Picture {
    /// Its pixels.
    #[must_use]
    pub fn draw(&self) -> DynamicImage {
        match self.look {
            Look::Ink => {
                let mut sheet = GrayImage::from_pixel(self.width, self.height, Luma([255]));
                for stroke in &self.strokes {
                    for (x, y) in pixels(stroke, self.width, self.height) {
                        sheet.put_pixel(x, y, Luma([0]));
                    }
                }
                sheet.into()
            }
            Look::Smooth if self.strokes.iter().all(|stroke| stroke.colour == [0; 3]) => {
                let cover = self.cover();
                GrayImage::from_fn(self.width, self.height, |x, y| Luma([shade(255.0, 0.0, cover(x, y))]))
                    .into()
            }
            Look::Smooth => self.coloured().into(),
            Look::Scan => self.scan().into(),
        }
    }

    /// The share of each pixel that any stroke covers.
    fn cover(&self) -> impl Fn(u32, u32) -> f64 {
        let mut mask = Mask::new(self.width, self.height);
        for stroke in &self.strokes {
            mask.add(stroke);
        }
        move |x, y| mask.share(x, y)
    }

    fn coloured(&self) -> RgbImage {
        let mut sheet = RgbImage::from_pixel(self.width, self.height, Rgb([255; 3]));
        for stroke in &self.strokes {
            let mut mask = Mask::new(self.width, self.height);
            mask.add(stroke);
            for (x, y, pixel) in sheet.enumerate_pixels_mut() {
                let share = mask.share(x, y);
                for (under, over) in pixel.0.iter_mut().zip(stroke.colour) {
                    *under = shade(f64::from(*under), f64::from(over), share);
                }
            }
        }
        sheet
    }

    fn scan(&self) -> GrayImage {
        let cover = self.cover();
        let mut random = Random::new(2009);
        GrayImage::from_fn(self.width, self.height, |x, y| {
            let across = f64::midpoint(
                f64::from(x) / f64::from(self.width - 1),
                f64::from(y) / f64::from(self.height - 1),
            );
            let between = |(from, to): (f64, f64)| from + (to - from) * across;
            let noise = NOISE * random.normal();
            let speckle = random.unit();
            if speckle < SPECKLES / 2.0 {
                Luma([0])
            } else if speckle < SPECKLES {
                Luma([255])
            } else {
                Luma([shade(between(LIGHT) + noise, between(DARK) + noise, cover(x, y))])
            }
        })
    }
}

fn shade(under: f64, over: f64, share: f64) -> u8 {
    let value = libm::round(under + (over - under) * share).clamp(0.0, 255.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and from 0 to 255")]
    let value = value as u8;
    value
}

/// Which of the 8 x 8 points in each pixel are covered.
struct Mask {
    width: u32,
    height: u32,
    bits: Vec<u64>,
}

impl Mask {
    fn new(width: u32, height: u32) -> Self {
        let size = u64::from(width) * u64::from(height);
        Self { width, height, bits: vec![0; usize::try_from(size).unwrap_or(0)] }
    }

    fn place(&self, x: u32, y: u32) -> usize {
        usize::try_from(u64::from(y) * u64::from(self.width) + u64::from(x)).unwrap_or(usize::MAX)
    }

    fn share(&self, x: u32, y: u32) -> f64 {
        self.bits.get(self.place(x, y)).map_or(0.0, |bits| f64::from(bits.count_ones()) / 64.0)
    }

    fn add(&mut self, stroke: &Stroke) {
        for piece in pieces(stroke) {
            for (x, y) in piece.box_in(self.width, self.height) {
                let mut bits = 0_u64;
                for point in 0..64_u32 {
                    let (column, row) = (f64::from(point % 8), f64::from(point / 8));
                    let at = (f64::from(x) + (column - 3.5) / 8.0, f64::from(y) + (row - 3.5) / 8.0);
                    bits |= u64::from(piece.covers(at)) << point;
                }
                let place = self.place(x, y);
                if let Some(word) = self.bits.get_mut(place) {
                    *word |= bits;
                }
            }
        }
    }
}

/// The pixels that a stroke blackens; some more than once.
fn pixels(stroke: &Stroke, width: u32, height: u32) -> Vec<(u32, u32)> {
    if stroke.width_px <= 1.0 {
        return thin(&stroke.points).into_iter().filter_map(|at| inside(at, width, height)).collect();
    }
    let covered = |piece: Piece| {
        piece
            .box_in(width, height)
            .into_iter()
            .filter(move |(x, y)| piece.covers((f64::from(*x), f64::from(*y))))
    };
    pieces(stroke).into_iter().flat_map(covered).collect()
}

/// A straight piece of a stroke with the radius of the pen.
#[derive(Clone, Copy)]
struct Piece {
    from: At,
    to: At,
    radius: f64,
    tapers: bool,
}

fn pieces(stroke: &Stroke) -> Vec<Piece> {
    let piece = |from, to| Piece { from, to, radius: stroke.width_px / 2.0, tapers: stroke.tapers };
    match stroke.points.as_slice() {
        [dot] => vec![piece(*dot, *dot)],
        points => points.windows(2).map(|pair| piece(pair[0], pair[1])).collect(),
    }
}

impl Piece {
    fn covers(&self, at: At) -> bool {
        let (dx, dy) = (self.to.0 - self.from.0, self.to.1 - self.from.1);
        let square = dx * dx + dy * dy;
        let along = (at.0 - self.from.0) * dx + (at.1 - self.from.1) * dy;
        let share = if square > 0.0 { along / square } else { 0.0 };
        let foot = share.clamp(0.0, 1.0);
        let away = libm::hypot(at.0 - self.from.0 - foot * dx, at.1 - self.from.1 - foot * dy);
        let reach = if !self.tapers {
            self.radius
        } else if (0.0..=1.0).contains(&share) {
            // Half a pixel at least: the tip of a needle is thin, but not a row of dots.
            (self.radius * (1.0 - share)).max(0.5)
        } else {
            0.0
        };
        away <= reach + EDGE_PX
    }

    /// The pixels that the piece may touch.
    fn box_in(&self, width: u32, height: u32) -> Vec<(u32, u32)> {
        let reach = self.radius + 1.0;
        let range = |a: f64, b: f64, size: u32| whole(a.min(b) - reach, size)..whole(a.max(b) + reach, size);
        let columns = range(self.from.0, self.to.0, width);
        range(self.from.1, self.to.1, height)
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            // A long slanted piece has a large box and a small neighbourhood.
            .filter(|(x, y)| self.near((f64::from(*x), f64::from(*y)), reach))
            .collect()
    }

    fn near(&self, at: At, reach: f64) -> bool {
        let (dx, dy) = (self.to.0 - self.from.0, self.to.1 - self.from.1);
        let across = (at.0 - self.from.0) * dy - (at.1 - self.from.1) * dx;
        across * across <= reach * reach * (dx * dx + dy * dy) + EDGE_PX || dx * dx + dy * dy == 0.0
    }
}

fn whole(value: f64, size: u32) -> u32 {
    let value = libm::ceil(value).clamp(0.0, f64::from(size));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "whole and within the picture"
    )]
    let value = value as u32;
    value
}

fn inside((x, y): At, width: u32, height: u32) -> Option<(u32, u32)> {
    let inside = x >= 0.0 && y >= 0.0 && x < f64::from(width) && y < f64::from(height);
    inside.then(|| (whole(x, width), whole(y, height)))
}

fn round((x, y): At) -> At {
    (libm::floor(x + 0.5), libm::floor(y + 0.5))
}

/// The pixels of a line of 1 px: its ends and corners, the nearest pixel in each column where it is flat and
/// in each row where it is steep, and where one changes to the other what keeps them connected.
fn thin(points: &[At]) -> Vec<At> {
    let mut exact: Vec<At> = points.first().copied().into_iter().collect();
    for (index, pair) in points.windows(2).enumerate() {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let flat = libm::fabs(dx) >= libm::fabs(dy);
        let (start, way) = if flat { (from.0, dx) } else { (from.1, dy) };
        let mut grid = if way > 0.0 { libm::ceil(start) } else { libm::floor(start) };
        while (grid - start) * way.signum() <= libm::fabs(way) {
            let share = (grid - start) / way;
            let line = if flat { (grid, from.1 + share * dy) } else { (from.0 + share * dx, grid) };
            exact.push(line);
            grid += way.signum();
        }
        let corner = points.get(index + 2).is_none_or(|next| {
            let (ex, ey) = (next.0 - to.0, next.1 - to.1);
            // More than 30 degrees.
            dx * ex + dy * ey < 0.866 * libm::hypot(dx, dy) * libm::hypot(ex, ey)
        });
        if corner {
            exact.push(to);
        }
    }
    let mut pixels: Vec<At> = Vec::new();
    let mut before: Option<At> = None;
    for at in exact {
        if let Some(before) = before {
            let (a, b) = (round(before), round(at));
            if libm::fabs(a.0 - b.0) > 1.0 || libm::fabs(a.1 - b.1) > 1.0 {
                pixels.push(round((f64::midpoint(before.0, at.0), f64::midpoint(before.1, at.1))));
            }
        }
        pixels.push(round(at));
        before = Some(at);
    }
    pixels.dedup();
    pixels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::strokes::arc;
    use core::f64::consts::TAU;

    fn text(picture: &Picture) -> String {
        let image = picture.draw().into_luma8();
        image
            .rows()
            .map(|row| {
                row.map(|pixel| if pixel.0[0] < 128 { '#' } else { '.' }).chain(['\n']).collect::<String>()
            })
            .collect()
    }

    #[test]
    fn a_pen_of_three_covers_a_plus_around_a_dot() {
        let mut picture = Picture::new("dot", (5, 5), Look::Ink, 2.0);
        picture.line(&[(2.0, 2.0)]);
        assert_eq!(text(&picture), ".....\n..#..\n.###.\n..#..\n.....\n");
    }

    #[test]
    fn a_thin_line_has_one_pixel_per_column() {
        let mut picture = Picture::new("line", (7, 4), Look::Ink, 1.0);
        picture.line(&[(0.0, 1.0), (6.0, 2.0)]);
        assert_eq!(text(&picture), ".......\n###....\n...####\n.......\n");
    }

    #[test]
    fn a_thin_circle_is_connected_and_near_the_true_one() {
        for radius in [4.0, 8.3, 20.0, 60.4, 149.9] {
            let pixels = thin(&arc((200.3, 200.7), radius, 0.0, TAU));
            for pair in pixels.windows(2) {
                assert!(libm::fabs(pair[0].0 - pair[1].0).max(libm::fabs(pair[0].1 - pair[1].1)) <= 1.0);
            }
            for (x, y) in pixels {
                let away = libm::fabs(libm::hypot(x - 200.3, y - 200.7) - radius);
                assert!(away <= core::f64::consts::FRAC_1_SQRT_2, "{away} px from radius {radius}");
            }
        }
    }

    #[test]
    fn half_a_pixel_under_a_smooth_line_is_grey() {
        let mut picture = Picture::new("grey", (7, 3), Look::Smooth, 2.0);
        picture.line(&[(-5.0, 1.0), (12.0, 1.0)]);
        let image = picture.draw().into_luma8();
        assert_eq!(image.get_pixel(3, 0).0, [128]);
        assert_eq!(image.get_pixel(3, 1).0, [0]);
    }
}
