//! A circuit: parts joined by wires, with their names.

use super::sheet;
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::{At, arc, turned};
use core::f64::consts::PI;

/// Length of a part with its legs, px.
const PART_PX: f64 = 120.0;

pub(super) fn circuit(random: &mut Random) -> Picture {
    let pen = random.between(2.5, 5.0);
    let mut picture = sheet("circuit", pen);
    let columns = 3;
    let rows = 4 + random.below(2);
    let left = random.between(90.0, 130.0);
    let pitch_x = (random.between(860.0, 900.0) - left) / f64::from(columns - 1);
    let top = random.between(110.0, 150.0);
    let pitch_y = (1290.0 - top) / f64::from(rows - 1);
    let node = |column: u32, row: u32| (left + pitch_x * f64::from(column), top + pitch_y * f64::from(row));
    let mut number = 1;
    for row in 0..rows {
        // A wire inside may end at the middle column.
        let inside = row > 0 && row + 1 < rows;
        let (first, last) = match random.below(4) {
            0 if inside => (0, 1),
            1 if inside => (1, 2),
            _ => (0, 2),
        };
        for column in first..last {
            edge(node(column, row), node(column + 1, row), &mut number, random, &mut picture);
        }
    }
    for column in 0..columns {
        for row in 0..rows - 1 {
            // The outer frame is closed; inside some places stay free.
            if column != 1 || random.chance(0.65) {
                edge(node(column, row), node(column, row + 1), &mut number, random, &mut picture);
            }
        }
    }
    picture
}

/// A wire with a part in its middle, or none.
fn edge(from: At, to: At, number: &mut u32, random: &mut Random, picture: &mut Picture) {
    let length = libm::hypot(to.0 - from.0, to.1 - from.1);
    let angle = libm::atan2(to.1 - from.1, to.0 - from.0);
    let half = PART_PX * random.between(0.4, 0.5);
    let middle = length * random.between(0.42, 0.58);
    // x along the wire from the part's middle.
    let place = |x: f64, y: f64| turned((middle + x, y), angle, from);
    let (start, end) = (place(-middle, 0.0), place(length - middle, 0.0));
    let upright = libm::fabs(to.1 - from.1) > libm::fabs(to.0 - from.0);
    let name = match random.below(8) {
        0 | 1 => {
            let tooth = 2.0 * half / 12.0;
            let mut points = vec![start, place(-half, 0.0)];
            for step in 0..6 {
                let side = if step % 2 == 0 { -0.34 } else { 0.34 };
                points.push(place(-half + tooth * (2.0 * f64::from(step) + 1.0), side * half));
            }
            points.extend([place(half, 0.0), end]);
            picture.line(&points);
            "R"
        }
        2 => {
            let radius = half / 4.0;
            let mut points = vec![start];
            for turn in 0..4 {
                let centre = -half + radius * (2.0 * f64::from(turn) + 1.0);
                points.extend(arc((centre, 0.0), radius, PI, 2.0 * PI).iter().map(|(x, y)| place(*x, *y)));
            }
            points.push(end);
            picture.line(&points);
            "L"
        }
        3 => {
            let gap = random.between(10.0, 14.0);
            for (side, far) in [(-1.0, start), (1.0, end)] {
                picture.line(&[far, place(side * gap, 0.0)]);
                picture.line(&[place(side * gap, -0.6 * half), place(side * gap, 0.6 * half)]);
            }
            "C"
        }
        4 => {
            let radius = 0.62 * half;
            picture.line(&[start, place(-radius, 0.0)]);
            picture.line(&[place(radius, 0.0), end]);
            picture.circle(place(0.0, 0.0), radius);
            let (cross, arm) = (0.3 * radius, 0.26 * radius);
            picture.line(&[place(-cross - arm, 0.0), place(-cross + arm, 0.0)]);
            picture.line(&[place(-cross, -arm), place(-cross, arm)]);
            picture.line(&[place(cross + 2.0, -arm), place(cross + 2.0, arm)]);
            "U"
        }
        5 => {
            let size = 0.45 * half;
            picture.line(&[start, place(-size, 0.0)]);
            picture.line(&[place(-size, -size), place(size, 0.0), place(-size, size), place(-size, -size)]);
            picture.line(&[place(size, -size), place(size, size)]);
            picture.line(&[place(size, 0.0), end]);
            "D"
        }
        6 => {
            // A switch, open.
            picture.line(&[start, place(-0.5 * half, 0.0), place(0.45 * half, -0.55 * half)]);
            picture.line(&[place(0.6 * half, 0.0), end]);
            "S"
        }
        _ => {
            picture.line(&[start, end]);
            return;
        }
    };
    let high = random.between(28.0, 34.0);
    let label = format!("{name}{number}");
    let (x, y) = place(0.0, 0.0);
    let at = if upright {
        (x + 0.62 * half + 12.0, y - high / 2.0)
    } else {
        (x - high / 2.0, y + 0.62 * half + 12.0)
    };
    if at.0 + high * 2.4 < 985.0 {
        picture.text(at, high, 0.0, &label);
    }
    *number += 1;
}
