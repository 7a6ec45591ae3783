//! Systems of notes, all of them as open strokes.

use super::sheet;
use super::smooth::through;
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::{At, curve, turned};
use core::f64::consts::TAU;

pub(super) fn music(random: &mut Random) -> Picture {
    let (thin, broad) = (random.between(2.0, 3.0), random.between(2.6, 4.0));
    let mut picture = sheet("music", thin);
    let space = random.between(25.0, 30.0);
    let (left, right) = (random.between(50.0, 80.0), random.between(910.0, 950.0));
    let mut top = random.between(120.0, 150.0);
    while top + 6.5 * space < 1390.0 {
        picture.pen(thin);
        for line in 0..5 {
            let y = top + space * f64::from(line);
            picture.line(&[(left, y), (right, y)]);
        }
        let bars = 2 + random.below(2);
        let start = left + 110.0;
        for bar in 0..=bars {
            let x = if bar == 0 { left } else { start + (right - start) * f64::from(bar) / f64::from(bars) };
            picture.line(&[(x, top), (x, top + 4.0 * space)]);
        }
        picture.pen(broad);
        clef((left + 50.0, top + 3.0 * space), space, &mut picture);
        for bar in 0..bars {
            let wide = (right - start) / f64::from(bars);
            let notes = 2 + random.below(2);
            for note in 0..notes {
                let x = start + wide * f64::from(bar) + wide * (f64::from(note) + 0.5) / f64::from(notes);
                one_note(x, top, space, random, &mut picture);
            }
        }
        top += 4.0 * space + random.between(4.2, 5.4) * space;
    }
    picture
}

/// A clef: a curl about the second line from below, and a loop up and down through it.
fn clef((x, y): At, space: f64, picture: &mut Picture) {
    let points = [
        (0.0, 0.5),
        (-0.75, 0.0),
        (0.0, -0.72),
        (0.85, 0.1),
        (0.1, 1.0),
        (-1.25, 0.1),
        (-0.4, -1.7),
        (0.6, -3.2),
        (0.35, -4.1),
        (-0.2, -3.0),
        (0.15, -0.4),
        (0.3, 1.5),
        (-0.2, 2.15),
        (-0.75, 1.8),
    ];
    picture.line(&through(&points.map(|(px, py)| (x + px * space, y + py * space))));
}

fn one_note(x: f64, top: f64, space: f64, random: &mut Random, picture: &mut Picture) {
    // In half spaces from the uppermost line.
    let step = 1 + random.below(7);
    let y = top + space * f64::from(step) / 2.0;
    // Between two lines a head stays clear of both.
    let high = if step % 2 == 1 { 0.27 } else { 0.4 } * space;
    let wide = 0.56 * space;
    let lean = random.between(-0.3, -0.15);
    let mut head =
        curve(0.0, TAU, |angle| turned((wide * libm::cos(angle), high * libm::sin(angle)), lean, (x, y)));
    if let (Some(first), Some(last)) = (head.first().copied(), head.last_mut()) {
        *last = first;
    }
    picture.line(&head);
    // The stem begins on the head: at its rightmost or leftmost end.
    let up = step > 4;
    let (side, way) = if up { (1.0, -1.0) } else { (-1.0, 1.0) };
    let foot = turned((side * wide, 0.0), lean, (x, y));
    let tip = (foot.0, foot.1 + way * 3.2 * space);
    match random.below(4) {
        0 => {
            let flag = through(&[
                tip,
                (tip.0 + 0.35 * space, tip.1 - way * 0.9 * space),
                (tip.0 + 0.95 * space, tip.1 - way * 1.7 * space),
            ]);
            picture.line(&[&[foot], flag.as_slice()].concat());
        }
        1 => {}
        _ => picture.line(&[foot, tip]),
    }
}
