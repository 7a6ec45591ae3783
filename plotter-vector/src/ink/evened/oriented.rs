//! [`along_lines`]: darkness along the line through each place, for strokes with gaps and grain.

use super::plane::{Plane, rounded};

/// Directions that are tried, in half a turn.
const DIRECTIONS: u8 = 16;

/// A window along a line: its standard deviations along and across, as parts of the lines' width.
const ALONG: f32 = 0.6;
const ACROSS: f32 = 0.2;

/// Where a window ends, in standard deviations.
const REACH: f32 = 2.2;

/// The mean darkness in a long narrow window, turned so that it is darkest there: along a line it bridges
/// gaps of the grain, and goes over a line's edge and end no farther than it is narrow.
///
/// Asked only where something is darker than `least`, or close to it; what is elsewhere is paper.
pub(super) fn along_lines(darkness: &Plane, width_px: f32, least: f32) -> Plane {
    let windows = windows(width_px);
    let radius = libm::ceilf(REACH * ALONG * width_px).max(1.0);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some pixels")]
    let radius = radius as usize;
    let near = darkness.clone().extreme(radius, false);
    let mut out = Plane::new(darkness.width, darkness.height);
    out.in_rows(|y, row| {
        for (x, (out, near)) in row.iter_mut().zip(near.row(y)).enumerate() {
            if f32::from(*near) < least {
                *out = darkness.row(y).get(x).copied().unwrap_or(0);
                continue;
            }
            let mean = |window: &Vec<(isize, isize, f32)>| -> f32 {
                window.iter().map(|(dx, dy, weight)| weight * f32::from(darkness.near(x, y, *dx, *dy))).sum()
            };
            *out = rounded(windows.iter().map(mean).fold(0.0, f32::max));
        }
    });
    out
}

/// The taps of each window, with weights that are 1 together.
fn windows(width_px: f32) -> Vec<Vec<(isize, isize, f32)>> {
    let (along, across) = ((ALONG * width_px).max(0.6), (ACROSS * width_px).max(0.5));
    #[expect(clippy::cast_possible_truncation, reason = "some pixels")]
    let reach = libm::ceilf(REACH * along) as i16;
    let window = |direction: u8| {
        let (sin, cos) = libm::sincosf(core::f32::consts::PI * f32::from(direction) / f32::from(DIRECTIONS));
        let tap = |x: i16, y: i16| {
            let (x, y) = (f32::from(x), f32::from(y));
            let (u, v) = ((x * cos + y * sin) / along, (y * cos - x * sin) / across);
            (u * u + v * v < REACH * REACH).then(|| libm::expf(-0.5 * (u * u + v * v)))
        };
        let taps: Vec<_> = (-reach..=reach)
            .flat_map(|y| (-reach..=reach).map(move |x| (x, y)))
            .filter_map(|(x, y)| Some((isize::from(x), isize::from(y), tap(x, y)?)))
            .collect();
        let sum: f32 = taps.iter().map(|(_, _, weight)| weight).sum();
        taps.into_iter().map(|(x, y, weight)| (x, y, weight / sum)).collect()
    };
    (0..DIRECTIONS).map(window).collect()
}
