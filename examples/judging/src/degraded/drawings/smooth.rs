//! Smooth curves through given points.

use crate::corpus::random::Random;
use crate::corpus::strokes::{At, curve, polar};
use core::f64::consts::TAU;

/// A curve through the points in turn (Catmull and Rom 1974, uniform).
pub(super) fn through(points: &[At]) -> Vec<At> {
    let last = points.len().saturating_sub(1);
    let point = |index: usize| points.get(index.min(last)).copied().unwrap_or((0.0, 0.0));
    let at = |place: f64| {
        let whole = libm::floor(place.clamp(0.0, (last as f64 - 1.0).max(0.0)));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "whole and within the list"
        )]
        let index = whole as usize;
        let t = place - whole;
        let [a, b, c, d] = [point(index.saturating_sub(1)), point(index), point(index + 1), point(index + 2)];
        let spline = |a: f64, b: f64, c: f64, d: f64| {
            0.5 * (2.0 * b
                + t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a))))
        };
        (spline(a.0, b.0, c.0, d.0), spline(a.1, b.1, c.1, d.1))
    };
    curve(0.0, last as f64, at)
}

/// A closed line around a centre whose radius swings a little.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blob {
    centre: At,
    radii: At,
    /// Height and start of the swings, two, three and five to a turn.
    swings: [(f64, f64, f64); 3],
}

impl Blob {
    /// `swing` is about the greatest change of the radius, as a share of it.
    pub(super) fn new(centre: At, radii: At, swing: f64, random: &mut Random) -> Self {
        let swings = [2.0, 3.0, 5.0]
            .map(|count| (count, swing * random.between(0.3, 1.0) / count, random.between(0.0, TAU)));
        Self { centre, radii, swings }
    }

    /// The outline, `share` times as large.
    pub(super) fn outline(&self, share: f64) -> Vec<At> {
        let mut points = curve(0.0, TAU, |angle| self.at(share, angle));
        if let (Some(first), Some(last)) = (points.first().copied(), points.last_mut()) {
            *last = first;
        }
        points
    }

    /// The place of the outline at an angle.
    pub(super) fn at(&self, share: f64, angle: f64) -> At {
        let swing: f64 =
            self.swings.iter().map(|(count, high, start)| high * libm::cos(count * angle + start)).sum();
        let (x, y) = polar((0.0, 0.0), share * (1.0 + swing), angle);
        (self.centre.0 + x * self.radii.0, self.centre.1 + y * self.radii.1)
    }
}
