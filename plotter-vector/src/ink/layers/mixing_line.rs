//! [`MixingLine`]: the colours between paper and a pen.

use crate::picture::oklab::OklabTable;
use crate::picture::{Oklab, Rgb};

/// Places on a line where its colour in Oklab is taken; between them it is as good as straight.
const SAMPLES: i32 = 16;
/// How far beyond the pen's own colour the line goes, of its length: ink where the pen went twice is darker.
const BEYOND: f64 = 1.25;

/// A pen whose colour another one's rims have covers less than this share of what that one does, and lies this
/// near to its line, in Oklab: half as far again as a colour that belongs to the line.
const PALER: f64 = 0.75;
const RIM: f64 = 0.09;

/// The colours of a pixel that a pen covers from not at all to wholly: p + s·(c − p) for paper p, pen c and
/// the share s, in encoded sRGB, as drawing programs and scanners' sharpened rims have it.
#[derive(Clone, Debug)]
pub(super) struct MixingLine {
    paper: [i32; 3],
    way: [i32; 3],
    /// Square of the length; at least 1.
    square: i32,
    pen: Rgb,
    /// The colours at 0, 1/16, … to 20/16 of the way.
    samples: Vec<Oklab>,
    /// Whether the pen was found in the middle of lines.
    has_core: bool,
}

impl MixingLine {
    pub(super) fn new(paper: Rgb, pen: Rgb, table: &OklabTable) -> Self {
        let from = paper.0.map(i32::from);
        let way = core::array::from_fn(|i| {
            pen.0.get(i).copied().map_or(0, i32::from) - from.get(i).copied().unwrap_or(0)
        });
        let square = dot(way, way).max(1);
        let sample = |step: i32| {
            let at = |i: usize| {
                let (from, way) = (from.get(i).copied().unwrap_or(0), way.get(i).copied().unwrap_or(0));
                u8::try_from((from + way * step / SAMPLES).clamp(0, 255)).unwrap_or(u8::MAX)
            };
            table.oklab(Rgb(core::array::from_fn(at)))
        };
        let samples = (0..=SAMPLES + SAMPLES / 4).map(sample).collect();
        Self { paper: from, way, square, pen, samples, has_core: false }
    }

    /// The same, of a pen that was found in the middle of lines.
    pub(super) fn with_core(self) -> Self {
        Self { has_core: true, ..self }
    }

    /// The line to another colour of the same pen.
    pub(super) fn moved(&self, paper: Rgb, pen: Rgb, table: &OklabTable) -> Self {
        Self { has_core: self.has_core, ..Self::new(paper, pen, table) }
    }

    /// Whether the pen was found in the middle of lines.
    pub(super) fn has_core(&self) -> bool {
        self.has_core
    }

    /// The pen's colour, where the share is 1.
    pub(super) fn pen(&self) -> Rgb {
        self.pen
    }

    /// The colour of the pen in Oklab.
    pub(super) fn pen_oklab(&self) -> Oklab {
        self.samples.get(SAMPLES as usize).copied().unwrap_or_default()
    }

    /// How far a colour has gone from the paper's in the pen's direction, times [`MixingLine::square`].
    fn along(&self, Rgb(colour): Rgb) -> i32 {
        let [red, green, blue] = colour.map(i32::from);
        dot([red - self.paper[0], green - self.paper[1], blue - self.paper[2]], self.way)
    }

    /// Whether this pen's colour is one that the other leaves where it covers a pixel in part.
    pub(super) fn is_rim_of(&self, other: &Self) -> bool {
        let own = self.pen();
        other.share(own) < PALER && other.distance(own, self.pen_oklab()) <= RIM
    }

    /// Whether the pen covers half or more of a pixel of this colour.
    pub(super) fn covers_half(&self, colour: Rgb) -> bool {
        2 * self.along(colour) >= self.square
    }

    /// The share of a pixel of this colour that the pen covers; below 0 and above 1 for colours beyond the
    /// ends.
    pub(super) fn share(&self, colour: Rgb) -> f64 {
        f64::from(self.along(colour)) / f64::from(self.square)
    }

    /// The share in 255ths, 0..=255, to nearest.
    pub(super) fn share_255(&self, colour: Rgb) -> u8 {
        let share =
            (i64::from(self.along(colour)) * 510 + i64::from(self.square)) / (2 * i64::from(self.square));
        u8::try_from(share.clamp(0, 255)).unwrap_or(u8::MAX)
    }

    /// How much the share can differ between two colours that differ by up to `levels` in each channel.
    pub(super) fn share_step(&self, levels: i32) -> f64 {
        let way: i32 = self.way.iter().map(|way| way.abs()).sum();
        f64::from(levels * way) / f64::from(self.square)
    }

    /// How far a colour lies beside the line, in Oklab. `oklab` is the colour in Oklab.
    pub(super) fn distance(&self, colour: Rgb, oklab: Oklab) -> f64 {
        self.distance_from(self.share(colour), oklab)
    }

    /// How far a colour is from the place of the line where the pen covers this share, in Oklab.
    pub(super) fn distance_from(&self, share: f64, oklab: Oklab) -> f64 {
        let at = share.clamp(0.0, BEYOND) * f64::from(SAMPLES);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0..=20")]
        let index = at as usize;
        let rest = at - f64::from(u32::try_from(index).unwrap_or(0));
        let from = self.samples.get(index).copied().unwrap_or_default();
        let to = self.samples.get(index + 1).copied().unwrap_or(from);
        from.towards(to, rest).distance(oklab)
    }
}

/// The shares of two pens in a pixel, neither below 0, that come nearest to its colour (least squares in
/// encoded sRGB), and the colour that they make with the paper.
pub(super) fn mixture(one: &MixingLine, other: &MixingLine, colour: Rgb) -> ([f64; 2], Rgb) {
    let (aa, bb, ab) = (f64::from(one.square), f64::from(other.square), f64::from(dot(one.way, other.way)));
    let (a, b) = (f64::from(one.along(colour)), f64::from(other.along(colour)));
    let determinant = aa * bb - ab * ab;
    let mut shares = [(a * bb - b * ab) / determinant, (b * aa - a * ab) / determinant];
    // Two pens on one line share nothing; a share below 0 leaves the pixel to the other pen.
    if determinant <= 0.0 || shares[0] < 0.0 {
        shares = [0.0, (b / bb).max(0.0)];
    } else if shares[1] < 0.0 {
        shares = [(a / aa).max(0.0), 0.0];
    }
    let total = shares[0] + shares[1];
    if total > 1.0 {
        shares = shares.map(|share| share / total);
    }
    let at = |i: usize| {
        let [paper, first, second] = [one.paper, one.way, other.way].map(|c| c.get(i).copied().unwrap_or(0));
        let level = f64::from(paper) + f64::from(first) * shares[0] + f64::from(second) * shares[1];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to a byte")]
        let level = libm::round(level.clamp(0.0, 255.0)) as u8;
        level
    };
    (shares, Rgb(core::array::from_fn(at)))
}

fn dot(a: [i32; 3], b: [i32; 3]) -> i32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = Rgb([208, 24, 24]);
    const BLUE: Rgb = Rgb([24, 64, 200]);

    fn line(pen: Rgb) -> MixingLine {
        MixingLine::new(Rgb::WHITE, pen, &OklabTable::new())
    }

    #[test]
    fn half_red_and_half_paper_is_half_covered_and_on_the_line() {
        // (255 + 208) / 2 and (255 + 24) / 2, rounded down: the darker side.
        let pale = Rgb([231, 139, 139]);
        let red = line(RED);
        assert!(red.covers_half(pale) && !red.covers_half(Rgb([232, 140, 140])));
        assert_eq!((red.share_255(pale), red.share_255(RED), red.share_255(Rgb::WHITE)), (128, 255, 0));
        assert!(red.distance(pale, pale.oklab()) < 0.01);
        assert!(line(BLUE).distance(pale, pale.oklab()) > 0.1);
    }

    #[test]
    fn a_pixel_of_two_pens_is_shared_as_it_was_mixed() {
        // A quarter of paper, a half of red, a quarter of blue.
        let mixed: [u8; 3] = core::array::from_fn(|i| {
            u8::try_from((255 + 2 * u32::from(RED.0[i]) + u32::from(BLUE.0[i])) / 4).unwrap()
        });
        let ([red, blue], made) = mixture(&line(RED), &line(BLUE), Rgb(mixed));
        assert!((red - 0.5).abs() < 0.01 && (blue - 0.25).abs() < 0.01, "{red} {blue}");
        assert!(made.oklab().distance(Rgb(mixed).oklab()) < 0.01);
    }

    #[test]
    fn a_pen_of_the_papers_colour_and_two_pens_of_one_colour_are_numbers_still() {
        assert!(line(Rgb::WHITE).share(RED).is_finite());
        let ([a, b], _) = mixture(&line(RED), &line(RED), Rgb::BLACK);
        assert!(a.is_finite() && b.is_finite());
    }
}
