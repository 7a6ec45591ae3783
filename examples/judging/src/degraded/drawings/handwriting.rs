//! Lines of joined script: each word is one stroke with loops above and below.

use super::sheet;
use super::smooth::through;
use crate::corpus::Picture;
use crate::corpus::random::Random;
use crate::corpus::strokes::At;

/// A letter from the line it stands on to that again, in heights of a small letter, y up, and how far it
/// goes. No way is gone twice: hands that lift little make loops of them.
const LETTERS: [(&[At], f64); 8] = [
    // e
    (&[(0.34, 0.32), (0.62, 0.74), (0.42, 1.0), (0.16, 0.62), (0.26, 0.12), (0.58, 0.02)], 0.86),
    // l
    (&[(0.42, 0.6), (0.76, 1.7), (0.56, 2.2), (0.28, 1.7), (0.26, 0.4), (0.5, 0.0)], 0.82),
    // a garland, as u, and an arcade, as n
    (&[(0.3, 0.5), (0.42, 0.98), (0.62, 0.4), (0.82, 0.02), (1.04, 0.4), (1.18, 0.98), (1.36, 0.3)], 1.62),
    (&[(0.22, 0.7), (0.46, 1.0), (0.62, 0.5), (0.78, 0.06), (0.98, 0.62), (1.2, 1.0), (1.38, 0.4)], 1.66),
    // g with its loop below
    (
        &[(0.3, 0.62), (0.58, 0.96), (0.68, 0.2), (0.54, -0.84), (0.26, -1.1), (0.12, -0.72), (0.5, -0.16)],
        0.98,
    ),
    // o
    (&[(0.3, 0.12), (0.68, 0.34), (0.66, 0.86), (0.36, 1.0), (0.18, 0.62), (0.4, 0.3), (0.84, 0.5)], 1.14),
    // s as a wave
    (&[(0.36, 0.6), (0.56, 1.02), (0.7, 0.5), (0.62, 0.06)], 0.94),
    // h: a loop, then an arcade
    (
        &[
            (0.4, 0.7),
            (0.7, 1.8),
            (0.48, 2.1),
            (0.3, 1.2),
            (0.34, 0.1),
            (0.62, 0.84),
            (0.9, 0.9),
            (1.04, 0.2),
        ],
        1.36,
    ),
];

pub(super) fn handwriting(random: &mut Random) -> Picture {
    let mut picture = sheet("handwriting", random.between(2.5, 5.0));
    let size = random.between(36.0, 46.0);
    let lean = random.between(0.05, 0.4);
    let slope = random.between(-0.02, 0.02);
    let pitch = 4.1 * size;
    let mut line = 150.0;
    while line < 1400.0 - 1.6 * size {
        let mut x = random.between(50.0, 90.0);
        let end = random.between(850.0, 940.0);
        while x < end - 5.0 * size {
            let letters = 3 + random.below(4);
            let word = word(letters, random);
            let long = word.last().map_or(0.0, |(x, _)| x * size);
            if x + long + lean * 2.2 * size > end {
                break;
            }
            let base = line + slope * (x - 500.0);
            let place = |(wx, wy): &At| (x + size * (wx + lean * wy), base - size * wy + slope * size * wx);
            picture.line(&through(&word.iter().map(place).collect::<Vec<_>>()));
            if random.chance(0.35) {
                // The dot of an i, or an accent.
                let (dx, dy) = (random.between(0.3, 0.7) * long, 2.5 * size);
                picture.line(&[(x + dx, base - dy), (x + dx + 9.0, base - dy - 8.0)]);
            }
            x += long + random.between(0.9, 1.3) * size;
        }
        line += pitch;
    }
    picture
}

/// Letters in a row, no two alike, each a little other than the last of its kind.
fn word(letters: u32, random: &mut Random) -> Vec<At> {
    let mut points = vec![(0.0, 0.0)];
    let mut x = 0.0;
    for _ in 0..letters {
        let Some((shape, wide)) = random.pick(&LETTERS) else { break };
        let (stretch, grow) = (random.between(0.92, 1.12), random.between(0.92, 1.08));
        points.extend(shape.iter().map(|(sx, sy)| {
            (x + stretch * sx + random.between(-0.02, 0.02), grow * sy + random.between(-0.02, 0.02))
        }));
        x += stretch * wide;
        points.push((x, random.between(-0.02, 0.04)));
    }
    points.push((x + 0.4, 0.3));
    points
}
