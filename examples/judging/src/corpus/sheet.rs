//! A technical sheet of any size, drawn row by row.
//!
//! Every row of pixels is made from the few lines and circles that cross it, so that two thousand million
//! pixels need no more memory than one row. A line of a round pen is convex: it covers one run of pixels in a
//! row.

use super::letters;
use super::random::Random;
use clap::ValueEnum;
use core::f64::consts::{FRAC_PI_4, TAU};
use std::io::{self, Write};

/// Size of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Size {
    /// 210 x 297 mm
    A4,
    /// 594 x 841 mm
    A1,
    /// 841 x 1189 mm
    A0,
}

/// Pens after ISO 128: outlines, dimensions and centre lines, hatching, lettering, mm.
const OUTLINE_MM: f64 = 0.42;
const EDGE_MM: f64 = 0.35;
const LETTER_MM: f64 = 0.25;
const THIN_MM: f64 = 0.18;

/// Lightness of paper and ink of the grey sheet, and the standard deviation of its noise.
const PAPER: f64 = 232.0;
const INK: f64 = 48.0;
const NOISE: f64 = 6.0;

/// A stroke in pixels; whole numbers are pixel centres.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Line { from: (f64, f64), to: (f64, f64), radius: f64 },
    Ring { centre: (f64, f64), inner: f64, outer: f64 },
}

/// A technical sheet of any size.
#[derive(Debug)]
pub struct Sheet {
    width: u32,
    height: u32,
    px_per_mm: f64,
    /// The topmost first.
    shapes: Vec<Shape>,
}

impl Shape {
    fn rows(&self) -> (f64, f64) {
        match self {
            Self::Line { from, to, radius } => (from.1.min(to.1) - radius, from.1.max(to.1) + radius),
            Self::Ring { centre, outer, .. } => (centre.1 - outer, centre.1 + outer),
        }
    }

    /// Where the shape covers the level `y`, from left to right.
    fn runs(&self, y: f64) -> [Option<(f64, f64)>; 2] {
        match *self {
            Self::Ring { centre, inner, outer } => {
                let half = |radius: f64| {
                    let square = radius * radius - (y - centre.1) * (y - centre.1);
                    (square >= 0.0).then(|| libm::sqrt(square))
                };
                match (half(outer), half(inner)) {
                    (Some(wide), Some(hole)) => {
                        [Some((centre.0 - wide, centre.0 - hole)), Some((centre.0 + hole, centre.0 + wide))]
                    }
                    (Some(wide), None) => [Some((centre.0 - wide, centre.0 + wide)), None],
                    (None, _) => [None, None],
                }
            }
            Self::Line { from, to, radius } => {
                let mut run: Option<(f64, f64)> = None;
                let mut add = |a: f64, b: f64| {
                    run = Some(run.map_or((a, b), |(left, right)| (left.min(a), right.max(b))));
                };
                for end in [from, to] {
                    let square = radius * radius - (y - end.1) * (y - end.1);
                    if square >= 0.0 {
                        let half = libm::sqrt(square);
                        add(end.0 - half, end.0 + half);
                    }
                }
                // Between the round ends: the two long sides of a rectangle.
                let length = libm::hypot(to.0 - from.0, to.1 - from.1);
                if length > 0.0 && from.1 != to.1 {
                    let across = (-(to.1 - from.1) * radius / length, (to.0 - from.0) * radius / length);
                    for side in [-1.0, 1.0] {
                        let start = (from.0 + side * across.0, from.1 + side * across.1);
                        let share = (y - start.1) / (to.1 - from.1);
                        if (0.0..=1.0).contains(&share) {
                            let x = start.0 + share * (to.0 - from.0);
                            add(x, x);
                        }
                    }
                } else if libm::fabs(y - from.1) <= radius {
                    add(from.0.min(to.0), from.0.max(to.0));
                }
                [run, None]
            }
        }
    }
}

impl Sheet {
    /// One of this size at so many pixels an inch.
    #[must_use]
    pub fn new(size: Size, dpi: u32) -> Self {
        let (width_mm, height_mm) = match size {
            Size::A4 => (210.0, 297.0),
            Size::A1 => (594.0, 841.0),
            Size::A0 => (841.0, 1189.0),
        };
        let px_per_mm = f64::from(dpi) / 25.4;
        let mut sheet = Self {
            width: whole(width_mm * px_per_mm),
            height: whole(height_mm * px_per_mm),
            px_per_mm,
            shapes: Vec::new(),
        };
        sheet.furnish(width_mm, height_mm);
        sheet.shapes.sort_by(|a, b| a.rows().0.total_cmp(&b.rows().0));
        sheet
    }

    /// Black and white, 8 pixels a byte.
    pub fn write_pbm(&self, out: &mut impl Write) -> io::Result<()> {
        write!(out, "P4\n{} {}\n", self.width, self.height)?;
        let mut row = vec![0_u8; usize::try_from(self.width.div_ceil(8)).unwrap_or(0)];
        let mut active = Active::default();
        for y in 0..self.height {
            row.fill(0);
            let y = f64::from(y);
            for shape in active.at(&self.shapes, y, y) {
                for (left, right) in shape.runs(y).into_iter().flatten() {
                    // Pixel centres within the run.
                    blacken(&mut row, start(left, self.width), start(libm::floor(right) + 1.0, self.width));
                }
            }
            out.write_all(&row)?;
        }
        Ok(())
    }

    /// Grey with smooth edges and the noise of paper.
    pub fn write_pgm(&self, out: &mut impl Write) -> io::Result<()> {
        /// Levels within one row on which the cover of its pixels is measured.
        const LEVELS: u32 = 4;
        write!(out, "P5\n{} {}\n255\n", self.width, self.height)?;
        let mut random = Random::new(1);
        let noise: Vec<f32> = (0..4096).map(|_| narrow(NOISE * random.normal())).collect();
        let size = usize::try_from(self.width).unwrap_or(0);
        let mut cover = vec![0.0_f32; size];
        let mut row = vec![0_u8; size];
        let mut active = Active::default();
        for y in 0..self.height {
            cover.fill(0.0);
            let y = f64::from(y);
            for shape in active.at(&self.shapes, y - 0.5, y + 0.5) {
                for level in 0..LEVELS {
                    let level = y + (f64::from(level) + 0.5) / f64::from(LEVELS) - 0.5;
                    for (left, right) in shape.runs(level).into_iter().flatten() {
                        shade(
                            &mut cover,
                            self.width,
                            left + 0.5,
                            right + 0.5,
                            1.0 / narrow(f64::from(LEVELS)),
                        );
                    }
                }
            }
            for (pixels, covers) in row.chunks_mut(5).zip(cover.chunks(5)) {
                // Five numbers of 12 bits from one of 64.
                let mut bits = random.bits();
                for (pixel, cover) in pixels.iter_mut().zip(covers) {
                    let place = usize::try_from(bits & 4095).unwrap_or(0);
                    bits >>= 12;
                    let light = narrow(PAPER) - narrow(PAPER - INK) * cover.min(1.0);
                    #[expect(
                        clippy::cast_possible_truncation,
                        clippy::cast_sign_loss,
                        reason = "clamped to 0..=255"
                    )]
                    let value =
                        (light + noise.get(place).copied().unwrap_or(0.0) + 0.5).clamp(0.0, 255.0) as u8;
                    *pixel = value;
                }
            }
            out.write_all(&row)?;
        }
        Ok(())
    }
}

/// The shapes that reach into the current row.
#[derive(Debug, Default)]
struct Active {
    next: usize,
    shapes: Vec<Shape>,
}

impl Active {
    fn at(&mut self, all: &[Shape], top: f64, bottom: f64) -> &[Shape] {
        self.shapes.retain(|shape| shape.rows().1 >= top);
        while let Some(shape) = all.get(self.next).filter(|shape| shape.rows().0 <= bottom) {
            self.shapes.push(*shape);
            self.next += 1;
        }
        &self.shapes
    }
}

fn narrow(value: f64) -> f32 {
    #[expect(clippy::cast_possible_truncation, reason = "lightness needs no more than 24 bits")]
    let value = value as f32;
    value
}

/// To the nearest whole pixel.
fn whole(value: f64) -> u32 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and below 2^31")]
    let value = libm::round(value).clamp(0.0, 2_147_483_647.0) as u32;
    value
}

/// The first pixel whose centre does not lie left of `x`.
fn start(x: f64, width: u32) -> u32 {
    whole(libm::ceil(x).clamp(0.0, f64::from(width)))
}

/// Sets the pixels from one to before the other; the leftmost of a byte is its highest bit.
fn blacken(row: &mut [u8], from: u32, to: u32) {
    let byte = |pixel: u32| usize::try_from(pixel / 8).unwrap_or(usize::MAX);
    if from >= to {
        return;
    }
    let (first, last) = (byte(from), byte(to - 1));
    let (head, tail) = (0xFF_u8 >> (from % 8), 0xFF_u8 << (7 - (to - 1) % 8));
    if first == last {
        if let Some(bits) = row.get_mut(first) {
            *bits |= head & tail;
        }
        return;
    }
    if let Some(run) = row.get_mut(first..=last)
        && let [begin, middle @ .., end] = run
    {
        *begin |= head;
        middle.fill(0xFF);
        *end |= tail;
    }
}

/// Adds to each pixel the share of its breadth that lies between left and right; pixel 0 begins at 0.
fn shade(cover: &mut [f32], width: u32, left: f64, right: f64, weight: f32) {
    let (left, right) = (left.max(0.0), right.min(f64::from(width)));
    if left >= right {
        return;
    }
    let (first, last) = (whole(libm::floor(left)), start(right, width));
    let range = usize::try_from(first).unwrap_or(0)..usize::try_from(last).unwrap_or(0);
    let Some(run) = cover.get_mut(range) else { return };
    let inside = run.len();
    for (place, pixel) in run.iter_mut().enumerate() {
        let edge = place == 0 || place + 1 == inside;
        let share = if edge {
            let x = f64::from(first) + if place == 0 { 0.0 } else { f64::from(last - first - 1) };
            narrow(right.min(x + 1.0) - left.max(x))
        } else {
            1.0
        };
        *pixel += share * weight;
    }
}

/// What is on the sheet, in mm.
impl Sheet {
    fn line(&mut self, pen_mm: f64, from: (f64, f64), to: (f64, f64)) {
        let px = |(x, y): (f64, f64)| (x * self.px_per_mm - 0.5, y * self.px_per_mm - 0.5);
        let radius = pen_mm * self.px_per_mm / 2.0;
        self.shapes.push(Shape::Line { from: px(from), to: px(to), radius });
    }

    fn lines(&mut self, pen_mm: f64, points: &[(f64, f64)]) {
        for pair in points.windows(2) {
            self.line(pen_mm, pair[0], pair[1]);
        }
    }

    fn rectangle(&mut self, pen_mm: f64, (left, top): (f64, f64), (right, bottom): (f64, f64)) {
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        self.lines(pen_mm, &corners);
    }

    fn circle(&mut self, pen_mm: f64, (x, y): (f64, f64), radius_mm: f64) {
        let scale = self.px_per_mm;
        self.shapes.push(Shape::Ring {
            centre: (x * scale - 0.5, y * scale - 0.5),
            inner: (radius_mm - pen_mm / 2.0) * scale,
            outer: (radius_mm + pen_mm / 2.0) * scale,
        });
    }

    fn dashed(&mut self, from: (f64, f64), to: (f64, f64)) {
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let at = |s: f64| (from.0 + (to.0 - from.0) * s / length, from.1 + (to.1 - from.1) * s / length);
        let mut s = 0.0;
        for dash in [6.0, 0.8].iter().cycle() {
            if s >= length {
                break;
            }
            self.line(THIN_MM, at(s), at((s + dash).min(length)));
            s += dash + 1.0;
        }
    }

    fn text(&mut self, at: (f64, f64), height_mm: f64, words: &str) {
        let scale = height_mm / letters::HEIGHT;
        for stroke in letters::strokes(words) {
            let points: Vec<(f64, f64)> =
                stroke.iter().map(|(x, y)| (at.0 + x * scale, at.1 + y * scale)).collect();
            match points.as_slice() {
                [dot] => self.line(LETTER_MM, *dot, *dot),
                points => self.lines(LETTER_MM, points),
            }
        }
    }

    /// A level dimension with open arrow heads.
    fn dimension(&mut self, from: (f64, f64), to: (f64, f64), y: f64, label: &str) {
        for (x, top) in [from, to] {
            self.line(THIN_MM, (x, top + 1.0), (x, y + 1.5));
        }
        self.line(THIN_MM, (from.0, y), (to.0, y));
        for (tip, way) in [(from.0, 1.0), (to.0, -1.0)] {
            self.lines(THIN_MM, &[(tip + way * 3.0, y - 0.8), (tip, y), (tip + way * 3.0, y + 0.8)]);
        }
        let width = letters::width(label, 2.5);
        self.text((f64::midpoint(from.0, to.0) - width / 2.0, y - 3.6), 2.5, label);
    }

    /// The frame, and in it fields of 92 x 88 mm, each with one of five drawings.
    fn furnish(&mut self, width_mm: f64, height_mm: f64) {
        const FIELD_MM: (f64, f64) = (92.0, 88.0);
        self.rectangle(THIN_MM, (5.0, 5.0), (width_mm - 5.0, height_mm - 5.0));
        self.rectangle(OUTLINE_MM, (10.0, 10.0), (width_mm - 10.0, height_mm - 10.0));
        let mut number = 0_u32;
        let mut top = 13.0;
        while top + FIELD_MM.1 <= height_mm - 10.0 {
            let mut left = 13.0;
            while left + FIELD_MM.0 <= width_mm - 10.0 {
                match number % 5 {
                    0 => self.flange(left, top),
                    1 => self.cut(left, top),
                    2 => self.table(left, top),
                    3 => self.scale(left, top),
                    _ => self.graph(left, top),
                }
                self.text((left + 4.0, top + 4.0), 3.5, &format!("FIG. {}", number + 1));
                number += 1;
                left += FIELD_MM.0 + 3.0;
            }
            top += FIELD_MM.1 + 2.0;
        }
    }

    /// A plate with bores and their centre lines.
    fn flange(&mut self, left: f64, top: f64) {
        let centre = (left + 46.0, top + 44.0);
        self.rectangle(OUTLINE_MM, (left + 12.0, top + 10.0), (left + 80.0, top + 78.0));
        for radius in [30.0, 24.0, 16.0, 12.0, 7.0] {
            self.circle(EDGE_MM, centre, radius);
        }
        for bolt in 0..12 {
            let angle = TAU * f64::from(bolt) / 12.0 + 0.1;
            let at = (centre.0 + 27.0 * libm::cos(angle), centre.1 + 27.0 * libm::sin(angle));
            self.circle(EDGE_MM, at, 1.8);
            self.line(THIN_MM, (at.0 - 2.6, at.1), (at.0 + 2.6, at.1));
            self.line(THIN_MM, (at.0, at.1 - 2.6), (at.0, at.1 + 2.6));
        }
        for corner in [(18.0, 16.0), (74.0, 16.0), (18.0, 72.0), (74.0, 72.0)] {
            self.circle(EDGE_MM, (left + corner.0, top + corner.1), 3.0);
        }
        self.dashed((centre.0 - 38.0, centre.1), (centre.0 + 38.0, centre.1));
        self.dashed((centre.0, centre.1 - 38.0), (centre.0, centre.1 + 38.0));
        self.dimension((left + 12.0, top + 78.0), (left + 80.0, top + 78.0), top + 86.0, "68.0");
    }

    /// A section with hatching.
    fn cut(&mut self, left: f64, top: f64) {
        let (x, y) = (left + 10.0, top + 12.0);
        for (from, to) in [((0.0, 0.0), (72.0, 22.0)), ((0.0, 44.0), (72.0, 66.0))] {
            self.rectangle(OUTLINE_MM, (x + from.0, y + from.1), (x + to.0, y + to.1));
            let mut at = from.0 + 0.9;
            while at + 22.0 <= to.0 {
                self.line(THIN_MM, (x + at, y + to.1), (x + at + 22.0, y + from.1));
                at += 2.2;
            }
        }
        self.line(EDGE_MM, (x, y + 22.0), (x, y + 44.0));
        self.line(EDGE_MM, (x + 72.0, y + 22.0), (x + 72.0, y + 44.0));
        self.dashed((x - 6.0, y + 33.0), (x + 78.0, y + 33.0));
        self.dimension((x, y + 66.0), (x + 72.0, y + 66.0), y + 75.0, "72");
    }

    /// A ruled list of parts.
    fn table(&mut self, left: f64, top: f64) {
        self.rectangle(EDGE_MM, (left + 3.0, top + 10.0), (left + 89.0, top + 88.0));
        for row in 1..13 {
            let y = top + 10.0 + 6.0 * f64::from(row);
            self.line(THIN_MM, (left + 3.0, y), (left + 89.0, y));
        }
        for x in [13.0, 51.0, 70.0] {
            self.line(THIN_MM, (left + x, top + 10.0), (left + x, top + 88.0));
        }
        for row in 0..13_u32 {
            let y = top + 11.8 + 6.0 * f64::from(row);
            self.text((left + 5.0, y), 2.5, &format!("{}", row + 1));
            self.text((left + 15.0, y), 2.5, "HEX BOLT M8X40");
            self.text((left + 53.0, y), 2.5, "8.8-ZN");
            self.text((left + 72.0, y), 2.5, &format!("{}", 4 * row + 2));
        }
    }

    /// A dial with 120 marks and spokes.
    fn scale(&mut self, left: f64, top: f64) {
        let centre = (left + 46.0, top + 48.0);
        for radius in [38.0, 34.0, 8.0, 3.0] {
            self.circle(EDGE_MM, centre, radius);
        }
        for mark in 0..120_u32 {
            let (sin, cos) = libm::sincos(TAU * f64::from(mark) / 120.0);
            let inner = if mark % 10 == 0 { 28.0 } else { 34.0 };
            let pen = if mark % 10 == 0 { EDGE_MM } else { THIN_MM };
            self.line(
                pen,
                (centre.0 + inner * cos, centre.1 + inner * sin),
                (centre.0 + 38.0 * cos, centre.1 + 38.0 * sin),
            );
        }
        for spoke in 0..24 {
            let (sin, cos) = libm::sincos(TAU * f64::from(spoke) / 24.0 + 0.06);
            self.line(
                LETTER_MM,
                (centre.0 + 8.0 * cos, centre.1 + 8.0 * sin),
                (centre.0 + 26.0 * cos, centre.1 + 26.0 * sin),
            );
        }
    }

    /// Curves on squared paper that lies askew.
    fn graph(&mut self, left: f64, top: f64) {
        let (sin, cos) = libm::sincos(0.012);
        let at = |x: f64, y: f64| (left + 7.0 + x * cos - y * sin, top + 12.0 + x * sin + y * cos);
        for line in 0..=12 {
            let s = 6.0 * f64::from(line);
            let pen = if line % 3 == 0 { LETTER_MM } else { THIN_MM };
            self.line(pen, at(s, 0.0), at(s, 72.0));
            self.line(pen, at(0.0, s), at(72.0, s));
        }
        for wave in 1..4 {
            let height =
                |x: f64| 36.0 - 9.0 * f64::from(wave) * libm::sin(x * FRAC_PI_4 / f64::from(4 + wave));
            let points: Vec<(f64, f64)> =
                (0..=288).map(|k| f64::from(k) / 4.0).map(|x| at(x, height(x))).collect();
            self.lines(OUTLINE_MM, &points);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_line_covers_its_length_and_half_the_pen_at_both_ends() {
        let line = Shape::Line { from: (10.0, 5.0), to: (20.0, 5.0), radius: 2.0 };
        assert_eq!(line.runs(5.0), [Some((8.0, 22.0)), None]);
        assert_eq!(line.runs(7.0), [Some((10.0, 20.0)), None]);
        assert_eq!(line.runs(7.1), [None, None]);
    }

    #[test]
    fn a_slanted_line_covers_what_its_slope_says() {
        // At 45 degrees a row cuts the pen of 2 in 2 sqrt 2.
        let line = Shape::Line { from: (0.0, 0.0), to: (20.0, 20.0), radius: 1.0 };
        let [Some((left, right)), None] = line.runs(10.0) else { panic!("one run") };
        assert!((right - left - 8.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn a_run_of_bits_begins_at_the_highest() {
        let mut row = [0_u8; 4];
        blacken(&mut row, 6, 18);
        assert_eq!(row, [0b0000_0011, 0xFF, 0b1100_0000, 0]);
        blacken(&mut row, 25, 27);
        assert_eq!(row[3], 0b0110_0000);
    }

    #[test]
    fn cover_is_shared_between_the_pixels_of_an_edge() {
        let mut cover = [0.0; 4];
        shade(&mut cover, 4, 0.75, 2.5, 1.0);
        assert_eq!(cover, [0.25, 1.0, 0.5, 0.0]);
    }

    #[test]
    fn a_sheet_of_600_dots_per_inch_has_the_pixels_of_the_paper() {
        let sheet = Sheet::new(Size::A4, 600);
        assert_eq!((sheet.width, sheet.height), (4961, 7016));
    }

    #[test]
    fn a_run_covers_the_pixels_whose_centres_it_holds() {
        let shapes = vec![Shape::Line { from: (2.0, 0.0), to: (4.2, 0.0), radius: 0.5 }];
        let sheet = Sheet { width: 8, height: 1, px_per_mm: 1.0, shapes };
        let mut file = Vec::new();
        sheet.write_pbm(&mut file).unwrap();
        // From 1.5 to 4.7.
        assert_eq!(file, b"P4\n8 1\n\x38");
    }

    #[test]
    fn a_twentieth_of_the_sheet_is_ink() {
        let mut file = Vec::new();
        Sheet::new(Size::A4, 150).write_pbm(&mut file).unwrap();
        let ink: u32 = file["P4\n1240 1754\n".len()..].iter().map(|byte| byte.count_ones()).sum();
        let share = f64::from(ink) / (1240.0 * 1754.0);
        assert!((0.03..0.07).contains(&share), "{share}");
    }
}
