//! Shapes filled with parallel lines, some crosswise.

use super::sheet;
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::{At, arc, polar};
use core::f64::consts::{FRAC_PI_2, TAU};

pub(super) fn hatching(random: &mut Random) -> Picture {
    let (thin, broad) = (random.between(2.0, 3.2), random.between(3.0, 5.0));
    let mut picture = sheet("hatching", broad);
    for row in 0..3 {
        for column in 0..2 {
            let centre = (
                270.0 + 460.0 * f64::from(column) + random.between(-15.0, 15.0),
                250.0 + 450.0 * f64::from(row) + random.between(-15.0, 15.0),
            );
            let radius = random.between(165.0, 205.0);
            let mut outline = match random.below(5) {
                0 => arc(centre, radius, 0.0, TAU),
                1 => polygon(centre, radius, 3, random),
                2 => polygon(centre, radius, 4, random),
                3 => polygon(centre, radius, 5, random),
                _ => polygon(centre, radius, 6, random),
            };
            if let (Some(first), Some(last)) = (outline.first().copied(), outline.last_mut()) {
                *last = first;
            }
            picture.pen(broad).line(&outline);
            picture.pen(thin);
            let pitch = random.between(16.0, 28.0);
            let angle = random.between(0.0, TAU / 2.0);
            fill(&outline, centre, pitch, angle, &mut picture);
            if random.chance(0.4) {
                let across = angle + random.between(0.7, 1.0) * FRAC_PI_2;
                fill(&outline, centre, 1.4 * pitch, across, &mut picture);
            }
        }
    }
    picture
}

fn polygon(centre: At, radius: f64, corners: u32, random: &mut Random) -> Vec<At> {
    let start = random.between(0.0, TAU);
    (0..=corners)
        .map(|corner| polar(centre, radius, start + TAU * f64::from(corner) / f64::from(corners)))
        .collect()
}

/// Lines at an angle between the two sides of a convex outline.
fn fill(outline: &[At], centre: At, pitch: f64, angle: f64, picture: &mut Picture) {
    let (sin, cos) = libm::sincos(angle);
    // Along and across the lines, from the centre.
    let turned = |(x, y): At| {
        let (x, y) = (x - centre.0, y - centre.1);
        (x * cos + y * sin, y * cos - x * sin)
    };
    let turned: Vec<At> = outline.iter().map(|at| turned(*at)).collect();
    let reach = turned.iter().map(|(_, across)| *across).fold(0.0, f64::max);
    let mut across = -pitch * libm::floor(2.0 * reach / pitch) - 0.37 * pitch;
    while across < reach {
        let crossing = |pair: &[At]| {
            let ((along, from), (end, to)) = (pair[0], pair[1]);
            let share = (across - from) / (to - from);
            (0.0..1.0).contains(&share).then_some(along + (end - along) * share)
        };
        let mut ends: Vec<f64> = turned.windows(2).filter_map(crossing).collect();
        ends.sort_by(f64::total_cmp);
        if let [from, to] = ends.as_slice()
            && to - from > 24.0
        {
            let place =
                |along: f64| (centre.0 + along * cos - across * sin, centre.1 + along * sin + across * cos);
            // Beside a parallel edge it would be one line with that.
            let middle = place(f64::midpoint(*from, *to));
            if outline.windows(2).all(|edge| far(middle, (edge[0], edge[1])) > 0.4 * pitch) {
                picture.line(&[place(*from), place(*to)]);
            }
        }
        across += pitch;
    }
}

/// Distance from a straight piece.
fn far(at: At, (from, to): (At, At)) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let along = (at.0 - from.0) * dx + (at.1 - from.1) * dy;
    let share = (along / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    libm::hypot(at.0 - from.0 - share * dx, at.1 - from.1 - share * dy)
}
