//! The strokes of a picture: lines, circles and curves as dense polylines.

use super::letters;
use core::f64::consts::{PI, TAU};

/// A point, px: x to the right, y down, whole numbers are pixel centres.
pub(crate) type At = (f64, f64);

/// Greatest distance of a curve from the polyline that stands for it, px.
const SAGITTA_PX: f64 = 0.015;

pub(crate) const BLACK: [u8; 3] = [0, 0, 0];

/// One stroke of a round pen.
#[derive(Clone, Debug)]
pub(crate) struct Stroke {
    /// One point is a dot; a closed stroke repeats its first point.
    pub(crate) points: Vec<At>,
    pub(crate) width_px: f64,
    /// A needle: the width falls to nothing at the last point.
    pub(crate) tapers: bool,
    pub(crate) colour: [u8; 3],
}

impl Stroke {
    pub(crate) fn closed(&self) -> bool {
        self.points.len() > 2 && self.points.first() == self.points.last()
    }
}

/// How the strokes get onto the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// Black or white, nothing between.
    Ink,
    /// Grey or mixed where a pixel is covered in part; later strokes cover earlier ones.
    Smooth,
    /// Smooth, on unevenly lit paper, with noise.
    Scan,
}

/// A picture and all that is known about it.
#[derive(Debug)]
pub struct Picture {
    /// Name of the picture and of its files.
    pub name: &'static str,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) look: Look,
    pub(crate) strokes: Vec<Stroke>,
    pen_px: f64,
    colour: [u8; 3],
}

impl Picture {
    pub(crate) fn new(name: &'static str, (width, height): (u32, u32), look: Look, pen_px: f64) -> Self {
        Self { name, width, height, look, strokes: Vec::new(), pen_px, colour: BLACK }
    }

    /// The width of the strokes from here on.
    pub(crate) fn pen(&mut self, width_px: f64) -> &mut Self {
        self.pen_px = width_px;
        self
    }

    /// The colour of the strokes from here on.
    pub(crate) fn ink(&mut self, colour: [u8; 3]) -> &mut Self {
        self.colour = colour;
        self
    }

    /// A stroke through the points, which are rounded to what the truth file says: thousandths of a pixel.
    pub(crate) fn line(&mut self, points: &[At]) {
        let round = |value: f64| libm::round(value * 1000.0) / 1000.0;
        let mut rounded: Vec<At> = points.iter().map(|(x, y)| (round(*x), round(*y))).collect();
        rounded.dedup();
        self.strokes.push(Stroke {
            points: rounded,
            width_px: self.pen_px,
            tapers: false,
            colour: self.colour,
        });
    }

    pub(crate) fn needle(&mut self, base: At, tip: At) {
        self.line(&[base, tip]);
        if let Some(stroke) = self.strokes.last_mut() {
            stroke.tapers = true;
        }
    }

    pub(crate) fn rectangle(&mut self, (left, top): At, (right, bottom): At) {
        self.line(&[(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]);
    }

    pub(crate) fn circle(&mut self, centre: At, radius: f64) {
        let mut points = arc(centre, radius, 0.0, TAU);
        // Sine and cosine of a full turn miss the start by a rounding error.
        if let (Some(first), Some(last)) = (points.first().copied(), points.last_mut()) {
            *last = first;
        }
        self.line(&points);
    }

    /// Straight strokes from a centre to all sides, at angles in degrees.
    pub(crate) fn rays(&mut self, centre: At, length: f64, degrees: &[f64]) {
        for angle in degrees {
            self.line(&[centre, polar(centre, length, angle.to_radians())]);
        }
    }

    /// A straight stroke through a centre.
    pub(crate) fn through(&mut self, centre: At, half: f64, degrees: f64) {
        let angle = degrees.to_radians();
        self.line(&[polar(centre, -half, angle), polar(centre, half, angle)]);
    }

    /// Single-line lettering of the given height, from the upper left corner, turned by an angle.
    pub(crate) fn text(&mut self, at: At, height: f64, angle_rad: f64, words: &str) {
        for stroke in letters::strokes(words) {
            let scale = height / letters::HEIGHT;
            let points: Vec<At> =
                stroke.iter().map(|(x, y)| turned((x * scale, y * scale), angle_rad, at)).collect();
            self.line(&points);
        }
    }

    /// Dashes of the given lengths in turn with gaps between.
    pub(crate) fn dashed(&mut self, from: At, to: At, dashes: &[f64], gap: f64) {
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let at = |s: f64| (from.0 + (to.0 - from.0) * s / length, from.1 + (to.1 - from.1) * s / length);
        let mut start = 0.0;
        for dash in dashes.iter().cycle() {
            if start >= length - 1.0 {
                break;
            }
            self.line(&[at(start), at((start + dash).min(length))]);
            start += dash + gap;
        }
    }
}

pub(crate) fn polar(centre: At, radius: f64, angle_rad: f64) -> At {
    (centre.0 + radius * libm::cos(angle_rad), centre.1 + radius * libm::sin(angle_rad))
}

/// The point turned about the origin and then moved.
pub(crate) fn turned((x, y): At, angle_rad: f64, to: At) -> At {
    let (sin, cos) = libm::sincos(angle_rad);
    (to.0 + x * cos - y * sin, to.1 + x * sin + y * cos)
}

/// An arc from one angle to the other, in whichever direction that is.
pub(crate) fn arc(centre: At, radius: f64, from_rad: f64, to_rad: f64) -> Vec<At> {
    // The sagitta of a chord over the angle 2h is r (1 - cos h).
    let half = libm::acos((1.0 - SAGITTA_PX / radius).max(0.0)).min(PI / 8.0);
    let pieces = libm::ceil(libm::fabs(to_rad - from_rad) / (2.0 * half));
    let mut points = vec![polar(centre, radius, from_rad)];
    let mut piece = 1.0;
    while piece <= pieces {
        points.push(polar(centre, radius, from_rad + (to_rad - from_rad) * piece / pieces));
        piece += 1.0;
    }
    points
}

/// A curve over the parameter, halved until no chord is farther than [`SAGITTA_PX`] from the curve's middle.
pub(crate) fn curve(from: f64, to: f64, at: impl Fn(f64) -> At) -> Vec<At> {
    const FIRST: u32 = 256;
    let mut points = vec![at(from)];
    for piece in 0..FIRST {
        let (a, b) = (f64::from(piece) / f64::from(FIRST), f64::from(piece + 1) / f64::from(FIRST));
        refine(from + (to - from) * a, from + (to - from) * b, 12, &at, &mut points);
    }
    points
}

fn refine(from: f64, to: f64, depth: u32, at: &impl Fn(f64) -> At, points: &mut Vec<At>) {
    let (a, b, middle) = (at(from), at(to), at(f64::midpoint(from, to)));
    let away = libm::hypot(middle.0 - f64::midpoint(a.0, b.0), middle.1 - f64::midpoint(a.1, b.1));
    if away < SAGITTA_PX || depth == 0 {
        points.push(b);
    } else {
        refine(from, f64::midpoint(from, to), depth - 1, at, points);
        refine(f64::midpoint(from, to), to, depth - 1, at, points);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chords_of_a_circle_stay_within_a_fiftieth_of_a_pixel() {
        for radius in [3.0, 8.3, 60.4, 200.7] {
            let points = arc((0.0, 0.0), radius, 0.0, TAU);
            for pair in points.windows(2) {
                let (x, y) = (f64::midpoint(pair[0].0, pair[1].0), f64::midpoint(pair[0].1, pair[1].1));
                assert!(radius - libm::hypot(x, y) < 0.02, "radius {radius}");
            }
        }
    }
}
